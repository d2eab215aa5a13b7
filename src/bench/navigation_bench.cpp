/// Navigation: a step of the filter against the same mathematics in bare Eigen, stereo odometry against OpenCV, planners against a plain A*.
#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <queue>

#include "base/math.h"
#include "base/random.h"
#include "bench/bench.h"
#include "navigation/estimation/ekf.h"
#include "navigation/planning/grid_planner.h"
#include "navigation/planning/hybrid_astar.h"
#include "navigation/visual_odometry/stereo_odometry.h"
#ifdef SANDLOT_HAS_OPENCV
#include "bench/opencv_odometry.h"
#endif

namespace sandlot::bench {
namespace {

namespace ekf = sandlot::navigation::ekf;
namespace nav = sandlot::navigation;

/// The filter as one writes it with Eigen: 15 states, dense matrices of fixed size, P = (I - K H) P.
struct BareFilter {
  Eigen::Matrix<double, 15, 1> x = Eigen::Matrix<double, 15, 1>::Zero();
  Eigen::Matrix<double, 15, 15> P = Eigen::Matrix<double, 15, 15>::Identity(), F = P;
  Eigen::Matrix<double, 15, 1> noise_per_s = x;
  Eigen::Matrix<double, 6, 15> H = Eigen::Matrix<double, 6, 15>::Zero();

  BareFilter() { H.block<6, 6>(0, 6).setIdentity(); }

  void predict(double dt) {
    const double sr = math::sin(x[3]), cr = math::cos(x[3]), sp = math::sin(x[4]), cp = math::cos(x[4]),
                 sy = math::sin(x[5]), cy = math::cos(x[5]), tp = sp / cp;
    Eigen::Matrix3d R, by_roll, by_pitch, by_yaw, E;
    R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
        sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
        -sp, cp * sr, cp * cr;
    by_roll << 0, R(0, 2), -R(0, 1), 0, R(1, 2), -R(1, 1), 0, R(2, 2), -R(2, 1);
    by_pitch << -cy * sp, cy * cp * sr, cy * cp * cr, -sy * sp, sy * cp * sr, sy * cp * cr, -cp, -sp * sr,
        -sp * cr;
    by_yaw << -R.row(1), R.row(0), Eigen::RowVector3d::Zero();
    E << 1, sr * tp, cr * tp, 0, cr, -sr, 0, sr / cp, cr / cp;
    const Eigen::Vector3d way = x.segment<3>(6) * dt + x.segment<3>(12) * (dt * dt / 2), w = x.segment<3>(9);
    F.block<3, 3>(0, 6) = R * dt;
    F.block<3, 3>(0, 12) = R * (dt * dt / 2);
    F.block<3, 3>(6, 12) = Eigen::Matrix3d::Identity() * dt;
    F.block<3, 1>(0, 3) = by_roll * way;
    F.block<3, 1>(0, 4) = by_pitch * way;
    F.block<3, 1>(0, 5) = by_yaw * way;
    F.block<3, 3>(3, 9) = E * dt;
    const double across = cr * w[1] - sr * w[2], along = sr * w[1] + cr * w[2];
    F(3, 3) = 1 + tp * across * dt;
    F(3, 4) = along / (cp * cp) * dt;
    F(4, 3) = -along * dt;
    F(5, 3) = across / cp * dt;
    F(5, 4) = along * tp / cp * dt;
    x.segment<3>(0) += R * way;
    x.segment<3>(3) += E * w * dt;
    x.segment<3>(6) += x.segment<3>(12) * dt;
    P = F * P * F.transpose();
    P.diagonal() += noise_per_s * dt;
  }
  void correct(const Eigen::Matrix<double, 6, 1>& z, const Eigen::Matrix<double, 6, 6>& N) {
    const Eigen::Matrix<double, 15, 6> PHt = P * H.transpose();
    const Eigen::Matrix<double, 6, 6> S = H * PHt + N;
    const Eigen::Matrix<double, 15, 6> K = S.llt().solve(PHt.transpose()).transpose();
    x += K * (z - H * x);
    for (const int i : {3, 4, 5}) x[i] = math::wrap_angle(x[i]);
    P = (Eigen::Matrix<double, 15, 15>::Identity() - K * H) * P;
  }
};

/// What a robot measures that turns and climbs a little: six velocities.
std::array<double, 6> velocities(std::uint64_t k) {
  const double t = 0.02 * static_cast<double>(k % 1000);
  return {0.5 + 0.1 * t, 0.05 * t - 0.5, 0.01, 0.02 - 0.002 * t, 0.002 * t - 0.02, 0.3};
}

std::vector<Row> filter() {
  constexpr int steps = 2000;
  constexpr Time dt{20'000'000};
  ekf::Spec spec;
  ekf::Sensor sensor;
  sensor.name = "odometry";
  for (std::size_t i = ekf::Vx; i <= ekf::Vyaw; ++i) sensor.config[i] = true;
  spec.sensors = {sensor};
  auto begun = ekf::begin(spec);
  SL_CHECK(begun);
  ekf::State state = std::move(*begun);
  msg::Odometry message;
  for (std::size_t i = 0; i < 6; ++i) message.twist.covariance[7 * i] = 1e-3 + 1e-4 * static_cast<double>(i);
  Eigen::Matrix<double, 6, 6> N = Eigen::Matrix<double, 6, 6>::Zero();
  for (int i = 0; i < 6; ++i) N(i, i) = 1e-3 + 1e-4 * i;

  const auto measure = [&](std::uint64_t k) {
    const auto v = velocities(k);
    message.header.stamp = dt * static_cast<std::int64_t>(k);
    message.twist.twist = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
    ekf::add(spec, state, 0, message);
    ekf::advance(spec, state, message.header.stamp);
    const ekf::Estimate estimate = ekf::estimate(spec, state, message.header.stamp);
    SL_CHECK(estimate.known);
  };
  // Both begin with the first measurement.
  measure(0);
  BareFilter bare;
  ekf::Vector x = state.core.x;
  ekf::Matrix P = state.core.P;
  for (std::size_t i = 0; i < ekf::states; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    bare.x[row] = x[i];
    bare.noise_per_s[row] = spec.process_noise[i];
    for (std::size_t j = 0; j < ekf::states; ++j) bare.P(row, static_cast<Eigen::Index>(j)) = P.at(i, j);
  }
  std::uint64_t ours_k = 1, bare_k = 1;
  const auto reference = [&] {
    for (int n = 0; n < steps; ++n) {
      const auto v = velocities(bare_k++);
      bare.predict(dt.s());
      bare.correct(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(v.data()), N);
    }
  };
  const Timing whole = compare(
      15,
      [&] {
        for (int n = 0; n < steps; ++n) measure(ours_k++);
      },
      reference);
  for (std::size_t i = 0; i < ekf::states; ++i) {
    const double difference = state.core.x[i] - bare.x[static_cast<Eigen::Index>(i)];
    SL_CHECK_MSG(std::abs(ekf::is_angle(i) ? math::wrap_angle(difference) : difference) < 1e-6,
                 "the two filters must say the same");
  }

  ekf::Innovation innovation;
  innovation.count = 6;
  for (std::size_t i = 0; i < 6; ++i) {
    innovation.index[i] = ekf::Vx + i;
    innovation.noise[7 * i] = 1e-3 + 1e-4 * static_cast<double>(i);
  }
  std::uint64_t k = 1;
  const Timing core = compare(
      15,
      [&] {
        for (int n = 0; n < steps; ++n) {
          ekf::predict(x, P, spec.process_noise, dt.s());
          const auto v = velocities(k++);
          for (std::size_t i = 0; i < 6; ++i) innovation.y[i] = v[i] - x[ekf::Vx + i];
          ekf::correct(x, P, innovation, 0);
        }
      },
      reference);
  const double per_step = 1e6 / steps;
  return {row("EKF: predict and correct, against bare Eigen", "us", core.ours_s * per_step,
              core.reference_s * per_step, 2),
          row("EKF: message to estimate, against the same", "us", whole.ours_s * per_step,
              whole.reference_s * per_step, 2)};
}

std::vector<Row> stereo() {
#ifdef SANDLOT_HAS_OPENCV
  constexpr std::size_t pairs = 12;
  std::vector<OdometryPair> pictures;
  for (const Pose& X_WS : vo::test::arc(pairs, 0.1, 0.03))
    pictures.push_back(odometry_pair(X_WS, pictures.size()));
  // To and fro along the arc: no step is longer than the others.
  const auto picture = [&](std::size_t k) -> OdometryPair& {
    const std::size_t at = k % (2 * (pairs - 1));
    return pictures[at < pairs ? at : 2 * (pairs - 1) - at];
  };
  constexpr std::size_t steps = 2 * (pairs - 1);
  const vo::StereoSpec spec;
  vo::StereoState state;
  vo::advance(spec, state, picture(0).left.view(), picture(0).right.view());
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);  // the time of this thread is what counts
  std::size_t moved = 0, opencv_moved = 0;
  const Timing time = compare(
      7,
      [&] {
        for (std::size_t k = 1; k <= steps; ++k)
          moved += vo::advance(spec, state, picture(k).left.view(), picture(k).right.view()).outcome ==
                   vo::Outcome::moved;
      },
      [&] {
        for (std::size_t k = 1; k <= steps; ++k)
          opencv_moved += opencv_motion(picture(k - 1), picture(k)).has_value();
      });
  cv::setNumThreads(threads);
  SL_CHECK_MSG(moved == 8 * steps && opencv_moved == 8 * steps, "both must see how the camera moves");
  const double per_pair = 1e3 / static_cast<double>(steps);
  return {row("stereo odometry 640 x 480, against OpenCV", "ms", time.ours_s * per_pair,
              time.reference_s * per_pair, 1.5)};
#else
  return {};
#endif
}

/// A* as one writes it: std::priority_queue, one array each for the cost and the parent of cells, octile distance. Costs as in
/// navigation/planning/grid_planner.h. @return the cost of the way [m]
double plain_astar(const nav::CostMap& map, nav::Cell start, nav::Cell goal, double cost_weight,
                   std::vector<nav::Cell>& path) {
  const nav::GridGeometry& g = map.geometry;
  std::vector<double> best(g.cells(), std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> parent(g.cells());
  std::vector<bool> closed(g.cells());
  using Item = std::pair<double, std::uint32_t>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> open;
  const auto free = [&](int x, int y) {
    return g.contains({x, y}) && map.cost[g.index({x, y})] < nav::inscribed_cost;
  };
  const auto price = [&](std::size_t i) { return 1 + cost_weight * map.cost[i] / 252; };
  const auto heuristic = [&](int x, int y) {
    const int dx = std::abs(x - goal.x), dy = std::abs(y - goal.y);
    return g.resolution_m * (std::max(dx, dy) + (std::numbers::sqrt2 - 1) * std::min(dx, dy));
  };
  const auto from = static_cast<std::uint32_t>(g.index(start)),
             to = static_cast<std::uint32_t>(g.index(goal));
  best[from] = 0;
  parent[from] = from;
  open.push({heuristic(start.x, start.y), from});
  while (!open.empty()) {
    const std::uint32_t at = open.top().second;
    open.pop();
    if (closed[at]) continue;
    closed[at] = true;
    if (at == to) break;
    const int x = static_cast<int>(at) % g.width, y = static_cast<int>(at) / g.width;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if ((dx == 0 && dy == 0) || !free(x + dx, y + dy) || !free(x + dx, y) || !free(x, y + dy)) continue;
        const auto next = static_cast<std::uint32_t>(g.index({x + dx, y + dy}));
        const double length = g.resolution_m * (dx != 0 && dy != 0 ? std::numbers::sqrt2 : 1.0),
                     cost = best[at] + length * (price(at) + price(next)) / 2;
        if (cost >= best[next]) continue;
        best[next] = cost;
        parent[next] = at;
        open.push({cost + heuristic(x + dx, y + dy), next});
      }
  }
  path.clear();
  for (std::uint32_t at = to; std::isfinite(best[to]); at = parent[at]) {
    path.push_back({static_cast<int>(at) % g.width, static_cast<int>(at) / g.width});
    if (at == from) break;
  }
  return best[to];
}

/// Hall of 50 m x 50 m with boxes, in cells of 5 cm, and walls with a door each that make ways longer.
nav::CostMap hall() {
  nav::GridMap map{{1000, 1000, 0.05, {}}, std::vector<std::int8_t>(1'000'000, 0)};
  const auto fill = [&](int x0, int y0, int x1, int y1, std::int8_t value) {
    for (int y = std::max(y0, 0); y < std::min(y1, 1000); ++y)
      for (int x = std::max(x0, 0); x < std::min(x1, 1000); ++x)
        map.occupancy[map.geometry.index({x, y})] = value;
  };
  Stream random(5, entity_key("hall"), Purpose::experiment, 0);
  const auto below = [&](std::uint32_t n) { return static_cast<int>(random.below(n)); };
  for (int i = 0; i < 250; ++i) {
    const int x = below(1000), y = below(1000);
    fill(x, y, x + 6 + below(30), y + 6 + below(30), 100);
  }
  for (int wall = 0; wall < 3; ++wall) {
    const int x = 250 + 250 * wall, door = wall % 2 == 0 ? 800 : 200;
    fill(x, 0, x + 3, 1000, 100);
    fill(x - 40, door - 30, x + 43, door + 30, 0);
  }
  fill(0, 0, 60, 60, 0);
  fill(940, 940, 1000, 1000, 0);
  auto costs = nav::make_cost_map(map, {}, 0.25);
  SL_CHECK(costs);
  return std::move(*costs);
}

std::vector<Row> planners() {
  const nav::CostMap map = hall();
  const nav::GridFrame frame(map.geometry);
  const nav::Cell start{30, 30}, goal{970, 970};
  const Vec2 from = frame.centre(start), to = frame.centre(goal);
  constexpr double weight = 2;
  double plain_m = 0;
  std::vector<nav::Cell> path;
  const auto reference = [&] { plain_m = plain_astar(map, start, goal, weight, path); };
  std::vector<Row> rows;
  double astar_m = 0;
  for (const nav::GridMethod method : {nav::GridMethod::astar, nav::GridMethod::theta}) {
    double cost_m = 0;
    const Timing time = compare(
        7,
        [&] {
          const auto plan = nav::plan_grid(map, {method, weight}, from, to);
          SL_CHECK_MSG(plan, "there is a way through the hall");
          cost_m = plan->cost_m;
        },
        reference);
    const bool theta = method == nav::GridMethod::theta;
    if (!theta) astar_m = cost_m;
    SL_CHECK_MSG(theta ? cost_m <= astar_m : std::abs(cost_m - plain_m) < 1e-6 * plain_m,
                 "A* must find the plain one's cost, Theta* no more");
    rows.push_back(row(theta ? "Theta* on 1000 x 1000 cells, against a plain A*"
                             : "A* on 1000 x 1000 cells, against a plain A*",
                       "ms", time.ours_s * 1e3, time.reference_s * 1e3, theta ? 5 : 1));
  }
  const auto footprint = nav::Footprint::rectangle(0.35, 0.35, 0.25, 0.25);
  SL_CHECK(footprint);
  const Timing time = compare(
      7,
      [&] {
        const auto plan = nav::plan_hybrid(map, *footprint, {}, {from.x, from.y, 0}, {to.x, to.y, 0});
        SL_CHECK_MSG(plan, plan.error().text().c_str());
      },
      reference);
  rows.push_back(row("hybrid A* on 1000 x 1000 cells, against a plain A*", "ms", time.ours_s * 1e3,
                     time.reference_s * 1e3, 5));
  return rows;
}

}  // namespace

std::vector<Row> navigation() {
  std::vector<Row> rows = filter();
  for (Row& each : stereo()) rows.push_back(std::move(each));
  for (Row& each : planners()) rows.push_back(std::move(each));
  for (Row& each : rows) each.name.insert(0, "navigation: ");
  return rows;
}

}  // namespace sandlot::bench
