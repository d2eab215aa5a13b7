/// Any bytes: an expression compiles and can be evaluated with any numbers, or there is one error that names the column.
#include <cmath>
#include <limits>

#include "base/check.h"
#include "sim/watch/expression.h"

namespace {

/// Names that hold every sign which could be an operator too.
struct Few final : sandlot::Names {
  std::size_t match(std::string_view text) const override {
    std::size_t best = 0;
    for (const std::string_view name : {"a.x", "b/c.r[3]", "my-bot.pose.x", "gap", "sim.time"})
      if (text.substr(0, name.size()) == name) best = std::max(best, name.size());
    return best;
  }
  std::size_t match_pattern(std::string_view text) const override {
    std::size_t best = 0;
    for (const std::string_view name : {"a*.x", "a*.y", "b*/c.r"})
      if (text.substr(0, name.size()) == name) best = std::max(best, name.size());
    return best;
  }
  sandlot::Error unknown(std::string_view word) const override {
    return {"there is no '" + std::string(word) + "'", "", {}, ""};
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  auto expression = sandlot::Expression::compile(text, Few());
  if (!expression) {
    SL_CHECK(expression.error().what.find("column ") != std::string::npos);
    return 0;
  }
  const double inf = std::numeric_limits<double>::infinity();
  for (const double x : {0.0, 1.0, -2.5, 1e300, inf, -inf, std::nan("")}) {
    const std::vector<double> inputs(expression->inputs().size(), x);
    for (const std::size_t things : {0u, 1u, 3u}) {
      std::vector<std::vector<double>> numbers;
      std::vector<sandlot::Expression::Table> tables;
      for (const sandlot::Expression::Pattern& pattern : expression->patterns()) {
        numbers.emplace_back(things * pattern.reads.size(), x);
        if (things > 1) numbers.back().front() = sandlot::Expression::no_value();
      }
      for (const auto& each : numbers) tables.push_back({things, each});
      const auto first = expression->evaluate(inputs, tables), second = expression->evaluate(inputs, tables);
      SL_CHECK(first.value == second.value || (std::isnan(first.value) && std::isnan(second.value)));
      SL_CHECK(!first.finite || first.absent || std::isfinite(first.value));
    }
  }
  return 0;
}
