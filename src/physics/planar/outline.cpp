#include "physics/planar/outline.h"

#include <algorithm>
#include <cmath>

#include "geometry/mesh.h"

namespace sandlot::planar {
namespace {

constexpr double upright = 1e-9;  ///< [rad] a tilt that does not count

Vec2 flat(Vec3 v) { return {v.x, v.y}; }

void add_circle(Vec2 centre, double radius, Heights h, std::vector<Outline>& outlines) {
  outlines.push_back({centre, radius, h, 0, 0});
}

void add_triangles(const TriangleMesh& mesh, const Pose& X_WC, std::vector<Outline>& outlines,
                   std::vector<Edge>& edges) {
  // Both halves of an upright rectangle are the same wall.
  Vec2 last_low, last_high;
  Heights last;
  for (const auto& t : mesh.triangles) {
    const Vec3 corner[] = {X_WC * mesh.vertices[t[0]], X_WC * mesh.vertices[t[1]],
                           X_WC * mesh.vertices[t[2]]};
    Heights h;
    Vec2 low = flat(corner[0]), high = low;
    const auto before = [](Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); };
    for (const Vec3& c : corner) {
      h.add({c.z, c.z});
      if (before(flat(c), low)) low = flat(c);
      if (before(high, flat(c))) high = flat(c);
    }
    const Vec2 along = high - low;
    const double length = std::sqrt(dot(along, along));
    if (!(length > 0)) continue;
    const Vec2 across = (1 / length) * Vec2{-along.y, along.x};
    double width = 0;
    for (const Vec3& c : corner) width = std::max(width, std::abs(dot(across, flat(c) - low)));
    if (width > 1e-6 * length) {
      add_polygon({flat(corner[0]), flat(corner[1]), flat(corner[2])}, h, outlines, edges);
      continue;
    }
    if (low == last_low && high == last_high && h.min_m == last.min_m && h.max_m == last.max_m) continue;
    last_low = low, last_high = high, last = h;
    const Vec2 half = 1e-6 * length * across;
    add_polygon({low + half, low - half, high + half, high - half}, h, outlines, edges);
  }
}

}  // namespace

void add_polygon(std::vector<Vec2> points, Heights h, std::vector<Outline>& outlines,
                 std::vector<Edge>& edges) {
  const std::vector<Vec2> corners = convex_hull_2d(std::move(points));
  if (corners.size() < 3) return;  // no area: nothing to bump into
  Vec2 low = corners[0], high = corners[0];
  for (const Vec2 p : corners) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
  Outline outline{0.5 * (low + high), 0, h, static_cast<std::uint32_t>(edges.size()),
                  static_cast<std::uint32_t>(corners.size())};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 from = corners[i], step = corners[(i + 1) % corners.size()] - from;
    const double length = std::sqrt(dot(step, step));
    edges.push_back({from, (1 / length) * step, length});
    const Vec2 out = from - outline.centre;
    outline.radius_m = std::max(outline.radius_m, std::sqrt(dot(out, out)));
  }
  outlines.push_back(outline);
}

void add_outlines(const Shape& shape, const Pose& X_WC, std::vector<Outline>& outlines,
                  std::vector<Edge>& edges) {
  if (const auto* mesh = std::get_if<Mesh>(&shape)) return add_triangles(*mesh->mesh, X_WC, outlines, edges);
  std::vector<SilhouetteDisc> hull;
  add_silhouette(shape, X_WC, hull);
  if (hull.empty()) return;
  const Heights h = heights_of(shape, X_WC);
  std::vector<Vec2> corners;
  const double r = hull[0].radius_m;
  if (r == 0) {
    for (const SilhouetteDisc& point : hull) corners.push_back(point.centre);
    return add_polygon(std::move(corners), h, outlines, edges);
  }
  // One circle, or the same one at both ends of an axis: a stadium, as two circles and the rectangle between.
  add_circle(hull[0].centre, r, h, outlines);
  const Vec2 axis = hull.back().centre - hull[0].centre;
  const double length = std::sqrt(dot(axis, axis));
  if (length < upright * r) return;
  add_circle(hull.back().centre, r, h, outlines);
  const Vec2 across = (r / length) * Vec2{-axis.y, axis.x};
  for (const SilhouetteDisc& end : {hull[0], hull.back()}) {
    corners.push_back(end.centre + across);
    corners.push_back(end.centre - across);
  }
  add_polygon(std::move(corners), h, outlines, edges);
}

Nearest nearest(const Outline& outline, std::span<const Edge> edges, Vec2 point) {
  if (outline.edge_count == 0) {
    const Vec2 out = point - outline.centre;
    const double d = std::sqrt(dot(out, out));
    return {d - outline.radius_m, d > 0 ? (1 / d) * out : Vec2{1, 0}};
  }
  Nearest best{-std::numeric_limits<double>::infinity(), {1, 0}};
  for (const Edge& e : edges.subspan(outline.first_edge, outline.edge_count)) {
    const double d = dot(e.outward(), point - e.from);
    if (d > best.distance_m) best = {d, e.outward()};
  }
  if (best.distance_m <= 0) return best;
  double least2 = std::numeric_limits<double>::infinity();
  for (const Edge& e : edges.subspan(outline.first_edge, outline.edge_count)) {
    const Vec2 to = point - e.from;
    if (dot(e.outward(), to) <= 0) continue;
    const double s = std::clamp(dot(e.along, to), 0.0, e.length_m);
    const Vec2 out = to - s * e.along;
    if (const double d2 = dot(out, out); d2 < least2) {
      least2 = d2;
      const double d = std::sqrt(d2);
      best = {d, (1 / d) * out};
    }
  }
  return best;
}

Chord chord(const Outline& outline, std::span<const Edge> edges, Vec2 origin, Vec2 direction) {
  if (outline.edge_count == 0) {
    const double length2 = dot(direction, direction);
    return chord_of_circle(outline.centre - origin, outline.radius_m, direction, length2, 1 / length2);
  }
  Chord c{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  for (const Edge& e : edges.subspan(outline.first_edge, outline.edge_count)) {
    const Vec2 out = e.outward();
    const double gap = dot(out, e.from - origin), speed = dot(out, direction);
    if (speed == 0) {
      if (gap < 0) return {1, 0};
    } else if (speed < 0) {
      c.first = std::max(c.first, gap / speed);
    } else {
      c.last = std::min(c.last, gap / speed);
    }
  }
  return c;
}

}  // namespace sandlot::planar
