#pragma once
/// Scanning range finder with several planes (3D lidar).
///
/// Frame    sensor frame S: x forward, y left, z up. Beam (plane p, column c) leaves S's origin at azimuth
///          min_angle + c (max_angle - min_angle) / (columns - 1), counter-clockwise, and elevation
///          min_elevation + p (max_elevation - min_elevation) / (planes - 1), upwards. A single column or
///          plane lies in the middle of its two angles.
/// Output   level `points`: sensor_msgs/PointCloud2 in S with x y z intensity (float32) and ring (uint16, the
///          plane, lowest first), 20 bytes per point. `organised: true`: `planes` rows of `columns` points,
///          NaN where nothing was hit between min_range and max_range. `organised: false`: one row of the
///          points that were hit.
/// Time     all beams are sampled at the same instant, the end of the tick. A real scanner turns; see Limits.
/// Noise    noise/range_noise.h, along the beam.
/// Housing  as laser_scanner: the link that carries it is never seen.
/// Limits   intensity is always 0; no motion distortion, reflectance, mixed pixels, cross-talk, second
///          returns.
/// Cost     columns * planes ray casts per sample; no allocation after the first sample. Planes run in
///          parallel.
/// Errors   a bad spec, more than a million beams: place and path of the key.
/// Source   ROS REP 117; noise/range_noise.h.
#include <numbers>
#include <vector>

#include "devices/kind.h"
#include "messages/messages.h"
#include "noise/range_noise.h"

namespace sandlot::laser_scanner_3d {

inline constexpr int max_beams = 1'000'000;

struct Spec {
  int columns = 360;
  int planes = 16;
  double min_angle_rad = -std::numbers::pi;
  double max_angle_rad = std::numbers::pi * (1 - 2.0 / 360);
  double min_elevation_rad = -std::numbers::pi / 12;
  double max_elevation_rad = std::numbers::pi / 12;
  double min_range_m = 0.1;
  double max_range_m = 100.0;
  double rate_hz = 10.0;
  bool organised = true;
  RangeNoiseSpec noise;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"columns", "1", "Number of beams per plane.", 1, 100'000}, s.columns);
    visit(Field{"planes", "1", "Number of planes.", 1, 10'000}, s.planes);
    visit(Field{"min_angle", "rad", "Azimuth of the first column.", -2 * std::numbers::pi,
                2 * std::numbers::pi},
          s.min_angle_rad);
    visit(
        Field{"max_angle", "rad", "Azimuth of the last column.", -2 * std::numbers::pi, 2 * std::numbers::pi},
        s.max_angle_rad);
    visit(Field{"min_elevation", "rad", "Elevation of the first plane.", -std::numbers::pi / 2,
                std::numbers::pi / 2},
          s.min_elevation_rad);
    visit(Field{"max_elevation", "rad", "Elevation of the last plane.", -std::numbers::pi / 2,
                std::numbers::pi / 2},
          s.max_elevation_rad);
    visit(Field{"min_range", "m", "Nearest measured distance; a nearer obstacle gives no point.", 0, 1e4},
          s.min_range_m);
    visit(
        Field{"max_range", "m", "Farthest measured distance; a farther obstacle gives no point.", 1e-3, 1e4},
        s.max_range_m);
    visit(Field{"rate", "Hz", "Scans per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(Field{"organised", "",
                "Whether there is a point for every beam, NaN where nothing was hit; false: hits only."},
          s.organised);
    visit(Field{"noise", "m", "Errors of the distances."}, s.noise);
    visit(errors_field, s.errors);
  }
};

struct State {
  RangeNoise noise;

  static void fields(auto& s, auto&& visit) { visit(Field{"noise", "m", "State of the errors."}, s.noise); }
};

struct Scanner {
  using Spec = laser_scanner_3d::Spec;
  using State = laser_scanner_3d::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t body = 0;  ///< index of the link that carries it
  Pose X_LS;
  std::vector<Vec3> directions_S;  ///< plane by plane
  std::vector<float> distance_m;   ///< of the sample being taken
  Topic<msg::PointCloud2>* cloud = nullptr;

  static Result<Scanner> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Scanner> pool, const Context& context);
};

extern const Kind kind;

}  // namespace sandlot::laser_scanner_3d
