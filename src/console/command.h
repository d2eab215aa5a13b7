#pragma once
/// One command of the console: its row in the table, and the call that it is given. Help, completion and docs/console.md
/// follow the table.
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "console/console.h"

namespace sandlot::console {

/// A line on its way.
struct CommandCall {
  Session& session;
  const Console::Options& options;
  const Caller& caller;
  const Console::Reply& reply;
  std::span<const std::string> words;  ///< behind the command's name, without --json
  std::string_view line;               ///< as it was written
  std::vector<std::size_t> ends = {};  ///< where each of `words` ends in the line
  bool json = false;
  bool before_tick = false;    ///< a tick follows whether the run is paused or not: scripts
  bool rehearsal = false;      ///< finds faults and does nothing: a script before the run begins
  bool unknown_thing = false;  ///< set by a rehearsal that failed for what may be there when the time comes

  /// Schedules a line ("at 2s ..."). @return when
  std::function<Result<Time>(std::string_view line)> schedule = {};

  const Simulation& simulation() const { return std::as_const(session).simulation(); }
  /// The line behind so many words, as it was written.
  std::string_view rest(std::size_t words) const;
};

/// What to answer now; nothing: the answer comes when the request has been carried out.
using CommandResult = Result<std::optional<std::string>>;

/// What an argument is, for completion.
enum class Argument : std::uint8_t {
  none,  ///< free: a number, a text
  command,
  list,            ///< what `list` lists
  thing,           ///< an instance
  device,          ///< its path
  level,           ///< of the device before it
  service,         ///< of the device before it
  controller_act,  ///< what `controllers` does, or a robot
  controller,      ///< its path
  agent,           ///< a robot's program
  link,            ///< of the thing before it
  parameter,       ///< its address
  value,           ///< its address
  target,          ///< a device that takes commands, or a topic that programs read
  type,            ///< the message type that the target before it takes
  model,
  off,
  speed,
};

/// A command of the console's own, in contrast to those of a program's hooks.
struct BuiltinCommand {
  const char* name;
  const char* aliases = "";   ///< further names, separated by blanks
  const char* usage = "";     ///< what follows the name
  const char* help;           ///< one sentence
  bool steers = false;        ///< it changes the run, or writes a file: not for spectators
  std::size_t min_words = 0;  ///< that must follow
  std::vector<Argument> arguments = {Argument::none};  ///< the last one goes for all that follow
  CommandResult (*act)(CommandCall&);
  bool submits = false;                      ///< all its effects go through submit(): it can be rehearsed
  bool plain = false;                        ///< quotes are letters like others
  bool travels = false;                      ///< it leaves the present time
  std::size_t stays_with = ~std::size_t{0};  ///< with so many words that follow it does not
};

/// In the order of the help.
std::span<const BuiltinCommand> commands();
/// Null when there is none of that name.
const BuiltinCommand* find_command(std::string_view name);
std::vector<std::string> command_names(const Console::Options& options);

/// A request and its description in answers: "rover/laser.noise.white = 0.02 m".
struct PendingRequest {
  Request request;
  std::string text;
  const MessageInfo* response = nullptr;  ///< of a CallRequest whose response is shown
};
/// Hands requests to the session, which answers for all of them together. @pre there is at least one
CommandResult submit(CommandCall& call, std::vector<PendingRequest> requests);

/// The instances whose name fits; an error when none does.
Result<std::vector<const Simulation::Entity*>> match_things(CommandCall& call, std::string_view pattern);
/// Paths of devices, and of programs if wanted.
Result<std::vector<std::string>> match_devices(CommandCall& call, std::string_view pattern);
/// The thing of that very name.
Result<const Simulation::Entity*> find_thing(CommandCall& call, std::string_view name);

/// The file behind a name that a line gave: in the console's folder or below.
Result<std::string> file_within(const Console::Options& options, std::string_view name);

struct ModelFile {
  std::string name;  ///< "models/rover/model.sdf"
  std::string file, help;
};
/// What `add` can load, by name.
std::vector<ModelFile> model_files(const Console::Options& options);
/// Scenarios and worlds: Sandlot's own, and those in the console's folder.
std::vector<ModelFile> world_files(const Console::Options& options);
/// The file that a URI names: "rover", "model://rover", "models/rover/model.sdf" of `known`, or a file in the console's folder
/// or one of those that are searched, as "file:///..." or by its path. "builder:..." stays as it is.
Result<std::string> resource_file(const Console::Options& options, std::string_view uri,
                                  std::span<const ModelFile> known);

inline constexpr std::size_t most_letters = 4096, most_pattern = 300, most_matches = 10'000;

// In the files of their kind: run, world, values, list.
CommandResult cmd_help(CommandCall& call);
CommandResult cmd_list(CommandCall& call);
CommandResult cmd_show(CommandCall& call);
CommandResult cmd_set(CommandCall& call);
CommandResult cmd_level(CommandCall& call);
CommandResult cmd_command(CommandCall& call);
CommandResult cmd_sample(CommandCall& call);
CommandResult cmd_press(CommandCall& call);
CommandResult cmd_referee(CommandCall& call);
CommandResult cmd_call(CommandCall& call);
CommandResult cmd_controllers(CommandCall& call);
CommandResult cmd_values(CommandCall& call);
CommandResult cmd_events(CommandCall& call);
CommandResult cmd_pose(CommandCall& call);
CommandResult cmd_drag(CommandCall& call);
CommandResult cmd_pull(CommandCall& call);
CommandResult cmd_add(CommandCall& call);
CommandResult cmd_remove(CommandCall& call);
CommandResult cmd_pause(CommandCall& call);
CommandResult cmd_run(CommandCall& call);
CommandResult cmd_step(CommandCall& call);
CommandResult cmd_speed(CommandCall& call);
CommandResult cmd_reset(CommandCall& call);
CommandResult cmd_jump(CommandCall& call);
CommandResult cmd_store(CommandCall& call);
CommandResult cmd_load(CommandCall& call);
// Of robots that learn: `list agents`, `store AGENT FILE`, `load AGENT FILE`.
CommandResult list_agents(CommandCall& call);
CommandResult store_agent(CommandCall& call);
CommandResult load_agent(CommandCall& call);
CommandResult cmd_record(CommandCall& call);
CommandResult cmd_time(CommandCall& call);
CommandResult cmd_clients(CommandCall& call);
CommandResult cmd_hash(CommandCall& call);
CommandResult cmd_echo(CommandCall& call);
CommandResult cmd_at(CommandCall& call);
CommandResult cmd_quit(CommandCall& call);

}  // namespace sandlot::console
