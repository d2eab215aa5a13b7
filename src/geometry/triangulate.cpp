#include "geometry/triangulate.h"

#include <algorithm>
#include <numeric>

namespace sandlot {
namespace {

using Point = std::array<double, 2>;
using Index = std::uint32_t;

/// Twice the signed area of a triangle.
double orient(const Point& a, const Point& b, const Point& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}
bool box_holds(const Point& a, const Point& b, const Point& p) {
  return p[0] >= std::min(a[0], b[0]) && p[0] <= std::max(a[0], b[0]) && p[1] >= std::min(a[1], b[1]) &&
         p[1] <= std::max(a[1], b[1]);
}
/// The closed segments ab and cd have a point in common.
bool touch(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double o1 = orient(a, b, c), o2 = orient(a, b, d), o3 = orient(c, d, a), o4 = orient(c, d, b);
  if (((o1 > 0 && o2 < 0) || (o1 < 0 && o2 > 0)) && ((o3 > 0 && o4 < 0) || (o3 < 0 && o4 > 0))) return true;
  return (o1 == 0 && box_holds(a, b, c)) || (o2 == 0 && box_holds(a, b, d)) ||
         (o3 == 0 && box_holds(c, d, a)) || (o4 == 0 && box_holds(c, d, b));
}

/// A ring of corners, the inside on its left: what is left to be cut.
struct Ring {
  const std::vector<Point>& points;
  std::vector<Index> corners;

  std::size_t size() const { return corners.size(); }
  const Point& at(std::size_t i) const { return points[corners[i % corners.size()]]; }
  const Point& before(std::size_t i) const { return at(i + corners.size() - 1); }

  /// Leaving corner i towards `to` leads inside.
  bool leads_inside(std::size_t i, const Point& to) const {
    const Point &a = before(i), &b = at(i), &c = at(i + 1);
    if (orient(a, b, c) > 0) return orient(b, to, a) > 0 && orient(b, c, to) > 0;
    return !(orient(b, to, c) >= 0 && orient(b, a, to) >= 0);
  }

  bool is_ear(std::size_t i) const {
    const Point &a = before(i), &b = at(i), &c = at(i + 1);
    if (!(orient(a, b, c) > 0)) return false;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Point& p = at(k);
      if (p == a || p == b || p == c) continue;
      if (orient(a, b, p) >= 0 && orient(b, c, p) >= 0 && orient(c, a, p) >= 0) return false;
    }
    return true;
  }
};

/// Joins a hole to the ring where they see each other, nearest corners first. False when they do not.
bool bridge(Ring& ring, const std::vector<Index>& hole, const std::vector<std::vector<Index>>& waiting) {
  const Ring inner{ring.points, hole};
  struct Pair {
    double distance2;
    std::size_t outer, inner;
  };
  // From the hole's corner of greatest x: holes farther to the right are joined already, so something is in
  // sight.
  std::size_t start = 0;
  for (std::size_t i = 1; i < hole.size(); ++i)
    if (inner.at(i)[0] > inner.at(start)[0]) start = i;
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const double dx = ring.at(i)[0] - inner.at(start)[0], dy = ring.at(i)[1] - inner.at(start)[1];
    pairs.push_back({dx * dx + dy * dy, i, start});
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.distance2 < b.distance2; });
  const auto blocks = [](const Ring& r, const Point& p, const Point& q) {
    for (std::size_t i = 0; i < r.size(); ++i) {
      const Point &a = r.at(i), &b = r.at(i + 1);
      const bool shares = a == p || a == q || b == p || b == q;
      if (!shares && touch(a, b, p, q)) return true;
      if (shares && a != p && a != q && orient(p, q, a) == 0 && box_holds(p, q, a)) return true;
      if (shares && b != p && b != q && orient(p, q, b) == 0 && box_holds(p, q, b)) return true;
    }
    return false;
  };
  for (const Pair& pair : pairs) {
    const Point &p = ring.at(pair.outer), &q = inner.at(pair.inner);
    if (p == q || !ring.leads_inside(pair.outer, q) || !inner.leads_inside(pair.inner, p)) continue;
    bool blocked = blocks(ring, p, q) || blocks(inner, p, q);
    for (const std::vector<Index>& other : waiting) blocked = blocked || blocks({ring.points, other}, p, q);
    if (blocked) continue;
    std::vector<Index> insert;
    for (std::size_t i = 0; i <= hole.size(); ++i) insert.push_back(hole[(pair.inner + i) % hole.size()]);
    insert.push_back(ring.corners[pair.outer]);
    ring.corners.insert(ring.corners.begin() + static_cast<std::ptrdiff_t>(pair.outer) + 1, insert.begin(),
                        insert.end());
    return true;
  }
  return false;
}

}  // namespace

double twice_area(const Loop2& loop) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) sum += orient(loop[0], loop[i], loop[i + 1]);
  return sum;
}

bool is_simple(const std::vector<Loop2>& loops) {
  struct Side {
    Point a, b;
    std::size_t loop, index;
  };
  std::vector<Side> sides;
  std::size_t corners = 0;
  for (const Loop2& loop : loops) corners += loop.size();
  if (corners > max_corners) return false;
  for (std::size_t l = 0; l < loops.size(); ++l) {
    if (loops[l].size() < 3 || !(twice_area(loops[l]) != 0)) return false;
    for (std::size_t i = 0; i < loops[l].size(); ++i)
      sides.push_back({loops[l][i], loops[l][(i + 1) % loops[l].size()], l, i});
  }
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const Side& s = sides[i];
    if (s.a == s.b) return false;
    for (std::size_t k = i + 1; k < sides.size(); ++k) {
      const Side& t = sides[k];
      const std::size_t n = loops[s.loop].size();
      const bool follows = s.loop == t.loop && t.index == s.index + 1,
                 leads = s.loop == t.loop && (t.index + 1) % n == s.index;
      if (follows || leads) {
        // Neighbours share a corner; they must not run back along each other.
        const Point &corner = follows ? s.b : s.a, &p = follows ? s.a : s.b, &q = follows ? t.b : t.a;
        const double along = (p[0] - corner[0]) * (q[0] - corner[0]) +
                             (p[1] - corner[1]) * (q[1] - corner[1]);
        if (orient(corner, p, q) == 0 && along > 0) return false;
      } else if (touch(s.a, s.b, t.a, t.b)) {
        return false;
      }
    }
  }
  return true;
}

std::vector<std::array<std::uint32_t, 3>> triangulate(const std::vector<Loop2>& loops) {
  std::vector<Point> points;
  std::vector<std::vector<Index>> rings;
  for (const Loop2& loop : loops) {
    std::vector<Index> ring(loop.size());
    std::iota(ring.begin(), ring.end(), static_cast<Index>(points.size()));
    if ((twice_area(loop) < 0) == rings.empty()) std::reverse(ring.begin(), ring.end());
    points.insert(points.end(), loop.begin(), loop.end());
    if (ring.size() < 3) return {};
    rings.push_back(std::move(ring));
  }
  if (rings.empty() || points.size() > max_corners) return {};
  Ring ring{points, rings.front()};
  std::vector<std::vector<Index>> holes(rings.begin() + 1, rings.end());
  const auto right_end = [&](const std::vector<Index>& r) {
    double x = points[r.front()][0];
    for (const Index i : r) x = std::max(x, points[i][0]);
    return x;
  };
  // A stack: the hole that reaches farthest to the right is joined first.
  std::stable_sort(holes.begin(), holes.end(),
                   [&](const auto& a, const auto& b) { return right_end(a) < right_end(b); });
  while (!holes.empty()) {
    const std::vector<Index> hole = holes.back();
    holes.pop_back();
    if (!bridge(ring, hole, holes)) return {};
  }
  std::vector<std::array<Index, 3>> out;
  std::size_t i = 0, misses = 0;
  while (ring.size() > 3) {
    if (misses > ring.size()) return {};
    i %= ring.size();
    if (!ring.is_ear(i)) {
      ++i, ++misses;
      continue;
    }
    const std::size_t n = ring.size();
    out.push_back({ring.corners[(i + n - 1) % n], ring.corners[i], ring.corners[(i + 1) % n]});
    ring.corners.erase(ring.corners.begin() + static_cast<std::ptrdiff_t>(i));
    ++i, misses = 0;
  }
  if (!(orient(ring.at(0), ring.at(1), ring.at(2)) > 0)) return {};
  out.push_back({ring.corners[0], ring.corners[1], ring.corners[2]});
  return out;
}

}  // namespace sandlot
