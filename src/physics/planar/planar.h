#pragma once
/// The planar engine, first form: bodies are discs and walls that move kinematically.
///
/// Frame    a moving instance has three degrees of freedom: x, y and heading of its canonical link. Height, roll and
///          pitch stay as they were placed.
/// Bodies   a moving instance meets others as one disc: around the middle of the rectangle that encloses all its
///          collision shapes, just large enough to contain them, over the heights between their lowest and highest
///          point. A static instance, or one with a joint to the world, is its shapes' outlines (outline.h).
///          Horizontal planes are the ground, on which everything stands.
/// Paths    an instance with a motion is a disc as well, which pushes and is not pushed, not even by walls.
/// Motion   ideal drives (drive.h). What has no drive stays where it is unless pushed, and stops at once: friction
///          with the ground is infinite between pushes and nothing during them.
/// Contact  discs stop at walls and slide along them; two discs push each other apart in proportion to their inverse
///          masses. A drive loses the velocity that a contact took. No restitution, no friction between bodies.
/// Joints   kinematic: a velocity target is reached at once and ends at the joint's limits; `free` and `effort`
///          leave the joint where it is. A universal joint turns about its first axis only, a screw does not slide,
///          and a joint that is to follow another stays.
/// Limits   wrenches and gravity have no effect. Discs that move farther than their radius in one step may pass each
///          other (never a wall). Stacked discs that press on each other may overlap by about one step's motion.
/// Cost     per moving body and step 110 ns (1000 bodies) to 140 ns (10,000), plus contacts; the states of links
///          about 15 ns each and only when asked for.
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "physics/engine.h"
#include "physics/planar/drive.h"
#include "physics/planar/map.h"
#include "physics/planar/tree.h"

namespace sandlot::planar {

struct Spec {
  double cell_m = 0.5;
  double clearance_m = 0.005;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"cell_size", "m",
                "Edge of the grid's cells: about the spacing of bodies. No effect on results.", 0.01, 1000},
          s.cell_m);
    visit(Field{"clearance", "m", "Bodies pass over and under what overlaps their height by less.", 0, 1000},
          s.clearance_m);
  }
};

class PlanarEngine final : public Engine, private RayCaster {
 public:
  explicit PlanarEngine(const Spec& spec) : spec_(spec), map_(spec.cell_m) {}

  Capabilities capabilities() const override;
  Result<InstanceId> add(const model::Instance& instance) override;
  void remove(InstanceId id) override;
  std::span<const BodyId> bodies(InstanceId id) const override { return get(id).bodies; }
  std::span<const JointId> joints(InstanceId id) const override { return get(id).joints; }
  void set_pose(InstanceId id, const Pose& X_WM) override;
  void guide(InstanceId id, const Pose& X_WM, const Velocity& V_WM) override;
  BodyName name(BodyId id) const override;
  Pose pose(InstanceId id) const override;
  std::span<const BodyState> states() const override;
  std::span<const JointState> joint_states() const override { return joint_states_; }
  std::span<const Contact> contacts() const override { return contacts_; }
  void overlaps(std::span<const OverlapQuery> queries, std::vector<std::uint32_t>& out,
                std::vector<std::uint32_t>& ends) const override;
  const RayCaster* rays() const override { return this; }
  void apply(std::span<const Wrench>) override {}
  void set_targets(std::span<const JointTarget> targets) override;
  void set_drive_targets(std::span<const DriveTarget> targets) override;
  void step(double h_s, std::uint64_t stream_key) override;
  Status check_finite() const override;
  void save(InstanceId id, ByteWriter& w) const override;
  bool load(InstanceId id, ByteReader& r) override;
  EngineCounters counters() const override;

 private:
  /// What changes rarely, or is looked at rarely.
  struct Instance {
    bool alive = false, moves = false;
    bool guided = false;                                   ///< moves along a path
    std::optional<std::pair<Pose, Velocity>> destination;  ///< of a guided one, after the next step
    std::uint32_t generation = 0;
    std::uint64_t created = 0;  ///< counts up: the order in which contacts are solved
    std::string name;
    std::shared_ptr<const model::Model> model;
    std::shared_ptr<const Tree> tree;
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    Quat tilt;       ///< attitude of the canonical link at heading 0
    double z_m = 0;  ///< its height
    Vec2 offset;     ///< of the disc's centre, in the heading's frame
    double inverse_mass_per_kg = 1;
  };
  /// Hot, one per slot.
  struct Base {
    Vec2 p;
    Turn heading;
    Vec2 v;  ///< of p, in W
    double w_radps = 0;
  };
  struct Drive {
    std::uint32_t active = 0;
    std::uint32_t link = 0;  ///< of the instance's model: whose frame the velocities are in
    Twist now, target;
    double accel = 0, angular_accel = 0;
    Vec2 arm;    ///< of that link's origin in the heading's frame
    Turn frame;  ///< of its x axis there
  };
  struct Motor {
    std::uint32_t generation = 0;
    std::uint32_t active = 0;  ///< mode `velocity`
    double velocity = 0;
    double lower = 0, upper = 0, max_velocity = 0;
  };
  /// A contact with the key that orders it.
  struct Touch {
    std::uint64_t first, second;  ///< creation of the instances, ascending
    std::uint32_t wall;           ///< index, or ~0u
    Contact contact;
  };
  struct Pair {
    std::uint64_t key;
    std::uint32_t a, b;  ///< slots, a created before b
  };

  void cast(std::span<const RayJob> jobs) const override;

  const Instance& get(InstanceId id) const;
  BodyId body_id(std::uint32_t index) const { return {index, body_generation_[index]}; }
  void settle(std::uint32_t slot, const Pose& X_WM);
  void shape(std::uint32_t slot);
  void aim(std::uint32_t slot, std::uint32_t link);
  Pose canonical_pose(std::uint32_t slot) const;

  void refresh_walls() const;
  void refresh_map() const;
  void refresh_links() const;
  void stale() { map_fresh_ = links_fresh_ = false; }

  void drive(std::uint32_t slot, double h_s);
  void lead(std::uint32_t slot);
  Vec2 clear_of_walls(std::uint32_t slot, Vec2 from, Vec2 to);
  bool push_out(std::uint32_t slot, Vec2& centre);
  void find_pairs();
  void separate_pairs();
  bool separate(const Pair& pair);
  void feel_contacts(std::uint32_t slot, double h_s);
  void turn_joints(double h_s);
  void list_contacts();
  void touch(std::uint32_t slot, std::uint32_t other, std::uint32_t wall, std::uint32_t other_body,
             Vec2 point, double z_m, Vec2 from_other, double depth_m);

  Spec spec_;
  std::vector<Instance> instances_;
  std::vector<Base> bases_;
  std::vector<Drive> drives_;
  std::vector<std::uint32_t> free_instances_, free_bodies_, free_joints_;
  std::vector<std::uint32_t> order_;  ///< slots by creation
  std::uint64_t created_ = 0;
  std::shared_ptr<const model::Model> last_model_;  ///< of `last_tree_`: robots come in series
  std::shared_ptr<const Tree> last_tree_;

  std::vector<std::uint32_t> body_slot_, body_generation_;
  std::vector<JointState> joint_states_;
  std::vector<Motor> motors_;

  // Made when asked for, in const functions that several threads may call at once.
  mutable std::mutex refreshing_;
  mutable std::atomic<bool> map_fresh_ = false, links_fresh_ = false;
  mutable bool walls_fresh_ = false;
  mutable Map map_;
  mutable std::vector<BodyState> states_;

  // Scratch of step().
  std::vector<Round> hull_;
  std::vector<Vec2> start_, unhindered_;  ///< by slot: p before the step, disc centre without contacts
  std::vector<std::uint32_t> near_walls_;
  std::vector<Pair> pairs_;
  std::vector<Touch> touches_;
  std::vector<Contact> contacts_;
};

}  // namespace sandlot::planar
