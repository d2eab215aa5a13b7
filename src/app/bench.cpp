#include "bench/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/json_text.h"
#include "base/text.h"

namespace sandlot::app {

int bench(const BenchOptions& options) {
  struct Suite {
    const char* name;
    std::vector<sandlot::bench::Row> (*run)();
  };
  static constexpr Suite suites[] = {
      {"physics", sandlot::bench::physics}, {"wheels", sandlot::bench::wheels},
      {"pile", sandlot::bench::pile},       {"swarm", sandlot::bench::swarm},
      {"rays", sandlot::bench::rays},       {"images", sandlot::bench::images},
      {"loading", sandlot::bench::loading}, {"recording", sandlot::bench::recording},
      {"viewer", sandlot::bench::viewer},   {"rollers", sandlot::bench::rollers},
      {"levels", sandlot::bench::levels}};
  std::vector<std::string> names;
  for (const Suite& suite : suites) names.emplace_back(suite.name);
  if (!options.name.empty() && std::find(names.begin(), names.end(), options.name) == names.end())
    return complain({"bench: there is no suite '" + options.name + "'", suggestion(options.name, names)});
  auto json = nlohmann::ordered_json::array();
  bool all_ok = true;
  for (const Suite& suite : suites) {
    if (!options.name.empty() && options.name != suite.name) continue;
    for (const sandlot::bench::Row& row : suite.run()) {
      all_ok = all_ok && row.ok;
      json.push_back({{"name", row.name},
                      {"value", row.value},
                      {"unit", row.unit},
                      {"reference", row.reference},
                      {"ratio", row.ratio},
                      {"budget", row.budget},
                      {"ok", row.ok}});
      if (!options.json)
        fmt::print("{:<4} {:<44} {:>10.4g} {:<8} reference {:>10.4g}  ratio {:.3f} (budget {:.3g})\n",
                   row.ok ? "ok" : "OVER", row.name, row.value, row.unit, row.reference, row.ratio,
                   row.budget);
    }
  }
  if (options.json) fmt::print("{}\n", json_text(json));
  // A missed budget is news, not a failure: times depend on the machine's other work.
  return exit_ok;
}

}  // namespace sandlot::app
