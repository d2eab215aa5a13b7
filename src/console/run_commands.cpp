/// Commands about the run as a whole: its clock, its state in files, its description.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/atomic_file.h"
#include "base/text.h"
#include "base/units.h"
#include "console/command.h"
#include "console/line_parsing.h"
#include "files/text.h"
#include "sim/world/snapshot.h"

namespace sandlot::console {
namespace {

namespace fs = std::filesystem;

std::string at(const Simulation& simulation) {
  return "at " + readable(simulation.now().s()) + " s, tick " + std::to_string(simulation.tick_index());
}

std::string speed_text(std::optional<double> speed) {
  return speed ? "real time x " + readable(*speed) : std::string("as fast as possible");
}

Status set_speed(CommandCall& call, std::string text) {
  if (text == "max" || text == "0") return call.session.set_speed(std::nullopt);
  if (!text.empty() && (text.back() == 'x' || text.back() == 'X')) text.pop_back();
  double factor = 0;
  if (!parse_number(text, factor))
    return Error{"'" + text.substr(0, 40) + "' is not a speed",
                 "1: real time; 0.001 to 1000; max: as fast as possible"};
  return call.session.set_speed(factor);
}

/// A regular file's bytes, if they can be a snapshot.
Result<std::vector<std::byte>> read_snapshot(const std::string& file) {
  constexpr std::uintmax_t most_bytes = std::uintmax_t{4} << 30;
  std::error_code failed;
  if (!fs::is_regular_file(file, failed)) return Error{"there is no file '" + file + "'", nearest_file(file)};
  const std::uintmax_t size = fs::file_size(file, failed);
  if (failed || size > most_bytes) return Error{"'" + file + "' has more than 4 GiB"};
  std::vector<std::byte> bytes(static_cast<std::size_t>(size));
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) return Error{"cannot read '" + file + "'"};
  if (!is_snapshot(bytes)) return Error{"'" + file + "' is not a snapshot", "load what `store` wrote"};
  return bytes;
}

bool is_snapshot_file(const std::string& file) {
  std::array<char, snapshot_magic.size()> head{};
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), head.size());
  return in && head == snapshot_magic;
}

}  // namespace

CommandResult cmd_pause(CommandCall& call) {
  call.session.pause();
  return std::optional("paused " + at(call.simulation()));
}

CommandResult cmd_run(CommandCall& call) {
  if (!call.words.empty()) SL_TRY(set_speed(call, call.words.front()));
  const Session::Report report = call.session.report();
  if (report.state == Session::State::ended || report.state == Session::State::failed)
    return Error{"the run has " + std::string(Session::name_of(report.state)) + ": " + report.reason,
                 report.may_not_rewind.empty() ? "reset it, or jump back" : ""};
  call.session.play();
  return std::optional(call.words.empty() ? "runs " + speed_text(report.speed)
                                          : "runs at speed " + call.words.front());
}

CommandResult cmd_step(CommandCall& call) {
  double count = 1;
  if (!call.words.empty() && (!parse_number(call.words.front(), count) || !(count >= 1 && count <= 1e9) ||
                              count != std::floor(count)))
    return Error{"'" + call.words.front().substr(0, 40) + "' is not a number of ticks", "1 to 1e9"};
  call.session.step(static_cast<std::uint64_t>(count));
  return std::optional(number_text(count) + (count == 1 ? " tick" : " ticks") + " from " +
                       std::to_string(call.simulation().tick_index()));
}

CommandResult cmd_speed(CommandCall& call) {
  if (call.words.empty()) return std::optional(speed_text(call.session.report().speed));
  SL_TRY(set_speed(call, call.words.front()));
  const bool max = call.words.front() == "max" || call.words.front() == "0";
  return std::optional(max ? speed_text(std::nullopt) : "real time x " + call.words.front());
}

CommandResult cmd_reset(CommandCall& call) {
  SL_TRY(call.session.reset());
  return std::optional("back to " + readable(call.session.report().begin.s()) + " s");
}

CommandResult cmd_jump(CommandCall& call) {
  std::string text;
  for (const std::string& word : call.words) text += (text.empty() ? "" : " ") + word;
  const bool relative = !text.empty() && (text.front() == '+' || text.front() == '-');
  auto seconds = parse_quantity(text, "s");
  if (!seconds) return Error{"TIME: " + seconds.error().what, seconds.error().fix};
  if (relative) *seconds += call.simulation().now().s();
  if (!(*seconds >= 0 && *seconds <= 9e9))
    return Error{"TIME: must be in [0, 9e9] s, is " + number_text(*seconds)};
  const Time to = Time::from_s(*seconds);
  SL_TRY(call.session.jump(to));
  return std::optional("goes to " + readable(to.s()) + " s");
}

CommandResult cmd_store(CommandCall& call) {
  if (call.words.size() == 2) return store_agent(call);
  SL_ASSIGN(const std::string file, file_within(call.options, call.words.front()));
  std::error_code failed;
  // Nobody shall lose a scenario to a slip.
  if (fs::exists(file, failed) && !is_snapshot_file(file))
    return Error{"'" + file + "' is there and is not a snapshot", "give another name"};
  const std::vector<std::byte> bytes = call.simulation().snapshot();
  SL_TRY(write_file(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  return std::optional("stored in " + file + " " + at(call.simulation()));
}

CommandResult cmd_load(CommandCall& call) {
  if (call.words.size() == 2) return load_agent(call);
  SL_ASSIGN(const std::string file, file_within(call.options, call.words.front()));
  SL_ASSIGN(std::vector<std::byte> bytes, read_snapshot(file));
  call.session.load(std::move(bytes),
                    [reply = call.reply, &session = call.session, file](const Status& status) {
                      if (!reply) return;
                      if (status) reply({true, "goes on from " + file + " " + at(session.simulation())});
                      else reply({false, status.error().text()});
                    });
  return std::optional<std::string>();
}

CommandResult cmd_record(CommandCall& call) {
  if (!call.options.record) return Error{"nothing can be recorded here"};
  if (call.words.front() == "off") {
    SL_ASSIGN(std::string text, call.options.record(""));
    return std::optional(std::move(text));
  }
  SL_ASSIGN(const std::string file, file_within(call.options, call.words.front()));
  std::error_code failed;
  if (fs::path(file).extension() != ".mcap") return Error{"a recording's name ends in .mcap"};
  if (fs::exists(file, failed)) return Error{"'" + file + "' is there already", "give another name"};
  SL_ASSIGN(std::string text, call.options.record(file));
  return std::optional(std::move(text));
}

CommandResult cmd_at(CommandCall& call) {
  SL_CHECK(call.schedule != nullptr);
  SL_ASSIGN(const Time at, call.schedule(trim(call.line)));
  return std::optional("will run at " + readable(at.s()) + " s");
}

CommandResult cmd_time(CommandCall& call) {
  const Session::Report report = call.session.report();
  std::string text = fmt::format("{} s, tick {}, {}", readable(call.simulation().now().s()),
                                 call.simulation().tick_index(), Session::name_of(report.state));
  if (!report.reason.empty()) text += " (" + report.reason + ")";
  text += ", " + speed_text(report.speed);
  if (report.state == Session::State::playing) text += fmt::format(", now x {:.3g}", report.real_time_factor);
  return std::optional(std::move(text));
}

CommandResult cmd_clients(CommandCall& call) {
  if (!call.options.clients) return Error{"this run has no server", "clients come to `run --port N`"};
  if (!call.caller.may_steer) return Error{"only an administrator sees who is connected"};
  return std::optional(call.options.clients(call.json));
}

CommandResult cmd_hash(CommandCall& call) {
  return std::optional(
      fmt::format("{:016x} after tick {}", call.simulation().state_hash(), call.simulation().tick_index()));
}

CommandResult cmd_echo(CommandCall& call) {
  const std::size_t blank = trim(call.line).find_first_of(" \t");
  return std::optional(blank == std::string_view::npos ? std::string()
                                                       : std::string(trim(trim(call.line).substr(blank))));
}

CommandResult cmd_quit(CommandCall& call) {
  call.session.quit();
  return std::optional<std::string>("the run ends " + at(call.simulation()));
}

}  // namespace sandlot::console
