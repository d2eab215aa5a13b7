#include "devices/cameras/pan_tilt/pan_tilt.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/test_rig.h"

namespace sandlot::pan_tilt {
namespace {

using test::config;
using test::Rig;
using S = msg::PanTiltState;

constexpr std::uint32_t joints_bit = 1, view_bit = 2;

/// A base with a neck that turns about z at 1 m and a head on it that turns about y; the head's joint may
/// point the other way.
model::Model owl(double pan_up = 1, double tilt_left = 1) {
  model::Model model;
  model.name = "owl";
  for (const char* name : {"base", "neck", "head"}) model.links.push_back({.name = name});
  model.links[1].X_ML.p = model.links[2].X_ML.p = {0, 0, 1};
  model.joints = {{.name = "pan",
                   .type = model::JointType::revolute,
                   .parent = 0,
                   .child = 1,
                   .axis_J = {0, 0, pan_up},
                   .lower = -3,
                   .upper = 3},
                  {.name = "tilt",
                   .type = model::JointType::revolute,
                   .parent = 1,
                   .child = 2,
                   .axis_J = {0, tilt_left, 0},
                   .lower = -1,
                   .upper = 1.2}};
  return model;
}

/// The camera's detections, as the test says.
class Found final : public TopicFinder {
 public:
  const TopicBase* find_topic(std::string_view name) const override {
    if (name == zoom.name()) return &zoom;
    return name == objects.name() ? &objects : nullptr;
  }
  Topic<msg::ObjectArray> objects{"/robot1/eye/objects"};
  Topic<msg::Float64> zoom{"/robot1/eye/zoom"};
  Topic<msg::Float64> told{"/robot1/eye/zoom/command"};
};

/// Writes orders into a slot.
class Into final : public OrderSink {
 public:
  explicit Into(TopicBase& slot) : slot_(slot) {}
  bool take(std::span<const std::byte> message, Time now) override {
    if (!slot_.assign(message)) return false;
    slot_.stamp = now;
    ++slot_.count;
    return true;
  }
  const TopicBase* latest(Time) const override { return &slot_; }

 private:
  TopicBase& slot_;
};

class Owl : public Rig {
 public:
  explicit Owl(double pan_up = 1, double tilt_left = 1)
      : Rig(kind, owl(pan_up, tilt_left)), pan_up_(pan_up), tilt_left_(tilt_left) {
    model::DeviceDecl eye;
    eye.name = "eye";
    eye.link = 2;
    eye.X_LS.p = {0.1, 0, 0};
    instance.devices.push_back(eye);
    finder = &found;
  }
  Status mount(std::uint32_t level, std::initializer_list<std::pair<const char*, const char*>> more = {}) {
    Node node = config({{"pan_joint", "pan"}, {"tilt_joint", "tilt"}, {"camera", "eye"}});
    for (const auto& [key, value] : more) node.set(key, Node::scalar(value));
    SL_TRY(add("head", std::move(node), level));
    for (const auto& order : orders) {
      EXPECT_EQ(order->slot(), found.told.name());
      order->connect(std::make_unique<Into>(found.told));
    }
    return {};
  }
  /// Ticks, with links where the joints have them.
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      act();
      place();
      sense();
    }
  }
  void place() {
    const Pose& base = engine->body[0].X_WB;
    engine->body[1].X_WB = base * Pose{{0, 0, 1},
                                       quat_from_axis_angle({0, 0, 1}, pan_up_ * engine->joint[0].position)};
    engine->body[2].X_WB = engine->body[1].X_WB *
                           Pose{{}, quat_from_axis_angle({0, 1, 0}, tilt_left_ * engine->joint[1].position)};
  }
  Pose eye() const { return engine->body[2].X_WB * Pose{{0.1, 0, 0}, {}}; }
  /// Angle between where the eye looks and a point.
  double off(Vec3 point_W) const {
    const Vec3 p = inverse(eye()) * point_W;
    return math::atan2(std::sqrt(p.y * p.y + p.z * p.z), p.x);
  }
  void look(const std::string& frame, Vec3 point) {
    msg::PointStamped message;
    message.header.frame_id = frame;
    message.point = point;
    command("head/view", message);
  }
  void tell(const char* text) { command("head/view/task", msg::String{text}); }
  /// What a camera that sees 30 degrees to each side tells of a ball.
  void see(Vec3 ball_W) {
    found.objects.message.objects.clear();
    const Vec3 p = inverse(eye()) * ball_W;
    if (off(ball_W) < math::pi / 6) {
      msg::Object object;
      object.label = "ball";
      object.position = p;
      found.objects.message.objects.push_back(object);
    }
    ++found.objects.count;
  }
  std::uint8_t status() { return topic<msg::PanTiltState>("head/status").message.status; }

  Found found;

 private:
  double pan_up_, tilt_left_;
};

TEST(PanTilt, TurnsToAnglesWithItsSpeedAndAcceleration) {
  Owl owl;
  ASSERT_TRUE(owl.mount(joints_bit, {{"max_pan_speed", "1"}, {"max_acceleration", "4"}}));
  msg::JointState wanted;
  wanted.name = {"tilt", "pan"};
  wanted.position = {-0.3, 2};
  owl.command("head/joints", wanted);
  double fastest = 0, steepest = 0, before = 0;
  int ticks = 0;
  while (ticks < 400 && std::abs(owl.engine->joint[0].position - 2) > 0.01) {
    owl.run(1), ++ticks;
    const double v = owl.engine->joint[0].velocity;
    fastest = std::max(fastest, v);
    steepest = std::max(steepest, (v - before) / 0.01);
    before = v;
  }
  EXPECT_NEAR(fastest, 1, 1e-12);
  EXPECT_LE(steepest, 4 + 1e-9);
  // 2 rad at 1 rad/s and one ramp up and one down of 0.25 s each: 2.25 s; the last hundredth comes slower.
  EXPECT_NEAR(0.01 * ticks, 2.25, 0.1);
  owl.run(100);
  EXPECT_NEAR(owl.engine->joint[0].position, 2, 1e-3);
  EXPECT_NEAR(owl.engine->joint[1].position, -0.3, 1e-3);
  EXPECT_EQ(owl.status(), S::idle);
  const msg::JointState& shown = owl.topic<msg::JointState>("head/state").message;
  EXPECT_EQ(shown.name, (std::vector<std::string>{"pan", "tilt"}));
  EXPECT_NEAR(shown.position.at(0), 2, 1e-3);
}

TEST(PanTilt, TurnsAtASpeedUntilItsLimit) {
  Owl owl;
  ASSERT_TRUE(owl.mount(joints_bit));
  msg::JointState wanted;
  wanted.velocity = {-0.5};
  owl.command("head/joints", wanted);
  owl.run(200);
  EXPECT_NEAR(owl.engine->joint[0].position, -1, 0.02);
  owl.run(600);
  EXPECT_NEAR(owl.engine->joint[0].position, -3, 0.03);
  EXPECT_EQ(owl.engine->joint[0].velocity, 0);
}

TEST(PanTilt, LooksAtPointsWhicheverWayItsAxesPoint) {
  for (const auto& [up, left] : {std::pair{1.0, 1.0}, {-1.0, 1.0}, {1.0, -1.0}}) {
    Owl owl(up, left);
    ASSERT_TRUE(owl.mount(view_bit));
    const Vec3 point{-1, 2, 0.6};
    owl.look("world", point);
    owl.run(300);
    EXPECT_LT(owl.off(point), 1e-3) << up << left;
    EXPECT_EQ(owl.status(), S::arrived);
    // In the frame of the robot, which stands at (5, 0, 0) and looks back.
    owl.engine->body[0].X_WB = {{5, 0, 0}, quat_from_axis_angle({0, 0, 1}, math::pi)};
    owl.place();
    owl.look("robot1/base", {2, -1, 1});
    owl.run(300);
    EXPECT_LT(owl.off({3, 1, 1}), 1e-3) << up << left;
  }
}

TEST(PanTilt, SaysWhatIsOutOfReachAndIgnoresUnknownFrames) {
  Owl owl;
  ASSERT_TRUE(owl.mount(view_bit));
  owl.look("", {0.3, 0, 9});  // nearly straight up: beyond a tilt of -1
  owl.run(300);
  EXPECT_EQ(owl.status(), S::out_of_reach);
  EXPECT_NEAR(owl.engine->joint[1].position, -1, 1e-3);
  owl.look("robot9/base", {1, 0, 1});
  owl.look("", {std::nan(""), 0, 1});
  owl.run(100);
  EXPECT_EQ(owl.status(), S::out_of_reach);
}

TEST(PanTilt, SearchesTracksAndLoses) {
  Owl owl;
  ASSERT_TRUE(owl.mount(view_bit, {{"lost_after", "0.2"}}));
  owl.tell("search ball");
  Vec3 ball{-2, -1, 0.7};
  const auto run = [&](int ticks, bool there) {
    for (int i = 0; i < ticks; ++i) {
      owl.see(there ? ball : Vec3{0, 0, -100});
      owl.run(1);
    }
  };
  run(100, true);
  EXPECT_EQ(owl.status(), S::searching);
  EXPECT_NEAR(owl.engine->joint[0].velocity, 1, 1e-9);  // search_speed
  run(900, true);
  EXPECT_EQ(owl.status(), S::arrived);
  EXPECT_LT(owl.off(ball), 0.01);

  owl.tell("track ball");
  run(2, true);
  EXPECT_EQ(owl.status(), S::tracking);
  for (int i = 0; i < 200; ++i) {  // it rolls by at 0.5 m/s: the eye keeps up
    ball.y -= 0.005;
    run(1, true);
  }
  EXPECT_EQ(owl.status(), S::tracking);
  EXPECT_LT(owl.off(ball), 0.03);
  run(15, false);
  EXPECT_EQ(owl.status(), S::tracking);
  run(10, false);
  EXPECT_EQ(owl.status(), S::lost);
  owl.tell("stop");
  run(100, true);
  EXPECT_EQ(owl.status(), S::idle);
}

/// The owl with a zoom lens that gets to 8 by at most a factor of 2 a second, as a camera that samples in
/// every tick turns it.
class ZoomingOwl : public Owl {
 public:
  ZoomingOwl() {
    Node zoom = config({{"max", "8"}, {"rate", "2"}});
    instance.devices[0].config = Node::map({});
    instance.devices[0].config.set("zoom", std::move(zoom));
    found.zoom.message.data = 1;
  }
  void run_zooming(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      act();
      place();
      double& zoom = found.zoom.message.data;
      const double most = math::pow(2, tick.s());
      if (found.told.count > 0) zoom = std::clamp(found.told.message.data, zoom / most, zoom * most);
      ++found.zoom.count;
      sense();
    }
  }
  const msg::PanTiltState& told_status() { return topic<msg::PanTiltState>("head/status").message; }
};

TEST(PanTilt, PassesZoomOnAtEitherLevelAndTellsWhereItIs) {
  for (const std::uint32_t level : {joints_bit, view_bit}) {
    ZoomingOwl owl;
    ASSERT_TRUE(owl.mount(level));
    owl.run_zooming(1);
    EXPECT_EQ(owl.found.told.count, 0u) << "nobody asked for anything";
    EXPECT_EQ(owl.told_status().zoom_target, 1);
    EXPECT_EQ(owl.status(), S::idle);
    owl.command("head/zoom", msg::Float64{4});
    owl.run_zooming(100);
    EXPECT_EQ(owl.found.told.count, 1u) << "told once";
    EXPECT_NEAR(owl.told_status().zoom, 2, 1e-9);  // 2^1
    EXPECT_EQ(owl.told_status().zoom_target, 4);
    EXPECT_EQ(owl.status(), S::moving);
    owl.run_zooming(101);
    EXPECT_EQ(owl.told_status().zoom, 4);
    EXPECT_EQ(owl.status(), S::idle);
    owl.command("head/zoom", msg::Float64{100});
    owl.run_zooming(1);
    EXPECT_EQ(owl.told_status().zoom_target, 8) << "no longer than its lens";
  }
}

TEST(PanTilt, KeepsTheSizeOfWhatItLooksAtAndSearchesWide) {
  ZoomingOwl owl;
  ASSERT_TRUE(owl.mount(view_bit, {{"zoom_per_m", "0.5"}, {"search_zoom", "1.5"}, {"lost_after", "0.2"}}));
  // Ahead of the eye, which sits 0.1 m before the axes at a height of 1 m: 6 m away.
  owl.look("", {6.1, 0, 1});
  owl.run_zooming(400);
  EXPECT_NEAR(owl.told_status().zoom, 3, 1e-6);
  owl.tell("search ball");
  owl.run_zooming(200);
  EXPECT_EQ(owl.told_status().zoom, 1.5);
  owl.tell("track ball");
  for (int i = 0; i < 1200; ++i) {
    owl.see({-3, 2.5, 0.8});
    owl.run_zooming(1);
  }
  EXPECT_EQ(owl.status(), S::tracking);
  EXPECT_NEAR(owl.told_status().zoom, 0.5 * norm(Vec3{-3, 2.5, 0.8} - owl.eye().p), 1e-6);
  for (int i = 0; i < 300; ++i) {
    owl.see({0, 0, -100});
    owl.run_zooming(1);
  }
  EXPECT_EQ(owl.status(), S::lost);
  EXPECT_EQ(owl.told_status().zoom, 1.5);
}

TEST(PanTilt, AModulesUnitTurnsTheModulesCamera) {
  Owl owl;
  owl.instance.devices[0].name = "front_eye";
  model::DeviceDecl unit{
      .name = "head", .scope = "front::", .config = config({{"pan_joint", "pan"}, {"camera", "eye"}})};
  const auto add = [&] {
    const std::string path = "robot1/head";
    return owl.pool->add({unit, owl.instance, path, 1, 1, owl.engine->body_ids, owl.engine->joint_ids,
                          owl.engine->what, owl.tick, joints_bit, owl});
  };
  EXPECT_TRUE(add());
  owl.instance.devices[0].name = "back_eye";
  EXPECT_FALSE(add());
}

TEST(PanTilt, SwitchesLevelsAndSurvivesSaving) {
  Owl a, b;
  for (Owl* owl : {&a, &b}) ASSERT_TRUE(owl->mount(view_bit));
  a.look("world", {1, 1, 1.2});
  a.run(20);
  b.load(a.saved());
  b.engine->joint = a.engine->joint;
  b.engine->target = a.engine->target;
  b.place();
  b.topic<msg::PointStamped>("head/view/command").count = 1;
  a.run(40), b.run(40);
  EXPECT_EQ(a.engine->joint[0].position, b.engine->joint[0].position);
  EXPECT_EQ(a.engine->joint[1].position, b.engine->joint[1].position);
  ASSERT_TRUE(a.switch_level(joints_bit));
  const double pan = a.topic<msg::PanTiltState>("head/status").message.pan_target;
  a.run(200);
  EXPECT_NEAR(a.engine->joint[0].position, pan, 1e-3);  // what it was turning to is held
  EXPECT_FALSE(a.switch_level(joints_bit | view_bit));
}

TEST(PanTilt, BadSpecsAreErrors) {
  const auto complaint = [](std::initializer_list<std::pair<const char*, const char*>> keys) {
    Owl owl;
    const Status status = owl.add("head", config(keys), joints_bit);
    return status ? "" : status.error().text();
  };
  EXPECT_NE(complaint({}).find("without joints"), std::string::npos);
  EXPECT_NE(
      complaint({{"pan_joint", "pam"}}).find("robot.yaml:1:9: /pan_joint: model 'owl' has no joint 'pam'"),
      std::string::npos);
  EXPECT_NE(complaint({{"pan_joint", "pan"}, {"camera", "eyes"}}).find("robot.yaml:2:9: /camera"),
            std::string::npos);
  EXPECT_NE(complaint({{"pan_joint", "pan"}, {"camera", "eye"}, {"zoom_per_m", "1"}})
                .find("robot.yaml:3:9: /zoom_per_m: this unit has no camera that zooms"),
            std::string::npos);
  EXPECT_NE(complaint({{"pan_joint", "pan"}, {"max_acceleration", "-1"}}).find("/max_acceleration"),
            std::string::npos);
}

}  // namespace
}  // namespace sandlot::pan_tilt
