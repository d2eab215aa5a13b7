#pragma once
/// Planar scanning range finder (2D lidar).
///
/// Frame    sensor frame S: x forward, y left, z up; the beams lie in its xy plane. Beam i leaves S's origin
///          at min_angle + i (max_angle - min_angle) / (beams - 1), counter-clockwise positive. A single beam
///          points to the middle of the two angles.
/// Levels   any of them at once; each runs alone what it needs.
///          `ranges` (the default): sensor_msgs/LaserScan, `beams` distances [m] in beam order. +inf: nothing
///          within max_range. -inf: nearer than min_range. Never NaN. Convention of ROS REP 117.
///          `segments`: sandlot_msgs/LineSegmentArray in S, the straight pieces of what lies within reach,
///          from few rays of their own (segments.h). Errors: `segments:`; each end moves by a normal in x and
///          y, some are missed.
///          `pose`: geometry_msgs/PoseWithCovarianceStamped of the canonical link in `world`, as a
///          localisation in a known map estimates it. No ray is cast. Errors: `pose:`
///          (noise/pose_estimate.h); height, roll and pitch are true.
/// Time     all beams are sampled at the same instant, the end of the tick. A real scanner sweeps; see
///          Limits.
/// Noise    of `ranges`: noise/range_noise.h: white noise per beam, a bias that all beams of a scan share, a
///          constant error and a resolution; added to finite distances only, then clamped to [min_range,
///          max_range].
/// Housing  rays start at S's origin, so that what touches the sensor reads -inf and not whatever lies behind
///          it. The link that carries the sensor is its housing and is never seen; other links of the robot
///          are.
/// Limits   no intensities, reflectance (mixed beams as a stage of noise), motion distortion, cross-talk,
///          beam divergence.
/// Cost     `ranges`: `beams` ray casts per sample, no allocation after the device was built; scanners run in
///          parallel.
///          `segments`: see segments.h. `pose`: a few normals.
/// Errors   a bad spec: place and path of the key.
/// Source   ROS REP 117; noise: S. Thrun et al., Probabilistic Robotics (2005), sec. 6.3 (the "hit" term
///          only).
#include <numbers>
#include <vector>

#include "devices/kind.h"
#include "devices/ranges/laser_scanner/segments.h"
#include "messages/messages.h"
#include "noise/pose_estimate.h"
#include "noise/range_noise.h"

namespace sandlot::laser_scanner {

struct SegmentsSpec {
  double step_rad = 0.035, tolerance_m = 0.01, min_length_m = 0.05;
  double end_std_m = 0, miss = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"step", "rad", "Angle between the rays that search for segments.", 1e-3, 1}, s.step_rad);
    visit(Field{"tolerance", "m", "Largest distance between a segment and the surface.", 1e-4, 10},
          s.tolerance_m);
    visit(Field{"min_length", "m", "Shortest segment that is reported.", 0, 100}, s.min_length_m);
    visit(Field{"end_std", "m", "Standard deviation of the ends, in x and in y.", 0, 100, Field::tunable},
          s.end_std_m);
    visit(Field{"miss", "1", "Probability that a segment is missed.", 0, 1, Field::tunable}, s.miss);
  }
};

struct Spec {
  int beams = 181;
  double min_angle_rad = -std::numbers::pi / 2;
  double max_angle_rad = std::numbers::pi / 2;
  double min_range_m = 0.02;
  double max_range_m = 10.0;
  double rate_hz = 10.0;
  RangeNoiseSpec noise;
  SegmentsSpec segments;
  PoseEstimateSpec pose;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"beams", "1", "Number of beams.", 1, 100'000}, s.beams);
    visit(Field{"min_angle", "rad", "Angle of the first beam.", -2 * std::numbers::pi, 2 * std::numbers::pi},
          s.min_angle_rad);
    visit(Field{"max_angle", "rad", "Angle of the last beam.", -2 * std::numbers::pi, 2 * std::numbers::pi},
          s.max_angle_rad);
    visit(Field{"min_range", "m", "Nearest measured distance; a nearer obstacle reads -inf.", 0, 1e4},
          s.min_range_m);
    visit(Field{"max_range", "m", "Farthest measured distance; a farther obstacle reads +inf.", 1e-3, 1e4},
          s.max_range_m);
    visit(Field{"rate", "Hz", "Scans per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"noise", "m", "Errors of the distances."}, s.noise);
    visit(Field{"segments", "", "Detection of segments at level segments."}, s.segments);
    visit(Field{"pose_error", "", "Errors of the level pose."}, s.pose);
    visit(errors_field, s.errors);
  }
};

struct State {
  RangeNoise noise;
  PoseEstimate pose;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"noise", "m", "State of the errors."}, s.noise);
    visit(Field{"pose", "", "State of the errors of the level pose."}, s.pose);
  }
};

struct Scanner {
  using Spec = laser_scanner::Spec;
  using State = laser_scanner::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;  ///< index of the link that carries it
  std::uint32_t base = 0;  ///< of the canonical link
  Pose X_LS;
  std::vector<Vec3> directions_S;
  SegmentFinder finder;
  Topic<msg::LaserScan>* scan = nullptr;
  Topic<msg::LineSegmentArray>* segments = nullptr;
  Topic<msg::PoseWithCovarianceStamped>* pose = nullptr;

  static Result<Scanner> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Scanner> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::laser_scanner
