#include "sim/world/commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sandlot::test {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::IsEmpty;

/// "a" was created first, then "b" and so on.
std::optional<std::uint64_t> serial_of(std::string_view target) {
  return target.size() == 1 ? std::optional(static_cast<std::uint64_t>(target[0] - 'a')) : std::nullopt;
}

constexpr auto admin = Source::Kind::admin, robot = Source::Kind::robot;

struct Sent {
  Source source;
  std::string target;
};

/// The targets in the order of their execution.
std::vector<std::string> taken(Commands& commands) {
  std::vector<std::string> out;
  for (const Commands::Pending& each : commands.take(serial_of)) out.push_back(request_target(each.request));
  return out;
}
std::vector<std::string> taken_of(const std::vector<Sent>& all) {
  Commands commands;
  for (const Sent& each : all) commands.submit(DeleteRequest{each.target}, each.source);
  return taken(commands);
}

TEST(Commands, OfAdministratorsComeFirstThenThoseOfRobotsByTheirCreation) {
  EXPECT_THAT(taken_of({{{robot, 1}, "c"}, {{robot, 2}, "b"}, {{admin, 9}, "x"}, {{robot, 3}, "a"}}),
              ElementsAre("x", "a", "b", "c"));
  Commands commands;
  commands.submit(DeleteRequest{"a"}, {admin, 0});
  EXPECT_THAT(taken(commands), ElementsAre("a"));
  EXPECT_THAT(taken(commands), IsEmpty()) << "each is taken once";
}

TEST(Commands, OfOneClientStayTogetherInTheOrderInWhichItSentThem) {
  EXPECT_THAT(taken_of({{{admin, 4}, "z"}, {{admin, 5}, "m"}, {{admin, 4}, "a"}, {{admin, 5}, "n"}}),
              ElementsAre("m", "n", "z", "a"));
  // A team's client stands where its first robot does.
  EXPECT_THAT(taken_of({{{robot, 1}, "d"}, {{robot, 2}, "c"}, {{robot, 1}, "b"}, {{robot, 3}, "a"}}),
              ElementsAre("a", "d", "b", "c"));
}

TEST(Commands, DoNotDependOnWhoConnectedOrSentFirst) {
  for (const Source::Kind kind : {admin, robot}) {
    // Three clients; the first two drive the same robot.
    const std::vector<std::vector<std::string>> clients{{"b", "a"}, {"a", "c"}, {"c", "?"}};
    std::vector<std::string> expected;
    std::vector<std::size_t> order{0, 1, 2};
    do {
      for (const bool in_turn : {false, true}) {
        std::vector<Sent> sent;
        if (in_turn) {
          for (std::size_t i = 0; i < 2; ++i)
            for (const std::size_t client : order)
              sent.push_back({{kind, order[client]}, clients[client][i]});
        } else {
          for (const std::size_t client : order)
            for (const std::string& target : clients[client]) sent.push_back({{kind, order[client]}, target});
        }
        const auto now = taken_of(sent);
        if (expected.empty()) expected = now;
        EXPECT_THAT(now, ElementsAreArray(expected));
      }
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST(Commands, OfALogKeepItsOrder) {
  Commands commands;
  commands.submit(DeleteRequest{"0"}, {admin, 1});
  for (const char* const target : {"c", "a", "b"}) commands.repeat(DeleteRequest{target}, {robot, 7});
  commands.repeat(DeleteRequest{"z"}, {admin, 7});
  EXPECT_THAT(taken(commands), ElementsAre("c", "a", "b", "z", "0"));
}

TEST(Commands, NameAClientThatDrivesARobotByTheRobot) {
  Commands commands;
  commands.submit(DeleteRequest{"c"}, {robot, 7});
  commands.submit(DeleteRequest{"nobody"}, {robot, 7});
  commands.submit(DeleteRequest{"c"}, {admin, 7});
  std::vector<std::uint64_t> ids;
  for (const Commands::Pending& each : commands.take(serial_of)) ids.push_back(each.source.id);
  EXPECT_THAT(ids, ElementsAre(7, 2, 7));
}

TEST(Commands, ManualOverridesLieInAnOrderThatDoesNotDependOnWhichCameFirst) {
  const auto overrides = [](std::vector<std::uint64_t> keys) {
    Commands commands;
    for (const std::uint64_t key : keys) {
      SimulationParts::Device device(std::make_shared<const model::DeviceDecl>());
      device.key = key;
      commands.override_manually(device, Time::from_s(1));
    }
    ByteWriter w;
    write(w, commands.overrides());
    return w.buffer();
  };
  EXPECT_EQ(overrides({3, 1, 2, 1}), overrides({1, 2, 3}));
  Commands commands;
  commands.restore({{5, Time::from_s(2)}, {4, Time::from_s(1)}});
  EXPECT_EQ(commands.overrides().front().device, 4u);
}

TEST(Commands, AManualOverrideLastsFromTheLatestCommand) {
  SimulationParts::Device drive(std::make_shared<const model::DeviceDecl>());
  SimulationParts::Device other(std::make_shared<const model::DeviceDecl>());
  drive.key = 1, other.key = 2;
  const auto at = [](double s) { return Time::from_s(s); };
  Commands commands;
  commands.override_manually(drive, at(1));
  commands.override_manually(drive, at(1.2));
  EXPECT_EQ(commands.overrides().size(), 1u);
  commands.begin_tick(at(1.69));
  EXPECT_TRUE(commands.is_overridden(drive));
  EXPECT_FALSE(commands.is_overridden(other));
  commands.begin_tick(at(1.7));
  EXPECT_FALSE(commands.is_overridden(drive));
}

TEST(Commands, LogARefusedRequestWithItsReason) {
  Commands commands;
  commands.submit(DeleteRequest{"box"}, {admin, 3});
  for (const Commands::Pending& each : commands.take(serial_of)) commands.conclude(each, Error{"no"}, true);
  ASSERT_EQ(commands.outcomes().size(), 1u);
  ASSERT_EQ(commands.tick_log().size(), 1u);
  const LogEntry& entry = commands.tick_log().front();
  EXPECT_EQ(entry.target, "box");
  EXPECT_EQ(entry.source.id, 3u);
  EXPECT_TRUE(entry.refused);
  EXPECT_EQ(entry.why, "no");
  commands.clear_log();
  EXPECT_FALSE(commands.log_entry(LogEntry::step, {}, 0).refused) << "entries are used again, but empty";
}

}  // namespace
}  // namespace sandlot::test
