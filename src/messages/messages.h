#pragma once
/// The ROS 2 messages that devices and controllers speak, as plain structs with one field list each.
///
/// A struct has the members of its ROS 2 type (Humble) in their order, so that CDR, JSON, CBOR and the schema follow
/// from the field list (messages/info.h). In memory a Time is nanoseconds and a Quat is w x y z; on the wire they are
/// sec, nanosec and x y z w. `constants` lists the constants of the type. Vectors keep their capacity between samples,
/// so that filling a message costs no heap once it has been filled before.
///
/// All types by name: messages/registry.h.
#include "messages/geometry_msgs.h"
#include "messages/nav_msgs.h"
#include "messages/sandlot_acting.h"
#include "messages/sandlot_drive.h"
#include "messages/sandlot_msgs.h"
#include "messages/sandlot_panel.h"
#include "messages/sandlot_radio.h"
#include "messages/sandlot_soccer.h"
#include "messages/sandlot_speech.h"
#include "messages/sandlot_time.h"
#include "messages/sensor_msgs.h"
#include "messages/sensor_ranges.h"
#include "messages/std_msgs.h"
#include "messages/stereo_msgs.h"
#include "messages/trajectory_msgs.h"
#include "messages/vision_msgs.h"
