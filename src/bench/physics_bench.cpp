/// P3: what the rigid engine costs beyond bare ODE with the same bodies, joints, contacts and settings.
///
/// The reference is the loop of ODE's own manual: one space per robot in a sweep-and-prune space, near
/// callback, contact joints along the slip, dWorldStep. What Sandlot adds is order (sorting), State outside
/// of ODE (canonical sub-steps), islands of its own and targets by id.
#include <ode/ode.h>

#include <cmath>
#include <memory>

#include "base/check.h"
#include "bench/bench.h"
#include "physics/engine.h"

namespace sandlot::bench {
namespace {

constexpr int steps = 200;
constexpr double h_s = 0.004, wheel_radius_m = 0.07, wheel_effort_Nm = 2;

double speed_radps(int robot, int wheel) { return 2 + 0.05 * robot + 0.5 * wheel; }
Vec3 robot_place(int i) { return {1.0 * (i % 10), 1.0 * (i / 10), 0}; }
Vec3 lone_box(int i) { return {0.8 * (i % 20) - 3, -1.5 - 0.8 * (i / 20), 0.1}; }
/// Layers of 25, each a little off the one below.
Vec3 piled_box(int i) {
  const int layer = i / 25;
  return {0.32 * (i % 5) + 0.03 * (layer % 3), 0.22 * (i / 5 % 5) + 0.02 * (layer % 2), 0.1 + 0.201 * layer};
}

/// Scene that both run.
struct Scene {
  int robots = 0, boxes = 0;
  Vec3 (*box_place)(int) = lone_box;
  bool quick = false;  ///< QuickStep in place of dWorldStep
};
constexpr int quick_iterations = 20;

// --- ours ---

std::shared_ptr<model::Model> one_link(const char* name, const Shape& shape, double mass_kg) {
  auto made = std::make_shared<model::Model>();
  made->name = name;
  made->is_static = mass_kg == 0;
  model::Link link;
  link.name = "link";
  link.inertial.mass_kg = mass_kg > 0 ? mass_kg : 1;
  link.inertial.moments = mass_kg > 0 ? inertia_kg_m2(shape, mass_kg) : Vec3{1, 1, 1};
  link.collisions.push_back({"c", {}, shape, {}, {}});
  made->links.push_back(std::move(link));
  return made;
}

std::shared_ptr<model::Model> robot_model() {
  auto made = one_link("robot", Box{{0.4, 0.24, 0.1}}, 5);
  made->links[0].X_ML.p = {0, 0, 0.12};
  model::Surface slick;
  slick.mu = slick.mu2 = 0;
  for (const double x : {0.15, -0.15})
    made->links[0].collisions.push_back({"caster", {{x, 0, -0.09}, {}}, Sphere{0.03}, slick, {}});
  for (const double y : {0.15, -0.15}) {
    model::Link wheel = one_link("wheel", Sphere{wheel_radius_m}, 0.5)->links[0];
    wheel.name = y > 0 ? "left" : "right";
    wheel.X_ML.p = {0, y, wheel_radius_m};
    made->links.push_back(wheel);
    model::Joint joint;
    joint.name = wheel.name;
    joint.type = model::JointType::continuous;
    joint.child = static_cast<std::uint32_t>(made->links.size() - 1);
    joint.axis_J = {0, 1, 0};
    made->joints.push_back(joint);
  }
  return made;
}

struct Ours {
  std::unique_ptr<Engine> engine;
  std::vector<JointTarget> targets;
  std::uint64_t tick = 0;

  explicit Ours(const Scene& scene) {
    Node config = Node::map();
    config.set("solver", Node::scalar(scene.quick ? "quick" : "direct"));
    config.set("quick_iterations", Node::scalar(std::to_string(quick_iterations)));
    config.set("sleeping", Node::scalar("false"));
    auto made = (*find_engine("rigid"))->create(config, {0, 0, -9.81});
    SL_CHECK(made);
    engine = std::move(*made);
    add("ground", one_link("ground", Plane{{0, 0, 1}}, 0), {}, false);
    const auto box = one_link("box", Box{{0.3, 0.2, 0.2}}, 1);
    for (int i = 0; i < scene.boxes; ++i) add("box" + std::to_string(i), box, scene.box_place(i), false);
    const auto robot = robot_model();
    for (int i = 0; i < scene.robots; ++i) {
      const InstanceId id = add("robot" + std::to_string(i), robot, robot_place(i), true);
      for (int wheel = 0; wheel < 2; ++wheel)
        targets.push_back({engine->joints(id)[static_cast<std::size_t>(wheel)], JointTarget::Mode::velocity,
                           speed_radps(i, wheel), wheel_effort_Nm, 0});
    }
  }
  InstanceId add(const std::string& name, std::shared_ptr<const model::Model> shape, Vec3 at, bool is_robot) {
    model::Instance instance;
    instance.name = instance.original_name = name;
    instance.model = std::move(shape);
    instance.X_WM.p = at;
    instance.is_robot = is_robot;
    auto id = engine->add(instance);
    SL_CHECK(id);
    return *id;
  }
  void run() {
    for (int i = 0; i < steps; ++i) {
      engine->set_targets(targets);
      engine->step(h_s, tick++);
    }
  }
};

// --- bare ODE ---

struct Bare {
  bool quick;
  dWorldID world = dWorldCreate();
  dThreadingImplementationID threading = dThreadingAllocateSelfThreadedImplementation();
  dSpaceID space = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
  dJointGroupID contacts = dJointGroupCreate(0);
  std::vector<dJointID> wheels;
  std::vector<std::unique_ptr<double>> friction;  ///< per geom, behind dGeomGetData

  explicit Bare(const Scene& scene) : quick(scene.quick) {
    dWorldSetQuickStepNumIterations(world, quick_iterations);
    dWorldSetStepThreadingImplementation(world, dThreadingImplementationGetFunctions(threading), threading);
    dWorldSetGravity(world, 0, 0, -9.81);
    dWorldSetERP(world, 0.2);
    dWorldSetCFM(world, 1e-6);
    dWorldSetContactMaxCorrectingVel(world, 1);
    finish(dCreatePlane(space, 0, 0, 1, 0), 1);
    for (int i = 0; i < scene.boxes; ++i) {
      const dBodyID body = make_body(inertia_kg_m2(Box{{0.3, 0.2, 0.2}}, 1), 1, scene.box_place(i));
      attach(dCreateBox(own_space(), 0.3, 0.2, 0.2), body, {}, 1);
    }
    for (int i = 0; i < scene.robots; ++i) {
      const dSpaceID own = own_space();
      const Vec3 at = robot_place(i);
      const dBodyID base = make_body(inertia_kg_m2(Box{{0.4, 0.24, 0.1}}, 5), 5, at + Vec3{0, 0, 0.12});
      attach(dCreateBox(own, 0.4, 0.24, 0.1), base, {}, 1);
      for (const double x : {0.15, -0.15}) attach(dCreateSphere(own, 0.03), base, {x, 0, -0.09}, 0);
      for (int wheel = 0; wheel < 2; ++wheel) {
        const Vec3 hub = at + Vec3{0, wheel == 0 ? 0.15 : -0.15, wheel_radius_m};
        const dBodyID body = make_body(inertia_kg_m2(Sphere{wheel_radius_m}, 0.5), 0.5, hub);
        attach(dCreateSphere(own, wheel_radius_m), body, {}, 1);
        const dJointID joint = dJointCreateHinge(world, nullptr);
        dJointAttach(joint, body, base);
        dJointSetHingeAnchor(joint, hub.x, hub.y, hub.z);
        dJointSetHingeAxis(joint, 0, -1, 0);
        dJointSetHingeParam(joint, dParamFMax, wheel_effort_Nm);
        dJointSetHingeParam(joint, dParamVel, -speed_radps(i, wheel));
        wheels.push_back(joint);
      }
    }
  }
  ~Bare() {
    dJointGroupDestroy(contacts);
    dSpaceDestroy(space);
    dWorldDestroy(world);
    dThreadingFreeImplementation(threading);
  }
  Bare(const Bare&) = delete;
  Bare& operator=(const Bare&) = delete;

  dSpaceID own_space() {
    const dSpaceID own = dSimpleSpaceCreate(space);
    dSpaceSetSublevel(own, 1);
    return own;
  }
  void finish(dGeomID geom, double mu) {
    friction.push_back(std::make_unique<double>(mu));
    dGeomSetData(geom, friction.back().get());
  }
  void attach(dGeomID geom, dBodyID body, Vec3 offset, double mu) {
    dGeomSetBody(geom, body);
    if (offset != Vec3{}) dGeomSetOffsetPosition(geom, offset.x, offset.y, offset.z);
    finish(geom, mu);
  }
  dBodyID make_body(Vec3 moments, double mass_kg, Vec3 at) {
    const dBodyID body = dBodyCreate(world);
    dMass mass;
    dMassSetParameters(&mass, mass_kg, 0, 0, 0, moments.x, moments.y, moments.z, 0, 0, 0);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, at.x, at.y, at.z);
    return body;
  }
  static void near(void* self, dGeomID a, dGeomID b) {
    if (dGeomIsSpace(a) || dGeomIsSpace(b)) return dSpaceCollide2(a, b, self, &near);
    static_cast<Bare*>(self)->touch(a, b);
  }
  void touch(dGeomID a, dGeomID b) {
    const dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (!body_a && !body_b) return;
    dContactGeom points[8];
    const int n = dCollide(a, b, 8, points, sizeof(dContactGeom));
    const double mu = std::min(*static_cast<double*>(dGeomGetData(a)),
                               *static_cast<double*>(dGeomGetData(b)));
    for (int i = 0; i < n; ++i) {
      dContact contact;
      contact.surface.mode = dContactFDir1 | dContactApprox1;
      contact.surface.mu = mu;
      contact.geom = points[i];
      dVector3 va{}, vb{};
      if (body_a) dBodyGetPointVel(body_a, points[i].pos[0], points[i].pos[1], points[i].pos[2], va);
      if (body_b) dBodyGetPointVel(body_b, points[i].pos[0], points[i].pos[1], points[i].pos[2], vb);
      const Vec3 normal{points[i].normal[0], points[i].normal[1], points[i].normal[2]};
      Vec3 slip{va[0] - vb[0], va[1] - vb[1], va[2] - vb[2]};
      slip -= dot(slip, normal) * normal;
      const Vec3 across = std::abs(normal.x) < 0.9 ? cross(normal, {1, 0, 0}) : cross(normal, {0, 1, 0});
      const Vec3 direction = norm(slip) > 1e-9 ? slip / norm(slip) : normalised(across);
      contact.fdir1[0] = direction.x, contact.fdir1[1] = direction.y, contact.fdir1[2] = direction.z;
      dJointAttach(dJointCreateContact(world, contacts, &contact), body_a, body_b);
    }
  }
  void run() {
    for (int i = 0; i < steps; ++i) {
      dSpaceCollide(space, this, &near);
      quick ? dWorldQuickStep(world, h_s) : dWorldStep(world, h_s);
      dJointGroupEmpty(contacts);
    }
  }
};

Row stepped(const std::string& name, const Scene& scene) {
  Ours ours(scene);  // also initialises ODE
  Bare bare(scene);
  const Timing timing = compare(
      9, [&] { ours.run(); }, [&] { bare.run(); });
  constexpr double per_step_us = 1e6 / steps;
  return row(name, "us", timing.ours_s * per_step_us, timing.reference_s * per_step_us, 1.15);
}

}  // namespace

std::vector<Row> physics() {
  return {stepped("P3 step of 50 two-wheeled robots and 100 boxes", {.robots = 50, .boxes = 100})};
}

std::vector<Row> wheels() { return {stepped("P3 step of 100 robots on driven wheels", {.robots = 100})}; }

std::vector<Row> pile() {
  return {stepped("P3 step of a pile of 200 boxes, QuickStep",
                  {.boxes = 200, .box_place = piled_box, .quick = true})};
}

}  // namespace sandlot::bench
