#include "physics/planar/planar.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/prefetch.h"
#include "base/read.h"
#include "geometry/mesh.h"

namespace sandlot::planar {
namespace {

bool stands_still(const model::Model& model) {
  return model.is_static || std::any_of(model.joints.begin(), model.joints.end(),
                                        [](const model::Joint& j) { return j.parent == model::world_link; });
}

Status check(const model::Instance& instance) {
  const model::Model& model = *instance.model;
  if (model.links.empty()) return Error{"model '" + model.name + "' has no link", "", model.place};
  const bool still = stands_still(model) && !instance.motion;
  for (const model::Link& link : model.links)
    for (const model::Collision& collision : link.collisions) {
      if (std::holds_alternative<Heightfield>(collision.shape))
        return Error{"the planar engine has no terrain: '" + collision.name + "' is a heightmap",
                     "use a plane, or engine: rigid", collision.place};
      constexpr std::size_t most_triangles = 1'000'000;
      const auto* mesh = std::get_if<Mesh>(&collision.shape);
      if (mesh && mesh->mesh->triangles.size() > most_triangles)
        return Error{
            "mesh '" + collision.name + "' has more than a million triangles, too many for the planar engine",
            "simplify it, or use engine: rigid", collision.place};
      const auto* plane = std::get_if<Plane>(&collision.shape);
      if (!plane) continue;
      const Vec3 n = rotate((instance.X_WM * link.X_ML * collision.X_LC).q, plane->normal);
      if (!still)
        return Error{"the planar engine has no moving planes: '" + collision.name + "'", "use a box",
                     collision.place};
      if (std::abs(n.z) < 0.999)
        return Error{"the planar engine has horizontal planes only, '" + collision.name + "' is none",
                     "use a box", collision.place};
    }
  return {};
}

}  // namespace

Capabilities PlanarEngine::capabilities() const {
  return {.name = "planar",
          .planar = true,
          .joints = true,
          .contact_drives = true,
          .ideal_drives = true,
          .rays = true,
          .contact_forces = true,
          .grips = true,
          .rolls = true};
}

BodyName PlanarEngine::name(BodyId id) const {
  if (id.index >= body_slot_.size() || body_generation_[id.index] != id.generation) return {};
  const Instance& instance = instances_[body_slot_[id.index]];
  for (std::size_t l = 0; l < instance.bodies.size(); ++l)
    if (instance.alive && instance.bodies[l] == id)
      return {instance.name, &instance.model->links[l], instance.moves && !instance.guided};
  return {};
}

BodyId PlanarEngine::body_at(std::uint32_t index) const {
  return index < body_generation_.size() ? body_id(index) : BodyId{};
}

const Instance& PlanarEngine::get(InstanceId id) const {
  SL_CHECK(id.index < instances_.size());
  const Instance& instance = instances_[id.index];
  SL_CHECK(instance.alive && instance.generation == id.generation);
  return instance;
}

template <class T>
std::uint32_t take_index(std::vector<std::uint32_t>& free, std::vector<T>& all) {
  if (free.empty()) {
    all.emplace_back();
    return static_cast<std::uint32_t>(all.size() - 1);
  }
  const std::uint32_t index = free.back();
  free.pop_back();
  return index;
}

Result<InstanceId> PlanarEngine::add(const model::Instance& declared) {
  SL_TRY(check(declared));
  const model::Model& model = *declared.model;
  if (last_model_ != declared.model) {
    last_model_ = declared.model;
    last_kinematics_ = std::make_shared<const ForwardKinematics>(model);
    last_plan_ = nullptr;
  }
  const std::uint32_t slot = take_index(free_instances_, instances_);
  drives_.resize(instances_.size());
  summaries_.resize(instances_.size());
  means_.resize(instances_.size());
  Instance& instance = instances_[slot];
  instance.alive = true;
  instance.guided = declared.motion.has_value();
  instance.moves = instance.guided || !stands_still(model);
  instance.created = created_++;
  instance.name = declared.name;
  instance.model = declared.model;
  instance.kinematics = last_kinematics_;
  instance.bodies.reserve(model.links.size());
  instance.joints.reserve(model.joints.size());
  for (std::size_t l = 0; l < model.links.size(); ++l) {
    const std::uint32_t body = take_index(free_bodies_, body_slot_);
    body_generation_.resize(body_slot_.size());
    body_is_first_.resize(body_slot_.size());
    body_slot_[body] = slot;
    body_is_first_[body] = l == 0;
    instance.bodies.push_back(body_id(body));
  }
  for (const model::Joint& joint : model.joints) {
    const std::uint32_t index = take_index(free_joints_, motors_);
    joint_states_.resize(motors_.size());
    joint_states_[index] = {};
    Motor& motor = motors_[index];
    const bool listed = motor.listed;
    motor = {.generation = motor.generation};
    motor.listed = listed;
    motor.slot = slot;
    motor.joint = &joint;
    instance.joints.push_back({index, motor.generation});
  }
  order_.push_back(slot);
  drives_[slot] = {};
  settle(slot, declared.X_WM);
  return InstanceId{slot, instance.generation};
}

void PlanarEngine::remove(InstanceId id) {
  get(id);
  let_go(id.index);
  Instance& instance = instances_[id.index];
  for (const BodyId body : instance.bodies) {
    ++body_generation_[body.index];
    body_slot_[body.index] = none;
  }
  for (const JointId joint : instance.joints) {
    end_roll(joint.index);
    Motor& motor = motors_[joint.index];
    const bool listed = motor.listed;
    motor = {.generation = motor.generation + 1};
    motor.listed = listed;
    joint_states_[joint.index] = {};
  }
  // Backwards, so that the next model of the same kind gets its indices in order.
  for (std::size_t i = instance.bodies.size(); i-- > 0;) free_bodies_.push_back(instance.bodies[i].index);
  for (std::size_t i = instance.joints.size(); i-- > 0;) free_joints_.push_back(instance.joints[i].index);
  free_groups(instance);
  walls_fresh_ = walls_fresh_ && instance.moves;
  std::erase_if(contact_points_, [&](const ContactPoint& t) {
    return t.key.pair >> 32 == instance.created || (t.key.pair & 0xffffffffu) == instance.created;
  });
  const std::uint32_t generation = instance.generation + 1;
  instance = {};
  instance.generation = generation;
  summaries_[id.index] = {};
  order_.erase(std::find(order_.begin(), order_.end(), id.index));
  free_instances_.push_back(id.index);
  filed_ = ground_fresh_ = false;
  stale();
}

std::uint32_t PlanarEngine::slot_of(BodyId id) const {
  SL_CHECK(id.index < body_slot_.size());
  SL_CHECK_MSG(alive(id), "no such body");
  return body_slot_[id.index];
}

bool PlanarEngine::alive(BodyId id) const {
  return id.index < body_slot_.size() && body_slot_[id.index] != none &&
         id.generation == body_generation_[id.index];
}

std::span<const BodyState> PlanarEngine::states() const {
  refresh_links();
  return states_;
}

/// Sets the frame in which the drive's velocities are given: that of `link`, as declared.
void PlanarEngine::aim(std::uint32_t slot, std::uint32_t link) {
  const Instance& instance = instances_[slot];
  const auto& links = instance.model->links;
  const Pose X_BL = inverse(links[0].X_ML) * links[link].X_ML;
  const Vec3 arm = rotate(instance.tilt, X_BL.p), x = rotate(instance.tilt, rotate(X_BL.q, {1, 0, 0}));
  Drive& drive = drives_[slot];
  drive.link = link;
  const Vec2 com = instance.plan->groups[0].com_H;
  drive.arm = Vec2{arm.x, arm.y} - com;
  const double n = std::sqrt(x.x * x.x + x.y * x.y);
  drive.frame = n > 1e-6 ? Turn{x.x / n, x.y / n} : Turn{};
}

void PlanarEngine::set_drive_targets(std::span<const DriveTarget> targets) {
  for (const DriveTarget& t : targets) {
    const std::uint32_t slot = slot_of(t.base);
    const Instance& instance = instances_[slot];
    if (!instance.moves || instance.guided) continue;
    Drive& drive = drives_[slot];
    if (instance.bodies[drive.link] != t.base)
      for (std::uint32_t link = 0; link < instance.bodies.size(); ++link)
        if (instance.bodies[link] == t.base) aim(slot, link);
    if (t.active && !drive.active) {
      // It goes on at the velocity that it has.
      const RigidGroup& group = groups_[instance.groups[0]];
      drive.now = {
          rotate_back(group.heading * drive.frame, group.velocity_at(rotate(group.heading, drive.arm))),
          group.w_radps};
      for (const Wheel& wheel : instance.wheels)
        for (const std::uint32_t joint : {wheel.joint, wheel.steering})
          if (joint != none && !motors_[joint].listed)
            motors_[joint].listed = true, turning_.push_back(joint);
    }
    if (!t.active && drive.active)
      for (const JointId joint : instance.joints) end_roll(joint.index);
    drive.active = t.active;
    drive.target = {{t.vx_mps, t.vy_mps}, t.wz_radps};
    drive.accel = t.max_accel_mps2;
    drive.angular_accel = t.max_angular_accel_radps2;
  }
}

void PlanarEngine::set_targets(std::span<const JointTarget> targets) {
  for (const JointTarget& t : targets) {
    SL_CHECK(t.joint.index < motors_.size());
    Motor& motor = motors_[t.joint.index];
    SL_CHECK_MSG(t.joint.generation == motor.generation, "no such joint");
    end_roll(t.joint.index);
    motor.target = t;
    if (motor.listed || t.mode != JointTarget::Mode::velocity || motor.role == Motor::Role::constraint)
      continue;
    motor.listed = true;
    turning_.push_back(t.joint.index);
  }
}

void PlanarEngine::apply(std::span<const Wrench> wrenches) {
  for (const Wrench& w : wrenches) {
    const Instance& instance = instances_[slot_of(w.body)];
    if (!instance.moves || instance.guided) continue;
    for (std::uint32_t link = 0; link < instance.bodies.size(); ++link) {
      if (instance.bodies[link] != w.body) continue;
      // The force acts at the link's centre of mass, which need not be the group's.
      RigidGroup& group = groups_[instance.groups[instance.plan->group_of_link[link]]];
      const Vec3 at = instance.plan->X_HL[link] * instance.model->links[link].inertial.X_LCo.p;
      const Vec2 arm = rotate(group.heading, Vec2{at.x, at.y} - instance.plan->groups[group.index].com_H);
      const Vec2 force{w.force_N.x, w.force_N.y};
      group.force_N = group.force_N + force;
      if (group.rolls)  // a torque that rolls it pushes like a force at its middle
        group.force_N = group.force_N +
                        (1 / group.plan->supports[0].ball_radius_m) * Vec2{w.torque_Nm.y, -w.torque_Nm.x};
      group.torque_Nm += w.torque_Nm.z + cross(arm, force);
    }
  }
}

void PlanarEngine::overlaps(std::span<const OverlapQuery> queries, std::vector<std::uint32_t>& out,
                            std::vector<std::uint32_t>& ends) const {
  refresh_map();
  for (const OverlapQuery& query : queries) {
    map_.overlaps(query, out);
    ends.push_back(static_cast<std::uint32_t>(out.size()));
  }
}

void PlanarEngine::cast(std::span<const RayJob> jobs) const {
  refresh_map();
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (i + 1 < jobs.size()) map_.expect(jobs[i + 1]);
    const RayJob& job = jobs[i];
    SL_CHECK(job.distance_m.size() == job.directions.size());
    SL_CHECK(job.body.empty() || job.body.size() == job.directions.size());
    map_.cast(job, job.ignore_body < body_slot_.size() ? body_slot_[job.ignore_body] : none);
  }
}

void PlanarEngine::refresh_walls() const {
  if (walls_fresh_) return;
  std::vector<Wall> walls;
  std::vector<Edge> edges;
  std::vector<Outline> outlines;
  floors_.clear();
  for (const std::uint32_t slot : order_) {
    const Instance& instance = instances_[slot];
    if (instance.moves) continue;
    const Pose X_WM = Pose{{instance.still->at.x, instance.still->at.y, instance.z_m}, instance.still->q} *
                      inverse(instance.model->links[0].X_ML);
    std::uint32_t ordinal = 0;
    for (std::size_t i = 0; i < instance.bodies.size(); ++i) {
      const model::Link& link = instance.model->links[i];
      for (const model::Collision& collision : link.collisions) {
        if (!collision.surface.touches) continue;
        outlines.clear();
        const Pose X_WC = X_WM * link.X_ML * collision.X_LC;
        add_outlines(collision.shape, X_WC, outlines, edges);
        const bool upright = std::abs(rotate(X_WC.q, {0, 0, 1}).z) > 0.999;
        const ContactFace face{&collision.surface, &collision, slot, static_cast<std::uint32_t>(i)};
        if (std::holds_alternative<Plane>(collision.shape)) floors_.push_back({X_WC.p.z, face});
        else if (upright && outlines.size() == 1 &&
                 (std::holds_alternative<Box>(collision.shape) ||
                  std::holds_alternative<Cylinder>(collision.shape)))
          floors_.push_back({outlines[0].heights.max_m, face, static_cast<std::uint32_t>(walls.size())});
        for (const Outline& outline : outlines)
          walls.push_back({outline, instance.bodies[i].index, slot, ordinal++, &collision, face.link});
      }
    }
  }
  map_.set_walls(walls, edges);
  walls_fresh_ = true;
  filed_ = ground_fresh_ = false;
}

void PlanarEngine::refresh_map() const {
  if (map_fresh_.load(std::memory_order_acquire)) return;
  const std::lock_guard lock(refreshing_);
  if (map_fresh_.load(std::memory_order_relaxed)) return;
  refresh_walls();
  map_.file_discs();
  map_fresh_.store(true, std::memory_order_release);
}

void PlanarEngine::refresh_links() const {
  if (links_fresh_.load(std::memory_order_acquire)) return;
  refresh_rolls();
  const std::lock_guard lock(refreshing_);
  if (links_fresh_.load(std::memory_order_relaxed)) return;
  states_.resize(body_slot_.size());
  for (const std::uint32_t slot : order_) {
    const Instance& instance = instances_[slot];
    states_[instance.bodies[0].index] = canonical_state(slot);
    if (instance.bodies.size() > 1)
      instance.kinematics->place(instance.bodies, instance.joints, joint_states_, states_);
  }
  links_fresh_.store(true, std::memory_order_release);
}

BodyState PlanarEngine::canonical_state(std::uint32_t slot) const {
  BodyState base{canonical_pose(slot), {}};
  const Instance& instance = instances_[slot];
  if (!instance.moves) return base;
  const RigidGroup& group = groups_[instance.groups[0]];
  const Vec2 v = group.velocity_at(rotate(group.heading, -1.0 * instance.plan->groups[0].com_H));
  base.V_WB = {{v.x, v.y, 0}, {0, 0, group.w_radps}};
  return base;
}

/// Asks for the memory of an instance that is needed some instances later.
void PlanarEngine::expect(std::uint32_t slot) const {
  if (slot == none) return;
  prefetch(&instances_[slot], 1);
  if (const std::uint32_t group = summaries_[slot].group; group != none) prefetch(&groups_[group], 1);
}

/// Sensors mostly sit on canonical links, whose states need no tree of joints and no memory.
void PlanarEngine::states_of(std::span<const std::uint32_t> bodies, std::span<BodyState> out) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i + 4 < bodies.size()) expect(body_slot_[bodies[i + 4]]);
    const std::uint32_t slot = body_slot_[bodies[i]];
    SL_CHECK_MSG(slot != none, "no such body");
    out[i] = body_is_first_[bodies[i]] ? canonical_state(slot) : states()[bodies[i]];
  }
}

EngineCounters PlanarEngine::counters() const {
  EngineCounters counters;
  counters.contacts = contacts_.size();
  for (const std::uint32_t slot : order_)
    if (instances_[slot].moves) counters.awake_bodies += instances_[slot].bodies.size();
  return counters;
}

Result<std::unique_ptr<Engine>> create(const Node& config, Vec3 gravity) {
  SL_ASSIGN(const Spec spec, read_spec<Spec>(config, "/physics"));
  return std::unique_ptr<Engine>(std::make_unique<PlanarEngine>(spec, gravity));
}

extern const EngineKind engine;
const EngineKind engine{"planar", "Bodies, wheels and joints in two dimensions: flat and fast.",
                        [] { return describe_fields<Spec>(); }, create};

}  // namespace sandlot::planar
