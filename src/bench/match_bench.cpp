/// P6: a match of twelve omni robots, with all their sensors at the level objects, their programs and the referee, on one core.
///
/// The reference is bare ODE with the same bodies, hinges and motors: dWorldStep with a contact for each wheel, or each roller, that is
/// low enough, and nothing else: no search for pairs, no other contacts, no sensors, no programs, no State. On the planar engine it is
/// that of ideal wheels. Both figures are milliseconds per simulated second: 1000 over the first is the speed in times real time.
#include <ode/ode.h>

#include <cmath>
#include <map>
#include <memory>

#include "base/check.h"
#include "bench/bench.h"
#include "files/resources.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::bench {
namespace {

/// Kick-off is at 4 s at the earliest; from 12 s on robots play.
constexpr double begin_s = 14, length_s = 4;

model::Setup setup_of(const std::string& drive, const std::string& engine) {
  Diagnostics diagnostics;
  const std::vector<formats::Override> overrides{
      {"vars.drive", drive}, {"vars.engine", engine}, {"vars.players", "6"}, {"vars.stop_clock", "false"}};
  LoadOptions options;
  options.overrides = overrides;
  auto setup = load(own_folder("scenarios") + "/match.yaml", options, diagnostics);
  SL_CHECK(setup);
  return std::move(*setup);
}

/// The robots of a setup and nothing else, as bodies of ODE.
class Bare {
 public:
  explicit Bare(const model::Setup& setup) {
    dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_),
                                         threading_);
    dWorldSetGravity(world_, 0, 0, -9.81);
    dWorldSetERP(world_, 0.2);
    dWorldSetCFM(world_, 1e-6);
    for (const model::Instance& instance : setup.instances)
      if (instance.is_robot) add(instance);
  }
  ~Bare() {
    dJointGroupDestroy(contacts_);
    dWorldDestroy(world_);
    dThreadingFreeImplementation(threading_);
  }
  Bare(const Bare&) = delete;
  Bare& operator=(const Bare&) = delete;

  void step(double h_s) {
    for (const Rolling& each : rolling_) touch(each);
    dWorldStep(world_, h_s);
    dJointGroupEmpty(contacts_);
  }
  double lowest_m() const {
    double low = 1e9;
    for (const dBodyID body : bodies_) low = std::min<double>(low, dBodyGetPosition(body)[2]);
    return low;
  }

 private:
  struct Rolling {
    dBodyID body;
    double radius_m;
    Vec3 axis_L;
    bool slides;  ///< along its axis
  };

  void add(const model::Instance& instance) {
    const model::Model& model = *instance.model;
    // What hangs on a fixed joint is part of what it hangs on.
    std::map<std::uint32_t, dBodyID> body_of;
    std::map<std::uint32_t, std::uint32_t> fixed_to;
    for (const model::Joint& joint : model.joints)
      if (joint.type == model::JointType::fixed) fixed_to[joint.child] = joint.parent;
    for (std::uint32_t i = 0; i < model.links.size(); ++i) {
      if (fixed_to.contains(i)) continue;
      const model::Link& link = model.links[i];
      const Pose X_WL = instance.X_WM * link.X_ML;
      const dBodyID body = dBodyCreate(world_);
      dMass mass;
      const Vec3 m = link.inertial.moments;
      dMassSetParameters(&mass, link.inertial.mass_kg, 0, 0, 0, m.x, m.y, m.z, 0, 0, 0);
      dBodySetMass(body, &mass);
      dBodySetPosition(body, X_WL.p.x, X_WL.p.y, X_WL.p.z);
      const dQuaternion q = {X_WL.q.w, X_WL.q.x, X_WL.q.y, X_WL.q.z};
      dBodySetQuaternion(body, q);
      body_of[i] = body;
      bodies_.push_back(body);
    }
    std::map<std::uint32_t, bool> has_rollers;
    for (const model::Joint& joint : model.joints)
      if (joint.type != model::JointType::fixed && joint.parent != 0) has_rollers[joint.parent] = true;
    for (const model::Joint& joint : model.joints) {
      if (joint.type == model::JointType::fixed) continue;
      std::uint32_t parent = joint.parent;
      while (fixed_to.contains(parent)) parent = fixed_to.at(parent);
      const model::Link& child = model.links[joint.child];
      const Pose X_WL = instance.X_WM * child.X_ML;
      const Vec3 axis = rotate(X_WL.q, joint.axis_J);
      const dJointID hinge = dJointCreateHinge(world_, nullptr);
      dJointAttach(hinge, body_of.at(joint.child), body_of.at(parent));
      dJointSetHingeAnchor(hinge, X_WL.p.x, X_WL.p.y, X_WL.p.z);
      dJointSetHingeAxis(hinge, -axis.x, -axis.y, -axis.z);
      const bool is_wheel = parent == 0;
      if (is_wheel) {
        dJointSetHingeParam(hinge, dParamFMax, 2);
        dJointSetHingeParam(hinge, dParamVel, 5);
      }
      if (is_wheel && has_rollers[joint.child]) continue;
      rolling_.push_back({body_of.at(joint.child), radius_of(child), joint.axis_J, is_wheel});
    }
  }

  static double radius_of(const model::Link& link) {
    for (const model::Collision& skin : link.collisions) {
      if (const auto* const round = std::get_if<Cylinder>(&skin.shape)) return round->radius_m;
      if (const auto* const ball = std::get_if<Sphere>(&skin.shape)) return ball->radius_m;
      if (const auto* const barrel = std::get_if<Barrel>(&skin.shape)) return barrel->radius_m;
    }
    return 0.05;
  }

  void touch(const Rolling& each) {
    const dReal* const p = dBodyGetPosition(each.body);
    if (p[2] > each.radius_m) return;
    dContact contact{};
    contact.surface.mode = dContactFDir1 | dContactMu2 | dContactApprox1;
    contact.surface.mu = each.slides ? 0 : 1;
    contact.surface.mu2 = 1;
    dVector3 axis;
    dBodyVectorToWorld(each.body, each.axis_L.x, each.axis_L.y, each.axis_L.z, axis);
    const Vec3 along = normalised(Vec3{axis[0], axis[1], 0}, {1, 0, 0});
    contact.fdir1[0] = along.x, contact.fdir1[1] = along.y;
    contact.geom.pos[0] = p[0], contact.geom.pos[1] = p[1];
    contact.geom.normal[2] = 1;
    contact.geom.depth = each.radius_m - p[2];
    dJointAttach(dJointCreateContact(world_, contacts_, &contact), each.body, nullptr);
  }

  dWorldID world_ = dWorldCreate();
  dThreadingImplementationID threading_ = dThreadingAllocateSelfThreadedImplementation();
  dJointGroupID contacts_ = dJointGroupCreate(0);
  std::vector<dBodyID> bodies_;
  std::vector<Rolling> rolling_;
};

/// @param reference_steps  physics steps of the reference that are timed: with rollers they are slow
Row played(const std::string& name, const std::string& drive, const std::string& engine, int reference_steps,
           double budget) {
  model::Setup setup = setup_of(drive, engine);
  const model::Setup same = engine == "planar" ? setup_of("ideal", "rigid") : setup;
  const double step_s = same.step.s() / same.substeps;
  Diagnostics diagnostics;
  auto made = Simulation::create(std::move(setup), {}, diagnostics);
  SL_CHECK(made);
  Simulation& simulation = **made;
  const auto run_to = [&](double until_s) {
    while (simulation.now().s() < until_s) SL_CHECK(simulation.tick());
  };
  run_to(begin_s);
  const double began = thread_seconds();
  run_to(begin_s + length_s);
  const double ours_s = (thread_seconds() - began) / length_s;
  Bare bare(same);
  const double begun = thread_seconds();
  for (int i = 0; i < reference_steps; ++i) bare.step(step_s);
  const double bare_s = (thread_seconds() - begun) / (reference_steps * step_s);
  SL_CHECK(bare.lowest_m() > -0.1);  // they stand on their wheels
  return row(name, "ms/s", 1000 * ours_s, 1000 * bare_s, budget);
}

}  // namespace

std::vector<Row> match() {
  return {played("P6 match on rollers, 2 ms", "roller", "rigid", 10, 0.2),
          played("P6 match at contact, 4 ms", "contact", "rigid", 1000, 0.3),
          played("P6 match on ideal wheels, 4 ms", "ideal", "rigid", 1000, 4),
          played("P6 match on the planar engine, 4 ms", "ideal", "planar", 1000, 4)};
}

}  // namespace sandlot::bench
