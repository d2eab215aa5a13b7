#pragma once
/// Cholesky factor of an innovation's covariance, S = L L^T, and what follows from it for every correction: the distance for the
/// gate, and the gain's rows by two triangular solutions.
///
/// Determinism every sum has one order. Rows are operated on element by element.
/// Source      G. H. Golub, C. F. Van Loan, Matrix Computations, sec. 4.2.
#include <array>
#include <cmath>
#include <cstddef>

#include "navigation/estimation/ekf_model.h"

namespace sandlot::navigation::ekf {

/// @param most  of components; where it is their number, the compiler knows how often loops run
template <std::size_t most>
struct InnovationFactor {
  std::array<std::array<double, most>, most> L{};

  /// @param covariance  covariance(i, j), j <= i: element of S
  /// @return the outcome of the gate, with y^T S^-1 y; singular where S has no factor
  template <class Covariance>
  Correction factorise(std::size_t m, const Covariance& covariance, const double* y, double gate) {
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        const double element = covariance(i, j);
        double sum = element;
        for (std::size_t k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
        if (i != j) {
          L[i][j] = sum / L[j][j];
          continue;
        }
        // What rounding alone may have left of the variance is nothing; differences of nearly equal variances leave more.
        if (!(sum > 1e-15 * element)) return {Correction::Is::singular};
        L[i][i] = std::sqrt(sum);
      }
    Correction result;
    std::array<double, most> white{};  // L^-1 y
    for (std::size_t i = 0; i < m; ++i) {
      double sum = y[i];
      for (std::size_t k = 0; k < i; ++k) sum -= L[i][k] * white[k];
      white[i] = sum / L[i][i];
      result.squared_distance += white[i] * white[i];
    }
    if (gate > 0 && !(result.squared_distance <= gate * gate)) result.is = Correction::Is::gated;
    return result;
  }

  /// Rows become S^-1 times the rows.
  /// @param row  row(i): an array of Eigen that writes to where the row is
  template <class Row>
  void solve(std::size_t m, const Row& row) const {
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t k = 0; k < i; ++k) row(i) -= L[i][k] * row(k);
      row(i) *= 1 / L[i][i];
    }
    for (std::size_t i = m; i-- > 0;) {
      for (std::size_t k = i + 1; k < m; ++k) row(i) -= L[k][i] * row(k);
      row(i) *= 1 / L[i][i];
    }
  }
};

}  // namespace sandlot::navigation::ekf
