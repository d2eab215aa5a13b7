#pragma once
/// Bodies of the planar engine, their constraints and drives: state and scratch shared by the engine's
/// sources.
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "physics/engine.h"
#include "physics/planar/drive.h"
#include "physics/planar/forward_kinematics.h"
#include "physics/planar/map.h"
#include "physics/planar/plan.h"

namespace sandlot::planar {

constexpr std::uint32_t none = ~0u;

constexpr double cross(Vec2 a, Vec2 b) { return a.x * b.y - a.y * b.x; }
constexpr Vec2 left_of(Vec2 a) { return {-a.y, a.x}; }

/// Rigid group: links that move as one, about their centre of mass.
struct alignas(64) RigidGroup {
  Vec2 p;  ///< centre of mass
  Turn heading;
  Vec2 v;  ///< of p
  double w_radps = 0;
  double inverse_kg = 0, inverse_kgm2 = 0;  ///< 0: on a path of its own
  const RigidGroupPlan* plan = nullptr;     ///< the instance's
  std::uint32_t slot = none;                ///< of its instance; none: there is no such group
  std::uint32_t index = 0;                  ///< in the instance's plan
  std::uint32_t silhouette = none;          ///< none: a circle
  /// A ball on the ground: what pushes it turns it, too, so that inverse_kg is that of m + I / r^2.
  bool rolls = false;
  double reach_m = 0;  ///< how far it may come in this step
  Vec2 force_N;        ///< of wrenches, consumed by the next step
  double torque_Nm = 0;

  Vec2 velocity_at(Vec2 arm) const { return v + w_radps * left_of(arm); }
  void push(Vec2 impulse, Vec2 arm) {
    v = v + inverse_kg * impulse;
    w_radps += inverse_kgm2 * cross(arm, impulse);
  }
};

/// Friction of the ground on a group that slides or rolls; fixed until the group stands elsewhere.
struct GroundFriction {
  double force_N = 0;    ///< largest, of a patch that slides along `along` without turning
  double side_N = 0;     ///< and across
  double torque_Nm = 0;  ///< largest, of one that turns about the centre of mass
  Vec2 along{1, 0};      ///< unit
  Vec2 belt_mps;         ///< velocity of the ground below
  Vec2 impulse;          ///< in this step
  double twist = 0;
};

/// A wheel on the ground, or a caster: a wheel that is locked and has no axle.
struct Wheel {
  const WheelPlan* plan = nullptr;  ///< null: a caster
  std::uint32_t group = none, joint = none, steering = none;
  Vec2 at;                ///< in the group's frame
  double limit_N = 0;     ///< largest friction
  double rolling_Nm = 0;  ///< resistance against rolling
  Vec2 belt_mps;          ///< velocity of the ground below
  Vec2 impulse;           ///< ahead and along the axle; with rollers: x along the grip
  struct Axle {
    double slope = 0;  ///< inertia and damping over the step: angular impulse = slope * spin - start
    double start = 0;  ///< of inertia and effort
    double wanted_radps = 0, motor = 0, friction = 0;  ///< angular impulses at most
    double thrust = 0;                                 ///< what the velocity motor gave
  };
  /// This step's:
  struct Now {
    Vec2 ahead, across, arm;  ///< the directions it holds, and where; with rollers the first alone
    double roll_m = 0;        ///< velocity along `ahead` that a spin of 1 rad/s makes up for
    double k_aa = 0, k_ac = 0, k_cc = 0;  ///< what the group's velocity there gains per impulse
    Axle axle;
  };
  std::unique_ptr<Now> now;  ///< made when it first drives: in a swarm on rails nobody's
};

/// Joint constraint: a pivot or slider between two groups of an instance, or a grip between two instances.
struct JointConstraint {
  const JointPlan* plan = nullptr;  ///< null: a grip
  std::uint32_t a = none, b = none, joint = none;
  Vec2 at_a, at_b;  ///< the anchor in both frames
  Vec2 axis_a;      ///< of a slider, in the frame of a
  Turn apart;       ///< heading of b in a at joint position 0
  Vec2 hold;        ///< impulse at the anchor; of a slider x is across
  double turn = 0;  ///< angular impulse of a slider or grip
  double motor = 0, friction = 0, spring = 0, limit = 0;
  BodyId body_a, body_b;  ///< of a grip
  // This step's:
  Vec2 arm_a, arm_b, axis;
  double rate_before = 0;
};

/// Largest friction per normal force along a unit vector across the normal: the radius of an ellipse.
double friction_along(const PairSurface& pair, Vec3 normal, Vec3 way);

/// One side of a contact, as needed by the law of surfaces and the user's rule.
struct ContactFace {
  const model::Surface* surface = nullptr;
  const model::Collision* collision = nullptr;  ///< null: the rule is not called
  std::uint32_t slot = none, link = 0;
  const RigidGroup* group = nullptr;  ///< null: it stands still
};

/// Contact key: the order of contacts, and their identity from step to step.
struct ContactKey {
  std::uint64_t pair = 0;                ///< creation of both instances, the older first
  std::uint32_t groups = 0;              ///< of the older << 16 | of the younger
  std::uint32_t part_a = 0, part_b = 0;  ///< of a wall: which of its instance's
  std::uint32_t feature = 0;
  friend constexpr bool operator==(const ContactKey&, const ContactKey&) = default;
  friend constexpr bool operator<(const ContactKey& a, const ContactKey& b) {
    return std::tie(a.pair, a.groups, a.part_a, a.part_b, a.feature) <
           std::tie(b.pair, b.groups, b.part_a, b.part_b, b.feature);
  }
};

/// Candidate of the narrow phase: two groups, or a group and a wall.
struct Candidate {
  ContactKey key;
  std::uint32_t a = none, b = none;  ///< groups, of the older and the younger; none: the wall
  std::uint32_t wall = none;
};

/// Point of a contact manifold, with the impulses of its constraint.
struct ContactPoint {
  ContactKey key;
  std::uint32_t a = none, b = none;  ///< groups; none: a wall
  Vec2 normal;                       ///< from a to b
  Vec2 at;
  Vec2 arm_a, arm_b;
  Turn heading_a, heading_b;  ///< when it was found
  double gap_m = 0;
  double normal_kg = 0, tangent_kg = 0;
  /// Impulse of a blow, by that of bodies which take up spin while they touch: a ball that is hit slides first.
  double blow = 1;
  double bias_mps = 0;  ///< the least velocity along the normal
  double normal_Ns = 0, tangent_Ns = 0, bounce_Ns = 0, bounce_tangent_Ns = 0;
  double mu = 0, restitution = 0, threshold_mps = 0, belt_mps = 0;
  std::uint32_t body_a = none, body_b = none, shape_a = none, shape_b = none;
  double z_m = 0;
};

/// Motion of a driven group without contacts.
struct Planned {
  Vec2 v;  ///< mean over the step, of the centre of mass
  double w_radps = 0;
  Vec2 p;  ///< where the step began
  Turn heading;
};

struct alignas(64) Drive {
  std::uint32_t active = 0;
  std::uint32_t link = 0;  ///< of the instance's model: whose frame the velocities are in
  Twist now, target;
  double accel = 0, angular_accel = 0;
  Vec2 arm;    ///< of that link's origin from the centre of mass, in its frame
  Turn frame;  ///< of its x axis there
  /// Integrals of the true velocity of the centre of mass and of the turning rate, in the group's frame, over
  /// all steps in which the drive was active.
  Vec2 way_m;
  double turned_rad = 0;
};

/// A wheel that turns as its base moves: its position is `offset` and so much for each part of the drive's
/// integrals. So it takes no step to turn it, and it does not matter how often it is looked at.
struct Roll {
  RollTarget target;
  std::uint32_t slot = none;
  Vec2 per_way;  ///< the target's factors for the centre of mass in the group's frame
  double per_turn = 0;
  double offset = 0;
};

struct Motor {
  std::uint32_t generation = 0;
  JointTarget target;
  const model::Joint* joint = nullptr;  ///< null: there is none
  /// Kinematic joints, and the wheels of a robot that runs on rails, follow their targets exactly.
  enum class Role : std::uint8_t { kinematic, wheel, constraint } role = Role::kinematic;
  bool listed = false;  ///< among those that are moved so
  std::uint32_t slot = none;
  std::uint32_t roll = none;  ///< among those that turn as their base moves

  bool bounded() const {
    return joint->type == model::JointType::revolute || joint->type == model::JointType::prismatic;
  }
  double lower() const { return bounded() ? joint->lower : -std::numeric_limits<double>::infinity(); }
  double upper() const { return bounded() ? joint->upper : std::numeric_limits<double>::infinity(); }
  double max_velocity() const {
    return joint->type == model::JointType::fixed || joint->type == model::JointType::ball
               ? 0
               : joint->max_velocity;
  }
};

/// Summary of an instance for the loops that every step runs over all of them.
struct InstanceSummary {
  std::uint32_t group = none;  ///< its only one; none: it has several, or none at all
  bool moves = false, guided = false;
};

/// Instance: data that changes rarely or is read rarely.
struct Instance {
  bool alive = false, moves = false;
  bool guided = false;  ///< moves along a path
  std::uint32_t generation = 0;
  std::uint64_t created = 0;  ///< counts up: the order in which contacts are solved
  std::string name;
  std::shared_ptr<const model::Model> model;
  std::shared_ptr<const ForwardKinematics> kinematics;
  std::shared_ptr<const Plan> plan;
  std::vector<BodyId> bodies;
  std::vector<JointId> joints;
  std::vector<std::uint32_t> groups;
  std::vector<Wheel> wheels;
  std::vector<JointConstraint> constraints;
  Quat tilt;       ///< attitude of the canonical link at heading 0
  double z_m = 0;  ///< its height
  /// Canonical link of an instance that stands still.
  struct Still {
    Vec2 at;
    Quat q;
  };
  std::unique_ptr<Still> still;
  std::unique_ptr<std::pair<Pose, Velocity>> destination;  ///< of a guided one, after the next step
};

}  // namespace sandlot::planar
