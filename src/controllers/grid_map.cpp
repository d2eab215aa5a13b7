#include "controllers/grid_map.h"

#include <charconv>
#include <cmath>

#include "base/text.h"

namespace sandlot::controllers {
namespace {

using navigation::GridMap;

/// Numbers of a text from its beginning on.
class Numbers {
 public:
  explicit Numbers(std::string_view text) : text_(text) {}
  bool ended() {
    const std::size_t begin = text_.find_first_not_of(" \n");
    text_.remove_prefix(begin == std::string_view::npos ? text_.size() : begin);
    return text_.empty();
  }
  template <class T>
  bool take(T& out) {
    if (ended()) return false;
    const auto [end, error] = std::from_chars(text_.data(), text_.data() + text_.size(), out);
    if (error != std::errc()) return false;
    text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
    return true;
  }
  bool take_star() {
    if (!text_.starts_with('*')) return false;
    text_.remove_prefix(1);
    return true;
  }

 private:
  std::string_view text_;
};

}  // namespace

std::string map_text(const GridMap& map) {
  const navigation::GridGeometry& g = map.geometry;
  SL_CHECK(map.occupancy.size() == g.cells());
  std::string out = std::to_string(g.width) + " " + std::to_string(g.height);
  for (const double x : {g.resolution_m, g.origin.x, g.origin.y, g.origin.theta})
    out.append(" ").append(number_text(x));
  out += '\n';
  for (std::size_t i = 0; i < map.occupancy.size();) {
    std::size_t end = i;
    while (end < map.occupancy.size() && map.occupancy[end] == map.occupancy[i]) ++end;
    out.append(std::to_string(end - i)).append("*").append(std::to_string(map.occupancy[i])).append(" ");
    i = end;
  }
  return out;
}

Result<GridMap> read_map_text(std::string_view text) {
  Numbers numbers(text);
  GridMap map;
  navigation::GridGeometry& g = map.geometry;
  if (!numbers.take(g.width) || !numbers.take(g.height) || !numbers.take(g.resolution_m) ||
      !numbers.take(g.origin.x) || !numbers.take(g.origin.y) || !numbers.take(g.origin.theta))
    return Error{"map_data does not begin with width, height, resolution and origin"};
  SL_TRY(navigation::check_geometry(g));
  // Room is taken as it is filled: 64 MiB at the most, those of max_cells.
  while (!numbers.ended()) {
    std::size_t count = 0;
    int percent = 0;
    if (!numbers.take(count) || !numbers.take_star() || !numbers.take(percent) || percent < -1 ||
        percent > 100)
      return Error{
          "map_data has a run that is not COUNT*PERCENT after cell " + std::to_string(map.occupancy.size()),
          "percent from -1 (unknown) to 100"};
    if (count == 0 || count > g.cells() - map.occupancy.size())
      return Error{"map_data has more than " + std::to_string(g.cells()) + " cells, or an empty run"};
    map.occupancy.insert(map.occupancy.end(), count, static_cast<std::int8_t>(percent));
  }
  if (map.occupancy.size() != g.cells())
    return Error{"map_data has " + std::to_string(map.occupancy.size()) + " cells",
                 std::to_string(g.cells())};
  return map;
}

Result<GridMap> map_of(const MapKeys& keys) {
  if (!keys.map_data.empty()) return read_map_text(keys.map_data);
  if (keys.map.empty()) return Error{"there is no map", "map: a YAML file of map_server"};
  return Error{"the map '" + keys.map.substr(0, 200) + "' was not read",
               "declare the controller in the scenario: one that comes later needs map_data"};
}

}  // namespace sandlot::controllers
