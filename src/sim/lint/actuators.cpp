/// Two devices that drive one joint. The engine takes all of their efforts and, of speeds to be held, the last one; neither
/// robot nor user knows who wins. Devices with `active: false` do not count: one of several takes turns that way.
#include <algorithm>
#include <map>

#include "devices/kind.h"
#include "sim/lint/rules.h"

namespace sandlot::lint_rules {
namespace {

bool stopped(const model::DeviceDecl& device) {
  const Node* const active = device.config.find("active");
  return active && active->text() == "false";
}

}  // namespace

void check_actuators(const Simulation& simulation, Findings& findings) {
  for (const auto& entity : simulation.entities()) {
    const model::Model& model = *entity->instance.model;
    std::map<std::uint32_t, const model::DeviceDecl*> driver;  // of each joint, the first one
    for (const auto& device : entity->devices) {
      const model::DeviceDecl& decl = device->decl;
      const auto kind = find_device_kind(decl.kind);
      if (!kind || !drives(**kind) || stopped(decl)) continue;
      for (const std::uint32_t joint : driven_joints(decl, **kind, model)) {
        const model::DeviceDecl* const first = driver.try_emplace(joint, &decl).first->second;
        if (first == &decl) continue;
        findings.add("two_drivers",
                     "joint '" + model.joints[joint].name + "' is driven by '" + decl.name + "' (" +
                         decl.kind + ") and by '" + first->name + "' (" + first->kind + ")" +
                         at(first->place),
                     "remove one of them, or give it 'active: false' where it has that key", decl.place);
      }
    }
  }
}

}  // namespace sandlot::lint_rules
