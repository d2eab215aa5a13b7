/// heading_drive: the drive of a high-level agent: a speed and a heading instead of wheels.
///
/// Command  level `ideal`: sandlot_msgs/SpeedHeading: speed forward and heading in the world. The robot turns the shorter way to
///          the heading, at most as fast as `max_turn_rate`, slowing down so that it stops there, and goes forward meanwhile: it runs
///          on an arc, or turns on the spot while the speed is 0.
///          Also a piece of way (devices/drives/maneuver.h): it counts its true motion, in every tick, and has no motors that
///          could stall.
/// Time     a command acts from the tick it arrives in, until the next one or for `command_timeout`; before the first one the
///          robot stands.
/// Limits   in the plane only. Obstacles stop it with a force of mass times max_acceleration. It knows the true heading: see
///          diff_drive and odometry for robots that do not.
/// Noise    none.
/// Cost     one target per tick, no allocation.
/// Errors   an engine without ideal drives.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "devices/drives/maneuver.h"
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::heading_drive {
namespace {

struct Spec {
  double max_speed_mps = 1, max_turn_rate_radps = 3;
  double max_acceleration_mps2 = 1e3, max_angular_acceleration_radps2 = 1e3;
  double command_timeout_s = 0;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"max_speed", "m/s", "Largest speed, forward and backward.", 0, 1e4, tunable},
          s.max_speed_mps);
    visit(Field{"max_turn_rate", "rad/s", "Largest rate of turn.", 1e-6, 1e4, tunable},
          s.max_turn_rate_radps);
    visit(Field{"max_acceleration", "m/s^2", "Largest change of the speed per second.", 0, 1e9, tunable},
          s.max_acceleration_mps2);
    visit(Field{"max_angular_acceleration", "rad/s^2", "Largest change of the rate of turn per second.", 1e-6,
                1e9, tunable},
          s.max_angular_acceleration_radps2);
    visit(Field{"command_timeout", "s", "Time without a command after which the robot stops; 0: never.", 0,
                1e6, tunable},
          s.command_timeout_s);
  }
};

struct State {
  std::uint64_t taken = 0;
  Time command_time;
  double speed_mps = 0, heading_rad = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"taken", "1", "Number of commands seen."}, s.taken);
    visit(Field{"command_time", "ns", "Time of the last command."}, s.command_time);
    visit(Field{"speed", "m/s", "Commanded speed."}, s.speed_mps);
    visit(Field{"heading", "rad", "Commanded heading in the world."}, s.heading_rad);
  }
};

struct HeadingDrive {
  using Spec = heading_drive::Spec;
  using State = heading_drive::State;
  Spec spec;
  State state;
  Boxed<maneuver::Late> late;
  BodyId base;
  Topic<msg::SpeedHeading>* command = nullptr;
  maneuver::Topics maneuver;

  static Result<HeadingDrive> create(const DeviceBuild& build, Spec spec) {
    if (!build.engine.ideal_drives)
      return Error{"the engine '" + std::string(build.engine.name) + "' has no ideal drives"};
    HeadingDrive drive{spec};
    drive.base = build.bodies.front();
    drive.command = build.accept<msg::SpeedHeading>(0, "ideal");
    drive.maneuver = maneuver::make_topics(build);
    return drive;
  }

  /// Rate of turn w for the next tick T: the largest with which the robot can still stop at the heading, w T + w^2 / (2 a) =
  /// what is left. Near the heading that is what is left / T: it ends there.
  double rate_radps(double to_go_rad, double tick_s) const {
    const double far = std::abs(to_go_rad);
    const double stopping = std::sqrt(tick_s * tick_s + 2 * far / spec.max_angular_acceleration_radps2);
    const double rate = std::min(spec.max_turn_rate_radps, 2 * far / (stopping + tick_s));
    return to_go_rad < 0 ? -rate : rate;
  }

  static void actuate(PoolView<HeadingDrive> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      HeadingDrive& drive = pool.all[index];
      const Spec& spec = drive.spec;
      State& state = drive.state;
      if (drive.command->count != state.taken) {
        state.taken = drive.command->count;
        state.command_time = drive.command->stamp;
        maneuver::end(drive.late);
        state.speed_mps = drive.command->message.speed;
        state.heading_rad = drive.command->message.heading;
      }
      const bool late = spec.command_timeout_s > 0 &&
                        (context.now - context.tick - state.command_time).s() > spec.command_timeout_s;
      const bool stands = state.taken == 0 || late;
      const double yaw_rad = yaw_of(context.engine.states()[drive.base.index].X_WB.q);
      const double to_go_rad = math::wrap_angle(state.heading_rad - yaw_rad);
      maneuver::PlanarMotion moving;
      if (maneuver::ride(drive.late, drive.maneuver,
                         {.speed_mps = spec.max_speed_mps,
                          .turning_rate_radps = spec.max_turn_rate_radps,
                          .acceleration_mps2 = spec.max_acceleration_mps2,
                          .angular_acceleration_radps2 = spec.max_angular_acceleration_radps2},
                         context.engine.states()[drive.base.index], context))
        moving = drive.late->maneuver.setpoint;
      else if (!stands)
        moving = {std::clamp(state.speed_mps, -spec.max_speed_mps, spec.max_speed_mps), 0,
                  drive.rate_radps(to_go_rad, context.tick.s())};
      context.actuation.drives.push_back({.base = drive.base,
                                          .vx_mps = moving.x,
                                          .vy_mps = moving.y,
                                          .wz_radps = moving.turn,
                                          .max_accel_mps2 = spec.max_acceleration_mps2,
                                          .max_angular_accel_radps2 = spec.max_angular_acceleration_radps2});
    }
  }
  bool fits() const {
    return std::isfinite(state.speed_mps) && std::isfinite(state.heading_rad) && maneuver::fits(late, 0);
  }
  void release(const Context& context) const {
    context.actuation.drives.push_back({.base = base, .active = false});
  }
};

constexpr LevelInfo levels[] = {
    {"ideal", "", msg::SpeedHeading::ros_type, "The robot turns to the heading and goes at the speed."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<HeadingDrive>({
    .name = "heading_drive",
    .help = "Drive of a high-level agent: goes at a commanded speed and turns to a commanded heading.",
    .levels = levels,
});

}  // namespace sandlot::heading_drive
