#include "selforg/semox/semox.h"

#include "selforg/test_reference.h"

namespace sandlot::selforg::test::semox_test {
namespace {

Stream stream(std::uint64_t sample) { return {4, entity_key("semox"), Purpose::experiment, sample}; }

Semox lived(Stream& random, const Semox::Spec& spec, std::size_t n, std::size_t m) {
  Semox semox;
  semox.spec = spec;
  EXPECT_TRUE(static_cast<bool>(semox.init({n, m, 5, "semox"})));
  Matrix y(m, 1);
  for (int k = 0; k < 13; ++k) semox.step(random_matrix(random, n, 1, 0.7), y, Mode::act);
  semox.state.A = random_matrix(random, n, m, 0.3);
  semox.state.C = random_matrix(random, m, n, 0.3);
  for (std::size_t i = 0; i < std::min(n, m); ++i) semox.state.A(i, i) += 1, semox.state.C(i, i) += 1;
  semox.state.S = random_matrix(random, n, n, 0.3);
  semox.state.H = random_matrix(random, m, 1, 0.2);
  semox.state.b = random_matrix(random, n, 1, 0.2);
  return semox;
}

Ref with_diagonal(Ref m, Real add) {
  for (std::size_t i = 0; i < m.rows; ++i) m.at[i][i] += add;
  return m;
}

TEST(Semox, EachLearningStepIsTheLiteralOne) {
  for (std::uint64_t k = 0; k < 40; ++k) {
    SCOPED_TRACE(k);
    Stream random = stream(k);
    const std::size_t n = 1 + random.below(15),
                      m = 1 + random.below(std::min<std::uint32_t>(6, static_cast<std::uint32_t>(n)));
    Semox::Spec p;
    p.epsC = random.uniform(0, 0.5);
    p.epsA = random.uniform(0, 0.5);
    p.s4delay = 1 + static_cast<int>(random.below(9));
    p.squashsize = random.uniform(0.001, 1);
    p.dampModel = random.uniform(0, 0.01);
    p.dampController = random.uniform(0, 0.01);
    p.gamma_cont = k % 2 ? random.uniform(0, 1) : 0;
    p.gamma_teach = random.uniform(0, 1);
    p.error = static_cast<Semox::ErrorFunction>(random.below(3));
    p.model_error = static_cast<Semox::ErrorFunction>(random.below(3));
    p.extended_model = random.below(3) != 0;
    Semox semox = lived(random, p, n, m);
    if (k % 3 == 0) semox.teach_motors(random_matrix(random, m, 1).data);
    const Semox::State s = semox.state;
    const Matrix x_new = random_matrix(random, n, 1);
    Matrix y_out(m, 1);
    semox.step(x_new, y_out, Mode::learn);

    const std::size_t then = (s.t + 10 - static_cast<std::size_t>(p.s4delay)) % 10;
    const Ref A = s.A, x = s.x_buffer[then], yc = s.y_buffer[then];
    const Ref before = s.y_buffer[(s.t + 9 - static_cast<std::size_t>(p.s4delay)) % 10];
    Ref C = s.C, H = s.H;
    const Ref xi = Ref(x_new) - (A * yc + Ref(s.b) + Ref(s.S) * x);
    const Ref y = squash(C * x + H);
    const Ref g = y.map([](Real u) { return 1 - u * u; });
    const Ref eta = squash(inverse(with_diagonal(A.T() * A, 0.001)) * A.T() * xi);
    const Ref zeta = eta & g.map([](Real u) { return 1 / std::max<Real>(u, 0.01); });
    const Ref R = C * A;
    const Ref chi = inverse(with_diagonal(R * R.T(), 0.001)) * zeta;
    const Ref v = clip(R.T() * chi, 3);
    const Ref rho = 2 * (y & chi & zeta);  // -(g''/g') = 2 g
    const Real size = static_cast<Real>(p.squashsize), E = norm2(v) / 2;
    const auto scale = [](Semox::ErrorFunction error, Real e) -> Real {
      if (error == Semox::ErrorFunction::logarithmic) return Real(0.1) / (e + Real(0.001));
      if (error == Semox::ErrorFunction::root) return Real(0.1) / std::sqrt(e + Real(0.001));
      return 1;
    };
    const auto pull = [&](const Ref& delta, double gamma) {
      const Ref G = R & g;
      const Ref step = static_cast<Real>(gamma * 1) * static_cast<Real>(p.epsC) *
                       (inverse(with_diagonal(G * G.T(), 0.001)) * delta);
      C = C + clip(step * x.T(), size);
      H = H + clip(step, size);
    };
    if (s.teach) pull((Ref(s.taught) - y) & g, p.gamma_teach);
    if (p.gamma_cont > 0) pull((before - y) & g, p.gamma_cont);
    const Real rate = static_cast<Real>(p.epsC) * scale(p.error, E),
               damp = static_cast<Real>(p.dampController);
    C = C + clip(rate * (chi * (v.T() * A.T()) - rho * x.T()), size) - damp * C;
    H = H + clip(-rate * rho, size) - damp * H;
    // The regularisation 0.001 bounds the condition of what is inverted at about 1e4: 1e-16 becomes 1e-12.
    expect_near(semox.state.xi, xi, 1e-12, "xi");
    expect_near(semox.state.v, v, 1e-12, "v");
    expect_near(semox.state.C, C, 1e-12, "C");
    expect_near(semox.state.H, H, 1e-12, "H");
    const Real rate_A = static_cast<Real>(p.epsA) * scale(p.model_error, norm2(xi)),
               damp_A = static_cast<Real>(p.dampModel);
    expect_near(semox.state.A, A + clip(rate_A * (xi * yc.T()), size) - damp_A * A, 1e-12, "A");
    if (p.extended_model)
      expect_near(semox.state.S,
                  Ref(s.S) + clip(rate_A * (xi * x.T()), size) - (Real(p.discountS) + damp_A) * Ref(s.S),
                  1e-12, "S");
    else EXPECT_EQ(semox.state.S.data, s.S.data);
    expect_near(semox.state.b, Ref(s.b) + clip(rate_A * Real(p.factorB) * xi, size) - damp_A * Ref(s.b),
                1e-12, "b");
    expect_near(y_out, squash(C * Ref(x_new) + H), 1e-12, "y");
  }
}

/// 1/2 zeta^T (R R^T + 0.001)^-1 zeta as a function of C and H, with eta and A held. The regularisation is part of chi, not of
/// v, so that the update is its gradient only where 0.001 is small: with R far from singular to 1e-3.
TEST(Semox, ControllerDescendsTheGradientOfItsError) {
  Stream random = stream(100);
  Semox::Spec p;
  p.epsC = 1e-4;
  p.epsA = 0;
  p.squashsize = 1;
  Semox semox = lived(random, p, 5, 2);
  const Semox::State s = semox.state;
  Matrix y(2, 1);
  semox.step(random_matrix(random, 5, 1, 0.3), y, Mode::learn);
  const Ref A = s.A, x = s.x_buffer[(s.t + 9) % 10], xi = semox.state.xi;
  const Ref eta = squash(inverse(with_diagonal(A.T() * A, 0.001)) * A.T() * xi);
  const auto E = [&](const Ref& C, const Ref& H) {
    const Ref zeta = eta & squash(C * x + H).map([](Real u) { return 1 / (1 - u * u); });
    const Ref R = C * A;
    return (zeta.T() * inverse(R * R.T()) * zeta)(0, 0) / 2;
  };
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 5; ++j) {
      Ref up = s.C, down = s.C;
      up.at[i][j] += 1e-6L;
      down.at[i][j] -= 1e-6L;
      const double gradient = static_cast<double>((E(up, s.H) - E(down, s.H)) / 2e-6L);
      EXPECT_NEAR((semox.state.C(i, j) - s.C(i, j)) / p.epsC, -gradient, 5e-3 * (0.1 + std::abs(gradient)));
    }
    Ref up = s.H, down = s.H;
    up.at[i][0] += 1e-6L;
    down.at[i][0] -= 1e-6L;
    const double gradient = static_cast<double>((E(s.C, up) - E(s.C, down)) / 2e-6L);
    (void)gradient;
    EXPECT_NEAR((semox.state.H[i] - s.H[i]) / p.epsC, -gradient, 5e-3 * (0.1 + std::abs(gradient)));
  }
}

TEST(Semox, PainStopsTheModel) {
  Stream random = stream(200);
  Semox semox = lived(random, {}, 3, 2);
  Matrix x(3, 1), y(2, 1);
  for (int k = 0; k < 50; ++k) {
    for (double& each : x.data) each = 0.01 * random.uniform(-1, 1);
    semox.step(x, y, Mode::learn);
  }
  const Semox::State before = semox.state;
  const double norm = std::sqrt(squared_norm(before.xi));
  ASSERT_GT(before.error_average, 0);
  for (double& each : x.data) each = 100 * (norm + before.error_average);  // a blow
  semox.step(x, y, Mode::learn);
  EXPECT_EQ(semox.state.A.data, before.A.data);
  EXPECT_NE(semox.state.C.data, before.C.data) << "the controller goes on";
}

}  // namespace
}  // namespace sandlot::selforg::test::semox_test
