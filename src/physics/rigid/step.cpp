/// The sub-step. Between sub-steps the State is in Body, Joint and Instance alone; ODE gets what it needs
/// from there, so nothing that a restored engine could not know takes part:
///
///   1 forces      from outside, of joints and drives, into ODE; orientations written again
///   2 contacts    found, put in order of creation, attached
///   3 islands     our own union-find: which solver, who may sleep
///   4 solve       ODE computes new velocities and positions
///   5 advance     State read back; orientation integrated by us (exactly, and with base/math.h)
///   6 sleep
#include <algorithm>
#include <limits>

#include "base/check.h"
#include "base/math.h"

#include "physics/rigid/drive.h"
#include "physics/rigid/joints.h"
#include "physics/rigid/library.h"
#include "physics/rigid/ode_vector.h"
#include "physics/rigid/rigid_engine.h"
#include "physics/rigid/wheels.h"

namespace sandlot::rigid {
namespace {

/// Rotation by the vector `turn` [rad].
inline Quat rotation(Vec3 turn) {
  const double x = 0.25 * dot(turn, turn);  // square of the half angle
  if (x < 0.01) {
    // The series of cos and of sin(a)/a to a^10: below a = 0.1 their error is under 1e-20. Cheaper than a
    // sine, and multiplied out because a division costs as much as four products.
    const double c = 1 + x * (-1.0 / 2 +
                              x * (1.0 / 24 + x * (-1.0 / 720 + x * (1.0 / 40320 + x * (-1.0 / 3628800)))));
    const double s = 1 + x * (-1.0 / 6 + x * (1.0 / 120 + x * (-1.0 / 5040 +
                                                               x * (1.0 / 362880 + x * (-1.0 / 39916800)))));
    return {c, 0.5 * s * turn.x, 0.5 * s * turn.y, 0.5 * s * turn.z};
  }
  const double half = std::sqrt(x);
  const auto [s, c] = math::sincos(half);
  const double scale = s / (2 * half);
  return {c, scale * turn.x, scale * turn.y, scale * turn.z};
}

/// Normalised product of unit quaternions, whose length differs from 1 by rounding: one Newton step is exact.
inline Quat trimmed(Quat q) {
  const double s = 1.5 - 0.5 * (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {s * q.w, s * q.x, s * q.y, s * q.z};
}

/// Orientation after h seconds at angular velocity w. Spin about the body's own joint axis comes first, the
/// rest turns the result: a fast wheel on a turning robot thus keeps its axis where the robot holds it.
inline Quat turned(Quat q, Vec3 w, Vec3 spin_axis_B, double h) {
  if (spin_axis_B == Vec3{}) return trimmed(rotation(h * w) * q);
  const Vec3 axis = rotate(q, spin_axis_B);
  const Vec3 spin = dot(w, axis) * axis;
  return trimmed(rotation(h * (w - spin)) * (rotation(h * spin) * q));
}

}  // namespace

void RigidEngine::step(double h, std::uint64_t stream_key) {
  SL_CHECK(h > 0);
  library::prepare_thread();
  if (failure_) return;  // ODE must not see NaN; check_finite() reports it
  const library::Counts before = library::counts();
  try {
    wake_held();
    push_forces(h);
    collide();
    attach_contacts(h);
    attach_grips();
    find_islands();
    solve(h, stream_key);
    measure_grips();
    if (!watched_links_.empty()) measure_contacts();
    if (!watched_joints_.empty()) measure_loads(h);
    forget_watch();
  } catch (const library::Fault& fault) {
    fault_ = fault.message;
    // ODE stopped before there were numbers to look at: the fastest body is the likeliest cause.
    fail({"the forces in this step are no longer finite (ODE: " + fault_ + "); the fastest body was '" +
              fastest_body() + "'",
          remedy});
    return;
  }
  if (!nobody_exploded()) return;
  advance(h);
  if (spec_.sleeping) send_to_sleep(h);
  dJointGroupEmpty(contact_joints_);
  counters_.solver_messages += library::counts().messages - before.messages;
  counters_.library_allocations += library::counts().allocations - before.allocations;
}

void RigidEngine::push_forces(double h) {
  for (Instance* instance : order_) {
    if (instance->guided && !instance->destination) instance->V_WM = {};
    if (instance->bodies.empty()) continue;
    for (Joint& joint : watched_joints_.empty() ? instance->moved_joints() : std::span(instance->joints)) {
      const Body* const mover = joint.child ? joint.child : joint.parent;
      if (!mover || !mover->frozen) prepare_joint(joint, spec_.erp, h);
      if (joint.main && joint.is(model::JointType::screw) && mover->awake)
        add_thread_row(world_, contact_joints_, joint, spec_.erp, h);
      if (joint.main && joint.target.friction > 0 && !joint.leader && !joint.is(model::JointType::ball) &&
          joint.target.mode == JointTarget::Mode::effort && mover->active())
        add_friction_row(world_, contact_joints_, joint);
      if (joint.load_watched && joint.main) watch_load(joint);
    }
    if (instance->drive.active) drive(*instance, h);
    for (Body& b : instance->movers()) {
      if (!b.active()) continue;
      put_orientation(b);
      if (b.weighs_partly) {
        const Vec3 weight = b.gravity_mass_kg * gravity_;
        b.force_N += weight;
        b.torque_Nm += cross(rotate(b.q, b.gravity_point_B), weight);
      }
      if (b.force_N != Vec3{}) dBodyAddForce(b.ode, b.force_N.x, b.force_N.y, b.force_N.z);
      if (b.torque_Nm != Vec3{}) dBodyAddTorque(b.ode, b.torque_Nm.x, b.torque_Nm.y, b.torque_Nm.z);
    }
  }
}

/// Rails push every body of the instance; who measures loads takes what they do to the base's body as done to
/// the base.
void RigidEngine::drive(Instance& instance, double h) {
  const Body* const base = instance.links[instance.drive_link].body;
  const Vec3 force = base ? base->force_N : Vec3{}, torque = base ? base->torque_Nm : Vec3{};
  push_drive(instance, gravity_, h);
  if (base && !watched_joints_.empty())
    pushes_.push_back(
        {&instance, instance.drive_link, base->p, base->force_N - force, base->torque_Nm - torque});
}

std::uint32_t RigidEngine::root(std::uint32_t node) {
  while (island_parent_[node] != node) node = island_parent_[node] = island_parent_[island_parent_[node]];
  return node;
}

void RigidEngine::unite(const Body* a, const Body* b) {
  if (!a || !b) return;
  const std::uint32_t x = root(a->island), y = root(b->island);
  island_parent_[std::max(x, y)] = std::min(x, y);
}

/// Bodies that joints and contacts connect, what stands left out. Decides how each island is solved.
void RigidEngine::find_islands() {
  island_parent_.clear();
  for (Instance* instance : order_)
    for (Body& b : instance->movers()) {
      if (!b.active()) continue;
      b.island = static_cast<std::uint32_t>(island_parent_.size());
      island_parent_.push_back(b.island);
    }
  counters_.awake_bodies = island_parent_.size();
  for (Instance* instance : order_)
    for (const Joint& joint : instance->moved_joints())
      if (joint.main && joint.child && joint.child->active()) unite(joint.child, joint.parent);
  for (const Hit& hit : hits()) unite(hit.a->body, hit.b->body);
  for (const Held& grip : grips_)
    if (grip.a && grip.a->active()) unite(grip.a, grip.b);

  islands_.assign(island_parent_.size(), {});
  for (const Hit& hit : hits()) ++islands_[root((hit.a->body ? hit.a->body : hit.b->body)->island)].contacts;
  for (Instance* instance : order_) {
    bool idle = !instance->is_robot && !instance->drive.active;
    if (idle)
      for (const Joint& joint : instance->joints) idle = idle && joint.target.mode == JointTarget::Mode::free;
    for (const Body& b : instance->movers()) {
      if (!b.active()) continue;
      Island& island = islands_[root(b.island)];
      island.was_quick = island.was_quick || b.quick;
      island.rolling = island.rolling || b.carrier;
      island.may_sleep = island.may_sleep && idle;
    }
  }
  for (Island& island : islands_) {
    // An island that was solved quickly stays so until it has shrunk by a quarter: no flicker at the limit.
    // Light rollers between heavy robots and the ground are what the quick solver is worst at.
    const std::uint32_t limit = static_cast<std::uint32_t>(spec_.direct_limit) * (island.rolling ? 4 : 1);
    const std::uint32_t bound = island.was_quick ? limit - limit / 4 : limit;
    island.quick = spec_.solver == Solver::quick ||
                   (spec_.solver == Solver::automatic && island.contacts > bound);
  }
}

/// ODE finds the same islands and solves each by itself, and leaves out those whose bodies are disabled.
void RigidEngine::solve(double h, std::uint64_t stream_key) {
  library::seed(stream_key);
  bool any_direct = false, any_quick = false;
  for (Instance* instance : order_)
    for (Body& b : instance->movers()) {
      if (!b.active()) continue;
      b.quick = islands_[root(b.island)].quick;
      (b.quick ? any_quick : any_direct) = true;
    }
  if (any_direct) {
    enable([](const Body& b) { return !b.quick; });
    const std::uint64_t complaints = library::counts().messages;
    dWorldStep(world_, h);
    if (library::counts().messages != complaints) solve_again(h);
  }
  if (any_quick) {
    enable([](const Body& b) { return b.quick; });
    dWorldQuickStep(world_, h);
  }
}

template <class Choose>
void RigidEngine::enable(Choose&& choose) {
  for (Instance* instance : order_)
    for (Body& b : instance->movers()) {
      const bool wanted = b.active() && choose(b);
      if (wanted == b.enabled) continue;
      b.enabled = wanted;
      if (wanted) dBodyEnable(b.ode);
      else dBodyDisable(b.ode);
    }
}

/// The direct solver gave up on some island, which leaves that one without most of its friction. Every island
/// is tried by itself, with the same result where it had one, and what fails is solved quickly for this
/// sub-step.
void RigidEngine::solve_again(double h) {
  const auto reset = [&](std::uint32_t island) {
    for (Instance* instance : order_)
      for (Body& b : instance->bodies) {
        if (!b.active() || root(b.island) != island) continue;
        put(b);
        dBodySetForce(b.ode, b.force_N.x, b.force_N.y, b.force_N.z);
        dBodySetTorque(b.ode, b.torque_Nm.x, b.torque_Nm.y, b.torque_Nm.z);
      }
  };
  for (std::uint32_t island = 0; island < islands_.size(); ++island) {
    if (island_parent_[island] != island || islands_[island].quick) continue;
    enable([&](const Body& b) { return root(b.island) == island; });
    reset(island);
    const std::uint64_t complaints = library::counts().messages;
    dWorldStep(world_, h);
    if (library::counts().messages == complaints) continue;
    reset(island);
    dWorldQuickStep(world_, h);
  }
}

std::string RigidEngine::fastest_body() const {
  std::string fastest;
  double speed = -1;
  for (const Instance* instance : order_)
    for (std::size_t l = 0; l < instance->links.size(); ++l) {
      const BodyState& s = states_[instance->link_ids[l].index];
      const double mine = norm(s.V_WB.linear) + norm(s.V_WB.angular);
      if (mine <= speed) continue;
      speed = mine;
      fastest = instance->name + "/" + instance->model->links[l].name;
    }
  return fastest;
}

/// Looks at what ODE has computed before anything takes it over: a body that has no finite state any more, or
/// is faster than any should be, ends the run with the State of before. The worst is named.
bool RigidEngine::nobody_exploded() {
  const Body* worst = nullptr;
  double worst_excess = 1, speed = 0, spin = 0;
  for (Instance* instance : order_)
    for (const Body& b : instance->movers()) {
      if (!b.active()) continue;
      const Vec3 p = vec(dBodyGetPosition(b.ode)), v = vec(dBodyGetLinearVel(b.ode)),
                 w = vec(dBodyGetAngularVel(b.ode));
      double excess2 = std::max(dot(v, v) / (spec_.max_speed_mps * spec_.max_speed_mps),
                                dot(w, w) / (spec_.max_spin_radps * spec_.max_spin_radps));
      const bool there = dot(p, p) < 1e24 && dot(v, v) < 1e300 && dot(w, w) < 1e300;  // false for NaN
      if (!there) excess2 = std::numeric_limits<double>::infinity();
      if (!(excess2 > worst_excess)) continue;
      worst = &b, worst_excess = excess2, speed = norm(v), spin = norm(w);
    }
  if (!worst) return true;
  const Instance& instance = *worst->instance;
  std::size_t link = 0;
  while (instance.links[link].body != worst) ++link;
  const std::string name = instance.name + "/" + instance.model->links[link].name;
  if (worst_excess == std::numeric_limits<double>::infinity()) fail(not_finite(name));
  else fail(exploded(name, {speed, spec_.max_speed_mps}, {spin, spec_.max_spin_radps}));
  return false;
}

void RigidEngine::advance(double h) {
  for (Instance* instance : order_) {
    if (instance->destination) {
      instance->X_WM = *instance->destination;
      instance->destination.reset();
      place_static_geoms(*instance);
    }
    if (instance->guided) show(*instance);
    if (instance->bodies.empty()) continue;
    bool any_awake = false;
    for (const Body& b : instance->movers()) any_awake = any_awake || b.active();
    if (!any_awake) continue;
    for (Joint& joint : instance->moved_joints())
      if (!joint.child || !joint.child->frozen) measure_effort(joint);
    for (Body& b : instance->movers()) {
      if (!b.active()) continue;
      b.p = vec(dBodyGetPosition(b.ode));
      b.v = vec(dBodyGetLinearVel(b.ode));
      b.w = vec(dBodyGetAngularVel(b.ode));
      b.q = turned(b.q, b.w, b.spin_axis_B, h);
      b.force_N = b.torque_Nm = {};
    }
    for (Joint& joint : instance->moved_joints())
      if (!joint.child || !joint.child->frozen) measure_position(joint, h, instance->X_WM);
    for (Wheel& wheel : instance->wheels) roll_on(wheel, h);
    show(*instance);
  }
}

void RigidEngine::send_to_sleep(double h) {
  const double speed2 = spec_.sleep_speed_mps * spec_.sleep_speed_mps;
  const double spin2 = spec_.sleep_spin_radps * spec_.sleep_spin_radps;
  for (Instance* instance : order_)
    for (Body& b : instance->movers()) {
      if (!b.active()) continue;
      b.quiet_s = dot(b.v, b.v) < speed2 && dot(b.w, b.w) < spin2 ? b.quiet_s + h : 0;
      Island& island = islands_[root(b.island)];
      island.may_sleep = island.may_sleep && b.quiet_s > spec_.sleep_time_s;
    }
  for (Instance* instance : order_) {
    bool changed = false;
    for (Body& b : instance->movers()) {
      if (!b.active() || !islands_[root(b.island)].may_sleep) continue;
      b.awake = b.quick = false;
      b.v = b.w = {};
      b.quiet_s = 0;
      put(b);
      changed = true;
    }
    if (!changed) continue;
    for (Wheel& wheel : instance->wheels)
      if (!wheel.body->awake) stop_frozen(wheel), follow(wheel);
    show(*instance);
  }
}

}  // namespace sandlot::rigid
