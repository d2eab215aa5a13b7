/// Barrels on everything, against places worked out by hand.
#include <gtest/gtest.h>

#include "base/math.h"
#include "geometry/barrel.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/rigid/triangle_tree.h"
#include "physics/test_world.h"

namespace sandlot::rigid {
namespace {

using namespace test;

constexpr Barrel roller{0.01, 0.05, 0.03};
const Quat along_x = quat_from_rpy(0, math::pi / 2, 0);

/// Contacts of a barrel with something that stands; normals point up into the barrel where that lies above.
std::vector<Contact> contacts_of(const Shape& fixed, const Pose& X_WF, const Pose& X_WB,
                                 const Barrel& barrel = roller, double margin_of_time = 1e-6) {
  World world(rigid::engine, {}, {});
  world.add(static_of("fixed", fixed, X_WF));
  world.add(body_of("barrel", barrel, 0.1, X_WB));
  world.run(1, margin_of_time);
  return {world.engine->contacts().begin(), world.engine->contacts().end()};
}

Shape mesh_of(const Shape& shape) {
  return Mesh{std::make_shared<const TriangleMesh>(tessellate(shape, 64))};
}
/// Cells of a centimetre; height `slope` times |x|.
Shape valley(double slope) {
  HeightGrid grid;
  grid.columns = grid.rows = 21;
  grid.size_x_m = grid.size_y_m = 0.2;
  for (int j = 0; j < 21; ++j)
    for (int i = 0; i < 21; ++i) grid.height_m.push_back(static_cast<float>(slope * 0.01 * std::abs(i - 10)));
  return Heightfield{std::make_shared<const HeightGrid>(grid)};
}

struct Ground {
  const char* name;
  Shape shape;
  Pose X;
};
std::vector<Ground> flat_grounds() {
  return {{"plane", Plane{{0, 0, 1}}, {}},
          {"box", Box{{1, 1, 1}}, {{0, 0, -0.5}, {}}},
          {"mesh", mesh_of(Box{{0.9, 1, 1}}), {{0, 0, -0.5}, {}}},
          {"terrain", valley(0), {}}};
}

/// The lowest point of the arc is where its normal points down: profile * sin(lean) along the axis from the
/// middle, and the barrel is one millimetre deep there.
TEST(BarrelContacts, OnFlatGroundIsOnePoint) {
  for (const Ground& g : flat_grounds())
    for (const double lean : {0.0, 0.2}) {
      SCOPED_TRACE(g.name);
      const auto [s, c] = math::sincos(lean);
      // The arc's middle lies (profile - radius) above the barrel's, across its axis.
      const double height = 0.05 - 0.04 * c - 1e-3;
      const Pose X{{0.0333, 0.0012, height}, quat_from_rpy(0, lean, 0) * along_x};
      const auto found = contacts_of(g.shape, g.X, X);
      ASSERT_EQ(found.size(), 1u);
      EXPECT_NEAR(found[0].depth_m, 1e-3, 1e-9);
      EXPECT_NEAR(found[0].normal_W.z, 1, 1e-9);
      EXPECT_NEAR(found[0].point_W.x, 0.0333 + 0.04 * s, 1e-9);
      EXPECT_NEAR(found[0].point_W.y, 0.0012, 1e-9);
    }
}

TEST(BarrelContacts, OnItsFlatEndStandsOnFourPoints) {
  const double end = end_radius_m(roller);
  for (const Ground& g : flat_grounds()) {
    SCOPED_TRACE(g.name);
    const auto found = contacts_of(g.shape, g.X, {{0.0333, 0.0012, 0.0145}, {}});
    ASSERT_EQ(found.size(), 4u);
    for (const Contact& point : found) {
      EXPECT_NEAR(point.depth_m, 5e-4, 1e-9);
      EXPECT_NEAR(norm(point.point_W - Vec3{0.0333, 0.0012, point.point_W.z}), end, 1e-9);
    }
  }
}

TEST(BarrelContacts, OfEdgesPointAwayFromThem) {
  // Its middle right over the edge of a box or mesh (x = 0, ground at x < 0), lying along the edge: the
  // corner of the ground points at the axis from below and from the side, at 45 degrees.
  const double off = (0.01 - 5e-4) / std::sqrt(2.0);
  const Pose X{{off, 0.01, off}, quat_from_rpy(math::pi / 2, 0, 0)};
  for (const bool mesh : {false, true}) {
    const Shape box = Box{{1, 1.2, 1}};
    const auto found = contacts_of(mesh ? mesh_of(box) : box, {{-0.5, 0, -0.5}, {}}, X);
    ASSERT_EQ(found.size(), 1u) << mesh;
    EXPECT_NEAR(found[0].depth_m, 5e-4, 1e-8);
    EXPECT_NEAR(found[0].normal_W.x, std::sqrt(0.5), 1e-4);
    EXPECT_NEAR(found[0].normal_W.z, std::sqrt(0.5), 1e-4);
    EXPECT_NEAR(found[0].point_W.y, 0.01, 1e-5) << "the barrel is thickest there";
  }
}

TEST(BarrelContacts, FeelNoSeamsButBothSidesOfAValley) {
  // Along a flat mesh of small triangles: always one point, straight up.
  const Shape fine = valley(0);
  for (int i = 0; i < 40; ++i) {
    const auto found = contacts_of(
        fine, {}, {{-0.02 + 0.001 * i, 0.0007 * i, 0.0099}, quat_from_rpy(0, 0, 0.1 * i) * along_x});
    ASSERT_EQ(found.size(), 1u) << i;
    EXPECT_NEAR(found[0].normal_W.z, 1, 1e-9);
  }
  // In a valley of 45 degrees, across its bottom: one point on each side.
  const auto both = contacts_of(valley(1), {}, {{0, 0.003, 0.0135}, quat_from_rpy(math::pi / 2, 0, 0)});
  ASSERT_EQ(both.size(), 2u);
  EXPECT_NEAR(both[0].normal_W.x * both[1].normal_W.x, -0.5, 1e-6);
  EXPECT_NEAR(both[0].depth_m, 0.01 - 0.0135 * std::sqrt(0.5), 1e-8);
}

/// Ball, capsule, cylinder and another barrel above the middle of one that lies along x.
TEST(BarrelContacts, WithRoundThingsAboveIt) {
  const struct {
    const char* name;
    Shape shape;
    double half_height;
    Quat q;
  } others[] = {{"ball", Sphere{0.02}, 0.02, {}},
                {"capsule", Capsule{0.02, 0.1}, 0.02, quat_from_rpy(math::pi / 2, 0, 0)},
                {"cylinder", Cylinder{0.02, 0.1}, 0.02, quat_from_rpy(math::pi / 2, 0, 0)},
                {"upright", Cylinder{0.02, 0.1}, 0.05, {}},
                {"barrel", Barrel{0.02, 0.1, 0.05}, 0.02, quat_from_rpy(math::pi / 2, 0, 0)},
                {"ellipsoid", Ellipsoid{{0.02, 0.02, 0.02}}, 0.02, {}}};
  for (const auto& other : others) {
    SCOPED_TRACE(other.name);
    const auto found = contacts_of(other.shape, {{0.003, 0, 0.01 + other.half_height - 1e-4}, other.q},
                                   {{}, along_x});
    ASSERT_GE(found.size(), 1u);
    // Off the thick middle by 3 mm: the arc falls by z^2 / (2 (profile + radius of the other)) at most.
    EXPECT_NEAR(found[0].depth_m, 1e-4, 1.1e-4);
    EXPECT_LT(found[0].normal_W.z, -0.99);
    EXPECT_NEAR(found[0].point_W.z, 0.01, 2e-4);
    const auto apart = contacts_of(other.shape, {{0.003, 0, 0.0102 + other.half_height}, other.q},
                                   {{}, along_x});
    EXPECT_TRUE(apart.empty());
  }
}

/// A barrel whose profile is its radius is a ball, so both must do the same on anything.
TEST(BarrelContacts, RollsLikeTheBallThatItIs) {
  const Barrel nearly{0.05, 0.05, 0.0999};
  const Ground grounds[] = {{"plane", Plane{{0, 0, 1}}, {}}, {"box", Box{{9, 9, 1}}, {{0, 0, -0.5}, {}}}};
  for (const Ground& g : grounds) {
    SCOPED_TRACE(g.name);
    const double angle = 0.3;
    World world(rigid::engine, {}, {9.81 * math::sin(angle), 0, -9.81 * math::cos(angle)});
    world.add(static_of("ground", g.shape, g.X));
    model::Model m;
    m.links.push_back(link_of("body", nearly, 1));
    m.links[0].inertial.moments = inertia_kg_m2(Sphere{0.05}, 1);
    const InstanceId barrel = world.add(
        instance_of("barrel", m, {{0, 0, 0.05}, quat_from_rpy(math::pi / 2, 0, 0)}));
    world.run(500, 1e-3);
    // 5/7 of the slide: g sin(angle) * 5/7 after half a second; within the half per cent that contacts give
    // way.
    const double v = 9.81 * math::sin(angle) * 5 / 7 * 0.5;
    EXPECT_NEAR(world.state(barrel).V_WB.linear.x, v, 5e-3 * v);
  }
}

TEST(TriangleTree, VisitsWhatABoxMeets) {
  const TriangleMesh ball = tessellate(Sphere{1}, 48);
  const TriangleTree tree(ball);
  for (const Vec3 low : {Vec3{0, 0, 0.5}, Vec3{-2, -2, -2}, Vec3{0.9, -0.1, -0.1}}) {
    const Vec3 high = low + Vec3{0.4, 0.5, 0.6};
    std::size_t expected = 0, seen = 0;
    for (const auto& t : ball.triangles) {
      bool meets = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const double a = ball.vertices[t[0]][k], b = ball.vertices[t[1]][k], c = ball.vertices[t[2]][k];
        meets = meets && std::min({a, b, c}) <= high[k] && std::max({a, b, c}) >= low[k];
      }
      expected += meets ? 1 : 0;
    }
    tree.visit(low, high, [&](Vec3 a, Vec3 b, Vec3 c) {
      bool meets = true;
      for (std::size_t k = 0; k < 3; ++k)
        meets = meets && std::min({a[k], b[k], c[k]}) <= high[k] && std::max({a[k], b[k], c[k]}) >= low[k];
      seen += meets ? 1 : 0;
      EXPECT_GT(dot(cross(b - a, c - a), a), 0) << "faces out";
    });
    EXPECT_EQ(seen, expected);
  }
}

}  // namespace
}  // namespace sandlot::rigid
