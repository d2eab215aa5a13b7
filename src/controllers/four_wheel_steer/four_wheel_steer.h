#pragma once
/// Four-wheel steer: model-based controller of a robot whose wheels are each driven and steered (4WD4S), over its joint
/// controllers.
///
/// Reads      a Twist, the velocity command for C in C, of another program (`joystick/cmd_vel`) or a device; a JointState
///            with the steering joints and the wheels' joints.
/// Orders     a Float64 to each steering controller (angle) and each wheel controller (rate), in every step from the first
///            JointState on.
/// Publishes  `odometry`, nav_msgs/Odometry of C from "<robot>/odom", one for each JointState after the first. It begins at the origin. The
///            twist is the mean over the step. `state`, sandlot_msgs/FourWheelSteerState, in every step: mode, transition,
///            set points, slip angles, wheel accelerations, centre of rotation, residual of the odometry.
/// Frame      C: that in which `wheels` lists their places, `base_frame` by name: x forward, y left.
/// Method     set points: governor.h. Odometry: model.h, with the mean of a wheel's steering angles before and after the
///            step. A step in which a wheel would have turned faster than twice its limit counts as a restart of the
///            encoders: no motion.
/// Covariance P' = F P F^T + G Q G^T of x, y and heading, F that of the motion, Q diagonal in C: `distance_variance` d + e^2
///            along x and y, `heading_variance` d + `turn_variance` |a| + e^2 / L^2 of the heading, with the way d, the turn a, the residual
///            e and the root mean square distance L of the wheels from their middle. With encoders of the resolution q, e^2 is more
///            by (r q)^2 / (6 n): two readings, each wrong by up to q / 2, for each of n wheels of radius r. Without, a robot that stands
///            is exactly known to stand, which filters refuse. z, roll and pitch count as known.
/// Safety     a command older than `timeout` counts as stop, and so does any command while the latest JointState is.
/// Limits     motion in the plane; wheel places and radii are keys, since a controller does not see the model. Wheels that the steering axis
///            does not meet (castor offset) are not modelled, nor encoders that wrap.
/// Cost       about a microsecond per wheel and step; no allocation after the first one.
/// Errors     lists of different lengths; wheels at one place; a steering range without an angle; joint controllers that are not there. A
///            JointState without a joint that is named: the run goes on, wheels stand.
/// Source     the paper of model.h, sec. 2.5 and 3.1; timeout as in ros2_controllers' diff_drive_controller (cmd_vel_timeout).
#include <array>
#include <string>
#include <vector>

#include "control/controller.h"
#include "controllers/four_wheel_steer/governor.h"

namespace sandlot::controllers::four_wheel_steer {

/// Default names are those of the paper's robot, models/mario; its geometry is a placeholder, since the paper has none.
struct Spec {
  std::string velocity, joint_states;
  std::vector<std::string> steering{"servo1_position_controller", "servo2_position_controller",
                                    "servo3_position_controller", "servo4_position_controller"};
  std::vector<std::string> drive{"motor1_velocity_controller", "motor2_velocity_controller",
                                 "motor3_velocity_controller", "motor4_velocity_controller"};
  std::vector<std::string> steering_joint{"servo1", "servo2", "servo3", "servo4"};
  std::vector<std::string> wheel_joint{"motor1", "motor2", "motor3", "motor4"};
  std::vector<std::array<double, 2>> wheels_m{{0.21, 0.21}, {0.21, -0.21}, {-0.21, 0.21}, {-0.21, -0.21}};
  double wheel_radius_m = 0.075;
  Limits limits;
  double timeout_s = 0.5;
  std::string base_frame = "base_link";
  double distance_variance = 1e-4, heading_variance = 1e-4, turn_variance = 1e-3;
  double encoder_resolution_rad = 0;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned none = Field::none, tunable = Field::tunable;
    visit(Field{"velocity", "",
                "Velocity command to follow: a topic such as joystick/cmd_vel; empty: the only one.", 0, 0,
                none, 1000},
          s.velocity);
    visit(Field{"joint_states", "", "Joint states to use; empty: the only ones.", 0, 0, none, 1000},
          s.joint_states);
    visit(Field{"steering", "", "Position controllers of the steering joints.", 0, 0, none, most_wheels, 2},
          s.steering);
    visit(Field{"drive", "", "Velocity controllers of the wheels, in the same order.", 0, 0, none,
                most_wheels, 2},
          s.drive);
    visit(Field{"steering_joint", "", "Steering joints in the joint states.", 0, 0, none, most_wheels, 2},
          s.steering_joint);
    visit(Field{"wheel_joint", "", "Joints of the wheels in the joint states.", 0, 0, none, most_wheels, 2},
          s.wheel_joint);
    visit(Field{"wheels", "m", "Places [x, y] of the wheels in the robot.", -1e3, 1e3, none, most_wheels, 2},
          s.wheels_m);
    visit(Field{"wheel_radius", "m", "Radius of the wheels.", 1e-3, 100}, s.wheel_radius_m);
    visit(Field{"steering_lower", "rad", "Smallest steering angle.", -100, 100}, s.limits.steering_lower_rad);
    visit(Field{"steering_upper", "rad", "Largest steering angle.", -100, 100}, s.limits.steering_upper_rad);
    visit(Field{"max_steering_rate", "rad/s", "Largest rate of steering.", 1e-3, 1e3, tunable},
          s.limits.max_steering_rate_radps);
    visit(Field{"max_wheel_speed", "rad/s", "Largest rotation of a wheel; commands are scaled as a whole.",
                1e-3, 1e4, tunable},
          s.limits.max_wheel_speed_radps);
    visit(Field{"max_wheel_acceleration", "rad/s^2", "Largest change of a wheel's rotation.", 1e-3, 1e6,
                tunable},
          s.limits.max_wheel_acceleration_radps2);
    visit(Field{"steer_first", "rad", "Error of steering beyond which the robot stops to steer.", 1e-3, 1.5,
                tunable},
          s.limits.steer_first_rad);
    visit(Field{"aligned", "rad", "Error of steering at which it drives off.", 1e-4, 1.5, tunable},
          s.limits.aligned_rad);
    visit(Field{"hysteresis", "rad",
                "Angle by which the other rolling direction must be nearer, and by which a target may leave "
                "the range.",
                0, 0.5, tunable},
          s.limits.hysteresis_rad);
    visit(Field{"smallest_speed", "m/s", "Speed of the fastest wheel below which a command counts as stop.",
                0, 10, tunable},
          s.limits.smallest_speed_mps);
    visit(Field{"timeout", "s", "Age at which a velocity command or joint states count as missing.", 1e-3,
                1e6, tunable},
          s.timeout_s);
    visit(Field{"base_frame", "", "Name of the frame in which the wheels' places are.", 0, 0, none, 100, 1},
          s.base_frame);
    visit(Field{"distance_variance", "m^2/m", "Variance of the position per distance.", 0, 100},
          s.distance_variance);
    visit(Field{"heading_variance", "rad^2/m", "Variance of the heading per distance.", 0, 100},
          s.heading_variance);
    visit(Field{"turn_variance", "rad^2/rad", "Variance of the heading per turn.", 0, 100}, s.turn_variance);
    visit(Field{"encoder_resolution", "rad",
                "Turn of a wheel that its encoder tells apart: least variance of each step. 0: none.", 0, 1},
          s.encoder_resolution_rad);
  }
};

struct State {
  Setting setting;
  double x_m = 0, y_m = 0, heading_rad = 0;  ///< pose of C by the odometry
  std::array<double, 6> covariance{};        ///< of x, y, heading: xx xy xt yy yt tt
  Motion measured;                           ///< velocity by the latest step of the odometry
  double residual_m = 0;
  std::vector<double> steering_rad, wheel_rad, rate_radps;  ///< joints in the latest JointState
  Time joints_at;                                           ///< its stamp
  Time stepped_at;
  std::uint8_t begun = 0;  ///< joint states have come

  static void fields(auto& s, auto&& visit) {
    visit(Field{"setting", "", "Set points and transition."}, s.setting);
    visit(Field{"x", "m", "Position along x by the odometry."}, s.x_m);
    visit(Field{"y", "m", "Position along y by the odometry."}, s.y_m);
    visit(Field{"heading", "rad", "Heading by the odometry."}, s.heading_rad);
    visit(Field{"covariance", "", "Covariance of x, y and heading: xx, xy, xt, yy, yt, tt."}, s.covariance);
    visit(Field{"measured", "", "Velocity by the odometry."}, s.measured);
    visit(Field{"residual", "m", "Residual of the latest step of the odometry."}, s.residual_m);
    visit(Field{"steering", "rad", "Steering angles in the latest joint states."}, s.steering_rad);
    visit(Field{"wheel", "rad", "Angles of the wheels in the latest joint states."}, s.wheel_rad);
    visit(Field{"rate", "rad/s", "Rotation of the wheels in the latest joint states."}, s.rate_radps);
    visit(Field{"joints_at", "s", "Time of the latest joint states."}, s.joints_at);
    visit(Field{"stepped_at", "s", "Time of the latest step."}, s.stepped_at);
    visit(Field{"begun", "1", "Whether joint states have come (1)."}, s.begun);
  }
};

struct FourWheelSteer {
  using Spec = four_wheel_steer::Spec;
  using State = four_wheel_steer::State;
  Spec spec;
  State state;

  Status init(const Description& robot, Outputs& out);
  void step(const Observation& obs, Command& cmd);
  bool fits() const;

 private:
  Status check_wheels() const;
  bool read_joints(const msg::JointState& message);
  void move(double dt_s);
  Motion command(const Observation& obs) const;
  void fill_odometry();
  void fill_report();

  Reading<msg::Twist> velocity_;
  Reading<msg::JointState> joints_;
  std::vector<Actuator<msg::Float64>> steering_, drive_;
  Publication<msg::Odometry> odometry_;
  Publication<msg::FourWheelSteerState> report_;
  double period_s_ = 0.01;
  double arm_m_ = 1;  ///< root mean square distance of the wheels from their middle
  Governor governor_;

  // Scratch of a step: members for the memory of their lists and texts.
  Orders orders_;
  std::vector<double> steering_now_, wheel_now_, rate_now_, turned_, headed_;
  msg::Odometry odometry_out_;
  msg::FourWheelSteerState state_out_;
};

}  // namespace sandlot::controllers::four_wheel_steer
