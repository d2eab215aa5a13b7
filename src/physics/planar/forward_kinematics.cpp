#include "physics/planar/forward_kinematics.h"

#include "kinematics/tree.h"
#include "physics/planar/turn.h"

namespace sandlot::planar {
namespace {

/// Displacement of the child link by its joint, in the frame the child has at position 0.
Pose displacement(Vec3 axis, Vec3 point, bool slides, double position) {
  if (slides) return {position * axis, {}};
  const Turn half = turn_of(0.5 * position);
  const Quat q{half.c, half.s * axis.x, half.s * axis.y, half.s * axis.z};
  return {point - rotate(q, point), q};
}

}  // namespace

ForwardKinematics::ForwardKinematics(const model::Model& model) {
  const kinematics::KinematicTree tree = kinematics::spanning_tree(model);
  branches_.reserve(tree.branches.size() - 1);
  for (std::size_t b = 1; b < tree.branches.size(); ++b) {
    const kinematics::KinematicTree::Branch& from = tree.branches[b];
    Branch& branch = branches_.emplace_back();
    branch.link = from.link;
    branch.parent = from.parent;
    branch.X_PL = inverse(model.links[from.parent].X_ML) * model.links[from.link].X_ML;
    if (from.joint == kinematics::KinematicTree::none) continue;
    const model::Joint& joint = model.joints[from.joint];
    if (joint.type == model::JointType::fixed || joint.type == model::JointType::ball) continue;
    branch.joint = from.joint;
    branch.slides = joint.type == model::JointType::prismatic;
    branch.from_child = !from.outwards;
    branch.axis = rotate(joint.X_CJ.q, joint.axis_J);
    branch.point = joint.X_CJ.p;
  }
}

void ForwardKinematics::place(std::span<const BodyId> bodies, std::span<const JointId> joints,
                              std::span<const JointState> joint_states, std::span<BodyState> states) const {
  for (const Branch& branch : branches_) {
    const BodyState& parent = states[bodies[branch.parent].index];
    BodyState& link = states[bodies[branch.link].index];
    const Velocity& V = parent.V_WB;
    if (branch.joint == rigid) {
      link.X_WB = parent.X_WB * branch.X_PL;
      const Vec3 arm = link.X_WB.p - parent.X_WB.p;
      link.V_WB = {V.linear + cross(V.angular, arm), V.angular};
      continue;
    }
    const JointState& joint = joint_states[joints[branch.joint].index];
    const Pose moved = displacement(branch.axis, branch.point, branch.slides, joint.position);
    // X_PL takes the child at 0 to the parent; seen from the child it is the other way round.
    link.X_WB = branch.from_child ? parent.X_WB * inverse(moved) * branch.X_PL
                                  : parent.X_WB * branch.X_PL * moved;
    const BodyState& child = branch.from_child ? parent : link;
    const double rate = branch.from_child ? -joint.velocity : joint.velocity;
    const Vec3 axis_W = rotate(child.X_WB.q, branch.axis);
    const Vec3 arm = link.X_WB.p - parent.X_WB.p;
    link.V_WB = {V.linear + cross(V.angular, arm), V.angular};
    if (branch.slides) {
      link.V_WB.linear += rate * axis_W;
    } else {
      link.V_WB.angular += rate * axis_W;
      link.V_WB.linear += rate * cross(axis_W, link.X_WB.p - child.X_WB * branch.point);
    }
  }
}

}  // namespace sandlot::planar
