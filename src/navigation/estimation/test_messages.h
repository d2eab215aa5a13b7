#pragma once
/// Messages and specs for tests of the estimator.
#include <initializer_list>

#include "base/math.h"
#include "navigation/estimation/ekf.h"

namespace sandlot::navigation::ekf::test {

inline Sensor sensor(const char* name, SensorKind kind, std::initializer_list<std::size_t> used) {
  Sensor out;
  out.name = name;
  out.kind = kind;
  for (const std::size_t i : used) out.config[i] = true;
  return out;
}

/// Diagonal of 6 x 6.
inline std::array<double, 36> diagonal6(double linear, double angular) {
  std::array<double, 36> out{};
  for (std::size_t i = 0; i < 6; ++i) out[7 * i] = i < 3 ? linear : angular;
  return out;
}
inline std::array<double, 9> diagonal3(double variance) {
  return {variance, 0, 0, 0, variance, 0, 0, 0, variance};
}

inline msg::PoseWithCovarianceStamped pose_at(double t_s, Vec3 p, Vec3 rpy = {}, double linear = 0.01,
                                              double angular = 0.01) {
  return {{Time::from_s(t_s), "odom"}, {pose_from_rpy(p, rpy), diagonal6(linear, angular)}};
}
inline msg::TwistWithCovarianceStamped twist_at(double t_s, Vec3 linear, Vec3 angular = {},
                                                double variance = 0.01) {
  return {{Time::from_s(t_s), "base_link"}, {{linear, angular}, diagonal6(variance, variance)}};
}
inline msg::Imu imu_at(double t_s, Vec3 rpy, Vec3 rate = {}, Vec3 acceleration = {}, double variance = 0.01) {
  msg::Imu out;
  out.header.stamp = Time::from_s(t_s);
  out.orientation = quat_from_rpy(rpy.x, rpy.y, rpy.z);
  out.angular_velocity = rate;
  out.linear_acceleration = acceleration;
  out.orientation_covariance = out.angular_velocity_covariance = out.linear_acceleration_covariance =
      diagonal3(variance);
  return out;
}
inline msg::NavSatFix fix_at(double t_s, const Datum& datum, Vec3 p_W, double variance = 0.04) {
  const geodesy::Geodetic place = to_geodetic(datum, p_W);
  msg::NavSatFix out;
  out.header.stamp = Time::from_s(t_s);
  out.latitude = place.latitude_rad * 180 / math::pi;
  out.longitude = place.longitude_rad * 180 / math::pi;
  out.altitude = place.height_m;
  out.position_covariance = diagonal3(variance);
  out.position_covariance_type = msg::NavSatFix::covariance_known;
  return out;
}

/// A filter that begins unsure, with one message after the other.
struct Rig {
  Spec spec;
  State state;
  std::vector<Report> reports;

  explicit Rig(std::vector<Sensor> sensors) {
    spec.sensors = std::move(sensors);
    spec.initial_covariance.fill(1);
    start();
  }
  void start() { state = begin(spec).value(); }
  /// Adds the message and goes to its stamp.
  /// @return  what became of it; of its last part
  Outcome give(std::size_t index, const auto& message) {
    if (const Outcome outcome = add(spec, state, index, message); outcome != Outcome::queued) return outcome;
    to(message.header.stamp);
    return state.sensors[index].last;
  }
  void to(Time now) { reports.clear(), advance(spec, state, std::max(now, state.now), &reports); }
  double x(Index i) const { return state.core.x[i]; }
  double variance(Index i) const { return state.core.P.at(i, i); }
};

}  // namespace sandlot::navigation::ekf::test
