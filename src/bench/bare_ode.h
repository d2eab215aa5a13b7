#pragma once
/// What P3 compares with: the loop of ODE's manual around the same bodies, joints and settings. Nothing is sorted,
/// saved, looked up or reported.
#include <ode/ode.h>

#include <map>
#include <memory>
#include <vector>

#include "base/check.h"
#include "model/model.h"
#include "physics/rigid/library.h"
#include "physics/rigid/spec.h"

namespace sandlot::bench {

class BareOde {
 public:
  explicit BareOde(const rigid::Spec& spec) : spec_(spec) {
    rigid::library::prepare_thread();
    world_ = dWorldCreate();
    threading_ = dThreadingAllocateSelfThreadedImplementation();
    dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_),
                                         threading_);
    dWorldSetGravity(world_, 0, 0, -9.81);
    dWorldSetERP(world_, spec.erp);
    dWorldSetCFM(world_, spec.cfm);
    dWorldSetContactMaxCorrectingVel(world_, spec.contact_correction_mps);
    dWorldSetQuickStepNumIterations(world_, spec.quick_iterations);
    dWorldSetAutoDisableFlag(world_, 0);
    space_ = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
    contacts_ = dJointGroupCreate(0);
  }
  ~BareOde() {
    dJointGroupDestroy(contacts_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
    dThreadingFreeImplementation(threading_);
  }
  BareOde(const BareOde&) = delete;
  BareOde& operator=(const BareOde&) = delete;

  /// Hinges with motors for continuous joints; nothing else. @pre the centre of mass is the link's origin
  void add(const model::Instance& instance) {
    const model::Model& model = *instance.model;
    const dSpaceID space = model.links.size() > 1 ? dSimpleSpaceCreate(space_) : space_;
    std::vector<dBodyID> bodies;
    for (const model::Link& link : model.links) {
      const Pose X_WL = instance.X_WM * link.X_ML;
      dBodyID body = nullptr;
      if (!model.is_static) {
        body = dBodyCreate(world_);
        dMass mass;
        const Vec3 i = link.inertial.moments;
        dMassSetParameters(&mass, link.inertial.mass_kg, 0, 0, 0, i.x, i.y, i.z, 0, 0, 0);
        dBodySetMass(body, &mass);
        dBodySetPosition(body, X_WL.p.x, X_WL.p.y, X_WL.p.z);
        const dQuaternion q{X_WL.q.w, X_WL.q.x, X_WL.q.y, X_WL.q.z};
        dBodySetQuaternion(body, q);
      }
      bodies.push_back(body);
      for (const model::Collision& collision : link.collisions) add(space, collision, body);
    }
    for (const model::Joint& joint : model.joints) {
      const Pose X_WJ = instance.X_WM * model.links[joint.child].X_ML * joint.X_CJ;
      const Vec3 axis = rotate(X_WJ.q, joint.axis_J);
      const dJointID hinge = dJointCreateHinge(world_, nullptr);
      dJointAttach(hinge, bodies[joint.child], bodies[joint.parent]);
      dJointSetHingeAnchor(hinge, X_WJ.p.x, X_WJ.p.y, X_WJ.p.z);
      dJointSetHingeAxis(hinge, axis.x, axis.y, axis.z);
      hinges_.push_back(hinge);
    }
  }
  void drive(double velocity_radps, double max_effort_Nm) {
    for (const dJointID hinge : hinges_) {
      dJointSetHingeParam(hinge, dParamVel, velocity_radps);
      dJointSetHingeParam(hinge, dParamFMax, max_effort_Nm);
    }
  }

  void step(double h_s, bool quick) {
    dSpaceCollide(space_, this, &near);
    quick ? dWorldQuickStep(world_, h_s) : dWorldStep(world_, h_s);
    dJointGroupEmpty(contacts_);
  }

 private:
  void add(dSpaceID space, const model::Collision& collision, dBodyID body) {
    dGeomID geom = nullptr;
    if (const auto* box = std::get_if<Box>(&collision.shape))
      geom = dCreateBox(space, box->size_m.x, box->size_m.y, box->size_m.z);
    else if (const auto* sphere = std::get_if<Sphere>(&collision.shape))
      geom = dCreateSphere(space, sphere->radius_m);
    else if (const auto* can = std::get_if<Cylinder>(&collision.shape))
      geom = dCreateCylinder(space, can->radius_m, can->length_m);
    else if (std::holds_alternative<Plane>(collision.shape)) geom = dCreatePlane(space, 0, 0, 1, 0);
    SL_CHECK(geom);
    frictions_.push_back(std::make_unique<double>(collision.surface.mu));
    dGeomSetData(geom, frictions_.back().get());
    if (!body) return;
    dGeomSetBody(geom, body);
    const Vec3 p = collision.X_LC.p;
    const Quat q = collision.X_LC.q;
    dGeomSetOffsetPosition(geom, p.x, p.y, p.z);
    const dQuaternion offset{q.w, q.x, q.y, q.z};
    dGeomSetOffsetQuaternion(geom, offset);
  }
  static void near(void* self, dGeomID a, dGeomID b) {
    if (dGeomIsSpace(a) || dGeomIsSpace(b)) return dSpaceCollide2(a, b, self, &near);
    auto& bare = *static_cast<BareOde*>(self);
    dContact contacts[8];
    const int n = dCollide(a, b, 8, &contacts[0].geom, sizeof(dContact));
    for (int i = 0; i < n; ++i) {
      contacts[i].surface.mode = dContactApprox1;
      contacts[i].surface.mu = std::min(*static_cast<const double*>(dGeomGetData(a)),
                                        *static_cast<const double*>(dGeomGetData(b)));
      const dJointID joint = dJointCreateContact(bare.world_, bare.contacts_, &contacts[i]);
      dJointAttach(joint, dGeomGetBody(a), dGeomGetBody(b));
    }
  }

  rigid::Spec spec_;
  dWorldID world_;
  dThreadingImplementationID threading_;
  dSpaceID space_;
  dJointGroupID contacts_;
  std::vector<dJointID> hinges_;
  std::vector<std::unique_ptr<double>> frictions_;
};

}  // namespace sandlot::bench
