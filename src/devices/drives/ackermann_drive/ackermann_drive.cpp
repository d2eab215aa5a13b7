#include "devices/drives/ackermann_drive/ackermann_drive.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace sandlot::ackermann_drive {

Result<wheeled::Base> Car::build(const DeviceBuild& build, const Spec& spec) {
  wheeled::Base base{.noun = "an Ackermann drive", .engine = build.engine};
  base.body = build.bodies[0];
  SL_TRY(add_pivots(base, build, std::span(&spec.left_steering_joint, 1), "left_steering_joint"));
  SL_TRY(add_pivots(base, build, std::span(&spec.right_steering_joint, 1), "right_steering_joint"));
  SL_TRY(add_wheels(base, build, spec, spec.left_joint, "left_joint", {}));
  SL_TRY(add_wheels(base, build, spec, spec.right_joint, "right_joint", {}));
  SL_TRY(add_wheels(base, build, spec, spec.passive_joint, "passive_joint", {.driven = false}));
  const wheeled::Pivot &left = base.pivots[0], &right = base.pivots[1];
  if (left.y_m <= right.y_m)
    return Error{"the left steering joint is not to the left of the right one",
                 "exchange left_steering_joint and right_steering_joint", build.decl.place,
                 "/left_steering_joint"};
  const double steered_x = 0.5 * (left.x_m + right.x_m), middle_y = 0.5 * (left.y_m + right.y_m);

  double fixed_x = 0;
  int fixed = 0;
  for (std::size_t i = 0; i < base.wheels.size(); ++i)
    if (base.wheels[i].pivot < 0) fixed_x += base.geometry[i].x_m, ++fixed;
  if (fixed == 0 && !spec.wheelbase_m)
    return Error{"there is no fixed axle: all wheels are steered",
                 "name its wheels in passive_joint, or give wheelbase", build.decl.place, "/wheelbase"};
  fixed_x = fixed > 0 ? fixed_x / fixed : steered_x - *spec.wheelbase_m;
  const double wheelbase = spec.wheelbase_m.value_or(steered_x - fixed_x);
  if (std::abs(wheelbase) < 1e-3)
    return Error{"the wheelbase is " + short_text(wheelbase) + " m",
                 "the steered wheels stand before or behind the fixed axle", build.decl.place, "/wheelbase"};
  for (std::size_t i = 0; i < base.wheels.size(); ++i)
    if (base.wheels[i].pivot < 0 && std::abs(base.geometry[i].x_m - fixed_x) > 0.05 * std::abs(wheelbase))
      return Error{"the wheel of joint '" + base.wheels[i].name + "' does not stand on the fixed axle",
                   "the fixed wheels of an Ackermann drive share one axle; else it is a skid_drive",
                   build.decl.place};
  put_frame(base, fixed_x, middle_y);
  double steering = spec.max_steering_rad;
  for (const wheeled::Pivot& pivot : base.pivots) steering = std::min({steering, pivot.upper, -pivot.lower});
  if (!(steering > 0))
    return Error{"the steering joints cannot turn both ways", "their limits lie on both sides of 0",
                 build.decl.place, "/left_steering_joint"};
  base.car = kinematics::Ackermann{wheelbase, spec.track_m.value_or(left.y_m - right.y_m), steering};
  return base;
}

namespace {
constexpr const char* sdf_types[] = {"plugin:AckermannSteering", "plugin:gz-sim-ackermann-steering-system",
                                     "plugin:ignition-gazebo-ackermann-steering-system",
                                     "plugin:gazebo_ros_ackermann_drive"};
}  // namespace

constinit const Kind kind = make_kind<wheeled::Device<Car>>({
    .name = "ackermann_drive",
    .help = "Car: a fixed axle and two steered wheels, with odometry and power.",
    .levels = wheeled::plain_levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic and frame names, TF, gains, limits of the jerk, the steering wheel",
});

}  // namespace sandlot::ackermann_drive
