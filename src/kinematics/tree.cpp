#include "kinematics/tree.h"

#include <cmath>

#include "base/math.h"

namespace sandlot::kinematics {
namespace {

using model::JointType;
constexpr std::uint32_t none = KinematicTree::none;

void append(KinematicTree& tree, const model::Model& model, std::uint32_t link, std::uint32_t parent,
            std::uint32_t joint, bool outwards) {
  tree.branch_of[link] = static_cast<std::uint32_t>(tree.branches.size());
  KinematicTree::Branch& branch = tree.branches.emplace_back();
  branch = {.link = link, .parent = parent, .joint = joint, .outwards = outwards};
  if (parent == none) return;
  branch.X_PJ = inverse(model.links[parent].X_ML) * model.links[link].X_ML;
  if (joint == none) return;
  const Pose& X_CJ = model.joints[joint].X_CJ;
  if (outwards) {
    branch.X_PJ = branch.X_PJ * X_CJ;
    branch.X_JL = inverse(X_CJ);
  } else {
    branch.X_JL = inverse(X_CJ) * branch.X_PJ;
    branch.X_PJ = X_CJ;
  }
}

}  // namespace

KinematicTree spanning_tree(const model::Model& model) {
  KinematicTree tree;
  const std::size_t count = model.links.size();
  tree.branches.reserve(count);
  tree.branch_of.assign(count, none);
  append(tree, model, 0, none, none, true);
  for (std::size_t next = 0; next < tree.branches.size(); ++next) {
    const std::uint32_t from = tree.branches[next].link;
    for (std::uint32_t j = 0; j < model.joints.size(); ++j) {
      const model::Joint& joint = model.joints[j];
      const bool outwards = joint.parent == from;
      const std::uint32_t to = outwards ? joint.child : joint.parent;
      if ((!outwards && joint.child != from) || to >= count || tree.branch_of[to] != none) continue;
      append(tree, model, to, from, j, outwards);
    }
  }
  for (std::uint32_t link = 0; link < count; ++link)
    if (tree.branch_of[link] == none) append(tree, model, link, 0, none, true);
  return tree;
}

KinematicTree forward_tree(const model::Model& model) {
  const std::size_t count = model.links.size();
  std::vector<std::uint32_t> parent(count, none), joint_of(count, none);
  for (std::uint32_t j = 0; j < model.joints.size(); ++j) {
    const model::Joint& joint = model.joints[j];
    if (joint.child == 0 || joint.child >= count || joint.parent >= count || joint_of[joint.child] != none)
      continue;
    std::uint32_t ancestor = joint.parent;
    while (ancestor != none && ancestor != joint.child) ancestor = parent[ancestor];
    if (ancestor == joint.child) continue;  // a loop
    joint_of[joint.child] = j;
    parent[joint.child] = joint.parent;
  }
  KinematicTree tree;
  tree.branches.reserve(count);
  tree.branch_of.assign(count, none);
  // At most as many rounds as the tree is deep: models have few links, and this is done once for each.
  while (tree.branches.size() < count)
    for (std::uint32_t link = 0; link < count; ++link)
      if (tree.branch_of[link] == none && (parent[link] == none || tree.branch_of[parent[link]] != none))
        append(tree, model, link, parent[link], joint_of[link], true);
  return tree;
}

Pose joint_motion(const model::Joint& joint, double position) {
  switch (joint.type) {
    case JointType::prismatic: return {position * joint.axis_J, {}};
    case JointType::screw:
      return {position / (2 * math::pi) * joint.thread_pitch_m * joint.axis_J,
              quat_from_axis_angle(joint.axis_J, position)};
    default: return {{}, quat_from_axis_angle(joint.axis_J, position)};
  }
}

double joint_position(const model::Joint& joint, const Pose& motion) {
  const double slide = dot(motion.p, joint.axis_J);
  if (joint.type == JointType::prismatic) return slide;
  const Vec3 imaginary{motion.q.x, motion.q.y, motion.q.z};
  const double turn = math::wrap_angle(2 * math::atan2(dot(imaginary, joint.axis_J), motion.q.w));
  if (joint.type != JointType::screw || joint.thread_pitch_m == 0) return turn;
  // The slide gives the number of whole turns, the orientation the rest.
  return turn + 2 * math::pi * std::round(slide / joint.thread_pitch_m - turn / (2 * math::pi));
}

}  // namespace sandlot::kinematics
