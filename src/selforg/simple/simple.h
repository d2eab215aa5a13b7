#pragma once
/// Controllers without learning: sine, babbling, braitenberg, replay. References to compare with, and sources of motor values.
///
/// Source   facts/lpzrobots.md sections 1 and 7 for defaults; V. Braitenberg: Vehicles (1984).
#include "selforg/controller.h"

namespace sandlot::selforg {

/// Sine: all motors oscillate with one period, each later than the one before it by phaseshift quarter turns.
///
/// y_i = amplitude * shape(t / period - i * phaseshift / 4), the argument in turns.
struct Sine {
  enum class Shape : std::uint8_t { sine, saw, impulse };
  struct Spec {
    double period = 50, phaseshift = 1, amplitude = 1, impulswidth = 0.5;
    Shape shape = Shape::sine;
    static void fields(auto& s, auto&& visit) {
      constexpr unsigned tunable = Field::tunable;
      visit(Field{"period", "1", "Steps of a period; a new one goes on from the phase of now.", 1, 1e9,
                  tunable},
            s.period);
      visit(Field{"phaseshift", "1", "Quarter turns of each motor behind the one before it.", -1e3, 1e3,
                  tunable},
            s.phaseshift);
      visit(Field{"amplitude", "1", "Amplitude of all motors.", 0, 1, tunable}, s.amplitude);
      visit(Field{"impulswidth", "1", "Share of a period that an impulse is up.", 0, 1, tunable},
            s.impulswidth);
      visit(Field{"shape", "", "Shape of the motion.", 0, 0, tunable}, s.shape);
    }
  };
  struct State {
    double phase = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"phase", "1", "Turns of the first motor's phase."}, s.phase);
    }
  };
  Spec spec;
  State state;
  Status init(const Setup&) { return {}; }
  void step(const Matrix& x, Matrix& y, Mode mode);
};

/// Babbling: sines with random periods, drawn again every `resample` steps.
struct Babbling {
  struct Spec {
    double period_min = 50, period_max = 250, amplitude = 1;
    int resample = 500;
    Status check(const Node& node, const std::string& path) const;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"period_min", "1", "Steps of the shortest period.", 2, 1e9}, s.period_min);
      visit(Field{"period_max", "1", "Steps of the longest period.", 2, 1e9}, s.period_max);
      visit(Field{"amplitude", "1", "Amplitude of all motors.", 0, 1, Field::tunable}, s.amplitude);
      visit(Field{"resample", "1", "Steps from one draw of the periods to the next.", 1, 1e9}, s.resample);
    }
  };
  struct State {
    std::uint64_t t = 0;
    Matrix phase, period;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"t", "1", "Steps so far."}, s.t);
      visit(Field{"phase", "1", "Turns of each motor's phase."}, s.phase);
      visit(Field{"period", "1", "Steps of each motor's period."}, s.period);
    }
  };
  Spec spec;
  State state;
  Status init(const Setup& setup);
  void step(const Matrix& x, Matrix& y, Mode mode);

 private:
  Setup setup_;
};

/// Braitenberg: motors are weighted sums of sensors, y = clip(W x + bias). Vehicles of two motors and two sensors by name.
///
/// aggressive  each wheel is driven by the sensor of the other side: it turns to the source and hits it.
/// cowardly    each wheel is driven by the sensor of its side: it turns away.
struct Braitenberg {
  enum class Type : std::uint8_t { aggressive, cowardly, custom };
  struct Spec {
    Type type = Type::aggressive;
    int left = 0, right = 1;
    double gain = 1;
    std::vector<double> weights, biases;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"type", "", "Vehicle, or `custom` for weights of its own."}, s.type);
      visit(Field{"left", "1", "Index of the left sensor of a vehicle.", 0, 10'000}, s.left);
      visit(Field{"right", "1", "Index of the right sensor of a vehicle.", 0, 10'000}, s.right);
      visit(Field{"gain", "1", "Factor on all weights.", -100, 100, Field::tunable}, s.gain);
      visit(Field{"weights", "1", "Weights of `custom`, motor after motor.", -1e3, 1e3}, s.weights);
      visit(Field{"biases", "1", "Motor values without stimulus, one per motor; empty: zero.", -1, 1},
            s.biases);
    }
  };
  using State = NoFields;
  Spec spec;
  State state;
  Status init(const Setup& setup);
  void step(const Matrix& x, Matrix& y, Mode mode);

 private:
  Matrix weights_, biases_;
};

/// Replay: motor values of a log file (selforg/log_file.h), one line per step.
struct Replay {
  enum class End : std::uint8_t { hold, loop, zero };
  struct Spec {
    std::string file;
    End end = End::hold;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"file", "", "Log file with the columns y[0], y[1] ...", 0, 0, Field::required, 4096, 1},
            s.file);
      visit(Field{"end", "", "What follows the last line: its values, the first line again, or zeros."},
            s.end);
    }
  };
  struct State {
    std::uint64_t line = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"line", "1", "Index of the next line."}, s.line);
    }
  };
  Spec spec;
  State state;
  Status init(const Setup& setup);
  void step(const Matrix& x, Matrix& y, Mode mode);

 private:
  Matrix recording_;  ///< a column per line of the file
};

inline std::span<const EnumName<Sine::Shape>> enum_names(Sine::Shape) {
  using E = Sine::Shape;
  static constexpr EnumName<E> names[] = {{"sine", E::sine}, {"saw", E::saw}, {"impulse", E::impulse}};
  return names;
}
inline std::span<const EnumName<Braitenberg::Type>> enum_names(Braitenberg::Type) {
  using E = Braitenberg::Type;
  static constexpr EnumName<E> names[] = {
      {"aggressive", E::aggressive}, {"cowardly", E::cowardly}, {"custom", E::custom}};
  return names;
}
inline std::span<const EnumName<Replay::End>> enum_names(Replay::End) {
  using E = Replay::End;
  static constexpr EnumName<E> names[] = {{"hold", E::hold}, {"loop", E::loop}, {"zero", E::zero}};
  return names;
}

}  // namespace sandlot::selforg
