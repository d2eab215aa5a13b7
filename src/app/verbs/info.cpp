#include "app/verbs/info.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "base/json_text.h"
#include "run/snapshot_files.h"
#include "sim/watch/values.h"

namespace sandlot::app {

const char* role_of(const model::Instance& instance) {
  return instance.motion             ? "actor"
         : instance.is_robot         ? "robot"
         : instance.model->is_static ? "static"
                                     : "object";
}

Overview overview_of(const Simulation& simulation) {
  Overview out;
  for (const model::Instance* instance : simulation.instances()) {
    const model::Model& model = *instance->model;
    ++(instance->motion     ? out.actors
       : instance->is_robot ? out.robots
       : model.is_static    ? out.statics
                            : out.objects);
    for (const model::Link& link : model.links) {
      if (!model.is_static && !instance->motion) out.moving_mass_kg += link.inertial.mass_kg;
      for (const model::Collision& collision : link.collisions) {
        out.bounds.include(bounds_of(collision.shape, instance->X_WM * link.X_ML * collision.X_LC));
        out.endless_ground = out.endless_ground || std::holds_alternative<Plane>(collision.shape);
      }
    }
  }
  return out;
}

nlohmann::ordered_json values_json(const Simulation& simulation) {
  auto out = nlohmann::ordered_json::array();
  list_values(simulation, "", [&](const ValueEntry& entry) {
    nlohmann::ordered_json one{{"address", entry.path}, {"unit", entry.unit}, {"help", entry.help}};
    if (entry.list) one["count"] = entry.count;
    const bool known = entry.is == ValueFound::Is::value && std::isfinite(entry.value);
    one["value"] = known ? nlohmann::ordered_json(entry.value) : nlohmann::ordered_json(nullptr);
    out.push_back(std::move(one));
  });
  return out;
}

std::string values_text(const Simulation& simulation) {
  std::string out;
  list_values(simulation, "", [&](const ValueEntry& entry) {
    std::string address = entry.path;
    if (entry.list) address += entry.count == 0 ? "[...]" : "[0.." + std::to_string(entry.count - 1) + "]";
    const std::string value = entry.is == ValueFound::Is::value ? fmt::format("{:.6g}", entry.value) : "-";
    out += fmt::format("{:<48} {:>12} {:<6} {}\n", address, value, entry.unit == "1" ? "" : entry.unit,
                       entry.help);
  });
  return out;
}

int info(const FileOptions& options) {
  auto many = nlohmann::ordered_json::array();
  for (const std::string& file : options.files) {
    Diagnostics diagnostics;
    const bool is_snapshot = is_snapshot_file(file);
    std::vector<std::pair<std::string, std::string>> facts;
    if (is_snapshot) {
      auto examined = snapshot_facts(file);
      if (!examined) return complain(examined.error());
      facts = std::move(*examined);
    }
    const auto built = is_snapshot ? restore_snapshot_file(file, {.paths = options.paths}, diagnostics)
                                   : build(file, options, diagnostics);
    if (!built) {
      print_warnings(diagnostics);
      return complain(built.error());
    }
    if (options.values) {
      if (options.json) many.push_back(values_json(**built));
      else std::fputs(values_text(**built).c_str(), stdout);
      continue;
    }
    if (options.json) {
      auto json = info_json(**built, diagnostics);
      for (const auto& [name, value] : facts) json["snapshot"][name] = value;
      many.push_back(std::move(json));
    } else {
      for (const auto& [name, value] : facts) std::printf("%-9s %s\n", name.c_str(), value.c_str());
      std::fputs(info_text(file, **built, diagnostics).c_str(), stdout);
    }
  }
  // One file gives one object, so that the common case needs no index.
  if (options.json) std::printf("%s\n", json_text(many.size() == 1 ? many[0] : many).c_str());
  return exit_ok;
}

}  // namespace sandlot::app
