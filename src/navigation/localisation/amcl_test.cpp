#include "navigation/localisation/amcl.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "base/bytes.h"
#include "navigation/localisation/test_rooms.h"

namespace sandlot::navigation::amcl {
namespace {

using namespace test;

constexpr float amcl_nan = std::numeric_limits<float>::quiet_NaN(),
                amcl_inf = std::numeric_limits<float>::infinity();

/// Robot that wanders in a room, with its laser and a filter.
struct AmclRun {
  explicit AmclRun(std::uint64_t seed, const Spec& spec = {}, double short_share = 0)
      : world(seed, entity_key("amcl test"), Purpose::experiment, 0),
        model(*Model::make(spec, room.map())),
        state(begin(seed)),
        work(model),
        robot{room, placed(room, world), {3, -2, 1}},
        obstructed(short_share) {}

  Outcome scan() {
    time = time + Time::from_s(0.1);
    return update(model, state, work, {time, robot.X_OB, laser.X_BL},
                  scan_at(room, laser, robot.X_MB, time, world, obstructed));
  }
  /// Drives until a number of scans was used.
  void drive(std::uint64_t updates) {
    for (const std::uint64_t end = state.count(Outcome::updated) + updates;
         state.count(Outcome::updated) < end;) {
      robot.go(world);
      scan();
    }
  }
  Pose2 estimate() const { return pose_at(state, robot.X_OB); }
  double error_m() const { return distance(estimate(), robot.X_MB); }
  double error_rad() const { return turn(estimate(), robot.X_MB); }
  bool found() const { return error_m() < 0.25 && error_rad() < 0.1; }

  Room room = furnished_room();
  Laser laser;
  Stream world;
  Model model;
  State state;
  Workspace work;
  Wanderer robot;
  Time time{0};
  double obstructed;
};

Spec amcl_small() {
  Spec spec;
  spec.min_particles = 100;
  spec.max_particles = 300;
  spec.max_beams = 30;
  return spec;
}

std::string amcl_refusal(const Result<Model>& model) { return model ? "" : model.error().text(); }

TEST(Amcl, LikelihoodOfABeamByHand) {
  Spec spec;
  spec.z_hit = 0.8, spec.z_rand = 0.2, spec.sigma_hit_m = 0.1, spec.laser_max_range_m = 10;
  spec.likelihood_max_distance_m = 0.5;
  GridMap map{{20, 20, 0.1, {-1, -1, 0}}, std::vector<std::int8_t>(400)};
  map.occupancy[map.geometry.index({10, 10})] = 100;  // centre (0.05, 0.05)
  const Model model = *Model::make(spec, map);
  const double anywhere = 0.2 / 10;
  const auto p = [&](Vec2 end) { return math::exp(model.log_likelihood(end)); };
  EXPECT_NEAR(p({0.02, 0.09}), 0.8 + anywhere, 1e-6);                      // in the cell
  EXPECT_NEAR(p({0.25, 0.05}), 0.8 * math::exp(-2.0) + anywhere, 1e-6);    // two cells: 2 sigma
  EXPECT_NEAR(p({-0.05, -0.05}), 0.8 * math::exp(-1.0) + anywhere, 1e-6);  // a diagonal: sqrt(2) sigma
  EXPECT_NEAR(p({0.95, 0.95}), 0.8 * math::exp(-12.5) + anywhere, 1e-6);   // beyond 0.5 m: as at 5 sigma
  EXPECT_NEAR(p({5, 0}), 0.8 * math::exp(-12.5) + anywhere, 1e-6);         // off the map
  // A robot at (0.05, -0.45) turned left: its point ahead lies in the cell, the one to its right off the map.
  const Vec2 points[] = {{0.5, 0}, {0, -1}};
  const double both = (math::log(0.8 + anywhere) + math::log(0.8 * math::exp(-12.5) + anywhere)) / 2;
  EXPECT_NEAR(model.mean_log_likelihood(points, {0.05, -0.45, math::pi / 2}), both, 1e-6);
  // The same in a map that is turned, about its corner.
  map.geometry.origin = {3, 4, 0.7};
  const Model turned = *Model::make(spec, map);
  EXPECT_NEAR(turned.mean_log_likelihood(points, compose({3, 4, 0.7}, {1.05, 0.55, math::pi / 2})), both,
              1e-6);
}

// Two particles, one scan of one beam: weights are the ratio of p to the power of one beam.
TEST(Amcl, WeightsAreLikelihoods) {
  Spec spec;
  spec.z_hit = 0.9, spec.z_rand = 0.1, spec.sigma_hit_m = 0.2, spec.laser_max_range_m = 10;
  spec.min_particles = 2, spec.max_particles = 2, spec.resample_interval = 1000;
  GridMap map{{40, 10, 0.1, {0, 0, 0}}, std::vector<std::int8_t>(400)};
  map.occupancy[map.geometry.index({35, 5})] = 100;  // centre (3.55, 0.55)
  const Model model = *Model::make(spec, map);
  State state = begin(1);
  Workspace work(model);
  ASSERT_TRUE(set_pose(model, state, {1, 0.55, 0}, {}));
  state.particles[0].pose.x = 0.55;  // its beam of 3 m ends in the cell, the other one's 0.2 m before
  state.particles[1].pose.x = 0.35;
  msg::LaserScan scan;
  scan.range_max = 10;
  scan.ranges = {3.0f};
  ASSERT_EQ(update(model, state, work, {}, scan), Outcome::updated);
  const double near = 0.9 + 0.01, far = 0.9 * math::exp(-0.5) + 0.01;
  EXPECT_NEAR(state.particles[0].weight, near / (near + far), 1e-6);
  EXPECT_NEAR(state.fast, (near + far) / 2, 1e-6);
  // One cluster; its mean and variance by hand.
  const double w0 = near / (near + far), mean = 0.35 + 0.2 * w0;
  EXPECT_EQ(state.estimate.clusters, 1u);
  EXPECT_NEAR(state.estimate.pose.x, mean, 1e-6);
  EXPECT_NEAR(state.estimate.covariance[0], 0.04 * w0 * (1 - w0), 1e-6);
  EXPECT_NEAR(state.estimate.fit, w0 * near + (1 - w0) * far, 1e-6);
  // Twenty such beams count for ten.
  ASSERT_TRUE(set_pose(model, state, {1, 0.55, 0}, {}));
  state.particles[0].pose.x = 0.55, state.particles[1].pose.x = 0.35;
  scan.ranges.assign(20, 3.0f);
  ASSERT_EQ(update(model, state, work, {}, scan), Outcome::updated);
  EXPECT_NEAR(state.particles[1].weight / state.particles[0].weight, math::pow(far / near, 10), 1e-6);
}

TEST(Amcl, HeadingsAreAveragedAcrossPi) {
  Spec spec;
  spec.min_particles = 2, spec.max_particles = 2;
  GridMap map{{40, 10, 0.1, {0, 0, 0}}, std::vector<std::int8_t>(400)};
  map.occupancy[map.geometry.index({39, 5})] = 100;
  const Model model = *Model::make(spec, map);
  State state = begin(1);
  Workspace work(model);
  ASSERT_TRUE(set_pose(model, state, {1.5, 0.5, math::pi}, {}));
  state.particles[0].pose.theta = math::pi - 0.01;
  state.particles[1].pose.theta = -math::pi + 0.03;
  msg::LaserScan scan;
  scan.range_max = 10;
  scan.ranges = {1.0f};  // ends more than 2 m from the obstacle, for both
  ASSERT_EQ(update(model, state, work, {}, scan), Outcome::updated);
  EXPECT_NEAR(state.estimate.pose.theta, -math::pi + 0.01, 1e-9);
  EXPECT_NEAR(state.estimate.covariance[8], 0.02 * 0.02, 1e-9);
}

TEST(Amcl, RecoveryFollowsTheTwoMeans) {
  AmclRun run(3, amcl_small());
  ASSERT_TRUE(set_pose(run.model, run.state, run.robot.X_MB, {}));
  run.drive(1);
  EXPECT_EQ(run.state.slow, run.state.fast);
  run.drive(4);
  const State before = run.state;
  run.drive(1);
  // Both moved towards the same mean, by 5 % and by 30 %.
  const double w = before.fast + (run.state.fast - before.fast) / 0.3;
  EXPECT_NEAR(run.state.slow, before.slow + 0.05 * (w - before.slow), 1e-12);
  // A scan that fits nowhere: the share of random particles is 1 - fast / slow.
  const State ready = run.state;
  run.state.slow = run.state.fast = 0.8;
  run.robot.X_OB = compose(run.robot.X_OB, {1, 0, 0});
  msg::LaserScan scan = scan_at(run.room, run.laser, run.robot.X_MB, run.time + Time::from_s(1), run.world);
  for (float& r : scan.ranges) r = 0.5f;
  const Moment moment{scan.header.stamp, run.robot.X_OB, run.laser.X_BL};
  ASSERT_EQ(update(run.model, run.state, run.work, moment, scan), Outcome::updated);
  const double share = 1 - run.state.fast / run.state.slow;
  EXPECT_GT(share, 0.05);
  EXPECT_EQ(static_cast<double>(run.state.injected - ready.injected),
            std::floor(share * static_cast<double>(run.state.particles.size()) + 0.5));
}

TEST(Amcl, InitialPoseHasItsCovariance) {
  const AmclRun run(1);
  State state = begin(4);
  // Standard deviations 0.3, 0.2, 0.1; x and y correlated by 0.5, y and theta by -0.4.
  const Covariance3 P{0.09, 0.03, 0, 0.03, 0.04, -0.008, 0, -0.008, 0.01};
  ASSERT_TRUE(set_pose(run.model, state, {5, 2, 3.1}, P));
  ASSERT_EQ(state.particles.size(), 2000u);
  Covariance3 sum{};
  for (const Particle& each : state.particles) {
    const double off[3] = {each.pose.x - 5, each.pose.y - 2, math::wrap_angle(each.pose.theta - 3.1)};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 3; ++c) sum[3 * r + c] += off[r] * off[c] / 2000;
  }
  // Of 2000 draws: a relative standard deviation of sqrt(2 / 2000) = 3.2 %, five of them.
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(sum[3 * r + c], P[3 * r + c], 0.16 * std::sqrt(P[4 * r] * P[4 * c])) << r << c;
  EXPECT_EQ(state.estimate.pose.x, 5);
  EXPECT_EQ(state.estimate.covariance, P);
  // Before the first scan the pose is the one given, whatever the odometry says.
  EXPECT_EQ(pose_at(state, {100, 100, 1}).y, 2);

  const State before = state;
  const auto refused = [&](const Pose2& pose, const Covariance3& covariance) {
    const Status status = set_pose(run.model, state, pose, covariance);
    return status ? "" : status.error().text();
  };
  EXPECT_NE(refused({50, 2, 0}, P).find("off the map"), std::string::npos);
  EXPECT_NE(refused({5, std::nan(""), 0}, P).find("not finite"), std::string::npos);
  EXPECT_NE(refused({5, 2, 0}, {-1, 0, 0, 0, 1, 0, 0, 0, 1}).find("covariance"), std::string::npos);
  EXPECT_NE(refused({5, 2, 0}, {1, 2, 0, 2, 1, 0, 0, 0, 1}).find("covariance"), std::string::npos);
  EXPECT_NE(refused({5, 2, 0}, {1, 0.5, 0, 0, 1, 0, 0, 0, 1}).find("covariance"), std::string::npos);
  EXPECT_NE(refused({5, 2, 0}, {0, 0.5, 0, 0.5, 1, 0, 0, 0, 1}).find("covariance"), std::string::npos);
  EXPECT_NE(refused({5, 2, 0}, {1, 0, 0, 0, amcl_inf, 0, 0, 0, 1}).find("covariance"), std::string::npos);
  EXPECT_EQ(state.events, before.events);
  EXPECT_EQ(refused({5, 2, 0}, {1, 1, 0, 1, 1, 0, 0, 0, 0}), "") << "a singular one is fine";
  for (const Particle& each : state.particles) ASSERT_NEAR(each.pose.x - 5, each.pose.y - 2, 1e-6);
}

TEST(Amcl, SpreadIsUniformOverFreeCells) {
  GridMap map{{4, 2, 1, {0, 0, 0}}, {0, 100, -1, 0, 50, 0, 25, 26}};  // free: (0,0), (3,0), (1,1), (2,1)
  const Model model = *Model::make({}, map);
  State state = begin(9);
  spread(model, state);
  int counts[8] = {}, quadrants[4] = {};
  for (const Particle& each : state.particles) {
    ++counts[static_cast<int>(each.pose.x) + 4 * static_cast<int>(each.pose.y)];
    ++quadrants[static_cast<int>((each.pose.theta + math::pi) / (math::pi / 2))];
  }
  // Binomial, n = 2000, p = 1/4: standard deviation 19.4.
  for (const int cell : {0, 3, 5, 6}) EXPECT_NEAR(counts[cell], 500, 97);
  for (const int cell : {1, 2, 4, 7}) EXPECT_EQ(counts[cell], 0);
  for (const int each : quadrants) EXPECT_NEAR(each, 500, 97);
  EXPECT_FALSE(state.estimate.known);
}

TEST(Amcl, TracksFromAnInitialPose) {
  AmclRun run(5, {}, 0.1);
  ASSERT_TRUE(set_pose(run.model, run.state, compose(run.robot.X_MB, {0.1, -0.1, 0.1}),
                       {0.04, 0, 0, 0, 0.04, 0, 0, 0, 0.03}));
  run.drive(3);
  double worst = 0, worst_rad = 0;
  for (int k = 0; k < 25; ++k) {
    run.drive(1);
    worst = std::max(worst, run.error_m());
    worst_rad = std::max(worst_rad, run.error_rad());
  }
  EXPECT_LT(worst, 0.1);
  EXPECT_LT(worst_rad, 3 * math::pi / 180);
  EXPECT_EQ(run.state.estimate.clusters, 1u);
  EXPECT_EQ(run.state.particles.size(), 500u) << "KLD-sampling has come down to the least number";
  EXPECT_GT(run.state.count(Outcome::waiting), 0u);
  // The transform to odom says the same.
  const Pose2 X = compose(map_to_odom(run.state), run.robot.X_OB);
  EXPECT_NEAR(distance(X, run.estimate()), 0, 1e-9);
}

TEST(Amcl, FindsItselfFromAnywhere) {
  AmclRun run(11);
  EXPECT_EQ(run.scan(), Outcome::uninitialised);
  spread(run.model, run.state);
  for (int k = 0; k < 40 && !run.found(); ++k) run.drive(1);
  EXPECT_TRUE(run.found()) << run.error_m() << " m, " << run.error_rad() << " rad";
}

TEST(Amcl, WaitsForMotionButNotForTheFirstScan) {
  AmclRun run(7, amcl_small());
  ASSERT_TRUE(set_pose(run.model, run.state, run.robot.X_MB, {}));
  EXPECT_EQ(run.scan(), Outcome::updated);
  EXPECT_EQ(run.scan(), Outcome::waiting);
  const Pose2 start = run.robot.X_OB;
  run.robot.X_OB = compose(start, {0.249, 0, 0});
  EXPECT_EQ(run.scan(), Outcome::waiting);
  run.robot.X_OB = compose(start, {0.15, -0.21, 0.1});  // 0.258 m
  EXPECT_EQ(run.scan(), Outcome::updated);
  run.robot.X_OB.theta += 0.19;
  EXPECT_EQ(run.scan(), Outcome::waiting);
  run.robot.X_OB.theta += 0.02;
  EXPECT_EQ(run.scan(), Outcome::updated);
}

TEST(Amcl, BadInputIsAnsweredAndChangesNothing) {
  AmclRun run(8, amcl_small());
  ASSERT_TRUE(set_pose(run.model, run.state, run.robot.X_MB, {0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01}));
  run.drive(3);
  const Time later = run.time + Time::from_s(1);
  const msg::LaserScan good = scan_at(run.room, run.laser, run.robot.X_MB, later, run.world);
  const Moment moment{later, compose(run.robot.X_OB, {0.3, 0, 0}), run.laser.X_BL};
  const auto answer = [&](auto&& change) {
    State state = run.state;
    msg::LaserScan scan = good;
    Moment at = moment;
    change(scan, at);
    const Outcome outcome = update(run.model, state, run.work, at, scan);
    EXPECT_EQ(state.count(outcome), run.state.count(outcome) + 1);
    EXPECT_EQ(state.last, outcome);
    if (outcome != Outcome::updated) {
      EXPECT_EQ(state.events, run.state.events);
      EXPECT_EQ(state.particles[0].pose.x, run.state.particles[0].pose.x);
    }
    for (const Particle& each : state.particles)
      EXPECT_TRUE(is_finite(each.pose) && each.weight >= 0 && each.weight <= 1);
    return outcome;
  };
  EXPECT_EQ(answer([](auto&, auto&) {}), Outcome::updated);
  EXPECT_EQ(answer([](auto& s, auto&) { s.ranges.clear(); }), Outcome::no_beams);
  for (const float bad : {amcl_nan, amcl_inf, -amcl_inf, -1.0f, 0.0f, 1e30f, 0.01f})
    EXPECT_EQ(answer([&](auto& s, auto&) { s.ranges.assign(s.ranges.size(), bad); }), Outcome::no_beams)
        << bad;
  EXPECT_EQ(answer([](auto& s, auto&) { s.ranges[3] = amcl_nan, s.ranges[5] = -amcl_inf; }),
            Outcome::updated);
  EXPECT_EQ(answer([](auto& s, auto&) { s.ranges.assign(1'000'000, 2.0f); }), Outcome::updated);
  EXPECT_EQ(answer([](auto& s, auto&) { s.angle_min = amcl_nan; }), Outcome::bad_scan);
  EXPECT_EQ(answer([](auto& s, auto&) { s.angle_increment = amcl_inf; }), Outcome::bad_scan);
  EXPECT_EQ(answer([](auto& s, auto&) { s.range_max = amcl_nan; }), Outcome::bad_scan);
  EXPECT_EQ(answer([](auto&, auto& m) { m.X_BL.p.x = std::nan(""); }), Outcome::bad_mount);
  EXPECT_EQ(answer([](auto&, auto& m) { m.X_BL.q = {0, 0, 0, 0}; }), Outcome::bad_mount);
  EXPECT_EQ(answer([](auto&, auto& m) { m.X_OB.theta = std::nan(""); }), Outcome::bad_odometry);
  EXPECT_EQ(answer([](auto&, auto& m) { m.X_OB.x = 1e9; }), Outcome::bad_odometry);
  EXPECT_EQ(answer([](auto&, auto& m) { m.odometry_stamp = m.odometry_stamp + Time::from_s(0.2); }),
            Outcome::unsynchronised);
  EXPECT_EQ(answer([](auto& s, auto&) { s.header.stamp = Time{-1}; }), Outcome::bad_stamp);
  EXPECT_EQ(answer([](auto& s, auto&) { s.header.stamp = Time{std::numeric_limits<std::int64_t>::max()}; }),
            Outcome::bad_stamp);
  EXPECT_EQ(answer([&](auto& s, auto& m) { s.header.stamp = m.odometry_stamp = run.state.at; }),
            Outcome::late);
  // A laser that would be far outside the map is believed as little as any scan that fits nowhere.
  EXPECT_EQ(answer([](auto&, auto& m) { m.X_BL.p.x = 900; }), Outcome::updated);

  // The odometry starts again elsewhere: what was driven before counts, and what is driven from there on.
  State state = run.state;
  Moment jumped = moment;
  const Pose2 last = compose(run.state.X_OB, {0.1, 0.05, 0.1});
  jumped.X_OB = last;
  ASSERT_EQ(update(run.model, state, run.work, jumped, good), Outcome::waiting);
  jumped.X_OB = {-40, 2, 0};
  EXPECT_EQ(update(run.model, state, run.work, jumped, good), Outcome::jumped);
  const Pose2 right = compose(state.estimate.pose, {0.1, 0.05, 0.1});
  EXPECT_NEAR(distance(pose_at(state, {-40, 2, 0}), right), 0, 1e-9);
  EXPECT_NEAR(distance(pose_at(state, {-39, 2, 0}), compose(right, {1, 0, 0})), 0, 1e-9);
  // The clock starts again.
  msg::LaserScan rewound = good;
  rewound.header.stamp = jumped.odometry_stamp = Time{5};
  state.at = Time::from_s(100);
  EXPECT_EQ(update(run.model, state, run.work, jumped, rewound), Outcome::rewound);
  rewound.header.stamp = jumped.odometry_stamp = Time{6};
  EXPECT_EQ(update(run.model, state, run.work, jumped, rewound), Outcome::waiting);
}

// Odometry that jumps to the limit of what is taken, while some way since the last scan used is still to be counted: a saved state is read
// again.
TEST(Amcl, OdometryAtItsLimitLeavesAStateThatFits) {
  AmclRun run(4, amcl_small());
  ASSERT_TRUE(set_pose(run.model, run.state, run.robot.X_MB, {}));
  run.drive(3);
  do run.robot.go(run.world);
  while (run.scan() != Outcome::waiting || distance(run.state.X_OB, run.state.latest_X_OB) < 0.02);
  const Time time = run.time + Time::from_s(0.1);
  const auto scan = scan_at(run.room, run.laser, run.robot.X_MB, time, run.world, 0);
  for (const double x : {-1e6, 1e6})
    for (const double y : {-1e6, 1e6}) {
      State state = run.state;
      EXPECT_EQ(update(run.model, state, run.work, {time, {x, y, 0}, run.laser.X_BL}, scan), Outcome::jumped);
      EXPECT_TRUE(state.fits(run.model)) << x << " " << y;
    }
}

TEST(Amcl, MapsAndSpecsThatCannotWorkAreRefused) {
  const GridMap good{{3, 3, 0.1, {}}, {0, 0, 0, 0, 100, 0, 0, 0, 0}};
  const auto with_map = [&](auto&& change) {
    GridMap map = good;
    change(map);
    return amcl_refusal(Model::make({}, map));
  };
  EXPECT_EQ(with_map([](GridMap&) {}), "");
  EXPECT_NE(with_map([](GridMap& m) { m.occupancy.assign(9, -1); }).find("no occupied cell"),
            std::string::npos);
  EXPECT_NE(with_map([](GridMap& m) { m.occupancy.assign(9, 0); }).find("no occupied cell"),
            std::string::npos);
  EXPECT_NE(with_map([](GridMap& m) { m.occupancy.assign(9, 100); }).find("no free cell"), std::string::npos);
  EXPECT_NE(with_map([](GridMap& m) { m.occupancy.pop_back(); }).find("8 cells"), std::string::npos);
  EXPECT_NE(with_map([](GridMap& m) { m.geometry.width = 0; }).find("at least one"), std::string::npos);
  EXPECT_NE(with_map([](GridMap& m) { m.geometry.width = 1'000'000'000; }).find("too large"),
            std::string::npos);
  EXPECT_NE(with_map([](GridMap& m) { m.geometry.resolution_m = std::nan(""); }).find("resolution"),
            std::string::npos);
  const auto with_spec = [&](auto&& change) {
    Spec spec;
    change(spec);
    return amcl_refusal(Model::make(spec, good));
  };
  const auto names = [&](const char* key, auto&& change) {
    EXPECT_NE(with_spec(change).find(key), std::string::npos) << key << ": " << with_spec(change);
  };
  names("min_particles", [](Spec& s) { s.min_particles = -1; });
  names("min_particles", [](Spec& s) { s.min_particles = 3000; });
  names("max_particles", [](Spec& s) { s.max_particles = 1'000'000'000; });
  names("alpha1", [](Spec& s) { s.noise.alpha1 = -0.1; });
  names("alpha5", [](Spec& s) { s.noise.alpha5 = std::nan(""); });
  names("pf_err", [](Spec& s) { s.kld_error = 0; });
  names("max_beams", [](Spec& s) { s.max_beams = 0; });
  names("z_rand", [](Spec& s) { s.z_rand = 0; });
  names("sigma_hit", [](Spec& s) { s.sigma_hit_m = -0.2; });
  names("laser_max_range", [](Spec& s) { s.laser_max_range_m = INFINITY; });
  names("laser_min_range", [](Spec& s) { s.laser_min_range_m = 200; });
  names("update_min_d", [](Spec& s) { s.update_min_d_m = -1; });
  names("resample_interval", [](Spec& s) { s.resample_interval = 0; });
  names("recovery_alpha_slow", [](Spec& s) { s.alpha_slow = 0.5; });
  names("free", [](Spec& s) { s.free_percent = 70; });
}

TEST(Amcl, GoesOnFromACopyToTheBit) {
  AmclRun run(13, amcl_small());
  spread(run.model, run.state);
  run.drive(4);
  ByteWriter bytes;
  write(bytes, run.state);
  State copy;
  ByteReader reader(bytes.bytes());
  read(reader, copy);
  ASSERT_TRUE(reader.ok());
  ASSERT_TRUE(copy.fits(run.model));
  Workspace other(run.model);
  for (int k = 0; k < 30; ++k) {
    run.robot.go(run.world);
    const Time at = run.time + Time::from_s(0.1 * (k + 1));
    const msg::LaserScan scan = scan_at(run.room, run.laser, run.robot.X_MB, at, run.world);
    const Moment moment{at, run.robot.X_OB, run.laser.X_BL};
    ASSERT_EQ(update(run.model, run.state, run.work, moment, scan),
              update(run.model, copy, other, moment, scan));
  }
  ByteWriter first, second;
  write(first, run.state);
  write(second, copy);
  EXPECT_TRUE(
      std::equal(first.bytes().begin(), first.bytes().end(), second.bytes().begin(), second.bytes().end()));
  // Another seed draws other particles.
  State other_seed = begin(14);
  spread(run.model, other_seed);
  EXPECT_NE(other_seed.particles[0].pose.x, copy.particles[0].pose.x);
  // Damaged ones.
  copy.particles[0].weight = 0.5;
  EXPECT_FALSE(copy.fits(run.model));
  copy = run.state;
  copy.particles[0].pose.x = std::nan("");
  EXPECT_FALSE(copy.fits(run.model));
  copy = run.state;
  copy.particles.resize(301);
  EXPECT_FALSE(copy.fits(run.model));
}

TEST(SlowAmcl, FindsItselfFromAnywhereIn19Of20) {
  int found = 0;
  for (std::uint64_t seed = 100; seed < 120; ++seed) {
    AmclRun run(seed, {}, 0.05);
    spread(run.model, run.state);
    run.drive(40);
    found += run.found();
    if (!run.found()) std::printf("seed %d: %.2f m %.2f rad\n", int(seed), run.error_m(), run.error_rad());
  }
  EXPECT_GE(found, 19);
}

TEST(SlowAmcl, FindsAKidnappedRobotIn19Of20) {
  int found = 0;
  for (std::uint64_t seed = 200; seed < 220; ++seed) {
    AmclRun run(seed, {}, 0.05);
    ASSERT_TRUE(set_pose(run.model, run.state, run.robot.X_MB, {0.04, 0, 0, 0, 0.04, 0, 0, 0, 0.03}));
    run.drive(20);
    EXPECT_TRUE(run.found());
    // Carried at least 3 m away, while its odometry stands still.
    Pose2 there;
    do there = placed(run.room, run.world);
    while (distance(there, run.robot.X_MB) < 3);
    run.robot.X_MB = there;
    run.drive(60);
    found += run.found();
    if (!run.found()) std::printf("seed %d: %.2f m %.2f rad\n", int(seed), run.error_m(), run.error_rad());
  }
  EXPECT_GE(found, 19);
}

TEST(SlowAmcl, TracksWithin10CentimetresAnd3Degrees) {
  Spec spec;
  spec.noise = {0.05, 0.05, 0.05, 0.05, 0.05};  // errors of 22 %: several times those of the odometry
  for (std::uint64_t seed = 300; seed < 310; ++seed) {
    AmclRun run(seed, spec, 0.1);
    ASSERT_TRUE(set_pose(run.model, run.state, run.robot.X_MB, {0.04, 0, 0, 0, 0.04, 0, 0, 0, 0.03}));
    run.drive(5);
    double worst = 0, worst_rad = 0;
    for (int k = 0; k < 100; ++k) {
      run.drive(1);
      worst = std::max(worst, run.error_m());
      worst_rad = std::max(worst_rad, run.error_rad());
    }
    EXPECT_LT(worst, 0.1) << seed;
    EXPECT_LT(worst_rad, 3 * math::pi / 180) << seed;
  }
}

}  // namespace
}  // namespace sandlot::navigation::amcl
