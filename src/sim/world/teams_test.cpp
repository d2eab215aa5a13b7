/// Team programs: one program drives all robots of its team, also while they come and go.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "sim/load/load.h"
#include "sim/test_values.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

constexpr const char* formation_file = "scenarios/formation.yaml";

Result<model::Setup> loaded(const std::string& yaml) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.text = yaml;
  return load("scenarios/s.yaml", options, diagnostics);
}

model::Setup formation() {
  Diagnostics diagnostics;
  auto setup = load(formation_file, {}, diagnostics);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error().text());
  return std::move(*setup);
}

std::vector<Pose> robots(const Simulation& simulation) {
  std::vector<Pose> out;
  for (const auto& entity : simulation.entities())
    if (entity->instance.is_robot) out.push_back(simulation.engine().pose(entity->id));
  return out;
}

void run_until_formed(Simulation& simulation, std::size_t robots) {
  for (int tick = 0; tick < 6000; ++tick) {
    if (value(simulation, "red/coach/arrived.data") == static_cast<double>(robots)) return;
    advance(simulation, 1);
  }
  ADD_FAILURE() << "not formed after 6000 ticks";
}

/// n points on a circle about the origin with neighbours 1 m apart lie at the radius 1 / (2 sin(pi / n)), point i at the
/// angle 2 pi i / n. A robot stands within the tolerance of 5 cm, with the heading to within 0.02 rad.
void expect_circle(const Simulation& simulation) {
  const std::vector<Pose> all = robots(simulation);
  const double n = static_cast<double>(all.size()), radius = n < 2 ? 0 : 0.5 / math::sin(math::pi / n);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double angle = 2 * math::pi * static_cast<double>(i) / n;
    EXPECT_NEAR(math::hypot(all[i].p.x - radius * math::cos(angle), all[i].p.y - radius * math::sin(angle)),
                0, 0.055)
        << i << " of " << n;
    EXPECT_NEAR(yaw_of(all[i].q), 0, 0.03) << i;
  }
}

TEST(Teams, AFormationIsFormedAndKeptWhenRobotsComeAndGo) {
  const auto simulation = build(formation());
  run_until_formed(*simulation, 6);
  expect_circle(*simulation);

  simulation->submit(DeleteRequest{"scout3"});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->outcomes().front().status);
  const auto half = simulation->snapshot();
  advance(*simulation, 10);
  run_until_formed(*simulation, 5);
  expect_circle(*simulation);

  model::Instance late = simulation->entities().back()->instance;
  late.name = late.original_name = "late";
  late.X_WM = {{3, 3, 0}, {}};
  simulation->submit(SpawnRequest{late});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->outcomes().front().status) << simulation->outcomes().front().status.error().text();
  advance(*simulation, 10);
  run_until_formed(*simulation, 6);
  expect_circle(*simulation);

  // From the middle of it, in any number of threads, the same.
  const auto ticks = static_cast<int>(300);
  std::uint64_t hash = 0;
  for (const int threads : {1, 2, 4}) {
    Diagnostics diagnostics;
    auto rest = Simulation::restore(half, {.threads = threads}, diagnostics);
    ASSERT_TRUE(rest);
    advance(**rest, ticks);
    if (threads == 1) hash = (*rest)->state_hash();
    EXPECT_EQ((*rest)->state_hash(), hash) << threads;
  }
}

TEST(Teams, TheLastRobotMayGoAndTheFirstCome) {
  const auto simulation = build(formation());
  const model::Instance scout = simulation->entities().back()->instance;
  for (int i = 1; i <= 6; ++i) simulation->submit(DeleteRequest{"scout" + std::to_string(i)});
  advance(*simulation, 20);
  EXPECT_EQ(value(*simulation, "red/coach/arrived.data"), 0);
  simulation->submit(SpawnRequest{scout});
  advance(*simulation, 2);
  run_until_formed(*simulation, 1);
  expect_circle(*simulation);
}

TEST(Teams, ARobotThatTheProgramCannotDriveIsNotSpawned) {
  const auto simulation = build(formation());
  model::Instance blind = simulation->entities().back()->instance;
  blind.name = "blind";
  auto& devices = blind.devices.edit();
  std::erase_if(devices, [](const model::DeviceDecl& decl) { return decl.name == "truth"; });
  simulation->submit(SpawnRequest{blind});
  simulation->submit(UnloadDeviceRequest{"scout2/truth"});
  advance(*simulation, 1);
  ASSERT_EQ(simulation->outcomes().size(), 2u);
  for (const Outcome& outcome : simulation->outcomes()) EXPECT_FALSE(outcome.status);
  EXPECT_THAT(simulation->outcomes()[0].status.error().text(),
              HasSubstr("robot 'blind' has no reading 'truth' of type nav_msgs/msg/Odometry"));
  EXPECT_EQ(simulation->find_instance("blind"), std::nullopt);
  EXPECT_NE(simulation->find_topic("scout2/truth"), nullptr);
  advance(*simulation, 20);
}

TEST(Teams, ParametersOfTheirProgramsAreSet) {
  const auto simulation = build(formation());
  simulation->submit(ParameterRequest{"red/coach", "spacing", Node::scalar("2 m")});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->outcomes().front().status);
  EXPECT_EQ(value(*simulation, "red/coach.spacing"), 2);
}

struct Sources : Observer {
  Wants wants() const override { return {.log = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    for (const LogEntry& entry : frame->log) ids.insert(entry.source.id);
  }
  std::set<std::uint64_t> ids;
};

/// Nobody takes them for those of a robot.
TEST(Teams, TheirOrdersHaveASourceOfTheirOwn) {
  const auto simulation = build(formation());
  Sources sources;
  simulation->add_observer(&sources);
  advance(*simulation, 20);
  EXPECT_EQ(sources.ids, (std::set<std::uint64_t>{std::uint64_t{1} << 63}));
  simulation->remove_observer(&sources);
}

TEST(Teams, SurviveASnapshotWithTheirState) {
  const auto whole = build(formation());
  advance(*whole, 77);
  const auto rest = again(*whole, {.threads = 2});
  ASSERT_EQ(rest->teams().size(), 1u);
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(rest->state_hash(), whole->state_hash()) << whole->tick_index();
    advance(*whole, 1);
    advance(*rest, 1);
  }
  EXPECT_EQ(rest->snapshot(), whole->snapshot());
  const auto parts = whole->sub_hashes();
  EXPECT_EQ(parts.back().path, "red/coach");
}

constexpr const char* start = "version: 1\nphysics: planar\ntime: {step: 20 ms, stop: 1 s}\n";
constexpr const char* robot = "robots:\n- {name: a, model: ../models/scout/model.sdf, team: red}\n";

std::string error_of_text(const std::string& yaml) {
  auto setup = loaded(yaml);
  if (!setup) return setup.error().text();
  Diagnostics diagnostics;
  auto made = Simulation::create(std::move(*setup), {}, diagnostics);
  return made ? "" : made.error().text();
}

TEST(Teams, ErrorsNameLineAndWhatWouldBeRight) {
  const std::string begin = start;
  EXPECT_EQ(error_of_text(begin + robot), "");  // without teams any name is one
  EXPECT_EQ(error_of_text(begin + "teams: [{name: red}]\n" + robot), "");
  EXPECT_THAT(error_of_text(begin + "teams:\n- name: rad\n" + robot),
              HasSubstr("s.yaml:7:53: /robots/0/team: there is no team 'red'; did you mean 'rad'?"));
  EXPECT_THAT(error_of_text(begin + "teams:\n- name: red\n- name: red\n" + robot),
              HasSubstr("s.yaml:6:9: /teams/1/name: two teams are called 'red'"));
  EXPECT_THAT(error_of_text(begin + "teams:\n- name: a\n" +
                            "robots:\n- {name: a, model: ../models/scout/model.sdf}\n"),
              HasSubstr("'a' is the name of a team"));
  EXPECT_THAT(error_of_text(begin + "teams:\n- name: red\n- name: blue\n  criterion: 1\n" + robot),
              HasSubstr("s.yaml:6:9: /teams/1: no robot is in team 'blue'; name it: team: blue"));
  EXPECT_THAT(error_of_text(begin + "teams:\n- name: a/b\n" + robot),
              HasSubstr("cannot be the name of a team"));
  EXPECT_THAT(error_of_text(begin + "teams: [{name: red, controller: wandr}]\n" + robot),
              HasSubstr("no controller 'wandr'; did you mean 'wander'?"));
  EXPECT_THAT(
      error_of_text(begin + "teams: [{name: red, controller: {kind: formation, odometry: gps}}]\n" + robot),
      HasSubstr("robot 'a' has no reading 'gps' of type nav_msgs/msg/Odometry"));
}

TEST(Rates, ARobotsRateIsTheDefaultOfItsProgramsAndDevices) {
  const auto setup = loaded(
      std::string("version: 1\nphysics: planar\ntime: {step: 10 ms, stop: 1 s}\n") +
      "robots:\n- name: a\n  model: ../models/rover/model.sdf\n  rate: 25\n  controllers:\n"
      "  - {name: own, kind: wander, laser: laser, rate: 5}\n  - {name: given, kind: wander, laser: laser}\n"
      "  devices:\n    slow: {kind: ground_truth, rate: 2}\n    plain: {kind: ground_truth}\n"
      "    every: {kind: ground_truth, rate: 0}\n    sick: {kind: laser_scanner, preset: sick_lms200}\n");
  ASSERT_TRUE(setup) << setup.error().text();
  Diagnostics diagnostics;
  auto made = Simulation::create(*setup, {}, diagnostics);
  ASSERT_TRUE(made) << made.error().text();
  const Simulation& simulation = **made;
  const auto rate = [&](const std::string& path) {
    for (const auto& device : simulation.entities().back()->devices)
      if (device->path == path) return simulation.timing(*device).rate_hz;
    return -1.0;
  };
  EXPECT_EQ(rate("a/slow"), 2);
  EXPECT_EQ(rate("a/plain"), 25);
  EXPECT_EQ(rate("a/every"), 0);
  EXPECT_EQ(rate("a/laser"), 10);  // of the model's file
  EXPECT_NE(rate("a/sick"), 25);   // of the preset
  const auto& programs = simulation.entities().back()->programs;
  EXPECT_EQ(programs[0]->schedule->rate_hz, 5);
  EXPECT_EQ(programs[1]->schedule->rate_hz, 25);
  EXPECT_EQ(programs[1]->description->control_period_s, 0.04);
  EXPECT_THAT(
      error_of_text(
          std::string(start) +
          "robots:\n- name: a\n  model: ../models/scout/model.sdf\n  rate: 100\n  controller: diffusion\n"),
      HasSubstr("s.yaml:7:9: "));
}

}  // namespace
}  // namespace sandlot::test
