#include "devices/drives/body_velocity/body_velocity.h"

#include <cmath>

#include "devices/sdf_noise.h"

namespace sandlot::body_velocity {
namespace {

constexpr double no_limit = 1e9;

/// "1 0 0" as a list of three.
void copy_vector(const Node& element, const char* name, Node& config, const char* key) {
  const Node* const node = sdf_element::find(element, name);
  if (!node) return;
  Node list = Node::sequence(node->place());
  const std::string written = sdf_element::text(node);
  for (const std::string_view part : split(written, ' '))
    if (!trim(part).empty()) list.push(Node::scalar(std::string(trim(part)), node->place()));
  config.set(key, std::move(list));
}

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  copy_vector(element, "initial_linear", config, "initial_linear");
  copy_vector(element, "initial_angular", config, "initial_angular");
  warn_unknown(element, {"initial_linear", "initial_angular", "odometryFrame", "robotBaseFrame"},
               "the velocity control plugin", diagnostics);
  return config;
}

}  // namespace

Result<Mover> Mover::create(const DeviceBuild& build, Spec spec) {
  if (!build.engine.ideal_drives)
    return Error{"the engine '" + std::string(build.engine.name) + "' has no ideal drives"};
  Mover mover{spec};
  mover.base = build.bodies.front();
  mover.energy = build.energy;
  if (mover.energy) mover.energy->can_ride();
  mover.state.vx_mps = spec.initial_linear_mps.x;
  mover.state.vy_mps = spec.initial_linear_mps.y;
  mover.state.wz_radps = spec.initial_angular_radps.z;
  mover.command = build.accept<msg::Twist>(0, "ideal");
  mover.maneuver = maneuver::make_topics(build);
  return mover;
}

void Mover::actuate(PoolView<Mover> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Mover& mover = pool.all[index];
    State& state = mover.state;
    if (mover.command->count != state.taken) {
      state.taken = mover.command->count;
      state.command_time = mover.command->stamp;
      maneuver::end(mover.late);
      // A message may hold anything; what is not a number has no effect.
      const auto sane = [](double x) { return std::isfinite(x) ? x : 0.0; };
      state.vx_mps = sane(mover.command->message.linear.x);
      state.vy_mps = sane(mover.command->message.linear.y);
      state.wz_radps = sane(mover.command->message.angular.z);
    }
    const double timeout_s = mover.spec.command_timeout_s;
    const bool late = timeout_s > 0 && (context.now - context.tick - state.command_time).s() > timeout_s;
    maneuver::PlanarMotion moving{state.vx_mps, state.vy_mps, state.wz_radps};
    if (late) moving = {};
    if (maneuver::ride(mover.late, mover.maneuver,
                       {.speed_mps = no_limit,
                        .turning_rate_radps = no_limit,
                        .acceleration_mps2 = mover.spec.max_acceleration_mps2,
                        .angular_acceleration_radps2 = mover.spec.max_angular_acceleration_radps2},
                       context.engine.states()[mover.base.index], context))
      moving = mover.late->maneuver.setpoint;
    context.actuation.drives.push_back(
        {.base = mover.base,
         .vx_mps = moving.x,
         .vy_mps = moving.y,
         .wz_radps = moving.turn,
         .max_accel_mps2 = mover.spec.max_acceleration_mps2,
         .max_angular_accel_radps2 = mover.spec.max_angular_acceleration_radps2});
    if (mover.energy) mover.energy->ride(context.actuation.drives.back());
  }
}

void Mover::release(const Context& context) {
  context.actuation.drives.push_back({.base = base, .active = false});
}

namespace {
constexpr LevelInfo levels[] = {
    {"ideal", "", msg::Twist::ros_type, "The base moves as commanded, within its acceleration."},
};
constexpr const char* sdf_types[] = {"plugin:VelocityControl", "plugin:gz-sim-velocity-control-system",
                                     "plugin:ignition-gazebo-velocity-control-system",
                                     "plugin:gazebo_ros_planar_move"};
}  // namespace

constinit const Kind kind = make_kind<Mover>({
    .name = "body_velocity",
    .help = "Moves a whole robot at a commanded velocity, without wheels.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic names, link_name, velocities out of the plane",
});

}  // namespace sandlot::body_velocity
