#include "controllers/seeker/seeker.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"

namespace sandlot::controllers::seeker {
namespace {

/// A robot that goes where it is told, and a camera that tells of things or shows them.
struct Trial {
  Seeker seeker;
  Topic<msg::ObjectArray> objects{"/robot/eye/objects"};
  Topic<msg::Image> image{"/robot/eye/image"};
  Topic<msg::CameraInfo> info{"/robot/eye/camera_info"};
  std::vector<std::uint64_t> seen{0, 0, 0};
  msg::Twist twist;

  explicit Trial(Spec spec = {}) {
    seeker.spec = std::move(spec);
    Description robot;
    robot.robot = "robot";
    robot.control_period_s = 0.1;
    const Pose X_BS{{0.1, 0, 0.4}, {}};
    robot.readings = {{"eye", "objects", msg::ObjectArray::ros_type, 0, X_BS},
                      {"eye", "image", msg::Image::ros_type, 1, X_BS},
                      {"eye", "image", msg::CameraInfo::ros_type, 2, X_BS}};
    robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}}};
    const Status ready = seeker.init(robot);
    EXPECT_TRUE(static_cast<bool>(ready)) << (ready ? "" : ready.error().text());
  }
  void decide() {
    const TopicBase* const topics[] = {&objects, &image, &info};
    const Observation obs({}, topics, seen, Stream(1, 2, Purpose::controller, 3));
    Command cmd;
    seeker.step(obs, cmd);
    ASSERT_EQ(cmd.orders().size(), 1u);
    ByteReader r(cmd.bytes(cmd.orders()[0]));
    read(r, twist);
    seen = {objects.count, image.count, info.count};
  }
  void tell(const char* label, double x, double y) {
    msg::Object object;
    object.label = label;
    object.position.x = x - 0.1, object.position.y = y, object.position.z = -0.29;
    object.confidence = 1;
    objects.message.objects = {object};
    objects.publish({});
  }
  /// A disc where a pinhole of 200 x 150 pixels, f = 200, sees a ball of 22 cm.
  void show(double x, double y) {
    info.message.width = image.message.width = 200;
    info.message.height = image.message.height = 150;
    info.message.k = {200, 0, 99.5, 0, 200, 74.5, 0, 0, 1};
    info.message.distortion_model = "plumb_bob";
    image.message.step = 600;
    image.message.encoding = "rgb8";
    image.message.data.assign(600 * 150, 80);
    for (int v = 0; v < 150; ++v)
      for (int u = 0; u < 200; ++u) {
        const Vec3 ray = normalised(Vec3{200, 99.5 - u, 74.5 - v}), to{x - 0.1, y, -0.29};
        const double along = dot(ray, to);
        if (dot(to, to) - along * along > 0.11 * 0.11) continue;
        const std::size_t at = 600 * static_cast<std::size_t>(v) + 3 * static_cast<std::size_t>(u);
        image.message.data[at] = 230, image.message.data[at + 1] = 110, image.message.data[at + 2] = 10;
      }
    info.publish({});
    image.publish({});
  }
};

TEST(Seeker, SearchesTurnsDrivesAndStops) {
  Trial t;
  t.decide();
  EXPECT_EQ(t.twist.linear.x, 0);
  EXPECT_EQ(t.twist.angular.z, 1.2);
  t.tell("robot", 2, 0);
  t.decide();
  EXPECT_EQ(t.twist.angular.z, 1.2);  // not what it looks for
  t.tell("ball", 0, -2);
  t.decide();
  EXPECT_EQ(t.twist.linear.x, 0);
  EXPECT_EQ(t.twist.angular.z, -1.2);
  // Unseen it is where the turn took it: after 0.1 s of 1.2 rad/s 0.12 rad nearer to the front.
  t.decide();
  EXPECT_NEAR(math::atan2(t.seeker.state.y_m, t.seeker.state.x_m), -math::pi / 2 + 0.12, 1e-9);
  t.tell("ball", 2, 0);
  t.decide();
  EXPECT_EQ(t.twist.linear.x, 0.5);
  EXPECT_EQ(t.twist.angular.z, 0);
  t.tell("ball", 0.49, 0);  // 4 cm to go at 0.5 m/s^2: 0.2 m/s
  t.decide();
  EXPECT_NEAR(t.twist.linear.x, 0.2, 1e-9);
  t.tell("ball", 0.44, 0);
  t.decide();
  EXPECT_EQ(t.twist.linear.x, 0);
  EXPECT_TRUE(t.seeker.state.arrived);
  t.tell("ball", 0.44, -0.2);
  t.decide();
  for (int i = 0; i < 11; ++i) t.decide();  // unseen for longer than a second: to the side where it was
  EXPECT_EQ(t.twist.angular.z, -1.2);
}

TEST(Seeker, APictureTellsTheSameAsTheListOfObjects) {
  Trial told, shown;
  for (const auto& [x, y] : {std::pair{1.5, 0.2}, {2.5, -0.4}, {1.2, 0.0}}) {
    told.tell("ball", x, y);
    told.decide();
    shown.show(x, y);
    shown.decide();
    // A pixel is 5 mrad; the middle of 150 or more of them is known to a tenth. Along the ground, seen at 6 degrees, ten times that.
    EXPECT_NEAR(shown.seeker.state.x_m, told.seeker.state.x_m, 0.02);
    EXPECT_NEAR(shown.seeker.state.y_m, told.seeker.state.y_m, 0.005);
    EXPECT_NEAR(shown.twist.angular.z, told.twist.angular.z, 0.01);
  }
  EXPECT_EQ(told.seeker.state.in_objects, 3u);
  EXPECT_EQ(shown.seeker.state.in_pictures, 3u);
  // Another lens in the middle of the run: the same disc is half as large and half as far below the horizon, so twice as far away.
  shown.info.message.k[0] = shown.info.message.k[4] = 400;
  shown.info.publish({});
  shown.image.publish({});
  shown.decide();
  EXPECT_EQ(shown.seeker.state.in_pictures, 4u);
  EXPECT_NEAR(shown.seeker.state.x_m, 0.1 + 2 * 1.1, 0.04);
}

TEST(Seeker, SaysWhatIsMissing) {
  Description robot;
  robot.robot = "blind";
  robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}}};
  Seeker seeker;
  const Status ready = seeker.init(robot);
  ASSERT_FALSE(ready);
  EXPECT_NE(ready.error().what.find("blind"), std::string::npos);
  robot.readings = {{"eye", "image", msg::Image::ros_type, 0, {}},
                    {"eye", "image", msg::CameraInfo::ros_type, 1, {}}};
  seeker.spec.label = "goal";
  const Status goal = seeker.init(robot);
  ASSERT_FALSE(goal);
  EXPECT_EQ(goal.error().path, "/label");
}

}  // namespace
}  // namespace sandlot::controllers::seeker
