#include "navigation/visual_odometry/track.h"

#include <Eigen/Dense>
#include <cmath>

#include "base/math.h"

namespace sandlot::navigation::vo {
namespace {

using TrackMatrix = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

TrackMatrix track_matrix(const Covariance& of) { return Eigen::Map<const TrackMatrix>(of.data()); }
Covariance track_covariance(const TrackMatrix& of) {
  Covariance out;
  Eigen::Map<TrackMatrix>(out.data()) = 0.5 * (of + of.transpose());
  return out;
}
Eigen::Matrix3d track_rotation(Quat q) { return Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix(); }

/// Takes errors of B, in X_AB, to those of C, in X_AC: a turn of B by a moves C's origin by a x p.
TrackMatrix track_adjoint(const Pose& X_BC) {
  const Eigen::Matrix3d Rt = track_rotation(X_BC.q).transpose();
  Eigen::Matrix3d lever;
  lever << 0, X_BC.p.z, -X_BC.p.y, -X_BC.p.z, 0, X_BC.p.x, X_BC.p.y, -X_BC.p.x, 0;
  TrackMatrix out = TrackMatrix::Zero();
  out.topLeftCorner<3, 3>() = Rt;
  out.topRightCorner<3, 3>() = Rt * lever;
  out.bottomRightCorner<3, 3>() = Rt;
  return out;
}

void track_forget(Covariance& errors) {
  for (std::size_t i = 0; i < 6; ++i) errors[7 * i] += unknown_variance;
}

}  // namespace

Covariance composed(const Covariance& AB, const Pose& X_BC, const Covariance& BC) {
  const TrackMatrix adjoint = track_adjoint(X_BC);
  return track_covariance(adjoint * track_matrix(AB) * adjoint.transpose() + track_matrix(BC));
}

Pose pose_W(const Track& track) { return track.X_WK * track.X_KS; }

Covariance covariance_S(const Track& track) {
  Covariance out = composed(track.keyframe_errors, track.X_KS, track.errors);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += track.drift[i];
  return out;
}

Covariance covariance_W(const Track& track) {
  const Eigen::Matrix3d R = track_rotation(pose_W(track).q);
  TrackMatrix turn = TrackMatrix::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R;
  return track_covariance(turn * track_matrix(covariance_S(track)) * turn.transpose());
}

void enter_pose(Track& track, const Pose& X_KS, const Covariance& errors, Step& step) {
  step.motion = inverse(track.X_KS) * X_KS;
  step.motion.q = normalised(step.motion.q);
  step.motion_errors = composed(track.errors, step.motion, errors);
  track.motion = step.motion;
  track.X_KS = X_KS;
  track.errors = errors;
  track.failures_in_row = 0;
}

void grow(Track& track, const Growth& growth, Step& step) {
  const Quat q = step.motion.q;
  const double way = norm(step.motion.p), turn = 2 * math::atan2(norm(Vec3{q.x, q.y, q.z}), std::abs(q.w));
  Covariance more{};
  for (std::size_t i = 0; i < 6; ++i)
    more[7 * i] = i < 3 ? growth.distance_variance * way : growth.turn_variance * turn;
  for (std::size_t i = 0; i < 6; ++i) step.motion_errors[7 * i] += more[7 * i];
  track.drift = composed(track.drift, step.motion, more);
}

void enter_keyframe(Track& track, Step& step) {
  track.keyframe_errors = composed(track.keyframe_errors, track.X_KS, track.errors);
  track.X_WK = pose_W(track);
  track.X_WK.q = normalised(track.X_WK.q);
  track.X_KS = {};
  track.errors = {};
  track.keyframe_inliers = 0;
  ++track.keyframes;
  step.keyframe = true;
}

void enter_gap(Track& track, Step& step) {
  enter_keyframe(track, step);
  track_forget(track.keyframe_errors);
  track.motion = {};
  track.failures_in_row = 0;
  ++track.gaps;
  step.gap = true;
  step.motion = {};
  step.motion_errors = {};
  track_forget(step.motion_errors);
}

}  // namespace sandlot::navigation::vo
