/// Files that name other files: models, worlds, meshes; merged, moved, missing.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "assets/image/write.h"
#include "base/math.h"
#include "formats/sdf/sdf.h"
#include "geometry/bounds.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"

namespace sandlot::formats {
namespace {

class SdfFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::TempDir() + "sandlot_" +
              testing::UnitTest::GetInstance()->current_test_info()->name() + "/";
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    options_.path = {};
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories(std::filesystem::path(folder_ + name).parent_path());
    std::ofstream(folder_ + name) << text;
  }
  /// A file with one model.
  void write_model(const std::string& name, const std::string& attributes, const std::string& content) {
    write(name, "<sdf version='1.9'><model " + attributes + ">\n" + content + "</model></sdf>");
  }
  bool read(const std::string& text) {
    Diagnostics diagnostics;
    auto result = parse_sdf("<sdf version='1.9'>" + text + "</sdf>", folder_ + "w.sdf", diagnostics,
                            options_);
    warnings_.clear();
    for (const Error& warning : diagnostics.warnings) warnings_.push_back(warning.text());
    error_ = result ? "" : result.error().text();
    if (result) content_ = std::move(*result);
    return error_.empty();
  }
  const model::Model& model() const { return *content_.instances.at(0).model; }

  std::string folder_, error_;
  SdfOptions options_;
  WorldContent content_;
  std::vector<std::string> warnings_;
};

const std::string body =
    "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";
std::string link(const std::string& name, const std::string& content = "") {
  return "<link name='" + name + "'>" + body + content + "</link>";
}
const std::string quarter = "1.5707963267948966";

void expect_pose(const Pose& X, Vec3 p, double yaw) {
  EXPECT_NEAR(norm(X.p - p), 0, 1e-12) << X.p.x << " " << X.p.y << " " << X.p.z;
  EXPECT_NEAR(yaw_of(X.q), yaw, 1e-12);
}

TEST_F(SdfFiles, MergeTakesLinksJointsFramesAndPlugins) {
  write_model("arm.sdf", "name='arm'",
              "<pose>9 9 9 0 0 0</pose><static>true</static>" + link("upper", "<pose>1 0 0 0 0 0</pose>") +
                  link("lower", "<pose relative_to='upper'>1 0 0 0 0 0</pose>") +
                  "<frame name='tip'><pose>3 0 0 0 0 0</pose></frame>"
                  "<joint name='elbow' type='revolute'><parent>upper</parent><child>lower</child>"
                  "<axis><xyz expressed_in='__model__'>0 1 0</xyz></axis></joint>"
                  "<joint name='foot' type='fixed'><parent>world</parent><child>__model__</child></joint>"
                  "<plugin name='p' filename='f'/><model name='n'><pose>0 0 1 0 0 0</pose>" +
                  link("l") + "</model>");
  ASSERT_TRUE(read("<model name='m'>" + link("base") +
                   "<include merge='true'><uri>arm.sdf</uri><pose>10 0 0 0 0 " + quarter +
                   "</pose></include></model>"))
      << error_;
  const model::Model& m = model();
  EXPECT_FALSE(m.is_static) << "static is the including model's own";
  ASSERT_EQ(m.links.size(), 4u);
  EXPECT_EQ(m.links[1].name, "upper");
  expect_pose(m.links[1].X_ML, {10, 1, 0}, math::pi / 2);
  expect_pose(m.links[2].X_ML, {10, 2, 0}, math::pi / 2);
  EXPECT_EQ(m.links[3].name, "n::l");
  expect_pose(m.links[3].X_ML, {10, 0, 1}, math::pi / 2);
  // The arm's own y, not the including model's.
  EXPECT_NEAR(m.joints.at(0).axis_J.y, 1, 1e-12);
  EXPECT_EQ(m.joints.at(1).child, 1u) << "__model__ is the included model, which stands for its first link";
  ASSERT_EQ(m.frames.size(), 2u);
  EXPECT_EQ(m.frames[0].name, "_merged__arm__model__");
  EXPECT_EQ(m.frames[1].link, 1u);
  expect_pose(m.frames[1].X_LF, {2, 0, 0}, 0);
  EXPECT_EQ(m.devices.size(), 1u);
}

TEST_F(SdfFiles, PlacementFramesSayWhatThePoseIsOf) {
  // The grip is 2 m ahead of the model and looks left. Put at (5, 0, 1) unturned, the model lies 2 m to the left of
  // that and looks right.
  write_model("tool.sdf", "name='tool'",
              link("l") + "<frame name='grip'><pose>2 0 0 0 0 " + quarter + "</pose></frame>");
  const std::string include =
      "<uri>tool.sdf</uri><placement_frame>grip</placement_frame>"
      "<pose relative_to='f'>0 0 1 0 0 0</pose></include>";
  const std::string frame = "<frame name='f'><pose>5 0 0 0 0 0</pose></frame>";
  ASSERT_TRUE(read("<world name='w'>" + frame + "<include>" + include + "</world>")) << error_;
  expect_pose(content_.instances.at(0).X_WM, {5, 2, 1}, -math::pi / 2);
  ASSERT_TRUE(
      read("<model name='m'>" + link("base") + frame + "<include merge='true'>" + include + "</model>"))
      << error_;
  expect_pose(model().links.at(1).X_ML, {5, 2, 1}, -math::pi / 2);
  ASSERT_TRUE(
      read("<model name='m'>" + link("base") + frame + "<include><name>t</name>" + include + "</model>"))
      << error_;
  EXPECT_EQ(model().links.at(1).name, "t::l");
  expect_pose(model().links.at(1).X_ML, {5, 2, 1}, -math::pi / 2);
}

TEST_F(SdfFiles, NestedStaticModelsAreFixedToTheWorld) {
  write_model("post.sdf", "name='post'", link("l"));
  ASSERT_TRUE(read("<model name='m'>" + link("base") +
                   "<include><uri>post.sdf</uri><static>true</static></include></model>"))
      << error_;
  ASSERT_EQ(model().joints.size(), 1u);
  EXPECT_EQ(model().joints[0].parent, model::world_link);
  EXPECT_EQ(model().joints[0].child, 1u);
}

TEST_F(SdfFiles, WorldsLightsAndActorsMayBeIncluded) {
  write_model("box.sdf", "name='box'", link("l"));
  write("inner/yard.sdf",
        "<sdf version='1.9'><world name='yard'><gravity>0 0 -1</gravity>"
        "<include><uri>../box.sdf</uri><pose>1 0 0 0 0 0</pose></include>"
        "<light name='sun' type='directional'/></world></sdf>");
  write("lamp.sdf", "<sdf version='1.9'><light name='lamp' type='point'/></sdf>");
  write("ann.sdf", "<sdf version='1.9'><actor name='ann'/></sdf>");
  ASSERT_TRUE(
      read("<world name='w'><include><uri>inner/yard.sdf</uri></include>"
           "<include><uri>lamp.sdf</uri><name>l2</name><pose>0 0 4 0 0 0</pose></include>"
           "<include><uri>ann.sdf</uri><pose>0 3 0 0 0 0</pose></include></world>"))
      << error_;
  EXPECT_EQ(content_.gravity.z, -9.81) << "the world's own";
  ASSERT_EQ(content_.instances.size(), 2u);
  EXPECT_EQ(content_.instances[0].X_WM.p.x, 1);
  EXPECT_EQ(content_.instances[1].motion->keys.at(0).X_WM.p.y, 3);
  ASSERT_EQ(content_.lights.size(), 2u);
  EXPECT_EQ(content_.lights[1].name, "l2");
  EXPECT_EQ(content_.lights[1].X_PLight.p.z, 4);
}

TEST_F(SdfFiles, FoldersWithOrWithoutConfig) {
  write_model("a/model.sdf", "name='a'", link("l"));
  write("b/model.config", "<model><sdf version='1.10'>new.sdf</sdf><sdf version='1.7'>old.sdf</sdf></model>");
  write_model("b/old.sdf", "name='b'", link("l"));
  ASSERT_TRUE(read("<world name='w'><include><uri>a</uri></include><include><uri>b</uri></include></world>"))
      << error_;
  EXPECT_EQ(content_.instances.at(1).name, "b");
}

TEST_F(SdfFiles, WhatIsMissingStopsOrIsLeftOut) {
  const std::string text =
      "<world name='w'><include><uri>model://gone</uri></include>\n<model name='m'>" +
      link("l",
           "<visual name='v'><geometry><mesh><uri>gone.dae</uri></mesh></geometry></visual>"
           "<visual name='u'><geometry><sphere/></geometry><material><pbr><metal>"
           "<albedo_map>gone.png</albedo_map></metal></pbr></material></visual>") +
      "</model><include><uri>https://fuel.gazebosim.org/1.0/Open/models/Far</uri></include><model "
      "name='shelf'><include><uri>gone2</uri></include></model></world>";
  EXPECT_FALSE(read(text));
  EXPECT_NE(error_.find("w.sdf:1: 'model://gone' is not there"), std::string::npos) << error_;
  options_.skip_missing = true;
  ASSERT_TRUE(read(text)) << error_;
  ASSERT_EQ(content_.instances.size(), 1u);
  ASSERT_EQ(model().links[0].visuals.size(), 1u);
  EXPECT_EQ(model().links[0].visuals[0].material.texture, folder_ + "gone.png") << "seen as a checker";
  int missing = 0;
  for (const std::string& warning : warnings_)
    if (warning.find("gone") != std::string::npos || warning.find("Far") != std::string::npos) ++missing;
  EXPECT_EQ(missing, 5);
}

TEST_F(SdfFiles, AMissingTextureIsOneWarningAndNoError) {
  const auto ball = [](const std::string& name, const std::string& map) {
    return "<visual name='" + name + "'><geometry><sphere/></geometry><material><pbr><metal>\n<albedo_map>" +
           map + "</albedo_map></metal></pbr></material></visual>";
  };
  ASSERT_TRUE(
      read("<model name='m'>" +
           link("l", ball("a", "gone.png") + ball("b", "gone.png") + ball("c", "model://far/it's gone.png") +
                         ball("d", "https://fuel.gazebosim.org/1.0/O/models/Far")) +
           "</model>"))
      << error_;
  const auto& visuals = model().links[0].visuals;
  EXPECT_EQ(visuals[0].material.texture, folder_ + "gone.png");
  EXPECT_EQ(visuals[1].material.texture, folder_ + "gone.png");
  EXPECT_EQ(visuals[2].material.texture, "model://far/it's gone.png");
  std::vector<std::string> said;
  for (const std::string& warning : warnings_)
    if (warning.find("the texture") != std::string::npos) said.push_back(warning);
  ASSERT_EQ(said.size(), 3u);
  EXPECT_NE(said[0].find("w.sdf:2: the texture '" + folder_ +
                         "gone.png' is not there; a checker is shown in its place: looked for "),
            std::string::npos)
      << said[0];
  EXPECT_NE(said[1].find("w.sdf:4: the texture 'model://far/it's gone.png' is not there; "),
            std::string::npos)
      << said[1];
  EXPECT_NE(said[2].find("would have to be downloaded; a checker is shown in its place: fetch it from "),
            std::string::npos)
      << said[2];
}

/// Two tetrahedra apart from each other, named hand, and a third one named thumb.
std::string tetrahedra() {
  std::string text;
  for (int k = 0; k < 3; ++k) {
    if (k != 1) text += k == 0 ? "o hand\n" : "o thumb\n";
    for (const char* const corner : {" 0 0\n", " 0 1\n", " 1 0\n"})
      text += "v " + std::to_string(3 * k) + corner;
    text += "v " + std::to_string(3 * k + 1) + " 0 0\n";
    const auto face = [&](int a, int b, int c) {
      text += "f " + std::to_string(4 * k + a) + " " + std::to_string(4 * k + b) + " " +
              std::to_string(4 * k + c) + "\n";
    };
    face(1, 2, 3), face(1, 4, 2), face(1, 3, 4), face(2, 4, 3);
  }
  return text;
}

TEST_F(SdfFiles, MeshesAndHeightmapsAreReadFromBesideTheFile) {
  write("part/arm.obj", tetrahedra());
  const std::uint8_t grey[] = {0, 0, 255, 0};
  write("part/hill.png", assets::png_of({.width = 2, .height = 2, .channels = 1, .data = grey}));
  for (const char* const name : {"part/bad.png", "part/skin.png"}) write(name, "x");
  write_model("part/part.sdf", "name='part'", "<static>1</static>" + link("l", R"(
    <collision name="c"><geometry><mesh optimization="convex_decomposition"><uri>arm.obj</uri><scale>2 2 -2</scale>
      <submesh><name>hand</name><center>true</center></submesh></mesh></geometry></collision>
    <visual name="v"><geometry><mesh><uri>arm.obj</uri></mesh></geometry>
      <material><pbr><metal><albedo_map>skin.png</albedo_map></metal></pbr></material></visual>
    <collision name="h"><pose>0 0 0 0 0 1.5707963267948966</pose>
      <geometry><heightmap><uri>hill.png</uri><size>10 20 3</size><pos>1 0 -1</pos></heightmap></geometry></collision>)"));
  ASSERT_TRUE(read("<world name='w'><include><uri>part/part.sdf</uri></include></world>")) << error_;
  const model::Link& l = model().links[0];
  ASSERT_EQ(l.collisions.size(), 3u) << "two hulls and the hill";
  EXPECT_EQ(l.collisions[0].name, "c");
  EXPECT_EQ(l.collisions[1].name, "c_2");
  Bounds hand;
  for (const std::size_t i : {0u, 1u}) {
    const Mesh& hull = std::get<Mesh>(l.collisions[i].shape);
    EXPECT_TRUE(hull.mesh->is_hull);
    EXPECT_EQ(hull.mesh->triangles.size(), 4u);
    hand.include(bounds_of(hull, l.collisions[i].X_LC));
  }
  EXPECT_NEAR(norm(hand.low - Vec3{-4, -1, -1}), 0, 1e-12) << "scaled, its middle at the origin";
  EXPECT_NEAR(norm(hand.high - Vec3{4, 1, 1}), 0, 1e-12);
  ASSERT_EQ(l.visuals.size(), 1u);
  EXPECT_EQ(std::get<Mesh>(l.visuals[0].shape).mesh->triangles.size(), 12u) << "all of the file, as it is";
  EXPECT_EQ(l.visuals[0].material.texture, folder_ + "part/skin.png");
  EXPECT_EQ(l.visuals[0].material.diffuse, (Color{1, 1, 1, 1}));
  expect_pose(l.collisions[2].X_LC, {0, 1, -1}, math::pi / 2);
  const Bounds hill = bounds_of(l.collisions[2].shape, {});
  EXPECT_NEAR(norm(hill.high - hill.low - Vec3{10, 20, 3}), 0, 1e-6);
  EXPECT_FALSE(read("<model name='m'>\n" +
                    link("l",
                         "<collision name='c'><geometry><heightmap><uri>part/bad.png</uri></heightmap>"
                         "</geometry></collision>") +
                    "</model>"));
  EXPECT_NE(error_.find("part/bad.png: "), std::string::npos) << error_;
}

}  // namespace
}  // namespace sandlot::formats
