#include "controllers/diffusion/diffusion.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::diffusion {
namespace {

/// Mean of the readings as vectors along their directions, in S.
Vec3 mean_of(const msg::LaserScan& scan) {
  const std::vector<float>& readings = scan.intensities;
  if (std::none_of(readings.begin(), readings.end(), [](float r) { return r > 0; })) return {};
  // Directions one after the other by a rotation; over a ring its rounding is far below that of a float.
  const auto step = math::sincos(static_cast<double>(scan.angle_increment));
  auto at = math::sincos(static_cast<double>(scan.angle_min));
  Vec3 sum;
  for (const float r : readings) {
    const double reading = std::isfinite(r) ? r : 0;
    sum += Vec3{reading * at.cos, reading * at.sin, 0};
    const double cos = at.cos * step.cos - at.sin * step.sin;
    at.sin = at.sin * step.cos + at.cos * step.sin;
    at.cos = cos;
  }
  return sum / static_cast<double>(readings.size());
}

}  // namespace

Status Diffusion::init(const Description& robot) {
  SL_ASSIGN(proximity, robot.reading<msg::LaserScan>(spec.proximity));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  q_BS = robot.pose(proximity).q;
  return {};
}

void Diffusion::step(const Observation& obs, Command& cmd) {
  const auto seen = obs.get(proximity);
  msg::Twist twist;
  if (seen.valid) {
    const Vec3 near_B = rotate(q_BS, mean_of(seen.message));
    const bool free = near_B.x < 0 ||
                      near_B.x * near_B.x + near_B.y * near_B.y <= spec.threshold * spec.threshold;
    if (free) state.turning = 0;
    else if (state.turning == 0) state.turning = near_B.y > 0 ? -1 : 1;
    if (free) twist.linear.x = spec.speed_mps;
    else twist.angular.z = state.turning * spec.turn_speed_radps;
  }
  cmd.set(drive, twist);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Diffusion>({
    .name = "diffusion",
    .help = "Straight motion until a proximity sensor detects something, then a turn away from it.",
});

}  // namespace sandlot::controllers::diffusion
