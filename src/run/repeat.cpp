#include "run/repeat.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <fstream>
#include <iterator>
#include <mutex>
#include <thread>

#include "base/hash.h"
#include "base/program.h"
#include "base/text.h"
#include "record/agent_log.h"
#include "run/fields_json.h"
#include "run/prepare.h"
#include "sim/watch/monitor.h"
#include "statistics/intervals.h"
#include "statistics/store.h"

namespace sandlot {
namespace {

Status check(const RepeatSpec& spec) {
  const RunSpec& run = spec.run;
  if (spec.count < 1 || spec.count > 1'000'000)
    return Error{"--repeat: must be in [1, 1000000], is " + std::to_string(spec.count)};
  if (!run.from_file.empty())
    return Error{"--from and --repeat: a run that has begun knows its seed", "repeat the scenario"};
  const auto refuse = [](const char* option) {
    return Error{std::string(option) + " and --repeat: one file cannot hold several runs",
                 "leave it out, or run one seed with --seed"};
  };
  if (!run.summary_file.empty()) return refuse("--summary");
  if (!run.drawing_file.empty()) return refuse("--svg");
  if (!run.log_file.empty()) return refuse("--log");
  if (!run.agent_logs.empty()) return refuse("--agent-log");
  if (!run.step_times_file.empty()) return refuse("--step-times");
  if (!run.record_file.empty()) return refuse("--record");
  if (!run.snapshots.file.empty()) return refuse("--snapshot");
  if (!run.film.file.empty()) return refuse("--video");
  return {};
}

/// What the scenario says of one run alone: its files would be overwritten by each.
Status check_outputs(const PreparedRun& prepared) {
  if (prepared.log)
    return Error{
        "--repeat: the scenario logs into '" + prepared.log->file + "', which cannot hold several runs",
        "leave `log` out of it", prepared.log->place};
  if (prepared.recording)
    return Error{"--repeat: the scenario is recorded into '" + prepared.recording->recording.file +
                     "', which cannot hold several runs",
                 "leave `record` out of it"};
  if (const auto logs = declared_agent_logs(*prepared.simulation); !logs.empty())
    return Error{fmt::format("--repeat: '{}' logs into '{}', which cannot hold several runs",
                             logs.front().agent, logs.front().file),
                 "leave `log` out of its keys"};
  const model::Setup& setup = prepared.simulation->setup();
  const auto& events = prepared.simulation->monitor().events();
  const bool may_stop = std::any_of(events.begin(), events.end(),
                                    [](const auto& each) { return each.decl.stop; });
  if (!setup.stop && !may_stop)
    return Error{"--repeat: the runs have no end", "give --duration, or time.stop in the scenario"};
  return {};
}

RepeatedRun one_run(RunSpec spec, std::uint64_t seed, const std::function<bool()>& keep_going) {
  spec.seed = seed;
  spec.threads = 1;
  RepeatedRun out;
  out.seed = seed;
  const auto summary = run(spec, {.keep_going = [&](const Simulation&) { return keep_going(); }});
  if (!summary) {
    out.errors.push_back(summary.error().text());
    return out;
  }
  out.end_s = summary->end_s;
  out.stopped = summary->stopped;
  out.state_hash = summary->state_hash;
  out.criterion = summary->criterion;
  out.success = summary->success;
  out.criteria = summary->criteria;
  out.errors = summary->errors;
  return out;
}

/// What runs with other seeds share: the world as it begins with seed 0 (plugins by the hash of their files), what steers and
/// ends the runs, and the code of this program. Programs in processes of their own count by their command line alone.
Result<std::string> fingerprint(const RunSpec& spec) {
  RunSpec one = spec;
  one.seed = 0;
  one.may_be_endless = true;
  Diagnostics diagnostics;
  SL_ASSIGN(const PreparedRun prepared, prepare(one, {}, diagnostics));
  const model::Setup& setup = prepared.simulation->setup();
  std::uint64_t hash = hash64(std::span<const std::byte>(prepared.simulation->snapshot()));
  const auto add = [&](std::string_view text) { hash = hash_combine(hash, hash64(text)); };
  const auto add_file = [&](const std::string& file) -> Status {
    std::ifstream in(file, std::ios::binary);
    add(std::string(std::istreambuf_iterator<char>(in), {}));
    return in ? Status() : Error{"'" + file + "' cannot be read"};
  };
  add(Simulation::profile());
  add(setup.stop ? std::to_string(setup.stop->ns) : "endless");
  add(spec.stop_when);
  for (const std::string& line : spec.commands) add(line);
  if (!spec.script_file.empty()) SL_TRY(add_file(spec.script_file));
  for (const std::string& file : program_files()) SL_TRY(add_file(file));
  return fmt::format("{:016x}", hash);
}

/// Settings of the command line, for people who read the store.
std::string settings_of(const RunSpec& spec) {
  std::string out;
  const auto add = [&](const std::string& text) { out += (out.empty() ? "" : "; ") + text; };
  for (const formats::Override& each : spec.overrides) add(each.path + "=" + each.value);
  if (spec.duration_s) add("duration " + number_text(*spec.duration_s) + " s");
  if (!spec.stop_when.empty()) add("stop when " + spec.stop_when);
  if (spec.errors) add("errors " + number_text(*spec.errors));
  for (const std::string& line : spec.commands) add(line);
  if (!spec.script_file.empty()) add("script " + spec.script_file);
  return out;
}

statistics::StoredRun as_stored(const RepeatedRun& run) {
  statistics::StoredRun out{
      run.seed, run.end_s, run.stopped, fmt::format("{:016x}", run.state_hash.value), {}};
  out.criteria.push_back({"", run.criterion, run.success});
  for (const auto& [team, judged] : run.criteria)
    out.criteria.push_back({team, judged.value, judged.success});
  return out;
}
RepeatedRun from_stored(const statistics::StoredRun& stored) {
  RepeatedRun out;
  out.seed = stored.seed, out.end_s = stored.end_s, out.stopped = stored.stopped, out.stored = true;
  std::from_chars(stored.state_hash.data(), stored.state_hash.data() + stored.state_hash.size(),
                  out.state_hash.value, 16);
  for (const statistics::StoredCriterion& each : stored.criteria) {
    if (each.team.empty()) out.criterion = each.value, out.success = each.success;
    else out.criteria.push_back({each.team, CriterionSummary{each.value, each.success}});
  }
  return out;
}

/// The series' part of the store of results.
struct Store {
  statistics::ResultStore results;
  std::int64_t experiment = 0;
  std::mutex mutex = {};
  std::optional<Error> failed = {};

  void add(const RepeatedRun& run) {
    const std::lock_guard lock(mutex);
    if (failed || !run.errors.empty()) return;
    if (Status added = results.add(experiment, as_stored(run)); !added) failed = std::move(added.error());
  }
};

Result<std::unique_ptr<Store>> open_store(const RepeatSpec& spec, const RepeatSummary& summary) {
  SL_ASSIGN(std::string print, fingerprint(spec.run));
  SL_ASSIGN(auto results, statistics::ResultStore::open(spec.store_file));
  SL_ASSIGN(const std::int64_t experiment,
            results.experiment({std::move(print), summary.name, summary.physics, settings_of(spec.run)}));
  return std::unique_ptr<Store>(new Store{std::move(results), experiment});
}

/// Figures of runs, one after the other.
class Figures {
 public:
  explicit Figures(double confidence) : confidence_(confidence) {}
  void add(const CriterionSummary& run) {
    if (run.value) sample_.add(*run.value);
    if (run.success) ++asked_, successes_ += *run.success;
  }
  JudgedRuns judged() const {
    JudgedRuns out;
    out.criterion = estimate();
    if (asked_ == 0) return out;
    out.success = with_interval({successes_, asked_, {}, {}, {}}, confidence_);
    return out;
  }
  Estimate estimate() const { return estimate_of(sample_, confidence_); }

 private:
  double confidence_;
  statistics::Sample sample_;
  std::uint64_t successes_ = 0, asked_ = 0;
};

void add_figures(RepeatSummary& out) {
  Figures all(out.confidence), ends(out.confidence);
  std::vector<Named<Figures>> teams;
  bool judged = false;
  for (const RepeatedRun& run : out.runs) {
    if (!run.errors.empty()) {
      ++out.failed;
      continue;
    }
    ends.add({run.end_s, {}});
    all.add({run.criterion, run.success});
    judged = judged || run.criterion || run.success;
    for (const Named<CriterionSummary>& of : run.criteria) {
      auto known = std::find_if(teams.begin(), teams.end(),
                                [&](const auto& each) { return each.name == of.name; });
      if (known == teams.end()) known = teams.insert(teams.end(), {of.name, Figures(out.confidence)});
      known->value.add(of.value);
    }
  }
  out.end_s = ends.estimate();
  if (judged) out.all = all.judged();
  for (const auto& [team, figures] : teams) out.teams.push_back({team, figures.judged()});
}

}  // namespace

Estimate estimate_of(const statistics::Sample& sample, double confidence) {
  Estimate out;
  out.count = sample.count();
  if (out.count == 0) return out;
  out.mean = sample.mean(), out.min = sample.min(), out.max = sample.max();
  if (out.count == 1) return out;
  const auto interval = statistics::mean_interval(sample, confidence);
  out.deviation = sample.deviation(), out.low = interval.low, out.high = interval.high;
  return out;
}

SuccessRate with_interval(SuccessRate counts, double confidence) {
  const auto interval = statistics::wilson_interval(counts.successes, counts.count, confidence);
  if (counts.count > 0)
    counts.rate = static_cast<double>(counts.successes) / static_cast<double>(counts.count);
  counts.low = interval.low, counts.high = interval.high;
  return counts;
}

Result<RepeatSummary> repeat(const RepeatSpec& spec, const std::function<bool(int ended)>& keep_going) {
  SL_TRY(check(spec));
  RepeatSummary out;
  std::uint64_t first_seed = 0;
  {
    Diagnostics diagnostics;
    RunSpec one = spec.run;
    one.may_be_endless = true;
    SL_ASSIGN(const PreparedRun prepared, prepare(one, {}, diagnostics));
    SL_TRY(check_outputs(prepared));
    const model::Setup& setup = prepared.simulation->setup();
    out.name = setup.name, out.physics = setup.engine;
    first_seed = setup.seed;
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto count = static_cast<std::size_t>(spec.count);
  std::vector<std::optional<RepeatedRun>> runs(count);
  std::atomic<std::size_t> next = 0;
  std::atomic<int> ended = 0;
  std::unique_ptr<Store> store;
  if (!spec.store_file.empty()) {
    SL_ASSIGN(store, open_store(spec, out));
    SL_ASSIGN(const auto known, store->results.runs(store->experiment, first_seed, count));
    for (const statistics::StoredRun& each : known) runs[each.seed - first_seed] = from_stored(each);
    ended = static_cast<int>(known.size());
  }
  std::atomic<bool> stopped = false;
  const auto may_go_on = [&] {
    if (!stopped && keep_going && !keep_going(ended)) stopped = true;
    return !stopped;
  };
  const auto work = [&] {
    for (std::size_t i = next++; i < count && may_go_on(); i = next++) {
      if (runs[i]) continue;
      RepeatedRun run = one_run(spec.run, first_seed + i, may_go_on);
      if (stopped) return;  // it may have been cut short
      if (store) store->add(run);
      runs[i] = std::move(run);
      ++ended;
    }
  };
  const std::size_t processors = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t workers = std::min(
      count, spec.at_a_time > 0 ? static_cast<std::size_t>(spec.at_a_time) : processors);
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < workers; ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  for (std::optional<RepeatedRun>& run : runs)
    if (run) out.runs.push_back(std::move(*run));
  out.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  add_figures(out);
  if (store && store->failed) out.store_error = store->failed->text();
  return out;
}

nlohmann::ordered_json as_json(const RepeatSummary& summary) { return fields_json(summary); }

std::string as_text(const RepeatSummary& s) {
  const std::string percent = fmt::format("{:.4g} %", 100 * s.confidence);
  const auto estimate = [&](const Estimate& e) -> std::string {
    if (!e.mean) return "no run has a value";
    if (e.count > 1 && *e.min == *e.max) return fmt::format("{:.4g} in every run", *e.mean);
    std::string text = fmt::format("mean {:.4g}", *e.mean);
    if (e.low)
      text += fmt::format(" ({} between {:.4g} and {:.4g}), deviation {:.3g}", percent, *e.low, *e.high,
                          *e.deviation);
    return text + fmt::format(", from {:.4g} to {:.4g}", *e.min, *e.max);
  };
  const auto judged = [&](const std::string& name, const JudgedRuns& runs) {
    std::string text;
    if (runs.criterion.mean) text += name + estimate(runs.criterion) + "\n";
    if (runs.criterion.mean && runs.criterion.count < s.runs.size() - s.failed)
      text += fmt::format("           of {} runs: the others have no value\n", runs.criterion.count);
    if (!runs.success) return text.empty() ? name + "no run has a value\n" : text;
    return text + fmt::format("success    {}{} of {}: {:.3g} % ({} between {:.3g} and {:.3g} %)\n",
                              name == "criterion  " ? "" : name.substr(11), runs.success->successes,
                              runs.success->count, 100 * *runs.success->rate, percent,
                              100 * *runs.success->low, 100 * *runs.success->high);
  };
  std::string out;
  const std::uint64_t first = s.runs.empty() ? 0 : s.runs.front().seed,
                      last = s.runs.empty() ? 0 : s.runs.back().seed;
  out += fmt::format("scenario   {} ({})\n", s.name, s.physics);
  out += fmt::format("runs       {}, seeds {} to {}, in {:.3g} s\n", s.runs.size(), first, last, s.wall_s);
  if (const auto stored = std::count_if(s.runs.begin(), s.runs.end(),
                                        [](const auto& run) { return run.stored; }))
    out += fmt::format("stored     {} of them were not run again\n", stored);
  if (s.all) out += judged("criterion  ", *s.all);
  for (const auto& [team, runs] : s.teams) out += judged("criterion  " + team + ": ", runs);
  if (!s.all && s.teams.empty()) out += "criterion  the scenario has none: docs/values.md\n";
  if (s.end_s.mean) out += "end [s]    " + estimate(s.end_s) + "\n";
  constexpr std::uint64_t most_listed = 5;
  std::uint64_t listed = 0;
  for (const RepeatedRun& run : s.runs)
    if (!run.errors.empty() && listed++ < most_listed)
      out += fmt::format("failed     seed {}: {}\n", run.seed, run.errors.front());
  if (s.failed > most_listed) out += fmt::format("           ... {} failed in all\n", s.failed);
  if (!s.store_error.empty()) out += "not stored " + s.store_error + "\n";
  return out;
}

}  // namespace sandlot
