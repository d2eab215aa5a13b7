#include "devices/touch/force_torque/force_torque.h"

#include "devices/sdf_noise.h"

namespace sandlot::force_torque {
namespace {

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  copy_rate(element, "update_rate", config);
  copy(element, "@joint", config, "joint");
  if (!config.find("joint"))
    return element.error("a force_torque sensor belongs into a <joint>", "move the <sensor> there");
  const Node* const own = find(element, "force_torque");
  if (!own || !own->is_map()) return config;
  warn_unknown(*own, {"frame", "measure_direction", "force", "torque"}, "<force_torque>", diagnostics);
  copy(*own, "frame", config, "frame");
  copy(*own, "measure_direction", config, "direction");
  for (const char* part : {"force", "torque"})
    if (const Node* const group = find(*own, part)) {
      SL_ASSIGN(Node keys, axes_noise(*group, diagnostics));
      config.set(part, std::move(keys));
    }
  return config;
}

}  // namespace

Result<Sensor> Sensor::create(const DeviceBuild& build, Spec spec) {
  if (!build.engine.joint_loads)
    return Error{"the engine '" + std::string(build.engine.name) + "' does not tell the loads of joints",
                 "use the engine 'rigid'"};
  SL_ASSIGN(const std::uint32_t index, build.joint_index(spec.joint, "joint"));
  const model::Joint& joint = build.instance.model->joints[index];
  Sensor sensor{std::move(spec)};
  sensor.key = build.key;
  sensor.joint = build.joints[index];
  sensor.child = build.bodies[joint.child].index;
  if (joint.parent != model::world_link) sensor.parent = build.bodies[joint.parent].index;
  sensor.q_CJ = joint.X_CJ.q;
  // The device's link need not be the child: a rigid relation is that of the declared poses.
  const auto& links = build.instance.model->links;
  const Quat q_MS = links[build.decl.link].X_ML.q * build.decl.X_LS.q;
  sensor.q_SC = normalised(conjugate(q_MS) * links[joint.child].X_ML.q);
  Stream random(build.seed, build.key, Purpose::initial, 0);
  sensor.state.force.reset(sensor.spec.force, random, "force");
  sensor.state.torque.reset(sensor.spec.torque, random, "torque");
  sensor.wrench = build.publish<msg::WrenchStamped>(0, "wrench");
  sensor.wrench->message.header.frame_id = build.frame_id();
  return sensor;
}

void Sensor::pre_substep(PoolView<Sensor> pool, const Context& context, double) {
  for (const std::uint32_t index : pool.due) context.actuation.watch.loads.push_back(pool.all[index].joint);
}

void Sensor::post_substep(PoolView<Sensor> pool, const Context& context, double h_s) {
  const auto states = context.engine.states();
  const auto loads = context.engine.joint_loads();
  for (const std::uint32_t index : pool.due) {
    Sensor& sensor = pool.all[index];
    Quat q = sensor.q_CJ;  // J's axes in those shown
    if (sensor.spec.frame == Axes::sensor) q = sensor.q_SC * q;
    if (sensor.spec.frame == Axes::parent) {
      const Quat q_WP = sensor.parent == ~0u ? Quat{} : states[sensor.parent].X_WB.q;
      q = conjugate(q_WP) * states[sensor.child].X_WB.q * q;
    }
    const JointLoad& load = loads[sensor.joint.index];
    sensor.state.impulse += h_s * rotate(q, load.force_N);
    sensor.state.turning += h_s * rotate(q, load.torque_Nm);
    sensor.state.counted_s += h_s;
  }
}

void Sensor::sense(PoolView<Sensor> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Sensor& sensor = pool.all[index];
    State& state = sensor.state;
    Vec3 force, torque;
    if (state.counted_s > 0) {
      const double sign = sensor.spec.direction == Direction::parent_to_child ? 1 : -1;
      force = sign / state.counted_s * state.impulse;
      torque = sign / state.counted_s * state.turning;
    }
    state.impulse = state.turning = {};
    state.counted_s = 0;
    Stream random(context.seed, sensor.key, Purpose::noise, pool.sample[index]);
    const double dt_s = pool.since[index].s();
    msg::Wrench& wrench = sensor.wrench->message.wrench;
    wrench.force = state.force.corrupt(sensor.spec.force, force, dt_s, random, sensor.spec.errors);
    wrench.torque = state.torque.corrupt(sensor.spec.torque, torque, dt_s, random, sensor.spec.errors);
    sensor.wrench->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"wrench", msg::WrenchStamped::ros_type, "", "Force and torque between the two links of a joint."},
};
constexpr const char* sdf_types[] = {"sensor:force_torque"};
}  // namespace

constinit const Kind kind = make_kind<Sensor>({
    .name = "force_torque",
    .help = "Force-torque sensor in a joint.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic names",
});

}  // namespace sandlot::force_torque
