#pragma once
/// Parts of the rigid engine: plain structs that hold ODE's handles and Sandlot's own State.
///
/// Frames: W world, M model, L link, B body (origin in the centre of mass), C collision, J joint.
#include <ode/ode.h>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "physics/engine.h"
#include "physics/rigid/rigid_group.h"
#include "physics/rigid/triangles.h"

namespace sandlot::rigid {

struct Instance;
struct Wheel;

/// One ODE body: a link, or several that fixed joints make one.
struct Body {
  Instance* instance = nullptr;
  dBodyID ode = nullptr;
  double mass_kg = 0;
  Symmetric3 inertia_B;
  Pose X_MB;                   ///< in the declared pose
  Vec3 spin_axis_B;            ///< of the joint it spins about as a child; zero: none
  bool weighs_partly = false;  ///< some of its links have no gravity: the weight below is added by hand
  double gravity_mass_kg = 0;
  Vec3 gravity_point_B;
  Body* carrier = nullptr;  ///< of a roller: the wheel it sits in

  // State. ODE holds copies: p, v, w exactly, the orientation only until its next sub-step (see step.cpp).
  Vec3 p;                   ///< [m] centre of mass in W
  Quat q;                   ///< R_WB
  Vec3 v, w;                ///< of the centre of mass, in W
  Vec3 force_N, torque_Nm;  ///< from outside, for the next step
  double quiet_s = 0;       ///< how long it has been slow
  bool awake = true;
  bool frozen = false;  ///< a roller that is part of its wheel: p, q, v and w follow from that
  bool enabled = true;  ///< ODE's flag, not State
  bool quick = false;   ///< its island was solved quickly last time

  // Scratch of one sub-step.
  std::uint32_t island = 0;  ///< node of the union-find
  Vec3 pull_mps;             ///< what gravity and forces add to v
  Pose pose() const { return {p, q}; }
  /// ODE moves it.
  bool active() const { return awake && !frozen; }
};

/// One collision shape.
struct Geom {
  Instance* instance = nullptr;
  Body* body = nullptr;   ///< null: fixed to the world
  dGeomID ode = nullptr;  ///< null for rollers: their wheel stands for them until contacts are sought
  const model::Collision* decl = nullptr;
  std::uint64_t serial = 0;  ///< grows with every shape made: the order of contacts
  BodyId link;
  std::uint32_t number_in_link = 0;
  Pose X_BC;                                   ///< in W where body is null
  std::shared_ptr<const Triangles> triangles;  ///< null for shapes that ODE has itself
  double size_m = 0;                           ///< radius about C's origin; infinite for planes
  Wheel* wheel = nullptr;                      ///< whose outside it is, as one body

  Pose pose() const { return body ? body->pose() * X_BC : X_BC; }
};

/// One link: what the outside calls a body.
struct Link {
  Body* body = nullptr;  ///< null: fixed to the world
  Pose X_BL;             ///< in M where body is null
};

struct Joint {
  const model::Joint* decl = nullptr;
  Body* child = nullptr;          ///< null: fixed to the world
  Body* parent = nullptr;         ///< likewise
  Pose X_child, X_parent;         ///< of J in the two bodies (in M where null) in the declared pose
  dJointID main = nullptr;        ///< hinge, slider ...; null: nothing moves (fixed, or both sides are)
  dJointID motor = nullptr;       ///< of all but a hinge, which has its own; friction of a ball
  dJointID extra = nullptr;       ///< rows for limit, spring with damping, and friction
  dJointID second = nullptr;      ///< the same rows about the second axis of a universal joint
  const Joint* leader = nullptr;  ///< whom it follows (mimic)
  std::unique_ptr<dJointFeedback> feedback;
  /// Feedback of main, motor, extra, second and the rows that live for one sub-step; made when the joint is
  /// watched first.
  std::unique_ptr<std::array<dJointFeedback, 6>> watched_rows;
  bool limited = false;
  bool soft_motor = false;  ///< the motor's row has a compliance of its own now; follows from the target

  // State
  double position = 0;
  double velocity = 0;  ///< follows from the bodies
  JointTarget target;
  double effort = 0;  ///< that the target put in

  // Scratch of one sub-step.
  bool load_watched = false;                              ///< its load, or one that depends on it, is watched
  dJointID thread_row = nullptr, friction_row = nullptr;  ///< rows of the contacts' group
  double pushed = 0;                                      ///< effort that went in as a force, not as a row

  bool is(model::JointType type) const { return decl->type == type; }
  bool is_hinge() const { return is(model::JointType::revolute) || is(model::JointType::continuous); }
  /// Its position is an angle.
  bool turns() const { return is_hinge() || is(model::JointType::universal) || is(model::JointType::screw); }
  bool slides() const { return is(model::JointType::prismatic); }
};

/// One roller of a wheel: see wheels.h.
struct Roller {
  Body* body = nullptr;
  Joint* joint = nullptr;
  Geom* geom = nullptr;  ///< null: it has no shape
  std::uint32_t link = 0;
  Pose X_BR;    ///< its body in the wheel's, at position 0
  Vec3 axis_R;  ///< of its joint
  Vec3 out_B;   ///< unit, from the wheel's axis

  /// Of half its angle, at the position that it was asked for last: most rollers that are frozen stand still.
  struct Turn {
    double position = 0, sin = 0, cos = 1;
  };
  Turn turn;
};

struct Wheel {
  Joint* joint = nullptr;
  Body* body = nullptr;
  const model::RollerWheel* decl = nullptr;
  std::uint32_t link = 0;
  Vec3 centre_B, axis_B;
  std::vector<Roller> rollers;
  model::Collision solid;         ///< its outside as one body
  Barrel probe{};                 ///< a little thicker and as wide as the rollers: what touches it wakes them
  Symmetric3 locked_B;            ///< inertia with all rollers in it
  double spin_inertia = 0;        ///< of a roller about its own axis
  double wake_cos, freeze_cos;    ///< of the angle between a roller and a point that is touched
  double roller_cos, roller_sin;  ///< of the declared angle

  bool on_rollers = false;  ///< State
  bool rolling = false;     ///< some roller is awake

  std::vector<Vec3> touched_B;  ///< scratch of one sub-step: unit, across the axis
};

/// One model in the world. Its vectors never grow after add(), so that Geom, Body and Joint can be pointed
/// to.
struct Instance {
  InstanceId id;
  std::string name;
  std::shared_ptr<const model::Model> model;
  bool is_robot = false;
  Pose X_WM;                 ///< where world-fixed parts stand
  dSpaceID space = nullptr;  ///< of its own when it has several moving shapes
  std::vector<Body> bodies;
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::vector<Geom> geoms;
  std::vector<Wheel> wheels;
  std::vector<BodyId> link_ids;
  std::vector<JointId> joint_ids;
  std::vector<std::pair<const Body*, const Body*>> joined;  ///< by joints: these never collide
  std::size_t own_bodies = 0, own_joints = 0;               ///< what comes behind is rollers
  bool rolling = false;                                     ///< some roller is awake
  double mass_kg = 0;
  bool anchored = false;  ///< some joint holds on to the world
  bool guided = false;    ///< moves along a path: no bodies, but velocity
  // State
  Velocity V_WM;  ///< of a guided one, in the last step or the next
  DriveTarget drive{.active = false};
  std::uint32_t drive_link = 0;

  std::optional<Pose> destination;  ///< of a guided one, after the next step

  /// Those that may be active, in their order: without the rollers where all of them are frozen.
  std::span<Body> movers() { return std::span(bodies).first(rolling ? bodies.size() : own_bodies); }
  std::span<Joint> moved_joints() { return std::span(joints).first(rolling ? joints.size() : own_joints); }

  bool is_moving() const { return V_WM.linear != Vec3{} || V_WM.angular != Vec3{}; }
  Vec3 velocity_at(Vec3 point_W) const { return V_WM.linear + cross(V_WM.angular, point_W - X_WM.p); }

  // Scratch of one sub-step.
  std::uint32_t contact_points = 0, contacts_seen = 0;
  double load_N = 0;
};

/// A grip between two links, by a joint of each sub-step: ODE keeps nothing of it.
struct Held {
  BodyId link_a, link_b;  ///< in the order of creation
  Instance *instance_a = nullptr, *instance_b = nullptr;
  Body *a = nullptr, *b = nullptr;  ///< null: fixed to the world, at most one
  Pose X_AB;                        ///< State. Of a null one the frame is W
  dJointFeedback load{};            ///< of the last sub-step
};

}  // namespace sandlot::rigid
