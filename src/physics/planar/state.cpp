// What the planar engine saves of an instance: everything that step() changes and targets that hold.
#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

void write_all(ByteWriter& w, std::initializer_list<double> numbers) {
  for (const double x : numbers) write(w, x);
}
bool read_all(ByteReader& r, std::initializer_list<double*> numbers) {
  for (double* x : numbers) read(r, *x);
  return r.ok();
}

}  // namespace

void PlanarEngine::save(InstanceId id, ByteWriter& w) const {
  const Instance& instance = get(id);
  const Base& base = bases_[id.index];
  const Drive& drive = drives_[id.index];
  write(w, instance.tilt);
  write_all(w, {instance.z_m, base.p.x, base.p.y, base.heading.c, base.heading.s, base.v.x, base.v.y,
                base.w_radps});
  write(w, drive.active);
  write(w, drive.link);
  write_all(w, {drive.now.v_mps.x, drive.now.v_mps.y, drive.now.w_radps, drive.target.v_mps.x,
                drive.target.v_mps.y, drive.target.w_radps, drive.accel, drive.angular_accel});
  for (const JointId joint : instance.joints) {
    const JointState& state = joint_states_[joint.index];
    const Motor& motor = motors_[joint.index];
    write(w, motor.active);
    write_all(w, {state.position, state.velocity, state.effort, motor.velocity});
  }
}

bool PlanarEngine::load(InstanceId id, ByteReader& r) {
  get(id);
  Instance& instance = instances_[id.index];
  Quat tilt;
  double z_m = 0;
  Base base;
  Drive drive;
  read(r, tilt);
  read_all(
      r, {&z_m, &base.p.x, &base.p.y, &base.heading.c, &base.heading.s, &base.v.x, &base.v.y, &base.w_radps});
  read(r, drive.active);
  read(r, drive.link);
  read_all(r, {&drive.now.v_mps.x, &drive.now.v_mps.y, &drive.now.w_radps, &drive.target.v_mps.x,
               &drive.target.v_mps.y, &drive.target.w_radps, &drive.accel, &drive.angular_accel});
  if (!r.ok() || drive.link >= instance.bodies.size()) return false;
  for (const JointId joint : instance.joints) {
    JointState& state = joint_states_[joint.index];
    Motor& motor = motors_[joint.index];
    read(r, motor.active);
    read_all(r, {&state.position, &state.velocity, &state.effort, &motor.velocity});
  }
  if (!r.ok()) return false;
  instance.tilt = tilt;
  instance.z_m = z_m;
  bases_[id.index] = base;
  drives_[id.index] = drive;
  shape(id.index);
  return true;
}

}  // namespace sandlot::planar
