#pragma once
/// Least squares for a pose in the plane from points and the lines they belong to: normal equations, covariance and the
/// directions about which the lines give no information.
///
/// Each point adds a residual e = n . (p - q) and its slope (n, n x r) in a change (x, y, theta) of the pose: r is the
/// point's position relative to the robot's, all in one frame. Turns are scaled by a length, so that the strength of
/// directions can be compared.
///
/// Source   A. Censi, On achievable accuracy for range-finder localization (2007), for the covariance and its null space.
#include <Eigen/Dense>

#include "navigation/localisation/planar.h"

namespace sandlot::navigation {

class PlaneFit {
 public:
  /// @param length_m  about the distance of the points from the robot
  explicit PlaneFit(double length_m) : length_(length_m) {}

  void clear();
  void add(Vec2 normal, Vec2 r, double error, double weight);
  int points() const { return points_; }
  double weight() const { return weight_; }
  /// Root of the weighted mean of squared residuals.
  double rms() const;

  struct Step {
    double x = 0, y = 0, theta = 0;
    int observable = 0;  ///< number of directions that were solved for, of 3
  };
  /// Change of the pose with the least sum of squares. Directions weaker than `weakest` times the strongest one, and
  /// those of a strength below `weakest`, are left alone.
  Step solve(double weakest) const;

  /// Covariance for independent residuals of a standard deviation; unknown_variance along directions left alone.
  Covariance3 covariance(double deviation, double weakest) const;

 private:
  double length_;
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero();
  double squares_ = 0, weight_ = 0;
  int points_ = 0;
};

}  // namespace sandlot::navigation
