#include "navigation/planning/dwa.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/random.h"
#include "navigation/planning/grid_planner.h"

namespace sandlot::navigation {
namespace {

Stream dwa_stream(std::uint64_t sample) { return Stream(6, entity_key("dwa"), Purpose::experiment, sample); }

CostMap dwa_room(double inscribed = 0.2) {
  GridMap map{{120, 120, 0.05, {-3, -3, 0}}, std::vector<std::int8_t>(120 * 120)};
  return *make_cost_map(map, {}, inscribed);
}
std::vector<PathPose> dwa_line() {
  const Vec2 points[] = {{0, 0}, {2.5, 0}};
  return path_through(points, 0.05);
}

TEST(Dwa, CommandsStayInTheWindow) {
  const CostMap map = dwa_room();
  const Footprint box = *Footprint::rectangle(0.25, 0.25, 0.2, 0.2);
  const DwaSpec spec;
  for (const PlanarTwist& v :
       {PlanarTwist{}, PlanarTwist{0.4, 0, -1}, PlanarTwist{0.6, 0, 1.5}, PlanarTwist{-0.1, 0, 0}}) {
    DwaState state;
    const DwaStep step = choose_velocity(spec, state, map, box, dwa_line(), {0, 0, 0.3}, v, {});
    ASSERT_EQ(step.status, Driving::driving);
    EXPECT_LE(std::abs(step.command.vx_mps - v.vx_mps), 0.08 + 1e-12);
    EXPECT_LE(std::abs(step.command.w_radps - v.w_radps), 0.3 + 1e-12);
    EXPECT_LE(std::abs(step.command.vx_mps), 0.6);
    EXPECT_EQ(step.command.vy_mps, 0);
  }
  // Straight ahead it takes the whole acceleration and does not turn.
  DwaState state;
  const DwaStep ahead = choose_velocity(spec, state, map, box, dwa_line(), {}, {0.3, 0, 0}, {});
  EXPECT_NEAR(ahead.command.vx_mps, 0.38, 1e-12);
  EXPECT_NEAR(ahead.command.w_radps, 0, 1e-12);
  // A robot faster than its limit brakes towards it.
  const DwaStep fast = choose_velocity(spec, state, map, box, dwa_line(), {}, {1, 0, 0}, {});
  EXPECT_NEAR(fast.command.vx_mps, 0.92, 1e-12);
}

TEST(Dwa, StopsBeforeAWallAndReportsBlocked) {
  GridMap grid{{120, 120, 0.05, {-3, -3, 0}}, std::vector<std::int8_t>(120 * 120)};
  for (int y = 0; y < 120; ++y) grid.occupancy[grid.geometry.index({80, y})] = 100;  // face at x = 1 m
  const CostMap map = *make_cost_map(grid, {}, 0.2);
  const GridFrame frame(map.geometry);
  const Footprint box = *Footprint::rectangle(0.25, 0.25, 0.2, 0.2);
  const DwaSpec spec{.min_vx_mps = 0};
  DwaState state;
  Pose2 pose;
  PlanarTwist v;
  for (int k = 0; k < 100; ++k) {
    const DwaStep step = choose_velocity(spec, state, map, box, dwa_line(), pose, v, {});
    v = step.command;
    pose = driven(pose, v, spec.period_s);
    ASSERT_EQ(footprint_contact(map, frame, box, pose), Contact::none) << k;
  }
  EXPECT_GT(pose.x, 0.5);
  // Nose against the wall at full speed: nothing is admissible, so it brakes with all it has.
  const DwaStep step = choose_velocity(spec, state, map, box, dwa_line(), {0.7, 0, 0}, {0.6, 0, 0.5}, {});
  EXPECT_EQ(step.status, Driving::blocked);
  EXPECT_NEAR(step.command.vx_mps, 0.52, 1e-12);
  EXPECT_NEAR(step.command.w_radps, 0.5 * 0.52 / 0.6, 1e-12);
}

TEST(Dwa, GivesWayToADiscOnlyIfItComesNear) {
  const CostMap map = dwa_room();
  const Footprint box = *Footprint::rectangle(0.25, 0.25, 0.2, 0.2);
  const auto chosen = [&](MovingDisc disc) {
    DwaState state;
    return choose_velocity({}, state, map, box, dwa_line(), {}, {0.5, 0, 0}, std::span(&disc, 1));
  };
  EXPECT_NEAR(chosen({{1, 2}, {0, 0}, 0.3}).command.w_radps, 0, 1e-12);
  // Stands in the way: a straight line would touch it at 0.5 m: 1 s.
  const DwaStep around = chosen({{1.05, 0.05}, {0, 0}, 0.2});
  EXPECT_TRUE(around.command.w_radps < 0 || around.command.vx_mps < 0.5) << "to the free side, or slower";
  // Comes from the side and crosses in front just when the robot would be there; standing where it is, it would not.
  const PlanarTwist crossing = chosen({{0.8, 0.9}, {0, -0.8}, 0.2}).command,
                    standing = chosen({{0.8, 0.9}, {0, 0}, 0.2}).command;
  EXPECT_NEAR(standing.w_radps, 0, 1e-12);
  EXPECT_TRUE(crossing.vx_mps < standing.vx_mps || std::abs(crossing.w_radps) > 0.1);
}

TEST(Dwa, DistanceToAFootprintIsThatOfItsSides) {
  const Footprint box = *Footprint::rectangle(1, 1, 0.5, 0.5), disc = *Footprint::circle(0.5);
  EXPECT_NEAR(footprint_distance(box, {0, 0, math::pi / 2}, {2, 0}), 1.5, 1e-12);
  EXPECT_NEAR(footprint_distance(box, {0, 0, 0}, {4, 4.5}), 5, 1e-12);
  EXPECT_EQ(footprint_distance(box, {0, 0, 0}, {0.9, 0.4}), 0);
  EXPECT_NEAR(footprint_distance(disc, {1, 0, 2}, {3, 0}), 1.5, 1e-12);
}

TEST(Dwa, NothingToFollowIsLost) {
  const CostMap map = dwa_room();
  const Footprint box = *Footprint::circle(0.2);
  DwaState state;
  EXPECT_EQ(choose_velocity({}, state, map, box, {}, {}, {}, {}).status, Driving::lost);
  EXPECT_EQ(choose_velocity({}, state, map, box, dwa_line(), {0, std::nan(""), 0}, {}, {}).status,
            Driving::lost);
  EXPECT_EQ(choose_velocity({}, state, map, box, dwa_line(), {}, {std::nan(""), 0, 0}, {}).status,
            Driving::lost);
  DwaSpec near;
  near.max_deviation_m = 0.5;
  EXPECT_EQ(choose_velocity(near, state, map, box, dwa_line(), {0, 2, 0}, {}, {}).status, Driving::lost);
}

struct DwaScore {
  int runs = 0, reached = 0, contacts = 0;
  int bumped = 0;  ///< runs in which a disc touched the robot, moving or standing
  double driven_m = 0, planned_m = 0, worst = 0;
};

/// A run through a random room of 10 x 8 m: plan, drive, plan again each second.
void dwa_run(std::uint64_t seed, const DwaSpec& spec, int discs, DwaScore& score) {
  Stream random = dwa_stream(seed);
  GridMap grid{{200, 160, 0.05, {0, 0, 0}}, std::vector<std::int8_t>(200 * 160)};
  for (int k = 0; k < 22; ++k) {
    const int x = static_cast<int>(random.below(190)), y = static_cast<int>(random.below(150)),
              w = 3 + static_cast<int>(random.below(20)), h = 3 + static_cast<int>(random.below(20));
    for (int j = y; j < std::min(y + h, 160); ++j)
      for (int i = x; i < std::min(x + w, 200); ++i) grid.occupancy[grid.geometry.index({i, j})] = 100;
  }
  for (int i = 0; i < 200; ++i)
    grid.occupancy[grid.geometry.index({i, 0})] = grid.occupancy[grid.geometry.index({i, 159})] = 100;
  for (int j = 0; j < 160; ++j)
    grid.occupancy[grid.geometry.index({0, j})] = grid.occupancy[grid.geometry.index({199, j})] = 100;
  const Footprint box = *Footprint::rectangle(0.25, 0.25, 0.2, 0.2);
  const Footprint grown = *box.grown(0.02);
  // Half a cell's diagonal is what lies between the centres that the planner looks at and the squares.
  const CostMap map = *make_cost_map(grid, {.inflation_radius_m = 0.7, .cost_scaling_per_m = 5},
                                     grown.circumscribed_m() + 0.04);
  const GridFrame frame(map.geometry);
  Pose2 pose;
  Vec2 goal;
  std::optional<GridPlan> plan;
  for (int tries = 0; !plan; ++tries) {
    ASSERT_LT(tries, 1000);
    pose = {random.uniform(0.4, 9.6), random.uniform(0.4, 7.6), random.uniform(-math::pi, math::pi)};
    goal = {random.uniform(0.4, 9.6), random.uniform(0.4, 7.6)};
    if (math::hypot(goal.x - pose.x, goal.y - pose.y) < 4) continue;
    if (auto found = plan_grid(map, {.start_tolerance_m = 0}, {pose.x, pose.y}, goal)) plan = *found;
  }
  const double shortest = plan_grid(map, {.cost_weight = 0}, {pose.x, pose.y}, goal)->length_m;
  std::vector<MovingDisc> moving;
  while (static_cast<int>(moving.size()) < discs) {
    MovingDisc disc{{random.uniform(0.5, 9.5), random.uniform(0.5, 7.5)},
                    {random.uniform(-0.35, 0.35), random.uniform(-0.35, 0.35)},
                    0.2};
    const auto cell = frame.cell(disc.centre_M);
    if (map.distance_m[map.geometry.index(*cell)] > 0.3f &&
        math::hypot(disc.centre_M.x - pose.x, disc.centre_M.y - pose.y) > 1.5)
      moving.push_back(disc);
  }

  auto path = path_through(plan->points, 0.05);
  DwaState state;
  PlanarTwist v;
  double length = 0;
  std::vector<Vec2> walking;
  for (const MovingDisc& disc : moving) walking.push_back(disc.velocity_M_mps);
  std::vector<double> pause(moving.size());
  bool contact = false, reached = false, bumped = false;
  for (int k = 0; k < 1200 && !contact && !reached; ++k) {
    if (k % 10 == 9)
      if (const auto again = plan_grid(map, {}, {pose.x, pose.y}, goal)) {
        path = path_through(again->points, 0.05);
        state = {};
      }
    // Any heading will do at the goal.
    if (!path.empty() && math::hypot(goal.x - pose.x, goal.y - pose.y) < spec.goal_tolerance_m)
      path.back().pose.theta = pose.theta;
    const DwaStep step = choose_velocity(spec, state, map, grown, path, pose, v, moving);
    reached = step.status == Driving::arrived;
    v = step.command;
    for (int n = 0; n < 5; ++n) {
      const Pose2 next = driven(pose, v, spec.period_s / 5);
      length += math::hypot(next.x - pose.x, next.y - pose.y);
      pose = next;
      contact = contact || footprint_contact(map, frame, box, pose) != Contact::none;
      for (MovingDisc& disc : moving) {
        // They walk back and forth, and stand for a while before they turn round. Nobody walks into one who stands.
        const std::size_t i = static_cast<std::size_t>(&disc - moving.data());
        const Vec2 next_M = disc.centre_M + (spec.period_s / 5) * walking[i];
        const auto cell = frame.cell(next_M);
        const bool wall = !cell || map.distance_m[map.geometry.index(*cell)] < 0.25f;
        if (wall && pause[i] <= 0) pause[i] = 2, walking[i] = -1 * walking[i];
        pause[i] -= spec.period_s / 5;
        disc.velocity_M_mps = pause[i] > 0 ? Vec2{} : walking[i];
        disc.centre_M = disc.centre_M + (spec.period_s / 5) * disc.velocity_M_mps;
        const bool moves = math::hypot(v.vx_mps, v.vy_mps) > 0.02 || std::abs(v.w_radps) > 0.02;
        const bool touch = footprint_distance(box, pose, disc.centre_M) < disc.radius_m;
        contact = contact || (touch && moves);
        bumped = bumped || touch;
      }
    }
  }
  ++score.runs;
  score.contacts += contact;
  score.bumped += bumped;
  if (reached) {
    ++score.reached;
    EXPECT_LE(math::hypot(goal.x - pose.x, goal.y - pose.y), 2 * spec.goal_tolerance_m) << seed;
    score.driven_m += length;
    score.planned_m += shortest;
    score.worst = std::max(score.worst, length / shortest);
  }
  if (contact || !reached)
    std::printf("run %d: %s at %.2f %.2f, goal %.2f %.2f\n", static_cast<int>(seed),
                contact ? "contact" : "late", pose.x, pose.y, goal.x, goal.y);
}

std::string dwa_text(const DwaScore& s) {
  return std::to_string(s.reached) + " of " + std::to_string(s.runs) + " reached, " +
         std::to_string(s.contacts) + " contacts, " + std::to_string(s.bumped) + " bumped, length " +
         std::to_string(s.driven_m / s.planned_m) + " of the shortest, worst " + std::to_string(s.worst);
}

TEST(SlowDwa, ReachesGoalsInHundredClutters) {
  DwaScore score;
  for (std::uint64_t seed = 0; seed < 100; ++seed) dwa_run(seed, {}, 0, score);
  RecordProperty("differential", dwa_text(score));
  EXPECT_GE(score.reached, 98);
  EXPECT_EQ(score.contacts, 0);
  EXPECT_LE(score.driven_m, 1.2 * score.planned_m);
}

TEST(Dwa, OmniReachesGoalsInClutters) {
  DwaScore score;
  for (std::uint64_t seed = 200; seed < 215; ++seed)
    dwa_run(seed, {.max_vy_mps = 0.4, .vx_samples = 5, .w_samples = 7}, 0, score);
  RecordProperty("omni", dwa_text(score));
  EXPECT_EQ(score.reached, 15);
  EXPECT_EQ(score.contacts, 0);
}

TEST(SlowDwa, AvoidsMovingDiscsInClutters) {
  DwaScore score;
  for (std::uint64_t seed = 300; seed < 350; ++seed)
    dwa_run(seed, {.min_vx_mps = -0.4, .vx_samples = 9}, 4, score);
  RecordProperty("moving", dwa_text(score));
  EXPECT_GE(score.reached, 49);
}

}  // namespace
}  // namespace sandlot::navigation
