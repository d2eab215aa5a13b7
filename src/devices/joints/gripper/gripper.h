#pragma once
/// Gripper: holds the nearest thing in its reach, as it stands, until a command opens it or the object is
/// torn off.
///
/// Frame    the grasping point is the origin of the device's frame S on its link.
/// Command  level `hold`: std_msgs/Bool. True closes: of all bodies that forces can move, the robot's own
///          left out, the one whose shapes are nearest to the grasping point is held, if it is within
///          `reach`; of equals the first by name. False opens. True while it holds something changes nothing;
///          true while it holds nothing is another try.
/// Output   sandlot_msgs/GripperState: closed, what is held ("can::body", empty: nothing), and the force on
///          it in S.
/// Time     a command acts from the tick it arrives in. The force is the mean over the last physics step.
///          When it was above `max_force`, what is held comes free before the next one.
/// Noise    none.
/// Limits   the grip is a weld between two links: no fingers, no squeezing, no slip; torque does not tear it.
///          On the planar engine nothing is lifted: what is held goes on rubbing on the ground, and no weight
///          is in the force. The mechanics of closing and its time are not modelled; for fingers use joints
///          and friction.
/// Cost     a look at the list of grips per physics step while it holds; a query of a ball at each try.
/// Errors   an engine without grips; a robot that moves along a path.
/// Source   physics/engine.h (GripTarget); names after Gazebo's vacuum gripper.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::gripper {

struct Spec {
  double reach_m = 0.05;
  double max_force_N = 1e9;
  bool closed = false;
  double rate_hz = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"reach", "m", "Largest distance of an object's surface from the grasping point.", 0, 1e3,
                Field::tunable},
          s.reach_m);
    visit(Field{"max_force", "N", "Force in the grip beyond which it is torn open.", 0, 1e9, Field::tunable},
          s.max_force_N);
    visit(Field{"closed", "", "Whether the gripper closes in the first tick, without a command."}, s.closed);
    visit(Field{"rate", "Hz", "Messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct State {
  std::uint64_t taken = 0;
  bool closed = false;
  bool tries = false;
  bool torn = false;
  std::string instance, link;  ///< names, because those mean the same after a restore; empty: nothing
  Vec3 force_N;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen."}, s.taken);
    visit(Field{"closed", "", "Whether the gripper is commanded to close."}, s.closed);
    visit(Field{"tries", "", "Whether the gripper looks for something to hold in the next tick."}, s.tries);
    visit(Field{"torn", "", "Whether the force was too large: the grip opens before the next physics step."},
          s.torn);
    visit(Field{"instance", "", "Instance whose link is held; empty: nothing."}, s.instance);
    visit(Field{"link", "", "Link that is held."}, s.link);
    visit(Field{"force", "N", "Force on the held object in the last physics step, in the world."}, s.force_N);
  }
};

struct Gripper {
  using Spec = gripper::Spec;
  using State = gripper::State;
  Spec spec;
  State state;

  BodyId body;
  std::string robot;
  Pose X_LS;
  Topic<msg::GripperState>* hold = nullptr;
  Topic<msg::Bool>* command = nullptr;

  static Result<Gripper> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Gripper> pool, const Context& context);
  static void pre_substep(PoolView<Gripper> pool, const Context& context, double h_s);
  static void post_substep(PoolView<Gripper> pool, const Context& context, double h_s);
  static void sense(PoolView<Gripper> pool, const Context& context);
  void release(const Context& context);

  bool holds() const { return !state.instance.empty(); }
  /// The grip by which it holds, or null: somebody took the thing away.
  const Grip* grip(const Engine& engine) const;
  void let_go(const Context& context);
  void try_to_hold(const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::gripper
