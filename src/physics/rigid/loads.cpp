/// Forces of contacts and loads of joints, for those requested before the sub-step.
///
/// A contact, and a joint that moves, are rows of ODE, which reports the force of each row on demand. A fixed
/// joint is not a joint to ODE: what it joins is one body. Its load follows from Newton and Euler over the links
/// behind it (those that hang on the child by fixed joints alone), with the acceleration that the sub-step
/// gave their common body:
///
///   force  = sum m (a - g) - contacts - loads of the moving joints that end there - wrenches from outside
///   torque = the moments of the same about J's origin + sum (I dw/dt + w x I w)
///
/// That is exact for a tree, and the motion is the same whether or not somebody measures; cutting the body in
/// two with ODE's soft fixed joint would be neither. In a ring of fixed joints the load is not determined:
/// all of the ring lies behind the joint. What ends on the world at both sides, without motion, is statics by
/// the same sums.
#include "base/check.h"
#include "physics/rigid/joints.h"
#include "physics/rigid/ode_vector.h"
#include "physics/rigid/rigid_engine.h"

namespace sandlot::rigid {
namespace {

/// J as the child carries it now.
Pose joint_frame(const Instance& instance, const Joint& j) {
  return (j.child ? j.child->pose() : instance.X_WM) * j.X_child;
}

Symmetric3 tensor(const model::Inertial& i) {
  return {i.moments.x, i.moments.y, i.moments.z, i.products.x, i.products.y, i.products.z};
}

}  // namespace

void RigidEngine::watch(const Watch& watch) {
  const auto watch_link = [&](std::uint32_t index) {
    if (link_slots_[index].watched) return;
    link_slots_[index].watched = true;
    watched_links_.push_back(index);
  };
  for (const BodyId body : watch.contacts) {
    SL_CHECK(body.index < link_slots_.size());
    SL_CHECK_MSG(link_slots_[body.index].instance && link_slots_[body.index].generation == body.generation,
                 "no such body");
    watch_link(body.index);
  }
  for (const JointId id : watch.loads) {
    SL_CHECK(id.index < joint_slots_.size());
    const JointSlot& slot = joint_slots_[id.index];
    SL_CHECK_MSG(slot.instance && slot.generation == id.generation, "no such joint");
    watched_joints_.push_back(id.index);
    Instance& instance = *slot.instance;
    Joint& joint = instance.joints[slot.joint];
    joint.load_watched = true;
    if (joint.main) continue;
    find_behind(instance, joint);
    for (std::size_t l = 0; l < instance.links.size(); ++l)
      if (behind_[l]) watch_link(instance.link_ids[l].index);
    for (Joint& other : instance.joints)
      if (other.main && (behind_[other.decl->child] ||
                         (other.decl->parent != model::world_link && behind_[other.decl->parent])))
        other.load_watched = true;
  }
}

/// Fills behind_: the links on the child's side of a joint without motion.
void RigidEngine::find_behind(const Instance& instance, const Joint& joint) {
  behind_.assign(instance.links.size(), 0);
  frontier_.assign(1, joint.decl->child);
  behind_[joint.decl->child] = 1;
  while (!frontier_.empty()) {
    const std::uint32_t link = frontier_.back();
    frontier_.pop_back();
    for (const Joint& other : instance.joints) {
      if (&other == &joint || other.main || other.decl->parent == model::world_link) continue;
      for (const auto& [near, far] : {std::pair{other.decl->child, other.decl->parent},
                                      std::pair{other.decl->parent, other.decl->child}})
        if (near == link && !behind_[far]) {
          behind_[far] = 1;
          frontier_.push_back(far);
        }
    }
  }
}

/// @return whether any contact of this sub-step may be watched
bool RigidEngine::begin_contacts(std::size_t count) {
  watched_contacts_.clear();
  if (watched_links_.empty()) return false;
  // ODE keeps pointers to these until it has solved.
  if (contact_feedback_.size() < count) contact_feedback_.resize(2 * count);
  return true;
}

void RigidEngine::watch_contact(const Geom& a, const Geom& b, dJointID joint) {
  const bool watched = link_slots_[a.link.index].watched || link_slots_[b.link.index].watched;
  if (watched) {
    dJointFeedback& feedback = contact_feedback_[watched_contacts_.size()];
    feedback = {};
    dJointSetFeedback(joint, &feedback);
  }
  // ODE's first body is b where a is fixed to the world.
  watched_contacts_.push_back(!watched ? 0 : a.body ? 2 : 1);
}

void RigidEngine::measure_contacts() {
  for (std::size_t i = 0; i < watched_contacts_.size(); ++i) {
    if (!watched_contacts_[i]) continue;
    const Vec3 force = vec(contact_feedback_[i].f1);
    contacts_[i].force_W = watched_contacts_[i] == 1 ? force : -force;
  }
}

void RigidEngine::measure_loads(double h) {
  for (const std::uint32_t index : watched_joints_) {
    const Instance& instance = *joint_slots_[index].instance;
    const Joint& joint = instance.joints[joint_slots_[index].joint];
    loads_[index] = load_of(instance, joint, h);
  }
}

JointLoad RigidEngine::load_of(const Instance& instance, const Joint& joint, double h) {
  const Quat q = joint_frame(instance, joint).q;
  Vec3 force, torque;
  if (joint.main) {
    const Transmitted t = transmitted(joint);
    force = t.force_N, torque = t.torque_Nm;
  } else {
    find_behind(instance, joint);
    const JointLoad load = load_within_body(instance, joint, h);
    force = load.force_N, torque = load.torque_Nm;
  }
  return {rotate_inverse(q, force), rotate_inverse(q, torque)};
}

/// In W. @pre find_behind()
JointLoad RigidEngine::load_within_body(const Instance& instance, const Joint& joint, double h) {
  const Vec3 origin = joint_frame(instance, joint).p;
  JointLoad load;
  const auto less = [&](Vec3 point, Vec3 force, Vec3 torque) {
    load.force_N -= force;
    load.torque_Nm -= torque + cross(point - origin, force);
  };
  // The body still stands where the forces found it; ODE has its new velocity.
  const Body* const body = joint.child;
  Vec3 a_B, dw, w;
  if (body && body->awake) {
    const Vec3 w_new = vec(dBodyGetAngularVel(body->ode));
    a_B = (vec(dBodyGetLinearVel(body->ode)) - body->v) / h;
    dw = (w_new - body->w) / h;
    w = 0.5 * (w_new + body->w);
  }
  for (std::size_t l = 0; l < instance.links.size(); ++l) {
    if (!behind_[l]) continue;
    const model::Link& link = instance.model->links[l];
    const Pose X_WL = (body ? body->pose() : instance.X_WM) * instance.links[l].X_BL;
    const Pose X_WCo = X_WL * link.inertial.X_LCo;
    const double mass = link.inertial.mass_kg;
    const Vec3 arm = body ? X_WCo.p - body->p : Vec3{};
    const Vec3 a = a_B + cross(dw, arm) + cross(w, cross(w, arm));
    const Symmetric3 inertia = rotated(normalised(X_WCo.q), tensor(link.inertial));
    less(X_WCo.p, mass * ((link.gravity ? gravity_ : Vec3{}) - a), -(inertia * dw + cross(w, inertia * w)));
  }
  for (const Contact& contact : contacts_) {
    const auto acts_on = [&](BodyId id) {
      const LinkSlot& slot = link_slots_[id.index];
      return slot.instance == &instance && behind_[slot.link];
    };
    if (acts_on(contact.b)) less(contact.point_W, contact.force_W, {});
    if (acts_on(contact.a)) less(contact.point_W, -contact.force_W, {});
  }
  for (const Joint& other : instance.joints) {
    if (!other.main || !other.load_watched) continue;
    const bool child = behind_[other.decl->child] != 0;
    const bool parent = other.decl->parent != model::world_link && behind_[other.decl->parent];
    if (child == parent) continue;
    const Transmitted t = transmitted(other);
    if (child) less(t.point_W, t.force_N, t.torque_Nm);
    else less(t.point_W, -t.force_N, -t.torque_Nm);
  }
  for (const Push& push : pushes_)
    if (push.instance == &instance && behind_[push.link]) less(push.point_W, push.force_N, push.torque_Nm);
  return load;
}

void RigidEngine::forget_watch() {
  if (watched_links_.empty() && watched_joints_.empty()) return;
  for (const std::uint32_t index : watched_links_) link_slots_[index].watched = false;
  for (const std::uint32_t index : watched_joints_) {
    Instance& instance = *joint_slots_[index].instance;
    for (Joint& joint : instance.joints) {
      if (joint.load_watched && joint.main) silence(joint);
      joint.load_watched = false;
    }
  }
  watched_links_.clear();
  watched_joints_.clear();
  pushes_.clear();
}

}  // namespace sandlot::rigid
