#include "record/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot::record {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A recording in memory.
struct Recorded {
  std::vector<std::byte> snapshot;
  std::vector<RecordedTick> ticks;
};

struct TickRecorder : Observer {
  std::vector<RecordedTick>& ticks;
  explicit TickRecorder(std::vector<RecordedTick>& out) : ticks(out) {}
  Wants wants() const override { return {.log = true, .hash = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    ticks.push_back({frame->tick, frame->now, frame->log, frame->hash, frame->parts, frame->part_names});
  }
};

struct Requested {
  std::uint64_t before_tick;  ///< carried out in this one
  Request request;
  Source source = {};
};

/// Records `ticks` ticks from tick `begin` on.
Recorded recorded_run(const model::Setup& setup, std::uint64_t begin, std::uint64_t ticks,
                      const std::vector<Requested>& requests = {},
                      std::optional<Time> measured = std::nullopt) {
  Diagnostics diagnostics;
  auto made = Simulation::create(setup, {}, diagnostics);
  EXPECT_TRUE(static_cast<bool>(made));
  Simulation& simulation = **made;
  for (std::uint64_t i = 0; i < begin; ++i) EXPECT_TRUE(static_cast<bool>(simulation.tick()));
  Recorded out;
  out.snapshot = simulation.snapshot();
  TickRecorder recorder(out.ticks);
  simulation.add_observer(&recorder);
  for (std::uint64_t i = 0; i < ticks; ++i) {
    for (const Requested& each : requests)
      if (each.before_tick == simulation.tick_index() + 1) simulation.submit(each.request, each.source);
    // Every tick of another length, some beyond what the clock allows.
    std::optional<Time> length;
    if (measured) length = *measured * static_cast<std::int64_t>(1 + i % 7);
    EXPECT_TRUE(static_cast<bool>(simulation.tick(length)));
  }
  return out;
}

Replay begin(const Recorded& recorded, Replay::Options options = {}) {
  Diagnostics diagnostics;
  auto replay = Replay::begin(recorded.snapshot, options, diagnostics);
  EXPECT_TRUE(static_cast<bool>(replay));
  return std::move(*replay);
}

/// What the first difference or error says; "" when there is none.
std::string verdict(const Recorded& recorded, Replay::Options options = {}) {
  Replay replay = begin(recorded, options);
  for (const RecordedTick& tick : recorded.ticks) {
    auto difference = replay.tick(tick);
    if (!difference) return difference.error().what;
    if (*difference) return (*difference)->text();
  }
  EXPECT_EQ(replay.simulation().tick_index(), recorded.ticks.back().tick);
  return "";
}

Request twist(const std::string& target, double vx_mps) {
  msg::Twist message;
  message.linear.x = vx_mps;
  ByteWriter w;
  write(w, message);
  return CommandRequest{target, msg::Twist::ros_type, {w.bytes().begin(), w.bytes().end()}};
}

/// Two rovers that wander, a third that a client drives, and a lot that is asked of them.
Recorded eventful(const char* engine, std::uint64_t begin = 33) {
  model::Setup setup = test::arena(engine, 2);
  setup.instances.push_back(test::rover("driven", setup.instances.back().model, {2.5, -2.5, 0}, 0.5, ""));
  model::Instance guest = test::arena(engine, 1).instances.back();
  guest.name = "guest";
  guest.X_WM = {{3, 3, 0}, {}};
  const Source client{Source::Kind::robot, 4};
  return recorded_run(setup, begin, 90,
                      {{begin + 2, twist("driven/drive", 0.3), client},
                       {begin + 12, twist("driven/drive/ideal", 0.1), client},
                       {begin + 12, twist("nobody/drive", 1), client},
                       {begin + 5, PullRequest{"rover2", "", {}, {1, -1, 0.3}, Time::from_s(0.1)}},
                       {begin + 20, SpawnRequest{guest}},
                       {begin + 30, PoseRequest{"rover1", {{-3, 3, 0}, {}}}},
                       {begin + 40, ParameterRequest{"guest/laser", "noise/white", Node::scalar("5 cm")}},
                       {begin + 50, DeleteRequest{"rover2"}},
                       {begin + 51, DeleteRequest{"rover2"}}});
}

TEST(Replay, BothWaysGiveEveryHashAgainOnBothEnginesAndFromTheMiddleOfAControlInterval) {
  for (const char* engine : {"planar", "rigid"})
    for (const Programs programs : {Programs::recompute, Programs::logged})
      for (const int threads : {1, 3}) {
        // The arena's control interval is 5 ticks: 35 is a control step whose orders wait for the next tick.
        EXPECT_EQ(verdict(eventful(engine, 35), {programs, threads}), "") << engine << threads;
        EXPECT_EQ(verdict(eventful(engine, 33), {programs, threads}), "") << engine << threads;
      }
}

/// What a client publishes for a program is input like a command to a device: its first pose, then another one of the wrong type,
/// then one that is nowhere.
TEST(Replay, TopicsThatClientsPublishComeFromTheLog) {
  model::Setup setup = test::arena("planar", 2);
  setup.instances.back().controllers.push_back(
      {"localiser",
       "localise",
       test::map({{"map_data", "90 90 0.1 -4.5 -4.5 0\n450*100 7200*0 450*100"},
                  {"odometry", "truth"},
                  {"begin", "topic"},
                  {"max_particles", "500"}}),
       {}});
  const auto initial = [](double x_m) {
    msg::PoseWithCovarianceStamped message;
    message.pose.pose.p.x = x_m;
    message.pose.covariance[0] = message.pose.covariance[7] = message.pose.covariance[35] = 0.01;
    ByteWriter w;
    write(w, message);
    return CommandRequest{
        "rover2/initialpose", msg::PoseWithCovarianceStamped::ros_type, {w.bytes().begin(), w.bytes().end()}};
  };
  CommandRequest of_other_type = initial(1);
  of_other_type.type = msg::Twist::ros_type;
  const Source client{Source::Kind::robot, 4};
  const Recorded recorded = recorded_run(setup, 33, 90,
                                         {{35, initial(-1.3), client},
                                          {50, of_other_type, client},
                                          {60, initial(1e9), client},
                                          {80, initial(-1), client}});
  const auto counts = [&](Replay& replay, const char* name) {
    return NamedValue::find(replay.simulation(), name)->read();
  };
  for (const Programs programs : {Programs::recompute, Programs::logged})
    for (const int threads : {1, 3}) EXPECT_EQ(verdict(recorded, {programs, threads}), "") << threads;
  Replay replay = begin(recorded, {Programs::recompute});
  for (const RecordedTick& tick : recorded.ticks) ASSERT_TRUE(replay.tick(tick));
  EXPECT_EQ(counts(replay, "rover2/localiser.poses"), 2);
  EXPECT_EQ(counts(replay, "rover2/localiser.refused"), 1) << "off the map";
  EXPECT_EQ(counts(replay, "rover2/initialpose.count"), 3);
  // Another pose in the log is seen.
  Recorded changed = recorded;
  for (RecordedTick& tick : changed.ticks)
    for (LogEntry& entry : tick.log)
      if (entry.target == "rover2/initialpose" && tick.tick == 35) entry.bytes = initial(-1.31).bytes;
  EXPECT_THAT(verdict(changed), HasSubstr("rover2/localiser"));
}

TEST(Replay, LoggedOrdersComeAfterTheRequestsOfRules) {
  // The drive of rover1 fails in a tick for which its program has an order: that one is refused.
  Node setting = Node::map(), config = Node::map(), settings = Node::sequence();
  setting.set("parameter", Node::scalar("rover1/drive.failure"));
  setting.set("value", Node::scalar("dead"));
  settings.push(setting);
  config.set("when", Node::scalar("sim.tick >= 40"));
  config.set("set", settings);
  model::Setup setup = test::arena("planar", 2);
  setup.rules.push_back({"fail", "set", config, {}});
  const Recorded recorded = recorded_run(setup, 0, 60, {});
  const auto refused = [&](std::uint64_t tick, const char* kind) {
    for (const LogEntry& entry : recorded.ticks[tick - 1].log)
      if (entry.target.starts_with("rover1/drive") && request_kind(entry.kind) == std::string(kind))
        return entry.refused ? "refused" : "taken";
    return "none";
  };
  EXPECT_STREQ(refused(41, "command"), "refused");
  for (const Programs programs : {Programs::recompute, Programs::logged})
    EXPECT_EQ(verdict(recorded, {programs, 1}), "");
}

TEST(Replay, LengthsThatAClockMeasuredAreTakenFromTheLog) {
  model::Setup setup = test::arena("planar", 2);
  setup.clock = {model::Clock::Mode::continuous, Time::from_s(2e-3), Time::from_s(0.02)};
  Recorded recorded = recorded_run(setup, 0, 60, {}, Time::from_s(4e-3));
  EXPECT_EQ(recorded.ticks.back().log.front().kind, LogEntry::step);
  EXPECT_EQ(verdict(recorded), "");
  // One nanosecond more in tick 40.
  recorded.ticks[39].log.front().bytes.front() ^= std::byte{1};
  EXPECT_THAT(verdict(recorded), testing::StartsWith("tick 40 ("));
}

TEST(Replay, AChangedOrderOfAProgramIsFoundByRecomputingAndAChangedStateByTheLog) {
  Recorded recorded = eventful("planar");
  RecordedTick* changed = nullptr;
  for (RecordedTick& tick : recorded.ticks)
    if (!changed && tick.tick >= 60)
      for (LogEntry& entry : tick.log)
        if (!changed && entry.target.starts_with("rover1/drive")) {
          entry.bytes[6] ^= std::byte{0x10};
          changed = &tick;
        }
  ASSERT_TRUE(changed);
  const std::string tick = tick_text(changed->tick, changed->now);
  EXPECT_THAT(verdict(recorded), testing::AllOf(testing::StartsWith(tick), HasSubstr("rover1/drive"),
                                                HasSubstr("not what the program orders now")));
  EXPECT_THAT(verdict(recorded, {Programs::logged}),
              testing::AllOf(testing::StartsWith(tick), HasSubstr("state differs of"), HasSubstr("rover1")));
}

TEST(Replay, AChangedCommandOfAClientShowsInTheStateOfTheRobotItWasFor) {
  Recorded recorded = eventful("planar");
  LogEntry& entry = recorded.ticks[1].log.front();
  ASSERT_EQ(entry.target, "driven/drive");
  ByteWriter w;
  msg::Twist faster;
  faster.linear.x = 0.4;
  write(w, faster);
  entry.bytes.assign(w.bytes().begin(), w.bytes().end());
  Replay replay = begin(recorded);
  ASSERT_FALSE((*replay.tick(recorded.ticks[0])).has_value());
  const auto difference = *replay.tick(recorded.ticks[1]);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->tick, 35u);
  EXPECT_THAT(difference->parts, ElementsAre("driven", "driven/drive"));
}

TEST(Replay, NamesWhatIsWrongWithALog) {
  const auto changed = [](const auto& change) {
    Recorded recorded = eventful("planar");
    change(recorded.ticks);
    return verdict(recorded);
  };
  using Ticks = std::vector<RecordedTick>;
  EXPECT_THAT(changed([](Ticks& t) { t.erase(t.begin() + 4); }), HasSubstr("incomplete: tick 38 is missing"));
  EXPECT_THAT(changed([](Ticks& t) { t[19].log.front().bytes.pop_back(); }),
              HasSubstr("the spawn for guest in the log cannot be read"));
  EXPECT_THAT(changed([](Ticks& t) { t[19].log.front().kind = 77; }), HasSubstr("cannot be read"));
  EXPECT_THAT(changed([](Ticks& t) { t[19].log.front().target = "host"; }), HasSubstr("cannot be read"));
  EXPECT_THAT(changed([](Ticks& t) { t[1].log.front().target = "driven/dryve"; }),
              HasSubstr("is refused now"));
  EXPECT_THAT(changed([](Ticks& t) { t[1].log.front().source.kind = Source::Kind{9}; }),
              HasSubstr("no known source"));
  EXPECT_THAT(changed([](Ticks& t) { t[1].log.erase(t[1].log.begin()); }), HasSubstr("driven"));
  EXPECT_THAT(changed([](Ticks& t) { t[7].parts[0] ^= 1, t[7].hash ^= 1; }),
              testing::EndsWith("the state differs of sim"));
  EXPECT_THAT(changed([](Ticks& t) { t[7].hash ^= 1; }), HasSubstr("the whole"));
  EXPECT_THAT(changed([](Ticks& t) {
                for (RecordedTick& tick : t)
                  if (!tick.log.empty() && tick.log.back().source.kind == Source::Kind::program)
                    return tick.log.pop_back();
              }),
              HasSubstr("that is not in the log"));
}

TEST(Replay, PartsArePairedByNameWhenTheModelsDiffer) {
  const std::vector<std::string> a{"sim", "ball", "box"}, b{"sim", "box", "cone"};
  EXPECT_THAT(differing_parts(a, std::vector<std::uint64_t>{1, 2, 3}, b, std::vector<std::uint64_t>{1, 3, 4}),
              ElementsAre("ball", "cone"));
  EXPECT_THAT(differing_parts(a, std::vector<std::uint64_t>{1, 2, 3}, a, std::vector<std::uint64_t>{1, 5, 4},
                              std::vector<std::string>{"ball"}),
              ElementsAre("box"));
}

}  // namespace
}  // namespace sandlot::record
