#include "physics/planar/map.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace sandlot::planar {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// A little more than a circle, so that rounding in the walk through the cells passes no thing by.
Area around(Vec2 centre, double radius_m) {
  const double r = radius_m + 1e-9 * (1 + std::abs(centre.x) + std::abs(centre.y));
  return {{centre.x - r, centre.y - r}, {centre.x + r, centre.y + r}};
}

void grow(Area& area, Area by) {
  area.low = {std::min(area.low.x, by.low.x), std::min(area.low.y, by.low.y)};
  area.high = {std::max(area.high.x, by.high.x), std::max(area.high.y, by.high.y)};
}

constexpr Area nowhere{{inf, inf}, {-inf, -inf}};

Area area_of(const Wall& wall, std::span<const Edge> edges) {
  if (wall.outline.edge_count == 0) return around(wall.outline.centre, wall.outline.radius_m);
  Area area = nowhere;
  for (const Edge& e : edges.subspan(wall.outline.first_edge, wall.outline.edge_count))
    grow(area, around(e.from, 0));
  return area;
}

/// Columns or rows for things spread over `length_m`: one cell each up to a limit, beyond which cells share slots.
std::uint32_t slots_for(double length_m, double cell_m) {
  const double cells = length_m / cell_m + 2;
  return cells >= 16 ? std::bit_ceil(static_cast<std::uint32_t>(std::min(cells, 1024.0))) : 16;
}

bool touches(Vec2 point, double radius_m, const Disc& disc) {
  const Vec2 d = disc.centre - point;
  const double r = radius_m + disc.radius_m;
  return dot(d, d) <= r * r;
}

/// Distance in height between a point and an interval.
double gap(double z, Heights h) { return std::max({h.min_m - z, z - h.max_m, 0.0}); }

}  // namespace

void Map::set_walls(std::span<const Wall> walls, std::span<const Edge> edges) {
  walls_.assign(walls.begin(), walls.end());
  edges_.assign(edges.begin(), edges.end());
  everywhere_.clear();
  Area all = nowhere;
  for (const Wall& wall : walls_) grow(all, area_of(wall, edges_));
  wall_cells_.resize(cell_m_, slots_for(all.high.x - all.low.x, cell_m_),
                     slots_for(all.high.y - all.low.y, cell_m_));
  wall_area_ = nowhere;
  const double many = 0.25 * wall_cells_.columns() * wall_cells_.rows();
  wall_cells_.build(static_cast<std::uint32_t>(walls_.size()), [&](std::uint32_t k) {
    const Area area = area_of(walls_[k], edges_);
    const Cells::Range range = wall_cells_.cover(area);
    const auto cells = static_cast<double>(range.x1 - range.x0 + 1) *
                       static_cast<double>(range.y1 - range.y0 + 1);
    if (cells > std::max(many, 64.0)) {
      everywhere_.push_back(k);
      return Cells::Range{};
    }
    if (!range.empty()) grow(wall_area_, area);
    return range;
  });
  area_ = wall_area_;
}

void Map::file_discs() {
  // Four slots per disc keep lists of one or two where bodies are as dense as robots ever stand.
  const auto count = static_cast<std::uint32_t>(discs_.size());
  const std::uint32_t columns = std::max(
      16u, std::bit_ceil(static_cast<std::uint32_t>(std::sqrt(4.0 * static_cast<double>(count)))));
  if (disc_cells_.columns() != columns) disc_cells_.resize(cell_m_, columns, columns);
  area_ = wall_area_;
  disc_cells_.build(count, [&](std::uint32_t k) {
    const Disc& disc = discs_[k];
    if (!(disc.radius_m > 0)) return Cells::Range{};
    const Area area = around(disc.centre, disc.radius_m);
    const Cells::Range range = disc_cells_.cover(area);
    if (!range.empty()) grow(area_, area);
    return range;
  });
}

void Map::walls_near(Area area, std::vector<std::uint32_t>& out) const {
  out.assign(everywhere_.begin(), everywhere_.end());
  const Cells::Range range = wall_cells_.cover(area);
  for (std::int64_t j = range.y0; j <= range.y1; ++j)
    for (std::int64_t i = range.x0; i <= range.x1; ++i) {
      const auto walls = wall_cells_.in_slot(wall_cells_.slot(i, j));
      out.insert(out.end(), walls.begin(), walls.end());
    }
  if (out.size() < 2) return;
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

void Map::overlaps(OverlapQuery ball, std::vector<std::uint32_t>& bodies) const {
  const auto begin = static_cast<std::ptrdiff_t>(bodies.size());
  const Vec2 centre{ball.centre_W.x, ball.centre_W.y};
  const Area area = around(centre, ball.radius_m);
  // At its height nearest to the ball's centre a thing meets a smaller circle of the ball.
  const auto radius_at = [&](Heights h) {
    const double dz = gap(ball.centre_W.z, h);
    return dz <= ball.radius_m ? std::sqrt(ball.radius_m * ball.radius_m - dz * dz) : -1;
  };
  const Cells::Range discs = disc_cells_.cover(area);
  for (std::int64_t j = discs.y0; j <= discs.y1; ++j)
    for (std::int64_t i = discs.x0; i <= discs.x1; ++i)
      for (const std::uint32_t k : disc_cells_.in_slot(disc_cells_.slot(i, j))) {
        const double radius = radius_at(discs_[k].heights);
        if (radius >= 0 && touches(centre, radius, discs_[k])) bodies.push_back(discs_[k].body);
      }
  const auto meet_wall = [&](std::uint32_t k) {
    const double radius = radius_at(walls_[k].outline.heights);
    if (radius >= 0 && nearest(walls_[k].outline, edges_, centre).distance_m <= radius)
      bodies.push_back(walls_[k].body);
  };
  for (const std::uint32_t k : everywhere_) meet_wall(k);
  const Cells::Range walls = wall_cells_.cover(area);
  for (std::int64_t j = walls.y0; j <= walls.y1; ++j)
    for (std::int64_t i = walls.x0; i <= walls.x1; ++i)
      for (const std::uint32_t k : wall_cells_.in_slot(wall_cells_.slot(i, j))) meet_wall(k);
  std::sort(bodies.begin() + begin, bodies.end());
  bodies.erase(std::unique(bodies.begin() + begin, bodies.end()), bodies.end());
}

/// A line in 3D, its parameter t in metres along it, and the nearest thing met so far.
struct Map::Ray {
  Vec2 origin, direction;
  double z, dz;
  double length2, inverse_length2;  ///< of `direction`
  double min_m;
  double best_m;
  std::uint32_t body = no_body;
  bool found = false;

  /// The first point of the prism over a chord at or behind min_m.
  void meet(Chord c, Heights h, std::uint32_t thing) {
    if (dz == 0) {
      if (z < h.min_m || z > h.max_m) return;
    } else {
      const double a = (h.min_m - z) / dz, b = (h.max_m - z) / dz;
      c.first = std::max(c.first, std::min(a, b));
      c.last = std::min(c.last, std::max(a, b));
    }
    if (!(c.first <= c.last)) return;
    const double t = c.first >= min_m ? c.first : c.last;
    if (!(t >= min_m) || t > best_m) return;
    if (t == best_m && found && thing >= body) return;
    best_m = t;
    body = thing;
    found = true;
  }
};

void Map::meet_walls(Ray& ray, std::span<const std::uint32_t> walls, std::uint32_t ignored) const {
  for (const std::uint32_t k : walls) {
    const Wall& wall = walls_[k];
    if (wall.instance == ignored) continue;
    if (ray.dz == 0 && (ray.z < wall.outline.heights.min_m || ray.z > wall.outline.heights.max_m)) continue;
    ray.meet(chord(wall.outline, edges_, ray.origin, ray.direction), wall.outline.heights, wall.body);
  }
}

void Map::meet_discs(Ray& ray, std::span<const std::uint32_t> discs, std::uint32_t ignored) const {
  for (const std::uint32_t k : discs) {
    const Disc& disc = discs_[k];
    const Chord c = chord_of_circle(disc.centre - ray.origin, disc.radius_m, ray.direction, ray.length2,
                                    ray.inverse_length2);
    if (c.first <= c.last && k != ignored) ray.meet(c, disc.heights, disc.body);
  }
}

void Map::cast(Ray& ray, std::uint32_t ignored) const {
  meet_walls(ray, everywhere_, ignored);
  if (!(area_.low.x <= area_.high.x)) return;
  // Only the part over the rectangle of all there is, where the walk has somewhere to end.
  double begin = ray.min_m, end = ray.best_m;
  const Vec2 o = ray.origin, d = ray.direction;
  const Vec2 per{1 / d.x, 1 / d.y};
  if (d.x != 0) {
    const double a = (area_.low.x - o.x) * per.x, b = (area_.high.x - o.x) * per.x;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  } else if (!(o.x >= area_.low.x && o.x <= area_.high.x)) {
    return;
  }
  if (d.y != 0) {
    const double a = (area_.low.y - o.y) * per.y, b = (area_.high.y - o.y) * per.y;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  } else if (!(o.y >= area_.low.y && o.y <= area_.high.y)) {
    return;
  }
  if (!(begin <= end)) return;
  const Vec2 entry = o + begin * d;
  if (!(std::abs(entry.x) < 1e13 && std::abs(entry.y) < 1e13))
    return;  // not finite, or no map reaches so far

  // J. Amanatides, A. Woo, A fast voxel traversal algorithm for ray tracing (1987).
  std::int64_t i = wall_cells_.cell(entry.x), j = wall_cells_.cell(entry.y);
  const std::int64_t step_i = d.x < 0 ? -1 : 1, step_j = d.y < 0 ? -1 : 1;
  const double next_x = cell_m_ * static_cast<double>(i + (d.x < 0 ? 0 : 1));
  const double next_y = cell_m_ * static_cast<double>(j + (d.y < 0 ? 0 : 1));
  double t_x = d.x != 0 ? (next_x - o.x) * per.x : inf, t_y = d.y != 0 ? (next_y - o.y) * per.y : inf;
  const double delta_x = cell_m_ * std::abs(per.x), delta_y = cell_m_ * std::abs(per.y);
  for (;;) {
    meet_discs(ray, disc_cells_.in_slot(disc_cells_.slot(i, j)), ignored);
    meet_walls(ray, wall_cells_.in_slot(wall_cells_.slot(i, j)), ignored);
    const double leave = std::min(t_x, t_y);
    if (ray.best_m <= leave || !(leave <= end)) return;
    if (t_x < t_y) {
      t_x += delta_x;
      i += step_i;
    } else {
      t_y += delta_y;
      j += step_j;
    }
  }
}

void Map::cast(const RayJob& job, std::uint32_t ignored) const {
  const Vec3 x = rotate(job.X_WS.q, {1, 0, 0}), y = rotate(job.X_WS.q, {0, 1, 0}),
             z = rotate(job.X_WS.q, {0, 0, 1});
  const Vec3 o = job.X_WS.p;
  for (std::size_t i = 0; i < job.directions.size(); ++i) {
    const Vec3 s = job.directions[i];
    const Vec2 d{x.x * s.x + y.x * s.y + z.x * s.z, x.y * s.x + y.y * s.y + z.y * s.z};
    Ray ray{{o.x, o.y},    d,         o.z,      x.z * s.x + y.z * s.y + z.z * s.z, dot(d, d),
            1 / dot(d, d), job.min_m, job.max_m};
    if (ray.length2 > 1e-20) cast(ray, ignored);
    job.distance_m[i] = ray.found ? static_cast<float>(ray.best_m) : std::numeric_limits<float>::infinity();
    if (!job.body.empty()) job.body[i] = ray.body;
  }
}

}  // namespace sandlot::planar
