#include "selforg/semox/semox.h"

#include "base/check.h"
#include "selforg/arrays.h"

namespace sandlot::selforg {
namespace {

constexpr double huge_value = 1e50;

void bounded(Matrix& x, double limit) {
  for (double& each : x.data) each = clipped(each, limit);
}

void copy_of(const Matrix& from, Matrix& to) {
  std::copy(from.data.begin(), from.data.end(), to.data.begin());
}

template <class Expression>
auto squashed(const Expression& x, double limit) {
  return x.max(-limit).min(limit);
}

double factor_of(Semox::ErrorFunction error, double E) {
  if (error == Semox::ErrorFunction::logarithmic) return 0.1 / (E + 0.001);
  if (error == Semox::ErrorFunction::root) return 0.1 / std::sqrt(E + 0.001);
  return 1;
}

}  // namespace

Status Semox::init(const Setup& setup) {
  setup_ = setup;
  const std::size_t n = setup.sensors, m = setup.motors;
  state = {};
  state.A = Matrix::identity(n, m);
  state.C = Matrix::identity(m, n, spec.init_feedback);
  state.S = Matrix(n, n);
  state.H = state.y = state.v = state.taught = Matrix(m, 1);
  state.b = state.x = state.xi = Matrix(n, 1);
  state.x_buffer.assign(buffer, Matrix(n, 1));
  state.y_buffer.assign(buffer, Matrix(m, 1));
  s_.z = s_.y = s_.g = s_.eta = s_.zeta = s_.chi = s_.rho = s_.delta = s_.m1 = s_.noisy = Matrix(m, 1);
  s_.n1 = Matrix(n, 1);
  s_.R = s_.RR = s_.RA = Matrix(m, m);
  s_.A_inverse = PseudoInverse(m, m);
  s_.RR_inverse = PseudoInverse(m, m);
  return {};
}

void Semox::step(const Matrix& x, Matrix& y, Mode mode) {
  const std::uint64_t t = state.t;
  if (t == 0) copy_of(x, state.x);
  else array(state.x) += (array(x) - array(state.x)) / spec.s4avg;
  copy_of(state.x, state.x_buffer[t % buffer]);
  const auto delay = static_cast<std::uint64_t>(spec.s4delay);
  const Matrix& x_then = state.x_buffer[(t + buffer - delay) % buffer];
  const Matrix& y_then = state.y_buffer[(t + buffer - delay) % buffer];
  const Matrix& y_before = state.y_buffer[(t + buffer - delay - 1) % buffer];

  if (mode != Mode::act && t > buffer) {
    multiply(state.A, y_then, state.xi);
    multiply(state.S, x_then, s_.n1);
    array(state.xi) = array(state.x) - (array(state.xi) + array(state.b) + array(s_.n1));
    bounded(state.xi, huge_value);
    if (mode == Mode::learn) learn_controller(x_then, y_before);
    learn_model(x_then, y_then);
  }
  if (mode != Mode::babble) {
    multiply(state.C, state.x, s_.z);
    array(s_.z) += array(state.H);
    tanh_of(s_.z, y);
  }
  copy_of(y, state.y);
  copy_of(y, state.y_buffer[t % buffer]);
  state.teach = false;
  ++state.t;
}

void Semox::learn_controller(const Matrix& x, const Matrix& y_before) {
  State& s = state;
  multiply(s.C, x, s_.z);
  array(s_.z) += array(s.H);
  tanh_of(s_.z, s_.y);
  array(s_.g) = 1 - array(s_.y) * array(s_.y);

  // eta = g((A^T A + 0.001)^-1 A^T xi): the error as motor values. zeta: the same before the squashing.
  multiply_transposed_matrices(s.A, s.A, s_.RA);
  for (std::size_t i = 0; i < s_.RA.rows; ++i) s_.RA(i, i) += 0.001;
  s_.A_inverse.factor(s_.RA);
  multiply_transposed(s.A, s.xi, s_.m1);
  s_.A_inverse.apply(s_.m1, s_.z);
  tanh_of(s_.z, s_.eta);
  array(s_.zeta) = array(s_.eta) / array(s_.g).max(0.01);

  multiply_matrices(s.C, s.A, s_.R);
  multiply_by_transposed(s_.R, s_.R, s_.RR);
  for (std::size_t i = 0; i < s_.RR.rows; ++i) s_.RR(i, i) += 0.001;
  s_.RR_inverse.factor(s_.RR);
  s_.RR_inverse.apply(s_.zeta, s_.chi);
  bounded(s_.chi, huge_value);
  multiply_transposed(s_.R, s_.chi, s.v);
  bounded(s.v, 3);
  s.E = 0.5 * squared_norm(s.v);
  // rho = -(g''/g') (chi & zeta), and g''/g' = -2 g for the hyperbolic tangent.
  array(s_.rho) = 2 * array(s_.y) * array(s_.chi) * array(s_.zeta);

  if (s.teach) {
    array(s_.delta) = (array(s.taught) - array(s_.y)) * array(s_.g);
    pull(s_.delta, spec.gamma_teach, x);
  }
  if (spec.gamma_cont > 0) {
    array(s_.delta) = (array(y_before) - array(s_.y)) * array(s_.g);
    pull(s_.delta, spec.gamma_cont, x);
  }

  const double rate = spec.epsC * factor_of(spec.error, s.E);
  multiply(s.A, s.v, s_.n1);  // (v^T A^T)^T
  for (std::size_t j = 0; j < s.C.cols; ++j) {
    auto to = column(s.C, j);
    to += squashed((array(s_.chi) * s_.n1[j] - array(s_.rho) * x[j]) * rate, spec.squashsize) -
          to * spec.dampController;
  }
  array(s.H) += squashed(array(s_.rho) * -rate, spec.squashsize) - array(s.H) * spec.dampController;
}

/// C += rate epsC ((R & g')(R & g')^T + 0.001)^-1 delta x^T
void Semox::pull(const Matrix& delta, double rate, const Matrix& x) {
  for (std::size_t j = 0; j < s_.R.cols; ++j) column(s_.RA, j) = column(s_.R, j) * array(s_.g);
  multiply_by_transposed(s_.RA, s_.RA, s_.RR);
  for (std::size_t i = 0; i < s_.RR.rows; ++i) s_.RR(i, i) += 0.001;
  s_.RR_inverse.factor(s_.RR);
  s_.RR_inverse.apply(delta, s_.m1);
  bounded(s_.m1, huge_value);
  for (std::size_t j = 0; j < state.C.cols; ++j)
    column(state.C, j) += squashed(array(s_.m1) * (rate * spec.epsC * x[j]), spec.squashsize);
  array(state.H) += squashed(array(s_.m1) * (rate * spec.epsC), spec.squashsize);
}

void Semox::learn_model(const Matrix& x, const Matrix& y) {
  State& s = state;
  const double error = std::sqrt(squared_norm(s.xi));
  const bool pain = s.error_average > 0 && error > spec.pain * s.error_average;
  s.error_average = clipped(s.error_average + 0.01 * (error - s.error_average), huge_value);
  if (s.error_average == 0) s.error_average = clipped(error, huge_value);
  if (pain) return;
  copy_of(y, s_.noisy);
  if (spec.modelNoise > 0) {
    Stream random = setup_.random(s.t, 1);
    for (double& each : s_.noisy.data) each += spec.modelNoise * random.normal();
  }
  const double rate = spec.epsA * factor_of(spec.model_error, error * error);
  const double limit = spec.squashsize;
  for (std::size_t j = 0; j < s.A.cols; ++j) {
    auto to = column(s.A, j);
    to += squashed(array(s.xi) * (rate * s_.noisy[j]), limit) - to * spec.dampModel;
  }
  if (spec.extended_model)
    for (std::size_t j = 0; j < s.S.cols; ++j) {
      auto to = column(s.S, j);
      to += squashed(array(s.xi) * (rate * x[j]), limit) - to * (spec.discountS + spec.dampModel);
    }
  array(s.b) += squashed(array(s.xi) * (rate * spec.factorB), limit) - array(s.b) * spec.dampModel;
}

void Semox::teach_motors(std::span<const double> y) {
  SL_CHECK(y.size() == state.taught.size());
  for (std::size_t i = 0; i < y.size(); ++i)
    state.taught[i] = std::isfinite(y[i]) ? clipped(y[i], 0.95) : state.y[i];
  state.teach = true;
}

void Semox::teach_sensors(std::span<const double> x) {
  SL_CHECK(x.size() == state.b.size());
  for (std::size_t i = 0; i < x.size(); ++i)
    s_.n1[i] = std::isfinite(x[i]) ? clipped(x[i], 1000) - state.b[i] : 0;
  multiply_transposed_matrices(state.A, state.A, s_.RA);
  for (std::size_t i = 0; i < s_.RA.rows; ++i) s_.RA(i, i) += 0.001;
  s_.A_inverse.factor(s_.RA);
  multiply_transposed(state.A, s_.n1, s_.m1);
  s_.A_inverse.apply(s_.m1, s_.delta);
  teach_motors(s_.delta.data);
}

}  // namespace sandlot::selforg
