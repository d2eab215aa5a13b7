/// Commands to the referee of a match of robot soccer.
#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "console/command.h"
#include "messages/command.h"
#include "messages/messages.h"

namespace sandlot::console {
namespace {

/// The path of the first rule that takes words of a referee; empty: there is none.
std::string find_referee(const Simulation& simulation) {
  for (const WorldElements::Part& part : simulation.elements().parts())
    for (const auto& slot : part.commands)
      if (std::string_view(slot->type()) == msg::RefereeCommand::ros_type) return part.path;
  return {};
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return text;
}

}  // namespace

/// `referee STOP`, `referee KICKOFF cyan`, `referee RED_CARD cyan3`, `referee BALL 1 2`.
CommandResult cmd_referee(CommandCall& call) {
  const std::string path = find_referee(call.simulation());
  if (path.empty()) return Error{"there is no referee in this world", "rules: [{kind: referee}]"};
  msg::RefereeCommand word;
  word.command = upper(call.words[0]);
  if (word.command == "BALL") {
    if (call.words.size() != 3) return Error{"BALL needs a place", "referee BALL 1 2"};
    word.command += " " + call.words[1] + " " + call.words[2];
  } else if (call.words.size() > 2) {
    return Error{"a word takes a team or a robot", "referee KICKOFF cyan, or referee RED_CARD cyan3"};
  } else if (call.words.size() == 2) {
    const std::string& whom = call.words[1];
    const std::size_t digits = whom.size() - std::min(whom.size(), whom.find_last_not_of("0123456789") + 1);
    constexpr std::size_t most_digits = 6;
    word.team = whom.substr(0, whom.size() - digits);
    if (digits > 0 && digits <= most_digits) word.robot = std::stoi(whom.substr(whom.size() - digits));
  }
  CommandRequest request{path, msg::RefereeCommand::ros_type, command_bytes(word)};
  return submit(call, {{std::move(request), path + " got " + word.command}});
}

}  // namespace sandlot::console
