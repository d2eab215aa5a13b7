#include "sim/visuals/render_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/test_folder.h"
#include "sim/load/load.h"
#include "sim/test_world.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

model::Visual visual(const Shape& shape, Pose X_LC, Color color) {
  model::Visual made;
  made.shape = shape;
  made.X_LC = X_LC;
  made.material.diffuse = color;
  return made;
}

/// A ground plane, a labelled ball and a cart of two visuals.
model::Setup render_world() {
  model::Setup setup;
  setup.instances.push_back(test::placed("ground", test::one_shape("plane", Plane{{0, 0, 1}}, 0), {}));
  model::Instance ball = test::placed("ball1", test::one_shape("size5", Sphere{0.11}, 0.4),
                                      {{1, 2, 0.11}, {}});
  ball.label = "ball";
  setup.instances.push_back(ball);
  auto cart = test::one_shape("cart", Box{{0.4, 0.2, 0.1}}, 2);
  cart->links[0].visuals.push_back(visual(Box{{0.4, 0.2, 0.1}}, {}, {0, 0, 1, 1}));
  cart->links[0].visuals.push_back(visual(Sphere{0.05}, {{0, 0, 0.1}, {}}, {1, 0, 0, 1}));
  setup.instances.push_back(test::placed("cart", cart, {{0, 0, 0.05}, {}}));
  setup.instances.back().is_robot = true;
  setup.instances.back().team = "cyan";
  return setup;
}

TEST(RenderScene, NamesLabelsColoursAndBoundsOfThings) {
  Diagnostics diagnostics;
  auto sim = Simulation::create(render_world(), {}, diagnostics);
  ASSERT_TRUE(sim) << sim.error().what;
  const auto& things = (*sim)->render_scene().labelled_objects;
  ASSERT_EQ(things.size(), 2u);  // the ground has no bounds
  EXPECT_EQ(things[0].name, "ball1");
  EXPECT_EQ(things[0].label, "ball");
  EXPECT_TRUE(things[0].moves);
  EXPECT_FALSE(things[0].is_robot);
  EXPECT_NEAR(things[0].bounds_B.size().x, 0.22, 1e-9);  // it has no visuals: those of its collision
  EXPECT_EQ(things[1].label, "cart");                    // nobody said otherwise
  EXPECT_EQ(things[1].team, "cyan");
  EXPECT_TRUE(things[1].is_robot);
  EXPECT_EQ(things[1].color, (Color{0, 0, 1, 1}));  // the box is larger than the sphere
  EXPECT_NEAR(things[1].bounds_B.low.z, -0.05, 1e-9);
  EXPECT_NEAR(things[1].bounds_B.high.z, 0.15, 1e-9);
  EXPECT_NE(things[0].instance, things[1].instance);
}

TEST(RenderScene, FollowsWhatComesAndGoesAndKeepsInstanceNumbers) {
  Diagnostics diagnostics;
  auto sim = Simulation::create(render_world(), {}, diagnostics);
  ASSERT_TRUE(sim);
  const std::uint32_t cart = (*sim)->render_scene().labelled_objects[1].instance;
  (*sim)->submit(DeleteRequest{"ball1"});
  ASSERT_TRUE((*sim)->tick());
  ASSERT_EQ((*sim)->render_scene().labelled_objects.size(), 1u);
  EXPECT_EQ((*sim)->render_scene().labelled_objects[0].instance, cart);
  (*sim)->submit(SpawnRequest{test::placed("ball2", test::one_shape("size5", Sphere{0.11}, 0.4), {})});
  ASSERT_TRUE((*sim)->tick());
  const auto& things = (*sim)->render_scene().labelled_objects;
  ASSERT_EQ(things.size(), 2u);
  EXPECT_EQ(things[1].label, "size5");
  EXPECT_NE(things[1].instance, cart);
}

TEST(RenderScene, DrawsTheWorldWithoutChangingTheRun) {
  Diagnostics diagnostics;
  auto seen = Simulation::create(render_world(), {}, diagnostics),
       plain = Simulation::create(render_world(), {}, diagnostics);
  ASSERT_TRUE(seen && plain);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE((*seen)->tick());
    ASSERT_TRUE((*plain)->tick());
    std::vector<std::uint32_t> instance(1);
    auto lens = optics::pinhole_of_fov(1, 1, 1.0);
    ASSERT_TRUE(lens);
    optics::PictureJob job;
    job.X_WS = {{-2, 0, 0.05}, {}};
    job.lens = optics::LensTable::make(*lens);
    job.instance = instance;
    RenderScene& scene = (*seen)->render_scene();
    scene.pictures.render(std::span(&job, 1));
    EXPECT_EQ(instance[0], scene.labelled_objects[1].instance);  // the cart stands straight ahead
  }
  EXPECT_EQ((*seen)->state_hash(), (*plain)->state_hash());
}

/// Boards of 1.6 m x 1.6 m at x = 2, whose textures are missing or broken: y = 0 a mesh, 10 a material, 20 a broken file, and
/// another mesh and material with the same textures.
constexpr const char* boards = R"(<sdf version="1.9"><world name="w">
<model name="mesh"><static>1</static><link name="l"><visual name="v"><geometry><mesh><uri>board.obj</uri></mesh></geometry></visual></link></model>
<model name="box"><static>1</static><pose>2.5 10 0 0 0 0</pose><link name="l"><visual name="v"><geometry><box><size>1 1.6 1.6</size></box></geometry>
<material><pbr><metal><albedo_map>no.png</albedo_map></metal></pbr></material></visual></link></model>
<model name="broken"><static>1</static><pose>2.5 20 0 0 0 0</pose><link name="l"><visual name="v"><geometry><box><size>1 1.6 1.6</size></box></geometry>
<material><pbr><metal><albedo_map>broken.png</albedo_map></metal></pbr></material></visual>
<visual name="u"><pose>0 0 50 0 0 0</pose><geometry><box><size>1 1 1</size></box></geometry>
<material><pbr><metal><albedo_map>no.png</albedo_map></metal></pbr></material></visual></link></model>
<model name="again"><static>1</static><pose>0 50 0 0 0 0</pose><link name="l"><visual name="v"><geometry><mesh><uri>board.obj</uri></mesh></geometry></visual></link></model>
<model name="eye"><static>1</static><link name="l"><sensor name="camera" type="camera"><update_rate>10</update_rate><camera>
<image><width>8</width><height>8</height></image></camera></sensor></link></model>
</world></sdf>)";

TEST(RenderScene, MissingTexturesAreACheckerAndOneWarningEach) {
  const test::TestFolder folder;
  folder.write("w.sdf", boards);
  folder.write("board.obj",
               "mtllib board.mtl\nusemtl paint\nv 2 0.8 -0.8\nv 2 -0.8 -0.8\nv 2 -0.8 0.8\nv 2 0.8 0.8\n"
               "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
  folder.write("board.mtl", "newmtl paint\nKd 1 1 1\nmap_Kd gone.png\n");
  folder.write("broken.png", "no image");
  Diagnostics diagnostics;
  auto setup = load(folder.file("w.sdf"), {}, diagnostics);
  ASSERT_TRUE(setup) << setup.error().text();
  auto sim = Simulation::create(std::move(*setup), {}, diagnostics);
  ASSERT_TRUE(sim) << sim.error().text();
  std::vector<std::string> said;
  for (const Error& each : diagnostics.warnings)
    if (each.text().find("checker") != std::string::npos) said.push_back(each.text());
  std::sort(said.begin(), said.end());
  ASSERT_EQ(said.size(), 3u);
  const auto begins = [](const std::string& text, const std::string& with) {
    EXPECT_EQ(text.substr(0, with.size()), with);
  };
  begins(said[0], folder.file("board.mtl") + ":3: the texture '" + folder.file("gone.png") +
                      "' does not exist; a checker");
  begins(said[1],
         folder.file("w.sdf") + ":4: the texture '" + folder.file("no.png") + "' is not there; a checker");
  begins(said[2],
         folder.file("w.sdf") + ":5: the texture '" + folder.file("broken.png") + "' cannot be used: ");

  // 200 px at 2 m are 2 m: the board fills the picture, each of its 8 x 8 squares 20 x 20 pixels. The upper left is magenta.
  for (const double y : {0.0, 10.0, 20.0}) {
    std::vector<std::uint8_t> rgb(std::size_t{3} * 160 * 160);
    optics::PictureJob job;
    job.X_WS = {{0, y, 0}, {}};
    job.lens = optics::LensTable::make(
        {160, 160, optics::Pinhole{.fx = 200, .fy = 200, .cx = 79.5, .cy = 79.5}});
    job.exposure.lit = false;
    job.rgb = rgb;
    (*sim)->render_scene().pictures.render(std::span(&job, 1));
    for (std::size_t row = 0; row < 8; ++row)
      for (std::size_t column = 0; column < 8; ++column) {
        const std::size_t at = 3 * ((20 * row + 10) * 160 + 20 * column + 10);
        const int on = (row + column) % 2 == 0 ? 255 : 0;
        ASSERT_EQ((std::array{int{rgb[at]}, int{rgb[at + 1]}, int{rgb[at + 2]}}), (std::array{on, 0, on}))
            << y << ": square " << row << ", " << column;
      }
  }
}

}  // namespace
}  // namespace sandlot
