#include "devices/cameras/ground_sensor/ground_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math.h"
#include "optics/picture.h"

namespace sandlot::ground_sensor {
namespace {

struct Pixel {
  std::array<std::uint8_t, 3> rgb;
  float depth_m;

  float reflectance() const {
    if (!std::isfinite(depth_m)) return 0;
    return (0.2126f * static_cast<float>(rgb[0]) + 0.7152f * static_cast<float>(rgb[1]) +
            0.0722f * static_cast<float>(rgb[2])) /
           255.0f;
  }
};

}  // namespace

Result<GroundSensor> GroundSensor::create(const DeviceBuild& build, Spec spec) {
  GroundSensor sensor{std::move(spec)};
  sensor.key = build.key;
  sensor.body = build.body().index;
  for (const Spot& spot : sensor.spec.spots)
    sensor.X_LSpot.push_back(build.decl.X_LS *
                             Pose{{spot.x_m, spot.y_m, 0}, quat_from_axis_angle({0, 1, 0}, math::pi / 2)});
  SL_ASSIGN(const optics::Lens lens, optics::pinhole_of_fov(1, 1, sensor.spec.fov_rad));
  sensor.lens = optics::LensTable::make(lens);
  sensor.state.noise.reset(sensor.spec.noise.stages, Stream(build.seed, build.key, Purpose::initial, 0));
  sensor.reflectance = build.publish<msg::Float32MultiArray>(0, "reflectance");
  msg::Float32MultiArray& message = sensor.reflectance->message;
  const auto spots = static_cast<std::uint32_t>(sensor.spec.spots.size());
  message.layout.dim.push_back({"spots", spots, spots});
  message.data.assign(spots, 0);
  return sensor;
}

void GroundSensor::sense(PoolView<GroundSensor> pool, const Context& context) {
  SL_CHECK(context.pictures != nullptr);
  static thread_local std::vector<Pixel> pixels;
  static thread_local std::vector<optics::PictureJob> jobs;
  std::size_t spots = 0;
  for (const std::uint32_t index : pool.due) spots += pool.all[index].X_LSpot.size();
  pixels.resize(spots);
  jobs.clear();
  for (const std::uint32_t index : pool.due) {
    const GroundSensor& sensor = pool.all[index];
    const Pose& X_WL = context.engine.states()[sensor.body].X_WB;
    for (std::size_t i = 0; i < sensor.X_LSpot.size(); ++i) {
      Pixel& pixel = pixels[jobs.size()];
      optics::PictureJob& job = jobs.emplace_back();
      job.X_WS = X_WL * sensor.X_LSpot[i];
      job.lens = sensor.lens;
      job.exposure.samples = sensor.spec.samples;
      job.exposure.lit = false;
      job.key = hash_combine(sensor.key, i);
      job.ignore_body = sensor.body;
      job.far_m = sensor.spec.range_m;
      job.rgb = pixel.rgb;
      job.depth_m = {&pixel.depth_m, 1};
    }
  }
  context.pictures->render(jobs);
  jobs.clear();  // a lens may go with its sensor
  std::size_t at = 0;
  for (const std::uint32_t index : pool.due) {
    GroundSensor& sensor = pool.all[index];
    std::vector<float>& shown = sensor.reflectance->message.data;
    shown.resize(sensor.X_LSpot.size());
    for (float& value : shown) value = pixels[at++].reflectance();
    const Stream random(context.seed, sensor.key, Purpose::noise, pool.sample[index]);
    if (!sensor.spec.noise.stages.empty())
      sensor.state.noise.corrupt(sensor.spec.noise.stages, shown, pool.since[index].s(), random,
                                 sensor.spec.errors);
    for (float& value : shown) value = value > 0 ? std::min(value, 1.0f) : 0.0f;  // not a number: 0
    sensor.reflectance->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"reflectance", msg::Float32MultiArray::ros_type, "", "Brightness of the floor below each spot."},
};
}  // namespace

constinit const Kind kind = make_kind<GroundSensor>({
    .name = "ground_sensor",
    .help = "Brightness of the floor below a few spots.",
    .levels = levels,
    .needs_render_scene = true,
});

}  // namespace sandlot::ground_sensor
