#include "run/repeat.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/atomic_file.h"
#include "base/test_folder.h"

namespace sandlot {
namespace {

using test::TestFolder;
using testing::HasSubstr;

/// A rover somewhere on a square of 4 m; each seed puts it elsewhere.
std::string scattered(const TestFolder& folder, const std::string& more) {
  const std::string file = folder.file("scattered.yaml");
  EXPECT_TRUE(
      write_file(file,
                 "version: 1\nname: scattered\nphysics: planar\ntime: {step: 10 ms, stop: 0.05}\nrobots:\n"
                 "  - name: rover\n    model: rover\n    team: red\n    count: 2\n"
                 "    distribution: {uniform: {width: 4, height: 4}}\n" +
                     more));
  return file;
}

RepeatSummary repeated(const RepeatSpec& spec) {
  auto all = repeat(spec);
  EXPECT_TRUE(all) << all.error().text();
  return all ? std::move(*all) : RepeatSummary();
}
std::string refusal(const RepeatSpec& spec) {
  const auto all = repeat(spec);
  return all ? "" : all.error().text();
}

TEST(Repeat, EachRunIsTheOneOfItsSeedAndTheFiguresAreTheirs) {
  const TestFolder folder;
  const std::string file = scattered(
      folder,
      "seed: 7\ncriterion: {value: max(rover*.pose.x), success: all(rover*.pose.y > -1)}\n"
      "teams: [{name: red, criterion: sum(rover*.pose.y)}]\n");
  for (const int at_a_time : {1, 3}) {
    const RepeatSummary all = repeated({.run = {.file = file}, .count = 12, .at_a_time = at_a_time});
    ASSERT_EQ(all.runs.size(), 12u);
    double sum = 0, squares = 0, lowest = 1e9;
    std::uint64_t successes = 0;
    for (std::size_t i = 0; i < all.runs.size(); ++i) {
      const auto alone = run({.file = file, .seed = 7 + i});
      ASSERT_TRUE(alone);
      EXPECT_EQ(all.runs[i].seed, 7 + i);
      EXPECT_EQ(all.runs[i].state_hash, alone->state_hash);
      EXPECT_EQ(all.runs[i].criterion, alone->criterion);
      EXPECT_EQ(all.runs[i].success, alone->success);
      EXPECT_EQ(all.runs[i].criteria.at(0).value.value, alone->criteria.at(0).value.value);
      sum += *alone->criterion;
      squares += *alone->criterion * *alone->criterion;
      lowest = std::min(lowest, *alone->criterion);
      successes += *alone->success;
    }
    EXPECT_GT(successes, 0u);
    EXPECT_LT(successes, 12u);
    const double mean = sum / 12, deviation = std::sqrt((squares - 12 * mean * mean) / 11);
    EXPECT_GT(deviation, 0.1);
    const Estimate& found = all.all->criterion;
    EXPECT_EQ(found.count, 12u);
    EXPECT_NEAR(*found.mean, mean, 1e-12);
    EXPECT_NEAR(*found.deviation, deviation, 1e-9);
    EXPECT_NEAR(*found.high - mean, 2.200985160082949 * deviation / std::sqrt(12.0),
                1e-9);  // t of 11, 97.5 %
    EXPECT_NEAR(mean - *found.low, *found.high - mean, 1e-12);
    EXPECT_EQ(found.min, lowest);
    EXPECT_EQ(all.all->success->successes, successes);
    EXPECT_EQ(all.teams.at(0).name, "red");
    EXPECT_EQ(all.teams.at(0).value.criterion.count, 12u);
    EXPECT_FALSE(all.teams.at(0).value.success);
    EXPECT_EQ(all.failed, 0u);
    EXPECT_DOUBLE_EQ(*all.end_s.mean, 0.05);
    EXPECT_THAT(as_text(all), HasSubstr("runs       12, seeds 7 to 18"));
    EXPECT_EQ(as_json(all)["runs"].size(), 12u);
    EXPECT_EQ(as_json(all)["teams"]["red"]["criterion"]["count"], 12);
  }
}

TEST(Repeat, RunsThatFailAreToldAndCountInNoFigure) {
  const TestFolder folder;
  // A division by zero where both rovers lie on one side.
  const std::string file = scattered(folder, "criterion: 1 / count(rover*.pose.x > 0)\n");
  const RepeatSummary all = repeated({.run = {.file = file, .seed = 1}, .count = 16});
  ASSERT_EQ(all.runs.size(), 16u);
  EXPECT_GT(all.failed, 0u);
  EXPECT_EQ(all.all->criterion.count + all.failed, 16u);
  EXPECT_GE(*all.all->criterion.min, 0.5);
  EXPECT_THAT(as_text(all), HasSubstr("is not a finite number"));
}

TEST(Repeat, SeedsThatAreInTheStoreAreNotRunAgain) {
  const TestFolder folder;
  const std::string file = scattered(folder, "criterion: rover1.pose.x\n");
  RepeatSpec spec{.run = {.file = file, .seed = 3}, .count = 4, .store_file = folder.file("results.db")};
  const RepeatSummary first = repeated(spec);
  spec.count = 6;
  const RepeatSummary second = repeated(spec);
  ASSERT_EQ(second.runs.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(second.runs[i].seed, 3 + i);
    EXPECT_EQ(second.runs[i].stored, i < 4) << i;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_FALSE(first.runs[i].stored);
    EXPECT_EQ(second.runs[i].state_hash, first.runs[i].state_hash);
    EXPECT_EQ(second.runs[i].criterion, first.runs[i].criterion);
    EXPECT_EQ(second.runs[i].end_s, first.runs[i].end_s);
  }
  EXPECT_THAT(as_text(second), HasSubstr("stored     4 of them were not run again"));
  // Other seeds of the same world belong to the same series; another end is another series.
  spec.run.seed = 5, spec.count = 5;
  const RepeatSummary shifted = repeated(spec);
  EXPECT_TRUE(shifted.runs[3].stored);
  EXPECT_FALSE(shifted.runs[4].stored);
  spec.run.duration_s = 0.02;
  EXPECT_FALSE(repeated(spec).runs[0].stored);
  // A run without the store gives the same.
  EXPECT_EQ(repeated({.run = {.file = file, .seed = 3}, .count = 1}).runs[0].state_hash,
            first.runs[0].state_hash);
}

TEST(Repeat, AFileThatIsNoStoreIsRefusedBeforeTheFirstRun) {
  const TestFolder folder;
  const std::string file = scattered(folder, "criterion: 1\n");
  EXPECT_THAT(refusal({.run = {.file = file}, .store_file = file}), HasSubstr("is not a store of results"));
}

TEST(Repeat, EndsWhenItIsToldTo) {
  const TestFolder folder;
  const auto all = repeat(
      {.run = {.file = scattered(folder, "criterion: 1\n")}, .count = 1000, .at_a_time = 2},
      [](int ended) { return ended < 3; });
  ASSERT_TRUE(all);
  EXPECT_GE(all->runs.size(), 3u);
  EXPECT_LE(all->runs.size(), 4u);
  EXPECT_EQ(all->all->criterion.count, all->runs.size());
}

TEST(Repeat, WithoutACriterionThereAreOnlyTheEnds) {
  const TestFolder folder;
  const RepeatSummary all = repeated({.run = {.file = scattered(folder, "")}, .count = 1});
  EXPECT_FALSE(all.all);
  EXPECT_FALSE(all.end_s.low);
  EXPECT_THAT(as_text(all), HasSubstr("criterion  the scenario has none"));
}

TEST(Repeat, WhatCannotBeRepeatedIsRefusedBeforeTheFirstRun) {
  const TestFolder folder;
  const std::string file = scattered(folder, "");
  EXPECT_THAT(refusal({.run = {.file = file}, .count = 0}),
              HasSubstr("--repeat: must be in [1, 1000000], is 0"));
  EXPECT_THAT(refusal({.run = {.file = file, .record_file = folder.file("a.mcap")}}),
              HasSubstr("--record and --repeat"));
  EXPECT_THAT(refusal({.run = {.file = file, .log_file = folder.file("a.csv")}}),
              HasSubstr("--log and --repeat"));
  EXPECT_THAT(refusal({.run = {.from_file = folder.file("a.snap")}}), HasSubstr("--from and --repeat"));
  EXPECT_THAT(refusal({.run = {.file = folder.file("none.yaml")}}), HasSubstr("none.yaml"));
  EXPECT_THAT(refusal({.run = {.file = scattered(folder, "log: {file: a.csv, values: [sim.time]}\n")}}),
              HasSubstr("the scenario logs into 'a.csv'"));
  EXPECT_THAT(refusal({.run = {.file = scattered(folder, "record: {file: a.mcap}\n")}}),
              HasSubstr("the scenario is recorded into"));
  ASSERT_TRUE(write_file(file, "version: 1\nphysics: planar\nrobots:\n  - {name: rover, model: rover}\n"));
  EXPECT_THAT(refusal({.run = {.file = file}}), HasSubstr("the runs have no end"));
}

}  // namespace
}  // namespace sandlot
