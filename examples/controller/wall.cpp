/// A plugin with one controller: `wall` keeps the wall to its right at a distance.
///
/// Reads    a LaserScan that covers the right side.
/// Orders   a Twist.
/// Limits   no dead ends, no corners to the left sharper than the scanner sees.
#include <sandlot/control.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace {

using namespace sandlot;

struct Wall {
  /// What a scenario may set: read, checked and listed from this one list.
  struct Spec {
    std::string laser, drive;
    double distance_m = 0.6;
    double speed_mps = 0.3;
    double give_up_s = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"laser", "", "Laser scanner to use; empty: the only one."}, s.laser);
      visit(Field{"drive", "", "Drive to use; empty: the only one."}, s.drive);
      visit(Field{"distance", "m", "Distance to keep.", 0.05, 10, Field::tunable}, s.distance_m);
      visit(Field{"speed", "m/s", "Speed.", 0, 10, Field::tunable}, s.speed_mps);
      visit(Field{"give_up", "s", "Throw an exception at this time, to see what becomes of it; 0: never.", 0,
                  1e6},
            s.give_up_s);
    }
  };
  /// What lasts from step to step: part of the state hash and of snapshots.
  struct State {
    double turn_radps = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"turn", "rad/s", "Turning rate ordered last."}, s.turn_radps);
    }
  };
  Spec spec;
  State state;
  Reading<msg::LaserScan> laser;  // handles, resolved once
  Actuator<msg::Twist> drive;

  Status init(const Description& robot) {
    SL_ASSIGN(laser, robot.reading<msg::LaserScan>(spec.laser));
    SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
    return {};
  }

  void step(const Observation& obs, Command& cmd) {
    if (spec.give_up_s > 0 && obs.now().s() >= spec.give_up_s) throw std::runtime_error("I give up");
    const auto scan = obs.get(laser);
    if (!scan.valid) return;
    double right_m = scan.message.range_max, ahead_m = right_m;
    for (std::size_t i = 0; i < scan.message.ranges.size(); ++i) {
      const double angle = scan.message.angle_min + static_cast<double>(i) * scan.message.angle_increment;
      const double range_m = std::max(
          0.0, static_cast<double>(scan.message.ranges[i]));  // -inf: too near (REP 117)
      if (std::abs(angle + 1.2) < 0.4) right_m = std::min(right_m, range_m);
      if (std::abs(angle) < 0.4) ahead_m = std::min(ahead_m, range_m);
    }
    const bool blocked = ahead_m < spec.distance_m;
    const double wanted = blocked ? 1.0 : std::clamp(2.0 * (spec.distance_m - right_m), -0.8, 0.8);
    state.turn_radps += 0.5 * (wanted - state.turn_radps);
    cmd.set(drive, msg::Twist{.linear = {blocked ? 0.0 : spec.speed_mps, 0, 0},
                              .angular = {0, 0, state.turn_radps}});
  }
};

constexpr ControllerKind wall = make_controller<Wall>(
    {.name = "wall", .help = "Follows the wall on its right."});

}  // namespace

SANDLOT_PLUGIN("my_controllers", &wall)
