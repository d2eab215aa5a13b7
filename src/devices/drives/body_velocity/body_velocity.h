#pragma once
/// Moves a whole robot at a commanded velocity, without wheels: what Gazebo calls velocity control.
///
/// Output   none; see ground_truth.
/// Command  level `ideal`: geometry_msgs/Twist in the frame of the model's first link; linear x and y and
///          angular z count, the robot stays on the plane it stands on.
///          Also a piece of way (devices/drives/maneuver.h): without wheels it counts its true motion, in every tick, and has
///          no motors that could stall.
/// Time     a command acts from the tick it arrives in, until the next one or for `command_timeout`.
/// Energy   draws its mechanical work on rails (devices/energy.h).
/// Limits   in the plane only: z, roll and pitch are physics' own. Obstacles stop it with a force of mass
///          times max_acceleration.
/// Noise    none.
/// Cost     one target per tick, no allocation.
/// Errors   an engine without ideal drives.
#include "devices/drives/maneuver.h"
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::body_velocity {

struct Spec {
  Vec3 initial_linear_mps;
  Vec3 initial_angular_radps;
  double max_acceleration_mps2 = 1e3;
  double max_angular_acceleration_radps2 = 1e3;
  double command_timeout_s = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"initial_linear", "m/s", "Velocity before the first command.", -1e4, 1e4},
          s.initial_linear_mps);
    visit(Field{"initial_angular", "rad/s", "Rate of turn before the first command.", -1e4, 1e4},
          s.initial_angular_radps);
    visit(Field{"max_acceleration", "m/s^2", "Largest change of the velocity per second.", 0, 1e9,
                Field::tunable},
          s.max_acceleration_mps2);
    visit(Field{"max_angular_acceleration", "rad/s^2", "Largest change of the rate of turn per second.", 0,
                1e9, Field::tunable},
          s.max_angular_acceleration_radps2);
    visit(Field{"command_timeout", "s", "Time without a command after which the base stops; 0: never.", 0,
                1e6, Field::tunable},
          s.command_timeout_s);
  }
};

struct State {
  std::uint64_t taken = 0;
  Time command_time;
  double vx_mps = 0, vy_mps = 0, wz_radps = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen."}, s.taken);
    visit(Field{"command_time", "ns", "Time of the last command."}, s.command_time);
    visit(Field{"vx", "m/s", "Commanded velocity forward."}, s.vx_mps);
    visit(Field{"vy", "m/s", "Commanded velocity to the left."}, s.vy_mps);
    visit(Field{"wz", "rad/s", "Commanded rate of turn."}, s.wz_radps);
  }
};

struct Mover {
  using Spec = body_velocity::Spec;
  using State = body_velocity::State;
  Spec spec;
  State state;
  Boxed<maneuver::Late> late;

  BodyId base;
  EnergyMeter* energy = nullptr;
  Topic<msg::Twist>* command = nullptr;
  maneuver::Topics maneuver;

  static Result<Mover> create(const DeviceBuild& build, Spec spec);
  static void actuate(PoolView<Mover> pool, const Context& context);
  void release(const Context& context);
  bool fits() const { return maneuver::fits(late, 0); }
};

extern const Kind kind;

}  // namespace sandlot::body_velocity
