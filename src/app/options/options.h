#pragma once
/// The verbs on the command line with their options: a function for each. app/verbs has what they do.
#include <memory>
#include <utility>
#include <vector>

#include "sim/session/run_hooks.h"

namespace CLI {
class App;
}

namespace sandlot::app {

/// The command line while it is put together and read.
struct CommandLine {
  CLI::App& app;
  int& result;                                ///< exit code of the verb
  const Hooks* hooks;                         ///< of an embedding program; null: none
  std::vector<std::shared_ptr<void>> kept{};  ///< what options are read into

  /// Makes an object that options may be read into: it lives as long as this.
  template <class T, class... Args>
  T& keep(Args&&... args) {
    auto made = std::make_shared<T>(std::forward<Args>(args)...);
    T& out = *made;
    kept.push_back(std::move(made));
    return out;
  }
};

// running.cpp
void add_run(CommandLine& line);
void add_demo(CommandLine& line);
void add_match(CommandLine& line);
void add_console(CommandLine& line);
// tournament.cpp
void add_tournament(CommandLine& line);
// drawing.cpp
void add_render(CommandLine& line);
void add_plot(CommandLine& line);
// files.cpp
void add_check(CommandLine& line);
void add_info(CommandLine& line);
void add_convert(CommandLine& line);
void add_calibrate(CommandLine& line);
// recordings.cpp
void add_replay(CommandLine& line);
void add_diff(CommandLine& line);
void add_fit(CommandLine& line);
void add_topic(CommandLine& line);
void add_doctor(CommandLine& line);
// program.cpp
void add_new(CommandLine& line);
void add_list(CommandLine& line);
void add_bench(CommandLine& line);
void add_validate(CommandLine& line);
void add_reproduce(CommandLine& line);

}  // namespace sandlot::app
