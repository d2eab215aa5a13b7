#pragma once
/// Wiring: what lies between a robot's values and those of its controller, in both directions.
///
/// Four sizes: sensors and motors of the robot and of the controller. A sequence applies its parts to the sensors from first to
/// last, to the motors from last to first.
///
/// one_to_one   the same values, with noise on the sensors.
/// selective    some of the sensors and motors, by index; motors that are left out get zero.
/// derivative   sensors, their change per step and the change of that, each if chosen, times a factor.
/// feedback     the controller's last motor values as further sensors, times a factor.
/// motor_noise  noise on the motors, clipped to [-1, 1].
///
/// Noise     none, uniform within +-1, normal, or coloured: a low-pass of these over `tau` steps with the same variance. Its
///           strength is that of the kind times the factor given per step.
#include "selforg/controller.h"

namespace sandlot::selforg {

enum class NoiseKind : std::uint8_t {
  none,
  white_uniform,
  white_normal,
  colour_uniform,
  colour_normal,
  sine_white
};
inline std::span<const EnumName<NoiseKind>> enum_names(NoiseKind) {
  using E = NoiseKind;
  static constexpr EnumName<E> names[] = {{"none", E::none},
                                          {"white_uniform", E::white_uniform},
                                          {"white_normal", E::white_normal},
                                          {"colour_uniform", E::colour_uniform},
                                          {"colour_normal", E::colour_normal},
                                          {"sine_white", E::sine_white}};
  return names;
}

/// Noise of a list of values: a function of seed, name and step.
struct Noise {
  struct Spec {
    NoiseKind kind = NoiseKind::white_normal;
    double strength = 1, tau = 10, period = 50;
    static void fields(auto& s, auto&& visit) {
      constexpr unsigned tunable = Field::tunable;
      visit(Field{"kind", "", "Distribution and colour; sine_white: white noise on a sine.", 0, 0, tunable},
            s.kind);
      visit(Field{"strength", "1", "Half width or standard deviation.", 0, 100, tunable}, s.strength);
      visit(Field{"tau", "1", "Steps over which coloured noise is correlated.", 1, 1e6, tunable}, s.tau);
      visit(Field{"period", "1", "Steps of a period of the sine.", 1, 1e6, tunable}, s.period);
    }
  };
  struct State {
    std::uint64_t t = 0;
    Matrix colour, value;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"t", "1", "Steps so far."}, s.t);
      visit(Field{"colour", "1", "Low-pass of the noise."}, s.colour);
      visit(Field{"value", "1", "Noise of the last step."}, s.value);
    }
  };
  void init(const Setup& setup, std::size_t size, std::uint64_t use);
  /// Draws state.value.
  void draw(const Spec& spec, State& state, double factor) const;
  State fresh() const;

 private:
  Setup setup_;
  std::size_t size_ = 0;
  std::uint64_t use_ = 0;
};

class Wiring : public Element {
 public:
  virtual const char* kind() const = 0;
  /// @param robot  the robot's sizes  @return an error where the wiring does not fit them
  virtual Status init(const Node& parameters, const Setup& robot) = 0;
  /// Sizes towards the controller; after init().
  virtual std::size_t controller_sensors() const = 0;
  virtual std::size_t controller_motors() const = 0;
  std::size_t robot_sensors() const { return robot_.sensors; }
  std::size_t robot_motors() const { return robot_.motors; }
  /// Once per step, before the controller. @param noise  factor on the strength of noise on sensors
  virtual void wire_sensors(std::span<const double> robot, std::span<double> controller, double noise) = 0;
  /// Once per step, after the controller.
  virtual void wire_motors(std::span<const double> controller, std::span<double> robot, double noise) = 0;
  virtual void channels(const ChannelVisit& visit) const = 0;
  /// The tunable parameters alone, for another object of the same kind.
  virtual void save_parameters(ByteWriter& w) const = 0;
  virtual void load_parameters(ByteReader& r) = 0;

 protected:
  Setup robot_;
};

struct WiringKind {
  const char* name;
  const char* help;
  std::unique_ptr<Wiring> (*create)() = nullptr;
};
std::span<const WiringKind> wiring_kinds();
Result<std::unique_ptr<Wiring>> make_wiring(std::string_view kind, const Setup& robot,
                                            const Node& parameters = {});
/// Sequence of wirings. @param parts  from the robot to the controller; each made with the sizes that the one before it gives
Result<std::unique_ptr<Wiring>> make_sequence(std::vector<std::unique_ptr<Wiring>> parts);

}  // namespace sandlot::selforg
