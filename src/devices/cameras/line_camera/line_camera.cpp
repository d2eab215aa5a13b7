#include "devices/cameras/line_camera/line_camera.h"

#include <algorithm>

#include "optics/picture.h"

namespace sandlot::line_camera {
namespace {

/// The row as the message has it. Only data of this camera is touched.
void finish(LineCamera& camera, std::uint64_t sample, Time since, const Context& context) {
  const std::vector<std::uint8_t>& rgb = camera.rgb;
  if (camera.spec.format == Format::rgb8) {
    camera.values.assign(rgb.begin(), rgb.end());
  } else {
    camera.values.resize(rgb.size() / 3);
    for (std::size_t i = 0; i < camera.values.size(); ++i)
      camera.values[i] = 0.2126f * static_cast<float>(rgb[3 * i]) +
                         0.7152f * static_cast<float>(rgb[3 * i + 1]) +
                         0.0722f * static_cast<float>(rgb[3 * i + 2]);
  }
  const Stream random(context.seed, camera.key, Purpose::noise, sample);
  if (!camera.spec.noise.stages.empty())
    camera.state.noise.corrupt(camera.spec.noise.stages, camera.values, since.s(), random,
                               camera.spec.errors);
  std::vector<std::uint8_t>& data = camera.image->message.data;
  data.resize(camera.values.size());
  for (std::size_t i = 0; i < data.size(); ++i) {
    const float value = camera.values[i];
    data[i] = value > 0 ? static_cast<std::uint8_t>(std::min(value + 0.5f, 255.0f)) : std::uint8_t{0};
  }
  camera.image->publish(context.now);
}

}  // namespace

Result<LineCamera> LineCamera::create(const DeviceBuild& build, Spec spec) {
  LineCamera camera{std::move(spec)};
  camera.key = build.key;
  camera.body = build.body().index;
  camera.X_LS = build.decl.X_LS;
  SL_ASSIGN(const optics::Lens lens, optics::pinhole_of_fov(camera.spec.pixels, 1, camera.spec.fov_rad));
  camera.lens = optics::LensTable::make(lens);
  const auto pixels = static_cast<std::size_t>(camera.spec.pixels);
  camera.rgb.resize(3 * pixels);
  camera.state.noise.reset(camera.spec.noise.stages, Stream(build.seed, build.key, Purpose::initial, 0));
  camera.image = build.publish<msg::Image>(0, "image");
  msg::Image& message = camera.image->message;
  const bool mono = camera.spec.format == Format::mono8;
  message.header.frame_id = build.frame_id();
  message.height = 1;
  message.width = static_cast<std::uint32_t>(pixels);
  message.encoding = mono ? "mono8" : "rgb8";
  message.step = mono ? message.width : 3 * message.width;
  message.data.assign(message.step, 0);
  return camera;
}

void LineCamera::sense(PoolView<LineCamera> pool, const Context& context) {
  SL_CHECK(context.pictures != nullptr);
  static thread_local std::vector<optics::PictureJob> jobs;
  jobs.clear();
  for (const std::uint32_t index : pool.due) {
    LineCamera& camera = pool.all[index];
    optics::PictureJob& job = jobs.emplace_back();
    job.X_WS = context.engine.states()[camera.body].X_WB * camera.X_LS;
    job.lens = camera.lens;
    job.exposure.samples = camera.spec.samples;
    job.exposure.gain = camera.spec.gain;
    job.key = camera.key;
    job.ignore_body = camera.body;
    job.far_m = camera.spec.max_range_m;
    job.rgb = camera.rgb;
  }
  context.pictures->render(jobs);
  jobs.clear();  // a lens may go with its camera
  for (const std::uint32_t index : pool.due)
    finish(pool.all[index], pool.sample[index], pool.since[index], context);
}

namespace {
constexpr LevelInfo levels[] = {
    {"image", msg::Image::ros_type, "", "Image with one row of pixels."},
};
}  // namespace

constinit const Kind kind = make_kind<LineCamera>({
    .name = "line_camera",
    .help = "Camera with one row of pixels.",
    .levels = levels,
    .needs_render_scene = true,
});

}  // namespace sandlot::line_camera
