#include "controllers/disturber/disturber.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot::controllers::disturber {
namespace {

constexpr double shortest_arc_s = 1, longest_arc_s = 4;

}  // namespace

Status Disturber::init(const Description& robot) {
  SL_ASSIGN(proximity, robot.reading<msg::LaserScan>(spec.proximity));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  return {};
}

bool Disturber::obstacle(const Observation& obs) const {
  const auto scan = obs.get(proximity);
  return scan.valid && std::any_of(scan.message.ranges.begin(), scan.message.ranges.end(),
                                   [&](float range_m) { return range_m < spec.distance_m; });
}

void Disturber::step(const Observation& obs, Command& cmd) {
  Stream random = obs.random();
  const Time now = obs.now();
  const auto enter = [&](Phase phase, double seconds) {
    state.phase = phase;
    state.until = now + Time::from_s(seconds);
  };
  if (state.phase == Phase::wander && obstacle(obs)) {
    ++state.bumps;
    enter(Phase::bump, spec.bump_time_s);
  } else if (now >= state.until) {
    switch (state.phase) {
      case Phase::bump: enter(Phase::back_off, spec.bump_time_s); break;
      case Phase::back_off: {
        const double angle = random.uniform(math::pi / 4, math::pi);
        state.turn_radps = random.below(2) == 0 ? spec.turn_speed_radps : -spec.turn_speed_radps;
        enter(Phase::turn, angle / spec.turn_speed_radps);
        break;
      }
      case Phase::turn:
      case Phase::wander:
        state.turn_radps = random.uniform(-0.4, 0.4) * spec.turn_speed_radps;
        enter(Phase::wander, random.uniform(shortest_arc_s, longest_arc_s));
        break;
    }
  }
  msg::Twist twist;
  switch (state.phase) {
    case Phase::wander:
      twist.linear.x = spec.speed_mps;
      twist.angular.z = state.turn_radps;
      break;
    case Phase::bump: twist.linear.x = spec.bump_speed_mps; break;
    case Phase::back_off: twist.linear.x = -spec.speed_mps; break;
    case Phase::turn: twist.angular.z = state.turn_radps; break;
  }
  cmd.set(drive, twist);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Disturber>({
    .name = "disturber",
    .help = "Wanders about slowly and bumps strongly into what stands in its way.",
});

}  // namespace sandlot::controllers::disturber
