#pragma once
/// Laser odometry: motion of the robot from scans alone, each matched against the last key scan.
///
/// Point to line: each point of the new scan belongs to the nearest point of the key scan, if one is within `reach` whose
/// surface has about the same direction, and is compared with the line through it along its normal. Pairs are chosen
/// again until nothing moves. It begins at the guess, or where clearly more points have a pair: standing, or turned.
/// A scan becomes the key scan once the robot is `key_distance` or `key_angle` away from the last one, or too few of its
/// points have a pair.
///
/// Frames    O is `odom`, which begins at the first scan; B base_link. The guess is that of the caller (wheels) or the
///           last motion gone on.
/// Errors    an Outcome for each scan, counted. A lost scan counts as moved by the guess and becomes the key scan.
/// Limits    motion within a scan is not corrected. Along directions that the scan does not show (a corridor's length) the
///           guess counts: `observable` < 3 and a variance of unknown_variance m^2 say so. The covariance takes points as
///           independent, which those of one key scan are not: variances come out about 1.5 times too small (measured
///           in a furnished room). It adds up from key scan to key scan.
/// Cost      about 0.3 ms a scan of 360 points. No allocation once the lists have grown.
/// Source    A. Censi, An ICP variant using a point-to-line metric (2008). Extends perception/scan_match.h, which has
///           walls in place of the key scan.
#include "base/node.h"
#include "base/time.h"
#include "navigation/localisation/planar.h"
#include "navigation/localisation/scan_points.h"

namespace sandlot::navigation::laser {

struct Spec {
  double min_range_m = 0, max_range_m = 100;
  int max_points = 360;
  double reach_m = 0.5, search_angle_rad = 0.3;
  int max_steps = 30;
  double normal_radius_m = 0.25, max_gap_m = 0.4;
  double range_deviation_m = 0.01;
  double min_share = 0.4;
  double weakest_direction = 0.01;
  double key_distance_m = 0.5, key_angle_rad = 0.5, key_share = 0.7;
  double longest_gap_s = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"min_range", "m", "Shortest distance that is used.", 0, 1e4}, s.min_range_m);
    visit(Field{"max_range", "m", "Longest distance that is used.", 0.01, 1e4}, s.max_range_m);
    visit(Field{"max_points", "1", "Number of points that are used, taken evenly.", 8, 10'000}, s.max_points);
    visit(Field{"reach", "m", "Greatest distance between the points of a pair.", 0.01, 100}, s.reach_m);
    visit(Field{"search_angle", "rad",
                "Turn from the guess, in steps of 0.1 rad, within which a better beginning is looked for.", 0,
                math::pi},
          s.search_angle_rad);
    visit(Field{"max_steps", "1", "Greatest number of Gauss-Newton steps.", 1, 1000}, s.max_steps);
    visit(Field{"normal_radius", "m", "Distance over which neighbouring points give a normal.", 0.01, 10},
          s.normal_radius_m);
    visit(Field{"max_gap", "m", "Gap between points that ends a surface.", 0.01, 10}, s.max_gap_m);
    visit(Field{"range_deviation", "m", "Least standard deviation of points, for the covariance.", 1e-4, 10},
          s.range_deviation_m);
    visit(Field{"min_share", "1", "Part of the points that must have a pair.", 0, 1}, s.min_share);
    visit(Field{"weakest_direction", "1",
                "Information along a direction, relative to the strongest, below which it counts as unknown.",
                1e-9, 1},
          s.weakest_direction);
    visit(Field{"key_distance", "m", "Drive after which a scan becomes the key scan.", 0, 100},
          s.key_distance_m);
    visit(Field{"key_angle", "rad", "Turn after which a scan becomes the key scan.", 0, 2 * math::pi},
          s.key_angle_rad);
    visit(Field{"key_share", "1", "Part of the points with a pair below which a scan becomes the key scan.",
                0, 1},
          s.key_share);
    visit(Field{"longest_gap", "s", "Time over which the last motion is thought to go on.", 1e-3, 1e3},
          s.longest_gap_s);
  }
  Status check(const Node& node, const std::string& path) const;
};

/// Answer to a scan.
enum class Outcome : std::uint8_t {
  matched,    ///< measured the motion
  started,    ///< is the first one
  lost,       ///< does not fit the key scan
  late,       ///< is not newer than the last one
  rewound,    ///< its stamp lies back by more than longest_gap: a new beginning at the last pose
  bad_stamp,  ///< has a negative stamp or one after the year 2096
  bad_guess,  ///< the caller's guess is not finite or above 1e6 m
  bad_scan,   ///< as ScanFault
  bad_mount,  ///< as ScanFault
  no_beams,   ///< fewer than 8 points on surfaces
};
inline constexpr std::size_t outcomes = 10;
std::span<const EnumName<Outcome>> enum_names(Outcome);

struct KeyPoint {
  double x_m = 0, y_m = 0, normal_x = 0, normal_y = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Position in the base at the key scan."}, s.x_m);
    visit(Field{"y", "m", "Position in the base at the key scan."}, s.y_m);
    visit(Field{"normal_x", "1", "Normal of the surface.", -1.001, 1.001}, s.normal_x);
    visit(Field{"normal_y", "1", "Normal of the surface.", -1.001, 1.001}, s.normal_y);
  }
};

struct State {
  bool known = false;  ///< there is a key scan
  Time at;             ///< of the last scan
  Pose2 pose;          ///< X_OB
  Covariance3 covariance{};
  Pose2 key_pose;  ///< X_OK: of the key scan
  Covariance3 key_covariance{};
  std::vector<KeyPoint> key;  ///< by x, those with a normal
  Pose2 motion;               ///< X_BB': from the last scan but one to the last one
  double motion_s = 0;        ///< its time; 0: not known
  int observable = 0;         ///< directions of x, y, theta that the last scan shows
  int pairs = 0;              ///< of the last scan
  double rms_m = 0;           ///< distance of its pairs along the normals
  std::uint64_t keys = 0;     ///< number of key scans
  std::array<std::uint64_t, outcomes> counts{};
  Outcome last = Outcome::started;
  std::uint64_t count(Outcome o) const { return counts[static_cast<std::size_t>(o)]; }

  static void fields(auto& s, auto&& visit) {
    visit(Field{"known", "", "Whether there is a key scan."}, s.known);
    visit(Field{"at", "s", "Stamp of the last scan."}, s.at);
    visit(Field{"pose_x", "m", "Position in odom."}, s.pose.x);
    visit(Field{"pose_y", "m", "Position in odom."}, s.pose.y);
    visit(Field{"pose_theta", "rad", "Heading in odom."}, s.pose.theta);
    visit(Field{"covariance", "", "Covariance of x, y and theta, row by row."}, s.covariance);
    visit(Field{"key_x", "m", "Position of the key scan in odom."}, s.key_pose.x);
    visit(Field{"key_y", "m", "Position of the key scan in odom."}, s.key_pose.y);
    visit(Field{"key_theta", "rad", "Heading of the key scan in odom."}, s.key_pose.theta);
    visit(Field{"key_covariance", "", "Covariance of the key scan's pose."}, s.key_covariance);
    visit(Field{"key", "", "Points of the key scan.", 0, 0, Field::none, 10'000}, s.key);
    visit(Field{"motion_x", "m", "Last motion, forward."}, s.motion.x);
    visit(Field{"motion_y", "m", "Last motion, to the left."}, s.motion.y);
    visit(Field{"motion_theta", "rad", "Last motion, turn."}, s.motion.theta);
    visit(Field{"motion_time", "s", "Time of the last motion."}, s.motion_s);
    visit(Field{"observable", "1", "Number of directions that the last scan shows.", 0, 3}, s.observable);
    visit(Field{"pairs", "1", "Number of pairs of points."}, s.pairs);
    visit(Field{"rms", "m", "Root mean square of the distances of pairs."}, s.rms_m);
    visit(Field{"keys", "1", "Number of key scans."}, s.keys);
    visit(Field{"counts", "1",
                "Scans that matched, started, were lost, late, rewound, had a bad stamp, a bad guess, bad "
                "angles, "
                "a bad mount, no beams."},
          s.counts);
    visit(Field{"last", "", "Outcome of the latest scan."}, s.last);
  }
  /// Whether the state can be one of this spec, for bytes that may be damaged.
  bool fits(const Spec& spec) const;
};

/// Odometry before the first scan, or what is wrong with the spec.
Result<State> begin(const Spec& spec);

/// Memory of update(), whose content does not outlast a call.
struct Workspace {
  ScanPoints scan;
};

/// @param X_BL    mount of the laser
/// @param motion  X_BB', the motion since the last scan that was matched, started or lost, by wheels or IMU; null:
///                the last one goes on
Outcome update(const Spec& spec, State& state, Workspace& work, const msg::LaserScan& scan, const Pose& X_BL,
               const Pose2* motion = nullptr);

}  // namespace sandlot::navigation::laser
