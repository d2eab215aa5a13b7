/// Named values, events, logs and plots as a user meets them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "command.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string content(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string values_scenario(const std::string& more) {
  return "version: 1\nname: v\nphysics: planar\ntime: {step: 10 ms, stop: 2 s}\nrobots:\n  - name: rover\n   "
         " model: " +
         (std::filesystem::current_path() / "models/rover/model.sdf").string() +
         "\n    controller: wander\n" + more;
}

TEST(Values, EveryAddressThatInfoListsCanBeLogged) {
  const Printed listed = sandlot("info scenarios/indoor.yaml --values --json");
  ASSERT_EQ(listed.exit_code, 0) << listed.out;
  const auto values = nlohmann::json::parse(listed.out);
  ASSERT_GT(values.size(), 50u);
  std::string all;
  for (const auto& value : values)
    all += (all.empty() ? "" : ",") + value["address"].get<std::string>() +
           (value.contains("count") ? "[0]" : "");
  const TestFolder scratch;
  const Printed run = sandlot("run scenarios/indoor.yaml --duration 1s --log " + scratch.file("a.csv") +
                              " --log-rate '10 Hz' --log-values '" + all + "'");
  EXPECT_EQ(run.exit_code, 0) << run.out;
  std::istringstream lines(content(scratch.file("a.csv")));
  std::string line;
  std::size_t count = 0;
  while (std::getline(lines, line)) {
    ++count;
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), static_cast<std::ptrdiff_t>(values.size()));
  }
  EXPECT_EQ(count, 1u + 11u);  // names, then 0, 0.1 ... 1 s
  EXPECT_THAT(sandlot("info scenarios/indoor.yaml --values").out, HasSubstr("rover/laser.ranges[0.."));
}

TEST(Values, InfoListsOfEachStageOfNoiseItsOwnKeysOnly) {
  const TestFolder scratch;
  const Printed info = sandlot(
      "info --values " +
      scratch.write("s.yaml", values_scenario("    devices: {laser: {noise: [{gaussian: {std: 1 cm}}]}}\n")));
  EXPECT_THAT(info.out, HasSubstr("rover/laser.noise.stages[0].gaussian.std"));
  EXPECT_THAT(info.out, Not(HasSubstr("stages[0].drift")));
}

TEST(Values, LoggingAndStoppingFromOutsideChangeNoHash) {
  const TestFolder scratch;
  const auto plain = summary_of("scenarios/indoor.yaml --duration 3s");
  const auto watched = summary_of("scenarios/indoor.yaml --stop-when 'sim.time >= 3' --log " +
                                  scratch.file("x.csv") + " --log-values rover.pose.x,rover/laser.ranges[3]");
  ASSERT_FALSE(watched.contains("failed")) << watched["failed"];
  EXPECT_EQ(plain["state_hash"], watched["state_hash"]);
  EXPECT_EQ(watched["events"][0]["count"], 1);
  EXPECT_EQ(watched["events"][0]["first"], 3.0);
  EXPECT_THAT(watched["stopped"].get<std::string>(), HasSubstr("sim.time >= 3"));
}

TEST(Values, AScenarioNamesValuesWatchesAndLogs) {
  const TestFolder scratch;
  const std::string log = scratch.file("run.csv");
  const std::string file = scratch.write(
      "s.yaml",
      values_scenario("values:\n  half: sim.time / 2\n  quarter: half / 2\n"
                      "events:\n  - {name: quarter, when: quarter >= 0.25, for: 0.5 s, stop: true}\n"
                      "  - {name: never, when: half > 100}\n"
                      "log: {file: " +
                      log + ", rate: 2 Hz, values: [values.half, quarter * 4 - sim.time]}\n"));
  const auto s = summary_of(file);
  ASSERT_FALSE(s.contains("failed")) << s["failed"];
  EXPECT_EQ(s["end_time"], 1.5);  // a quarter of 1 s, held for 0.5 s
  EXPECT_EQ(s["events"][0]["name"], "quarter");
  EXPECT_EQ(s["events"][0]["first"], 1.5);
  EXPECT_EQ(s["events"][1]["count"], 0);
  EXPECT_EQ(content(log),
            "time,values.half,quarter * 4 - sim.time\n0,0,0\n0.5,0.25,0\n1,0.5,0\n1.5,0.75,0\n");
}

TEST(Values, AConditionThatIsNoNumberFailsTheRun) {
  const Printed run = sandlot(
      "run scenarios/indoor.yaml --duration 1s --stop-when '1 / (sim.tick - 50) > 2'");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, HasSubstr("a part of '1 / (sim.tick - 50) > 2' is not a finite number at 0.5 s"));
}

TEST(Values, AConditionThatIsNoNumberAtTheBeginningFailsTheRunToo) {
  const TestFolder scratch;
  const Printed run = sandlot("run " +
                              scratch.write("s.yaml",
                                            "version: 1\nname: s\nrobots: []\nevents: "
                                            "[{name: e, when: 1 / sim.time > 2}]\n") +
                              " --duration 1s");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, HasSubstr("s.yaml:4:"));
  EXPECT_THAT(run.out, HasSubstr("stopped    by an error"));
}

TEST(Values, WrongInputIsRefusedBeforeTheFirstTick) {
  const TestFolder scratch;
  const std::string old = scratch.write("old.csv", "precious\n");
  const auto refused = [](const std::string& arguments, const std::string& words) {
    const Printed run = sandlot("run scenarios/indoor.yaml --duration 1s " + arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments << run.out;
    EXPECT_THAT(run.out, HasSubstr(words)) << arguments;
  };
  refused("--stop-when 'rovr.pose.x > 3'", "did you mean 'rover'?");
  refused("--stop-when '1 +'", "column 4");
  refused("--log " + old + " --log-values rover.pose.q", "did you mean 'rover.pose.");
  refused("--log " + old, "--log-values");
  refused("--log-values sim.time", "--log FILE");
  refused("--log " + old + " --log-values sim.time --log-rate '1 kHz'", "above the tick rate");
  refused("--log /nowhere/x.csv --log-values sim.time", "cannot write the log");
  EXPECT_EQ(content(old), "precious\n");
  EXPECT_EQ(
      sandlot("run scenarios/indoor.yaml --duration 1s --log /dev/full --log-values sim.time").exit_code, 2);
}

TEST(Values, WhatARecordingDoesNotHoldIsNamed) {
  const TestFolder scratch;
  const std::string file = scratch.file("r.mcap"), out = scratch.file("out.csv");
  const Printed run = sandlot("run scenarios/indoor.yaml --duration 1s --record " + file +
                              " --record-topics '/rover/*' --record-topics /rover/lazer/ranges");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, HasSubstr("no topic to record fits '/rover/lazer/ranges'; did you mean"));
  EXPECT_THAT(run.out, Not(HasSubstr("fits '/rover/*'")));
  EXPECT_THAT(run.out, HasSubstr("recording  " + file + ": "));
  const auto exported = [&](const std::string& values) {
    return sandlot("topic export " + file + " --out " + out + " --values '" + values + "'");
  };
  EXPECT_EQ(exported("/rover/laser/ranges.ranges[99999]").exit_code, 0) << "lists may grow";
  EXPECT_EQ(exported("/rover/laser/ranges").exit_code, 0) << "all there is, times included";
  for (const char* wrong :
       {"rangs[3]", "ranges", "ranges[3].x", "header.frame_id", "header[0].stamp", "header.stamp.sec"}) {
    const Printed refused = exported(std::string("/rover/laser/ranges.") + wrong);
    EXPECT_EQ(refused.exit_code, 2) << wrong;
    EXPECT_THAT(refused.out, HasSubstr(std::string("have no number '") + wrong + "'"));
  }
  const Printed drawn = sandlot("plot " + file + " --out " + scratch.file("x.svg"));
  EXPECT_EQ(drawn.exit_code, 2);
  EXPECT_THAT(drawn.out, HasSubstr("topic export"));
}

TEST(Values, ALogBecomesAFigure) {
  const TestFolder scratch;
  const std::string csv = scratch.file("r.csv"), svg = scratch.file("r.svg");
  ASSERT_EQ(sandlot("run scenarios/indoor.yaml --duration 2s --log " + csv +
                    " --log-values rover.pose.x,rover.pose.y")
                .exit_code,
            0);
  const Printed drawn = sandlot("plot " + csv + " --y rover.pose.x,rover.pose.y --title Path --out " + svg);
  EXPECT_EQ(drawn.exit_code, 0) << drawn.out;
  EXPECT_THAT(content(svg), HasSubstr(">rover.pose.y<"));
  EXPECT_THAT(content(svg), HasSubstr("</svg>"));
  EXPECT_EQ(sandlot("plot " + csv + " --y rover.pose.w --out " + svg).exit_code, 2);
  EXPECT_EQ(sandlot("plot README.md --out " + svg).exit_code, 2);
  EXPECT_EQ(sandlot("plot " + csv + " --y-range 1,0 --out " + svg).exit_code, 2);
}

}  // namespace
}  // namespace sandlot::test
