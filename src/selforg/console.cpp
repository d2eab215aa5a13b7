#include "selforg/console.h"

#include <fmt/format.h>

#include "base/text.h"

namespace sandlot::selforg {
namespace {

constexpr std::size_t most_letters = 4096;

constexpr std::string_view help_text =
    "list                 the agent and its parameters\n"
    "show [NAME...]       parameters and values; * stands for any letters: show C* x[0]\n"
    "set NAME VALUE       or NAME=VALUE: set eps* 0.2\n"
    "store FILE           what the agent has learned\n"
    "load FILE            goes on from such a file\n"
    "log FILE [INTERVAL]  values every INTERVAL steps (5) from now on; log off ends it\n"
    "babble STEPS         motors move at random, and the agent learns from it\n"
    "pause, run, step [N], quit\n";

/// Parameters of controller and wiring, and the factor on noise.
struct Named {
  std::string name;
  double value;
};
std::vector<Named> parameters_of(const Agent& agent) {
  std::vector<Named> out{{"noise", agent.wired().noise()}};
  const auto add = [&](std::string path, const ValueEntry& entry) {
    if (!entry.list && entry.is == ValueFound::Is::value) out.push_back({std::move(path), entry.value});
  };
  agent.wired().controller().list_values(ValuePart::parameter,
                                         [&](const ValueEntry& entry) { add(entry.path, entry); });
  agent.wired().wiring().list_values(ValuePart::parameter, [&](const ValueEntry& entry) {
    add((starts_with(entry.path, "[") ? "wiring" : "wiring.") + entry.path, entry);
  });
  return out;
}

std::vector<Named> values_of(const Agent& agent) {
  std::vector<Named> out;
  agent.wired().channels([&](const Channel& channel) {
    for (std::size_t i = 0; i < channel.values.size(); ++i)
      out.push_back({channel_name(channel, i), channel.values[i]});
  });
  return out;
}

std::vector<std::string> names_in(const std::vector<Named>& list) {
  std::vector<std::string> names;
  for (const Named& each : list) names.push_back(each.name);
  return names;
}

/// `[1,2]` is an index, not a choice of letters: names are compared as they are before they count as patterns.
bool fitting(std::string_view name, std::string_view pattern) {
  return name == pattern || fits_pattern(name, pattern);
}

}  // namespace

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (const std::string_view word : split(line, ' '))
    if (!trim(word).empty()) words.push_back(trim(word));
  return words;
}

Result<std::uint64_t> number_of_steps(std::string_view text) {
  constexpr double most_steps = 1e15;
  double number = 0;
  if (!parse_number(text, number) || !(number >= 1 && number <= most_steps) || number != std::floor(number))
    return Error{fmt::format("'{}' is not a number of steps", text.substr(0, 40)), "1 to 1e15"};
  return static_cast<std::uint64_t>(number);
}

Result<std::string> AgentConsole::show(std::span<const std::string_view> names) const {
  std::vector<Named> all = parameters_of(agent_);
  for (Named& each : values_of(agent_)) all.push_back(std::move(each));
  std::string text;
  std::vector<bool> met(names.size(), false);
  for (const Named& each : all) {
    bool wanted = names.empty();
    for (std::size_t i = 0; i < names.size(); ++i)
      if (fitting(each.name, names[i])) wanted = met[i] = true;
    if (wanted) text += fmt::format("{} = {}\n", each.name, number_text(each.value));
  }
  for (std::size_t i = 0; i < names.size(); ++i)
    if (!met[i])
      return Error{fmt::format("there is no '{}'", names[i].substr(0, 100)),
                   suggestion(names[i], names_in(all))};
  return text;
}

Result<std::string> AgentConsole::set(std::string_view name, std::string_view value) {
  // Saved first: where one of several is refused, none is changed.
  const double noise = agent_.wired().noise();
  ByteWriter before;
  agent_.controller().save_parameters(before);
  agent_.wired().wiring().save_parameters(before);
  std::string text;
  const std::vector<Named> all = parameters_of(agent_);
  for (const Named& each : all) {
    if (!fitting(each.name, name)) continue;
    if (const Status set = agent_.set(each.name, value); !set) {
      agent_.wired().set_noise(noise);
      ByteReader r(before.bytes());
      agent_.controller().load_parameters(r);
      agent_.wired().wiring().load_parameters(r);
      Error error = set.error();
      error.path = each.name;
      return error;
    }
    text += fmt::format("{} = {}\n", each.name, value);
  }
  if (text.empty())
    return Error{fmt::format("there is no parameter '{}'", name.substr(0, 100)),
                 suggestion(name, names_in(all))};
  return text;
}

Result<std::string> AgentConsole::execute(std::string_view line) {
  if (line.size() > most_letters) return Error{fmt::format("a line has {} letters at most", most_letters)};
  if (std::any_of(line.begin(), line.end(),
                  [](unsigned char c) { return c < ' ' && c != '\t' && c != '\r'; }))
    return Error{"a line is text without control characters"};
  std::vector<std::string_view> words = words_of(line);
  if (words.empty()) return std::string();
  const std::string_view command = words.front();
  // "epsC=0.2", "set epsC=0.2", "set epsC = 0.2"
  if (const std::size_t equals = line.find('='); equals != std::string_view::npos) {
    auto left = words_of(line.substr(0, equals));
    if (!left.empty() && left.front() == "set") left.erase(left.begin());
    if (left.size() != 1) return Error{"'=' belongs between a name and its value", "epsC=0.2"};
    return set(left.front(), trim(line.substr(equals + 1)));
  }
  const auto needs = [&](std::size_t least, std::size_t most, const char* usage) -> Status {
    if (words.size() - 1 >= least && words.size() - 1 <= most) return {};
    return Error{fmt::format("'{}' is {}", command, usage), "help"};
  };
  if (command == "help" || command == "?") return std::string(help_text);
  if (command == "list" || command == "ls") {
    const WiredController& agent = agent_.wired();
    std::string text = fmt::format("{}, {} sensors, {} motors, {} steps\n", agent.kinds(),
                                   agent.robot_sensors(), agent.robot_motors(), agent.steps());
    for (const Named& each : parameters_of(agent_))
      text += fmt::format("{} = {}\n", each.name, number_text(each.value));
    return text;
  }
  if (command == "show" || command == "view") return show(std::span(words).subspan(1));
  if (command == "set") {
    SL_TRY(needs(2, 2, "set NAME VALUE"));
    return set(words[1], words[2]);
  }
  if (command == "store") {
    SL_TRY(needs(1, 1, "store FILE"));
    SL_TRY(agent_.wired().store(std::string(words[1])));
    return fmt::format("stored in {} after {} steps\n", words[1], agent_.wired().steps());
  }
  if (command == "load") {
    SL_TRY(needs(1, 1, "load FILE"));
    SL_TRY(agent_.wired().load(std::string(words[1])));
    return fmt::format("goes on from {}\n", words[1]);
  }
  if (command == "log") {
    SL_TRY(needs(1, 2, "log FILE [INTERVAL], or log off"));
    if (words[1] == "off") {
      SL_TRY(agent_.stop_log());
      return std::string("the log ends\n");
    }
    LogSpec spec;
    if (words.size() > 2) {
      SL_ASSIGN(const std::uint64_t interval, number_of_steps(words[2]));
      if (interval > 1'000'000) return Error{"the interval of a log is at most 1e6 steps"};
      spec.interval = static_cast<int>(interval);
    }
    SL_TRY(agent_.start_log(std::string(words[1]), spec));
    return fmt::format("logs to {}\n", words[1]);
  }
  if (command == "babble") {
    SL_TRY(needs(1, 1, "babble STEPS"));
    SL_ASSIGN(const std::uint64_t steps, number_of_steps(words[1]));
    agent_.wired().babble(steps);
    return fmt::format("babbles for {} steps\n", steps);
  }
  return Error{
      fmt::format("there is no command '{}'", command.substr(0, 60)),
      suggestion(command, std::vector<std::string>{"help", "list", "show", "set", "store", "load", "log",
                                                   "babble", "pause", "run", "step", "quit"})};
}

}  // namespace sandlot::selforg
