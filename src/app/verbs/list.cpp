/// `sandlot list`: which sections, and in which form. The folder list has what can be listed.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/verbs/list/messages.h"
#include "app/verbs/list/plugins.h"
#include "app/verbs/list/print.h"
#include "app/verbs/list/sections.h"
#include "base/json_text.h"
#include "base/text.h"
#include "builders/builder.h"
#include "formats/scenario/scenario.h"
#include "programs/programs.h"
#include "sim/load/plugin.h"
#include "sim/world/device_keys.h"
#include "sim/world/faults.h"

namespace sandlot::app {
namespace {

using Json = nlohmann::ordered_json;

/// Our controllers and those of the plugins that were asked for.
Result<std::vector<const ControllerKind*>> known_controllers(const ListOptions& options) {
  std::vector<const ControllerKind*> out(controller_kinds().begin(), controller_kinds().end());
  Diagnostics none;
  for (const std::string& written : options.plugins) {
    SL_ASSIGN(const std::string file, find_plugin(written, "", {}, {}));
    SL_ASSIGN(const Plugin* const plugin, load_plugin({file, "", 0, {}}, {}, none));
    out.insert(out.end(), plugin->controllers.begin(), plugin->controllers.end());
  }
  return out;
}

/// Leaves only the items of these names in a section; all of them when there are none.
Status keep_named(Section& section, std::span<const std::string> names) {
  if (names.empty()) return {};
  std::vector<Item> kept;
  std::vector<std::string> known;
  for (const Item& item : section.items) known.push_back(item.name);
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      return Error{"list " + section.key + ": there is no '" + name + "'", suggestion(name, known)};
    kept.push_back(section.items[static_cast<std::size_t>(found - known.begin())]);
  }
  section.items = std::move(kept);
  return {};
}

void print_schema(std::span<const ControllerKind* const> table) {
  std::vector<formats::KindFields> devices, controllers;
  for (const Kind* kind : device_kinds()) {
    devices.emplace_back(kind->name, kind->describe());
    for (FieldInfo& field : device_key_fields(*kind)) devices.back().second.push_back(std::move(field));
    if (kind->presets.empty()) continue;
    FieldInfo preset{"preset", "choice", "",
                     "Name of ready-made keys; keys given in addition take precedence."};
    for (const Preset& each : kind->presets) preset.choices.emplace_back(each.name);
    devices.back().second.push_back(std::move(preset));
  }
  for (const ControllerKind* kind : table) controllers.emplace_back(kind->name, kind->describe());
  for (const ProgramKind* kind : program_kinds()) controllers.emplace_back(kind->name, kind->describe());
  std::vector<formats::StageFields> stages;
  for (StageFamily& family : stage_families()) {
    stages.push_back({family.key, {}});
    for (StageType& type : family.types) stages.back().second.emplace_back(type.name, std::move(type.fields));
  }
  std::vector<formats::KindFields> builders;
  for (const Builder* const builder : builder_table())
    builders.emplace_back(builder->name, builder->describe());
  std::vector<formats::ElementFields> elements;
  for (const ElementFamily& family : element_families()) {
    elements.push_back({family.key, {}});
    for (const ElementFamily::Kind& kind : family.kinds)
      elements.back().second.emplace_back(kind.name, kind.fields);
  }
  fmt::print("{}\n", formats::scenario_schema(devices, controllers, stages, builders,
                                              describe_fields<FaultsSpec>(), elements));
}

}  // namespace

int list(const ListOptions& options) {
  const auto known = known_controllers(options);
  if (!known) return complain(known.error());
  std::vector<Section> chosen = sections(*known);
  if (options.schema && !options.what.empty())
    return complain({"--schema stands for the whole", "leave '" + options.what + "' out"});
  if (options.schema) return print_schema(*known), exit_ok;
  if (!options.names.empty() && (options.what == "plugins" || options.what == "levels"))
    return complain(
        {"list " + options.what + " takes no names", "leave '" + options.names.front() + "' out"});
  if (options.what == "plugins" && !options.markdown) {
    if (!options.json) return print_plugins(), exit_ok;
    Json rows = Json::array();
    for (const Mapped& row : mapped_names())
      rows.push_back({{"element", row.element},
                      {"name", row.name},
                      {"kind", row.kind},
                      {"levels", row.levels},
                      {"unused", row.unused}});
    fmt::print("{}\n", json_text(Json{{"plugins", rows}}));
    return exit_ok;
  }
  if (options.what == "messages" && !options.markdown) {
    const auto types = choose_types(options.names);
    if (!types) return complain(types.error());
    if (options.json) fmt::print("{}\n", messages_json(*types).dump(2));
    else print_messages(*types, options.verbose || !options.names.empty());
    return exit_ok;
  }
  if (!options.what.empty() && options.what != "levels") {
    std::vector<std::string> names{"levels", "messages", "plugins"};
    for (const Section& section : chosen) names.push_back(section.key);
    std::erase_if(chosen, [&](const Section& section) { return section.key != options.what; });
    if (chosen.empty())
      return complain(
          {"list: there is nothing called '" + options.what + "'", suggestion(options.what, names)});
    if (Status status = keep_named(chosen.front(), options.names); !status) return complain(status.error());
  }
  if (options.json) {
    Json json;
    for (const Section& section : chosen) json[section.key] = to_json(section);
    fmt::print("{}\n", json_text(json));
  } else if (options.markdown) {
    print_markdown(chosen);
  } else if (options.what == "levels") {
    print_levels();
  } else {
    for (const Section& section : chosen) print_text(section, options.verbose || !options.names.empty());
  }
  return exit_ok;
}

}  // namespace sandlot::app
