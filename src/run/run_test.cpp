/// Runs in process, as a study does them.
#include "run/run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/atomic_file.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class RunTest : public testing::Test {
 protected:
  RunTest() {
    const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
    folder = testing::TempDir() + "run_test_" + test->name() + "/";
    fs::remove_all(folder);
    fs::create_directories(folder);
    EXPECT_TRUE(write_file(folder + "drive.yaml", R"(
version: 1
name: drive
physics: planar
time: {step: 10 ms}
robots:
  - name: rover
    model: rover
    controller: {kind: sequence, steps: [{at: 0 s, orders: {drive: [0.5, 0, 0]}}]}
)"));
    EXPECT_TRUE(write_file(folder + "stand.yaml",
                           "version: 1\nphysics: planar\ntime: {step: 10 ms}\nrobots:\n"
                           "  - {name: rover, model: rover}\n"));
  }
  ~RunTest() override { fs::remove_all(folder); }

  /// Result of a run that is not refused.
  static Summary summary_of(const RunSpec& spec, const RunCallbacks& callbacks = {}) {
    auto summary = run(spec, callbacks);
    EXPECT_TRUE(summary) << summary.error().text();
    return summary ? std::move(*summary) : Summary();
  }
  static std::string refusal(const RunSpec& spec, const RunCallbacks& callbacks = {}) {
    const auto summary = run(spec, callbacks);
    return summary ? "" : summary.error().text();
  }
  static std::string content_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::string folder;
};

TEST_F(RunTest, ARobotThatAcceleratesIsWhereTheFormulaSays) {
  const Summary s = summary_of({.file = folder + "drive.yaml", .duration_s = 1});
  EXPECT_EQ(s.ticks, 100u);
  EXPECT_DOUBLE_EQ(s.sim_s, 1);
  EXPECT_EQ(s.name, "drive");
  EXPECT_EQ(s.physics, "planar");
  EXPECT_THAT(s.errors, IsEmpty());
  ASSERT_EQ(s.robots.size(), 1u);
  // 0.5 s at 1 m/s^2, then 0.5 s at 0.5 m/s: 0.375 m. The controller's order acts one tick late (5 mm), the
  // ramp is off by half a step of speed (2.5 mm), the distance is rounded to 1 mm.
  EXPECT_NEAR((*s.robots[0].pose)[0], 0.375, 0.0081);
  EXPECT_NEAR(s.robots[0].distance_m, (*s.robots[0].pose)[0], 0.0005001);
  EXPECT_NEAR(s.robots[0].extent_m[1], 0, 1e-9);
}

TEST_F(RunTest, AStopConditionEndsTheRunAtItsTime) {
  const Summary s = summary_of(
      {.file = folder + "drive.yaml", .duration_s = 10, .stop_when = "rover.pose.x > 0.2"});
  // 0.125 m at 0.5 s, then 0.075 m at 0.5 m/s: 0.65 s, one tick late by the controller, one by the ramp, one
  // by judging at ticks.
  EXPECT_NEAR(s.end_s, 0.65, 0.0301);
  EXPECT_GT((*s.robots[0].pose)[0], 0.2);
  EXPECT_LE((*s.robots[0].pose)[0], 0.2051);
  ASSERT_EQ(s.events.size(), 1u);
  EXPECT_EQ(s.events[0].count, 1u);
  EXPECT_EQ(s.events[0].first_s, s.end_s);
  EXPECT_NE(s.stopped, "");
}

TEST_F(RunTest, ConsoleLinesAreInputOfTheRun) {
  std::vector<std::string> answers;
  const Summary s = summary_of(
      {.file = folder + "stand.yaml", .commands = {"at 50ms pose rover 3 4"}, .duration_s = 0.1},
      {.on_answer = [&](const std::string& answer) { answers.push_back(answer); }});
  ASSERT_EQ(s.robots.size(), 1u);
  EXPECT_NEAR(s.robots[0].distance_m, 5, 1e-9);
  EXPECT_NEAR(s.robots[0].covered_m2, 2 * 0.25, 1e-12) << "the cells of 0.5 m at its two places";
  EXPECT_NEAR((*s.robots[0].pose)[0], 3, 1e-9);
  EXPECT_EQ(answers.size(), 1u);
}

TEST_F(RunTest, TheSeedDecidesAndRunsDoNotDisturbEachOther) {
  const auto hash = [](std::uint64_t seed) {
    return summary_of({.file = "scenarios/indoor.yaml", .seed = seed, .duration_s = 0.5}).state_hash.value;
  };
  const std::uint64_t first = hash(1), second = hash(2);
  EXPECT_NE(first, second);
  EXPECT_EQ(hash(1), first) << "one after the other";
  std::uint64_t beside_1 = 0, beside_2 = 0;
  std::thread other([&] { beside_1 = hash(1); });
  beside_2 = hash(2);
  other.join();
  EXPECT_EQ(beside_1, first) << "at the same time";
  EXPECT_EQ(beside_2, second);
}

TEST_F(RunTest, WritesItsResults) {
  RunSpec spec{.file = folder + "drive.yaml",
               .duration_s = 0.2,
               .summary_file = folder + "s.json",
               .drawing_file = folder + "d.svg",
               .log_file = folder + "l.csv",
               .log_values = {"rover.pose.x"},
               .record_file = folder + "r.mcap"};
  spec.snapshots.file = folder + "half.snapshot";
  const Summary s = summary_of(spec);
  EXPECT_THAT(s.errors, IsEmpty());
  const auto json = nlohmann::ordered_json::parse(content_of(folder + "s.json"));
  EXPECT_EQ(json["state_hash"], hash_text(s.state_hash.value));
  EXPECT_EQ(json["robots"][0]["name"], "rover");
  EXPECT_EQ(json["recording"]["complete"], true);
  EXPECT_THAT(content_of(folder + "d.svg"), HasSubstr("<svg"));
  EXPECT_THAT(content_of(folder + "l.csv"), HasSubstr("rover.pose.x"));
  ASSERT_TRUE(s.recording);
  EXPECT_EQ(s.recording->bytes, fs::file_size(folder + "r.mcap"));

  const Summary rest = summary_of({.from_file = folder + "half.snapshot", .duration_s = 0.3});
  const Summary whole = summary_of({.file = folder + "drive.yaml", .duration_s = 0.5});
  EXPECT_EQ(rest.state_hash, whole.state_hash);
  EXPECT_EQ(rest.ticks, 30u);
  EXPECT_EQ(rest.end_tick, 50u);
}

TEST_F(RunTest, TheCallerMayEndIt) {
  int ticks = 0;
  const Summary s = summary_of({.file = folder + "stand.yaml", .may_be_endless = true},
                               {.keep_going = [&](const Simulation&) { return ++ticks < 7; }});
  EXPECT_EQ(s.ticks, 7u);
  EXPECT_EQ(s.stopped, "");
  EXPECT_THAT(s.warnings, IsEmpty());
}

TEST_F(RunTest, WarningsAreReportedAndKept) {
  std::vector<std::string> warnings;
  const Summary s = summary_of({.file = folder + "stand.yaml"},
                               {.on_warning = [&](const Error& w) { warnings.push_back(w.text()); },
                                .keep_going = [](const Simulation&) { return false; }});
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("the run has no end")));
  EXPECT_EQ(s.warnings, warnings);
}

TEST_F(RunTest, ARefusedRunLeavesNothing) {
  const std::string file = folder + "stand.yaml";
  EXPECT_THAT(refusal({}), HasSubstr("either a file or --from"));
  EXPECT_THAT(refusal({.file = folder + "none.yaml", .duration_s = 1}), HasSubstr("none.yaml"));
  EXPECT_THAT(refusal({.from_file = file}), HasSubstr("not a Sandlot snapshot"));
  EXPECT_THAT(refusal({.from_file = file, .seed = 1}), HasSubstr("cannot change a run that has begun"));
  EXPECT_THAT(refusal({.file = file, .duration_s = -1}), HasSubstr("--duration"));
  EXPECT_THAT(refusal({.file = file, .rate = 0.0}), HasSubstr("--rate"));
  EXPECT_THAT(refusal({.file = file, .commands = {"at 1s fly"}}), HasSubstr("fly"));
  EXPECT_THAT(refusal({.file = file, .summary_file = file}), HasSubstr("overwrite the scenario"));
  EXPECT_THAT(refusal({.file = file, .log_file = folder + "l.csv"}), HasSubstr("--log-values"));
  EXPECT_THAT(refusal({.file = file, .record_topics = {"/clock"}}), HasSubstr("add --record FILE"));
  EXPECT_THAT(refusal({.file = file, .record_file = folder + "r.mcap", .record_compression = "zip"}),
              HasSubstr("known are: none, lz4, zstd"));
  EXPECT_THAT(refusal({.file = file, .record_file = folder + "r.mcap"},
                      {.on_ready = [](const RunParts&) -> Status { return Error{"no port"}; }}),
              HasSubstr("no port"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 2) << "only the scenarios";
}

TEST_F(RunTest, WhatGoesWrongOnTheWayIsInTheSummary) {
  const Summary paused = summary_of(
      {.file = folder + "stand.yaml", .commands = {"at 50ms pause"}, .duration_s = 1});
  EXPECT_THAT(paused.errors, ElementsAre(HasSubstr("nobody can let it go on")));
  EXPECT_LT(paused.ticks, 10u);
  const Summary unwritten = summary_of(
      {.file = folder + "stand.yaml", .duration_s = 0.05, .summary_file = "/dev/full"});
  EXPECT_THAT(unwritten.errors, ElementsAre(HasSubstr("cannot write '/dev/full'")));
  EXPECT_EQ(unwritten.ticks, 5u);
}

TEST_F(RunTest, IsJudgedByItsCriteria) {
  const auto judged = [&](const std::string& criteria) {
    EXPECT_TRUE(write_file(folder + "judged.yaml",
                           "version: 1\nphysics: planar\ntime: {step: 10 ms}\nrobots:\n"
                           "  - {name: red1, model: rover, team: red, pose: [2, 0, 0]}\n"
                           "  - {name: red2, model: rover, team: red, pose: [4, 0, 0]}\n"
                           "  - {name: blue1, model: rover, team: blue, pose: [8, 0, 0]}\n" +
                               criteria));
    return summary_of({.file = folder + "judged.yaml", .duration_s = 0.05});
  };
  const Summary s = judged(R"(
values: {reds: mean(red*.pose.x)}
criterion: {value: reds + blue1.pose.x, success: reds > 7}
teams:
  - {name: red, criterion: count(red*.pose.x > 3)}
  - {name: blue, criterion: {value: max(blue*.pose.x), success: any(blue*.pose.x > 7)}}
events: [{name: early, when: red.criterion > 0 and criterion > 10 and sim.time > 15 ms, once: true}]
)");
  EXPECT_EQ(s.criterion, 11);
  EXPECT_EQ(s.success, false);
  ASSERT_EQ(s.criteria.size(), 2u);
  EXPECT_EQ(s.criteria[0].name, "red");
  EXPECT_EQ(s.criteria[0].value.value, 1);
  EXPECT_EQ(s.criteria[0].value.success, std::nullopt);
  EXPECT_EQ(s.criteria[1].value.value, 8);
  EXPECT_EQ(s.criteria[1].value.success, true);
  ASSERT_EQ(s.events.size(), 1u);
  EXPECT_EQ(s.events[0].first_s, 0.02);
  EXPECT_THAT(as_text(s),
              HasSubstr("criterion  11, no success\ncriterion  red: 1\ncriterion  blue: 8, success\n"));
  EXPECT_EQ(as_json(s)["criteria"]["red"].dump(), R"({"value":1.0,"success":null})");

  // What has no value at the end, and what is no number, keep the rest of the result.
  const Summary empty = judged("criterion: mean(red*.pose.x where red*.pose.x > 5)\n");
  EXPECT_EQ(empty.criterion, std::nullopt);
  EXPECT_THAT(empty.errors, IsEmpty());
  const Summary broken = judged("criterion: 1 / (red1.pose.x - 2)\n");
  EXPECT_EQ(broken.criterion, std::nullopt);
  EXPECT_EQ(broken.ticks, 5u);
  EXPECT_THAT(broken.errors,
              ElementsAre(HasSubstr(
                  "judged.yaml:8:12: criterion: '1 / (red1.pose.x - 2)' is not a finite number at 0.05 s")));
}

TEST_F(RunTest, CriteriaThatCannotBeReadAreRefusedWithTheirPlace) {
  const std::pair<const char*, const char*> expected[] = {
      {"criterion: mean(rad*.pose.x)",
       "bad.yaml:5:12: expression 'mean(rad*.pose.x)', column 6: nothing is called 'rad*'"},
      {"criterion: criterion + 1", "values and criteria cannot use a criterion"},
      {"criterion: 1 / 0", "is it a division by 0?"},
      {"criterion: {success: 1}", "'value' is missing"},
      {"criterion: {value: 1, succes: 1}", "did you mean 'success'?"},
      {"criterion: [1]", "expected an expression"},
      {"criterion: {value: 1, success: rover.x}", "bad.yaml:5:32: expression 'rover.x'"},
      {"criterion: 1\nvalues: {criterion: 2}", "'criterion' cannot be the name of a value"},
      {"teams: [{name: red, criterion: blue.criterion}]", "bad.yaml:5:32: expression 'blue.criterion'"},
      {"teams: [{name: red}, {name: blue, criterion: 1}]",
       "/teams/1: no robot is in team 'blue'; name it: team: blue"},
  };
  for (const auto& [lines, words] : expected) {
    ASSERT_TRUE(write_file(
        folder + "bad.yaml",
        std::string("version: 1\nphysics: planar\nrobots:\n  - {name: rover, model: rover, team: red}\n") +
            lines + "\n"));
    EXPECT_THAT(refusal({.file = folder + "bad.yaml", .duration_s = 0.01}), HasSubstr(words)) << lines;
  }
}

TEST(Run, ThatCannotBeginLetsGoOfTheSessionBeforeItEnds) {
  // The recording is opened last: whoever serves the run has begun by then.
  int ready = 0, ended = 0;
  const RunCallbacks callbacks{.on_ready = [&](const RunParts&) -> Status { return ++ready, Status(); },
                               .on_end = [&](Summary&) { ++ended; }};
  const auto refused = run(
      {.file = "scenarios/indoor.yaml", .duration_s = 0.01, .record_file = "/nonexistent/run.mcap"},
      callbacks);
  EXPECT_FALSE(refused);
  EXPECT_EQ(ready, 1);
  EXPECT_EQ(ended, 1);
}

TEST(Summary, HasTheKeysThatPeopleParseInTheirOrder) {
  Summary s;
  const auto keys = [](const nlohmann::ordered_json& json) {
    std::string out;
    for (const auto& [key, value] : json.items()) out += (out.empty() ? "" : " ") + key;
    return out;
  };
  const std::string always =
      "name physics seed ticks sim_seconds wall_seconds real_time_factor late_ticks phase_us end_tick "
      "end_time stopped "
      "state_hash sub_hashes profile robots engine refused_commands refused_by_device events criterion "
      "success "
      "criteria teams "
      "warnings errors";
  EXPECT_EQ(keys(as_json(s)), always + " clients");
  s.video = {"a.mp4", 3};
  s.recording.emplace();
  s.server.emplace();
  EXPECT_EQ(keys(as_json(s)), always + " video recording server clients");
  s.refbox = {.address = "127.0.0.1:28097", .teams = {{.team = "cyan", .protocol = "2009", .words = 3}}};
  EXPECT_EQ(keys(as_json(s)), always + " video recording server clients refbox");
  EXPECT_EQ(as_json(s)["refbox"]["teams"][0]["words"], 3);
  EXPECT_THAT(as_text(s), HasSubstr("refbox     cyan: 0 connections (2009), 3 words"));
  EXPECT_EQ(keys(as_json(s)["recording"]), "file messages bytes dropped_messages lost_ticks complete");
  EXPECT_EQ(keys(as_json(s)["server"]), "viewers_most refused dropped");
  EXPECT_EQ(as_json(s)["criterion"], nullptr);
  EXPECT_EQ(as_json(s)["teams"], nlohmann::ordered_json::object());
  s.robots.push_back({.name = "rover", .joints = {{"wheel", 0.5}}});
  s.events.push_back({.name = "far"});
  s.state_hash = {0xab};
  const auto json = as_json(s);
  EXPECT_EQ(keys(json["robots"][0]), "name distance_m extent_m covered_m2 pose joints");
  EXPECT_EQ(json["robots"][0]["pose"], nullptr);
  EXPECT_EQ(json["robots"][0]["joints"].dump(), R"({"wheel":0.5})");
  EXPECT_EQ(json["events"][0].dump(), R"({"name":"far","count":0,"first":null,"last":null})");
  EXPECT_EQ(json["state_hash"], "00000000000000ab");
}

}  // namespace
}  // namespace sandlot
