#include "physics/rigid/rigid_group.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "physics/test_world.h"

namespace sandlot::rigid {
namespace {

using namespace test;

model::Joint fixed(std::uint32_t parent, std::uint32_t child) {
  model::Joint joint;
  joint.parent = parent;
  joint.child = child;
  return joint;
}

TEST(RigidGroup, TwoHalvesMakeTheWhole) {
  // A bar of 2 kg cut in the middle; the second half is turned and carries its frame elsewhere.
  model::Model m;
  m.links.push_back(link_of("left", Box{{0.5, 0.1, 0.2}}, 1, {{-0.25, 0, 0}, {}}));
  m.links.push_back(link_of("right", Box{{0.1, 0.2, 0.5}}, 1));
  // x of the half lies along its own z, its y along z.
  m.links[1].X_ML = {{1, 2, 3}, quat_from_rpy(math::pi / 2, 0, 0) * quat_from_rpy(0, math::pi / 2, 0)};
  const Pose X_MCo{{0.25, 0, 0}, m.links[1].X_ML.q};
  m.links[1].inertial.X_LCo = inverse(m.links[1].X_ML) * X_MCo;
  m.joints.push_back(fixed(0, 1));
  const auto groups = group_links(m);
  ASSERT_TRUE(groups);
  ASSERT_EQ(groups->groups.size(), 1u);
  const RigidGroup& group = groups->groups[0];
  EXPECT_DOUBLE_EQ(group.mass_kg, 2);
  EXPECT_NEAR(norm(group.X_MB.p), 0, 1e-15);
  // Which way round the half lies decides between y and z extents; take them from the rotated shape.
  const Vec3 size_M = rotate(m.links[1].X_ML.q, {0.1, 0.2, 0.5});
  ASSERT_NEAR(std::abs(size_M.x), 0.5, 1e-12);
  const double y = std::abs(size_M.y), z = std::abs(size_M.z);
  const Vec3 left = inertia_kg_m2(Box{{0.5, 0.1, 0.2}}, 1), right = inertia_kg_m2(Box{{0.5, y, z}}, 1);
  EXPECT_NEAR(group.inertia_B.xx, left.x + right.x, 1e-12);
  EXPECT_NEAR(group.inertia_B.yy, left.y + right.y + 2 * 0.0625, 1e-12);  // Steiner: 1 kg at 0.25 m, twice
  EXPECT_NEAR(group.inertia_B.zz, left.z + right.z + 2 * 0.0625, 1e-12);
  EXPECT_NEAR(group.inertia_B.xy, 0, 1e-12);
}

/// C's axes turned by 90 degrees about x: z of the link is y of C, y of the link is -z of C.
TEST(RigidGroup, ATurnedTensorIsThatOfTheLink) {
  model::Model m;
  m.links.push_back(link_of("one", Sphere{0.1}, 1));
  m.links[0].X_ML = {{1, 2, 3}, quat_from_rpy(0, 0, 0.4)};  // the body has the link's axes, wherever that is
  m.links[0].inertial = {.mass_kg = 2,
                         .X_LCo = {{0.5, 0, 0}, quat_from_rpy(math::pi / 2, 0, 0)},
                         .moments = {1, 2, 2.5},
                         .products = {0.1, 0.2, 0.3}};
  const auto expect_turned = [](const Symmetric3& i, double times, Vec3 steiner) {
    EXPECT_NEAR(i.xx, times * 1 + steiner.x, 1e-14);
    EXPECT_NEAR(i.yy, times * 2.5 + steiner.y, 1e-14);
    EXPECT_NEAR(i.zz, times * 2 + steiner.z, 1e-14);
    EXPECT_NEAR(i.xy, times * -0.2, 1e-14);
    EXPECT_NEAR(i.xz, times * 0.1, 1e-14);
    EXPECT_NEAR(i.yz, times * -0.3, 1e-14);
  };
  const auto alone = group_links(m);
  ASSERT_TRUE(alone);
  expect_turned(alone->groups[0].inertia_B, 1, {});
  // A second one of the same axes, 2 m farther along x: 2 kg, twice 1 m from the middle.
  m.links.push_back(m.links[0]);
  m.links[1].name = "two";
  m.links[1].X_ML.p = m.links[0].X_ML * Vec3{2, 0, 0};
  m.joints.push_back(fixed(0, 1));
  const auto both = group_links(m);
  ASSERT_TRUE(both);
  expect_turned(both->groups[0].inertia_B, 2, {0, 4, 4});
}

TEST(RigidGroup, ProductsOfInertiaTurnWithTheirFrame) {
  const Symmetric3 m{1, 2, 3, 0.1, 0.2, 0.3};
  const Quat q = quat_from_rpy(0.3, -0.5, 1.1);
  const Symmetric3 r = rotated(q, m);
  // R m R^T v = R (m (R^T v)) for any v.
  for (const Vec3 v : {Vec3{1, 0, 0}, Vec3{0.3, -2, 0.7}}) {
    const Vec3 want = rotate(q, m * rotate_inverse(q, v)), got = r * v;
    EXPECT_NEAR(norm(want - got), 0, 1e-14);
  }
  EXPECT_TRUE(is_positive_definite(m));
  EXPECT_FALSE(is_positive_definite({1, 1, 1, 2, 0, 0}));
  EXPECT_FALSE(is_positive_definite({1, 1, -1, 0, 0, 0}));
  EXPECT_TRUE(is_positive_definite({1e-12, 1e-12, 1e-14, 0, 0, 0})) << "a grain of dust";
  EXPECT_FALSE(is_positive_definite({1, 1, 1, 1 - 1e-15, 0, 0})) << "only by rounding";
  EXPECT_FALSE(is_positive_definite({1, 1, 1, 0, 0, 1 - 1e-15})) << "only by rounding";
  EXPECT_TRUE(is_positive_definite({1, 1, 1, 1 - 1e-12, 0, 0}));
  EXPECT_FALSE(is_positive_definite({1, 1, 1e-300, 0, 0, 0})) << "its inverse is next to infinite";
}

TEST(RigidGroup, AMassThatCannotBeDividedByIsRefused) {
  model::Model m;
  m.links.push_back(link_of("dust", Sphere{0.1}, 1e-20));
  EXPECT_TRUE(group_links(m));
  for (const double mass : {0.0, 1e-310, 1e-41, 1e41, std::nan("")}) {
    m.links[0].inertial.mass_kg = mass;
    const auto groups = group_links(m);
    ASSERT_FALSE(groups) << mass;
    EXPECT_EQ(groups.error().what, "the mass of link 'dust' is not between 1e-40 and 1e40 kg");
  }
}

TEST(RigidGroup, FixedJointsJoinAndTheWorldHolds) {
  model::Model m;
  for (int i = 0; i < 6; ++i) m.links.push_back(link_of("l", Sphere{0.1}, 1, {{1.0 * i, 0, 0}, {}}));
  m.joints.push_back(fixed(4, 2));
  m.joints.push_back(fixed(2, 0));
  m.joints.push_back(fixed(0, 4));  // a loop of fixed joints
  m.joints.push_back(fixed(model::world_link, 5));
  m.joints.push_back(fixed(5, 3));
  const auto groups = group_links(m);
  ASSERT_TRUE(groups);
  EXPECT_EQ(groups->of_link, (std::vector<std::uint32_t>{0, 1, 0, 2, 0, 2}));
  ASSERT_EQ(groups->groups.size(), 3u);
  EXPECT_EQ(groups->groups[0].links, (std::vector<std::uint32_t>{0, 2, 4}));
  EXPECT_NEAR(groups->groups[0].X_MB.p.x, 2, 1e-15);
  EXPECT_FALSE(groups->groups[0].fixed);
  EXPECT_TRUE(groups->groups[2].fixed);
  m.is_static = true;
  const auto standing = group_links(m);
  ASSERT_TRUE(standing);
  ASSERT_EQ(standing->groups.size(), 1u);
  EXPECT_TRUE(standing->groups[0].fixed);
}

}  // namespace
}  // namespace sandlot::rigid
