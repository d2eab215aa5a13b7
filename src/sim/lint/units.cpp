/// Numbers that look as if they were written in another unit.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "sim/lint/rules.h"

namespace sandlot::lint_rules {
namespace {

bool has_mesh(const model::Model& model) {
  for (const model::Link& link : model.links) {
    for (const model::Collision& c : link.collisions)
      if (std::holds_alternative<Mesh>(c.shape)) return true;
    for (const model::Visual& v : link.visuals)
      if (std::holds_alternative<Mesh>(v.shape)) return true;
  }
  return false;
}

void check_size(const model::Instance& instance, Findings& findings) {
  const model::Model& model = *instance.model;
  const Vec3 size = bounds_in_model(model, true).size();
  const double across = std::max({size.x, size.y, size.z});
  const char* const millimetres = has_mesh(model)
                                      ? "is its mesh in millimetres? Then <scale>0.001 0.001 0.001</scale>"
                                      : "lengths are in m: are these in mm?";
  // A robot of 50 m fits no machine hall; of what else moves little is longer than a ship; a scanned city is still
  // smaller than 10 km.
  const double most = model.is_static ? 1e4 : instance.is_robot ? 50 : 500;
  if (across > most)
    findings.add("size", "'" + model.name + "' is " + length_text(across) + " across", millimetres,
                 model.place);
  else if (instance.is_robot && across > 0 && across < 0.005)
    findings.add("size", "'" + model.name + "' is " + length_text(across) + " across",
                 "lengths are in m: was its <scale> applied twice?", model.place);
}

/// Nobody limits a joint at 90 rad, and 90 is what one writes for a right angle.
void check_limits(const model::Model& model, Findings& findings) {
  for (const model::Joint& joint : model.joints) {
    if (joint.type != model::JointType::revolute && joint.type != model::JointType::universal) continue;
    for (const double limit : {joint.lower, joint.upper}) {
      const double degrees = std::abs(limit);
      if (degrees < 10 || degrees > 720 || std::abs(degrees - 5 * std::round(degrees / 5)) > 1e-9) continue;
      findings.add(
          "angle",
          "joint '" + joint.name + "' has a limit of " + short_text(limit) + " rad, which looks like degrees",
          "write " + short_text(limit * math::pi / 180) + " for " + short_text(limit) + " degrees",
          joint.place);
      break;
    }
  }
}

void check_gravity(const model::Setup& setup, Findings& findings) {
  const Vec3 g = setup.gravity;
  const double magnitude = norm(g);
  // Earth, and where robots have been or are planned for: Mercury and Mars, Venus, Moon, Titan; and free fall.
  constexpr double known[] = {9.81, 3.71, 8.87, 1.62, 1.35};
  if (g.z > 0.1)
    findings.add("gravity", "gravity points up: " + short_text(g.z) + " m/s^2 along z",
                 "write 0 0 -9.81: z points up", setup.gravity_place);
  else if (magnitude > 1e-3 && std::none_of(std::begin(known), std::end(known),
                                            [&](double k) { return std::abs(magnitude - k) <= 0.2; }))
    findings.add(
        "gravity",
        "gravity is " + short_text(magnitude) + " m/s^2, which is neither Earth's nor that of a planet",
        "write 0 0 -9.81 if this is not meant", setup.gravity_place);
}

}  // namespace

void check_units(const Simulation& simulation, Findings& findings) {
  check_gravity(simulation.setup(), findings);
  std::set<const model::Model*> known;  // only asked, never walked through
  for (const auto& entity : simulation.entities()) {
    const model::Instance& instance = entity->instance;
    for (const auto& device : entity->devices) {
      const auto radius = setting(device->decl, "wheel_radius");
      if (radius && *radius > 5)
        findings.add("size",
                     "device '" + device->decl.name + "' has wheels with a radius of " + length_text(*radius),
                     "lengths are in m: is this in mm?", device->decl.place);
    }
    if (!known.insert(instance.model.get()).second) continue;
    check_size(instance, findings);
    check_limits(*instance.model, findings);
  }
}

}  // namespace sandlot::lint_rules
