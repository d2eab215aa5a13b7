#pragma once
/// Names and frames of SDF: what is called what, and where things are that are given relative to other things.
///
/// check_names() refuses duplicates, reserved names, references to nothing and circles, each with its line.
/// resolve_frames() then places what is not simply relative to its parent. A name `a::b` leads into nested models;
/// names never lead out of a model.
///
/// Source   SDFormat proposal "Pose frame semantics" (SDF 1.7) and its amendments for nested models (1.8, 1.9).
#include <string>
#include <unordered_map>

#include "files/xml.h"
#include "geometry/pose.h"

namespace sandlot::formats {

/// Only what needs resolving is in here: for the rest, the pose as written is relative to the parent.
struct ResolvedFrames {
  /// Models in their parent model or the world; links in their model; collisions, visuals, sensors in their link or
  /// joint; joints in their child link; frames in the link they are attached to.
  std::unordered_map<const Xml*, Pose> poses;
  std::unordered_map<const Xml*, Vec3> axes;  ///< <axis> in its joint's frame
  /// Of joints: child and parent link; of frames: the link they are attached to. As names in the scope of the model
  /// they are in; "world" for the world.
  std::unordered_map<const Xml*, std::string> child_links, parent_links, frame_links;
};

/// What a file is about: its first world, or its first model if it has none; null if it has neither.
const Xml* main_element(const Xml& root);

/// `root` is an <sdf> element of a loaded document.
Status check_names(const Xml& root);
/// @pre check_names(root) succeeded
Result<ResolvedFrames> resolve_frames(const Xml& root);

}  // namespace sandlot::formats
