#include "files/resources.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <vector>

#include "base/program.h"
#include "base/text.h"
#include "files/text.h"

namespace sandlot {
namespace {

namespace fs = std::filesystem;

bool is_there(const fs::path& path) {
  std::error_code failed;
  return fs::exists(path, failed);
}

void add_list(const char* variable, const char* below, std::vector<std::string>& folders) {
  const char* const value = std::getenv(variable);
  for (const std::string_view each : split(value ? value : "", ':'))
    if (!each.empty()) folders.push_back(std::string(each) + below);
}

/// Folders above the file that hold `name`, nearest first: a file of model `arm` may say model://arm.
void add_ancestors(const std::string& folder, const std::string& name, std::vector<std::string>& tried) {
  std::error_code failed;
  const fs::path start = fs::weakly_canonical(folder.empty() ? "." : folder, failed);
  for (fs::path each = start; !each.empty(); each = each.parent_path()) {
    if (each.filename() == name) tried.push_back(each.string());
    if (each == each.root_path()) break;
  }
}

/// The text with %20 and the like undone.
std::string decoded(std::string_view text) {
  const auto digit = [](char c) {
    if (c >= '0' && c <= '9') return c - '0';
    const int lower = std::tolower(static_cast<unsigned char>(c));
    return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool escape = text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 &&
                        digit(text[i + 2]) >= 0;
    out += escape ? static_cast<char>(16 * digit(text[i + 1]) + digit(text[i + 2])) : text[i];
    if (escape) i += 2;
  }
  return out;
}

/// https://fuel.gazebosim.org/1.0/OWNER/models/NAME[/VERSION][/files/...]
struct Fuel {
  std::string owner, name, version, rest;
};
Fuel fuel_of(const std::string& uri) {
  Fuel out;
  const std::vector<std::string_view> parts = split(uri, '/');
  for (std::size_t i = 1; i + 1 < parts.size(); ++i) {
    if (parts[i] != "models") continue;
    out.owner = decoded(parts[i - 1]);
    out.name = decoded(parts[i + 1]);
    for (std::size_t k = i + 2; k < parts.size(); ++k) {
      if (k == i + 2) out.version = std::string(parts[k]);
      else if (parts[k] != "files") out.rest += "/" + decoded(parts[k]);
    }
    break;
  }
  return out;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Names of the files and folders in a folder, sorted.
std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code failed;
  fs::directory_iterator entry(folder.empty() ? "." : folder, failed);
  for (; !failed && entry != fs::directory_iterator(); entry.increment(failed))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// The file of a model's folder: model.sdf, or the first robot in URDF; "" when it has neither.
std::string model_in(const std::string& folder) {
  if (is_there(folder + "/model.sdf")) return folder + "/model.sdf";
  for (const std::string& name : names_in(folder))
    if (fs::path(name).extension() == ".urdf") return beside(folder, name);
  return "";
}

/// The newest version folder in Gazebo's cache.
void add_cached(const Fuel& fuel, std::vector<std::string>& tried) {
  const char* const home = std::getenv("HOME");
  if (!home) return;
  for (const char* const cache : {"/.gz/fuel", "/.ignition/fuel"}) {
    const fs::path model = fs::path(std::string(home) + cache) / "fuel.gazebosim.org" / lower(fuel.owner) /
                           "models" / lower(fuel.name);
    std::error_code failed;
    double best = -1;
    std::string newest;
    for (const auto& entry : fs::directory_iterator(model, failed)) {
      double number = 0;
      if (parse_number(entry.path().filename().string(), number) && number > best)
        best = number, newest = entry.path().string();
    }
    if (!newest.empty()) tried.push_back(newest + fuel.rest);
  }
}

/// `uri` with the last part replaced by the nearest name in one of the folders that were searched; "" when none is near.
std::string nearest_name(const std::string& uri, std::span<const std::string> tried) {
  constexpr std::size_t shortest = 3;           // almost every name is near to a shorter one
  const std::size_t last = uri.rfind('/') + 1;  // 0 where there is no '/'
  if (uri.size() - last < shortest) return "";
  for (const std::string& each : tried) {
    const std::string near = nearest(uri.substr(last), names_in(folder_of(each)));
    if (!near.empty()) return uri.substr(0, last) + near;
  }
  return "";
}

Result<std::string> find_fuel(const std::string& uri, const SearchPath& path, const Place& place) {
  const Fuel fuel = fuel_of(uri);
  if (fuel.name.empty())
    return Error{"'" + uri.substr(0, 120) + "' would have to be downloaded",
                 "download it and name the file by a relative path", place};
  std::vector<std::string> tried;
  for (const std::string& folder : path.folders)
    for (const std::string& name : {fuel.name, lower(fuel.name)})
      tried.push_back(beside(folder, name) + fuel.rest);
  add_cached(fuel, tried);
  for (const std::string& each : tried)
    if (is_there(each)) return each;
  return Error{"'" + uri.substr(0, 160) + "' would have to be downloaded",
               "fetch it from https://app.gazebosim.org/" + fuel.owner + "/fuel/models/" + fuel.name +
                   ", unpack it as folder '" + fuel.name + "' in FOLDER and give --path FOLDER",
               place};
}

}  // namespace

SearchPath search_path(std::span<const std::string> asked_for) {
  SearchPath out{{asked_for.begin(), asked_for.end()}};
  for (const char* const variable : {"SANDLOT_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH",
                                     "GAZEBO_MODEL_PATH", "ROS_PACKAGE_PATH"})
    add_list(variable, "", out.folders);
  add_list("AMENT_PREFIX_PATH", "/share", out.folders);
  if (std::string own = own_folder("models"); !own.empty()) out.folders.push_back(std::move(own));
  return out;
}

Result<std::string> find_resource(const std::string& uri, const std::string& folder, const SearchPath& path,
                                  const Place& place) {
  const std::size_t scheme_end = uri.find("://");
  const std::string scheme = scheme_end == std::string::npos ? "" : uri.substr(0, scheme_end);
  std::string rest = scheme.empty() ? uri : uri.substr(scheme_end + 3);
  std::vector<std::string> tried;
  bool searched = true;
  if (scheme == "http" || scheme == "https") return find_fuel(uri, path, place);
  if (scheme == "model" || scheme == "package") {
    while (!rest.empty() && rest.front() == '/') rest.erase(0, 1);
    const std::string name(first_part(rest));
    add_ancestors(folder, name, tried);
    for (std::string& each : tried) each += rest.substr(name.size());
    for (const std::string& each : path.folders) {
      tried.push_back(beside(each, rest));
      if (fs::path(each).filename() == name) tried.push_back(beside(each, "." + rest.substr(name.size())));
    }
  } else if (scheme.empty() || scheme == "file") {
    tried.push_back(beside(folder, rest));
    searched = scheme.empty() && !fs::path(rest).is_absolute();
    if (searched)
      for (const std::string& each : path.folders) tried.push_back(beside(each, rest));
  } else {
    return Error{"'" + uri.substr(0, 120) + "' begins with an unknown '" + scheme.substr(0, 20) + "://'",
                 "write a relative path, file://, model:// or package://", place};
  }
  for (const std::string& each : tried)
    if (is_there(each)) return each;
  std::string list = nearest_name(uri, tried);
  if (!list.empty()) list = "did you mean '" + list + "'? ";
  list += tried.empty() ? "nothing was searched" : "looked for ";
  for (std::size_t i = 0; i < tried.size() && i < 4; ++i) list += (i ? ", " : "") + tried[i];
  if (tried.size() > 4) list += " and " + std::to_string(tried.size() - 4) + " more places";
  return Error{"'" + uri.substr(0, 160) + "' is not there",
               list + (searched ? "; --path FOLDER or SANDLOT_PATH name more folders" : ""), place};
}

std::string nearest_resource(const std::string& written, const SearchPath& path) {
  const std::string first(first_part(written));
  if (first.size() < written.size()) {  // "scenarios/indoor.yaml", from another folder than Sandlot's own
    const std::string own = first.empty() ? "" : own_folder(first);
    const std::string file = own + written.substr(first.size());
    if (!own.empty() && is_there(file)) return "Sandlot's own is '" + file + "'";
    return nearest_file(own.empty() || is_there(folder_of(written)) ? written : file);
  }
  // One word: a model of the search path, or one of Sandlot's scenarios.
  std::map<std::string, std::string> files;
  for (const std::string& folder : path.folders)
    for (const std::string& name : names_in(folder))
      if (const std::string file = model_in(beside(folder, name)); !file.empty()) files.emplace(name, file);
  if (const std::string own = own_folder("scenarios"); !own.empty())
    for (const std::string& name : names_in(own)) {
      files.emplace(name, beside(own, name));
      files.emplace(fs::path(name).stem().string(), beside(own, name));
    }
  if (const auto file = files.find(written); file != files.end())
    return "the file of that name is '" + file->second + "'";
  if (std::string here = nearest_file(written); !here.empty()) return here;
  std::vector<std::string> names;
  for (const auto& [name, file] : files) names.push_back(name);
  const std::string near = nearest(written, names);
  return near.empty() ? "" : "did you mean '" + files[near] + "'?";
}

void warn_of_texture(const std::string& file, Error problem, Diagnostics& diagnostics) {
  constexpr std::size_t most = 20, longest = 160;
  const std::string begin = "the texture '", more = "more textures cannot be used";
  const std::string name = begin +
                           (file.size() > longest ? "..." + file.substr(file.size() - longest) : file) + "'";
  std::size_t said = 0;
  for (const Error& each : diagnostics.warnings) {
    if (starts_with(each.what, name) || each.what == more) return;
    if (starts_with(each.what, begin)) ++said;
  }
  const std::string shown = "a checker is shown in its place";
  if (said == most) {
    problem.what = more;
    problem.fix = shown;
  } else {
    problem.what = name + " " + problem.what;
    problem.fix = problem.fix.empty() ? shown : shown + ": " + problem.fix;
  }
  diagnostics.warn(std::move(problem));
}

std::string own_folder(const std::string& name) {
  std::error_code failed;
  for (const std::string& program : program_files())
    for (fs::path folder = fs::path(program).parent_path(); !folder.empty(); folder = folder.parent_path()) {
      for (const fs::path& candidate : {folder / "share" / "sandlot" / name, folder / name})
        if (fs::is_directory(candidate, failed) && is_there(candidate)) return candidate.string();
      if (folder == folder.root_path()) break;
    }
  return "";
}

}  // namespace sandlot
