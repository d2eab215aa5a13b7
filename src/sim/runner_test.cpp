#include "sim/runner.h"

#include <gtest/gtest.h>

#include "sim/test_world.h"

namespace sandlot::test {
namespace {

model::Setup ball(double stop_s) {
  model::Setup setup;
  setup.engine = "planar";
  setup.stop = Time::from_s(stop_s);
  setup.instances.push_back(placed("ball", one_shape("ball", Sphere{0.1}, 1), {{0, 0, 0.1}, {}}));
  return setup;
}

TEST(Runner, as_fast_as_possible_runs_to_the_stop_time) {
  const auto simulation = build(ball(20));
  RunReport report;
  ASSERT_TRUE(run(*simulation, {}, report));
  EXPECT_EQ(report.ticks, 2000u);
  EXPECT_DOUBLE_EQ(report.sim_s, 20);
  EXPECT_EQ(simulation->now(), Time::from_s(20));
}

TEST(Runner, a_factor_never_runs_ahead_of_the_clock) {
  // The other direction (keeping up) depends on the machine and is not tested: 1 s at 10 x real time cannot take
  // less than 0.1 s, but for the last tick, which need not be waited for.
  const auto simulation = build(ball(1));
  RunReport report;
  ASSERT_TRUE(run(*simulation, {10.0}, report));
  EXPECT_EQ(report.ticks, 100u);
  EXPECT_GE(report.wall_s, 0.1 - 0.001 - 1e-9);
}

TEST(Runner, the_clock_does_not_change_the_result) {
  const auto fast = build(ball(0.5)), timed = build(ball(0.5));
  RunReport report;
  ASSERT_TRUE(run(*fast, {}, report));
  ASSERT_TRUE(run(*timed, {20.0}, report));
  EXPECT_EQ(fast->state_hash(), timed->state_hash());
}

TEST(Runner, the_caller_can_end_it) {
  const auto simulation = build(ball(20));
  RunReport report;
  ASSERT_TRUE(run(*simulation, {}, report, [](const Simulation& s) { return s.tick_index() < 30; }));
  EXPECT_EQ(report.ticks, 30u);
}

}  // namespace
}  // namespace sandlot::test
