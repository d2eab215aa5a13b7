/// Expected numbers follow from the definition of the formats by hand: see docs/eyesim_files.md.
#include "formats/eyesim/robi.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/math.h"
#include "formats/eyesim/shapes.h"

namespace sandlot::formats::eyesim {
namespace {

Robi robi(std::string_view text, Diagnostics& diagnostics) {
  auto robot = read_robi(text, "scout.robi", {}, diagnostics);
  EXPECT_TRUE(robot) << robot.error().text();
  return robot ? *robot : Robi{};
}
std::string robi_error(std::string_view text) {
  Diagnostics diagnostics;
  const auto robot = read_robi(text, "scout.robi", {}, diagnostics);
  return robot ? "none" : robot.error().text();
}
const model::DeviceDecl* device_named(const model::Instance& instance, std::string_view name) {
  for (const model::DeviceDecl& each : instance.devices)
    if (each.name == name) return &each;
  ADD_FAILURE() << "no device " << name;
  return nullptr;
}
double key(const model::DeviceDecl* decl, const char* name) {
  const Node* const node = decl ? decl->config.find(name) : nullptr;
  return node ? std::stod(node->text()) : -1e9;
}

constexpr const char* scout = R"(# a robot of ours
drive DIFFERENTIAL_DRIVE
name scout
mass 2.5 0 20 0
collider box 120 60 150 0 35 0
axis 0 0
wheel 54 1800 1100 90
psd PSD_FRONT 1 70 0 30 0
psd 2 PSD_LEFT 30 45 30 90
camera 60 0 60 0 10 60 46.83
lidar 360 180
)";

TEST(EyesimRobot, StandsOnItsWheelsWithItsDevices) {
  Diagnostics d;
  const Robi robot = robi(scout, d);
  EXPECT_TRUE(d.warnings.empty()) << d.warnings.front().text();
  const model::Instance& scout_robot = robot.instance;
  EXPECT_EQ(scout_robot.name, "scout");
  EXPECT_TRUE(scout_robot.is_robot);
  const model::Model& model = *scout_robot.model;
  // The axle is at the robot's own point, so that the point is a wheel's radius above the ground.
  const auto wheel = model.find_link("left_wheel");
  ASSERT_TRUE(wheel);
  EXPECT_NEAR(model.links[*wheel].X_ML.p.y, 0.045, 1e-12);
  EXPECT_NEAR(model.links[*wheel].X_ML.p.z, 0.027, 1e-12);
  // 1800 deg/s at a radius of 27 mm; turning on the spot both wheels together, over 90 mm.
  const double top_speed = 10 * 3.14159265358979323846 * 0.027;
  EXPECT_NEAR(key(device_named(scout_robot, "drive"), "max_linear_speed"), top_speed, 1e-12);
  EXPECT_NEAR(key(device_named(scout_robot, "drive"), "max_angular_speed"), 2 * top_speed / 0.09, 1e-12);
  EXPECT_EQ(key(device_named(scout_robot, "left_encoder"), "ticks_per_turn"), 1100);
  // x forward, y left, z up from the robot's point.
  const auto* const front = device_named(scout_robot, "PSD_FRONT");
  EXPECT_NEAR(front->X_LS.p.x, 0.07, 1e-12);
  EXPECT_NEAR(front->X_LS.p.z, 0.057, 1e-12);
  const auto* const left = device_named(scout_robot, "PSD_LEFT");
  EXPECT_NEAR(left->X_LS.p.y, 0.045, 1e-12);
  EXPECT_NEAR(rotate(left->X_LS.q, {1, 0, 0}).y, 1, 1e-12);
  EXPECT_EQ(robot.psds, (std::map<int, std::string>{{1, "PSD_FRONT"}, {2, "PSD_LEFT"}}));
  const auto* const camera = device_named(scout_robot, "camera");
  EXPECT_NEAR(rotate(camera->X_LS.q, {1, 0, 0}).z, math::sin(10 * M_PI / 180), 1e-12);  // it looks up
  EXPECT_EQ(key(camera, "width"), 320);
  EXPECT_EQ(key(camera, "height"), 240);  // tan(30) / tan(23.415) is 4 / 3
  EXPECT_EQ(key(device_named(scout_robot, "lidar"), "beams"), 180);
}

TEST(EyesimRobot, HasItsMassAndColliderInModelSpace) {
  Diagnostics d;
  const Robi robot = robi(scout, d);
  const model::Model& model = *robot.instance.model;
  double mass = 0;
  for (const model::Link& link : model.links) mass += link.inertial.mass_kg;
  // The body has nine tenths and two balls with a fiftieth each, the wheels a fortieth each.
  EXPECT_NEAR(mass, 2.5 * (0.9 + 0.04 + 0.05), 1e-9);
  const model::Collision& body = model.links[0].collisions[0];
  const Box& box = std::get<Box>(body.shape);
  EXPECT_NEAR(box.size_m.x, 0.15, 1e-12);  // forward is z there
  EXPECT_NEAR(box.size_m.y, 0.12, 1e-12);
  EXPECT_NEAR(box.size_m.z, 0.06, 1e-12);
  EXPECT_NEAR(body.X_LC.p.z, 0.062, 1e-12);                             // 35 mm over the point
  EXPECT_NEAR(model.links[0].inertial.X_LCo.p.z, 0.02 + 0.027, 1e-12);  // as the line `mass` says
}

TEST(EyesimRobot, OfEachDriveIsWhole) {
  for (const char* const drive : {"ACKERMANN_DRIVE", "OMNI_DRIVE", "DIFFERENTIAL_DRIVE"}) {
    SCOPED_TRACE(drive);
    Diagnostics d;
    const std::string text = std::string("drive ") + drive +
                             "\nname car\nmass 3\nwheel drive 60 1000 500 120\nwheel turn 60 1000 500 120\n"
                             "axel drive 0 -60\naxel turn 0 90\n";
    const Robi car = robi(text, d);
    const std::size_t wheels = std::string_view(drive) == "DIFFERENTIAL_DRIVE" ? 2 : 4;
    std::size_t found = 0;
    for (const model::Link& link : car.instance.model->links)
      found += link.name.size() > 6 && link.name.substr(link.name.size() - 6) == "_wheel";
    EXPECT_EQ(found, wheels);
  }
}

TEST(EyesimRobot, SaysWhatIsWrongWithItsLine) {
  EXPECT_EQ(
      robi_error("drive LEGS\n"),
      "scout.robi:1: 'legs' is not a drive; known are DIFFERENTIAL_DRIVE, ACKERMANN_DRIVE and OMNI_DRIVE");
  EXPECT_EQ(robi_error("drive OMNI_DRIVE\nmass 0\n"), "scout.robi:2: the mass of a robot is above 0");
  EXPECT_EQ(robi_error("wheel 50 100 0 80\n"), "scout.robi:1: the numbers of wheels are above 0");
  EXPECT_EQ(robi_error("psd A 1 0 0 0 0\npsd A 2 0 0 0 0\n"),
            "scout.robi:2: two psds have the name 'A' or the number 2; the other one is at scout.robi:1");
  EXPECT_EQ(robi_error("lidar 400 10\n"), "scout.robi:1: a lidar sees 1 to 360 degrees");
  EXPECT_EQ(robi_error(""), "scout.robi: the file describes no robot; begin with: drive DIFFERENTIAL_DRIVE");
}

TEST(EyesimObject, ScalesItsMeshAndTurnsItUpright) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "eyesim_object";
  std::filesystem::create_directories(folder);
  // A tetrahedron that is 2 high along y.
  std::ofstream(folder / "post.obj")
      << "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  Diagnostics d;
  const auto post = read_object(
      "obj post.obj\nname post\nscale 100\nmass 2 0 50 0\n"
      "collider capsule 0 250 0 30 500 y\nfixed\n",
      (folder / "post.esObj").string(), {}, d);
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(post) << post.error().text();
  EXPECT_TRUE(d.warnings.empty()) << d.warnings.front().text();
  const model::Model& model = *post->model;
  EXPECT_TRUE(model.is_static);
  const model::Collision& capsule = model.links[0].collisions.at(0);
  EXPECT_NEAR(std::get<Capsule>(capsule.shape).length_m, 0.44, 1e-12);  // 500 mm over all
  EXPECT_NEAR(capsule.X_LC.p.z, 0.25, 1e-12);
  EXPECT_NEAR(rotate(capsule.X_LC.q, {0, 0, 1}).z, 1, 1e-12);
  const model::Visual& seen = model.links[0].visuals.at(0);
  double highest = 0, ahead = 0, left = 0;
  for (const Vec3& v : std::get<Mesh>(seen.shape).mesh->vertices) {
    const Vec3 p = seen.X_LC * v;
    highest = std::max(highest, p.z), ahead = std::max(ahead, p.x), left = std::max(left, p.y);
  }
  EXPECT_NEAR(highest, 0.2, 1e-9);  // 2 units of 100 mm
  EXPECT_NEAR(ahead, 0.1, 1e-9);
  EXPECT_NEAR(left, 0.1, 1e-9);
  EXPECT_NEAR(model.links[0].inertial.X_LCo.p.z, 0.05, 1e-12);
}

TEST(EyesimObject, SaysWhatIsWrongWithItsLine) {
  Diagnostics d;
  const auto object = [&](std::string_view text) {
    const auto read = read_object(text, "post.esObj", {}, d);
    return read ? "none" : read.error().text();
  };
  EXPECT_EQ(object("name post\n"),
            "post.esObj: the object has neither a mesh nor a collider; name a mesh: obj can.obj");
  EXPECT_EQ(object("mass -1\n"),
            "post.esObj:1: the mass of an object is above 0; 'fixed' keeps it in its place");
  EXPECT_EQ(object("collider torus 1 2 3\n"),
            "post.esObj:1: 'torus' is not a collider; known are box, sphere and capsule");
}

TEST(EyesimModelSpace, IsLeftHanded) {
  // Right, up and forward of model space, in ours.
  EXPECT_EQ(from_model_space({1, 0, 0}), (Vec3{0, -1, 0}));
  EXPECT_EQ(from_model_space({0, 1, 0}), (Vec3{0, 0, 1}));
  EXPECT_EQ(from_model_space({0, 0, 1}), (Vec3{1, 0, 0}));
  // A turn about up goes clockwise, seen from above: forward becomes right.
  EXPECT_NEAR(rotate(turned_in_model_space({0, 90, 0}), {1, 0, 0}).y, -1, 1e-12);
}

}  // namespace
}  // namespace sandlot::formats::eyesim
