/// Meaning of words: entities, devices, parameters, files.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <tuple>

#include "base/text.h"
#include "console/command.h"
#include "console/line_parsing.h"
#include "files/resources.h"
#include "sim/world/lookup.h"

namespace sandlot::console {
namespace {

namespace fs = std::filesystem;

Error too_many(std::string_view pattern) {
  return {"'" + std::string(pattern.substr(0, 100)) + "' meets more than " + std::to_string(most_matches) +
              " things",
          "narrow it down"};
}

Status check_length(std::string_view pattern) {
  if (pattern.size() <= most_pattern) return {};
  return Error{"an address has " + std::to_string(most_pattern) + " letters at most"};
}

}  // namespace

Result<const Simulation::Entity*> find_thing(CommandCall& call, std::string_view name) {
  auto found = entity_named(call.simulation(), name);
  if (!found) call.unknown_thing = true;
  return found;
}

Result<std::vector<const Simulation::Entity*>> match_things(CommandCall& call, std::string_view pattern) {
  SL_TRY(check_length(pattern));
  std::vector<const Simulation::Entity*> out;
  if (!is_pattern(pattern)) {
    SL_ASSIGN(const Simulation::Entity* const thing, find_thing(call, pattern));
    out.push_back(thing);
    return out;
  }
  const Pattern ready(pattern);
  for (const auto& entity : call.simulation().entities()) {
    if (!ready.fits(entity->instance.name)) continue;
    if (out.size() == most_matches) return too_many(pattern);
    out.push_back(entity.get());
  }
  call.unknown_thing = out.empty();
  if (out.empty())
    return Error{"no name fits '" + std::string(pattern) + "'",
                 suggestion(pattern, entity_names(call.simulation()))};
  return out;
}

Result<std::vector<std::string>> match_devices(CommandCall& call, std::string_view pattern) {
  SL_TRY(check_length(pattern));
  std::vector<std::string> out, near;
  const std::string_view robot = pattern.substr(0, pattern.find('/'));
  const Pattern ready(pattern);
  const auto look = [&](const Simulation::Entity& entity) {
    for (const auto& device : entity.devices) {
      if (ready.fits(device->path)) out.push_back(device->path);
      else near.push_back(device->path);
    }
    return out.size() <= most_matches;
  };
  const bool narrow = !is_pattern(robot);
  if (narrow) {
    SL_ASSIGN(const Simulation::Entity* const only, find_thing(call, robot));
    look(*only);
  } else {
    for (const auto& entity : call.simulation().entities())
      if (!look(*entity)) return too_many(pattern);
  }
  if (!out.empty()) return out;
  call.unknown_thing = true;
  if (near.size() > 100) near.resize(100);
  Error error = no_device(pattern);
  error.fix = near.empty() ? "'" + std::string(robot) + "' has none" : suggestion(pattern, near);
  return error;
}

Result<std::string> file_within(const Console::Options& options, std::string_view name) {
  const fs::path path(name);
  if (name.empty()) return Error{"a file's name is missing"};
  const bool anywhere = options.folder == "/";
  if (!anywhere) {
    const Error outside{"'" + std::string(name.substr(0, 200)) + "' is not within the run's folder",
                        "name a file there, without .. and not beginning with /"};
    if (path.is_absolute()) return outside;
    for (const fs::path& part : path)
      if (part == "..") return outside;
    // A link may lead out of it.
    std::error_code failed;
    const fs::path folder = fs::weakly_canonical(options.folder, failed);
    const fs::path file = failed ? fs::path() : fs::weakly_canonical(fs::path(options.folder) / path, failed);
    if (failed) return Error{"cannot reach '" + std::string(name.substr(0, 200)) + "': " + failed.message()};
    const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    if (end != folder.end() && !end->empty()) return outside;
    return (fs::path(options.folder) / path).string();
  }
  return path.is_absolute() ? path.string() : (fs::current_path() / path).string();
}

std::vector<ModelFile> model_files(const Console::Options& options) {
  constexpr std::size_t most = 1000;
  std::vector<std::string> folders = search_path(options.paths).folders;
  std::vector<ModelFile> out;
  std::error_code failed;
  for (const std::string& folder : folders) {
    fs::directory_iterator entries(folder, failed);
    if (failed) continue;
    for (const fs::directory_entry& entry : entries) {
      const fs::path file = entry.path() / "model.sdf";
      if (out.size() >= most || !fs::is_regular_file(file, failed)) continue;
      const fs::path named = fs::path(folder).lexically_normal();
      const fs::path last = named.has_filename() ? named.filename() : named.parent_path().filename();
      ModelFile model{(last / entry.path().filename() / "model.sdf").string(), file.string(), ""};
      if (std::none_of(out.begin(), out.end(), [&](const ModelFile& m) { return m.name == model.name; }))
        out.push_back(std::move(model));
    }
  }
  std::sort(out.begin(), out.end(), [](const ModelFile& a, const ModelFile& b) { return a.name < b.name; });
  return out;
}

std::vector<ModelFile> world_files(const Console::Options& options) {
  constexpr std::size_t most = 1000;
  std::vector<ModelFile> out;
  const auto add_folder = [&](const std::string& folder, std::initializer_list<std::string_view> extensions) {
    std::error_code failed;
    if (folder.empty()) return;
    fs::directory_iterator entries(folder, failed);
    if (failed) return;
    for (const fs::directory_entry& entry : entries) {
      const std::string extension = entry.path().extension().string();
      if (out.size() >= most || !entry.is_regular_file(failed) ||
          std::find(extensions.begin(), extensions.end(), extension) == extensions.end())
        continue;
      const fs::path file = fs::weakly_canonical(entry.path(), failed);
      if (failed ||
          std::any_of(out.begin(), out.end(), [&](const ModelFile& m) { return m.file == file.string(); }))
        continue;
      out.push_back({file.stem().string(), file.string(), extension == ".yaml" ? "scenario" : "world"});
    }
  };
  add_folder(own_folder("scenarios"), {".yaml"});
  add_folder(own_folder("worlds"), {".sdf", ".world"});
  // A console that may go anywhere has no folder of its own to show.
  if (options.folder != "/") add_folder(options.folder, {".yaml", ".sdf", ".world"});
  std::sort(out.begin(), out.end(), [](const ModelFile& a, const ModelFile& b) {
    return std::tie(a.name, a.file) < std::tie(b.name, b.file);
  });
  return out;
}

Result<std::string> resource_file(const Console::Options& options, std::string_view uri,
                                  std::span<const ModelFile> known) {
  if (starts_with(uri, "builder:")) return std::string(uri);
  constexpr std::string_view model_scheme = "model://", file_scheme = "file://";
  const bool by_model = starts_with(uri, model_scheme);
  std::string_view name = uri;
  if (by_model) name.remove_prefix(model_scheme.size());
  if (starts_with(uri, file_scheme)) name.remove_prefix(file_scheme.size());
  std::vector<std::string> near;
  for (const ModelFile& each : known) {
    // models/rover/model.sdf, rover/model.sdf, rover; of a world its name alone.
    const std::string bare = each.name.substr(each.name.find('/') + 1);
    const std::string only = bare.substr(0, bare.find('/'));
    near.push_back(only);
    if (name == each.name || name == bare || name == only || name == each.file) return each.file;
  }
  const Error missing{"there is no '" + std::string(uri.substr(0, 200)) + "'", suggestion(name, near)};
  if (by_model || name.empty()) return missing;
  std::vector<std::string> folders = search_path(options.paths).folders;
  folders.push_back(options.folder);
  folders.push_back(own_folder("scenarios"));
  folders.push_back(own_folder("worlds"));
  std::error_code failed;
  const fs::path wanted = fs::path(name).is_absolute() ? fs::path(name) : fs::path(options.folder) / name;
  const fs::path file = fs::weakly_canonical(wanted, failed);
  if (failed) return missing;
  for (const std::string& each : folders) {
    const fs::path folder = each.empty() ? fs::path() : fs::weakly_canonical(each, failed);
    if (failed || folder.empty()) continue;
    const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    if (end != folder.end() && !end->empty()) continue;
    if (!fs::is_regular_file(file, failed)) return missing;
    return file.string();
  }
  return Error{"'" + std::string(uri.substr(0, 200)) + "' is not within the folders of this run",
               "put it there, or name its folder with --path"};
}

}  // namespace sandlot::console
