/// The controller on pictures of the library's test room: what it adds to the library is places, axes and messages.
#include "controllers/visual_odometry/visual_odometry.h"

#include <gtest/gtest.h>

#include "navigation/visual_odometry/test_drive.h"

namespace sandlot::controllers::visual_odometry {
namespace {

using namespace navigation::vo::test;

void put(msg::Image& image, const Picture& picture, const char* encoding) {
  const std::uint32_t channels = std::string_view(encoding) == "mono8" ? 1 : 3;
  image.encoding = encoding;
  image.width = static_cast<std::uint32_t>(picture.width),
  image.height = static_cast<std::uint32_t>(picture.height);
  image.step = image.width * channels;
  image.data.clear();
  for (const std::uint8_t p : picture.pixels) image.data.insert(image.data.end(), channels, p);
}

msg::CameraInfo info_of(double right_of_left_m) {
  msg::CameraInfo info;
  info.width = small_width, info.height = small_height;
  info.p = {small_focal_px,
            0,
            0.5 * (small_width - 1),
            -small_focal_px * right_of_left_m,
            0,
            small_focal_px,
            0.5 * (small_height - 1),
            0,
            0,
            0,
            1,
            0};
  return info;
}

/// A robot with a pair of eyes, or with one, that a test fills.
struct Trial {
  VisualOdometry odometry;
  Outputs outputs{"rover/eyes"};
  Topic<msg::Image> left{"/rover/stereo/left/image"}, right{"/rover/stereo/right/image"};
  Topic<msg::CameraInfo> left_info{"/rover/stereo/left/camera_info"},
      right_info{"/rover/stereo/right/camera_info"};
  std::vector<std::uint64_t> seen{0, 0, 0, 0};
  const char* encoding = "mono8";
  Scene scene;
  Time now;

  explicit Trial(const Pose& X_BS, Eyes eyes = Eyes::stereo) {
    odometry.spec.eyes = eyes;
    odometry.spec.mono.camera.height_m = camera_height_m;
    odometry.spec.mono.camera.pitch_rad = camera_pitch_rad;
    Description robot;
    robot.robot = "rover";
    const bool two = eyes == Eyes::stereo;
    robot.readings = {{two ? "stereo/left/image" : "front", "", msg::Image::ros_type, 0, X_BS},
                      {two ? "stereo/right/image" : "other", "", msg::Image::ros_type, 1, X_BS},
                      {two ? "stereo/left/camera_info" : "front", "", msg::CameraInfo::ros_type, 2, X_BS},
                      {two ? "stereo/right/camera_info" : "other", "", msg::CameraInfo::ros_type, 3, X_BS}};
    odometry.spec.camera = two ? "stereo" : "front";
    const Status ready = odometry.init(robot, outputs);
    EXPECT_TRUE(ready) << ready.error().text();
  }
  void look(const Pose& X_WS) {
    put(left.message, scene.render(X_WS, small_width, small_height, small_focal_px), encoding);
    put(right.message, scene.render(right_of(X_WS, baseline_m), small_width, small_height, small_focal_px),
        encoding);
    left_info.message = info_of(0);
    right_info.message = info_of(baseline_m);
    for (Topic<msg::Image>* const each : {&left, &right}) each->publish(now);
    for (Topic<msg::CameraInfo>* const each : {&left_info, &right_info}) each->publish(now);
  }
  void step(double dt_s) {
    const std::vector<const TopicBase*> topics{&left, &right, &left_info, &right_info};
    Command cmd;
    cmd.bind(&outputs);
    odometry.step(Observation(now, topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd);
    outputs.commit(now);
    seen = {left.count, right.count, left_info.count, right_info.count};
    now = now + Time::from_s(dt_s);
  }
  const Topic<msg::Odometry>& published() const {
    return *topic_cast<msg::Odometry>(outputs.all()[0].topic.get());
  }
};

/// The camera sits 0.2 m before and 0.5 m above the base and looks down: the base moves on level ground as it drove.
TEST(VisualOdometry, MovesTheBaseThatCarriesTheCamera) {
  const Pose X_BS{{0.2, 0.05, camera_height_m}, quat_from_axis_angle({0, 1, 0}, camera_pitch_rad)};
  for (const char* const encoding : {"mono8", "rgb8"}) {
    Trial t(X_BS);
    t.encoding = encoding;
    const std::vector<Pose> way = arc(8, 0.05, 0.03);
    for (const Pose& X_WS : way) {
      t.look(X_WS);
      t.step(0.1);
    }
    const Pose X_SB = inverse(X_BS), X_WB0 = way.front() * X_SB,
               expected = inverse(X_WB0) * (way.back() * X_SB);
    const auto& at = t.published().message;
    EXPECT_EQ(t.published().count, way.size());
    EXPECT_LT(norm(at.pose.pose.p - expected.p), 0.02 * path_length(way));
    EXPECT_LT(angle_between(at.pose.pose.q, expected.q), 0.004);
    EXPECT_NEAR(at.pose.pose.p.z, 0, 0.01);
    EXPECT_NEAR(at.twist.twist.angular.z, 0.3, 0.03);
    const Pose moved = inverse(way[6] * X_SB) * (way[7] * X_SB);
    EXPECT_NEAR(at.twist.twist.linear.x, moved.p.x / 0.1, 0.03);
    EXPECT_NEAR(at.twist.twist.linear.y, moved.p.y / 0.1, 0.03);
    EXPECT_EQ(at.header.frame_id, "rover/visual_odom");
    EXPECT_EQ(at.header.stamp, t.published().stamp);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_GT(at.pose.covariance[7 * i], 0);
      EXPECT_LT(at.pose.covariance[7 * i], 1e-3);
      EXPECT_GT(at.twist.covariance[7 * i], 0);
    }
    EXPECT_TRUE(t.odometry.fits());
  }
}

TEST(VisualOdometry, OfOneEyeHasItsScaleFromTheGround) {
  const Pose X_BS{{0, 0, camera_height_m}, quat_from_axis_angle({0, 1, 0}, camera_pitch_rad)};
  Trial t(X_BS, Eyes::mono);
  const std::vector<Pose> way = arc(8, 0.08, 0.01);
  for (const Pose& X_WS : way) {
    t.look(X_WS);
    t.step(0.1);
  }
  const Pose X_SB = inverse(X_BS), expected = inverse(way.front() * X_SB) * (way.back() * X_SB);
  EXPECT_LT(norm(t.published().message.pose.pose.p - expected.p), 0.05 * path_length(way));
}

TEST(VisualOdometry, SaysNothingOfPicturesThatHaveNoPose) {
  Trial t(Pose{{0, 0, camera_height_m}, {}});
  t.look(camera_at(-2, 0, 0));
  t.step(0.1);
  EXPECT_EQ(t.published().count, 1u);
  t.scene.brightness = 0;  // the light goes out
  t.look(camera_at(-1.95, 0, 0));
  t.step(0.1);
  EXPECT_EQ(t.published().count, 1u);
  t.step(0.1);  // nothing new
  EXPECT_EQ(t.published().count, 1u);
  t.look(camera_at(-1.9, 0, 0));
  t.left.message.encoding = "bayer_rggb8";
  t.step(0.1);
  t.look(camera_at(-1.9, 0, 0));
  t.left.message.data.resize(100);
  t.step(0.1);
  t.look(camera_at(-1.9, 0, 0));
  t.right_info.message.p = {};  // no focal length
  t.step(0.1);
  EXPECT_EQ(t.published().count, 1u);
  t.look(camera_at(-1.9, 0, 0));
  t.left.stamp = t.left.stamp + Time::from_s(0.05);  // not of one moment
  t.step(0.1);
  EXPECT_EQ(t.published().count, 1u);
}

// Away long enough for a gap: the next message's twist is over time in which it did not see, and says so.
TEST(VisualOdometry, TheTwistAcrossAGapIsNotKnown) {
  Trial t(Pose{{0, 0, camera_height_m}, quat_from_axis_angle({0, 1, 0}, camera_pitch_rad)});
  const std::vector<Pose> way = arc(3, 0.03, 0);
  for (std::size_t i = 0; i < 3; ++i) {
    t.look(way[i]);
    t.step(0.1);
  }
  EXPECT_EQ(t.published().count, 3u);
  const double sure = t.published().message.twist.covariance[0];
  EXPECT_LT(sure, 0.1);
  // A picture of another place has features but nothing in common: after `patience` of them there is a gap.
  for (int i = 0; t.odometry.state.track.gaps == 0 && i < 6; ++i) {
    t.look(camera_at(-2, 1.5, 2.5));
    t.step(0.1);
  }
  ASSERT_EQ(t.odometry.state.track.gaps, 1u);
  EXPECT_EQ(t.published().count, 3u);
  t.look(camera_at(-1.98, 1.5, 2.5));
  t.step(0.1);
  ASSERT_EQ(t.published().count, 4u);
  EXPECT_GT(t.published().message.twist.covariance[0], 9999);
  EXPECT_GT(t.published().message.pose.covariance[0], 9998);
  t.look(camera_at(-1.96, 1.5, 2.5));
  t.step(0.1);
  ASSERT_EQ(t.published().count, 5u);
  EXPECT_LT(t.published().message.twist.covariance[0], 0.1);
}

TEST(VisualOdometry, RefusesAStateThatCannotBe) {
  Trial t(Pose{});
  t.look(camera_at(-2, 0, 0));
  t.step(0.1);
  EXPECT_TRUE(t.odometry.fits());
  const State good = t.odometry.state;
  t.odometry.state.pair.left.image.pixels.resize(7);
  EXPECT_FALSE(t.odometry.fits());
  t.odometry.state = good;
  t.odometry.state.track.X_WK.p.x = NAN;
  EXPECT_FALSE(t.odometry.fits());
  t.odometry.state = good;
  t.odometry.state.posed_at = Time{-5};
  EXPECT_FALSE(t.odometry.fits());
}

TEST(VisualOdometry, NamesWhatIsMissing) {
  VisualOdometry odometry;
  Description robot;
  robot.robot = "rover";
  Outputs out("rover/eyes");
  EXPECT_FALSE(odometry.init(robot, out));
  robot.readings = {{"front", "", msg::Image::ros_type, 0, {}},
                    {"front", "", msg::CameraInfo::ros_type, 1, {}}};
  const Status two = odometry.init(robot, out);
  ASSERT_FALSE(two);
  EXPECT_NE(two.error().what.find("front/left/image"), std::string::npos) << two.error().what;
  odometry.spec.eyes = Eyes::mono;
  EXPECT_TRUE(odometry.init(robot, out));
}

}  // namespace
}  // namespace sandlot::controllers::visual_odometry
