#include "devices/drives/mecanum_drive/mecanum_drive.h"

#include <cmath>

namespace sandlot::mecanum_drive {

Result<wheeled::Base> Mecanum::build(const DeviceBuild& build, const Spec& spec) {
  wheeled::Base base{.noun = "a Mecanum drive", .engine = build.engine};
  base.body = build.bodies[0];
  const struct {
    const std::string& joint;
    const char* key;
    double x, y;  ///< signs of the corner
  } corners[] = {{spec.front_left_joint, "front_left_joint", 1, 1},
                 {spec.front_right_joint, "front_right_joint", 1, -1},
                 {spec.back_left_joint, "back_left_joint", -1, 1},
                 {spec.back_right_joint, "back_right_joint", -1, -1}};
  for (const auto& corner : corners)
    SL_TRY(add_wheels(base, build, spec, std::span(&corner.joint, 1), corner.key,
                      {.ordinary = false, .roller_rad = -corner.x * corner.y * spec.roller_angle_rad}));
  put_frame_in_the_middle(base);
  for (std::size_t i = 0; i < base.geometry.size(); ++i) {
    kinematics::Wheel& wheel = base.geometry[i];
    const auto& corner = corners[i];
    if (wheel.x_m * corner.x < 1e-6 || wheel.y_m * corner.y < 1e-6) {
      return build.error(corner.key,
                         "the wheel of joint '" + corner.joint + "' does not stand in that corner",
                         "x is forward, y left: exchange the joints");
    }
    if (spec.wheelbase_m) wheel.x_m = 0.5 * corner.x * *spec.wheelbase_m;
    if (spec.track_m) wheel.y_m = 0.5 * corner.y * *spec.track_m;
  }
  return base;
}

namespace {
constexpr const char* sdf_types[] = {"plugin:MecanumDrive", "plugin:gz-sim-mecanum-drive-system",
                                     "plugin:ignition-gazebo-mecanum-drive-system"};
}  // namespace

constinit const Kind kind = make_kind<wheeled::Device<Mecanum>>({
    .name = "mecanum_drive",
    .help = "Four Mecanum wheels: forward, sideways and turning, with odometry and power.",
    .levels = wheeled::roller_levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .sdf_note = "topic and frame names, TF, limits of the jerk",
});

}  // namespace sandlot::mecanum_drive
