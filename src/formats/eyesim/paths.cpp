#include "formats/eyesim/paths.h"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "base/text.h"
#include "formats/eyesim/lines.h"

namespace sandlot::formats::eyesim {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view home = "%sim%/";
constexpr int folders_above = 3;
constexpr std::size_t longest = 4096, most_entries = 10'000;

/// The path below a folder, each part in the letters that are there; empty: it is not.
fs::path below(const fs::path& folder, const std::vector<std::string_view>& parts) {
  fs::path out = folder;
  for (const std::string_view part : parts) {
    std::error_code failed;
    if (fs::exists(out / part, failed)) {
      out /= part;
      continue;
    }
    const std::string wanted = lower(part);
    std::string found;
    std::size_t entries = 0;
    fs::directory_iterator each(out, failed);
    for (; !failed && each != fs::directory_iterator() && ++entries < most_entries; each.increment(failed)) {
      std::string name = each->path().filename().string();
      // The first by name, so that the order of the folder does not matter.
      if (lower(name) == wanted && (found.empty() || name < found)) found = std::move(name);
    }
    if (found.empty()) return {};
    out /= found;
  }
  std::error_code failed;
  return fs::is_regular_file(out, failed) ? out : fs::path();
}

}  // namespace

std::string path_of(const std::string& written) {
  std::string out = written;
  std::replace(out.begin(), out.end(), '\\', '/');
  return out;
}

std::string located(const std::string& written, const std::string& folder, const SearchPath& path) {
  const std::string name = path_of(written);
  if (name.size() > longest || find_resource(name, folder, path, {})) return name;
  std::string_view rest = name;
  if (starts_with(lower(rest), home)) rest.remove_prefix(home.size());
  if (rest.size() > 1 && rest[1] == ':') rest.remove_prefix(2);
  std::vector<std::string_view> parts;
  for (const std::string_view part : split(rest, '/'))
    if (!part.empty() && part != ".") parts.push_back(part);

  std::error_code failed;
  std::vector<fs::path> folders;
  fs::path above = fs::weakly_canonical(folder.empty() ? "." : folder, failed);
  for (int i = 0; i <= folders_above && !failed; ++i, above = above.parent_path()) folders.push_back(above);
  for (const std::string& each : path.folders)
    if (const fs::path found = fs::weakly_canonical(each, failed); !failed) folders.push_back(found);
  for (; !parts.empty(); parts.erase(parts.begin())) {
    // A bare name is too little to look elsewhere for it.
    if (parts.size() == 1 && folders.size() > 1) folders.resize(1);
    for (const fs::path& each : folders)
      if (const fs::path found = below(each, parts); !found.empty()) return found.string();
  }
  return name;
}

std::string located_program(const std::string& written, const std::string& folder, const SearchPath& path) {
  const std::string name = located(written, folder, path);
  const std::string extension = lower(fs::path(name).extension().string());
  if (find_resource(name, folder, path, {}) ||
      (extension != ".x" && extension != ".exe" && extension != ".dll" && extension != ".so"))
    return name;
  for (const char* const source : {".c", ".cpp", ".cc", ".cxx", ".py"}) {
    const std::string tried = located(fs::path(name).replace_extension(source).string(), folder, path);
    if (find_resource(tried, folder, path, {})) return tried;
  }
  return name;
}

}  // namespace sandlot::formats::eyesim
