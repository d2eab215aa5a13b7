#include "physics/rigid/wheels.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot::rigid {
namespace {

constexpr double wake_beyond = 10 * math::pi / 180, freeze_beyond = 15 * math::pi / 180;
constexpr double thicker = 1.02;

Symmetric3 wheel_tensor(const model::Inertial& i) {
  return {i.moments.x, i.moments.y, i.moments.z, i.products.x, i.products.y, i.products.z};
}

/// Moment of inertia of a link about its joint's axis.
double spin_inertia(const model::Link& link, const model::Joint& joint) {
  const Vec3 axis = rotate_inverse(link.inertial.X_LCo.q, rotate(joint.X_CJ.q, joint.axis_J));
  return dot(axis, wheel_tensor(link.inertial) * axis);
}

void make_shapes(Wheel& wheel) {
  const model::RollerWheel& d = *wheel.decl;
  const math::SinCos a = math::sincos(d.angle_rad);
  wheel.roller_cos = a.cos, wheel.roller_sin = a.sin;
  const double across = 0.5 * d.roller_length_m * std::abs(a.cos) + d.roller_radius_m * std::abs(a.sin);
  const double half = across + 0.5 * (d.rows - 1) * d.row_spacing_m, r = d.radius_m;
  // As narrow as its rollers allow, but not so that it loses more than half of its radius to the sides.
  const double profile = std::max(half, half * half / r + 0.25 * r);
  wheel.probe = {thicker * r, 100 * std::max(r, half), 2 * thicker * half};
  wheel.solid.name = "wheel";
  wheel.solid.shape = Barrel{r, profile, 2 * half};
  wheel.solid.surface = d.surface;
  wheel.solid.X_LC = wheel.joint->decl->X_CJ * Pose{{}, quat_between({0, 0, 1}, wheel.joint->decl->axis_J)};
  const double extent = math::atan2(0.5 * d.roller_length_m * std::abs(a.sin), r - d.roller_radius_m);
  wheel.wake_cos = math::cos(std::min(math::pi, extent + wake_beyond));
  wheel.freeze_cos = math::cos(std::min(math::pi, extent + freeze_beyond));
}

}  // namespace

void lock_rollers(const model::Model& model, RigidGroups& groups) {
  for (const model::Joint& joint : model.joints) {
    if (joint.roller_of == model::Joint::no_joint) continue;
    RigidGroup& roller = groups.groups[groups.of_link[joint.child]];
    RigidGroup& wheel = groups.groups[groups.of_link[model.joints[joint.roller_of].child]];
    if (roller.fixed || wheel.fixed || &roller == &wheel || roller.links.size() > 1) continue;
    const model::Link& link = model.links[joint.child];
    const double mass = wheel.mass_kg + roller.mass_kg;
    const Vec3 apart_M = roller.X_MB.p - wheel.X_MB.p, shift_M = roller.mass_kg / mass * apart_M;
    // Each about the common centre of mass, in the wheel's axes.
    const Vec3 of_wheel = rotate_inverse(wheel.X_MB.q, shift_M),
               of_roller = rotate_inverse(wheel.X_MB.q, apart_M - shift_M);
    wheel.inertia_B += steiner(wheel.mass_kg, of_wheel);
    wheel.inertia_B += steiner(roller.mass_kg, of_roller);
    wheel.inertia_B += rotated(conjugate(wheel.X_MB.q) * roller.X_MB.q, roller.inertia_B);
    if (const double weight = wheel.gravity_mass_kg + roller.gravity_mass_kg; weight > 0) {
      const Vec3 point_M = wheel.X_MB * wheel.gravity_point_B;
      const Vec3 both_M = 1 / weight *
                          (wheel.gravity_mass_kg * point_M + roller.gravity_mass_kg * roller.X_MB.p);
      wheel.X_MB.p += shift_M;
      wheel.gravity_point_B = inverse(wheel.X_MB) * both_M;
      wheel.gravity_mass_kg = weight;
    } else {
      wheel.X_MB.p += shift_M;
    }
    wheel.mass_kg = mass;
    wheel.has_rollers = true;
    const double spin = spin_inertia(link, joint);
    roller.inertia_B = {spin, spin, spin, 0, 0, 0};
    wheel.spin_inertia += spin;
    roller.mass_kg *= awake_share;
    roller.gravity_mass_kg *= awake_share;
  }
}

void make_wheels(Instance& instance) {
  const auto& declared = instance.model->joints;
  const auto is_wheel = [&](std::size_t j) { return declared[j].rollers && instance.joints[j].child; };
  std::size_t count = 0;
  for (std::size_t j = 0; j < declared.size(); ++j) count += is_wheel(j) ? 1 : 0;
  instance.wheels.reserve(count);
  for (std::size_t j = 0; j < declared.size(); ++j) {
    if (!is_wheel(j)) continue;
    Wheel& wheel = instance.wheels.emplace_back();
    wheel.joint = &instance.joints[j];
    wheel.body = wheel.joint->child;
    wheel.decl = &*declared[j].rollers;
    wheel.link = declared[j].child;
    wheel.centre_B = wheel.joint->X_child.p;
    wheel.axis_B = rotate(wheel.joint->X_child.q, declared[j].axis_J);
    wheel.locked_B = wheel.body->inertia_B;
    const Pose X_BM = inverse(wheel.body->X_MB);
    for (std::size_t r = 0; r < declared.size(); ++r) {
      const Body* const body = instance.joints[r].child;
      if (declared[r].roller_of != j || !body || body == wheel.body || body->X_MB.p == wheel.body->X_MB.p)
        continue;
      Roller roller{
          instance.joints[r].child, &instance.joints[r], nullptr, declared[r].child, {}, {}, {}, {}};
      roller.X_BR = X_BM * roller.body->X_MB;
      roller.X_BR.q = normalised(roller.X_BR.q);
      roller.axis_R = rotate(roller.joint->X_child.q, declared[r].axis_J);
      const Vec3 out = roller.X_BR.p - wheel.centre_B;
      roller.out_B = normalised(out - dot(out, wheel.axis_B) * wheel.axis_B);
      roller.body->carrier = wheel.body;
      roller.body->frozen = true;
      wheel.spin_inertia = roller.body->inertia_B.xx;
      wheel.rollers.push_back(roller);
    }
    make_shapes(wheel);
    settle(wheel);
  }
  const auto is_roller = [](const Body* body) { return body && body->carrier; };
  instance.own_bodies = instance.bodies.size();
  while (instance.own_bodies > 0 && is_roller(&instance.bodies[instance.own_bodies - 1]))
    --instance.own_bodies;
  instance.own_joints = instance.joints.size();
  while (instance.own_joints > 0 && is_roller(instance.joints[instance.own_joints - 1].child))
    --instance.own_joints;
}

void settle(Wheel& wheel) {
  int awake = 0;
  for (Roller& roller : wheel.rollers) {
    awake += roller.body->frozen ? 0 : 1;
    if (roller.body->frozen && roller.body->enabled) {
      roller.body->enabled = false;
      dBodyDisable(roller.body->ode);
    }
    for (const dJointID ode : {roller.joint->main, roller.joint->extra}) {
      if (!ode) continue;
      if (roller.body->frozen) dJointDisable(ode);
      else dJointEnable(ode);
    }
  }
  wheel.rolling = awake > 0;
  Instance& instance = *wheel.body->instance;
  instance.rolling = std::any_of(instance.wheels.begin(), instance.wheels.end(),
                                 [](const Wheel& each) { return each.rolling; });
  Symmetric3& t = wheel.body->inertia_B;
  t = wheel.locked_B;
  t.xx -= awake * wheel.spin_inertia, t.yy -= awake * wheel.spin_inertia, t.zz -= awake * wheel.spin_inertia;
  dMass mass;
  dMassSetParameters(&mass, wheel.body->mass_kg, 0, 0, 0, t.xx, t.yy, t.zz, t.xy, t.xz, t.yz);
  dBodySetMass(wheel.body->ode, &mass);
}

namespace {

void follow_roller(const Wheel& wheel, Roller& roller) {
  const Body& carrier = *wheel.body;
  Body& body = *roller.body;
  Roller::Turn& half = roller.turn;
  if (const double position = roller.joint->position; position != half.position) {
    const math::SinCos now = math::sincos(0.5 * position);
    half = {position, now.sin, now.cos};
  }
  const Vec3 a = half.sin * roller.axis_R, arm = rotate(carrier.q, roller.X_BR.p);
  body.q = carrier.q * roller.X_BR.q * Quat{half.cos, a.x, a.y, a.z};
  body.p = carrier.p + arm;
  body.v = carrier.v + cross(carrier.w, arm);
  body.w = carrier.w + roller.joint->velocity * rotate(body.q, roller.axis_R);
}

}  // namespace

void follow(Wheel& wheel) {
  for (Roller& roller : wheel.rollers)
    if (roller.body->frozen) follow_roller(wheel, roller);
}

void roll_on(Wheel& wheel, double h) {
  for (Roller& roller : wheel.rollers) {
    if (!roller.body->frozen) continue;
    Joint& joint = *roller.joint;
    if (joint.velocity != 0) {
      const double slower = joint.decl->friction / wheel.spin_inertia * h, speed = std::abs(joint.velocity);
      if (slower > 0) joint.velocity *= speed > slower ? 1 - slower / speed : 0;
      joint.position += h * joint.velocity;
    }
    follow_roller(wheel, roller);
  }
}

void stop_frozen(Wheel& wheel) {
  for (Roller& roller : wheel.rollers)
    if (roller.body->frozen) roller.joint->velocity = 0;
}

void touch(Wheel& wheel, Vec3 point_W) {
  constexpr std::size_t most = 64;
  const Vec3 to = rotate_inverse(wheel.body->q, point_W - wheel.body->p) - wheel.centre_B;
  const Vec3 out = to - dot(to, wheel.axis_B) * wheel.axis_B;
  const double length = norm(out);
  if (length > 1e-3 * wheel.decl->radius_m && wheel.touched_B.size() < most)
    wheel.touched_B.push_back(out / length);
}

void choose_awake(Wheel& wheel) {
  bool changed = false;
  for (Roller& roller : wheel.rollers) {
    double best = -2;
    for (const Vec3& d : wheel.touched_B) best = std::max(best, dot(d, roller.out_B));
    Body& body = *roller.body;
    if (body.frozen ? best <= wheel.wake_cos : best >= wheel.freeze_cos) continue;
    changed = true;
    body.frozen = !body.frozen;
    roller.joint->effort = 0;
    body.force_N = body.torque_Nm = {};
    if (body.frozen) continue;
    follow_roller(wheel, roller);
    body.awake = wheel.body->awake;
    body.quick = wheel.body->quick;
    body.quiet_s = wheel.body->quiet_s;
    dBodySetPosition(body.ode, body.p.x, body.p.y, body.p.z);
    const dQuaternion q = {body.q.w, body.q.x, body.q.y, body.q.z};
    dBodySetQuaternion(body.ode, q);
    dBodySetLinearVel(body.ode, body.v.x, body.v.y, body.v.z);
    dBodySetAngularVel(body.ode, body.w.x, body.w.y, body.w.z);
    dBodySetForce(body.ode, 0, 0, 0);
    dBodySetTorque(body.ode, 0, 0, 0);
  }
  if (changed) settle(wheel);
}

Vec3 roller_axis_W(const Wheel& wheel, Vec3 point_W) {
  const Vec3 axis = rotate(wheel.body->q, wheel.axis_B);
  const Vec3 to = point_W - (wheel.body->p + rotate(wheel.body->q, wheel.centre_B));
  const Vec3 out = normalised(to - dot(to, axis) * axis);
  return wheel.roller_cos * axis + wheel.roller_sin * cross(out, axis);
}

}  // namespace sandlot::rigid
