/// Surfaces that cannot do what they were declared for.
#include "sim/lint/rules.h"

namespace sandlot::lint_rules {
namespace {

const model::Collision* with_substance(const model::Instance& instance) {
  for (const model::Link& link : instance.model->links)
    for (const model::Collision& collision : link.collisions)
      if (collision.surface.substance) return &collision;
  return nullptr;
}

}  // namespace

/// A substance counts between two things that have one. Where a single thing has, it never does.
void check_surfaces(const Simulation& simulation, Findings& findings) {
  const model::Instance* only = nullptr;
  const model::Collision* where = nullptr;
  for (const model::SurfaceZone& zone : simulation.setup().zones)
    if (zone.surface.substance) return;
  for (const model::Instance* instance : simulation.instances()) {
    const model::Collision* const collision = with_substance(*instance);
    if (!collision) continue;
    if (only) return;
    only = instance;
    where = collision;
  }
  // A model file by itself stands on a ground that nobody has declared.
  if (!only || simulation.instances().size() < 2) return;
  findings.add("substance",
               "'" + only->original_name + "' has a substance, and nothing else in this world has one",
               "give what it touches a <sandlot:substance> too, such as plastic; until then friction is <mu>",
               where->place);
}

}  // namespace sandlot::lint_rules
