/// Agents on the console: listed, tuned by patterns, stored and loaded.
#include <fstream>
#include <iterator>

#include "base/base64.h"
#include "console/test_console.h"

namespace sandlot {
namespace {

using test::has;
using test::Talk;

/// Rovers whose agents sense speed and turning rate of their drive; the last one is driven by another program.
model::Setup agents(int robots, const char* agent = "sox") {
  model::Setup setup = test::arena("planar", robots);
  for (auto& instance : setup.instances) {
    if (!instance.is_robot || instance.name == "rover" + std::to_string(robots)) continue;
    instance.controllers.front().kind = "selforg";
    Node config = Node::map(), sensors = Node::sequence(), motors = Node::sequence();
    for (const char* value : {"linear.x", "angular.z"}) {
      Node place = test::map({{"device", "drive"}, {"min", "-1"}, {"max", "1"}});
      place.set("value", Node::scalar(value));
      motors.push(place);
      place.set("value", Node::scalar(std::string("twist.twist.") + value));
      sensors.push(std::move(place));
    }
    config.set("agent", Node::scalar(agent));
    config.set("sensors", sensors);
    config.set("motors", motors);
    instance.controllers.front().config = config;
  }
  return setup;
}

std::string file_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(AgentCommands, RobotsAndAgentsAreListed) {
  Talk talk(agents(2));
  EXPECT_EQ(talk.ok("list robots").substr(0, 19), "rover1  robot  rove");
  EXPECT_FALSE(has(talk.ok("list robots"), "crate1"));
  talk.step(11);  // the control interval is 5; the first step comes with the world
  EXPECT_EQ(talk.ok("list agents"),
            "rover1/controller  selforg  sox behind one_to_one, 2 sensors, 2 motors, 3 steps\n"
            "rover2/controller  wander");
  EXPECT_TRUE(
      has(talk.ok("list agents --json"), R"("agent":"sox","wiring":"one_to_one","sensors":2,"motors":2)"))
      << talk.ok("list agents --json");
  EXPECT_EQ(talk.complete("store rover1/c"), (std::vector<std::string>{"rover1/controller"}));
}

TEST(AgentCommands, PatternsSetParametersOfAllAgents) {
  Talk talk(agents(3));
  EXPECT_EQ(talk.ok("set */controller.parameters.eps* 0.3"),
            "rover1/controller.parameters.epsC = 0.3 with the next tick\n"
            "rover1/controller.parameters.epsA = 0.3 with the next tick\n"
            "rover2/controller.parameters.epsC = 0.3 with the next tick\n"
            "rover2/controller.parameters.epsA = 0.3 with the next tick");
  talk.ok("set */controller.wiring[0].noise.strength 0.25");
  talk.step();
  EXPECT_EQ(talk.ok("show rover2/controller.parameters.epsA"), "rover2/controller.parameters.epsA = 0.3");
  EXPECT_EQ(talk.ok("show rover1/controller.wiring[0].noise.strength"),
            "rover1/controller.wiring[0].noise.strength = 0.25");
  EXPECT_TRUE(has(talk.refused("set rover1/controller.parameters.epsC 9"), "must be in [0, 5]"));
  EXPECT_TRUE(has(talk.refused("set rover1/controller.parameters.epsC nan"), "epsC"));
  EXPECT_TRUE(has(talk.refused("set rover1/controller.parameters.eps 1"), "no parameter"));
}

TEST(AgentCommands, WhatOneLearnedGoesToAnotherInTheSameRunAndInOthers) {
  const test::TestFolder folder;
  const Console::Options options{.folder = folder.path.string()};
  {
    Talk talk(agents(3), options);
    talk.step(200);
    EXPECT_TRUE(has(talk.ok("store rover1/controller skill.agent"), "after 41 steps"));
    talk.step(20);
    const std::string answer = talk.ok("load rover2/controller skill.agent");
    EXPECT_TRUE(has(answer, "rover2/controller goes on from ") && has(answer, "with the next tick"))
        << answer;
    talk.step();
    EXPECT_TRUE(has(talk.ok("list agents"),
                    "rover2/controller  selforg  sox behind one_to_one, 2 sensors, 2 "
                    "motors, 41 steps"));
    talk.ok("store rover2 again.agent");  // its only agent
    EXPECT_EQ(file_text(folder.path / "skill.agent"), file_text(folder.path / "again.agent"));
  }
  Talk other(agents(2), options);
  other.ok("load rover1/controller skill.agent");
  other.step(5);
  EXPECT_TRUE(has(other.ok("list agents"), "42 steps")) << "it went on from 41";
}

TEST(AgentCommands, ALoadedAgentIsInputOfTheRun) {
  const test::TestFolder folder;
  Talk talk(agents(2), {.folder = folder.path.string()});
  talk.step(100);
  talk.ok("store rover1/controller a.agent");
  talk.step(50);
  talk.ok("load rover1/controller a.agent");
  talk.step(30);
  const std::string hash = talk.ok("hash");
  talk.step(30);
  std::filesystem::remove(folder.path / "a.agent");
  // Back behind the load, by the same input without the file.
  talk.ok("jump 1.8 s");
  const auto has_jumped = [&] {
    const Session::Report report = talk.session.report();
    return report.epoch > 1 && report.state == Session::State::paused && !report.target;
  };
  for (int i = 0; i < 2000 && !has_jumped(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(talk.session.report().tick, 180u);
  EXPECT_EQ(talk.ok("hash"), hash);
}

TEST(AgentCommands, WhatCannotBeLoadedIsOneErrorAndChangesNothing) {
  const test::TestFolder folder;
  const Console::Options options{.folder = folder.path.string()};
  {
    Talk semox(agents(2, "semox"), options);
    semox.ok("store rover1/controller semox.agent");
  }
  Talk talk(agents(2), options);
  talk.step(60);
  talk.ok("store rover1/controller sox.agent");
  const std::string hash = talk.ok("hash"), whole = file_text(folder.path / "sox.agent");
  const auto written = [&](const std::string& text) {
    std::ofstream(folder.path / "bad.agent", std::ios::binary) << text;
    return talk.refused("load rover1/controller bad.agent");
  };
  EXPECT_TRUE(has(written(whole.substr(0, whole.size() / 2)), "is damaged or incomplete"));
  EXPECT_TRUE(has(written(""), "is not a stored agent"));
  std::string forged = whole;
  forged[whole.size() / 2] ^= 1;
  EXPECT_TRUE(has(written(forged), "is damaged or incomplete"));
  forged = whole;
  forged[8] = 9;
  EXPECT_TRUE(has(written(forged), "has version 9"));
  EXPECT_TRUE(has(talk.refused("load rover1/controller semox.agent"), "holds semox behind one_to_one"));
  EXPECT_TRUE(has(talk.refused("load rover2/controller sox.agent"), "a program of kind 'wander'"));
  EXPECT_TRUE(has(talk.refused("load rover3/controller sox.agent"), "did you mean 'rover1/controller'"));
  EXPECT_TRUE(has(talk.refused("load rover1/controller none.agent"), "there is no file"));
  EXPECT_TRUE(has(talk.refused("load rover1/controller ../sox.agent"), "not within the run's folder"));
  EXPECT_TRUE(has(talk.refused("set rover1/controller.learned AAAA"), "learned"));
  std::ofstream(folder.path / "scenario.yaml") << "version: 1\n";
  EXPECT_TRUE(has(talk.refused("store rover1/controller scenario.yaml"), "is not a stored agent"));
  EXPECT_FALSE(talk.say("load rover1/controller sox.agent", false).ok) << "spectators";
  EXPECT_EQ(talk.ok("hash"), hash);
}

}  // namespace
}  // namespace sandlot
