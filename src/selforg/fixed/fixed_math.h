#pragma once
/// Mathematics of agents of a fixed size: tanh, and the pseudo-inverse of a matrix, without heap, libm or other headers.
///
/// tanh       (1 - e) / (1 + e) with e = exp(-2 |x|) from a polynomial; the error is at most 4e-16 in double, 2e-7 in float.

namespace sandlot::selforg::fixed {

using Index = unsigned;

template <class Real>
constexpr Real clipped(Real x, Real limit) {
  return x > limit ? limit : x < -limit ? -limit : __builtin_isnan(x) ? Real(0) : x;
}
template <class Real>
constexpr bool is_finite(Real x) {
  return __builtin_isfinite(x);
}
template <class Real>
constexpr Real size_of(Real x) {
  return x < 0 ? -x : x;
}

/// e^-t for t >= 0.
template <class Real>
constexpr Real exp_of_minus(Real t) {
  constexpr bool single = sizeof(Real) == 4;
  if (!(t < (single ? Real(80) : Real(700)))) return 0;
  const auto k = static_cast<Index>(t * Real(1.44269504088896340736) + Real(0.5));
  // ln 2 in two parts: the products of the first one are exact.
  const Real n = static_cast<Real>(k);
  const Real r = single ? -((t - n * Real(0.693359375)) + n * Real(2.12194440054690583e-4))
                        : -((t - n * Real(0.693147180369123816490)) - n * Real(1.90821492927058770002e-10));
  Real power = 1;
  for (Index i = single ? 7 : 13; i > 0; --i) power = 1 + power * r / static_cast<Real>(i);
  constexpr double halves[] = {0x1p-1,  0x1p-2,  0x1p-4,   0x1p-8,   0x1p-16,
                               0x1p-32, 0x1p-64, 0x1p-128, 0x1p-256, 0x1p-512};
  Index bit = 0;
  for (Index rest = k; rest > 0; rest >>= 1, ++bit)
    if (rest & 1) power *= static_cast<Real>(halves[bit]);
  return power;
}

template <class Real>
constexpr Real tanh_of(Real x) {
  const Real e = exp_of_minus(2 * size_of(x));
  const Real value = (1 - e) / (1 + e);
  return x < 0 ? -value : x > 0 ? value : __builtin_isnan(x) ? x : Real(0);
}

/// Inverse or Moore-Penrose pseudo-inverse of an R x K matrix: as selforg/matrix.h has it, with L D L^T in place of Cholesky.
template <Index R, Index K, class Real>
class PseudoInverse {
 public:
  void factor(const Real (&M)[R][K]) {
    for (Index i = 0; i < R; ++i)
      for (Index j = 0; j < K; ++j) m_[i][j] = M[i][j];
    use_lu_ = R == K && factor_lu();
    if (use_lu_ || factor_normal(R == K ? Real(-1) : Real(0))) return;
    Real trace = 0;
    for (Index j = 0; j < K; ++j)
      for (Index i = 0; i < R; ++i) trace += m_[i][j] * m_[i][j];
    const Real shift = Real(1e-8) * (trace / static_cast<Real>(small));
    if (!factor_normal(shift > least_shift ? shift : least_shift))
      for (auto& row : f_)
        for (Real& each : row) each = 0;
  }

  /// out = M^+ x
  void apply(const Real (&x)[R], Real (&out)[K]) {
    if (use_lu_) {
      for (Index i = 0; i < small; ++i) out[i] = x[order_[i]];
      for (Index j = 0; j < small; ++j)
        for (Index i = j + 1; i < small; ++i) out[i] -= f_[i][j] * out[j];
      for (Index j = small; j-- > 0;) {
        out[j] *= f_[j][j];
        for (Index i = 0; i < j; ++i) out[i] -= f_[i][j] * out[j];
      }
    } else if (R >= K) {
      for (Index j = 0; j < K; ++j) {
        Real sum = 0;
        for (Index i = 0; i < R; ++i) sum += m_[i][j] * x[i];
        out[j] = sum;
      }
      solve(out);
    } else {
      for (Index i = 0; i < R; ++i) t_[i] = x[i];
      solve(t_);
      for (Index j = 0; j < K; ++j) {
        Real sum = 0;
        for (Index i = 0; i < R; ++i) sum += m_[i][j] * t_[i];
        out[j] = sum;
      }
    }
  }

  /// out = (M^+)^T x
  void apply_transposed(const Real (&x)[K], Real (&out)[R]) {
    if (use_lu_) {
      for (Index j = 0; j < small; ++j) {
        Real sum = x[j];
        for (Index i = 0; i < j; ++i) sum -= f_[i][j] * t_[i];
        t_[j] = sum * f_[j][j];
      }
      for (Index j = small; j-- > 0;) {
        Real sum = t_[j];
        for (Index i = j + 1; i < small; ++i) sum -= f_[i][j] * t_[i];
        t_[j] = sum;
      }
      for (Index i = 0; i < small; ++i) out[order_[i]] = t_[i];
    } else if (R >= K) {
      for (Index j = 0; j < K; ++j) t_[j] = x[j];
      solve(t_);
      for (Index i = 0; i < R; ++i) {
        Real sum = 0;
        for (Index j = 0; j < K; ++j) sum += m_[i][j] * t_[j];
        out[i] = sum;
      }
    } else {
      for (Index i = 0; i < R; ++i) {
        Real sum = 0;
        for (Index j = 0; j < K; ++j) sum += m_[i][j] * x[j];
        out[i] = sum;
      }
      solve(out);
    }
  }

 private:
  static constexpr Index small = R < K ? R : K, large = R < K ? K : R;
  static constexpr Real least_pivot = sizeof(Real) == 4 ? Real(1e-5) : Real(1e-12);
  static constexpr Real least_square = sizeof(Real) == 4 ? Real(1e-6) : Real(1e-14);
  static constexpr Real least_shift = sizeof(Real) == 4 ? Real(1e-7) : Real(1e-12);

  bool factor_lu() {
    Real largest = 0;
    for (Index i = 0; i < small; ++i) {
      order_[i] = i;
      for (Index j = 0; j < small; ++j) {
        f_[i][j] = m_[i][j];
        const Real size = size_of(f_[i][j]);
        if (!is_finite(size)) return false;
        if (size > largest) largest = size;
      }
    }
    for (Index k = 0; k < small; ++k) {
      Index pivot = k;
      for (Index i = k + 1; i < small; ++i)
        if (size_of(f_[i][k]) > size_of(f_[pivot][k])) pivot = i;
      if (!(size_of(f_[pivot][k]) > least_pivot * largest)) return false;
      if (pivot != k) {
        const Index row = order_[k];
        order_[k] = order_[pivot];
        order_[pivot] = row;
        for (Index j = 0; j < small; ++j) {
          const Real element = f_[k][j];
          f_[k][j] = f_[pivot][j];
          f_[pivot][j] = element;
        }
      }
      const Real scale = 1 / f_[k][k];
      for (Index i = k + 1; i < small; ++i) f_[i][k] *= scale;
      for (Index j = k + 1; j < small; ++j)
        for (Index i = k + 1; i < small; ++i) f_[i][j] -= f_[i][k] * f_[k][j];
      f_[k][k] = scale;
    }
    return true;
  }

  /// L D L^T of the normal matrix: L below the diagonal, the reciprocals of D on it. @param shift  negative: fails at once
  bool factor_normal(Real shift) {
    if (shift < 0) return false;
    Real largest = 0;
    for (Index i = 0; i < small; ++i) {
      for (Index j = 0; j <= i; ++j) {
        Real sum = 0;
        if (R >= K)
          for (Index k = 0; k < R; ++k) sum += m_[k][i % K] * m_[k][j % K];
        else
          for (Index k = 0; k < K; ++k) sum += m_[i % R][k] * m_[j % R][k];
        f_[i][j] = sum;
      }
      f_[i][i] += shift;
      if (f_[i][i] > largest) largest = f_[i][i];
      if (!is_finite(f_[i][i])) return false;
    }
    for (Index j = 0; j < small; ++j) {
      const Real pivot = f_[j][j];
      if (!(pivot > least_square * largest) || !(pivot > 0)) {
        if (!(shift > 0)) return false;
        for (Index i = j; i < small; ++i) f_[i][j] = 0;  // this direction gives nothing
        continue;
      }
      const Real scale = 1 / pivot;
      f_[j][j] = scale;
      for (Index i = j + 1; i < small; ++i) {
        const Real factor = f_[i][j] * scale;
        for (Index k = i; k < small; ++k) f_[k][i] -= f_[k][j] * factor;
        f_[i][j] = factor;
      }
    }
    return true;
  }

  template <Index n>
  void solve(Real (&x)[n]) const {
    static_assert(n >= small, "");
    for (Index j = 0; j < small; ++j)
      for (Index i = j + 1; i < small; ++i) x[i] -= f_[i][j] * x[j];
    for (Index j = small; j-- > 0;) {
      Real sum = x[j] * f_[j][j];
      for (Index i = j + 1; i < small; ++i) sum -= f_[i][j] * x[i];
      x[j] = sum;
    }
  }

  Real m_[R][K] = {}, f_[small][small] = {}, t_[large] = {};
  Index order_[small] = {};
  bool use_lu_ = false;
};

}  // namespace sandlot::selforg::fixed
