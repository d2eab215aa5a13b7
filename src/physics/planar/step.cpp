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
  if (explosion_.group != none) {
    failure_ = exploded(explosion_.group, explosion_.v, explosion_.w_radps);
    // Forgotten, so that the State can be saved, looked at and read back.
    for (RigidGroup& group : groups_) group.force_N = {}, group.torque_Nm = 0;
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
    for_each(groups_.size(), 512, [&](std::size_t k) {
      if (groups_[k].slot != none) find_ground(static_cast<std::uint32_t>(k));
    });
    ground_fresh_ = true;
  }
  if (!filed_) file(h_s);
  find_contact_points(h_s);
  find_islands(h_s);
  for_each(island_count_, 8, [&](std::size_t i) { solve(islands_[i], h_s); });
  for_each(groups_.size(), 512, [&](std::size_t k) {
    if (groups_[k].slot != none && island_of_[k] == none) move_alone(static_cast<std::uint32_t>(k), h_s);
  });
  for (const std::uint32_t slot : order_)
    if (summaries_[slot].guided) arrive(slot);
  contact_points_.clear();
  for (std::size_t i = 0; i < island_count_; ++i)
    contact_points_.insert(contact_points_.end(), islands_[i].contact_points.begin(),
                           islands_[i].contact_points.end());
  std::sort(contact_points_.begin(), contact_points_.end(),
            [](const ContactPoint& x, const ContactPoint& y) { return x.key < y.key; });
  turn_joints(h_s);
  list_contacts(h_s);
  measure_grips(h_s);
  stale();
}

/// Velocities before contacts: wrenches, drives, paths.
void PlanarEngine::begin(std::uint32_t slot, double h_s) {
  const InstanceSummary& summary = summaries_[slot];
  if (!summary.moves) return;
  const std::span<const std::uint32_t> groups = summary.group != none ? std::span(&summary.group, 1)
                                                                      : std::span(instances_[slot].groups);
  Drive& drive = drives_[slot];
  if (summary.guided) {
    lead(slot, h_s);
  } else {
    bool pushed = false;
    for (const std::uint32_t k : groups) {
      RigidGroup& group = groups_[k];
      if (group.force_N == Vec2{} && group.torque_Nm == 0) continue;
      const Vec2 v = group.v + (h_s * group.inverse_kg) * group.force_N;
      const double w = group.w_radps + h_s * group.inverse_kgm2 * group.torque_Nm;
      if (!is_sound(v, w)) {
        explode(k, v, w);
        continue;
      }
      group.v = v;
      group.w_radps = w;
      group.force_N = {};
      group.torque_Nm = 0;
      pushed = true;
    }
    if (drive.active) {
      RigidGroup& group = groups_[groups[0]];
      if (pushed) {
        drive.now = {
            rotate_back(group.heading * drive.frame, group.velocity_at(rotate(group.heading, drive.arm))),
            group.w_radps};
      }
      const Twist had = drive.now;
      const Vec2 v = group.v;
      const double w = group.w_radps;
      plan_drive(slot, group, h_s);
      if (!is_sound(group.v, group.w_radps)) {
        explode(groups[0], group.v, group.w_radps);
        drive.now = had, group.v = v, group.w_radps = w;
      }
    }
  }
  const bool filed = filed_.load(std::memory_order_relaxed);
  for (const std::uint32_t k : groups) {
    RigidGroup& group = groups_[k];
    if (!is_sound(group.v, group.w_radps)) explode(k, group.v, group.w_radps);
    group.reach_m = reach(group, h_s);
    if (!(drive.active && group.index == 0)) {  // else nothing rubs
      ground_friction_[k].impulse = {};
      ground_friction_[k].twist = 0;
    }
    // The candidates must hold all that may touch in this step.
    if (!filed) continue;
    const Vec2 d = map_.discs()[k].centre - filed_at_[k];
    const double left = slack_m_[k] - group.reach_m;
    if (!(left >= 0 && dot(d, d) <= left * left)) filed_.store(false, std::memory_order_relaxed);
  }
}

void PlanarEngine::plan_drive(std::uint32_t slot, RigidGroup& group, double h_s) {
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
  Turn middle = group.heading;
  double sinc = 1;
  if (half != 0) {
    const Turn turn = turn_of(half);
    sinc = std::abs(half) <= math::pi / 4 ? small_sinc(half) : turn.s / half;
    middle = group.heading * turn;
  }
  group.v = sinc * rotate(middle, v_mps);
  group.w_radps = mean.w_radps;
}

/// Takes over the motion of a drive after its group has moved as planned.
void PlanarEngine::finish_drive(std::uint32_t slot, RigidGroup& group, double h_s) {
  Drive& drive = drives_[slot];
  const Vec2 v = rotate(drive.frame, drive.now.v_mps) - drive.now.w_radps * left_of(drive.arm);
  group.v = rotate(group.heading, v);
  group.w_radps = drive.now.w_radps;
  drive.way_m = drive.way_m + h_s * means_[slot].v_mps;
  drive.turned_rad += h_s * means_[slot].w_radps;
}

/// The same of one that was hindered: the arc from where it was to where it has come.
void PlanarEngine::finish_hindered(std::uint32_t slot, RigidGroup& group, const Planned& planned) {
  Drive& drive = drives_[slot];
  const Turn turn = Turn{planned.heading.c, -planned.heading.s} * group.heading;
  const double half = 0.5 * math::atan2(turn.s, turn.c);
  const double sinc = std::abs(half) <= math::pi / 4 ? small_sinc(half) : turn_of(half).s / half;
  drive.way_m = drive.way_m + (1 / sinc) * rotate_back(planned.heading * turn_of(half), group.p - planned.p);
  drive.turned_rad += 2 * half;
  drive.now = {rotate_back(group.heading * drive.frame, group.velocity_at(rotate(group.heading, drive.arm))),
               group.w_radps};
}

/// Largest way of a group in a step: what follows from a collision has to wait for the next.
double PlanarEngine::reach(const RigidGroup& group, double h_s) const {
  return group.plan->reach_share_m + 2 * h_s * std::sqrt(dot(group.v, group.v));
}

// --- broad phase -------------------------------------------------------------------------------------------

void PlanarEngine::file(double) {
  const auto count = static_cast<std::uint32_t>(groups_.size());
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
    slack_m_[k] = groups_[k].reach_m + std::min(0.5 * disc.radius_m, 0.05);
    if (groups_[k].slot == none || !(disc.radius_m > 0)) return HashGrid::Range{};
    return cells_.cover(area(k));
  });
  const auto meets = [&](std::uint32_t a, std::uint32_t b) {
    const Disc &x = map_.discs()[a], &y = map_.discs()[b];
    const double far = x.radius_m + y.radius_m + slack_m_[a] + slack_m_[b];
    const Vec2 d = y.centre - x.centre;
    if (!(dot(d, d) < far * far) || !meet(x.heights, y.heights, spec_.clearance_m)) return;
    const RigidGroup *first = &groups_[a], *second = &groups_[b];
    if (first->inverse_kg == 0 && second->inverse_kg == 0) return;
    if (first->slot == second->slot) {
      if (first->index > second->index) std::swap(a, b), std::swap(first, second);
      const Instance& instance = instances_[first->slot];
      if (!instance.model->self_collide) return;
      for (const JointConstraint& l : instance.constraints)
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
      const RigidGroup& group = groups_[k];
      if (group.slot == none || !(disc.radius_m > 0) || group.inverse_kg == 0) continue;
      map_.walls_near(area(k), near_walls_);
      for (const std::uint32_t w : near_walls_) {
        const Wall& wall = map_.walls()[w];
        if (!meet(disc.heights, wall.outline.heights, spec_.clearance_m)) continue;
        const Vec2 d = wall.outline.centre - disc.centre;
        const double far = disc.radius_m + slack_m_[k] + wall.outline.radius_m;
        if (!(dot(d, d) < far * far)) continue;
        if (!(nearest(wall.outline, map_.edges(), disc.centre).distance_m < disc.radius_m + slack_m_[k]))
          continue;
        const std::uint64_t mine = instances_[group.slot].created, its = instances_[wall.instance].created;
        Candidate c{.key = {}, .wall = w};
        if (mine < its) {
          c.key = {mine << 32 | (its & 0xffffffffu), group.index << 16, 0, wall.ordinal};
          c.a = k;
        } else {
          c.key = {its << 32 | (mine & 0xffffffffu), group.index, wall.ordinal};
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

// --- islands -----------------------------------------------------------------------------------------------

void PlanarEngine::find_contact_points(double h_s) {
  found_.clear();
  for (const Candidate& c : candidates_) collide(c, h_s, found_);
  const auto before = [](const ContactPoint& x, const ContactPoint& y) { return x.key < y.key; };
  if (!std::is_sorted(found_.begin(), found_.end(), before)) std::sort(found_.begin(), found_.end(), before);
  remember(found_);
}

void PlanarEngine::refresh_linked() {
  if (std::exchange(linked_fresh_, true)) return;
  linked_.clear();
  for (const std::uint32_t slot : order_)
    if (!instances_[slot].constraints.empty()) linked_.push_back(slot);
}

std::uint32_t PlanarEngine::root(std::uint32_t k) {
  while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
  return k;
}

void PlanarEngine::unite(std::uint32_t a, std::uint32_t b) {
  const auto join = [&](std::uint32_t k) { return k == none || groups_[k].inverse_kg == 0 ? none : k; };
  a = join(a), b = join(b);
  for (const std::uint32_t k : {a, b})
    if (k != none && island_of_[k] == none) island_of_[k] = 0, marked_.push_back(k);
  if (a == none || b == none) return;
  a = root(a), b = root(b);
  // Towards the smaller index: nothing depends on it but the shape of the forest.
  if (a != b) parent_[std::max(a, b)] = std::min(a, b);
}

void PlanarEngine::find_islands(double h_s) {
  const std::size_t count = groups_.size();
  parent_.resize(count);
  island_of_.assign(count, none);
  marked_.clear();
  for (std::uint32_t k = 0; k < count; ++k) parent_[k] = k;
  for (const ContactPoint& t : found_) unite(t.a, t.b);
  island_constraints_.clear();
  refresh_linked();
  for (const std::uint32_t slot : linked_)
    for (JointConstraint& l : instances_[slot].constraints) island_constraints_.push_back(&l);
  for (JointConstraint& l : grips_)
    if (l.a != none || l.b != none) island_constraints_.push_back(&l);
  for (const JointConstraint* l : island_constraints_) unite(l->a, l->b);
  // Whoever is fast goes from impact to impact together with all that it may hit on the way.
  const double fast = 0.25;
  const auto core = [&](std::uint32_t k) {
    return k == none ? std::numeric_limits<double>::infinity() : groups_[k].plan->core_m;
  };
  const auto way = [&](std::uint32_t k) {
    if (k == none) return 0.0;
    const RigidGroup& group = groups_[k];
    const double turned = group.silhouette == none ? 0
                                                   : h_s * std::abs(group.w_radps) * map_.discs()[k].radius_m;
    return group.reach_m - group.plan->reach_share_m + turned;
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
  // Islands in the order of their first groups' creation.
  std::sort(marked_.begin(), marked_.end(), [&](std::uint32_t a, std::uint32_t b) {
    const RigidGroup &x = groups_[a], &y = groups_[b];
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
      fresh.groups = fresh.candidates = fresh.constraints = 0;
      fresh.contact_points.clear();
    }
    island_of_[k] = island;
    ++islands_[island].groups;
  }
  const auto island_at = [&](std::uint32_t a, std::uint32_t b) {
    if (a != none && island_of_[a] != none) return island_of_[a];
    return b != none ? island_of_[b] : none;
  };
  // Two islands that are near each other but slow do not look at each other: they are solved at the same
  // time.
  const auto island_of_pair = [&](const Candidate& c) {
    const bool apart = c.a != none && c.b != none && island_of_[c.a] != none && island_of_[c.b] != none &&
                       island_of_[c.a] != island_of_[c.b];
    return apart ? none : island_at(c.a, c.b);
  };
  for (const Candidate& c : candidates_)
    if (const std::uint32_t i = island_of_pair(c); i != none) ++islands_[i].candidates;
  for (const JointConstraint* l : island_constraints_)
    if (const std::uint32_t i = island_at(l->a, l->b); i != none) ++islands_[i].constraints;
  std::uint32_t group = 0, candidate = 0, constraint = 0;
  for (std::size_t i = 0; i < island_count_; ++i) {
    Island& island = islands_[i];
    island.first_group = group, island.first_candidate = candidate, island.first_constraint = constraint;
    group += island.groups, candidate += island.candidates, constraint += island.constraints;
    island.groups = island.candidates = island.constraints = 0;
  }
  island_groups_.resize(group);
  island_candidates_.resize(candidate);
  sorted_constraints_.resize(constraint);
  for (const std::uint32_t k : marked_) {
    Island& island = islands_[island_of_[k]];
    island_groups_[island.first_group + island.groups++] = k;
  }
  planned_.resize(group);
  left_m_.resize(group);
  for (const Candidate& c : candidates_)
    if (const std::uint32_t i = island_of_pair(c); i != none)
      island_candidates_[islands_[i].first_candidate + islands_[i].candidates++] = c;
  for (JointConstraint* l : island_constraints_)
    if (const std::uint32_t i = island_at(l->a, l->b); i != none)
      sorted_constraints_[islands_[i].first_constraint + islands_[i].constraints++] = l;
  for (const ContactPoint& t : found_)
    if (const std::uint32_t i = island_at(t.a, t.b); i != none) islands_[i].contact_points.push_back(t);
}

// --- afterwards --------------------------------------------------------------------------------------------

/// Joints that follow their targets exactly.
void PlanarEngine::turn_joints(double h_s) {
  std::erase_if(turning_, [&](std::uint32_t k) {
    Motor& motor = motors_[k];
    JointState& joint = joint_states_[k];
    const bool moved = motor.role == Motor::Role::kinematic ||
                       (motor.role == Motor::Role::wheel && drives_[motor.slot].active);
    const bool driven = motor.slot != none && motor.target.mode == JointTarget::Mode::velocity;
    if (moved && motor.roll == none) {
      joint.velocity = joint.effort = 0;
      if (driven && motor.target.max_effort > 0) {
        const double before = joint.position;
        const double velocity = std::clamp(motor.target.velocity, -motor.max_velocity(),
                                           motor.max_velocity());
        const double goal = before + velocity * h_s;
        joint.position = std::clamp(goal, std::min(motor.lower(), before), std::max(motor.upper(), before));
        joint.velocity = joint.position == goal ? velocity : (joint.position - before) / h_s;
      }
    }
    motor.listed = driven;
    return !driven;
  });
}

void PlanarEngine::list_contacts(double h_s) {
  contacts_.clear();
  for (const ContactPoint& t : contact_points_) {
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
