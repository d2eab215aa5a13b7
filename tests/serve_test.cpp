/// Runs with a page, as their options go; what viewers see is tried in tests/js.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command.h"

namespace sandlot::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

const std::string indoor = "run scenarios/indoor.yaml --set physics=planar --duration 1s --rate max ";

TEST(Serve, ARunWithAPageEndsByItselfInTheStateOfOneWithout) {
  const TestFolder scratch;
  const Printed served = sandlot(indoor + "--port 0 --summary " + scratch.file("served.json"));
  ASSERT_EQ(served.exit_code, 0) << served.out;
  EXPECT_THAT(served.out, ContainsRegex("page: http://127\\.0\\.0\\.1:[0-9]+/\n"));
  ASSERT_EQ(sandlot(indoor + "--summary " + scratch.file("alone.json")).exit_code, 0);
  const auto a = read_json(scratch.file("served.json")), b = read_json(scratch.file("alone.json"));
  EXPECT_EQ(a["state_hash"], b["state_hash"]);
  EXPECT_EQ(a["ticks"], b["ticks"]);
  EXPECT_EQ(a["server"]["viewers_most"], 0);
  EXPECT_FALSE(b.contains("server"));
}

TEST(Serve, ElsewhereThanOnThisMachineATokenIsMade) {
  EXPECT_THAT(sandlot(indoor + "--port 0 --address 0.0.0.0").out,
              ContainsRegex("page: http://[^ ]+\\?token=[0-9a-f]{32}\n"));
  EXPECT_THAT(sandlot(indoor + "--port 0 --address 0.0.0.0 --token sesame").out,
              HasSubstr("/?token=sesame\n"));
  EXPECT_THAT(sandlot(indoor + "--port 0 --token 'a b&c'").out, HasSubstr("/?token=a%20b%26c\n"));
  EXPECT_THAT(sandlot(indoor + "--port 0 --token sesame").out, HasSubstr("/?token=sesame\n"));
}

TEST(Serve, APortThatIsTakenIsRefusedBeforeAnythingIsWritten) {
  const TestFolder scratch;
  // The first holds its port until it is stopped; the second wants the same and must leave its log alone.
  const std::string log = scratch.write("log.csv", "kept");
  const Printed both = shell(
      std::string(SANDLOT_BIN) + " run scenarios/indoor.yaml --set physics=planar --port 0 --paused 2> " +
      scratch.file("first") + " & first=$!; until grep -q page: " + scratch.file("first") +
      "; do kill -0 $first || exit 9; sleep 0.05; done; port=$(grep -o '[0-9]*/$' " + scratch.file("first") +
      " | tr -d /); " + SANDLOT_BIN + " " + indoor + "--port $port --log " + log +
      " --log-values rover.pose.x; code=$?; kill -INT $first; wait "
      "$first; echo \"first ended with $?\"; exit $code");
  EXPECT_EQ(both.exit_code, 2) << both.out;
  EXPECT_THAT(both.out, AllOf(HasSubstr("error: "), HasSubstr("first ended with 0")));
  EXPECT_EQ(shell("cat " + log).out, "kept");
}

TEST(Serve, OptionsThatDoNotGoTogetherAreRefused) {
  const auto refused = [](const std::string& arguments, const char* why) {
    const Printed printed = sandlot(arguments);
    EXPECT_EQ(printed.exit_code, 2) << arguments << printed.out;
    EXPECT_THAT(printed.out, HasSubstr(why)) << arguments;
  };
  refused(indoor + "--paused", "--port");
  refused(indoor + "--token sesame", "--port");
  refused(indoor + "--headless --port 0", "--headless");
  refused(indoor + "--port 70000", "--port");
  refused(indoor + "--port 0 --address nowhere.invalid", "nowhere.invalid");
  refused(indoor + "--port 0 --allow-origin example.org", "'example.org' is not an origin");
  refused(indoor + "--command 'at 2s lsit'", "lsit");
  refused(indoor + "--script /nowhere.txt", "/nowhere.txt");
  refused("replay /nowhere.mcap --port 0", "/nowhere.mcap");
  refused("replay r.mcap --port 0 --logged", "--logged");
  refused("replay r.mcap --rate 2", "--port");
}

TEST(Serve, ConsoleLinesSteerARunWithoutAPageAndAreInItsRecording) {
  const TestFolder scratch;
  const std::string recording = scratch.file("r.mcap");
  const std::string script = scratch.write("s.txt", "# a comment\nat 0.5s pose rover 3 4.65\n");
  const Printed run = sandlot("run scenarios/indoor.yaml --set physics=planar --duration 0.52s --record " +
                              recording + " --script " + script + " --json");
  ASSERT_EQ(run.exit_code, 0) << run.out;
  const Printed shown = sandlot("topic echo " + recording + " /sandlot/log");
  EXPECT_THAT(shown.out, HasSubstr("rover"));
  EXPECT_EQ(sandlot("replay " + recording + " --verify").exit_code, 0);
  // It is there, and has not driven far in 20 ms at 0.5 m/s.
  const Printed again = sandlot(
      "run scenarios/indoor.yaml --set physics=planar --duration 0.52s --command 'at 0.5s pose rover 3 "
      "4.65' --stop-when 'abs(rover.pose.x - 3) < 0.02' --json");
  EXPECT_THAT(again.out, HasSubstr("--stop-when"));
}

/// By hand: it would wait for ever.
TEST(Serve, ARunWithoutAPageThatIsPausedEndsWithAReason) {
  for (const char* line : {"at 0.5s pause", "at 0.45s step 5"}) {
    const Printed paused = sandlot(indoor + "--command '" + line + "'");
    EXPECT_EQ(paused.exit_code, 1) << paused.out;
    EXPECT_THAT(paused.out, HasSubstr("nobody can let it go on; add --port 8765"));
  }
  EXPECT_EQ(sandlot(indoor + "--command 'at 0.5s pause' --command 'at 0.5s run'").exit_code, 0);
  EXPECT_EQ(sandlot(indoor + "--command 'at 0.5s jump 0.8 s'").exit_code, 0);
}

TEST(Serve, DemosAreListedAndAnUnknownOneNamesThoseThereAre) {
  EXPECT_THAT(sandlot("demo list").out, AllOf(HasSubstr("yard\n"), HasSubstr("indoor\n")));
  const Printed unknown = sandlot("demo nothing --headless");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.out, HasSubstr("known are: ball, beach"));
}

}  // namespace
}  // namespace sandlot::test
