#pragma once
/// Slow literal matrix arithmetic in long double, against which the learning rules are tested. Nothing of selforg/matrix.cpp is used.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/random.h"
#include "selforg/matrix.h"

namespace sandlot::selforg::test {

using Real = long double;
struct Ref {
  std::size_t rows = 0, cols = 0;
  std::vector<std::vector<Real>> at;
  Ref() = default;
  Ref(std::size_t r, std::size_t c) : rows(r), cols(c), at(r, std::vector<Real>(c, 0)) {}
  Ref(const Matrix& m) : Ref(m.rows, m.cols) {  // NOLINT(google-explicit-constructor)
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < cols; ++j) at[i][j] = static_cast<Real>(m(i, j));
  }
  static Ref eye(std::size_t n) {
    Ref out(n, n);
    for (std::size_t i = 0; i < n; ++i) out.at[i][i] = 1;
    return out;
  }
  Real operator()(std::size_t i, std::size_t j = 0) const { return at[i][j]; }
  Ref T() const {
    Ref out(cols, rows);
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = 0; j < cols; ++j) out.at[j][i] = at[i][j];
    return out;
  }
  template <class F>
  Ref map(F&& f) const {
    Ref out = *this;
    for (auto& row : out.at)
      for (Real& each : row) each = f(each);
    return out;
  }
};
inline Ref operator*(const Ref& a, const Ref& b) {
  EXPECT_EQ(a.cols, b.rows);
  Ref out(a.rows, b.cols);
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j < b.cols; ++j)
      for (std::size_t k = 0; k < a.cols; ++k) out.at[i][j] += a.at[i][k] * b.at[k][j];
  return out;
}
template <class F>
Ref zip(const Ref& a, const Ref& b, F&& f) {
  EXPECT_TRUE(a.rows == b.rows && a.cols == b.cols);
  Ref out = a;
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j < a.cols; ++j) out.at[i][j] = f(a.at[i][j], b.at[i][j]);
  return out;
}
inline Ref operator+(const Ref& a, const Ref& b) {
  return zip(a, b, [](Real x, Real y) { return x + y; });
}
inline Ref operator-(const Ref& a, const Ref& b) {
  return zip(a, b, [](Real x, Real y) { return x - y; });
}
inline Ref operator*(Real f, const Ref& a) {
  return a.map([&](Real x) { return f * x; });
}
/// Row-wise product with a column.
inline Ref operator&(const Ref& a, const Ref& g) {
  Ref out = a;
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j < a.cols; ++j) out.at[i][j] = a.at[i][j] * g.at[i][0];
  return out;
}
inline Ref squash(const Ref& a) {
  return a.map([](Real x) { return std::tanh(x); });  // lint-ok: the reference does not use base/math.h
}
inline Ref clip(const Ref& a, Real limit) {
  return a.map([&](Real x) { return std::min(std::max(x, -limit), limit); });
}
inline Ref cube(const Ref& a) {
  return a.map([](Real x) { return x * x * x; });
}
inline Real norm2(const Ref& a) {
  Real sum = 0;
  for (const auto& row : a.at)
    for (const Real each : row) sum += each * each;
  return sum;
}
/// Gauss-Jordan with full pivoting of rows.
inline Ref inverse(Ref m) {
  const std::size_t n = m.rows;
  Ref out = Ref::eye(n);
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < n; ++i)
      if (std::abs(m.at[i][k]) > std::abs(m.at[pivot][k])) pivot = i;
    std::swap(m.at[k], m.at[pivot]);
    std::swap(out.at[k], out.at[pivot]);
    const Real scale = 1 / m.at[k][k];
    for (std::size_t j = 0; j < n; ++j) m.at[k][j] *= scale, out.at[k][j] *= scale;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const Real factor = m.at[i][k];
      for (std::size_t j = 0; j < n; ++j)
        m.at[i][j] -= factor * m.at[k][j], out.at[i][j] -= factor * out.at[k][j];
    }
  }
  return out;
}
/// Moore-Penrose inverse of a matrix of full rank.
inline Ref pinv(const Ref& m) {
  if (m.rows >= m.cols) return inverse(m.T() * m) * m.T();
  return m.T() * inverse(m * m.T());
}

inline Matrix random_matrix(Stream& random, std::size_t rows, std::size_t cols, double scale = 1) {
  Matrix out(rows, cols);
  for (double& each : out.data) each = scale * random.uniform(-1, 1);
  return out;
}

inline void expect_near(const Matrix& got, const Ref& wanted, double tolerance, const char* what) {
  ASSERT_TRUE(got.rows == wanted.rows && got.cols == wanted.cols) << what;
  for (std::size_t i = 0; i < wanted.rows; ++i)
    for (std::size_t j = 0; j < wanted.cols; ++j)
      ASSERT_NEAR(got(i, j), static_cast<double>(wanted(i, j)),
                  tolerance * (1 + std::abs(static_cast<double>(wanted(i, j)))))
          << what << "[" << i << "," << j << "]";
}

}  // namespace sandlot::selforg::test
