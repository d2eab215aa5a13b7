/// Wide-angle lenses of SDF: r = c1 f fun(theta / c2), as keys of the lens.
#include "devices/cameras/camera_sdf.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "base/text.h"

namespace sandlot::sdf_element {
namespace {

constexpr double pi = std::numbers::pi;

Node map_of(std::initializer_list<std::pair<const char*, const char*>> entries) {
  Node node = Node::map();
  for (const auto& [key, value] : entries) node.set(key, Node::scalar(value));
  return node;
}

Result<Node> read_lens(Node lens, const char* fov, Diagnostics& diagnostics) {
  Node camera = map_of({{"horizontal_fov", fov}});
  camera.set("image", map_of({{"width", "800"}, {"height", "600"}}));
  camera.set("lens", std::move(lens));
  Node element = Node::map();
  element.set("camera", std::move(camera));
  return camera_keys(element, diagnostics, {.color = true});
}

double number_in(const Node& node, const char* key) {
  double value = NAN;
  const Node* const found = node.find(key);
  EXPECT_TRUE(found && parse_number(found->text(), value)) << key;
  return value;
}

/// Pixels from the optical axis, as OpenCV's fisheye has them.
double radius_px(const Node& keys, double theta) {
  const Node& d = *keys.find("distortion");
  const double s = theta * theta;
  return number_in(keys, "fx") * theta *
         (1 + s * (number_in(d, "k1") +
                   s * (number_in(d, "k2") + s * (number_in(d, "k3") + s * number_in(d, "k4")))));
}

TEST(CameraSdf, ALensOfItsOwnFunctionKeepsItWithinAHundredthOfAPixel) {
  Diagnostics diagnostics;
  for (const bool tangent : {true, false}) {
    Node lens = map_of({{"type", "custom"}, {"scale_to_hfov", "true"}, {"cutoff_angle", "2"}});
    lens.set("custom_function",
             map_of({{"c1", "1.05"}, {"c2", "4"}, {"f", "1"}, {"fun", tangent ? "tan" : "sin"}}));
    const auto keys = read_lens(std::move(lens), "3.1415926", diagnostics);
    ASSERT_TRUE(keys) << keys.error().text();
    EXPECT_EQ(keys->find("lens")->text(), "kannala_brandt");
    EXPECT_NEAR(number_in(*keys, "horizontal_fov"), 4, 1e-12);  // up to the cutoff
    const auto fun = [&](double x) { return tangent ? math::tan(x) : math::sin(x); };
    for (double theta = 0.05; theta < 2; theta += 0.05)  // 90 degrees are seen at the edge, 400 px away
      EXPECT_NEAR(radius_px(*keys, theta), 400 * fun(theta / 4) / fun(pi / 8), 0.01) << theta;
  }
  EXPECT_TRUE(diagnostics.warnings.empty());
}

TEST(CameraSdf, AnUnscaledLensHasHalfTheWidthTimesItsFunction) {
  Diagnostics diagnostics;
  Node lens = map_of({{"type", "custom"}, {"scale_to_hfov", "false"}});
  lens.set("custom_function", map_of({{"c1", "1.5"}, {"c2", "2"}, {"f", "0.8"}, {"fun", "id"}}));
  const auto keys = read_lens(std::move(lens), "1", diagnostics);
  ASSERT_TRUE(keys);
  EXPECT_NEAR(radius_px(*keys, 0.7), 400 * 1.5 * 0.8 * 0.7 / 2, 1e-6);
  EXPECT_NEAR(number_in(*keys, "horizontal_fov"), pi, 1e-12) << "SDF's cutoff is 90 degrees";
}

TEST(CameraSdf, NamedLensesEndAtTheirFieldOfView) {
  // By hand: at 60 degrees the edge, 400 px away. 2 tan(30 deg), 60 deg, 2 sin(30 deg), sin(60 deg).
  Diagnostics diagnostics;
  const std::pair<const char*, double> names[] = {{"stereographic", 1.154700538379252},
                                                  {"equidistant", pi / 3},
                                                  {"equisolid_angle", 1.0},
                                                  {"orthographic", 0.866025403784439}};
  for (const auto& [name, radius] : names) {
    const auto keys = read_lens(map_of({{"type", name}}), "2.0943951023931953", diagnostics);
    ASSERT_TRUE(keys) << name;
    EXPECT_NEAR(number_in(*keys, "fx"), 400 / radius, 1e-9) << name;
    EXPECT_EQ(keys->find("distortion"), nullptr);
  }
  EXPECT_TRUE(diagnostics.warnings.empty());
}

TEST(CameraSdf, WhatIsNoLensIsRefusedOrNamed) {
  Diagnostics diagnostics;
  const auto complaint = [&](Node lens, const char* fov) {
    const auto keys = read_lens(std::move(lens), fov, diagnostics);
    return keys ? std::string("fine") : keys.error().text();
  };
  EXPECT_NE(complaint(map_of({{"type", "equidistance"}}), "1").find("did you mean 'equidistant'"),
            std::string::npos);
  EXPECT_NE(complaint(map_of({{"type", "orthographic"}}), "4").find("at most 3.14 rad"), std::string::npos);
  EXPECT_NE(complaint(map_of({{"type", "equidistant"}, {"cutoff_angle", "0"}}), "1").find("sees nothing"),
            std::string::npos);
  const auto custom = [&](std::initializer_list<std::pair<const char*, const char*>> function) {
    Node lens = map_of({{"type", "custom"}});
    lens.set("custom_function", map_of(function));
    return complaint(std::move(lens), "1");
  };
  EXPECT_NE(custom({{"fun", "cos"}}).find("sin, tan or id"), std::string::npos);
  EXPECT_NE(custom({{"c2", "0"}}).find("above 0"), std::string::npos);
  EXPECT_TRUE(diagnostics.warnings.empty());
  EXPECT_EQ(custom({{"c3", "0.1"}}), "fine");
  EXPECT_EQ(diagnostics.warnings.size(), 1u);
}

}  // namespace
}  // namespace sandlot::sdf_element
