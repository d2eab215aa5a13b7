/// set: sets parameters whenever a condition begins to hold: freezes, repairs, charges, scores.
///
/// Time       the condition is judged at the end of a tick, the parameters change at the beginning of the next one, in the order
///            of the list. Expressions have their values of the end of the tick.
/// Limits     parameters that are texts or numbers; an expression without a finite value sets nothing and is counted.
#include "base/text.h"
#include "rules/rule.h"

namespace sandlot::rules::set {
namespace {

struct Setting {
  std::string parameter, value, expression;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"parameter", "", "Address of the parameter, such as red1/drive.failure.", 0, 0,
                Field::required, 300},
          s.parameter);
    visit(Field{"value", "", "New value, such as dead or 5 cm.", 0, 0, Field::none, 300}, s.value);
    visit(
        Field{"expression", "", "Expression that gives the new value, in SI units.", 0, 0, Field::none, 2000},
        s.expression);
  }
};

struct Spec {
  std::string when;
  std::vector<Setting> settings;
  bool once = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"when", "", "Condition: an expression that is other than 0.", 0, 0, Field::required, 2000},
          s.when);
    visit(Field{"set", "", "Parameters to set, in this order.", 0, 0, Field::required, 100, 1}, s.settings);
    visit(Field{"once", "", "Whether they are set at the first time alone."}, s.once);
  }
};

struct State {
  bool holds = false;
  std::uint64_t count = 0, skipped = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"holds", "", "Whether the condition held in the latest tick."}, s.holds);
    visit(Field{"count", "1", "Times that the condition began to hold and parameters were set."}, s.count);
    visit(Field{"skipped", "1", "Parameters not set because their expression had no value."}, s.skipped);
  }
};

struct Set {
  using Spec = set::Spec;
  using State = set::State;
  Spec spec;
  State state;
  std::uint32_t when = 0;
  std::vector<std::uint32_t> expressions;  ///< per setting, of those that have one
  std::vector<ElementBuild::ParameterName> names;

  Status init(const ElementBuild& build) {
    SL_ASSIGN(when, build.watch(spec.when, "when"));
    expressions.resize(spec.settings.size());
    names.resize(spec.settings.size());
    for (std::size_t i = 0; i < spec.settings.size(); ++i) {
      const Setting& setting = spec.settings[i];
      if (setting.value.empty() == setting.expression.empty())
        return build.error(
            "set", "'" + setting.parameter.substr(0, 100) + "' has neither or both of value and expression",
            "give one of them");
      SL_ASSIGN(names[i], build.expect_parameter(setting.parameter, setting.value, "set"));
      if (setting.expression.empty()) continue;
      SL_ASSIGN(expressions[i], build.watch(setting.expression, "set"));
    }
    return {};
  }

  void judge(const RuleContext& context, RuleActions& actions) {
    const std::optional<double> value = context.world.value(when);
    const bool holds = value && *value != 0;
    const bool begins = holds && !state.holds;
    state.holds = holds;
    if (!begins || (spec.once && state.count > 0)) return;
    ++state.count;
    for (std::size_t i = 0; i < spec.settings.size(); ++i) {
      const Setting& setting = spec.settings[i];
      std::string text = setting.value;
      if (!setting.expression.empty()) {
        const std::optional<double> x = context.world.value(expressions[i]);
        if (!x) {
          ++state.skipped;
          continue;
        }
        text = number_text(*x);
      }
      actions.request(ParameterRequest{names[i].target, names[i].field, Node::scalar(std::move(text))});
    }
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Set>({
    .name = "set",
    .help = "Sets parameters whenever a condition begins to hold: freezes, repairs, charges, scores.",
});

}  // namespace sandlot::rules::set
