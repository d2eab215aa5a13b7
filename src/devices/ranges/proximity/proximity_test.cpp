#include "devices/ranges/proximity/proximity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "devices/test_rig.h"

namespace sandlot::proximity {
namespace {

using test::config;
using test::Rig;

constexpr float inf = std::numeric_limits<float>::infinity();
// Distances are floats of some 0.2 m; readings divide their error by a range of 0.1 m.
constexpr double float_m = 3e-8, float_reading = 4e-7;

/// The plane x = 0.15 m, met by rays that reach it.
class Wall final : public RayCaster {
 public:
  void cast(std::span<const RayJob> jobs) const override {
    for (const RayJob& job : jobs) {
      ignored = job.ignore_body;
      for (std::size_t i = 0; i < job.directions.size(); ++i) {
        const Vec3 d = rotate(job.X_WS.q, job.directions[i]);
        const double t = d.x > 1e-9 ? (0.15 - job.X_WS.p.x) / d.x : HUGE_VAL;
        job.distance_m[i] = t >= job.min_m && t <= job.max_m ? static_cast<float>(t) : inf;
      }
    }
  }
  mutable std::uint32_t ignored = 0;
};

model::Model disc() {
  model::Model model;
  model.name = "robot";
  model.links.resize(1);
  model.links[0].name = "base";
  return model;
}

const msg::LaserScan& scan(Rig& rig, const Wall& wall) {
  rig.rays = &wall;
  rig.sense();
  return rig.topic<msg::LaserScan>("ring/proximity").message;
}

TEST(Proximity, ReadingsAndDistancesFollowFromTheGeometry) {
  Rig rig(kind, disc(), 0.1);
  const Wall wall;
  ASSERT_TRUE(rig.add("ring", config({{"sensors", "8"}, {"radius", "0.08"}, {"range", "0.1"}})));
  const msg::LaserScan& message = scan(rig, wall);
  // Straight ahead: 0.15 m from the middle, 0.07 m from the sensor. At 45 degrees 0.15 sqrt(2) = 0.2121 m is
  // out of the reach of 0.18 m; behind there is nothing.
  ASSERT_EQ(message.ranges.size(), 8u);
  EXPECT_NEAR(message.ranges[0], 0.15, float_m);
  EXPECT_NEAR(message.intensities[0], 1 - 0.07 / 0.1, float_reading);
  for (std::size_t i = 1; i < 8; ++i) {
    EXPECT_EQ(message.ranges[i], inf) << i;
    EXPECT_EQ(message.intensities[i], 0) << i;
  }
  EXPECT_EQ(wall.ignored, 0u) << "the link that carries the ring is not seen";
  EXPECT_NEAR(message.angle_increment, math::pi / 4, 1e-7);
  EXPECT_NEAR(message.range_min, 0.08, float_m);
  EXPECT_NEAR(message.range_max, 0.18, float_m);
}

TEST(Proximity, SensorsStandWhereFirstAngleAndSpacingSay) {
  Rig rig(kind, disc(), 0.1);
  const Wall wall;
  ASSERT_TRUE(rig.add("ring", config({{"sensors", "3"},
                                      {"radius", "0.1"},
                                      {"range", "0.2"},
                                      {"first_angle", "-60 deg"},
                                      {"spacing", "60 deg"}})));
  const msg::LaserScan& message = scan(rig, wall);
  // 0.15 / cos(60 deg) = 0.3 m: just the reach; 0.15 m ahead.
  EXPECT_NEAR(message.ranges[1], 0.15, float_m);
  EXPECT_NEAR(message.intensities[1], 0.75, float_reading);
  // A step to the wall, so that the outer ones see it well within their reach: (0.15 - 0.02) / cos(60 deg) =
  // 0.26 m.
  rig.engine->body[0].X_WB.p.x = 0.02;
  const msg::LaserScan& nearer = scan(rig, wall);
  for (const std::size_t i : {0u, 2u}) {
    EXPECT_NEAR(nearer.ranges[i], 0.26, float_m);
    EXPECT_NEAR(nearer.intensities[i], 1 - 0.16 / 0.2, float_reading);
  }
}

TEST(Proximity, ReflectedLightFallsOffWithTheSquare) {
  Spec spec;
  spec.response = Response::inverse_square;
  spec.saturation_m = 0.02;
  EXPECT_EQ(reading(spec, 0.01f), 1);
  EXPECT_NEAR(reading(spec, 0.04f), 0.25, float_reading);
  EXPECT_NEAR(reading(spec, 0.1f), 0.04, float_reading);
  EXPECT_EQ(reading(spec, inf), 0);
}

TEST(Proximity, NoiseMovesDistanceAndReadingTogether) {
  Rig rig(kind, disc(), 0.1);
  const Wall wall;
  Node keys = config({{"sensors", "4"}, {"radius", "0.08"}, {"range", "0.1"}});
  keys.set("noise", config({{"white", "5 mm"}}));
  ASSERT_TRUE(rig.add("ring", std::move(keys)));
  double sum = 0, squares = 0;
  constexpr int samples = 400;
  for (int i = 0; i < samples; ++i) {
    const msg::LaserScan& message = scan(rig, wall);
    const double error = static_cast<double>(message.ranges[0]) - 0.15;
    sum += error, squares += error * error;
    EXPECT_NEAR(message.intensities[0], 1 - (0.07 + error) / 0.1, 1e-6);
    EXPECT_EQ(message.ranges[2], inf) << "noise makes no echo";
  }
  // Mean 0 with deviation 5 mm / 20; variance with a relative deviation of sqrt(2 / 400): five of each.
  EXPECT_NEAR(sum / samples, 0, 5 * 0.005 / 20);
  EXPECT_NEAR(squares / samples, 25e-6, 5 * 25e-6 * std::sqrt(2.0 / samples));
}

TEST(Proximity, ARingThatGoesRoundMoreThanOnceIsRefused) {
  Rig rig(kind, disc(), 0.1);
  const Status status = rig.add("ring", config({{"sensors", "10"}, {"spacing", "60 deg"}}));
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("more than once"), std::string::npos);
  EXPECT_EQ(status.error().path, "/spacing");
}

}  // namespace
}  // namespace sandlot::proximity
