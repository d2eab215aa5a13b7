#pragma once
/// Measurements against references taken in the same run: the machine cancels out, the ratio remains.
#include <algorithm>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

namespace sandlot::bench {

/// One line of `sandlot bench`. `ratio` = value / reference, both costs, so less is better; ok: ratio <=
/// budget.
struct Row {
  std::string name;
  double value = 0;
  std::string unit;
  double reference = 0;
  double ratio = 0;
  double budget = 0;
  bool ok = false;
  double guard = 0;  ///< ratio from which on `--guard` fails; 0: twice the budget
};

/// @param guard  of rows that are known to miss their budget: twice of what they take
inline Row row(std::string name, std::string unit, double value, double reference, double budget,
               double guard = 0) {
  const double ratio = value / reference;
  return {std::move(name), value, std::move(unit), reference, ratio, budget, ratio <= budget, guard};
}

// The suites; entry.cpp runs them by name.
std::vector<Row> swarm();       ///< P1: the swarm's scenario, robot by robot
std::vector<Row> rays();        ///< P2, P5: rays of both kinds of world
std::vector<Row> images();      ///< P5: pictures against their depth alone
std::vector<Row> levels();      ///< A8: sensors at their low and at their high levels
std::vector<Row> physics();     ///< P3: steps of the engines
std::vector<Row> wheels();      ///< P3: robots on wheels alone
std::vector<Row> pile();        ///< P3: a pile in the solver for large islands
std::vector<Row> loading();     ///< P8: files to a simulation
std::vector<Row> recording();   ///< P11: runs and images into a file
std::vector<Row> viewer();      ///< P9: what looking at a run costs it
std::vector<Row> radio();       ///< packets among many robots
std::vector<Row> lockstep();    ///< P7: a step of a client over TCP
std::vector<Row> rollers();     ///< P4: a robot on wheels with rollers
std::vector<Row> match();       ///< P6: a match of twelve robots at its levels
std::vector<Row> robios();      ///< RoBIOS programs: a time slot, and four robots with cameras
std::vector<Row> navigation();  ///< estimators and planners against plain ones
std::vector<Row> sox();         ///< a learning step of homeokinesis against bare Eigen

/// Processor time of the calling thread: other work on the machine does not count.
inline double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

struct Timing {
  double ours_s, reference_s;
};

/// Median times of two pieces of work that take turns, so that drifts of clock and caches hit both.
template <class Ours, class Reference>
Timing compare(int repetitions, Ours&& ours, Reference&& reference) {
  std::vector<double> a, b;
  const auto time = [](auto& work, std::vector<double>& times) {
    const double begin = thread_seconds();
    work();
    times.push_back(thread_seconds() - begin);
  };
  for (int i = 0; i < repetitions + 1; ++i) {
    time(ours, a);
    time(reference, b);
  }
  const auto median = [](std::vector<double>& times) {
    times.erase(times.begin());  // the first warms up
    const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
    std::nth_element(times.begin(), middle, times.end());
    return *middle;
  };
  return {median(a), median(b)};
}

}  // namespace sandlot::bench
