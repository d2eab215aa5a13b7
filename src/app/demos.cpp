#include "app/demos.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "app/commands.h"
#include "base/program.h"
#include "base/text.h"

namespace sandlot::app {
namespace {

/// Folders that may hold scenarios.
std::vector<std::filesystem::path> scenario_folders() {
  namespace fs = std::filesystem;
  std::vector<fs::path> folders;
  for (const fs::path folder : folders_above_program()) {
    folders.push_back(folder / "scenarios");
    folders.push_back(folder / "share" / "sandlot" / "scenarios");
  }
  folders.emplace_back("scenarios");
  return folders;
}

/// Names of the scenarios in the first such folder that is there, sorted.
std::vector<std::string> demo_names() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& folder : scenario_folders()) {
    if (!std::filesystem::is_directory(folder, error)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
      if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
    break;
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

int list_demos() {
  for (const std::string& name : demo_names()) std::printf("%s\n", name.c_str());
  return exit_ok;
}

Result<std::string> demo_file(const std::string& name) {
  std::error_code error;
  for (const auto& folder : scenario_folders())
    if (std::filesystem::is_regular_file(folder / (name + ".yaml"), error))
      return (folder / (name + ".yaml")).lexically_normal().string();
  const std::vector<std::string> known = demo_names();
  return Error{"there is no demo '" + name + "'",
               known.empty() ? "no folder 'scenarios' was found near the program" : suggestion(name, known)};
}

}  // namespace sandlot::app
