#include "navigation/estimation/ekf.h"

#include <gtest/gtest.h>

#include "base/bytes.h"
#include "base/random.h"
#include "base/read.h"
#include "navigation/estimation/test_messages.h"

namespace sandlot::navigation::ekf {
namespace {

using namespace test;

TEST(Ekf, FirstSampleSetsWhatItMeasures) {
  Rig rig({sensor("imu", SensorKind::imu, {Yaw})});
  EXPECT_FALSE(estimate(rig.spec, rig.state, Time::from_s(1)).known);
  EXPECT_EQ(rig.give(0, imu_at(1, {0, 0, 2})), Outcome::used);
  EXPECT_NEAR(rig.x(Yaw), 2, 1e-12);
  EXPECT_EQ(rig.variance(Yaw), 0.01);
  EXPECT_EQ(rig.variance(X), 1);
  EXPECT_TRUE(estimate(rig.spec, rig.state, Time::from_s(1)).known);
  rig.spec.initial_state[Yaw] = 3;
  rig.start();
  rig.give(0, imu_at(1, {0, 0, -3}));
  EXPECT_NEAR(rig.x(Yaw), -3, 1e-12);
}

TEST(Ekf, YawAcrossPi) {
  Rig rig({sensor("imu", SensorKind::imu, {Yaw})});
  rig.spec.process_noise.fill(0);
  rig.give(0, imu_at(1, {0, 0, 3.1}));
  EXPECT_EQ(rig.give(0, imu_at(1 + 1e-9, {0, 0, -3.1})), Outcome::used);
  // Two equal variances: half way between, over pi. The rate is unsure by 1 rad/s, for a nanosecond.
  EXPECT_NEAR(std::abs(rig.x(Yaw)), math::pi, 1e-8);
  EXPECT_NEAR(rig.variance(Yaw), 0.005, 1e-8);
  rig.give(0, imu_at(1 + 2e-9, {0, 0, -3.0}));
  // y = -3 + pi from half way, gain 1/3.
  EXPECT_NEAR(rig.x(Yaw), -math::pi + (math::pi - 3) / 3, 1e-8);
}

TEST(Ekf, PredictsAheadWithoutChange) {
  Rig rig({sensor("twist", SensorKind::twist, {Vx, Vyaw})});
  rig.spec.initial_state[Ax] = 2;
  rig.start();
  rig.give(0, twist_at(1, {3, 0, 0}, {0, 0, 0.5}));
  const State before = rig.state;
  const Estimate ahead = estimate(rig.spec, rig.state, Time::from_s(1.5));
  EXPECT_EQ(ahead.at, Time::from_s(1.5));
  EXPECT_NEAR(ahead.x[X], 3 * 0.5 + 2 * 0.125, 1e-12);
  EXPECT_NEAR(ahead.x[Vx], 4, 1e-12);
  EXPECT_NEAR(ahead.x[Yaw], 0.25, 1e-12);
  EXPECT_NEAR(ahead.P.at(Yaw, Yaw), 1 + 0.25 * 0.01 + 0.06 * 0.5, 1e-12);
  EXPECT_EQ(rig.state.core.x, before.core.x);
  EXPECT_EQ(estimate(rig.spec, rig.state, Time::from_s(0.5)).at, Time::from_s(1));
  EXPECT_NEAR(estimate(rig.spec, rig.state, Time::from_s(9)).x[Yaw], 4 - 2 * math::pi, 1e-12);
}

struct Arrival {
  double at_s = 0;
  std::size_t index = 0;
  msg::Odometry odometry;
  msg::Imu imu;
  msg::PoseWithCovarianceStamped pose;
  Time stamp() const {
    return index == 2 ? imu.header.stamp : index < 2 ? odometry.header.stamp : pose.header.stamp;
  }
};

// Messages of a differential odometry, a plain one, an imu and a relative pose, 8 s: in order, and with delays of up to 0.3 s, drawn
// for each. Stamps of different sensors may be equal.
TEST(Ekf, OrderOfArrivalDoesNotMatter) {
  std::vector<Sensor> sensors = {
      sensor("vo", SensorKind::odometry, {X, Y, Yaw}), sensor("wheels", SensorKind::odometry, {Vx, Vy, Vyaw}),
      sensor("imu", SensorKind::imu, {Yaw, Vyaw, Ax}), sensor("pose", SensorKind::pose, {X, Y, Yaw})};
  sensors[0].differential = true;
  sensors[3].relative = true;
  sensors[3].pose_rejection_threshold = 3;
  Stream random(5, 5, Purpose::experiment, 0);
  std::vector<Arrival> arrivals;
  for (int step = 1; step < 400; ++step) {
    const double t = 0.02 * step;
    for (std::size_t index = 0; index < 4; ++index) {
      if (random.below(3)) continue;
      Arrival a;
      a.index = index;
      a.at_s = t;
      const auto noisy = [&](double x) { return x + 0.05 * random.normal(); };
      const double yaw = 0.8 * t;
      const Vec3 p{noisy(2 * math::sin(yaw)), noisy(2 - 2 * math::cos(yaw)), 0}, v{noisy(1.6), noisy(0), 0};
      a.pose = pose_at(t, p, {0, 0, noisy(yaw)});
      if (index == 3 && random.below(6) == 0) a.pose.pose.pose.p.x += 100;
      a.odometry = {a.pose.header, "", a.pose.pose, twist_at(t, v, {0, 0, noisy(0.8)}).twist};
      a.imu = imu_at(t, {0, 0, noisy(yaw)}, {0, 0, noisy(0.8)}, {noisy(0), 0, 0});
      arrivals.push_back(a);
    }
  }
  const auto give = [&](Rig& rig, const Arrival& a) {
    const Outcome outcome = a.index == 2   ? add(rig.spec, rig.state, 2, a.imu)
                            : a.index == 3 ? add(rig.spec, rig.state, 3, a.pose)
                                           : add(rig.spec, rig.state, a.index, a.odometry);
    EXPECT_EQ(outcome, Outcome::queued);
  };
  Rig ordered(sensors), delayed(sensors);
  for (const Arrival& a : arrivals) {
    give(ordered, a);
    ordered.to(a.stamp());
  }
  EXPECT_LE(ordered.state.rewinds, 200u);  // equal stamps, added one by one
  std::vector<Arrival> late = arrivals;
  for (Arrival& a : late) a.at_s += random.below(2) ? random.uniform(0, 0.3) : 0;
  std::stable_sort(late.begin(), late.end(),
                   [](const Arrival& a, const Arrival& b) { return a.at_s < b.at_s; });
  for (const Arrival& a : late) {
    give(delayed, a);
    delayed.to(Time::from_s(a.at_s));
  }
  EXPECT_GT(delayed.state.rewinds, 150u);
  EXPECT_EQ(ordered.state.core.at, delayed.state.core.at);
  for (std::size_t i = 0; i < states; ++i) {
    EXPECT_NEAR(ordered.state.core.x[i], delayed.state.core.x[i], 1e-12);
    for (std::size_t j = 0; j < states; ++j)
      EXPECT_NEAR(ordered.state.core.P.at(i, j), delayed.state.core.P.at(i, j), 1e-12);
  }
  EXPECT_EQ(ordered.state.core.x, delayed.state.core.x);  // and to the bit
  EXPECT_EQ(ordered.state.core.extra.x, delayed.state.core.extra.x);
  EXPECT_EQ(ordered.state.core.extra.covariance, delayed.state.core.extra.covariance);
  std::size_t gated = 0;
  for (std::size_t s = 0; s < 4; ++s) {
    std::uint64_t a = 0, b = 0;
    for (std::size_t o = 1; o < outcomes; ++o)
      a += ordered.state.sensors[s].counts[o], b += delayed.state.sensors[s].counts[o];
    EXPECT_EQ(a, b);  // each sample is counted once
    EXPECT_EQ(a, delayed.state.sensors[s].count(Outcome::queued));
    EXPECT_EQ(delayed.state.sensors[s].count(Outcome::late), 0u);
    gated += ordered.state.sensors[s].count(Outcome::gated);
  }
  EXPECT_GT(gated, 10u);
}

TEST(Ekf, TooLateIsLateAndChangesNothing) {
  Rig rig({sensor("twist", SensorKind::twist, {Vx}), sensor("pose", SensorKind::pose, {X})});
  rig.spec.history_s = 0.2;
  for (int i = 1; i <= 50; ++i) rig.give(0, twist_at(0.1 * i, {1, 0, 0}));
  const Vector before = rig.state.core.x;
  EXPECT_EQ(rig.give(1, pose_at(4.79, {3, 0, 0})), Outcome::late);
  EXPECT_EQ(rig.reports.size(), 1u);
  EXPECT_EQ(rig.state.core.x, before);
  EXPECT_EQ(rig.state.sensors[1].count(Outcome::late), 1u);
  EXPECT_EQ(rig.give(1, pose_at(4.81, {3, 0, 0})), Outcome::used);
  EXPECT_NE(rig.state.core.x, before);
  EXPECT_EQ(rig.state.core.at, Time::from_s(5));
  // Without a history only what is not older than the newest counts.
  rig.spec.history_s = 0;
  rig.start();
  rig.give(0, twist_at(1, {1, 0, 0}));
  rig.give(0, twist_at(2, {1, 0, 0}));
  EXPECT_EQ(rig.give(1, pose_at(1.999, {3, 0, 0})), Outcome::late);
  EXPECT_EQ(rig.give(1, pose_at(2, {3, 0, 0})), Outcome::used);
  EXPECT_EQ(rig.give(0, twist_at(3, {1, 0, 0})), Outcome::used);
}

TEST(Ekf, DuplicateReversedAndEarlyStamps) {
  Rig rig({sensor("twist", SensorKind::twist, {Vx})});
  rig.give(0, twist_at(1, {1, 0, 0}));
  rig.give(0, twist_at(1.1, {1, 0, 0}));
  EXPECT_EQ(rig.give(0, twist_at(1.1, {9, 0, 0})), Outcome::duplicate);
  EXPECT_EQ(rig.give(0, twist_at(1.0, {9, 0, 0})), Outcome::duplicate);
  EXPECT_EQ(rig.give(0, twist_at(1.05, {1, 0, 0})), Outcome::used);  // reversed
  EXPECT_EQ(rig.state.rewinds, 1u);
  EXPECT_NEAR(rig.x(Vx), 1, 1e-12);
  // Ahead of the clock: by less than `future` it waits, also as a duplicate; by more it is dropped.
  EXPECT_EQ(add(rig.spec, rig.state, 0, twist_at(1.4, {5, 0, 0})), Outcome::queued);
  EXPECT_EQ(add(rig.spec, rig.state, 0, twist_at(1.4, {5, 0, 0})), Outcome::duplicate);
  EXPECT_EQ(add(rig.spec, rig.state, 0, twist_at(100, {5, 0, 0})), Outcome::queued);
  rig.to(Time::from_s(1.2));
  ASSERT_EQ(rig.reports.size(), 1u);
  EXPECT_EQ(rig.reports[0].outcome, Outcome::early);
  EXPECT_NEAR(rig.x(Vx), 1, 1e-12);
  EXPECT_EQ(rig.state.core.at, Time::from_s(1.1));
  rig.to(Time::from_s(1.4));
  ASSERT_EQ(rig.reports.size(), 1u);
  EXPECT_EQ(rig.reports[0].outcome, Outcome::used);
  EXPECT_GT(rig.x(Vx), 1.5);
  for (const std::int64_t ns :
       {std::int64_t{-1}, INT64_MIN, INT64_MAX, std::int64_t{4'000'000'000'000'000'001}}) {
    msg::TwistWithCovarianceStamped bad = twist_at(0, {1, 0, 0});
    bad.header.stamp.ns = ns;
    EXPECT_EQ(add(rig.spec, rig.state, 0, bad), Outcome::bad_stamp);
  }
  rig.to(Time{INT64_MAX});
  rig.to(Time{INT64_MIN});
}

TEST(Ekf, QueueIsBounded) {
  std::vector<Sensor> sensors = {sensor("odom", SensorKind::odometry, {X, Vx}),
                                 sensor("t", SensorKind::twist, {Vx})};
  sensors[0].queue_size = 3;
  Rig rig(sensors);
  for (int i = 1; i <= 5; ++i) {
    const double t = 0.01 * i;
    const msg::Odometry message{{Time::from_s(t), ""}, "", pose_at(t, {}).pose, twist_at(t, {}).twist};
    EXPECT_EQ(add(rig.spec, rig.state, 0, message), i <= 3 ? Outcome::queued : Outcome::full);
    EXPECT_EQ(add(rig.spec, rig.state, 1, twist_at(t, {})), Outcome::queued);
  }
  rig.to(Time{});  // sorts the queue, nothing is due
  EXPECT_EQ(add(rig.spec, rig.state, 0,
                msg::Odometry{{Time::from_s(1), ""}, "", pose_at(1, {}).pose, twist_at(1, {}).twist}),
            Outcome::full);
  rig.to(Time::from_s(1));
  EXPECT_EQ(rig.reports.size(), 11u);
  EXPECT_TRUE(rig.state.queue.empty());
}

TEST(Ekf, HistoryIsBounded) {
  Rig rig({sensor("imu", SensorKind::imu, {Yaw, Vyaw, Ax}), sensor("twist", SensorKind::twist, {Vx})});
  std::size_t samples = 0, checkpoints = 0;
  for (int i = 1; i <= 5000; ++i) {
    rig.give(0, imu_at(0.001 * i, {}));
    if (i % 20 == 0) rig.give(1, twist_at(0.001 * i, {}));
    samples = std::max(samples, rig.state.history.size());
    checkpoints = std::max(checkpoints, rig.state.checkpoints.size());
  }
  // 0.5 s and an eighth more of 3050 samples a second.
  EXPECT_LE(samples, 1920u);
  EXPECT_GE(samples, 1525u);
  EXPECT_LE(checkpoints, 10u);
  rig.spec.history_s = 60;
  rig.start();
  for (int i = 1; i <= 9000; ++i) rig.give(0, imu_at(0.001 * i, {}));
  EXPECT_LE(rig.state.history.size(), 4096u + 1024u);
  EXPECT_EQ(rig.give(1, twist_at(0.001, {})), Outcome::late);
  EXPECT_EQ(rig.give(1, twist_at(8.0005, {})), Outcome::used);
}

TEST(Ekf, GpsJumpIsGated) {
  const Datum datum{.latitude_rad = 0.8, .longitude_rad = 0.15, .altitude_m = 300};
  std::vector<Sensor> sensors = {sensor("gps", SensorKind::gps, {X, Y, Z})};
  sensors[0].pose_rejection_threshold = 5;
  Rig rig(sensors);
  rig.spec.datum = datum;
  rig.start();
  for (int i = 1; i <= 20; ++i)
    EXPECT_EQ(rig.give(0, fix_at(0.1 * i, datum, {0.1 * i, 0, 0})), Outcome::used);
  const double predicted = estimate(rig.spec, rig.state, Time::from_s(2.3)).x[X];
  for (int i = 21; i <= 23; ++i)
    EXPECT_EQ(rig.give(0, fix_at(0.1 * i, datum, {100 + 0.1 * i, 0, 0})), Outcome::gated);
  EXPECT_EQ(rig.state.sensors[0].gated_in_row, 3u);
  EXPECT_GT(rig.state.sensors[0].squared_distance, 25);
  EXPECT_EQ(rig.state.sensors[0].components, 3u);
  EXPECT_NEAR(rig.x(X), predicted, 1e-9);  // straight ahead, where three steps are as good as one
  EXPECT_EQ(rig.give(0, fix_at(2.4, datum, {2.4, 0, 0})), Outcome::used);
  EXPECT_EQ(rig.state.sensors[0].gated_in_row, 0u);
  EXPECT_NEAR(rig.x(X), 2.4, 0.5);
  // The threshold is a distance, not its square: 4.9 standard deviations of S pass, 5.1 don't.
  Rig exact({sensor("pose", SensorKind::pose, {X})});
  exact.spec.sensors[0].pose_rejection_threshold = 5;
  exact.spec.process_noise.fill(0);
  exact.spec.initial_covariance.fill(0);
  for (const double factor : {4.9, 5.1}) {
    exact.start();
    exact.give(0, pose_at(1, {}, {}, 0.03));
    EXPECT_EQ(exact.give(0, pose_at(2, {factor * std::sqrt(0.03 + 0.01), 0, 0}, {}, 0.01)),
              factor < 5 ? Outcome::used : Outcome::gated);
  }
}

TEST(Ekf, GatesOfTheirOwnForPartsOfAMessage) {
  Rig rig({sensor("odom", SensorKind::odometry, {X, Vx}), sensor("imu", SensorKind::imu, {Ax})});
  rig.spec.sensors[0].twist_rejection_threshold = 3;
  rig.spec.sensors[1].acceleration_rejection_threshold = 3;
  const auto odometry = [](double t, double x, double v) {
    return msg::Odometry{{Time::from_s(t), ""}, "", pose_at(t, {x, 0, 0}).pose, twist_at(t, {v, 0, 0}).twist};
  };
  rig.give(0, odometry(1, 0, 0));
  EXPECT_EQ(rig.give(0, odometry(1.1, 0, 50)), Outcome::gated);  // its last part
  ASSERT_EQ(rig.reports.size(), 2u);
  EXPECT_EQ(rig.reports[0].outcome, Outcome::used);
  EXPECT_EQ(rig.give(1, imu_at(1.2, {}, {}, {50, 0, 0})), Outcome::gated);
  EXPECT_EQ(rig.give(1, imu_at(1.3, {}, {}, {0.5, 0, 0})), Outcome::used);
}

TEST(Ekf, PlaneStaysAPlane) {
  Rig rig({sensor("imu", SensorKind::imu, {Roll, Pitch, Yaw, Vroll, Vpitch, Vyaw, Ax, Ay, Az}),
           sensor("pose", SensorKind::pose, {X, Y, Z, Roll, Pitch, Yaw})});
  rig.spec.two_d_mode = true;
  rig.spec.initial_state[Z] = 3;
  rig.start();
  Stream random(1, 1, Purpose::experiment, 0);
  for (int i = 1; i <= 200; ++i) {
    const auto r = [&] { return random.uniform(-0.4, 0.4); };
    EXPECT_EQ(rig.give(0, imu_at(0.01 * i, {r(), r(), r()}, {r(), r(), r()}, {r(), r(), r()})),
              Outcome::used);
    EXPECT_EQ(rig.give(1, pose_at(0.01 * i + 0.005, {r(), r(), r()}, {r(), r(), r()})), Outcome::used);
  }
  for (const Index i : {Z, Roll, Pitch, Vz, Vroll, Vpitch, Az}) {
    EXPECT_EQ(rig.x(i), 0);
    for (std::size_t j = 0; j < states; ++j) EXPECT_EQ(rig.state.core.P.at(i, j), 0);
  }
  for (const Index i : {X, Y, Yaw, Vx, Vy, Vyaw, Ax, Ay}) {
    EXPECT_NE(rig.x(i), 0);
    EXPECT_GT(rig.variance(i), 0);
  }
  const Estimate later = estimate(rig.spec, rig.state, Time::from_s(10));
  EXPECT_EQ(later.x[Z], 0);
  EXPECT_EQ(later.P.at(Z, Z), 0);
}

TEST(Ekf, RefusedMessagesAreCountedAndChangeNothing) {
  Rig rig({sensor("twist", SensorKind::twist, {Vx})});
  rig.give(0, twist_at(1, {1, 0, 0}));
  const State before = rig.state;
  msg::TwistWithCovarianceStamped bad = twist_at(1.1, {NAN, 0, 0});
  EXPECT_EQ(rig.give(0, bad), Outcome::bad_value);
  bad = twist_at(1.1, {1, 0, 0});
  bad.twist.covariance[0] = -1;
  EXPECT_EQ(rig.give(0, bad), Outcome::bad_covariance);
  rig.to(Time::from_s(2));
  EXPECT_EQ(rig.state.core.x, before.core.x);
  EXPECT_EQ(rig.state.core.P, before.core.P);
  EXPECT_EQ(rig.state.sensors[0].count(Outcome::bad_value), 1u);
  EXPECT_EQ(rig.state.sensors[0].count(Outcome::bad_covariance), 1u);
  // Its stamp may come again, in order.
  EXPECT_EQ(rig.give(0, twist_at(1.1, {1, 0, 0})), Outcome::used);
}

TEST(Ekf, ExtremesStayFinite) {
  Rig rig({sensor("odom", SensorKind::odometry, {X, Y, Z, Roll, Pitch, Yaw, Vx, Vy, Vz, Vroll, Vpitch, Vyaw}),
           sensor("imu", SensorKind::imu, {Ax, Ay, Az})});
  Stream random(9, 1, Purpose::experiment, 0);
  std::int64_t ns = 0;
  for (int i = 0; i < 3000; ++i) {
    ns += std::int64_t{1} << random.below(49);
    const auto r = [&] { return (random.below(2) ? 1 : -1) * math::pow(10, random.uniform(-9, 9)); };
    const auto v = [&] { return math::pow(10, random.uniform(-17, 17)); };
    const Vec3 rpy{r(), math::pi / 2 * static_cast<double>(random.below(3)), r()};
    const Time at = Time::from_ns(ns);
    if (random.below(3) == 0) {
      rig.give(1, msg::Imu{{at, ""},
                           {},
                           diagonal3(v()),
                           {r(), r(), r()},
                           diagonal3(v()),
                           {r(), r(), r()},
                           diagonal3(v())});
    } else {
      msg::Odometry odometry{{at, ""}, "", pose_at(0, {r(), r(), r()}, rpy, v(), v()).pose, {}};
      odometry.twist.twist = {{r(), r(), r()}, {r(), r(), r()}};
      odometry.twist.covariance = diagonal6(v(), v());
      rig.give(0, odometry);
    }
    const Estimate e = estimate(rig.spec, rig.state, at + Time::from_s(1000));
    for (const double each : e.x) ASSERT_TRUE(std::isfinite(each)) << i;
    for (const double each : e.P.padded) ASSERT_TRUE(std::isfinite(each)) << i;
  }
  const auto count = [&](Outcome o) { return rig.state.sensors[0].count(o) + rig.state.sensors[1].count(o); };
  EXPECT_GT(count(Outcome::used), 1000u);
  EXPECT_GT(count(Outcome::diverged), 10u);
}

TEST(Ekf, SilenceOfYears) {
  Rig rig({sensor("pose", SensorKind::pose, {X})});
  rig.spec.initial_covariance.fill(1e6);
  rig.start();
  rig.give(0, pose_at(1, {}));
  // After 1e8 s the variance of x is 1e6 (1e16 / 2)^2 = 2.5e37: nothing is left to correct.
  EXPECT_EQ(rig.give(0, pose_at(1e8, {5, 0, 0})), Outcome::diverged);
  EXPECT_FALSE(rig.state.core.known);
  EXPECT_EQ(rig.give(0, pose_at(1e8 + 1, {5, 0, 0})), Outcome::used);
  EXPECT_EQ(rig.x(X), 5);
  EXPECT_EQ(rig.variance(X), 0.01);
}

TEST(Ekf, ClockThatJumpsBack) {
  for (const bool reset : {false, true}) {
    Rig rig({sensor("twist", SensorKind::twist, {Vx})});
    rig.spec.reset_on_time_jump = reset;
    for (int i = 0; i < 20; ++i) rig.give(0, twist_at(100 + 0.1 * i, {1, 0, 0}));
    EXPECT_EQ(add(rig.spec, rig.state, 0, twist_at(102, {1, 0, 0})), Outcome::queued);
    EXPECT_EQ(add(rig.spec, rig.state, 0, twist_at(1, {2, 0, 0})), Outcome::queued);
    advance(rig.spec, rig.state, Time::from_s(1));
    EXPECT_EQ(rig.state.sensors[0].count(Outcome::late), reset ? 0u : 1u);
    EXPECT_EQ(rig.state.sensors[0].count(Outcome::early), 1u);
    EXPECT_EQ(rig.state.resets, reset ? 1u : 0u);
    EXPECT_EQ(rig.state.core.at, Time::from_s(reset ? 1 : 101.9));
    EXPECT_NEAR(rig.x(Vx), reset ? 2 : 1, 1e-9);
    if (reset) {
      EXPECT_TRUE(rig.state.queue.empty());
      EXPECT_EQ(rig.state.sensors[0].newest, Time::from_s(1));
      EXPECT_EQ(rig.give(0, twist_at(1.1, {2, 0, 0})), Outcome::used);
      EXPECT_EQ(rig.give(0, twist_at(101.9, {2, 0, 0})), Outcome::used);  // once more
      EXPECT_EQ(rig.give(0, twist_at(102, {2, 0, 0})), Outcome::used);    // which was early before
    }
  }
  // A jump within the history is lateness.
  Rig rig({sensor("twist", SensorKind::twist, {Vx})});
  rig.spec.reset_on_time_jump = true;
  rig.give(0, twist_at(10, {1, 0, 0}));
  advance(rig.spec, rig.state, Time::from_s(9.6));
  EXPECT_EQ(rig.state.resets, 0u);
}

TEST(Ekf, SnapshotGoesOnTheSame) {
  std::vector<Sensor> sensors = {sensor("vo", SensorKind::pose, {X, Y, Yaw}),
                                 sensor("imu", SensorKind::imu, {Yaw, Vyaw}),
                                 sensor("gps", SensorKind::gps, {X, Y})};
  sensors[0].differential = true;
  Rig rig(sensors);
  const Datum datum{.latitude_rad = 0.8, .longitude_rad = 0.15, .altitude_m = 300};
  const auto step = [&](Rig& on, int i) {
    const double t = 0.05 * i;
    add(on.spec, on.state, 0, pose_at(t - (i % 3) * 0.02, {t, 0.1 * t, 0}, {0, 0, 0.1 * t}));
    add(on.spec, on.state, 1, imu_at(t, {0, 0, 0.1 * t}, {0, 0, 0.1}));
    if (i % 4 == 0) add(on.spec, on.state, 2, fix_at(t - 0.1, datum, {t, 0, 0}));
    on.to(Time::from_s(t - 0.01));
  };
  for (int i = 3; i < 100; ++i) step(rig, i);
  ByteWriter w;
  write(w, rig.state);
  Rig copy(sensors);
  ByteReader r(w.bytes());
  read(r, copy.state);
  ASSERT_TRUE(r.ok());
  EXPECT_EQ(r.remaining(), 0u);
  EXPECT_TRUE(copy.state.fits(copy.spec));
  for (int i = 100; i < 150; ++i) step(rig, i), step(copy, i);
  ByteWriter a, b;
  write(a, rig.state), write(b, copy.state);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.bytes().data(), b.bytes().data(), a.size()), 0);
  EXPECT_GT(rig.state.rewinds, 20u);
}

TEST(Ekf, DamagedStatesDoNotFit) {
  Rig rig({sensor("vo", SensorKind::pose, {X, Y, Yaw})});
  EXPECT_TRUE(rig.state.fits(rig.spec));
  for (int i = 1; i < 50; ++i) rig.give(0, pose_at(0.1 * i, {}));
  EXPECT_TRUE(rig.state.fits(rig.spec));
  const auto broken = [&](auto&& change) {
    State state = rig.state;
    change(state);
    return !state.fits(rig.spec);
  };
  EXPECT_TRUE(broken([](State& s) { s.sensors.clear(); }));
  EXPECT_TRUE(broken([](State& s) { s.core.x[3] = NAN; }));
  EXPECT_TRUE(broken([](State& s) { s.checkpoints[1].P.at(2, 2) = INFINITY; }));
  EXPECT_TRUE(broken([](State& s) { s.checkpoints[1].memories.clear(); }));
  EXPECT_TRUE(broken([](State& s) { s.history[1].sensor = 7; }));
  EXPECT_TRUE(broken([](State& s) { std::swap(s.history[0], s.history[1]); }));
  EXPECT_TRUE(broken([](State& s) { std::swap(s.checkpoints[0], s.checkpoints[1]); }));
  EXPECT_TRUE(broken([](State& s) { s.core.at = Time{INT64_MAX}; }));
  EXPECT_TRUE(broken([](State& s) { s.checkpoints.clear(); }));
  rig.spec.sensors[0].differential = true;  // a filter with an earlier pose has more numbers
  EXPECT_FALSE(rig.state.fits(rig.spec));
  rig.start();
  for (int i = 1; i < 50; ++i) rig.give(0, pose_at(0.1 * i, {}));
  EXPECT_TRUE(rig.state.fits(rig.spec));
  EXPECT_TRUE(broken([](State& s) { s.core.extra.x.pop_back(); }));
  EXPECT_TRUE(broken([](State& s) { s.core.extra.covariance.pop_back(); }));
  EXPECT_TRUE(broken([](State& s) { s.checkpoints[1].extra.x[2] = NAN; }));
  EXPECT_TRUE(broken([](State& s) { s.core.extra.row(0, 1)[ExtraStates::column(0, 1)] = -1; }));
}

TEST(Ekf, MapToOdom) {
  Estimate in_map, in_odom;
  in_map.x[X] = 5, in_map.x[Y] = 1, in_map.x[Yaw] = math::pi / 2;
  in_odom.x[X] = 2;
  // B at (5, 1) looking along map's y is at (2, 0) looking along odom's x: odom begins 2 behind.
  const Pose X = map_to_odom(in_map, in_odom);
  EXPECT_NEAR(X.p.x, 5, 1e-12);
  EXPECT_NEAR(X.p.y, -1, 1e-12);
  EXPECT_NEAR(yaw_of(X.q), math::pi / 2, 1e-12);
  EXPECT_LT(norm((X * in_odom.pose()).p - in_map.pose().p), 1e-12);
}

TEST(Ekf, MessageHasTheBlocksOfTheCovariance) {
  Estimate e;
  e.at = Time::from_s(7);
  e.x[Y] = 2, e.x[Yaw] = 1, e.x[Vx] = 3, e.x[Vyaw] = 4;
  e.P.at(Y, Yaw) = 5, e.P.at(Vx, Vyaw) = 6;
  msg::Odometry out;
  write_message(e, out);
  EXPECT_EQ(out.header.stamp, e.at);
  EXPECT_EQ(out.pose.pose.p.y, 2);
  EXPECT_NEAR(yaw_of(out.pose.pose.q), 1, 1e-12);
  EXPECT_EQ(out.twist.twist.linear.x, 3);
  EXPECT_EQ(out.twist.twist.angular.z, 4);
  EXPECT_EQ(out.pose.covariance[1 * 6 + 5], 5);
  EXPECT_EQ(out.twist.covariance[0 * 6 + 5], 6);
}

TEST(Ekf, SpecsThatAreRefused) {
  const auto error = [](auto&& change) {
    Spec spec;
    spec.sensors = {sensor("a", SensorKind::twist, {Vx}), sensor("b", SensorKind::imu, {Az})};
    change(spec);
    const auto result = begin(spec);
    return result ? std::string() : result.error().what;
  };
  EXPECT_EQ(error([](Spec&) {}), "");
  EXPECT_NE(error([](Spec& s) { s.sensors[1].name = "a"; }), "");
  EXPECT_NE(error([](Spec& s) { s.two_d_mode = true; }), "");  // az alone
  EXPECT_NE(error([](Spec& s) { s.process_noise[4] = NAN; }), "");
  EXPECT_NE(error([](Spec& s) { s.initial_covariance[4] = -1; }), "");
  EXPECT_NE(error([](Spec& s) { s.history_s = INFINITY; }), "");
  EXPECT_NE(error([](Spec& s) { s.sensors[0].config = {}; }), "");
  EXPECT_NE(error([](Spec& s) { s.sensors.resize(33, s.sensors[0]); }), "");
}

TEST(Ekf, SpecFromAFile) {
  const auto list = [](std::initializer_list<const char*> items) {
    Node out = Node::sequence();
    for (const char* item : items) out.push(Node::scalar(item));
    return out;
  };
  Node given = Node::map(), wheels = Node::map();
  wheels.set("name", Node::scalar("odom0"));
  wheels.set("kind", Node::scalar("odometry"));
  const char *const no = "false", *const yes = "true";
  wheels.set("config", list({no, no, no, no, no, no, yes, yes, no, no, no, yes, no, no, no}));
  Node sensors = Node::sequence();
  sensors.push(wheels);
  given.set("two_d_mode", Node::scalar("true"));
  given.set("sensors", sensors);
  const Result<Spec> spec = read_spec<Spec>(given);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_TRUE(spec->two_d_mode);
  EXPECT_TRUE(spec->sensors[0].config[Vyaw]);
  EXPECT_FALSE(spec->sensors[0].config[X]);
  given.find("sensors")->items()[0].set("kind", Node::scalar("gps"));
  const Result<Spec> wrong = read_spec<Spec>(given);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().path, "/sensors/0/config");
  given.find("sensors")->items()[0].set("kind", Node::scalar("odometry"));
  given.find("sensors")->items()[0].set("config", list({yes, yes}));
  EXPECT_FALSE(read_spec<Spec>(given));
}

TEST(Ekf, FindsSensorsByName) {
  const Rig rig({sensor("a", SensorKind::twist, {Vx}), sensor("b", SensorKind::imu, {Az})});
  EXPECT_EQ(find_sensor(rig.spec, "b"), std::size_t{1});
  EXPECT_FALSE(find_sensor(rig.spec, "c"));
}

}  // namespace
}  // namespace sandlot::navigation::ekf
