// The filter against a literal one: dense matrices of 15 x 15, rotations as products of three, their derivatives by the
// product rule, the inverse by elimination, P = (I - K H) P. Written from the textbook, sharing no code with the filter.
#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "base/random.h"
#include "navigation/estimation/ekf.h"

namespace sandlot::navigation::ekf {
namespace {

using M3 = std::array<std::array<double, 3>, 3>;
using Dense = std::vector<std::vector<double>>;

M3 mul(const M3& a, const M3& b) {
  M3 c{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}
M3 rx(double a) { return {{{1, 0, 0}, {0, math::cos(a), -math::sin(a)}, {0, math::sin(a), math::cos(a)}}}; }
M3 ry(double a) { return {{{math::cos(a), 0, math::sin(a)}, {0, 1, 0}, {-math::sin(a), 0, math::cos(a)}}}; }
M3 rz(double a) { return {{{math::cos(a), -math::sin(a), 0}, {math::sin(a), math::cos(a), 0}, {0, 0, 1}}}; }
// Derivative of a rotation about an axis: the rotation by 90 degrees more, without the part along the axis.
M3 without(M3 m, std::size_t axis) { return m[axis][axis] = 0, m; }
M3 drx(double a) { return without(rx(a + math::pi / 2), 0); }
M3 dry(double a) { return without(ry(a + math::pi / 2), 1); }
M3 drz(double a) { return without(rz(a + math::pi / 2), 2); }

Dense zeros(std::size_t rows, std::size_t cols) { return Dense(rows, std::vector<double>(cols, 0)); }
Dense product(const Dense& a, const Dense& b) {
  Dense c = zeros(a.size(), b[0].size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b[0].size(); ++j)
      for (std::size_t k = 0; k < b.size(); ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}
Dense transposed(const Dense& a) {
  Dense c = zeros(a[0].size(), a.size());
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < a[0].size(); ++j) c[j][i] = a[i][j];
  return c;
}
Dense inverse_of(Dense a) {  // Gauss-Jordan with pivots
  const std::size_t n = a.size();
  Dense inv = zeros(n, n);
  for (std::size_t i = 0; i < n; ++i) inv[i][i] = 1;
  for (std::size_t c = 0; c < n; ++c) {
    std::size_t p = c;
    for (std::size_t r = c + 1; r < n; ++r)
      if (std::abs(a[r][c]) > std::abs(a[p][c])) p = r;
    std::swap(a[c], a[p]), std::swap(inv[c], inv[p]);
    const double d = a[c][c];
    for (std::size_t j = 0; j < n; ++j) a[c][j] /= d, inv[c][j] /= d;
    for (std::size_t r = 0; r < n; ++r) {
      if (r == c) continue;
      const double f = a[r][c];
      for (std::size_t j = 0; j < n; ++j) a[r][j] -= f * a[c][j], inv[r][j] -= f * inv[c][j];
    }
  }
  return inv;
}
double wrapped(double a) {
  while (a > math::pi) a -= 2 * math::pi;
  while (a <= -math::pi) a += 2 * math::pi;
  return a;
}

struct Literal {
  std::vector<double> x = std::vector<double>(15, 0);
  Dense P = zeros(15, 15);

  void predict(const std::array<double, 15>& q, double dt) {
    const double a = x[3], b = x[4], c = x[5];
    const M3 R = mul(rz(c), mul(ry(b), rx(a)));
    const std::array<M3, 3> by = {mul(rz(c), mul(ry(b), drx(a))), mul(rz(c), mul(dry(b), rx(a))),
                                  mul(drz(c), mul(ry(b), rx(a)))};
    double d[3], w[3] = {x[9], x[10], x[11]};
    for (std::size_t i = 0; i < 3; ++i) d[i] = x[6 + i] * dt + x[12 + i] * dt * dt / 2;
    // Rates of roll, pitch and yaw: E w, and its derivatives.
    const double sa = math::sin(a), ca = math::cos(a), tb = math::tan(b), cb = math::cos(b);
    const double sec2 = 1 + tb * tb, dsec = tb / cb;
    const M3 E = {{{1, sa * tb, ca * tb}, {0, ca, -sa}, {0, sa / cb, ca / cb}}};
    const M3 Ea = {{{0, ca * tb, -sa * tb}, {0, -sa, -ca}, {0, ca / cb, -sa / cb}}};
    const M3 Eb = {{{0, sa * sec2, ca * sec2}, {0, 0, 0}, {0, sa * dsec, ca * dsec}}};
    Dense F = zeros(15, 15);
    for (std::size_t i = 0; i < 15; ++i) F[i][i] = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        F[i][6 + j] = R[i][j] * dt;
        F[i][12 + j] = R[i][j] * dt * dt / 2;
        for (std::size_t k = 0; k < 3; ++k) F[i][3 + k] += by[k][i][j] * d[j];
        F[3 + i][9 + j] = E[i][j] * dt;
        F[3 + i][3] += Ea[i][j] * w[j] * dt;
        F[3 + i][4] += Eb[i][j] * w[j] * dt;
      }
      F[6 + i][12 + i] = dt;
    }
    std::vector<double> next = x;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) next[i] += R[i][j] * d[j], next[3 + i] += E[i][j] * w[j] * dt;
      next[6 + i] += x[12 + i] * dt;
      next[3 + i] = wrapped(next[3 + i]);
    }
    x = next;
    P = product(product(F, P), transposed(F));
    for (std::size_t i = 0; i < 15; ++i) P[i][i] += q[i] * dt;
  }

  double correct(const std::vector<std::size_t>& idx, const std::vector<double>& z, const Dense& N,
                 double gate) {
    const std::size_t m = idx.size();
    Dense H = zeros(m, 15), y = zeros(m, 1);
    for (std::size_t i = 0; i < m; ++i) {
      H[i][idx[i]] = 1;
      y[i][0] = z[i] - x[idx[i]];
      if (idx[i] == 3 || idx[i] == 4 || idx[i] == 5) y[i][0] = wrapped(y[i][0]);
    }
    Dense S = product(product(H, P), transposed(H));
    for (std::size_t i = 0; i < m; ++i)
      for (std::size_t j = 0; j < m; ++j) S[i][j] += N[i][j];
    const Dense Si = inverse_of(S);
    const double d2 = product(product(transposed(y), Si), y)[0][0];
    if (gate > 0 && std::sqrt(d2) > gate) return d2;
    const Dense K = product(product(P, transposed(H)), Si), KH = product(K, H), Ky = product(K, y);
    Dense I_KH = zeros(15, 15);
    for (std::size_t i = 0; i < 15; ++i) {
      x[i] += Ky[i][0];
      for (std::size_t j = 0; j < 15; ++j) I_KH[i][j] = (i == j) - KH[i][j];
    }
    for (const std::size_t i : {Roll, Pitch, Yaw}) x[i] = wrapped(x[i]);
    P = product(I_KH, P);
    return d2;
  }
};

/// Covariance of m components: A A^T + a little, of standard deviations about `size`.
Dense random_covariance(Stream& random, std::size_t m, double size) {
  Dense A = zeros(m, m);
  for (auto& row : A)
    for (double& each : row) each = random.uniform(-1, 1);
  Dense C = product(A, transposed(A));
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < m; ++j) C[i][j] = size * size * (C[i][j] + (i == j ? 0.2 : 0));
  return C;
}

double smooth(std::size_t i, double t) {
  switch (i) {
    case 0: return 5 * math::cos(0.3 * t);
    case 1: return 4 * math::sin(0.2 * t);
    case 2: return 0.5 * math::sin(0.5 * t);
    case 3: return 0.4 * math::sin(0.7 * t);
    case 4: return 0.5 * math::cos(0.4 * t);
    case 5: return wrapped(0.9 * t);  // round and round
    case 11: return 0.9;
    default: return 0.6 * math::sin(0.3 * t + static_cast<double>(i));
  }
}

// 60 s of an odometry (x, y, yaw, vx, vy, vyaw), a pose of all six, a twist and an imu, whose stamps interleave; every
// covariance is full and another; every 20th pose is 50 m off and must be rejected.
TEST(EkfReference, LongRandomSequences) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Stream random(seed, 15, Purpose::experiment, 0);
    Spec spec;
    spec.sensors.resize(4);
    const auto set = [&](std::size_t s, const char* name, SensorKind kind,
                         std::initializer_list<std::size_t> used) {
      spec.sensors[s].name = name, spec.sensors[s].kind = kind;
      for (const std::size_t i : used) spec.sensors[s].config[i] = true;
    };
    set(0, "odom0", SensorKind::odometry, {0, 1, 5, 6, 7, 11});
    set(1, "pose0", SensorKind::pose, {0, 1, 2, 3, 4, 5});
    set(2, "twist0", SensorKind::twist, {8, 10});
    set(3, "imu0", SensorKind::imu, {3, 4, 5, 9, 10, 11, 12, 13, 14});
    spec.sensors[1].pose_rejection_threshold = 8;
    for (std::size_t i = 0; i < 15; ++i) spec.initial_covariance[i] = random.uniform(0.1, 1);
    State state = begin(spec).value();
    Literal literal;
    for (std::size_t i = 0; i < 15; ++i) literal.P[i][i] = spec.initial_covariance[i];
    double at = 0;
    bool begun = false;
    int gated = 0;
    double worst = 0;

    for (int step = 1; step <= 6000; ++step) {
      const Time stamp = Time::from_s(0.01 * step);
      const double t = stamp.s();
      const std::size_t s = random.below(4);
      const bool outlier = s == 1 && random.below(20) == 0 && step > 100;
      // What goes into the message: value and covariance of all 15, in blocks that a message has.
      std::vector<double> z(15);
      const double size = random.uniform(0.02, 0.3);
      Dense blocks[5];  // pose, twist, and three of three
      blocks[0] = random_covariance(random, 6, size), blocks[1] = random_covariance(random, 6, size);
      for (int b = 2; b < 5; ++b) blocks[b] = random_covariance(random, 3, size);
      for (std::size_t i = 0; i < 15; ++i) z[i] = smooth(i, t) + size * random.normal();
      if (outlier) z[0] += 50;
      const Vec3 rpy{wrapped(z[3]), wrapped(z[4]), wrapped(z[5])};
      const Quat q = quat_from_rpy(rpy.x, rpy.y, rpy.z);
      const auto fill36 = [](const Dense& C) {
        std::array<double, 36> out{};
        for (std::size_t i = 0; i < 36; ++i) out[i] = C[i / 6][i % 6];
        return out;
      };
      const auto fill9 = [](const Dense& C) {
        std::array<double, 9> out{};
        for (std::size_t i = 0; i < 9; ++i) out[i] = C[i / 3][i % 3];
        return out;
      };
      const msg::PoseWithCovariance pose{{{z[0], z[1], z[2]}, q}, fill36(blocks[0])};
      const msg::TwistWithCovariance twist{{{z[6], z[7], z[8]}, {z[9], z[10], z[11]}}, fill36(blocks[1])};
      Outcome outcome{};
      if (s == 0) outcome = add(spec, state, 0, msg::Odometry{{stamp, ""}, "", pose, twist});
      if (s == 1) outcome = add(spec, state, 1, msg::PoseWithCovarianceStamped{{stamp, ""}, pose});
      if (s == 2) outcome = add(spec, state, 2, msg::TwistWithCovarianceStamped{{stamp, ""}, twist});
      if (s == 3)
        outcome = add(spec, state, 3,
                      msg::Imu{{stamp, ""},
                               q,
                               fill9(blocks[2]),
                               {z[9], z[10], z[11]},
                               fill9(blocks[3]),
                               {z[12], z[13], z[14]},
                               fill9(blocks[4])});
      ASSERT_EQ(outcome, Outcome::queued);
      std::vector<Report> reports;
      advance(spec, state, stamp, &reports);

      // The same for the literal filter: one correction for each block, in the order pose, twist, acceleration.
      struct Block {
        std::size_t first, size, of;
      };
      std::vector<Block> use;
      if (s == 0) use = {{0, 6, 0}, {6, 6, 1}};
      if (s == 1) use = {{0, 6, 0}};
      if (s == 2) use = {{6, 6, 1}};
      if (s == 3) use = {{3, 3, 2}, {9, 3, 3}, {12, 3, 4}};
      if (begun) literal.predict(spec.process_noise, t - at);
      at = t;
      std::size_t r = 0;
      for (const Block& block : use) {
        std::vector<std::size_t> idx;
        std::vector<double> values;
        for (std::size_t i = 0; i < block.size; ++i)
          if (spec.sensors[s].config[block.first + i])
            idx.push_back(block.first + i), values.push_back(z[block.first + i]);
        Dense N = zeros(idx.size(), idx.size());
        for (std::size_t i = 0; i < idx.size(); ++i)
          for (std::size_t j = 0; j < idx.size(); ++j)
            N[i][j] = blocks[block.of][idx[i] - block.first][idx[j] - block.first];
        if (!begun) {
          for (std::size_t i = 0; i < idx.size(); ++i) {
            literal.x[idx[i]] = idx[i] >= 3 && idx[i] <= 5 ? wrapped(values[i]) : values[i];
            for (std::size_t j = 0; j < idx.size(); ++j) literal.P[idx[i]][idx[j]] = N[i][j];
          }
          begun = true;
          ++r;
          continue;
        }
        const double gate = s == 1 ? 8 : 0, d2 = literal.correct(idx, values, N, gate);
        ASSERT_LT(r, reports.size());
        const bool rejected = gate > 0 && std::sqrt(d2) > gate;
        EXPECT_EQ(reports[r].outcome, rejected ? Outcome::gated : Outcome::used);
        EXPECT_NEAR(reports[r].squared_distance, d2, 1e-9 * (1 + d2));
        EXPECT_EQ(reports[r].components, idx.size());
        if (rejected) ++gated;
        if (outlier) { EXPECT_TRUE(rejected); }
        ++r;
      }
      for (std::size_t i = 0; i < 15; ++i) {
        worst = std::max(worst, std::abs(state.core.x[i] - literal.x[i]));
        for (std::size_t j = 0; j < 15; ++j)
          worst = std::max(worst, std::abs(state.core.P.at(i, j) - literal.P[i][j]));
      }
      ASSERT_LT(worst, 1e-9) << "seed " << seed << ", step " << step;
    }
    EXPECT_GT(gated, 30);
    RecordProperty("worst", std::to_string(worst));
  }
}

TEST(EkfReference, JacobianIsThatOfTheMotion) {
  Stream random(3, 1, Purpose::experiment, 0);
  for (int trial = 0; trial < 200; ++trial) {
    Vector x;
    for (double& each : x) each = random.uniform(-2, 2);
    x[Pitch] = random.uniform(-1.2, 1.2);
    const double dt = random.uniform(0.01, 0.5), h = 1e-5;
    const Matrix F = dense(transition(x, dt));
    for (std::size_t j = 0; j < states; ++j) {
      Vector up = x, down = x;
      up[j] += h, down[j] -= h;
      up = moved(up, dt), down = moved(down, dt);
      for (std::size_t i = 0; i < states; ++i) {
        const double d = up[i] - down[i];
        // Third derivatives are below 200: h^2 / 6 * 200 = 3e-9, rounding 1e-15 / h = 1e-10.
        EXPECT_NEAR(F.at(i, j), (is_angle(i) ? wrapped(d) : d) / (2 * h), 2e-8) << i << ' ' << j;
      }
    }
  }
}

TEST(EkfReference, CovarianceStaysSymmetricAndPositive) {
  Stream random(4, 1, Purpose::experiment, 0);
  Vector x{};
  Matrix P;
  for (std::size_t i = 0; i < states; ++i) P.at(i, i) = 1;
  const Vector noise = Spec{}.process_noise;
  for (int step = 0; step < 20000; ++step) {
    predict(x, P, noise, 1e-4);
    Innovation innovation;
    innovation.count = 2;
    innovation.index = {random.below(15), 0};
    innovation.index[1] = (innovation.index[0] + 1 + random.below(14)) % 15;
    innovation.y = {0.01 * random.normal(), 0.01 * random.normal()};
    innovation.noise[0] = innovation.noise[3] = 1e-9;  // nearly exact: where (I - K H) P loses its sign
    ASSERT_EQ(correct(x, P, innovation, 0).is, Correction::Is::used);
    for (std::size_t i = 0; i < states; ++i) {
      ASSERT_GT(P.at(i, i), 0);
      EXPECT_EQ(P.at(i, 0), P.at(0, i));
      EXPECT_EQ(P.padded[i * Matrix::stride + 15], 0);
    }
  }
  // Cholesky of the whole.
  for (std::size_t j = 0; j < states; ++j) {
    for (std::size_t k = 0; k < j; ++k) P.at(j, j) -= P.at(j, k) * P.at(j, k);
    ASSERT_GT(P.at(j, j), 0);
    P.at(j, j) = std::sqrt(P.at(j, j));
    for (std::size_t i = j + 1; i < states; ++i) {
      for (std::size_t k = 0; k < j; ++k) P.at(i, j) -= P.at(i, k) * P.at(j, k);
      P.at(i, j) /= P.at(j, j);
    }
  }
}

TEST(EkfReference, PredictionIsExactlySymmetric) {
  Vector x;
  Matrix P;
  for (std::size_t i = 0; i < states; ++i) x[i] = 0.1 * static_cast<double>(i) - 0.7, P.at(i, i) = 1;
  for (int step = 0; step < 5; ++step) predict(x, P, Spec{}.process_noise, 0.1);
  for (std::size_t i = 0; i < states; ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_EQ(P.at(i, j), P.at(j, i));
  EXPECT_NE(P.at(Yaw, Pitch), 0);
}

TEST(EkfReference, SingularAndGatedChangeNothing) {
  Vector x{};
  Matrix P;
  P.at(0, 0) = 1;
  Innovation innovation;
  innovation.count = 1;
  innovation.index = {1};
  innovation.y = {1};
  EXPECT_EQ(correct(x, P, innovation, 0).is, Correction::Is::singular);  // P and N are 0
  innovation.index = {0};
  innovation.noise = {3};
  // y^2 / (1 + 3) = 1/4: the distance is 0.5.
  EXPECT_EQ(correct(x, P, innovation, 0.49).is, Correction::Is::gated);
  EXPECT_EQ(x, Vector{});
  EXPECT_EQ(P.at(0, 0), 1);
  const Correction used = correct(x, P, innovation, 0.51);
  EXPECT_EQ(used.is, Correction::Is::used);
  EXPECT_DOUBLE_EQ(used.squared_distance, 0.25);
  EXPECT_DOUBLE_EQ(x[0], 0.25);  // K = 1 / 4
  EXPECT_DOUBLE_EQ(P.at(0, 0), 0.75);
}

}  // namespace
}  // namespace sandlot::navigation::ekf
