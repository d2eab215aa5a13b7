/// The controller navigate in its scenarios: goals in clutter of several seeds, with movers; in a flat; along rows of vines; snapshots; goals and maps that are
/// bad.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "messages/command.h"
#include "messages/diagnostic_msgs.h"
#include "sim/load/load.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot::test {
namespace {

std::unique_ptr<Simulation> navigate_scenario(const std::string& file, std::uint64_t seed,
                                              const std::vector<formats::Override>& overrides = {}) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.seed = seed;
  options.overrides = overrides;
  auto setup = load(file, options, diagnostics);
  EXPECT_TRUE(setup) << setup.error().text();
  return setup ? build(std::move(*setup)) : nullptr;
}

std::unique_ptr<Simulation> clutter(std::uint64_t seed,
                                    const std::vector<formats::Override>& overrides = {}) {
  return navigate_scenario("scenarios/clutter.yaml", seed, overrides);
}

double value(const Simulation& simulation, const std::string& name) {
  auto found = NamedValue::find(simulation, name);
  EXPECT_TRUE(found) << name;
  return found ? found->read().value_or(NAN) : NAN;
}

const msg::DiagnosticStatus& status(const Simulation& simulation) {
  return topic_cast<msg::DiagnosticStatus>(simulation.find_topic("/rover/controller/status"))->message;
}

CommandRequest goal(double x, double y, const std::string& frame = "") {
  msg::PoseStamped message;
  message.header.frame_id = frame;
  message.pose.p = {x, y, 0};
  return {"rover/goal_pose", msg::PoseStamped::ros_type, command_bytes(message)};
}

/// Drives until a number of goals has an end. @return the least gap to a rock, a wall or a mover [m]
double drive(Simulation& simulation, double goals, int most_ticks) {
  double gap = 1e9;
  for (int i = 0; i < most_ticks; i += 5) {
    advance(simulation, 5);
    gap = std::min(gap, value(simulation, "gap"));
    const Vec3 p = simulation.engine().pose(*simulation.find_instance("rover")).p;
    for (const char* mover : {"mover1", "mover2"})
      if (const auto at = simulation.find_instance(mover)) {
        const Vec3 m = simulation.engine().pose(*at).p;
        gap = std::min(gap, math::hypot(p.x - m.x, p.y - m.y) - 2 * 0.18);
      }
    if (value(simulation, "rover/controller.reached") + value(simulation, "rover/controller.failed") >= goals)
      break;
  }
  return gap;
}

void expect_all_goals(std::uint64_t seed, const char* movers) {
  const auto simulation = clutter(seed, {{"movers", movers}});
  EXPECT_EQ(simulation->find_instance("mover2").has_value(), movers[0] == '2');
  const double gap = drive(*simulation, 4, 24'000);
  std::printf("seed %d, %s movers: gap %.3f m, %g s\n", static_cast<int>(seed), movers, gap,
              simulation->now().s());
  EXPECT_GT(gap, 0) << seed;
  EXPECT_EQ(value(*simulation, "rover/controller.reached"), 4) << seed;
}

TEST(Clutter, ReachesItsGoalsWithoutContact) {
  const auto simulation = clutter(1);
  EXPECT_GT(drive(*simulation, 1, 6000), 0);
  EXPECT_EQ(value(*simulation, "rover/controller.reached"), 1);
  const Vec3 p = simulation->engine().pose(*simulation->find_instance("rover")).p;
  EXPECT_LE(math::hypot(p.x - 4.3, p.y - 4.3), 0.15 + 0.6 * 0.05) << "the tolerance, and a control step";
}

// With seed 11 it backed into a rock that its laser of 270 degrees did not see, with seed 4 it touched one.
TEST(Clutter, BacksUpOnlyWhereItKnowsTheWay) {
  expect_all_goals(11, "0");
  expect_all_goals(4, "0");
}

TEST(SlowClutter, ReachesItsGoalsWithoutContactOnTenSeeds) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) expect_all_goals(seed, "0");
}
TEST(SlowClutter, ReachesItsGoalsAmongMovers) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) expect_all_goals(seed, "2");
}

/// A car and a robot with four steered wheels, whose lasers do not see what is behind them: `gap` is of the rectangle about their bodies.
void expect_all_goals_on(const char* chassis, std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const auto simulation = clutter(seed, {{"chassis", chassis}});
    double gap = 1e9;
    const auto over = [&](const char* name) {
      return value(*simulation, std::string("rover/controller.") + name);
    };
    for (int i = 0; i < 24'000 && over("reached") + over("failed") < 4; i += 5) {
      advance(*simulation, 5);
      gap = std::min(gap, value(*simulation, "gap"));
    }
    std::printf("seed %d, %s: gap %.3f m, %g s, %g reached\n", static_cast<int>(seed), chassis, gap,
                simulation->now().s(), over("reached"));
    EXPECT_GT(gap, 0) << seed;
    EXPECT_EQ(over("reached"), 4) << seed << ' ' << status(*simulation).message;
  }
}
TEST(SlowClutter, ACarReachesItsGoals) { expect_all_goals_on("car", 1, 2); }
TEST(SlowClutter, FourSteeredWheelsReachTheirGoals) { expect_all_goals_on("four_wheel_steer", 1, 2); }
TEST(LongClutter, ACarReachesItsGoalsOnTwentySeeds) { expect_all_goals_on("car", 1, 20); }
TEST(LongClutter, FourSteeredWheelsReachTheirGoalsOnTwentySeeds) {
  expect_all_goals_on("four_wheel_steer", 1, 20);
}

/// Ticks until all goals have an end. @return whether the rule `touched` has counted a contact
bool drive_on(Simulation& simulation, const std::string& navigator, double goals, int most_ticks) {
  for (int i = 0; i < most_ticks; i += 20) {
    advance(simulation, 20);
    if (value(simulation, navigator + ".reached") + value(simulation, navigator + ".failed") >= goals) break;
  }
  EXPECT_EQ(value(simulation, navigator + ".reached"), goals);
  return value(simulation, "rules/touched.robots[0].blows") > 0;
}

TEST(SlowOfficeGoals, ReachesTheRoomsWithoutContact) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto simulation = navigate_scenario("scenarios/office_goals.yaml", seed);
    EXPECT_FALSE(drive_on(*simulation, "rover/navigator", 5, 20'000)) << seed;
    const Vec3 p = simulation->engine().pose(*simulation->find_instance("rover")).p;
    // The tolerance of the goal, and what the localiser is off by.
    EXPECT_LE(math::hypot(p.x - 1.6, p.y - 4.65), 0.15 + 0.15) << seed;
  }
}
// The rule that counts contacts does: a rover that takes itself for a point touches something.
TEST(SlowOfficeGoals, NoticesContacts) {
  const auto simulation = navigate_scenario(
      "scenarios/office_goals.yaml", 1,
      {{"robots[0].controllers[1].radius", "0.02"}, {"robots[0].controllers[1].margin", "0"}});
  double blows = 0;
  for (int i = 0; i < 12'000 && !(blows > 0); i += 20) {
    advance(*simulation, 20);
    blows = value(*simulation, "rules/touched.robots[0].blows");
  }
  EXPECT_GT(blows, 0);
}

TEST(SlowVineyardRows, ReachesTheEndsOfRows) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto simulation = navigate_scenario("scenarios/vineyard_rows.yaml", seed);
    double nearest = 1e9;
    for (int i = 0; i < 18'000 && value(*simulation, "mario/navigator.reached") < 4; i += 20) {
      advance(*simulation, 20);
      nearest = std::min(nearest, value(*simulation, "nearest"));
    }
    EXPECT_EQ(value(*simulation, "mario/navigator.reached"), 4) << seed;
    EXPECT_EQ(value(*simulation, "mario/navigator.failed"), 0) << seed;
    // Half of its width is 0.3 m; a vine's stem is a few centimetres thick.
    EXPECT_GT(nearest, 0.35) << seed;
    EXPECT_LT(math::hypot(value(*simulation, "x"), value(*simulation, "y")), 0.25 + 0.2)
        << "back at the start by the truth, within the goal's tolerance and the receiver's error";
  }
}

TEST(Clutter, GoesOnFromASnapshotToTheBit) {
  const auto whole = clutter(2);
  advance(*whole, 437);
  const auto one = again(*whole), three = again(*whole, {.threads = 3});
  advance(*whole, 300), advance(*one, 300), advance(*three, 300);
  EXPECT_GT(value(*whole, "rover/controller.navigator.plans"), 2);
  EXPECT_EQ(one->state_hash(), whole->state_hash());
  EXPECT_EQ(three->state_hash(), whole->state_hash());
}

TEST(Clutter, AnswersGoalsOfClients) {
  const auto simulation = clutter(1);
  advance(*simulation, 10);
  const std::string frame = topic_cast<msg::Path>(simulation->find_topic("/rover/controller/plan"))
                                ->message.header.frame_id;
  // Another frame: the goal of the list stays.
  simulation->submit(goal(0, 0, "somewhere"));
  advance(*simulation, 20);
  EXPECT_EQ(value(*simulation, "rover/controller.refused"), 1);
  EXPECT_EQ(value(*simulation, "rover/controller.navigator.goal_x"), 4.3);
  // Off the map, 20 m about the start.
  simulation->submit(goal(500, 0, frame));
  advance(*simulation, 20);
  EXPECT_EQ(status(*simulation).level, msg::DiagnosticStatus::error);
  EXPECT_NE(status(*simulation).message.find("is off the map"), std::string::npos)
      << status(*simulation).message;
  EXPECT_EQ(value(*simulation, "rover/controller.failed"), 1);
  EXPECT_TRUE(topic_cast<msg::Path>(simulation->find_topic("/rover/controller/plan"))->message.poses.empty());
  // No number: refused at the border, nothing changes.
  simulation->submit(goal(NAN, 0));
  advance(*simulation, 20);
  EXPECT_EQ(value(*simulation, "rover/controller.failed"), 1);
  // A free one is driven to, and ends the list.
  simulation->submit(goal(-4.3, -3.5));
  EXPECT_GT(drive(*simulation, 2, 3000), 0);
  EXPECT_EQ(value(*simulation, "rover/controller.reached"), 1);
  advance(*simulation, 50);
  EXPECT_EQ(status(*simulation).message, "reached");
  // In the wall: it fails with the reason, after recoveries.
  simulation->submit(goal(-5.05, -4.3));
  EXPECT_GT(drive(*simulation, 3, 12'000), 0);
  EXPECT_EQ(value(*simulation, "rover/controller.failed"), 2);
  EXPECT_EQ(status(*simulation).level, msg::DiagnosticStatus::error);
}

TEST(Clutter, RefusesMapsThatAreNone) {
  Diagnostics diagnostics;
  const auto refusal = [&](const std::string& map) {
    const std::vector<formats::Override> overrides{{"robots[0].controller.map_data", map}};
    LoadOptions options;
    options.overrides = overrides;
    auto setup = load("scenarios/clutter.yaml", options, diagnostics);
    if (!setup) return setup.error().text();
    auto made = Simulation::create(std::move(*setup), {}, diagnostics);
    return made ? std::string() : made.error().text();
  };
  EXPECT_EQ(refusal("\"200 200 0.05 -5 -5 0\\n40000*0\""), "");
  EXPECT_NE(refusal("\"200 200 0.05 -5 -5 0\\n39999*0\""), "") << "too few cells";
  EXPECT_NE(refusal("\"100000 100000 0.05 -5 -5 0\\n1*0\""), "") << "too large";
  EXPECT_NE(refusal("\"200 200 nan -5 -5 0\\n40000*0\""), "");
}

/// A map with a wall in the place of the goal: answered at once, without a drive.
TEST(Clutter, AnswersAGoalInAWallOfTheMap) {
  const auto simulation = clutter(
      1, {{"robots[0].controller.map_data", "\"200 200 0.05 -5 -5 0\\n20000*0 20000*100\""},
          {"robots[0].controller.stop_on_failure", "true"}});
  advance(*simulation, 40);
  EXPECT_EQ(value(*simulation, "rover/controller.failed"), 1);
  EXPECT_NE(status(*simulation).message.find("in an obstacle of the map"), std::string::npos)
      << status(*simulation).message;
}

}  // namespace
}  // namespace sandlot::test
