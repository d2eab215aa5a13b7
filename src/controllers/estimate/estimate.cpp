#include "controllers/estimate/estimate.h"

namespace sandlot::controllers::estimate {
namespace {

namespace ekf = navigation::ekf;

/// A reading as one of the variant's, with the sensor's mount from the device's place where the file gives none.
template <class M, class Source>
Result<Source> reading_of(const Description& robot, ekf::Sensor& sensor, bool mounted) {
  SL_ASSIGN(const Reading<M> reading, robot.reading<M>(sensor.name));
  if (mounted && sensor.mount == Pose{}) sensor.mount = robot.pose(reading);
  return Source(reading);
}

}  // namespace

Result<Estimator::Source> Estimator::source_of(const Description& robot, ekf::Sensor& sensor) const {
  switch (sensor.kind) {
    case ekf::SensorKind::odometry: return reading_of<msg::Odometry, Source>(robot, sensor, false);
    case ekf::SensorKind::pose:
      return reading_of<msg::PoseWithCovarianceStamped, Source>(robot, sensor, false);
    case ekf::SensorKind::twist:
      return reading_of<msg::TwistWithCovarianceStamped, Source>(robot, sensor, true);
    case ekf::SensorKind::imu: return reading_of<msg::Imu, Source>(robot, sensor, true);
    case ekf::SensorKind::gps: return reading_of<msg::NavSatFix, Source>(robot, sensor, true);
  }
  SL_CHECK_MSG(false, "no kind of sensor");
  return Error{"", ""};
}

Status Estimator::init(const Description& robot, Outputs& out) {
  if (spec.sensors.empty()) return Error{"there is nothing to estimate from", "give `sensors`"};
  sources_.clear();
  for (ekf::Sensor& sensor : spec.sensors) {
    SL_ASSIGN(const Source source, source_of(robot, sensor));
    sources_.push_back(source);
  }
  if (!spec.odometry.empty()) {
    SL_ASSIGN(odometry_, robot.reading<msg::Odometry>(spec.odometry));
    transform_ = out.publish<msg::TransformStamped>("map_to_odom");
  }
  estimate_ = out.publish<msg::Odometry>("odometry");
  out_.header.frame_id = placed_.header.frame_id = robot.robot + "/" + spec.frame;
  out_.child_frame_id = robot.robot + "/" + spec.child;
  SL_ASSIGN(state, ekf::begin(spec));
  return {};
}

void Estimator::step(const Observation& obs, Command& cmd) {
  for (std::size_t i = 0; i < sources_.size(); ++i)
    std::visit(
        [&](const auto& reading) {
          const auto seen = obs.get(reading);
          if (seen.fresh) ekf::add(spec, state, i, seen.message);
        },
        sources_[i]);
  ekf::advance(spec, state, obs.now());
  const ekf::Estimate estimate = ekf::estimate(spec, state, obs.now());
  if (!estimate.known) return;
  ekf::write_message(estimate, out_);
  out_.header.stamp = obs.now();
  cmd.publish(estimate_, out_);
  if (!odometry_) return;
  const auto odometry = obs.get(*odometry_);
  if (!odometry.valid) return;
  // What it says is a step old: its own velocities carry it to now, so that both poses are of one time.
  const double since_s = (obs.now() - odometry.stamp).s();
  const auto& twist = odometry.message.twist.twist;
  const Vec3 turn = since_s * twist.angular;
  const double angle = norm(turn);
  const Quat turned = angle > 0 ? quat_from_axis_angle(turn / angle, angle) : Quat{};
  const Pose X_OB = odometry.message.pose.pose * Pose{since_s * twist.linear, turned};
  const Pose X_MO = estimate.pose() * inverse(X_OB);
  placed_.child_frame_id = odometry.message.header.frame_id;
  placed_.transform = {X_MO.p, X_MO.q};
  cmd.publish(transform_, placed_);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Estimator>({
    .name = "estimate",
    .help = "Estimates a robot's motion from all its sensors with a Kalman filter of 15 states.",
});

}  // namespace sandlot::controllers::estimate
