/// long file: the tables of all that can be listed, as text, JSON, schema and reference page.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

#include "app/commands.h"
#include "assets/mesh/mesh.h"
#include "base/field_json.h"
#include "base/json_text.h"
#include "base/text.h"
#include "builders/builder.h"
#include "controllers/controllers.h"
#include "devices/kind.h"
#include "formats/kind.h"
#include "formats/ros2_control/ros2_control.h"
#include "markers/marker.h"
#include "media/medium.h"
#include "messages/registry.h"
#include "noise/chain.h"
#include "noise/depth_noise.h"
#include "noise/image_noise.h"
#include "physics/engine.h"
#include "programs/programs.h"
#include "rules/rule.h"
#include "sim/load/plugin.h"
#include "sim/world/device_keys.h"
#include "sim/world/faults.h"

namespace sandlot::app {
namespace {

using Json = nlohmann::ordered_json;

/// One thing that can be listed, whatever table it comes from.
struct Item {
  std::string name, help;
  std::vector<FieldInfo> fields;
  std::span<const LevelInfo> levels;
  std::vector<std::string> sdf_names;
  std::span<const Preset> presets = {};
  std::span<const DeviceService> services = {};
  // Of file formats:
  std::string contents = {};  ///< "worlds and models"
  std::vector<std::string> extensions = {};
  bool written = false;  ///< by `sandlot convert`
};
struct Section {
  std::string key, title, intro;
  std::vector<Item> items;
};

/// What lists of stages of errors may hold.
struct StageFamily {
  const char *key, *title, *intro;
  std::vector<StageType> types;
};
std::vector<StageFamily> stage_families() {
  return {{"noise", "Noise",
           "Stages of errors: `noise: [{gaussian: {std: 1 cm}}, ...]`; U is the unit of the values.",
           stage_types()},
          {"image_noise", "Noise of pictures",
           "Stages of errors of pictures: `noise: [{salt_and_pepper: {salt: 1 %, pepper: 1 %}}, ...]` of a "
           "camera; 1 is "
           "full scale.",
           image_stage_types()},
          {"depth_noise", "Noise of depth pictures",
           "Stages of errors of depth pictures: `[{quadratic: {std: 1.4 mm}}, ...]`.", depth_stage_types()}};
}

/// Elements of the world, by the key of the scenario that declares them.
struct ElementFamily {
  const char *key, *title, *intro;
  struct Kind {
    std::string name, help;
    std::vector<FieldInfo> fields;
  };
  std::vector<Kind> kinds;
};
std::vector<ElementFamily> element_families() {
  const auto of = [](const char* key, const char* title, const char* intro, const auto& table) {
    ElementFamily out{key, title, intro, {}};
    for (const auto* const kind : table) out.kinds.push_back({kind->name, kind->help, kind->describe()});
    return out;
  };
  return {of("media", "Media", "What spreads between robots or pushes them: `media:` of a scenario.",
             medium_kinds()),
          of("rules", "Rules", "What judges the run, and acts: `rules:` of a scenario.", rule_kinds()),
          of("markers", "Markers", "Areas on the ground: `markers:` of a scenario.", marker_kinds())};
}

Section format_section() {
  Section out{
      "formats",
      "File formats",
      "What `sandlot run`, `check`, `info` and `convert` read, by the extension of the file, and the meshes "
      "that such files name.",
      {}};
  for (const formats::FormatKind* const kind : formats::format_kinds()) {
    Item item{kind->name, kind->help, {}, {}, {}};
    item.contents = kind->contents;
    item.extensions.assign(kind->extensions.begin(), kind->extensions.end());
    item.written = kind->scenario || kind->write_world || kind->write_model;
    out.items.push_back(std::move(item));
  }
  for (const assets::MeshFormat& format : assets::mesh_formats()) {
    Item item{format.name, format.help, {}, {}, {}};
    item.contents = "meshes";
    item.extensions.assign(format.extensions.begin(), format.extensions.end());
    out.items.push_back(std::move(item));
  }
  return out;
}

std::vector<Section> sections(std::span<const ControllerKind* const> controller_table) {
  Section devices{"devices", "Devices", "Sensors and actuators: `devices:` of a robot in a scenario.", {}};
  for (const Kind* kind : device_kinds()) {
    Item item{kind->name, kind->help, kind->describe(), kind->levels, {}, kind->presets, kind->services};
    for (const char* name : kind->sdf_types) item.sdf_names.emplace_back(name);
    devices.items.push_back(std::move(item));
  }
  Section controllers{
      "controllers", "Controllers", "Programs that decide: `controller:` of a robot in a scenario.", {}};
  for (const ControllerKind* kind : controller_table)
    controllers.items.push_back({kind->name, kind->help, kind->describe(), {}, {}, {}});
  Section programs{
      "programs",
      "Programs",
      "Programs outside this process that decide, in the place of a controller: `controller:` of a "
      "robot or a team in a scenario.",
      {}};
  for (const ProgramKind* kind : program_kinds())
    programs.items.push_back({kind->name, kind->help, kind->describe(), {}, {}, {}});
  Section engines{"engines", "Physics engines", "`physics:` of a scenario.", {}};
  for (const EngineKind* kind : engine_kinds())
    engines.items.push_back({kind->name, kind->help, kind->describe(), {}, {}, {}});
  Section common{"common",
                 "Common keys",
                 "Keys of every device in addition to its kind's and to those of [faults](#faults): `mass: "
                 "160 g`, `delay: 50 ms`, "
                 "`command_errors: {linear: [{gaussian: {std: 1 cm/s}}]}`.",
                 {}};
  common.items.push_back(
      {"device",
       "Mass, limit of activations, delay, errors of commands and drains. A kind with a key "
       "`errors` of its own has that one.",
       describe_fields<DeviceKeysSpec>(),
       {},
       {},
       {}});
  Section faults{
      "faults",
      "Faults",
      "Keys of every device in addition to its kind's: `failures: [{kind: stuck, from: 3 s, until: 5 s}]`, "
      "`clock: {drift: 20e-6}`.",
      {}};
  faults.items.push_back({"failures",
                          "Times in which the device is stuck, dead or noisy, one per entry of the list.",
                          describe_fields<FailureSpec>(),
                          {},
                          {},
                          {}});
  faults.items.push_back(
      {"clock", "Errors of the times in its messages.", describe_fields<ClockSpec>(), {}, {}, {}});
  std::vector<Section> out{devices, controllers, programs};
  for (ElementFamily& family : element_families()) {
    out.push_back({family.key, family.title, family.intro, {}});
    for (auto& [name, help, fields] : family.kinds) out.back().items.push_back({name, help, fields, {}, {}});
  }
  out.push_back(std::move(engines));
  for (const StageFamily& family : stage_families()) {
    out.push_back({family.key, family.title, family.intro, {}});
    for (const StageType& type : family.types)
      out.back().items.push_back({type.name, type.help, type.fields, {}, {}, {}});
  }
  out.push_back(std::move(common));
  out.push_back(std::move(faults));
  Section builders{
      "builders",
      "Builders",
      "Models with parameters: `model: {builder: snake, segments: 12}` of a robot or a thing in a scenario, "
      "`builder:snake?segments=12` on the command line.",
      {}};
  for (const Builder* const builder : builder_table())
    builders.items.push_back({builder->name, builder->help, builder->describe(), {}, {}, {}});
  out.push_back(std::move(builders));
  out.push_back(format_section());
  return out;
}

std::string joined(std::span<const std::string> words, const char* between = ", ") {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word;
  return out;
}

/// Six digits are enough to read; JSON has them all.
std::string short_number(double x) { return fmt::format("{:.6g}", x); }

std::string limits(const FieldInfo& field) {
  if (!field.choices.empty()) return joined(field.choices);
  if (field.type != "number" && field.type != "integer" && field.type != "list of number") return "";
  if (field.min <= -1e12 && field.max >= 1e12) return "";
  return short_number(field.min) + " .. " + short_number(field.max);
}

std::string default_text(const FieldInfo& field) {
  double number = 0;
  if (field.default_value == "[]") return "";
  return parse_number(field.default_value, number) ? short_number(number) : field.default_value;
}

/// "number m, 0 .. 10; default 1; tunable"
std::string summary(const FieldInfo& field) {
  std::string out = field.type;
  if (!field.unit.empty() && field.unit != "1") out += " " + field.unit;
  if (!limits(field).empty()) out += (field.choices.empty() ? ", " : " of ") + limits(field);
  if (field.required) out += "; required";
  else if (!default_text(field).empty()) out += "; default " + default_text(field);
  if (field.tunable) out += "; tunable";
  return out;
}

/// "Files: .sdf, .world."
std::string files_text(const Item& item, const char* mark = "") {
  std::string names;
  for (const std::string& each : item.extensions) names += (names.empty() ? "" : ", ") + (mark + each + mark);
  return "Files: " + names + (item.written ? "; `sandlot convert` writes them too." : ".");
}

/// Help of a level, unless it is that of its kind: those with one level often have the same.
std::string own_help(const Item& item, const LevelInfo& level) {
  return item.help == level.help ? "" : level.help;
}

/// Width of a column that holds these names.
template <class List, class Name>
std::size_t width_of(const List& list, Name name) {
  std::size_t out = 0;
  for (const auto& each : list) out = std::max(out, std::string_view(name(each)).size());
  return out;
}

void print_text(const Section& section, bool verbose) {
  const std::size_t width = width_of(section.items,
                                     [](const Item& item) { return std::string_view(item.name); });
  fmt::print("{}\n", section.key);
  for (const Item& item : section.items) {
    std::string more;
    if (item.levels.size() > 1) {
      for (const LevelInfo& level : item.levels) more += (more.empty() ? "" : ", ") + std::string(level.name);
      more = " Levels: " + more + ".";
    }
    if (!item.extensions.empty()) more = " " + files_text(item);
    fmt::print("  {:<{}}  {}{}\n", item.name, width, item.help, more);
    if (!verbose) continue;
    for (const LevelInfo& level : item.levels) {
      std::string line = own_help(item, level);
      if (*level.message) line += (line.empty() ? "" : " ") + std::string("Publishes ") + level.message + ".";
      if (*level.command) line += (line.empty() ? "" : " ") + std::string("Takes ") + level.command + ".";
      fmt::print("    level {:<20} {}\n", level.name, line);
    }
    for (const DeviceService& service : item.services)
      fmt::print("    service {:<18} {} Type {}.\n", service.name, service.help, service.type);
    for (const Preset& preset : item.presets) fmt::print("    preset {:<19} {}\n", preset.name, preset.help);
    const std::size_t keys = std::max<std::size_t>(
        26, width_of(item.fields, [](const FieldInfo& field) { return std::string_view(field.path); }));
    for (const FieldInfo& field : item.fields)
      fmt::print("    {:<{}} {} [{}]\n", field.path, keys, field.help, summary(field));
  }
}

void print_levels() {
  const std::size_t kinds = width_of(device_kinds(), [](const Kind* kind) { return kind->name; });
  std::size_t levels = 0;
  for (const Kind* const kind : device_kinds())
    levels = std::max(levels, width_of(kind->levels, [](const LevelInfo& level) { return level.name; }));
  fmt::print("levels\n");
  for (const Kind* const kind : device_kinds()) {
    const char* name = kind->name;
    for (const LevelInfo& level : kind->levels) {
      fmt::print("  {:<{}}  {:<{}}  {}\n", name, kinds, level.name, levels, level.help);
      name = "";
    }
  }
}

/// One thing that a Gazebo file or a controller file may name, and what it becomes here.
struct Mapped {
  std::string name, element, kind, levels, unused;
};

std::vector<Mapped> mapped_names() {
  std::vector<Mapped> out;
  for (const Kind* kind : device_kinds()) {
    std::string levels;
    for (const LevelInfo& level : kind->levels)
      levels += (levels.empty() ? "" : ", ") + std::string(level.name);
    for (const std::string_view name : kind->sdf_types) {
      const std::size_t colon = name.find(':');
      out.push_back({std::string(name.substr(colon + 1)), std::string(name.substr(0, colon)), kind->name,
                     levels, kind->sdf_note});
    }
  }
  for (const formats::ControllerType& each : formats::controller_types())
    out.push_back({each.type, "controller", each.kind, each.level, "rates of the loop, topics, tolerances"});
  std::stable_sort(out.begin(), out.end(), [](const Mapped& a, const Mapped& b) {
    return std::tie(a.element, a.name, a.kind) < std::tie(b.element, b.name, b.kind);
  });
  return out;
}

/// What of such elements has no effect, by the kind that they become, and of controllers.
std::map<std::string, std::string> without_effect() {
  std::map<std::string, std::string> out;
  for (const Mapped& row : mapped_names())
    if (!row.unused.empty())
      out.emplace(row.element == "controller" ? "(controllers)" : row.kind, row.unused);
  return out;
}

void print_plugins() {
  const std::vector<Mapped> rows = mapped_names();
  const auto column = [&](std::string Mapped::*text) {
    return width_of(rows, [&](const Mapped& row) { return std::string_view(row.*text); });
  };
  const std::size_t elements = column(&Mapped::element), names = column(&Mapped::name),
                    kinds = column(&Mapped::kind);
  fmt::print("plugins\n");
  for (const Mapped& row : rows)
    fmt::print("  {:<{}}  {:<{}}  {:<{}}  {}\n", row.element, elements, row.name, names, row.kind, kinds,
               row.levels);
  fmt::print("without effect, by kind\n");
  for (const auto& [kind, unused] : without_effect()) fmt::print("  {:<{}}  {}\n", kind, kinds, unused);
}

/// "float32[]", "geometry_msgs/msg/Point[4]": the type of a field as ROS writes it.
std::string type_text(const MessageField& field) {
  std::string out = field.message ? field.message->name : name_of(field.type);
  if (field.count == MessageField::Count::array) out += "[" + std::to_string(field.length) + "]";
  if (field.count == MessageField::Count::sequence)
    out += field.length > 0 ? "[<=" + std::to_string(field.length) + "]" : "[]";
  return out;
}

void print_members(const MessageInfo& type) {
  for (const MessageConstant& constant : type.constants)
    fmt::print("    {:<40} {} = {}\n", name_of(constant.type), constant.name, constant.value);
  for (const MessageField& field : type.fields)
    fmt::print("    {:<40} {:<26} {}{}\n", type_text(field), field.name, field.help,
               field.unit.empty() || field.unit == "1" ? "" : " [" + field.unit + "]");
}

bool is_side_of_service(const MessageInfo& type) { return type.name.find("/srv/") != std::string::npos; }

/// Types of messages and services, those of the names that were given, or all.
struct Types {
  std::vector<const MessageInfo*> messages;
  std::vector<ServiceInfo> services;
};
Result<Types> choose_types(std::span<const std::string> names) {
  Types all{{}, {all_services().begin(), all_services().end()}};
  for (const MessageInfo* const type : all_messages())
    if (!is_side_of_service(*type)) all.messages.push_back(type);
  if (names.empty()) return all;
  Types out;
  std::vector<std::string> known;
  for (const MessageInfo* const type : all.messages) known.push_back(type->name);
  for (const ServiceInfo& service : all.services) known.emplace_back(service.name);
  for (const std::string& name : names) {
    // "Twist" is enough where only one package has it.
    const auto named = [&](std::string_view full) {
      return full == name || (name.find('/') == name.npos && full.ends_with("/" + name));
    };
    const std::size_t before = out.messages.size() + out.services.size();
    for (const MessageInfo* const type : all.messages)
      if (named(type->name)) out.messages.push_back(type);
    for (const ServiceInfo& service : all.services)
      if (named(service.name)) out.services.push_back(service);
    if (out.messages.size() + out.services.size() == before)
      return Error{"list messages: there is no type '" + name + "'", suggestion(name, known)};
  }
  return out;
}

void print_messages(const Types& types, bool verbose) {
  if (!types.messages.empty()) fmt::print("messages\n");
  for (const MessageInfo* const type : types.messages) {
    fmt::print("  {}\n", type->name);
    if (verbose) print_members(*type);
  }
  if (!types.services.empty()) fmt::print("services\n");
  for (const ServiceInfo& service : types.services) {
    fmt::print("  {}\n", service.name);
    if (!verbose) continue;
    print_members(*service.request);
    fmt::print("    ---\n");
    print_members(*service.response);
  }
}

Json message_json(const MessageInfo& type) {
  Json constants = Json::array(), fields = Json::array();
  for (const MessageConstant& constant : type.constants)
    constants.push_back(
        {{"name", constant.name}, {"type", name_of(constant.type)}, {"value", constant.value}});
  for (const MessageField& field : type.fields)
    fields.push_back(
        {{"name", field.name}, {"type", type_text(field)}, {"unit", field.unit}, {"help", field.help}});
  return {{"name", type.name}, {"constants", constants}, {"fields", fields}};
}

Json messages_json(const Types& chosen) {
  Json types = Json::array(), services = Json::array();
  for (const MessageInfo* const type : chosen.messages) types.push_back(message_json(*type));
  for (const ServiceInfo& service : chosen.services)
    services.push_back({{"name", service.name},
                        {"request", message_json(*service.request)},
                        {"response", message_json(*service.response)}});
  return {{"messages", types}, {"services", services}};
}

std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

void print_plugin_table() {
  fmt::print(
      "\n## Gazebo's sensors and plugins\n\nWhat `<sensor type=\"...\">` and `<plugin>` of SDF and URDF "
      "files "
      "become, and the types of joint controllers in ROS parameter files (`joint_controllers:` of a robot, "
      "or the "
      "ros2_control plugin of its model). A plugin is known by its class (the last part of `name`) or by its "
      "library (`filename` "
      "without "
      "`lib` and `.so`). Where two kinds answer to one name, the element decides: several planes make a "
      "lidar 3D. "
      "What is not in the table is named in one warning with its line.\n\n"
      "| element | name | kind | levels |\n|---|---|---|---|\n");
  for (const Mapped& row : mapped_names())
    fmt::print("| {} | `{}` | [{}](#{}) | {} |\n", row.element, row.name, row.kind, row.kind, row.levels);
  fmt::print("\n| kind | has no effect |\n|---|---|\n");
  for (const auto& [kind, unused] : without_effect()) fmt::print("| {} | {} |\n", kind, cell(unused));
}

void print_markdown(const std::vector<Section>& all) {
  fmt::print(
      "# Reference\n\nGenerated by `sandlot list --markdown` from the field lists of the program; a test "
      "keeps it so.\n");
  for (const Section& section : all) {
    fmt::print("\n## {}\n\n{}\n", section.title, section.intro);
    for (const Item& item : section.items) {
      fmt::print("\n### {}\n\n{}\n", item.name, item.help);
      if (!item.sdf_names.empty()) {
        std::string names;
        for (const std::string& name : item.sdf_names) names += (names.empty() ? "`" : ", `") + name + "`";
        fmt::print("\nIn SDF files: {}.\n", names);
      }
      if (!item.extensions.empty()) fmt::print("\n{}\n", files_text(item, "`"));
      if (!item.levels.empty()) {
        fmt::print("\n| level | publishes | takes | meaning |\n|---|---|---|---|\n");
        for (const LevelInfo& level : item.levels)
          fmt::print("| `{}` | {} | {} | {} |\n", level.name, level.message, level.command,
                     own_help(item, level));
      }
      if (!item.services.empty()) {
        fmt::print("\n| service | type | meaning |\n|---|---|---|\n");
        for (const DeviceService& service : item.services)
          fmt::print("| `{}` | {} | {} |\n", service.name, service.type, cell(service.help));
      }
      if (!item.presets.empty()) {
        fmt::print("\n| preset | stands for |\n|---|---|\n");
        for (const Preset& preset : item.presets)
          fmt::print("| `{}` | {} `{}` |\n", preset.name, cell(preset.help), cell(preset.keys));
      }
      if (item.fields.empty()) continue;
      fmt::print("\n| key | type | unit | range | default | meaning |\n|---|---|---|---|---|---|\n");
      for (const FieldInfo& field : item.fields)
        fmt::print("| `{}` | {}{} | {} | {} | {} | {} |\n", field.path, field.type,
                   field.tunable ? ", tunable" : "", field.unit == "1" ? "" : field.unit, limits(field),
                   field.required ? "required" : cell(default_text(field)), cell(field.help));
    }
    if (section.key == "devices") print_plugin_table();
  }
}

Json to_json(const Section& section) {
  Json out = Json::array();
  for (const Item& item : section.items) {
    Json entry{{"name", item.name}, {"help", item.help}};
    Json levels = Json::array(), fields = Json::array();
    for (const LevelInfo& level : item.levels)
      levels.push_back({{"name", level.name},
                        {"publishes", level.message},
                        {"takes", level.command},
                        {"help", level.help}});
    for (const FieldInfo& f : item.fields) {
      std::string field;
      JsonWriter writer(field);
      writer.object([&] {
        writer.key("key").text(f.path);
        write_field(writer, f);
      });
      fields.push_back(Json::parse(field));
    }
    if (!item.extensions.empty()) {
      entry["contents"] = item.contents;
      entry["extensions"] = item.extensions;
      entry["written"] = item.written;
    }
    entry["levels"] = levels;
    entry["sdf"] = item.sdf_names;
    Json presets = Json::array();
    for (const Preset& preset : item.presets)
      presets.push_back({{"name", preset.name}, {"help", preset.help}, {"keys", preset.keys}});
    entry["presets"] = presets;
    if (!item.services.empty()) {
      Json services = Json::array();
      for (const DeviceService& service : item.services)
        services.push_back({{"name", service.name}, {"type", service.type}, {"help", service.help}});
      entry["services"] = services;
    }
    entry["fields"] = fields;
    out.push_back(std::move(entry));
  }
  return out;
}

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

}  // namespace

int list(const ListOptions& options) {
  const auto known = known_controllers(options);
  if (!known) return complain(known.error());
  std::vector<Section> chosen = sections(*known);
  if (options.schema && !options.what.empty())
    return complain({"--schema stands for the whole", "leave '" + options.what + "' out"});
  if (options.schema) {
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
    for (const ControllerKind* kind : *known) controllers.emplace_back(kind->name, kind->describe());
    for (const ProgramKind* kind : program_kinds()) controllers.emplace_back(kind->name, kind->describe());
    std::vector<formats::StageFields> stages;
    for (StageFamily& family : stage_families()) {
      stages.push_back({family.key, {}});
      for (StageType& type : family.types)
        stages.back().second.emplace_back(type.name, std::move(type.fields));
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
    return exit_ok;
  }
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
