/// Errors of commands against their formulas, in whole simulations.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/world/device_keys.h"
#include "sim/world/test_movers.h"

namespace sandlot::test {
namespace {

// ----------------------------------------------------------------------------------------------------- command_errors

struct Moments {
  double mean = 0, variance = 0;
};
Moments moments(const std::vector<double>& x) {
  Moments m;
  const auto n = static_cast<double>(x.size());
  for (const double v : x) m.mean += v / n;
  for (const double v : x) m.variance += (v - m.mean) * (v - m.mean) / n;
  return m;
}
double correlation(const std::vector<double>& a, const std::vector<double>& b, std::size_t lag = 0) {
  const Moments of_a = moments(a), of_b = moments(b);
  double sum = 0;
  for (std::size_t i = 0; i + lag < a.size(); ++i) sum += (a[i] - of_a.mean) * (b[i + lag] - of_b.mean);
  return sum / static_cast<double>(a.size() - lag) / std::sqrt(of_a.variance * of_b.variance);
}

/// What a robot makes of one command over n ticks.
std::vector<double> course(const Node& keys, int n, double command = 1) {
  const auto simulation = build(movers(keys));
  drive(*simulation, command);
  std::vector<double> out;
  for (int i = 0; i < n; ++i) {
    advance(*simulation, 1);
    out.push_back(followed(*simulation).message.linear.x);
  }
  return out;
}

constexpr double bound = 4.5;  // standard deviations of the estimator

TEST(CommandErrors, HaveTheVarianceOfTheirStages) {
  constexpr int n = 20'000;
  const auto expect = [](const std::vector<double>& x, double mean, double variance) {
    const Moments m = moments(x);
    EXPECT_NEAR(m.mean, mean, bound * std::sqrt(variance / n));
    EXPECT_NEAR(m.variance, variance, bound * variance * std::sqrt(2.0 / n));
  };
  expect(course(errors_of("linear", list_of({{"gaussian", map({{"std", "5 cm/s"}})}})), n), 1, 0.0025);
  expect(course(errors_of("linear", list_of({{"proportional", map({{"std", "0.1"}})}})), n, 3), 3, 0.09);
  // Both, at half and at no errors.
  Node both = errors_of(
      "linear", list_of({{"gaussian", map({{"std", "0.05"}})}, {"proportional", map({{"std", "0.1"}})}}));
  expect(course(both, n), 1, 0.0025 + 0.01 * (1 + 0.0025));
  both.set("errors", Node::scalar("0.5"));
  expect(course(both, n), 1, 0.25 * (0.0025 + 0.01 * (1 + 0.25 * 0.0025)));
  both.set("errors", Node::scalar("0"));
  EXPECT_EQ(course(both, 100), std::vector<double>(100, 1.0));
}

TEST(CommandErrors, DriftWithTheirCorrelationTime) {
  // exp(-lag / 0.2 s) of an error with the correlation time 0.2 s; of n samples with exp(-dt / tau) between neighbours about
  // n dt / (2 tau) are independent.
  constexpr int n = 40'000;
  const auto x = course(
      errors_of("linear", list_of({{"drift", map({{"std", "0.1"}, {"correlation", "0.2 s"}})}})), n);
  const double independent = n * 0.01 / 0.4;
  EXPECT_NEAR(moments(x).variance, 0.01, bound * 0.01 * std::sqrt(2 / independent));
  for (const std::size_t lag : {5u, 20u, 40u})
    EXPECT_NEAR(correlation(x, x, lag), math::exp(-0.01 * static_cast<double>(lag) / 0.2),
                bound / std::sqrt(independent));
}

TEST(CommandErrors, FollowAStepAsAFirstOrderLagDoes) {
  const auto x = course(errors_of("linear", list_of({{"lag", map({{"time_constant", "0.1 s"}})}})), 50, 2);
  for (std::size_t k = 0; k < x.size(); ++k)
    ASSERT_NEAR(x[k], 2 * (1 - math::exp(-0.01 * static_cast<double>(k + 1) / 0.1)), 1e-12) << k;
  Node twice = errors_of("linear", list_of({{"lag", map({{"time_constant", "0.1 s"}})}}));
  twice.set("errors", Node::scalar("2"));
  EXPECT_NEAR(course(twice, 20, 1)[19], 1 - math::exp(-1.0), 1e-12);
}

TEST(CommandErrors, LagBehindByTheirDelayWithinOneStep) {
  // Another random command in each tick; what is followed is most like the command of 190 ms before.
  for (const auto& keys : {errors_of("linear", list_of({{"latency", map({{"delay", "190 ms"}})}})),
                           map({{"delay", "190 ms"}})}) {
    const auto simulation = build(movers(keys));
    Stream random(5, 6, Purpose::experiment, 0);
    std::vector<double> commanded, real;
    for (int i = 0; i < 2000; ++i) {
      commanded.push_back(random.normal());
      drive(*simulation, commanded.back());
      advance(*simulation, 1);
      real.push_back(followed(*simulation).message.linear.x);
    }
    std::size_t best = 0;
    for (std::size_t lag = 0; lag < 60; ++lag)
      if (correlation(commanded, real, lag) > correlation(commanded, real, best)) best = lag;
    EXPECT_EQ(best, 19u);
    for (std::size_t i = 0; i < 19; ++i) ASSERT_EQ(real[i], 0) << "at rest before the first arrives";
    for (std::size_t i = 19; i < real.size(); ++i) ASSERT_EQ(real[i], commanded[i - 19]);
  }
}

TEST(CommandErrors, OfTwoRobotsAndOfTwoAxesAreIndependent) {
  constexpr int n = 10'000;
  Node keys = errors_of("linear", list_of({{"gaussian", map({{"std", "0.1"}})}}));
  keys.find("command_errors")->set("angular", list_of({{"gaussian", map({{"std", "0.1"}})}}));
  const auto simulation = build(movers(keys, 2));
  drive(*simulation, 1, 1), drive(*simulation, 1, 1, "robot2");
  std::vector<double> x1, y1, turn1, x2;
  for (int i = 0; i < n; ++i) {
    advance(*simulation, 1);
    const msg::Twist& one = followed(*simulation).message;
    x1.push_back(one.linear.x), y1.push_back(one.linear.y), turn1.push_back(one.angular.z);
    x2.push_back(followed(*simulation, "robot2").message.linear.x);
  }
  const double most = bound / std::sqrt(n);
  EXPECT_LT(std::abs(correlation(x1, x2)), most);
  EXPECT_LT(std::abs(correlation(x1, y1)), most);
  EXPECT_LT(std::abs(correlation(x1, turn1)), most);
  EXPECT_NEAR(moments(y1).mean, 0, bound * 0.1 / std::sqrt(n));
  // One more robot changes no other's errors.
  const auto alone = build(movers(keys));
  drive(*alone, 1, 1);
  for (int i = 0; i < 50; ++i) {
    advance(*alone, 1);
    ASSERT_EQ(followed(*alone).message.linear.x, x1[static_cast<std::size_t>(i)]);
  }
}

/// A drift goes on while nothing is commanded: what it is at a time does not depend on when the first command came.
TEST(CommandErrors, DriftAlsoWhileNothingIsCommanded) {
  const Node keys = errors_of("linear",
                              list_of({{"drift", map({{"std", "0.1"}, {"correlation", "0.2 s"}})}}));
  const auto early = build(movers(keys)), late = build(movers(keys));
  drive(*early, 1);
  advance(*early, 30), advance(*late, 30);
  drive(*late, 1);
  advance(*early, 10), advance(*late, 10);
  EXPECT_NE(followed(*early).message.linear.x, 1);
  EXPECT_EQ(followed(*late).message.linear.x, followed(*early).message.linear.x);
}

/// What came last is followed, whatever its slot.
TEST(CommandErrors, FollowTheLatestCommandAtAnotherLevel) {
  model::Setup setup = arena("rigid", 1, "");
  setup.instances.back().devices[0].config.set(
      "command_errors",
      *errors_of("linear", list_of({{"gaussian", map({{"std", "0"}})}})).find("command_errors"));
  const auto simulation = build(std::move(setup));
  const auto order = [&](double x) {
    simulation->submit(
        CommandRequest{"rover1/drive", msg::Twist::ros_type, command_bytes(msg::Twist{{x, 0, 0}, {}})});
  };
  order(0.4);
  advance(*simulation, 5);
  EXPECT_EQ(value(*simulation, "rover1/drive/ideal/command.linear.x"), 0.4);
  simulation->submit(LevelRequest{"rover1/drive", {"contact"}});
  advance(*simulation, 5);
  EXPECT_EQ(value(*simulation, "rover1/drive/contact/command.linear.x"), 0.4);
  order(0.1);
  advance(*simulation, 5);
  EXPECT_EQ(value(*simulation, "rover1/drive/contact/command.linear.x"), 0.1);
}

TEST(CommandErrors, EndWithTheLevelOrGoOnAtTheOtherLevel) {
  model::Setup setup = arena("rigid", 1, "");
  setup.instances.back().devices[0].config.set(
      "command_errors",
      *errors_of("linear", list_of({{"gaussian", map({{"std", "0.05"}})}})).find("command_errors"));
  const auto simulation = build(std::move(setup));
  const auto count = [&](const char* level) {
    return value(*simulation, (std::string("rover1/drive/") + level + "/command.count").c_str());
  };
  simulation->submit(
      CommandRequest{"rover1/drive", msg::Twist::ros_type, command_bytes(msg::Twist{{0.4, 0, 0}, {}})});
  advance(*simulation, 10);
  EXPECT_EQ(count("ideal"), 10);
  EXPECT_EQ(count("contact"), 0);
  simulation->submit(LevelRequest{"rover1/drive", {"contact"}});
  advance(*simulation, 10);
  EXPECT_EQ(count("ideal"), 10);
  EXPECT_EQ(count("contact"), 10);
  double mean = 0;
  for (int i = 0; i < 400; ++i) {
    advance(*simulation, 1);
    mean += value(*simulation, "rover1/drive/contact/command.linear.x") / 400;
  }
  EXPECT_NEAR(mean, 0.4, bound * 0.05 / 20);
}

TEST(CommandErrors, AreScaledByRobotWorldAndNoisyFailures) {
  constexpr int n = 5000;
  Node keys = errors_of("linear", list_of({{"gaussian", map({{"std", "0.05"}})}}));
  Node failures = Node::sequence();
  failures.push(map({{"kind", "noisy"}, {"from", "0"}, {"until", "1000 s"}, {"factor", "2"}}));
  keys.set("failures", failures);
  model::Setup setup = movers(keys);
  setup.errors = 0.5;
  setup.instances.back().errors = 4;
  const auto simulation = build(std::move(setup));
  drive(*simulation, 1);
  std::vector<double> x;
  for (int i = 0; i < n; ++i) {
    advance(*simulation, 1);
    x.push_back(followed(*simulation).message.linear.x);
  }
  const double variance = 0.2 * 0.2;  // 2 * 0.5 * 4 = 4 times 0.05
  EXPECT_NEAR(moments(x).variance, variance, bound * variance * std::sqrt(2.0 / n));
}

}  // namespace
}  // namespace sandlot::test
