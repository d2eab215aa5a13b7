/// Scenarios of scenarios/selforg: robots that move by themselves, agents that are the same in the simulator and in a plain program,
/// runs that go on in the middle of learning.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/text.h"
#include "command.h"
#include "run/repeat.h"
#include "selforg/agent.h"
#include "sim/load/load.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot::test {
namespace {

using Settings = std::vector<formats::Override>;

std::string file_of(const std::string& name) { return "scenarios/selforg/" + name + ".yaml"; }

std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator("scenarios/selforg"))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::unique_ptr<Simulation> world_of(const std::string& name, const Settings& settings = {}) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.overrides = settings;
  auto setup = load(file_of(name), options, diagnostics);
  if (!setup) {
    ADD_FAILURE() << setup.error().text();
    return nullptr;
  }
  for (const Error& warning : diagnostics.warnings) ADD_FAILURE() << name << ": " << warning.text();
  EXPECT_TRUE(setup->criterion) << name << " has no criterion";
  return build(std::move(*setup));
}

TEST(SelfOrgRobots, EachScenarioLoadsWithoutAWarningAndHasACriterion) {
  EXPECT_GE(all_names().size(), 15u);
  for (const std::string& name : all_names()) EXPECT_TRUE(world_of(name)) << name;
}

// --- the same agent in the simulator and in a plain program ---

struct Driven {
  const char* scenario;
  const char* robot;
  const char* sensors;  ///< addresses, `#` for x, y, z or an index
  int count;
};

class SelfOrgAgent : public testing::TestWithParam<Driven> {};
INSTANTIATE_TEST_SUITE_P(Robots, SelfOrgAgent,
                         testing::Values(Driven{"sphere", "ball", "ball/imu.linear_acceleration.#", 3},
                                         Driven{"hexapod", "hexapod", "hexapod/joints.position[#]", 12},
                                         Driven{"slider_wheelie", "wheelie", "wheelie/joints.position[#]", 8},
                                         Driven{"world_model", "nimm", "nimm/joints.velocity[#]", 2},
                                         Driven{"humanoid", "human", "human/joints.position[#]", 16}),
                         [](const auto& each) { return std::string(each.param.scenario); });

/// The robot of a simulation as a plain program sees it: numbers in, numbers out. Its agent begins with the seed that the run gives,
/// gets what the robot measured in each control step, and must order what the run ordered.
TEST_P(SelfOrgAgent, OrdersTheSameInAPlainProgram) {
  const Driven& p = GetParam();
  const auto simulation = world_of(p.scenario);
  ASSERT_TRUE(simulation);
  const auto address = [&](int i) {
    std::string text = p.sensors;
    const std::string index = text.find('[') == std::string::npos ? std::string(1, "xyz"[i])
                                                                  : std::to_string(i);
    return text.replace(text.find('#'), 1, index);
  };
  const std::string controller = std::string(p.robot) + "/controller";
  std::vector<NamedValue> sensors, motors;
  const auto find = [&](const std::string& text) {
    auto value = NamedValue::find(*simulation, text);
    EXPECT_TRUE(value) << (value ? "" : value.error().text());
    return std::move(*value);
  };
  for (int i = 0; i < p.count; ++i) sensors.push_back(find(address(i)));
  const auto n = static_cast<std::size_t>(p.count);
  std::size_t m = 0;
  while (NamedValue::find_or_wait(*simulation, fmt::format("{}/y.data[{}]", controller, m)).read()) ++m;
  ASSERT_GT(m, 0u);
  for (std::size_t i = 0; i < m; ++i) motors.push_back(find(fmt::format("{}/y.data[{}]", controller, i)));

  selforg::AgentSpec spec;
  spec.name = p.robot;
  spec.noise = 0.05;
  spec.seed = Stream(simulation->setup().seed, entity_key(controller), Purpose::controller, 0).bits64();
  const auto entity = std::find_if(simulation->entities().begin(), simulation->entities().end(),
                                   [&](const auto& each) { return each->instance.name == p.robot; });
  ASSERT_NE(entity, simulation->entities().end());
  const Node& config = (*entity)->instance.controllers.at(0).config;
  if (const Node* const parameters = config.find("parameters")) spec.parameters = *parameters;
  // The largest number of a sensor's range; all of these are symmetric. One entry may stand for many sensors.
  const auto half_range = [&](std::size_t i) {
    const auto& entries = config.find("sensors")->items();
    double half = 1;
    if (const Node* const max = entries[entries.size() == 1 ? 0 : i].find("max")) {
      EXPECT_TRUE(parse_number(max->text(), half));
    }
    return half;
  };
  auto plain = selforg::WiredController::make(n, m, spec);
  ASSERT_TRUE(plain) << plain.error().text();
  std::vector<double> x(n), y(m);
  // Tick 0 is taken; control steps are every other tick. What the robot measures in a tick is what its controller sees in it.
  for (int step = 0; step < 500; ++step) {
    if (step > 0) advance(*simulation, 2);
    for (std::size_t i = 0; i < n; ++i) x[i] = sensors[i].read().value_or(0) / half_range(i);
    (*plain)->step(x, y);
    for (std::size_t i = 0; i < m; ++i)
      ASSERT_EQ(*motors[i].read(), y[i]) << "step " << step << ", motor " << i;
  }
}

// --- behaviour: three seeds here, twenty in docs/selforg_experiments.md ---

RepeatSummary runs(const std::string& name, const Settings& settings = {}, int count = 3) {
  RepeatSpec spec;
  spec.run.file = file_of(name);
  spec.run.overrides = settings;
  spec.count = count;
  auto all = repeat(spec);
  if (!all) {
    ADD_FAILURE() << all.error().text();
    return {};
  }
  for (const RepeatedRun& run : all->runs)
    for (const std::string& error : run.errors)
      ADD_FAILURE() << name << ", seed " << run.seed << ": " << error;
  return std::move(*all);
}

double mean(const RepeatSummary& all) {
  return all.all && all.all->criterion.mean ? *all.all->criterion.mean : -1e9;
}

double least(const RepeatSummary& all) { return all.all ? all.all->criterion.min.value_or(-1e9) : -1e9; }
double most(const RepeatSummary& all) { return all.all ? all.all->criterion.max.value_or(1e9) : 1e9; }
/// Settings for another kind of agent.
Settings agent(const char* kind, const std::string& robot) {
  return {{"agent", kind}, {"robots." + robot + ".controller.parameters", "{}"}};
}

TEST(SlowSelfOrgBehaviour, ABallFindsRollingAboutItsAxes) {
  const RepeatSummary sox = runs("sphere");
  EXPECT_GE(least(sox), 2) << "axes";
  EXPECT_EQ(mean(runs("sphere", agent("sine", "ball"))), 0);
}

TEST(SlowSelfOrgBehaviour, TheWorldModelIsDeprivedWhenTheControllerStopsLearning) {
  const RepeatSummary learns = runs("world_model"), frozen = runs("world_model", {{"freeze", "1 min"}});
  // While both learn, A's singular values are those of wheels that follow their motors: about 1.
  EXPECT_GT(least(learns), 0.95);
  EXPECT_LT(most(frozen), 0.85);
}

TEST(SlowSelfOrgBehaviour, CrossMotorTeachingReachesTheTaughtCoordination) {
  const RepeatSummary taught = runs("cross_motor"),
                      free = runs("cross_motor", {{"robots.nimm.controller.cross_motor", "[]"}});
  EXPECT_GT(least(taught), 0.5);
  EXPECT_LT(std::abs(mean(free)), 0.3);
}

TEST(SlowSelfOrgBehaviour, RewardsRaiseSpeedAndSpin) {
  const auto mean_of = [](const char* speed, const char* spin, const char* figure) {
    return mean(runs(
        "reward", {{"speed", speed}, {"spin", spin}, {"criterion", std::string("{value: ") + figure + "}"}}));
  };
  EXPECT_GT(mean_of("1", "0", "rules/speed.mean"), mean_of("0", "0", "rules/speed.mean"));
  EXPECT_GT(mean_of("0", "1", "rules/turning.mean"), mean_of("0", "0", "rules/turning.mean"));
}

TEST(SlowSelfOrgBehaviour, ARingAndAHexapodGetAboutBetterThanByBabbling) {
  EXPECT_GT(mean(runs("slider_wheelie", agent("dep", "wheelie"))),
            2 * mean(runs("slider_wheelie", agent("babbling", "wheelie"))));
  EXPECT_GT(mean(runs("hexapod")), mean(runs("hexapod", agent("babbling", "hexapod"))));
}

/// Recall begins from standing still, after two and a half minutes at the earliest.
TEST(SlowSelfOrgBehaviour, AnExpertRollsAgainFromStandingStill) {
  int within_a_minute = 0;
  for (const RepeatedRun& run : runs("experts").runs) within_a_minute += run.criterion.value_or(1e9) < 60;
  EXPECT_GE(within_a_minute, 2) << "of 3";
}

TEST(SlowSelfOrgBehaviour, PrimitivesTogetherAvoidObstaclesBetterThanEachAlone) {
  const double together = mean(runs("obstacles"));
  for (const char* alone :
       {"[{name: forwards, biases: [0.6, 0.6]}]", "[{name: backwards, biases: [-0.4, -0.4]}]",
        "[{name: left, biases: [-0.3, 0.3]}]", "[{name: right, biases: [0.3, -0.3]}]"})
    EXPECT_GT(together, mean(runs("obstacles", {{"primitives", alone}}))) << alone;
}

/// Each robot is somewhere else, or in another shape, than where it began.
TEST(SlowSelfOrgBehaviour, EachRobotMoves) {
  for (const std::string& name : all_names()) {
    const bool judged_late = name == "obstacles" || name == "world_model";  // behind the second minute
    const RepeatSummary all = runs(name, judged_late ? Settings() : Settings{{"time.stop", "70 s"}}, 1);
    ASSERT_EQ(all.runs.size(), 1u) << name;
    EXPECT_TRUE(all.runs[0].criterion) << name;
    EXPECT_NE(all.runs[0].criterion.value_or(0), 0) << name;
  }
}

}  // namespace
}  // namespace sandlot::test
