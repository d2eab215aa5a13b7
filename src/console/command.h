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
struct Call {
  Session& session;
  const Console::Options& options;
  const Speaker& speaker;
  const Console::Reply& reply;
  std::span<const std::string> words;  ///< behind the command's name, without --json
  std::string_view line;               ///< what was said
  std::vector<std::size_t> ends = {};  ///< where each of `words` ends in the line
  bool json = false;
  bool before_tick = false;    ///< a tick follows whether the run is paused or not: scripts
  bool rehearsal = false;      ///< finds faults and does nothing: a script before the run begins
  bool unknown_thing = false;  ///< set by a rehearsal that failed for what may be there when the time comes

  /// Has a line said later ("at 2s ..."). @return when
  std::function<Result<Time>(std::string_view line)> schedule = {};

  const Simulation& simulation() const { return std::as_const(session).simulation(); }
  /// The line behind so many words, as it was written.
  std::string_view rest(std::size_t words) const;
};

/// What to answer now; nothing: the answer comes when what was asked for is carried out.
using Said = Result<std::optional<std::string>>;

/// What an argument is, for completion.
enum class Argument : std::uint8_t {
  none,  ///< free: a number, a text
  command,
  list,       ///< what `list` lists
  thing,      ///< an instance
  device,     ///< its path
  level,      ///< of the device before it
  link,       ///< of the thing before it
  parameter,  ///< its address
  value,      ///< its address
  target,     ///< a device that takes commands
  type,       ///< the message type that the target before it takes
  model,
  off,
  speed,
};

struct Verb {
  const char* name;
  const char* others;               ///< further names, parted by blanks
  const char* usage;                ///< what follows the name
  const char* help;                 ///< one sentence
  bool steers;                      ///< it changes the run, or writes a file
  std::size_t least;                ///< words that must follow
  std::vector<Argument> arguments;  ///< the last one goes for all that follow
  Said (*act)(Call&);
  bool submits = false;  ///< all it does goes through submit(): it can be rehearsed
  bool plain = false;    ///< quotes are letters like others
  bool travels = false;  ///< it leaves the present time
};

/// In the order of the help.
std::span<const Verb> commands();
/// Null when there is none of that name.
const Verb* find_command(std::string_view name);
std::vector<std::string> command_names(const Console::Options& options);

/// A request and how it is told: "rover/laser.noise.white = 0.02 m".
struct Asked {
  Request request;
  std::string text;
};
/// Hands requests to the session, which answers for all of them together. @pre there is at least one
Said submit(Call& call, std::vector<Asked> asked);

/// The instances whose name fits; an error when none does.
Result<std::vector<const Simulation::Entity*>> match_things(Call& call, std::string_view pattern);
/// Paths of devices, and of programs if asked for.
Result<std::vector<std::string>> match_devices(Call& call, std::string_view pattern);
/// The thing of that very name.
Result<const Simulation::Entity*> find_thing(Call& call, std::string_view name);

/// A parameter of a device or program.
struct Parameter {
  std::string target, path;  ///< "rover/laser", "noise/white"
  std::string unit;
  std::string address() const;  ///< "rover/laser.noise.white"
};
/// All tunable ones of a device or program.
std::vector<Parameter> parameters_of(const Simulation& simulation, const Simulation::Entity& entity,
                                     std::string_view path);

/// What is wrong with a value, as far as it can be told without the device: its type, unit and range.
Status check_parameter(const Simulation& simulation, const Parameter& parameter, const Node& value);

/// The file behind a name that a line gave: in the console's folder or below.
Result<std::string> file_within(const Console::Options& options, std::string_view name);

struct ModelFile {
  std::string name;  ///< "models/rover/model.sdf"
  std::string file, help;
};
/// What `add` can load, by name.
std::vector<ModelFile> model_files(const Console::Options& options);

inline constexpr std::size_t most_letters = 4096, most_pattern = 300, most_matches = 10'000;

// In the files of their kind: run, world, values, list.
Said say_help(Call& call);
Said say_list(Call& call);
Said say_show(Call& call);
Said say_set(Call& call);
Said say_level(Call& call);
Said say_command(Call& call);
Said say_sample(Call& call);
Said say_values(Call& call);
Said say_events(Call& call);
Said say_pose(Call& call);
Said say_drag(Call& call);
Said say_pull(Call& call);
Said say_add(Call& call);
Said say_remove(Call& call);
Said say_pause(Call& call);
Said say_run(Call& call);
Said say_step(Call& call);
Said say_speed(Call& call);
Said say_reset(Call& call);
Said say_jump(Call& call);
Said say_store(Call& call);
Said say_load(Call& call);
Said say_record(Call& call);
Said say_time(Call& call);
Said say_hash(Call& call);
Said say_echo(Call& call);
Said say_at(Call& call);
Said say_quit(Call& call);

}  // namespace sandlot::console
