#pragma once
/// Formats of files that declare worlds, models or scenarios: one folder and one line in formats/kinds.h each.
///
/// Loading, converting, checking and `sandlot list formats` go through this table. Meshes and images, which such files
/// name, have tables of their own (assets/).
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "files/xml.h"
#include "formats/content.h"
#include "formats/scenario/scenario.h"

namespace sandlot::formats {

struct FormatKind {
  const char* name;  ///< "sdf"
  const char* help;
  const char* contents;                          ///< "scenarios", "worlds and models", "robots"
  std::span<const std::string_view> extensions;  ///< with the dot, the usual one first
  std::size_t max_bytes;                         ///< of a file

  // A format declares scenarios, or worlds and models: exactly one of these is given.
  Result<Scenario> (*scenario)(std::string_view text, const std::string& file, const ReadOptions& options,
                               std::span<const Override> overrides, Diagnostics& diagnostics) = nullptr;
  /// The scenario as a tree of the keys of scenario files, when the format is read by way of them.
  Result<Node> (*scenario_tree)(std::string_view text, const std::string& file, const ReadOptions& options,
                                Diagnostics& diagnostics) = nullptr;
  Result<WorldContent> (*world)(std::string_view text, const std::string& file, const ReadOptions& options,
                                Diagnostics& diagnostics) = nullptr;

  /// The document as a tree of SDF, everything in it kept, when the format is read by way of SDF. Other formats are converted
  /// to SDF by way of the model. Null when there is none.
  Result<Xml> (*sdf_tree)(std::string_view text, const std::string& file, const ReadOptions& options,
                          Diagnostics& diagnostics) = nullptr;

  // Writers; null for what the format cannot declare. File names are written as the model has them.
  Result<Xml> (*write_world)(const model::Setup& setup, Diagnostics& diagnostics) = nullptr;
  Result<Xml> (*write_model)(const model::Instance& instance, Diagnostics& diagnostics) = nullptr;
  /// For formats that are no XML and name no files.
  Result<std::string> (*write_plain_world)(const model::Setup& setup, Diagnostics& diagnostics) = nullptr;
  Result<std::string> (*write_plain_model)(const model::Instance& instance,
                                           Diagnostics& diagnostics) = nullptr;
  Result<std::string> (*write_scenario)(const Scenario& scenario, Diagnostics& diagnostics) = nullptr;
};

std::span<const FormatKind* const> format_kinds();

/// The format of a file, by its extension; null when there is none.
const FormatKind* find_format(std::string_view path);

/// ".yaml, .yml, .sdf, .world, .urdf or .xacro"
std::string known_extensions();

/// Reads a file that declares a world or a model. One whose extension no format has is read in the first format with worlds.
/// Errors   a scenario; those of the format.
Result<WorldContent> read_world(const std::string& path, const ReadOptions& options,
                                Diagnostics& diagnostics);

/// Reads a scenario in the format of its extension.
Result<Scenario> read_scenario_file(const std::string& path, const ReadOptions& options,
                                    std::span<const Override> overrides, Diagnostics& diagnostics);

}  // namespace sandlot::formats
