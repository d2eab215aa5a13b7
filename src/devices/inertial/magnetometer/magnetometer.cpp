#include "devices/inertial/magnetometer/magnetometer.h"

#include "base/math.h"
#include "devices/sdf_noise.h"

namespace sandlot::magnetometer {
namespace {

enum Level : std::uint32_t { field_level, heading_level };

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  copy_rate(element, "update_rate", config);
  const Node* const own = find(element, "magnetometer");
  if (!own || !own->is_map()) return config;
  warn_unknown(*own, {"x", "y", "z", "topic"}, "<magnetometer>", diagnostics);
  for (const char* axis : {"x", "y", "z"}) {
    const Node* const noise = find(*own, std::string(axis) + "/noise");
    if (!noise) continue;
    SL_ASSIGN(Node errors, channel_noise(*noise, diagnostics));
    if (!errors.entries().empty()) config.set(axis, std::move(errors));
  }
  return config;
}

}  // namespace

Result<Magnetometer> Magnetometer::create(const DeviceBuild& build, Spec spec) {
  Magnetometer m{spec};
  m.key = build.key;
  m.body = build.body().index;
  m.q_LS = build.decl.X_LS.q;
  m.field_T = build.magnetic_field_T;
  if (build.levels >> heading_level & 1 && math::hypot(m.field_T.x, m.field_T.y) == 0)
    return Error{"the magnetic field of this world has no horizontal part, so there is no heading in it",
                 "give the world file a <magnetic_field>, or leave the level heading out", build.decl.place};
  m.declination = math::atan2(m.field_T.y, m.field_T.x);
  Stream random(build.seed, build.key, Purpose::initial, 0);
  m.state.x.reset(spec.x, random, "x");
  m.state.y.reset(spec.y, random, "y");
  m.state.z.reset(spec.z, random, "z");
  m.field = build.publish<msg::MagneticField>(field_level, "field");
  m.heading = build.publish<msg::Float64>(heading_level, "heading");
  msg::MagneticField& message = m.field->message;
  message.header.frame_id = build.frame_id();
  const double interval_s = spec.rate_hz > 0 ? 1 / spec.rate_hz : build.tick.s();
  message.magnetic_field_covariance[0] = spec.x.variance(interval_s, spec.errors);
  message.magnetic_field_covariance[4] = spec.y.variance(interval_s, spec.errors);
  message.magnetic_field_covariance[8] = spec.z.variance(interval_s, spec.errors);
  return m;
}

void Magnetometer::sense(PoolView<Magnetometer> pool, const Context& context) {
  const auto states = context.engine.states();
  for (const std::uint32_t index : pool.due) {
    Magnetometer& m = pool.all[index];
    const Spec& spec = m.spec;
    const Quat q_WS = states[m.body].X_WB.q * m.q_LS;
    const Vec3 b = rotate_inverse(q_WS, m.field_T) + spec.hard_iron_T, d = spec.soft_iron,
               c = spec.soft_iron_cross;
    Vec3 shown{d.x * b.x + c.x * b.y + c.y * b.z, c.x * b.x + d.y * b.y + c.z * b.z,
               c.y * b.x + c.z * b.y + d.z * b.z};
    Stream random(context.seed, m.key, Purpose::noise, pool.sample[index]);
    const double dt_s = pool.since[index].s();
    shown.x = m.state.x.corrupt(spec.x, shown.x, dt_s, random, spec.errors);
    shown.y = m.state.y.corrupt(spec.y, shown.y, dt_s, random, spec.errors);
    shown.z = m.state.z.corrupt(spec.z, shown.z, dt_s, random, spec.errors);
    if (pool.levels[index] >> field_level & 1) {
      m.field->message.magnetic_field = shown;
      m.field->publish(context.now);
    }
    if (pool.levels[index] >> heading_level & 1) {
      // Turned into the horizontal plane that has S's heading, the field stands at (declination - heading).
      const Vec3 x_W = rotate(q_WS, {1, 0, 0});
      const double yaw = math::atan2(x_W.y, x_W.x);
      const Vec3 level = rotate(conjugate(quat_from_axis_angle({0, 0, 1}, yaw)) * q_WS, shown);
      m.heading->message.data = math::wrap_angle(m.declination - math::atan2(level.y, level.x));
      m.heading->publish(context.now);
    }
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"field", msg::MagneticField::ros_type, "", "Magnetic field in the sensor's frame."},
    {"heading", msg::Float64::ros_type, "", "Heading in the world, as of a compass."},
};
constexpr const char* sdf_types[] = {"sensor:magnetometer"};
constexpr Preset presets[] = {
    {"hmc5883l",
     "Honeywell HMC5883L, as on the SparkFun 9DOF Razor: 2 mG rms per sample, steps of 0.73 mG (its data "
     "sheet), 50 Hz.",
     "{rate: 50, x: &a {white: 2.0e-7, resolution: 7.3e-8, limit: 1.3e-4}, y: *a, z: *a}"},
};
}  // namespace

constinit const Kind kind = make_kind<Magnetometer>({
    .name = "magnetometer",
    .help = "Magnetometer: magnetic field, or heading as a compass.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic names",
    .presets = presets,
});

}  // namespace sandlot::magnetometer
