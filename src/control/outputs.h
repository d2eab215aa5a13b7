#pragma once
/// Topics that a program publishes, and those that others publish for it.
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/deep_const.h"
#include "base/result.h"
#include "messages/topic.h"

namespace sandlot {

/// Handle of a topic that a program publishes, made once.
template <class M>
struct Publication {
  std::uint32_t index = ~0u;
};

/// Handle of a topic on which others publish for a program, made once.
template <class M>
struct Subscription {
  std::uint32_t index = ~0u;
};

/// Most bytes of a message that comes on such a topic.
inline constexpr std::size_t most_input_bytes = 64 * 1024;

/// Topics that a program publishes, made while it begins: "/rover/estimator/estimate"; and those on which clients publish for
/// it, "/rover/goal_pose". The latter are called after the robot (or the team) alone, as ROS has them: several of its programs
/// may read one. What comes is a command like those to devices: judged, logged, replayed.
///
/// Time   a message that a step publishes is held back until commit(): programs that step at the same time see only what
///        earlier steps published.
/// Cost   two messages per topic; no allocation per step once they have reached their size.
class Outputs {
 public:
  struct Output {
    Owned<TopicBase> topic;
    Owned<TopicBase> next;  ///< the message that is held back
    bool fresh = false;     ///< there is one
  };
  struct Input {
    Owned<TopicBase>
        topic;  ///< `stamp` is when the newest message came; the message keeps the one that its sender gave
    std::uint64_t seen = 0;  ///< count at the program's previous step
  };
  /// @param path  of the program: "rover/estimator"
  explicit Outputs(std::string path) : path_(std::move(path)) {}

  /// A name has letters, digits and _ and is unique in its program; else status() is an error.
  template <class M>
  Publication<M> publish(std::string_view name) {
    check(name);
    const std::string topic = "/" + path_ + "/" + std::string(name);
    outputs_.push_back({std::make_unique<Topic<M>>(topic), std::make_unique<Topic<M>>(topic)});
    return {static_cast<std::uint32_t>(outputs_.size() - 1)};
  }
  /// A topic that clients may publish; the program reads it by Observation::get(). Rules of names as above; one that is
  /// called like a device or a program of the robot is refused when the program is made.
  template <class M>
  Subscription<M> subscribe(std::string_view name) {
    const std::string topic = "/" + path_.substr(0, path_.find('/')) + "/" + std::string(name);
    check_input(name, topic);
    inputs_.push_back({std::make_unique<Topic<M>>(topic)});
    return {static_cast<std::uint32_t>(inputs_.size() - 1)};
  }
  const Status& status() const { return status_; }

  /// A probable mistake of the robot's description that the program can live with; `sandlot check` reports it.
  struct Remark {
    std::string what, fix;
    std::string
        rule;  ///< kind of a rule: without one of it in the world the remark does not hold; "": always
  };
  void remark(Remark remark) { remarks_.push_back(std::move(remark)); }
  std::span<const Remark> remarks() const { return remarks_; }

  template <class M>
  void set(Publication<M> handle, const M& message) {
    SL_CHECK(handle.index < outputs_.size());
    Output& output = outputs_[handle.index];
    Topic<M>* const next = topic_cast<M>(output.next.get());
    SL_CHECK(next != nullptr);
    next->message = message;
    output.fresh = true;
  }
  /// The message that was published last; null before the first one.
  template <class M>
  const M* last(Publication<M> handle) const {
    SL_CHECK(handle.index < outputs_.size());
    const Topic<M>* const topic = topic_cast<M>(outputs_[handle.index].topic.get());
    SL_CHECK(topic != nullptr);
    return topic->count > 0 ? &topic->message : nullptr;
  }
  /// Publishes what was held back, with `now` as its time.
  void commit(Time now);
  /// Takes over the topics, with their messages, of outputs that this object replaces.
  void adopt(Outputs& before);

  const std::string& path() const { return path_; }
  bool empty() const { return outputs_.empty() && inputs_.empty() && remarks_.empty(); }
  std::span<const Output> all() const { return outputs_; }
  std::span<Output> all() { return outputs_; }
  std::span<const Input> inputs() const { return inputs_; }
  std::span<Input> inputs() { return inputs_; }

 private:
  void check(std::string_view name);
  void check_input(std::string_view name, const std::string& topic);

  std::string path_;
  std::vector<Output> outputs_;
  std::vector<Input> inputs_;
  Status status_;
  std::vector<Remark> remarks_;
};

}  // namespace sandlot
