/// `sandlot new controller NAME --lang LANGUAGE`: a project that runs, from templates/controller.
///
/// Templates   templates/controller/any and those of the language; NAME in a file's name and @NAME@ in its text become the name.
/// Library     a copy of the client library, so that the project runs on a machine without Sandlot.
/// Errors      a name that is none in all languages; a file that is there already: then nothing is written.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "app/commands.h"
#include "base/atomic_file.h"
#include "base/program.h"
#include "base/text.h"

namespace sandlot::app {
namespace {

namespace fs = std::filesystem;

struct Language {
  const char* name;
  const char* library;    ///< folder of the client library in the source tree; "": it is no client
  const char* installed;  ///< the same below the prefix of an installation
  const char* build;      ///< command before the program can run; "": none
  const char* start;      ///< command that runs the program
};
constexpr Language languages[] = {
    {"python", "clients/python/sandlot_client", "share/sandlot/python/sandlot_client", "",
     "python3 @NAME@_controller.py"},
    {"js", "clients/javascript", "share/sandlot/javascript", "", "node @NAME@_controller.mjs"},
    {"cpp", "clients/cpp/sandlot_client", "include/sandlot_client", "cmake -B build && cmake --build build",
     "build/@NAME@_controller"},
    {"robios", "", "", "", ""},
};

/// A file of the project.
struct ProjectFile {
  fs::path from, to;  ///< to: relative to the project
  bool is_template = false;
};

/// A folder of data near this program: in the source tree, or below the prefix of an installation.
Result<fs::path> data_folder(const std::string& in_tree, const std::string& installed) {
  std::error_code error;
  for (const std::string& above : folders_above_program())
    for (const std::string& each : {in_tree, installed})
      if (fs::path folder = fs::path(above) / each; fs::is_directory(folder, error)) return folder;
  return Error{"the folder '" + in_tree + "' was not found near the program", "install Sandlot again"};
}

/// Letters, digits and _ only: a part of file names, and a name in a scenario and in CMake.
Status check_name(const std::string& name) {
  constexpr std::size_t longest = 64;
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const auto fits = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  if (!name.empty() && name.size() <= longest && is_letter(name[0]) &&
      std::all_of(name.begin(), name.end(), fits))
    return {};
  return Error{"'" + name.substr(0, longest) + "' cannot be the name of a controller",
               "a letter, then letters, digits and _, 64 at most"};
}

std::string with_name(std::string text, const std::string& token, const std::string& name) {
  for (std::size_t at = 0; (at = text.find(token, at)) != std::string::npos; at += name.size())
    text.replace(at, token.size(), name);
  return text;
}

Status add_files(const fs::path& folder, const fs::path& to, const std::string& name, bool is_template,
                 std::vector<ProjectFile>& files) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (!entry.is_regular_file(error)) continue;  // __pycache__, node_modules
    std::string file = entry.path().filename().string();
    if (is_template) file = with_name(file, "NAME", name);
    files.push_back({entry.path(), to / file, is_template});
  }
  if (error) return Error{"cannot read " + folder.string() + ": " + error.message()};
  return {};
}

Status write_project_file(const ProjectFile& file, const fs::path& folder, const std::string& name) {
  std::ifstream in(file.from, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) return Error{"cannot read " + file.from.string()};
  if (file.is_template) text = with_name(std::move(text), "@NAME@", name);
  const fs::path to = folder / file.to;
  SL_TRY(write_file(to.string(), text));
  // A script can be started.
  std::error_code error;
  fs::permissions(to, fs::status(file.from, error).permissions() | fs::perms::owner_write, error);
  return {};
}

Status write_project(const NewOptions& options, const Language& language) {
  SL_TRY(check_name(options.name));
  SL_ASSIGN(const fs::path templates,
            data_folder("templates/controller", "share/sandlot/templates/controller"));
  const bool is_client = *language.library != 0;
  std::vector<ProjectFile> files;
  SL_TRY(add_files(templates / language.name, "", options.name, true, files));
  if (is_client) {
    SL_ASSIGN(const fs::path library, data_folder(language.library, language.installed));
    SL_TRY(add_files(templates / "any", "", options.name, true, files));
    SL_TRY(add_files(library, "sandlot_client", options.name, false, files));
  }
  std::sort(files.begin(), files.end(),
            [](const ProjectFile& a, const ProjectFile& b) { return a.to < b.to; });
  const fs::path folder = options.out.empty() ? options.name : options.out;
  std::error_code error;
  for (const ProjectFile& each : files)
    if (fs::exists(fs::symlink_status(folder / each.to, error)))
      return Error{(folder / each.to).string() + " exists already", "another folder: --out DIR"};
  fs::create_directories(is_client ? folder / "sandlot_client" : folder, error);
  if (error) return Error{"cannot make the folder " + folder.string() + ": " + error.message()};
  for (const ProjectFile& each : files) SL_TRY(write_project_file(each, folder, options.name));
  const auto command = [&](const char* text) { return with_name(text, "@NAME@", options.name); };
  fmt::print("{}: {} files, explained in README.md\n", folder.string(), files.size());
  fmt::print("  cd {}\n", folder.string());
  if (*language.build) fmt::print("  {}\n", language.build);
  fmt::print("  sandlot run {}.yaml --port 8765\n", options.name);
  if (is_client) fmt::print("  {}\n", command(language.start));
  return {};
}

}  // namespace

int new_controller(const NewOptions& options) {
  std::vector<std::string> known;
  for (const Language& each : languages) {
    if (each.name == options.language) {
      const Status status = write_project(options, each);
      return status ? exit_ok : complain(status.error());
    }
    known.emplace_back(each.name);
  }
  return complain(Error{"--lang: there is no template for '" + options.language + "'",
                        suggestion(options.language, known)});
}

}  // namespace sandlot::app
