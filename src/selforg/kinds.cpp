#include "selforg/kinds.h"

#include "selforg/controller.h"
#include "selforg/dep/dep.h"
#include "selforg/experts/experts.h"
#include "selforg/primitives/primitives.h"
#include "selforg/semox/semox.h"
#include "selforg/simple/simple.h"
#include "selforg/sox/sox.h"

namespace sandlot::selforg {

std::span<const ControllerKind> controller_kinds() {
#define SL_ENTRY(name, type, help)                                     \
  ControllerKind{#name, help, []() -> std::unique_ptr<Controller> {    \
                   return std::make_unique<ControllerOf<type>>(#name); \
                 }},
  static const ControllerKind table[] = {SELFORG_CONTROLLERS(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

}  // namespace sandlot::selforg
