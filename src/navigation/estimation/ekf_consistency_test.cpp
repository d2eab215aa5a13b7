// Consistency: errors of the estimate, and innovations, are as large as the covariance says.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <span>

#include "base/math.h"
#include "base/random.h"
#include "navigation/estimation/ekf.h"

namespace sandlot::navigation::ekf {
namespace {

/// Quantile of chi-square with k degrees of freedom, z standard deviations of a normal number from its median.
/// E. B. Wilson, M. M. Hilferty, The distribution of chi-square (1931): within 0.1 % for k >= 50.
double chi_square(double k, double z) {
  const double root = 1 - 2 / (9 * k) + z * std::sqrt(2 / (9 * k));
  return k * root * root * root;
}

/// e^T P^-1 e, by the Cholesky factor.
double squared_error(const Estimate& estimate, const Vector& truth) {
  std::array<std::array<double, states>, states> L{};
  double sum = 0;
  std::array<double, states> white{};
  for (std::size_t i = 0; i < states; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double s = estimate.P.at(i, j);
      for (std::size_t k = 0; k < j; ++k) s -= L[i][k] * L[j][k];
      L[i][j] = i == j ? std::sqrt(s) : s / L[j][j];
    }
    double e = estimate.x[i] - truth[i];
    if (is_angle(i)) e = math::wrap_angle(e);
    for (std::size_t k = 0; k < i; ++k) e -= L[i][k] * white[k];
    white[i] = e / L[i][i];
    sum += white[i] * white[i];
  }
  return sum;
}

/// Sums over runs are within the bounds of chi-square.
/// @param nees     at each time; `freedom` degrees of freedom
/// @param numbers  how many each sensor has measured, the degrees of freedom of its NIS
void expect_consistent(std::span<const double> nees, double freedom, std::span<const double> nis,
                       std::span<const double> numbers) {
  double mean = 0;
  for (const double each : nees) {
    EXPECT_GT(each, chi_square(freedom, -4.5));
    EXPECT_LT(each, chi_square(freedom, 4.5));
    mean += each / freedom / static_cast<double>(nees.size());
  }
  // The mean over time varies no more than one of its terms does.
  EXPECT_NEAR(mean, 1, 4.5 * std::sqrt(2.0 / freedom));
  testing::Test::RecordProperty("nees", std::to_string(mean));
  for (std::size_t s = 0; s < nis.size(); ++s) {
    EXPECT_GT(numbers[s], 7000);
    EXPECT_GT(nis[s], 0.98 * chi_square(numbers[s], -4.5)) << s;
    EXPECT_LT(nis[s], 1.02 * chi_square(numbers[s], 4.5)) << s;
    testing::Test::RecordProperty("nis" + std::to_string(s), std::to_string(nis[s] / numbers[s]));
  }
}

// The truth moves by the filter's model with its process noise; 50 runs of 10 s. Odometry at 10 Hz, imu at 50 Hz, gps at 5 Hz.
// At one time the sum of the runs' NEES is chi-square with 50 * 15 degrees of freedom; there are 100 times, so a bound of
// 4.5 standard deviations fails by chance in 7e-4 of all seeds. Innovations are white: the sum of all NIS is chi-square
// with as many degrees of freedom as there were numbers measured; 2 % more are allowed for what linearisation leaves out.
TEST(EkfConsistency, NeesAndNisOfFiftyRuns) {
  constexpr int runs = 50, steps = 500, stride = 5;
  constexpr double dt = 0.02;
  Spec spec;
  spec.sensors.resize(3);
  spec.sensors[0].name = "odom0", spec.sensors[0].kind = SensorKind::odometry;
  for (const std::size_t i : {Vx, Vy, Vz, Vyaw}) spec.sensors[0].config[i] = true;
  spec.sensors[1].name = "imu0", spec.sensors[1].kind = SensorKind::imu;
  for (const std::size_t i : {Roll, Pitch, Yaw, Vroll, Vpitch, Vyaw, Ax, Ay, Az})
    spec.sensors[1].config[i] = true;
  spec.sensors[2].name = "gps0", spec.sensors[2].kind = SensorKind::gps;
  for (const std::size_t i : {X, Y, Z}) spec.sensors[2].config[i] = true;
  spec.datum = Datum{.latitude_rad = 0.8, .longitude_rad = 0.15, .altitude_m = 300, .yaw_rad = 0.7};
  spec.initial_covariance = {.01, .01, .01, .001, .001, .001, .01, .01, .01, .001, .001, .001, .01, .01, .01};
  // Roll and pitch stay away from a right angle: after 10 s their variance is 1e-3 * 10 + 1e-4 * 10^3 / 3 + 1e-3 * 10^2 =
  // 0.38^2 rad^2.
  spec.process_noise[Roll] = spec.process_noise[Pitch] = 1e-3;
  spec.process_noise[Vroll] = spec.process_noise[Vpitch] = 1e-4;
  spec.initial_state[Vx] = 1, spec.initial_state[Vyaw] = 0.4;
  const double speed_sd = 0.05, rate_sd = 0.02, angle_sd = 0.02, acceleration_sd = 0.1, place_sd = 0.1;

  std::array<double, steps / stride> nees{};
  std::array<double, 3> nis{}, components{};
  for (std::uint64_t run = 0; run < runs; ++run) {
    Stream random(2026, run, Purpose::experiment, 0);
    State state = begin(spec).value();
    Vector truth = spec.initial_state;
    for (std::size_t i = 0; i < states; ++i)
      truth[i] += std::sqrt(spec.initial_covariance[i]) * random.normal();
    std::vector<Report> reports;
    for (int step = 0; step < steps; ++step) {
      if (step > 0) {
        truth = moved(truth, dt);
        for (std::size_t i = 0; i < states; ++i)
          truth[i] += std::sqrt(spec.process_noise[i] * dt) * random.normal();
      }
      const Time now = Time::from_s(dt * step);
      const auto measured = [&](std::size_t first, double sd) {
        return Vec3{truth[first] + sd * random.normal(), truth[first + 1] + sd * random.normal(),
                    truth[first + 2] + sd * random.normal()};
      };
      const auto variance = [](double sd) {
        return std::array<double, 9>{sd * sd, 0, 0, 0, sd * sd, 0, 0, 0, sd * sd};
      };
      msg::Imu imu;
      imu.header.stamp = now;
      const Vec3 rpy = measured(Roll, angle_sd);
      imu.orientation = quat_from_rpy(rpy.x, rpy.y, rpy.z);
      imu.orientation_covariance = variance(angle_sd);
      imu.angular_velocity = measured(Vroll, rate_sd);
      imu.angular_velocity_covariance = variance(rate_sd);
      imu.linear_acceleration = measured(Ax, acceleration_sd);
      imu.linear_acceleration_covariance = variance(acceleration_sd);
      ASSERT_EQ(add(spec, state, 1, imu), Outcome::queued);
      if (step % 5 == 0) {
        msg::Odometry odometry;
        odometry.header.stamp = now;
        odometry.twist.twist.linear = measured(Vx, speed_sd);
        odometry.twist.twist.angular.z = truth[Vyaw] + rate_sd * random.normal();
        for (std::size_t i = 0; i < 3; ++i) odometry.twist.covariance[7 * i] = speed_sd * speed_sd;
        odometry.twist.covariance[35] = rate_sd * rate_sd;
        ASSERT_EQ(add(spec, state, 0, odometry), Outcome::queued);
      }
      if (step % 10 == 3) {
        const geodesy::Geodetic place = to_geodetic(*spec.datum, measured(X, place_sd));
        msg::NavSatFix fix;
        fix.header.stamp = now;
        fix.latitude = place.latitude_rad * 180 / math::pi,
        fix.longitude = place.longitude_rad * 180 / math::pi;
        fix.altitude = place.height_m;
        fix.position_covariance = variance(place_sd);
        fix.position_covariance_type = msg::NavSatFix::covariance_known;
        ASSERT_EQ(add(spec, state, 2, fix), Outcome::queued);
      }
      advance(spec, state, now, &reports);
      if (step % stride == 0)
        nees[static_cast<std::size_t>(step / stride)] += squared_error(estimate(spec, state, now), truth);
    }
    for (const Report& each : reports) {
      ASSERT_EQ(each.outcome, Outcome::used);
      nis[each.sensor] += each.squared_distance;
      components[each.sensor] += static_cast<double>(each.components);
    }
  }
  expect_consistent(nees, runs * states, nis, components);
}

// Wheels and eyes by differences, one with the other's rate, and a receiver on an arm 1.5 m up without a datum, whose first fix comes
// while the tilt is unsure by 0.016 rad; an imu tells it from 1 s on. The truth moves by the filter's model; 50 runs of 10 s. Bounds as
// above; the datum's own error is part of it: its estimate less what it is, over its variance, has 50 * 3 degrees.
TEST(EkfConsistency, DifferencesAndADatumOfFiftyRuns) {
  constexpr int runs = 50, steps = 500;
  constexpr double dt = 0.02;
  Spec spec;
  spec.sensors.resize(4);
  const auto set = [&](std::size_t s, const char* name, SensorKind kind,
                       std::initializer_list<std::size_t> used) {
    spec.sensors[s].name = name, spec.sensors[s].kind = kind;
    for (const std::size_t i : used) spec.sensors[s].config[i] = true;
  };
  set(0, "wheels", SensorKind::odometry, {X, Y, Yaw});
  set(1, "eyes", SensorKind::pose, {X, Y, Z, Roll, Pitch, Yaw});
  set(2, "imu", SensorKind::imu, {Roll, Pitch, Vroll, Vpitch, Vyaw});
  set(3, "gps", SensorKind::gps, {X, Y, Z});
  spec.sensors[0].differential = spec.sensors[1].differential = true;
  spec.sensors[0].pose_errors = PoseErrors::as_twist;
  spec.sensors[1].pose_errors = PoseErrors::accumulated;
  const Vec3 arm = spec.sensors[3].mount.p = {0.3, 0, 1.5};
  spec.initial_covariance = {1e-6, 1e-6, 1e-6, .0025, .0025, 1e-6, .01, .01,
                             .01,  .001, .001, .001,  .01,   .01,  .01};
  spec.process_noise[Roll] = spec.process_noise[Pitch] = 1e-3;
  spec.process_noise[Vroll] = spec.process_noise[Vpitch] = 1e-4;
  // A tenth of the noise of above: with all of it, what linearisation leaves out makes the NEES of 1000 runs 10 % too large,
  // with this 0.5 % (300 runs).
  for (std::size_t i = 0; i < states; ++i) spec.process_noise[i] *= 0.1, spec.initial_covariance[i] *= 0.1;
  spec.initial_state[Vx] = 1, spec.initial_state[Vyaw] = 0.4;
  const Datum where{
      .latitude_rad = 0.8, .longitude_rad = 0.15, .altitude_m = 300, .yaw_rad = 0, .offset_m = {}};
  const double way_sd = 0.005, turn_sd = 0.003, rate_sd = 0.02, angle_sd = 0.02, place_sd = 0.1;

  std::array<double, steps / 5> nees{};
  std::array<double, 4> nis{}, components{};
  double datum_error = 0;
  for (std::uint64_t run = 0; run < runs; ++run) {
    Stream random(2027, run, Purpose::experiment, 0);
    const auto noise = [&](double sd) {
      return sd * Vec3{random.normal(), random.normal(), random.normal()};
    };
    State state = begin(spec).value();
    Vector truth = spec.initial_state;
    for (std::size_t i = 0; i < states; ++i)
      truth[i] += std::sqrt(spec.initial_covariance[i]) * random.normal();
    const auto pose_of = [](const Vector& x) {
      return pose_from_rpy({x[X], x[Y], x[Z]}, {x[Roll], x[Pitch], x[Yaw]});
    };
    std::vector<Report> reports;
    Pose before[2] = {pose_of(truth), pose_of(truth)}, told[2];
    Eigen::Matrix<double, 6, 6> grown = 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
    for (int step = 0; step < steps; ++step) {
      if (step > 0) {
        truth = moved(truth, dt);
        for (std::size_t i = 0; i < states; ++i)
          truth[i] += std::sqrt(spec.process_noise[i] * dt) * random.normal();
      }
      const Time now = Time::from_s(dt * step);
      const Pose is = pose_of(truth);
      for (std::size_t s = 0; s < 2; ++s) {
        if (step % (s == 0 ? 2 : 5) != 0) continue;
        // The odometry adds up what it measures: way and turn since before, each with an error.
        const Pose went = inverse(before[s]) * is;
        const Vec3 e = noise(turn_sd);
        const double angle = norm(e);
        const Pose from = told[s];
        told[s] = told[s] * Pose{went.p + noise(way_sd), quat_from_axis_angle(e / angle, angle) * went.q};
        before[s] = is;
        msg::Odometry odometry;
        odometry.header.stamp = now;
        odometry.pose.pose = told[s];
        if (s == 0) {
          const double span = 2 * dt;
          for (std::size_t i = 0; i < 6; ++i) {
            const double sd = (i < 3 ? way_sd : turn_sd) / span;
            odometry.twist.covariance[7 * i] = sd * sd;
          }
          ASSERT_EQ(add(spec, state, 0, odometry), Outcome::queued);
        } else {
          // A turn of before turns the way: d = b - a - turn x way.
          const Vec3 way = told[1].p - from.p;
          Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Identity();
          J.topRightCorner<3, 3>() << 0, way.z, -way.y, -way.z, 0, way.x, way.y, -way.x, 0;
          grown = (J * grown * J.transpose()).eval();
          for (int i = 0; i < 6; ++i) grown(i, i) += i < 3 ? way_sd * way_sd : turn_sd * turn_sd;
          for (int i = 0; i < 36; ++i)
            odometry.pose.covariance[static_cast<std::size_t>(i)] = grown(i / 6, i % 6);
          ASSERT_EQ(add(spec, state, 1, msg::PoseWithCovarianceStamped{odometry.header, odometry.pose}),
                    Outcome::queued);
        }
      }
      const auto variance = [](double sd) {
        return std::array<double, 9>{sd * sd, 0, 0, 0, sd * sd, 0, 0, 0, sd * sd};
      };
      if (step >= 50) {
        msg::Imu imu;
        imu.header.stamp = now;
        const Vec3 e = noise(angle_sd);
        imu.orientation = quat_from_rpy(truth[Roll] + e.x, truth[Pitch] + e.y, truth[Yaw]);
        imu.orientation_covariance = variance(angle_sd);
        imu.angular_velocity = Vec3{truth[Vroll], truth[Vpitch], truth[Vyaw]} + noise(rate_sd);
        imu.angular_velocity_covariance = variance(rate_sd);
        ASSERT_EQ(add(spec, state, 2, imu), Outcome::queued);
      }
      if (step % 10 == 0) {
        const geodesy::Geodetic place = to_geodetic(where, is * arm + noise(place_sd));
        msg::NavSatFix fix;
        fix.header.stamp = now;
        fix.latitude = place.latitude_rad * 180 / math::pi,
        fix.longitude = place.longitude_rad * 180 / math::pi;
        fix.altitude = place.height_m;
        fix.position_covariance = variance(place_sd);
        fix.position_covariance_type = msg::NavSatFix::covariance_known;
        ASSERT_EQ(add(spec, state, 3, fix), Outcome::queued);
      }
      advance(spec, state, now, &reports);
      if (step % 5 == 4)
        nees[static_cast<std::size_t>(step / 5)] += squared_error(estimate(spec, state, now), truth);
    }
    for (const Report& each : reports) {
      if (each.outcome == Outcome::started) continue;
      ASSERT_EQ(each.outcome, Outcome::used);
      nis[each.sensor] += each.squared_distance;
      components[each.sensor] += static_cast<double>(each.components);
    }
    // The filter's datum lies where the world's is, in the world that the truth is in.
    const Vec3 place = to_world(*state.datum, to_geodetic(where, {}));
    const std::size_t slot = *spec.datum_slot();
    for (std::size_t i = 0; i < 3; ++i) {
      const double off = place[i] + state.core.extra.x[6 * slot + i];
      datum_error += off * off / state.core.extra.variance(slot, i);
    }
  }
  expect_consistent(nees, runs * states, nis, components);
  EXPECT_GT(datum_error, chi_square(runs * 3, -4.5));
  EXPECT_LT(datum_error, chi_square(runs * 3, 4.5));
  RecordProperty("datum", std::to_string(datum_error / (runs * 3)));
}

}  // namespace
}  // namespace sandlot::navigation::ekf
