#include "physics/planar/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "geometry/mesh.h"

namespace sandlot::planar {
namespace {

struct Shadow {
  std::vector<Outline> outlines;
  std::vector<Edge> edges;
  Shadow(const Shape& shape, const Pose& X_WC) { add_outlines(shape, X_WC, outlines, edges); }
  double distance(Vec2 p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Outline& o : outlines) least = std::min(least, nearest(o, edges, p).distance_m);
    return least;
  }
};

Pose lying(double yaw = 0) {
  return pose_from_rpy({1, 2, 0.5}, {0, math::pi / 2, yaw});
}  // z of C along x of W

TEST(PlanarOutline, ABoxIsItsRectangle) {
  const Shadow box(Box{{2, 1, 0.4}},
                   pose_from_rpy({1, 2, 0.5}, {0, 0, math::pi / 2}));  // 1 wide in x, 2 in y
  ASSERT_EQ(box.outlines.size(), 1u);
  EXPECT_EQ(box.outlines[0].edge_count, 4u);
  EXPECT_NEAR(box.outlines[0].heights.min_m, 0.3, 1e-15);
  EXPECT_NEAR(box.outlines[0].heights.max_m, 0.7, 1e-15);
  EXPECT_NEAR(box.distance({3, 2}), 1.5, 1e-12);
  EXPECT_NEAR(box.distance({1, 2.8}), -0.2, 1e-12);             // inside
  EXPECT_NEAR(box.distance({1.5 + 0.3, 3 + 0.4}), 0.5, 1e-12);  // beyond a corner
  const Nearest n = nearest(box.outlines[0], box.edges, {1.5 + 0.3, 3 + 0.4});
  EXPECT_NEAR(n.normal.x, 0.6, 1e-12);
  EXPECT_NEAR(n.normal.y, 0.8, 1e-12);
  const Chord c = chord(box.outlines[0], box.edges, {-1, 2.5}, {2, 0});  // in units of the direction
  EXPECT_NEAR(c.first, 0.75, 1e-12);
  EXPECT_NEAR(c.last, 1.25, 1e-12);
}

TEST(PlanarOutline, ALineBesideAnEdgeMissesIt) {
  const Shadow box(Box{{2, 1, 1}}, {});
  const Chord beside = chord(box.outlines[0], box.edges, {-3, 0.51}, {1, 0});
  EXPECT_GT(beside.first, beside.last);
  const Chord inside = chord(box.outlines[0], box.edges, {-3, 0.49}, {1, 0});
  EXPECT_NEAR(inside.first, 2, 1e-12);
  EXPECT_NEAR(inside.last, 4, 1e-12);
}

TEST(PlanarOutline, ATiltedBoxIsTheHullOfItsCorners) {
  const Shadow box(Box{{1, 1, 1}}, pose_from_rpy({0, 0, 0}, {0, math::pi / 4, 0}));
  EXPECT_NEAR(box.distance({2, 0}), 2 - std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(box.distance({0, 2}), 1.5, 1e-12);
  EXPECT_NEAR(box.outlines[0].heights.max_m, std::sqrt(0.5), 1e-12);
  const Shadow corner(Box{{1, 1, 1}}, {{}, quat_between(normalised(Vec3{1, 1, 1}), {0, 0, 1})});
  EXPECT_EQ(corner.outlines[0].edge_count, 6u);  // a cube on its corner
  EXPECT_NEAR(corner.outlines[0].heights.max_m, std::sqrt(0.75), 1e-12);
}

TEST(PlanarOutline, ACylinderStandsAsACircleAndLiesAsARectangle) {
  const Shadow standing(Cylinder{0.3, 2}, pose_from_rpy({1, 2, 0.5}, {0, 0, 1}));
  ASSERT_EQ(standing.outlines[0].edge_count, 0u);
  EXPECT_NEAR(standing.distance({1, 4}), 1.7, 1e-12);
  EXPECT_NEAR(standing.outlines[0].heights.max_m, 1.5, 1e-15);
  const Shadow flat(Cylinder{0.3, 2}, lying());
  EXPECT_NEAR(flat.distance({3, 2}), 1, 1e-9);
  EXPECT_NEAR(flat.distance({1, 3}), 0.7, 1e-9);
  EXPECT_NEAR(flat.distance({2.3, 2.7}), std::sqrt(0.3 * 0.3 + 0.4 * 0.4),
              1e-9);  // a corner, not a half circle
  EXPECT_NEAR(flat.outlines[0].heights.min_m, 0.2, 1e-12);
  // Oblique: never smaller than it is, larger by less than 1 / cos(pi / 32) - 1 = 0.5 % of the radius.
  const Shadow oblique(Cylinder{0.3, 2}, pose_from_rpy({}, {0, 0.5, 0}));
  const double reach = math::sin(0.5) + 0.3 * math::cos(0.5);
  EXPECT_LE(oblique.distance({2, 0}), 2 - reach + 1e-12);
  EXPECT_GE(oblique.distance({2, 0}), 2 - reach - 0.005 * 0.3);
}

TEST(PlanarOutline, ACapsuleLiesAsAStadium) {
  const Shadow flat(Capsule{0.3, 2}, lying(math::pi / 2));  // along y
  EXPECT_NEAR(flat.distance({1, 4}), 0.7, 1e-9);
  EXPECT_NEAR(flat.distance({2, 2.5}), 0.7, 1e-9);
  EXPECT_NEAR(flat.distance({1.3, 3.4}), 0.2, 1e-9);  // round ends
  for (const Outline& o : flat.outlines) EXPECT_NEAR(o.heights.max_m, 0.8, 1e-12);
  const Shadow standing(Capsule{0.3, 2}, {});
  EXPECT_EQ(standing.outlines.size(), 1u);
  EXPECT_NEAR(standing.outlines[0].heights.max_m, 1.3, 1e-15);
}

TEST(PlanarOutline, ASphereIsACircleAndAPlaneNothing) {
  const Shadow ball(Sphere{0.5}, {{1, 1, 1}, {}});
  EXPECT_NEAR(ball.distance({1, 3}), 1.5, 1e-15);
  EXPECT_NEAR(ball.outlines[0].heights.min_m, 0.5, 1e-15);
  const Shadow ground(Plane{{0, 0, 1}}, {});
  EXPECT_TRUE(ground.outlines.empty());
  EXPECT_TRUE(heights_of(Plane{{0, 0, 1}}, {}).empty());
}

TEST(PlanarOutline, ConesAndEllipsoidsCastCirclesAndHulls) {
  std::vector<Outline> outlines;
  std::vector<Edge> edges;
  add_outlines(Cone{0.5, 2}, {{1, 2, 3}, {}}, outlines, edges);
  ASSERT_EQ(outlines.size(), 1u);
  EXPECT_EQ(outlines[0].edge_count, 0u);
  EXPECT_DOUBLE_EQ(outlines[0].radius_m, 0.5);
  EXPECT_DOUBLE_EQ(outlines[0].heights.min_m, 2);
  EXPECT_DOUBLE_EQ(outlines[0].heights.max_m, 4);
  // On its side, apex towards +x: a triangle, 1 m wide where the base is.
  outlines.clear(), edges.clear();
  add_outlines(Cone{0.5, 2}, {{0, 0, 1}, quat_from_axis_angle({0, 1, 0}, math::pi / 2)}, outlines, edges);
  ASSERT_EQ(outlines.size(), 1u);
  EXPECT_NEAR(nearest(outlines[0], edges, {3, 0}).distance_m, 2, 1e-6);
  EXPECT_NEAR(nearest(outlines[0], edges, {-3, 0}).distance_m, 2, 1e-6);
  EXPECT_NEAR(nearest(outlines[0], edges, {-1, 2}).distance_m, 1.5, 1e-2);
  EXPECT_NEAR(outlines[0].heights.max_m, 1.5, 1e-9);
  // An ellipsoid turned by 90 degrees about z.
  outlines.clear(), edges.clear();
  add_outlines(Ellipsoid{{1, 2, 0.5}}, {{}, quat_from_axis_angle({0, 0, 1}, math::pi / 2)}, outlines, edges);
  ASSERT_EQ(outlines.size(), 1u);
  EXPECT_NEAR(nearest(outlines[0], edges, {3, 0}).distance_m, 1, 0.01);  // 32 tangents: 0.5 % outside at most
  EXPECT_NEAR(nearest(outlines[0], edges, {0, 3}).distance_m, 2, 0.01);
  EXPECT_NEAR(outlines[0].heights.max_m, 0.5, 1e-12);
}

TEST(PlanarOutline, AMeshIsItsTrianglesAndKeepsItsRooms) {
  // A room without a roof: four upright walls of 4 m x 3 m about the origin, from z = 0 to 2.
  TriangleMesh room;
  const double x[] = {-2, 2, 2, -2}, y[] = {-1.5, -1.5, 1.5, 1.5};
  for (std::uint32_t i = 0; i < 4; ++i)
    for (const double z : {0.0, 2.0}) room.vertices.push_back({x[i], y[i], z});
  for (std::uint32_t i = 0; i < 4; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % 4);
    room.triangles.push_back({a, b, b + 1});
    room.triangles.push_back({a, b + 1, a + 1});
  }
  std::vector<Outline> outlines;
  std::vector<Edge> edges;
  add_outlines(Mesh{std::make_shared<const TriangleMesh>(room)}, {{10, 0, 0}, {}}, outlines, edges);
  ASSERT_EQ(outlines.size(), 4u);  // one wall for both halves of a rectangle
  const auto gap = [&](Vec2 p) {
    double least = 1e9;
    for (const Outline& o : outlines) least = std::min(least, nearest(o, edges, p).distance_m);
    return least;
  };
  EXPECT_NEAR(gap({10, 0}), 1.5, 1e-5);
  EXPECT_NEAR(gap({11.5, 0}), 0.5, 1e-5);
  EXPECT_NEAR(gap({13, 0}), 1, 1e-5);
  // From outside through both walls.
  double first = 1e9, last = -1e9;
  for (const Outline& o : outlines) {
    const Chord c = chord(o, edges, {5, 0.3}, {1, 0});
    if (c.first <= c.last) first = std::min(first, c.first), last = std::max(last, c.last);
  }
  EXPECT_NEAR(first, 3, 1e-5);
  EXPECT_NEAR(last, 7, 1e-5);
  // A closed box of triangles stands in the way as the box does.
  outlines.clear(), edges.clear();
  add_outlines(Mesh{std::make_shared<const TriangleMesh>(tessellate(Box{{2, 1, 1}}))}, {}, outlines, edges);
  EXPECT_NEAR(gap({2, 0.2}), 1, 1e-5);
  EXPECT_NEAR(gap({0.3, -1}), 0.5, 1e-5);
  EXPECT_LE(gap({0.3, 0.1}), 0);
}

}  // namespace
}  // namespace sandlot::planar
