#pragma once
/// The straight pieces of what a planar scanner would see, from far fewer rays than a scan has.
///
/// A fan of rays `step` apart comes first. Between neighbours that do not lie on one straight line of one
/// link (an edge, a corner) further rays halve the gap, five times at most, so edges are found within step /
/// 32. Rays are exact, so straight pieces are straight: a chain of points is cut where it leaves its chord by
/// more than `tolerance`, at the farthest point (Ramer, Douglas, Peucker), so round things become polygons
/// that close to them.
///
/// Frame    S, angles as the scan's.
/// Limits   a thing between two rays of the first fan is missed; a full turn's seam cuts what lies there; two
///          walls of one link in one line, with a gap narrower than step, are one.
/// Cost     1 + fov / step rays and at most four times as many for edges; no allocation after the first
///          samples.
/// Source   D. Douglas, T. Peucker, Cartographica 10 (1973) 112-122; V. Nguyen et al., A comparison of line
///          extraction algorithms using 2D laser rangefinder (IROS 2005): split and merge.
#include <vector>

#include "base/math_list.h"
#include "geometry/rays.h"
#include "geometry/vec2.h"
#include "messages/line_segments.h"

namespace sandlot::laser_scanner {

class SegmentFinder {
 public:
  struct Fan {
    double first_rad = 0, last_rad = 0, step_rad = 0.035;
    double min_m = 0, tolerance_m = 0.01, min_length_m = 0.05;
  };
  /// @param job  pose, reach and body that is not seen; its spans are filled here
  void find(const Fan& fan, const RayCaster& rays, RayJob job, std::vector<msg::LineSegment>& out);

 private:
  struct Echo {
    double angle_rad = 0;
    Vec2 direction_S, point_S;
    double range_m = 0;  ///< to point_S
    std::uint32_t body = no_body;
    bool linked = false;  ///< to the next: one straight line of one link
  };
  void aim();
  void cast(const RayCaster& rays, RayJob job, double min_m);
  void link(double tolerance_m);
  void cut(std::size_t begin, std::size_t end, const Fan& fan, std::vector<msg::LineSegment>& out);

  Fan fan_;                  ///< for which `first_` was made
  std::vector<Echo> first_;  ///< its rays before they meet anything
  std::vector<Echo> echoes_, fresh_, merged_;
  std::vector<double> angles_rad_;
  std::vector<math::SinCos> sin_cos_;
  std::vector<Vec3> directions_;
  std::vector<float> distances_m_;
  std::vector<std::uint32_t> bodies_;
  std::vector<std::pair<std::size_t, std::size_t>> pieces_;
};

}  // namespace sandlot::laser_scanner
