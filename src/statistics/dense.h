#pragma once
/// Small dense linear algebra for estimates with some tens of unknowns, compiled once: no template of a matrix library in those who use it.
///
/// Determinism every sum has one order.
/// Source      G. H. Golub, C. F. Van Loan, Matrix Computations: LDL^T (4.1.2), cyclic Jacobi (8.5.4).
#include <cstddef>
#include <vector>

namespace sandlot::statistics {

/// A matrix, row by row.
struct Dense {
  std::size_t rows = 0, columns = 0;
  std::vector<double> data;

  Dense() = default;
  Dense(std::size_t height, std::size_t width) : rows(height), columns(width), data(height * width) {}
  double& operator()(std::size_t i, std::size_t j) { return data[i * columns + j]; }
  double operator()(std::size_t i, std::size_t j) const { return data[i * columns + j]; }
};

double dot(const std::vector<double>& a, const std::vector<double>& b);
inline double squared_norm(const std::vector<double>& a) { return dot(a, a); }

/// L D L^T of a symmetric matrix that is positive definite. Directions in which it is 0 or less have no part in solutions.
class Factors {
 public:
  explicit Factors(Dense symmetric);
  std::vector<double> solve(std::vector<double> right) const;
  Dense inverse() const;
  /// Smallest share that D has of the matrix's diagonal: near 0 where unknowns cannot be told apart. 1 of no unknowns.
  double least_pivot() const { return least_pivot_; }

 private:
  Dense L_;  ///< below the diagonal; D is on it
  double least_pivot_ = 1;
};

/// Eigenvalues, in ascending order, and eigenvectors, which are the columns.
struct EigenPairs {
  std::vector<double> values;
  Dense vectors;
};
EigenPairs eigen_pairs(Dense symmetric);

}  // namespace sandlot::statistics
