#pragma once
/// Rigid bodies in three dimensions, on the Open Dynamics Engine (double precision).
///
/// Frame    W: z up where gravity points down; everything in SI.
/// Time     semi-implicit Euler: velocities first, then positions with the new velocities. Orientation
///          advances by the exact rotation of the new angular velocity, spin about the own joint axis first.
/// Contacts spheres, boxes, cylinders, capsules, planes; cylinders against cylinders and capsules: see
/// cylinder_contacts.h; meshes,
///          terrain, cones and ellipsoids: see triangles.h; barrels: see barrel_contacts.h.
/// Wheels   with rollers: see wheels.h.
/// State    positions, velocities, joint angles, motors, drives, sleep and solver choice, all of it in
///          save(). Every sub-step builds what ODE needs from that State, so that a restored run continues
///          with the same bits.
/// Limits   planes and terrain are static; no continuous collision: a body faster than its
///          size per sub-step passes through walls. Limits and motors act with ODE's compliance.
/// Cost     direct solver cubic, quick solver linear in the contacts of an island.
/// Errors   add() names the link or joint that cannot be expressed; step() never fails, check_finite()
///          reports.
/// Source   R. Smith, Open Dynamics Engine 0.16.2; settings: docs of the fields in spec.h.
#include <ode/ode.h>

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "physics/engine.h"
#include "physics/exploded.h"
#include "physics/pair_surface.h"
#include "physics/rigid/parts.h"
#include "physics/rigid/spec.h"

namespace sandlot::rigid {

extern const EngineKind engine;

class RigidEngine final : public Engine {
 public:
  RigidEngine(const Spec& spec, Vec3 gravity_mps2);
  ~RigidEngine() override;

  Capabilities capabilities() const override;
  Result<InstanceId> add(const model::Instance& instance) override;
  void remove(InstanceId id) override;
  std::span<const BodyId> bodies(InstanceId id) const override { return alive(id).link_ids; }
  std::span<const JointId> joints(InstanceId id) const override { return alive(id).joint_ids; }
  void set_pose(InstanceId id, const Pose& X_WM) override;
  void set_velocity(InstanceId id, const Velocity& V_WB) override;
  void guide(InstanceId id, const Pose& X_WM, const Velocity& V_WM) override;
  void become_robot(InstanceId id) override;
  BodyName name(BodyId id) const override;
  BodyId body_at(std::uint32_t index) const override;
  Pose pose(InstanceId id) const override;
  std::span<const BodyState> states() const override { return states_; }
  std::span<const JointState> joint_states() const override { return joint_states_; }
  std::span<const Contact> contacts() const override { return contacts_; }
  void overlaps(std::span<const OverlapQuery> queries, std::vector<std::uint32_t>& out,
                std::vector<std::uint32_t>& ends) const override;
  const RayCaster* rays() const override { return nullptr; }
  void apply(std::span<const Wrench> wrenches) override;
  void set_targets(std::span<const JointTarget> targets) override;
  void set_drive_targets(std::span<const DriveTarget> targets) override;
  void set_wheels(std::span<const WheelTarget> targets) override;
  void set_grips(std::span<const GripTarget> targets) override;
  std::span<const Grip> grips() const override { return published_grips_; }
  void set_zones(std::span<const model::SurfaceZone> zones) override { zones_ = ZoneMap(zones); }
  void set_contact_rule(ContactRule rule) override { rule_ = std::move(rule); }
  void watch(const Watch& watch) override;
  std::span<const JointLoad> joint_loads() const override { return loads_; }
  void step(double h_s, std::uint64_t stream_key) override;
  Status check_finite() const override;
  void save(InstanceId id, ByteWriter& w) const override;
  bool load(InstanceId id, ByteReader& r) override;
  EngineCounters counters() const override { return counters_; }

 private:
  struct Pair {
    std::uint64_t first, second;  ///< their serials, first < second
    Geom *a, *b;
  };
  struct Hit {
    Geom *a, *b;
    std::uint32_t index;  ///< among the points of this pair
    dContact contact;
  };
  struct Island {
    std::uint32_t contacts = 0;
    bool was_quick = false, quick = false;
    bool rolling = false;  ///< a roller is awake in it
    bool may_sleep = true;
  };
  struct LinkSlot {
    std::uint32_t generation = 0;
    Instance* instance = nullptr;  ///< null: free
    std::uint32_t link = 0;
    bool watched = false;  ///< its contacts, in the next sub-step
  };
  struct JointSlot {
    std::uint32_t generation = 0;
    Instance* instance = nullptr;
    std::uint32_t joint = 0;
  };

  // build.cpp
  Instance& alive(InstanceId id) const;
  Status check(const model::Instance& instance) const;
  void make_bodies(Instance& instance, const RigidGroups& groups);
  void make_geoms(Instance& instance);
  Geom& make_geom(Instance& instance, std::uint32_t link, const model::Collision& collision,
                  Wheel* wheel = nullptr);
  void give_ids(Instance& instance);
  void destroy(Instance& instance);

  // placement.cpp
  void place(Instance& instance, const Pose& X_WM);
  void place_static_geoms(Instance& instance);
  void put(Body& body);
  void put_orientation(Body& body);
  void show(const Instance& instance);
  void set_gyroscopic(Instance& instance);
  void wake(Body& body);
  void wake_instance(Instance& instance);
  void wake_neighbours(const Instance& instance);

  // collide.cpp
  std::span<Hit> hits() { return {hit_buffer_.data(), hit_count_}; }
  void collide();
  void see_pair(Geom* a, Geom* b);
  void collide_pair(const Pair& pair);
  int collide_triangles(const Pair& pair, Hit* found);
  int collide_meshes(const Pair& pair);
  int collide_barrels(const Pair& pair, Hit* found);
  void sense_wheels(const Pair& pair);
  void collide_rollers(const Pair& pair);
  PairSurface surfaces_at(const Hit& hit) const;
  void find_surfaces();
  void direct_contact(Hit& hit, const PairSurface& pair);
  void attach_contacts(double h_s);
  static void near(void* engine, dGeomID a, dGeomID b);

  // grips.cpp
  std::uint64_t rank(const Instance& instance) const;
  Held grip_of(BodyId one, BodyId other) const;
  void keep(const Held& grip);
  void let_go(const Instance& instance);
  void list_grips();
  void wake_held();
  void attach_grips();
  void measure_grips();
  bool hold_each_other(const Geom& a, const Geom& b) const;
  std::size_t grips_of(const Instance& instance) const;
  void save_grips(const Instance& instance, ByteWriter& w) const;
  bool load_grips(Instance& instance, ByteReader& r);

  // loads.cpp
  bool begin_contacts(std::size_t count);
  void watch_contact(const Geom& a, const Geom& b, dJointID joint);
  void measure_contacts();
  void measure_loads(double h_s);
  JointLoad load_of(const Instance& instance, const Joint& joint, double h_s);
  JointLoad load_within_body(const Instance& instance, const Joint& joint, double h_s);
  void find_behind(const Instance& instance, const Joint& joint);
  void forget_watch();

  // step.cpp
  void push_forces(double h_s);
  void drive(Instance& instance, double h_s);
  void find_islands();
  std::uint32_t root(std::uint32_t node);
  void unite(const Body* a, const Body* b);
  void solve(double h_s, std::uint64_t stream_key);
  template <class Choose>
  void enable(Choose&& choose);
  void solve_again(double h_s);
  bool nobody_exploded();
  std::string fastest_body() const;
  void fail(Error error);
  void advance(double h_s);
  void send_to_sleep(double h_s);

  Spec spec_;
  Vec3 gravity_;
  dWorldID world_ = nullptr;
  dThreadingImplementationID threading_ = nullptr;
  dSpaceID space_ = nullptr;
  dJointGroupID contact_joints_ = nullptr;

  struct Slot {
    std::uint32_t generation = 0;
    std::unique_ptr<Instance> instance;
  };
  std::vector<Slot> slots_;
  std::vector<Instance*> order_;  ///< alive, in the order of creation: every loop over bodies follows it
  std::vector<LinkSlot> link_slots_;
  std::vector<JointSlot> joint_slots_;
  std::vector<std::uint32_t> free_instances_, free_links_, free_joints_;
  std::uint64_t next_serial_ = 1;

  std::vector<Held> grips_;
  std::vector<Grip> published_grips_;  ///< the same, as others see them
  ZoneMap zones_;
  ContactRule rule_;
  TriangleStore triangles_;
  std::vector<BodyState> states_;
  std::vector<JointState> joint_states_;
  std::vector<Contact> contacts_;
  std::vector<JointLoad> loads_;
  EngineCounters counters_;
  std::optional<Error>
      failure_;        ///< who broke off the run; the State is that before the sub-step in which it did
  std::string fault_;  ///< ODE's message when it stopped in the middle of a sub-step; empty: it never did

  // Scratch of one sub-step; kept for its capacity.
  std::vector<Pair> pairs_, dormant_;
  std::vector<dContactGeom> points_;  ///< of one pair, before they are thinned out
  dGeomID ray_ = nullptr;             ///< in no space; for pairs of meshes
  std::vector<Hit> hit_buffer_;       ///< never shrinks: clearing 300 bytes per possible point would show
  std::size_t hit_count_ = 0;
  std::vector<PairSurface> surfaces_;  ///< of each hit, where zones or a rule make them differ
  std::vector<std::uint32_t> island_parent_;
  std::vector<Island> islands_;
  bool woke_ = false;
  bool unordered_ = false;  ///< hits are not in the order of their shapes yet
  // Contacts and joints watched in the next sub-step: see loads.cpp.
  struct Push {
    const Instance* instance;
    std::uint32_t link;
    Vec3 point_W, force_N, torque_Nm;
  };
  std::vector<std::uint32_t> watched_links_, watched_joints_;  ///< indices of slots
  std::vector<Push> pushes_;                                   ///< wrenches on links, while loads are watched
  std::vector<dJointFeedback> contact_feedback_;
  std::vector<std::uint8_t>
      watched_contacts_;              ///< per contact: 0 not watched, 1 the force reported is on b, 2 on a
  std::vector<std::uint8_t> behind_;  ///< per link: beyond the fixed joint in question
  std::vector<std::uint32_t> frontier_;
};

}  // namespace sandlot::rigid
