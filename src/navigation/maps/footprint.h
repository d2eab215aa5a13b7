#pragma once
/// Footprint of a robot, and whether it touches an obstacle of a cost map at a pose.
///
/// Frame    corners in the robot's: x forward, y left, about the point whose pose is given.
/// Errors   fewer than three corners, sides that cross, numbers that are not finite or over 1000 m.
/// Limits   a polygon that is not convex counts, row by row of the grid, from its leftmost to its rightmost
///          point: never too small.
/// Cost     far from obstacles one look at the distance map (20 ns); near them, rows times corners.
#include <span>
#include <vector>

#include "navigation/maps/cost_map.h"

namespace sandlot::navigation {

class Footprint {
 public:
  static Result<Footprint> circle(double radius_m);
  static Result<Footprint> polygon(std::vector<Vec2> corners);
  /// @param front_m, back_m, left_m, right_m  distances of the sides from the robot's origin
  static Result<Footprint> rectangle(double front_m, double back_m, double left_m, double right_m);

  /// The footprint with its outline moved outward; corners stay corners. Errors: a margin that is negative, not
  /// finite, or so large that sides cross.
  Result<Footprint> grown(double margin_m) const;

  std::span<const Vec2> corners() const { return corners_; }  ///< none: a circle
  /// Radius of the largest circle about the origin within the footprint; 0 when the origin lies outside.
  double inscribed_m() const { return inscribed_; }
  /// Radius of the smallest circle about the origin around the footprint.
  double circumscribed_m() const { return circumscribed_; }

 private:
  std::vector<Vec2> corners_;
  double inscribed_ = 0, circumscribed_ = 0;
};

enum class Contact : std::uint8_t { none, obstacle, off_map };

/// Whether the footprint at a pose overlaps the square of a lethal cell, or reaches beyond the map. A pose that
/// is not finite is off the map.
/// @pre  `frame` is that of map.geometry
Contact footprint_contact(const CostMap& map, const GridFrame& frame, const Footprint& footprint,
                          const Pose2& X_MB);

}  // namespace sandlot::navigation
