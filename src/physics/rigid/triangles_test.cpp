/// Terrain, meshes, cones and ellipsoids against formulas and against the primitives they imitate.
#include "physics/rigid/triangles.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "geometry/height_grid.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid::triangles_test {
namespace {

using namespace test;

constexpr double g = 9.81, h = 0.005;

Shape mesh_of(const Shape& shape, int segments = 32) {
  return Mesh{std::make_shared<const TriangleMesh>(tessellate(shape, segments))};
}
/// z = slope * x + across * y over 40 m x 20 m.
Shape slope_grid(double slope, double across = 0) {
  HeightGrid grid{41, 11, 40, 20, {}, {}};
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      grid.height_m.push_back(static_cast<float>(slope * (column * grid.cell_x_m() - 20) +
                                                 across * (row * grid.cell_y_m() - 10)));
  return Heightfield{std::make_shared<const HeightGrid>(grid)};
}
/// The same surface as a mesh.
Shape slope_mesh(double slope) { return mesh_of(slope_grid(slope)); }

model::Surface sticky() {
  model::Surface s;
  s.mu = s.mu2 = 1;
  return s;
}

struct OnSlope : ::testing::TestWithParam<bool> {
  Shape slope(double rise) const { return GetParam() ? slope_mesh(rise) : slope_grid(rise); }
};

TEST_P(OnSlope, BodiesRestAtTheHeightWorkedOutByHand) {
  const double rise = 0.1, c = 1 / std::sqrt(1 + rise * rise);  // cosine of the slope
  World world(rigid::engine);
  world.add(static_of("slope", slope(rise)));
  const Quat tilt = quat_from_axis_angle({0, 1, 0}, -math::atan2(rise, 1));
  const auto centre = [&](double x, double y, double above) {
    return Vec3{x - above * rise * c, y, rise * x + above * c};  // `above` the slope along its normal
  };
  const InstanceId box = world.add(body_of("box", Box{{0.4, 0.3, 0.2}}, 3, {centre(1.3, 0.7, 0.1), tilt}));
  const InstanceId can = world.add(body_of("can", Cylinder{0.15, 0.3}, 3, {centre(-2.3, 1.2, 0.15), tilt}));
  const InstanceId cone = world.add(body_of("cone", Cone{0.2, 0.3}, 3, {centre(3.4, -1.3, 0.15), tilt}));
  const InstanceId mesh = world.add(
      body_of("mesh", mesh_of(Box{{0.4, 0.3, 0.2}}), 3, {centre(5.6, 2.2, 0.1), tilt}));
  world.run(400, h);
  // Contacts give way by the depth that carries the weight (CFM 1e-6, ERP 0.2): far below a millimetre.
  for (const auto& [id, above] : {std::pair{box, 0.1}, {can, 0.15}, {cone, 0.15}, {mesh, 0.1}}) {
    const Vec3 p = world.state(id).X_WB.p;
    EXPECT_NEAR((p.z - rise * p.x) * c, above, 5e-4) << id.index;
    EXPECT_LT(norm(world.state(id).V_WB.linear), 0.02) << id.index;
    EXPECT_GT(rotate(world.state(id).X_WB.q, {0, 0, 1}).z, c - 1e-3) << id.index;
  }
  // Held by friction: tan(slope) = 0.1 < mu = 1.
  EXPECT_NEAR(world.state(box).X_WB.p.x, centre(1.3, 0.7, 0.1).x, 0.01);
}

TEST_P(OnSlope, ABallRollsDownWithFiveSeventhsOfTheSlide) {
  const double rise = 0.1, sine = rise / std::sqrt(1 + rise * rise);
  World world(rigid::engine);
  world.add(static_of("slope", slope(rise), {}, sticky()));
  const double r = 0.2;
  // Just off the lines of the grid, along x.
  const InstanceId ball = world.add(
      body_of("ball", Sphere{r}, 1, {{10.4, 0.37, 1.04 + r * std::sqrt(1 + rise * rise)}, {}}, sticky()));
  world.run(400, h);
  const double t = 400 * h, a = 5.0 / 7 * g * sine;
  const BodyState& s = world.state(ball);
  // Over 13 edges between triangles; semi-implicit Euler is ahead by a h / 2 t.
  EXPECT_NEAR(norm(s.V_WB.linear), a * t, 0.01 * a * t);
  EXPECT_NEAR(10.4 - s.X_WB.p.x, 0.5 * a * t * t / std::sqrt(1 + rise * rise), 0.02 * 0.5 * a * t * t);
  EXPECT_NEAR(norm(s.V_WB.angular), norm(s.V_WB.linear) / r, 0.02 * a * t / r);
  EXPECT_NEAR(s.X_WB.p.y, 0.37, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, OnSlope, ::testing::Values(false, true),
                         [](const auto& suite) { return suite.param ? "mesh" : "terrain"; });

TEST(Terrain, ASphereRestsOnTheSurfaceThatHeightAtSays) {
  // One cell, turned and raised: its two triangles have slopes of their own.
  HeightGrid grid{2, 2, 4, 4, {0, 0.4f, 0.1f, 0.0f}, {}};
  const Shape field = Heightfield{std::make_shared<const HeightGrid>(grid)};
  const Pose X_WC{{3, -2, 1}, quat_from_rpy(0, 0, 0.7)};
  const model::Surface rough = sticky();
  for (const auto& [x, y] : {std::pair{1.0, -0.5}, {-0.5, 1.0}, {0.2, -1.2}, {-1.4, -0.3}}) {
    World world(rigid::engine, settings({{"sleeping", "false"}}));
    world.add(static_of("field", field, X_WC, rough));
    const Vec3 n = normal_at(grid, x, y);
    const Vec3 p = Vec3{x, y, height_at(grid, x, y)} + 0.1 * n;
    const InstanceId ball = world.add(body_of("ball", Sphere{0.1}, 1, {X_WC * p, {}}, rough));
    world.run(2, h);
    ASSERT_GE(world.engine->contacts().size(), 1u) << x << " " << y;
    const Vec3 n_W = rotate(X_WC.q, n);
    EXPECT_NEAR(dot(world.engine->contacts()[0].normal_W, n_W), 1, 1e-6) << x << " " << y;
    // It rolls along the surface: its distance from the triangle's plane is its radius.
    world.run(20, h);
    EXPECT_NEAR(dot(world.state(ball).X_WB.p - X_WC * Vec3{x, y, height_at(grid, x, y)}, n_W), 0.1, 1e-3);
  }
}

TEST(Terrain, StandsStillOrIsRefused) {
  World world(rigid::engine);
  model::Instance moving = static_of("field", slope_grid(0));
  model::Model model = *moving.model;
  model.is_static = false;
  model.links[0].inertial.moments = {1, 1, 1};
  moving.model = std::make_shared<const model::Model>(model);
  const auto made = world.engine->add(moving);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().text().find("heightmap on a body that moves"), std::string::npos)
      << made.error().text();
  TriangleMesh broken = tessellate(Box{{1, 1, 1}});
  broken.triangles[3][1] = 8;
  model::Instance torn = body_of("mesh", Box{{1, 1, 1}}, 1);  // its inertia; no mesh so torn has one
  model = *torn.model;
  model.links[0].collisions[0].shape = Mesh{std::make_shared<const TriangleMesh>(broken)};
  torn.model = std::make_shared<const model::Model>(model);
  EXPECT_FALSE(world.engine->add(torn));
}

/// How far and how high a body slides that starts at 2 m/s.
struct Slide {
  double x, z;
};
Slide slide(const Shape& shape, const Shape& floor) {
  World world(rigid::engine);
  model::Surface s;
  s.mu = s.mu2 = 0.5;
  world.add(static_of("floor", floor, {}, s));
  const InstanceId id = world.add(body_of("body", shape, 2, {{0.13, 0.21, 0.1}, {}}, s));
  world.push(id, {2 * 2 / h, 0, 0});  // an impulse of 2 kg * 2 m/s
  world.run(300, h);
  const Vec3 p = world.state(id).X_WB.p;
  return {p.x - 0.13, p.z};
}

TEST(Mesh, ABoxOfTrianglesIsABox) {
  // v^2 / (2 mu g) = 0.408 m
  const Shape box = Box{{0.4, 0.3, 0.2}}, plane = Plane{{0, 0, 1}};
  const Shape floor = mesh_of(Box{{6, 6, 1}});
  for (const auto& [shape, under] :
       {std::pair{box, plane}, {mesh_of(box), plane}, {box, slope_mesh(0)}, {mesh_of(box), slope_grid(0)}}) {
    const Slide s = slide(shape, under);
    EXPECT_NEAR(s.x, 4 / (2 * 0.5 * g), 0.012) << shape_name(shape) << " on " << shape_name(under);
    EXPECT_NEAR(s.z, 0.1, 5e-4) << shape_name(shape) << " on " << shape_name(under);
  }
}

TEST(Mesh, MeshesStandOnMeshes) {
  World world(rigid::engine);
  world.add(static_of("floor", mesh_of(Box{{4, 4, 1}}), {{0, 0, -0.5}, {}}));
  const Shape box = mesh_of(Box{{0.4, 0.4, 0.2}});
  const InstanceId low = world.add(body_of("low", box, 2, {{0.1, 0.2, 0.1}, {}}));
  const InstanceId high = world.add(body_of("high", box, 2, {{0.15, 0.22, 0.3}, quat_from_rpy(0, 0, 0.3)}));
  world.run(400, h);
  EXPECT_NEAR(world.state(low).X_WB.p.z, 0.1, 2e-3);
  EXPECT_NEAR(world.state(high).X_WB.p.z, 0.3, 4e-3);
  EXPECT_NEAR(world.state(high).X_WB.p.x, 0.15, 0.02);
  EXPECT_GT(rotate(world.state(high).X_WB.q, {0, 0, 1}).z, 0.999);
}

TEST(RoundShapes, AConeStandsOnItsBaseAndAnEllipsoidLiesOnItsShortAxis) {
  for (const Shape& floor :
       {Shape(Plane{{0, 0, 1}}), slope_mesh(0), slope_grid(0), Shape(Box{{30, 30, 2}})}) {
    const double top = std::holds_alternative<Box>(floor) ? 1 : 0;
    World world(rigid::engine);
    world.add(static_of("floor", floor));
    const InstanceId cone = world.add(body_of("cone", Cone{0.2, 0.4}, 2, {{0.3, 0.2, top + 0.21}, {}}));
    const InstanceId egg = world.add(
        body_of("egg", Ellipsoid{{0.3, 0.25, 0.1}}, 2, {{2.3, 0.2, top + 0.12}, quat_from_rpy(0.1, 0, 0)}));
    world.run(2400, h);
    EXPECT_NEAR(world.state(cone).X_WB.p.z - top, 0.2, 5e-4) << shape_name(floor);
    EXPECT_GT(rotate(world.state(cone).X_WB.q, {0, 0, 1}).z, 0.9999) << shape_name(floor);
    // 0.22 % of the radius for tessellation, and it may still rock a little: 0.1 + 0.05 * angle^2.
    EXPECT_NEAR(world.state(egg).X_WB.p.z - top, 0.1, 1.5e-3) << shape_name(floor);
  }
}

TEST(RoundShapes, AnEllipsoidWithEqualRadiiRollsAsABall) {
  const double rise = 0.1, sine = rise / std::sqrt(1 + rise * rise), r = 0.2;
  World world(rigid::engine);
  const Quat tilt = quat_from_axis_angle({0, 1, 0}, -math::atan2(rise, 1));
  world.add(static_of("slope", Plane{{0, 0, 1}}, {{}, tilt}, sticky()));
  const InstanceId ball = world.add(
      body_of("ball", Ellipsoid{{r, r, r}}, 1, {rotate(tilt, {0, 0, r}), {}}, sticky()));
  world.run(400, h);
  EXPECT_NEAR(norm(world.state(ball).V_WB.linear), 5.0 / 7 * g * sine * 400 * h, 1e-3);
}

TEST(RoundShapes, PlaneContactsAreExact) {
  dContactGeom out[8];
  // An ellipsoid turned by a quarter about y, over a tilted plane: its support is sqrt(sum (r_i n_i)^2).
  const Vec3 n = normalised(Vec3{0.3, -0.2, 1});
  const Pose X{{1, 2, 0.5}, quat_from_axis_angle({0, 1, 0}, math::pi / 2)};
  const Vec3 n_C = rotate_inverse(X.q, n);
  const double support = norm(Vec3{0.6 * n_C.x, 0.5 * n_C.y, 0.9 * n_C.z});
  const double offset = dot(n, X.p) - support + 0.01;
  ASSERT_EQ(collide_with_plane(Ellipsoid{{0.6, 0.5, 0.9}}, X, n, offset, out), 1);
  EXPECT_NEAR(out[0].depth, 0.01, 1e-12);
  ASSERT_EQ(collide_with_plane(Ellipsoid{{0.6, 0.5, 0.9}}, X, n, offset - 0.011, out), 0);
  // A cone on its side touches along a line: apex and lowest point of the rim, both 0.01 deep.
  const double half = math::atan2(0.3, 1.2), slant = std::sqrt(0.09 + 1.44);
  const Quat lying = quat_from_axis_angle({0, 1, 0}, math::pi / 2 + half);
  const Pose X_cone{Vec3{0, 0, 5} - rotate(lying, {0, 0, 0.6}), lying};  // its apex at z = 5
  ASSERT_EQ(collide_with_plane(Cone{0.3, 1.2}, X_cone, {0, 0, 1}, 5.01, out), 2);
  EXPECT_NEAR(out[0].depth, 0.01, 1e-9);
  EXPECT_NEAR(out[1].depth, 0.01, 1e-9);
  EXPECT_NEAR(std::abs(out[0].pos[0] - out[1].pos[0]), slant, 1e-9);
}

TEST(ReduceContacts, KeepsTheDeepestAndTheCornersInOrder) {
  std::vector<dContactGeom> points;
  for (int i = 0; i < 25; ++i) {
    dContactGeom p{};
    p.pos[0] = 0.1 * (i % 5), p.pos[1] = 0.1 * (i / 5), p.normal[2] = 1;
    p.depth = i == 12 ? 0.02 : 0.01;
    points.push_back(p);
    p.pos[0] += 1e-6;  // a twin, a little deeper
    p.depth += 1e-3;
    points.push_back(p);
  }
  ASSERT_EQ(reduce_contacts(points, 5, 0.5), 5);
  const double corners[5][2] = {{0, 0}, {0.4, 0}, {0.2, 0.2}, {0, 0.4}, {0.4, 0.4}};
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_NEAR(points[i].pos[0], corners[i][0], 1e-5) << i;
    EXPECT_NEAR(points[i].pos[1], corners[i][1], 1e-5) << i;
    EXPECT_NEAR(points[i].depth, i == 2 ? 0.021 : 0.011, 1e-12);
  }
}

TEST(Restore, WorldsOfTrianglesContinueWithTheSameBits) {
  const Shape ground = slope_mesh(0.05), box = mesh_of(Box{{0.4, 0.3, 0.2}});
  HeightGrid bumps{21, 21, 20, 20, {}, {}};
  for (int i = 0; i < 21 * 21; ++i) bumps.height_m.push_back(static_cast<float>(0.1 * math::sin(i) - 0.3));
  const Shape field = Heightfield{std::make_shared<const HeightGrid>(bumps)};
  const Shape shapes[] = {box,         Cone{0.2, 0.4},     Ellipsoid{{0.3, 0.2, 0.1}},
                          Sphere{0.2}, Cylinder{0.2, 0.3}, Box{{0.3, 0.3, 0.3}}};
  const auto fill = [&](World& world) {
    world.add(static_of("ground", ground));
    world.add(static_of("field", field, {{0, 0, 0.4}, {}}));
    for (int i = 0; i < 12; ++i)
      world.add(body_of("b" + std::to_string(i), shapes[i % 6], 1,
                        {{0.5 * (i % 3), 0.5 * (i / 3), 0.8 + 0.1 * i}, quat_from_rpy(0.3 * i, 0.2, 0)}));
  };
  World first(rigid::engine), second(rigid::engine);
  fill(first);
  first.run(150, h);
  fill(second);
  second.steps = first.steps;
  for (std::size_t i = 0; i < first.ids.size(); ++i)
    ASSERT_TRUE(second.load(second.ids[i], first.bytes(first.ids[i])));
  std::size_t contacts = 0;
  for (int k = 0; k < 100; ++k) {
    first.run(1, h);
    second.run(1, h);
    contacts = std::max(contacts, first.engine->contacts().size());
    for (std::size_t i = 0; i < first.ids.size(); ++i)
      ASSERT_EQ(first.bytes(first.ids[i]), second.bytes(second.ids[i])) << "step " << k << " body " << i;
  }
  EXPECT_GT(contacts, 10u);
  EXPECT_TRUE(first.engine->check_finite());
}

}  // namespace
}  // namespace sandlot::rigid::triangles_test
