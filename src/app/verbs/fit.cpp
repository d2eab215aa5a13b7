#include "app/verbs/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "app/interrupt.h"
#include "app/verbs/topic_export.h"
#include "base/atomic_file.h"
#include "base/json_text.h"
#include "base/text.h"
#include "base/values.h"
#include "draw/plot.h"
#include "files/text.h"
#include "messages/dynamic.h"
#include "record/playback.h"
#include "record/recording.h"
#include "sim/watch/values.h"
#include "statistics/least_squares.h"

namespace sandlot::app {
namespace {

using Json = nlohmann::ordered_json;
using statistics::FitParameter;
using statistics::LeastSquares;

/// Correlation from which two parameters are called confounded.
constexpr double confounded = 0.95;

/// Number of a topic that is compared, with the recorded messages; or an expression, with the column of a table.
struct Compared {
  std::string topic, path;  ///< of a table: the expression and ""
  ValuePath steps;
  std::optional<double> given_scale;
  double scale = 1;
  bool adds_up = false;  ///< a pose of dead reckoning, whose covariance grows: its errors are not independent
  std::vector<std::pair<std::int64_t, double>> recorded;  ///< stamp [ns] and value, ascending
};

struct Problem {
  const FitOptions& options;
  bool of_table = false;  ///< the recording is a table: the scenario's own programs drive
  std::vector<std::string> addresses;
  std::vector<FitParameter> parameters;
  std::vector<formats::Override> fixed;
  std::vector<record::RecordedTick> ticks;
  std::optional<std::uint64_t> seed;  ///< of the recording
  std::vector<Compared> compared;
};

Error of_file(const std::string& file, std::string what, std::string fix = "") {
  Place place;
  place.file = std::make_shared<const std::string>(file);
  return {std::move(what), std::move(fix), place, ""};
}

/// Splits "ADDRESS=LOW:HIGH[:log]"; the start is that of --set, else the middle.
Status read_parameter(const std::string& text, Problem& problem) {
  const Error wrong{
      "--parameter '" + text.substr(0, 200) + "' is not ADDRESS=LOW:HIGH or ADDRESS=LOW:HIGH:log",
      "such as robots[0].devices.left_motor.velocity.p=0.1:10:log"};
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == std::string::npos) return wrong;
  const std::string address = text.substr(0, equals);
  std::string range = text.substr(equals + 1);
  FitParameter p;
  if (range.ends_with(":log")) {
    p.logarithmic = true;
    range.resize(range.size() - 4);
  }
  const std::size_t colon = range.find(':');
  if (colon == std::string::npos || !parse_number(range.substr(0, colon), p.low) ||
      !parse_number(range.substr(colon + 1), p.high))
    return wrong;
  if (!(p.low < p.high))
    return Error{"--parameter " + address + ": the lower limit must be below the upper one"};
  if (p.logarithmic && p.low <= 0) return Error{"--parameter " + address + ": log needs limits above 0"};
  if (std::find(problem.addresses.begin(), problem.addresses.end(), address) != problem.addresses.end())
    return Error{"--parameter " + address + " is given more than once"};
  p.start = p.logarithmic ? std::sqrt(p.low * p.high) : 0.5 * (p.low + p.high);
  for (const formats::Override& each : problem.options.overrides) {
    if (each.path != address) continue;
    if (!parse_number(each.value, p.start) || !(p.start >= p.low && p.start <= p.high))
      return Error{"--set " + address + "=" + each.value +
                   " is where the fit starts: it must lie in its limits, [" + number_text(p.low) + ", " +
                   number_text(p.high) + "]"};
  }
  problem.addresses.push_back(address);
  problem.parameters.push_back(p);
  return {};
}

Result<model::Setup> load_fit(const Problem& problem, const std::vector<double>& values,
                              Diagnostics& diagnostics) {
  std::vector<formats::Override> overrides = problem.fixed;
  for (std::size_t i = 0; i < values.size(); ++i)
    overrides.push_back({problem.addresses[i], fmt::format("{:.17g}", values[i])});
  LoadOptions how;
  how.overrides = overrides;
  how.paths = problem.options.paths;
  how.seed = problem.seed;
  how.errors = 0;
  return record::load_with_playbacks(problem.options.file, how, diagnostics);
}

/// Reads the commands, and refuses a recording of something else.
Status read_commands(Problem& problem) {
  const std::string& file = problem.options.recording;
  SL_ASSIGN(record::Recording recording, record::Recording::open(file));
  if (recording.begin().tick != 0)
    return of_file(file, "the recording begins at tick " + std::to_string(recording.begin().tick),
                   "a fit needs the run from its first tick");
  const model::Setup& theirs = recording.begin().setup;
  problem.seed = theirs.seed;
  std::vector<double> start;
  for (const FitParameter& p : problem.parameters) start.push_back(p.start);
  Diagnostics diagnostics;
  SL_ASSIGN(const model::Setup ours, load_fit(problem, start, diagnostics));
  print_warnings(diagnostics);
  const auto names = [](const model::Setup& setup) {
    std::string out;
    for (const model::Instance& each : setup.instances) out += each.name + "\n";
    return out;
  };
  if (theirs.name != ours.name || theirs.step != ours.step || names(theirs) != names(ours))
    return of_file(file,
                   "the recording is of another scenario: '" + theirs.name + "', not '" + ours.name +
                       "' with the same things and step",
                   "name the scenario that was recorded");
  bool commanded = false;
  while (true) {
    SL_ASSIGN(const record::RecordedTick* const tick, recording.next());
    if (!tick) break;
    if (problem.options.to_s && tick->now > Time::from_s(*problem.options.to_s)) break;
    problem.ticks.push_back({tick->tick, tick->now, tick->log, 0, {}, nullptr});
    for (const LogEntry& entry : tick->log) commanded = commanded || entry.kind == LogEntry::command;
  }
  if (!commanded)
    return of_file(file, "there is no command in the recording", "a fit needs a run that was driven");
  return {};
}

/// Standard deviation of the recorded values; nothing when they are all alike.
std::optional<double> deviation_of(const Compared& c) {
  double mean = 0, squares = 0;
  const auto n = static_cast<double>(c.recorded.size());
  for (const auto& [stamp, value] : c.recorded) mean += value / n;
  for (const auto& [stamp, value] : c.recorded) squares += (value - mean) * (value - mean) / n;
  return squares > 1e-18 ? std::optional(std::sqrt(squares)) : std::nullopt;
}

/// Takes ":SCALE" from the end of a text of --compare.
Status split_scale(std::string& text, std::optional<double>& scale) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return {};
  double number = 0;
  if (!parse_number(text.substr(colon + 1), number) || number <= 0)
    return Error{"--compare '" + text + "': the scale behind the colon must be a number above 0"};
  scale = number;
  text.resize(colon);
  return {};
}

/// Reads what is compared, its recorded values and their scales.
Status read_compared(Problem& problem) {
  const std::string& file = problem.options.recording;
  SL_ASSIGN(mcap::Reader reader, mcap::Reader::open(file));
  std::vector<std::string> topics;
  std::vector<std::string> wanted = problem.options.compare;
  for (const auto& [id, channel] : reader.summary().channels) {
    topics.push_back(channel.topic);
    const mcap::Schema* const schema = reader.schema_of(channel);
    if (!schema || !problem.options.compare.empty()) continue;
    if (schema->name == "sandlot_msgs/msg/MotorState") wanted.push_back(channel.topic + ".velocity");
    if (schema->name == "nav_msgs/msg/Odometry")
      for (const char* path : {"pose.pose.position.x", "pose.pose.position.y", "twist.twist.linear.x",
                               "twist.twist.linear.y", "twist.twist.angular.z"})
        wanted.push_back(channel.topic + "." + path);
  }
  if (wanted.empty()) return of_file(file, "no motor and no odometry was recorded", "name what to --compare");
  for (std::string& text : wanted) {
    Compared c;
    SL_TRY(split_scale(text, c.given_scale));
    auto split = wanted_topics(std::span(&text, 1), topics);
    if (!split) return of_file(file, split.error().what, split.error().fix);
    c.topic = split->front().topic;
    if (split->front().paths.size() != 1)
      return Error{"--compare '" + text + "' names a topic alone", "name a number of it: " + text + ".FIELD"};
    c.path = split->front().paths.front();
    SL_ASSIGN(c.steps, parse_value_path(c.path));
    const mcap::Channel* const channel = reader.find_channel(c.topic);
    const mcap::Schema* const schema = channel ? reader.schema_of(*channel) : nullptr;
    if (!schema) return of_file(file, "'" + c.topic + "' has no schema");
    const std::string_view words(reinterpret_cast<const char*>(schema->data.data()), schema->data.size());
    SL_ASSIGN(const DynamicSchema types, DynamicSchema::parse(schema->name, words));
    mcap::Cursor cursor = reader.messages({.topics = {c.topic}});
    std::vector<std::string> known;
    const bool is_pose = schema->name == "nav_msgs/msg/Odometry" && c.path.starts_with("pose.pose.");
    std::optional<double> first_variance;
    double variance = 0;  // of the place, in the latest message
    while (true) {
      SL_ASSIGN(const mcap::Message* const message, cursor.next());
      if (!message) break;
      const auto stamp = static_cast<std::int64_t>(message->log_time);
      if (stamp < Time::from_s(problem.options.from_s.value_or(0)).ns || stamp > problem.ticks.back().now.ns)
        continue;
      SL_TRY(visit_values(types.info(), message->data, [&](std::string_view path, const MessageValue& value) {
        if (known.size() < 1000) known.emplace_back(path);
        const auto* const x = std::get_if<double>(&value);
        if (x && path == c.path) c.recorded.emplace_back(stamp, *x);
        if (x && path == "pose.covariance[0]") variance = *x;
        if (x && path == "pose.covariance[7]") variance += *x;
      }));
      if (!first_variance) first_variance = variance;
    }
    constexpr double growth = 1.5;
    c.adds_up = is_pose && variance > growth * first_variance.value_or(variance);
    if (c.recorded.empty())
      return of_file(file, "'" + c.topic + "' has no number '" + c.path + "' in that time",
                     suggestion(c.path, known));
    const auto deviation = deviation_of(c);
    if (problem.options.compare.empty() && (!deviation || c.adds_up)) continue;
    c.scale = c.given_scale.value_or(deviation.value_or(1));
    problem.compared.push_back(std::move(c));
  }
  if (problem.compared.empty()) return of_file(file, "nothing that was recorded varies in that time");
  return {};
}

/// Reads the columns of a table, the run of a real robot, that are compared with values of the simulation.
Status read_table(Problem& problem) {
  const FitOptions& options = problem.options;
  constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
  SL_ASSIGN(const std::string text, read_text_file(options.recording, most_bytes));
  SL_ASSIGN(const draw::Table table, draw::read_csv(text, options.recording));
  const auto column = [&](const std::string& name) -> Result<const std::vector<double>*> {
    const auto found = std::find(table.names.begin(), table.names.end(), name);
    if (found == table.names.end())
      return of_file(options.recording, "the table has no column '" + name.substr(0, 60) + "'",
                     suggestion(name, table.names));
    return &table.columns[static_cast<std::size_t>(found - table.names.begin())];
  };
  SL_ASSIGN(const std::vector<double>* const times, column("time"));
  for (const double t : *times)
    if (!(t >= 0 && t < 1e6))
      return of_file(options.recording, "a time of the table is not a number of seconds from 0 on",
                     "the first tick of the scenario is at 0 s");
  if (options.compare.empty())
    return Error{"with a table --compare says which value each column is",
                 "--compare cart.joints.left_wheel_joint.velocity=speed"};
  for (const std::string& each : options.compare) {
    const std::size_t equals = each.rfind('=');
    if (equals == std::string::npos || equals == 0)
      return Error{"--compare '" + each + "' is not VALUE=COLUMN or VALUE=COLUMN:SCALE"};
    Compared c;
    c.topic = each.substr(0, equals);
    std::string name = each.substr(equals + 1);
    if (std::find(table.names.begin(), table.names.end(), name) == table.names.end())
      SL_TRY(split_scale(name, c.given_scale));
    SL_ASSIGN(const std::vector<double>* const values, column(name));
    for (std::size_t row = 0; row < values->size(); ++row) {
      const double t = (*times)[row], value = (*values)[row];
      if (std::isfinite(value) && t >= options.from_s.value_or(0) && t <= options.to_s.value_or(1e6))
        c.recorded.emplace_back(Time::from_s(t).ns, value);
    }
    if (c.recorded.empty())
      return of_file(options.recording, "column '" + name + "' has no number in that time");
    std::stable_sort(c.recorded.begin(), c.recorded.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    c.scale = c.given_scale.value_or(deviation_of(c).value_or(1));
    problem.compared.push_back(std::move(c));
  }
  return {};
}

/// Residuals of a run that the scenario's own programs drive. Between two ticks values are taken to be linear.
Result<std::vector<double>> trial_beside_table(const Problem& problem,
                                               const std::vector<double>& parameters) {
  Diagnostics diagnostics;
  SL_ASSIGN(model::Setup setup, load_fit(problem, parameters, diagnostics));
  setup.stop.reset();
  SL_ASSIGN(const auto simulation,
            Simulation::create(std::move(setup), {.paths = problem.options.paths}, diagnostics));
  struct Follower {
    ValueExpression value;
    const Compared* compared;
    std::size_t next = 0;
    std::optional<double> before = std::nullopt;
    std::vector<double> residuals = {};
  };
  std::vector<Follower> followers;
  std::int64_t end_ns = 0;
  for (const Compared& c : problem.compared) {
    SL_ASSIGN(ValueExpression value, ValueExpression::compile(*simulation, c.topic));
    followers.push_back({std::move(value), &c});
    end_ns = std::max(end_ns, c.recorded.back().first);
  }
  Time before;
  while (true) {
    const Time now = simulation->now();
    for (Follower& each : followers) {
      const auto evaluated = each.value.evaluate();
      const bool there = evaluated && std::isfinite(evaluated->value);
      const auto& recorded = each.compared->recorded;
      for (; each.next < recorded.size() && recorded[each.next].first <= now.ns; ++each.next) {
        const auto& [stamp, wanted] = recorded[each.next];
        if (!there || (stamp < now.ns && !each.before))
          return Error{
              "'" + each.compared->topic + "' has no value at " + number_text(Time{stamp}.s()) + " s",
              "compare from a later time: --from"};
        const double part = stamp == now.ns ? 1
                                            : static_cast<double>(stamp - before.ns) /
                                                  static_cast<double>(now.ns - before.ns);
        const double from = part == 1 ? 0 : *each.before;
        each.residuals.push_back((from + part * (evaluated->value - from) - wanted) / each.compared->scale);
      }
      each.before = there ? std::optional(evaluated->value) : std::nullopt;
    }
    if (now.ns >= end_ns) break;
    before = now;
    SL_TRY(simulation->tick());
  }
  std::vector<double> residuals;
  for (const Follower& each : followers)
    residuals.insert(residuals.end(), each.residuals.begin(), each.residuals.end());
  return residuals;
}

/// Residuals of one run, or why it could not be carried out.
Result<std::vector<double>> trial(const Problem& problem, const std::vector<double>& values) {
  if (problem.of_table) return trial_beside_table(problem, values);
  Diagnostics diagnostics;
  SL_ASSIGN(model::Setup setup, load_fit(problem, values, diagnostics));
  setup.stop.reset();
  SL_ASSIGN(const auto fresh,
            Simulation::create(std::move(setup), {.run_programs = false, .paths = problem.options.paths},
                               diagnostics));
  SL_ASSIGN(record::Replay replay,
            record::Replay::begin(
                fresh->snapshot(),
                {.programs = record::Programs::logged, .compare = false, .paths = problem.options.paths},
                diagnostics));
  std::vector<const TopicBase*> topics;
  for (const Compared& c : problem.compared) {
    topics.push_back(replay.simulation().find_topic(c.topic));
    if (!topics.back()) return Error{"the scenario has no topic '" + c.topic + "'"};
  }
  std::vector<std::map<std::int64_t, double>> shown(topics.size());
  for (const record::RecordedTick& tick : problem.ticks) {
    SL_TRY(replay.tick(tick));
    for (std::size_t i = 0; i < topics.size(); ++i) {
      if (topics[i]->count == 0) continue;
      const ValueFound found = topics[i]->value(problem.compared[i].steps);
      if (found.is == ValueFound::Is::value) shown[i][topics[i]->stamp.ns] = found.value;
    }
  }
  std::vector<double> residuals;
  for (std::size_t i = 0; i < topics.size(); ++i)
    for (const auto& [stamp, value] : problem.compared[i].recorded) {
      const auto at = shown[i].find(stamp);
      if (at == shown[i].end())
        return Error{
            "'" + problem.compared[i].topic + "' has no message at " + number_text(Time{stamp}.s()) + " s",
            "the rates of the scenario must be those of the recording"};
      residuals.push_back((at->second - value) / problem.compared[i].scale);
    }
  return residuals;
}

/// Trials on all processors, in the order of the points. An interrupt leaves the rest out.
std::vector<std::optional<std::vector<double>>> trials(const Problem& problem,
                                                       const std::vector<std::vector<double>>& points) {
  std::vector<std::optional<std::vector<double>>> out(points.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < points.size() && !interrupted(); i = next++)
      if (auto residuals = trial(problem, points[i])) out[i] = std::move(*residuals);
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < std::min<std::size_t>(points.size(), std::thread::hardware_concurrency()); ++i)
    threads.emplace_back(work);
  work();
  for (std::thread& each : threads) each.join();
  return out;
}

/// Root mean square of the differences of one field, in its unit; null: that run could not be carried out.
Json rms(const Problem& problem, const std::vector<double>& residuals, std::size_t field) {
  if (residuals.empty()) return nullptr;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < field; ++i) begin += problem.compared[i].recorded.size();
  const std::size_t n = problem.compared[field].recorded.size();
  double squares = 0;
  for (std::size_t i = begin; i < begin + n; ++i) squares += residuals[i] * residuals[i];
  return problem.compared[field].scale * std::sqrt(squares / static_cast<double>(n));
}

Json number_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json fit_json(const Problem& problem, const LeastSquares& fitted) {
  Json json{{"runs", fitted.evaluations},
            {"failed", fitted.failed},
            {"converged", fitted.converged},
            {"condition", number_or_null(fitted.condition)}};
  Json parameters = Json::array(), compared = Json::array(), notes = Json::array();
  for (std::size_t i = 0; i < fitted.parameters.size(); ++i) {
    const auto& p = fitted.parameters[i];
    const std::string& address = problem.addresses[i];
    parameters.push_back({{"parameter", address},
                          {"start", problem.parameters[i].start},
                          {"value", p.value},
                          {"low", number_or_null(p.low)},
                          {"high", number_or_null(p.high)}});
    if (p.at_low) notes.push_back(address + " is at its lower limit and was not counted as free");
    if (p.at_high) notes.push_back(address + " is at its upper limit and was not counted as free");
    if (p.without_effect) notes.push_back(address + " changes nothing that is compared");
    if (p.undetermined) notes.push_back(address + " is not determined by what is compared");
    for (std::size_t j = i + 1; j < fitted.parameters.size(); ++j)
      if (std::abs(fitted.correlation[i][j]) > confounded)
        notes.push_back(fmt::format("{} and {} are confounded: correlation {:.4f}", address,
                                    problem.addresses[j], fitted.correlation[i][j]));
  }
  for (std::size_t i = 0; i < problem.compared.size(); ++i)
    compared.push_back(
        {{"field", problem.of_table ? problem.compared[i].topic
                                    : problem.compared[i].topic + "." + problem.compared[i].path},
         {"scale", problem.compared[i].scale},
         {"values", problem.compared[i].recorded.size()},
         {"rms_before", rms(problem, fitted.first, i)},
         {"rms_after", rms(problem, fitted.last, i)}});
  for (const Compared& each : problem.compared)
    if (each.adds_up)
      notes.push_back(each.topic + "." + each.path +
                      " is dead reckoning, whose errors add up: values and intervals are not to be trusted; "
                      "compare speeds of it: twist.twist");
  if (!fitted.converged) notes.push_back("the search was ended before it converged; --runs allows more");
  json["parameters"] = parameters;
  json["correlation"] = fitted.correlation;
  json["compared"] = compared;
  json["notes"] = notes;
  return json;
}

std::string number_cell(const Json& x) { return x.is_null() ? "-" : fmt::format("{:.5g}", x.get<double>()); }

void print(const Json& json) {
  std::size_t wide = 9;
  for (const Json& p : json["parameters"])
    wide = std::max(wide, p["parameter"].get_ref<const std::string&>().size());
  for (const Json& c : json["compared"])
    wide = std::max(wide, c["field"].get_ref<const std::string&>().size());
  fmt::print("{:<{}}  {:>10}  {:>10}  95 % interval\n", "parameter", wide, "start", "value");
  for (const Json& p : json["parameters"])
    fmt::print("{:<{}}  {:>10}  {:>10}  {} to {}\n", p["parameter"].get<std::string>(), wide,
               number_cell(p["start"]), number_cell(p["value"]), number_cell(p["low"]),
               number_cell(p["high"]));
  fmt::print("\n{:<{}}  {:>10}  {:>10}  values\n", "compared", wide, "rms before", "after");
  for (const Json& c : json["compared"])
    fmt::print("{:<{}}  {:>10}  {:>10}  {}\n", c["field"].get<std::string>(), wide,
               number_cell(c["rms_before"]), number_cell(c["rms_after"]), c["values"].get<std::size_t>());
  fmt::print("\n{} runs, {} failed; condition {}\n", json["runs"].get<int>(), json["failed"].get<int>(),
             number_cell(json["condition"]));
  for (const Json& note : json["notes"]) fmt::print("note: {}\n", note.get<std::string>());
}

Result<LeastSquares> search(Problem& problem) {
  if (problem.options.parameters.empty()) return Error{"a fit needs at least one --parameter"};
  for (const std::string& text : problem.options.parameters) SL_TRY(read_parameter(text, problem));
  for (const formats::Override& each : problem.options.overrides)
    if (std::find(problem.addresses.begin(), problem.addresses.end(), each.path) == problem.addresses.end())
      problem.fixed.push_back(each);
  problem.of_table = std::filesystem::path(problem.options.recording).extension() == ".csv";
  if (problem.of_table) {
    SL_TRY(read_table(problem));
  } else {
    SL_TRY(read_commands(problem));
    SL_TRY(read_compared(problem));
  }
  catch_interrupts();
  const auto evaluate = [&](const std::vector<std::vector<double>>& points) {
    return trials(problem, points);
  };
  auto fitted = statistics::least_squares(
      problem.parameters, {.most_evaluations = problem.options.runs, .screening = problem.options.screening},
      evaluate);
  if (interrupted()) return Error{"interrupted"};
  if (fitted) return fitted;
  // The reason of a run tells more than that none could be carried out.
  std::vector<double> start;
  for (const FitParameter& p : problem.parameters) start.push_back(p.start);
  if (const auto tried = trial(problem, start); !tried) return tried.error();
  return fitted.error();
}

}  // namespace

int fit(const FitOptions& options) {
  Problem problem{.options = options};
  const auto fitted = search(problem);
  if (!fitted) return complain(fitted.error());
  const Json json = fit_json(problem, *fitted);
  if (options.json) fmt::print("{}\n", json_text(json));
  else print(json);
  if (!options.out.empty()) {
    std::string words;
    for (std::size_t i = 0; i < problem.addresses.size(); ++i)
      words += fmt::format("--set {}={:.9g}\n", problem.addresses[i], fitted->parameters[i].value);
    if (Status status = write_file(options.out, words); !status) return complain(status.error());
  }
  return finish_output(fitted->converged ? exit_ok : exit_failed);
}

}  // namespace sandlot::app
