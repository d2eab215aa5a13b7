#pragma once
/// Extended Kalman filter of 15 states: motion model, prediction and correction. What remembers measurements and puts them
/// in order is in ekf.h.
///
/// State      x y z, roll pitch yaw of base_link B in the world frame W; vx vy vz and rates about x y z of B, in B;
///            ax ay az of B, in B: the order of robot_localization.
/// Motion     constant acceleration, in every direction. With R = Rz(yaw) Ry(pitch) Rx(roll), s and c sine and cosine:
///
///              p     += R (v dt + a dt^2 / 2)
///              roll  += (w_x + tan(pitch) (s_roll w_y + c_roll w_z)) dt
///              pitch += (c_roll w_y - s_roll w_z) dt
///              yaw   += (s_roll w_y + c_roll w_z) / c_pitch dt
///              v     += a dt
///              P      = F P F^T + Q dt,   F = df/dx
///
/// Correction in the form of Joseph, which keeps P symmetric and positive definite whatever the gain:
///
///              S = H P H^T + N,  K = P H^T S^-1,  x += K y,  P = (I - K H) P (I - K H)^T + K N K^T
///
///            H picks components of the state. P is made exactly symmetric after each step.
/// Angles     roll, pitch and yaw are in (-pi, pi] after each step. At |cos(pitch)| < 1e-6 the cosine counts as 1e-6.
/// Limits     the velocity of B changes by a alone: turning does not turn it in B, as in robot_localization. One step of
///            dt is linearised once, however long.
/// Determinism every sum has one order, whatever the vector unit, so the bits do not depend on compiler or CPU.
/// Cost       a prediction takes 54 row operations of 15 numbers twice (F is sparse), a correction of m components 30 m; no
///            allocation.
/// Source     T. Moore, D. Stouch, A Generalized Extended Kalman Filter Implementation for the Robot Operating System (2014);
///            P. S. Maybeck, Stochastic Models, Estimation and Control, vol. 1 (1979), ch. 5.
#include <array>
#include <cstddef>
#include <span>

#include "base/fields.h"

namespace sandlot::navigation::ekf {

inline constexpr std::size_t states = 15;

/// Index of a component of the state.
enum Index : std::size_t { X, Y, Z, Roll, Pitch, Yaw, Vx, Vy, Vz, Vroll, Vpitch, Vyaw, Ax, Ay, Az };

using Vector = std::array<double, states>;

/// Matrix of 15 x 15. Rows are padded to 16 numbers, which whole vector registers fill; the padding stays 0.
struct Matrix {
  static constexpr std::size_t stride = 16;
  static constexpr std::size_t extent = states * states;  ///< for field lists: row by row, without padding
  std::array<double, states * stride> padded{};

  double* row(std::size_t i) { return &padded[i * stride]; }
  const double* row(std::size_t i) const { return &padded[i * stride]; }
  double& at(std::size_t i, std::size_t j) { return padded[i * stride + j]; }
  double at(std::size_t i, std::size_t j) const { return padded[i * stride + j]; }
  double& operator[](std::size_t k) { return padded[k / states * stride + k % states]; }
  const double& operator[](std::size_t k) const { return padded[k / states * stride + k % states]; }
  friend bool operator==(const Matrix&, const Matrix&) = default;
};

/// Derivative F of the motion over dt, without its zeros: F is the identity plus these blocks.
struct Transition {
  double dt_s = 0;
  std::array<std::array<double, 3>, 3> rotation{};            ///< R, of B in W
  std::array<std::array<double, 3>, 3> position_by_angles{};  ///< of x y z by roll pitch yaw
  std::array<std::array<double, 3>, 3> angles_by_rates{};     ///< times dt
  /// Of roll pitch yaw by roll and pitch, less the identity.
  std::array<std::array<double, 2>, 3> angles_by_angles{};
};

/// F at a state.
Transition transition(const Vector& x, double dt_s);
/// F with its zeros.
Matrix dense(const Transition& F);
/// State after dt, without noise.
Vector moved(const Vector& x, double dt_s);

/// Goes dt ahead.
/// @param noise_per_s  diagonal of Q, [unit^2/s]
/// @pre dt_s >= 0
void predict(Vector& x, Matrix& P, const Vector& noise_per_s, double dt_s);

inline constexpr std::size_t most_measured = 6;

/// Innovation of components of the state.
struct Innovation {
  std::size_t count = 0;
  std::array<std::size_t, most_measured> index{};
  std::array<double, most_measured> y{};                      ///< measured less predicted; angles wrapped
  std::array<double, most_measured * most_measured> noise{};  ///< N, count x count, row by row
};

struct Correction {
  enum class Is { used, gated, singular } is = Is::used;
  double squared_distance = 0;  ///< y^T S^-1 y: chi-square of `count` degrees of freedom when all is well
};

/// Corrects by one measurement. Nothing changes unless it is used.
/// @param gate  greatest Mahalanobis distance sqrt(y^T S^-1 y); 0: any
Correction correct(Vector& x, Matrix& P, const Innovation& innovation, double gate);

/// Roll, pitch and yaw into (-pi, pi].
void wrap_angles(Vector& x);

constexpr bool is_angle(std::size_t index) { return index >= Roll && index <= Yaw; }

}  // namespace sandlot::navigation::ekf
