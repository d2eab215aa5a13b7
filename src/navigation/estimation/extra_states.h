#pragma once
/// States that the filter estimates in addition to its 15 (ekf_model.h), in slots of six: poses of base_link at earlier times, from
/// which differences are measured, an offset of three numbers, of the datum, and relative errors of way and turn, two numbers for
/// each sensor that has them. They stand still; what they share with the 15
/// and with each other is their covariance, by which each measurement corrects all of them.
///
/// Layout     of the joint covariance and of H: columns 0 to 14 are the state, component i of slot s is column 16 + 8 s + i.
///            Columns between are 0. A slot that is not set is 0.
/// Correction as in ekf_model.h, with any H.
/// Determinism every sum has one order.
/// Cost       of a correction of m components with s slots: m (16 + 8 s)^2 multiplications four times; no allocation.
/// Source     S. I. Roumeliotis, J. W. Burdick, Stochastic cloning: a generalized framework for processing relative state
///            measurements (2002).
#include <array>
#include <vector>

#include "navigation/estimation/ekf_model.h"

namespace sandlot::navigation::ekf {

struct ExtraStates {
  static constexpr std::size_t per_slot = 6, most_slots = 6;
  std::vector<double> x;  ///< per_slot for each slot
  std::vector<double>
      covariance;  ///< a row of stride() for each number in x: with the 15, and with the slots

  ExtraStates() = default;
  explicit ExtraStates(std::size_t slots) : x(slots * per_slot) { covariance.resize(x.size() * stride()); }
  std::size_t slots() const { return x.size() / per_slot; }
  std::size_t stride() const { return column(slots(), 0); }
  static constexpr std::size_t column(std::size_t slot, std::size_t i) {
    return Matrix::stride + 8 * slot + i;
  }
  double* row(std::size_t slot, std::size_t i) { return &covariance[(slot * per_slot + i) * stride()]; }
  const double* row(std::size_t slot, std::size_t i) const {
    return &covariance[(slot * per_slot + i) * stride()];
  }
  double variance(std::size_t slot, std::size_t i) const { return row(slot, i)[column(slot, i)]; }
  /// Whether the numbers can be those of some filter with so many slots.
  bool sound(std::size_t slots, double most) const;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "",
                "Six numbers for each pose that differences count from, three and three unused ones for the "
                "datum, relative errors of way and turn and four unused ones for a sensor that has them."},
          s.x);
    visit(Field{"covariance", "", "Their covariance with the state and with each other, row by row."},
          s.covariance);
  }
};

/// Measurement that depends on the state and on slots: y = H (x - estimate) + noise.
struct Measurement {
  static constexpr std::size_t columns = ExtraStates::column(ExtraStates::most_slots, 0);
  std::size_t count = 0;
  std::array<double, most_measured> y{};
  std::array<std::array<double, columns>, most_measured> H{};
  std::array<double, most_measured * most_measured> noise{};  ///< count x count, row by row
};

/// Takes the slots' covariances with the state along with a prediction.
void carry(ExtraStates& extra, const Transition& F);

/// Sets a slot to the pose of now.
void clone_pose(ExtraStates& extra, std::size_t slot, const Vector& x, const Matrix& P);

/// Sets a slot to numbers of which value - H x is known, H of the state alone, with an error of its own.
/// @param measurement  H and noise; y is the value
void set_slot(ExtraStates& extra, std::size_t slot, const Matrix& P, const Measurement& measurement);

/// Corrects by one measurement. Nothing changes unless it is used.
/// @param gate  greatest Mahalanobis distance; 0: any
Correction correct(Vector& x, Matrix& P, ExtraStates& extra, const Measurement& measurement, double gate);

/// Where angles go: turns of the body, about W's axes, for one unit of roll, pitch and yaw each.
std::array<std::array<double, 3>, 3> turns_by_angles(double pitch, double yaw);

}  // namespace sandlot::navigation::ekf
