/// The table of commands.
#include "base/text.h"
#include "console/command.h"
#include "sim/session/run_hooks.h"

namespace sandlot::console {
namespace {

using A = Argument;

const std::vector<BuiltinCommand>& table() {
  static const std::vector<BuiltinCommand> commands{
      {"help", "?", "[WORD]", "All commands, or one of them in full.", false, 0, {A::command}, cmd_help},
      {"list",
       "ls",
       "[entities|models|topics|parameters|NAME|NAME/DEVICE] [--json]",
       "Entities, models to add, topics or parameters; or the contents of one entity or device.",
       false,
       0,
       {A::list},
       cmd_list},
      {"show",
       "view get",
       "ADDRESS... [--json]",
       "Values with their units: addresses, with * ? [ab] **, or expressions such as 'rover.pose.x * 2'.",
       false,
       1,
       {A::value},
       cmd_show},
      {"set",
       "",
       "ADDRESS VALUE",
       "Changes parameters (set */laser.noise.white 2 cm).",
       true,
       2,
       {A::parameter, A::none},
       cmd_set,
       true},
      {"level",
       "",
       "DEVICE LEVEL...",
       "Selects the active levels of abstraction of a device.",
       true,
       2,
       {A::device, A::level},
       cmd_level,
       true},
      {"command",
       "",
       "TARGET TYPE JSON",
       "Sends one message to a device (command rover/drive Twist {\"linear\": {\"x\": 0.5}}).",
       true,
       3,
       {A::target, A::type, A::none},
       cmd_command,
       true,
       true},
      {"sample",
       "",
       "DEVICE",
       "Takes a sample of a device in the next tick although it is not due.",
       true,
       1,
       {A::device},
       cmd_sample,
       true},
      {"pause", "", "", "Stops the clock.", true, 0, {A::none}, cmd_pause},
      {"run", "play", "[SPEED]", "Continues the run.", true, 0, {A::speed}, cmd_run},
      {"step", "", "[N]", "Runs N ticks, one by default, then pauses.", true, 0, {A::none}, cmd_step},
      {"speed",
       "",
       "[X|max]",
       "Sets the speed as a factor on real time, or as fast as possible; alone: shows it.",
       true,
       0,
       {A::speed},
       cmd_speed},
      {"reset", "", "", "Returns to the beginning.", true, 0, {A::none}, cmd_reset, false, false, true},
      {"jump",
       "rewind",
       "TIME",
       "Goes to a simulated time, back or ahead (jump 12 s; from now: jump -2 s).",
       true,
       1,
       {A::none},
       cmd_jump,
       false,
       false,
       true},
      {"pose",
       "",
       "NAME [X Y [Z] [YAW]] | NAME X Y Z ROLL PITCH YAW",
       "Sets the pose of an entity, in m and rad (\"90 deg\"); what is left out stays; alone: shows it.",
       true,
       1,
       {A::thing, A::none},
       cmd_pose,
       true},
      {"drag",
       "",
       "NAME X Y [Z]",
       "Moves an entity without turning it.",
       true,
       3,
       {A::thing, A::none},
       cmd_drag,
       true},
      {"pull",
       "",
       "NAME LINK PX PY PZ TX TY TZ | NAME off",
       "Pulls by a spring from a point of a link to a target in the world, for 0.25 s unless repeated.",
       true,
       2,
       {A::thing, A::link, A::none},
       cmd_pull,
       true},
      {"add",
       "",
       "MODEL [NAME] X Y [Z] [YAW] [size=...] [color=...] [mass=...]",
       "Adds a box, sphere or cylinder, a model file, or a copy of an entity (add copy of rover as ann 1 2).",
       true,
       3,
       {A::model, A::none},
       cmd_add,
       true},
      {"remove",
       "delete",
       "NAME",
       "Removes entities; * ? [ab] in the name.",
       true,
       1,
       {A::thing},
       cmd_remove,
       true},
      {"store", "", "FILE", "Writes the state to a snapshot file.", true, 1, {A::none}, cmd_store},
      {"load",
       "",
       "FILE",
       "Continues from a snapshot file.",
       true,
       1,
       {A::none},
       cmd_load,
       false,
       false,
       true},
      {"record", "", "FILE|off", "Begins a recording, or ends it.", true, 1, {A::off}, cmd_record},
      {"at",
       "",
       "TIME LINE",
       "Runs a line at a simulated time (at 12 s pause).",
       true,
       2,
       {A::none},
       cmd_at,
       false,
       true},
      {"time", "", "", "Simulated time, tick, speed, and whether it runs.", false, 0, {A::none}, cmd_time},
      {"hash", "", "", "Hash of all state; equal runs have equal hashes.", false, 0, {A::none}, cmd_hash},
      {"values", "", "[--json]", "The values that the scenario names.", false, 0, {A::none}, cmd_values},
      {"events",
       "",
       "[--json]",
       "The events of the scenario and how often they happened.",
       false,
       0,
       {A::none},
       cmd_events},
      {"echo", "", "TEXT", "Prints the text; for scripts.", false, 0, {A::none}, cmd_echo, false, true},
      {"quit", "", "", "Ends the run.", true, 0, {A::none}, cmd_quit},
  };
  return commands;
}

}  // namespace

std::span<const BuiltinCommand> commands() { return table(); }

const BuiltinCommand* find_command(std::string_view name) {
  for (const BuiltinCommand& command : table()) {
    if (name == command.name) return &command;
    for (const std::string_view other : split(command.others, ' '))
      if (!other.empty() && name == other) return &command;
  }
  return nullptr;
}

std::vector<std::string> command_names(const Console::Options& options) {
  std::vector<std::string> out;
  for (const BuiltinCommand& command : table()) {
    out.emplace_back(command.name);
    for (const std::string_view other : split(command.others, ' '))
      if (!other.empty()) out.emplace_back(other);
  }
  if (options.experiment)
    for (const HookCommand& own : options.experiment->commands()) out.push_back(own.name);
  return out;
}

CommandResult cmd_help(CommandCall& call) {
  if (!call.words.empty()) {
    const std::string& word = call.words.front();
    if (const BuiltinCommand* const command = find_command(word)) {
      std::string text = std::string(command->name) + (*command->usage ? " " : "") + command->usage + "\n" +
                         command->help;
      if (*command->others) text += std::string("\nAlso: ") + command->others;
      if (command->steers) text += "\nChanges the run: not for spectators.";
      return std::optional(text);
    }
    if (call.options.experiment)
      for (const HookCommand& own : call.options.experiment->commands())
        if (own.name == word) return std::optional(own.name + "\n" + own.help);
    return Error{"there is no command '" + word.substr(0, 60) + "'",
                 suggestion(word, command_names(call.options))};
  }
  std::size_t width = 0;
  for (const BuiltinCommand& command : table())
    width = std::max(width, std::string_view(command.name).size());
  std::string text;
  const auto add = [&](const std::string& name, const std::string& help) {
    text += (text.empty() ? "" : "\n") + name +
            std::string(std::max(width, name.size()) - name.size() + 2, ' ') + help;
  };
  for (const BuiltinCommand& command : table()) add(command.name, command.help);
  if (call.options.experiment)
    for (const HookCommand& own : call.options.experiment->commands()) add(own.name, own.help);
  text += "\n`help WORD` says what follows a word.";
  return std::optional(text);
}

}  // namespace sandlot::console
