#include "navigation/localisation/scan_points.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::navigation {
namespace {

constexpr int scan_points_per_side = 20;
constexpr double scan_points_thickest_line = 0.05;

bool scan_points_mount_usable(const Pose& X) {
  const double norm = X.q.w * X.q.w + X.q.x * X.q.x + X.q.y * X.q.y + X.q.z * X.q.z;
  return is_finite(X) && std::abs(norm - 1) < 1e-3 && std::abs(X.p.x) <= 1e3 && std::abs(X.p.y) <= 1e3 &&
         std::abs(X.p.z) <= 1e3;
}

bool scan_points_scan_usable(const msg::LaserScan& scan) {
  constexpr float most = 1e3f;
  return std::abs(scan.angle_min) <= most && std::abs(scan.angle_increment) <= most &&
         !std::isnan(scan.range_min) && !std::isnan(scan.range_max);
}

}  // namespace

ScanFault take_points(const msg::LaserScan& scan, const Pose& X_BL, const ScanLimits& limits,
                      ScanPoints& out) {
  out.p_B.clear();
  out.normal_B.clear();
  if (!scan_points_scan_usable(scan)) return ScanFault::bad_scan;
  if (!scan_points_mount_usable(X_BL)) return ScanFault::bad_mount;
  out.laser_B = {X_BL.p.x, X_BL.p.y};
  const double nearest = std::max(limits.min_range_m, static_cast<double>(scan.range_min)),
               own_end = static_cast<double>(scan.range_max);
  const auto usable = [&](float range) {
    const auto r = static_cast<double>(range);
    return r > 0 && r >= nearest && r <= limits.max_range_m && r < own_end;  // NaN and infinities are not
  };
  const auto total = static_cast<std::size_t>(std::count_if(scan.ranges.begin(), scan.ranges.end(), usable));
  if (total == 0) return ScanFault::no_beams;
  const std::size_t most = std::min(total, static_cast<std::size_t>(std::max(limits.max_points, 1)));
  // Of `total` usable beams, number floor(k * total / most) for each k.
  std::size_t seen = 0;
  for (std::size_t i = 0; i < scan.ranges.size() && out.p_B.size() < most; ++i) {
    if (!usable(scan.ranges[i])) continue;
    if (seen++ != out.p_B.size() * total / most) continue;
    const auto range = static_cast<double>(scan.ranges[i]);
    const auto [s, c] = math::sincos(static_cast<double>(scan.angle_min) +
                                     static_cast<double>(i) * static_cast<double>(scan.angle_increment));
    const Vec3 p = X_BL * Vec3{range * c, range * s, 0};
    out.p_B.push_back({p.x, p.y});
  }
  return ScanFault::none;
}

void add_normals(ScanPoints& points, double radius_m, double max_gap_m) {
  const std::vector<Vec2>& p = points.p_B;
  points.normal_B.assign(p.size(), Vec2{});
  const auto square = [](Vec2 d) { return dot(d, d); };
  for (std::size_t i = 0; i < p.size(); ++i) {
    double n = 1, x = 0, y = 0, xx = 0, xy = 0, yy = 0;  // sums of the points relative to p[i]
    int fewest = scan_points_per_side;
    for (const int side : {-1, 1}) {
      int count = 0;
      for (std::size_t j = i; count < scan_points_per_side; ++count) {
        if (side < 0 ? j == 0 : j + 1 == p.size()) break;
        const std::size_t next = side < 0 ? j - 1 : j + 1;
        const Vec2 d = p[next] - p[i];
        if (square(p[next] - p[j]) > max_gap_m * max_gap_m) break;
        if (count >= 2 && square(d) > radius_m * radius_m) break;
        n += 1, x += d.x, y += d.y, xx += d.x * d.x, xy += d.x * d.y, yy += d.y * d.y;
        j = next;
      }
      fewest = std::min(fewest, count);
    }
    if (fewest < 2) continue;
    xx -= x * x / n, xy -= x * y / n, yy -= y * y / n;
    // Eigenvalues of [xx xy; xy yy]: half +- root. The normal belongs to the smaller one.
    const double half = (xx + yy) / 2, root = std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy);
    if (!(root > 0) || half - root > scan_points_thickest_line * (half + root)) continue;
    Vec2 along = xx > yy ? Vec2{(xx - yy) / 2 + root, xy} : Vec2{xy, (yy - xx) / 2 + root};
    along = (1 / std::sqrt(square(along))) * along;
    Vec2 normal{-along.y, along.x};
    if (dot(normal, points.laser_B - p[i]) < 0) normal = -1 * normal;
    points.normal_B[i] = normal;
  }
}

}  // namespace sandlot::navigation
