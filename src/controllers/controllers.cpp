#include "controllers/controllers.h"

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

}  // namespace sandlot
