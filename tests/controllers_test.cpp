/// Controllers that are exchanged while a run goes on, from files in ros2_control's form, as a user meets them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

const std::string mario = "scenarios/mario.yaml --duration 3s";
/// MARIO's sequence hands over to a gait, a wheel to another controller; the gait is taken away again.
const std::string exchanged =
    mario +
    " --command 'at 1s controllers load mario/weave tests/controllers/mario.yaml'"
    " --command 'at 1s controllers load mario/free_wheel tests/controllers/mario.yaml'"
    " --command 'at 1.2s controllers configure mario/weave mario/free_wheel'"
    " --command 'at 1.5s controllers start mario/weave mario/free_wheel stop mario/controller "
    "mario/motor1_velocity_controller'"
    " --command 'at 2s controllers stop mario/weave'"
    " --command 'at 2.2s controllers start mario/controller'"
    " --command 'at 2.5s controllers unload mario/weave'";

TEST(ControllersOfARun, AreExchangedTheSameWayInEveryReplayAndNumberOfThreads) {
  const TestFolder scratch;
  const std::string file = scratch.file("r.mcap");
  const Printed ran = sandlot("run " + exchanged + " --headless --record " + file + " --summary " + file +
                              ".json");
  ASSERT_EQ(ran.exit_code, 0) << ran.out;
  const auto run = read_json(file + ".json");
  for (const char* way : {"--recompute", "--recompute --threads 4", "--logged --threads 2"}) {
    const Printed printed = sandlot("replay " + file + " --verify --json " + way);
    const auto replay = nlohmann::json::parse(printed.out, nullptr, false);
    EXPECT_EQ(replay["verified"], true) << way << printed.out;
  }
  for (const char* threads : {"1", "4"})
    EXPECT_EQ(summary_of(exchanged + " --threads " + threads)["state_hash"], run["state_hash"]) << threads;
  EXPECT_NE(summary_of(mario)["state_hash"], run["state_hash"]);
}

TEST(ControllersOfARun, OfAFileWithAFaultEndAScriptWithItsLine) {
  const Printed printed = sandlot(
      "run " + mario +
      " --headless --command 'at 0.1s controllers load mario/weave tests/controllers/wrong.yaml'"
      " --command 'at 0.2s controllers configure mario/weave'");
  EXPECT_EQ(printed.exit_code, 1);  // the run had begun
  EXPECT_THAT(printed.out, HasSubstr("tests/controllers/wrong.yaml:7:13: /period: "));
}

TEST(ControllersOfARun, OnOneJointAreRefusedWithBothNames) {
  const Printed printed = sandlot(
      "run " + mario +
      " --headless --command 'at 0.1s controllers load mario/free_wheel tests/controllers/mario.yaml'"
      " --command 'at 0.2s controllers configure mario/free_wheel'"
      " --command 'at 0.3s controllers start mario/free_wheel'");
  EXPECT_EQ(printed.exit_code, 1);  // the run had begun
  EXPECT_THAT(printed.out, HasSubstr("both command joint 'motor1'; stop one of them in the same switch"));
}

}  // namespace
}  // namespace sandlot::test
