#pragma once
/// Rigid motions in optical frames, for stereo and mono odometry.
#include <Eigen/Dense>

#include "navigation/visual_odometry/track.h"

namespace sandlot::navigation::vo {

/// Of at most six rows and columns.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;
/// X with A X = B for a symmetric A. Eigen's L D L^T, compiled once for all sizes.
/// @param rcond  when given: estimate of the reciprocal condition number of A
SmallMatrix solve_symmetric(const SmallMatrix& A, const SmallMatrix& B, double* rcond = nullptr);
SmallMatrix inverse_symmetric(const SmallMatrix& A);

/// Takes points from one camera's optical frame (x right, y down, z forward) to another's.
struct Rigid {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();

  /// Moves the result by a small translation and turn: X -> X + translation + turn x X, exact for the turn's group to third order.
  void move(const Eigen::Vector3d& translation, const Eigen::Vector3d& turn);
};
/// Rotation by about `turn` (its angle is 2 atan(|turn| / 2)).
Eigen::Matrix3d small_turn(const Eigen::Vector3d& turn);

/// Takes points from K's optical frame to that of S.
Rigid optical_motion(const Pose& X_KS);
Pose motion_of_S(const Rigid& X_10);
/// Covariance of X_KS from that of small motions of the present camera's optical frame.
Covariance errors_of_S(const Eigen::Matrix<double, 6, 6>& optical);

}  // namespace sandlot::navigation::vo
