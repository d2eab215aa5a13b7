#pragma once
/// SDF's <camera> as keys of the kinds of cameras; shared by their from_sdf functions.
///
/// <horizontal_fov>, <image>, <clip>, <noise> (gaussian), <distortion>, <lens> with <type>, <scale_to_hfov>,
/// <cutoff_angle> and <intrinsics>, <depth_camera><clip>, <anti_aliasing>. SDF's defaults hold where they are
/// not ours: 1.047 rad, 320 x 240, clip from 0.1 to 100 m. Bayer and 16 bit formats become the nearest that
/// we have, with a warning.
#include "devices/sdf_element.h"

namespace sandlot::sdf_element {

struct CameraUse {
  bool color = false, depth = false;
  bool pose = false;  ///< the kind reads <pose> itself
};
/// Keys of the lens, and of the picture or the depth as the kind has them. Names what it cannot use.
Result<Node> camera_keys(const Node& element, Diagnostics& diagnostics, CameraUse use);
/// Keys of a multicamera with two cameras side by side.
Result<Node> stereo_keys(const Node& element, Diagnostics& diagnostics);

}  // namespace sandlot::sdf_element

namespace sandlot::cameras {
inline constexpr const char* camera_sdf_note =
    "topic and frame names, triggers, saving, visibility masks, poses within <camera>, distortion centres";
}  // namespace sandlot::cameras
