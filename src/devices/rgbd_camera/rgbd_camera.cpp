#include "devices/rgbd_camera/rgbd_camera.h"

#include "devices/camera_sdf.h"

namespace sandlot::rgbd_camera {

Result<Camera> Camera::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(eye::check_exposure(spec, build));
  SL_ASSIGN(const optics::Lens lens, eye::lens_of(spec, build));
  const std::string optical = build.frame("optical", eye::X_S_optical);
  auto* const image = build.publish<msg::Image>(0, "image");
  auto* const deep = build.publish<msg::Image>(0, "depth");
  auto* const info = build.publish<msg::CameraInfo>(0, "camera_info");
  auto* const points = spec.points ? build.publish<msg::PointCloud2>(0, "points") : nullptr;
  eye::fill_info(info->message, lens, optical);
  eye::ColorImage color(build, image, lens, spec.format, spec.noise, optical);
  eye::DepthImage depth(deep, points, lens, spec.encoding, optical, true);
  return Camera{std::move(spec), {}, eye::Eye(build, lens), std::move(color), std::move(depth), info};
}

void Camera::sense(PoolView<Camera> pool, const Context& context) {
  eye::JobBatch batch(context);
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    optics::PictureJob job = camera.eye.job(camera.spec, context);
    job.near_m = 0;
    job.rgb = camera.color.rgb();
    job.depth_m = camera.depth.depth_m();
    batch.add(std::move(job));
  }
  batch.flush();
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    const Spec& spec = camera.spec;
    const std::uint64_t sample = pool.sample[index];
    if (spec.points) {
      const auto rgb = camera.color.rgb();
      camera.true_rgb.assign(rgb.begin(), rgb.end());
    }
    camera.color.finish(spec, spec.noise, spec.errors, sample, context);
    const Stream random = Stream(context.seed, camera.eye.key, Purpose::noise, sample).fork(hash64("depth"));
    camera.depth.finish(spec.near_m, spec.depth_noise, spec.errors, random, camera.true_rgb, context.now);
    camera.info->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {{"image", msg::Image::ros_type, "", "Colour and depth of every pixel."}};
constexpr const char* sdf_types[] = {"sensor:rgbd_camera", "sensor:rgbd"};
}  // namespace

constinit const Kind kind = make_kind<Camera>({
    .name = "rgbd_camera",
    .help = "Colour and depth of the same pixels, and the points they are.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf =
        [](const Node& element, Diagnostics& diagnostics) {
          return sdf_element::camera_keys(element, diagnostics, {.color = true, .depth = true});
        },
    .sdf_note = eye::camera_sdf_note,
    .sees = true,
});

}  // namespace sandlot::rgbd_camera
