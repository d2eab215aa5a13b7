#include "app/verbs/list/plugins.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <tuple>

#include "app/verbs/list/print.h"
#include "devices/kind.h"
#include "formats/ros2_control/ros2_control.h"

namespace sandlot::app {

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

namespace {

/// What of such elements has no effect, by the kind that they become, and of controllers.
std::map<std::string, std::string> without_effect() {
  std::map<std::string, std::string> out;
  for (const Mapped& row : mapped_names())
    if (!row.unused.empty())
      out.emplace(row.element == "controller" ? "(controllers)" : row.kind, row.unused);
  return out;
}

}  // namespace

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

}  // namespace sandlot::app
