#include "physics/rigid/joints.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot::rigid {
namespace {

constexpr int limit_row = 0, spring_row = 1, friction_row = 2;  // of `extra`

bool has_spring(const Joint& j) { return j.decl->spring_stiffness > 0 || j.decl->damping > 0; }
bool has_friction(const Joint& j) { return j.decl->friction > 0; }

/// Pose of the joint frame as the child, or the parent, carries it.
Pose frame_on_child(const Joint& j, const Pose& X_WM) {
  return (j.child ? j.child->pose() : X_WM) * j.X_child;
}
Pose frame_on_parent(const Joint& j, const Pose& X_WM) {
  return (j.parent ? j.parent->pose() : X_WM) * j.X_parent;
}

/// ODE measures from its second body to its first. The first is the child, or the parent where the child is the world.
bool reversed(const Joint& j) { return !j.child; }
Body& first_body(const Joint& j) { return j.child ? *j.child : *j.parent; }
Body* second_body(const Joint& j) { return j.child ? j.parent : nullptr; }

/// In the first body, so that it turns with it.
Vec3 axis_W(const Joint& j) {
  const Pose& X = j.child ? j.X_child : j.X_parent;
  return rotate(first_body(j).q, rotate(X.q, j.decl->axis_J));
}

void set_row_motor(dJointID extra, bool turns, int row, double velocity, double max_effort, double cfm) {
  const int group = row * dParamGroup;
  const auto set = turns ? dJointSetAMotorParam : dJointSetLMotorParam;
  set(extra, group + dParamVel, velocity);
  set(extra, group + dParamFMax, max_effort);
  if (cfm >= 0) set(extra, group + dParamCFM, cfm);
}

/// Three rows about (or along) one axis: limit, spring, friction; each costs nothing until it is used.
dJointID make_rows(dWorldID world, const Joint& j, Vec3 axis, bool turns) {
  Body* const second = second_body(j);
  const dJointID rows = turns ? dJointCreateAMotor(world, nullptr) : dJointCreateLMotor(world, nullptr);
  dJointAttach(rows, first_body(j).ode, second ? second->ode : nullptr);
  if (turns) {
    dJointSetAMotorMode(rows, dAMotorUser);
    dJointSetAMotorNumAxes(rows, 3);
    for (int i = 0; i < 3; ++i) dJointSetAMotorAxis(rows, i, 1, axis.x, axis.y, axis.z);
  } else {
    dJointSetLMotorNumAxes(rows, 3);
    for (int i = 0; i < 3; ++i) dJointSetLMotorAxis(rows, i, 1, axis.x, axis.y, axis.z);
  }
  return rows;
}

void set_limits(dJointID joint, bool turns, double lower, double upper) {
  // Twice, because ODE refuses a low stop above the present high one.
  for (int i = 0; i < 2; ++i) {
    if (turns) {
      dJointSetAMotorParam(joint, dParamLoStop, lower);
      dJointSetAMotorParam(joint, dParamHiStop, upper);
    } else {
      dJointSetSliderParam(joint, dParamLoStop, lower);
      dJointSetSliderParam(joint, dParamHiStop, upper);
    }
  }
}

void make_ball(dWorldID world, Joint& j) {
  Body* const second = second_body(j);
  j.main = dJointCreateBall(world, nullptr);
  dJointAttach(j.main, first_body(j).ode, second ? second->ode : nullptr);
  const Pose X = first_body(j).pose() * (j.child ? j.X_child : j.X_parent);
  const auto make_motor = [&](double max_torque, double cfm) {
    const dJointID rows = dJointCreateAMotor(world, nullptr);
    dJointAttach(rows, first_body(j).ode, second ? second->ode : nullptr);
    dJointSetAMotorMode(rows, dAMotorUser);
    dJointSetAMotorNumAxes(rows, 3);
    const Vec3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; ++i) {
      const Vec3 a = rotate(X.q, axes[i]);
      dJointSetAMotorAxis(rows, i, 1, a.x, a.y, a.z);
      set_row_motor(rows, true, i, 0, max_torque, cfm);
    }
    return rows;
  };
  if (has_spring(j)) j.extra = make_motor(dInfinity, 1 / j.decl->damping);
  if (has_friction(j)) j.motor = make_motor(j.decl->friction, -1);
}

}  // namespace

void make_joint(dWorldID world, Joint& j) {
  if ((!j.child && !j.parent) || j.child == j.parent || j.decl->type == model::JointType::fixed) return;
  if (j.decl->type == model::JointType::ball) {
    make_ball(world, j);
    return anchor_joint(j, {});
  }
  const bool turns = j.turns();
  j.limited = j.decl->type != model::JointType::continuous && (j.decl->lower > -1e15 || j.decl->upper < 1e15);
  Body* const second = second_body(j);
  const Vec3 axis = reversed(j) ? -axis_W(j) : axis_W(j);
  j.main = turns ? dJointCreateHinge(world, nullptr) : dJointCreateSlider(world, nullptr);
  dJointAttach(j.main, first_body(j).ode, second ? second->ode : nullptr);
  j.feedback = std::make_unique<dJointFeedback>();
  if (!turns) j.motor = make_rows(world, j, axis, false);
  if ((turns && j.limited) || has_spring(j) || has_friction(j)) j.extra = make_rows(world, j, axis, turns);
  if (has_friction(j)) set_row_motor(j.extra, turns, friction_row, 0, j.decl->friction, -1);
  if (j.limited) set_limits(turns ? j.extra : j.main, turns, j.decl->lower, j.decl->upper);
  anchor_joint(j, {});
}

void anchor_joint(Joint& j, const Pose& X_WM) {
  if (!j.main) return;
  const Vec3 p = j.child ? frame_on_child(j, X_WM).p : frame_on_parent(j, X_WM).p;
  if (j.decl->type == model::JointType::ball) return dJointSetBallAnchor(j.main, p.x, p.y, p.z);
  const Vec3 a = reversed(j) ? -axis_W(j) : axis_W(j);
  if (j.turns()) {
    dJointSetHingeAnchor(j.main, p.x, p.y, p.z);
    dJointSetHingeAxis(j.main, a.x, a.y, a.z);
  } else {
    dJointSetSliderAxis(j.main, a.x, a.y, a.z);
  }
}

void destroy_joint(Joint& j) {
  for (const dJointID ode : {j.main, j.motor, j.extra})
    if (ode) dJointDestroy(ode);
  j.main = j.motor = j.extra = nullptr;
}

void set_motor(Joint& j) {
  if (!j.main || j.decl->type == model::JointType::ball) return;
  const bool driven = j.target.mode == JointTarget::Mode::velocity;
  const dJointID motor = j.turns() ? j.main : j.motor;
  const auto set = j.turns() ? dJointSetHingeParam : dJointSetLMotorParam;
  set(motor, dParamVel,
      driven ? std::clamp(j.target.velocity, -j.decl->max_velocity, j.decl->max_velocity) : 0);
  set(motor, dParamFMax, driven ? std::clamp(j.target.max_effort, 0.0, j.decl->max_effort) : 0);
  dJointSetFeedback(motor, driven ? j.feedback.get() : nullptr);
}

void prepare_joint(Joint& j, double h) {
  if (!j.main || j.decl->type == model::JointType::ball) return;
  const bool turns = j.turns();
  if (turns && j.limited) dJointSetAMotorAngle(j.extra, limit_row, j.position);
  if (has_spring(j)) {
    const double k = j.decl->spring_stiffness, stiffness = j.decl->damping + h * k;
    set_row_motor(j.extra, turns, spring_row, -k * (j.position - j.decl->spring_reference) / stiffness,
                  dInfinity, 1 / stiffness);
  }
  if (j.target.mode != JointTarget::Mode::effort) return;
  j.effort = std::clamp(j.target.effort, -j.decl->max_effort, j.decl->max_effort);
  const Vec3 along = j.effort * axis_W(j);
  const auto push = [&](Body* body, double sign) {
    if (!body) return;
    if (turns) {
      body->torque_Nm += sign * along;
    } else {
      // Both forces act at the child's joint origin: no couple arises.
      const Vec3 point = j.child ? j.child->pose() * j.X_child.p : j.parent->pose() * j.X_parent.p;
      body->force_N += sign * along;
      body->torque_Nm += cross(point - body->p, sign * along);
    }
  };
  push(j.child, 1);
  push(j.parent, -1);
}

void measure_effort(Joint& j) {
  if (j.target.mode == JointTarget::Mode::free) j.effort = 0;
  if (j.target.mode != JointTarget::Mode::velocity || !j.main || !j.feedback) return;
  const dJointFeedback& f = *j.feedback;
  const Vec3 axis = reversed(j) ? -axis_W(j) : axis_W(j);
  const Vec3 force{f.f1[0], f.f1[1], f.f1[2]};
  if (j.turns()) {
    // ODE gives the whole torque about the first body's centre; what the anchor's force makes of it is not the motor's.
    const Body& body = first_body(j);
    const Vec3 arm = rotate(body.q, (j.child ? j.X_child : j.X_parent).p);
    j.effort = dot(Vec3{f.t1[0], f.t1[1], f.t1[2]} - cross(arm, force), axis);
  } else {
    j.effort = dot(force, axis);
  }
}

namespace {

double velocity_about(const Joint& j, Vec3 axis, Vec3 point) {
  const auto side = [&](const Body* body) {
    if (!body) return 0.0;
    return dot(axis, j.turns() ? body->w : body->v + cross(body->w, point - body->p));
  };
  return side(j.child) - side(j.parent);
}

}  // namespace

void measure_velocity(Joint& j, const Pose& X_WM) {
  if (!j.main || j.decl->type == model::JointType::ball) return;
  j.velocity = velocity_about(j, axis_W(j), frame_on_child(j, X_WM).p);
}

void measure_position(Joint& j, double h, const Pose& X_WM) {
  if (!j.main || j.decl->type == model::JointType::ball) return;
  const Pose on_child = frame_on_child(j, X_WM), on_parent = frame_on_parent(j, X_WM);
  j.velocity = velocity_about(j, rotate(j.child ? on_child.q : on_parent.q, j.decl->axis_J), on_child.p);
  if (j.slides()) {
    j.position = dot(rotate(on_parent.q, j.decl->axis_J), on_child.p - on_parent.p);
    return;
  }
  const Quat turn = conjugate(on_parent.q) * on_child.q;
  const double angle = 2 * math::atan2(dot({turn.x, turn.y, turn.z}, j.decl->axis_J), turn.w);
  // The measured angle is exact but wrapped; the velocity says near which turn it must lie.
  const double expected = j.position + h * j.velocity;
  const double turns = std::floor((expected - angle) / math::tau + 0.5);
  j.position = angle + turns * math::tau;
}

}  // namespace sandlot::rigid
