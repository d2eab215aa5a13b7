// Differences and the datum against a literal filter of 30 states: 15, two earlier poses, the datum's place. Dense matrices of
// Eigen, rotations as products of three, every derivative by dual numbers, P = (I - K H) P. It shares no code with the filter.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "base/random.h"
#include "navigation/estimation/test_messages.h"

namespace sandlot::navigation::ekf {
namespace {

using namespace test;

constexpr int all = 30, clone_at[2] = {15, 21}, datum_at = 27;
using V = Eigen::Matrix<double, all, 1>;
using M = Eigen::Matrix<double, all, all>;
using M6 = Eigen::Matrix<double, 6, 6>;

/// A number and its derivatives by the 30 states.
struct Dual {
  double v = 0;
  V d = V::Zero();
  Dual(double value = 0) : v(value) {}  // NOLINT(google-explicit-constructor)
  Dual(double value, V derivatives) : v(value), d(std::move(derivatives)) {}
  friend Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.d + b.d}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.d - b.d}; }
  friend Dual operator*(const Dual& a, const Dual& b) { return {a.v * b.v, a.v * b.d + b.v * a.d}; }
  friend Dual operator/(const Dual& a, const Dual& b) { return {a.v / b.v, (a.d - a.v / b.v * b.d) / b.v}; }
};
Dual dual_sin(const Dual& a) { return {math::sin(a.v), math::cos(a.v) * a.d}; }
Dual dual_cos(const Dual& a) { return {math::cos(a.v), -math::sin(a.v) * a.d}; }

using D3 = std::array<Dual, 3>;
using D33 = std::array<D3, 3>;
D33 times(const D33& a, const D33& b) {
  D33 c;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) c[i][j] = c[i][j] + a[i][k] * b[k][j];
  return c;
}
D3 times(const D33& a, const D3& b) {
  D3 c;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) c[i] = c[i] + a[i][k] * b[k];
  return c;
}
D33 flipped(const D33& a) {
  D33 c;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) c[i][j] = a[j][i];
  return c;
}
D33 turned(const Dual& roll, const Dual& pitch, const Dual& yaw) {
  const Dual sr = dual_sin(roll), cr = dual_cos(roll), sp = dual_sin(pitch), cp = dual_cos(pitch),
             sy = dual_sin(yaw), cy = dual_cos(yaw), minus = -1.0;
  const D33 x{D3{1.0, 0.0, 0.0}, D3{0.0, cr, minus * sr}, D3{0.0, sr, cr}};
  const D33 y{D3{cp, 0.0, sp}, D3{0.0, 1.0, 0.0}, D3{minus * sp, 0.0, cp}};
  const D33 z{D3{cy, minus * sy, 0.0}, D3{sy, cy, 0.0}, D3{0.0, 0.0, 1.0}};
  return times(z, times(y, x));
}
Eigen::Matrix3d plain(const D33& a) {
  Eigen::Matrix3d out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = a[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].v;
  return out;
}
Eigen::Matrix3d turned(const Vec3& rpy) { return plain(turned(rpy.x, rpy.y, rpy.z)); }

struct LiteralJoint {
  V x = V::Zero();
  M P = M::Zero();

  Dual at(int i) const { return {x[i], V::Unit(i)}; }
  D3 three(int i) const { return {at(i), at(i + 1), at(i + 2)}; }
  D33 rotation(int i) const { return turned(at(i + 3), at(i + 4), at(i + 5)); }
  void wrap() {
    for (const int i : {3, 18, 24})
      for (int k = i; k < i + 3; ++k) x[k] = math::wrap_angle(x[k]);
  }

  void predict(const Vector& q, double dt) {
    const D33 R = rotation(0);
    std::array<Dual, 15> next;
    for (int i = 0; i < 15; ++i) next[static_cast<std::size_t>(i)] = at(i);
    D3 way;
    for (int i = 0; i < 3; ++i)
      way[static_cast<std::size_t>(i)] = at(6 + i) * dt + at(12 + i) * (0.5 * dt * dt);
    const D3 step = times(R, way);
    const Dual sr = dual_sin(at(3)), cr = dual_cos(at(3)), sp = dual_sin(at(4)), cp = dual_cos(at(4));
    const Dual across = sr * at(10) + cr * at(11);
    next[3] = next[3] + (at(9) + sp / cp * across) * dt;
    next[4] = next[4] + (cr * at(10) - sr * at(11)) * dt;
    next[5] = next[5] + across / cp * dt;
    for (std::size_t i = 0; i < 3; ++i) {
      next[i] = next[i] + step[i];
      next[6 + i] = next[6 + i] + at(static_cast<int>(12 + i)) * dt;
    }
    M F = M::Identity();
    for (int i = 0; i < 15; ++i) {
      x[i] = next[static_cast<std::size_t>(i)].v;
      F.row(i) = next[static_cast<std::size_t>(i)].d.transpose();
    }
    wrap();
    P = F * P * F.transpose();
    for (int i = 0; i < 15; ++i) P(i, i) += q[static_cast<std::size_t>(i)] * dt;
  }
  double correct(const Eigen::MatrixXd& H, const Eigen::VectorXd& y, const Eigen::MatrixXd& N, double gate) {
    const Eigen::MatrixXd S = H * P * H.transpose() + N, inv = S.inverse();
    const double squared = y.dot(inv * y);
    if (gate > 0 && squared > gate * gate) return squared;
    const Eigen::MatrixXd K = P * H.transpose() * inv;
    x += K * y;
    wrap();
    P = ((M::Identity() - K * H) * P).eval();
    return squared;
  }
  void clone(int c) {
    M T = M::Identity();
    T.middleRows(c, 6).setZero();
    T.block(c, 0, 6, 6).setIdentity();
    P = (T * P * T.transpose()).eval();
    x.segment(c, 6) = x.head(6);
  }
  double correct_movement(int c, const std::vector<int>& used, const Eigen::Vector3d& way,
                          const Eigen::Matrix3d& turn, const M6& C, double gate) {
    const D33 Rt = flipped(rotation(c));
    D3 d;
    for (int i = 0; i < 3; ++i) d[static_cast<std::size_t>(i)] = at(i) - at(c + i);
    const D3 expected = times(Rt, d);
    const D33 R = times(Rt, rotation(0));
    // A change of R is [e]x R: e from the three derivatives of its elements, times R^T.
    Eigen::Matrix<double, 6, all> H;
    for (int k = 0; k < all; ++k) {
      Eigen::Matrix3d change;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          change(i, j) = R[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].d[k];
      const Eigen::Matrix3d skew = change * plain(R).transpose();
      H.col(k).tail<3>() << skew(2, 1), skew(0, 2), skew(1, 0);
      for (int i = 0; i < 3; ++i) H(i, k) = expected[static_cast<std::size_t>(i)].d[k];
    }
    const Eigen::AngleAxisd rest(turn * plain(R).transpose());
    Eigen::Matrix<double, 6, 1> y;
    for (int i = 0; i < 3; ++i) y[i] = way[i] - expected[static_cast<std::size_t>(i)].v;
    y.tail<3>() = rest.angle() * rest.axis();
    return correct(H(used, Eigen::all), y(used), C(used, used), gate);
  }
  /// @return  less than 0: it placed the datum
  double correct_fix(bool& placed, const Eigen::Vector3d& z, const Vec3& arm, const Eigen::Matrix3d& N) {
    const D3 arm_W = times(rotation(0), D3{arm.x, arm.y, arm.z});
    Eigen::Matrix<double, 3, all> H;
    Eigen::Vector3d y;
    for (int i = 0; i < 3; ++i) {
      const Dual h = at(i) + arm_W[static_cast<std::size_t>(i)] - at(datum_at + i);
      H.row(i) = h.d.transpose();
      y[i] = z[i] - h.v;
    }
    if (placed) return correct(H, y, N, 0);
    placed = true;
    H.rightCols<3>().setZero();
    x.tail<3>() = -y;
    M T = M::Identity();
    T.bottomRows<3>() = H;
    P = (T * P * T.transpose()).eval();
    P.bottomRightCorner<3, 3>() += N;
    return -1;
  }
};

Eigen::MatrixXd random_covariance(Stream& random, int m, double size) {
  const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(m, m, [&] { return random.uniform(-1, 1); });
  return size * size * (A * A.transpose() + 0.2 * Eigen::MatrixXd::Identity(m, m));
}
template <std::size_t n>
std::array<double, n> row_by_row(const Eigen::MatrixXd& C) {
  std::array<double, n> out{};
  for (int i = 0; i < C.rows(); ++i)
    for (int j = 0; j < C.cols(); ++j) out[static_cast<std::size_t>(i * C.cols() + j)] = C(i, j);
  return out;
}

Pose on_the_way(double t) {
  return pose_from_rpy({5 * math::cos(0.3 * t), 4 * math::sin(0.2 * t), 0.5 * math::sin(0.5 * t)},
                       {0.4 * math::sin(0.7 * t), 0.5 * math::cos(0.4 * t), math::wrap_angle(0.9 * t)});
}

/// What a message of a pose was, for the one after.
struct Last {
  bool set = false;
  Eigen::Vector3d p;
  Eigen::Matrix3d R;
  Eigen::Matrix<double, 6, 6> C;
};

/// Way and turn between two poses and their covariance, `sign` 1 for independent errors, -1 for accumulated ones.
void between(const Last& a, const Last& b, double sign, Eigen::Vector3d& way, Eigen::Matrix3d& turn, M6& C) {
  const Eigen::Vector3d d = b.p - a.p;
  way = a.R.transpose() * d;
  turn = a.R.transpose() * b.R;
  // b - a, less what a turn of a makes of the way: e x d = -[d]x e, and d_AB changes by the opposite.
  M6 J = M6::Identity(), to_a = M6::Zero();
  J.topRightCorner<3, 3>() << 0, d.z(), -d.y(), -d.z(), 0, d.x(), d.y(), -d.x(), 0;
  to_a.topLeftCorner<3, 3>() = to_a.bottomRightCorner<3, 3>() = a.R.transpose();
  C = to_a * (b.C + sign * J * a.C * J.transpose()) * to_a.transpose();
}

// 40 s of an odometry whose errors accumulate (all six), one with independent errors (x, y, yaw; each twentieth 30 m off and to be
// rejected), an odometry whose twist tells, an imu, and a receiver on an arm without a datum; every covariance is full.
TEST(EkfClones, AsALiteralFilterOfThirtyStates) {
  double worst = 0;
  int gated = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Stream random(seed, 16, Purpose::experiment, 0);
    Spec spec;
    spec.sensors = {sensor("first", SensorKind::odometry, {X, Y, Z, Roll, Pitch, Yaw}),
                    sensor("second", SensorKind::pose, {X, Y, Yaw}),
                    sensor("imu", SensorKind::imu, {Roll, Pitch, Yaw, Vroll, Vpitch, Vyaw, Ax, Ay, Az}),
                    sensor("gps", SensorKind::gps, {X, Y, Z})};
    spec.sensors[0].differential = spec.sensors[1].differential = true;
    const bool by_twist = seed % 2 == 0;
    spec.sensors[0].pose_errors = by_twist ? PoseErrors::as_twist : PoseErrors::accumulated;
    spec.sensors[1].pose_rejection_threshold = 8;
    spec.sensors[3].mount.p = {0.4, -0.2, 1.1};
    const Vec3 arm = spec.sensors[3].mount.p;
    for (std::size_t i = 0; i < states; ++i) spec.initial_covariance[i] = random.uniform(0.1, 1);
    State state = begin(spec).value();
    LiteralJoint literal;
    for (std::size_t i = 0; i < states; ++i)
      literal.P(static_cast<int>(i), static_cast<int>(i)) = spec.initial_covariance[i];
    const Datum where{
        .latitude_rad = 0.8, .longitude_rad = 0.15, .altitude_m = 300, .yaw_rad = 0, .offset_m = {}};
    Last last[2];
    double cloned_at[2] = {}, at = 0;
    bool begun = false, placed = false;
    M6 grown = M6::Zero();

    for (int step = 1; step <= 2000; ++step) {
      const Time stamp = Time::from_s(0.02 * step);
      const double t = stamp.s(), size = random.uniform(0.02, 0.2);
      const std::size_t s = begun ? random.below(4) : 2;
      const Pose X = on_the_way(t);
      const Vec3 rpy = rpy_from_quat(X.q);
      const auto noisy = [&](Vec3 v) {
        return v + size * Vec3{random.normal(), random.normal(), random.normal()};
      };
      const Vec3 p = noisy(X.p), angles = noisy(rpy);
      if (begun) literal.predict(spec.process_noise, t - at);
      at = t;
      double squared = -1;
      Outcome outcome{};
      if (s < 2) {
        M6 C = random_covariance(random, 6, size);
        msg::Odometry message;
        message.header.stamp = stamp;
        message.pose.pose = pose_from_rpy(p, angles);
        const bool outlier = s == 1 && random.below(20) == 0;
        if (outlier) message.pose.pose.p.x += 30;
        Last now{true, Eigen::Vector3d(message.pose.pose.p.x, message.pose.pose.p.y, message.pose.pose.p.z),
                 turned(angles), C};
        const double dt = t - cloned_at[s];
        const bool difference = last[s].set && dt <= 1;
        Eigen::Vector3d way;
        Eigen::Matrix3d turn;
        if (s == 0 && !by_twist) {
          // Accumulated: what it was before, seen from the end of the way, and more.
          M6 J = M6::Identity();
          if (last[0].set) {
            const Eigen::Vector3d d = now.p - last[0].p;
            J.topRightCorner<3, 3>() << 0, d.z(), -d.y(), -d.z(), 0, d.x(), d.y(), -d.x(), 0;
          }
          grown = (J * grown * J.transpose() + C).eval();
          now.C = grown;
        }
        message.pose.covariance = row_by_row<36>(now.C);
        if (difference) between(last[s], now, s == 0 ? -1 : 1, way, turn, C);
        if (by_twist && s == 0) {
          C = random_covariance(random, 6, size);
          message.twist.covariance = row_by_row<36>(C / (dt * dt));
          M6 to_a = M6::Zero();
          if (difference) {
            to_a.topLeftCorner<3, 3>() = to_a.bottomRightCorner<3, 3>() = turn;
            C = to_a * C * to_a.transpose();
          }
        }
        const double gate = s == 1 ? 8 : 0;
        if (difference)
          squared = literal.correct_movement(
              clone_at[s], s == 0 ? std::vector<int>{0, 1, 2, 3, 4, 5} : std::vector<int>{0, 1, 5}, way, turn,
              C, gate);
        const bool rejected = gate > 0 && squared > gate * gate;
        gated += rejected;
        if (!rejected) {
          literal.clone(clone_at[s]);
          last[s] = now, cloned_at[s] = t;
        }
        if (s == 0) outcome = add(spec, state, 0, message);
        if (s == 1)
          outcome = add(spec, state, 1, msg::PoseWithCovarianceStamped{message.header, message.pose});
        ASSERT_EQ(outcome, Outcome::queued);
        advance(spec, state, stamp);
        EXPECT_EQ(state.sensors[s].last, !difference ? Outcome::started
                                         : rejected  ? Outcome::gated
                                                     : Outcome::used);
      } else if (s == 2) {
        msg::Imu message = imu_at(t, angles, noisy({0.1, 0.2, 0.9}), noisy({0.1, 0, -0.1}));
        const Eigen::MatrixXd C[3] = {random_covariance(random, 3, size), random_covariance(random, 3, size),
                                      random_covariance(random, 3, size)};
        message.orientation_covariance = row_by_row<9>(C[0]);
        message.angular_velocity_covariance = row_by_row<9>(C[1]);
        message.linear_acceleration_covariance = row_by_row<9>(C[2]);
        ASSERT_EQ(add(spec, state, 2, message), Outcome::queued);
        advance(spec, state, stamp);
        const Vec3 values[3] = {angles, message.angular_velocity, message.linear_acceleration};
        const int first[3] = {3, 9, 12};
        for (int part = 0; part < 3; ++part) {
          Eigen::MatrixXd H = Eigen::MatrixXd::Zero(3, all);
          Eigen::Vector3d y;
          for (int i = 0; i < 3; ++i) {
            H(i, first[part] + i) = 1;
            y[i] = values[part][static_cast<std::size_t>(i)] - literal.x[first[part] + i];
            if (part == 0) y[i] = math::wrap_angle(y[i]);
          }
          if (begun) {
            squared = literal.correct(H, y, C[part], 0);
            continue;
          }
          literal.x.segment(first[part], 3) += y;
          literal.wrap();
          literal.P.block(first[part], first[part], 3, 3) = C[part];
          begun = true;
        }
      } else {
        const Pose X_now = pose_from_rpy(p, angles);
        const Vec3 antenna = X_now * arm;
        msg::NavSatFix message = fix_at(t, where, antenna);
        const Eigen::MatrixXd C = random_covariance(random, 3, size);
        message.position_covariance = row_by_row<9>(C);
        ASSERT_EQ(add(spec, state, 3, message), Outcome::queued);
        advance(spec, state, stamp);
        // In the axes of the datum that the first fix gave the filter: how they lie in W is what is estimated.
        constexpr double deg = math::pi / 180;
        const Vec3 z = to_world(*state.datum,
                                {message.latitude * deg, message.longitude * deg, message.altitude});
        const bool first = !placed;
        squared = literal.correct_fix(placed, Eigen::Vector3d(z.x, z.y, z.z), arm, C);
        EXPECT_EQ(state.sensors[3].last, first ? Outcome::started : Outcome::used);
      }
      if (squared >= 0) {
        EXPECT_NEAR(state.sensors[s].squared_distance, squared, 1e-8 * (1 + squared)) << s;
      }

      const auto column = [](int i) {
        return i < 15 ? static_cast<std::size_t>(i)
                      : ExtraStates::column(static_cast<std::size_t>((i - 15) / 6),
                                            static_cast<std::size_t>((i - 15) % 6));
      };
      const ExtraStates& extra = state.core.extra;
      for (int i = 0; i < all; ++i) {
        const auto own = static_cast<std::size_t>(i);
        const double off = (own < 15 ? state.core.x[own] : extra.x[own - 15]) - literal.x[i];
        worst = std::max(worst, std::abs(off));
        for (int j = 0; j <= i; ++j)
          worst = std::max(worst, std::abs((i < 15 ? state.core.P.at(own, static_cast<std::size_t>(j))
                                                   : extra.row(0, own - 15)[column(j)]) -
                                           literal.P(i, j)));
      }
      ASSERT_LT(worst, 1e-9) << "seed " << seed << ", step " << step << ", sensor " << s;
    }
  }
  EXPECT_GT(gated, 30);
  RecordProperty("worst", std::to_string(worst));
}

}  // namespace
}  // namespace sandlot::navigation::ekf
