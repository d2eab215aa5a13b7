#include "selforg/dep/dep.h"

#include "base/math.h"
#include "selforg/arrays.h"

namespace sandlot::selforg {

Status Dep::init(const Setup& setup) {
  const std::size_t n = setup.sensors, m = setup.motors;
  state = {};
  state.C = Matrix(m, n);
  state.h = state.y = norm_ = z_ = Matrix(m, 1);
  state.x = old_x_ = Matrix(n, 1);
  state.velocities.assign(buffer, Matrix(n, 1));
  // A seed of the loop: without correlations at first nothing would move.
  Stream random = setup.random(0, 2);
  for (double& each : state.C.data) each = 1e-3 * random.normal();
  for (std::size_t i = 0; i < std::min(m, n); ++i) state.C(i, i) += 0.01;
  return {};
}

void Dep::step(const Matrix& x, Matrix& y, Mode mode) {
  State& s = state;
  std::copy(s.x.data.begin(), s.x.data.end(), old_x_.data.begin());
  if (s.t == 0) {
    array(s.x) = array(x);
    array(old_x_) = array(x);
  } else {
    array(s.x) += (array(x) - array(s.x)) / spec.s4avg;
  }
  Matrix& velocity = s.velocities[s.t % buffer];
  array(velocity) = array(s.x) - array(old_x_);
  const auto distance = static_cast<std::uint64_t>(spec.timedist);
  if (mode != Mode::act && s.t > distance) {
    const Matrix& before = s.velocities[(s.t + buffer - distance) % buffer];
    const std::size_t known = std::min<std::size_t>(s.C.rows, s.C.cols);  // M: one-to-one
    for (std::size_t j = 0; j < s.C.cols; ++j)
      for (std::size_t i = 0; i < s.C.rows; ++i) {
        const double correlation = i < known ? velocity[i] * before[j] : 0;
        s.C(i, j) += spec.urate * (correlation - s.C(i, j));
      }
  }
  if (mode != Mode::babble) {
    const double floor = math::pow(10, -spec.regularization);
    norm_.set(0);
    for (std::size_t j = 0; j < s.C.cols; ++j) array(norm_) += column(s.C, j) * column(s.C, j);
    double all = 0;
    for (const double each : norm_.data) all += each;
    for (double& each : norm_.data) each = spec.synboost / (std::sqrt(spec.indnorm ? each : all) + floor);
    multiply(s.C, s.x, z_);
    array(z_) = array(z_) * array(norm_) + array(s.h);
    tanh_of(z_, y);
    if (mode == Mode::learn) array(s.h) -= spec.epsh * array(y);
  }
  array(s.y) = array(y);
  ++s.t;
}

}  // namespace sandlot::selforg
