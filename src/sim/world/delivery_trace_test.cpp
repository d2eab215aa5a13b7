/// What observers see of media: who has received from whom, and that nobody's looking changes the run.
#include "sim/world/delivery_trace.h"

#include <gtest/gtest.h>

#include <set>

#include "sim/test_radios.h"
#include "sim/world/test_elements.h"

namespace sandlot::test {
namespace {

/// Collects the deliveries of all ticks.
struct Listener : Observer {
  explicit Listener(Simulation& s) : simulation(s) { simulation.add_observer(this); }
  ~Listener() override { simulation.remove_observer(this); }
  Wants wants() const override { return {.deliveries = wanted}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    for (const FrameDelivery& each : frame->deliveries) seen.push_back(each);
  }
  Simulation& simulation;
  bool wanted = true;
  std::vector<FrameDelivery> seen;
};

std::uint64_t serial(const Simulation& simulation, const char* name) {
  return simulation.find_entity(name)->serial;
}

/// Three radios in range of each other; the one that is called "far" hears nobody.
Radios three() {
  Radios world(keys_of({{"range", "20"}, {"jitter", "0"}}));
  world.add("first", {});
  world.add("second", {10, 0, 0});
  world.add("third", {0, 10, 0});
  world.add("far", {100, 0, 0});
  world.start();
  return world;
}

TEST(DeliveryTrace, APacketIsSeenOnceForEachRadioThatItReached) {
  Radios world = three();
  Listener listener(*world.simulation);
  world.send("first", {1, 2, 3});
  world.tick(5);
  ASSERT_EQ(listener.seen.size(), 2u);
  std::set<std::uint64_t> receivers;
  for (const FrameDelivery& each : listener.seen) {
    EXPECT_EQ(each.medium, 0u);
    EXPECT_EQ(each.sender, serial(*world.simulation, "first"));
    EXPECT_EQ(each.channel, 0);
    EXPECT_EQ(each.strength, 20) << "as sent, in dBm";
    receivers.insert(each.receiver);
  }
  EXPECT_EQ(receivers, (std::set{serial(*world.simulation, "second"), serial(*world.simulation, "third")}));
}

TEST(DeliveryTrace, AWordAndItsMediumAmongSeveralAreSeen) {
  model::Setup setup = talkers({10});
  setup.media.insert(setup.media.begin(), element("wind", map({})));
  const auto simulation = build(std::move(setup));
  Listener listener(*simulation);
  say(*simulation, "hello");
  advance(*simulation, 5);
  ASSERT_EQ(listener.seen.size(), 1u);
  EXPECT_EQ(listener.seen[0].medium, 1u);
  EXPECT_EQ(listener.seen[0].sender, serial(*simulation, "speaker"));
  EXPECT_EQ(listener.seen[0].receiver, serial(*simulation, "listener1"));
}

TEST(DeliveryTrace, OfASenderThatIsGoneNothingIsSeen) {
  model::Setup setup = talkers({9});
  const auto simulation = build(std::move(setup));
  Listener listener(*simulation);
  say(*simulation, "hello");
  advance(*simulation, 1);
  simulation->submit(DeleteRequest{"speaker"});
  advance(*simulation, 5);  // 9 m at 340 m/s are 0.026 s
  EXPECT_EQ(value(*simulation, "media/air.heard"), 1);
  EXPECT_TRUE(listener.seen.empty());
}

TEST(DeliveryTrace, LookingChangesNothing) {
  const auto hash_of = [](int lookers, bool wanted) {
    Radios world = three();
    std::vector<std::unique_ptr<Listener>> listeners;
    for (int i = 0; i < lookers; ++i) {
      listeners.push_back(std::make_unique<Listener>(*world.simulation));
      listeners.back()->wanted = wanted;
    }
    for (int i = 0; i < 20; ++i) {
      world.send(i % 2 ? "first" : "second", {static_cast<std::uint8_t>(i)});
      world.tick();
    }
    for (const auto& each : listeners) EXPECT_EQ(each->seen.empty(), !wanted);
    return world.simulation->state_hash();
  };
  const std::uint64_t alone = hash_of(0, false);
  EXPECT_EQ(hash_of(1, false), alone);
  EXPECT_EQ(hash_of(1, true), alone);
  EXPECT_EQ(hash_of(3, true), alone);
}

}  // namespace
}  // namespace sandlot::test
