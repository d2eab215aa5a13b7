#include "sim/session/runner.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

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

TEST(Runner, AsFastAsPossibleRunsToTheStopTime) {
  const auto simulation = build(ball(20));
  RunReport report;
  ASSERT_TRUE(run(*simulation, {}, report));
  EXPECT_EQ(report.ticks, 2000u);
  EXPECT_DOUBLE_EQ(report.sim_s, 20);
  EXPECT_EQ(simulation->now(), Time::from_s(20));
}

TEST(Runner, AFactorNeverRunsAheadOfTheClock) {
  // The other direction (keeping up) depends on the machine and is not tested: 1 s at 10 x real time cannot take
  // less than 0.1 s, but for the last tick, which need not be waited for.
  const auto simulation = build(ball(1));
  RunReport report;
  ASSERT_TRUE(run(*simulation, {10.0}, report));
  EXPECT_EQ(report.ticks, 100u);
  EXPECT_GE(report.wall_s, 0.1 - 0.001 - 1e-9);
}

TEST(Runner, TheClockDoesNotChangeTheResult) {
  const auto fast = build(ball(0.5)), timed = build(ball(0.5));
  RunReport report;
  ASSERT_TRUE(run(*fast, {}, report));
  ASSERT_TRUE(run(*timed, {20.0}, report));
  EXPECT_EQ(fast->state_hash(), timed->state_hash());
}

TEST(Runner, TheCallerCanEndIt) {
  const auto simulation = build(ball(20));
  RunReport report;
  ASSERT_TRUE(run(*simulation, {}, report, [](const Simulation& s) { return s.tick_index() < 30; }));
  EXPECT_EQ(report.ticks, 30u);
}

/// Lengths of the ticks, and what the log says of them.
struct Lengths : Observer {
  Wants wants() const override { return {.log = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    ticks.push_back(frame->step);
    for (const LogEntry& entry : frame->log) {
      if (entry.kind != LogEntry::step) continue;
      Time logged;
      ByteReader r(entry.bytes);
      read(r, logged.ns);
      logged_ticks.push_back(logged);
    }
  }
  std::vector<Time> ticks, logged_ticks;
};

TEST(Runner, AContinuousClockTakesTheTimeThatTheLastTickTook) {
  model::Setup setup = ball(0.3);
  setup.clock = {model::Clock::Mode::continuous, Time::from_s(1e-3), Time::from_s(0.03)};
  const auto simulation = build(setup);
  Lengths lengths;
  simulation->add_observer(&lengths);
  RunReport report;
  // A cycle of at least 5 ms, now and then one of 50 ms: more than the longest tick.
  const auto slow = [](const Simulation& s) {
    std::this_thread::sleep_for(std::chrono::milliseconds(s.tick_index() % 8 == 5 ? 50 : 5));
    return true;
  };
  ASSERT_TRUE(run(*simulation, {}, report, slow));
  ASSERT_GE(lengths.ticks.size(), 7u);
  EXPECT_EQ(lengths.logged_ticks, lengths.ticks);
  EXPECT_EQ(lengths.ticks[0], setup.step) << "nothing has been measured yet";
  EXPECT_EQ(lengths.ticks[5], setup.clock.max_step);
  for (std::size_t i = 1; i < lengths.ticks.size(); ++i) {
    EXPECT_GE(lengths.ticks[i], Time::from_s(5e-3)) << i;
    EXPECT_LE(lengths.ticks[i], setup.clock.max_step) << i;
  }
  EXPECT_GE(report.late_ticks, 1u);
  EXPECT_LE(report.sim_s, report.wall_s + setup.step.s()) << "it never runs ahead of the wall clock";
  // The log alone gives the same run.
  const auto replay = build(setup);
  for (const Time length : lengths.logged_ticks) ASSERT_TRUE(replay->tick(length));
  EXPECT_EQ(replay->now(), simulation->now());
  EXPECT_EQ(replay->state_hash(), simulation->state_hash());
}

TEST(Runner, TicksLongerThanASamplingIntervalLoseSamplesAndDoNotPileThemUp) {
  model::Setup setup = arena("planar", 1);
  setup.clock.mode = model::Clock::Mode::continuous;
  for (auto& device : setup.instances.back().devices)
    if (device.name == "laser") device.config.set("rate", Node::scalar("20"));
  const auto simulation = build(setup);
  const TopicBase* const scan = simulation->find_topic("rover1/laser");
  ASSERT_TRUE(scan);
  const std::uint64_t before = scan->count;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation->tick(Time::from_s(0.1)));
  EXPECT_EQ(scan->count - before, 5u) << "one per tick: there are two intervals in each";
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(simulation->tick(Time::from_s(0.01)));
  EXPECT_EQ(scan->count - before, 15u) << "0.5 s at 20 Hz, none made up for";
}

}  // namespace
}  // namespace sandlot::test
