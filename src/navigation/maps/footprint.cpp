#include "navigation/maps/footprint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/polygon.h"

namespace sandlot::navigation {
namespace {

/// Whether a row of the grid holds an obstacle between two coordinates.
bool footprint_row_hit(const CostMap& map, int row, double left, double right) {
  const int first = static_cast<int>(std::floor(left)), last = static_cast<int>(std::ceil(right)) - 1;
  const std::uint8_t* cells = map.cost.data() + map.geometry.index({0, row});
  for (int x = first; x <= last; ++x)
    if (cells[x] == lethal_cost) return true;
  return false;
}

Contact footprint_circle(const CostMap& map, Vec2 p, double radius) {
  const int low = static_cast<int>(std::floor(p.y - radius)),
            high = static_cast<int>(std::ceil(p.y + radius)) - 1;
  for (int row = low; row <= high; ++row) {
    const double dy = std::max({0.0, row - p.y, p.y - (row + 1)});
    const double half = std::sqrt(std::max(0.0, radius * radius - dy * dy));
    if (half > 0 && footprint_row_hit(map, row, p.x - half, p.x + half)) return Contact::obstacle;
  }
  return Contact::none;
}

}  // namespace

Result<Footprint> Footprint::circle(double radius_m) {
  if (!(radius_m > 0 && radius_m <= 1000))
    return Error{"a footprint with a radius of " + number_text(radius_m) + " m",
                 "it must lie in (0, 1000] m"};
  Footprint out;
  out.inscribed_ = out.circumscribed_ = radius_m;
  return out;
}

Result<Footprint> Footprint::polygon(std::vector<Vec2> corners) {
  if (corners.size() < 3 || corners.size() > 1000)
    return Error{"a footprint of " + std::to_string(corners.size()) + " corners", "a polygon has 3 to 1000"};
  std::vector<Vec3> flat;
  Footprint out;
  for (const Vec2 c : corners) {
    if (!(std::abs(c.x) <= 1000 && std::abs(c.y) <= 1000))
      return Error{"a corner of the footprint is " + point_text(c),
                   "coordinates must lie in [-1000, 1000] m"};
    flat.push_back({c.x, c.y, 0});
    out.circumscribed_ = std::max(out.circumscribed_, math::hypot(c.x, c.y));
  }
  if (const auto crossing = polygon_crossing(flat))
    return Error{"sides " + std::to_string(crossing->first) + " and " + std::to_string(crossing->second) +
                     " of the footprint meet",
                 "give the corners in order"};
  if (std::abs(polygon_area(flat)) < 1e-9)
    return Error{"the footprint has no area", "give its corners in metres"};
  if (polygon_contains(flat, {0, 0, 0})) {
    out.inscribed_ = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec2 a = corners[i], d = corners[(i + 1) % corners.size()] - a;
      const double square = dot(d, d), t = square > 0 ? std::clamp(-dot(a, d) / square, 0.0, 1.0) : 0;
      const Vec2 near = a + t * d;
      out.inscribed_ = std::min(out.inscribed_, math::hypot(near.x, near.y));
    }
  }
  out.corners_ = std::move(corners);
  return out;
}

Result<Footprint> Footprint::rectangle(double front, double back, double left, double right) {
  return polygon({{front, left}, {-back, left}, {-back, -right}, {front, -right}});
}

Result<Footprint> Footprint::grown(double margin_m) const {
  if (!(margin_m >= 0 && margin_m <= 1000))
    return Error{"a margin of " + number_text(margin_m) + " m", "it must lie in [0, 1000] m"};
  if (corners_.empty()) return circle(circumscribed_ + margin_m);
  std::vector<Vec3> flat;
  for (const Vec2 c : corners_) flat.push_back({c.x, c.y, 0});
  const double outward = polygon_area(flat) > 0 ? margin_m : -margin_m;
  const std::size_t n = corners_.size();
  // Unit normal of side i, on the right of its direction.
  const auto normal = [&](std::size_t i) {
    const Vec2 d = corners_[(i + 1) % n] - corners_[i % n];
    const double length = std::max(math::hypot(d.x, d.y), 1e-12);
    return Vec2{d.y / length, -d.x / length};
  };
  std::vector<Vec2> moved;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 a = normal(i + n - 1), b = normal(i);
    moved.push_back(corners_[i] + (outward / std::max(1 + dot(a, b), 0.1)) * (a + b));
  }
  return polygon(std::move(moved));
}

Contact footprint_contact(const CostMap& map, const GridFrame& frame, const Footprint& footprint,
                          const Pose2& X) {
  const auto cell = frame.cell({X.x, X.y});
  if (!cell || !std::isfinite(X.theta)) return Contact::off_map;
  const Vec2 p = frame.to_grid({X.x, X.y});
  const double resolution = frame.resolution_m(), outer = footprint.circumscribed_m() / resolution;
  const bool inside = p.x - outer >= 0 && p.y - outer >= 0 && p.x + outer <= map.geometry.width &&
                      p.y + outer <= map.geometry.height;
  // Point and obstacle each lie within half a diagonal of the centres that the distance was taken between.
  const double centres = static_cast<double>(map.distance_m[map.geometry.index(*cell)]) / resolution,
               slack = std::numbers::sqrt2;
  if (inside && centres - slack >= outer) return Contact::none;
  if (footprint.corners().empty()) {
    if (!inside) return Contact::off_map;
    return footprint_circle(map, p, outer);
  }

  const auto [s, c] = math::sincos(X.theta);
  std::array<Vec2, 16> few;
  std::vector<Vec2> many;
  const std::size_t n = footprint.corners().size();
  if (n > few.size()) many.resize(n);
  const std::span<Vec2> corners = n > few.size() ? std::span<Vec2>(many) : std::span<Vec2>(few.data(), n);
  constexpr double far = std::numeric_limits<double>::infinity();
  Vec2 low{far, far}, high{-far, -far};
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 b = footprint.corners()[i],
               d = frame.direction_to_grid({c * b.x - s * b.y, s * b.x + c * b.y});
    corners[i] = p + (1 / resolution) * d;
    low = {std::min(low.x, corners[i].x), std::min(low.y, corners[i].y)};
    high = {std::max(high.x, corners[i].x), std::max(high.y, corners[i].y)};
  }
  if (low.x < 0 || low.y < 0 || high.x > map.geometry.width || high.y > map.geometry.height)
    return Contact::off_map;
  if (centres + slack < footprint.inscribed_m() / resolution) return Contact::obstacle;
  for (int row = static_cast<int>(std::floor(low.y)), last = static_cast<int>(std::ceil(high.y)) - 1;
       row <= last; ++row) {
    double left = far, right = -far;
    for (std::size_t i = 0; i < n; ++i) {
      // Part of this side within the row.
      const Vec2 a = corners[i], b = corners[i + 1 < n ? i + 1 : 0], d = b - a;
      double begin = 0, end = 1;
      if (d.y != 0) {
        const double t0 = (row - a.y) / d.y, t1 = (row + 1 - a.y) / d.y;
        begin = std::max(begin, std::min(t0, t1));
        end = std::min(end, std::max(t0, t1));
      } else if (a.y < row || a.y > row + 1) {
        continue;
      }
      if (begin > end) continue;
      const double x0 = a.x + begin * d.x, x1 = a.x + end * d.x;
      left = std::min({left, x0, x1});
      right = std::max({right, x0, x1});
    }
    left = std::max(left, 0.0);
    right = std::min(right, static_cast<double>(map.geometry.width));
    if (left < right && footprint_row_hit(map, row, left, right)) return Contact::obstacle;
  }
  return Contact::none;
}

}  // namespace sandlot::navigation
