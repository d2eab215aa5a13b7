#include "navigation/planning/car_paths.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sandlot::navigation {
namespace {

Stream car_stream(std::uint64_t sample) {
  return Stream(9, entity_key("car paths"), Purpose::experiment, sample);
}
Pose2 car_random(Stream& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-math::pi, math::pi)};
}

/// End of a path by small steps of the unicycle, midpoint rule: error of order step^2.
Pose2 car_walked(Pose2 at, const CarPath& path) {
  for (int i = 0; i < path.count; ++i) {
    const Move& move = path.moves[static_cast<std::size_t>(i)];
    constexpr int steps = 400;
    const double ds = move.direction_B.x * move.amount / steps;
    for (int k = 0; k < steps; ++k) {
      const double middle = at.theta + 0.5 * ds * move.curvature_pm;
      at = {at.x + ds * math::cos(middle), at.y + ds * math::sin(middle), at.theta + ds * move.curvature_pm};
    }
  }
  return at;
}

TEST(CarPaths, EveryPathEndsAtItsGoal) {
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    Stream random = car_stream(seed);
    const Pose2 from = car_random(random, 5), to = car_random(random, 5);
    const double radius = random.uniform(0.3, 3);
    for (const CarPath& path :
         {reeds_shepp(from, to, radius), reeds_shepp(from, to, radius, {2.5, 1}), dubins(from, to, radius)}) {
      ASSERT_GT(path.count, 0);
      double sum = 0;
      for (int i = 0; i < path.count; ++i) {
        const Move& move = path.moves[static_cast<std::size_t>(i)];
        EXPECT_TRUE(move.curvature_pm == 0 || std::abs(std::abs(move.curvature_pm) * radius - 1) < 1e-12);
        sum += move.amount;
      }
      EXPECT_NEAR(sum, path.length_m, 1e-9);
      const Pose2 end = car_walked(from, path);
      // Midpoint rule on an arc of up to a circle in 400 steps: (2 pi / 400)^2 / 24 = 1e-5 of its length.
      EXPECT_NEAR(end.x, to.x, 1e-3) << seed;
      EXPECT_NEAR(end.y, to.y, 1e-3) << seed;
      EXPECT_NEAR(math::wrap_angle(end.theta - to.theta), 0, 1e-6) << seed;
    }
  }
}

TEST(CarPaths, ReedsSheppLengthIsAMetricBelowDubins) {
  // Shortest lengths are symmetric and obey the triangle inequality; a missing or wrong word breaks it.
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    Stream random = car_stream(10'000 + seed);
    const double reach = seed % 2 ? 1.5 : 5;
    const Pose2 a = car_random(random, reach), b = car_random(random, reach), c = car_random(random, reach);
    const double ab = reeds_shepp(a, b, 1).length_m, bc = reeds_shepp(b, c, 1).length_m,
                 ac = reeds_shepp(a, c, 1).length_m;
    EXPECT_LE(ac, ab + bc + 1e-9) << seed;
    EXPECT_NEAR(ab, reeds_shepp(b, a, 1).length_m, 1e-9) << seed;
    EXPECT_GE(ab, math::hypot(a.x - b.x, a.y - b.y) - 1e-9);
    EXPECT_LE(ab, dubins(a, b, 1).length_m + 1e-9) << seed;
    EXPECT_LE(dubins(a, c, 1).length_m, dubins(a, b, 1).length_m + dubins(b, c, 1).length_m + 1e-9) << seed;
  }
}

TEST(CarPaths, KnownPathsHaveTheirKnownLengths) {
  EXPECT_NEAR(reeds_shepp({}, {3, 0, 0}, 1).length_m, 3, 1e-12);
  EXPECT_NEAR(reeds_shepp({}, {-3, 0, 0}, 1).length_m, 3, 1e-12);
  EXPECT_NEAR(reeds_shepp({}, {1, 1, math::pi / 2}, 1).length_m, math::pi / 2, 1e-12);
  // Turn on the spot by half a turn: three arcs of 60 degrees, forward, backward, forward.
  EXPECT_NEAR(reeds_shepp({}, {0, 0, math::pi}, 1).length_m, math::pi, 1e-9);
  EXPECT_NEAR(dubins({}, {0, 2, math::pi}, 1).length_m, math::pi, 1e-9);
  // Forward only, a metre back along the own track costs nearly a whole circle and more.
  EXPECT_GT(dubins({}, {-1, 0, 0}, 1).length_m, math::tau);
  // A price on metres backward turns the straight back into a detour.
  EXPECT_LT(reeds_shepp({}, {-3, 0, 0}, 1).moves[0].direction_B.x, 0);
  const CarPath dear = reeds_shepp({}, {-3, 0, 0}, 1, {20, 0});
  double back = 0;
  for (int i = 0; i < dear.count; ++i)
    if (dear.moves[static_cast<std::size_t>(i)].direction_B.x < 0)
      back += dear.moves[static_cast<std::size_t>(i)].amount;
  EXPECT_LT(back, 1);
}

TEST(CarPaths, BadInputIsAnsweredWithAnEmptyPath) {
  EXPECT_EQ(reeds_shepp({std::nan(""), 0, 0}, {}, 1).count, 0);
  EXPECT_EQ(reeds_shepp({}, {1, 0, 0}, 0).count, 0);
  EXPECT_EQ(dubins({}, {1, 0, std::nan("")}, 1).count, 0);
  EXPECT_EQ(reeds_shepp({}, {}, 1).count, 0) << "already there";
}

}  // namespace
}  // namespace sandlot::navigation
