/// The derivations behind lint's rules, held against the engine: what a rule calls impossible does not work.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/bytes.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "messages/messages.h"
#include "physics/engine.h"
#include "sim/lint/lint.h"
#include "sim/load/load.h"
#include "sim/test_world.h"

namespace sandlot {
namespace {

bool found(const Simulation& simulation, const char* rule) {
  for (const Finding& finding : lint(simulation))
    if (finding.rule == rule) return true;
  return false;
}

struct Servo {
  double error = 0;  ///< after 4 s, relative to the command
  double worst = 0;  ///< on the way
  bool suspected = false;
};

/// The beam of a file with gains set to p and d at a level, commanded once.
Servo lint_run(const std::string& file, const char* level, double p, double d) {
  Diagnostics diagnostics;
  auto setup = load(file, {}, diagnostics);
  if (!setup) {
    ADD_FAILURE() << setup.error().text();
    return {};
  }
  for (model::Instance& instance : setup->instances)
    for (model::DeviceDecl& device : instance.devices) {
      Node gains = Node::map();
      gains.set("p", Node::scalar(std::to_string(p)));
      gains.set("d", Node::scalar(std::to_string(d)));
      device.config.set(level, std::move(gains));
    }
  const auto simulation = test::build(std::move(*setup));
  if (!simulation) return {};
  constexpr double wanted = 1e-3;  // far from the joint's limits
  msg::Float64 command;
  command.data = wanted;
  ByteWriter w;
  write(w, command);
  simulation->submit(
      CommandRequest{"arm/motor", msg::Float64::ros_type, {w.bytes().begin(), w.bytes().end()}});
  Servo servo;
  servo.suspected = found(*simulation, "gains");
  const JointId joint = simulation->engine().joints(*simulation->find_instance("arm"))[1];
  for (int i = 0; i < 400; ++i) {
    if (!simulation->tick()) {  // so wild that the engine gives it up
      servo.worst = std::numeric_limits<double>::infinity();
      break;
    }
    const JointState& state = simulation->engine().joint_states()[joint.index];
    servo.error = std::abs((std::string(level) == "velocity" ? state.velocity : state.position) - wanted) /
                  wanted;
    servo.worst = std::max(servo.worst, servo.error);
  }
  return servo;
}

TEST(LintPhysics, TheBoundOfGainsIsWhereTheLoopBecomesUnstable) {
  // J = 0.334167 kg m^2, h = 10 ms: p = 2 J / h = 66.83. 3 % beyond, the error grows by 6 % per step; within,
  // it shrinks.
  const std::string velocity = "tests/suspicious/gains_velocity_not.sdf";
  const Servo calm = lint_run(velocity, "velocity", 66.83 * 0.97, 0),
              wild = lint_run(velocity, "velocity", 66.83 * 1.03, 0);
  EXPECT_FALSE(calm.suspected);
  EXPECT_LT(calm.error, 1e-3);
  EXPECT_TRUE(wild.suspected);
  EXPECT_GT(wild.worst, 10);
  // With d = 60: p = (4 J - 2 h d) / h^2 = 1367.
  const std::string position = "tests/suspicious/gains_position_not.sdf";
  const Servo still = lint_run(position, "position", 1367 * 0.8, 60),
              shaky = lint_run(position, "position", 1367 * 1.2, 60);
  EXPECT_FALSE(still.suspected);
  EXPECT_LT(still.error, 1e-2);
  EXPECT_TRUE(shaky.suspected);
  EXPECT_GT(shaky.worst, 10);
}

/// How many of 40 boxes of extent w, each started another way off a wall of thickness t, come out behind it.
int number_through(double v_mps, double w_m, double t_m, double h_s) {
  int through = 0;
  for (int i = 0; i < 40; ++i) {
    const auto kind = find_engine("rigid");
    auto engine = (*kind)->create(Node::map(), {});
    if (!engine) return -1;
    const auto add = [&](const char* name, bool is_static, Vec3 size, Vec3 at) {
      auto model = std::make_shared<model::Model>();
      model->name = name;
      model->is_static = is_static;
      model::Link link;
      link.name = "link";
      link.inertial.moments = inertia_kg_m2(Box{size}, 1);
      link.collisions.push_back({"c", {}, Box{size}, {}, {}});
      model->links.push_back(link);
      model::Instance instance;
      instance.name = instance.original_name = name;
      instance.model = model;
      instance.X_WM.p = at;
      return *(*engine)->add(instance);
    };
    add("wall", true, {t_m, 4, 4}, {});
    const InstanceId box = add("box", false, {w_m, w_m, w_m}, {-1.5 - v_mps * h_s * i / 40, 0, 0});
    const Wrench push{(*engine)->bodies(box)[0], {v_mps / h_s, 0, 0}, {}};
    (*engine)->apply({&push, 1});
    for (int k = 0; k < 60; ++k) (*engine)->step(h_s, static_cast<std::uint64_t>(k));
    through += (*engine)->pose(box).p.x > 0 ? 1 : 0;
  }
  return through;
}

TEST(LintPhysics, BodiesTunnelOnceAStepIsLongerThanHalfOfWallAndBody) {
  constexpr double w = 0.3, t = 0.1, h = 0.01, bound = 0.5 * (w + t) / h;  // 20 m/s
  EXPECT_EQ(number_through(0.95 * bound, w, t, h), 0);
  // Uniform phases: the share (v h - (t + w) / 2) / (v h) of them is first seen past the middle: 1 - 1/1.5 =
  // 1/3 of 40.
  EXPECT_NEAR(number_through(1.5 * bound, w, t, h), 40.0 / 3, 1.5);
}

model::Setup on_terrain(double z_m) {
  auto grid = std::make_shared<HeightGrid>();
  grid->columns = grid->rows = 3, grid->size_x_m = grid->size_y_m = 20;
  grid->height_m = {1, 1, 1, 1, 1, 1, 1, 1, 1};
  model::Setup setup;
  setup.name = "w";
  const auto add = [&](const char* name, Shape shape, bool is_static, Vec3 p) {
    auto model = std::make_shared<model::Model>();
    model->name = name;
    model->is_static = is_static;
    model::Link link;
    link.name = "link";
    link.inertial.moments = {1e-2, 1e-2, 1e-2};
    link.collisions.push_back({"c", {}, shape, {}, {}});
    model->links.push_back(link);
    model::Instance instance;
    instance.name = instance.original_name = name;
    instance.model = model;
    instance.X_WM.p = p;
    setup.instances.push_back(instance);
  };
  add("hill", Heightfield{grid}, true, {5, 0, 0});
  add("thing", Box{{0.2, 0.2, 0.2}}, false, {0, 0, z_m});
  return setup;
}

TEST(LintPhysics, ThingsBelowTheTerrainAreFound) {
  Diagnostics diagnostics;
  auto below = Simulation::create(on_terrain(0.4), {}, diagnostics);
  ASSERT_TRUE(static_cast<bool>(below)) << below.error().text();
  const std::vector<Finding> findings = lint(**below);
  ASSERT_EQ(findings.size(), 1u);
  // Its top is at 0.5, the ground at 1; it must come up by that and its own height.
  EXPECT_EQ(findings[0].rule, "below_ground");
  EXPECT_EQ(findings[0].text.what,
            "'thing' starts below the terrain 'hill', its top 0.5 m under the surface");
  EXPECT_EQ(findings[0].text.fix, "raise it by 0.7 m or more");
  EXPECT_TRUE(lint(*test::build(on_terrain(1.1))).empty());
}

}  // namespace
}  // namespace sandlot
