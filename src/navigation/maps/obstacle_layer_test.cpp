#include "navigation/maps/obstacle_layer.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sandlot::navigation {
namespace {

/// 2 m x 2 m in cells of 0.1 m; a laser in the middle of cell (10, 10) with one beam forward and one to the left.
struct LayerTrial {
  GridGeometry geometry{20, 20, 0.1, {-1.05, -1.05, 0}};
  ObstacleLayerSpec spec{.persistence_s = 10, .max_range_m = 5};
  ObstacleLayerState state;
  LayerTrial() { state.resize(geometry.cells()); }
  void scan(float forward, float left) {
    msg::LaserScan scan;
    scan.angle_increment = static_cast<float>(math::pi / 2);
    scan.range_min = 0.01f, scan.range_max = 8;
    scan.ranges = {forward, left};
    mark_scan(spec, geometry, state, scan, {}, {}, 0.05);
  }
  int trust(int x, int y) const { return state.trust[geometry.index({x, y})]; }
  int free(int x, int y) const { return state.free[geometry.index({x, y})]; }
};

TEST(ObstacleLayer, BeamsMarkTheirEndAndFreeTheirWay) {
  LayerTrial t;
  t.scan(0.5f, INFINITY);
  EXPECT_EQ(t.trust(15, 10), 255);
  EXPECT_EQ(t.free(15, 10), 0) << "an obstacle";
  for (int x = 10; x < 15; ++x) {
    EXPECT_EQ(t.trust(x, 10), 0) << x;
    EXPECT_EQ(t.free(x, 10), 255) << x;
  }
  for (int y = 11; y < 20; ++y) EXPECT_EQ(t.free(10, y), 255) << y;
  // Behind the obstacle, behind the robot and beside the beams nothing is known.
  for (const Cell c : {Cell{16, 10}, Cell{9, 10}, Cell{10, 9}, Cell{12, 12}}) {
    EXPECT_EQ(t.trust(c.x, c.y), 0);
    EXPECT_EQ(t.free(c.x, c.y), 0);
  }
  // What went away is clear after four scans, and known to be free only then.
  for (int k = 0; k < 3; ++k) {
    t.scan(INFINITY, INFINITY);
    EXPECT_GT(t.trust(15, 10), 0);
    EXPECT_EQ(t.free(15, 10), 0);
  }
  t.scan(INFINITY, INFINITY);
  EXPECT_EQ(t.trust(15, 10), 0);
  EXPECT_EQ(t.free(15, 10), 255);
}

TEST(ObstacleLayer, TimeForgetsObstaclesAndWhatIsFree) {
  LayerTrial t;
  t.scan(0.5f, INFINITY);
  decay(t.spec, t.state, 5);
  EXPECT_NEAR(t.trust(15, 10), 127, 1);
  EXPECT_NEAR(t.free(12, 10), 127, 1);
  decay(t.spec, t.state, 5.1);
  EXPECT_EQ(t.trust(15, 10), 0);
  EXPECT_EQ(t.free(12, 10), 0);
  EXPECT_EQ(t.free(15, 10), 0) << "forgotten is not free";
}

TEST(ObstacleLayer, ClearsARing) {
  LayerTrial t;
  std::fill(t.state.trust.begin(), t.state.trust.end(), std::uint8_t{200});
  clear_near(t.geometry, t.state, {0, 0}, 0.5, 0.3);
  EXPECT_EQ(t.trust(10, 10), 200);
  EXPECT_EQ(t.trust(12, 10), 200);
  EXPECT_EQ(t.trust(13, 10), 0);
  EXPECT_EQ(t.trust(15, 10), 0);
  EXPECT_EQ(t.trust(16, 10), 200);
  EXPECT_EQ(t.trust(10, 5), 0);
  EXPECT_EQ(t.free(13, 10), 0) << "no longer an obstacle is not known to be free";
}

}  // namespace
}  // namespace sandlot::navigation
