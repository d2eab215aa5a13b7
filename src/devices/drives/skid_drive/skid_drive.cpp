#include "devices/drives/skid_drive/skid_drive.h"

namespace sandlot::skid_drive {

Result<wheeled::Base> Skid::build(const DeviceBuild& build, const Spec& spec) {
  return wheeled::skid_base("a skid drive", build, spec,
                            {spec.left_joint, spec.right_joint, spec.track_m, spec.track_ratio});
}

constinit const Kind kind = make_kind<wheeled::Device<Skid>>({
    .name = "skid_drive",
    .help = "Skid drive: wheels on two sides that slide while it turns, with odometry and power.",
    .levels = wheeled::plain_levels,
});

}  // namespace sandlot::skid_drive
