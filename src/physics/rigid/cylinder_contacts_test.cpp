#include "physics/rigid/cylinder_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/math.h"
#include "base/random.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/test_world.h"

namespace sandlot::rigid {
namespace {

using namespace test;

std::vector<dContactGeom> contacts(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                                   int most = 8) {
  dContactGeom found[8];
  EXPECT_TRUE(is_round_pair(a, b));
  const int n = collide_round(a, X_WA, b, X_WB, most, found, sizeof(dContactGeom));
  return {found, found + n};
}

TEST(Round, UprightCylindersMeetAlongALine) {
  const Cylinder a{0.2, 1}, b{0.3, 0.4};
  const Vec3 toward = Vec3{0.6, 0.8, 0};
  EXPECT_TRUE(contacts(a, {}, b, {0.501 * toward + Vec3{0, 0, 0.2}, {}}).empty());
  const auto found = contacts(a, {}, b, {0.499 * toward + Vec3{0, 0, 0.2}, {}});
  ASSERT_EQ(found.size(), 2u);
  for (const dContactGeom& c : found) {
    EXPECT_NEAR(c.depth, 0.001, 1e-12);
    EXPECT_NEAR(c.normal[0], -0.6, 1e-12);  // into a
    EXPECT_NEAR(c.normal[1], -0.8, 1e-12);
    EXPECT_NEAR(std::sqrt(c.pos[0] * c.pos[0] + c.pos[1] * c.pos[1]), 0.1995, 1e-12);
  }
  // Heights of b: 0 .. 0.4.
  EXPECT_NEAR(std::min(found[0].pos[2], found[1].pos[2]), 0.0, 1e-12);
  EXPECT_NEAR(std::max(found[0].pos[2], found[1].pos[2]), 0.4, 1e-12);
}

TEST(Round, StackedCylindersMeetInTheirCommonDisc) {
  const Cylinder a{0.3, 0.2}, b{0.1, 0.2};
  auto found = contacts(a, {}, b, {{0.05, 0, 0.199}, {}});
  ASSERT_EQ(found.size(), 4u);
  for (const dContactGeom& c : found) {
    EXPECT_NEAR(c.depth, 0.001, 1e-12);
    EXPECT_NEAR(c.normal[2], -1, 1e-12);
    EXPECT_NEAR(math::hypot(c.pos[0] - 0.05, c.pos[1]), 0.1, 1e-9);
  }
  // Over the edge: a lens whose corners lie on both rims.
  found = contacts(a, {}, b, {{0.28, 0, 0.199}, {}});
  ASSERT_EQ(found.size(), 4u);
  double reach = -1;
  for (const dContactGeom& c : found) {
    EXPECT_LE(math::hypot(c.pos[0], c.pos[1]), 0.3 + 1e-9);
    EXPECT_LE(math::hypot(c.pos[0] - 0.28, c.pos[1]), 0.1 + 1e-9);
    reach = std::max(reach, c.pos[0]);
  }
  EXPECT_NEAR(reach, 0.3, 1e-9);
}

TEST(Round, CrossedAndLyingOnes) {
  const Quat along_x = quat_from_rpy(0, math::pi / 2, 0), along_y = quat_from_rpy(math::pi / 2, 0, 0);
  const Cylinder a{0.1, 1}, b{0.2, 1};
  auto found = contacts(a, {{0, 0, 0}, along_x}, b, {{0.2, 0.1, 0.299}, along_y});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].depth, 0.001, 1e-12);
  EXPECT_NEAR(found[0].pos[0], 0.2, 1e-9);
  EXPECT_NEAR(found[0].pos[1], 0.0, 1e-9);
  // Standing on a lying one: the line, cut by the disc.
  found = contacts(b, {{0, 0, 0.499 + 0.1}, {}}, a, {{0, 0.1, 0}, along_x});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].normal[2], 1, 1e-9);
  EXPECT_NEAR(std::abs(found[0].pos[0]), std::sqrt(0.04 - 0.01), 1e-6);
  // A capsule's end on a cylinder's cap, and its side along a cylinder's side.
  found = contacts(Capsule{0.1, 0.5}, {{0, 0, 0.5 + 0.35 - 0.002}, {}}, a, {});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].depth, 0.002, 1e-12);
  found = contacts(Capsule{0.1, 0.5}, {{0.199, 0, 0}, {}}, a, {});
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].normal[0], 1, 1e-12);
  EXPECT_EQ(contacts(Capsule{0.1, 0.5}, {{0.199, 0, 0}, {}}, a, {}, 1).size(), 1u);
}

double support(const Shape& shape, const Pose& X, Vec3 n) {
  const Vec3 d = rotate_inverse(X.q, n);
  if (const auto* c = std::get_if<Cylinder>(&shape))
    return dot(n, X.p) + 0.5 * c->length_m * std::abs(d.z) + c->radius_m * std::sqrt(d.x * d.x + d.y * d.y);
  const auto& c = std::get<Capsule>(shape);
  return dot(n, X.p) + 0.5 * c.length_m * std::abs(d.z) + c.radius_m;
}

TEST(Round, NoDirectionPartsThemWithLess) {
  // Against brute force: 20,000 directions spread evenly. The best of them is within 0.02 rad of the true
  // minimum, whose overlap it exceeds by at most 0.02 times the extent (kinks) of some 0.6.
  constexpr int directions = 20000;
  std::vector<Vec3> sphere;
  for (int i = 0; i < directions; ++i) {
    const double z = 1 - (2 * i + 1.0) / directions, angle = i * 2.399963229728653, r = std::sqrt(1 - z * z);
    sphere.push_back({r * math::cos(angle), r * math::sin(angle), z});
  }
  int touching = 0, apart = 0;
  for (int i = 0; i < 300; ++i) {
    Stream random(3, static_cast<std::uint64_t>(i), Purpose::placement, 0);
    const auto angle = [&] { return random.uniform(-math::pi, math::pi); };
    const auto pose = [&](double spread) {
      Pose X;
      for (std::size_t k = 0; k < 3; ++k) X.p[k] = random.uniform(-spread, spread);
      const double roll = angle(), pitch = angle(), yaw = angle();
      X.q = quat_from_rpy(roll, pitch, yaw);
      return X;
    };
    const double r1 = random.uniform(0.05, 0.2), l1 = random.uniform(0.05, 0.6);
    const double r2 = random.uniform(0.05, 0.2), l2 = random.uniform(0.05, 0.6);
    const Shape a = Cylinder{r1, l1};
    const Shape b = i % 2 ? Shape(Cylinder{r2, l2}) : Shape(Capsule{r2, l2});
    const Pose X = pose(0), Y = pose(0.3);
    double least = 1e9;
    for (const Vec3 n : sphere) least = std::min(least, support(a, X, n) + support(b, Y, -n));
    const auto found = contacts(a, X, b, Y);
    if (found.empty()) {
      ++apart;
      EXPECT_LT(least, 0.012) << i;
      continue;
    }
    ++touching;
    const Vec3 n{-found[0].normal[0], -found[0].normal[1], -found[0].normal[2]};
    const double depth = support(a, X, n) + support(b, Y, -n);
    EXPECT_NEAR(norm(n), 1, 1e-9);
    EXPECT_LT(depth, least + 1e-9) << i;  // at least as good as the best of 20,000
    EXPECT_GT(depth, least - 0.012) << i;
    double deepest = 0;
    for (const dContactGeom& c : found) {
      deepest = std::max(deepest, c.depth);
      EXPECT_GE(c.depth, 0);
      EXPECT_LE(c.depth, depth * (1 + 1e-3));  // faces count as flat within 0.02 rad: cos is 2e-4 off
      // The point lies in both bodies' reach along n.
      const Vec3 at{c.pos[0], c.pos[1], c.pos[2]};
      EXPECT_LE(dot(n, at), support(a, X, n) + 1e-9);
      EXPECT_LE(dot(-n, at), support(b, Y, -n) + 1e-9);
    }
    EXPECT_GT(deepest, 0.2 * depth) << i;
    // The other way round: the same depth.
    const auto swapped = contacts(b, Y, a, X);
    ASSERT_FALSE(swapped.empty()) << i;
    const Vec3 m{-swapped[0].normal[0], -swapped[0].normal[1], -swapped[0].normal[2]};
    EXPECT_NEAR(support(b, Y, m) + support(a, X, -m), depth, 1e-6) << i;
  }
  EXPECT_GT(touching, 80);
  EXPECT_GT(apart, 30);
}

TEST(Round, ATowerOfCansStandsAndACanOnARollFalls) {
  World world(rigid::engine);
  world.add(ground());
  for (int i = 0; i < 4; ++i)
    world.add(body_of("can", Cylinder{0.1, 0.2}, 1, {{0.01 * i, 0, 0.1 + 0.2 * i}, {}}));
  const Quat lying = quat_from_rpy(math::pi / 2, 0, 0);
  world.add(body_of("roll", Cylinder{0.1, 0.4}, 1, {{2, 0, 0.1}, lying}));
  const InstanceId above = world.add(body_of("upper", Capsule{0.1, 0.2}, 1, {{2.02, 0, 0.301}, lying}));
  world.run(300);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(world.state(world.ids[i + 1]).X_WB.p.z, 0.1 + 0.2 * static_cast<double>(i), 1e-3);
    EXPECT_NEAR(world.state(world.ids[i + 1]).X_WB.p.x, 0.01 * static_cast<double>(i), 1e-3);
  }
  EXPECT_LT(world.state(above).X_WB.p.z, 0.15);
  EXPECT_EQ(world.engine->counters().solver_messages, 0u);
}

}  // namespace
}  // namespace sandlot::rigid
