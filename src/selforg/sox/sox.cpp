#include "selforg/sox/sox.h"

#include "base/check.h"
#include "selforg/arrays.h"

namespace sandlot::selforg {
namespace {

constexpr double huge = 1e50;  // products of a few such numbers are still finite

void limit(Matrix& x) {
  for (double& each : x.data) each = clipped(each, huge);
}

void copy(const Matrix& from, Matrix& to) { std::copy(from.data.begin(), from.data.end(), to.data.begin()); }

/// Clipping element by element of an Eigen expression of finite numbers.
template <class Expression>
auto clip(const Expression& x, double limit) {
  return x.max(-limit).min(limit);
}

}  // namespace

Status Sox::init(const Setup& setup) {
  const std::size_t n = setup.sensors, m = setup.motors;
  state = {};
  state.A = state.A_native = Matrix::identity(n, m);
  state.C = Matrix::identity(m, n, spec.init_feedback);
  state.C_native = Matrix::identity(m, n, 1.2);
  state.S = spec.extended_model ? Matrix::identity(n, n, 0.05) : Matrix(n, n);
  state.h = state.y = state.taught = state.goal = Matrix(m, 1);
  state.b = state.x = state.v = state.v_avg = state.xi = state.self_caused = state.environment_caused =
      Matrix(n, 1);
  state.x_buffer.assign(buffer, Matrix(n, 1));
  state.y_buffer.assign(buffer, Matrix(m, 1));
  s_.z = s_.y = s_.g = s_.eta = s_.y_hat = s_.mu = s_.Cv = s_.epsrel = s_.delta = s_.m1 = s_.m2 = Matrix(m,
                                                                                                         1);
  s_.v_hat = s_.chi = s_.n1 = s_.n2 = s_.input = Matrix(n, 1);
  s_.L = Matrix(n, n);
  s_.P = s_.PL = Matrix(m, n);
  s_.Q = Matrix(n, m);
  s_.PLQ = Matrix(m, m);
  s_.A_inverse = PseudoInverse(n, m);
  s_.L_inverse = PseudoInverse(n, n);
  s_.inner_inverse = PseudoInverse(m, m);
  return {};
}

bool Sox::fits(const State& s) const { return s.reward >= -1 && s.reward <= 1; }

void Sox::step(const Matrix& x, Matrix& y, Mode mode) {
  const std::uint64_t t = state.t;
  if (t == 0) copy(x, state.x);
  else array(state.x) += (array(x) - array(state.x)) / spec.s4avg;
  copy(state.x, state.x_buffer[t % buffer]);
  const auto delay = static_cast<std::uint64_t>(spec.s4delay);
  const Matrix& x_then = state.x_buffer[(t + buffer - delay) % buffer];
  const Matrix& y_then = state.y_buffer[(t + buffer - delay) % buffer];

  if (mode == Mode::babble) {
    copy(y, state.y);
    if (t > buffer) learn_from(x_then, y_then, state.x);
  } else {
    if (mode == Mode::learn && t > buffer) learn(x_then, y_then, state.x);
    array(s_.input) = array(state.x) + spec.creativity * array(state.v_avg);
    multiply(state.C, s_.input, s_.z);
    array(s_.z) += array(state.h);
    tanh_of(s_.z, y);
    copy(y, state.y);
  }
  // A signal holds for one step, whether it could be used or not.
  state.teach = state.pursue = false;
  state.reward = 0;
  copy(state.y, state.y_buffer[t % buffer]);
  ++state.t;
}

/// One step of the learning rule, in the order of docs/selforg.md.
void Sox::learn(const Matrix& x, const Matrix& y_sent, const Matrix& x_next) {
  State& s = state;
  // Error of the model.
  multiply(s.A, y_sent, s.self_caused);
  multiply(s.S, x, s.environment_caused);
  array(s.xi) = array(x_next) - (array(s.self_caused) + array(s.b) + array(s.environment_caused));
  limit(s.xi);

  // Jacobian L of the loop at x.
  multiply(s.C, x, s_.z);
  array(s_.z) += array(s.h);
  tanh_of(s_.z, s_.y);
  array(s_.g) = 1 - array(s_.y) * array(s_.y);
  multiply_scaled_rows(s.A, s.C, s_.g, s_.L);
  array(s_.L) += array(s.S);

  // Time-loop error and its gradient.
  s_.A_inverse.factor(s.A);
  s_.A_inverse.apply(s.xi, s_.eta);
  limit(s_.eta);
  const double causeaware = spec.extended_model ? spec.causeaware : 0;
  array(s_.y_hat) = array(s_.y) + causeaware * array(s_.eta);
  factor_L();
  invert_L(s.xi, s.v);
  limit(s.v);
  invert_L_transposed(s.v, s_.chi);
  limit(s_.chi);
  s.E = squared_norm(s.v);
  multiply_transposed(s.A, s_.chi, s_.mu);
  array(s_.mu) *= array(s_.g);
  multiply(s.C, s.v, s_.Cv);
  array(s_.epsrel) = array(s_.mu) * array(s_.Cv) * (2 * spec.sense);
  array(s_.v_hat) = array(s.v) + spec.harmony * array(x);
  array(s.v_avg) += 0.1 * (array(s.v) - array(s.v_avg));
  limit(s_.mu);
  limit(s_.epsrel);

  double rate = spec.epsC * (1 - 0.99 * s.reward);
  if (spec.error == ErrorFunction::logarithmic) rate *= 0.1 / (s.E + 0.001);
  if (spec.error == ErrorFunction::root) rate *= 0.1 / std::sqrt(s.E + 0.001);

  // Guidance with the values from before this step's change, as the rule itself. The metric needs A as it was.
  const bool teach = s.teach, pursue = s.pursue;
  if (teach) array(s_.delta) = (array(s.taught) - array(s_.y)) * array(s_.g);
  if (teach) guide(s_.delta, spec.gamma, x);
  if (pursue) array(s_.delta) = array(s.goal) * array(s_.g);
  if (pursue) guide(s_.delta, spec.goal_weight, x);

  // Model.
  for (std::size_t j = 0; j < s.A.cols; ++j) {
    auto to = column(s.A, j);
    const auto pull = column(s.A_native, j) - to;
    to += clip(array(s.xi) * (spec.epsA * s_.y_hat[j]), 0.1) + clip(pull * pull * pull * spec.damping, 0.1);
  }
  if (spec.extended_model)
    for (std::size_t j = 0; j < s.S.cols; ++j) {
      auto to = column(s.S, j);
      to += clip(array(s.xi) * (spec.epsA * spec.factorS * x[j]) - to * (10 * spec.damping), 0.1);
    }
  array(s.b) += clip(array(s.xi) * (spec.epsA * spec.factorb) - array(s.b) * spec.damping, 0.1);

  // Controller.
  array(s_.m1) = array(s_.epsrel) * array(s_.y);
  for (std::size_t j = 0; j < s.C.cols; ++j) {
    auto to = column(s.C, j);
    const auto pull = column(s.C_native, j) - to;
    to += clip((array(s_.mu) * s_.v_hat[j] - array(s_.m1) * x[j]) * rate, 0.05) +
          clip(pull * pull * pull * spec.damping, 0.05);
  }
  array(s.h) += clip((array(s_.mu) * spec.harmony - array(s_.m1)) * (rate * spec.factorh), 0.05);
}

/// C and h along a desired change of the motors: C += clip(rate epsC metric delta x^T), with the natural metric A^T (L^+)^T L^+ A.
void Sox::guide(const Matrix& delta, double rate, const Matrix& x) {
  multiply(state.A, delta, s_.n1);
  invert_L(s_.n1, s_.n2);
  limit(s_.n2);
  invert_L_transposed(s_.n2, s_.n1);
  limit(s_.n1);
  multiply_transposed(state.A, s_.n1, s_.m2);
  limit(s_.m2);
  for (std::size_t j = 0; j < state.C.cols; ++j)
    column(state.C, j) += clip(array(s_.m2) * (rate * spec.epsC * x[j]), 0.05);
  array(state.h) += clip(array(s_.m2) * (rate * spec.epsC * spec.factorh), 0.05);
}

/// Babbling: model and controller learn what somebody else's motor values show, by the delta rule.
void Sox::learn_from(const Matrix& x, const Matrix& y_sent, const Matrix& x_next) {
  State& s = state;
  multiply(s.A, y_sent, s.self_caused);
  multiply(s.S, x, s.environment_caused);
  array(s.xi) = array(x_next) - (array(s.self_caused) + array(s.b) + array(s.environment_caused));
  limit(s.xi);
  const double epsA = 0.1 * spec.epsA, epsC = 0.1 * spec.epsC;
  for (std::size_t j = 0; j < s.A.cols; ++j) column(s.A, j) += clip(array(s.xi) * (epsA * y_sent[j]), 0.1);
  if (spec.extended_model)
    for (std::size_t j = 0; j < s.S.cols; ++j)
      column(s.S, j) += clip(array(s.xi) * (epsA * spec.factorS * x[j]), 0.1);
  array(s.b) += clip(array(s.xi) * (epsA * spec.factorb), 0.1);

  multiply(s.C, x, s_.z);
  array(s_.z) += array(s.h);
  tanh_of(s_.z, s_.y);
  array(s_.delta) = (array(y_sent) - array(s_.y)) * (1 - array(s_.y) * array(s_.y));
  for (std::size_t j = 0; j < s.C.cols; ++j) column(s.C, j) += clip(array(s_.delta) * (epsC * x[j]), 0.05);
  array(s.h) += clip(array(s_.delta) * (epsC * spec.factorh), 0.05);
  copy(s.A, s.A_native);
  copy(s.C, s.C_native);
}

void Sox::factor_L() {
  if (spec.pseudo == Pseudo::moore_penrose) return s_.L_inverse.factor(s_.L);
  for (std::size_t i = 0; i < s_.P.rows; ++i)
    for (std::size_t j = 0; j < s_.P.cols; ++j) {
      s_.P(i, j) = spec.pseudo == Pseudo::special ? state.C(i, j) : state.A(j, i);
      s_.Q(j, i) = spec.pseudo == Pseudo::sensor_space ? state.C(i, j) : state.A(j, i);
    }
  multiply_matrices(s_.P, s_.L, s_.PL);
  multiply_matrices(s_.PL, s_.Q, s_.PLQ);
  s_.inner_inverse.factor(s_.PLQ);
}

void Sox::invert_L(const Matrix& in, Matrix& out) {
  if (spec.pseudo == Pseudo::moore_penrose) return s_.L_inverse.apply(in, out);
  multiply(s_.P, in, s_.m1);
  s_.inner_inverse.apply(s_.m1, s_.m2);
  multiply(s_.Q, s_.m2, out);
}

void Sox::invert_L_transposed(const Matrix& in, Matrix& out) {
  if (spec.pseudo == Pseudo::moore_penrose) return s_.L_inverse.apply_transposed(in, out);
  multiply_transposed(s_.Q, in, s_.m1);
  s_.inner_inverse.apply_transposed(s_.m1, s_.m2);
  multiply_transposed(s_.P, s_.m2, out);
}

void Sox::teach_motors(std::span<const double> y) {
  SL_CHECK(y.size() == state.taught.size());
  for (std::size_t i = 0; i < y.size(); ++i)
    state.taught[i] = std::isfinite(y[i]) ? clipped(y[i], 0.95) : state.y[i];
  state.teach = true;
}

void Sox::teach_sensors(std::span<const double> x) {
  SL_CHECK(x.size() == state.b.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    s_.n1[i] = std::isfinite(x[i]) ? clipped(x[i], 1000) - state.b[i] : 0;
  s_.A_inverse.factor(state.A);
  s_.A_inverse.apply(s_.n1, s_.m1);
  teach_motors(s_.m1.data);
}

void Sox::correct_last_motors(const Matrix& y) {
  copy(y, state.y);
  if (state.t > 0) copy(y, state.y_buffer[(state.t - 1) % buffer]);
}

void Sox::loop_matrix(Matrix& R) const {
  multiply_matrices(state.A, state.C, R);
  array(R) += array(state.S);
}

void Sox::set_goal(std::span<const double> gradient) {
  SL_CHECK(gradient.size() == state.goal.size());
  for (std::size_t i = 0; i < gradient.size(); ++i) state.goal[i] = -clipped(gradient[i], 1000);
  state.pursue = true;
}

void Sox::set_goal_sensors(std::span<const double> x_goal, std::span<const double> weights) {
  SL_CHECK(x_goal.size() == state.b.size() && weights.size() == state.b.size());
  multiply(state.A, state.y, s_.n1);
  multiply(state.S, state.x, s_.n2);
  for (std::size_t i = 0; i < x_goal.size(); ++i) {
    const double miss = x_goal[i] - (s_.n1[i] + state.b[i] + s_.n2[i]);
    s_.n2[i] = -clipped(weights[i] * miss, 1000);
  }
  multiply_transposed(state.A, s_.n2, s_.m1);
  set_goal(s_.m1.data);
}

}  // namespace sandlot::selforg
