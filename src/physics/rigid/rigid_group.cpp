#include "physics/rigid/rigid_group.h"

#include <limits>
#include <numeric>

namespace sandlot::rigid {
namespace {

// Beyond these the library divides by what is next to nothing, and the first step ends with an infinite velocity.
constexpr double least_mass_kg = 1e-40, most_mass_kg = 1e40, least_inertia_kgm2 = 1e-40;
/// Of a decomposition of a tensor of inertia, relative to its diagonal: some hundred roundings.
constexpr double least_pivot = 1e-13;

}  // namespace

Symmetric3& Symmetric3::operator+=(const Symmetric3& b) {
  xx += b.xx, yy += b.yy, zz += b.zz, xy += b.xy, xz += b.xz, yz += b.yz;
  return *this;
}

Symmetric3 rotated(Quat q, const Symmetric3& m) {
  // Column i of M R^T is M times row i of R, which is R^T e_i; R then turns the columns.
  const Vec3 c0 = rotate(q, m * rotate_inverse(q, {1, 0, 0}));
  const Vec3 c1 = rotate(q, m * rotate_inverse(q, {0, 1, 0}));
  const Vec3 c2 = rotate(q, m * rotate_inverse(q, {0, 0, 1}));
  return {c0.x, c1.y, c2.z, 0.5 * (c0.y + c1.x), 0.5 * (c0.z + c2.x), 0.5 * (c1.z + c2.y)};
}

Symmetric3 steiner(double m, Vec3 r) {
  return {m * (r.y * r.y + r.z * r.z),
          m * (r.x * r.x + r.z * r.z),
          m * (r.x * r.x + r.y * r.y),
          -m * r.x * r.y,
          -m * r.x * r.z,
          -m * r.y * r.z};
}

bool is_positive_definite(const Symmetric3& m) {
  // Sylvester: all leading minors positive. NaN fails every comparison.
  const double minor2 = m.xx * m.yy - m.xy * m.xy;
  const double det = m.zz * minor2 - m.xx * m.yz * m.yz - m.yy * m.xz * m.xz + 2 * m.xy * m.xz * m.yz;
  const double trace = m.xx + m.yy + m.zz;
  // ODE's own test is a Cholesky decomposition: it must not fail by rounding where this one does not.
  const double pivot_yy = minor2 / m.xx, pivot_zz = det / minor2;
  // det / trace^2 is below the smallest principal moment, so that the inverse stays far from an overflow.
  return m.xx > 0 && pivot_yy > least_pivot * m.yy && pivot_zz > least_pivot * m.zz && m.yy > 0 && m.zz > 0 &&
         det > least_inertia_kgm2 * trace * trace && std::isfinite(det);
}

namespace {

Symmetric3 group_tensor(const model::Inertial& i) {
  return {i.moments.x, i.moments.y, i.moments.z, i.products.x, i.products.y, i.products.z};
}

void add_masses(const model::Model& model, RigidGroup& group) {
  Vec3 moment_M, gravity_moment_M;
  for (const std::uint32_t l : group.links) {
    const model::Link& link = model.links[l];
    const Vec3 com_M = link.X_ML * link.inertial.X_LCo.p;
    group.mass_kg += link.inertial.mass_kg;
    moment_M += link.inertial.mass_kg * com_M;
    if (link.gravity) {
      group.gravity_mass_kg += link.inertial.mass_kg;
      gravity_moment_M += link.inertial.mass_kg * com_M;
    }
  }
  const model::Link& first = model.links[group.links.front()];
  group.X_MB.q = normalised(first.X_ML.q);
  group.X_MB.p = moment_M / group.mass_kg;
  if (group.links.size() == 1) group.X_MB.p = first.X_ML * first.inertial.X_LCo.p;
  const Pose X_BM = inverse(group.X_MB);
  for (const std::uint32_t l : group.links) {
    const Pose X_BCo = X_BM * model.links[l].X_ML * model.links[l].inertial.X_LCo;
    group.inertia_B += rotated(normalised(X_BCo.q), group_tensor(model.links[l].inertial));
    group.inertia_B += steiner(model.links[l].inertial.mass_kg, X_BCo.p);
  }
  if (group.links.size() == 1)  // exactly as in the file, without the rounding of the sums
    group.inertia_B = rotated(normalised(first.inertial.X_LCo.q), group_tensor(first.inertial));
  if (group.gravity_mass_kg > 0) group.gravity_point_B = X_BM * (gravity_moment_M / group.gravity_mass_kg);
}

}  // namespace

Result<RigidGroups> group_links(const model::Model& model, bool held) {
  // Union-find over links; index n stands for the world. The smallest link is the root, the world above all.
  const auto n = static_cast<std::uint32_t>(model.links.size());
  std::vector<std::uint32_t> parent(n + 1);
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    if (a == n || (b != n && a < b)) parent[b] = a;
    else parent[a] = b;
  };
  for (const model::Joint& joint : model.joints)
    if (joint.type == model::JointType::fixed)
      join(joint.parent == model::world_link ? n : joint.parent, joint.child);
  if (model.is_static || held)
    for (std::uint32_t l = 0; l < n; ++l) join(n, l);

  RigidGroups result;
  result.of_link.assign(n, 0);
  std::vector<std::uint32_t> group_of_root(n + 1, ~0u);
  for (std::uint32_t l = 0; l < n; ++l) {
    std::uint32_t& group = group_of_root[root(l)];
    if (group == ~0u) {
      group = static_cast<std::uint32_t>(result.groups.size());
      result.groups.emplace_back().fixed = root(l) == n;
    }
    result.groups[group].links.push_back(l);
    result.of_link[l] = group;
  }
  for (RigidGroup& group : result.groups) {
    const model::Link& first = model.links[group.links.front()];
    if (group.fixed) {
      group.X_MB = first.X_ML;
      continue;
    }
    add_masses(model, group);
  }
  SL_TRY(check_masses(model, result));
  return result;
}

Status check_masses(const model::Model& model, const RigidGroups& groups) {
  for (const RigidGroup& group : groups.groups) {
    if (group.fixed) continue;
    const model::Link& first = model.links[group.links.front()];
    if (!(group.mass_kg >= least_mass_kg && group.mass_kg <= most_mass_kg))
      return Error{"the mass of link '" + first.name + "' is not between 1e-40 and 1e40 kg",
                   "give it a mass, or make the model static", first.place};
    Symmetric3 least = group.inertia_B;
    least.xx -= group.spin_inertia, least.yy -= group.spin_inertia, least.zz -= group.spin_inertia;
    if (!is_positive_definite(group.inertia_B) || !is_positive_definite(least))
      return Error{"the inertia of link '" + first.name + "' is not positive definite",
                   "ixx, iyy, izz must be positive, above 1e-39, and the products small against them",
                   first.place};
  }
  return {};
}

}  // namespace sandlot::rigid
