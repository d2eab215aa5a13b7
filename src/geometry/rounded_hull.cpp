#include "geometry/rounded_hull.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandlot {
namespace {

/// Twice the area of a, b, c; positive when they turn to the left.
double turn_of(Vec2 a, Vec2 b, Vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

bool segments_cross(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const double abc = turn_of(a, b, c), abd = turn_of(a, b, d), cda = turn_of(c, d, a), cdb = turn_of(c, d, b);
  return ((abc > 0 && abd < 0) || (abc < 0 && abd > 0)) && ((cda > 0 && cdb < 0) || (cda < 0 && cdb > 0));
}

double between_m(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  if (segments_cross(a, b, c, d)) return 0;
  return std::min({distance_m(a, c, d), distance_m(b, c, d), distance_m(c, a, b), distance_m(d, a, b)});
}

bool holds(std::span<const Vec2> convex, Vec2 point) {
  if (convex.size() < 3) return false;
  for (std::size_t i = 0, j = convex.size() - 1; i < convex.size(); j = i++)
    if (turn_of(convex[j], convex[i], point) < 0) return false;
  return true;
}

bool inside(std::span<const Vec2> outline, Vec2 p) {
  bool inside = false;  // a ray towards +x crosses the outline an odd number of times
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const Vec2 a = outline[i], b = outline[j];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    if (p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

}  // namespace

RoundedHull rounded_hull(std::span<const SilhouetteDisc> discs) {
  RoundedHull hull;
  std::vector<Vec2> centres;
  for (const SilhouetteDisc& disc : discs) {
    if (std::find(centres.begin(), centres.end(), disc.centre) == centres.end())
      centres.push_back(disc.centre);
    hull.radius_m = std::max(hull.radius_m, disc.radius_m);
  }
  hull.corners = convex_hull_2d(centres);
  if (hull.corners.empty()) hull.corners.push_back(centres.front());
  return hull;
}

double distance_m(Vec2 point, Vec2 a, Vec2 b) {
  const Vec2 along = b - a;
  const double length_2 = dot(along, along);
  const double part = length_2 > 0 ? std::clamp(dot(point - a, along) / length_2, 0.0, 1.0) : 0;
  const Vec2 off = point - (a + part * along);
  return std::sqrt(dot(off, off));
}

double distance_m(std::span<const Vec2> corners, Vec2 a, Vec2 b) {
  if (holds(corners, a)) return 0;
  if (corners.size() == 1) return distance_m(corners[0], a, b);
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++)
    nearest = std::min(nearest, between_m(corners[j], corners[i], a, b));
  return nearest;
}

bool meets(const RoundedHull& hull, std::span<const Vec2> outline) {
  if (inside(outline, hull.corners.front())) return true;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++)
    if (distance_m(hull.corners, outline[j], outline[i]) <= hull.radius_m) return true;
  return false;
}

}  // namespace sandlot
