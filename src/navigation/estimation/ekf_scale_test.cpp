// Constant relative errors of an odometry's ways and turns (Sensor::way_scale_deviation), against what can be written by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "navigation/estimation/test_messages.h"

namespace sandlot::navigation::ekf {
namespace {

using namespace test;

constexpr double step_s = 0.1;

/// A filter with an odometry and a sensor of places, which says where it begins, at a stand: its first difference tells a velocity alone, since
/// there is no pose of the filter yet from which it counts. Velocities are open after that.
Spec spec_of(double way_scale, double turn_scale) {
  Spec spec;
  spec.process_noise = {0, 0, 0, 0, 0, 0, 1000, 1000, 1000, 1, 1, 1, 1, 1, 1};
  spec.sensors = {sensor("odom", SensorKind::odometry, {X, Y, Z, Roll, Pitch, Yaw})};
  Sensor& odometry = spec.sensors[0];
  odometry.differential = true;
  odometry.pose_errors = PoseErrors::as_twist;
  odometry.way_scale_deviation = way_scale, odometry.turn_scale_deviation = turn_scale;
  spec.sensors.push_back(sensor("place", SensorKind::pose, {X, Y, Z, Roll, Pitch, Yaw}));
  for (std::size_t i = Vx; i < states; ++i) spec.initial_covariance[i] = 1e-12;
  return spec;
}

/// @param step_m  errors of each difference, other than the scale's
msg::Odometry odometry_at(double t_s, double x_m, double yaw, double step_m) {
  msg::Odometry out;
  out.header.stamp = Time::from_s(t_s);
  out.pose = {pose_from_rpy({x_m, 0, 0}, {0, 0, yaw}), diagonal6(1e-6, 1e-6)};
  const double variance = step_m * step_m / (step_s * step_s);
  out.twist.covariance = diagonal6(variance, variance);
  return out;
}

double deviation_x(const Spec& spec, const State& state, Time now) {
  return std::sqrt(estimate(spec, state, now).P.at(X, X));
}

TEST(EkfScale, CancelsOnTheWayBackAndForth) {
  const Spec spec = spec_of(0.02, 0);
  State state = begin(spec).value();
  Time now;
  ASSERT_EQ(add(spec, state, 1, pose_at(0, {}, {}, 1e-10, 1e-10)), Outcome::queued);
  // 10 m ahead and back, 5 m (1 - cos): 0.2 m at the far end, and at the end what is not the scale's, 0.01 mm at the start and in each of 200
  // steps. Each expected way is about that of the step before, whose sum is the same. As a random walk the errors would be sqrt(2) times
  // as large as at the far end.
  double farthest = 0;
  for (int i = 0; i <= 201; ++i) {
    const double x_m = 5 - 5 * math::cos(math::tau * std::min(i, 200) / 200);
    now = Time::from_s(i * step_s + 1e-6);  // messages of this very moment wait for others
    ASSERT_EQ(add(spec, state, 0, odometry_at(i * step_s, x_m, 0, 1e-5)), Outcome::queued);
    advance(spec, state, now);
    if (i == 101) farthest = deviation_x(spec, state, now);
  }
  EXPECT_NEAR(farthest, 0.02 * 10, 1e-3);
  EXPECT_LT(deviation_x(spec, state, now), 1e-3);
}

TEST(EkfScale, IsFoundByAReceiver) {
  const Spec spec = spec_of(0.05, 0.1);
  State state = begin(spec).value();
  for (int i = -1; i <= 100; ++i) {
    const double t_s = (i + 1) * step_s, x_m = 0.1 * std::max(0, i), yaw = 0.02 * i;
    // 5 m ahead, then a turn on the spot.
    const bool turns = i > 50;
    const double way = turns ? 5 : x_m, turn = turns ? yaw - 1 : 0;
    ASSERT_EQ(add(spec, state, 0, odometry_at(t_s, 1.02 * way, 0.95 * turn, 1e-6)), Outcome::queued);
    ASSERT_EQ(add(spec, state, 1, pose_at(t_s, {way, 0, 0}, {0, 0, turn}, 1e-4, 1e-4)), Outcome::queued);
    advance(spec, state, Time::from_s(t_s + 1e-6));
  }
  const ExtraStates& extra = state.core.extra;
  const std::size_t slot = *spec.scale_slot(0);
  EXPECT_EQ(slot, 1u);
  // The line through 102 places of 1 cm, whose slope is 1 / (1 + s) and whose start is open, too: its deviation is 1 cm by the root of the sum of
  // (x - mean)^2, which is 282 m^2 for the ways 0, 0, 0.1 ... 5 m and fifty times 5 m. The same of turns, 0 and 0.02 ... 1 rad, where the start
  // is known by 102 readings and by the way's direction, to 1 cm by the root of 282 m^2, as well as by another 282 readings:
  // 17.17 - 25.5^2 / 384 = 15.5 rad^2.
  const double way = 1.02 * 0.01 / std::sqrt(282.1), turn = 0.95 * 0.01 / std::sqrt(15.48);
  EXPECT_NEAR(std::sqrt(extra.variance(slot, 0)), way, 0.05 * way);
  EXPECT_NEAR(std::sqrt(extra.variance(slot, 1)), turn, 0.05 * turn);
  // Without noise. The step in which a way or turn begins is not expected, and counts as none; that in which it ends counts as one: one of 50.
  EXPECT_NEAR(extra.x[slot * ExtraStates::per_slot], 0.02, 0.02 * 0.05);
  EXPECT_NEAR(extra.x[slot * ExtraStates::per_slot + 1], -0.05, 0.05 * 0.05);
}

TEST(EkfScale, IsRefusedWhereThereAreNoDifferences) {
  Spec spec = spec_of(0.02, 0);
  spec.sensors[0].differential = false;
  const auto begun = begin(spec);
  ASSERT_FALSE(begun);
  EXPECT_NE(begun.error().text().find("differential: true"), std::string::npos) << begun.error().text();
}

TEST(EkfScale, TakesASlotEach) {
  Spec spec = spec_of(0.02, 0.02);
  spec.sensors.pop_back();
  const Sensor one = spec.sensors[0];
  for (const char* const name : {"b", "c"}) {
    spec.sensors.push_back(one);
    spec.sensors.back().name = name;
  }
  EXPECT_EQ(spec.slots(), 6u);
  EXPECT_TRUE(begin(spec));
  spec.sensors.push_back(one);
  spec.sensors.back().name = "d";
  EXPECT_FALSE(begin(spec));
}

}  // namespace
}  // namespace sandlot::navigation::ekf
