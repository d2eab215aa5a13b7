#include "draw/run_drawing.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "sim/load/load.h"

namespace sandlot::draw {
namespace {

std::unique_ptr<Simulation> indoor(const std::string& physics) {
  Diagnostics diagnostics;
  const formats::Override override{"physics", physics};
  LoadOptions options;
  options.overrides = {&override, 1};
  auto setup = load("scenarios/indoor.yaml", options, diagnostics);
  if (!setup) ADD_FAILURE() << setup.error().text();
  auto simulation = Simulation::create(std::move(*setup), {}, diagnostics);
  if (!simulation) ADD_FAILURE() << simulation.error().text();
  return std::move(*simulation);
}

/// A rover alone on the planar engine's floor, without a controller.
std::unique_ptr<Simulation> empty_floor() {
  Diagnostics diagnostics;
  model::Setup setup;
  setup.engine = "planar";
  auto rover = load_instance("models/rover/model.sdf", "rover", {}, diagnostics);
  if (!rover) ADD_FAILURE() << rover.error().text();
  setup.instances.push_back(std::move(*rover));
  auto simulation = Simulation::create(std::move(setup), {}, diagnostics);
  if (!simulation) ADD_FAILURE() << simulation.error().text();
  return std::move(*simulation);
}

Pose pose_of(const Simulation& simulation) {
  return simulation.engine().pose(*simulation.find_instance("rover"));
}

void put(Simulation& simulation, double x, double y) {
  simulation.submit(PoseRequest{"rover", {{x, y, 0}, {}}});
  ASSERT_TRUE(static_cast<bool>(simulation.tick()));
}

TEST(RunDrawing, FollowsTheRobotOnBothEngines) {
  for (const char* physics : {"rigid", "planar"}) {
    const auto simulation = indoor(physics);
    RunDrawing recorder(*simulation);
    simulation->add_observer(&recorder);
    const Vec3 start = pose_of(*simulation).p;
    for (int i = 0; i < 500; ++i) ASSERT_TRUE(static_cast<bool>(simulation->tick()));
    const Plan plan = recorder.plan();
    EXPECT_EQ(plan.title, "indoor");
    ASSERT_EQ(plan.robots.size(), 1u);
    const Plan::Robot& rover = plan.robots[0];
    ASSERT_EQ(rover.path.size(), 1u);
    EXPECT_EQ(rover.path[0].front(), start);
    EXPECT_EQ(rover.path[0].back(), pose_of(*simulation).p);
    double length = 0;
    for (std::size_t i = 1; i < rover.path[0].size(); ++i)
      length += norm(rover.path[0][i] - rover.path[0][i - 1]);
    // 5 s at no more than 0.5 m/s. The kept points cut corners, and never lengthen the way.
    EXPECT_GT(rover.driven_m, 0.5);
    EXPECT_LE(rover.driven_m, 2.5);
    EXPECT_LE(length, rover.driven_m + 1e-9);
    EXPECT_GT(length, 0.9 * rover.driven_m);
    EXPECT_GT(plan.solids.size(), 100u);
  }
}

TEST(RunDrawing, DrawsTheScanFromWhereItWasTaken) {
  const auto simulation = indoor("planar");
  RunDrawing recorder(*simulation);
  simulation->add_observer(&recorder);
  // Scans come at 10 Hz: the one of 3.0 s is the latest until 3.1 s, and the rover has driven on since.
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(static_cast<bool>(simulation->tick()));
  const Pose then = pose_of(*simulation);
  for (int i = 0; i < 9; ++i) ASSERT_TRUE(static_cast<bool>(simulation->tick()));
  ASSERT_GT(norm(pose_of(*simulation).p - then.p), 0.005);
  const Plan plan = recorder.plan();
  ASSERT_EQ(plan.robots[0].scans.size(), 1u);
  const Plan::Scan& scan = plan.robots[0].scans[0];
  EXPECT_NEAR(norm(scan.origin_m - then * Vec3{0, 0, 0.25}), 0, 1e-12);
  ASSERT_EQ(scan.ends_m.size(), 271u);
  ASSERT_TRUE(scan.hit[0]);
  // The first beam looks 135 degrees to the right.
  const Vec3 beam = rotate_inverse(then.q, scan.ends_m[0] - scan.origin_m);
  EXPECT_NEAR(math::atan2(beam.y, beam.x), -0.75 * math::pi, 1e-6);
}

TEST(RunDrawing, ChangesNothing) {
  const auto watched = indoor("planar"), alone = indoor("planar");
  RunDrawing recorder(*watched);
  watched->add_observer(&recorder);
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(static_cast<bool>(watched->tick()));
    ASSERT_TRUE(static_cast<bool>(alone->tick()));
  }
  recorder.draw();
  EXPECT_EQ(watched->state_hash(), alone->state_hash());
}

TEST(RunDrawing, AJumpBeginsANewPart) {
  const auto simulation = empty_floor();
  RunDrawing recorder(*simulation);
  simulation->add_observer(&recorder);
  put(*simulation, 0.3, 0);
  put(*simulation, 5, 5);
  put(*simulation, 5.4, 5);
  const Plan plan = recorder.plan();
  ASSERT_EQ(plan.robots[0].path.size(), 2u);
  EXPECT_NEAR(plan.robots[0].path[1].front().x, 5, 1e-12);
  EXPECT_NEAR(plan.robots[0].driven_m, 0.7, 1e-9);
}

TEST(RunDrawing, LongPathsAreThinnedAndKeepTheirShape) {
  const auto simulation = empty_floor();
  RunDrawing recorder(*simulation);
  simulation->add_observer(&recorder);
  // Round and round a circle of 2 m in steps of 0.1 m, more often than the recorder keeps points.
  constexpr int steps = 25'000;
  for (int i = 0; i < steps; ++i) put(*simulation, 2 * math::cos(0.05 * i) - 2, 2 * math::sin(0.05 * i));
  const Plan plan = recorder.plan();
  std::size_t points = 0;
  for (const auto& part : plan.robots[0].path) {
    points += part.size();
    for (const Vec3& p : part) ASSERT_NEAR(math::hypot(p.x + 2, p.y), 2, 1e-9);
    // Every other of the older points is left.
    for (std::size_t i = 1; i < part.size(); ++i) ASSERT_LE(norm(part[i] - part[i - 1]), 0.2 + 1e-9);
  }
  EXPECT_LE(points, 20'000u);
  EXPECT_GE(points, 5'000u);
  // The chord of 0.05 rad on a radius of 2 m.
  EXPECT_NEAR(plan.robots[0].driven_m, (steps - 1) * 4 * math::sin(0.025), 1e-6);
}

}  // namespace
}  // namespace sandlot::draw
