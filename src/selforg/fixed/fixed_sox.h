#pragma once
/// Sox of a fixed size for microcontrollers: no heap, no library of mathematics, no headers but this and fixed_math.h. C++17; `-ffreestanding` will do.
///
///   static sandlot::selforg::fixed::Sox<4, 2> sox;        // 4 sensors, 2 motors, in float
///   float x[4], y[2];
///   for (;;) { read(x); sox.step(x, y); write(y); wait(); }
///
/// Equations  those of selforg/sox/sox.h (docs/selforg.md) in the same order of additions. Left out: forms of L^+ other than
///            Moore-Penrose, the root error, babbling, and guidance but for the reward.
/// Same       in double, C, A and the motor values stay within 1e-12 of those of selforg/sox for 1000 steps of the same sensor
///            values with the default parameters; in float one step from the same matrices differs by less than 1e-6 (fixed_test.cpp).
/// Size       all memory is in the object: 736 bytes of Sox<4, 2> in float, with 6.5 KiB of code (g++ -Os, x86-64). The stack
///            holds less than 256 bytes in one function.
/// Time       O(n^3) per step, two factorisations.
/// Sensors    a value that is not finite is replaced by the last one that was; values are clipped to +-1000.

#include "selforg/fixed/fixed_math.h"

namespace sandlot::selforg::fixed {

/// @tparam N  sensors  @tparam M  motors, both at least 1  @tparam Delays  largest s4delay
template <Index N, Index M, class Real = float, Index Delays = 1>
class Sox {
 public:
  struct Parameters {
    Real epsC = Real(0.1), epsA = Real(0.1), sense = 1, creativity = 0, damping = Real(1e-5),
         causeaware = Real(0.01), harmony = 0;
    Real s4avg = 1;
    Index s4delay = 1;  ///< at most Delays
    Real factorS = 1, factorb = 1, factorh = 1, init_feedback = 1;
    bool logarithmic = false, extended_model = true;
  };
  Parameters parameters;
  // What is learned: store these, and give them back, to go on.
  Real A[N][M], C[M][N], S[N][N], h[M], b[N];

  Sox() { reset(); }
  explicit Sox(const Parameters& with) : parameters(with) { reset(); }

  void reset() {
    for (Index i = 0; i < N; ++i)
      for (Index j = 0; j < M; ++j) A[i][j] = i == j ? Real(1) : Real(0);
    for (Index i = 0; i < M; ++i)
      for (Index j = 0; j < N; ++j) C[i][j] = i == j ? parameters.init_feedback : Real(0);
    for (Index i = 0; i < N; ++i)
      for (Index j = 0; j < N; ++j) S[i][j] = i == j && parameters.extended_model ? Real(0.05) : Real(0);
    for (Real& each : h) each = 0;
    for (Index i = 0; i < N; ++i) b[i] = x_[i] = raw_[i] = v_[i] = v_avg_[i] = xi_[i] = 0;
    for (Real& each : y_) each = 0;
    for (auto& row : x_buffer_)
      for (Real& each : row) each = 0;
    for (auto& row : y_buffer_)
      for (Real& each : row) each = 0;
    steps_ = 0;
    reward_ = error_ = 0;
  }

  /// Once per control step. @param x  sensor values, by convention within [-1, 1]  @param y  out: motor values
  void step(const Real (&x)[N], Real (&y)[M], bool learns = true) {
    for (Index i = 0; i < N; ++i) {
      if (is_finite(x[i])) raw_[i] = clipped(x[i], Real(1000));
      if (steps_ == 0) x_[i] = raw_[i];
      else x_[i] += (raw_[i] - x_[i]) / parameters.s4avg;
      x_buffer_[at(0)][i] = x_[i];
    }
    const Index delay = parameters.s4delay < 1        ? 1
                        : parameters.s4delay > Delays ? Delays
                                                      : parameters.s4delay;
    if (learns && steps_ > 10) learn(x_buffer_[at(delay)], y_buffer_[at(delay)]);
    for (Index i = 0; i < N; ++i) n_[i] = x_[i] + parameters.creativity * v_avg_[i];
    for (Index i = 0; i < M; ++i) {
      Real sum = 0;
      for (Index j = 0; j < N; ++j) sum += C[i][j] * n_[j];
      y[i] = y_[i] = y_buffer_[at(0)][i] = tanh_of(sum + h[i]);
    }
    reward_ = 0;
    slot_ = (slot_ + 1) % (Delays + 1);
    if (steps_ <= 10) ++steps_;
  }
  /// Reward of the next step, within [-1, 1]: 1 freezes the controller, -1 doubles its learning.
  void set_reward(Real reward) { reward_ = clipped(reward, Real(1)); }
  /// Time-loop error of the last step.
  Real error() const { return error_; }

 private:
  static constexpr Real huge = sizeof(Real) == 4 ? Real(1e9) : Real(1e50);
  Index at(Index steps_ago) const { return (slot_ + Delays + 1 - steps_ago) % (Delays + 1); }

  /// The equations of docs/selforg.md, section 1, in their order.
  void learn(const Real (&x)[N], const Real (&y_sent)[M]) {
    const Parameters& p = parameters;
    for (Index i = 0; i < N; ++i) {
      Real self = 0, environment = 0;
      for (Index j = 0; j < M; ++j) self += A[i][j] * y_sent[j];
      for (Index j = 0; j < N; ++j) environment += S[i][j] * x[j];
      xi_[i] = clipped(x_[i] - (self + b[i] + environment), huge);
    }
    for (Index i = 0; i < M; ++i) {
      Real sum = 0;
      for (Index j = 0; j < N; ++j) sum += C[i][j] * x[j];
      z_[i] = tanh_of(sum + h[i]);
      g_[i] = 1 - z_[i] * z_[i];
    }
    for (Index i = 0; i < N; ++i)
      for (Index j = 0; j < N; ++j) {
        Real sum = 0;
        for (Index k = 0; k < M; ++k) sum += A[i][k] * (C[k][j] * g_[k]);
        L_[i][j] = sum + S[i][j];
      }
    A_inverse_.factor(A);
    A_inverse_.apply(xi_, eta_);
    const Real causeaware = p.extended_model ? p.causeaware : Real(0);
    for (Index i = 0; i < M; ++i) eta_[i] = z_[i] + causeaware * clipped(eta_[i], huge);
    L_inverse_.factor(L_);
    L_inverse_.apply(xi_, v_);
    error_ = 0;
    for (Real& each : v_) each = clipped(each, huge), error_ += each * each;
    L_inverse_.apply_transposed(v_, chi_);
    for (Real& each : chi_) each = clipped(each, huge);
    for (Index i = 0; i < M; ++i) {
      Real sum = 0, Cv = 0;
      for (Index j = 0; j < N; ++j) sum += A[j][i] * chi_[j];
      for (Index j = 0; j < N; ++j) Cv += C[i][j] * v_[j];
      sum *= g_[i];
      epsrel_[i] = clipped(sum * Cv * (2 * p.sense), huge);
      mu_[i] = clipped(sum, huge);
    }
    for (Index i = 0; i < N; ++i) v_avg_[i] += Real(0.1) * (v_[i] - v_avg_[i]);
    Real rate = p.epsC * (1 - Real(0.99) * reward_);
    if (p.logarithmic) rate *= Real(0.1) / (error_ + Real(0.001));

    for (Index i = 0; i < N; ++i)
      for (Index j = 0; j < M; ++j) {
        const Real pull = (i == j ? Real(1) : Real(0)) - A[i][j];
        A[i][j] += clipped(xi_[i] * (p.epsA * eta_[j]), Real(0.1)) +
                   clipped(pull * pull * pull * p.damping, Real(0.1));
      }
    for (Index i = 0; i < N; ++i) {
      if (p.extended_model)
        for (Index j = 0; j < N; ++j)
          S[i][j] += clipped(xi_[i] * (p.epsA * p.factorS * x[j]) - S[i][j] * (10 * p.damping), Real(0.1));
      b[i] += clipped(xi_[i] * (p.epsA * p.factorb) - b[i] * p.damping, Real(0.1));
    }
    for (Index i = 0; i < M; ++i) {
      const Real m = epsrel_[i] * z_[i];
      for (Index j = 0; j < N; ++j) {
        const Real pull = (i == j ? Real(1.2) : Real(0)) - C[i][j];
        C[i][j] += clipped((mu_[i] * (v_[j] + p.harmony * x[j]) - m * x[j]) * rate, Real(0.05)) +
                   clipped(pull * pull * pull * p.damping, Real(0.05));
      }
      h[i] += clipped((mu_[i] * p.harmony - m) * (rate * p.factorh), Real(0.05));
    }
  }

  Real x_[N], raw_[N], y_[M], v_[N], v_avg_[N], xi_[N];
  Real x_buffer_[Delays + 1][N], y_buffer_[Delays + 1][M];
  Real reward_ = 0, error_ = 0;
  Index steps_ = 0, slot_ = 0;
  // Of one step:
  Real z_[M] = {}, g_[M] = {}, eta_[M] = {}, mu_[M] = {}, epsrel_[M] = {}, chi_[N] = {}, n_[N] = {},
       L_[N][N] = {};
  PseudoInverse<N, M, Real> A_inverse_;
  PseudoInverse<N, N, Real> L_inverse_;
};

}  // namespace sandlot::selforg::fixed
