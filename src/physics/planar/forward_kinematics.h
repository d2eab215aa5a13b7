#pragma once
/// Forward kinematics of an instance: poses and velocities of its links from those of the canonical link and
/// its joints.
///
/// Limits   joints are kinematic; a ball joint holds its declared pose. Links that no joint connects ride on
///          the canonical link. Of a loop of joints one is left out (kinematics/tree.h).
#include <cstdint>
#include <span>
#include <vector>

#include "model/model.h"
#include "physics/engine.h"

namespace sandlot::planar {

class ForwardKinematics {
 public:
  explicit ForwardKinematics(const model::Model& model);

  /// Fills the states of all links but the first from that of the first. Indices of spans are the model's.
  /// @param joints  ids of the model's joints, into `joint_states`
  void place(std::span<const BodyId> bodies, std::span<const JointId> joints,
             std::span<const JointState> joint_states, std::span<BodyState> states) const;

 private:
  static constexpr std::uint32_t rigid = ~0u;
  struct Branch {
    std::uint32_t link, parent;   ///< of the model; parents come first
    std::uint32_t joint = rigid;  ///< index in the model
    bool slides = false;          ///< prismatic
    bool from_child = false;      ///< the joint's child is nearer to the root than its parent
    Pose X_PL;                    ///< at joint position 0
    Vec3 axis, point;             ///< unit vector and a point on it in the joint's child link
  };
  std::vector<Branch> branches_;
};

}  // namespace sandlot::planar
