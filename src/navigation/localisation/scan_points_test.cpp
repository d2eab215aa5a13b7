#include "navigation/localisation/scan_points.h"

#include <gtest/gtest.h>

#include "navigation/localisation/distance_field.h"
#include "navigation/localisation/plane_fit.h"
#include "navigation/localisation/test_rooms.h"

namespace sandlot::navigation {
namespace {

using namespace test;

msg::LaserScan scan_points_scan(std::vector<float> ranges) {
  msg::LaserScan out;
  out.angle_min = -0.5f;
  out.angle_increment = 0.5f;
  out.range_min = 0.1f;
  out.range_max = 10;
  out.ranges = std::move(ranges);
  return out;
}

TEST(ScanPoints, AreWhereTheBeamsEnd) {
  ScanPoints points;
  const msg::LaserScan scan = scan_points_scan({1, 2, 4});
  ASSERT_EQ(take_points(scan, {{0.5, 0.1, 1}, {}}, {}, points), ScanFault::none);
  ASSERT_EQ(points.p_B.size(), 3u);
  EXPECT_NEAR(points.p_B[0].x, 0.5 + math::cos(0.5), 1e-9);
  EXPECT_NEAR(points.p_B[0].y, 0.1 - math::sin(0.5), 1e-9);
  EXPECT_NEAR(points.p_B[1].x, 2.5, 1e-9);
  EXPECT_NEAR(points.p_B[2].y, 0.1 + 4 * math::sin(0.5), 1e-9);
  // Upside down: left and right change places.
  ASSERT_EQ(take_points(scan, pose_from_rpy({0.5, 0.1, 1}, {math::pi, 0, 0}), {}, points), ScanFault::none);
  EXPECT_NEAR(points.p_B[0].y, 0.1 + math::sin(0.5), 1e-9);
}

TEST(ScanPoints, LimitsAndEvenChoice) {
  ScanPoints points;
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  ASSERT_EQ(take_points(scan_points_scan({inf, nan, -inf, -1, 0, 0.05f, 10, 11, 3, 0.3f, 6}), {},
                        {0.5, 5, 100}, points),
            ScanFault::none);
  ASSERT_EQ(points.p_B.size(), 1u) << "only the 3 m";
  EXPECT_NEAR(math::hypot(points.p_B[0].x, points.p_B[0].y), 3, 1e-6);
  std::vector<float> ranges;
  for (int i = 0; i < 100; ++i) ranges.push_back(i % 2 ? inf : 1 + 0.01f * static_cast<float>(i));
  ASSERT_EQ(take_points(scan_points_scan(ranges), {}, {0, 100, 5}, points), ScanFault::none);
  ASSERT_EQ(points.p_B.size(), 5u);
  for (std::size_t k = 0; k < 5; ++k)  // of 50 usable ones number 0, 10, 20, 30, 40: beams 0, 20, 40 ...
    EXPECT_NEAR(math::hypot(points.p_B[k].x, points.p_B[k].y), 1 + 0.2 * static_cast<double>(k), 1e-6);
  EXPECT_EQ(take_points(scan_points_scan({}), {}, {}, points), ScanFault::no_beams);
  EXPECT_TRUE(points.p_B.empty());
}

TEST(ScanPoints, NormalsOfAWallAndOfACorner) {
  ScanPoints points;
  // A wall along the direction (2, 1) in steps of 5 cm, then an edge into the direction (-1, 2).
  const double h = std::sqrt(5.0);
  for (int i = 0; i <= 20; ++i) points.p_B.push_back({3 + 0.1 / h * i, 0.05 / h * i});
  const Vec2 corner = points.p_B.back();
  for (int i = 1; i <= 20; ++i) points.p_B.push_back({corner.x - 0.05 / h * i, corner.y + 0.1 / h * i});
  add_normals(points, 0.25, 0.3);
  ASSERT_EQ(points.normal_B.size(), 41u);
  EXPECT_EQ(points.normal_B[0], Vec2{}) << "no neighbours on one side";
  EXPECT_EQ(points.normal_B[20], Vec2{}) << "the corner";
  for (const std::size_t i : {std::size_t{2}, std::size_t{10}, std::size_t{15}}) {
    EXPECT_NEAR(points.normal_B[i].x, -1 / h, 1e-9)
        << i;  // of (-1, 2) and (1, -2) the one towards the origin
    EXPECT_NEAR(points.normal_B[i].y, 2 / h, 1e-9) << i;
  }
  EXPECT_NEAR(points.normal_B[30].x, -2 / h, 1e-9);
  EXPECT_NEAR(points.normal_B[30].y, -1 / h, 1e-9);
  // A gap ends the surface.
  for (std::size_t i = 21; i < points.p_B.size(); ++i) points.p_B[i] = points.p_B[i] + Vec2{2, 2};
  add_normals(points, 0.25, 0.3);
  EXPECT_EQ(points.normal_B[20], Vec2{});
  EXPECT_NEAR(points.normal_B[18].x, -1 / h, 1e-9) << "the corner is gone";
}

TEST(DistanceField, InterpolatesBetweenCentres) {
  GridMap map{{10, 10, 0.1, {2, 1, 0.6}}, std::vector<std::int8_t>(100)};
  for (int y = 0; y < 10; ++y)
    map.occupancy[map.geometry.index({7, y})] = 100;  // centres at 0.75 m along the x axis
  const DistanceField field = *DistanceField::make(map, 65, 0.5);
  const GridFrame frame(map.geometry);
  DistanceField::Sample at;
  ASSERT_TRUE(field.sample(frame.to_map({4.2, 5.1}), at));
  EXPECT_NEAR(at.distance_m, 0.33, 1e-6);
  EXPECT_NEAR(at.gradient_M.x, -math::cos(0.6), 1e-6);
  EXPECT_NEAR(at.gradient_M.y, -math::sin(0.6), 1e-6);
  ASSERT_TRUE(field.sample(frame.to_map({8.4, 0.01}), at));
  EXPECT_NEAR(at.distance_m, 0.09, 1e-6);
  EXPECT_NEAR(at.gradient_M.x, math::cos(0.6), 1e-6);
  ASSERT_TRUE(field.sample(frame.to_map({0.2, 5}), at));
  EXPECT_NEAR(at.distance_m, 0.5, 1e-6) << "the greatest";
  EXPECT_FALSE(field.sample(frame.to_map({-0.01, 5}), at));
  // A thick wall, columns 4 to 7: 0 at its surface, negative inside, the gradient out of it on both sides.
  for (int y = 0; y < 10; ++y)
    for (int x = 4; x < 7; ++x) map.occupancy[map.geometry.index({x, y})] = 100;
  const DistanceField thick = *DistanceField::make(map, 65, 0.5);
  ASSERT_TRUE(thick.sample(frame.to_map({4.5, 5.5}), at));
  EXPECT_NEAR(at.distance_m, 0, 1e-6);
  ASSERT_TRUE(thick.sample(frame.to_map({4.9, 5.5}), at));
  EXPECT_NEAR(at.distance_m, -0.04, 1e-6);
  EXPECT_NEAR(at.gradient_M.x, -math::cos(0.6), 1e-6);
  ASSERT_TRUE(thick.sample(frame.to_map({7.1, 5.5}), at));
  EXPECT_NEAR(at.distance_m, -0.04, 1e-6);
  EXPECT_NEAR(at.gradient_M.x, math::cos(0.6), 1e-6);
  EXPECT_FALSE(field.sample({std::nan(""), 0}, at));
}

TEST(PlaneFit, SolvesWhatItsLinesShow) {
  // A pose off by (0.02, -0.01) and a turn of 0.005: residuals of points on three walls, to first order.
  const double x = 0.02, y = -0.01, turn = 0.005;
  PlaneFit fit(2);
  const auto add = [&](Vec2 n, Vec2 r) {
    fit.add(n, r, n.x * x + n.y * y + (n.y * r.x - n.x * r.y) * turn, 1);
  };
  for (int i = -5; i <= 5; ++i) add({1, 0}, {3, 0.2 * i});
  const PlaneFit::Step wall = fit.solve(1e-3);
  EXPECT_EQ(wall.observable, 2);
  EXPECT_NEAR(wall.x, -x, 1e-12);
  EXPECT_NEAR(wall.y, 0, 1e-12);
  EXPECT_NEAR(wall.theta, -turn, 1e-12);
  // x: 11 points; theta: sum of (0.2 i)^2 = 4.4. Along the wall nothing.
  const Covariance3 P = fit.covariance(0.1, 1e-3);
  EXPECT_NEAR(P[0], 0.01 / 11, 1e-12);
  EXPECT_NEAR(P[8], 0.01 / 4.4, 1e-12);
  EXPECT_NEAR(P[4], unknown_variance, 1e-3);
  for (int i = -5; i <= 5; ++i) add({0, 1}, {0.2 * i, 2});
  const PlaneFit::Step both = fit.solve(1e-3);
  EXPECT_EQ(both.observable, 3);
  EXPECT_NEAR(both.x, -x, 1e-12);
  EXPECT_NEAR(both.y, -y, 1e-12);
  EXPECT_NEAR(both.theta, -turn, 1e-12);
}

}  // namespace
}  // namespace sandlot::navigation
