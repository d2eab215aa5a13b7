#include "navigation/localisation/odometry_motion.h"

#include <cmath>

namespace sandlot::navigation {
namespace {

constexpr double motion_least_drive_m = 0.01;

}  // namespace

MotionSampler::MotionSampler(MotionModel model, const MotionNoise& a, const Pose2& X) : model_(model) {
  trans_ = math::hypot(X.x, X.y);
  rot1_ = trans_ > 0 ? math::atan2(X.y, X.x) : 0;
  const double turn = math::wrap_angle(X.theta), trans2 = trans_ * trans_;
  if (model == MotionModel::omnidirectional) {
    rot2_ = turn;
    trans_std_ = std::sqrt(a.alpha3 * trans2 + a.alpha4 * turn * turn);
    across_std_ = std::sqrt(a.alpha5 * trans2 + a.alpha4 * turn * turn);
    rot2_std_ = std::sqrt(a.alpha1 * turn * turn + a.alpha2 * trans2);
    return;
  }
  const bool direction_known = trans_ >= motion_least_drive_m;
  if (std::abs(rot1_) > math::pi / 2) {
    rot1_ = math::wrap_angle(rot1_ + math::pi);
    trans_ = -trans_;
  }
  rot2_ = math::wrap_angle(turn - rot1_);
  const double noisy1 = direction_known ? rot1_ : 0, noisy2 = direction_known ? rot2_ : turn;
  rot1_std_ = std::sqrt(a.alpha1 * noisy1 * noisy1 + a.alpha2 * trans2);
  rot2_std_ = std::sqrt(a.alpha1 * noisy2 * noisy2 + a.alpha2 * trans2);
  trans_std_ = std::sqrt(a.alpha3 * trans2 + a.alpha4 * (noisy1 * noisy1 + noisy2 * noisy2));
}

Pose2 MotionSampler::operator()(const Pose2& from, Stream& random) const {
  const double trans = trans_ + trans_std_ * random.normal();
  if (model_ == MotionModel::omnidirectional) {
    const double across = across_std_ * random.normal(), turn = rot2_ + rot2_std_ * random.normal();
    const auto [s, c] = math::sincos(from.theta + rot1_);
    return {from.x + trans * c - across * s, from.y + trans * s + across * c,
            math::wrap_angle(from.theta + turn)};
  }
  const double rot1 = rot1_ + rot1_std_ * random.normal(), rot2 = rot2_ + rot2_std_ * random.normal();
  const auto [s, c] = math::sincos(from.theta + rot1);
  return {from.x + trans * c, from.y + trans * s, math::wrap_angle(from.theta + rot1 + rot2)};
}

}  // namespace sandlot::navigation
