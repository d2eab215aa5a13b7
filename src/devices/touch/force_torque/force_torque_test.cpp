#include "devices/touch/force_torque/force_torque.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"

namespace sandlot::force_torque {
namespace {

using test::config;
using test::Rig;

void expect_near(Vec3 is, Vec3 should, double tolerance) {
  EXPECT_NEAR(is.x, should.x, tolerance);
  EXPECT_NEAR(is.y, should.y, tolerance);
  EXPECT_NEAR(is.z, should.z, tolerance);
}

/// Shows the load (1, 2, 3) N, (4, 5, 6) Nm, given along J, with these keys.
msg::Wrench shown(std::initializer_list<std::pair<const char*, const char*>> keys, double yaw_parent = 0) {
  model::Model model = test::two_wheels();
  model.joints[0].X_CJ.q = quat_from_rpy(0, 0, math::pi / 2);  // J's x is the child's y
  model.links[1].X_ML.q = {};
  Rig rig(kind, model);
  Node node = config({{"joint", "left"}, {"rate", "0"}});
  for (const auto& [key, value] : keys) node.set(key, Node::scalar(value));
  const Status added = rig.add("ft", node, 1, 1, {{}, quat_from_rpy(math::pi, 0, 0)});
  EXPECT_TRUE(added);
  rig.engine->body[0].X_WB.q = quat_from_rpy(0, 0, yaw_parent);
  rig.engine->loads[0] = {{1, 2, 3}, {4, 5, 6}};
  rig.act(2);
  EXPECT_EQ(rig.engine->watched.loads.size(), 1u);
  rig.sense();
  return rig.topic<msg::WrenchStamped>("ft/wrench").message.wrench;
}

TEST(ForceTorque, ShowsTheLoadInTheAxesAskedFor) {
  // Child: (x, y) of J are (y, -x) of the child. The default is what the child does to the parent.
  msg::Wrench w = shown({});
  expect_near(w.force, {2, -1, -3}, 1e-12);
  expect_near(w.torque, {5, -4, -6}, 1e-12);
  w = shown({{"direction", "parent_to_child"}});
  expect_near(w.force, {-2, 1, 3}, 1e-12);
  // The sensor lies upside down on the child, turned about x.
  w = shown({{"direction", "parent_to_child"}, {"frame", "sensor"}});
  expect_near(w.force, {-2, -1, -3}, 1e-12);
  // The parent has turned by 90 degrees: the child's x is its -y.
  w = shown({{"direction", "parent_to_child"}, {"frame", "parent"}}, math::pi / 2);
  expect_near(w.force, {1, 2, 3}, 1e-12);
  expect_near(w.torque, {4, 5, 6}, 1e-12);
}

TEST(ForceTorque, ShowsTheMeanSinceThePreviousSample) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("ft", config({{"joint", "left"}, {"direction", "parent_to_child"}})));
  rig.engine->loads[0] = {{0, 0, 1}, {}};
  rig.act();
  rig.engine->loads[0] = {{0, 0, 4}, {}};
  rig.act();
  rig.act();
  rig.sense();
  EXPECT_NEAR(rig.topic<msg::WrenchStamped>("ft/wrench").message.wrench.force.z, 3, 1e-12);
  rig.act();
  rig.sense();
  EXPECT_NEAR(rig.topic<msg::WrenchStamped>("ft/wrench").message.wrench.force.z, 4, 1e-12);
}

TEST(ForceTorque, RefusesAnEngineThatTellsNoLoads) {
  Rig rig(kind, test::two_wheels());
  rig.engine->what.joint_loads = false;
  EXPECT_FALSE(rig.add("ft", config({{"joint", "left"}})));
  rig.engine->what.joint_loads = true;
  EXPECT_FALSE(rig.add("ft", config({{"joint", "lost"}})));
}

TEST(ForceTorque, ReadsTheElementOfSdf) {
  Node own = config({{"frame", "parent"}, {"measure_direction", "parent_to_child"}});
  Node sensor = config({{"@joint", "left"}, {"update_rate", "30"}});
  sensor.set("force_torque", own);
  Diagnostics diagnostics;
  const auto keys = kind.from_sdf(sensor, diagnostics);
  ASSERT_TRUE(keys);
  EXPECT_TRUE(diagnostics.warnings.empty());
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("ft", *keys));
  EXPECT_EQ(rig.pool->rate_hz(0), 30);
  EXPECT_FALSE(kind.from_sdf(config({}), diagnostics));  // not in a joint
}

}  // namespace
}  // namespace sandlot::force_torque
