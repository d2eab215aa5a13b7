/// path: how far a point travels, and how fast, by samples of its coordinates.
///
/// Length     sum of the straight pieces between samples. A longer `interval` leaves out what goes back and forth: a robot that
///            rocks in its place travels little.
/// Speed      length / time since the first sample.
/// Farthest   largest distance from the first sample.
/// Limits     samples without a finite value are left out and counted; a point that is put elsewhere has travelled there.
/// Cost       one evaluation per coordinate and sample.
#include <cmath>

#include "rules/rule.h"

namespace sandlot::rules::path {
namespace {

struct Spec {
  std::vector<std::string> values;
  double interval_s = 1, from_s = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"values", "", "Expressions of the coordinates, such as [rover.pose.x, rover.pose.y].", 0, 0,
                Field::required, 20, 1},
          s.values);
    visit(Field{"interval", "s", "Time between samples; 0: one in every tick.", 0, 1e6}, s.interval_s);
    visit(Field{"from", "s", "Time of the first sample.", 0, 1e9}, s.from_s);
  }
};

struct State {
  std::uint64_t samples = 0, skipped = 0;
  double length = 0, speed = 0, farthest = 0;
  std::vector<double> begin, last;
  Time begun, next;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"samples", "1", "Samples so far."}, s.samples);
    visit(Field{"skipped", "1", "Samples in which a value was missing or not finite."}, s.skipped);
    visit(Field{"length", "", "Length of the path so far, in the unit of the values."}, s.length);
    visit(Field{"speed", "", "Length per second since the first sample."}, s.speed);
    visit(Field{"farthest", "", "Largest distance from the first sample."}, s.farthest);
    visit(Field{"begin", "", "First sample."}, s.begin);
    visit(Field{"last", "", "Latest sample."}, s.last);
    visit(Field{"begun", "s", "Time of the first sample."}, s.begun);
    visit(Field{"next", "s", "Time of the next sample."}, s.next);
  }
};

struct Path {
  using Spec = path::Spec;
  using State = path::State;
  Spec spec;
  State state;
  std::vector<std::uint32_t> watched;
  std::vector<double> now;

  Status init(const ElementBuild& build) {
    for (const std::string& value : spec.values) {
      SL_ASSIGN(const std::uint32_t each, build.watch(value, "values"));
      watched.push_back(each);
    }
    state.next = Time::from_s(spec.from_s);
    state.begin.assign(watched.size(), 0);
    state.last = now = state.begin;
    return {};
  }
  bool fits() const {
    return state.next >= Time{} && state.begin.size() == watched.size() &&
           state.last.size() == watched.size();
  }

  void judge(const RuleContext& context, RuleActions&) {
    if (context.now < state.next) return;
    const Time interval = Time::from_s(spec.interval_s);
    // The sample that is due stands for those before it that a long tick has passed over.
    if (interval > Time{})
      state.next = state.next + Time{((context.now - state.next).ns / interval.ns + 1) * interval.ns};
    ++state.samples;
    for (std::size_t i = 0; i < watched.size(); ++i) {
      const std::optional<double> x = context.world.value(watched[i]);
      if (!x || !std::isfinite(*x)) {
        ++state.skipped;
        return;
      }
      now[i] = *x;
    }
    if (state.samples == state.skipped + 1) {
      state.begin = state.last = now;
      state.begun = context.now;
      return;
    }
    state.length += distance(now, state.last);
    state.farthest = std::max(state.farthest, distance(now, state.begin));
    state.speed = state.length / (context.now - state.begun).s();
    state.last = now;
  }

  static double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum);
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Path>({
    .name = "path",
    .help = "Length of the path of a point, its mean speed and largest distance from the start.",
});

}  // namespace sandlot::rules::path
