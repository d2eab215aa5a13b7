#pragma once
/// Map files of ROS: a PGM picture and a YAML file that gives its place and meaning.
///
///   image: office.pgm          resolution: 0.05        origin: [-10.0, -10.0, 0.0]    (x, y, yaw)
///   occupied_thresh: 0.65      free_thresh: 0.196      negate: 0       mode: trinary | scale | raw
///
///   p = 1 - pixel / maxval (negate: pixel / maxval)
///   trinary, scale   p >= occupied_thresh: 100;  p <= free_thresh: 0
///   between them     trinary: unknown;  scale: round(100 (p - free) / (occupied - free))
///   raw              round(255 pixel / maxval) as percent; unknown over 100
///
/// The picture's upper row is the map's last one. Text and bytes come in and go out: the caller reads and
/// writes the files.
///
/// Errors   with line and key in the YAML text, with the byte or pixel in the picture: bad numbers, missing or
///          repeated keys, cut-off pictures, maps over max_cells (refused before memory is taken).
/// Limits   of YAML only what map_server writes: one `key: value` a line, comments, quotes, a flat list.
///          Grey PGM only (P2, P5; up to 16 bits), no PNG.
/// Source   Nav2 1.1 (Humble), nav2_map_server/src/map_io.cpp; Netpbm, pgm(5).
#include <span>
#include <string>
#include <string_view>

#include "navigation/maps/occupancy.h"

namespace sandlot::navigation {

enum class MapMode : std::uint8_t { trinary, scale, raw };
std::span<const EnumName<MapMode>> enum_names(MapMode);

struct MapHeader {
  std::string image;   ///< as written: relative to the folder of the YAML file, or absolute
  int image_line = 0;  ///< where that stands
  double resolution_m = 0.05;
  Pose2 origin;
  bool negate = false;
  double occupied_threshold = 0.65, free_threshold = 0.196;
  MapMode mode = MapMode::trinary;
};

/// @param file   name of the text, for errors
/// @param notes  receives a warning for each key that map_server does not know
Result<MapHeader> parse_map_header(std::string_view text, Diagnostics& notes,
                                   const std::string& file = "map.yaml");

/// @param bytes  of a PGM picture
/// @param file   name of the picture, for errors
Result<GridMap> decode_map(const MapHeader& header, std::string_view bytes,
                           const std::string& file = "map.pgm");

struct MapFiles {
  std::string yaml, pgm;
};
/// Both files of a map. Trinary keeps free (0 to 19), occupied (65 to 100) and unknown apart, scale and raw keep
/// every percent. Errors: a map that decode_map() would refuse, an image name with a line break, and unknown
/// cells with scale, which has no pixel for them.
Result<MapFiles> encode_map(const GridMap& map, MapMode mode, const std::string& image);

}  // namespace sandlot::navigation
