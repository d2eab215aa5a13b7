/// Any text and any bytes, apart by the first zero byte: a map of the size that the picture says, or one error with its file; a map comes
/// back from the files that are written of it, and from the text that scenarios carry. That text, which a request may bring, is read, too.
#include <algorithm>

#include "base/check.h"
#include "controllers/grid_map.h"
#include "navigation/maps/map_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace sandlot;
  using namespace sandlot::navigation;
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  if (const auto map = controllers::read_map_text(all)) {
    const auto again = controllers::read_map_text(controllers::map_text(*map));
    SL_CHECK(again && again->occupancy == map->occupancy &&
             again->geometry.origin.x == map->geometry.origin.x);
  } else {
    SL_CHECK(!map.error().what.empty());
  }
  const std::size_t end = std::min(all.find('\0'), size);
  Diagnostics notes;
  const auto header = parse_map_header(all.substr(0, end), notes);
  if (!header) {
    SL_CHECK(!header.error().what.empty());
    return 0;
  }
  const auto map = decode_map(*header, all.substr(std::min(size, end + 1)));
  if (!map) {
    SL_CHECK(!map.error().what.empty());
    return 0;
  }
  for (const auto percent : map->occupancy) SL_CHECK(percent >= -1 && percent <= 100);
  const auto files = encode_map(*map, MapMode::raw, "map.pgm");
  if (!files) return 0;
  const auto again = parse_map_header(files->yaml, notes);
  SL_CHECK(again);
  const auto same = decode_map(*again, files->pgm);
  SL_CHECK(same && same->occupancy == map->occupancy);
  const auto text = controllers::read_map_text(controllers::map_text(*map));
  SL_CHECK(text && text->occupancy == map->occupancy &&
           text->geometry.resolution_m == map->geometry.resolution_m);
  return 0;
}
