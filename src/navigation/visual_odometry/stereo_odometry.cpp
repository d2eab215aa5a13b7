#include "navigation/visual_odometry/stereo_odometry.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math.h"
#include "navigation/maps/grid.h"
#include "navigation/visual_odometry/rigid.h"
#include "navigation/visual_odometry/sampling.h"

namespace sandlot::navigation::vo {
namespace {

using StereoVector6 = Eigen::Matrix<double, 6, 1>;
using StereoMatrix6 = Eigen::Matrix<double, 6, 6>;
using StereoMatrix46 = Eigen::Matrix<double, 4, 6>;

/// Least limit of inliers, [px^2]: perspective within patches makes errors of 0.15 px.
constexpr double stereo_narrowest = 18.47 * 0.15 * 0.15;

struct StereoPoint {
  Eigen::Vector3d X;       ///< in the keyframe's left camera
  Eigen::Matrix3d spread;  ///< derivative of X by the keyframe's places (u left, u right, v)
  Eigen::Vector4d seen;    ///< in the present images: u and v left, u and v right
  std::uint32_t match = 0;
};

std::vector<StereoPoint> stereo_points(const StereoSpec& spec, std::span<const StereoMatch> matches) {
  const StereoCamera& c = spec.camera;
  std::vector<StereoPoint> out;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const StereoMatch& m = matches[i];
    const double d = m.left0.x - m.right0.x;
    if (!(d >= spec.min_disparity_px) || !(m.left1.x - m.right1.x > 0)) continue;
    StereoPoint point;
    const double z = c.fx_px * c.baseline_m / d, x = (m.left0.x - c.cx_px) / c.fx_px,
                 y = (m.left0.y - c.cy_px) / c.fy_px, z_by_d = -z / d;
    point.X << x * z, y * z, z;
    point.spread << z / c.fx_px + x * z_by_d, -x * z_by_d, 0,  //
        y * z_by_d, -y * z_by_d, z / c.fy_px,                  //
        z_by_d, -z_by_d, 0;
    point.seen << m.left1.x, m.left1.y, m.right1.x, m.right1.y;
    point.match = static_cast<std::uint32_t>(i);
    out.push_back(point);
  }
  return out;
}

/// Errors of a point's places, seen less predicted; false behind the camera.
bool stereo_errors(const StereoCamera& c, const Rigid& X_10, const StereoPoint& point, Eigen::Vector3d& X1,
                   Eigen::Vector4d& errors) {
  X1 = X_10.R * point.X + X_10.t;
  if (!(X1.z() > 1e-3 * c.baseline_m)) return false;
  const double v = c.fy_px * X1.y() / X1.z() + c.cy_px, scale = c.fx_px / X1.z();
  errors << point.seen(0) - scale * X1.x() - c.cx_px, point.seen(1) - v,
      point.seen(2) - scale * (X1.x() - c.baseline_m) - c.cx_px, point.seen(3) - v;
  return true;
}

/// Derivative of the predicted places by the point in the present left camera.
Eigen::Matrix<double, 4, 3> stereo_projection(const StereoCamera& c, const Eigen::Vector3d& X1) {
  const double u = c.fx_px / X1.z(), v = c.fy_px / X1.z();
  Eigen::Matrix<double, 4, 3> out;
  out << u, 0, -u * X1.x() / X1.z(),  //
      0, v, -v * X1.y() / X1.z(),     //
      u, 0, -u * (X1.x() - c.baseline_m) / X1.z(), 0, v, -v * X1.y() / X1.z();
  return out;
}

/// Derivative of the predicted places by a small motion (translation, turn) of the present left camera's frame.
StereoMatrix46 stereo_jacobian(const Eigen::Matrix<double, 4, 3>& projection, const Eigen::Vector3d& X1) {
  StereoMatrix46 out;
  for (int row = 0; row < 4; ++row) {
    const Eigen::Vector3d by_point = projection.row(row).transpose();
    out.row(row).head<3>() = by_point.transpose();
    out.row(row).tail<3>() = X1.cross(by_point).transpose();
  }
  return out;
}

/// Inverse covariance of a point's errors, for places with unit variance: those in the present images, and those in the keyframe
/// by way of the triangulated point.
Eigen::Matrix4d stereo_weight(const Eigen::Matrix<double, 4, 3>& projection, const Rigid& X_10,
                              const StereoPoint& point) {
  const Eigen::Matrix<double, 4, 3> by_places = projection * (X_10.R * point.spread);
  const Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity() + by_places * by_places.transpose();
  return covariance.llt().solve(Eigen::Matrix4d::Identity());
}

/// Gauss-Newton from a guess. False when it leads nowhere.
/// @param weighted  whether errors are weighted by their covariance
/// @param normal    normal matrix of the last step
bool stereo_fit(const StereoCamera& camera, std::span<const StereoPoint> points, bool weighted, Rigid& X_10,
                StereoMatrix6& normal) {
  for (int step = 0; step < 20; ++step) {
    normal.setZero();
    StereoVector6 right = StereoVector6::Zero();
    for (const StereoPoint& point : points) {
      Eigen::Vector3d X1;
      Eigen::Vector4d errors;
      if (!stereo_errors(camera, X_10, point, X1, errors)) return false;
      const auto projection = stereo_projection(camera, X1);
      const StereoMatrix46 J = stereo_jacobian(projection, X1);
      if (weighted) {
        const Eigen::Matrix<double, 6, 4> weighted_J = J.transpose() * stereo_weight(projection, X_10, point);
        normal.noalias() += weighted_J * J;
        right.noalias() += weighted_J * errors;
      } else {
        normal.noalias() += J.transpose() * J;
        right.noalias() += J.transpose() * errors;
      }
    }
    double rcond = 0;
    const StereoVector6 move = solve_symmetric(normal, right, &rcond);
    if (!(rcond > 1e-14)) return false;
    // 1 m in each direction and a radian are far beyond what successive images leave in common.
    if (!move.allFinite() || move.cwiseAbs().maxCoeff() > 10) return false;
    X_10.move(move.head<3>(), move.tail<3>());
    if (move.cwiseAbs().maxCoeff() < 1e-7) return true;
  }
  return false;
}

/// Squared errors of all points, each cut off at `limit`; the number of those below it.
double stereo_score(const StereoCamera& camera, std::span<const StereoPoint> points, const Rigid& X_10,
                    double limit, int& inliers) {
  double sum = 0;
  inliers = 0;
  for (const StereoPoint& point : points) {
    Eigen::Vector3d X1;
    Eigen::Vector4d errors;
    double squares = limit;
    if (stereo_errors(camera, X_10, point, X1, errors)) squares = std::min(limit, errors.squaredNorm());
    inliers += squares < limit;
    sum += squares;
  }
  return sum;
}

/// Motion that continues a guess: of the points near it, then of those that agree. False when they are too few.
bool stereo_continue(const StereoSpec& spec, std::span<const StereoPoint> points, Rigid& X_10) {
  for (const double width_px : {4 * spec.inlier_px, spec.inlier_px}) {
    std::vector<StereoPoint> near;
    for (const StereoPoint& point : points) {
      Eigen::Vector3d X1;
      Eigen::Vector4d errors;
      if (stereo_errors(spec.camera, X_10, point, X1, errors) &&
          errors.squaredNorm() < 2 * width_px * width_px)
        near.push_back(point);
    }
    StereoMatrix6 normal;
    if (static_cast<int>(near.size()) < spec.min_inliers ||
        !stereo_fit(spec.camera, near, false, X_10, normal))
      return false;
  }
  return true;
}

/// Best of the motions of samples of three points, and of the one that continues the guess: that one counts unless another is
/// better by a tenth, so that of two answers which fit about as well the steady one is taken.
bool stereo_ransac(const StereoSpec& spec, std::span<const StereoPoint> points, const Rigid& guess,
                   Stream& random, Rigid& best) {
  const auto count = static_cast<std::uint32_t>(points.size());
  const double limit = 2 * spec.inlier_px * spec.inlier_px;
  double least = std::numeric_limits<double>::infinity();
  int inliers = 0;
  RansacEnd end(3, 20, spec.ransac_iterations);
  best = guess;
  if (stereo_continue(spec, points, best)) {
    least = 0.9 * stereo_score(spec.camera, points, best, limit, inliers);
    end.found(static_cast<double>(inliers) / count);
  }
  while (end.another()) {
    std::array<StereoPoint, 3> sample;
    std::array<std::uint32_t, 3> index{};
    draw_distinct(random, count, index);
    for (std::size_t i = 0; i < 3; ++i) sample[i] = points[index[i]];
    Rigid X_10 = guess;
    StereoMatrix6 normal;
    if (!stereo_fit(spec.camera, sample, false, X_10, normal)) continue;
    const double score = stereo_score(spec.camera, points, X_10, limit, inliers);
    if (!(score < least)) continue;
    least = score;
    best = X_10;
    end.found(static_cast<double>(inliers) / count);
  }
  return least < std::numeric_limits<double>::infinity();
}

/// Weighted squared errors of all points; those that are behind the camera have infinity.
std::vector<double> stereo_distances(const StereoCamera& camera, std::span<const StereoPoint> points,
                                     const Rigid& X_10) {
  std::vector<double> out(points.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector3d X1;
    Eigen::Vector4d errors;
    if (stereo_errors(camera, X_10, points[i], X1, errors))
      out[i] = errors.dot(stereo_weight(stereo_projection(camera, X1), X_10, points[i]) * errors);
  }
  return out;
}

double stereo_median_flow(std::span<const StereoMatch> matches, std::span<const std::uint32_t> chosen) {
  std::vector<double> flow;
  for (const std::uint32_t i : chosen) {
    const Vec2 move = matches[i].left1 - matches[i].left0;
    flow.push_back(math::hypot(move.x, move.y));
  }
  return median(flow);
}

}  // namespace

Status StereoSpec::check(const Node& node, const std::string& path) const {
  if (keyframe_motion_px > matching.radius_px)
    return node.error("no match has so much flow", "at most the matching's radius",
                      path + "/keyframe_motion");
  return {};
}

Status validate(const StereoSpec& spec) {
  SL_TRY(check_ranges(spec));
  SL_TRY(check_ranges(spec.camera));
  SL_TRY(check_ranges(spec.features));
  SL_TRY(check_ranges(spec.matching));
  return spec.check(Node{}, "");
}

StereoMotion estimate_motion(const StereoSpec& spec, std::span<const StereoMatch> matches, const Pose& guess,
                             Stream& random) {
  StereoMotion out;
  const std::vector<StereoPoint> points = stereo_points(spec, matches);
  out.matches = static_cast<int>(points.size());
  if (out.matches < spec.min_inliers) return out;
  out.outcome = Outcome::too_few_inliers;
  Rigid X_10;
  if (!stereo_ransac(spec, points, optical_motion(guess), random, X_10)) return out;

  // From the sample's inliers, by plain errors, to those within what the errors of all suggest. Median of chi-square with 4
  // degrees of freedom: 3.357; 18.47 is its 0.999 quantile.
  const double widest = 2 * spec.inlier_px * spec.inlier_px;
  StereoMatrix6 normal;
  double limit = widest, squares = 0;
  std::vector<StereoPoint> inliers;
  for (int round = 0; round < 4; ++round) {
    const std::vector<double> distances = stereo_distances(spec.camera, points, X_10);
    std::vector<double> within;
    for (const double d : distances)
      if (d <= limit) within.push_back(d);
    if (round > 0 && !within.empty())
      limit = std::clamp(18.47 * median(within) / 3.357, std::min(stereo_narrowest, widest), widest);
    inliers.clear();
    squares = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!(distances[i] <= limit)) continue;
      inliers.push_back(points[i]);
      squares += distances[i];
    }
    out.inliers.clear();
    for (const StereoPoint& point : inliers) out.inliers.push_back(point.match);
    // The share counts what agrees with the motion, not what agrees best.
    if (static_cast<int>(inliers.size()) < spec.min_inliers ||
        (round == 0 && static_cast<double>(inliers.size()) < spec.min_inlier_share * out.matches))
      return out;
    if (round == 3) break;
    if (!stereo_fit(spec.camera, inliers, true, X_10, normal)) return out;
  }

  const double variance = std::max(squares / (4.0 * static_cast<double>(inliers.size()) - 6),
                                   spec.least_noise_px * spec.least_noise_px);
  out.residual_px = std::sqrt(variance);
  out.X_KS = motion_of_S(X_10);
  const double common = spec.common_error_px * spec.common_error_px * static_cast<double>(inliers.size());
  out.errors = errors_of_S((variance + common) * StereoMatrix6(inverse_symmetric(normal)));
  const double deviation = std::sqrt(out.errors[0] + out.errors[7] + out.errors[14]);
  out.outcome = deviation <= spec.max_position_deviation_m ? Outcome::moved : Outcome::uncertain;
  return out;
}

Step advance(const StereoSpec& spec, StereoState& state, const GreyImage& left, const GreyImage& right) {
  Step step;
  Track& track = state.track;
  const std::uint64_t number = track.images++;
  const auto answer = [&](Outcome outcome) {
    step.outcome = outcome;
    ++track.counts[static_cast<std::size_t>(outcome)];
    return step;
  };
  if (!check(left) || !check(right) || left.width != right.width || left.height != right.height)
    return answer(Outcome::refused);

  StereoView view{view_of(left, spec.features), view_of(right, spec.features)};
  step.features = static_cast<int>(view.left.features.features.size());
  if (step.features < spec.min_inliers ||
      static_cast<int>(view.right.features.features.size()) < spec.min_inliers) {
    ++track.failures_in_row;
    return answer(Outcome::too_few_features);
  }
  const bool usable = sound(state.keyframe.left) && sound(state.keyframe.right);
  if (!usable || state.keyframe.left.image.width != left.width ||
      state.keyframe.left.image.height != left.height || state.keyframe.right.image.width != left.width ||
      state.keyframe.right.image.height != left.height ||
      state.keyframe.left.features.scale != view.left.features.scale ||
      state.keyframe.right.features.scale != view.left.features.scale) {
    state.keyframe = std::move(view);
    if (track.keyframes > 0) {
      enter_gap(track, step);
      return answer(Outcome::size_changed);
    }
    track.keyframes = 1;
    step.keyframe = true;
    return answer(Outcome::first_image);
  }

  const std::vector<StereoMatch> matches = match_circle(state.keyframe, view, spec.matching);
  Stream random(spec.seed, entity_key("stereo_odometry"), Purpose::controller, number);
  const StereoMotion motion = estimate_motion(spec, matches, track.X_KS * track.motion, random);
  step.matches = motion.matches;
  step.inliers = static_cast<int>(motion.inliers.size());
  step.residual_px = motion.residual_px;
  if (motion.outcome != Outcome::moved) {
    if (++track.failures_in_row > static_cast<std::uint32_t>(spec.patience)) {
      enter_gap(track, step);
      state.keyframe = std::move(view);
    }
    return answer(motion.outcome);
  }
  enter_pose(track, motion.X_KS, motion.errors, step);
  grow(track, spec.growth, step);
  if (track.keyframe_inliers == 0) track.keyframe_inliers = static_cast<std::uint32_t>(step.inliers);
  if (stereo_median_flow(matches, motion.inliers) > spec.keyframe_motion_px ||
      step.inliers < spec.keyframe_share * track.keyframe_inliers) {
    enter_keyframe(track, step);
    state.keyframe = std::move(view);
  }
  return answer(Outcome::moved);
}

}  // namespace sandlot::navigation::vo
