#include <algorithm>

#include "base/check.h"
#include "physics/rigid/joints.h"
#include "physics/rigid/library.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/rigid/wheels.h"

namespace sandlot::rigid {

/// Writes the body's State to ODE.
void RigidEngine::put(Body& body) {
  dBodySetPosition(body.ode, body.p.x, body.p.y, body.p.z);
  dBodySetLinearVel(body.ode, body.v.x, body.v.y, body.v.z);
  dBodySetAngularVel(body.ode, body.w.x, body.w.y, body.w.z);
  put_orientation(body);
}

/// ODE normalises the orientation once more, so this must happen in every sub-step, restored or not, for both
/// to compute with the same bits. The other quantities ODE holds as they are.
void RigidEngine::put_orientation(Body& body) {
  const dQuaternion q = {body.q.w, body.q.x, body.q.y, body.q.z};
  dBodySetQuaternion(body.ode, q);
}

/// The instance's links and joints in states() and joint_states().
void RigidEngine::show(const Instance& instance) {
  for (std::size_t l = 0; l < instance.links.size(); ++l) {
    const Link& link = instance.links[l];
    BodyState& state = states_[instance.link_ids[l].index];
    if (!link.body) {
      state = {instance.X_WM * link.X_BL, {}};
      if (instance.guided) state.V_WB = {instance.velocity_at(state.X_WB.p), instance.V_WM.angular};
      continue;
    }
    const Body& b = *link.body;
    const Vec3 arm = rotate(b.q, link.X_BL.p);
    state.X_WB = {b.p + arm, link.X_BL.q == Quat{} ? b.q : b.q * link.X_BL.q};
    state.V_WB = {b.v + cross(b.w, arm), b.w};
  }
  for (std::size_t i = 0; i < instance.joints.size(); ++i) {
    const Joint& joint = instance.joints[i];
    joint_states_[instance.joint_ids[i].index] = {joint.position, joint.velocity, joint.effort};
  }
}

/// Puts the model at X_WM in its declared pose, at rest, and fixes what holds on to the world.
void RigidEngine::place(Instance& instance, const Pose& X_WM) {
  instance.X_WM = X_WM;
  for (Body& body : instance.bodies) {
    body.p = X_WM * body.X_MB.p;
    body.q = normalised(X_WM.q * body.X_MB.q);
    body.v = body.w = {};
    put(body);
  }
  if (instance.anchored)
    for (Joint& joint : instance.joints)
      if (!joint.child || !joint.parent) anchor_joint(joint, X_WM);
  place_static_geoms(instance);
  for (Joint& joint : instance.joints) measure_velocity(joint, X_WM);
  show(instance);
}

void RigidEngine::place_static_geoms(Instance& instance) {
  for (Geom& geom : instance.geoms) {
    if (geom.body) continue;
    const Pose X_MC = instance.links[link_slots_[geom.link.index].link].X_BL * geom.decl->X_LC;
    geom.X_BC = instance.X_WM * X_MC;
    geom.X_BC.q = normalised(geom.X_BC.q);
    const Pose& X = geom.X_BC;
    if (const auto* plane = std::get_if<Plane>(&geom.decl->shape)) {
      const Vec3 n = normalised(rotate(X.q, plane->normal));
      dGeomPlaneSetParams(geom.ode, n.x, n.y, n.z, dot(n, X.p));
    } else {
      dGeomSetPosition(geom.ode, X.p.x, X.p.y, X.p.z);
      const Quat q_WO = geom.triangles ? X.q * geom.triangles->q_CO() : X.q;
      const dQuaternion q = {q_WO.w, q_WO.x, q_WO.y, q_WO.z};
      dGeomSetQuaternion(geom.ode, q);
    }
  }
}

Pose RigidEngine::pose(InstanceId id) const {
  const Instance& instance = alive(id);
  if (!instance.links[0].body) return instance.X_WM;
  Pose X = states_[instance.link_ids[0].index].X_WB * inverse(instance.model->links[0].X_ML);
  X.q = normalised(X.q);
  return X;
}

void RigidEngine::set_pose(InstanceId id, const Pose& X_WM) {
  library::prepare_thread();
  Instance& instance = alive(id);
  if (!is_finite(X_WM)) return fail({"the new pose of '" + instance.name + "' is not finite", remedy});
  let_go(instance);
  wake_neighbours(instance);
  const Pose move = Pose{X_WM.p, normalised(X_WM.q)} * inverse(pose(id));
  std::vector<Pose> moved;
  for (const Body& body : instance.bodies) moved.push_back(move * body.pose());
  instance.V_WM = {};
  instance.destination.reset();
  const Pose X_WM_new = instance.bodies.empty() ? X_WM : move * instance.X_WM;
  place(instance, {X_WM_new.p, normalised(X_WM_new.q)});
  for (Wheel& wheel : instance.wheels) stop_frozen(wheel);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    Body& body = instance.bodies[i];
    body.p = moved[i].p;
    body.q = normalised(moved[i].q);
    body.force_N = body.torque_Nm = {};
    put(body);
  }
  for (Wheel& wheel : instance.wheels) follow(wheel);
  show(instance);
  wake_instance(instance);
  wake_neighbours(instance);
}

void RigidEngine::set_velocity(InstanceId id, const Velocity& V_WB) {
  library::prepare_thread();
  Instance& instance = alive(id);
  if (!is_finite(V_WB.linear) || !is_finite(V_WB.angular))
    return fail({"the new velocity of '" + instance.name + "' is not finite", remedy});
  if (!instance.links[0].body) return;
  // A rigid motion on top of the present one: whatever joins the bodies does not feel it.
  const BodyState now = states_[instance.link_ids[0].index];
  const Vec3 dv = V_WB.linear - now.V_WB.linear, dw = V_WB.angular - now.V_WB.angular;
  for (Body& body : instance.bodies) {
    body.v = body.v + dv + cross(dw, body.p - now.X_WB.p);
    body.w = body.w + dw;
    put(body);
  }
  for (Wheel& wheel : instance.wheels) follow(wheel);
  for (Joint& joint : instance.joints) measure_velocity(joint, instance.X_WM);
  show(instance);
  wake_instance(instance);
}

void RigidEngine::guide(InstanceId id, const Pose& X_WM, const Velocity& V_WM) {
  Instance& instance = alive(id);
  SL_CHECK_MSG(instance.guided, "guide() needs an instance with a motion");
  if (!is_finite(X_WM) || !is_finite(V_WM.linear) || !is_finite(V_WM.angular))
    return fail({"the motion of '" + instance.name + "' is no longer finite", remedy});
  instance.destination = Pose{X_WM.p, normalised(X_WM.q)};
  instance.V_WM = V_WM;
}

void RigidEngine::become_robot(InstanceId id) {
  Instance& instance = alive(id);
  instance.is_robot = true;
  wake_instance(instance);
}

void RigidEngine::wake(Body& body) {
  if (!body.awake) wake_instance(*body.instance);
  body.quiet_s = 0;
}

void RigidEngine::wake_instance(Instance& instance) {
  for (Body& body : instance.bodies) {
    if (!body.awake) woke_ = true;
    body.awake = true;
    body.quiet_s = 0;
  }
}

/// Wakes sleepers whose bounding boxes touch those of the instance: they may lean on it.
void RigidEngine::wake_neighbours(const Instance& instance) {
  constexpr double margin_m = 0.01;
  for (const Geom& geom : instance.geoms)
    if (geom.body) put_orientation(*geom.body);  // ODE's own orientation is not State: see step.cpp
  for (Instance* other : order_) {
    if (other == &instance) continue;
    for (Geom& sleeper : other->geoms) {
      if (!sleeper.ode || !sleeper.body || sleeper.body->awake) continue;
      dReal theirs[6], mine[6];
      dGeomGetAABB(sleeper.ode, theirs);
      bool touch = false;
      for (const Geom& geom : instance.geoms) {
        if (!geom.ode) continue;
        dGeomGetAABB(geom.ode, mine);
        bool overlap = true;
        for (int axis = 0; axis < 6; axis += 2)
          overlap = overlap && mine[axis] - margin_m <= theirs[axis + 1] &&
                    theirs[axis] - margin_m <= mine[axis + 1];
        touch = touch || overlap;
      }
      if (touch) wake(*sleeper.body);
    }
  }
}

}  // namespace sandlot::rigid
