#include "sim/watch/monitor.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace sandlot {

namespace {

Error no_finite_number(const std::string& what, const Place& place, double value,
                       const std::string& expression, Time now) {
  return {what + ": " +
              // A comparison with infinity is a finite 0 or 1.
              (std::isfinite(value) ? "a part of '" : "'") + expression + "' is not a finite number at " +
              number_text(now.s()) + " s",
          "guard it, as in if(x == 0, 0, 1 / x)", place};
}

std::string title(const Monitor::Criterion& criterion) {
  return criterion.team.empty() ? "criterion" : "criterion of team " + criterion.team;
}

}  // namespace

Status Monitor::add(const model::Setup& setup, std::vector<std::string>& known) {
  // A restored world may speak of what is gone, but never of a value or criterion that comes later: that could speak
  // of this one.
  std::vector<std::string> before = known;
  std::erase_if(before, [&](const std::string& address) {
    const bool of_team = std::any_of(
        setup.teams.begin(), setup.teams.end(),
        [&](const model::TeamDecl& team) { return address == team.name + ".criterion"; });
    return of_team || address == "criterion" ||
           std::any_of(setup.values.begin(), setup.values.end(), [&](const model::ValueDecl& value) {
             return address == value.name || address == "values." + value.name;
           });
  });
  const auto note = [&](const ValueExpression& expression) {
    for (const std::string& address : expression.addresses())
      if (std::find(known.begin(), known.end(), address) == known.end()) known.push_back(address);
  };
  for (const model::ValueDecl& decl : setup.values) {
    if (Expression::is_reserved(decl.name) || (decl.name == "criterion" && setup.criterion))
      return Error{"'" + decl.name + "' cannot be the name of a value: it means something in expressions",
                   "give it another name", decl.place};
    SL_ASSIGN(ValueExpression expression,
              ValueExpression::compile(simulation_, decl.expression, decl.place, before));
    note(expression);
    names_.push_back(decl.name);
    values_.push_back(std::move(expression));
    computed_.emplace_back();
  }
  // Compiled before any is there: none can speak of another, or of itself.
  std::vector<Criterion> criteria;
  const auto add_criterion = [&](const std::string& team, const model::CriterionDecl& decl) -> Status {
    SL_ASSIGN(ValueExpression value, ValueExpression::compile(simulation_, decl.value, decl.place, before));
    note(value);
    criteria.push_back({team, decl, std::move(value), {}});
    if (decl.success.empty()) return {};
    SL_ASSIGN(criteria.back().success,
              ValueExpression::compile(simulation_, decl.success, decl.success_place, before));
    note(*criteria.back().success);
    return {};
  };
  if (setup.criterion) SL_TRY(add_criterion("", *setup.criterion));
  for (const model::TeamDecl& team : setup.teams)
    if (team.criterion) SL_TRY(add_criterion(team.name, *team.criterion));
  criteria_ = std::move(criteria);
  for (const model::EventDecl& decl : setup.events) {
    SL_TRY(add_event(decl, true, before));
    note(events_.back().condition);
  }
  return {};
}

const Monitor::Criterion* Monitor::find_criterion(std::string_view team) const {
  for (const Criterion& criterion : criteria_)
    if (criterion.team == team) return &criterion;
  return nullptr;
}

Result<std::optional<double>> Monitor::judge(const Criterion& criterion) const {
  const auto result = criterion.value.evaluate();
  if (!result) return std::optional<double>();
  if (!result->finite)
    return no_finite_number(title(criterion), criterion.decl.place, result->value, criterion.decl.value,
                            simulation_.now());
  return std::optional(result->value);
}

Result<std::optional<bool>> Monitor::succeeds(const Criterion& criterion) const {
  if (!criterion.success) return std::optional<bool>();
  const auto result = criterion.success->evaluate();
  if (result && !result->finite)
    return no_finite_number("success by the " + title(criterion), criterion.decl.success_place, result->value,
                            criterion.decl.success, simulation_.now());
  return std::optional(result && result->value != 0);
}

Status Monitor::add_event(model::EventDecl decl, bool declared, std::span<const std::string> known) {
  SL_ASSIGN(ValueExpression condition, ValueExpression::compile(simulation_, decl.when, decl.place, known));
  happened_.reserve(events_.size() + 1);
  events_.push_back({std::move(decl), declared, std::move(condition)});
  return {};
}

std::optional<std::uint32_t> Monitor::find_value(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return std::nullopt;
  return static_cast<std::uint32_t>(found - names_.begin());
}

std::optional<double> Monitor::value(std::uint32_t index) const {
  // An expression that is being computed asks for those before it: they are ready.
  if (index < computing_) return computed_[index].value;
  SL_CHECK(computing_ == 0);
  for (; computing_ <= index; ++computing_) {
    const auto result = values_[computing_].evaluate();
    computed_[computing_].value = result ? std::optional(result->value) : std::nullopt;
    computed_[computing_].broken = result && result->broken;
  }
  computing_ = 0;
  return computed_[index].value;
}

void Monitor::save(ByteWriter& w) const {
  for (const Event& event : events_)
    if (event.declared) Event::state(event, [&](const auto& value) { write(w, value); });
}

void Monitor::load(ByteReader& r) {
  for (Event& event : events_)
    if (event.declared) Event::state(event, [&](auto& value) { read(r, value); });
}

Result<std::optional<std::string>> Monitor::judge(Time now) {
  happened_.clear();
  std::optional<std::string> reason;
  for (Event& event : events_) {
    const auto condition = event.condition.evaluate();
    if (condition && !condition->finite)
      return no_finite_number("event '" + event.decl.name + "'", event.decl.place, condition->value,
                              event.decl.when, now);
    if (!condition || condition->value == 0) {
      event.holds = event.happened = false;
      continue;
    }
    if (!event.holds) event.since = now;
    event.holds = true;
    if (!event.happened && now - event.since >= event.decl.hold && !(event.decl.once && event.count > 0)) {
      event.happened = true;
      if (event.count++ == 0) event.first = now;
      event.last = now;
    }
    // Asked again at the same time, after a restore, it answers the same.
    if (!event.happened || event.last != now) continue;
    happened_.push_back(event.decl.name);
    if (event.decl.stop && !reason) reason = "event '" + event.decl.name + "': " + event.decl.when;
  }
  return reason;
}

}  // namespace sandlot
