#include "devices/drives/wheel_odometry/wheel_odometry.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/test_rig.h"

namespace sandlot::wheel_odometry {
namespace {

using test::config;
using test::Rig;

/// The wheels of two_wheels() turn about the joints' z, which lies along y of the base.
struct Bench : Rig {
  explicit Bench(std::initializer_list<std::pair<const char*, const char*>> more = {}, double axle_x = 0)
      : Rig(kind, test::two_wheels(axle_x), 0.1) {
    Node node = config({{"left_joint", "left"},
                        {"right_joint", "right"},
                        {"wheel_radius", "0.1"},
                        {"wheel_separation", "0.5"},
                        {"rate", "0"}});
    for (const auto& [key, value] : more) node.set(key, Node::scalar(value));
    const Status added = add("odo", node);
    EXPECT_TRUE(added) << (added ? "" : added.error().text());
  }
  const msg::Odometry& roll(double left_rad, double right_rad, int n = 1) {
    for (int i = 0; i < n; ++i) {
      engine->joint[0].position += left_rad / n;
      engine->joint[1].position += right_rad / n;
      sense();
    }
    return topic<msg::Odometry>("odo/odometry").message;
  }
};

TEST(WheelOdometry, GoesStraightAndRoundAsTheWheelsTurn) {
  Bench bench({}, 0.2);  // the axle lies 0.2 m before the base's origin
  msg::Odometry at = bench.roll(10, 10);
  EXPECT_NEAR(at.pose.pose.p.x, 1, 1e-14);
  EXPECT_NEAR(at.twist.twist.linear.x, 10, 1e-12);  // in one tick of 0.1 s
  // On the spot by 90 degrees: 0.25 m * pi / 2 = 0.1 m * 3.927 rad of each wheel. The origin goes round the
  // axle.
  const double turn = 0.25 * math::pi / 2 / 0.1;
  at = bench.roll(-turn, turn);
  EXPECT_NEAR(yaw_of(at.pose.pose.q), math::pi / 2, 1e-14);
  EXPECT_NEAR(at.pose.pose.p.x, 1.2, 1e-14);
  EXPECT_NEAR(at.pose.pose.p.y, -0.2, 1e-14);
  EXPECT_NEAR(at.twist.twist.angular.z, math::pi / 2 / 0.1, 1e-11);
  EXPECT_NEAR(at.twist.twist.linear.y, -0.2 * math::pi / 2 / 0.1, 1e-11);
  for (const double c : at.pose.covariance) EXPECT_EQ(c, 0);
}

TEST(WheelOdometry, IsResetAndSetByItsServices) {
  Bench bench({{"alpha_3", "0.01"}}, 0.2);  // 0.01 m^2 per m
  bench.roll(10, 10);
  const auto call = [&](const char* name, const auto& request, auto& response) -> Status {
    std::vector<std::byte> asked, answer;
    write_cdr(message_info<std::remove_cvref_t<decltype(request)>>(), &request, asked);
    const auto service = service_of(kind, "robot1/odo", name);
    EXPECT_TRUE(service);
    SL_TRY(bench.pool->call(0, **service, asked, answer, bench.context(bench.now)));
    return read_cdr(message_info<std::remove_cvref_t<decltype(response)>>(), answer, &response);
  };
  Odometer::Trigger::Response done;
  ASSERT_TRUE(call("reset", Odometer::Trigger::Request{}, done));
  EXPECT_TRUE(done.success);
  msg::Odometry at = bench.roll(0, 0);
  EXPECT_NEAR(norm(at.pose.pose.p), 0, 1e-15);
  EXPECT_EQ(at.pose.covariance[0], 0);

  // At (3, 4) and turned to the left, 1 m ahead is 1 m along y. The covariance given grows by 0.01 m^2 along the way.
  Odometer::SetPose::Request request;
  request.pose.header.frame_id = "robot1/odom";
  request.pose.pose.pose = {{3, 4, 9}, quat_from_rpy(0, 0, math::pi / 2)};
  request.pose.pose.covariance[0] = 0.5;
  request.pose.pose.covariance[7] = 0.25;
  Odometer::SetPose::Response none;
  ASSERT_TRUE(call("set_pose", request, none));
  at = bench.roll(10, 10);
  EXPECT_NEAR(at.pose.pose.p.x, 3, 1e-12);
  EXPECT_NEAR(at.pose.pose.p.y, 5, 4.5 * 0.1);
  EXPECT_NEAR(at.pose.covariance[0], 0.5, 1e-12);
  EXPECT_NEAR(at.pose.covariance[7], 0.26, 1e-12);

  const auto refused = [&](auto&& spoil) {
    Odometer::SetPose::Request bad = request;
    spoil(bad.pose);
    const Status status = call("set_pose", bad, none);
    return status ? std::string() : status.error().text();
  };
  EXPECT_EQ(refused([](auto& p) { p.header.frame_id = "map"; }),
            "the pose is in 'map'; give it in 'robot1/odom'");
  EXPECT_EQ(refused([](auto& p) { p.pose.pose.p.x = NAN; }), "the pose is not finite");
  EXPECT_EQ(refused([](auto& p) { p.pose.covariance[5] = INFINITY; }), "the covariance is not finite");
  EXPECT_EQ(refused([](auto& p) { p.pose.covariance[35] = -1; }), "the covariance has a negative variance");
  EXPECT_NEAR(bench.roll(0, 0).pose.pose.p.x, 3, 1e-12) << "refused calls change nothing";
}

TEST(WheelOdometry, SystematicErrorsBendTheWay) {
  // UMBmark: with the right wheels believed 1 % larger, 10 m become an arc that turns by 0.1 m / 0.5 m.
  Bench unequal({{"right_error", "0.01"}});
  msg::Odometry at = unequal.roll(100, 100, 100);
  EXPECT_NEAR(yaw_of(at.pose.pose.q), 0.2, 1e-12);
  const double radius = 10.05 / 0.2;
  EXPECT_NEAR(at.pose.pose.p.y, radius * (1 - math::cos(0.2)), 1e-9);
  // A separation believed 10 % too large: a turn by 90 degrees is taken for one by 90 / 1.1.
  Bench wide({{"separation_error", "0.1"}});
  at = wide.roll(-0.25 * math::pi / 2 / 0.1, 0.25 * math::pi / 2 / 0.1, 7);
  EXPECT_NEAR(yaw_of(at.pose.pose.q), math::pi / 2 / 1.1, 1e-12);
}

TEST(WheelOdometry, OneFactorScalesAllOfItsErrors) {
  Bench exact({{"right_error", "0.01"}, {"separation_error", "0.1"}, {"alpha_2", "1"}, {"errors", "0"}});
  msg::Odometry at = exact.roll(100, 100, 100);
  EXPECT_NEAR(at.pose.pose.p.x, 10, 1e-12);
  EXPECT_NEAR(yaw_of(at.pose.pose.q), 0, 1e-12);
  for (const double c : at.pose.covariance) EXPECT_EQ(c, 0);
  Bench twice({{"right_error", "0.01"}, {"errors", "2"}});
  EXPECT_NEAR(yaw_of(twice.roll(100, 100, 100).pose.pose.q), 0.4, 1e-12);
  // Variances go by the square: 10 m of 1e-4 rad^2/m, four times.
  Bench random({{"alpha_2", "1e-4"}, {"errors", "2"}});
  EXPECT_NEAR(random.roll(100, 100, 100).pose.covariance[35], 4 * 10 * 1e-4, 1e-12);
  // However large the factor, a wheel stays a wheel.
  Bench large({{"separation_error", "-0.1"}, {"errors", "10"}});
  EXPECT_NEAR(yaw_of(large.roll(-1, 1).pose.pose.q), 0.1 * 2 / (0.5 * 0.5), 1e-12);
}

TEST(WheelOdometry, RandomErrorsGrowWithTheWayWhateverTheRateAndAsTheCovarianceSays) {
  // 4 m straight on: var(x) = alpha_3 d; heading alpha_2 d; y: the heading's random walk integrated, alpha_2
  // d^3 / 3.
  for (const int samples : {40, 160}) {
    double xx = 0, yy = 0, tt = 0;
    std::array<double, 36> said{};
    constexpr int runs = 2000;
    for (int run = 0; run < runs; ++run) {
      Bench bench({{"alpha_2", "1e-4"}, {"alpha_3", "1e-3"}});
      bench.seed = static_cast<std::uint64_t>(run) + 1;
      const msg::Odometry& at = bench.roll(40, 40, samples);
      xx += (at.pose.pose.p.x - 4) * (at.pose.pose.p.x - 4);
      yy += at.pose.pose.p.y * at.pose.pose.p.y;
      tt += yaw_of(at.pose.pose.q) * yaw_of(at.pose.pose.q);
      said = at.pose.covariance;
    }
    // Variances of 2000 runs are good to sqrt(2 / 2000) = 3.2 %; five of them. Bending shortens x by 1e-4 * 4
    // * ... = 2e-4 m^2.
    EXPECT_NEAR(xx / runs, 4e-3, 4e-3 * 0.16);
    EXPECT_NEAR(yy / runs, 1e-4 * 64 / 3, 1e-4 * 64 / 3 * 0.17);
    EXPECT_NEAR(tt / runs, 4e-4, 4e-4 * 0.16);
    EXPECT_NEAR(said[35], 4e-4, 1e-12);
    EXPECT_NEAR(said[0], 4e-3, 4e-3 * 0.1);
    EXPECT_NEAR(said[7], 1e-4 * 64 / 3, 1e-4 * 64 / 3 * 0.2);  // along the way it took, not the straight one
    EXPECT_EQ(said[5], said[30]);
  }
}

TEST(WheelOdometry, ASavedOdometerGoesOnWithTheSameBits) {
  Bench one({{"alpha_1", "1e-3"}, {"alpha_2", "1e-3"}, {"alpha_3", "1e-3"}}),
      two({{"alpha_1", "1e-3"}, {"alpha_2", "1e-3"}, {"alpha_3", "1e-3"}});
  one.roll(3, 4, 10);
  two.load(one.saved());
  two.sample = one.sample;
  two.engine->joint = one.engine->joint;
  one.roll(1, 2, 3);
  two.roll(1, 2, 3);
  EXPECT_EQ(one.saved(), two.saved());
}

TEST(WheelOdometry, RefusesWhatIsNoWheel) {
  Rig rig(kind, test::two_wheels());
  Node node = config({{"left_joint", "left"},
                      {"right_joint", "lift"},
                      {"wheel_radius", "0.1"},
                      {"wheel_separation", "0.5"}});
  const Status status = rig.add("odo", node);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().place.line, 2);
}

}  // namespace
}  // namespace sandlot::wheel_odometry
