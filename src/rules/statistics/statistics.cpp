/// statistics: distribution of a value over time, or over all things of a kind and over time.
///
/// Numbers    `value`: one number per sample, the value of the expression. `each`: at every sample one number of each thing that
///            the pattern fits. A sample in which the expression has no finite value is left out and counted.
/// Moments    batches are merged pairwise: mean and sum of squares stay exact to rounding for any length of a run.
/// Quantiles  of the histogram, linear within a bin; what lies beyond its ends is taken to lie at the ends.
/// Limits     numbers are not kept; neighbouring samples in time are not independent, so deviation / sqrt(count) is not the
///            standard error of the mean.
/// Cost       one evaluation per sample; with `each` five, and one more per bin.
/// Source     T. F. Chan, G. H. Golub, R. J. LeVeque, Updating formulae and a pairwise algorithm for computing sample variances
///            (1979).
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "rules/rule.h"

namespace sandlot::rules::statistics {
namespace {

struct Spec {
  std::string value, each;
  double interval_s = 0, from_s = 0;
  std::array<double, 2> range{0, 1};
  int bins = 0;
  std::vector<double> quantiles;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"value", "", "Expression with one number per sample.", 0, 0, Field::none, 2000}, s.value);
    visit(Field{"each", "",
                "Expression with a pattern, such as bird*.pose.x: a number of each thing per sample.", 0, 0,
                Field::none, 2000},
          s.each);
    visit(Field{"interval", "s", "Time between samples; 0: one in every tick.", 0, 1e6}, s.interval_s);
    visit(Field{"from", "s", "Time of the first sample.", 0, 1e9}, s.from_s);
    visit(Field{"range", "", "Ends of the histogram, the lower one first.", -1e12, 1e12}, s.range);
    visit(Field{"bins", "1", "Number of bins of the histogram; 0: no histogram.", 0, 1000}, s.bins);
    visit(Field{"quantiles", "1", "Fractions of which the quantiles are given, such as [0.1, 0.5, 0.9].", 0,
                1, Field::none, 100},
          s.quantiles);
  }
};

struct State {
  std::uint64_t samples = 0, skipped = 0, count = 0;
  double mean = 0, squares = 0, deviation = 0, min = 0, max = 0;
  std::uint64_t below = 0, above = 0;
  std::vector<std::uint64_t> histogram;
  std::vector<double> quantiles;
  Time next;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"samples", "1", "Samples so far."}, s.samples);
    visit(Field{"skipped", "1", "Samples in which there was no finite value."}, s.skipped);
    visit(Field{"count", "1", "Numbers so far."}, s.count);
    visit(Field{"mean", "", "Mean of the numbers."}, s.mean);
    visit(Field{"squares", "", "Sum of the squared distances from the mean."}, s.squares);
    visit(Field{"deviation", "", "Standard deviation, by n - 1."}, s.deviation);
    visit(Field{"min", "", "Smallest number."}, s.min);
    visit(Field{"max", "", "Largest number."}, s.max);
    visit(Field{"below", "1", "Numbers below the histogram's range."}, s.below);
    visit(Field{"above", "1", "Numbers at or above the upper end of the histogram's range."}, s.above);
    visit(Field{"histogram", "1", "Numbers in each bin; its lower end belongs to a bin."}, s.histogram);
    visit(Field{"quantile", "", "Quantiles in the order of the key, from the histogram."}, s.quantiles);
    visit(Field{"next", "s", "Time of the next sample."}, s.next);
  }
};

/// Numbers that came together.
struct Batch {
  double count = 0, mean = 0, squares = 0, min = 0, max = 0;
};

struct Statistics {
  using Spec = statistics::Spec;
  using State = statistics::State;
  Spec spec;
  State state;
  std::uint32_t value = 0;                                                        ///< of `value`
  std::uint32_t count = 0, mean = 0, deviation = 0, min = 0, max = 0, below = 0;  ///< of `each`
  std::vector<std::uint32_t> bins;

  Status init(const ElementBuild& build) {
    if (spec.value.empty() == spec.each.empty())
      return build.error(
          "value",
          spec.value.empty() ? "neither `value` nor `each` is given" : "both `value` and `each` are given",
          "give one of them");
    if (spec.bins > 0 && !(spec.range[0] < spec.range[1]))
      return build.error("range", "the histogram's range is empty", "the lower end comes first: [0, 10]");
    if (!spec.quantiles.empty() && spec.bins == 0)
      return build.error("quantiles", "quantiles are taken from the histogram, and there is none",
                         "give bins and range");
    state.next = Time::from_s(spec.from_s);
    state.histogram.resize(static_cast<std::size_t>(spec.bins), 0);
    return spec.each.empty() ? watch_value(build) : watch_each(build);
  }
  bool fits() const {
    return state.next >= Time{} && state.histogram.size() == static_cast<std::size_t>(spec.bins) &&
           (state.quantiles.empty() || state.quantiles.size() == spec.quantiles.size());
  }

  Status watch_value(const ElementBuild& build) {
    SL_ASSIGN(value, build.watch(spec.value, "value"));
    return {};
  }
  Status watch_each(const ElementBuild& build) {
    const std::string each = "(" + spec.each + ")";
    const auto watch = [&](std::uint32_t& to, const std::string& expression) -> Status {
      SL_ASSIGN(to, build.watch(expression, "each"));
      return {};
    };
    SL_TRY(watch(count, "count(" + each + " == " + each + ")"));
    SL_TRY(watch(mean, "mean(" + each + ")"));
    SL_TRY(watch(deviation, "deviation(" + each + ")"));
    SL_TRY(watch(min, "min(" + each + ")"));
    SL_TRY(watch(max, "max(" + each + ")"));
    if (spec.bins == 0) return {};
    SL_TRY(watch(below, "count(" + each + " < " + edge(0) + ")"));
    bins.resize(static_cast<std::size_t>(spec.bins));
    for (std::size_t i = 0; i < bins.size(); ++i)
      SL_TRY(watch(bins[i], "count(" + each + " >= " + edge(i) + " and " + each + " < " + edge(i + 1) + ")"));
    return {};
  }
  double edge_at(std::size_t i) const {
    return spec.range[0] + (spec.range[1] - spec.range[0]) * (static_cast<double>(i) / spec.bins);
  }
  std::string edge(std::size_t i) const { return "(" + number_text(edge_at(i)) + ")"; }

  void judge(const RuleContext& context, RuleActions&) {
    if (context.now < state.next) return;
    const Time interval = Time::from_s(spec.interval_s);
    // The sample that is due stands for those before it that a long tick has passed over.
    if (interval > Time{})
      state.next = state.next + Time{((context.now - state.next).ns / interval.ns + 1) * interval.ns};
    ++state.samples;
    if (spec.each.empty() ? !take_value(context.world) : !take_each(context.world)) ++state.skipped;
    else update_quantiles();
  }

  bool take_value(const WorldView& world) {
    const std::optional<double> x = world.value(value);
    if (!x) return false;
    merge({1, *x, 0, *x, *x});
    if (spec.bins == 0) return true;
    if (*x < spec.range[0]) ++state.below;
    else if (!(*x < spec.range[1])) ++state.above;
    else {
      // By the bins' own edges, so that `value` and `each` agree on a number at an edge.
      std::size_t low = 0, high = state.histogram.size();
      while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (*x < edge_at(middle) ? high : low) = middle;
      }
      ++state.histogram[low];
    }
    return true;
  }

  bool take_each(const WorldView& world) {
    const auto n = world.value(count), middle = world.value(mean), least = world.value(min),
               most = world.value(max);
    if (!n || *n < 1 || !middle || !least || !most) return false;
    const double spread = world.value(deviation).value_or(0);  // of one thing there is none
    merge({*n, *middle, spread * spread * (*n - 1), *least, *most});
    if (spec.bins == 0) return true;
    std::uint64_t counted = 0;
    const auto add = [&](std::uint64_t& to, std::uint32_t watched) {
      const auto here = static_cast<std::uint64_t>(world.value(watched).value_or(0));
      to += here, counted += here;
    };
    add(state.below, below);
    for (std::size_t i = 0; i < bins.size(); ++i) add(state.histogram[i], bins[i]);
    const auto all = static_cast<std::uint64_t>(*n);
    state.above += all - std::min(all, counted);
    return true;
  }

  void merge(const Batch& batch) {
    const double before = static_cast<double>(state.count), all = before + batch.count;
    const double apart = batch.mean - state.mean;
    state.min = state.count == 0 ? batch.min : std::min(state.min, batch.min);
    state.max = state.count == 0 ? batch.max : std::max(state.max, batch.max);
    state.mean += apart * (batch.count / all);
    state.squares += batch.squares + apart * apart * (before * batch.count / all);
    state.count += static_cast<std::uint64_t>(batch.count);
    state.deviation = all < 2 ? 0 : std::sqrt(state.squares / (all - 1));
  }

  void update_quantiles() {
    state.quantiles.resize(spec.quantiles.size());
    for (std::size_t i = 0; i < spec.quantiles.size(); ++i) state.quantiles[i] = quantile(spec.quantiles[i]);
  }
  double quantile(double fraction) const {
    double left = fraction * static_cast<double>(state.count) - static_cast<double>(state.below);
    if (left <= 0) return spec.range[0];
    for (std::size_t i = 0; i < state.histogram.size(); ++i) {
      const auto here = static_cast<double>(state.histogram[i]);
      if (left <= here) return edge_at(i) + (edge_at(i + 1) - edge_at(i)) * (left / here);
      left -= here;
    }
    return spec.range[1];
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Statistics>({
    .name = "statistics",
    .help = "Mean, spread, histogram and quantiles of a value over time, or of all things of a kind.",
});

}  // namespace sandlot::rules::statistics
