// Placement of the planar engine's instances: from poses of models to groups, and back.
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

/// Heading of a rotation about z.
Turn heading_of(Quat q, Quat& tilt) {
  const double n = std::sqrt(q.w * q.w + q.z * q.z);
  if (n < 1e-9) {  // upside down: any heading will do
    tilt = q;
    return {};
  }
  const double w = q.w / n, z = q.z / n;
  tilt = normalised(Quat{n, w * q.x + z * q.y, w * q.y - z * q.x, 0});
  return tidied({w * w - z * z, 2 * w * z});
}

bool same(Quat a, Quat b) {
  const Quat d = conjugate(a) * b;
  return d.x * d.x + d.y * d.y + d.z * d.z < 1e-18;
}

}  // namespace

/// Puts an instance to a place, at rest.
void PlanarEngine::settle(std::uint32_t slot, const Pose& X_WM) {
  Instance& instance = instances_[slot];
  const Pose X_WB = X_WM * instance.model->links[0].X_ML;
  const Quat tilt_before = instance.tilt;
  const double z_before = instance.z_m;
  if (!instance.moves) {
    instance.still = std::make_unique<Instance::Still>(
        Instance::Still{.at = {X_WB.p.x, X_WB.p.y}, .q = X_WB.q});
    instance.z_m = X_WB.p.z;
    walls_fresh_ = false;
    stale();
    return;
  }
  heading_of(X_WB.q, instance.tilt);
  instance.z_m = X_WB.p.z;
  if (!instance.plan || !same(tilt_before, instance.tilt) || z_before != instance.z_m) shape(slot);
  place_groups(slot, X_WB);
  for (const std::uint32_t k : instance.groups) {
    groups_[k].v = {};
    groups_[k].w_radps = 0;
  }
  for (Wheel& wheel : instance.wheels) {
    wheel.impulse = {};
    if (wheel.joint != none) joint_states_[wheel.joint].velocity = 0;
  }
  for (JointConstraint& l : instance.constraints) {
    l.hold = {};
    l.turn = 0;
    joint_states_[l.joint].velocity = 0;
  }
  drives_[slot].now = {};
  std::erase_if(contact_points_, [&](const ContactPoint& t) {
    return t.key.pair >> 32 == instance.created || (t.key.pair & 0xffffffffu) == instance.created;
  });
}

void PlanarEngine::free_groups(Instance& instance) {
  for (std::size_t i = instance.groups.size(); i-- > 0;) {
    const std::uint32_t k = instance.groups[i];
    if (groups_[k].silhouette != none) {
      map_.silhouettes()[groups_[k].silhouette] = {};
      free_silhouettes_.push_back(groups_[k].silhouette);
    }
    groups_[k] = {};
    map_.discs()[k] = {};
    free_groups_.push_back(k);
  }
  instance.groups.clear();
  linked_fresh_ = false;
}

/// Makes the parts that follow from attitude and height: groups, outlines and wheels.
void PlanarEngine::shape(std::uint32_t slot) {
  Instance& instance = instances_[slot];
  if (!last_plan_ || last_model_ != instance.model || !same(last_tilt_, instance.tilt) ||
      last_z_m_ != instance.z_m) {
    last_plan_ = std::make_shared<const Plan>(make_plan(*instance.model, instance.tilt, instance.z_m));
    last_tilt_ = instance.tilt;
    last_z_m_ = instance.z_m;
    if (last_model_ != instance.model) {
      last_model_ = instance.model;
      last_kinematics_ = instance.kinematics;
    }
  }
  instance.plan = last_plan_;
  const Plan& plan = *instance.plan;
  std::vector<RigidGroup> before;
  for (const std::uint32_t k : instance.groups) before.push_back(groups_[k]);
  free_groups(instance);
  for (std::uint32_t i = 0; i < plan.groups.size(); ++i) {
    const RigidGroupPlan& p = plan.groups[i];
    std::uint32_t k;
    if (free_groups_.empty()) {
      k = static_cast<std::uint32_t>(groups_.size());
      groups_.emplace_back();
      ground_friction_.emplace_back();
      map_.discs().emplace_back();
    } else {
      k = free_groups_.back();
      free_groups_.pop_back();
    }
    RigidGroup& group = groups_[k];
    group = i < before.size() ? before[i] : RigidGroup{};
    group.plan = &p;
    group.slot = slot;
    group.index = i;
    group.silhouette = none;
    group.rolls = p.rolls && p.supports[0].surface->mu > 0 && !instance.guided;
    group.inverse_kg = instance.guided ? 0 : 1 / (p.mass_kg * (group.rolls ? 1 + p.spin() : 1));
    group.inverse_kgm2 = instance.guided ? 0 : 1 / p.inertia_kgm2;
    instance.groups.push_back(k);
    Disc& disc = map_.discs()[k];
    disc = {.centre = {},
            .radius_m = p.radius_m,
            .heights = p.heights,
            .body = instance.bodies[p.root].index,
            .instance = slot};
    if (!p.parts.empty()) disc.body = instance.bodies[p.parts[0].link].index;
    if (!p.disc && !p.parts.empty()) {
      if (free_silhouettes_.empty()) {
        group.silhouette = static_cast<std::uint32_t>(map_.silhouettes().size());
        map_.silhouettes().emplace_back();
      } else {
        group.silhouette = free_silhouettes_.back();
        free_silhouettes_.pop_back();
      }
      Silhouette& silhouette = map_.silhouettes()[group.silhouette];
      for (const Part& part : p.parts) {
        silhouette.parts.push_back(part.outline);
        silhouette.bodies.push_back(instance.bodies[part.link].index);
      }
      silhouette.edges = p.edges;
      disc.silhouette = group.silhouette;
    }
  }
  summaries_[slot] = {instance.groups.size() == 1 ? instance.groups[0] : none, instance.moves,
                      instance.guided};
  add_joints(instance);
  aim(slot, drives_[slot].link);
  for (const JointId joint : instance.joints)
    if (const std::uint32_t roll = motors_[joint.index].roll; roll != none) {
      // It goes on from where it is.
      show(rolls_[roll]);
      set_roll(joint.index, rolls_[roll].target, joint_states_[joint.index].position);
    }
  filed_ = ground_fresh_ = false;
  stale();
}

/// Wheels, casters and constraints, as the plan has them.
void PlanarEngine::add_joints(Instance& instance) {
  const Plan& plan = *instance.plan;
  const bool same_kind = instance.constraints.size() + instance.wheels.size() > 0;
  std::vector<JointConstraint> constraints = std::move(instance.constraints);
  std::vector<Wheel> wheels = std::move(instance.wheels);
  instance.constraints.clear();
  instance.wheels.clear();
  const auto global = [&](std::uint32_t joint) {
    return joint == model::Joint::no_joint ? none : instance.joints[joint].index;
  };
  for (const WheelPlan& w : plan.wheels) {
    Wheel wheel;
    wheel.plan = &w;
    wheel.group = instance.groups[w.group];
    wheel.joint = global(w.joint);
    wheel.steering = global(w.steering);
    wheel.at = w.at;
    motors_[wheel.joint].role = Motor::Role::wheel;
    if (wheel.steering != none) motors_[wheel.steering].role = Motor::Role::wheel;
    instance.wheels.push_back(std::move(wheel));
  }
  for (std::uint32_t i = 0; i < plan.groups.size(); ++i) {
    const bool wheeled = std::any_of(plan.wheels.begin(), plan.wheels.end(),
                                     [&](const WheelPlan& w) { return w.group == i; });
    if (!wheeled) continue;
    for (const Support& s : plan.groups[i].supports)
      if (s.surface->mu > 0) {
        Wheel caster;
        caster.group = instance.groups[i];
        caster.at = s.at;
        instance.wheels.push_back(std::move(caster));
      }
  }
  instance.wheels.shrink_to_fit();
  for (const JointPlan& l : plan.constraints) {
    if (l.kind == JointPlan::Kind::steering) continue;
    JointConstraint constraint{
        .plan = &l, .a = instance.groups[l.parent], .b = instance.groups[l.child], .joint = global(l.joint)};
    constraint.at_a = l.at_H - plan.groups[l.parent].com_H;
    constraint.at_b = l.at_H - plan.groups[l.child].com_H;
    constraint.axis_a = l.axis;
    motors_[constraint.joint].role = Motor::Role::constraint;
    instance.constraints.push_back(constraint);
  }
  if (!same_kind) return;
  for (std::size_t i = 0; i < std::min(wheels.size(), instance.wheels.size()); ++i)
    instance.wheels[i].impulse = wheels[i].impulse;
  for (std::size_t i = 0; i < std::min(constraints.size(), instance.constraints.size()); ++i) {
    instance.constraints[i].hold = constraints[i].hold;
    instance.constraints[i].turn = constraints[i].turn;
  }
}

/// From the canonical link's pose and the positions of joints.
void PlanarEngine::place_groups(std::uint32_t slot, const Pose& X_WB) {
  Instance& instance = instances_[slot];
  const Plan& plan = *instance.plan;
  if (plan.groups.size() > 1) {
    refresh_rolls();
    states_.resize(body_slot_.size());
    states_[instance.bodies[0].index] = {X_WB, {}};
    instance.kinematics->place(instance.bodies, instance.joints, joint_states_, states_);
  }
  for (const std::uint32_t k : instance.groups) {
    RigidGroup& group = groups_[k];
    const RigidGroupPlan& p = plan.groups[group.index];
    Quat tilt;
    if (group.index == 0) {
      group.heading = heading_of(X_WB.q, tilt);
      group.p = Vec2{X_WB.p.x, X_WB.p.y} + rotate(group.heading, p.com_H);
    } else {
      const Pose moved = states_[instance.bodies[p.root].index].X_WB * inverse(plan.X_HL[p.root]);
      group.heading = heading_of(moved.q, tilt);
      group.p = Vec2{moved.p.x, moved.p.y} + rotate(group.heading, p.com_H);
    }
    place_disc(k);
  }
  stale();
}

/// Brings what others see of a group to where it is.
void PlanarEngine::place_disc(std::uint32_t k) {
  const RigidGroup& group = groups_[k];
  map_.discs()[k].centre = group.p + rotate(group.heading, group.plan->centre);
  if (group.silhouette != none) move_silhouette(k);
}

void PlanarEngine::move_silhouette(std::uint32_t k) {
  const RigidGroup& group = groups_[k];
  const RigidGroupPlan& plan = *group.plan;
  Silhouette& silhouette = map_.silhouettes()[group.silhouette];
  for (std::size_t i = 0; i < plan.parts.size(); ++i)
    silhouette.parts[i].centre = group.p + rotate(group.heading, plan.parts[i].outline.centre);
  for (std::size_t i = 0; i < plan.edges.size(); ++i) {
    silhouette.edges[i].from = group.p + rotate(group.heading, plan.edges[i].from);
    silhouette.edges[i].along = rotate(group.heading, plan.edges[i].along);
  }
}

void PlanarEngine::set_pose(InstanceId id, const Pose& X_WM) {
  get(id);
  let_go(id.index);
  settle(id.index, X_WM);
}

void PlanarEngine::set_velocity(InstanceId id, const Velocity& V_WB) {
  get(id);
  Instance& instance = instances_[id.index];
  if (!instance.moves || instance.guided) return;
  const BodyState now = canonical_state(id.index);
  const Vec3 dv = V_WB.linear - now.V_WB.linear;
  const double dw = V_WB.angular.z - now.V_WB.angular.z;
  for (const std::uint32_t k : instance.groups) {
    RigidGroup& group = groups_[k];
    const Vec2 arm = group.p - Vec2{now.X_WB.p.x, now.X_WB.p.y};
    group.v = group.v + Vec2{dv.x, dv.y} + dw * left_of(arm);
    group.w_radps += dw;
  }
  if (Drive& drive = drives_[id.index]; drive.active) {
    const RigidGroup& group = groups_[instance.groups[0]];
    drive.now = {
        rotate_back(group.heading * drive.frame, group.velocity_at(rotate(group.heading, drive.arm))),
        group.w_radps};
  }
  stale();
}

void PlanarEngine::guide(InstanceId id, const Pose& X_WM, const Velocity& V_WM) {
  SL_CHECK_MSG(get(id).guided, "guide() needs an instance with a motion");
  instances_[id.index].destination = std::make_unique<std::pair<Pose, Velocity>>(X_WM, V_WM);
}

/// The velocity of a guided instance in this step.
void PlanarEngine::lead(std::uint32_t slot, double) {
  Instance& instance = instances_[slot];
  for (const std::uint32_t k : instance.groups) {
    RigidGroup& group = groups_[k];
    group.v = {};
    group.w_radps = 0;
    if (!instance.destination) continue;
    const auto& [X_WM, V] = *instance.destination;
    // At its destination, where the velocity is meant.
    const Pose X_WB = X_WM * instance.model->links[0].X_ML;
    Quat tilt;
    const Vec2 com = rotate(heading_of(X_WB.q, tilt), instance.plan->groups[0].com_H);
    const Vec3 arm = X_WB.p + Vec3{com.x, com.y, 0} - X_WM.p, v = V.linear + sandlot::cross(V.angular, arm);
    group.v = {v.x, v.y};
    group.w_radps = V.angular.z;
  }
}

/// Takes a guided instance where it is to be.
void PlanarEngine::arrive(std::uint32_t slot) {
  Instance& instance = instances_[slot];
  if (!instance.destination) return;
  const Pose X_WB = instance.destination->first * instance.model->links[0].X_ML;
  instance.destination.reset();
  Quat tilt;
  heading_of(X_WB.q, tilt);
  const Quat change = conjugate(instance.tilt) * tilt;
  // Rounding alone does not make a new outline.
  if (std::abs(X_WB.p.z - instance.z_m) > 1e-9 || norm(Vec3{change.x, change.y, change.z}) > 1e-9) {
    instance.tilt = tilt;
    instance.z_m = X_WB.p.z;
    shape(slot);
  }
  place_groups(slot, X_WB);
}

Pose PlanarEngine::canonical_pose(std::uint32_t slot) const {
  const Instance& instance = instances_[slot];
  if (!instance.moves) return {{instance.still->at.x, instance.still->at.y, instance.z_m}, instance.still->q};
  const RigidGroup& group = groups_[instance.groups[0]];
  const Vec2 p = group.p - rotate(group.heading, instance.plan->groups[0].com_H);
  return {{p.x, p.y, instance.z_m}, about_z(group.heading) * instance.tilt};
}

Pose PlanarEngine::pose(InstanceId id) const {
  return canonical_pose(id.index) * inverse(get(id).model->links[0].X_ML);
}

}  // namespace sandlot::planar
