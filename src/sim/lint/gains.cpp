/// Gains of a joint's servo loop that no sub-step this long can follow.
///
/// A motor computes its effort once per sub-step h from the state before it; the engine then changes the speed first and
/// the position with the new speed. For a joint of inertia J, x the position, v the speed:
///   level velocity   v' = v - (h p / J) v                              unstable for h p / J > 2
///   level position   v' = v - (h / J)(p x + d v),  x' = x + h v'       unstable for 2 h d / J + h^2 p / J > 4 (Jury's
///                                                                      test of l^2 - (2 - h d/J - h^2 p/J) l + 1 - h d/J)
/// Damping c and a spring k of the joint itself are implicit in the engines: they add h c + h^2 k to J.
///
/// J is not known exactly, for what hangs on the joint may give way. It is at most that of all links beyond the joint
/// locked together, seen from a parent that stands still, since constraints only ever add to it; and a wheel that rolls
/// carries its robot along, which adds at most the whole mass times the radius squared. A loop that is unstable with that
/// much is unstable with what there is.
#include <algorithm>
#include <cmath>

#include "devices/kind.h"
#include "sim/lint/rules.h"

namespace sandlot::lint_rules {
namespace {

/// Inertia of the links beyond a joint about (turning) or along (sliding) its axis. Nothing when they hold its parent too.
std::optional<double> inertia_beyond(const model::Model& model, std::uint32_t index) {
  const model::Joint& joint = model.joints[index];
  std::vector<char> beyond(model.links.size(), 0);
  std::vector<std::uint32_t> open{joint.child};
  beyond[joint.child] = 1;
  while (!open.empty()) {
    const std::uint32_t link = open.back();
    open.pop_back();
    for (std::uint32_t j = 0; j < model.joints.size(); ++j) {
      const model::Joint& other = model.joints[j];
      if (j == index || (other.parent != link && other.child != link)) continue;
      const std::uint32_t next = other.parent == link ? other.child : other.parent;
      if (next == model::world_link || next == joint.parent) return std::nullopt;
      if (!beyond[next]) beyond[next] = 1, open.push_back(next);
    }
  }
  const Pose X_MJ = model.links[joint.child].X_ML * joint.X_CJ;
  const Vec3 axis = rotate(X_MJ.q, joint.axis_J);
  double total = 0;
  for (std::uint32_t i = 0; i < model.links.size(); ++i) {
    if (!beyond[i]) continue;
    const model::Inertial& part = model.links[i].inertial;
    if (joint.type == model::JointType::prismatic) {
      total += part.mass_kg;
      continue;
    }
    const Pose X_MCo = model.links[i].X_ML * part.X_LCo;
    const Vec3 a = rotate_inverse(X_MCo.q, axis), I = part.moments, P = part.products;
    total += a.x * a.x * I.x + a.y * a.y * I.y + a.z * a.z * I.z +
             2 * (a.x * a.y * P.x + a.x * a.z * P.y + a.y * a.z * P.z);
    const Vec3 arm = cross(axis, X_MCo.p - X_MJ.p);
    total += part.mass_kg * dot(arm, arm);
  }
  if (joint.type == model::JointType::continuous && joint.parent != model::world_link) {
    const Bounds wheel = bounds_in_link(model.links[joint.child], false);
    double mass = 0;
    for (const model::Link& link : model.links) mass += link.inertial.mass_kg;
    const Vec3 s = 0.5 * wheel.size();
    total += mass * std::max({s.x, s.y, s.z}) * std::max({s.x, s.y, s.z});
  }
  return total;
}

void check_device(const Simulation::Device& device, const model::Model& model, double h_s,
                  Findings& findings) {
  const auto kind = find_device_kind(device.decl.kind);
  const auto joints = joints_of(device.decl, model);
  if (!kind || joints.size() != 1) return;
  if (const Node* const servo = device.decl.config.find("servo"); servo && servo->text() == "exact")
    return;  // solved with the contacts, at any gain
  const model::Joint& joint = model.joints[joints[0]];
  for (std::size_t level = 0; level < (*kind)->levels.size(); ++level) {
    if (!(device.levels >> level & 1)) continue;
    const std::string name = (*kind)->levels[level].name;
    const auto p = setting(device.decl, name + "/p"), d = setting(device.decl, name + "/d");
    if (!p) continue;
    const auto beyond = inertia_beyond(model, joints[0]);
    if (!beyond) continue;
    const double J = *beyond + h_s * joint.damping + h_s * h_s * joint.spring_stiffness;
    const bool position = name == "position";
    const double load = position ? 2 * h_s * d.value_or(0) + h_s * h_s * *p : h_s * *p;
    const double most = (position ? 4 : 2) * J;
    if (!(load > most)) continue;
    const int times = static_cast<int>(std::min(1e6, std::ceil(load / most)));
    findings.add(
        "gains",
        "the servo loop of '" + device.decl.name + "' is unstable at level " + name +
            ": with p = " + short_text(*p) + (position ? ", d = " + short_text(d.value_or(0)) : "") +
            " and a physics step of " + short_text(1e3 * h_s) + " ms, joint '" + joint.name +
            "' moves too light a load (" + short_text(J) +
            (joint.type == model::JointType::prismatic ? " kg)" : " kg m^2)"),
        "divide the gains by " + std::to_string(times) + " or take that many times as many sub-steps",
        device.decl.place);
  }
}

}  // namespace

void check_gains(const Simulation& simulation, Findings& findings) {
  if (!simulation.engine().capabilities().joints) return;
  // A model file by itself does not say what step it will run at.
  const auto instances = simulation.instances();
  if (std::none_of(instances.begin(), instances.end(), [](const auto* i) { return i->model->is_static; }))
    return;
  const double h_s = simulation.setup().step.s() / simulation.setup().substeps;
  for (const auto& entity : simulation.entities())
    for (const auto& device : entity->devices) check_device(*device, *entity->instance.model, h_s, findings);
}

}  // namespace sandlot::lint_rules
