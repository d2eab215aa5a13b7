#pragma once
/// Pose estimate of a localisation, without simulating the localisation: an error that comes and goes but
/// never grows, and now and then a wrong place.
///
///   p = p_true + e (x, y, z)         q = turn about the vertical by e a, then q_true
///
/// x, y, z, a: first-order Gauss-Markov processes (noise/drifting_bias.h) of the deviations configured and
/// one correlation time: a filter's error follows its measurements slowly. e is the factor `errors`.
/// While it is lost, a constant offset (normal, drawn when it gets lost) is added. It gets lost as a Poisson
/// process does, `e lost_rate` times a second, for a time that is exponentially distributed about
/// `lost_time`; it does not know that it is lost, so the covariance shown stays what it is, as that of a
/// filter that follows the wrong hypothesis.
///
/// Units    metres, radians, seconds.
/// Errors   none at run time: a spec is validated once, when it is read.
/// Cost     four normals per sample while anything is configured, no allocation.
/// Source   S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), sec. 8.1 (taxonomy: tracking,
///          kidnapping), 8.3.
/// Not modelled   errors that depend on the place or on what is seen; roll and pitch are true.
#include <array>

#include "geometry/pose.h"
#include "noise/drifting_bias.h"

namespace sandlot {

struct PoseEstimateSpec {
  double position_std_m = 0, vertical_std_m = 0, yaw_std_rad = 0;
  double correlation_s = 1;
  double lost_rate_hz = 0, lost_time_s = 2, lost_position_std_m = 1, lost_yaw_std_rad = 0.5;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"position_std", "m", "Standard deviation of x and of y.", 0, 1e4, tunable}, s.position_std_m);
    visit(Field{"vertical_std", "m", "Standard deviation of z.", 0, 1e4, tunable}, s.vertical_std_m);
    visit(Field{"yaw_std", "rad", "Standard deviation of the heading.", 0, 10, tunable}, s.yaw_std_rad);
    visit(Field{"correlation", "s", "Correlation time of the errors.", 1e-6, 1e9, tunable}, s.correlation_s);
    visit(Field{"lost_rate", "Hz", "Rate at which the estimate gets lost.", 0, 1e3, tunable}, s.lost_rate_hz);
    visit(Field{"lost_time", "s", "Mean duration of being lost.", 1e-6, 1e6, tunable}, s.lost_time_s);
    visit(Field{"lost_position_std", "m", "Standard deviation of x and y while lost.", 0, 1e4, tunable},
          s.lost_position_std_m);
    visit(Field{"lost_yaw_std", "rad", "Standard deviation of the heading while lost.", 0, 10, tunable},
          s.lost_yaw_std_rad);
  }
};

struct PoseEstimate {
  DriftingBias x, y, z, yaw;
  double lost_s = 0;  ///< for how long it will still be lost
  double lost_x_m = 0, lost_y_m = 0, lost_yaw_rad = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Error of x."}, s.x);
    visit(Field{"y", "m", "Error of y."}, s.y);
    visit(Field{"z", "m", "Error of z."}, s.z);
    visit(Field{"yaw", "rad", "Error of the heading."}, s.yaw);
    visit(Field{"lost", "s", "Time until the estimate is found again."}, s.lost_s);
    visit(Field{"lost_x", "m", "Error of x while lost."}, s.lost_x_m);
    visit(Field{"lost_y", "m", "Error of y while lost."}, s.lost_y_m);
    visit(Field{"lost_yaw", "rad", "Error of the heading while lost."}, s.lost_yaw_rad);
  }

  /// Draws errors from their stationary distribution: no warm-up.
  void reset(const PoseEstimateSpec& s, Stream random) {
    *this = {};
    x.reset({0, s.position_std_m, s.correlation_s}, random);
    y.reset({0, s.position_std_m, s.correlation_s}, random);
    z.reset({0, s.vertical_std_m, s.correlation_s}, random);
    yaw.reset({0, s.yaw_std_rad, s.correlation_s}, random);
  }
  /// @param dt_s    [s] since the previous sample, > 0
  /// @param random  stream of the device for this sample; its position does not matter afterwards
  Pose corrupt(const PoseEstimateSpec& s, const Pose& truth, double dt_s, Stream random, double errors = 1) {
    const DriftingBiasSpec level{0, s.position_std_m, s.correlation_s};
    Pose shown = truth;
    // Each draws, whatever is configured: the numbers of one do not depend on the other's deviation.
    shown.p.x = x.corrupt(level, shown.p.x, dt_s, random, errors);
    shown.p.y = y.corrupt(level, shown.p.y, dt_s, random, errors);
    shown.p.z = z.corrupt({0, s.vertical_std_m, s.correlation_s}, shown.p.z, dt_s, random, errors);
    double turn = yaw.corrupt({0, s.yaw_std_rad, s.correlation_s}, 0, dt_s, random, errors);
    lose(s, dt_s, random.fork(1), errors);
    if (lost_s > 0) {
      shown.p.x += errors * lost_x_m;
      shown.p.y += errors * lost_y_m;
      turn += errors * lost_yaw_rad;
    }
    if (turn != 0) shown.q = normalised(quat_from_axis_angle({0, 0, 1}, turn) * truth.q);
    return shown;
  }

 private:
  void lose(const PoseEstimateSpec& s, double dt_s, Stream random, double errors) {
    if (lost_s > 0) lost_s = lost_s > dt_s ? lost_s - dt_s : 0;
    const double rate_hz = errors * s.lost_rate_hz;
    if (lost_s > 0 || rate_hz <= 0 || random.uniform() >= 1 - math::exp(-rate_hz * dt_s)) return;
    lost_s = -s.lost_time_s * math::log(1 - random.uniform());
    lost_x_m = s.lost_position_std_m * random.normal();
    lost_y_m = s.lost_position_std_m * random.normal();
    lost_yaw_rad = s.lost_yaw_std_rad * random.normal();
  }
};

/// ROS's covariance of the pose shown, but for being lost: x, y, z and the turn about z.
inline std::array<double, 36> covariance_of(const PoseEstimateSpec& s, double errors) {
  std::array<double, 36> out{};
  const auto square = [errors](double std) { return errors * errors * std * std; };
  out[0] = out[7] = square(s.position_std_m);
  out[14] = square(s.vertical_std_m);
  out[35] = square(s.yaw_std_rad);
  return out;
}

}  // namespace sandlot
