#include "controllers/wander/wander.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/math.h"

namespace sandlot::controllers::wander {
namespace {

struct Point {
  double x, y;
};
struct Wall {
  Point a, b;
};

/// A plan of straight walls: distances and ranges that can be written down without any engine.
struct Room {
  std::vector<Wall> walls;

  void polygon(std::initializer_list<Point> corners) {
    const std::vector<Point> p(corners);
    for (std::size_t i = 0; i < p.size(); ++i) walls.push_back({p[i], p[(i + 1) % p.size()]});
  }
  void box(double x, double y, double w, double h) {
    polygon({{x, y}, {x + w, y}, {x + w, y + h}, {x, y + h}});
  }
  double cast(Point from, double angle) const {
    const double dx = math::cos(angle), dy = math::sin(angle);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wall& w : walls) {
      const double ex = w.b.x - w.a.x, ey = w.b.y - w.a.y, det = ex * dy - ey * dx;
      if (std::abs(det) < 1e-12) continue;
      const double ax = w.a.x - from.x, ay = w.a.y - from.y;
      const double t = (ex * ay - ey * ax) / det, u = (dx * ay - dy * ax) / det;
      if (t >= 0 && u >= 0 && u <= 1) nearest = std::min(nearest, t);
    }
    return nearest;
  }
  double distance(Point p) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wall& w : walls) {
      const double ex = w.b.x - w.a.x, ey = w.b.y - w.a.y;
      const double t = std::clamp(((p.x - w.a.x) * ex + (p.y - w.a.y) * ey) / (ex * ex + ey * ey), 0.0, 1.0);
      nearest = std::min(nearest, math::hypot(p.x - w.a.x - t * ex, p.y - w.a.y - t * ey));
    }
    return nearest;
  }
};

struct Scanner {
  int beams = 181;
  double fov_rad = math::pi;
  double max_m = 8;
  double min_m = 0.05;
  double noise_m = 0.0;
};

Description description(const Pose& X_BS = {}) {
  Description robot;
  robot.robot = "rover";
  robot.control_period_s = 0.1;
  robot.readings = {{"laser", "ranges", msg::LaserScan::ros_type, 0, X_BS}};
  robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}}};
  return robot;
}

/// The controller with the simulator's part played by the test: a unicycle that is integrated exactly.
struct Trial {
  Wander wander;
  Topic<msg::LaserScan> topic{"/rover/laser/ranges"};
  Scanner scanner;
  std::uint64_t seed, ticks = 0;
  std::vector<std::uint64_t> seen{0};
  double x = 0, y = 0, theta = 0;
  double v = 0, omega = 0;
  bool blocked = false;  ///< something holds the robot where it is

  explicit Trial(Scanner s, std::uint64_t run_seed = 1, Spec spec = {}) : scanner(s), seed(run_seed) {
    wander.spec = spec;
    const Status ready = wander.init(description());
    EXPECT_TRUE(static_cast<bool>(ready));
    const int gaps = std::max(1, s.beams - 1);
    topic.message.angle_min = static_cast<float>(-s.fov_rad / 2);
    topic.message.angle_max = static_cast<float>(s.fov_rad / 2);
    topic.message.angle_increment = static_cast<float>(s.fov_rad / gaps);
    topic.message.range_min = static_cast<float>(s.min_m);
    topic.message.range_max = static_cast<float>(s.max_m);
    topic.message.ranges.resize(static_cast<std::size_t>(s.beams));
  }
  void scan(const Room& room) {
    Stream noise(seed, 7, Purpose::noise, ticks);
    for (std::size_t i = 0; i < topic.message.ranges.size(); ++i) {
      const double angle = theta + topic.message.angle_min +
                           static_cast<double>(i) * topic.message.angle_increment;
      const double r = room.cast({x, y}, angle);
      topic.message.ranges[i] = r > scanner.max_m ? std::numeric_limits<float>::infinity()
                                : r < scanner.min_m
                                    ? -std::numeric_limits<float>::infinity()
                                    : static_cast<float>(r + scanner.noise_m * noise.normal());
    }
    topic.publish(Time::from_ns(static_cast<std::int64_t>(ticks) * 100'000'000));
  }
  /// One control step on whatever the topic holds.
  void decide() {
    const TopicBase* const topics[] = {&topic};
    const Observation obs(topic.stamp, topics, seen, Stream(seed, 9, Purpose::controller, ticks));
    Command cmd;
    wander.step(obs, cmd);
    seen[0] = topic.count;
    ASSERT_EQ(cmd.orders().size(), 1u);
    ByteReader r(cmd.bytes(cmd.orders()[0]));
    msg::Twist twist;
    read(r, twist);
    v = twist.linear.x;
    omega = twist.angular.z;
    ++ticks;
  }
  void move(double dt) {
    if (blocked) return;
    const double half = 0.5 * omega * dt;
    const double chord = v * dt * (std::abs(half) < 1e-9 ? 1.0 : math::sin(half) / half);
    x += chord * math::cos(theta + half);
    y += chord * math::sin(theta + half);
    theta += 2 * half;
  }
};

/// Two rooms with a door of 0.9 m, a table, a pillar and an acute corner.
Room flat() {
  Room room;
  room.polygon({{0, 0}, {8, 0}, {8, 5}, {9, 6}, {0, 6}});
  room.box(4, 0, 0.1, 3.2);
  room.box(4, 4.1, 0.1, 1.9);
  room.box(1.2, 4.2, 1.0, 0.8);
  room.box(6.0, 2.0, 0.3, 0.3);
  return room;
}

struct Outcome {
  double nearest_m = 1e9;
  double covered = 0;
  double driven_m = 0;
};

Outcome wander_in(const Room& room, Trial& run, double seconds) {
  Outcome out;
  std::set<std::pair<int, int>> visited;
  for (int k = 0; k < static_cast<int>(seconds * 10); ++k) {
    run.scan(room);
    run.decide();
    for (int i = 0; i < 5; ++i) {
      run.move(0.02);
      out.nearest_m = std::min(out.nearest_m, room.distance({run.x, run.y}));
    }
    out.driven_m += std::abs(run.v) * 0.1;
    visited.insert({static_cast<int>(std::floor(run.x / 0.5)), static_cast<int>(std::floor(run.y / 0.5))});
  }
  // Cells whose centre the robot's centre can reach with its margin, inside the flat.
  int free = 0, reached = 0;
  for (int i = 0; i < 18; ++i)
    for (int j = 0; j < 12; ++j) {
      const Point centre{0.25 + 0.5 * i, 0.25 + 0.5 * j};
      const bool inside = centre.x < 8 || centre.y - 5 > centre.x - 8;
      const bool in_table = centre.x > 1.2 && centre.x < 2.2 && centre.y > 4.2 && centre.y < 5.0;
      if (!inside || in_table || room.distance(centre) < 0.35) continue;
      ++free;
      reached += visited.count({i, j}) > 0;
    }
  out.covered = static_cast<double>(reached) / free;
  return out;
}

TEST(Sectors, TakeTheNearestEchoOfEachAndKnowWhatIsNotSeen) {
  // 91 beams over 90 degrees: 30 sectors of 3 degrees. One near beam in the fifth, nothing at all on the left half.
  msg::LaserScan scan;
  scan.angle_min = static_cast<float>(-math::pi / 4);
  scan.angle_increment = static_cast<float>(math::pi / 180);
  scan.range_max = 8;
  scan.ranges.assign(91, 3.0f);
  for (std::size_t i = 46; i < 91; ++i) scan.ranges[i] = std::numeric_limits<float>::infinity();
  scan.ranges[13] = 1.0f;
  scan.ranges[20] = -std::numeric_limits<float>::infinity();
  scan.ranges[25] = NAN;
  Sectors sectors;
  sectors.fill(scan, {});
  ASSERT_EQ(sectors.distance_m.size(), 30u);
  EXPECT_EQ(sectors.distance_m[4], 1.0f);
  EXPECT_EQ(sectors.distance_m[6], 0.0f);
  EXPECT_EQ(sectors.distance_m[0], 3.0f);
  EXPECT_EQ(sectors.distance_m[8], 3.0f);
  EXPECT_TRUE(sectors.echoes[4].seen);
  EXPECT_FALSE(sectors.echoes[20].seen);
}

TEST(Sectors, BetweenSparseBeamsTheNearerNeighbourHolds) {
  msg::LaserScan scan;
  scan.angle_min = static_cast<float>(-math::pi / 4);
  scan.angle_increment = static_cast<float>(math::pi / 4);
  scan.range_max = 8;
  scan.ranges = {1, 5, 2};
  Sectors sectors;
  sectors.fill(scan, {});
  ASSERT_EQ(sectors.distance_m.size(), 30u);
  EXPECT_EQ(sectors.distance_m[3], 1);
  EXPECT_EQ(sectors.distance_m[14], 1);
  EXPECT_EQ(sectors.distance_m[15], 5);
  EXPECT_EQ(sectors.distance_m[16], 2);
}

TEST(Sectors, ACorridorEndsWhereTheDiscTouches) {
  // One echo at (2, 0.1): a disc of 0.5 m moving along x touches it at 2 - sqrt(0.25 - 0.01).
  Sectors sectors;
  sectors.echoes = {{2, 0.1, math::hypot(2, 0.1), true}};
  EXPECT_NEAR(sectors.corridor_m(0, 0.5, 10), 2 - std::sqrt(0.24), 1e-12);
  EXPECT_EQ(sectors.corridor_m(0, 0.09, 10), 10);        // passes beside it
  EXPECT_EQ(sectors.corridor_m(math::pi, 0.5, 10), 10);  // lies behind
  EXPECT_NEAR(sectors.corridor_m(math::atan2(0.1, 2), 0.5, 10), math::hypot(2, 0.1) - 0.5, 1e-12);
  EXPECT_EQ(sectors.corridor_m(0, 0.5, 1), 1);
}

TEST(Wander, DrivesStraightInTheOpenAndStopsBlind) {
  Room nothing;
  Trial trial({});
  trial.wander.state.favourite_left_s = 100;
  trial.scan(nothing);
  trial.decide();
  EXPECT_NEAR(trial.v, trial.wander.spec.speed_mps, 1e-9);
  EXPECT_NEAR(trial.omega, 0, 0.1);             // the headings tried are 5 degrees apart
  for (int k = 0; k < 12; ++k) trial.decide();  // no new scan for more than a second
  EXPECT_EQ(trial.v, 0);
  EXPECT_EQ(trial.omega, 0);
}

TEST(Wander, NeverOrdersMoreThanTheGapAllows) {
  // A wall straight ahead: v <= (d - radius - margin / 2) / reaction.
  for (const double d : {0.31, 0.4, 0.6, 1.0}) {
    Room room;
    room.walls.push_back({{d, -20}, {d, 20}});
    Trial trial({});
    trial.scan(room);
    trial.decide();
    EXPECT_LE(trial.v, (d - 0.25 - 0.05) / 0.6 + 1e-6);
    EXPECT_GE(trial.v, 0);
  }
}

TEST(Wander, TurnsToTheFreerSideAndKeepsToIt) {
  // A pocket, open to the left behind the robot's shoulder.
  Room room;
  room.walls = {{{0.4, -0.4}, {0.4, 3}}, {{-3, -0.4}, {0.4, -0.4}}, {{-3, 0.8}, {0.1, 0.8}}};
  Trial trial({});
  trial.scan(room);
  trial.decide();
  EXPECT_LT(trial.v, 0.02);
  ASSERT_GT(trial.omega, 0.3);
  for (int k = 0; k < 8; ++k) {
    trial.move(0.1);
    trial.scan(room);
    trial.decide();
    EXPECT_GE(trial.omega, 0) << k;
  }
}

TEST(Wander, BacksUpWhenItIsHeld) {
  // Something that the scanner does not see holds the robot: the wall 3 m ahead comes no nearer.
  Room room;
  room.box(-3, -3, 6, 6);
  Trial trial({.noise_m = 0.01});
  trial.wander.state.favourite_left_s = 100;
  trial.blocked = true;
  bool backed = false;
  for (int k = 0; k < 60 && !backed; ++k) {
    trial.scan(room);
    trial.decide();
    backed = trial.v < 0;
  }
  EXPECT_TRUE(backed);
  trial.blocked = false;
  for (int k = 0; k < 100; ++k) {
    trial.scan(room);
    trial.decide();
    trial.move(0.1);
  }
  EXPECT_GT(math::hypot(trial.x, trial.y), 0.3);  // and is off again
}

TEST(Wander, AnotherThingAtTheSameDistanceAheadIsNotBeingStuck) {
  // Always 3 m ahead, while everything else goes by as it should.
  Trial trial({});
  trial.wander.state.favourite_left_s = 100;
  for (int k = 0; k < 60; ++k) {
    Room room;
    room.walls = {{{trial.x + 3, -0.3}, {trial.x + 3, 0.3}},
                  {{5 - 0.05 * k, 1}, {5 - 0.05 * k, 7}},
                  {{5 - 0.05 * k, -7}, {5 - 0.05 * k, -1}}};
    trial.scan(room);
    trial.decide();
    EXPECT_GE(trial.v, 0);
  }
}

TEST(Wander, StateSurvivesSaving) {
  const Room room = flat();
  Trial a({.beams = 61, .fov_rad = 2 * math::pi / 3}), b({.beams = 61, .fov_rad = 2 * math::pi / 3});
  a.x = 2;
  a.y = 2;
  for (int k = 0; k < 300; ++k) {
    a.scan(room);
    a.decide();
    a.move(0.1);
  }
  ByteWriter w;
  write(w, a.wander.state);
  ByteReader r(w.bytes());
  read(r, b.wander.state);
  ASSERT_TRUE(r.ok());
  b.x = a.x;
  b.y = a.y;
  b.theta = a.theta;
  b.ticks = a.ticks;
  for (int k = 0; k < 300; ++k) {
    for (Trial* trial : {&a, &b}) {
      trial->scan(room);
      trial->decide();
      trial->move(0.1);
    }
    ASSERT_EQ(a.x, b.x);
    ASSERT_EQ(a.theta, b.theta);
  }
}

class SlowWander : public testing::TestWithParam<int> {};

TEST_P(SlowWander, CoversTheFlatWithoutTouchingAWall) {
  const Scanner scanners[] = {{},
                              {.beams = 720, .fov_rad = math::tau},
                              {.beams = 25, .fov_rad = math::pi},
                              {.beams = 61, .fov_rad = 2 * math::pi / 3}};
  Scanner scanner = scanners[GetParam() % 4];
  if (GetParam() % 2) scanner.noise_m = 0.01;
  Trial run(scanner, static_cast<std::uint64_t>(GetParam()));
  Stream start(static_cast<std::uint64_t>(GetParam()), 3, Purpose::placement, 0);
  const Room room = flat();
  do {
    run.x = start.uniform(0.5, 7.5);
    run.y = start.uniform(0.5, 5.5);
  } while (room.distance({run.x, run.y}) < 0.5 || (run.x > 1.2 && run.x < 2.2 && run.y > 4.2 && run.y < 5.0));
  run.theta = start.uniform(-3, 3);
  const Outcome out = wander_in(room, run, 600);
  EXPECT_GT(out.nearest_m, run.wander.spec.radius_m);
  EXPECT_GT(out.covered, 0.6);
  EXPECT_GT(out.driven_m, 60);
}

INSTANTIATE_TEST_SUITE_P(Seeds, SlowWander, testing::Range(0, 20));

TEST(Wander, EchoesOfItsOwnPostsAreNoObstacles) {
  // A scanner 0.13 m behind the centre of a robot of radius 0.2 m looks ahead: the rim lies 0.33 m away, a post at 0.25 m is
  // its own and what the neighbouring beams see counts; something at 0.34 m does not belong to it.
  msg::LaserScan scan;
  scan.angle_min = -0.02f;
  scan.angle_increment = 0.02f;
  scan.range_max = 10;
  scan.ranges = {3.0f, 0.25f, 2.5f};
  Sectors sectors;
  const Pose X_BS{{-0.13, 0, 0}, {}};
  sectors.learn_own_body(scan, X_BS, 0.2);
  EXPECT_NEAR(sectors.own_m[1], 0.33f, 1e-6f);
  sectors.fill(scan, X_BS);
  EXPECT_EQ(sectors.distance_m, (std::vector<float>{2.5f}));
  scan.ranges[1] = 0.34f;
  sectors.fill(scan, X_BS);
  EXPECT_EQ(sectors.distance_m, (std::vector<float>{0.34f}));
}

}  // namespace
}  // namespace sandlot::controllers::wander
