/// sandlot demo: a scenario that comes with Sandlot; without a name a match, at the level that this machine runs in real time.
#include <fmt/format.h>

#include "app/commands.h"
#include "app/demos.h"
#include "app/match_level.h"

namespace sandlot::app {

int demo(const DemoOptions& options) {
  if (options.name == "list") return list_demos();
  RunOptions run_options = options.run;
  const bool is_match = options.name.empty();
  auto file = demo_file(is_match ? "match" : options.name);
  if (!file) return complain(file.error());
  run_options.spec.file = *file;
  if (!is_match) return run(run_options);

  // The page and whoever looks at it take their share of the machine.
  constexpr double margin = 1.5;
  std::vector<formats::Override>& overrides = run_options.spec.overrides;
  overrides.insert(overrides.begin(), {"half", "900"});  // of a real game
  const auto chosen = choose_level(run_options.spec, margin);
  if (!chosen) return complain(chosen.error());
  const std::vector<formats::Override> level = chosen->level.overrides();
  overrides.insert(overrides.begin() + 1, level.begin(), level.end());
  fmt::print(stderr, "match: senses {}, drives {}, engine {}; measured {:.1f} x real time\n",
             chosen->level.sense, chosen->level.drive, chosen->level.engine, chosen->real_time_factor);
  std::string flags;
  for (const formats::Override& each : overrides) {
    const bool plain = each.value.find_first_of(" '\"$[{") == std::string::npos;
    flags += fmt::format(" --set {0}{1}={2}{0}", plain ? "" : "'", each.path, each.value);
  }
  fmt::print(stderr, "the same again: sandlot demo match{}\n", flags);
  return run(run_options);
}

}  // namespace sandlot::app
