#include "physics/planar/planar.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
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

/// Heading of a rotation about z.
Turn heading_of(Quat q, Quat& tilt) {
  const double n = std::sqrt(q.w * q.w + q.z * q.z);
  if (n < 1e-9) {  // upside down: any heading will do
    tilt = q;
    return {};
  }
  const double w = q.w / n, z = q.z / n;
  tilt = normalised(Quat{n, w * q.x + z * q.y, w * q.y - z * q.x, 0});
  return tidied({w * w - z * z, 2 * w * z});
}

Quat about_z(Turn t) {
  if (t.c >= 0) {
    const double w = std::sqrt(0.5 * (1 + t.c));
    return {w, 0, 0, 0.5 * t.s / w};
  }
  const double z = std::copysign(std::sqrt(0.5 * (1 - t.c)), t.s);
  return {0.5 * t.s / z, 0, 0, z};
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

}  // namespace

Capabilities PlanarEngine::capabilities() const {
  return {.name = "planar",
          .planar = true,
          .joints = false,
          .contact_drives = false,
          .ideal_drives = true,
          .rays = true};
}

BodyName PlanarEngine::name(BodyId id) const {
  if (id.index >= body_slot_.size() || body_generation_[id.index] != id.generation) return {};
  const Instance& instance = instances_[body_slot_[id.index]];
  for (std::size_t l = 0; l < instance.bodies.size(); ++l)
    if (instance.alive && instance.bodies[l] == id) return {instance.name, &instance.model->links[l]};
  return {};
}

const PlanarEngine::Instance& PlanarEngine::get(InstanceId id) const {
  SL_CHECK(id.index < instances_.size());
  const Instance& instance = instances_[id.index];
  SL_CHECK(instance.alive && instance.generation == id.generation);
  return instance;
}

Result<InstanceId> PlanarEngine::add(const model::Instance& declared) {
  SL_TRY(check(declared));
  const model::Model& model = *declared.model;
  if (last_model_ != declared.model) {
    last_model_ = declared.model;
    last_tree_ = std::make_shared<const Tree>(model);
  }
  const std::uint32_t slot = take_index(free_instances_, instances_);
  bases_.resize(instances_.size());
  drives_.resize(instances_.size());
  map_.discs().resize(instances_.size());
  Instance& instance = instances_[slot];
  instance.alive = true;
  instance.guided = declared.motion.has_value();
  instance.moves = instance.guided || !stands_still(model);
  instance.created = created_++;
  instance.name = declared.name;
  instance.model = declared.model;
  instance.tree = last_tree_;
  double mass_kg = 0;
  for (const model::Link& link : model.links) {
    mass_kg += link.inertial.mass_kg;
    const std::uint32_t body = take_index(free_bodies_, body_slot_);
    body_generation_.resize(body_slot_.size());
    states_.resize(body_slot_.size());
    body_slot_[body] = slot;
    instance.bodies.push_back(body_id(body));
  }
  instance.inverse_mass_per_kg = instance.guided ? 0 : 1 / std::max(mass_kg, 1e-9);
  for (const model::Joint& joint : model.joints) {
    const std::uint32_t index = take_index(free_joints_, motors_);
    joint_states_.resize(motors_.size());
    joint_states_[index] = {};
    Motor& motor = motors_[index];
    motor = {.generation = motor.generation, .max_velocity = joint.max_velocity};
    const bool bounded = joint.type == model::JointType::revolute ||
                         joint.type == model::JointType::prismatic;
    motor.lower = bounded ? joint.lower : -std::numeric_limits<double>::infinity();
    motor.upper = bounded ? joint.upper : std::numeric_limits<double>::infinity();
    if (joint.type == model::JointType::fixed || joint.type == model::JointType::ball) motor.max_velocity = 0;
    instance.joints.push_back({index, motor.generation});
  }
  order_.push_back(slot);
  drives_[slot] = {};
  settle(slot, declared.X_WM);
  return InstanceId{slot, instance.generation};
}

/// Puts an instance to a place, at rest.
void PlanarEngine::settle(std::uint32_t slot, const Pose& X_WM) {
  Instance& instance = instances_[slot];
  const Pose X_WB = X_WM * instance.model->links[0].X_ML;
  bases_[slot] = {{X_WB.p.x, X_WB.p.y}, heading_of(X_WB.q, instance.tilt), {}, 0};
  instance.z_m = X_WB.p.z;
  drives_[slot].now = {};
  shape(slot);
}

/// What follows from attitude and height: the disc and the frame of the drive.
void PlanarEngine::shape(std::uint32_t slot) {
  Instance& instance = instances_[slot];
  const model::Model& model = *instance.model;
  const Base& base = bases_[slot];
  aim(slot, drives_[slot].link);
  Disc& disc = map_.discs()[slot];
  disc = {.centre = base.p, .body = instance.bodies[0].index};
  instance.offset = {};
  walls_fresh_ = walls_fresh_ && instance.moves;
  stale();
  if (!instance.moves) return;
  const Pose X_HM = Pose{{0, 0, instance.z_m}, instance.tilt} * inverse(model.links[0].X_ML);
  std::vector<Round>& hull = hull_;
  hull.clear();
  for (const model::Link& link : model.links)
    for (const model::Collision& collision : link.collisions) {
      const Pose X_HC = X_HM * link.X_ML * collision.X_LC;
      add_shadow(collision.shape, X_HC, hull);
      disc.heights.add(heights_of(collision.shape, X_HC));
    }
  if (hull.empty()) return;
  Vec2 low = hull[0].centre, high = low;
  for (const Round& r : hull) {
    low = {std::min(low.x, r.centre.x - r.radius_m), std::min(low.y, r.centre.y - r.radius_m)};
    high = {std::max(high.x, r.centre.x + r.radius_m), std::max(high.y, r.centre.y + r.radius_m)};
  }
  instance.offset = 0.5 * (low + high);
  for (const Round& r : hull) {
    const Vec2 out = r.centre - instance.offset;
    disc.radius_m = std::max(disc.radius_m, std::sqrt(dot(out, out)) + r.radius_m);
  }
  disc.centre = base.p + rotate(base.heading, instance.offset);
}

void PlanarEngine::remove(InstanceId id) {
  get(id);
  Instance& instance = instances_[id.index];
  for (const BodyId body : instance.bodies) {
    ++body_generation_[body.index];
    body_slot_[body.index] = ~0u;
  }
  for (const JointId joint : instance.joints) {
    motors_[joint.index] = {.generation = motors_[joint.index].generation + 1};
    joint_states_[joint.index] = {};
  }
  // Backwards, so that the next model of the same kind gets its indices in order.
  for (std::size_t i = instance.bodies.size(); i-- > 0;) free_bodies_.push_back(instance.bodies[i].index);
  for (std::size_t i = instance.joints.size(); i-- > 0;) free_joints_.push_back(instance.joints[i].index);
  walls_fresh_ = walls_fresh_ && instance.moves;
  instance = {.generation = instance.generation + 1};
  map_.discs()[id.index] = {};
  order_.erase(std::find(order_.begin(), order_.end(), id.index));
  free_instances_.push_back(id.index);
  stale();
}

void PlanarEngine::set_pose(InstanceId id, const Pose& X_WM) {
  get(id);
  settle(id.index, X_WM);
}

void PlanarEngine::guide(InstanceId id, const Pose& X_WM, const Velocity& V_WM) {
  SL_CHECK_MSG(get(id).guided, "guide() needs an instance with a motion");
  instances_[id.index].destination = {X_WM, V_WM};
}

/// Takes a guided instance where it is to be.
void PlanarEngine::lead(std::uint32_t slot) {
  Instance& instance = instances_[slot];
  Base& base = bases_[slot];
  base.v = {};
  base.w_radps = 0;
  if (!instance.destination) return;
  const auto [X_WM, V] = *instance.destination;
  instance.destination.reset();
  const Pose X_WB = X_WM * instance.model->links[0].X_ML;
  const Vec3 v = V.linear + cross(V.angular, X_WB.p - X_WM.p);
  Quat tilt;
  base = {{X_WB.p.x, X_WB.p.y}, heading_of(X_WB.q, tilt), {v.x, v.y}, V.angular.z};
  const Quat change = conjugate(instance.tilt) * tilt;
  // Rounding alone does not make a new outline.
  if (std::abs(X_WB.p.z - instance.z_m) > 1e-9 || norm(Vec3{change.x, change.y, change.z}) > 1e-9) {
    instance.tilt = tilt;
    instance.z_m = X_WB.p.z;
    shape(slot);
  }
  map_.discs()[slot].centre = base.p + rotate(base.heading, instance.offset);
}

Pose PlanarEngine::canonical_pose(std::uint32_t slot) const {
  const Base& base = bases_[slot];
  const Instance& instance = instances_[slot];
  return {{base.p.x, base.p.y, instance.z_m}, about_z(base.heading) * instance.tilt};
}

Pose PlanarEngine::pose(InstanceId id) const {
  return canonical_pose(id.index) * inverse(get(id).model->links[0].X_ML);
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
  drive.arm = {arm.x, arm.y};
  const double n = std::sqrt(x.x * x.x + x.y * x.y);
  drive.frame = n > 1e-6 ? Turn{x.x / n, x.y / n} : Turn{};
}

void PlanarEngine::set_drive_targets(std::span<const DriveTarget> targets) {
  for (const DriveTarget& t : targets) {
    SL_CHECK(t.base.index < body_slot_.size());
    const std::uint32_t slot = body_slot_[t.base.index];
    SL_CHECK_MSG(slot != ~0u && t.base.generation == body_generation_[t.base.index], "no such body");
    if (!instances_[slot].moves || instances_[slot].guided) continue;
    const Instance& instance = instances_[slot];
    Drive& drive = drives_[slot];
    if (instance.bodies[drive.link] != t.base)
      for (std::uint32_t link = 0; link < instance.bodies.size(); ++link)
        if (instance.bodies[link] == t.base) aim(slot, link);
    drive.active = t.active;
    if (!t.active) drive.now = {};
    drive.target = {{t.vx_mps, t.vy_mps}, t.wz_radps};
    drive.accel = t.max_accel_mps2;
    drive.angular_accel = t.max_angular_accel_radps2;
  }
}

void PlanarEngine::set_targets(std::span<const JointTarget> targets) {
  for (const JointTarget& t : targets) {
    SL_CHECK(t.joint.index < motors_.size());
    SL_CHECK_MSG(t.joint.generation == motors_[t.joint.index].generation, "no such joint");
    Motor& motor = motors_[t.joint.index];
    motor.active = t.mode == JointTarget::Mode::velocity && t.max_effort > 0;
    motor.velocity = t.velocity;
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
  for (const RayJob& job : jobs) {
    SL_CHECK(job.distance_m.size() == job.directions.size());
    SL_CHECK(job.body.empty() || job.body.size() == job.directions.size());
    map_.cast(job, job.ignore_body < body_slot_.size() ? body_slot_[job.ignore_body] : ~0u);
  }
}

void PlanarEngine::refresh_walls() const {
  if (walls_fresh_) return;
  std::vector<Wall> walls;
  std::vector<Edge> edges;
  std::vector<Outline> outlines;
  for (const std::uint32_t slot : order_) {
    const Instance& instance = instances_[slot];
    if (instance.moves) continue;
    const Pose X_WM = canonical_pose(slot) * inverse(instance.model->links[0].X_ML);
    for (std::size_t i = 0; i < instance.bodies.size(); ++i) {
      const model::Link& link = instance.model->links[i];
      outlines.clear();
      for (const model::Collision& collision : link.collisions)
        add_outlines(collision.shape, X_WM * link.X_ML * collision.X_LC, outlines, edges);
      for (const Outline& outline : outlines) walls.push_back({outline, instance.bodies[i].index, slot});
    }
  }
  map_.set_walls(walls, edges);
  walls_fresh_ = true;
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
  const std::lock_guard lock(refreshing_);
  if (links_fresh_.load(std::memory_order_relaxed)) return;
  for (const std::uint32_t slot : order_) {
    const Instance& instance = instances_[slot];
    const Base& base = bases_[slot];
    states_[instance.bodies[0].index] = {canonical_pose(slot),
                                         {{base.v.x, base.v.y, 0}, {0, 0, base.w_radps}}};
    if (instance.bodies.size() > 1)
      instance.tree->place(instance.bodies, instance.joints, joint_states_, states_);
  }
  links_fresh_.store(true, std::memory_order_release);
}

Status PlanarEngine::check_finite() const {
  for (const std::uint32_t slot : order_) {
    const Base& b = bases_[slot];
    double sum = b.p.x + b.p.y + b.heading.c + b.heading.s + b.v.x + b.v.y + b.w_radps + instances_[slot].z_m;
    for (const JointId joint : instances_[slot].joints)
      sum += joint_states_[joint.index].position + joint_states_[joint.index].velocity;
    if (!std::isfinite(sum))
      return Error{"the state of '" + instances_[slot].name + "/" + instances_[slot].model->links[0].name +
                   "' is no longer finite"};
  }
  return {};
}

EngineCounters PlanarEngine::counters() const {
  EngineCounters counters;
  counters.contacts = contacts_.size();
  for (const std::uint32_t slot : order_)
    if (instances_[slot].moves) counters.awake_bodies += instances_[slot].bodies.size();
  return counters;
}

Result<std::unique_ptr<Engine>> create(const Node& config, Vec3) {
  SL_ASSIGN(const Spec spec, read_spec<Spec>(config, "/physics"));
  return std::unique_ptr<Engine>(std::make_unique<PlanarEngine>(spec));
}

extern const EngineKind engine;
const EngineKind engine{"planar", "discs, walls and ideal drives in two dimensions",
                        [] { return describe_fields<Spec>(); }, create};

}  // namespace sandlot::planar
