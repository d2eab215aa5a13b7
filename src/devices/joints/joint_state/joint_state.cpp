#include "devices/joints/joint_state/joint_state.h"

#include "base/math.h"
#include "devices/sdf_noise.h"

namespace sandlot::joint_state {
namespace {

bool one_axis(const model::Joint& joint) {
  using model::JointType;
  return joint.type == JointType::revolute || joint.type == JointType::continuous ||
         joint.type == JointType::prismatic || joint.type == JointType::screw;
}

/// Limits beyond this are none.
constexpr double unlimited = 1e9;

Joints::Scale scale_of(const model::Joint& joint) {
  Joints::Scale scale;
  if (joint.upper - joint.lower < unlimited && joint.lower < joint.upper) {
    scale.middle = (joint.lower + joint.upper) / 2;
    scale.half = (joint.upper - joint.lower) / 2;
  } else if (joint.type != model::JointType::prismatic) {
    scale.half = math::pi;
    scale.turns = true;
  }
  if (joint.max_velocity > 0 && joint.max_velocity < unlimited) scale.velocity = joint.max_velocity;
  if (joint.max_effort > 0 && joint.max_effort < unlimited) scale.effort = joint.max_effort;
  return scale;
}

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  config.set("rate", Node::scalar("0", element.place()));
  SL_TRY(copy_number(element, {"update_rate", "updateRate"}, 1.0, config, "rate"));
  Node joints = Node::sequence(element.place());
  const auto add = [&](const Node& node) {
    // Gazebo classic's plugin for ROS 1 lists them in one text.
    const std::string written = text(&node);
    for (const std::string_view name : split(written, ','))
      if (!trim(name).empty()) joints.push(Node::scalar(std::string(trim(name)), node.place()));
  };
  for (const char* name : {"joint_name", "jointName"})
    if (const Node* const node = element.find(name)) {
      if (node->is_sequence())
        for (const Node& item : node->items()) add(item);
      else add(*node);
    }
  if (!joints.items().empty()) config.set("joints", std::move(joints));
  warn_unknown(element, {"joint_name", "jointName", "update_rate", "updateRate", "ros", "robotNamespace"},
               "the joint state publisher", diagnostics);
  return config;
}

}  // namespace

Result<Joints> Joints::create(const DeviceBuild& build, Spec spec) {
  Joints device{std::move(spec)};
  const std::vector<model::Joint>& all = build.instance.model->joints;
  std::vector<std::string> names;
  if (device.spec.joints.empty()) {
    for (std::uint32_t i = 0; i < all.size(); ++i)
      if (one_axis(all[i])) {
        if (device.spec.units == Units::centred) device.scales.push_back(scale_of(all[i]));
        names.push_back(all[i].name);
        device.joints.push_back(build.joints[i].index);
      }
  } else {
    for (const std::string& name : device.spec.joints) {
      SL_ASSIGN(const std::uint32_t index, build.joint_index(name, "joints"));
      if (!one_axis(all[index])) {
        return build.error("joints", "joint '" + name + "' has no single angle or length",
                           "name revolute, continuous, prismatic or screw joints");
      }
      if (device.spec.units == Units::centred) device.scales.push_back(scale_of(all[index]));
      names.push_back(name);
      device.joints.push_back(build.joints[index].index);
    }
  }
  device.key = build.key;
  const Stream random(build.seed, build.key, Purpose::initial, 0);
  const auto prepare = [&](const ChainSpec& chain, std::vector<ChannelChain>& channels, const char* what) {
    channels.resize(names.size());
    for (std::size_t i = 0; i < names.size(); ++i)
      channels[i].reset(chain.stages, random, std::string(what) + "/" + names[i]);
  };
  prepare(device.spec.noise.position, device.state.position, "position");
  prepare(device.spec.noise.velocity, device.state.velocity, "velocity");
  prepare(device.spec.noise.effort, device.state.effort, "effort");
  device.message = build.publish<msg::JointState>(0, "joints");
  msg::JointState& message = device.message->message;
  message.header.frame_id = build.frame_id();
  message.position.resize(names.size());
  message.velocity.resize(names.size());
  message.effort.resize(names.size());
  message.name = std::move(names);
  return device;
}

bool Joints::fits() const {
  const msg::JointState& shown = message->message;
  const std::size_t n = joints.size();
  return shown.position.size() == n && shown.velocity.size() == n && shown.effort.size() == n;
}

void Joints::scale(msg::JointState& message) const {
  for (std::size_t i = 0; i < scales.size(); ++i) {
    const Scale& scale = scales[i];
    const double angle = message.position[i];
    message.position[i] = ((scale.turns ? math::wrap_angle(angle) : angle) - scale.middle) / scale.half;
    message.velocity[i] /= scale.velocity;
    message.effort[i] /= scale.effort;
  }
}

void Joints::sense(PoolView<Joints> pool, const Context& context) {
  const auto states = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Joints& device = pool.all[index];
    msg::JointState& message = device.message->message;
    const Stream random(context.seed, device.key, Purpose::noise, pool.sample[index]);
    const double dt_s = pool.since[index].s();
    const auto corrupt = [&](const ChainSpec& chain, ChannelChain& channel, double x) {
      return channel.corrupt(chain.stages, x, dt_s, random, device.spec.errors);
    };
    const NoiseSpec& noise = device.spec.noise;
    for (std::size_t i = 0; i < device.joints.size(); ++i) {
      const JointState& joint = states[device.joints[i]];
      message.position[i] = corrupt(noise.position, device.state.position[i], joint.position);
      message.velocity[i] = corrupt(noise.velocity, device.state.velocity[i], joint.velocity);
      message.effort[i] = corrupt(noise.effort, device.state.effort[i], joint.effort);
    }
    device.scale(message);
    device.message->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"joints", msg::JointState::ros_type, "", "Angle, speed and effort of each joint."},
};
constexpr const char* sdf_types[] = {
    "plugin:JointStatePublisher", "plugin:gz-sim-joint-state-publisher-system",
    "plugin:ignition-gazebo-joint-state-publisher-system", "plugin:gazebo_ros_joint_state_publisher"};
}  // namespace

constinit const Kind kind = make_kind<Joints>({
    .name = "joint_state",
    .help = "Angles, speeds and efforts of all or some joints.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic names",
});

}  // namespace sandlot::joint_state
