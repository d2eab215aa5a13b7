#include "navigation/estimation/ekf_model.h"

#include <Eigen/Core>
#include <cmath>

#include "base/check.h"
#include "base/math.h"
#include "navigation/estimation/innovation_factor.h"

namespace sandlot::navigation::ekf {
namespace {

// Operations on whole rows, element by element: no order of additions is left to the vector unit.
using Row = Eigen::Map<Eigen::Array<double, Matrix::stride, 1>>;
using ConstRow = Eigen::Map<const Eigen::Array<double, Matrix::stride, 1>>;
using RowValue = Eigen::Array<double, Matrix::stride, 1>;

/// M becomes F M.
void apply_transition(const Transition& F, Matrix& M) {
  const double dt = F.dt_s, half = 0.5 * dt * dt;
  // Position first: it needs the angles, velocities and accelerations as they were.
  for (std::size_t i = 0; i < 3; ++i) {
    RowValue sum = ConstRow(M.row(X + i));
    for (std::size_t j = 0; j < 3; ++j) sum += F.position_by_angles[i][j] * ConstRow(M.row(Roll + j));
    for (std::size_t j = 0; j < 3; ++j) sum += (F.rotation[i][j] * dt) * ConstRow(M.row(Vx + j));
    for (std::size_t j = 0; j < 3; ++j) sum += (F.rotation[i][j] * half) * ConstRow(M.row(Ax + j));
    Row(M.row(X + i)) = sum;
  }
  const RowValue roll = ConstRow(M.row(Roll)), pitch = ConstRow(M.row(Pitch));
  for (std::size_t i = 0; i < 3; ++i) {
    RowValue sum = ConstRow(M.row(Roll + i));
    sum += F.angles_by_angles[i][0] * roll;
    sum += F.angles_by_angles[i][1] * pitch;
    for (std::size_t j = 0; j < 3; ++j) sum += (F.angles_by_rates[i][j] * dt) * ConstRow(M.row(Vroll + j));
    Row(M.row(Roll + i)) = sum;
  }
  for (std::size_t i = 0; i < 3; ++i) Row(M.row(Vx + i)) += dt * ConstRow(M.row(Ax + i));
}

void transpose(Matrix& M) {
  for (std::size_t i = 0; i < states; ++i)
    for (std::size_t j = i + 1; j < states; ++j) std::swap(M.at(i, j), M.at(j, i));
}

/// Both triangles become their mean.
void symmetrise(Matrix& M) {
  for (std::size_t i = 0; i < states; ++i)
    for (std::size_t j = i + 1; j < states; ++j) M.at(i, j) = M.at(j, i) = 0.5 * (M.at(i, j) + M.at(j, i));
}

struct Turned {
  double sr, cr, sp, cp, sy, cy;
  explicit Turned(const Vector& x) {
    const auto roll = math::sincos(x[Roll]), pitch = math::sincos(x[Pitch]), yaw = math::sincos(x[Yaw]);
    sr = roll.sin, cr = roll.cos, sp = pitch.sin, cp = pitch.cos, sy = yaw.sin, cy = yaw.cos;
  }
  double divisor() const { return std::abs(cp) < 1e-6 ? std::copysign(1e-6, cp) : cp; }
};

Vector moved_by(const Vector& x, const Transition& F) {
  const double dt = F.dt_s;
  Vector out = x;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      out[X + i] += F.rotation[i][j] * (x[Vx + j] * dt + 0.5 * x[Ax + j] * dt * dt);
      out[Roll + i] += F.angles_by_rates[i][j] * x[Vroll + j] * dt;
    }
    out[Vx + i] += x[Ax + i] * dt;
  }
  wrap_angles(out);
  return out;
}

/// The number of components is known to the compiler, which then keeps rows in registers.
template <std::size_t m>
Correction correct_by(Vector& x, Matrix& P, const Innovation& innovation, double gate) {
  constexpr std::size_t stride = Matrix::stride;
  const auto noise = [&](std::size_t i, std::size_t j) { return innovation.noise[i * m + j]; };
  InnovationFactor<m> factor;
  const Correction result = factor.factorise(
      m,
      [&](std::size_t i, std::size_t j) {
        return P.at(innovation.index[i], innovation.index[j]) + noise(i, j);
      },
      innovation.y.data(), gate);
  if (result.is != Correction::Is::used) return result;

  // K^T = S^-1 H P, and H P, row by row.
  std::array<double, m * stride> HP, KT;
  const auto gain = [&](std::size_t i) { return Row(&KT[i * stride]); };
  for (std::size_t i = 0; i < m; ++i) gain(i) = Row(&HP[i * stride]) = ConstRow(P.row(innovation.index[i]));
  factor.solve(m, gain);
  // A = (I - K H) P, then P = A (I - K H)^T + K N K^T = A - (A H^T - K N) K^T.
  for (std::size_t r = 0; r < states; ++r) {
    RowValue sum = ConstRow(P.row(r));
    for (std::size_t i = 0; i < m; ++i) sum -= KT[i * stride + r] * ConstRow(&HP[i * stride]);
    std::array<double, m> rest;
    for (std::size_t i = 0; i < m; ++i) {
      rest[i] = sum[static_cast<Eigen::Index>(innovation.index[i])];
      for (std::size_t j = 0; j < m; ++j) rest[i] -= KT[j * stride + r] * noise(j, i);
    }
    for (std::size_t i = 0; i < m; ++i) sum -= rest[i] * ConstRow(&KT[i * stride]);
    Row(P.row(r)) = sum;
  }
  symmetrise(P);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t r = 0; r < states; ++r) x[r] += KT[i * stride + r] * innovation.y[i];
  wrap_angles(x);
  return result;
}

}  // namespace

Transition transition(const Vector& x, double dt) {
  const Turned a(x);
  Transition F;
  F.dt_s = dt;
  F.rotation = {{{a.cy * a.cp, a.cy * a.sp * a.sr - a.sy * a.cr, a.cy * a.sp * a.cr + a.sy * a.sr},
                 {a.sy * a.cp, a.sy * a.sp * a.sr + a.cy * a.cr, a.sy * a.sp * a.cr - a.cy * a.sr},
                 {-a.sp, a.cp * a.sr, a.cp * a.cr}}};
  std::array<double, 3> way_B, way_W{};
  for (std::size_t j = 0; j < 3; ++j) way_B[j] = x[Vx + j] * dt + 0.5 * x[Ax + j] * dt * dt;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) way_W[i] += F.rotation[i][j] * way_B[j];
  // By roll, R's columns y and z turn into each other; by pitch the way turns about the horizontal axis across the
  // heading; by yaw about z.
  const double ahead = a.cp * way_B[0] + a.sp * (a.sr * way_B[1] + a.cr * way_B[2]);
  for (std::size_t i = 0; i < 3; ++i)
    F.position_by_angles[i][0] = F.rotation[i][2] * way_B[1] - F.rotation[i][1] * way_B[2];
  F.position_by_angles[0][1] = a.cy * way_W[2];
  F.position_by_angles[1][1] = a.sy * way_W[2];
  F.position_by_angles[2][1] = -ahead;
  F.position_by_angles[0][2] = -way_W[1];
  F.position_by_angles[1][2] = way_W[0];

  const double c = a.divisor(), t = a.sp / c;
  F.angles_by_rates = {{{1, t * a.sr, t * a.cr}, {0, a.cr, -a.sr}, {0, a.sr / c, a.cr / c}}};
  const double across = a.sr * x[Vpitch] + a.cr * x[Vyaw];  // rate about B's y and z, along the turned axis
  const double along = a.cr * x[Vpitch] - a.sr * x[Vyaw];   // its derivative by roll
  F.angles_by_angles = {{{t * along * dt, across * dt / (c * c)},
                         {-across * dt, 0},
                         {along * dt / c, across * a.sp * dt / (c * c)}}};
  return F;
}

Matrix dense(const Transition& F) {
  Matrix M;
  for (std::size_t i = 0; i < states; ++i) M.at(i, i) = 1;
  apply_transition(F, M);
  return M;
}

Vector moved(const Vector& x, double dt_s) { return moved_by(x, transition(x, dt_s)); }

void predict(Vector& x, Matrix& P, const Vector& noise_per_s, double dt_s) {
  SL_CHECK(dt_s >= 0);
  const Transition F = transition(x, dt_s);
  // F (F P)^T = F P F^T, since P is symmetric.
  apply_transition(F, P);
  transpose(P);
  apply_transition(F, P);
  symmetrise(P);
  for (std::size_t i = 0; i < states; ++i) P.at(i, i) += noise_per_s[i] * dt_s;
  x = moved_by(x, F);
}

Correction correct(Vector& x, Matrix& P, const Innovation& innovation, double gate) {
  switch (innovation.count) {
    case 1: return correct_by<1>(x, P, innovation, gate);
    case 2: return correct_by<2>(x, P, innovation, gate);
    case 3: return correct_by<3>(x, P, innovation, gate);
    case 4: return correct_by<4>(x, P, innovation, gate);
    case 5: return correct_by<5>(x, P, innovation, gate);
    case 6: return correct_by<6>(x, P, innovation, gate);
    default: break;
  }
  SL_CHECK_MSG(false, "1 to 6 components");
}

void wrap_angles(Vector& x) {
  for (const std::size_t i : {Roll, Pitch, Yaw}) x[i] = math::wrap_angle(x[i]);
}

}  // namespace sandlot::navigation::ekf
