/// Radios in a running world: fading, carrier sense, interference of several, and the energy of what is sent.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/math.h"
#include "sim/test_radios.h"

namespace sandlot::test {
namespace {

std::vector<std::uint8_t> bytes(std::size_t count) { return std::vector<std::uint8_t>(count, 0x5a); }

TEST(Radio, FadingIsDrawnForEachPacketWithItsDeviation) {
  // 20 - 40 - 25 lg 10 = -45 dBm, and 2 dB of fading, of which the cut at three deviations leaves 0.9975.
  Radios world(keys_of({{"model", "log_distance"},
                        {"exponent", "2.5"},
                        {"fading", "2"},
                        {"bandwidth", "1e9"},
                        {"jitter", "0"},
                        {"sensitivity", "-200"},
                        {"noise_floor", "-200"}}));
  world.add("sender", {});
  world.add("receiver", {10, 0, 0});
  world.start();
  constexpr int packets = 2000;
  double sum = 0, squares = 0, products = 0, before = 0;
  for (int i = 0; i < packets; ++i) {
    world.send("sender", bytes(1));
    world.tick();
    const auto came = world.received("receiver");
    ASSERT_EQ(came.size(), 1u);
    const double x = came[0].rssi + 45;
    sum += x, squares += x * x, products += x * before;
    before = x;
  }
  EXPECT_NEAR(sum / packets, 0, 5 * 2 / std::sqrt(packets));
  EXPECT_NEAR(std::sqrt(squares / packets), 2 * 0.9975, 5 * 2 / std::sqrt(2.0 * packets));
  // Neighbours are independent: the mean product has the deviation std^2 / sqrt(n).
  EXPECT_NEAR(products / packets, 0, 5 * 4 / std::sqrt(packets));
}

/// Carrier sense with slots of 1 ms and packets of 0.5 ms: 128 + 8 bits at 272 kbit/s.
Radios sensing() {
  Node keys = keys_of({{"access", "csma"}, {"bandwidth", "272e3"}, {"jitter", "0"}, {"speed", "1e12"}});
  keys.set("csma", keys_of({{"slot", "1 ms"}, {"min_exponent", "0"}, {"max_exponent", "5"}}));
  Radios world(std::move(keys));
  world.add("receiver", {});
  world.add("one", {10, 0, 0});
  world.add("two", {0, 10, 0});
  return world;
}

TEST(Radio, CarrierSenseWaitsOneSlotAtExponentZeroAndUpToTwoAfterABusyOne) {
  // Exponent 0: 1 slot; both sense at 1 ms, and the one that is later in order hears the other begin. It waits 1 or 2 slots
  // more, the channel is free by then: the last bits come at 1.5 ms and at 2.5 or 3.5 ms, half of the times each.
  Radios world = sensing();
  world.start();
  constexpr int times = 200;
  int short_waits = 0;
  for (int i = 0; i < times; ++i) {
    const Time begin = world.simulation->now();
    world.send("one", bytes(1));
    world.send("two", bytes(1));
    world.tick();
    const auto came = world.received("receiver");
    ASSERT_EQ(came.size(), 2u);
    EXPECT_EQ((came[0].stamp - begin).ns, 1'500'000);
    const std::int64_t second_ns = (came[1].stamp - begin).ns;
    EXPECT_TRUE(second_ns == 2'500'000 || second_ns == 3'500'000) << second_ns;
    short_waits += second_ns == 2'500'000;
  }
  EXPECT_NEAR(short_waits, times / 2, 5 * 0.5 * std::sqrt(times));
}

TEST(Radio, CarrierSenseHearsItsOwnChannelAlone) {
  // The packet of `one` fills channel 0 for 1.36 s; `two`, which hears it begin, changes to channel 7, where nobody sends.
  Radios world = sensing();
  world.setup.media.front().config.set("bandwidth", Node::scalar("100"));
  world.start();
  world.send("one", bytes(1));
  world.tick();
  world.simulation->submit(ParameterRequest{"two/radio", "channel", Node::scalar("7")});
  world.send("two", bytes(1));
  world.tick();
  EXPECT_EQ(world.value("media/air.sent"), 2);
}

TEST(Radio, APacketHasToExceedTheSumOfAllThatOverlapIt) {
  // Exponent 4: 40 lg 2 = 12.04 dB above each of the two far ones, so 9.03 dB above both.
  for (const auto& [capture, received] : {std::pair("9", 1), {"9.1", 0}}) {
    Radios world(
        keys_of({{"model", "log_distance"}, {"exponent", "4"}, {"capture", capture}, {"jitter", "0"}}));
    world.add("receiver", {});
    world.add("near", {10, 0, 0});
    world.add("left", {0, 20, 0});
    world.add("right", {0, -20, 0});
    world.start();
    for (const char* each : {"near", "left", "right"}) world.send(each, bytes(1));
    world.tick(2);
    EXPECT_EQ(world.value("receiver/radio.received"), received) << capture;
  }
}

TEST(Radio, WhatOverlapsAPartOfAPacketInterferesWithThatPart) {
  // 8128 bits at 812.8 kbit/s: 10 ms. They come after 1 ms and 10 ms, so a tenth of each overlaps the other, of equal power:
  // s = 10, and for fsk p = exp(-5) / 2 of 2 x 8000 bits. Five standard deviations.
  Radios world(keys_of({{"range", "200"},
                        {"speed", "1e4"},
                        {"bandwidth", "812800"},
                        {"jitter", "0"},
                        {"capture", "-50"},
                        {"modulation", "fsk"}}));
  world.add("receiver", {});
  world.add("near", {10, 0, 0});
  world.add("far", {-100, 0, 0});
  world.start();
  world.send("near", bytes(1000));
  world.send("far", bytes(1000));
  world.tick(4);
  EXPECT_EQ(world.value("media/air.delivered"), 4) << "each at the receiver and, later, at the other";
  const double p = 0.5 * math::exp(-5), n = 16'000;
  EXPECT_NEAR(world.value("media/air.wrong_bits"), n * p, 5 * std::sqrt(n * p * (1 - p)));
}

TEST(Radio, DrawsEnergyPerBitOfDataFromTheBattery) {
  Radios world(Node::map());
  model::Instance& sender = world.add("sender", {}, keys_of({{"energy_per_bit", "1 mJ"}}));
  model::DeviceDecl battery;
  battery.name = battery.kind = "battery";
  battery.config = keys_of({{"capacity", "10 J"}});
  sender.devices.push_back(battery);
  world.add("receiver", {1, 0, 0});
  world.start();
  world.send("sender", bytes(10));
  world.tick();
  EXPECT_NEAR(world.value("sender/radio.drawn"), 10 * 8 * 1e-3, 1e-15);
  EXPECT_NEAR(world.value("sender/battery.energy"), 10 - 0.08, 1e-12);
}

TEST(Infrared, NothingArrivesBelowTheLeastIrradiance) {
  // 0.05 W/sr at 2 m on the axis: 0.0125 W/m^2.
  for (const auto& [least, delivered] : {std::pair("0.0124", 1), {"0.0126", 0}}) {
    Radios world(keys_of({{"least", least}}), 0.01, "infrared");
    world.add("sender", {});
    world.add("receiver", {2, 0, 0}, Node::map(), math::pi);
    world.start();
    world.send("sender", bytes(1));
    world.tick();
    EXPECT_EQ(world.value("media/air.delivered"), delivered) << least;
  }
}

}  // namespace
}  // namespace sandlot::test
