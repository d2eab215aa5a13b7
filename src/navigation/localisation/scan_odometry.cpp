#include "navigation/localisation/scan_odometry.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "navigation/localisation/plane_fit.h"

namespace sandlot::navigation::laser {
namespace {

constexpr Time laser_last_stamp{4'000'000'000'000'000'000};
constexpr int laser_least_points = 8;
constexpr double laser_least_cosine = 0.7;  ///< between the normals of a pair
constexpr double laser_near_m = 0.15, laser_search_step_rad = 0.1;

Outcome laser_count(State& state, Outcome outcome) {
  ++state.counts[static_cast<std::size_t>(outcome)];
  return state.last = outcome;
}

void laser_set_key(State& state, const ScanPoints& points) {
  state.key.clear();
  for (std::size_t i = 0; i < points.p_B.size(); ++i) {
    const Vec2 p = points.p_B[i], n = points.normal_B[i];
    if (n != Vec2{}) state.key.push_back({p.x, p.y, n.x, n.y});
  }
  std::sort(state.key.begin(), state.key.end(), [](const KeyPoint& a, const KeyPoint& b) {
    return a.x_m < b.x_m || (a.x_m == b.x_m && a.y_m < b.y_m);
  });
  state.key_pose = state.pose;
  state.key_covariance = state.covariance;
  ++state.keys;
}

/// Nearest point of the key scan within a distance; null when there is none. The key's points are sorted by x.
const KeyPoint* laser_nearest(const std::vector<KeyPoint>& key, Vec2 p, double reach) {
  const auto middle = std::lower_bound(key.begin(), key.end(), p.x,
                                       [](const KeyPoint& each, double x) { return each.x_m < x; });
  double best = reach * reach;
  const KeyPoint* out = nullptr;
  const auto take = [&](const KeyPoint& each) {
    const double dx = each.x_m - p.x, dy = each.y_m - p.y;
    if (dx * dx > best) return false;
    if (const double square = dx * dx + dy * dy; square < best) best = square, out = &each;
    return true;
  };
  for (auto each = middle; each != key.end() && take(*each); ++each) {}
  for (auto each = middle; each != key.begin() && take(*(each - 1)); --each) {}
  return out;
}

/// Number of points that have a pair near by, of the same direction, at a pose.
int laser_pairs_near(const State& state, const ScanPoints& points, const Pose2& X_KB) {
  int out = 0;
  const auto [s, c] = math::sincos(X_KB.theta);
  for (std::size_t i = 0; i < points.p_B.size(); ++i) {
    const Vec2 p = points.p_B[i], n = points.normal_B[i];
    if (n == Vec2{}) continue;
    const KeyPoint* pair = laser_nearest(state.key, {X_KB.x + c * p.x - s * p.y, X_KB.y + s * p.x + c * p.y},
                                         laser_near_m);
    if (pair &&
        pair->normal_x * (c * n.x - s * n.y) + pair->normal_y * (s * n.x + c * n.y) >= laser_least_cosine)
      ++out;
  }
  return out;
}

/// The guess, or a pose that the scan fits clearly better: standing, or turned by up to `search_angle`.
Pose2 laser_first_guess(const Spec& spec, const State& state, const ScanPoints& points, const Pose2& guess) {
  Pose2 out = guess;
  int best = 11 * laser_pairs_near(state, points, guess) / 10;
  const int turns = static_cast<int>(spec.search_angle_rad / laser_search_step_rad);
  for (const Pose2& from : {guess, relative(state.key_pose, state.pose)})
    for (int k = -turns; k <= turns; ++k) {
      const Pose2 turned{from.x, from.y, math::wrap_angle(from.theta + k * laser_search_step_rad)};
      if (const int pairs = laser_pairs_near(state, points, turned); pairs > best) best = pairs, out = turned;
    }
  return out;
}

struct LaserMatch {
  bool converged = false;
  Pose2 pose;  ///< X_KB
  Covariance3 covariance{};
  int observable = 0, pairs = 0, surfaces = 0;
  double rms_m = 0;
};

LaserMatch laser_match(const Spec& spec, const State& state, const ScanPoints& points, const Pose2& guess) {
  LaserMatch out{.pose = guess};
  double squares = 0;
  for (std::size_t i = 0; i < points.p_B.size(); ++i) {
    squares += dot(points.p_B[i], points.p_B[i]);
    out.surfaces += points.normal_B[i] != Vec2{};
  }
  PlaneFit fit(std::max(0.1, std::sqrt(squares / static_cast<double>(points.p_B.size()))));
  double reach = spec.reach_m, gain = 1;
  for (int step = 0; step < spec.max_steps && !out.converged; ++step) {
    fit.clear();
    const auto [s, c] = math::sincos(out.pose.theta);
    for (std::size_t i = 0; i < points.p_B.size(); ++i) {
      const Vec2 p = points.p_B[i], n = points.normal_B[i];
      if (n == Vec2{}) continue;
      const Vec2 r{c * p.x - s * p.y, s * p.x + c * p.y}, q = Vec2{out.pose.x, out.pose.y} + r,
                                                          n_K{c * n.x - s * n.y, s * n.x + c * n.y};
      const KeyPoint* pair = laser_nearest(state.key, q, reach);
      if (!pair) continue;
      const Vec2 m{pair->normal_x, pair->normal_y};
      if (dot(m, n_K) < laser_least_cosine) continue;
      const double error = m.x * (q.x - pair->x_m) + m.y * (q.y - pair->y_m);
      // Huber's weight: pairs of different surfaces count less, once it lies about right.
      const double bound = step == 0 ? spec.reach_m : 3 * std::max(spec.range_deviation_m, out.rms_m / 2);
      fit.add(m, r, error, std::abs(error) > bound ? bound / std::abs(error) : 1);
    }
    out.pairs = fit.points();
    out.rms_m = fit.rms();
    if (out.pairs < laser_least_points) return out;
    const PlaneFit::Step change = fit.solve(spec.weakest_direction);
    out.observable = change.observable;
    // Pairs that change, which is a matter of millimetres, would never let it rest.
    if (step >= 10) gain *= 0.8;
    out.pose = {out.pose.x + gain * change.x, out.pose.y + gain * change.y,
                math::wrap_angle(out.pose.theta + gain * change.theta)};
    reach = std::clamp(5 * out.rms_m, std::min(0.1, reach), reach);
    out.converged = gain * math::hypot(change.x, change.y) < 1e-4 && gain * std::abs(change.theta) < 1e-4;
  }
  out.converged = out.converged && out.pairs >= spec.min_share * out.surfaces;
  out.covariance = fit.covariance(std::max(out.rms_m, spec.range_deviation_m), spec.weakest_direction);
  return out;
}

/// Covariance of X_OB = X_OK X_KB: that of X_KB turned into O, and that of X_OK carried to B.
Covariance3 laser_joined(const State& state, const LaserMatch& match) {
  const auto [s, c] = math::sincos(state.key_pose.theta);
  const double dx = c * match.pose.x - s * match.pose.y, dy = s * match.pose.x + c * match.pose.y;
  Eigen::Matrix3d turn, carry;
  turn << c, -s, 0, s, c, 0, 0, 0, 1;
  carry << 1, 0, -dy, 0, 1, dx, 0, 0, 1;
  using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  const Eigen::Map<const Rows> before(state.key_covariance.data()), step(match.covariance.data());
  Covariance3 out{};
  Eigen::Map<Rows>(out.data()) = carry * before * carry.transpose() + turn * step * turn.transpose();
  // Unknown stays unknown, however many scans there are.
  const double greatest = std::max({out[0], out[4], out[8]}), most = 1e3 * unknown_variance;
  if (greatest > most)
    for (double& each : out) each *= most / greatest;
  return out;
}

}  // namespace

std::span<const EnumName<Outcome>> enum_names(Outcome) {
  static constexpr EnumName<Outcome> names[] = {
      {"matched", Outcome::matched},     {"started", Outcome::started},   {"lost", Outcome::lost},
      {"late", Outcome::late},           {"rewound", Outcome::rewound},   {"bad_stamp", Outcome::bad_stamp},
      {"bad_guess", Outcome::bad_guess}, {"bad_scan", Outcome::bad_scan}, {"bad_mount", Outcome::bad_mount},
      {"no_beams", Outcome::no_beams}};
  return names;
}

Status Spec::check(const Node& node, const std::string& path) const {
  if (!(min_range_m < max_range_m))
    return node.error("min_range is not below max_range", "a shorter min_range", path + "/min_range");
  if (min_share > key_share)
    return node.error("min_share is above key_share", "a scan becomes the key scan before it is lost",
                      path + "/key_share");
  return {};
}

bool State::fits(const Spec& spec) const {
  const auto finite = [](const Covariance3& P) {
    return std::all_of(P.begin(), P.end(), [](double x) { return std::abs(x) <= 1e12; });
  };
  if (key.size() > static_cast<std::size_t>(spec.max_points) || (known && key.empty())) return false;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const KeyPoint& each = key[i];
    if (!(std::abs(each.x_m) <= 1e6 && std::abs(each.y_m) <= 1e6 && std::abs(each.normal_x) <= 1.001 &&
          std::abs(each.normal_y) <= 1.001) ||
        (i > 0 && each.x_m < key[i - 1].x_m))
      return false;
  }
  return is_bounded(pose) && is_bounded(key_pose) && is_bounded(motion) && finite(covariance) &&
         finite(key_covariance) && motion_s >= 0 && motion_s <= 1e12;
}

Result<State> begin(const Spec& spec) {
  SL_TRY(check_ranges(spec));
  SL_TRY(spec.check(Node{}, ""));
  return State{};
}

Outcome update(const Spec& spec, State& state, Workspace& work, const msg::LaserScan& scan, const Pose& X_BL,
               const Pose2* motion) {
  const Time stamp = scan.header.stamp;
  if (stamp < Time{} || stamp > laser_last_stamp) return laser_count(state, Outcome::bad_stamp);
  if (motion && !is_bounded(*motion)) return laser_count(state, Outcome::bad_guess);
  const double dt_s = (stamp - state.at).s();
  const bool rewound = state.known && dt_s < -spec.longest_gap_s;
  if (state.known && dt_s <= 0 && !rewound) return laser_count(state, Outcome::late);

  ScanPoints& points = work.scan;
  const ScanFault fault = take_points(scan, X_BL, {spec.min_range_m, spec.max_range_m, spec.max_points},
                                      points);
  if (fault == ScanFault::bad_scan) return laser_count(state, Outcome::bad_scan);
  if (fault == ScanFault::bad_mount) return laser_count(state, Outcome::bad_mount);
  if (fault == ScanFault::no_beams) return laser_count(state, Outcome::no_beams);
  add_normals(points, spec.normal_radius_m, spec.max_gap_m);
  if (std::count_if(points.normal_B.begin(), points.normal_B.end(), [](Vec2 n) { return n != Vec2{}; }) <
      laser_least_points)
    return laser_count(state, Outcome::no_beams);

  if (!state.known || rewound) {
    state.at = stamp;
    state.motion = {};
    state.motion_s = 0;
    laser_set_key(state, points);
    return laser_count(state, std::exchange(state.known, true) ? Outcome::rewound : Outcome::started);
  }
  Pose2 step;
  if (motion) {
    step = *motion;
  } else if (state.motion_s > 0 && dt_s <= spec.longest_gap_s) {
    const double part = dt_s / state.motion_s;
    step = {part * state.motion.x, part * state.motion.y, part * state.motion.theta};
  }
  const Pose2 before = state.pose;
  const Pose2 guess = compose(before, step);
  LaserMatch match = laser_match(spec, state, points,
                                 laser_first_guess(spec, state, points, relative(state.key_pose, guess)));
  state.at = stamp;
  state.pairs = match.pairs;
  state.rms_m = match.rms_m;
  state.observable = match.observable;
  if (!match.converged) {
    state.observable = 0;
    match.pose = relative(state.key_pose, guess);
    match.covariance = unknown_covariance;
  }
  state.covariance = laser_joined(state, match);
  state.pose = compose(state.key_pose, match.pose);
  state.motion = relative(before, state.pose);
  state.motion_s = match.converged && dt_s <= spec.longest_gap_s ? dt_s : 0;
  if (!match.converged || math::hypot(match.pose.x, match.pose.y) > spec.key_distance_m ||
      std::abs(match.pose.theta) > spec.key_angle_rad || match.pairs < spec.key_share * match.surfaces)
    laser_set_key(state, points);
  return laser_count(state, match.converged ? Outcome::matched : Outcome::lost);
}

}  // namespace sandlot::navigation::laser
