#pragma once
/// A planar world for tests: models, poses and questions in one line each.
#include <limits>
#include <memory>

#include "physics/planar/planar.h"

namespace sandlot::planar::test {

constexpr double h_s = 0.01;

inline std::shared_ptr<model::Model> model_of(Shape shape, bool is_static = false, double mass_kg = 1,
                                              Pose X_LC = {}) {
  auto model = std::make_shared<model::Model>();
  model->name = "thing";
  model->is_static = is_static;
  model::Link link;
  link.name = "base";
  link.inertial.mass_kg = mass_kg;
  link.collisions.push_back({"shape", X_LC, shape, {}, {}});
  model->links.push_back(link);
  return model;
}
/// A robot of radius 0.2 standing on the ground, 0.4 high.
inline std::shared_ptr<model::Model> robot_model(double mass_kg = 1) {
  return model_of(Cylinder{0.2, 0.4}, false, mass_kg, {{0, 0, 0.2}, {}});
}
inline Pose at(double x, double y, double yaw = 0, double z = 0) {
  return pose_from_rpy({x, y, z}, {0, 0, yaw});
}

struct World {
  PlanarEngine engine{Spec{}};
  InstanceId add(std::shared_ptr<const model::Model> model, Pose X_WM) {
    model::Instance instance;
    instance.name = "thing";
    instance.model = std::move(model);
    instance.X_WM = X_WM;
    return engine.add(instance).value();
  }
  void drive(InstanceId id, double vx, double vy, double wz, double accel = 1e9, double angular = 1e9) {
    const DriveTarget target{engine.bodies(id)[0], true, vx, vy, wz, accel, angular};
    engine.set_drive_targets({&target, 1});
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) engine.step(h_s, 0);
  }
  Vec3 p(InstanceId id) { return engine.pose(id).p; }
  BodyState state(InstanceId id) { return engine.states()[engine.bodies(id)[0].index]; }
  float see(Vec3 from, Vec3 direction, double max_m = 100, std::uint32_t ignore = no_body,
            std::uint32_t* body = nullptr, double min_m = 0) {
    float distance = -1;
    std::uint32_t hit = 0;
    const Vec3 d = normalised(direction);
    const RayJob job{{from, {}}, {&d, 1}, min_m, max_m, ignore, {&distance, 1}, {&hit, 1}};
    engine.rays()->cast({&job, 1});
    if (body) *body = hit;
    return distance;
  }
};

}  // namespace sandlot::planar::test
