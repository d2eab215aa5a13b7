/// Map files that controllers name: read by the loader, carried in the setup; bad ones with their file and line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/test_folder.h"
#include "controllers/grid_map.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

constexpr const char* bot = R"(<?xml version="1.0"?>
<sdf version="1.9" xmlns:sandlot="urn:sandlot:sdf"><model name="bot">
  <link name="base"><inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia></inertial>
    <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>
  <sandlot:device name="eye" kind="laser_scanner" link="base"><beams>11</beams><max_range>3</max_range></sandlot:device>
  <sandlot:device name="truth" kind="ground_truth" link="base"/>
</model></sdf>)";

constexpr const char* yaml =
    "image: room.pgm\n"
    "resolution: 0.5\n"
    "origin: [-1, -2, 0]\n"
    "occupied_thresh: 0.65\n"
    "free_thresh: 0.196\n"
    "negate: 0\n";
/// Three columns, two rows: the upper one is free, the lower one occupied, unknown, free.
constexpr const char* pgm = "P2\n3 2\n255\n254 254 254\n0 205 254\n";

struct MapFiles : testing::Test {
  const test::TestFolder test_folder;
  Diagnostics diagnostics;

  void SetUp() override {
    fs::create_directories(test_folder.path / "maps");
    write("bot.sdf", bot);
    write("maps/room.yaml", yaml);
    write("maps/room.pgm", pgm);
  }
  std::string write(const std::string& name, const std::string& text) const {
    return test_folder.write(name, text);
  }
  Result<model::Setup> load_with(const std::string& keys) {
    const std::string file = write("s.yaml",
                                   "version: 1\nname: s\nrobots:\n"
                                   "  - name: a\n    model: bot.sdf\n    controllers:\n"
                                   "      - {name: where, kind: localise, " +
                                       keys + "}\n");
    return load(file, {}, diagnostics);
  }
  std::string refusal() {
    const auto setup = load_with("map: maps/room.yaml");
    return setup ? "" : setup.error().text();
  }
  /// What is said of the map with another line in its YAML file.
  std::string with_line(const std::string& from, const std::string& to) {
    std::string text = yaml;
    text.replace(text.find(from), from.size(), to);
    write("maps/room.yaml", text);
    return refusal();
  }
  std::string with_picture(const std::string& bytes) {
    write("maps/room.pgm", bytes);
    return refusal();
  }
  std::string path(const std::string& name) const { return (test_folder.path / name).string(); }
};

TEST_F(MapFiles, AreCarriedInTheSetupAndNoLongerNeeded) {
  auto setup = load_with("map: maps/room.yaml");
  ASSERT_TRUE(setup) << setup.error().text();
  const model::ControllerDecl& decl = setup->instances.back().controllers.get().front();
  const auto map = controllers::read_map_text(decl.config.find("map_data")->text());
  ASSERT_TRUE(map) << map.error().text();
  EXPECT_EQ(map->occupancy, (std::vector<std::int8_t>{100, -1, 0, 0, 0, 0}));
  EXPECT_EQ(map->geometry.resolution_m, 0.5);
  EXPECT_EQ(map->geometry.origin.y, -2);
  fs::remove_all(test_folder.path / "maps");
  auto made = Simulation::create(std::move(*setup), {}, diagnostics);
  ASSERT_TRUE(made) << made.error().text();
  const auto bytes = (*made)->snapshot();
  const auto again = Simulation::restore(bytes, {}, diagnostics);
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ((*again)->state_hash(), (*made)->state_hash());
}

TEST_F(MapFiles, MayBeGivenAsTextInTheScenario) {
  const auto setup = load_with("map_data: '3 2 1 0 0 0 6*0'");
  ASSERT_TRUE(setup) << setup.error().text();
  EXPECT_EQ(setup->instances.back().controllers.get().front().config.find("map_data")->text(),
            "3 2 1 0 0 0 6*0");
}

TEST_F(MapFiles, ThatAreMissingAreNamedWhereTheyWereNamed) {
  const auto missing = load_with("map: maps/rom.yaml");
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().text(), StartsWith(path("s.yaml") + ":7"));
  EXPECT_THAT(missing.error().text(), HasSubstr(path("maps/rom.yaml") + ": no such file; did you mean '" +
                                                path("maps/room.yaml") + "'?"));
  EXPECT_THAT(with_line("room.pgm", "rom.pgm"),
              StartsWith(path("maps/room.yaml") + ":1: " + path("maps/rom.pgm") + ": no such file"));
  EXPECT_THAT(with_line("room.pgm", "../maps"), StartsWith(path("maps/room.yaml") + ":1: "));
}

TEST_F(MapFiles, WithBadHeadersAreRefusedByLine) {
  const std::string file = path("maps/room.yaml");
  EXPECT_THAT(with_line("0.5", "0"), StartsWith(file + ":2: /resolution: '0' is not a number in ["));
  EXPECT_THAT(with_line("0.5", "-0.05"), StartsWith(file + ":2: /resolution"));
  EXPECT_THAT(with_line("0.5", "nan"), StartsWith(file + ":2: /resolution"));
  EXPECT_THAT(with_line("[-1, -2, 0]", "[-1, nan, 0]"), StartsWith(file + ":3: /origin/1: 'nan'"));
  EXPECT_THAT(with_line("[-1, -2, 0]", "[-1, -2]"), StartsWith(file + ":3: /origin"));
  EXPECT_THAT(with_line("0.196", "0.7"),
              StartsWith(file + ":5: /free_thresh: 0.7 is not below occupied_thresh, 0.65"));
  EXPECT_THAT(with_line("0.65", "1.5"), StartsWith(file + ":4: /occupied_thresh"));
  EXPECT_THAT(with_line("image: room.pgm\n", ""), StartsWith(file));
  EXPECT_THAT(refusal(), HasSubstr("/image: this key is missing"));
  write("maps/room.yaml", std::string("image: room.pgm\nresolution: \xff\xfe\n"));
  EXPECT_THAT(refusal(), StartsWith(file + ":2"));
  write("maps/room.yaml", std::string(100'000, '#'));
  EXPECT_THAT(refusal(), HasSubstr("room.yaml"));
}

TEST_F(MapFiles, WithBadPicturesAreRefusedByName) {
  const std::string file = path("maps/room.pgm");
  EXPECT_THAT(with_picture(""), StartsWith(file + ":"));
  EXPECT_THAT(with_picture("\x89PNG\r\n\x1a\n"), HasSubstr("this is not a PGM picture"));
  EXPECT_THAT(with_picture("P6\n3 2\n255\n"), HasSubstr("it begins with P5 or P2"));
  EXPECT_THAT(with_picture("P5\n3 2\n255\nabcd"), HasSubstr("cut off: 4 bytes of pixels, 3 x 2 need 6"));
  EXPECT_THAT(with_picture("P5\n100000 10000\n255\nabcd"), HasSubstr("is too large"));
  EXPECT_THAT(refusal(), StartsWith(file + ":"));
  EXPECT_THAT(with_picture("P5\n3 2\n70000\nabcdef"), HasSubstr("largest grey value"));
  EXPECT_THAT(with_picture("P2\n3 2\n255\n0 0 0 0 0 256\n"), HasSubstr("pixel 5 of 6"));
  // What a picture cannot know: that there is nowhere to be.
  EXPECT_EQ(with_picture("P2\n3 2\n255\n0 0 0 0 0 0\n"), "");
  const auto made = Simulation::create(*load_with("map: maps/room.yaml"), {}, diagnostics);
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().text(), StartsWith(path("s.yaml") + ":7"));
  EXPECT_THAT(made.error().text(), HasSubstr("the map has no free cell"));
}

}  // namespace
}  // namespace sandlot
