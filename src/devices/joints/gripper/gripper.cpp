#include "devices/joints/gripper/gripper.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "devices/sdf_noise.h"
#include "physics/distance.h"

namespace sandlot::gripper {
namespace {

BodyId partner(const Grip& grip, BodyId of) { return grip.a == of ? grip.b : grip.a; }

/// gazebo_ros_vacuum_gripper; its link is taken by the loader of the file.
Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  copy(element, "link_name", config, "link");
  copy(element, "max_distance", config, "reach");
  copy_rate(element, "update_rate", config);
  warn_unknown(element, {"link_name", "max_distance", "update_rate", "ros"}, "the vacuum gripper",
               diagnostics);
  return config;
}

}  // namespace

Result<Gripper> Gripper::create(const DeviceBuild& build, Spec spec) {
  if (!build.engine.grips)
    return Error{"the engine '" + std::string(build.engine.name) + "' cannot hold things together"};
  if (build.instance.motion)
    return Error{"'" + build.instance.name + "' moves along a path, so it cannot hold anything",
                 "give the gripper to a robot that forces move, or to one that stands"};
  Gripper gripper{spec};
  gripper.body = build.body();
  gripper.robot = build.instance.name;
  gripper.X_LS = build.decl.X_LS;
  gripper.state.closed = gripper.state.tries = spec.closed;
  gripper.hold = build.publish<msg::GripperState>(0, "hold");
  gripper.hold->message.header.frame_id = build.frame_id();
  gripper.command = build.accept<msg::Bool>(0, "hold");
  return gripper;
}

const Grip* Gripper::grip(const Engine& engine) const {
  for (const Grip& grip : engine.grips()) {
    if (!(grip.a == body || grip.b == body)) continue;
    const BodyName name = engine.name(partner(grip, body));
    if (name.link && name.instance == state.instance && name.link->name == state.link) return &grip;
  }
  return nullptr;
}

void Gripper::let_go(const Context& context) {
  if (const Grip* const held = grip(context.engine))
    context.actuation.grips.push_back({held->a, held->b, false});
  state.instance.clear();
  state.link.clear();
  state.force_N = {};
  state.torn = false;
}

void Gripper::try_to_hold(const Context& context) {
  const Engine& engine = context.engine;
  const auto bodies = engine.states();
  const OverlapQuery ball{(bodies[body.index].X_WB * X_LS).p, spec.reach_m};
  std::vector<std::uint32_t> found, ends;
  engine.overlaps(std::span(&ball, 1), found, ends);
  BodyId nearest;
  // Names and not indices decide between equals: a restored world may count them out differently.
  std::tuple<double, std::string_view, std::string_view> best{
      std::numeric_limits<double>::infinity(), {}, {}};
  for (const std::uint32_t index : found) {
    const BodyId id = engine.body_at(index);
    const BodyName name = engine.name(id);
    if (!name.link || !name.moves || name.instance == robot) continue;
    const auto held = [&](const Grip& g) { return (g.a == body && g.b == id) || (g.a == id && g.b == body); };
    if (std::any_of(engine.grips().begin(), engine.grips().end(), held)) continue;  // by another on this link
    double distance = std::numeric_limits<double>::infinity();
    for (const model::Collision& c : name.link->collisions) {
      if (!c.surface.touches) continue;
      const Vec3 at = inverse(bodies[index].X_WB * c.X_LC) * ball.centre_W;
      distance = std::min(distance, distance_m(c.shape, at, spec.reach_m));
    }
    if (!(distance <= spec.reach_m)) continue;
    const std::tuple<double, std::string_view, std::string_view> mine{distance, name.instance,
                                                                      name.link->name};
    if (!(mine < best)) continue;
    best = mine;
    nearest = id;
    state.instance = name.instance;
    state.link = name.link->name;
  }
  if (holds()) context.actuation.grips.push_back({body, nearest});
}

void Gripper::actuate(PoolView<Gripper> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Gripper& gripper = pool.all[index];
    State& state = gripper.state;
    if (gripper.command->count != state.taken) {
      state.taken = gripper.command->count;
      state.closed = state.tries = gripper.command->message.data;
    }
    if (!state.closed && gripper.holds()) gripper.let_go(context);
    if (state.tries && !gripper.holds()) gripper.try_to_hold(context);
    state.tries = false;
  }
}

void Gripper::pre_substep(PoolView<Gripper> pool, const Context& context, double) {
  for (const std::uint32_t index : pool.due)
    if (pool.all[index].state.torn) pool.all[index].let_go(context);
}

void Gripper::post_substep(PoolView<Gripper> pool, const Context& context, double) {
  for (const std::uint32_t index : pool.due) {
    Gripper& gripper = pool.all[index];
    if (!gripper.holds()) continue;
    const Grip* const held = gripper.grip(context.engine);
    if (!held) {
      gripper.let_go(context);
      continue;
    }
    State& state = gripper.state;
    state.force_N = held->b == gripper.body ? -held->force_N : held->force_N;
    const double most = gripper.spec.max_force_N;
    state.torn = dot(state.force_N, state.force_N) > most * most;
  }
}

void Gripper::sense(PoolView<Gripper> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Gripper& gripper = pool.all[index];
    const State& state = gripper.state;
    msg::GripperState& message = gripper.hold->message;
    message.closed = state.closed;
    message.held.clear();
    if (gripper.holds() && !state.torn) {
      message.held += state.instance;
      message.held += "::";
      message.held += state.link;
    }
    const Quat q_WS = context.engine.states()[gripper.body.index].X_WB.q * gripper.X_LS.q;
    message.force = rotate_inverse(q_WS, state.force_N);
    gripper.hold->publish(context.now);
  }
}

void Gripper::release(const Context& context) { let_go(context); }

namespace {
constexpr LevelInfo levels[] = {
    {"hold", msg::GripperState::ros_type, msg::Bool::ros_type,
     "Closes on true, opens on false; reports what is held."},
};
constexpr const char* sdf_types[] = {"plugin:gazebo_ros_vacuum_gripper", "plugin:VacuumGripperPlugin"};
}  // namespace

constinit const Kind kind = make_kind<Gripper>({
    .name = "gripper",
    .help = "Gripper that holds the nearest object in its reach until commanded to open, or until it is torn "
            "off.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "fixed bodies that it shall leave alone; it holds one thing, at once, instead of pulling all "
                "in reach",
});

}  // namespace sandlot::gripper
