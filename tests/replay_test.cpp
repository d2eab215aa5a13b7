/// Recordings, replays and differences as a user meets them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

std::string recorded(const TestFolder& scratch, const std::string& name, const std::string& arguments) {
  const std::string file = scratch.file(name);
  const Printed run = sandlot("run " + arguments + " --headless --record " + file + " --summary " + file +
                              ".json");
  EXPECT_EQ(run.exit_code, 0) << run.out;
  return file;
}

nlohmann::json json_of(const std::string& arguments) {
  const Printed printed = sandlot(arguments);
  return nlohmann::json::parse(printed.out, nullptr, false);
}

TEST(Replay, ARecordingVerifiesBothWaysAndEndsInTheHashOfTheRun) {
  const TestFolder scratch;
  for (const char* scenario : {"scenarios/indoor.yaml --duration 3s", "scenarios/fleet.yaml --duration 1s",
                               "scenarios/mario.yaml --duration 2s"}) {
    const std::string file = recorded(scratch, "r.mcap", scenario);
    const auto run = read_json(file + ".json");
    for (const char* way : {"--recompute", "--logged --threads 2"}) {
      const auto replay = json_of("replay " + file + " --verify --json " + way);
      EXPECT_EQ(replay["verified"], true) << scenario << way << replay.dump(2);
      EXPECT_EQ(replay["ticks"], run["ticks"]) << scenario;
      // `logged` leaves the controllers' own state as it was at the beginning.
      EXPECT_EQ(replay["state_hash"] == run["state_hash"], std::string(way) == "--recompute") << scenario;
    }
  }
}

/// Sliders, failures and levels moved by hand: what they do is in the recording, and the same for any number
/// of threads.
TEST(Replay, ARunWhoseErrorsFailuresAndLevelsAreChangedOnTheWayIsReproducible) {
  const TestFolder scratch;
  const std::string quiet = "scenarios/errors.yaml --duration 4s";
  const std::string steered = quiet +
                              " --command 'at 0.5s set errors 1.7' --command 'at 1s set rover.errors 0.4'"
                              " --command 'at 1.5s level rover/exact pose'"
                              " --command 'at 2s set rover/uniform.failure dead'"
                              " --command 'at 3s level rover/exact ranges'"
                              " --command 'at 3s set rover/uniform.failure none'";
  const std::string file = recorded(scratch, "r.mcap", steered);
  const auto run = read_json(file + ".json");
  for (const char* way : {"--recompute", "--recompute --threads 4", "--logged --threads 2"}) {
    const auto replay = json_of("replay " + file + " --verify --json " + way);
    EXPECT_EQ(replay["verified"], true) << way << replay.dump(2);
  }
  for (const char* threads : {"1", "2", "4"})
    EXPECT_EQ(summary_of(steered + " --threads " + threads)["state_hash"], run["state_hash"]) << threads;
  EXPECT_NE(summary_of(quiet)["state_hash"], run["state_hash"]);
}

TEST(Replay, AContinuousClockIsReplayedFromTheLengthsItMeasured) {
  const TestFolder scratch;
  const std::string file = recorded(
      scratch, "r.mcap",
      "scenarios/indoor.yaml --set physics=planar --set time.clock=continuous --duration 1s");
  const auto run = read_json(file + ".json");
  EXPECT_GE(run["step_s"]["max"], run["step_s"]["min"]);
  EXPECT_GT(run["step_s"]["min"], 0.0);
  const auto replay = json_of("replay " + file + " --verify --json");
  EXPECT_EQ(replay["verified"], true) << replay.dump(2);
  EXPECT_EQ(replay["state_hash"], run["state_hash"]);
  EXPECT_EQ(replay["end_time"], run["end_time"]);
}

TEST(Replay, AStateFromTheMiddleOfARecordingIsTheOneThatTheRunWouldHaveLeft) {
  const TestFolder scratch;
  const std::string file = recorded(scratch, "r.mcap",
                                    "scenarios/indoor.yaml --set physics=planar --duration 2s");
  const std::string half = scratch.file("half.snapshot");
  ASSERT_EQ(sandlot("replay " + file + " --snapshot-at 1s --snapshot " + half + " --until 1.5s").exit_code,
            0);
  const auto rest = summary_of("--from " + half + " --duration 1s");
  EXPECT_EQ(rest["state_hash"], read_json(file + ".json")["state_hash"]);
  const Printed same = sandlot("diff " + file + " " + half);
  EXPECT_EQ(same.exit_code, 0) << same.out;
  EXPECT_THAT(same.out, HasSubstr("tick 100 (1 s)"));
}

TEST(Diff, TwoSeedsDifferFirstInWhatDrawsRandomNumbers) {
  const TestFolder scratch;
  const std::string arguments = "scenarios/indoor.yaml --set physics=planar --duration 1s";
  const std::string a = recorded(scratch, "a.mcap", arguments),
                    b = recorded(scratch, "b.mcap", arguments + " --seed 2");
  const Printed same = sandlot("diff " + a + " " + a);
  EXPECT_EQ(same.exit_code, 0) << same.out;
  const auto json = json_of("diff --json " + a + " " + b);
  EXPECT_EQ(json["same"], false);
  EXPECT_THAT(json["setup"].dump(), HasSubstr("seed: 1 against 2"));
  ASSERT_FALSE(json["parts"].empty()) << json.dump(2);
  EXPECT_THAT(json["parts"].dump(), HasSubstr("rover/"));
  ASSERT_FALSE(json["values"].empty());
  EXPECT_NE(json["values"][0]["a"], json["values"][0]["b"]);
  const Printed text = sandlot("diff " + a + " " + b);
  EXPECT_EQ(text.exit_code, 1);
  EXPECT_THAT(text.out, HasSubstr("first difference at tick "));
}

TEST(Replay, WhatIsNoRecordingIsRefused) {
  const TestFolder scratch;
  const auto refused = [](const std::string& arguments, const char* word) {
    const Printed printed = sandlot(arguments);
    EXPECT_EQ(printed.exit_code, 2) << arguments << printed.out;
    EXPECT_THAT(printed.out, HasSubstr(word)) << arguments;
  };
  refused("replay README.md", "README.md");
  refused("replay nowhere.mcap", "nowhere.mcap");
  refused("replay " + scratch.write("empty.mcap", ""), "empty.mcap");
  refused("replay a.mcap --logged --recompute", "--logged");
  refused("replay a.mcap --logged --snapshot s.snapshot", "--logged does not run the controllers");
  refused("diff README.md README.md", "README.md");
}

TEST(Replay, ARecordingThatWasTornOffVerifiesAsFarAsItGoesAndAFlippedByteIsNamed) {
  const TestFolder scratch;
  const std::string file = recorded(scratch, "r.mcap",
                                    "scenarios/indoor.yaml --set physics=planar --duration 20s");
  std::ifstream in(file, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  const std::string torn = scratch.write("torn.mcap", whole.substr(0, whole.size() * 3 / 4));
  const auto replay = json_of("replay " + torn + " --verify --json");
  EXPECT_EQ(replay["verified"], true) << replay.dump(2);
  EXPECT_FALSE(replay["torn"].is_null());
  EXPECT_GT(replay["ticks"], 100);
  EXPECT_LT(replay["ticks"], 2000);
  std::string flipped = whole;
  flipped[flipped.size() / 2] = static_cast<char>(flipped[flipped.size() / 2] ^ 16);
  const Printed damaged = sandlot("replay " + scratch.write("flipped.mcap", flipped) + " --verify");
  EXPECT_EQ(damaged.exit_code, 1) << damaged.out;
  EXPECT_THAT(damaged.out, testing::AllOf(HasSubstr("behind tick "), HasSubstr("damaged at byte")));
}

TEST(Playback, ARobotDrivesAgainAsAnotherWasRecorded) {
  const TestFolder scratch;
  const std::string scenario = "scenarios/indoor.yaml --set physics=planar --duration 3s";
  const std::string file = recorded(scratch, "r.mcap", scenario);
  const auto original = read_json(file + ".json");
  // The same robot in the same place, driven by the orders of the first one: the same path to the last bit.
  const std::string play = "'robots[0].controller={kind: playback, file: " + file +
                           ", commands: rover/drive}'";
  const auto again = summary_of(scenario + " --set " + play);
  ASSERT_FALSE(again.contains("failed")) << again["failed"];
  EXPECT_EQ(again["robots"][0]["pose"], original["robots"][0]["pose"]);
  // By measured velocities it follows to within what the steps of the odometry leave open.
  const std::string by_odometry = "'robots[0].controller={kind: playback, file: " + file +
                                  ", topic: /rover/drive/ideal}'";
  const auto follows = summary_of(scenario + " --set " + by_odometry);
  ASSERT_FALSE(follows.contains("failed")) << follows["failed"];
  for (const std::size_t i : {0u, 1u})
    EXPECT_NEAR(follows["robots"][0]["pose"][i].get<double>(), original["robots"][0]["pose"][i].get<double>(),
                0.15);
  const Printed missing = sandlot("run " + scenario +
                                  " --headless --set 'robots[0].controller={kind: playback, file: " + file +
                                  ", topic: /rover/none}'");
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.out,
              testing::AllOf(HasSubstr("no topic '/rover/none'"), HasSubstr("/rover/drive/ideal")));
}

TEST(Playback, ATableNeedsNoRecordingAndASnapshotNeedsNoTable) {
  const TestFolder scratch;
  const std::string table = scratch.write("path.csv", "time,vx,vy,wz\n0,0.2,0,0\n1,0,0,0.5\n2,0,0,0\n");
  const std::string scenario =
      "scenarios/indoor.yaml --set physics=planar --duration 3s --set 'robots[0].controller={kind: playback, "
      "file: " +
      table + "}'";
  const std::string half = scratch.file("half.snapshot");
  const auto whole = summary_of(scenario + " --snapshot-at 1.5s --snapshot " + half);
  ASSERT_FALSE(whole.contains("failed")) << whole["failed"];
  EXPECT_NEAR(whole["robots"][0]["distance_m"].get<double>(), 0.2, 0.05);
  std::filesystem::remove(table);
  EXPECT_EQ(summary_of("--from " + half)["state_hash"], whole["state_hash"]);
  const Printed gone = sandlot("run " + scenario + " --headless");
  EXPECT_EQ(gone.exit_code, 2);
  EXPECT_THAT(gone.out, HasSubstr("path.csv"));
}

}  // namespace
}  // namespace sandlot::test
