#include "statistics/dense.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.h"

namespace sandlot::statistics {

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  SL_CHECK(a.size() == b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

Factors::Factors(Dense symmetric) : L_(std::move(symmetric)) {
  SL_CHECK(L_.rows == L_.columns);
  const std::size_t n = L_.rows;
  for (std::size_t j = 0; j < n; ++j) {
    double d = L_(j, j);
    for (std::size_t k = 0; k < j; ++k) d -= L_(j, k) * L_(j, k) * L_(k, k);
    least_pivot_ = L_(j, j) > 0 ? std::min(least_pivot_, d / L_(j, j)) : 0;
    L_(j, j) = d = std::max(d, 0.0);
    for (std::size_t i = j + 1; i < n; ++i) {
      double l = L_(i, j);
      for (std::size_t k = 0; k < j; ++k) l -= L_(i, k) * L_(j, k) * L_(k, k);
      L_(i, j) = d > 0 ? l / d : 0;
    }
  }
}

std::vector<double> Factors::solve(std::vector<double> right) const {
  const std::size_t n = L_.rows;
  SL_CHECK(right.size() == n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < i; ++k) right[i] -= L_(i, k) * right[k];
  for (std::size_t i = 0; i < n; ++i) right[i] = L_(i, i) > 0 ? right[i] / L_(i, i) : 0;
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t k = i + 1; k < n; ++k) right[i] -= L_(k, i) * right[k];
  return right;
}

Dense Factors::inverse() const {
  Dense out(L_.rows, L_.rows);
  for (std::size_t j = 0; j < L_.rows; ++j) {
    std::vector<double> unit(L_.rows, 0);
    unit[j] = 1;
    const std::vector<double> column = solve(std::move(unit));
    for (std::size_t i = 0; i < L_.rows; ++i) out(i, j) = column[i];
  }
  return out;
}

namespace {

/// Turns rows and columns p and q of a symmetric matrix so that their common element becomes 0.
void rotate(Dense& A, Dense& vectors, std::size_t p, std::size_t q) {
  if (A(p, q) == 0) return;
  const std::size_t n = A.rows;
  const double theta = (A(q, q) - A(p, p)) / (2 * A(p, q));
  const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1), s = t * c;
  for (std::size_t k = 0; k < n; ++k) {
    const double kp = A(k, p), kq = A(k, q);
    A(k, p) = c * kp - s * kq;
    A(k, q) = s * kp + c * kq;
  }
  for (std::size_t k = 0; k < n; ++k) {
    const double pk = A(p, k), qk = A(q, k);
    A(p, k) = c * pk - s * qk;
    A(q, k) = s * pk + c * qk;
  }
  A(p, q) = A(q, p) = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double kp = vectors(k, p), kq = vectors(k, q);
    vectors(k, p) = c * kp - s * kq;
    vectors(k, q) = s * kp + c * kq;
  }
}

}  // namespace

EigenPairs eigen_pairs(Dense symmetric) {
  SL_CHECK(symmetric.rows == symmetric.columns);
  const std::size_t n = symmetric.rows;
  Dense A = std::move(symmetric), vectors(n, n);
  for (std::size_t i = 0; i < n; ++i) vectors(i, i) = 1;
  // Each sweep about squares what is left beside the diagonal: ten are more than enough.
  constexpr int most_sweeps = 30;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double beside = 0, all = 0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        all += A(i, j) * A(i, j);
        if (i != j) beside += A(i, j) * A(i, j);
      }
    if (!(beside > 1e-34 * all)) break;
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t q = p + 1; q < n; ++q) rotate(A, vectors, p, q);
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return A(a, a) < A(b, b); });
  EigenPairs out{{}, Dense(n, n)};
  for (std::size_t j = 0; j < n; ++j) {
    out.values.push_back(A(order[j], order[j]));
    for (std::size_t i = 0; i < n; ++i) out.vectors(i, j) = vectors(i, order[j]);
  }
  return out;
}

}  // namespace sandlot::statistics
