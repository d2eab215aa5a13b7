#include "devices/drives/wheel_encoder/wheel_encoder.h"

#include <algorithm>
#include <cmath>

#include "base/math.h"

namespace sandlot::wheel_encoder {
namespace {
enum Level : std::uint32_t { ticks_level, joint_level };
}

std::int64_t ticks_at(double angle_rad, int ticks_per_turn) {
  // Errors may be of any size; what a counter of 64 bits cannot hold is its end.
  return static_cast<std::int64_t>(
      std::clamp(std::floor(angle_rad * ticks_per_turn / math::tau), -9e18, 9e18));
}

Result<Encoder> Encoder::create(const DeviceBuild& build, Spec spec) {
  SL_ASSIGN(const std::uint32_t index, build.joint_index(spec.joint, "joint"));
  const model::JointType type = build.instance.model->joints[index].type;
  if (type != model::JointType::revolute && type != model::JointType::continuous) {
    return build.error("joint", "joint '" + spec.joint + "' does not turn",
                       "an encoder needs a revolute or continuous joint");
  }
  Encoder encoder{std::move(spec)};
  encoder.key = build.key;
  encoder.state.reset(encoder.spec.noise.stages, Stream(build.seed, build.key, Purpose::initial, 0));
  encoder.joint = build.joints[index].index;
  encoder.ticks = build.publish<msg::Int64Stamped>(ticks_level, "ticks");
  encoder.ticks->message.header.frame_id = build.frame_id();
  encoder.exact = build.publish<msg::JointState>(joint_level, "joint");
  encoder.exact->message.header.frame_id = build.frame_id();
  encoder.exact->message.name = {encoder.spec.joint};
  encoder.exact->message.position = encoder.exact->message.velocity = encoder.exact->message.effort = {0.0};
  return encoder;
}

void Encoder::sense(PoolView<Encoder> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Encoder& encoder = pool.all[index];
    const JointState& joint = context.engine.joint_states()[encoder.joint];
    if (pool.levels[index] >> ticks_level & 1) {
      const double angle_rad = encoder.state.corrupt(
          encoder.spec.noise.stages, joint.position, pool.since[index].s(),
          Stream(context.seed, encoder.key, Purpose::noise, pool.sample[index]), encoder.spec.errors);
      if (!std::isnan(angle_rad))
        encoder.ticks->message.data = ticks_at(angle_rad, encoder.spec.ticks_per_turn);
      encoder.ticks->publish(context.now);
    }
    if (pool.levels[index] >> joint_level & 1) {
      msg::JointState& message = encoder.exact->message;
      message.position = {joint.position};
      message.velocity = {joint.velocity};
      message.effort = {joint.effort};
      encoder.exact->publish(context.now);
    }
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"ticks", msg::Int64Stamped::ros_type, "", "Edges counted since the model's declared pose."},
    {"joint", msg::JointState::ros_type, "", "Exact angle, speed and effort."},
};
}  // namespace

constinit const Kind kind = make_kind<Encoder>({
    .name = "wheel_encoder",
    .help = "Incremental encoder on a turning joint.",
    .levels = levels,
});

}  // namespace sandlot::wheel_encoder
