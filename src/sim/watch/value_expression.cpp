/// Expressions over a simulation's values: what their words name, and the things of their aggregates.
#include <algorithm>
#include <cctype>

#include "base/text.h"
#include "sim/watch/values.h"

namespace sandlot {
namespace {

/// What an unknown address of several things was meant to be.
Error no_such_things(const Simulation& simulation, std::string_view address) {
  const std::size_t cut = std::min(address.find_first_of("./"), address.size());
  const std::string pattern(address.substr(0, std::min<std::size_t>(cut, 100)));
  std::vector<std::string> names;
  for (const auto& entity : simulation.entities()) {
    names.push_back(entity->instance.name);
    if (!fits_pattern(names.back(), pattern)) continue;
    if (address.substr(cut, 1) == ".")
      if (auto error = no_such_marker(simulation, address.substr(cut + 1))) return std::move(*error);
    return {"nothing called '" + pattern + "' has a value '" + std::string(address.substr(cut, 100)) + "'",
            "`sandlot info FILE --values` lists those there are"};
  }
  return {"nothing is called '" + pattern + "'", suggestion(pattern, names)};
}

}  // namespace

/// The words of expressions: addresses, as far as they reach.
class SimulationNames final : public Names {
 public:
  SimulationNames(const Simulation& simulation, std::span<const std::string> known)
      : simulation_(simulation), known_(known) {}

  std::size_t match(std::string_view text) const override {
    return longest(text, [&](std::string_view candidate) {
      return NamedValue(simulation_, std::string(candidate)).resolve();
    });
  }
  std::size_t match_pattern(std::string_view text) const override {
    // Nonsense about a large world must not keep it waiting.
    int tries = 50'000;
    return longest(text, [&](std::string_view candidate) {
      const std::size_t cut = candidate.find_first_of("./");
      if (cut == std::string_view::npos || candidate.find('*', cut) != std::string_view::npos) return false;
      for (const auto& entity : simulation_.entities()) {
        const bool can_have_it = candidate[cut] == '.' || !entity->devices.empty() ||
                                 !entity->programs.empty();
        if (!can_have_it || !fits_pattern(entity->instance.name, candidate.substr(0, cut))) continue;
        if (tries-- <= 0) return false;
        if (NamedValue(simulation_, entity->instance.name + std::string(candidate.substr(cut))).resolve())
          return true;
      }
      return false;
    });
  }
  Error unknown(std::string_view word) const override {
    return word.find('*') == std::string_view::npos ? no_such_value(simulation_, word)
                                                    : no_such_things(simulation_, word);
  }

 private:
  /// The longest beginning of `text` that names something. A '/' or '-' may belong to the name or be an operator.
  template <class Names>
  std::size_t longest(std::string_view text, Names&& names) const {
    const auto in_address = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) ||
             std::string_view("_./-[]*").find(c) != std::string_view::npos;
    };
    std::size_t end = 0;
    while (end < text.size() && end < longest_address && in_address(text[end])) ++end;
    for (std::size_t n = end; n > 0; --n) {
      if (n < end && std::string_view("/-*").find(text[n]) == std::string_view::npos) continue;
      const std::string_view candidate = text.substr(0, n);
      if (std::find(known_.begin(), known_.end(), candidate) != known_.end()) return n;
      if (names(candidate)) return n;
    }
    return 0;
  }

  static constexpr std::size_t longest_address = 300;
  const Simulation& simulation_;
  std::span<const std::string> known_;
};

Result<ValueExpression> ValueExpression::compile(const Simulation& simulation, std::string_view text,
                                                 const Place& place, std::span<const std::string> known) {
  SL_ASSIGN(Expression expression,
            Expression::compile(without_slash(trim(text)), SimulationNames(simulation, known), place));
  return ValueExpression(simulation, std::move(expression));
}

ValueExpression::ValueExpression(const Simulation& simulation, Expression expression)
    : simulation_(&simulation),
      expression_(std::move(expression)),
      numbers_(expression_.inputs().size()),
      populations_(expression_.patterns().size()),
      tables_(populations_.size()) {
  for (const std::string& address : expression_.inputs())
    inputs_.push_back(NamedValue::find_or_wait(simulation, address));
}

void ValueExpression::look_up() {
  for (NamedValue& input : inputs_) input = NamedValue::find_or_wait(*simulation_, input.address());
}

std::vector<std::string> ValueExpression::addresses() const {
  std::vector<std::string> all(expression_.inputs().begin(), expression_.inputs().end());
  for (const Expression::Pattern& pattern : expression_.patterns())
    for (const std::string& read : pattern.reads) all.push_back(pattern.things + read);
  return all;
}

std::size_t ValueExpression::reads() const {
  std::size_t sum = inputs_.size();
  for (const Expression::Pattern& pattern : expression_.patterns())
    for (const auto& entity : simulation_->entities())
      if (fits_pattern(entity->instance.name, pattern.things)) sum += pattern.reads.size();
  return sum;
}

std::string ValueExpression::unit() const {
  return inputs_.size() == 1 && inputs_.front().address() == text() ? inputs_.front().unit() : "";
}

void ValueExpression::look(const Expression::Pattern& pattern, Population& population) const {
  if (population.revision != simulation_->revision()) {
    population.revision = simulation_->revision();
    population.things = 0;
    population.values.clear();
    for (const auto& entity : simulation_->entities()) {
      if (!fits_pattern(entity->instance.name, pattern.things)) continue;
      ++population.things;
      for (const std::string& read : pattern.reads)
        population.values.push_back(NamedValue::find_or_wait(*simulation_, entity->instance.name + read));
    }
    population.numbers.resize(population.values.size());
  }
  for (std::size_t i = 0; i < population.values.size(); ++i)
    population.numbers[i] = population.values[i].read().value_or(Expression::no_value());
}

std::optional<Expression::Evaluated> ValueExpression::evaluate() {
  bool broken = false;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    const auto value = inputs_[i].read();
    if (!value) return std::nullopt;
    numbers_[i] = *value;
    broken = broken || inputs_[i].is_broken();
  }
  for (std::size_t i = 0; i < populations_.size(); ++i) {
    look(expression_.patterns()[i], populations_[i]);
    tables_[i] = {populations_[i].things, populations_[i].numbers};
  }
  Expression::Evaluated result = expression_.evaluate(numbers_, tables_);
  if (result.absent) return std::nullopt;
  if (!broken) return result;
  // What is named behaves as if it were written out: 1 / 0 > 3 is not a yes, wherever the 1 / 0 stands.
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (inputs_[i].is_broken()) numbers_[i] = Expression::broken_value();
  const Expression::Evaluated marked = expression_.evaluate(numbers_, tables_);
  result.finite = result.finite && marked.finite;
  result.broken = marked.broken;
  return result;
}

}  // namespace sandlot
