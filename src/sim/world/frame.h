#pragma once
/// Frame: the immutable picture of a tick for the outside. Observers read frames and cannot change the run.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "elements/request.h"
#include "messages/topic.h"
#include "physics/engine.h"

namespace sandlot {

/// Hash of one entity's State: an instance's bodies ("rover"), a device ("rover/laser") or a program
/// ("rover/controller").
struct SubHash {
  std::string path;
  std::uint64_t hash = 0;
};

struct FrameInstance {
  std::string name;
  InstanceId id;
  std::uint64_t serial = 0;  ///< creation order over the whole run: nothing else ever has it
  bool is_robot = false;
  Pose X_WM;
  Velocity V_WB;  ///< of the canonical link
  std::shared_ptr<const model::Model> model;
  std::vector<Pose> X_WL;  ///< of each link, if asked for
};

/// Entry of the log: one request or order of a tick, in order. These entries and the first state are the replay.
struct LogEntry {
  /// The alternatives of Request in their order, and the measured length of the tick (clock `continuous`).
  static constexpr std::uint8_t command = 0, step = 255;
  std::uint8_t kind = command;
  Source source;
  std::uint64_t sequence = 0;
  std::string target;            ///< "rover/drive/ideal"; nothing for `step`
  std::string type;              ///< ROS type of a command
  std::vector<std::byte> bytes;  ///< command: the message; step: nanoseconds, int64; others: write_request()
  bool refused = false;
  std::string why;  ///< it was refused; for those who look now, no part of recordings

  /// Whether it is input: what the world does not bring forth by itself when the run is repeated.
  bool is_input() const { return kind == step || !source.is_inside(); }
};

/// What a medium brought from one instance to another in a tick: a packet, a word.
struct FrameDelivery {
  std::uint32_t medium = 0;                ///< index in the world's list
  std::uint64_t sender = 0, receiver = 0;  ///< serials of the instances
  std::int32_t channel = 0;
  double strength = 0;  ///< as received, in the medium's unit
};

struct Frame {
  std::uint64_t tick = 0;
  Time now;
  std::uint64_t revision = 0;  ///< of the Model: counts spawns, deletions and level changes
  Time step;                   ///< length of the tick
  std::vector<FrameInstance> instances;
  std::vector<std::shared_ptr<const TopicBase>>
      topics;                             ///< those that got a message in this tick, if asked for
  std::vector<LogEntry> log;              ///< if asked for, or its part that is `input`
  std::vector<Contact> contacts;          ///< of the last sub-step, if asked for
  std::vector<FrameDelivery> deliveries;  ///< of media in this tick, if asked for
  std::uint64_t hash = 0;                 ///< of all State, if asked for
  std::vector<std::uint64_t> parts;       ///< and of each entity
  std::shared_ptr<const std::vector<std::string>>
      part_names;  ///< of `parts`; another object when they change
};

/// Observer of a run. Called at the end of each tick on the simulation's thread; it must not block. It may keep
/// frames and topics and read them in other threads. Once nobody holds them they are filled again, so it lets go of them
/// on the simulation's thread.
class Observer {
 public:
  virtual ~Observer() = default;
  struct Wants {
    bool messages = false;
    bool log = false;
    bool input = false;  ///< of the log what came from outside and from rules, without the orders of programs
    bool hash = false;
    bool links = false;
    bool contacts = false;
    bool deliveries = false;
    bool instances = true;  ///< false: the frame may come without them
  };
  /// Asked at the beginning of each tick.
  virtual Wants wants() const { return {}; }
  virtual void on_frame(const std::shared_ptr<const Frame>& frame) = 0;
};

}  // namespace sandlot
