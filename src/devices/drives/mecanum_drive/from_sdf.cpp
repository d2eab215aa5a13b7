/// Gazebo's MecanumDrive as keys of our spec.
#include "devices/drives/mecanum_drive/mecanum_drive.h"
#include "devices/drives/sdf_drive.h"
#include "devices/sdf_noise.h"

namespace sandlot::mecanum_drive {
using namespace sdf_element;

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  Node config = Node::map(element.place());
  for (const char* corner : {"front_left_joint", "front_right_joint", "back_left_joint", "back_right_joint"})
    copy(element, corner, config, corner);
  SL_TRY(copy_number(element, {"wheel_separation"}, 1.0, config, "track"));
  SL_TRY(copy_number(element, {"wheelbase"}, 1.0, config, "wheelbase"));
  SL_TRY(copy_number(element, {"wheel_radius"}, 1.0, config, "wheel_radius"));
  SL_TRY(copy_number(element, {"odom_publish_frequency"}, 1.0, config, "rate"));
  SL_TRY(copy_limits(element, config, diagnostics));
  config.set("max_wheel_effort",
             Node::scalar(unlimited, element.place()));  // then the joint's own limit holds
  warn_unknown_of_drive(element,
                        {"front_left_joint", "front_right_joint", "back_left_joint", "back_right_joint",
                         "wheel_separation", "wheelbase", "wheel_radius"},
                        "the Mecanum plugin", diagnostics);
  return config;
}

}  // namespace sandlot::mecanum_drive
