#include "selforg/matrix.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/math.h"
#include "selforg/arrays.h"

namespace sandlot::selforg {

Matrix Matrix::identity(std::size_t r, std::size_t c, double scale) {
  Matrix out(r, c);
  for (std::size_t i = 0; i < std::min(r, c); ++i) out(i, i) = scale;
  return out;
}

void multiply(const Matrix& A, const Matrix& x, Matrix& out) {
  SL_CHECK(A.cols == x.size() && A.rows == out.size());
  out.set(0);
  for (std::size_t k = 0; k < A.cols; ++k) array(out) += column(A, k) * x[k];
}

void multiply_transposed(const Matrix& A, const Matrix& x, Matrix& out) {
  SL_CHECK(A.rows == x.size() && A.cols == out.size());
  const std::size_t n = A.rows;
  std::size_t j = 0;
  // Four sums at a time: each is a chain of additions of its own.
  for (; j + 4 <= A.cols; j += 4) {
    const double* const a = A.data.data() + j * n;
    double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    for (std::size_t i = 0; i < n; ++i) {
      s0 += a[i] * x[i];
      s1 += a[n + i] * x[i];
      s2 += a[2 * n + i] * x[i];
      s3 += a[3 * n + i] * x[i];
    }
    out[j] = s0, out[j + 1] = s1, out[j + 2] = s2, out[j + 3] = s3;
  }
  for (; j < A.cols; ++j) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += A(i, j) * x[i];
    out[j] = sum;
  }
}

namespace {

/// out = A B, where b(k, j) gives the elements of B. Columns of eight rows stay in registers.
template <class B>
void product(const Matrix& A, std::size_t cols, B&& b, Matrix& out) {
  constexpr Eigen::Index block = 8;
  using Block = Eigen::Array<double, block, 1>;
  const std::size_t n = A.rows, inner = A.cols;
  for (std::size_t j = 0; j < cols; ++j) {
    double* const to = out.data.data() + j * n;
    std::size_t i = 0;
    for (; i + block <= n; i += block) {
      Block sum = Block::Zero();
      for (std::size_t k = 0; k < inner; ++k)
        sum += Eigen::Map<const Block>(A.data.data() + k * n + i) * b(k, j);
      Eigen::Map<Block>(to + i) = sum;
    }
    for (; i < n; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < inner; ++k) sum += A(i, k) * b(k, j);
      to[i] = sum;
    }
  }
}

}  // namespace

void multiply_matrices(const Matrix& A, const Matrix& B, Matrix& out) {
  SL_CHECK(A.cols == B.rows && out.rows == A.rows && out.cols == B.cols && &out != &A && &out != &B);
  product(
      A, B.cols, [&](std::size_t k, std::size_t j) { return B(k, j); }, out);
}

void multiply_by_transposed(const Matrix& A, const Matrix& B, Matrix& out) {
  SL_CHECK(A.cols == B.cols && out.rows == A.rows && out.cols == B.rows && &out != &A && &out != &B);
  product(
      A, B.rows, [&](std::size_t k, std::size_t j) { return B(j, k); }, out);
}

void multiply_transposed_matrices(const Matrix& A, const Matrix& B, Matrix& out) {
  SL_CHECK(A.rows == B.rows && out.rows == A.cols && out.cols == B.cols && &out != &A && &out != &B);
  for (std::size_t j = 0; j < B.cols; ++j)
    for (std::size_t i = 0; i < A.cols; ++i) {
      double sum = 0;
      for (std::size_t k = 0; k < A.rows; ++k) sum += A(k, i) * B(k, j);
      out(i, j) = sum;
    }
}

void multiply_scaled_rows(const Matrix& A, const Matrix& B, const Matrix& g, Matrix& out) {
  SL_CHECK(A.cols == B.rows && g.size() == B.rows && out.rows == A.rows && out.cols == B.cols);
  SL_CHECK(&out != &A && &out != &B);
  product(
      A, B.cols, [&](std::size_t k, std::size_t j) { return B(k, j) * g[k]; }, out);
}

double squared_norm(const Matrix& x) {
  double sum = 0;
  for (const double each : x.data) sum += each * each;
  return sum;
}

void tanh_of(const Matrix& z, Matrix& out) {
  SL_CHECK(z.size() == out.size());
  for (std::size_t i = 0; i < z.size(); ++i) out[i] = math::tanh(z[i]);
}

bool all_finite(std::span<const double> x) {
  return std::all_of(x.begin(), x.end(), [](double each) { return std::isfinite(each); });
}

PseudoInverse::PseudoInverse(std::size_t rows, std::size_t cols)
    : m_(rows, cols),
      lu_(rows == cols ? rows : 0, rows == cols ? rows : 0),
      normal_(std::min(rows, cols), std::min(rows, cols)),
      small_(std::max(rows, cols), 1),
      order_(rows) {}

void PseudoInverse::factor(const Matrix& M) {
  SL_CHECK(M.rows == m_.rows && M.cols == m_.cols);
  std::copy(M.data.begin(), M.data.end(), m_.data.begin());
  singular_ = false;
  use_lu_ = M.rows == M.cols && M.rows > 0 && factor_lu();
  if (use_lu_ || m_.size() == 0) return;
  singular_ = M.rows == M.cols || !factor_cholesky(0);
  if (!singular_) return;
  double trace = 0;
  for (std::size_t j = 0; j < M.cols; ++j)
    for (std::size_t i = 0; i < M.rows; ++i) trace += M(i, j) * M(i, j);
  const double mean = trace / static_cast<double>(normal_.rows);
  if (!factor_cholesky(std::max(regularisation * mean, 1e-12))) normal_.set(0);
}

/// Row by row order in `order_`, L below the diagonal (its own is 1), the reciprocal of U's diagonal on it.
bool PseudoInverse::factor_lu() {
  const std::size_t n = m_.rows;
  std::copy(m_.data.begin(), m_.data.end(), lu_.data.begin());
  double largest = 0;
  for (const double each : lu_.data) largest = std::max(largest, std::abs(each));
  for (std::size_t i = 0; i < n; ++i) order_[i] = static_cast<std::uint32_t>(i);
  if (!std::isfinite(largest)) return false;
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(lu_(i, k)) > std::abs(lu_(pivot, k))) pivot = i;
    if (!(std::abs(lu_(pivot, k)) > 1e-12 * largest)) return false;
    if (pivot != k) {
      std::swap(order_[k], order_[pivot]);
      for (std::size_t j = 0; j < n; ++j) std::swap(lu_(k, j), lu_(pivot, j));
    }
    const double scale = 1 / lu_(k, k);
    const auto below = static_cast<Eigen::Index>(n - k - 1);
    auto factors = column(lu_, k).tail(below);
    factors *= scale;
    for (std::size_t j = k + 1; j < n; ++j) column(lu_, j).tail(below) -= factors * lu_(k, j);
    lu_(k, k) = scale;
  }
  return true;
}

/// Lower triangle of the normal matrix, with reciprocals on the diagonal.
bool PseudoInverse::factor_cholesky(double shift) {
  const std::size_t k = normal_.rows;
  if (m_.rows >= m_.cols) multiply_transposed_matrices(m_, m_, normal_);
  else multiply_by_transposed(m_, m_, normal_);
  double largest = 0;
  for (std::size_t i = 0; i < k; ++i) {
    normal_(i, i) += shift;
    largest = std::max(largest, normal_(i, i));
  }
  if (!std::isfinite(largest)) return false;
  for (std::size_t j = 0; j < k; ++j) {
    const double pivot = normal_(j, j);
    // Without a shift the bound is the square of what a pivot of M itself may be, as far as doubles resolve it.
    if (!(pivot > 1e-14 * largest) || !(pivot > 0)) {
      if (shift == 0) return false;
      for (std::size_t i = j; i < k; ++i) normal_(i, j) = 0;  // this direction gives nothing
      continue;
    }
    const double scale = 1 / std::sqrt(pivot);
    const auto rest = static_cast<Eigen::Index>(k - j - 1);
    normal_(j, j) = scale;
    column(normal_, j).tail(rest) *= scale;
    for (std::size_t i = j + 1; i < k; ++i) {
      const auto below = static_cast<Eigen::Index>(k - i);
      column(normal_, i).tail(below) -= column(normal_, j).tail(below) * normal_(i, j);
    }
  }
  return true;
}

void PseudoInverse::solve_cholesky(Matrix& x) const {
  const std::size_t k = normal_.rows;
  for (std::size_t j = 0; j < k; ++j) {
    x[j] *= normal_(j, j);
    for (std::size_t i = j + 1; i < k; ++i) x[i] -= normal_(i, j) * x[j];
  }
  for (std::size_t j = k; j-- > 0;) {
    double sum = x[j];
    for (std::size_t i = j + 1; i < k; ++i) sum -= normal_(i, j) * x[i];
    x[j] = sum * normal_(j, j);
  }
}

void PseudoInverse::apply(const Matrix& x, Matrix& out) {
  SL_CHECK(x.size() == m_.rows && out.size() == m_.cols && &x != &out);
  const std::size_t n = m_.rows, m = m_.cols;
  if (use_lu_) {
    for (std::size_t i = 0; i < n; ++i) out[i] = x[order_[i]];
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = j + 1; i < n; ++i) out[i] -= lu_(i, j) * out[j];
    for (std::size_t j = n; j-- > 0;) {
      out[j] *= lu_(j, j);
      for (std::size_t i = 0; i < j; ++i) out[i] -= lu_(i, j) * out[j];
    }
    return;
  }
  if (n >= m) {  // (M^T M)^-1 M^T x
    multiply_transposed(m_, x, out);
    solve_cholesky(out);
  } else {  // M^T (M M^T)^-1 x
    for (std::size_t i = 0; i < n; ++i) small_[i] = x[i];
    solve_cholesky(small_);
    for (std::size_t j = 0; j < m; ++j) {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += m_(i, j) * small_[i];
      out[j] = sum;
    }
  }
}

void PseudoInverse::apply_transposed(const Matrix& x, Matrix& out) {
  SL_CHECK(x.size() == m_.cols && out.size() == m_.rows && &x != &out);
  const std::size_t n = m_.rows, m = m_.cols;
  if (use_lu_) {  // U^T L^T P out = x
    for (std::size_t j = 0; j < n; ++j) {
      double sum = x[j];
      for (std::size_t i = 0; i < j; ++i) sum -= lu_(i, j) * small_[i];
      small_[j] = sum * lu_(j, j);
    }
    for (std::size_t j = n; j-- > 0;) {
      double sum = small_[j];
      for (std::size_t i = j + 1; i < n; ++i) sum -= lu_(i, j) * small_[i];
      small_[j] = sum;
    }
    for (std::size_t i = 0; i < n; ++i) out[order_[i]] = small_[i];
    return;
  }
  if (n >= m) {  // M (M^T M)^-1 x
    for (std::size_t j = 0; j < m; ++j) small_[j] = x[j];
    solve_cholesky(small_);
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < m; ++j) sum += m_(i, j) * small_[j];
      out[i] = sum;
    }
  } else {  // (M M^T)^-1 M x
    multiply(m_, x, out);
    solve_cholesky(out);
  }
}

}  // namespace sandlot::selforg
