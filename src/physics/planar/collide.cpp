// Narrow phase: contact points of two bodies, and the time of impact of those that do not touch yet.
#include <algorithm>
#include <cmath>

#include "physics/planar/manifold.h"
#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

constexpr double within_m = 1e-4;  ///< what is so near counts as touching whatever its speed
constexpr double impact_gap_m = 5e-5;

struct Side {
  std::uint32_t group = none;
  const RigidGroup* moving = nullptr;
  const Disc* disc = nullptr;
  std::span<const Outline> parts;
  std::span<const Edge> edges;
  Outline circle;  ///< of a disc
};

double middle_of_common(Heights a, Heights b) {
  return 0.5 * (std::max(a.min_m, b.min_m) + std::min(a.max_m, b.max_m));
}

}  // namespace

/// Whether they can come to touch in this step, from the state alone.
bool PlanarEngine::near(const Candidate& c, double) const {
  const std::uint32_t k = c.a != none ? c.a : c.b;
  const Disc& disc = map_.discs()[k];
  if (c.wall != none)
    return nearest(map_.walls()[c.wall].outline, map_.edges(), disc.centre).distance_m <
           disc.radius_m + groups_[k].reach_m;
  const Disc& other = map_.discs()[c.b];
  const Vec2 d = other.centre - disc.centre;
  const double far = disc.radius_m + other.radius_m + groups_[c.a].reach_m + groups_[c.b].reach_m;
  return dot(d, d) < far * far;
}

namespace {

template <class Visit>
void for_parts(const Side& a, const Side& b, double margin_m, double clearance_m, Visit&& visit) {
  for (std::uint32_t i = 0; i < a.parts.size(); ++i)
    for (std::uint32_t j = 0; j < b.parts.size(); ++j) {
      const Outline &x = a.parts[i], &y = b.parts[j];
      const double far = x.radius_m + y.radius_m + margin_m;
      const Vec2 d = y.centre - x.centre;
      if (!(dot(d, d) < far * far) || !meet(x.heights, y.heights, clearance_m)) continue;
      visit(i, j, ConvexOutline{x, a.edges}, ConvexOutline{y, b.edges});
    }
}

void take_side(Side& side, std::uint32_t k, const Candidate& c, const std::vector<RigidGroup>& groups,
               Map& map) {
  side.group = k;
  if (k == none) {
    side.parts = {&map.walls()[c.wall].outline, 1};
    side.edges = map.edges();
    return;
  }
  side.moving = &groups[k];
  side.disc = &map.discs()[k];
  if (side.moving->silhouette == none) {
    side.circle = {side.disc->centre, side.disc->radius_m, side.disc->heights};
    side.parts = {&side.circle, 1};
    return;
  }
  const Silhouette& silhouette = map.silhouettes()[side.moving->silhouette];
  side.parts = silhouette.parts;
  side.edges = silhouette.edges;
}

/// Largest way of a group's outline in h.
double way(const Side& side, double h_s) {
  if (!side.moving) return 0;
  return h_s * (std::sqrt(dot(side.moving->v, side.moving->v)) +
                std::abs(side.moving->w_radps) * side.disc->radius_m);
}

}  // namespace

void PlanarEngine::collide(const Candidate& c, double h_s, std::vector<ContactPoint>& out) const {
  if (!grips_.empty() && hold_each_other(c)) return;
  const auto core = [&](const Side& s) {
    return s.moving ? instances_[s.moving->slot].plan->groups[s.moving->index].core_m
                    : std::numeric_limits<double>::infinity();
  };
  if (c.wall == none) {
    // Most candidates are some way off.
    const Disc &x = map_.discs()[c.a], &y = map_.discs()[c.b];
    const double far = x.radius_m + y.radius_m + groups_[c.a].reach_m + groups_[c.b].reach_m;
    const Vec2 d = y.centre - x.centre;
    if (!(dot(d, d) < far * far)) return;
  }
  Side a, b;
  take_side(a, c.a, c, groups_, map_);
  take_side(b, c.b, c, groups_, map_);
  const double margin = within_m + std::min(way(a, h_s) + way(b, h_s), 0.5 * std::min(core(a), core(b)));
  for_parts(a, b, margin, spec_.clearance_m,
            [&](std::uint32_t i, std::uint32_t j, ConvexOutline x, ConvexOutline y) {
              Manifold met;
              if (!find_manifold(x, y, margin, met)) return;
              struct Surfaced {
                ContactFace face;
                std::uint32_t body, shape;
                bool slippery;
              };
              const auto surfaced = [&](const Side& s, std::uint32_t part) -> Surfaced {
                if (!s.moving) {
                  const Wall& wall = map_.walls()[c.wall];
                  return {{&wall.collision->surface, wall.collision, wall.instance, wall.link},
                          wall.body,
                          Contact::no_shape,
                          false};
                }
                const std::uint32_t slot = s.moving->slot;
                const Instance& instance = instances_[slot];
                const Part& p = instance.plan->groups[s.moving->index].parts[part];
                const auto& collisions = instance.model->links[p.link].collisions;
                const auto of_surface = [&](const model::Collision& each) {
                  return &each.surface == p.surface;
                };
                const auto at = std::find_if(collisions.begin(), collisions.end(), of_surface);
                return {{p.surface, at == collisions.end() ? nullptr : &*at, slot, p.link, s.moving},
                        instance.bodies[p.link].index,
                        p.collision,
                        drives_[slot].active != 0};
              };
              const Surfaced sa = surfaced(a, i), sb = surfaced(b, j);
              const Vec3 normal{met.normal.x, met.normal.y, 0}, tangent{-normal.y, normal.x, 0};
              const double z_m = middle_of_common(x.outline.heights, y.outline.heights);
              for (int k = 0; k < met.count; ++k) {
                const PairSurface pair = surfaces_at(sa.face, sb.face,
                                                     {met.points[k].at.x, met.points[k].at.y, z_m}, normal);
                if (!pair.touches) continue;
                ContactPoint t;
                t.key = c.key;
                t.key.part_a += a.moving ? i : 0;
                t.key.part_b += b.moving ? j : 0;
                t.key.feature = met.points[k].feature;
                t.a = c.a, t.b = c.b;
                t.normal = met.normal;
                t.at = met.points[k].at;
                t.gap_m = met.points[k].gap_m;
                t.mu = sa.slippery || sb.slippery ? 0 : friction_along(pair, normal, tangent);
                t.belt_mps = dot(pair.belt_velocity_W_mps, tangent);
                t.restitution = pair.restitution;
                t.threshold_mps = pair.restitution_threshold_mps;
                t.body_a = sa.body, t.body_b = sb.body;
                t.shape_a = sa.shape, t.shape_b = sb.shape;
                t.z_m = z_m;
                out.push_back(t);
              }
            });
}

/// Takes the impulses of the last step over to contacts that were there already.
void PlanarEngine::remember(std::span<ContactPoint> contact_points) const {
  auto old = contact_points_.begin();
  for (ContactPoint& t : contact_points) {
    while (old != contact_points_.end() && old->key < t.key) ++old;
    if (old == contact_points_.end()) return;
    if (old->key != t.key) continue;
    t.normal_Ns = old->normal_Ns;
    t.tangent_Ns = old->tangent_Ns;
  }
}

/// The part of h after which two that could pass each other meet; 1: they do not.
double PlanarEngine::impact(const Candidate& c, double h_s) const {
  if (!grips_.empty() && hold_each_other(c)) return 1;
  Side a, b;
  take_side(a, c.a, c, groups_, map_);
  take_side(b, c.b, c, groups_, map_);
  const auto core = [&](const Side& s) {
    return s.moving ? instances_[s.moving->slot].plan->groups[s.moving->index].core_m
                    : std::numeric_limits<double>::infinity();
  };
  const Vec2 va = a.moving ? a.moving->v : Vec2{}, vb = b.moving ? b.moving->v : Vec2{};
  const Vec2 path = h_s * (vb - va);
  const double length = std::sqrt(dot(path, path));
  const auto turning = [&](const Side& s) {
    return s.moving && s.moving->silhouette != none ? h_s * std::abs(s.moving->w_radps) * s.disc->radius_m
                                                    : 0;
  };
  const double turned = turning(a) + turning(b), least = 0.25 * std::min(core(a), core(b));
  if (!(length > least || turned > least)) return 1;
  double first = 1;
  for_parts(a, b, length + turned, spec_.clearance_m,
            [&](std::uint32_t, std::uint32_t, ConvexOutline x, ConvexOutline y) {
              if (length > least) first = std::min(first, time_of_impact(x, y, path, impact_gap_m));
              // A body that turns fast moves at most by the gap at a time, or by the contacts' look-ahead.
              if (turned > least)
                first = std::min(first, std::max(separation(x, y).gap_m, least) / (length + turned));
            });
  return first;
}

}  // namespace sandlot::planar
