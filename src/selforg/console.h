#pragma once
/// Console of an agent in a program without simulator: lines in, answers out. On a terminal: selforg/terminal/terminal.h.
///
/// Commands  help, list, show [NAME...], set NAME VALUE (or NAME=VALUE), store FILE, load FILE, log FILE [INTERVAL] or log off,
///           babble STEPS; on a terminal in addition pause, run, step [N] and quit. `*` in names stands for any letters: set eps* 0.2
/// Names     parameters of the controller (epsC), of the wiring with `wiring.` in front, `noise`; values as in logs (x[0], C[1,2]).
/// Errors    a line that fails has changed nothing.
/// Threads   the one that steps.
#include <string>
#include <string_view>

#include "selforg/agent.h"

namespace sandlot::selforg {

class AgentConsole {
 public:
  explicit AgentConsole(Agent& agent) : agent_(agent) {}
  /// @param line  at most 4096 letters
  Result<std::string> execute(std::string_view line);

 private:
  Result<std::string> show(std::span<const std::string_view> names) const;
  Result<std::string> set(std::string_view name, std::string_view value);
  Agent& agent_;
};

/// Words of a line, separated by blanks.
std::vector<std::string_view> words_of(std::string_view line);
/// A whole number from 1 to 1e15.
Result<std::uint64_t> number_of_steps(std::string_view text);

}  // namespace sandlot::selforg
