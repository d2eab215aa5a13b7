#include "geometry/vec3.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot {

Quat quat_from_axis_angle(Vec3 axis, double rad) {
  const auto [s, c] = math::sincos(0.5 * rad);
  return {c, s * axis.x, s * axis.y, s * axis.z};
}

Quat quat_from_rpy(double roll_rad, double pitch_rad, double yaw_rad) {
  const auto [sr, cr] = math::sincos(0.5 * roll_rad);
  const auto [sp, cp] = math::sincos(0.5 * pitch_rad);
  const auto [sy, cy] = math::sincos(0.5 * yaw_rad);
  return {cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
          cr * cp * sy - sr * sp * cy};
}

Vec3 rpy_from_quat(Quat q) {
  const double up = 2 * (q.w * q.y - q.z * q.x);  // sin(pitch)
  const double c_r = 1 - 2 * (q.x * q.x + q.y * q.y), s_r = 2 * (q.w * q.x + q.y * q.z);
  const double level = std::sqrt(c_r * c_r + s_r * s_r);  // cos(pitch)
  // Straight up or down, only the sum or difference of roll and yaw is defined: all of it is called yaw.
  if (level < 1.5e-8)
    return {0, up > 0 ? math::pi / 2 : -math::pi / 2, math::wrap_angle(2 * math::atan2(q.z, q.w))};
  return {math::atan2(s_r, c_r), math::atan2(up, level), yaw_of(q)};
}

double yaw_of(Quat q) { return math::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z)); }

std::span<const Component> components(const Vec3&) {
  static constexpr Component names[] = {{"x", ""}, {"y", ""}, {"z", ""}};
  return names;
}
std::span<const Component> components(const Quat&) {
  static constexpr Component names[] = {{"w", ""},       {"x", ""},        {"y", ""},     {"z", ""},
                                        {"roll", "rad"}, {"pitch", "rad"}, {"yaw", "rad"}};
  return names;
}
double component(const Vec3& v, std::size_t i) { return v[i]; }
double component(const Quat& q, std::size_t i) { return i < 4 ? q[i] : rpy_from_quat(q)[i - 4]; }

Quat quat_between(Vec3 from, Vec3 to) {
  const double d = dot(from, to);
  if (d < -1 + 1e-12) {  // opposite: any perpendicular axis will do
    const Vec3 axis = normalised(std::abs(from.x) < 0.9 ? cross(from, {1, 0, 0}) : cross(from, {0, 1, 0}));
    return {0, axis.x, axis.y, axis.z};
  }
  const Vec3 c = cross(from, to);
  return normalised(Quat{1 + d, c.x, c.y, c.z});
}

}  // namespace sandlot
