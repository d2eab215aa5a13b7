#include "model/model_bytes.h"

#include "geometry/height_grid.h"
#include "geometry/mesh.h"

#include <gtest/gtest.h>

#include <limits>

#include "sim/test_world.h"

namespace sandlot {
namespace {

std::vector<std::byte> bytes_of(const model::Setup& setup) {
  std::vector<const model::Instance*> instances;
  for (const model::Instance& instance : setup.instances) instances.push_back(&instance);
  ByteWriter w;
  write_setup(w, setup, instances);
  return {w.bytes().begin(), w.bytes().end()};
}

/// Every member differs from its default, so that one left out shows.
model::Setup full_setup() {
  auto made = std::make_shared<model::Model>();
  made->name = "my model";
  made->self_collide = true;
  model::Link base;
  base.name = "base";
  base.X_ML = {{1, 2, 3}, quat_from_rpy(0.1, 0.2, 0.3)};
  base.inertial = {4, {{0.1, 0, 0}, {}}, {1, 2, 2.5}, {0.1, 0.2, 0.3}};
  base.gravity = false;
  model::Surface surface{0.4, 0.5, {1, 0, 0}, 0.1, 0.2, 0.3, 0.06, 0.2, 1e-5, 3000, 4, 0.5};
  surface.substance = model::Substance{0.9, 0.02, 50, 0.6};
  surface.skin = model::Skin{{0, 1, 0}, 0.1};
  surface.rolling_resistance_m = 0.003;
  surface.belt_velocity_mps = {0.7, 0.1, 0.2};
  surface.touches = false;
  auto mesh = std::make_shared<TriangleMesh>(tessellate(Box{{1, 1, 1}}));
  mesh->texture_uv.assign(mesh->vertices.size(), {0.25f, 0.75f});
  mesh->parts = {{"lid", 2, 10, {0.1f, 0.2f, 0.3f, 1}, "wood.png"}};
  mesh->source = "crate.obj";
  const auto grid = std::make_shared<HeightGrid>(HeightGrid{2, 3, 4, 5, {0, 1, 2, 3, 4, 5}, "hill.png"});
  for (const Shape& shape :
       {Shape(Box{{1, 2, 3}}), Shape(Sphere{0.5}), Shape(Cylinder{0.2, 0.7}), Shape(Capsule{0.1, 0.6}),
        Shape(Plane{{0, 0, 1}}), Shape(Cone{0.3, 0.9}), Shape(Ellipsoid{{0.1, 0.2, 0.3}}), Shape(Mesh{mesh}),
        Shape(Heightfield{grid})}) {
    base.collisions.push_back({"c", {{0, 0, 1}, {}}, shape, surface, {}});
    base.visuals.push_back(
        {"v",
         {{0, 1, 0}, {}},
         shape,
         {{0.1f, 0.2f, 0.3f, 0.4f}, {0.5f, 0, 0, 1}, {0, 0.5f, 0, 1}, 12, "paint.png", false},
         false,
         {}});
  }
  model::Link arm = base;
  arm.name = "arm";
  made->links = {base, arm};
  model::Joint joint{
      "hinge", model::JointType::revolute, 0, 1, {{0, 1, 0}, {}}, {1, 0, 0}, -1, 2, 30, 4, 0.5, 0.6, 7, 0.8};
  joint.thread_pitch_m = 0.01;
  joint.second = model::SecondAxis{{0, 0, 1}, -0.5, 0.6, 0.7, 0.8};
  joint.mimic = model::Mimic{0, 2, 0.1, 0.2};
  joint.rollers = model::RollerWheel{.radius_m = 0.06, .count = 7, .rows = 2, .surface = {.mu = 0.3}};
  joint.roller_of = 0;
  made->label = "7";
  made->joints.push_back(joint);
  model::Light lamp{model::Light::Type::spot,
                    "lamp",
                    {{0, 0, 4}, {}},
                    {1, 1, 0, 1},
                    {0, 1, 0, 1},
                    true,
                    7,
                    0.5,
                    0.6,
                    0.7,
                    0.1,
                    0.2,
                    3};
  made->lights.push_back({1, lamp});
  made->frames.push_back({"tip", 1, {{0, 0, 2}, {}}});
  Node config = Node::map();
  config.set("list", Node::sequence()).push(Node::scalar("1.5"));
  config.set("nested", test::map({{"key", "value"}}));
  made->devices.push_back({"cam", "camera", {"sensor:camera"}, "arm::", 1, {{1, 1, 1}, {}}, config, {}});
  model::Setup setup;
  setup.name = "full";
  setup.engine = "planar";
  setup.physics = config;
  setup.gravity = {0, 1, -3};
  setup.step = Time::from_s(0.02);
  setup.substeps = 3;
  setup.control_interval = 4;
  setup.seed = 99;
  setup.stop = Time::from_s(12);
  setup.zones.push_back({"ice", {{1, 2, 3}, {4, 5, 6}, {7, 8, 0}}, {9, 8, 7}, 6, surface, {}});
  setup.lights.push_back(lamp);
  setup.ambient = {0.1f, 0.1f, 0.1f, 1};
  setup.background = {0.2f, 0.2f, 0.2f, 1};
  setup.geography = model::Geography{0.8, 0.1, 300, 0.2};
  setup.magnetic_field_T = {1e-5, 2e-5, 3e-5};
  for (const char* name : {"one", "two"}) {
    model::Instance instance = test::placed(name, made, {{5, 6, 7}, {}});
    instance.original_name = std::string(name) + "!";
    instance.is_robot = true;
    instance.team = "red";
    instance.devices = made->devices;
    instance.controllers.push_back({"brain", "wander", config, {}});
    instance.motion = model::Motion{{{0, {{1, 2, 3}, {}}}, {4, {{5, 6, 7}, {}}}}, 1.5, false};
    setup.instances.push_back(instance);
  }
  return setup;
}

TEST(ModelBytes, WhatIsReadWritesTheSameBytesAndSharesModels) {
  const auto bytes = bytes_of(full_setup());
  model::Setup read;
  ByteReader r(bytes);
  ASSERT_TRUE(read_setup(r, read));
  EXPECT_EQ(r.remaining(), 0u);
  EXPECT_EQ(bytes_of(read), bytes);
  ASSERT_EQ(read.instances.size(), 2u);
  EXPECT_EQ(read.instances[0].model, read.instances[1].model) << "one model, twice used";
  // Spot checks that the bytes carry the values, not only themselves.
  const model::Model& m = *read.instances[0].model;
  EXPECT_EQ(m.links[1].name, "arm");
  EXPECT_EQ(std::get<Capsule>(m.links[0].collisions[3].shape).length_m, 0.6);
  EXPECT_EQ(*m.links[0].collisions[0].surface.soft_cfm, 1e-5);
  for (const model::Surface& s : {m.links[1].collisions[2].surface, read.zones.at(0).surface}) {
    EXPECT_EQ(s.stiffness_N_per_m, 3000);
    EXPECT_EQ(s.damping_N_s_per_m, 4);
    EXPECT_EQ(s.max_correction_mps, 0.5);
    EXPECT_EQ(s.substance, (model::Substance{0.9, 0.02, 50, 0.6}));
    EXPECT_EQ(s.skin->axis, (Vec3{0, 1, 0}));
    EXPECT_EQ(s.skin->ratio, 0.1);
    EXPECT_EQ(s.rolling_resistance_m, 0.003);
    EXPECT_EQ(s.belt_velocity_mps, (Vec3{0.7, 0.1, 0.2}));
    EXPECT_FALSE(s.touches);
  }
  EXPECT_EQ(read.zones[0].name, "ice");
  EXPECT_EQ(read.zones[0].outline_W, (std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 0}}));
  EXPECT_EQ(read.zones[0].centre_W, (Vec3{9, 8, 7}));
  EXPECT_EQ(read.zones[0].radius_m, 6);
  EXPECT_EQ(m.joints[0].spring_reference, 0.8);
  EXPECT_EQ(m.devices[0].config.find("list")->items()[0].text(), "1.5");
  EXPECT_EQ(read.stop->s(), 12);
  EXPECT_FALSE(m.links[0].gravity);
  const auto mesh = std::get<Mesh>(m.links[0].collisions[7].shape).mesh;
  EXPECT_EQ(mesh, std::get<Mesh>(m.links[1].visuals[7].shape).mesh) << "one mesh, four times used";
  EXPECT_EQ(mesh->parts.at(0).texture, "wood.png");
  EXPECT_EQ(std::get<Heightfield>(m.links[0].visuals[8].shape).grid->at(1, 2), 5.0f);
  EXPECT_EQ(m.links[0].visuals[0].material.emissive.g, 0.5f);
  EXPECT_EQ(m.joints[0].mimic->offset, 0.1);
  EXPECT_EQ(m.joints[0].rollers->count, 7);
  EXPECT_EQ(m.joints[0].rollers->surface.mu, 0.3);
  EXPECT_EQ(m.joints[0].roller_of, 0u);
  EXPECT_EQ(m.devices[0].scope, "arm::");
  EXPECT_EQ(read.instances[1].motion->keys.at(1).X_WM.p.y, 6);
  EXPECT_EQ(read.geography->elevation_m, 300);
}

TEST(ModelBytes, EveryTruncationIsRefused) {
  const auto bytes = bytes_of(full_setup());
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    model::Setup read;
    ByteReader r(std::span<const std::byte>(bytes).first(cut));
    EXPECT_FALSE(read_setup(r, read)) << cut;
  }
}

TEST(ModelBytes, IndicesOutOfTheModelAndNumbersThatAreNoneAreRefused) {
  for (int broken = 0; broken < 24; ++broken) {
    model::Setup setup = full_setup();
    auto changed = std::make_shared<model::Model>(*setup.instances[0].model);
    if (broken == 0) changed->joints[0].child = 2;
    if (broken == 1) changed->frames[0].link = 7;
    if (broken == 2) changed->devices[0].link = 2;
    if (broken == 3) changed->links.clear();
    if (broken == 4) changed->joints[0].mimic->joint = 1;
    if (broken == 5) changed->lights[0].link = 2;
    if (broken == 6) setup.instances[1].motion->keys.clear();
    if (broken == 7) {
      auto torn = std::make_shared<TriangleMesh>(*std::get<Mesh>(changed->links[0].collisions[7].shape).mesh);
      torn->triangles[3][1] = 8;
      changed->links[0].collisions[7].shape = Mesh{torn};
    }
    if (broken == 8) setup.instances[0].X_WM.q = {1e300, 0, 0, 0};
    if (broken == 9) setup.instances[0].X_WM.q = {0, 0, 0, 0};
    if (broken == 10) changed->links[0].X_ML.p.x = std::numeric_limits<double>::infinity();
    if (broken == 11) setup.control_interval = 0;
    if (broken == 12) setup.substeps = 0;
    if (broken == 13) changed->joints[0].damping = std::numeric_limits<double>::quiet_NaN();
    if (broken == 14) setup.gravity.y = -std::numeric_limits<double>::infinity();
    if (broken == 15) changed->links[0].collisions[0].surface.mu = 1e300;
    if (broken == 16) setup.zones[0].outline_W[1].x = 1e17;
    if (broken == 17) changed->joints[0].max_effort = -1;
    if (broken == 18) changed->joints[0].lower = 2.5;
    if (broken == 19) changed->joints[0].second->friction = -1;
    if (broken == 20) changed->joints[0].max_velocity = -1;
    if (broken == 21) changed->joints[0].rollers->count = 1 << 30;
    if (broken == 22) setup.instances[0].devices.edit()[0].X_LS.q = {1, 0, -1e14, 0};
    if (broken == 23) changed->links[1].collisions[0].X_LC.q = {0, 0, 0, 0};
    setup.instances[0].model = changed;
    const auto bytes = bytes_of(setup);
    model::Setup read;
    ByteReader r(bytes);
    EXPECT_FALSE(read_setup(r, read)) << broken;
  }
}

}  // namespace
}  // namespace sandlot
