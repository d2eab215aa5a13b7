#pragma once
/// Common keys of devices, in addition to those of their kind and to those of sim/world/faults.h:
///
///   mass: 160 g                 # of the device itself, added to its link
///   max_rate: 20 Hz             # activations per second; more are refused and counted
///   delay: 50 ms                # from a command to its effect, from a measurement to its message
///   command_errors: {linear: [{proportional: {std: 5 %}}, {lag: {time_constant: 0.1 s}}], angular: [...]}
///   errors: 0.5                 # factor on command_errors and delay, of kinds that have no such key themselves
///   on_request: true            # samples are taken when a program asks for them, and not at the rate
///   drain: 0.5 W                # drawn from the battery of its robot all the time
///   drain_per_use: 0.2 J        # drawn per activation in addition
///   efficiency: 60 %            # of a drive or motor without a model of its current: mechanical work per energy drawn
///   rolling_resistance: 0.02    # of a drive on rails: force per weight
///
/// mass      A point mass at the device's place on its link, before the engine makes the robot: the link's centre of mass
///           moves, its inertia grows by the parallel-axis theorem. Fixed from then on: a device with a mass is neither
///           loaded nor unloaded while the world runs.
/// max_rate  Two commands that a device takes lie at least 1 / max_rate apart, whatever their type; so do a requested sample
///           and the sample before it. Commands of people, programs and other devices count alike.
/// delay     d = e delay, e the product of all factors on errors. A command of the tick at t acts in the first tick at or
///           after t + d; a message measured at t is published at the end of the first tick at or after t + d, with the time
///           of its measurement in its header. Nothing overtakes anything. What a device has on the way is lost when it fails
///           (a command: stuck or dead; a message: dead), and a command when its level is off meanwhile.
/// on_request
///           A device that senses takes a sample when one is requested, and then only. Viewers may look through it at its
///           rate (DevicePools::look_through), which is no sample. Fixed.
/// command_errors
///           A chain of stages (noise/chain.h) per quantity of the commands; each component of a quantity (x, y, a joint) is a
///           channel of its own. In every tick the chains make what the device follows of the latest command, with dt the
///           length of the tick. Before the first command speeds, efforts, voltages and duty cycles begin at 0; positions
///           begin with the first command. A switch to a level that takes the same quantities keeps the command.
/// drain     Drawn as long as the device is not dead, in every tick. What the battery cannot deliver is counted
///           (devices/energy.h), and does not stop the device: the rule `energy` does.
/// drain_per_use
///           Per command that the device takes, of kinds whose levels take commands; per sample that it takes, of all others.
///           A command counts when it is taken, even if it is on its way for a while yet. A dead device takes no samples.
/// efficiency, rolling_resistance
///           See devices/energy.h.
/// Random    Stream(seed, device, Purpose::actuation, tick).
/// Limits    the components of a joint command are counted by place: orders of several commands that name joints in another
///           order exchange channels. At most most_held commands or messages of a device are on the way, at most
///           most_held_bytes of them; more are refused and counted.
/// Errors    a rate above max_rate (of devices without commands), keys without effect on the device, quantities that its
///           commands do not have, a drain on a robot without a battery.
/// State     of devices with such keys: tunable keys, what is on the way, the latest command, chains, refusals.
/// Cost      nothing for devices without such keys; delayed messages are copied twice, and hashed while they are on the way.
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/random.h"
#include "noise/chain.h"
#include "sim/world/parts.h"

namespace sandlot {

/// What the numbers of a command mean.
enum class Quantity : std::uint8_t { linear, angular, position, velocity, effort, voltage, pwm };
inline constexpr std::size_t quantity_count = 7;
inline constexpr std::array<const char*, quantity_count> quantity_names{
    "linear", "angular", "position", "velocity", "effort", "voltage", "pwm"};

struct CommandErrorsSpec {
  std::array<ChainSpec, quantity_count> of;  ///< by Quantity

  static void fields(auto& s, auto&& visit) {
    const auto at = [&](Quantity q) -> auto& { return s.of[static_cast<std::size_t>(q)]; };
    visit(Field{"linear", "m/s", "Errors of commanded speeds along x and along y."}, at(Quantity::linear));
    visit(Field{"angular", "rad/s", "Errors of the commanded turning rate."}, at(Quantity::angular));
    visit(Field{"position", "rad", "Errors of commanded angles, or of positions [m] of sliding joints."},
          at(Quantity::position));
    visit(
        Field{"velocity", "rad/s", "Errors of commanded speeds of wheels and joints; sliding joints: [m/s]."},
        at(Quantity::velocity));
    visit(Field{"effort", "Nm", "Errors of commanded torques, or of forces [N] of sliding joints."},
          at(Quantity::effort));
    visit(Field{"voltage", "V", "Errors of commanded voltages."}, at(Quantity::voltage));
    visit(Field{"pwm", "1", "Errors of commanded duty cycles."}, at(Quantity::pwm));
  }
};

struct DeviceKeysSpec {
  double mass_kg = 0, max_rate_hz = 0, delay_s = 0;
  std::optional<CommandErrorsSpec> command_errors;
  bool on_request = false;
  double errors = 1;  ///< of kinds that have no such key themselves
  EnergyMeter::Rates energy;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"mass", "kg", "Mass of the device, added to its link as a point mass.", 0, 1e6}, s.mass_kg);
    visit(Field{"max_rate", "Hz", "Most commands or requested samples per second; 0: no limit.", 0, 1e6,
                Field::tunable},
          s.max_rate_hz);
    visit(Field{"delay", "s", "Time from a command to its effect, and from a measurement to its message.", 0,
                1e3, Field::tunable},
          s.delay_s);
    visit(Field{"command_errors", "", "Errors of what the device makes of its commands."}, s.command_errors);
    visit(Field{"on_request", "",
                "Whether it takes samples when they are requested alone, and none at its rate."},
          s.on_request);
    visit(errors_field, s.errors);
    EnergyMeter::Rates::fields(s.energy, visit);
  }
};

struct DeviceKeysState {
  std::uint64_t refused = 0;
  Time accepted{-1};  ///< of the latest command; negative: none

  static void fields(auto& s, auto&& visit) {
    visit(Field{"refused", "1", "Commands and requested samples refused."}, s.refused);
    visit(Field{"accepted", "s", "Time of the latest accepted command; negative: none."}, s.accepted);
  }
};

/// One device's keys, and what they have on the way.
class DeviceKeys {
 public:
  static constexpr std::size_t most_held = 4096, most_held_bytes = std::size_t{1} << 28;
  using Device = SimulationParts::Device;
  using Slot = SimulationParts::Slot;

  DeviceKeysSpec spec;
  DeviceKeysState state;
  std::vector<std::pair<std::string, Place>> places;  ///< of the keys that were written

  /// Judges the keys by the device they were given to, and makes ready. @param sample_hz  0: none, or one per tick
  Status begin(Device& device, const Kind& kind, double sample_hz, bool samples, std::size_t joints,
               std::uint64_t seed);

  /// Whether there is nothing to remember of them once the device is there.
  bool only_on_request() const { return places.size() == 1 && places.front().first == "on_request"; }
  /// Whether commands or messages do not simply pass.
  bool act() const {
    return spec.max_rate_hz > 0 || spec.delay_s > 0 || spec.command_errors || !commands_.empty() ||
           !messages_.empty();
  }
  /// Takes a command for a slot of the device: now, or on its way.
  /// @param explain  false: errors without text
  Status take_command(Device& device, std::size_t slot, std::span<const std::byte> bytes, Time now,
                      double all_errors, bool explain);
  /// Whether a sample may be taken at `at`; counted when not.
  Status take_request(const Device& device, Time at, Time last, bool first);
  void count_refused() { ++state.refused; }
  /// The latest command accepted for a slot, on its way or not; null: none.
  const TopicBase* latest_command(const Device& device, std::size_t slot) const;

  struct Turn {
    Time begin, length;  ///< of the tick
    std::uint64_t tick = 0, seed = 0;
    double errors = 1;  ///< all factors together
  };
  /// Before the actuate phase: commands that arrive, then errors of the latest.
  void prepare_commands(Device& device, const Turn& turn, bool takes_commands);

  /// Around the sense phase of a device whose sample is due: keeps its messages of before, and takes back new ones.
  void remember_messages(const Device& device);
  void hold_back_messages(Device& device, Time now, double all_errors);
  /// Publishes the messages that arrive now. @param dead  they are lost
  void publish_messages(Device& device, Time now, bool dead);
  bool delays_messages() const { return spec.delay_s > 0 || !messages_.empty(); }

  void save(const Device& device, ByteWriter& w) const;
  /// @param fits  whether the device can go on with the messages that its topics hold now
  bool load(Device& device, ByteReader& r, Time now, const std::function<bool()>& fits);

 private:
  struct Held {
    Time due;
    std::uint32_t slot = 0;
    std::vector<std::byte> bytes;
  };
  bool is_active(const Device& device, const Slot& slot) const {
    return slot.level >= levels_ || (device.levels >> slot.level & 1);
  }
  bool hold(std::vector<Held>& line, Time due, std::size_t slot, std::span<const std::byte> bytes);
  void drop_first(std::vector<Held>& line);
  Status apply(Device& device, std::size_t slot, std::span<const std::byte> bytes, Time now);
  void corrupt_command(Device& device, const Turn& turn);
  Slot* target_of(Device& device, std::size_t slot) const;
  bool load_line(std::vector<Held>& line, ByteReader& r, std::size_t slots);
  template <class Report>
  Status begin_energy(const Device& device, const Kind& kind, Report&& error) const;

  std::size_t levels_ = 0;
  std::vector<Held> commands_, messages_, spare_;
  std::size_t held_bytes_ = 0;
  std::vector<std::unique_ptr<TopicBase>> before_;          ///< per topic: scratch of a sample
  mutable std::vector<std::unique_ptr<TopicBase>> newest_;  ///< per slot: scratch of latest_command()
  ByteWriter scratch_;

  // Errors of commands:
  std::vector<std::unique_ptr<TopicBase>> ordered_;  ///< per slot: its latest command, as it was given
  std::uint32_t latest_ = 0;                         ///< index + 1 of the slot with the latest command
  std::array<std::vector<ChannelChain>, quantity_count> chains_;  ///< per component
};

/// Whether a command slot is a queue without room.
inline bool is_full(const TopicBase& slot) {
  return slot.queue_limit() > 0 && slot.waiting() >= slot.queue_limit();
}

/// Takes the keys above out of the keys of a device. Null: it has none of them.
Result<std::unique_ptr<DeviceKeys>> take_device_keys(Node& config, bool kind_has_errors);

/// Whether a parameter belongs to the common keys: "delay", "command_errors/linear/stages/0/gaussian/std".
bool is_device_key(std::string_view field, bool kind_has_errors);
/// Sets one while the run goes on.
Status set_device_key(SimulationParts::Device& device, std::string_view field, const Node& value);

/// Descriptions of the keys that a device of this kind may have.
std::vector<FieldInfo> device_key_fields(const Kind& kind);

struct PointMass {
  std::uint32_t link = 0;
  double mass_kg = 0;
  Vec3 point_L;
  friend bool operator==(const PointMass&, const PointMass&) = default;
};
/// The masses that an instance's devices declare, presets included.
/// Errors   masses on something that is not moved by forces; what is not a mass.
/// @param kind_of  the kind of a name; null: there is none
Result<std::vector<PointMass>> masses_of_devices(const model::Instance& instance,
                                                 const std::function<const Kind*(std::string_view)>& kind_of);
std::shared_ptr<const model::Model> model_with_masses(const model::Model& model,
                                                      std::span<const PointMass> masses);

}  // namespace sandlot
