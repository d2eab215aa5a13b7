/// The filter of the navigation library in a plain program, without simulator: fed from a recording, it gives the same bits as the
/// controller `estimate` did in the run.
///
///   sandlot run scenarios/vineyard_loop.yaml --headless --duration 5s --record run.mcap
///   for topic in base/odometry eyes/odometry imu/imu gps/fix estimator/odometry locator/odometry; do
///     sandlot topic echo run.mcap /mario/$topic --json > ${topic%/*}.jsonl
///   done
///   estimate_recording filters.yaml locator --program base/odometry=base.jsonl --program eyes/odometry=eyes.jsonl
///     --device imu=imu.jsonl --device gps=gps.jsonl --expect locator.jsonl > estimates.jsonl
///
/// Arguments   a file of filters, and which of them; then the messages of its sensors, by their names. A filter sees what a device has
///   measured in the same step, and what another program (`--program`) published in the next one, as a controller does.
/// Output      estimates as JSON, one a line, in the form of `sandlot topic echo --json`; at the end, on standard error, what became of the
///   messages of each sensor. With --expect, estimates are held against recorded ones.
/// Exit code   0: all went well; 1: the estimates differ from those that were expected; 2: wrong arguments or files.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <sandlot/navigation.h>

using namespace sandlot;
namespace ekf = navigation::ekf;

namespace {

constexpr Time step{10'000'000};  ///< of the scenario's control

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "error: %s\n", what.c_str());
  std::exit(2);
}

template <class T>
T or_fail(Result<T> result) {
  if (!result) fail(result.error().text());
  return std::move(result).value();
}

using Message = std::variant<msg::Odometry, msg::PoseWithCovarianceStamped, msg::TwistWithCovarianceStamped,
                             msg::Imu, msg::NavSatFix>;

/// A message of the type that a kind of sensor has.
Message message_of(ekf::SensorKind kind) {
  switch (kind) {
    case ekf::SensorKind::odometry: return msg::Odometry{};
    case ekf::SensorKind::pose: return msg::PoseWithCovarianceStamped{};
    case ekf::SensorKind::twist: return msg::TwistWithCovarianceStamped{};
    case ekf::SensorKind::imu: return msg::Imu{};
    case ekf::SensorKind::gps: return msg::NavSatFix{};
  }
  std::abort();
}

/// Reads lines {"time":0.01,"message":{...}} one by one.
class Lines {
 public:
  explicit Lines(const std::string& file) : file_(file), in_(file) {
    if (!in_) fail("cannot read '" + file + "'");
  }
  /// Reads the next message; its time, or nothing at the end.
  template <class M>
  std::optional<Time> next(M& message) {
    std::string line;
    if (!std::getline(in_, line)) return std::nullopt;
    ++number_;
    constexpr std::string_view head = "{\"time\":", middle = ",\"message\":";
    const std::size_t at = line.find(middle);
    if (line.rfind(head, 0) != 0 || at == std::string::npos || line.back() != '}')
      complain("this is not a line of `sandlot topic echo --json`");
    char* end = nullptr;
    const double time_s = std::strtod(line.c_str() + head.size(), &end);
    if (end != line.c_str() + at) complain("the time is no number");
    const std::string_view text = std::string_view(line).substr(at + middle.size());
    message = M{};
    if (const Status status = read_json(message_info<M>(), text.substr(0, text.size() - 1), &message);
        !status)
      complain(status.error().text());
    return Time::from_s(time_s);
  }

 private:
  [[noreturn]] void complain(const std::string& what) const {
    fail(file_ + ":" + std::to_string(number_) + ": " + what);
  }
  std::string file_;
  std::ifstream in_;
  int number_ = 0;
};

/// What a sensor says next, and when a filter sees it.
struct Source {
  std::size_t sensor = 0;
  Time delay;
  Lines lines;
  Message message;
  std::optional<Time> seen;

  void advance() {
    seen = std::visit([&](auto& m) { return lines.next(m); }, message);
    if (seen) *seen = *seen + delay;
  }
};

/// All numbers of an estimate.
std::vector<double> numbers_of(const msg::Odometry& m) {
  const Pose& X = m.pose.pose;
  const msg::Twist& v = m.twist.twist;
  std::vector<double> out{X.p.x,      X.p.y,      X.p.z,      X.q.w,       X.q.x,       X.q.y,      X.q.z,
                          v.linear.x, v.linear.y, v.linear.z, v.angular.x, v.angular.y, v.angular.z};
  out.insert(out.end(), m.pose.covariance.begin(), m.pose.covariance.end());
  out.insert(out.end(), m.twist.covariance.begin(), m.twist.covariance.end());
  return out;
}

bool same_bits(const msg::Odometry& a, const msg::Odometry& b) {
  const std::vector<double> x = numbers_of(a), y = numbers_of(b);
  return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](double one, double other) {
    return std::bit_cast<std::uint64_t>(one) == std::bit_cast<std::uint64_t>(other);
  });
}

/// Holds estimates against recorded ones.
class Expected {
 public:
  explicit Expected(const std::string& file) : lines_(file) { time_ = lines_.next(message_); }
  /// @param estimate  null: there is none
  void compare(Time now, const msg::Odometry* estimate) {
    const bool recorded = time_ && *time_ <= now;
    if (!recorded && !estimate) return;
    const bool same = time_ == now && estimate && same_bits(message_, *estimate);
    ++(same ? equal_ : different_);
    if (!same && !first_) first_ = now;
    if (recorded) time_ = lines_.next(message_);
  }
  bool more() const { return time_.has_value(); }
  /// Says how it went; whether all are equal.
  bool report() const {
    std::fprintf(stderr, "%ld estimates equal the recorded ones to the bit, %ld differ", equal_, different_);
    if (first_) std::fprintf(stderr, ", the first one at %.2f s", first_->s());
    std::fprintf(stderr, "\n");
    return different_ == 0 && equal_ > 0;
  }

 private:
  Lines lines_;
  msg::Odometry message_;
  std::optional<Time> time_, first_;
  long equal_ = 0, different_ = 0;
};

/// Final outcomes of the messages: "gps: 118 used, 2 gated, 1 started".
void report_outcomes(const ekf::Spec& spec, const ekf::State& state) {
  for (std::size_t i = 0; i < spec.sensors.size(); ++i) {
    std::string text;
    for (const EnumName<ekf::Outcome>& outcome : ekf::enum_names(ekf::Outcome{}))
      if (const auto count = outcome.value == ekf::Outcome::queued
                                 ? 0
                                 : state.sensors[i].counts[static_cast<std::size_t>(outcome.value)];
          count > 0)
        text += std::string(text.empty() ? "" : ", ") + std::to_string(count) + " " + outcome.name;
    std::fprintf(stderr, "%s: %s\n", spec.sensors[i].name.c_str(),
                 text.empty() ? "no messages" : text.c_str());
  }
}

[[noreturn]] void usage() {
  std::fprintf(stderr,
               "usage: estimate_recording FILTERS.yaml FILTER [--device NAME=FILE] [--program NAME=FILE] "
               "[--expect FILE]\n");
  std::exit(2);
}

ekf::Spec read_filter(const std::string& file, const std::string& name) {
  std::ifstream in(file);
  if (!in) fail("cannot read '" + file + "'");
  std::ostringstream text;
  text << in.rdbuf();
  const Node root = or_fail(parse_yaml(text.str(), file));
  const Node* const filter = root.find(name);
  if (!filter) {
    std::string known;
    if (root.is_map())
      for (const Node::Entry& each : root.entries())
        known += std::string(known.empty() ? "" : ", ") + each.key;
    fail(file + ": there is no filter '" + name + "'; known are: " + known);
  }
  return or_fail(read_spec<ekf::Spec>(*filter, "/" + name));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) usage();
  const ekf::Spec spec = read_filter(argv[1], argv[2]);
  std::vector<Source> sources;
  std::optional<Expected> expected;
  for (int i = 3; i < argc; i += 2) {
    const std::string option = argv[i], value = argv[i + 1];
    if (option == "--expect") {
      expected.emplace(value);
      continue;
    }
    const std::size_t equals = value.find('=');
    if ((option != "--device" && option != "--program") || equals == std::string::npos) usage();
    const std::string name = value.substr(0, equals);
    const std::optional<std::size_t> sensor = ekf::find_sensor(spec, name);
    if (!sensor) {
      std::string known;
      for (const auto& each : spec.sensors) known += std::string(known.empty() ? "" : ", ") + each.name;
      fail("the filter has no sensor '" + name + "'; known are: " + known);
    }
    sources.push_back({*sensor,
                       option == "--program" ? step : Time{},
                       Lines(value.substr(equals + 1)),
                       message_of(spec.sensors[*sensor].kind),
                       {}});
    sources.back().advance();
  }
  if (sources.empty()) usage();
  const auto later = [](const Source& a, const Source& b) { return a.sensor < b.sensor; };
  std::stable_sort(sources.begin(), sources.end(), later);

  ekf::State state = or_fail(ekf::begin(spec));
  msg::Odometry out;
  std::string json;
  std::vector<std::byte> bytes;
  const auto any_left = [&] {
    return std::any_of(sources.begin(), sources.end(), [](const Source& s) { return s.seen.has_value(); });
  };
  // Recordings of robots begin decades after 0; steps lie where those from 0 would.
  std::optional<Time> first;
  for (const Source& source : sources)
    if (source.seen && (!first || *source.seen < *first)) first = source.seen;
  for (Time now{first ? first->ns / step.ns * step.ns : 0}; expected ? expected->more() : any_left();
       now = now + step) {
    for (Source& source : sources)
      for (; source.seen && *source.seen <= now; source.advance())
        std::visit([&](const auto& message) { ekf::add(spec, state, source.sensor, message); },
                   source.message);
    ekf::advance(spec, state, now);
    const ekf::Estimate estimate = ekf::estimate(spec, state, now);
    if (expected && !estimate.known) expected->compare(now, nullptr);
    if (!estimate.known) continue;
    ekf::write_message(estimate, out);
    out.header.stamp = now;
    if (expected) expected->compare(now, &out);
    write_cdr(message_info<msg::Odometry>(), &out, bytes);
    if (const Status status = cdr_to_json(message_info<msg::Odometry>(), bytes, json); !status)
      fail(status.error().text());
    std::printf("{\"time\":%.9f,\"message\":%s}\n", now.s(), json.c_str());
  }
  report_outcomes(spec, state);
  return expected && !expected->report() ? 1 : 0;
}
