#include "wire/link_tree.h"

#include "base/check.h"
#include "base/math.h"

namespace sandlot::wire {
namespace {

using model::JointType;

double turn_about(const Pose& motion, Vec3 axis) {
  return math::wrap_angle(2 * math::atan2(dot({motion.q.x, motion.q.y, motion.q.z}, axis), motion.q.w));
}

}  // namespace

LinkTree link_tree(std::shared_ptr<const model::Model> model) {
  LinkTree tree;
  const std::size_t count = model->links.size();
  tree.links.resize(count);
  for (std::uint32_t j = 0; j < model->joints.size(); ++j) {
    const model::Joint& joint = model->joints[j];
    if (joint.child == 0 || joint.child >= count || joint.parent >= count) continue;
    LinkTree::Each& link = tree.links[joint.child];
    if (link.joint != LinkTree::none) continue;
    std::uint32_t above = joint.parent;
    while (above != LinkTree::none && above != joint.child) above = tree.links[above].parent;
    if (above == joint.child) continue;  // a loop
    link.joint = j;
    link.parent = joint.parent;
    link.X_PJ = inverse(model->links[joint.parent].X_ML) * model->links[joint.child].X_ML * joint.X_CJ;
    link.X_JC = inverse(joint.X_CJ);
  }
  // As often as the tree is deep, at most: models have few links, and this is done once for each.
  std::vector<bool> placed(count);
  while (tree.order.size() < count)
    for (std::uint32_t i = 0; i < count; ++i)
      if (!placed[i] && (tree.links[i].parent == LinkTree::none || placed[tree.links[i].parent])) {
        placed[i] = true;
        tree.order.push_back(i);
      }
  tree.model = std::move(model);
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
  const double turn = turn_about(motion, joint.axis_J);
  if (joint.type != JointType::screw || joint.thread_pitch_m == 0) return turn;
  // The slide tells how many whole turns there were, the orientation the rest.
  return turn + 2 * math::pi * std::round(slide / joint.thread_pitch_m - turn / (2 * math::pi));
}

}  // namespace sandlot::wire
