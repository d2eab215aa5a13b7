#pragma once
/// The border to physics: batched, one call for all bodies, the same for the 3D and the planar engine.
///
/// A "body" here is a link of an instance: an engine may join links that are fixed to each other, but every
/// link has a BodyId and a BodyState. Ids are index + generation: an index is used again after a removal, an
/// id never. A call takes effect in the next step(); apply() and the targets it was given are consumed as
/// described there.
///
/// Determinism: the result of step() depends on State and inputs alone, never on addresses, thread timing or
/// on instances that touch nothing (each island of touching bodies is solved as if it were alone). Processing
/// order is creation order.
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "base/describe.h"
#include "base/result.h"
#include "geometry/pose.h"
#include "geometry/rays.h"
#include "model/model.h"
#include "physics/contact_rule.h"

namespace sandlot {

struct BodyId {
  std::uint32_t index = ~0u, generation = 0;
  friend constexpr bool operator==(BodyId, BodyId) = default;
};
struct JointId {
  std::uint32_t index = ~0u, generation = 0;
  friend constexpr bool operator==(JointId, JointId) = default;
};
struct InstanceId {
  std::uint32_t index = ~0u, generation = 0;
  friend constexpr bool operator==(InstanceId, InstanceId) = default;
};

struct BodyState {
  Pose X_WB;      ///< frame of the link (not its centre of mass)
  Velocity V_WB;  ///< of the link's origin, in W
};

struct JointState {
  double position = 0;  ///< [rad] or [m]; unwrapped: a wheel keeps counting turns
  double velocity = 0;  ///< [rad/s] or [m/s]
  double effort = 0;    ///< [Nm] or [N] that the last JointTarget put in
};

/// Force at the centre of mass plus torque, in W, for the next step only.
struct Wrench {
  BodyId body;
  Vec3 force_N;
  Vec3 torque_Nm;
};

/// Target of a joint's motor; holds until the next target for this joint.
///
/// A motor (mode effort) may be given its own properties in addition to its effort. All of it acts
/// implicitly, on the velocity that the sub-step ends with, so it is stable whatever its size and that of the
/// load:
///
///   effort - damping * v - inertia * dv/dt, and Coulomb friction of at most `friction`
struct JointTarget {
  enum class Mode : std::uint8_t {
    free,      ///< no motor
    velocity,  ///< reach `velocity` with at most `max_effort`
    effort,    ///< apply `effort`
  };
  JointId joint;
  Mode mode = Mode::free;
  double velocity = 0;
  double max_effort = 0;
  double effort = 0;
  double damping = 0;   ///< [Nm s/rad] or [N s/m], >= 0
  double inertia = 0;   ///< [kg m^2] or [kg], >= 0: of a rotor, seen from the joint
  double friction = 0;  ///< [Nm] or [N], >= 0
};

/// Closed-form drive of a whole instance (level `ideal`): its base moves at a velocity in its own plane as if
/// it ran on rails, reached with limited acceleration; while it holds, the instance's contacts have no
/// friction. Obstacles still stop it: the push is limited to mass * max_accel. Holds until the next target
/// for this base.
struct DriveTarget {
  BodyId base;
  bool active = true;                           ///< false: release the instance to its own wheels
  double vx_mps = 0, vy_mps = 0, wz_radps = 0;  ///< in the base frame
  double max_accel_mps2 = 1e9, max_angular_accel_radps2 = 1e9;
};

/// A wheel of an ideally driven base that turns as if it rolled: by the integral of what the base's true
/// velocity, in its own frame, makes of it. Holds while the drive does, until the next target of either sort
/// for this joint.
struct RollTarget {
  JointId wheel;
  BodyId base;
  /// [rad/m], [rad/m], [1]: wheel speed per velocity of the base's origin.
  double per_vx = 0, per_vy = 0, per_wz = 0;
};

/// Whether a wheel with rollers (model::RollerWheel) runs on its rollers, each a body of its own, or as one
/// body whose contact grips along the axis of the roller on the ground alone. The second is how it begins.
/// Holds until the next target for this wheel. A change keeps velocities.
struct WheelTarget {
  JointId wheel;
  bool rollers = false;
};

/// Holds two bodies together as they stand to each other now, or lets go again: a gripper. Both may belong to
/// any instance; what stands still counts as the world, and two of those cannot hold each other. Who holds
/// each other does not collide. Removing one or setting its pose lets go. Holds until the next target for
/// this pair.
struct GripTarget {
  BodyId a, b;
  bool hold = true;
};

/// A grip that holds.
struct Grip {
  BodyId a, b;   ///< of the older instance and the younger; of one instance, in the order of its links
  Vec3 force_N;  ///< on b through the grip, in W, mean over the last step; zero before the first
};

struct Contact {
  BodyId a, b;    ///< a created before b; a world-fixed body where the other side is static
  Vec3 point_W;   ///< [m]
  Vec3 normal_W;  ///< unit, from a towards b
  double depth_m = 0;
  Vec3 force_W;  ///< [N] on b, mean over the sub-step, friction included; zero unless somebody watched a or b
  /// Which collision of its link it was; no_shape: the engine has merged the shapes of a body.
  std::uint32_t shape_a = no_shape, shape_b = no_shape;
  static constexpr std::uint32_t no_shape = ~0u;
};

/// Body behind a BodyId. Valid as long as its instance is.
struct BodyName {
  std::string_view instance;
  const model::Link* link = nullptr;  ///< null: there is no such body
  bool moves = false;                 ///< forces move it
};

/// Load of a joint: force and torque of the parent on the child, at the joint's origin, mean over the
/// sub-step; the motor's part is in it. Along the axes of the joint frame J as the child carries it.
struct JointLoad {
  Vec3 force_N, torque_Nm;
};

/// Contacts and joints whose forces the next step shall report; consumed by it.
struct Watch {
  std::vector<BodyId> contacts;  ///< all contacts of these bodies
  std::vector<JointId> loads;
  bool empty() const { return contacts.empty() && loads.empty(); }
  void clear() {
    contacts.clear();
    loads.clear();
  }
};

/// Bodies in a ball: the cheap query behind proximity, spawning and markers.
struct OverlapQuery {
  Vec3 centre_W;
  double radius_m = 0;
};

struct Capabilities {
  const char* name;
  bool planar = false;          ///< poses have three degrees of freedom
  bool joints = false;          ///< joints are simulated (else: kinematic)
  bool contact_drives = false;  ///< wheels drive by contact and friction
  bool ideal_drives = false;
  bool rays = false;            ///< rays() answers
  bool contact_forces = false;  ///< Contact::force_W is reported
  bool joint_loads = false;     ///< joint_loads() answers
  bool rollers = false;         ///< wheels can run on their rollers
  bool grips = false;           ///< set_grips() works
  bool rolls = false;  ///< set_rolls() works; else a drive turns the wheels of the level ideal itself
};

/// Counted since the engine was made; reported in the summary.
struct EngineCounters {
  std::uint64_t solver_messages = 0;  ///< complaints of the library below
  std::uint64_t library_allocations = 0;
  std::uint64_t contacts = 0;  ///< in the last step
  std::uint64_t awake_bodies = 0;
};

class Engine {
 public:
  virtual ~Engine() = default;
  virtual Capabilities capabilities() const = 0;

  /// Adds all links and joints of a model at instance.X_WM. One with a motion is moved by guide() alone: its
  /// joints hold, and nothing pushes it. An error names what this engine cannot express.
  virtual Result<InstanceId> add(const model::Instance& instance) = 0;
  /// Removes an instance and wakes what rested on it. @pre id is alive
  virtual void remove(InstanceId id) = 0;
  /// One per link, and one per joint, of the instance's model, in the model's order.
  virtual std::span<const BodyId> bodies(InstanceId id) const = 0;
  virtual std::span<const JointId> joints(InstanceId id) const = 0;
  /// Moves a whole instance to a pose, at rest, its joints as they are; wakes it and what rested on it.
  virtual void set_pose(InstanceId id, const Pose& X_WM) = 0;
  /// Gives the canonical link, at its origin, a velocity in W. The instance gets it as a whole: the velocities of its joints
  /// stay. What stands still, or follows a motion, keeps its own; a drive goes on from there, as its limits allow.
  virtual void set_velocity(InstanceId id, const Velocity& V_WB) = 0;
  /// Pose of an instance with a motion: it stands at X_WM after the next step and moves with V_WM (of the
  /// model frame's origin) during it, whatever is in its way; contacts feel that velocity. Without a call it
  /// stands still.
  /// @pre it was added with a motion
  virtual void guide(InstanceId id, const Pose& X_WM, const Velocity& V_WM) = 0;
  /// The instance is a robot from now on, as if it had been added as one: it does not sleep.
  virtual void become_robot(InstanceId) {}
  virtual BodyName name(BodyId) const { return {}; }
  /// The body that has this index now; its name is empty when there is none.
  virtual BodyId body_at(std::uint32_t index) const { return {index, 0}; }
  /// Pose of the model frame, from the canonical link.
  virtual Pose pose(InstanceId id) const = 0;

  /// Indexed by BodyId::index; entries of dead ids hold rubbish. Valid until the next non-const call.
  virtual std::span<const BodyState> states() const = 0;
  /// The same of some bodies alone, by their indices: an engine that does not keep the states of all saves
  /// the rest.
  /// @pre they live; `out` is as long as `bodies`
  virtual void states_of(std::span<const std::uint32_t> bodies, std::span<BodyState> out) const {
    const auto all = states();
    for (std::size_t i = 0; i < bodies.size(); ++i) out[i] = all[bodies[i]];
  }
  virtual std::span<const JointState> joint_states() const = 0;
  /// Contacts of the last step, ordered by creation of the two bodies.
  virtual std::span<const Contact> contacts() const = 0;
  /// Indices of bodies that overlap each ball, ascending; appended to `out`, one span end per query in
  /// `ends`.
  virtual void overlaps(std::span<const OverlapQuery> queries, std::vector<std::uint32_t>& out,
                        std::vector<std::uint32_t>& ends) const = 0;
  /// The engine's own ray casting, or null when it has none (then the ray scene answers).
  virtual const RayCaster* rays() const = 0;

  virtual void apply(std::span<const Wrench> wrenches) = 0;
  virtual void set_targets(std::span<const JointTarget> targets) = 0;
  virtual void set_drive_targets(std::span<const DriveTarget> targets) = 0;
  virtual void set_rolls(std::span<const RollTarget>) {}
  virtual void set_wheels(std::span<const WheelTarget>) {}
  virtual void set_grips(std::span<const GripTarget>) {}
  /// All that hold, in an order that follows from the order of creation. Valid until the next non-const call.
  virtual std::span<const Grip> grips() const { return {}; }
  /// The ground's zones, and the user's exceptions (null: none). Before the first step.
  virtual void set_zones(std::span<const model::SurfaceZone>) {}
  virtual void set_contact_rule(ContactRule) {}
  /// Asks for forces of the next step. Comes before the wrenches of that step. An engine may round
  /// differently when it is watched, so watching is an input like the others.
  virtual void watch(const Watch&) {}
  /// Indexed by JointId::index; valid for the joints whose loads were watched in the last step. Empty without
  /// the capability.
  virtual std::span<const JointLoad> joint_loads() const { return {}; }

  /// Advances by h seconds: one sub-step. `stream_key` seeds what the solver draws in this sub-step.
  virtual void step(double h_s, std::uint64_t stream_key) = 0;
  /// Fails with the name of the first body whose state is no longer finite.
  virtual Status check_finite() const = 0;

  /// All State of one instance (bodies, joints, motors, sleep), independent of all other instances.
  virtual void save(InstanceId id, ByteWriter& w) const = 0;
  /// @pre the same instances were added in the same order to a new engine; false: the bytes do not fit, and the instance
  ///      is in no state to go on with.
  virtual bool load(InstanceId id, ByteReader& r) = 0;

  virtual EngineCounters counters() const = 0;
};

/// One line per engine in physics/engines.cpp.
struct EngineKind {
  const char* name;
  const char* help;
  std::vector<FieldInfo> (*describe)();
  /// @param config   keys of `physics:` other than `engine`
  Result<std::unique_ptr<Engine>> (*create)(const Node& config, Vec3 gravity_mps2);
};

std::span<const EngineKind* const> engine_kinds();
/// By name, or an error with the nearest one.
Result<const EngineKind*> find_engine(std::string_view name);

}  // namespace sandlot
