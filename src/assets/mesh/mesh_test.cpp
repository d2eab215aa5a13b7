#include "assets/mesh/mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "assets/mesh/samples_test.h"

namespace sandlot::assets::mesh_test {
namespace {

using namespace mesh_samples;  // NOLINT(google-build-using-namespace)

TriangleMesh parsed(const std::string& bytes, const std::string& name, const MeshOptions& options = {}) {
  Diagnostics diagnostics;
  auto result = parse_mesh(bytes, "/nowhere/" + name, options, diagnostics);
  EXPECT_TRUE(result) << name << ": " << (result ? "" : result.error().text());
  return result ? std::move(*result) : TriangleMesh{};
}
std::string complaint(const std::string& bytes, const std::string& name, const MeshOptions& options = {}) {
  Diagnostics diagnostics;
  const auto result = parse_mesh(bytes, "/nowhere/" + name, options, diagnostics);
  return result ? "" : result.error().text();
}
void expect_says(const std::string& said, const std::string& part) {
  EXPECT_NE(said.find(part), std::string::npos) << "said: '" << said << "', wanted: " << part;
}

/// The corner tetrahedron with legs of `size`, its right angle at `at`: volume size^3 / 6, centre a quarter of the way.
void expect_tetrahedron(const TriangleMesh& mesh, Vec3 size = {1, 1, 1}, Vec3 at = {},
                        double tolerance = 1e-12) {
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_TRUE(is_closed(mesh));
  const MassProperties p = mass_properties(mesh);
  EXPECT_NEAR(p.volume_m3, std::abs(size.x * size.y * size.z) / 6, tolerance);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(p.centre_m[i], at[i] + 0.25 * size[i], tolerance) << i;
  // E[x^2] = 3/80 size^2 about the centre, E[xy] = -1/80 size^2.
  EXPECT_NEAR(p.moments.z, 3.0 / 80 * (size.x * size.x + size.y * size.y), tolerance);
  EXPECT_NEAR(p.products.x, size.x * size.y / 80, tolerance);
}

TEST(Mesh, EveryFormatTellsTheSameTetrahedron) {
  for (const Sample& sample : all_formats()) {
    SCOPED_TRACE(sample.name);
    // glTF is turned from y up to z up: (x, y, z) -> (x, -z, y).
    const bool turned = sample.name.find(".gl") != std::string::npos;
    const TriangleMesh mesh = parsed(sample.bytes, sample.name);
    if (turned) expect_tetrahedron(mesh, {1, -1, 1});
    else expect_tetrahedron(mesh);
    expect_tetrahedron(parsed(sample.bytes, sample.name, {.up = UpAxis::as_written}));
  }
}

TEST(Mesh, ScaleMovesTheInertiaAndAMirrorKeepsTheOutsideOutside) {
  for (const Sample& sample : all_formats()) {
    SCOPED_TRACE(sample.name);
    for (const Vec3 scale : {Vec3{2, 3, 0.5}, Vec3{-1, 1, 1}, Vec3{-2, -3, 1}, Vec3{-1, -1, -2}})
      expect_tetrahedron(parsed(sample.bytes, sample.name, {.scale = scale, .up = UpAxis::as_written}),
                         scale);
  }
  expect_says(complaint(stl_ascii(), "a.stl", {.scale = {1, 0, 1}}), "other than 0");
  expect_says(complaint(stl_ascii(), "a.stl", {.scale = {1, NAN, 1}}), "finite");
  expect_says(complaint(stl_ascii(), "a.stl", {.scale = {1, 1e12, 1}}), "unit");
}

TEST(Mesh, AFileCutOffAnywhereIsOneErrorOrAWholeMesh) {
  for (const Sample& sample : all_formats())
    for (std::size_t k = 0; k < 20; ++k) {
      const std::string part = sample.bytes.substr(0, sample.bytes.size() * k / 20);
      SCOPED_TRACE(sample.name + " cut to " + std::to_string(k) + "/20");
      Diagnostics diagnostics;
      const auto result = parse_mesh(part, "/nowhere/" + sample.name, {}, diagnostics);
      // OBJ has no end: what stands is what there is. MS3D ends in tables that nobody needs.
      if (sample.name == "a.obj") {
        if (result) { EXPECT_LT(result->triangles.size(), 4u); }
        continue;
      }
      ASSERT_FALSE(result);
      EXPECT_FALSE(result.error().what.empty());
      ASSERT_TRUE(result.error().place.file);
      EXPECT_EQ(*result.error().place.file, "/nowhere/" + sample.name);
    }
}

TEST(Mesh, FlippedBytesNeverDoMoreThanAnError) {
  std::uint32_t random = 12345;
  const auto next = [&] { return random = random * 1664525u + 1013904223u, random >> 8; };
  for (const Sample& sample : all_formats())
    for (int i = 0; i < 400; ++i) {
      std::string bytes = sample.bytes;
      for (int k = 0; k < 3; ++k) bytes[next() % bytes.size()] = static_cast<char>(next());
      Diagnostics diagnostics;
      const auto result = parse_mesh(bytes, "/nowhere/" + sample.name, {}, diagnostics);
      if (!result) {
        EXPECT_FALSE(result.error().what.empty());
        continue;
      }
      for (const auto& t : result->triangles)
        for (const auto v : t) ASSERT_LT(v, result->vertices.size());
      for (const Vec3& v : result->vertices) ASSERT_TRUE(is_finite(v));
    }
}

TEST(Mesh, TooManyTrianglesAreRefusedBeforeTheyAreRead) {
  std::string stl = stl_binary();
  const std::uint32_t count = 10'000'000;
  std::memcpy(stl.data() + 80, &count, 4);
  expect_says(complaint(stl, "a.stl"), "has 10000000 triangles");
  expect_says(complaint(stl, "a.stl", {.max_triangles = 20'000'000}),
              "it should have 10000000 triangles and has 4");
  std::string ply = ply_binary();
  ply.replace(ply.find("face 4"), 6, "face 40000000");
  expect_says(complaint(ply, "a.ply"), "cut off");
  for (const Sample& sample : all_formats()) {
    SCOPED_TRACE(sample.name);
    EXPECT_EQ(complaint(sample.bytes, sample.name, {.max_triangles = 4}), "");
    expect_says(complaint(sample.bytes, sample.name, {.max_triangles = 3}), "at most 3 are read");
  }
}

TEST(Mesh, TrianglesWithoutAreaAreDroppedAndNumbersMustBeNumbers) {
  const std::string tail =
      "v 2 0 0\nv 0 0 0\nf 1 2 5\nf 1 6 2\nf 1 1 2\n";  // collinear, repeated place, repeated corner
  expect_tetrahedron(parsed(obj() + tail, "a.obj"));
  expect_says(complaint("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "a.obj"), "has no triangles");
  expect_says(complaint("v 0 nan 0\n", "a.obj"), "a.obj:1: a vertex has three finite numbers");
  expect_says(complaint("v 0 0 0\nv 0 1e999 0\n", "a.obj"), ":2: ");
  std::string stl = stl_binary();
  const float nan = NAN;
  std::memcpy(stl.data() + 84 + 50 + 12, &nan, 4);
  expect_says(complaint(stl, "a.stl"), "triangle 1 has a corner that is not a number");
  std::string dae = collada();
  dae.replace(dae.find("0 0 0 1 0 0"), 1, "NaN");
  expect_says(complaint(dae, "a.dae"), "not a finite number");
}

TEST(Mesh, PolygonsAreCutIntoTheirTriangles) {
  // An L of six corners in the plane x = y/2: area 3 in (y, z), times sqrt(1.25) for the slope. A fan would cover more.
  const std::string l = "v 0 0 0\nv 1 2 0\nv 1 2 1\nv 0.5 1 1\nv 0.5 1 2\nv 0 0 2\nf 1 2 3 4 5 6\n";
  const TriangleMesh mesh = parsed(l, "l.obj");
  EXPECT_EQ(mesh.triangles.size(), 4u);
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 n = cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
    area += 0.5 * norm(n);
    EXPECT_GT(n.x, 0);  // all of them face the side from which the outline runs counter-clockwise
  }
  EXPECT_NEAR(area, 3 * std::sqrt(1.25), 1e-12);
}

TEST(Mesh, StlBinaryThatBeginsWithSolidAndAsciiOfSeveralSolids) {
  std::string stl = stl_binary();
  stl.replace(0, 5, "solid");
  expect_tetrahedron(parsed(stl, "a.STL"));
  std::string upper = stl_ascii();
  for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  expect_tetrahedron(parsed(upper, "a.stl"));
  const std::string two = stl_ascii("first one") + stl_ascii("second");
  const TriangleMesh both = parsed(two, "two.stl");
  ASSERT_EQ(both.parts.size(), 2u);
  EXPECT_EQ(both.parts[0].name, "first one");
  EXPECT_EQ(both.parts[1].first_triangle, 4u);
  expect_tetrahedron(parsed(two, "two.stl", {.submesh = "second"}));
  expect_says(complaint("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", "a.stl"), "a.stl:4: ");
  expect_says(complaint("hello", "a.stl"), "is not a STL file");
}

TEST(Mesh, ColladaUnitsNodesAndMirrors) {
  // Unit, then node by node from the outside: translate (1 2 3), turn a quarter about z, scale.
  const std::string steps = "<translate>1 2 3</translate><rotate>0 0 1 90</rotate><scale>2 1 1</scale>";
  const TriangleMesh mesh = parsed(collada("<unit meter=\"0.01\"/>", steps), "a.dae");
  // x' = -y, y' = 2 x, all in centimetres.
  expect_tetrahedron(mesh, {-0.01, 0.02, 0.01}, {0.01, 0.02, 0.03}, 1e-15);
  const TriangleMesh mirrored = parsed(collada("", "<matrix>-1 0 0 5 0 1 0 0 0 0 1 0 0 0 0 1</matrix>"),
                                       "a.dae");
  expect_tetrahedron(mirrored, {-1, 1, 1}, {5, 0, 0});
  expect_says(complaint(collada("<unit meter=\"0\"/>"), "a.dae"), "is not a length");
  expect_says(complaint(collada("", "<translate>1 2</translate>"), "a.dae"), "3 are needed");
}

TEST(Mesh, ColladaUpAxisIsLeftAloneUnlessAskedFor) {
  for (const std::string up : {"X_UP", "Y_UP", "Z_UP"}) {
    SCOPED_TRACE(up);
    const std::string dae = collada("<up_axis>" + up + "</up_axis>");
    Diagnostics diagnostics;
    const auto usual = parse_mesh(dae, "/nowhere/a.dae", {}, diagnostics);
    ASSERT_TRUE(usual);
    expect_tetrahedron(*usual);
    EXPECT_EQ(diagnostics.warnings.size(), up == "Z_UP" ? 0u : 1u);
    const TriangleMesh turned = parsed(dae, "a.dae", {.up = UpAxis::declared});
    // Y_UP: x right, y up, z backwards -> (x, -z, y). X_UP: x up, y left, z backwards -> (-y, -z, x).
    if (up == "Y_UP") expect_tetrahedron(turned, {1, -1, 1});
    if (up == "X_UP") expect_tetrahedron(turned, {-1, -1, 1});
    if (up == "Z_UP") expect_tetrahedron(turned);
  }
}

TEST(Mesh, ColladaInstancesColoursAndLoops) {
  const std::string twice =
      "</node><node name=\"again\"><translate>10 0 0</translate><instance_node url=\"#n\"/>";
  const TriangleMesh mesh = parsed(collada("", "", twice), "a.dae");
  EXPECT_EQ(mesh.triangles.size(), 8u);
  ASSERT_EQ(mesh.parts.size(), 4u);  // triangles and polylist, twice
  EXPECT_EQ(mesh.parts[0].name, "body");
  EXPECT_EQ(mesh.parts[0].color, (Color{1, 0.5, 0, 1}));
  EXPECT_EQ(mesh.parts[1].color, Color{});  // no material
  expect_says(complaint(collada("", "", "<instance_node url=\"#n\"/>"), "a.dae"), "circle");
  expect_says(complaint(collada("", "", "<instance_node url=\"#m\"/>"), "a.dae"), "a.dae:");
}

TEST(Mesh, GltfNodesAndBrokenLinks) {
  const std::string moved = gltf(
      R"("nodes":[{"mesh":0,"name":"body","translation":[1,2,3],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,1,1]}])");
  expect_tetrahedron(parsed(moved, "a.gltf", {.up = UpAxis::as_written}), {-1, 2, 1}, {1, 2, 3}, 1e-12);
  expect_tetrahedron(parsed(moved, "a.gltf"), {-1, -1, 2}, {1, -3, 2}, 1e-12);
  const TriangleMesh mesh = parsed(gltf(), "a.gltf");
  ASSERT_EQ(mesh.parts.size(), 1u);
  EXPECT_EQ(mesh.parts[0].name, "body");
  EXPECT_EQ(mesh.parts[0].color, (Color{1, 0.5, 0, 1}));
  expect_says(complaint(gltf(R"("nodes":[{"mesh":0,"children":[0]}])"), "a.gltf"), "two parents");
  expect_says(complaint(gltf(R"("nodes":[{"children":[7]}])"), "a.gltf"), "not there");
  expect_says(complaint(gltf(R"("nodes":[{"mesh":3}])"), "a.gltf"), "not there");
  std::string big = gltf();
  big.replace(big.find("\"count\":4"), 9, "\"count\":4000000000");
  expect_says(complaint(big, "a.gltf"), "outside its buffer");
  std::string draco = gltf();
  draco.insert(1, R"("extensionsRequired":["KHR_draco_mesh_compression"],)");
  expect_says(complaint(draco, "a.gltf"), "without compression");
  expect_says(complaint(R"({"asset":{"version":"1.0"}})", "a.gltf"), "version 1.0");
}

TEST(Mesh, ASubmeshIsFoundByNameAndCentred) {
  const std::string two =
      obj() + "o other\nv 10 0 0\nv 12 0 0\nv 10 4 0\nv 10 0 6\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n";
  EXPECT_EQ(parsed(two, "a.obj").triangles.size(), 8u);
  expect_tetrahedron(parsed(two, "a.obj", {.submesh = "other"}), {2, 4, 6}, {10, 0, 0}, 1e-11);
  expect_tetrahedron(parsed(two, "a.obj", {.submesh = "other", .centre = true}), {2, 4, 6}, {-1, -2, -3},
                     1e-11);
  expect_says(complaint(two, "a.obj", {.submesh = "othre"}), "did you mean 'other'?");
  for (const Sample& sample : all_formats()) {
    if (sample.name.find(".ply") != std::string::npos || sample.name == "b.stl")
      continue;  // they have no names
    SCOPED_TRACE(sample.name);
    EXPECT_EQ(parsed(sample.bytes, sample.name, {.submesh = "body"}).triangles.size(), 4u);
    expect_says(complaint(sample.bytes, sample.name, {.submesh = "boddy"}), "did you mean 'body'?");
  }
}

TEST(Mesh, AnObjThatEndsInAContinuedLineIsReadOnceToItsEnd) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* face : {"f 1 2 3 \\", "f 1 2 3 \\\n", "f 1 \\\n2 3 \\", "f 1 \\\n2 \\\n3"})
    EXPECT_EQ(parsed(corners + face, "a.obj").triangles.size(), 1u) << face;
}

TEST(Mesh, AnObjReadsEachMaterialFileOnce) {
  Diagnostics diagnostics;
  const std::string text = "mtllib a.mtl\nmtllib b.mtl\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  ASSERT_TRUE(parse_mesh(text, "/nowhere/a.obj", {}, diagnostics));
  EXPECT_EQ(diagnostics.warnings.size(), 2u);  // neither is there
}

TEST(Mesh, ObjLinesCornersAndErrorsHaveTheirLine) {
  expect_tetrahedron(parsed("# a comment\n\n" + obj() + "l 1 2\np 1\ns off\n", "a.obj"));
  expect_tetrahedron(
      parsed("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nv 0 0 1\r\nf -4 -2 \\\r\n -3\r\nf 1 2 4\r\nf 1//1 4//1 "
             "3//1\r\nf 2 3 4\r\n",
             "a.obj"));
  expect_says(complaint("v 0 0 0\nv 1 0 0\nf 1 2 3\n", "a.obj"),
              "a.obj:3: face corner '3' names no vertex; there are 2");
  expect_says(complaint("v 0 0 0\nf 1 0 1\n", "a.obj"), "a.obj:2: ");
  expect_says(complaint("v 0 0 0\nf 1 1\n", "a.obj"), "three corners or more");
  expect_says(complaint("v 0 0 0\nf 1 99999999999999999999 1\n", "a.obj"), "names no vertex");
  expect_says(complaint("", "a.obj"), "is empty");
  expect_says(complaint("x", "a.fbx"), "known are .dae .stl .obj");
}

TEST(Mesh, ManyPartsAndManyUnknownMaterials) {
  // 300 parts: more names than suggestions are made from. Each material that is not there is said once.
  std::string many = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 300; ++i)
    many += "o part" + std::to_string(i) + "\nusemtl " + (i % 2 == 0 ? "red" : "blue") + "\nf 1 2 3\n";
  Diagnostics diagnostics;
  const auto all = parse_mesh(many, "/nowhere/a.obj", {}, diagnostics);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->parts.size(), 300u);
  EXPECT_EQ(diagnostics.warnings.size(), 2u);
  const TriangleMesh last = parsed(many, "a.obj", {.submesh = "part299"});
  EXPECT_EQ(last.triangles.size(), 1u);
  ASSERT_EQ(last.parts.size(), 1u);
  EXPECT_EQ(last.parts[0].first_triangle, 0u);
}

class MeshFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("sandlot_mesh_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "meshes");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& bytes) {
    const auto path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
    return path.string();
  }
  std::filesystem::path folder_;
  Diagnostics diagnostics_;
};

TEST_F(MeshFiles, OneMeshForAllWhoReadTheSameFile) {
  const std::string path = write("meshes/a.stl", stl_binary());
  const auto a = read_mesh(path, {}, diagnostics_);
  ASSERT_TRUE(a);
  const auto b = read_mesh((folder_ / "meshes/../meshes/./a.stl").string(), {}, diagnostics_);
  ASSERT_TRUE(b);
  EXPECT_EQ(a->get(), b->get());
  const auto scaled = read_mesh(path, {.scale = {2, 2, 2}}, diagnostics_);
  ASSERT_TRUE(scaled);
  EXPECT_NE(a->get(), scaled->get());
  write("meshes/a.stl", stl_binary() + "changed");
  EXPECT_FALSE(read_mesh(path, {.max_triangles = 3}, diagnostics_));
  const auto changed = read_mesh(path, {}, diagnostics_);
  ASSERT_TRUE(changed);
  EXPECT_NE(a->get(), changed->get());
  // Several threads at once end with one mesh.
  const std::string other = write("meshes/b.stl", stl_binary());
  std::array<std::shared_ptr<const TriangleMesh>, 8> got;
  std::vector<std::thread> threads;
  for (auto& each : got)
    threads.emplace_back([&each, &other] {
      Diagnostics d;
      if (auto mesh = read_mesh(other, {}, d)) each = *mesh;
    });
  for (std::thread& t : threads) t.join();
  for (const auto& each : got) EXPECT_EQ(each, got[0]);
  EXPECT_NE(got[0], nullptr);
}

TEST_F(MeshFiles, MaterialsAndTexturesComeFromBesideTheMesh) {
  write("meshes/m.mtl", "newmtl red\nKd 1 0.25 0\nd 0.5\nmap_Kd wood.png\n");
  write("materials/textures/wood.png", "x");
  const std::string text =
      "mtllib m.mtl\nvt 0.5 0.25\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n";
  const std::string path = write("meshes/a.obj", text);
  const auto mesh = read_mesh(path, {}, diagnostics_);
  ASSERT_TRUE(mesh) << mesh.error().text();
  ASSERT_EQ((*mesh)->parts.size(), 1u);
  EXPECT_EQ((*mesh)->parts[0].color, (Color{1, 0.25, 0, 0.5}));
  EXPECT_EQ((*mesh)->parts[0].texture, (folder_ / "materials/textures/wood.png").string());
  ASSERT_EQ((*mesh)->texture_uv.size(), 3u);
  EXPECT_EQ((*mesh)->texture_uv[0], (std::array{0.5f, 0.25f}));
  EXPECT_TRUE(diagnostics_.warnings.empty());
}

TEST_F(MeshFiles, AMissingTextureIsOneWarningWithItsLine) {
  // Two parts and two meshes name it, one of them twice.
  write("meshes/m.mtl",
        "newmtl red\nKd 1 0.25 0\nmap_Kd C:\\models\\gone.png\nnewmtl blue\nmap_Kd gone.png\n");
  const std::string red = "mtllib m.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                    path = write("meshes/a.obj", red + "usemtl blue\nf 3 2 1\nusemtl red\nf 2 1 3\n");
  const auto shape_only = read_mesh(path, {.textures = false}, diagnostics_);
  ASSERT_TRUE(shape_only);
  EXPECT_TRUE(diagnostics_.warnings.empty()) << "who needs only the shape does not care";
  const auto mesh = read_mesh(path, {}, diagnostics_);
  ASSERT_TRUE(mesh) << mesh.error().text();
  EXPECT_EQ(mesh->get(), shape_only->get());
  ASSERT_EQ(diagnostics_.warnings.size(), 2u);
  const std::string folder = (folder_ / "meshes").string();
  EXPECT_EQ(diagnostics_.warnings[0].text(),
            folder + "/m.mtl:3: the texture '" + folder +
                "/C:/models/gone.png' does not exist; a checker is shown in its place: put it beside the "
                "mesh or into ../materials/textures");
  expect_says(diagnostics_.warnings[1].text(), "m.mtl:5: the texture '" + folder + "/gone.png' does not");
  EXPECT_EQ((*mesh)->parts[0].texture, folder + "/C:/models/gone.png");
  EXPECT_EQ((*mesh)->parts[1].texture, folder + "/gone.png");
  EXPECT_FALSE((*mesh)->texture_uv.empty()) << "the checker needs them";
  ASSERT_TRUE(read_mesh(path, {}, diagnostics_));
  ASSERT_TRUE(read_mesh(write("meshes/b.obj", red), {}, diagnostics_));
  EXPECT_EQ(diagnostics_.warnings.size(), 2u) << "said once, whoever names it";
  Diagnostics later;
  ASSERT_TRUE(read_mesh(path, {}, later));
  EXPECT_EQ(later.warnings.size(), 2u) << "also when the cache has it";
}

TEST_F(MeshFiles, MissingTexturesOfColladaAndGltfAreNamedToo) {
  std::string dae = collada();
  const auto put = [](std::string& text, const std::string& before, const std::string& more) {
    const std::size_t at = text.find(before);
    ASSERT_NE(at, std::string::npos);
    text.insert(at, more);
  };
  put(dae, "<library_effects>",
      "<library_images><image id=\"i\"><init_from>bark%20a.png</init_from></image></library_images>\n");
  put(dae, "<color>1 0.5 0 1</color>", "<texture texture=\"i\"/>");
  ASSERT_TRUE(read_mesh(write("meshes/a.dae", dae), {}, diagnostics_));
  ASSERT_EQ(diagnostics_.warnings.size(), 1u);
  expect_says(diagnostics_.warnings[0].text(),
              "a.dae:4: the texture '" + (folder_ / "meshes/bark a.png").string());
  std::string gltf_text = gltf();
  put(gltf_text, "\"baseColorFactor\"", "\"baseColorTexture\":{\"index\":0},");
  put(gltf_text, "\"materials\"", "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"leaf.png\"}],");
  ASSERT_TRUE(read_mesh(write("meshes/a.gltf", gltf_text), {}, diagnostics_));
  ASSERT_EQ(diagnostics_.warnings.size(), 2u);
  expect_says(diagnostics_.warnings[1].text(),
              "a.gltf: the texture '" + (folder_ / "meshes/leaf.png").string());
}

TEST_F(MeshFiles, ManyMissingTexturesAreNotAllNamed) {
  std::string mtl, text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 1000; ++i) {
    const std::string name = std::to_string(i);
    mtl += "newmtl m" + name + "\nmap_Kd " + name + ".png\n";
    text += "usemtl m" + name + "\nf 1 2 3\n";
  }
  write("meshes/m.mtl", mtl);
  const auto mesh = read_mesh(write("meshes/a.obj", text), {}, diagnostics_);
  ASSERT_TRUE(mesh) << mesh.error().text();
  EXPECT_EQ((*mesh)->parts.size(), 1000u);
  ASSERT_EQ(diagnostics_.warnings.size(), 21u);
  expect_says(diagnostics_.warnings.back().text(),
              "m.mtl:42: more textures cannot be used; a checker is shown");
}

TEST_F(MeshFiles, NothingOutsideTheMeshsFolderIsRead) {
  write("secret.mtl", "newmtl red\nKd 1 0 0\n");
  for (const std::string& name : {std::string("../secret.mtl"), std::string("x/../../secret.mtl"),
                                  (folder_ / "secret.mtl").string(), std::string("gone.mtl")}) {
    SCOPED_TRACE(name);
    Diagnostics diagnostics;
    const auto mesh = parse_mesh("mtllib " + name + "\nusemtl red\n" + obj(),
                                 (folder_ / "meshes/a.obj").string(), {}, diagnostics);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->parts[0].color, Color{});
    ASSERT_EQ(diagnostics.warnings.size(), 2u);
    expect_says(diagnostics.warnings[0].text(),
                name == "gone.mtl" ? "does not exist" : "not a file in the mesh's folder");
  }
  std::string outside = gltf();
  const std::size_t from = outside.find("data:"), to = outside.find('"', from);
  outside.replace(from, to - from, "../../etc/passwd");
  expect_says(complaint(outside, "a.gltf"), "not a file in the mesh's folder");
}

TEST_F(MeshFiles, BuffersOfGltfComeFromBesideIt) {
  write("meshes/my buffer.bin", gltf_buffer());
  std::string text = gltf();
  const std::size_t from = text.find("data:"), to = text.find('"', from);
  const auto mesh = read_mesh(write("meshes/a.gltf", text.replace(from, to - from, "my%20buffer.bin")),
                              {.up = UpAxis::as_written}, diagnostics_);
  ASSERT_TRUE(mesh) << mesh.error().text();
  expect_tetrahedron(**mesh);
  write("meshes/my buffer.bin", gltf_buffer().substr(1));
  const auto cut = read_mesh(write("meshes/b.gltf", text), {}, diagnostics_);
  ASSERT_FALSE(cut);
  expect_says(cut.error().text(), "b.gltf: a buffer has 71 bytes and should have 72");
}

TEST_F(MeshFiles, UnreadableFiles) {
  const auto says = [&](const std::string& path) {
    const auto mesh = read_mesh(path, {}, diagnostics_);
    return mesh ? "" : mesh.error().text();
  };
  expect_says(says((folder_ / "none.stl").string()), "no such file");
  expect_says(says((folder_ / "meshes").string()), "is a folder");
  expect_says(says("/dev/zero"), "not a regular file");
  expect_says(says(write("a.stl", "")), "is empty");
  const auto large = read_mesh(write("b.stl", stl_binary()), {.max_bytes = 100}, diagnostics_);
  ASSERT_FALSE(large);
  expect_says(large.error().text(), "too large");
}

TEST(CollisionMeshes, HullsOfTheWholeOrOfItsParts) {
  // Two boxes 1 x 1 x 1 with a gap of 1: hull 3 x 1 x 1.
  TriangleMesh two = tessellate(Box{{1, 1, 1}});
  const TriangleMesh one = two;
  for (const Vec3& v : one.vertices) two.vertices.push_back(v + Vec3{2, 0, 0});
  for (const auto& [a, b, c] : one.triangles) two.triangles.push_back({a + 8, b + 8, c + 8});
  const auto mesh = std::make_shared<const TriangleMesh>(two);
  const auto volumes = [&](Simplification how) {
    std::vector<double> out;
    const auto meshes = collision_meshes(mesh, how);
    for (const auto& m : *meshes) out.push_back(mass_properties(*m).volume_m3);
    return out;
  };
  EXPECT_EQ(collision_meshes(mesh, Simplification::none)->front(), mesh);
  ASSERT_EQ(volumes(Simplification::convex_hull).size(), 1u);
  EXPECT_NEAR(volumes(Simplification::convex_hull)[0], 3, 1e-8);
  const auto hull = collision_meshes(mesh, Simplification::convex_hull),
             again = collision_meshes(mesh, Simplification::convex_hull);
  EXPECT_EQ(hull->front(), again->front());
  const auto copy = std::make_shared<const TriangleMesh>(two);
  EXPECT_NE(collision_meshes(copy, Simplification::convex_hull)->front(), hull->front());
  ASSERT_EQ(volumes(Simplification::convex_decomposition).size(), 2u);
  EXPECT_NEAR(volumes(Simplification::convex_decomposition)[0], 1, 1e-8);
  const auto flat = std::make_shared<const TriangleMesh>(
      TriangleMesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}});
  expect_says(collision_meshes(flat, Simplification::convex_hull).error().text(), "is flat");
}

}  // namespace
}  // namespace sandlot::assets::mesh_test
