#include "devices/drives/swerve_drive/swerve_drive.h"

namespace sandlot::swerve_drive {

Result<wheeled::Base> Swerve::build(const DeviceBuild& build, const Spec& spec) {
  wheeled::Base base{.noun = "a swerve drive", .engine = build.engine};
  base.body = build.bodies[0];
  SL_TRY(add_pivots(base, build, spec.steering_joint, "steering_joint"));
  SL_TRY(add_wheels(base, build, spec, spec.wheel_joint, "wheel_joint", {.across = false}));
  for (const wheeled::Wheel& wheel : base.wheels)
    if (wheel.pivot < 0)
      return Error{"the wheel of joint '" + wheel.name + "' hangs on none of the steering joints",
                   "the parent of its joint is the child of a steering joint", build.decl.place,
                   "/wheel_joint"};
  put_frame_in_the_middle(base);
  return base;
}

constinit const Kind kind = make_kind<wheeled::Device<Swerve>>({
    .name = "swerve_drive",
    .help = "Every wheel driven and steered by itself (4WD4S), with odometry and power.",
    .levels = wheeled::plain_levels,
});

}  // namespace sandlot::swerve_drive
