#pragma once
/// Keys of what a scenario watches: events and the log.
#include <string>
#include <vector>

#include "base/fields.h"

namespace sandlot::formats::scenario_spec {

struct Event {
  std::string name;
  std::string when;
  double hold_s = 0;
  bool stop = false, once = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the event; unique.", 0, 0, Field::required, 100}, s.name);
    visit(Field{"when", "", "Condition of the event: an expression that is other than 0.", 0, 0,
                Field::required, 2000},
          s.when);
    visit(Field{"for", "s", "Time for which the condition must hold without a break.", 0, 9e9}, s.hold_s);
    visit(Field{"stop", "", "Whether the event ends the run."}, s.stop);
    visit(Field{"once", "", "Whether the event happens only once."}, s.once);
  }
};

struct Log {
  std::string file;
  double rate_hz = 0;
  std::vector<std::string> values;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"file", "", "CSV file to write, relative to where the program runs.", 0, 0, Field::required,
                4096},
          s.file);
    visit(Field{"rate", "Hz", "Lines per simulated second; 0: one per tick.", 0, 1e6}, s.rate_hz);
    visit(Field{"values", "", "Addresses or expressions, one per column.", 0, 0, Field::required, 2000},
          s.values);
  }
};

}  // namespace sandlot::formats::scenario_spec
