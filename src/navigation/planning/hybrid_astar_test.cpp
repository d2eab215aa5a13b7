#include "navigation/planning/hybrid_astar.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sandlot::navigation {
namespace {

Stream hybrid_stream(std::uint64_t sample) {
  return Stream(4, entity_key("hybrid"), Purpose::experiment, sample);
}

struct HybridBox {
  double front, back, side;
  Footprint footprint() const { return *Footprint::rectangle(front, back, side, side); }
};

/// Holds a plan against the spec, pose by pose, by formulas of its own.
void hybrid_check(const CostMap& map, const HybridBox& box, const HybridSpec& spec, const Pose2& start,
                  const Pose2& goal, const HybridPlan& plan) {
  const GridFrame frame(map.geometry);
  const double cell = map.geometry.resolution_m;
  EXPECT_EQ(plan.poses.front().pose.x, start.x);
  EXPECT_EQ(plan.poses.front().pose.y, start.y);
  const Pose2 end = plan.poses.back().pose;
  EXPECT_LE(math::hypot(end.x - goal.x, end.y - goal.y), spec.goal_tolerance_m + 1e-6);
  EXPECT_LE(std::abs(math::wrap_angle(end.theta - goal.theta)), spec.goal_tolerance_rad + 1e-6);
  double length = 0;
  for (std::size_t i = 1; i < plan.poses.size(); ++i) {
    const Pose2 a = plan.poses[i - 1].pose, b = plan.poses[i].pose;
    const Vec2 d = plan.poses[i].direction_B;
    const double turn = math::wrap_angle(b.theta - a.theta), chord = math::hypot(b.x - a.x, b.y - a.y);
    if (d == Vec2{0, 0}) {
      EXPECT_TRUE(spec.turn_on_spot);
      EXPECT_NEAR(chord, 0, 1e-9);
      continue;
    }
    ASSERT_GT(chord, 0);
    ASSERT_LE(chord, cell / 2 + 1e-9);
    // A chord c of an arc of radius R turns by 2 asin(c / 2R).
    if (d.y == 0) {
      EXPECT_LE(std::abs(turn), 2 * math::asin(chord / (2 * spec.turning_radius_m)) + 1e-9);
    } else {
      EXPECT_NEAR(turn, 0, 1e-12);
      EXPECT_TRUE(spec.sideways);
    }
    EXPECT_TRUE(d.x >= -1e-9 || spec.backward);
    // The chord points along the direction of travel, turned by half the change of heading.
    const double course = math::atan2(b.y - a.y, b.x - a.x),
                 expected = a.theta + turn / 2 + math::atan2(d.y, d.x);
    EXPECT_NEAR(math::wrap_angle(course - expected), 0, 1e-6);
    length += std::abs(turn) < 1e-9 ? chord : chord * (turn / 2) / math::sin(turn / 2);
  }
  EXPECT_NEAR(length, plan.length_m, 1e-6);

  // The footprint by points, on poses between those of the plan as well. No point of it moves further than half a cell
  // from pose to pose, so it is within a quarter of a cell of where it was checked.
  const double margin = cell / 4 + 1e-3;
  for (std::size_t i = 1; i < plan.poses.size(); ++i)
    for (const double share : {0.0, 0.5}) {
      const Pose2 a = plan.poses[i - 1].pose, b = plan.poses[i].pose;
      const double theta = a.theta + share * math::wrap_angle(b.theta - a.theta);
      const auto [s, c] = math::sincos(theta);
      const double px = a.x + share * (b.x - a.x), py = a.y + share * (b.y - a.y);
      const double inset = share == 0 ? 1e-6 : margin;
      constexpr int n = 12;
      for (int k = 0; k <= n; ++k)
        for (int m = 0; m <= n; ++m) {
          const double x = -box.back + inset + (box.front + box.back - 2 * inset) * k / n,
                       y = -box.side + inset + 2 * (box.side - inset) * m / n;
          const auto at = frame.cell({px + c * x - s * y, py + s * x + c * y});
          ASSERT_TRUE(at);
          ASSERT_NE(int{map.cost[map.geometry.index(*at)]}, 254) << "pose " << i;
        }
    }
}

CostMap hybrid_clutter(std::uint64_t seed, double inscribed) {
  Stream random = hybrid_stream(seed);
  GridMap map{{160, 120, 0.1, {-3, -2, 0.3}}, std::vector<std::int8_t>(160 * 120)};
  for (int k = 0; k < 14; ++k) {
    const int x = static_cast<int>(random.below(145)), y = static_cast<int>(random.below(110)),
              w = 2 + static_cast<int>(random.below(14)), h = 2 + static_cast<int>(random.below(14));
    for (int j = y; j < std::min(y + h, 120); ++j)
      for (int i = x; i < std::min(x + w, 160); ++i) map.occupancy[map.geometry.index({i, j})] = 100;
  }
  return *make_cost_map(map, {.inflation_radius_m = 1, .cost_scaling_per_m = 3}, inscribed);
}

struct HybridRobot {
  const char* name;
  HybridBox box;
  HybridSpec spec;
};
const HybridRobot hybrid_robots[] = {
    {"car", {0.9, 0.25, 0.35}, {.turning_radius_m = 1.2}},
    {"forward", {0.6, 0.25, 0.3}, {.turning_radius_m = 0.8, .backward = false}},
    {"mecanum", {0.4, 0.4, 0.3}, {.turning_radius_m = 0.6, .sideways = true, .turn_on_spot = true}},
    {"differential", {0.4, 0.3, 0.3}, {.turning_radius_m = 0.6, .turn_on_spot = true}},
    {"crab", {0.9, 0.9, 0.5}, {.turning_radius_m = 1.0, .sideways = true}},
};

TEST(HybridAStar, PlansKeepRadiusAndFootprint) {
  for (const HybridRobot& robot : hybrid_robots) {
    int found = 0, tried = 0;
    double longest = 0;
    std::size_t expanded = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
      SCOPED_TRACE(std::string(robot.name) + " " + std::to_string(seed));
      const Footprint footprint = robot.box.footprint();
      const CostMap map = hybrid_clutter(seed, footprint.inscribed_m());
      const GridFrame frame(map.geometry);
      Stream random = hybrid_stream(100 + seed);
      const auto pose = [&] {
        for (;;) {
          const Vec2 p = frame.to_map({random.uniform(0, 160), random.uniform(0, 120)});
          const Pose2 X{p.x, p.y, random.uniform(-math::pi, math::pi)};
          if (footprint_contact(map, frame, footprint, X) == Contact::none) return X;
        }
      };
      const Pose2 start = pose(), goal = pose();
      HybridSpec spec = robot.spec;
      spec.max_expansions = 20'000;
      const auto plan = plan_hybrid(map, footprint, spec, start, goal);
      ++tried;
      if (!plan) {
        EXPECT_NE(plan.error().what.find("no way"), std::string::npos) << plan.error().text();
        continue;
      }
      ++found;
      expanded += plan->expanded;
      longest = std::max(longest, plan->length_m);
      hybrid_check(map, robot.box, robot.spec, start, goal, *plan);
    }
    EXPECT_GE(found, tried - 3) << robot.name;
    RecordProperty(std::string(robot.name),
                   std::to_string(found) + " found, expanded " + std::to_string(expanded));
  }
}

CostMap hybrid_open(double cell = 0.1) {
  GridMap map{{200, 200, cell, {-10, -10, 0}}, std::vector<std::int8_t>(40000)};
  return *make_cost_map(map, {}, 0.2);
}

TEST(HybridAStar, OpenGroundGivesTheKnownShortestPaths) {
  const CostMap map = hybrid_open();
  const HybridBox box{0.5, 0.2, 0.2};
  // Turn round: three arcs of pi / 3 with free changes and metres; the price of changes makes a U-turn cheaper.
  HybridSpec spec{.turning_radius_m = 1, .backward_factor = 1, .arc_factor = 1, .change_price_m = 0};
  const auto three = plan_hybrid(map, box.footprint(), spec, {0, 0, 0}, {0, 0, math::pi});
  ASSERT_TRUE(three);
  EXPECT_NEAR(three->length_m, math::pi, 1e-6);
  EXPECT_NEAR(three->price, math::pi, 1e-6);
  // Two metres straight back: with a factor of 3 it costs 6; with free driving backward, 2.
  const auto back = plan_hybrid(map, box.footprint(), {.backward_factor = 3}, {0, 0, 0}, {-2, 0, 0});
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->length_m, 2, 1e-9);
  EXPECT_NEAR(back->price, 6, 1e-9);
  // Forward only, the least is the way of Dubins: twice LRL or so; far longer than 2 m.
  const auto round = plan_hybrid(map, box.footprint(), {.backward = false, .arc_factor = 1}, {0, 0, 0},
                                 {-2, 0, 0});
  ASSERT_TRUE(round);
  EXPECT_GT(round->length_m, math::tau);
  // Sideways costs its factor.
  const auto aside = plan_hybrid(map, box.footprint(), {.sideways = true, .turn_on_spot = true}, {0, 0, 0},
                                 {0, 2, 0});
  ASSERT_TRUE(aside);
  EXPECT_NEAR(aside->price, 3, 1e-9);
  EXPECT_EQ(aside->poses.back().direction_B.x, math::cos(math::pi / 2));
  // Turn, drive, turn: 90 degrees twice at 0.3 m/rad, 2 m, two changes of 0.5 m.
  const auto spin = plan_hybrid(map, box.footprint(), {.turning_radius_m = 5, .turn_on_spot = true},
                                {0, 0, 0}, {0, 2, 0});
  ASSERT_TRUE(spin);
  EXPECT_LE(spin->price, 2 + math::pi * 0.3 + 1 + 1e-9);
}

TEST(HybridAStar, ParksBackwardInASlot) {
  // A street 3 m wide and a slot of 1.7 x 1.1 m beside it; the car is 1.4 x 0.7 m.
  GridMap map{{160, 60, 0.05, {}}, std::vector<std::int8_t>(160 * 60, 100)};
  for (int y = 28; y < 56; ++y)
    for (int x = 2; x < 158; ++x) map.occupancy[map.geometry.index({x, y})] = 0;
  for (int y = 4; y < 28; ++y)
    for (int x = 60; x < 82; ++x) map.occupancy[map.geometry.index({x, y})] = 0;
  const CostMap costs = *make_cost_map(map, {.inflation_radius_m = 0.4}, 0.2);
  const HybridBox box{1.0, 0.3, 0.33};
  const Pose2 start{1.5, 2.1, 0}, goal{3.55, 0.55, math::pi / 2};
  HybridSpec spec{.turning_radius_m = 0.9, .step_m = 0.15, .cost_weight = 0};
  const auto plan = plan_hybrid(costs, box.footprint(), spec, start, goal);
  ASSERT_TRUE(plan) << plan.error().text();
  hybrid_check(costs, box, spec, start, goal, *plan);
  EXPECT_LT(plan->poses.back().direction_B.x, 0) << "nose to the street: the last part is backward";
}

TEST(HybridAStar, BadEndsAndMissingWaysAreNamed) {
  GridMap map{{80, 40, 0.1, {}}, std::vector<std::int8_t>(80 * 40)};
  for (int y = 0; y < 40; ++y)
    if (y < 18 || y > 22) map.occupancy[map.geometry.index({40, y})] = 100;  // a gap of 0.5 m
  const CostMap costs = *make_cost_map(map, {}, 0.2);
  const auto fault = [&](const HybridBox& box, Pose2 start, Pose2 goal, HybridSpec spec = {}) {
    const auto plan = plan_hybrid(costs, box.footprint(), spec, start, goal);
    return plan ? std::string("found") : plan.error().what;
  };
  const HybridBox slim{0.3, 0.3, 0.2}, wide{0.3, 0.3, 0.3};
  EXPECT_EQ(fault(slim, {1, 2, 0}, {6, 2, 0}), "found");
  EXPECT_EQ(fault(wide, {1, 2, 0}, {6, 2, 0}), "there is no way from (1, 2) to (6, 2) for this robot");
  EXPECT_EQ(fault(wide, {1, 2, 0}, {6, 2, 0}, {.max_expansions = 5}),
            "no way from (1, 2) to (6, 2) was found within 5 poses");
  EXPECT_EQ(fault(wide, {1, 2, 0}, {4, 1, 0}), "the goal (4, 1): the footprint touches an obstacle");
  EXPECT_EQ(fault(wide, {1, 0.1, 0}, {6, 2, 0}), "the start (1, 0.1): the footprint reaches off the map");
  EXPECT_EQ(fault(wide, {1, 2, std::nan("")}, {6, 2, 0}), "the start (1, 2) is not a pose");
  EXPECT_EQ(fault(wide, {1, 2, 0}, {1e300, 2, 0}).find("the goal"), 0u);
  EXPECT_EQ(fault(wide, {1, 2, 0}, {6, 2, 0}, {.step_m = 0.1}), "a step of 0.1 m is shorter than two cells");
  EXPECT_EQ(fault(wide, {1, 2, 0}, {6, 2, 0}, {.turning_radius_m = 0}), "turning_radius is 0");
  EXPECT_EQ(fault(slim, {1, 2, 0}, {1, 2, 0}), "found") << "already there";
}

TEST(HybridAStar, SameInputGivesTheSamePath) {
  const HybridRobot& robot = hybrid_robots[0];
  const CostMap map = hybrid_clutter(3, 0.25);
  const GridFrame frame(map.geometry);
  const Vec2 a = frame.to_map({20, 20}), b = frame.to_map({140, 100});
  const auto one = plan_hybrid(map, robot.box.footprint(), robot.spec, {a.x, a.y, 0}, {b.x, b.y, 0}),
             two = plan_hybrid(map, robot.box.footprint(), robot.spec, {a.x, a.y, 0}, {b.x, b.y, 0});
  ASSERT_EQ(static_cast<bool>(one), static_cast<bool>(two));
  if (!one) return;
  ASSERT_EQ(one->poses.size(), two->poses.size());
  EXPECT_EQ(one->price, two->price);
  EXPECT_EQ(one->poses[one->poses.size() / 2].pose.x, two->poses[one->poses.size() / 2].pose.x);
}

}  // namespace
}  // namespace sandlot::navigation
