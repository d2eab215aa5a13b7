#pragma once
/// Finding the files that other files name: models, meshes, textures, heightmaps, controller settings.
///
/// What may be written, wherever a file is named:
///   part/arm.stl                     beside the file that says so, then in the folders of the search path
///   /abs/arm.stl, file://...         that file; file:// with a relative path is taken beside
///   model://arm/meshes/arm.stl       arm/... in each folder of the search path, and beside a model folder of that name above
///                                    the file
///   package://arm/meshes/arm.stl     likewise, and the ROS package `arm` (package.xml) that the file itself lies in, or
///                                    share/arm of a prefix in AMENT_PREFIX_PATH
///   https://fuel.../models/Arm       a folder `Arm` (or `arm`) of the search path or of Gazebo's own cache; nothing is ever
///                                    downloaded: the error says what to fetch and where to put it
/// Search   the folders asked for (`--path`), SANDLOT_PATH, GZ_SIM_RESOURCE_PATH, IGN_GAZEBO_RESOURCE_PATH,
///          GAZEBO_MODEL_PATH, ROS_PACKAGE_PATH, then Sandlot's own models.
#include <span>
#include <string>
#include <vector>

#include "base/result.h"

namespace sandlot {

struct SearchPath {
  std::vector<std::string> folders;  ///< the first that has it wins
};

/// The folders above, with `asked_for` first; those that do not exist are left in, so that errors can name them.
SearchPath search_path(std::span<const std::string> asked_for = {});

/// The file or folder behind `uri`, which a file in `folder` wrote.
/// Errors   nothing there: what was looked for, and what to set or download.
Result<std::string> find_resource(const std::string& uri, const std::string& folder, const SearchPath& path,
                                  const Place& place);

/// Remedy for a file or model on the command line that does not exist: Sandlot's own scenario, world or model that the words
/// name, or the nearest name; "" when nothing is near.
std::string nearest_resource(const std::string& written, const SearchPath& path);

/// Says that a texture cannot be used and that cameras show a checker in its place: once per file, whoever names it, and of
/// no more than twenty files.
/// @param file     as the model keeps it
/// @param problem  what follows its name ("does not exist"), what would be right, and where it is named
void warn_of_texture(const std::string& file, Error problem, Diagnostics& diagnostics);

/// Sandlot's folder `name` ("models", "scenarios"): beside or above the program or Sandlot's library, or in
/// ../share/sandlot there; "" if nowhere.
std::string own_folder(const std::string& name);

}  // namespace sandlot
