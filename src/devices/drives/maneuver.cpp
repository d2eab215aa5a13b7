#include "devices/drives/maneuver.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "base/text.h"

namespace sandlot::maneuver {
namespace {

using msg::DriveManeuver;

/// Half of the tolerance, see the header.
constexpr double near_m = 5e-4, near_rad = 5e-4;
/// A limit above this is none, and what is taken then.
constexpr double no_limit = 100;
constexpr double usual_mps = 0.5, usual_radps = 1, usual_mps2 = 1, usual_radps2 = 2;
/// Time constant of the heading while a drive follows its way. A car, which has to roll for it, corrects it on the radius of
/// its tightest turn.
constexpr double heading_s = 0.1;
/// Slower than this a drive stands.
constexpr double standing_mps = 1e-3, standing_radps = 1e-3;
constexpr double driven_mps = 1e-3, stalled_mps = 1e-2, stalled_share = 0.1, stalled_s = 0.25;

double towards(double from, double to, double step) { return from + std::clamp(to - from, -step, step); }
/// Longest way and largest angle of a command. What a snapshot holds may be anything.
constexpr double most = 1e6;
double sane(double x) { return std::isfinite(x) ? std::clamp(x, -most, most) : 0; }
double acceleration(double limit, double usual) { return std::max(limit > no_limit ? usual : limit, 1e-6); }

/// Largest rate with which a drive that reacts after t still stops where nothing is left.
double approach(double left, double most, double acceleration, double t_s) {
  const double far = std::abs(left);
  const double rate = std::min(most, 2 * far / (t_s + std::sqrt(t_s * t_s + 2 * far / acceleration)));
  return left < 0 ? -rate : rate;
}

/// Whether a drive that has this left at this rate stops within the tolerance.
bool is_there(double left, double rate, double acceleration, double near, double response_s) {
  return std::abs(left) <= near && rate * rate <= acceleration * near && std::abs(rate) * response_s <= near;
}

/// Time after which a drive follows what is requested: the odometry may be a tick old.
double reaction_s(const Limits& limits, double tick_s) { return 2 * tick_s + limits.response_s; }

/// Acceleration that the drive attains, learnt while it stays behind the setpoint by more than its reaction and the resolution of
/// its odometry.
double attained(Ramp& ramp, double setpoint, double rate, double acceleration, double reaction_s, double edge,
                double tick_s) {
  constexpr double least_share = 0.2;
  ramp.time_s += tick_s;
  const double sign = setpoint < 0 ? -1 : 1;
  // Before that, a way that began in motion has no rate yet.
  if (ramp.time_s > reaction_s && sign * (setpoint - rate) > acceleration * reaction_s + edge / tick_s) {
    const double gained = sign * (rate - ramp.from) + acceleration * tick_s;
    ramp.share = std::clamp(gained / (acceleration * ramp.time_s), least_share, ramp.share);
  }
  return ramp.share * acceleration;
}

void slow_down(State& state, const Limits& limits, double tick_s) {
  const double a = acceleration(limits.acceleration_mps2, usual_mps2);
  const double alpha = acceleration(limits.angular_acceleration_radps2, usual_radps2);
  state.setpoint.x = towards(state.setpoint.x, 0, a * tick_s);
  state.setpoint.turn = towards(state.setpoint.turn, 0, alpha * tick_s);
}

/// Distance and angle of the arc that leads to (x, y) along the present heading; backward to what is behind.
struct Arc {
  double distance_m = 0, angle_rad = 0;
};
Arc arc_to(double x, double y) {
  const double chord = math::hypot(x, y);
  if (chord == 0) return {};
  const double half = x < 0 ? math::atan2(-y, -x) : math::atan2(y, x);
  // Half of the angle lies between chord and tangent; the arc is longer than the chord by h / sin(h).
  const double longer = std::abs(half) < 1e-4 ? 1 + half * half / 6 : half / math::sin(half);
  return x < 0 ? Arc{-chord * longer, 2 * half} : Arc{chord * longer, 2 * half};
}

/// A drive that can turn on the spot goes to a point on an arc where RoBIOS does.
bool by_arc(double x, double y, const std::optional<double>& max_curvature_pm) {
  return max_curvature_pm || x > std::abs(y);
}

}  // namespace

Status check(const DriveManeuver& command, std::optional<double> max_curvature_pm) {
  if (command.kind > DriveManeuver::stop)
    return Error{"there is no maneuver of kind " + std::to_string(command.kind),
                 "0 STRAIGHT, 1 TURN, 2 CURVE, 3 TO_POINT, 4 STOP"};
  for (const double x : {command.distance, command.angle, command.x, command.y})
    if (std::abs(x) > most) return Error{"the maneuver is too long", "at most 1e6 m or rad"};
  if (!max_curvature_pm) return {};
  const double tightest_m = 1 / std::max(*max_curvature_pm, 1e-9);
  Arc arc;
  if (command.kind == DriveManeuver::turn) arc = {0, command.angle};
  if (command.kind == DriveManeuver::curve) arc = {command.distance, command.angle};
  if (command.kind == DriveManeuver::to_point) arc = arc_to(command.x, command.y);
  if (std::abs(arc.angle_rad) * tightest_m <= std::abs(arc.distance_m) * (1 + 1e-9)) return {};
  const std::string hint = "the tightest turn has a radius of " + short_text(tightest_m) + " m";
  if (command.kind == DriveManeuver::turn) return Error{"a car does not turn on the spot", hint};
  return Error{"the curve is too tight for this car", hint};
}

Status Slot::assign(std::span<const std::byte> bytes) {
  DriveManeuver taken;
  SL_TRY(read_command(bytes, taken));
  SL_TRY(maneuver::check(taken, max_curvature_pm_));
  message = taken;
  return {};
}

Status Slot::check(std::span<const std::byte> bytes) const {
  DriveManeuver taken;
  SL_TRY(read_command(bytes, taken));
  return maneuver::check(taken, max_curvature_pm_);
}

Topics make_topics(const DeviceBuild& build, std::optional<double> max_curvature_pm) {
  auto command = std::make_unique<Slot>("/" + build.path + "/maneuver/command", max_curvature_pm);
  auto progress = std::make_unique<Topic<msg::DriveProgress>>("/" + build.path + "/maneuver");
  progress->message.header.frame_id = build.frame_id();
  const Topics made{command.get(), progress.get()};
  build.topics.adopt_command(std::move(command), late_level);
  build.topics.adopt_topic(std::move(progress), late_level);
  return made;
}

void begin(Boxed<Late>& late, const Slot& slot, const Limits& limits, const PlanarPose& now,
           const PlanarMotion& moving, std::size_t motors) {
  if (!late) late.emplace().maneuver.standing_s.resize(motors);
  State& state = late->maneuver;
  state.taken = slot.count;
  // A maneuver that follows another goes on from what that one has requested.
  begin(state, slot.message, limits, now, state.in_force ? PlanarMotion(state.setpoint) : moving);
}

void begin(State& state, const DriveManeuver& command, const Limits& limits, const PlanarPose& now,
           const PlanarMotion& moving) {
  ++state.begun;
  state.in_force = 1;
  state.done = 0;
  state.kind = std::min(command.kind, DriveManeuver::stop);  // a snapshot may hold anything
  const auto largest = [](double wanted, double limit, double usual) {
    wanted = std::abs(sane(wanted));
    if (wanted > 0) return std::min(wanted, limit);
    return limit > no_limit ? usual : limit;
  };
  state.speed_mps = largest(command.speed, limits.speed_mps, usual_mps);
  state.turning_rate_radps = largest(command.turning_rate, limits.turning_rate_radps, usual_radps);
  state.pose = now;
  state.heading_rad = now.theta_rad;
  state.way_m = 0;
  state.setpoint = {moving.x, 0, moving.turn};
  state.ramp = {};
  state.turning = 0;
  state.distance_m = state.angle_rad = state.x_m = state.y_m = 0;
  switch (state.kind) {
    case DriveManeuver::straight: state.distance_m = sane(command.distance); break;
    case DriveManeuver::turn:
      state.angle_rad = sane(command.angle);
      state.turning = 1;
      break;
    case DriveManeuver::curve:
      state.distance_m = sane(command.distance);
      state.angle_rad = sane(command.angle);
      state.turning = !limits.max_curvature_pm && std::abs(state.distance_m) < near_m;
      break;
    case DriveManeuver::to_point: {
      const double x = sane(command.x), y = sane(command.y);
      const auto [sine, cosine] = math::sincos(now.theta_rad);
      state.x_m = now.x_m + cosine * x - sine * y;
      state.y_m = now.y_m + sine * x + cosine * y;
      if (by_arc(x, y, limits.max_curvature_pm)) {
        const Arc arc = arc_to(x, y);
        state.distance_m = arc.distance_m;
        state.angle_rad = arc.angle_rad;
      } else if (const double far = math::hypot(x, y); far > near_m) {
        state.turning = 1;
        state.angle_rad = math::atan2(y, x);
        state.distance_m = far;
      }
      break;
    }
    default: break;
  }
  state.ramp.from = state.turning ? moving.turn : moving.x;
  state.remaining_m = state.turning && state.kind != DriveManeuver::to_point ? 0 : state.distance_m;
  state.remaining_rad = state.angle_rad;
}

void end(Boxed<Late>& late) {
  if (!in_force(late)) return;
  State& state = late->maneuver;
  state.in_force = 0;
  state.done = 1;
  state.turning = 0;
  state.remaining_m = state.remaining_rad = 0;
  state.setpoint = {};
}

namespace {

/// The drive of TO_POINT looks at its point: straight on to it from here.
void go_on_to_point(State& state) {
  const double x = state.x_m - state.pose.x_m, y = state.y_m - state.pose.y_m;
  state.turning = 0;
  state.distance_m = math::hypot(x, y);
  state.heading_rad = state.pose.theta_rad + math::wrap_angle(math::atan2(y, x) - state.pose.theta_rad);
  state.angle_rad = 0;
  state.way_m = 0;
  state.ramp = {};
}

void step_turn(State& state, const Limits& limits, double turning_radps, double tick_s) {
  const double a = acceleration(limits.acceleration_mps2, usual_mps2), t_s = reaction_s(limits, tick_s);
  double alpha = acceleration(limits.angular_acceleration_radps2, usual_radps2);
  alpha = attained(state.ramp, state.setpoint.turn, turning_radps, alpha, t_s, limits.edge_rad, tick_s);
  const double left = state.heading_rad + state.angle_rad - state.pose.theta_rad;
  state.remaining_rad = left;
  if (is_there(left, turning_radps, alpha, std::max(near_rad, limits.edge_rad), limits.response_s)) {
    slow_down(state, limits, tick_s);
    state.remaining_rad = 0;
    if (state.kind == DriveManeuver::to_point) return go_on_to_point(state);
    state.done = 1;
    return;
  }
  const double wanted = approach(left, state.turning_rate_radps, alpha, t_s);
  state.setpoint.turn = towards(state.setpoint.turn, wanted, alpha * tick_s);
  state.setpoint.x = towards(state.setpoint.x, 0, a * tick_s);
}

void step_way(State& state, const Limits& limits, double moving_mps, double tick_s) {
  double a = acceleration(limits.acceleration_mps2, usual_mps2);
  const double alpha = acceleration(limits.angular_acceleration_radps2, usual_radps2);
  double speed = state.speed_mps;
  const double curvature = state.distance_m != 0 ? state.angle_rad / state.distance_m : 0;
  if (curvature != 0) {
    const double rate = limits.turning_rate_radps > no_limit ? usual_radps : limits.turning_rate_radps;
    speed = std::min(speed, rate / std::abs(curvature));
    a = std::min(a, alpha / std::abs(curvature));
  }
  const double t_s = reaction_s(limits, tick_s);
  a = attained(state.ramp, state.setpoint.x, moving_mps, a, t_s, limits.edge_m, tick_s);
  const double left = state.distance_m - state.way_m;
  const double share = state.distance_m != 0 ? std::clamp(state.way_m / state.distance_m, 0.0, 1.0) : 1;
  const double off = state.heading_rad + state.angle_rad * share - state.pose.theta_rad;
  state.remaining_m = left;
  state.remaining_rad = state.heading_rad + state.angle_rad - state.pose.theta_rad;
  // A car cannot correct its heading without rolling on.
  const bool heading_counts = !limits.max_curvature_pm && state.angle_rad != 0;
  const bool heading_fits = !heading_counts ||
                            std::abs(state.remaining_rad) <= std::max(near_rad, limits.edge_rad);
  if (is_there(left, moving_mps, a, std::max(near_m, limits.edge_m), limits.response_s) && heading_fits) {
    state.done = 1;
    slow_down(state, limits, tick_s);
    state.remaining_m = state.remaining_rad = 0;
    return;
  }
  const double v = towards(state.setpoint.x, approach(left, speed, a, t_s), a * tick_s);
  double correction = off / std::max(heading_s, 2 * t_s);
  if (limits.max_curvature_pm) correction = off * std::abs(v) * *limits.max_curvature_pm;
  state.setpoint = {v, 0, curvature * v + correction};
}

void step_stop(State& state, const Limits& limits, double moving_mps, double turning_radps, double tick_s) {
  slow_down(state, limits, tick_s);
  state.done = state.setpoint == PlanarMotion{} && std::abs(moving_mps) < standing_mps &&
               std::abs(turning_radps) < standing_radps;
}

}  // namespace

void step(State& state, const Limits& limits, const PlanarPose& now, double tick_s) {
  const auto [sine, cosine] = math::sincos(0.5 * (state.pose.theta_rad + now.theta_rad));
  const double forward = cosine * (now.x_m - state.pose.x_m) + sine * (now.y_m - state.pose.y_m);
  const double turned = now.theta_rad - state.pose.theta_rad;
  state.pose = now;
  if (!state.turning) state.way_m += forward;
  if (state.done) {
    slow_down(state, limits, tick_s);
  } else if (state.kind == DriveManeuver::stop) {
    step_stop(state, limits, forward / tick_s, turned / tick_s, tick_s);
  } else if (state.turning) {
    step_turn(state, limits, turned / tick_s, tick_s);
  } else {
    step_way(state, limits, forward / tick_s, tick_s);
  }
}

void watch_motor(State& state, std::size_t motor, double wanted_mps, double turning_mps, double tick_s) {
  const double wanted = std::abs(wanted_mps), turning = std::abs(turning_mps);
  const bool stands = wanted >= driven_mps && turning < stalled_share * wanted && turning < stalled_mps;
  double& since = state.standing_s[motor];
  since = stands ? std::min(since + tick_s, 1.0) : 0;
}

bool ride(Boxed<Late>& late, const Topics& topics, const Limits& limits, const BodyState& base,
          const Context& context) {
  const bool fresh = is_new(late, *topics.command);
  if (!late && !fresh) return false;
  PlanarPose now{base.X_WB.p.x, base.X_WB.p.y, yaw_of(base.X_WB.q)};
  if (late)  // turns count
    now.theta_rad = late->maneuver.pose.theta_rad +
                    math::wrap_angle(now.theta_rad - late->maneuver.pose.theta_rad);
  if (fresh) {
    const double forward_mps = rotate_inverse(base.X_WB.q, base.V_WB.linear).x;
    begin(late, *topics.command, limits, now, {forward_mps, 0, base.V_WB.angular.z}, 0);
  }
  if (late->maneuver.in_force) step(late->maneuver, limits, now, context.tick.s());
  else late->maneuver.pose = now;
  publish(*topics.progress, late->maneuver, context.now);
  return late->maneuver.in_force;
}

void publish(Topic<msg::DriveProgress>& topic, const State& state, Time now) {
  msg::DriveProgress& message = topic.message;
  message.maneuvers = state.begun;
  message.kind = state.kind;
  message.done = state.done != 0;
  message.remaining_distance = state.remaining_m;
  message.remaining_angle = state.remaining_rad;
  message.stalled.clear();
  for (std::size_t i = 0; i < state.standing_s.size(); ++i)
    if (state.standing_s[i] >= stalled_s) message.stalled.push_back(static_cast<std::uint32_t>(i + 1));
  topic.publish(now);
}

bool fits(const Boxed<Late>& late, std::size_t motors) {
  if (!late) return true;
  const State& s = late->maneuver;
  bool sound = s.kind <= DriveManeuver::stop && s.standing_s.size() == motors;
  for (const double x :
       {s.distance_m, s.angle_rad, s.x_m, s.y_m, s.speed_mps, s.turning_rate_radps, s.heading_rad, s.way_m,
        s.pose.x_m, s.pose.y_m, s.pose.theta_rad, s.setpoint.x, s.setpoint.y, s.setpoint.turn, s.ramp.time_s,
        s.ramp.from, s.remaining_m, s.remaining_rad})
    sound = sound && std::abs(x) <= 1e10;
  sound = sound && s.ramp.time_s >= 0 && s.ramp.share > 0 && s.ramp.share <= 1;
  for (const double x : s.standing_s) sound = sound && x >= 0 && x <= 1;
  return sound;
}

}  // namespace sandlot::maneuver
