/// The table of commands.
#include "base/json_writer.h"
#include "base/text.h"
#include "console/command.h"
#include "sim/session/run_hooks.h"

namespace sandlot::console {
namespace {

using A = Argument;

const std::vector<BuiltinCommand>& table() {
  static const std::vector<BuiltinCommand> commands{
      {.name = "help",
       .aliases = "?",
       .usage = "[WORD] [--json]",
       .help = "All commands, or one of them in full.",
       .arguments = {A::command},
       .act = cmd_help},
      {.name = "list",
       .aliases = "ls",
       .usage = "[entities|robots|agents|models|topics|parameters|NAME|NAME/DEVICE] [--json]",
       .help =
           "Entities, robots, agents (their programs), models to add, topics or parameters; or the contents "
           "of one entity, device, program, medium or rule.",
       .arguments = {A::list},
       .act = cmd_list},
      {.name = "show",
       .aliases = "view get",
       .usage = "ADDRESS... [--json]",
       .help =
           "Values with their units: addresses, with * ? [ab] **, or expressions such as 'rover.pose.x * 2'.",
       .min_words = 1,
       .arguments = {A::value},
       .act = cmd_show},
      {.name = "set",
       .usage = "ADDRESS VALUE",
       .help = "Changes parameters (set */laser.noise.white 2 cm).",
       .steers = true,
       .min_words = 2,
       .arguments = {A::parameter, A::none},
       .act = cmd_set,
       .submits = true},
      {.name = "level",
       .usage = "DEVICE LEVEL...",
       .help = "Selects the active levels of abstraction of a device.",
       .steers = true,
       .min_words = 2,
       .arguments = {A::device, A::level},
       .act = cmd_level,
       .submits = true},
      {.name = "command",
       .usage = "TARGET TYPE JSON",
       .help = "Sends one message to a device, or on a topic that programs read (command rover/drive Twist "
               "{\"linear\": {\"x\": 0.5}}).",
       .steers = true,
       .min_words = 3,
       .arguments = {A::target, A::type, A::none},
       .act = cmd_command,
       .submits = true,
       .plain = true},
      {.name = "sample",
       .usage = "DEVICE",
       .help = "Takes a sample of a device in the next tick although it is not due.",
       .steers = true,
       .min_words = 1,
       .arguments = {A::device},
       .act = cmd_sample,
       .submits = true},
      {.name = "press",
       .usage = "ROBOT KEY | ROBOT touch X Y",
       .help = "Presses a key of a robot, from 1, or a place on its screen, in pixels.",
       .steers = true,
       .min_words = 2,
       .arguments = {A::thing, A::none},
       .act = cmd_press,
       .submits = true},
      {.name = "referee",
       .usage = "WORD [TEAM | ROBOT] | BALL X Y",
       .help = "Gives a word to the referee of a match (referee RED_CARD cyan3), or puts the ball.",
       .steers = true,
       .min_words = 1,
       .arguments = {A::none, A::thing},
       .act = cmd_referee,
       .submits = true},
      {.name = "call",
       .usage = "DEVICE SERVICE [JSON]",
       .help = "Calls a service of a device and prints its response.",
       .steers = true,
       .min_words = 2,
       .arguments = {A::device, A::service, A::none},
       .act = cmd_call,
       .submits = true},
      {.name = "controllers",
       .usage =
           "[ROBOT] [--json] | load CONTROLLER KIND [KEYS] | load CONTROLLER FILE.yaml | configure, start, "
           "stop or unload CONTROLLER... | start CONTROLLER... stop CONTROLLER...",
       .help =
           "Controllers of robots with their states; or loads, configures, starts, stops and unloads some "
           "(controllers load rover/weave sine {period: 2}).",
       .arguments = {A::controller_act, A::controller},
       .act = cmd_controllers,
       .submits = true,
       .plain = true},
      {.name = "pause", .help = "Stops the clock.", .steers = true, .act = cmd_pause},
      {.name = "run",
       .aliases = "play",
       .usage = "[SPEED]",
       .help = "Continues the run.",
       .steers = true,
       .arguments = {A::speed},
       .act = cmd_run},
      {.name = "step",
       .usage = "[N]",
       .help = "Runs N ticks, one by default, then pauses.",
       .steers = true,
       .act = cmd_step},
      {.name = "speed",
       .usage = "[X|max]",
       .help = "Sets the speed as a factor on real time, or as fast as possible; alone: shows it.",
       .steers = true,
       .arguments = {A::speed},
       .act = cmd_speed},
      {.name = "reset",
       .help = "Returns to the beginning.",
       .steers = true,
       .act = cmd_reset,
       .travels = true},
      {.name = "jump",
       .aliases = "rewind",
       .usage = "TIME",
       .help = "Goes to a simulated time, back or ahead (jump 12 s; from now: jump -2 s).",
       .steers = true,
       .min_words = 1,
       .act = cmd_jump,
       .travels = true},
      {.name = "pose",
       .usage = "NAME [X Y [Z] [YAW]] | NAME X Y Z ROLL PITCH YAW",
       .help =
           "Sets the pose of an entity, in m and rad (\"90 deg\"); what is left out stays; alone: shows it.",
       .steers = true,
       .min_words = 1,
       .arguments = {A::thing, A::none},
       .act = cmd_pose,
       .submits = true},
      {.name = "drag",
       .usage = "NAME X Y [Z]",
       .help = "Moves an entity without turning it.",
       .steers = true,
       .min_words = 3,
       .arguments = {A::thing, A::none},
       .act = cmd_drag,
       .submits = true},
      {.name = "pull",
       .usage = "NAME LINK PX PY PZ TX TY TZ | NAME off",
       .help =
           "Pulls by a spring from a point of a link to a target in the world, for 0.25 s unless repeated.",
       .steers = true,
       .min_words = 2,
       .arguments = {A::thing, A::link, A::none},
       .act = cmd_pull,
       .submits = true},
      {.name = "add",
       .usage = "MODEL [NAME] X Y [Z] [YAW] [size=...] [color=...] [mass=...]",
       .help = "Adds a box, sphere or cylinder, a model file, or a copy of an entity (add copy of rover as "
               "ann 1 2).",
       .steers = true,
       .min_words = 3,
       .arguments = {A::model, A::none},
       .act = cmd_add,
       .submits = true},
      {.name = "remove",
       .aliases = "delete",
       .usage = "NAME",
       .help = "Removes entities; * ? [ab] in the name.",
       .steers = true,
       .min_words = 1,
       .arguments = {A::thing},
       .act = cmd_remove,
       .submits = true},
      {.name = "store",
       .usage = "[ROBOT/CONTROLLER] FILE",
       .help = "Writes the state to a snapshot file, or what one agent has learned to a file of its own.",
       .steers = true,
       .min_words = 1,
       .arguments = {A::agent, A::none},
       .act = cmd_store},
      {.name = "load",
       .usage = "[ROBOT/CONTROLLER] FILE",
       .help = "Continues from a snapshot file, or gives one agent what another one has learned.",
       .steers = true,
       .min_words = 1,
       .arguments = {A::agent, A::none},
       .act = cmd_load,
       .travels = true,
       .stays_with = 2},
      {.name = "record",
       .usage = "FILE|off",
       .help = "Begins a recording, or ends it.",
       .steers = true,
       .min_words = 1,
       .arguments = {A::off},
       .act = cmd_record},
      {.name = "at",
       .usage = "TIME LINE",
       .help = "Runs a line at a simulated time (at 12 s pause).",
       .steers = true,
       .min_words = 2,
       .act = cmd_at,
       .plain = true},
      {.name = "time", .help = "Simulated time, tick, speed, and whether it runs.", .act = cmd_time},
      {.name = "clients",
       .usage = "[--json]",
       .help = "Clients of the run's server: who they are, what they drive, how late their answers are.",
       .act = cmd_clients},
      {.name = "hash", .help = "Hash of all state; equal runs have equal hashes.", .act = cmd_hash},
      {.name = "values",
       .usage = "[--json]",
       .help = "The values that the scenario names.",
       .act = cmd_values},
      {.name = "events",
       .usage = "[--json]",
       .help = "The events of the scenario and how often they happened.",
       .act = cmd_events},
      {.name = "echo",
       .usage = "TEXT",
       .help = "Prints the text; for scripts.",
       .act = cmd_echo,
       .plain = true},
      {.name = "quit", .help = "Ends the run.", .steers = true, .act = cmd_quit},
  };
  return commands;
}

}  // namespace

std::span<const BuiltinCommand> commands() { return table(); }

const BuiltinCommand* find_command(std::string_view name) {
  for (const BuiltinCommand& command : table()) {
    if (name == command.name) return &command;
    for (const std::string_view other : split(command.aliases, ' '))
      if (!other.empty() && name == other) return &command;
  }
  return nullptr;
}

std::vector<std::string> command_names(const Console::Options& options) {
  std::vector<std::string> out;
  for (const BuiltinCommand& command : table()) {
    out.emplace_back(command.name);
    for (const std::string_view other : split(command.aliases, ' '))
      if (!other.empty()) out.emplace_back(other);
  }
  if (options.experiment)
    for (const HookCommand& own : options.experiment->commands()) out.push_back(own.name);
  return out;
}

namespace {

/// Commands and, of an experiment, the keys that it binds.
std::string help_json(const CommandCall& call) {
  std::string text;
  JsonWriter json(text);
  const auto row = [&](const std::string& name, std::string_view usage, const std::string& help) {
    json.object([&] {
      json.key("name").text(name);
      json.key("usage").text(usage);
      json.key("help").text(help);
    });
  };
  json.object([&] {
    json.key("commands").list([&] {
      for (const BuiltinCommand& command : table()) row(command.name, command.usage, command.help);
      if (call.options.experiment)
        for (const HookCommand& own : call.options.experiment->commands()) row(own.name, "", own.help);
    });
    json.key("keys").list([&] {
      if (!call.options.experiment) return;
      for (const KeyBinding& each : call.options.experiment->bindings())
        json.object([&] {
          json.key("key").text(each.key);
          json.key("line").text(each.line);
          json.key("help").text(each.help);
        });
    });
  });
  return text;
}

}  // namespace

CommandResult cmd_help(CommandCall& call) {
  if (!call.words.empty()) {
    const std::string& word = call.words.front();
    if (const BuiltinCommand* const command = find_command(word)) {
      std::string text = std::string(command->name) + (*command->usage ? " " : "") + command->usage + "\n" +
                         command->help;
      if (*command->aliases) text += std::string("\nAlso: ") + command->aliases;
      if (command->steers) text += "\nChanges the run: not for spectators.";
      return std::optional(text);
    }
    if (call.options.experiment)
      for (const HookCommand& own : call.options.experiment->commands())
        if (own.name == word) return std::optional(own.name + "\n" + own.help);
    return Error{"there is no command '" + word.substr(0, 60) + "'",
                 suggestion(word, command_names(call.options))};
  }
  if (call.json) return std::optional(help_json(call));
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
  if (call.options.experiment)
    for (const KeyBinding& key : call.options.experiment->bindings())
      text += "\nkey " + key.key + "  " + key.line + (key.help.empty() ? "" : ": " + key.help);
  text += "\n`help WORD` says what follows a word.";
  return std::optional(text);
}

}  // namespace sandlot::console
