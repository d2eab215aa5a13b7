/// episodes: how often and how long a condition holds without a break.
///
/// Episode    a time in which the condition holds at every sample, if it lasts for at least `at_least`; it counts from then on.
/// Limits     a condition without a value does not hold.
/// Cost       one evaluation per sample.
#include <algorithm>

#include "rules/rule.h"

namespace sandlot::rules::episodes {
namespace {

struct Spec {
  std::string when;
  double at_least_s = 0, interval_s = 0, from_s = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"when", "", "Condition: an expression that is other than 0.", 0, 0, Field::required, 2000},
          s.when);
    visit(Field{"at_least", "s", "Shortest time that counts.", 0, 1e9}, s.at_least_s);
    visit(Field{"interval", "s", "Time between samples; 0: one in every tick.", 0, 1e6}, s.interval_s);
    visit(Field{"from", "s", "Time of the first sample.", 0, 1e9}, s.from_s);
  }
};

struct State {
  bool holds = false, counted = false;
  std::uint64_t count = 0;
  double longest_s = 0, first_s = -1;
  Time since, next;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"holds", "", "Whether the condition held at the latest sample."}, s.holds);
    visit(Field{"counted", "", "Whether the present time is long enough to count."}, s.counted);
    visit(Field{"count", "1", "Episodes so far."}, s.count);
    visit(Field{"longest", "s", "Longest time that the condition held without a break."}, s.longest_s);
    visit(Field{"first", "s", "Time at which the first episode began; -1: none so far."}, s.first_s);
    visit(Field{"since", "s", "Time since which the condition holds."}, s.since);
    visit(Field{"next", "s", "Time of the next sample."}, s.next);
  }
};

struct Episodes {
  using Spec = episodes::Spec;
  using State = episodes::State;
  Spec spec;
  State state;
  std::uint32_t when = 0;

  Status init(const ElementBuild& build) {
    SL_ASSIGN(when, build.watch(spec.when, "when"));
    state.next = Time::from_s(spec.from_s);
    return {};
  }
  bool fits() const { return state.next >= Time{} && state.since >= Time{}; }

  void judge(const RuleContext& context, RuleActions&) {
    if (context.now < state.next) return;
    const Time interval = Time::from_s(spec.interval_s);
    // The sample that is due stands for those before it that a long tick has passed over.
    if (interval > Time{})
      state.next = state.next + Time{((context.now - state.next).ns / interval.ns + 1) * interval.ns};
    const std::optional<double> value = context.world.value(when);
    const bool holds = value && *value != 0;
    if (!holds) {
      state.holds = state.counted = false;
      return;
    }
    if (!state.holds) state.since = context.now;
    state.holds = true;
    const double held_s = (context.now - state.since).s();
    state.longest_s = std::max(state.longest_s, held_s);
    if (state.counted || held_s < spec.at_least_s) return;
    state.counted = true;
    ++state.count;
    if (state.first_s < 0) state.first_s = state.since.s();
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Episodes>({
    .name = "episodes",
    .help = "Counts how often and how long a condition holds without a break.",
});

}  // namespace sandlot::rules::episodes
