#pragma once
/// Odometry motion models: a random pose of the robot after a step of its odometry.
///
///   differential      turn, drive, turn: rot1, trans, rot2 with normal errors of the variances
///                       rot    alpha1 rot^2 + alpha2 trans^2
///                       trans  alpha3 trans^2 + alpha4 (rot1^2 + rot2^2)
///   omnidirectional   errors along the drive, across it and of the heading, of the variances
///                       along  alpha3 trans^2 + alpha4 rot^2
///                       across alpha5 trans^2 + alpha4 rot^2
///                       rot    alpha1 rot^2 + alpha2 trans^2
///
/// Frame    the step is X_BB', the pose of the base after it in the base before it.
/// Limits   errors of steps are independent. A step back counts as one with a negative trans. Below 1 cm the direction of
///          the drive counts as noise of the odometry: rot1 = 0 in the variances.
/// Cost     two or three normals and one or two sines.
/// Source   S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), table 5.6; omnidirectional and parameters as in
///          Nav2's AMCL.
#include "base/random.h"
#include "navigation/localisation/planar.h"

namespace sandlot::navigation {

enum class MotionModel : std::uint8_t { differential, omnidirectional };
inline std::span<const EnumName<MotionModel>> enum_names(MotionModel) {
  static constexpr EnumName<MotionModel> names[] = {{"differential", MotionModel::differential},
                                                    {"omnidirectional", MotionModel::omnidirectional}};
  return names;
}

struct MotionNoise {
  double alpha1 = 0.2, alpha2 = 0.2, alpha3 = 0.2, alpha4 = 0.2, alpha5 = 0.2;
};

class MotionSampler {
 public:
  MotionSampler(MotionModel model, const MotionNoise& noise, const Pose2& X_BB);
  /// Random pose after the step that begins at `from`.
  Pose2 operator()(const Pose2& from, Stream& random) const;

 private:
  MotionModel model_;
  double trans_ = 0, rot1_ = 0, rot2_ = 0;  ///< omnidirectional: rot1 is the bearing, rot2 the turn
  double trans_std_ = 0, rot1_std_ = 0, rot2_std_ = 0, across_std_ = 0;
};

}  // namespace sandlot::navigation
