#pragma once
/// Progress of a run as one line on the terminal: simulated time, speed, time left. Nothing when standard
/// error is not a terminal.
#include <chrono>

#include "base/time.h"

namespace sandlot {
class Simulation;
}

namespace sandlot::app {

class Progress {
 public:
  Progress();
  ~Progress() { clear(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// After each tick; draws at most five times a second.
  void update(const Simulation& simulation);
  /// Removes the line.
  void clear();

 private:
  bool shown_, drawn_ = false;
  std::chrono::steady_clock::time_point begin_, last_;
  Time sim_begin_;
};

}  // namespace sandlot::app
