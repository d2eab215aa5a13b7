#pragma once
/// Faults of a device as a whole: failures at planned times or by order, and a clock that is wrong. Keys of any device in
/// addition to those of its kind:
///
///   failures: [{kind: stuck, from: 3 s, until: 5 s}, {kind: dead, from: 8 s}, {kind: noisy, from: 1 s, until: 2 s, factor: 10}]
///   clock: {offset: 20 ms, drift: 50e-6, jitter: 1 ms}
///
/// stuck   What it publishes is its last message from before, again and again, with the time of each sample: a driver that
///         reads a sensor which no longer measures. Nothing is published if there was no message before. An actuator
///         goes on with its last command; new ones are refused.
/// dead    It publishes nothing and takes no commands. An actuator exerts nothing.
/// noisy   Its errors, those of its commands included, are `factor` times as large: as if its key `errors` were.
///
/// By order while the run goes on: the parameter `failure` of the device, whatever its kind, is stuck, dead, noisy or
/// {kind: noisy, factor: 5}; `none` is not a failure even if one is planned, `planned` follows the key `failures`. An order
/// holds until the next one.
///
/// Inside the device life goes on: its samples are counted, its biases drift, so that it is as it would have been once a
/// failure is over, and no other number in the run changes. A failure lasts from the tick at `from` to the one before
/// `until`; dead has precedence over stuck, and the factors of several noisy ones multiply.
///
/// clock   The time in the header of a message of the time t is t + e (offset + drift t + jitter n), never below 0, with
///         n ~ Normal(0, 1) drawn per sample and the factor e of `errors`. When the sample was taken stays as it is, and so
///         do files, viewers and everything that knows messages by the time of their tick.
///
/// What is planned follows from the declaration and the time; an order is State.
#include <memory>
#include <optional>
#include <vector>

#include "base/random.h"
#include "base/read.h"
#include "base/time.h"
#include "messages/topic.h"
#include "sim/world/parts.h"

namespace sandlot {

struct FailureSpec {
  enum class Kind : std::uint8_t { stuck, dead, noisy } kind = Kind::stuck;
  double from_s = 0, until_s = 1e9, factor = 10;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"kind", "", "Kind of the failure.", 0, 0, Field::required}, s.kind);
    visit(Field{"from", "s", "Time at which the failure begins.", 0, 1e9}, s.from_s);
    visit(Field{"until", "s", "Time at which the failure ends.", 0, 1e9}, s.until_s);
    visit(Field{"factor", "1", "Factor on the errors of a noisy device.", 0, 1000}, s.factor);
  }
  Status check(const Node& node, const std::string& path) const;
};
inline std::span<const EnumName<FailureSpec::Kind>> enum_names(FailureSpec::Kind) {
  static constexpr EnumName<FailureSpec::Kind> names[] = {{"stuck", FailureSpec::Kind::stuck},
                                                          {"dead", FailureSpec::Kind::dead},
                                                          {"noisy", FailureSpec::Kind::noisy}};
  return names;
}

/// What somebody orders while the run goes on.
struct FailureOrder {
  enum class Kind : std::uint8_t { planned, none, stuck, dead, noisy } kind = Kind::planned;
  double factor = 10;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"kind", "", "Kind of the failure.", 0, 0, Field::required}, s.kind);
    visit(Field{"factor", "1", "Factor on the errors of a noisy device.", 0, 1000}, s.factor);
  }
};
inline std::span<const EnumName<FailureOrder::Kind>> enum_names(FailureOrder::Kind) {
  static constexpr EnumName<FailureOrder::Kind> names[] = {{"planned", FailureOrder::Kind::planned},
                                                           {"none", FailureOrder::Kind::none},
                                                           {"stuck", FailureOrder::Kind::stuck},
                                                           {"dead", FailureOrder::Kind::dead},
                                                           {"noisy", FailureOrder::Kind::noisy}};
  return names;
}
inline constexpr const char* failure_field = "failure";
/// From the name of a kind, or a map with a factor.
Result<FailureOrder> read_failure_order(const Node& value);

struct ClockSpec {
  double offset_s = 0, drift = 0, jitter_s = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"offset", "s", "Lead of the clock at the start of the run.", -1e6, 1e6}, s.offset_s);
    visit(Field{"drift", "1", "Seconds gained per second: 20e-6 are 20 ppm.", -0.5, 0.5}, s.drift);
    visit(Field{"jitter", "s", "Standard deviation of a further error of each message.", 0, 1e3}, s.jitter_s);
  }
};

struct FaultsSpec {
  std::vector<FailureSpec> failures;
  std::optional<ClockSpec> clock;

  static void fields(auto& s, auto&& visit) {
    visit(
        Field{"failures", "", "Times in which the device is stuck, dead or noisy.", 0, 0, Field::none, 1000},
        s.failures);
    visit(Field{"clock", "", "Errors of the times in the device's messages."}, s.clock);
  }
};

/// The failures of a device at a time.
struct Failing {
  bool stuck = false, dead = false;
  double factor = 1;  ///< on its errors
};
Failing failing_at(const FaultsSpec& spec, Time now);

/// What its clock shows at `now`.
/// @param random  stream of the device for this sample, Purpose::noise; its position does not matter
Time clock_at(const ClockSpec& spec, Time now, double errors, const Stream& random);

/// Of one device: its spec, what was ordered, and where its messages of before wait while it takes a sample.
struct Faults {
  FaultsSpec spec;
  std::vector<std::unique_ptr<TopicBase>> before;  ///< per topic; used again
  Place clock_place;
  FailureOrder order{};

  Failing at(Time now) const;
  /// Nothing is planned, ordered or wrong with its clock.
  bool idle() const;
  Status check(std::span<SimulationParts::Slot> topics) const;
};

inline bool is_ordered(const SimulationParts::Device& device) {
  return device.faults && device.faults->order.kind != FailureOrder::Kind::planned;
}
/// @param faulty  how many devices of the pool have faults
Status order_failure(SimulationParts::Device& device, bool has_errors, std::uint32_t& faulty,
                     const FailureOrder& order);

/// Takes the keys above out of the keys of a device of this kind. Null: it has none of them.
Result<std::unique_ptr<Faults>> take_faults(Node& config, bool has_errors, std::string_view kind);

}  // namespace sandlot
