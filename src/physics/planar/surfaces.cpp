// Contact parameters of touching surfaces, and errors about bodies that move impossibly fast.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "physics/exploded.h"
#include "physics/planar/planar.h"

namespace sandlot::planar {

double friction_along(const PairSurface& pair, Vec3 normal, Vec3 way) {
  const Vec3 f = pair.fdir1_W - dot(pair.fdir1_W, normal) * normal;
  const double square = dot(f, f);
  if (!(square > 1e-12)) return pair.mu;
  const double along = dot(f, way), c2 = std::min(along * along / square, 1.0);
  const double size = std::sqrt(c2 * pair.mu2 * pair.mu2 + (1 - c2) * pair.mu * pair.mu);
  return size > 0 ? pair.mu * pair.mu2 / size : 0;
}

/// Pose of the shape in W, with a group's joints at 0.
Pose PlanarEngine::pose_of(const ContactFace& face) const {
  const Instance& instance = instances_[face.slot];
  const model::Link& link = instance.model->links[face.link];
  if (!face.group)
    return canonical_pose(face.slot) * inverse(instance.model->links[0].X_ML) * link.X_ML *
           face.collision->X_LC;
  const RigidGroup& group = *face.group;
  const Vec2 p = group.p - rotate(group.heading, instance.plan->groups[group.index].com_H);
  const Pose X_WL = Pose{{p.x, p.y, 0}, about_z(group.heading)} * instance.plan->X_HL[face.link];
  return face.collision ? X_WL * face.collision->X_LC : X_WL;
}

/// @param a  the older
PairSurface PlanarEngine::surfaces_at(const ContactFace& a, const ContactFace& b, Vec3 point,
                                      Vec3 normal) const {
  const auto side = [&](const ContactFace& f) -> SurfaceSide {
    if (!f.group)
      if (const model::SurfaceZone* const zone = zones_.find(point)) return {zone->surface, {}};
    return {*f.surface, is_plain(*f.surface) ? Quat{} : pose_of(f).q};
  };
  PairSurface pair = combine(side(a), side(b), normal);
  if (rule_ && a.collision && b.collision) {
    const auto side_of = [&](const ContactFace& f) -> ContactSide {
      const Instance& instance = instances_[f.slot];
      return {instance.name, instance.model->links[f.link], *f.collision, pose_of(f)};
    };
    rule_(side_of(a), side_of(b), point, normal, pair);
  }
  // A rule may return anything.
  for (double* x : {&pair.mu, &pair.mu2, &pair.restitution, &pair.rolling_resistance_m})
    *x = std::max(0.0, *x);
  return pair;
}

void PlanarEngine::set_zones(std::span<const model::SurfaceZone> zones) {
  zones_ = ZoneMap(zones);
  ground_fresh_ = false;
}

void PlanarEngine::set_contact_rule(ContactRule rule) {
  rule_ = std::move(rule);
  ground_fresh_ = false;
}

// --- explosions --------------------------------------------------------------------------------------------

/// Speed as a multiple of the largest allowed one; infinite where it is not a number.
double PlanarEngine::excess(Vec2 v, double w) const {
  const double most = std::max(dot(v, v) / (spec_.max_speed_mps * spec_.max_speed_mps),
                               w * w / (spec_.max_spin_radps * spec_.max_spin_radps));
  return dot(v, v) < 1e300 && w * w < 1e300 ? most : std::numeric_limits<double>::infinity();
}

/// Notes that this step cannot be made. Of several bodies the worst is named, of equals that with the
/// smallest index.
void PlanarEngine::explode(std::uint32_t k, Vec2 v, double w) {
  const std::lock_guard lock(refreshing_);
  const double mine = excess(v, w);
  if (mine > explosion_.excess || (mine == explosion_.excess && k < explosion_.group))
    explosion_ = {mine, k, v, w};
}

Error PlanarEngine::exploded(std::uint32_t k, Vec2 v, double w) const {
  const RigidGroup& group = groups_[k];
  const Instance& instance = instances_[group.slot];
  const std::string name = instance.name + "/" +
                           instance.model->links[instance.plan->groups[group.index].root].name;
  if (!std::isfinite(excess(v, w))) return not_finite(name);
  return sandlot::exploded(name, {std::sqrt(dot(v, v)), spec_.max_speed_mps},
                           {std::abs(w), spec_.max_spin_radps});
}

Status PlanarEngine::check_finite() const {
  if (failure_) return *failure_;
  double worst = 1;
  std::uint32_t exploding = none;
  constexpr std::size_t ahead = 4;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    if (i + ahead < order_.size()) expect(order_[i + ahead]);
    const Instance& instance = instances_[order_[i]];
    double sum = instance.z_m;
    for (const std::uint32_t k : instance.groups) {
      const RigidGroup& b = groups_[k];
      sum += b.p.x + b.p.y + b.heading.c + b.heading.s;
      if (is_sound(b.v, b.w_radps)) continue;
      if (const double mine = excess(b.v, b.w_radps); mine > worst) worst = mine, exploding = k;
    }
    for (const JointId joint : instance.joints)
      sum += joint_states_[joint.index].position + joint_states_[joint.index].velocity;
    if (!std::isfinite(sum)) return not_finite(instance.name + "/" + instance.model->links[0].name);
  }
  if (exploding != none) return exploded(exploding, groups_[exploding].v, groups_[exploding].w_radps);
  return {};
}

}  // namespace sandlot::planar
