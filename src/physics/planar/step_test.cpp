#include <gtest/gtest.h>

#include "base/random.h"
#include "physics/planar/test_world.h"

namespace sandlot::planar {
namespace {

using namespace test;

TEST(PlanarDrive, ConstantVelocitiesEndOnTheCircle) {
  for (const double yaw : {0.0, 1.0, 3.0}) {
    World w;
    const InstanceId robot = w.add(robot_model(), at(1, 2, yaw));
    w.drive(robot, 0.5, 0.1, 0.7);
    w.run(1);  // past the (1e9 m/s^2) ramp, during which the motion is not the circle's
    const Pose start = w.engine.pose(robot);
    w.run(1000);
    // X(t) = X(0) exp(twist t): p = R(yaw) [sin a, -(1 - cos a); 1 - cos a, sin a] v / w with a = w t.
    const double a = 0.7 * 10, s = math::sin(a) / 0.7, c = (1 - math::cos(a)) / 0.7;
    const Vec3 expected = start * Vec3{0.5 * s - 0.1 * c, 0.5 * c + 0.1 * s, 0};
    // 1000 roundings of a position and a heading of order 1.
    EXPECT_NEAR(w.p(robot).x, expected.x, 1000 * 4e-16) << yaw;
    EXPECT_NEAR(w.p(robot).y, expected.y, 1000 * 4e-16) << yaw;
    EXPECT_NEAR(math::wrap_angle(yaw_of(w.engine.pose(robot).q) - yaw_of(start.q) - a), 0, 1000 * 2e-16 * 2);
    const Vec3 v = w.state(robot).V_WB.linear, v_B = rotate_inverse(w.engine.pose(robot).q, v);
    EXPECT_NEAR(v_B.x, 0.5, 1e-12);
    EXPECT_NEAR(v_B.y, 0.1, 1e-12);
    EXPECT_EQ(w.state(robot).V_WB.angular.z, 0.7);
  }
}

TEST(PlanarDrive, AccelerationIsLimited) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.drive(robot, 1, 0, 0, 0.7);
  w.run(100);  // 0.7 m/s after 1 s, 0.35 m on
  EXPECT_NEAR(w.state(robot).V_WB.linear.x, 0.7, 1e-13);
  EXPECT_NEAR(w.p(robot).x, 0.5 * 0.7, 1e-13);
  w.run(100);  // the target is reached at 1/0.7 s, within a step: s = v t - v^2 / (2 a)
  EXPECT_EQ(w.state(robot).V_WB.linear.x, 1);
  EXPECT_NEAR(w.p(robot).x, 2 - 1 / (2 * 0.7), 1e-13);
  w.drive(robot, 0, 0, 0, 0.7);
  w.run(200);  // and the same to a stop
  EXPECT_NEAR(w.p(robot).x, 2, 1e-13);
  EXPECT_EQ(w.state(robot).V_WB.linear.x, 0);
  // As a vector: from (1, 0) to (0, 1) the change is sqrt 2.
  w.drive(robot, 1, 0, 0);
  w.run(1);
  w.drive(robot, 0, 1, 0, std::sqrt(2.0));
  w.run(50);
  EXPECT_NEAR(w.state(robot).V_WB.linear.x, 0.5, 1e-13);
  EXPECT_NEAR(w.state(robot).V_WB.linear.y, 0.5, 1e-13);
}

TEST(PlanarDrive, AngularAccelerationIsLimited) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.drive(robot, 0, 0, -2, 1e9, 1);
  w.run(100);
  EXPECT_NEAR(yaw_of(w.engine.pose(robot).q), -0.5, 1e-13);
  EXPECT_NEAR(w.state(robot).V_WB.angular.z, -1, 1e-13);
}

TEST(PlanarDrive, TheFrameIsThatOfTheLinkItIsGivenFor) {
  auto model = robot_model();
  model::Link axle;
  axle.name = "axle";
  axle.X_ML = at(0.3, 0, math::pi / 2);  // its x is the base's y
  model->links.push_back(axle);
  model->joints.push_back({.name = "fixed", .parent = 0, .child = 1});
  World w;
  const InstanceId robot = w.add(model, at(0, 0));
  const DriveTarget target{w.engine.bodies(robot)[1], true, 0, 0, 1};
  w.engine.set_drive_targets({&target, 1});
  w.run(314);
  // The axle's origin stays, the base runs around it.
  const auto states = w.engine.states();
  const Vec3 axle_W = states[w.engine.bodies(robot)[1].index].X_WB.p;
  EXPECT_NEAR(axle_W.x, 0.3, 1e-9);  // 1e-9: the first step's ramp
  EXPECT_NEAR(axle_W.y, 0, 1e-9);
  EXPECT_NEAR(w.p(robot).x, 0.3 - 0.3 * math::cos(3.14), 1e-9);
  const DriveTarget forward{w.engine.bodies(robot)[1], true, 1, 0, 0};
  World v;
  const InstanceId other = v.add(model, at(0, 0));
  v.engine.set_drive_targets({&forward, 1});
  v.run(1);
  EXPECT_NEAR(v.p(other).y, 0.01, 1e-9);
}

TEST(PlanarDrive, AReleasedRobotSlidesToAStop) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.drive(robot, 1, 0, 0);
  w.run(10);
  const DriveTarget release{w.engine.bodies(robot)[0], false};
  w.engine.set_drive_targets({&release, 1});
  w.run(5);
  EXPECT_NEAR(w.state(robot).V_WB.linear.x, 1 - 9.81 * 0.05, 1e-9);  // mu 1
  w.run(10);
  EXPECT_EQ(w.state(robot).V_WB.linear, Vec3{});
}

TEST(PlanarContact, AWallStopsADisc) {
  World w;
  const InstanceId wall = w.add(model_of(Box{{0.1, 10, 1}}, true), at(2.05, 0, 0, 0.5));
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.drive(robot, 1, 0, 0.5);
  w.engine.step(h_s, 0);
  EXPECT_EQ(w.engine.contacts().size(), 0u);
  w.drive(robot, 1, 0, 0);
  w.run(400);
  EXPECT_NEAR(w.p(robot).x, 2 - 0.2, 1e-12);
  const double crept = w.p(robot).y;
  EXPECT_GT(crept, 0);  // it was turned a little and slides along
  EXPECT_NEAR(w.state(robot).V_WB.linear.x, 0, 1e-12);
  ASSERT_EQ(w.engine.contacts().size(), 1u);
  const Contact contact = w.engine.contacts()[0];
  EXPECT_EQ(contact.a, w.engine.bodies(wall)[0]);
  EXPECT_EQ(contact.b, w.engine.bodies(robot)[0]);
  EXPECT_NEAR(contact.normal_W.x, -1, 1e-12);
  EXPECT_NEAR(contact.depth_m, 0, 1e-4);
  EXPECT_NEAR(contact.force_W.x, -1 * 1 * math::cos(0.005) / h_s,
              1);  // 1 kg is brought back to 1 m/s each step
  EXPECT_NEAR(contact.point_W.z, 0.2, 1e-12);
}

TEST(PlanarContact, TheNormalPointsFromTheOlderToTheYounger) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(0.7, 0));
  const InstanceId wall = w.add(model_of(Box{{1, 1, 1}}, true), at(1.35, 0, 0, 0.5));  // overlap 0.05
  w.run(1);
  ASSERT_EQ(w.engine.contacts().size(), 1u);
  EXPECT_EQ(w.engine.contacts()[0].a, w.engine.bodies(robot)[0]);
  EXPECT_EQ(w.engine.contacts()[0].b, w.engine.bodies(wall)[0]);
  EXPECT_NEAR(w.engine.contacts()[0].normal_W.x, 1, 1e-12);
  EXPECT_NEAR(w.engine.contacts()[0].depth_m, 0.05, 1e-12);
}

TEST(PlanarContact, ADiscSlidesAlongAWall) {
  World w;
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(1.05, 0, 0, 0.5));
  const InstanceId robot = w.add(robot_model(), at(0, 0, math::pi / 4));
  w.drive(robot, 1, 0, 0);
  w.run(300);
  EXPECT_NEAR(w.p(robot).x, 0.8, 1e-12);
  // Each step the wall takes the part across it. What it takes of the speed ahead (half of it: v cos^2 45) is
  // regained at once, so the robot keeps 1 m/s * sin 45 along the wall.
  EXPECT_NEAR(w.p(robot).y, 3 * std::sqrt(0.5), 1e-6);
  EXPECT_NEAR(w.state(robot).V_WB.linear.y, std::sqrt(0.5), 1e-6);
}

TEST(PlanarContact, NoWallIsTooThinForAFastDisc) {
  World w;
  w.add(model_of(Box{{0.001, 10, 1}}, true), at(50, 0, 0, 0.5));
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.drive(robot, 10'000, 0, 0);  // 100 m in one step
  w.run(1);
  EXPECT_NEAR(w.p(robot).x, 50 - 0.0005 - 0.2, 1e-9);
}

TEST(PlanarContact, AHeldDriveLosesItsVelocity) {
  World w;
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(1.05, 0, 0, 0.5));
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.drive(robot, 1, 0, 0, 1);
  w.run(300);
  w.drive(robot, -1, 0, 0, 1);
  const double x = w.p(robot).x;
  w.run(100);  // it starts from rest, not from 1 m/s
  EXPECT_NEAR(x - w.p(robot).x, 0.5, 0.5 * h_s);
}

TEST(PlanarContact, AnInsideCornerHoldsADisc) {
  World w;
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(1.05, 0, 0, 0.5));
  w.add(model_of(Box{{10, 0.1, 1}}, true), at(0, 1.05, 0, 0.5));
  const InstanceId robot = w.add(robot_model(), at(0, 0, 0.7));
  w.drive(robot, 1, 0, 0);
  w.run(500);
  EXPECT_NEAR(w.p(robot).x, 0.8, 1e-9);
  EXPECT_NEAR(w.p(robot).y, 0.8, 1e-9);
}

TEST(PlanarContact, OverlapAtTheStartIsTakenBackByInverseMassAndLeavesNoVelocity) {
  World w;
  const InstanceId light = w.add(robot_model(1), at(0.3, 0));
  const InstanceId heavy = w.add(robot_model(3), at(0, 0));
  w.run(1);
  ASSERT_EQ(w.engine.contacts().size(), 1u);
  const Contact c = w.engine.contacts()[0];
  EXPECT_EQ(c.a, w.engine.bodies(light)[0]);
  EXPECT_NEAR(c.normal_W.x, -1, 1e-12);
  EXPECT_NEAR(c.depth_m, 0.1, 1e-12);
  w.run(100);
  // Overlap 0.1, but for the slop: three quarters to the light one.
  EXPECT_NEAR(w.p(light).x, 0.3 + 0.075, 1e-4);
  EXPECT_NEAR(w.p(heavy).x, -0.025, 1e-4);
  EXPECT_EQ(w.state(light).V_WB.linear, Vec3{});
}

TEST(PlanarContact, ARobotPushesABallUpToAWall) {
  World w;
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(2.05, 0, 0, 0.5));
  const InstanceId robot = w.add(robot_model(10), at(0, 0));
  const InstanceId ball = w.add(model_of(Sphere{0.1}, false, 0.5), at(0.5, 0, 0, 0.1));
  w.drive(robot, 1, 0, 0);
  w.run(100);
  EXPECT_GT(w.p(ball).x, 1.15);
  w.run(300);
  EXPECT_NEAR(w.p(ball).x, 1.9, 5e-4);
  EXPECT_NEAR(w.p(robot).x, 1.6, 1e-3);
}

TEST(PlanarContact, ThingsOfAnySizeCostNoMoreThanTheTable) {
  World w;
  w.add(model_of(Box{{1e9, 1e9, 0.2}}, true), at(0, 0, 0, -0.1));
  w.add(model_of(Cylinder{1e7, 0.1}), at(0, 2e7, 0, 5));
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.drive(robot, 1, 0, 0);
  w.run(100);
  EXPECT_NEAR(w.p(robot).x, 1, 1e-9);
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.5}, {1, 0, -1}, 10), static_cast<float>(std::sqrt(0.5)));
}

TEST(PlanarContact, OnlyWhatSharesHeightsMeets) {
  World w;
  w.add(model_of(Box{{4, 4, 0.1}}, true), at(0, 0, 0, -0.05 + 0.004));  // a floor that stands out by 4 mm
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(1.05, 0, 0, 0.9));        // begins at the robot's height 0.4
  w.add(model_of(Plane{{0, 0, 1}}, true), at(0, 0));
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.drive(robot, 1, 0, 0);
  w.run(300);
  EXPECT_NEAR(w.p(robot).x, 3, 1e-7);
}

TEST(PlanarContact, AllShapesOfABodyTouch) {
  auto model = robot_model();
  model->links[0].collisions.push_back({"nose", at(0.3, 0, 0, 0.2), Box{{0.2, 0.2, 0.1}}, {}, {}});
  World w;
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(2.05, 0, 0, 0.5));
  const InstanceId robot = w.add(model, at(0, 0));
  w.drive(robot, 1, 0, 0);
  w.run(300);
  EXPECT_NEAR(w.p(robot).x, 2 - 0.4, 2e-4);  // the nose ends at 0.4
}

TEST(PlanarContact, OrderOfCreationDoesNotMatterToThoseWhoDoNotTouch) {
  // The same crowd alone, among others that are far away, and after a removal that reused an index.
  const auto crowd = [](World& w) {
    std::vector<InstanceId> ids;
    for (int i = 0; i < 12; ++i) {
      ids.push_back(w.add(robot_model(1 + i), at(0.3 * (i % 4), 0.3 * (i / 4), 0.1 * i)));
      w.drive(ids.back(), 0.3, 0, 0.2 * i - 1);
    }
    return ids;
  };
  World alone, among;
  const auto a = crowd(alone);
  std::vector<InstanceId> strangers;
  for (int i = 0; i < 5; ++i) strangers.push_back(among.add(robot_model(), at(1000 + 0.3 * i, 0)));
  among.engine.remove(strangers[1]);
  among.engine.remove(strangers[3]);
  const auto b = crowd(among);
  alone.run(200);
  among.run(200);
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(alone.engine.pose(a[i]), among.engine.pose(b[i])) << i;
  EXPECT_EQ(alone.engine.contacts().size(), among.engine.contacts().size());
}

TEST(PlanarContact, TheSizeOfCellsChangesNothing) {
  std::vector<Pose> first;
  for (const double cell_m : {0.05, 0.5, 7.0}) {
    PlanarEngine engine(Spec{.cell_m = cell_m});
    std::vector<InstanceId> ids;
    model::Instance instance;
    instance.model = model_of(Box{{0.1, 10, 1}}, true);
    instance.X_WM = at(1, 0, 0.3);
    ASSERT_TRUE(engine.add(instance));
    Stream r(3, 0, Purpose::experiment, 0);
    for (int i = 0; i < 40; ++i) {
      instance.model = robot_model();
      const double x = r.uniform(-2, 2), y = r.uniform(-2, 2);
      instance.X_WM = at(x, y, r.uniform(-3, 3));
      ids.push_back(engine.add(instance).value());
      const DriveTarget target{engine.bodies(ids.back())[0], true, 0.5, 0, 0.3};
      engine.set_drive_targets({&target, 1});
    }
    for (int i = 0; i < 200; ++i) engine.step(h_s, 0);
    std::vector<Pose> poses;
    for (const InstanceId id : ids) poses.push_back(engine.pose(id));
    if (first.empty()) first = poses;
    EXPECT_EQ(poses, first) << cell_m;
  }
}

}  // namespace
}  // namespace sandlot::planar
