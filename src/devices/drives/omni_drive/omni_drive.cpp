#include "devices/drives/omni_drive/omni_drive.h"

namespace sandlot::omni_drive {

Result<wheeled::Base> Omni::build(const DeviceBuild& build, const Spec& spec) {
  wheeled::Base base{.noun = "an omni drive", .engine = build.engine};
  base.body = build.bodies[0];
  SL_TRY(add_wheels(base, build, spec, spec.wheel_joint, "wheel_joint",
                    {.across = false, .ordinary = false, .roller_rad = spec.roller_angle_rad}));
  put_frame_in_the_middle(base);
  return base;
}

constinit const Kind kind = make_kind<wheeled::Device<Omni>>({
    .name = "omni_drive",
    .help = "Omnidirectional drive of three or more omni wheels, with odometry and power.",
    .levels = wheeled::roller_levels,
});

}  // namespace sandlot::omni_drive
