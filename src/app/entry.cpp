/// The `sandlot` command itself. It is this small because everything else is in libsandlot, where plugins
/// find it too.
#include "app/commands.h"

#ifdef SANDLOT_CHECK_X86_64_V3
#include <unistd.h>

#include <cstdlib>
#include <string_view>

namespace {

/// Ends the program with a sentence instead of an illegal instruction. Runs before the initialisers of
/// libsandlot, which are compiled for x86-64-v3 already; this file alone is compiled for every x86-64
/// processor.
void check_processor() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
      __builtin_cpu_supports("bmi2"))
    return;
  constexpr std::string_view text =
      "sandlot: this processor lacks AVX2, FMA, BMI1 or BMI2, which this program is built for (x86-64-v3)\n"
      "         use a processor of 2013 (Intel Haswell) or 2015 (AMD Excavator) or later, or build from "
      "source\n"
      "         with -DSANDLOT_MARCH=x86-64\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, text.data(), text.size());
  ::_exit(EXIT_FAILURE + 1);
}

[[gnu::section(".preinit_array"), gnu::used]] void (*check_first)() = check_processor;

}  // namespace
#endif

int main(int argc, char** argv) { return sandlot::app::command(argc, argv); }
