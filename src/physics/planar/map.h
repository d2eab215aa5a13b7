#pragma once
/// Map of the plane for rays and overlap queries: discs and silhouettes of moving bodies and outlines of
/// static ones, in grids of cells.
///
/// A thing here is an upright prism: its outline over its heights, with a lid and a bottom. Answers do not
/// depend on the size of the cells: a ray's distance to a thing is computed from the ray and the thing alone.
///
/// Limits   a ray parallel to z hits nothing.
/// Cost     360 rays of 5 m among discs, one per 2 m^2: 85 ns each; 24 rays of 0.1 m: 6 ns each. Where there are at
///          most 64 things, many long rays of one job look only at those in their direction. No allocation.
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/rays.h"
#include "physics/engine.h"
#include "physics/planar/hash_grid.h"
#include "physics/planar/outline.h"

namespace sandlot::planar {

/// The footprint of one moving group, or a circle around its silhouette; `body` is what rays and contacts
/// call it.
struct alignas(64) Disc {
  Vec2 centre;
  double radius_m = 0;  ///< 0: nothing to meet
  Heights heights;
  std::uint32_t body = no_body;
  std::uint32_t instance = ~0u;    ///< slot
  std::uint32_t silhouette = ~0u;  ///< ~0u: the disc is all
};

/// A moving group that is more than a disc, where it is now.
struct Silhouette {
  std::vector<Outline> parts;
  std::vector<Edge> edges;
  std::vector<std::uint32_t> bodies;  ///< by part
};

/// The outline of one shape that never moves.
struct Wall {
  Outline outline;
  std::uint32_t body = no_body;
  std::uint32_t instance = ~0u;  ///< slot
  std::uint32_t ordinal = 0;     ///< among those of its instance
  const model::Collision* collision = nullptr;
  std::uint32_t link = 0;  ///< of its instance
};

class Map {
 public:
  explicit Map(double cell_m) : cell_m_(cell_m) {}

  /// Replaces the walls. Their order decides which of two counts first, so it has to be that of creation.
  void set_walls(std::span<const Wall> walls, std::span<const Edge> edges);
  /// By group. Whoever changes them calls file_discs() before the next question.
  std::vector<Disc>& discs() { return discs_; }
  std::vector<Silhouette>& silhouettes() { return silhouettes_; }
  /// Files the discs under the cells where they are now.
  void file_discs();

  std::span<const Wall> walls() const { return walls_; }
  std::span<const Edge> edges() const { return edges_; }

  /// Indices of walls that may touch an area, ascending, each once.
  void walls_near(Area area, std::vector<std::uint32_t>& out) const;
  /// Bodies that meet a ball, ascending, each once, appended.
  void overlaps(OverlapQuery ball, std::vector<std::uint32_t>& bodies) const;

  /// @param ignored  slot of the instance that the rays do not see, or ~0u
  void cast(const RayJob& job, std::uint32_t ignored) const;
  /// Asks for the memory of the discs that the rays of a job, soon to be cast, may meet.
  void expect(const RayJob& job) const;

 private:
  struct Ray;
  struct Hit;
  struct Reach;
  struct Fan;
  struct Start;
  Start start_at(Vec2 entry, Vec2 origin) const;
  bool clip(const Ray& ray, double& begin, double& end) const;
  template <bool with_walls>
  void walk(const Ray& ray, const Start* shared, Hit& hit) const;
  bool gather(const RayJob& job, std::uint32_t ignored, Reach& reach) const;
  bool collect(const RayJob& job, std::uint32_t ignored, bool level, Fan& fan) const;
  bool spread(const RayJob& job, std::uint32_t ignored, Fan& fan) const;
  void meet_in_direction(const Ray& ray, const Fan& fan, Hit& hit) const;
  void meet_walls(const Ray& ray, std::span<const std::uint32_t> walls, Hit& hit) const;
  void meet_wall(const Ray& ray, std::uint32_t wall, Hit& hit) const;
  static bool passes_by(const Ray& ray, Vec2 centre, double radius_m, const Hit& hit);
  static void meet_part(const Ray& ray, const Silhouette& silhouette, std::size_t i, Hit& hit);
  void meet_silhouette(const Ray& ray, const Disc& disc, Hit& hit) const;
  void meet_all(const Ray& ray, Hit& hit) const;

  double cell_m_;
  std::vector<Wall> walls_;
  std::vector<Edge> edges_;
  std::vector<Disc> discs_;
  std::vector<Silhouette> silhouettes_;
  HashGrid wall_cells_, disc_cells_;
  /// By slot of wall_cells_: whether there is any. A hundredth of its size: rays of a swarm mostly are where
  /// none is.
  std::vector<bool> walled_;
  std::vector<std::uint32_t> everywhere_;  ///< walls so large that every query looks at them
  Area wall_area_, area_;                  ///< of the walls, and of all there is
  std::vector<std::uint32_t> filed_;       ///< discs that are in cells, ascending
  double longest_walk_m_ = 0;              ///< along x and y; beyond it, to look at everything is quicker
};

}  // namespace sandlot::planar
