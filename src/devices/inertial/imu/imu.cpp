#include "devices/inertial/imu/imu.h"

#include <cmath>

#include "base/math.h"
#include "base/text.h"
#include "devices/sdf_noise.h"

namespace sandlot::imu {
namespace {

enum Level : std::uint32_t { imu_level, pose_level };
constexpr std::uint64_t pose_use = 1, orientation_use = 2;  // of the device's stream

struct Motion {
  Vec3 v_W;  ///< of S's origin
  Quat q_WS;
};

Motion motion_of(const Imu& imu, const BodyState& link) {
  return {link.V_WB.linear + cross(link.V_WB.angular, rotate(link.X_WB.q, imu.X_LS.p)),
          normalised(link.X_WB.q * imu.X_LS.q)};
}

/// Axis times angle of the shorter way round.
Vec3 rotation_vector(Quat q) {
  if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
  const Vec3 v{q.x, q.y, q.z};
  const double s = norm(v);
  return s > 1e-12 ? v * (2 * math::atan2(s, q.w) / s) : v * 2.0;
}

/// The inverse of rotation_vector().
Quat turn_by(Vec3 v) {
  const double angle = norm(v);
  return angle > 0 ? quat_from_axis_angle(v / angle, angle) : Quat{};
}

/// Adds the sub-step that ends now.
void count(Imu& imu, const Motion& now) {
  State& state = imu.state;
  if (state.running_s == 0) return;
  Quat end = now.q_WS;
  if (state.q_WS.w * end.w + state.q_WS.x * end.x + state.q_WS.y * end.y + state.q_WS.z * end.z < 0)
    end = {-end.w, -end.x, -end.y, -end.z};
  const Quat half = normalised(
      {state.q_WS.w + end.w, state.q_WS.x + end.x, state.q_WS.y + end.y, state.q_WS.z + end.z});
  state.velocity_S += rotate_inverse(half, now.v_W - state.v_W - imu.gravity_mps2 * state.running_s);
  state.turn_S += rotation_vector(conjugate(state.q_WS) * end);
  state.counted_s += state.running_s;
  state.running_s = 0;
}

/// The exact discretisation of the walk over dt, of errors and of their variances.
void walk(const PoseSpec& spec, PoseState& state, double dt_s, double errors, Stream random) {
  const double q = errors * spec.velocity_walk, step = q * std::sqrt(dt_s);
  for (std::size_t i = 0; i < 3; ++i) {
    const double a = random.normal(), b = random.normal();
    state.position_m[i] += state.velocity_mps[i] * dt_s + step * dt_s * (0.5 * a + b / std::sqrt(12.0));
    state.velocity_mps[i] += step * a;
  }
  state.yaw_rad += errors * spec.yaw_walk * std::sqrt(dt_s) * random.normal();
  auto& [velocity, position, yaw] = state.variance;
  position += dt_s * (2 * state.covariance + dt_s * velocity) + q * q * dt_s * dt_s * dt_s / 3;
  state.covariance += dt_s * velocity + q * q * dt_s * dt_s / 2;
  velocity += q * q * dt_s;
  yaw += errors * errors * spec.yaw_walk * spec.yaw_walk * dt_s;
}

void publish_pose(Imu& imu, std::uint64_t sample, Time since, const Context& context) {
  PoseState& state = imu.state.pose;
  const Stream random = Stream(context.seed, imu.key, Purpose::noise, sample).fork(pose_use);
  if (state.begun) walk(imu.spec.pose, state, since.s(), imu.spec.errors, random);
  state.begun = true;
  msg::PoseWithCovariance& pose = imu.pose->message.pose;
  const Pose& X_WB = context.engine.states()[imu.base].X_WB;
  pose.pose = {X_WB.p + state.position_m,
               normalised(quat_from_axis_angle({0, 0, 1}, state.yaw_rad) * X_WB.q)};
  for (const std::size_t i : {0u, 7u, 14u}) pose.covariance[i] = state.variance[1];
  pose.covariance[35] = state.variance[2];
  imu.pose->publish(context.now);
}

std::array<double, 9> covariance(const AxesNoiseSpec& spec, double dt_s, double errors) {
  std::array<double, 9> out{};
  out[0] = spec.x.variance(dt_s, errors);
  out[4] = spec.y.variance(dt_s, errors);
  out[8] = spec.z.variance(dt_s, errors);
  return out;
}

/// The older form: <noise><type/><rate>...</rate><accel>...</accel></noise>, alike for all axes.
Status old_noise(const Node& noise, Node& config, Diagnostics& diagnostics) {
  using namespace sdf_element;
  for (const auto& [name, key] : {std::pair{"rate", "gyro"}, std::pair{"accel", "accel"}}) {
    const Node* const part = find(noise, name);
    if (!part || !part->is_map()) continue;
    Node whole = *part;
    whole.set("type", Node::scalar(text(find(noise, "type")), noise.place()));
    SL_ASSIGN(const Node errors, channel_noise(whole, diagnostics));
    Node keys = Node::map(part->place());
    if (!errors.entries().empty())
      for (const char* axis : {"x", "y", "z"}) keys.set(axis, errors);
    config.set(key, std::move(keys));
  }
  return {};
}

Status reference_keys(const Node& frame, Node& config, Diagnostics& diagnostics) {
  using namespace sdf_element;
  warn_unknown(frame, {"localization", "custom_rpy", "grav_dir_x"}, "<orientation_reference_frame>",
               diagnostics);
  const std::string name = text(find(frame, "localization"));
  const auto custom = [&](const std::string& rpy) {
    config.set("reference", Node::scalar("custom", frame.place()));
    Node list = Node::sequence(frame.place());
    for (const std::string_view part : split(rpy, ' '))
      if (!trim(part).empty()) list.push(Node::scalar(std::string(trim(part)), frame.place()));
    config.set("reference_rpy", std::move(list));
  };
  if (name == "ENU") config.set("reference", Node::scalar("world", frame.place()));
  else if (name == "NWU") custom("0 0 " + number_text(math::pi / 2));
  else if (name == "NED") custom(number_text(math::pi) + " 0 " + number_text(math::pi / 2));
  else if (name == "CUSTOM") {
    const Node* const rpy = find(frame, "custom_rpy");
    custom(rpy && !text(rpy).empty() ? text(rpy) : "0 0 0");
  } else {
    diagnostics.warn(frame.error("the reference frame '" + name.substr(0, 40) +
                                     "' of an imu is not supported: the orientation is relative to the start",
                                 "ENU, NED, NWU and CUSTOM are"));
  }
  return {};
}

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  // A sensor has <update_rate>; the older plugins of models have <updateRate> and <gaussianNoise>.
  config.set("rate", Node::scalar("0", element.place()));
  SL_TRY(copy_number(element, {"update_rate", "updateRate", "update_rate_hz"}, 1.0, config, "rate"));
  config.set("reference", Node::scalar("start", element.place()));
  for (const char* name : {"bodyName", "body_name"})
    if (find(element, name)) copy(element, name, config, "link");
  SL_ASSIGN(const auto gaussian, number(element, "gaussianNoise"));
  if (gaussian && *gaussian != 0) {
    Node axis = Node::map(element.place());
    axis.set("white", scalar(*gaussian, *find(element, "gaussianNoise")));
    Node axes = Node::map(element.place());
    for (const char* name : {"x", "y", "z"}) axes.set(name, axis);
    config.set("gyro", axes);
    config.set("accel", std::move(axes));
  }
  const Node* const imu = find(element, "imu");
  if (!imu) return config;
  if (!imu->is_map()) return config;
  warn_unknown(*imu,
               {"angular_velocity", "linear_acceleration", "orientation_reference_frame", "noise", "topic",
                "enable_orientation"},
               "<imu>", diagnostics);
  if (const Node* const group = find(*imu, "angular_velocity")) {
    SL_ASSIGN(Node keys, axes_noise(*group, diagnostics));
    config.set("gyro", std::move(keys));
  }
  if (const Node* const group = find(*imu, "linear_acceleration")) {
    SL_ASSIGN(Node keys, axes_noise(*group, diagnostics));
    config.set("accel", std::move(keys));
  }
  if (const Node* const noise = find(*imu, "noise")) SL_TRY(old_noise(*noise, config, diagnostics));
  if (const Node* const frame = find(*imu, "orientation_reference_frame"))
    SL_TRY(reference_keys(*frame, config, diagnostics));
  return config;
}

}  // namespace

Result<Imu> Imu::create(const DeviceBuild& build, Spec spec) {
  Imu imu{spec};
  imu.key = build.key;
  imu.body = build.body().index;
  imu.X_LS = build.decl.X_LS;
  imu.gravity_mps2 = build.gravity_mps2;
  const Quat q_WS = (build.instance.X_WM * build.instance.model->links[build.decl.link].X_ML * imu.X_LS).q;
  const Vec3 rpy = spec.reference_rpy_rad;
  switch (spec.reference) {
    case Reference::start: imu.q_RW = conjugate(normalised(q_WS)); break;
    case Reference::world: break;
    case Reference::custom: imu.q_RW = conjugate(quat_from_rpy(rpy.x, rpy.y, rpy.z)); break;
  }
  Stream random(build.seed, build.key, Purpose::initial, 0);
  imu.state.gyro.reset(spec.gyro, random, "gyro");
  imu.state.accel.reset(spec.accel, random, "accel");
  imu.state.orientation.reset(spec.orientation, random, "orientation");
  imu.base = build.bodies.front().index;
  imu.message = build.publish<msg::Imu>(imu_level, "imu");
  imu.pose = build.publish<msg::PoseWithCovarianceStamped>(pose_level, "pose");
  imu.pose->message.header.frame_id = "world";
  msg::Imu& message = imu.message->message;
  message.header.frame_id = build.frame_id();
  const double interval_s = spec.rate_hz > 0 ? 1 / spec.rate_hz : build.tick.s();
  message.angular_velocity_covariance = covariance(spec.gyro, interval_s, spec.errors);
  message.linear_acceleration_covariance = covariance(spec.accel, interval_s, spec.errors);
  message.orientation_covariance = covariance(spec.orientation, interval_s, spec.errors);
  return imu;
}

void Imu::pre_substep(PoolView<Imu> pool, const Context& context, double h_s) {
  const auto states = context.engine.states();
  for (const std::uint32_t index : pool.due) {
    if (!(pool.levels[index] >> imu_level & 1)) continue;
    Imu& imu = pool.all[index];
    const Motion now = motion_of(imu, states[imu.body]);
    count(imu, now);
    imu.state.v_W = now.v_W;
    imu.state.q_WS = now.q_WS;
    imu.state.running_s = h_s;
  }
}

void Imu::sense(PoolView<Imu> pool, const Context& context) {
  const auto states = context.engine.states();
  for (const std::uint32_t index : pool.due) {
    Imu& imu = pool.all[index];
    if (pool.levels[index] >> pose_level & 1)
      publish_pose(imu, pool.sample[index], pool.since[index], context);
    if (!(pool.levels[index] >> imu_level & 1)) continue;
    State& state = imu.state;
    const Motion now = motion_of(imu, states[imu.body]);
    count(imu, now);
    Vec3 rate = rotate_inverse(now.q_WS, states[imu.body].V_WB.angular);
    Vec3 force = rotate_inverse(now.q_WS, -imu.gravity_mps2);
    if (state.counted_s > 0) {
      rate = state.turn_S / state.counted_s;
      force = state.velocity_S / state.counted_s;
    }
    state.counted_s = 0;
    state.velocity_S = state.turn_S = {};
    Stream random(context.seed, imu.key, Purpose::noise, pool.sample[index]);
    const double dt_s = pool.since[index].s();
    msg::Imu& message = imu.message->message;
    Stream turned = random.fork(orientation_use);
    const Vec3 turn = state.orientation.corrupt(imu.spec.orientation, {}, dt_s, turned, imu.spec.errors);
    message.orientation = normalised(turn_by(turn) * imu.q_RW * now.q_WS);
    message.angular_velocity = state.gyro.corrupt(imu.spec.gyro, rate, dt_s, random, imu.spec.errors);
    message.linear_acceleration = state.accel.corrupt(imu.spec.accel, force, dt_s, random, imu.spec.errors);
    imu.message->publish(context.now);
  }
}

Status Imu::switch_level(std::uint32_t before, std::uint32_t after, const Context&) {
  const std::uint32_t fresh = after & ~before;
  if (fresh >> imu_level & 1) {
    state.running_s = state.counted_s = 0;
    state.velocity_S = state.turn_S = {};
  }
  if (fresh >> pose_level & 1) state.pose = {};
  return {};
}

Result<msg::std_srvs::Trigger::Response> Imu::calibrate(const msg::std_srvs::Trigger::Request&,
                                                        const Context& context) {
  constexpr double most_radps = 0.01;
  const double turning_radps = norm(context.engine.states()[body].V_WB.angular);
  if (turning_radps > most_radps)
    return msg::std_srvs::Trigger::Response{
        false, "the unit turns at " + number_text(turning_radps) + " rad/s; hold it still"};
  const auto zero = [](const ChannelNoiseSpec& axis, ChannelNoise& noise) {
    noise.drawn = -axis.mean - noise.bias.bias;
  };
  zero(spec.gyro.x, state.gyro.x);
  zero(spec.gyro.y, state.gyro.y);
  zero(spec.gyro.z, state.gyro.z);
  return msg::std_srvs::Trigger::Response{true, "the offsets of the gyroscopes are set"};
}

namespace {
using msg::std_srvs::Trigger;
constexpr DeviceService services[] = {device_service<Imu, Trigger, &Imu::calibrate>(
    "calibrate", "Sets the offsets of the gyroscopes, at rest.")};
constexpr LevelInfo levels[] = {
    {"imu", msg::Imu::ros_type, "", "Rates, specific force and orientation."},
    {"pose", msg::PoseWithCovarianceStamped::ros_type, "", "Pose by inertial navigation."},
};
constexpr const char* sdf_types[] = {"sensor:imu", "plugin:gazebo_ros_imu", "plugin:gazebo_ros_imu_sensor",
                                     "plugin:hector_gazebo_ros_imu"};
constexpr Preset presets[] = {
    {"razor_9dof",
     "SparkFun 9DOF Razor (ITG-3200, ADXL345, HMC5883L): 50 Hz, gyro 0.38 deg/s and accelerometer 4 mg rms, "
     "heading 1.5 deg, level 0.5 deg, slow drift (general knowledge of the data sheets; the drift is "
     "uncertain).",
     "{rate: 50,"
     " gyro: {x: &g {white: 6.6e-3, bias: {bias_std: 9e-4, correlation: 100}, resolution: 1.214e-3, limit: "
     "34.9},"
     " y: *g, z: *g},"
     " accel: {x: &a {white: 0.039, bias: {bias_std: 0.02, correlation: 300}, resolution: 0.0383, limit: "
     "156.9},"
     " y: *a, z: *a},"
     " orientation: {x: &t {white: 2e-3, bias: {bias_std: 8.7e-3, correlation: 10}}, y: *t,"
     " z: {white: 3e-3, bias: {bias_std: 0.026, correlation: 60}}}}"},
};
}  // namespace

constinit const Kind kind = make_kind<Imu>({
    .name = "imu",
    .help = "Inertial measurement unit: gyroscopes, accelerometers, orientation.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic and frame names, xyzOffset and rpyOffset, grav_dir_x, hector's drift parameters",
    .presets = presets,
    .services = services,
});

}  // namespace sandlot::imu
