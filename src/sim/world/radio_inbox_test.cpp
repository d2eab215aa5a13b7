/// Packets that wait in the inbox of a slow receiver, while the medium uses its memory for others.
#include <gtest/gtest.h>

#include "sim/test_radios.h"

namespace sandlot::test {
namespace {

std::string word(int number) {
  return "packet " + std::to_string(number) + std::string(static_cast<std::size_t>(number % 40), '!');
}

void send_word(Radios& world, int from, int to) {
  for (int i = from; i < to; ++i) {
    const std::string data = word(i);
    world.send("sender", {data.begin(), data.end()});
    world.tick();
  }
}

/// One that samples five times a second and one that samples at once.
Radios pair() {
  Radios world(keys_of({{"bandwidth", "1e9"}, {"jitter", "0"}}));
  world.add("sender", {});
  world.add("slow", {1, 0, 0}, keys_of({{"rate", "5"}}));
  world.add("quick", {2, 0, 0});
  return world;
}

TEST(Radio, PacketsThatWaitForTheNextSampleKeepTheirContent) {
  Radios world = pair();
  world.start();
  send_word(world, 0, 19);
  EXPECT_EQ(world.received("slow").size(), 0u) << "the sample before was at 0";
  EXPECT_EQ(world.received("quick").size(), 1u);
  send_word(world, 19, 20);
  const auto packets = world.received("slow");
  ASSERT_EQ(packets.size(), 20u);
  for (int i = 0; i < 20; ++i) {
    const auto& data = packets[static_cast<std::size_t>(i)].data;
    EXPECT_EQ(std::string(data.begin(), data.end()), word(i));
  }
  // From the middle of it, from a snapshot.
  Radios first = pair();
  first.start();
  send_word(first, 0, 9);
  Diagnostics diagnostics;
  auto restored = Simulation::restore(first.simulation->snapshot(), {}, diagnostics);
  ASSERT_TRUE(restored) << restored.error().text();
  EXPECT_EQ((*restored)->state_hash(), first.simulation->state_hash());
  Radios second = pair();
  second.simulation = std::move(*restored);
  send_word(second, 9, 20);
  EXPECT_EQ(second.simulation->state_hash(), world.simulation->state_hash());
}

}  // namespace
}  // namespace sandlot::test
