#include "devices/cameras/color_sensor/color_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "optics/picture.h"

namespace sandlot::color_sensor {
namespace {

struct Pixel {
  std::array<std::uint8_t, 3> rgb;
  float depth_m;
};

}  // namespace

Result<ColorSensor> ColorSensor::create(const DeviceBuild& build, Spec spec) {
  ColorSensor sensor{std::move(spec)};
  sensor.key = build.key;
  sensor.body = build.body().index;
  sensor.X_LS = build.decl.X_LS;
  SL_ASSIGN(const optics::Lens lens, optics::pinhole_of_fov(1, 1, sensor.spec.fov_rad));
  sensor.lens = optics::LensTable::make(lens);
  sensor.state.noise.reset(sensor.spec.noise.stages, Stream(build.seed, build.key, Purpose::initial, 0));
  sensor.color = build.publish<msg::ColorRGBA>(0, "color");
  return sensor;
}

void ColorSensor::sense(PoolView<ColorSensor> pool, const Context& context) {
  SL_CHECK(context.pictures != nullptr);
  static thread_local std::vector<Pixel> pixels;
  static thread_local std::vector<optics::PictureJob> jobs;
  pixels.resize(pool.due.size());
  jobs.clear();
  for (std::size_t i = 0; i < pool.due.size(); ++i) {
    const ColorSensor& sensor = pool.all[pool.due[i]];
    optics::PictureJob& job = jobs.emplace_back();
    job.X_WS = context.engine.states()[sensor.body].X_WB * sensor.X_LS;
    job.lens = sensor.lens;
    job.exposure.samples = sensor.spec.samples;
    job.exposure.lit = !sensor.spec.lamp;
    job.key = sensor.key;
    job.ignore_body = sensor.body;
    job.far_m = sensor.spec.range_m;
    job.rgb = pixels[i].rgb;
    job.depth_m = {&pixels[i].depth_m, 1};
  }
  context.pictures->render(jobs);
  jobs.clear();  // a lens may go with its sensor
  for (std::size_t i = 0; i < pool.due.size(); ++i) {
    const std::uint32_t index = pool.due[i];
    ColorSensor& sensor = pool.all[index];
    msg::ColorRGBA& shown = sensor.color->message;
    shown = {};
    if (std::isfinite(pixels[i].depth_m)) {
      std::array<float, 3> rgb;
      for (std::size_t k = 0; k < 3; ++k) rgb[k] = static_cast<float>(pixels[i].rgb[k]) / 255.0f;
      const Stream random(context.seed, sensor.key, Purpose::noise, pool.sample[index]);
      if (!sensor.spec.noise.stages.empty())
        sensor.state.noise.corrupt(sensor.spec.noise.stages, rgb, pool.since[index].s(), random,
                                   sensor.spec.errors);
      for (float& value : rgb) value = value > 0 ? std::min(value, 1.0f) : 0.0f;  // not a number: 0
      shown = {rgb[0], rgb[1], rgb[2], 1};
    }
    sensor.color->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"color", msg::ColorRGBA::ros_type, "", "Colour of the surface before the sensor."},
};
}  // namespace

constinit const Kind kind = make_kind<ColorSensor>({
    .name = "color_sensor",
    .help = "Sensor of the colour of the surface right before it.",
    .levels = levels,
    .needs_render_scene = true,
});

}  // namespace sandlot::color_sensor
