#pragma once
/// Transforms as ROS messages: /tf of a frame, /tf_static of a world. Recordings and viewers get the same.
///
/// Frames   `world` is the root; `<instance>/<link>` lies in it for canonical links, in the canonical link for others;
///          `<instance>/<device>` lies in its link, other frames of a device (`<instance>/<device>_optical`) in that, and
///          links of static models in the world (/tf_static).
/// Limits   a link of a static model that is put elsewhere while the run goes on appears in the next static_transforms().
/// Cost     transforms_of(): no heap allocation once `out` has held as much.
#include "messages/tf2_msgs.h"
#include "sim/world/frame.h"

namespace sandlot {

class Simulation;

/// Replaces what `out` holds. Instances whose links the frame does not have are left out.
void transforms_of(const Frame& frame, msg::TFMessage& out);

/// Where the devices are mounted, and where what never moves stands.
msg::TFMessage static_transforms(const Simulation& simulation);

}  // namespace sandlot
