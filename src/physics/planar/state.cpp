// Saved state of the planar engine's instances: everything that step() changes and targets that hold.
#include <algorithm>

#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

/// The fields of a saved part, visited alike by writing and reading.
template <class Visit>
void visit_group(auto& l, Visit&& visit) {
  visit(l.p.x), visit(l.p.y), visit(l.heading.c), visit(l.heading.s), visit(l.v.x), visit(l.v.y),
      visit(l.w_radps);
  visit(l.force_N.x), visit(l.force_N.y), visit(l.torque_Nm);
}
template <class Visit>
void visit_drive(auto& d, Visit&& visit) {
  visit(d.active), visit(d.link);
  visit(d.now.v_mps.x), visit(d.now.v_mps.y), visit(d.now.w_radps);
  visit(d.target.v_mps.x), visit(d.target.v_mps.y), visit(d.target.w_radps);
  visit(d.accel), visit(d.angular_accel);
  visit(d.way_m.x), visit(d.way_m.y), visit(d.turned_rad);
}
template <class Visit>
void visit_target(auto& t, Visit&& visit) {
  visit(t.velocity), visit(t.max_effort), visit(t.effort), visit(t.damping), visit(t.inertia),
      visit(t.friction);
}
template <class Visit>
void visit_roll(auto& r, Visit&& visit) {
  visit(r.target.per_vx), visit(r.target.per_vy), visit(r.target.per_wz), visit(r.offset);
}
template <class Visit>
void visit_constraint(auto& l, Visit&& visit) {
  visit(l.hold.x), visit(l.hold.y), visit(l.turn);
}
template <class Visit>
void visit_grip(auto& l, Visit&& visit) {
  visit(l.at_a.x), visit(l.at_a.y), visit(l.at_b.x), visit(l.at_b.y), visit(l.apart.c), visit(l.apart.s);
  visit_constraint(l, visit);
}

std::uint32_t link_of(const Instance& i, BodyId body) {
  return static_cast<std::uint32_t>(std::find(i.bodies.begin(), i.bodies.end(), body) - i.bodies.begin());
}

constexpr std::uint32_t rolling_mode = 3;  ///< in place of a motor's
constexpr std::uint32_t most_contact_points = 1u << 24;

// Bytes of a snapshot may be forged. What these let through, step() computes with; all are false for NaN.
bool in_range(double x) { return std::abs(x) < 1e150; }  // the square is finite
bool in_range(Vec2 v) { return dot(v, v) < 1e24; }
bool is_unit(Turn t) { return std::abs(t.c * t.c + t.s * t.s - 1) < 1e-6; }
/// An attitude is kept as the model gave it, so it need not have length 1.
bool is_rotation(Quat q) { return norm(q) > 1e-6 && norm(q) < 1e6; }

}  // namespace

void PlanarEngine::save(InstanceId id, ByteWriter& w) const {
  const Instance& instance = get(id);
  const auto put = [&](const auto& x) { write(w, x); };
  refresh_rolls();
  write(w, canonical_pose(id.index).q);  // of one that stands still; others have it in their groups
  write(w, instance.tilt);
  put(instance.z_m);
  const Vec2 still_at = instance.still ? instance.still->at : Vec2{};
  put(still_at.x), put(still_at.y);
  visit_drive(drives_[id.index], put);
  for (const std::uint32_t k : instance.groups) visit_group(groups_[k], put);
  for (const JointId joint : instance.joints) {
    const JointState& state = joint_states_[joint.index];
    put(state.position), put(state.velocity), put(state.effort);
    const Motor& motor = motors_[joint.index];
    if (motor.roll != none) {
      const Roll& roll = rolls_[motor.roll];
      put(rolling_mode);
      put(link_of(instance, roll.target.base));
      visit_roll(roll, put);
      continue;
    }
    put(static_cast<std::uint32_t>(motor.target.mode));
    visit_target(motor.target, put);
  }
  for (const Wheel& wheel : instance.wheels) put(wheel.impulse.x), put(wheel.impulse.y);
  for (const JointConstraint& l : instance.constraints) visit_constraint(l, put);
  save_contact_points(id.index, w);
}

bool PlanarEngine::load(InstanceId id, ByteReader& r) {
  get(id);
  Instance& instance = instances_[id.index];
  const auto take = [&](auto& x) {
    read(r, x);
    if (!in_range(static_cast<double>(x))) r.fail();
  };
  Quat q, tilt;
  Vec2 still_at;
  double z_m = 0;
  Drive drive;
  read(r, q);
  read(r, tilt);
  take(z_m), take(still_at.x), take(still_at.y);
  visit_drive(drive, take);
  if (!r.ok() || drive.link >= instance.bodies.size() || !is_rotation(q) || !is_rotation(tilt) ||
      !in_range(still_at) || !(std::abs(z_m) < 1e12) || drive.accel < 0 || drive.angular_accel < 0)
    return false;
  // Which groups, wheels and constraints there are follows from attitude and height, so these come first.
  instance.tilt = tilt;
  instance.z_m = z_m;
  if (instance.moves) {
    drives_[id.index] = drive;
    shape(id.index);
  } else {
    instance.still = std::make_unique<Instance::Still>(Instance::Still{.at = still_at, .q = q});
    walls_fresh_ = false;
  }
  std::vector<RigidGroup> groups(instance.groups.size());
  for (RigidGroup& l : groups) {
    visit_group(l, take);
    if (!r.ok() || !in_range(l.p) || !in_range(l.v) || !(std::abs(l.w_radps) < 1e12) || !is_unit(l.heading) ||
        !in_range(l.force_N))
      return false;
  }
  struct SavedJoint {
    JointState state;
    JointTarget target;
    Roll roll;
    bool rolls = false;
  };
  std::vector<SavedJoint> joints(instance.joints.size());
  for (auto& [state, target, roll, rolls] : joints) {
    std::uint32_t mode = 0;
    take(state.position), take(state.velocity), take(state.effort), take(mode);
    rolls = mode == rolling_mode;
    if (rolls) {
      std::uint32_t link = 0;
      take(link);
      visit_roll(roll, take);
      if (!r.ok() || link >= instance.bodies.size() || !drive.active || !instance.moves) return false;
      roll.target.base = instance.bodies[link];
      continue;
    }
    visit_target(target, take);
    if (!r.ok() || mode > 2 || target.damping < 0 || target.inertia < 0 || target.friction < 0) return false;
    target.mode = static_cast<JointTarget::Mode>(mode);
  }
  std::vector<Vec2> wheels(instance.wheels.size());
  for (Vec2& v : wheels) take(v.x), take(v.y);
  std::vector<JointConstraint> constraints(instance.constraints.size());
  for (JointConstraint& l : constraints) visit_constraint(l, take);
  if (!r.ok()) return false;

  for (std::size_t i = 0; i < groups.size(); ++i) {
    RigidGroup& to = groups_[instance.groups[i]];
    const RigidGroup& from = groups[i];
    to.p = from.p, to.heading = from.heading, to.v = from.v, to.w_radps = from.w_radps;
    to.force_N = from.force_N, to.torque_Nm = from.torque_Nm;
  }
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const JointId joint = instance.joints[i];
    Motor& motor = motors_[joint.index];
    end_roll(joint.index);
    joint_states_[joint.index] = joints[i].state;
    motor.target = joints[i].target;
    motor.target.joint = joint;
    if (joints[i].rolls) {
      joints[i].roll.target.wheel = joint;
      set_roll(joint.index, joints[i].roll.target, 0);
      rolls_[motor.roll].offset = joints[i].roll.offset;
    }
    if (motor.listed || motor.target.mode != JointTarget::Mode::velocity) continue;
    motor.listed = true;
    turning_.push_back(joint.index);
  }
  for (std::size_t i = 0; i < wheels.size(); ++i) instance.wheels[i].impulse = wheels[i];
  for (std::size_t i = 0; i < constraints.size(); ++i)
    instance.constraints[i].hold = constraints[i].hold, instance.constraints[i].turn = constraints[i].turn;
  for (const std::uint32_t k : instance.groups) { place_disc(k); }
  filed_ = ground_fresh_ = false;
  failure_.reset();
  explosion_ = {};
  stale();
  return load_contact_points(id.index, r);
}

/// Contacts and grips with instances that are older: each is saved once. Others are named by their place in
/// the order of creation, which a new engine with the same instances has too.
void PlanarEngine::save_contact_points(std::uint32_t slot, ByteWriter& w) const {
  const Instance& instance = instances_[slot];
  const auto rank = [&](std::uint64_t created) {
    const auto at = std::partition_point(order_.begin(), order_.end(),
                                         [&](std::uint32_t s) { return instances_[s].created < created; });
    return static_cast<std::uint32_t>(at - order_.begin());
  };
  const auto mine = [&](const ContactPoint& t) {
    return (t.key.pair & 0xffffffffu) == instance.created && (t.normal_Ns != 0 || t.tangent_Ns != 0);
  };
  write(w, static_cast<std::uint32_t>(std::count_if(contact_points_.begin(), contact_points_.end(), mine)));
  for (const ContactPoint& t : contact_points_) {
    if (!mine(t)) continue;
    write(w, rank(t.key.pair >> 32));
    for (const std::uint32_t x : {t.key.groups, t.key.part_a, t.key.part_b, t.key.feature}) write(w, x);
    write(w, t.normal_Ns);
    write(w, t.tangent_Ns);
  }
  const auto held = [&](const JointConstraint& l) { return body_slot_[l.body_b.index] == slot; };
  write(w, static_cast<std::uint32_t>(std::count_if(grips_.begin(), grips_.end(), held)));
  for (const JointConstraint& l : grips_) {
    if (!held(l)) continue;
    const Instance& other = instances_[body_slot_[l.body_a.index]];
    write(w, rank(other.created));
    write(w, link_of(other, l.body_a));
    write(w, link_of(instance, l.body_b));
    visit_grip(l, [&](const double& x) { write(w, x); });
  }
}

bool PlanarEngine::load_contact_points(std::uint32_t slot, ByteReader& r) {
  const Instance& instance = instances_[slot];
  std::erase_if(contact_points_,
                [&](const ContactPoint& t) { return (t.key.pair & 0xffffffffu) == instance.created; });
  std::erase_if(grips_, [&](const JointConstraint& l) { return body_slot_[l.body_b.index] == slot; });
  list_grips();
  std::uint32_t count = 0;
  read(r, count);
  if (!r.ok() || count > most_contact_points) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    ContactPoint t;
    std::uint32_t rank = 0;
    read(r, rank);
    for (std::uint32_t* x : {&t.key.groups, &t.key.part_a, &t.key.part_b, &t.key.feature}) read(r, *x);
    read(r, t.normal_Ns);
    read(r, t.tangent_Ns);
    if (!r.ok() || rank >= order_.size() || !in_range(t.normal_Ns) || !in_range(t.tangent_Ns)) return false;
    t.key.pair = instances_[order_[rank]].created << 32 | (instance.created & 0xffffffffu);
    contact_points_.push_back(t);
  }
  std::sort(contact_points_.begin(), contact_points_.end(),
            [](const ContactPoint& x, const ContactPoint& y) { return x.key < y.key; });
  read(r, count);
  if (!r.ok() || count > most_contact_points) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t rank = 0, link_a = 0, link_b = 0;
    read(r, rank);
    read(r, link_a);
    read(r, link_b);
    if (!r.ok() || rank >= order_.size()) return false;
    const Instance& other = instances_[order_[rank]];
    if (link_a >= other.bodies.size() || link_b >= instance.bodies.size()) return false;
    const GripTarget grip{other.bodies[link_a], instance.bodies[link_b]};
    set_grips({&grip, 1});
    for (JointConstraint& l : grips_)
      if (l.body_a == grip.a && l.body_b == grip.b) {
        visit_grip(l, [&](double& x) {
          read(r, x);
          if (!in_range(x)) r.fail();
        });
        if (!is_unit(l.apart)) r.fail();
      }
    if (!r.ok()) return false;
  }
  return r.ok();
}

}  // namespace sandlot::planar
