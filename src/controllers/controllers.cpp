#include "controllers/controllers.h"

#include "base/text.h"
#include "controllers/kinds.h"

namespace sandlot {
#define SL_DECLARE(name)            \
  namespace controllers::name {     \
  extern const ControllerKind kind; \
  }
SANDLOT_CONTROLLERS(SL_DECLARE)
#undef SL_DECLARE

std::span<const ControllerKind* const> controller_kinds() {
#define SL_ENTRY(name) &controllers::name::kind,
  static const ControllerKind* const table[] = {SANDLOT_CONTROLLERS(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

Result<const ControllerKind*> find_controller_kind(std::string_view name) {
  std::vector<std::string> names;
  for (const ControllerKind* kind : controller_kinds()) {
    if (name == kind->name) return kind;
    names.emplace_back(kind->name);
  }
  return Error{"no controller '" + std::string(name) + "'", suggestion(name, names)};
}

}  // namespace sandlot
