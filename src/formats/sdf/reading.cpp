#include "formats/sdf/reading.h"

#include "formats/text.h"

namespace sandlot::formats {

Result<Pose> Reading::pose(const Xml& element) const {
  const auto resolved = frames.poses.find(&element);
  if (resolved != frames.poses.end()) return resolved->second;
  return read_child_pose(element);
}

Result<std::optional<std::string>> Reading::find(const Xml& element, const std::string& uri,
                                                 const char* without) const {
  // Each element knows the file it stands in, so this is right for what was included too.
  const std::string folder = element.place.file ? folder_of(*element.place.file) : "";
  auto found = find_resource(uri, folder, options.path, element.place);
  if (found) return std::optional<std::string>(std::move(*found));
  if (!options.skip_missing) return std::move(found.error());
  notes.warn(element, found.error().what, without);
  return std::optional<std::string>();
}

const Xml* descend(const Xml& element, std::initializer_list<const char*> path) {
  const Xml* at = &element;
  for (const char* const key : path) at = at ? at->child(key) : nullptr;
  return at;
}

}  // namespace sandlot::formats
