#pragma once
/// Parts that stereo and mono odometry share: rigid motions in optical frames, samples of RANSAC, medians.
#include <Eigen/Dense>
#include <span>
#include <vector>

#include "base/random.h"
#include "navigation/visual_odometry/track.h"

namespace sandlot::navigation::vo {

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

/// Middle one of the values (the upper of two), which are reordered; 0 of none.
double median(std::vector<double>& values);

/// `index.size()` different numbers below `count`. @pre count >= index.size()
void draw_distinct(Stream& random, std::uint32_t count, std::span<std::uint32_t> index);

/// End of RANSAC: after so many samples that one without outliers was among them with a probability of 0.9999, but no fewer than
/// `least`.
class RansacEnd {
 public:
  RansacEnd(int sample_size, int least, int most)
      : sample_size_(sample_size), least_(least), left_(most), most_(most) {}
  bool another() { return left_-- > 0; }
  /// @param share  of inliers, of the best sample until now
  void found(double share);

 private:
  int sample_size_, least_, left_, most_;
};

}  // namespace sandlot::navigation::vo
