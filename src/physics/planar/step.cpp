// A step of the planar engine: what each body means to do, who touches whom, islands, and what comes of it.

#include <algorithm>
#include <cmath>

#include "physics/parallel.h"
#include "physics/planar/planar.h"

namespace sandlot::planar {
namespace {

/// Calls work(i) for all i, in parallel where it pays: what is done for one i depends on no other.
template <class Work>
void for_each(std::size_t count, std::size_t grain, const Work& work) {
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) work(i);
  });
}

}  // namespace

void PlanarEngine::step(double h_s, std::uint64_t) {
  if (!(h_s > 0) || failure_) return;
  refresh_walls();
  for_each(order_.size(), 512, [&](std::size_t i) { begin(order_[i], h_s); });
  if (explosion_.lump != none) {
    failure_ = exploded(explosion_.lump, explosion_.v, explosion_.w_radps);
    return;
  }
  if (!ground_fresh_ || ground_varies_) {
    if (!ground_fresh_) {
      double highest = 0;
      for (const std::uint32_t slot : order_)
        if (instances_[slot].moves) highest = std::max(highest, instances_[slot].plan->bottom_m);
      ground_varies_ = !zones_.empty() || rule_ ||
                       std::any_of(order_.begin(), order_.end(),
                                   [&](std::uint32_t slot) {
                                     return instances_[slot].moves && !instances_[slot].plan->plain;
                                   }) ||
                       std::any_of(floors_.begin(), floors_.end(), [&](const Floor& f) {
                         return (f.wall != none || !is_plain(*f.face.surface)) &&
                                f.z_m <= highest + spec_.clearance_m;
                       });
    }
    for_each(lumps_.size(), 512, [&](std::size_t k) {
      if (lumps_[k].slot != none) find_ground(static_cast<std::uint32_t>(k));
    });
    ground_fresh_ = true;
  }
  if (!filed_) file(h_s);
  find_touches(h_s);
  find_islands(h_s);
  for_each(island_count_, 8, [&](std::size_t i) { solve(islands_[i], h_s); });
  for_each(lumps_.size(), 512, [&](std::size_t k) {
    if (lumps_[k].slot != none && island_of_[k] == none) move_alone(static_cast<std::uint32_t>(k), h_s);
  });
  for (const std::uint32_t slot : order_)
    if (briefs_[slot].guided) arrive(slot);
  touches_.clear();
  for (std::size_t i = 0; i < island_count_; ++i)
    touches_.insert(touches_.end(), islands_[i].touches.begin(), islands_[i].touches.end());
  std::sort(touches_.begin(), touches_.end(), [](const Touch& x, const Touch& y) { return x.key < y.key; });
  turn_joints(h_s);
  list_contacts(h_s);
  measure_grips(h_s);
  stale();
}

/// Velocities before contacts: wrenches, drives, paths.
void PlanarEngine::begin(std::uint32_t slot, double h_s) {
  const Brief& brief = briefs_[slot];
  if (!brief.moves) return;
  const std::span<const std::uint32_t> lumps = brief.lump != none ? std::span(&brief.lump, 1)
                                                                  : std::span(instances_[slot].lumps);
  Drive& drive = drives_[slot];
  if (brief.guided) {
    lead(slot, h_s);
  } else {
    bool pushed = false;
    for (const std::uint32_t k : lumps) {
      Lump& lump = lumps_[k];
      if (lump.force_N == Vec2{} && lump.torque_Nm == 0) continue;
      const Vec2 v = lump.v + (h_s * lump.inverse_kg) * lump.force_N;
      const double w = lump.w_radps + h_s * lump.inverse_kgm2 * lump.torque_Nm;
      if (!is_sound(v, w)) {
        explode(k, v, w);
        continue;
      }
      lump.v = v;
      lump.w_radps = w;
      lump.force_N = {};
      lump.torque_Nm = 0;
      pushed = true;
    }
    if (drive.active) {
      Lump& lump = lumps_[lumps[0]];
      if (pushed) {
        drive.now = {
            rotate_back(lump.heading * drive.frame, lump.velocity_at(rotate(lump.heading, drive.arm))),
            lump.w_radps};
      }
      const Twist had = drive.now;
      const Vec2 v = lump.v;
      const double w = lump.w_radps;
      plan_drive(slot, lump, h_s);
      if (!is_sound(lump.v, lump.w_radps)) {
        explode(lumps[0], lump.v, lump.w_radps);
        drive.now = had, lump.v = v, lump.w_radps = w;
      }
    }
  }
  const bool filed = filed_.load(std::memory_order_relaxed);
  for (const std::uint32_t k : lumps) {
    Lump& lump = lumps_[k];
    if (!is_sound(lump.v, lump.w_radps)) explode(k, lump.v, lump.w_radps);
    lump.reach_m = reach(lump, h_s);
    if (!(drive.active && lump.index == 0)) {  // else nothing rubs
      rubbing_[k].impulse = {};
      rubbing_[k].twist = 0;
    }
    // The candidates must hold all that may touch in this step.
    if (!filed) continue;
    const Vec2 d = map_.discs()[k].centre - filed_at_[k];
    const double left = slack_m_[k] - lump.reach_m;
    if (!(left >= 0 && dot(d, d) <= left * left)) filed_.store(false, std::memory_order_relaxed);
  }
}

void PlanarEngine::plan_drive(std::uint32_t slot, Lump& lump, double h_s) {
  Drive& drive = drives_[slot];
  Vec2 turning{drive.now.w_radps, 0};
  Twist mean;
  mean.v_mps = ramp(drive.now.v_mps, drive.target.v_mps, drive.accel, h_s);
  mean.w_radps = ramp(turning, {drive.target.w_radps, 0}, drive.angular_accel, h_s).x;
  drive.now.w_radps = turning.x;
  // From the drive's frame to the centre of mass: v_C = v_L - w x r_CL.
  const Vec2 v_mps = rotate(drive.frame, mean.v_mps) - mean.w_radps * left_of(drive.arm);
  means_[slot] = {v_mps, mean.w_radps};
  // The chord of the arc, so that a step along it ends on the arc.
  const double half = 0.5 * mean.w_radps * h_s;
  Turn middle = lump.heading;
  double sinc = 1;
  if (half != 0) {
    const Turn turn = turn_of(half);
    sinc = std::abs(half) <= math::pi / 4 ? small_sinc(half) : turn.s / half;
    middle = lump.heading * turn;
  }
  lump.v = sinc * rotate(middle, v_mps);
  lump.w_radps = mean.w_radps;
}

/// What a drive has reached, after its lump has moved as planned.
void PlanarEngine::finish_drive(std::uint32_t slot, Lump& lump, double h_s) {
  Drive& drive = drives_[slot];
  const Vec2 v = rotate(drive.frame, drive.now.v_mps) - drive.now.w_radps * left_of(drive.arm);
  lump.v = rotate(lump.heading, v);
  lump.w_radps = drive.now.w_radps;
  drive.way_m = drive.way_m + h_s * means_[slot].v_mps;
  drive.turned_rad += h_s * means_[slot].w_radps;
}

/// The same of one that was hindered: the arc from where it was to where it has come.
void PlanarEngine::finish_hindered(std::uint32_t slot, Lump& lump, const Planned& planned) {
  Drive& drive = drives_[slot];
  const Turn turn = Turn{planned.heading.c, -planned.heading.s} * lump.heading;
  const double half = 0.5 * math::atan2(turn.s, turn.c);
  const double sinc = std::abs(half) <= math::pi / 4 ? small_sinc(half) : turn_of(half).s / half;
  drive.way_m = drive.way_m + (1 / sinc) * rotate_back(planned.heading * turn_of(half), lump.p - planned.p);
  drive.turned_rad += 2 * half;
  drive.now = {rotate_back(lump.heading * drive.frame, lump.velocity_at(rotate(lump.heading, drive.arm))),
               lump.w_radps};
}

/// How far a lump can come in a step at most: what comes of a collision has to wait for the next.
double PlanarEngine::reach(const Lump& lump, double h_s) const {
  return lump.plan->reach_share_m + 2 * h_s * std::sqrt(dot(lump.v, lump.v));
}

// --- broad phase ----------------------------------------------------------------------------------------------------

void PlanarEngine::file(double) {
  const auto count = static_cast<std::uint32_t>(lumps_.size());
  filed_at_.resize(count);
  slack_m_.resize(count);
  candidates_.clear();
  std::uint32_t columns = 16;
  while (std::uint64_t{columns} * columns < std::uint64_t{count} * 4) columns *= 2;
  if (cells_.columns() != columns || !filed_) cells_.resize(spec_.cell_m, columns, columns);
  const auto area = [&](std::uint32_t k) {
    const double r = map_.discs()[k].radius_m + slack_m_[k];
    const Vec2 c = filed_at_[k];
    return Area{{c.x - r, c.y - r}, {c.x + r, c.y + r}};
  };
  cells_.build(count, [&](std::uint32_t k) {
    const Disc& disc = map_.discs()[k];
    filed_at_[k] = disc.centre;
    slack_m_[k] = lumps_[k].reach_m + std::min(0.5 * disc.radius_m, 0.05);
    if (lumps_[k].slot == none || !(disc.radius_m > 0)) return Cells::Range{};
    return cells_.cover(area(k));
  });
  const auto meets = [&](std::uint32_t a, std::uint32_t b) {
    const Disc &x = map_.discs()[a], &y = map_.discs()[b];
    const double far = x.radius_m + y.radius_m + slack_m_[a] + slack_m_[b];
    const Vec2 d = y.centre - x.centre;
    if (!(dot(d, d) < far * far) || !meet(x.heights, y.heights, spec_.clearance_m)) return;
    const Lump *first = &lumps_[a], *second = &lumps_[b];
    if (first->inverse_kg == 0 && second->inverse_kg == 0) return;
    if (first->slot == second->slot) {
      if (first->index > second->index) std::swap(a, b), std::swap(first, second);
      const Instance& instance = instances_[first->slot];
      if (!instance.model->self_collide) return;
      for (const Linkage& l : instance.linkages)
        if ((l.a == a && l.b == b) || (l.a == b && l.b == a)) return;
    } else if (instances_[first->slot].created > instances_[second->slot].created) {
      std::swap(a, b), std::swap(first, second);
    }
    candidates_.push_back(
        {{instances_[first->slot].created << 32 | (instances_[second->slot].created & 0xffffffffu),
          first->index << 16 | second->index},
         a,
         b});
  };
  for (std::uint32_t s = 0; s < cells_.columns() * cells_.rows(); ++s) {
    const auto in = cells_.in_slot(s);
    for (std::size_t i = 0; i + 1 < in.size(); ++i)
      for (std::size_t j = i + 1; j < in.size(); ++j) meets(in[i], in[j]);
  }
  if (!map_.walls().empty())
    for (std::uint32_t k = 0; k < count; ++k) {
      const Disc& disc = map_.discs()[k];
      const Lump& lump = lumps_[k];
      if (lump.slot == none || !(disc.radius_m > 0) || lump.inverse_kg == 0) continue;
      map_.walls_near(area(k), near_walls_);
      for (const std::uint32_t w : near_walls_) {
        const Wall& wall = map_.walls()[w];
        if (!meet(disc.heights, wall.outline.heights, spec_.clearance_m)) continue;
        const Vec2 d = wall.outline.centre - disc.centre;
        const double far = disc.radius_m + slack_m_[k] + wall.outline.radius_m;
        if (!(dot(d, d) < far * far)) continue;
        if (!(nearest(wall.outline, map_.edges(), disc.centre).distance_m < disc.radius_m + slack_m_[k]))
          continue;
        const std::uint64_t mine = instances_[lump.slot].created, its = instances_[wall.instance].created;
        Candidate c{.key = {}, .wall = w};
        if (mine < its) {
          c.key = {mine << 32 | (its & 0xffffffffu), lump.index << 16, 0, wall.ordinal};
          c.a = k;
        } else {
          c.key = {its << 32 | (mine & 0xffffffffu), lump.index, wall.ordinal};
          c.b = k;
        }
        candidates_.push_back(c);
      }
    }
  const auto before = [](const Candidate& x, const Candidate& y) { return x.key < y.key; };
  std::sort(candidates_.begin(), candidates_.end(), before);
  candidates_.erase(std::unique(candidates_.begin(), candidates_.end(),
                                [](const Candidate& x, const Candidate& y) { return x.key == y.key; }),
                    candidates_.end());
  filed_ = true;
}

// --- islands --------------------------------------------------------------------------------------------------------

void PlanarEngine::find_touches(double h_s) {
  found_.clear();
  for (const Candidate& c : candidates_) collide(c, h_s, found_);
  const auto before = [](const Touch& x, const Touch& y) { return x.key < y.key; };
  if (!std::is_sorted(found_.begin(), found_.end(), before)) std::sort(found_.begin(), found_.end(), before);
  remember(found_);
}

void PlanarEngine::refresh_linked() {
  if (std::exchange(linked_fresh_, true)) return;
  linked_.clear();
  for (const std::uint32_t slot : order_)
    if (!instances_[slot].linkages.empty()) linked_.push_back(slot);
}

std::uint32_t PlanarEngine::root(std::uint32_t k) {
  while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
  return k;
}

void PlanarEngine::unite(std::uint32_t a, std::uint32_t b) {
  const auto join = [&](std::uint32_t k) { return k == none || lumps_[k].inverse_kg == 0 ? none : k; };
  a = join(a), b = join(b);
  for (const std::uint32_t k : {a, b})
    if (k != none && island_of_[k] == none) island_of_[k] = 0, marked_.push_back(k);
  if (a == none || b == none) return;
  a = root(a), b = root(b);
  // Towards the smaller index: nothing depends on it but the shape of the forest.
  if (a != b) parent_[std::max(a, b)] = std::min(a, b);
}

void PlanarEngine::find_islands(double h_s) {
  const std::size_t count = lumps_.size();
  parent_.resize(count);
  island_of_.assign(count, none);
  marked_.clear();
  for (std::uint32_t k = 0; k < count; ++k) parent_[k] = k;
  for (const Touch& t : found_) unite(t.a, t.b);
  island_linkages_.clear();
  refresh_linked();
  for (const std::uint32_t slot : linked_)
    for (Linkage& l : instances_[slot].linkages) island_linkages_.push_back(&l);
  for (Linkage& l : grips_)
    if (l.a != none || l.b != none) island_linkages_.push_back(&l);
  for (const Linkage* l : island_linkages_) unite(l->a, l->b);
  // Whoever is fast goes from impact to impact together with all that it may hit on the way.
  const double fast = 0.25;
  const auto core = [&](std::uint32_t k) {
    return k == none ? std::numeric_limits<double>::infinity() : lumps_[k].plan->core_m;
  };
  const auto way = [&](std::uint32_t k) {
    if (k == none) return 0.0;
    const Lump& lump = lumps_[k];
    const double turned = lump.figure == none ? 0 : h_s * std::abs(lump.w_radps) * map_.discs()[k].radius_m;
    return lump.reach_m - lump.plan->reach_share_m + turned;
  };
  for (int pass = 0; pass < 2; ++pass) {
    fastest_.resize(count);  // 0 but for those in islands
    for (const std::uint32_t k : marked_) fastest_[k] = 0;
    for (const std::uint32_t k : marked_) fastest_[root(k)] = std::max(fastest_[root(k)], way(k));
    for (const Candidate& c : candidates_) {
      const double most = std::max(way(c.a), way(c.b)), least = std::min(core(c.a), core(c.b));
      const bool hit_on = (c.a != none && island_of_[c.a] != none) ||
                          (c.b != none && island_of_[c.b] != none);
      const auto fast_root = [&](std::uint32_t k) { return k != none && fastest_[root(k)] > fast * least; };
      if (most > fast * least || (hit_on && (fast_root(c.a) || fast_root(c.b))))
        if (near(c, h_s)) unite(c.a, c.b);
    }
  }
  for (const std::uint32_t k : marked_) fastest_[k] = 0;
  island_count_ = 0;
  // Islands in the order of their first lumps' creation.
  std::sort(marked_.begin(), marked_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Lump &x = lumps_[a], &y = lumps_[b];
    return x.slot == y.slot ? x.index < y.index : instances_[x.slot].created < instances_[y.slot].created;
  });
  island_slots_.resize(count);  // by root: its island
  for (const std::uint32_t k : marked_) island_slots_[k] = none;
  for (const std::uint32_t k : marked_) {
    std::uint32_t& island = island_slots_[root(k)];
    if (island == none) {
      island = static_cast<std::uint32_t>(island_count_++);
      if (islands_.size() < island_count_) islands_.emplace_back();
      Island& fresh = islands_[island];
      fresh.lumps = fresh.candidates = fresh.linkages = 0;
      fresh.touches.clear();
    }
    island_of_[k] = island;
    ++islands_[island].lumps;
  }
  const auto island_at = [&](std::uint32_t a, std::uint32_t b) {
    if (a != none && island_of_[a] != none) return island_of_[a];
    return b != none ? island_of_[b] : none;
  };
  // Two islands that are near each other but slow do not look at each other: they are solved at the same time.
  const auto island_of_pair = [&](const Candidate& c) {
    const bool apart = c.a != none && c.b != none && island_of_[c.a] != none && island_of_[c.b] != none &&
                       island_of_[c.a] != island_of_[c.b];
    return apart ? none : island_at(c.a, c.b);
  };
  for (const Candidate& c : candidates_)
    if (const std::uint32_t i = island_of_pair(c); i != none) ++islands_[i].candidates;
  for (const Linkage* l : island_linkages_)
    if (const std::uint32_t i = island_at(l->a, l->b); i != none) ++islands_[i].linkages;
  std::uint32_t lump = 0, candidate = 0, linkage = 0;
  for (std::size_t i = 0; i < island_count_; ++i) {
    Island& island = islands_[i];
    island.first_lump = lump, island.first_candidate = candidate, island.first_linkage = linkage;
    lump += island.lumps, candidate += island.candidates, linkage += island.linkages;
    island.lumps = island.candidates = island.linkages = 0;
  }
  island_lumps_.resize(lump);
  island_candidates_.resize(candidate);
  sorted_linkages_.resize(linkage);
  for (const std::uint32_t k : marked_) {
    Island& island = islands_[island_of_[k]];
    island_lumps_[island.first_lump + island.lumps++] = k;
  }
  planned_.resize(lump);
  left_m_.resize(lump);
  for (const Candidate& c : candidates_)
    if (const std::uint32_t i = island_of_pair(c); i != none)
      island_candidates_[islands_[i].first_candidate + islands_[i].candidates++] = c;
  for (Linkage* l : island_linkages_)
    if (const std::uint32_t i = island_at(l->a, l->b); i != none)
      sorted_linkages_[islands_[i].first_linkage + islands_[i].linkages++] = l;
  for (const Touch& t : found_)
    if (const std::uint32_t i = island_at(t.a, t.b); i != none) islands_[i].touches.push_back(t);
}

// --- afterwards -----------------------------------------------------------------------------------------------------

/// Joints that are moved as their targets say.
void PlanarEngine::turn_joints(double h_s) {
  std::erase_if(turning_, [&](std::uint32_t k) {
    Motor& motor = motors_[k];
    JointState& joint = joint_states_[k];
    const bool moved = motor.role == Motor::Role::kinematic ||
                       (motor.role == Motor::Role::wheel && drives_[motor.slot].active);
    const bool asked = motor.slot != none && motor.target.mode == JointTarget::Mode::velocity;
    if (moved && motor.roll == none) {
      joint.velocity = joint.effort = 0;
      if (asked && motor.target.max_effort > 0) {
        const double before = joint.position;
        const double velocity = std::clamp(motor.target.velocity, -motor.max_velocity(),
                                           motor.max_velocity());
        const double goal = before + velocity * h_s;
        joint.position = std::clamp(goal, std::min(motor.lower(), before), std::max(motor.upper(), before));
        joint.velocity = joint.position == goal ? velocity : (joint.position - before) / h_s;
      }
    }
    motor.listed = asked;
    return !asked;
  });
}

void PlanarEngine::list_contacts(double h_s) {
  contacts_.clear();
  for (const Touch& t : touches_) {
    const double normal_Ns = t.normal_Ns + t.bounce_Ns;
    if (!(normal_Ns > 0) && t.gap_m > 0) continue;
    const Vec2 force = (1 / h_s) *
                       (normal_Ns * t.normal + (t.tangent_Ns + t.bounce_tangent_Ns) * left_of(t.normal));
    contacts_.push_back({body_id(t.body_a),
                         body_id(t.body_b),
                         {t.at.x, t.at.y, t.z_m},
                         {t.normal.x, t.normal.y, 0},
                         std::max(-t.gap_m, 0.0),
                         {force.x, force.y, 0},
                         t.shape_a,
                         t.shape_b});
  }
}

}  // namespace sandlot::planar
