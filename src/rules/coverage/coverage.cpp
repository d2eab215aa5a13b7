/// coverage: how much of a space of values a run visits, such as the places of a robot or its joint angles.
///
/// Cells      each value's range is cut into `bins` equal parts; together they make bins^n cells. What lies beyond a range counts to
///            its first or last part.
/// Visited    cells that had at least `at_least` samples; `share` is their part of all cells.
/// Limits     at most a million cells; samples without a finite value are left out and counted.
/// Cost       one evaluation per value and sample.
#include <algorithm>
#include <cmath>

#include "rules/rule.h"

namespace sandlot::rules::coverage {
namespace {

struct Spec {
  std::vector<std::string> values;
  std::vector<std::array<double, 2>> ranges;
  int bins = 10, at_least = 1;
  double interval_s = 0.1, from_s = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"values", "", "Expressions that span the space.", 0, 0, Field::required, 20, 1}, s.values);
    visit(Field{"ranges", "", "Lower and upper end of each value; one for all values if there is one.", -1e12,
                1e12, Field::required, 20, 1},
          s.ranges);
    visit(Field{"bins", "1", "Parts of each range.", 1, 1000}, s.bins);
    visit(Field{"at_least", "1", "Samples from which on a cell counts as visited.", 1, 1e9}, s.at_least);
    visit(Field{"interval", "s", "Time between samples; 0: one in every tick.", 0, 1e6}, s.interval_s);
    visit(Field{"from", "s", "Time of the first sample.", 0, 1e9}, s.from_s);
  }
};

struct State {
  std::uint64_t samples = 0, skipped = 0, visited = 0;
  double share = 0;
  std::vector<std::uint32_t> cells;
  Time next;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"samples", "1", "Samples so far."}, s.samples);
    visit(Field{"skipped", "1", "Samples in which a value was missing or not finite."}, s.skipped);
    visit(Field{"visited", "1", "Cells visited so far."}, s.visited);
    visit(Field{"share", "1", "Visited cells as a part of all."}, s.share);
    visit(Field{"cells", "1", "Samples in each cell; the first value changes fastest."}, s.cells);
    visit(Field{"next", "s", "Time of the next sample."}, s.next);
  }
};

struct Coverage {
  using Spec = coverage::Spec;
  using State = coverage::State;
  Spec spec;
  State state;
  std::vector<std::uint32_t> watched;
  std::size_t count = 1;

  Status init(const ElementBuild& build) {
    if (spec.ranges.size() != 1 && spec.ranges.size() != spec.values.size())
      return build.error("ranges", "there are more or fewer ranges than values",
                         "give one, or one per value");
    for (const auto& [low, high] : spec.ranges)
      if (!(low < high))
        return build.error("ranges", "a range is empty", "the lower end comes first: [-1, 1]");
    count = 1;
    for (const std::string& value : spec.values) {
      count *= static_cast<std::size_t>(spec.bins);
      if (count > 1'000'000)
        return build.error("bins", "there would be more than a million cells", "take fewer bins or values");
      SL_ASSIGN(const std::uint32_t each, build.watch(value, "values"));
      watched.push_back(each);
    }
    state.next = Time::from_s(spec.from_s);
    state.cells.assign(count, 0);
    return {};
  }
  bool fits() const { return state.next >= Time{} && state.cells.size() == count; }

  void judge(const RuleContext& context, RuleActions&) {
    if (context.now < state.next) return;
    const Time interval = Time::from_s(spec.interval_s);
    // The sample that is due stands for those before it that a long tick has passed over.
    if (interval > Time{})
      state.next = state.next + Time{((context.now - state.next).ns / interval.ns + 1) * interval.ns};
    ++state.samples;
    std::size_t cell = 0, stride = 1;
    for (std::size_t i = 0; i < watched.size(); ++i) {
      const std::optional<double> x = context.world.value(watched[i]);
      if (!x || !std::isfinite(*x)) {
        ++state.skipped;
        return;
      }
      const auto& [low, high] = spec.ranges[spec.ranges.size() == 1 ? 0 : i];
      const double part = std::floor(std::clamp((*x - low) / (high - low), 0.0, 1.0) * spec.bins);
      cell += stride * std::min(static_cast<std::size_t>(part), static_cast<std::size_t>(spec.bins) - 1);
      stride *= static_cast<std::size_t>(spec.bins);
    }
    if (state.cells[cell] == ~0u) return;
    if (++state.cells[cell] != static_cast<std::uint32_t>(spec.at_least)) return;
    ++state.visited;
    state.share = static_cast<double>(state.visited) / static_cast<double>(count);
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Coverage>({
    .name = "coverage",
    .help = "Counts the cells of a space of values that a run visits.",
});

}  // namespace sandlot::rules::coverage
