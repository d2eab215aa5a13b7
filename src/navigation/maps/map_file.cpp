#include "navigation/maps/map_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/line_comment.h"

namespace sandlot::navigation {
namespace {

constexpr std::array<EnumName<MapMode>, 3> map_modes{
    {{"trinary", MapMode::trinary}, {"scale", MapMode::scale}, {"raw", MapMode::raw}}};

Error map_file_error(const std::string& file, int line, const std::string& path, std::string what,
                     std::string fix) {
  Error error{std::move(what), std::move(fix), {}, path};
  error.place.file = std::make_shared<const std::string>(file);
  error.place.line = line;
  return error;
}

std::string_view map_file_unquoted(std::string_view value) {
  if (value.size() >= 2 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front())
    return value.substr(1, value.size() - 2);
  return value;
}

/// Reads the one key of a line.
Status map_file_value(MapHeader& out, std::string_view key, std::string_view value, std::string& broken) {
  const auto number = [&](double& x, double low, double high) -> Status {
    double read = 0;
    if (!parse_number(value, read) || !(read >= low && read <= high))
      return Error{"'" + std::string(value) + "' is not a number in [" + number_text(low) + ", " +
                       number_text(high) + "]",
                   ""};
    x = read;
    return {};
  };
  broken = "/" + std::string(key);
  if (key == "image") {
    out.image = std::string(map_file_unquoted(value));
    if (out.image.empty()) return Error{"there is no name", "the path of a PGM picture"};
    return {};
  }
  if (key == "resolution") return number(out.resolution_m, 1e-4, 1e4);
  if (key == "occupied_thresh") return number(out.occupied_threshold, 0, 1);
  if (key == "free_thresh") return number(out.free_threshold, 0, 1);
  if (key == "negate") {
    value = map_file_unquoted(value);
    if (!is_one_of(value, {"0", "1", "true", "false"}))
      return Error{"'" + std::string(value) + "' is neither 0 nor 1", ""};
    out.negate = value == "1" || value == "true";
    return {};
  }
  if (key == "mode") {
    for (const auto& mode : map_modes)
      if (map_file_unquoted(value) == mode.name) {
        out.mode = mode.value;
        return {};
      }
    return Error{"'" + std::string(value) + "' is not a mode", "trinary, scale or raw"};
  }
  // origin: [x, y, yaw]
  const std::string fix = "write [x, y, yaw] in metres and radians";
  if (value.size() < 2 || value.front() != '[' || value.back() != ']')
    return Error{"'" + std::string(value) + "' is not a list", fix};
  const auto parts = split(value.substr(1, value.size() - 2), ',');
  double p[3] = {};
  if (parts.size() != 3) return Error{"the list has " + std::to_string(parts.size()) + " numbers", fix};
  for (std::size_t i = 0; i < 3; ++i)
    if (!parse_number(parts[i], p[i]) || !(std::abs(p[i]) <= (i < 2 ? 1e9 : 1e3))) {
      broken += "/" + std::to_string(i);
      return Error{"'" + std::string(trim(parts[i])) + "' is not a number in range", fix};
    }
  out.origin = {p[0], p[1], p[2]};
  return {};
}

/// Reader of a PGM's header and of the numbers of a P2.
class MapPicture {
 public:
  MapPicture(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  Error error(std::string what, std::string fix) const {
    return map_file_error(
        file_, 0, "",
        std::move(what) + " (byte " + std::to_string(at_) + " of " + std::to_string(bytes_.size()) + ")",
        std::move(fix));
  }
  Status magic(bool& plain) {
    if (bytes_.size() < 2 || bytes_[0] != 'P' || (bytes_[1] != '2' && bytes_[1] != '5'))
      return error("this is not a PGM picture", "it begins with P5 or P2");
    plain = bytes_[1] == '2';
    at_ = 2;
    return {};
  }
  /// A whole number after blanks and comments.
  Status number(const char* name, int high, int& out) {
    while (at_ < bytes_.size() && (blank(bytes_[at_]) || bytes_[at_] == '#')) {
      if (bytes_[at_] != '#') {
        ++at_;
        continue;
      }
      while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
    }
    if (at_ >= bytes_.size()) return error(std::string("the picture is cut off before its ") + name, "");
    const std::size_t begin = at_;
    std::int64_t value = 0;
    for (; at_ < bytes_.size() && bytes_[at_] >= '0' && bytes_[at_] <= '9'; ++at_)
      value = std::min<std::int64_t>(value * 10 + (bytes_[at_] - '0'), 1'000'000'000'000);
    if (at_ == begin) return error(std::string("there is no number where the ") + name + " should be", "");
    if (value > high)
      return error(std::string("the ") + name + " is " + std::to_string(value),
                   "at most " + std::to_string(high));
    out = static_cast<int>(value);
    return {};
  }
  /// The single blank between the header and the bytes of a P5.
  Status separator() {
    if (at_ >= bytes_.size() || !blank(bytes_[at_])) return error("the header does not end with a blank", "");
    ++at_;
    return {};
  }
  std::string_view rest() const { return bytes_.substr(at_); }

 private:
  static bool blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  std::string_view bytes_;
  const std::string& file_;
  std::size_t at_ = 0;
};

std::int8_t map_file_cell(const MapHeader& header, int pixel, int maxval) {
  const double shade = static_cast<double>(pixel) / maxval, p = header.negate ? shade : 1 - shade;
  if (header.mode == MapMode::raw) {
    const double percent = std::floor(shade * 255 + 0.5);
    return percent <= 100 ? static_cast<std::int8_t>(percent) : GridMap::unknown;
  }
  if (p >= header.occupied_threshold) return 100;
  if (p <= header.free_threshold) return 0;
  if (header.mode == MapMode::trinary) return GridMap::unknown;
  const double part = (p - header.free_threshold) / (header.occupied_threshold - header.free_threshold);
  return static_cast<std::int8_t>(std::floor(part * 100 + 0.5));
}

}  // namespace

std::span<const EnumName<MapMode>> enum_names(MapMode) { return map_modes; }

Result<MapHeader> parse_map_header(std::string_view text, Diagnostics& notes, const std::string& file) {
  static const std::vector<std::string> keys{"image",           "resolution",  "origin", "negate",
                                             "occupied_thresh", "free_thresh", "mode"};
  constexpr std::size_t required = 3;
  MapHeader out;
  std::vector<int> lines(keys.size());  // 0: not seen
  int number = 0;
  for (std::string_view line : split(text, '\n')) {
    ++number;
    line = trim(without_comment(line));
    if (line.empty() || line == "---") continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos)
      return map_file_error(file, number, "", "'" + std::string(line.substr(0, 60)) + "' has no key",
                            "write `key: value`, the list of `origin` in one line");
    const std::string_view key = map_file_unquoted(trim(line.substr(0, colon))),
                           value = trim(line.substr(colon + 1));
    const auto found = std::find(keys.begin(), keys.end(), key);
    if (found == keys.end()) {
      notes.warn(map_file_error(file, number, "/" + std::string(key), "map_server does not know this key",
                                suggestion(key, keys)));
      continue;
    }
    const auto which = static_cast<std::size_t>(found - keys.begin());
    if (lines[which] > 0)
      return map_file_error(file, number, "/" + *found,
                            "this key stands in line " + std::to_string(lines[which]) + ", too", "");
    lines[which] = number;
    std::string path;
    if (Status status = map_file_value(out, key, value, path); !status)
      return map_file_error(file, number, path, status.error().what, status.error().fix);
  }
  for (std::size_t i = 0; i < required; ++i)
    if (lines[i] == 0) return map_file_error(file, 0, "/" + keys[i], "this key is missing", "");
  out.image_line = lines[0];
  if (out.mode != MapMode::raw && !(out.free_threshold < out.occupied_threshold))
    return map_file_error(file, std::max(lines[4], lines[5]), "/free_thresh",
                          number_text(out.free_threshold) + " is not below occupied_thresh, " +
                              number_text(out.occupied_threshold),
                          "usually 0.196 and 0.65");
  return out;
}

Result<GridMap> decode_map(const MapHeader& header, std::string_view bytes, const std::string& file) {
  const auto share = [](double x) { return x >= 0 && x <= 1; };
  if (!share(header.free_threshold) || !share(header.occupied_threshold))
    return Error{"a threshold of the map's header lies outside [0, 1]", ""};
  MapPicture picture(bytes, file);
  bool plain = false;
  int maxval = 0;
  GridMap map;
  map.geometry.resolution_m = header.resolution_m;
  map.geometry.origin = header.origin;
  SL_TRY(picture.magic(plain));
  constexpr int any = 1'000'000'000;
  SL_TRY(picture.number("width", any, map.geometry.width));
  SL_TRY(picture.number("height", any, map.geometry.height));
  if (Status status = check_geometry(map.geometry); !status)
    return map_file_error(file, 0, "", status.error().what, status.error().fix);
  SL_TRY(picture.number("largest grey value", 65'535, maxval));
  if (maxval < 1) return picture.error("the largest grey value is 0", "usually 255");
  const std::size_t cells = map.geometry.cells();
  if (!plain) SL_TRY(picture.separator());
  const std::size_t size = maxval > 255 ? 2 : 1;
  // A pixel of a P2 takes a digit and, but for the last one, a blank.
  const std::size_t least = plain ? 2 * cells - 1 : size * cells;
  if (picture.rest().size() < least)
    return picture.error("the picture is cut off: " + std::to_string(picture.rest().size()) +
                             " bytes of pixels, " + std::to_string(map.geometry.width) + " x " +
                             std::to_string(map.geometry.height) + " need " + std::to_string(least),
                         "copy the whole file");
  std::vector<std::int8_t> value(static_cast<std::size_t>(maxval) + 1);
  for (int pixel = 0; pixel <= maxval; ++pixel)
    value[static_cast<std::size_t>(pixel)] = map_file_cell(header, pixel, maxval);
  map.occupancy.resize(cells);
  const std::string_view data = picture.rest();
  std::size_t k = 0;
  for (int row = map.geometry.height - 1; row >= 0; --row)
    for (int x = 0; x < map.geometry.width; ++x, ++k) {
      int pixel = 0;
      if (plain) {
        if (Status status = picture.number("pixels", maxval, pixel); !status) {
          status.error().what = "pixel " + std::to_string(k) + " of " + std::to_string(cells) + ": " +
                                status.error().what;
          return std::move(status).error();
        }
      } else {
        pixel = static_cast<std::uint8_t>(data[k * size]);
        if (size == 2) pixel = pixel * 256 + static_cast<std::uint8_t>(data[k * size + 1]);
        if (pixel > maxval)
          return picture.error("pixel " + std::to_string(k) + " is " + std::to_string(pixel),
                               "at most " + std::to_string(maxval));
      }
      map.occupancy[map.geometry.index({x, row})] = value[static_cast<std::size_t>(pixel)];
    }
  return map;
}

Result<MapFiles> encode_map(const GridMap& map, MapMode mode, const std::string& image) {
  SL_TRY(check_geometry(map.geometry));
  const GridGeometry& g = map.geometry;
  if (map.occupancy.size() != g.cells())
    return Error{"the map has " + std::to_string(map.occupancy.size()) + " cells of data",
                 "its size says " + std::to_string(g.cells())};
  if (image.empty() || image.find_first_of("\n\r\"") != std::string::npos)
    return Error{"the name of the picture is empty, or has a quote or line break in it", ""};
  const char* occupied = mode == MapMode::scale ? "1" : "0.65";
  const char* free = mode == MapMode::scale ? "0" : "0.196";
  MapFiles out;
  out.yaml = "image: \"" + image + "\"\nmode: " + name_of(mode) +
             "\nresolution: " + number_text(g.resolution_m) + "\norigin: [" + number_text(g.origin.x) + ", " +
             number_text(g.origin.y) + ", " + number_text(g.origin.theta) +
             "]\nnegate: 0\noccupied_thresh: " + occupied + "\nfree_thresh: " + free + "\n";
  out.pgm = "P5\n" + std::to_string(g.width) + " " + std::to_string(g.height) + "\n255\n";
  out.pgm.reserve(out.pgm.size() + g.cells());
  for (int row = g.height - 1; row >= 0; --row)
    for (int x = 0; x < g.width; ++x) {
      const int percent = map.occupancy[g.index({x, row})];
      const bool known = percent >= 0 && percent <= 100;
      int pixel = 0;
      if (mode == MapMode::raw) {
        pixel = known ? percent : 255;
      } else if (mode == MapMode::scale) {
        if (!known)
          return Error{"cell (" + std::to_string(x) + ", " + std::to_string(row) + ") is unknown",
                       "mode scale has no pixel for it: write trinary or raw"};
        pixel = (255 * (100 - percent) + 50) / 100;
      } else {
        // Grey values of map_saver.
        pixel = !known ? 205 : percent >= 65 ? 0 : percent <= 19 ? 254 : 205;
      }
      out.pgm.push_back(static_cast<char>(pixel));
    }
  return out;
}

}  // namespace sandlot::navigation
