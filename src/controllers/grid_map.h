#pragma once
/// Map of a controller: the key `map` names a file of map_server (YAML with a PGM picture, navigation/maps/map_file.h), which
/// the loader of scenarios reads and writes as text into `map_data`. So a snapshot, a recording and a replay need no file.
///
///   "40 30 0.05 -1 -0.5 0\n  600*-1 12*100 588*0"     width, height, resolution, origin x, y, yaw; then runs: count*percent
///
/// Errors   texts that are no such map: sizes that navigation/maps/grid.h refuses, runs that do not fill the cells, percentages
///          that are none.
/// Limits   a map of ragged scale occupancy is a text of some ten bytes a run.
#include <string>
#include <string_view>

#include "base/fields.h"
#include "base/result.h"
#include "navigation/maps/occupancy.h"

namespace sandlot::controllers {

struct MapKeys {
  std::string map, map_data;

  static void fields(auto& s, auto&& visit) {
    constexpr std::size_t most_letters = 1'000'000'000;
    visit(Field{"map", "", "Map file of map_server (.yaml), beside the scenario."}, s.map);
    visit(Field{"map_data", "", "Cells of the map, which the loader fills in.", 0, 0, Field::none,
                most_letters},
          s.map_data);
  }
};

/// The map as text, each number exact. @pre the geometry is valid and the cells fill it
std::string map_text(const navigation::GridMap& map);
Result<navigation::GridMap> read_map_text(std::string_view text);
/// The map that the keys give. Errors: there is none, or a file that nobody has read.
Result<navigation::GridMap> map_of(const MapKeys& keys);

}  // namespace sandlot::controllers
