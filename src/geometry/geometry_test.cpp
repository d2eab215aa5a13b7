#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "base/random.h"
#include "geometry/pose.h"
#include "geometry/shape.h"

namespace sandlot::geometry_test {
namespace {

// Products of a handful of numbers of size one: a few ulp.
constexpr double eps = 1e-14;

void expect_near(Vec3 a, Vec3 b, double tolerance = eps) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}
/// q and -q are the same rotation.
void expect_same_rotation(Quat a, Quat b, double tolerance = eps) {
  EXPECT_NEAR(std::abs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z), 1, tolerance * tolerance + 1e-15);
  for (const Vec3 v : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    expect_near(rotate(a, v), rotate(b, v), tolerance);
}
Vec3 random_vector(Stream& random) {
  const double x = random.normal(), y = random.normal(), z = random.normal();
  return {x, y, z};
}

TEST(Quat, TurnsTheAxesAsTheRightHandSays) {
  const double q = math::pi / 2;
  expect_near(rotate(quat_from_axis_angle({0, 0, 1}, q), {1, 0, 0}), {0, 1, 0});
  expect_near(rotate(quat_from_axis_angle({1, 0, 0}, q), {0, 1, 0}), {0, 0, 1});
  expect_near(rotate(quat_from_axis_angle({0, 1, 0}, q), {0, 0, 1}), {1, 0, 0});
  // SDF and URDF: roll about x first, then pitch about y, then yaw about z, all fixed.
  const Quat by_hand = quat_from_axis_angle({0, 0, 1}, 0.3) * quat_from_axis_angle({0, 1, 0}, -0.2) *
                       quat_from_axis_angle({1, 0, 0}, 0.1);
  expect_same_rotation(quat_from_rpy(0.1, -0.2, 0.3), by_hand);
}

TEST(Quat, RollPitchYawComeBack) {
  Stream random(1, 1, Purpose::experiment, 0);
  for (int i = 0; i < 2000; ++i) {
    const double r = random.uniform(-math::pi, math::pi), p = random.uniform(-1.5, 1.5),
                 y = random.uniform(-math::pi, math::pi);
    // Near 1.5 rad roll and yaw are divided by cos(1.5) = 0.07.
    expect_near(rpy_from_quat(quat_from_rpy(r, p, y)), {r, p, y}, 1e-13);
    EXPECT_NEAR(yaw_of(quat_from_rpy(r, p, y)), y, 1e-13);
  }
}

TEST(Quat, LookingStraightUpOrDownIsNoSpecialCaseForTheRotation) {
  // Within 1.5e-8 of the vertical pitch is rounded to it; outside, 2e-16 / 1.5e-8 is lost.
  for (const double pitch :
       {math::pi / 2, -math::pi / 2, math::pi / 2 - 1e-9, math::pi / 2 - 1e-7, -math::pi / 2 + 1e-5})
    for (const double roll : {0.0, 0.4, -3.0})
      for (const double yaw : {0.0, 2.0, -1.0}) {
        const Quat q = quat_from_rpy(roll, pitch, yaw);
        const Vec3 rpy = rpy_from_quat(q);
        expect_same_rotation(quat_from_rpy(rpy.x, rpy.y, rpy.z), q, 5e-8);
        EXPECT_LE(std::abs(rpy.z), math::pi);
      }
}

TEST(Quat, TheShortestRotationBetweenTwoDirections) {
  Stream random(1, 1, Purpose::experiment, 1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a = normalised(random_vector(random)), b = normalised(random_vector(random));
    const Quat q = quat_between(a, b);
    expect_near(rotate(q, a), b, 1e-12);
    EXPECT_NEAR(2 * math::acos(std::min(1.0, std::abs(q.w))), math::acos(dot(a, b)), 1e-7);  // shortest
  }
  for (const Vec3 a : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, normalised(Vec3{1, 1, 1})}) {
    expect_near(rotate(quat_between(a, -a), a), -a);
    expect_same_rotation(quat_between(a, a), {});
  }
}

TEST(Pose, ComposesAndInverts) {
  Stream random(1, 1, Purpose::experiment, 2);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 pa = random_vector(random), ra = random_vector(random), pb = random_vector(random),
               rb = random_vector(random), point = random_vector(random);
    const Pose A = pose_from_rpy(pa, ra), B = pose_from_rpy(pb, rb);
    expect_near((A * B) * point, A * (B * point), 1e-13);
    expect_near(inverse(A) * (A * point), point, 1e-13);
    expect_near((A * inverse(A)).p, {}, 1e-13);
    EXPECT_NEAR(norm(A.q), 1, eps);
  }
  // By hand: 2 m ahead of a robot at (1, 1) that looks along y.
  expect_near(pose_from_rpy({1, 1, 0}, {0, 0, math::pi / 2}) * Vec3{2, 0, 0}, {1, 3, 0});
}

TEST(Pose, NoticesWhatIsNotFinite) {
  Pose X;
  EXPECT_TRUE(is_finite(X));
  X.p.z = INFINITY;
  EXPECT_FALSE(is_finite(X));
  X = {};
  X.q.y = NAN;
  EXPECT_FALSE(is_finite(X));
}

TEST(Vec3, HasNoDirectionWhenItIsZero) {
  EXPECT_EQ(normalised(Vec3{}), (Vec3{1, 0, 0}));
  EXPECT_EQ(normalised(Vec3{}, {0, 0, 1}), (Vec3{0, 0, 1}));
  expect_near(normalised(Vec3{3, 0, 4}), {0.6, 0, 0.8});
  EXPECT_EQ(cross({1, 0, 0}, {0, 1, 0}), (Vec3{0, 0, 1}));
}

// Textbook values (e.g. Meriam, Kraige, Dynamics, table D/4).
TEST(Shape, InertiaOfBoxBallAndCylinder) {
  expect_near(inertia_kg_m2(Box{{1, 2, 3}}, 12), {13, 10, 5}, 1e-13);
  expect_near(inertia_kg_m2(Sphere{0.5}, 10), {1, 1, 1}, 1e-13);
  expect_near(inertia_kg_m2(Cylinder{2, 6}, 12), {48, 48, 24}, 1e-12);
  expect_near(inertia_kg_m2(Plane{{0, 0, 1}}, 10), {});
}

// The capsule's closed form against slices: discs of mass dm add dm (r^2/4 + z^2) across and dm r^2/2 along.
// The midpoint rule with n slices is off by O(1/n^2), and by O(1/n^1.5) at the poles where the radius has no
// slope.
TEST(Shape, InertiaAndVolumeOfACapsuleAgainstSlices) {
  const Capsule capsule{0.3, 0.8};
  const double half = 0.5 * capsule.length_m, top = half + capsule.radius_m;
  constexpr int n = 20'000;
  double volume = 0, across = 0, along = 0;
  for (int i = 0; i < n; ++i) {
    const double dz = 2 * top / n, z = -top + (i + 0.5) * dz;
    const double beyond = std::max(0.0, std::abs(z) - half);
    const double r2 = capsule.radius_m * capsule.radius_m - beyond * beyond;
    const double dv = math::pi * r2 * dz;
    volume += dv;
    across += dv * (r2 / 4 + z * z);
    along += dv * r2 / 2;
  }
  EXPECT_NEAR(volume_m3(capsule), volume, 1e-7 * volume);
  const Vec3 inertia = inertia_kg_m2(capsule, volume);  // density 1
  EXPECT_NEAR(inertia.x, across, 1e-7 * across);
  EXPECT_NEAR(inertia.z, along, 1e-7 * along);
  EXPECT_EQ(inertia.x, inertia.y);
  // Without a cylinder it is a ball.
  expect_near(inertia_kg_m2(Capsule{0.5, 0}, 10), {1, 1, 1}, 1e-13);
}

TEST(Shape, VolumesAndBounds) {
  EXPECT_NEAR(volume_m3(Box{{1, 2, 3}}), 6, eps);
  EXPECT_NEAR(volume_m3(Sphere{1}), 4 * math::pi / 3, eps);
  EXPECT_NEAR(volume_m3(Cylinder{2, 3}), 12 * math::pi, 1e-13);
  EXPECT_EQ(volume_m3(Plane{{0, 0, 1}}), 0);
  EXPECT_NEAR(bounding_radius_m(Box{{2, 3, 6}}), 3.5, eps);
  EXPECT_EQ(bounding_radius_m(Sphere{2}), 2);
  EXPECT_NEAR(bounding_radius_m(Cylinder{3, 8}), 5, eps);
  EXPECT_EQ(bounding_radius_m(Capsule{1, 4}), 3);
  EXPECT_TRUE(std::isinf(bounding_radius_m(Plane{{0, 0, 1}})));
}

}  // namespace
}  // namespace sandlot::geometry_test
