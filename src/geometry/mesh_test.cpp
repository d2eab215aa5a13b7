#include "geometry/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "base/math.h"
#include "base/random.h"
#include "geometry/height_grid.h"
#include "geometry/triangulate.h"

namespace sandlot::mesh_test {
namespace {

// Sums of a few dozen products of numbers of size one.
constexpr double eps = 1e-13;

void expect_near(Vec3 a, Vec3 b, double tolerance = eps) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TriangleMesh moved(TriangleMesh mesh, Vec3 by) {
  for (Vec3& v : mesh.vertices) v += by;
  return mesh;
}
TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto n = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + n, j + n, k + n});
  return a;
}
Vec3 random_point(Stream& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
  return {x, y, z};
}

TEST(MassProperties, OfABoxAwayFromItsFrame) {
  const TriangleMesh box = moved(tessellate(Box{{2, 3, 4}}), {10, -20, 30});
  const MassProperties p = mass_properties(box);
  EXPECT_NEAR(p.volume_m3, 24, 24 * eps);
  expect_near(p.centre_m, {10, -20, 30}, 30 * eps);
  expect_near(p.moments, {25.0 / 12, 20.0 / 12, 13.0 / 12}, 30 * eps);  // (b^2 + c^2) / 12
  expect_near(p.products, {0, 0, 0}, 30 * eps);
}

TEST(MassProperties, OfTheCornerTetrahedron) {
  // Corners 0 x y z: volume 1/6, centre 1/4. Moments about the corner: E[x^2] = 1/10, E[xy] = 1/20.
  const TriangleMesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  const MassProperties p = mass_properties(mesh);
  EXPECT_NEAR(p.volume_m3, 1.0 / 6, eps);
  expect_near(p.centre_m, {0.25, 0.25, 0.25});
  const double variance = 0.1 - 1.0 / 16, covariance = 0.05 - 1.0 / 16;
  expect_near(p.moments, {2 * variance, 2 * variance, 2 * variance});
  expect_near(p.products, {-covariance, -covariance, -covariance});
  EXPECT_TRUE(is_closed(mesh));
}

TEST(MassProperties, TrianglesThatFaceInwardsGiveANegativeVolume) {
  TriangleMesh box = tessellate(Box{{1, 1, 1}});
  for (auto& t : box.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(mass_properties(box).volume_m3, -1, eps);
  EXPECT_TRUE(is_closed(box));
}

TEST(MassProperties, OfAnExtrudedLByHand) {
  // Two plates: 2 x 1 at centre (1, 0.5) and 1 x 2 at (0.5, 2), thickness 0.5, areas 2 and 2.
  const TriangleMesh l = extrude({{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}}, 0.5);
  ASSERT_TRUE(is_closed(l));
  const MassProperties p = mass_properties(l);
  EXPECT_NEAR(p.volume_m3, 2, eps);
  expect_near(p.centre_m, {0.75, 1.25, 0.25});
  // Each plate about its own middle, then moved by (-+0.25, -+0.75) from the common one; halves of the mass.
  const double xx = 0.5 * (4.0 / 12 + 1.0 / 12) + 0.0625, yy = 0.5 * (1.0 / 12 + 4.0 / 12) + 0.5625,
               zz = 0.25 / 12;
  expect_near(p.moments, {yy + zz, xx + zz, xx + yy});
  expect_near(p.products, {0.25 * 0.75, 0, 0});  // -E[(x-cx)(y-cy)] = 0.25 * 0.75
}

TEST(MassProperties, OfATorusConvergesToPappus) {
  // Major radius R, minor r: V = 2 pi^2 R r^2, izz = R^2 + 3/4 r^2. A profile of n and a turn of m corners:
  // relative error of each (inscribed polygons) at most (2 pi)^2/6 (1/n^2 + 1/m^2) in area, twice that in the
  // second moments.
  const double R = 2, r = 0.5;
  const std::uint32_t n = 128, m = 256;
  TriangleMesh torus;
  for (std::uint32_t i = 0; i < m; ++i)
    for (std::uint32_t k = 0; k < n; ++k) {
      const math::SinCos a = math::sincos(math::tau * i / m), b = math::sincos(math::tau * k / n);
      torus.vertices.push_back({(R + r * b.cos) * a.cos, (R + r * b.cos) * a.sin, r * b.sin});
      const std::uint32_t i2 = (i + 1) % m, k2 = (k + 1) % n;
      torus.triangles.push_back({i * n + k, i2 * n + k, i2 * n + k2});
      torus.triangles.push_back({i * n + k, i2 * n + k2, i * n + k2});
    }
  EXPECT_TRUE(is_closed(torus));
  const MassProperties p = mass_properties(torus);
  const double error = math::tau * math::tau / 6 * (1.0 / (n * n) + 1.0 / (m * m));
  const double volume = 2 * math::pi * math::pi * R * r * r;
  EXPECT_NEAR(p.volume_m3, volume, error * volume);
  EXPECT_NEAR(p.moments.z, R * R + 0.75 * r * r, 2 * error * R * R);
  EXPECT_NEAR(p.moments.x, 0.5 * R * R + 0.625 * r * r, 2 * error * R * R);
}

TEST(Tessellate, RoundShapesConvergeToTheirClosedForms) {
  // Inscribed: always too small, by at most (2 pi / n)^2 / 2 per round direction.
  for (const Shape& shape : {Shape{Ellipsoid{{1, 0.5, 2}}}, Shape{Sphere{0.7}}, Shape{Cylinder{0.3, 2}},
                             Shape{Capsule{0.3, 1}}, Shape{Cone{0.5, 1.2}}}) {
    SCOPED_TRACE(shape_name(shape));
    for (const int n : {16, 64, 256}) {
      const TriangleMesh mesh = tessellate(shape, n);
      EXPECT_TRUE(is_closed(mesh));
      const MassProperties p = mass_properties(mesh), exact = mass_properties(shape);
      const double error = math::tau * math::tau / (n * n);
      EXPECT_LT(p.volume_m3, exact.volume_m3);
      EXPECT_NEAR(p.volume_m3, exact.volume_m3, error * exact.volume_m3);
      expect_near(p.centre_m, exact.centre_m, error);
      expect_near(p.moments, exact.moments, 2 * error * norm(exact.moments));
    }
  }
}

TEST(IsClosed, NotWithAHoleATurnedTriangleOrAThirdWall) {
  const TriangleMesh box = tessellate(Box{{1, 1, 1}});
  TriangleMesh open = box, turned = box, three = box;
  open.triangles.pop_back();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  three.vertices.push_back({5, 5, 5});
  three.triangles.push_back({0, 1, 8});
  EXPECT_TRUE(is_closed(box));
  EXPECT_FALSE(is_closed(open));
  EXPECT_FALSE(is_closed(turned));
  EXPECT_FALSE(is_closed(three));
  EXPECT_FALSE(is_closed({}));
}

TEST(IsClosed, VerticesAtEqualPlacesCountAsOne) {
  TriangleMesh soup;  // every triangle with corners of its own, as STL has it; -0 is 0
  const TriangleMesh box = moved(tessellate(Box{{1, 1, 1}}), {0.5, 0.5, 0.5});
  for (const auto& t : box.triangles) {
    const auto n = static_cast<std::uint32_t>(soup.vertices.size());
    for (const std::uint32_t v : t) {
      Vec3 p = box.vertices[v];
      if (p.x == 0 && n % 2 == 0) p.x = -0.0;
      soup.vertices.push_back(p);
    }
    soup.triangles.push_back({n, n + 1, n + 2});
  }
  EXPECT_TRUE(is_closed(soup));
}

TEST(ConvexHull, OfABoxIsTheBoxWhateverLiesInsideOrOnIt) {
  std::vector<Vec3> points;
  for (int x = 0; x <= 4; ++x)
    for (int y = 0; y <= 4; ++y)
      for (int z = 0; z <= 4; ++z) points.push_back({0.25 * x, 0.5 * y, 0.75 * z});
  const TriangleMesh hull = convex_hull(points);
  EXPECT_TRUE(is_closed(hull));
  EXPECT_NEAR(mass_properties(hull).volume_m3, 1 * 2 * 3, 6e-8);  // grid of 1e-9 times the surface
  // Points on edges and faces may be corners of the hull or not; points inside are none.
  for (const Vec3& v : hull.vertices)
    EXPECT_TRUE(v.x == 0 || v.x == 1 || v.y == 0 || v.y == 2 || v.z == 0 || v.z == 3);
}

TEST(ConvexHull, HoldsEveryPointAndTakesItsCornersFromThem) {
  Stream random(1, 1, Purpose::experiment, 7);
  for (int round = 0; round < 40; ++round) {
    std::vector<Vec3> points;
    const int n = 4 + round * 5;
    for (int i = 0; i < n; ++i) {
      Vec3 p = random_point(random);
      if (round % 3 == 1) p = normalised(p);  // all of them corners
      if (round % 3 == 2)
        p = {std::round(4 * p.x), std::round(4 * p.y), std::round(4 * p.z)};  // many in a plane
      points.push_back(p);
    }
    const TriangleMesh hull = convex_hull(points);
    ASSERT_TRUE(is_closed(hull)) << round;
    EXPECT_GT(mass_properties(hull).volume_m3, 0);
    if (round % 3 == 1) { EXPECT_EQ(hull.vertices.size(), points.size()); }
    // Euler: a closed surface without handles has 2 v - 4 triangles.
    EXPECT_EQ(hull.triangles.size(), 2 * hull.vertices.size() - 4);
    for (const auto& [a, b, c] : hull.triangles) {
      const Vec3 normal = normalised(
          cross(hull.vertices[b] - hull.vertices[a], hull.vertices[c] - hull.vertices[a]));
      for (const Vec3& p : points) EXPECT_LE(dot(normal, p - hull.vertices[a]), 1e-6) << round;
    }
  }
}

TEST(ConvexHull, OfWhatLiesInAPlaneALineOrAPointIsEmpty) {
  const Vec3 u = normalised(Vec3{1, 2, 3}), v = normalised(Vec3{-2, 1, 0});
  Stream random(1, 1, Purpose::experiment, 8);
  std::vector<Vec3> axis_plane, slanted_plane, line;
  for (int i = 0; i < 100; ++i) {
    const double a = random.uniform(-1, 1), b = random.uniform(-1, 1);
    axis_plane.push_back({a, b, 7});
    slanted_plane.push_back(a * u + b * v);
    line.push_back(std::round(64 * a) * Vec3{1, 2, 3});
  }
  EXPECT_TRUE(convex_hull(axis_plane).triangles.empty());
  EXPECT_TRUE(convex_hull(slanted_plane).triangles.empty());
  EXPECT_TRUE(convex_hull(line).triangles.empty());
  EXPECT_TRUE(convex_hull({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}).triangles.empty());
  EXPECT_TRUE(convex_hull({}).triangles.empty());
  EXPECT_TRUE(convex_hull({u, v, {0, 0, 0}}).triangles.empty());
  EXPECT_TRUE(convex_hull({u, v, {0, 0, 0}, {NAN, 0, 0}}).triangles.empty());
}

TEST(ConvexHull, RepeatsAndOrderOfPointsDoNotChangeTheSolid) {
  Stream random(1, 1, Purpose::experiment, 9);
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i) points.push_back(random_point(random));
  const double volume = mass_properties(convex_hull(points)).volume_m3;
  std::vector<Vec3> others(points.rbegin(), points.rend());
  others.insert(others.end(), points.begin(), points.end());
  EXPECT_NEAR(mass_properties(convex_hull(others)).volume_m3, volume, 1e-8);
  const TriangleMesh a = convex_hull(points), b = convex_hull(points);
  EXPECT_EQ(a.triangles, b.triangles);
}

TEST(ConnectedParts, LargestSurfaceFirstWithTheirLooks) {
  TriangleMesh mesh = joined(
      joined(tessellate(Box{{1, 1, 1}}), moved(tessellate(Box{{3, 3, 3}}), {10, 0, 0})),
      moved(tessellate(Box{{1, 1, 2}}), {-10, 0, 0}));
  mesh.parts = {
      {"a", 0, 12, {1, 0, 0, 1}, ""}, {"b", 12, 18, {0, 1, 0, 1}, ""}, {"c", 30, 6, {0, 0, 1, 1}, ""}};
  const auto parts = connected_parts(mesh);
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_NEAR(mass_properties(parts[0]).volume_m3, 27, 27 * eps);
  EXPECT_NEAR(mass_properties(parts[1]).volume_m3, 2, 10 * eps);
  EXPECT_NEAR(mass_properties(parts[2]).volume_m3, 1, eps);
  ASSERT_EQ(parts[1].parts.size(), 2u);  // the third box was half of part b, half of c
  EXPECT_EQ(parts[1].parts[0].name, "b");
  EXPECT_EQ(parts[1].parts[0].triangles, 6u);
  EXPECT_EQ(parts[1].parts[1].name, "c");
  EXPECT_EQ(parts[1].parts[1].first_triangle, 6u);
  EXPECT_EQ(parts[2].parts.size(), 1u);
}

TEST(Extrude, AreaTimesHeightForOutlinesInEitherSenseWithHoles) {
  const Loop2 square{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, hole{{1, 1}, {2, 1}, {2, 2}, {1, 2}},
      other{{3, 1}, {3.5, 2}, {3, 3}, {2.5, 2}};
  for (const bool turn_outline : {false, true})
    for (const bool turn_hole : {false, true}) {
      Loop2 outline = square, inner = hole;
      if (turn_outline) std::reverse(outline.begin(), outline.end());
      if (turn_hole) std::reverse(inner.begin(), inner.end());
      const TriangleMesh mesh = extrude({outline, inner, other}, 0.5);
      EXPECT_TRUE(is_closed(mesh));
      EXPECT_NEAR(mass_properties(mesh).volume_m3, (16 - 1 - 1) * 0.5, 10 * eps);
    }
}

TEST(Extrude, StarsCombsAndCornersInStraightSides) {
  Loop2 star, comb{{0, 0}, {20, 0}};
  for (int i = 0; i < 40; ++i) {
    const math::SinCos a = math::sincos(math::tau * i / 40);
    const double radius = i % 2 == 0 ? 1 : 0.2;
    star.push_back({radius * a.cos, radius * a.sin});
  }
  for (int i = 19; i >= 0; --i) {
    comb.push_back({i + 1.0, i % 2 == 0 ? 1.0 : 5.0});
    comb.push_back({i + 0.0, i % 2 == 0 ? 1.0 : 5.0});
  }
  // 40 triangles from the middle: area of each 1/2 * 1 * 0.2 * sin(9 deg).
  const double star_area = 40 * 0.5 * 0.2 * math::sin(math::tau / 40);
  EXPECT_NEAR(mass_properties(extrude({star}, 1)).volume_m3, star_area, 100 * eps);
  EXPECT_TRUE(is_closed(extrude({star}, 1)));
  EXPECT_NEAR(mass_properties(extrude({comb}, 2)).volume_m3, 2 * (10 * 1 + 10 * 5), 1000 * eps);
  EXPECT_TRUE(is_closed(extrude({comb}, 2)));
  // Repeated points are one; the last may repeat the first.
  const TriangleMesh straight = extrude(
      {{{0, 0}, {0.5, 0}, {1, 0}, {1, 0}, {1, 1}, {0.5, 1}, {0, 1}, {0, 0}}}, 1);
  EXPECT_EQ(straight.vertices.size(), 12u);
  EXPECT_TRUE(is_closed(straight));
  EXPECT_NEAR(mass_properties(straight).volume_m3, 1, eps);
}

TEST(Extrude, ManyHolesInAGrid) {
  std::vector<Loop2> loops{{{0, 0}, {20, 0}, {20, 20}, {0, 20}}};
  for (int i = 0; i < 9; ++i)
    for (int k = 0; k < 9; ++k) {
      const double x = 1 + 2 * i, y = 1 + 2 * k;
      loops.push_back({{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}});
    }
  const TriangleMesh mesh = extrude(loops, 1);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_NEAR(mass_properties(mesh).volume_m3, 400 - 81, 1e-9);
}

TEST(Extrude, EmptyForLoopsThatAreNoOutline) {
  const Loop2 square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  EXPECT_TRUE(extrude({{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, 1).triangles.empty());          // crosses itself
  EXPECT_TRUE(extrude({{{0, 0}, {1, 0}, {2, 0}}}, 1).triangles.empty());                  // no area
  EXPECT_TRUE(extrude({{{0, 0}, {2, 0}, {2, 2}, {1, 0}, {0, 2}}}, 1).triangles.empty());  // touches itself
  EXPECT_TRUE(extrude({{{0, 0}, {2, 0}, {1, 0}, {1, 1}}}, 1).triangles.empty());          // runs back
  EXPECT_TRUE(extrude({square, {{5, 5}, {6, 5}, {6, 6}}}, 1).triangles.empty());          // hole outside
  EXPECT_TRUE(extrude({square, {{0.5, 0.5}, {2, 0.5}, {2, 0.8}}}, 1).triangles.empty());  // hole sticks out
  EXPECT_TRUE(extrude({square}, 0).triangles.empty());
  EXPECT_TRUE(extrude({square}, -1).triangles.empty());
  EXPECT_TRUE(extrude({square}, NAN).triangles.empty());
  EXPECT_TRUE(extrude({{{0, 0}, {1, 0}, {NAN, 1}}}, 1).triangles.empty());
  EXPECT_TRUE(extrude({}, 1).triangles.empty());
  EXPECT_TRUE(extrude({Loop2(5000, {0, 0})}, 1).triangles.empty());
}

/// 3 x 2 samples over 4 m x 1 m.
HeightGrid slope() { return {3, 2, 4, 1, {0, 1, 3, 0, 2, 3}, ""}; }

TEST(HeightGrid, HeightsByHandOnCornersDiagonalsAndOutside) {
  const HeightGrid g = slope();  // columns at x = -2 0 2, rows at y = -0.5 0.5
  EXPECT_DOUBLE_EQ(height_at(g, -2, -0.5), 0);
  EXPECT_DOUBLE_EQ(height_at(g, 0, -0.5), 1);
  EXPECT_DOUBLE_EQ(height_at(g, 0, 0.5), 2);
  EXPECT_DOUBLE_EQ(height_at(g, 2, 0.5), 3);
  EXPECT_DOUBLE_EQ(height_at(g, -1, 0), 1);         // middle of the diagonal 0..2
  EXPECT_DOUBLE_EQ(height_at(g, -0.5, -0.25), 1);   // lower triangle 0 1 2: 0.75 * 1 + 0.25 * 1
  EXPECT_DOUBLE_EQ(height_at(g, -1.5, 0.25), 0.5);  // upper triangle 0 0 2: u = 0.25, slope 2
  EXPECT_DOUBLE_EQ(height_at(g, -9, -9), 0);
  EXPECT_DOUBLE_EQ(height_at(g, 9, 9), 3);
  expect_near(normal_at(g, -0.5, -0.25), normalised(Vec3{-0.5, -1, 1}));
  expect_near(normal_at(g, -1.5, 0.25), normalised(Vec3{-1, 0, 1}));
}

TEST(HeightGrid, ItsTrianglesAreTheSurfaceThatHeightAtTells) {
  const auto grid = std::make_shared<const HeightGrid>(slope());
  const TriangleMesh mesh = tessellate(Heightfield{grid});
  ASSERT_EQ(mesh.triangles.size(), 4u);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 middle = (mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3;
    EXPECT_NEAR(height_at(*grid, middle.x, middle.y), middle.z, eps);
    const Vec3 normal = normalised(
        cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]));
    expect_near(normal_at(*grid, middle.x, middle.y), normal);
  }
}

}  // namespace
}  // namespace sandlot::mesh_test
