#pragma once
/// Rule: a judgement of the true state of the world once per tick, after sensing and before control. It may act by requests
/// and end the run.
///
/// A kind is one folder under rules/ and one line in rules/kinds.h. It writes a struct
///   struct Goals {
///     using Spec = ...; using State = ...;                    // with field lists; State is saved and hashed
///     Spec spec; State state;
///     Status init(const ElementBuild&);                       // checks names and compiles expressions
///     void judge(const RuleContext&, RuleActions&);
///     bool fits() const;                                      // only where sizes in State are trusted: false refuses a snapshot
///   };
/// and `const RuleKind kind = make_rule<Goals>({...})`.
///
/// Requests   act at the beginning of the next tick, after those from outside and before the orders of programs, in the order
///            of the rules in the file. They are logged. A replay judges again, so they are not fed from the log.
/// Restore    a rule is never judged twice for one tick: requests that still wait and a reason to stop are State.
/// Cost       one call per rule and tick. Touches are gathered only for kinds that ask for them.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/describe.h"
#include "base/element.h"
#include "elements/request.h"
#include "elements/world_view.h"

namespace sandlot {

struct RuleContext {
  Time now;   ///< end of the tick
  Time step;  ///< its length
  std::uint64_t tick_index = 0;
  std::uint64_t seed = 0;
  const WorldView& world;
  std::span<const BodyTouch> touches;  ///< of all sub-steps of the tick, if some rule asks for them
};

/// What a rule wants done.
class RuleActions {
 public:
  /// For the beginning of the next tick.
  void request(Request request) { requests.push_back(std::move(request)); }
  /// Ends the run after this tick. The first reason counts.
  void stop(std::string why) {
    if (!reason) reason = std::move(why);
  }
  std::vector<Request> requests;
  std::optional<std::string> reason;
};

class Rule : public Element {
 public:
  /// Reads the keys and checks names.
  virtual Status init(const ElementBuild& build) = 0;
  virtual void judge(const RuleContext& context, RuleActions& actions) = 0;
};

struct RuleKind {
  enum class Touches : std::uint8_t {
    none,
    pairs,     ///< who touched whom
    impulses,  ///< with the impulse between them; the engine then reports all contacts of robots
  };
  const char* name;
  const char* help;
  Touches touches = Touches::none;
  // Filled by make_rule:
  std::vector<FieldInfo> (*describe)() = nullptr;
  std::unique_ptr<Rule> (*create)() = nullptr;
};

template <class R>
class RuleAdapter final : public ElementAdapter<Rule, R> {
 public:
  Status init(const ElementBuild& build) override {
    SL_ASSIGN(this->element_.spec, read_spec<typename R::Spec>(build.decl.config));
    return this->element_.init(build);
  }
  void judge(const RuleContext& context, RuleActions& actions) override {
    this->element_.judge(context, actions);
  }
};

template <class R>
constexpr RuleKind make_rule(RuleKind kind) {
  kind.describe = [] { return describe_fields<typename R::Spec>(); };
  kind.create = []() -> std::unique_ptr<Rule> { return std::make_unique<RuleAdapter<R>>(); };
  return kind;
}

std::span<const RuleKind* const> rule_kinds();

}  // namespace sandlot
