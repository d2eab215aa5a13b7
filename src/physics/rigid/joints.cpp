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

/// ODE measures from its second body to its first. The first is the child, or the parent where the child is
/// the world.
bool reversed(const Joint& j) { return !j.child; }
Body& first_body(const Joint& j) { return j.child ? *j.child : *j.parent; }
Body* second_body(const Joint& j) { return j.child ? j.parent : nullptr; }

const Pose& model_pose(const Joint& j) { return first_body(j).instance->X_WM; }

/// In the first body, so that it turns with it; of a universal joint in the parent, of its second axis in the
/// child.
Vec3 axis_W(const Joint& j) {
  if (j.is(model::JointType::universal)) return rotate(frame_on_parent(j, model_pose(j)).q, j.decl->axis_J);
  const Pose& X = j.child ? j.X_child : j.X_parent;
  return rotate(first_body(j).q, rotate(X.q, j.decl->axis_J));
}
/// Exactly across the first.
Vec3 second_axis_J(const Joint& j) {
  const Vec3 first = j.decl->axis_J, second = j.decl->second->axis_J;
  return normalised(second - dot(first, second) * first);
}
/// Within half a turn.
double second_position(const Joint& j) {
  const Vec3 first = j.decl->axis_J, third = cross(first, second_axis_J(j));
  const Pose &X_WM = model_pose(j), on_child = frame_on_child(j, X_WM), on_parent = frame_on_parent(j, X_WM);
  const Vec3 in_child = rotate(conjugate(on_child.q) * on_parent.q, first);
  return math::atan2(dot(in_child, third), dot(in_child, first));
}

/// Any unit vector across a unit vector.
Vec3 second_to(Vec3 axis) {
  const Vec3 other = std::abs(axis.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalised(other - dot(other, axis) * axis);
}

void set_row_motor(dJointID extra, bool turns, int row, double velocity, double max_effort, double cfm) {
  const int group = row * dParamGroup;
  const auto set = turns ? dJointSetAMotorParam : dJointSetLMotorParam;
  set(extra, group + dParamVel, velocity);
  set(extra, group + dParamFMax, max_effort);
  if (cfm >= 0) set(extra, group + dParamCFM, cfm);
}

/// Which of ODE's two bodies carries an axis that is fixed in the child, or in the parent; 0: the world.
int carrier(const Joint& j, bool child) {
  if (child) return j.child ? 1 : 0;
  return !j.parent ? 0 : reversed(j) ? 1 : 2;
}

void aim_rows(dJointID rows, bool turns, Vec3 axis, int body) {
  const auto set = turns ? dJointSetAMotorAxis : dJointSetLMotorAxis;
  for (int i = 0; i < 3; ++i) set(rows, i, body, axis.x, axis.y, axis.z);
}

/// Three rows about (or along) one axis: limit, spring, friction; each costs nothing until it is used.
dJointID make_rows(dWorldID world, const Joint& j, Vec3 axis, bool turns, int body = 1) {
  Body* const second = second_body(j);
  const dJointID rows = turns ? dJointCreateAMotor(world, nullptr) : dJointCreateLMotor(world, nullptr);
  dJointAttach(rows, first_body(j).ode, second ? second->ode : nullptr);
  if (turns) {
    dJointSetAMotorMode(rows, dAMotorUser);
    dJointSetAMotorNumAxes(rows, 3);
  } else {
    dJointSetLMotorNumAxes(rows, 3);
  }
  aim_rows(rows, turns, axis, body);
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
  const int body = j.is(model::JointType::universal) ? carrier(j, false) : 1;
  switch (j.decl->type) {
    case model::JointType::universal: j.main = dJointCreateUniversal(world, nullptr); break;
    case model::JointType::screw: j.main = dJointCreatePiston(world, nullptr); break;
    case model::JointType::prismatic: j.main = dJointCreateSlider(world, nullptr); break;
    default: j.main = dJointCreateHinge(world, nullptr);
  }
  dJointAttach(j.main, first_body(j).ode, second ? second->ode : nullptr);
  j.feedback = std::make_unique<dJointFeedback>();
  if (!j.is_hinge()) j.motor = make_rows(world, j, axis, turns, body);
  if ((turns && j.limited) || has_spring(j) || has_friction(j))
    j.extra = make_rows(world, j, axis, turns, body);
  if (has_friction(j)) set_row_motor(j.extra, turns, friction_row, 0, j.decl->friction, -1);
  if (j.limited) set_limits(turns ? j.extra : j.main, turns, j.decl->lower, j.decl->upper);
  if (j.is(model::JointType::universal)) {
    const model::SecondAxis& other = *j.decl->second;
    j.second = make_rows(world, j, axis, true);
    if (other.lower > -1e15 || other.upper < 1e15) set_limits(j.second, true, other.lower, other.upper);
    if (other.damping > 0) set_row_motor(j.second, true, spring_row, 0, dInfinity, 1 / other.damping);
    if (other.friction > 0) set_row_motor(j.second, true, friction_row, 0, other.friction, -1);
  }
  anchor_joint(j, {});
}

void anchor_joint(Joint& j, const Pose& X_WM) {
  if (!j.main) return;
  const Vec3 p = j.child ? frame_on_child(j, X_WM).p : frame_on_parent(j, X_WM).p;
  if (j.decl->type == model::JointType::ball) return dJointSetBallAnchor(j.main, p.x, p.y, p.z);
  const Vec3 a = reversed(j) ? -axis_W(j) : axis_W(j);
  if (j.is(model::JointType::universal)) {
    // ODE's first axis is that of its first body.
    const Vec3 first = rotate(frame_on_parent(j, X_WM).q, j.decl->axis_J),
               second = rotate(frame_on_child(j, X_WM).q, second_axis_J(j));
    const Vec3 one = reversed(j) ? first : second, two = reversed(j) ? second : first;
    dJointSetUniversalAnchor(j.main, p.x, p.y, p.z);
    dJointSetUniversalAxis1(j.main, one.x, one.y, one.z);
    dJointSetUniversalAxis2(j.main, two.x, two.y, two.z);
    const double sign = reversed(j) ? -1 : 1;
    for (const dJointID rows : {j.motor, j.extra})
      if (rows) aim_rows(rows, true, sign * first, carrier(j, false));
    aim_rows(j.second, true, sign * second, carrier(j, true));
  } else if (j.is(model::JointType::screw)) {
    dJointSetPistonAnchor(j.main, p.x, p.y, p.z);
    dJointSetPistonAxis(j.main, a.x, a.y, a.z);
  } else if (j.turns()) {
    dJointSetHingeAnchor(j.main, p.x, p.y, p.z);
    dJointSetHingeAxis(j.main, a.x, a.y, a.z);
  } else {
    dJointSetSliderAxis(j.main, a.x, a.y, a.z);
  }
}

/// ODE has no joint with a thread. The friction row of a contact, without bound and without the contact's
/// normal force, is an equation between velocities at a point: with the point at radius c = pitch / (2 pi)
/// from the axis and the direction half along the axis, half round it, it is slide - c turn = 0.
void add_thread_row(dWorldID world, dJointGroupID group, Joint& j, double erp, double h) {
  const Pose &X_WM = model_pose(j), on_child = frame_on_child(j, X_WM), on_parent = frame_on_parent(j, X_WM);
  const Vec3 axis = axis_W(j), radial = rotate(on_parent.q, second_to(j.decl->axis_J));
  const double per_rad = j.decl->thread_pitch_m / math::tau;
  const double radius = std::abs(per_rad) > 1e-9 ? std::abs(per_rad) : 1;
  const double slope = -per_rad / radius, length = std::sqrt(1 + slope * slope);
  const Vec3 direction = (axis + slope * cross(axis, radial)) / length, at = on_parent.p + radius * radial;
  const double error = dot(axis, on_child.p - on_parent.p) - per_rad * j.position;
  const double wanted = -erp * error / h / length;
  dContact contact{};
  contact.surface.mode = dContactMu2 | dContactFDir1 | dContactMotion1 | dContactSoftCFM;
  contact.surface.mu = dInfinity;
  contact.surface.mu2 = 0;
  contact.surface.motion1 = reversed(j) ? -wanted : wanted;
  // The normal row carries next to nothing at this, and is not so soft that ODE loses its other rows in
  // rounding.
  contact.surface.soft_cfm = 1e3;
  for (std::size_t k = 0; k < 3; ++k) {
    contact.geom.pos[k] = at[k];
    contact.geom.normal[k] = radial[k];
    contact.fdir1[k] = direction[k];
  }
  Body* const second = second_body(j);
  j.thread_row = dJointCreateContact(world, group, &contact);
  dJointAttach(j.thread_row, first_body(j).ode, second ? second->ode : nullptr);
}

void add_friction_row(dWorldID world, dJointGroupID group, Joint& j) {
  Body* const second = second_body(j);
  const Vec3 axis = reversed(j) ? -axis_W(j) : axis_W(j);
  const bool turns = j.turns();
  j.friction_row = turns ? dJointCreateAMotor(world, group) : dJointCreateLMotor(world, group);
  dJointAttach(j.friction_row, first_body(j).ode, second ? second->ode : nullptr);
  if (turns) {
    dJointSetAMotorMode(j.friction_row, dAMotorUser);
    dJointSetAMotorNumAxes(j.friction_row, 1);
    dJointSetAMotorAxis(j.friction_row, 0, 0, axis.x, axis.y, axis.z);
  } else {
    dJointSetLMotorNumAxes(j.friction_row, 1);
    dJointSetLMotorAxis(j.friction_row, 0, 0, axis.x, axis.y, axis.z);
  }
  set_row_motor(j.friction_row, turns, 0, 0, j.target.friction, -1);
}

void destroy_joint(Joint& j) {
  for (const dJointID ode : {j.main, j.motor, j.extra, j.second})
    if (ode) dJointDestroy(ode);
  j.main = j.motor = j.extra = j.second = nullptr;
}

namespace {

/// A motor that brings damping or inertia of its own is a row, not a force.
bool has_slope(const Joint& j) {
  return j.target.mode == JointTarget::Mode::effort && (j.target.damping > 0 || j.target.inertia > 0);
}
bool is_driven(const Joint& j) {
  return j.leader || j.target.mode == JointTarget::Mode::velocity || has_slope(j);
}
dJointID motor_of(const Joint& j) { return j.is_hinge() ? j.main : j.motor; }

void set_motor_parameter(const Joint& j, int parameter, double value) {
  const auto set = j.is_hinge() ? dJointSetHingeParam
                   : j.turns()  ? dJointSetAMotorParam
                                : dJointSetLMotorParam;
  set(motor_of(j), parameter, value);
}

void run_motor(Joint& j, double velocity, double max_effort) {
  const dJointID motor = motor_of(j);
  set_motor_parameter(j, dParamVel, std::clamp(velocity, -j.decl->max_velocity, j.decl->max_velocity));
  set_motor_parameter(j, dParamFMax, max_effort);
  dJointSetFeedback(motor, is_driven(j) ? j.feedback.get() : nullptr);
}

}  // namespace

void set_motor(Joint& j) {
  if (!j.main || j.is(model::JointType::ball) || j.leader) return;
  const bool by_velocity = j.target.mode == JointTarget::Mode::velocity;
  run_motor(j, by_velocity ? j.target.velocity : 0,
            by_velocity ? std::clamp(j.target.max_effort, 0.0, j.decl->max_effort) : 0);
  if (j.soft_motor && !has_slope(j)) {
    set_motor_parameter(j, dParamCFM, dWorldGetCFM(dBodyGetWorld(first_body(j).ode)));
    j.soft_motor = false;
  }
}

void prepare_joint(Joint& j, double erp, double h) {
  j.pushed = 0;
  j.thread_row = j.friction_row = nullptr;
  if (!j.main || j.decl->type == model::JointType::ball) return;
  const bool turns = j.turns();
  if (turns && j.limited) dJointSetAMotorAngle(j.extra, limit_row, j.position);
  if (j.second) dJointSetAMotorAngle(j.second, limit_row, second_position(j));
  if (has_spring(j)) {
    const double k = j.decl->spring_stiffness, stiffness = j.decl->damping + h * k;
    set_row_motor(j.extra, turns, spring_row, -k * (j.position - j.decl->spring_reference) / stiffness,
                  dInfinity, 1 / stiffness);
  }
  if (j.leader) {
    const model::Mimic& mimic = *j.decl->mimic;
    const double wanted = mimic.multiplier * (j.leader->position - mimic.reference) + mimic.offset;
    const double effort = j.decl->max_effort < 1e15 ? j.decl->max_effort : dInfinity;
    return run_motor(j, mimic.multiplier * j.leader->velocity + erp * (wanted - j.position) / h, effort);
  }
  if (j.target.mode != JointTarget::Mode::effort) return;
  const double effort = std::clamp(j.target.effort, -j.decl->max_effort, j.decl->max_effort);
  if (has_slope(j)) {
    // The row is v = vel - cfm * effort, which is the motor's law solved for the velocity it ends with.
    const double slope = j.target.damping + j.target.inertia / h;
    set_motor_parameter(j, dParamVel, (effort + j.target.inertia / h * j.velocity) / slope);
    set_motor_parameter(j, dParamFMax, dInfinity);
    set_motor_parameter(j, dParamCFM, 1 / slope);
    j.soft_motor = true;
    return;
  }
  j.effort = j.pushed = effort;
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
  if (!is_driven(j) || !j.main || !j.feedback) return;
  const dJointFeedback& f = *j.feedback;
  const Vec3 axis = reversed(j) ? -axis_W(j) : axis_W(j);
  const Vec3 force{f.f1[0], f.f1[1], f.f1[2]};
  if (j.turns()) {
    // ODE gives the whole torque about the first body's centre; what the anchor's force makes of it is not
    // the motor's.
    const Body& body = first_body(j);
    const Vec3 arm = rotate(body.q, (j.child ? j.X_child : j.X_parent).p);
    j.effort = dot(Vec3{f.t1[0], f.t1[1], f.t1[2]} - cross(arm, force), axis);
  } else {
    j.effort = dot(force, axis);
  }
}

void watch_load(Joint& j) {
  if (!j.watched_rows) j.watched_rows = std::make_unique<std::array<dJointFeedback, 6>>();
  auto& rows = *j.watched_rows;
  rows.fill({});
  std::size_t next = 0;
  for (const dJointID ode : {j.main, j.motor, j.extra, j.second, j.thread_row, j.friction_row}) {
    dJointFeedback& row = rows[next++];
    if (ode && !dJointGetFeedback(ode)) dJointSetFeedback(ode, &row);
  }
}

void silence(Joint& j) {
  if (!j.watched_rows) return;
  const auto& rows = *j.watched_rows;
  // The last two live no longer than the sub-step.
  for (const dJointID ode : {j.main, j.motor, j.extra, j.second}) {
    const dJointFeedback* const feedback = ode ? dJointGetFeedback(ode) : nullptr;
    if (feedback >= rows.data() && feedback < rows.data() + rows.size()) dJointSetFeedback(ode, nullptr);
  }
}

Transmitted transmitted(const Joint& j) {
  Vec3 force, torque;  // on the first body, about its centre
  for (const dJointID ode : {j.main, j.motor, j.extra, j.second, j.thread_row, j.friction_row}) {
    if (!ode) continue;
    const dJointFeedback* const feedback = dJointGetFeedback(ode);
    if (!feedback) continue;
    force += Vec3{feedback->f1[0], feedback->f1[1], feedback->f1[2]};
    torque += Vec3{feedback->t1[0], feedback->t1[1], feedback->t1[2]};
  }
  const Body& body = first_body(j);
  const Vec3 point = (body.pose() * (j.child ? j.X_child : j.X_parent)).p;
  torque -= cross(point - body.p, force);
  if (reversed(j)) force = -force, torque = -torque;
  const Vec3 along = j.pushed * axis_W(j);
  (j.turns() ? torque : force) += along;
  return {point, force, torque};
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
  j.velocity = velocity_about(j, axis_W(j), on_child.p);
  if (j.slides()) {
    j.position = dot(rotate(on_parent.q, j.decl->axis_J), on_child.p - on_parent.p);
    return;
  }
  const Quat turn = conjugate(on_parent.q) * on_child.q;
  double angle = 0;
  if (j.is(model::JointType::universal)) {
    // The second axis turns about the first.
    const Vec3 second = second_axis_J(j), turned = rotate(turn, second);
    angle = math::atan2(dot(turned, cross(j.decl->axis_J, second)), dot(turned, second));
  } else {
    angle = 2 * math::atan2(dot({turn.x, turn.y, turn.z}, j.decl->axis_J), turn.w);
  }
  // The measured angle is exact but wrapped; the velocity determines near which turn it must lie.
  const double expected = j.position + h * j.velocity;
  const double turns = std::floor((expected - angle) / math::tau + 0.5);
  j.position = angle + turns * math::tau;
}

}  // namespace sandlot::rigid
