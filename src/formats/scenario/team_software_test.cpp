/// Teams that bring their robots by a team.yaml.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "formats/scenario/scenario.h"

namespace sandlot::formats {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* scenario = R"(version: 1
vars: {side: foxes, wheels: 4, unused: 1, how: slow, levels: {slow: ideal, fast: contact}, level: "${levels[how]}"}
teams:
  - name: red
    software: ${side}
    players: 3
    starts: [[-3, 0, 0], [-1, 1, 0], [-1, -1, 90 deg]]
    vars: {color: cyan}
    robot:
      model: {builder: msl_robot, wheels: "${wheels}", number: "$${number}", color: "$${color}"}
      devices: {drive: {level: "$${level}"}}
robots:
  - {name: guest, model: rover}
)";

class TeamSoftwareFile : public testing::Test {
 protected:
  TeamSoftwareFile() {
    std::filesystem::create_directory(folder.file("foxes"));
    file = folder.write("s.yaml", scenario);
  }
  void write(const std::string& team) { team_file = folder.write("foxes/team.yaml", team); }
  Result<Scenario> read(std::vector<Override> overrides = {}) {
    Diagnostics diagnostics;
    return read_scenario(file, overrides, diagnostics);
  }
  std::string error_of(const std::string& team, std::vector<Override> overrides = {}) {
    write(team);
    const auto result = read(std::move(overrides));
    return result ? "" : result.error().text();
  }

  test::TestFolder folder;
  std::string file, team_file;
};

constexpr const char* foxes = R"(version: 1
name: Foxes
description: Sly.
vars: {pace: 2}
robots:
  - {controller: {kind: wander, speed: "${pace}"}}
  - {model: {mass: 20}, controllers: [{name: player, kind: wander, speed: "${number}"}, {name: at, kind: sequence, start: "${start}", of: "${team}"}]}
)";

TEST_F(TeamSoftwareFile, AddsItsRobotsToTheScenario) {
  write(foxes);
  const auto read_it = read();
  ASSERT_TRUE(read_it) << read_it.error().text();
  std::vector<std::string> names;
  for (const RobotGroup& robot : read_it->robots) names.push_back(robot.name + " of " + robot.instance.team);
  EXPECT_THAT(names, ElementsAre("guest of ", "red1 of red", "red2 of red", "red3 of red"));
  const RobotGroup &first = read_it->robots[1], &third = read_it->robots[3];
  EXPECT_EQ(first.placement.X_WM.p, (Vec3{-3, 0, 0}));
  EXPECT_EQ(third.placement.X_WM.p, (Vec3{-1, -1, 0}));
  // The scenario's keys, those of team.yaml upon them; variables of both, and the robot's own.
  EXPECT_EQ(first.builder.find("number")->text(), "1");
  EXPECT_EQ(first.builder.find("wheels")->text(), "4");
  EXPECT_EQ(first.builder.find("mass"), nullptr);
  EXPECT_EQ(third.builder.find("number")->text(), "3");
  EXPECT_EQ(third.builder.find("color")->text(), "cyan");
  EXPECT_EQ(third.builder.find("mass")->text(), "20");
  EXPECT_EQ(third.devices.find("drive")->find("level")->text(), "ideal");
  EXPECT_EQ(first.instance.controllers.get()[0].config.find("speed")->text(), "2");
  const auto& programs = third.instance.controllers.get();
  ASSERT_EQ(programs.size(), 2u);
  EXPECT_EQ(programs[0].config.find("speed")->text(), "3");
  EXPECT_EQ(programs[1].config.find("start")->items()[2].text(), "90 deg");
  EXPECT_EQ(programs[1].config.find("of")->text(), "red");
  // What it says stands in its own file: programs start there, errors name it.
  EXPECT_EQ(base_folder(*read_it, programs[0].place), folder.file("foxes"));
  ASSERT_EQ(read_it->unused_vars.size(), 1u) << "level is used by the team's robots";
  EXPECT_EQ(read_it->unused_vars[0].first, "unused");
}

/// A variable of the team goes before the scenario's of that name, also where another one of the scenario chooses by it.
TEST_F(TeamSoftwareFile, ChoosesByItsOwnVariables) {
  write(foxes);
  const auto fast = read({{"teams[0].vars.how", "fast"}});
  ASSERT_TRUE(fast) << fast.error().text();
  EXPECT_EQ(fast->robots[1].devices.find("drive")->find("level")->text(), "contact");
}

/// One device of team.yaml leaves the others as they are, although the scenario gives all of them by one variable.
TEST_F(TeamSoftwareFile, ChangesOneOfTheDevicesThatAVariableGives) {
  file = folder.write("s.yaml", R"(version: 1
vars: {all: {drive: {level: ideal}, eye: {kind: camera}}}
teams:
  - {name: red, software: foxes, players: 2, starts: [[0, 0, 0], [1, 0, 0]], robot: {model: rover, devices: "$${all}"}}
)");
  write("version: 1\nname: A\nrobots: [{controller: wander}, {devices: {drive: {level: contact}}}]\n");
  const auto team = read();
  ASSERT_TRUE(team) << team.error().text();
  ASSERT_EQ(team->robots.size(), 2u);
  for (const std::size_t i : {0u, 1u}) {
    const Node& devices = team->robots[i].devices;
    ASSERT_TRUE(devices.find("eye")) << team->robots[i].name;
    EXPECT_EQ(devices.find("eye")->find("kind")->text(), "camera");
    EXPECT_EQ(devices.find("drive")->find("level")->text(), i == 0 ? "ideal" : "contact");
  }
}

TEST_F(TeamSoftwareFile, MayBringFewerRobots) {
  write("version: 1\nname: Two\nplayers: 2\nrobots: [{controller: wander}]\n");
  const auto two = read();
  ASSERT_TRUE(two) << two.error().text();
  EXPECT_EQ(two->robots.size(), 3u);
}

TEST_F(TeamSoftwareFile, ErrorsNameTheFileAndTheKey) {
  EXPECT_THAT(error_of(foxes, {{"vars.side", "wolves"}}),
              testing::AllOf(HasSubstr("--set vars.side=wolves"), HasSubstr("there is no team in '"),
                             HasSubstr("a team.yaml")));
  EXPECT_THAT(error_of("version: 1\nrobots: [{}]\n"), HasSubstr("team.yaml:1"));
  EXPECT_THAT(error_of("version: 1\nname: A\nrobot: [{}]\n"), HasSubstr("did you mean 'robots'?"));
  EXPECT_THAT(error_of("version: 1\nname: A\nrobots: []\n"), HasSubstr("expected a list of robots"));
  EXPECT_THAT(error_of("version: 1\nname: A\nrobots: [3]\n"), HasSubstr("a robot is a map of keys"));
  EXPECT_THAT(error_of("version: 1\nname: A\nrobots:\n  - {pose: [0, 0, 0]}\n"),
              testing::AllOf(HasSubstr("team.yaml:4:12"), HasSubstr("is given by the scenario")));
  EXPECT_THAT(error_of("version: 1\nname: A\nrobots:\n  - {contoller: wander}\n"),
              testing::AllOf(HasSubstr("team.yaml:4"), HasSubstr("did you mean 'controller'?")));
  EXPECT_THAT(error_of("version: 1\nname: A\nplayers: 7\nrobots: [{controller: wander}]\n"),
              HasSubstr("the team brings 7 robots, and 3 may play"));
  EXPECT_THAT(error_of("version: 1\nname: A\nrobots: [{}, {}, {}, {}]\n"),
              testing::AllOf(HasSubstr("team.yaml:3:22"), HasSubstr("brings 4 robots")));
  EXPECT_THAT(error_of("version: 1\nname: A\nrobots: [{controller: \"${none}\"}]\n"),
              testing::AllOf(HasSubstr("team.yaml:3"), HasSubstr("no variable 'none'")));
  EXPECT_THAT(error_of(foxes, {{"teams[0].players", "5"}}), HasSubstr("there are 3 poses for 5 players"));
  EXPECT_THAT(error_of("- a\n"), HasSubstr("a map of keys"));
}

TEST_F(TeamSoftwareFile, SaysWhatTheTeamIsCalled) {
  write(foxes);
  const auto software = read_team_software(folder.file("foxes"));
  ASSERT_TRUE(software) << software.error().text();
  EXPECT_EQ(software->name, "Foxes");
  EXPECT_EQ(software->description, "Sly.");
  EXPECT_FALSE(read_team_software(folder.file("wolves")));
}

}  // namespace
}  // namespace sandlot::formats
