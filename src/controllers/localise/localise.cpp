#include "controllers/localise/localise.h"

#include "base/log.h"

namespace sandlot::controllers::localise {
namespace {

namespace amcl = navigation::amcl;
using navigation::Pose2;

Pose2 in_plane(const Pose& X) { return {X.p.x, X.p.y, yaw_of(X.q)}; }
Pose in_space(const Pose2& X) { return {{X.x, X.y, 0}, quat_from_axis_angle({0, 0, 1}, X.theta)}; }

/// Places of x, y and the turn about z in a 6x6 covariance.
constexpr std::size_t axes[] = {0, 1, 5};

}  // namespace

std::span<const EnumName<Begin>> enum_names(Begin) {
  static constexpr EnumName<Begin> names[] = {
      {"global", Begin::global}, {"pose", Begin::pose}, {"topic", Begin::topic}};
  return names;
}

Status Localiser::init(const Description& robot, Outputs& out) {
  SL_ASSIGN(const navigation::GridMap map, map_of(spec.map));
  SL_ASSIGN(amcl::Model model, amcl::Model::make(spec, map));
  model_ = std::move(model);
  work_.emplace(*model_);
  SL_ASSIGN(laser_, robot.reading<msg::LaserScan>(spec.laser));
  SL_ASSIGN(odometry_, robot.reading<msg::Odometry>(spec.odometry));
  X_BL_ = robot.pose(laser_);
  path_ = out.path();
  initial_ = out.subscribe<msg::PoseWithCovarianceStamped>("initialpose");
  pose_ = out.publish<msg::PoseWithCovarianceStamped>("amcl_pose");
  transform_ = out.publish<msg::TransformStamped>("map_to_odom");
  cloud_ = out.publish<msg::PoseArray>("particle_cloud");
  for (msg::Header* const header : {&pose_out_.header, &transform_out_.header, &cloud_out_.header})
    header->frame_id = spec.frame;
  cloud_out_.poses.reserve(static_cast<std::size_t>(spec.max_particles));
  if (spec.begin != Begin::pose) return {};
  amcl::State trial = amcl::begin(1);  // a pose off the map is answered now
  return amcl::set_pose(*model_, trial, {spec.x_m, spec.y_m, spec.yaw_rad}, {});
}

/// The random numbers of the first step give the seed of all later ones.
void Localiser::start(const Observation& obs) {
  state.begun = true;
  Stream random = obs.random();
  state.filter = amcl::begin(random.bits64());
  if (spec.begin == Begin::global) amcl::spread(*model_, state.filter);
  if (spec.begin != Begin::pose) return;
  const double p = spec.deviation_m * spec.deviation_m, a = spec.deviation_rad * spec.deviation_rad;
  const Status set = amcl::set_pose(*model_, state.filter, {spec.x_m, spec.y_m, spec.yaw_rad},
                                    {p, 0, 0, 0, p, 0, 0, 0, a});
  SL_CHECK(set);
}

void Localiser::take_pose(const msg::PoseWithCovarianceStamped& message) {
  navigation::Covariance3 covariance{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      covariance[3 * i + k] = message.pose.covariance[6 * axes[i] + axes[k]];
  const std::string& frame = message.header.frame_id;
  const Status taken = [&]() -> Status {
    if (!frame.empty() && frame != spec.frame)
      return Error{
          "an initial pose in the frame '" + frame + "'", "the map is in '" + spec.frame + "'", {}, {}};
    if (norm(message.pose.pose.q) <= 0.5)
      return Error{"an initial pose without an orientation", "w = 1 is along x", {}, {}};
    return amcl::set_pose(*model_, state.filter, in_plane(message.pose.pose), covariance);
  }();
  ++(taken ? state.poses : state.refused);
  if (!taken) log::warning(path_ + ": refused: " + taken.error().what + "; " + taken.error().fix);
}

void Localiser::step(const Observation& obs, Command& cmd) {
  if (!state.begun) start(obs);
  if (const auto initial = obs.get(initial_); initial.fresh) take_pose(initial.message);
  const auto odometry = obs.get(odometry_);
  if (!odometry.valid) return;
  /// The odometry of another time, by its own velocities.
  const auto at = [&](Time time) {
    const double since_s = (time - odometry.stamp).s();
    const auto& twist = odometry.message.twist.twist;
    return in_plane(odometry.message.pose.pose *
                    Pose{since_s * twist.linear, quat_from_axis_angle({0, 0, 1}, since_s * twist.angular.z)});
  };
  if (const auto scan = obs.get(laser_); scan.fresh) {
    const auto outcome = amcl::update(*model_, state.filter, *work_, {odometry.stamp, at(scan.stamp), X_BL_},
                                      scan.message);
    if (outcome == amcl::Outcome::updated) {
      cloud_out_.header.stamp = scan.stamp;
      cloud_out_.poses.clear();
      for (const amcl::Particle& each : state.filter.particles)
        cloud_out_.poses.push_back(in_space(each.pose));
      cmd.publish(cloud_, cloud_out_);
    }
  }
  const amcl::Estimate& estimate = state.filter.estimate;
  if (!estimate.known || (obs.now() - odometry.stamp).s() > spec.odometry_age_s) return;
  const Pose2 X_OB = at(obs.now());
  const Pose2 X_MB = amcl::pose_at(state.filter, X_OB);
  pose_out_.header.stamp = obs.now();
  pose_out_.pose.pose = in_space(X_MB);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      pose_out_.pose.covariance[6 * axes[i] + axes[k]] = estimate.covariance[3 * i + k];
  cmd.publish(pose_, pose_out_);
  const Pose X_MO = in_space(navigation::compose(X_MB, navigation::inverse(X_OB)));
  transform_out_.child_frame_id = odometry.message.header.frame_id;
  transform_out_.transform = {X_MO.p, X_MO.q};
  cmd.publish(transform_, transform_out_);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Localiser>({
    .name = "localise",
    .help = "Finds a robot in a map by laser and odometry, with a particle filter.",
});

}  // namespace sandlot::controllers::localise
