/// convex_hull(): quickhull in exact arithmetic.
///
/// The points are rounded to a grid of 2^30 steps over their greatest extent; there, the side of a plane on
/// which a point lies is a 96 bit integer, so no point is ever judged differently by two faces and the
/// surface stays a closed one, whatever lies in one plane or line. The vertices returned are the points as
/// given.
///
/// Limits   what is flatter than 1e-8 of its greatest extent counts as lying in a plane.
/// Source   C. B. Barber et al., The quickhull algorithm for convex hulls (1996).
#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/mesh.h"

namespace sandlot {
namespace {

using Wide = __int128;
using Index = std::uint32_t;
struct GridPoint {
  std::int64_t x, y, z;
  friend GridPoint operator-(GridPoint a, GridPoint b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
};

/// At most 2^61: each difference is at most 2^30.
GridPoint grid_cross(GridPoint a, GridPoint b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length2(GridPoint a) {
  const auto x = static_cast<double>(a.x), y = static_cast<double>(a.y), z = static_cast<double>(a.z);
  return x * x + y * y + z * z;
}

/// In steps of the grid: rounding lifts points out of a slanted plane by less than two.
constexpr double flat = 8;

struct Face {
  std::array<Index, 3> corner, neighbour;  ///< neighbour i lies across the edge from corner i to corner i + 1
  GridPoint normal;
  std::vector<Index> outside;  ///< points in front of it that no other face has
  bool alive = true;
};

class Hull {
 public:
  explicit Hull(std::vector<GridPoint> points) : p_(std::move(points)) {}

  /// False when all points lie in a plane.
  bool build() {
    if (!start()) return false;
    for (std::size_t f = 0; f < faces_.size(); ++f)
      while (faces_[f].alive && !faces_[f].outside.empty()) grow(static_cast<Index>(f));
    return true;
  }
  const std::vector<Face>& faces() const { return faces_; }

 private:
  Wide height(const Face& f, Index point) const {
    const GridPoint d = p_[point] - p_[f.corner[0]];
    return static_cast<Wide>(f.normal.x) * d.x + static_cast<Wide>(f.normal.y) * d.y +
           static_cast<Wide>(f.normal.z) * d.z;
  }
  Index add(Index a, Index b, Index c) {
    faces_.push_back({{a, b, c}, {}, grid_cross(p_[b] - p_[a], p_[c] - p_[a])});
    return static_cast<Index>(faces_.size() - 1);
  }
  /// Gives each point to the first of the faces that it lies in front of.
  void share(const std::vector<Index>& points, const std::vector<Index>& among) {
    for (const Index point : points)
      for (const Index f : among)
        if (height(faces_[f], point) > 0) {
          faces_[f].outside.push_back(point);
          break;
        }
  }

  bool start() {
    const auto n = static_cast<Index>(p_.size());
    Index a = 0, b = 0, c = 0, d = 0;
    double best = 0;
    for (Index i = 0; i < n; ++i)
      if (const double l = length2(p_[i] - p_[a]); l > best) best = l, b = i;
    best = 0;
    for (Index i = 0; i < n; ++i)
      if (const double l = length2(grid_cross(p_[b] - p_[a], p_[i] - p_[a])); l > best) best = l, c = i;
    const GridPoint along = p_[b] - p_[a];
    if (b == a || c == a || best <= flat * flat * length2(along)) return false;
    const Face base{{a, b, c}, {}, grid_cross(p_[b] - p_[a], p_[c] - p_[a])};
    Wide far = 0;
    for (Index i = 0; i < n; ++i) {
      const Wide h = height(base, i);
      if ((h < 0 ? -h : h) > far) far = h < 0 ? -h : h, d = i;
    }
    if (static_cast<double>(far) <= flat * std::sqrt(length2(base.normal))) return false;
    if (height(base, d) > 0) std::swap(b, c);
    add(a, b, c), add(b, a, d), add(c, b, d), add(a, c, d);
    faces_[0].neighbour = {1, 2, 3};
    faces_[1].neighbour = {0, 3, 2};
    faces_[2].neighbour = {0, 1, 3};
    faces_[3].neighbour = {0, 2, 1};
    std::vector<Index> all(n);
    for (Index i = 0; i < n; ++i) all[i] = i;
    share(all, {0, 1, 2, 3});
    return true;
  }

  /// Adds the point farthest in front of face f.
  void grow(Index f) {
    Index eye = faces_[f].outside.front();
    for (const Index i : faces_[f].outside)
      if (height(faces_[f], i) > height(faces_[f], eye)) eye = i;
    // The visible faces are connected; their rim is one ring, for the arithmetic is exact.
    std::vector<Index> seen{f}, orphans, made;
    std::map<Index, Index> made_at;  // by the corner its edge of the rim begins at
    faces_[f].alive = false;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      for (const Index next : faces_[seen[k]].neighbour)
        if (faces_[next].alive && height(faces_[next], eye) > 0) {
          faces_[next].alive = false;
          seen.push_back(next);
        }
    }
    for (const Index s : seen) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Index beyond = faces_[s].neighbour[i];
        if (!faces_[beyond].alive) continue;
        const Index from = faces_[s].corner[i], to = faces_[s].corner[(i + 1) % 3];
        const Index fresh = add(from, to, eye);
        faces_[fresh].neighbour[0] = beyond;
        for (std::size_t e = 0; e < 3; ++e)
          if (faces_[beyond].corner[e] == to && faces_[beyond].neighbour[e] == s)
            faces_[beyond].neighbour[e] = fresh;
        made.push_back(fresh);
        made_at[from] = fresh;
      }
      orphans.insert(orphans.end(), faces_[s].outside.begin(), faces_[s].outside.end());
      faces_[s].outside = {};
    }
    for (const Index m : made) {
      const Index next = made_at.at(faces_[m].corner[1]);
      faces_[m].neighbour[1] = next;
      faces_[next].neighbour[2] = m;
    }
    share(orphans, made);
  }

  std::vector<GridPoint> p_;
  std::vector<Face> faces_;
};

}  // namespace

TriangleMesh convex_hull(const std::vector<Vec3>& points) {
  TriangleMesh mesh;
  if (points.empty()) return mesh;
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    if (!is_finite(p)) return mesh;
    for (std::size_t i = 0; i < 3; ++i) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
  }
  const Vec3 size = high - low;
  const double extent = std::max({size.x, size.y, size.z}), steps = 1 << 30;
  if (!(extent > 0) || !std::isfinite(extent)) return mesh;
  std::vector<GridPoint> grid;
  grid.reserve(points.size());
  for (const Vec3& p : points) {
    const auto round = [&](double d) {
      return static_cast<std::int64_t>(std::floor(d / extent * steps + 0.5));
    };
    grid.push_back({round(p.x - low.x), round(p.y - low.y), round(p.z - low.z)});
  }
  Hull hull(std::move(grid));
  if (!hull.build()) return mesh;
  std::vector<Index> number(points.size(), ~Index{0});
  for (const Face& face : hull.faces()) {
    if (!face.alive) continue;
    std::array<Index, 3> triangle{};
    for (std::size_t i = 0; i < 3; ++i) {
      Index& n = number[face.corner[i]];
      if (n == ~Index{0}) {
        n = static_cast<Index>(mesh.vertices.size());
        mesh.vertices.push_back(points[face.corner[i]]);
      }
      triangle[i] = n;
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

}  // namespace sandlot
