#pragma once
/// Occupancy grid: map of free, occupied and unknown cells, built from laser scans and the poses they were
/// taken at.
///
///   l += log(p / (1 - p))   with p = hit_probability where a beam ends, miss_probability where it passes
///
/// One scan changes a cell once, and a hit outweighs the beams that pass: beams that graze a wall do not
/// erase it.
///
/// Frame    M, the map's; the laser's pose is given in it. Beams lie in the plane.
/// Errors   beams that are NaN, too near (-inf, below range_min) or of a scan whose angles are not finite
///          change nothing; neither does a pose that is not finite.
/// Limits   poses are taken as exact: no loop closure. All beams of a scan are taken at one pose. Occupancy
///          of a cell is independent of its neighbours.
/// Cost     cells along the beams, about 3 ns each; memory of a scan: a byte for each cell within its range.
/// Source   S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), sec. 9.2.
#include <vector>

#include "messages/nav_msgs.h"
#include "messages/sensor_ranges.h"
#include "navigation/maps/grid.h"

namespace sandlot::navigation {

/// Map with the occupancy of its cells in percent, as nav_msgs/OccupancyGrid has it.
struct GridMap {
  static constexpr std::int8_t unknown = -1;
  GridGeometry geometry;
  std::vector<std::int8_t> occupancy;  ///< 0: free, 100: occupied, -1: unknown; row by row from cell (0, 0)
};

/// Message with the cells of a map; the header stays empty.
msg::OccupancyGrid to_message(const GridMap& map);
/// Map of a message. Errors: sizes that do not fit together, and those of check_geometry().
Result<GridMap> from_message(const msg::OccupancyGrid& message);

struct OccupancySpec {
  double hit_probability = 0.7;
  double miss_probability = 0.4;
  double min_probability = 0.03;
  double max_probability = 0.97;
  double max_range_m = 30;
  bool clear_without_echo = true;

  static void fields(auto& s, auto&& visit) {
    visit(
        Field{"hit_probability", "1", "Probability that a cell where a beam ends is occupied.", 0.501, 0.999},
        s.hit_probability);
    visit(Field{"miss_probability", "1", "Probability that a cell which a beam passes is occupied.", 0.001,
                0.499},
          s.miss_probability);
    visit(Field{"min_probability", "1", "Lower bound of a cell's probability, so that it can change again.",
                1e-6, 0.499},
          s.min_probability);
    visit(Field{"max_probability", "1", "Upper bound of a cell's probability, so that it can change again.",
                0.501, 0.999999},
          s.max_probability);
    visit(Field{"max_range", "m", "Part of a beam that is used; a longer beam marks free cells only.", 1e-3,
                1e4},
          s.max_range_m);
    visit(Field{"clear_without_echo", "", "Whether a beam without an echo marks its cells as free."},
          s.clear_without_echo);
  }
};

/// Log odds of the cells, which scans change. Plain data: a copy is a snapshot.
struct OccupancyState {
  std::vector<float> log_odds;     ///< 0: as likely free as occupied
  std::vector<std::uint8_t> seen;  ///< 1 where a beam ended or passed
  static void fields(auto& s, auto&& visit) {
    visit(Field{"log_odds", "1", "Logarithm of occupied over free, for each cell.", -1e3, 1e3, Field::none,
                max_cells},
          s.log_odds);
    visit(Field{"seen", "1", "Cells that beams reached. 0: unknown.", 0, 1, Field::none, max_cells}, s.seen);
  }
};

/// Grid that scans are drawn into.
class OccupancyMapper {
 public:
  /// Errors: those of check_geometry() and of the spec's ranges.
  static Result<OccupancyMapper> make(const OccupancySpec& spec, const GridGeometry& geometry);

  /// @param X_ML  pose of the laser in the map
  void add(const msg::LaserScan& scan, const Pose2& X_ML);
  /// Occupancy in percent, rounded; unknown where no beam was.
  GridMap map() const;

  const GridGeometry& geometry() const { return geometry_; }
  const OccupancyState& state() const { return state_; }
  /// Takes back a saved state; false, and no change, if it belongs to a grid of another size.
  bool restore(OccupancyState state);

 private:
  OccupancyMapper(const OccupancySpec& spec, const GridGeometry& geometry);
  OccupancySpec spec_;
  GridGeometry geometry_;
  GridFrame frame_;
  OccupancyState state_;
  float hit_, miss_, lowest_, highest_;
};

}  // namespace sandlot::navigation
