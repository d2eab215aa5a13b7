/// Clients in one run: what they request together does not depend on the order in which they connected.
#include <gtest/gtest.h>

#include <optional>

#include "messages/messages.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

/// Two people drive the same robots, and one of them changes the world, in the same ticks: whoever connected first, and
/// whose message came first, the run is the same. Its log repeats it.
TEST(Sources, TheRunDoesNotDependOnWhoConnectedFirst) {
  const auto twist = [](double x) {
    msg::Twist message;
    message.linear.x = x;
    ByteWriter w;
    write(w, message);
    return w.buffer();
  };
  struct Log : Observer {
    std::vector<std::vector<LogEntry>> ticks;
    Wants wants() const override { return {.input = true}; }
    void on_frame(const std::shared_ptr<const Frame>& frame) override { ticks.push_back(frame->log); }
  };
  std::optional<std::uint64_t> expected;
  for (const bool swapped : {false, true})
    for (const bool reversed : {false, true}) {
      const auto simulation = build(arena("planar", 3));
      Log log;
      simulation->add_observer(&log);
      const std::uint64_t anna = swapped ? 8 : 3, bert = swapped ? 3 : 8;
      for (int tick = 0; tick < 60; ++tick) {
        const auto send = [&](std::uint64_t client, const char* robot, double x) {
          simulation->submit(
              CommandRequest{std::string(robot) + "/drive", "geometry_msgs/msg/Twist", twist(x)},
              {Source::Kind::robot, client});
        };
        const auto of_anna = [&] {
          send(anna, "rover3", 0.3), send(anna, "rover1", 0.1 * (tick % 5)), send(anna, "rover1", 0.2);
          if (tick == 20)
            simulation->submit(PoseRequest{"crate1", {{1, 2, 0.2}, {}}}, {Source::Kind::admin, anna});
        };
        const auto of_bert = [&] {
          send(bert, "rover1", -0.1), send(bert, "rover2", 0.25);
          if (tick == 20)
            simulation->submit(PoseRequest{"crate1", {{0, 3, 0.2}, {}}}, {Source::Kind::admin, bert});
        };
        if (reversed) of_bert(), of_anna();
        else of_anna(), of_bert();
        advance(*simulation, 1);
      }
      if (!expected) expected = simulation->state_hash();
      EXPECT_EQ(simulation->state_hash(), *expected) << swapped << reversed;
      const auto repeated = build(arena("planar", 3));
      for (const std::vector<LogEntry>& entries : log.ticks) {
        for (const LogEntry& entry : entries) {
          Request request = CommandRequest{entry.target, entry.type, entry.bytes};
          ByteReader r(entry.bytes);
          const bool command = entry.kind == LogEntry::command;
          ASSERT_TRUE(command || read_request(r, request));
          repeated->repeat(std::move(request), entry.source);
        }
        advance(*repeated, 1);
      }
      EXPECT_EQ(repeated->state_hash(), *expected) << swapped << reversed;
    }
}

}  // namespace
}  // namespace sandlot::test
