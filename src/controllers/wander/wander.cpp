#include "controllers/wander/wander.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::wander {
namespace {

constexpr double sector_rad = 3 * math::pi / 180;
constexpr double widest_heading_rad = 100 * math::pi / 180;
constexpr double heading_step_rad = 5 * math::pi / 180;
/// Below this free length a heading counts as blocked.
constexpr double blocked_m = 0.15;
/// Above this the way ahead is clear enough to end a turn on the spot.
constexpr double clear_m = 0.6;
/// A scanner that sees no less than this needs no memory: obstacles at the side or behind cannot be hit.
constexpr double wide_view_rad = 200 * math::pi / 180;
constexpr double memory_m = 1.2;
constexpr float memory_s = 3;
constexpr std::size_t memory_size = 240;
constexpr std::size_t most_sectors = 121;  // of a full turn
constexpr std::size_t edge_sectors = 5;
/// Echoes within this share of the radius are of the robot itself: whatever it touches is farther out.
constexpr double own_share = 0.9;
constexpr double back_s = 1.0;
constexpr double back_mps = 0.15;

}  // namespace

void Sectors::learn_own_body(const msg::LaserScan& scan, const Pose& X_BS, double own_radius_m) {
  own_m.assign(scan.ranges.size(), 0);
  const double ox = X_BS.p.x, oy = X_BS.p.y, yaw = yaw_of(X_BS.q);
  const double power = ox * ox + oy * oy - own_radius_m * own_radius_m;
  if (power >= 0) return;  // a scanner outside the circle sees its robot, if at all, like anything else
  for (std::size_t i = 0; i < own_m.size(); ++i) {
    const auto [s, c] = math::sincos(yaw + scan.angle_min + static_cast<double>(i) * scan.angle_increment);
    const double along = ox * c + oy * s;
    own_m[i] = static_cast<float>(std::sqrt(along * along - power) - along);
  }
}

void Sectors::fill(const msg::LaserScan& scan, const Pose& X_BS) {
  const auto beams = scan.ranges.size();
  const double first = scan.angle_min, step = scan.angle_increment;
  const double span = beams > 1 ? static_cast<double>(beams - 1) * std::abs(step) : 0;
  const double low = step < 0 ? first - span : first;
  const auto count = static_cast<std::size_t>(
      std::max(1.0, std::ceil(std::min(span, math::tau) / sector_rad - 1e-3)));
  const double width = span / static_cast<double>(count);

  max_m = scan.range_max;
  constexpr float empty = -1;
  distance_m.assign(count, empty);
  for (std::size_t i = 0; i < beams; ++i) {
    float range = scan.ranges[i];
    if (std::isnan(range)) continue;
    if (range > 0 && i < own_m.size() && range < own_m[i]) continue;  // a mast or post of its own
    range = std::clamp(range, 0.0f, scan.range_max);                  // -inf, too near, becomes 0
    const double bearing = first + static_cast<double>(i) * step;
    const double place = width > 0 ? (bearing - low) / width : 0;
    const std::size_t k = std::min(count - 1, static_cast<std::size_t>(std::max(0.0, place)));
    if (distance_m[k] == empty || range < distance_m[k]) distance_m[k] = range;
  }
  // Sparse beams: a sector between two of them takes the nearer echo, as an obstacle may reach that far.
  float left = empty;
  for (std::size_t k = 0, next = 0; k < count; ++k) {
    if (distance_m[k] != empty) {
      left = distance_m[k];
      continue;
    }
    next = std::max(next, k);
    while (next < count && distance_m[next] == empty) ++next;
    const float right = next < count ? distance_m[next] : left;
    distance_m[k] = left == empty ? right : right == empty ? left : std::min(left, right);
    if (distance_m[k] == empty) distance_m[k] = 0;  // not one valid beam: as good as blind
  }

  const double yaw = yaw_of(X_BS.q);
  first_rad = low + yaw;
  last_rad = low + span + yaw;
  echoes.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const auto [s, c] = math::sincos(low + (static_cast<double>(k) + 0.5) * width);
    const double range = distance_m[k];
    const Vec3 p = X_BS * Vec3{range * c, range * s, 0};
    echoes.push_back({p.x, p.y, std::sqrt(p.x * p.x + p.y * p.y), range < scan.range_max});
  }
}

double Sectors::corridor_m(double heading_rad, double half_width_m, double most_m) const {
  const auto [s, c] = math::sincos(heading_rad);
  double free_m = most_m;
  for (const Echo& echo : echoes) {
    if (!echo.seen) continue;
    const double along = echo.x_m * c + echo.y_m * s;
    const double across = std::abs(echo.y_m * c - echo.x_m * s);
    if (along <= 0 || across >= half_width_m) continue;
    free_m = std::min(free_m, along - std::sqrt(half_width_m * half_width_m - across * across));
  }
  return std::max(free_m, 0.0);
}

Status Wander::init(const Description& robot) {
  SL_ASSIGN(laser, robot.reading<msg::LaserScan>(spec.laser));
  SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.drive));
  X_BS = robot.pose(laser);
  period_s = robot.control_period_s;
  state.memory.reserve(memory_size);  // it fills up slowly, and a running robot shall cost no heap
  sectors.echoes.reserve(most_sectors + memory_size);
  state.before.reserve(most_sectors);
  return {};
}

void Wander::enter(Mode mode, Stream& random) {
  state.mode = mode;
  state.mode_s = 0;
  state.driven_m = state.turned_rad = 0;
  state.before.clear();
  // Up to half a turn more than needed: without it the robot would run the same round for ever.
  if (mode == Mode::turn) state.turn_min_s = random.uniform() * math::pi / spec.turn_speed_radps;
}

/// Keeps near echoes that leave the view: the robot may still turn into them.
void Wander::remember() {
  if (sectors.last_rad - sectors.first_rad >= wide_view_rad) {
    state.memory.clear();
    return;
  }
  const math::SinCos turned = math::sincos(-state.omega_radps * period_s);
  const double dx = state.v_mps * period_s;
  const Pose X_SB = inverse(X_BS);
  const double yaw = yaw_of(X_BS.q);
  std::erase_if(state.memory, [&](std::array<float, 3>& echo) {
    const double x = echo[0] - dx, y = echo[1];
    echo = {static_cast<float>(x * turned.cos - y * turned.sin),
            static_cast<float>(x * turned.sin + y * turned.cos), echo[2] + static_cast<float>(period_s)};
    const Vec3 p_S = X_SB * Vec3{echo[0], echo[1], 0};
    const double bearing = math::wrap_angle(math::atan2(p_S.y, p_S.x) + yaw);
    const bool in_view = bearing > sectors.first_rad && bearing < sectors.last_rad;
    return in_view || echo[2] > memory_s || echo[0] * echo[0] + echo[1] * echo[1] > memory_m * memory_m;
  });
  const std::size_t count = sectors.echoes.size();
  for (std::size_t k = 0; k < count; ++k) {
    const Sectors::Echo& echo = sectors.echoes[k];
    if ((k >= edge_sectors && k + edge_sectors < count) || !echo.seen || echo.range_m > memory_m) continue;
    if (state.memory.size() >= memory_size) state.memory.erase(state.memory.begin());
    state.memory.push_back({static_cast<float>(echo.x_m), static_cast<float>(echo.y_m), 0});
  }
  for (const auto& [x, y, age] : state.memory)
    sectors.echoes.push_back({x, y, std::sqrt(x * x + y * y), true});
}

/// The barrier: no echo may come nearer than it can be braked for.
double Wander::safe_speed(double wanted_mps) const {
  const double sign = wanted_mps < 0 ? -1.0 : 1.0;
  double speed = std::abs(wanted_mps);
  for (const Sectors::Echo& echo : sectors.echoes) {
    const double towards = sign * echo.x_m;
    if (!echo.seen || towards <= 0) continue;
    const double gap = std::max(0.0, echo.range_m - spec.radius_m - 0.5 * spec.margin_m);
    speed = std::min(speed, gap / spec.reaction_s * echo.range_m / towards);
  }
  return sign * speed;
}

Wander::Motion Wander::cruise(Stream& random) {
  state.favourite_left_s -= period_s;
  if (state.favourite_left_s <= 0) {
    state.favourite_rad = random.uniform(-1.0, 1.0);
    state.favourite_left_s = random.uniform(2.0, 6.0);
    // Now and then it looks round: without that it can run the same round of one room for minutes.
    if (random.below(6) == 0) {
      state.turn_sign = random.below(2) == 0 ? 1.0 : -1.0;
      enter(Mode::turn, random);
      return turn(random);
    }
  }
  const double half_width = spec.radius_m + spec.margin_m;
  const double right = std::max(-widest_heading_rad, sectors.first_rad),
               left = std::min(widest_heading_rad, sectors.last_rad);
  double best_score = -1e9, best_rad = 0, best_m = 0, free_right = 0, free_left = 0;
  for (double heading = -widest_heading_rad; heading <= widest_heading_rad + 1e-9;
       heading += heading_step_rad) {
    if (heading < right || heading > left) continue;
    const double free_m = sectors.corridor_m(heading, half_width, spec.lookahead_m);
    (heading < 0 ? free_right : free_left) += free_m;
    const double score = free_m / spec.lookahead_m -
                         0.5 * std::abs(heading - state.favourite_rad) / (math::pi / 2) -
                         0.2 * std::abs(heading - state.heading_rad) / (math::pi / 2);
    if (free_m >= blocked_m && score > best_score) {
      best_score = score;
      best_rad = heading;
      best_m = free_m;
    }
  }
  if (best_m < blocked_m) {
    // Both sides alike, as in a corner: toss a coin.
    const double difference = free_left - free_right;
    const bool coin = random.below(2) == 0;
    state.turn_sign = std::abs(difference) < 0.1 ? (coin ? 1.0 : -1.0) : difference > 0 ? 1.0 : -1.0;
    enter(Mode::turn, random);
    return turn(random);
  }
  state.heading_rad = best_rad;
  // Slower where there is less room, and the more it has to turn; with a narrow view it must not turn into what it
  // has just lost sight of.
  const double view = std::min(math::pi / 2, std::max(0.3, std::min(-right, left)));
  const double room = std::min(1.0, best_m / (0.5 * spec.lookahead_m));
  const double straight = std::max(0.0, 1.0 - std::abs(best_rad) / view);
  return {safe_speed(spec.speed_mps * room * straight),
          std::clamp(2.0 * best_rad, -spec.turn_speed_radps, spec.turn_speed_radps)};
}

Wander::Motion Wander::turn(Stream& random) {
  const double ahead = sectors.corridor_m(0, spec.radius_m + spec.margin_m, spec.lookahead_m);
  // In a tight place no direction is as clear as hoped for: after each full turn be content with less.
  const double turns = state.mode_s * spec.turn_speed_radps / math::tau;
  const double enough = std::max(blocked_m, clear_m * (1.5 - 0.5 * turns));
  if (state.mode_s >= state.turn_min_s && ahead >= std::min(enough, clear_m)) {
    state.heading_rad = 0;
    enter(Mode::cruise, random);
    return {};
  }
  if (turns > 3) {
    enter(Mode::back, random);
    return back();
  }
  return {0, state.turn_sign * spec.turn_speed_radps};
}

Wander::Motion Wander::back() { return {safe_speed(-back_mps), 0}; }

/// Compares what the scanner shows with what the orders should have done to it.
bool Wander::stuck() {
  const std::vector<float>& now = sectors.distance_m;
  if (state.before.size() != now.size()) {
    state.before = now;
    state.driven_m = state.turned_rad = 0;
    return false;
  }
  double change = 0;  // mean over all sectors
  for (std::size_t k = 0; k < now.size(); ++k)
    change += std::abs(now[k] - state.before[k]) / static_cast<double>(now.size());
  bool found = false;
  if (state.driven_m >= 0.25 && std::abs(state.turned_rad) < 0.1) {
    // Straight ahead the distance must have changed by what was driven, wherever the walls stand, unless another
    // thing came into line at the same distance; but then the rest of the scan has changed.
    const double width = (sectors.last_rad - sectors.first_rad) / static_cast<double>(now.size());
    const auto middle = static_cast<std::size_t>(
        std::clamp(-sectors.first_rad / width, 0.0, static_cast<double>(now.size() - 1)));
    const bool seen = now[middle] < sectors.max_m && state.before[middle] < sectors.max_m;
    found = seen && std::abs(now[middle] - state.before[middle]) < 0.3 * state.driven_m &&
            change < 0.15 * state.driven_m;
  } else if (std::abs(state.turned_rad) >= 0.8) {
    found = change < 0.03;
  } else if (state.driven_m < 1.0) {
    return false;  // not enough to judge yet
  }
  state.before = now;
  state.driven_m = state.turned_rad = 0;
  return found;
}

void Wander::step(const Observation& obs, Command& cmd) {
  const auto scan = obs.get(laser);
  state.blind_s = scan.fresh ? 0 : state.blind_s + period_s;
  Motion motion;
  if (scan.valid && state.blind_s < 1.0 && !scan.message.ranges.empty()) {
    Stream random = obs.random();
    if (sectors.own_m.size() != scan.message.ranges.size())
      sectors.learn_own_body(scan.message, X_BS, own_share * spec.radius_m);
    sectors.fill(scan.message, X_BS);
    remember();
    if (state.mode != Mode::back && scan.fresh && stuck()) enter(Mode::back, random);
    switch (state.mode) {
      case Mode::cruise: motion = cruise(random); break;
      case Mode::turn: motion = turn(random); break;
      case Mode::back:
        motion = back();
        if (state.mode_s >= back_s) {
          state.turn_sign = random.below(2) == 0 ? 1.0 : -1.0;
          enter(Mode::turn, random);
        }
        break;
    }
    state.mode_s += period_s;
    state.driven_m += std::abs(motion.v_mps) * period_s;
    state.turned_rad += motion.omega_radps * period_s;
  }
  state.v_mps = motion.v_mps;
  state.omega_radps = motion.omega_radps;
  msg::Twist twist;
  twist.linear.x = motion.v_mps;
  twist.angular.z = motion.omega_radps;
  cmd.set(drive, twist);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Wander>({
    .name = "wander",
    .help = "Wanders about without bumping into things, by a laser scan.",
});

}  // namespace sandlot::controllers::wander
