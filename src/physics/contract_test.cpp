/// Contract of the engines (physics/engine.h), tested on each of them. A part that an engine does not claim
/// in its capabilities() is left out by a condition, so that no test is ever skipped.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/math.h"
#include "model/rollers.h"
#include "physics/test_world.h"

namespace sandlot {
namespace {

using namespace test;

class EngineContract : public ::testing::TestWithParam<const EngineKind*> {
 protected:
  const EngineKind& kind = *GetParam();
};

constexpr double h = 0.01;

TEST_P(EngineContract, CapabilitiesNameTheKind) {
  World world(kind);
  EXPECT_STREQ(world.engine->capabilities().name, kind.name);
  EXPECT_EQ(world.engine->rays() != nullptr, world.engine->capabilities().rays);
}

TEST_P(EngineContract, UnknownSettingIsRefusedByName) {
  const auto made = kind.create(settings({{"no_such_setting", "1"}}), {0, 0, -9.81});
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().text().find("no_such_setting"), std::string::npos);
}

TEST_P(EngineContract, ABodyStandsWhereItWasPut) {
  World world(kind);
  world.add(ground());
  const InstanceId id = world.add(disc_robot("a", {1, 2, 0}, 0.5));
  ASSERT_EQ(world.engine->bodies(id).size(), 1u);
  EXPECT_TRUE(world.engine->joints(id).empty());
  // Quaternion and position pass through a product or two: some ulp of values near 1.
  EXPECT_NEAR(world.state(id).X_WB.p.x, 1, 1e-14);
  EXPECT_NEAR(world.state(id).X_WB.p.y, 2, 1e-14);
  EXPECT_NEAR(world.state(id).X_WB.p.z, 0.05, 1e-14);
  EXPECT_NEAR(yaw_of(world.state(id).X_WB.q), 0.5, 1e-14);
  EXPECT_EQ(world.state(id).V_WB.linear, Vec3{});
  EXPECT_NEAR(world.engine->pose(id).p.x, 1, 1e-14);
}

TEST_P(EngineContract, LinksAndModelFramesKeepTheirPlaces) {
  model::Model m;
  m.links.push_back(link_of("base", Cylinder{0.1, 0.1}, 2, {{0, 0, 0.05}, {}}));
  m.links.push_back(link_of("mast", Cylinder{0.02, 0.1}, 0.1, {{0.05, 0, 0.15}, quat_from_rpy(0, 0, 0.3)}));
  model::Joint joint;
  joint.name = "fix";
  joint.parent = 0;
  joint.child = 1;
  m.joints.push_back(joint);
  World world(kind);
  world.add(ground());
  const InstanceId id = world.add(instance_of("a", m, {{1, 2, 0}, quat_from_rpy(0, 0, math::pi / 2)}, true));
  ASSERT_EQ(world.engine->bodies(id).size(), 2u);
  ASSERT_EQ(world.engine->joints(id).size(), 1u);
  const Pose mast = world.state(id, 1).X_WB;
  EXPECT_NEAR(mast.p.x, 1, 1e-14);
  EXPECT_NEAR(mast.p.y, 2.05, 1e-14);
  EXPECT_NEAR(mast.p.z, 0.15, 1e-14);
  EXPECT_NEAR(yaw_of(mast.q), math::pi / 2 + 0.3, 1e-14);
  EXPECT_NEAR(world.engine->pose(id).p.z, 0, 1e-14);
  EXPECT_NEAR(yaw_of(world.engine->pose(id).q), math::pi / 2, 1e-14);
}

TEST_P(EngineContract, AnIndexIsUsedAgainAnIdNever) {
  World world(kind);
  const InstanceId a = world.add(disc_robot("a", {0, 0, 0}));
  const InstanceId b = world.add(disc_robot("b", {1, 0, 0}));
  const BodyId body_a = world.engine->bodies(a)[0];
  world.engine->remove(a);
  const InstanceId c = world.add(disc_robot("c", {2, 0, 0}));
  EXPECT_EQ(c.index, a.index);
  EXPECT_FALSE(c == a);
  const BodyId body_c = world.engine->bodies(c)[0];
  EXPECT_EQ(body_c.index, body_a.index);
  EXPECT_FALSE(body_c == body_a);
  EXPECT_NEAR(world.state(b).X_WB.p.x, 1, 1e-14);
  EXPECT_NEAR(world.state(c).X_WB.p.x, 2, 1e-14);
  EXPECT_DEATH(world.engine->remove(a), "internal error");
}

TEST_P(EngineContract, IdealDriveReachesItsVelocityAtTheGivenAcceleration) {
  World world(kind);
  ASSERT_TRUE(world.engine->capabilities().ideal_drives);
  world.add(ground());
  const InstanceId id = world.add(disc_robot("a", {0, 0, 0}, 0.3));
  world.run(50);  // the 3D robot settles
  world.drive(id, {.vx_mps = 0.5, .max_accel_mps2 = 1.0});
  for (int i = 1; i <= 60; ++i) {
    world.run(1);
    // v = a t until v reaches the target; rounding of some 1e-16 per sub-step, and in 3D the tilt of a body
    // that rests on the ground (1e-6 rad at most, which enters squared).
    const Velocity v = world.state(id).V_WB;
    EXPECT_NEAR(v.linear.x * std::sqrt(1 - 0.29552020666133955 * 0.29552020666133955) +
                    v.linear.y * 0.29552020666133955,
                std::min(0.5, 1.0 * h * i), 1e-9);
  }
}

TEST_P(EngineContract, IdealDriveStaysOnItsArc) {
  World world(kind);
  world.add(ground());
  const InstanceId id = world.add(disc_robot("a", {0, 0, 0}));
  world.run(50);
  const Vec3 start = world.state(id).X_WB.p;
  const double yaw = yaw_of(world.state(id).X_WB.q);
  world.drive(id, {.vx_mps = 0.5, .wz_radps = 1.0});
  world.run(100);
  // One second at 1 rad/s: an arc of radius 0.5 by 1 rad. A 3D body that has settled is tilted by some 1e-5
  // rad, so the ground pushes it along its own plane with g * 1e-5, of which each sub-step corrects all but g
  // * 1e-5 * h: 1e-6 m/s.
  const auto [s, c] = math::sincos(1.0);
  const Vec3 p = world.state(id).X_WB.p - start;
  const auto [sy, cy] = math::sincos(yaw);
  EXPECT_NEAR(cy * p.x + sy * p.y, 0.5 * s, 1e-5);
  EXPECT_NEAR(-sy * p.x + cy * p.y, 0.5 * (1 - c), 1e-5);
  EXPECT_NEAR(yaw_of(world.state(id).X_WB.q), yaw + 1.0, 1e-6);
}

TEST_P(EngineContract, AWallStopsAnIdealDrive) {
  World world(kind);
  world.add(ground());
  world.add(static_of("wall", Box{{0.2, 2, 0.5}}, {{1, 0, 0.25}, {}}));
  const InstanceId id = world.add(disc_robot("a", {0, 0, 0}));
  world.drive(id, {.vx_mps = 0.5, .max_accel_mps2 = 2.0});
  world.run(400);
  // The wall's face is at 0.9, the robot's radius 0.1. A compliant contact yields by less than a millimetre.
  EXPECT_NEAR(world.state(id).X_WB.p.x, 0.8, 1e-3);
  EXPECT_NEAR(world.state(id).V_WB.linear.x, 0, 1e-3);
  // It never passed the wall, and leaves it on command.
  world.drive(id, {.vx_mps = -0.5, .max_accel_mps2 = 2.0});
  world.run(100);
  EXPECT_LT(world.state(id).X_WB.p.x, 0.5);
}

TEST_P(EngineContract, RobotsStopEachOther) {
  World world(kind);
  world.add(ground());
  const InstanceId a = world.add(disc_robot("a", {-0.5, 0, 0}));
  const InstanceId b = world.add(disc_robot("b", {0.5, 0, 0}, math::pi));
  world.drive(a, {.vx_mps = 0.5, .max_accel_mps2 = 2.0});
  world.drive(b, {.vx_mps = 0.5, .max_accel_mps2 = 2.0});
  world.run(300);
  // Equal pushes: they stand face to face in the middle, two radii apart.
  const double gap = world.state(b).X_WB.p.x - world.state(a).X_WB.p.x;
  EXPECT_NEAR(gap, 0.2, 2e-3);
  EXPECT_NEAR(world.state(a).X_WB.p.x + world.state(b).X_WB.p.x, 0, 2e-3);
}

TEST_P(EngineContract, AReleasedDriveNoLongerPushes) {
  World world(kind, {}, {0, 0, 0});
  const InstanceId id = world.add(disc_robot("a", {0, 0, 0}));
  world.drive(id, {.vx_mps = 0.5});
  world.run(10);
  world.drive(id, {.active = false});
  world.run(10);
  const double v = world.state(id).V_WB.linear.x;
  EXPECT_TRUE(std::abs(v) <= 0.5 + 1e-12) << v;
}

TEST_P(EngineContract, SetPosePutsAtRest) {
  World world(kind);
  world.add(ground());
  const InstanceId id = world.add(disc_robot("a", {0, 0, 0}));
  world.drive(id, {.vx_mps = 0.5});
  world.run(20);
  world.engine->set_pose(id, {{3, -1, 0.05}, quat_from_rpy(0, 0, 1)});
  EXPECT_NEAR(world.state(id).X_WB.p.x, 3, 1e-12);
  EXPECT_NEAR(world.state(id).X_WB.p.y, -1, 1e-12);
  EXPECT_NEAR(yaw_of(world.state(id).X_WB.q), 1, 1e-12);
  EXPECT_EQ(world.state(id).V_WB.linear, Vec3{});
  EXPECT_NEAR(world.engine->pose(id).p.y, -1, 1e-12);
}

/// Robots that run into each other and into a wall, from which one vanishes while another appears.
struct Crowd : World {
  explicit Crowd(const EngineKind& k) : World(k) {
    add(ground());
    add(static_of("wall", Box{{0.2, 4, 0.5}}, {{1, 0, 0.25}, {}}));
    for (int i = 0; i < 5; ++i) {
      const double x = 0.25 * i - 0.6, y = 0.3 * (i % 2);
      add(disc_robot("r" + std::to_string(i), {x, y, 0}, 0.7 * i));
      drive(ids.back(),
            {.vx_mps = 0.4, .wz_radps = 0.3 * (i - 2), .max_accel_mps2 = 2, .max_angular_accel_radps2 = 5});
    }
  }
};

TEST_P(EngineContract, ARestoredRunContinuesWithTheSameBits) {
  Crowd world(kind);
  world.run(60);
  world.engine->remove(world.ids[3]);
  world.ids.erase(world.ids.begin() + 3);
  const model::Instance late = disc_robot("late", {-1.5, 0, 0});
  world.add(late);
  world.drive(world.ids.back(), {.vx_mps = 0.7});
  world.run(60);

  // The same instances in the same order, the removed one never there.
  World copy(kind);
  copy.add(ground());
  copy.add(static_of("wall", Box{{0.2, 4, 0.5}}, {{1, 0, 0.25}, {}}));
  for (int i = 0; i < 5; ++i)
    if (i != 1) copy.add(disc_robot("r" + std::to_string(i), {0.25 * i - 0.6, 0.3 * (i % 2), 0}, 0.7 * i));
  copy.add(late);
  ASSERT_EQ(copy.ids.size(), world.ids.size());
  for (std::size_t i = 0; i < world.ids.size(); ++i)
    ASSERT_TRUE(copy.load(copy.ids[i], world.bytes(world.ids[i])));
  copy.steps = world.steps;
  for (int step = 0; step < 100; ++step) {
    for (std::size_t i = 0; i < world.ids.size(); ++i)
      ASSERT_EQ(world.bytes(world.ids[i]), copy.bytes(copy.ids[i])) << "instance " << i << ", step " << step;
    world.run(1);
    copy.run(1);
  }
}

TEST_P(EngineContract, RepeatedRunsHaveTheSameBitsAndInputsMatter) {
  const auto final_bytes = [&](double speed) {
    Crowd world(kind);
    world.drive(world.ids[2], {.vx_mps = speed});
    world.run(100);
    std::vector<std::byte> all;
    for (const InstanceId id : world.ids) {
      const auto bytes = world.bytes(id);
      all.insert(all.end(), bytes.begin(), bytes.end());
    }
    return all;
  };
  EXPECT_EQ(final_bytes(0.4), final_bytes(0.4));
  EXPECT_NE(final_bytes(0.4), final_bytes(0.41));
}

TEST_P(EngineContract, AFarInstanceChangesNobodysBits) {
  Crowd alone(kind), company(kind);
  const InstanceId far = company.add(disc_robot("far", {100, 100, 0}));
  company.drive(far, {.vx_mps = 1, .wz_radps = 1});
  for (int step = 0; step < 120; ++step) {
    alone.run(1);
    company.run(1);
    if (step == 60) company.engine->remove(far);
    for (std::size_t i = 0; i < alone.ids.size(); ++i)
      ASSERT_EQ(alone.bytes(alone.ids[i]), company.bytes(company.ids[i]))
          << "instance " << i << ", step " << step;
  }
}

TEST_P(EngineContract, DamagedBytesAreRefused) {
  Crowd world(kind);
  world.run(10);
  const auto bytes = world.bytes(world.ids[3]);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(world.load(world.ids[3], {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}))
        << size;
  EXPECT_TRUE(world.load(world.ids[3], bytes));
}

/// A cart with an arm that a motor turns, on rails, with a push to come: one of each number that is State.
struct Cart : World {
  InstanceId cart;
  explicit Cart(const EngineKind& kind) : World(kind) {
    model::Model m;
    m.links.push_back(link_of("base", Cylinder{0.2, 0.2}, 4, {{0, 0, 0.1}, {}}));
    m.links.push_back(link_of("arm", Cylinder{0.05, 0.1}, 0.5, {{0, 0, 0.3}, {}}));
    model::Joint joint;
    joint.name = "turn";
    joint.type = model::JointType::continuous;
    joint.parent = 0;
    joint.child = 1;
    m.joints.push_back(joint);
    add(ground());
    cart = add(instance_of("cart", std::move(m), {}, true));
    add(static_of("wall", Box{{0.2, 2, 1}}, {{0.35, 0, 0.5}, {}}));
  }
};

TEST_P(EngineContract, ForgedNumbersAreRefusedOrEndTheRunWithAName) {
  Cart original(kind);
  original.drive(original.cart, {.vx_mps = 0.5, .max_accel_mps2 = 2, .max_angular_accel_radps2 = 2});
  original.target(
      original.cart, 0,
      {.mode = JointTarget::Mode::effort, .effort = 0.01, .damping = 0.1, .inertia = 1e-4, .friction = 1e-3});
  original.run(20);
  original.push(original.cart, {1, 2, 0}, {0, 0, 0.1});
  const auto is_sound = [](const Cart& world) {
    double sum = 0;
    for (const BodyId body : world.engine->bodies(world.cart)) {
      const BodyState& s = world.engine->states()[body.index];
      sum += norm(s.X_WB.p) + norm(s.X_WB.q) + norm(s.V_WB.linear) + norm(s.V_WB.angular);
    }
    for (const JointId joint : world.engine->joints(world.cart))
      sum += world.engine->joint_states()[joint.index].position;
    return std::isfinite(sum);
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const std::size_t which : {1u, 2u}) {
    const InstanceId id = original.ids[which];
    const auto bytes = original.bytes(id);
    int refused = 0;
    for (std::size_t at = 0; at + 8 <= bytes.size(); ++at)
      for (const double value : {std::nan(""), infinity, -infinity, 1e300, -1e300, 1e-310, 0.0}) {
        auto forged = bytes;
        std::memcpy(&forged[at], &value, 8);
        Cart world(kind);
        if (!world.load(id, forged)) {
          ++refused;
          continue;
        }
        ASSERT_TRUE(is_sound(world)) << which << ", byte " << at << ", " << value;
        world.run(2);
        const Status sound = world.engine->check_finite();
        ASSERT_TRUE(is_sound(world)) << which << ", byte " << at << ", " << value;
        // "ODE": an assertion of the library, which the engine has to keep such numbers from.
        ASSERT_TRUE(sound || sound.error().what.find("ODE") == std::string::npos)
            << which << ", byte " << at << ", " << value << ": " << sound.error().what;
      }
    EXPECT_GT(refused, 100);
  }
}

TEST_P(EngineContract, ContactsComeInTheOrderOfCreation) {
  World world(kind);
  world.add(ground());
  const InstanceId wall = world.add(static_of("wall", Box{{0.2, 4, 0.5}}, {{0, 0, 0.25}, {}}));
  // Made in an order that is neither that of their places nor its reverse; each pushes against the wall, from
  // x > 0 or from x < 0.
  std::vector<InstanceId> robots;
  const std::vector<std::pair<double, double>> places{
      {0.3, 1.0}, {-0.3, -1.0}, {0.3, 0.0}, {-0.3, 0.5}, {0.3, -0.5}};
  for (const auto& [x, y] : places) {
    robots.push_back(world.add(disc_robot("r", {x, y, 0}, x > 0 ? math::pi : 0)));
    world.drive(robots.back(), {.vx_mps = 0.5, .max_accel_mps2 = 3});
  }
  world.run(200);
  std::vector<BodyId> met;
  for (const Contact& contact : world.engine->contacts()) {
    if (!(contact.a == world.engine->bodies(wall)[0])) continue;
    if (met.empty() || !(met.back() == contact.b)) met.push_back(contact.b);
    // From the wall (a, made first) towards the robot.
    const double side = contact.point_W.x > 0 ? 1 : -1;
    EXPECT_NEAR(contact.normal_W.x, side, 1e-3);
    EXPECT_NEAR(contact.point_W.x, 0.1 * side, 2e-3);
    EXPECT_LT(std::abs(contact.depth_m), 2e-3);
  }
  ASSERT_EQ(met.size(), robots.size());
  for (std::size_t i = 0; i < robots.size(); ++i) EXPECT_EQ(met[i], world.engine->bodies(robots[i])[0]) << i;
}

TEST_P(EngineContract, OverlapsFindWhatIsInTheBall) {
  World world(kind);
  const InstanceId wall = world.add(static_of("wall", Box{{0.2, 4, 0.5}}, {{1, 0, 0.25}, {}}));
  const InstanceId robot = world.add(disc_robot("a", {0, 0, 0}));
  const std::uint32_t wall_index = world.engine->bodies(wall)[0].index,
                      robot_index = world.engine->bodies(robot)[0].index;
  // Distances: wall face at x = 0.9, robot's side at x = 0.1.
  const OverlapQuery queries[] = {{{0.5, 0, 0.05}, 0.39},
                                  {{0.5, 0, 0.05}, 0.41},
                                  {{0.2, 0, 0.05}, 0.11},
                                  {{0.2, 0, 0.05}, 0.09},
                                  {{0.85, 0, 0.05}, 0.06}};
  std::vector<std::uint32_t> out, ends;
  world.engine->overlaps(queries, out, ends);
  EXPECT_EQ(ends, (std::vector<std::uint32_t>{0, 2, 3, 3, 4}));
  EXPECT_EQ(out, (std::vector<std::uint32_t>{wall_index, robot_index, robot_index, wall_index}));
}

TEST_P(EngineContract, AStateThatIsNoNumberIsReported) {
  World world(kind, {}, {0, 0, 0});
  world.add(disc_robot("good", {0, 0, 0}));
  const InstanceId bad = world.add(disc_robot("bad", {5, 0, 0}));
  world.run(1);
  EXPECT_TRUE(world.engine->check_finite());
  world.drive(bad, {.vx_mps = std::numeric_limits<double>::quiet_NaN()});
  world.run(3);
  const Status status = world.engine->check_finite();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().text().find("bad"), std::string::npos);
}

TEST_P(EngineContract, JointsTurnAtTheirTarget) {
  World world(kind, {}, {0, 0, 0});
  model::Model m;
  m.links.push_back(link_of("base", Cylinder{0.1, 0.1}, 2));
  m.links.push_back(
      link_of("wheel", Cylinder{0.03, 0.02}, 0.1, {{0, 0.12, 0}, quat_from_rpy(-math::pi / 2, 0, 0)}));
  model::Joint joint;
  joint.name = "axle";
  joint.type = model::JointType::continuous;
  joint.parent = 0;
  joint.child = 1;
  m.joints.push_back(joint);
  const InstanceId id = world.add(instance_of("a", m, {}, true));
  EXPECT_EQ(world.engine->joints(id).size(), 1u);
  world.target(id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 10, .max_effort = 1});
  world.run(100);
  // An engine with joints reaches the target within a sub-step (the wheel's inertia is 4.5e-5) and then turns
  // 10 rad in one second; one without must not pretend.
  if (world.engine->capabilities().joints) {
    EXPECT_NEAR(world.joint(id).velocity, 10, 1e-3);
    EXPECT_NEAR(world.joint(id).position, 10, 0.2);
  }
  EXPECT_TRUE(std::isfinite(world.joint(id).velocity));
}

TEST_P(EngineContract, CountersCount) {
  Crowd world(kind);
  world.run(100);
  const EngineCounters counters = world.engine->counters();
  EXPECT_EQ(counters.contacts, world.engine->contacts().size());
  EXPECT_GE(counters.awake_bodies, 5u);
}

/// A cylinder on a path.
model::Instance guided(const std::string& name, Vec3 p) {
  model::Instance instance = static_of(name, Cylinder{0.2, 0.4}, {p, {}});
  instance.motion = model::Motion{.keys = {{0, {p, {}}}}};
  return instance;
}

TEST_P(EngineContract, AGuidedInstanceIsWhereItWasTold) {
  World world(kind);
  world.add(ground());
  const InstanceId id = world.add(guided("walker", {1, 2, 0.2}));
  const Pose to{{1.1, 2, 0.3}, quat_from_rpy(0, 0, 0.5)};
  world.engine->guide(id, to, {{10, 0, 10}, {0, 0, 50}});
  world.run(1);
  EXPECT_NEAR(norm(world.state(id).X_WB.p - to.p), 0, 1e-12);
  EXPECT_NEAR(yaw_of(world.state(id).X_WB.q), 0.5, 1e-12);
  EXPECT_NEAR(yaw_of(world.engine->pose(id).q), 0.5, 1e-12);
  EXPECT_NEAR(world.state(id).V_WB.linear.x, 10, 1e-12);
  EXPECT_NEAR(world.state(id).V_WB.angular.z, 50, 1e-12);
  world.run(1);  // without a command it stands
  EXPECT_NEAR(norm(world.state(id).X_WB.p - to.p), 0, 1e-12);
  EXPECT_EQ(world.state(id).V_WB.linear, Vec3{});
}

TEST_P(EngineContract, AGuidedInstancePushesAndIsNotPushed) {
  World world(kind);
  model::Surface smooth;
  smooth.mu = smooth.mu2 = 0.3;
  world.add(ground(smooth));
  const InstanceId walker = world.add(guided("walker", {0, 0, 0.2}));
  const InstanceId crate = world.add(body_of("crate", Cylinder{0.2, 0.4}, 50, {{0.6, 0, 0.2}, {}}, smooth));
  world.run(100);  // a crate that is not touched falls asleep
  std::vector<std::byte> half_walker, half_crate;
  const auto walk = [&](World& w, int from, int until) {
    for (int i = from; i < until; ++i) {
      w.engine->guide(w.ids[1], {{0.005 * (i + 1), 0, 0.2}, {}}, {{0.5, 0, 0}, {}});
      w.run(1);
    }
  };
  walk(world, 0, 100);
  half_walker = world.bytes(walker), half_crate = world.bytes(crate);
  World other(kind);
  other.add(ground(smooth));
  other.add(guided("walker", {0, 0, 0.2}));
  other.add(body_of("crate", Cylinder{0.2, 0.4}, 50, {{0.6, 0, 0.2}, {}}, smooth));
  other.run(100);
  ASSERT_TRUE(other.load(walker, half_walker));
  ASSERT_TRUE(other.load(crate, half_crate));
  walk(world, 100, 200);
  walk(other, 100, 200);
  EXPECT_EQ(world.bytes(crate), other.bytes(crate));
  EXPECT_EQ(world.bytes(walker), other.bytes(walker));
  // It walked 1 m and holds the crate at the sum of the radii; restitution is none.
  EXPECT_NEAR(world.state(walker).X_WB.p.x, 1, 1e-9);
  EXPECT_NEAR(world.state(crate).X_WB.p.x, 1.4, 0.01);
  EXPECT_NEAR(world.state(crate).X_WB.p.y, 0, 0.01);
  bool touch = false;
  for (const Contact& c : world.engine->contacts())
    touch = touch || (c.a == world.engine->bodies(walker)[0] && c.b == world.engine->bodies(crate)[0]);
  EXPECT_TRUE(touch);
}

/// A crate of 1 kg that stands on the ground, 0.1 wide.
model::Instance crate(const std::string& name, Vec3 p) {
  return body_of(name, Box{{0.1, 0.1, 0.1}}, 1, {{p.x, p.y, 0.05}, {}});
}

TEST_P(EngineContract, AZoneIsSlipperyWhereItIs) {
  World world(kind);
  model::SurfaceZone ice{.name = "ice", .centre_W = {0, 5, 0}, .radius_m = 2};
  ice.surface.mu = ice.surface.mu2 = 0;
  world.engine->set_zones(std::span(&ice, 1));
  world.add(ground());
  const InstanceId on_ice = world.add(crate("on_ice", {0, 5, 0})), beside = world.add(crate("beside", {}));
  for (int i = 0; i < 50; ++i) {
    world.push(on_ice, {1, 0, 0});
    world.push(beside, {1, 0, 0});
    world.run(1);
  }
  // 1 N on 1 kg for half a second; friction of 9.81 N holds the other, but for the creep of ODE's contacts.
  EXPECT_NEAR(world.state(on_ice).V_WB.linear.x, 0.5, 1e-6);
  EXPECT_NEAR(world.state(beside).V_WB.linear.x, 0, 1e-3);
}

TEST_P(EngineContract, ARuleMayLetSomethingPass) {
  World world(kind);
  world.engine->set_contact_rule(
      [](const ContactSide& a, const ContactSide& b, Vec3, Vec3, PairSurface& pair) {
        if (a.instance == "ghost" || b.instance == "ghost") pair.touches = a.instance == "ground";
      });
  world.add(ground());
  world.add(static_of("ghost", Box{{0.2, 1, 0.5}}, {{1, 0, 0.25}, {}}));
  world.add(static_of("wall", Box{{0.2, 1, 0.5}}, {{2, 0, 0.25}, {}}));
  const InstanceId id = world.add(disc_robot("a", {0, 0, 0}));
  world.drive(id, {.vx_mps = 0.5, .max_accel_mps2 = 2.0});
  world.run(500);
  EXPECT_NEAR(world.state(id).X_WB.p.x, 1.8, 1e-3);  // through the ghost, up to the face of the wall
}

/// A disc with one wheel at its side that touches nothing.
model::Instance with_wheel(const std::string& name) {
  model::Model m;
  m.links.push_back(link_of("base", Cylinder{0.1, 0.1}, 2, {{0, 0, 0.05}, {}}));
  m.links.push_back(
      link_of("wheel", Cylinder{0.03, 0.02}, 0.1, {{0, 0.12, 0.05}, quat_from_rpy(-math::pi / 2, 0, 0)}));
  model::Joint joint;
  joint.name = "axle";
  joint.type = model::JointType::continuous;
  joint.parent = 0;
  joint.child = 1;
  m.joints.push_back(joint);
  return instance_of(name, m, {}, true);
}

TEST_P(EngineContract, WheelsOfAnIdealDriveRollOrAreLeftAlone) {
  World world(kind, {}, {0, 0, 0});
  const InstanceId id = world.add(with_wheel("a"));
  const auto before = world.bytes(id);
  world.drive(id, {.vx_mps = 0.6});
  const RollTarget roll{world.engine->joints(id)[0], world.engine->bodies(id)[0], 1 / 0.03, 0, 0.12 / 0.03};
  const auto driven = world.bytes(id);
  world.engine->set_rolls(std::span(&roll, 1));
  // An engine that does not claim it must not do half of it.
  EXPECT_EQ(world.bytes(id) != driven, world.engine->capabilities().rolls);
  EXPECT_NE(driven, before);
  world.run(50);
  if (world.engine->capabilities().rolls) {
    // Reaching 0.6 m/s at 1e9 m/s^2 costs 0.6^2 / 2e9 m of way.
    EXPECT_NEAR(world.joint(id).position, 0.5 * 0.6 / 0.03, 1e-8);
    EXPECT_NEAR(world.joint(id).velocity, 0.6 / 0.03, 1e-9);
  } else {
    EXPECT_NEAR(world.joint(id).velocity, 0, 1e-9);
  }
}

TEST_P(EngineContract, WheelsRunOnTheirRollersOrAreLeftAlone) {
  World world(kind);
  world.add(ground());
  model::Instance instance = with_wheel("a");
  model::Model m = *instance.model;
  m.links[1].X_ML.p.z = 0.03;  // on the ground
  m.links[1].collisions.clear();
  m.joints[0].rollers = model::RollerWheel{
      .radius_m = 0.03, .count = 8, .angle_rad = math::pi / 2, .roller_length_m = 0.02};
  const Status made = model::add_rollers(m);
  ASSERT_TRUE(made) << made.error().text();
  const InstanceId id = world.add(instance_of("a", m, {}, true));
  const auto before = world.bytes(id);
  const WheelTarget rollers{world.engine->joints(id)[0], true};
  world.engine->set_wheels(std::span(&rollers, 1));
  EXPECT_EQ(world.bytes(id) != before, world.engine->capabilities().rollers);
  const WheelTarget one_body{world.engine->joints(id)[0], false};
  world.engine->set_wheels(std::span(&one_body, 1));
  EXPECT_EQ(world.bytes(id), before);
}

std::string engine_name(const ::testing::TestParamInfo<const EngineKind*>& param) {
  return param.param->name;
}

INSTANTIATE_TEST_SUITE_P(Engines, EngineContract,
                         ::testing::ValuesIn(engine_kinds().begin(), engine_kinds().end()), engine_name);

}  // namespace
}  // namespace sandlot
