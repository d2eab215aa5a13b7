#pragma once
/// Sox: the homeokinetic controller. It learns a model of the world and changes itself so that its behaviour is both sensitive to
/// its sensors and predictable, without any goal. docs/selforg.md explains it.
///
/// Reads      sensors x, smoothed by s4avg.
/// Orders     motors y = tanh(C (x + creativity v_avg) + h).
/// Learns     from step 11 on: A, S, b of the model x' = A y + b + S x; C, h by descent on the time-loop error
///            E = |v|^2 = xi^T (L L^T)^-1 xi with xi the model's error and L = A (C & g') + S.
/// Guidance   desired motors or sensors for one step (Teachable, set_goal), a reward for one step (Rewardable).
/// Cost       one LU decomposition of L and one of A per step: O(n^3).
/// Singular   L or A: see PseudoInverse; v, chi and xi are limited to +-1e50, and no element of C changes by more than 0.1, none
///            of A by more than 0.2 per step.
/// Source     R. Der, G. Martius: The Playful Machine (2012), chapters 5 and 15; equations as of facts/lpzrobots.md section 6.
///            The root error is ours: the descent on the square root of E in place of E.
#include "selforg/controller.h"

namespace sandlot::selforg {

struct Sox final : Teachable, Rewardable {
  /// Scale of the controller's learning step.
  enum class ErrorFunction : std::uint8_t { plain, logarithmic, root };
  /// Form of L^+: Moore-Penrose, or Q (P L Q)^-1 P in a space of the motors' size.
  enum class Pseudo : std::uint8_t { moore_penrose, sensor_space, motor_space, special };

  struct Spec {
    double epsC = 0.1, epsA = 0.1, sense = 1, creativity = 0, damping = 1e-5, causeaware = 0.01, harmony = 0,
           gamma = 0.01;
    Pseudo pseudo = Pseudo::moore_penrose;
    ErrorFunction error = ErrorFunction::plain;
    double s4avg = 1;
    int s4delay = 1;
    double factorS = 1, factorb = 1, factorh = 1, goal_weight = 0.1;
    double init_feedback = 1;
    bool extended_model = true;
    static void fields(auto& s, auto&& visit) {
      constexpr unsigned tunable = Field::tunable;
      visit(Field{"epsC", "1", "Learning rate of the controller.", 0, 5, tunable}, s.epsC);
      visit(Field{"epsA", "1", "Learning rate of the model.", 0, 5, tunable}, s.epsA);
      visit(Field{"sense", "1", "Sensibility: weight of the term that leads out of saturation.", 0.2, 5,
                  tunable},
            s.sense);
      visit(Field{"creativity", "1", "Share of the mean reconstruction error in the input.", 0, 1, tunable},
            s.creativity);
      visit(Field{"damping", "1", "Forgetting: pull towards the native matrices.", 0, 0.01, tunable},
            s.damping);
      visit(Field{"causeaware", "1",
                  "Awareness of causes: share of the model's error that the motors are taken to have caused.",
                  0, 0.1, tunable},
            s.causeaware);
      visit(Field{"harmony", "1", "Harmony: share of the sensor values in the learning signal.", 0, 0.1,
                  tunable},
            s.harmony);
      visit(Field{"gamma", "1", "Strength of teaching.", 0, 1, tunable}, s.gamma);
      visit(Field{"pseudo", "",
                  "Inverse of L: Moore-Penrose, or an inverse in a space of as many dimensions as motors.", 0,
                  0, tunable},
            s.pseudo);
      visit(Field{"error", "", "Error function: E, its logarithm or its root.", 0, 0, tunable}, s.error);
      visit(Field{"s4avg", "1", "Steps over which sensor values are smoothed.", 1, 1e6, tunable}, s.s4avg);
      visit(Field{"s4delay", "1", "Steps from motor values to the sensor values that they cause.", 1, 9,
                  tunable},
            s.s4delay);
      visit(Field{"factorS", "1", "Factor on the learning rate of S.", 0, 100, tunable}, s.factorS);
      visit(Field{"factorb", "1", "Factor on the learning rate of b.", 0, 100, tunable}, s.factorb);
      visit(Field{"factorh", "1", "Factor on the learning rate of h.", 0, 100, tunable}, s.factorh);
      visit(Field{"goal_weight", "1", "Strength of goals, the additional error functions.", 0, 10, tunable},
            s.goal_weight);
      visit(Field{"init_feedback", "1", "Diagonal of C at the beginning.", -10, 10}, s.init_feedback);
      visit(Field{"extended_model", "",
                  "Model with S, which tells what the environment causes from what the motors cause."},
            s.extended_model);
    }
  };
  static constexpr std::size_t buffer = 10;

  struct State {
    std::uint64_t t = 0;
    Matrix A, C, S, h, b, A_native, C_native;
    Matrix x, y;  ///< smoothed sensors, motors
    std::vector<Matrix> x_buffer, y_buffer;
    Matrix v, v_avg, xi, self_caused, environment_caused;
    double E = 0;
    Matrix taught, goal;
    bool teach = false, pursue = false;
    double reward = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"t", "1", "Steps so far."}, s.t);
      visit(Field{"x", "1", "Smoothed sensor values."}, s.x);
      visit(Field{"y", "1", "Motor values."}, s.y);
      visit(Field{"A", "1", "Model: motors to sensors."}, s.A);
      visit(Field{"C", "1", "Controller: sensors to motors."}, s.C);
      visit(Field{"S", "1", "Model: sensors to next sensors, caused by the environment."}, s.S);
      visit(Field{"h", "1", "Bias of the controller."}, s.h);
      visit(Field{"b", "1", "Bias of the model."}, s.b);
      visit(Field{"A_native", "1", "Model that damping pulls towards."}, s.A_native);
      visit(Field{"C_native", "1", "Controller that damping pulls towards."}, s.C_native);
      visit(Field{"x_buffer", "1", "Smoothed sensor values of the last steps."}, s.x_buffer);
      visit(Field{"y_buffer", "1", "Motor values of the last steps."}, s.y_buffer);
      visit(Field{"v", "1", "Reconstruction error."}, s.v);
      visit(Field{"v_avg", "1", "Mean reconstruction error."}, s.v_avg);
      visit(Field{"xi", "1", "Prediction error of the model."}, s.xi);
      visit(Field{"self_caused", "1", "Part of the predicted sensor values that the motors cause: A y."},
            s.self_caused);
      visit(Field{"environment_caused", "1",
                  "Part of the predicted sensor values that the environment causes: S x."},
            s.environment_caused);
      visit(Field{"E", "1", "Time-loop error."}, s.E);
      visit(Field{"taught", "1", "Desired motor values of the next step."}, s.taught);
      visit(Field{"goal", "1",
                  "Descent direction of an additional error function in the next step, per motor."},
            s.goal);
      visit(Field{"teach", "", "Whether motor values are taught in the next step."}, s.teach);
      visit(Field{"pursue", "", "Whether there is an additional error function in the next step."}, s.pursue);
      visit(Field{"reward", "1", "Reward in the next step."}, s.reward);
    }
  };
  static constexpr std::string_view channels[] = {"x", "y", "A",  "C", "S",           "h",
                                                  "b", "v", "xi", "E", "self_caused", "environment_caused"};

  Spec spec;
  State state;

  Status init(const Setup& setup);
  void step(const Matrix& x, Matrix& y, Mode mode);
  bool fits(const State& s) const;
  Teachable* teachable() { return this; }
  Rewardable* rewardable() { return this; }

  void teach_motors(std::span<const double> y) override;
  void teach_sensors(std::span<const double> x) override;
  std::span<const double> last_motors() const override { return state.y.data; }
  void set_reward(double reward) override { state.reward = clipped(reward, 1); }
  /// Additional error function F of the motor values, for the next step: its gradient dF/dy at last_motors().
  void set_goal(std::span<const double> gradient);
  /// The additional error function 1/2 sum_i weight_i (x_goal_i - predicted x_i)^2, through the world model.
  void set_goal_sensors(std::span<const double> x_goal, std::span<const double> weights);
  /// Motor values that were sent in place of the last output: the model learns from what was sent.
  void correct_last_motors(const Matrix& y);
  /// R = A C + S, the feedback strength of the loop; a view for plots.
  void loop_matrix(Matrix& R) const;

 private:
  void learn(const Matrix& x, const Matrix& y_sent, const Matrix& x_next);
  void learn_from(const Matrix& x, const Matrix& y_sent, const Matrix& x_next);
  void guide(const Matrix& delta, double rate, const Matrix& x);
  void factor_L();
  void invert_L(const Matrix& in, Matrix& out);
  void invert_L_transposed(const Matrix& in, Matrix& out);

  struct Scratch {
    Matrix z, y, g, L, eta, y_hat, v_hat, chi, mu, Cv, epsrel, delta, m1, m2, n1, n2, input;
    Matrix P, Q, PL, PLQ;
    PseudoInverse A_inverse, L_inverse, inner_inverse;
  } s_;
};

inline std::span<const EnumName<Sox::ErrorFunction>> enum_names(Sox::ErrorFunction) {
  using E = Sox::ErrorFunction;
  static constexpr EnumName<E> names[] = {
      {"plain", E::plain}, {"logarithmic", E::logarithmic}, {"root", E::root}};
  return names;
}
inline std::span<const EnumName<Sox::Pseudo>> enum_names(Sox::Pseudo) {
  using E = Sox::Pseudo;
  static constexpr EnumName<E> names[] = {{"moore_penrose", E::moore_penrose},
                                          {"sensor_space", E::sensor_space},
                                          {"motor_space", E::motor_space},
                                          {"special", E::special}};
  return names;
}

}  // namespace sandlot::selforg
