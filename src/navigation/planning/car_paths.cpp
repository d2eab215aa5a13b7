#include "navigation/planning/car_paths.h"

#include <cmath>
#include <limits>
#include <span>

namespace sandlot::navigation {
namespace {

constexpr double car_rounding = 1e-12, car_quarter = math::pi / 2;

struct CarPolar {
  double r, angle;
};
CarPolar car_polar(double x, double y) { return {math::hypot(x, y), math::atan2(y, x)}; }

/// Goal in the frame of the start, in radii; sine and cosine of its heading.
struct CarGoal {
  double x, y, phi, sin, cos;
};
CarGoal car_goal(double x, double y, double phi) {
  const auto [s, c] = math::sincos(phi);
  return {x, y, phi, s, c};
}

/// Lengths of a word's free parts; false where the word does not exist.
struct CarWord {
  bool exists = false;
  double t = 0, u = 0, v = 0;
};
CarWord car_word(double t, double u, double v, bool exists) { return {exists, t, u, v}; }

CarWord car_lsl(const CarGoal& g) {  // 8.1
  const auto [u, t] = car_polar(g.x - g.sin, g.y - 1 + g.cos);
  const double v = math::wrap_angle(g.phi - t);
  return car_word(t, u, v, t >= -car_rounding && v >= -car_rounding);
}
CarWord car_lsr(const CarGoal& g) {  // 8.2
  const auto [r, angle] = car_polar(g.x + g.sin, g.y - 1 - g.cos);
  if (r < 2) return {};
  const double u = std::sqrt(r * r - 4), t = math::wrap_angle(angle + math::atan2(2, u)),
               v = math::wrap_angle(t - g.phi);
  return car_word(t, u, v, t >= -car_rounding && v >= -car_rounding);
}
CarWord car_lrl(const CarGoal& g) {  // 8.3, 8.4
  const auto [r, angle] = car_polar(g.x - g.sin, g.y - 1 + g.cos);
  if (r > 4) return {};
  const double u = -2 * math::asin(0.25 * r), t = math::wrap_angle(angle + 0.5 * u + math::pi),
               v = math::wrap_angle(g.phi - t + u);
  return car_word(t, u, v, t >= -car_rounding && u <= car_rounding);
}
CarWord car_tau_omega(double u, double v, double xi, double eta, double phi) {
  const double delta = math::wrap_angle(u - v), a = math::sin(u) - math::sin(delta),
               b = math::cos(u) - math::cos(delta) - 1, t1 = math::atan2(eta * a - xi * b, xi * a + eta * b),
               t2 = 2 * (math::cos(delta) - math::cos(v) - math::cos(u)) + 3,
               tau = math::wrap_angle(t2 < 0 ? t1 + math::pi : t1),
               omega = math::wrap_angle(tau - u + v - phi);
  return car_word(tau, u, omega, tau >= -car_rounding);
}
CarWord car_lrlr_changing(const CarGoal& g) {  // 8.7
  const double xi = g.x + g.sin, eta = g.y - 1 - g.cos, rho = 0.25 * (2 + math::hypot(xi, eta));
  if (rho > 1) return {};
  const double u = math::acos(rho);
  CarWord word = car_tau_omega(u, -u, xi, eta, g.phi);
  word.exists = word.exists && word.v <= car_rounding;
  return word;
}
CarWord car_lrlr_same(const CarGoal& g) {  // 8.8
  const double xi = g.x + g.sin, eta = g.y - 1 - g.cos, rho = (20 - xi * xi - eta * eta) / 16;
  if (rho < 0 || rho > 1) return {};
  const double u = -math::acos(rho);
  CarWord word = car_tau_omega(u, u, xi, eta, g.phi);
  word.exists = word.exists && word.v >= -car_rounding;
  return word;
}
CarWord car_lrsl(const CarGoal& g) {  // 8.9
  const auto [rho, angle] = car_polar(g.x - g.sin, g.y - 1 + g.cos);
  if (rho < 2) return {};
  const double r = std::sqrt(rho * rho - 4), u = 2 - r, t = math::wrap_angle(angle + math::atan2(r, -2)),
               v = math::wrap_angle(g.phi - car_quarter - t);
  return car_word(t, u, v, t >= -car_rounding && u <= car_rounding && v <= car_rounding);
}
CarWord car_lrsr(const CarGoal& g) {  // 8.10
  const double xi = g.x + g.sin, eta = g.y - 1 - g.cos;
  const auto [rho, t] = car_polar(-eta, xi);
  if (rho < 2) return {};
  const double u = 2 - rho, v = math::wrap_angle(t + car_quarter - g.phi);
  return car_word(t, u, v, t >= -car_rounding && u <= car_rounding && v <= car_rounding);
}
CarWord car_lrslr(const CarGoal& g) {  // 8.11
  const double xi = g.x + g.sin, eta = g.y - 1 - g.cos, rho = math::hypot(xi, eta);
  if (rho < 2) return {};
  const double u = 4 - std::sqrt(rho * rho - 4);
  if (u > car_rounding) return {};
  const double t = math::wrap_angle(math::atan2((4 - u) * xi - 2 * eta, -2 * xi + (u - 4) * eta)),
               v = math::wrap_angle(t - g.phi);
  return car_word(t, u, v, t >= -car_rounding && v >= -car_rounding);
}

/// Keeps the cheapest of the words it is shown.
struct CarChoice {
  double radius;
  CarPrices prices;
  CarPath best;

  /// @param turns  L, S or R for each part
  /// @param parts  signed lengths in radii; negative: backward
  void offer(const char* turns, std::span<const double> parts, bool mirrored, bool flipped) {
    double price = 0, length = 0;
    int last = 0;
    for (double part : parts) {
      if (flipped) part = -part;
      const double size = std::abs(part);
      if (size < 1e-9) continue;
      const int way = part < 0 ? -1 : 1;
      price += size * radius * (way < 0 ? prices.backward_factor : 1) +
               (last && last != way ? prices.change : 0);
      length += size * radius;
      last = way;
    }
    if (!(price < best.price)) return;
    best.price = price;
    best.length_m = length;
    best.count = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const double part = flipped ? -parts[i] : parts[i];
      if (std::abs(part) < 1e-9) continue;
      const int side = turns[i] == 'S' ? 0 : (turns[i] == 'L') != mirrored ? 1 : -1;
      best.moves[static_cast<std::size_t>(best.count++)] = {
          {part < 0 ? -1.0 : 1.0, 0}, side / radius, std::abs(part) * radius};
    }
  }
};

bool car_valid(const Pose2& from, const Pose2& to, double radius) {
  return is_finite(from) && is_finite(to) && radius > 0 && std::isfinite(radius);
}

CarGoal car_relative(const Pose2& from, const Pose2& to, double radius) {
  const auto [s, c] = math::sincos(from.theta);
  const double dx = (to.x - from.x) / radius, dy = (to.y - from.y) / radius;
  return car_goal(c * dx + s * dy, -s * dx + c * dy, math::wrap_angle(to.theta - from.theta));
}

}  // namespace

CarPath reeds_shepp(const Pose2& from, const Pose2& to, double radius_m, const CarPrices& prices) {
  if (!car_valid(from, to, radius_m)) return {};
  CarChoice choice{radius_m, prices, {.price = std::numeric_limits<double>::infinity()}};
  const CarGoal goal = car_relative(from, to, radius_m);
  // Words come in fours: as they are, with time running back (flipped), mirrored, and both.
  for (int variant = 0; variant < 4; ++variant) {
    const bool flipped = variant & 1, mirrored = variant & 2;
    const double x = flipped ? -goal.x : goal.x, y = mirrored ? -goal.y : goal.y,
                 phi = flipped != mirrored ? -goal.phi : goal.phi;
    const CarGoal g = car_goal(x, y, phi);
    const auto offer = [&](const char* turns, std::initializer_list<double> parts) {
      choice.offer(turns, std::span(parts.begin(), parts.size()), mirrored, flipped);
    };
    if (const auto w = car_lsl(g); w.exists) offer("LSL", {w.t, w.u, w.v});
    if (const auto w = car_lsr(g); w.exists) offer("LSR", {w.t, w.u, w.v});
    if (const auto w = car_lrl(g); w.exists) offer("LRL", {w.t, w.u, w.v});
    if (const auto w = car_lrlr_changing(g); w.exists) offer("LRLR", {w.t, w.u, -w.u, w.v});
    if (const auto w = car_lrlr_same(g); w.exists) offer("LRLR", {w.t, w.u, w.u, w.v});
    if (const auto w = car_lrsl(g); w.exists) offer("LRSL", {w.t, -car_quarter, w.u, w.v});
    if (const auto w = car_lrsr(g); w.exists) offer("LRSR", {w.t, -car_quarter, w.u, w.v});
    if (const auto w = car_lrslr(g); w.exists) offer("LRSLR", {w.t, -car_quarter, w.u, -car_quarter, w.v});
    // The same words from the goal to the start, read in reverse order.
    const CarGoal b = car_goal(x * g.cos + y * g.sin, x * g.sin - y * g.cos, phi);
    if (const auto w = car_lrl(b); w.exists) offer("LRL", {w.v, w.u, w.t});
    if (const auto w = car_lrsl(b); w.exists) offer("LSRL", {w.v, w.u, -car_quarter, w.t});
    if (const auto w = car_lrsr(b); w.exists) offer("RSRL", {w.v, w.u, -car_quarter, w.t});
  }
  return choice.best;
}

CarPath dubins(const Pose2& from, const Pose2& to, double radius_m) {
  if (!car_valid(from, to, radius_m)) return {};
  CarChoice choice{radius_m, {}, {.price = std::numeric_limits<double>::infinity()}};
  const CarGoal goal = car_relative(from, to, radius_m);
  const auto turn = [](double angle) {
    const double a = angle - math::tau * std::floor(angle / math::tau);
    return a > math::tau - 1e-9 ? 0 : a;
  };
  for (const bool mirrored : {false, true}) {
    const CarGoal g = mirrored ? car_goal(goal.x, -goal.y, -goal.phi) : goal;
    const auto offer = [&](const char* turns, double t, double u, double v) {
      const double parts[] = {t, u, v};
      choice.offer(turns, parts, mirrored, false);
    };
    const auto [same_r, same] = car_polar(g.x - g.sin, g.y - 1 + g.cos);
    offer("LSL", turn(same), same_r, turn(g.phi - same));
    if (same_r <= 4) {
      // The middle turn is over half a circle; the line of centres has its heading half way through.
      const double u = math::tau - 2 * math::asin(same_r / 4), t = turn(same + u / 2);
      offer("LRL", t, u, turn(g.phi - t + u));
    }
    const auto [cross_r, cross] = car_polar(g.x + g.sin, g.y - 1 - g.cos);
    if (cross_r >= 2) {
      const double u = std::sqrt(cross_r * cross_r - 4), t = turn(cross + math::atan2(2, u));
      offer("LSR", t, u, turn(t - g.phi));
    }
  }
  return choice.best;
}

}  // namespace sandlot::navigation
