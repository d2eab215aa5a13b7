#include "base/check.h"
#include "base/math.h"
#include "bench/bare_ode.h"
#include "bench/bench.h"
#include "physics/engine.h"
#include "physics/engines.h"

namespace sandlot::bench {
namespace {

model::Link link_of(const char* name, const Shape& shape, double mass_kg, const Pose& X_ML) {
  model::Link link;
  link.name = name;
  link.X_ML = X_ML;
  link.inertial.mass_kg = mass_kg;
  link.inertial.moments = inertia_kg_m2(shape, mass_kg);
  link.collisions.push_back({name, {}, shape, {}, {}});
  return link;
}

std::shared_ptr<model::Model> model_of(model::Link link, bool is_static = false) {
  auto model = std::make_shared<model::Model>();
  model->name = link.name;
  model->is_static = is_static;
  model->links.push_back(std::move(link));
  return model;
}

/// Two driven wheels and a smooth ball in front.
std::shared_ptr<model::Model> robot_model() {
  auto model = model_of(link_of("base", Box{{0.3, 0.2, 0.1}}, 5, {{0, 0, 0.09}, {}}));
  model::Collision caster{"caster", {{0.12, 0, -0.06}, {}}, Sphere{0.03}, {}, {}};
  caster.surface.mu = caster.surface.mu2 = 0;
  model->links[0].collisions.push_back(caster);
  for (const double side : {1.0, -1.0}) {
    const auto child = static_cast<std::uint32_t>(model->links.size());
    const Pose X_ML{{-0.05, side * 0.12, 0.05}, quat_from_axis_angle({1, 0, 0}, -math::pi / 2)};
    model->links.push_back(link_of(side > 0 ? "left" : "right", Cylinder{0.05, 0.03}, 0.3, X_ML));
    model->joints.push_back({.name = model->links.back().name,
                             .type = model::JointType::continuous,
                             .parent = 0,
                             .child = child});
  }
  return model;
}

/// The instances of one load, and how bare ODE is to solve it.
struct Load {
  const char* name;
  std::vector<model::Instance> instances;
  bool quick;
  double wheel_radps;

  void add(std::shared_ptr<const model::Model> model, const Pose& X_WM) {
    model::Instance& instance = instances.emplace_back();
    instance.name = instance.original_name = model->name + std::to_string(instances.size());
    instance.model = std::move(model);
    instance.X_WM = X_WM;
  }
};

Load robots() {
  Load load{"P3 rigid, 50 two-wheeled robots", {}, false, 4};
  load.add(model_of(link_of("ground", Plane{{0, 0, 1}}, 1, {}), true), {});
  const auto robot = robot_model();
  for (int i = 0; i < 50; ++i)
    load.add(robot, {{1.0 * (i % 10), 1.0 * (i / 10), 0}, quat_from_axis_angle({0, 0, 1}, 0.3 * i)});
  return load;
}

/// Four layers of boxes, each a little off the one below: one island.
Load pile() {
  Load load{"P3 rigid, pile of 40 boxes", {}, true, 0};
  load.add(model_of(link_of("ground", Plane{{0, 0, 1}}, 1, {}), true), {});
  const auto box = model_of(link_of("box", Box{{0.2, 0.2, 0.2}}, 1, {}));
  for (int layer = 0; layer < 4; ++layer)
    for (int i = 0; i < 10; ++i)
      load.add(box, {{0.21 * (i % 5) + 0.05 * layer, 0.21 * (i / 5) + 0.04 * layer, 0.1 + 0.2 * layer}, {}});
  return load;
}

constexpr double h_s = 0.005;
constexpr int steps = 100;

struct Ours {
  std::unique_ptr<Engine> engine;
  explicit Ours(const Load& load) {
    // Without sleep, else the engine would win by doing nothing.
    Node config = Node::map();
    config.set("sleeping", Node::scalar("false"));
    config.set("solver", Node::scalar(load.quick ? "quick" : "direct"));
    engine = find_engine("rigid").value()->create(config, {0, 0, -9.81}).value();
    std::vector<JointTarget> targets;
    for (const model::Instance& instance : load.instances) {
      const InstanceId id = engine->add(instance).value();
      for (const JointId joint : engine->joints(id))
        targets.push_back({joint, JointTarget::Mode::velocity, load.wheel_radps, 1, 0});
    }
    engine->set_targets(targets);
  }
  void run() {
    for (int i = 0; i < steps; ++i) engine->step(h_s, static_cast<std::uint64_t>(i));
  }
};

Row overhead(const Load& load) {
  Ours ours(load);
  BareOde bare{rigid::Spec{}};
  for (const model::Instance& instance : load.instances) bare.add(instance);
  bare.drive(load.wheel_radps, 1);
  const Timing t = compare(
      9, [&] { ours.run(); },
      [&] {
        for (int i = 0; i < steps; ++i) bare.step(h_s, load.quick);
      });
  SL_CHECK(ours.engine->check_finite());
  return row(load.name, "us/step", t.ours_s * 1e6 / steps, t.reference_s * 1e6 / steps, 1.15);
}

}  // namespace

std::vector<Row> physics() { return {overhead(robots()), overhead(pile())}; }

}  // namespace sandlot::bench
