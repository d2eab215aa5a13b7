#include "run/run.h"

#include <optional>
#include <utility>

#include "base/atomic_file.h"
#include "base/text.h"
#include "console/console.h"
#include "run/outputs.h"
#include "sim/session/run_hooks.h"
#include "sim/session/session.h"

namespace sandlot {
namespace {

/// The parts of a run and how they are connected. Session calls back into the others, but only within
/// execute().
class Run {
 public:
  Run(const RunSpec& spec, const RunCallbacks& callbacks, PreparedRun prepared, Diagnostics diagnostics)
      : spec_(spec),
        callbacks_(callbacks),
        prepared_(std::move(prepared)),
        warnings_(std::move(diagnostics.warnings)),
        begin_(prepared_.simulation->now()),
        hooks_(callbacks.hooks ? std::make_optional<RunHooks>(*prepared_.simulation, *callbacks.hooks)
                               : std::nullopt),
        session_(std::move(prepared_.simulation), session_options()),
        outputs_(spec, session_, [this](Error warning) { warn(std::move(warning)); }),
        console_(session_, {.paths = spec.paths,
                            .experiment = hooks_ ? &*hooks_ : nullptr,
                            .record = [this](const std::string& file) { return outputs_.record(file); }}) {}
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// All that can refuse the run, in the order that replaces files last.
  Status start();
  /// From the first tick to the last.
  void execute();
  /// Instead of execute() and finish(), when start() has failed.
  void abandon();
  /// Ends what is being written and writes the files of the end.
  Summary finish();

 private:
  Session::Options session_options();
  Status tick(Simulation& simulation, std::optional<Time> measured);
  bool keep_going(const Simulation& simulation);
  void warn(Error warning);

  const RunSpec& spec_;
  const RunCallbacks& callbacks_;
  PreparedRun prepared_;
  std::vector<Error> warnings_;
  Time begin_;
  std::optional<RunHooks> hooks_;
  Status hooks_status_;  ///< of hooks that were given back their state
  Session session_;
  RunOutputs outputs_;
  Console console_;
  RunReport report_;
  std::optional<std::uint64_t> seen_tick_;  ///< by keep_going()
  bool ready_ = false;                      ///< on_ready was called
};

Session::Options Run::session_options() {
  Session::Options options{
      .pace = {spec_.rate},
      .paused = spec_.paused,
      .history_mb = spec_.steered ? Session::Options().history_mb : 0,
      .simulation = prepared_.options,
      .may_not_rewind = hooks_ ? callbacks_.hooks->may_not_rewind() : "",
      .may_not_load = hooks_ && !callbacks_.hooks->stateless
                          ? "it does not hold the state of the experiment in C++"
                          : "",
      .on_world =
          [this](Simulation& next, const std::string& why) {
            if (hooks_) hooks_->replace(next);
            outputs_.on_world_replaced(next, why);
          },
      .tick = [this](Simulation& simulation,
                     std::optional<Time> measured) { return tick(simulation, measured); }};
  if (!spec_.steered && options.may_not_rewind.empty())
    options.may_not_rewind = "snapshots for that are kept with --port alone";
  if (hooks_) {
    options.save_beside = [this] { return hooks_->save(); };
    options.load_beside = [this](std::span<const std::byte> saved) { hooks_status_ = hooks_->load(saved); };
  }
  return options;
}

Status Run::tick(Simulation& simulation, std::optional<Time> measured) {
  SL_TRY(std::exchange(hooks_status_, {}));
  // A tick that runs again after a rewind has all its input already.
  const bool repeats = session_.rerunning();
  if (!repeats) SL_TRY(console_.before_tick());
  return hooks_ ? hooks_->tick(measured, repeats) : simulation.tick(measured);
}

void Run::warn(Error warning) {
  if (callbacks_.on_warning) callbacks_.on_warning(warning);
  warnings_.push_back(std::move(warning));
}

Status Run::start() {
  SL_TRY(outputs_.open_log(prepared_));
  for (const std::string& line : spec_.commands) SL_TRY(console_.schedule(line));
  if (!spec_.script_file.empty()) SL_TRY(console_.schedule_script(spec_.script_file));
  ready_ = true;
  if (callbacks_.on_ready) SL_TRY(callbacks_.on_ready({session_, console_, outputs_}));
  return outputs_.start(prepared_);
}

/// Whoever has taken hold of the session lets it go before it ends.
void Run::abandon() {
  Summary none;
  if (ready_ && callbacks_.on_end) callbacks_.on_end(none);
}

bool Run::keep_going(const Simulation& simulation) {
  const bool same_tick = std::exchange(seen_tick_, simulation.tick_index()) == simulation.tick_index();
  for (const std::string& answer : console_.take_answers())
    if (callbacks_.on_answer) callbacks_.on_answer(answer);
  if (!spec_.steered && same_tick && session_.report().state == Session::State::paused) {
    outputs_.record_error(Error{
        "the run was paused at " + number_text(simulation.now().s()) + " s, and nobody can let it go on",
        "add --port 8765, or leave what pauses it out of the script"});
    return false;
  }
  return outputs_.after_tick() && (!callbacks_.keep_going || callbacks_.keep_going(simulation));
}

void Run::execute() {
  Status status = hooks_ ? hooks_->start() : Status();
  if (status)
    status = session_.run(report_, [this](const Simulation& simulation) { return keep_going(simulation); });
  if (status) status = console_.finish();
  if (!status) {
    outputs_.rescue(status.error());
    outputs_.record_error(std::move(status));
  }
  if (hooks_) outputs_.record_error(hooks_->finish());
  // A difference, where the sum over the ticks would carry their rounding.
  if (session_.epoch() == 1) report_.sim_s = (session_.simulation().now() - begin_).s();
}

Summary Run::finish() {
  outputs_.finish();
  Summary summary = summarise(session_.simulation(), report_, outputs_.travel());
  outputs_.add_to(summary);
  for (const Error& warning : warnings_) summary.warnings.push_back(warning.text());
  for (const Error& error : outputs_.errors()) summary.errors.push_back(error.text());
  if (callbacks_.on_end) callbacks_.on_end(summary);
  const std::string text = as_json_text(summary);
  const auto write = [&](const std::string& file, const std::string& content) {
    if (const Status written = write_file(file, content); !written)
      summary.errors.push_back(written.error().text());
  };
  if (!spec_.summary_file.empty()) write(spec_.summary_file, text);
  if (const auto drawing = outputs_.drawing()) write(spec_.drawing_file, *drawing);
  return summary;
}

}  // namespace

Result<Summary> run(const RunSpec& spec, const RunCallbacks& callbacks) {
  Diagnostics diagnostics;
  std::span<const ControllerKind* const> controllers;
  if (callbacks.hooks) controllers = callbacks.hooks->controllers;
  auto prepared = prepare(spec, controllers, diagnostics);
  if (callbacks.on_warning)
    for (const Error& warning : diagnostics.warnings) callbacks.on_warning(warning);
  if (!prepared) return prepared.error();
  Run one(spec, callbacks, std::move(*prepared), std::move(diagnostics));
  if (const Status begun = one.start(); !begun) {
    one.abandon();
    return begun.error();
  }
  one.execute();
  return one.finish();
}

}  // namespace sandlot
