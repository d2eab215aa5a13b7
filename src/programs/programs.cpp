#include "programs/programs.h"

#include "programs/kinds.h"

namespace sandlot {
#define SL_DECLARE(name)         \
  namespace programs::name {     \
  extern const ProgramKind kind; \
  }
SANDLOT_PROGRAMS(SL_DECLARE)
#undef SL_DECLARE

std::span<const ProgramKind* const> program_kinds() {
#define SL_ENTRY(name) &programs::name::kind,
  static const std::vector<const ProgramKind*> table{SANDLOT_PROGRAMS(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

}  // namespace sandlot
