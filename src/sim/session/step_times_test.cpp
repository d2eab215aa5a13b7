/// Step times of a session.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <utility>

#include "sim/session/session.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

model::Setup rolling_until(double stop_s) {
  model::Setup setup;
  setup.engine = "rigid";
  setup.stop = Time::from_s(stop_s);
  setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
  setup.instances.push_back(placed("ball", one_shape("ball", Sphere{0.1}, 1, 0.5), {{0, 0, 1}, {}}));
  return setup;
}

struct Steps final : StepObserver {
  std::vector<StepTime> steps;
  std::vector<std::size_t> ends;  ///< of stretches: steps before them
  void on_step(const StepTime& step) override { steps.push_back(step); }
  void on_stretch_end() override { ends.push_back(steps.size()); }
};

/// By hand: 20 ticks of 10 ms at real time; the first one begins the stretch, the other 19 take 190 ms in all, but for how late the
/// ends of the first and the last are. What is waited for is in the intervals and not in what the ticks took to compute.
TEST(StepTimes, SumUpToRealTime) {
  Session session(build(rolling_until(0.2)), {.pace = {1.0}});
  Steps seen;
  session.add_step_observer(&seen);
  RunReport report;
  ASSERT_TRUE(session.run(report));
  ASSERT_EQ(seen.steps.size(), 20u);
  double wall_s = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_EQ(seen.steps[i].now, Time::from_s(0.01 * static_cast<double>(i + 1)));
    EXPECT_EQ(seen.steps[i].step, Time::from_s(0.01));
    EXPECT_EQ(seen.steps[i].wall_s.has_value(), i > 0);
    EXPECT_GT(seen.steps[i].compute_s, 0);
    if (!seen.steps[i].wall_s) continue;
    EXPECT_GE(*seen.steps[i].wall_s, seen.steps[i].compute_s);
    wall_s += *seen.steps[i].wall_s;
  }
  EXPECT_LE(wall_s, report.wall_s);
  EXPECT_GT(wall_s, 0.1);
  EXPECT_EQ(seen.ends, std::vector<std::size_t>{20});
}

TEST(StepTimes, BeginAgainAfterAPauseAndAJump) {
  Session session(build(rolling_until(0.2)), {});
  Steps seen;
  session.add_step_observer(&seen);
  RunReport report;
  bool back = false;
  ASSERT_TRUE(session.run(report, [&](const Simulation& simulation) {
    if (session.report().state == Session::State::paused) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      session.play();
    } else if (simulation.tick_index() == 5 && seen.steps.size() == 5) {
      session.pause();
    } else if (simulation.tick_index() == 10 && !std::exchange(back, true)) {
      EXPECT_TRUE(session.jump(Time::from_s(0.03)));
    }
    return true;
  }));
  // Ticks 1 to 5, 6 to 10, and from 0.03 s on again; those that run again on the way there do not count.
  ASSERT_EQ(seen.steps.size(), 10u + 17u);
  for (std::size_t i = 0; i < seen.steps.size(); ++i)
    EXPECT_EQ(seen.steps[i].wall_s.has_value(), i != 0 && i != 5 && i != 10) << i;
  EXPECT_EQ(seen.steps[10].now, Time::from_s(0.04));
  for (const StepTime& each : seen.steps) {
    EXPECT_LT(each.wall_s.value_or(0), 0.045) << "the pause is in no interval";
  }
}

TEST(StepTimes, ChangeNothingOfTheRun) {
  std::uint64_t hash[2];
  for (const bool measured : {false, true}) {
    Session session(build(rolling_until(0.2)), {});
    Steps seen;
    if (measured) session.add_step_observer(&seen);
    RunReport report;
    ASSERT_TRUE(session.run(report));
    EXPECT_EQ(seen.steps.size(), measured ? 20u : 0u);
    hash[measured] = session.simulation().state_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

}  // namespace
}  // namespace sandlot::test
