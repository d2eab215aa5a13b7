#include "run/step_times_file.h"

#include <fmt/format.h>

#include <iterator>

#include "base/text.h"

namespace sandlot {
namespace {

constexpr std::size_t hold_bytes = 64 << 10;
constexpr std::string_view names = "time_s,step_s,wall_s,compute_s";

}  // namespace

StepTimesFile::StepTimesFile(const std::string& path) : file_(path) {
  write(
      "# Step times of a run, all in seconds. time_s, step_s: simulated time at the end of the tick, its "
      "length.\n"
      "# wall_s: wall time from the end of the tick before, empty after a pause or a leap; compute_s: to "
      "compute it.\n");
  write(names);
  write("\n");
}

void StepTimesFile::on_step(const StepTime& step) {
  if (!status_) return;
  fmt::format_to(std::back_inserter(held_), "{},{},", step.now.s(), step.step.s());
  if (step.wall_s) fmt::format_to(std::back_inserter(held_), "{:.7f}", *step.wall_s);
  fmt::format_to(std::back_inserter(held_), ",{:.7f}\n", step.compute_s);
  if (held_.size() < hold_bytes) return;
  write(held_);
  held_.clear();
}

void StepTimesFile::write(std::string_view text) {
  if (status_) status_ = file_.write(text);
}

Status StepTimesFile::finish() {
  write(held_);
  held_.clear();
  if (status_) status_ = file_.commit();
  return status_;
}

Result<std::vector<StepTime>> read_step_times(std::string_view text, const std::string& file) {
  std::vector<StepTime> out;
  bool named = false;
  std::size_t number = 0;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    ++number;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty() || line.front() == '#') continue;
    const auto wrong = [&](const char* what) {
      return Error{fmt::format("{}:{}: {}", file, number, what),
                   "sandlot run --step-times FILE writes such files"};
    };
    if (!named) {
      if (line != names)
        return wrong("these are not step times: the names are not time_s,step_s,wall_s,compute_s");
      named = true;
      continue;
    }
    double numbers[4] = {};
    bool empty[4] = {};
    for (int i = 0; i < 4; ++i) {
      const std::size_t comma = line.find(',');
      if ((comma == std::string_view::npos) != (i == 3))
        return wrong("four numbers with commas between them are expected");
      const std::string_view field = line.substr(0, comma);
      line.remove_prefix(i == 3 ? line.size() : comma + 1);
      empty[i] = field.empty();
      if (empty[i] ? i != 2 : !parse_number(field, numbers[i])) return wrong("this is not a number");
      if (!(numbers[i] >= 0 && numbers[i] <= 1e9)) return wrong("times are from 0 to 1e9 s");
    }
    if (!(numbers[1] > 0)) return wrong("a tick has a length above 0");
    StepTime& step = out.emplace_back();
    step.now = Time::from_s(numbers[0]);
    step.step = Time::from_s(numbers[1]);
    if (!empty[2]) step.wall_s = numbers[2];
    step.compute_s = numbers[3];
  }
  return out;
}

}  // namespace sandlot
