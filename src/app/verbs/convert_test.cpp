/// Files turned into each other: nothing is lost on the way, and what is lost is said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "app/commands.h"
#include "base/bytes.h"
#include "base/math.h"
#include "base/test_folder.h"
#include "base/text.h"
#include "formats/sdf/sdf.h"
#include "formats/sdf/write.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "model/model_bytes.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

using testing::HasSubstr;

struct Folder : test::TestFolder {
  Folder() { std::filesystem::create_directory(path / "sub"); }
};

struct Converted {
  int exit_code;
  std::string printed;
};
Converted convert(const std::string& in, const std::string& out, bool force = false) {
  testing::internal::CaptureStderr();
  const int code = app::convert({.in = in, .out = out, .force = force});
  return {code, testing::internal::GetCapturedStderr()};
}

model::Setup loaded(const std::string& path) {
  Diagnostics diagnostics;
  auto setup = load(path, {}, diagnostics);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error().text());
  return setup ? std::move(*setup) : model::Setup{};
}

/// The keys of a device in one order: that of an element's children is the order of their lines. The file that a plugin
/// names is called differently from another folder.
void sort_keys(Node& node) {
  node.erase("parameters");
  for (Node& item : node.items()) sort_keys(item);
  for (Node::Entry& entry : node.entries()) sort_keys(entry.value);
  std::sort(node.entries().begin(), node.entries().end(),
            [](const auto& a, const auto& b) { return a.key < b.key; });
}

/// Everything but the places and the name of the file: what a snapshot keeps of a world.
std::vector<std::byte> bytes_of(model::Setup setup) {
  setup.name.clear();
  std::vector<const model::Instance*> instances;
  for (model::Instance& each : setup.instances) {
    model::Model model = *each.model;
    for (auto* const devices : {&model.devices, &each.devices.edit()})
      for (model::DeviceDecl& device : *devices) sort_keys(device.config);
    each.model = std::make_shared<model::Model>(std::move(model));
  }
  for (const model::Instance& each : setup.instances) instances.push_back(&each);
  ByteWriter w;
  write_setup(w, setup, instances);
  const auto bytes = w.bytes();
  return {bytes.begin(), bytes.end()};
}
std::vector<std::byte> bytes_of(const model::Model& model) {
  model::Setup setup;
  setup.instances.push_back({.name = "m", .model = std::make_shared<model::Model>(model)});
  return bytes_of(setup);
}

/// A differential robot as ROS people write it: a footprint and sensor frames without mass, fixed joints, a pan head whose
/// second joint follows the first.
std::string turtle() {
  const std::string wheel =
      "<inertial><mass value='0.03'/><inertia ixx='2e-5' ixy='0' ixz='0' iyy='2e-5' iyz='0' "
      "izz='3e-5'/></inertial>"
      "<collision><geometry><cylinder radius='0.033' length='0.018'/></geometry></collision>";
  const std::string small =
      "<inertial><origin xyz='0 0 0.02'/><mass value='0.05'/><inertia ixx='1e-5' ixy='0' ixz='0' iyy='1e-5' "
      "iyz='0' "
      "izz='1e-5'/></inertial>";
  return R"(<robot name="turtle">
  <material name="dark"><color rgba="0.2 0.2 0.25 1"/></material>
  <link name="base_footprint"/>
  <joint name="base_joint" type="fixed"><parent link="base_footprint"/><child link="base_link"/>
    <origin xyz="0 0 0.010"/></joint>
  <link name="base_link">
    <inertial><origin xyz="-0.01 0 0.05" rpy="0.1 0 0"/><mass value="1.2"/>
      <inertia ixx="0.008" ixy="0" ixz="0.0001" iyy="0.008" iyz="0" izz="0.012"/></inertial>
    <visual><origin xyz="-0.03 0 0.06"/><geometry><box size="0.14 0.14 0.1"/></geometry><material name="dark"/></visual>
    <collision><origin xyz="-0.03 0 0.06"/><geometry><box size="0.14 0.14 0.1"/></geometry></collision></link>
  <joint name="left" type="continuous"><origin xyz="0 0.08 0.023" rpy="-1.57 0 0"/>
    <parent link="base_link"/><child link="left_wheel"/><axis xyz="0 0 1"/></joint>
  <link name="left_wheel">)" +
         wheel + R"(</link>
  <joint name="right" type="continuous"><origin xyz="0 -0.08 0.023" rpy="-1.57 0 0"/>
    <parent link="base_link"/><child link="right_wheel"/><axis xyz="0 0 1"/></joint>
  <link name="right_wheel">)" +
         wheel + R"(</link>
  <joint name="caster" type="fixed"><origin xyz="-0.08 0 -0.004"/><parent link="base_link"/><child link="ball"/></joint>
  <link name="ball"><collision><geometry><sphere radius="0.006"/></geometry></collision></link>
  <joint name="scan_joint" type="fixed"><origin xyz="-0.032 0 0.18" rpy="0 0 0.3"/>
    <parent link="base_link"/><child link="scan_frame"/></joint>
  <link name="scan_frame"/>
  <joint name="pan" type="revolute"><origin xyz="0.03 0 0.11"/><parent link="base_link"/><child link="head"/>
    <axis xyz="0.1 0.2 1"/><limit lower="-0.5" upper="0.75" effort="1" velocity="2"/><dynamics damping="0.01" friction="0"/></joint>
  <link name="head">)" +
         small + R"(</link>
  <joint name="tilt" type="revolute"><origin xyz="0 0 0.04"/><parent link="head"/><child link="eye"/>
    <axis xyz="0 1 0"/><limit lower="-0.5" upper="0.5" effort="1" velocity="2"/><mimic joint="pan" multiplier="0.5" offset="0.1"/>
    <safety_controller soft_lower_limit="-0.4" soft_upper_limit="0.3" k_position="5" k_velocity="2"/></joint>
  <link name="eye">)" +
         small + R"(</link>
  <gazebo reference="ball"><mu1>0</mu1><mu2>0</mu2></gazebo>
  <gazebo reference="pan"><springStiffness>0.2</springStiffness><springReference>0.3</springReference></gazebo>
  <gazebo reference="scan_frame"><sensor name="scan" type="gpu_lidar"><update_rate>10</update_rate><lidar><scan><horizontal>
    <samples>36</samples><min_angle>-3</min_angle><max_angle>3</max_angle></horizontal></scan>
    <range><min>0.1</min><max>5</max></range><noise><type>gaussian</type><stddev>0.01</stddev></noise></lidar></sensor></gazebo>
  <gazebo><plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system"><left_joint>left</left_joint>
    <right_joint>right</right_joint><wheel_separation>0.16</wheel_separation><wheel_radius>0.033</wheel_radius></plugin></gazebo>
</robot>)";
}

/// Hash of 500 ticks on a floor with something to see.
std::uint64_t hash_of_run(const std::string& robot) {
  Diagnostics diagnostics;
  model::Setup setup = loaded("worlds/pile.sdf");
  setup.step = Time::from_s(0.01);
  setup.substeps = 5;
  auto instance = load_instance(robot, "turtle", {{0, 0, 0.002}, {}}, diagnostics);
  EXPECT_TRUE(instance) << (instance ? "" : instance.error().text());
  if (!instance) return 0;
  setup.instances.push_back(std::move(*instance));
  auto simulation = Simulation::create(std::move(setup), {}, diagnostics);
  EXPECT_TRUE(simulation) << (simulation ? "" : simulation.error().text());
  if (!simulation) return 0;
  for (int i = 0; i < 500; ++i) EXPECT_TRUE((*simulation)->tick());
  return (*simulation)->state_hash();
}

TEST(Convert, AUrdfRunsToTheSameHashAsSdf) {
  const Folder folder;
  const std::string urdf = folder.write("turtle.urdf", turtle()), sdf = folder.file("sub/turtle.sdf");
  const Converted done = convert(urdf, sdf);
  ASSERT_EQ(done.exit_code, 0) << done.printed;
  EXPECT_TRUE(bytes_of(loaded(urdf)) == bytes_of(loaded(sdf)));
  EXPECT_EQ(loaded(urdf).instances[0].model->links.size(), 8u) << "every frame of the URDF is kept";
  const std::uint64_t hash = hash_of_run(urdf);
  EXPECT_EQ(hash, hash_of_run(sdf));
  // The hash is not blind to the file.
  std::string other = turtle();
  other.replace(other.find("1.2"), 3, "1.3");
  EXPECT_NE(hash, hash_of_run(folder.write("other.urdf", other)));
}

TEST(Convert, AFileAsSdfIsTheSameWorld) {
  const Folder folder;
  for (const char* const file : {"worlds/indoor.sdf", "worlds/pile.sdf", "models/rover/model.sdf",
                                 "models/turtlebot/turtlebot.urdf", "models/mario/mario.urdf"}) {
    const Converted done = convert(file, folder.file("out.sdf"), true);
    ASSERT_EQ(done.exit_code, 0) << done.printed;
    EXPECT_TRUE(bytes_of(loaded(file)) == bytes_of(loaded(folder.file("out.sdf")))) << file;
  }
}

TEST(Convert, AModelWrittenFromItsFieldsReadsBackEqual) {
  for (const char* const file : {"worlds/indoor.sdf", "worlds/pile.sdf", "models/rover/model.sdf"}) {
    const model::Setup setup = loaded(file);
    Diagnostics diagnostics;
    auto root = formats::sdf_of(setup, diagnostics);
    ASSERT_TRUE(root) << root.error().text();
    const Folder folder;
    const model::Setup back = loaded(folder.write("back.sdf", formats::xml_text(*root)));
    ASSERT_EQ(back.instances.size(), setup.instances.size());
    for (std::size_t i = 0; i < setup.instances.size(); ++i) {
      model::Model was = *setup.instances[i].model, is = *back.instances[i].model;
      EXPECT_EQ(is.devices.size(), was.devices.size());
      was.devices = setup.instances[i].devices;  // the model keeps what the file called them
      is.devices = back.instances[i].devices;
      for (model::DeviceDecl& device : was.devices) device.sdf_types.clear();
      was.name = is.name;
      EXPECT_TRUE(bytes_of(is) == bytes_of(was)) << file << ": " << setup.instances[i].name;
    }
  }
}

/// Numbers without a short decimal form.
struct Random {
  std::uint64_t state;
  double operator()() {  // in [-1, 1)
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 11) / 4503599627370496.0 - 1;
  }
  int below(int n) { return static_cast<int>((*this)() * n / 2 + n / 2.0); }
  Vec3 vec() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }
  Pose pose() {
    const Vec3 p = 3 * vec(), a = vec();
    const double w = (*this)();
    return {p, normalised(Quat{w, a.x, a.y, a.z})};
  }
};

model::Model random_model(Random& random) {
  model::Model m;
  m.name = "m";
  m.self_collide = random() > 0;
  m.label = random() > 0 ? "40" : "";
  const char* const scopes[] = {"", "", "in::", "in::deep::", "other::"};
  for (const char* const scope : scopes)
    for (int i = 0, n = 1 + random.below(3); i < n; ++i) {
      model::Link link;
      link.name = scope + std::string("l") + std::to_string(m.links.size());
      link.X_ML = random.pose();
      link.gravity = random() > -0.5;
      link.inertial = {1.5 + random(), random.pose(), {1.25, 1.5, 1.75}, 0.05 * random.vec()};
      const Shape shapes[] = {Box{{1.5 + random(), 1.5, 2}}, Sphere{1.5 + random()},
                              Cylinder{1.5 + random(), 2}, Capsule{1.5 + random(), 0.75},
                              Plane{normalised(random.vec())}};
      for (const Shape& shape : shapes) {
        model::Collision c{"c" + std::to_string(link.collisions.size()), random.pose(), shape, {}, {}};
        c.surface.mu = 1 + random();
        c.surface.mu2 = random() > 0 ? c.surface.mu : 1 + random();
        if (random() > 0) c.surface.fdir1 = normalised(random.vec());
        if (random() > 0) c.surface.restitution = (1 + random()) / 2;
        if (random() > 0) c.surface.soft_erp = (1 + random()) / 2;
        if (random() > 0) c.surface.slip1 = 1 + random();
        if (random() > 0) {
          c.surface.stiffness_N_per_m = 1e6 * (1.5 + random());
          c.surface.damping_N_s_per_m = 1 + random();
          c.surface.max_correction_mps = 1 + random();
        }
        if (random() > 0) c.surface.substance = model::Substance{1 + random(), 0.01, 40, (1 + random()) / 2};
        if (random() > 0) c.surface.skin = model::Skin{normalised(random.vec()), 1 + random()};
        if (random() > 0) c.surface.rolling_resistance_m = 1 + random();
        if (random() > 0) c.surface.belt_velocity_mps = random.vec();
        c.surface.touches = random() > -0.5;
        link.collisions.push_back(c);
        model::Visual v{"v" + std::to_string(link.visuals.size()), random.pose(), shape, {}, true, {}};
        v.material.diffuse = {static_cast<float>((1 + random()) / 2), 0.1f, 0.7f, 1};
        v.material.from_mesh = false;
        link.visuals.push_back(v);
      }
      m.links.push_back(link);
    }
  // Links of one scope stand together, as readers leave them; so do joints.
  for (std::uint32_t l = 1; l < m.links.size(); ++l) {
    using Type = model::JointType;
    const auto scope_of = [&](std::uint32_t i) {
      return m.links[i].name.substr(0, m.links[i].name.rfind('l'));
    };
    if (scope_of(l) != scope_of(l - 1)) continue;
    model::Joint j;
    j.name = scope_of(l) + "j" + std::to_string(l);
    const Type types[] = {Type::fixed, Type::revolute, Type::continuous, Type::prismatic, Type::ball};
    j.type = types[random.below(5)];
    j.parent = random() > 0.8 ? model::world_link : l - 1;
    j.child = l;
    j.X_CJ = random.pose();
    if (j.type != Type::fixed && j.type != Type::ball) {
      j.axis_J = normalised(random.vec());
      if (j.type != Type::continuous && random() > 0) j.lower = random() - 2, j.upper = random() + 1;
      if (random() > 0) j.max_effort = 1.5 + random();
      if (random() > 0) j.damping = 1.5 + random(), j.spring_stiffness = 1.5 + random();
    }
    m.joints.push_back(j);
  }
  for (int i = 0; i < 3; ++i) {
    model::DeviceDecl device;
    device.name = "d" + std::to_string(i);
    device.kind = "no_matter";
    device.link = static_cast<std::uint32_t>(random.below(static_cast<int>(m.links.size())));
    device.X_LS = random.pose();
    device.config = Node::map();
    device.config.set("rate", Node::scalar(number_text(random())));
    Node list = Node::sequence();
    list.push(Node::scalar("a b, \"c\" <&>"));
    list.push(Node::scalar("2"));
    Node inner = Node::map();
    inner.set("list", std::move(list));
    inner.set("text", Node::scalar("x < y & z"));
    device.config.set("inner", std::move(inner));
    Node odd = Node::map();
    odd.set("not a name", Node::scalar("1"));
    device.config.set("odd", std::move(odd));
    m.devices.push_back(device);
  }
  return m;
}

TEST(Convert, RandomModelsReadBackEqualToTheLastBit) {
  Random random{7};
  for (int round = 0; round < 50; ++round) {
    model::Instance instance;
    instance.original_name = "m";
    instance.model = std::make_shared<model::Model>(random_model(random));
    instance.devices = instance.model->devices;
    instance.X_WM = random.pose();
    Diagnostics diagnostics;
    auto root = formats::sdf_of(instance, diagnostics);
    ASSERT_TRUE(root) << root.error().text();
    auto back = formats::parse_sdf(formats::xml_text(*root), "back.sdf", diagnostics);
    ASSERT_TRUE(back) << back.error().text() << formats::xml_text(*root);
    EXPECT_TRUE(diagnostics.warnings.empty()) << diagnostics.warnings.front().text();
    EXPECT_EQ(back->instances.at(0).X_WM, instance.X_WM);
    const auto is = bytes_of(*back->instances[0].model), was = bytes_of(*instance.model);
    const auto at = std::mismatch(is.begin(), is.end(), was.begin(), was.end()).first - is.begin();
    ASSERT_TRUE(is == was) << "from byte " << at << " of " << was.size() << "\n" << formats::xml_text(*root);
  }
}

TEST(Convert, SdfAsUrdfKeepsPosesOfAllThatIsVisible) {
  // Joints away from the origin of their child: the link's frame moves there, what it carries stays where it was.
  const Folder folder;
  const std::string body =
      "<inertial><pose>0.1 0 0 0 0 "
      "0</pose><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";
  const std::string sdf = folder.write(
      "arm.sdf",
      R"(<sdf version="1.9"><model name="arm"><link name="a">)" + body +
          R"(</link><link name="b"><pose>1 2 3 0.1 0.2 0.3</pose>)" + body +
          R"(<collision name="c"><pose>0.5 0 0 0 0 0.4</pose><geometry><box><size>1 2 3</size></box></geometry>
      <surface><friction><ode><mu>0.5</mu><mu2>0.25</mu2></ode></friction></surface></collision></link>
    <joint name="j" type="revolute"><parent>a</parent><child>b</child><pose>0 0 0.5 0.3 0 0</pose>
      <axis><xyz>0 0.6 0.8</xyz><limit><lower>-1</lower><upper>2</upper></limit><dynamics><spring_stiffness>3</spring_stiffness></dynamics></axis></joint>
    <frame name="tool" attached_to="b"><pose>0 0 1 0 0 0</pose></frame>
    <sandlot:device name="laser" kind="laser_scanner" link="b"><pose>0 0 0.25 0 0 0</pose><rate>5</rate></sandlot:device></model></sdf>)");
  const Converted done = convert(sdf, folder.file("arm.urdf"));
  ASSERT_EQ(done.exit_code, 0) << done.printed;
  EXPECT_EQ(done.printed, "");
  const model::Setup was = loaded(sdf), is = loaded(folder.file("arm.urdf"));
  const model::Model &m = *was.instances[0].model, &n = *is.instances[0].model;
  const auto near = [](const Pose& a, const Pose& b) {
    return norm(a.p - b.p) < 1e-14 && norm(rotate(a.q, {1, 2, 3}) - rotate(b.q, {1, 2, 3})) < 1e-14;
  };
  ASSERT_EQ(n.links.size(), 3u) << "the frame is a link";
  EXPECT_TRUE(near(n.links[1].X_ML, m.links[1].X_ML * m.joints[0].X_CJ));
  EXPECT_TRUE(near(n.links[1].X_ML * n.links[1].collisions.at(0).X_LC,
                   m.links[1].X_ML * m.links[1].collisions[0].X_LC));
  EXPECT_TRUE(near(n.links[1].X_ML * n.links[1].inertial.X_LCo, m.links[1].X_ML * m.links[1].inertial.X_LCo));
  EXPECT_TRUE(near(n.links[2].X_ML, m.links[1].X_ML * m.frames.at(0).X_LF));
  EXPECT_TRUE(near(n.links[1].X_ML * is.instances[0].devices.at(0).X_LS,
                   m.links[1].X_ML * was.instances[0].devices.at(0).X_LS));
  EXPECT_EQ(n.links[1].collisions[0].surface.mu2, 0.25);
  EXPECT_EQ(n.joints[0].axis_J, m.joints[0].axis_J);
  EXPECT_EQ(n.joints[0].upper, 2);
  EXPECT_EQ(n.joints[0].spring_stiffness, 3);
}

TEST(Convert, WhatUrdfCannotSayIsAnErrorWithItsReason) {
  const Folder folder;
  const auto refused = [&](const std::string& content, const std::string& reason) {
    const std::string body =
        "<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>";
    std::string text = "<sdf version='1.9'><model name='m'>";
    for (const char* const l : {"a", "b", "c"})
      text += "<link name='" + std::string(l) + "'>" + body + "</link>";
    const Converted done = convert(folder.write("m.sdf", text + content + "</model></sdf>"),
                                   folder.file("m.urdf"));
    EXPECT_EQ(done.exit_code, 2);
    EXPECT_THAT(done.printed, HasSubstr(reason));
    EXPECT_FALSE(std::filesystem::exists(folder.file("m.urdf")));
  };
  const auto joint = [](const std::string& name, const std::string& type, const std::string& p,
                        const std::string& c) {
    return "<joint name='" + name + "' type='" + type + "'><parent>" + p + "</parent><child>" + c +
           "</child><axis><xyz>0 0 1</xyz></axis></joint>";
  };
  refused(joint("ab", "fixed", "a", "b"), "link 'c' hangs from nothing, beside link 'a'");
  refused(joint("ab", "ball", "a", "b") + joint("ac", "fixed", "a", "c"),
          "joint 'ab' is of a type that URDF does not have");
  refused(joint("ab", "fixed", "a", "b") + joint("ac", "fixed", "a", "c") + joint("bc", "revolute", "b", "c"),
          "link 'c' is the child of joints 'ac' and 'bc'");
  refused(joint("bc", "fixed", "b", "c") + joint("cb", "revolute", "c", "b"), "the joints run in a circle");
  EXPECT_THAT(convert("worlds/indoor.sdf", folder.file("w.urdf")).printed, HasSubstr("is a world"));
  EXPECT_THAT(convert("scenarios/indoor.yaml", folder.file("w.urdf")).printed, HasSubstr("is a scenario"));
}

TEST(Convert, ScenariosOfWorldsAndRobotsRun) {
  const Folder folder;
  folder.write("turtle.urdf", turtle());
  ASSERT_EQ(convert(folder.file("turtle.urdf"), folder.file("sub/turtle.yaml")).exit_code, 0);
  const model::Setup robot = loaded(folder.file("sub/turtle.yaml"));
  ASSERT_EQ(robot.instances.size(), 2u) << "it stands on the ground";
  EXPECT_EQ(robot.instances[1].name, "turtle");
  ASSERT_EQ(convert("worlds/indoor.sdf", folder.file("indoor.yaml")).exit_code, 0);
  EXPECT_EQ(loaded(folder.file("indoor.yaml")).instances.size(),
            loaded("worlds/indoor.sdf").instances.size());
  // 1 ms is what a world without <physics> is stepped by; a tick is 10 ms.
  EXPECT_EQ(robot.substeps, 10);
  EXPECT_EQ(robot.step, Time::from_s(0.01));
}

TEST(Convert, ScenariosBecomeWorldsWithoutWhatSdfCannotSay) {
  const Folder folder;
  const Converted done = convert("scenarios/indoor.yaml", folder.file("all.sdf"));
  ASSERT_EQ(done.exit_code, 0) << done.printed;
  EXPECT_THAT(done.printed, HasSubstr("the controller of 'rover' cannot be said in SDF"));
  EXPECT_THAT(done.printed, HasSubstr("the stop time cannot be said in SDF"));
  const model::Setup was = loaded("scenarios/indoor.yaml"), is = loaded(folder.file("all.sdf"));
  ASSERT_EQ(is.instances.size(), was.instances.size());
  for (std::size_t i = 0; i < was.instances.size(); ++i) {
    EXPECT_EQ(is.instances[i].name, was.instances[i].name);
    EXPECT_NEAR(norm(is.instances[i].X_WM.p - was.instances[i].X_WM.p), 0, 1e-15);
    EXPECT_EQ(is.instances[i].devices.size(), was.instances[i].devices.size());
  }
}

TEST(Convert, MeshesAndTerrainKeepTheirFilesScalesAndHeights) {
  const Folder folder;
  std::filesystem::create_directory(folder.path / "meshes");
  // A tetrahedron in millimetres: 100 mm along each axis.
  folder.write("meshes/corner.obj",
               "o corner\nv 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  std::filesystem::copy_file("worlds/vineyard_heights.png", folder.path / "meshes/hills.png");
  folder.write("w.sdf", R"(<sdf version="1.9"><world name="w">
    <model name="hills"><static>true</static><link name="l"><collision name="c"><geometry>
      <heightmap><uri>meshes/hills.png</uri><size>8 6 0.5</size></heightmap></geometry></collision></link></model>
    <model name="stone"><pose>0 0 1 0 0 0</pose><link name="l">
      <inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial>
      <collision name="c"><geometry><mesh><uri>meshes/corner.obj</uri><submesh><name>corner</name><center>true</center></submesh>
        <scale>0.001 0.001 0.002</scale></mesh></geometry></collision></link></model>
  </world></sdf>)");
  folder.write("s.yaml", "version: 1\nworld: w.sdf\n");
  std::filesystem::create_directory(folder.path / "sub");
  const Converted done = convert(folder.file("s.yaml"), folder.file("sub/all.sdf"));
  ASSERT_EQ(done.exit_code, 0) << done.printed;
  const model::Setup was = loaded(folder.file("w.sdf")), is = loaded(folder.file("sub/all.sdf"));
  const auto shape = [](const model::Setup& setup, std::size_t i) -> const Shape& {
    return setup.instances.at(i).model->links.at(0).collisions.at(0).shape;
  };
  EXPECT_EQ(std::get<Heightfield>(shape(is, 0)).grid->height_m,
            std::get<Heightfield>(shape(was, 0)).grid->height_m);
  EXPECT_EQ(std::get<Heightfield>(shape(is, 0)).grid->size_y_m, 6);
  EXPECT_EQ(std::get<Mesh>(shape(is, 1)).mesh->vertices, std::get<Mesh>(shape(was, 1)).mesh->vertices);
  // 0.1 x 0.1 x 0.2 / 6 m^3
  EXPECT_NEAR(volume_m3(shape(is, 1)), 0.1 * 0.1 * 0.2 / 6, 1e-12);
}

TEST(Convert, TerrainOfABuilderBecomesAMeshBesideTheFile) {
  const Folder folder;
  const Converted done = convert("builder:terrain?size_x=2&size_y=1&cell=0.5", folder.file("hill.sdf"));
  ASSERT_EQ(done.exit_code, 0) << done.printed;
  Diagnostics diagnostics;
  const auto made = load_instance("builder:terrain?size_x=2&size_y=1&cell=0.5", "x", {}, diagnostics);
  const auto back = load_instance(folder.file("hill.sdf"), "x", {}, diagnostics);
  ASSERT_TRUE(made && back);
  const auto& grid = *std::get<Heightfield>(made->model->links[0].collisions[0].shape).grid;
  const auto& mesh = *std::get<Mesh>(back->model->links[0].collisions[0].shape).mesh;
  ASSERT_EQ(mesh.triangles.size(), 2u * 4 * 2) << "two for each cell of half a metre";
  for (const Vec3& v : mesh.vertices) EXPECT_NEAR(v.z, height_at(grid, v.x, v.y), 1e-6);
  // The second file is not replaced unasked either.
  std::filesystem::remove(folder.path / "hill.sdf");
  EXPECT_EQ(convert("builder:terrain", folder.file("hill.sdf")).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "hill.sdf"));
}

TEST(Convert, LightsOfNestedModelsKeepTheirNames) {
  const Folder folder;
  folder.write("robot.sdf", R"(<sdf version="1.9"><model name="robot"><link name="base"/>
    <model name="arm"><link name="hand"><light name="lamp" type="point"/></link></model></model></sdf>)");
  const std::string scenario = folder.write("s.yaml",
                                            "version: 1\nrobots:\n  - {name: r, model: robot.sdf}\n");
  ASSERT_EQ(convert(scenario, folder.file("world.sdf")).exit_code, 0);
  const model::Setup back = loaded(folder.file("world.sdf"));
  ASSERT_EQ(back.instances.back().model->lights.size(), 1u);
  EXPECT_EQ(back.instances.back().model->lights[0].light.name, "arm::lamp");
}

TEST(Convert, NeverReplacesAFileUnasked) {
  const Folder folder;
  const std::string urdf = folder.write("a.urdf", turtle());
  folder.write("a.sdf", "precious");
  const Converted refused = convert(urdf, folder.file("a.sdf"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.printed, HasSubstr("exists already; add --force"));
  EXPECT_EQ(folder.read("a.sdf"), "precious");
  EXPECT_EQ(convert(urdf, folder.file("a.sdf"), true).exit_code, 0);
  EXPECT_THAT(folder.read("a.sdf"), HasSubstr("<model name=\"turtle\""));
  EXPECT_EQ(convert(urdf, folder.file("nowhere/a.sdf")).exit_code, 2);
  EXPECT_EQ(convert(urdf, folder.file("a.txt")).exit_code, 2);
  const std::string bad = folder.write("bad.urdf", "<robot name='r'/>");
  EXPECT_EQ(convert(bad, folder.file("bad.sdf")).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.file("bad.sdf")));
}

TEST(Convert, PathsMeanTheSameFilesFromTheirNewPlace) {
  const Folder folder;
  std::filesystem::create_directory(folder.path / "meshes");
  folder.write("meshes/hull.stl", "solid x\nendsolid x\n");
  folder.write("a.urdf", R"(<robot name="r"><link name="l"><inertial><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
    <gazebo><plugin name="p" filename="p"><parameters>meshes/hull.stl</parameters></plugin></gazebo></robot>)");
  ASSERT_EQ(convert(folder.file("a.urdf"), folder.file("sub/a.sdf")).exit_code, 0);
  EXPECT_THAT(folder.read("sub/a.sdf"), HasSubstr("<parameters>../meshes/hull.stl</parameters>"));
  ASSERT_EQ(convert(folder.file("a.urdf"), folder.file("a.sdf")).exit_code, 0);
  EXPECT_THAT(folder.read("a.sdf"), HasSubstr("<parameters>meshes/hull.stl</parameters>"));
}

TEST(Convert, TextOfAnyKindSurvivesWriting) {
  Xml root;
  root.name = "sdf";
  root.set_attribute("version", "1.9 <&>\"'\n\t");
  Xml child;
  child.name = "a";
  child.text = "x < y && \"z\" > 'w' \xc3\xa9";
  root.children.push_back(child);
  const auto back = parse_xml(formats::xml_text(root, "two -- hyphens -"), "f", {});
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_EQ(*back->attribute("version"), *root.attribute("version"));
  EXPECT_EQ(back->children.at(0).text, child.text);
}

}  // namespace
}  // namespace sandlot
