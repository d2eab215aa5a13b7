#include "formats/kind.h"

#include <algorithm>
#include <filesystem>

#include "files/text.h"
#include "formats/kinds.h"

namespace sandlot::formats {

#define SL_DECLARE(name) extern const FormatKind name##_format;
SANDLOT_FORMATS(SL_DECLARE)
#undef SL_DECLARE

std::span<const FormatKind* const> format_kinds() {
#define SL_ENTRY(name) &name##_format,
  static const FormatKind* const table[] = {SANDLOT_FORMATS(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

const FormatKind* find_format(std::string_view path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  for (const FormatKind* const kind : format_kinds())
    if (std::find(kind->extensions.begin(), kind->extensions.end(), extension) != kind->extensions.end())
      return kind;
  return nullptr;
}

std::string known_extensions() {
  std::vector<std::string_view> all;
  for (const FormatKind* const kind : format_kinds())
    all.insert(all.end(), kind->extensions.begin(), kind->extensions.end());
  std::string out;
  for (std::size_t i = 0; i < all.size(); ++i)
    out += std::string(i == 0 ? "" : i + 1 < all.size() ? ", " : " or ") + std::string(all[i]);
  return out;
}

Result<WorldContent> read_world(const std::string& path, const ReadOptions& options,
                                Diagnostics& diagnostics) {
  const FormatKind* kind = find_format(path);
  if (kind && !kind->world)
    return Error{"'" + path + "' holds " + kind->contents + ", not a world or a model"};
  if (!kind)
    kind = *std::find_if(format_kinds().begin(), format_kinds().end(),
                         [](const FormatKind* each) { return each->world != nullptr; });
  SL_ASSIGN(const std::string text, read_text_file(path, kind->max_bytes));
  // Saphira's simulator and Gazebo both end their worlds in .world.
  if (std::filesystem::path(path).extension() == ".world" && text.find('<') == std::string::npos)
    kind = find_format("a.wld");
  return kind->world(text, path, options, diagnostics);
}

Result<Scenario> read_scenario_file(const std::string& path, const ReadOptions& options,
                                    std::span<const Override> overrides, Diagnostics& diagnostics) {
  const FormatKind* const kind = find_format(path);
  if (!kind || !kind->scenario) return read_scenario(path, overrides, diagnostics);
  SL_ASSIGN(const std::string text, read_text_file(path, kind->max_bytes));
  return kind->scenario(text, path, options, overrides, diagnostics);
}

}  // namespace sandlot::formats
