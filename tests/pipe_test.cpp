/// A program in a process of its own, as a user meets it: run, recorded, replayed, continued.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>

#include "command.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

/// Drives at 0.3 m/s, and counts its starts in a file beside it.
constexpr const char* brain = R"(import json, sys
open('starts', 'a').write('started\n')
sys.stdin.readline()
for line in sys.stdin:
    print(json.dumps({'orders': {'drive': {'linear': {'x': 0.3}}}}), flush=True)
)";

std::string scenario(const TestFolder& folder, const std::string& controller) {
  folder.write("brain.py", brain);
  return folder.write(
      "s.yaml",
      "version: 1\nname: piped\nphysics: planar\n"
      "time: {step: 10 ms, control_interval: 10, stop: 2 s}\nrobots:\n  - name: rover\n    model: " +
          fs::absolute("models/rover").string() + "\n    controller: {kind: pipe, " + controller + "}\n");
}

std::size_t starts(const TestFolder& folder) {
  const std::string text = folder.read("starts");
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(Pipe, ARunIsRecordedAndReplayedWithoutTheProcess) {
  const TestFolder folder;
  const std::string file = scenario(folder, "command: [python3, brain.py], deadline: 20 s");
  const std::string recording = folder.file("r.mcap");
  const auto run = summary_of(file + " --record " + recording);
  ASSERT_FALSE(run.contains("failed")) << run["failed"];
  // From 0.01 s on at 1 m/s^2 to 0.3 m/s: 0.3 * 1.99 - 0.3^2 / 2 m.
  EXPECT_NEAR(run["robots"][0]["pose"][0].get<double>(), 0.3 * 1.99 - 0.045, 0.005);
  EXPECT_EQ(starts(folder), 1u);
  fs::rename(folder.file("brain.py"), folder.file("away.py"));
  for (const char* way : {"--recompute", "--recompute --threads 4", "--logged --threads 2"}) {
    const Printed printed = sandlot("replay " + recording + " --verify --json " + way);
    const auto replay = nlohmann::json::parse(printed.out, nullptr, false);
    EXPECT_EQ(replay["verified"], true) << way << "\n" << printed.out;
  }
  EXPECT_EQ(starts(folder), 1u);
}

TEST(Pipe, ASnapshotStartsNothingUnlessItIsAllowed) {
  const TestFolder folder;
  const std::string file = scenario(folder, "command: [python3, brain.py], deadline: 20 s");
  const std::string half = folder.file("half.snapshot");
  const Printed first = sandlot("run " + file + " --headless --snapshot " + half + " --snapshot-at 1s");
  ASSERT_EQ(first.exit_code, 0) << first.out;
  EXPECT_EQ(starts(folder), 1u);
  const Printed quiet = sandlot("run --headless --from " + half + " --duration 1s");
  EXPECT_EQ(quiet.exit_code, 0) << quiet.out;
  EXPECT_THAT(
      quiet.out,
      HasSubstr("program 'rover/controller' (pipe) gives no orders: this run may not start programs"));
  EXPECT_EQ(starts(folder), 1u);
  const Printed allowed = sandlot("run --headless --allow-programs --from " + half + " --duration 1s");
  EXPECT_EQ(allowed.exit_code, 0) << allowed.out;
  EXPECT_EQ(starts(folder), 2u);
  for (const char* verb : {"check ", "info "})
    EXPECT_THAT(sandlot(verb + file).out, Not(HasSubstr("gives no orders")));
  EXPECT_EQ(starts(folder), 2u);
  EXPECT_EQ(sandlot("run --headless --allow-programs " + file).exit_code, 2);
}

TEST(Pipe, AScenarioMayBeNamedWithoutItsFolder) {
  const TestFolder folder;
  scenario(folder, "command: [python3, brain.py], deadline: 20 s");
  const std::string from_there = "cd " + folder.path.string() + " && " + fs::absolute(SANDLOT_BIN).string() +
                                 " ";
  const Printed checked = shell(from_there + "check s.yaml");
  EXPECT_EQ(checked.exit_code, 0) << checked.out;
  EXPECT_THAT(checked.out, HasSubstr("s.yaml: ok"));
  const Printed run = shell(from_there + "run s.yaml --headless");
  EXPECT_EQ(run.exit_code, 0) << run.out;
  EXPECT_EQ(starts(folder), 1u);
}

TEST(Pipe, AProcessThatHangsDelaysTheRunByItsDeadlinesOnly) {
  const TestFolder folder;
  const std::string file = scenario(folder, "command: [sleep, '1000'], deadline: 20 ms");
  const auto begin = std::chrono::steady_clock::now();
  const auto run = summary_of(file);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  ASSERT_FALSE(run.contains("failed")) << run["failed"];
  EXPECT_LT(took.count(), 10);  // 21 control steps of 20 ms, and a program that starts
  EXPECT_NEAR(run["robots"][0]["pose"][0].get<double>(), 0, 1e-9);
}

TEST(Pipe, ErrorsReachTheUser) {
  const TestFolder folder;
  const auto run = [&](const std::string& controller) {
    return sandlot("run --headless " + scenario(folder, controller));
  };
  const Printed ended = run("command: [sh, -c, 'echo no brain >&2; exit 3'], on_miss: end");
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.out, HasSubstr("rover/controller: no brain"));
  EXPECT_THAT(ended.out,
              HasSubstr("the process is gone: it has ended; last line of its standard error: no brain"));
  const Printed wrong = run("command: [sh, -c, 'read a; read b; echo {}; read c; echo nonsense; sleep 9']");
  EXPECT_EQ(wrong.exit_code, 1);
  EXPECT_THAT(wrong.out,
              HasSubstr("program 'rover/controller' (pipe) failed at 0.1 s: the answer is not JSON"));
  const Printed missing = run("command: [no-such-brain]");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.out, HasSubstr("s.yaml:8:17: cannot start 'no-such-brain': there is no such program"));
  EXPECT_EQ(run("command: []").exit_code, 2);
  EXPECT_THAT(run("comand: [cat]").out, HasSubstr("did you mean 'command'?"));
}

TEST(Formation, TheScenarioFormsAndEndsByItself) {
  const auto one = summary_of("scenarios/formation.yaml");
  ASSERT_FALSE(one.contains("failed")) << one["failed"];
  EXPECT_LT(one["sim_seconds"].get<double>(), 60);
  const TestFolder folder;
  const std::string recording = folder.file("r.mcap");
  const auto two = summary_of("scenarios/formation.yaml --threads 4 --record " + recording);
  EXPECT_EQ(one["state_hash"], two["state_hash"]);
  const Printed again = sandlot("replay " + recording + " --verify --json --threads 2");
  EXPECT_EQ(nlohmann::json::parse(again.out, nullptr, false)["verified"], true) << again.out;
  // Programs that do not run publish nothing: up to the event that waits for their word the world is the same.
  const Printed logged = sandlot("replay " + recording + " --verify --logged");
  EXPECT_THAT(logged.out, HasSubstr("the state differs of sim")) << logged.out;
  const Printed topics = sandlot("topic list " + recording);
  EXPECT_THAT(topics.out, HasSubstr("/red/coach/arrived"));
}

}  // namespace
}  // namespace sandlot::test
