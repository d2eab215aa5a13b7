#pragma once
/// Signed distance field of an occupancy grid: how far each point is from the nearest surface.
///
///   not occupied   distance to the centre of the nearest occupied cell
///   occupied       0 in cells on the surface, and less the deeper inside: -(distance to the centre of the nearest cell that is
///                  not occupied, less a cell)
///
/// Frame    the map's. Between centres distances are interpolated bilinearly.
/// Errors   those of check_geometry(), data that does not fit the map's size, a map without an occupied cell.
/// Limits   unknown cells are not obstacles. The surface is where the centres of its cells are: half a cell behind it if
///          the map was drawn with filled cells.
/// Cost     twice that of maps/distance.h; memory four bytes a cell.
#include <cstdint>
#include <span>
#include <vector>

#include "navigation/maps/occupancy.h"

namespace sandlot::navigation {

class DistanceField {
 public:
  /// Cells of at least `occupied_percent` are occupied.
  /// @param max_distance_m  greater distances read as this one, on both sides
  static Result<DistanceField> make(const GridMap& map, int occupied_percent, double max_distance_m);

  struct Sample {
    double distance_m = 0;  ///< negative inside
    Vec2 gradient_M;        ///< about 1 long, out of the obstacle; nearly (0, 0) in walls of one or two cells
  };
  /// Whether the point is on the map, and the field there.
  bool sample(Vec2 p_M, Sample& out) const;

  const GridGeometry& geometry() const { return geometry_; }
  const GridFrame& frame() const { return frame_; }
  float at(Cell c) const { return distance_m_[geometry_.index(c)]; }
  /// Of all cells, row by row.
  std::span<const float> distances() const { return distance_m_; }

 private:
  explicit DistanceField(const GridGeometry& geometry) : geometry_(geometry), frame_(geometry) {}
  GridGeometry geometry_;
  GridFrame frame_;
  std::vector<float> distance_m_;
};

}  // namespace sandlot::navigation
