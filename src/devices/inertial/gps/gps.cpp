#include "devices/inertial/gps/gps.h"

#include "base/math.h"
#include "devices/sdf_noise.h"

namespace sandlot::gps {
namespace {

enum Level : std::uint32_t { fix_level, velocity_level, pose_level };
constexpr std::uint64_t pose_use = 1;  // of the device's stream

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  copy_rate(element, "update_rate", config);
  const Node* own = find(element, "navsat");
  if (!own) own = find(element, "gps");
  if (!own || !own->is_map()) return config;
  warn_unknown(*own, {"position_sensing", "velocity_sensing", "topic"}, "<navsat>", diagnostics);
  const auto noise = [&](const char* path, const char* key) -> Status {
    const Node* const found = find(*own, path);
    if (!found) return {};
    SL_ASSIGN(Node errors, channel_noise(*found, diagnostics));
    if (!errors.entries().empty()) config.set(key, std::move(errors));
    return {};
  };
  SL_TRY(noise("position_sensing/horizontal/noise", "horizontal"));
  SL_TRY(noise("position_sensing/vertical/noise", "vertical"));
  SL_TRY(noise("velocity_sensing/horizontal/noise", "speed"));
  if (find(*own, "velocity_sensing/vertical/noise") && !config.find("speed"))
    SL_TRY(noise("velocity_sensing/vertical/noise", "speed"));
  return config;
}

}  // namespace

Result<Receiver> Receiver::create(const DeviceBuild& build, Spec spec) {
  if (!build.geography)
    return Error{"the world has no place on the Earth, so a satellite receiver has nothing to show",
                 "give the world file <spherical_coordinates> with <latitude_deg> and <longitude_deg>",
                 build.decl.place};
  Receiver gps{spec};
  gps.key = build.key;
  gps.body = build.body().index;
  gps.base = build.bodies.front().index;
  gps.X_LS = build.decl.X_LS;
  gps.q_EW = quat_from_axis_angle({0, 0, 1}, build.geography->heading_rad);
  gps.plane = geodesy::LocalPlane(
      {build.geography->latitude_rad, build.geography->longitude_rad, build.geography->elevation_m});
  Stream random(build.seed, build.key, Purpose::initial, 0);
  gps.state.east.reset(spec.horizontal, random, "east");
  gps.state.north.reset(spec.horizontal, random, "north");
  gps.state.up.reset(spec.vertical, random, "up");
  gps.state.v_east.reset(spec.speed, random, "v_east");
  gps.state.v_north.reset(spec.speed, random, "v_north");
  gps.state.v_up.reset(spec.speed, random, "v_up");

  gps.fix = build.publish<msg::NavSatFix>(fix_level, "fix");
  gps.velocity = build.publish<msg::TwistStamped>(velocity_level, "velocity");
  gps.velocity->message.header.frame_id = "enu";
  gps.state.pose.reset(spec.pose, random.fork(pose_use));
  gps.pose = build.publish<msg::PoseWithCovarianceStamped>(pose_level, "pose");
  gps.pose->message.header.frame_id = "world";
  msg::NavSatFix& message = gps.fix->message;
  message.header.frame_id = build.frame_id();
  message.status.status = static_cast<std::int8_t>(spec.status);
  message.status.service = msg::NavSatStatus::gps;
  message.position_covariance_type = msg::NavSatFix::covariance_diagonal_known;
  return gps;
}

namespace {
/// Variance of a channel about the truth, what is drawn at the start included.
double channel_variance(const ChannelNoiseSpec& c, double interval_s, double errors) {
  return c.variance(interval_s, errors) + errors * errors * c.mean_std * c.mean_std;
}
}  // namespace

void Receiver::sense(PoolView<Receiver> pool, const Context& context) {
  const auto states = context.engine.states();
  for (const std::uint32_t index : pool.due) {
    Receiver& gps = pool.all[index];
    const Spec& spec = gps.spec;
    State& state = gps.state;
    const BodyState& body = states[gps.body];
    const Vec3 arm_W = rotate(body.X_WB.q, gps.X_LS.p);
    Stream random(context.seed, gps.key, Purpose::noise, pool.sample[index]);
    const double dt_s = pool.since[index].s();
    if (pool.levels[index] >> pose_level & 1) {
      msg::PoseWithCovariance& pose = gps.pose->message.pose;
      pose.pose = state.pose.corrupt(spec.pose, states[gps.base].X_WB, dt_s, random.fork(pose_use),
                                     spec.errors);
      pose.covariance = covariance_of(spec.pose, spec.errors);
      gps.pose->publish(context.now);
    }
    if (!(pool.levels[index] & (1u << fix_level | 1u << velocity_level))) continue;
    // All six, whichever of both is shown: the errors of one level do not depend on the other.
    Vec3 p = rotate(gps.q_EW, body.X_WB.p + arm_W);
    p.x = state.east.corrupt(spec.horizontal, p.x, dt_s, random, spec.errors);
    p.y = state.north.corrupt(spec.horizontal, p.y, dt_s, random, spec.errors);
    p.z = state.up.corrupt(spec.vertical, p.z, dt_s, random, spec.errors);
    Vec3 v = rotate(gps.q_EW, body.V_WB.linear + cross(body.V_WB.angular, arm_W));
    v.x = state.v_east.corrupt(spec.speed, v.x, dt_s, random, spec.errors);
    v.y = state.v_north.corrupt(spec.speed, v.y, dt_s, random, spec.errors);
    v.z = state.v_up.corrupt(spec.speed, v.z, dt_s, random, spec.errors);
    if (pool.levels[index] >> fix_level & 1) {
      const geodesy::Geodetic place = gps.plane.to_geodetic(p);
      msg::NavSatFix& message = gps.fix->message;
      message.latitude = place.latitude_rad * 180 / math::pi;
      message.longitude = place.longitude_rad * 180 / math::pi;
      message.altitude = place.height_m;
      // The errors may be tuned while it runs, so each sample has their present size.
      const double interval_s = spec.rate_hz > 0 ? 1 / spec.rate_hz : context.tick.s();
      message.position_covariance[0] = message.position_covariance[4] = channel_variance(
          spec.horizontal, interval_s, spec.errors);
      message.position_covariance[8] = channel_variance(spec.vertical, interval_s, spec.errors);
      gps.fix->publish(context.now);
    }
    if (pool.levels[index] >> velocity_level & 1) {
      gps.velocity->message.twist.linear = v;
      gps.velocity->publish(context.now);
    }
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"fix", msg::NavSatFix::ros_type, "", "Latitude, longitude and altitude with their covariance."},
    {"velocity", msg::TwistStamped::ros_type, "", "Velocity to the east, north and up."},
    {"pose", msg::PoseWithCovarianceStamped::ros_type, "", "Pose in the world, with the errors of a filter."},
};
constexpr const char* sdf_types[] = {"sensor:navsat", "sensor:gps", "plugin:gazebo_ros_gps_sensor",
                                     "plugin:hector_gazebo_ros_gps"};
constexpr Preset presets[] = {
    {"standalone",
     "One receiver by itself: 1.5 m per axis drifting over 10 minutes, 2.5 m of altitude (sizes as in data "
     "sheets of "
     "single-frequency receivers; time: ionosphere and multipath, Groves sec. 9.3).",
     "{horizontal: {white: 0.3, bias: {bias_std: 1.5, correlation: 600}},"
     " vertical: {white: 0.5, bias: {bias_std: 2.5, correlation: 600}}, speed: {white: 0.05}, status: 0}"},
    {"float",
     "Differential carrier phase without fixed ambiguities: 0.25 m per axis drifting over 2 minutes (0.1 to "
     "0.5 m in "
     "reports on low-cost RTK; the time is an estimate).",
     "{horizontal: {white: 0.02, bias: {bias_std: 0.25, correlation: 120}},"
     " vertical: {white: 0.04, bias: {bias_std: 0.4, correlation: 120}}, speed: {white: 0.03}, status: 2}"},
    {"fixed",
     "RTK with fixed ambiguities: 0.01 m per axis, 0.02 m of altitude as in data sheets (Swift Piksi), "
     "multipath of the "
     "carrier drifting over a minute.",
     "{horizontal: {white: 0.004, bias: {bias_std: 0.009, correlation: 60}},"
     " vertical: {white: 0.008, bias: {bias_std: 0.018, correlation: 60}}, speed: {white: 0.03}, status: 2}"},
};
}  // namespace

constinit const Kind kind = make_kind<Receiver>({
    .name = "gps",
    .help = "Satellite receiver: latitude, longitude, altitude and velocity.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic and frame names, the vertical velocity's own noise",
    .presets = presets,
});

}  // namespace sandlot::gps
