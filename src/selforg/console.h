#pragma once
/// Console of an agent in a program without simulator: lines in, answers out; and the same on a terminal while the robot runs.
///
///   selforg::Terminal terminal(agent);                    // standard input and output
///   while (terminal.serve()) { agent.step(0.01); robot.move(0.01); }
///
/// Commands  help, list, show [NAME...], set NAME VALUE (or NAME=VALUE), store FILE, load FILE, log FILE [INTERVAL] or log off,
///           babble STEPS; on a terminal in addition pause, run, step [N] and quit. `*` in names stands for any letters: set eps* 0.2
/// Names     parameters of the controller (epsC), of the wiring with `wiring.` in front, `noise`; values as in logs (x[0], C[1,2]).
/// Errors    a line that fails has changed nothing.
/// Threads   the one that steps.
#include <cstdio>
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

/// Reads lines between steps, without waiting as long as the agent runs.
class Terminal {
 public:
  struct Options {
    bool paused = false;  ///< begins paused
    int in = 0, out = 1;  ///< file descriptors
    bool prompt = false;  ///< writes a prompt while paused
  };
  explicit Terminal(Agent& agent) : Terminal(agent, Options()) {}
  Terminal(Agent& agent, Options options)
      : console_(agent), options_(options), state_(options.paused ? State::paused : State::running) {}
  /// Executes the lines that have come; while paused, waits for more. @return false: the program should end (quit, or the end of
  /// the input while paused)
  bool serve();

 private:
  enum class State { running, stepping, paused };
  bool execute(std::string_view line);
  bool read_more(bool wait);
  void print(std::string_view text) const;

  AgentConsole console_;
  Options options_;
  State state_;
  std::uint64_t steps_left_ = 0;
  std::string pending_;
  bool ended_ = false;  ///< the input
};

}  // namespace sandlot::selforg
