#pragma once
/// Car: a fixed axle and two steered wheels, whose axes meet in one point.
///
/// Frame    D: middle of the fixed axle, axes as the canonical link's. It moves along x on curves of at least
///          the radius that the steering allows; a turning rate without a speed moves nothing.
/// Levels, commands, output, motors, power and odometry: devices/drives/wheeled_base.h.
///          The steering follows the requested curvature at max_steering_speed while the speed follows with
///          its acceleration; the wheels turn as the steering stands now.
/// Geometry wheels are those of left_joint and right_joint (with motors) and passive_joint (without); those
/// that hang on a steering
///          joint are steered by it. All others stand on one axle.
/// Limits   angles of the two steered wheels are set, not a linkage; the differential is ideal (each wheel
///          its speed).
/// Errors   in addition to those of wheeled_base.h: a fixed wheel off the axle; no wheelbase.
/// Source   kinematics/ackermann.h.
#include "devices/drives/wheeled_drive.h"

namespace sandlot::ackermann_drive {

struct Spec : wheeled::Common {
  std::vector<std::string> left_joint, right_joint, passive_joint;
  std::string left_steering_joint, right_steering_joint;
  std::optional<double> wheelbase_m, track_m;
  double max_steering_rad = 0.6;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned required = Field::required;
    visit(Field{"left_joint", "", "Driven wheels on the left.", 0, 0, required, 100, 1}, s.left_joint);
    visit(Field{"right_joint", "", "Driven wheels on the right.", 0, 0, required, 100, 1}, s.right_joint);
    visit(Field{"passive_joint", "", "Wheels that roll along without a motor.", 0, 0, Field::none, 100},
          s.passive_joint);
    visit(Field{"left_steering_joint", "", "Upright joint that steers on the left.", 0, 0, required, 1000},
          s.left_steering_joint);
    visit(Field{"right_steering_joint", "", "Upright joint that steers on the right.", 0, 0, required, 1000},
          s.right_steering_joint);
    visit(Field{"wheelbase", "m",
                "Distance from the fixed axle to the steered one; not given: from the joints.", -1000, 1000},
          s.wheelbase_m);
    visit(Field{"track", "m", "Distance between the steering joints; not given: from the joints.", 0, 1000},
          s.track_m);
    visit(Field{"max_steering_angle", "rad",
                "Largest steering angle of the inner wheel, within the joints' own limits.", 0.01, 1.5},
          s.max_steering_rad);
    steering_fields(s, visit);
    Common::fields(s, visit);
  }
};

struct Car {
  using Spec = ackermann_drive::Spec;
  static constexpr bool has_rollers = false;
  static Result<wheeled::Base> build(const DeviceBuild& build, const Spec& spec);
};

/// SDF plugin to spec keys (from_sdf.cpp).
Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics);

extern const Kind kind;

}  // namespace sandlot::ackermann_drive
