#include "devices/cameras/stereo_camera/stereo_camera.h"

#include "devices/cameras/camera_sdf.h"

namespace sandlot::stereo_camera {

Result<Camera> Camera::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(cameras::check_exposure(spec, build));
  if (spec.lens != cameras::Projection::pinhole || !spec.distortion.none())
    return build.error(spec.distortion.none() ? "lens" : "distortion",
                       "the pictures of a stereo camera are rectified", "a pinhole without distortion");
  SL_ASSIGN(const optics::Lens lens, cameras::lens_of(spec, build));
  const std::string optical = build.frame("optical", cameras::X_S_optical);
  Camera camera{std::move(spec), {}, {}};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string side = i == 0 ? "left" : "right";
    Side& s = camera.sides[i];
    s.mount = cameras::CameraMount(build, lens);
    if (i == 1) s.mount.X_LS = s.mount.X_LS * Pose{{0, -camera.spec.baseline_m, 0}, {}};
    s.picture = cameras::ColorImage(build, build.publish<msg::Image>(0, (side + "/image").c_str()), lens,
                                    camera.spec.format, camera.spec.noise, optical, i);
    s.info = build.publish<msg::CameraInfo>(0, (side + "/camera_info").c_str());
    cameras::fill_info(s.info->message, lens, optical, i == 0 ? 0 : camera.spec.baseline_m);
  }
  return camera;
}

void Camera::sense(PoolView<Camera> pool, const Context& context) {
  cameras::JobBatch batch(context);
  for (const std::uint32_t index : pool.due)
    for (Side& side : pool.all[index].sides) {
      optics::PictureJob job = side.mount.job(pool.all[index].spec, context);
      job.rgb = side.picture.rgb();
      batch.add(std::move(job));
    }
  batch.flush();
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    for (Side& side : camera.sides) {
      side.picture.finish(camera.spec, camera.spec.noise, camera.spec.errors, pool.sample[index], context);
      side.info->publish(context.now);
    }
  }
}

namespace {
constexpr LevelInfo levels[] = {{"image", msg::Image::ros_type, "", "Pictures of both eyes."}};
constexpr const char* sdf_types[] = {"sensor:multicamera"};
}  // namespace

constinit const Kind kind = make_kind<Camera>({
    .name = "stereo_camera",
    .help = "Two cameras side by side with rectified pictures.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = sdf_element::stereo_keys,
    .sdf_note = cameras::camera_sdf_note,
    .needs_render_scene = true,
});

}  // namespace sandlot::stereo_camera
