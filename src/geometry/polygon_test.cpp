#include "geometry/polygon.h"

#include <gtest/gtest.h>

#include <vector>

namespace sandlot {
namespace {

const std::vector<Vec3> square{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
/// An L: the square without its upper right quarter.
const std::vector<Vec3> angle{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}};

TEST(Polygon, ContainsWhatLiesWithinItsSides) {
  EXPECT_TRUE(polygon_contains(square, {1, 1, 5}));
  EXPECT_FALSE(polygon_contains(square, {2.001, 1, 0}));
  EXPECT_TRUE(polygon_contains(angle, {0.5, 1.5, 0}));
  EXPECT_FALSE(polygon_contains(angle, {1.5, 1.5, 0}));
  EXPECT_FALSE(polygon_contains({}, {0, 0, 0}));
}

TEST(Polygon, AreaIsPositiveCounterClockwise) {
  EXPECT_DOUBLE_EQ(polygon_area(square), 4);
  EXPECT_DOUBLE_EQ(polygon_area(angle), 3);
  EXPECT_DOUBLE_EQ(polygon_area(std::vector<Vec3>(square.rbegin(), square.rend())), -4);
}

TEST(Polygon, CrossingSidesAreFound) {
  EXPECT_FALSE(polygon_crossing(square));
  EXPECT_FALSE(polygon_crossing(angle));
  const std::vector<Vec3> bow{{0, 0, 0}, {2, 2, 0}, {2, 0, 0}, {0, 2, 0}};
  ASSERT_TRUE(polygon_crossing(bow));
  EXPECT_EQ(*polygon_crossing(bow), std::pair(std::size_t{0}, std::size_t{2}));
  // A corner on another side, a side that goes back along the one before it, a corner given twice.
  EXPECT_TRUE(polygon_crossing(std::vector<Vec3>{{0, 0, 0}, {4, 0, 0}, {4, 2, 0}, {2, 0, 0}, {0, 2, 0}}));
  EXPECT_TRUE(polygon_crossing(std::vector<Vec3>{{0, 0, 0}, {4, 0, 0}, {2, 0, 0}, {2, 2, 0}}));
  EXPECT_TRUE(polygon_crossing(std::vector<Vec3>{{0, 0, 0}, {0, 0, 0}, {2, 0, 0}, {2, 2, 0}}));
}

}  // namespace
}  // namespace sandlot
