#include "kinematics/tree.h"

#include <gtest/gtest.h>

#include "base/math.h"

namespace sandlot::kinematics {
namespace {

using model::JointType;
constexpr std::uint32_t none = KinematicTree::none;

/// Links in a row along x, 1 m apart, without joints.
model::Model row_of(std::uint32_t count) {
  model::Model model;
  model.links.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) model.links[i].X_ML.p = {static_cast<double>(i), 0, 0};
  return model;
}

void join(model::Model& model, std::uint32_t parent, std::uint32_t child,
          JointType type = JointType::revolute, Pose X_CJ = {}) {
  model::Joint joint;
  joint.type = type;
  joint.parent = parent;
  joint.child = child;
  joint.X_CJ = X_CJ;
  model.joints.push_back(joint);
}

/// Poses of the links, by link, with link 0 in its declared pose; what moves no joint stays where its parent
/// carries it.
std::vector<Pose> place(const model::Model& model, const KinematicTree& tree,
                        const std::vector<double>& positions) {
  std::vector<Pose> X_ML(model.links.size());
  for (const KinematicTree::Branch& branch : tree.branches) {
    if (branch.parent == none) {
      X_ML[branch.link] = model.links[branch.link].X_ML;
      continue;
    }
    Pose motion;
    if (branch.joint != none) motion = joint_motion(model.joints[branch.joint], positions[branch.joint]);
    X_ML[branch.link] = X_ML[branch.parent] * branch.X_PJ * (branch.outwards ? motion : inverse(motion)) *
                        branch.X_JL;
  }
  return X_ML;
}

void expect_point(Vec3 got, Vec3 want) {
  EXPECT_LT(norm(got - want), 1e-12) << got.x << ' ' << got.y << ' ' << got.z;
}

std::vector<std::uint32_t> parents_of(const KinematicTree& tree) {
  std::vector<std::uint32_t> parents;
  for (const std::uint32_t branch : tree.branch_of) parents.push_back(tree.branches[branch].parent);
  return parents;
}

void expect_parents_first(const KinematicTree& tree) {
  EXPECT_EQ(tree.branches[0].link, 0u);
  for (std::uint32_t b = 0; b < tree.branches.size(); ++b) {
    EXPECT_EQ(tree.branch_of[tree.branches[b].link], b);
    if (tree.branches[b].parent != none) { EXPECT_LT(tree.branch_of[tree.branches[b].parent], b); }
  }
}

TEST(KinematicTree, FollowsJointsBothWaysOrForwardAlone) {
  // 2 -> 0 -> 1, so that the canonical link is the child of a joint, and link 3 on none.
  model::Model model = row_of(4);
  join(model, 2, 0);
  join(model, 0, 1);
  const KinematicTree spanning = spanning_tree(model), forward = forward_tree(model);
  expect_parents_first(spanning);
  expect_parents_first(forward);
  EXPECT_EQ(parents_of(spanning), (std::vector<std::uint32_t>{none, 0, 0, 0}));
  EXPECT_FALSE(spanning.branches[spanning.branch_of[2]].outwards);
  EXPECT_EQ(spanning.branches[spanning.branch_of[2]].joint, 0u);
  EXPECT_EQ(spanning.branches[spanning.branch_of[3]].joint, none);
  EXPECT_EQ(parents_of(forward), (std::vector<std::uint32_t>{none, 0, none, none}));
  EXPECT_EQ(forward.branches[forward.branch_of[1]].joint, 1u);
}

TEST(KinematicTree, PutsParentsFirstWhateverTheOrderOfTheLinks) {
  model::Model model = row_of(5);
  join(model, 4, 1);
  join(model, 3, 4);
  join(model, 0, 3);
  join(model, 1, 2);
  for (const KinematicTree& tree : {spanning_tree(model), forward_tree(model)}) {
    expect_parents_first(tree);
    EXPECT_EQ(parents_of(tree), (std::vector<std::uint32_t>{none, 4, 1, 0, 3}));
  }
}

TEST(KinematicTree, LeavesOutLoopsSecondJointsAndTheWorld) {
  model::Model model = row_of(4);
  join(model, model::world_link, 0);
  join(model, 0, 1);
  join(model, 1, 2);
  join(model, 2, 1);  // a loop of two
  join(model, 2, 3);
  join(model, 0, 3);  // the second joint of link 3
  join(model, 3, 0);  // back to the canonical link
  const KinematicTree forward = forward_tree(model);
  expect_parents_first(forward);
  EXPECT_EQ(parents_of(forward), (std::vector<std::uint32_t>{none, 0, 1, 2}));
  // Breadth first, link 3 is reached from the canonical link first.
  const KinematicTree spanning = spanning_tree(model);
  EXPECT_EQ(parents_of(spanning), (std::vector<std::uint32_t>{none, 0, 1, 0}));
  EXPECT_EQ(spanning.branches[spanning.branch_of[3]].joint, 5u);
  // Two links that carry each other and nothing else: the first joint counts.
  model::Model pair = row_of(3);
  join(pair, 1, 2);
  join(pair, 2, 1);
  EXPECT_EQ(parents_of(forward_tree(pair)), (std::vector<std::uint32_t>{none, none, 1}));
  EXPECT_EQ(parents_of(spanning_tree(pair)), (std::vector<std::uint32_t>{none, 0, 0}));
}

TEST(KinematicTree, PlacesLinksByTheirJoints) {
  // Hinge at x = 1 about z, slide of link 2 along the x of link 1.
  model::Model model = row_of(3);
  join(model, 0, 1);
  join(model, 1, 2, JointType::prismatic, {{-0.3, 0.2, 0}, {}});
  model.joints[1].axis_J = {1, 0, 0};
  const auto at_rest = place(model, forward_tree(model), {0, 0});
  for (std::size_t i = 0; i < 3; ++i) expect_point(at_rest[i].p, model.links[i].X_ML.p);
  const auto moved = place(model, forward_tree(model), {math::pi / 2, 0.5});
  expect_point(moved[1].p, {1, 0, 0});
  expect_point(moved[2].p, {1, 1.5, 0});
  EXPECT_EQ(moved[2].p, place(model, spanning_tree(model), {math::pi / 2, 0.5})[2].p);
}

TEST(KinematicTree, PlacesAParentFromItsChild) {
  // Link 1 carries the canonical link on a hinge about z at (0, 0.5): turned by a right angle, the child
  // stays and the parent, which stood at (1, 0), turns the other way about the hinge: (1, -0.5) off it
  // becomes (-0.5, -1).
  model::Model model = row_of(2);
  join(model, 1, 0, JointType::revolute, {{0, 0.5, 0}, {}});
  const auto moved = place(model, spanning_tree(model), {math::pi / 2});
  expect_point(moved[0].p, {0, 0, 0});
  expect_point(moved[1].p, {-0.5, -0.5, 0});
}

TEST(JointMotion, PositionsComeBack) {
  model::Joint joint;
  joint.axis_J = normalised(Vec3{1, 2, -2});
  for (const double position : {-3.0, -0.5, 0.0, 0.25, 3.1}) {
    for (const JointType type : {JointType::revolute, JointType::prismatic, JointType::screw}) {
      joint.type = type;
      joint.thread_pitch_m = type == JointType::screw ? 0.005 : 0;
      EXPECT_NEAR(joint_position(joint, joint_motion(joint, position)), position, 1e-12);
    }
  }
  // A screw counts whole turns by its slide.
  EXPECT_NEAR(joint_position(joint, joint_motion(joint, 40.0)), 40.0, 1e-9);
  EXPECT_NEAR(norm(joint_motion(joint, math::tau).p), 0.005, 1e-15);
}

}  // namespace
}  // namespace sandlot::kinematics
