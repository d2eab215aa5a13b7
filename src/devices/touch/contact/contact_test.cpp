#include "devices/touch/contact/contact.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"

namespace sandlot::contact {
namespace {

using test::config;
using test::Rig;

struct Bench : Rig {
  model::Link wall_link{.name = "wall"};
  explicit Bench() : Rig(kind, with_shapes()) {
    wall_link.collisions.push_back({.name = "face"});
    engine->names = {{"robot1", &instance.model->links[0]},
                     {"robot1", &instance.model->links[1]},
                     {},
                     {},
                     {"house", &wall_link}};
  }
  static model::Model with_shapes() {
    model::Model m = test::two_wheels();
    m.links[0].collisions = {{.name = "front"}, {.name = "rear"}};
    return m;
  }
  /// The wall (body 4, made later) at one of the chassis' shapes.
  void touch(std::uint32_t shape, Vec3 force_on_robot, Vec3 point = {1, 2, 3}) {
    engine->contact.push_back(
        {engine->body_ids[0], {4, 1}, point, {1, 0, 0}, 0.002, -force_on_robot, shape, 0});
  }
};

TEST(Contact, ShowsWhoTouchesWhereAndHowHard) {
  Bench bench;
  ASSERT_TRUE(bench.add("b", config({})));
  bench.touch(1, {-5, 0, 0}, {1, 2, 3});
  bench.touch(1, {-3, 0, 0}, {1, 4, 3});
  bench.touch(0, {-1, 0, 0});
  bench.engine->contact.push_back(
      {bench.engine->body_ids[1], {4, 1}, {}, {0, 0, 1}, 0, {}, 0, 0});  // another link
  bench.act();
  ASSERT_EQ(bench.engine->watched.contacts.size(), 1u);
  EXPECT_EQ(bench.engine->watched.contacts[0], bench.engine->body_ids[0]);
  bench.sense();
  const auto& states = bench.topic<msg::ContactsState>("b/contacts").message.states;
  ASSERT_EQ(states.size(), 2u);
  EXPECT_EQ(states[0].collision1_name, "robot1::chassis::rear");
  EXPECT_EQ(states[0].collision2_name, "house::wall::face");
  ASSERT_EQ(states[0].wrenches.size(), 2u);
  EXPECT_EQ(states[0].wrenches[0].force, (Vec3{-5, 0, 0}));
  EXPECT_EQ(states[0].total_wrench.force, (Vec3{-8, 0, 0}));
  EXPECT_EQ(states[0].total_wrench.torque, (Vec3{0, 0, 6}));  // (0,2,0) x (-3,0,0), about the first point
  EXPECT_EQ(states[0].contact_normals[0], (Vec3{-1, 0, 0}));  // towards the robot
  EXPECT_EQ(states[0].contact_positions[1], (Vec3{1, 4, 3}));
  EXPECT_EQ(states[0].depths[1], 0.002);
  EXPECT_EQ(states[1].collision1_name, "robot1::chassis::front");
  bench.engine->contact.clear();
  bench.act();
  bench.sense();
  EXPECT_TRUE(states.empty());
}

TEST(Contact, TheBumperRemembersABlowBetweenTwoSamples) {
  Bench bench;
  ASSERT_TRUE(bench.add("b", config({{"threshold", "4"}, {"collision", "front"}}), 1u << bumper));
  const auto pressed = [&] {
    bench.sense();
    return bench.topic<msg::Bool>("b/bumper").message.data;
  };
  bench.touch(1, {-50, 0, 0});  // not the front
  bench.act();
  EXPECT_FALSE(pressed());
  bench.engine->contact.clear();
  bench.touch(0, {-3, 0, 0});  // too soft
  bench.act();
  EXPECT_FALSE(pressed());
  bench.touch(0, {-3, 0, 0});  // together enough
  bench.act();
  bench.engine->contact.clear();
  bench.act();
  EXPECT_TRUE(pressed());
  bench.act();
  EXPECT_FALSE(pressed());
}

TEST(Contact, RefusesWhatIsNotThere) {
  Bench bench;
  const Status wrong = bench.add("b", config({{"collision", "frint"}}));
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text().find("front"), std::string::npos);
  bench.engine->what.contact_forces = false;
  EXPECT_FALSE(bench.add("b", config({{"threshold", "1"}})));
  EXPECT_TRUE(bench.add("b", config({})));
}

TEST(Contact, ReadsTheElementOfSdf) {
  Node sensor = config({});
  sensor.set("contact", config({{"collision", "rear"}, {"topic", "x"}}));
  Diagnostics diagnostics;
  const auto keys = kind.from_sdf(sensor, diagnostics);
  ASSERT_TRUE(keys);
  EXPECT_TRUE(diagnostics.warnings.empty());
  Bench bench;
  ASSERT_TRUE(bench.add("b", *keys));
  bench.touch(0, {-1, 0, 0});
  bench.touch(1, {-2, 0, 0});
  bench.act();
  bench.sense();
  const auto& states = bench.topic<msg::ContactsState>("b/contacts").message.states;
  ASSERT_EQ(states.size(), 1u);
  EXPECT_EQ(states[0].collision1_name, "robot1::chassis::rear");
}

}  // namespace
}  // namespace sandlot::contact
