#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/height_grid.h"
#include "physics/planar/test_world.h"

namespace sandlot::planar {
namespace {

using namespace test;

TEST(PlanarJoint, AWheelCountsTurnsAndItsLinkFollows) {
  auto model = robot_model();
  model::Link wheel;
  wheel.name = "wheel";
  wheel.X_ML = pose_from_rpy({0, 0.2, 0.1}, {-math::pi / 2, 0, 0});  // its z points left
  model->links.push_back(wheel);
  model->joints.push_back({.name = "axle", .type = model::JointType::continuous, .parent = 0, .child = 1});
  World w;
  const InstanceId robot = w.add(model, at(0, 0));
  const JointId axle = w.engine.joints(robot)[0];
  const JointTarget spin{axle, JointTarget::Mode::velocity, 10, 1, 0};
  w.engine.set_targets({&spin, 1});
  w.drive(robot, 1, 0, 0);
  w.run(1000);
  EXPECT_NEAR(w.engine.joint_states()[axle.index].position, 100, 1e-10);  // 1000 roundings
  EXPECT_EQ(w.engine.joint_states()[axle.index].velocity, 10);
  const BodyState state = w.engine.states()[w.engine.bodies(robot)[1].index];
  EXPECT_NEAR(state.X_WB.p.x, 10, 1e-7);
  EXPECT_NEAR(state.X_WB.p.y, 0.2, 1e-12);
  EXPECT_NEAR(state.V_WB.angular.y, 10, 1e-12);
  // Turned by 100 rad about the axle: the wheel's x axis.
  const Vec3 x_W = rotate(state.X_WB.q, {1, 0, 0});
  EXPECT_NEAR(x_W.x, math::cos(100), 1e-10);
  EXPECT_NEAR(x_W.z, -math::sin(100), 1e-10);
  const JointTarget loose{axle};
  w.engine.set_targets({&loose, 1});
  w.run(10);
  EXPECT_NEAR(w.engine.joint_states()[axle.index].position, 100, 1e-10);
  EXPECT_EQ(w.engine.joint_states()[axle.index].velocity, 0);
}

/// A base that no joint's reaction moves.
std::shared_ptr<model::Model> anvil() {
  auto model = robot_model(1e12);
  model->links[0].inertial.moments = {1e12, 1e12, 1e12};
  return model;
}

TEST(PlanarJoint, LimitsHoldItAndASlideMoves) {
  auto model = anvil();
  model::Link lift;
  lift.name = "lift";
  lift.X_ML = at(0.1, 0, math::pi / 2, 0.3);
  model->links.push_back(lift);
  model->joints.push_back({.name = "slide",
                           .type = model::JointType::prismatic,
                           .parent = 0,
                           .child = 1,
                           .axis_J = {1, 0, 0},
                           .lower = -0.1,
                           .upper = 0.25,
                           .max_velocity = 0.5});
  World w;
  const InstanceId robot = w.add(model, at(1, 1, math::pi / 2));
  const JointId slide = w.engine.joints(robot)[0];
  const JointTarget out{slide, JointTarget::Mode::velocity, 3, 1e9, 0};
  w.engine.set_targets({&out, 1});
  w.run(20);
  EXPECT_NEAR(w.engine.joint_states()[slide.index].position, 0.1, 1e-4);  // at max_velocity
  // x of the lift is -x of W: (1, 1.1) - (0.1, 0).
  EXPECT_NEAR(w.engine.states()[w.engine.bodies(robot)[1].index].X_WB.p.x, 0.9, 1e-4);
  EXPECT_NEAR(w.engine.states()[w.engine.bodies(robot)[1].index].X_WB.p.y, 1.1, 1e-4);
  EXPECT_NEAR(w.engine.states()[w.engine.bodies(robot)[1].index].V_WB.linear.x, -0.5, 1e-4);
  w.run(100);
  EXPECT_NEAR(w.engine.joint_states()[slide.index].position, 0.25, 1e-4);
  EXPECT_NEAR(w.engine.joint_states()[slide.index].velocity, 0, 1e-4);
}

TEST(PlanarJoint, AHingeTurnsAboutItsOwnAxis) {
  auto model = anvil();
  model::Link door;
  door.name = "door";
  door.X_ML = at(1, 0);
  model->links.push_back(door);
  model->joints.push_back({.name = "hinge",
                           .type = model::JointType::revolute,
                           .parent = 0,
                           .child = 1,
                           .X_CJ = {{-0.5, 0, 0}, {}}});
  World w;
  const InstanceId robot = w.add(model, at(0, 0));
  const JointTarget swing{w.engine.joints(robot)[0], JointTarget::Mode::velocity, math::pi / 2, 1e9, 0};
  w.engine.set_targets({&swing, 1});
  w.run(100);
  // A quarter turn about (0.5, 0).
  const BodyState state = w.engine.states()[w.engine.bodies(robot)[1].index];
  EXPECT_NEAR(state.X_WB.p.x, 0.5, 1e-4);
  EXPECT_NEAR(state.X_WB.p.y, 0.5, 1e-4);
  EXPECT_NEAR(state.V_WB.linear.x, -0.5 * math::pi / 2, 1e-4);
  EXPECT_NEAR(state.V_WB.linear.y, 0, 1e-4);
}

TEST(PlanarJoint, ATreeMayHangFromAChild) {
  // The canonical link is the joint's child: the other link swings the opposite way.
  auto model = anvil();
  model::Link arm;
  arm.name = "arm";
  arm.X_ML = at(1, 0);
  model->links.push_back(arm);
  model->joints.push_back({.name = "hinge", .type = model::JointType::revolute, .parent = 1, .child = 0});
  World w;
  const InstanceId robot = w.add(model, at(0, 0));
  const JointTarget swing{w.engine.joints(robot)[0], JointTarget::Mode::velocity, 1, 1e9, 0};
  w.engine.set_targets({&swing, 1});
  w.run(100);
  const BodyState state = w.engine.states()[w.engine.bodies(robot)[1].index];
  EXPECT_NEAR(state.X_WB.p.x, math::cos(1), 1e-4);
  EXPECT_NEAR(state.X_WB.p.y, -math::sin(1), 1e-4);
  EXPECT_NEAR(state.V_WB.linear.x, -math::sin(1), 1e-4);
  EXPECT_NEAR(state.V_WB.linear.y, -math::cos(1), 1e-4);
  EXPECT_NEAR(state.V_WB.angular.z, -1, 1e-4);
}

TEST(PlanarEngine, ASnapshotContinuesToTheBit) {
  const auto build = [](World& w) {
    std::vector<InstanceId> ids{w.add(model_of(Box{{0.1, 10, 1}}, true), at(1.5, 0, 0.2, 0.5))};
    auto model = robot_model();
    model::Link wheel;
    wheel.name = "wheel";
    wheel.X_ML = at(0, 0.2);
    model->links.push_back(wheel);
    model->joints.push_back({.name = "axle", .type = model::JointType::continuous, .parent = 0, .child = 1});
    model->links[0].collisions.push_back({"nose", at(0.1, 0.05, 0.3, 0.2), Box{{0.3, 0.2, 0.1}}, {}, {}});
    for (int i = 0; i < 10; ++i)
      ids.push_back(w.add(model, pose_from_rpy({0.4 * i, 0.02 * i * i, 0}, {0.02, 0.01 * i, 0.5 * i})));
    return ids;
  };
  const auto command = [](World& w, std::span<const InstanceId> ids) {
    for (std::size_t i = 1; i < ids.size(); ++i) {
      w.drive(ids[i], 0.5, 0, 0.3 * static_cast<double>(i) - 1, 0.4, 0.3);
      const JointTarget spin{w.engine.joints(ids[i])[0], JointTarget::Mode::velocity, static_cast<double>(i),
                             1, 0};
      w.engine.set_targets({&spin, 1});
    }
  };
  const auto bytes = [](World& w, std::span<const InstanceId> ids) {
    ByteWriter writer;
    for (const InstanceId id : ids) w.engine.save(id, writer);
    return std::vector<std::byte>(writer.bytes().begin(), writer.bytes().end());
  };
  World first, second;
  const auto a = build(first), b = build(second);
  command(first, a);
  first.run(150);
  EXPECT_FALSE(first.engine.contacts().empty());
  const auto middle = bytes(first, a);
  first.run(150);
  ByteReader reader(middle);
  for (const InstanceId id : b) ASSERT_TRUE(second.engine.load(id, reader));
  EXPECT_EQ(reader.remaining(), 0u);
  EXPECT_EQ(bytes(second, b), middle);
  second.run(150);
  EXPECT_EQ(bytes(first, a), bytes(second, b));
  EXPECT_NE(bytes(first, a), middle);
  ByteReader torn{std::span<const std::byte>(middle).first(middle.size() - 9)};
  bool all = true;
  for (const InstanceId id : b) all = second.engine.load(id, torn) && all;
  EXPECT_FALSE(all);
}

TEST(PlanarEngine, APoseComesBackAsItWasGiven) {
  auto model = robot_model();
  model->links[0].X_ML = pose_from_rpy({0.1, 0.2, 0.3}, {0.1, 0.2, 0.3});
  World w;
  for (const Vec3 rpy : {Vec3{}, Vec3{0, 0, 2}, Vec3{0.3, -0.2, -3}, Vec3{3.0, 0.1, 1}}) {
    const Pose X = pose_from_rpy({1, 2, 3}, rpy);
    const InstanceId id = w.add(model, X);
    for (const Pose& seen : {w.engine.pose(id), (w.engine.set_pose(id, X), w.engine.pose(id))}) {
      EXPECT_NEAR(norm(seen.p - X.p), 0, 1e-14);
      const Quat d = conjugate(X.q) * seen.q;
      EXPECT_NEAR(std::abs(d.w), 1, 1e-14);
    }
  }
}

TEST(PlanarEngine, WhatItCannotExpressIsAnError) {
  World w;
  model::Instance instance;
  instance.X_WM = pose_from_rpy({}, {0, 0.5, 0});
  instance.model = model_of(Plane{{0, 0, 1}}, true);
  EXPECT_NE(w.engine.add(instance).error().what.find("horizontal planes only"), std::string::npos);
  instance.X_WM = {};
  EXPECT_TRUE(w.engine.add(instance));
  instance.model = model_of(Plane{{0, 0, 1}});
  EXPECT_NE(w.engine.add(instance).error().what.find("moving planes"), std::string::npos);
  instance.model = std::make_shared<model::Model>();
  EXPECT_FALSE(w.engine.add(instance));
}

TEST(PlanarEngine, NotANumberIsFoundAndNamed) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.run(1);
  EXPECT_TRUE(w.engine.check_finite());
  w.drive(robot, std::nan(""), 0, 0);
  w.run(1);
  ASSERT_FALSE(w.engine.check_finite());
  EXPECT_NE(w.engine.check_finite().error().what.find("thing/base"), std::string::npos);
  w.see({0, 0, 0}, {1, 0, 0});  // and nothing breaks meanwhile
  w.run(1);
}

TEST(PlanarEngine, AnInstanceThatIsGoneTakesNoCommands) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  const DriveTarget old{w.engine.bodies(robot)[0], true, 1, 0, 0};
  w.engine.remove(robot);
  const InstanceId next = w.add(robot_model(), at(5, 0));
  EXPECT_EQ(w.engine.bodies(next)[0].index, old.base.index);
  EXPECT_NE(w.engine.bodies(next)[0], old.base);
  EXPECT_DEATH(w.engine.set_drive_targets({&old, 1}), "no such body");
  w.run(10);
  EXPECT_EQ(w.p(next).x, 5);
  EXPECT_EQ(w.engine.counters().awake_bodies, 1u);
}

TEST(PlanarEngine, TurnsAgreeWithTheLibrary) {
  Stream r(6, 0, Purpose::experiment, 0);
  for (int i = 0; i < 20'000; ++i) {
    const double rad = (i % 2 ? 10.0 : 9e4) * r.uniform(-1, 1);
    const Turn t = turn_of(rad);
    const auto [s, c] = math::sincos(rad);
    // An ulp of the functions and what the reduced argument is off: k * 2^-86 and one rounding.
    ASSERT_NEAR(t.c, c, 4e-16) << rad;
    ASSERT_NEAR(t.s, s, 4e-16) << rad;
  }
}

TEST(PlanarEngine, TerrainIsRefusedByName) {
  World w;
  HeightGrid grid{2, 2, 1, 1, {0, 0, 0, 0}, {}};
  model::Instance instance;
  instance.model = model_of(Heightfield{std::make_shared<const HeightGrid>(grid)}, true);
  const auto made = w.engine.add(instance);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().what.find("no terrain"), std::string::npos);
}

}  // namespace
}  // namespace sandlot::planar
