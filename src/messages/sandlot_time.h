#pragma once
/// sandlot_msgs: how fast a run goes.
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// Wall times of the latest ticks. With `restarted` the first tick has no interval, so that `wall_s` is one shorter than `compute_s`.
struct StepTimes {
  static constexpr const char* ros_type = "sandlot_msgs/msg/StepTimes";
  Time stamp;
  double step_s = 0;
  bool restarted = false;
  std::vector<double> wall_s;
  std::vector<double> compute_s;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Simulated time at the end of the last tick."}, s.stamp);
    visit(Field{"step_s", "s", "Length of a tick in simulated time; mean where they differ."}, s.step_s);
    visit(Field{"restarted", "",
                "Whether the first tick follows a start, a pause or a leap in time: it has no interval."},
          s.restarted);
    visit(Field{"wall_s", "s", "Wall time from the end of the tick before to the end of each tick."},
          s.wall_s);
    visit(Field{"compute_s", "s", "Wall time that each tick took to compute."}, s.compute_s);
  }
};

}  // namespace sandlot::msg
