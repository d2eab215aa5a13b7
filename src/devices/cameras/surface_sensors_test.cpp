/// Sensors of light, colour, floor and temperature against what is written down by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "devices/cameras/color_sensor/color_sensor.h"
#include "devices/cameras/ground_sensor/ground_sensor.h"
#include "devices/cameras/light_sensor/light_sensor.h"
#include "devices/cameras/line_camera/line_camera.h"
#include "devices/cameras/overhead_camera/overhead_camera.h"
#include "devices/inertial/thermometer/thermometer.h"
#include "devices/test_rig.h"
#include "optics/picture.h"

namespace sandlot {
namespace {

using test::config;
using test::Rig;

/// A scene whose first group stands in the world.
struct Scene {
  optics::PictureScene pictures;
  std::vector<optics::PictureShape> shapes;
  std::vector<optics::PictureLight> lights;

  void add(const Shape& shape, Vec3 p, Color color, std::uint32_t body = no_body) {
    optics::PictureShape made;
    made.X_GC.p = p;
    made.shape = shape;
    made.appearance.diffuse = color;
    made.body = body;
    shapes.push_back(made);
  }
  model::Light& light(model::Light::Type type, Vec3 p, Color color) {
    model::Light made;
    made.type = type;
    made.X_PLight.p = p;  // light leaves along -z
    made.color = color;
    made.cast_shadows = true;
    lights.push_back({0, made});
    return lights.back().light;
  }
  void finish(float ambient) {
    pictures.set_shapes(shapes);
    pictures.set_lights(lights);
    pictures.set_surroundings({{1, 1, 1, 1}, {ambient, ambient, ambient, 1}});
    SceneFrame frame;
    frame.X_WG.resize(1);
    pictures.update(frame);
  }
};

void sense(Rig& rig, Scene& scene) {
  Context context = rig.context(rig.now);
  context.pictures = &scene.pictures;
  rig.pool->sense(context, rig.due());
  for (std::uint64_t& k : rig.sample) ++k;
}

const Pose looking_up{{0, 0, 0.05}, quat_from_rpy(0, -math::pi / 2, 0)};
const Pose looking_down{{0, 0, 0.05}, quat_from_rpy(0, math::pi / 2, 0)};

TEST(LightSensor, AddsAmbientAndLightsByCosineAttenuationAndRange) {
  Scene scene;
  scene.light(model::Light::Type::directional, {}, {0.5f, 0.5f, 0.5f, 1});
  model::Light& lamp = scene.light(model::Light::Type::point, {0, 0, 2.05}, {0.3f, 0.3f, 0.3f, 1});
  lamp.linear = 0.5, lamp.quadratic = 0.25, lamp.range_m = 2.5;
  scene.light(model::Light::Type::point, {0, 0, 3.05}, {1, 1, 1, 1}).range_m = 2.9;  // too far
  scene.light(model::Light::Type::directional, {}, {0, 1, 0, 1}).X_PLight.q = quat_from_rpy(math::pi, 0, 0);
  scene.finish(0.1f);
  Rig rig(light_sensor::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("light", config({{"lux", "2000"}}), 1, 0, looking_up));
  const auto& shown = rig.topic<msg::Illuminance>("light/illuminance").message;
  sense(rig, scene);
  // The lamp's 0.3 at 2 m: 1 / (1 + 0.5 * 2 + 0.25 * 4) = 1/3 of it. The last light comes from below.
  EXPECT_NEAR(shown.illuminance, 2000 * (0.1 + 0.5 + 0.1), 2000 * 1e-6);
  // Rolled by 60 degrees about x the light falls aslant: half of it, and 0.866 less of the lamp's way.
  rig.engine->body[0].X_WB.q = quat_from_rpy(math::pi / 3, 0, 0);
  rig.engine->body[0].X_WB.p = Vec3{0, 0, 0.05} - rotate(rig.engine->body[0].X_WB.q, {0, 0, 0.05});
  sense(rig, scene);
  EXPECT_NEAR(shown.illuminance, 2000 * (0.1 + 0.25 + 0.05), 2000 * 1e-6);
  // Upside down the green light counts, by its weight.
  rig.engine->body[0].X_WB = {{0, 0, 0.1}, quat_from_rpy(math::pi, 0, 0)};
  sense(rig, scene);
  EXPECT_NEAR(shown.illuminance, 2000 * (0.1 + 0.7152), 2000 * 1e-6);
}

TEST(LightSensor, AShadowLeavesTheAmbientLight) {
  Scene scene;
  scene.light(model::Light::Type::directional, {}, {0.5f, 0.5f, 0.5f, 1});
  scene.add(Box{{1, 1, 0.1}}, {0, 0, 3}, {});
  scene.finish(0.1f);
  Rig rig(light_sensor::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("light", config({}), 1, 0, looking_up));
  const auto& shown = rig.topic<msg::Illuminance>("light/illuminance").message;
  for (const auto& [x, expected] :
       {std::pair{0.49, 100.0}, std::pair{0.51, 600.0}, std::pair{-0.49, 100.0}}) {
    rig.engine->body[0].X_WB.p.x = x;
    sense(rig, scene);
    EXPECT_NEAR(shown.illuminance, expected, 1e-3) << x;
  }
}

TEST(LightSensor, ItsHousingThrowsShadowsOnlyWhereAskedForThoseOfOtherLinksAlways) {
  Scene scene;
  scene.light(model::Light::Type::directional, {}, {0.5f, 0.5f, 0.5f, 1});
  scene.add(Box{{0.2, 0.2, 0.2}}, {0, 0, 0.05}, {}, 0);  // both sensors sit inside it
  scene.finish(0.1f);
  Rig rig(light_sensor::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("free", config({}), 1, 0, looking_up));
  ASSERT_TRUE(rig.add("shaded", config({{"own_shadow", "true"}}), 1, 0, looking_up));
  ASSERT_TRUE(rig.add("guest", config({}), 1, 3, looking_up));  // on another link, in the same place
  sense(rig, scene);
  EXPECT_NEAR(rig.topic<msg::Illuminance>("free/illuminance").message.illuminance, 600, 1e-3);
  EXPECT_NEAR(rig.topic<msg::Illuminance>("shaded/illuminance").message.illuminance, 100, 1e-3);
  EXPECT_NEAR(rig.topic<msg::Illuminance>("guest/illuminance").message.illuminance, 100, 1e-3);
}

TEST(ColorSensor, ShowsTheSurfacesOwnColourByItsLampAndTheLightThereWithout) {
  Scene scene;
  scene.add(Plane{{0, 0, 1}}, {}, {0.2f, 0.6f, 1, 1});
  scene.add(Box{{0.1, 0.1, 0.01}}, {0, 0, 0.03}, {1, 0, 0, 1}, 0);  // its own housing
  scene.light(model::Light::Type::directional, {}, {1, 1, 1, 1});
  scene.finish(0.2f);
  Rig rig(color_sensor::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("lamp", config({}), 1, 0, looking_down));
  ASSERT_TRUE(rig.add("none", config({{"lamp", "false"}}), 1, 0, looking_down));
  sense(rig, scene);
  const auto& lamp = rig.topic<msg::ColorRGBA>("lamp/color").message;
  const auto& none = rig.topic<msg::ColorRGBA>("none/color").message;
  EXPECT_NEAR(lamp.r, 0.2, 1e-6);  // 51, 153 and 255 of 255
  EXPECT_NEAR(lamp.g, 0.6, 1e-6);
  EXPECT_EQ(lamp.b, 1);
  EXPECT_EQ(lamp.a, 1);
  // Below the housing, which is not seen but throws its shadow, only the ambient light is left.
  EXPECT_NEAR(none.r, 0.04, 0.5 / 255);
  EXPECT_NEAR(none.g, 0.12, 0.5 / 255);
  EXPECT_NEAR(none.b, 0.2, 0.5 / 255);
  rig.engine->body[0].X_WB.p.z = 0.06;  // 0.11 m above the floor, out of range
  sense(rig, scene);
  EXPECT_EQ(lamp.a, 0);
  EXPECT_EQ(lamp.b, 0);
}

/// White on the left of y = 0, black on the right.
void two_halves(Scene& scene, float ambient) {
  scene.add(Box{{2, 1, 0.01}}, {0, 0.5, -0.005}, {1, 1, 1, 1});
  scene.add(Box{{2, 1, 0.01}}, {0, -0.5, -0.005}, {0, 0, 0, 1});
  scene.finish(ambient);
}

TEST(GroundSensor, TellsWhiteFromBlackSpotBySpotInAnyLight) {
  Scene scene;
  two_halves(scene, 0);  // pitch dark
  Rig rig(ground_sensor::kind, test::two_wheels());
  Node node = config({});
  Node spots = Node::sequence({});
  spots.push(config({{"y", "0.02"}}));
  spots.push(config({{"x", "0.05"}, {"y", "-0.02"}}));
  spots.push(config({{"x", "5"}}));  // beyond the boards
  node.set("spots", spots);
  ASSERT_TRUE(rig.add("ground", node, 1, 0, {{0, 0, 0.05}, {}}));
  const auto& shown = rig.topic<msg::Float32MultiArray>("ground/reflectance").message.data;
  sense(rig, scene);
  ASSERT_EQ(shown.size(), 3u);
  EXPECT_NEAR(shown[0], 1, 1e-6);
  EXPECT_NEAR(shown[1], 0, 1e-6);
  EXPECT_EQ(shown[2], 0);
  rig.engine->body[0].X_WB.q = quat_from_rpy(0, 0, math::pi);
  sense(rig, scene);
  EXPECT_NEAR(shown[0], 0, 1e-6);
  EXPECT_NEAR(shown[1], 1, 1e-6);
}

TEST(GroundSensor, ErrorsFollowTheirFactorAndTheirSeed) {
  Scene scene;
  scene.add(Plane{{0, 0, 1}}, {}, {0.5f, 0.5f, 0.5f, 1});
  scene.finish(0);
  const auto rms = [&](const char* errors) {
    Rig rig(ground_sensor::kind, test::two_wheels());
    Node node = config({{"errors", errors}, {"samples", "1"}});
    Node stage = config({}), list = Node::sequence({});
    stage.set("gaussian", config({{"std", "0.02"}}));
    list.push(stage);
    node.set("noise", list);
    EXPECT_TRUE(rig.add("ground", node, 1, 0, {{0, 0, 0.05}, {}}));
    double sum = 0;
    for (int i = 0; i < 400; ++i) {
      sense(rig, scene);
      const double off = static_cast<double>(
                             rig.topic<msg::Float32MultiArray>("ground/reflectance").message.data[0]) -
                         128 / 255.0;
      sum += off * off;
    }
    return std::sqrt(sum / 400);
  };
  // Relative deviation of an rms of 400: 1 / sqrt(800) = 3.5 %. Five of them.
  EXPECT_NEAR(rms("1"), 0.02, 0.02 * 5 * 0.0354);
  EXPECT_NEAR(rms("3"), 0.06, 0.06 * 5 * 0.0354);
  EXPECT_NEAR(rms("0"), 0, 1e-6);
}

TEST(LineCamera, ShowsTheRowFromLeftToRight) {
  Scene scene;
  two_halves(scene, 0.5f);
  Rig rig(line_camera::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("mono", config({{"pixels", "10"}, {"gain", "1.2"}}), 1, 0, looking_down));
  ASSERT_TRUE(rig.add("rgb", config({{"pixels", "10"}, {"format", "rgb8"}}), 1, 0, looking_down));
  // The edge lies 0.02 m to the left of the axis: at 0.05 m height, half the row (0.5 rad) spans 0.0273 m, so
  // 1.34 of 5 pixels are white.
  rig.engine->body[0].X_WB.p.y = -0.02;
  sense(rig, scene);
  const auto& mono = rig.topic<msg::Image>("mono/image").message;
  EXPECT_EQ(mono.width, 10u);
  EXPECT_EQ(mono.height, 1u);
  EXPECT_EQ(mono.encoding, "mono8");
  EXPECT_EQ(mono.data, (std::vector<std::uint8_t>{153, 0, 0, 0, 0, 0, 0, 0, 0, 0}));  // 255 * 0.5 * 1.2
  const auto& rgb = rig.topic<msg::Image>("rgb/image").message;
  EXPECT_EQ(rgb.step, 30u);
  ASSERT_EQ(rgb.data.size(), 30u);
  EXPECT_EQ(rgb.data[2], 128);
  EXPECT_EQ(rgb.data[3], 0);
}

TEST(Thermometer, FollowsTheAirWithItsTimeConstant) {
  Rig rig(thermometer::kind, test::two_wheels(), 0.5);
  ASSERT_TRUE(
      rig.add("t", config({{"ambient", "20"}, {"response", "10"}, {"rate", "0"}}), 1, 0, {{0, 0, 1}, {}}));
  const auto& shown = rig.topic<msg::Temperature>("t/temperature").message;
  rig.engine->body[0].X_WB.p.z = 999;
  rig.sense();
  EXPECT_NEAR(shown.temperature, 13.5, 1e-12);  // 1000 m up
  rig.engine->body[0].X_WB.p.z = -1;
  for (int i = 0; i < 20; ++i) rig.sense();  // 10 s
  EXPECT_NEAR(shown.temperature, 20 - 6.5 * math::exp(-1.0), 1e-12);
}

LabelledObject thing_of(const char* name, const char* label, std::uint32_t body, bool moves) {
  LabelledObject thing;
  thing.name = name;
  thing.label = label;
  thing.moves = moves;
  thing.color = {1, 0.5f, 0, 1};
  thing.bodies = {body};
  return thing;
}

const std::vector<msg::ObjectPose>& overhead(Rig& rig, std::span<const LabelledObject> things) {
  Context context = rig.context(rig.now);
  context.labelled_objects = things;
  rig.pool->sense(context, rig.due());
  for (std::uint64_t& k : rig.sample) ++k;
  return rig.topic<msg::ObjectPoseArray>("eye/world").message.objects;
}

TEST(OverheadCamera, TellsWhereThingsAreThatMoveAndCastsNoRay) {
  Rig rig(overhead_camera::kind, test::two_wheels());
  ASSERT_TRUE(rig.add("eye", config({})));
  const Pose at = pose_from_rpy({3, 4, 0.1}, {0, 0, 1});
  rig.engine->body[1].X_WB = at;
  const std::vector<LabelledObject> things{thing_of("ball1", "ball", 1, true),
                                           thing_of("goal", "goal", 2, false),
                                           thing_of("robot2", "robot", 3, true)};
  const auto& told = overhead(rig, things);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_EQ(told[0].name, "ball1");
  EXPECT_EQ(told[0].label, "ball");
  EXPECT_EQ(told[0].pose, at);
  EXPECT_EQ(told[0].color.g, 0.5f);
  EXPECT_EQ(told[1].name, "robot2");
  Rig some(overhead_camera::kind, test::two_wheels());
  Node node = config({{"fixed", "true"}, {"names", "false"}});
  Node labels = Node::sequence({});
  labels.push(Node::scalar("goal"));
  node.set("labels", labels);
  ASSERT_TRUE(some.add("eye", node));
  ASSERT_EQ(overhead(some, things).size(), 1u);
  EXPECT_EQ(overhead(some, things)[0].label, "goal");
  EXPECT_EQ(overhead(some, things)[0].name, "");
}

TEST(OverheadCamera, ErrsAndMissesAsConfiguredThingByThing) {
  const std::vector<LabelledObject> one{thing_of("ball1", "ball", 1, true)};
  const std::vector<LabelledObject> two{thing_of("other", "ball", 2, true),
                                        thing_of("ball1", "ball", 1, true)};
  Node node = config({{"position_std", "0.05"}, {"yaw_std", "0.1"}, {"miss", "0.2"}, {"errors", "2"}});
  Rig alone(overhead_camera::kind, test::two_wheels()), together(overhead_camera::kind, test::two_wheels());
  ASSERT_TRUE(alone.add("eye", node));
  ASSERT_TRUE(together.add("eye", node));
  const Vec3 p = alone.engine->body[1].X_WB.p;
  double x2 = 0, seen = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto& told = overhead(alone, one);
    const auto& more = overhead(together, two);
    // What else there is changes nothing about the ball.
    const bool last = !more.empty() && more.back().name == "ball1";
    ASSERT_EQ(told.empty(), !last);
    if (told.empty()) continue;
    ASSERT_EQ(told[0].pose, more.back().pose);
    const Vec3 off = told[0].pose.p - p;
    x2 += off.x * off.x + off.y * off.y;
    ++seen;
  }
  // 0.6 of 2000: deviation sqrt(0.24 / 2000) = 1.1 %; rms of 2400 deviates: 1 / sqrt(4800) = 1.4 %. Five of
  // them.
  EXPECT_NEAR(seen / 2000, 0.6, 5 * 0.011);
  EXPECT_NEAR(std::sqrt(x2 / (2 * seen)), 0.1, 0.1 * 5 * 0.0145);
}

TEST(LookingSensors, RefuseWhatCannotBe) {
  const auto refused = [](const Kind& kind, std::initializer_list<std::pair<const char*, const char*>> keys) {
    Rig rig(kind, test::two_wheels());
    const Status status = rig.add("d", config(keys));
    EXPECT_FALSE(status);
    return status ? std::string() : status.error().text();
  };
  EXPECT_NE(refused(color_sensor::kind, {{"fov", "180 deg"}}).find("fov"), std::string::npos);
  EXPECT_NE(refused(line_camera::kind, {{"pixels", "100000"}}).find("8192"), std::string::npos);
  EXPECT_NE(refused(line_camera::kind, {{"format", "bgr"}}).find("rgb8"), std::string::npos);
  EXPECT_NE(refused(light_sensor::kind, {{"lux", "-1"}}).find("lux"), std::string::npos);
  EXPECT_NE(refused(thermometer::kind, {{"ambient", "-300"}}).find("ambient"), std::string::npos);
  EXPECT_NE(refused(ground_sensor::kind, {{"samples", "0"}}).find("robot.yaml:1"), std::string::npos);
}

}  // namespace
}  // namespace sandlot
