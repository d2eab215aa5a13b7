#pragma once
/// URDF robots as SDF models: a translation of one tree into another, so that whatever is checked, warned about and
/// meant by the SDF reader holds for URDF too. Every element keeps the line of the URDF that it came from.
///
/// Kept     every link and every joint: nothing is lumped, fixed joints and links of sensors stay. A link without mass is a
///          frame: as long as something with mass is fixed to it, it gets a 1e-12th of that mass, which no sum shows; a
///          part that moves by itself and has no mass at all is left to the SDF reader and its error.
/// Frames   a joint's <origin> becomes the pose of the child link in its parent; the joint itself lies in the child.
/// Root     the canonical link. A root link called `world` is the world: what is fixed to it stands still.
/// Floating joints leave their child free, as URDF means it; planar ones are refused.
/// <gazebo> sensors, plugins, materials, surface and joint settings; what has no `reference` goes into the model.
/// Drives   a <transmission> or a joint of <ros2_control> with a position, velocity or effort interface becomes a
///          `joint_motor` named like its joint, which is free until it is first commanded. Not where somebody else
///          commands the joint: a plugin that names it, or any ros_control plugin, whose controllers do.
/// Names    SDF has one list of names for links and joints: a joint called like a link gets `_joint` added, `::` becomes
///          `__`, each with a warning; plugins that name the joint follow.
/// Errors   no root or several, circles, links with two parents, joints to nowhere, missing limits, xacro, numbers that
///          are none: one error with its line. Values out of range are found by the SDF reader, with the same line.
/// Ignored  calibration silently; anything unknown with one warning.
#include "files/xml.h"
#include "formats/sdf/values.h"

namespace sandlot::formats {

/// The <sdf> element that means the same as `robot`, a <robot> element. Places stay those of `robot`.
Result<Xml> urdf_to_sdf(const Xml& robot, Notes& notes);

}  // namespace sandlot::formats
