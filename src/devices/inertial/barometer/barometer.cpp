#include "devices/inertial/barometer/barometer.h"

#include <algorithm>

#include "base/math.h"
#include "devices/sdf_noise.h"

namespace sandlot::barometer {
namespace {

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  copy_rate(element, "update_rate", config);
  const Node* const own = find(element, "air_pressure");
  if (!own || !own->is_map()) return config;
  warn_unknown(*own, {"reference_altitude", "pressure", "topic"}, "<air_pressure>", diagnostics);
  copy(*own, "reference_altitude", config, "reference_altitude");
  if (const Node* const noise = find(*own, "pressure/noise")) {
    SL_ASSIGN(Node errors, channel_noise(*noise, diagnostics));
    if (!errors.entries().empty()) config.set("noise", std::move(errors));
  }
  return config;
}

}  // namespace

double pressure_Pa(double altitude_m) {
  // Above the troposphere the formula ends; far below the sea it has no meaning either.
  const double z = std::clamp(altitude_m, -5000.0, 11000.0);
  return 101325.0 * math::pow(1 - 0.0065 * z / 288.15, 5.25588);
}

Result<Barometer> Barometer::create(const DeviceBuild& build, Spec spec) {
  Barometer b{spec};
  b.key = build.key;
  b.body = build.body().index;
  b.p_LS = build.decl.X_LS.p;
  b.altitude_m = spec.reference_altitude_m.value_or(build.geography ? build.geography->elevation_m : 0);
  Stream random(build.seed, build.key, Purpose::initial, 0);
  b.state.noise.reset(spec.noise, random);
  b.pressure = build.publish<msg::FluidPressure>(0, "pressure");
  b.pressure->message.header.frame_id = build.frame_id();
  b.pressure->message.variance = spec.noise.variance(spec.rate_hz > 0 ? 1 / spec.rate_hz : build.tick.s(),
                                                     spec.errors);
  return b;
}

void Barometer::sense(PoolView<Barometer> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Barometer& b = pool.all[index];
    const double z = (context.engine.states()[b.body].X_WB * b.p_LS).z + b.altitude_m;
    Stream random(context.seed, b.key, Purpose::noise, pool.sample[index]);
    b.pressure->message.fluid_pressure = b.state.noise.corrupt(b.spec.noise, pressure_Pa(z),
                                                               pool.since[index].s(), random, b.spec.errors);
    b.pressure->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"pressure", msg::FluidPressure::ros_type, "", "Pressure of the air."},
};
constexpr const char* sdf_types[] = {"sensor:air_pressure"};
}  // namespace

constinit const Kind kind = make_kind<Barometer>({
    .name = "barometer",
    .help = "Pressure of the air.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic names",
});

}  // namespace sandlot::barometer
