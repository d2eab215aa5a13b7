#include "devices/drives/track_drive/track_drive.h"

namespace sandlot::track_drive {

Result<wheeled::Base> Tracks::build(const DeviceBuild& build, const Spec& spec) {
  return wheeled::skid_base("a tracked drive", build, spec,
                            {spec.left_joint, spec.right_joint, spec.track_m, spec.track_ratio});
}

namespace {
constexpr const char* sdf_types[] = {"plugin:TrackedVehicle", "plugin:gz-sim-tracked-vehicle-system",
                                     "plugin:ignition-gazebo-tracked-vehicle-system"};
}  // namespace

constinit const Kind kind = make_kind<wheeled::Device<Tracks>>({
    .name = "track_drive",
    .help = "Two tracks, or the wheels under them, with odometry and power.",
    .levels = wheeled::plain_levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "the tracks' links (it moves on the level `ideal`), topic and frame names, TF",
});

}  // namespace sandlot::track_drive
