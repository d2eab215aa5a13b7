#include "sim/visuals/ground_paint.h"

#include <gtest/gtest.h>

#include "sim/test_world.h"
#include "sim/visuals/render_scene.h"

namespace sandlot::test {
namespace {

Node paint_numbers(std::initializer_list<double> values) {
  Node out = Node::sequence();
  for (const double value : values) out.push(Node::scalar(std::to_string(value)));
  return out;
}

model::ElementDecl disc(const char* name, double x, const char* radius, std::initializer_list<double> color,
                        const char* visible) {
  Node config = map({{"radius", radius}, {"visible", visible}});
  config.set("centre", paint_numbers({x, 0}));
  config.set("color", paint_numbers(color));
  return {name, "disc", std::move(config), {}};
}

/// A white floor with a robot that looks down from 5 cm at (0, 0), (1, 0) and (3, 0).
model::Setup floor_world(const char* engine) {
  model::Setup setup;
  setup.engine = engine;
  setup.gravity = {0, 0, engine == std::string("planar") ? -9.81 : 0.0};
  auto ground = one_shape("ground", Plane{{0, 0, 1}}, 0);
  model::Visual visual;
  visual.shape = Plane{{0, 0, 1}};
  visual.material.diffuse = {1, 1, 1, 1};
  ground->links[0].visuals.push_back(visual);
  setup.instances.push_back(placed("ground", ground, {}));
  model::Instance robot = placed("robot", one_shape("robot", Cylinder{0.1, 0.2}, 1), {{0, 0, 0.1}, {}});
  robot.is_robot = true;
  model::DeviceDecl eyes;
  eyes.name = "floor";
  eyes.kind = "ground_sensor";
  eyes.X_LS.p.z = -0.05;
  Node spots = Node::sequence();
  for (const char* const x : {"0", "1", "3"}) spots.push(map({{"x", x}}));
  eyes.config = map({{"rate", "0"}});
  eyes.config.set("spots", spots);
  robot.devices.push_back(eyes);
  setup.instances.push_back(robot);
  return setup;
}

std::vector<float> seen(const model::Setup& setup) {
  const auto simulation = build(setup);
  advance(*simulation, 1);
  const auto* const topic = topic_cast<msg::Float32MultiArray>(simulation->find_topic("robot/floor"));
  SL_CHECK(topic != nullptr);
  return topic->message.data;
}

TEST(GroundPaint, GroundSensorsSeeVisibleMarkersAlone) {
  for (const char* const engine : {"rigid", "planar"}) {
    model::Setup setup = floor_world(engine);
    setup.markers.push_back(disc("black", 0, "0.2", {0, 0, 0}, "true"));
    setup.markers.push_back(disc("hidden", 1, "0.2", {0, 0, 0}, "false"));
    EXPECT_EQ(seen(setup), (std::vector<float>{0, 1, 1})) << engine;
    // A later one covers an earlier one: 51 of 255.
    setup.markers.push_back(disc("grey", 0, "0.1", {0.2, 0.2, 0.2}, "true"));
    EXPECT_NEAR(seen(setup)[0], 0.2, 1e-6) << engine;
    std::swap(setup.markers[0], setup.markers[2]);
    EXPECT_EQ(seen(setup)[0], 0) << engine;
  }
}

TEST(GroundPaint, TouchesNothingAndChangesNoRunInWhichNobodyLooks) {
  for (const char* const engine : {"rigid", "planar"}) {
    std::vector<std::uint64_t> hashes;
    for (const char* const visible : {"false", "true"}) {
      model::Setup setup = arena(engine, 2);
      setup.markers.push_back(disc("goal", 0, "3", {1, 0, 0}, visible));
      const auto simulation = build(setup);
      advance(*simulation, 40);
      hashes.push_back(simulation->state_hash());
    }
    EXPECT_EQ(hashes[0], hashes[1]) << engine;
  }
}

TEST(GroundPaint, IsNotTornByTheGroundFromFarAway) {
  model::Setup setup = floor_world("rigid");
  setup.markers.push_back(disc("red", 0, "20", {1, 0, 0}, "true"));
  setup.markers.push_back(disc("blue", 0, "10", {0, 0, 1}, "true"));
  const auto simulation = build(setup);
  advance(*simulation, 1);
  // Lenses of 0.05 rad that look at the origin: all they see of the ground is within the blue disc.
  for (const auto& [at, pitch] :
       {std::pair{Vec3{-30, 0, 10}, math::atan2(10.0, 30.0)}, {Vec3{0, 0, 30}, math::pi / 2}}) {
    constexpr int size = 64;
    std::vector<std::uint8_t> rgb(std::size_t{3} * size * size);
    optics::PictureJob job;
    job.X_WS = {at, quat_from_rpy(0, pitch, 0)};
    const auto lens = optics::pinhole_of_fov(size, size, 0.05);
    ASSERT_TRUE(lens);
    job.lens = optics::LensTable::make(*lens);
    job.exposure.lit = false;
    job.rgb = rgb;
    simulation->render_scene().pictures.render(std::span(&job, 1));
    for (std::size_t i = 0; i < rgb.size(); i += 3)
      ASSERT_EQ((std::array{rgb[i], rgb[i + 1], rgb[i + 2]}), (std::array<std::uint8_t, 3>{0, 0, 255}))
          << i / 3;
  }
}

}  // namespace
}  // namespace sandlot::test
