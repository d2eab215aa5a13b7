#include "devices/cameras/overhead_camera/overhead_camera.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot::overhead_camera {
namespace {

bool reports(const Spec& spec, const LabelledObject& target) {
  return (target.moves || spec.fixed) &&
         (spec.labels.empty() ||
          std::find(spec.labels.begin(), spec.labels.end(), target.label) != spec.labels.end());
}

void observe(OverheadCamera& camera, std::uint64_t sample, const Context& context) {
  const Spec& spec = camera.spec;
  const double position_std_m = spec.errors * spec.position_std_m;
  const double yaw_std_rad = spec.errors * spec.yaw_std_rad, miss = std::min(1.0, spec.errors * spec.miss);
  const Stream stream(context.seed, camera.key, Purpose::noise, sample);
  const auto states = context.engine.states();
  std::vector<msg::ObjectPose>& reported = camera.world->message.objects;
  std::size_t count = 0;
  for (const LabelledObject& target : context.labelled_objects) {
    if (!reports(spec, target)) continue;
    Stream random = stream.fork(entity_key(target.name));
    if (random.uniform() < miss) continue;
    if (count == reported.size())
      reported.emplace_back();  // else: the place of an earlier sample and its memory
    msg::ObjectPose& object = reported[count++];
    object.label = target.label;
    object.name = spec.names ? target.name : std::string();
    object.color = {target.color.r, target.color.g, target.color.b, target.color.a};
    object.pose = states[target.bodies.front()].X_WB;
    object.pose.p.x += position_std_m * random.normal();
    object.pose.p.y += position_std_m * random.normal();
    const double turn_rad = yaw_std_rad * random.normal();
    if (turn_rad != 0) object.pose.q = normalised(quat_from_axis_angle({0, 0, 1}, turn_rad) * object.pose.q);
    object.position_std = position_std_m;
    object.confidence = 1;
  }
  reported.resize(count);
  camera.world->publish(context.now);
}

}  // namespace

Result<OverheadCamera> OverheadCamera::create(const DeviceBuild& build, Spec spec) {
  OverheadCamera camera{std::move(spec)};
  camera.key = build.key;
  camera.world = build.publish<msg::ObjectPoseArray>(0, "world");
  camera.world->message.header.frame_id = "world";
  return camera;
}

void OverheadCamera::sense(PoolView<OverheadCamera> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) observe(pool.all[index], pool.sample[index], context);
}

namespace {
constexpr LevelInfo levels[] = {
    {"world", msg::ObjectPoseArray::ros_type, "", "Poses of all objects."},
};
}  // namespace

constinit const Kind kind = make_kind<OverheadCamera>({
    .name = "overhead_camera",
    .help = "Camera above the field that reports the poses of all objects.",
    .levels = levels,
    .needs_render_scene = true,
});

}  // namespace sandlot::overhead_camera
