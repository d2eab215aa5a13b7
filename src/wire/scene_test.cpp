/// Scene for viewers, read back as a viewer reads it: by docs/viewer_protocol.md alone, from the JSON of the
/// world and the bytes.
#include "wire/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "base/random.h"
#include "messages/geometry_msgs.h"
#include "sim/test_world.h"

namespace sandlot::wire {
namespace {

using Json = nlohmann::json;
using test::advance;
using test::arena;
using test::build;

std::uint32_t serial_of(const Simulation& simulation, std::string_view name) {
  return static_cast<std::uint32_t>(simulation.find_entity(name)->serial);
}

/// Keeps the last frame.
struct Camera : Observer {
  explicit Camera(Simulation& s) : simulation(s) { simulation.add_observer(this); }
  ~Camera() override { simulation.remove_observer(this); }
  Wants wants() const override { return {.log = true, .links = true, .contacts = true}; }
  void on_frame(const std::shared_ptr<const Frame>& shown) override { frame = *shown; }
  Simulation& simulation;
  Frame frame;
};

struct Cursor {
  std::span<const std::byte> rest;
  template <class T>
  T take() {
    T value{};
    if (rest.size() < sizeof value) throw std::runtime_error("the message ends early");
    std::memcpy(&value, rest.data(), sizeof value);
    rest = rest.subspan(sizeof value);
    return value;
  }
  Vec3 vector() {
    const float x = take<float>(), y = take<float>(), z = take<float>();
    return {x, y, z};
  }
  Quat orientation() {
    std::uint64_t bits = 0;
    for (int i = 0; i < 6; ++i) bits |= std::uint64_t{take<std::uint8_t>()} << (8 * i);
    EXPECT_EQ(bits >> 47, 0u);
    const auto left_out = static_cast<std::size_t>(bits & 3);
    Quat q;
    double sum = 0;
    bits >>= 2;
    for (std::size_t i = 0; i < 4; ++i) {
      if (i == left_out) continue;
      q[i] = (static_cast<double>(bits & 0x7FFF) / 32767 * 2 - 1) / std::sqrt(2.0);
      sum += q[i] * q[i];
      bits >>= 15;
    }
    q[left_out] = std::sqrt(1 - sum);
    return q;
  }
};

Pose pose_of(const Json& j) { return {{j[0], j[1], j[2]}, {j[3], j[4], j[5], j[6]}}; }
Vec3 vec_of(const Json& j) { return {j[0], j[1], j[2]}; }

/// What the page holds: the world, and where each link of each instance is.
struct Viewer {
  Json world;
  std::map<std::uint32_t, std::vector<Pose>> X_WL;
  std::map<std::uint32_t, int> form;
  std::map<std::uint32_t, std::size_t> bytes;
  std::uint32_t count = 0;
  bool key = false;

  const Json& model_of(std::uint32_t id) const {
    for (const Json& instance : world["instances"])
      if (instance["id"] == id)
        for (const Json& model : world["models"])
          if (model["id"] == instance["model"]) return model;
    throw std::runtime_error("no instance " + std::to_string(id));
  }
  static Pose motion(const Json& joint, double x) {
    const Vec3 axis = vec_of(joint["axis"]);
    if (joint["type"] == "prismatic") return {x * axis, {}};
    Pose out{{}, quat_from_axis_angle(axis, x)};
    if (joint["type"] == "screw") out.p = joint["thread_pitch_m"].get<double>() * x / (2 * math::pi) * axis;
    return out;
  }
  void record(Cursor& c) {
    const std::size_t before = c.rest.size();
    const auto id = c.take<std::uint32_t>();
    const Json& model = model_of(id);
    const Json& links = model["links"];
    form[id] = c.take<std::uint8_t>();
    std::vector<Pose>& poses = X_WL[id];
    poses.assign(links.size(), {});
    poses[0].p = c.vector();
    poses[0].q = c.orientation();
    std::vector<std::optional<Pose>> X_PC(links.size());
    for (std::size_t i = 1; i < links.size(); ++i) {
      if (form[id] == 1 || links[i]["joint"] == -1) {
        poses[i].p = c.vector();
        poses[i].q = c.orientation();
        continue;
      }
      const Json& joint = model["joints"][links[i]["joint"].get<std::size_t>()];
      const Pose rest = inverse(pose_of(links[links[i]["parent"].get<std::size_t>()]["pose"])) *
                        pose_of(links[i]["pose"]);
      const Pose X_CJ = pose_of(joint["pose"]);
      const std::string type = joint["type"];
      Pose moved;
      if (type == "revolute" || type == "continuous")
        moved = motion(joint, c.take<std::uint16_t>() * 2 * math::pi / 65536);
      else if (type == "prismatic" || type == "screw") moved = motion(joint, c.take<float>());
      else if (type != "fixed") moved.q = conjugate(X_CJ.q) * conjugate(rest.q) * c.orientation() * X_CJ.q;
      X_PC[i] = rest * X_CJ * moved * inverse(X_CJ);
    }
    // Parents may come later: as many rounds as there are links.
    for (std::size_t round = 0; round < links.size(); ++round)
      for (std::size_t i = 1; i < links.size(); ++i)
        if (X_PC[i]) poses[i] = poses[links[i]["parent"].get<std::size_t>()] * *X_PC[i];
    bytes[id] = before - c.rest.size();
  }
  void read(const Frame& frame, std::span<const std::byte> message, std::uint64_t epoch = 1) {
    Cursor c{message};
    EXPECT_EQ(c.take<std::uint8_t>(), 1);
    key = c.take<std::uint8_t>() == 1;
    EXPECT_EQ(c.take<std::uint16_t>(), epoch & 0xFFFF);
    EXPECT_EQ(c.take<std::uint32_t>(), frame.revision);
    EXPECT_EQ(c.take<std::uint64_t>(), frame.tick);
    EXPECT_EQ(c.take<std::int64_t>(), frame.now.ns);
    count = c.take<std::uint32_t>();
    bytes.clear();
    for (std::uint32_t i = 0; i < count; ++i) record(c);
    EXPECT_TRUE(c.rest.empty());
  }
};

double angle_between(Quat a, Quat b) {
  const Quat d = conjugate(normalised(a)) * normalised(b);
  return 2 * math::atan2(norm(Vec3{d.x, d.y, d.z}), std::abs(d.w));
}

// Half a step of 15 bits in +-1/sqrt(2) is 2.16e-5 in each of three components. The fourth, at least 0.5, is then off by at
// most 0.866 * sqrt(3) * 2.16e-5 / 0.5: together 7.5e-5 of a quaternion, twice that as an angle.
constexpr double orientation_rad = 1.5e-4;
// Half a step of a u16 angle.
constexpr double turn_rad = math::pi / 65536;

void expect_same(const Viewer& viewer, const Frame& frame, double slack_m, double slack_rad) {
  for (const FrameInstance& instance : frame.instances) {
    const auto found = viewer.X_WL.find(static_cast<std::uint32_t>(instance.serial));
    ASSERT_NE(found, viewer.X_WL.end()) << instance.name;
    ASSERT_EQ(found->second.size(), instance.X_WL.size());
    for (std::size_t i = 0; i < instance.X_WL.size(); ++i) {
      EXPECT_LE(norm(found->second[i].p - instance.X_WL[i].p), slack_m) << instance.name << " link " << i;
      EXPECT_LE(angle_between(found->second[i].q, instance.X_WL[i].q), slack_rad)
          << instance.name << " link " << i;
    }
  }
}

TEST(World, TellsWhatStandsInIt) {
  const auto simulation = build(arena("rigid", 2));
  advance(*simulation, 3);
  WorldJsonWriter writer{Assets()};
  const Json world = Json::parse(writer.write(*simulation, 5));
  EXPECT_EQ(world["epoch"], 5);
  EXPECT_EQ(world["revision"], simulation->revision());
  EXPECT_EQ(world["name"], "arena");
  EXPECT_EQ(world["engine"], "rigid");
  EXPECT_EQ(world["step_s"], 0.01);
  EXPECT_EQ(world["seed"], 7);
  EXPECT_EQ(world["gravity"], Json::parse("[0, 0, -9.81]"));
  // ground, wall, pillar, crate and rover, whatever stands in several places
  EXPECT_EQ(world["models"].size(), 5u);
  ASSERT_EQ(world["instances"].size(), 11u);
  const Json& rover = world["instances"][9];
  EXPECT_EQ(rover["name"], "rover1");
  EXPECT_EQ(rover["robot"], true);
  EXPECT_EQ(rover["model"], world["instances"][10]["model"]);
  EXPECT_EQ(rover["id"], serial_of(*simulation, "rover1"));
  EXPECT_EQ(world["instances"][0]["robot"], false);
  const Pose X_WM = simulation->engine().pose(*simulation->find_instance("rover1"));
  EXPECT_EQ(pose_of(rover["pose"]), X_WM);
  EXPECT_EQ(pose_of(rover["start"]), (Pose{{-2.5, -2.6, 0}, {}}));  // where the arena puts the first one
  EXPECT_NE(pose_of(rover["pose"]), pose_of(rover["start"]));
  ASSERT_EQ(rover["devices"].size(), 3u);
  EXPECT_EQ(rover["devices"][1],
            Json::parse(R"({"name":"laser","path":"rover1/laser","kind":"laser_scanner","link":0,
                            "pose":[0,0,0.12,1,0,0,0],"active":["ranges"],
                            "topics":[{"name":"/rover1/laser/ranges","type":"sensor_msgs/msg/LaserScan","level":"ranges"},
                                      {"name":"/rover1/laser/segments","type":"sandlot_msgs/msg/LineSegmentArray","level":"segments"},
                                      {"name":"/rover1/laser/pose","type":"geometry_msgs/msg/PoseWithCovarianceStamped","level":"pose"}],
                            "commands":[]})"));
  EXPECT_THAT(rover["devices"][0]["commands"].dump(), testing::HasSubstr("geometry_msgs/msg/Twist"));
  EXPECT_EQ(rover["controllers"],
            Json::parse(R"([{"name":"controller","path":"rover1/controller","kind":"wander"}])"));
  std::vector<std::string> kinds;
  for (const auto& [name, kind] : world["kinds"].items()) kinds.push_back(name);
  EXPECT_THAT(kinds, testing::ElementsAre("diff_drive", "ground_truth", "laser_scanner", "wander"));
  const Json& laser = world["kinds"]["laser_scanner"];
  EXPECT_EQ(laser["levels"][0]["name"], "ranges");
  EXPECT_EQ(laser["levels"][0]["message"], "sensor_msgs/msg/LaserScan");
  bool found = false;
  for (const Json& field : laser["fields"]) {
    if (field["path"] != "noise/white") continue;
    found = true;
    EXPECT_EQ(field["type"], "number");
    EXPECT_EQ(field["tunable"], true);
    EXPECT_EQ(field["min"], 0);
    EXPECT_EQ(field["default"], "0");
    EXPECT_EQ(field["choices"], Json::array());
    EXPECT_EQ(field["length"], 0);
  }
  EXPECT_TRUE(found);
  const Json& model = world["models"][4];
  EXPECT_EQ(model["name"], "rover");
  EXPECT_EQ(model["static"], false);
  EXPECT_EQ(model["links"][0]["joint"], -1);
  EXPECT_EQ(model["links"][1]["parent"], 0);
  EXPECT_EQ(model["links"][1]["joint"], 0);
  EXPECT_EQ(model["joints"][0]["child"], 1);
  EXPECT_EQ(world["models"][0]["static"], true);
  EXPECT_EQ(world["models"][0]["links"][0]["collisions"][0]["shape"],
            Json::parse(R"({"type":"plane","normal":[0,0,1]})"));
}

TEST(World, HasZonesOfTheGroundWhereThereAreSome) {
  auto setup = arena("rigid", 2);
  WorldJsonWriter writer{Assets()};
  EXPECT_FALSE(Json::parse(writer.write(*build(setup), 1)).contains("zones"));
  setup.zones.push_back({"ice", {{1, 2, 0}, {3, 2, 0}, {1, 4, 0}}, {}, 0, {}, {}});
  setup.zones[0].surface.mu = 0.05;
  setup.zones.push_back({"belt", {}, {5, 6, 0}, 2, {}, {}});
  setup.zones[1].surface.belt_velocity_mps = {0.7, 0, 0};
  setup.zones[1].surface.touches = false;
  const Json zones = Json::parse(writer.write(*build(setup), 2))["zones"];
  EXPECT_EQ(zones[0],
            Json::parse(R"({"name":"ice","centre":[0,0,0],"radius_m":0,"corners":[[1,2,0],[3,2,0],[1,4,0]],
    "friction":0.05,"rolling_resistance_m":0,"belt_velocity":[0,0,0],"hole":false})"));
  EXPECT_EQ(zones[1]["corners"], Json::array());
  EXPECT_EQ(zones[1]["radius_m"], 2);
  EXPECT_EQ(zones[1]["belt_velocity"], Json::parse("[0.7,0,0]"));
  EXPECT_EQ(zones[1]["hole"], true);
}

TEST(World, HasMarkersWithTheirCornersAndColours) {
  auto setup = arena("rigid", 1);
  WorldJsonWriter writer{Assets()};
  EXPECT_FALSE(Json::parse(writer.write(*build(setup), 1)).contains("markers"));
  const auto numbers = [](std::initializer_list<const char*> texts) {
    Node out = Node::sequence();
    for (const char* text : texts) out.push(Node::scalar(text));
    return out;
  };
  Node config = Node::map();
  Node corners = Node::sequence();  // clockwise: they come the other way round
  for (const auto& corner : {numbers({"0", "0"}), numbers({"0", "1"}), numbers({"2", "0"})})
    corners.push(corner);
  config.set("corners", corners);
  config.set("color", numbers({"1", "0.5", "0"}));
  setup.markers.push_back({"goal", "polygon", config, {}});
  const Json markers = Json::parse(writer.write(*build(setup), 2))["markers"];
  EXPECT_EQ(
      markers,
      Json::parse(
          R"([{"name":"goal","color":[1,0.5,0,1],"painted":false,"outlines":[[[2,0,0],[0,1,0],[0,0,0]]]}])"));
}

TEST(World, NumbersStayWhenTheWorldIsBuiltAnew) {
  const auto simulation = build(arena("rigid", 2));
  WorldJsonWriter writer{Assets()};
  const Json first = Json::parse(writer.write(*simulation, 1));
  const auto again = test::again(*simulation);
  const Json second = Json::parse(writer.write(*again, 2));
  EXPECT_EQ(second["models"], first["models"]);
  EXPECT_EQ(second["instances"], first["instances"]);
  // A model that is gone frees nothing for others: its number is not given out again.
  again->submit(DeleteRequest{"crate1"});
  again->submit(DeleteRequest{"crate2"});
  again->submit(SpawnRequest{test::placed("ball", test::one_shape("ball", Sphere{0.1}, 1), {{0, 0, 1}, {}})});
  advance(*again, 1);
  const Json third = Json::parse(writer.write(*again, 2));
  EXPECT_GT(third["revision"], second["revision"]);
  std::set<std::string> before, after;
  for (const Json& model : first["models"]) before.insert(model["id"]);
  for (const Json& model : third["models"]) {
    if (model["name"] == "ball") { EXPECT_EQ(before.count(model["id"]), 0u); }
    if (model["name"] == "rover") { EXPECT_EQ(before.count(model["id"]), 1u); }
    EXPECT_NE(model["name"], "crate");
  }
  EXPECT_EQ(third["models"].size(), 5u);
}

TEST(Poses, OfARunningWorldAreWhereTheEngineHasThem) {
  for (const char* engine : {"rigid", "planar"}) {
    const auto simulation = build(arena(engine, 4));
    Camera camera(*simulation);
    Viewer viewer;
    WorldJsonWriter world_writer{Assets()};
    viewer.world = Json::parse(world_writer.write(*simulation, 1));
    PoseWriter writer;
    std::vector<std::byte> out;
    for (int i = 0; i < 80; ++i) {
      advance(*simulation, 1);
      writer.write(camera.frame, 1, false, out);
      viewer.read(camera.frame, out);
      EXPECT_EQ(viewer.key, i == 0);
      // By joints, links may be 1 mm and 0.01 rad off: that much the engine's joints give way.
      expect_same(viewer, camera.frame, 1e-3, 0.01);
      for (const auto& [id, size] : viewer.bytes) {
        const std::string name = viewer.model_of(id)["name"];
        if (name != "rover") continue;
        EXPECT_EQ(viewer.form[id], 0) << engine;
        EXPECT_EQ(size, 27u);  // 4 id, 1 form, 12 position, 6 orientation, 2 x 2 wheels
      }
    }
    // Two lone crates at rest, ground, walls and pillars: sent once. The rovers drive.
    EXPECT_LE(viewer.count, 6u) << engine;
    EXPECT_GE(viewer.count, 4u) << engine;
    EXPECT_TRUE(writer.write(camera.frame, 1, true, out));
    viewer.read(camera.frame, out);
    EXPECT_TRUE(viewer.key);
    EXPECT_EQ(viewer.count, camera.frame.instances.size());
    EXPECT_FALSE(writer.write(camera.frame, 1, false, out));
    EXPECT_EQ(out.size(), 28u);
    EXPECT_TRUE(writer.write(camera.frame, 65536 + 2, false, out));
    viewer.read(camera.frame, out, 65536 + 2);
    EXPECT_TRUE(viewer.key) << "another epoch begins anew";
  }
}

TEST(Poses, AThingThatIsPutElsewhereIsSentEvenIfItNeverMoves) {
  const auto simulation = build(arena("rigid", 0));
  Camera camera(*simulation);
  advance(*simulation, 200);  // until the crates rest
  Viewer viewer;
  viewer.world = Json::parse(WorldJsonWriter{Assets()}.write(*simulation, 1));
  PoseWriter writer;
  std::vector<std::byte> out;
  writer.write(camera.frame, 1, true, out);
  viewer.read(camera.frame, out);
  simulation->submit(PoseRequest{"pillar1", {{2, -1, 0.5}, quat_from_rpy(0, 0, 1)}});
  advance(*simulation, 1);
  EXPECT_TRUE(writer.write(camera.frame, 1, false, out));
  viewer.read(camera.frame, out);
  EXPECT_EQ(viewer.bytes.count(serial_of(*simulation, "pillar1")), 1u);
  expect_same(viewer, camera.frame, 1e-3, 0.01);
}

/// Links on joints of all types, some before the links that carry them.
std::shared_ptr<model::Model> gadget() {
  auto made = std::make_shared<model::Model>();
  made->name = "gadget";
  const auto add_link = [&](const char* name, Pose X_ML) {
    model::Link link;
    link.name = name;
    link.X_ML = X_ML;
    made->links.push_back(std::move(link));
  };
  add_link("base", {{0.1, 0.2, 0.3}, quat_from_rpy(0.1, 0.2, 0.3)});
  add_link("finger",
           {{0.5, 0.2, 0.3}, quat_from_rpy(-0.4, 0, 1)});  // carried by the slider, which comes later
  add_link("slider", {{0.4, 0, 0.3}, quat_from_rpy(0, 0.5, 0)});
  add_link("head", {{0.1, 0.2, 0.9}, quat_from_rpy(1, 0, 0)});
  add_link("eye", {{0.15, 0.25, 0.95}, quat_from_rpy(0, 0, -2)});
  add_link("cardan", {{-0.3, 0.2, 0.3}, quat_from_rpy(0.3, 0.3, 0.3)});
  add_link("nut", {{-0.3, 0.4, 0.3}, quat_from_rpy(0.2, -0.3, 0.3)});
  add_link("loose", {{0, 0, 2}, {}});
  add_link("hung", {{0, 1, 2}, {}});
  const auto add_joint = [&](model::JointType type, std::uint32_t parent, std::uint32_t child) {
    model::Joint joint;
    joint.name = made->links[child].name + "_joint";
    joint.type = type;
    joint.parent = parent;
    joint.child = child;
    joint.X_CJ = {{0.02, -0.03, 0.04}, quat_from_rpy(0.2, 0.1 * child, -0.3)};
    joint.axis_J = normalised(Vec3{1, 2, -2});
    joint.thread_pitch_m = type == model::JointType::screw ? 0.005 : 0;
    made->joints.push_back(std::move(joint));
  };
  add_joint(model::JointType::revolute, 2, 1);
  add_joint(model::JointType::prismatic, 0, 2);
  add_joint(model::JointType::ball, 0, 3);
  add_joint(model::JointType::fixed, 3, 4);
  add_joint(model::JointType::universal, 0, 5);
  made->joints.back().second = model::SecondAxis{.axis_J = normalised(Vec3{2, -2, -1})};
  add_joint(model::JointType::screw, 5, 6);
  add_joint(model::JointType::revolute, model::world_link, 8);
  add_joint(model::JointType::revolute, 1, 3);  // a second joint of the head
  return made;
}

struct Posed {
  Frame frame;
  Viewer viewer;
  PoseWriter writer;
  std::vector<std::byte> out;
  void show() {
    writer.write(frame, 1, true, out);
    viewer.read(frame, out);
  }
};

/// A gadget somewhere, with its world as JSON.
Posed posed_at_rest(const std::shared_ptr<model::Model>& model) {
  model::Setup setup;
  setup.instances.push_back(test::placed("gadget", model, {}));
  Diagnostics diagnostics;
  const auto simulation = Simulation::create(std::move(setup), {}, diagnostics);
  EXPECT_TRUE(simulation) << simulation.error().text();
  Posed out;
  out.viewer.world = Json::parse(WorldJsonWriter{Assets()}.write(**simulation, 1));
  FrameInstance instance;
  instance.name = "gadget";
  instance.serial = serial_of(**simulation, "gadget");
  instance.model = (*simulation)->entities().front()->instance.model;
  instance.X_WL.resize(model->links.size());
  out.frame.revision = (*simulation)->revision();
  out.frame.instances.push_back(instance);
  return out;
}

/// A joint's pose of the child in the parent at a position, from what model.h says.
Pose moved(const model::Model& model, std::uint32_t joint, const Pose& motion) {
  const model::Joint& j = model.joints[joint];
  return inverse(model.links[j.parent].X_ML) * model.links[j.child].X_ML * j.X_CJ * motion * inverse(j.X_CJ);
}

TEST(Poses, JointsOfEveryTypeAreSentAsPositions) {
  const auto model = gadget();
  Posed posed = posed_at_rest(model);
  const Vec3 axis = model->joints[0].axis_J;
  std::vector<Pose>& X = posed.frame.instances[0].X_WL;
  const double turns[] = {0, 0.7, -0.7, 3.1, -3.1, math::pi, 2.5};
  const double screwed[] = {0, 3, -3, 20, -20.5, 1000, 3.2};
  for (int i = 0; i < 7; ++i) {
    const double a = turns[i];
    X[0] = {{10, -20, 0.5}, quat_from_rpy(a, 0.3 * a, -0.8)};
    X[2] = X[0] * moved(*model, 1, {0.1 * a * axis, {}});
    X[1] = X[2] * moved(*model, 0, {{}, quat_from_axis_angle(axis, a)});
    X[3] = X[0] * moved(*model, 2, {{}, quat_from_rpy(a, 1, 2 * a)});
    X[4] = X[3] * moved(*model, 3, {});
    X[5] = X[0] * moved(*model, 4, {{}, quat_from_rpy(a, 0.2, 0)});
    X[6] = X[5] * moved(*model, 5,
                        {0.005 * screwed[i] / (2 * math::pi) * axis, quat_from_axis_angle(axis, screwed[i])});
    X[7] = {{1, 2, 3}, quat_from_rpy(a, a, a)};
    X[8] = {{-1, 2, 3}, quat_from_rpy(0, a, a)};
    posed.show();
    const auto id = static_cast<std::uint32_t>(posed.frame.instances[0].serial);
    EXPECT_EQ(posed.viewer.form[id], 0) << a;
    // 5 head; 18 base; 2 finger; 4 slider; 6 head; 0 eye; 6 cardan; 4 nut; 18 loose; 18 hung
    EXPECT_EQ(posed.viewer.bytes[id], 81u);
    // Two orientations in the longest chain, or one and an angle; links are within 1 m of the base, whose own position of up
    // to 20 m is a float: 2^-24 * 20 m. The nut's turn of up to 1000 rad is one as well: 3e-5 rad.
    expect_same(posed.viewer, posed.frame, 2 * orientation_rad * 1.0 + 4e-6,
                2 * orientation_rad + 2 * turn_rad);
  }
}

TEST(Poses, WhatJointsDoNotDetermineIsSentLinkByLink) {
  const auto model = test::rover_model();
  Posed posed = posed_at_rest(model);
  std::vector<Pose>& X = posed.frame.instances[0].X_WL;
  const auto id = static_cast<std::uint32_t>(posed.frame.instances[0].serial);
  const Pose off_axis{{}, quat_from_axis_angle(normalised(Vec3{1, 0, 1}), 0.03)};
  const struct {
    Pose error;
    int form;
  } cases[] = {{{}, 0},
               {{{0.0005, 0, 0}, {}}, 0},  // within 1 mm
               {{{0.005, 0, 0}, {}}, 1},   // a wheel that was pulled 5 mm off
               {off_axis, 1}};
  for (const auto& [error, form] : cases) {
    for (std::size_t i = 0; i < X.size(); ++i)
      X[i] = Pose{{3, 1, 0}, quat_from_rpy(0, 0, 2)} * model->links[i].X_ML;
    X[1] = X[1] * error;
    posed.show();
    if (form >= 0) { EXPECT_EQ(posed.viewer.form[id], form); }
    if (form == 1) {
      EXPECT_EQ(posed.viewer.bytes[id], 5u + 3 * 18);
      expect_same(posed.viewer, posed.frame, 4e-7 * 3, orientation_rad);
    } else {
      expect_same(posed.viewer, posed.frame, 1e-3, 0.01);
    }
  }
}

TEST(Poses, OrientationsOfAllSortsKeepTheirPrecision) {
  Posed posed = posed_at_rest(test::one_shape("crate", Box{{1, 1, 1}}, 1));
  Pose& X = posed.frame.instances[0].X_WL[0];
  X.p = {1e300, -1e5, 1e-3};  // a float has no room for the first
  Stream stream(1, 2, Purpose::placement, 3);
  for (int i = 0; i < 500; ++i) {
    X.q = {stream.uniform(-1, 1), stream.uniform(-1, 1), stream.uniform(-1, 1), stream.uniform(-1, 1)};
    if (i < 32)  // edges: signs, zeros, and components of one magnitude
      X.q = {(i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2 & 1) * 0.5, (i >> 3 & 1) * (i & 16 ? -0.5 : 0.5)};
    X.q = normalised(X.q);
    posed.show();
    const auto& shown = posed.viewer.X_WL.begin()->second[0];
    EXPECT_LE(angle_between(shown.q, X.q), orientation_rad) << i;
    EXPECT_NEAR(norm(shown.q), 1, 1e-12);
    EXPECT_EQ(shown.p.y, -1e5);
    EXPECT_GT(shown.p.x, 3e38);
  }
}

TEST(Contacts, AreSentAsFloats) {
  Frame frame;
  frame.tick = 7;
  frame.now = Time{70'000'000};
  std::vector<std::byte> out;
  write_contacts(frame, out);
  EXPECT_EQ(out.size(), 20u);
  Contact contact;
  contact.point_W = {1, 2, 3};
  contact.normal_W = {0, 0, 1};
  contact.depth_m = 0.25;
  frame.contacts = {contact, contact};
  write_contacts(frame, out);
  ASSERT_EQ(out.size(), 20u + 2 * 28);
  Cursor c{out};
  EXPECT_EQ(c.take<std::uint64_t>(), 7u);
  EXPECT_EQ(c.take<std::int64_t>(), 70'000'000);
  EXPECT_EQ(c.take<std::uint32_t>(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(c.vector(), (Vec3{1, 2, 3}));
    EXPECT_EQ(c.vector(), (Vec3{0, 0, 1}));
    EXPECT_EQ(c.take<float>(), 0.25f);
  }
}

TEST(Commands, SayWhatCameFromOutside) {
  const auto simulation = build(arena("rigid", 1));
  Camera camera(*simulation);
  advance(*simulation, 6);
  EXPECT_EQ(commands_json(camera.frame), "") << "a controller's orders are left out";
  const auto said = [&](Request request) {
    simulation->submit(std::move(request), {Source::Kind::robot, 3});
    advance(*simulation, 1);
    const Json all = Json::parse(commands_json(camera.frame));
    EXPECT_EQ(all["commands"].size(), 1u);
    return all["commands"][0];
  };
  const Json noise = said(ParameterRequest{"rover1/laser", "noise/white", Node::scalar("0.02")});
  EXPECT_EQ(noise["tick"], camera.frame.tick);
  EXPECT_EQ(noise["time_s"], camera.frame.now.s());
  EXPECT_EQ(noise["source"], "robot");
  EXPECT_EQ(noise["id"], serial_of(*simulation, "rover1")) << "the robot that it drives";
  EXPECT_EQ(noise["kind"], "parameter");
  EXPECT_EQ(noise["target"], "rover1/laser");
  EXPECT_EQ(noise["text"], "noise/white = 0.02");
  EXPECT_EQ(noise["refused"], false);
  EXPECT_EQ(noise["why"], "");
  const Json wrong = said(ParameterRequest{"rover1/lasser", "noise/white", Node::scalar("0.02")});
  EXPECT_EQ(wrong["refused"], true);
  EXPECT_EQ(wrong["why"], "there is no device or program 'rover1/lasser'");
  EXPECT_EQ(said(PoseRequest{"crate1", {{1, 2, 0.25}, {}}})["text"], "pose 1 2 0.25");
  EXPECT_EQ(said(PoseRequest{"crate1", {{1, 2, 0.25}, quat_from_rpy(0, 0, 0.5)}})["text"],
            "pose 1 2 0.25 0.5");
  EXPECT_EQ(said(PoseRequest{"crate1", {{1, 2, 0.25}, quat_from_rpy(0.1, 0, 0.5)}})["text"]
                .get<std::string>()
                .substr(0, 17),
            "pose 1 2 0.25 0.1");
  EXPECT_EQ(said(LevelRequest{"rover1/laser", {"ranges"}})["text"], "level ranges");
  EXPECT_EQ(said(SpawnRequest{
                test::placed("ball", test::one_shape("sphere", Sphere{0.1}, 1), {{0, 0, 3}, {}})})["text"],
            "add sphere at 0 0 3");
  EXPECT_EQ(said(PullRequest{"crate1", "", {0, 0, 0.1}, {1, 2, 3}})["text"], "pull 0 0 0.1 1 2 3");
  EXPECT_EQ(said(PullRequest{"crate1", "", {}, {}, Time{}})["text"], "pull off");
  EXPECT_EQ(said(SampleRequest{"rover1/truth"})["text"], "sample");
  EXPECT_EQ(said(DeleteRequest{"ball"})["kind"], "delete");
  ByteWriter w;
  msg::Twist twist;
  twist.linear.x = 0.5;
  write(w, twist);
  const Json drive = said(CommandRequest{"rover1/drive", "geometry_msgs/msg/Twist", w.buffer()});
  EXPECT_EQ(drive["text"], "Twist linear 0.5 0 0 angular 0 0 0");
  EXPECT_EQ(drive["kind"], "command");
  // Whatever a recording says, there are words for it.
  EXPECT_EQ(describe_request({.kind = 5, .bytes = {std::byte{77}}}), "pose");
  EXPECT_EQ(describe_request({.kind = 99}), "unknown");
  LogEntry large;
  large.kind = 1;
  ByteWriter bytes;
  write_request(bytes, ParameterRequest{"a", "b", Node::scalar(std::string(100'000, 'x'))});
  large.bytes = bytes.buffer();
  EXPECT_LT(describe_request(large).size(), 400u);
}

}  // namespace
}  // namespace sandlot::wire
