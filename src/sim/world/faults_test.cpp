/// Devices that fail, clocks that are wrong, and the factors on all errors, in a whole simulation.
#include "sim/world/faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "messages/messages.h"
#include "sim/test_log.h"
#include "sim/test_values.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

Node failure(const char* kind, const char* from, const char* until, const char* factor = "10") {
  return map({{"kind", kind}, {"from", from}, {"until", until}, {"factor", factor}});
}
Node fault_list(std::initializer_list<Node> all) {
  Node out = Node::sequence();
  for (const Node& each : all) out.push(each);
  return out;
}

/// Two rovers that stand still: their lasers (10 Hz, 1 cm of noise per beam) show another scan in every sample.
model::Setup standing() { return arena("planar", 2, ""); }
std::unique_ptr<Simulation> world_with(const char* name, const char* key, Node value) {
  model::Setup setup = standing();
  device_of(setup, "rover1", name).config.set(key, std::move(value));
  return build(std::move(setup));
}
const Topic<msg::LaserScan>& laser(const Simulation& simulation, const char* name = "rover1/laser") {
  return *topic_cast<msg::LaserScan>(simulation.find_topic(name));
}

TEST(Faults, StuckRepeatsDeadIsSilentAndAfterwardsAllIsAsWithout) {
  const auto whole = build(standing());
  const auto failing = world_with(
      "laser", "failures", fault_list({failure("stuck", "1 s", "2 s"), failure("dead", "3 s", "4 s")}));
  std::vector<float> last;
  for (int tick = 1; tick <= 500; ++tick) {
    advance(*whole, 1);
    advance(*failing, 1);
    const double t = failing->now().s();
    const auto &seen = laser(*failing), &right = laser(*whole);
    if (t < 1) last = right.message.ranges;
    if (t >= 1 && t < 2) {  // the last scan before, with new times
      ASSERT_EQ(seen.message.ranges, last) << t;
      ASSERT_NE(seen.message.ranges, right.message.ranges) << t;
      ASSERT_EQ(seen.stamp, right.stamp) << t;
      ASSERT_EQ(seen.message.header.stamp, right.message.header.stamp) << t;
      ASSERT_EQ(seen.count, right.count) << t;
    } else if (t >= 3 && t < 4) {  // samples at 0, 0.1, ... 2.9 were published
      ASSERT_EQ(seen.count, 30u) << t;
      ASSERT_NEAR(seen.stamp.s(), 2.9, 1e-9);
    } else {
      ASSERT_EQ(seen.message.ranges, right.message.ranges) << t;
      ASSERT_EQ(seen.stamp, right.stamp) << t;
      ASSERT_EQ(seen.count, right.count - (t >= 4 ? 10 : 0)) << t;
    }
    if (tick % 50 != 0) continue;
    const auto other = by_path(*whole);
    for (const auto& [path, hash] : by_path(*failing)) {
      if (path == "rover1/laser") continue;
      ASSERT_EQ(hash, other.at(path)) << path << " at " << t;
    }
  }
}

TEST(Faults, AStuckDeviceWithoutAMessageBeforeHasNothingToRepeat) {
  const auto simulation = world_with("laser", "failures", fault_list({failure("stuck", "0", "1 s")}));
  advance(*simulation, 99);
  EXPECT_EQ(laser(*simulation).count, 0u);
  advance(*simulation, 1);
  EXPECT_EQ(laser(*simulation).count, 1u);
}

TEST(Faults, AStuckDeviceRepeatsOnlyWhatItWouldHavePublished) {
  model::Setup setup = standing();
  device_of(setup, "rover1", "laser").config.set("failures", fault_list({failure("stuck", "1 s", "3 s")}));
  const auto simulation = build(std::move(setup));
  const auto count = [&](const char* topic) { return simulation->find_topic(topic)->count; };
  simulation->submit(LevelRequest{"rover1/laser", {"ranges", "pose"}});
  advance(*simulation, 150);
  EXPECT_EQ(count("/rover1/laser/ranges"), 16u);  // at 0, 0.1, ... 1.5 s
  EXPECT_EQ(count("/rover1/laser/pose"), 15u);
  simulation->submit(LevelRequest{"rover1/laser", {"ranges"}});
  advance(*simulation, 50);
  EXPECT_EQ(count("/rover1/laser/ranges"), 21u);
  EXPECT_EQ(count("/rover1/laser/pose"), 15u) << "a level that is off is silent, stuck or not";
  EXPECT_EQ(simulation->find_topic("/rover1/laser/ranges")->stamp, simulation->now());
}

TEST(Faults, AnOrderBeginsAndEndsThemInTheRunAndTheLogRepeatsIt) {
  const auto make = [] {
    model::Setup setup = standing();
    device_of(setup, "rover2", "laser").config.set("failures", fault_list({failure("dead", "1 s", "9 s")}));
    return build(std::move(setup));
  };
  TickLog live, repeated;
  const auto whole = build(standing()), run = make();
  run->add_observer(&live);
  const auto order = [&](const char* name, Node value) {
    run->submit(ParameterRequest{name, "failure", std::move(value)});
  };
  std::vector<float> last;
  for (int tick = 1; tick <= 500; ++tick) {
    if (tick == 100) order("rover1/laser", Node::scalar("stuck"));
    if (tick == 200) order("rover1/laser", Node::scalar("none"));
    if (tick == 300) order("rover1/laser", map({{"kind", "noisy"}, {"factor", "3"}}));
    if (tick == 400) order("rover1/laser", Node::scalar("planned"));
    if (tick == 300) order("rover2/laser", Node::scalar("none"));  // against the plan
    if (tick == 400) order("rover2/laser", Node::scalar("planned"));
    advance(*whole, 1);
    advance(*run, 1);
    const double t = run->now().s();
    const auto &seen = laser(*run), &right = laser(*whole);
    if (t < 1) last = right.message.ranges;
    if (t >= 1 && t < 2) {
      ASSERT_EQ(seen.message.ranges, last) << t;
      ASSERT_EQ(seen.count, right.count) << t;
    } else if (t >= 3 && t < 4) {
      ASSERT_NE(seen.message.ranges, right.message.ranges) << t;
    } else {
      ASSERT_EQ(seen.message.ranges, right.message.ranges) << t;
    }
    const auto planned = laser(*run, "rover2/laser").count;
    if (t < 1) ASSERT_EQ(planned, right.count);
    else ASSERT_EQ(planned, t < 3 ? 10u : t < 4 ? right.count - 20 : 20u) << t;
    if (tick % 100 != 50) continue;
    const auto restored = again(*run, {.threads = 2});
    ASSERT_TRUE(restored) << t;
    ASSERT_EQ(restored->state_hash(), run->state_hash()) << t;
    advance(*restored, 7);
    const auto twice = again(*restored);
    ASSERT_TRUE(twice) << t;
    ASSERT_EQ(twice->state_hash(), restored->state_hash()) << t;
  }
  EXPECT_EQ(by_path(*run).at("rover1/laser"), by_path(*whole).at("rover1/laser"));
  EXPECT_EQ(run->sub_hashes()[0].hash, whole->sub_hashes()[0].hash) << "nothing of it stays";

  const auto replay = make();
  replay->add_observer(&repeated);
  for (const auto& entries : live.ticks) {
    for (const LogEntry& entry : entries) {
      if (entry.source.kind == Source::Kind::program) continue;
      Request request;
      ByteReader r(entry.bytes);
      ASSERT_TRUE(read_request(r, request));
      replay->submit(std::move(request), entry.source);
    }
    advance(*replay, 1);
  }
  EXPECT_EQ(repeated.hashes, live.hashes);
}

TEST(Faults, OrdersThatCannotBeAreRefused) {
  const auto simulation = build(standing());
  const auto error_of = [&](const char* target, Node value) {
    simulation->submit(ParameterRequest{target, "failure", std::move(value)});
    advance(*simulation, 1);
    const Status& status = simulation->outcomes().front().status;
    return status ? std::string() : status.error().text();
  };
  EXPECT_EQ(error_of("rover1/drive", Node::scalar("dead")), "");
  EXPECT_THAT(error_of("rover1/drive", Node::scalar("noisy")), HasSubstr("diff_drive has no errors"));
  EXPECT_THAT(error_of("rover1/laser", Node::scalar("ded")), HasSubstr("dead"));
  EXPECT_THAT(error_of("rover1/laser", map({{"kind", "noisy"}, {"factor", "-1"}})), HasSubstr("factor"));
  EXPECT_THAT(error_of("rover1", Node::scalar("dead")), HasSubstr("not a parameter of the whole"));
}

TEST(Faults, ANoisyDeviceErrsMoreByItsFactor) {
  const auto exact = world_with("laser", "errors", Node::scalar("0"));
  const auto whole = build(standing());
  const auto failing = world_with(
      "laser", "failures",
      fault_list({failure("noisy", "0.5 s", "2 s", "4"), failure("noisy", "1 s", "3 s", "0.5")}));
  for (const auto& [ticks, factor] : {std::pair(40, 1.0), {40, 4.0}, {70, 2.0}, {100, 0.5}, {100, 1.0}}) {
    for (Simulation* each : {exact.get(), whole.get(), failing.get()}) advance(*each, ticks);
    const auto &truth = laser(*exact).message.ranges, &once = laser(*whole).message.ranges,
               &seen = laser(*failing).message.ranges;
    int looked_at = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (!std::isfinite(truth[i]) || truth[i] > 5.5F || truth[i] < 0.5F)
        continue;  // away from what it is cut to
      ASSERT_NEAR(seen[i] - truth[i], factor * static_cast<double>(once[i] - truth[i]), 1e-5) << factor;
      ++looked_at;
    }
    EXPECT_GT(looked_at, 20);
    EXPECT_EQ(value(*failing, "rover1/laser.errors"), 1) << "its own factor stays";
  }
}

TEST(Faults, AFailedDriveTakesNoCommandsAndAStuckOneGoesOn) {
  for (const char* engine : {"planar", "rigid"})
    for (const char* kind : {"stuck", "dead"}) {
      model::Setup setup = arena(engine, 1, "");
      device_of(setup, "rover1", "drive").config.set("failures", fault_list({failure(kind, "1 s", "2 s")}));
      const auto simulation = build(std::move(setup));
      const auto order = [&](double v_mps) {
        msg::Twist twist;
        twist.linear.x = v_mps;
        ByteWriter w;
        write(w, twist);
        CommandRequest request{"rover1/drive", msg::Twist::ros_type, {}};
        request.bytes.assign(w.bytes().begin(), w.bytes().end());
        simulation->submit(request);
        advance(*simulation, 1);
        return static_cast<bool>(simulation->outcomes().front().status);
      };
      const auto speed = [&] {
        return math::hypot(value(*simulation, "rover1.twist.linear.x"),
                           value(*simulation, "rover1.twist.linear.y"));
      };
      EXPECT_TRUE(order(0.3));
      advance(*simulation, 97);
      EXPECT_NEAR(speed(), 0.3, 0.03) << engine;
      advance(*simulation, 30);
      EXPECT_FALSE(order(0)) << engine << " " << kind;
      advance(*simulation, 60);
      if (std::string_view(kind) == "stuck") { EXPECT_NEAR(speed(), 0.3, 0.03) << engine; }
      advance(*simulation, 20);
      EXPECT_TRUE(order(0));
      advance(*simulation, 100);
      EXPECT_NEAR(speed(), 0, 0.01) << engine << " " << kind;
    }
}

TEST(Faults, AWrongClockShowsInHeadersAlone) {
  Node clock = map({{"offset", "20 ms"}, {"drift", "0.001"}});
  const auto simulation = world_with("laser", "clock", clock);
  advance(*simulation, 300);
  const auto& scan = laser(*simulation);
  EXPECT_NEAR(scan.stamp.s(), 3, 1e-9);
  EXPECT_NEAR(scan.message.header.stamp.s(), 3.023, 1e-9);
  simulation->submit(ParameterRequest{"rover1", "errors", Node::scalar("0.5")});
  advance(*simulation, 100);
  EXPECT_NEAR(scan.message.header.stamp.s(), 4 + 0.5 * (0.02 + 0.004), 1e-9);
  EXPECT_EQ(laser(*simulation, "rover2/laser").message.header.stamp,
            laser(*simulation, "rover2/laser").stamp);

  const auto jittery = world_with("truth", "clock", map({{"jitter", "2 ms"}}));
  const auto& truth = *topic_cast<msg::Odometry>(jittery->find_topic("rover1/truth"));
  double squares = 0;
  constexpr int n = 400;  // 20 per second
  for (int k = 0; k < n; ++k) {
    advance(*jittery, 5);
    const double error_s = (truth.message.header.stamp - truth.stamp).s();
    squares += error_s * error_s / n;
  }
  EXPECT_NEAR(squares, 4e-6, 4e-6 * 5 * std::sqrt(2.0 / n));
}

TEST(Faults, SnapshotsMayBeTakenInTheMiddleOfOne) {
  model::Setup setup = standing();
  device_of(setup, "rover1", "laser")
      .config.set("failures", fault_list({failure("stuck", "1 s", "2 s"), failure("noisy", "2.5 s", "4 s")}));
  device_of(setup, "rover1", "truth").config.set("failures", fault_list({failure("dead", "1 s", "3 s")}));
  device_of(setup, "rover2", "laser").config.set("clock", map({{"jitter", "2 ms"}}));
  setup.instances.back().errors = 1.5;
  setup.errors = 2;
  const auto simulation = build(std::move(setup));
  for (int part = 0; part < 4; ++part) {
    advance(*simulation, 75);
    const auto restored = again(*simulation);
    ASSERT_TRUE(restored);
    EXPECT_EQ(restored->state_hash(), simulation->state_hash());
    advance(*simulation, 75);
    advance(*restored, 75);
    EXPECT_EQ(restored->state_hash(), simulation->state_hash()) << part;
  }
}

TEST(Errors, FactorsOfWorldRobotAndDeviceMultiplyWhileTheRunGoesOn) {
  const auto exact = world_with("laser", "errors", Node::scalar("0"));
  const auto once = build(standing());
  const auto tuned = build(standing());
  const auto set = [&](const char* target, const char* to) {
    tuned->submit(ParameterRequest{target, "errors", Node::scalar(to)});
  };
  const auto expect = [&](double factor) {
    for (Simulation* each : {exact.get(), once.get(), tuned.get()}) advance(*each, 20);
    for (const auto& outcome : tuned->outcomes())
      EXPECT_TRUE(outcome.status) << outcome.status.error().text();
    const auto &truth = laser(*exact).message.ranges, &right = laser(*once).message.ranges,
               &seen = laser(*tuned).message.ranges;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (!(truth[i] < 5.5F && truth[i] > 0.5F)) continue;
      EXPECT_NEAR(seen[i] - truth[i], factor * static_cast<double>(right[i] - truth[i]), 1e-5) << factor;
    }
    // The other robot errs by the world's factor alone.
    return laser(*tuned, "rover2/laser").message.ranges == laser(*once, "rover2/laser").message.ranges;
  };
  EXPECT_TRUE(expect(1));
  set("rover1", "3");
  EXPECT_TRUE(expect(3));
  set("rover1/laser", "0.5");
  EXPECT_TRUE(expect(1.5));
  set("sim", "2");
  EXPECT_FALSE(expect(3));
  set("rover1", "0");
  EXPECT_FALSE(expect(0));
  EXPECT_EQ(value(*tuned, "sim.errors"), 2);
  EXPECT_EQ(value(*tuned, "rover1.errors"), 0);
  EXPECT_EQ(value(*tuned, "rover1/laser.errors"), 0.5);
  EXPECT_NE(tuned->state_hash(), once->state_hash());
  set("sim", "1"), set("rover1", "1"), set("rover1/laser", "1");
  EXPECT_TRUE(expect(1));
  EXPECT_EQ(tuned->state_hash(), once->state_hash()) << "all is again as if nothing had been touched";
}

TEST(Errors, AFactorIsANumberFrom0To1000) {
  const auto simulation = build(standing());
  const auto error_of = [&](const char* target, const char* field, const char* to) {
    simulation->submit(ParameterRequest{target, field, Node::scalar(to)});
    advance(*simulation, 1);
    const Status& status = simulation->outcomes().front().status;
    return status ? std::string() : status.error().text();
  };
  EXPECT_THAT(error_of("sim", "errors", "-1"), HasSubstr("must be in [0, 1000]"));
  EXPECT_THAT(error_of("rover1", "errors", "nan"), HasSubstr("/errors"));
  EXPECT_THAT(error_of("rover1", "pose", "1"), HasSubstr("'pose' is not a parameter"));
  EXPECT_THAT(error_of("rover9", "errors", "1"), HasSubstr("rover9"));
  // All together they are cut: 1000 * 1000 stays 1000.
  EXPECT_EQ(error_of("sim", "errors", "1000"), "");
  EXPECT_EQ(error_of("rover1", "errors", "1000"), "");
  advance(*simulation, 50);
}

TEST(Faults, BadOnesAreRefused) {
  const auto error_of = [](const char* name, const char* key, Node value) {
    model::Setup setup = standing();
    device_of(setup, "rover1", name).config.set(key, std::move(value));
    Diagnostics diagnostics;
    const auto made = Simulation::create(std::move(setup), {}, diagnostics);
    return made ? std::string() : made.error().text();
  };
  EXPECT_EQ(error_of("laser", "failures", fault_list({failure("dead", "1 s", "2 s")})), "");
  EXPECT_THAT(error_of("laser", "failures", fault_list({failure("ded", "1 s", "2 s")})),
              HasSubstr("/failures/0/kind"));
  EXPECT_THAT(error_of("laser", "failures", fault_list({failure("dead", "2 s", "1 s")})),
              HasSubstr("until is not later"));
  EXPECT_THAT(error_of("laser", "failures", fault_list({failure("noisy", "1 s", "2 s", "-3")})),
              HasSubstr("/failures/0/factor"));
  EXPECT_THAT(error_of("laser", "failures", Node::scalar("dead")), HasSubstr("/failures"));
  EXPECT_THAT(error_of("drive", "failures", fault_list({failure("noisy", "1 s", "2 s")})),
              HasSubstr("diff_drive has no errors"));
  EXPECT_THAT(error_of("laser", "clock", map({{"drift", "2"}})), HasSubstr("/clock/drift"));
  EXPECT_THAT(error_of("laser", "clock", map({{"ofset", "2"}})), HasSubstr("offset"));
}

}  // namespace
}  // namespace sandlot::test
