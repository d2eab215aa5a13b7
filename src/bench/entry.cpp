/// `sandlot-bench [SUITE] [--json] [--guard]`, which `sandlot bench` runs: a program of its own, so that neither the
/// library nor those who only build the simulator carry what is measured against.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/result.h"
#include "base/text.h"
#include "bench/bench.h"

namespace {

using namespace sandlot;

struct Suite {
  const char* name;
  std::vector<bench::Row> (*run)();
};
constexpr Suite suites[] = {{"physics", bench::physics},
                            {"wheels", bench::wheels},
                            {"pile", bench::pile},
                            {"swarm", bench::swarm},
                            {"rays", bench::rays},
                            {"images", bench::images},
                            {"loading", bench::loading},
                            {"recording", bench::recording},
                            {"viewer", bench::viewer},
                            {"rollers", bench::rollers},
                            {"levels", bench::levels},
                            {"radio", bench::radio},
                            {"lockstep", bench::lockstep},
                            {"robios", bench::robios},
                            {"match", bench::match},
                            {"sox", bench::sox},
                            {"navigation", bench::navigation}};

/// A ratio this much over its budget is a mistake in the code; less may be the machine's other work.
constexpr double guard_factor = 2;

bool exceeds_guard(const bench::Row& row) {
  return row.ratio > (row.guard > 0 ? row.guard : guard_factor * row.budget);
}

nlohmann::ordered_json as_json(const bench::Row& row) {
  return {{"name", row.name},   {"value", row.value},   {"unit", row.unit}, {"reference", row.reference},
          {"ratio", row.ratio}, {"budget", row.budget}, {"ok", row.ok}};
}

void print(const bench::Row& row) {
  fmt::print("{:<4} {:<44} {:>10.4g} {:<8} reference {:>10.4g}  ratio {:.3f} (budget {:.3g})\n",
             row.ok ? "ok" : "OVER", row.name, row.value, row.unit, row.reference, row.ratio, row.budget);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::string_view wanted;
  bool json = false, guard = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--json") json = true;
    else if (argument == "--guard") guard = true;
    else wanted = argument;
  }
  std::vector<std::string> names;
  for (const Suite& suite : suites) names.emplace_back(suite.name);
  if (!wanted.empty() && std::find(names.begin(), names.end(), wanted) == names.end()) {
    const Error error{"bench: there is no suite '" + std::string(wanted) + "'", suggestion(wanted, names)};
    std::fprintf(stderr, "error: %s\n", error.text().c_str());
    return 2;
  }
  auto rows_json = nlohmann::ordered_json::array();
  bool slow = false;
  for (const Suite& suite : suites) {
    if (!wanted.empty() && wanted != suite.name) continue;
    std::vector<bench::Row> rows = suite.run();
    // Measured once more before it counts as slow: a machine may have had something else to do.
    if (guard && std::any_of(rows.begin(), rows.end(), exceeds_guard)) {
      rows = suite.run();
      slow = slow || std::any_of(rows.begin(), rows.end(), exceeds_guard);
    }
    for (const bench::Row& row : rows) {
      rows_json.push_back(as_json(row));
      if (!json) print(row);
    }
  }
  if (json)
    fmt::print("{}\n", rows_json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  if (slow)
    std::fprintf(stderr, "error: a ratio is over %g times its budget, twice in a row\n", guard_factor);
  // Without --guard a missed budget is news, not a failure: times depend on the machine's other work.
  return slow ? 1 : 0;
}
