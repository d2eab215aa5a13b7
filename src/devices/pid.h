#pragma once
/// PID controller with a limited output and back-calculation against wind-up.
///
///   u* = p e + I - d dy/dt      u = clamp(u*, -limit, limit)
///   I += h (i e + (u - u*) / T)
///
/// The derivative acts on the measurement y alone, so that a step of the reference gives no kick. While the
/// output is limited, the last term drives I to where u* just reaches the limit, with time constant T; for h
/// > T it does so in one step.
///
/// Units    e, y in the controlled unit U; u, limit, I in the output's unit V.
/// Errors   none at run time: gains are validated once, when they are read.
/// Cost     a dozen operations.
/// Source   K. J. Astrom, T. Hagglund, PID Controllers: Theory, Design, and Tuning, 2nd ed. (1995), sec. 3.4
///          (set-point weighting, derivative on the measurement) and sec. 3.5 (back-calculation).
/// Not modelled   filtered derivative: the simulator's joint speed carries no noise.
#include <algorithm>

#include "base/fields.h"

namespace sandlot {

struct Gains {
  double p = 0;                ///< [V/U]
  double i = 0;                ///< [V/(U s)]
  double d = 0;                ///< [V s/U]
  double anti_windup_s = 0.1;  ///< T

  static void fields(auto& s, auto&& visit) {
    visit(Field{"p", "", "Proportional gain, effort per unit of error.", 0, 1e9, Field::tunable}, s.p);
    visit(Field{"i", "", "Integral gain, effort per unit of error and second.", 0, 1e9, Field::tunable}, s.i);
    visit(Field{"d", "", "Derivative gain, effort per unit of error per second.", 0, 1e9, Field::tunable},
          s.d);
    visit(Field{"anti_windup", "s", "Time constant that unwinds the integral while the output is limited.",
                1e-6, 1e6, Field::tunable},
          s.anti_windup_s);
  }
};

struct Pid {
  double integral = 0;  ///< [V]

  static void fields(auto& s, auto&& visit) {
    visit(Field{"integral", "", "Integral part of the output."}, s.integral);
  }

  /// @param error  [U] reference - measurement
  /// @param rate   [U/s] of the measurement
  /// @param h_s    [s] since the previous call, > 0
  double step(const Gains& g, double error, double rate, double limit, double h_s) {
    const double wanted = g.p * error + integral - g.d * rate;
    const double output = std::clamp(wanted, -limit, limit);
    integral += h_s * g.i * error + std::min(1.0, h_s / g.anti_windup_s) * (output - wanted);
    return output;
  }
};

}  // namespace sandlot
