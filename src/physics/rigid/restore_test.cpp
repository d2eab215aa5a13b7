/// A restored engine continues with the same bits: piles, joints, drives, sleepers, with both solvers and
/// with bodies that came and went.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <thread>

#include "base/math.h"
#include "base/random.h"
#include "physics/rigid/library.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid {
namespace {

using namespace test;

/// A world whose instances are remembered, so that another one like it can be built.
struct Recorded : World {
  std::vector<model::Instance> instances;
  Settings config;
  explicit Recorded(const Settings& settings_used)
      : World(rigid::engine, settings(settings_used)), config(settings_used) {}
  void put(const model::Instance& instance) {
    instances.push_back(instance);
    add(instance);
  }
  void drop(std::size_t i) {
    engine->remove(ids[i]);
    ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(i));
    instances.erase(instances.begin() + static_cast<std::ptrdiff_t>(i));
  }
  /// A new engine with the same instances, in the state of this one.
  std::unique_ptr<Recorded> copy() const {
    auto other = std::make_unique<Recorded>(config);
    for (const model::Instance& instance : instances) other->put(instance);
    for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_TRUE(other->load(other->ids[i], bytes(ids[i]))) << i;
    other->steps = steps;
    return other;
  }
};

/// Runs both side by side and compares all bytes, states and joint states after every sub-step.
void expect_same(Recorded& a, Recorded& b, int n, double h,
                 const std::function<void(Recorded&, int)>& act = {}) {
  for (int step = 0; step < n; ++step) {
    for (std::size_t i = 0; i < a.ids.size(); ++i) {
      ASSERT_EQ(a.bytes(a.ids[i]), b.bytes(b.ids[i])) << a.instances[i].name << ", step " << step;
      for (std::size_t l = 0; l < a.engine->bodies(a.ids[i]).size(); ++l) {
        ASSERT_EQ(a.state(a.ids[i], l).X_WB, b.state(b.ids[i], l).X_WB)
            << a.instances[i].name << ", step " << step;
        ASSERT_EQ(a.state(a.ids[i], l).V_WB.linear, b.state(b.ids[i], l).V_WB.linear);
      }
      for (std::size_t j = 0; j < a.engine->joints(a.ids[i]).size(); ++j) {
        ASSERT_EQ(a.joint(a.ids[i], j).position, b.joint(b.ids[i], j).position);
        ASSERT_EQ(a.joint(a.ids[i], j).velocity, b.joint(b.ids[i], j).velocity);
        ASSERT_EQ(a.joint(a.ids[i], j).effort, b.joint(b.ids[i], j).effort);
      }
    }
    if (act) act(a, step), act(b, step);
    a.run(1, h);
    b.run(1, h);
    ASSERT_EQ(a.engine->contacts().size(), b.engine->contacts().size()) << step;
  }
}

model::Instance box(int i, Vec3 p, double size = 0.2) {
  Stream random(7, static_cast<std::uint64_t>(i), Purpose::placement, 0);
  const double roll = random.uniform(-0.2, 0.2), pitch = random.uniform(-0.2, 0.2),
               yaw = random.uniform(-1, 1);
  return body_of("box" + std::to_string(i), Box{{size, size, 0.8 * size}}, 1,
                 {p, quat_from_rpy(roll, pitch, yaw)});
}

struct Pile : ::testing::TestWithParam<const char*> {};

TEST_P(Pile, FortyBoxesContinueWithTheSameBits) {
  Recorded world(Settings{{"solver", GetParam()}, {"direct_limit", "12"}});
  world.put(ground());
  for (int i = 0; i < 40; ++i) {
    const double x = 0.23 * (i % 4), y = 0.23 * ((i / 4) % 4), z = 0.12 + 0.21 * (i / 16);
    world.put(box(i, {x, y, z}));
  }
  const std::uint64_t draws = library::counts().draws;
  world.run(60);
  world.drop(17);
  world.drop(5);
  world.put(box(50, {0.4, 0.4, 1.2}));
  world.run(25);
  EXPECT_GT(world.engine->counters().contacts, 40u);
  if (GetParam() == std::string("direct")) EXPECT_EQ(world.engine->counters().solver_messages, 0u);
  else EXPECT_GT(library::counts().draws, draws);
  const auto copy = world.copy();
  expect_same(world, *copy, 60, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Solvers, Pile, ::testing::Values("direct", "quick", "auto"));

/// One of each joint, moved in every way.
model::Model machine() {
  model::Model m;
  m.links.push_back(link_of("base", Box{{0.4, 0.4, 0.1}}, 4, {{0, 0, 0.1}, {}}));
  const auto attach = [&](const char* name, model::JointType type, Vec3 at, Vec3 axis) -> model::Joint& {
    m.links.push_back(link_of(name, Sphere{0.05}, 0.3, {at, {}}));
    model::Joint joint;
    joint.name = name;
    joint.type = type;
    joint.parent = 0;
    joint.child = static_cast<std::uint32_t>(m.links.size() - 1);
    joint.axis_J = axis;
    m.joints.push_back(joint);
    return m.joints.back();
  };
  attach("left", model::JointType::continuous, {0, 0.25, 0.05}, {0, 1, 0});
  attach("right", model::JointType::continuous, {0, -0.25, 0.05}, {0, 1, 0});
  model::Joint& arm = attach("arm", model::JointType::revolute, {0.3, 0, 0.3}, {0, 1, 0});
  arm.X_CJ.p = {-0.3, 0, 0};
  arm.lower = -0.5, arm.upper = 0.4, arm.friction = 0.05, arm.damping = 0.02;
  model::Joint& lift = attach("lift", model::JointType::prismatic, {0, 0, 0.4}, {0, 0, 1});
  lift.lower = -0.1, lift.upper = 0.1, lift.spring_stiffness = 50, lift.damping = 1;
  attach("tail", model::JointType::ball, {-0.35, 0, 0.15}, {1, 0, 0}).damping = 0.01;
  m.joints.back().X_CJ.p = {0.15, 0, 0};
  attach("glued", model::JointType::fixed, {0.1, 0.1, 0.2}, {0, 0, 1});
  return m;
}

model::Model pendulum() {
  model::Model m;
  m.links.push_back(link_of("bob", Sphere{0.05}, 1, {{0.4, 0, 1}, {}}));
  model::Joint joint;
  joint.type = model::JointType::revolute;
  joint.parent = model::world_link;
  joint.child = 0;
  joint.X_CJ.p = {-0.4, 0, 0};
  joint.axis_J = {0, 1, 0};
  joint.lower = -4, joint.upper = 4;
  m.joints.push_back(joint);
  return m;
}

void move_machine(World& world, std::size_t i, int step) {
  const InstanceId id = world.ids[i];
  if (step % 40 == 0) {
    world.target(id, 0, {.mode = JointTarget::Mode::velocity, .velocity = 0.1 * step, .max_effort = 0.3});
    world.target(id, 1,
                 {.mode = JointTarget::Mode::velocity, .velocity = 6 - 0.05 * step, .max_effort = 0.3});
    world.target(id, 2, {.mode = JointTarget::Mode::effort, .effort = step % 80 ? 2.0 : -2.0});
    world.target(id, 3,
                 {.mode = JointTarget::Mode::velocity, .velocity = step % 80 ? 0.2 : -0.2, .max_effort = 20});
  }
  world.push(id, {0.2, 0.1 * math::sin(0.1 * step), 0});
}

TEST(RigidRestore, JointsMotorsDrivesAndWorldAnchorsContinue) {
  for (const char* solver : {"direct", "quick", "auto"}) {
    Recorded world(Settings{{"solver", solver}});
    world.put(ground());
    world.put(instance_of("machine", machine(), {{0, 0, 0}, quat_from_rpy(0, 0, 0.4)}, true));
    world.put(instance_of("pendulum", pendulum(), {{3, 1, 0.5}, quat_from_rpy(0.1, 0.2, 0.3)}));
    world.put(instance_of("driven", machine(), {{-2, 0, 0}, {}}, true));
    world.drive(world.ids[3],
                {.vx_mps = 0.3, .wz_radps = 0.5, .max_accel_mps2 = 0.2, .max_angular_accel_radps2 = 0.3});
    world.target(world.ids[3], 0, {.mode = JointTarget::Mode::velocity, .velocity = 20, .max_effort = 1});
    world.engine->set_pose(world.ids[2], {{3, 2, 0.5}, quat_from_rpy(0.1, 0.2, 1.3)});
    for (int step = 0; step < 100; ++step) {
      move_machine(world, 1, step);
      world.run(1);
    }
    EXPECT_TRUE(world.engine->check_finite());
    EXPECT_GT(std::abs(world.joint(world.ids[2]).position), 0.01);
    const auto copy = world.copy();
    expect_same(world, *copy, 150, 0.01, [](Recorded& w, int step) {
      move_machine(w, 1, step + 100);
      if (step == 70) w.drive(w.ids[3], {.active = false});
    });
  }
}

TEST(RigidRestore, SleepersContinueToSleepAndWakeAlike) {
  Recorded world(Settings{});
  world.put(ground());
  for (int tower = 0; tower < 4; ++tower)
    for (int i = 0; i < 3; ++i)
      world.put(body_of("box", Box{{0.2, 0.2, 0.2}}, 1, {{tower * 1.0, 0.01 * i, 0.1 + 0.2 * i}, {}}));
  world.run(150);
  ASSERT_EQ(world.engine->counters().awake_bodies, 0u);
  world.put(body_of("ball", Sphere{0.1}, 2, {{0, 0, 2}, {}}));
  world.run(30);
  auto copy = world.copy();  // asleep, with a ball above
  expect_same(world, *copy, 60, 0.01, [](Recorded& w, int step) {
    if (step == 5) w.drop(4);  // the lowest of the second tower: the others fall
  });
  EXPECT_GT(world.engine->counters().awake_bodies, 0u);
  EXPECT_LT(world.engine->counters().awake_bodies, 12u);
}

TEST(RigidRestore, TheChoiceOfTheSolverIsRememberedWhereItMatters) {
  // A plate on balls has two contact points per ball. With 10 balls there are 20, solved quickly because that
  // is above 16; once quick, an island stays so down to 13. With 8 balls the choice therefore depends on what
  // was before.
  const auto drew = [](Recorded& world) {
    const std::uint64_t before = library::counts().draws;
    world.run(1);
    return library::counts().draws != before;
  };
  const auto furnish = [](Recorded& world, int balls) {
    world.put(ground());
    world.put(body_of("plate", Box{{2, 2, 0.1}}, 1, {{0, 0, 0.2499}, {}}));
    for (int i = 0; i < balls; ++i)  // four corners first, so that the plate does not tip when balls go
      world.put(
          body_of("ball", Sphere{0.1}, 1,
                  {{(i % 2 ? 0.7 : -0.7), (i / 2 % 2 ? 1 : -1) * (0.8 - 0.25 * (i / 4)), 0.09995}, {}}));
  };
  const Settings config{{"direct_limit", "16"}, {"sleeping", "false"}};
  Recorded world(config), fresh(config);
  furnish(world, 10);
  world.run(5);
  EXPECT_EQ(world.engine->contacts().size(), 20u);
  EXPECT_TRUE(drew(world));
  world.drop(11);
  world.drop(10);
  EXPECT_TRUE(drew(world));
  EXPECT_EQ(world.engine->contacts().size(), 16u);
  const auto copy = world.copy();
  expect_same(world, *copy, 20, 0.01);
  EXPECT_TRUE(drew(world));
  world.drop(9);
  world.drop(8);
  EXPECT_FALSE(drew(world));
  EXPECT_EQ(world.engine->contacts().size(), 12u);
  furnish(fresh, 8);
  EXPECT_FALSE(drew(fresh));
}

TEST(RigidRestore, PushesThatWaitForTheNextStepAreSaved) {
  Recorded world(Settings{});
  world.put(body_of("ball", Sphere{0.1}, 2));
  world.push(world.ids[0], {1, 2, 3}, {0.1, 0, 0});
  const auto copy = world.copy();
  expect_same(world, *copy, 3, 0.01);
  EXPECT_NE(world.state(world.ids[0]).V_WB.linear.x, 0);
}

TEST(RigidRestore, TheKeyOfTheSubStepDecidesWhatTheQuickSolverDraws) {
  const auto run = [](std::uint64_t key) {
    Recorded world(Settings{{"solver", "quick"}, {"quick_iterations", "10"}});
    world.put(ground());
    for (int i = 0; i < 8; ++i) world.put(box(i, {0.01 * i, 0, 0.1 + 0.18 * i}));
    world.steps = key;
    world.run(50);
    return world.bytes(world.ids[4]);
  };
  EXPECT_EQ(run(5), run(5));
  EXPECT_NE(run(5), run(6));
}

/// Two piles far apart: each must not notice the other, whichever solver either needs.
TEST(RigidRestore, IslandsAreSolvedAsIfAlone) {
  for (const char* limit : {"0", "12", "1000"}) {
    const Settings config{{"direct_limit", limit}};
    Recorded small(config), both(config);
    for (Recorded* world : {&small, &both}) {
      world->put(ground());
      for (int i = 0; i < 3; ++i) world->put(box(i, {0.01 * i, 0, 0.1 + 0.2 * i}));
    }
    for (int i = 3; i < 15; ++i) both.put(box(i, {20 + 0.21 * (i % 3), 0.21 * (i % 2), 0.1 + 0.1 * i}));
    for (int step = 0; step < 120; ++step) {
      small.run(1);
      both.run(1);
      for (std::size_t i = 0; i < small.ids.size(); ++i)
        ASSERT_EQ(small.bytes(small.ids[i]), both.bytes(both.ids[i])) << limit << " " << step;
    }
  }
}

TEST(RigidRestore, EnginesInSeveralThreadsDoNotMeet) {
  const auto run = [](std::vector<std::byte>& result) {
    Recorded world(Settings{{"direct_limit", "12"}});
    world.put(ground());
    for (int i = 0; i < 12; ++i) world.put(box(i, {0.02 * i, 0, 0.1 + 0.18 * i}));
    world.run(80);
    for (const InstanceId id : world.ids) {
      const auto bytes = world.bytes(id);
      result.insert(result.end(), bytes.begin(), bytes.end());
    }
  };
  std::vector<std::byte> alone, results[3];
  run(alone);
  std::thread threads[3];
  for (int i = 0; i < 3; ++i) threads[i] = std::thread(run, std::ref(results[i]));
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : results) EXPECT_EQ(result, alone);
}

}  // namespace
}  // namespace sandlot::rigid
