#pragma once
/// Moves several joints along a trajectory of timed points.
///
/// Command  level `trajectory`: trajectory_msgs/JointTrajectory for some or all of its joints. It starts at
///          its stamp, or in the tick it arrives in when the stamp is 0, from where the references are then;
///          a new one replaces the old. Between points with velocities the path is a cubic (Hermite), else a
///          straight line; after the last it stays there. Joints that it does not name stay where they are. A
///          trajectory with a fault (a joint that is not its own, times that do not grow, a number that is
///          none) is dropped whole.
/// Control  once per sub-step. Without gains the engine holds each joint to the speed of the path plus a
///          fifth of the error per sub-step; with gains a PID loop (devices/pid.h) on the position, its
///          derivative on the error. The joint's limits of range and effort hold.
/// Output   none; joint_state shows the joints.
/// Time     before the first trajectory the joints are held where they are. `active: false` leaves them free;
///          started again they are held where they are.
/// Noise    none.
/// Limits   accelerations and efforts of points are not used; no tolerances, no feedback or result of an
///          action.
/// Cost     one binary search and one cubic per joint and sub-step; no allocation but when a trajectory is
///          taken.
/// Errors   a joint that is not there or has no single degree of freedom; a number of gains other than that
///          of joints.
/// Source   devices/pid.h; cubic Hermite interpolation.
#include <vector>

#include "devices/kind.h"
#include "devices/pid.h"
#include "messages/messages.h"

namespace sandlot::joint_trajectory {

inline constexpr std::size_t max_points = 10'000;

struct Spec {
  std::vector<std::string> joints;
  std::vector<Gains> gains;
  bool active = true;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"joints", "",
                "Names of the joints, in order; none: all that can be driven, in the model's order.", 0, 0,
                Field::none, 1000},
          s.joints);
    visit(Field{"gains", "", "Gains of each joint, in order [Nm per rad]; none: followed exactly.", 0, 0,
                Field::none, 1000},
          s.gains);
    visit(Field{"active", "", "Whether the joints are driven; false: the joints are free.", 0, 1,
                Field::tunable},
          s.active);
  }
};

struct State {
  std::uint64_t taken = 0;
  std::uint8_t held = 0;         ///< 0: the joints are free
  double elapsed_s = 0;          ///< since the start of the path
  std::vector<double> time_s;    ///< of each point; the first is where the path began
  std::vector<double> position;  ///< point by point, all joints
  std::vector<double> velocity;  ///< likewise; empty: straight lines
  std::vector<Pid> pids;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen."}, s.taken);
    visit(Field{"held", "1", "Whether the joints are held; 0: the joints are free."}, s.held);
    visit(Field{"elapsed", "s", "Time since the start of the path."}, s.elapsed_s);
    visit(Field{"time", "s", "Time of each point."}, s.time_s);
    visit(Field{"position", "", "Position at each point, per joint."}, s.position);
    visit(Field{"velocity", "", "Velocity at each point, per joint."}, s.velocity);
    visit(Field{"pids", "", "States of the servo loops."}, s.pids);
  }
};

struct Trajectory {
  using Spec = joint_trajectory::Spec;
  using State = joint_trajectory::State;
  Spec spec;
  State state;

  struct Joint {
    JointId id;
    double lower, upper, max_effort, max_velocity;
  };
  std::vector<Joint> joints;
  EnergyMeter* energy = nullptr;  ///< draws its mechanical work (devices/energy.h)
  Topic<msg::JointTrajectory>* command = nullptr;

  static Result<Trajectory> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Trajectory> pool, const Context& context);
  static void pre_substep(PoolView<Trajectory> pool, const Context& context, double h_s);
  void release(const Context& context);
  /// The lists of the path have lengths that go together, and its times run forward.
  bool fits() const;
};

extern const Kind kind;

}  // namespace sandlot::joint_trajectory
