/// Meshes, grids and textures as viewers fetch them, against bytes written by hand from docs/viewer_protocol.md.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/test_folder.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "sim/test_world.h"
#include "wire/scene.h"

namespace sandlot::wire {
namespace {

using Json = nlohmann::json;

std::vector<std::byte> bytes_of(auto... values) {
  ByteWriter w;
  (write(w, values), ...);
  return std::move(w.buffer());
}

TriangleMesh square() {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// A world whose only thing looks like these shapes.
model::Setup shown(std::vector<model::Visual> visuals) {
  const auto box = test::one_shape("thing", Box{{1, 1, 1}}, 0);
  box->links[0].visuals = std::move(visuals);
  model::Setup setup;
  setup.instances.push_back(test::placed("thing", box, {}));
  return setup;
}

Json visuals_of(const std::string& world) { return Json::parse(world)["models"][0]["links"][0]["visuals"]; }

TEST(Assets, MeshesComeAsBytesAndEqualOnesOnce) {
  TriangleMesh mesh = square();
  mesh.texture_uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  mesh.parts = {{"a", 0, 1, {1, 0, 0, 1}, ""}, {"b", 1, 1, {0, 1, 0, 0.5f}, "no/such.png"}};
  const auto first = std::make_shared<const TriangleMesh>(mesh);
  mesh.source = "elsewhere.stl";
  const auto same = std::make_shared<const TriangleMesh>(mesh);
  mesh.vertices[2].z = 0.25;
  const auto other = std::make_shared<const TriangleMesh>(mesh);
  const auto simulation = test::build(shown({{"v1", {}, Mesh{first}, {}, true, {}},
                                             {"v2", {}, Mesh{same}, {}, false, {}},
                                             {"v3", {}, Mesh{other}, {}, true, {}}}));
  const Assets assets;
  WorldJsonWriter writer(assets);
  const Json visuals = visuals_of(writer.write(*simulation, 1));
  EXPECT_EQ(visuals[0]["shape"], Json::parse(R"({"type":"mesh","mesh":"a0"})"));
  EXPECT_EQ(visuals[1]["shape"], visuals[0]["shape"]);
  EXPECT_EQ(visuals[2]["shape"]["mesh"], "a1");
  EXPECT_EQ(visuals[0]["cast_shadows"], true);
  EXPECT_EQ(visuals[1]["cast_shadows"], false);

  const auto body = assets.get("mesh/a0");
  ASSERT_TRUE(body) << body.error().text();
  EXPECT_EQ(body->type, "application/octet-stream");
  const std::uint32_t no_texture = 0, texture_0 = 1;
  EXPECT_EQ(*body->bytes,
            bytes_of('S', 'L', 'M', '1', 4u, 2u, 1u, 2u,                           // header
                     0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.5f, 0.f, 1.f, 0.f,  // vertices
                     0.f, 0.f, 1.f, 0.f, 1.f, 1.f, 0.f, 1.f,                       // uv
                     0u, 1u, 2u, 0u, 2u, 3u,                                       // triangles
                     0u, 1u, 1.f, 0.f, 0.f, 1.f, no_texture, 1u, 1u, 0.f, 1.f, 0.f, 0.5f, texture_0));
  EXPECT_EQ(assets.get("mesh/a0")->bytes, body->bytes) << "is kept";
  const auto gone = assets.get("texture/t0");
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().text(), "the texture 'such.png': no such file") << "and not where it lies";

  // The same world once more, its things at other addresses: nothing is numbered anew.
  const auto again = test::again(*simulation);
  EXPECT_EQ(visuals_of(writer.write(*again, 2)), visuals);
  EXPECT_FALSE(assets.get("mesh/a2"));
}

TEST(Assets, GridsComeAsBytes) {
  HeightGrid grid;
  grid.columns = 3;
  grid.rows = 2;
  grid.size_x_m = 4;
  grid.size_y_m = 2;
  grid.height_m = {0, 1, 2, 3, 4, 5.5f};
  const auto shared = std::make_shared<const HeightGrid>(grid);
  const auto simulation = test::build(shown({{"v", {}, Heightfield{shared}, {}, true, {}}}));
  const Assets assets;
  const Json visuals = visuals_of(WorldJsonWriter(assets).write(*simulation, 1));
  EXPECT_EQ(visuals[0]["shape"], Json::parse(R"({"type":"heightmap","grid":"g0"})"));
  const auto body = assets.get("grid/g0");
  ASSERT_TRUE(body);
  EXPECT_EQ(*body->bytes, bytes_of('S', 'L', 'G', '1', 3u, 2u, 4.f, 2.f, 0.f, 1.f, 2.f, 3.f, 4.f, 5.5f));
}

TEST(Assets, TexturesAreFilesThatAModelNamesAndNothingElse) {
  const test::TestFolder folder;
  const std::string png = "\x89PNG\r\n\x1a\nand so on", jpeg = "\xff\xd8\xff\xe0 and so on";
  model::Visual visual{"v", {}, Box{{1, 1, 1}}, {}, true, {}};
  std::vector<model::Visual> visuals;
  for (const std::string& file :
       {folder.write("a.png", png), folder.write("b.any", jpeg), folder.write("c.png", "text"),
        folder.path.string(), std::string("/etc/passwd"), folder.write("empty.png", "")}) {
    visual.material.texture = file;
    visuals.push_back(visual);
  }
  visual.material.texture = "";
  visuals.push_back(visual);
  const auto simulation = test::build(shown(std::move(visuals)));
  const Assets assets;
  const Json written = visuals_of(WorldJsonWriter(assets).write(*simulation, 1));
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(written[static_cast<std::size_t>(i)]["material"]["texture"], "t" + std::to_string(i));
  EXPECT_EQ(written[6]["material"]["texture"], "");
  const auto text = [](const std::vector<std::byte>& bytes) {
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  const auto first = assets.get("texture/t0");
  ASSERT_TRUE(first);
  EXPECT_EQ(first->type, "image/png");
  EXPECT_EQ(text(*first->bytes), png);
  const auto second = assets.get("texture/t1");
  ASSERT_TRUE(second);
  EXPECT_EQ(second->type, "image/jpeg");
  EXPECT_EQ(text(*second->bytes), jpeg);
  for (const char* other : {"texture/t2", "texture/t3", "texture/t4", "texture/t5"})
    EXPECT_FALSE(assets.get(other)) << other << ": no image";
  EXPECT_NE(assets.get("texture/t4").error().text().find("neither a PNG nor a JPEG"), std::string::npos);
  // Larger than any texture may be: a file of holes.
  std::filesystem::resize_file(folder.path / "a.png", most_texture_bytes + 1);
  EXPECT_FALSE(assets.get("texture/t0"));
}

TEST(Assets, WhatIsNoNameOfOneIsRefused) {
  const Assets assets;
  for (const char* path :
       {"", "mesh", "mesh/", "mesh/a", "mesh/a0", "mesh/a-1", "mesh/a0x", "mesh/a99999999999", "mesh/b0",
        "grid/g0", "texture/t0", "texture/../../etc/passwd", "/etc/passwd"})
    EXPECT_FALSE(assets.get(path)) << path;
  const auto error = assets.get(std::string(100'000, 'x'));
  ASSERT_FALSE(error);
  EXPECT_LT(error.error().text().size(), 200u);
}

TEST(Assets, MayBeAskedFromAnyThreadWhileTheWorldGrows) {
  const Assets assets;
  WorldJsonWriter writer(assets);
  std::atomic<bool> stop = false;
  std::thread reader([&] {
    while (!stop)
      for (std::uint32_t i = 0; i < 20; ++i)
        if (const auto body = assets.get("mesh/a" + std::to_string(i))) {
          // Each mesh lies at the height of its number.
          float z = 0;
          std::memcpy(&z, body->bytes->data() + 20 + 8, sizeof z);
          EXPECT_EQ(z, static_cast<float>(i));
        }
  });
  for (int i = 0; i < 20; ++i) {
    TriangleMesh mesh = square();
    for (Vec3& v : mesh.vertices) v.z = i;
    const auto shared = std::make_shared<const TriangleMesh>(std::move(mesh));
    const auto simulation = test::build(shown({{"v", {}, Mesh{shared}, {}, true, {}}}));
    EXPECT_EQ(visuals_of(writer.write(*simulation, 1))[0]["shape"]["mesh"], "a" + std::to_string(i));
  }
  stop = true;
  reader.join();
}

}  // namespace
}  // namespace sandlot::wire
