/// Remarks of programs: devices that a controller can do without, although it was hardly meant to.
#include <algorithm>

#include "sim/lint/rules.h"

namespace sandlot::lint_rules {

void check_programs(const Simulation& simulation, Findings& findings) {
  const auto has_rule = [&](const std::string& kind) {
    const auto parts = simulation.elements().parts();
    return std::any_of(parts.begin(), parts.end(), [&](const auto& part) {
      return part.path.starts_with("rules/") && part.kind == kind;
    });
  };
  for (const auto& entity : simulation.entities())
    for (const auto& program : entity->programs) {
      if (!program->outputs) continue;
      for (const Outputs::Remark& remark : std::as_const(*program->outputs).remarks())
        if (remark.rule.empty() || has_rule(remark.rule))
          findings.add("devices", remark.what, remark.fix, program->decl.place);
    }
}

}  // namespace sandlot::lint_rules
