#pragma once
/// Loading of files into a Setup: a scenario with the world and models it names, or a bare world.
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "formats/scenario/scenario.h"
#include "model/model.h"

namespace sandlot {

struct LoadOptions {
  std::span<const formats::Override> overrides = {};
  std::optional<std::uint64_t> seed;        ///< replaces the scenario's
  std::optional<double> stop_s;             ///< replaces the scenario's
  std::span<const std::string> paths = {};  ///< folders to search first (`--path`)
  bool skip_missing = false;                ///< missing includes and meshes are left out with a warning
  double errors = 1;  ///< factor on the errors of all devices, in addition to the scenario's and the robots'
  /// The text of the file, which is not read from its path then.
  std::optional<std::string_view> text = {};
};

/// Loads a file of any format (formats/kind.h), or a model with parameters ("builder:snake?segments=12",
/// builders/builder.h): what `sandlot run` accepts.
/// A world or model runs at its own step, or Gazebo's 1 ms; a model by itself gets a plane to stand on.
/// Errors carry file and line; warnings go to `diagnostics`, each once per file.
Result<model::Setup> load(const std::string& path, const LoadOptions& options, Diagnostics& diagnostics);

/// Loads one model file, or "builder:...", as an instance at `X_WM`, ready for a SpawnRequest.
Result<model::Instance> load_instance(const std::string& model_file, const std::string& name,
                                      const Pose& X_WM, Diagnostics& diagnostics,
                                      std::span<const std::string> paths = {}, bool skip_missing = false);

/// "sdf" or "urdf", by the root element of a text; "": it is neither.
std::string format_of_text(std::string_view text);
/// Loads a model from a text of such a format, as above. @param folder  that relative names of files begin at
Result<model::Instance> load_instance_text(std::string_view text, const std::string& folder,
                                           const std::string& name, Diagnostics& diagnostics,
                                           std::span<const std::string> paths = {},
                                           bool skip_missing = false);

/// Models with parameters by their addresses, "builder:snake", with a line about each.
std::vector<std::pair<std::string, std::string>> built_models();

}  // namespace sandlot
