/// Output of the command, and its errors when the output cannot be written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "command.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string short_run = "run scenarios/indoor.yaml --set physics=planar --duration 0.2s";

TEST(Output, AFullDiskBehindTheOutputIsAnError) {
  const TestFolder scratch;
  const std::string recording = scratch.file("r.mcap");
  ASSERT_EQ(sandlot(short_run + " --record " + recording).exit_code, 0);
  for (const std::string& verb :
       {short_run, "replay " + recording + " --verify", "topic list " + recording,
        "topic echo " + recording + " /clock", "diff " + recording + " " + recording, std::string("list")}) {
    const Printed printed = shell(std::string(SANDLOT_BIN) + " " + verb + " 2>&1 >/dev/full");
    EXPECT_EQ(printed.exit_code, 1) << verb << printed.out;
    EXPECT_THAT(printed.out, HasSubstr("not all of the output")) << verb;
  }
}

TEST(Output, APipeAndALinkStayWhatTheyAre) {
  const TestFolder scratch;
  ASSERT_EQ(mkfifo(scratch.file("pipe").c_str(), 0600), 0);
  const Printed piped = shell("cat " + scratch.file("pipe") + " & " + SANDLOT_BIN + " " + short_run +
                              " --summary " + scratch.file("pipe") + " >/dev/null; wait");
  EXPECT_THAT(piped.out, HasSubstr("\"state_hash\""));
  EXPECT_TRUE(std::filesystem::is_fifo(scratch.file("pipe")));

  scratch.write("old.json", "old");
  std::filesystem::create_symlink("old.json", scratch.file("link.json"));
  ASSERT_EQ(sandlot(short_run + " --summary " + scratch.file("link.json")).exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(scratch.file("link.json")));
  EXPECT_EQ(read_json(scratch.file("old.json")).at("ticks"), 20);
}

TEST(Output, ATableGoesIntoAPipeToo) {
  const TestFolder scratch;
  const std::string recording = scratch.file("r.mcap");
  ASSERT_EQ(sandlot(short_run + " --record " + recording).exit_code, 0);
  ASSERT_EQ(mkfifo(scratch.file("pipe").c_str(), 0600), 0);
  const Printed piped = shell("cat " + scratch.file("pipe") + " & " + SANDLOT_BIN + " topic export " +
                              recording + " --values /clock --out " + scratch.file("pipe") + "; wait");
  EXPECT_THAT(piped.out, HasSubstr("time,/clock.clock"));
  EXPECT_TRUE(std::filesystem::is_fifo(scratch.file("pipe")));
}

TEST(Output, NamesThatAreNoUtf8AreWrittenAllTheSame) {
  const TestFolder scratch;
  const std::string recording = scratch.file("b\xff.mcap"), summary = scratch.file("s.json");
  EXPECT_EQ(sandlot(short_run + " --record " + recording + " --summary " + summary).exit_code, 0);
  EXPECT_THAT(read_json(summary).at("recording").at("file"), HasSubstr("b\xef\xbf\xbd.mcap"));
  const Printed replayed = sandlot("replay " + recording + " --verify --json");
  EXPECT_EQ(replayed.exit_code, 0) << replayed.out;
  EXPECT_EQ(sandlot("doctor " + recording + " --json").exit_code, 0);
}

TEST(Output, ATopicWithoutANameIsRefused) {
  const TestFolder scratch;
  ASSERT_EQ(sandlot(short_run + " --record " + scratch.file("r.mcap")).exit_code, 0);
  const Printed printed = sandlot("topic echo " + scratch.file("r.mcap") + " ''");
  EXPECT_EQ(printed.exit_code, 2);
  EXPECT_THAT(printed.out, HasSubstr("topic list"));
}

TEST(Output, ARunThatIsRefusedLeavesTheLogOfTheOneBefore) {
  const TestFolder scratch;
  const std::string log = scratch.write("run.csv", "time\n1\n");
  const Printed printed = sandlot(short_run + " --log " + log +
                                  " --log-values sim.time --record /nowhere/r.mcap");
  EXPECT_EQ(printed.exit_code, 2);
  std::ifstream in(log);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "time\n1\n");
}

TEST(Output, AReplayThatWasInterruptedVerifiesNothing) {
  const TestFolder scratch;
  const std::string recording = scratch.file("r.mcap");
  ASSERT_EQ(sandlot("run scenarios/indoor.yaml --duration 150s --record-topics none --record " + recording)
                .exit_code,
            0);
  // Too early a signal ends the program before it listens, too late a one finds it done: one of these meets
  // it at work.
  int met = 0;
  for (const char* after_s : {"0.1", "0.2", "0.4", "0.8", "1.6", "3.2", "6.4", "13"}) {
    const Printed printed = shell("timeout --preserve-status -s TERM " + std::string(after_s) + " " +
                                  std::string(SANDLOT_BIN) + " replay " + recording + " --verify");
    if (printed.exit_code == 0) break;
    if (printed.exit_code != 1) continue;
    ++met;
    EXPECT_THAT(printed.out, HasSubstr("interrupted: nothing behind tick"));
    EXPECT_THAT(printed.out, Not(HasSubstr("verified")));
  }
  EXPECT_GE(met, 1);
}

}  // namespace
}  // namespace sandlot::test
