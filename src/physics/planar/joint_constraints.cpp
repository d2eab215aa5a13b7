// Pivots and sliders between the groups of an instance, and grips between instances.
//
// Rows of sequential impulses with warm start: two that hold the anchor (a slider: across its axis and the
// angle), one along the joint's own freedom for each of spring with damping (implicit), motor, friction and
// limits. What is left of the anchor's error after the step is taken back by moving the bodies.
#include <algorithm>
#include <cmath>

#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

using Kind = JointPlan::Kind;

bool is_slider(const JointConstraint& l) { return l.plan && l.plan->kind == Kind::slider; }
bool is_pivot(const JointConstraint& l) { return l.plan && l.plan->kind == Kind::pivot; }

/// The turn from a's heading to b's beyond that of joint position 0, within half a turn [rad].
double turned(const RigidGroup* a, const RigidGroup* b, Turn apart) {
  const Turn ha = a ? a->heading : Turn{}, hb = b ? b->heading : Turn{};
  const Turn t = Turn{apart.c, -apart.s} * Turn{ha.c, -ha.s} * hb;
  return math::atan2(t.s, t.c);
}

struct Two {
  RigidGroup *a, *b;
  double inverse_kg() const { return (a ? a->inverse_kg : 0) + (b ? b->inverse_kg : 0); }
  double inverse_kgm2() const { return (a ? a->inverse_kgm2 : 0) + (b ? b->inverse_kgm2 : 0); }
  Vec2 apart(const JointConstraint& l) const {
    Vec2 v;
    if (b) v = v + b->velocity_at(l.arm_b);
    if (a) v = v - a->velocity_at(l.arm_a);
    return v;
  }
  double turning() const { return (b ? b->w_radps : 0) - (a ? a->w_radps : 0); }
  void push(const JointConstraint& l, Vec2 impulse) const {
    if (a) a->push(-1.0 * impulse, l.arm_a);
    if (b) b->push(impulse, l.arm_b);
  }
  void twist(double impulse) const {
    if (a) a->w_radps -= a->inverse_kgm2 * impulse;
    if (b) b->w_radps += b->inverse_kgm2 * impulse;
  }
  double response(const JointConstraint& l, Vec2 along) const {
    double k = inverse_kg();
    if (a) k += a->inverse_kgm2 * cross(l.arm_a, along) * cross(l.arm_a, along);
    if (b) k += b->inverse_kgm2 * cross(l.arm_b, along) * cross(l.arm_b, along);
    return k;
  }
};

Two two(std::vector<RigidGroup>& groups, const JointConstraint& l) {
  return {l.a == none ? nullptr : &groups[l.a], l.b == none ? nullptr : &groups[l.b]};
}

/// Impulse at the anchor that changes its velocity by `dv`.
Vec2 solve_point(const Two& t, const JointConstraint& l, Vec2 dv) {
  const double m = t.inverse_kg();
  double xx = m, xy = 0, yy = m;
  for (const auto& [group, arm] : {std::pair{t.a, l.arm_a}, std::pair{t.b, l.arm_b}}) {
    if (!group) continue;
    xx += group->inverse_kgm2 * arm.y * arm.y;
    xy -= group->inverse_kgm2 * arm.x * arm.y;
    yy += group->inverse_kgm2 * arm.x * arm.x;
  }
  const double det = xx * yy - xy * xy;
  if (!(det > 0)) return {};
  return {(yy * dv.x - xy * dv.y) / det, (xx * dv.y - xy * dv.x) / det};
}

void place_arms(const Two& t, JointConstraint& l) {
  l.arm_a = t.a ? rotate(t.a->heading, l.at_a) : Vec2{};
  l.arm_b = t.b ? rotate(t.b->heading, l.at_b) : Vec2{};
  if (!is_slider(l)) return;
  l.axis = t.a ? rotate(t.a->heading, l.axis_a) : l.axis_a;
  // The child's anchor slides along a; forces between them act there.
  l.arm_a = t.b->p + l.arm_b - t.a->p;
}

double rate(const Two& t, const JointConstraint& l) {
  return is_slider(l) ? dot(t.apart(l), l.axis) : l.plan->sign * t.turning();
}
double rate_response(const Two& t, const JointConstraint& l) {
  return is_slider(l) ? t.response(l, l.axis) : t.inverse_kgm2();
}
void push_rate(const Two& t, const JointConstraint& l, double impulse) {
  if (is_slider(l)) t.push(l, impulse * l.axis);
  else t.twist(l.plan->sign * impulse);
}

}  // namespace

void PlanarEngine::prepare_constraint(JointConstraint& l, double h_s) {
  const Two t = two(groups_, l);
  place_arms(t, l);
  if (is_slider(l)) {
    t.push(l, l.hold.x * left_of(l.axis));
    t.twist(l.turn);
  } else {
    t.push(l, l.hold);
    if (!l.plan) t.twist(l.turn);
  }
  l.motor = l.friction = l.spring = l.limit = 0;
  if (!l.plan) return;
  const Motor& motor = motors_[l.joint];
  l.rate_before = joint_states_[l.joint].velocity;
  if (motor.target.mode == JointTarget::Mode::effort)
    push_rate(t, l, h_s * std::clamp(motor.target.effort, -motor.joint->max_effort, motor.joint->max_effort));
}

void PlanarEngine::hold_constraint(JointConstraint& l, double h_s) {
  const Two t = two(groups_, l);
  if (l.plan) {
    const Motor& motor = motors_[l.joint];
    const JointState& joint = joint_states_[l.joint];
    const double k = rate_response(t, l);
    // Implicit: impulse = -h (stiffness (x - x0 + h v) + damping v) - inertia (v - v_before).
    const bool by_effort = motor.target.mode == JointTarget::Mode::effort;
    const double inertia = by_effort ? motor.target.inertia : 0;
    const double damping = motor.joint->damping + (by_effort ? motor.target.damping : 0);
    const double slope = h_s * (damping + h_s * motor.joint->spring_stiffness) + inertia;
    if (slope > 0) {
      const double offset = inertia * l.rate_before - h_s * motor.joint->spring_stiffness *
                                                          (joint.position - motor.joint->spring_reference);
      // The new sum s obeys s = offset - slope * (v + k (s - spring)).
      const double sum = (offset - slope * (rate(t, l) - k * l.spring)) / (1 + slope * k);
      push_rate(t, l, sum - l.spring);
      l.spring = sum;
    }
    if (motor.target.mode == JointTarget::Mode::velocity) {
      const double most = h_s * std::clamp(motor.target.max_effort, 0.0, motor.joint->max_effort);
      const double wanted = std::clamp(motor.target.velocity, -motor.max_velocity(), motor.max_velocity());
      const double sum = std::clamp(l.motor + (wanted - rate(t, l)) / k, -most, most);
      push_rate(t, l, sum - l.motor);
      l.motor = sum;
    }
    if (const double most = h_s * (motor.joint->friction + (by_effort ? motor.target.friction : 0));
        most > 0) {
      const double sum = std::clamp(l.friction - rate(t, l) / k, -most, most);
      push_rate(t, l, sum - l.friction);
      l.friction = sum;
    }
    if (motor.lower() > -1e15 || motor.upper() < 1e15) {
      // Within the step it may reach a limit, not pass it.
      const double low = (motor.lower() - joint.position) / h_s,
                   high = (motor.upper() - joint.position) / h_s;
      const double v = rate(t, l) - k * l.limit;  // without what the limit gave
      const double sum = v < low    ? (std::min(low, 1.0) - v) / k
                         : v > high ? (std::max(high, -1.0) - v) / k
                                    : 0;
      push_rate(t, l, sum - l.limit);
      l.limit = sum;
    }
  }
  if (is_slider(l)) {
    const double turn = -t.turning() / t.inverse_kgm2();
    t.twist(turn);
    l.turn += turn;
    const Vec2 across = left_of(l.axis);
    const double hold = -dot(t.apart(l), across) / t.response(l, across);
    t.push(l, hold * across);
    l.hold.x += hold;
    return;
  }
  if (!l.plan) {
    const double turn = -t.turning() / t.inverse_kgm2();
    t.twist(turn);
    l.turn += turn;
  }
  const Vec2 hold = solve_point(t, l, -1.0 * t.apart(l));
  t.push(l, hold);
  l.hold = l.hold + hold;
}

/// Moves both so that the anchor's error shrinks.
void PlanarEngine::take_back(JointConstraint& l) {
  const Two t = two(groups_, l);
  place_arms(t, l);
  const auto shift = [](RigidGroup* group, Vec2 impulse, Vec2 arm, double twist) {
    if (!group) return;
    group->p = group->p + group->inverse_kg * impulse;
    const double turn = group->inverse_kgm2 * (cross(arm, impulse) + twist);
    if (turn != 0) group->heading = tidied(group->heading * turn_of(turn));
  };
  if (!is_pivot(l)) {
    const double twist = -turned(t.a, t.b, l.apart) / t.inverse_kgm2();
    shift(t.a, {}, {}, -twist);
    shift(t.b, {}, {}, twist);
    place_arms(t, l);
  }
  Vec2 impulse;
  if (is_slider(l)) {
    const Vec2 across = left_of(l.axis);
    const Vec2 apart = t.b->p + l.arm_b - t.a->p - rotate(t.a->heading, l.at_a);
    impulse = (-dot(apart, across) / t.response(l, across)) * across;
  } else {
    const Vec2 at_a = t.a ? t.a->p + l.arm_a : l.at_a, at_b = t.b ? t.b->p + l.arm_b : l.at_b;
    impulse = solve_point(t, l, at_a - at_b);
  }
  shift(t.a, -1.0 * impulse, l.arm_a, 0);
  shift(t.b, impulse, l.arm_b, 0);
}

void PlanarEngine::finish_constraint(JointConstraint& l, double h_s) {
  if (!l.plan) return;
  const Two t = two(groups_, l);
  place_arms(t, l);
  const Motor& motor = motors_[l.joint];
  JointState& joint = joint_states_[l.joint];
  if (is_slider(l)) {
    joint.position = dot(t.b->p + l.arm_b - t.a->p - rotate(t.a->heading, l.at_a), l.axis);
  } else {
    // The angle within half a turn of what the last one has become.
    const double now = l.plan->sign * turned(t.a, t.b, l.apart);
    joint.position += math::wrap_angle(now - joint.position);
  }
  joint.velocity = rate(t, l);
  const JointTarget& target = motor.target;
  joint.effort = target.mode == JointTarget::Mode::velocity ? l.motor / h_s
                 : target.mode == JointTarget::Mode::effort
                     ? std::clamp(target.effort, -motor.joint->max_effort, motor.joint->max_effort) -
                           target.damping * joint.velocity -
                           target.inertia * (joint.velocity - l.rate_before) / h_s
                     : 0;
}

}  // namespace sandlot::planar
