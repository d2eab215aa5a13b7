// Wheels on the ground.
//
// A wheel of radius r on an axle `a` (unit, level) that spins at s rolls along e = a x z. Where it touches
// the ground the slip is
//
//   u = v + w x arm - r s e          along e and along a;  with rollers along the roller's axis g alone: u . g
//
// (less the velocity of a belt below) and the ground answers with an impulse j, |j| <= mu N h: the one that
// makes u vanish, or on the cone against the u that is left. For one wheel this is exact: (K + x I) j = -u
// with K what velocity an impulse brings, x = 0 for a wheel that grips, else the x that puts j on the cone
// (J. More, D. Sorensen, Computing a trust region step, 1983). The spin is eliminated: it follows from j and
// the motor, damping and friction of its axle, all acting on the spin at the end of the step. The wheels of a
// robot, and its contacts, are passed over until they agree.
//
// Directions are those half way through the step; the impulses of the last step are put in along those at its
// beginning, half way between the old and the new directions. So a robot in a bend keeps its speed.
#include <algorithm>
#include <cmath>

#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

constexpr double kept = 0.9;  ///< from step to step, of the part of the impulses that moves nothing

/// Wheels that work against each other without moving anything would do so for ever, and near the cone it
/// takes many passes to agree on such. So it fades: of all impulses with the same sum and moment, those with
/// the least squares come in by a little.
void ease(std::span<Wheel> wheels) {
  // G x = b for the sum and the moment b, G the sum of d d^T over all directions d = (x, y, moment); then j =
  // d . x.
  double G[3][3] = {}, b[3] = {};
  const auto each = [&](auto&& visit) {
    for (Wheel& w : wheels) {
      visit(w.now->ahead, w.now->arm, w.impulse.x);
      if (!(w.plan && w.plan->rollers)) visit(w.now->across, w.now->arm, w.impulse.y);
    }
  };
  each([&](Vec2 along, Vec2 arm, double& j) {
    const double d[] = {along.x, along.y, cross(arm, along)};
    for (int r = 0; r < 3; ++r) {
      b[r] += j * d[r];
      for (int c = 0; c < 3; ++c) G[r][c] += d[r] * d[c];
    }
  });
  double x[3];
  const double minor0 = G[1][1] * G[2][2] - G[1][2] * G[2][1], minor1 = G[1][0] * G[2][2] - G[1][2] * G[2][0],
               minor2 = G[1][0] * G[2][1] - G[1][1] * G[2][0];
  const double det = G[0][0] * minor0 - G[0][1] * minor1 + G[0][2] * minor2;
  if (!(det > 1e-9 * G[0][0] * G[1][1] * G[2][2])) return;
  for (int c = 0; c < 3; ++c) {
    double M[3][3];
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) M[r][k] = k == c ? b[r] : G[r][k];
    x[c] = (M[0][0] * (M[1][1] * M[2][2] - M[1][2] * M[2][1]) -
            M[0][1] * (M[1][0] * M[2][2] - M[1][2] * M[2][0]) +
            M[0][2] * (M[1][0] * M[2][1] - M[1][1] * M[2][0])) /
           det;
  }
  each([&](Vec2 along, Vec2 arm, double& j) {
    j = kept * j + (1 - kept) * (along.x * x[0] + along.y * x[1] + cross(arm, along) * x[2]);
  });
}

struct Spin {
  double radps = 0;
  double per_impulse = 0;  ///< what it gains per angular impulse: 0 while motor or friction hold it
};

/// The spin after the step when the ground gives `impulse`: slope * s = start + impulse + motor + friction,
/// where the motor gives at most so much towards the speed it wants, and friction towards rest.
Spin spin_after(Wheel::Axle& axle, double impulse) {
  const double x = axle.start + impulse;
  const auto friction_at = [&](double s) { return s > 0 ? -axle.friction : s < 0 ? axle.friction : 0.0; };
  if (axle.motor > 0) {
    axle.thrust = axle.slope * axle.wanted_radps - x - friction_at(axle.wanted_radps);
    if (std::abs(axle.thrust) <= axle.motor + (axle.wanted_radps == 0 ? axle.friction : 0)) {
      axle.thrust = std::clamp(axle.thrust, -axle.motor, axle.motor);
      return {axle.wanted_radps, 0};
    }
    axle.thrust = std::copysign(axle.motor, axle.thrust);
  } else {
    axle.thrust = 0;
  }
  const double pushed = x + axle.thrust;
  if (std::abs(pushed) <= axle.friction) return {0, 0};
  return {(pushed - std::copysign(axle.friction, pushed)) / axle.slope, 1 / axle.slope};
}

/// Effect of a joint's motor, damping, friction and spring on an axle in this step.
Wheel::Axle axle_of(const Motor& motor, const JointState& state, double inertia, double h_s) {
  const JointTarget& t = motor.target;
  Wheel::Axle axle;
  double damping = motor.joint->damping;
  axle.friction = h_s * motor.joint->friction;
  if (t.mode == JointTarget::Mode::velocity) {
    axle.wanted_radps = std::clamp(t.velocity, -motor.max_velocity(), motor.max_velocity());
    axle.motor = h_s * std::clamp(t.max_effort, 0.0, motor.joint->max_effort);
  } else if (t.mode == JointTarget::Mode::effort) {
    inertia += t.inertia;
    damping += t.damping;
    axle.friction += h_s * t.friction;
    axle.start = h_s * std::clamp(t.effort, -motor.joint->max_effort, motor.joint->max_effort);
  }
  axle.start += inertia * state.velocity -
                h_s * motor.joint->spring_stiffness * (state.position - motor.joint->spring_reference);
  axle.slope = std::max(inertia + h_s * (damping + h_s * motor.joint->spring_stiffness), 1e-12);
  return axle;
}

/// Motor's part of the joint's state.
double effort_of(const JointTarget& t, const Motor& motor, double thrust, double before, double after,
                 double h_s) {
  if (t.mode == JointTarget::Mode::velocity) return thrust / h_s;
  if (t.mode != JointTarget::Mode::effort) return 0;
  return std::clamp(t.effort, -motor.joint->max_effort, motor.joint->max_effort) - t.damping * after -
         t.inertia * (after - before) / h_s;
}

}  // namespace

void PlanarEngine::steer(std::uint32_t slot, double h_s) {
  for (const Wheel& wheel : instances_[slot].wheels) {
    if (wheel.steering == none) continue;
    const Motor& motor = motors_[wheel.steering];
    JointState& joint = joint_states_[wheel.steering];
    Wheel::Axle axle = axle_of(motor, joint, wheel.plan->steering_kgm2, h_s);
    const double before = joint.velocity, at = joint.position;
    joint.velocity = spin_after(axle, 0).radps;
    joint.effort = effort_of(motor.target, motor, axle.thrust, before, joint.velocity, h_s);
    const double goal = at + h_s * joint.velocity;
    joint.position = std::clamp(goal, std::min(motor.lower(), at), std::max(motor.upper(), at));
    if (joint.position != goal) joint.velocity = (joint.position - at) / h_s;
  }
}

void PlanarEngine::prepare_wheels(std::uint32_t slot, double h_s) {
  Instance& instance = instances_[slot];
  if (instance.wheels.empty() || drives_[slot].active) return;
  steer(slot, h_s);
  for (Wheel& wheel : instance.wheels) {
    RigidGroup& group = groups_[wheel.group];
    Vec2 at = wheel.at, ahead{1, 0}, across{0, 1};
    if (!wheel.now) wheel.now = std::make_unique<Wheel::Now>();
    wheel.now->roll_m = 0;
    if (wheel.plan) {
      const WheelPlan& plan = *wheel.plan;
      Turn steered;
      if (wheel.steering != none) {
        steered = turn_of(plan.steering_sign * joint_states_[wheel.steering].position);
        at = plan.steering_at + rotate(steered, at - plan.steering_at);
      }
      const Vec2 forward{plan.axle.y, -plan.axle.x};
      across = rotate(steered, plan.axle);
      ahead = rotate(steered, plan.rollers ? plan.grip : forward);
      wheel.now->roll_m = plan.radius_m * (plan.rollers ? dot(plan.grip, forward) : 1);
      wheel.now->axle = axle_of(motors_[wheel.joint], joint_states_[wheel.joint], plan.inertia_kgm2, h_s);
      wheel.now->axle.friction += h_s * wheel.rolling_Nm;
    }
    if (wheel.plan && wheel.plan->rollers) wheel.impulse.y = 0;
    const double size = std::sqrt(dot(wheel.impulse, wheel.impulse)), most = h_s * wheel.limit_N;
    if (size > most) wheel.impulse = (most / size) * wheel.impulse;
    wheel.now->ahead = rotate(group.heading, ahead);
    wheel.now->across = rotate(group.heading, across);
    wheel.now->arm = rotate(group.heading, at);
  }
  const bool one = std::all_of(instance.wheels.begin(), instance.wheels.end(),
                               [&](const Wheel& w) { return w.group == instance.wheels[0].group; });
  if (one) ease(instance.wheels);
  Turn half;
  std::uint32_t of = none;
  for (Wheel& wheel : instance.wheels) {
    RigidGroup& group = groups_[wheel.group];
    // The turn of half a step, by the rate before any of this group's wheels have pushed.
    if (wheel.group != of) half = turn_of(0.5 * h_s * group.w_radps), of = wheel.group;
    group.push(wheel.impulse.x * wheel.now->ahead + wheel.impulse.y * wheel.now->across, wheel.now->arm);
    wheel.now->ahead = rotate(half, wheel.now->ahead);
    wheel.now->across = rotate(half, wheel.now->across);
    wheel.now->arm = rotate(half, wheel.now->arm);
    const double a = cross(wheel.now->arm, wheel.now->ahead), c = cross(wheel.now->arm, wheel.now->across);
    wheel.now->k_aa = group.inverse_kg + group.inverse_kgm2 * a * a;
    wheel.now->k_ac = wheel.plan && wheel.plan->rollers ? 0 : group.inverse_kgm2 * a * c;
    wheel.now->k_cc = group.inverse_kg + group.inverse_kgm2 * c * c;
  }
}

/// One pass over the wheels. @return the largest change of velocity
double PlanarEngine::turn_wheels(std::uint32_t slot, double h_s) {
  Instance& instance = instances_[slot];
  if (drives_[slot].active) return 0;
  double change = 0;
  for (Wheel& wheel : instance.wheels) {
    const double most = h_s * wheel.limit_N;
    if (!(most > 0)) continue;
    RigidGroup& group = groups_[wheel.group];
    const bool one_way = wheel.plan && wheel.plan->rollers;
    const Vec2 v = group.velocity_at(wheel.now->arm) - wheel.belt_mps, before = wheel.impulse;
    const double va = dot(v, wheel.now->ahead), vc = one_way ? 0 : dot(v, wheel.now->across);
    Vec2 j = before;
    double held = -1;
    for (int i = 0; i < 6; ++i) {
      const Spin spin = wheel.plan ? spin_after(wheel.now->axle, -wheel.now->roll_m * j.x) : Spin{};
      if (spin.per_impulse == held && i > 1) break;
      held = spin.per_impulse;
      const Vec2 d = j - before;
      const Vec2 u{va + wheel.now->k_aa * d.x + wheel.now->k_ac * d.y - wheel.now->roll_m * spin.radps,
                   one_way ? 0 : vc + wheel.now->k_ac * d.x + wheel.now->k_cc * d.y};
      const double kaa = wheel.now->k_aa + wheel.now->roll_m * wheel.now->roll_m * held,
                   kac = wheel.now->k_ac, kcc = wheel.now->k_cc;
      if (one_way) {
        j.x = std::clamp(j.x - u.x / kaa, -most, most);
        continue;
      }
      // u at j = 0, and from there the j on the cone.
      const Vec2 u0 = u - Vec2{kaa * j.x + kac * j.y, kac * j.x + kcc * j.y};
      double x = 0;
      for (int n = 0; n < 20; ++n) {
        const double a = kaa + x, c = kcc + x, det = a * c - kac * kac;
        j = {(kac * u0.y - c * u0.x) / det, (kac * u0.x - a * u0.y) / det};
        const double square = dot(j, j), size = std::sqrt(square);
        if (size <= most * (x > 0 ? 1 + 1e-12 : 1)) break;
        const double weighted = (c * j.x * j.x - 2 * kac * j.x * j.y + a * j.y * j.y) / det;
        x += square / weighted * (size - most) / most;
      }
    }
    const Vec2 d = j - before;
    wheel.impulse = j;
    group.push(d.x * wheel.now->ahead + d.y * wheel.now->across, wheel.now->arm);
    change = std::max({change, std::abs(d.x) * wheel.now->k_aa, std::abs(d.y) * wheel.now->k_cc});
  }
  return change;
}

void PlanarEngine::finish_wheels(std::uint32_t slot, double h_s) {
  if (drives_[slot].active) return;
  for (Wheel& wheel : instances_[slot].wheels) {
    if (!wheel.plan) continue;
    JointState& joint = joint_states_[wheel.joint];
    const double before = joint.velocity;
    joint.velocity = spin_after(wheel.now->axle, -wheel.now->roll_m * wheel.impulse.x).radps;
    joint.position += h_s * joint.velocity;
    const Motor& motor = motors_[wheel.joint];
    joint.effort = effort_of(motor.target, motor, wheel.now->axle.thrust, before, joint.velocity, h_s);
  }
}

}  // namespace sandlot::planar
