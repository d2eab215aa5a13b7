#include "physics/planar/outline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/barrel.h"
#include "geometry/mesh.h"

namespace sandlot::planar {
namespace {

constexpr double upright = 1e-9;  ///< [rad] a tilt that does not count
constexpr int facets = 32;

Vec2 flat(Vec3 v) { return {v.x, v.y}; }

/// The rim of a disc of radius r about `centre` with unit normal `axis`, seen from above: a circle, a line or an
/// ellipse, which its 32 tangents enclose.
void add_rim(Vec3 centre, Vec3 axis, double r, std::vector<Round>& hull) {
  const double tilt = std::sqrt(axis.x * axis.x + axis.y * axis.y);
  if (tilt < upright) return hull.push_back({flat(centre), r});
  const Vec2 low{axis.x / tilt, axis.y / tilt};  // the way it leans; across it the ellipse is r wide
  const double narrow = std::abs(axis.z) * r;
  if (narrow < upright * r) {
    hull.push_back({flat(centre) + r * Vec2{-low.y, low.x}, 0});
    hull.push_back({flat(centre) - r * Vec2{-low.y, low.x}, 0});
    return;
  }
  const double outside = 1 / math::cos(math::pi / facets);
  for (int i = 0; i < facets; ++i) {
    const auto [s, c] = math::sincos(math::tau * i / facets);
    hull.push_back({flat(centre) + outside * (r * s * Vec2{-low.y, low.x} + narrow * c * low), 0});
  }
}

/// Convex hull, counter-clockwise, without collinear points (A. M. Andrew, 1979).
std::vector<Vec2> hull_of(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(),
            [](Vec2 a, Vec2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  double size = 0;
  for (const Vec2 p : points)
    size = std::max({size, std::abs(p.x - points[0].x), std::abs(p.y - points[0].y)});
  std::vector<Vec2> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = hull.size();
    for (const Vec2 p : points) {
      while (hull.size() >= start + 2) {
        const Vec2 a = hull[hull.size() - 2], b = hull.back();
        const double area = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        if (area > 1e-12 * size * size) break;
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();  // the first of the other side
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

void add_circle(Vec2 centre, double radius, Heights h, std::vector<Outline>& outlines) {
  outlines.push_back({centre, radius, h, 0, 0});
}

void add_polygon(std::vector<Vec2> points, Heights h, std::vector<Outline>& outlines,
                 std::vector<Edge>& edges) {
  const std::vector<Vec2> corners = hull_of(std::move(points));
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

/// Upper part and height of R diag(r^2) R^T: of the ellipse that an ellipsoid casts.
struct Shadow {
  double xx, xy, yy, zz;
};
Shadow shadow_of(const Ellipsoid& egg, Quat q) {
  const Vec3 x = egg.radii_m.x * rotate(q, {1, 0, 0}), y = egg.radii_m.y * rotate(q, {0, 1, 0}),
             z = egg.radii_m.z * rotate(q, {0, 0, 1});
  return {x.x * x.x + y.x * y.x + z.x * z.x, x.x * x.y + y.x * y.y + z.x * z.y,
          x.y * x.y + y.y * y.y + z.y * z.y, x.z * x.z + y.z * y.z + z.z * z.z};
}

std::array<Vec3, 8> corners_of(const Box& box, const Pose& X_WC) {
  std::array<Vec3, 8> corners;
  for (unsigned i = 0; i < 8; ++i)
    corners[i] = X_WC *
                 (0.5 * Vec3{i & 1 ? box.size_m.x : -box.size_m.x, i & 2 ? box.size_m.y : -box.size_m.y,
                             i & 4 ? box.size_m.z : -box.size_m.z});
  return corners;
}

}  // namespace

Heights heights_of(const Shape& shape, const Pose& X_WC) {
  const Vec3 axis = rotate(X_WC.q, {0, 0, 1});
  double half = -1;
  if (const auto* box = std::get_if<Box>(&shape)) {
    const Vec3 x = rotate(X_WC.q, {1, 0, 0}), y = rotate(X_WC.q, {0, 1, 0});
    half = 0.5 *
           (std::abs(x.z) * box->size_m.x + std::abs(y.z) * box->size_m.y + std::abs(axis.z) * box->size_m.z);
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    half = sphere->radius_m;
  } else if (const auto* can = std::get_if<Cylinder>(&shape)) {
    half = std::sqrt(axis.x * axis.x + axis.y * axis.y) * can->radius_m +
           0.5 * std::abs(axis.z) * can->length_m;
  } else if (const auto* pill = std::get_if<Capsule>(&shape)) {
    half = pill->radius_m + 0.5 * std::abs(axis.z) * pill->length_m;
  } else if (const auto* barrel = std::get_if<Barrel>(&shape)) {
    half = reach_m(*barrel, axis.z);
  } else if (const auto* egg = std::get_if<Ellipsoid>(&shape)) {
    half = std::sqrt(shadow_of(*egg, X_WC.q).zz);
  } else if (const auto* cone = std::get_if<Cone>(&shape)) {
    const double rim = std::sqrt(axis.x * axis.x + axis.y * axis.y) * cone->radius_m;
    const double apex = 0.5 * cone->length_m * axis.z;
    return {X_WC.p.z + std::min(apex, -apex - rim), X_WC.p.z + std::max(apex, -apex + rim)};
  } else if (const auto* mesh = std::get_if<Mesh>(&shape)) {
    Heights heights;
    for (const Vec3& v : mesh->mesh->vertices) {
      const double z = (X_WC * v).z;
      heights.add({z, z});
    }
    return heights;
  } else {
    return {};
  }
  return {X_WC.p.z - half, X_WC.p.z + half};
}

void add_shadow(const Shape& shape, const Pose& X_WC, std::vector<Round>& hull) {
  const Vec3 axis = rotate(X_WC.q, {0, 0, 1});
  if (const auto* box = std::get_if<Box>(&shape)) {
    for (const Vec3 corner : corners_of(*box, X_WC)) hull.push_back({flat(corner), 0});
  } else if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    hull.push_back({flat(X_WC.p), sphere->radius_m});
  } else if (const auto* can = std::get_if<Cylinder>(&shape)) {
    for (const double end : {-0.5, 0.5})
      add_rim(X_WC.p + end * can->length_m * axis, axis, can->radius_m, hull);
  } else if (const auto* pill = std::get_if<Capsule>(&shape)) {
    for (const double end : {-0.5, 0.5})
      hull.push_back({flat(X_WC.p + end * pill->length_m * axis), pill->radius_m});
  } else if (const auto* barrel = std::get_if<Barrel>(&shape)) {
    // The arc as five rings: from above it lies inside the true outline by less than 1 % of the sagitta.
    for (const double part : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const double z = part * 0.5 * barrel->length_m;
      if (const double r = radius_at_m(*barrel, z); r > 0) add_rim(X_WC.p + z * axis, axis, r, hull);
    }
  } else if (const auto* cone = std::get_if<Cone>(&shape)) {
    add_rim(X_WC.p - 0.5 * cone->length_m * axis, axis, cone->radius_m, hull);
    hull.push_back({flat(X_WC.p + 0.5 * cone->length_m * axis), 0});
  } else if (const auto* egg = std::get_if<Ellipsoid>(&shape)) {
    const Shadow s = shadow_of(*egg, X_WC.q);
    const double tolerance = upright * (s.xx + s.yy);
    if (std::abs(s.xx - s.yy) < tolerance && std::abs(s.xy) < tolerance)
      return hull.push_back({flat(X_WC.p), std::sqrt(s.xx)});
    // The ellipse is the unit circle times the Cholesky factor; so are its tangents.
    const double a = std::sqrt(s.xx), b = s.xy / a, c = std::sqrt(std::max(s.yy - b * b, 0.0));
    const double outside = 1 / math::cos(math::pi / facets);
    for (int i = 0; i < facets; ++i) {
      const auto [sine, cosine] = math::sincos(math::tau * i / facets);
      hull.push_back({flat(X_WC.p) + outside * Vec2{a * cosine, b * cosine + c * sine}, 0});
    }
  } else if (const auto* mesh = std::get_if<Mesh>(&shape)) {
    for (const Vec3& v : mesh->mesh->vertices) hull.push_back({flat(X_WC * v), 0});
  }
}

void add_outlines(const Shape& shape, const Pose& X_WC, std::vector<Outline>& outlines,
                  std::vector<Edge>& edges) {
  if (const auto* mesh = std::get_if<Mesh>(&shape)) return add_triangles(*mesh->mesh, X_WC, outlines, edges);
  std::vector<Round> hull;
  add_shadow(shape, X_WC, hull);
  if (hull.empty()) return;
  const Heights h = heights_of(shape, X_WC);
  std::vector<Vec2> corners;
  const double r = hull[0].radius_m;
  if (r == 0) {
    for (const Round& point : hull) corners.push_back(point.centre);
    return add_polygon(std::move(corners), h, outlines, edges);
  }
  // One circle, or the same one at both ends of an axis: a stadium, as two circles and the rectangle between.
  add_circle(hull[0].centre, r, h, outlines);
  const Vec2 axis = hull.back().centre - hull[0].centre;
  const double length = std::sqrt(dot(axis, axis));
  if (length < upright * r) return;
  add_circle(hull.back().centre, r, h, outlines);
  const Vec2 across = (r / length) * Vec2{-axis.y, axis.x};
  for (const Round& end : {hull[0], hull.back()}) {
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
