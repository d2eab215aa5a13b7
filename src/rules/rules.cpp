#include "rules/kinds.h"

#include "rules/rule.h"

namespace sandlot {
#define SL_DECLARE(name)      \
  namespace rules::name {     \
  extern const RuleKind kind; \
  }
SANDLOT_RULES(SL_DECLARE)
#undef SL_DECLARE

std::span<const RuleKind* const> rule_kinds() {
#define SL_ENTRY(name) &rules::name::kind,
  static const RuleKind* const table[] = {SANDLOT_RULES(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

}  // namespace sandlot
