#include "physics/planar/planar.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace sandlot::planar {
namespace {

constexpr double h_s = 0.01;

std::shared_ptr<model::Model> model_of(Shape shape, bool is_static = false, double mass_kg = 1,
                                       Pose X_LC = {}) {
  auto model = std::make_shared<model::Model>();
  model->name = "thing";
  model->is_static = is_static;
  model::Link link;
  link.name = "base";
  link.inertial.mass_kg = mass_kg;
  link.collisions.push_back({"shape", X_LC, shape, {}, {}});
  model->links.push_back(link);
  return model;
}
/// A robot of radius 0.2 standing on the ground, 0.4 high.
std::shared_ptr<model::Model> robot_model(double mass_kg = 1) {
  return model_of(Cylinder{0.2, 0.4}, false, mass_kg, {{0, 0, 0.2}, {}});
}
Pose at(double x, double y, double yaw = 0, double z = 0) { return pose_from_rpy({x, y, z}, {0, 0, yaw}); }

struct World {
  PlanarEngine engine{Spec{}};
  InstanceId add(std::shared_ptr<const model::Model> model, Pose X_WM) {
    model::Instance instance;
    instance.name = "thing";
    instance.model = std::move(model);
    instance.X_WM = X_WM;
    return engine.add(instance).value();
  }
  void drive(InstanceId id, double vx, double vy, double wz, double accel = 1e9, double angular = 1e9) {
    const DriveTarget target{engine.bodies(id)[0], true, vx, vy, wz, accel, angular};
    engine.set_drive_targets({&target, 1});
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) engine.step(h_s, 0);
  }
  Vec3 p(InstanceId id) { return engine.pose(id).p; }
  BodyState state(InstanceId id) { return engine.states()[engine.bodies(id)[0].index]; }
  float see(Vec3 from, Vec3 direction, double max_m = 100, std::uint32_t ignore = no_body,
            std::uint32_t* body = nullptr, double min_m = 0) {
    float distance = -1;
    std::uint32_t hit = 0;
    const Vec3 d = normalised(direction);
    const RayJob job{{from, {}}, {&d, 1}, min_m, max_m, ignore, {&distance, 1}, {&hit, 1}};
    engine.rays()->cast({&job, 1});
    if (body) *body = hit;
    return distance;
  }
};

// --- ideal drives -------------------------------------------------------------------------------------------------

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

TEST(PlanarDrive, AReleasedRobotStops) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(0, 0));
  w.drive(robot, 1, 0, 1);
  w.run(10);
  const DriveTarget release{w.engine.bodies(robot)[0], false};
  w.engine.set_drive_targets({&release, 1});
  const Vec3 before = w.p(robot);
  w.run(10);
  EXPECT_EQ(w.p(robot), before);
  EXPECT_EQ(w.state(robot).V_WB.linear, Vec3{});
}

// --- contacts -----------------------------------------------------------------------------------------------------

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
  EXPECT_NEAR(contact.depth_m, h_s * math::cos(0.005), 1e-6);
  EXPECT_NEAR(contact.point_W.z, 0.2, 1e-12);
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

TEST(PlanarContact, DiscsArePushedByInverseMass) {
  World w;
  const InstanceId light = w.add(robot_model(1), at(0.3, 0));
  const InstanceId heavy = w.add(robot_model(3), at(0, 0));
  w.run(1);
  // Overlap 0.1: three quarters to the light one.
  EXPECT_NEAR(w.p(light).x, 0.3 + 0.075, 1e-12);
  EXPECT_NEAR(w.p(heavy).x, -0.025, 1e-12);
  ASSERT_EQ(w.engine.contacts().size(), 1u);
  const Contact c = w.engine.contacts()[0];
  EXPECT_EQ(c.a, w.engine.bodies(light)[0]);
  EXPECT_NEAR(c.normal_W.x, -1, 1e-12);
  EXPECT_NEAR(c.depth_m, 0.1, 1e-12);
  EXPECT_NEAR(w.state(light).V_WB.linear.x, 0.075 / h_s, 1e-9);
  w.run(1);
  EXPECT_EQ(w.state(light).V_WB.linear.x, 0);  // the ground stops it at once
  EXPECT_TRUE(w.engine.contacts().empty());
}

TEST(PlanarContact, ARobotPushesABoxUpToAWall) {
  World w;
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(2.05, 0, 0, 0.5));
  const InstanceId robot = w.add(robot_model(10), at(0, 0));
  const InstanceId ball = w.add(model_of(Sphere{0.1}, false, 0.5), at(0.5, 0, 0, 0.1));
  w.drive(robot, 1, 0, 0);
  w.run(100);
  EXPECT_GT(w.p(ball).x, 1.2);
  EXPECT_NEAR(w.p(ball).x - w.p(robot).x, 0.3, 1e-9);
  w.run(300);
  EXPECT_NEAR(w.p(ball).x, 1.9, 1e-9);
  EXPECT_NEAR(w.p(robot).x, 1.6, 1e-9);
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

TEST(PlanarContact, TheDiscEnclosesAllShapes) {
  auto model = robot_model();
  model->links[0].collisions.push_back({"nose", at(0.3, 0, 0, 0.2), Box{{0.2, 0.2, 0.1}}, {}, {}});
  World w;
  w.add(model_of(Box{{0.1, 10, 1}}, true), at(2.05, 0, 0, 0.5));
  const InstanceId robot = w.add(model, at(0, 0));
  w.drive(robot, 1, 0, 0);
  w.run(300);
  // The rectangle goes from -0.2 to 0.4: a circle about 0.1 that reaches the nose's corner (0.4, 0.1).
  EXPECT_NEAR(w.p(robot).x, 2 - std::sqrt(0.3 * 0.3 + 0.1 * 0.1) - 0.1, 1e-9);
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

// --- joints -------------------------------------------------------------------------------------------------------

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

TEST(PlanarJoint, LimitsHoldItAndASlideMoves) {
  auto model = robot_model();
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
  const JointTarget out{slide, JointTarget::Mode::velocity, 3, 1, 0};
  w.engine.set_targets({&out, 1});
  w.run(20);
  EXPECT_NEAR(w.engine.joint_states()[slide.index].position, 0.1, 1e-12);  // at max_velocity
  // x of the lift is -x of W: (1, 1.1) - (0.1, 0).
  EXPECT_NEAR(w.engine.states()[w.engine.bodies(robot)[1].index].X_WB.p.x, 0.9, 1e-12);
  EXPECT_NEAR(w.engine.states()[w.engine.bodies(robot)[1].index].X_WB.p.y, 1.1, 1e-12);
  EXPECT_NEAR(w.engine.states()[w.engine.bodies(robot)[1].index].V_WB.linear.x, -0.5, 1e-12);
  w.run(100);
  EXPECT_EQ(w.engine.joint_states()[slide.index].position, 0.25);
  EXPECT_EQ(w.engine.joint_states()[slide.index].velocity, 0);
}

TEST(PlanarJoint, ATreeMayHangFromAChild) {
  // The canonical link is the joint's child: the other link swings the opposite way.
  auto model = robot_model();
  model::Link arm;
  arm.name = "arm";
  arm.X_ML = at(1, 0);
  model->links.push_back(arm);
  model->joints.push_back({.name = "hinge", .type = model::JointType::revolute, .parent = 1, .child = 0});
  World w;
  const InstanceId robot = w.add(model, at(0, 0));
  const JointTarget swing{w.engine.joints(robot)[0], JointTarget::Mode::velocity, 1, 1, 0};
  w.engine.set_targets({&swing, 1});
  w.run(100);
  const BodyState state = w.engine.states()[w.engine.bodies(robot)[1].index];
  EXPECT_NEAR(state.X_WB.p.x, math::cos(1), 1e-12);
  EXPECT_NEAR(state.X_WB.p.y, -math::sin(1), 1e-12);
  EXPECT_NEAR(state.V_WB.linear.x, -math::sin(1), 1e-12);
  EXPECT_NEAR(state.V_WB.linear.y, -math::cos(1), 1e-12);
  EXPECT_NEAR(state.V_WB.angular.z, -1, 1e-12);
}

// --- rays and overlaps --------------------------------------------------------------------------------------------

TEST(PlanarRays, DiscsAndWallsAreMetWhereTheyAre) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(3, 0));
  const InstanceId wall = w.add(model_of(Box{{1, 1, 1}}, true), at(0, 4, math::pi / 4, 0.5));
  std::uint32_t body = 0;
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 100, no_body, &body), 2.8f);
  EXPECT_EQ(body, w.engine.bodies(robot)[0].index);
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {0, 1, 0}, 100, no_body, &body), static_cast<float>(4 - std::sqrt(0.5)));
  EXPECT_EQ(body, w.engine.bodies(wall)[0].index);
  EXPECT_FLOAT_EQ(w.see({0, 4, 0.1}, {1, -1, 0}), 0.5f);  // from inside
  EXPECT_EQ(w.see({0, 0, 0.1}, {-1, 0, 0}, 100, no_body, &body), std::numeric_limits<float>::infinity());
  EXPECT_EQ(body, no_body);
  EXPECT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 2.7), std::numeric_limits<float>::infinity());
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}, 100, no_body, nullptr, 2.9), 3.2f);  // starts inside
  EXPECT_EQ(w.see({3, 0, 0.1}, {1, 0, 0}, 100, w.engine.bodies(robot)[0].index),
            std::numeric_limits<float>::infinity());
  EXPECT_EQ(w.see({0, 0, 0.1}, {0, 0, 1}), std::numeric_limits<float>::infinity());
}

TEST(PlanarRays, HeightsCount) {
  World w;
  w.add(robot_model(), at(3, 0));  // 0 .. 0.4
  EXPECT_EQ(w.see({0, 0, 0.41}, {1, 0, 0}), std::numeric_limits<float>::infinity());
  EXPECT_EQ(w.see({0, 0, -0.01}, {1, 0, 0}), std::numeric_limits<float>::infinity());
  EXPECT_NEAR(w.see({0, 0, 1.6}, {2.8, 0, -1.4}), std::sqrt(2.8 * 2.8 + 1.4 * 1.4),
              1e-6);                                                 // the side, aslant
  EXPECT_NEAR(w.see({0, 0, 1.4}, {3, 0, -1}), std::sqrt(10), 1e-6);  // the lid
  EXPECT_EQ(w.see({0, 0, 2.4}, {2.5, 0, -0.5}), std::numeric_limits<float>::infinity());
}

TEST(PlanarRays, WhatIsGoneIsNotSeen) {
  World w;
  const InstanceId robot = w.add(robot_model(), at(3, 0)),
                   wall = w.add(model_of(Box{{1, 1, 1}}, true), at(5, 0));
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), 2.8f);
  w.engine.remove(robot);
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), 4.5f);
  w.engine.set_pose(wall, at(7, 0));
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), 6.5f);
  w.engine.remove(wall);
  EXPECT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), std::numeric_limits<float>::infinity());
  const InstanceId again = w.add(robot_model(), at(2, 0));
  EXPECT_NE(again, robot);
  EXPECT_FLOAT_EQ(w.see({0, 0, 0.1}, {1, 0, 0}), 1.8f);
}

struct Crowd {
  World w;
  std::vector<Vec3> robots;  ///< x, y, and the radius in z
  std::vector<std::pair<Pose, Vec3>> boxes;
  Crowd(std::uint64_t sample, double size_m, bool floor) {
    Stream r(4, 0, Purpose::experiment, sample);
    for (int i = 0; i < 60; ++i) {
      const double x = r.uniform(-size_m, size_m), y = r.uniform(-size_m, size_m),
                   radius = r.uniform(0.03, 0.5);
      robots.push_back({x, y, radius});
      w.add(model_of(Cylinder{radius, 1}, false, 1, {{0, 0, 0.5}, {}}), at(x, y));
    }
    for (int i = 0; i < 8; ++i) {
      const double x = r.uniform(-size_m, size_m), y = r.uniform(-size_m, size_m), yaw = r.uniform(-3, 3);
      const double length = i < 2 ? size_m : r.uniform(0.05, 1), width = r.uniform(0.05, 1);
      boxes.push_back({at(x, y, yaw, 0.5), {length, width, 1}});
      w.add(model_of(Box{{length, width, 1}}, true), boxes.back().first);
    }
    if (floor) w.add(model_of(Box{{8 * size_m, 8 * size_m, 0.2}}, true), at(0, 0, 0, -0.1));
  }
};

TEST(PlanarRays, AgreeWithBruteForceOnRandomScenes) {
  int hits = 0, rays = 0;
  for (std::uint64_t sample = 0; sample < 40; ++sample) {
    Crowd crowd(sample, sample % 2 ? 4 : 300, sample % 3 == 0);
    Stream r(5, 0, Purpose::experiment, sample);
    for (int k = 0; k < 200; ++k) {
      const Vec3 target = crowd.robots[static_cast<std::size_t>(k % 60)];
      const double x = target.x + r.uniform(-3, 3), y = target.y + r.uniform(-3, 3);
      const double min_m = k % 4 ? 0 : r.uniform(0, 1), max_m = r.uniform(1, 20);
      Vec3 d{r.normal(), r.normal(), 0};
      if (k % 10 == 0) d.x = 0;
      if (k % 10 == 1) d.y = 0;
      d = normalised(d);
      double best = std::numeric_limits<double>::infinity();
      const auto see = [&](double t) {
        if (t >= min_m && t <= max_m) best = std::min(best, t);
      };
      for (const Vec3 c : crowd.robots) {
        const double b = (x - c.x) * d.x + (y - c.y) * d.y;
        const double disc = b * b - ((x - c.x) * (x - c.x) + (y - c.y) * (y - c.y) - c.z * c.z);
        if (disc < 0) continue;
        see(-b - std::sqrt(disc));
        see(-b + std::sqrt(disc));
      }
      for (const auto& [X, size] : crowd.boxes) {
        const Vec3 o = inverse(X) * Vec3{x, y, 0.5}, e = rotate_inverse(X.q, d);
        for (std::size_t i = 0; i < 2; ++i)
          for (const double side : {-0.5, 0.5}) {
            const double t = (side * size[i] - o[i]) / e[i];
            if (std::abs(o[1 - i] + t * e[1 - i]) <= size[1 - i] / 2) see(t);
          }
      }
      const float seen = crowd.w.see({x, y, 0.5}, d, max_m, no_body, nullptr, min_m);
      // The reference loses digits to b^2 - c near the silhouette; 1e-6 covers the float too.
      if (best < 1e9) ASSERT_NEAR(seen, best, 2e-6) << sample << " " << k;
      else ASSERT_EQ(seen, std::numeric_limits<float>::infinity()) << sample << " " << k;
      hits += best < 1e9;
      ++rays;
    }
  }
  EXPECT_GT(hits, rays / 4);
  EXPECT_LT(hits, rays * 3 / 4);
}

TEST(PlanarRays, TheSensorsPoseTurnsTheFan) {
  World w;
  w.add(robot_model(), at(3, 0));
  const Vec3 directions[] = {{1, 0, 0}, {0, -1, 0}};
  float distance[2];
  const RayJob job{at(0, 0, math::pi / 2, 0.1), directions, 0, 10, no_body, distance, {}};
  w.engine.rays()->cast({&job, 1});
  EXPECT_EQ(distance[0], std::numeric_limits<float>::infinity());
  EXPECT_FLOAT_EQ(distance[1], 2.8f);
}

TEST(PlanarOverlaps, NameBodiesOnceAndInOrder) {
  World w;
  const InstanceId wall = w.add(model_of(Box{{5, 0.2, 1}}, true), at(0, 1, 0, 0.5));
  const InstanceId a = w.add(robot_model(), at(0, 0)), b = w.add(robot_model(), at(1, 0));
  const OverlapQuery queries[] = {{{0, 0, 0.2}, 0.7},  {{0, 0.3, 0.2}, 0.59}, {{0, 0.3, 0.2}, 0.61},
                                  {{0, 0, 0.5}, 0.09}, {{0, 0, 0.5}, 0.11},   {{0.6, 0, 0}, 3}};
  std::vector<std::uint32_t> out, ends;
  w.engine.overlaps(queries, out, ends);
  const std::uint32_t W = w.engine.bodies(wall)[0].index, A = w.engine.bodies(a)[0].index,
                      B = w.engine.bodies(b)[0].index;
  EXPECT_EQ(ends, (std::vector<std::uint32_t>{1, 2, 4, 4, 5, 8}));
  EXPECT_EQ(out, (std::vector<std::uint32_t>{A, A, W, A, A, W, A, B}));
}

// --- the border ---------------------------------------------------------------------------------------------------

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

}  // namespace
}  // namespace sandlot::planar
