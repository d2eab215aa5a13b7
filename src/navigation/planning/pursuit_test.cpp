#include "navigation/planning/pursuit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "navigation/planning/hybrid_astar.h"

namespace sandlot::navigation {
namespace {

struct PursuitRun {
  Pose2 pose;
  Following status = Following::driving;
  double seconds = 0, fastest_turn = 0, tightest = 0, farthest = 0;
  PlanarTwist last;
};

PursuitRun pursuit_drive(const PursuitSpec& spec, std::span<const PathPose> path, Pose2 pose,
                         double dt = 0.02, double limit_s = 200, const CostMap* map = nullptr) {
  PursuitState state;
  PursuitRun run{pose};
  for (; run.seconds < limit_s && run.status == Following::driving; run.seconds += dt) {
    const PursuitStep step = pursue(spec, state, path, run.pose, map, dt);
    run.status = step.status;
    if (step.status != Following::driving) break;
    run.last = step.command;
    run.fastest_turn = std::max(run.fastest_turn, std::abs(step.command.w_radps));
    if (std::abs(step.command.vx_mps) > 1e-6)
      run.tightest = std::max(run.tightest, std::abs(step.command.w_radps / step.command.vx_mps));
    run.farthest = std::max(run.farthest, step.deviation_m);
    run.pose = driven(run.pose, step.command, dt);
  }
  return run;
}

std::vector<PathPose> pursuit_line(double length) {
  const Vec2 points[] = {{0, 0}, {length, 0}};
  return path_through(points, 0.05);
}

TEST(Pursuit, OffsetFromALineDecaysAsTheLinearEquation) {
  // Lookahead fixed at 1 m: y(s) = y0 e^(-s/L) (cos s/L + sin s/L) for a heading of 0 at the start.
  const PursuitSpec spec{.speed_mps = 0.5,
                         .acceleration_mps2 = 1000,
                         .min_lookahead_m = 1,
                         .max_lookahead_m = 1,
                         .curve_radius_m = 0};
  const auto path = pursuit_line(30);
  PursuitState state;
  const double y0 = 0.01, dt = 0.002;
  Pose2 pose{0, y0, 0};
  for (int k = 1; k <= 5000; ++k) {
    const PursuitStep step = pursue(spec, state, path, pose, nullptr, dt);
    ASSERT_EQ(step.status, Following::driving);
    EXPECT_NEAR(step.command.vx_mps, 0.5, 1e-12);
    pose = driven(pose, step.command, dt);
    const double s = 0.5 * dt * k;
    const double expected = y0 * math::exp(-s) * (math::cos(s) + math::sin(s));
    // Linear terms leave out y0^2 = 1e-4 of y0; the hold over a step shifts s by half a millimetre.
    ASSERT_NEAR(pose.y, expected, 1.5e-5) << s;
  }
}

TEST(Pursuit, CircleIsDrivenAtItsOwnCurvature) {
  std::vector<PathPose> path;
  const double radius = 2;
  append_poses(path, {radius, 0, math::pi / 2}, {.curvature_pm = 1 / radius, .amount = 5 * radius}, 0.02, 1);
  const PursuitSpec spec{
      .speed_mps = 0.4, .min_lookahead_m = 0.6, .max_lookahead_m = 0.6, .curve_radius_m = 0.5};
  const PursuitRun run = pursuit_drive(spec, path, {radius, 0, math::pi / 2}, 0.02, 15);
  // A chord of the circle has the circle's curvature; sides of 2 cm leave it by 2.5e-5 m.
  EXPECT_NEAR(math::hypot(run.pose.x, run.pose.y), radius, 1e-3);
  EXPECT_NEAR(run.last.w_radps, run.last.vx_mps / radius, 1e-3);
  EXPECT_NEAR(run.last.vx_mps, 0.4, 1e-12);
  // The same circle counts as tight with a limit of 4 m: half the speed.
  PursuitSpec slow = spec;
  slow.curve_radius_m = 4;
  EXPECT_NEAR(pursuit_drive(slow, path, {radius, 0, math::pi / 2}, 0.02, 15).last.vx_mps, 0.2, 1e-3);
}

TEST(Pursuit, LookaheadGrowsWithSpeed) {
  const auto path = pursuit_line(30);
  for (const double speed : {0.1, 0.5, 2.0}) {
    const PursuitSpec spec{.speed_mps = speed,
                           .acceleration_mps2 = 1000,
                           .lookahead_time_s = 1.5,
                           .min_lookahead_m = 0.3,
                           .max_lookahead_m = 1};
    PursuitState state;
    pursue(spec, state, path, {1, 0, 0}, nullptr, 0.1);
    const PursuitStep step = pursue(spec, state, path, {1, 0, 0}, nullptr, 0.1);
    EXPECT_NEAR(step.target_M.x - 1, speed == 0.1 ? 0.3 : speed == 0.5 ? 0.75 : 1, 1e-9);
  }
}

TEST(Pursuit, SlowsNearObstaclesAndBeforeTheEnd) {
  GridMap map{{200, 80, 0.1, {-5, -4, 0}}, std::vector<std::int8_t>(200 * 80)};
  for (int x = 0; x < 200; ++x) map.occupancy[map.geometry.index({x, 43})] = 100;  // centres at y = 0.35 m
  const CostMap costs = *make_cost_map(map, {}, 0.1);
  const auto path = pursuit_line(10);
  const PursuitSpec spec{
      .speed_mps = 0.5, .acceleration_mps2 = 1000, .obstacle_distance_m = 0.6, .approach_distance_m = 1};
  PursuitState state;
  EXPECT_NEAR(pursue(spec, state, path, {2, 0.02, 0}, nullptr, 0.1).command.vx_mps, 0.5, 1e-12);
  // Cell of y in [0, 0.1), 0.3 m from the wall's.
  EXPECT_NEAR(pursue(spec, state, path, {2, 0.02, 0}, &costs, 0.1).command.vx_mps, 0.25, 1e-6);
  PursuitState late;
  EXPECT_NEAR(pursue(spec, late, pursuit_line(1.5), {1, 0, 0}, nullptr, 0.1).command.vx_mps, 0.25, 1e-9);
}

TEST(Pursuit, DifferentialTurnsFirstAndTakesTheGoalsHeading) {
  auto path = pursuit_line(3);
  path.back().pose.theta = -math::pi / 2;
  const PursuitSpec spec{.speed_mps = 0.5, .goal_tolerance_m = 0.03, .goal_tolerance_rad = 0.02};
  PursuitState state;
  const PursuitStep first = pursue(spec, state, path, {0, 0, math::pi}, nullptr, 0.02);
  EXPECT_EQ(first.command.vx_mps, 0);
  EXPECT_NE(first.command.w_radps, 0);
  const PursuitRun run = pursuit_drive(spec, path, {0, 0, 3});
  EXPECT_EQ(run.status, Following::arrived);
  EXPECT_NEAR(run.pose.x, 3, 0.03);
  EXPECT_NEAR(run.pose.y, 0, 0.03);
  EXPECT_NEAR(run.pose.theta, -math::pi / 2, 0.02);
  EXPECT_LE(run.fastest_turn, spec.max_turn_rate_radps + 1e-12);
}

TEST(Pursuit, OmniDrivesSidewaysWithThePathsHeading) {
  std::vector<PathPose> path{{{0, 0, 0.5}, {0, 1}}};
  append_poses(path, {0, 0, 0.5}, {{0, 1}, 0, 2}, 0.05, 0.1);
  path.back().pose.theta = 1.5;
  const PursuitSpec spec{.drive = Drive::omni, .goal_tolerance_m = 0.02, .goal_tolerance_rad = 0.02};
  PursuitState state;
  const PursuitStep step = pursue(spec, state, path, {0, 0, 0.5}, nullptr, 0.02);
  EXPECT_NEAR(step.command.vx_mps, 0, 1e-12);
  EXPECT_GT(step.command.vy_mps, 0);
  EXPECT_NEAR(step.command.w_radps, 0, 1e-12);
  const PursuitRun run = pursuit_drive(spec, path, {0, 0, 0});
  EXPECT_EQ(run.status, Following::arrived);
  EXPECT_NEAR(run.pose.x, path.back().pose.x, 0.02);
  EXPECT_NEAR(run.pose.theta, 1.5, 0.02);
}

TEST(Pursuit, CarFollowsForwardAndBackwardSections) {
  GridMap map{{200, 200, 0.1, {-10, -10, 0}}, std::vector<std::int8_t>(40000)};
  const CostMap costs = *make_cost_map(map, {}, 0.2);
  const Footprint footprint = *Footprint::rectangle(0.6, 0.2, 0.25, 0.25);
  const HybridSpec planner{.turning_radius_m = 1};
  const PursuitSpec spec{.drive = Drive::car,
                         .speed_mps = 0.4,
                         .min_lookahead_m = 0.25,
                         .max_lookahead_m = 0.4,
                         .turning_radius_m = 0.8,
                         .goal_tolerance_m = 0.1};
  int changes = 0;
  for (const Pose2 goal : {Pose2{0, 1.2, 0}, Pose2{-3, 0.5, 0.4}, Pose2{2, 2, -2}, Pose2{0.3, 0, math::pi}}) {
    const auto plan = plan_hybrid(costs, footprint, planner, {0, 0, 0}, goal);
    ASSERT_TRUE(plan);
    for (std::size_t i = 1; i < plan->poses.size(); ++i)
      changes += plan->poses[i].direction_B.x * plan->poses[i - 1].direction_B.x < 0;
    const PursuitRun run = pursuit_drive(spec, plan->poses, {0, 0, 0});
    EXPECT_EQ(run.status, Following::arrived) << goal.x << " " << goal.y;
    EXPECT_LE(math::hypot(run.pose.x - goal.x, run.pose.y - goal.y), 0.1 + 1e-9);
    EXPECT_NEAR(math::wrap_angle(run.pose.theta - goal.theta), 0, 0.3);
    EXPECT_LE(run.tightest, 1 / 0.8 + 1e-9) << "never below the turning radius";
    EXPECT_LT(run.farthest, 0.2);
  }
  EXPECT_GE(changes, 3);
}

TEST(Pursuit, NothingToFollowStopsTheRobot) {
  PursuitState state;
  const PursuitSpec spec;
  const auto path = pursuit_line(3);
  EXPECT_EQ(pursue(spec, state, {}, {}, nullptr, 0.1).status, Following::lost);
  EXPECT_EQ(pursue(spec, state, path, {std::nan(""), 0, 0}, nullptr, 0.1).status, Following::lost);
  EXPECT_EQ(pursue(spec, state, path, {0, 5, 0}, nullptr, 0.1).status, Following::lost);
  EXPECT_EQ(pursue(spec, state, path, {0, 0, 0}, nullptr, 0).status, Following::lost);
  EXPECT_EQ(pursue(spec, state, path, {2.95, 0.3, 0}, nullptr, 0.1).status, Following::driving);
  PursuitSpec car{.drive = Drive::car};
  PursuitState late;
  EXPECT_EQ(pursue(car, late, pursuit_line(1), {1.1, 0.3, 0}, nullptr, 0.1).status, Following::missed);
  PursuitState one;
  const PathPose here[] = {{{1, 1, 0}}};
  EXPECT_EQ(pursue(spec, one, here, {1, 1, 0}, nullptr, 0.1).status, Following::arrived);
  EXPECT_EQ(pursue(spec, one, here, {1.5, 1, 0}, nullptr, 0.1).status, Following::driving);
}

}  // namespace
}  // namespace sandlot::navigation
