#include "media/kinds.h"

#include "media/medium.h"

namespace sandlot {
#define SL_DECLARE(name)        \
  namespace media::name {       \
  extern const MediumKind kind; \
  }
SANDLOT_MEDIA(SL_DECLARE)
#undef SL_DECLARE

std::span<const MediumKind* const> medium_kinds() {
#define SL_ENTRY(name) &media::name::kind,
  static const MediumKind* const table[] = {SANDLOT_MEDIA(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

}  // namespace sandlot
