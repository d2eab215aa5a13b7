/// Bytes of /sandlot/batteries, read by docs/viewer_protocol.md alone.
#include <gtest/gtest.h>

#include "base/bytes.h"
#include "sim/test_world.h"
#include "wire/scene.h"

namespace sandlot::wire {
namespace {

using test::arena;
using test::build;

template <class T>
T take(ByteReader& r) {
  T value{};
  read(r, value);
  return value;
}

void add_battery(model::Setup& setup, std::string_view robot, const char* charge) {
  for (model::Instance& each : setup.instances) {
    if (each.name != robot) continue;
    model::DeviceDecl battery;
    battery.name = battery.kind = "battery";
    battery.config = test::map({{"capacity", "10 J"}, {"initial_charge", charge}});
    each.devices.push_back(battery);
  }
}

TEST(Batteries, OfThoseRobotsThatHaveOneAreSent) {
  model::Setup setup = arena("planar", 3, "");
  add_battery(setup, "rover1", "0.25");
  add_battery(setup, "rover3", "0");
  const auto simulation = build(setup);
  std::vector<std::byte> out;
  write_batteries(*simulation, out);
  ASSERT_EQ(out.size(), 20u + 2 * 8);
  ByteReader r(out);
  EXPECT_EQ(take<std::uint64_t>(r), 0u) << "tick";
  EXPECT_EQ(take<std::int64_t>(r), 0);
  EXPECT_EQ(take<std::uint32_t>(r), 2u);
  const Simulation& seen = *simulation;
  EXPECT_EQ(take<std::uint32_t>(r), seen.find_entity("rover1")->serial);
  EXPECT_EQ(take<float>(r), 0.25f);
  EXPECT_EQ(take<std::uint32_t>(r), seen.find_entity("rover3")->serial);
  EXPECT_EQ(take<float>(r), 0.f) << "nothing is left";
}

TEST(Batteries, OfAWorldWithoutThemThereIsTheHeadAlone) {
  std::vector<std::byte> out;
  write_batteries(*build(arena("planar", 1, "")), out);
  EXPECT_EQ(out.size(), 20u);
}

}  // namespace
}  // namespace sandlot::wire
