#pragma once
/// One robot on flat ground, driven by commands, for the validations of drives.
#include <memory>
#include <string>

#include "base/result.h"
#include "sim/world/simulation.h"
#include "validation/quasistatic.h"

namespace sandlot::validation {

class Robot {
 public:
  struct Trial {
    std::string model;   ///< builder and parameters, in YAML
    std::string engine;  ///< "rigid"
    std::string level;
    int step_us = 2000;      ///< of physics; a tick is 10 ms or as near as steps allow
    std::string drive = {};  ///< further keys of the drive, in YAML: "odometry: kabsch"
    std::string world = {};  ///< further lines of the scenario
  };
  /// It has settled on its wheels.
  static Result<Robot> start(const Trial& trial);

  void command(Twist velocity);
  void switch_level(const std::string& level);
  void tick();

  Pose pose() const { return sim->engine().pose(id); }
  /// True velocity in its own frame.
  Twist velocity() const;
  /// State of the model's k-th joint.
  const JointState& joint(std::size_t k) const {
    return sim->engine().joint_states()[sim->engine().joints(id)[k].index];
  }
  double tick_s() const { return 1e-3 * tick_ms; }

  std::unique_ptr<Simulation> sim;
  InstanceId id;
  std::string level;
  int tick_ms = 10;
};

/// The constant twist that leads from one pose to the other, in the first one's frame.
Twist between(const Pose& from, const Pose& to, double turned_rad, double time_s);

}  // namespace sandlot::validation
