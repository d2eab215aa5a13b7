#pragma once
/// Console of an agent on a terminal, while the robot runs.
///
///   selforg::Terminal terminal(agent);                    // standard input and output
///   while (terminal.serve()) { agent.step(0.01); robot.move(0.01); }
///
/// Commands  those of selforg/console.h, and pause, run, step [N], quit.
/// Threads   the one that steps.
#include <string>
#include <string_view>

#include "selforg/console.h"

namespace sandlot::selforg {

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
