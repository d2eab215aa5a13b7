#include "physics/rigid/rigid_engine.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/check.h"
#include "base/read.h"
#include "physics/distance.h"
#include "physics/rigid/joints.h"
#include "physics/rigid/library.h"
#include "physics/rigid/wheels.h"

namespace sandlot::rigid {
namespace {

/// What the library may meet: squares of this over the least inertia are far from an overflow. False for NaN.
bool is_computable(Vec3 force) { return dot(force, force) < 1e200; }

}  // namespace

RigidEngine::RigidEngine(const Spec& spec, Vec3 gravity_mps2) : spec_(spec), gravity_(gravity_mps2) {
  library::prepare_thread();
  world_ = dWorldCreate();
  // ODE's default threading is one object for all worlds of a process; worlds in several threads then abort.
  threading_ = dThreadingAllocateSelfThreadedImplementation();
  dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_), threading_);
  dWorldSetGravity(world_, gravity_.x, gravity_.y, gravity_.z);
  dWorldSetERP(world_, spec_.erp);
  dWorldSetCFM(world_, spec_.cfm);
  dWorldSetContactMaxCorrectingVel(world_, dInfinity);  // see attach_contacts()
  dWorldSetContactSurfaceLayer(world_, 0);
  dWorldSetQuickStepNumIterations(world_, spec_.quick_iterations);
  dWorldSetAutoDisableFlag(world_, 0);  // sleeping is ours: ODE's counters cannot be saved
  space_ = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XYZ);
  dSpaceSetCleanup(space_, 0);
  contact_joints_ = dJointGroupCreate(0);
  ray_ = dCreateRay(nullptr, 1);
  dGeomRaySetClosestHit(ray_, 1);
}

RigidEngine::~RigidEngine() {
  dJointGroupDestroy(contact_joints_);
  dGeomDestroy(ray_);
  for (Instance* instance : order_) destroy(*instance);
  dSpaceDestroy(space_);
  dWorldDestroy(world_);
  // A step that ODE broke off leaves jobs behind, and ODE insists that there are none: its complaint, thrown
  // out of a destructor, would end the process. The few bytes are not worth that.
  if (fault_.empty()) dThreadingFreeImplementation(threading_);
  else library::abandon(threading_);
}

Capabilities RigidEngine::capabilities() const {
  return {.name = "rigid",
          .planar = false,
          .joints = true,
          .contact_drives = true,
          .ideal_drives = true,
          .rays = false,
          .contact_forces = true,
          .joint_loads = true,
          .rollers = true,
          .grips = true};
}

BodyName RigidEngine::name(BodyId id) const {
  if (id.index >= link_slots_.size()) return {};
  const LinkSlot& slot = link_slots_[id.index];
  if (!slot.instance || slot.generation != id.generation) return {};
  return {slot.instance->name, &slot.instance->model->links[slot.link],
          slot.instance->links[slot.link].body != nullptr};
}

BodyId RigidEngine::body_at(std::uint32_t index) const {
  return index < link_slots_.size() ? BodyId{index, link_slots_[index].generation} : BodyId{};
}

void RigidEngine::apply(std::span<const Wrench> wrenches) {
  for (const Wrench& wrench : wrenches) {
    SL_CHECK(wrench.body.index < link_slots_.size());
    const LinkSlot& slot = link_slots_[wrench.body.index];
    SL_CHECK_MSG(slot.instance && slot.generation == wrench.body.generation, "no such body");
    if (wrench.force_N == Vec3{} && wrench.torque_Nm == Vec3{}) continue;
    Body* const body = slot.instance->links[slot.link].body;
    if (!body) continue;
    wake(*body);
    if (!is_computable(wrench.force_N) || !is_computable(wrench.torque_Nm)) {  // kept away from ODE
      fail({"the force on '" + slot.instance->name + "/" + slot.instance->model->links[slot.link].name +
                "' is not finite, or beyond all bounds",
            remedy});
      return;
    }
    // At the link's own centre of mass, which is not the body's where fixed joints make several links one
    // body.
    const Vec3 com_L = slot.instance->model->links[slot.link].inertial.X_LCo.p;
    const Vec3 arm = rotate(body->q, slot.instance->links[slot.link].X_BL * com_L);
    body->force_N += wrench.force_N;
    body->torque_Nm += wrench.torque_Nm + cross(arm, wrench.force_N);
    if (!watched_joints_.empty())
      pushes_.push_back({slot.instance, slot.link, body->p + arm, wrench.force_N, wrench.torque_Nm});
  }
}

void RigidEngine::set_targets(std::span<const JointTarget> targets) {
  for (const JointTarget& target : targets) {
    SL_CHECK(target.joint.index < joint_slots_.size());
    const JointSlot& slot = joint_slots_[target.joint.index];
    SL_CHECK_MSG(slot.instance && slot.generation == target.joint.generation, "no such joint");
    Joint& joint = slot.instance->joints[slot.joint];
    for (const double x :
         {target.velocity, target.max_effort, target.effort, target.damping, target.inertia, target.friction})
      if (!std::isfinite(x)) {
        fail({"the target of joint '" + slot.instance->name + "/" + joint.decl->name + "' is not finite",
              remedy});
        return;
      }
    joint.target = target;
    set_motor(joint);
    if (target.mode != JointTarget::Mode::free) wake_instance(*slot.instance);
  }
}

void RigidEngine::set_wheels(std::span<const WheelTarget> targets) {
  for (const WheelTarget& target : targets) {
    SL_CHECK(target.wheel.index < joint_slots_.size());
    const JointSlot& slot = joint_slots_[target.wheel.index];
    SL_CHECK_MSG(slot.instance && slot.generation == target.wheel.generation, "no such joint");
    for (Wheel& wheel : slot.instance->wheels) {
      if (wheel.joint != &slot.instance->joints[slot.joint] || wheel.on_rollers == target.rollers) continue;
      wheel.on_rollers = target.rollers;
      if (!target.rollers) {
        wheel.touched_B.clear();
        choose_awake(wheel);
        stop_frozen(wheel);
        follow(wheel);
        show(*slot.instance);
      }
      wake_instance(*slot.instance);
    }
  }
}

void RigidEngine::set_drive_targets(std::span<const DriveTarget> targets) {
  for (const DriveTarget& target : targets) {
    SL_CHECK(target.base.index < link_slots_.size());
    const LinkSlot& slot = link_slots_[target.base.index];
    SL_CHECK_MSG(slot.instance && slot.generation == target.base.generation, "no such body");
    for (const double x : {target.vx_mps, target.vy_mps, target.wz_radps, target.max_accel_mps2,
                           target.max_angular_accel_radps2})
      if (!std::isfinite(x)) {
        fail({"the velocity ordered of '" + slot.instance->name + "' is not finite", remedy});
        return;
      }
    slot.instance->drive = target;
    slot.instance->drive_link = slot.link;
    set_gyroscopic(*slot.instance);
    wake_instance(*slot.instance);
  }
}

/// The rails carry what turning wheels would do to a free body, so ODE must not add it.
void RigidEngine::set_gyroscopic(Instance& instance) {
  for (Body& body : instance.bodies) dBodySetGyroscopicMode(body.ode, !instance.drive.active);
}

Status RigidEngine::check_finite() const { return failure_ ? Status(*failure_) : Status(); }

/// The run is over. What was to act in this sub-step is forgotten, so that the State can be saved and looked
/// at.
void RigidEngine::fail(Error error) {
  if (failure_) return;
  failure_ = std::move(error);
  for (Instance* instance : order_) {
    instance->destination.reset();
    for (Body& b : instance->bodies) b.force_N = b.torque_Nm = {};
  }
}

void RigidEngine::overlaps(std::span<const OverlapQuery> queries, std::vector<std::uint32_t>& out,
                           std::vector<std::uint32_t>& ends) const {
  for (const OverlapQuery& query : queries) {
    for (std::uint32_t index = 0; index < link_slots_.size(); ++index) {
      const LinkSlot& slot = link_slots_[index];
      if (!slot.instance) continue;
      for (const Geom& geom : slot.instance->geoms) {
        if (geom.link.index != index) continue;
        const model::Collision& c = *geom.decl;
        const Pose X_WC = states_[index].X_WB * c.X_LC;
        const double reach = query.radius_m + geom.size_m;
        const Vec3 apart = query.centre_W - X_WC.p;
        if (dot(apart, apart) > reach * reach) continue;
        if (distance_m(c.shape, rotate_inverse(X_WC.q, apart), query.radius_m) > query.radius_m) continue;
        out.push_back(index);
        break;
      }
    }
    ends.push_back(static_cast<std::uint32_t>(out.size()));
  }
}

namespace {

Result<std::unique_ptr<Engine>> create(const Node& config, Vec3 gravity_mps2) {
  SL_ASSIGN(const Spec spec, read_spec<Spec>(config));
  return std::unique_ptr<Engine>(std::make_unique<RigidEngine>(spec, gravity_mps2));
}

}  // namespace

const EngineKind engine = {
    .name = "rigid",
    .help = "Rigid bodies in three dimensions with joints, contacts and friction (ODE).",
    .describe = [] { return describe_fields<Spec>(); },
    .create = create,
};

}  // namespace sandlot::rigid
