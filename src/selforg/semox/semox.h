#pragma once
/// SeMoX: homeokinesis with the dynamics in motor space, for robots with many sensors: what is inverted has the size of the
/// motors, however many sensors there are.
///
/// Reads      sensors x, smoothed by s4avg.
/// Orders     motors y = tanh(C x + H).
/// Learns     model x' = A y + b + S x, as long as its error is below `pain` times its average; C, H by descent on
///            E = 1/2 zeta^T (R R^T)^-1 zeta, where zeta is the model's error brought back to before the motors' squashing and R = C A.
/// Guidance   desired motors or sensors for one step (Teachable); a pull towards continuous motor values (gamma_cont).
/// Bounds     1/g' at most 100; v within +-3; changes per step of each element within +-squashsize.
/// Source     G. Martius, thesis, section 4.1.2; equations as of facts/lpzrobots.md section 7. Its g'(z, eta) is taken as g'(z).
#include "selforg/controller.h"

namespace sandlot::selforg {

struct Semox final : Teachable {
  enum class ErrorFunction : std::uint8_t { plain, logarithmic, root };
  struct Spec {
    double epsC = 0.1, epsA = 0.1, s4avg = 1, factorB = 0.2, squashsize = 0.01;
    int s4delay = 1;
    double dampModel = 0, dampController = 0, modelNoise = 0, gamma_cont = 0, gamma_teach = 0.01,
           discountS = 0.001, pain = 5;
    ErrorFunction error = ErrorFunction::plain, model_error = ErrorFunction::plain;
    double init_feedback = 1;
    bool extended_model = true;
    static void fields(auto& s, auto&& visit) {
      constexpr unsigned tunable = Field::tunable;
      visit(Field{"epsC", "1", "Learning rate of the controller.", 0, 5, tunable}, s.epsC);
      visit(Field{"epsA", "1", "Learning rate of the model.", 0, 5, tunable}, s.epsA);
      visit(Field{"s4avg", "1", "Steps over which sensor values are smoothed.", 1, 1e6, tunable}, s.s4avg);
      visit(Field{"factorB", "1", "Factor on the learning rate of b.", 0, 100, tunable}, s.factorB);
      visit(Field{"squashsize", "1", "Bound of the change of one element in one step.", 0, 1, tunable},
            s.squashsize);
      visit(Field{"s4delay", "1", "Steps from motor values to the sensor values that they cause.", 1, 9,
                  tunable},
            s.s4delay);
      visit(Field{"dampModel", "1", "Decay of A, S and b per step.", 0, 0.1, tunable}, s.dampModel);
      visit(Field{"dampController", "1", "Decay of C and H per step.", 0, 0.1, tunable}, s.dampController);
      visit(
          Field{"modelNoise", "1",
                "Standard deviation of noise on the motor values that the model learns from.", 0, 1, tunable},
          s.modelNoise);
      visit(Field{"gamma_cont", "1", "Strength of the pull towards the motor values of the step before.", 0,
                  1, tunable},
            s.gamma_cont);
      visit(Field{"gamma_teach", "1", "Strength of teaching.", 0, 1, tunable}, s.gamma_teach);
      visit(Field{"discountS", "1", "Decay of S per step, which leaves to A what A can explain.", 0, 0.1,
                  tunable},
            s.discountS);
      visit(Field{"pain", "1",
                  "Ratio of the model's error to its average from which on the model does not learn.", 1, 1e6,
                  tunable},
            s.pain);
      visit(Field{"error", "", "Error function of the controller: E, its logarithm or its root.", 0, 0,
                  tunable},
            s.error);
      visit(Field{"model_error", "", "Error function of the model.", 0, 0, tunable}, s.model_error);
      visit(Field{"init_feedback", "1", "Diagonal of C at the beginning.", -10, 10}, s.init_feedback);
      visit(Field{"extended_model", "",
                  "Model with S, which tells what the environment causes from what the motors cause."},
            s.extended_model);
    }
  };
  static constexpr std::size_t buffer = 10;
  struct State {
    std::uint64_t t = 0;
    Matrix A, C, S, H, b, x, y;
    std::vector<Matrix> x_buffer, y_buffer;
    Matrix xi, v, taught;
    double E = 0, error_average = 0;
    bool teach = false;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"t", "1", "Steps so far."}, s.t);
      visit(Field{"x", "1", "Smoothed sensor values."}, s.x);
      visit(Field{"y", "1", "Motor values."}, s.y);
      visit(Field{"A", "1", "Model: motors to sensors."}, s.A);
      visit(Field{"C", "1", "Controller: sensors to motors."}, s.C);
      visit(Field{"S", "1", "Model: sensors to next sensors."}, s.S);
      visit(Field{"H", "1", "Bias of the controller."}, s.H);
      visit(Field{"b", "1", "Bias of the model."}, s.b);
      visit(Field{"x_buffer", "1", "Smoothed sensor values of the last steps."}, s.x_buffer);
      visit(Field{"y_buffer", "1", "Motor values of the last steps."}, s.y_buffer);
      visit(Field{"xi", "1", "Prediction error of the model."}, s.xi);
      visit(Field{"v", "1", "Error in motor space before the loop."}, s.v);
      visit(Field{"taught", "1", "Desired motor values of the next step."}, s.taught);
      visit(Field{"E", "1", "Error of the loop in motor space."}, s.E);
      visit(Field{"error_average", "1", "Average norm of the model's error."}, s.error_average);
      visit(Field{"teach", "", "Whether motor values are taught in the next step."}, s.teach);
    }
  };
  static constexpr std::string_view channels[] = {
      "x", "y", "A", "C", "S", "H", "b", "v", "xi", "E", "error_average"};
  Spec spec;
  State state;

  Status init(const Setup& setup);
  void step(const Matrix& x, Matrix& y, Mode mode);
  Teachable* teachable() { return this; }
  void teach_motors(std::span<const double> y) override;
  void teach_sensors(std::span<const double> x) override;
  std::span<const double> last_motors() const override { return state.y.data; }

 private:
  void learn_controller(const Matrix& x, const Matrix& y_before);
  void learn_model(const Matrix& x, const Matrix& y);
  void pull(const Matrix& delta, double rate, const Matrix& x);

  Setup setup_;
  struct Scratch {
    Matrix z, y, g, eta, zeta, chi, rho, delta, m1, n1, noisy, R, RR, RA;
    PseudoInverse A_inverse, RR_inverse;
  } s_;
};

inline std::span<const EnumName<Semox::ErrorFunction>> enum_names(Semox::ErrorFunction) {
  using E = Semox::ErrorFunction;
  static constexpr EnumName<E> names[] = {
      {"plain", E::plain}, {"logarithmic", E::logarithmic}, {"root", E::root}};
  return names;
}

}  // namespace sandlot::selforg
