#include "devices/ranges/laser_scanner_3d/laser_scanner_3d.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "devices/test_rig.h"

namespace sandlot::laser_scanner_3d {
namespace {

using test::config;
using test::Rig;

// Coordinates are floats: relative rounding 6e-8 of a few metres.
constexpr double float_m = 1e-6;

/// A world that is a function of one ray.
class Caster final : public RayCaster {
 public:
  explicit Caster(std::function<double(Vec3 origin_W, Vec3 direction_W)> distance)
      : distance_(std::move(distance)) {}
  void cast(std::span<const RayJob> jobs) const override {
    for (const RayJob& job : jobs)
      for (std::size_t i = 0; i < job.directions.size(); ++i) {
        const double d = distance_(job.X_WS.p, rotate(job.X_WS.q, job.directions[i]));
        job.distance_m[i] = d <= job.max_m ? static_cast<float>(d) : std::numeric_limits<float>::infinity();
      }
  }

 private:
  std::function<double(Vec3, Vec3)> distance_;
};

/// The floor z = -1 m.
double floor_below(Vec3 o, Vec3 d) { return d.z < -1e-12 ? (-1 - o.z) / d.z : HUGE_VAL; }

struct Point {
  float x, y, z, intensity;
  std::uint16_t ring;
};
Point point(const msg::PointCloud2& cloud, std::size_t i) {
  Point p{};
  std::memcpy(&p, cloud.data.data() + i * cloud.point_step, 18);
  return p;
}

Node spec_node(const char* organised) {
  return config({{"columns", "4"},
                 {"planes", "3"},
                 {"min_angle", "-180 deg"},
                 {"max_angle", "90 deg"},
                 {"min_elevation", "-45 deg"},
                 {"max_elevation", "45 deg"},
                 {"min_range", "0.5"},
                 {"max_range", "30"},
                 {"organised", organised}});
}

TEST(LaserScanner3d, AFloorIsSeenWhereTheBeamsMeetItPlaneByPlane) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("lidar", spec_node("true")));
  const Caster caster(floor_below);
  rig.rays = &caster;
  rig.sense();
  const msg::PointCloud2& cloud = rig.topic<msg::PointCloud2>("lidar/points").message;
  EXPECT_EQ(cloud.height, 3u);
  EXPECT_EQ(cloud.width, 4u);
  EXPECT_EQ(cloud.point_step, 20u);
  EXPECT_EQ(cloud.row_step, 80u);
  ASSERT_EQ(cloud.data.size(), 240u);
  EXPECT_FALSE(cloud.is_dense);
  EXPECT_EQ(cloud.header.frame_id, "robot1/lidar");
  // Downwards by 45 degrees the floor is met 1 m out, in the directions -180, -90, 0 and 90 degrees.
  const Vec3 expected[] = {{-1, 0, -1}, {0, -1, -1}, {1, 0, -1}, {0, 1, -1}};
  for (std::size_t i = 0; i < 12; ++i) {
    const Point p = point(cloud, i);
    EXPECT_EQ(p.ring, i / 4);
    EXPECT_EQ(p.intensity, 0);
    if (i < 4) {
      EXPECT_NEAR(p.x, expected[i].x, float_m);
      EXPECT_NEAR(p.y, expected[i].y, float_m);
      EXPECT_NEAR(p.z, expected[i].z, float_m);
    } else {
      EXPECT_TRUE(std::isnan(p.x) && std::isnan(p.y) && std::isnan(p.z)) << i;
    }
  }
  const std::vector<std::string> names{"x", "y", "z", "intensity", "ring"};
  ASSERT_EQ(cloud.point_fields.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(cloud.point_fields[i].name, names[i]);
    EXPECT_EQ(cloud.point_fields[i].offset, 4 * i);
    EXPECT_EQ(cloud.point_fields[i].datatype, i < 4 ? 7 : 4);
  }
}

TEST(LaserScanner3d, UnorganisedHoldsTheHitsAlone) {
  Rig rig(kind, test::two_wheels());
  ASSERT_TRUE(rig.add("lidar", spec_node("false")));
  const Caster caster([](Vec3 o, Vec3 d) { return d.x > 0.5 ? floor_below(o, d) : HUGE_VAL; });
  rig.rays = &caster;
  rig.sense();
  const msg::PointCloud2& cloud = rig.topic<msg::PointCloud2>("lidar/points").message;
  EXPECT_EQ(cloud.height, 1u);
  EXPECT_EQ(cloud.width, 1u);
  EXPECT_TRUE(cloud.is_dense);
  ASSERT_EQ(cloud.data.size(), 20u);
  EXPECT_NEAR(point(cloud, 0).x, 1, float_m);
  const Caster near([](Vec3, Vec3) { return 0.49; });  // below min_range
  rig.rays = &near;
  rig.sense();
  EXPECT_EQ(cloud.width, 0u);
  EXPECT_TRUE(cloud.data.empty());
}

TEST(LaserScanner3d, NoiseActsAlongTheBeam) {
  Rig rig(kind, test::two_wheels());
  Node node = config({{"columns", "1000"}, {"planes", "10"}, {"max_range", "20"}});
  node.set("noise", config({{"white", "5 cm"}, {"mean", "0.5"}}));
  ASSERT_TRUE(rig.add("lidar", std::move(node)));
  const Caster sphere([](Vec3, Vec3) { return 4.0; });
  rig.rays = &sphere;
  rig.sense();
  const msg::PointCloud2& cloud = rig.topic<msg::PointCloud2>("lidar/points").message;
  double sum = 0, squares = 0;
  constexpr int n = 10'000;
  for (std::size_t i = 0; i < n; ++i) {
    const Point p = point(cloud, i);
    const double e = std::sqrt(double(p.x) * p.x + double(p.y) * p.y + double(p.z) * p.z) - 4.5;
    sum += e;
    squares += e * e;
  }
  EXPECT_NEAR(sum / n, 0, 5 * 0.05 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.05, 5 * 0.05 / std::sqrt(2.0 * n));
}

TEST(LaserScanner3d, StateSurvivesSaving) {
  Rig a(kind, test::two_wheels()), b(kind, test::two_wheels());
  for (Rig* rig : {&a, &b}) {
    Node node = spec_node("true");
    Node noise = config({{"white", "0.1"}});
    noise.set("bias", config({{"bias_std", "0.2"}}));
    node.set("noise", std::move(noise));
    ASSERT_TRUE(rig->add("lidar", std::move(node)));
  }
  const Caster sphere([](Vec3, Vec3) { return 4.0; });
  a.rays = b.rays = &sphere;
  for (int i = 0; i < 3; ++i) a.sense();
  b.load(a.saved());
  b.sample = a.sample;
  a.sense();
  b.sense();
  EXPECT_EQ(a.topic<msg::PointCloud2>("lidar/points").message.data,
            b.topic<msg::PointCloud2>("lidar/points").message.data);
}

std::string complaint(std::initializer_list<std::pair<const char*, const char*>> values) {
  Rig rig(kind, test::two_wheels());
  const Status status = rig.add("lidar", config(values));
  return status ? "" : status.error().text();
}

TEST(LaserScanner3d, ABadSpecIsRefusedAtItsPlace) {
  EXPECT_EQ(
      complaint({{"columns", "100000"}, {"planes", "100"}}),
      "robot.yaml:1:9: /columns: the scanner has more than a million beams; columns * planes is at most "
      "1000000");
  EXPECT_EQ(complaint({{"min_range", "5"}, {"max_range", "5"}}),
            "robot.yaml:2:9: /max_range: max_range must be greater than min_range; min_range is 5 m");
  EXPECT_EQ(
      complaint({{"min_elevation", "10 deg"}, {"max_elevation", "5 deg"}}),
      "robot.yaml:2:9: /max_elevation: max_elevation must not be less than min_elevation; elevations grow "
      "upwards");
  EXPECT_EQ(complaint({{"columns", "100000"}, {"planes", "10"}}), "");
}

TEST(LaserScanner3dFromSdf, AnswersToLidarsWithSeveralPlanes) {
  Node scan = Node::map();
  scan.set("horizontal", config({{"samples", "1800"}, {"min_angle", "-3.14"}, {"max_angle", "3.14"}}));
  scan.set("vertical", config({{"samples", "16"}, {"min_angle", "-0.26"}, {"max_angle", "0.26"}}));
  Node lidar = Node::map();
  lidar.set("scan", std::move(scan));
  lidar.set("range", config({{"min", "0.5"}, {"max", "100"}}));
  lidar.set("noise", config({{"type", "gaussian"}, {"stddev", "0.02"}}));
  Node sensor = config({{"@name", "lidar"}, {"@type", "gpu_lidar"}, {"update_rate", "10"}});
  sensor.set("lidar", std::move(lidar));
  const model::DeviceDecl decl{.name = "lidar", .sdf_types = {"sensor:gpu_lidar"}, .config = sensor};
  ASSERT_EQ(find_device_kind_for_sdf(decl), &kind);
  Diagnostics diagnostics;
  const auto node = kind.from_sdf(sensor, diagnostics);
  ASSERT_TRUE(node);
  const auto spec = read_spec<Spec>(*node);
  ASSERT_TRUE(spec) << spec.error().text();
  EXPECT_EQ(spec->columns, 1800);
  EXPECT_EQ(spec->planes, 16);
  EXPECT_EQ(spec->min_elevation_rad, -0.26);
  EXPECT_EQ(spec->max_elevation_rad, 0.26);
  EXPECT_EQ(spec->rate_hz, 10);
  EXPECT_EQ(spec->noise.white_m, 0.02);
  EXPECT_TRUE(diagnostics.warnings.empty());
}

}  // namespace
}  // namespace sandlot::laser_scanner_3d
