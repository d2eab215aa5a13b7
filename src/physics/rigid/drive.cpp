#include "physics/rigid/drive.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot::rigid {

void push_drive(Instance& instance, Vec3 gravity, double h) {
  const Link& base = instance.links[instance.drive_link];
  if (!base.body) return;  // it stands on the world
  const DriveTarget& target = instance.drive;
  const Body& chassis = *base.body;
  const Quat q = chassis.q * base.X_BL.q;
  const Vec3 z = rotate(q, {0, 0, 1}), x = rotate(q, {1, 0, 0}), y = rotate(q, {0, 1, 0});
  const Vec3 arm = -rotate(chassis.q, base.X_BL.p);  // from the base's origin to the chassis' centre of mass

  // `ahead(a, v)`: v turned by a about z. Velocity of the origin as the last sub-step moved it: the chassis'
  // own, less what the turning of `arm` by w h took of it.
  const auto ahead = [&](double angle, Vec3 v) {
    const auto [s, c] = math::sincos(angle);
    return c * v + s * cross(z, v) + (1 - c) * dot(z, v) * z;
  };
  const double w = dot(chassis.w, z);
  const Vec3 v_origin = chassis.v - (arm - ahead(-w * h, arm)) / h;
  // In the frame that lies half the last turn behind: along these axes the last sub-step moved.
  const Vec3 v_behind = ahead(0.5 * w * h, v_origin);
  const double ux = dot(v_behind, x), uy = dot(v_behind, y);

  double dx = target.vx_mps - ux, dy = target.vy_mps - uy;
  const double change = std::sqrt(dx * dx + dy * dy), most = target.max_accel_mps2 * h;
  if (change > most) dx *= most / change, dy *= most / change;
  const double dw = std::clamp(target.wz_radps - w, -target.max_angular_accel_radps2 * h,
                               target.max_angular_accel_radps2 * h);
  const double w_new = w + dw;
  const Vec3 v_new = ahead(0.5 * w_new * h, (ux + dx) * x + (uy + dy) * y);

  // The chassis' centre moves so that the origin ends where it should; the other bodies follow as one with
  // it.
  const Vec3 dv_arm = v_new + (ahead(w_new * h, arm) - arm) / h - chassis.v;
  const Vec3 dv_chassis = dv_arm - dot(dv_arm, z) * z;
  const Vec3 weight = gravity - dot(gravity, z) * z;
  for (Body& body : instance.bodies) {
    if (body.frozen) continue;
    const Vec3 dv = dv_chassis + cross(dw * z, body.p - chassis.p);
    // A body that turns relative to the chassis (a wheel) has its axis carried round by the last turn.
    const Vec3 spin = body.w - chassis.w;
    const Vec3 dw_body = dw * z + (ahead(w * h, spin) - spin);
    body.force_N += body.mass_kg / h * dv - body.gravity_mass_kg * weight;
    body.torque_Nm += 1 / h * (rotated(body.q, body.inertia_B) * dw_body);
  }
}

}  // namespace sandlot::rigid
