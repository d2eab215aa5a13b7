/// All kinds with eyes, in a world that can be computed by hand.
/// long file: one stage serves the tests of all these kinds
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "devices/cameras/camera_lens.h"
#include "devices/test_rig.h"
#include "messages/stereo_msgs.h"
#include "messages/vision_msgs.h"
#include "optics/picture.h"

namespace sandlot {
namespace {

using test::config;
using test::Rig;
using Entries = std::initializer_list<std::pair<const char*, const char*>>;

constexpr std::uint32_t image_bit = 1, objects_bit = 2, world_bit = 4;
constexpr double inf = std::numeric_limits<double>::infinity();

const Kind& kind(const char* name) { return **find_device_kind(name); }

/// What a ray meets: a body and how far away, as a function.
struct Met {
  double distance = inf;
  std::uint32_t body = no_body;
};
class Rays final : public RayCaster {
 public:
  explicit Rays(std::function<Met(Vec3 origin_W, Vec3 direction_W)> meet) : meet_(std::move(meet)) {}
  void cast(std::span<const RayJob> jobs) const override {
    for (const RayJob& job : jobs)
      for (std::size_t i = 0; i < job.directions.size(); ++i) {
        const Met met = meet_(job.X_WS.p, rotate(job.X_WS.q, job.directions[i]));
        const bool near = met.distance <= job.max_m;
        job.distance_m[i] = near ? static_cast<float>(met.distance) : std::numeric_limits<float>::infinity();
        if (!job.body.empty()) job.body[i] = near ? met.body : no_body;
      }
  }

 private:
  std::function<Met(Vec3, Vec3)> meet_;
};

double to_sphere(Vec3 o, Vec3 d, Vec3 middle, double radius) {
  const Vec3 m = o - middle;
  const double b = dot(m, d), c = dot(m, m) - radius * radius;
  return b * b - c < 0 || b > 0 ? inf : -b - std::sqrt(b * b - c);
}

/// A robot at the origin and balls that glow, so that their pixels have their colour whatever the light.
class Stage : public Rig {
 public:
  explicit Stage(const char* device) : Rig(kind(device), test::two_wheels()) {
    surroundings.background = {0, 0, 1, 1};
    surroundings.ambient = {0, 0, 0, 1};
  }
  void ball(const std::string& name, const std::string& label, Vec3 at, double radius,
            Color color = {1, 0, 0, 1}) {
    const auto body = static_cast<std::uint32_t>(engine->body.size());
    engine->body.push_back({});
    engine->body.back().X_WB.p = at;
    LabelledObject& thing = things.emplace_back();
    thing.name = name;
    thing.label = label;
    thing.color = color;
    thing.instance = body + 10;
    thing.bodies = {body};
    const Vec3 half{radius, radius, radius};
    thing.bounds_B = {-half, half};
    optics::PictureShape shape;
    shape.group = shape.body = body;
    shape.shape = Sphere{radius};
    shape.appearance.diffuse = {0, 0, 0, 1};
    shape.appearance.emissive = color;
    shape.instance = thing.instance;
    shapes.push_back(shape);
  }
  /// Balls are met by rays as spheres.
  void solid() {
    solid_ = std::make_unique<Rays>([this](Vec3 o, Vec3 d) {
      Met best;
      for (std::size_t i = 0; i < things.size(); ++i) {
        const double t = to_sphere(o, d, engine->body[things[i].bodies[0]].X_WB.p,
                                   0.5 * things[i].bounds_B.size().x);
        if (t < best.distance) best = {t, things[i].bodies[0]};
      }
      return best;
    });
    rays = solid_.get();
  }
  void draw() {
    scene.set_shapes(shapes);
    scene.set_surroundings(surroundings);
    SceneFrame frame;
    for (const BodyState& body : engine->body) frame.X_WG.push_back(body.X_WB);
    scene.update(frame);
    pictures = &scene;
    sense();
  }
  const msg::Image& picture(const std::string& name) { return topic<msg::Image>(name).message; }
  const std::vector<msg::Object>& seen(const std::string& name = "eye/objects") {
    return topic<msg::ObjectArray>(name).message.objects;
  }

  std::vector<optics::PictureShape> shapes;
  optics::Surroundings surroundings;
  optics::PictureScene scene;

 private:
  std::unique_ptr<Rays> solid_;
};

/// Middle of the pixels of rgb8 that are red.
std::array<double, 3> red(const msg::Image& image) {
  double u = 0, v = 0, n = 0;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x)
      if (image.data[y * image.step + 3 * x] > 128) u += x, v += y, ++n;
  return {u / n, v / n, n};
}

/// 80 x 60 pixels over 90 degrees: f = 40 pixels, the axis at (39.5, 29.5).
const Entries small = {{"width", "80"}, {"height", "60"}, {"horizontal_fov", "90 deg"}};

Node with(Entries more, Entries base = small) {
  Node node = config(base);
  for (const auto& [key, value] : more) node.set(key, Node::scalar(value));
  return node;
}

TEST(Cameras, APointIsSeenWhereThePinholeFormulaSays) {
  Stage stage("camera");
  stage.ball("b", "ball", {2, 0.5, -0.25}, 0.1);
  ASSERT_TRUE(stage.add("eye", with({})));
  stage.draw();
  const msg::Image& image = stage.picture("eye/image");
  ASSERT_EQ(image.data.size(), 80u * 60 * 3);
  EXPECT_EQ(image.encoding, "rgb8");
  EXPECT_EQ(image.step, 240u);
  EXPECT_EQ(image.header.frame_id, "robot1/eye_optical");
  // u = 39.5 - 40 * 0.5 / 2, v = 29.5 + 40 * 0.25 / 2; a disc of 2 pixels' radius between pixels is
  // symmetric.
  const auto [u, v, n] = red(image);
  EXPECT_NEAR(u, 29.5, 0.2);
  EXPECT_NEAR(v, 34.5, 0.2);
  EXPECT_NEAR(n, math::pi * 4, 5);
  EXPECT_EQ(image.data[0], 0);
  EXPECT_EQ(image.data[2], 255);  // the background
}

TEST(Cameras, CameraInfoAndFramesAreThoseOfRos) {
  Stage stage("camera");
  Node node = with({{"cx", "30"}});
  node.set("distortion", config({{"k1", "-0.1"}, {"p2", "0.01"}}));
  ASSERT_TRUE(stage.add("eye", std::move(node)));
  stage.draw();
  const msg::CameraInfo& info = stage.topic<msg::CameraInfo>("eye/camera_info").message;
  EXPECT_EQ(info.header.stamp, stage.picture("eye/image").header.stamp);
  EXPECT_EQ(info.distortion_model, "plumb_bob");
  EXPECT_EQ(info.d, (std::vector<double>{-0.1, 0, 0, 0.01, 0}));
  const std::array<double, 9> k{40, 0, 30, 0, 40, 29.5, 0, 0, 1};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(info.k[i], k[i], 1e-9) << i;
  EXPECT_NEAR(info.p[0], 40, 1e-9);
  EXPECT_EQ(info.p[3], 0);
  // Optical: x right, y down, z forward.
  const Pose X = stage.frames.at("robot1/eye_optical");
  EXPECT_NEAR(norm(rotate(X.q, {1, 0, 0}) - Vec3{0, -1, 0}), 0, 1e-15);
  EXPECT_NEAR(norm(rotate(X.q, {0, 1, 0}) - Vec3{0, 0, -1}), 0, 1e-15);
  EXPECT_NEAR(norm(rotate(X.q, {0, 0, 1}) - Vec3{1, 0, 0}), 0, 1e-15);
}

TEST(Cameras, FormatsGammaAndNoise) {
  const auto middle = [](Entries more, Node noise = {}) {
    Stage stage("camera");
    stage.ball("b", "ball", {1, 0, 0}, 0.5, {0.6f, 0.2f, 0.0f, 1});
    Node node = with(more);
    if (!noise.is_null()) node.set("noise", std::move(noise));
    EXPECT_TRUE(stage.add("eye", std::move(node)));
    stage.draw();
    const msg::Image& image = stage.picture("eye/image");
    const std::uint32_t channels = image.step / 80;
    const auto at = image.data.begin() + 30 * image.step + 40 * channels;
    return std::vector<int>(at, at + channels);
  };
  EXPECT_EQ(middle({}), (std::vector<int>{153, 51, 0}));
  EXPECT_EQ(middle({{"format", "bgr8"}}), (std::vector<int>{0, 51, 153}));
  EXPECT_EQ(middle({{"format", "mono8"}}), std::vector<int>{76});  // (299 * 153 + 587 * 51) / 1000 = 75.7
  // 255 (153 / 255)^(1/2) = 197.5, 255 (51 / 255)^(1/2) = 114.04
  EXPECT_NEAR(middle({{"gamma", "2"}})[0], 197.5, 0.6);
  EXPECT_EQ(middle({{"gamma", "2"}})[1], 114);
  Node noise = Node::sequence(), stage = Node::map();
  stage.set("salt_and_pepper", config({{"salt", "1"}, {"pepper", "0"}}));
  noise.push(std::move(stage));
  EXPECT_EQ(middle({}, noise), (std::vector<int>{255, 255, 255}));
  EXPECT_EQ(middle({{"errors", "0"}}, noise), (std::vector<int>{153, 51, 0}));
}

TEST(Cameras, ACompressedPictureIsTheSameInRgb) {
  Stage stage("camera");
  stage.ball("b", "ball", {1, 0, 0}, 0.5, {0.6f, 0.2f, 0.0f, 1});
  // "Compressed" as size, quality and the middle pixel.
  stage.encoder = [](int width, int height, int channels, std::span<const std::uint8_t> pixels, int quality) {
    const std::size_t middle = 3 * (30 * 80 + 40);
    EXPECT_EQ(pixels.size(), static_cast<std::size_t>(width * height * channels));
    const int values[] = {width, height, channels, quality, pixels[middle], pixels[middle + 2]};
    return std::string(std::begin(values), std::end(values));
  };
  ASSERT_TRUE(stage.add("eye", with({{"format", "bgr8"}, {"compressed", "jpeg"}, {"quality", "70"}})));
  stage.draw();
  const auto& message = stage.topic<msg::CompressedImage>("eye/image/compressed").message;
  EXPECT_EQ(message.format, "jpeg");
  EXPECT_EQ(message.data, (std::vector<std::uint8_t>{80, 60, 3, 70, 153, 0}));
  EXPECT_EQ(message.header.frame_id, "robot1/eye_optical");
}

TEST(Cameras, ObjectsAreToldWithoutAnyPicture) {
  Stage stage("camera");
  stage.ball("ahead", "ball", {3, 3, 0}, 0.1, {1, 0.5f, 0, 1});
  stage.ball("beside", "ball", {-1, 3, 0}, 0.1);
  stage.ball("far", "ball", {30, 0, 0}, 0.1);
  stage.ball("post", "goal", {2, -1, 1}, 0.1);
  stage.solid();
  Node node = with({{"horizontal_fov", "100 deg"}});
  node.set("objects", config({{"names", "true"}}));
  // Nobody draws: the scene is null, and asking for it would end the program.
  ASSERT_TRUE(stage.add("eye", std::move(node), objects_bit));
  stage.sense();
  const auto& seen = stage.seen();
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].name, "ahead");
  EXPECT_EQ(seen[0].label, "ball");
  EXPECT_EQ(seen[0].color.g, 0.5f);
  EXPECT_NEAR(seen[0].bearing, math::pi / 4, 1e-12);
  EXPECT_NEAR(seen[0].elevation, 0, 1e-12);
  EXPECT_NEAR(seen[0].range, std::sqrt(18.0), 1e-12);
  EXPECT_NEAR(norm(seen[0].position - Vec3{3, 3, 0}), 0, 1e-12);
  EXPECT_EQ(seen[0].visible, 1);
  EXPECT_EQ(seen[0].confidence, 1);
  EXPECT_EQ(seen[1].name, "post");
  EXPECT_NEAR(seen[1].elevation, math::asin(1 / std::sqrt(6.0)), 1e-12);
  EXPECT_EQ(stage.topic<msg::Image>("eye/image").count, 0u);
  EXPECT_EQ(stage.topic<msg::ObjectPoseArray>("eye/world").count, 0u);
  // Pixels that nobody drew are no State, which every tick hashes.
  EXPECT_EQ(stage.picture("eye/image").step, 80u * 3);
  EXPECT_TRUE(stage.picture("eye/image").data.empty());
}

TEST(Cameras, WhatHidesAThingAndTheEdgeOfThePictureCount) {
  Stage stage("camera");
  stage.ball("b", "ball", {4, 0, 0}, 0.2);
  const std::uint32_t ball = stage.things[0].bodies[0];
  double edge = -0.001;  // a wall 2 m ahead reaches from the right to y = edge at the ball's distance
  const Rays rays([&](Vec3 o, Vec3 d) -> Met {
    if (d.y / d.x * 4 < edge) return {2 / d.x, 77};
    return {to_sphere(o, d, {4, 0, 0}, 0.2), ball};
  });
  stage.rays = &rays;
  ASSERT_TRUE(stage.add("eye", with({}), objects_bit));
  stage.sense();
  ASSERT_EQ(stage.seen().size(), 1u);
  EXPECT_NEAR(stage.seen()[0].visible, 6.0 / 9, 1e-12);  // of three columns of places the right one is hidden
  edge = 0.001;
  stage.sense();
  EXPECT_NEAR(stage.seen()[0].visible, 3.0 / 9, 1e-12);
  edge = 1;
  stage.sense();
  EXPECT_TRUE(stage.seen().empty());
  // At each edge of the picture (80 x 60, 45 degrees to the sides, atan(30 / 40) up and down) the outer column or row of places is beyond it.
  edge = -100;
  const double side = math::pi / 4 - 0.005, up = math::atan2(30, 40) - 0.005;
  for (const auto& [axis, angle] : {std::pair{Vec3{0, 0, 1}, -side}, std::pair{Vec3{0, 0, 1}, side},
                                    std::pair{Vec3{0, 1, 0}, -up}, std::pair{Vec3{0, 1, 0}, up}}) {
    stage.engine->body[0].X_WB.q = quat_from_axis_angle(axis, angle);
    stage.sense();
    ASSERT_EQ(stage.seen().size(), 1u);
    EXPECT_NEAR(stage.seen()[0].visible, 6.0 / 9, 1e-12) << axis.z << ' ' << angle;
  }
}

TEST(Cameras, DetectorErrorsHaveTheirStatistics) {
  Stage stage("camera");
  stage.ball("b", "ball", {4, 0, 0}, 0.2);
  stage.solid();
  Node node = with({{"rate", "10"}});
  Node detector = config({{"miss_rate", "0.1"},
                          {"miss_rate_per_m", "0.05"},
                          {"bearing_std", "0.02"},
                          {"range_std", "0.1"},
                          {"range_std_per_m", "0.05"},
                          {"confusion", "0.2"}});
  Node labels = Node::sequence();
  for (const char* label : {"ball", "goal"}) labels.push(Node::scalar(label));
  detector.set("labels", std::move(labels));
  node.set("objects", std::move(detector));
  ASSERT_TRUE(stage.add("eye", std::move(node), objects_bit));
  constexpr int samples = 4000;
  double found = 0, bearing2 = 0, range = 0, range2 = 0, goals = 0;
  for (int i = 0; i < samples; ++i) {
    stage.sense();
    for (const msg::Object& object : stage.seen()) {
      ++found;
      bearing2 += object.bearing * object.bearing;
      range += object.range - 4;
      range2 += (object.range - 4) * (object.range - 4);
      goals += object.label == "goal";
      ASSERT_NEAR(object.confidence, 0.7, 1e-12);
    }
  }
  // A miss has the probability 0.1 + 0.05 * 4 = 0.3; the range a deviation of 0.1 + 0.05 * 4 = 0.3 m. Five
  // deviations each.
  EXPECT_NEAR(found / samples, 0.7, 5 * std::sqrt(0.21 / samples));
  EXPECT_NEAR(goals / found, 0.2, 5 * std::sqrt(0.16 / found));
  EXPECT_NEAR(std::sqrt(bearing2 / found), 0.02, 0.02 * 5 / std::sqrt(2 * found));
  EXPECT_NEAR(range / found, 0, 5 * 0.3 / std::sqrt(found));
  EXPECT_NEAR(std::sqrt(range2 / found), 0.3, 0.3 * 5 / std::sqrt(2 * found));
}

TEST(Cameras, GhostsComeAtTheirRateAndErrorsScaleThemAll) {
  const auto ghosts = [](const char* errors) {
    Stage stage("camera");
    stage.ball("b", "ball", {4, 0, 0}, 0.2);
    stage.solid();
    Node node = with({{"errors", errors}});
    node.set("objects", config({{"ghost_rate", "20"}, {"miss_rate", "1"}, {"max_range", "8"}}));
    EXPECT_TRUE(stage.add("eye", std::move(node), objects_bit));
    double count = 0;
    for (int i = 0; i < 4000; ++i) {
      stage.sense();
      for (const msg::Object& object : stage.seen()) {
        if (object.range == 4) continue;
        ++count;
        EXPECT_LE(object.confidence, 0.5);
        EXPECT_LE(object.range, 8);
        EXPECT_LE(std::abs(object.bearing), math::pi / 4 + 1e-9);
      }
    }
    return count;
  };
  // 4000 samples 10 ms apart: 800 ghosts expected, a Poisson number.
  EXPECT_NEAR(ghosts("1"), 800, 5 * std::sqrt(800.0));
  EXPECT_NEAR(ghosts("0.5"), 400, 5 * std::sqrt(400.0));
  EXPECT_EQ(ghosts("0"), 0);
}

TEST(Cameras, ErrorsOfOneThingDoNotDependOnTheOthers) {
  const auto first = [](bool more) {
    Stage stage("camera");
    if (more) stage.ball("a", "ball", {5, 1, 0}, 0.2);
    stage.ball("b", "ball", {4, 0, 0}, 0.2);
    stage.solid();
    Node node = with({});
    node.set("objects", config({{"range_std", "0.5"}, {"names", "true"}}));
    EXPECT_TRUE(stage.add("eye", std::move(node), objects_bit));
    stage.sense();
    for (const msg::Object& object : stage.seen())
      if (object.name == "b") return object.range;
    return 0.0;
  };
  EXPECT_NE(first(false), 4.0);
  EXPECT_EQ(first(false), first(true));
}

TEST(Cameras, TheWorldLevelTellsPoses) {
  Stage stage("camera");
  stage.ball("b", "ball", {3, 4, 0.3}, 0.2);
  stage.ball("behind", "ball", {-4, 0, 0}, 0.2);
  stage.solid();
  Node node = with({{"horizontal_fov", "120 deg"}});
  node.set("world", config({{"position_std", "0.1"}, {"position_std_per_m", "0.08"}}));
  ASSERT_TRUE(stage.add("eye", std::move(node), world_bit));
  const auto& message = stage.topic<msg::ObjectPoseArray>("eye/world").message;
  double squares = 0;
  constexpr int samples = 1000;
  const double std = 0.1 + 0.08 * std::sqrt(25.09);
  for (int i = 0; i < samples; ++i) {
    stage.sense();
    ASSERT_EQ(message.objects.size(), 1u);
    const msg::ObjectPose& object = message.objects[0];
    ASSERT_NEAR(object.position_std, std, 1e-12);
    ASSERT_EQ(object.pose.p.z, 0.3);
    squares += (object.pose.p.x - 3) * (object.pose.p.x - 3) + (object.pose.p.y - 4) * (object.pose.p.y - 4);
  }
  EXPECT_EQ(message.header.frame_id, "world");
  EXPECT_NEAR(std::sqrt(squares / (2 * samples)), std, std * 5 / std::sqrt(4.0 * samples));

  Stage all("camera");
  all.ball("behind", "ball", {-4, 0, 0}, 0.2);
  all.solid();
  Node everything = with({});
  everything.set("world", config({{"everything", "true"}}));
  ASSERT_TRUE(all.add("eye", std::move(everything), world_bit | objects_bit));
  all.sense();
  EXPECT_TRUE(all.seen().empty());
  const auto& poses = all.topic<msg::ObjectPoseArray>("eye/world").message.objects;
  ASSERT_EQ(poses.size(), 1u);
  EXPECT_EQ(poses[0].pose.p, (Vec3{-4, 0, 0}));
}

TEST(Cameras, LevelsRunTogetherAndSwitch) {
  Stage stage("camera");
  stage.ball("b", "ball", {2, 0, 0}, 0.2);
  stage.solid();
  ASSERT_TRUE(stage.add("eye", with({}), image_bit | objects_bit));
  stage.draw();
  EXPECT_EQ(stage.topic<msg::Image>("eye/image").count, 1u);
  EXPECT_EQ(stage.seen().size(), 1u);
  ASSERT_TRUE(stage.switch_level(world_bit));
  stage.pictures = nullptr;
  stage.sense();
  EXPECT_EQ(stage.topic<msg::Image>("eye/image").count, 1u);
  EXPECT_EQ(stage.topic<msg::ObjectArray>("eye/objects").count, 1u);
  EXPECT_EQ(stage.topic<msg::ObjectPoseArray>("eye/world").count, 1u);
}

TEST(Cameras, ZoomChangesTheLensAtItsRate) {
  Stage stage("camera");
  stage.ball("b", "ball", {4, 0.4, 0}, 0.1);
  Node node = with({});
  node.set("zoom", config({{"max", "3"}, {"rate", "4"}}));
  ASSERT_TRUE(stage.add("eye", std::move(node)));
  stage.draw();
  EXPECT_NEAR(red(stage.picture("eye/image"))[0], 35.5, 0.6);  // 39.5 - 40 * 0.1
  stage.command("eye/zoom", msg::Float64{100});
  stage.since[0] = Time::from_s(0.5);  // 4^0.5 = 2
  stage.draw();
  EXPECT_NEAR(red(stage.picture("eye/image"))[0], 31.5, 0.6);
  EXPECT_NEAR(stage.topic<msg::CameraInfo>("eye/camera_info").message.k[0], 80, 1e-9);
  const auto saved = stage.saved();
  stage.draw();  // no further than max
  EXPECT_NEAR(stage.topic<msg::CameraInfo>("eye/camera_info").message.k[0], 120, 1e-9);
  stage.load(saved);
  stage.since[0] = Time{1};
  stage.draw();
  EXPECT_NEAR(stage.topic<msg::CameraInfo>("eye/camera_info").message.k[0], 80, 1e-3);
}

TEST(Cameras, AMirrorSeesBehind) {
  Stage stage("omni_camera");
  stage.ball("b", "ball", {0, 2, -0.5}, 0.3);
  stage.ball("c", "goal", {-2, 0, -0.5}, 0.3, {0, 1, 0, 1});
  stage.solid();
  ASSERT_TRUE(stage.add("eye", config({{"width", "60"}, {"height", "60"}}), image_bit | objects_bit));
  stage.draw();
  // Seen mirrored: what is left of the robot is right in the image.
  const auto [u, v, n] = red(stage.picture("eye/image"));
  EXPECT_GT(n, 3);
  EXPECT_GT(u, 34);
  EXPECT_NEAR(v, 29.5, 1);
  const auto& seen = stage.seen();
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_NEAR(seen[0].bearing, math::pi / 2, 1e-12);
  EXPECT_NEAR(std::abs(seen[1].bearing), math::pi, 1e-12);
  const Pose X = stage.frames.at("robot1/eye_optical");
  EXPECT_NEAR(norm(rotate(X.q, {1, 0, 0}) - Vec3{0, 1, 0}), 0, 1e-12);
  EXPECT_NEAR(norm(rotate(X.q, {0, 1, 0}) - Vec3{-1, 0, 0}), 0, 1e-12);
}

/// Where the horizon lies in an image of 240 rows whose height the rim fills, by the tangents seen from the camera below.
///   hyperbolic  a^2 / b from the axis, at the focus, 2 c from the camera; the rim b sqrt(1 + r^2 / a^2) + c from it
///   parabolic   a of r, since the camera is orthographic
///   spherical   at 38.18 degrees from the axis: 2 theta + alpha = 90 degrees
TEST(Cameras, TheHorizonLiesWhereEachMirrorsDefaultsPutIt) {
  const double a = 5e-3 * std::sqrt(233.3), b = 5e-3 * std::sqrt(1135.7), c = std::sqrt(a * a + b * b),
               rim = 0.05;
  const double theta = 38.18 * math::pi / 180;
  const double hyperbolic = a * a / b / (2 * c) / (rim / (b * std::sqrt(1 + rim * rim / (a * a)) + c));
  const double spherical = 0.06 * math::sin(theta) / (0.2 - 0.06 * math::cos(theta)) /
                           (rim / (0.2 - std::sqrt(0.06 * 0.06 - rim * rim)));
  for (const auto& [mirror, share] :
       {std::pair{"", hyperbolic}, std::pair{"hyperbolic", hyperbolic}, std::pair{"parabolic", 0.034 / rim},
        std::pair{"spherical", spherical}}) {
    Stage stage("omni_camera");
    stage.ball("b", "ball", {20, 0, 0}, 1);
    Node keys = config({{"width", "240"}, {"height", "240"}});
    if (*mirror) keys.set("mirror", Node::scalar(mirror));
    ASSERT_TRUE(stage.add("eye", std::move(keys), image_bit));
    stage.draw();
    const auto [u, v, n] = red(stage.picture("eye/image"));
    EXPECT_GT(n, 10) << mirror;
    EXPECT_NEAR(u, 119.5, 0.3) << mirror;
    EXPECT_NEAR(119.5 - v, 120 * share, 0.5) << mirror;
  }
}

TEST(Cameras, StereoSeesTheDisparityOfTheDepth) {
  Stage stage("stereo_camera");
  stage.ball("b", "ball", {2, -0.25, 0}, 0.1);
  Node node = with({{"baseline", "0.5"}});
  ASSERT_TRUE(stage.add("eye", std::move(node)));
  stage.draw();
  // f b / z = 40 * 0.5 / 2 = 10 pixels; the ball stands between both eyes.
  const auto left = red(stage.picture("eye/left/image")), right = red(stage.picture("eye/right/image"));
  EXPECT_NEAR(left[0], 44.5, 0.2);
  EXPECT_NEAR(left[0] - right[0], 10, 0.2);
  EXPECT_NEAR(left[1], right[1], 0.1);
  EXPECT_EQ(stage.topic<msg::CameraInfo>("eye/left/camera_info").message.p[3], 0);
  const msg::CameraInfo& info = stage.topic<msg::CameraInfo>("eye/right/camera_info").message;
  EXPECT_NEAR(info.p[3], -20, 1e-9);
  EXPECT_EQ(info.header.frame_id, "robot1/eye_optical");
}

// 300 cameras, each with a seed of its own: deviations of what they publish, within five of the estimator's, s / sqrt(2 * 300). The
// pictures of a camera whose right eye is turned by a about the vertical are moved by f a there, here some pixels.
TEST(Cameras, StereoIsCalibratedWithErrors) {
  const auto calibration = [](const char* focal, const char* centre, const char* baseline,
                              const char* rotation) {
    Node node = with({{"baseline", "0.5"}});
    Node keys = Node::map();
    keys.set("focal", Node::scalar(focal));
    keys.set("centre", Node::scalar(centre));
    keys.set("baseline", Node::scalar(baseline));
    keys.set("rotation", Node::scalar(rotation));
    node.set("calibration", std::move(keys));
    return node;
  };
  const auto squared = [](double x) { return x * x; };
  double focal = 0, centre = 0, baseline = 0;
  constexpr int cameras = 300;
  for (int i = 0; i < cameras; ++i) {
    Stage stage("stereo_camera");
    stage.seed = static_cast<std::uint64_t>(i);
    ASSERT_TRUE(stage.add("eye", calibration("0.01", "0.5", "0.03", "0")));
    const msg::CameraInfo& left = stage.topic<msg::CameraInfo>("eye/left/camera_info").message;
    const msg::CameraInfo& right = stage.topic<msg::CameraInfo>("eye/right/camera_info").message;
    EXPECT_EQ(left.k, right.k);
    EXPECT_EQ(left.p[0], left.k[0]);
    EXPECT_EQ(left.p[5], left.p[0]);
    EXPECT_EQ(left.p[2], left.k[2]);
    focal += squared(left.p[0] / 40 - 1);
    centre += squared(left.p[2] - 39.5) + squared(left.p[6] - 29.5);
    baseline += squared(-right.p[3] / right.p[0] / 0.5 - 1);
  }
  const double bound = 5 / std::sqrt(2.0 * cameras);
  EXPECT_NEAR(std::sqrt(focal / cameras), 0.01, 0.01 * bound);
  EXPECT_NEAR(std::sqrt(centre / (2 * cameras)), 0.5, 0.5 * bound);
  EXPECT_NEAR(std::sqrt(baseline / cameras), 0.03, 0.03 * bound);

  double moved = 0;
  for (int i = 0; i < 20; ++i) {
    Stage stage("stereo_camera");
    stage.seed = static_cast<std::uint64_t>(i);
    stage.ball("b", "ball", {2, -0.25, 0}, 0.1);
    ASSERT_TRUE(stage.add("eye", calibration("0", "0", "0", "0.05")));
    stage.draw();
    const auto left = red(stage.picture("eye/left/image")), right = red(stage.picture("eye/right/image"));
    EXPECT_NEAR(left[0], 44.5, 0.2);
    moved += squared(left[0] - right[0] - 10);
    EXPECT_NEAR(stage.topic<msg::CameraInfo>("eye/right/camera_info").message.p[3], -20, 1e-9);
  }
  // f a = 2 pixels, of 20 cameras within four deviations of their mean square.
  EXPECT_NEAR(std::sqrt(moved / 20), 2, 2 * 4 / std::sqrt(40.0));
}

float depth_at(const msg::Image& image, std::uint32_t u, std::uint32_t v) {
  float d = 0;
  std::memcpy(&d, image.data.data() + v * image.step + 4 * u, 4);
  return d;
}

/// A wall at x = 3 m that fills the picture but its right third, and a ball nearer than 1 m.
void wall(Stage& stage) {
  stage.ball("near", "ball", {0.6, 0, 0}, 0.1);
  optics::PictureShape shape;
  shape.X_GC.p = {3.5, 10, 0};
  shape.shape = Box{{1, 22, 20}};
  stage.shapes.push_back(shape);
}

/// The wall at 3 m, f b = 40 * 0.5 = 20 m: the disparity is 20 / 3.
TEST(Cameras, StereoComputesDisparitiesFromTrueDepths) {
  constexpr std::uint32_t closed_form_bit = 4;
  Stage stage("stereo_camera");
  wall(stage);
  ASSERT_TRUE(
      stage.add("eye", with({{"baseline", "0.5"}, {"match_std", "0"}, {"points", "true"}}), closed_form_bit));
  stage.draw();
  const auto& found = stage.topic<msg::DisparityImage>("eye/closed_form").message;
  EXPECT_EQ(found.image.encoding, "32FC1");
  EXPECT_FLOAT_EQ(found.f, 40);
  EXPECT_FLOAT_EQ(found.t, 0.5);
  EXPECT_NEAR(depth_at(found.image, 20, 30), 20.0 / 3, 1e-4);
  EXPECT_EQ(depth_at(found.image, 5, 30), -1) << "the right eye's picture ends there";
  EXPECT_EQ(depth_at(found.image, 75, 30), -1) << "there is no surface";
  // The ball's front at 0.5 m has 40 pixels, and hides the wall from the right eye where it is seen there: 40 to 20/3 farther right.
  EXPECT_NEAR(depth_at(found.image, 40, 30), 40, 1);
  EXPECT_EQ(depth_at(found.image, 8, 30), -1) << "behind the ball for the right eye";
  const auto& cloud = stage.topic<msg::PointCloud2>("eye/closed_form/points").message;
  float point[3];
  std::memcpy(point, cloud.data.data() + 12 * (30 * found.image.width + 20), 12);
  EXPECT_NEAR(point[2], 3, 1e-4);
  EXPECT_NEAR(point[0], 3 * (20 - 39.5) / 40, 1e-4);
  std::memcpy(point, cloud.data.data() + 12 * (30 * found.image.width + 75), 12);
  EXPECT_TRUE(std::isnan(point[0]));
  EXPECT_TRUE(stage.picture("eye/left/image").data.empty()) << "no picture is drawn";

  Stage noisy("stereo_camera");
  wall(noisy);
  ASSERT_TRUE(noisy.add("eye", with({{"baseline", "0.5"}, {"match_std", "0.5"}}), closed_form_bit));
  noisy.draw();
  const auto& seen = noisy.topic<msg::DisparityImage>("eye/closed_form").message;
  double n = 0, sum = 0, square = 0;
  for (std::uint32_t v = 0; v < 12; ++v)
    for (std::uint32_t u = 10; u < 50; ++u) {
      const double d = static_cast<double>(depth_at(seen.image, u, v));
      ++n, sum += d - 20.0 / 3, square += (d - 20.0 / 3) * (d - 20.0 / 3);
    }
  EXPECT_NEAR(sum / n, 0, 4 * 0.5 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(square / n), 0.5, 4 * 0.5 / std::sqrt(2 * n));
}

TEST(Cameras, DepthIsMeasuredAlongTheAxis) {
  Stage stage("depth_camera");
  wall(stage);
  ASSERT_TRUE(stage.add("eye", with({{"near", "1"}, {"far", "5"}, {"points", "true"}})));
  stage.draw();
  const msg::Image& image = stage.picture("eye/depth");
  EXPECT_EQ(image.encoding, "32FC1");
  EXPECT_NEAR(depth_at(image, 0, 0), 3, 1e-5);  // the corner, sqrt(1 + 1 + 0.56) as far as the middle
  EXPECT_NEAR(depth_at(image, 20, 30), 3, 1e-5);
  EXPECT_EQ(depth_at(image, 40, 30), -inf);
  EXPECT_EQ(depth_at(image, 79, 30), inf);
  const msg::PointCloud2& cloud = stage.topic<msg::PointCloud2>("eye/points").message;
  EXPECT_EQ(cloud.width, 80u);
  EXPECT_EQ(cloud.height, 60u);
  ASSERT_EQ(cloud.data.size(), 80u * 60 * 12);
  std::array<float, 3> point{};
  std::memcpy(point.data(), cloud.data.data(), 12);  // pixel (0, 0): (u - 39.5) / 40 * 3 to the right
  EXPECT_NEAR(point[0], -39.5 / 40 * 3, 1e-5);
  EXPECT_NEAR(point[1], -29.5 / 40 * 3, 1e-5);
  EXPECT_NEAR(point[2], 3, 1e-5);
  std::memcpy(point.data(), cloud.data.data() + (30 * 80 + 40) * 12, 12);
  EXPECT_TRUE(std::isnan(point[0]) && std::isnan(point[2]));
}

TEST(Cameras, ColourAndDepthOfTheSamePixels) {
  Stage stage("rgbd_camera");
  wall(stage);
  stage.ball("b", "ball", {2, 0.5, 0}, 0.2);
  ASSERT_TRUE(stage.add("eye", with({{"near", "0.1"}, {"encoding", "16UC1"}, {"points", "true"}})));
  stage.draw();
  const msg::Image &color = stage.picture("eye/image"), &depth = stage.picture("eye/depth");
  EXPECT_EQ(depth.encoding, "16UC1");
  const std::size_t u = 29, v = 30;  // 39.5 - 40 * 0.25 = 29.5: on the ball, whose front is at 1.8 m
  EXPECT_EQ(color.data[v * color.step + 3 * u], 255);
  std::uint16_t mm = 0;
  std::memcpy(&mm, depth.data.data() + v * depth.step + 2 * u, 2);
  EXPECT_NEAR(mm, 1806, 8);  // the ray through the ball's middle meets it at 2 - 0.2 cos(14 deg) = 1.806
  std::memcpy(&mm, depth.data.data() + v * depth.step + 2 * 79, 2);
  EXPECT_EQ(mm, 0);
  const msg::PointCloud2& cloud = stage.topic<msg::PointCloud2>("eye/points").message;
  ASSERT_EQ(cloud.point_step, 16u);
  EXPECT_EQ(cloud.data[(v * 80 + u) * 16 + 14], 255);  // b g r 0
  EXPECT_EQ(cloud.data[(v * 80 + u) * 16 + 12], 0);
}

TEST(Cameras, ClassesInstancesAndBoxes) {
  Stage stage("segmentation_camera");
  stage.ball("b", "ball", {2, 0.5, 0}, 0.2);
  stage.ball("c", "cone", {2, -0.5, 0}, 0.2);
  Node node = with({});
  Node labels = Node::sequence();
  for (const char* label : {"robot", "cone"}) labels.push(Node::scalar(label));
  node.set("labels", std::move(labels));
  ASSERT_TRUE(stage.add("eye", std::move(node)));
  stage.draw();
  const auto at = [&](const char* name, std::uint32_t u, std::uint32_t bytes) {
    const msg::Image& image = stage.picture(name);
    std::uint32_t value = 0;
    std::memcpy(&value, image.data.data() + 30 * image.step + u * bytes, bytes);
    return value;
  };
  EXPECT_EQ(at("eye/labels", 29, 1), 0u);  // a ball, which is not in the list
  EXPECT_EQ(at("eye/labels", 49, 1), 2u);
  EXPECT_EQ(at("eye/labels", 40, 1), 0u);
  EXPECT_EQ(at("eye/instances", 49, 4), stage.things[1].instance);
  EXPECT_EQ(at("eye/instances", 29, 4), 0u);
  EXPECT_NE(at("eye/colored", 49, 3), 0u);
  EXPECT_EQ(at("eye/colored", 40, 3), 0u);

  Stage numbered("segmentation_camera");  // labels that are numbers need no list
  numbered.ball("b", "40", {2, 0.5, 0}, 0.2);
  numbered.ball("c", "256", {2, -0.5, 0}, 0.2);
  ASSERT_TRUE(numbered.add("eye", with({})));
  numbered.draw();
  const msg::Image& numbers = numbered.picture("eye/labels");
  EXPECT_EQ(numbers.data[30 * numbers.step + 29], 40);
  EXPECT_EQ(numbers.data[30 * numbers.step + 49], 0);

  Stage boxes("boundingbox_camera");
  boxes.ball("b", "ball", {2, 0.5, 0}, 0.2);
  boxes.ball("c", "cone", {-2, 0.5, 0}, 0.2);
  ASSERT_TRUE(boxes.add("eye", with({})));
  boxes.draw();
  const auto& found = boxes.topic<msg::vision::Detection2DArray>("eye/boxes").message.detections;
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].id, "b");
  EXPECT_EQ(found[0].results.at(0).hypothesis.class_id, "ball");
  // A sphere of 0.2 m at 2 m: about 4 pixels to each side of (29.5, 29.5).
  EXPECT_NEAR(found[0].bbox.center.position.x, 29.5, 0.6);
  EXPECT_NEAR(found[0].bbox.center.position.y, 29.5, 0.6);
  EXPECT_NEAR(found[0].bbox.size_x, 8, 1.1);
  EXPECT_NEAR(found[0].bbox.size_y, 8, 1.1);
}

std::string complaint(const char* device, Entries values, std::pair<const char*, Node> more = {}) {
  Stage stage(device);
  Node node = config(values);
  if (more.first) node.set(more.first, std::move(more.second));
  const Status status = stage.add("eye", std::move(node));
  return status ? "" : status.error().text();
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Cameras, BadLensesAreRefusedWhereTheyStand) {
  const auto expect = [](const std::string& text, const char* place, const char* part) {
    EXPECT_TRUE(holds(text, place) && holds(text, part)) << text;
  };
  expect(complaint("camera", {{"width", "100000"}, {"height", "100000"}}), "robot.yaml:1:9", "/width");
  expect(complaint("camera", {{"width", "8192"}, {"height", "8192"}}), "robot.yaml:1:9", "8192 x 8192");
  expect(complaint("camera", {{"rate", "10"}, {"horizontal_fov", "180 deg"}}), "robot.yaml:2:9",
         "179 degrees");
  expect(complaint("camera", {{"horizontal_fov", "0"}}), "robot.yaml:1:9", "/horizontal_fov");
  expect(complaint("camera", {{"fx", "0"}}), "robot.yaml:1:9", "/fx");
  expect(complaint("camera", {{"lens", "orthographic"}, {"horizontal_fov", "200 deg"}}), "robot.yaml:2:9",
         "fisheye");
  expect(complaint("camera", {{"near", "2"}, {"far", "1"}}), "robot.yaml:2:9", "greater than near");
  expect(complaint("camera", {{"format", "rgb9"}}), "robot.yaml:1:9", "rgb8");
  expect(complaint("camera", {}, {"objects", config({{"bearing_std", "-1"}})}), "robot.yaml:1:9",
         "/objects/bearing_std");
  expect(complaint("camera", {}, {"world", config({{"position_std", "nan"}})}), "robot.yaml", "position_std");
  expect(complaint("omni_camera", {{"rim", "0"}}), "robot.yaml:1:9", "/rim");
  expect(complaint("omni_camera", {{"mirror", "spherical"}, {"a", "0.1"}, {"b", "0.05"}}), "robot.yaml:2:9",
         "inside");
  expect(complaint("omni_camera", {{"width", "8000"}, {"height", "8000"}}), "robot.yaml:1:9", "/width");
  expect(complaint("omni_camera", {{"focal_length", "0.5"}}), "robot.yaml:1:9", "smaller than a pixel");
  expect(complaint("stereo_camera", {{"baseline", "0"}}), "robot.yaml:1:9", "/baseline");
  expect(complaint("stereo_camera", {{"lens", "equidistant"}}), "robot.yaml:1:9", "rectified");
}

TEST(Cameras, ReadSdf) {
  const auto keys = [](const char* device, Node camera, Diagnostics& diagnostics) {
    Node element = Node::map();
    element.set("camera", std::move(camera));
    element.set("update_rate", Node::scalar("15"));
    return kind(device).from_sdf(element, diagnostics);
  };
  const auto text = [](const Node& node, const char* key) {
    const Node* const found = node.find(key);
    return found ? found->text() : std::string("none");
  };
  Node camera = config({{"horizontal_fov", "1.2"}, {"visualize", "1"}});
  camera.set("image", config({{"width", "64"}, {"height", "48"}, {"format", "L8"}}));
  camera.set("clip", config({{"near", "0.2"}, {"far", "30"}}));
  camera.set("noise", config({{"type", "gaussian"}, {"mean", "0"}, {"stddev", "0.007"}}));
  camera.set("distortion", config({{"k1", "-0.2"}, {"k2", "0"}}));
  Diagnostics diagnostics;
  const auto read = keys("camera", camera, diagnostics);
  ASSERT_TRUE(read);
  EXPECT_EQ(text(*read, "horizontal_fov"), "1.2");
  EXPECT_EQ(text(*read, "width"), "64");
  EXPECT_EQ(text(*read, "format"), "mono8");
  EXPECT_EQ(text(*read, "near"), "0.2");
  EXPECT_EQ(text(*read, "rate"), "15");
  EXPECT_EQ(read->find("noise")->items().size(), 1u);
  EXPECT_EQ(text(*read->find("distortion"), "k1"), "-0.2");
  EXPECT_EQ(diagnostics.warnings.size(), 1u);  // visualize
  Stage stage("camera");
  EXPECT_TRUE(stage.add("eye", *read));

  Node wide = config({{"horizontal_fov", "3.1"}});
  wide.set("lens", config({{"type", "equidistant"}, {"scale_to_hfov", "true"}}));
  const auto fisheye = keys("camera", wide, diagnostics);
  ASSERT_TRUE(fisheye);
  EXPECT_EQ(text(*fisheye, "lens"), "equidistant");
  Stage second("camera");
  EXPECT_TRUE(second.add("eye", *fisheye));

  const auto depth = keys("depth_camera", camera, diagnostics);
  ASSERT_TRUE(depth);
  EXPECT_EQ(depth->find("format"), nullptr);
  Stage third("depth_camera");
  EXPECT_TRUE(third.add("eye", *depth));

  Node pair = Node::sequence();
  for (const char* pose : {"0 0 0 0 0 0", "0 -0.07 0 0 0 0"}) {
    Node one = camera;
    one.erase("distortion");
    one.erase("visualize");
    one.set("pose", Node::scalar(pose));
    pair.push(std::move(one));
  }
  const auto stereo = keys("stereo_camera", pair, diagnostics);
  ASSERT_TRUE(stereo) << to_string(stereo.error().place) << stereo.error().text();
  EXPECT_EQ(text(*stereo, "baseline"), "0.07");
  Stage fourth("stereo_camera");
  EXPECT_TRUE(fourth.add("eye", *stereo));
  EXPECT_FALSE(keys("stereo_camera", camera, diagnostics));
}

}  // namespace
}  // namespace sandlot
