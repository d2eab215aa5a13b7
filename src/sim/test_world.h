#pragma once
/// Small worlds for the tests of sim, built without files.
#include <gtest/gtest.h>

#include "base/math.h"
#include "sim/world/simulation.h"

namespace sandlot::test {

inline std::shared_ptr<model::Model> one_shape(const std::string& name, const Shape& shape, double mass_kg,
                                               double restitution = 0) {
  auto made = std::make_shared<model::Model>();
  made->name = name;
  made->is_static = mass_kg == 0;
  model::Link link;
  link.name = "link";
  link.inertial.mass_kg = mass_kg > 0 ? mass_kg : 1;
  link.inertial.moments = mass_kg > 0 ? inertia_kg_m2(shape, mass_kg) : Vec3{1, 1, 1};
  model::Surface surface;
  surface.restitution = restitution;
  link.collisions.push_back({"collision", {}, shape, surface, {}});
  made->links.push_back(std::move(link));
  return made;
}

inline model::Instance placed(const std::string& name, std::shared_ptr<const model::Model> shape, Pose X_WM) {
  model::Instance instance;
  instance.name = instance.original_name = name;
  instance.model = std::move(shape);
  instance.X_WM = X_WM;
  return instance;
}

inline Node map(std::initializer_list<std::pair<const char*, std::string>> entries) {
  Node node = Node::map();
  for (const auto& [key, text] : entries) node.set(key, Node::scalar(text));
  return node;
}

/// Chassis cylinder (radius 0.17 m) on two wheels and two frictionless balls.
inline std::shared_ptr<model::Model> rover_model() {
  auto rover = std::make_shared<model::Model>();
  rover->name = "rover";
  const auto add_link = [&](const char* name, Vec3 at, const Shape& shape, double mass_kg, double mu) {
    model::Link link;
    link.name = name;
    link.X_ML.p = at;
    link.inertial.mass_kg = mass_kg;
    link.inertial.moments = inertia_kg_m2(shape, mass_kg);
    model::Surface surface;
    surface.mu = surface.mu2 = mu;
    link.collisions.push_back({"collision", {}, shape, surface, {}});
    rover->links.push_back(std::move(link));
  };
  add_link("base_link", {0, 0, 0.12}, Cylinder{0.17, 0.12}, 6, 0.3);
  for (const double x : {0.13, -0.13}) {
    model::Surface slick;
    slick.mu = slick.mu2 = 0;
    rover->links.front().collisions.push_back({"caster", {{x, 0, -0.09}, {}}, Sphere{0.03}, slick, {}});
  }
  add_link("left_wheel", {0, 0.15, 0.07}, Sphere{0.07}, 0.5, 1);
  add_link("right_wheel", {0, -0.15, 0.07}, Sphere{0.07}, 0.5, 1);
  for (const std::uint32_t wheel : {1u, 2u}) {
    model::Joint joint;
    joint.name = wheel == 1 ? "left_wheel_joint" : "right_wheel_joint";
    joint.type = model::JointType::continuous;
    joint.parent = 0;
    joint.child = wheel;
    joint.axis_J = {0, 1, 0};
    rover->joints.push_back(joint);
  }
  return rover;
}

inline model::Instance rover(const std::string& name, std::shared_ptr<const model::Model> shape, Vec3 at,
                             double yaw_rad, const char* controller = "wander") {
  model::Instance instance = placed(name, std::move(shape), {at, quat_from_rpy(0, 0, yaw_rad)});
  instance.is_robot = true;
  const auto add = [&](const char* device, const char* kind, Pose X_LS, Node config) {
    model::DeviceDecl decl;
    decl.name = device;
    decl.kind = kind;
    decl.X_LS = X_LS;
    decl.config = std::move(config);
    instance.devices.push_back(std::move(decl));
  };
  add("drive", "diff_drive", {},
      map({{"left_joint", "left_wheel_joint"},
           {"right_joint", "right_wheel_joint"},
           {"wheel_radius", "0.07"},
           {"wheel_separation", "0.3"}}));
  Node laser = map({{"beams", "61"}, {"rate", "10"}, {"min_range", "0.05"}, {"max_range", "6"}});
  Node noise = map({{"white", "0.01"}});
  laser.set("noise", noise);
  add("laser", "laser_scanner", {{0, 0, 0.12}, {}}, laser);
  add("truth", "ground_truth", {}, map({{"rate", "20"}}));
  if (*controller) instance.controllers.push_back({"controller", controller, Node::map(), {}});
  return instance;
}

/// A walled square of 8 m with pillars, boxes to push and `robots` rovers; the same on both engines.
inline model::Setup arena(const std::string& engine, int robots, const char* controller = "wander") {
  model::Setup setup;
  setup.name = "arena";
  setup.engine = engine;
  setup.step = Time::from_s(0.01);
  setup.substeps = 2;
  setup.control_interval = 5;
  setup.seed = 7;
  setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
  const auto wall = one_shape("wall", Box{{8.2, 0.2, 1}}, 0);
  for (int i = 0; i < 4; ++i) {
    const double yaw = 0.5 * math::pi * i;
    setup.instances.push_back(
        placed("wall" + std::to_string(i), wall,
               {{4 * math::cos(yaw - 0.5 * math::pi), 4 * math::sin(yaw - 0.5 * math::pi), 0.5},
                quat_from_rpy(0, 0, yaw)}));
  }
  const auto pillar = one_shape("pillar", Cylinder{0.2, 1}, 0);
  setup.instances.push_back(placed("pillar1", pillar, {{1.5, 1.2, 0.5}, {}}));
  setup.instances.push_back(placed("pillar2", pillar, {{-1.7, -1.4, 0.5}, {}}));
  const auto crate = one_shape("crate", Cylinder{0.2, 0.4}, 2);
  setup.instances.push_back(placed("crate1", crate, {{0.4, -2.1, 0.2}, {}}));
  setup.instances.push_back(placed("crate2", crate, {{-2.2, 1.9, 0.2}, {}}));
  const auto model = rover_model();
  for (int i = 0; i < robots; ++i)
    setup.instances.push_back(rover("rover" + std::to_string(i + 1), model,
                                    {-2.5 + 1.2 * (i % 5), -2.6 + 1.3 * (i / 5), 0.0}, 0.7 * i, controller));
  return setup;
}

inline std::unique_ptr<Simulation> build(model::Setup setup, SimulationOptions options = {}) {
  Diagnostics diagnostics;
  auto made = Simulation::create(std::move(setup), options, diagnostics);
  EXPECT_TRUE(made) << made.error().text();
  for (const Error& warning : diagnostics.warnings) ADD_FAILURE() << warning.text();
  return made ? std::move(*made) : nullptr;
}

inline void advance(Simulation& simulation, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    const Status status = simulation.tick();
    ASSERT_TRUE(status) << status.error().text();
  }
}

/// The hash of each entity; not the run's own, which counts spawns and refusals.
inline std::map<std::string, std::uint64_t> by_path(const Simulation& simulation) {
  std::map<std::string, std::uint64_t> out;
  for (const SubHash& sub : simulation.sub_hashes())
    if (sub.path != "sim") out[sub.path] = sub.hash;
  return out;
}

inline std::unique_ptr<Simulation> again(const Simulation& simulation, SimulationOptions options = {}) {
  Diagnostics diagnostics;
  const auto bytes = simulation.snapshot();
  auto restored = Simulation::restore(bytes, options, diagnostics);
  EXPECT_TRUE(restored) << restored.error().text();
  return restored ? std::move(*restored) : nullptr;
}

inline model::DeviceDecl device(const char* name, const char* kind, Node config = Node::map(),
                                Pose X_LS = {}) {
  model::DeviceDecl decl;
  decl.name = name;
  decl.kind = kind;
  decl.X_LS = X_LS;
  decl.config = std::move(config);
  return decl;
}

/// @throws std::out_of_range  there is none
inline model::DeviceDecl& device_of(model::Setup& setup, const char* robot, const char* name) {
  for (model::Instance& instance : setup.instances)
    for (model::DeviceDecl& decl : instance.devices)
      if (instance.name == robot && decl.name == name) return decl;
  throw std::out_of_range(name);
}

}  // namespace sandlot::test
