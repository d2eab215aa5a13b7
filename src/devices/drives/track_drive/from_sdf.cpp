/// Gazebo's TrackedVehicle as keys of our spec. Its tracks are links whose surface moves, not joints: two
/// tracks in thought.
#include "devices/drives/sdf_drive.h"
#include "devices/drives/track_drive/track_drive.h"
#include "devices/sdf_noise.h"

namespace sandlot::track_drive {
using namespace sdf_element;

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  Node config = Node::map(element.place());
  SL_TRY(copy_number(element, {"tracks_separation"}, 1.0, config, "track"));
  if (!config.find("track")) config.set("track", Node::scalar("1", element.place()));  // Gazebo's default
  SL_TRY(copy_number(element, {"track_height"}, 0.5, config, "wheel_radius"));
  // The share of the tracks' difference that turns the vehicle; 0.5 when it is not given.
  SL_ASSIGN(const auto efficiency, number(element, "steering_efficiency"));
  if (efficiency && !(*efficiency > 0 && *efficiency <= 1))
    return find(element, "steering_efficiency")->error("<steering_efficiency> is not in ]0, 1]", "write 0.5");
  const Node* const given = find(element, "steering_efficiency");
  config.set("track_ratio", scalar(1 / efficiency.value_or(0.5), given ? *given : element));
  SL_TRY(copy_number(element, {"odom_publish_frequency"}, 1.0, config, "rate"));
  SL_TRY(copy_limits(element, config, diagnostics));
  warn_unknown_of_drive(
      element, {"left_track", "right_track", "tracks_separation", "track_height", "steering_efficiency"},
      "the tracked vehicle plugin", diagnostics);
  return config;
}

}  // namespace sandlot::track_drive
