#pragma once
/// Rigid transforms. `X_AB` is the pose of frame B in frame A; X_AC = X_AB * X_BC.
#include "base/fields.h"
#include "geometry/vec3.h"

namespace sandlot {

struct Pose {
  Vec3 p;  ///< [m] position of B's origin in A
  Quat q;  ///< rotation of B in A

  friend constexpr bool operator==(const Pose&, const Pose&) = default;
  friend constexpr Pose operator*(const Pose& a, const Pose& b) {
    return {a.p + rotate(a.q, b.p), a.q * b.q};
  }
  /// Takes a point from B to A.
  friend constexpr Vec3 operator*(const Pose& a, Vec3 point) { return a.p + rotate(a.q, point); }

  static void fields(auto& s, auto&& visit) {
    visit(Field{"position", "m", "Position x y z."}, s.p);
    visit(Field{"orientation", "1", "Quaternion w x y z."}, s.q);
  }
};

constexpr Pose inverse(const Pose& X) {
  const Quat q = conjugate(X.q);
  return {rotate(q, -X.p), q};
}
inline bool is_finite(const Pose& X) {
  return is_finite(X.p) && std::isfinite(X.q.w) && std::isfinite(X.q.x) && std::isfinite(X.q.y) &&
         std::isfinite(X.q.z);
}
/// From SDF's `x y z roll pitch yaw`.
Pose pose_from_rpy(Vec3 p_m, Vec3 rpy_rad);

/// x y z roll pitch yaw.
std::span<const Component> components(const Pose& X);
double component(const Pose& X, std::size_t i);

/// Linear and angular velocity of a body in the world: v_WB_W (of the body's origin) and w_WB_W.
struct Velocity {
  Vec3 linear;   ///< [m/s]
  Vec3 angular;  ///< [rad/s]

  static void fields(auto& s, auto&& visit) {
    visit(Field{"linear", "m/s", "Velocity of the origin in the world."}, s.linear);
    visit(Field{"angular", "rad/s", "Angular velocity in the world."}, s.angular);
  }
};

}  // namespace sandlot
