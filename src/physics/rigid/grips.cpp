/// Grips: fixed joints between links of any two instances. They live for one sub-step, like contacts, in the
/// order of creation of what they hold, so that a restored engine solves the same rows in the same order.
#include <algorithm>
#include <tuple>

#include "base/check.h"
#include "physics/rigid/ode_vector.h"
#include "physics/rigid/rigid_engine.h"

namespace sandlot::rigid {
namespace {

Pose pose_of(const Body* body) { return body ? body->pose() : Pose{}; }

/// A roller is held by its wheel's body.
Body* holder(Body* body) { return body && body->carrier ? body->carrier : body; }

bool awake(const Body* body) { return body && body->awake; }

void put_at(dBodyID body, const Pose& X) {
  const dQuaternion q = {X.q.w, X.q.x, X.q.y, X.q.z};
  dBodySetPosition(body, X.p.x, X.p.y, X.p.z);
  dBodySetQuaternion(body, q);
}

}  // namespace

std::uint64_t RigidEngine::rank(const Instance& instance) const {
  return static_cast<std::uint64_t>(std::find(order_.begin(), order_.end(), &instance) - order_.begin());
}

/// A grip of two as they stand now; of two that cannot hold each other, or do so anyway, a and b are the
/// same.
Held RigidEngine::grip_of(BodyId one, BodyId other) const {
  const auto slot_of = [&](BodyId id) -> const LinkSlot& {
    SL_CHECK(id.index < link_slots_.size());
    const LinkSlot& slot = link_slots_[id.index];
    SL_CHECK_MSG(slot.instance && slot.generation == id.generation, "no such body");
    return slot;
  };
  const auto place = [&](BodyId id) { return std::pair{rank(*slot_of(id).instance), slot_of(id).link}; };
  if (place(other) < place(one)) std::swap(one, other);
  const LinkSlot &a = slot_of(one), &b = slot_of(other);
  Held grip{.link_a = one, .link_b = other, .instance_a = a.instance, .instance_b = b.instance};
  if (a.instance->guided || b.instance->guided) return grip;
  grip.a = holder(a.instance->links[a.link].body);
  grip.b = holder(b.instance->links[b.link].body);
  grip.X_AB = inverse(pose_of(grip.a)) * pose_of(grip.b);
  grip.X_AB.q = normalised(grip.X_AB.q);
  return grip;
}

void RigidEngine::keep(const Held& grip) {
  const auto key = [&](const Held& g) {
    return std::tuple{rank(*g.instance_b), link_slots_[g.link_b.index].link, rank(*g.instance_a),
                      link_slots_[g.link_a.index].link};
  };
  grips_.insert(std::upper_bound(grips_.begin(), grips_.end(), grip,
                                 [&](const Held& x, const Held& y) { return key(x) < key(y); }),
                grip);
  list_grips();
}

void RigidEngine::set_grips(std::span<const GripTarget> targets) {
  for (const GripTarget& t : targets) {
    const Held grip = grip_of(t.a, t.b);
    const auto same = std::find_if(grips_.begin(), grips_.end(), [&](const Held& g) {
      return g.link_a == grip.link_a && g.link_b == grip.link_b;
    });
    if (t.hold == (same != grips_.end()) || grip.a == grip.b) continue;
    wake_instance(*grip.instance_a);
    wake_instance(*grip.instance_b);
    if (t.hold) {
      keep(grip);
    } else {
      grips_.erase(same);
      list_grips();
    }
  }
}

void RigidEngine::let_go(const Instance& instance) {
  if (grips_.empty()) return;
  for (const Held& grip : grips_) {
    if (grip.instance_a == &instance) wake_instance(*grip.instance_b);
    if (grip.instance_b == &instance) wake_instance(*grip.instance_a);
  }
  std::erase_if(grips_,
                [&](const Held& g) { return g.instance_a == &instance || g.instance_b == &instance; });
  list_grips();
}

/// State of the grips for grips(); forces are those of the last sub-step where there was one.
void RigidEngine::list_grips() {
  std::vector<Grip> before;
  swap(before, published_grips_);
  for (const Held& held : grips_) {
    const auto same = std::find_if(before.begin(), before.end(),
                                   [&](const Grip& g) { return g.a == held.link_a && g.b == held.link_b; });
    published_grips_.push_back(same != before.end() ? *same : Grip{held.link_a, held.link_b, {}});
  }
}

/// A held body wakes with its holder.
void RigidEngine::wake_held() {
  for (const Held& grip : grips_)
    for (Body* const body : {grip.a, grip.b}) {
      if (!body || body->awake || (!awake(grip.a) && !awake(grip.b))) continue;
      wake_instance(*body->instance);
      for (Body& each : body->instance->bodies)
        put_orientation(each);  // ODE's own is not State: see step.cpp
    }
}

void RigidEngine::attach_grips() {
  wake_held();  // a contact may have woken one of two
  for (Held& grip : grips_) {
    grip.load = {};
    if (!awake(grip.a) && !awake(grip.b)) continue;
    const dJointID joint = dJointCreateFixed(world_, contact_joints_);
    // ODE takes the pose to be held from that of the bodies, so they stand so for a moment: with A at the
    // origin, where ODE's arithmetic is exact.
    if (grip.a) put_at(grip.a->ode, {});
    if (grip.b) put_at(grip.b->ode, grip.X_AB);
    dJointAttach(joint, grip.a ? grip.a->ode : grip.b->ode, grip.a && grip.b ? grip.b->ode : nullptr);
    if (!grip.b) put_at(grip.a->ode, inverse(grip.X_AB));
    dJointSetFixed(joint);
    for (const Body* const body : {grip.a, grip.b})
      if (body) put_at(body->ode, body->pose());
    dJointSetFeedback(joint, &grip.load);
  }
}

void RigidEngine::measure_grips() {
  for (std::size_t i = 0; i < grips_.size(); ++i) {
    const Held& grip = grips_[i];
    // The first body that was attached has f1; that of two is A.
    const Vec3 f1 = vec(grip.load.f1), t1 = vec(grip.load.t1), f2 = vec(grip.load.f2), t2 = vec(grip.load.t2);
    const bool both = grip.a && grip.b;
    published_grips_[i].force_N = both ? f2 : grip.b ? f1 : -f1;
    if (watched_joints_.empty()) continue;
    const auto push = [&](const Instance* instance, BodyId link, const Body* body, Vec3 force, Vec3 torque) {
      if (body) pushes_.push_back({instance, link_slots_[link.index].link, body->p, force, torque});
    };
    push(grip.instance_a, grip.link_a, grip.a, f1, t1);
    push(grip.instance_b, grip.link_b, grip.b, both ? f2 : f1, both ? t2 : t1);
  }
}

/// These two do not collide.
bool RigidEngine::hold_each_other(const Geom& a, const Geom& b) const {
  const auto is = [](const Body* body, const Instance* instance, const Geom& geom) {
    return body ? body == geom.body : !geom.body && instance == geom.instance;
  };
  return std::any_of(grips_.begin(), grips_.end(), [&](const Held& g) {
    return (is(g.a, g.instance_a, a) && is(g.b, g.instance_b, b)) ||
           (is(g.a, g.instance_a, b) && is(g.b, g.instance_b, a));
  });
}

/// A grip is State of the younger. The older is named by its place in the order of creation, which a new
/// engine with the same instances has too.
std::size_t RigidEngine::grips_of(const Instance& instance) const {
  return static_cast<std::size_t>(std::count_if(
      grips_.begin(), grips_.end(), [&](const Held& grip) { return grip.instance_b == &instance; }));
}

void RigidEngine::save_grips(const Instance& instance, ByteWriter& w) const {
  write(w, static_cast<std::uint32_t>(grips_of(instance)));
  for (const Held& grip : grips_) {
    if (grip.instance_b != &instance) continue;
    write(w, static_cast<std::uint32_t>(rank(*grip.instance_a)));
    write(w, link_slots_[grip.link_a.index].link);
    write(w, link_slots_[grip.link_b.index].link);
    write(w, grip.X_AB.p);
    write(w, grip.X_AB.q);
  }
}

bool RigidEngine::load_grips(Instance& instance, ByteReader& r) {
  constexpr std::uint32_t most = 1u << 20;
  std::uint32_t count = 0;
  read(r, count);
  if (!r.ok() || count == 0 || count > most) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint32_t other = 0, link_a = 0, link_b = 0;
    Pose X_AB;
    read(r, other);
    read(r, link_a);
    read(r, link_b);
    read(r, X_AB.p);
    read(r, X_AB.q);
    if (!r.ok() || other >= order_.size() || link_b >= instance.links.size() ||
        link_a >= order_[other]->links.size() || !(dot(X_AB.p, X_AB.p) < 1e24) ||
        !(std::abs(norm(X_AB.q) - 1) < 1e-6))
      return false;
    Held grip = grip_of(order_[other]->link_ids[link_a], instance.link_ids[link_b]);
    if (grip.a == grip.b || grip.instance_b != &instance) return false;
    grip.X_AB = X_AB;
    keep(grip);
  }
  return true;
}

}  // namespace sandlot::rigid
