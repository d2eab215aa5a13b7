/// Step times to clients.
#include "server/test_bridge.h"

namespace sandlot::server::test {
namespace {

using sandlot::test::arena;

double seconds(const json& time) { return time["sec"].get<double>() + 1e-9 * time["nanosec"].get<double>(); }

json next_times(Bridge& bridge) {
  while (true) {
    json message = bridge.next("publish");
    if (message.is_null() || message["topic"] == "/sandlot/step_times")
      return message.is_null() ? message : message["msg"];
  }
}

/// By hand: each tick is in one message, so that stamps and numbers of ticks go together; ticks of 10 ms at real time are one or two to a
/// message of about 20 ms, if the machine keeps up. The rest is true however slow it is.
TEST(StepTimes, ReachARobotTickByTick) {
  Running run(arena("planar", 1, ""), {.pace = {1.0}});
  run.go();
  Bridge bridge(run.url());
  EXPECT_EQ(bridge.claim({{"robot", "rover1"}})["op"], "sandlot.claimed");
  bridge.send({{"op", "subscribe"}, {"topic", "/sandlot/step_times"}});
  json before = next_times(bridge);
  ASSERT_FALSE(before.is_null());
  EXPECT_EQ(before["restarted"], true) << "nobody has measured before";
  for (int i = 0; i < 20; ++i) {
    const json now = next_times(bridge);
    ASSERT_FALSE(now.is_null());
    EXPECT_EQ(now["restarted"], false);
    EXPECT_EQ(now["wall_s"].size(), now["compute_s"].size());
    EXPECT_NEAR(seconds(now["stamp"]) - seconds(before["stamp"]),
                now["step_s"].get<double>() * static_cast<double>(now["compute_s"].size()), 1e-9);
    for (std::size_t k = 0; k < now["wall_s"].size(); ++k)
      EXPECT_GE(now["wall_s"][k].get<double>(), now["compute_s"][k].get<double>());
    before = now;
  }
}

TEST(StepTimes, AreSentInFewMessagesHoweverFastTheRun) {
  Running run(arena("planar", 1, ""), {});
  run.go();
  Bridge bridge(run.url());
  bridge.send({{"op", "subscribe"}, {"topic", "/sandlot/step_times"}});
  double wall_s = 0;
  std::size_t ticks = 0;
  for (int i = 0; i < 20; ++i) {
    const json now = next_times(bridge);
    ASSERT_FALSE(now.is_null());
    for (const json& each : now["wall_s"]) wall_s += each.get<double>();
    ticks += now["compute_s"].size();
  }
  EXPECT_GT(wall_s, 18 * 0.009) << "about 20 ms each, half of that at least";
  EXPECT_GT(ticks, 40u);
}

}  // namespace
}  // namespace sandlot::server::test
