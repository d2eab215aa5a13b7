#include "controllers/playback/playback.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace sandlot::controllers::playback {
namespace {

constexpr double hair_s = 1e-9;  ///< times are integer nanoseconds, sample times need not be

}  // namespace

std::string samples_text(const std::vector<Sample>& samples) {
  std::string out;
  for (const Sample& s : samples) {
    for (const double x : {s.time_s, s.vx_mps, s.vy_mps, s.wz_radps}) out.append(number_text(x)).append(" ");
    out.back() = '\n';
  }
  return out;
}

Result<std::vector<Sample>> read_samples(std::string_view text) {
  std::vector<Sample> samples;
  int row = 0;
  while (!text.empty()) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    ++row;
    std::vector<double> numbers;
    while (!line.empty()) {
      const std::size_t begin = line.find_first_not_of(" \t\r,;");
      if (begin == std::string_view::npos) break;
      line.remove_prefix(begin);
      const std::string_view word = line.substr(0, line.find_first_of(" \t\r,;"));
      line.remove_prefix(word.size());
      double number = 0;
      if (!parse_number(word, number) || !std::isfinite(number) || std::abs(number) > 1e9)
        return Error{
            "row " + std::to_string(row) + ": '" + std::string(word.substr(0, 40)) + "' is not a number here",
            "a row is: time, vx, vy, wz"};
      numbers.push_back(number);
      if (numbers.size() > 4) break;
    }
    if (numbers.empty()) continue;
    if (numbers.size() != 4)
      return Error{"row " + std::to_string(row) + " has " +
                       (numbers.size() > 4 ? "more than 4" : std::to_string(numbers.size())) + " numbers",
                   "a row is: time, vx, vy, wz"};
    if (!samples.empty() && numbers[0] < samples.back().time_s)
      return Error{"row " + std::to_string(row) + " is earlier than the one above it",
                   "give the rows in order of time"};
    samples.push_back({numbers[0], numbers[1], numbers[2], numbers[3]});
  }
  return samples;
}

Status Playback::init(const Description& robot, Outputs& out) {
  if (spec.publish.empty()) {
    SL_ASSIGN(drive, robot.actuator<msg::Twist>(spec.to));
  } else if (spec.to.empty()) {
    shown = out.publish<msg::Twist>(spec.publish);
  } else {
    return Error{"both a drive and a topic are given", "leave one of them out", {}, "/publish"};
  }
  if (spec.samples.empty())
    return spec.file.empty()
               ? Error{"there is nothing to play back", "give file: run.mcap, or samples", {}, "/file"}
               : Error{"the recording '" + spec.file + "' was not read",
                       "load the scenario by record::load_with_playbacks, as load_simulation does",
                       {},
                       "/file"};
  auto read = read_samples(spec.samples);
  if (!read) {
    read.error().path = "/samples";
    return std::move(read.error());
  }
  samples = std::move(*read);
  if (samples.empty()) return Error{"there are no samples", "a row is: time, vx, vy, wz", {}, "/samples"};
  if (spec.loop && !(samples.back().time_s > 0))
    return Error{"a recording of no length cannot be repeated", "leave out loop", {}, "/loop"};
  return {};
}

void Playback::step(const Observation& obs, Command& cmd) {
  msg::Twist twist;
  const double last_s = samples.back().time_s;
  double at_s = (obs.now().s() - spec.start_s) * spec.rate + hair_s;
  if (spec.loop && at_s >= last_s) at_s -= last_s * std::floor(at_s / last_s);
  const auto after = std::upper_bound(samples.begin(), samples.end(), at_s,
                                      [](double t, const Sample& s) { return t < s.time_s; });
  // The last sample ends the recording: nobody knows for how long it was meant.
  if (after != samples.begin() && after != samples.end()) {
    const Sample& held = *(after - 1);
    twist.linear.x = held.vx_mps;
    twist.linear.y = held.vy_mps;
    twist.angular.z = held.wz_radps;
  }
  if (shown) cmd.publish(*shown, twist);
  else cmd.set(drive, twist);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Playback>({
    .name = "playback",
    .help = "Replays the motion of a robot from a recording.",
});

}  // namespace sandlot::controllers::playback
