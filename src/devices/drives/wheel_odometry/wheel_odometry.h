#pragma once
/// Dead reckoning from two sides of wheels, with the errors it has on a real robot.
///
/// Frame    B: the canonical link. D: centre of the axle, the mean of the wheel joints' origins, axes as B.
/// Levels   `odometry` (the default) and `pose`, one or both.
/// Output   level `odometry`: nav_msgs/Odometry of B: frame "<robot>/odom", child "<robot>/<canonical link>".
///          The pose counts from where B stood when the device was built. Covariances: of the random errors
///          alone, propagated. Level `pose`: the same message and frames from B's true motion in the plane,
///          with errors that grow as those of a well calibrated odometry do: std of the distance
///          `distance_walk` sqrt(way), of the heading `heading_walk` sqrt(way) and `turn_walk` sqrt(turn). No
///          wheel is looked at, so slip does not show. A level that becomes active alone takes over the
///          other's pose and covariance.
/// Time     one exact arc per sample (kinematics/differential.h); the twist is the mean over the interval.
/// Noise    systematic: the robot believes in `wheel_radius` and `wheel_separation`, while its wheels have
///          the radii and the distance that its model gives them; `left_error`, `right_error` and
///          `separation_error` are the relative errors of what it believes, on top. Random: over an interval
///          with the distance d and the turn a
///
///            var(d) = alpha_3 |d| + alpha_4 |a|      var(a) = alpha_1 |a| + alpha_2 |d|
///
///          so that the error of a way does not depend on the sample rate: variances add up. Covariance: P' =
///          F P F^T + G Q G^T with the Jacobians of the arc's chord. `errors` multiplies relative errors (no
///          wheel and no distance gets below half its size by that) and, squared, the variances. Slip of the
///          wheels shows by itself: the wheels' joints turn.
/// Services reset (std_srvs/Trigger): pose and covariance of both levels become zero. set_pose
///          (robot_localization/SetPose): they become those given, of B in "<robot>/odom"; of the pose only x, y and the heading
///          count. Both show from the next sample on.
/// Limits   wheels that roll; play and width of the tyres are not there.
/// Cost     one arc, two normals and two products of 3x3 matrices per sample; no allocation.
/// Errors   joints that are not there, do not turn, or whose axes do not lie across the robot.
/// Source   S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), sec. 5.4 (alphas; here variances,
///          linear in the way); J. Borenstein, L. Feng, IEEE Trans. Robotics and Automation 12 (1996) 869-880
///          (UMBmark: unequal wheel diameters, wrong wheelbase); R. Siegwart et al., Introduction to
///          Autonomous Mobile Robots, 2nd ed. (2011), sec. 5.2.4.
#include <array>

#include "devices/kind.h"
#include "kinematics/differential.h"
#include "messages/device_services.h"
#include "messages/messages.h"
#include "noise/chain.h"

namespace sandlot::wheel_odometry {

/// Errors of the level pose.
struct PoseSpec {
  double distance_walk = 0, heading_walk = 0, turn_walk = 0;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"distance_walk", "m/sqrt(m)", "Random walk of the distance.", 0, 100, tunable},
          s.distance_walk);
    visit(Field{"heading_walk", "rad/sqrt(m)", "Random walk of the heading with distance.", 0, 100, tunable},
          s.heading_walk);
    visit(Field{"turn_walk", "rad/sqrt(rad)", "Random walk of the heading with turning.", 0, 100, tunable},
          s.turn_walk);
  }
};

struct Spec {
  std::vector<std::string> left_joint, right_joint;
  double wheel_radius_m = 0.1, wheel_separation_m = 0.5;
  double left_error = 0, right_error = 0, separation_error = 0;
  double alpha_1 = 0, alpha_2 = 0, alpha_3 = 0, alpha_4 = 0;
  PoseSpec pose;
  double rate_hz = 50;
  double errors = 1;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned required = Field::required;
    visit(Field{"left_joint", "", "Wheel joint on the left side, or a list of them.", 0, 0, required, 100},
          s.left_joint);
    visit(Field{"right_joint", "", "Wheel joint on the right side, or a list of them.", 0, 0, required, 100},
          s.right_joint);
    visit(Field{"wheel_radius", "m", "Radius of the wheels.", 1e-4, 100, required}, s.wheel_radius_m);
    visit(Field{"wheel_separation", "m", "Distance between left and right wheels.", 1e-3, 1000, required},
          s.wheel_separation_m);
    visit(Field{"left_error", "1", "Relative error of the left wheels' radius.", -0.5, 0.5}, s.left_error);
    visit(Field{"right_error", "1", "Relative error of the right wheels' radius.", -0.5, 0.5}, s.right_error);
    visit(Field{"separation_error", "1", "Relative error of the separation.", -0.5, 0.5}, s.separation_error);
    visit(Field{"alpha_1", "rad^2/rad", "Variance of the heading per turn.", 0, 100}, s.alpha_1);
    visit(Field{"alpha_2", "rad^2/m", "Variance of the heading per distance.", 0, 100}, s.alpha_2);
    visit(Field{"alpha_3", "m^2/m", "Variance of the distance per distance.", 0, 100}, s.alpha_3);
    visit(Field{"alpha_4", "m^2/rad", "Variance of the distance per turn.", 0, 100}, s.alpha_4);
    visit(Field{"pose_error", "", "Errors of the level pose."}, s.pose);
    visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
    visit(errors_field, s.errors);
  }
};

struct PoseState {
  kinematics::PlanarPose seen_W;       ///< where B was at the previous sample
  kinematics::PlanarPose reported_O;   ///< reported pose
  std::array<double, 6> covariance{};  ///< as below
  bool begun = false;                  ///< false: nothing has been seen since the level became active

  static void fields(auto& s, auto&& visit) {
    visit(Field{"seen", "m", "True pose at the last sample."}, s.seen_W);
    visit(Field{"told", "m", "Reported pose."}, s.reported_O);
    visit(Field{"covariance", "", "Covariance of x, y and heading."}, s.covariance);
    visit(Field{"begun", "", "Whether a pose has been reported."}, s.begun);
  }
};

struct State {
  double left_rad = 0, right_rad = 0;  ///< mean wheel angles counted
  kinematics::PlanarPose X_OD;
  std::array<double, 6> covariance{};  ///< of x, y, heading: xx xy xt yy yt tt
  PoseState pose;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"left", "rad", "Angle counted at the left wheel."}, s.left_rad);
    visit(Field{"right", "rad", "Angle counted at the right wheel."}, s.right_rad);
    visit(Field{"odometry", "m", "Odometry of the axle's centre."}, s.X_OD);
    visit(Field{"covariance", "", "Covariance of x, y and heading."}, s.covariance);
    visit(Field{"pose", "", "State of the level pose."}, s.pose);
  }
};

struct Wheel {
  std::uint32_t joint = 0;
  double sign = 1;  ///< +1: a positive angle rolls forward
};

struct Odometer {
  using Spec = wheel_odometry::Spec;
  using State = wheel_odometry::State;
  Spec spec;
  State state;

  std::uint64_t key = 0;
  std::uint32_t base = 0;  ///< of the canonical link
  std::vector<Wheel> left, right;
  double dx_m = 0, dy_m = 0;  ///< D in B
  Topic<msg::Odometry>*odometry = nullptr, *pose = nullptr;

  static Result<Odometer> create(const DeviceBuild& build, Spec spec);
  static void sense(PoolView<Odometer> pool, const Context& context);
  Status switch_level(std::uint32_t before, std::uint32_t after, const Context& context);

  using Trigger = msg::std_srvs::Trigger;
  using SetPose = msg::robot_localization::SetPose;
  Result<Trigger::Response> reset(const Trigger::Request&, const Context&);
  Result<SetPose::Response> set_pose(const SetPose::Request& request, const Context&);

 private:
  void go_to(const kinematics::PlanarPose& X_OB, const std::array<double, 6>& covariance);
};

extern const Kind kind;

}  // namespace sandlot::wheel_odometry
