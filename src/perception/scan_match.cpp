#include "perception/scan_match.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::perception {

ScanMatch match_scan(const msg::LaserScan& scan, const Pose& X_BL, std::span<const Wall> walls, Pose2 guess,
                     double reach_m) {
  std::vector<Vec3> points_B;
  points_B.reserve(scan.ranges.size());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const auto range = static_cast<double>(scan.ranges[i]);
    if (!std::isfinite(range) || !(range > 0)) continue;
    const auto [s, c] = math::sincos(static_cast<double>(scan.angle_min) +
                                     static_cast<double>(i) * static_cast<double>(scan.angle_increment));
    points_B.push_back(X_BL * Vec3{range * c, range * s, 0});
  }

  ScanMatch match{guess};
  double reach = reach_m, gain = 1;
  for (match.steps = 0; match.steps < 60 && !match.converged; ++match.steps) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double squares = 0;
    match.points = 0;
    const auto [s, c] = math::sincos(match.pose.theta);
    for (const Vec3 p : points_B) {
      const double rx = c * p.x - s * p.y, ry = s * p.x + c * p.y, x = match.pose.x + rx,
                   y = match.pose.y + ry;
      double best = reach, nx = 0, ny = 0, off = 0;
      for (const Wall& wall : walls) {
        const double dx = wall.x1 - wall.x0, dy = wall.y1 - wall.y0, length = math::hypot(dx, dy);
        if (!(length > 1e-9)) continue;
        const double along = ((x - wall.x0) * dx + (y - wall.y0) * dy) / (length * length),
                     t = std::clamp(along, 0.0, 1.0);
        const double distance = math::hypot(x - wall.x0 - t * dx, y - wall.y0 - t * dy);
        if (distance >= best) continue;
        best = distance;
        nx = -dy / length, ny = dx / length;
        off = (x - wall.x0) * nx + (y - wall.y0) * ny;
      }
      if (!(best < reach)) continue;
      const Eigen::Vector3d slope(nx, ny, -nx * ry + ny * rx);
      normal += slope * slope.transpose();
      right -= off * slope;
      squares += off * off;
      ++match.points;
    }
    if (match.points < 3) return match;
    match.rms_m = std::sqrt(squares / match.points);
    // Directions about which the walls give no information are left as they are.
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(normal);
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      const double strength = solver.eigenvalues()(i);
      if (strength < 1e-4 * solver.eigenvalues()(2)) continue;
      const Eigen::Vector3d axis = solver.eigenvectors().col(i);
      step += axis * (axis.dot(right) / strength);
    }
    // Points that switch between walls, which is about millimetres, would never let it rest.
    if (match.steps >= 15) step *= gain *= 0.8;
    match.pose.x += step(0);
    match.pose.y += step(1);
    match.pose.theta = math::wrap_angle(match.pose.theta + step(2));
    match.converged = step.head<2>().norm() < 1e-5 && std::abs(step(2)) < 1e-5;
    // Once it lies about right, what is far from all walls is not a wall: people, other robots.
    reach = std::clamp(4 * match.rms_m, 0.1, reach);
  }
  return match;
}

}  // namespace sandlot::perception
