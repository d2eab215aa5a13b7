#include "navigation/navigator/navigator.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "navigation/navigator/test_clutter.h"

namespace sandlot::navigation {
namespace {

using test::Clutter;
using test::Mover;

struct NavigatorRun {
  NavStatus status = NavStatus::idle;
  std::string reason;
  double way_m = 0, clearance_m = 1e9, seconds = 0;
  std::uint32_t recoveries = 0;
  Pose2 end;
};

/// Drives through a room whose drive does exactly what it is told; the navigator sees scans and poses only.
NavigatorRun navigator_drive(Navigator& nav, const Clutter& room, std::vector<Mover> movers,
                             const NavGoal& goal, double radius, double most_s = 120,
                             double view_rad = math::tau) {
  NavigatorRun out;
  constexpr double dt = 0.1;
  Pose2 X{room.start.x, room.start.y, 0.6};
  EXPECT_TRUE(nav.set_goal(goal));
  for (; out.seconds < most_s; out.seconds += dt) {
    msg::LaserScan scan = test::scan(room, movers, X);
    const std::size_t beams = scan.ranges.size();
    for (std::size_t i = 0; i < beams; ++i)
      if (std::abs(math::tau * static_cast<double>(i) / static_cast<double>(beams) - math::pi) > view_rad / 2)
        scan.ranges[i] = std::numeric_limits<float>::quiet_NaN();
    const NavigatorStep step = nav.step({.X_MB = X, .scan = &scan, .dt_s = dt});
    out.status = step.status;
    out.recoveries = step.feedback.number_of_recoveries;
    if (step.status == NavStatus::reached || step.status == NavStatus::failed) break;
    for (int k = 0; k < 10; ++k) {
      const Pose2 next = driven(X, step.command, dt / 10);
      out.way_m += math::hypot(next.x - X.x, next.y - X.y);
      X = next;
      out.clearance_m = std::min(out.clearance_m, room.clearance({X.x, X.y}) - radius);
      for (Mover& m : movers) {
        m.centre = m.centre + (dt / 10) * m.velocity;
        if (std::abs(m.centre.x) > room.half - m.radius)
          m.velocity.x = std::copysign(m.velocity.x, -m.centre.x);
        if (std::abs(m.centre.y) > room.half - m.radius)
          m.velocity.y = std::copysign(m.velocity.y, -m.centre.y);
        // A disc takes no notice of a robot: it may run over one that stands. What the robot drives into is its fault.
        const Vec2 to_disc = m.centre - Vec2{X.x, X.y};
        const double distance_m = test::length(to_disc), between_m = distance_m - radius - m.radius;
        const double approach_mps = (step.command.vx_mps *
                                         (to_disc.x * math::cos(X.theta) + to_disc.y * math::sin(X.theta)) +
                                     step.command.vy_mps *
                                         (to_disc.y * math::cos(X.theta) - to_disc.x * math::sin(X.theta))) /
                                    distance_m;
        if (approach_mps > 0.02 && !m.touches) out.clearance_m = std::min(out.clearance_m, between_m);
        m.touches = between_m <= 0;
      }
    }
  }
  out.reason = nav.state().reason;
  out.end = X;
  return out;
}

NavigatorSpec navigator_spec(Chassis chassis = Chassis::differential) {
  NavigatorSpec spec;
  spec.chassis = chassis;
  spec.radius_m = 0.2;
  spec.margin_m = 0.02;
  spec.area_m = 21;
  return spec;
}

enum class Knowledge { unknown, mapped };

/// Goals in clutter: reached without contact in 98 of 100 rooms. With the room's map, each way is at most 1.2 times as long as the
/// optimum. A robot that does not know the room goes into gaps that turn out to be too narrow when it is there: its ways are as short
/// in 95 of 100 rooms, and 10 % longer than the optimum on average at most.
void navigator_clutter(std::uint64_t first, std::uint64_t last, Chassis chassis, Knowledge knowledge) {
  int reached = 0, rooms = 0, short_ways = 0;
  double worst = 0, sum = 0;
  for (std::uint64_t seed = first; seed < last; ++seed) {
    const Clutter room = Clutter::random(seed, 22);
    const double best = test::shortest(room.polygons, 0.2 + 0.1, room.start, room.goal, room.half);
    if (!std::isfinite(best)) continue;
    ++rooms;
    std::optional<GridMap> map;
    if (knowledge == Knowledge::mapped) map = room.map(0.05);
    Navigator nav = *Navigator::make(navigator_spec(chassis), 0.1, std::move(map));
    const NavigatorRun run = navigator_drive(nav, room, {}, {{room.goal.x, room.goal.y, 0}, false}, 0.2);
    const bool good = run.status == NavStatus::reached && run.clearance_m > 0;
    reached += good;
    // The goal counts as reached within its tolerance.
    const double optimum = test::shortest(room.polygons, 0.2, room.start, room.goal, room.half) - 0.15;
    const double ratio = run.way_m / optimum;
    if (good) worst = std::max(worst, ratio), sum += ratio;
    short_ways += good && ratio <= 1.2;
    if (!good || ratio > 1.2)
      std::printf("seed %d: %s %s clearance %.3f way %.2f of %.2f, %.0f s, %u recoveries\n", int(seed),
                  name_of(run.status), run.reason.c_str(), run.clearance_m, run.way_m, optimum, run.seconds,
                  run.recoveries);
  }
  std::printf("%s %s: %d of %d, mean ratio %.3f, worst %.3f, %d within 1.2\n", name_of(chassis),
              knowledge == Knowledge::mapped ? "mapped" : "unknown", reached, rooms,
              sum / std::max(reached, 1), worst, short_ways);
  EXPECT_GE(rooms, 0.9 * static_cast<double>(last - first));
  EXPECT_GE(reached, 0.98 * rooms);
  if (knowledge == Knowledge::mapped) { EXPECT_EQ(short_ways, reached); }
  EXPECT_GE(short_ways, 0.95 * rooms);
  EXPECT_LE(sum, 1.1 * reached);
}

TEST(Navigator, ReachesGoalsInClutter) {
  navigator_clutter(0, 3, Chassis::differential, Knowledge::unknown);
  navigator_clutter(0, 2, Chassis::differential, Knowledge::mapped);
}
TEST(Navigator, AnOmniReachesGoalsInClutter) {
  navigator_clutter(1, 3, Chassis::omni, Knowledge::unknown);
  navigator_clutter(1, 3, Chassis::omni, Knowledge::mapped);
}
// Room 55 has a gap at the limit of the margin, before which the robot wavered.
TEST(Navigator, KeepsToItsWayAtAGapAtTheLimit) {
  navigator_clutter(55, 56, Chassis::differential, Knowledge::unknown);
}
TEST(SlowNavigator, ReachesGoalsInTwentyRooms) {
  navigator_clutter(0, 20, Chassis::differential, Knowledge::unknown);
}
TEST(SlowNavigator, ReachesGoalsInTwentyRoomsThatItKnows) {
  navigator_clutter(20, 40, Chassis::differential, Knowledge::mapped);
}
TEST(SlowNavigator, AnOmniReachesGoalsInTenRooms) {
  navigator_clutter(20, 30, Chassis::omni, Knowledge::unknown);
}
TEST(SlowNavigator, AnOmniReachesGoalsInTenRoomsThatItKnows) {
  navigator_clutter(30, 40, Chassis::omni, Knowledge::mapped);
}
/// A car and four steered wheels that see 270 degrees: as often without contact. Their ways are longer than those of a disc that turns on the
/// spot, which is what the optimum is of: 10 % on average.
void navigator_steered(std::uint64_t first, std::uint64_t last, Chassis chassis) {
  int reached = 0, clear = 0, rooms = 0;
  double sum = 0, worst = 0;
  for (std::uint64_t seed = first; seed < last; ++seed) {
    const Clutter room = Clutter::random(seed, 22);
    const double best = test::shortest(room.polygons, 0.2 + 0.1, room.start, room.goal, room.half);
    if (!std::isfinite(best)) continue;
    ++rooms;
    Navigator nav = *Navigator::make(navigator_spec(chassis), 0.1, {});
    const NavigatorRun run = navigator_drive(nav, room, {}, {{room.goal.x, room.goal.y, 0}, false}, 0.2, 120,
                                             1.5 * math::pi);
    const double ratio = run.way_m /
                         (test::shortest(room.polygons, 0.2, room.start, room.goal, room.half) - 0.15);
    clear += run.clearance_m > 0;
    if (run.status == NavStatus::reached) ++reached, sum += ratio, worst = std::max(worst, ratio);
    if (run.status != NavStatus::reached || run.clearance_m <= 0)
      std::printf("seed %d: %s %s clearance %.3f\n", int(seed), name_of(run.status), run.reason.c_str(),
                  run.clearance_m);
  }
  std::printf("%s: %d of %d reached, %d without contact, mean ratio %.3f, worst %.3f\n", name_of(chassis),
              reached, rooms, clear, sum / std::max(reached, 1), worst);
  EXPECT_EQ(clear, rooms);
  EXPECT_GE(reached, 0.9 * rooms);
  EXPECT_LE(sum, 1.1 * reached);
}
TEST(SlowNavigator, ACarReachesGoalsInSixRooms) { navigator_steered(0, 6, Chassis::car); }
TEST(SlowNavigator, FourSteeredWheelsReachGoalsInSixRooms) {
  navigator_steered(0, 6, Chassis::four_wheel_steer);
}
TEST(LongNavigator, ACarReachesGoalsInTwentyRooms) { navigator_steered(0, 20, Chassis::car); }
TEST(LongNavigator, FourSteeredWheelsReachGoalsInTwentyRooms) {
  navigator_steered(0, 20, Chassis::four_wheel_steer);
}
TEST(LongNavigator, ReachesGoalsInAHundredRooms) {
  navigator_clutter(0, 100, Chassis::differential, Knowledge::unknown);
}
TEST(LongNavigator, ReachesGoalsInAHundredRoomsThatItKnows) {
  navigator_clutter(0, 100, Chassis::differential, Knowledge::mapped);
}
TEST(LongNavigator, AnOmniReachesGoalsInAHundredRooms) {
  navigator_clutter(0, 100, Chassis::omni, Knowledge::unknown);
}
TEST(LongNavigator, AnOmniReachesGoalsInAHundredRoomsThatItKnows) {
  navigator_clutter(0, 100, Chassis::omni, Knowledge::mapped);
}

/// Goals among discs that move: reached in 98 of 100 rooms, and driven into none of them in as many. A disc that comes out from
/// behind an obstacle at arm's length may meet a robot that has not come to a stop yet.
void navigator_movers(std::uint64_t first, std::uint64_t last, Chassis chassis = Chassis::differential) {
  int reached = 0, clear = 0;
  for (std::uint64_t seed = first; seed < last; ++seed) {
    const Clutter room = Clutter::random(seed, 5);
    const std::vector<Mover> movers{{{-3, 3}, {0.3, -0.1}}, {{0, 2}, {-0.1, -0.25}}, {{3, -3}, {-0.25, 0.2}}};
    Navigator nav = *Navigator::make(navigator_spec(chassis), 0.1, {});
    const NavigatorRun run = navigator_drive(nav, room, movers, {{room.goal.x, room.goal.y, 0}, false}, 0.2);
    reached += run.status == NavStatus::reached;
    clear += run.clearance_m > 0;
    if (run.status != NavStatus::reached || run.clearance_m <= 0)
      std::printf("seed %d: %s %s clearance %.3f, %.0f s, %u recoveries\n", int(seed), name_of(run.status),
                  run.reason.c_str(), run.clearance_m, run.seconds, run.recoveries);
  }
  const auto rooms = static_cast<int>(last - first);
  std::printf("%d of %d reached, %d without contact\n", reached, rooms, clear);
  EXPECT_GE(reached, 0.98 * rooms);
  EXPECT_GE(clear, 0.98 * rooms);
}

TEST(Navigator, NeverDrivesIntoMovingDiscs) { navigator_movers(0, 5); }

TEST(SlowNavigator, NeverDrivesIntoMovingDiscsInTwentyRooms) { navigator_movers(0, 20); }
TEST(SlowNavigator, AnOmniNeverDrivesIntoMovingDiscsInTenRooms) { navigator_movers(0, 10, Chassis::omni); }
TEST(LongNavigator, NeverDrivesIntoMovingDiscsInAHundredRooms) { navigator_movers(0, 100); }
TEST(LongNavigator, AnOmniNeverDrivesIntoMovingDiscsInAHundredRooms) {
  navigator_movers(0, 100, Chassis::omni);
}

TEST(Navigator, ReachesAHeading) {
  Clutter room;
  room.start = {-2, 0};
  for (const Chassis chassis :
       {Chassis::differential, Chassis::omni, Chassis::car, Chassis::four_wheel_steer}) {
    Navigator nav = *Navigator::make(navigator_spec(chassis), 0.1, {});
    const NavigatorRun run = navigator_drive(nav, room, {}, {{1, 0.5, 1.5}, true}, 0.2);
    EXPECT_EQ(run.status, NavStatus::reached) << name_of(chassis) << ' ' << run.reason;
    EXPECT_LE(math::hypot(run.end.x - 1, run.end.y - 0.5), 0.15 + 1e-9) << name_of(chassis);
    // A car can't turn at the goal: the tracking error of its last arc remains.
    EXPECT_LE(std::abs(math::wrap_angle(run.end.theta - 1.5)), chassis == Chassis::car ? 0.3 : 0.15 + 1e-9)
        << name_of(chassis);
  }
}

/// A wall of the map is between it and its goal, so that it recovers; behind it, where its laser of 270 degrees does not see,
/// something stands.
TEST(Navigator, DoesNotBackUpIntoWhatItDoesNotSee) {
  Clutter room;
  room.start = {};
  const auto [s, c] = math::sincos(0.6);
  room.polygons = {test::regular({-0.5 * c, -0.5 * s}, 0.2, 12, 0)};
  GridMap map{{100, 100, 0.1, {-5, -5, 0}}, std::vector<std::int8_t>(10'000)};
  for (int y = 0; y < 100; ++y) map.occupancy[map.geometry.index({70, y})] = 100;
  for (const Chassis chassis : {Chassis::differential, Chassis::omni, Chassis::four_wheel_steer}) {
    Navigator nav = *Navigator::make(navigator_spec(chassis), 0.1, map);
    const NavigatorRun run = navigator_drive(nav, room, {}, {{4, 0, 0}, false}, 0.2, 120, 1.5 * math::pi);
    EXPECT_EQ(run.status, NavStatus::failed) << name_of(chassis);
    EXPECT_EQ(run.recoveries, 3u) << name_of(chassis);
    EXPECT_GT(run.clearance_m, 0) << name_of(chassis);
  }
}

TEST(Navigator, LeavesWhatItTouches) {
  Clutter room;
  // A post that reaches 2 cm into its outline, at its side.
  room.polygons = {test::regular({-2, 0.28}, 0.1, 12, 0)};
  room.start = {-2, 0};
  Navigator nav = *Navigator::make(navigator_spec(), 0.1, {});
  const NavigatorRun run = navigator_drive(nav, room, {}, {{1, -1, 0}, false}, 0.2);
  EXPECT_EQ(run.status, NavStatus::reached) << run.reason;
  EXPECT_GE(run.clearance_m, -0.021) << "it goes no deeper";
}

TEST(Navigator, AnswersBadGoalsWithTheReason) {
  GridMap map{{100, 100, 0.1, {-5, -5, 0}}, std::vector<std::int8_t>(10'000)};
  for (int y = 0; y < 100; ++y)
    for (int x = 70; x < 75; ++x) map.occupancy[map.geometry.index({x, y})] = 100;
  Navigator nav = *Navigator::make(navigator_spec(), 0.1, map);
  const auto refused = [&](Pose2 goal) {
    const Status set = nav.set_goal({goal, true});
    EXPECT_EQ(nav.state().status, set ? NavStatus::planning : NavStatus::failed);
    return set ? std::string() : set.error().what;
  };
  EXPECT_NE(refused({std::nan(""), 0, 0}).find("not a finite pose"), std::string::npos);
  EXPECT_NE(refused({0, 0, INFINITY}).find("not a finite pose"), std::string::npos);
  EXPECT_NE(refused({80, 0, 0}).find("off the map"), std::string::npos);
  EXPECT_NE(refused({2.2, 0, 0}).find("in an obstacle"), std::string::npos);
  EXPECT_EQ(refused({0, 1, 0}), "");
  // Behind a wall that reaches from side to side there is no way: rounds of recovery, then the reason.
  EXPECT_EQ(refused({4, 0, 0}), "");
  NavigatorStep step;
  Pose2 X;
  double seconds = 0;
  for (; seconds < 300 && step.status != NavStatus::failed; seconds += 0.1) {
    step = nav.step({.X_MB = X, .dt_s = 0.1});
    X = driven(X, step.command, 0.1);
  }
  EXPECT_EQ(step.status, NavStatus::failed);
  EXPECT_NE(nav.state().reason.find("there is no way"), std::string::npos) << nav.state().reason;
  EXPECT_EQ(step.feedback.number_of_recoveries, 3u);
  // Each round: patience 1 s, wait 2 s, back up 3 s, turn 3.2 s.
  EXPECT_LT(seconds, 60);
}

// A jump of the measured velocity: the dynamic window brakes from there in steps of 0.08 m/s.
TEST(Navigator, StaysWithinItsLimitsWhateverVelocityIsMeasured) {
  for (const Chassis chassis : {Chassis::differential, Chassis::omni}) {
    const NavigatorSpec spec = navigator_spec(chassis);
    Navigator nav = *Navigator::make(spec, 0.1, {});
    ASSERT_TRUE(nav.set_goal({{3, 0, 0}, false}));
    for (const PlanarTwist velocity :
         {PlanarTwist{1e9, 0, 0.5}, PlanarTwist{-5, 3, 0}, PlanarTwist{1.3, 0, 40}}) {
      const PlanarTwist v = nav.step({.X_MB = Pose2{}, .velocity = velocity, .dt_s = 0.1}).command;
      EXPECT_LE(v.vx_mps, spec.limits.speed_mps + 1e-12);
      EXPECT_GE(v.vx_mps, -spec.limits.backward_mps - 1e-12);
      EXPECT_LE(std::abs(v.vy_mps), spec.limits.sideways_mps + 1e-12);
      EXPECT_LE(std::abs(v.w_radps), spec.limits.turn_radps + 1e-12);
    }
  }
}

/// A wall ahead, nearer than a car can turn, and a goal behind it. It sees 270 degrees, and a post stands where it does not.
TEST(Navigator, PlansBackwardOverWhatIsKnownAlone) {
  for (const bool sees : {false, true}) {
    Clutter room;
    room.start = {};
    const auto [s, c] = math::sincos(0.6);
    const Vec2 ahead{0.9 * c, 0.9 * s};
    room.polygons = {test::regular(ahead, 0.5, 12, 0), test::regular({-0.75 * c, -0.75 * s}, 0.2, 12, 0)};
    Navigator nav = *Navigator::make(navigator_spec(Chassis::car), 0.1, {});
    const NavigatorRun run = navigator_drive(nav, room, {}, {{-3, -2, 0}, false}, 0.2, 120,
                                             sees ? math::tau : 1.5 * math::pi);
    EXPECT_GT(run.clearance_m, 0) << sees;
    EXPECT_EQ(run.status, sees ? NavStatus::reached : NavStatus::failed) << run.reason;
    if (!sees) { EXPECT_EQ(run.way_m, 0); }
  }
}

TEST(Navigator, StandsWithoutAPoseAndGivesUpInTime) {
  NavigatorSpec spec = navigator_spec();
  spec.time_limit_s = 2;
  Navigator nav = *Navigator::make(spec, 0.1, {});
  ASSERT_TRUE(nav.set_goal({{1, 0, 0}, true}));
  for (int k = 0; k < 10; ++k) {
    const NavigatorStep step = nav.step({.X_MB = Pose2{}, .pose_std_m = 1, .dt_s = 0.1});
    EXPECT_EQ(step.command.vx_mps, 0);
    EXPECT_EQ(step.status, NavStatus::planning);
  }
  for (int k = 0; k < 15; ++k) (void)nav.step({.dt_s = 0.1});
  EXPECT_EQ(nav.state().status, NavStatus::failed);
}

TEST(Navigator, GoesOnFromItsStateWithTheSameBits) {
  const Clutter room = Clutter::random(3, 12);
  Navigator a = *Navigator::make(navigator_spec(), 0.1, {}), b = *Navigator::make(navigator_spec(), 0.1, {});
  ASSERT_TRUE(a.set_goal({{room.goal.x, room.goal.y, 0}, true}));
  Pose2 X{room.start.x, room.start.y, 0};
  for (int k = 0; k < 80; ++k) {
    const msg::LaserScan scan = test::scan(room, {}, X);
    const NavigatorInput in{.X_MB = X, .scan = k % 2 ? nullptr : &scan, .dt_s = 0.1};
    if (k == 31) { ASSERT_TRUE(b.restore(a.state())); }
    const NavigatorStep step = a.step(in);
    if (k >= 31) {
      const NavigatorStep same = b.step(in);
      ASSERT_EQ(step.command.vx_mps, same.command.vx_mps) << k;
      ASSERT_EQ(step.command.w_radps, same.command.w_radps) << k;
    }
    X = driven(X, step.command, 0.1);
  }
  NavigatorState other = a.state();
  other.layer.trust.pop_back();
  EXPECT_FALSE(b.restore(other));
}

}  // namespace
}  // namespace sandlot::navigation
