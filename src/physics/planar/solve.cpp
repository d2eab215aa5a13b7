// An island of bodies that touch or hold each other: velocities, then motion from impact to impact, then what overlap is
// left.
//
//   bounce    contacts with restitution that close within the step pass their impulse on one after the other, -e times the
//             closing velocity each, until none closes: exact for two, and for a row of balls. A face on a face takes both
//             points at once. Energy is never gained: each impulse is a collision of its own.
//   apart     v_n >= -gap / h and |friction| <= mu * normal, by sequential impulses with those of the last step to begin
//             with (E. Catto, Iterative Dynamics with Temporal Coherence, 2005). So nobody enters anybody.
//   back      overlap beyond the slop is taken back by moving the bodies, not by velocities (nonlinear Gauss-Seidel).
#include <algorithm>
#include <cmath>

#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

constexpr double slop_m = 1e-4, most_back_m = 2e-3, share_back = 0.3;
/// Passes go on while one of them still changes by more than this how far somebody comes in the step, but not for ever: a
/// heavy body takes many to hold a light one against a wall.
constexpr double settled_m = 1e-5;
constexpr int most_times_passes = 20;
constexpr int bounce_passes = 200, back_passes = 4, most_impacts = 24;

double effective_kg(const Lump* a, const Lump* b, Vec2 arm_a, Vec2 arm_b, Vec2 along) {
  double k = 0;
  if (a) k += a->inverse_kg + a->inverse_kgm2 * cross(arm_a, along) * cross(arm_a, along);
  if (b) k += b->inverse_kg + b->inverse_kgm2 * cross(arm_b, along) * cross(arm_b, along);
  return k > 0 ? 1 / k : 0;
}

/// A touch with the bodies it is about.
struct Ends {
  Lump *a, *b;
  Vec2 apart(const Touch& t) const {
    Vec2 v;
    if (b) v = v + b->velocity_at(t.arm_b);
    if (a) v = v - a->velocity_at(t.arm_a);
    return v;
  }
  void push(const Touch& t, Vec2 impulse) const {
    if (a) a->push(-1.0 * impulse, t.arm_a);
    if (b) b->push(impulse, t.arm_b);
  }
};

Ends ends(std::vector<Lump>& lumps, const Touch& t) {
  return {t.a == none ? nullptr : &lumps[t.a], t.b == none ? nullptr : &lumps[t.b]};
}

bool same_face(const Touch& x, const Touch& y) {
  return x.key.pair == y.key.pair && x.key.lumps == y.key.lumps && x.key.part_a == y.key.part_a &&
         x.key.part_b == y.key.part_b;
}

}  // namespace

/// @param warm  the impulses of the last step are put in
void PlanarEngine::prepare(Touch& t, double h_s, bool warm) {
  const auto [a, b] = ends(lumps_, t);
  // Each at its own surface, where they will be when they meet.
  t.arm_a = t.at - (0.5 * t.gap_m) * t.normal, t.arm_b = t.at + (0.5 * t.gap_m) * t.normal;
  if (a) t.arm_a = t.arm_a - a->p, t.heading_a = a->heading;
  if (b) t.arm_b = t.arm_b - b->p, t.heading_b = b->heading;
  t.normal_kg = effective_kg(a, b, t.arm_a, t.arm_b, t.normal);
  t.tangent_kg = effective_kg(a, b, t.arm_a, t.arm_b, left_of(t.normal));
  t.bias_mps = t.gap_m > 0 ? -t.gap_m / h_s : 0;
  if (!warm) t.normal_Ns = t.tangent_Ns = 0;
}

void PlanarEngine::bounce(std::span<Touch> touches) {
  const auto closing = [&](const Touch& t) {
    const double v = dot(ends(lumps_, t).apart(t), t.normal);
    return t.restitution > 0 && v < -t.threshold_mps && v < t.bias_mps ? -v : 0.0;
  };
  const auto rub = [&](Touch& t, double normal_Ns) {
    const Ends e = ends(lumps_, t);
    const Vec2 tangent = left_of(t.normal);
    const double most = t.mu * normal_Ns;
    const double j = std::clamp(-t.tangent_kg * (dot(e.apart(t), tangent) + t.belt_mps), -most, most);
    e.push(t, j * tangent);
    t.bounce_tangent_Ns += j;
  };
  const auto single = [&](Touch& t, double v) {
    const double j = (1 + t.restitution) * v * t.normal_kg;
    ends(lumps_, t).push(t, j * t.normal);
    t.bounce_Ns += j;
    rub(t, j);
  };
  for (int pass = 0; pass < bounce_passes; ++pass) {
    bool any = false;
    for (std::size_t i = 0; i < touches.size(); ++i) {
      Touch& t = touches[i];
      const bool two = i + 1 < touches.size() && same_face(t, touches[i + 1]);
      const double v = closing(t);
      if (!two) {
        if (v > 0) single(t, v), any = true;
        continue;
      }
      Touch& u = touches[++i];
      const double w = closing(u);
      if (!(v > 0 || w > 0)) continue;
      any = true;
      if (v > 0 && w > 0) {
        // Both points at once: a 2x2 system.
        const Ends e = ends(lumps_, t);
        double k = 0;
        for (const auto& [lump, arm_t, arm_u] :
             {std::tuple{e.a, t.arm_a, u.arm_a}, std::tuple{e.b, t.arm_b, u.arm_b}})
          if (lump)
            k += lump->inverse_kg + lump->inverse_kgm2 * cross(arm_t, t.normal) * cross(arm_u, u.normal);
        const double kt = 1 / t.normal_kg, ku = 1 / u.normal_kg, det = kt * ku - k * k;
        const double rt = (1 + t.restitution) * v, ru = (1 + u.restitution) * w;
        const double jt = (rt * ku - ru * k) / det, ju = (ru * kt - rt * k) / det;
        if (det > 1e-9 * kt * ku && jt >= 0 && ju >= 0) {
          ends(lumps_, t).push(t, jt * t.normal);
          ends(lumps_, u).push(u, ju * u.normal);
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
double PlanarEngine::hold_apart(std::span<Touch> touches) {
  double change = 0;
  for (Touch& t : touches) {
    const Ends e = ends(lumps_, t);
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
  const std::span<const std::uint32_t> lumps(island_lumps_.data() + island.first_lump, island.lumps);
  const std::span<Linkage* const> linkages(sorted_linkages_.data() + island.first_linkage, island.linkages);
  std::vector<Touch>& touches = island.touches;
  for (std::size_t i = 0; i < lumps.size(); ++i) {
    const Lump& lump = lumps_[lumps[i]];
    planned_[island.first_lump + i] = {lump.v, lump.w_radps, lump.p, lump.heading};
    left_m_[island.first_lump + i] = lump.reach_m;
  }
  for (Touch& t : touches) prepare(t, h_s, true);
  bounce(touches);
  for (Touch& t : touches) ends(lumps_, t).push(t, t.normal_Ns * t.normal + t.tangent_Ns * left_of(t.normal));
  for (Linkage* l : linkages) prepare_linkage(*l, h_s);
  const auto each_instance = [&](auto&& visit) {
    for (const std::uint32_t k : lumps)
      if (lumps_[k].index == 0) visit(lumps_[k].slot);
  };
  each_instance([&](std::uint32_t slot) { prepare_wheels(slot, h_s); });
  // A row of joints takes as many passes as it is long.
  const int passes = spec_.iterations + 2 * static_cast<int>(std::min<std::size_t>(linkages.size(), 30));
  double change = 0;
  for (int pass = 0; pass < passes || (change * h_s > settled_m && pass < most_times_passes * passes);
       ++pass) {
    for (Linkage* l : linkages) hold_linkage(*l, h_s);
    each_instance([&](std::uint32_t slot) { turn_wheels(slot, h_s); });
    for (const std::uint32_t k : lumps) rub(k, h_s);
    change = hold_apart(touches);
  }
  each_instance([&](std::uint32_t slot) { finish_wheels(slot, h_s); });

  double left_s = h_s;
  for (int impacts = 0;; ++impacts) {
    const double moved = advance_island(island, left_s);
    left_s -= moved;
    if (!(left_s > 1e-9 * h_s) || impacts == most_impacts) break;
    // Something has been hit on the way: contacts alone, for the rest of the step.
    touches.clear();
    for (std::uint32_t i = 0; i < island.candidates; ++i)
      collide(island_candidates_[island.first_candidate + i], left_s, touches);
    for (Touch& t : touches) prepare(t, left_s, false);
    bounce(touches);
    for (int pass = 0; pass < spec_.iterations ||
                       (change * left_s > settled_m && pass < most_times_passes * spec_.iterations);
         ++pass) {
      for (Linkage* l : linkages) hold_linkage(*l, h_s);
      change = hold_apart(touches);
    }
  }
  take_back(island, h_s);
  for (Linkage* l : linkages) finish_linkage(*l, h_s);
  for (std::size_t i = 0; i < lumps.size(); ++i) {
    Lump& lump = lumps_[lumps[i]];
    if (lump.index != 0 || !drives_[lump.slot].active) continue;
    const Planned& planned = planned_[island.first_lump + i];
    if (lump.v == planned.v && lump.w_radps == planned.w_radps) finish_drive(lump.slot, lump, h_s);
    else finish_hindered(lump.slot, lump, planned);
  }
}

/// Moves everybody for h, or until the first of those that could pass each other meet. @return for how long
double PlanarEngine::advance_island(const Island& island, double h_s) {
  double first = 1;
  for (std::uint32_t i = 0; i < island.candidates; ++i)
    first = std::min(first, impact(island_candidates_[island.first_candidate + i], h_s));
  for (std::uint32_t i = island.first_lump; i < island.first_lump + island.lumps; ++i)
    move(island_lumps_[i], first * h_s, left_m_[i]);
  return first < 1 ? first * h_s : h_s;
}

void PlanarEngine::move(std::uint32_t k, double h_s, double& left_m) {
  Lump& lump = lumps_[k];
  Vec2 way = h_s * lump.v;
  // Nobody leaves what the broad phase has looked at, whatever he is hit by on the way.
  double length = std::sqrt(dot(way, way));
  if (length > left_m) way = (left_m / length) * way, length = left_m;
  left_m -= length;
  lump.p = lump.p + way;
  if (lump.w_radps != 0) {
    const Turn half = turn_of(0.5 * lump.w_radps * h_s);
    lump.heading = tidied(lump.heading * half * half);
  }
  place_disc(k);
}

void PlanarEngine::take_back(Island& island, double h_s) {
  // The points of who has turned far are no longer those where he touches.
  const bool turned_far = std::any_of(island_lumps_.begin() + island.first_lump,
                                      island_lumps_.begin() + island.first_lump + island.lumps,
                                      [&](std::uint32_t k) {
                                        const double angle = h_s * lumps_[k].w_radps;
                                        return 0.5 * angle * angle * map_.discs()[k].radius_m > slop_m;
                                      });
  std::span<Touch> touches = island.touches;
  if (turned_far) {
    island.turned.clear();
    for (std::uint32_t i = 0; i < island.candidates; ++i)
      collide(island_candidates_[island.first_candidate + i], 0, island.turned);
    for (Touch& t : island.turned) prepare(t, h_s, false);
    touches = island.turned;
  }
  const std::span<Linkage* const> linkages(sorted_linkages_.data() + island.first_linkage, island.linkages);
  const auto turned = [](const Lump& lump, Turn before, Vec2 arm) {
    return rotate(lump.heading, rotate_back(before, arm));
  };
  const auto shift = [](Lump* lump, Vec2 impulse, Vec2 arm) {
    if (!lump) return;
    lump->p = lump->p + lump->inverse_kg * impulse;
    const double turn = lump->inverse_kgm2 * cross(arm, impulse);
    if (turn != 0) lump->heading = tidied(lump->heading * turn_of(turn));
  };
  bool moved = false;
  for (int pass = 0; pass < back_passes; ++pass) {
    bool any = false;
    for (Linkage* l : linkages) take_back(*l);
    for (Touch& t : touches) {
      const auto [a, b] = ends(lumps_, t);
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
    moved = moved || any || !linkages.empty();
    if (!any && linkages.empty()) break;
  }
  if (!moved) return;
  for (std::uint32_t i = 0; i < island.lumps; ++i) {
    const std::uint32_t k = island_lumps_[island.first_lump + i];
    place_disc(k);
  }
}

/// A lump that touches nothing and is held by nothing.
void PlanarEngine::move_alone(std::uint32_t k, double h_s) {
  Lump& lump = lumps_[k];
  if (lump.inverse_kg == 0) return;
  const std::uint32_t slot = lump.slot;
  double left_m = lump.reach_m;
  if (drives_[slot].active && lump.index == 0) {
    move(k, h_s, left_m);
    finish_drive(slot, lump, h_s);
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
  if (lump.v == Vec2{} && lump.w_radps == 0) return;
  move(k, h_s, left_m);
}

}  // namespace sandlot::planar
