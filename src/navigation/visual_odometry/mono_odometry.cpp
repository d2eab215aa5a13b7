#include "navigation/visual_odometry/mono_odometry.h"

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

using MonoVector5 = Eigen::Matrix<double, 5, 1>;
using MonoMatrix5 = Eigen::Matrix<double, 5, 5>;

/// Directions in both optical frames, with z = 1.
struct MonoPoint {
  Eigen::Vector3d x0, x1;
  std::uint32_t match = 0;
};

struct MonoPoints {
  std::vector<MonoPoint> all;
  double focal_px = 1;
};

MonoPoints mono_points(const MonoCamera& c, std::span<const FlowMatch> matches) {
  MonoPoints out{{}, std::sqrt(c.fx_px * c.fy_px)};
  const auto direction = [&](Vec2 p) {
    return Eigen::Vector3d((p.x - c.cx_px) / c.fx_px, (p.y - c.cy_px) / c.fy_px, 1);
  };
  for (std::size_t i = 0; i < matches.size(); ++i)
    out.all.push_back({direction(matches[i].p0), direction(matches[i].p1), static_cast<std::uint32_t>(i)});
  return out;
}

/// Two directions at a right angle to t and to each other.
Eigen::Matrix<double, 3, 2> mono_tangents(const Eigen::Vector3d& t) {
  int least = 0;
  t.cwiseAbs().minCoeff(&least);
  Eigen::Matrix<double, 3, 2> out;
  out.col(0) = t.cross(Eigen::Vector3d::Unit(least)).normalized();
  out.col(1) = t.cross(out.col(0));
  return out;
}

/// Sampson distance of a point, in focal lengths; its derivative by a small turn and along the tangents of t, the denominator
/// taken as constant.
double mono_distance(const Rigid& X_10, const MonoPoint& point, const Eigen::Matrix<double, 3, 2>* tangents,
                     MonoVector5* slope) {
  const Eigen::Vector3d q = X_10.R * point.x0, a = point.x1.cross(X_10.t), line1 = X_10.t.cross(q),
                        line0 = X_10.R.transpose() * a;
  const double squares = line1.head<2>().squaredNorm() + line0.head<2>().squaredNorm();
  const double scale = squares > 1e-24 ? 1 / std::sqrt(squares) : 0;
  if (slope) {
    slope->head<3>() = scale * q.cross(a);
    slope->tail<2>() = scale * (tangents->transpose() * q.cross(point.x1));
  }
  return scale * a.dot(q);
}

double mono_cost(std::span<const MonoPoint> points, const Rigid& X_10) {
  double sum = 0;
  for (const MonoPoint& point : points) {
    const double d = mono_distance(X_10, point, nullptr, nullptr);
    sum += d * d;
  }
  return sum;
}

/// Normal equations of a small turn and of a move of t along its tangents.
void mono_normal(std::span<const MonoPoint> points, const Rigid& X_10, MonoMatrix5& normal,
                 MonoVector5& right) {
  const auto tangents = mono_tangents(X_10.t);
  normal.setZero();
  right.setZero();
  for (const MonoPoint& point : points) {
    MonoVector5 slope;
    const double d = mono_distance(X_10, point, &tangents, &slope);
    normal.noalias() += slope * slope.transpose();
    right.noalias() -= d * slope;
  }
}

/// Levenberg-Marquardt on rotation and direction of t. Returns the sum of squared distances.
double mono_fit(std::span<const MonoPoint> points, int steps, Rigid& X_10) {
  double cost = mono_cost(points, X_10), damping = 1e-3;
  for (int step = 0; step < steps; ++step) {
    const auto tangents = mono_tangents(X_10.t);
    MonoMatrix5 normal;
    MonoVector5 right;
    mono_normal(points, X_10, normal, right);
    bool better = false;
    for (int attempt = 0; attempt < 5 && !better; ++attempt) {
      MonoMatrix5 damped = normal;
      damped.diagonal() *= 1 + damping;
      damped.diagonal().array() += 1e-15;
      const MonoVector5 move = solve_symmetric(damped, right);
      if (!move.allFinite()) return std::numeric_limits<double>::infinity();
      Rigid next = X_10;
      next.R = small_turn(move.head<3>()) * X_10.R;
      next.t = (X_10.t + tangents * move.tail<2>()).normalized();
      const double next_cost = mono_cost(points, next);
      if (next_cost < cost) {
        better = true;
        const bool rest = cost - next_cost < 1e-9 * cost || move.cwiseAbs().maxCoeff() < 1e-9;
        X_10 = next;
        cost = next_cost;
        damping = std::max(damping * 0.1, 1e-9);
        if (rest) return cost;
      } else {
        damping = std::max(damping * 10, 1e-6);
      }
    }
    if (!better) break;
  }
  return cost;
}

/// Squared distances of all points, each cut off at `limit`; those below it.
double mono_score(std::span<const MonoPoint> points, const Rigid& X_10, double limit,
                  std::vector<MonoPoint>& inliers) {
  double sum = 0;
  inliers.clear();
  for (const MonoPoint& point : points) {
    const double d = mono_distance(X_10, point, nullptr, nullptr);
    if (d * d < limit) inliers.push_back(point);
    sum += std::min(d * d, limit);
  }
  return sum;
}

/// Best of the motions of samples of five points.
bool mono_ransac(const MonoSpec& spec, const MonoPoints& points, const Rigid& guess, Stream& random,
                 Rigid& best) {
  const auto count = static_cast<std::uint32_t>(points.all.size());
  const double limit = spec.inlier_px * spec.inlier_px / (points.focal_px * points.focal_px);
  double least = std::numeric_limits<double>::infinity();
  std::vector<MonoPoint> inliers;
  // Many samples end off their solution, so that the share of inliers alone would end too early.
  RansacEnd end(5, 300, spec.ransac_iterations);
  for (int number = 0; end.another(); ++number) {
    std::array<MonoPoint, 5> sample;
    std::array<std::uint32_t, 5> index{};
    draw_distinct(random, count, index);
    for (std::size_t i = 0; i < 5; ++i) sample[i] = points.all[index[i]];
    Rigid X_10 = guess;
    // Every other sample begins from the guess's direction, if it has one, the others anywhere.
    if (number % 2 == 1 || !(guess.t.norm() > 1e-9)) {
      const double x = random.normal(), y = random.normal(), z = random.normal();
      X_10.t = Eigen::Vector3d(x, y, z);
      if (!(X_10.t.norm() > 1e-9)) X_10.t = Eigen::Vector3d::UnitZ();
    }
    X_10.t.normalize();
    // Five points have an exact solution: steps that end elsewhere found none.
    if (!(mono_fit(sample, 20, X_10) < 0.01 * limit)) continue;
    double score = mono_score(points.all, X_10, limit, inliers);
    if (!(score < 2 * least)) continue;
    // Improved by its own inliers: wrong directions that fit many points within a pixel are left that way.
    Rigid better = X_10;
    if (std::isfinite(mono_fit(inliers, 6, better))) {
      const double better_score = mono_score(points.all, better, limit, inliers);
      if (better_score < score) X_10 = better, score = better_score;
    }
    if (!(score < least)) continue;
    least = score;
    best = X_10;
    end.found(1 - score / (limit * count));
  }
  return least < std::numeric_limits<double>::infinity();
}

/// Depth of a point along x0, in lengths of t; its parallax is the angle between the rays.
double mono_depth(const Rigid& X_10, const MonoPoint& point, double& parallax_rad) {
  const Eigen::Vector3d q = X_10.R * point.x0, across = q.cross(point.x1);
  parallax_rad = across.norm() / (q.norm() * point.x1.norm());
  return -across.dot(X_10.t.cross(point.x1)) / std::max(across.squaredNorm(), 1e-24);
}

/// Share of the points, among those with a parallax above `least_rad`, that lie in front of both cameras.
double mono_in_front(std::span<const MonoPoint> points, const Rigid& X_10, double least_rad) {
  int front = 0, all = 0;
  for (const MonoPoint& point : points) {
    double parallax = 0;
    const double depth = mono_depth(X_10, point, parallax);
    if (!(parallax > least_rad)) continue;
    ++all;
    front += depth > 0 && point.x1.dot(depth * (X_10.R * point.x0) + X_10.t) > 0;
  }
  return all > 0 ? static_cast<double>(front) / all : 0;
}

/// Rotation that maps the directions best, translation left out: steps with Cauchy weights.
struct MonoTurn {
  Eigen::Matrix3d R;
  Eigen::Matrix3d normal;
  std::vector<double> errors_px;
};
MonoTurn mono_turn(const MonoPoints& points, const Eigen::Matrix3d& guess) {
  constexpr double width_px = 2;
  MonoTurn out{guess, Eigen::Matrix3d::Zero(), {}};
  for (int step = 0; step < 30; ++step) {
    out.normal.setZero();
    out.errors_px.clear();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const MonoPoint& point : points.all) {
      const Eigen::Vector3d q = out.R * point.x0;
      if (!(q.z() > 1e-3)) {
        out.errors_px.push_back(std::numeric_limits<double>::infinity());
        continue;
      }
      const double u = q.x() / q.z(), v = q.y() / q.z();
      Eigen::Matrix<double, 2, 3> slope;  // of (u, v) by the turn
      slope << -u * v, 1 + u * u, -v, -1 - v * v, u * v, u;
      const Eigen::Vector2d error(point.x1.x() - u, point.x1.y() - v);
      const double error_px = points.focal_px * error.norm();
      const double weight = 1 / (1 + error_px * error_px / (width_px * width_px));
      out.normal.noalias() += weight * slope.transpose() * slope;
      right.noalias() += weight * slope.transpose() * error;
      out.errors_px.push_back(error_px);
    }
    const Eigen::Vector3d move = solve_symmetric(out.normal, right);
    if (!move.allFinite() || !(move.norm() < 10)) break;
    if (move.norm() < 1e-9) break;
    out.R = small_turn(move) * out.R;
  }
  return out;
}

struct MonoGround {
  int points = 0;
  double height = 0;     ///< of the camera, in lengths of t
  double deviation = 0;  ///< of the height, relative
};
/// Height at which most points lie below the camera, none of them much deeper.
MonoGround mono_ground(const MonoSpec& spec, const MonoPoints& points, std::span<const MonoPoint> inliers,
                       const Rigid& X_10, double noise_px) {
  const auto [s, c] = math::sincos(spec.camera.pitch_rad);
  struct Height {
    double h, weight;
  };
  std::vector<Height> heights;
  for (const MonoPoint& point : inliers) {
    double parallax = 0;
    const double depth = mono_depth(X_10, point, parallax);
    const double deviation = 1.5 * noise_px / (points.focal_px * parallax);
    const double h = depth * (c * point.x0.y() + s * point.x0.z());
    if (depth > 0 && h > 0 && deviation < 0.1) heights.push_back({h, 1 / (deviation * deviation + 1e-4)});
  }
  MonoGround out;
  double votes = 0;
  for (const Height& candidate : heights) {
    double sum = 0;
    for (const Height& other : heights)
      if (std::abs(other.h - candidate.h) < 0.03 * candidate.h) sum += other.weight;
    if (!(sum > votes)) continue;
    votes = sum;
    out.height = candidate.h;
  }
  // To the centre of the peak: a wall's foot lies on one side of it only.
  for (int step = 0; step < 20 && votes > 0; ++step) {
    double sum = 0, weights = 0;
    for (const Height& other : heights) {
      const double apart = (other.h / out.height - 1) / 0.02;
      if (std::abs(apart) > 4) continue;
      const double weight = other.weight * math::exp(-0.5 * apart * apart);
      sum += weight * other.h;
      weights += weight;
    }
    out.height = sum / weights;
  }
  double squares = 0;
  int below = 0;
  for (const Height& other : heights) {
    const double apart = other.h / out.height - 1;
    if (std::abs(apart) < 0.06) ++out.points, squares += apart * apart;
    below += apart > 0.12;
  }
  if (out.points < spec.min_ground_points || below > 0.3 * out.points) out.points = 0;
  if (out.points > 0) out.deviation = std::max(std::sqrt(squares) / out.points, 0.002);
  return out;
}

double mono_median_flow(std::span<const FlowMatch> matches, std::span<const std::uint32_t> chosen) {
  std::vector<double> flow;
  for (const std::uint32_t i : chosen) {
    const Vec2 move = matches[i].p1 - matches[i].p0;
    flow.push_back(math::hypot(move.x, move.y));
  }
  return median(flow);
}

/// Answer to matches without enough parallax.
void mono_answer_turn(const MonoSpec& spec, const MonoPoints& points, const MonoTurn& turn, MonoMotion& out) {
  double squares = 0;
  for (std::size_t i = 0; i < turn.errors_px.size(); ++i) {
    if (!(turn.errors_px[i] < 2 * spec.min_parallax_px)) continue;
    out.inliers.push_back(points.all[i].match);
    squares += turn.errors_px[i] * turn.errors_px[i];
  }
  const auto count = static_cast<double>(out.inliers.size());
  if (count < spec.min_inliers || count < spec.min_inlier_share * static_cast<double>(points.all.size())) {
    out.outcome = Outcome::too_few_inliers;
    return;
  }
  const double f = points.focal_px;
  const double variance = std::max(squares / (2 * count - 3), spec.least_noise_px * spec.least_noise_px);
  out.residual_px = std::sqrt(variance);
  Rigid X_10;
  X_10.R = turn.R;
  Eigen::Matrix<double, 6, 6> errors = Eigen::Matrix<double, 6, 6>::Zero();
  const double hidden = spec.min_parallax_px / f * 5 * spec.camera.height_m, tilt = out.parallax_px / f;
  errors.topLeftCorner<3, 3>() = hidden * hidden * Eigen::Matrix3d::Identity();
  // What little parallax there is may have gone into the rotation.
  errors.bottomRightCorner<3, 3>() = variance / (f * f) * Eigen::Matrix3d(inverse_symmetric(turn.normal)) +
                                     tilt * tilt * Eigen::Matrix3d::Identity();
  out.X_KS = motion_of_S(X_10);
  out.errors = errors_of_S(errors);
  out.outcome = Outcome::turned;
}

}  // namespace

Status MonoSpec::check(const Node& node, const std::string& path) const {
  if (keyframe_motion_px > matching.radius_px)
    return node.error("no match has so much flow", "at most the matching's radius",
                      path + "/keyframe_motion");
  return {};
}

Status validate(const MonoSpec& spec) {
  SL_TRY(check_ranges(spec));
  SL_TRY(check_ranges(spec.camera));
  SL_TRY(check_ranges(spec.features));
  SL_TRY(check_ranges(spec.matching));
  return spec.check(Node{}, "");
}

MonoMotion estimate_motion(const MonoSpec& spec, std::span<const FlowMatch> matches, const Pose& guess,
                           Stream& random) {
  MonoMotion out;
  if (static_cast<int>(matches.size()) < spec.min_inliers) return out;
  const MonoPoints points = mono_points(spec.camera, matches);
  const double f = points.focal_px;
  const Rigid begin = optical_motion(guess);
  const MonoTurn turn = mono_turn(points, begin.R);
  std::vector<double> errors_px = turn.errors_px;
  out.parallax_px = median(errors_px);
  if (out.parallax_px < spec.min_parallax_px) return mono_answer_turn(spec, points, turn, out), out;

  out.outcome = Outcome::too_few_inliers;
  Rigid X_10;
  if (!mono_ransac(spec, points, begin, random, X_10)) return out;
  // Inliers within what the errors of all suggest. Median of a squared normal: 0.455; 10.83 is its 0.999 quantile.
  const double widest = spec.inlier_px * spec.inlier_px / (f * f),
               narrowest = std::min(widest, 10.83 * 0.15 * 0.15 / (f * f));  // as in stereo_odometry.cpp
  double limit = widest, squares = 0;
  std::vector<MonoPoint> inliers;
  for (int round = 0; round < 4; ++round) {
    std::vector<double> within;
    inliers.clear();
    out.inliers.clear();
    squares = 0;
    for (const MonoPoint& point : points.all) {
      const double d = mono_distance(X_10, point, nullptr, nullptr);
      if (!(d * d <= limit)) continue;
      within.push_back(d * d);
      inliers.push_back(point);
      out.inliers.push_back(point.match);
      squares += d * d;
    }
    limit = std::clamp(10.83 * median(within) / 0.455, narrowest, widest);
    // The share counts what agrees with the motion, not what agrees best.
    if (static_cast<int>(inliers.size()) < spec.min_inliers ||
        (round == 0 &&
         static_cast<double>(inliers.size()) < spec.min_inlier_share * static_cast<double>(matches.size())))
      return out;
    if (round == 3) break;
    if (!std::isfinite(mono_fit(inliers, 20, X_10))) return out;
  }
  const double variance = std::max(squares / (static_cast<double>(inliers.size()) - 5),
                                   spec.least_noise_px * spec.least_noise_px / (f * f));
  out.residual_px = f * std::sqrt(variance);

  // The distances do not change with the sign of t.
  const double least_rad = spec.min_parallax_px / f;
  Rigid opposite = X_10;
  opposite.t = -opposite.t;
  const double front = mono_in_front(inliers, X_10, least_rad),
               back = mono_in_front(inliers, opposite, least_rad);
  if (back > front) X_10 = opposite;
  if (!(std::max(front, back) > 0.75)) return out;

  const MonoGround ground = mono_ground(spec, points, inliers, X_10, out.residual_px);
  out.ground_points = ground.points;
  if (ground.points == 0) {
    out.outcome = Outcome::no_ground;
    return out;
  }
  // Errors of (turn, direction, scale) to those of (translation, turn).
  const double scale = spec.camera.height_m / ground.height;
  MonoMatrix5 normal;
  MonoVector5 right;
  mono_normal(inliers, X_10, normal, right);
  const Eigen::Vector3d direction = X_10.t;
  X_10.t *= scale;
  Eigen::Matrix<double, 6, 6> by = Eigen::Matrix<double, 6, 6>::Zero(), parts = by;
  by.topLeftCorner<3, 3>() << 0, -X_10.t.z(), X_10.t.y(), X_10.t.z(), 0, -X_10.t.x(), -X_10.t.y(), X_10.t.x(),
      0;
  by.block<3, 2>(0, 3) = scale * mono_tangents(direction);
  by.block<3, 1>(0, 5) = direction;
  by.bottomLeftCorner<3, 3>().setIdentity();
  const double common = spec.common_error_px * spec.common_error_px / (f * f) *
                        static_cast<double>(inliers.size());
  parts.topLeftCorner<5, 5>() = (variance + common) * MonoMatrix5(inverse_symmetric(normal));
  parts(5, 5) = scale * scale * ground.deviation * ground.deviation;
  out.X_KS = motion_of_S(X_10);
  out.errors = errors_of_S(by * parts * by.transpose());
  const double deviation = std::sqrt(out.errors[0] + out.errors[7] + out.errors[14]);
  out.outcome = deviation <= spec.max_position_deviation_m ? Outcome::moved : Outcome::uncertain;
  return out;
}

Step advance(const MonoSpec& spec, MonoState& state, const GreyImage& image) {
  Step step;
  Track& track = state.track;
  const std::uint64_t number = track.images++;
  const auto answer = [&](Outcome outcome) {
    step.outcome = outcome;
    ++track.counts[static_cast<std::size_t>(outcome)];
    return step;
  };
  if (!check(image)) return answer(Outcome::refused);
  View view = view_of(image, spec.features);
  step.features = static_cast<int>(view.features.features.size());
  if (step.features < spec.min_inliers) {
    ++track.failures_in_row;
    return answer(Outcome::too_few_features);
  }
  if (!sound(state.keyframe) || state.keyframe.image.width != image.width ||
      state.keyframe.image.height != image.height || state.keyframe.features.scale != view.features.scale) {
    state.keyframe = std::move(view);
    if (track.keyframes > 0) {
      enter_gap(track, step);
      return answer(Outcome::size_changed);
    }
    track.keyframes = 1;
    step.keyframe = true;
    return answer(Outcome::first_image);
  }

  const std::vector<FlowMatch> matches = match_flow(state.keyframe, view, spec.matching);
  Stream random(spec.seed, entity_key("mono_odometry"), Purpose::controller, number);
  const MonoMotion motion = estimate_motion(spec, matches, track.X_KS * track.motion, random);
  step.matches = static_cast<int>(matches.size());
  step.inliers = static_cast<int>(motion.inliers.size());
  step.residual_px = motion.residual_px;
  if (!has_pose(motion.outcome)) {
    if (++track.failures_in_row > static_cast<std::uint32_t>(spec.patience)) {
      enter_gap(track, step);
      state.keyframe = std::move(view);
    }
    return answer(motion.outcome);
  }
  enter_pose(track, motion.X_KS, motion.errors, step);
  grow(track, spec.growth, step);
  if (track.keyframe_inliers == 0) track.keyframe_inliers = static_cast<std::uint32_t>(step.inliers);
  const double flow_px = mono_median_flow(matches, motion.inliers);
  const bool far = motion.outcome == Outcome::turned ? flow_px > 0.5 * spec.matching.radius_px
                                                     : flow_px > spec.keyframe_motion_px;
  const bool scarce = motion.outcome == Outcome::moved && motion.ground_points < 3 * spec.min_ground_points;
  if (far || scarce || step.inliers < spec.keyframe_share * track.keyframe_inliers) {
    enter_keyframe(track, step);
    state.keyframe = std::move(view);
  }
  return answer(motion.outcome);
}

}  // namespace sandlot::navigation::vo
