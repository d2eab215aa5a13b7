#pragma once
/// Models and a world for the tests of physics engines.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "geometry/shape.h"
#include "physics/engine.h"
#include "physics/engines.h"

namespace sandlot::test {

inline model::Link link_of(const std::string& name, const Shape& shape, double mass_kg, Pose X_ML = {},
                           model::Surface surface = {}) {
  model::Link link;
  link.name = name;
  link.X_ML = X_ML;
  link.inertial.mass_kg = mass_kg;
  link.inertial.moments = inertia_kg_m2(shape, mass_kg);
  model::Collision collision;
  collision.name = name;
  collision.shape = shape;
  collision.surface = surface;
  link.collisions.push_back(collision);
  return link;
}

inline model::Instance instance_of(const std::string& name, model::Model m, const Pose& X_WM = {},
                                   bool robot = false) {
  model::Instance instance;
  m.name = name;
  instance.name = instance.original_name = name;
  instance.model = std::make_shared<const model::Model>(std::move(m));
  instance.X_WM = X_WM;
  instance.is_robot = robot;
  return instance;
}

/// One link, one shape.
inline model::Instance body_of(const std::string& name, const Shape& shape, double mass_kg,
                               const Pose& X_WM = {}, const model::Surface& surface = {},
                               bool robot = false) {
  model::Model m;
  m.links.push_back(link_of("body", shape, mass_kg, {}, surface));
  return instance_of(name, std::move(m), X_WM, robot);
}

inline model::Instance static_of(const std::string& name, const Shape& shape, const Pose& X_WM = {},
                                 const model::Surface& surface = {}) {
  model::Instance instance = body_of(name, shape, 1, X_WM, surface);
  model::Model m = *instance.model;
  m.is_static = true;
  instance.model = std::make_shared<const model::Model>(std::move(m));
  return instance;
}

inline model::Instance ground(const model::Surface& surface = {}) {
  return static_of("ground", Plane{{0, 0, 1}}, {}, surface);
}

/// A disc-shaped robot that stands on the ground.
inline model::Instance disc_robot(const std::string& name, Vec3 p, double yaw = 0) {
  return body_of(name, Cylinder{0.1, 0.1}, 2, {{p.x, p.y, p.z + 0.05}, quat_from_rpy(0, 0, yaw)}, {}, true);
}

using Settings = std::vector<std::pair<std::string, std::string>>;

inline Node settings(const Settings& entries) {
  Node node = Node::map();
  for (const auto& [key, value] : entries) node.set(key, Node::scalar(value));
  return node;
}

/// An engine with the ids of what was added to it.
struct World {
  std::unique_ptr<Engine> engine;
  std::vector<InstanceId> ids;
  std::uint64_t steps = 0;

  explicit World(const EngineKind& kind, const Node& config = {}, Vec3 gravity = {0, 0, -9.81}) {
    auto made = kind.create(config, gravity);
    engine = std::move(made.value());
  }
  InstanceId add(const model::Instance& instance) {
    auto id = engine->add(instance);
    ids.push_back(id.value());
    return ids.back();
  }
  void run(int n, double h = 0.01) {
    for (int i = 0; i < n; ++i) engine->step(h, 1000 + steps++);
  }
  const BodyState& state(InstanceId id, std::size_t link = 0) const {
    return engine->states()[engine->bodies(id)[link].index];
  }
  const JointState& joint(InstanceId id, std::size_t joint = 0) const {
    return engine->joint_states()[engine->joints(id)[joint].index];
  }
  void drive(InstanceId id, DriveTarget target) {
    target.base = engine->bodies(id)[0];
    engine->set_drive_targets(std::span(&target, 1));
  }
  void target(InstanceId id, std::size_t joint, JointTarget t) {
    t.joint = engine->joints(id)[joint];
    engine->set_targets(std::span(&t, 1));
  }
  void push(InstanceId id, Vec3 force, Vec3 torque = {}) {
    const Wrench wrench{engine->bodies(id)[0], force, torque};
    engine->apply(std::span(&wrench, 1));
  }
  std::vector<std::byte> bytes(InstanceId id) const {
    ByteWriter w;
    engine->save(id, w);
    return {w.bytes().begin(), w.bytes().end()};
  }
  bool load(InstanceId id, const std::vector<std::byte>& bytes) const {
    ByteReader r{bytes};
    return engine->load(id, r) && r.remaining() == 0;
  }
};

}  // namespace sandlot::test
