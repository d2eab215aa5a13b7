#pragma once
/// Preparation of a scenario's Nodes before its keys are read: includes, --set, ${var}; and parts of the
/// reader.
#include <span>
#include <string>

#include "base/node.h"
#include "formats/scenario/scenario.h"
#include "formats/scenario/spec.h"

namespace sandlot::formats {

/// Parses `text` and merges the files it includes below it.
Result<Node> parse_with_includes(std::string_view text, const std::string& file);

/// Applies the overrides in order. New keys are put where the path leads; unknown ones are found when
/// the fields are read.
Status apply_overrides(Node& root, std::span<const Override> overrides);

/// Replaces every ${name} in `root` by the entry of its `vars`; `$${` stands for a plain `${`.
/// A text that is just `${name}` becomes the variable's value, whatever its type, with the variable's place.
/// @param unused  out: entries of `vars` that no ${name} uses, in file order
Status substitute_variables(Node& root, std::vector<std::pair<std::string, Place>>& unused);

/// Adds the robots that the software of teams brings to `robots`; team_software.cpp.
/// @param file    the scenario's
/// @param vars    the scenario's variables as they are written: those of a team may choose another way in them
/// @param unused  entries of `vars` that nothing has used: those that the teams use are taken out
Status add_team_robots(Node& root, const Node& vars, const std::string& file,
                       std::vector<std::pair<std::string, Place>>& unused);

/// Checks and takes over the zones of the ground; zones.cpp.
Status read_zones(const Node& root, const std::vector<scenario_spec::Zone>& keys,
                  std::vector<model::SurfaceZone>& out, Diagnostics& diagnostics);

/// "--set path=value", the `file` of what an override gives.
inline constexpr std::string_view override_place = "--set ";

}  // namespace sandlot::formats
