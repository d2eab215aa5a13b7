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
model::Model robot_model(const std::vector<Mount>& mounts) {
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
  EXPECT_TRUE(model::add_rollers(m));
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

/// What the wheel must turn at so that the base moves at (vx, vy) and turns at wz: the point of the wheel on the ground
/// rests along the axis of the roller there. With a the wheel's axis, d = cos(angle) a + sin(angle) (-z x a):
///   (v + wz z x r) . d = w R (a x z) . d
double wheel_speed(const Mount& m, double vx, double vy, double wz) {
  const Vec3 z{0, 0, 1}, v = Vec3{vx, vy, 0} + cross(wz * z, m.at);
  const Vec3 d = math::cos(m.angle_rad) * m.axis + math::sin(m.angle_rad) * cross(-z, m.axis);
  return dot(v, d) / (R * dot(cross(m.axis, z), d));
}

struct Rig : World {
  std::vector<Mount> mounts;
  InstanceId robot;
  double h;

  Rig(const std::vector<Mount>& wheels, bool on_rollers, double h_s, const model::Instance& floor = ground(),
      const Pose& X_WM = {{0, 0, R + 0.02}, {}}, const Node& config = {})
      : World(engine, config), mounts(wheels), h(h_s) {
    add(floor);
    robot = add(instance_of("robot", robot_model(wheels), X_WM, true));
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
  void run_s(double seconds) { run(static_cast<int>(seconds / h + 0.5), h); }
  double yaw() const { return yaw_of(state(robot).X_WB.q); }
};

/// Mean velocity in the base's frame at the start of the measurement, and mean rate of turning.
Vec3 measured(Rig& rig, double vx, double vy, double wz) {
  rig.command(vx, vy, wz);
  rig.run_s(0.4);
  const double seconds = 1.0;
  const Pose from = rig.state(rig.robot).X_WB;
  double turned = 0, last = rig.yaw();
  Vec3 sum;
  const int n = static_cast<int>(seconds / rig.h + 0.5);
  for (int i = 0; i < n; ++i) {
    rig.run(1, rig.h);
    const double yaw = rig.yaw();
    turned += math::wrap_angle(yaw - last);
    last = yaw;
    sum += rotate_inverse(rig.state(rig.robot).X_WB.q, rig.state(rig.robot).V_WB.linear);
  }
  (void)from;
  return {sum.x / n, sum.y / n, turned / seconds};
}

struct Case {
  const char* name;
  bool mecanum, rollers;
  double h;
  double linear, turning;  ///< relative tolerance
};
class Drives : public testing::TestWithParam<Case> {};

TEST_P(Drives, MoveAsTheClosedFormSays) {
  const Case& c = GetParam();
  const auto mounts = c.mecanum ? mecanum_mounts() : omni_mounts();
  {
    Rig rig(mounts, c.rollers, c.h);
    const Vec3 v = measured(rig, 0.5, 0, 0);
    std::printf("%s forward %+.3f%% side %+.4f turn %+.4f\n", c.name, 100 * (v.x / 0.5 - 1), v.y, v.z);
    EXPECT_NEAR(v.x, 0.5, c.linear * 0.5);
  }
  {
    Rig rig(mounts, c.rollers, c.h);
    const Vec3 v = measured(rig, 0, 0.5, 0);
    std::printf("%s sideways %+.3f%% side %+.4f turn %+.4f\n", c.name, 100 * (v.y / 0.5 - 1), v.x, v.z);
    EXPECT_NEAR(v.y, 0.5, c.linear * 0.5);
  }
  {
    Rig rig(mounts, c.rollers, c.h);
    const Vec3 v = measured(rig, 0, 0, 2);
    std::printf("%s spin %+.3f%% %+.4f %+.4f\n", c.name, 100 * (v.z / 2 - 1), v.x, v.y);
    EXPECT_NEAR(v.z, 2, c.turning * 2);
  }
}
INSTANTIATE_TEST_SUITE_P(All, Drives,
                         testing::Values(Case{"omni_solid", false, false, 1e-3, 3e-3, 1e-3},
                                         Case{"omni_rollers_1ms", false, true, 1e-3, 3e-3, 1e-3},
                                         Case{"omni_rollers_2ms", false, true, 2e-3, 1e-2, 1e-3},
                                         Case{"mecanum_solid", true, false, 1e-3, 3e-3, 1e-3},
                                         Case{"mecanum_rollers", true, true, 1e-3, 1e-2, 1e-2}),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace sandlot::rigid
