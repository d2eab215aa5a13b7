#pragma once
/// Scan matching against an occupancy map: the pose at which a laser scan fits the map best.
///
///   refine()   Gauss-Newton on the distance field from a guess that is about right (half a metre, 20 degrees in rooms)
///   search()   correlative search over a window about a guess that is not, up to the whole map; then refine()
///
/// refine() compares each point p with the map along the scan's own normal n there: e = d(p) (grad d . n). The field
/// gives the signed distance, the scan the direction, which a grid has only in steps.
///
/// search() maximises the mean over the points of exp(-d^2 / (2 search_deviation^2)), over cells and turns of about a cell
/// at the farthest point. Maxima of the score over squares of 2^k cells bound what a square of offsets can reach; the best
/// bound is opened first, so the first single offset that comes up is the best of the window.
///
/// Frame     the map's. X_BL is the mount of the laser.
/// Errors    a MatchOutcome says why there is no match; then the pose is the guess or the last try, and its
///           covariance unknown.
/// Limits    the covariance takes points as independent, and adds the error of the grid (resolution^2 / 12) once.
///           Where the map looks alike, search() gives one of the places: `score` says how well it fits, not that no
///           other does. Along a corridor the guess stays (`observable` < 3).
/// Cost      refine(): about 0.1 us a point and step. search(): depends on the window; in a room a metre and 30 degrees
///           take half a millisecond, 16 m and all turns 10 ms. Memory: up to 12 bytes a cell.
/// Source    E. B. Olson, Real-time correlative scan matching (2009); W. Hess, D. Kohler, H. Rapp, D. Andor, Real-time
///           loop closure in 2D LIDAR SLAM (2016), sec. V-B. The projection onto the scan's normals is ours.
#include "base/node.h"
#include "navigation/localisation/distance_field.h"
#include "navigation/localisation/planar.h"
#include "navigation/localisation/scan_points.h"

namespace sandlot::navigation {

struct MapMatchSpec {
  int occupied_percent = 65;
  double min_range_m = 0, max_range_m = 100;
  int max_points = 360;
  double reach_m = 0.6;
  int max_steps = 40;
  double range_deviation_m = 0.02;
  double normal_radius_m = 0.25, max_gap_m = 0.4;
  double min_share = 0.4;
  double weakest_direction = 0.01;
  double search_distance_m = 1, search_angle_rad = 0.5, search_deviation_m = 0.1, min_score = 0.5;
  int search_points = 120;
  int max_evaluations = 2'000'000;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"occupied", "%", "Occupancy from which a cell is an obstacle.", 1, 100}, s.occupied_percent);
    visit(Field{"min_range", "m", "Shortest distance that is used.", 0, 1e4}, s.min_range_m);
    visit(Field{"max_range", "m", "Longest distance that is used.", 0.01, 1e4}, s.max_range_m);
    visit(Field{"max_points", "1", "Number of points that are used, taken evenly.", 8, 10'000}, s.max_points);
    visit(Field{"reach", "m", "Distance from all obstacles above which a point is not compared.", 0.01, 100},
          s.reach_m);
    visit(Field{"max_steps", "1", "Greatest number of Gauss-Newton steps.", 1, 1000}, s.max_steps);
    visit(Field{"range_deviation", "m", "Least standard deviation of points, for the covariance.", 1e-4, 10},
          s.range_deviation_m);
    visit(Field{"normal_radius", "m", "Distance over which neighbouring points give a normal.", 0.01, 10},
          s.normal_radius_m);
    visit(Field{"max_gap", "m", "Gap between points that ends a surface.", 0.01, 10}, s.max_gap_m);
    visit(Field{"min_share", "1", "Part of the points on surfaces that must lie near obstacles.", 0, 1},
          s.min_share);
    visit(Field{"weakest_direction", "1",
                "Information along a direction, relative to the strongest, below which it counts as unknown.",
                1e-9, 1},
          s.weakest_direction);
    visit(Field{"search_distance", "m", "Distance from the guess that is searched, along x and along y.", 0,
                1e4},
          s.search_distance_m);
    visit(Field{"search_angle", "rad", "Turn from the guess that is searched.", 0, math::pi},
          s.search_angle_rad);
    visit(Field{"search_deviation", "m", "Standard deviation of points in the search.", 0.01, 10},
          s.search_deviation_m);
    visit(Field{"min_score", "1", "Least score of a match that was searched for.", 0, 1}, s.min_score);
    visit(Field{"search_points", "1", "Number of points in the search, taken evenly.", 4, 10'000},
          s.search_points);
    visit(Field{"max_evaluations", "1", "Offsets and squares of offsets after which a search gives up.", 1,
                1e8},
          s.max_evaluations);
  }
  Status check(const Node& node, const std::string& path) const;
};

enum class MatchOutcome : std::uint8_t {
  matched,
  bad_scan,   ///< as ScanFault
  bad_mount,  ///< as ScanFault
  no_beams,   ///< as ScanFault
  bad_guess,  ///< the guess is not finite or above 1e6 m
  few_points,  ///< too few points lie on surfaces, or near obstacles: the guess is off the map or far from right
  not_converged,  ///< still moved after max_steps
  low_score,      ///< nothing in the window fits
  gave_up,        ///< max_evaluations came first
};
std::span<const EnumName<MatchOutcome>> enum_names(MatchOutcome);

struct MapMatch {
  MatchOutcome outcome = MatchOutcome::matched;
  Pose2 pose;  ///< X_MB
  /// Of a match; unknown_variance along what the scan does not show.
  Covariance3 covariance = unknown_covariance;
  int observable = 0;  ///< directions of x, y, theta that the scan shows: 2 in a corridor
  int points = 0;      ///< compared in the last step
  int steps = 0;
  double rms_m = 0;     ///< of their distances
  double score = 0;     ///< of search(), in [0, 1]
  int evaluations = 0;  ///< of search()
};

/// Map made ready for matching: constant. Calls allocate; they may run at the same time.
class MapMatcher {
 public:
  /// Errors: ranges of the spec, and those of DistanceField.
  static Result<MapMatcher> make(const MapMatchSpec& spec, const GridMap& map);

  MapMatch refine(const msg::LaserScan& scan, const Pose& X_BL, const Pose2& guess) const;
  MapMatch search(const msg::LaserScan& scan, const Pose& X_BL, const Pose2& guess) const;

 private:
  /// Scores 0 to 255: greatest of the squares of 2^k cells that begin at each cell, also at those up to 2^k - 1 before the
  /// map.
  struct Level {
    int side = 1;
    int width = 0, height = 0;
    std::vector<std::uint8_t> score;
    int at(int x, int y) const {
      x += side - 1, y += side - 1;
      if (x < 0 || y < 0 || x >= width || y >= height) return 0;
      return score[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(x)];
    }
  };
  MapMatcher(const MapMatchSpec& spec, DistanceField field) : spec_(spec), field_(std::move(field)) {}
  static Level first_level(const DistanceField& field, double deviation_m);
  static Level next_level(const Level& level);
  MapMatch refine(const ScanPoints& points, const Pose2& guess) const;
  MapMatch correlate(const ScanPoints& points, const Pose2& guess) const;
  MapMatchSpec spec_;
  DistanceField field_;
  std::vector<Level> levels_;
};

}  // namespace sandlot::navigation
