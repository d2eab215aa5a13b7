#pragma once
/// The controller border: observation in, command out. No simulator in it: the same controller can be linked to
/// the drivers of a real robot.
///
/// A controller kind is one folder under controllers/ and one line in controllers/kinds.h. It writes
///
///   struct Wander {
///     using Spec = ...;  using State = ...;           // with field lists; State is saved and hashed
///     Spec spec; State state;
///     Status init(const Description& robot);          // resolves names to handles; or, for topics of its own and those
///     Status init(const Description& robot, Outputs& out);  // that clients publish for it (Outputs::subscribe),
///     void step(const Observation& obs, Command& cmd);
///     bool fits() const;                              // only where sizes or indices in State are trusted: asked after
///                                                     // it was restored from a file, false refuses the snapshot
///   };
///   const ControllerKind kind = make_controller<Wander>({...});
///
/// All controllers of a kind step in few calls (ControllerKind::step_all), in which the compiler sees through step(); a
/// class derived from Controller with a kind of its own, without step_all, is stepped one by one. Both give the same.
///
/// A team's controller drives all robots of the team: see Description::members.
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/describe.h"
#include "base/element.h"
#include "base/random.h"
#include "base/read.h"
#include "control/outputs.h"
#include "messages/messages.h"
#include "messages/topic.h"

namespace sandlot {

inline constexpr int controller_api_version = 5;

/// Handle of a device's message of type M, resolved once.
template <class M>
struct Reading {
  std::uint32_t topic = ~0u;
};
/// Handle of a device that takes commands of type M, resolved once.
template <class M>
struct Actuator {
  std::uint32_t slot = ~0u;
};
/// What a controller may know of the robot it drives: names and types, no ground truth.
class Description {
 public:
  struct Entry {
    std::string device;    ///< "laser"
    std::string level;     ///< "ranges"
    std::string type;      ///< "sensor_msgs/msg/LaserScan"
    std::uint32_t index;   ///< into the observation's topics or the command's slots
    Pose X_BS;             ///< sensor frame in the robot's base link
    bool program = false;  ///< a topic of another program: `device` is "estimator/estimate"
  };
  std::string robot;  ///< its name, or that of the team
  double control_period_s = 0;
  std::vector<Entry> readings;
  std::vector<Entry> actuators;
  /// Of a team's controller: each robot of the team in creation order, with handles that are valid for the team's controller.
  /// `readings` and `actuators` list the same devices with the robot's name in front: "red1/laser".
  std::vector<Description> members;

  /// `device` or `device/level`, or `program/topic` of a program that is listed before this one; "" takes the only device
  /// of that type or, without one, the only topic. Errors name what there is.
  template <class M>
  Result<Reading<M>> reading(std::string_view device) const {
    SL_ASSIGN(const Entry* entry, find(readings, device, M::ros_type, "reading"));
    return Reading<M>{entry->index};
  }
  template <class M>
  Result<Actuator<M>> actuator(std::string_view device) const {
    SL_ASSIGN(const Entry* entry, find(actuators, device, M::ros_type, "actuator"));
    return Actuator<M>{entry->index};
  }
  /// Where the sensor behind a reading sits on the robot.
  template <class M>
  const Pose& pose(Reading<M> reading) const {
    for (const Entry& entry : readings)
      if (entry.index == reading.topic) return entry.X_BS;
    SL_CHECK_MSG(false, "handle of another robot");
    return readings.front().X_BS;
  }

 private:
  Result<const Entry*> find(const std::vector<Entry>& entries, std::string_view device, const char* type,
                            const char* what) const;
};

/// A message as it was at the beginning of this control step; valid during the step.
template <class M>
struct View {
  const M& message;
  Time stamp;
  bool fresh;  ///< new since this controller's previous step
  bool valid;  ///< false: the device has never produced one
};

/// What a controller sees in one step.
class Observation {
 public:
  /// @param inputs  what clients published for the controller (Outputs::subscribe)
  Observation(Time now, std::span<const TopicBase* const> topics, std::span<const std::uint64_t> seen,
              Stream random, std::span<const Outputs::Input> inputs = {})
      : now_(now), topics_(topics), seen_(seen), random_(random), inputs_(inputs) {}
  Time now() const { return now_; }
  template <class M>
  View<M> get(Reading<M> handle) const {
    SL_CHECK(handle.topic < topics_.size());
    const Topic<M>* const topic = topic_cast<M>(topics_[handle.topic]);
    SL_CHECK(topic != nullptr);
    return {topic->message, topic->stamp, topic->count > seen_[handle.topic], topic->count > 0};
  }
  /// The newest message that a client published; its stamp is when it came. Its numbers are finite, but for NaN in lists.
  template <class M>
  View<M> get(Subscription<M> handle) const {
    SL_CHECK(handle.index < inputs_.size());
    const Outputs::Input& input = inputs_[handle.index];
    const Topic<M>* const topic = topic_cast<M>(input.topic.get());
    SL_CHECK(topic != nullptr);
    return {topic->message, topic->stamp, topic->count > input.seen, topic->count > 0};
  }
  /// For those that know a message by its type alone. @param reading  index in the description
  const TopicBase& topic(std::uint32_t reading) const {
    SL_CHECK(reading < topics_.size());
    return *topics_[reading];
  }
  /// This controller's own random numbers for this step.
  Stream random() const { return random_; }

 private:
  Time now_;
  std::span<const TopicBase* const> topics_;
  std::span<const std::uint64_t> seen_;
  Stream random_;
  std::span<const Outputs::Input> inputs_;
};

/// What a controller orders in one step; acts at the beginning of the next tick. What it publishes is there for others from
/// the end of the step on.
class Command {
 public:
  struct Order {
    std::uint32_t slot;         ///< an actuator's index; for a sample, that of the reading with `sample_bit`
    std::uint32_t begin, size;  ///< bytes of the message in `bytes`
    bool is_sample() const { return (slot & sample_bit) != 0; }
    std::uint32_t reading() const { return slot & ~sample_bit; }
  };
  static constexpr std::uint32_t sample_bit = 1u << 31;

  template <class M>
  void set(Actuator<M> handle, const M& message) {
    const auto begin = static_cast<std::uint32_t>(bytes_.size());
    write(bytes_, message);
    orders_.push_back({handle.slot, begin, static_cast<std::uint32_t>(bytes_.size()) - begin});
  }
  /// As set(), from bytes that set() wrote before.
  void set_bytes(std::uint32_t slot, std::span<const std::byte> message) {
    orders_.push_back(
        {slot, static_cast<std::uint32_t>(bytes_.size()), static_cast<std::uint32_t>(message.size())});
    bytes_.raw(message.data(), message.size());
  }
  /// Asks the device behind a reading for a sample at the end of the next tick, although none is due. A topic of another
  /// program has no device: the request is refused and counted.
  template <class M>
  void request_sample(Reading<M> handle) {
    request_sample_of(handle.topic);
  }
  void request_sample_of(std::uint32_t reading) { orders_.push_back({reading | sample_bit, 0, 0}); }
  /// Publishes a message on a topic of the program's own. Of several in one step the last counts.
  template <class M>
  void publish(Publication<M> handle, const M& message) {
    SL_CHECK_MSG(outputs_ != nullptr, "the program has no topics");
    outputs_->set(handle, message);
  }
  /// What earlier steps published last on such a topic; null before the first message. It survives snapshots, as State does.
  template <class M>
  const M* published(Publication<M> handle) const {
    SL_CHECK_MSG(outputs_ != nullptr, "the program has no topics");
    return outputs_->last(handle);
  }
  /// Where publish() puts messages: the object that init() filled. It must outlive the command.
  void bind(Outputs* outputs) { outputs_ = outputs; }
  void clear() {
    orders_.clear();
    bytes_.clear();
  }
  std::span<const Order> orders() const { return orders_; }
  std::span<const std::byte> bytes(const Order& order) const {
    return bytes_.bytes().subspan(order.begin, order.size);
  }

 private:
  std::vector<Order> orders_;
  ByteWriter bytes_;
  Outputs* outputs_ = nullptr;
};

/// A controller of any kind.
class Controller {
 public:
  virtual ~Controller() = default;
  /// Reads the configuration, resolves names and makes topics. Called once, before the first step.
  virtual Status init(const Description& robot, const Node& config, Outputs& out) = 0;
  virtual void step(const Observation& obs, Command& cmd) = 0;
  virtual Status set_parameter(std::string_view path, const Node& value) = 0;
  /// A number of the spec or the state by its path, and all of them.
  virtual ValueFound value(ValuePart part, std::span<const ValueStep> path) const = 0;
  virtual void list_values(ValuePart part, const ValueVisit& visit) const = 0;
  virtual void save(ByteWriter& w) const = 0;
  virtual void load(ByteReader& r) = 0;
};

/// Calls f, the code of a controller's author. @return what() of the exception that it threw, if it threw one
template <class F>
std::optional<std::string> caught(F&& f) {
  try {
    f();
    return std::nullopt;
  } catch (const std::exception& e) { return e.what(); } catch (...) {
    return "something that is not a std::exception";
  }
}

/// One controller's turn within a step of many.
struct ControllerTurn {
  Controller* controller = nullptr;
  const Observation* observation = nullptr;
  Command* command = nullptr;
  std::optional<std::string> failure = {};  ///< out: what it threw
};

struct ControllerKind {
  const char* name;
  const char* help;
  int api_version = controller_api_version;
  // Filled by make_controller:
  std::vector<FieldInfo> (*describe)() = nullptr;
  std::unique_ptr<Controller> (*create)() = nullptr;
  /// Steps controllers of this kind, each with what it sees alone. Called from several threads with others' turns. Null:
  /// they are stepped by Controller::step.
  void (*step_all)(std::span<ControllerTurn> turns) = nullptr;
};

template <class C>
class ControllerAdapter final : public ElementAdapter<Controller, C> {
 public:
  Status init(const Description& robot, const Node& config, Outputs& out) override {
    SL_ASSIGN(this->element_.spec, read_spec<typename C::Spec>(config));
    if constexpr (requires { this->element_.init(robot, out); }) return this->element_.init(robot, out);
    else return this->element_.init(robot);
  }
  /// For a controller without topics.
  Status init(const Description& robot, const Node& config) {
    Outputs none(robot.robot);
    return init(robot, config, none);
  }
  void step(const Observation& obs, Command& cmd) override { this->element_.step(obs, cmd); }
  static void step_all(std::span<ControllerTurn> turns) {
    for (ControllerTurn& turn : turns)
      turn.failure = caught([&] {
        static_cast<ControllerAdapter*>(turn.controller)->element_.step(*turn.observation, *turn.command);
      });
  }
};

template <class C>
constexpr ControllerKind make_controller(ControllerKind kind) {
  kind.describe = [] { return describe_fields<typename C::Spec>(); };
  kind.create = []() -> std::unique_ptr<Controller> { return std::make_unique<ControllerAdapter<C>>(); };
  kind.step_all = ControllerAdapter<C>::step_all;
  return kind;
}

}  // namespace sandlot
