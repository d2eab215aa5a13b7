#pragma once
/// Monitor: the named values of a scenario, and its events, which happen when a condition has held for a while.
///
/// Named values are computed when they are asked for, in the order of their declaration; each may use those before it.
/// Events are judged once per tick, in phase 7. An event happens when its condition has held (was other than 0) for
/// `hold` without a break, and once per such stretch. No value (nothing measured yet) counts as "does not hold"; a
/// value that is not a finite number fails the run.
///
/// Criteria are what a run or a team is judged by. They are computed when they are asked for, and no part of State.
///
/// State   of the scenario's events: since when they hold, how often they happened. Events added later (from the
///         command line) are a matter of the observer, like the stop time, and no part of State.
#include <optional>
#include <string>
#include <vector>

#include "sim/watch/values.h"

namespace sandlot {

class Monitor {
 public:
  struct Event {
    model::EventDecl decl;
    bool declared = true;  ///< by the scenario
    ValueExpression condition;
    // State:
    bool holds = false;
    Time since;             ///< holds without a break since then
    bool happened = false;  ///< in this stretch
    std::uint64_t count = 0;
    Time first, last;  ///< when it happened, if count > 0

    static void state(auto& e, auto&& visit) {
      visit(e.holds);
      visit(e.since);
      visit(e.happened);
      visit(e.count);
      visit(e.first);
      visit(e.last);
    }
  };

  /// What a team, or with team "" the whole run, is judged by.
  struct Criterion {
    std::string team;
    model::CriterionDecl decl;
    mutable ValueExpression value;
    mutable std::optional<ValueExpression> success;
  };

  explicit Monitor(const Simulation& simulation) : simulation_(simulation) {}
  /// Compiles values, then criteria and events: each may use what is before it. The addresses they use are appended to
  /// `known`, which also makes addresses acceptable that name nothing now.
  Status add(const model::Setup& setup, std::vector<std::string>& known);
  Status add_event(model::EventDecl decl, bool declared, std::span<const std::string> known);

  std::optional<std::uint32_t> find_value(std::string_view name) const;
  const std::vector<std::string>& value_names() const { return names_; }
  /// The present value of a named value.
  std::optional<double> value(std::uint32_t index) const;
  /// Whether the latest value() of it was an infinity or NaN that came of finite numbers, such as 1 / 0.
  bool is_broken(std::uint32_t index) const { return computed_[index].broken; }

  /// The run's own, if it has one, and then those of the teams.
  const std::vector<Criterion>& criteria() const { return criteria_; }
  /// Null where that team, or with "" the run, is not judged.
  const Criterion* find_criterion(std::string_view team) const;
  /// The present value; nothing while something it reads has none. Errors: it is no finite number.
  Result<std::optional<double>> judge(const Criterion& criterion) const;
  /// Whether the run succeeds as things are; nothing where that is not asked. Errors as above.
  Result<std::optional<bool>> succeeds(const Criterion& criterion) const;

  const std::vector<Event>& events() const { return events_; }
  std::vector<Event>& events() { return events_; }
  /// Names of the events that happened in the latest tick.
  std::span<const std::string> happened() const { return happened_; }
  /// Judges all events at `now`. @return the reason to stop, if one stops the run
  Result<std::optional<std::string>> judge(Time now);
  /// The State of the scenario's events; nothing when it has none.
  void save(ByteWriter& w) const;
  void load(ByteReader& r);

 private:
  const Simulation& simulation_;
  std::vector<std::string> names_;
  mutable std::vector<ValueExpression> values_;
  struct Computed {
    std::optional<double> value;
    bool broken = false;
  };
  mutable std::vector<Computed> computed_;
  mutable std::uint32_t computing_ = 0;  ///< values below this index are those of now
  std::vector<Event> events_;
  std::vector<Criterion> criteria_;
  std::vector<std::string> happened_;
};

}  // namespace sandlot
