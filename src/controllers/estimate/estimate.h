#pragma once
/// Estimate: the motion of a robot from any of its sensors, by the extended Kalman filter of the navigation library.
///
/// Reads      each of `sensors`, by its `name`: a device or a topic of a program, of the message of its `kind` (Odometry,
///            PoseWithCovarianceStamped, TwistWithCovarianceStamped, Imu, NavSatFix). Where `mount` is not given, that of an imu, a
///            gps or a twist is the device's place on the robot.
/// Publishes  `odometry`, nav_msgs/Odometry in <robot>/<frame>, at each step once something was measured. With `odometry` given, also
///            `map_to_odom`, geometry_msgs/TransformStamped: the pose of that odometry's frame in <frame>, as REP 105 has it.
/// Method, errors, limits   navigation/estimation/ekf.h, with the keys of robot_localization. What became of the measurements stands in
///            the state: `estimator.sensors[0].counts[2]` are those gated.
/// Frames     twists are in the robot's base link. Two of it, one with frame `odom` that fuses what is continuous, one with frame `map`
///            that also fuses what jumps (gps, localisation), are REP 105's chain.
/// Limits     of a topic the newest message of a control step alone: sensors faster than the controller lose messages.
/// Cost       some ten microseconds per step and sensor; no allocation once histories have grown.
#include <variant>

#include "control/controller.h"
#include "navigation/estimation/ekf.h"

namespace sandlot::controllers::estimate {

struct Spec : navigation::ekf::Spec {
  std::string frame = "odom", child = "base_link", odometry;

  static void fields(auto& s, auto&& visit) {
    navigation::ekf::Spec::fields(s, visit);
    visit(Field{"frame", "", "Frame of the estimate, after the robot's name.", 0, 0, Field::none, 100, 1},
          s.frame);
    visit(Field{"child", "", "Link that is estimated, the robot's first one.", 0, 0, Field::none, 100, 1},
          s.child);
    visit(Field{"odometry", "", "Odometry whose frame is placed in this one; empty: none.", 0, 0, Field::none,
                1000},
          s.odometry);
  }
};

struct Estimator {
  using Spec = estimate::Spec;
  using State = navigation::ekf::State;
  Spec spec;
  State state;

  Status init(const Description& robot, Outputs& out);
  void step(const Observation& obs, Command& cmd);
  bool fits() const { return state.fits(spec); }

 private:
  using Source =
      std::variant<Reading<msg::Odometry>, Reading<msg::PoseWithCovarianceStamped>,
                   Reading<msg::TwistWithCovarianceStamped>, Reading<msg::Imu>, Reading<msg::NavSatFix>>;
  Result<Source> source_of(const Description& robot, navigation::ekf::Sensor& sensor) const;

  std::vector<Source> sources_;
  std::optional<Reading<msg::Odometry>> odometry_;
  Publication<msg::Odometry> estimate_;
  Publication<msg::TransformStamped> transform_;
  // Of one step: members for the memory of their texts.
  msg::Odometry out_;
  msg::TransformStamped placed_;
};

}  // namespace sandlot::controllers::estimate
