#include "physics/rigid/overlap.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sandlot::rigid {
namespace {

TEST(Overlap, DistancesAreThoseOfTheSolids) {
  const Box box{{2, 4, 6}};
  EXPECT_EQ(distance_m(box, {0.9, -1.9, 2.9}), 0);
  EXPECT_DOUBLE_EQ(distance_m(box, {1.5, 0, 0}), 0.5);
  EXPECT_DOUBLE_EQ(distance_m(box, {4, -6, 0}), 5);  // 3, 4, 5
  EXPECT_EQ(distance_m(Sphere{1}, {0.5, 0.5, 0.5}), 0);
  EXPECT_DOUBLE_EQ(distance_m(Sphere{1}, {0, 3, 4}), 4);
  const Cylinder can{1, 2};
  EXPECT_EQ(distance_m(can, {0.6, 0.6, -0.9}), 0);
  EXPECT_DOUBLE_EQ(distance_m(can, {0, 3, 0.5}), 2);
  EXPECT_DOUBLE_EQ(distance_m(can, {0, 0.5, 4}), 3);
  EXPECT_DOUBLE_EQ(distance_m(can, {4, 0, -5}), 5);
  const Capsule pill{1, 2};
  EXPECT_EQ(distance_m(pill, {0, 0, 1.9}), 0);
  EXPECT_DOUBLE_EQ(distance_m(pill, {0, 0, -3}), 1);
  EXPECT_DOUBLE_EQ(distance_m(pill, {3, 0, 1}), 2);
  EXPECT_DOUBLE_EQ(distance_m(pill, {3, 0, 5}), 4);
  EXPECT_DOUBLE_EQ(distance_m(Plane{{0, 0, 2}}, {7, 8, 3}), 3);
  EXPECT_EQ(distance_m(Plane{{0, 0, 1}}, {7, 8, -3}), 0);
}

}  // namespace
}  // namespace sandlot::rigid
