/// Agents as a user watches them: logs, figures of logs, stored agents in scripts, recordings and replays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "command.h"
#include "selforg/log_file.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

/// Two rovers with agents. `more` are further keys of the first one's controller.
std::string watch_scenario(const TestFolder& folder, const std::string& more = "",
                           const std::string& name = "s.yaml") {
  std::string text =
      "version: 1\nname: agents\nphysics: planar\ntime: {step: 10 ms, control_interval: 2, stop: 2 "
      "s}\nrobots:\n";
  for (const char* robot : {"one", "two"}) {
    const bool first = std::string(robot) == "one";
    text += std::string("  - name: ") + robot +
            "\n    model: " + std::filesystem::absolute("models").string() + "/rover\n    pose: [" +
            (first ? "0" : "2") + ", 0, 0]\n    controller:\n      kind: selforg\n" + (first ? more : "") +
            "      sensors:\n"
            "        - {device: drive, value: twist.twist.linear.x, min: -0.5, max: 0.5}\n"
            "        - {device: drive, value: twist.twist.angular.z, min: -2, max: 2}\n"
            "      motors:\n"
            "        - {device: drive, value: linear.x, min: -0.5, max: 0.5}\n"
            "        - {device: drive, value: angular.z, min: -2, max: 2}\n";
  }
  return folder.write(name, text);
}

TEST(SelfOrgWatch, ALogOfAnAgentIsReadByPlotAndByTheLibrary) {
  TestFolder folder;
  const std::string file = watch_scenario(folder), log = folder.file("one.log"), hash = "state_hash";
  const std::string set = " --command 'at 1s set one/controller.parameters.epsC 0.3'";
  const auto with = summary_of(file + set + " --agent-log one/controller=" + log);
  ASSERT_FALSE(with.contains("failed")) << with.dump(2);
  EXPECT_EQ(with[hash], summary_of(file + set)[hash]) << "looking changes nothing";
  auto table = selforg::read_log(log);
  ASSERT_TRUE(static_cast<bool>(table)) << table.error().text();
  // 2 s with a control step each 20 ms and one at the beginning: 101 steps, every fifth is logged.
  ASSERT_EQ(table->rows.size(), 21u);
  EXPECT_EQ(table->columns[0], "t");
  EXPECT_EQ(table->rows[0][0], 0);
  EXPECT_NEAR(table->rows[20][0], 2, 1e-9);
  for (const char* name : {"x[0]", "y[1]", "A[0,1]", "C[1,0]", "xi[0]", "x_R[1]", "y_R[0]", "E"})
    EXPECT_NE(std::find(table->columns.begin(), table->columns.end(), name), table->columns.end()) << name;
  const auto has = [&](std::string_view line) {
    return std::find(table->comments.begin(), table->comments.end(), line) != table->comments.end();
  };
  EXPECT_TRUE(has("#IN sox") && has("# epsC= 0.1") && has("# parameters.epsC=0.3"));

  const Printed drawn = sandlot("plot " + log + " --y 'C[0,0],A*' --out " + folder.file("f.svg"));
  ASSERT_EQ(drawn.exit_code, 0) << drawn.out;
  const std::string svg = folder.read("f.svg");
  for (const char* label : {"C[0,0]", "A[0,0]", "A[1,1]", "time"}) EXPECT_THAT(svg, HasSubstr(label));
  EXPECT_THAT(sandlot("plot " + log + " --y Q --out " + folder.file("f.svg")).out,
              HasSubstr("there is no column 'Q'"));
}

TEST(SelfOrgWatch, AScenarioLogsTheValuesThatItNames) {
  TestFolder folder;
  const std::string log = folder.file("one.log");
  const std::string file = watch_scenario(
      folder, "      log: {file: " + log + ", interval: 10, values: ['C[*', '-C[1*']}\n");
  const auto summary = summary_of(file);
  ASSERT_FALSE(summary.contains("failed")) << summary.dump(2);
  auto table = selforg::read_log(log);
  ASSERT_TRUE(static_cast<bool>(table)) << table.error().text();
  EXPECT_EQ(table->columns, (std::vector<std::string>{"t", "C[0,0]", "C[0,1]"}));
  EXPECT_EQ(table->rows.size(), 11u);
  EXPECT_EQ(sandlot("run " + file + " --repeat 2").exit_code, 2) << "one file, two runs";
}

TEST(SelfOrgWatch, WrongLogsAreRefusedBeforeAnythingIsReplaced) {
  TestFolder folder;
  const std::string file = watch_scenario(folder), log = folder.write("keep.log", "mine");
  for (const auto& [option, why] :
       {std::pair{"rover=", "there is no agent 'rover'"}, std::pair{"", "there are 2 agents"},
        std::pair{"one/laser=", "there is no agent 'one/laser'"}}) {
    const Printed run = sandlot("run " + file + " --headless --agent-log " + option + log);
    EXPECT_EQ(run.exit_code, 2) << run.out;
    EXPECT_THAT(run.out, HasSubstr(why));
  }
  EXPECT_EQ(folder.read("keep.log"), "mine");
  EXPECT_EQ(sandlot("run " + file + " --headless --agent-log one=/nowhere/x.log").exit_code, 2);
  folder.write("bad.log", "# Start date: -\n#C t a\n0 1\n1 x\n");
  const Printed plot = sandlot("plot " + folder.file("bad.log") + " --out " + folder.file("f.svg"));
  EXPECT_EQ(plot.exit_code, 2);
  EXPECT_THAT(plot.out, HasSubstr("bad.log:4: 'x' is not a number"));
}

TEST(SelfOrgWatch, WhatAScriptLoadsIsRecordedAndReplayedWithoutTheFile) {
  TestFolder folder;
  const std::string file = watch_scenario(folder), here = "cd " + folder.path.string() + " && ";
  const std::string sandlot_bin = std::filesystem::absolute(SANDLOT_BIN).string();
  const auto run = [&](const std::string& arguments) { return shell(here + sandlot_bin + " " + arguments); };
  const Printed stored = run("run " + file +
                             " --headless --command 'at 1.5s store one/controller skill.agent'");
  ASSERT_EQ(stored.exit_code, 0) << stored.out;
  const std::string loading = "run " + file +
                              " --headless --seed 9 --command 'at 0.5s load two/controller skill.agent'";
  const Printed recorded = run(loading + " --record r.mcap --summary s.json");
  ASSERT_EQ(recorded.exit_code, 0) << recorded.out;
  const auto summary = read_json(folder.file("s.json"));
  ASSERT_EQ(run("run " + file + " --headless --seed 9 --summary plain.json").exit_code, 0);
  EXPECT_NE(read_json(folder.file("plain.json"))["state_hash"], summary["state_hash"]) << "it did load";
  ASSERT_EQ(run(loading + " --threads 2 --summary again.json").exit_code, 0);
  EXPECT_EQ(read_json(folder.file("again.json"))["state_hash"], summary["state_hash"]);
  std::filesystem::remove(folder.path / "skill.agent");
  const auto replay = nlohmann::json::parse(run("replay r.mcap --verify --json --recompute").out, nullptr,
                                            false);
  EXPECT_EQ(replay["verified"], true) << replay.dump(2);
  EXPECT_EQ(replay["state_hash"], summary["state_hash"]);
  // A script that names a file that is not there ends the run when its time comes, with the reason.
  const Printed missing = run(loading);
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.out, HasSubstr("there is no file"));
}

}  // namespace
}  // namespace sandlot::test
