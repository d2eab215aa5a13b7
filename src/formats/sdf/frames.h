#pragma once
/// Names and frames of SDF: what is called what, and where things are that are given relative to other things.
///
/// check_names() refuses duplicates, reserved names, references to nothing and circles, each with its line.
/// resolve_frames() then asks libsdformat for the poses. Only elements that need it are looked up, and a file
/// without relative_to, <frame>, placement_frame and expressed_in needs none at all.
#include <string>
#include <unordered_map>

#include "formats/sdf/xml.h"
#include "geometry/pose.h"

namespace sandlot::formats {

struct ResolvedFrames {
  /// Models in their parent model or the world; links in their model; collisions, visuals, sensors in their link;
  /// joints in their child link; frames in the link they are attached to.
  std::unordered_map<const Xml*, Pose> poses;
  std::unordered_map<const Xml*, Vec3> axes;  ///< <axis> in its joint's frame
  /// Of joints: child and parent link; of frames: the link they are attached to ("" for the world). As names in the
  /// scope of the model they are in.
  std::unordered_map<const Xml*, std::string> child_links, parent_links, frame_links;
};

/// What a file is about: its first world, or its first model if it has none; null if it has neither.
const Xml* main_element(const Xml& root);

/// `root` is an <sdf> element of a loaded document.
Status check_names(const Xml& root);
Result<ResolvedFrames> resolve_frames(const Xml& root);

}  // namespace sandlot::formats
