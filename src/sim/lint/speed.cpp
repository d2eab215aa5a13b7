/// Speeds at which a sub-step carries a robot past the middle of a wall.
///
/// The engines find contacts where bodies are, not on the way. A body of extent w along its path that meets a wall of
/// thickness t has gone in by p = v h when it is first seen. It is pushed out the shorter way: back, by p, or out at the
/// far side, by t + w - p. So it goes through when p > (t + w) / 2.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "devices/kind.h"
#include "sim/lint/rules.h"

namespace sandlot::lint_rules {
namespace {

/// Nothing that is declared means this much; files write 1e9 and the like for "no limit".
constexpr double unlimited = 1e4;

struct Wall {
  const model::Instance* instance;
  const model::Collision* collision;
  double thickness_m, bottom_m, top_m;
};

std::optional<double> thickness_m(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape))
    return std::min({box->size_m.x, box->size_m.y, box->size_m.z});
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return 2 * sphere->radius_m;
  if (const auto* cylinder = std::get_if<Cylinder>(&shape))
    return std::min(2 * cylinder->radius_m, cylinder->length_m);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return 2 * capsule->radius_m;
  if (const auto* barrel = std::get_if<Barrel>(&shape))
    return std::min(2 * barrel->radius_m, barrel->length_m);
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape))
    return 2 * std::min({ellipsoid->radii_m.x, ellipsoid->radii_m.y, ellipsoid->radii_m.z});
  return std::nullopt;  // planes and terrain have no far side; of a cone or a mesh it is not known
}

std::vector<Wall> walls_near(const Simulation& simulation) {
  std::vector<Wall> walls;
  for (const model::Instance* instance : simulation.instances()) {
    if (!instance->model->is_static) continue;
    for (const model::Link& link : instance->model->links)
      for (const model::Collision& collision : link.collisions) {
        const auto thickness = thickness_m(collision.shape);
        if (!thickness) continue;
        const Bounds b = bounds_of(collision.shape, instance->X_WM * link.X_ML * collision.X_LC);
        walls.push_back({instance, &collision, *thickness, b.low.z, b.high.z});
      }
  }
  std::stable_sort(walls.begin(), walls.end(),
                   [](const Wall& a, const Wall& b) { return a.thickness_m < b.thickness_m; });
  return walls;
}

/// Of the wheel that a joint turns: the radius of the ball or cylinder on its link, 0 when it carries none.
double wheel_radius_m(const model::Link& link) {
  double radius = 0;
  for (const model::Collision& collision : link.collisions) {
    if (const auto* s = std::get_if<Sphere>(&collision.shape)) radius = std::max(radius, s->radius_m);
    if (const auto* c = std::get_if<Cylinder>(&collision.shape)) radius = std::max(radius, c->radius_m);
  }
  return radius;
}

/// The fastest that a device can drive its robot, as far as the files say.
std::optional<double> fastest_mps(const model::DeviceDecl& device, const model::Model& model) {
  std::optional<double> speed = setting(device, "max_linear_speed");
  for (const std::uint32_t index : joints_of(device, model)) {
    const model::Joint& joint = model.joints[index];
    if (joint.type != model::JointType::continuous) continue;
    const double radius = wheel_radius_m(model.links[joint.child]);
    if (!(radius > 0)) continue;
    const double turning = std::min(joint.max_velocity, setting(device, "max_velocity").value_or(unlimited));
    if (turning < unlimited) speed = std::min(speed.value_or(unlimited), turning * radius);
  }
  return speed && *speed > 0 && *speed < unlimited ? speed : std::nullopt;
}

/// Only what moves the robot counts: a kind that takes commands.
bool takes_commands(const Simulation::Device& device) { return !device.commands.empty(); }

}  // namespace

void check_speed(const Simulation& simulation, Findings& findings) {
  const std::vector<Wall> walls = walls_near(simulation);
  if (walls.empty()) return;
  const double h_s = simulation.setup().step.s() / simulation.setup().substeps;
  for (const auto& entity : simulation.entities()) {
    const model::Model& model = *entity->instance.model;
    if (model.is_static) continue;
    const Bounds in_model = bounds_in_model(model, false);
    if (in_model.empty()) continue;
    const double bottom = entity->instance.X_WM.p.z + in_model.low.z,
                 top = entity->instance.X_WM.p.z + in_model.high.z;
    const double extent = std::min(in_model.size().x, in_model.size().y);
    for (const auto& device : entity->devices) {
      if (!takes_commands(*device)) continue;
      const auto speed = fastest_mps(device->decl, model);
      if (!speed) continue;
      // What the robot stands on or passes below is not a wall to it.
      const double clearance = 0.1 * (top - bottom);
      const auto wall = std::find_if(walls.begin(), walls.end(), [&](const Wall& w) {
        return w.top_m > bottom + clearance && w.bottom_m < top - clearance;
      });
      if (wall == walls.end()) continue;
      const double most = 0.5 * (wall->thickness_m + extent);
      if (!(*speed * h_s > most)) continue;
      const int times = static_cast<int>(std::min(1e6, std::ceil(*speed * h_s / most)));
      findings.add("tunnelling",
                   "device '" + device->decl.name + "' drives at up to " + short_text(*speed) + " m/s, " +
                       length_text(*speed * h_s) + " in a physics step of " + short_text(1e3 * h_s) +
                       " ms: it can pass through '" + wall->instance->original_name + "/" +
                       wall->collision->name + "', " + length_text(wall->thickness_m) + " thick" +
                       at(wall->collision->place),
                   "take at least " + std::to_string(times * simulation.setup().substeps) +
                       " sub-steps (time.substeps), or limit the speed to " + short_text(most / h_s) + " m/s",
                   device->decl.place);
    }
  }
}

}  // namespace sandlot::lint_rules
