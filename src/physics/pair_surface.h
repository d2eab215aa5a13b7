#pragma once
/// Combination of two touching surfaces: one law for all engines.
///
/// Substances  where both have one, physics/substance.h decides.
/// Friction    else: Coulomb, pairs combine by min(). A surface with fdir1 brings its two directions along.
/// Skin        multiplies what either law gives, along its axis. Where both have a skin, that with the
///             smaller ratio counts. Where the axis stands up from the surface (more than 71 deg) there is no
///             direction along: the value across holds both ways.
/// Bounce      the larger restitution counts, above the larger threshold.
/// Softness    springs in series, dampers add; slip and soft_cfm are compliances in series: they add.
///             soft_erp and the fastest correction: the smaller.
/// Rolling     resistances add. Belts: the difference of their velocities.
#include "physics/contact_rule.h"

namespace sandlot {

/// Without what depends on how they stand: fdir1_W, skins and belts.
PairSurface combine(const model::Surface& a, const model::Surface& b);

struct SurfaceSide {
  const model::Surface& surface;
  Quat q_WC;  ///< of the collision; identity for a zone of the ground
};
/// @param normal_W  unit
PairSurface combine(const SurfaceSide& a, const SurfaceSide& b, Vec3 normal_W);

/// Finds the zone that a point of the ground lies in.
class ZoneMap {
 public:
  ZoneMap() = default;
  explicit ZoneMap(std::span<const model::SurfaceZone> zones);
  bool empty() const { return zones_.empty(); }
  /// The last zone that holds the point, seen from above; null: none. Of a polygon's border the left and
  /// lower part belong to it, so that two polygons with a common side share no point and leave none out.
  const model::SurfaceZone* find(Vec3 point_W) const;

 private:
  struct Zone {
    model::SurfaceZone zone;
    double x0, x1, y0, y1;  ///< around it
  };
  std::vector<Zone> zones_;
};

}  // namespace sandlot
