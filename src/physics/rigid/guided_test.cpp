/// Bodies that move along a path, which carry and turn whatever stands on them.
#include <gtest/gtest.h>

#include "base/math.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid::guided_test {
namespace {

using namespace test;

constexpr double h = 0.01;

/// A platform, top at z = 0, with a box on it, 0.5 m off its centre. Which of the two was made first decides
/// which is which in the contact.
struct Platform : World, ::testing::TestWithParam<bool> {
  InstanceId platform, box;
  Pose at{{0, 0, -0.1}, {}};
  Platform() : World(rigid::engine) {
    model::Instance floor = static_of("platform", Box{{3, 3, 0.2}}, at);
    floor.motion = model::Motion{.keys = {{0, at}}};
    const model::Instance load = body_of("box", Box{{0.2, 0.2, 0.1}}, 2, {{0.5, 0, 0.05}, {}});
    if (GetParam()) platform = add(floor);
    box = add(load);
    if (!GetParam()) platform = add(floor);
  }
  void move(Vec3 v, double w, int count) {
    for (int i = 0; i < count; ++i) {
      at = {at.p + h * v, quat_from_axis_angle({0, 0, 1}, h * w) * at.q};
      engine->guide(platform, at, {v, {0, 0, w}});
      run(1, h);
    }
  }
  const BodyState& load() const { return state(box); }
};

TEST_P(Platform, CarriesByFriction) {
  move({0, 0, 0}, 0, 50);
  move({0.3, 0, 0}, 0, 100);
  // mu = 1: it is up to speed within 0.3 / 9.81 s and slides back by v^2 / (2 mu g) = 4.6 mm meanwhile.
  EXPECT_NEAR(load().V_WB.linear.x, 0.3, 1e-3);
  EXPECT_NEAR(load().X_WB.p.x, 0.5 + 0.3 - 0.0046, 0.004);
  EXPECT_NEAR(load().X_WB.p.z, 0.05, 1e-3);
  move({0, 0.3, 0}, 0, 100);
  EXPECT_NEAR(load().V_WB.linear.x, 0, 1e-3);
  EXPECT_NEAR(load().V_WB.linear.y, 0.3, 1e-3);
}

TEST_P(Platform, LiftsAndLowers) {
  move({0, 0, 0.4}, 0, 100);
  EXPECT_NEAR(load().V_WB.linear.z, 0.4, 1e-3);
  EXPECT_NEAR(load().X_WB.p.z, 0.45, 2e-3);
  move({0, 0, -0.4}, 0, 100);
  EXPECT_NEAR(load().X_WB.p.z, 0.05, 2e-3);
}

TEST_P(Platform, TurnsWhatStandsOnIt) {
  move({0, 0, 0}, 0.5, 200);
  const double angle = 1.0;
  EXPECT_NEAR(yaw_of(load().X_WB.q), angle, 0.03);
  EXPECT_NEAR(load().X_WB.p.x, 0.5 * math::cos(angle), 0.02);
  EXPECT_NEAR(load().X_WB.p.y, 0.5 * math::sin(angle), 0.02);
}

TEST_P(Platform, NobodySleepsOnASlowOne) {
  move({0, 0, 0}, 0, 200);
  EXPECT_EQ(engine->counters().awake_bodies, 0u);
  move({0.004, 0, 0}, 0, 400);  // slower than what counts as lying still
  EXPECT_NEAR(load().X_WB.p.x, 0.5 + 0.004 * 4, 5e-4);
  move({0, 0, 0}, 0, 200);
  EXPECT_EQ(engine->counters().awake_bodies, 0u);
}

INSTANTIATE_TEST_SUITE_P(Order, Platform, ::testing::Values(false, true),
                         [](const auto& suite) { return suite.param ? "platform_first" : "box_first"; });

}  // namespace
}  // namespace sandlot::rigid::guided_test
