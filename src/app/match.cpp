#include "app/match.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "app/demos.h"
#include "base/text.h"
#include "base/units.h"
#include "formats/scenario/scenario.h"
#include "programs/remote/remote.h"
#include "sim/watch/values.h"
#include "sim/world/simulation.h"

namespace sandlot::app {
namespace {

constexpr std::array<const char*, 2> sides{"cyan", "magenta"};
constexpr int walk_over_goals = 3;
constexpr double most_missed = 0.5;          // of the steps of a team's programs
constexpr std::uint64_t enough_steps = 500;  // of a team, after which the game does not wait for it any more
constexpr double most_deadline_s = 1, most_patience_s = 60;

/// YAML of a text, whatever is in it.
std::string quoted(const std::string& text) { return nlohmann::json(text).dump(); }

/// Whether `path` names a robot of a team or what is in one: "cyan3", "cyan3/player".
bool is_of(std::string_view path, std::string_view side) {
  if (!path.starts_with(side)) return false;
  std::string_view rest = path.substr(side.size());
  const std::size_t digits = std::min(rest.find_first_not_of("0123456789"), rest.size());
  rest.remove_prefix(digits);
  return (digits > 0 || rest.empty()) && (rest.empty() || rest.front() == '/');
}

/// A program of a team outside this process.
struct OutsideProgram {
  std::string path;
  std::shared_ptr<const programs::remote::Link> link;
};

/// Steps of the programs of a team, and those without an answer in time: also those of a program that has crashed.
struct Steps {
  std::size_t programs = 0, silent = 0;
  std::uint64_t steps = 0, misses = 0;

  bool too_late() const {
    return steps > 0 && static_cast<double>(misses) > most_missed * static_cast<double>(steps);
  }
};

Steps steps_of(const char* side, const std::vector<OutsideProgram>& outside) {
  Steps out;
  for (const OutsideProgram& each : outside) {
    if (!is_of(each.path, side)) continue;
    const std::uint64_t steps = each.link->counts().steps, misses = each.link->counts().misses;
    ++out.programs;
    out.steps += steps;
    out.misses += misses;
    out.silent += each.link->counts().answers == 0;
  }
  return out;
}

/// Why the team on a side has lost by rule; "": it has not.
std::string fault_of(const char* side, const std::vector<OutsideProgram>& outside, const Summary& summary) {
  for (const std::string& error : summary.errors)
    for (const char* const mark : {"'", "\"", " "})
      if (const auto at = error.find(mark + std::string(side)); at != std::string::npos) {
        const std::string_view from = std::string_view(error).substr(at + 1);
        if (is_of(from.substr(0, from.find_first_of("'\": ,;")), side))
          return "its software failed: " + error;
      }
  const Steps all = steps_of(side, outside);
  if (all.programs == 0) return "";
  if (all.silent == all.programs) return "none of its programs answered";
  if (all.too_late()) return fmt::format("its programs missed {} of {} steps", all.misses, all.steps);
  return "";
}

/// Goals of a side in the penalty kicks after a draw; 0 where there were none.
int penalty_kicks(const Simulation& world, std::size_t side) {
  auto value = ValueExpression::compile(world, fmt::format("rules/referee.teams[{}].shots_in", side));
  const auto found = value ? value->evaluate() : std::nullopt;
  return found ? static_cast<int>(found->value) : 0;
}

/// Refuses a program of a team that may hold up the game.
Status check_time(const model::ControllerDecl& program) {
  const auto check = [&](const char* key, double most_s) -> Status {
    const Node* const written = program.config.find(key);
    if (!written || !written->is_scalar()) return {};
    const auto time_s = parse_quantity(written->text(), "s");
    if (!time_s || *time_s <= most_s) return {};  // what cannot be read was refused before
    return written->error(fmt::format("a match waits at most {} s ({}), here {} s", number_text(most_s), key,
                                      number_text(*time_s)),
                          fmt::format("write {}: {} s", key, number_text(most_s)));
  };
  if (!program.config.is_map()) return {};
  SL_TRY(check("deadline", most_deadline_s));
  return check("patience", most_patience_s);
}

}  // namespace

Result<Match> play_match(const MatchSpec& spec, bool shows_progress) {
  Match out;
  RunOptions run = spec.run;
  SL_ASSIGN(run.spec.file, demo_file("match"));
  run.spec.may_be_endless = true;  // the referee ends the game
  std::vector<formats::Override> overrides;
  for (std::size_t i = 0; i < spec.teams.size(); ++i) {
    const std::string folder = std::filesystem::absolute(spec.teams[i]).lexically_normal().string();
    SL_ASSIGN(const formats::TeamSoftware software, formats::read_team_software(folder));
    out.result.folders[i] = spec.teams[i];
    out.result.names[i] = software.name;
    const std::string side = sides[spec.swap ? 1 - i : i];
    overrides.push_back({"vars." + side, quoted(folder)});
    overrides.push_back({"vars." + side + "_title", quoted(software.name)});
  }
  const auto choose = [&](const char* variable, const std::string& value) {
    if (!value.empty()) overrides.push_back({std::string("vars.") + variable, value});
  };
  choose("drive", spec.drive);
  choose("sense", spec.sense);
  choose("engine", spec.engine);
  choose("size", spec.size);
  if (spec.half_s) choose("half", number_text(*spec.half_s));
  run.spec.overrides.insert(run.spec.overrides.begin(), overrides.begin(), overrides.end());

  // All topics of ten robots are 1.6 MB/s, half of it /tf. A replay makes what is left out again.
  if (!run.spec.record_file.empty()) {
    if (run.spec.record_topics.empty())
      run.spec.record_topics = {"/rules/*", "/*/player/state", "/*/truth/pose"};
    if (run.spec.record_compression.empty()) run.spec.record_compression = "zstd";
  }

  std::vector<OutsideProgram> outside;
  const RunWatch watch{
      .on_world =
          [&](Simulation& world) {
            Status status;
            world.for_each_outside([&](const SimulationParts::ProgramEntry& entry, const Outside& program) {
              if (const auto* const remote = dynamic_cast<const programs::remote::Remote*>(&program))
                outside.push_back({entry.path, remote->link()});
              if (status) status = check_time(entry.decl);
            });
            return status;
          },
      .goes_on =
          [&] {
            return std::none_of(sides.begin(), sides.end(), [&](const char* side) {
              const Steps all = steps_of(side, outside);
              return all.steps >= enough_steps && all.too_late();
            });
          },
      .on_end =
          [&](const Simulation& world) {
            for (std::size_t i = 0; i < 2; ++i)
              out.result.penalty_kicks[i] = penalty_kicks(world, spec.swap ? 1 - i : i);
          }};
  SL_ASSIGN(out.summary, run_once(run, shows_progress, watch));
  const Summary& summary = out.summary;
  MatchResult& result = out.result;
  result.swapped = spec.swap;
  result.seed = summary.seed;
  result.sim_s = summary.sim_s;
  result.wall_s = summary.wall_s;
  result.state_hash = summary.state_hash;
  result.recording = run.spec.record_file;
  result.ended = summary.stopped.find("game") != std::string::npos;
  std::array<std::string, 2> faults;
  for (std::size_t i = 0; i < 2; ++i) {
    const char* const side = sides[spec.swap ? 1 - i : i];
    for (const auto& judged : summary.criteria)
      if (judged.name == side && judged.value.value) result.goals[i] = static_cast<int>(*judged.value.value);
    faults[i] = fault_of(side, outside, summary);
  }
  const auto lose = [&](std::size_t loser) {
    std::array<int, 2>& goals = result.goals;
    const std::size_t other = 1 - loser;
    result.walk_over = result.names[loser] + " loses by rule: " + faults[loser];
    if (goals[other] - goals[loser] >= walk_over_goals) return;
    goals[loser] = 0;
    goals[other] = walk_over_goals;
  };
  if (!faults[0].empty() && !faults[1].empty()) {
    result.goals = {};
    result.walk_over = fmt::format("neither has won: {}: {}; {}: {}", result.names[0], faults[0],
                                   result.names[1], faults[1]);
  } else if (!faults[0].empty()) {
    lose(0);
  } else if (!faults[1].empty()) {
    lose(1);
  }
  if (!result.walk_over.empty()) result.penalty_kicks = {};
  const auto& decides = result.goals[0] != result.goals[1] ? result.goals : result.penalty_kicks;
  if (decides[0] != decides[1]) result.winner = result.names[decides[0] > decides[1] ? 0 : 1];
  return out;
}

}  // namespace sandlot::app
