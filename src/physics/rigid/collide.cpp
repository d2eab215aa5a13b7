#include <algorithm>
#include <limits>
#include <tuple>

#include "physics/rigid/barrel_contacts.h"
#include "physics/rigid/cylinder_contacts.h"
#include "physics/rigid/ode_vector.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/rigid/surface.h"
#include "physics/rigid/wheels.h"

namespace sandlot::rigid {
namespace {

/// Share of its weight that one contact point carries.
double load_on(const Geom& g) {
  return g.body ? g.instance->load_N : std::numeric_limits<double>::infinity();
}
/// Bodies on a path wake the ones they meet.
bool is_awake(const Geom& g) { return g.body ? g.body->awake : g.instance->is_moving(); }

constexpr std::size_t most_points = 512;  ///< of one pair, before they are thinned out

/// Across the axis of a roller that is not a body of its own, friction is that of its bearing, a force [N].
void give_way(dSurfaceParameters& surface, const model::RollerWheel& wheel) {
  surface.mode = (surface.mode & ~(dContactApprox1_2 | dContactSlip2)) | dContactMu2;
  surface.mu2 = surface.mu > 0 ? wheel.bearing_friction_Nm / wheel.roller_radius_m : 0;
}

Vec3 spin(const Geom& g) { return g.body ? g.body->w : g.instance->V_WM.angular; }

Vec3 velocity_at(const Geom& g, Vec3 point) {
  return g.body ? g.body->v + cross(g.body->w, point - g.body->p) : g.instance->velocity_at(point);
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
    for (const auto& [first, second] : a->instance->joined)
      if ((first == a->body && second == b->body) || (first == b->body && second == a->body)) return;
  }
  if (!grips_.empty() && hold_each_other(*a, *b)) return;
  if (b->serial < a->serial) std::swap(a, b);
  (is_awake(*a) || is_awake(*b) ? pairs_ : dormant_).push_back({a->serial, b->serial, a, b});
}

/// Points of each in the other; ODE's normals point into the first.
int RigidEngine::collide_meshes(const Pair& pair) {
  constexpr std::size_t most_of_static = 4000;
  std::size_t count = 0;
  const auto ask = [&](const Geom& whose, const Geom& other) {
    const std::span<const Sample> samples = whose.triangles->samples();
    if (!whose.body && samples.size() > most_of_static) return count;
    const std::span<dContactGeom> rest = std::span(points_).subspan(count);
    const auto* field = std::get_if<Heightfield>(&other.decl->shape);
    const int found = field ? collide_samples(samples, whose.pose(), *field->grid, other.pose(), rest)
                            : collide_samples(samples, whose.pose(), ray_, other.ode, rest);
    count += static_cast<std::size_t>(found);
    return count;
  };
  const std::size_t of_a = ask(*pair.a, *pair.b), all = ask(*pair.b, *pair.a);
  for (std::size_t i = of_a; i < all; ++i)
    for (dReal& x : points_[i].normal) x = -x;
  return static_cast<int>(all);
}

/// Contacts of shapes that are triangles to ODE.
int RigidEngine::collide_triangles(const Pair& pair, Hit* found) {
  constexpr std::size_t most = most_points;
  points_.resize(most);
  const Shape &a = pair.a->decl->shape, &b = pair.b->decl->shape;
  const bool plane_a = std::holds_alternative<Plane>(a), plane_b = std::holds_alternative<Plane>(b);
  int n = 0;
  if ((plane_a && meets_planes_exactly(b)) || (plane_b && meets_planes_exactly(a))) {
    dVector4 plane;
    dGeomPlaneGetParams(plane_a ? pair.a->ode : pair.b->ode, plane);
    const Geom& round = plane_a ? *pair.b : *pair.a;
    n = collide_with_plane(round.decl->shape, round.pose(), vec(plane), plane[3], points_);
    if (plane_a)
      for (int i = 0; i < n; ++i)
        for (dReal& x : points_[static_cast<std::size_t>(i)].normal) x = -x;
  } else if (pair.a->triangles && pair.b->triangles) {
    n = collide_meshes(pair);
  } else {
    n = dCollide(pair.a->ode, pair.b->ode, static_cast<int>(most), points_.data(), sizeof(dContactGeom));
  }
  n = reduce_contacts(std::span(points_).first(static_cast<std::size_t>(n)), spec_.max_contacts,
                      std::min(pair.a->size_m, pair.b->size_m));
  for (int i = 0; i < n; ++i) found[i].contact.geom = points_[static_cast<std::size_t>(i)];
  return n;
}

/// Contacts of a barrel with anything but cylinders and barrels.
int RigidEngine::collide_barrels(const Pair& pair, Hit* found) {
  points_.resize(most_points);
  const bool first = std::holds_alternative<Barrel>(pair.a->decl->shape);
  const Geom &barrel = first ? *pair.a : *pair.b, &other = first ? *pair.b : *pair.a;
  int n = collide_barrel(std::get<Barrel>(barrel.decl->shape), barrel.pose(), other.decl->shape, other.pose(),
                         other.triangles.get(), points_);
  n = reduce_contacts(std::span(points_).first(static_cast<std::size_t>(n)), spec_.max_contacts,
                      std::min(pair.a->size_m, pair.b->size_m));
  for (int i = 0; i < n; ++i) {
    dContactGeom& point = points_[static_cast<std::size_t>(i)];
    if (!first)
      for (dReal& x : point.normal) x = -x;
    found[i].contact.geom = point;
  }
  return n;
}

/// Finds where the wheels of a pair, a little thickened, touch: rollers there must be awake.
void RigidEngine::sense_wheels(const Pair& pair) {
  points_.resize(most_points);
  for (const auto& [own, other] : {std::pair{pair.a, pair.b}, std::pair{pair.b, pair.a}}) {
    if (!own->wheel || !own->wheel->on_rollers) continue;
    const Barrel& probe = own->wheel->probe;
    const int n = is_round_pair(probe, other->decl->shape)
                      ? collide_round(probe, own->pose(), other->decl->shape, other->pose(), 4,
                                      points_.data(), static_cast<int>(sizeof(dContactGeom)))
                      : collide_barrel(probe, own->pose(), other->decl->shape, other->pose(),
                                       other->triangles.get(), points_);
    for (int i = 0; i < n; ++i) touch(*own->wheel, vec(points_[static_cast<std::size_t>(i)].pos));
  }
}

/// A wheel on its rollers touches with those that are awake.
void RigidEngine::collide_rollers(const Pair& pair) {
  unordered_ = true;
  const auto each = [](Geom* g, auto&& visit) {
    if (!g->wheel || !g->wheel->on_rollers) return visit(g);
    for (const Roller& roller : g->wheel->rollers)
      if (!roller.body->frozen && roller.geom) visit(roller.geom);
  };
  each(pair.a, [&](Geom* a) {
    each(pair.b, [&](Geom* b) {
      const double reach = a->size_m + b->size_m;
      const Vec3 apart = a->pose().p - b->pose().p;
      if (std::isfinite(reach) && dot(apart, apart) > reach * reach) return;
      if (a->serial < b->serial) collide_pair({a->serial, b->serial, a, b});
      else collide_pair({b->serial, a->serial, b, a});
    });
  });
}

/// Finds contact points and wakes whom an awake body touches.
void RigidEngine::collide_pair(const Pair& pair) {
  for (const Geom* g : {pair.a, pair.b})
    if (g->wheel && g->wheel->on_rollers) return collide_rollers(pair);
  const std::size_t most = hit_count_ + static_cast<std::size_t>(spec_.max_contacts);
  if (hit_buffer_.size() < most) hit_buffer_.resize(2 * most);
  Hit* const found = &hit_buffer_[hit_count_];
  const Shape &a = pair.a->decl->shape, &b = pair.b->decl->shape;
  const bool barrel = std::holds_alternative<Barrel>(a) || std::holds_alternative<Barrel>(b);
  const int n = is_round_pair(a, b) ? collide_round(a, pair.a->pose(), b, pair.b->pose(), spec_.max_contacts,
                                                    &found->contact.geom, static_cast<int>(sizeof(Hit)))
                : barrel            ? collide_barrels(pair, found)
                : pair.a->triangles || pair.b->triangles
                    ? collide_triangles(pair, found)
                    : dCollide(pair.a->ode, pair.b->ode, spec_.max_contacts, &found->contact.geom,
                               sizeof(Hit));
  for (int i = 0; i < n; ++i) {
    found[i].a = pair.a;
    found[i].b = pair.b;
    found[i].index = static_cast<std::uint32_t>(i);
  }
  hit_count_ += static_cast<std::size_t>(n);
  if (n == 0) return;
  if (pair.a->body && !pair.a->body->awake) wake(*pair.a->body);
  if (pair.b->body && !pair.b->body->awake) wake(*pair.b->body);
  // On what moves, however slowly, nobody falls asleep.
  if (!pair.a->body && is_awake(*pair.a)) pair.b->body->quiet_s = 0;
  if (!pair.b->body && is_awake(*pair.b)) pair.a->body->quiet_s = 0;
}

/// All contact points of awake bodies, in the order in which their shapes were made.
void RigidEngine::collide() {
  pairs_.clear();
  dormant_.clear();
  hit_count_ = 0;
  dSpaceCollide(space_, this, &near);
  for (Instance* instance : order_)
    if (instance->space && instance->model->self_collide) dSpaceCollide(instance->space, this, &near);

  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& x, const Pair& y) {
    return x.first != y.first ? x.first < y.first : x.second < y.second;
  });
  bool rolling = false;
  for (Instance* instance : order_)
    for (Wheel& wheel : instance->wheels)
      if (wheel.on_rollers && wheel.body->awake) wheel.touched_B.clear(), rolling = true;
  if (rolling) {
    for (const Pair& pair : pairs_) sense_wheels(pair);
    for (Instance* instance : order_)
      for (Wheel& wheel : instance->wheels)
        if (wheel.on_rollers && wheel.body->awake) choose_awake(wheel);
  }
  woke_ = unordered_ = false;
  for (const Pair& pair : pairs_) collide_pair(pair);
  if (!woke_ && !unordered_) return;
  // A woken body meets its neighbours in this very sub-step, else it would fall through what it lies on;
  // they may wake in turn. The set that is awake in the end does not depend on the order of the search.
  while (woke_) {
    woke_ = false;
    std::erase_if(dormant_, [&](const Pair& pair) {
      if (!is_awake(*pair.a) && !is_awake(*pair.b)) return false;
      collide_pair(pair);
      return true;
    });
  }
  std::sort(hits().begin(), hits().end(), [](const Hit& x, const Hit& y) {
    return std::tie(x.a->serial, x.b->serial, x.index) < std::tie(y.a->serial, y.b->serial, y.index);
  });
}

/// Contact parameters of the surfaces at a contact point: those of the shapes, a zone in place of what stands
/// still, and at last the result of the user's rule.
PairSurface RigidEngine::surfaces_at(const Hit& hit) const {
  const Vec3 point = vec(hit.contact.geom.pos), normal = -vec(hit.contact.geom.normal);
  const auto side = [&](const Geom& g) -> SurfaceSide {
    if (!g.body && !g.instance->guided)
      if (const model::SurfaceZone* const zone = zones_.find(point)) return {zone->surface, {}};
    return {g.decl->surface, g.pose().q};
  };
  PairSurface pair = combine(side(*hit.a), side(*hit.b), normal);
  if (!rule_) return pair;
  const auto side_of = [&](const Geom& g) -> ContactSide {
    const model::Link& link = g.instance->model->links[link_slots_[g.link.index].link];
    return {g.instance->name, link, *g.decl, g.pose()};
  };
  rule_(side_of(*hit.a), side_of(*hit.b), point, normal, pair);
  return pair;
}

/// Surfaces of all points where zones or a rule may give each point another one: finds them all, and drops
/// the points that do not touch.
void RigidEngine::find_surfaces() {
  surfaces_.clear();
  std::size_t kept = 0;
  for (Hit& hit : hits()) {
    const PairSurface pair = surfaces_at(hit);
    if (!pair.touches) continue;
    surfaces_.push_back(pair);
    if (&hit != &hit_buffer_[kept]) hit_buffer_[kept] = hit;
    ++kept;
  }
  hit_count_ = kept;
}

namespace {

/// The roller of a wheel that touches with its own body, if one does.
const Body* roller_of(const Geom& a, const Geom& b) {
  for (const Geom* g : {&a, &b})
    if (g->body && g->body->carrier) return g->body;
  return nullptr;
}

}  // namespace

/// ODE's inputs in addition to the parameters of the surfaces: the direction of friction, and that a surface
/// moves.
///
/// A roller on its hinge is held along its axis alone: whatever slips across, it soon turns along with. Its
/// axis is thus the direction of the force, sliding or not; that of its slip is not, since the point of
/// contact wanders on the barrel to where that is thinner, and that little slip across would pass for the
/// whole of it (the box of friction then lies askew, and a spinning Mecanum robot goes by whichever wheels it
/// went by before).
void RigidEngine::direct_contact(Hit& hit, const PairSurface& pair) {
  const Geom &a = *hit.a, &b = *hit.b;
  dContact& contact = hit.contact;
  const Vec3 point = vec(contact.geom.pos), normal = vec(contact.geom.normal);
  const double mu = contact.surface.mu;
  const Vec3 belt = pair.belt_velocity_W_mps;
  const Wheel* const wheel = a.wheel ? a.wheel : b.wheel;
  const Body* const roller = roller_of(a, b);
  const bool directed = wheel || roller || pair.fdir1_W != Vec3{};
  Vec3 slip, wanted;
  if (wheel) {
    wanted = roller_axis_W(*wheel, point);
    give_way(contact.surface, *wheel->decl);
  } else if (pair.fdir1_W != Vec3{}) {
    wanted = pair.fdir1_W;
  } else if (roller) {
    wanted = rotate(roller->q, roller->spin_axis_B);
  } else if (mu > 0) {
    slip = velocity_at(a, point) - velocity_at(b, point) - belt;
    wanted = slip;
    if (a.body) wanted += a.body->pull_mps;
    if (b.body) wanted -= b.body->pull_mps;
  }
  if (!directed && pair.rolling_resistance_m > 0) {
    // The box around the torque against rolling is right along its two directions too: what rolls more than
    // it slips has the first one along its way.
    const Vec3 turning = cross(spin(a) - spin(b), normal);
    const double rolling_mps = 0.1 * norm(turning) * std::min(a.size_m, b.size_m);
    if (rolling_mps > 0 && norm(slip - dot(slip, normal) * normal) < rolling_mps) wanted = turning, slip = {};
  }
  const Vec3 direction = friction_direction(normal, wanted);
  contact.fdir1[0] = direction.x, contact.fdir1[1] = direction.y, contact.fdir1[2] = direction.z;
  if (!directed && mu > 0) {
    const double limit = mu * std::min(load_on(a), load_on(b));
    const double creep = (100 * spec_.cfm + pair.slip1) * limit;
    if (const double speed = std::abs(dot(slip, direction)); speed > creep) {
      if (!(contact.surface.mode & dContactSlip2)) contact.surface.slip2 = spec_.cfm;
      contact.surface.mode |= dContactSlip2;
      contact.surface.slip2 += (speed - creep) / limit;
    }
  }
  const Geom& mover = a.body ? b : a;
  const bool moves = !mover.body && mover.instance->is_moving(), runs = belt != Vec3{};
  if (!moves && !runs) return;
  // To ODE surfaces stand still; that one moves, it takes as velocities at which the contact comes to rest.
  // They are those of the first body, or the only one, along ODE's three directions with its normal into that
  // body.
  const Vec3 into = a.body ? normal : -normal;
  Vec3 v = a.body ? belt : -belt;
  if (moves) {
    const Vec3 of_mover = velocity_at(mover, point);
    v += of_mover;
    contact.surface.mode |= dContactMotionN;
    contact.surface.motionN = dot(into, of_mover);
  }
  contact.surface.mode |= dContactMotion1 | dContactMotion2;
  contact.surface.motion1 = dot(direction, v);
  contact.surface.motion2 = dot(cross(into, direction), v);
  if (!runs) return;
  // A body held back on a belt does not fall asleep: it has to notice when it is let go.
  for (const Geom* g : {&a, &b})
    if (g->body) g->body->quiet_s = 0;
}

/// Contact joints for all hits.
///
/// ODE bounds friction by a box along two directions. The first is that of the slip the bodies would have
/// after this sub-step without any friction: while they slide that is the slip, and at rest the way in which
/// gravity and forces pull. A body held by friction creeps (CFM) along the force that pulls it, so pushes
/// through other bodies show too.
///
/// Across the slip Coulomb's law is, to first order, viscous: a slip s that turns by a small s' meets mu N s'
/// / |s|. ODE would stop s' instead, and so resist the turning of whatever slides in a curve (a skid-steered
/// robot would turn 3 % too slowly). Therefore the second direction gets the compliance |s| / (mu N); N as if
/// each contact point of the lighter side carried an equal share of its weight. The force across is small, so
/// N need not be exact. A body that merely creeps, by CFM or by the slip of its surface, gets none: there
/// equal compliance both ways is what turns the first direction into that of the force (a softer second one
/// makes it overshoot, from side to side, sub-step by sub-step).
void RigidEngine::attach_contacts(double h) {
  contacts_.clear();
  const bool per_point = rule_ || !zones_.empty();
  if (per_point) find_surfaces();
  for (const Hit& hit : hits()) {
    ++hit.a->instance->contact_points;
    ++hit.b->instance->contact_points;
  }
  const double weight_of_1kg = std::max(norm(gravity_), 1.0);
  for (Instance* instance : order_) {
    if (instance->contact_points == 0) continue;
    instance->load_N = weight_of_1kg * instance->mass_kg / instance->contact_points;
    instance->contact_points = instance->contacts_seen = 0;
    for (Body& b : instance->bodies)
      b.pull_mps = h * (b.gravity_mass_kg / b.mass_kg * gravity_ + b.force_N / b.mass_kg);
  }
  PairSurface pair;
  dSurfaceParameters parameters{};
  std::size_t number_of_hit = 0;
  for (Hit& hit : hits()) {
    const Geom &a = *hit.a, &b = *hit.b;
    dContact& contact = hit.contact;
    if (per_point || hit.index == 0 || a.decl->surface.skin || b.decl->surface.skin) {
      pair = per_point ? surfaces_[number_of_hit++]
                       : combine({a.decl->surface, a.pose().q}, {b.decl->surface, b.pose().q},
                                 -vec(contact.geom.normal));
      const bool slippery = a.instance->drive.active || b.instance->drive.active;
      parameters = parameters_of(pair, h, spec_.cfm, slippery);
    }
    contact.surface = parameters;
    // Equal limits of symmetric contacts are reached at the same moment, and the direct solver, which follows
    // them one by one, then gives up ("s <= 0"). A part in 10^7 between them is enough to distinguish them.
    std::uint32_t number = 0;
    for (const Geom* g : {&a, &b})
      if (g->body) number += g->instance->contacts_seen++;
    contact.surface.mu *= 1 - 1e-7 * (1 + number % 32);
    contact.surface.mu2 *= 1 - 1.37e-7 * (1 + number % 32);
    contact.surface.rho *= 1 - 1.73e-7 * (1 + number % 32);
    contact.surface.rho2 *= 1 - 2.11e-7 * (1 + number % 32);
    direct_contact(hit, pair);
    // ODE's normal points into the first shape, ours from a towards b.
    contacts_.push_back({a.link,
                         b.link,
                         vec(contact.geom.pos),
                         -vec(contact.geom.normal),
                         contact.geom.depth,
                         {},
                         a.number_in_link,
                         b.number_in_link});
    // ODE has one fastest correction for all contacts of a world; ours come into the depth that it gets.
    const double erp = contact.surface.mode & dContactSoftERP ? contact.surface.soft_erp : spec_.erp;
    const double fastest = pair.max_correction_mps.value_or(spec_.contact_correction_mps);
    if (const double share = 1 / h * erp; share * contact.geom.depth > fastest)
      contact.geom.depth = fastest / share;
  }
  const bool watching = begin_contacts(hit_count_);
  // In a loop of its own: ODE copies the contact, and would wait for what was only just written there.
  for (const Hit& hit : hits()) {
    const dJointID joint = dJointCreateContact(world_, contact_joints_, &hit.contact);
    dJointAttach(joint, hit.a->body ? hit.a->body->ode : nullptr, hit.b->body ? hit.b->body->ode : nullptr);
    if (watching) watch_contact(*hit.a, *hit.b, joint);
  }
  counters_.contacts = contacts_.size();
}

}  // namespace sandlot::rigid
