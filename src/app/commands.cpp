#include "app/commands.h"

#include <cstdio>

#include "record/playback.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::app {

Result<std::unique_ptr<Simulation>> build(const std::string& file, const FileOptions& options,
                                          Diagnostics& diagnostics) {
  SL_ASSIGN(model::Setup setup,
            record::load_with_playbacks(
                file, {options.overrides, {}, {}, options.paths, options.skip_missing}, diagnostics));
  return Simulation::create(std::move(setup), {}, diagnostics);
}

int complain(const Error& error) {
  std::fprintf(stderr, "error: %s\n", error.text().c_str());
  return exit_bad_input;
}

int finish_output(int code) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
  std::fputs("error: not all of the output could be written\n", stderr);
  return code == exit_ok ? exit_failed : code;
}

void print_warnings(const Diagnostics& diagnostics) {
  for (const Error& warning : diagnostics.warnings)
    std::fprintf(stderr, "warning: %s\n", warning.text().c_str());
}

}  // namespace sandlot::app
