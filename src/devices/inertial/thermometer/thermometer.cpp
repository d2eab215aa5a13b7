#include "devices/inertial/thermometer/thermometer.h"

#include <algorithm>

#include "base/math.h"

namespace sandlot::thermometer {

Result<Thermometer> Thermometer::create(const DeviceBuild& build, Spec spec) {
  Thermometer t{std::move(spec)};
  t.key = build.key;
  t.body = build.body().index;
  t.p_LS = build.decl.X_LS.p;
  Stream random(build.seed, build.key, Purpose::initial, 0);
  t.state.noise.reset(t.spec.noise, random);
  t.temperature = build.publish<msg::Temperature>(0, "temperature");
  t.temperature->message.header.frame_id = build.frame_id();
  t.temperature->message.variance = t.spec.noise.variance(
      t.spec.rate_hz > 0 ? 1 / t.spec.rate_hz : build.tick.s(), t.spec.errors);
  return t;
}

void Thermometer::sense(PoolView<Thermometer> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Thermometer& t = pool.all[index];
    const double z = (context.engine.states()[t.body].X_WB * t.p_LS).z;
    const double air = std::max(-273.15, t.spec.ambient_degC + t.spec.gradient_degC_per_m * z);
    const double dt_s = pool.since[index].s();
    const double keep = t.state.begun && t.spec.response_s > 0 ? math::exp(-dt_s / t.spec.response_s) : 0;
    t.state.probe_degC = air + keep * (t.state.probe_degC - air);
    t.state.begun = true;
    Stream random(context.seed, t.key, Purpose::noise, pool.sample[index]);
    t.temperature->message.temperature = t.state.noise.corrupt(t.spec.noise, t.state.probe_degC, dt_s, random,
                                                               t.spec.errors);
    t.temperature->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"temperature", msg::Temperature::ros_type, "", "Temperature of the air."},
};
}  // namespace

constinit const Kind kind = make_kind<Thermometer>({
    .name = "thermometer",
    .help = "Temperature of the air.",
    .levels = levels,
});

}  // namespace sandlot::thermometer
