#include "kinematics/kabsch.h"

#include <array>
#include <cmath>
#include <utility>

#include "base/math.h"

namespace sandlot::kinematics {
namespace {

/// Fits n pairs that `pair(i)` gives as {before, after}.
template <class Pair>
RigidFit fit(std::size_t n, Pair&& pair) {
  double px = 0, py = 0, qx = 0, qy = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto [p, q] = pair(i);
    px += p.x, py += p.y, qx += q.x, qy += q.y;
  }
  const double count = static_cast<double>(n);
  px /= count, py /= count, qx /= count, qy /= count;
  double cross = 0, dot = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto [p, q] = pair(i);
    cross += (p.x - px) * (q.y - qy) - (p.y - py) * (q.x - qx);
    dot += (p.x - px) * (q.x - qx) + (p.y - py) * (q.y - qy);
  }
  RigidFit out;
  out.turn_rad = math::atan2(cross, dot);
  const auto [s, c] = math::sincos(out.turn_rad);
  out.x_m = qx - (c * px - s * py);
  out.y_m = qy - (s * px + c * py);
  double squares = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto [p, q] = pair(i);
    const double dx = c * p.x - s * p.y + out.x_m - q.x, dy = s * p.x + c * p.y + out.y_m - q.y;
    squares += dx * dx + dy * dy;
  }
  out.rmsd_m = std::sqrt(squares / count);
  return out;
}

double sinc(double x) { return std::abs(x) < 1e-4 ? 1 - x * x / 6 : math::sin(x) / x; }

}  // namespace

RigidFit kabsch(std::span<const Direction> before, std::span<const Direction> after) {
  SL_CHECK(before.size() == after.size() && before.size() >= 2);
  return fit(before.size(), [&](std::size_t i) { return std::pair(before[i], after[i]); });
}

Estimate rolled(std::span<const Wheel> wheels, std::span<const double> turns) {
  SL_CHECK(wheels.size() == turns.size());
  std::array<std::size_t, 64> counted{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < wheels.size() && n < counted.size(); ++i)
    if (wheels[i].counted) counted[n++] = i;
  RigidFit found;
  for (int pass = 0; pass < 3; ++pass) {
    const double half = 0.5 * found.turn_rad, shrink = sinc(half);
    const math::SinCos turned = math::sincos(half);
    const double s = turned.sin, c = turned.cos;
    found = fit(n, [&](std::size_t k) {
      const Wheel& w = wheels[counted[k]];
      const double chord = shrink * w.radius_m * turns[counted[k]];
      const Direction p{w.x_m, w.y_m};
      return std::pair(p, Direction{p.x + chord * (c * w.along.x - s * w.along.y),
                                    p.y + chord * (s * w.along.x + c * w.along.y)});
    });
  }
  // The displacement whose exact arc ends there: the chord turned back by half the turn, stretched to the
  // arc.
  const double half = 0.5 * found.turn_rad, stretch = 1 / sinc(half);
  const auto [s, c] = math::sincos(half);
  return {
      {stretch * (c * found.x_m + s * found.y_m), stretch * (-s * found.x_m + c * found.y_m), found.turn_rad},
      found.rmsd_m};
}

}  // namespace sandlot::kinematics
