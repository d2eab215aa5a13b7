/// Snapshot files as a user meets them: which are written, what they say, and what happens to bad ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "command.h"

namespace sandlot::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

const std::string indoor_run = "run scenarios/indoor.yaml --set physics=planar --headless ";

TEST(SnapshotFiles, OneEachIntervalTheLastOnesStayAndAContinuedRunKeepsTheNames) {
  const TestFolder scratch;
  const std::string file = scratch.file("a.snapshot");
  ASSERT_EQ(sandlot(indoor_run + "--duration 1s --snapshot-every 0.25s --snapshot " + file).exit_code, 0);
  EXPECT_THAT(names_in(scratch.path),
              ElementsAre("a-000000.250.snapshot", "a-000000.500.snapshot", "a-000000.750.snapshot",
                          "a-000001.000.snapshot", "a.snapshot"));
  EXPECT_EQ(contents(file), contents(scratch.file("a-000001.000.snapshot")))
      << "both are the state at the end";

  // 0.3 s is not a multiple: the next one is due at 0.5 s all the same.
  const TestFolder second;
  const std::string mid = second.file("mid.snapshot"), again = second.file("a.snapshot");
  ASSERT_EQ(sandlot(indoor_run + "--duration 0.3s --snapshot " + mid).exit_code, 0);
  ASSERT_EQ(
      sandlot("run --from " + mid +
              " --headless --duration 0.7s --snapshot-every 0.25s --snapshot-keep 2 --snapshot " + again)
          .exit_code,
      0);
  EXPECT_THAT(names_in(second.path),
              ElementsAre("a-000000.750.snapshot", "a-000001.000.snapshot", "a.snapshot", "mid.snapshot"));
}

TEST(SnapshotFiles, InfoSaysWhatIsInOne) {
  const TestFolder scratch;
  const std::string file = scratch.file("a.snapshot");
  ASSERT_EQ(sandlot(indoor_run + "--duration 0.5s --seed 12 --snapshot " + file).exit_code, 0);
  const Printed info = sandlot("info " + file);
  EXPECT_EQ(info.exit_code, 0);
  for (const char* word :
       {"version", "fp-contract-off", "indoor (planar, seed 12)", "0.5 s, tick 50", "1 of", "laser"})
    EXPECT_THAT(info.out, HasSubstr(word));
  const auto json = nlohmann::json::parse(sandlot("info --json " + file).out, nullptr, false);
  EXPECT_EQ(json["snapshot"]["time"], "0.5 s, tick 50");
}

TEST(SnapshotFiles, BadOnesAreRefusedWithTheFilesNameAndWhatIsWrong) {
  const TestFolder scratch;
  const std::string file = scratch.file("good.snapshot");
  ASSERT_EQ(sandlot(indoor_run + "--duration 0.1s --snapshot " + file).exit_code, 0);
  const std::string good = contents(file);
  const auto refused = [&](const char* name, const std::string& bytes, const char* word) {
    const std::string bad = scratch.write(name, bytes);
    for (const char* verb : {"run --from ", "info "}) {
      const Printed printed = sandlot(verb + bad);
      EXPECT_EQ(printed.exit_code, 2) << verb << name;
      EXPECT_THAT(printed.out, testing::AllOf(HasSubstr(name), HasSubstr(word))) << verb;
    }
  };
  for (const std::size_t size : {std::size_t{9}, std::size_t{20}, good.size() / 2, good.size() - 1})
    refused("cut.snapshot", good.substr(0, size), size < 10 ? "cut short" : "the snapshot is damaged");
  for (const std::size_t at : {good.size() / 3, good.size() / 2, good.size() - 1}) {
    std::string flipped = good;
    flipped[at] = static_cast<char>(flipped[at] ^ 4);
    refused("flipped.snapshot", flipped, "its checksum does not fit");
  }
  std::string newer = good;
  newer[8] = 99;
  refused("newer.snapshot", newer, "has version 99");
  EXPECT_THAT(sandlot("run --from " + scratch.write("foreign.snapshot", "\x89PNG\r\n")).out,
              HasSubstr("not a Sandlot snapshot"));
  EXPECT_EQ(sandlot("run --from " + scratch.path.string()).exit_code, 2);
}

TEST(SnapshotFiles, WhatCannotBeWrittenFailsTheRunAndCostsNoOlderFile) {
  const TestFolder scratch;
  const std::string file = scratch.file("a.snapshot");
  ASSERT_EQ(sandlot(indoor_run + "--duration 0.1s --snapshot " + file).exit_code, 0);
  const std::string before = contents(file);
  // A limit on the size of files stands in for a full disk.
  const std::string line = "bash -c 'ulimit -f 2; trap \"\" XFSZ; exec " + std::string(SANDLOT_BIN) + " " +
                           indoor_run + "--duration 0.2s --snapshot " + file + "' >" + scratch.file("out") +
                           " 2>&1";
  const int status = std::system(line.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_THAT(contents(scratch.file("out")), HasSubstr("cannot write '" + file + "'"));
  EXPECT_EQ(contents(file), before);
  EXPECT_THAT(names_in(scratch.path), ElementsAre("a.snapshot", "out")) << "no half file is left";
  const Printed nowhere = sandlot(indoor_run + "--duration 0.1s --snapshot /nowhere/a.snapshot");
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_THAT(nowhere.out, HasSubstr("/nowhere/a.snapshot"));
}

TEST(SnapshotFiles, OptionsThatDoNotGoTogetherAreRefused) {
  const auto refused = [](const std::string& options, const char* word) {
    const Printed printed = sandlot(indoor_run + options);
    EXPECT_EQ(printed.exit_code, 2) << options;
    EXPECT_THAT(printed.out, HasSubstr(word)) << options;
  };
  refused("--snapshot-every 1s", "add --snapshot FILE");
  refused("--snapshot a --snapshot-every 0s", "--snapshot-every");
  refused("--snapshot a --snapshot-keep 3", "add --snapshot-every");
}

/// Every scenario there is: from the state at half time, in a new process, to the same end in any number of
/// threads.
TEST(SlowSnapshotFiles, EveryScenarioGoesOnFromHalfTimeToTheSameHash) {
  int scenarios = 0;
  for (const auto& entry : std::filesystem::directory_iterator("scenarios")) {
    if (entry.path().extension() != ".yaml" && entry.path().extension() != ".sim") continue;
    ++scenarios;
    const std::string scenario = entry.path().string();
    const TestFolder scratch;
    const std::string half = scratch.file("half.snapshot");
    const auto whole = summary_of(scenario + " --duration 2s --snapshot-at 1s --snapshot " + half);
    ASSERT_FALSE(whole.contains("failed")) << scenario << whole["failed"];
    for (const int threads : {1, 2, 4}) {
      const auto rest = summary_of("--from " + half + " --duration 1s --threads " + std::to_string(threads));
      EXPECT_EQ(rest["end_tick"], whole["end_tick"]) << scenario;
      EXPECT_EQ(rest["state_hash"], whole["state_hash"]) << scenario << ", " << threads << " threads";
    }
  }
  EXPECT_GE(scenarios, 6);
}

}  // namespace
}  // namespace sandlot::test
