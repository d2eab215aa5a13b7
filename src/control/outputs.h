#pragma once
/// Topics that a program publishes.
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

/// Topics that a program publishes, made while it begins: "/rover/estimator/estimate".
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
  const Status& status() const { return status_; }

  template <class M>
  void set(Publication<M> handle, const M& message) {
    SL_CHECK(handle.index < outputs_.size());
    Output& output = outputs_[handle.index];
    Topic<M>* const next = topic_cast<M>(output.next.get());
    SL_CHECK(next != nullptr);
    next->message = message;
    output.fresh = true;
  }
  /// Publishes what was held back, with `now` as its time.
  void commit(Time now);
  /// Takes over the topics, with their messages, of outputs that this object replaces.
  void adopt(Outputs& before);

  const std::string& path() const { return path_; }
  bool empty() const { return outputs_.empty(); }
  std::span<const Output> all() const { return outputs_; }
  std::span<Output> all() { return outputs_; }

 private:
  void check(std::string_view name);

  std::string path_;
  std::vector<Output> outputs_;
  Status status_;
};

}  // namespace sandlot
