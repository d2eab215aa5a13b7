/// Sox of a fixed size against the one with Eigen.
#include "selforg/fixed/fixed_sox.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "selforg/sox/sox.h"

namespace sandlot::selforg {
namespace {

TEST(FixedSox, ItsTanhHasTheStatedError) {
  double most = 0, most_float = 0;
  for (int k = -400'000; k <= 400'000; ++k) {
    const double x = k * 6e-5;  // to +-24
    most = std::max(most, std::abs(fixed::tanh_of(x) - math::tanh(x)));
    most_float = std::max(most_float, std::abs(static_cast<double>(fixed::tanh_of(static_cast<float>(x))) -
                                               math::tanh(static_cast<double>(static_cast<float>(x)))));
  }
  EXPECT_LE(most, 4e-16);
  EXPECT_LE(most_float, 2e-7);
  EXPECT_EQ(fixed::tanh_of(1e300), 1);
  EXPECT_EQ(fixed::tanh_of(-std::numeric_limits<double>::infinity()), -1);
  EXPECT_EQ(fixed::tanh_of(0.0), 0);
  EXPECT_EQ(fixed::tanh_of(1e30f), 1);
  EXPECT_TRUE(std::isnan(fixed::tanh_of(std::nan(""))));
}

/// Sensor values of a body that follows its motors with a lag, and of nobody's making in between.
template <std::size_t N>
void move(std::array<double, N>& body, std::span<const double> y, std::uint64_t k) {
  Stream random(5, 6, Purpose::experiment, k);
  for (std::size_t i = 0; i < N; ++i)
    body[i] += 0.3 * (y[i % y.size()] - body[i]) + random.uniform(-0.05, 0.05);
}

template <unsigned N, unsigned M, class Real, unsigned Delays = 1>
double largest_difference(int steps, const typename fixed::Sox<N, M, Real, Delays>::Parameters& p,
                          bool follow, bool rough = false) {
  auto made = std::make_unique<ControllerOf<Sox>>("sox");
  EXPECT_TRUE(static_cast<bool>(made->init({}, {N, M})));
  Sox::Spec& spec = made->element().spec;
  spec.epsC = p.epsC, spec.epsA = p.epsA, spec.sense = p.sense, spec.creativity = p.creativity;
  spec.damping = p.damping, spec.causeaware = p.causeaware, spec.harmony = p.harmony, spec.s4avg = p.s4avg;
  spec.s4delay = static_cast<int>(p.s4delay), spec.factorS = p.factorS, spec.factorb = p.factorb;
  spec.factorh = p.factorh;
  spec.error = p.logarithmic ? Sox::ErrorFunction::logarithmic : Sox::ErrorFunction::plain;
  fixed::Sox<N, M, Real, Delays> small(p);
  std::array<double, N> body{};
  std::vector<double> y(M);
  // Matrices whose factors need their rows exchanged.
  for (unsigned i = 0; rough && i < N; ++i)
    for (unsigned j = 0; j < M; ++j) {
      made->element().state.A(i, j) = small.A[i][j] = i == (j + 1) % N ? Real(1) : Real(0.001) * Real(i + 1);
      made->element().state.C(j, i) = small.C[j][i] = i == (j + 1) % N ? Real(0.9)
                                                                       : Real(-0.002) * Real(j + 1);
    }
  double most = 0;
  for (int k = 0; k < steps; ++k) {
    Real x[N], y_small[M];
    std::array<double, N> seen = body;
    if (rough && k % 17 == 3) seen[0] = std::nan("");
    if (rough && k % 23 == 5) seen[N - 1] *= 40;  // a blow: changes reach their limits
    for (unsigned i = 0; i < N; ++i) x[i] = static_cast<Real>(seen[i]);
    const double reward = k % 50 == 7 ? 0.5 : 0;
    made->element().set_reward(reward);
    small.set_reward(static_cast<Real>(reward));
    made->step(seen, y);
    small.step(x, y_small);
    const Sox::State& s = made->element().state;
    for (unsigned i = 0; i < M; ++i) {
      most = std::max(most, std::abs(static_cast<double>(y_small[i]) - y[i]));
      for (unsigned j = 0; j < N; ++j) {
        most = std::max(most, std::abs(static_cast<double>(small.C[i][j]) - s.C(i, j)));
        most = std::max(most, std::abs(static_cast<double>(small.A[j][i]) - s.A(j, i)));
        if (follow)
          small.C[i][j] = static_cast<Real>(s.C(i, j)), small.A[j][i] = static_cast<Real>(s.A(j, i));
      }
      if (follow) small.h[i] = static_cast<Real>(s.h[i]);
    }
    for (unsigned i = 0; i < N && follow; ++i) {
      small.b[i] = static_cast<Real>(s.b[i]);
      for (unsigned j = 0; j < N; ++j) small.S[i][j] = static_cast<Real>(s.S(i, j));
    }
    move(body, y, static_cast<std::uint64_t>(k));
  }
  return most;
}

TEST(FixedSox, InDoubleItIsTheOneWithEigen) {
  EXPECT_LT((largest_difference<2, 2, double>(1000, {}, false)), 1e-12);
  EXPECT_LT((largest_difference<4, 2, double>(1000, {}, false)), 1e-12);  // A by the normal equations
  EXPECT_LT((largest_difference<2, 3, double>(1000, {}, false)), 1e-12);
  fixed::Sox<3, 3, double, 4>::Parameters p;
  p.s4delay = 3, p.s4avg = 2, p.creativity = 0.2, p.harmony = 0.05, p.logarithmic = true, p.sense = 2,
  p.epsC = 0.02;
  EXPECT_LT((largest_difference<3, 3, double, 4>(1000, p, false)), 1e-12);
}

TEST(FixedSox, InDoubleItIsTheOneWithEigenAtItsLimitsAndWithBrokenSensors) {
  fixed::Sox<3, 3, double>::Parameters p;
  p.epsC = 1, p.epsA = 0.5;
  EXPECT_LT((largest_difference<3, 3, double>(300, p, false, true)), 1e-11);
  fixed::Sox<4, 2, double>::Parameters q;
  q.epsC = 1, q.damping = 0.01;
  // L of 4 x 4 from 2 motors is near to singular: differences of 1e-16 grow tenfold every 25 steps.
  EXPECT_LT((largest_difference<4, 2, double>(50, q, false, true)), 1e-11);
}

TEST(FixedSox, InFloatOneStepIsCloseToIt) {
  // From the same matrices in every step: what one step of single precision adds.
  EXPECT_LT((largest_difference<2, 2, float>(1000, {}, true)), 1e-6);
  EXPECT_LT((largest_difference<4, 2, float>(1000, {}, true)), 1e-6);
}

TEST(FixedSox, StaysFiniteWhateverItSenses) {
  fixed::Sox<3, 2, float> sox;
  sox.parameters.epsC = 5, sox.parameters.epsA = 5, sox.parameters.sense = 5, sox.parameters.harmony = 0.1f;
  float y[2];
  for (std::uint64_t k = 0; k < 100'000; ++k) {
    Stream random(1, 2, Purpose::experiment, k);
    float x[3];
    for (float& each : x) each = static_cast<float>(random.uniform(-1, 1));
    const std::uint32_t weather = random.below(12);
    if (weather == 0) x[0] = std::numeric_limits<float>::quiet_NaN();
    if (weather == 1) x[1] = -std::numeric_limits<float>::infinity();
    if (weather == 2) x[0] = x[1] = x[2] = 0;
    if (weather == 3) x[2] *= 1e30f;
    sox.step(x, y);
    ASSERT_TRUE(std::abs(y[0]) <= 1 && std::abs(y[1]) <= 1) << k;
  }
  for (const auto& row : sox.C)
    for (const float each : row) EXPECT_TRUE(std::isfinite(each));
  for (const auto& row : sox.A)
    for (const float each : row) EXPECT_TRUE(std::isfinite(each));
}

TEST(FixedSox, ItsSizeIsBounded) {
  static_assert(sizeof(fixed::Sox<4, 2>) < 1536);
  static_assert(sizeof(fixed::Sox<2, 2>) < 600);
  static_assert(std::is_trivially_copyable_v<fixed::Sox<4, 2>>);
}

}  // namespace
}  // namespace sandlot::selforg
