#include <gtest/gtest.h>

#include <limits>

#include "assets/image/visible.h"
#include "messages/messages.h"
#include "server/clients/decision_log.h"
#include "server/clients/inventory.h"
#include "server/clients/mailbox.h"
#include "server/clients/match_track.h"
#include "server/clients/parameters.h"
#include "server/clients/preview.h"
#include "sim/test_world.h"

namespace sandlot::server::test {
namespace {

msg::RefereeDecision decision(std::uint64_t sequence, double at_s, const char* rule = "throw_in") {
  msg::RefereeDecision out;
  out.header.stamp = Time::from_s(at_s);
  out.sequence = sequence;
  out.tick = static_cast<std::uint64_t>(at_s * 100);
  out.rule = rule;
  return out;
}

/// A log of a run that has come to 1 s.
struct LogOfASecond {
  LogOfASecond() : session(sandlot::test::build(sandlot::test::arena("rigid", 1, "")), {}), kept(session) {
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(session.simulation().tick());
  }
  std::vector<std::string> rules(const std::string& topic = "") {
    std::vector<std::string> out;
    for (const msg::RefereeDecision& each : kept.decisions(topic)) out.push_back(each.rule);
    return out;
  }
  Session session;
  DecisionLog kept;
};
using Rules = std::vector<std::string>;

TEST(DecisionLog, KeepsWhatComesOnceAndOfEachTopicByItself) {
  LogOfASecond of;
  of.kept.take("/rules/referee/decision", decision(1, 0.1, "begin"));
  of.kept.take("/rules/referee/decision", decision(2, 0.5, "goal"));
  of.kept.take("/rules/other/decision", decision(1, 0.6, "corner"));
  of.kept.take("/rules/referee/decision", decision(1, 0.1, "begin"));  // again, after a jump back
  EXPECT_EQ(of.rules(), (Rules{"begin", "goal"}));
  EXPECT_EQ(of.rules("/rules/other/decision"), (Rules{"corner"}));
  EXPECT_EQ(of.rules("/nobody"), Rules{});
}

TEST(DecisionLog, ForgetsTheCourseThatTheRunHasLeft) {
  LogOfASecond of;
  for (const auto& [sequence, at_s, rule] :
       {std::tuple(1u, 0.1, "begin"), {2u, 0.3, "goal"}, {3u, 0.4, "kickoff"}})
    of.kept.take("/d", decision(sequence, at_s, rule));
  of.kept.take("/d", decision(2, 0.35, "corner"));  // instead of the goal
  EXPECT_EQ(of.rules(), (Rules{"begin", "corner"}));
  of.kept.take("/d", decision(3, 1.5, "start"));  // later than now: the run has gone back behind it
  EXPECT_EQ(of.rules(), (Rules{"begin", "corner"}));
  of.kept.keep_between(Time::from_s(0.2), Time::from_s(1));
  EXPECT_EQ(of.rules(), (Rules{"corner"}));
}

TEST(DecisionLog, LosesTheOldestOfVeryMany) {
  LogOfASecond of;
  for (std::uint64_t i = 1; i <= most_decisions + 5; ++i) of.kept.take("/d", decision(i, 0.5));
  const auto latest = of.kept.decisions("/d");
  ASSERT_EQ(latest.size(), most_decisions);
  EXPECT_EQ(latest.front().sequence, 6u);
  EXPECT_EQ(latest.back().sequence, most_decisions + 5);
}

/// One second of a run of two robots of two teams; the referee's states are the test's.
struct TrackOfASecond {
  static model::Setup setup() {
    model::Setup out = sandlot::test::arena("rigid", 2, "");
    for (model::Instance& each : out.instances)
      if (each.is_robot) each.team = each.name == "rover1" ? "cyan" : "magenta";
    return out;
  }
  TrackOfASecond() : session(sandlot::test::build(setup()), {}), kept(session) {
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(session.simulation().tick());
  }
  void take(double at_s, const std::string& last_touch, bool in_play = true) {
    msg::RefereeState state;
    state.in_play = in_play;
    state.last_touch = last_touch;
    kept.take(Time::from_s(at_s), state);
  }
  Session session;
  MatchTrack kept;
};

TEST(MatchTrack, KeepsPlacesFiveTimesASecondOfPlayAndEachTouch) {
  TrackOfASecond of;
  of.take(0.1, "", false);
  of.take(0.2, "rover1");
  of.take(0.3, "rover1");  // not due
  of.take(0.35, "rover2");
  of.take(0.4, "rover2");
  of.take(0.7, "rover2", false);
  of.take(0.8, "rover1");
  of.take(0.2, "rover2");  // again, after a jump back in a recording: known
  const msg::MatchTrack::Response track = of.kept.track();
  EXPECT_EQ(track.robots, (std::vector<std::string>{"rover1", "rover2"}));
  EXPECT_EQ(track.teams, (std::vector<std::string>{"cyan", "magenta"}));
  EXPECT_EQ(track.times, (std::vector<double>{0.2, 0.4, 0.8}));
  EXPECT_EQ(track.touch_times, (std::vector<double>{0.2, 0.35, 0.7, 0.8}));
  EXPECT_EQ(track.touches, (std::vector<std::string>{"rover1", "rover2", "", "rover1"}));
  ASSERT_EQ(track.places.size(), 3u * 6);
  const Simulation& simulation = of.session.simulation();
  for (std::size_t i = 0; i < track.places.size(); i += 6) {
    EXPECT_EQ(track.places[i], std::numeric_limits<std::int32_t>::min()) << "there is no ball";
    for (std::size_t robot = 0; robot < 2; ++robot) {
      const Vec3 at = simulation.engine().pose(simulation.find_entity(track.robots[robot])->id).p;
      EXPECT_NEAR(track.places[i + 2 + 2 * robot], 1000 * at.x, 0.5);
      EXPECT_NEAR(track.places[i + 3 + 2 * robot], 1000 * at.y, 0.5);
    }
  }
}

TEST(MatchTrack, ForgetsTheCourseThatTheRunHasLeft) {
  TrackOfASecond of;
  of.take(0.9, "rover1");
  of.take(1.5, "rover2");  // later than now: the run has gone back behind it
  EXPECT_EQ(of.kept.track().times, std::vector<double>{0.9});
  EXPECT_EQ(of.kept.track().touches, std::vector<std::string>{"rover1"});
  EXPECT_TRUE(of.session.simulation().tick());
  of.take(1.01, "rover2");
  of.take(1.2, "rover2");
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(of.session.simulation().tick());
  EXPECT_EQ(of.kept.track().times, (std::vector<double>{0.9, 1.2}));
  EXPECT_EQ(of.kept.track().touch_times, (std::vector<double>{0.9, 1.01}));
}

TEST(Mailbox, LosesTheOldestMessagesWhenItIsFullButNotWhatCameFromOutside) {
  Mailbox mailbox(10'000);
  const auto bytes = [](std::size_t n) { return std::make_shared<const std::vector<std::byte>>(n); };
  for (int i = 0; i < 10; ++i) {
    Batch batch;
    batch.now = Time::from_ns(i);
    batch.messages.push_back({1, batch.now, bytes(3000)});
    batch.commands = bytes(1);
    mailbox.push(std::move(batch));
  }
  std::deque<QueuedItem> taken;
  mailbox.take(taken);
  ASSERT_EQ(taken.size(), 10u);
  std::size_t whole = 0;
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_TRUE(taken[i].batch.commands);
    if (!taken[i].batch.messages.empty()) ++whole;
    else EXPECT_EQ(whole, 0u) << "the oldest go first";
  }
  // A batch is 3 kB and what it is made of: three of them fit into 10 kB beside the ten empty ones, or two.
  EXPECT_GE(whole, 2u);
  EXPECT_LE(whole, 3u);
  EXPECT_EQ(mailbox.dropped(), 10 - whole);
}

TEST(Mailbox, WakesOnceUntilSomebodyHasLooked) {
  Mailbox mailbox;
  int woken = 0;
  mailbox.open([&] { ++woken; });
  mailbox.push([](Hub&) {});
  mailbox.push([](Hub&) {});
  EXPECT_EQ(woken, 1);
  std::deque<QueuedItem> taken;
  mailbox.take(taken);
  EXPECT_EQ(taken.size(), 2u);
  mailbox.push([](Hub&) {});
  EXPECT_EQ(woken, 2);
  mailbox.close();
  mailbox.push([](Hub&) {});
  EXPECT_EQ(woken, 2);
}

TEST(Parameters, AreListedReadAndSetByTheSameNames) {
  const auto simulation = sandlot::test::build(sandlot::test::arena("rigid", 1));
  std::vector<foxglove::Parameter> all;
  EXPECT_TRUE(list_parameters(*simulation, all));
  bool found = false;
  for (const auto& each : all) {
    EXPECT_EQ(read_parameter(*simulation, each.name).value, each.value) << each.name;
    const auto request = parameter_request(each);
    ASSERT_TRUE(request) << each.name;
    simulation->submit(*request);
    found = found || each.name == "rover1/laser.noise.white";
  }
  EXPECT_TRUE(found);
  ASSERT_TRUE(simulation->tick());
  for (const Outcome& outcome : simulation->outcomes())
    EXPECT_TRUE(outcome.status) << outcome.status.error().text();
  EXPECT_EQ(simulation->outcomes().size(), all.size());
  for (const char* unknown :
       {"rover1", "rover1.x", "rover1/laser.noise", "rover1/laser.", "nobody/x.y", ".", ""})
    EXPECT_EQ(read_parameter(*simulation, unknown).value.index(), 0u) << unknown;
}

TEST(Preview, IsASmallJpegOfTheImage) {
  // 960 x 720, the left half green and the right half red.
  msg::Image image;
  image.header.frame_id = "eye";
  image.width = 960;
  image.height = 720;
  image.encoding = "rgb8";
  image.step = 3 * image.width;
  for (std::uint32_t i = 0; i < image.width * image.height; ++i)
    for (const int c : {i % image.width < 480 ? 0 : 255, i % image.width < 480 ? 255 : 0, 0})
      image.data.push_back(static_cast<std::uint8_t>(c));
  msg::CompressedImage got;
  ASSERT_TRUE(read_cdr(message_info<msg::CompressedImage>(), preview_of(image), &got));
  EXPECT_EQ(got.header.frame_id, "eye");
  EXPECT_EQ(got.format, "jpeg");
  EXPECT_LT(got.data.size(), 10'000u);
  const auto picture = assets::visible(got);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width, 480);
  EXPECT_EQ(picture->height, 360);
  const auto channel = [&](std::size_t x, std::size_t k) {
    return static_cast<int>(picture->rgb[3 * (180 * 480 + x) + k]);
  };
  EXPECT_NEAR(channel(120, 0), 0, 4);
  EXPECT_NEAR(channel(120, 1), 255, 4);
  EXPECT_NEAR(channel(360, 0), 255, 4);
  EXPECT_NEAR(channel(360, 1), 0, 4);
  image.data.resize(100);
  ASSERT_TRUE(read_cdr(message_info<msg::CompressedImage>(), preview_of(image), &got));
  EXPECT_TRUE(got.data.empty()) << "what cannot be shown";
}

TEST(Inventory, KnowsWhereAMessageGoes) {
  const auto simulation = sandlot::test::build(sandlot::test::arena("rigid", 2));
  const auto inventory = take_inventory(*simulation, 1);
  const auto address = [&](const char* topic, const char* type) {
    const auto target = inventory->target(topic, type);
    return target ? target->address : "error: " + target.error().text();
  };
  EXPECT_EQ(address("/rover2/cmd_vel", ""), "rover2/drive");
  EXPECT_EQ(address("/rover2/cmd_vel", "geometry_msgs/Twist"), "rover2/drive");
  EXPECT_EQ(address("/rover2/drive", "geometry_msgs/msg/Twist"), "rover2/drive");
  EXPECT_EQ(address("/rover1/drive/contact/command", ""), "rover1/drive/contact");
  EXPECT_NE(address("/rover1/drive", "std_msgs/String").find("takes geometry_msgs/msg/Twist"),
            std::string::npos);
  EXPECT_NE(address("/rover1/drove", "").find("did you mean '/rover1/drive'"), std::string::npos);
}

}  // namespace
}  // namespace sandlot::server::test
