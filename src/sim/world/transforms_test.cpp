/// /tf and /tf_static against poses that follow by hand from where things were put.
#include "sim/world/transforms.h"

#include "sim/test_world.h"

namespace sandlot::test {
namespace {

const msg::TransformStamped* find(const msg::TFMessage& message, std::string_view child) {
  const msg::TransformStamped* found = nullptr;
  for (const auto& each : message.transforms) {
    if (each.child_frame_id != child) continue;
    EXPECT_EQ(found, nullptr) << child << " twice";
    found = &each;
  }
  return found;
}

void expect_at(const msg::TFMessage& message, const char* parent, const char* child, Vec3 at,
               double yaw_rad) {
  const msg::TransformStamped* const tf = find(message, child);
  ASSERT_TRUE(tf) << child;
  EXPECT_EQ(tf->header.frame_id, parent);
  EXPECT_LT(norm(tf->transform.translation - at), 1e-12) << child;
  EXPECT_NEAR(yaw_of(tf->transform.rotation), yaw_rad, 1e-12) << child;
}

TEST(Transforms, OfAFrameGoFromTheWorldToTheFirstLinkAndOnToTheOthers) {
  Frame frame;
  frame.now = Time{5};
  FrameInstance rover, wall;
  rover.name = "rover";
  rover.model = rover_model();
  // Its base is turned to the left, the left wheel 0.15 m to the left of it: that is -x in the world.
  const Quat left = quat_from_rpy(0, 0, math::pi / 2);
  rover.X_WL = {{{1, 2, 0.12}, left}, {{0.85, 2, 0.07}, left}, {{1.15, 2, 0.07}, left}};
  wall.name = "wall";
  wall.model = one_shape("wall", Box{{1, 1, 1}}, 0);
  wall.X_WL = {{}};
  frame.instances = {rover, wall};
  msg::TFMessage out;
  out.transforms.resize(7);  // of an earlier frame that had more
  transforms_of(frame, out);
  ASSERT_EQ(out.transforms.size(), 3u) << "what never moves is not part of it";
  expect_at(out, "world", "rover/base_link", {1, 2, 0.12}, math::pi / 2);
  expect_at(out, "rover/base_link", "rover/left_wheel", {0, 0.15, -0.05}, 0);
  expect_at(out, "rover/base_link", "rover/right_wheel", {0, -0.15, -0.05}, 0);
  EXPECT_EQ(out.transforms[0].header.stamp, Time{5});
  frame.instances[0].X_WL.clear();  // links were not asked for
  transforms_of(frame, out);
  EXPECT_TRUE(out.transforms.empty());
}

TEST(Transforms, ThatStayAreThoseOfDevicesAndOfWhatNeverMoves) {
  const auto simulation = build(arena("planar", 1));
  const msg::TFMessage out = static_transforms(*simulation);
  // ground, 4 walls and 2 pillars; drive, laser and truth of the rover
  EXPECT_EQ(out.transforms.size(), 10u);
  expect_at(out, "world", "pillar1/link", {1.5, 1.2, 0.5}, 0);
  expect_at(out, "world", "wall1/link", {4, 0, 0.5}, math::pi / 2);
  expect_at(out, "rover1/base_link", "rover1/laser", {0, 0, 0.12}, 0);
  EXPECT_EQ(find(out, "rover1/base_link"), nullptr);
  // Put elsewhere by hand: the next telling says so, and the revision says that there is something to tell.
  const std::uint64_t revision = simulation->revision();
  simulation->submit(PoseRequest{"pillar1", {{0.5, 0.25, 0.5}, {}}});
  ASSERT_TRUE(simulation->tick());
  EXPECT_GT(simulation->revision(), revision);
  expect_at(static_transforms(*simulation), "world", "pillar1/link", {0.5, 0.25, 0.5}, 0);
}

}  // namespace
}  // namespace sandlot::test
