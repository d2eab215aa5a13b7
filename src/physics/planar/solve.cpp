// An island of bodies that touch or hold each other: velocities, then motion from impact to impact, then what
// overlap is left.
//
//   bounce    contacts with restitution that close within the step pass their impulse on one after the other,
//             -e times the closing velocity each, until none closes: exact for two, and for a row of balls. A
//             face on a face takes both points at once. Energy is never gained: each impulse is a collision
//             of its own.
//   apart     v_n >= -gap / h and |friction| <= mu * normal, by sequential impulses with those of the last
//             step to begin with (E. Catto, Iterative Dynamics with Temporal Coherence, 2005). So nobody
//             enters anybody.
//   back      overlap beyond the slop is taken back by moving the bodies, not by velocities (nonlinear
//             Gauss-Seidel).
#include <algorithm>
#include <cmath>

#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

constexpr double slop_m = 1e-4, most_back_m = 2e-3, share_back = 0.3;
/// Passes go on while one of them still changes by more than this how far somebody comes in the step, but not
/// for ever: a heavy body takes many to hold a light one against a wall.
constexpr double settled_m = 1e-5;
constexpr int most_times_passes = 20;
constexpr int bounce_passes = 200, back_passes = 4, most_impacts = 24;

double effective_kg(const RigidGroup* a, const RigidGroup* b, Vec2 arm_a, Vec2 arm_b, Vec2 along) {
  double k = 0;
  if (a) k += a->inverse_kg + a->inverse_kgm2 * cross(arm_a, along) * cross(arm_a, along);
  if (b) k += b->inverse_kg + b->inverse_kgm2 * cross(arm_b, along) * cross(arm_b, along);
  return k > 0 ? 1 / k : 0;
}

/// Share of the impulse that stops two bodies, if balls take up spin while they touch, which stops them if they slide.
double blow_of(const RigidGroup* a, const RigidGroup* b, double normal_kg) {
  double more = 0;
  for (const RigidGroup* each : {a, b})
    if (each && each->rolls) more += 1 / each->plan->mass_kg - each->inverse_kg;
  return more > 0 ? 1 / (1 + more * normal_kg) : 1;
}

/// A contact point with the bodies it is about.
struct Ends {
  RigidGroup *a, *b;
  Vec2 apart(const ContactPoint& t) const {
    Vec2 v;
    if (b) v = v + b->velocity_at(t.arm_b);
    if (a) v = v - a->velocity_at(t.arm_a);
    return v;
  }
  void push(const ContactPoint& t, Vec2 impulse) const {
    if (a) a->push(-1.0 * impulse, t.arm_a);
    if (b) b->push(impulse, t.arm_b);
  }
};

Ends ends(std::vector<RigidGroup>& groups, const ContactPoint& t) {
  return {t.a == none ? nullptr : &groups[t.a], t.b == none ? nullptr : &groups[t.b]};
}

bool same_face(const ContactPoint& x, const ContactPoint& y) {
  return x.key.pair == y.key.pair && x.key.groups == y.key.groups && x.key.part_a == y.key.part_a &&
         x.key.part_b == y.key.part_b;
}

}  // namespace

/// @param warm  the impulses of the last step are put in
void PlanarEngine::prepare(ContactPoint& t, double h_s, bool warm) {
  const auto [a, b] = ends(groups_, t);
  // Each at its own surface, where they will be when they meet.
  t.arm_a = t.at - (0.5 * t.gap_m) * t.normal, t.arm_b = t.at + (0.5 * t.gap_m) * t.normal;
  if (a) t.arm_a = t.arm_a - a->p, t.heading_a = a->heading;
  if (b) t.arm_b = t.arm_b - b->p, t.heading_b = b->heading;
  t.normal_kg = effective_kg(a, b, t.arm_a, t.arm_b, t.normal);
  t.tangent_kg = effective_kg(a, b, t.arm_a, t.arm_b, left_of(t.normal));
  t.blow = blow_of(a, b, t.normal_kg);
  t.bias_mps = t.gap_m > 0 ? -t.gap_m / h_s : 0;
  if (!warm) t.normal_Ns = t.tangent_Ns = 0;
}

void PlanarEngine::bounce(std::span<ContactPoint> contact_points) {
  const auto closing = [&](const ContactPoint& t) {
    const double v = dot(ends(groups_, t).apart(t), t.normal);
    return t.restitution > 0 && v < -t.threshold_mps && v < t.bias_mps ? -v : 0.0;
  };
  const auto rub = [&](ContactPoint& t, double normal_Ns) {
    const Ends e = ends(groups_, t);
    const Vec2 tangent = left_of(t.normal);
    const double most = t.mu * normal_Ns;
    const double j = std::clamp(-t.tangent_kg * (dot(e.apart(t), tangent) + t.belt_mps), -most, most);
    e.push(t, j * tangent);
    t.bounce_tangent_Ns += j;
  };
  const auto single = [&](ContactPoint& t, double v) {
    const double j = (1 + t.restitution) * v * t.normal_kg * t.blow;
    ends(groups_, t).push(t, j * t.normal);
    t.bounce_Ns += j;
    rub(t, j);
  };
  for (int pass = 0; pass < bounce_passes; ++pass) {
    bool any = false;
    for (std::size_t i = 0; i < contact_points.size(); ++i) {
      ContactPoint& t = contact_points[i];
      const bool two = i + 1 < contact_points.size() && same_face(t, contact_points[i + 1]);
      const double v = closing(t);
      if (!two) {
        if (v > 0) single(t, v), any = true;
        continue;
      }
      ContactPoint& u = contact_points[++i];
      const double w = closing(u);
      if (!(v > 0 || w > 0)) continue;
      any = true;
      if (v > 0 && w > 0) {
        // Both points at once: a 2x2 system.
        const Ends e = ends(groups_, t);
        double k = 0;
        for (const auto& [group, arm_t, arm_u] :
             {std::tuple{e.a, t.arm_a, u.arm_a}, std::tuple{e.b, t.arm_b, u.arm_b}})
          if (group)
            k += group->inverse_kg + group->inverse_kgm2 * cross(arm_t, t.normal) * cross(arm_u, u.normal);
        const double kt = 1 / t.normal_kg, ku = 1 / u.normal_kg, det = kt * ku - k * k;
        const double rt = (1 + t.restitution) * v, ru = (1 + u.restitution) * w;
        const double jt = (rt * ku - ru * k) / det, ju = (ru * kt - rt * k) / det;
        if (det > 1e-9 * kt * ku && jt >= 0 && ju >= 0) {
          ends(groups_, t).push(t, jt * t.normal);
          ends(groups_, u).push(u, ju * u.normal);
          t.bounce_Ns += jt, u.bounce_Ns += ju;
          rub(t, jt), rub(u, ju);
          continue;
        }
      }
      if (v >= w) single(t, v);
      else single(u, w);
    }
    if (!any) return;
  }
}

/// One pass. @return the largest change of velocity along a normal
double PlanarEngine::hold_apart(std::span<ContactPoint> contact_points) {
  double change = 0;
  for (ContactPoint& t : contact_points) {
    const Ends e = ends(groups_, t);
    const Vec2 tangent = left_of(t.normal);
    if (t.mu > 0) {
      const double most = t.mu * t.normal_Ns;
      const double j = std::clamp(t.tangent_Ns - t.tangent_kg * (dot(e.apart(t), tangent) + t.belt_mps),
                                  -most, most);
      e.push(t, (j - t.tangent_Ns) * tangent);
      t.tangent_Ns = j;
    }
    const double j = std::max(0.0, t.normal_Ns - t.normal_kg * (dot(e.apart(t), t.normal) - t.bias_mps));
    e.push(t, (j - t.normal_Ns) * t.normal);
    if (t.normal_kg > 0) change = std::max(change, std::abs(j - t.normal_Ns) / t.normal_kg);
    t.normal_Ns = j;
  }
  return change;
}

void PlanarEngine::solve(Island& island, double h_s) {
  const std::span<const std::uint32_t> groups(island_groups_.data() + island.first_group, island.groups);
  const std::span<JointConstraint* const> constraints(sorted_constraints_.data() + island.first_constraint,
                                                      island.constraints);
  std::vector<ContactPoint>& contact_points = island.contact_points;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const RigidGroup& group = groups_[groups[i]];
    planned_[island.first_group + i] = {group.v, group.w_radps, group.p, group.heading};
    left_m_[island.first_group + i] = group.reach_m;
  }
  for (ContactPoint& t : contact_points) prepare(t, h_s, true);
  bounce(contact_points);
  for (ContactPoint& t : contact_points)
    ends(groups_, t).push(t, t.normal_Ns * t.normal + t.tangent_Ns * left_of(t.normal));
  for (JointConstraint* l : constraints) prepare_constraint(*l, h_s);
  const auto each_instance = [&](auto&& visit) {
    for (const std::uint32_t k : groups)
      if (groups_[k].index == 0) visit(groups_[k].slot);
  };
  each_instance([&](std::uint32_t slot) { prepare_wheels(slot, h_s); });
  // A row of joints takes as many passes as it is long.
  const int passes = spec_.iterations + 2 * static_cast<int>(std::min<std::size_t>(constraints.size(), 30));
  double change = 0;
  for (int pass = 0; pass < passes || (change * h_s > settled_m && pass < most_times_passes * passes);
       ++pass) {
    for (JointConstraint* l : constraints) hold_constraint(*l, h_s);
    each_instance([&](std::uint32_t slot) { turn_wheels(slot, h_s); });
    for (const std::uint32_t k : groups) rub(k, h_s);
    change = hold_apart(contact_points);
  }
  each_instance([&](std::uint32_t slot) { finish_wheels(slot, h_s); });

  double left_s = h_s;
  for (int impacts = 0;; ++impacts) {
    const double moved = advance_island(island, left_s);
    left_s -= moved;
    if (!(left_s > 1e-9 * h_s) || impacts == most_impacts) break;
    // Something has been hit on the way: contacts alone, for the rest of the step.
    contact_points.clear();
    for (std::uint32_t i = 0; i < island.candidates; ++i)
      collide(island_candidates_[island.first_candidate + i], left_s, contact_points);
    for (ContactPoint& t : contact_points) prepare(t, left_s, false);
    bounce(contact_points);
    for (int pass = 0; pass < spec_.iterations ||
                       (change * left_s > settled_m && pass < most_times_passes * spec_.iterations);
         ++pass) {
      for (JointConstraint* l : constraints) hold_constraint(*l, h_s);
      change = hold_apart(contact_points);
    }
  }
  take_back(island, h_s);
  for (JointConstraint* l : constraints) finish_constraint(*l, h_s);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    RigidGroup& group = groups_[groups[i]];
    if (group.index != 0 || !drives_[group.slot].active) continue;
    const Planned& planned = planned_[island.first_group + i];
    if (group.v == planned.v && group.w_radps == planned.w_radps) finish_drive(group.slot, group, h_s);
    else finish_hindered(group.slot, group, planned);
  }
}

/// Moves everybody for h, or until the first of those that could pass each other meet. @return for how long
double PlanarEngine::advance_island(const Island& island, double h_s) {
  double first = 1;
  for (std::uint32_t i = 0; i < island.candidates; ++i)
    first = std::min(first, impact(island_candidates_[island.first_candidate + i], h_s));
  for (std::uint32_t i = island.first_group; i < island.first_group + island.groups; ++i)
    move(island_groups_[i], first * h_s, left_m_[i]);
  return first < 1 ? first * h_s : h_s;
}

void PlanarEngine::move(std::uint32_t k, double h_s, double& left_m) {
  RigidGroup& group = groups_[k];
  Vec2 way = h_s * group.v;
  // Nobody leaves what the broad phase has looked at, whatever he is hit by on the way.
  double length = std::sqrt(dot(way, way));
  if (length > left_m) way = (left_m / length) * way, length = left_m;
  left_m -= length;
  group.p = group.p + way;
  if (group.w_radps != 0) {
    const Turn half = turn_of(0.5 * group.w_radps * h_s);
    group.heading = tidied(group.heading * half * half);
  }
  place_disc(k);
}

void PlanarEngine::take_back(Island& island, double h_s) {
  // The points of a body that has turned far are no longer those where it touches.
  const bool turned_far = std::any_of(island_groups_.begin() + island.first_group,
                                      island_groups_.begin() + island.first_group + island.groups,
                                      [&](std::uint32_t k) {
                                        const double angle = h_s * groups_[k].w_radps;
                                        return 0.5 * angle * angle * map_.discs()[k].radius_m > slop_m;
                                      });
  std::span<ContactPoint> contact_points = island.contact_points;
  if (turned_far) {
    island.turned.clear();
    for (std::uint32_t i = 0; i < island.candidates; ++i)
      collide(island_candidates_[island.first_candidate + i], 0, island.turned);
    for (ContactPoint& t : island.turned) prepare(t, h_s, false);
    contact_points = island.turned;
  }
  const std::span<JointConstraint* const> constraints(sorted_constraints_.data() + island.first_constraint,
                                                      island.constraints);
  const auto turned = [](const RigidGroup& group, Turn before, Vec2 arm) {
    return rotate(group.heading, rotate_back(before, arm));
  };
  const auto shift = [](RigidGroup* group, Vec2 impulse, Vec2 arm) {
    if (!group) return;
    group->p = group->p + group->inverse_kg * impulse;
    const double turn = group->inverse_kgm2 * cross(arm, impulse);
    if (turn != 0) group->heading = tidied(group->heading * turn_of(turn));
  };
  bool moved = false;
  for (int pass = 0; pass < back_passes; ++pass) {
    bool any = false;
    for (JointConstraint* l : constraints) take_back(*l);
    for (ContactPoint& t : contact_points) {
      const auto [a, b] = ends(groups_, t);
      const Vec2 arm_a = a ? turned(*a, t.heading_a, t.arm_a) : t.arm_a,
                 arm_b = b ? turned(*b, t.heading_b, t.arm_b) : t.arm_b;
      const Vec2 at_a = a ? a->p + arm_a : arm_a, at_b = b ? b->p + arm_b : arm_b;
      const double gap = dot(t.normal, at_b - at_a);
      const double back = std::clamp(share_back * (-gap - slop_m), 0.0, most_back_m);
      if (!(back > 0)) continue;
      const Vec2 impulse = back * effective_kg(a, b, arm_a, arm_b, t.normal) * t.normal;
      shift(a, -1.0 * impulse, arm_a);
      shift(b, impulse, arm_b);
      any = true;
    }
    moved = moved || any || !constraints.empty();
    if (!any && constraints.empty()) break;
  }
  if (!moved) return;
  for (std::uint32_t i = 0; i < island.groups; ++i) {
    const std::uint32_t k = island_groups_[island.first_group + i];
    place_disc(k);
  }
}

/// A group that touches nothing and is held by nothing.
void PlanarEngine::move_alone(std::uint32_t k, double h_s) {
  RigidGroup& group = groups_[k];
  if (group.inverse_kg == 0) return;
  const std::uint32_t slot = group.slot;
  double left_m = group.reach_m;
  if (drives_[slot].active && group.index == 0) {
    move(k, h_s, left_m);
    finish_drive(slot, group, h_s);
    return;
  }
  if (!instances_[slot].wheels.empty()) {
    prepare_wheels(slot, h_s);
    for (int pass = 0; pass < 60; ++pass)
      if (turn_wheels(slot, h_s) < 1e-10) break;
    finish_wheels(slot, h_s);
  } else {
    rub(k, h_s);
  }
  if (group.v == Vec2{} && group.w_radps == 0) return;
  move(k, h_s, left_m);
}

}  // namespace sandlot::planar
