#pragma once
/// What the outside sees: one immutable frame per tick. Observers read frames and cannot change the run.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "messages/topic.h"
#include "physics/engine.h"
#include "sim/request.h"

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
  bool is_robot = false;
  Pose X_WM;
  Velocity V_WB;  ///< of the canonical link
};

/// A command as it was applied in this tick.
struct FrameCommand {
  Source source;
  std::uint64_t sequence = 0;
  std::string target;  ///< slot name, "/rover/drive/ideal/command"
  std::string type;
  std::vector<std::byte> bytes;
};

struct Frame {
  std::uint64_t tick = 0;
  Time now;
  std::uint64_t revision = 0;  ///< of the Model: counts spawns, deletions and level changes
  std::vector<FrameInstance> instances;
  std::vector<std::shared_ptr<const TopicBase>>
      topics;  ///< those that got a message in this tick, if asked for
  std::vector<FrameCommand> commands;
  std::uint64_t hash = 0;  ///< if asked for
  std::vector<SubHash> sub_hashes;
};

/// Something that watches. Called at the end of each tick on the simulation's thread; it must not block.
class Observer {
 public:
  virtual ~Observer() = default;
  struct Wants {
    bool messages = false;
    bool hash = false;
  };
  virtual Wants wants() const { return {}; }
  virtual void on_frame(const std::shared_ptr<const Frame>& frame) = 0;
};

}  // namespace sandlot
