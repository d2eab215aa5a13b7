/// Cones, ellipsoids, meshes and terrain as rays see them: against closed forms, against each other, and
/// against height_at().
#include <gtest/gtest.h>

#include "base/math.h"
#include "base/random.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "optics/ray_scene.h"

namespace sandlot::shapes_test {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();
constexpr double eps_m = 10 * 3 * 6e-8;  ///< of a float distance of about 10 m, three operations deep

struct World {
  RayScene scene;
  SceneFrame frame{0, 0, std::vector<Pose>(4)};
  explicit World(std::vector<SceneShape> shapes) {
    scene.set_shapes(shapes);
    scene.update(frame);
  }
  float see(Vec3 from, Vec3 to, std::uint32_t ignore = no_body, std::uint32_t* body = nullptr,
            double min_m = 0, double max_m = 1000) const {
    const Vec3 d = normalised(to - from);
    float distance = -1;
    std::uint32_t hit = 12345;
    RayJob job{{from, {}}, {&d, 1}, min_m, max_m, ignore, {&distance, 1}, {&hit, 1}};
    scene.cast({&job, 1});
    if (body) *body = hit;
    return distance;
  }
};

SceneShape at(const Shape& shape, Vec3 p, std::uint32_t body = 0, Quat q = {}, bool moves = false) {
  return {0, {p, q}, shape, body, moves};
}
Shape mesh_of(const Shape& shape, int segments = 32) {
  return Mesh{std::make_shared<const TriangleMesh>(tessellate(shape, segments))};
}

TEST(RayShapes, AConeIsWideBelowAndSharpAbove) {
  // Radius 1 at z = 0, apex at z = 2: at height z the radius is 1 - z / 2.
  const World world({at(Cone{1, 2}, {5, 0, 1})});
  for (const double z : {0.01, 0.5, 1.0, 1.5, 1.99}) {
    EXPECT_NEAR(world.see({0, 0, z}, {5, 0, z}), 5 - (1 - z / 2), 2 * eps_m) << z;
    EXPECT_NEAR(world.see({5, 0, z}, {9, 0, z}), 1 - z / 2, 2 * eps_m) << z;  // from inside
  }
  const double y = 0.3, z = 1;  // off the axis: half the chord of the circle of radius 1/2
  EXPECT_NEAR(world.see({0, y, z}, {1, y, z}), 5 - std::sqrt(0.25 - y * y), 4 * eps_m);
  EXPECT_EQ(world.see({0, 0, 2.001}, {5, 0, 2.001}), inf);  // over the apex, where the double cone goes on
  EXPECT_EQ(world.see({0, 0, 3}, {5, 0, 3}), inf);
  EXPECT_EQ(world.see({0, 0, -0.001}, {5, 0, -0.001}), inf);
  EXPECT_NEAR(world.see({5, 0, 9}, {5, 0, 0}), 7, eps_m);              // down on the apex
  EXPECT_NEAR(world.see({5.5, 0, 9}, {5.5, 0, 0}), 8, 4 * eps_m);      // down on the mantle
  EXPECT_NEAR(world.see({5.5, 0, -4}, {5.5, 0, 0}), 4, eps_m);         // up on the base
  EXPECT_NEAR(world.see({5.5, 0, 0.2}, {5.5, 0, 5}), 0.8, 4 * eps_m);  // from inside up
  EXPECT_NEAR(world.see({5, 0, 0.2}, {5, 0, 5}), 1.8, eps_m);
  EXPECT_EQ(world.see({6.01, 0, 9}, {6.01, 0, 0}), inf);
  // Parallel to the mantle's line from (4, 0, 0) to (5, 0, 2), half a metre to its right: through the base
  // and out where the right line x = 6 - z/2 is met: x = 4.5 + z/2, so z = 1.5.
  EXPECT_NEAR(world.see({4, 0, -1}, {4.5, 0, 0}), std::sqrt(1.25), 4 * eps_m);
  EXPECT_NEAR(world.see({4.75, 0, 0.5}, {5.25, 0, 1.5}), std::sqrt(1.25), 4 * eps_m);
  EXPECT_EQ(world.see({3, 0, -1}, {3.5, 0, 0}), inf);  // the parallel on the outside
}

TEST(RayShapes, AnEllipsoidIsAScaledBall) {
  const World world({at(Ellipsoid{{1, 2, 0.5}}, {5, 0, 0})});
  EXPECT_NEAR(world.see({}, {1, 0, 0}), 4, eps_m);
  EXPECT_NEAR(world.see({5, 0, 0}, {5, 1, 0}), 2, eps_m);
  EXPECT_NEAR(world.see({5, 0, 3}, {5, 0, 0}), 2.5, eps_m);
  // x^2 + (y/2)^2 + (2z)^2 = 1 at y = 1.2, z = 0: x = 0.8.
  EXPECT_NEAR(world.see({0, 1.2, 0}, {1, 1.2, 0}), 4.2, 4 * eps_m);
  EXPECT_EQ(world.see({0, 0, 0.501}, {1, 0, 0.501}), inf);
  EXPECT_EQ(world.see({0, 2.001, 0}, {1, 2.001, 0}), inf);
  EXPECT_LT(world.see({0, 1.999, 0}, {1, 1.999, 0}), inf);
}

Vec3 random_direction(Stream& r) {
  const double x = r.normal(), y = r.normal(), z = r.normal();
  return normalised(Vec3{x, y, z});
}

/// A solid and its inscribed tessellation differ by less than `bulge_m` across the surface, so a ray that
/// meets the solid at an angle with cosine c differs by bulge_m / c; silhouettes are left out by c > 0.2.
void compare(const Shape& exact, double bulge_m, std::uint64_t sample) {
  Stream r(5, entity_key("shapes"), Purpose::experiment, sample);
  const Vec3 axis = random_direction(r);
  const Quat q = quat_from_axis_angle(axis, 6 * r.uniform());
  const World solid({at(exact, {1, 2, 3}, 0, q)}), mesh({at(mesh_of(exact, 128), {1, 2, 3}, 0, q)});
  int hits = 0, misses = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 from = Vec3{1, 2, 3} + 6 * random_direction(r);
    const Vec3 aim = Vec3{1, 2, 3} + 1.5 * r.uniform() * random_direction(r);
    const Vec3 d = normalised(aim - from);
    const float a = solid.see(from, from + d), b = mesh.see(from, from + d);
    if (a == inf || b == inf) {
      misses += a == b;
      continue;
    }
    // Slope of the distance, from a neighbouring ray.
    const Vec3 side = 1e-3 * normalised(cross(d, Vec3{d.z, d.x, -d.y}));
    const float beside = solid.see(from + side, from + side + d),
                above = solid.see(from + cross(d, side), from + cross(d, side) + d);
    const double steep = norm(Vec3{beside - a, above - a, 0}) / 1e-3;
    if (!(steep < 5)) continue;
    EXPECT_NEAR(a, b, 2 * bulge_m * std::sqrt(1 + steep * steep) + 3 * eps_m) << i;
    ++hits;
  }
  EXPECT_GT(hits, 700);
  EXPECT_GT(misses, 200);
}

TEST(RayShapes, SolidsAndTheirTessellationsAgree) {
  // The sagitta of a 128-gon: r (1 - cos(pi / 128)) = 3.0e-4 r.
  compare(Cone{1, 2}, 3.1e-4, 0);
  compare(Cone{0.3, 2.5}, 3.1e-4, 1);
  compare(Ellipsoid{{1, 1.6, 0.4}}, 2 * 3.1e-4 * 1.6, 2);
  compare(Box{{1, 2, 0.5}}, 0, 3);
  compare(Cylinder{0.7, 1.5}, 3.1e-4, 4);
}

TEST(RayShapes, TrianglesAreSeenFromBothSidesAndTiesGoToTheSmallerBody) {
  TriangleMesh square;
  square.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Shape sheet = Mesh{std::make_shared<const TriangleMesh>(square)};
  for (const bool first : {false, true}) {
    // Two sheets at one place, and a box below.
    std::vector<SceneShape> shapes{at(sheet, {0, 0, 1}, 5), at(sheet, {0, 0, 1}, 3),
                                   at(Box{{2, 2, 1.9}}, {0, 0, -0.05}, 4)};
    if (first) std::reverse(shapes.begin(), shapes.end());
    const World world(shapes);
    std::uint32_t body = 0;
    EXPECT_FLOAT_EQ(world.see({0.2, 0.3, 3}, {0.2, 0.3, 0}, no_body, &body), 2);
    EXPECT_EQ(body, 3u);
    EXPECT_FLOAT_EQ(world.see({0.2, 0.3, 3}, {0.2, 0.3, 0}, 3, &body), 2);
    EXPECT_EQ(body, 5u);
    // Through the middle, where the two triangles of the sheet meet, and from below.
    EXPECT_FLOAT_EQ(world.see({0, 0, 3}, {0, 0, 0}, no_body, &body), 2);
    EXPECT_EQ(body, 3u);
    EXPECT_FLOAT_EQ(world.see({0.5, 0.2, 0}, {0.5, 0.2, 2}, 4, &body), 1);
    EXPECT_EQ(body, 3u);
    EXPECT_EQ(world.see({0.5, 0.2, 3}, {0.5, 0.2, 0}, no_body, &body, 0, 1.9), inf);
    EXPECT_FLOAT_EQ(world.see({0.5, 0.2, 3}, {0.5, 0.2, 0}, no_body, &body, 2.2), 4);  // the box's floor
    EXPECT_EQ(body, 4u);
  }
}

TEST(RayShapes, AMeshFarFromTheOriginIsAsSharpAsOneBeside) {
  const World world({at(mesh_of(Box{{2, 2, 2}}), {1e5, -1e5, 0})});
  EXPECT_NEAR(world.see({1e5 - 5, -1e5 + 0.25, 0.125}, {1e5, -1e5 + 0.25, 0.125}), 4, eps_m);
  // And one whose vertices lie far from its frame.
  TriangleMesh away = tessellate(Box{{2, 2, 2}});
  for (Vec3& v : away.vertices) v += Vec3{1e5, 0, 0};
  const World other({at(Mesh{std::make_shared<const TriangleMesh>(away)}, {-1e5, 0, 0})});
  EXPECT_NEAR(other.see({-5, 0.25, 0.125}, {0, 0.25, 0.125}), 4, eps_m);
}

HeightGrid random_grid(int columns, int rows) {
  HeightGrid grid{columns, rows, 6, 4, {}, {}};
  Stream r(6, entity_key("grid"), Purpose::experiment, 0);
  for (int i = 0; i < columns * rows; ++i) grid.height_m.push_back(static_cast<float>(r.uniform()));
  return grid;
}

TEST(RayShapes, RaysMeetTerrainAtItsHeight) {
  // Steep noise on purpose: the wrong diagonal of a cell would show as decimetres.
  const auto grid = std::make_shared<const HeightGrid>(random_grid(31, 17));
  const World world({at(Heightfield{grid}, {10, 20, 0.5}, 2)});
  Stream r(7, entity_key("terrain"), Purpose::experiment, 0);
  for (int i = 0; i < 2000; ++i) {
    const double x = 5.98 * (r.uniform() - 0.5), y = 3.98 * (r.uniform() - 0.5);
    const double expected = 5 - (0.5 + height_at(*grid, x, y));
    // Slopes reach 5 to 7: coordinates rounded to 2e-7 m show as up to 2e-6 m.
    EXPECT_NEAR(world.see({10 + x, 20 + y, 5}, {10 + x, 20 + y, 0}), expected, 4e-6) << x << " " << y;
  }
  EXPECT_EQ(world.see({13.01, 20, 5}, {13.01, 20, 0}), inf);
  EXPECT_EQ(world.see({10, 22.01, 5}, {10, 22.01, 0}), inf);
  // A level ray ends where the surface first passes through its height: found by steps along it.
  for (const double y : {-1.3, 0.1, 1.7}) {
    double x = -3;
    const bool above = 0.5 + height_at(*grid, x, y) > 1.2;
    while ((0.5 + height_at(*grid, x, y) > 1.2) == above) x += 1e-5;
    EXPECT_NEAR(world.see({6, 20 + y, 1.2}, {16, 20 + y, 1.2}), 4 + x, 2e-5) << y;
  }
}

TEST(RayShapes, TrianglesAreMetWhereIeeeDivisionSaysOnAnyProcessor) {
  // Flat, with corners at powers of two: all but one division is exact. Estimates of reciprocals, which
  // differ from processor to processor, would show in the last bit of many.
  const auto square = std::make_shared<const TriangleMesh>(TriangleMesh{
      .vertices = {{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}}, .triangles = {{0, 1, 2}, {0, 2, 3}}});
  const auto flat = std::make_shared<const HeightGrid>(HeightGrid{5, 5, 8, 8, std::vector<float>(25), {}});
  for (const Shape& shape : {Shape(Mesh{square}), Shape(Heightfield{flat})}) {
    const World world({at(shape, {})});
    Stream r(9, entity_key("division"), Purpose::experiment, 0);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 from{0.1, 0.2, 1.1}, to{7 * (r.uniform() - 0.5), 7 * (r.uniform() - 0.5), 0};
      const auto down = static_cast<float>(-normalised(to - from).z);
      EXPECT_EQ(world.see(from, to), 1.1f / down) << to.x << " " << to.y;
    }
  }
}

TEST(RayShapes, SharedMeshesAnswerAsTheirOwnAndRaysDoNotSeeTheirPacket) {
  Stream r(8, entity_key("shapes"), Purpose::experiment, 0);
  const Shape ball = mesh_of(Sphere{0.5}, 24);
  const Shape shapes[] = {ball, Cone{0.4, 1}, Ellipsoid{{0.2, 0.5, 0.7}}, mesh_of(Box{{0.5, 0.9, 0.4}}),
                          Heightfield{std::make_shared<const HeightGrid>(random_grid(9, 9))}};
  std::vector<SceneShape> world;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const Vec3 p = 5 * r.uniform() * random_direction(r);
    const Quat q = quat_from_axis_angle(random_direction(r), i);
    world.push_back({i % 3, {p, q}, shapes[i % 5], i, i % 3 != 0});
  }
  RayScene scene;
  scene.set_shapes(world);
  SceneFrame frame{0, 0, {Pose{}, Pose{{0.1, 0, 0}, {}}, Pose{}}};
  scene.update(frame);
  std::vector<Vec3> directions(800);
  for (Vec3& d : directions) d = random_direction(r);
  const auto cast = [&](const RayScene& of, std::size_t first, std::size_t count, std::vector<float>& out) {
    const RayJob job{{{0.3, 0.2, 0.1}, {}},
                     std::span(directions).subspan(first, count),
                     0,
                     30,
                     no_body,
                     std::span(out).subspan(first, count),
                     {}};
    of.cast({&job, 1});
  };
  std::vector<float> together(800), apart(800), again(800);
  cast(scene, 0, 800, together);
  for (std::size_t i = 800; i-- > 0;) cast(scene, i, 1, apart);
  EXPECT_EQ(together, apart);
  // Another revision keeps the trees; each shape with a mesh of its own sees the same.
  for (SceneShape& s : world)
    if (const auto* m = std::get_if<Mesh>(&s.shape))
      s.shape = Mesh{std::make_shared<const TriangleMesh>(*m->mesh)};
  RayScene other;
  other.set_shapes(world);
  other.update(frame);
  cast(other, 0, 800, again);
  EXPECT_EQ(together, again);
  scene.set_shapes(std::span(world).first(50));
  scene.update(frame);
  scene.set_shapes(world);
  scene.update(frame);
  cast(scene, 0, 800, again);
  EXPECT_EQ(together, again);
}

}  // namespace
}  // namespace sandlot::shapes_test
