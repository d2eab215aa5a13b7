#include "app/game_process.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <optional>

#include "app/interrupt.h"
#include "base/program.h"
#include "base/text.h"
#include "programs/child.h"

namespace sandlot::app {
namespace {

using Clock = std::chrono::steady_clock;

double since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// What a game has printed up to now.
struct Output {
  std::string text;   ///< standard output
  std::string error;  ///< the last line that begins with "error: ", without that

  void take_from(programs::Child& child) {
    child.move();
    while (const auto line = child.take_line()) text += *line + "\n";
    constexpr std::string_view mark = "error: ";
    while (const auto note = child.take_note())
      if (note->starts_with(mark)) error = note->substr(mark.size());
  }
};

/// Waits for output, but not for long.
void wait_for(const programs::Child& child) {
  constexpr int longest_ms = 100;
  std::array<pollfd, 2> ends{{{child.output(), POLLIN, 0}, {child.error(), POLLIN, 0}}};
  poll(ends.data(), ends.size(), longest_ms);  // closed ones are negative, and left out
}

}  // namespace

std::vector<std::string> match_arguments(const MatchSpec& spec, const tournament::Match& game) {
  std::vector<std::string> out{"match", game.teams[0].folder, game.teams[1].folder, "--seed",
                               std::to_string(game.game.seed)};
  const auto add = [&](const char* flag, const std::string& value) {
    if (!value.empty()) out.insert(out.end(), {flag, value});
  };
  add("--level", spec.sense);
  add("--drive", spec.drive);
  add("--physics", spec.engine);
  add("--size", spec.size);
  if (spec.half_s) add("--duration", number_text(2 * *spec.half_s) + " s");
  for (const formats::Override& each : spec.run.spec.overrides) add("--set", each.path + "=" + each.value);
  add("--record", game.recording);
  // A replay makes all other messages again.
  if (!game.recording.empty()) add("--record-topics", "/rules/*");
  return out;
}

Result<tournament::GameResult> read_game(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  const Error wrong{"its result cannot be read"};
  if (!json.is_object()) return wrong;
  tournament::GameResult out;
  try {
    json.at("goals").get_to(out.goals);
    json.at("penalty_kicks").get_to(out.penalty_kicks);
    const std::string walk_over = json.at("walk_over");
    out.walk_over = !walk_over.empty();
    out.reason = out.walk_over ? walk_over : json.at("summary").at("stopped").get<std::string>();
    out.state_hash.value = std::stoull(json.at("state_hash").get<std::string>(), nullptr, 16);
    json.at("sim_seconds").get_to(out.sim_s);
    json.at("recording").get_to(out.recording);
  } catch (const std::exception&) { return wrong; }
  return out;
}

Result<tournament::GameResult> play_in_process(const std::vector<std::string>& arguments, double limit_s) {
  std::vector<std::string> command{program_files().front()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  command.emplace_back("--json");
  SL_ASSIGN(programs::Child child, programs::Child::start(command));
  const Clock::time_point begin = Clock::now();
  constexpr double patience_s = 2;  // from SIGTERM to SIGKILL
  std::optional<Clock::time_point> asked;
  Output output;
  std::optional<int> status;
  while (!(status = child.exit_status())) {
    wait_for(child);
    output.take_from(child);
    if (!asked && (interrupted() || since(begin) > limit_s)) {
      asked = Clock::now();
      kill(child.process(), SIGTERM);
    }
    if (asked && since(*asked) > patience_s) break;  // the child is killed as it is destroyed
  }
  // What it has printed since, a piece at a time.
  for (std::size_t before = std::string::npos; before != output.text.size();) {
    before = output.text.size();
    output.take_from(child);
  }
  if (asked) return Error{fmt::format("it took longer than {} s", number_text(limit_s))};
  if (WIFEXITED(*status) && WEXITSTATUS(*status) == 0) return read_game(output.text);
  const std::string end = "its process " + programs::text_of_exit(*status);
  return Error{output.error.empty() ? end : output.error};
}

}  // namespace sandlot::app
