#include "markers/kinds.h"

#include "markers/marker.h"

namespace sandlot {
#define SL_DECLARE(name)        \
  namespace markers::name {     \
  extern const MarkerKind kind; \
  }
SANDLOT_MARKERS(SL_DECLARE)
#undef SL_DECLARE

std::span<const MarkerKind* const> marker_kinds() {
#define SL_ENTRY(name) &markers::name::kind,
  static const MarkerKind* const table[] = {SANDLOT_MARKERS(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

}  // namespace sandlot
