#include "physics/planar/manifold.h"

#include <algorithm>
#include <cmath>

namespace sandlot::planar {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::span<const Edge> edges_of(ConvexOutline f) {
  return f.edges.subspan(f.outline.first_edge, f.outline.edge_count);
}

struct Face {
  double gap_m = -infinity;
  std::uint32_t edge = 0;
};

/// The edge of `a` that keeps `b` farthest off.
Face face_between(std::span<const Edge> a, std::span<const Edge> b, Vec2 shift_b) {
  Face best;
  for (std::uint32_t i = 0; i < a.size(); ++i) {
    const Vec2 out = a[i].outward();
    double least = infinity;
    for (const Edge& e : b) least = std::min(least, dot(out, e.from));
    least += dot(out, shift_b - a[i].from);
    if (least > best.gap_m) best = {least, i};
  }
  return best;
}

bool meet_circles(const Outline& a, const Outline& b, double margin_m, Manifold& out) {
  const Vec2 d = b.centre - a.centre;
  const double reach = a.radius_m + b.radius_m + margin_m, square = dot(d, d);
  if (!(square < reach * reach)) return false;
  const double distance = std::sqrt(square);
  out.normal = distance > 0 ? (1 / distance) * d : Vec2{1, 0};
  const double gap = distance - a.radius_m - b.radius_m;
  out.count = 1;
  out.points[0] = {a.centre + (a.radius_m + 0.5 * gap) * out.normal, gap, 0};
  return true;
}

/// @param sign  1: the polygon is a
bool meet_circle(ConvexOutline polygon, const Outline& circle, double sign, double margin_m, Manifold& out) {
  const Vec2 apart = circle.centre - polygon.outline.centre;
  const double reach = polygon.outline.radius_m + circle.radius_m + margin_m;
  if (!(dot(apart, apart) < reach * reach)) return false;
  const Nearest near = nearest(polygon.outline, polygon.edges, circle.centre);
  const double gap = near.distance_m - circle.radius_m;
  if (!(gap < margin_m)) return false;
  out.normal = sign * near.normal;
  out.count = 1;
  out.points[0] = {circle.centre - (circle.radius_m + 0.5 * gap) * near.normal, gap, 0};
  return true;
}

bool meet_polygons(ConvexOutline a, ConvexOutline b, double margin_m, Manifold& out) {
  const auto edges_a = edges_of(a), edges_b = edges_of(b);
  const Face of_a = face_between(edges_a, edges_b, {});
  if (!(of_a.gap_m < margin_m)) return false;
  const Face of_b = face_between(edges_b, edges_a, {});
  if (!(of_b.gap_m < margin_m)) return false;
  // Rounding shall not change the face from step to step.
  const bool swapped = of_b.gap_m > of_a.gap_m + 1e-6;
  const auto face_edges = swapped ? edges_b : edges_a, other = swapped ? edges_a : edges_b;
  const std::uint32_t face_index = swapped ? of_b.edge : of_a.edge;
  const Edge& face = face_edges[face_index];
  const Vec2 n = face.outward();
  std::uint32_t facing = 0;
  double most = infinity;
  for (std::uint32_t i = 0; i < other.size(); ++i)
    if (const double along = dot(other[i].outward(), n); along < most) most = along, facing = i;
  const Edge& e = other[facing];
  // The part of the facing edge over the face, as parameters along it.
  const double from = dot(face.along, e.from - face.from), slope = dot(face.along, e.along);
  double first = 0, last = e.length_m;
  if (slope != 0) {
    const double begin = -from / slope, end = (face.length_m - from) / slope;
    first = std::max(first, std::min(begin, end));
    last = std::min(last, std::max(begin, end));
  } else if (from < 0 || from > face.length_m) {
    return false;
  }
  if (!(first <= last)) return false;
  out.normal = swapped ? -1.0 * n : n;
  out.count = 0;
  const std::uint32_t feature = (swapped ? 1u << 30 : 0u) | face_index << 15 | facing << 1;
  for (std::uint32_t k = 0; k < 2; ++k) {
    const Vec2 p = e.from + (k == 0 ? first : last) * e.along;
    const double gap = dot(n, p - face.from);
    if (gap < margin_m) out.points[out.count++] = {p - (0.5 * gap) * n, gap, feature | k};
  }
  return out.count > 0;
}

}  // namespace

bool find_manifold(ConvexOutline a, ConvexOutline b, double margin_m, Manifold& out) {
  const bool round_a = a.outline.edge_count == 0, round_b = b.outline.edge_count == 0;
  if (round_a && round_b) return meet_circles(a.outline, b.outline, margin_m, out);
  if (round_b) return meet_circle(a, b.outline, 1, margin_m, out);
  if (round_a) return meet_circle(b, a.outline, -1, margin_m, out);
  return meet_polygons(a, b, margin_m, out);
}

Axis separation(ConvexOutline a, ConvexOutline b, Vec2 shift) {
  const bool round_a = a.outline.edge_count == 0, round_b = b.outline.edge_count == 0;
  if (round_b) {
    const Nearest near = nearest(a.outline, a.edges, b.outline.centre + shift);
    return {near.distance_m - b.outline.radius_m, near.normal};
  }
  if (round_a) {
    const Nearest near = nearest(b.outline, b.edges, a.outline.centre - shift);
    return {near.distance_m - a.outline.radius_m, -1.0 * near.normal};
  }
  const auto edges_a = edges_of(a), edges_b = edges_of(b);
  const Face of_a = face_between(edges_a, edges_b, shift),
             of_b = face_between(edges_b, edges_a, -1.0 * shift);
  if (of_a.gap_m >= of_b.gap_m) return {of_a.gap_m, edges_a[of_a.edge].outward()};
  return {of_b.gap_m, -1.0 * edges_b[of_b.edge].outward()};
}

double time_of_impact(ConvexOutline a, ConvexOutline b, Vec2 path, double target_m) {
  // They lie on both sides of an axis, so they cannot meet before the path along it has used up the gap.
  double t = 0;
  for (int i = 0; i < 40; ++i) {
    const Axis axis = separation(a, b, t * path);
    const double left = axis.gap_m - target_m, closing = -dot(axis.normal, path);
    if (!(closing > 0)) return 1;
    if (left <= 0.01 * target_m) return i == 0 ? 1 : t;
    t += left / closing;
    if (!(t < 1)) return 1;
  }
  return t;
}

}  // namespace sandlot::planar
