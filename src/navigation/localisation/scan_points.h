#pragma once
/// Points of a laser scan in the plane of the robot's base, and the directions of the surfaces they lie on.
///
/// Frame    base_link B. The laser may be mounted in any orientation; its points are projected along z of B.
/// Errors   a ScanFault says why a scan has no points. Beams without an echo (+inf), too near (-inf), NaN, negative or
///          outside the limits are left out.
/// Limits   all beams are taken at one pose. Normals need about five beams on a surface without a gap.
/// Cost     linear in the number of beams; no allocation once the lists have grown to `max_points`.
#include <span>
#include <vector>

#include "base/fields.h"
#include "geometry/pose.h"
#include "geometry/vec2.h"
#include "messages/sensor_ranges.h"

namespace sandlot::navigation {

enum class ScanFault : std::uint8_t {
  none,
  bad_scan,   ///< angles or limits of range are not finite, or the angles are above 1e3 rad
  bad_mount,  ///< the laser's pose is not finite, above 1e3 m, or its orientation is no rotation
  no_beams,   ///< no beam has an echo within the limits
};

/// Part of a scan that is used.
struct ScanLimits {
  double min_range_m = 0;
  double max_range_m = 100;  ///< a beam of the scan's own range_max has no echo
  int max_points = 360;      ///< of more, as many are taken, evenly
};

struct ScanPoints {
  std::vector<Vec2> p_B;  ///< in the order of the beams
  std::vector<Vec2>
      normal_B;  ///< unit vectors towards the laser; (0, 0): not known. Empty before add_normals()
  Vec2 laser_B;
};

/// Fills `out` with the points of a scan, without normals.
/// @param X_BL  pose of the laser in the base
ScanFault take_points(const msg::LaserScan& scan, const Pose& X_BL, const ScanLimits& limits,
                      ScanPoints& out);

/// Normals of the lines through the points within `radius_m` (two on each side at least, 20 at most) that follow each
/// other without a gap above `max_gap_m`. Not known where they form no line: the variance across it is above
/// 5 % of that along it.
void add_normals(ScanPoints& points, double radius_m, double max_gap_m);

}  // namespace sandlot::navigation
