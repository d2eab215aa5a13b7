#include "draw/viewpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "assets/image/visible.h"
#include "base/math.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::draw {
namespace {

using testing::HasSubstr;

/// A red cube of 1 m that stands on the ground at (2, 0), and a robot that turns on the spot; light from
/// everywhere.
constexpr const char* world_sdf = R"(<sdf version="1.9"><world name="w">
  <scene><ambient>1 1 1 1</ambient><background>0 0 1 1</background></scene>
  <model name="cube"><static>true</static><pose>2 0 0.5 0 0 0</pose><link name="l">
    <collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision>
    <visual name="v"><geometry><box><size>1 1 1</size></box></geometry><material><diffuse>1 0 0 1</diffuse></material></visual>
  </link></model>
</world></sdf>)";

class Views : public testing::Test {
 protected:
  Views() {
    const std::string folder = testing::TempDir() + "views/";
    std::filesystem::create_directories(folder);
    std::ofstream(folder + "w.sdf") << world_sdf;
    Diagnostics diagnostics;
    LoadOptions options;
    const std::string text =
        "version: 1\nname: t\nworld: w.sdf\ntime: {step: 20 ms, stop: 100 s}\nrobots:\n"
        "  - {name: bot, model: {builder: diff_robot}, pose: [-3, 0, 0], controller: {kind: sequence, steps: "
        "[{at: 0 s, orders: {drive: [0, 0, "
        "1]}}]}, devices: {drive: {level: ideal}}}\n";
    options.text = text;
    auto setup = load(folder + "t.yaml", options, diagnostics);
    EXPECT_TRUE(setup) << setup.error().text();
    auto made = Simulation::create(std::move(*setup), {}, diagnostics);
    EXPECT_TRUE(made) << made.error().text();
    simulation = std::move(*made);
  }
  std::string refusal(const ViewpointOptions& options) {
    const auto view = Viewpoint::make(options, *simulation);
    return view ? "" : view.error().text();
  }
  assets::Picture picture(const ViewpointOptions& options) {
    auto view = Viewpoint::make(options, *simulation);
    EXPECT_TRUE(view) << view.error().text();
    auto out = view->picture(*simulation);
    EXPECT_TRUE(out) << out.error().text();
    return std::move(*out);
  }
  std::unique_ptr<Simulation> simulation;
};

using Rgb = std::array<int, 3>;
Rgb at(const assets::Picture& p, int x, int y) {
  const auto i = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(p.width) +
                      static_cast<std::size_t>(x));
  return {p.rgb[i], p.rgb[i + 1], p.rgb[i + 2]};
}
constexpr Rgb red{255, 0, 0}, blue{0, 0, 255};

TEST_F(Views, ShowWhatIsThereWhereItIs) {
  // From 2 m before the front of the cube, at the height of its middle, 90 degrees wide: the front spans
  // +-atan(0.5 / 2), which is a quarter of the width of 200 pixels: from 74.5 to 124.5 px.
  ViewpointOptions options{.from = Vec3{-0.5, 0, 0.5},
                           .at = Vec3{2, 0, 0.5},
                           .width = 200,
                           .height = 100,
                           .fov_rad = math::pi / 2,
                           .samples = 1};
  const assets::Picture p = picture(options);
  EXPECT_EQ(at(p, 100, 50), red);
  for (const int y : {30, 50, 70}) {
    EXPECT_EQ(at(p, 76, y), red);
    EXPECT_EQ(at(p, 123, y), red);
    EXPECT_EQ(at(p, 73, y), blue);
    EXPECT_EQ(at(p, 126, y), blue);
  }
  options.plane = "labels";
  EXPECT_EQ(at(picture(options), 10, 5), (Rgb{0, 0, 0})) << "nothing";
  EXPECT_NE(at(picture(options), 100, 50), (Rgb{0, 0, 0}));
  options.plane = "depth";
  EXPECT_EQ(at(picture(options), 10, 5), (Rgb{0, 0, 0}));
  EXPECT_NE(at(picture(options), 100, 50), (Rgb{0, 0, 0}));
}

TEST_F(Views, FromAboveNorthIsUpAndEverythingIsThere) {
  // The robot on the left, the cube on the right.
  const assets::Picture p = picture({.camera = "overhead", .width = 200, .height = 100, .samples = 1});
  int left = 200, right = 0;
  for (int x = 0; x < 200; ++x)
    for (int y = 0; y < 100; ++y)
      if (at(p, x, y) == red) left = std::min(left, x), right = std::max(right, x);
  EXPECT_GT(left, 120);
  EXPECT_LT(right, 199);
  EXPECT_GT(right, 180) << "and it fills the picture";
  EXPECT_EQ(at(p, 100, 5), blue);
}

TEST_F(Views, AViewThatFollowsStaysBeforeAWall) {
  auto view = Viewpoint::make({.camera = "follow:bot"}, *simulation);
  ASSERT_TRUE(view);
  EXPECT_LT(view->pose(*simulation)->p.x, -3.6) << "nothing behind it: farther than the wall will be";
  simulation->submit(PoseRequest{"cube", {{-4.1, 0, 0.5}, {}}});
  ASSERT_TRUE(simulation->tick());
  const Vec3 eye = view->pose(*simulation)->p;
  EXPECT_GT(eye.x, -3.6) << "the wall's face";
  EXPECT_LT(eye.x, -3.3);
}

TEST_F(Views, AViewThatFollowsLagsBehindTheHeading) {
  auto view = Viewpoint::make({.camera = "follow:bot"}, *simulation);
  ASSERT_TRUE(view);
  const auto yaw = [&] {
    const Vec3 x = rotate(view->pose(*simulation)->q, {1, 0, 0});
    return math::atan2(x.y, x.x);
  };
  EXPECT_NEAR(yaw(), 0, 1e-9);
  const Pose first = *view->pose(*simulation);
  EXPECT_LT(first.p.x, -3.3) << "behind it";
  EXPECT_GT(first.p.z, 0.2) << "and above";
  // The heading goes on at 1 rad/s once the drive turns so fast. A first-order lag of 0.5 s is then 0.5 rad
  // behind, a little more as the directions are averaged and not the angles.
  double turned = 0;
  while (simulation->now().s() < 5) {
    ASSERT_TRUE(simulation->tick());
    turned = yaw();
  }
  const Vec3 ahead = rotate(simulation->engine().pose(*simulation->find_instance("bot")).q, {1, 0, 0});
  double behind = math::atan2(ahead.y, ahead.x) - turned;
  if (behind < 0) behind += math::tau;
  EXPECT_NEAR(behind, 0.5, 0.06);
}

TEST_F(Views, RefuseWhatCannotBeWithWhatWouldBeRight) {
  EXPECT_THAT(refusal({}), HasSubstr("give one of --camera"));
  EXPECT_THAT(refusal({.from = Vec3{1, 2, 3}}), HasSubstr("--from and --at go together"));
  EXPECT_THAT(refusal({.from = Vec3{1, 2, 3}, .at = Vec3{1, 2, 3}}), HasSubstr("the same point"));
  EXPECT_THAT(refusal({.camera = "follow:bit"}), HasSubstr("did you mean 'bot'"));
  EXPECT_THAT(refusal({.camera = "bot/eye"}), HasSubstr("nothing here sends pictures"));
  EXPECT_THAT(refusal({.camera = "overhead", .plane = "colour"}),
              HasSubstr("known are: rgb, depth, labels, instances"));
  EXPECT_NE(refusal({.camera = "overhead", .width = 100'000, .height = 100'000}), "");
  EXPECT_NE(refusal({.camera = "overhead", .fov_rad = math::pi}), "");
}

}  // namespace
}  // namespace sandlot::draw
