#include <algorithm>
#include <limits>
#include <tuple>

#include "physics/rigid/rigid_engine.h"
#include "physics/rigid/surface.h"

namespace sandlot::rigid {
namespace {

bool is_awake(const Geom& g) { return g.body && g.body->awake; }
bool in_order(const Geom& a, const Geom& b) { return a.serial < b.serial; }

Vec3 vec(const dReal* v) { return {v[0], v[1], v[2]}; }

Vec3 velocity_at(const Geom& g, Vec3 point) {
  return g.body ? g.body->v + cross(g.body->w, point - g.body->p) : Vec3{};
}

}  // namespace

void RigidEngine::near(void* self, dGeomID a, dGeomID b) {
  if (dGeomIsSpace(a) || dGeomIsSpace(b)) return dSpaceCollide2(a, b, self, &near);
  static_cast<RigidEngine*>(self)->see_pair(static_cast<Geom*>(dGeomGetData(a)),
                                            static_cast<Geom*>(dGeomGetData(b)));
}

/// The broad phase found two bounding boxes that meet.
void RigidEngine::see_pair(Geom* a, Geom* b) {
  if (!a->body && !b->body) return;
  if (a->body == b->body) return;
  if (a->instance == b->instance) {
    if (!a->instance->model->self_collide) return;
    const auto bodies = std::minmax<const Body*>(a->body, b->body);
    for (const auto& joined : a->instance->joined)
      if (joined.first == bodies.first && joined.second == bodies.second) return;
  }
  if (!in_order(*a, *b)) std::swap(a, b);
  (is_awake(*a) || is_awake(*b) ? pairs_ : dormant_).push_back({a, b});
}

/// Finds contact points and wakes whom an awake body touches.
void RigidEngine::collide_pair(const Pair& pair) {
  const int n = dCollide(pair.a->ode, pair.b->ode, spec_.max_contacts, points_.data(), sizeof(dContactGeom));
  if (n == 0) return;
  for (int i = 0; i < n; ++i)
    hits_.push_back({pair.a, pair.b, static_cast<std::uint32_t>(i), points_[static_cast<std::size_t>(i)]});
  if (pair.a->body && !pair.a->body->awake) wake(*pair.a->body);
  if (pair.b->body && !pair.b->body->awake) wake(*pair.b->body);
}

/// All contact points of awake bodies, in the order in which their shapes were made.
void RigidEngine::collide() {
  pairs_.clear();
  dormant_.clear();
  hits_.clear();
  dSpaceCollide(space_, this, &near);
  for (Instance* instance : order_)
    if (instance->space && instance->model->self_collide) dSpaceCollide(instance->space, this, &near);

  const auto before = [](const Pair& x, const Pair& y) {
    return std::tie(x.a->serial, x.b->serial) < std::tie(y.a->serial, y.b->serial);
  };
  std::sort(pairs_.begin(), pairs_.end(), before);
  woke_ = false;
  for (const Pair& pair : pairs_) collide_pair(pair);
  if (!woke_) return;
  // Who was woken meets its neighbours in this very sub-step, else it would fall through what it lies on; they may
  // wake in turn. The set that is awake in the end does not depend on the order of the search.
  while (woke_) {
    woke_ = false;
    std::erase_if(dormant_, [&](const Pair& pair) {
      if (!is_awake(*pair.a) && !is_awake(*pair.b)) return false;
      collide_pair(pair);
      return true;
    });
  }
  std::sort(hits_.begin(), hits_.end(), [](const Hit& x, const Hit& y) {
    return std::tie(x.a->serial, x.b->serial, x.index) < std::tie(y.a->serial, y.b->serial, y.index);
  });
}

/// Contact joints for all hits.
///
/// ODE bounds friction by a box along two directions. The first is that of the slip the bodies would have after this
/// sub-step without any friction: while they slide that is the slip, and at rest the way in which gravity and forces
/// pull. A body held by friction creeps (CFM) along the force that pulls it, so pushes through other bodies show too.
///
/// Across the slip Coulomb's law is, to first order, viscous: a slip s that turns by a small s' meets mu N s' / |s|. ODE
/// would stop s' instead, and so resist the turning of whatever slides in a curve (a skid-steered robot would turn 3 %
/// too slowly). Therefore the second direction gets the compliance |s| / (mu N); N as if each contact point of the
/// lighter side carried an equal share of its weight. The force across is small, so N need not be exact. A body that
/// merely creeps gets none: there equal compliance both ways is what turns the first direction into that of the force
/// (a softer second one makes it overshoot, from side to side, sub-step by sub-step).
void RigidEngine::attach_contacts(double h) {
  contacts_.clear();
  for (Instance* instance : order_) instance->contact_points = instance->contacts_seen = 0;
  for (const Hit& hit : hits_) {
    ++hit.a->instance->contact_points;
    ++hit.b->instance->contact_points;
  }
  const double weight_of_1kg = std::max(norm(gravity_), 1.0);
  const auto load = [&](const Geom& g) {
    if (!g.body) return std::numeric_limits<double>::infinity();
    return weight_of_1kg * g.instance->mass_kg / g.instance->contact_points;
  };
  const auto free_velocity = [&](const Geom& g, Vec3 point) {
    if (!g.body) return Vec3{};
    const Body& b = *g.body;
    return velocity_at(g, point) + h * (b.gravity_mass_kg / b.mass_kg * gravity_ + b.force_N / b.mass_kg);
  };
  SurfacePair pair;
  for (const Hit& hit : hits_) {
    const Geom &a = *hit.a, &b = *hit.b;
    if (hit.index == 0) {
      const bool slippery = a.instance->drive.active || b.instance->drive.active;
      pair = combine(a.decl->surface, b.decl->surface, spec_.cfm, slippery);
    }
    dContact contact;
    contact.surface = pair.parameters;
    contact.geom = hit.point;
    const Vec3 point = vec(hit.point.pos), normal = vec(hit.point.normal);
    // Equal limits of symmetric contacts are reached at the same moment, and the direct solver, which follows them one
    // by one, then gives up ("s <= 0"). A part in 10^7 between them is enough to tell them apart.
    std::uint32_t number = 0;
    for (const Geom* g : {&a, &b})
      if (g->body) number += g->instance->contacts_seen++;
    contact.surface.mu *= 1 - 1e-7 * (1 + number % 32);
    contact.surface.mu2 *= 1 - 1.37e-7 * (1 + number % 32);
    const double mu = contact.surface.mu;
    Vec3 wanted;
    if (pair.directed) {
      const Geom& owner = pair.directed == &a.decl->surface ? a : b;
      const Quat q = owner.body ? owner.body->q * owner.X_BC.q : owner.X_BC.q;
      wanted = rotate(q, pair.directed->fdir1);
    } else if (mu > 0) {
      wanted = free_velocity(a, point) - free_velocity(b, point);
    }
    const Vec3 direction = friction_direction(normal, wanted);
    contact.fdir1[0] = direction.x, contact.fdir1[1] = direction.y, contact.fdir1[2] = direction.z;
    if (!pair.directed && mu > 0) {
      const Vec3 slip = velocity_at(a, point) - velocity_at(b, point);
      const double limit = mu * std::min(load(a), load(b)), creep = 100 * spec_.cfm * limit;
      if (const double speed = std::abs(dot(slip, direction)); speed > creep) {
        if (!(contact.surface.mode & dContactSlip2)) contact.surface.slip2 = spec_.cfm;
        contact.surface.mode |= dContactSlip2;
        contact.surface.slip2 += (speed - creep) / limit;
      }
    }
    const dJointID joint = dJointCreateContact(world_, contact_joints_, &contact);
    dJointAttach(joint, a.body ? a.body->ode : nullptr, b.body ? b.body->ode : nullptr);
    // ODE's normal points into the first shape, ours from a towards b.
    contacts_.push_back({a.link, b.link, point, -normal, hit.point.depth});
  }
  counters_.contacts = contacts_.size();
}

}  // namespace sandlot::rigid
