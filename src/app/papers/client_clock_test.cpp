/// The clock for clients in C++ (clients/cpp), by hand and against its twin in Python.
#include <gtest/gtest.h>
#include <sandlot_client/clock.h>

#include <array>
#include <cmath>
#include <cstdio>

#include "app/papers/step_timers.h"
#include "files/text.h"
#include "run/step_times_file.h"

namespace sandlot::app {
namespace {

using sandlot_client::Clock;
using sandlot_client::IntervalTimer;

/// A run whose steps of 10 ms take `wall_s` each; messages arrive at once.
struct Fed {
  double wall_s = 100, stamp_s = 5;
  Clock clock{[this] { return wall_s; }, [this](double s) { wall_s += s; }};

  Fed() { clock.take(stamp_s, 0.01, {}, wall_s, true); }
  void steps(int count, double each_s) {
    for (int i = 0; i < count; ++i) {
      stamp_s += 0.01;
      wall_s += each_s;
      clock.take(stamp_s, 0.01, {each_s}, wall_s);
    }
  }
};

TEST(ClientClock, IsExactAtAConstantSpeed) {
  Fed run;
  EXPECT_EQ(run.clock.speed(), 1) << "nothing is known yet";
  run.steps(100, 0.005);
  EXPECT_NEAR(run.clock.speed(), 2, 1e-9);
  EXPECT_NEAR(run.clock.speed(0.5), 2, 1e-9);
  EXPECT_NEAR(run.clock.now_s(), 6, 1e-9);
  run.wall_s += 0.002;
  EXPECT_NEAR(run.clock.now_s(), 6.004, 1e-9);
  EXPECT_NEAR(run.clock.wall_s_until(6.1), 0.048, 1e-9);
  EXPECT_EQ(run.clock.wall_s_until(5.9), 0);
}

/// By hand: after 100 steps of 5 ms, steps take 20 ms. A mean of the last n steps is right after n of them. All of them have predicted
/// without an error, so the first, of 5, is used: 20/8 of the old share is left after 4 steps, none after 5.
TEST(ClientClock, FollowsAnotherSpeedWithinItsShortestWindow) {
  Fed run;
  run.steps(100, 0.005);
  run.steps(4, 0.02);
  EXPECT_GT(run.clock.speed(), 0.55);
  run.steps(1, 0.02);
  EXPECT_NEAR(run.clock.speed(), 0.5, 1e-9);
  run.steps(60, 0.02);
  EXPECT_NEAR(run.clock.speed(), 0.5, 1e-9);
  EXPECT_NEAR(run.clock.speed(1), 0.5, 1e-9) << "the longest window, too";
}

/// By hand: times of 1 and 9 ms in turn give a mean of 5 ms; a window of 5 is off by 0.8 ms, one of 10 not at all. Over 64 steps any even
/// window is right. Fifty steps later the clock plans half a second, 50 steps, to the wall times of 250 ms.
TEST(ClientClock, PlansLongIntervalsByTheWindowThatWasRight) {
  Fed run;
  for (int i = 0; i < 200; ++i) run.steps(1, i % 2 ? 0.009 : 0.001);
  EXPECT_NEAR(run.clock.speed(0.64), 2, 1e-9);
  EXPECT_NEAR(run.clock.wall_s_until(run.stamp_s + 0.5), 0.25, 1e-9);
}

TEST(ClientClock, NeverGoesBackNorBeyondTheNextMessage) {
  Fed run;
  run.steps(100, 0.005);
  run.wall_s += 1;  // the run stalls: no more than the step that may have ended meanwhile
  EXPECT_NEAR(run.clock.now_s(), 6.01, 1e-9);
  double before = run.clock.now_s();
  run.stamp_s += 0.01;
  run.clock.take(run.stamp_s, 0.01, {1}, run.wall_s);
  EXPECT_GE(run.clock.now_s(), before);
  // Messages of 8 steps, whose time the clock may go on, and of a single slow one, with which it is ahead.
  for (int i = 0; i < 2000; ++i) {
    const std::vector<double> walls(i % 20 == 10 ? 8 : 1, i % 20 == 10 ? 0.001 : 0.004);
    if (i % 10 == 0) run.stamp_s += 0.01 * static_cast<double>(walls.size());
    if (i % 10 == 0) run.clock.take(run.stamp_s, 0.01, walls, run.wall_s);
    run.wall_s += 0.0007;
    const double now = run.clock.now_s();
    EXPECT_GE(now, before);
    EXPECT_LE(now, run.stamp_s + 0.08 + 1e-9);
    before = now;
  }
}

/// By hand: messages of 4 steps; the clock may go 4 steps on. One that comes 3 ms late is as good as one in time.
TEST(ClientClock, TakesStepsInMessagesAndRemovesTheirDelay) {
  Fed run;
  for (int i = 0; i < 20; ++i) {
    run.wall_s += 0.02;
    run.stamp_s += 0.04;
    run.clock.take(run.stamp_s, 0.01, {0.005, 0.005, 0.005, 0.005}, run.wall_s + (i == 19 ? 0.003 : 0));
  }
  run.wall_s += 0.01;
  EXPECT_NEAR(run.clock.now_s(), run.stamp_s + 0.02, 1e-9);
  run.wall_s += 1;
  EXPECT_NEAR(run.clock.now_s(), run.stamp_s + 0.04, 1e-9);
}

TEST(ClientClock, BeginsAgainAfterAPauseAndAfterARewind) {
  Fed run;
  run.steps(100, 0.005);
  run.wall_s += 60;  // paused
  run.stamp_s += 0.01;
  run.clock.take(run.stamp_s, 0.01, {}, run.wall_s, true);
  EXPECT_NEAR(run.clock.now_s(), 6.01, 1e-9);
  EXPECT_NEAR(run.clock.speed(), 2, 1e-9) << "the pause is no step";
  EXPECT_EQ(run.clock.rewinds(), 0u);
  IntervalTimer timer = run.clock.timer(0.1);
  run.stamp_s = 1;
  run.clock.take(run.stamp_s, 0.01, {}, run.wall_s, true);
  EXPECT_NEAR(run.clock.now_s(), 1, 1e-9);
  EXPECT_EQ(run.clock.rewinds(), 1u);
  EXPECT_EQ(timer.poll(), 0u);
  EXPECT_NEAR(timer.next_s(), 1.1, 1e-9);
}

/// By hand: at twice real time a period of 0.1 s takes 50 ms, at half of real time 200 ms.
TEST(ClientClock, TimersAdaptAndDoNotDrift) {
  Fed run;
  run.steps(100, 0.005);
  IntervalTimer timer = run.clock.timer(0.1);
  EXPECT_NEAR(timer.wall_s_left(), 0.05, 1e-9);
  EXPECT_EQ(timer.poll(), 0u);
  run.steps(10, 0.005);
  EXPECT_EQ(timer.poll(), 1u);
  EXPECT_EQ(timer.poll(), 0u);
  run.steps(5, 0.02);
  EXPECT_NEAR(timer.next_s(), 6.2, 1e-9);
  run.steps(26, 0.02);
  EXPECT_EQ(timer.poll(), 3u) << "6.2, 6.3 and 6.4";
  EXPECT_NEAR(timer.next_s(), 6.5, 1e-9);
  EXPECT_NEAR(timer.wall_s_left(), 0.18, 1e-9) << "90 ms of simulated time are left";
  EXPECT_THROW(run.clock.timer(0), std::invalid_argument);
  EXPECT_THROW(run.clock.timer(1e-300), std::invalid_argument);
  EXPECT_THROW(run.clock.timer(std::nan("")), std::invalid_argument);
  EXPECT_THROW(Clock({}, {}, {}), std::invalid_argument);
}

/// By hand: steps of 10 ms in 5 ms, fed while the clock waits.
TEST(ClientClock, SleepsInSimulatedTime) {
  double wall_s = 0, stamp_s = 0;
  Clock* fed = nullptr;
  Clock clock([&] { return wall_s; },
              [&](double s) {
                ASSERT_LE(s, 0.02);
                for (wall_s += s; wall_s < 0.43 && stamp_s + 0.01 <= 2 * wall_s;) {
                  stamp_s += 0.01;
                  fed->take(stamp_s, 0.01, {0.005}, stamp_s / 2);
                }
              });
  fed = &clock;
  EXPECT_TRUE(clock.sleep_until(0.5)) << "the first messages come while it waits";
  EXPECT_NEAR(wall_s, 0.25, 0.006);
  IntervalTimer timer = clock.timer(0.1);
  EXPECT_EQ(timer.wait(), 1u);
  EXPECT_NEAR(wall_s, 0.3, 0.006);
  EXPECT_FALSE(clock.sleep_until(5, 0.5)) << "the run stalls at 0.86 s";
  EXPECT_NEAR(wall_s, 0.8, 0.03);
  EXPECT_EQ(timer.wait(0.1), 2u) << "0.7 and 0.8 have passed";
  EXPECT_EQ(timer.wait(0.1), 0u);
}

/// tests/clock/expected.csv has what the twin in Python answers on a trace: `python3 tests/clock_test.py --write` makes it.
TEST(ClientClock, AnswersAsItsTwinInPythonDoes) {
  const auto text = read_text_file("tests/clock/field_images.csv", 1 << 20);
  const auto expected = read_text_file("tests/clock/expected.csv", 1 << 20);
  ASSERT_TRUE(text);
  ASSERT_TRUE(expected);
  const auto steps = read_step_times(*text, "field_images.csv");
  ASSERT_TRUE(steps);
  double wall_s = 0;
  Clock clock([&] { return wall_s; });
  IntervalTimer timer = clock.timer(0.07);
  const char* at = expected->c_str();
  int compared = 0;
  for (std::size_t i = 0; i + 3 < steps->size(); i += 3) {
    // Every other message has one step, the others two.
    std::vector<double> walls;
    for (std::size_t k = i; k < i + 3; ++k) {
      wall_s += *(*steps)[k].wall_s;
      walls.push_back(*(*steps)[k].wall_s);
      if (k == i + 1) continue;
      clock.take((*steps)[k].now.s(), 0.001, walls, wall_s);
      walls.clear();
    }
    const double came_s = wall_s;
    wall_s += 0.4 * *(*steps)[i + 3].wall_s;
    double row[5] = {};
    int length = 0;
    ASSERT_EQ(std::sscanf(at, "%lf,%lf,%lf,%lf,%lf%n", &row[0], &row[1], &row[2], &row[3], &row[4], &length),
              5);
    at += length;
    const double stamp_s = (*steps)[i + 2].now.s();
    const std::array<double, 5> ours{clock.now_s(), clock.speed(), clock.speed(0.1),
                                     clock.wall_s_until(stamp_s + 0.05), static_cast<double>(timer.poll())};
    for (std::size_t k = 0; k < ours.size(); ++k) {
      EXPECT_NEAR(ours[k], row[k], 1e-9 * std::max(1.0, std::abs(row[k]))) << i << " " << k;
    }
    ++compared;
    wall_s = came_s;
  }
  EXPECT_GT(compared, 600);
}

}  // namespace
}  // namespace sandlot::app
