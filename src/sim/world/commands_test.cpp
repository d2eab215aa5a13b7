#include "sim/world/commands.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sandlot::test {
namespace {

using testing::ElementsAre;

TEST(Commands, AreTakenBySourceAndThenByNumber) {
  Commands commands;
  const auto submit = [&](Source::Kind kind, std::uint64_t id) {
    return commands.submit(DeleteRequest{"x"}, {kind, id});
  };
  submit(Source::Kind::robot, 2);
  submit(Source::Kind::robot, 1);
  submit(Source::Kind::admin, 9);
  submit(Source::Kind::robot, 1);
  const auto numbers = [&] {
    std::vector<std::uint64_t> out;
    for (const Commands::Pending& each : commands.take()) out.push_back(each.sequence);
    return out;
  };
  EXPECT_THAT(numbers(), ElementsAre(2, 1, 3, 0));
  EXPECT_TRUE(numbers().empty()) << "each is taken once";
  submit(Source::Kind::admin, 0);
  EXPECT_THAT(numbers(), ElementsAre(4));
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
  commands.submit(DeleteRequest{"box"}, {Source::Kind::admin, 3});
  for (const Commands::Pending& each : commands.take()) commands.conclude(each, Error{"no"}, true);
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
