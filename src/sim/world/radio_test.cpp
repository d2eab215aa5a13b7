/// Radios in a running world: each property against its closed form; State saved in the middle, forged, and kept apart.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/math.h"
#include "media/packet.h"
#include "media/radio/bit_errors.h"
#include "model/substance.h"
#include "sim/test_radios.h"

namespace sandlot::test {
namespace {

double decibels(double ratio) { return 10 / std::numbers::ln10 * math::log(ratio); }
std::vector<std::uint8_t> text(std::string_view words) { return {words.begin(), words.end()}; }
std::string text(const std::vector<std::uint8_t>& data) { return {data.begin(), data.end()}; }

std::string refused_radio(const Radios& world) {
  Diagnostics diagnostics;
  const auto made = Simulation::create(world.setup, {}, diagnostics);
  return made ? "" : made.error().text();
}

/// A sender at the origin and a receiver on the x axis.
Radios radio_pair(Node medium, double distance_m = 10, double step_s = 0.01) {
  Radios world(std::move(medium), step_s);
  world.add("sender", {});
  world.add("receiver", {distance_m, 0, 0});
  return world;
}

// ------------------------------------------------------------------------------------------------------------- time

TEST(Radio, APacketArrivesWithItsLastBitAfterFlightAndDelay) {
  // 128 + 8 * 5 bits at 10 kbit/s are 16.8 ms, 300 m at 1e5 m/s are 3 ms, and 1 ms of delay: 20.8 ms, in the third tick.
  Radios world = radio_pair(
      keys_of(
          {{"bandwidth", "10e3"}, {"speed", "1e5"}, {"delay", "1 ms"}, {"jitter", "0"}, {"range", "300"}}),
      300);
  world.start();
  world.send("sender", text("hello"));
  for (int tick = 1; tick <= 2; ++tick) {
    world.tick();
    EXPECT_TRUE(world.received("receiver").empty()) << tick;
  }
  world.tick();
  const auto packets = world.received("receiver");
  ASSERT_EQ(packets.size(), 1u);
  EXPECT_EQ(text(packets[0].data), "hello");
  EXPECT_EQ(packets[0].from, "sender");
  EXPECT_EQ(packets[0].stamp.ns, 20'800'000);
  EXPECT_EQ(packets[0].rssi, 20);
  world.tick();
  EXPECT_TRUE(world.received("receiver").empty()) << "received once";
  // One metre farther there is nothing.
  Radios far = radio_pair(keys_of({{"range", "300"}}), 300.001);
  far.start();
  far.send("sender", text("hello"));
  far.tick(5);
  EXPECT_EQ(far.value("receiver/radio.received"), 0);
}

TEST(Radio, PacketsOfARadioFollowOneAnotherAndTheQueueIsBounded) {
  // 128 + 8 bits at 13.6 kbit/s: 10 ms each, in ticks of 10 ms.
  Radios world = radio_pair(keys_of({{"bandwidth", "13600"}, {"jitter", "0"}, {"queue", "3"}}));
  world.start();
  for (int i = 0; i < 5; ++i) world.send("sender", {static_cast<std::uint8_t>('a' + i)});
  std::string came;
  std::vector<std::int64_t> at_ns;
  for (int tick = 0; tick < 8; ++tick) {
    world.tick();
    for (const auto& packet : world.received("receiver")) {
      came += text(packet.data);
      at_ns.push_back(packet.stamp.ns);
    }
  }
  EXPECT_EQ(came, "abc");
  EXPECT_EQ(world.value("media/air.overflowed"), 2);
  ASSERT_EQ(at_ns.size(), 3u);
  EXPECT_EQ(at_ns[1] - at_ns[0], 10'000'000);
  EXPECT_EQ(at_ns[2] - at_ns[1], 10'000'000);
}

TEST(Radio, StartsLieAnywhereInTheTickThatTakesTheOrder) {
  Radios world = radio_pair(keys_of({{"bandwidth", "1e9"}}));
  world.start();
  constexpr int packets = 2000;
  double sum = 0, squares = 0;
  for (int i = 0; i < packets; ++i) {
    const Time begin = world.simulation->now();
    world.send("sender", {});
    world.tick();
    // The last bit may come a microsecond after the tick.
    auto came = world.received("receiver");
    if (came.empty()) {
      world.tick();
      came = world.received("receiver");
    }
    ASSERT_EQ(came.size(), 1u);
    const double share = (came[0].stamp - begin).s() / 0.01;
    EXPECT_GE(share, 0);
    sum += share, squares += share * share;
  }
  // Uniform in [0, 1): mean 1/2 +- 0.289 / sqrt(n), variance 1/12 +- 0.0745 / sqrt(n). Five of them.
  const double mean = sum / packets;
  EXPECT_NEAR(mean, 0.5, 5 * 0.289 / std::sqrt(packets));
  EXPECT_NEAR(squares / packets - mean * mean, 1.0 / 12, 5 * 0.0745 / std::sqrt(packets));
}

// ------------------------------------------------------------------------------------------------------ propagation

TEST(Radio, PowerFollowsTheLogarithmOfTheDistance) {
  for (const double d : {0.3, 1.0, 10.0, 50.0}) {
    Radios world = radio_pair(keys_of({{"model", "log_distance"},
                                       {"exponent", "3"},
                                       {"reference_loss", "41"},
                                       {"sensitivity", "-72.1"}}),
                              d);
    world.start();
    world.send("sender", text("x"));
    world.tick(2);
    // 20 - 41 - 30 lg 50 = -71.97 dBm.
    EXPECT_EQ(world.value("receiver/radio.received"), 1) << d;
    const auto* const topic = topic_cast<msg::RadioReceptionArray>(
        world.simulation->find_topic("/receiver/radio/packets"));
    EXPECT_NEAR(topic->message.packets.at(0).rssi, 20 - 41 - 3 * decibels(std::max(1.0, d)), 1e-9);
  }
  Radios weak = radio_pair(
      keys_of(
          {{"model", "log_distance"}, {"exponent", "3"}, {"reference_loss", "41"}, {"sensitivity", "-72.1"}}),
      51);
  weak.start();
  weak.send("sender", text("x"));
  weak.tick(2);
  EXPECT_EQ(weak.value("receiver/radio.received"), 0);
  EXPECT_EQ(weak.value("media/air.weak"), 1);
}

TEST(Radio, ShadowingIsThatOfThePairBothWaysAndOfNobodyElse) {
  const auto rssi = [](bool with_third, const char* from, const char* to) {
    Radios world(keys_of({{"model", "log_distance"}, {"shadowing", "6"}, {"sensitivity", "-200"}}));
    if (with_third) world.add("third", {1, 1, 0});
    world.add("a", {});
    world.add("b", {5, 0, 0});
    world.start();
    world.send(from, text("x"));
    world.tick(2);
    return topic_cast<msg::RadioReceptionArray>(
               world.simulation->find_topic(std::string("/") + to + "/radio/packets"))
        ->message.packets.at(0)
        .rssi;
  };
  const double there = rssi(false, "a", "b");
  EXPECT_EQ(there, rssi(false, "b", "a"));
  EXPECT_EQ(there, rssi(true, "a", "b"));
  EXPECT_NE(there, 20 - 40 - 2.5 * decibels(5));
}

TEST(Radio, EachBodyInTheLineLosesByItsLabelOrSubstance) {
  Node medium = keys_of({{"obstacle_loss", "5"}});
  Node losses = Node::sequence();
  losses.push(keys_of({{"of", "metal"}, {"loss", "30 dB"}}));
  losses.push(keys_of({{"of", "hedge"}, {"loss", "2"}}));
  medium.set("obstacles", losses);
  Radios world = radio_pair(medium);
  const Box wall{{0.1, 4, 4}};
  world.add_thing("plain", wall, {2, 0, 0});
  world.add_thing("cabinet", wall, {4, 0, 0}, model::substance_from("metal(0.5)").value().substance);
  world.add_thing("bush", wall, {6, 0, 0}).label = "hedge";
  world.add_thing("aside", wall, {8, 10, 0});
  for (const char* engine : {"rigid", "planar"}) {
    world.setup.engine = engine;
    world.start();
    world.send("sender", text("x"));
    world.tick(2);
    const auto* const topic = topic_cast<msg::RadioReceptionArray>(
        world.simulation->find_topic("/receiver/radio/packets"));
    ASSERT_EQ(topic->message.packets.size(), 1u) << engine;
    EXPECT_EQ(topic->message.packets[0].rssi, 20 - 5 - 30 - 2) << engine;
  }
}

// ----------------------------------------------------------------------------------------------------------- access

/// Two senders at 10 m and 20 m from a receiver, all packets of one length: 128 + 8 bits at 13.6 kbit/s, 10 ms.
Radios crowd(Node keys) {
  keys.set("bandwidth", Node::scalar("13600"));
  keys.set("jitter", Node::scalar("0"));
  Radios world(std::move(keys));
  world.add("receiver", {});
  world.add("near", {10, 0, 0});
  world.add("far", {0, 20, 0});
  return world;
}

TEST(Radio, PacketsThatOverlapDestroyEachOtherUnlessOneIsCaptured) {
  // Log-distance with n = 4: 40 lg 2 = 12.04 dB apart.
  for (const auto& [capture, survive] : {std::pair("12", 1), {"12.1", 0}, {"1000", 0}}) {
    Radios world = crowd(keys_of({{"model", "log_distance"}, {"exponent", "4"}, {"capture", capture}}));
    world.start();
    world.send("near", text("n"));
    world.send("far", text("f"));
    world.tick(3);
    EXPECT_EQ(world.value("receiver/radio.received"), survive) << capture;
    // The senders are deaf for each other.
    EXPECT_EQ(world.value("media/air.deaf"), 2) << capture;
    EXPECT_EQ(world.value("media/air.collided"), 2 - survive) << capture;
  }
  // In the model range all are as strong.
  Radios equal = crowd(keys_of({{"capture", "0"}}));
  equal.start();
  equal.send("near", text("n"));
  equal.send("far", text("f"));
  equal.tick(3);
  EXPECT_EQ(equal.value("receiver/radio.received"), 2) << "0 dB is captured where 0 dB is the ratio";
}

TEST(Radio, ATouchInTimeIsNoOverlapAndALastBitIs) {
  // The second packet begins when the first one ends, and 1 ms before.
  for (const auto& [begin_ms, received] : {std::pair(10, 2), {9, 0}}) {
    Radios world = crowd(keys_of({{"speed", "1e12"}, {"capture", "1000"}}));
    world.setup.step = Time::from_s(0.001);
    world.start();
    world.send("near", text("n"));
    world.tick(begin_ms);
    world.send("far", text("f"));
    world.tick(25);
    EXPECT_EQ(world.value("receiver/radio.received"), received) << begin_ms;
  }
}

TEST(Radio, ChannelsAreApartAndMayBeTuned) {
  Radios world = crowd(keys_of({{"capture", "1000"}}));
  world.setup.instances[2].devices.edit().front().config = keys_of({{"channel", "7"}});
  world.start();
  world.send("near", text("n"));
  world.send("far", text("f"));
  world.tick(3);
  EXPECT_EQ(world.value("receiver/radio.received"), 1);
  EXPECT_EQ(world.value("media/air.collided"), 0);
  world.simulation->submit(ParameterRequest{"receiver/radio", "channel", Node::scalar("7")});
  world.tick();
  world.send("far", text("f"));
  world.tick(2);
  const auto* const topic = topic_cast<msg::RadioReceptionArray>(
      world.simulation->find_topic("/receiver/radio/packets"));
  EXPECT_EQ(world.value("receiver/radio.received"), 2);
  EXPECT_EQ(topic->message.packets.at(0).channel, 7);
}

TEST(Radio, ARadioThatSendsIsDeafUnlessItIsFullDuplex) {
  for (const bool half : {true, false}) {
    Radios world = radio_pair(keys_of({{"half_duplex", half ? "true" : "false"}, {"jitter", "0"}}));
    world.start();
    world.send("sender", text("ping"));
    world.send("receiver", text("pong"));
    world.tick(2);
    EXPECT_EQ(world.value("sender/radio.received"), half ? 0 : 1);
    EXPECT_EQ(world.value("receiver/radio.received"), half ? 0 : 1);
    EXPECT_EQ(world.value("media/air.deaf"), half ? 2 : 0);
  }
}

TEST(Radio, CarrierSenseWaitsForTheOtherOrGivesUp) {
  // Both are ready at once; each waits 1 to 8 slots of 1 ms and then senses. Unless they draw the same, the second waits.
  Node csma = keys_of({{"slot", "1 ms"}, {"attempts", "20"}});
  Node keys = keys_of({{"access", "csma"}, {"capture", "1000"}});
  keys.set("csma", csma);
  Radios world = crowd(keys);
  world.start();
  world.send("near", text("n"));
  world.tick();
  world.send("far", text("f"));
  world.tick(30);
  EXPECT_EQ(world.value("receiver/radio.received"), 2);
  // A channel that is always busy: the packet is given up. The noise threshold lies below any signal.
  csma.set("attempts", Node::scalar("1"));
  keys.set("csma", csma);
  keys.set("bandwidth", Node::scalar("100"));
  Radios busy(keys);
  busy.add("receiver", {});
  busy.add("near", {10, 0, 0});
  busy.add("far", {0, 20, 0});
  busy.start();
  busy.send("near", text("n"));
  busy.tick(3);
  busy.send("far", text("f"));
  busy.tick(3);
  EXPECT_EQ(busy.value("media/air.given_up"), 1);
}

// ----------------------------------------------------------------------------------------------------- the receiver

TEST(Radio, PacketsAreForARobotATeamAnAddressOrAll) {
  Radios world(keys_of({{"bandwidth", "1e9"}}));
  world.setup.teams.push_back({.name = "red"});
  world.setup.teams.push_back({.name = "blue"});
  world.add("sender", {});
  world.add("one", {1, 0, 0}).team = "red";
  world.add("two", {2, 0, 0}, keys_of({{"address", "base"}})).team = "blue";
  world.add("spy", {3, 0, 0}, keys_of({{"promiscuous", "true"}}));
  world.start();
  for (const char* to : {"", "one", "red", "base", "nobody"}) world.send("sender", text("x"), to);
  world.tick(2);
  EXPECT_EQ(world.value("one/radio.received"), 3);
  EXPECT_EQ(world.value("two/radio.received"), 2);
  EXPECT_EQ(world.value("spy/radio.received"), 5);
}

TEST(Radio, AMessageOverTheLimitIsRefusedAndCounted) {
  Radios world = radio_pair(Node::map());
  world.setup.instances[0].devices.edit().front().config = keys_of({{"max_size", "4"}});
  world.start();
  world.send("sender", text("12345"));
  world.send("sender", text("1234"), std::string(300, 'x'));
  world.send("sender", text("1234"));
  world.tick(2);
  EXPECT_EQ(world.value("sender/radio.orders.refused"), 2);
  EXPECT_EQ(world.value("receiver/radio.received"), 1);
}

TEST(Radio, WithoutARateASampleIsTakenWhenSomethingCame) {
  Radios world = radio_pair(Node::map());
  world.add("slow", {1, 0, 0}, keys_of({{"rate", "10"}}));
  world.start();
  const auto count = [&](const char* topic) { return world.simulation->find_topic(topic)->count; };
  world.tick(20);
  EXPECT_EQ(count("/receiver/radio/packets"), 0u);
  EXPECT_EQ(count("/slow/radio/packets"), 3u) << "at 0, 100 and 200 ms, with nothing";
  world.send("sender", text("x"));
  world.tick(2);
  EXPECT_EQ(count("/receiver/radio/packets"), 1u);
}

TEST(Radio, BitErrorsFollowTheirFormulaAndAreThoseOfThePair) {
  // Q(sqrt(2)) for bpsk at 0 dB, from tables; exp(-1/2) / 2 for fsk.
  EXPECT_NEAR(media::radio::error_rate(media::radio::Modulation::bpsk, 1), 0.078649603525, 1e-12);
  EXPECT_NEAR(media::radio::error_rate(media::radio::Modulation::qpsk, 2), 0.078649603525, 1e-12);
  EXPECT_NEAR(media::radio::error_rate(media::radio::Modulation::fsk, 1), 0.303265329856, 1e-12);
  // Each bit with p: mean n p, deviation sqrt(n p (1 - p)); five of them.
  for (const double p : {1e-4, 0.01, 0.5}) {
    std::vector<std::uint8_t> data(50'000, 0);
    Stream random(1, 2, Purpose::medium, 3);
    const double wrong = media::radio::flip_bits(data, p, random), n = 400'000;
    EXPECT_NEAR(wrong, n * p, 5 * std::sqrt(n * p * (1 - p))) << p;
    double ones = 0;
    for (const std::uint8_t byte : data) ones += std::popcount(byte);
    EXPECT_EQ(ones, wrong);
  }
  const auto received = [](bool one_more) {
    Node levels = Node::sequence(), keys = Node::map();
    levels.push(Node::scalar("bits"));
    keys.set("levels", levels);
    Radios world(keys_of({{"bit_error_rate", "0.01"}, {"drop", "0.3"}}));
    if (one_more) world.add("aardvark", {1, 0, 0}, keys);
    world.add("sender", {});
    world.add("receiver", {10, 0, 0}, keys);
    world.start();
    std::string all;
    for (int i = 0; i < 50; ++i) {
      world.send("sender", text("the same words"));
      world.tick();
      for (const auto& packet : world.received("receiver", "bits")) all += text(packet.data);
    }
    return all;
  };
  const std::string alone = received(false);
  EXPECT_GT(alone.size(), 300u);
  EXPECT_NE(alone.find("the same words"), std::string::npos);
  EXPECT_EQ(alone, received(true));
}

// ------------------------------------------------------------------------------------------- infrared, range, bearing

TEST(Infrared, PowerFollowsBeamDistanceAndIncidence) {
  Radios world(Node::map(), 0.01, "infrared");
  world.add("sender", {});
  // At 30 degrees from the beam's axis, 2 m away, turned by 170 degrees so that the light comes from 40 degrees aside.
  const double off = math::pi / 6, turned = math::pi * 170 / 180;
  world.add("receiver", {2 * math::cos(off), 2 * math::sin(off), 0}, keys_of({{"sensitivity", "-90"}}),
            turned);
  world.add("away", {2, 0, 0});                           // looks along x, away from the sender
  world.add("behind", {-1, 0, 0});                        // looks at its back
  world.add("hidden", {4, 0, 0}, Node::map(), math::pi);  // behind `away`
  world.add("beyond", {0, -5.01, 0}, Node::map(), math::pi / 2);
  world.start();
  world.send("sender", text("flash"));
  world.tick();
  const auto packets = world.received("receiver");
  ASSERT_EQ(packets.size(), 1u);
  const double order = -math::log(2) / math::log(math::cos(0.35));
  const double incidence = std::abs(math::wrap_angle(off + math::pi - turned));
  const double power_W = 0.05 * math::pow(math::cos(off), order) / 4 * 1e-5 * math::cos(incidence);
  EXPECT_NEAR(packets[0].rssi, decibels(1000 * power_W), 1e-6);
  for (const char* dark : {"away", "behind", "hidden", "beyond"})
    EXPECT_EQ(world.value(std::string(dark) + "/radio.received"), 0) << dark;
  EXPECT_EQ(world.value("media/air.blocked"), 1);
}

TEST(RangeBearing, MeasuresWhoAndWhere) {
  Radios world(Node::map(), 0.01);
  world.next_are("range_bearing");
  const double yaw = 0.7;
  world.add("me", {1, 2, 0}, keys_of({{"beacon_rate", "0"}}), yaw);
  world.add("other", {1 + 3 * math::cos(1.0), 2 + 3 * math::sin(1.0), 4}, keys_of({{"beacon_rate", "20"}}));
  world.start();
  world.send("other", text("hi"));
  int came = 0;
  for (int tick = 0; tick < 100; ++tick) {
    world.tick();
    const auto* const topic = topic_cast<msg::RangeBearingArray>(
        world.simulation->find_topic("/me/radio/neighbours"));
    if (topic->count == 0 || topic->stamp != world.simulation->now()) continue;
    for (const msg::RangeBearing& each : topic->message.neighbours) {
      ++came;
      EXPECT_EQ(each.from, "other");
      EXPECT_NEAR(each.range, 5, 1e-9);
      EXPECT_NEAR(each.bearing, 1.0 - yaw, 1e-9);
      EXPECT_NEAR(each.elevation, math::atan2(4, 3), 1e-9);
      EXPECT_EQ(text(each.data), "hi");
    }
  }
  EXPECT_EQ(came, 20) << "20 beacons in a second";
}

TEST(RangeBearing, ANeighbourMoreChangesNoOthersNoise) {
  const auto ranges = [](bool one_more) {
    Radios world(keys_of({{"collisions", "false"}, {"half_duplex", "false"}}));
    world.next_are("range_bearing");
    if (one_more) world.add("aardvark", {0, 1, 0});
    Node noise = keys_of({{"std", "0.1"}}), keys = Node::map();
    keys.set("range_noise", noise);
    world.add("me", {}, keys);
    world.add("other", {3, 0, 0});
    world.start();
    std::vector<double> out;
    for (int tick = 0; tick < 1000; ++tick) {
      world.tick();
      const auto* const topic = topic_cast<msg::RangeBearingArray>(
          world.simulation->find_topic("/me/radio/neighbours"));
      if (topic->count == 0 || topic->stamp != world.simulation->now()) continue;
      for (const msg::RangeBearing& each : topic->message.neighbours)
        if (each.from == "other") out.push_back(each.range);
    }
    return out;
  };
  const std::vector<double> alone = ranges(false);
  EXPECT_EQ(alone, ranges(true));
  ASSERT_GE(alone.size(), 99u);
  double sum = 0;
  for (const double each : alone) sum += each;
  EXPECT_NEAR(sum / static_cast<double>(alone.size()), 3, 5 * 0.1 / std::sqrt(99));
}

// ------------------------------------------------------------------------------------------------------------ State

/// Eight radios that all speak at once, slowly: packets wait, are on the air, and overlap.
Radios chatter(const char* access) {
  Radios world(keys_of({{"model", "log_distance"},
                        {"bandwidth", "20e3"},
                        {"speed", "1e4"},
                        {"shadowing", "4"},
                        {"fading", "2"},
                        {"modulation", "fsk"},
                        {"bit_error_rate", "0.002"},
                        {"drop", "0.1"},
                        {"capture", "3"},
                        {"delay", "4 ms"},
                        {"access", access}}));
  for (int i = 0; i < 8; ++i) world.add("r" + std::to_string(i), {1.0 * i, 0.3 * i * i, 0.1 * i});
  world.next_are("range_bearing");
  world.add("buoy", {2, 2, 0});
  return world;
}
void talk(Radios& world, std::uint64_t until) {
  while (world.simulation->tick_index() < until) {
    const auto tick = world.simulation->tick_index();
    if (tick == 11) world.send("buoy", text("mind the rock"));
    for (std::uint64_t i = 0; i < 8; ++i)
      if (tick % (5 + i) == i) world.send("r" + std::to_string(i), text("at " + std::to_string(tick)));
    world.tick();
  }
}

TEST(Radio, GoesOnFromASnapshotInAnyNumberOfThreads) {
  for (const char* access : {"aloha", "csma"}) {
    Radios whole = chatter(access);
    whole.start();
    talk(whole, 150);
    EXPECT_GT(whole.value("media/air.delivered"), 20) << access;
    EXPECT_GT(whole.value("media/air.collided"), 5) << access;
    for (const std::uint64_t at : {23u, 50u, 99u}) {
      Radios first = chatter(access);
      first.start();
      talk(first, at);
      const std::vector<std::byte> snapshot = first.simulation->snapshot();
      for (const int threads : {1, 2, 4}) {
        Radios second = chatter(access);
        Diagnostics diagnostics;
        auto restored = Simulation::restore(snapshot, {.threads = threads}, diagnostics);
        ASSERT_TRUE(restored) << restored.error().text();
        second.simulation = std::move(*restored);
        EXPECT_EQ(second.simulation->state_hash(), first.simulation->state_hash());
        talk(second, 150);
        EXPECT_EQ(second.simulation->state_hash(), whole.simulation->state_hash())
            << access << " from " << at << " in " << threads << " threads";
      }
    }
  }
}

TEST(Radio, ForgedStateIsRefused) {
  Radios world = chatter("aloha");
  world.start();
  talk(world, 40);
  const WorldElements::Part& part = *world.simulation->elements().find_part("media/air");
  ByteWriter w;
  world.simulation->elements().save(part, w);
  const std::vector<std::byte> bytes(w.bytes().begin(), w.bytes().end());
  Radios fresh = chatter("aloha");
  fresh.start();
  auto& elements = const_cast<WorldElements&>(fresh.simulation->elements());
  const WorldElements::Part& own = *elements.find_part("media/air");
  ByteReader whole(bytes);
  EXPECT_TRUE(elements.load(own, whole) && whole.remaining() == 0);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader cut(std::span<const std::byte>(bytes).first(size));
    EXPECT_FALSE(elements.load(own, cut)) << size;
  }
  // Whatever a byte becomes, it is refused, or the world runs on.
  int refusals = 0;
  Stream random(1, 2, Purpose::experiment, 3);
  for (int i = 0; i < 300; ++i) {
    std::vector<std::byte> forged = bytes;
    forged[random.below(static_cast<std::uint32_t>(forged.size()))] = static_cast<std::byte>(
        random.below(256));
    ByteReader r(forged);
    if (!elements.load(own, r) || r.remaining() != 0) {
      ++refusals;
      ByteReader again(bytes);
      ASSERT_TRUE(elements.load(own, again));
      continue;
    }
    ASSERT_TRUE(fresh.simulation->tick());
  }
  EXPECT_GT(refusals, 20);
}

TEST(Radio, RadiosThatGoAreForgottenWithTheirPackets) {
  Radios world = chatter("csma");
  world.start();
  talk(world, 30);
  world.simulation->submit(DeleteRequest{"r3"});
  world.simulation->submit(DeleteRequest{"r4"});
  world.tick(30);
  SUCCEED();
}

TEST(Radio, WrongKeysAreNamed) {
  EXPECT_NE(refused_radio(radio_pair(keys_of({{"bandwidth", "0"}}))).find("/bandwidth"), std::string::npos);
  Node csma = keys_of({{"min_exponent", "6"}});
  Node keys = Node::map();
  keys.set("csma", csma);
  EXPECT_NE(refused_radio(radio_pair(keys)).find("max_exponent is less than min_exponent"),
            std::string::npos);
  Radios none = radio_pair(Node::map());
  none.setup.media.clear();
  EXPECT_NE(refused_radio(none).find("media: [{kind: radio}]"), std::string::npos) << refused_radio(none);
}

TEST(Packet, ItsBytesGiveItBackAndOthersAreRefused) {
  std::vector<std::byte> out;
  const auto data = text("data");
  write_packet({.number = 7, .x_m = 1, .wrong_bits = 2}, "me", "you", data, out);
  const std::vector<std::uint8_t> bytes(reinterpret_cast<const std::uint8_t*>(out.data()),
                                        reinterpret_cast<const std::uint8_t*>(out.data()) + out.size());
  const auto packet = read_packet(bytes);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->from, "me");
  EXPECT_EQ(packet->to, "you");
  EXPECT_EQ(packet->number(), 7u);
  EXPECT_EQ(std::vector<std::uint8_t>(packet->data.begin(), packet->data.end()), data);
  for (std::size_t size = 0; size < sizeof(PacketHead) + 5; ++size)
    EXPECT_FALSE(read_packet(std::span(bytes).first(size))) << size;
}

}  // namespace
}  // namespace sandlot::test
