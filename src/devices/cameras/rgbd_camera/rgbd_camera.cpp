#include "devices/cameras/rgbd_camera/rgbd_camera.h"

#include "devices/cameras/camera_sdf.h"

namespace sandlot::rgbd_camera {

Result<Camera> Camera::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(cameras::check_exposure(spec, build));
  SL_ASSIGN(const optics::Lens lens, cameras::lens_of(spec, build));
  const std::string optical = build.frame("optical", cameras::X_S_optical);
  auto* const image = build.publish<msg::Image>(0, "image");
  auto* const deep = build.publish<msg::Image>(0, "depth");
  auto* const info = build.publish<msg::CameraInfo>(0, "camera_info");
  auto* const points = spec.points ? build.publish<msg::PointCloud2>(0, "points") : nullptr;
  cameras::fill_info(info->message, lens, optical);
  cameras::ColorImage color(build, image, lens, spec.format, spec.noise, optical);
  cameras::DepthImage depth(deep, points, lens, spec.encoding, optical, true);
  return Camera{std::move(spec),  {},  cameras::CameraMount(build, lens), std::move(color),
                std::move(depth), info};
}

void Camera::sense(PoolView<Camera> pool, const Context& context) {
  cameras::JobBatch batch(context);
  for (const std::uint32_t index : pool.due) {
    Camera& camera = pool.all[index];
    optics::PictureJob job = camera.mount.job(camera.spec, context);
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
    const Stream random = Stream(context.seed, camera.mount.key, Purpose::noise, sample)
                              .fork(hash64("depth"));
    camera.depth.finish(spec.near_m, spec.depth_noise, spec.errors, random, camera.true_rgb, context.now);
    camera.info->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {{"image", msg::Image::ros_type, "", "Colour and depth of every pixel."}};
constexpr const char* sdf_types[] = {"sensor:rgbd_camera", "sensor:rgbd"};
constexpr Preset presets[] = {
    {"kinect_v1",
     "Microsoft Kinect (Xbox 360): 640 x 480, 57 deg, 30 Hz, 0.8 to 4 m; depth from disparities in steps of "
     "1/8 "
     "pixel over 75 mm, with an error of 1.4 mm at 1 m that grows with the square (Khoshelham and Oude "
     "Elberink "
     "2012; range and field of view from the maker; the shadow beside edges and the colours' errors are "
     "ours).",
     "{width: 640, height: 480, horizontal_fov: 57 deg, rate: 30, near: 0.8, far: 4, encoding: 16UC1,"
     " depth_noise: [{quadratic: {std: 1.4 mm}}, {disparity: {step: 0.125, focal_baseline: 44.2 m}},"
     " {edges: {jump: 10 cm, rate: 80 %, shows: nan}}],"
     " noise: [{shot: {full_well: 6000}}, {gaussian: {std: 1 %}}]}"},
    {"kinect_v2",
     "Microsoft Kinect (Xbox One), time of flight: 512 x 424, 70.6 deg, 30 Hz, 0.5 to 4.5 m (field of view "
     "and "
     "range from the maker; depth errors of about 2 mm and pixels between two surfaces as in Wasenmueller "
     "and "
     "Stricker 2017, the numbers general knowledge). Colours are those of the depth's pixels.",
     "{width: 512, height: 424, horizontal_fov: 70.6 deg, rate: 30, near: 0.5, far: 4.5, encoding: 16UC1,"
     " depth_noise: [{gaussian: {std: 1.5 mm}}, {quadratic: {std: 0.2 mm}},"
     " {edges: {jump: 5 cm, rate: 50 %, shows: mixed}}],"
     " noise: [{shot: {full_well: 10000}}, {gaussian: {std: 0.6 %}}]}"},
    {"realsense_d435",
     "Intel RealSense D435, stereo over 50 mm: 848 x 480, 87 deg, 30 Hz, from 0.195 m (data sheet of the "
     "D400 "
     "series; depth error z^2 0.08 pixel / (f baseline), so 14 mm at 2 m where the sheet allows 2 %). "
     "Colours are "
     "those of the depth's pixels; their errors are ours.",
     "{width: 848, height: 480, horizontal_fov: 87 deg, rate: 30, near: 0.195, far: 10, encoding: 16UC1,"
     " depth_noise: [{quadratic: {std: 3.58 mm}}, {disparity: {step: 0.03125, focal_baseline: 22.34 m}},"
     " {edges: {jump: 10 cm, rate: 70 %, shows: nan}}],"
     " noise: [{shot: {full_well: 8000}}, {gaussian: {std: 0.6 %}}]}"},
};
}  // namespace

constinit const Kind kind = make_kind<Camera>({
    .name = "rgbd_camera",
    .help = "Camera of colour and depth of the same pixels, and the points they belong to.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf =
        [](const Node& element, Diagnostics& diagnostics) {
          return sdf_element::camera_keys(element, diagnostics, {.color = true, .depth = true});
        },
    .sdf_note = cameras::camera_sdf_note,
    .presets = presets,
    .needs_render_scene = true,
});

}  // namespace sandlot::rgbd_camera
