/// Media, rules and markers in a running world: each against what can be said beforehand, then saved in the middle.
#include "sim/world/world_elements.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/test_world.h"
#include "sim/world/test_elements.h"

namespace sandlot::test {
namespace {

constexpr double g = 9.81;

// ------------------------------------------------------------------------------------------------------------ wind

TEST(Wind, PushesABoxAsItsDragSays) {
  // dw/dt = -k w^2 for the relative speed w, so w(t) = w0 / (1 + k w0 t), with k = rho c A / (2 m).
  model::Setup setup = weightless(0.001);
  setup.instances.push_back(placed("box", one_shape("box", Box{{0.5, 2, 1}}, 4), {}));
  setup.media.push_back(element(
      "wind", with(map({{"density", "1.2"}, {"drag_coefficient", "1"}}), "velocity", numbers({10, 0, 0}))));
  const auto simulation = build(setup);
  const double k = 0.5 * 1.2 * 1 * (2 * 1) / 4, w0 = 10;
  advance(*simulation, 1);
  EXPECT_NEAR(value(*simulation, "box.twist.linear.x"), k * w0 * w0 * 0.001, 1e-12);
  advance(*simulation, 999);
  const double w = w0 / (1 + k * w0 * 1);
  // The force of a sub-step is that at its beginning: the error of the first order is below k w0 h / 2 of the whole.
  EXPECT_NEAR(value(*simulation, "box.twist.linear.x"), w0 - w, 0.5 * k * w0 * 0.001 * w0);
  EXPECT_EQ(value(*simulation, "box.twist.linear.y"), 0);
}

TEST(Wind, ActsOnTheAreaThatItSees) {
  model::Setup setup = weightless(0.001);
  // Turned by 90 degrees about z, the box shows its 0.5 m x 1 m side to a wind along x.
  setup.instances.push_back(
      placed("box", one_shape("box", Box{{0.5, 2, 1}}, 4), {{}, quat_from_rpy(0, 0, math::pi / 2)}));
  setup.media.push_back(element(
      "wind", with(map({{"density", "1.2"}, {"drag_coefficient", "1"}}), "velocity", numbers({10, 0, 0}))));
  const auto simulation = build(setup);
  advance(*simulation, 1);
  EXPECT_NEAR(value(*simulation, "box.twist.linear.x"), 0.5 * 1.2 * 0.5 / 4 * 100 * 0.001, 1e-12);
  simulation->submit(ParameterRequest{"media/wind", "velocity", numbers({0, 0, 0})});
  advance(*simulation, 1);
  EXPECT_TRUE(simulation->outcomes().front().status);
  EXPECT_EQ(value(*simulation, "media/wind.velocity.x"), 0);
}

// ----------------------------------------------------------------------------------------------------------- shout

/// Loss of level over a distance.
double decibels_at(double distance_m) { return 20 * math::log(distance_m) / math::log(10); }

const msg::HeardArray& heard(const Simulation& simulation, const char* topic = "listener1/ear") {
  const auto* const found = topic_cast<msg::HeardArray>(simulation.find_topic(topic));
  SL_CHECK(found != nullptr);
  return found->message;
}

TEST(Shout, AWordArrivesWithTheDelayLevelAndDirectionOfItsWay) {
  const auto simulation = build(talkers({10}));
  say(*simulation, "hello");
  // 10 m at 340 m/s are 29.4 ms: in the third tick of 10 ms.
  for (int tick = 1; tick <= 2; ++tick) {
    advance(*simulation, 1);
    EXPECT_TRUE(heard(*simulation).words.empty()) << "tick " << tick;
  }
  advance(*simulation, 1);
  ASSERT_EQ(heard(*simulation).words.size(), 1u);
  const msg::Heard& word = heard(*simulation).words.front();
  EXPECT_EQ(word.text, "hello");
  EXPECT_NEAR(word.stamp.s(), 10.0 / 340, 1e-9);
  EXPECT_NEAR(word.level, 70 - decibels_at(10.0), 1e-9);
  // The speaker lies along -x of the world; the listener looks along y.
  EXPECT_NEAR(word.direction.x, 0, 1e-12);
  EXPECT_NEAR(word.direction.y, 1, 1e-12);
  advance(*simulation, 1);
  EXPECT_TRUE(heard(*simulation).words.empty()) << "heard once";
  EXPECT_EQ(value(*simulation, "media/air.heard"), 1);
}

TEST(Shout, WallsWeakenAndFarEarsHearNothing) {
  // 70 dB at 1 m are 40 dB at 31.6 m; 15 dB less behind a wall.
  model::Setup setup = talkers({3, 31, 32});
  setup.instances.push_back(placed("wall", one_shape("wall", Box{{0.2, 0.05, 3}}, 0), {{1.5, 0, 0}, {}}));
  model::Setup open = setup;
  open.instances.pop_back();
  for (const bool wall : {false, true}) {
    const auto simulation = build(wall ? setup : open);
    say(*simulation, "hello");
    double level = 0, far = 0, too_far = 0;
    for (int tick = 0; tick < 15; ++tick) {
      advance(*simulation, 1);
      for (const msg::Heard& word : heard(*simulation).words) level = word.level;
      for (const msg::Heard& word : heard(*simulation, "listener2/ear").words) far = word.level;
      for (const msg::Heard& word : heard(*simulation, "listener3/ear").words) too_far = word.level;
    }
    EXPECT_NEAR(level, 70 - decibels_at(3.0) - (wall ? 15 : 0), 1e-9);
    // The nearer listeners stand in the way of those behind them.
    EXPECT_EQ(far, 0);
    EXPECT_EQ(too_far, 0);
  }
  for (const auto& [x_m, hears] : {std::pair(31.0, true), {32.0, false}}) {
    const auto simulation = build(talkers({x_m}));
    say(*simulation, "hello");
    std::size_t words = 0;
    for (int tick = 0; tick < 15; ++tick) advance(*simulation, 1), words += heard(*simulation).words.size();
    EXPECT_EQ(words == 1, hears) << x_m;
  }
}

TEST(Shout, AnEarThatSamplesSeldomHearsAllWordsThatCameMeanwhile) {
  model::Setup setup = talkers({1});
  setup.instances.back().devices.edit().front().config = map({{"rate", "10"}});
  const auto simulation = build(setup);
  for (const char* word : {"one", "two", "three"}) {
    say(*simulation, word);
    advance(*simulation, 1);
  }
  advance(*simulation, 7);
  ASSERT_EQ(heard(*simulation).words.size(), 3u);
  EXPECT_EQ(heard(*simulation).words[2].text, "three");
}

TEST(Shout, AllWordsOfATickAreSpokenInTheirOrder) {
  const auto simulation = build(talkers({1}));
  for (const char* word : {"one", "two", "three"}) say(*simulation, word);
  advance(*simulation, 1);
  ASSERT_EQ(heard(*simulation).words.size(), 3u);
  EXPECT_EQ(heard(*simulation).words[0].text, "one");
  EXPECT_EQ(heard(*simulation).words[2].text, "three");
  EXPECT_EQ(value(*simulation, "speaker/voice.spoken"), 3);
}

TEST(Shout, ADeviceWithoutItsMediumIsRefusedByName) {
  model::Setup setup = talkers({1});
  setup.media.clear();
  EXPECT_NE(refused(setup).find("media: [{kind: shout}]"), std::string::npos) << refused(setup);
  setup = talkers({1});
  setup.media.push_back(element("shout", Node::map(), "water"));
  EXPECT_NE(refused(setup).find("name one of them: air, water"), std::string::npos) << refused(setup);
}

// ----------------------------------------------------------------------------------------------------------- rules

/// A ball that moves along x at 1 m/s, without weight, and two goals on its way.
model::Setup pitch() {
  model::Setup setup = weightless();
  auto ball = placed("ball", one_shape("ball", Sphere{0.1}, 1), {{-0.5, 0, 0}, {}});
  setup.instances.push_back(ball);
  setup.markers.push_back(
      element("disc", with(map({{"radius", "0.3"}}), "centre", numbers({2, 0})), "right"));
  setup.markers.push_back(
      element("polygon",
              with(Node::map(), "corners",
                   list({numbers({-3, -1}), numbers({-2, -1}), numbers({-2, 1}), numbers({-3, 1})})),
              "left"));
  Node goals = map({{"object", "ball"}});
  goals.set("goals", list({map({{"marker", "left"}, {"team", "blue"}}), map({{"marker", "right"}})}));
  setup.rules.push_back(element("goals", goals));
  return setup;
}

void kick(Simulation& simulation, Vec3 target) { simulation.submit(PoseRequest{"ball", {target, {}}}); }

TEST(Goals, CountOnceAndPutTheBallBackInTheNextTick) {
  const auto simulation = build(pitch());
  kick(*simulation, {2.1, 0, 0});
  advance(*simulation, 1);
  EXPECT_EQ(value(*simulation, "rules/goals.scored[1]"), 1);
  EXPECT_NEAR(value(*simulation, "ball.pose.x"), 2.1, 1e-9) << "the request waits for the next tick";
  advance(*simulation, 1);
  EXPECT_NEAR(value(*simulation, "ball.pose.x"), 0, 1e-9);
  kick(*simulation, {-2.5, 0, 0});
  advance(*simulation, 3);
  EXPECT_EQ(value(*simulation, "rules/goals.scored[0]"), 1);
  EXPECT_EQ(value(*simulation, "rules/goals.scored[1]"), 1);
  EXPECT_NEAR(value(*simulation, "rules/goals.last"), 0.03, 1e-12);
}

TEST(Goals, WithoutAResetABallThatStaysCountsOnceAndTheScoreEndsTheRun) {
  model::Setup setup = pitch();
  setup.rules.front().config.set("reset", Node::scalar("false"));
  setup.rules.front().config.set("stop_at", Node::scalar("2"));
  const auto simulation = build(setup);
  kick(*simulation, {2.1, 0, 0});
  advance(*simulation, 5);
  EXPECT_EQ(value(*simulation, "rules/goals.scored[1]"), 1);
  EXPECT_FALSE(simulation->stop_reason());
  kick(*simulation, {0, 0, 0});
  advance(*simulation, 1);
  kick(*simulation, {1.9, 0, 0});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->stop_reason());
  EXPECT_EQ(*simulation->stop_reason(), "right has scored 2");
}

TEST(Rules, NamesThatAreNotThereAreRefused) {
  model::Setup setup = pitch();
  setup.rules.front().config.set("object", Node::scalar("bal"));
  EXPECT_NE(refused(setup).find("did you mean 'ball'"), std::string::npos) << refused(setup);
  setup = pitch();
  setup.rules.front().config.set("goals", list({map({{"marker", "middle"}})}));
  EXPECT_NE(refused(setup).find("there is no marker 'middle'"), std::string::npos) << refused(setup);
  setup = pitch();
  setup.rules.push_back(element("goal", Node::map()));
  EXPECT_NE(refused(setup).find("no kind of rule 'goal'"), std::string::npos) << refused(setup);
  setup = pitch();
  setup.rules.push_back(setup.rules.front());
  EXPECT_NE(refused(setup).find("two rules are called 'goals'"), std::string::npos) << refused(setup);
}

TEST(Place, PutsAnObjectOncePerTimeThatItsConditionHolds) {
  model::Setup setup = pitch();
  setup.rules.push_back(
      element("place", with(map({{"object", "ball"}, {"when", "ball.pose.y > 1"}, {"yaw", "0.5"}}), "place",
                            numbers({0, 0, 3}))));
  const auto simulation = build(setup);
  kick(*simulation, {0, 2, 0});
  advance(*simulation, 2);
  EXPECT_NEAR(value(*simulation, "ball.pose.z"), 3, 1e-9);
  EXPECT_NEAR(value(*simulation, "ball.pose.yaw"), 0.5, 1e-9);
  EXPECT_EQ(value(*simulation, "rules/place.count"), 1);
  advance(*simulation, 3);
  EXPECT_EQ(value(*simulation, "rules/place.count"), 1);
  setup.rules.back().config.set("when", Node::scalar("ball.pose.why > 1"));
  EXPECT_NE(refused(setup).find("ball"), std::string::npos);
}

/// A ball that is a robot falls on the ground.
model::Setup falling(const char* limit, double height_m) {
  model::Setup setup;
  setup.step = Time::from_s(0.001);
  setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
  model::Instance robot = rover("rover", rover_model(), {0, 0, height_m}, 0, "");
  setup.instances.push_back(robot);
  setup.rules.push_back(element("impact", map({{"threshold", "2"}, {"limit", limit}})));
  return setup;
}

TEST(Impact, ARestingRobotTakesNoDamageAndAFallBreaksIt) {
  // 7 kg: standing presses with 69 N, 0.07 Ns in a sub-step of 1 ms; a fall of 0.5 m ends with m sqrt(2 g h) = 21.9 Ns, spread
  // over the contacts of chassis and wheels.
  const auto resting = build(falling("0", 0.001));
  advance(*resting, 300);
  auto damage = NamedValue::find(*resting, "rules/impact.robots[0].sum");
  ASSERT_TRUE(damage);
  EXPECT_FALSE(damage->read());
  const auto fallen = build(falling("4", 0.5));
  advance(*fallen, 700);
  const double hardest = value(*fallen, "rules/impact.robots[0].hardest");
  EXPECT_GT(hardest, 3);
  EXPECT_LT(hardest, 7 * std::sqrt(2 * g * 0.5) * 1.05);
  EXPECT_EQ(value(*fallen, "rules/impact.robots[0].broken"), 1);
  // The drive has failed: commands are refused.
  ByteWriter w;
  write(w, msg::Twist{});
  fallen->submit(CommandRequest{"rover/drive", msg::Twist::ros_type, {w.bytes().begin(), w.bytes().end()}});
  advance(*fallen, 1);
  EXPECT_FALSE(fallen->outcomes().back().status);
}

// ----------------------------------------------------------------------------------------- saved, restored, repeated

/// All of it at once, with robots that drive.
model::Setup everything() {
  model::Setup setup = arena("rigid", 2);
  setup.media.push_back(element("wind", with(Node::map(), "velocity", numbers({2, 1, 0}))));
  setup.media.push_back(element("shout", map({{"speed", "20"}}), "air"));
  setup.media.push_back(element("radio", map({{"bandwidth", "2e3"}, {"bit_error_rate", "0.01"}}), "ether"));
  setup.media.push_back(element("infrared", Node::map(), "light"));
  for (model::Instance& each : setup.instances) {
    if (!each.is_robot) continue;
    each.devices.push_back(device("voice", "voice"));
    each.devices.push_back(device("ear", "ear", map({{"rate", "5"}})));
    each.devices.push_back(device("radio", "radio"));
    each.devices.push_back(
        device("lamp", "infrared", map({{"half_angle", "90 deg"}, {"acceptance", "180 deg"}})));
    each.devices.push_back(device("buoy", "range_bearing", map({{"medium", "ether"}, {"beacon_rate", "3"}})));
  }
  std::string team = "cyan";
  for (model::Instance& each : setup.instances) {
    if (!each.is_robot) continue;
    each.devices.push_back(device("referee", "referee_link"));
    each.team = std::exchange(team, "magenta");
  }
  setup.instances.push_back(placed("ball", one_shape("ball", Sphere{0.1}, 0.5), {{0, 0, 0.1}, {}}));
  setup.markers.push_back(
      element("disc", with(map({{"radius", "1.5"}}), "centre", numbers({2, 0})), "right"));
  Node goals = map({{"object", "ball"}});
  goals.set("goals", list({map({{"marker", "right"}})}));
  goals.set("place", numbers({0, 0, 0.1}));
  setup.rules.push_back(element("goals", goals));
  setup.rules.push_back(element(
      "referee",
      map({{"stop_time", "0.1"}, {"prepare_max", "0.2"}, {"prepare_kickoff", "0.2"}, {"take_time", "0.1"}})));
  setup.rules.push_back(element("impact", map({{"threshold", "0.001"}})));
  setup.rules.push_back(element("place", with(map({{"object", "ball"}, {"when", "ball.pose.x > 0.4"}}),
                                              "place", numbers({2, 0, 0.1}))));
  setup.rules.push_back(
      element("statistics", with(map({{"each", "rover*.pose.x"}, {"interval", "70 ms"}, {"bins", "5"}}),
                                 "range", numbers({-2, 2}))));
  Node coverage = with(map({{"bins", "8"}}), "values", texts({"rover1.pose.x", "ball.pose.x"}));
  coverage.set("ranges", list({numbers({-2, 2})}));
  setup.rules.push_back(element("coverage", coverage));
  setup.rules.push_back(element(
      "path", with(map({{"interval", "50 ms"}}), "values", texts({"rover1.pose.x", "rover1.pose.y"}))));
  setup.rules.push_back(
      element("episodes", map({{"when", "mod(sim.time, 0.3) < 0.2"}, {"at_least", "0.1"}})));
  setup.rules.push_back(
      element("set", with(map({{"when", "ball.pose.x > 0.4"}}), "set",
                          list({map({{"parameter", "media/air.threshold"}, {"value", "31 dB"}})}))));
  return setup;
}

void transmit(Simulation& simulation, const std::string& text, const char* device) {
  ByteWriter w;
  write(w, msg::RadioPacket{"", {text.begin(), text.end()}});
  simulation.submit(CommandRequest{device, msg::RadioPacket::ros_type, {w.bytes().begin(), w.bytes().end()}});
}

/// The world up to tick `ticks`, with a word and a kick now and then.
void play_elements(Simulation& simulation, std::uint64_t until) {
  while (simulation.tick_index() < until) {
    const std::uint64_t tick = simulation.tick_index();
    if (tick % 10 == 3) say(simulation, "at " + std::to_string(tick), "rover1");
    if (tick % 12 == 5) transmit(simulation, "at " + std::to_string(tick), "rover2/radio");
    if (tick % 12 == 5) transmit(simulation, "flash", "rover1/lamp");
    if (tick % 25 == 7) simulation.submit(PullRequest{"ball", "", {}, {1, 0.2, 0.1}, Time::from_s(0.05)});
    advance(simulation, 1);
  }
}

TEST(WorldElements, GoOnFromASnapshotInAnyNumberOfThreads) {
  const auto whole = build(everything());
  play_elements(*whole, 75);
  ASSERT_GT(value(*whole, "rules/goals.scored[0]"), 0);
  ASSERT_GT(value(*whole, "media/air.words"), 0);
  ASSERT_GT(value(*whole, "media/ether.delivered"), 3);
  ASSERT_GT(value(*whole, "media/light.delivered"), 3);
  ASSERT_GT(value(*whole, "rules/referee.decisions"), 1);
  ASSERT_GT(value(*whole, "/rover1/referee/state.commands"), 1);
  for (const std::uint64_t at : {24u, 33u, 48u}) {
    const auto first = build(everything());
    play_elements(*first, at);
    const std::vector<std::byte> snapshot = first->snapshot();
    for (const int threads : {1, 2, 4}) {
      Diagnostics diagnostics;
      auto second = Simulation::restore(snapshot, {.threads = threads}, diagnostics);
      ASSERT_TRUE(second) << second.error().text();
      EXPECT_EQ((*second)->state_hash(), first->state_hash()) << at;
      play_elements(**second, 75);
      EXPECT_EQ((*second)->state_hash(), whole->state_hash()) << at << ", " << threads << " threads";
    }
  }
}

TEST(WorldElements, ATickThatWasJudgedIsNotJudgedAgainByARestore) {
  model::Setup setup = pitch();
  setup.rules.front().config.set("stop_at", Node::scalar("1"));
  const auto simulation = build(setup);
  kick(*simulation, {2.1, 0, 0});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->stop_reason());
  Diagnostics diagnostics;
  auto restored = Simulation::restore(simulation->snapshot(), {}, diagnostics);
  ASSERT_TRUE(restored) << restored.error().text();
  EXPECT_EQ((*restored)->state_hash(), simulation->state_hash());
  EXPECT_EQ((*restored)->stop_reason(), simulation->stop_reason());
  EXPECT_EQ(value(**restored, "rules/goals.scored[1]"), 1);
  advance(**restored, 1);
  advance(*simulation, 1);
  EXPECT_NEAR(value(**restored, "ball.pose.x"), 0, 1e-9) << "the request that waited was carried out";
  EXPECT_EQ((*restored)->state_hash(), simulation->state_hash());
}

TEST(WorldElements, AreRestoredWhenWhatTheyNameIsGone) {
  const auto simulation = build(everything());
  play_elements(*simulation, 30);
  simulation->submit(DeleteRequest{"ball"});
  advance(*simulation, 1);
  Diagnostics diagnostics;
  auto restored = Simulation::restore(simulation->snapshot(), {}, diagnostics);
  ASSERT_TRUE(restored) << restored.error().text();
  advance(*simulation, 20);
  advance(**restored, 20);
  EXPECT_EQ((*restored)->state_hash(), simulation->state_hash());
}

TEST(WorldElements, ARobotThatComesHearsAndOneThatGoesIsForgotten) {
  const auto simulation = build(talkers({1, 300}));
  model::Instance late = placed("late", one_shape("ball", Sphere{0.1}, 1), {{0, 2, 0}, {}});
  late.devices.push_back(device("ear", "ear"));
  simulation->submit(SpawnRequest{late});
  advance(*simulation, 1);
  say(*simulation, "hello");
  simulation->submit(DeleteRequest{"listener1"});
  advance(*simulation, 1);
  EXPECT_EQ(heard(*simulation, "late/ear").words.size(), 1u);
}

TEST(WorldElements, HashesHavePartsOfTheirOwnAndNoneWithoutElements) {
  const model::Setup all = everything();
  std::vector<std::string> expected{"sim"}, names;
  for (const model::ElementDecl& each : all.media) expected.push_back("media/" + each.name);
  for (const model::ElementDecl& each : all.rules) expected.push_back("rules/" + each.name);
  const auto simulation = build(all);
  for (const SubHash& part : simulation->sub_hashes()) names.push_back(part.path);
  ASSERT_GE(names.size(), expected.size());
  names.resize(expected.size());
  EXPECT_EQ(names, expected);
  // A run hashes the same with and without a stop time.
  model::Setup setup = arena("rigid", 1);
  const std::uint64_t without = build(setup)->state_hash();
  setup.stop = Time::from_s(3);
  EXPECT_EQ(build(setup)->state_hash(), without);
}

TEST(WorldElements, ForgedStateIsRefused) {
  // goals: two counters for two goals. The last byte of the whole is its checksum's.
  const auto simulation = build(pitch());
  const WorldElements::Part& part = *simulation->elements().find_part("rules/goals");
  ByteWriter w;
  simulation->elements().save(part, w);
  const auto fresh = build(pitch());
  auto& elements = const_cast<WorldElements&>(fresh->elements());
  const WorldElements::Part& own = *elements.find_part("rules/goals");
  const std::vector<std::byte> bytes(w.bytes().begin(), w.bytes().end());
  ByteReader whole(bytes);
  EXPECT_TRUE(elements.load(own, whole) && whole.remaining() == 0);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    ByteReader cut(std::span<const std::byte>(bytes).first(size));
    EXPECT_FALSE(elements.load(own, cut)) << size;
  }
  std::vector<std::byte> forged = bytes;
  forged[0] = std::byte{1};  // one counter in place of two
  ByteReader r(forged);
  EXPECT_FALSE(elements.load(own, r) && r.remaining() == 0);
}

TEST(Media, WordsOfATickArriveInTheOrderInWhichTheirSpeakersWereMade) {
  model::Setup setup = talkers({1});
  for (const char* name : {"zoe", "amy"}) {
    model::Instance speaker = placed(name, one_shape("ball", Sphere{0.1}, 1),
                                     {{1, name[0] == 'z' ? 1.0 : -1.0, 0}, {}});
    speaker.is_robot = true;
    speaker.devices.push_back(device("voice", "voice"));
    setup.instances.push_back(speaker);
  }
  const auto simulation = build(setup);
  for (const char* name : {"amy", "speaker", "zoe"}) say(*simulation, name, name);
  advance(*simulation, 1);
  ASSERT_EQ(heard(*simulation).words.size(), 3u);
  EXPECT_EQ(heard(*simulation).words[0].text, "speaker");
  EXPECT_EQ(heard(*simulation).words[1].text, "zoe");
  EXPECT_EQ(heard(*simulation).words[2].text, "amy");
}

}  // namespace
}  // namespace sandlot::test
