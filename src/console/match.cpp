/// What words mean: things, devices, parameters, files.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/text.h"
#include "console/command.h"
#include "console/words.h"
#include "controllers/controllers.h"
#include "devices/kind.h"
#include "files/resources.h"

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

std::vector<std::string> names_of_things(const Simulation& simulation) {
  std::vector<std::string> out;
  for (const auto& entity : simulation.entities()) out.push_back(entity->instance.name);
  return out;
}

/// What a device's or program's kind says of its fields; empty for kinds that plugins bring.
const std::vector<FieldInfo>& fields_of(const std::string& kind, bool program) {
  // Kinds are constants of the process, so what they say may be kept.
  thread_local std::map<std::pair<std::string, bool>, std::vector<FieldInfo>> known;
  const auto [place, fresh] = known.try_emplace({kind, program});
  if (!fresh) return place->second;
  if (program) {
    for (const ControllerKind* each : controller_kinds())
      if (kind == each->name) place->second = each->describe();
  } else if (const auto found = find_device_kind(kind)) {
    place->second = (*found)->describe();
  }
  return place->second;
}

std::string with_dots(std::string path) {
  // "noise/0/white" is noise[0].white in an address.
  std::string out;
  for (const std::string_view part : split(path, '/')) {
    const bool index = !part.empty() &&
                       std::all_of(part.begin(), part.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (index) out.append("[").append(part).append("]");
    else out.append(out.empty() ? "" : ".").append(part);
  }
  return out;
}

}  // namespace

std::string Parameter::address() const { return target + "." + with_dots(path); }

Result<const Simulation::Entity*> find_thing(Call& call, std::string_view name) {
  if (const Simulation::Entity* const found = call.simulation().find_entity(name)) return found;
  call.unknown_thing = true;
  return Error{"there is nothing named '" + std::string(name.substr(0, 60)) + "'",
               suggestion(name, names_of_things(call.simulation()))};
}

Result<std::vector<const Simulation::Entity*>> match_things(Call& call, std::string_view pattern) {
  SL_TRY(check_length(pattern));
  std::vector<const Simulation::Entity*> out;
  if (!is_pattern(pattern)) {
    SL_ASSIGN(const Simulation::Entity* const thing, find_thing(call, pattern));
    out.push_back(thing);
    return out;
  }
  for (const auto& entity : call.simulation().entities()) {
    if (!fits(pattern, entity->instance.name)) continue;
    if (out.size() == most_matches) return too_many(pattern);
    out.push_back(entity.get());
  }
  call.unknown_thing = out.empty();
  if (out.empty())
    return Error{"no name fits '" + std::string(pattern) + "'",
                 suggestion(pattern, names_of_things(call.simulation()))};
  return out;
}

Result<std::vector<std::string>> match_devices(Call& call, std::string_view pattern) {
  SL_TRY(check_length(pattern));
  std::vector<std::string> out, near;
  const std::string_view robot = pattern.substr(0, pattern.find('/'));
  const auto look = [&](const Simulation::Entity& entity) {
    for (const auto& device : entity.devices) {
      if (fits(pattern, device->path)) out.push_back(device->path);
      else near.push_back(device->path);
    }
    return out.size() <= most_matches;
  };
  const bool narrow = !is_pattern(robot);
  if (const Simulation::Entity* const only = narrow ? call.simulation().find_entity(robot) : nullptr) {
    look(*only);
  } else if (narrow) {
    call.unknown_thing = true;
    return Error{"there is nothing named '" + std::string(robot.substr(0, 60)) + "'",
                 suggestion(robot, names_of_things(call.simulation()))};
  } else {
    for (const auto& entity : call.simulation().entities())
      if (!look(*entity)) return too_many(pattern);
  }
  if (!out.empty()) return out;
  call.unknown_thing = true;
  if (near.size() > 100) near.resize(100);
  return Error{"there is no device '" + std::string(pattern) + "'",
               near.empty() ? "'" + std::string(robot) + "' has none" : suggestion(pattern, near)};
}

std::vector<Parameter> parameters_of(const Simulation& simulation, const Simulation::Entity& entity,
                                     std::string_view path) {
  std::vector<Parameter> out;
  std::map<std::string, std::string, std::less<>> present;  // paths that have a value now, with their units
  const auto note = [&](const ValueEntry& entry) {
    if (entry.is != ValueFound::Is::absent || entry.list) present.emplace(entry.path, entry.unit);
  };
  const auto gather = [&](const std::string& target, const std::vector<FieldInfo>& fields) {
    std::vector<std::string> lists;
    for (const FieldInfo& field : fields) {
      if (field.type == "list of maps") {
        lists.push_back(with_dots(field.path) + "[");
        continue;
      }
      if (!field.tunable || field.path.find("[]") != std::string::npos) continue;
      const std::string dotted = with_dots(field.path);
      const bool plain = field.type == "number" || field.type == "integer" || field.type == "bool" ||
                         field.type == "choice";
      if (plain && !present.contains(dotted)) continue;  // in a part that is not set
      out.push_back({target, field.path, field.unit});
    }
    for (const auto& [value, unit] : present) {
      bool in_list = fields.empty();  // of a kind that we know nothing of, every one may be tunable
      for (const std::string& list : lists) in_list = in_list || starts_with(value, list);
      if (!in_list) continue;
      std::string with_slashes;
      for (const char c : value)
        if (c == '[' || c == '.') with_slashes += '/';
        else if (c != ']') with_slashes += c;
      out.push_back({target, with_slashes, unit});
    }
  };
  for (const auto& device : entity.devices)
    if (device->path == path) {
      simulation.pool(*device).list_values(device->index, ValuePart::parameter, note);
      gather(device->path, fields_of(device->decl.kind, false));
      return out;
    }
  for (const auto& program : entity.programs)
    if (program->path == path) {
      program->program->list_values(ValuePart::parameter, note);
      gather(program->path, fields_of(program->decl.kind, true));
    }
  return out;
}

Status check_parameter(const Simulation& simulation, const Parameter& parameter, const Node& value) {
  const Simulation::Entity* const entity = simulation.find_entity(
      std::string_view(parameter.target).substr(0, parameter.target.find('/')));
  if (!entity) return {};
  const std::vector<FieldInfo>* fields = nullptr;
  for (const auto& device : entity->devices)
    if (device->path == parameter.target) fields = &fields_of(device->decl.kind, false);
  for (const auto& program : entity->programs)
    if (program->path == parameter.target) fields = &fields_of(program->decl.kind, true);
  if (!fields) return {};
  for (const FieldInfo& info : *fields) {
    if (info.path != parameter.path) continue;
    if (!info.tunable) return Error{"'" + parameter.address() + "' is fixed once the run has started"};
    const Field field{info.path.c_str(), info.unit.c_str(), info.help.c_str(), info.min, info.max};
    if (info.type == "number" || info.type == "integer") {
      auto number = read_number(value, field, info.min, info.max, info.type == "integer", "");
      if (!number) return std::move(number.error());
    } else if (info.type == "bool") {
      auto read = read_bool(value, "");
      if (!read) return std::move(read.error());
    } else if (info.type == "choice") {
      if (std::find(info.choices.begin(), info.choices.end(), value.text()) == info.choices.end())
        return Error{"'" + value.text().substr(0, 40) + "' is no choice here",
                     suggestion(value.text(), info.choices)};
    }
  }
  return {};
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

}  // namespace sandlot::console
