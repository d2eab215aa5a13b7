#pragma once
/// Links that move as one: what fixed joints join becomes one body with the sum of the masses.
#include <array>
#include <cstdint>
#include <vector>

#include "base/result.h"
#include "model/model.h"

namespace sandlot::rigid {

/// Symmetric 3x3 matrix.
struct Symmetric3 {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  friend constexpr Vec3 operator*(const Symmetric3& m, Vec3 v) {
    return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.xz * v.x + m.yz * v.y + m.zz * v.z};
  }
  Symmetric3& operator+=(const Symmetric3& b);
};

/// R(q) m R(q)^T
Symmetric3 rotated(Quat q, const Symmetric3& m);
/// Inertia about a point at offset `r` from the centre of mass, minus that about the centre of mass.
Symmetric3 steiner(double mass_kg, Vec3 r_m);
/// Positive definite, and its smallest principal moment large enough to divide by.
bool is_positive_definite(const Symmetric3& m);

/// Links joined rigidly. Frame B: origin in the common centre of mass, axes of the first link.
struct RigidGroup {
  std::vector<std::uint32_t> links;  ///< ascending
  bool fixed = false;                ///< to the world: no mass, no motion
  double mass_kg = 0;
  Pose X_MB;
  Symmetric3 inertia_B;        ///< [kg m^2] about the centre of mass
  double gravity_mass_kg = 0;  ///< of the links that gravity pulls at
  Vec3 gravity_point_B;        ///< where it pulls
  bool has_rollers = false;    ///< their masses are in it: see wheels.h
  double spin_inertia = 0;     ///< [kg m^2] of all rollers: what the wheel lacks when all of them are awake
};

struct RigidGroups {
  std::vector<RigidGroup> groups;      ///< in the order of their first links
  std::vector<std::uint32_t> of_link;  ///< index into groups
};

/// Errors   a movable group whose mass or inertia is not positive, or too small or large to compute with, with the
///          place of its first link.
/// @param held  all links stand as if the model were static
Result<RigidGroups> group_links(const model::Model& model, bool held = false);
/// The errors that group_links() gives, for groups that have changed since.
Status check_masses(const model::Model& model, const RigidGroups& groups);

}  // namespace sandlot::rigid
