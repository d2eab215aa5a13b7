#include "physics/pair_surface.h"

#include <algorithm>
#include <limits>

#include "geometry/polygon.h"
#include "physics/substance.h"

namespace sandlot {
namespace {

bool is_directed(const model::Surface& s) { return dot(s.fdir1, s.fdir1) > 0; }
/// Without a direction of its own a surface is isotropic: mu and slip1 hold both ways.
double mu2(const model::Surface& s) { return is_directed(s) ? s.mu2 : s.mu; }
double slip2(const model::Surface& s) { return is_directed(s) ? s.slip2 : s.slip1; }

/// Whose fdir1 counts; null: neither has one that does. Of two the more slippery surface decides: it gives
/// way first.
const model::Surface* directed(const model::Surface& a, const model::Surface& b) {
  if (a.substance && b.substance) return nullptr;
  const bool of_a = is_directed(a), of_b = is_directed(b);
  if (of_a && of_b) return std::min(a.mu, a.mu2) <= std::min(b.mu, b.mu2) ? &a : &b;
  return of_a ? &a : of_b ? &b : nullptr;
}

const model::Surface* with_skin(const model::Surface& a, const model::Surface& b) {
  if (a.skin && b.skin) return a.skin->ratio <= b.skin->ratio ? &a : &b;
  return a.skin ? &a : b.skin ? &b : nullptr;
}

/// The smaller of those that are given.
std::optional<double> smaller(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b ? std::min(*a, *b) : a ? a : b;
}

void combine_softness(const model::Surface& a, const model::Surface& b, PairSurface& pair) {
  if (a.stiffness_N_per_m || b.stiffness_N_per_m) {
    constexpr double usual_damping = 1;  // SDF's default
    const auto damping = [](const model::Surface& s) {
      return s.damping_N_s_per_m.value_or(s.stiffness_N_per_m ? usual_damping : 0);
    };
    pair.stiffness_N_per_m = a.stiffness_N_per_m && b.stiffness_N_per_m
                                 ? *a.stiffness_N_per_m * *b.stiffness_N_per_m /
                                       (*a.stiffness_N_per_m + *b.stiffness_N_per_m)
                                 : smaller(a.stiffness_N_per_m, b.stiffness_N_per_m);
    pair.damping_N_s_per_m = damping(a) + damping(b);
  }
  pair.soft_erp = smaller(a.soft_erp, b.soft_erp);
  if (a.soft_cfm || b.soft_cfm) pair.soft_cfm = a.soft_cfm.value_or(0) + b.soft_cfm.value_or(0);
  pair.max_correction_mps = smaller(a.max_correction_mps, b.max_correction_mps);
}

bool holds(const model::SurfaceZone& zone, Vec3 p) {
  const auto& corners = zone.outline_W;
  if (corners.empty()) {
    const double x = p.x - zone.centre_W.x, y = p.y - zone.centre_W.y;
    return x * x + y * y <= zone.radius_m * zone.radius_m;
  }
  return polygon_contains(corners, p);
}

}  // namespace

PairSurface combine(const model::Surface& a, const model::Surface& b) {
  PairSurface pair;
  pair.touches = a.touches && b.touches;
  pair.rolling_resistance_m = a.rolling_resistance_m + b.rolling_resistance_m;
  if (a.substance && b.substance) {
    const SubstancePair made = combine(*a.substance, *b.substance);
    pair.mu = pair.mu2 = made.mu;
    pair.slip1 = pair.slip2 = made.slip;
    pair.stiffness_N_per_m = made.stiffness_N_per_m;
    pair.damping_N_s_per_m = made.damping_N_s_per_m;
    // A spring that may not push as fast as it is compressed is none.
    pair.max_correction_mps = std::numeric_limits<double>::infinity();
    return pair;
  }
  pair.mu = std::min(a.mu, b.mu);
  pair.mu2 = std::min(mu2(a), mu2(b));
  pair.slip1 = a.slip1 + b.slip1;
  pair.slip2 = slip2(a) + slip2(b);
  pair.restitution = std::max(a.restitution, b.restitution);
  // The larger, as in Gazebo: nothing bounces off a net whose threshold is beyond all speeds.
  pair.restitution_threshold_mps = std::max(a.restitution_threshold_mps, b.restitution_threshold_mps);
  combine_softness(a, b, pair);
  return pair;
}

PairSurface combine(const SurfaceSide& a, const SurfaceSide& b, Vec3 normal_W) {
  PairSurface pair = combine(a.surface, b.surface);
  const auto to_world = [&](const model::Surface& whose, Vec3 v_C) {
    return rotate(&whose == &a.surface ? a.q_WC : b.q_WC, v_C);
  };
  if (const model::Surface* const s = with_skin(a.surface, b.surface)) {
    const Vec3 axis_W = to_world(*s, s->skin->axis);
    const Vec3 across = cross(axis_W, normal_W);
    pair.mu2 = std::max(pair.mu, pair.mu2);
    pair.slip2 = std::max(pair.slip1, pair.slip2);
    if (dot(across, across) < 0.1) {
      pair.mu = pair.mu2;
      pair.slip1 = pair.slip2;
    } else {
      pair.mu = s->skin->ratio * pair.mu2;
      pair.slip1 = pair.slip2;
      pair.fdir1_W = axis_W;
    }
  } else if (const model::Surface* const d = directed(a.surface, b.surface)) {
    pair.fdir1_W = to_world(*d, d->fdir1);
  }
  if (a.surface.belt_velocity_mps != Vec3{} || b.surface.belt_velocity_mps != Vec3{})
    pair.belt_velocity_W_mps = rotate(b.q_WC, b.surface.belt_velocity_mps) -
                               rotate(a.q_WC, a.surface.belt_velocity_mps);
  return pair;
}

ZoneMap::ZoneMap(std::span<const model::SurfaceZone> zones) {
  for (const model::SurfaceZone& zone : zones) {
    const Vec3 c = zone.centre_W;
    const double r = zone.radius_m;
    Zone z{zone, c.x - r, c.x + r, c.y - r, c.y + r};
    if (!zone.outline_W.empty()) {
      const auto& o = zone.outline_W;
      const auto x = std::minmax_element(o.begin(), o.end(), [](Vec3 p, Vec3 q) { return p.x < q.x; });
      const auto y = std::minmax_element(o.begin(), o.end(), [](Vec3 p, Vec3 q) { return p.y < q.y; });
      z.x0 = x.first->x, z.x1 = x.second->x, z.y0 = y.first->y, z.y1 = y.second->y;
    }
    zones_.push_back(std::move(z));
  }
}

const model::SurfaceZone* ZoneMap::find(Vec3 p) const {
  for (std::size_t i = zones_.size(); i-- > 0;) {
    const Zone& z = zones_[i];
    if (p.x >= z.x0 && p.x <= z.x1 && p.y >= z.y0 && p.y <= z.y1 && holds(z.zone, p)) return &z.zone;
  }
  return nullptr;
}

}  // namespace sandlot
