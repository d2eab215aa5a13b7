#pragma once
/// Sine: moves motors back and forth, each a little later than the one before: creatures that walk, crawl and roll blindly.
///
/// Reads    nothing.
/// Orders   a Float64 to each of its motors in every control step: offset + amplitude * shape(phase). The motor's level
///          decides what it means (angle, length, speed, effort).
/// Phase    of motor i: t / period - i * phase_shift - phases[i]. `phases` and `phase_shift` are angles, 0 to one turn: a
///          motor with a larger one comes later. The time starts with the controller.
/// Shapes   `sine`; `triangle`; `pulse`: +1 for the share `width` of a period from phase 0, -1 for the rest.
/// Tunable  period, amplitude, phase_shift and width: a new period goes on from the phase of now, without a jump.
/// Cost     one sine per motor and step.
/// Errors   a motor that is not there or takes no Float64; a robot without any; lists that are not as long as the motors.
/// Source   the idea is LpzRobots' sine controller: period of 50 steps of 10 ms, amplitude 1.
#include "base/math.h"
#include "control/controller.h"

namespace sandlot::controllers::sine {

enum class Shape : std::uint8_t { sine, triangle, pulse };
inline std::span<const EnumName<Shape>> enum_names(Shape) {
  static constexpr EnumName<Shape> names[] = {
      {"sine", Shape::sine}, {"triangle", Shape::triangle}, {"pulse", Shape::pulse}};
  return names;
}

struct Spec {
  std::vector<std::string> motors;
  Shape shape = Shape::sine;
  double period_s = 0.5;
  double amplitude = 1;
  double phase_shift_rad = math::pi / 2;
  double width = 0.5;
  std::vector<double> amplitudes, offsets, phases_rad;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"motors", "", "Devices that take a number, in order; none: all of the robot.", 0, 0,
                Field::none, 10'000},
          s.motors);
    visit(Field{"shape", "", "Shape of the motion over time."}, s.shape);
    visit(Field{"period", "s", "Period of the motion.", 1e-3, 1e6, tunable}, s.period_s);
    visit(Field{"amplitude", "", "Amplitude of all motors, in the unit of their commands: rad, m, rad/s, ...",
                -1e6, 1e6, tunable},
          s.amplitude);
    visit(
        Field{"phase_shift", "rad", "Phase lag of each motor behind the one before it.", -1e4, 1e4, tunable},
        s.phase_shift_rad);
    visit(Field{"width", "1", "Share of the period that a pulse is up.", 0, 1, tunable}, s.width);
    visit(Field{"amplitudes", "", "Factor on the amplitude, one per motor.", -1e6, 1e6}, s.amplitudes);
    visit(Field{"offsets", "", "Middle of the motion, one per motor.", -1e6, 1e6}, s.offsets);
    visit(Field{"phases", "rad", "Additional phase lag, one per motor.", -1e4, 1e4}, s.phases_rad);
  }
};

struct State {
  double phase = 0;  ///< [turns] of the first motor
  Time last;         ///< when it was
  bool started = false;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"phase", "1", "Turns of the first motor's phase."}, s.phase);
    visit(Field{"last", "ns", "Time of the previous step."}, s.last);
    visit(Field{"started", "", "Whether there was a previous step."}, s.started);
  }
};

struct Sine {
  using Spec = sine::Spec;
  using State = sine::State;
  Spec spec;
  State state;
  std::vector<Actuator<msg::Float64>> motors;

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);
};

}  // namespace sandlot::controllers::sine
