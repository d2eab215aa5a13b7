#include "devices/joints/gripper/gripper.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"
#include "physics/engines.h"

namespace sandlot::gripper {
namespace {

using test::config;

model::Model solid(const Shape& shape, double mass_kg, bool still = false) {
  model::Model m;
  m.is_static = still;
  m.links.push_back({.name = "body"});
  m.links[0].inertial = {.mass_kg = mass_kg, .moments = inertia_kg_m2(shape, mass_kg)};
  m.links[0].collisions.push_back({.name = "body", .shape = shape});
  return m;
}

/// A robot of 5 kg at the origin with a gripper 0.15 ahead of its middle, on an engine, among cans of 0.5 kg.
struct World : TopicMaker {
  std::unique_ptr<Engine> engine;
  std::map<std::string, model::Instance> instances;
  std::map<std::string, InstanceId> ids;
  std::unique_ptr<PoolBase> pool = kind.create_pool();
  std::map<std::string, std::unique_ptr<TopicBase>> topics;
  Actuation actuation;
  EmissionBuffer emissions;
  test::NoRays rays;
  Time now, tick = Time::from_s(0.01);
  std::uint64_t index = 0, sample = 0;
  std::uint32_t zero = 0, levels = 1;
  Time since = tick;
  Status made;

  explicit World(const EngineKind& engine_kind, Node keys = config({}), double gravity = 9.81) {
    engine = std::move(*engine_kind.create(Node::map(), {0, 0, -gravity}));
    add("ground", solid(Plane{{0, 0, 1}}, 1, true), {});
    add("robot1", solid(Box{{0.2, 0.2, 0.1}}, 5), {0, 0, 0.05});
    model::DeviceDecl decl{.name = "hand", .X_LS = {{0.15, 0, 0}, {}}, .config = std::move(keys)};
    const InstanceId robot = ids.at("robot1");
    made = pool->add({decl, instances.at("robot1"), "robot1/hand", entity_key("robot1/hand"), 1,
                      engine->bodies(robot), engine->joints(robot), engine->capabilities(), tick, levels,
                      *this});
  }
  void add(const std::string& name, model::Model m, Vec3 p) {
    model::Instance& i = instances[name];
    m.name = name;
    i.name = i.original_name = name;
    i.is_robot = name == "robot1";
    i.model = std::make_shared<const model::Model>(std::move(m));
    i.X_WM.p = p;
    ids[name] = *engine->add(i);
  }
  void can(const std::string& name, double x, double y) {
    add(name, solid(Cylinder{0.03, 0.1}, 0.5), {x, y, 0.05});
  }
  void adopt_topic(std::unique_ptr<TopicBase> topic, std::uint32_t) override {
    topics[topic->name()] = std::move(topic);
  }
  void adopt_order(std::unique_ptr<DeviceOrder>) override { ADD_FAILURE() << "it gives no orders"; }
  void adopt_inbox(std::unique_ptr<Inbox>) override {}
  void adopt_light(std::unique_ptr<SceneLight>) override {}
  void adopt_command(std::unique_ptr<TopicBase> topic, std::uint32_t) override {
    topics[topic->name()] = std::move(topic);
  }
  Context context() { return {now + tick, tick, index, 1, *engine, rays, actuation, emissions}; }
  PoolBase::Due due() {
    return {std::span(&zero, 1), std::span(&sample, 1), std::span(&levels, 1), std::span(&since, 1)};
  }
  void tell(bool closed) {
    auto& slot = *topic_cast<msg::Bool>(topics.at("/robot1/hand/hold/command").get());
    slot.message.data = closed;
    ++slot.count;
  }
  /// With a force on the robot along x.
  void run(int ticks, double force_N = 0) {
    for (int i = 0; i < ticks; ++i, ++index, now = now + tick) {
      actuation.clear();
      pool->actuate(context(), due());
      for (int k = 0; k < 2; ++k) {
        pool->pre_substep(context(), due(), 0.005);
        const Wrench push{engine->bodies(ids.at("robot1"))[0], {force_N, 0, 0}, {}};
        engine->apply({&push, 1});
        engine->set_grips(actuation.grips);
        engine->step(0.005, 2 * index + static_cast<std::uint64_t>(k));
        pool->post_substep(context(), due(), 0.005);
        actuation.clear();
      }
      pool->sense(context(), due());
    }
  }
  const msg::GripperState& seen() {
    return topic_cast<msg::GripperState>(topics.at("/robot1/hand/hold").get())->message;
  }
  BodyState state(const std::string& name) { return engine->states()[engine->bodies(ids.at(name))[0].index]; }
  std::vector<std::byte> saved() {
    ByteWriter w;
    for (const char* name : {"ground", "robot1", "near", "far"}) engine->save(ids.at(name), w);
    pool->save(0, w);
    return w.buffer();
  }
};

class GripperOn : public ::testing::TestWithParam<const EngineKind*> {};

TEST_P(GripperOn, HoldsTheNearestInReachUntilItOpens) {
  World w(*GetParam(), config({{"reach", "0.1"}}));
  ASSERT_TRUE(w.made) << w.made.error().text();
  w.can("far", 0.27, 0.0);  // 0.12 - 0.03 = 0.09 from the point
  w.can("near", 0.2, 0.0);  // 0.05 - 0.03 = 0.02
  w.run(1);
  EXPECT_FALSE(w.seen().closed);
  EXPECT_EQ(w.seen().held, "");
  w.tell(true);
  w.run(1);
  EXPECT_TRUE(w.seen().closed);
  EXPECT_EQ(w.seen().held, "near::body");
  w.run(50, 120);  // faster than its own friction lets it: mu g 6 kg = 59 N
  EXPECT_GT(w.state("robot1").X_WB.p.x, 0.3);
  EXPECT_NEAR(w.state("near").X_WB.p.x - w.state("robot1").X_WB.p.x, 0.2, 1e-3);
  EXPECT_EQ(w.seen().held, "near::body");
  w.tell(false);
  w.run(1, 120);
  EXPECT_EQ(w.seen().held, "");
  EXPECT_EQ(w.seen().force, Vec3{});
  EXPECT_TRUE(w.engine->grips().empty());
}

TEST_P(GripperOn, NothingInReachIsHeldAndAnotherCommandTriesAgain) {
  World w(*GetParam(), config({{"reach", "0.01"}, {"closed", "true"}}));
  w.add("wall", solid(Box{{0.1, 0.1, 0.1}}, 1, true), {0.15, 0, 0.05});  // in reach, but nothing moves it
  w.can("near", 0.2, 0.0);
  w.run(5);
  EXPECT_TRUE(w.seen().closed);
  EXPECT_EQ(w.seen().held, "");
  w.engine->remove(w.ids.at("wall"));
  w.engine->set_pose(w.ids.at("near"), {{0.185, 0, 0.05}, {}});
  w.run(5);
  EXPECT_EQ(w.seen().held, "");
  w.tell(true);
  w.run(1);
  EXPECT_EQ(w.seen().held, "near::body");
}

TEST_P(GripperOn, OfEqualsTheFirstByNameWhateverTheirOrder) {
  for (const bool turned : {false, true}) {
    World w(*GetParam());
    w.can(turned ? "b" : "a", 0.15, 0.05);
    w.can(turned ? "a" : "b", 0.15, -0.05);
    w.tell(true);
    w.run(1);
    EXPECT_EQ(w.seen().held, "a::body");
  }
}

TEST_P(GripperOn, TellsTheForceAndIsTornOpenByMore) {
  // Nothing rubs without weight: 11 N on 5.5 kg are 2 m/s^2, of which 0.5 kg in the grip needs 1 N.
  World w(*GetParam(), config({{"max_force", "20"}}), 0);
  w.can("near", 0.19, 0);
  w.tell(true);
  w.run(20, 11);
  ASSERT_EQ(w.seen().held, "near::body");
  EXPECT_NEAR(w.state("near").V_WB.linear.x, 0.4, 1e-4);  // ODE's compliance
  EXPECT_NEAR(w.seen().force.x, 1, 1e-2);
  w.run(3, 600);  // 109 m/s^2: 55 N
  EXPECT_EQ(w.seen().held, "");
  EXPECT_TRUE(w.seen().closed);
  EXPECT_TRUE(w.engine->grips().empty());
  w.run(50);
  EXPECT_EQ(w.seen().held, "");  // it does not snap by itself
}

TEST_P(GripperOn, WhatIsTakenAwayIsNoLongerHeld) {
  World w(*GetParam());
  w.can("near", 0.19, 0);
  w.tell(true);
  w.run(5);
  ASSERT_EQ(w.seen().held, "near::body");
  w.engine->remove(w.ids.at("near"));
  w.run(1);
  EXPECT_EQ(w.seen().held, "");
}

TEST_P(GripperOn, ARestoredGraspGoesOnWithTheSameBits) {
  const auto fresh = [&] {
    World w(*GetParam(), config({{"reach", "0.1"}, {"max_force", "1000"}}));
    w.can("near", 0.2, 0.01);
    w.can("far", 0.45, 0.02);
    return w;
  };
  World w = fresh();
  w.tell(true);
  w.run(30, 80);
  ASSERT_EQ(w.seen().held, "near::body");
  World copy = fresh();
  const auto bytes = w.saved();
  ByteReader r(bytes);
  for (const char* name : {"ground", "robot1", "near", "far"})
    ASSERT_TRUE(copy.engine->load(copy.ids.at(name), r));
  copy.pool->load(0, r);
  ASSERT_TRUE(r.ok());
  copy.topics.at("/robot1/hand/hold/command")->count = 1;
  copy.index = w.index, copy.now = w.now;
  for (int i = 0; i < 60; ++i) {
    w.run(1, 80);
    copy.run(1, 80);
    ASSERT_EQ(w.saved(), copy.saved()) << i;
    ASSERT_EQ(w.seen().held, copy.seen().held) << i;
  }
  EXPECT_GT(w.state("far").X_WB.p.x, 0.46);  // what is held pushed the other
}

TEST_P(GripperOn, UnloadingLetsGo) {
  World w(*GetParam());
  w.can("near", 0.19, 0);
  w.tell(true);
  w.run(2);
  ASSERT_EQ(w.engine->grips().size(), 1u);
  w.pool->release(0, w.context());
  w.engine->set_grips(w.actuation.grips);
  EXPECT_TRUE(w.engine->grips().empty());
}

INSTANTIATE_TEST_SUITE_P(Engines, GripperOn,
                         ::testing::ValuesIn(engine_kinds().begin(), engine_kinds().end()),
                         [](const auto& param) { return std::string(param.param->name); });

TEST(Gripper, AnEngineWithoutGripsIsRefused) {
  test::Rig rig(kind, test::two_wheels());
  const Status added = rig.add("hand", config({}));
  ASSERT_FALSE(added);
  EXPECT_NE(added.error().text().find("'hand' cannot hold things together"), std::string::npos);
}

TEST(Gripper, GazebosVacuumGripperIsOne) {
  Diagnostics diagnostics;
  const Node element = config(
      {{"@name", "hand"}, {"link_name", "tip"}, {"max_distance", "0.02"}, {"fixed", "floor"}});
  const auto keys = kind.from_sdf(element, diagnostics);
  ASSERT_TRUE(keys);
  EXPECT_EQ(keys->find("link")->text(), "tip");
  EXPECT_EQ(keys->find("reach")->text(), "0.02");
  ASSERT_EQ(diagnostics.warnings.size(), 1u);
  EXPECT_NE(diagnostics.warnings[0].text().find("fixed"), std::string::npos);
}

}  // namespace
}  // namespace sandlot::gripper
