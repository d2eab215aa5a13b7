#pragma once
/// Composition of poses in the plane, and covariances of such poses.
///
/// Frame    X_AB is the pose of B in A; X_AC = compose(X_AB, X_BC). Headings are wrapped to (-pi, pi].
#include <array>

#include "navigation/maps/grid.h"

namespace sandlot::navigation {

/// Covariance of x, y [m] and theta [rad], row by row.
using Covariance3 = std::array<double, 9>;

/// Variance of what is not known, in m^2 and rad^2.
inline constexpr double unknown_variance = 1e6;
inline constexpr Covariance3 unknown_covariance{unknown_variance, 0, 0, 0, unknown_variance, 0, 0, 0,
                                                unknown_variance};

inline Pose2 compose(const Pose2& X_AB, const Pose2& X_BC) {
  const auto [s, c] = math::sincos(X_AB.theta);
  return {X_AB.x + c * X_BC.x - s * X_BC.y, X_AB.y + s * X_BC.x + c * X_BC.y,
          math::wrap_angle(X_AB.theta + X_BC.theta)};
}

/// X_BC from X_AB and X_AC.
inline Pose2 relative(const Pose2& X_AB, const Pose2& X_AC) {
  const auto [s, c] = math::sincos(X_AB.theta);
  const double dx = X_AC.x - X_AB.x, dy = X_AC.y - X_AB.y;
  return {c * dx + s * dy, -s * dx + c * dy, math::wrap_angle(X_AC.theta - X_AB.theta)};
}

inline Pose2 inverse(const Pose2& X_AB) { return relative(X_AB, {}); }

/// Whether a pose is finite and within 1e6 m and 1e6 rad of the origin: what its sums can take without loss.
inline bool is_bounded(const Pose2& pose) {
  return std::abs(pose.x) <= 1e6 && std::abs(pose.y) <= 1e6 && std::abs(pose.theta) <= 1e6;
}

}  // namespace sandlot::navigation
