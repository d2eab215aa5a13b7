#pragma once
/// Odometry estimator: the pose of a robot in the plane from its odometry and, where it has one, its gyroscope, with a
/// covariance.
///
/// Reads      an Odometry (of a drive or of wheel_odometry) and, unless the robot has none, an Imu.
/// Publishes  `estimate`, nav_msgs/Odometry: frames of the odometry that it reads, so it begins at the first pose of that.
///            One message for each message of the odometry.
/// Method     between two messages of the odometry B moves by the way (dx, dy) in B, d = |(dx, dy)|, and turns by a. With a
///            gyroscope, a is its rate about B's z axis, integrated by trapezoids; the way, which the wheels measured along
///            an arc with their own turn, is turned by half the difference. Direction phi of the way: that of the chord.
/// Covariance of x, y and heading, P' = F P F^T + G Q G^T, with
///
///              F = | 1  0  -d sin(phi) |     G = | cos(phi)  -d/2 sin(phi) |     Q = | var_d    0   |
///                  | 0  1   d cos(phi) |         | sin(phi)   d/2 cos(phi) |         |   0    var_a |
///                  | 0  0   1          |         |    0            1       |
///
///              var_d = distance_variance d
///              var_a = heading_variance d + turn_variance |a|    from the wheels
///              var_a = gyro_density^2 dt                         from the gyroscope, over the time dt
///
///            z, roll and pitch are taken as known: their variances are 0.
///            A gyroscope that has sent nothing for half a second is left out until it sends again.
/// Limits     motion in the plane; systematic errors of the wheels (radius, separation) and the gyroscope's bias are not
///            estimated. Samples of the gyroscope between two control steps are lost but for the last: give it a rate that
///            is not above that of the controller.
/// Cost       a sine and a cosine per message; no allocation.
/// Source     R. Siegwart, I. R. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed. (2011),
///            sec. 5.2.4; S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), sec. 5.4.
#include <array>

#include "control/controller.h"

namespace sandlot::controllers::odometry_estimator {

struct Spec {
  std::string odometry, imu;
  double distance_variance = 1e-4;
  double heading_variance = 1e-4;
  double turn_variance = 1e-3;
  double gyro_density = 1e-3;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"odometry", "", "Odometry to use; empty: the only one.", 0, 0, Field::none, 1000},
          s.odometry);
    visit(Field{"imu", "", "Inertial unit to use; empty: the only one, if there is one.", 0, 0, Field::none,
                1000},
          s.imu);
    visit(Field{"distance_variance", "m^2/m", "Variance of the distance per distance.", 0, 100},
          s.distance_variance);
    visit(
        Field{"heading_variance", "rad^2/m", "Variance of the heading per distance, by the wheels.", 0, 100},
        s.heading_variance);
    visit(Field{"turn_variance", "rad^2/rad", "Variance of the heading per turn, by the wheels.", 0, 100},
          s.turn_variance);
    visit(Field{"gyro_density", "rad/s/sqrt(Hz)", "Noise density of the gyroscope.", 0, 100}, s.gyro_density);
  }
};

struct State {
  double x_m = 0, y_m = 0, heading_rad = 0;         ///< estimate
  std::array<double, 6> covariance{};               ///< of x, y, heading: xx xy xt yy yt tt
  double seen_x_m = 0, seen_y_m = 0, seen_rad = 0;  ///< pose of the last odometry
  Time seen_at;                                     ///< its stamp
  double gyro_radps = 0, gyro_rad = 0;              ///< last rate about z; angle since the last odometry
  Time gyro_at;                                     ///< stamp of the last rate
  std::uint8_t begun = 0, has_gyro = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Estimated position along x."}, s.x_m);
    visit(Field{"y", "m", "Estimated position along y."}, s.y_m);
    visit(Field{"heading", "rad", "Estimated heading."}, s.heading_rad);
    visit(Field{"covariance", "", "Covariance of x, y and heading: xx, xy, xt, yy, yt, tt."}, s.covariance);
    visit(Field{"seen_x", "m", "Position along x in the last odometry."}, s.seen_x_m);
    visit(Field{"seen_y", "m", "Position along y in the last odometry."}, s.seen_y_m);
    visit(Field{"seen_heading", "rad", "Heading in the last odometry."}, s.seen_rad);
    visit(Field{"seen_at", "s", "Time of the last odometry."}, s.seen_at);
    visit(Field{"gyro_rate", "rad/s", "Last rate of the gyroscope about the vertical axis."}, s.gyro_radps);
    visit(Field{"gyro_angle", "rad", "Angle by the gyroscope since the last odometry."}, s.gyro_rad);
    visit(Field{"gyro_at", "s", "Time of the last rate."}, s.gyro_at);
    visit(Field{"begun", "1", "Whether an odometry has come (1)."}, s.begun);
    visit(Field{"has_gyro", "1", "Whether a rate has come (1)."}, s.has_gyro);
  }
};

struct OdometryEstimator {
  using Spec = odometry_estimator::Spec;
  using State = odometry_estimator::State;
  Spec spec;
  State state;

  Reading<msg::Odometry> odometry;
  std::optional<Reading<msg::Imu>> imu;
  Quat q_BS;  ///< orientation of the inertial unit in B
  Publication<msg::Odometry> estimate;

  Status init(const Description& robot, Outputs& out);
  void step(const Observation& obs, Command& cmd);
  bool fits() const;

 private:
  void turn(const msg::Imu& message, Time stamp);
  void move(const msg::Odometry& message, Time stamp);

  msg::Odometry out_;  ///< of this step: a member for the memory of its texts
};

}  // namespace sandlot::controllers::odometry_estimator
