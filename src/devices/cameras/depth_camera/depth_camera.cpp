#include "devices/cameras/depth_camera/depth_camera.h"

#include "devices/cameras/camera_sdf.h"

namespace sandlot::depth_camera {

Result<Camera> Camera::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(cameras::check_exposure({spec.near_m, spec.far_m}, build));
  SL_ASSIGN(const optics::Lens lens, cameras::lens_of(spec, build));
  const std::string optical = build.frame("optical", cameras::X_S_optical);
  auto* const image = build.publish<msg::Image>(0, "depth");
  auto* const info = build.publish<msg::CameraInfo>(0, "camera_info");
  auto* const points = spec.points ? build.publish<msg::PointCloud2>(0, "points") : nullptr;
  cameras::fill_info(info->message, lens, optical);
  cameras::DepthImage depth(image, points, lens, spec.encoding, optical, false);
  return Camera{std::move(spec), {}, cameras::CameraMount(build, lens), std::move(depth), info};
}

void Camera::sense(PoolView<Camera> pool, const Context& context) {
  cameras::JobBatch batch(context);
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    optics::PictureJob job = camera.mount.job({0, camera.spec.far_m}, context);
    job.depth_m = camera.depth.depth_m();
    batch.add(std::move(job));
  }
  batch.flush();
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    const Stream random(context.seed, camera.mount.key, Purpose::noise, pool.sample[index]);
    camera.depth.finish(camera.spec.near_m, camera.spec.noise, camera.spec.errors, random, {}, context.now);
    camera.info->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {{"depth", msg::Image::ros_type, "", "The depth of every pixel."}};
constexpr const char* sdf_types[] = {"sensor:depth", "sensor:depth_camera"};
}  // namespace

constinit const Kind kind = make_kind<Camera>({
    .name = "depth_camera",
    .help = "Depth camera: the distance of every pixel and the points they belong to.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf =
        [](const Node& element, Diagnostics& diagnostics) {
          return sdf_element::camera_keys(element, diagnostics, {.depth = true});
        },
    .sdf_note = cameras::camera_sdf_note,
    .needs_render_scene = true,
});

}  // namespace sandlot::depth_camera
