#include "navigation/maps/map_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sandlot::navigation {
namespace {

const std::string map_file_yaml =
    "# an office\n"
    "image: office.pgm\n"
    "resolution: 0.050000   # metres\n"
    "origin: [-10.5, 2, 1.5]\n"
    "negate: 0\n"
    "occupied_thresh: 0.65\n"
    "free_thresh: 0.196\n";

TEST(MapFile, HeaderOfMapServerIsRead) {
  Diagnostics notes;
  const auto header = parse_map_header(map_file_yaml, notes);
  ASSERT_TRUE(header) << header.error().text();
  EXPECT_EQ(header->image, "office.pgm");
  EXPECT_EQ(header->image_line, 2);
  EXPECT_EQ(header->resolution_m, 0.05);
  EXPECT_EQ(header->origin.x, -10.5);
  EXPECT_EQ(header->origin.theta, 1.5);
  EXPECT_EQ(header->mode, MapMode::trinary);
  EXPECT_TRUE(notes.warnings.empty());
  const auto windows = parse_map_header(
      "---\r\nimage: 'a # b.pgm'\r\nresolution: 1\r\norigin: [0,0,0]\r\nmode: scale\r\nowner: me\r\n", notes);
  ASSERT_TRUE(windows) << windows.error().text();
  EXPECT_EQ(windows->image, "a # b.pgm");
  EXPECT_EQ(windows->mode, MapMode::scale);
  ASSERT_EQ(notes.warnings.size(), 1u);
  EXPECT_EQ(notes.warnings[0].place.line, 6);
}

TEST(MapFile, BadHeadersAreRefusedWithLineAndKey) {
  const auto fault = [](std::string from, const std::string& to) {
    std::string text = map_file_yaml;
    text.replace(text.find(from), from.size(), to);
    Diagnostics notes;
    const auto header = parse_map_header(text, notes);
    return header ? "read" : header.error().text();
  };
  const auto holds = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(holds(fault("0.050000", "nan"), "map.yaml:3: /resolution"));
  EXPECT_TRUE(holds(fault("0.050000", "0"), "map.yaml:3: /resolution"));
  EXPECT_TRUE(holds(fault("[-10.5, 2, 1.5]", "[-10.5, 2]"), "map.yaml:4: /origin"));
  EXPECT_TRUE(holds(fault("[-10.5, 2, 1.5]", "[-10.5, inf, 1.5]"), "map.yaml:4: /origin/1"));
  EXPECT_TRUE(holds(fault("[-10.5, 2, 1.5]", ""), "map.yaml:4: /origin"));
  EXPECT_TRUE(holds(fault("negate: 0", "negate: maybe"), "map.yaml:5: /negate"));
  EXPECT_TRUE(
      holds(fault("negate: 0", "resolution: 1"), "map.yaml:5: /resolution: this key stands in line 3, too"));
  EXPECT_TRUE(holds(fault("negate: 0", "mode: fast"), "map.yaml:5: /mode"));
  EXPECT_TRUE(holds(fault("negate: 0", "some words"), "map.yaml:5: "));
  EXPECT_TRUE(holds(fault("image", "picture"), "/image: this key is missing"));
  EXPECT_TRUE(holds(fault("0.196", "0.7"), "map.yaml:7: /free_thresh"));
  Diagnostics notes;
  EXPECT_FALSE(parse_map_header("", notes));
  EXPECT_FALSE(parse_map_header(std::string(100, '\0'), notes));
}

/// Three columns, two rows; the picture's upper row is the map's second one.
GridMap map_file_decoded(const MapHeader& header, const std::string& pgm) {
  auto map = decode_map(header, pgm);
  EXPECT_TRUE(map) << map.error().text();
  return map ? *map : GridMap{};
}
using Cells = std::vector<std::int8_t>;

TEST(MapFile, PixelsMeanWhatMapServerSays) {
  const std::string plain = "P2\n# by hand\n3 2\n255\n0 254 205\n89 90 255\n";
  // p = 1 - pixel / 255: 1, 0.004, 0.196; 0.651, 0.647, 0. Just over free_thresh (0.196078): unknown.
  EXPECT_EQ(map_file_decoded({}, plain).occupancy, (Cells{100, -1, 0, 100, 0, -1}));
  // Negated p = pixel / 255: 0, 0.996, 0.804; 0.349, 0.353, 1.
  EXPECT_EQ(map_file_decoded({.negate = true}, plain).occupancy, (Cells{-1, -1, 100, 0, 100, 100}));
  // Scale from 0.196 to 0.65: (0.196078 - 0.196) / 0.454 = 0, (0.647059 - 0.196) / 0.454 = 0.9935.
  EXPECT_EQ(map_file_decoded({.mode = MapMode::scale}, plain).occupancy, (Cells{100, 99, 0, 100, 0, 0}));
  EXPECT_EQ(map_file_decoded({.mode = MapMode::raw}, plain).occupancy, (Cells{89, 90, -1, 0, -1, -1}));
  // The same picture as bytes, and with 16 bits.
  const std::string bytes = std::string("P5 3 2 255\n") + std::string("\0\xfe\xcd\x59\x5a\xff", 6);
  EXPECT_EQ(map_file_decoded({}, bytes).occupancy, map_file_decoded({}, plain).occupancy);
  const std::string wide = std::string("P5\n3 1\n65535\n") + std::string("\x00\x00\xff\xff\xcd\xcd", 6);
  EXPECT_EQ(map_file_decoded({}, wide).occupancy, (Cells{100, 0, -1}));
  const GridMap placed = map_file_decoded({.resolution_m = 0.2, .origin = {1, 2, 3}}, bytes);
  EXPECT_EQ(placed.geometry.origin.theta, 3);
  EXPECT_EQ(placed.geometry.resolution_m, 0.2);
}

TEST(MapFile, BadPicturesAreRefusedByName) {
  const auto fault = [](const std::string& pgm) {
    const auto map = decode_map({}, pgm);
    return map ? "read" : map.error().text();
  };
  const auto holds = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(holds(fault(""), "not a PGM"));
  EXPECT_TRUE(holds(fault("\x89PNG"), "not a PGM"));
  EXPECT_TRUE(holds(fault("P5"), "cut off before its width"));
  EXPECT_TRUE(holds(fault("P5\n3 2"), "cut off before its largest grey value"));
  EXPECT_TRUE(holds(fault("P5\n3 2\n255\nabcd"), "cut off: 4 bytes of pixels, 3 x 2 need 6 (byte 11 of 15)"));
  EXPECT_TRUE(holds(fault("P5\n100000 10000\n255\n"), "1e+09 cells is too large"))
      << fault("P5\n100000 10000\n255\n");
  EXPECT_TRUE(holds(fault("P5\n30000 30000\n255\n"), "too large"));
  EXPECT_TRUE(holds(fault("P5\n99999999999999999999 1\n255\n"), "width"));
  EXPECT_TRUE(holds(fault("P5\n8000 8000\n255\nabc"), "cut off")) << "refused before memory is taken";
  EXPECT_TRUE(holds(fault("P5\n-3 2\n255\n"), "no number where the width"));
  EXPECT_TRUE(holds(fault("P5\n0 2\n255\n"), "at least one"));
  EXPECT_TRUE(holds(fault("P5\n1 1\n0\na"), "largest grey value is 0"));
  EXPECT_TRUE(holds(fault("P5\n1 1\n70000\naa"), "largest grey value"));
  EXPECT_TRUE(holds(fault("P5\n1 1\n100\n\xff"), "pixel 0 is 255"));
  EXPECT_TRUE(holds(fault("P2\n3 2\n255\n0 1 2 3 4    "), "pixel 5 of 6"));
  EXPECT_TRUE(holds(fault("P2\n3 1\n255\n0 x 2"), "pixel 1 of 3"));
  EXPECT_TRUE(holds(fault("P2\n3 1\n255\n0 256 2"), "pixel 1 of 3"));
  EXPECT_FALSE(decode_map({.free_threshold = std::nan("")}, "P5 1 1 255 a"));
}

TEST(MapFile, EveryCutOfAFileIsAnsweredWithAnError) {
  const std::string plain = "P2\n# by hand\n3 2\n255\n0 254 205\n89 90 255", yaml = map_file_yaml;
  // Cut within the last number, it is another number: 2 or 25 in place of 255.
  for (std::size_t n = 0; n < plain.size() - 2; ++n) EXPECT_FALSE(decode_map({}, plain.substr(0, n))) << n;
  Diagnostics notes;
  for (std::size_t n = 0; n < yaml.find("negate") - 2; ++n)
    EXPECT_FALSE(parse_map_header(yaml.substr(0, n), notes)) << n;
}

TEST(MapFile, MapsComeBackFromTheirFiles) {
  Stream random(5, entity_key("map files"), Purpose::experiment, 0);
  GridMap map{{17, 9, 0.05, {-3.25, 1.0 / 3, 0.7}}, {}};
  for (std::size_t i = 0; i < map.geometry.cells(); ++i)
    map.occupancy.push_back(static_cast<std::int8_t>(static_cast<int>(random.below(102)) - 1));
  for (const MapMode mode : {MapMode::raw, MapMode::scale, MapMode::trinary}) {
    GridMap expected = map;
    for (auto& o : expected.occupancy) {
      if (mode == MapMode::scale) o = std::max<std::int8_t>(o, 0);
      if (mode == MapMode::trinary) o = o >= 65 ? 100 : o >= 0 && o <= 19 ? 0 : -1;
    }
    if (mode == MapMode::scale) { EXPECT_FALSE(encode_map(map, mode, "a.pgm")) << "unknown cells"; }
    const auto files = encode_map(mode == MapMode::scale ? expected : map, mode, "my map.pgm");
    ASSERT_TRUE(files) << files.error().text();
    Diagnostics notes;
    const auto header = parse_map_header(files->yaml, notes);
    ASSERT_TRUE(header) << header.error().text();
    EXPECT_EQ(header->image, "my map.pgm");
    const GridMap back = map_file_decoded(*header, files->pgm);
    EXPECT_EQ(back.occupancy, expected.occupancy) << name_of(mode);
    EXPECT_EQ(back.geometry.origin.y, 1.0 / 3);
    EXPECT_EQ(back.geometry.origin.theta, 0.7);
  }
  EXPECT_FALSE(encode_map(map, MapMode::raw, "a\nb"));
  map.occupancy.pop_back();
  EXPECT_FALSE(encode_map(map, MapMode::raw, "a.pgm"));
}

}  // namespace
}  // namespace sandlot::navigation
