#pragma once
/// Log of an agent: its named values over time, in the text format of selforg's tools (selforg/log_file.h).
///
///   auto log = AgentLog::open(simulation, {.agent = "rover/controller", .file = "rover.log"});
///   SL_TRY((*log)->begin());  session.add_observer(log->get());
///
/// Lines   one per `interval` control steps of the agent, with the simulated time; a parameter that was set is a comment before
///         the next line.
/// Errors  open() checks the agent and leaves an existing file alone; begin() replaces it.
#include <memory>
#include <string>
#include <vector>

#include "controllers/selforg/selforg.h"
#include "sim/world/simulation.h"

namespace sandlot {

struct AgentLogDecl {
  std::string agent;  ///< "rover/controller"; "": the only one
  std::string file;
  selforg::LogSpec spec = {};
};

/// Logs that the controllers of a world declare by their key `log`.
std::vector<AgentLogDecl> declared_agent_logs(const Simulation& simulation);
/// "ROBOT/CONTROLLER=FILE", "ROBOT=FILE" or, in a world with one agent, "FILE".
AgentLogDecl parse_agent_log(std::string_view text);

class AgentLog final : public Observer {
 public:
  static Result<std::unique_ptr<AgentLog>> open(const Simulation& simulation, AgentLogDecl decl);
  const std::string& file() const { return decl_.file; }
  Status begin();
  Wants wants() const override { return {.input = true, .instances = false}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override;
  Status finish() { return log_.close(); }

 private:
  AgentLog(const Simulation& simulation, AgentLogDecl decl)
      : simulation_(simulation), decl_(std::move(decl)) {}
  const selforg::WiredController* agent() const;
  void write_step();

  const Simulation& simulation_;
  AgentLogDecl decl_;
  selforg::LogFile log_;
  std::uint64_t steps_ = 0;  ///< of the agent when the last line was considered
};

}  // namespace sandlot
