/// Positions before the first tick: overlapping, below the ground, in the air, far away.
#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/height_grid.h"
#include "physics/engine.h"
#include "sim/lint/rules.h"

namespace sandlot::lint_rules {
namespace {

/// Contacts give way by less than this in their own compliance; what stands deeper is pushed out visibly.
constexpr double most_depth_m = 2e-3;
/// A fall of 0.5 m ends at 3 m/s, which no wheeled robot is made for.
constexpr double most_drop_m = 0.5;

/// A move that frees two things: rounded up to whole millimetres, without the crumbs of a normal that leans a little.
std::string move_text(Vec3 v) {
  const auto one = [&](double x) {
    if (std::abs(x) < 0.02 * norm(v)) return std::string("0");
    return short_text(1e-3 * std::copysign(std::ceil(1e3 * std::abs(x) - 1e-6), x));
  };
  return "[" + one(v.x) + ", " + one(v.y) + ", " + one(v.z) + "]";
}

/// A contact passes forces between bodies as a joint does (inertia.cpp), but many solvers survive a ratio of 1000 there:
/// grit under a vehicle. At 10^6 an iterative solver would need as many iterations, and the compliance that keeps a contact
/// stable is no longer small beside what the light body gives way itself.
void check_masses(std::span<const Contact> contacts, const std::vector<const model::Instance*>& owner,
                  Findings& findings) {
  constexpr double most = 1e6;
  const auto mass_kg = [](const model::Instance& instance) {
    double sum = 0;
    for (const model::Link& link : instance.model->links) sum += link.inertial.mass_kg;
    return sum;
  };
  for (const Contact& contact : contacts) {
    if (contact.a.index >= owner.size() || contact.b.index >= owner.size()) continue;
    const model::Instance *light = owner[contact.a.index], *heavy = owner[contact.b.index];
    if (!light || !heavy || light == heavy) continue;
    if (light->model->is_static || heavy->model->is_static || light->motion || heavy->motion) continue;
    if (mass_kg(*light) > mass_kg(*heavy)) std::swap(light, heavy);
    const double ratio = mass_kg(*heavy) / mass_kg(*light);
    if (ratio >= most)
      findings.add("mass_ratio",
                   "'" + light->original_name + "' of " + short_text(mass_kg(*light)) + " kg touches '" +
                       heavy->original_name + "' of " + short_text(mass_kg(*heavy)) + " kg" +
                       at(heavy->place) + ": " + short_text(ratio) + " times as much",
                   "masses are in kg: is one of them in g or t? Keep the ratio well below 10^6",
                   light->place);
  }
}

/// One step of a second engine finds the contacts of the poses it starts from.
/// @param buried  things of which more has been said already; only asked, never walked through
void check_overlaps(const Simulation& simulation, const std::set<const model::Instance*>& buried,
                    Findings& findings) {
  const model::Setup& setup = simulation.setup();
  const auto kind = find_engine(setup.engine);
  if (!kind) return;
  const auto engine = (*kind)->create(setup.physics, setup.gravity);
  if (!engine) return;
  (*engine)->set_zones(setup.zones);
  std::vector<const model::Instance*> owner;  // by body
  for (const model::Instance* instance : simulation.instances()) {
    const auto id = (*engine)->add(*instance);
    if (!id) return;
    for (const BodyId body : (*engine)->bodies(*id)) {
      if (owner.size() <= body.index) owner.resize(body.index + 1, nullptr);
      owner[body.index] = instance;
    }
  }
  (*engine)->step(setup.step.s() / setup.substeps, 0);

  check_masses((*engine)->contacts(), owner, findings);
  // Of each pair of things the deepest contact, in the order in which the engine lists the pairs.
  std::vector<Contact> deepest;
  std::map<std::pair<const void*, const void*>, std::size_t> pairs;  // found by address, walked by index
  for (const Contact& contact : (*engine)->contacts()) {
    if (contact.a.index >= owner.size() || contact.b.index >= owner.size()) continue;
    const model::Instance *const a = owner[contact.a.index], *const b = owner[contact.b.index];
    if (!a || !b || a == b || !(contact.depth_m > most_depth_m)) continue;
    const auto [entry, fresh] = pairs.try_emplace({a, b}, deepest.size());
    if (fresh) deepest.push_back(contact);
    else if (contact.depth_m > deepest[entry->second].depth_m) deepest[entry->second] = contact;
  }
  for (const Contact& contact : deepest) {
    const model::Instance *thing = owner[contact.b.index], *other = owner[contact.a.index];
    Vec3 out = contact.depth_m * contact.normal_W;
    const auto stays = [](const model::Instance* i) { return i->model->is_static || i->motion; };
    if (stays(thing) || (!thing->is_robot && other->is_robot && !stays(other)))
      std::swap(thing, other), out = -out;
    if (buried.count(thing) > 0) continue;
    findings.add("overlap",
                 "'" + thing->original_name + "' starts " + length_text(contact.depth_m) + " inside '" +
                     other->original_name + "'" + at(other->place),
                 "move it by " + move_text(out) + " or more", thing->place);
  }
}

Bounds bounds_in_world(const model::Instance& instance) {
  Bounds bounds;
  for (const model::Link& link : instance.model->links)
    for (const model::Collision& collision : link.collisions)
      bounds.include(bounds_of(collision.shape, instance.X_WM * link.X_ML * collision.X_LC));
  return bounds;
}

/// Whether a thing lies wholly below some terrain.
bool check_below_terrain(const Simulation& simulation, const model::Instance& thing, const Bounds& bounds,
                         Findings& findings) {
  for (const model::Instance* ground : simulation.instances()) {
    if (!ground->model->is_static) continue;
    for (const model::Link& link : ground->model->links)
      for (const model::Collision& collision : link.collisions) {
        const auto* field = std::get_if<Heightfield>(&collision.shape);
        if (!field) continue;
        const Pose X_GW = inverse(ground->X_WM * link.X_ML * collision.X_LC);
        const Vec3 c = bounds.centre();
        const Vec3 top = X_GW * Vec3{c.x, c.y, bounds.high.z};
        if (std::abs(top.x) > 0.5 * field->grid->size_x_m || std::abs(top.y) > 0.5 * field->grid->size_y_m)
          continue;
        const double below = height_at(*field->grid, top.x, top.y) - top.z;
        if (!(below > 0)) continue;
        findings.add("below_ground",
                     "'" + thing.original_name + "' starts below the terrain '" + ground->original_name +
                         "'" + at(ground->place) + ", its top " + length_text(below) + " under the surface",
                     "raise it by " + length_text(below + bounds.size().z) + " or more", thing.place);
        return true;
      }
  }
  return false;
}

/// Distance from the lowest point of an instance down to what carries it: the least over its collision shapes. Nothing
/// when there is nothing.
std::optional<double> drop_m(const Simulation& simulation, const Entity& entity, const Bounds& bounds) {
  const auto bodies = simulation.engine().bodies(entity.id);
  const auto own = [&](std::uint32_t body) {
    return std::any_of(bodies.begin(), bodies.end(), [&](BodyId b) { return b.index == body; });
  };
  constexpr double up_m =
      0.05;  // rays start a little inside, so that a robot that stands on the floor sees it
  std::optional<double> least;
  const model::Model& model = *entity.instance.model;
  for (const model::Link& link : model.links)
    for (const model::Collision& collision : link.collisions) {
      const Bounds b = bounds_of(collision.shape, entity.instance.X_WM * link.X_ML * collision.X_LC);
      if (b.empty()) continue;
      const Vec3 down{0, 0, -1};
      float distance = 0;
      std::uint32_t body = no_body;
      double from = 0;
      // Own links in the way are passed one surface at a time.
      for (int i = 0; i < 32; ++i) {
        const RayJob job{Pose{{b.centre().x, b.centre().y, bounds.low.z + up_m}, {}},
                         {&down, 1},
                         from,
                         1e5,
                         bodies.front().index,
                         {&distance, 1},
                         {&body, 1}};
        simulation.rays().cast({&job, 1});
        if (!std::isfinite(distance) || !own(body)) break;
        from = static_cast<double>(distance) + 1e-4;
      }
      if (!std::isfinite(distance) || own(body)) continue;
      const double drop = static_cast<double>(distance) - up_m;
      least = least ? std::min(*least, drop) : drop;
    }
  return least;
}

/// Takes commands, or has a program that gives them: a box with a camera on it may well be dropped on purpose.
bool has_drive(const Entity& entity) {
  return !entity.programs.empty() ||
         std::any_of(entity.devices.begin(), entity.devices.end(),
                     [](const auto& device) { return !device->commands.empty(); });
}

bool hangs(const model::Model& model) {
  return std::any_of(model.joints.begin(), model.joints.end(),
                     [](const model::Joint& j) { return j.parent == model::world_link; }) ||
         std::any_of(model.links.begin(), model.links.end(), [](const model::Link& l) { return !l.gravity; });
}

}  // namespace

void check_start(const Simulation& simulation, Findings& findings) {
  std::set<const model::Instance*> buried;
  for (const model::Instance* instance : simulation.instances()) {
    const Bounds bounds = bounds_in_world(*instance);
    if (instance->model->is_static || instance->motion || bounds.empty()) continue;
    if (check_below_terrain(simulation, *instance, bounds, findings)) buried.insert(instance);
  }
  check_overlaps(simulation, buried, findings);

  Bounds standing;  // what stands still and ends somewhere
  bool endless = false, anything = false;
  for (const model::Instance* instance : simulation.instances()) {
    if (!instance->model->is_static) continue;
    for (const model::Link& link : instance->model->links)
      for (const model::Collision& collision : link.collisions) {
        anything = true;
        if (std::holds_alternative<Plane>(collision.shape)) endless = true;
        standing.include(bounds_of(collision.shape, instance->X_WM * link.X_ML * collision.X_LC));
      }
  }
  if (!anything) return;  // a model by itself
  const Vec3 g = simulation.setup().gravity;
  const bool falls = g.z < -0.1 && !simulation.engine().capabilities().planar;
  for (const auto& entity : simulation.entities()) {
    const model::Instance& instance = entity->instance;
    const model::Model& model = *instance.model;
    if (model.is_static || instance.motion) continue;
    const Bounds bounds = bounds_in_world(instance);
    if (bounds.empty()) continue;
    if (!instance.is_robot) continue;

    // With an endless floor a robot may stand anywhere; ten times as far out as the world is large, it was not meant to.
    if (endless && !standing.empty()) {
      const double away = standing.distance_m(bounds.centre()), world = norm(standing.size());
      if (away > std::max(10 * world, 100.0))
        findings.add("far_away",
                     "robot '" + instance.original_name + "' starts " + length_text(away) +
                         " away from everything that stands in this world",
                     "lengths are in m: is its pose in mm?", instance.place);
    }
    if (!falls || hangs(model) || !has_drive(*entity)) continue;
    const auto drop = drop_m(simulation, *entity, bounds);
    if (!drop)
      findings.add("nothing_below",
                   "robot '" + instance.original_name + "' has nothing below it and falls for ever",
                   "place it on the ground, or give the world a <plane>", instance.place);
    else if (*drop > most_drop_m)
      findings.add(
          "drop",
          "robot '" + instance.original_name + "' starts " + length_text(*drop) + " above what it falls on",
          "lower it by " + length_text(*drop), instance.place);
  }
}

}  // namespace sandlot::lint_rules
