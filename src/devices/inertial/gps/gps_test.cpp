#include "devices/inertial/gps/gps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/test_rig.h"

namespace sandlot::gps {
namespace {

using test::config;
using test::Rig;

constexpr double deg = math::pi / 180;

struct Bench : Rig {
  Bench(Node node, std::uint32_t level_bits, double heading = 0) : Rig(kind, test::two_wheels()) {
    geography = model::Geography{48 * deg, 9 * deg, 500, heading};
    const Status added = add("gps", std::move(node), level_bits, 0, {{0, 0, 2}, {}});
    EXPECT_TRUE(added) << (added ? "" : added.error().text());
  }
  msg::NavSatFix fix() {
    sense();
    return topic<msg::NavSatFix>("gps/fix").message;
  }
};

TEST(Gps, ShowsWhereTheAntennaIs) {
  // The world's x axis points north (90 deg from east): 1000 m along it are 1000 / (M + h) rad of latitude.
  Bench bench(config({}), 3, math::pi / 2);
  msg::NavSatFix at = bench.fix();
  EXPECT_NEAR(at.latitude, 48, 1e-13 * 180);
  EXPECT_NEAR(at.longitude, 9, 1e-13 * 180);
  EXPECT_NEAR(at.altitude, 502, 1e-8);
  bench.engine->body[0].X_WB.p = {1000, 0, 0};
  bench.engine->body[0].V_WB = {{3, 0, 1}, {0, 2, 0}};
  at = bench.fix();
  const double s = math::sin(48 * deg), e2 = geodesy::flattening * (2 - geodesy::flattening),
               w = 1 - e2 * s * s;
  const double m = geodesy::semi_major_m * (1 - e2) / (w * std::sqrt(w));
  EXPECT_NEAR((at.latitude - 48) * deg, 1000 / (m + 502),
              1e-3 / m);  // M itself grows by 1.6e-6 on the way: 0.8 mm
  EXPECT_NEAR(at.longitude, 9, 1e-11);
  EXPECT_NEAR(at.altitude, 502 + 1000 * 1000 / (2 * m), 1e-4);
  // Velocity: the antenna 2 m up moves by w x r = (4, 0, 0) more; world x is north.
  const Vec3 v = bench.topic<msg::TwistStamped>("gps/velocity").message.twist.linear;
  EXPECT_NEAR(v.x, 0, 1e-14);
  EXPECT_NEAR(v.y, 7, 1e-14);
  EXPECT_NEAR(v.z, 1, 1e-14);
}

TEST(Gps, ErrorsHaveTheirSizeAndTheirCorrelation) {
  Node node = config({{"rate", "1"}});
  const auto drift = [](const char* std) {
    Node bias = config({{"bias_std", std}, {"correlation", "20"}}), keys = config({});
    keys.set("bias", bias);
    return keys;
  };
  node.set("horizontal", drift("2"));
  node.set("vertical", drift("3"));
  Bench bench(node, 1);
  bench.since[0] = Time::from_s(1);
  const msg::NavSatFix first = bench.fix();
  EXPECT_EQ(first.position_covariance[0], 4);
  EXPECT_EQ(first.position_covariance[4], 4);
  EXPECT_EQ(first.position_covariance[8], 9);
  ASSERT_TRUE(bench.pool->set_parameter(0, "errors", Node::scalar("0.5")));
  EXPECT_EQ(bench.fix().position_covariance[8], 9 * 0.25) << "errors are tunable: half as large from now on";
  ASSERT_TRUE(bench.pool->set_parameter(0, "errors", Node::scalar("1")));
  const double metre = 1 / (geodesy::semi_major_m * deg);
  constexpr int n = 40000;
  double up2 = 0, north2 = 0, up_lag = 0, before = 0, cross = 0;
  for (int i = 0; i < n; ++i) {
    const msg::NavSatFix at = bench.fix();
    const double up = at.altitude - 502, north = (at.latitude - 48) / metre;
    up2 += up * up;
    north2 += north * north;
    up_lag += up * before;
    cross += up * north;
    before = up;
  }
  // Squares decorrelate in tau / 2 = 10 samples: n / 20 independent ones, so 3.2 % of the variance; five of
  // them.
  EXPECT_NEAR(up2 / n, 9, 9 * 5 * 0.032);
  EXPECT_NEAR(north2 / n, 4, 4 * 5 * 0.032);
  EXPECT_NEAR(up_lag / up2, math::exp(-1.0 / 20), 5 * std::sqrt((1 - 0.905) / n) + 0.01);
  EXPECT_NEAR(cross / n, 0, 6 * 5 * 0.032);
}

TEST(Gps, TheCovarianceCountsTheConstantThatWasDrawn) {
  Node node = config({{"rate", "1"}});
  node.set("horizontal", config({{"white", "1.5"}, {"mean_std", "2"}}));
  node.set("vertical", config({{"white", "3"}, {"mean_std", "4"}}));
  Bench bench(node, 1);
  bench.since[0] = Time::from_s(1);
  const msg::NavSatFix at = bench.fix();
  EXPECT_EQ(at.position_covariance[0], 1.5 * 1.5 + 2 * 2);
  EXPECT_EQ(at.position_covariance[4], 1.5 * 1.5 + 2 * 2);
  EXPECT_EQ(at.position_covariance[8], 3 * 3 + 4 * 4);
}

TEST(Gps, NeedsAPlaceOnTheEarth) {
  Rig rig(kind, test::two_wheels());
  const Status status = rig.add("gps", config({}));
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().text().find("spherical_coordinates"), std::string::npos);
  EXPECT_EQ(status.error().place.line, 12);
}

}  // namespace
}  // namespace sandlot::gps
