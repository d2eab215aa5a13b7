#include "physics/planar/map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "base/prefetch.h"

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

/// Columns or rows for things spread over `length_m`: one cell each up to a limit, beyond which cells share
/// slots.
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
    const HashGrid::Range range = wall_cells_.cover(area);
    const auto cells = static_cast<double>(range.x1 - range.x0 + 1) *
                       static_cast<double>(range.y1 - range.y0 + 1);
    if (cells > std::max(many, 64.0)) {
      everywhere_.push_back(k);
      return HashGrid::Range{};
    }
    if (!range.empty()) grow(wall_area_, area);
    return range;
  });
  area_ = wall_area_;
  walled_.assign(std::size_t{wall_cells_.columns()} * wall_cells_.rows(), false);
  for (std::uint32_t slot = 0; slot < walled_.size(); ++slot)
    walled_[slot] = !wall_cells_.in_slot(slot).empty();
}

void Map::file_discs() {
  // Four slots per disc keep lists of one or two where bodies are as dense as robots ever stand.
  const auto count = static_cast<std::uint32_t>(discs_.size());
  const std::uint32_t columns = std::max(
      16u, std::bit_ceil(static_cast<std::uint32_t>(std::sqrt(4.0 * static_cast<double>(count)))));
  if (disc_cells_.columns() != columns) disc_cells_.resize(cell_m_, columns, columns);
  area_ = wall_area_;
  filed_.clear();
  disc_cells_.build(count, [&](std::uint32_t k) {
    const Disc& disc = discs_[k];
    if (!(disc.radius_m > 0)) return HashGrid::Range{};
    const Area area = around(disc.centre, disc.radius_m);
    const HashGrid::Range range = disc_cells_.cover(area);
    if (range.empty()) return range;
    grow(area_, area);
    filed_.push_back(k);
    return range;
  });
  // Of few things, three are looked at in the time of a step to the next cell. Among many, a ray mostly ends
  // soon.
  constexpr std::size_t few = 48;
  const std::size_t things = filed_.size() + walls_.size();
  const std::size_t cells = things <= few ? things / 3 : std::max<std::size_t>(1024, 2 * things);
  longest_walk_m_ = cell_m_ * static_cast<double>(cells);
}

void Map::walls_near(Area area, std::vector<std::uint32_t>& out) const {
  out.assign(everywhere_.begin(), everywhere_.end());
  const HashGrid::Range range = wall_cells_.cover(area);
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
  const HashGrid::Range discs = disc_cells_.cover(area);
  for (std::int64_t j = discs.y0; j <= discs.y1; ++j)
    for (std::int64_t i = discs.x0; i <= discs.x1; ++i)
      for (const std::uint32_t k : disc_cells_.in_slot(disc_cells_.slot(i, j))) {
        const double radius = radius_at(discs_[k].heights);
        if (!(radius >= 0 && touches(centre, radius, discs_[k]))) continue;
        if (discs_[k].silhouette == ~0u) {
          bodies.push_back(discs_[k].body);
          continue;
        }
        const Silhouette& silhouette = silhouettes_[discs_[k].silhouette];
        for (std::size_t part = 0; part < silhouette.parts.size(); ++part) {
          const Outline& outline = silhouette.parts[part];
          const double across = radius_at(outline.heights), most = across + outline.radius_m + 1e-6;
          const Vec2 off = outline.centre - centre;
          if (across >= 0 && dot(off, off) <= most * most &&
              nearest(outline, silhouette.edges, centre).distance_m <= across)
            bodies.push_back(silhouette.bodies[part]);
        }
      }
  const auto meet_wall = [&](std::uint32_t k) {
    const double radius = radius_at(walls_[k].outline.heights);
    if (radius >= 0 && nearest(walls_[k].outline, edges_, centre).distance_m <= radius)
      bodies.push_back(walls_[k].body);
  };
  for (const std::uint32_t k : everywhere_) meet_wall(k);
  const HashGrid::Range walls = wall_cells_.cover(area);
  for (std::int64_t j = walls.y0; j <= walls.y1; ++j)
    for (std::int64_t i = walls.x0; i <= walls.x1; ++i)
      for (const std::uint32_t k : wall_cells_.in_slot(wall_cells_.slot(i, j))) meet_wall(k);
  std::sort(bodies.begin() + begin, bodies.end());
  bodies.erase(std::unique(bodies.begin() + begin, bodies.end()), bodies.end());
}

// --- rays ---------------------------------------------------------------------------------------------------------

/// A line in 3D with its parameter t in metres along it.
struct Map::Ray {
  Vec2 origin, direction;
  double z, dz;
  double length2, inverse_length2;  ///< of `direction`
  double min_m, max_m;
  std::uint32_t ignored;  ///< slot
};

/// The nearest thing met so far.
struct Map::Hit {
  double t;  ///< max_m until something is found
  std::uint32_t body = no_body;
  bool found = false;

  /// The first point at or behind min_m of the prism over a chord.
  void meet(const Ray& ray, Chord c, Heights h, std::uint32_t thing) {
    if (ray.dz == 0) {
      if (ray.z < h.min_m || ray.z > h.max_m) return;
    } else {
      const double a = (h.min_m - ray.z) / ray.dz, b = (h.max_m - ray.z) / ray.dz;
      c.first = std::max(c.first, std::min(a, b));
      c.last = std::min(c.last, std::max(a, b));
      if (!(c.first <= c.last)) return;
    }
    const double at = c.first >= ray.min_m ? c.first : c.last;
    if (!(at >= ray.min_m) || at > t) return;
    if (at == t && found && thing >= body) return;
    t = at;
    body = thing;
    found = true;
  }
  void meet(const Ray& ray, const Disc& disc) {
    const Chord c = chord_of_circle(disc.centre - ray.origin, disc.radius_m, ray.direction, ray.length2,
                                    ray.inverse_length2);
    if (c.first <= c.last) meet(ray, c, disc.heights, disc.body);
  }
};

inline void Map::meet_wall(const Ray& ray, std::uint32_t k, Hit& hit) const {
  const Wall& wall = walls_[k];
  const Heights h = wall.outline.heights;
  if (wall.instance == ray.ignored || (ray.dz == 0 && (ray.z < h.min_m || ray.z > h.max_m))) return;
  const Chord c = chord(wall.outline, edges_, ray.origin, ray.direction);
  if (c.first <= c.last) hit.meet(ray, c, h, wall.body);
}

void Map::meet_walls(const Ray& ray, std::span<const std::uint32_t> walls, Hit& hit) const {
  for (const std::uint32_t k : walls) meet_wall(ray, k, hit);
}

/// True when nothing within a circle can be what the ray meets first. The margin is far beyond rounding, so that the exact
/// outlines inside decide alone.
inline bool Map::passes_by(const Ray& ray, Vec2 centre, double radius_m, const Hit& hit) {
  const Chord c = chord_of_circle(centre - ray.origin, radius_m * (1 + 1e-9) + 1e-9, ray.direction,
                                  ray.length2, ray.inverse_length2);
  return !(c.first <= c.last) || c.first > hit.t || c.last < ray.min_m;
}

inline void Map::meet_part(const Ray& ray, const Silhouette& silhouette, std::size_t i, Hit& hit) {
  const Outline& part = silhouette.parts[i];
  if (ray.dz == 0 && (ray.z < part.heights.min_m || ray.z > part.heights.max_m)) return;
  if (passes_by(ray, part.centre, part.radius_m, hit)) return;
  const Chord c = chord(part, silhouette.edges, ray.origin, ray.direction);
  if (c.first <= c.last) hit.meet(ray, c, part.heights, silhouette.bodies[i]);
}

void Map::meet_silhouette(const Ray& ray, const Disc& disc, Hit& hit) const {
  if (passes_by(ray, disc.centre, disc.radius_m, hit)) return;
  const Silhouette& silhouette = silhouettes_[disc.silhouette];
  for (std::size_t i = 0; i < silhouette.parts.size(); ++i) meet_part(ray, silhouette, i, hit);
}

/// The same as a walk, without cells: where there are few things, or one is lost far away, those are too many.
void Map::meet_all(const Ray& ray, Hit& hit) const {
  for (const std::uint32_t k : filed_) {
    const Disc& disc = discs_[k];
    if (disc.instance == ray.ignored) continue;
    if (disc.silhouette == ~0u) hit.meet(ray, disc);
    else meet_silhouette(ray, disc, hit);
  }
  for (std::uint32_t k = 0; k < walls_.size(); ++k)
    if (!passes_by(ray, walls_[k].outline.centre, walls_[k].outline.radius_m, hit)) meet_wall(ray, k, hit);
}

/// The cell in which a walk begins and where its edges are, from the ray's origin. Rays of one job mostly
/// share it.
struct Map::Start {
  std::int64_t i, j;
  Vec2 low, high;
};

Map::Start Map::start_at(Vec2 entry, Vec2 origin) const {
  const std::int64_t i = disc_cells_.cell(entry.x), j = disc_cells_.cell(entry.y);
  const Vec2 corner{cell_m_ * static_cast<double>(i), cell_m_ * static_cast<double>(j)};
  return {i, j, corner - origin, corner + Vec2{cell_m_, cell_m_} - origin};
}

/// Cuts [begin, end] of the ray down to the part over the rectangle of all there is; false when none is left.
bool Map::clip(const Ray& ray, double& begin, double& end) const {
  const auto between = [&](double o, double d, double low, double high) {
    if (d == 0) return o >= low && o <= high;
    const double a = (low - o) / d, b = (high - o) / d;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
    return begin <= end;
  };
  return between(ray.origin.x, ray.direction.x, area_.low.x, area_.high.x) &&
         between(ray.origin.y, ray.direction.y, area_.low.y, area_.high.y);
}

/// Follows a ray from cell to cell until the nearest thing met lies before the next one.
/// J. Amanatides, A. Woo, A fast voxel traversal algorithm for ray tracing (1987).
/// @param shared  where rays of this job begin if that is over the map; otherwise null
/// Inlined by force: a ray then stays in registers, which makes it a tenth faster.
template <bool with_walls>
[[gnu::always_inline]] inline void Map::walk(const Ray& ray_in, const Start* shared, Hit& hit_out) const {
  const Ray ray = ray_in;
  Hit hit = hit_out;
  double begin = ray.min_m, end = hit.t;
  Start start;
  if (shared) {
    start = *shared;
  } else {
    if (!clip(ray, begin, end)) return;
    const Vec2 entry = ray.origin + begin * ray.direction;
    if (!(std::abs(entry.x) < 1e13 && std::abs(entry.y) < 1e13))
      return;  // not finite, or no map reaches so far
    start = start_at(entry, ray.origin);
  }
  const Vec2 d = ray.direction, per{1 / d.x, 1 / d.y};
  if (shared) {
    // NaN, of a ray along the map's border, loses against `end` in std::min.
    end = std::min(end, ((d.x < 0 ? area_.low.x : area_.high.x) - ray.origin.x) * per.x);
    end = std::min(end, ((d.y < 0 ? area_.low.y : area_.high.y) - ray.origin.y) * per.y);
  }
  // Nor from so far away that a step of one cell would be lost in rounding.
  if (std::max(end - begin, 1e-8 * end) * (std::abs(d.x) + std::abs(d.y)) > longest_walk_m_) [[unlikely]]
    return meet_all(ray_in, hit_out);
  constexpr double level = 1e-300;  // 1 / d would be infinite, and 0 times that no number
  double t_x = std::abs(d.x) > level ? (d.x < 0 ? start.low.x : start.high.x) * per.x : inf;
  double t_y = std::abs(d.y) > level ? (d.y < 0 ? start.low.y : start.high.y) * per.y : inf;
  const double delta_x = cell_m_ * std::abs(per.x), delta_y = cell_m_ * std::abs(per.y);
  HashGrid::Walk discs = disc_cells_.walk_from(start.i, start.j),
                 walls = wall_cells_.walk_from(start.i, start.j);
  const std::uint32_t step_i = d.x < 0 ? ~0u : 1u;
  const std::uint32_t disc_row = d.y < 0 ? 0u - discs.columns : discs.columns;
  [[maybe_unused]] const std::uint32_t wall_row = d.y < 0 ? 0u - walls.columns : walls.columns;
  const Disc* const disc = discs_.data();
  for (;;) {
    const std::uint32_t slot = discs.slot();
    for (std::uint32_t k = discs.start[slot]; k < discs.start[slot + 1]; ++k)
      if (const Disc& met_disc = disc[discs.things[k]]; met_disc.instance != ray.ignored) {
        if (met_disc.silhouette == ~0u) {
          hit.meet(ray, met_disc);
        } else [[unlikely]] {
          // Copies, so that the others may stay in registers.
          const Ray same = ray;
          Hit met = hit;
          meet_silhouette(same, met_disc, met);
          hit = met;
        }
      }
    if constexpr (with_walls) meet_walls(ray, wall_cells_.in_slot(walls.slot()), hit);
    end = std::min(end, hit.t);
    if (!(std::min(t_x, t_y) < end)) break;
    if (t_x < t_y) {
      t_x += delta_x;
      discs.i += step_i;
      if constexpr (with_walls) walls.i += step_i;
    } else {
      t_y += delta_y;
      discs.row += disc_row;
      if constexpr (with_walls) walls.row += wall_row;
    }
  }
  hit_out = hit;
}

/// Discs that rays of one job can reach at all, if there are few: short rays then need no walk.
struct Map::Reach {
  static constexpr std::size_t most = 24;
  static constexpr std::int64_t most_cells = 16;
  std::uint32_t count = 0;
  const Disc* discs[most];
};

bool Map::gather(const RayJob& job, std::uint32_t ignored, Reach& reach) const {
  const Vec2 o{job.X_WS.p.x, job.X_WS.p.y};
  const Area area = around(o, job.max_m);
  const HashGrid::Range range = disc_cells_.cover(area);
  if (range.empty() || (range.x1 - range.x0 + 1) * (range.y1 - range.y0 + 1) > Reach::most_cells)
    return false;
  for (std::int64_t j = range.y0; j <= range.y1; ++j)
    for (std::int64_t i = range.x0; i <= range.x1; ++i) {
      if (!walls_.empty() && walled_[wall_cells_.slot(i, j)]) return false;
      for (const std::uint32_t k : disc_cells_.in_slot(disc_cells_.slot(i, j))) {
        const Disc* const disc = &discs_[k];
        if (disc->instance == ignored || !touches(o, job.max_m + 1e-6, *disc)) continue;
        if (std::find(reach.discs, reach.discs + reach.count, disc) != reach.discs + reach.count) continue;
        if (reach.count == Reach::most) return false;
        reach.discs[reach.count++] = disc;
      }
    }
  return true;
}

/// Things that many rays from one place may meet, by sectors of direction: a ray then looks at those of its sector, the nearest
/// first. To level rays, parts of silhouettes are things of their own: most have none at their height.
struct Map::Fan {
  static constexpr std::size_t most = 64, fewest_rays = 16;
  static constexpr int sectors = 64;
  static constexpr std::uint32_t wall = ~0u, whole = ~0u - 1;
  struct Thing {
    double near_m;  ///< none of it is nearer
    Vec2 centre;    ///< from the rays' origin
    double radius_m;
    std::uint32_t index;  ///< of a disc or wall
    std::uint32_t part;   ///< of the disc's silhouette, `whole` or `wall`
  };
  std::size_t count = 0;
  std::array<Thing, most> things;
  std::array<std::uint64_t, sectors> in_sector;  ///< bit k: things[k]

  /// Grows with the angle of d, counter-clockwise from -x; within [0, sectors).
  static int sector(Vec2 d) {
    const double across = d.y / (std::abs(d.x) + std::abs(d.y));
    const double turn = d.x < 0 ? (across < 0 ? -across : 4 - across) : 2 + across;
    return std::min(static_cast<int>(turn * (sectors / 4)), sectors - 1);
  }
};

/// Fills fan.things, in any order. @return false when there are too many
bool Map::collect(const RayJob& job, std::uint32_t ignored, bool level, Fan& fan) const {
  const Vec2 o{job.X_WS.p.x, job.X_WS.p.y};
  fan.count = 0;
  bool fits = true;
  const auto add = [&](Vec2 centre, double radius_m, std::uint32_t index, std::uint32_t part) {
    const Vec2 c = centre - o;
    // As in passes_by(): far beyond rounding, so that the exact outlines decide alone.
    const double r = radius_m * (1 + 1e-9) + 1e-9, near_m = std::sqrt(dot(c, c)) * (1 - 1e-9) - r;
    if (near_m > job.max_m * (1 + 1e-6)) return;
    fits = fits && fan.count < Fan::most;
    if (fits) fan.things[fan.count++] = {near_m, c, r, index, part};
  };
  const auto add_outline = [&](const Outline& outline, std::uint32_t index, std::uint32_t part) {
    const Heights h = outline.heights;
    if (!level || (job.X_WS.p.z >= h.min_m && job.X_WS.p.z <= h.max_m))
      add(outline.centre, outline.radius_m, index, part);
  };
  for (const std::uint32_t k : filed_) {
    const Disc& disc = discs_[k];
    if (disc.instance == ignored) continue;
    if (!level || disc.silhouette == ~0u) {
      add(disc.centre, disc.radius_m, k, Fan::whole);
      continue;
    }
    const std::vector<Outline>& parts = silhouettes_[disc.silhouette].parts;
    for (std::uint32_t i = 0; i < parts.size(); ++i) add_outline(parts[i], k, i);
  }
  for (std::uint32_t k = 0; k < walls_.size(); ++k)
    if (walls_[k].instance != ignored) add_outline(walls_[k].outline, k, Fan::wall);
  return fits;
}

/// @return false when there are too many things for it to be worth while, or too few rays
bool Map::spread(const RayJob& job, std::uint32_t ignored, Fan& fan) const {
  if (job.directions.size() < Fan::fewest_rays || !(job.min_m >= 0)) return false;
  if (filed_.size() + walls_.size() > Fan::most) return false;
  const bool level = rotate(job.X_WS.q, {1, 0, 0}).z == 0 && rotate(job.X_WS.q, {0, 1, 0}).z == 0 &&
                     std::all_of(job.directions.begin(), job.directions.end(),
                                 [](const Vec3& d) { return d.z == 0; });
  if (!(level && collect(job, ignored, true, fan)) && !collect(job, ignored, false, fan)) return false;
  std::sort(fan.things.begin(), fan.things.begin() + static_cast<std::ptrdiff_t>(fan.count),
            [](const Fan::Thing& a, const Fan::Thing& b) { return a.near_m < b.near_m; });
  fan.in_sector.fill(0);
  for (std::size_t k = 0; k < fan.count; ++k) {
    const Fan::Thing& thing = fan.things[k];
    int first = 0, last = Fan::sectors - 1;
    const double far2 = dot(thing.centre, thing.centre);
    if (thing.near_m > 0 && far2 < 1e30) {
      // The tangents from the origin, longer than 1 by the same factor; a sector more on either side for their rounding.
      const double s = thing.radius_m, c = std::sqrt(std::max(0.0, far2 - s * s));
      const Vec2 m = thing.centre;
      first = Fan::sector({c * m.x + s * m.y, c * m.y - s * m.x}) - 1;
      last = Fan::sector({c * m.x - s * m.y, c * m.y + s * m.x}) + 1;
      if (last < first) last += Fan::sectors;
    }
    for (int i = first; i <= last; ++i)
      fan.in_sector[static_cast<std::size_t>(i) % Fan::sectors] |= std::uint64_t{1} << k;
  }
  return true;
}

void Map::meet_in_direction(const Ray& ray, const Fan& fan, Hit& hit) const {
  for (std::uint64_t left = fan.in_sector[static_cast<std::size_t>(Fan::sector(ray.direction))]; left != 0;
       left &= left - 1) {
    const Fan::Thing& thing = fan.things[static_cast<std::size_t>(std::countr_zero(left))];
    if (thing.near_m > 0 && thing.near_m * thing.near_m > hit.t * hit.t * ray.length2 * (1 + 1e-6)) return;
    if (thing.part == Fan::wall) {
      const Outline& outline = walls_[thing.index].outline;
      if (!passes_by(ray, outline.centre, outline.radius_m, hit)) meet_wall(ray, thing.index, hit);
    } else if (const Disc& disc = discs_[thing.index]; thing.part != Fan::whole) {
      meet_part(ray, silhouettes_[disc.silhouette], thing.part, hit);
    } else if (disc.silhouette == ~0u) {
      hit.meet(ray, disc);
    } else {
      meet_silhouette(ray, disc, hit);
    }
  }
}

void Map::expect(const RayJob& job) const {
  constexpr std::size_t few = 4096;  // that stay near the processor
  if (discs_.size() < few) return;
  const HashGrid::Range range = disc_cells_.cover(around({job.X_WS.p.x, job.X_WS.p.y}, job.max_m));
  if (range.empty() || (range.x1 - range.x0 + 1) * (range.y1 - range.y0 + 1) > Reach::most_cells) return;
  for (std::int64_t j = range.y0; j <= range.y1; ++j)
    for (std::int64_t i = range.x0; i <= range.x1; ++i)
      for (const std::uint32_t k : disc_cells_.in_slot(disc_cells_.slot(i, j))) prefetch(&discs_[k], 1);
}

void Map::cast(const RayJob& job, std::uint32_t ignored) const {
  const Vec3 x = rotate(job.X_WS.q, {1, 0, 0}), y = rotate(job.X_WS.q, {0, 1, 0}),
             z = rotate(job.X_WS.q, {0, 0, 1});
  const Vec3 o = job.X_WS.p;
  Reach reach;
  Fan fan;
  const bool near = gather(job, ignored, reach), spreads = !near && spread(job, ignored, fan);
  const bool anything = area_.low.x <= area_.high.x;
  const bool inside = o.x >= area_.low.x && o.y >= area_.low.y && o.x <= area_.high.x && o.y <= area_.high.y;
  const Start start = inside ? start_at({o.x, o.y}, {o.x, o.y}) : Start{};
  const Start* const shared = inside ? &start : nullptr;
  for (std::size_t i = 0; i < job.directions.size(); ++i) {
    const Vec3 s = job.directions[i];
    const Vec2 d{x.x * s.x + y.x * s.y + z.x * s.z, x.y * s.x + y.y * s.y + z.y * s.z};
    const double length2 = dot(d, d);
    // Most rays are level and of unit length up to rounding, where 2 - x is 1 / x.
    const double inverse_length2 = std::abs(length2 - 1) < 1e-9 ? 2 - length2 : 1 / length2;
    const Ray ray{{o.x, o.y}, d,         o.z,    x.z * s.x + y.z * s.y + z.z * s.z, length2, inverse_length2,
                  job.min_m,  job.max_m, ignored};
    Hit hit{job.max_m};
    if (length2 > 1e-20) {
      if (!spreads && !everywhere_.empty()) meet_walls(ray, everywhere_, hit);
      if (spreads) meet_in_direction(ray, fan, hit);
      else if (near)
        for (std::uint32_t k = 0; k < reach.count; ++k) {
          if (reach.discs[k]->silhouette == ~0u) hit.meet(ray, *reach.discs[k]);
          else meet_silhouette(ray, *reach.discs[k], hit);
        }
      else if (anything) walls_.empty() ? walk<false>(ray, shared, hit) : walk<true>(ray, shared, hit);
    }
    job.distance_m[i] = hit.found ? static_cast<float>(hit.t) : std::numeric_limits<float>::infinity();
    if (!job.body.empty()) job.body[i] = hit.body;
  }
}

}  // namespace sandlot::planar
