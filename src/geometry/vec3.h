#pragma once
/// Vectors and quaternions as plain data.
///
/// Eigen's own types are not trivially copyable, so they cannot be State (a snapshot is a copy of bytes);
/// these are. Decompositions and anything larger than 3x3 go to Eigen.
#include <cmath>
#include <cstddef>

#include "base/fields.h"

namespace sandlot {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  static constexpr std::size_t extent = 3;
  constexpr double& operator[](std::size_t i) { return i == 0 ? x : i == 1 ? y : z; }
  constexpr const double& operator[](std::size_t i) const { return i == 0 ? x : i == 1 ? y : z; }

  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
  friend constexpr Vec3 operator*(Vec3 a, double s) { return s * a; }
  friend constexpr Vec3 operator/(Vec3 a, double s) { return {a.x / s, a.y / s, a.z / s}; }
  constexpr Vec3& operator+=(Vec3 b) { return *this = *this + b; }
  constexpr Vec3& operator-=(Vec3 b) { return *this = *this - b; }
};

constexpr double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(Vec3 a) { return std::sqrt(dot(a, a)); }
/// a / |a|, or `fallback` when a is too short to have a direction.
inline Vec3 normalised(Vec3 a, Vec3 fallback = {1, 0, 0}) {
  const double n = norm(a);
  return n > 1e-300 ? a / n : fallback;
}
inline bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// Unit quaternion, w first. Rotates vectors of the child frame into the parent frame.
struct Quat {
  double w = 1, x = 0, y = 0, z = 0;

  static constexpr std::size_t extent = 4;
  constexpr double& operator[](std::size_t i) { return i == 0 ? w : i == 1 ? x : i == 2 ? y : z; }
  constexpr const double& operator[](std::size_t i) const { return i == 0 ? w : i == 1 ? x : i == 2 ? y : z; }

  friend constexpr bool operator==(const Quat&, const Quat&) = default;
  friend constexpr Quat operator*(Quat a, Quat b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
};

constexpr Quat conjugate(Quat q) { return {q.w, -q.x, -q.y, -q.z}; }
inline double norm(Quat q) { return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z); }
inline Quat normalised(Quat q) {
  const double n = norm(q);
  return n > 1e-300 ? Quat{q.w / n, q.x / n, q.y / n, q.z / n} : Quat{};
}
/// R(q) v
constexpr Vec3 rotate(Quat q, Vec3 v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2.0 * cross(u, v);
  return v + q.w * t + cross(u, t);
}
constexpr Vec3 rotate_inverse(Quat q, Vec3 v) { return rotate(conjugate(q), v); }

/// Rotation by `rad` about the unit vector `axis`.
Quat quat_from_axis_angle(Vec3 axis, double rad);
/// Fixed-axis roll, pitch, yaw as in SDF and URDF: Rz(yaw) Ry(pitch) Rx(roll).
Quat quat_from_rpy(double roll_rad, double pitch_rad, double yaw_rad);
/// Inverse of quat_from_rpy; pitch in [-pi/2, pi/2]. Looking straight up or down, roll is 0.
Vec3 rpy_from_quat(Quat q);
/// Heading about world z of a body's x axis.
double yaw_of(Quat q);
/// Names of the components in addresses: x y z of a vector; w x y z and roll pitch yaw of a rotation.
std::span<const Component> components(const Vec3& v);
std::span<const Component> components(const Quat& q);
double component(const Vec3& v, std::size_t i);
double component(const Quat& q, std::size_t i);
/// The shortest rotation that takes unit vector `from` to unit vector `to`.
Quat quat_between(Vec3 from, Vec3 to);

}  // namespace sandlot
