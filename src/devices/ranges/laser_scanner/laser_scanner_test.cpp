#include "devices/ranges/laser_scanner/laser_scanner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>

#include "devices/test_rig.h"

namespace sandlot::laser_scanner {
namespace {

using test::config;
using test::Rig;

constexpr float inf = std::numeric_limits<float>::infinity();
// Distances are floats: relative rounding 6e-8 of a few metres.
constexpr double float_m = 5e-7;

/// A world that is a function of one ray.
class Caster final : public RayCaster {
 public:
  explicit Caster(std::function<double(Vec3 origin_W, Vec3 direction_W)> distance)
      : distance_(std::move(distance)) {}
  void cast(std::span<const RayJob> jobs) const override {
    for (const RayJob& job : jobs) {
      ++jobs_cast;
      largest_batch = std::max(largest_batch.load(), jobs.size());
      last_ignored = job.ignore_body;
      for (std::size_t i = 0; i < job.directions.size(); ++i) {
        const double d = distance_(job.X_WS.p, rotate(job.X_WS.q, job.directions[i]));
        job.distance_m[i] = d >= job.min_m && d <= job.max_m ? static_cast<float>(d) : inf;
      }
    }
  }
  mutable std::atomic<std::size_t> jobs_cast{0}, largest_batch{0};
  mutable std::atomic<std::uint32_t> last_ignored{0};

 private:
  std::function<double(Vec3, Vec3)> distance_;
};

/// The plane x = 2 m.
double wall(Vec3 o, Vec3 d) { return d.x > 1e-12 && o.x < 2 ? (2 - o.x) / d.x : HUGE_VAL; }
/// A ball (or, without z, an upright cylinder) of radius r about (4, 0, 0): the smaller root of |o + t d - c|
/// = r.
double ball(Vec3 o, Vec3 d, double r, bool upright) {
  Vec3 oc = o - Vec3{4, 0, 0};
  if (upright) oc.z = d.z = 0;
  const double a = dot(d, d), b = dot(oc, d), c = dot(oc, oc) - r * r, under = b * b - a * c;
  return under < 0 ? HUGE_VAL : (-b - std::sqrt(under)) / a;
}

const std::vector<float>& scan(Rig& rig, const Caster& caster) {
  rig.rays = &caster;
  rig.sense();
  return rig.topic<msg::LaserScan>("laser/ranges").message.ranges;
}

TEST(LaserScanner, AWallReadsItsDistanceOverTheCosineBeamZeroRightmost) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", config({{"beams", "5"}, {"min_angle", "-90 deg"}, {"max_angle", "90 deg"}}), 1,
                      3, pose_from_rpy({0.5, 0, 0}, {})));
  const auto& r = scan(rig, Caster(wall));
  ASSERT_EQ(r.size(), 5u);
  EXPECT_EQ(r[0], inf);
  EXPECT_NEAR(r[1], 1.5 * std::sqrt(2.0), float_m);
  EXPECT_NEAR(r[2], 1.5, float_m);
  EXPECT_NEAR(r[3], 1.5 * std::sqrt(2.0), float_m);
  EXPECT_EQ(r[4], inf);
  // The link turned left by 45 degrees about its origin: the rightmost but one beam meets the wall squarely,
  // from x = 0.5 cos 45.
  rig.engine->body[3].X_WB.q = quat_from_rpy(0, 0, math::pi / 4);
  const auto& turned = scan(rig, Caster(wall));
  EXPECT_NEAR(turned[1], 2 - 0.5 / std::sqrt(2.0), float_m);
  EXPECT_NEAR(turned[0], (2 - 0.5 / std::sqrt(2.0)) * std::sqrt(2.0), float_m);
  EXPECT_EQ(turned[3], inf);
}

TEST(LaserScanner, RoundThingsByTheirClosedForm) {
  // Beam at angle b towards a circle of radius r at distance D: t = D cos b - sqrt(r^2 - D^2 sin^2 b).
  for (const bool upright : {false, true}) {
    Rig rig(kind, test::two_wheels());
    ASSERT_TRUE(rig.add("laser", config({{"beams", "41"}, {"min_angle", "-0.2"}, {"max_angle", "0.2"}})));
    const auto& r = scan(rig, Caster([&](Vec3 o, Vec3 d) { return ball(o, d, 0.5, upright); }));
    for (int i = 0; i < 41; ++i) {
      const double b = -0.2 + 0.01 * i, side = 4 * math::sin(b), under = 0.25 - side * side;
      if (std::abs(under) < 1e-3) continue;  // grazing
      if (under < 0) EXPECT_EQ(r[static_cast<std::size_t>(i)], inf);
      else EXPECT_NEAR(r[static_cast<std::size_t>(i)], 4 * math::cos(b) - std::sqrt(under), float_m);
    }
  }
}

TEST(LaserScanner, TooNearIsMinusInfinityAndTooFarInfinity) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", config({{"beams", "1"}, {"min_range", "0.5"}, {"max_range", "3"}})));
  const auto at = [&](double distance) { return scan(rig, Caster([=](Vec3, Vec3) { return distance; }))[0]; };
  EXPECT_EQ(at(0.0), -inf);
  EXPECT_EQ(at(0.49), -inf);
  EXPECT_EQ(at(0.5), 0.5f);
  EXPECT_EQ(at(3.0), 3.0f);
  EXPECT_EQ(at(3.01), inf);
  const msg::LaserScan& m = rig.topic<msg::LaserScan>("laser/ranges").message;
  EXPECT_EQ(m.range_min, 0.5f);
  EXPECT_EQ(m.range_max, 3.0f);
}

TEST(LaserScanner, DoesNotSeeItsOwnHousing) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", config({{"beams", "1"}}), 1, 3));
  const Caster caster(wall);
  scan(rig, caster);
  EXPECT_EQ(caster.last_ignored, 3u);
}

TEST(LaserScanner, TheMessageDescribesItsBeams) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(
      rig.add("laser",
              config({{"beams", "91"}, {"min_angle", "-45 deg"}, {"max_angle", "135 deg"}, {"rate", "20"}})));
  rig.now = Time::from_s(3);
  scan(rig, Caster(wall));
  const msg::LaserScan& m = rig.topic<msg::LaserScan>("laser/ranges").message;
  EXPECT_EQ(m.header.frame_id, "robot1/laser");
  EXPECT_EQ(m.header.stamp, Time::from_s(3));
  EXPECT_NEAR(m.angle_min, -math::pi / 4, 1e-7);
  EXPECT_NEAR(m.angle_max, 0.75 * math::pi, 2e-7);
  EXPECT_NEAR(m.angle_increment, math::pi / 90, 1e-8);
  EXPECT_FLOAT_EQ(m.scan_time, 0.05f);
  EXPECT_EQ(m.time_increment, 0);
  EXPECT_EQ(rig.pool->rate_hz(0), 20);
}

TEST(LaserScanner, ASingleBeamPointsToTheMiddle) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", config({{"beams", "1"}, {"min_angle", "0"}, {"max_angle", "60 deg"}})));
  EXPECT_NEAR(scan(rig, Caster(wall))[0], 2 / math::cos(math::pi / 6), float_m);
}

Node with_noise(std::initializer_list<std::pair<const char*, const char*>> noise,
                std::initializer_list<std::pair<const char*, const char*>> bias) {
  Node node = config({{"beams", "1000"}, {"min_range", "0.1"}, {"max_range", "10"}});
  Node errors = config(noise);
  if (bias.size()) errors.set("bias", config(bias));
  node.set("noise", std::move(errors));
  return node;
}

TEST(LaserScanner, WhiteNoiseHasItsStatedSpreadAndIsDrawnAnew) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", with_noise({{"white", "1 cm"}}, {})));
  const Caster flat([](Vec3, Vec3) { return 5.0; });
  double sum = 0, squares = 0, product = 0;
  std::vector<float> before;
  constexpr int scans = 100, n = scans * 1000;
  for (int k = 0; k < scans; ++k) {
    const auto& r = scan(rig, flat);
    for (std::size_t i = 0; i < r.size(); ++i) {
      const double e = r[i] - 5.0;
      sum += e;
      squares += e * e;
      if (!before.empty()) product += e * (before[i] - 5.0);
    }
    before = r;
  }
  EXPECT_NEAR(sum / n, 0, 5 * 0.01 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.01, 5 * 0.01 / std::sqrt(2.0 * n));
  EXPECT_NEAR(product / n, 0, 5 * 1e-4 / std::sqrt(n));
}

TEST(LaserScanner, ABiasIsSharedByTheBeamsOfAScan) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", with_noise({}, {{"bias_std", "0.05"}, {"correlation", "1e-3"}})));
  const Caster flat([](Vec3, Vec3) { return 5.0; });
  double squares = 0;
  constexpr int scans = 4000;  // 10 ms apart: independent, as e^-10 is left
  for (int k = 0; k < scans; ++k) {
    const auto& r = scan(rig, flat);
    EXPECT_EQ(r.front(), r.back());
    squares += (r[0] - 5.0) * (r[0] - 5.0);
  }
  EXPECT_NEAR(std::sqrt(squares / scans), 0.05, 5 * 0.05 / std::sqrt(2.0 * scans));
}

TEST(LaserScanner, AConstantErrorIsDrawnOncePerDeviceWithinItsBound) {
  // Uniform within +-0.3: of 400 devices the mean has a deviation of 0.3 / sqrt(3 * 400), the mean square
  // (0.03) one of 0.09 sqrt(4 / 45 / 400).
  Rig rig(kind, test::two_wheels());
  constexpr int devices = 400;
  for (int i = 0; i < devices; ++i)
    ASSERT_TRUE(rig.add("laser" + std::to_string(i), [] {
      Node node = config({{"beams", "2"}, {"max_range", "10"}});
      node.set("noise", config({{"systematic", "30 cm"}, {"mean", "1"}}));
      return node;
    }()));
  const Caster flat([](Vec3, Vec3) { return 5.0; });
  rig.rays = &flat;
  rig.sense();
  double sum = 0, squares = 0;
  std::vector<float> first;
  for (int i = 0; i < devices; ++i) {
    const auto& r = rig.topic<msg::LaserScan>("laser" + std::to_string(i) + "/ranges").message.ranges;
    const double e = r[0] - 6.0;
    EXPECT_LE(std::abs(e), 0.3 + float_m);
    EXPECT_EQ(r[0], r[1]);
    first.push_back(r[0]);
    sum += e;
    squares += e * e;
  }
  EXPECT_NEAR(sum / devices, 0, 5 * 0.3 / std::sqrt(3.0 * devices));
  EXPECT_NEAR(squares / devices, 0.03, 5 * 0.09 * std::sqrt(4.0 / 45 / devices));
  rig.sense();
  for (int i = 0; i < devices; ++i)
    EXPECT_EQ(rig.topic<msg::LaserScan>("laser" + std::to_string(i) + "/ranges").message.ranges[0],
              first[static_cast<std::size_t>(i)]);
}

TEST(LaserScanner, DistancesAreMultiplesOfTheResolution) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", with_noise({{"resolution", "25 cm"}}, {})));
  EXPECT_EQ(scan(rig, Caster([](Vec3, Vec3) { return 4.87; }))[0], 4.75f);
  EXPECT_EQ(scan(rig, Caster([](Vec3, Vec3) { return 4.88; }))[0], 5.0f);
  EXPECT_EQ(scan(rig, Caster([](Vec3, Vec3) { return 11.0; }))[0], inf);
}

TEST(LaserScanner, NoiseTurnsNoHitIntoAMissAndNoMissIntoAHit) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", with_noise({{"white", "5"}}, {})));
  for (const double distance : {0.05, 0.1, 9.99, 11.0}) {
    const auto& r = scan(rig, Caster([=](Vec3, Vec3) { return distance; }));
    for (const float x : r) {
      if (distance < 0.1) EXPECT_EQ(x, -inf);
      else if (distance > 10) EXPECT_EQ(x, inf);
      else EXPECT_TRUE(x >= 0.1f && x <= 10.0f) << x;
    }
  }
}

TEST(LaserScanner, AScannersNoiseDoesNotDependOnItsNeighbours) {
  const Caster flat([](Vec3, Vec3) { return 5.0; });
  Rig alone(kind, test::two_wheels()), crowd(kind, test::two_wheels());
  ASSERT_TRUE(alone.add("laser", with_noise({{"white", "0.1"}}, {})));
  for (int i = 0; i < 40; ++i)
    ASSERT_TRUE(crowd.add("other" + std::to_string(i), with_noise({{"white", "0.1"}}, {})));
  ASSERT_TRUE(crowd.add("laser", with_noise({{"white", "0.1"}}, {})));
  for (int k = 0; k < 3; ++k) EXPECT_EQ(scan(alone, flat), scan(crowd, flat));
  EXPECT_NE(crowd.topic<msg::LaserScan>("other0/ranges").message.ranges,
            crowd.topic<msg::LaserScan>("other1/ranges").message.ranges);
}

TEST(LaserScanner, CastsForAllThatAreDueInBatches) {
  Rig rig(kind, test::two_wheels());
  for (int i = 0; i < 100; ++i)
    ASSERT_TRUE(rig.add("laser" + std::to_string(i), config({{"beams", std::to_string(i + 1).c_str()}})));
  const Caster caster(wall);
  rig.rays = &caster;
  const std::vector<std::uint32_t> due{3, 7, 50};
  rig.pool->sense(rig.context(rig.now), {due, rig.sample, rig.levels, rig.since});
  EXPECT_EQ(caster.jobs_cast, 3u);
  EXPECT_EQ(rig.topic<msg::LaserScan>("laser50/ranges").count, 1u);
  EXPECT_EQ(rig.topic<msg::LaserScan>("laser4/ranges").count, 0u);
  rig.sense();
  EXPECT_EQ(caster.jobs_cast, 103u);
  EXPECT_GT(caster.largest_batch, 1u);
}

TEST(LaserScanner, SamplesIntoTheSameMemory) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", config({{"beams", "500"}})));
  const float* const place = scan(rig, Caster(wall)).data();
  for (int k = 0; k < 5; ++k) EXPECT_EQ(scan(rig, Caster(wall)).data(), place);
}

TEST(LaserScanner, StateAndNoiseSurviveSavingAndNoiseIsTunable) {
  const Caster flat([](Vec3, Vec3) { return 5.0; });
  Rig a(kind, test::two_wheels()), b(kind, test::two_wheels());
  for (Rig* rig : {&a, &b})
    ASSERT_TRUE(
        rig->add("laser", with_noise({{"white", "0.1"}}, {{"bias_std", "0.2"}, {"correlation", "10"}})));
  ASSERT_TRUE(a.pool->set_parameter(0, "noise/white", Node::scalar("3 cm")));
  EXPECT_FALSE(a.pool->set_parameter(0, "noise/white", Node::scalar("-1")));
  EXPECT_FALSE(a.pool->set_parameter(0, "beams", Node::scalar("5")));
  for (int k = 0; k < 5; ++k) scan(a, flat);
  b.load(a.saved());
  b.sample = a.sample;
  EXPECT_EQ(scan(a, flat), scan(b, flat));
  EXPECT_EQ(a.saved(), b.saved());
}

std::string complaint(std::initializer_list<std::pair<const char*, const char*>> values) {
  Rig rig(kind, test::two_wheels());
  const Status status = rig.add("laser", config(values));
  return status ? "" : status.error().text();
}

TEST(LaserScanner, ABadSpecIsRefusedAtItsPlace) {
  EXPECT_EQ(complaint({{"beams", "1000000000"}}),
            "robot.yaml:1:9: /beams: must be in [1, 1e+05], is 1e+09; Number of beams.");
  EXPECT_EQ(complaint({{"min_range", "5"}, {"max_range", "5"}}),
            "robot.yaml:2:9: /max_range: max_range must be greater than min_range; min_range is 5 m");
  EXPECT_EQ(complaint({{"min_range", "20"}}),
            "robot.yaml:12:5: /max_range: max_range must be greater than min_range; min_range is 20 m");
  EXPECT_EQ(
      complaint({{"min_angle", "1"}, {"max_angle", "0"}}),
      "robot.yaml:2:9: /max_angle: max_angle must not be less than min_angle; angles grow counter-clockwise");
  EXPECT_EQ(complaint({{"min_angle", "-200 deg"}, {"max_angle", "200 deg"}}),
            "robot.yaml:2:9: /max_angle: the beams cover more than a full turn; max_angle - min_angle is at "
            "most 360 deg");
  EXPECT_EQ(complaint({{"min_angle", "-180 deg"}, {"max_angle", "180 deg"}}), "");
  EXPECT_EQ(complaint({{"beam", "5"}}), "robot.yaml:1:9: unknown key 'beam'; did you mean 'beams'?");
}

Node sdf(std::initializer_list<std::pair<const char*, const char*>> horizontal, Node noise = Node(),
         const char* planes = nullptr) {
  Node scan = Node::map();
  scan.set("horizontal", config(horizontal));
  if (planes) scan.set("vertical", config({{"samples", planes}}));
  Node lidar = Node::map();
  lidar.set("scan", std::move(scan));
  lidar.set("range", config({{"min", "0.08"}, {"max", "12"}, {"resolution", "0.01"}}));
  if (!noise.is_null()) lidar.set("noise", std::move(noise));
  Node sensor = config({{"@name", "laser"}, {"@type", "gpu_lidar"}, {"update_rate", "7"}, {"topic", "scan"}});
  sensor.set("lidar", std::move(lidar));
  return sensor;
}

TEST(LaserScannerFromSdf, TakesTheElementsOfALidar) {
  Diagnostics diagnostics;
  const auto node = kind.from_sdf(
      sdf({{"samples", "640"}, {"resolution", "0.5"}, {"min_angle", "-1.5"}, {"max_angle", "1.2"}},
          config({{"type", "gaussian"}, {"mean", "0.0"}, {"stddev", "0.02"}})),
      diagnostics);
  ASSERT_TRUE(node);
  const auto spec = read_spec<Spec>(*node);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->beams, 320);
  EXPECT_EQ(spec->min_angle_rad, -1.5);
  EXPECT_EQ(spec->max_angle_rad, 1.2);
  EXPECT_EQ(spec->min_range_m, 0.08);
  EXPECT_EQ(spec->max_range_m, 12);
  EXPECT_EQ(spec->rate_hz, 7);
  EXPECT_EQ(spec->noise.white_m, 0.02);
  EXPECT_TRUE(diagnostics.warnings.empty()) << diagnostics.warnings[0].text();
}

TEST(LaserScannerFromSdf, TakesConstantErrorsAndQuantisation) {
  Diagnostics diagnostics;
  const auto node = kind.from_sdf(sdf({{"samples", "10"}}, config({{"type", "gaussian_quantized"},
                                                                   {"mean", "0.1"},
                                                                   {"stddev", "0.02"},
                                                                   {"bias_mean", "0.05"},
                                                                   {"precision", "0.01"},
                                                                   {"colour", "pink"}})),
                                  diagnostics);
  ASSERT_TRUE(node);
  const auto spec = read_spec<Spec>(*node);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_NEAR(spec->noise.mean_m, 0.15, 1e-15);
  EXPECT_EQ(spec->noise.white_m, 0.02);
  EXPECT_EQ(spec->noise.resolution_m, 0.01);
  ASSERT_EQ(diagnostics.warnings.size(), 1u);
  EXPECT_EQ(diagnostics.warnings[0].what, "<colour> of <noise> is not supported and has no effect");
}

TEST(LaserScannerFromSdf, WarnsOfWhatItLeavesOut) {
  Diagnostics diagnostics;
  ASSERT_TRUE(kind.from_sdf(sdf({{"samples", "10"}}, config({{"type", "pink"}})), diagnostics));
  ASSERT_EQ(diagnostics.warnings.size(), 1u);
  EXPECT_EQ(diagnostics.warnings[0].what, "noise of type 'pink' is not supported and has no effect");
  EXPECT_TRUE(kind.accepts(sdf({{"samples", "10"}})));
  EXPECT_TRUE(kind.accepts(sdf({{"samples", "10"}}, Node(), "1")));
  EXPECT_FALSE(kind.accepts(sdf({{"samples", "10"}}, Node(), "16")));  // the 3D scanner's
}

TEST(LaserScannerFromSdf, BadNumbersAreErrorsWithPlace) {
  Diagnostics diagnostics;
  EXPECT_EQ(kind.from_sdf(sdf({{"samples", "many"}}), diagnostics).error().text(),
            "robot.yaml:1:9: <scan/horizontal/samples> is 'many'; write a number");
  const auto node = kind.from_sdf(sdf({{"samples", "1000000000"}}), diagnostics);
  ASSERT_TRUE(node);
  EXPECT_EQ(read_spec<Spec>(*node).error().text(),
            "robot.yaml:1:9: /beams: must be in [1, 1e+05], is 1e+09; Number of beams.");
  EXPECT_EQ(kind.from_sdf(config({{"@type", "lidar"}}), diagnostics).error().what,
            "a laser scanner needs a <lidar> or <ray> element");
}

}  // namespace
}  // namespace sandlot::laser_scanner
