/// P4: a robot on three omni wheels of ten rollers each, against bare ODE with all its 33 bodies.
///
/// The reference has the same bodies, hinges and motors, the barrels' exact contact with the ground, friction
/// along the slip, and dWorldStep; it is spared the search for pairs.
#include <ode/ode.h>

#include "base/check.h"
#include "base/math.h"
#include "bench/bench.h"
#include "geometry/barrel.h"
#include "model/rollers.h"
#include "physics/engine.h"

namespace sandlot::bench {
namespace {

constexpr int steps = 500;
constexpr double h_s = 0.001, radius_m = 0.05, height_m = 0.07, effort_Nm = 2;

model::Link link_of(const char* name, const Shape& shape, double mass_kg, const Pose& X_ML) {
  model::Link link;
  link.name = name;
  link.X_ML = X_ML;
  link.inertial.mass_kg = mass_kg;
  link.inertial.moments = inertia_kg_m2(shape, mass_kg);
  link.collisions.push_back({"c", {}, shape, {}, {}});
  return link;
}

Vec3 axis_of(int wheel) {
  const math::SinCos a = math::sincos(math::tau * wheel / 3 + 0.2);
  return {a.cos, a.sin, 0};
}
/// Sideways at 0.5 m/s: (v along a x z) / R.
double speed_radps(int wheel) { return dot(Vec3{0, 0.5, 0}, cross(axis_of(wheel), {0, 0, 1})) / radius_m; }

std::shared_ptr<model::Model> robot_model() {
  auto robot = std::make_shared<model::Model>();
  robot->name = "robot";
  robot->links.push_back(link_of("base", Cylinder{0.15, 0.06}, 10, {}));
  for (int wheel = 0; wheel < 3; ++wheel) {
    const Vec3 axis = axis_of(wheel);
    const std::string name = "wheel" + std::to_string(wheel);
    robot->links.push_back(
        link_of(name.c_str(), Cylinder{0.03, 0.02}, 0.3,
                {0.2 * axis - Vec3{0, 0, height_m - radius_m}, quat_between({0, 0, 1}, axis)}));
    model::Joint joint;
    joint.name = name;
    joint.type = model::JointType::continuous;
    joint.child = static_cast<std::uint32_t>(wheel + 1);
    joint.rollers.emplace();
    robot->joints.push_back(joint);
  }
  SL_CHECK(model::add_rollers(*robot));
  return robot;
}

struct Ours {
  std::unique_ptr<Engine> engine;
  InstanceId robot;
  std::uint64_t tick = 0;

  explicit Ours(std::shared_ptr<model::Model> model) {
    auto made = (*find_engine("rigid"))->create(Node::map(), {0, 0, -9.81});
    SL_CHECK(made);
    engine = std::move(*made);
    auto ground = std::make_shared<model::Model>();
    ground->name = "ground";
    ground->is_static = true;
    ground->links.push_back(link_of("ground", Plane{{0, 0, 1}}, 1, {}));
    model::Instance instance;
    instance.name = instance.original_name = "ground";
    instance.model = ground;
    SL_CHECK(engine->add(instance));
    instance.name = instance.original_name = "robot";
    instance.model = std::move(model);
    instance.X_WM.p.z = height_m;
    instance.is_robot = true;
    auto id = engine->add(instance);
    SL_CHECK(id);
    robot = *id;
    for (int wheel = 0; wheel < 3; ++wheel) {
      const JointId joint = engine->joints(robot)[static_cast<std::size_t>(wheel)];
      const WheelTarget on_rollers{joint, true};
      engine->set_wheels(std::span(&on_rollers, 1));
      const JointTarget target{joint, JointTarget::Mode::velocity, speed_radps(wheel), effort_Nm, 0};
      engine->set_targets(std::span(&target, 1));
    }
  }
  void run() {
    for (int i = 0; i < steps; ++i) engine->step(h_s, tick++);
  }
  Vec3 velocity() const { return engine->states()[engine->bodies(robot)[0].index].V_WB.linear; }
};

struct Bare {
  const model::Model& model;
  dWorldID world = dWorldCreate();
  dThreadingImplementationID threading = dThreadingAllocateSelfThreadedImplementation();
  dJointGroupID contacts = dJointGroupCreate(0);
  std::vector<dBodyID> bodies;

  explicit Bare(const model::Model& robot) : model(robot) {
    dWorldSetStepThreadingImplementation(world, dThreadingImplementationGetFunctions(threading), threading);
    dWorldSetGravity(world, 0, 0, -9.81);
    dWorldSetERP(world, 0.2);
    dWorldSetCFM(world, 1e-6);
    dWorldSetContactMaxCorrectingVel(world, 1);
    for (const model::Link& link : model.links) {
      const dBodyID body = dBodyCreate(world);
      dMass mass;
      const Vec3 i = link.inertial.moments, p = link.X_ML.p;
      const Quat r = link.X_ML.q;
      dMassSetParameters(&mass, link.inertial.mass_kg, 0, 0, 0, i.x, i.y, i.z, 0, 0, 0);
      dBodySetMass(body, &mass);
      dBodySetPosition(body, p.x, p.y, p.z + height_m);
      const dQuaternion q = {r.w, r.x, r.y, r.z};
      dBodySetQuaternion(body, q);
      bodies.push_back(body);
    }
    for (std::size_t j = 0; j < model.joints.size(); ++j) {
      const model::Joint& joint = model.joints[j];
      const model::Link& child = model.links[joint.child];
      const Vec3 p = child.X_ML.p, axis = rotate(child.X_ML.q, joint.axis_J);
      const dJointID hinge = dJointCreateHinge(world, nullptr);
      dJointAttach(hinge, bodies[joint.child], bodies[joint.parent]);
      dJointSetHingeAnchor(hinge, p.x, p.y, p.z + height_m);
      dJointSetHingeAxis(hinge, -axis.x, -axis.y, -axis.z);
      if (j >= 3) continue;
      dJointSetHingeParam(hinge, dParamFMax, effort_Nm);
      dJointSetHingeParam(hinge, dParamVel, -speed_radps(static_cast<int>(j)));
    }
  }
  ~Bare() {
    dJointGroupDestroy(contacts);
    dWorldDestroy(world);
    dThreadingFreeImplementation(threading);
  }
  Bare(const Bare&) = delete;
  Bare& operator=(const Bare&) = delete;

  void touch(std::size_t link) {
    const Barrel& barrel = std::get<Barrel>(model.links[link].collisions[0].shape);
    const dReal *p = dBodyGetPosition(bodies[link]), *r = dBodyGetQuaternion(bodies[link]);
    const Pose X{{p[0], p[1], p[2]}, {r[0], r[1], r[2], r[3]}};
    const Vec3 low = X * farthest(barrel, rotate_inverse(X.q, {0, 0, -1}));
    if (low.z > 0) return;
    dContact contact{};
    contact.surface.mode = dContactFDir1 | dContactApprox1;
    contact.surface.mu = 1;
    dVector3 v{};
    dBodyGetPointVel(bodies[link], low.x, low.y, low.z, v);
    const Vec3 slip = normalised(Vec3{v[0], v[1], 0}, {1, 0, 0});
    contact.fdir1[0] = slip.x, contact.fdir1[1] = slip.y;
    contact.geom.pos[0] = low.x, contact.geom.pos[1] = low.y, contact.geom.pos[2] = low.z;
    contact.geom.normal[2] = 1;
    contact.geom.depth = -low.z;
    dJointAttach(dJointCreateContact(world, contacts, &contact), bodies[link], nullptr);
  }
  void run() {
    for (int i = 0; i < steps; ++i) {
      for (std::size_t link = 4; link < bodies.size(); ++link) touch(link);
      dWorldStep(world, h_s);
      dJointGroupEmpty(contacts);
    }
  }
};

}  // namespace

std::vector<Row> rollers() {
  const auto model = robot_model();
  Ours ours(model);  // also initialises ODE
  Bare bare(*model);
  const Timing timing = compare(
      5, [&] { ours.run(); }, [&] { bare.run(); });
  constexpr double per_step_us = 1e6 / steps;
  // Both still go sideways at the commanded speed: else there were nothing to compare.
  const dReal* const v = dBodyGetLinearVel(bare.bodies[0]);
  const double own_speed = norm(ours.velocity()), bare_speed = std::sqrt(v[0] * v[0] + v[1] * v[1]);
  SL_CHECK(std::abs(own_speed - 0.5) < 0.05 && std::abs(bare_speed - 0.5) < 0.05);
  return {row("P4 step of an omni robot with 30 rollers", "us", timing.ours_s * per_step_us,
              timing.reference_s * per_step_us, 0.2)};
}

}  // namespace sandlot::bench
