#include "sim/watch/values.h"

#include "sim/test_values.h"
#include "sim/test_world.h"
#include "sim/watch/monitor.h"

namespace sandlot {
namespace {

using test::advance;
using test::arena;
using test::build;
using test::value;

std::string complaint(const Simulation& simulation, const std::string& address) {
  const auto value = NamedValue::find(simulation, address);
  return value ? "" : value.error().text();
}

TEST(NamedValue, ReadsWhatTheSimulationHolds) {
  const auto simulation = build(arena("rigid", 1));
  advance(*simulation, 37);
  const Engine& engine = simulation->engine();
  const InstanceId id = *simulation->find_instance("rover1");
  const Pose X_WM = engine.pose(id);
  EXPECT_EQ(value(*simulation, "sim.time"), 0.37);
  EXPECT_EQ(value(*simulation, "sim.tick"), 37);
  EXPECT_EQ(value(*simulation, "rover1.pose.x"), X_WM.p.x);
  EXPECT_EQ(value(*simulation, "rover1.pose.position.y"), X_WM.p.y);
  EXPECT_EQ(value(*simulation, "rover1.pose.yaw"), rpy_from_quat(X_WM.q).z);
  const auto bodies = engine.bodies(id);
  EXPECT_EQ(value(*simulation, "rover1.twist.linear.x"), engine.states()[bodies[0].index].V_WB.linear.x);
  EXPECT_EQ(value(*simulation, "rover1.links.left_wheel.pose.z"), engine.states()[bodies[1].index].X_WB.p.z);
  EXPECT_EQ(value(*simulation, "rover1.links.right_wheel.twist.angular.y"),
            engine.states()[bodies[2].index].V_WB.angular.y);
  const JointState& wheel = engine.joint_states()[engine.joints(id)[1].index];
  EXPECT_EQ(value(*simulation, "rover1.joints.right_wheel_joint.position"), wheel.position);
  EXPECT_EQ(value(*simulation, "rover1.joints.right_wheel_joint.velocity"), wheel.velocity);
  EXPECT_EQ(value(*simulation, "rover1.joints.right_wheel_joint.effort"), wheel.effort);
  const auto* const scan = topic_cast<msg::LaserScan>(simulation->find_topic("rover1/laser"));
  ASSERT_NE(scan, nullptr);
  EXPECT_EQ(value(*simulation, "rover1/laser.ranges[3]"), static_cast<double>(scan->message.ranges[3]));
  EXPECT_EQ(value(*simulation, "/rover1/laser.header.stamp"), 0.3);
  EXPECT_EQ(value(*simulation, "rover1/laser.noise.white"), 0.01);
  EXPECT_EQ(value(*simulation, "rover1/laser.parameter.beams"), 61);
  EXPECT_EQ(value(*simulation, "rover1/laser.sample"), 4);  // at 0, 0.1, 0.2, 0.3 s
  EXPECT_EQ(value(*simulation, "rover1/laser.count"), 4);
  EXPECT_EQ(value(*simulation, "rover1/laser/ranges.angle_min"),
            static_cast<double>(scan->message.angle_min));
  EXPECT_EQ(value(*simulation, "rover1/controller.steps"), 8);  // ticks 0, 5 ... 35
}

TEST(NamedValue, EveryListedAddressCanBeRead) {
  for (const char* const engine : {"rigid", "planar"}) {
    const auto simulation = build(arena(engine, 2));
    advance(*simulation, 21);
    int seen = 0;
    list_values(*simulation, "", [&](const ValueEntry& entry) {
      ++seen;
      auto value = NamedValue::find(*simulation, entry.path + (entry.list ? "[0]" : ""));
      ASSERT_TRUE(value) << entry.path << ": " << value.error().text();
      EXPECT_EQ(value->unit(), entry.unit) << entry.path;
      const auto number = value->read();
      ASSERT_EQ(number.has_value(), entry.is == ValueFound::Is::value) << entry.path;
      if (number && !std::isnan(*number)) { EXPECT_EQ(*number, entry.value) << entry.path; }
    });
    EXPECT_GT(seen, 100);
  }
}

TEST(NamedValue, ErrorsNameWhatIsNear) {
  const auto simulation = build(arena("rigid", 1));
  const std::vector<std::pair<const char*, const char*>> expected{
      {"rovr1.pose.x", "there is no 'rovr1'; did you mean 'rover1'?"},
      {"rover1/lasr.ranges[0]", "there is no 'rover1/lasr'; did you mean 'rover1/laser'?"},
      {"rover1.pose.q", "did you mean 'rover1.pose."},
      {"rover1.pose", "not a number but a group of them; known are: rover1.pose.x"},
      {"rover1/laser.rages[3]", "did you mean 'rover1/laser.ranges[0]'?"},
      {"rover1/laser.ranges", "not a number but a group"},
      {"rover1", "is not a number; name one of its values, such as rover1.pose.x"},
      {"sim.tim", "did you mean 'sim.time'?"},
      {"rover1.joints.left_wheel_join.position", "did you mean 'rover1.joints.left_wheel_joint.position'?"},
      {"", "there is no ''"}};
  for (const auto& [address, words] : expected)
    EXPECT_NE(complaint(*simulation, address).find(words), std::string::npos)
        << complaint(*simulation, address);
}

TEST(NamedValue, FollowsItsThingAndLosesItWithIt) {
  const auto simulation = build(arena("rigid", 3));
  auto second = NamedValue::find(*simulation, "rover2.pose.x");
  auto third = NamedValue::find(*simulation, "rover3/laser.ranges[0]");
  auto first = NamedValue::find(*simulation, "rover1.pose.x");
  ASSERT_TRUE(first && second && third);
  simulation->submit(DeleteRequest{"rover1"});
  simulation->submit(DeleteRequest{"rover3"});
  advance(*simulation, 1);
  EXPECT_FALSE(first->read());
  EXPECT_FALSE(third->read());
  EXPECT_EQ(second->read(), simulation->engine().pose(*simulation->find_instance("rover2")).p.x);
  simulation->submit(SpawnRequest{test::rover("rover1", test::rover_model(), {1, -1, 0}, 0)});
  advance(*simulation, 1);
  EXPECT_EQ(first->read(), simulation->engine().pose(*simulation->find_instance("rover1")).p.x);
  EXPECT_EQ(first->unit(), "m");
}

TEST(NamedValue, HasNoValueBeforeTheFirstMeasurementOrBeyondTheEnd) {
  const auto simulation = build(arena("rigid", 1));
  auto beyond = NamedValue::find(*simulation, "rover1/laser.ranges[61]");
  auto command = NamedValue::find(*simulation, "rover1/drive/contact/command.linear.x");
  ASSERT_TRUE(beyond);
  EXPECT_FALSE(beyond->read());
  ASSERT_TRUE(command) << command.error().text();
  EXPECT_FALSE(command->read());
}

model::Setup watched(std::vector<model::ValueDecl> values, std::vector<model::EventDecl> events) {
  model::Setup setup = arena("planar", 1);
  setup.values = std::move(values);
  setup.events = std::move(events);
  return setup;
}
const Monitor::Event& event(const Simulation& simulation, const char* name) {
  for (const Monitor::Event& each : simulation.monitor().events())
    if (each.decl.name == name) return each;
  ADD_FAILURE() << name;
  return simulation.monitor().events().front();
}

TEST(Monitor, ValuesUseThoseBeforeThem) {
  // Doubling 60 times: without keeping what has been computed this takes 2^60 evaluations.
  std::vector<model::ValueDecl> values{{"v0", "sim.tick", {}}};
  for (int i = 1; i <= 60; ++i) {
    const std::string before = "v" + std::to_string(i - 1);
    values.push_back({"v" + std::to_string(i), before + " / 2 + values." + before + " / 2", {}});
  }
  const auto simulation = build(watched(values, {}));
  advance(*simulation, 3);
  EXPECT_EQ(value(*simulation, "values.v60"), 3);
  EXPECT_EQ(value(*simulation, "v30"), 3);
  Diagnostics diagnostics;
  const auto later = Simulation::create(watched({{"a", "b", {}}, {"b", "1", {}}}, {}), {}, diagnostics);
  ASSERT_FALSE(later);
  EXPECT_NE(later.error().text().find("the value 'b' is declared later, or uses itself"), std::string::npos)
      << later.error().text();
  EXPECT_EQ(
      Simulation::create(watched({{"a", "a + 1", {}}}, {}), {}, diagnostics).error().text(),
      "expression 'a + 1', column 1: the value 'a' is declared later, or uses itself; a value may use those "
      "above it");
  model::Setup circle = watched({}, {});
  for (const auto& [team, other] : {std::pair("red", "blue"), {"blue", "red"}}) {
    model::TeamDecl& decl = circle.teams.emplace_back();
    decl.name = team;
    decl.criterion.emplace().value = std::string(other) + ".criterion";
  }
  EXPECT_NE(Simulation::create(circle, {}, diagnostics).error().text().find("cannot use a criterion"),
            std::string::npos);
}

TEST(Monitor, EventsCountStretchesAndHold) {
  // The condition holds in ticks 10..19 and 30..39 of every 40 (0.1 s long each).
  const std::string wave = "mod(floor(sim.tick / 10), 2) == 1";
  const auto simulation = build(watched({}, {{"edge", wave, {}, false, false, {}},
                                             {"late", wave, Time::from_s(0.05), false, false, {}},
                                             {"never", wave, Time::from_s(0.1), false, false, {}},
                                             {"once", wave, {}, true, false, {}}}));
  std::vector<std::uint64_t> at;
  for (int i = 0; i < 100; ++i) {
    advance(*simulation, 1);
    for (const std::string& name : simulation->monitor().happened())
      if (name == "late") at.push_back(simulation->tick_index());
  }
  EXPECT_EQ(at, (std::vector<std::uint64_t>{15, 35, 55, 75, 95}));
  EXPECT_EQ(event(*simulation, "edge").count, 5u);
  EXPECT_EQ(event(*simulation, "edge").first, Time::from_s(0.1));
  EXPECT_EQ(event(*simulation, "edge").last, Time::from_s(0.9));
  EXPECT_EQ(event(*simulation, "never").count, 0u);
  EXPECT_EQ(event(*simulation, "once").count, 1u);
}

TEST(Monitor, AnEventStopsTheRunAndItsStateIsSaved) {
  const std::vector<model::EventDecl> events{{"end", "sim.time >= 0.2", Time::from_s(0.3), false, true, {}}};
  const auto whole = build(watched({}, events));
  advance(*whole, 49);
  EXPECT_FALSE(whole->stop_reason());
  // Half the time of holding lies before the snapshot.
  const auto half = build(watched({}, events));
  advance(*half, 35);
  const auto restored = test::again(*half);
  EXPECT_EQ(restored->state_hash(), half->state_hash());
  advance(*restored, 14);
  EXPECT_EQ(restored->state_hash(), whole->state_hash());
  EXPECT_FALSE(restored->stop_reason());
  advance(*restored, 1);
  EXPECT_EQ(restored->stop_reason(), "event 'end': sim.time >= 0.2");
  EXPECT_EQ(test::again(*restored)->stop_reason(), restored->stop_reason());
  advance(*whole, 1);
  EXPECT_EQ(restored->state_hash(), whole->state_hash());
}

TEST(Monitor, EventsFromOutsideChangeNoHash) {
  const auto plain = build(arena("planar", 1));
  const auto watching = build(arena("planar", 1));
  ASSERT_TRUE(watching->add_event({"stop", "sim.tick >= 7", {}, false, true, {}}));
  advance(*plain, 7);
  advance(*watching, 7);
  EXPECT_EQ(plain->state_hash(), watching->state_hash());
  EXPECT_EQ(watching->stop_reason(), "event 'stop': sim.tick >= 7");
}

TEST(Monitor, WhatIsNotFiniteEndsTheRun) {
  const auto simulation = build(watched({}, {{"bad", "1 / (sim.tick - 5) > 0", {}, false, false, {}}}));
  advance(*simulation, 4);
  const Status status = simulation->tick();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("event 'bad': a part of '1 / (sim.tick - 5) > 0'"), std::string::npos);
  EXPECT_NE(status.error().what.find("at 0.05 s"), std::string::npos) << status.error().what;
  EXPECT_TRUE(simulation->stop_reason());
}

TEST(Monitor, ADivisionByZeroEndsTheRunAlsoWhereAValueNamesIt) {
  // At tick 5: inf > 0 would be a yes, and so would be what is computed from it.
  for (const char* const when : {"slope > 0", "twice > 0", "values.twice < 1 or twice >= 1"}) {
    const auto simulation = build(
        watched({{"slope", "1 / (sim.tick - 5)", {}}, {"twice", "2 * slope", {}}},
                {{"bad", when, {}, false, false, {}},
                 {"guarded", "if(sim.tick == 5, 1, twice) > 0", {}, false, false, {}}}));
    advance(*simulation, 4);
    const Status status = simulation->tick();
    ASSERT_FALSE(status) << when;
    EXPECT_NE(status.error().what.find("event 'bad'"), std::string::npos) << status.error().what;
  }
  const auto guarded = build(watched({{"slope", "1 / (sim.tick - 5)", {}}},
                                     {{"good", "if(sim.tick == 5, 1, slope) > 0", {}, false, false, {}}}));
  advance(*guarded, 7);
  EXPECT_EQ(event(*guarded, "good").first, Time::from_s(0.05));
  // A measured infinity may be named.
  const auto measured = build(
      watched({{"far", "rover1/laser.ranges[0]", {}}}, {{"seen", "far > 0", {}, false, false, {}}}));
  advance(*measured, 20);
}

TEST(Monitor, WhatIsNotFiniteAtTheBeginningIsToldByTheFirstTick) {
  const auto simulation = build(watched({}, {{"bad", "1 / sim.tick > 0", {}, false, false, {}}}));
  EXPECT_FALSE(simulation->stop_reason())
      << "a run that asks before it ticks would end there, as if all were well";
  const Status status = simulation->tick();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("at 0 s"), std::string::npos);
  EXPECT_EQ(simulation->tick_index(), 0u);
}

TEST(Monitor, ARestoredRunAcceptsWhatIsGone) {
  model::Setup setup = arena("planar", 2);
  setup.values = {{"gap", "rover1.pose.x - rover2.pose.x", {}}};
  setup.events = {{"near", "gap < -100", {}, false, false, {}}};
  const auto simulation = build(std::move(setup));
  simulation->submit(DeleteRequest{"rover2"});
  advance(*simulation, 2);
  const auto restored = test::again(*simulation);
  ASSERT_NE(restored, nullptr);
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
  auto gap = NamedValue::find(*restored, "values.gap");
  ASSERT_TRUE(gap);
  EXPECT_FALSE(gap->read());
  advance(*restored, 1);
}

TEST(Monitor, ARestoredRunSpeaksOfNoValueThatComesLater) {
  const auto simulation = build(arena("planar", 1));
  for (const auto& [value, criterion, address] :
       {std::tuple{"b + 1", "1", "b"}, std::tuple{"values.b", "1", "values.b"},
        std::tuple{"criterion", "1", "criterion"}, std::tuple{"red.criterion", "1", "red.criterion"}}) {
    model::Setup setup;
    setup.values = {{"a", value, {}}, {"b", "2", {}}};
    setup.criterion = {criterion, "", {}};
    setup.teams.emplace_back().name = "red";
    setup.teams.back().criterion = {"3", "", {}};
    std::vector<std::string> known{address};  // as a forged file may have it
    EXPECT_FALSE(Monitor(*simulation).add(setup, known)) << address;
    setup.values.front().expression = "1";
    const Status well = Monitor(*simulation).add(setup, known);
    EXPECT_TRUE(well) << well.error().text();
  }
}

std::optional<double> evaluated(ValueExpression& expression) {
  const auto result = expression.evaluate();
  return result ? std::optional(result->value) : std::nullopt;
}

TEST(ValueExpression, AggregatesFollowThingsThatComeAndGo) {
  const auto simulation = build(arena("planar", 3));
  advance(*simulation, 5);
  auto sum = ValueExpression::compile(*simulation, "sum(rover*.pose.x)");
  ASSERT_TRUE(sum) << sum.error().text();
  EXPECT_EQ(sum->addresses(), std::vector<std::string>{"rover*.pose.x"});
  auto nearest = ValueExpression::compile(*simulation,
                                          "mean(rover*/laser.ranges[0] where rover*.errors > 0)");
  ASSERT_TRUE(nearest) << nearest.error().text();
  const auto x = [&](int i) { return value(*simulation, "rover" + std::to_string(i) + ".pose.x"); };
  EXPECT_EQ(evaluated(*sum), 0 + x(1) + x(2) + x(3));
  double ranges = 0;
  for (int i = 1; i <= 3; ++i) ranges += value(*simulation, "rover" + std::to_string(i) + "/laser.ranges[0]");
  EXPECT_EQ(evaluated(*nearest), ranges / 3);
  simulation->submit(DeleteRequest{"rover2"});
  advance(*simulation, 1);
  EXPECT_EQ(evaluated(*sum), 0 + x(1) + x(3));
  for (const char* const name : {"rover1", "rover3"}) simulation->submit(DeleteRequest{name});
  advance(*simulation, 1);
  EXPECT_EQ(evaluated(*sum), 0);
  EXPECT_EQ(evaluated(*nearest), std::nullopt);
}

TEST(ValueExpression, APatternThatFitsNothingIsRefusedUnlessItIsKnown) {
  const auto simulation = build(arena("planar", 1));
  const auto complaint = [&](const std::string& text) {
    const auto compiled = ValueExpression::compile(*simulation, text);
    return compiled ? "" : compiled.error().text();
  };
  EXPECT_NE(complaint("mean(rovr*.pose.x)").find("nothing is called 'rovr*'"), std::string::npos);
  EXPECT_NE(complaint("mean(rover*.pse.x)").find("nothing called 'rover*' has a value '.pse.x'"),
            std::string::npos);
  const std::vector<std::string> known{"rovr*.pose.x"};
  auto waiting = ValueExpression::compile(*simulation, "count(rovr*.pose.x > 0)", {}, known);
  ASSERT_TRUE(waiting) << waiting.error().text();
  EXPECT_EQ(evaluated(*waiting), 0);
}

}  // namespace
}  // namespace sandlot
