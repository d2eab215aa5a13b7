#include <algorithm>

#include "base/check.h"
#include "geometry/barrel.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "model/rollers.h"
#include "physics/rigid/joints.h"
#include "physics/rigid/library.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/rigid/wheels.h"

namespace sandlot::rigid {
namespace {

// ODE tests pairs of shapes whose bits meet: what stands never meets what stands.
constexpr unsigned long standing_bit = 1, moving_bit = 2;

constexpr bool positive(double x) { return x > 1e-12 && x < 1e12; }

/// A coefficient that is divided by where it is not 0.
constexpr bool is_coefficient(double x) { return x == 0 || (x >= 1e-30 && x <= 1e30); }
/// A limit; 1e16 is none (model/joint.h).
constexpr bool is_limit(double x) { return x >= 0 && x <= 1e16; }

bool has_size(const Shape& shape) {
  struct {
    bool operator()(const Box& b) const {
      return positive(b.size_m.x) && positive(b.size_m.y) && positive(b.size_m.z);
    }
    bool operator()(const Sphere& s) const { return positive(s.radius_m); }
    bool operator()(const Cylinder& c) const { return positive(c.radius_m) && positive(c.length_m); }
    bool operator()(const Capsule& c) const { return positive(c.radius_m) && positive(c.length_m); }
    bool operator()(const Barrel& b) const { return is_barrel(b); }
    bool operator()(const Plane& p) const { return is_finite(p.normal) && norm(p.normal) > 0; }
    bool operator()(const Cone& c) const { return positive(c.radius_m) && positive(c.length_m); }
    bool operator()(const Ellipsoid& e) const {
      return positive(e.radii_m.x) && positive(e.radii_m.y) && positive(e.radii_m.z);
    }
    bool operator()(const Mesh& m) const {
      if (!m.mesh || m.mesh->triangles.empty()) return false;
      const auto& corners = m.mesh->vertices;
      return std::all_of(corners.begin(), corners.end(), [](Vec3 v) { return norm(v) < 1e12; }) &&
             std::all_of(m.mesh->triangles.begin(), m.mesh->triangles.end(), [&](const auto& t) {
               return std::max({t[0], t[1], t[2]}) < corners.size();
             });
    }
    bool operator()(const Heightfield& h) const {
      return h.grid && h.grid->columns > 1 && h.grid->rows > 1 && positive(h.grid->size_x_m) &&
             positive(h.grid->size_y_m) &&
             h.grid->height_m.size() ==
                 static_cast<std::size_t>(h.grid->columns) * static_cast<std::size_t>(h.grid->rows) &&
             std::all_of(h.grid->height_m.begin(), h.grid->height_m.end(),
                         [](float z) { return std::abs(z) < 1e9f; });
    }
  } visitor;
  return std::visit(visitor, shape);
}

struct MakeGeom {
  const Triangles* triangles;

  dGeomID operator()(const Box& b) const { return dCreateBox(nullptr, b.size_m.x, b.size_m.y, b.size_m.z); }
  dGeomID operator()(const Sphere& s) const { return dCreateSphere(nullptr, s.radius_m); }
  dGeomID operator()(const Cylinder& c) const { return dCreateCylinder(nullptr, c.radius_m, c.length_m); }
  dGeomID operator()(const Capsule& c) const { return dCreateCapsule(nullptr, c.radius_m, c.length_m); }
  /// For its bounds alone: ODE has no barrels and never collides one.
  dGeomID operator()(const Barrel& b) const { return dCreateCylinder(nullptr, b.radius_m, b.length_m); }
  dGeomID operator()(const Plane&) const { return dCreatePlane(nullptr, 0, 0, 1, 0); }
  template <class OfTriangles>
  dGeomID operator()(const OfTriangles&) const {
    return triangles->make_geom();
  }
};

/// Finite, and turned by a quaternion of length 1: the library takes no other.
bool is_sound(const Pose& X) { return is_finite(X) && std::abs(norm(X.q) - 1) < 1e-6; }

/// Lets slots grow only where none is free; the newest free one is used again first.
std::uint32_t take_slot(std::vector<std::uint32_t>& free, std::size_t size) {
  if (free.empty()) return static_cast<std::uint32_t>(size);
  const std::uint32_t index = free.back();
  free.pop_back();
  return index;
}

}  // namespace

Instance& RigidEngine::alive(InstanceId id) const {
  SL_CHECK_MSG(
      id.index < slots_.size() && slots_[id.index].generation == id.generation && slots_[id.index].instance,
      "no such instance");
  return *slots_[id.index].instance;
}

Status RigidEngine::check(const model::Instance& instance) const {
  const model::Model& model = *instance.model;
  SL_CHECK(!model.links.empty());
  if (!is_finite(instance.X_WM) || !std::isfinite(norm(instance.X_WM.q)))
    return Error{"the pose of '" + instance.name + "' is not finite", "", instance.place};
  for (const model::Link& link : model.links) {
    if (!is_sound(link.X_ML) || !is_sound(link.inertial.X_LCo))
      return Error{"a pose of link '" + link.name + "' is not finite, or its quaternion not of length 1", "",
                   link.place};
    for (const model::Collision& c : link.collisions) {
      if (!has_size(c.shape) || !is_sound(c.X_LC))
        return Error{"collision '" + c.name + "' has no valid size or pose", "sizes are positive numbers [m]",
                     c.place};
    }
  }
  for (const model::Joint& joint : model.joints) {
    SL_CHECK(joint.child < model.links.size());
    SL_CHECK(joint.parent < model.links.size() || joint.parent == model::world_link);
    if (!is_sound(joint.X_CJ))
      return Error{"the pose of joint '" + joint.name + "' is not finite, or its quaternion not of length 1",
                   "", joint.place};
    if (joint.parent == joint.child)
      return Error{"joint '" + joint.name + "' joins a link to itself", "name two links", joint.place};
    if (!(std::abs(norm(joint.axis_J) - 1) < 1e-6) && joint.type != model::JointType::fixed)
      return Error{"the axis of joint '" + joint.name + "' has no length", "give it a direction",
                   joint.place};
    if (joint.type == model::JointType::ball && joint.spring_stiffness > 0)
      return Error{"the engine 'rigid' has no springs on ball joints",
                   "remove the stiffness of '" + joint.name + "'", joint.place};
    if (joint.type == model::JointType::universal) {
      if (!joint.second || !(std::abs(norm(joint.second->axis_J) - 1) < 1e-6) ||
          !(std::abs(dot(joint.second->axis_J, joint.axis_J)) < 1e-3))
        return Error{"the axes of universal joint '" + joint.name + "' are not across each other",
                     "give it two axes at a right angle", joint.place};
      if (!(joint.second->lower <= joint.second->upper))
        return Error{"joint '" + joint.name + "' has its lower limit above its upper one", "exchange them",
                     joint.place};
      if (!is_coefficient(joint.second->damping) || !is_coefficient(joint.second->friction))
        return Error{"joint '" + joint.name + "' has a negative damping or friction, or one beyond 1e30",
                     "0 switches it off", joint.place};
    }
    if (!(std::abs(joint.thread_pitch_m) < 1e6))
      return Error{"the thread pitch of joint '" + joint.name + "' is not a length",
                   "give it in metres per turn", joint.place};
    if (joint.rollers && !model::is_wheel(*joint.rollers))
      return Error{"the wheel with rollers of joint '" + joint.name + "' has no sound sizes",
                   "lengths are positive numbers [m]", joint.place};
    if (joint.roller_of != model::Joint::no_joint &&
        (joint.roller_of >= model.joints.size() || !model.joints[joint.roller_of].rollers ||
         joint.type != model::JointType::continuous))
      return Error{"joint '" + joint.name + "' is that of a roller, but of no wheel", "", joint.place};
    if (joint.mimic) {
      const std::uint32_t leader = joint.mimic->joint;
      const auto has_position = [](const model::Joint& j) {
        return j.type != model::JointType::fixed && j.type != model::JointType::ball;
      };
      if (leader >= model.joints.size() || &model.joints[leader] == &joint ||
          !has_position(model.joints[leader]) || !has_position(joint))
        return Error{"joint '" + joint.name + "' cannot follow what it is to follow",
                     "a joint with an axis follows another one of its model", joint.place};
      if (!(std::abs(joint.mimic->multiplier) < 1e9 && std::abs(joint.mimic->offset) < 1e9 &&
            std::abs(joint.mimic->reference) < 1e9))
        return Error{"the multiplier or offset of mimic joint '" + joint.name + "' is not a sound number", "",
                     joint.place};
    }
    const bool bounded = joint.type != model::JointType::fixed && joint.type != model::JointType::ball &&
                         joint.type != model::JointType::continuous;
    if (bounded && !(joint.lower <= joint.upper))
      return Error{"joint '" + joint.name + "' has its lower limit above its upper one", "exchange them",
                   joint.place};
    if (!is_coefficient(joint.damping) || !is_coefficient(joint.friction) ||
        !is_coefficient(joint.spring_stiffness))
      return Error{
          "joint '" + joint.name + "' has a negative damping, friction or stiffness, or one beyond 1e30",
          "0 switches it off", joint.place};
    if (!is_limit(joint.max_effort) || !is_limit(joint.max_velocity) ||
        !(std::abs(joint.spring_reference) <= 1e16))
      return Error{"the largest effort or velocity of joint '" + joint.name +
                       "', or the reference of its spring, is not a sound number",
                   "limits are from 0 to 1e16", joint.place};
  }
  return {};
}

Result<InstanceId> RigidEngine::add(const model::Instance& declared) {
  library::prepare_thread();
  SL_TRY(check(declared));
  const model::Model& model = *declared.model;
  SL_ASSIGN(RigidGroups groups, group_links(model, declared.motion.has_value()));
  lock_rollers(model, groups);
  SL_TRY(check_masses(model, groups));
  for (const RigidGroup& group : groups.groups)
    for (const std::uint32_t l : group.links)
      for (const model::Collision& c : model.links[l].collisions)
        if (!group.fixed &&
            (std::holds_alternative<Plane>(c.shape) || std::holds_alternative<Heightfield>(c.shape)))
          return Error{"collision '" + c.name + "' is a " + shape_name(c.shape) + " on a body that moves",
                       "make the model static, or use a box", c.place};

  const std::uint32_t slot = take_slot(free_instances_, slots_.size());
  if (slot == slots_.size()) slots_.emplace_back();
  slots_[slot].instance = std::make_unique<Instance>();
  Instance& instance = *slots_[slot].instance;
  instance.id = {slot, slots_[slot].generation};
  instance.name = declared.name;
  instance.model = declared.model;
  instance.is_robot = declared.is_robot;
  instance.guided = declared.motion.has_value();
  make_bodies(instance, groups);
  give_ids(instance);
  make_geoms(instance);
  order_.push_back(&instance);
  place(instance, {declared.X_WM.p, normalised(declared.X_WM.q)});
  if (instance.bodies.empty()) wake_neighbours(instance);
  return instance.id;
}

void RigidEngine::make_bodies(Instance& instance, const RigidGroups& groups) {
  const model::Model& model = *instance.model;
  std::vector<Body*> of_group(groups.groups.size(), nullptr);
  instance.bodies.reserve(groups.groups.size());
  for (std::size_t i = 0; i < groups.groups.size(); ++i) {
    const RigidGroup& group = groups.groups[i];
    if (group.fixed) continue;
    Body& body = instance.bodies.emplace_back();
    of_group[i] = &body;
    body.instance = &instance;
    body.mass_kg = group.mass_kg;
    instance.mass_kg += group.mass_kg;
    body.inertia_B = group.inertia_B;
    body.X_MB = group.X_MB;
    body.gravity_mass_kg = group.gravity_mass_kg;
    body.gravity_point_B = group.gravity_point_B;
    body.weighs_partly = group.gravity_mass_kg < group.mass_kg * (1 - 1e-12);
    body.ode = dBodyCreate(world_);
    dMass mass;
    const Symmetric3& t = body.inertia_B;
    dMassSetParameters(&mass, body.mass_kg, 0, 0, 0, t.xx, t.yy, t.zz, t.xy, t.xz, t.yz);
    dBodySetMass(body.ode, &mass);
    dBodySetGravityMode(body.ode, !body.weighs_partly);
    // The joints are made in the declared pose at the origin, so that their constants do not depend on the
    // place.
    body.p = body.X_MB.p;
    body.q = body.X_MB.q;
    put(body);
  }

  instance.links.resize(model.links.size());
  for (std::uint32_t l = 0; l < model.links.size(); ++l) {
    Link& link = instance.links[l];
    link.body = of_group[groups.of_link[l]];
    const RigidGroup& group = groups.groups[groups.of_link[l]];
    link.X_BL = model.links[l].X_ML;
    if (!link.body) continue;
    link.X_BL = inverse(link.body->X_MB) * model.links[l].X_ML;
    if (l == group.links.front()) link.X_BL.q = {};  // exactly: B takes its axes from this link
    if (group.links.size() == 1 && !group.has_rollers) link.X_BL.p = -model.links[l].inertial.X_LCo.p;
  }

  instance.joints.resize(model.joints.size());
  for (std::uint32_t i = 0; i < model.joints.size(); ++i) {
    Joint& joint = instance.joints[i];
    joint.decl = &model.joints[i];
    joint.child = instance.links[joint.decl->child].body;
    const Pose X_MJ = model.links[joint.decl->child].X_ML * joint.decl->X_CJ;
    if (joint.decl->parent != model::world_link) joint.parent = instance.links[joint.decl->parent].body;
    joint.X_child = joint.child ? inverse(joint.child->X_MB) * X_MJ : X_MJ;
    joint.X_parent = joint.parent ? inverse(joint.parent->X_MB) * X_MJ : X_MJ;
    joint.X_child.q = normalised(joint.X_child.q);
    joint.X_parent.q = normalised(joint.X_parent.q);
    make_joint(world_, joint);
    if (!joint.main) continue;
    if (!joint.child || !joint.parent) instance.anchored = true;
    else instance.joined.emplace_back(joint.child, joint.parent);
    if (joint.decl->mimic) joint.leader = &instance.joints[joint.decl->mimic->joint];
    if (joint.turns() && !joint.is(model::JointType::universal) && joint.child &&
        joint.child->spin_axis_B == Vec3{})
      joint.child->spin_axis_B = rotate(joint.X_child.q, joint.decl->axis_J);
  }
  make_wheels(instance);
}

void RigidEngine::make_geoms(Instance& instance) {
  const model::Model& model = *instance.model;
  std::size_t count = 0, moving = 0;
  for (std::uint32_t l = 0; l < model.links.size(); ++l) {
    count += model.links[l].collisions.size();
    const Body* const body = instance.links[l].body;
    if (body && !body->carrier) moving += model.links[l].collisions.size();
  }
  count += instance.wheels.size();
  moving += instance.wheels.size();
  // One space for the moving shapes of a robot: the world sorts robots, not wheels. What stands is sorted one
  // by one, because the box around a house is not a bound for its walls.
  if (moving > 1) {
    instance.space = dSimpleSpaceCreate(space_);
    dSpaceSetCleanup(instance.space, 0);
  }
  instance.geoms.reserve(count);
  for (std::uint32_t l = 0; l < model.links.size(); ++l) {
    for (const model::Collision& c : model.links[l].collisions) {
      Geom& geom = make_geom(instance, l, c);
      geom.number_in_link = static_cast<std::uint32_t>(&c - model.links[l].collisions.data());
    }
  }
  for (Wheel& wheel : instance.wheels) {
    make_geom(instance, wheel.link, wheel.solid, &wheel).number_in_link = Contact::no_shape;
    for (Roller& roller : wheel.rollers)
      for (Geom& geom : instance.geoms)
        if (geom.body == roller.body) roller.geom = &geom;
  }
}

/// @param wheel  whose outside it is
Geom& RigidEngine::make_geom(Instance& instance, std::uint32_t link, const model::Collision& c,
                             Wheel* wheel) {
  Geom& geom = instance.geoms.emplace_back();
  geom.instance = &instance;
  geom.body = instance.links[link].body;
  geom.decl = &c;
  geom.wheel = wheel;
  geom.serial = next_serial_++;
  geom.link = instance.link_ids[link];
  geom.triangles = triangles_.of(c);
  geom.size_m = bounding_radius_m(c.shape);
  geom.X_BC = instance.links[link].X_BL * c.X_LC;
  geom.X_BC.q = normalised(geom.X_BC.q);
  if (geom.body && geom.body->carrier) return geom;
  geom.ode = wheel ? MakeGeom{nullptr}(wheel->probe) : std::visit(MakeGeom{geom.triangles.get()}, c.shape);
  dGeomSetData(geom.ode, &geom);
  const bool touches = c.surface.touches;
  dGeomSetCategoryBits(geom.ode, !touches ? 0 : geom.body ? moving_bit : standing_bit);
  dGeomSetCollideBits(geom.ode, !touches ? 0 : geom.body ? moving_bit | standing_bit : moving_bit);
  if (geom.body) {
    const Pose& X = geom.X_BC;
    dGeomSetBody(geom.ode, geom.body->ode);
    dGeomSetOffsetPosition(geom.ode, X.p.x, X.p.y, X.p.z);
    const dQuaternion q = {X.q.w, X.q.x, X.q.y, X.q.z};
    dGeomSetOffsetQuaternion(geom.ode, q);
  }
  dSpaceAdd(geom.body && instance.space ? instance.space : space_, geom.ode);
  return geom;
}

void RigidEngine::give_ids(Instance& instance) {
  for (std::uint32_t l = 0; l < instance.links.size(); ++l) {
    const std::uint32_t index = take_slot(free_links_, link_slots_.size());
    if (index == link_slots_.size()) {
      link_slots_.emplace_back();
      states_.emplace_back();
    }
    link_slots_[index].instance = &instance;
    link_slots_[index].link = l;
    instance.link_ids.push_back({index, link_slots_[index].generation});
  }
  for (std::uint32_t j = 0; j < instance.joints.size(); ++j) {
    const std::uint32_t index = take_slot(free_joints_, joint_slots_.size());
    if (index == joint_slots_.size()) {
      joint_slots_.emplace_back();
      joint_states_.emplace_back();
      loads_.emplace_back();
    }
    joint_slots_[index].instance = &instance;
    joint_slots_[index].joint = j;
    instance.joint_ids.push_back({index, joint_slots_[index].generation});
  }
}

void RigidEngine::remove(InstanceId id) {
  library::prepare_thread();
  Instance& instance = alive(id);
  forget_watch();
  let_go(instance);
  wake_neighbours(instance);
  std::erase_if(contacts_, [&](const Contact& c) {
    const auto mine = [&](BodyId b) { return link_slots_[b.index].instance == &instance; };
    return mine(c.a) || mine(c.b);
  });
  for (std::size_t i = instance.link_ids.size(); i-- > 0;) {
    LinkSlot& slot = link_slots_[instance.link_ids[i].index];
    ++slot.generation;
    slot.instance = nullptr;
    free_links_.push_back(instance.link_ids[i].index);
  }
  for (std::size_t i = instance.joint_ids.size(); i-- > 0;) {
    JointSlot& slot = joint_slots_[instance.joint_ids[i].index];
    ++slot.generation;
    slot.instance = nullptr;
    free_joints_.push_back(instance.joint_ids[i].index);
  }
  destroy(instance);
  std::erase(order_, &instance);
  ++slots_[id.index].generation;
  free_instances_.push_back(id.index);
  slots_[id.index].instance.reset();
}

void RigidEngine::destroy(Instance& instance) {
  for (Joint& joint : instance.joints) destroy_joint(joint);
  // The last one first: that is where a body's list of shapes begins, which ODE searches for each.
  for (std::size_t i = instance.geoms.size(); i-- > 0;)
    if (instance.geoms[i].ode) dGeomDestroy(instance.geoms[i].ode);
  if (instance.space) dSpaceDestroy(instance.space);
  for (Body& body : instance.bodies) dBodyDestroy(body.ode);
}

}  // namespace sandlot::rigid
