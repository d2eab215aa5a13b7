/// The controller in a room, with rays and odometry that a test makes: what it gives is what the library gives.
#include "controllers/localise/localise.h"

#include <gmock/gmock.h>

#include "base/bytes.h"
#include "base/log.h"
#include "navigation/localisation/test_rooms.h"

namespace sandlot::controllers::localise {
namespace {

namespace amcl = navigation::amcl;
using navigation::Pose2;
using navigation::test::Laser;
using testing::HasSubstr;

Pose in_space(const Pose2& X) { return {{X.x, X.y, 0}, quat_from_axis_angle({0, 0, 1}, X.theta)}; }
Pose2 in_plane(const Pose& X) { return {X.p.x, X.p.y, yaw_of(X.q)}; }

/// A small filter of the furnished room.
Spec in_room() {
  Spec spec;
  spec.map.map_data = map_text(navigation::test::furnished_room().map());
  spec.odometry = "odometry";
  spec.min_particles = 200;
  spec.max_particles = 1000;
  return spec;
}

/// The controller of a robot with topics that a test fills. The robot has a second odometry, the truth, which nobody fills.
struct Trial {
  Localiser localiser;
  Outputs outputs{"rover/localiser"};
  Laser laser;
  Topic<msg::LaserScan> scan{"/rover/laser/ranges"};
  Topic<msg::Odometry> odometry{"/rover/odometry/odometry"}, truth{"/rover/truth"};
  std::vector<std::uint64_t> seen{0, 0, 0};
  Status ready;
  Time now;

  explicit Trial(Spec spec) {
    localiser.spec = std::move(spec);
    Description robot;
    robot.robot = "rover";
    robot.readings = {{"laser", "ranges", msg::LaserScan::ros_type, 0, laser.X_BL},
                      {"odometry", "odometry", msg::Odometry::ros_type, 1, {}},
                      {"truth", "", msg::Odometry::ros_type, 2, {}}};
    ready = localiser.init(robot, outputs);
    odometry.message.header.frame_id = "rover/odom";
  }
  void put_odometry(const Pose2& X_OB, double v_mps = 0, double w_radps = 0) {
    odometry.message.pose.pose = in_space(X_OB);
    odometry.message.twist.twist = {{v_mps, 0, 0}, {0, 0, w_radps}};
    odometry.publish(now);
  }
  void put_scan(msg::LaserScan message) {
    scan.message = std::move(message);
    scan.publish(now);
  }
  /// What a client publishes on /rover/initialpose.
  void put_pose(const Pose2& X_MB, const std::string& frame, std::array<double, 36> covariance = {}) {
    auto* const topic = topic_cast<msg::PoseWithCovarianceStamped>(outputs.inputs()[0].topic.get());
    topic->message = {};
    topic->message.header.frame_id = frame;
    topic->message.pose = {in_space(X_MB), covariance};
    topic->stamp = now;
    ++topic->count;
  }
  void step() {
    const std::vector<const TopicBase*> topics{&scan, &odometry, &truth};
    Command cmd;
    cmd.bind(&outputs);
    localiser.step(Observation(now, topics, seen, Stream(1, 2, Purpose::controller, steps_++),
                               std::as_const(outputs).inputs()),
                   cmd);
    outputs.commit(now);
    seen = {scan.count, odometry.count, truth.count};
    for (Outputs::Input& input : outputs.inputs()) input.seen = input.topic->count;
  }
  void step_at(double time_s) {
    now = Time::from_s(time_s);
    step();
  }
  template <class M>
  const Topic<M>& published(std::size_t index) const {
    return *topic_cast<M>(outputs.all()[index].topic.get());
  }
  const Topic<msg::PoseWithCovarianceStamped>& pose() const {
    return published<msg::PoseWithCovarianceStamped>(0);
  }
  amcl::State& filter() { return localiser.state.filter; }

 private:
  std::uint64_t steps_ = 0;
};

/// A robot that wanders in the room.
struct Drive {
  explicit Drive(std::uint64_t seed)
      : world(seed, entity_key("localise test"), Purpose::experiment, 0),
        robot{room, placed(room, world), {3, -2, 1}} {}
  void go(Trial& trial) {
    trial.now = trial.now + Time::from_s(0.1);
    robot.go(world);
    trial.put_odometry(robot.X_OB);
    trial.put_scan(scan_at(room, trial.laser, robot.X_MB, trial.now, world));
    trial.step();
  }
  navigation::test::Room room = navigation::test::furnished_room();
  Stream world;
  navigation::test::Wanderer robot;
};

TEST(Localise, IsWhatTheLibraryGives) {
  Trial t(in_room());
  ASSERT_TRUE(t.ready) << t.ready.error().text();
  const amcl::Model model = *amcl::Model::make(t.localiser.spec, navigation::test::furnished_room().map());
  amcl::Workspace work(model);
  amcl::State alone = amcl::begin(Stream(1, 2, Purpose::controller, 0).bits64());
  amcl::spread(model, alone);
  Drive drive(3);
  for (int i = 0; i < 60; ++i) {
    drive.go(t);
    const Pose2 X_OB = in_plane(t.odometry.message.pose.pose);
    amcl::update(model, alone, work, {t.now, X_OB, t.laser.X_BL}, t.scan.message);
    ASSERT_EQ(t.pose().message.pose.pose, in_space(amcl::pose_at(alone, X_OB))) << i;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at[] = {0, 7, 35};
      ASSERT_EQ(t.pose().message.pose.covariance[at[k]], alone.estimate.covariance[4 * k]);
    }
    ASSERT_EQ(t.pose().message.pose.covariance[5], alone.estimate.covariance[2]) << "of x and the heading";
  }
  EXPECT_GT(alone.count(amcl::Outcome::updated), 10u);
  EXPECT_GT(alone.count(amcl::Outcome::waiting), 10u);
}

TEST(Localise, FindsTheRobotFromAnywhereAndTellsItOnItsTopics) {
  Trial t(in_room());
  Drive drive(4);
  for (int i = 0; i < 300; ++i) drive.go(t);
  const Pose2 found = in_plane(t.pose().message.pose.pose);
  EXPECT_LT(navigation::test::distance(found, drive.robot.X_MB), 0.25);
  EXPECT_LT(navigation::test::turn(found, drive.robot.X_MB), 0.1);
  EXPECT_EQ(t.pose().name(), "/rover/localiser/amcl_pose");
  EXPECT_EQ(t.pose().message.header.frame_id, "map");
  EXPECT_EQ(t.pose().message.header.stamp, t.now);
  // REP 105: the pose of odom in map, which takes the robot's pose in odom to that in map.
  const auto& transform = t.published<msg::TransformStamped>(1);
  EXPECT_EQ(transform.name(), "/rover/localiser/map_to_odom");
  EXPECT_EQ(transform.message.header.frame_id, "map");
  EXPECT_EQ(transform.message.child_frame_id, "rover/odom");
  const Pose X_MO{transform.message.transform.translation, transform.message.transform.rotation};
  const Pose2 placed = in_plane(X_MO * in_space(drive.robot.X_OB));
  EXPECT_NEAR(navigation::test::distance(placed, found), 0, 1e-12);
  EXPECT_NEAR(navigation::test::turn(placed, found), 0, 1e-12);
  const auto& cloud = t.published<msg::PoseArray>(2);
  EXPECT_EQ(cloud.name(), "/rover/localiser/particle_cloud");
  EXPECT_EQ(cloud.message.poses.size(), t.filter().particles.size());
  EXPECT_EQ(cloud.count, t.filter().count(amcl::Outcome::updated));
}

/// Between scans the odometry carries the pose on, and its own velocities from its stamp to now.
TEST(Localise, CarriesThePoseOnAsLongAsTheOdometryIsFresh) {
  Spec spec = in_room();
  spec.begin = Begin::pose;
  spec.x_m = 3, spec.y_m = 2, spec.yaw_rad = math::pi / 2;
  spec.deviation_m = spec.deviation_rad = 0;  // all particles in one place: the scan cannot move the estimate
  Trial t(spec);
  ASSERT_TRUE(t.ready) << t.ready.error().text();
  Stream random(1, 1, Purpose::experiment, 0);
  t.now = Time::from_s(1);
  t.put_odometry({7, 7, 0}, 0.5, 0.2);
  t.put_scan(scan_at(navigation::test::furnished_room(), t.laser, {3, 2, math::pi / 2}, t.now, random));
  t.step();
  EXPECT_NEAR(t.pose().message.pose.pose.p.x, 3, 1e-9);
  EXPECT_NEAR(t.pose().message.pose.pose.p.y, 2, 1e-9);
  // Ahead is y in the map, x in odom: 0.5 m/s for 0.04 s.
  t.step_at(1.04);
  EXPECT_NEAR(t.pose().message.pose.pose.p.x, 3, 1e-9);
  EXPECT_NEAR(t.pose().message.pose.pose.p.y, 2.02, 1e-9);
  EXPECT_NEAR(yaw_of(t.pose().message.pose.pose.q), math::pi / 2 + 0.008, 1e-9);
  t.now = Time::from_s(1.05);
  t.put_odometry({7.1, 7.05, 0.1});
  t.step();
  EXPECT_NEAR(t.pose().message.pose.pose.p.x, 2.95, 1e-9);
  EXPECT_NEAR(t.pose().message.pose.pose.p.y, 2.1, 1e-9);
  // 0.1 s is the age up to which it counts (odometry_age); then there is no pose, until there is odometry again.
  const std::uint64_t before = t.pose().count;
  t.step_at(1.15);
  EXPECT_EQ(t.pose().count, before + 1);
  t.step_at(1.16);
  t.step_at(60);
  EXPECT_EQ(t.pose().count, before + 1) << "no pose is better than one of a minute ago";
  t.put_odometry({7.1, 7.05, 0.1});
  t.step();
  EXPECT_EQ(t.pose().count, before + 2);
}

TEST(Localise, TakesAPoseOfAClientWithItsCovariance) {
  Spec spec = in_room();
  spec.begin = Begin::topic;
  Trial t(spec);
  t.put_odometry({});
  t.step();
  EXPECT_EQ(t.pose().count, 0u) << "it waits for the topic";
  EXPECT_EQ(t.filter().particles.size(), 0u);
  // Of the 36 numbers those of x, y and the turn about z count: here the turn alone. The others are of no account.
  std::array<double, 36> covariance{};
  covariance[14] = covariance[21] = covariance[28] = 0.5;
  covariance[35] = 0.04;
  t.put_pose({4, 2, 0.5}, "map", covariance);
  t.step();
  ASSERT_EQ(t.localiser.state.poses, 1u);
  ASSERT_EQ(t.filter().particles.size(), 1000u);
  double squares = 0;
  for (const amcl::Particle& each : t.filter().particles) {
    ASSERT_EQ(each.pose.x, 4);
    ASSERT_EQ(each.pose.y, 2);
    squares += (each.pose.theta - 0.5) * (each.pose.theta - 0.5);
  }
  // The variance of 1000 samples has a relative standard deviation of sqrt(2 / 1000) = 4.5 %; five of them.
  EXPECT_NEAR(squares / 1000, 0.04, 0.04 * 5 * 0.045);
  EXPECT_EQ(t.pose().message.pose.covariance[35], 0.04);
  t.step();
  EXPECT_EQ(t.localiser.state.poses, 1u) << "it is new once";
  // The frame may be left out, as the console's messages do; x and the turn that belong together stay so.
  covariance = {};
  covariance[0] = covariance[5] = covariance[30] = covariance[35] = 0.04;
  t.put_pose({4, 2, 0.5}, "", covariance);
  t.step();
  ASSERT_EQ(t.localiser.state.poses, 2u);
  // Rounding of the root: sqrt(2^-53 * 0.04) = 2e-9, times five deviations.
  for (const amcl::Particle& each : t.filter().particles)
    ASSERT_NEAR(each.pose.x - 4, each.pose.theta - 0.5, 1.1e-8);
}

TEST(Localise, RefusesPosesThatCannotBe) {
  Trial t(in_room());
  t.put_odometry({});
  t.step();
  const std::vector<amcl::Particle> before = t.filter().particles;
  std::uint64_t refused = 0;
  std::string warning;
  log::set_listener([&](log::Level, std::string_view text) { warning = text; });
  const auto is_refused = [&](const char* why) {
    t.step();
    EXPECT_THAT(warning, testing::HasSubstr(why));
    EXPECT_EQ(t.localiser.state.refused, ++refused);
    EXPECT_EQ(t.localiser.state.poses, 0u);
    for (std::size_t i = 0; i < before.size(); ++i)
      ASSERT_EQ(t.filter().particles[i].pose.x, before[i].pose.x);
  };
  t.put_pose({4, 2, 0}, "odom");
  is_refused("refused: an initial pose in the frame 'odom'; the map is in 'map'");
  t.put_pose({40, 2, 0}, "map");
  is_refused("(40, 2) lies off the map");
  t.put_pose({1e300, 2, 0}, "map");
  is_refused("not finite");
  std::array<double, 36> covariance{};
  covariance[0] = -1;
  t.put_pose({4, 2, 0}, "map", covariance);
  is_refused("not a covariance");
  covariance[0] = 1, covariance[7] = 1, covariance[1] = covariance[6] = 2;
  t.put_pose({4, 2, 0}, "map", covariance);
  is_refused("not a covariance");
  t.put_pose({4, 2, 0}, "map");
  auto* const topic = topic_cast<msg::PoseWithCovarianceStamped>(t.outputs.inputs()[0].topic.get());
  topic->message.pose.pose.q = {0, 0, 0, 0};
  is_refused("without an orientation");
  log::set_listener({});
}

TEST(Localise, GoesOnFromItsStateToTheBit) {
  Trial t(in_room()), other(in_room());
  Drive drive(6);
  for (int i = 0; i < 20; ++i) drive.go(t);
  ByteWriter bytes;
  write(bytes, t.localiser.state);
  ByteReader reader(bytes.bytes());
  read(reader, other.localiser.state);
  ASSERT_TRUE(reader.ok());
  EXPECT_TRUE(other.localiser.fits());
  for (int i = 0; i < 40; ++i) {
    drive.go(t);
    other.now = t.now;
    other.put_odometry(drive.robot.X_OB);
    other.put_scan(t.scan.message);
    other.step();
    ASSERT_EQ(t.pose().message.pose.pose, other.pose().message.pose.pose) << i;
  }
  other.filter().particles.resize(1001);
  EXPECT_FALSE(other.localiser.fits());
  other.localiser.state = {};
  EXPECT_TRUE(other.localiser.fits());
}

TEST(Localise, NamesWhatIsWrongWithItsKeys) {
  const auto refusal = [](void (*spoil)(Spec&)) {
    Spec spec = in_room();
    spoil(spec);
    const Trial t(std::move(spec));
    return t.ready ? "" : t.ready.error().text();
  };
  EXPECT_EQ(refusal([](Spec&) {}), "");
  EXPECT_THAT(refusal([](Spec& s) { s.map.map_data.clear(); }), HasSubstr("there is no map"));
  EXPECT_THAT(refusal([](Spec& s) { s.map.map_data = "2 2 1 0 0 0 3*0"; }), HasSubstr("has 3 cells"));
  EXPECT_THAT(refusal([](Spec& s) { s.map.map_data = "2 2 1 0 0 0 4*100"; }), HasSubstr("no free cell"));
  EXPECT_THAT(refusal([](Spec& s) { s.map.map_data = "2 2 1 0 0 0 4*0"; }), HasSubstr("no occupied cell"));
  EXPECT_THAT(refusal([](Spec& s) { s.begin = Begin::pose, s.x_m = -50; }), HasSubstr("lies off the map"));
  EXPECT_EQ(refusal([](Spec& s) { s.x_m = -50; }), "") << "it begins all over the map";
  EXPECT_THAT(refusal([](Spec& s) { s.odometry.clear(); }), HasSubstr("odometry")) << "there are two";
  EXPECT_THAT(refusal([](Spec& s) { s.laser = "lasr"; }), HasSubstr("laser"));
}

}  // namespace
}  // namespace sandlot::controllers::localise
