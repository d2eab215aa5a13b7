#include "programs/robios/robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "messages/command.h"
#include "messages/sensor_images.h"

namespace sandlot::programs::robios {
namespace {

using namespace sandlot::robios;

/// A robot with one of everything: topics that a test fills, and what was ordered.
class OneOfEverything : public testing::Test {
 protected:
  template <class M>
  Topic<M>& reading(const char* device) {
    auto topic = std::make_unique<Topic<M>>(std::string("/r/") + device);
    Topic<M>& out = *topic;
    description.readings.push_back(
        {device, "", M::ros_type, static_cast<std::uint32_t>(description.readings.size()), {}});
    topics.push_back(std::move(topic));
    return out;
  }
  template <class M>
  void actuator(const char* device) {
    description.actuators.push_back(
        {device, "", M::ros_type, static_cast<std::uint32_t>(description.actuators.size()), {}});
  }
  void SetUp() override {
    description.robot = "r";
    ranges[0] = &reading<msg::Range>("PSD_FRONT");
    ranges[1] = &reading<msg::Range>("PSD_LEFT");
    shown = &reading<msg::Image>("screen");
    image = &reading<msg::Image>("camera");
    odometry = &reading<msg::Odometry>("drive");
    progress = &reading<msg::DriveProgress>("drive");
    presses = &reading<msg::KeyPresses>("keys");
    speaker = &reading<msg::SpeakerState>("speaker");
    ticks = &reading<msg::Int64Stamped>("left_encoder");
    reading<msg::Int64Stamped>("counter");
    contacts = &reading<msg::ContactsState>("bumper");
    imu = &reading<msg::Imu>("imu");
    battery = &reading<msg::BatteryState>("battery");
    scan = &reading<msg::LaserScan>("laser");
    reading<msg::RadioReceptionArray>("radio");
    actuator<msg::Twist>("drive");
    actuator<msg::DriveManeuver>("drive");
    actuator<msg::ScreenPatch>("screen");
    actuator<msg::Sound>("speaker");
    actuator<msg::RadioPacket>("radio");
    actuator<msg::Float64>("arm");
    for (const auto& each : topics) {
      views.push_back(each.get());
      seen.push_back(0);
    }
    state.robots = {"other", "r"};
    state.number = 2;
  }
  void find(const char* drive = "diff_drive") {
    ASSERT_TRUE(robot.find(description,
                           {{"drive",
                             drive,
                             {},
                             {{"wheel_radius", 0.03},
                              {"wheel_separation", 0.2},
                              {"max_linear_speed", 0.6},
                              {"max_angular_speed", 1e9}}},
                            {"screen", "screen", {}, {{"width", 128}, {"height", 64}}},
                            {"left_encoder", "wheel_encoder", {}, {{"ticks_per_turn", 540}}},
                            {"arm", "joint_motor", {"position"}, {}}},
                           spec));
  }
  Observation seeing() { return {Time::from_s(1), views, seen, Stream(1, 2, Purpose::controller, 3)}; }
  /// Carries an order out. @return the message that the actuator gets; nothing: none
  template <class M>
  std::optional<M> ordered(const Order& order, std::uint32_t actuator) {
    Command cmd;
    if (!robot.carry_out(order, state, cmd) || cmd.orders().size() != 1) return std::nullopt;
    EXPECT_EQ(cmd.orders()[0].slot, actuator);
    Topic<M> slot("/r/x/command");
    EXPECT_TRUE(slot.assign(cmd.bytes(cmd.orders()[0])));
    return slot.message;
  }

  Description description;
  std::vector<std::unique_ptr<TopicBase>> topics;
  std::vector<const TopicBase*> views;
  std::vector<std::uint64_t> seen;
  Topic<msg::Range>* ranges[2] = {};
  Topic<msg::Image>*shown = nullptr, *image = nullptr;
  Topic<msg::Odometry>* odometry = nullptr;
  Topic<msg::DriveProgress>* progress = nullptr;
  Topic<msg::KeyPresses>* presses = nullptr;
  Topic<msg::SpeakerState>* speaker = nullptr;
  Topic<msg::Int64Stamped>* ticks = nullptr;
  Topic<msg::ContactsState>* contacts = nullptr;
  Topic<msg::Imu>* imu = nullptr;
  Topic<msg::BatteryState>* battery = nullptr;
  Topic<msg::LaserScan>* scan = nullptr;
  Spec spec;
  State state;
  RobotDevices robot;
  std::unique_ptr<Senses> senses = std::make_unique<Senses>();
};

TEST_F(OneOfEverything, IsDescribed) {
  find();
  sandlot::robios::Robot out{};
  robot.describe(spec, state, out);
  EXPECT_STREQ(out.name, "r");
  EXPECT_EQ(out.id, 2u);
  EXPECT_EQ(out.drive, Drive::differential);
  EXPECT_DOUBLE_EQ(out.wheel_diameter_m, 0.06);
  EXPECT_DOUBLE_EQ(out.track_m, 0.2);
  EXPECT_DOUBLE_EQ(out.max_speed_mps, 0.6);
  EXPECT_LT(out.max_turning_rate_radps, 100) << "no limit is none that a program can use";
  EXPECT_DOUBLE_EQ(out.max_motor_radps, 20);
  EXPECT_EQ(out.motors, 2u);
  EXPECT_EQ(out.servos, 1u);
  EXPECT_EQ(out.distances, 2u);
  EXPECT_STREQ(out.distance_names[1], "PSD_LEFT");
  EXPECT_EQ(out.distance_numbers[1], 2);
  EXPECT_EQ(out.ticks_per_turn, 540u);
  EXPECT_EQ(out.screen_width, 128u);
  for (const std::uint32_t has : {out.has_camera, out.has_lidar, out.has_radio, out.has_keys, out.has_screen,
                                  out.has_speaker, out.has_compass, out.has_battery})
    EXPECT_EQ(has, 1u);
}

TEST_F(OneOfEverything, DistancesHaveTheNumbersThatWereGiven) {
  spec.distances = {"PSD_LEFT", "", "PSD_FRONT"};
  find();
  sandlot::robios::Robot out{};
  robot.describe(spec, state, out);
  EXPECT_STREQ(out.distance_names[0], "PSD_LEFT");
  EXPECT_EQ(out.distance_numbers[1], 3);
  spec.distances = {"-205=PSD_LEFT", "7=PSD_FRONT"};
  RobotDevices older;
  ASSERT_TRUE(older.find(description, {}, spec));
  older.describe(spec, state, out);
  EXPECT_STREQ(out.distance_names[0], "PSD_LEFT");
  EXPECT_EQ(out.distance_numbers[0], -205);
  EXPECT_EQ(out.distance_numbers[1], 7);
  spec.distances = {"two=PSD_LEFT"};
  EXPECT_FALSE(RobotDevices().find(description, {}, spec));
  spec.distances = {"PSD_LEFD"};
  const Status wrong = RobotDevices().find(description, {}, spec);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().text(), testing::HasSubstr("PSD_LEFT"));
}

TEST_F(OneOfEverything, SensesWhatItsDevicesSay) {
  find();
  ranges[0]->message.min_range = 0.05f;
  ranges[0]->message.max_range = 2;
  ranges[0]->message.range = 0.5f;
  ranges[0]->count = 9;
  ranges[1]->message.max_range = 2;
  ranges[1]->message.range = std::numeric_limits<float>::infinity();
  ranges[1]->count = 1;
  odometry->message.pose.pose.p = {1, 2, 0};
  odometry->message.pose.pose.q = quat_from_rpy(0, 0, 0.5);
  odometry->message.twist.twist.linear.x = 0.3;
  progress->message.maneuvers = 4;
  progress->message.done = false;
  progress->message.remaining_distance = 0.7;
  progress->message.stalled = {2, 400};
  presses->message.count = 20;
  for (std::uint32_t i = 0; i < 20; ++i) presses->message.latest.push_back({i, 0, 0});
  speaker->message.playing = true;
  ticks->message.data = -77;
  contacts->message.states.resize(1);
  imu->message.orientation = quat_from_rpy(0, 0, -1);
  battery->message.voltage = 7.5f;
  scan->message.ranges = {1, 2, 3};
  scan->count = 1;
  std::uint64_t sent = 0;
  robot.sense(seeing(), state, *senses, sent);
  EXPECT_DOUBLE_EQ(senses->distance_m[0], 0.5);
  EXPECT_EQ(senses->distance_count[0], 9u);
  EXPECT_LT(senses->distance_m[1], 0);
  EXPECT_DOUBLE_EQ(senses->x_m, 1);
  EXPECT_NEAR(senses->phi_rad, 0.5, 1e-12);
  EXPECT_EQ(senses->v_mps, 0.3);
  EXPECT_EQ(senses->maneuvers, 4u);
  EXPECT_EQ(senses->maneuver_done, 0u);
  EXPECT_EQ(senses->remaining_m, 0.7);
  EXPECT_EQ(senses->stalled, 2u);
  EXPECT_EQ(senses->key_presses, 20u);
  EXPECT_EQ(senses->keys, 16u);
  EXPECT_EQ(senses->key[0].key, 4u);
  EXPECT_EQ(senses->key[15].key, 19u);
  EXPECT_EQ(senses->speaker_busy, 1u);
  EXPECT_EQ(senses->encoder_ticks[0], -77);
  EXPECT_EQ(senses->bumper[0], 1u);
  EXPECT_NEAR(senses->compass_rad, -1, 1e-12);
  EXPECT_EQ(senses->battery_V, 7.5);
  EXPECT_EQ(senses->beams, 3u);
  EXPECT_EQ(senses->beam_m[2], 3);
  EXPECT_EQ(senses->image_width, 0u);
}

TEST_F(OneOfEverything, PicturesAreOfTheCameraAndColoursStay) {
  find();
  shown->message.encoding = "rgb8";  // what the screen shows is no picture
  shown->message.width = shown->message.height = 1;
  shown->message.data = {9, 9, 9};
  shown->count = 5;
  image->message.encoding = "bgr8";
  image->message.width = 2;
  image->message.height = 1;
  image->message.data = {1, 2, 3, 4, 5, 6};
  image->count = 1;
  image->stamp = Time::from_s(0.9);
  std::uint64_t sent = 0;
  robot.sense(seeing(), state, *senses, sent);
  EXPECT_EQ(senses->image_width, 2u);
  EXPECT_EQ(senses->image_time_ns, 900'000'000);
  EXPECT_THAT(std::span(senses->image, 6), testing::ElementsAre(3, 2, 1, 6, 5, 4));
  // A message that does not hold what it says leaves the old one.
  image->message.data.pop_back();
  image->count = 2;
  robot.sense(seeing(), state, *senses, sent);
  EXPECT_EQ(senses->image_count, 1u);
}

TEST_F(OneOfEverything, OrdersBecomeCommands) {
  find();
  const auto twist = ordered<msg::Twist>(SpeedOrder{0.2, -1}, 0);
  ASSERT_TRUE(twist);
  EXPECT_EQ(twist->linear.x, 0.2);
  EXPECT_EQ(twist->angular.z, -1);
  const auto maneuver = ordered<msg::DriveManeuver>(ManeuverOrder{2, 0, 0.5, 1.5, 0, 0, 0.3, 0}, 1);
  ASSERT_TRUE(maneuver);
  EXPECT_EQ(maneuver->kind, msg::DriveManeuver::curve);
  EXPECT_EQ(maneuver->angle, 1.5);
  EXPECT_EQ(maneuver->speed, 0.3);
  const std::vector<std::byte> rgb(6, std::byte{7});
  const auto patch = ordered<msg::ScreenPatch>(ScreenPixels{{126, 63, 2, 1}, rgb}, 2);
  ASSERT_TRUE(patch);
  EXPECT_EQ(patch->x, 126u);
  EXPECT_EQ(patch->data.size(), 6u);
  EXPECT_FALSE(ordered<msg::ScreenPatch>(ScreenPixels{{127, 63, 2, 1}, rgb}, 2)) << "beyond the screen";
  const auto text = ordered<msg::ScreenPatch>(ScreenLines{{"GO"}, {"one", "two"}}, 2);
  ASSERT_TRUE(text);
  EXPECT_TRUE(text->has_text);
  EXPECT_EQ(text->width, 0u);
  EXPECT_EQ(text->lines.size(), 2u);
  const auto sound = ordered<msg::Sound>(SoundNamed{{440, 0.5}, ""}, 3);
  ASSERT_TRUE(sound);
  EXPECT_EQ(sound->frequency, 440);
  const auto packet = ordered<msg::RadioPacket>(Packet{1, rgb}, 4);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->to, "other");
  EXPECT_EQ(ordered<msg::RadioPacket>(Packet{0, rgb}, 4)->to, "");
  EXPECT_FALSE(ordered<msg::RadioPacket>(Packet{3, rgb}, 4)) << "there is no third robot";
  const auto servo = ordered<msg::Float64>(ServoOrder{0, 0.75}, 5);
  ASSERT_TRUE(servo);
  EXPECT_NEAR(servo->data, 3.14159265358979 / 4, 1e-9);
  Command picture;
  EXPECT_TRUE(robot.carry_out(PictureOrder{}, state, picture));
  EXPECT_TRUE(picture.orders()[0].is_sample());
  EXPECT_EQ(picture.orders()[0].reading(), 3u);
}

TEST_F(OneOfEverything, MotorsAreTheSidesOfTheDrive) {
  find();
  // Left at 0.3 m/s, the right still stands: the middle at half of it, turning by 0.3 m/s on 0.2 m to the right.
  const auto left = ordered<msg::Twist>(MotorOrder{0, 0, 0.5}, 0);
  ASSERT_TRUE(left);
  EXPECT_NEAR(left->linear.x, 0.15, 1e-12);
  EXPECT_NEAR(left->angular.z, -1.5, 1e-12);
  const auto both = ordered<msg::Twist>(MotorOrder{1, 1, 10}, 0);  // rad/s on wheels of 3 cm
  ASSERT_TRUE(both);
  EXPECT_NEAR(both->linear.x, 0.3, 1e-12);
  EXPECT_NEAR(both->angular.z, 0, 1e-12);
  EXPECT_FALSE(ordered<msg::Twist>(MotorOrder{2, 0, 1}, 0));
}

TEST_F(OneOfEverything, MotorsAreTheWheelsOfAMecanumDrive) {
  actuator<msg::JointState>("drive");
  find("mecanum_drive");
  sandlot::robios::Robot out{};
  robot.describe(spec, state, out);
  EXPECT_EQ(out.motors, 4u);
  EXPECT_STREQ(out.motor_names[1], "frontright");
  // Half of 0.6 m/s on wheels of 3 cm; what was ordered before stays.
  const auto first = ordered<msg::JointState>(MotorOrder{1, 0, -0.5}, 6);
  ASSERT_TRUE(first);
  EXPECT_THAT(first->velocity, testing::ElementsAre(0, testing::DoubleNear(-10, 1e-9), 0, 0));
  const auto second = ordered<msg::JointState>(MotorOrder{3, 1, 7}, 6);
  ASSERT_TRUE(second);
  EXPECT_THAT(second->velocity,
              testing::ElementsAre(0, testing::DoubleNear(-10, 1e-9), 0, testing::DoubleNear(7, 1e-9)));
  EXPECT_FALSE(ordered<msg::JointState>(MotorOrder{4, 0, 1}, 6));
}

TEST_F(OneOfEverything, MotorAndServoOneDriveACar) {
  find("ackermann_drive");
  sandlot::robios::Robot out{};
  robot.describe(spec, state, out);
  EXPECT_EQ(out.motors, 1u);
  EXPECT_EQ(out.servos, 2u);
  EXPECT_STREQ(out.servo_names[0], "steering");
  // Half of 0.6 m/s; the wheels turn by 0.6 rad at most, on a wheelbase of 1.5 times the track of 0.2 m.
  constexpr double tangent = 0.6841368083416923;
  const auto ahead = ordered<msg::Twist>(MotorOrder{0, 0, 0.5}, 0);
  ASSERT_TRUE(ahead);
  EXPECT_NEAR(ahead->linear.x, 0.3, 1e-12);
  EXPECT_NEAR(ahead->angular.z, 0, 1e-12);
  const auto left = ordered<msg::Twist>(ServoOrder{0, 0}, 0);
  ASSERT_TRUE(left);
  EXPECT_NEAR(left->linear.x, 0.3, 1e-12);
  EXPECT_NEAR(left->angular.z, tangent, 1e-9);
  EXPECT_NEAR(ordered<msg::Twist>(ServoOrder{0, 1}, 0)->angular.z, -tangent, 1e-9);
  EXPECT_NEAR(ordered<msg::Twist>(MotorOrder{0, 0, -0.5}, 0)->angular.z, tangent, 1e-9);
  EXPECT_NEAR(ordered<msg::Float64>(ServoOrder{1, 0.75}, 5)->data, 3.14159265358979 / 4, 1e-9);
  EXPECT_FALSE(ordered<msg::Twist>(MotorOrder{1, 0, 1}, 0));
}

TEST_F(OneOfEverything, ItsOdometryBeginsWhereItIsSet) {
  find();
  // The drive counts (1, 2) at a heading of 90 degrees; that place shall be (5, 0) at 0.
  constexpr double quarter = 1.5707963267948966;
  state.odometry = {1, 2, quarter};
  Command none;
  EXPECT_TRUE(robot.carry_out(PoseOrder{5, 0, 0}, state, none));
  EXPECT_TRUE(none.orders().empty());
  odometry->message.pose.pose.p = {1, 3, 0};  // a metre on, straight ahead
  odometry->message.pose.pose.q = quat_from_rpy(0, 0, quarter);
  std::uint64_t sent = 0;
  robot.sense(seeing(), state, *senses, sent);
  EXPECT_NEAR(senses->x_m, 6, 1e-12);
  EXPECT_NEAR(senses->y_m, 0, 1e-12);
  EXPECT_NEAR(senses->phi_rad, 0, 1e-12);
}

TEST_F(OneOfEverything, ARobotWithoutDevicesRefusesAll) {
  RobotDevices bare;
  ASSERT_TRUE(bare.find({}, {}, spec));
  Command cmd;
  for (const Order& order :
       std::vector<Order>{SpeedOrder{}, ManeuverOrder{}, MotorOrder{}, ServoOrder{}, ScreenPixels{},
                          ScreenLines{}, SoundNamed{}, Packet{}, PictureOrder{}})
    EXPECT_FALSE(bare.carry_out(order, state, cmd)) << order.index();
  EXPECT_TRUE(cmd.orders().empty());
}

}  // namespace
}  // namespace sandlot::programs::robios
