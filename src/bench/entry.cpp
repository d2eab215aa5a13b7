/// `sandlot-bench [SUITE] [--json]`, which `sandlot bench` runs: a program of its own, so that neither the
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
constexpr Suite suites[] = {
    {"physics", bench::physics}, {"wheels", bench::wheels},       {"pile", bench::pile},
    {"swarm", bench::swarm},     {"rays", bench::rays},           {"images", bench::images},
    {"loading", bench::loading}, {"recording", bench::recording}, {"viewer", bench::viewer},
    {"rollers", bench::rollers}, {"levels", bench::levels}};

}  // namespace

int main(int argc, char** argv) {
  std::string_view wanted;
  bool as_json = false;
  for (int i = 1; i < argc; ++i) {
    if (argv[i] == std::string_view("--json")) as_json = true;
    else wanted = argv[i];
  }
  std::vector<std::string> names;
  for (const Suite& suite : suites) names.emplace_back(suite.name);
  if (!wanted.empty() && std::find(names.begin(), names.end(), wanted) == names.end()) {
    const sandlot::Error error{"bench: there is no suite '" + std::string(wanted) + "'",
                               suggestion(wanted, names)};
    std::fprintf(stderr, "error: %s\n", error.text().c_str());
    return 2;
  }
  auto json = nlohmann::ordered_json::array();
  for (const Suite& suite : suites) {
    if (!wanted.empty() && wanted != suite.name) continue;
    for (const bench::Row& row : suite.run()) {
      json.push_back({{"name", row.name},
                      {"value", row.value},
                      {"unit", row.unit},
                      {"reference", row.reference},
                      {"ratio", row.ratio},
                      {"budget", row.budget},
                      {"ok", row.ok}});
      if (as_json) continue;
      fmt::print("{:<4} {:<44} {:>10.4g} {:<8} reference {:>10.4g}  ratio {:.3f} (budget {:.3g})\n",
                 row.ok ? "ok" : "OVER", row.name, row.value, row.unit, row.reference, row.ratio, row.budget);
      std::fflush(stdout);
    }
  }
  if (as_json) fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  // A missed budget is news, not a failure: times depend on the machine's other work.
  return 0;
}
