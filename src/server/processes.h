#pragma once
/// Processes of programs: starts, watches and ends those of remote robots and teams that have a command.
///
/// Connection  each has a socket of its own in a private folder (programs/sandbox.h). Who comes there is the robot or the team.
/// Restart     by the program's rule, after 0.1 s, twice as long after each end, 5 s at most; six ends in a row within 10 s of
///             their start are the last. At once when it is requested, or a file of it has changed.
/// Budget      processor time and memory of all processes of a program are measured 25 times a second. Who has used more than its
///             share is halted until it has not; who has more memory is ended.
/// Output      lines go to the log, 50 a second and 200 at once, and all of them to a file, if a folder is given, 16 MB at most.
/// Threads     one of its own starts and watches; the functions may be called from any.
/// Determinism nothing here is State: the run sees a client that comes, answers and goes.
/// Limits      robots that are spawned later get no process; a robot that is deleted keeps its own until the end of the run.
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "server/http/transport.h"

namespace sandlot {
class Simulation;
}

namespace sandlot::server {

struct ProgramOptions {
  bool start = false;                       ///< whether commands of the scenario are started
  bool watch_files = false;                 ///< restarts a program when a file of its folder has changed
  std::string log_folder;                   ///< of a file per program; "": none
  std::vector<std::string> python_folders;  ///< with modules that programs may import: the client
};

class Processes {
 public:
  /// Null: the world has no program to start.
  /// Errors   two programs of one robot; no folder for sockets or log files.
  static Result<std::unique_ptr<Processes>> create(Simulation& simulation, const ProgramOptions& options);
  ~Processes();
  std::vector<LocalPort> ports() const;
  /// Starts all. Errors: of the first that cannot be started, with its place.
  Status start();
  Status restart(const std::string& program);
  /// From here on their ends are as they should be.
  void expect_end();
  /// Gives them half a second to end by themselves, then kills what is left.
  void stop();

 private:
  struct Impl;
  explicit Processes(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sandlot::server
