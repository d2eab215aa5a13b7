#include "sim/sight.h"

#include <gtest/gtest.h>

#include "sim/simulation.h"
#include "sim/test_world.h"

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
model::Setup world() {
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

TEST(Sight, NamesLabelsColoursAndBoundsOfThings) {
  Diagnostics diagnostics;
  auto sim = Simulation::create(world(), {}, diagnostics);
  ASSERT_TRUE(sim) << sim.error().what;
  const auto& things = (*sim)->sight().things;
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

TEST(Sight, FollowsWhatComesAndGoesAndKeepsInstanceNumbers) {
  Diagnostics diagnostics;
  auto sim = Simulation::create(world(), {}, diagnostics);
  ASSERT_TRUE(sim);
  const std::uint32_t cart = (*sim)->sight().things[1].instance;
  (*sim)->submit(DeleteRequest{"ball1"});
  ASSERT_TRUE((*sim)->tick());
  ASSERT_EQ((*sim)->sight().things.size(), 1u);
  EXPECT_EQ((*sim)->sight().things[0].instance, cart);
  (*sim)->submit(SpawnRequest{test::placed("ball2", test::one_shape("size5", Sphere{0.11}, 0.4), {})});
  ASSERT_TRUE((*sim)->tick());
  const auto& things = (*sim)->sight().things;
  ASSERT_EQ(things.size(), 2u);
  EXPECT_EQ(things[1].label, "size5");
  EXPECT_NE(things[1].instance, cart);
}

TEST(Sight, DrawsTheWorldWithoutChangingTheRun) {
  Diagnostics diagnostics;
  auto seen = Simulation::create(world(), {}, diagnostics),
       plain = Simulation::create(world(), {}, diagnostics);
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
    Sight& sight = (*seen)->sight();
    sight.pictures.render(std::span(&job, 1));
    EXPECT_EQ(instance[0], sight.things[1].instance);  // the cart stands straight ahead
  }
  EXPECT_EQ((*seen)->state_hash(), (*plain)->state_hash());
}

}  // namespace
}  // namespace sandlot
