#pragma once
/// The planar engine: bodies with three degrees of freedom on a ground, among walls.
///
/// Frame    a moving instance has three degrees of freedom: x, y and heading. Height, roll and pitch stay as
///          placed.
/// Bodies   rigid groups of links, circles or convex polygons over heights (plan.h). A static instance, or
///          one with a joint to the world, is its shapes' outlines (outline.h). Horizontal planes and flat
///          tops are the ground.
/// Paths    an instance with a motion pushes and is not pushed, not even by walls.
/// Contact  semi-implicit Euler; collisions with restitution are passed on one after the other (so Newton's
///          cradle works), then sequential impulses with warm start hold bodies apart with Coulomb friction;
///          overlap beyond 0.1 mm is taken back by moving bodies, which adds no energy (solve.cpp).
/// Surface  combined by the law of all engines (pair_surface.h), zones and the user's rule included; the rule
///          may be called by several threads at once, and sees all joints at 0. Of a pair count: friction
///          along the tangent, belts, restitution, and on the ground the two directions of friction and
///          rolling resistance. Slip, softness and correction have no meaning: bodies are hard. So of a
///          substance only the roughness counts (mu = r1 r2), and it does not bounce. A support stands on the
///          zone or belt below its middle; several belts pull at their mean.
/// Fast     a body that could pass something in a step, or turn into it, moves in pieces from impact to
///          impact; the rest of the step is lost after 24 of them.
/// Ground   what does not stand on wheels rubs with mu times its weight, as force and torque, by an
///          ellipsoidal limit surface; one sphere rolls, held by rolling resistance alone (ground.cpp).
/// Balls    A ball that is kicked or bounces slides first and rolls in the end; here it rolls at once, with the velocity of
///          that end: a lasting push moves m + I / r^2, and a blow, which is over before the ball turns, is as
///          large as against m alone, so that a bounce keeps (1 + e) / (1 + I / (m r^2)) - 1 of the speed, or nothing. A sphere
///          with mu 0 slides for ever. A torque about the horizontal rolls it.
///          Without a floor: a surface with mu 1.
/// Wheels   level `contact`: spin about the axle with motor, damping and friction; against the ground along
///          and across within Coulomb's cone of the weight on the wheel; with rollers along the roller's axis
///          alone (wheels.cpp).
/// Drives   ideal drives run on rails (drive.h): an exact arc where nothing touches, and in contact a push of
///          at most what brings the robot to its velocity within the step at the acceleration it may have.
///          Their wheels turn by the way that the base went, on demand (rolls.cpp).
/// Joints   pivots and sliders between groups of an instance, with motor, limits, friction and spring;
///          steering. All others are kinematic: a velocity target is reached at once and ends at the joint's
///          limits.
/// Limits   balls have no phase of sliding. Wheels do not tilt the body, nor does accelerating shift weight.
///          Steering does not feel the ground. Kinematic joints do not change outlines. A lying cylinder
///          slides.
/// Threads  islands of touching bodies are solved in parallel; results do not depend on how many threads
///          there are.
#include <array>
#include <atomic>
#include <mutex>

#include "physics/pair_surface.h"
#include "physics/planar/bodies.h"

namespace sandlot::planar {

struct Spec {
  double cell_m = 0.5;
  double clearance_m = 0.005;
  int iterations = 12;
  double max_speed_mps = 1e4, max_spin_radps = 1e5;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"cell_size", "m",
                "Edge length of the grid's cells: about the spacing of bodies. No effect on results.", 0.01,
                1000},
          s.cell_m);
    visit(Field{"clearance", "m", "Overlap in height below which bodies pass over and under one another.", 0,
                1000},
          s.clearance_m);
    visit(
        Field{"iterations", "", "Number of passes over the contacts of an island in each sub-step.", 1, 1000},
        s.iterations);
    visit(Field{"max_speed", "m/s",
                "Largest speed of a body; beyond it the run ends with an error that names the body.", 1e-3,
                1e9},
          s.max_speed_mps);
    visit(Field{"max_spin", "rad/s",
                "Largest turning rate of a body; beyond it the run ends with an error that names the body.",
                1e-3, 1e9},
          s.max_spin_radps);
  }
};

class PlanarEngine final : public Engine, private RayCaster {
 public:
  explicit PlanarEngine(const Spec& spec, Vec3 gravity = {0, 0, -9.81})
      : spec_(spec), gravity_mps2_(std::max(-gravity.z, 0.0)), map_(spec.cell_m) {}

  Capabilities capabilities() const override;
  Result<InstanceId> add(const model::Instance& instance) override;
  void remove(InstanceId id) override;
  std::span<const BodyId> bodies(InstanceId id) const override { return get(id).bodies; }
  std::span<const JointId> joints(InstanceId id) const override { return get(id).joints; }
  void set_pose(InstanceId id, const Pose& X_WM) override;
  void set_velocity(InstanceId id, const Velocity& V_WB) override;
  void guide(InstanceId id, const Pose& X_WM, const Velocity& V_WM) override;
  BodyName name(BodyId id) const override;
  BodyId body_at(std::uint32_t index) const override;
  Pose pose(InstanceId id) const override;
  std::span<const BodyState> states() const override;
  void states_of(std::span<const std::uint32_t> bodies, std::span<BodyState> out) const override;
  std::span<const JointState> joint_states() const override;
  std::span<const Contact> contacts() const override { return contacts_; }
  void overlaps(std::span<const OverlapQuery> queries, std::vector<std::uint32_t>& out,
                std::vector<std::uint32_t>& ends) const override;
  const RayCaster* rays() const override { return this; }
  void apply(std::span<const Wrench> wrenches) override;
  void set_targets(std::span<const JointTarget> targets) override;
  void set_drive_targets(std::span<const DriveTarget> targets) override;
  void set_rolls(std::span<const RollTarget> targets) override;
  void set_grips(std::span<const GripTarget> targets) override;
  std::span<const Grip> grips() const override { return published_grips_; }
  void set_zones(std::span<const model::SurfaceZone> zones) override;
  void set_contact_rule(ContactRule rule) override;
  void step(double h_s, std::uint64_t stream_key) override;
  Status check_finite() const override;
  void save(InstanceId id, ByteWriter& w) const override;
  bool load(InstanceId id, ByteReader& r) override;
  EngineCounters counters() const override;

 private:
  struct Island {
    std::uint32_t first_group = 0, groups = 0, first_candidate = 0, candidates = 0, first_constraint = 0,
                  constraints = 0;
    std::vector<ContactPoint> contact_points, turned;  ///< kept from step to step so that they need no heap
  };
  /// A flat place to stand on.
  struct Floor {
    double z_m = 0;
    ContactFace face;
    std::uint32_t wall = none;  ///< whose top it is; none: it has no end
  };

  void cast(std::span<const RayJob> jobs) const override;

  const Instance& get(InstanceId id) const;
  BodyId body_id(std::uint32_t index) const { return {index, body_generation_[index]}; }
  std::uint32_t slot_of(BodyId id) const;
  bool alive(BodyId id) const;

  // planar.cpp, placement.cpp
  void expect(std::uint32_t slot) const;
  void add_joints(Instance& instance);
  void settle(std::uint32_t slot, const Pose& X_WM);
  void shape(std::uint32_t slot);
  void place_groups(std::uint32_t slot, const Pose& X_WB);
  void place_disc(std::uint32_t group);
  void free_groups(Instance& instance);
  void aim(std::uint32_t slot, std::uint32_t link);
  void lead(std::uint32_t slot, double h_s);
  void arrive(std::uint32_t slot);
  Pose canonical_pose(std::uint32_t slot) const;
  BodyState canonical_state(std::uint32_t slot) const;
  void refresh_walls() const;
  void refresh_map() const;
  void refresh_links() const;
  void stale() { map_fresh_ = links_fresh_ = rolls_fresh_ = false; }

  // surfaces.cpp
  PairSurface surfaces_at(const ContactFace& a, const ContactFace& b, Vec3 point_W, Vec3 normal_W) const;
  Pose pose_of(const ContactFace& face) const;
  void explode(std::uint32_t group, Vec2 v, double w_radps);
  double excess(Vec2 v, double w_radps) const;
  /// excess() is at most 1.
  bool is_sound(Vec2 v, double w_radps) const {
    return dot(v, v) <= spec_.max_speed_mps * spec_.max_speed_mps &&
           w_radps * w_radps <= spec_.max_spin_radps * spec_.max_spin_radps;
  }
  Error exploded(std::uint32_t group, Vec2 v, double w_radps) const;

  // rolls.cpp
  void refresh_rolls() const;
  void show(const Roll& roll) const;
  void relate(Roll& roll) const;
  void set_roll(std::uint32_t joint, const RollTarget& target, double position);
  void end_roll(std::uint32_t joint);

  // grips.cpp
  JointConstraint make_grip(BodyId a, BodyId b) const;
  void let_go(std::uint32_t slot);
  void list_grips();
  void measure_grips(double h_s);
  bool hold_each_other(const Candidate& c) const;

  // step.cpp
  void begin(std::uint32_t slot, double h_s);
  void plan_drive(std::uint32_t slot, RigidGroup& group, double h_s);
  double reach(const RigidGroup& group, double h_s) const;
  void file(double h_s);
  void find_contact_points(double h_s);
  void find_islands(double h_s);
  std::uint32_t root(std::uint32_t group);
  void unite(std::uint32_t a, std::uint32_t b);
  void finish_drive(std::uint32_t slot, RigidGroup& group, double h_s);
  void finish_hindered(std::uint32_t slot, RigidGroup& group, const Planned& planned);
  void refresh_linked();
  void turn_joints(double h_s);
  void list_contacts(double h_s);

  // collide.cpp
  bool near(const Candidate& c, double h_s) const;
  void collide(const Candidate& c, double h_s, std::vector<ContactPoint>& out) const;
  void remember(std::span<ContactPoint> contact_points) const;
  double impact(const Candidate& c, double h_s) const;
  void move_silhouette(std::uint32_t group);

  // solve.cpp
  void solve(Island& island, double h_s);
  void bounce(std::span<ContactPoint> contact_points);
  void prepare(ContactPoint& t, double h_s, bool warm);
  double hold_apart(std::span<ContactPoint> contact_points);
  double advance_island(const Island& island, double h_s);
  void take_back(Island& island, double h_s);
  void move(std::uint32_t group, double h_s, double& left_m);
  void move_alone(std::uint32_t group, double h_s);

  // ground.cpp, wheels.cpp, joint_constraints.cpp
  void find_ground(std::uint32_t group);
  const Floor* floor_under(std::uint32_t group, Vec2 at_W) const;
  PairSurface on_ground(std::uint32_t group, ContactFace foot, Vec2 at) const;
  void rub(std::uint32_t group, double h_s);
  void prepare_wheels(std::uint32_t slot, double h_s);
  double turn_wheels(std::uint32_t slot, double h_s);
  void finish_wheels(std::uint32_t slot, double h_s);
  void steer(std::uint32_t slot, double h_s);
  void prepare_constraint(JointConstraint& l, double h_s);
  void hold_constraint(JointConstraint& l, double h_s);
  void take_back(JointConstraint& l);
  void finish_constraint(JointConstraint& l, double h_s);

  // state.cpp
  void save_contact_points(std::uint32_t slot, ByteWriter& w) const;
  bool load_contact_points(std::uint32_t slot, ByteReader& r);

  Spec spec_;
  double gravity_mps2_;
  std::vector<Instance> instances_;
  std::vector<Drive> drives_;               ///< by slot
  std::vector<InstanceSummary> summaries_;  ///< by slot
  std::vector<Twist> means_;                ///< by slot: of a drive's step, in the group's frame
  std::vector<RigidGroup> groups_;
  std::vector<GroundFriction> ground_friction_;  ///< by group
  std::vector<std::uint32_t> free_instances_, free_bodies_, free_joints_, free_groups_, free_silhouettes_;
  std::vector<std::uint32_t> order_;  ///< slots by creation
  std::uint64_t created_ = 0;
  std::shared_ptr<const Plan> last_plan_;  ///< robots come in series
  std::shared_ptr<const model::Model> last_model_;
  std::shared_ptr<const ForwardKinematics> last_kinematics_;
  Quat last_tilt_;
  double last_z_m_ = 0;

  std::vector<std::uint32_t> body_slot_, body_generation_;
  std::vector<std::uint8_t> body_is_first_;  ///< of its instance: its canonical link
  std::vector<Motor> motors_;
  std::vector<std::uint32_t> turning_;  ///< kinematic joints with a velocity target, and those that had one
  std::vector<Roll> rolls_;
  std::vector<JointConstraint> grips_;
  std::vector<Grip> published_grips_;  ///< the same, as others see them

  // Made on demand, in const functions that several threads may call at once.
  mutable std::mutex refreshing_;
  mutable std::atomic<bool> map_fresh_ = false, links_fresh_ = false, rolls_fresh_ = false;
  mutable bool walls_fresh_ = false;
  mutable std::atomic<bool> filed_ = false;  ///< the broad phase holds
  mutable Map map_;
  mutable std::vector<BodyState> states_;
  mutable std::vector<JointState> joint_states_;
  mutable std::vector<Floor> floors_;
  mutable bool ground_fresh_ = false;
  bool ground_varies_ = false;  ///< what stands under a body, or how, changes as it moves
  ZoneMap zones_;
  ContactRule rule_;
  struct Explosion {
    double excess = 0;
    std::uint32_t group = none;
    Vec2 v;
    double w_radps = 0;
  } explosion_;  ///< the worst of a step that is not made
  std::optional<Error> failure_;

  // Broad phase: superset of what can touch until somebody has come far.
  HashGrid cells_;
  std::vector<Vec2> filed_at_;
  std::vector<double> slack_m_;
  std::vector<Candidate> candidates_;
  std::vector<std::uint32_t> near_walls_;

  std::vector<ContactPoint> contact_points_;  ///< of the last step, by key: their impulses are State
  std::vector<ContactPoint> found_;
  std::vector<std::uint32_t> parent_, island_of_, island_groups_, island_slots_;
  std::vector<std::uint32_t> marked_;  ///< groups that are in an island
  std::vector<std::uint32_t> linked_;  ///< slots with constraints
  bool linked_fresh_ = false;
  std::vector<Planned> planned_;  ///< of those on rails, as island_groups_
  std::vector<double> left_m_;    ///< how far they may still come in this step, as island_groups_
  std::vector<Candidate> island_candidates_;
  std::vector<JointConstraint*> island_constraints_, sorted_constraints_;
  std::vector<double> fastest_;
  std::vector<Island> islands_;
  std::size_t island_count_ = 0;
  std::vector<Contact> contacts_;
};

}  // namespace sandlot::planar
