#include "geometry/polygon.h"

#include <algorithm>

namespace sandlot {
namespace {

/// Twice the area of a, b, c; positive when they turn to the left.
double turn(Vec3 a, Vec3 b, Vec3 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

bool in_box(Vec3 a, Vec3 b, Vec3 p) {
  return p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) && p.y >= std::min(a.y, b.y) &&
         p.y <= std::max(a.y, b.y);
}

int sign(double x) { return (x > 0) - (x < 0); }

bool meet(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  const int abc = sign(turn(a, b, c)), abd = sign(turn(a, b, d));
  const int cda = sign(turn(c, d, a)), cdb = sign(turn(c, d, b));
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && in_box(a, b, c)) || (abd == 0 && in_box(a, b, d)) || (cda == 0 && in_box(c, d, a)) ||
         (cdb == 0 && in_box(c, d, b));
}

}  // namespace

bool polygon_contains(std::span<const Vec3> corners, Vec3 p) {
  bool inside = false;  // a ray towards +x crosses the outline an odd number of times
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Vec3 a = corners[i], b = corners[j];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    if (p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

double polygon_area(std::span<const Vec3> corners) {
  double twice = 0;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++)
    twice += corners[j].x * corners[i].y - corners[i].x * corners[j].y;
  return twice / 2;
}

std::optional<std::pair<std::size_t, std::size_t>> polygon_crossing(std::span<const Vec3> corners) {
  const std::size_t n = corners.size();
  const auto at = [&](std::size_t i) { return corners[i % n]; };
  for (std::size_t i = 0; i < n; ++i) {
    // Neighbours share a corner; they overlap where the second goes back along the first.
    const Vec3 a = at(i), b = at(i + 1), c = at(i + 2);
    if (turn(a, b, c) == 0 && (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y) <= 0)
      return std::pair(i, (i + 1) % n);
    for (std::size_t j = i + 2; j < n; ++j)
      if ((j + 1) % n != i && meet(at(i), at(i + 1), at(j), at(j + 1))) return std::pair(i, j);
  }
  return std::nullopt;
}

}  // namespace sandlot
