/// The higher levels of laser scanner, satellite receiver, inertial unit and odometry: their messages, and
/// that they run none of the work below.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>

#include "devices/drives/wheel_odometry/wheel_odometry.h"
#include "devices/inertial/gps/gps.h"
#include "devices/inertial/imu/imu.h"
#include "devices/ranges/laser_scanner/laser_scanner.h"
#include "devices/test_rig.h"

namespace sandlot {
namespace {

using test::config;
using test::Rig;

/// Upright walls seen from above; counts the rays.
class Walls final : public RayCaster {
 public:
  struct Wall {
    Vec3 a, b;
    std::uint32_t body;
  };
  explicit Walls(std::vector<Wall> walls) : walls_(std::move(walls)) {}
  mutable std::atomic<std::size_t> rays{0};

  void cast(std::span<const RayJob> jobs) const override {
    for (const RayJob& job : jobs) {
      rays += job.directions.size();
      for (std::size_t i = 0; i < job.directions.size(); ++i) {
        const Vec3 d = rotate(job.X_WS.q, job.directions[i]);
        double nearest = job.max_m;
        std::uint32_t body = no_body;
        for (const Wall& wall : walls_) {
          const Vec3 along = wall.b - wall.a, to = wall.a - job.X_WS.p;
          const double across = d.x * along.y - d.y * along.x;
          const double t = (to.x * along.y - to.y * along.x) / across;
          const double s = (to.x * d.y - to.y * d.x) / across;
          if (t > 0 && t < nearest && s >= 0 && s <= 1 && wall.body != job.ignore_body)
            nearest = t, body = wall.body;
        }
        job.distance_m[i] = body == no_body ? std::numeric_limits<float>::infinity()
                                            : static_cast<float>(nearest);
        if (!job.body.empty()) job.body[i] = body;
      }
    }
  }

 private:
  std::vector<Wall> walls_;
};

/// A room of one link, 2 m ahead and 1.5 m to each side, and a board of another, 1 m ahead and 0.4 m wide.
Walls room() {
  return Walls({{{-1, -1.5, 0}, {2, -1.5, 0}, 7},
                {{2, -1.5, 0}, {2, 1.5, 0}, 7},
                {{2, 1.5, 0}, {-1, 1.5, 0}, 7},
                {{1, -0.2, 0}, {1, 0.2, 0}, 8}});
}

constexpr std::uint32_t ranges = 1, segments = 2, pose = 4;

void expect_segment(const msg::LineSegment& found, Vec3 start, Vec3 end, double tolerance_m) {
  EXPECT_LE(norm(found.start - start), tolerance_m) << found.start.x << ' ' << found.start.y;
  EXPECT_LE(norm(found.end - end), tolerance_m) << found.end.x << ' ' << found.end.y;
}

TEST(LaserSegments, AreTheStraightPiecesWithTheirCornersAndWhatTheyHide) {
  const Walls walls = room();
  Rig rig(laser_scanner::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", config({}), segments));
  rig.rays = &walls;
  rig.sense();
  const auto& message = rig.topic<msg::LineSegmentArray>("laser/segments").message;
  EXPECT_EQ(message.header.frame_id, "robot1/laser");
  ASSERT_EQ(message.segments.size(), 5u);
  // Between links the gap of 0.035 rad is halved five times: 1.1 mrad, of 2 m some 2.3 mm, of 1 m half of it.
  // A corner within one link is where the chain leaves its chord by 1 cm.
  const double edge = 0.0024, near_edge = 0.0012, corner = 0.02;
  expect_segment(message.segments[0], {0, -1.5, 0}, {2, -1.5, 0}, corner);
  expect_segment(message.segments[1], {2, -1.5, 0}, {2, -0.4, 0}, corner);
  EXPECT_NEAR(message.segments[1].end.y, -0.4, edge);
  expect_segment(message.segments[2], {1, -0.2, 0}, {1, 0.2, 0}, near_edge);
  EXPECT_NEAR(message.segments[3].start.y, 0.4, edge);
  expect_segment(message.segments[3], {2, 0.4, 0}, {2, 1.5, 0}, corner);
  expect_segment(message.segments[4], {2, 1.5, 0}, {0, 1.5, 0}, corner);
  // pi / 0.035 rays and, at two corners and two edges, at most one more in each of five rounds and at its
  // neighbours.
  EXPECT_GE(walls.rays, 91u);
  EXPECT_LE(walls.rays, 91u + 4 * 2 * 5u);
}

TEST(LaserSegments, EndWhereTheRangeDoes) {
  const Walls walls = room();
  Rig rig(laser_scanner::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", config({{"max_range", "1.7"}}), segments));
  rig.rays = &walls;
  rig.sense();
  const auto& found = rig.topic<msg::LineSegmentArray>("laser/segments").message.segments;
  // Of the walls at the sides sqrt(1.7^2 - 1.5^2) = 0.8 m is near enough, of that ahead nothing; a link of
  // 1.1 mrad is 1.1 mm * (1.7 / 1.5) * (1.7 / 0.8) long along the wall.
  ASSERT_EQ(found.size(), 3u);
  expect_segment(found[0], {0, -1.5, 0}, {0.8, -1.5, 0}, 0.005);
  expect_segment(found[1], {1, -0.2, 0}, {1, 0.2, 0}, 0.0012);
  expect_segment(found[2], {0.8, 1.5, 0}, {0, 1.5, 0}, 0.005);
}

TEST(LaserSegments, RoundThingsBecomePolygonsWithinTheTolerance) {
  std::vector<Walls::Wall> many;  // a post of 0.5 m radius, 2 m ahead
  for (int i = 0; i < 720; ++i) {
    const auto at = [](int k) {
      const auto [s, c] = math::sincos(math::tau * k / 720);
      return Vec3{2 + 0.5 * c, 0.5 * s, 0};
    };
    many.push_back({at(i), at(i + 1), 3});
  }
  const Walls post(many);
  Rig rig(laser_scanner::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", config({}), segments));
  rig.rays = &post;
  rig.sense();
  const auto& found = rig.topic<msg::LineSegmentArray>("laser/segments").message.segments;
  // A chord whose middle is 1 cm inside a circle of 0.5 m is 0.2 m long; half the circle's edge is 1.3 m
  // (acos(1/4) to each side).
  EXPECT_GE(found.size(), 7u);
  EXPECT_LE(found.size(), 20u);
  for (const auto& segment : found) {
    const Vec3 middle = 0.5 * (segment.start + segment.end);
    EXPECT_NEAR(norm(segment.start - Vec3{2, 0, 0}), 0.5, 1e-4);
    EXPECT_GE(norm(middle - Vec3{2, 0, 0}), 0.5 - 0.012);
  }
}

TEST(LaserSegments, EndsHaveTheirErrorAndSomeAreMissed) {
  const Walls walls({{{2, -1, 0}, {2, 1, 0}, 7}});
  const auto spread = [&](const char* errors) {
    Rig rig(laser_scanner::kind, test::two_wheels());
    Node node = config({{"errors", errors}});
    node.set("segments", config({{"end_std", "0.1"}, {"miss", "0.25"}}));
    EXPECT_TRUE(rig.add("laser", node, segments));
    rig.rays = &walls;
    double sum = 0, count = 0;
    for (int i = 0; i < 600; ++i) {
      rig.sense();
      for (const auto& s : rig.topic<msg::LineSegmentArray>("laser/segments").message.segments) {
        sum += (s.start.x - 2) * (s.start.x - 2) + (s.end.x - 2) * (s.end.x - 2);
        count += 2;
      }
    }
    return std::pair(std::sqrt(sum / count), count / 2 / 600);
  };
  // 900 deviates: their rms has a relative deviation of 1 / sqrt(1800) = 2.4 %; the share of 3/4 one of 1.8
  // %. Five of them.
  EXPECT_NEAR(spread("1").first, 0.1, 0.1 * 5 * 0.024);
  EXPECT_NEAR(spread("1").second, 0.75, 5 * 0.018);
  EXPECT_NEAR(spread("2").first, 0.2, 0.2 * 5 * 0.029);
  EXPECT_NEAR(spread("2").second, 0.5, 5 * 0.0205);
  EXPECT_NEAR(spread("0").first, 0, 1e-6);
  EXPECT_EQ(spread("0").second, 1);
}

TEST(LaserLevels, RunNoneOfTheWorkBelow) {
  const Walls walls = room();
  Rig rig(laser_scanner::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("laser", config({{"beams", "181"}}), pose));
  rig.rays = &walls;
  const auto rays_of = [&](std::uint32_t level) {
    EXPECT_TRUE(rig.switch_level(level));
    const std::size_t before = walls.rays;
    rig.sense();
    return walls.rays - before;
  };
  EXPECT_EQ(rays_of(pose), 0u);
  EXPECT_EQ(rays_of(ranges), 181u);
  const std::size_t few = rays_of(segments);
  EXPECT_LT(few, 181u);
  EXPECT_EQ(rays_of(ranges | segments | pose), 181 + few);
  EXPECT_EQ(rig.topic<msg::LaserScan>("laser/ranges").count, 2u);
  EXPECT_EQ(rig.topic<msg::LineSegmentArray>("laser/segments").count, 2u);
  EXPECT_EQ(rig.topic<msg::PoseWithCovarianceStamped>("laser/pose").count, 2u);
}

TEST(LaserLevels, OneLevelsNumbersDoNotDependOnAnother) {
  const Walls walls = room();
  const auto last_scan = [&](std::uint32_t levels) {
    Rig rig(laser_scanner::kind, test::two_wheels());
    Node node = config({});
    node.set("noise", config({{"white", "0.01"}}));
    node.set("segments", config({{"end_std", "0.1"}}));
    node.set("pose_error", config({{"position_std", "0.1"}}));
    EXPECT_TRUE(rig.add("laser", node, levels));
    rig.rays = &walls;
    for (int i = 0; i < 3; ++i) rig.sense();
    return rig.topic<msg::LaserScan>("laser/ranges").message.ranges;
  };
  EXPECT_EQ(last_scan(ranges), last_scan(ranges | segments | pose));
}

TEST(LaserPose, IsTheRobotsPoseWithItsErrorsAndItsCovariance) {
  Rig rig(laser_scanner::kind, test::two_wheels(), 0.1);
  Node node = config({{"rate", "0"}, {"errors", "2"}});
  node.set("pose_error", config({{"position_std", "0.05"}, {"yaw_std", "0.02"}, {"correlation", "0.001"}}));
  ASSERT_TRUE(rig.add("laser", node, pose, 0, {{0.3, 0, 0.2}, {}}));
  rig.engine->body[0].X_WB = pose_from_rpy({3, 4, 0.1}, {0, 0, 1});
  double x2 = 0, yaw2 = 0;
  const int n = 2000;  // independent: 0.1 s is a hundred times the correlation time
  for (int i = 0; i < n; ++i) {
    rig.sense();
    const auto& m = rig.topic<msg::PoseWithCovarianceStamped>("laser/pose").message;
    x2 += (m.pose.pose.p.x - 3) * (m.pose.pose.p.x - 3) + (m.pose.pose.p.y - 4) * (m.pose.pose.p.y - 4);
    yaw2 += math::pow(math::wrap_angle(yaw_of(m.pose.pose.q) - 1), 2);
    EXPECT_EQ(m.pose.pose.p.z, 0.1);
  }
  const auto& m = rig.topic<msg::PoseWithCovarianceStamped>("laser/pose").message;
  EXPECT_EQ(m.header.frame_id, "world");
  EXPECT_NEAR(m.pose.covariance[0], 0.01, 1e-15);
  EXPECT_NEAR(m.pose.covariance[35], 0.0016, 1e-15);
  // Relative deviation of an rms of n: 1 / sqrt(2 n). Five of them.
  EXPECT_NEAR(std::sqrt(x2 / (2 * n)), 0.1, 0.1 * 5 / std::sqrt(4.0 * n));
  EXPECT_NEAR(std::sqrt(yaw2 / n), 0.04, 0.04 * 5 / std::sqrt(2.0 * n));
}

TEST(LaserPose, IsLostAsOftenAndAsLongAsConfigured) {
  Rig rig(laser_scanner::kind, test::two_wheels(), 0.1);
  Node node = config({{"rate", "0"}});
  node.set("pose_error", config({{"lost_rate", "0.5"}, {"lost_time", "2"}, {"lost_position_std", "100"}}));
  ASSERT_TRUE(rig.add("laser", node, pose));
  int lost = 0, times = 0;
  bool was = false;
  const int n = 20'000;
  for (int i = 0; i < n; ++i) {
    rig.sense();
    const bool is = rig.topic<msg::PoseWithCovarianceStamped>("laser/pose").message.pose.pose.p.x != 0;
    lost += is;
    times += is && !was;
    was = is;
  }
  // 2 s lost, 2 s not: half of the time, in 500 turns of 4 s. The share's deviation over T = 2000 s is
  // sqrt(2 * 0.5 * 0.5 / T) = 1.6 %, the number's sqrt(500 / 2); samples 0.1 s apart stretch both by 0.05 s
  // of 2 s.
  EXPECT_NEAR(static_cast<double>(lost) / n, 0.5, 5 * 0.016 + 0.0125);
  EXPECT_NEAR(times, 500, 5 * 16 + 13);
}

TEST(GpsPose, TellsThePoseAndComputesNoFix) {
  Rig rig(gps::kind, test::two_wheels());
  rig.geography = model::Geography{0.8, 0.1, 500, 0.3};
  ASSERT_TRUE(rig.add("gps", config({}), 4, 0, {{0, 0, 2}, {}}));
  const Pose X_WB = pose_from_rpy({30, -4, 0.1}, {0.1, 0, 2});
  rig.engine->body[0].X_WB = X_WB;
  rig.sense();
  const auto& m = rig.topic<msg::PoseWithCovarianceStamped>("gps/pose").message;
  EXPECT_EQ(m.pose.pose, X_WB);
  EXPECT_EQ(rig.topic<msg::NavSatFix>("gps/fix").count, 0u);
  EXPECT_EQ(rig.topic<msg::TwistStamped>("gps/velocity").count, 0u);
  ASSERT_TRUE(rig.switch_level(5));
  rig.sense();
  EXPECT_EQ(rig.topic<msg::NavSatFix>("gps/fix").count, 1u);
}

TEST(ImuPose, DriftsAsAnIntegratedWalkDoes) {
  // In thirty samples or in one: the walk is discretised exactly.
  for (const int steps : {30, 1}) {
    Rig rig(imu::kind, test::two_wheels(), 3.0 / steps);
    // In one sample its own part of the position, b / sqrt(12), makes a quarter of the variance: 13 % of the
    // deviation, which 6000 deviates show within 5 %.
    const int n = steps == 1 ? 2000 : 200;
    Node node = config({{"rate", "0"}});
    node.set("pose_error", config({{"velocity_walk", "0.3"}, {"yaw_walk", "0.02"}}));
    for (int i = 0; i < n; ++i) ASSERT_TRUE(rig.add("imu" + std::to_string(i), node, 2));
    const Pose X_WB{{5, 6, 0}, {}};
    rig.engine->body[0].X_WB = X_WB;
    rig.sense();
    EXPECT_EQ(rig.topic<msg::PoseWithCovarianceStamped>("imu0/pose").message.pose.pose, X_WB);
    for (int i = 0; i < steps; ++i) rig.act(), rig.sense();
    double p2 = 0, yaw2 = 0;
    for (int i = 0; i < n; ++i) {
      const auto& m = rig.topic<msg::PoseWithCovarianceStamped>("imu" + std::to_string(i) + "/pose").message;
      const Vec3 off = m.pose.pose.p - X_WB.p;
      p2 += dot(off, off);
      yaw2 += math::pow(yaw_of(m.pose.pose.q), 2);
      // q^2 t^3 / 3 at 3 s, whatever the rate.
      EXPECT_NEAR(m.pose.covariance[7], 0.09 * 9, 1e-12);
      EXPECT_NEAR(m.pose.covariance[35], 0.0004 * 3, 1e-15);
    }
    EXPECT_NEAR(std::sqrt(p2 / (3 * n)), 0.9, 0.9 * 5 / std::sqrt(6.0 * n));
    EXPECT_NEAR(std::sqrt(yaw2 / n), 0.02 * std::sqrt(3.0), 0.0347 * 5 / std::sqrt(2.0 * n));
    EXPECT_EQ(rig.topic<msg::Imu>("imu0/imu").count, 0u);
  }
}

TEST(ImuPose, BeginsAnewWhenItIsSwitchedOnAndTheImuWithAnIntervalOfItsOwn) {
  Rig rig(imu::kind, test::two_wheels(), 0.1);
  Node node = config({{"rate", "0"}});
  node.set("pose_error", config({{"velocity_walk", "1"}}));
  ASSERT_TRUE(rig.add("imu", node, 2));
  for (int i = 0; i < 9; ++i) rig.sense();
  const auto& told = rig.topic<msg::PoseWithCovarianceStamped>("imu/pose").message.pose;
  EXPECT_NE(told.pose.p.x, 0);
  ASSERT_TRUE(rig.switch_level(1));
  rig.engine->body[0].V_WB.linear = {50, 0, 0};  // nobody looked while it changed: no blow
  rig.act();
  rig.sense();
  const Vec3 force = rig.topic<msg::Imu>("imu/imu").message.linear_acceleration;
  EXPECT_NEAR(force.x, 0, 1e-12);
  EXPECT_NEAR(force.z, 9.81, 1e-12);
  ASSERT_TRUE(rig.switch_level(2));
  rig.sense();
  EXPECT_EQ(told.pose.p.x, rig.engine->body[0].X_WB.p.x);
  EXPECT_EQ(told.covariance[0], 0);
}

/// Wheels of 0.1 m radius; `more` goes into the level pose.
Node odometer(std::initializer_list<std::pair<const char*, const char*>> more) {
  Node node = config({{"left_joint", "left"},
                      {"right_joint", "right"},
                      {"wheel_radius", "0.1"},
                      {"wheel_separation", "0.5"},
                      {"rate", "0"}});
  node.set("pose_error", config(more));
  return node;
}

TEST(OdometryPose, FollowsTheTrueMotionSidewaysToo) {
  Rig rig(wheel_odometry::kind, test::two_wheels(), 0.1);
  rig.engine->body[0].X_WB = pose_from_rpy({7, 8, 0}, {0, 0, 3.0});
  ASSERT_TRUE(rig.add("odo", odometer({}), 2));
  rig.sense();
  const auto& told = rig.topic<msg::Odometry>("odo/pose").message;
  EXPECT_EQ(told.pose.pose, Pose{});
  // 1 m forward, then 0.5 m to the left, then a turn through the seam at pi.
  const Pose steps[] = {{{1, 0, 0}, {}}, {{0, 0.5, 0}, {}}, pose_from_rpy({}, {0, 0, 0.5})};
  for (const Pose& step : steps) {
    rig.engine->body[0].X_WB = rig.engine->body[0].X_WB * step;
    rig.sense();
  }
  EXPECT_NEAR(told.pose.pose.p.x, 1, 1e-12);
  EXPECT_NEAR(told.pose.pose.p.y, 0.5, 1e-12);
  EXPECT_NEAR(yaw_of(told.pose.pose.q), 0.5, 1e-12);
  EXPECT_NEAR(told.twist.twist.angular.z, 5, 1e-10);
  EXPECT_EQ(rig.topic<msg::Odometry>("odo/odometry").count, 0u);
  EXPECT_EQ(told.header.frame_id, "robot1/odom");
}

TEST(OdometryPose, ErrorsGrowWithTheWayAsTheCovarianceSays) {
  Rig rig(wheel_odometry::kind, test::two_wheels(), 0.1);
  const int n = 400;
  for (int i = 0; i < n; ++i)
    ASSERT_TRUE(rig.add("odo" + std::to_string(i),
                        odometer({{"distance_walk", "0.05"}, {"heading_walk", "0.02"}}), 2));
  rig.sense();
  for (int k = 0; k < 40; ++k) {  // 10 m straight on
    rig.engine->body[0].X_WB.p.x += 0.25;
    rig.sense();
  }
  double x2 = 0, y2 = 0, yaw2 = 0;
  for (int i = 0; i < n; ++i) {
    const Pose& p = rig.topic<msg::Odometry>("odo" + std::to_string(i) + "/pose").message.pose.pose;
    x2 += (p.p.x - 10) * (p.p.x - 10);
    y2 += p.p.y * p.p.y;
    yaw2 += math::pow(yaw_of(p.q), 2);
  }
  // x: 0.05 sqrt(10), less 3 cm of foreshortening (10 h^2 / 6 of 0.004 = 7 mm); heading: 0.02 sqrt(10);
  // y: heading walk integrated over the way, 0.02 sqrt(10^3 / 3).
  const double rms = 5 / std::sqrt(2.0 * n);
  EXPECT_NEAR(std::sqrt(x2 / n), 0.1581, 0.1581 * rms + 0.01);
  EXPECT_NEAR(std::sqrt(yaw2 / n), 0.0632, 0.0632 * rms);
  EXPECT_NEAR(std::sqrt(y2 / n), 0.3651, 0.3651 * rms);
  // The covariance is taken at each one's own heading: of one whose heading erred little it is nearly the
  // same.
  const auto& P = rig.topic<msg::Odometry>("odo0/pose").message.pose.covariance;
  EXPECT_NEAR(P[35], 0.0004 * 10, 1e-12);
  EXPECT_NEAR(P[0] + P[7], 0.0025 * 10 + 0.0004 * 1000 / 3, 0.01);
}

TEST(OdometryPose, OneLevelGoesOnFromWhereTheOtherIs) {
  Rig rig(wheel_odometry::kind, test::two_wheels(), 0.1);
  ASSERT_TRUE(rig.add("odo", odometer({}), 1));
  rig.engine->joint[0].position = rig.engine->joint[1]
                                      .position = 10;  // the wheels measure 1 m, the robot slipped
  rig.engine->body[0].X_WB.p.x = 0.8;
  rig.sense();
  ASSERT_TRUE(rig.switch_level(2));
  rig.sense();
  EXPECT_NEAR(rig.topic<msg::Odometry>("odo/pose").message.pose.pose.p.x, 1, 1e-12);
  rig.engine->joint[0].position = rig.engine->joint[1].position = 100;  // wheels spin: nobody looks at them
  rig.engine->body[0].X_WB.p.x = 1.3;
  rig.sense();
  EXPECT_NEAR(rig.topic<msg::Odometry>("odo/pose").message.pose.pose.p.x, 1.5, 1e-12);
  ASSERT_TRUE(rig.switch_level(1));
  rig.engine->joint[0].position = rig.engine->joint[1].position = 102;
  rig.sense();
  EXPECT_NEAR(rig.topic<msg::Odometry>("odo/odometry").message.pose.pose.p.x, 1.7, 1e-12);
}

TEST(LevelsState, GoesOnWithTheSameBitsAfterSaving) {
  const Walls walls = room();
  const auto same = [&](const Kind& kind, const Node& node, std::uint32_t level, const char* topic) {
    Rig one(kind, test::two_wheels(), 0.1), two(kind, test::two_wheels(), 0.1);
    one.geography = two.geography = model::Geography{0.8, 0.1, 500, 0};
    one.rays = two.rays = &walls;
    EXPECT_TRUE(one.add("d", node, level));
    EXPECT_TRUE(two.add("d", node, level));
    for (int i = 0; i < 5; ++i) one.engine->body[0].X_WB.p.x += 0.1, one.sense();
    two.load(one.saved());
    two.sample = one.sample;
    two.engine->body = one.engine->body;
    one.sense();
    two.sense();
    const auto bytes = [&](Rig& rig) {
      std::vector<std::byte> out;
      rig.topics.at(std::string("/robot1/d/") + topic)->to_cdr(out);
      return out;
    };
    EXPECT_EQ(bytes(one), bytes(two)) << topic;
  };
  Node laser = config({});
  laser.set("pose_error", config({{"position_std", "0.1"}, {"lost_rate", "5"}}));
  same(laser_scanner::kind, laser, pose, "pose");
  Node inertial = config({});
  inertial.set("pose_error", config({{"velocity_walk", "0.1"}, {"yaw_walk", "0.1"}}));
  same(imu::kind, inertial, 2, "pose");
  same(wheel_odometry::kind, odometer({{"heading_walk", "0.1"}}), 2, "pose");
  Node receiver = config({});
  receiver.set("pose_error", config({{"position_std", "1"}, {"vertical_std", "1"}}));
  same(gps::kind, receiver, 4, "pose");
}

}  // namespace
}  // namespace sandlot
