#pragma once
/// Drives of the tests: poses of a camera on a way through test_scene.h's room, and errors of estimates.
#include <algorithm>
#include <array>
#include <vector>

#include "base/math.h"
#include "navigation/visual_odometry/test_scene.h"
#include "navigation/visual_odometry/track.h"

namespace sandlot::navigation::vo::test {

inline constexpr int small_width = 320, small_height = 240;
inline constexpr double small_focal_px = 175, baseline_m = 0.12, camera_height_m = 0.5,
                        camera_pitch_rad = 0.2;

/// Camera that looks down by camera_pitch_rad.
inline Pose camera_at(double x, double y, double yaw) {
  return {{x, y, camera_height_m},
          quat_from_axis_angle({0, 0, 1}, yaw) * quat_from_axis_angle({0, 1, 0}, camera_pitch_rad)};
}

/// Arc: begins at (-2, 0) along x, `step_m` and `turn_rad` per image.
inline std::vector<Pose> arc(int images, double step_m, double turn_rad) {
  std::vector<Pose> out;
  double x = -2, y = 0, yaw = 0;
  for (int i = 0; i < images; ++i) {
    out.push_back(camera_at(x, y, yaw));
    x += step_m * math::cos(yaw + turn_rad / 2);
    y += step_m * math::sin(yaw + turn_rad / 2);
    yaw += turn_rad;
  }
  return out;
}

inline double path_length(const std::vector<Pose>& way) {
  double sum = 0;
  for (std::size_t i = 1; i < way.size(); ++i) sum += norm(way[i].p - way[i - 1].p);
  return sum;
}

/// Angle between two rotations.
inline double angle_between(Quat a, Quat b) {
  const Quat q = conjugate(a) * b;
  return 2 * math::asin(std::min(1.0, std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z)));
}

/// Small displacement and turn of S about its own axes that takes the estimate to the truth.
inline std::array<double, 6> error_of(const Pose& estimate, const Pose& truth) {
  const Pose X = inverse(estimate) * truth;
  const double sign = X.q.w < 0 ? -2 : 2;
  return {X.p.x, X.p.y, X.p.z, sign * X.q.x, sign * X.q.y, sign * X.q.z};
}

/// e^T P^-1 e by the Cholesky factor; NaN where P is not positive definite.
inline double squared_error(const Covariance& P, const std::array<double, 6>& e) {
  std::array<std::array<double, 6>, 6> L{};
  std::array<double, 6> white{};
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    double rest = e[i];
    for (std::size_t j = 0; j <= i; ++j) {
      double s = P[6 * i + j];
      for (std::size_t k = 0; k < j; ++k) s -= L[i][k] * L[j][k];
      L[i][j] = i == j ? std::sqrt(s) : s / L[j][j];
    }
    for (std::size_t k = 0; k < i; ++k) rest -= L[i][k] * white[k];
    white[i] = rest / L[i][i];
    sum += white[i] * white[i];
  }
  return sum;
}

}  // namespace sandlot::navigation::vo::test
