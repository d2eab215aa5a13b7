#include "navigation/planning/recovery.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "base/bytes.h"

namespace sandlot::navigation {
namespace {

CostMap recovery_room(double wall_behind_m = 2) {
  GridMap map{{120, 120, 0.05, {-3, -3, 0}}, std::vector<std::int8_t>(120 * 120)};
  const int x = static_cast<int>(std::lround((3 - wall_behind_m) / 0.05));
  for (int y = 0; y < 120; ++y) map.occupancy[map.geometry.index({x, y})] = 100;
  return *make_cost_map(map, {}, 0.2);
}

struct RecoveryRun {
  std::map<RecoveryStage, double> seconds;
  int clears = 0, plans = 0;
  Pose2 pose;
};

/// A robot that nothing but its recovery moves.
RecoveryRun recovery_run(const RecoverySpec& spec, const CostMap& map, double time_s,
                         RecoveryState state = {}) {
  const Footprint box = *Footprint::rectangle(0.25, 0.25, 0.2, 0.2);
  const GridFrame frame(map.geometry);
  RecoveryRun run;
  for (double t = 0; t < time_s - 1e-9; t += 0.05) {
    const RecoveryStep step = recover(spec, state, map, box, run.pose, false, 0.05);
    run.seconds[step.stage] += 0.05;
    run.clears += step.clear_map;
    run.plans += step.plan_again;
    run.pose = driven(run.pose, step.command, 0.05);
    EXPECT_EQ(footprint_contact(map, frame, box, run.pose), Contact::none);
  }
  return run;
}

TEST(Recovery, ARoundClearsWaitsBacksUpAndTurns) {
  // 6 s without progress, clearing for a step, 2 s, 0.3 m at 0.1 m/s, 1.6 rad at 0.5 rad/s: 14.2 s and the steps between.
  const RecoveryRun run = recovery_run({}, recovery_room(), 14.6);
  EXPECT_EQ(run.clears, 1);
  EXPECT_EQ(run.plans, 1);
  EXPECT_NEAR(run.seconds.at(RecoveryStage::waiting), 2, 0.11);
  EXPECT_NEAR(run.seconds.at(RecoveryStage::backing), 3, 0.11);
  EXPECT_NEAR(run.seconds.at(RecoveryStage::turning), 3.2, 0.11);
  EXPECT_NEAR(run.pose.x, -0.3, 0.006);
  EXPECT_NEAR(run.pose.theta, 1.6, 0.03);
}

TEST(Recovery, GivesUpAfterItsRounds) {
  const RecoveryRun run = recovery_run({.rounds = 2}, recovery_room(), 60);
  EXPECT_EQ(run.clears, 2);
  EXPECT_GT(run.seconds.at(RecoveryStage::given_up), 10);
}

TEST(Recovery, MotionsEndBeforeObstacles) {
  // The wall's face is 0.35 m behind the robot's middle: it backs up by at most 0.1 m.
  const RecoveryRun run = recovery_run({.turn_rad = 0, .rounds = 1}, recovery_room(0.4), 20);
  EXPECT_LT(run.pose.x, -0.02);
  EXPECT_GT(run.pose.x, -0.1);
  EXPECT_EQ(run.pose.theta, 0);
}

TEST(Recovery, MotionsDoNotLeadToTheUnknown) {
  const CostMap map = recovery_room();
  const Footprint box = *Footprint::circle(0.2);
  // It has seen the half plane from 0.15 m behind it on: with 0.1 m/s and half a second to look ahead it backs up by 0.1 m or less.
  const auto known = [](const Pose2& there) { return there.x > -0.15; };
  RecoveryState state;
  Pose2 pose;
  for (int k = 0; k < 200; ++k) {
    const RecoveryStep step = recover({}, state, map, box, pose, k < 1, 0.05, known);
    pose = driven(pose, step.command, 0.05);
  }
  EXPECT_GT(pose.x, -0.11);
  EXPECT_LT(pose.x, -0.08);
}

TEST(Recovery, FailuresStartARoundAtOnceAndProgressForgets) {
  const CostMap map = recovery_room();
  const Footprint box = *Footprint::circle(0.2);
  const RecoverySpec spec{.wait_s = 0, .back_up_m = 0, .turn_rad = 0, .rounds = 1};
  RecoveryState state;
  Pose2 pose;
  const auto step = [&](bool failed) { return recover(spec, state, map, box, pose, failed, 0.1); };
  EXPECT_EQ(step(false).stage, RecoveryStage::watching);
  EXPECT_TRUE(step(true).clear_map);
  EXPECT_TRUE(step(false).plan_again);
  // A robot that drives 0.3 m on has made progress: the next failure begins a first round again.
  pose.x = 0.3;
  EXPECT_EQ(step(false).stage, RecoveryStage::watching);
  EXPECT_TRUE(step(true).clear_map);
  EXPECT_TRUE(step(false).plan_again);
  // Without progress the next failure is one too many.
  EXPECT_EQ(step(true).stage, RecoveryStage::given_up);
  EXPECT_EQ(step(false).stage, RecoveryStage::given_up);
}

TEST(Recovery, DrivingRobotIsLeftAlone) {
  const CostMap map = recovery_room();
  const Footprint box = *Footprint::circle(0.2);
  RecoveryState state;
  for (int k = 0; k < 400; ++k)
    ASSERT_EQ(recover({}, state, map, box, {0.005 * k, 0, 0}, false, 0.1).stage, RecoveryStage::watching)
        << k;
}

TEST(Recovery, PoseThatIsNotFiniteNeverMovesTheRobot) {
  const CostMap map = recovery_room();
  const Footprint box = *Footprint::circle(0.2);
  RecoveryState state;
  bool gave_up = false;
  for (int k = 0; k < 2000; ++k) {
    const RecoveryStep step = recover({}, state, map, box, {std::nan(""), 0, 0}, false, 0.1);
    EXPECT_EQ(step.command.vx_mps, 0);
    EXPECT_EQ(step.command.w_radps, 0);
    gave_up = gave_up || step.stage == RecoveryStage::given_up;
  }
  EXPECT_TRUE(gave_up);
}

TEST(Recovery, StateComesBackFromItsBytes) {
  const CostMap map = recovery_room();
  const Footprint box = *Footprint::circle(0.2);
  RecoveryState state;
  for (int k = 0; k < 100; ++k) recover({}, state, map, box, {0.1, 0.2, 0.3}, false, 0.1);
  ASSERT_NE(state.stage, RecoveryStage::watching);
  ByteWriter out;
  write(out, state);
  RecoveryState back;
  ByteReader in(out.bytes());
  read(in, back);
  EXPECT_EQ(back.stage, state.stage);
  EXPECT_EQ(back.done, state.done);
  EXPECT_EQ(back.round, state.round);
  EXPECT_EQ(back.y_m, 0.2);
}

}  // namespace
}  // namespace sandlot::navigation
