// Consistency: errors of the estimate, and innovations, are as large as the covariance says.
#include <gtest/gtest.h>

#include <cmath>

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
  const double low = chi_square(runs * states, -4.5), high = chi_square(runs * states, 4.5);
  double mean = 0;
  for (const double each : nees) {
    EXPECT_GT(each, low);
    EXPECT_LT(each, high);
    mean += each / (runs * states) / static_cast<double>(nees.size());
  }
  // The mean over time varies no more than one of its terms does.
  EXPECT_NEAR(mean, 1, 4.5 * std::sqrt(2.0 / (runs * states)));
  RecordProperty("nees", std::to_string(mean));
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_GT(components[s], 7000);
    EXPECT_GT(nis[s], 0.98 * chi_square(components[s], -4.5)) << s;
    EXPECT_LT(nis[s], 1.02 * chi_square(components[s], 4.5)) << s;
    RecordProperty("nis" + std::to_string(s), std::to_string(nis[s] / components[s]));
  }
}

}  // namespace
}  // namespace sandlot::navigation::ekf
