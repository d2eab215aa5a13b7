/// Every preset builds, and says what it was asked for.
#include "sim/load/presets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "messages/messages.h"
#include "messages/sensor_images.h"
#include "sim/load/device_settings.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

model::Instance with_device(const char* kind, Node config) {
  model::Instance instance = placed("robot", rover_model(), {});
  instance.is_robot = true;
  model::DeviceDecl decl;
  decl.name = "device";
  decl.kind = kind;
  decl.config = std::move(config);
  instance.devices.push_back(std::move(decl));
  return instance;
}

Result<std::unique_ptr<Simulation>> simulate(const char* kind, Node config) {
  model::Setup setup;
  setup.step = Time::from_s(0.001);
  setup.geography = model::Geography{.latitude_rad = 0.8};
  setup.instances.push_back(with_device(kind, std::move(config)));
  Diagnostics diagnostics;
  return Simulation::create(std::move(setup), {}, diagnostics);
}

TEST(Presets, EachOfEachKindBuildsARunningDevice) {
  std::size_t count = 0;
  for (const Kind* kind : device_kinds())
    for (const Preset& preset : kind->presets) {
      Node config = map({{"preset", preset.name}});
      for (const FieldInfo& field : kind->describe())  // what no preset can know
        if (field.path == "joint") config.set("joint", Node::scalar("left_wheel_joint"));
      auto simulation = simulate(kind->name, std::move(config));
      ASSERT_TRUE(simulation) << preset.name << ": " << simulation.error().text();
      EXPECT_TRUE((*simulation)->tick());
      EXPECT_NE(std::string(preset.help), "");
      ++count;
    }
  EXPECT_GE(count, 10u);
}

/// The catalogues give what follows from the other numbers too: an error in one of those shows here.
TEST(Presets, MotorsTurnWithoutLoadAsFastAsTheirCataloguesSay) {
  for (const auto& [preset, rpm] : {std::pair{"maxon_re30_24v", 8810.0},
                                    {"maxon_amax22_12v_gp22", 10400.0},
                                    {"faulhaber_2224_6v", 8200.0}}) {
    const auto simulation = simulate("dc_motor", map({{"preset", preset}, {"joint", "left_wheel_joint"}}));
    ASSERT_TRUE(simulation) << simulation.error().text();
    const model::DeviceDecl& decl = (*simulation)->entities()[0]->devices[0]->decl;
    const auto number = [&](const char* key) { return setting(decl, key).value_or(std::nan("")); };
    const double k = number("torque_constant"), no_load_A = number("friction") / k;
    const double speed = (number("supply_voltage") - number("resistance") * no_load_A) / k;
    EXPECT_NEAR(speed, rpm * 2 * 3.14159265 / 60, 0.005 * speed) << preset;  // three digits are given
  }
}

/// The sheets name the vertical field of view, too, and pixels are square: height and width must fit it. Sheets round, and
/// cut a few rows.
TEST(Presets, CamerasSeeAsHighAsTheirSheetsSay) {
  struct Sheet {
    const char *kind, *preset;
    double vertical_deg;
  };
  for (const Sheet& sheet : {Sheet{"camera", "raspberry_pi_v2", 48.8}, Sheet{"camera", "logitech_c920", 43.3},
                             Sheet{"rgbd_camera", "kinect_v1", 43}, Sheet{"rgbd_camera", "kinect_v2", 60},
                             Sheet{"rgbd_camera", "realsense_d435", 58}}) {
    const auto simulation = simulate(sheet.kind, map({{"preset", sheet.preset}}));
    ASSERT_TRUE(simulation) << simulation.error().text();
    const auto* info = topic_cast<msg::CameraInfo>((*simulation)->find_topic("/robot/device/camera_info"));
    ASSERT_NE(info, nullptr);
    const double half = math::atan(0.5 * info->message.height / info->message.k[4]);
    EXPECT_NEAR(2 * half * 180 / 3.14159265, sheet.vertical_deg, 1.6) << sheet.preset;
  }
}

/// f baseline is the number of disparities at 1 m: focal length of the preset's own lens times the maker's baseline.
TEST(Presets, DepthCamerasStepByTheirLensAndBaseline) {
  for (const auto& [preset, baseline_m, step] :
       {std::tuple{"kinect_v1", 0.075, 0.125}, {"realsense_d435", 0.05, 0.03125}}) {
    const auto simulation = simulate("rgbd_camera", map({{"preset", preset}}));
    ASSERT_TRUE(simulation) << simulation.error().text();
    const auto* info = topic_cast<msg::CameraInfo>((*simulation)->find_topic("/robot/device/camera_info"));
    const model::DeviceDecl& decl = (*simulation)->entities()[0]->devices[0]->decl;
    const Node* const stage = decl.config.find("depth_noise")->items().at(1).find("disparity");
    ASSERT_NE(stage, nullptr);
    EXPECT_NEAR(std::stod(stage->find("focal_baseline")->text()), info->message.k[0] * baseline_m,
                0.005 * info->message.k[0] * baseline_m)
        << preset;
    EXPECT_EQ(std::stod(stage->find("step")->text()), step);
  }
}

TEST(Presets, TheKeysBesideAPresetGoBefore) {
  const auto simulation = simulate("laser_scanner", map({{"preset", "sick_lms200"}, {"beams", "19"}}));
  ASSERT_TRUE(simulation) << simulation.error().text();
  const auto* scan = topic_cast<msg::LaserScan>((*simulation)->find_topic("robot/device"));
  ASSERT_NE(scan, nullptr);
  EXPECT_EQ(scan->message.ranges.size(), 19u);
  EXPECT_EQ(scan->message.range_max, 8);
  // A snapshot holds the preset by name and lays it again.
  const auto restored = again(**simulation);
  EXPECT_EQ(restored->state_hash(), (*simulation)->state_hash());
}

/// Errors of one beam that looks at a wall 3 m away, one per tick.
std::vector<double> errors_of_preset(const char* preset, std::uint64_t seed, int samples) {
  model::Setup setup;
  setup.step = Time::from_s(0.001);
  setup.seed = seed;
  setup.gravity = {};
  setup.instances.push_back(with_device(
      "laser_scanner",
      map({{"preset", preset}, {"beams", "1"}, {"min_angle", "0"}, {"max_angle", "0"}, {"rate", "0"}})));
  setup.instances.push_back(placed("wall", one_shape("wall", Box{{0.1, 4, 4}}, 0), {{3.05, 0, 0}, {}}));
  Diagnostics diagnostics;
  const auto simulation = Simulation::create(std::move(setup), {}, diagnostics);
  EXPECT_TRUE(simulation) << (simulation ? "" : simulation.error().text());
  std::vector<double> out;
  if (!simulation) return out;
  const auto* scan = topic_cast<msg::LaserScan>((*simulation)->find_topic("robot/device"));
  for (int i = 0; i < samples; ++i) {
    EXPECT_TRUE((*simulation)->tick());
    out.push_back(static_cast<double>(scan->message.ranges.at(0)) - 3);
  }
  return out;
}

TEST(Presets, TheNoiseOfTheLaserPresetsIsThatOfTheDataSheet) {
  struct Sheet {
    const char* preset;
    double white_m, systematic_m, resolution_m;
  };
  constexpr int devices = 12, samples = 400;
  for (const Sheet& sheet :
       {Sheet{"sick_lms200", 0.005, 0.015, 0.001}, Sheet{"sick_ld", 0.025, 0.038, 0.00390625}}) {
    double squares = 0, largest = 0;
    for (int d = 0; d < devices; ++d) {
      const std::vector<double> errors = errors_of_preset(sheet.preset, static_cast<std::uint64_t>(d + 1),
                                                          samples);
      ASSERT_EQ(errors.size(), static_cast<std::size_t>(samples));
      double mean = 0;
      for (const double e : errors) mean += e / samples;
      for (const double e : errors) squares += (e - mean) * (e - mean);
      largest = std::max(largest, std::abs(mean));
      // The systematic error is constant, within its bound; the mean of the samples strays by sigma / sqrt(n), four of them.
      EXPECT_LT(std::abs(mean), sheet.systematic_m + 4 * sheet.white_m / std::sqrt(samples)) << sheet.preset;
    }
    // Rounding to multiples of r adds r^2 / 12. The deviation from n samples strays by sigma / sqrt(2 n); four of that.
    const double expected = std::sqrt(sheet.white_m * sheet.white_m +
                                      sheet.resolution_m * sheet.resolution_m / 12);
    const int n = devices * (samples - 1);
    EXPECT_NEAR(std::sqrt(squares / n), expected, 4 * expected / std::sqrt(2.0 * n)) << sheet.preset;
    // Drawn evenly: that all twelve lie in the inner half has a chance of 1 in 4096.
    EXPECT_GT(largest, 0.5 * sheet.systematic_m) << sheet.preset;
  }
}

TEST(Presets, AnUnknownOneIsAnErrorWithTheNearest) {
  EXPECT_EQ(simulate("laser_scanner", map({{"preset", "sick_lsm200"}})).error().text(),
            "/preset: device kind 'laser_scanner' has no preset 'sick_lsm200'; did you mean 'sick_lms200'?");
  EXPECT_EQ(simulate("ground_truth", map({{"preset", "x"}})).error().text(),
            "/preset: device kind 'ground_truth' has no preset 'x'; it has none at all");
}

}  // namespace
}  // namespace sandlot::test
