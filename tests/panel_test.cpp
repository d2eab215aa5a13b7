/// Screen, keys and speaker of a robot in a run: from the console to topics, snapshots, recordings and back.
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "command.h"

namespace sandlot::test {
namespace {

class Panel : public testing::Test {
 protected:
  void SetUp() override {
    scenario = folder.write("s.yaml", R"(version: 1
name: panel
physics: planar
time: {step: 10 ms, stop: 1 s}
values:
  presses: rover/keys/presses.count
  key: rover/keys/presses.latest[0].key
  sounds: rover/speaker/sound.sounds
  playing: rover/speaker/sound.playing
events:
  - {name: pressed, when: presses > 1}
robots:
  - name: rover
    model: )" + std::filesystem::absolute("models/rover/model.sdf").string() +
                                          R"(
    devices:
      lcd: {kind: screen, width: 16, height: 16}
      keys: {kind: keys}
      speaker: {kind: speaker}
)");
  }
  static std::string line(const std::string& text) { return " --command '" + text + "'"; }
  /// A pixel of `color` at (x, 3), written at a time.
  static std::string draw(const std::string& at, int x, int red) {
    return line("at " + at + " command rover/lcd ScreenPatch {\"x\": " + std::to_string(x) +
                ", \"y\": 3, \"width\": 1, \"height\": 1, \"data\": [" + std::to_string(red) + ", 0, 0]}");
  }
  nlohmann::json run(const std::string& arguments) {
    const std::string summary = folder.file("summary.json");
    const Printed printed = sandlot("run " + arguments + " --summary " + summary);
    EXPECT_EQ(printed.exit_code, 0) << arguments << "\n" << printed.out;
    return read_json(summary);
  }
  std::string hash(const std::string& arguments) { return run(arguments)["state_hash"].dump(); }
  /// What is done in the whole run; the sound lasts at the middle, 0.5 s.
  static std::string orders(int red) {
    return draw("0.2s", 5, red) + line("at 0.3s press rover 2") + line("at 0.31s press rover touch 7 8") +
           line("at 0.4s command rover/speaker Sound {\"frequency\": 440, \"duration\": 0.3}") +
           draw("0.7s", 6, 9);
  }

  const TestFolder folder;
  std::string scenario;
};

TEST_F(Panel, OneOtherPixelIsAnotherState) {
  const std::string once = hash(scenario + orders(200));
  EXPECT_EQ(hash(scenario + orders(200)), once);
  EXPECT_NE(hash(scenario + orders(201)), once);
  EXPECT_NE(hash(scenario + orders(200) + line("at 0.8s press rover 1")), once);
  // What is refused is counted, and the count is State.
  EXPECT_NE(hash(scenario + orders(200) + draw("0.8s", 16, 1)), once);
}

TEST_F(Panel, GoesOnFromASnapshotAndReplays) {
  const std::string half = folder.file("half.snapshot"), recording = folder.file("r.mcap");
  const auto whole = run(scenario + orders(200) + " --snapshot-at 0.5s --snapshot " + half + " --record " +
                         recording);
  EXPECT_EQ(whole["events"][0]["count"], 1) << whole["events"].dump();
  const std::string expected = whole["state_hash"].dump();
  for (const char* threads : {" --threads 1", " --threads 4"})
    EXPECT_EQ(hash("--from " + half + " --duration 0.5s" + draw("0.7s", 6, 9) + threads), expected);
  const auto replay = nlohmann::json::parse(sandlot("replay " + recording + " --verify --json").out, nullptr,
                                            false);
  EXPECT_EQ(replay["verified"], true) << replay.dump();
  EXPECT_EQ(replay["state_hash"].dump(), expected);
}

TEST_F(Panel, ASoundLastsItsDuration) {
  const std::string log = folder.file("log.csv");
  run(scenario + line("at 0.4s command rover/speaker Sound {\"frequency\": 440, \"duration\": 0.3}") +
      " --log " + log + " --log-values playing");
  // Ordered between the ticks that end at 0.4 s and 0.41 s: it sounds from 0.4 s to 0.7 s, and plays at the ends 0.41 ... 0.69 s.
  std::istringstream rows(folder.read("log.csv"));
  int playing = 0;
  for (std::string row; std::getline(rows, row);)
    playing += row.size() > 2 && row.substr(row.size() - 2) == ",1";
  EXPECT_EQ(playing, 29) << folder.read("log.csv");
}

}  // namespace
}  // namespace sandlot::test
