/// Kinematic chain of the MARIO report, from a model put together by hand.
#include "app/papers/mario.h"

#include <gtest/gtest.h>

#include <numbers>

namespace sandlot::app::mario {
namespace {

TEST(MarioChain, PosesAreOfTheChildInItsParent) {
  model::Model model;
  // base at (1, 0, 0), turned left by 90 degrees; arm at (1, 2, 0) of the model: 2 m ahead of the base, on its x axis.
  model::Link base, arm, eye;
  base.name = "base", arm.name = "arm", eye.name = "eye";
  base.X_ML = pose_from_rpy({1, 0, 0}, {0, 0, std::numbers::pi / 2});
  arm.X_ML = pose_from_rpy({1, 2, 0}, {0, 0, std::numbers::pi / 2});
  eye.X_ML = pose_from_rpy({1, 2, 0.5}, {0, 0, 0});
  model.links = {base, arm, eye};
  model::Joint hinge, bolt, anchor;
  hinge.name = "hinge", hinge.type = model::JointType::revolute, hinge.parent = 0, hinge.child = 1;
  bolt.name = "bolt", bolt.type = model::JointType::fixed, bolt.parent = 1, bolt.child = 2;
  anchor.name = "anchor", anchor.parent = model::world_link, anchor.child = 0;
  model.joints = {anchor, hinge, bolt};
  const std::vector<ChainLink> chain = chain_of(model);
  ASSERT_EQ(chain.size(), 2u);  // the one to the world is left out
  EXPECT_EQ(chain[0].joint, "hinge");
  EXPECT_EQ(chain[0].type, "revolute");
  EXPECT_TRUE(chain[0].moves);
  EXPECT_NEAR(chain[0].X_PC.p.x, 2, 1e-12);
  EXPECT_NEAR(chain[0].X_PC.p.y, 0, 1e-12);
  EXPECT_NEAR(rpy_from_quat(chain[0].X_PC.q).z, 0, 1e-12);
  EXPECT_FALSE(chain[1].moves);
  EXPECT_NEAR(chain[1].X_PC.p.z, 0.5, 1e-12);
  EXPECT_NEAR(rpy_from_quat(chain[1].X_PC.q).z, -std::numbers::pi / 2, 1e-12);

  // base - hinge - arm - bolt - eye: five nodes, each link once.
  const draw::Graph graph = drawing_of(chain);
  ASSERT_EQ(graph.nodes.size(), 5u);
  EXPECT_EQ(draw::layers_of(graph), (std::vector<int>{0, 1, 2, 3, 4}));
  EXPECT_EQ(graph.nodes[0].label, "base");
  EXPECT_EQ(graph.nodes[4].label, "eye");
}

}  // namespace
}  // namespace sandlot::app::mario
