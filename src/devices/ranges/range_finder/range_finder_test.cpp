#include "devices/ranges/range_finder/range_finder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "devices/test_rig.h"

namespace sandlot::range_finder {
namespace {

using test::config;
using test::Rig;

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr double float_m = 5e-7;

class Caster final : public RayCaster {
 public:
  explicit Caster(std::function<double(Vec3 origin_W, Vec3 direction_W)> distance)
      : distance_(std::move(distance)) {}
  void cast(std::span<const RayJob> jobs) const override {
    for (const RayJob& job : jobs) {
      rays = job.directions.size();
      ignored = job.ignore_body;
      for (std::size_t i = 0; i < job.directions.size(); ++i) {
        const double d = distance_(job.X_WS.p, rotate(job.X_WS.q, job.directions[i]));
        job.distance_m[i] = d <= job.max_m ? static_cast<float>(d) : inf;
      }
    }
  }
  mutable std::size_t rays = 0;
  mutable std::uint32_t ignored = 0;

 private:
  std::function<double(Vec3, Vec3)> distance_;
};

float measure(Rig& rig, const Caster& caster) {
  rig.rays = &caster;
  rig.sense();
  return rig.topic<msg::Range>("sonar/range").message.range;
}

/// The floor z = -1 m.
double floor_below(Vec3 o, Vec3 d) { return d.z < -1e-12 ? (-1 - o.z) / d.z : HUGE_VAL; }

TEST(RangeFinder, TheEdgeOfTheConeMeetsTheFloorFirst) {
  // The lowest ray of the outermost ring leaves at fov / 2 below the axis (6 rings rays: one at 270 degrees
  // when 6 k is a multiple of 4, so for two rings): distance 1 / sin(fov / 2).
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("sonar", config({{"fov", "40 deg"}, {"rings", "2"}, {"max_range", "10"}}), 1, 3));
  const Caster caster(floor_below);
  EXPECT_NEAR(measure(rig, caster), 1 / math::sin(math::pi / 9), 1e-6);
  EXPECT_EQ(caster.rays, 1u + 6 + 12);
  EXPECT_EQ(caster.ignored, 3u);
  const msg::Range& m = rig.topic<msg::Range>("sonar/range").message;
  EXPECT_EQ(m.radiation_type, 0);
  EXPECT_NEAR(m.field_of_view, 40 * math::pi / 180, 1e-7);
  EXPECT_EQ(m.max_range, 10);
  EXPECT_EQ(m.header.frame_id, "robot1/sonar");
}

TEST(RangeFinder, SeesInItsConeAndNowhereElse) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("sonar", config({{"fov", "60 deg"}, {"rings", "4"}, {"max_range", "5"}})));
  // Only directions more than a given angle from x are blocked, at 2 m.
  const auto beyond = [&](double deg) {
    const double limit = math::cos(deg * math::pi / 180);
    return measure(rig, Caster([=](Vec3, Vec3 d) { return d.x < limit ? 2.0 : HUGE_VAL; }));
  };
  EXPECT_EQ(beyond(29.9), 2.0f);
  EXPECT_EQ(beyond(30.1), inf);
}

TEST(RangeFinder, ASingleRayLooksAlongX) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("sonar", config({{"rings", "0"}, {"min_range", "0.1"}, {"max_range", "0.8"}}), 1, 0,
                      pose_from_rpy({0.2, 0, 0}, {0, 0, 0.5})));
  const Caster wall([](Vec3 o, Vec3 d) { return (0.7 - o.x) / d.x; });
  EXPECT_NEAR(measure(rig, wall), 0.5 / math::cos(0.5), float_m);
  EXPECT_EQ(measure(rig, Caster([](Vec3, Vec3) { return 0.09; })), -inf);
  EXPECT_EQ(measure(rig, Caster([](Vec3, Vec3) { return 0.81; })), inf);
}

TEST(RangeFinder, NoiseHasItsStatedSpreadAndIsTheDevicesOwn) {
  Rig rig(kind, test::two_wheels());
  Node node = config({{"rings", "1"}});
  node.set("noise", config({{"white", "1 cm"}}));
  ASSERT_TRUE(rig.add("sonar", std::move(node)));
  const Caster flat([](Vec3, Vec3) { return 2.0; });
  double sum = 0, squares = 0;
  constexpr int n = 10'000;
  for (int i = 0; i < n; ++i) {
    const double e = static_cast<double>(measure(rig, flat)) - 2;
    sum += e;
    squares += e * e;
  }
  EXPECT_NEAR(sum / n, 0, 5 * 0.01 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.01, 5 * 0.01 / std::sqrt(2.0 * n));
}

TEST(RangeFinder, ABadSpecIsRefusedAtItsPlace) {
  Rig rig(kind, test::two_wheels());
  EXPECT_EQ(rig.add("sonar", config({{"min_range", "5"}, {"max_range", "5"}})).error().text(),
            "robot.yaml:2:9: /max_range: max_range must be greater than min_range; min_range is 5 m");
  EXPECT_EQ(rig.add("sonar", config({{"radiation", "infra"}})).error().text(),
            "robot.yaml:1:9: /radiation: 'infra' is not a choice here; known are: ultrasound, infrared");
}

Result<Spec> read_range_spec(const Node& element, Diagnostics& diagnostics) {
  SL_ASSIGN(const Node node, kind.from_sdf(element, diagnostics));
  return read_spec<Spec>(node);
}

TEST(RangeFinderFromSdf, TakesSonars) {
  Node sensor = config({{"@type", "sonar"}, {"update_rate", "5"}});
  sensor.set("sonar", config({{"min", "0.1"}, {"max", "2"}, {"radius", "0.5"}}));
  Diagnostics diagnostics;
  const auto spec = read_range_spec(sensor, diagnostics);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->rate_hz, 5);
  EXPECT_EQ(spec->min_range_m, 0.1);
  EXPECT_EQ(spec->max_range_m, 2);
  EXPECT_NEAR(spec->fov_rad, 2 * math::atan(0.25), 1e-12);
  EXPECT_TRUE(diagnostics.warnings.empty());
}

TEST(RangeFinderFromSdf, TakesRaySensorsWhosePluginPublishesARange) {
  Node ray = Node::map();
  Node scan = Node::map();
  scan.set("horizontal", config({{"samples", "5"}, {"min_angle", "-0.2"}, {"max_angle", "0.2"}}));
  ray.set("scan", std::move(scan));
  ray.set("range", config({{"min", "0.1"}, {"max", "0.8"}}));
  Node sensor = config({{"@type", "ray"}, {"update_rate", "25"}});
  sensor.set("ray", std::move(ray));
  sensor.set("plugin", config({{"@filename", "libgazebo_ros_range.so"}, {"radiation", "infrared"}}));
  model::DeviceDecl decl{
      .name = "ir", .sdf_types = {"sensor:ray", "plugin:libgazebo_ros_range.so"}, .config = sensor};
  ASSERT_EQ(find_device_kind_for_sdf(decl), &kind);
  Diagnostics diagnostics;
  const auto spec = read_range_spec(sensor, diagnostics);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->radiation, Radiation::infrared);
  EXPECT_NEAR(spec->fov_rad, 0.4, 1e-12);
  EXPECT_EQ(spec->max_range_m, 0.8);
  // The plugin of many types: a Range is ours, a LaserScan the scanner's.
  decl.sdf_types[1] = "plugin:libgazebo_ros_ray_sensor.so";
  decl.config.set(
      "plugin", config({{"@filename", "libgazebo_ros_ray_sensor.so"}, {"output_type", "sensor_msgs/Range"}}));
  EXPECT_EQ(find_device_kind_for_sdf(decl), &kind);
  decl.config.find("plugin")->set("output_type", Node::scalar("sensor_msgs/LaserScan"));
  ASSERT_NE(find_device_kind_for_sdf(decl), nullptr);
  EXPECT_STREQ(find_device_kind_for_sdf(decl)->name, "laser_scanner");
}

}  // namespace
}  // namespace sandlot::range_finder
