#pragma once
/// What the simulation does for programs that need more of it than messages: hosts of programs of another simulator. A Program
/// implements Surrounded in addition, and the simulation finds out by itself.
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "control/program.h"

namespace sandlot::programs {

/// Kind and numbers of a device: the parameters that are a number each, by path.
struct DeviceFacts {
  std::string name, kind;
  std::vector<std::string> levels;  ///< that are active
  std::map<std::string, double> numbers;
};

/// A robot or object. Numbers count from 1: robots in the order of their creation, then objects.
struct Being {
  std::uint32_t number = 0;
  bool is_robot = false;
  std::string name;
  Pose X_WM;  ///< given to see() only
};

/// New place of a robot or object, as a program requests it.
struct Move {
  std::string name;
  Pose X_WM;
};

/// New value of a parameter of a device of its robot, as a program requests it.
struct Setting {
  std::string device, field;  ///< "drive", "control/vv"
  double value = 0;
};

class Surrounded {
 public:
  virtual ~Surrounded() = default;
  /// Devices of its robot, and the length of a tick, the shortest where they differ. Before init().
  virtual void describe(std::vector<DeviceFacts> devices, Time tick) = 0;
  /// Whether see() shall be called before each step.
  virtual bool looks_around() const = 0;
  virtual void see(std::span<const Being> beings) = 0;
  /// Robots and objects without their poses, when some came or went. Before a step.
  virtual void meet(std::span<const Being> beings) = 0;
  /// Waits for what the outside has to say where no descriptor tells it: until something may have come, or `until`.
  /// @return whether it waits in this way at all
  virtual bool await(Outside::Clock::time_point until) = 0;
  /// Moves that the answer requested that receive() returned last. They are input of the next tick, as the answer is.
  virtual std::vector<Move> take_moves() = 0;
  /// Parameters that it set, likewise.
  virtual std::vector<Setting> take_settings() = 0;
};

}  // namespace sandlot::programs
