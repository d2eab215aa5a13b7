#pragma once
/// DEP: differential extrinsic plasticity, a rule without world model and errors: the velocities of the sensors are correlated
/// over time, and the controller repeats the correlations it finds.
///
/// Reads      sensors x, smoothed by s4avg.
/// Orders     motors y = tanh(synboost C x / (|C| + 10^-regularization) + h), with |C| the Frobenius norm of C or, with indnorm,
///            of each motor's row.
/// Learns     C += urate ((M dx(t)) dx(t - timedist)^T - C), h -= epsh y, where dx(t) = x(t) - x(t-1) and M is the inverse
///            model, here one-to-one.
/// Source     R. Der, G. Martius: Novel plasticity rule can explain the development of sensorimotor intelligence, PNAS 112
///            (2015). Defaults as of facts/lpzrobots.md section 7; its learned inverse model (epsC) is not part of this one.
#include "selforg/controller.h"

namespace sandlot::selforg {

struct Dep {
  struct Spec {
    double epsh = 0.1, urate = 0.1, synboost = 5, regularization = 12, s4avg = 1;
    int timedist = 1;
    bool indnorm = true;
    static void fields(auto& s, auto&& visit) {
      constexpr unsigned tunable = Field::tunable;
      visit(Field{"epsh", "1", "Learning rate of the bias h.", 0, 1, tunable}, s.epsh);
      visit(Field{"urate", "1", "Rate at which C follows the correlations.", 0, 1, tunable}, s.urate);
      visit(Field{"synboost", "1", "Gain after normalisation.", 0, 100, tunable}, s.synboost);
      visit(Field{"timedist", "1", "Steps between the correlated velocities.", 1, 20, tunable}, s.timedist);
      visit(Field{"indnorm", "", "Normalisation per motor instead of over all.", 0, 0, tunable}, s.indnorm);
      visit(
          Field{"regularization", "1", "Exponent n of the 10^-n that is added to the norm.", 0, 100, tunable},
          s.regularization);
      visit(Field{"s4avg", "1", "Steps over which sensor values are smoothed.", 1, 1e6, tunable}, s.s4avg);
    }
  };
  static constexpr std::size_t buffer = 32;
  struct State {
    std::uint64_t t = 0;
    Matrix C, h, x, y;
    std::vector<Matrix> velocities;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"t", "1", "Steps so far."}, s.t);
      visit(Field{"x", "1", "Smoothed sensor values."}, s.x);
      visit(Field{"y", "1", "Motor values."}, s.y);
      visit(Field{"C", "1", "Correlations, before normalisation."}, s.C);
      visit(Field{"h", "1", "Bias of the controller."}, s.h);
      visit(Field{"velocities", "1", "Changes of the sensor values in the last steps."}, s.velocities);
    }
  };
  static constexpr std::string_view channels[] = {"x", "y", "C", "h"};
  Spec spec;
  State state;

  Status init(const Setup& setup);
  void step(const Matrix& x, Matrix& y, Mode mode);

 private:
  Matrix old_x_, norm_, z_;
};

}  // namespace sandlot::selforg
