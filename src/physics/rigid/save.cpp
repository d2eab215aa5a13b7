#include "base/check.h"
#include "physics/rigid/joints.h"
#include "physics/rigid/library.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/rigid/wheels.h"

namespace sandlot::rigid {
namespace {

// Beside the drive's: grips follow at the end, so that who holds nothing saves nothing of it.
constexpr std::uint8_t driven_flag = 1, grips_flag = 2;
// Flags of a body.
constexpr std::uint8_t awake_flag = 1, quick_flag = 2, pushed_flag = 4, frozen_flag = 8;

// Bytes of a snapshot may be forged. What these let through, the library computes with; all are false for NaN.
bool in_range(Vec3 v) { return dot(v, v) < 1e24; }
bool in_range(double x) { return std::abs(x) < 1e300; }
bool is_unit(Quat q) { return std::abs(norm(q) - 1) < 1e-6; }
/// Positions and velocities of joints, which follow from those of bodies.
bool is_joint_number(double x) { return std::abs(x) < 1e16; }

constexpr std::uint8_t motor_flag =
    4;  // in addition to the mode: the target brings damping, inertia or friction

void save_target(ByteWriter& w, const JointTarget& t) {
  const bool motor = t.damping > 0 || t.inertia > 0 || t.friction > 0;
  const auto flags = static_cast<std::uint8_t>(static_cast<std::uint8_t>(t.mode) | (motor ? motor_flag : 0));
  write(w, flags);
  if (t.mode == JointTarget::Mode::free) return;
  write(w, t.velocity);
  write(w, t.max_effort);
  write(w, t.effort);
  if (!(flags & motor_flag)) return;
  write(w, t.damping);
  write(w, t.inertia);
  write(w, t.friction);
}

bool load_target(ByteReader& r, JointTarget& t) {
  std::uint8_t mode = 0;
  read(r, mode);
  const bool motor = mode & motor_flag;
  mode &= static_cast<std::uint8_t>(~motor_flag);
  t = {.joint = t.joint, .mode = static_cast<JointTarget::Mode>(mode)};
  if (t.mode == JointTarget::Mode::free) return r.ok();
  read(r, t.velocity);
  read(r, t.max_effort);
  read(r, t.effort);
  if (motor) {
    read(r, t.damping);
    read(r, t.inertia);
    read(r, t.friction);
    for (const double x : {t.damping, t.inertia, t.friction})
      if (!(x == 0 || (x > 1e-100 && x < 1e100))) return false;
  }
  return r.ok() && mode <= static_cast<std::uint8_t>(JointTarget::Mode::effort) && in_range(t.velocity) &&
         in_range(t.max_effort) && in_range(t.effort);
}

}  // namespace

void RigidEngine::save(InstanceId id, ByteWriter& w) const {
  const Instance& instance = alive(id);
  write(w, static_cast<std::uint32_t>(instance.bodies.size()));
  write(w, static_cast<std::uint32_t>(instance.joints.size()));
  if (instance.bodies.empty() || instance.anchored) {
    write(w, instance.X_WM.p);
    write(w, instance.X_WM.q);
  }
  if (instance.guided) {
    write(w, instance.V_WM.linear);
    write(w, instance.V_WM.angular);
  }
  const bool holds = grips_of(instance) > 0;
  write(w, static_cast<std::uint8_t>((instance.drive.active ? driven_flag : 0) | (holds ? grips_flag : 0)));
  if (instance.drive.active) {
    write(w, instance.drive_link);
    const DriveTarget& d = instance.drive;
    for (const double x : {d.vx_mps, d.vy_mps, d.wz_radps, d.max_accel_mps2, d.max_angular_accel_radps2})
      write(w, x);
  }
  for (const Body& b : instance.bodies) {
    const bool pushed = b.force_N != Vec3{} || b.torque_Nm != Vec3{};
    write(w, static_cast<std::uint8_t>((b.awake ? awake_flag : 0) | (b.quick ? quick_flag : 0) |
                                       (pushed ? pushed_flag : 0) | (b.frozen ? frozen_flag : 0)));
    if (b.frozen) continue;
    write(w, b.p);
    write(w, b.q);
    write(w, b.v);
    write(w, b.w);
    write(w, b.quiet_s);
    if (!pushed) continue;
    write(w, b.force_N);
    write(w, b.torque_Nm);
  }
  for (const Wheel& wheel : instance.wheels) write(w, static_cast<std::uint8_t>(wheel.on_rollers));
  for (const Joint& j : instance.joints) {
    write(w, j.position);
    if (j.child && j.child->frozen) write(w, j.velocity);
    write(w, j.effort);
    save_target(w, j.target);
  }
  if (holds) save_grips(instance, w);
}

bool RigidEngine::load(InstanceId id, ByteReader& r) {
  library::prepare_thread();
  Instance& instance = alive(id);
  std::uint32_t bodies = 0, joints = 0;
  read(r, bodies);
  read(r, joints);
  if (!r.ok() || bodies != instance.bodies.size() || joints != instance.joints.size()) return false;
  if (instance.bodies.empty() || instance.anchored) {
    Pose X_WM;
    read(r, X_WM.p);
    read(r, X_WM.q);
    if (!r.ok() || !in_range(X_WM.p) || !is_unit(X_WM.q)) return false;
    place(instance, X_WM);
  }
  if (instance.guided) {
    read(r, instance.V_WM.linear);
    read(r, instance.V_WM.angular);
    if (!r.ok() || !in_range(instance.V_WM.linear) || !in_range(instance.V_WM.angular)) return false;
  }
  std::uint8_t driven = 0;
  read(r, driven);
  instance.drive = {.active = (driven & driven_flag) != 0};
  instance.drive_link = 0;
  if (instance.drive.active) {
    read(r, instance.drive_link);
    DriveTarget& d = instance.drive;
    for (double* x : {&d.vx_mps, &d.vy_mps, &d.wz_radps, &d.max_accel_mps2, &d.max_angular_accel_radps2}) {
      read(r, *x);
      if (!in_range(*x)) return false;
    }
    if (instance.drive_link >= instance.links.size() || d.max_accel_mps2 < 0 ||
        d.max_angular_accel_radps2 < 0)
      return false;
    d.base = instance.link_ids[instance.drive_link];
  }
  set_gyroscopic(instance);
  for (Body& b : instance.bodies) {
    std::uint8_t flags = 0;
    read(r, flags);
    b.awake = flags & awake_flag;
    b.quick = flags & quick_flag;
    b.frozen = flags & frozen_flag;
    if (b.frozen && !b.carrier) return false;
    if (b.frozen) {
      b.force_N = b.torque_Nm = {};
      continue;
    }
    read(r, b.p);
    read(r, b.q);
    read(r, b.v);
    read(r, b.w);
    read(r, b.quiet_s);
    b.force_N = b.torque_Nm = {};
    if (flags & pushed_flag) {
      read(r, b.force_N);
      read(r, b.torque_Nm);
    }
    // A run ends before a body is faster than the engine's settings allow.
    if (!r.ok() || !in_range(b.p) || !is_unit(b.q) || !(norm(b.v) <= 1.001 * spec_.max_speed_mps) ||
        !(norm(b.w) <= 1.001 * spec_.max_spin_radps) || !in_range(b.quiet_s) || !in_range(b.force_N) ||
        !in_range(b.torque_Nm))
      return false;
    put(b);
    dBodySetForce(b.ode, 0, 0, 0);
    dBodySetTorque(b.ode, 0, 0, 0);
  }
  for (Wheel& wheel : instance.wheels) {
    std::uint8_t on_rollers = 0;
    read(r, on_rollers);
    wheel.on_rollers = on_rollers != 0;
  }
  for (Joint& j : instance.joints) {
    const bool frozen = j.child && j.child->frozen;
    read(r, j.position);
    if (frozen) read(r, j.velocity);
    read(r, j.effort);
    if (!load_target(r, j.target) || !is_joint_number(j.position) || !is_joint_number(j.velocity) ||
        !in_range(j.effort))
      return false;
    set_motor(j);
    if (!frozen) measure_velocity(j, instance.X_WM);
  }
  for (Wheel& wheel : instance.wheels) {
    settle(wheel);
    follow(wheel);
  }
  show(instance);
  std::erase_if(grips_, [&](const Held& grip) { return grip.instance_b == &instance; });
  list_grips();
  return r.ok() && (!(driven & grips_flag) || load_grips(instance, r));
}

}  // namespace sandlot::rigid
