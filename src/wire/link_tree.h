#pragma once
/// Which joint carries each link of a model, for those that draw it: every link has at most one, and following parents ends.
///
/// Left out   joints that carry the canonical link (its pose is told anyway), joints to the world (where the world is in a model
///            nobody knows), the second joint of a link, and joints that would close a loop. Their links count as carried by
///            none: their poses are told as they are.
#include <cstdint>
#include <memory>
#include <vector>

#include "model/model.h"

namespace sandlot::wire {

struct LinkTree {
  static constexpr std::uint32_t none = ~0u;
  struct Each {
    std::uint32_t joint = none, parent = none;
    Pose X_PJ;  ///< of the joint in the parent at rest
    Pose X_JC;  ///< of the link in the joint
  };
  std::shared_ptr<const model::Model> model;
  std::vector<Each> links;           ///< as in the model
  std::vector<std::uint32_t> order;  ///< parents before children
};

LinkTree link_tree(std::shared_ptr<const model::Model> model);

/// Motion of a joint's child against rest, in the joint frame, by its position: a turn about, or a slide along, the axis.
/// @pre revolute, continuous, prismatic or screw
Pose joint_motion(const model::Joint& joint, double position);
/// The position whose motion comes nearest. Turns are in -pi to pi, but those of screws that slide.
double joint_position(const model::Joint& joint, const Pose& motion);

}  // namespace sandlot::wire
