#include "devices/joints/joint_trajectory/joint_trajectory.h"

#include <algorithm>
#include <cmath>

#include "devices/sdf_noise.h"

namespace sandlot::joint_trajectory {
namespace {

struct Reference {
  double position, velocity;
};

/// Target of joint `j` at time t of the path.
Reference reference(const State& s, std::size_t joints, std::size_t j, double t_s) {
  const auto at = [&](std::size_t point) { return s.position[point * joints + j]; };
  const std::size_t last = s.time_s.size() - 1;
  if (t_s >= s.time_s[last]) return {at(last), 0};
  if (t_s <= s.time_s[0]) return {at(0), 0};
  const auto after = static_cast<std::size_t>(std::upper_bound(s.time_s.begin(), s.time_s.end(), t_s) -
                                              s.time_s.begin());
  const std::size_t before = after - 1;
  const double span_s = s.time_s[after] - s.time_s[before], u = (t_s - s.time_s[before]) / span_s;
  const double p0 = at(before), p1 = at(after);
  if (s.velocity.empty()) return {p0 + u * (p1 - p0), (p1 - p0) / span_s};
  const double m0 = s.velocity[before * joints + j] * span_s, m1 = s.velocity[after * joints + j] * span_s;
  const double a = 2 * p0 - 2 * p1 + m0 + m1, b = -3 * p0 + 3 * p1 - 2 * m0 - m1;
  return {((a * u + b) * u + m0) * u + p0, ((3 * a * u + 2 * b) * u + m0) / span_s};
}

/// The path is one point from now on: where the joints are.
void hold(Trajectory& device, std::span<const JointState> states) {
  State& state = device.state;
  state.held = 1;
  state.elapsed_s = 0;
  state.time_s = {0.0};
  state.position.clear();
  state.velocity.clear();
  for (const Trajectory::Joint& joint : device.joints)
    state.position.push_back(states[joint.id.index].position);
  state.pids.assign(device.joints.size(), {});
}

/// A message may hold anything: true when it is a path for joints of this device. `order` then has the place
/// of each joint it names.
bool is_path(const Trajectory& device, const msg::JointTrajectory& message, std::vector<std::size_t>& order) {
  if (message.points.empty() || message.points.size() > max_points || message.joint_names.empty())
    return false;
  for (const std::string& name : message.joint_names) {
    const auto found = std::find(device.spec.joints.begin(), device.spec.joints.end(), name);
    if (found == device.spec.joints.end()) return false;
    const auto place = static_cast<std::size_t>(found - device.spec.joints.begin());
    if (std::find(order.begin(), order.end(), place) != order.end()) return false;
    order.push_back(place);
  }
  const auto finite = [](const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
  };
  const bool with_velocities = !message.points.front().velocities.empty();
  Time previous = Time{-1};
  for (const msg::JointTrajectoryPoint& point : message.points) {
    if (point.positions.size() != order.size() || !finite(point.positions) || !finite(point.velocities))
      return false;
    if (point.velocities.size() != (with_velocities ? order.size() : 0)) return false;
    if (point.time_from_start <= previous) return false;
    previous = point.time_from_start;
  }
  return true;
}

void take_command(Trajectory& device, Time begin) {
  State& state = device.state;
  if (device.command->count == state.taken) return;
  state.taken = device.command->count;
  if (!state.held) return;
  const msg::JointTrajectory& message = device.command->message;
  std::vector<std::size_t> order;
  if (!is_path(device, message, order)) return;
  const std::size_t n = device.joints.size();
  const bool with_velocities = !message.points.front().velocities.empty();
  const bool jump = message.points.front().time_from_start.ns == 0;  // no way leads there
  std::vector<double> start, start_velocity;
  for (std::size_t j = 0; j < n; ++j) {
    const Reference now = reference(state, n, j, state.elapsed_s);
    start.push_back(now.position);
    start_velocity.push_back(now.velocity);
  }
  state.time_s.clear();
  state.position.clear();
  state.velocity.clear();
  if (!jump) {
    state.time_s.push_back(0);
    state.position = start;
    if (with_velocities) state.velocity = start_velocity;
  }
  for (const msg::JointTrajectoryPoint& point : message.points) {
    state.time_s.push_back(point.time_from_start.s());
    const std::size_t at = state.position.size();
    state.position.insert(state.position.end(), start.begin(), start.end());
    if (with_velocities) state.velocity.resize(at + n, 0.0);
    for (std::size_t i = 0; i < order.size(); ++i) {
      const Trajectory::Joint& joint = device.joints[order[i]];
      state.position[at + order[i]] = std::clamp(point.positions[i], joint.lower, joint.upper);
      if (with_velocities) state.velocity[at + order[i]] = point.velocities[i];
    }
  }
  state.elapsed_s = message.header.stamp.ns == 0 ? 0 : (begin - message.header.stamp).s();
}

/// Lists under several names of elements, one number or text each.
void copy_list(const Node& element, const char* name, std::vector<Node>& out) {
  const Node* const node = element.find(name);
  if (!node) return;
  if (node->is_sequence())
    for (const Node& item : node->items())
      out.push_back(Node::scalar(sdf_element::text(&item), item.place()));
  else out.push_back(Node::scalar(sdf_element::text(node), node->place()));
}

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  std::vector<Node> joints;
  copy_list(element, "joint_name", joints);
  if (!joints.empty()) {  // none: all joints of the model, as in Gazebo
    Node& list = config.set("joints", Node::sequence(joints.front().place()));
    for (const Node& joint : joints) list.push(joint);
  }
  std::vector<Node> gains[3];
  constexpr const char* names[] = {"position_p_gain", "position_i_gain", "position_d_gain"};
  constexpr const char* keys[] = {"p", "i", "d"};
  for (int k = 0; k < 3; ++k) copy_list(element, names[k], gains[k]);
  if (!gains[0].empty()) {
    Node& all = config.set("gains", Node::sequence(element.place()));
    for (std::size_t j = 0; j < (joints.empty() ? gains[0].size() : joints.size()); ++j) {
      Node each = Node::map(element.place());
      for (int k = 0; k < 3; ++k)
        if (j < gains[k].size()) each.set(keys[k], gains[k][j]);
      all.push(std::move(each));
    }
  }
  warn_unknown(element, {"joint_name", "position_p_gain", "position_i_gain", "position_d_gain"},
               "the plugin JointTrajectoryController", diagnostics);
  return config;
}

}  // namespace

Result<Trajectory> Trajectory::create(const DeviceBuild& build, Spec spec) {
  if (!build.engine.joints)
    return Error{"the engine '" + std::string(build.engine.name) + "' does not simulate joints",
                 "use the engine 'rigid'"};
  const auto can_be_driven = [](const model::Joint& joint) {
    using enum model::JointType;
    return joint.type == revolute || joint.type == continuous || joint.type == prismatic;
  };
  if (spec.joints.empty())
    for (const model::Joint& joint : build.instance.model->joints)
      if (can_be_driven(joint)) spec.joints.push_back(joint.name);
  if (spec.joints.empty())
    return Error{"model '" + build.instance.model->name + "' has no joint that can be driven", "",
                 build.decl.place};
  if (!spec.gains.empty() && spec.gains.size() != spec.joints.size())
    return build.error("gains",
                       "there are " + std::to_string(spec.gains.size()) + " gains for " +
                           std::to_string(spec.joints.size()) + " joints",
                       "write one {p, i, d} for each joint, or none at all");
  Trajectory device{std::move(spec)};
  for (const std::string& name : device.spec.joints) {
    SL_ASSIGN(const std::uint32_t index, build.joint_index(name, "joints"));
    const model::Joint& joint = build.instance.model->joints[index];
    if (!can_be_driven(joint))
      return build.error("joints", "joint '" + name + "' cannot be driven",
                         "a trajectory needs revolute, continuous or prismatic joints");
    for (const Joint& other : device.joints)
      if (other.id == build.joints[index])
        return build.error("joints", "joint '" + name + "' is named twice", "");
    const bool bounded = joint.type != model::JointType::continuous;
    device.joints.push_back({build.joints[index], bounded ? joint.lower : -1e16, bounded ? joint.upper : 1e16,
                             joint.max_effort, joint.max_velocity});
  }
  device.energy = build.energy;
  if (device.energy)
    for (const Joint& joint : device.joints) device.energy->can_turn(joint.id);
  device.command = build.accept<msg::JointTrajectory>(0, "trajectory");
  return device;
}

bool Trajectory::fits() const {
  if (!state.held) return true;
  // The path is followed by its times without asking: a NaN among them would lead out of the lists.
  const auto finite = [](double x) { return std::isfinite(x); };
  return !state.time_s.empty() && state.position.size() == state.time_s.size() * joints.size() &&
         (state.velocity.empty() || state.velocity.size() == state.position.size()) &&
         state.pids.size() == joints.size() && std::isfinite(state.elapsed_s) &&
         std::all_of(state.time_s.begin(), state.time_s.end(), finite) &&
         std::is_sorted(state.time_s.begin(), state.time_s.end());
}

void Trajectory::actuate(PoolView<Trajectory> pool, const Context& context) {
  const auto states = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Trajectory& device = pool.all[index];
    if (device.spec.active && !device.state.held) hold(device, states);
    if (!device.spec.active && device.state.held) {
      device.release(context);
      device.state.held = 0;
    }
    take_command(device, context.now - context.tick);
    if (device.energy && device.state.held) device.energy->turn_joints();
  }
}

void Trajectory::pre_substep(PoolView<Trajectory> pool, const Context& context, double h_s) {
  const auto states = context.engine.joint_states();
  for (const std::uint32_t index : pool.due) {
    Trajectory& device = pool.all[index];
    State& state = device.state;
    if (!state.held) continue;
    const std::size_t n = device.joints.size();
    for (std::size_t j = 0; j < n; ++j) {
      const Joint& joint = device.joints[j];
      const JointState& now = states[joint.id.index];
      const Reference wanted = reference(state, n, j, state.elapsed_s);
      if (device.spec.gains.empty()) {
        const double next = reference(state, n, j, state.elapsed_s + h_s).position;
        const double speed = (next - wanted.position + 0.2 * (wanted.position - now.position)) / h_s;
        context.actuation.joints.push_back(
            {.joint = joint.id,
             .mode = JointTarget::Mode::velocity,
             .velocity = std::clamp(speed, -joint.max_velocity, joint.max_velocity),
             .max_effort = joint.max_effort});
      } else {
        const double effort = state.pids[j].step(device.spec.gains[j], wanted.position - now.position,
                                                 now.velocity - wanted.velocity, joint.max_effort, h_s);
        context.actuation.joints.push_back(
            {.joint = joint.id, .mode = JointTarget::Mode::effort, .effort = effort});
      }
    }
    state.elapsed_s += h_s;
  }
}

void Trajectory::release(const Context& context) {
  if (!state.held) return;
  for (const Joint& joint : joints) context.actuation.joints.push_back({.joint = joint.id});
}

namespace {
constexpr LevelInfo levels[] = {
    {"trajectory", "", msg::JointTrajectory::ros_type, "Follows a path of timed points."},
};
constexpr const char* sdf_types[] = {"plugin:JointTrajectoryController",
                                     "plugin:gz-sim-joint-trajectory-controller-system",
                                     "plugin:ignition-gazebo-joint-trajectory-controller-system"};
}  // namespace

constinit const Kind kind = make_kind<Trajectory>({
    .name = "joint_trajectory",
    .help = "Moves several joints along a trajectory of timed points.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic names, initial positions, gains of velocities, limits of integrals and commands",
});

}  // namespace sandlot::joint_trajectory
