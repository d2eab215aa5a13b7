#include "base/check.h"

#include <cstdio>
#include <cstdlib>

namespace sandlot {

void check_failed(const char* expression, const char* message, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: internal error (a bug in Sandlot, please report it): %s is false%s%s\n", file,
               line, expression, *message ? ": " : "", message);
  std::fflush(stderr);
  std::abort();
}

}  // namespace sandlot
