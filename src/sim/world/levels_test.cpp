/// Levels of sensors switched in a run, and sensors that look at the world's visuals, on both engines.
#include <gtest/gtest.h>

#include "messages/line_segments.h"
#include "messages/messages.h"
#include "messages/sensor_images.h"
#include "sim/test_log.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

class LevelsOnBoth : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Engines, LevelsOnBoth, testing::Values("rigid", "planar"),
                         [](const auto& p) { return std::string(p.param); });

void add_device(model::Instance& instance, const char* name, const char* kind, Node config, Pose X_LS = {}) {
  model::DeviceDecl decl;
  decl.name = name;
  decl.kind = kind;
  decl.X_LS = X_LS;
  decl.config = std::move(config);
  instance.devices.push_back(std::move(decl));
}

/// Rovers whose lasers and inertial units err at every level.
model::Setup rovers(const char* engine) {
  model::Setup setup = arena(engine, 2);
  for (model::Instance& instance : setup.instances) {
    if (!instance.is_robot) continue;
    Node pose = map({{"position_std", "0.05"}, {"yaw_std", "0.02"}, {"lost_rate", "0.5"}});
    instance.devices[1].config.set("pose_error", pose);
    instance.devices[1].config.set("segments", map({{"end_std", "0.01"}, {"miss", "0.1"}}));
    Node imu = map({{"rate", "50"}});
    imu.set("pose_error", map({{"velocity_walk", "0.1"}}));
    add_device(instance, "imu", "imu", imu);
  }
  return setup;
}

TEST_P(LevelsOnBoth, SwitchedInARunSpeakByTurnsAndTheLogRepeatsIt) {
  TickLog live, repeated;
  const auto run = build(rovers(GetParam()));
  run->add_observer(&live);
  const auto count = [&](const char* topic) { return run->find_topic(topic)->count; };
  for (int tick = 0; tick < 200; ++tick) {
    if (tick == 50) run->submit(LevelRequest{"rover1/laser", {"pose"}});
    if (tick == 60) run->submit(LevelRequest{"rover1/imu", {"pose"}});
    if (tick == 100) {
      // Samples at 0, 10, ... 50 ticks and 60 ... 100.
      EXPECT_EQ(count("/rover1/laser/ranges"), 5u + 1);
      EXPECT_EQ(count("/rover1/laser/pose"), 5u);
      run->submit(LevelRequest{"rover1/laser", {"ranges", "segments"}});
      run->submit(LevelRequest{"rover2/laser", {"lines"}});  // there is none: refused
    }
    if (tick == 150) run->submit(LevelRequest{"rover1/imu", {"imu"}});
    advance(*run, 1);
  }
  EXPECT_EQ(count("/rover1/laser/pose"), 5u);
  EXPECT_EQ(count("/rover1/laser/ranges"), 6u + 10);
  EXPECT_EQ(count("/rover1/laser/segments"), 10u);
  EXPECT_EQ(count("/rover2/laser/segments"), 0u);
  const auto* segments = topic_cast<msg::LineSegmentArray>(run->find_topic("/rover1/laser/segments"));
  ASSERT_TRUE(segments);
  EXPECT_FALSE(segments->message.segments.empty());
  const auto* pose = topic_cast<msg::PoseWithCovarianceStamped>(run->find_topic("/rover1/laser/pose"));
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->message.pose.covariance[0], 0.0025, 1e-15);

  const auto replay = build(rovers(GetParam()), {.threads = 2});
  replay->add_observer(&repeated);
  std::size_t asked = 0, refused = 0;
  for (const auto& entries : live.ticks) {
    for (const LogEntry& entry : entries) {
      if (entry.source.kind == Source::Kind::program) continue;
      ++asked;
      refused += entry.refused;
      Request request;
      ByteReader r(entry.bytes);
      ASSERT_TRUE(read_request(r, request));
      replay->submit(std::move(request), entry.source);
    }
    advance(*replay, 1);
  }
  EXPECT_EQ(asked, 5u);
  EXPECT_EQ(refused, 1u);
  EXPECT_EQ(repeated.hashes, live.hashes);
}

TEST_P(LevelsOnBoth, GoOnFromASnapshotInTheMiddleOfALevel) {
  const auto run = build(rovers(GetParam()));
  run->submit(LevelRequest{"rover1/laser", {"pose", "segments"}});
  run->submit(LevelRequest{"rover2/imu", {"pose", "imu"}});
  advance(*run, 77);
  const auto restored = again(*run, {.threads = 2});
  ASSERT_TRUE(restored);
  advance(*run, 60);
  advance(*restored, 60);
  EXPECT_EQ(restored->state_hash(), run->state_hash());
}

/// One rover on a floor whose right half is dark, under the sun.
model::Setup zones(const char* engine) {
  model::Setup setup = arena(engine, 1, "");
  auto floor = std::make_shared<model::Model>();
  floor->name = "floor";
  floor->is_static = true;
  floor->links.push_back({.name = "link"});
  for (const double side : {1.0, -1.0}) {
    model::Visual half;
    half.shape = Box{{8, 4, 0.01}};
    half.X_LC.p = {0, 2 * side, -0.005};
    const float shade = side > 0 ? 1.0f : 0.2f;
    half.material.diffuse = {shade, shade, shade, 1};
    floor->links[0].visuals.push_back(half);
  }
  setup.instances.push_back(placed("floor", floor, {}));
  model::Light sun;
  sun.color = {0.5f, 0.5f, 0.5f, 1};
  setup.lights.push_back(sun);
  setup.ambient = {0.1f, 0.1f, 0.1f, 1};
  model::Instance& rover = setup.instances[setup.instances.size() - 2];
  rover.X_WM = {{0, 1, 0}, {}};
  add_device(rover, "ground", "ground_sensor", map({{"range", "0.2"}}), {{0.1, 0, -0.05}, {}});
  add_device(rover, "color", "color_sensor", map({{"lamp", "false"}, {"range", "0.2"}}),
             {{0.1, 0, -0.05}, quat_from_rpy(0, math::pi / 2, 0)});
  add_device(rover, "light", "light_sensor", map({{"rate", "0"}}),
             {{0, 0, 0.1}, quat_from_rpy(0, -math::pi / 2, 0)});
  add_device(rover, "line", "line_camera", map({{"pixels", "2"}}),
             {{0.1, 0, -0.05}, quat_from_rpy(0, math::pi / 2, 0)});
  add_device(rover, "air", "thermometer", map({{"gradient", "0"}, {"rate", "10"}}));
  return setup;
}

TEST_P(LevelsOnBoth, SensorsThatLookSeeTheFloorAndTheLight) {
  const auto run = build(zones(GetParam()));
  const auto reflectance = [&] {
    return topic_cast<msg::Float32MultiArray>(run->find_topic("/rover1/ground/reflectance"))
        ->message.data.at(0);
  };
  const auto red = [&] {
    return static_cast<double>(topic_cast<msg::ColorRGBA>(run->find_topic("/rover1/color/color"))->message.r);
  };
  advance(*run, 10);
  EXPECT_NEAR(reflectance(), 1, 1e-6);
  EXPECT_NEAR(red(), 0.6, 0.5 / 255);  // the sun straight from above, and the ambient light
  EXPECT_NEAR(topic_cast<msg::Illuminance>(run->find_topic("/rover1/light/illuminance"))->message.illuminance,
              600, 1);
  EXPECT_EQ(topic_cast<msg::Temperature>(run->find_topic("/rover1/air/temperature"))->message.temperature,
            15);
  run->submit(PoseRequest{"rover1", {{0, -1, 0}, {}}});
  advance(*run, 10);
  EXPECT_NEAR(reflectance(), 0.2, 1e-6);
  EXPECT_NEAR(red(), 0.12, 0.5 / 255);
  const auto& line = topic_cast<msg::Image>(run->find_topic("/rover1/line/image"))->message.data;
  EXPECT_EQ(line, (std::vector<std::uint8_t>{31, 31}));  // 255 * 0.12
  const auto restored = again(*run, {.threads = 2});
  ASSERT_TRUE(restored);
  advance(*run, 20);
  advance(*restored, 20);
  EXPECT_EQ(restored->state_hash(), run->state_hash());
}

}  // namespace
}  // namespace sandlot::test
