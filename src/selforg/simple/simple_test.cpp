#include "selforg/simple/simple.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "base/test_folder.h"
#include "selforg/agent.h"
#include "selforg/dep/dep.h"
#include "selforg/test_reference.h"

namespace sandlot::selforg::test {
namespace {

TEST(Sine, EachMotorFollowsTheOneBeforeIt) {
  Sine sine;
  sine.spec.period = 40;
  sine.spec.amplitude = 0.5;
  Matrix x(0, 1), y(3, 1);
  for (int k = 0; k < 100; ++k) {
    sine.step(x, y, Mode::learn);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(y[static_cast<std::size_t>(i)], 0.5 * math::sin(2 * math::pi * k / 40 - i * math::pi / 2),
                  1e-12);
  }
  sine.spec.shape = Sine::Shape::impulse;
  sine.spec.impulswidth = 0.25;
  sine.state.phase = 0.2;
  sine.step(x, y, Mode::learn);
  EXPECT_EQ(y[0], 0.5);
  EXPECT_EQ(y[1], -0.5);  // at 0.95 of its period
}

TEST(Babbling, HasPeriodsWithinItsBoundsAndRepeatsItself) {
  auto one = make_controller("babbling", {0, 4, 9, "a"}), same = make_controller("babbling", {0, 4, 9, "a"}),
       other = make_controller("babbling", {0, 4, 9, "b"});
  ASSERT_TRUE(one && same && other);
  std::vector<double> y1(4), y2(4), y3(4), last(4);
  std::vector<int> crossings(4);
  bool differs = false;
  for (int k = 0; k < 500; ++k) {
    (*one)->step({}, y1);
    (*same)->step({}, y2);
    (*other)->step({}, y3);
    EXPECT_EQ(y1, y2);
    differs = differs || y1 != y3;
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_LE(std::abs(y1[i]), 1);
      crossings[i] += k > 0 && (y1[i] > 0) != (last[i] > 0);
    }
    last = y1;
  }
  EXPECT_TRUE(differs) << "the name is a key of the random numbers";
  // Periods of 50 to 250 steps: 500 steps hold 2 to 10 of them, with two crossings each, and one more or less at the ends.
  for (const int each : crossings) EXPECT_TRUE(each >= 3 && each <= 21) << each;
}

TEST(Braitenberg, VehiclesTurnToTheSourceOrAway) {
  const double light_left[] = {0.9, 0.2};
  double y[2];
  auto aggressive = make_controller("braitenberg", {2, 2});
  ASSERT_TRUE(static_cast<bool>(aggressive));
  (*aggressive)->step(light_left, y);
  EXPECT_EQ(y[0], 0.2);
  EXPECT_EQ(y[1], 0.9);  // the right wheel is faster: to the left
  Node cowardly = Node::map();
  cowardly.set("type", Node::scalar("cowardly"));
  auto coward = make_controller("braitenberg", {2, 2}, cowardly);
  ASSERT_TRUE(static_cast<bool>(coward));
  (*coward)->step(light_left, y);
  EXPECT_EQ(y[0], 0.9);
  EXPECT_EQ(y[1], 0.2);
  EXPECT_FALSE(static_cast<bool>(make_controller("braitenberg", {2, 3})));
  Node custom = Node::map();
  custom.set("type", Node::scalar("custom"));
  auto none = make_controller("braitenberg", {2, 1}, custom);
  ASSERT_FALSE(static_cast<bool>(none));
  EXPECT_EQ(none.error().what, "'weights' has 0 values for 1 motors and 2 sensors");
}

TEST(Replay, RepeatsALogToTheBit) {
  sandlot::test::TestFolder folder;
  const std::string path = folder.file("run.log");
  auto sox = make_controller("sox", {2, 2});
  ASSERT_TRUE(static_cast<bool>(sox));
  LogFile log;
  ASSERT_TRUE(static_cast<bool>(log.open(path, {.interval = 1, .channels = {"y*"}}, **sox)));
  std::vector<std::vector<double>> sent;
  std::vector<double> x(2), y(2);
  for (int k = 0; k < 40; ++k) {
    x = {0.3 * math::sin(k * 0.7), 0.1 * k / 40};
    (*sox)->step(x, y);
    log.step(0.01 * k, **sox);
    sent.push_back(y);
  }
  ASSERT_TRUE(static_cast<bool>(log.close()));
  Node node = Node::map();
  node.set("file", Node::scalar(path));
  node.set("end", Node::scalar("loop"));
  auto replay = make_controller("replay", {7, 2}, node);
  ASSERT_TRUE(static_cast<bool>(replay)) << replay.error().text();
  x.resize(7);
  for (int k = 0; k < 80; ++k) {
    (*replay)->step(x, y);
    EXPECT_EQ(y, sent[static_cast<std::size_t>(k) % 40]) << k;
  }
  auto wide = make_controller("replay", {0, 3}, node);
  ASSERT_FALSE(static_cast<bool>(wide));
  EXPECT_NE(wide.error().what.find("no column y[2]"), std::string::npos);
}

TEST(Dep, EachStepIsTheLiteralOne) {
  for (const bool individual : {false, true}) {
    Stream random(1, 2, Purpose::experiment, 3);
    Dep dep;
    dep.spec.timedist = 2;
    dep.spec.indnorm = individual;
    dep.spec.regularization = 2;
    ASSERT_TRUE(static_cast<bool>(dep.init({4, 3, 1, "dep"})));
    Ref C = dep.state.C, h = dep.state.h;
    std::vector<Ref> xs;
    Matrix y(3, 1);
    for (std::size_t t = 0; t < 30; ++t) {
      const Matrix x = random_matrix(random, 4, 1);
      xs.emplace_back(x);
      dep.step(x, y, Mode::learn);
      if (t > 2) {
        const Ref now = xs[t] - xs[t - 1], then = xs[t - 2] - xs[t - 3];
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 4; ++j) C.at[i][j] += 0.1L * (now(i) * then(j) - C.at[i][j]);
      }
      expect_near(dep.state.C, C, 1e-12, "C");
      Ref z(3, 1);
      for (std::size_t i = 0; i < 3; ++i) {
        Real row = 0, sum = 0;
        for (std::size_t j = 0; j < 4; ++j) row += C(i, j) * C(i, j), sum += C(i, j) * xs[t](j);
        z.at[i][0] = 5 * sum / (std::sqrt(individual ? row : norm2(C)) + 0.01L) + h(i);
      }
      const Ref wanted = squash(z);
      expect_near(y, wanted, 1e-12, "y");
      h = h - 0.1L * wanted;
    }
  }
}

}  // namespace
}  // namespace sandlot::selforg::test
