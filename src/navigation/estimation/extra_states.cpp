#include "navigation/estimation/extra_states.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/math.h"
#include "navigation/estimation/innovation_factor.h"

namespace sandlot::navigation::ekf {
namespace {

// Operations on whole rows, element by element, as in ekf_model.cpp.
using JointRow = Eigen::Map<Eigen::ArrayXd>;
using ConstJointRow = Eigen::Map<const Eigen::ArrayXd>;

constexpr std::size_t widest = Measurement::columns;

/// Joint covariance: square, of extra.stride() rows. Not filled until it is used.
struct Joint {
  std::size_t n;
  std::array<double, widest * widest> numbers;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  double* row(std::size_t r) { return &numbers[r * n]; }
};

void fill_joint(const Matrix& P, const ExtraStates& extra, Joint& joint) {
  joint.n = extra.stride();
  std::fill_n(joint.numbers.begin(), joint.n * joint.n, 0.0);
  for (std::size_t r = 0; r < states; ++r) std::copy_n(P.row(r), states, joint.row(r));
  for (std::size_t s = 0; s < extra.slots(); ++s)
    for (std::size_t i = 0; i < ExtraStates::per_slot; ++i) {
      const double* from = extra.row(s, i);
      const std::size_t c = ExtraStates::column(s, i);
      std::copy_n(from, joint.n, joint.row(c));
      for (std::size_t r = 0; r < states; ++r) joint.row(r)[c] = from[r];
    }
}

/// Both triangles become their mean.
void take_joint(Joint& joint, Matrix& P, ExtraStates& extra) {
  const auto mean = [&](std::size_t a, std::size_t b) { return 0.5 * (joint.row(a)[b] + joint.row(b)[a]); };
  for (std::size_t r = 0; r < states; ++r)
    for (std::size_t c = 0; c < states; ++c) P.at(r, c) = mean(r, c);
  for (std::size_t s = 0; s < extra.slots(); ++s)
    for (std::size_t i = 0; i < ExtraStates::per_slot; ++i)
      for (std::size_t c = 0; c < joint.n; ++c) extra.row(s, i)[c] = mean(ExtraStates::column(s, i), c);
}

}  // namespace

bool ExtraStates::sound(std::size_t wanted, double most) const {
  if (x.size() != wanted * per_slot || covariance.size() != x.size() * stride()) return false;
  const auto within = [&](double each) { return std::abs(each) <= most; };  // NaN is not
  if (!std::all_of(x.begin(), x.end(), within) || !std::all_of(covariance.begin(), covariance.end(), within))
    return false;
  for (std::size_t s = 0; s < slots(); ++s)
    for (std::size_t i = 0; i < per_slot; ++i)
      if (!(variance(s, i) >= 0)) return false;
  return true;
}

void carry(ExtraStates& extra, const Transition& F) {
  const double dt = F.dt_s, half = 0.5 * dt * dt;
  for (std::size_t k = 0; k < extra.x.size(); ++k) {
    double* v = extra.row(0, k);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        v[X + i] += F.position_by_angles[i][j] * v[Roll + j] + F.rotation[i][j] * dt * v[Vx + j] +
                    F.rotation[i][j] * half * v[Ax + j];
    const double roll = v[Roll], pitch = v[Pitch];
    for (std::size_t i = 0; i < 3; ++i) {
      v[Roll + i] += F.angles_by_angles[i][0] * roll + F.angles_by_angles[i][1] * pitch;
      for (std::size_t j = 0; j < 3; ++j) v[Roll + i] += F.angles_by_rates[i][j] * dt * v[Vroll + j];
    }
    for (std::size_t i = 0; i < 3; ++i) v[Vx + i] += dt * v[Ax + i];
  }
}

void clone_pose(ExtraStates& extra, std::size_t slot, const Vector& x, const Matrix& P) {
  SL_CHECK(slot < extra.slots());
  constexpr std::size_t n = ExtraStates::per_slot;
  for (std::size_t i = 0; i < n; ++i) {
    extra.x[slot * n + i] = x[i];
    double* row = extra.row(slot, i);
    std::copy_n(P.row(i), states, row);
    for (std::size_t s = 0; s < extra.slots(); ++s)
      for (std::size_t j = 0; j < n; ++j) {
        if (s == slot) {
          row[ExtraStates::column(s, j)] = P.at(i, j);
          continue;
        }
        const double shared = extra.row(s, j)[i];
        row[ExtraStates::column(s, j)] = extra.row(s, j)[ExtraStates::column(slot, i)] = shared;
      }
  }
}

void set_slot(ExtraStates& extra, std::size_t slot, const Matrix& P, const Measurement& measurement) {
  SL_CHECK(slot < extra.slots() && measurement.count <= ExtraStates::per_slot);
  constexpr std::size_t n = ExtraStates::per_slot;
  for (std::size_t i = 0; i < n; ++i) {
    double* row = extra.row(slot, i);
    std::fill_n(row, extra.stride(), 0.0);
    extra.x[slot * n + i] = i < measurement.count ? measurement.y[i] : 0;
  }
  for (std::size_t s = 0; s < extra.slots(); ++s)
    for (std::size_t j = 0; s != slot && j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) extra.row(s, j)[ExtraStates::column(slot, i)] = 0;
  for (std::size_t i = 0; i < measurement.count; ++i) {
    double* row = extra.row(slot, i);
    for (std::size_t c = 0; c < states; ++c)
      for (std::size_t k = 0; k < states; ++k) row[c] += measurement.H[i][k] * P.at(k, c);
    for (std::size_t s = 0; s < extra.slots(); ++s)
      for (std::size_t j = 0; s != slot && j < n; ++j) {
        double shared = 0;
        for (std::size_t k = 0; k < states; ++k) shared += measurement.H[i][k] * extra.row(s, j)[k];
        row[ExtraStates::column(s, j)] = extra.row(s, j)[ExtraStates::column(slot, i)] = shared;
      }
  }
  for (std::size_t i = 0; i < measurement.count; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double both = measurement.noise[i * measurement.count + j];
      for (std::size_t k = 0; k < states; ++k) both += extra.row(slot, i)[k] * measurement.H[j][k];
      extra.row(slot, i)[ExtraStates::column(slot, j)] = extra.row(slot,
                                                                   j)[ExtraStates::column(slot, i)] = both;
    }
}

Correction correct(Vector& x, Matrix& P, ExtraStates& extra, const Measurement& measurement, double gate) {
  const std::size_t m = measurement.count;
  SL_CHECK(m >= 1 && m <= most_measured && extra.slots() <= ExtraStates::most_slots);
  Joint joint;
  fill_joint(P, extra, joint);
  const std::size_t n = joint.n;
  const auto length = static_cast<Eigen::Index>(n);
  const auto noise = [&](std::size_t i, std::size_t j) { return measurement.noise[i * m + j]; };
  const auto observed = [&](std::size_t i, const double* row) {
    double sum = 0;
    for (std::size_t c = 0; c < n; ++c)
      if (measurement.H[i][c] != 0) sum += measurement.H[i][c] * row[c];
    return sum;
  };

  std::array<double, most_measured * widest> HP{}, KT;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t c = 0; c < n; ++c)
      if (measurement.H[i][c] != 0)
        JointRow(&HP[i * n], length) += measurement.H[i][c] * ConstJointRow(joint.row(c), length);
  InnovationFactor<most_measured> factor;
  const Correction result = factor.factorise(
      m, [&](std::size_t i, std::size_t j) { return observed(j, &HP[i * n]) + noise(i, j); },
      measurement.y.data(), gate);
  if (result.is != Correction::Is::used) return result;

  // K^T = S^-1 H P
  const auto gain = [&](std::size_t i) { return JointRow(&KT[i * n], length); };
  for (std::size_t i = 0; i < m; ++i) gain(i) = ConstJointRow(&HP[i * n], length);
  factor.solve(m, gain);
  // A = (I - K H) P, then P = A (I - K H)^T + K N K^T = A - (A H^T - K N) K^T.
  for (std::size_t r = 0; r < n; ++r) {
    JointRow row(joint.row(r), length);
    for (std::size_t i = 0; i < m; ++i) row -= KT[i * n + r] * ConstJointRow(&HP[i * n], length);
    std::array<double, most_measured> rest{};
    for (std::size_t i = 0; i < m; ++i) {
      rest[i] = observed(i, joint.row(r));
      for (std::size_t j = 0; j < m; ++j) rest[i] -= KT[j * n + r] * noise(j, i);
    }
    for (std::size_t i = 0; i < m; ++i) row -= rest[i] * gain(i);
  }
  take_joint(joint, P, extra);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t r = 0; r < states; ++r) x[r] += KT[i * n + r] * measurement.y[i];
    for (std::size_t k = 0; k < extra.x.size(); ++k)
      extra.x[k] += KT[i * n + ExtraStates::column(k / ExtraStates::per_slot, k % ExtraStates::per_slot)] *
                    measurement.y[i];
  }
  wrap_angles(x);
  for (std::size_t k = 0; k < extra.x.size(); ++k)
    if (is_angle(k % ExtraStates::per_slot)) extra.x[k] = math::wrap_angle(extra.x[k]);
  return result;
}

std::array<std::array<double, 3>, 3> turns_by_angles(double pitch, double yaw) {
  const auto p = math::sincos(pitch), y = math::sincos(yaw);
  return {{{y.cos * p.cos, y.sin * p.cos, -p.sin}, {-y.sin, y.cos, 0}, {0, 0, 1}}};
}

}  // namespace sandlot::navigation::ekf
