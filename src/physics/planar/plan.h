#pragma once
/// Plan of a model for the planar engine, at a height and tilt: rigid groups with outlines, wheels, joints
/// and supports.
///
/// Frame H   heading frame: origin on the canonical link's x and y, z of the world, turned by the instance's
///           heading. All joints are at 0. The frame of a group has its origin in the group's centre of mass
///           and the axes of H.
/// Groups     links that move as one in the plane. Joints that separate them: vertical revolute and
///            continuous ones
///           (pivots) and horizontal prismatic ones (sliders). Whatever hangs on another joint belongs to its
///           parent.
/// Outlines  those of outline.h; of a mesh its convex hull. A shape above and below a circle that hides it
///           from above is merged into the circle when it begins no lower below it than the circle's shape is
///           thick, and ends no higher above it than twice that: a robot's wheels, casters and mast. So most
///           robots are one circle.
/// Wheels    links on a horizontal axle whose sphere, cylinder or capsule lies on it and reaches the ground.
///           A vertical joint that carries nothing but a wheel and its fork steers it.
/// Weight    shared among the supports (wheels, and shapes that reach the ground) by equilibrium of force and
///           moments at rest, with the smallest sum of squares; none pulls.
/// Limits    moving arms shift neither outline nor weight; accelerating does not shift weight.
#include <memory>
#include <vector>

#include "model/model.h"
#include "physics/planar/outline.h"

namespace sandlot::planar {

/// True where friction is the same in all directions and nothing moves but the body.
inline bool is_plain(const model::Surface& s) {
  return s.fdir1 == Vec3{} && !s.skin && s.belt_velocity_mps == Vec3{};
}

/// A part of a group's outline, in the group's frame.
struct Part {
  Outline outline;
  std::uint32_t link = 0;
  std::uint32_t collision = ~0u;  ///< of the link; ~0u: several were merged
  const model::Surface* surface = nullptr;
};

/// A point or patch that carries weight.
struct Support {
  Vec2 at;                     ///< in the group's frame
  double weight_kg = 0;        ///< that it carries
  double mean_radius_m = 0;    ///< of the patch, about its middle
  double ball_radius_m = 0;    ///< > 0: a sphere
  double mean_distance_m = 0;  ///< of the patch from the group's centre of mass
  const model::Surface* surface = nullptr;
  const model::Collision* collision = nullptr;
  std::uint32_t link = 0;
};

struct RigidGroupPlan {
  std::vector<Part> parts;
  std::vector<Edge> edges;
  Vec2 centre;          ///< of the circle around all parts, in the group's frame
  double radius_m = 0;  ///< its radius; 0: nothing to meet
  /// Radius of the smallest part's inscribed circle, which a step must not pass over.
  double core_m = 0;
  /// Largest way in a step in addition to twice its speed; a group without a shape meets nothing.
  double reach_share_m = 1e9;
  Heights heights;
  bool disc = false;  ///< that circle is all there is
  Vec2 com_H;
  double mass_kg = 0, inertia_kgm2 = 0;
  std::uint32_t root = 0;         ///< its link nearest to the canonical one
  std::vector<Support> supports;  ///< other than wheels
  bool rolls = false;             ///< stands on one ball and nothing else
  /// I / (m r^2) of a group that rolls. A ball's I is the same about all axes, so that about the vertical will do.
  double spin() const {
    const double r = supports[0].ball_radius_m;
    return inertia_kgm2 / (mass_kg * r * r);
  }
};

struct WheelPlan {
  std::uint32_t joint = 0, group = 0;
  std::uint32_t steering = model::Joint::no_joint;
  Vec2 at;           ///< of the contact with the ground, in the group's frame; steered: at steering angle 0
  Vec2 steering_at;  ///< where the steering axis stands
  Vec2 axle;         ///< unit, the axis about which positive turns are counted
  double steering_sign = 1;  ///< of the steering joint's axis along z
  double steering_kgm2 = 0;  ///< what it turns
  double radius_m = 0, inertia_kgm2 = 0, weight_kg = 0;
  bool rollers = false;
  Vec2 grip;  ///< of a wheel with rollers: the only direction it holds, along the roller on the ground
  const model::Surface* surface = nullptr;
  const model::Collision* collision = nullptr;  ///< null: rollers
  double bearing_Nm = 0;                        ///< of the rollers
};

/// A joint between groups, or one that steers.
struct JointPlan {
  enum class Kind : std::uint8_t { pivot, slider, steering } kind = Kind::pivot;
  std::uint32_t joint = 0;
  std::uint32_t parent = 0, child = 0;  ///< groups
  Vec2 at_H;                            ///< a point of the axis
  Vec2 axis;                            ///< of a slider, unit
  double sign = 1;          ///< of the joint's position in the plane: child counter-clockwise, or along axis
  double inertia_kgm2 = 0;  ///< of what a steering joint turns
};

struct Plan {
  std::vector<RigidGroupPlan> groups;  ///< [0] holds the canonical link
  std::vector<std::uint32_t> group_of_link;
  std::vector<WheelPlan> wheels;
  std::vector<JointPlan> constraints;
  std::vector<Pose> X_HL;  ///< of the links at joint positions 0
  double bottom_m = 0;     ///< lowest point of all shapes
  bool plain = true;       ///< all that stands on the ground is so
};

/// @param tilt, z_m  of the canonical link at heading 0
Plan make_plan(const model::Model& model, Quat tilt, double z_m);

/// Shares `weight_kg` among points so that its moments about the origin vanish: the least sum of squares
/// without pull. Where that cannot be (the origin lies outside), what comes nearest.
void share_weight(double weight_kg, std::span<const Vec2> points, std::span<double> shares);

}  // namespace sandlot::planar
