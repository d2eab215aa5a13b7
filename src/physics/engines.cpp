#include "physics/engines.h"

#include "base/text.h"
#include "physics/engine.h"

namespace sandlot {
#define SL_DECLARE(name)          \
  namespace name {                \
  extern const EngineKind engine; \
  }
SANDLOT_ENGINES(SL_DECLARE)
#undef SL_DECLARE

std::span<const EngineKind* const> engine_kinds() {
#define SL_ENTRY(name) &name::engine,
  static const EngineKind* const table[] = {SANDLOT_ENGINES(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

Result<const EngineKind*> find_engine(std::string_view name) {
  std::vector<std::string> names;
  for (const EngineKind* kind : engine_kinds()) {
    if (name == kind->name) return kind;
    names.emplace_back(kind->name);
  }
  return Error{"no physics engine '" + std::string(name) + "'", suggestion(name, names)};
}

}  // namespace sandlot
