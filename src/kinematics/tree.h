#pragma once
/// Kinematic tree of a model: which joint connects each link to which other one, in an order with parents
/// first.
///
/// Frames    P, L: parent and link of a branch. J: the joint frame of model.h, fixed in the joint's child.
/// Pose      X_WL = X_WP * X_PJ * motion * X_JL with motion = joint_motion(joint, position); of a branch that
///           leads from a joint's child to its parent, the inverse of that.
/// Limits    a tree has one joint per link: of joints that form a loop, the last one is left out. Joints to
///           the world are left out too: where the world is depends on the instance.
/// Cost      once per model; proportional to links times joints.
#include <cstdint>
#include <vector>

#include "model/model.h"

namespace sandlot::kinematics {

struct KinematicTree {
  static constexpr std::uint32_t none = ~0u;
  struct Branch {
    std::uint32_t link = 0;
    std::uint32_t parent = none;  ///< link; none: a root
    /// None: a root, or a link that no joint connects and that its parent carries.
    std::uint32_t joint = none;
    bool outwards = true;  ///< from the joint's parent to its child
    Pose X_PJ, X_JL;       ///< with all joints at position 0; identity at roots
  };
  std::vector<Branch> branches;          ///< parents precede children; [0] is the canonical link
  std::vector<std::uint32_t> branch_of;  ///< by link
};

/// Tree with the canonical link as its only root: joints are followed both ways, breadth first in the order
/// of the model. Links that no joint connects to it are children of the canonical link, without a joint.
KinematicTree spanning_tree(const model::Model& model);

/// Tree in which a link's parent is the parent of its joint: the first joint whose child it is and that
/// closes no loop. The canonical link and links that are the child of no joint are roots.
KinematicTree forward_tree(const model::Model& model);

/// Motion of a joint's child against rest, in J: a turn about, or a slide along, the axis.
/// @param position  [rad] or [m]
/// @pre revolute, continuous, prismatic or screw
Pose joint_motion(const model::Joint& joint, double position);

/// Position whose motion comes nearest. Turns are in -pi to pi, except those of screws with a pitch.
double joint_position(const model::Joint& joint, const Pose& motion);

}  // namespace sandlot::kinematics
