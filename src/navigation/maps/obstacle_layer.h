#pragma once
/// Obstacle layer: cells in which a laser saw obstacles, cleared by beams that pass and by time.
///
///   a beam ends in a cell     its trust becomes full
///   beams of a scan pass it   a quarter of its trust is lost: after four scans it is clear
///   time                      trust falls from full to none within `persistence`
///
/// A cell with any trust left is an obstacle. One scan changes a cell once, and a hit outweighs beams that pass.
///
/// Cells that a beam passed, and no obstacle is trusted in, are known to be free, until `persistence` has gone by. What is neither
/// is unknown: hidden, behind the robot, or out of range.
///
/// Frame    the map's.
/// Errors   beams that are NaN, too near or negative, and poses that are not finite, change nothing.
/// Limits   one plane; all beams of a scan are taken at one pose.
/// Cost     two bytes a cell; a scan about 3 ns for each cell along its beams; decay 0.2 ns a cell.
/// Source   marking and clearing as in Nav2's obstacle layer; trust that decays is ours.
#include <span>
#include <vector>

#include "geometry/pose.h"
#include "messages/sensor_ranges.h"
#include "navigation/maps/grid.h"
#include "navigation/maps/occupancy.h"

namespace sandlot::navigation {

struct ObstacleLayerSpec {
  double persistence_s = 60;
  double max_range_m = 8;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"persistence", "s", "Time after which an obstacle that is not seen again is forgotten.", 0.1,
                1e6},
          s.persistence_s);
    visit(Field{"max_range", "m", "Distance up to which beams mark obstacles.", 0.1, 1e3}, s.max_range_m);
  }
};

struct ObstacleLayerState {
  std::vector<std::uint8_t> trust;  ///< 255: seen just now, 0: no obstacle
  std::vector<std::uint8_t> free;   ///< 255: seen or driven through just now, 0: not known to be free
  double rest_s = 0;                ///< time that has not lowered trust yet

  void resize(std::size_t cells) {
    trust.assign(cells, 0);
    free.assign(cells, 0);
  }
  static void fields(auto& s, auto&& visit) {
    visit(Field{"trust", "1", "Trust in the obstacle of each cell, 255 at most.", 0, 255, Field::none,
                max_cells},
          s.trust);
    visit(Field{"free", "1", "Trust that each cell is free, 255 at most; 0: not known.", 0, 255, Field::none,
                max_cells},
          s.free);
    visit(Field{"rest", "s", "Time that has not lowered the trust yet."}, s.rest_s);
  }
};

/// End of a beam on an obstacle.
struct Echo {
  Vec2 p_M;
  std::size_t beam = 0;
  double range_m = 0;
};

/// Echoes of a scan within a range, in the order of its beams.
/// @param X_BL  pose of the laser on the robot; points are projected into the plane
void take_echoes(const msg::LaserScan& scan, const Pose& X_BL, const Pose2& X_MB, double max_range_m,
                 std::vector<Echo>& out);

/// Draws a scan into the layer. @param robot_radius_m  echoes nearer to the robot's origin are its own body
void mark_scan(const ObstacleLayerSpec& spec, const GridGeometry& geometry, ObstacleLayerState& state,
               const msg::LaserScan& scan, const Pose& X_BL, const Pose2& X_MB, double robot_radius_m);
void decay(const ObstacleLayerSpec& spec, ObstacleLayerState& state, double dt_s);
/// Forgets obstacles within a distance of a point, but not those nearer than `keep_m`.
void clear_near(const GridGeometry& geometry, ObstacleLayerState& state, Vec2 centre_M, double radius_m,
                double keep_m = 0);

}  // namespace sandlot::navigation
