#include "validation/quasistatic.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::validation {

Twist least_dissipation(std::span<const Patch> patches, Push push) {
  // Each contact gives one or two rows a . (vx, vy, w) = c.
  const auto slip_of = [](const Patch& p, const Eigen::Vector3d& v) {
    const double x = v[0] - v[2] * p.y_m - p.sx_mps, y = v[1] + v[2] * p.x_m - p.sy_mps;
    return p.ex == 0 && p.ey == 0 ? std::sqrt(x * x + y * y) : std::abs(p.ex * x + p.ey * y);
  };
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  double total = 0;
  for (const Patch& p : patches) total += p.load;
  // Rounded off near d = 0, less and less: 1 m/s (least squares) at first, 1e-7 m/s at last.
  double round_mps = 1;
  for (int i = 0; i < 400; ++i) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b{total * push.x, total * push.y, 0};
    for (const Patch& p : patches) {
      const double slip = i == 0 ? 0 : slip_of(p, v);
      const double weight = p.load / std::sqrt(slip * slip + round_mps * round_mps);
      const auto add = [&](double ex, double ey) {
        const Eigen::Vector3d row{ex, ey, -ex * p.y_m + ey * p.x_m};
        a += weight * row * row.transpose();
        b += weight * (ex * p.sx_mps + ey * p.sy_mps) * row;
      };
      if (p.ex == 0 && p.ey == 0) {
        add(1, 0);
        add(0, 1);
      } else {
        add(p.ex, p.ey);
      }
    }
    v = a.ldlt().solve(b);
    round_mps = std::max(1e-7, 0.93 * round_mps);
  }
  return {v[0], v[1], v[2]};
}

void add_wheel(std::vector<Patch>& patches, double x_m, double y_m, double half_width_m, double rim_mps,
               double load) {
  if (half_width_m == 0) {
    patches.push_back({.x_m = x_m, .y_m = y_m, .sx_mps = rim_mps, .load = load});
    return;
  }
  for (const double side : {1.0, -1.0})
    patches.push_back({.x_m = x_m, .y_m = y_m + side * half_width_m, .sx_mps = rim_mps, .load = 0.5 * load});
}

void add_mecanum_wheel(std::vector<Patch>& patches, double x_m, double y_m, double radius_m,
                       double roller_radius_m, int rollers, double angle_rad, double turned_rad,
                       double speed_radps) {
  // Roller 0 points ahead while the wheel's joint is at zero; turning forward it goes down.
  const double pitch = math::tau / rollers, past = turned_rad - 0.5 * math::pi;
  const double f = past - pitch * std::floor(past / pitch + 0.5);
  const math::SinCos a = math::sincos(angle_rad), t = math::sincos(f);
  const double ex = a.sin * t.cos, ey = a.cos, length = std::sqrt(ex * ex + ey * ey);
  patches.push_back({.x_m = x_m,
                     .y_m = y_m + (radius_m - roller_radius_m) * t.sin / t.cos * a.cos / a.sin,
                     .sx_mps = radius_m * speed_radps,
                     .ex = ex / length,
                     .ey = ey / length});
}

}  // namespace sandlot::validation
