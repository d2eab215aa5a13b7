/// Omni and Mecanum wheels, solid and on rollers, against the closed forms of their drives.
#include "physics/rigid/wheels.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "model/rollers.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid {
namespace {

using namespace test;

constexpr double R = 0.05;  ///< of all wheels

struct Mount {
  Vec3 at;           ///< in the base
  Vec3 axis;         ///< of the wheel
  double angle_rad;  ///< of its rollers
};

model::RollerWheel rollers_of(double angle_rad) {
  model::RollerWheel w;
  w.radius_m = R;
  w.angle_rad = angle_rad;
  w.surface.mu = 0.8;
  if (std::abs(angle_rad) < 1.5) w.count = 9, w.roller_length_m = 0.04;
  return w;
}

/// A disc of 10 kg on wheels; the joint of wheel k is number k.
model::Model wheels_model(const std::vector<Mount>& mounts) {
  model::Model m;
  m.links.push_back(link_of("base", Cylinder{0.15, 0.06}, 10));
  for (const Mount& mount : mounts) {
    const Pose X{mount.at, quat_between({0, 0, 1}, mount.axis)};
    model::Link hub = link_of("wheel_" + std::to_string(m.joints.size()), Cylinder{0.03, 0.02}, 0.3, X);
    model::Joint joint;
    joint.name = hub.name;
    joint.type = model::JointType::continuous;
    joint.child = static_cast<std::uint32_t>(m.links.size());
    joint.rollers = rollers_of(mount.angle_rad);
    m.links.push_back(hub);
    m.joints.push_back(joint);
  }
  const Status added = model::add_rollers(m);
  EXPECT_TRUE(added) << added.error().what;
  return m;
}
std::vector<Mount> omni_mounts() {
  std::vector<Mount> mounts;
  for (int k = 0; k < 3; ++k) {
    const math::SinCos a = math::sincos(math::tau * k / 3 + 0.2);
    mounts.push_back({{0.2 * a.cos, 0.2 * a.sin, -0.02}, {a.cos, a.sin, 0}, math::pi / 2});
  }
  return mounts;
}
std::vector<Mount> mecanum_mounts() {
  std::vector<Mount> mounts;
  for (const double x : {0.2, -0.2})
    for (const double y : {0.15, -0.15})
      mounts.push_back({{x, y, -0.02}, {0, 1, 0}, (x * y > 0 ? -1 : 1) * math::pi / 4});
  return mounts;
}

/// What the wheel must turn at so that the base moves at (vx, vy) and turns at wz: the point of the wheel on
/// the ground rests along the axis of the roller there. With a the wheel's axis, d = cos(angle) a +
/// sin(angle) (-z x a):
///   (v + wz z x r) . d = w R (a x z) . d
double wheel_speed(const Mount& m, double vx, double vy, double wz) {
  const Vec3 z{0, 0, 1}, v = Vec3{vx, vy, 0} + cross(wz * z, m.at);
  const Vec3 d = math::cos(m.angle_rad) * m.axis + math::sin(m.angle_rad) * cross(-z, m.axis);
  return dot(v, d) / (R * dot(cross(m.axis, z), d));
}

struct Rig : World {
  std::vector<Mount> mounts;
  InstanceId robot;
  std::shared_ptr<const model::Model> model;
  double h;

  Rig(const std::vector<Mount>& wheels, bool on_rollers, double h_s, const model::Instance& floor = ground(),
      const Pose& X_WM = {{0, 0, R + 0.02}, {}}, Vec3 gravity = {0, 0, -9.81})
      : World(rigid::engine, {}, gravity), mounts(wheels), h(h_s) {
    add(floor);
    const model::Instance instance = instance_of("robot", wheels_model(wheels), X_WM, true);
    model = instance.model;
    robot = add(instance);
    put_on_rollers(on_rollers);
  }
  void put_on_rollers(bool on) {
    for (std::size_t k = 0; k < mounts.size(); ++k) {
      const WheelTarget t{engine->joints(robot)[k], on};
      engine->set_wheels(std::span(&t, 1));
    }
  }
  void command(double vx, double vy, double wz) {
    for (std::size_t k = 0; k < mounts.size(); ++k)
      target(robot, k,
             {.mode = JointTarget::Mode::velocity,
              .velocity = wheel_speed(mounts[k], vx, vy, wz),
              .max_effort = 2});
  }
  void run_s(double seconds) { run(static_cast<int>(std::lround(seconds / h)), h); }
  double yaw() const { return yaw_of(state(robot).X_WB.q); }
};

/// Mean velocity in the base's frame, and mean rate of turning, over a second.
Vec3 measured(Rig& rig, double vx, double vy, double wz) {
  rig.command(vx, vy, wz);
  rig.run_s(0.4);
  double turned = 0, last = rig.yaw();
  Vec3 sum;
  const int n = static_cast<int>(std::lround(1 / rig.h));
  for (int i = 0; i < n; ++i) {
    rig.run(1, rig.h);
    turned += math::wrap_angle(rig.yaw() - last);
    last = rig.yaw();
    sum += rotate_inverse(rig.state(rig.robot).X_WB.q, rig.state(rig.robot).V_WB.linear);
  }
  return {sum.x / n, sum.y / n, turned};
}

struct Case {
  const char* name;
  bool mecanum, rollers;
  double h;
  double side, turning;  ///< relative tolerances
  double less = 0;       ///< further share of the speed that may be missing
};
class Drives : public testing::TestWithParam<Case> {};

/// The tolerances on rollers are those of the project's budget P4. A Mecanum wheel is slower than the closed
/// form but for straight ahead: with its middle p off the lowest point of the wheel a roller's axis is no
/// longer level, and seen from above it lies along (sin a cos p, cos a), so that the speed across is that of
/// the closed form times cos p. Over all p within half a pitch of 9 rollers (20 deg) that is 2 % less in the
/// mean; which wheel gives way decides friction.
TEST_P(Drives, MoveAsTheClosedFormSays) {
  const Case& c = GetParam();
  const auto mounts = c.mecanum ? mecanum_mounts() : omni_mounts();
  for (const Vec3 v : {Vec3{0.5, 0, 0}, Vec3{0, 0.5, 0}, Vec3{0, 0, 2}}) {
    Rig rig(mounts, c.rollers, c.h);
    const Vec3 is = measured(rig, v.x, v.y, v.z);
    const double part = dot(is, v) / dot(v, v), tolerance = v.z != 0 ? c.turning : c.side;
    EXPECT_LT(part, 1 + tolerance);
    EXPECT_GT(part, 1 - tolerance - (v.x != 0 ? 0 : c.less));
    EXPECT_NEAR(norm(is - part * v), 0, 1e-3) << "no drift";
    const BodyState& base = rig.state(rig.robot);
    EXPECT_NEAR(base.X_WB.p.z, R + 0.02, 2e-4) << "it rolls level: gaps between rollers are half a degree";
  }
}
INSTANTIATE_TEST_SUITE_P(All, Drives,
                         testing::Values(Case{"omni_solid", false, false, 1e-3, 1e-4, 1e-4},
                                         Case{"omni_rollers_1ms", false, true, 1e-3, 3e-3, 1e-3},
                                         Case{"omni_rollers_2ms", false, true, 2e-3, 1e-2, 1e-3},
                                         Case{"mecanum_solid", true, false, 1e-3, 1e-4, 1e-3},
                                         Case{"mecanum_rollers", true, true, 1e-3, 3e-3, 3e-3, 0.0202}),
                         [](const auto& each) { return std::string(each.param.name); });

Shape grid_of(double size_m, int n, double slope) {
  HeightGrid grid;
  grid.columns = grid.rows = n;
  grid.size_x_m = grid.size_y_m = size_m;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      grid.height_m.push_back(static_cast<float>(slope * (i * grid.cell_x_m() - 0.5 * size_m)));
  return Heightfield{std::make_shared<const HeightGrid>(grid)};
}

struct Floor {
  const char* name;
  Shape shape;
  Pose X;  ///< at rest level; the test leans it
};
class OnGround : public testing::TestWithParam<int> {};

/// The same robot on four kinds of ground that lean by 0.2 rad about y, so that it climbs. Free rollers point
/// down the slope for one of the wheels only, so the motors hold it; its speed is that on level ground.
TEST_P(OnGround, AnOmniRobotClimbsASlope) {
  const double lean = 0.2;
  const Quat q = quat_from_rpy(0, -lean, 0);
  const Floor floors[] = {
      {"plane", Plane{{0, 0, 1}}, {{}, q}},
      {"box", Box{{6, 6, 1}}, {rotate(q, {0, 0, -0.5}), q}},
      {"mesh",
       Mesh{std::make_shared<const TriangleMesh>(tessellate(Box{{6.1, 6.3, 1}}))},
       {rotate(q, {0, 0, -0.5}), q}},
      {"terrain", grid_of(6, 61, math::tan(lean)), {}},
  };
  const Floor& floor = floors[GetParam()];
  SCOPED_TRACE(floor.name);
  for (const bool on_rollers : {false, true}) {
    const Pose start{rotate(q, {0.013, 0.017, R + 0.02}), q};
    Rig rig(omni_mounts(), on_rollers, 1e-3, static_of("floor", floor.shape, floor.X), start);
    rig.command(0.4, 0, 0);
    rig.run_s(0.2);
    const Pose from = rig.state(rig.robot).X_WB;  // its heading slipped while it started
    rig.run_s(0.5);
    const Vec3 moved = rotate_inverse(from.q, rig.state(rig.robot).X_WB.p - from.p);
    // Friction creeps by 100 CFM per newton of the weight's part along the slope: 1e-6 * 23 N and rollers'
    // slip below.
    EXPECT_NEAR(moved.x, 0.2, 0.004) << on_rollers;
    EXPECT_NEAR(moved.y, 0, 0.004) << on_rollers;
    EXPECT_NEAR(moved.z, 0, 5e-4) << on_rollers;
  }
}
INSTANTIATE_TEST_SUITE_P(Grounds, OnGround, testing::Range(0, 4));

TEST(Wheels, LighterThanTheSpinOfTheirRollersAreRefused) {
  for (const double spin : {1e-6, 1.0}) {  // about their axes alone: no body has such a tensor
    model::Model m = wheels_model({omni_mounts()[0]});
    for (std::size_t l = 2; l < m.links.size(); ++l) m.links[l].inertial.moments = {1e-9, 1e-9, spin};
    auto groups = group_links(m);
    ASSERT_TRUE(groups);
    lock_rollers(m, *groups);
    EXPECT_EQ(static_cast<bool>(check_masses(m, *groups)), spin < 1) << spin;
  }
}

/// A wheel on a robot that hangs upside down under a ceiling that gravity pulls it to: the same as below it.
TEST(Wheels, WorkUpsideDownAsTheyDoUpright) {
  const Quat over = quat_from_rpy(math::pi, 0, 0);
  World up(rigid::engine), down(rigid::engine, {}, {0, 0, 9.81});
  std::vector<Vec3> moved;
  for (World* w : {&up, &down}) {
    const bool flipped = w == &down;
    w->add(static_of("floor", Plane{{0, 0, 1}}, {{}, flipped ? over : Quat{}}));
    const InstanceId robot = w->add(
        instance_of("robot", wheels_model(omni_mounts()),
                    {{0, 0, flipped ? -R - 0.02 : R + 0.02}, flipped ? over : Quat{}}, true));
    for (std::size_t k = 0; k < 3; ++k) {
      const WheelTarget t{w->engine->joints(robot)[k], true};
      w->engine->set_wheels(std::span(&t, 1));
      w->target(robot, k,
                {.mode = JointTarget::Mode::velocity,
                 .velocity = wheel_speed(omni_mounts()[k], 0.3, 0.2, 0),
                 .max_effort = 2});
    }
    w->run(300, 1e-3);
    moved.push_back(w->state(robot).X_WB.p);
  }
  // The same world turned over; while it starts and slips, rounding decides which contact gives way.
  EXPECT_NEAR(moved[0].x, moved[1].x, 5e-4);
  EXPECT_NEAR(moved[0].y, -moved[1].y, 5e-4);
  EXPECT_NEAR(moved[0].z, -moved[1].z, 1e-5);
  EXPECT_GT(moved[0].x, 0.07);
}

/// Against a wall a wheel has rollers awake there too, and they let the robot slide along it.
TEST(Wheels, RollersRollOnAWallAsOnTheGround) {
  // Without gravity, pushed with 20 N against a wall ahead and 5 N along it.
  const std::vector<Mount> mounts{{{0.2, 0.2, 0}, {0, 1, 0}, math::pi / 2},
                                  {{0.2, -0.2, 0}, {0, 1, 0}, math::pi / 2}};
  Rig rig(mounts, true, 1e-3, static_of("wall", Plane{{-1, 0, 0}}, {{0.2 + R, 0, 0}, {}}), {}, {});
  for (int i = 0; i < 200; ++i) {
    rig.push(rig.robot, {20, 5, 0});
    rig.run(1, 1e-3);
  }
  // Rollers that turn without slip weigh half of theirs more (I / r^2), two or so of 10 g; pushed at the base
  // the robot yaws a little, as its wheels lie before it.
  const double mass = 10 + 2 * 0.3 + 20 * 0.01;
  const BodyState& s = rig.state(rig.robot);
  EXPECT_NEAR(s.V_WB.linear.y, 5 * 0.2 / mass, 0.05 * 5 * 0.2 / mass);
  EXPECT_NEAR(s.X_WB.p.x, 0, 2e-4);
}

Vec3 momentum(const Rig& rig, Vec3& angular) {
  const model::Model& m = *rig.model;
  Vec3 p;
  angular = {};
  for (std::size_t l = 0; l < m.links.size(); ++l) {
    const BodyState& s = rig.state(rig.robot, l);
    const double mass = m.links[l].inertial.mass_kg;
    const Vec3 i = m.links[l].inertial.moments, w = rotate_inverse(s.X_WB.q, s.V_WB.angular);
    p += mass * s.V_WB.linear;
    angular += cross(s.X_WB.p, mass * s.V_WB.linear) + rotate(s.X_WB.q, {i.x * w.x, i.y * w.y, i.z * w.z});
  }
  return p;
}

/// Lifted off the ground while its rollers spin, they freeze; put down, they wake. Nothing is lost.
TEST(Wheels, KeepMomentumWhenRollersWakeAndFreeze) {
  Rig rig(omni_mounts(), true, 1e-3);
  rig.command(0.1, 0.5, 0.5);
  rig.run_s(0.3);
  const auto spinning = [&] {
    int n = 0;
    for (std::size_t j = 3; j < 33; ++j) n += std::abs(rig.joint(rig.robot, j).velocity) > 1 ? 1 : 0;
    return n;
  };
  EXPECT_GT(spinning(), 3) << "also those that have left the ground";
  // All at once: off the ground by a millimetre and more, as with a jump.
  Vec3 before_angular, after_angular;
  const Vec3 before = momentum(rig, before_angular);
  const auto bytes = rig.bytes(rig.robot);
  // What is free of any force keeps its momentum: without gravity and floor, in a world of its own.
  World free(rigid::engine, {}, {});
  const InstanceId robot = free.add(instance_of("robot", *rig.model, {{0, 0, R + 0.02}, {}}, true));
  ASSERT_TRUE(free.load(robot, bytes));
  for (std::size_t k = 0; k < 3; ++k) free.target(robot, k, {});
  free.run(2, 1e-3);  // the first sub-step freezes every roller
  Vec3 after;
  {
    const model::Model& m = *rig.model;
    for (std::size_t l = 0; l < m.links.size(); ++l) {
      const BodyState& s = free.state(robot, l);
      const double mass = m.links[l].inertial.mass_kg;
      const Vec3 i = m.links[l].inertial.moments, w = rotate_inverse(s.X_WB.q, s.V_WB.angular);
      after += mass * s.V_WB.linear;
      after_angular += cross(s.X_WB.p, mass * s.V_WB.linear) +
                       rotate(s.X_WB.q, {i.x * w.x, i.y * w.y, i.z * w.z});
    }
  }
  // What rollers and wheels moved against each other by the compliance of their hinges is gone: 1e-5 of the
  // whole.
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(after[k], before[k], 1e-4 * norm(before));
    EXPECT_NEAR(after_angular[k], before_angular[k], 2e-3 * norm(before_angular));
  }
}

TEST(Wheels, KeepPoseAndVelocityWhenTheyBecomeSolidAndBack) {
  Rig rig(omni_mounts(), true, 1e-3);
  rig.command(0.2, 0.4, 0);
  rig.run_s(0.2);
  for (const bool on : {false, true}) {
    const BodyState before = rig.state(rig.robot);
    rig.put_on_rollers(on);
    const BodyState& at_once = rig.state(rig.robot);
    EXPECT_EQ(at_once.X_WB.p, before.X_WB.p);
    EXPECT_EQ(at_once.V_WB.linear, before.V_WB.linear);
    rig.run(1, 1e-3);
    EXPECT_NEAR(norm(rig.state(rig.robot).V_WB.linear - before.V_WB.linear), 0, 0.02);
    rig.run_s(0.1);
    EXPECT_NEAR(rig.state(rig.robot).V_WB.linear.y, 0.4, 0.02);
  }
}

TEST(Wheels, ContinueFromASnapshotWithTheSameBits) {
  Rig rig(omni_mounts(), true, 1e-3);
  rig.command(0.3, 0.4, 1);
  rig.run_s(0.25);
  const auto bytes = rig.bytes(rig.robot);
  const std::uint64_t steps = rig.steps;
  rig.run_s(0.1);
  Rig other(omni_mounts(), false, 1e-3);
  other.run_s(0.05);
  ASSERT_TRUE(other.load(other.robot, bytes));
  other.steps = steps;
  EXPECT_EQ(other.bytes(other.robot), bytes);
  other.run_s(0.1);
  EXPECT_EQ(other.bytes(other.robot), rig.bytes(rig.robot));
  // And of nonsense it says so: a base that is frozen, bytes that end early.
  auto broken = bytes;
  broken.resize(bytes.size() - 3);
  EXPECT_FALSE(other.load(other.robot, broken));
  broken = bytes;
  broken[9] |= std::byte{8};
  EXPECT_FALSE(other.load(other.robot, broken));
}

TEST(Wheels, RollersHaveTheirPlaceInEveryAttitude) {
  // A frozen roller's link is where the wheel carries it: at R - r from the axis, in its plane.
  Rig rig(omni_mounts(), true, 1e-3);
  rig.command(0.3, -0.4, 0.7);
  rig.run_s(0.2);
  for (std::size_t k = 0; k < 3; ++k) {
    const BodyState& hub = rig.state(rig.robot, 1 + k);
    for (std::size_t i = 0; i < 10; ++i) {
      const BodyState& s = rig.state(rig.robot, 4 + 10 * k + i);
      const Vec3 at = rotate_inverse(hub.X_WB.q, s.X_WB.p - hub.X_WB.p);
      EXPECT_NEAR(norm(at), R - 0.01, 2e-5);
      EXPECT_NEAR(at.z, 0, 2e-5);
      const Vec3 rigid = hub.V_WB.linear + cross(hub.V_WB.angular, s.X_WB.p - hub.X_WB.p);
      // Hinges hold velocities where things stood before the sub-step: w^2 r h at 13 rad/s.
      EXPECT_NEAR(norm(s.V_WB.linear - rigid), 0, 7e-3);
    }
  }
}

/// A ball that comes along the wheel's axis meets a roller and makes it spin; along the rim it cannot.
TEST(Wheels, ABallTurnsARoller) {
  Rig rig(omni_mounts(), true, 1e-3);
  rig.run_s(0.1);
  // On top of wheel 0, moving along its axis.
  const BodyState hub = rig.state(rig.robot, 1);
  const Vec3 axis = rotate(hub.X_WB.q, {0, 0, 1});
  const InstanceId ball = rig.add(
      body_of("ball", Sphere{0.02}, 0.05, {hub.X_WB.p + Vec3{0, 0, R + 0.0199} - 0.002 * axis, {}}));
  rig.push(ball, 0.05 / 1e-3 * 0.5 * axis);
  rig.run(5, 1e-3);
  double fastest = 0;
  for (std::size_t i = 0; i < 10; ++i)
    fastest = std::max(fastest, std::abs(rig.joint(rig.robot, 3 + i).velocity));
  EXPECT_GT(fastest, 5) << "0.5 m/s over 0.01 m would be 50 rad/s without slip";
}

TEST(Wheels, DoNotDependOnOtherRobots) {
  Rig alone(omni_mounts(), true, 1e-3), beside(omni_mounts(), true, 1e-3);
  const InstanceId far = beside.add(
      instance_of("far", wheels_model(mecanum_mounts()), {{5, 5, R + 0.02}, {}}, true));
  const WheelTarget t{beside.engine->joints(far)[0], true};
  beside.engine->set_wheels(std::span(&t, 1));
  for (Rig* rig : {&alone, &beside}) {
    rig->command(0.2, 0.3, 0.4);
    rig->run_s(0.15);
  }
  EXPECT_EQ(alone.bytes(alone.robot), beside.bytes(beside.robot));
}

}  // namespace
}  // namespace sandlot::rigid
