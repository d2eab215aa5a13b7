#pragma once
/// Matrix of a controller's State, and the few operations of the learning rules with a fixed order of additions.
///
/// Eigen's own products choose the order of their sums by sizes, alignment and instruction set. Here each element of a result
/// is summed in ascending order of the inner index, without fused multiply-adds, so that every compiler and every level of
/// optimisation gives the same bits. selforg/arrays.h has views for Eigen's arithmetic element by element.
///
/// Heap     none in any function below, as long as the results have the right size; SL_CHECK holds them to it.
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "base/fields.h"

namespace sandlot::selforg {

/// Column-major matrix of doubles; a vector is a matrix with one column.
struct Matrix {
  std::uint32_t rows = 0, cols = 0;
  std::vector<double> data;

  Matrix() = default;
  Matrix(std::size_t r, std::size_t c, double value = 0)
      : rows(static_cast<std::uint32_t>(r)), cols(static_cast<std::uint32_t>(c)), data(r * c, value) {}
  /// `scale` on the main diagonal, zero elsewhere.
  static Matrix identity(std::size_t r, std::size_t c, double scale = 1);

  double& operator()(std::size_t i, std::size_t j) { return data[i + j * rows]; }
  double operator()(std::size_t i, std::size_t j) const { return data[i + j * rows]; }
  double& operator[](std::size_t i) { return data[i]; }
  double operator[](std::size_t i) const { return data[i]; }
  std::size_t size() const { return data.size(); }
  void set(double value) { std::fill(data.begin(), data.end(), value); }
  std::span<const double> values() const { return data; }

  static void fields(auto& s, auto&& visit) {
    visit(Field{"rows", "1", "Number of rows."}, s.rows);
    visit(Field{"cols", "1", "Number of columns."}, s.cols);
    visit(Field{"data", "", "Elements, column after column."}, s.data);
  }
};

/// out = A x
void multiply(const Matrix& A, const Matrix& x, Matrix& out);
/// out = A^T x
void multiply_transposed(const Matrix& A, const Matrix& x, Matrix& out);
/// out = A B
void multiply_matrices(const Matrix& A, const Matrix& B, Matrix& out);
/// out = A B^T
void multiply_by_transposed(const Matrix& A, const Matrix& B, Matrix& out);
/// out = A^T B
void multiply_transposed_matrices(const Matrix& A, const Matrix& B, Matrix& out);
/// out = A (B & g): row i of B times g[i]
void multiply_scaled_rows(const Matrix& A, const Matrix& B, const Matrix& g, Matrix& out);
/// Sum of squares in ascending order.
double squared_norm(const Matrix& x);
/// tanh element by element, by base/math.h.
void tanh_of(const Matrix& z, Matrix& out);

/// Number within +-limit; 0 in place of one that is not a number.
inline double clipped(double x, double limit) {
  return x > limit ? limit : x < -limit ? -limit : x == x ? x : 0;
}

/// Whether all elements are finite.
bool all_finite(std::span<const double> x);

/// Inverse or Moore-Penrose pseudo-inverse as an operator: factors once, then is applied to vectors.
///
/// Square M       LU decomposition with partial pivoting.
/// Other shapes   the normal equations with Cholesky: M^+ = (M^T M)^-1 M^T or M^T (M M^T)^-1.
/// Singular M     a pivot below 1e-12 of the largest element: the normal equations with `regularisation` times the mean of
///                their diagonal added to it (at least 1e-12), so that the result is finite and small where M gives no information.
class PseudoInverse {
 public:
  static constexpr double regularisation = 1e-8;
  PseudoInverse() = default;
  PseudoInverse(std::size_t rows, std::size_t cols);
  void factor(const Matrix& M);
  /// out = M^+ x
  void apply(const Matrix& x, Matrix& out);
  /// out = (M^+)^T x
  void apply_transposed(const Matrix& x, Matrix& out);
  bool singular() const { return singular_; }

 private:
  bool factor_lu();
  bool factor_cholesky(double shift);
  void solve_cholesky(Matrix& x) const;

  Matrix m_, lu_, normal_, small_;
  std::vector<std::uint32_t> order_;
  bool use_lu_ = false, singular_ = false;
};

}  // namespace sandlot::selforg
