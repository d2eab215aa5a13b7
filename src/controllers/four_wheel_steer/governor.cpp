#include "controllers/four_wheel_steer/governor.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/math.h"

namespace sandlot::controllers::four_wheel_steer {
namespace {

/// Commands beyond this [m/s, rad/s] are scaled to it first, so that squares stay finite.
constexpr double largest_command = 1e6;
/// A wheel whose point moves slower than this keeps its angle: the centre of rotation lies on it.
constexpr double no_direction_mps = 1e-6;
/// Part of its pace at which the motion goes on where the steering rate would stop it.
constexpr double least_pace = 1.0 / 16;

Motion bounded(const Motion& v) {
  if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.turn)) return {};
  const double most = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.turn)});
  return most > largest_command ? (largest_command / most) * v : v;
}

}  // namespace

Governor::Governor(std::vector<Wheel> wheels, const Limits& limits)
    : wheels_(std::move(wheels)), limits_(limits), wanted_(wheels_.size()) {
  SL_CHECK(wheels_.size() >= 2 && wheels_.size() <= most_wheels);
}

Setting Governor::start(std::span<const double> steering_rad) const {
  SL_CHECK(steering_rad.size() == wheels_.size());
  Setting setting;
  setting.backward.assign(wheels_.size(), 0);
  for (const double rad : steering_rad)
    setting.steering_rad.push_back(std::clamp(rad, limits_.steering_lower_rad, limits_.steering_upper_rad));
  return setting;
}

bool Governor::fits(const Setting& setting) const {
  const auto is_small = [](double x) { return std::abs(x) < 1e9; };
  return setting.steering_rad.size() == wheels_.size() && setting.backward.size() == wheels_.size() &&
         std::all_of(setting.steering_rad.begin(), setting.steering_rad.end(), is_small) &&
         is_small(setting.motion.x) && is_small(setting.motion.y) && is_small(setting.motion.turn) &&
         setting.phase <= Phase::braking;
}

SteeringAngle Governor::angle_for(Vec2 velocity, double now_rad, bool backward) const {
  if (dot(velocity, velocity) < no_direction_mps * no_direction_mps) return {now_rad, backward, true};
  const double lower = limits_.steering_lower_rad, upper = limits_.steering_upper_rad;
  // Angles along this line are nearest + k pi; with k odd the wheel turns backward.
  const double nearest = now_rad + math::wrap_angle(math::atan2(velocity.y, velocity.x) - now_rad);
  SteeringAngle best{now_rad, backward, false};
  double least = 0;
  for (int k = -2; k <= 2; ++k) {
    const double rad = nearest + k * math::pi, inside = std::clamp(rad, lower, upper);
    const double beyond = std::abs(rad - inside);
    if (beyond > limits_.hysteresis_rad) continue;
    const bool turns_back = k % 2 != 0;
    constexpr double rounding = 1e-9;
    const double cost = std::abs(inside - now_rad) + (turns_back != backward ? limits_.hysteresis_rad : 0) +
                        (beyond > rounding ? limits_.hysteresis_rad : 0);
    if (!best.reachable || cost < least) best = {inside, turns_back, true}, least = cost;
  }
  return best;
}

double Governor::aim(const Motion& motion, const Setting& setting) {
  double farthest = 0;
  for (std::size_t i = 0; i < wheels_.size(); ++i) {
    wanted_[i] = angle_for(wheel_velocity(motion, wheels_[i]), setting.steering_rad[i],
                           setting.backward[i] != 0);
    farthest = std::max(farthest, std::abs(wanted_[i].rad - setting.steering_rad[i]));
  }
  return farthest;
}

Motion Governor::within_speed(const Motion& command, double& scale) const {
  double most_mps = 0, most_radps = 0;
  for (const Wheel& wheel : wheels_) {
    const Vec2 u = wheel_velocity(command, wheel);
    const double speed = std::sqrt(dot(u, u));
    most_mps = std::max(most_mps, speed);
    most_radps = std::max(most_radps, speed / wheel.radius_m);
  }
  scale = most_radps > limits_.max_wheel_speed_radps ? limits_.max_wheel_speed_radps / most_radps : 1;
  return most_mps < limits_.smallest_speed_mps ? Motion{} : scale * command;
}

double Governor::pace(const Motion& from, const Motion& to, double dt_s) const {
  const Motion change = to - from;
  double part = 1;
  for (const Wheel& wheel : wheels_) {
    const Vec2 u = wheel_velocity(change, wheel);
    const double wanted = std::sqrt(dot(u, u));
    const double most = limits_.max_wheel_acceleration_radps2 * wheel.radius_m * dt_s;
    if (part * wanted > most) part = most / wanted;
  }
  return part;
}

void Governor::brake(double dt_s, Setting& setting) const {
  const double part = pace(setting.motion, {}, dt_s);
  setting.motion = part < 1 ? (1 - part) * setting.motion : Motion{};
}

/// Moves the set points towards wanted_, all by the same part of their way.
void Governor::steer(double dt_s, double farthest_rad, Setting& setting) const {
  const double most = limits_.max_steering_rate_radps * dt_s;
  const double part = farthest_rad > most ? most / farthest_rad : 1;
  for (std::size_t i = 0; i < wheels_.size(); ++i) {
    double& rad = setting.steering_rad[i];
    rad = part < 1 ? rad + part * (wanted_[i].rad - rad) : wanted_[i].rad;
    setting.backward[i] = wanted_[i].backward ? 1 : 0;
  }
}

/// Goes on towards a motion while the wheels roll.
void Governor::drive(const Motion& goal, double dt_s, Setting& setting) {
  const Motion from = setting.motion;
  const auto on_the_way = [&](double part) { return part < 1 ? from + part * (goal - from) : goal; };
  double part = pace(from, goal, dt_s);
  double farthest = aim(on_the_way(part), setting);
  const bool reachable = std::all_of(wanted_.begin(), wanted_.end(),
                                     [](const SteeringAngle& angle) { return angle.reachable; });
  const bool at_rest = from == Motion{};
  if (!reachable || farthest > (at_rest ? limits_.aligned_rad : limits_.steer_first_rad)) {
    setting.phase = at_rest ? Phase::steering : Phase::braking;
    return at_rest ? steer(dt_s, farthest, setting) : brake(dt_s, setting);
  }
  // The set points may go at their rate: the part of the way after which they have gone no farther.
  const double most = limits_.max_steering_rate_radps * dt_s;
  if (farthest > most && !at_rest) {
    double low = 0, high = part;
    for (int k = 0; k < 12; ++k) {
      const double middle = 0.5 * (low + high);
      (aim(on_the_way(middle), setting) > most ? high : low) = middle;
    }
    part = std::max(low, least_pace * part);
    farthest = aim(on_the_way(part), setting);
  }
  setting.phase = Phase::driving;
  setting.motion = on_the_way(part);
  steer(dt_s, farthest, setting);
}

void Governor::step(const Motion& command, std::span<const double> steering_rad, double dt_s,
                    Setting& setting, Orders& out) {
  SL_CHECK(steering_rad.size() == wheels_.size() && dt_s > 0);
  const Motion before = setting.motion;
  Motion target = within_speed(bounded(command), out.scale);
  out.mode = mode_of(target);
  const auto error = [&] {
    double most = 0;
    for (std::size_t i = 0; i < wheels_.size(); ++i)
      most = std::max(most, std::abs(setting.steering_rad[i] - steering_rad[i]));
    return most;
  };
  out.error_rad = error();
  out.reachable = true;
  const double farthest = aim(target, setting);
  for (const SteeringAngle& angle : wanted_) out.reachable = out.reachable && angle.reachable;
  if (!out.reachable) target = {};

  const bool at_rest = setting.motion == Motion{};
  if (target == Motion{}) {
    brake(dt_s, setting);
    setting.phase = setting.motion == Motion{} ? Phase::standing : Phase::braking;
  } else if (at_rest) {
    // The error that counts is that from the angles of the command.
    double off = 0;
    for (std::size_t i = 0; i < wheels_.size(); ++i)
      off = std::max(off, std::abs(wanted_[i].rad - steering_rad[i]));
    if (off > limits_.aligned_rad) {
      setting.phase = Phase::steering;
      steer(dt_s, farthest, setting);
    } else {
      drive(target, dt_s, setting);
    }
  } else if (out.error_rad >
             (setting.phase == Phase::braking ? 0.5 * limits_.steer_first_rad : limits_.steer_first_rad)) {
    setting.phase = Phase::braking;
    brake(dt_s, setting);
  } else {
    drive(math::cos(out.error_rad) * target, dt_s, setting);
  }

  out.change = (1 / dt_s) * (setting.motion - before);
  out.rate_radps.resize(wheels_.size());
  for (std::size_t i = 0; i < wheels_.size(); ++i) {
    const auto [s, c] = math::sincos(setting.steering_rad[i]);
    out.rate_radps[i] = dot(wheel_velocity(setting.motion, wheels_[i]), {c, s}) / wheels_[i].radius_m;
  }
}

}  // namespace sandlot::controllers::four_wheel_steer
