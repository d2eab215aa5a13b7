#include "devices/cameras/light_sensor/light_sensor.h"

#include <algorithm>

#include "optics/picture.h"

namespace sandlot::light_sensor {

Result<LightSensor> LightSensor::create(const DeviceBuild& build, Spec spec) {
  LightSensor sensor{std::move(spec)};
  sensor.key = build.key;
  sensor.body = build.body().index;
  sensor.X_LS = build.decl.X_LS;
  Stream random(build.seed, build.key, Purpose::initial, 0);
  sensor.state.noise.reset(sensor.spec.noise, random);
  sensor.illuminance = build.publish<msg::Illuminance>(0, "illuminance");
  sensor.illuminance->message.header.frame_id = build.frame_id();
  sensor.illuminance->message.variance = sensor.spec.noise.variance(
      sensor.spec.rate_hz > 0 ? 1 / sensor.spec.rate_hz : build.tick.s(), sensor.spec.errors);
  return sensor;
}

void LightSensor::sense(PoolView<LightSensor> pool, const Context& context) {
  SL_CHECK(context.pictures != nullptr);
  static thread_local std::vector<optics::LightProbe> probes;  // keeps its room
  probes.clear();
  for (const std::uint32_t index : pool.due) {
    const LightSensor& sensor = pool.all[index];
    const Pose X_WS = context.engine.states()[sensor.body].X_WB * sensor.X_LS;
    probes.push_back({X_WS.p, rotate(X_WS.q, {1, 0, 0}), sensor.spec.own_shadow ? no_body : sensor.body});
  }
  context.pictures->illuminate(probes);
  for (std::size_t i = 0; i < pool.due.size(); ++i) {
    const std::uint32_t index = pool.due[i];
    LightSensor& sensor = pool.all[index];
    const Color& light = probes[i].light;
    const double luminance = 0.2126 * static_cast<double>(light.r) + 0.7152 * static_cast<double>(light.g) +
                             0.0722 * static_cast<double>(light.b);
    Stream random(context.seed, sensor.key, Purpose::noise, pool.sample[index]);
    const double shown = sensor.state.noise.corrupt(sensor.spec.noise, sensor.spec.lux * luminance,
                                                    pool.since[index].s(), random, sensor.spec.errors);
    sensor.illuminance->message.illuminance = std::max(0.0, shown);
    sensor.illuminance->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"illuminance", msg::Illuminance::ros_type, "", "Illuminance at the sensor."},
};
}  // namespace

constinit const Kind kind = make_kind<LightSensor>({
    .name = "light_sensor",
    .help = "Photo cell: illuminance at the sensor.",
    .levels = levels,
    .needs_render_scene = true,
});

}  // namespace sandlot::light_sensor
