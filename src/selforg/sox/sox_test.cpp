#include "selforg/sox/sox.h"

#include "selforg/test_reference.h"

namespace sandlot::selforg::test::sox_test {
namespace {

Stream stream(std::uint64_t sample) { return {3, entity_key("sox"), Purpose::experiment, sample}; }

/// Literal Sox: one learning step from a state, as the equations of docs/selforg.md stand.
struct Literal {
  Ref A, C, S, h, b, v, xi, v_avg;
  Real E = 0;
  Literal(const Sox::Spec& p, const Sox::State& s, const Matrix& x_new) {
    const std::size_t at = s.t % 10, then = (s.t + 10 - static_cast<std::size_t>(p.s4delay)) % 10;
    (void)at;
    A = s.A, C = s.C, S = s.S, h = s.h, b = s.b, v_avg = s.v_avg;
    const Ref x = s.x_buffer[then], yc = s.y_buffer[then];
    const Ref x_next = Ref(s.x) + (1 / static_cast<Real>(p.s4avg)) * (Ref(x_new) - Ref(s.x));
    xi = x_next - (A * yc + b + S * x);
    const Ref y = squash(C * x + h);
    const Ref g = y.map([](Real u) { return 1 - u * u; });
    const Ref L = A * (C & g) + S;
    Ref Lplus = pinv(L);
    if (p.pseudo != Sox::Pseudo::moore_penrose) {
      const Ref P = p.pseudo == Sox::Pseudo::special ? C : A.T();
      const Ref Q = p.pseudo == Sox::Pseudo::sensor_space ? C.T() : A;
      Lplus = Q * inverse(P * L * Q) * P;
    }
    const Real aware = p.extended_model ? static_cast<Real>(p.causeaware) : 0;
    const Ref y_hat = y + aware * (pinv(A) * xi);
    v = Lplus * xi;
    E = norm2(v);
    const Ref chi = Lplus.T() * v;
    const Ref mu = (A.T() * chi) & g;
    const Ref epsrel = (2 * static_cast<Real>(p.sense)) * (mu & (C * v));
    const Ref v_hat = v + static_cast<Real>(p.harmony) * x;
    v_avg = v_avg + Real(0.1) * (v - v_avg);
    Real EE = 1;
    if (p.error == Sox::ErrorFunction::logarithmic) EE = Real(0.1) / (E + Real(0.001));
    if (p.error == Sox::ErrorFunction::root) EE = Real(0.1) / std::sqrt(E + Real(0.001));
    const Real epsC = static_cast<Real>(p.epsC) * EE * (1 - Real(0.99) * static_cast<Real>(s.reward));
    const Real epsA = static_cast<Real>(p.epsA), d = static_cast<Real>(p.damping);

    const Ref metric = A.T() * (Lplus.T() * Lplus) * A;
    const auto guided = [&](const Ref& delta, double rate) {
      const Ref m = (static_cast<Real>(rate) * static_cast<Real>(p.epsC)) * (metric * delta);
      C = C + clip(m * x.T(), Real(0.05));
      h = h + clip(static_cast<Real>(p.factorh) * m, Real(0.05));
    };
    if (s.teach) guided((Ref(s.taught) - y) & g, p.gamma);
    if (s.pursue) guided(Ref(s.goal) & g, p.goal_weight);

    A = A + clip(epsA * (xi * y_hat.T()), Real(0.1)) + clip(d * cube(Ref(s.A_native) - A), Real(0.1));
    if (p.extended_model)
      S = S + clip((epsA * static_cast<Real>(p.factorS)) * (xi * x.T()) - (10 * d) * S, Real(0.1));
    b = b + clip((epsA * static_cast<Real>(p.factorb)) * xi - d * b, Real(0.1));
    C = C + clip(epsC * (mu * v_hat.T() - (epsrel & y) * x.T()), Real(0.05)) +
        clip(d * cube(Ref(s.C_native) - C), Real(0.05));
    h = h + clip((epsC * static_cast<Real>(p.factorh)) * (static_cast<Real>(p.harmony) * mu - (epsrel & y)),
                 Real(0.05));
  }
};

Sox::Spec random_spec(Stream& random) {
  Sox::Spec p;
  p.epsC = random.uniform(0, 0.5);
  p.epsA = random.uniform(0, 0.3);
  p.sense = random.uniform(0.2, 3);
  p.creativity = random.uniform(0, 1);
  p.damping = random.uniform(0, 0.01);
  p.causeaware = random.uniform(0, 0.1);
  p.harmony = random.uniform(0, 0.1);
  p.gamma = random.uniform(0, 1);
  p.s4avg = random.uniform(1, 3);
  p.s4delay = 1 + static_cast<int>(random.below(9));
  p.factorS = random.uniform(0, 2);
  p.factorb = random.uniform(0, 2);
  p.factorh = random.uniform(0, 2);
  p.goal_weight = random.uniform(0, 1);
  p.error = static_cast<Sox::ErrorFunction>(random.below(3));
  p.extended_model = random.below(4) != 0;
  return p;
}

/// A Sox with matrices far from singular, and a past.
Sox lived(Stream& random, const Sox::Spec& spec, std::size_t n, std::size_t m) {
  Sox sox;
  sox.spec = spec;
  EXPECT_TRUE(static_cast<bool>(sox.init({n, m})));
  Matrix y(m, 1);
  for (int k = 0; k < 12; ++k) sox.step(random_matrix(random, n, 1, 0.7), y, Mode::act);
  sox.state.A = random_matrix(random, n, m, 0.2);
  sox.state.C = random_matrix(random, m, n, 0.2);
  sox.state.S = random_matrix(random, n, n, 0.1);
  for (std::size_t i = 0; i < std::min(n, m); ++i) sox.state.A(i, i) += 1, sox.state.C(i, i) += 1;
  for (std::size_t i = 0; i < n; ++i) sox.state.S(i, i) += 1;
  sox.state.h = random_matrix(random, m, 1, 0.2);
  sox.state.b = random_matrix(random, n, 1, 0.2);
  sox.state.v_avg = random_matrix(random, n, 1, 0.2);
  return sox;
}

TEST(Sox, EachLearningStepIsTheLiteralOne) {
  for (std::uint64_t k = 0; k < 60; ++k) {
    SCOPED_TRACE(k);
    Stream random = stream(k);
    const std::size_t n = 1 + random.below(12), m = 1 + random.below(12);
    Sox::Spec spec = random_spec(random);
    // The smaller spaces exist where L of their size has full rank.
    if (m <= n) spec.pseudo = static_cast<Sox::Pseudo>(random.below(4));
    Sox sox = lived(random, spec, n, m);
    if (k % 3 == 0) sox.teach_motors(random_matrix(random, m, 1, 1.2).data);
    if (k % 4 == 0) sox.set_goal(random_matrix(random, m, 1).data);
    if (k % 5 == 0) sox.set_reward(random.uniform(-1, 1));
    const Sox::State before = sox.state;
    const Matrix x = random_matrix(random, n, 1);
    const Literal literal(sox.spec, before, x);
    Matrix y(m, 1);
    sox.step(x, y, Mode::learn);
    expect_near(sox.state.xi, literal.xi, 1e-12, "xi");
    expect_near(sox.state.v, literal.v, 1e-12, "v");
    EXPECT_NEAR(sox.state.E, static_cast<double>(literal.E), 1e-12 * (1 + sox.state.E));
    expect_near(sox.state.v_avg, literal.v_avg, 1e-12, "v_avg");
    expect_near(sox.state.A, literal.A, 1e-12, "A");
    expect_near(sox.state.S, literal.S, 1e-12, "S");
    expect_near(sox.state.b, literal.b, 1e-12, "b");
    expect_near(sox.state.C, literal.C, 1e-12, "C");
    expect_near(sox.state.h, literal.h, 1e-12, "h");
    const Ref input = Ref(sox.state.x) + static_cast<Real>(spec.creativity) * literal.v_avg;
    expect_near(y, squash(literal.C * input + literal.h), 1e-12, "y");
    EXPECT_FALSE(sox.state.teach || sox.state.pursue);
    EXPECT_EQ(sox.state.reward, 0) << "a signal holds for one step";
  }
}

TEST(Sox, TheTimeLoopErrorIsTheQuadraticForm) {
  for (std::uint64_t k = 0; k < 20; ++k) {
    Stream random = stream(200 + k);
    const std::size_t n = 1 + random.below(10), m = 1 + random.below(10);
    Sox sox = lived(random, {}, n, m);
    const Sox::State before = sox.state;
    Matrix y(m, 1);
    sox.step(random_matrix(random, n, 1), y, Mode::learn);
    const Ref x = before.x_buffer[(before.t + 9) % 10];
    const Ref g = squash(Ref(before.C) * x + Ref(before.h)).map([](Real u) { return 1 - u * u; });
    const Ref L = Ref(before.A) * (Ref(before.C) & g) + Ref(before.S);
    const Ref xi = sox.state.xi;
    const Real E = (xi.T() * inverse(L * L.T()) * xi)(0, 0);
    EXPECT_NEAR(sox.state.E, static_cast<double>(E), 1e-12 * (1 + static_cast<double>(E)));
  }
}

/// E as a function of C and h, with the model's error held.
Real error_of(const Ref& A, const Ref& C, const Ref& S, const Ref& h, const Ref& x, const Ref& xi) {
  const Ref g = squash(C * x + h).map([](Real u) { return 1 - u * u; });
  return norm2(inverse(A * (C & g) + S) * xi);
}

TEST(Sox, ControllerDescendsTheGradientOfE) {
  for (std::uint64_t k = 0; k < 10; ++k) {
    Stream random = stream(300 + k);
    const std::size_t n = 1 + random.below(6), m = 1 + random.below(6);
    Sox::Spec spec;
    spec.epsC = 1e-4;  // nothing is clipped
    spec.epsA = spec.damping = spec.harmony = 0;
    spec.sense = 1;  // with other values the second term is weighted on purpose
    Sox sox = lived(random, spec, n, m);
    const Sox::State before = sox.state;
    Matrix y(m, 1);
    sox.step(random_matrix(random, n, 1, 0.5), y, Mode::learn);
    const Ref A = before.A, C = before.C, S = before.S, h = before.h, xi = sox.state.xi;
    const Ref x = before.x_buffer[(before.t + 9) % 10];
    const Real step = 1e-6L;  // central difference: error step^2 E''' / 6, about 1e-12 of 1
    const auto slope = [&](const auto& change) {
      Ref C1 = C, C2 = C, h1 = h, h2 = h;
      change(C1, h1, step);
      change(C2, h2, -step);
      return (error_of(A, C1, S, h1, x, xi) - error_of(A, C2, S, h2, x, xi)) / (2 * step);
    };
    // Delta C = -epsC/2 dE/dC.
    for (std::size_t i = 0; i < m; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        const double gradient = static_cast<double>(slope([&](Ref& c, Ref&, Real s) { c.at[i][j] += s; }));
        EXPECT_NEAR((sox.state.C(i, j) - before.C(i, j)) / spec.epsC, -0.5 * gradient,
                    1e-7 * (1 + std::abs(gradient)));
      }
      const double gradient = static_cast<double>(slope([&](Ref&, Ref& hh, Real s) { hh.at[i][0] += s; }));
      EXPECT_NEAR((sox.state.h[i] - before.h[i]) / spec.epsC, -0.5 * gradient,
                  1e-7 * (1 + std::abs(gradient)));
    }
  }
}

TEST(Sox, BabblingTeachesModelAndController) {
  Stream random = stream(400);
  const std::size_t n = 4, m = 3;
  Sox sox = lived(random, {}, n, m);
  const Sox::State s = sox.state;
  const Matrix x_new = random_matrix(random, n, 1);
  Matrix y = random_matrix(random, m, 1);
  sox.step(x_new, y, Mode::babble);
  const Ref x = s.x_buffer[(s.t + 9) % 10], yc = s.y_buffer[(s.t + 9) % 10];
  const Ref xi = Ref(x_new) - (Ref(s.A) * yc + Ref(s.b) + Ref(s.S) * x);
  expect_near(sox.state.A, Ref(s.A) + 0.01L * (xi * yc.T()), 1e-12, "A");
  const Ref z = squash(Ref(s.C) * x + Ref(s.h));
  const Ref delta = (yc - z) & z.map([](Real u) { return 1 - u * u; });
  expect_near(sox.state.C, Ref(s.C) + 0.01L * (delta * x.T()), 1e-12, "C");
  EXPECT_EQ(sox.state.A.data, sox.state.A_native.data);
  EXPECT_EQ(sox.state.C.data, sox.state.C_native.data);
}

TEST(Sox, DirectTeachingReachesTheTaughtMotorValues) {
  Sox sox;
  sox.spec.gamma = 0.5;
  ASSERT_TRUE(static_cast<bool>(sox.init({2, 2})));
  Matrix x(2, 1), y(2, 1);
  const double wanted[] = {0.6, -0.4};
  for (int k = 0; k < 3000; ++k) {
    sox.teach_motors(wanted);
    sox.step(x, y, Mode::learn);
    for (std::size_t i = 0; i < 2; ++i) x[i] = 0.9 * y[i];  // a world that follows
  }
  EXPECT_NEAR(y[0], 0.6, 0.1);
  EXPECT_NEAR(y[1], -0.4, 0.1);
}

TEST(Sox, SensorTeachingAsksTheModelForTheMotors) {
  Sox sox;
  ASSERT_TRUE(static_cast<bool>(sox.init({2, 2})));
  sox.state.A(0, 0) = 2;
  sox.state.b[1] = 0.25;
  const double x[] = {0.5, 0.5};
  sox.teach_sensors(x);
  EXPECT_NEAR(sox.state.taught[0], 0.25, 1e-14);  // 2 y = 0.5
  EXPECT_NEAR(sox.state.taught[1], 0.25, 1e-14);  // y + 0.25 = 0.5
  const double far[] = {100, -100};
  sox.teach_sensors(far);
  EXPECT_EQ(sox.state.taught[0], 0.95);
  EXPECT_EQ(sox.state.taught[1], -0.95);
}

TEST(Sox, AGoalInSensorSpaceIsDescendedThroughTheModel) {
  Stream random = stream(500);
  Sox sox = lived(random, {}, 3, 2);
  const double goal[] = {0.5, -0.2, 0.1}, weights[] = {1, 2, 0};
  sox.set_goal_sensors(goal, weights);
  const auto F = [&](const Ref& y) {
    const Ref predicted = Ref(sox.state.A) * y + Ref(sox.state.b) + Ref(sox.state.S) * Ref(sox.state.x);
    Real sum = 0;
    for (std::size_t i = 0; i < 3; ++i)
      sum += static_cast<Real>(weights[i]) / 2 * (goal[i] - predicted(i)) * (goal[i] - predicted(i));
    return sum;
  };
  for (std::size_t i = 0; i < 2; ++i) {
    Ref up = sox.state.y, down = sox.state.y;
    up.at[i][0] += 1e-6L;
    down.at[i][0] -= 1e-6L;
    EXPECT_NEAR(sox.state.goal[i], static_cast<double>(-(F(up) - F(down)) / 2e-6L), 1e-9);
  }
}

TEST(Sox, ARewardFreezesAndAPunishmentDoubles) {
  Stream random = stream(600);
  Sox::Spec spec;
  spec.damping = 0;
  spec.epsC = 1e-3;
  const Sox start = lived(random, spec, 3, 3);
  const Matrix x = random_matrix(random, 3, 1);
  const auto change = [&](double reward) {
    Sox sox = start;
    sox.set_reward(reward);
    Matrix y(3, 1);
    sox.step(x, y, Mode::learn);
    return sox.state.C(0, 1) - start.state.C(0, 1);
  };
  const double plain = change(0);
  ASSERT_NE(plain, 0);
  EXPECT_NEAR(change(1) / plain, 0.01, 1e-10);
  EXPECT_NEAR(change(-1) / plain, 1.99, 1e-10);
  EXPECT_NEAR(change(-7) / plain, 1.99, 1e-10) << "clipped to [-1, 1]";
}

TEST(Sox, TheExtendedModelTellsItsOwnEffectFromTheEnvironments) {
  // x' = 0.5 y + 0.4 x: with motors that are independent of the sensors A finds 0.5 and S finds 0.4.
  Sox sox;
  sox.spec.damping = 0;
  ASSERT_TRUE(static_cast<bool>(sox.init({1, 1})));
  Stream random = stream(700);
  Matrix x(1, 1), y(1, 1);
  for (int k = 0; k < 40'000; ++k) {
    y[0] = random.uniform(-1, 1);
    sox.step(x, y, Mode::babble);
    x[0] = 0.5 * y[0] + 0.4 * x[0];
  }
  EXPECT_NEAR(sox.state.A[0], 0.5, 1e-6);
  EXPECT_NEAR(sox.state.S[0], 0.4, 1e-6);
  EXPECT_NEAR(sox.state.self_caused[0] + sox.state.environment_caused[0], sox.state.x[0], 1e-5);
}

}  // namespace
}  // namespace sandlot::selforg::test::sox_test
