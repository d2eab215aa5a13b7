#include "formats/sdf/reading.h"

#include "files/resources.h"
#include "files/text.h"

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

std::string Reading::find_texture(const Xml& element, const std::string& uri) const {
  const std::string folder = element.place.file ? folder_of(*element.place.file) : "";
  auto found = find_resource(uri, folder, options.path, element.place);
  if (found) return std::move(*found);
  std::string file = uri.find("://") == std::string::npos ? beside(folder, uri) : uri;
  Error problem = std::move(found.error());
  // It names the texture, and so does the warning.
  const std::size_t named = problem.what.rfind("' ");
  problem.what.erase(0, named == std::string::npos ? 0 : named + 2);
  warn_of_texture(file, std::move(problem), notes.diagnostics());
  return file;
}

const Xml* descend(const Xml& element, std::initializer_list<const char*> path) {
  const Xml* at = &element;
  for (const char* const key : path) at = at ? at->child(key) : nullptr;
  return at;
}

}  // namespace sandlot::formats
