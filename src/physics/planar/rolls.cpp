// Wheels of an ideal drive that turn as the base moves: angles by multiplication, on demand.
#include <algorithm>

#include "base/check.h"
#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

bool same_target(const RollTarget& a, const RollTarget& b) {
  return a.base == b.base && a.per_vx == b.per_vx && a.per_vy == b.per_vy && a.per_wz == b.per_wz;
}

}  // namespace

void PlanarEngine::set_rolls(std::span<const RollTarget> targets) {
  for (const RollTarget& t : targets) {
    SL_CHECK(t.wheel.index < motors_.size());
    Motor& motor = motors_[t.wheel.index];
    SL_CHECK_MSG(t.wheel.generation == motor.generation, "no such joint");
    // Drives repeat themselves.
    if (motor.roll != none && same_target(rolls_[motor.roll].target, t)) continue;
    if (!drives_[motor.slot].active || motor.role == Motor::Role::constraint) continue;
    if (motor.roll != none) show(rolls_[motor.roll]);
    motor.target = {};
    set_roll(t.wheel.index, t, joint_states_[t.wheel.index].position);
    rolls_fresh_ = false;
  }
}

/// From the velocity of the base's origin in its frame to that of the centre of mass in the group's.
void PlanarEngine::relate(Roll& roll) const {
  const Instance& instance = instances_[roll.slot];
  const auto link = static_cast<std::size_t>(
      std::find(instance.bodies.begin(), instance.bodies.end(), roll.target.base) - instance.bodies.begin());
  SL_CHECK_MSG(link < instance.bodies.size(), "the base is not a body of the wheel's robot");
  const Pose& X_HB = instance.plan->X_HL[link];
  const Vec3 x = rotate(X_HB.q, {1, 0, 0}), y = rotate(X_HB.q, {0, 1, 0});
  const Vec2 arm = Vec2{X_HB.p.x, X_HB.p.y} - instance.plan->groups[0].com_H;
  roll.per_way = roll.target.per_vx * Vec2{x.x, x.y} + roll.target.per_vy * Vec2{y.x, y.y};
  roll.per_turn = roll.target.per_wz + dot(roll.per_way, left_of(arm));
}

void PlanarEngine::set_roll(std::uint32_t joint, const RollTarget& target, double position) {
  Motor& motor = motors_[joint];
  if (motor.roll == none) {
    motor.roll = static_cast<std::uint32_t>(rolls_.size());
    rolls_.emplace_back();
  }
  Roll& roll = rolls_[motor.roll];
  roll = {.target = target, .slot = motor.slot};
  relate(roll);
  const Drive& drive = drives_[roll.slot];
  roll.offset = position - dot(roll.per_way, drive.way_m) - roll.per_turn * drive.turned_rad;
}

/// The joint keeps the angle that it has, and a wheel on the ground its speed.
void PlanarEngine::end_roll(std::uint32_t joint) {
  const std::uint32_t at = motors_[joint].roll;
  if (at == none) return;
  show(rolls_[at]);
  Motor& motor = motors_[joint];
  motor.roll = none;
  if (motor.role == Motor::Role::kinematic && !motor.listed) motor.listed = true, turning_.push_back(joint);
  if (at + 1 < rolls_.size()) {
    rolls_[at] = rolls_.back();
    motors_[rolls_[at].target.wheel.index].roll = at;
  }
  rolls_.pop_back();
}

void PlanarEngine::show(const Roll& roll) const {
  const Drive& drive = drives_[roll.slot];
  const RigidGroup& group = groups_[instances_[roll.slot].groups[0]];
  JointState& joint = joint_states_[roll.target.wheel.index];
  joint.position = roll.offset + dot(roll.per_way, drive.way_m) + roll.per_turn * drive.turned_rad;
  joint.velocity = dot(roll.per_way, rotate_back(group.heading, group.v)) + roll.per_turn * group.w_radps;
  joint.effort = 0;
}

void PlanarEngine::refresh_rolls() const {
  if (rolls_fresh_.load(std::memory_order_acquire)) return;
  const std::lock_guard lock(refreshing_);
  if (rolls_fresh_.load(std::memory_order_relaxed)) return;
  for (const Roll& roll : rolls_) show(roll);
  rolls_fresh_.store(true, std::memory_order_release);
}

std::span<const JointState> PlanarEngine::joint_states() const {
  refresh_rolls();
  return joint_states_;
}

}  // namespace sandlot::planar
