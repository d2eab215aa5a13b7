#pragma once
/// Disturber: wanders about slowly and bumps strongly into whatever its proximity sensor finds in front of it.
///
/// Reads    a LaserScan of one or more beams: a proximity sensor. An echo nearer than `distance` is an obstacle.
/// Orders   a Twist for a drive that can turn on the spot.
/// Method   wander: `speed` along arcs whose curvature changes at random times. An obstacle: `bump_speed` straight ahead for
///          `bump_time`, then backwards as long at the speed of wandering, then a turn on the spot by a random angle.
/// Limits   it takes walls for obstacles, as a blind robot would.
/// Cost     one pass over the beams.
/// Errors   no such sensor or drive.
/// Source   Simulator for cooperation and competition of mobile robots, section 4: the perturbing robot.
#include "control/controller.h"

namespace sandlot::controllers::disturber {

struct Spec {
  std::string proximity, drive;
  double distance_m = 0.5;
  double speed_mps = 0.15;
  double turn_speed_radps = 1.5;
  double bump_speed_mps = 1;
  double bump_time_s = 0.8;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"proximity", "", "Proximity sensor or scanner to use; empty: the only one.", 0, 0,
                Field::none, 1000},
          s.proximity);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"distance", "m", "Distance at which an echo is an obstacle to bump into.", 0, 100, tunable},
          s.distance_m);
    visit(Field{"speed", "m/s", "Speed of wandering.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"bump_speed", "m/s", "Speed of bumping.", 0, 100, tunable}, s.bump_speed_mps);
    visit(Field{"bump_time", "s", "Time of bumping, and of backing off after it.", 0, 1000, tunable},
          s.bump_time_s);
  }
};

enum class Phase : std::uint8_t { wander, bump, back_off, turn };

inline std::span<const EnumName<Phase>> enum_names(Phase) {
  static constexpr EnumName<Phase> names[] = {
      {"wander", Phase::wander}, {"bump", Phase::bump}, {"back_off", Phase::back_off}, {"turn", Phase::turn}};
  return names;
}

struct State {
  Phase phase = Phase::wander;
  Time until;  ///< when the phase ends; of wandering: when the curvature changes
  double turn_radps = 0;
  std::uint32_t bumps = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"phase", "", "What it does: wander, bump, back_off or turn."}, s.phase);
    visit(Field{"until", "s", "Time at which that ends, or the turning rate changes."}, s.until);
    visit(Field{"turn", "rad/s", "Turning rate."}, s.turn_radps);
    visit(Field{"bumps", "1", "Times that it has bumped into something."}, s.bumps);
  }
};

struct Disturber {
  using Spec = disturber::Spec;
  using State = disturber::State;
  Spec spec;
  State state;

  Reading<msg::LaserScan> proximity;
  Actuator<msg::Twist> drive;

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);

 private:
  bool obstacle(const Observation& obs) const;
};

extern const ControllerKind kind;

}  // namespace sandlot::controllers::disturber
