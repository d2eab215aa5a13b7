#pragma once
/// The command language of a running session, shared by terminal, page, scripts and tests. The words: docs/console.md.
///
///   Console console(session, {.paths = {"models"}});
///   console.execute("set rover/laser.noise.white 2 cm", {.may_steer = true}, [](const Answer& a) { ... });
///
/// Threads  the simulation's (Session::post brings a line there).
/// Answers  each line is answered exactly once: at once, or when its requests have been carried out. While the run is paused a
///          request is answered at once: "... with the next tick".
/// Errors   unknown words name the nearest known one; a line that fails has done nothing.
/// Limits   a line has 4096 characters at most, an address pattern meets at most 10,000 things.
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "sim/session/session.h"

namespace sandlot {

class RunHooks;

/// Origin and rights of a line.
struct Caller {
  bool may_steer = true;
  Source source = {};
};

struct Answer {
  bool ok = true;
  std::string text;
};

class Console {
 public:
  struct Options {
    std::vector<std::string> paths;  ///< folders to search for models (`add`) and files
    std::string folder = ".";        ///< where store, load and record may write and read: there and below
    RunHooks* experiment = nullptr;  ///< whose commands are known too
    /// Starts a recording to a file, or ends it (""). Unset: there is none.
    std::function<Result<std::string>(const std::string& file)> record;
    /// Clients of the run's server, as a table or as JSON; called on the simulation's thread. Unset: it has none.
    std::function<std::string(bool json)> clients = {};
  };
  Console(Session& session, Options options);
  const Options& options() const { return options_; }

  /// Sets or clears Options::clients: a server comes later than its console. @pre no line is being executed
  void set_clients(std::function<std::string(bool json)> clients) { options_.clients = std::move(clients); }

  using Reply = std::function<void(const Answer&)>;
  void execute(std::string_view line, const Caller& caller, const Reply& reply);

  /// How the last word of `line` may go on, at most 100, sorted: whole words.
  std::vector<std::string> complete(std::string_view line) const;

  /// "at 2s set rover/laser.noise.white 0.1", or a line without a time: before the first tick. Scripts are such lines,
  /// `#` begins a comment. Errors name file and line; what is wrong in a word is found now where that can be. After a
  /// reset or a jump back the lines behind that time are executed again, except those that go through time themselves.
  Status schedule(std::string_view line, const Place& place = {});
  Status schedule_script(const std::string& file);
  /// Executes the lines that are due; call before each tick. An error of a line ends the run, also one that turned up in the tick before.
  Status before_tick();
  /// Call when the run has ended: an error of the last tick's lines.
  Status finish();
  /// Answers of scheduled lines since the last call.
  std::vector<std::string> take_answers();

 private:
  struct Scheduled {
    Time at;
    std::string text;
    Place place;
    bool of_run = true;  ///< an error of it ends the run; else it came while the run went on
    bool over = false;   ///< it will not be executed again, whatever becomes of the time
  };
  Result<Scheduled> read_scheduled(std::string_view line, const Place& place);
  void insert(Scheduled scheduled);
  void find_next();
  Session& session_;
  Options options_;
  struct ScheduledAnswers;  ///< answers of scheduled lines; outlives the console, as answers may come late
  void execute(std::string_view line, const Caller& caller, const Reply& reply, bool before_tick);
  Status rehearse(std::string_view line);

  std::vector<Scheduled> scheduled_;  ///< in order of time
  std::size_t next_ = 0;              ///< the first that has not been executed
  std::uint64_t epoch_ = 0;           ///< of the session when `next_` was found
  std::shared_ptr<ScheduledAnswers> answers_;
};

}  // namespace sandlot
