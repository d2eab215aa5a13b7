#pragma once
/// Ball handler: two driven wheels that hold a ball in front of a robot and let it roll on, as the dribblers of robot soccer do.
///
/// Frame    the device's frame S: x points to where the ball is held. It belongs in the middle of the robot, at the height of
///          the ball's middle.
/// Command  level `hold`: std_msgs/Float64, the strength from 0 (released) to 1; it holds until the next command.
/// Holds    a ball: a link whose only collision is a sphere about its origin, of another robot or object, that forces move. Its middle must lie
///          within `reach` of S's origin, seen from above, and within `opening` about x; in height no farther from S than
///          its radius. Of several the nearest.
/// Acts     in each physics step of h, seen from above, with the ball's middle p, mass m, moment of inertia I and radius r,
///          and the point H on x at the distance `hold_distance`:
///            v* = velocity of the robot's body at p - (p - H) / 0.08 s
///            F  = m (v* - v) / (2 h), at most strength max_force; at the ball's middle
///            T  = I (z x F / (m r) + (w* - w) / (2 h)) about the horizontal, at most strength max_force r; w* = z x v / r: the
///                 roll without slip, for which the ground needs no friction; w is taken for w* on an engine that is
///                 planar
///          The device's link takes -F, at the same point, and -T. Both halve the difference in each step, so that two robots
///          that pull at one ball do not make it swing.
/// Tears    to accelerate the ball with the robot by a takes F = m (a + b), b: what rolling resistance takes. What is more than
///          max_force is missing: the ball falls behind, and is lost when it leaves the reach.
/// Output   sandlot_msgs/BallHandlerState at `rate`: whether a ball is held, the mean size of F over the latest tick, balls
///          taken and lost so far, the name of what is held.
/// Noise    none; see the common key command_errors.
/// Limits   the wheels' own inertia, and slip between them and the ball: the force acts at the middle of the ball. It presses
///          on nothing: the ball is held free of the body. A spin about the vertical is left alone.
/// Cost     a comparison while released; while active two subtractions per body of the world and tick, and per physics step
///          and ball held two wrenches. No allocation.
/// Errors   hold_distance beyond the reach.
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::ball_handler {

struct Spec {
  double reach_m = 0.4;
  double hold_distance_m = 0.335;
  double opening_rad = 0.349065850398866;
  double max_force_N = 3;
  double strength = 0;
  double rate_hz = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"reach", "m", "Largest distance of the ball's middle from the device, seen from above.", 1e-3,
                100, Field::tunable},
          s.reach_m);
    visit(Field{"hold_distance", "m", "Distance at which the middle of the ball is held.", 0, 100},
          s.hold_distance_m);
    visit(Field{"opening", "rad",
                "Angle in front of the device, half to each side, in which it reaches the ball.", 1e-3, 6.3,
                Field::tunable},
          s.opening_rad);
    visit(Field{"max_force", "N", "Largest force on the ball, at full strength.", 0, 1e6, Field::tunable},
          s.max_force_N);
    visit(Field{"strength", "1", "Strength before the first command, from 0 (released) to 1.", 0, 1},
          s.strength);
    visit(Field{"rate", "Hz", "Messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
  Status check(const Node& node, const std::string& path) const;
};

struct State {
  std::uint64_t taken = 0;
  double strength = 0;
  std::string instance, link;
  double impulse_Ns = 0;
  double force_N = 0;
  std::uint64_t grips = 0, losses = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen."}, s.taken);
    visit(Field{"strength", "1", "Strength in force, from 0 (released) to 1.", 0, 1}, s.strength);
    visit(Field{"instance", "", "Robot or object that is held; empty: none."}, s.instance);
    visit(Field{"link", "", "Link of it that is held."}, s.link);
    visit(Field{"impulse", "Ns", "Sum of the sizes of the impulses in this tick so far."}, s.impulse_Ns);
    visit(Field{"force", "N", "Mean size of the force on the ball in the latest tick."}, s.force_N);
    visit(Field{"grips", "1", "Number of balls taken."}, s.grips);
    visit(Field{"losses", "1", "Number of balls that tore off."}, s.losses);
  }
};

struct BallHandler {
  using Spec = ball_handler::Spec;
  using State = ball_handler::State;
  Spec spec;
  State state;

  BodyId body;
  std::string robot;
  Pose X_LS;
  bool planar = false;
  Topic<msg::BallHandlerState>* hold = nullptr;
  Topic<msg::Float64>* command = nullptr;
  BodyId ball;  ///< what is held, found again in each tick

  static Result<BallHandler> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<BallHandler> pool, const Context& context);
  static void pre_substep(PoolView<BallHandler> pool, const Context& context, double h_s);
  static void sense(PoolView<BallHandler> pool, const Context& context);
  bool fits() const;
  bool holds() const { return !state.instance.empty(); }
  void find_ball(const Engine& engine);
  void pull(const Context& context, double h_s);
};

extern const Kind kind;

}  // namespace sandlot::ball_handler
