// Grips: welds that come and go.
#include <algorithm>
#include <utility>

#include "base/check.h"
#include "physics/planar/planar.h"

namespace sandlot::planar {

void PlanarEngine::set_grips(std::span<const GripTarget> targets) {
  const auto place = [&](BodyId id) {
    const Instance& instance = instances_[slot_of(id)];
    const auto link = std::find(instance.bodies.begin(), instance.bodies.end(), id) - instance.bodies.begin();
    return std::pair{instance.created, static_cast<std::uint64_t>(link)};
  };
  for (const GripTarget& t : targets) {
    const bool in_order = place(t.a) < place(t.b);
    const BodyId a = in_order ? t.a : t.b, b = in_order ? t.b : t.a;
    const auto same = std::find_if(grips_.begin(), grips_.end(),
                                   [&](const JointConstraint& l) { return l.body_a == a && l.body_b == b; });
    if (!t.hold && same != grips_.end()) grips_.erase(same);
    if (!t.hold || same != grips_.end()) continue;
    const auto guided = [&](BodyId id) { return instances_[body_slot_[id.index]].guided; };
    if (guided(a) || guided(b)) continue;
    // Two that stand still, or are one group, hold each other anyway.
    if (const JointConstraint grip = make_grip(a, b); grip.a != grip.b) grips_.push_back(grip);
  }
  if (targets.empty()) return;
  std::sort(grips_.begin(), grips_.end(), [&](const JointConstraint& x, const JointConstraint& y) {
    const auto key = [&](const JointConstraint& l) { return std::pair{place(l.body_b), place(l.body_a)}; };
    return key(x) < key(y);
  });
  list_grips();
}

/// All grips of an instance.
void PlanarEngine::let_go(std::uint32_t slot) {
  if (grips_.empty()) return;
  std::erase_if(grips_, [&](const JointConstraint& l) {
    return body_slot_[l.body_a.index] == slot || body_slot_[l.body_b.index] == slot;
  });
  list_grips();
}

/// State of the grips for grips(); forces are those of the last step where there was one.
void PlanarEngine::list_grips() {
  std::vector<Grip> before;
  swap(before, published_grips_);
  for (const JointConstraint& l : grips_) {
    const auto same = std::find_if(before.begin(), before.end(),
                                   [&](const Grip& g) { return g.a == l.body_a && g.b == l.body_b; });
    published_grips_.push_back(same != before.end() ? *same : Grip{l.body_a, l.body_b, {}});
  }
}

void PlanarEngine::measure_grips(double h_s) {
  for (std::size_t i = 0; i < grips_.size(); ++i)
    published_grips_[i].force_N = {grips_[i].hold.x / h_s, grips_[i].hold.y / h_s, 0};
}

/// These two do not collide.
bool PlanarEngine::hold_each_other(const Candidate& c) const {
  const auto is = [&](std::uint32_t group, BodyId body, std::uint32_t side) {
    if (side != none || c.wall == none) return group == side;
    return group == none && body_slot_[body.index] == map_.walls()[c.wall].instance;
  };
  return std::any_of(grips_.begin(), grips_.end(), [&](const JointConstraint& l) {
    return (is(l.a, l.body_a, c.a) && is(l.b, l.body_b, c.b)) ||
           (is(l.a, l.body_a, c.b) && is(l.b, l.body_b, c.a));
  });
}

JointConstraint PlanarEngine::make_grip(BodyId a, BodyId b) const {
  JointConstraint l;
  l.body_a = a;
  l.body_b = b;
  const auto group_of = [&](BodyId id) {
    const Instance& instance = instances_[body_slot_[id.index]];
    if (!instance.moves) return none;
    for (std::size_t i = 0; i < instance.bodies.size(); ++i)
      if (instance.bodies[i] == id) return instance.groups[instance.plan->group_of_link[i]];
    return none;
  };
  l.a = group_of(a);
  l.b = group_of(b);
  // The anchor lies in the middle, where neither gets a longer arm than it needs.
  const Vec2 in_a = l.a != none ? groups_[l.a].p : groups_[l.b == none ? 0 : l.b].p;
  const Vec2 in_b = l.b != none ? groups_[l.b].p : in_a;
  if (l.a == none && l.b == none) return l;
  const Vec2 at = 0.5 * (in_a + in_b);
  const auto local = [&](std::uint32_t k) {
    return k == none ? at : rotate_back(groups_[k].heading, at - groups_[k].p);
  };
  l.at_a = local(l.a);
  l.at_b = local(l.b);
  const Turn ha = l.a == none ? Turn{} : groups_[l.a].heading,
             hb = l.b == none ? Turn{} : groups_[l.b].heading;
  l.apart = Turn{ha.c, -ha.s} * hb;
  return l;
}

}  // namespace sandlot::planar
