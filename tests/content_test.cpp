/// Promises of models/, worlds/ and scenarios/ in their comments.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "assets/image/image.h"
#include "base/math.h"
#include "formats/sdf/sdf.h"
#include "geometry/bounds.h"
#include "sim/load/load.h"
#include "sim/test_world.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

model::Setup loaded(const std::string& file, std::vector<formats::Override> overrides = {},
                    std::uint64_t seed = 1) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.overrides = overrides;
  options.seed = seed;
  auto setup = load(file, options, diagnostics);
  if (!setup) {
    ADD_FAILURE() << setup.error().text();
    return {};
  }
  for (const Error& warning : diagnostics.warnings) ADD_FAILURE() << warning.text();
  return std::move(*setup);
}

formats::WorldContent rover_file() {
  Diagnostics diagnostics;
  auto content = formats::read_sdf("models/rover/model.sdf", diagnostics);
  if (!content) ADD_FAILURE() << content.error().text();
  return std::move(*content);
}

TEST(Content, EveryScenarioLoadsAndBuildsWithoutAWarning) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator("scenarios")) {
    if (entry.path().extension() != ".yaml" && entry.path().extension() != ".sim") continue;
    SCOPED_TRACE(entry.path().string());
    ++files;
    EXPECT_TRUE(test::build(loaded(entry.path().string())));
  }
  EXPECT_GE(files, 3);
}

TEST(Content, WorldsOfGazeboFindTheirFloorAndSun) {
  const std::string file = ::testing::TempDir() + "floor_and_sun.sdf";
  std::ofstream(file) << "<sdf version='1.6'><world name='w'><include><uri>model://sun</uri></include>"
                         "<include><uri>model://ground_plane</uri></include></world></sdf>";
  const model::Setup setup = loaded(file);
  std::filesystem::remove(file);
  ASSERT_EQ(setup.instances.size(), 1u);
  EXPECT_EQ(setup.instances[0].name, "ground_plane");
  ASSERT_EQ(setup.lights.size(), 1u);
  EXPECT_EQ(setup.lights[0].name, "sun");
}

TEST(Materials, DoWhatTheWorldsCommentsSay) {
  const auto simulation = test::build(loaded("scenarios/materials.yaml"));
  ASSERT_TRUE(simulation);
  const auto body = [&](const std::string& name) {
    for (const auto& entity : simulation->entities())
      if (entity->instance.name == name)
        return simulation->engine().states()[simulation->engine().bodies(entity->id)[0].index];
    ADD_FAILURE() << "no " << name;
    return BodyState{};
  };
  const auto x = [&](const std::string& name) { return body(name).X_WB.p.x; };
  const auto run_to = [&](double s) {
    while (simulation->now().s() < s) ASSERT_TRUE(simulation->tick());
  };
  std::map<std::string, double> begin;
  for (const char* name : {"metal_block", "plastic_block", "rubber_block", "foam_block", "snow_block",
                           "sled_along", "sled_across"})
    begin[name] = x(name);
  run_to(0.5);
  // On 30 deg, v = g (sin - mu cos) t once it is faster than its slip takes up: mu is 0.5 times its own
  // roughness.
  const double s30 = math::sin(math::pi / 6), c30 = math::cos(math::pi / 6);
  EXPECT_NEAR(norm(body("metal_block").V_WB.linear), 9.81 * (s30 - 0.25 * c30) * 0.5, 0.05);
  EXPECT_NEAR(norm(body("plastic_block").V_WB.linear), 9.81 * (s30 - 0.4 * c30) * 0.5, 0.05);
  run_to(1.5);
  EXPECT_LT(x("rubber_block") - begin["rubber_block"], 0.05);
  // Foam creeps: slip 0.11 m/(s N) times a quarter of the pull of 4.9 N.
  EXPECT_NEAR(norm(body("foam_block").V_WB.linear), 0.11 * 9.81 * s30 / 4, 0.005);
  EXPECT_GT(x("snow_block") - begin["snow_block"], 1);
  EXPECT_GT(x("sled_along") - begin["sled_along"], 1);
  EXPECT_LT(x("sled_across") - begin["sled_across"], 0.01);
  EXPECT_NEAR(body("box2").V_WB.linear.x, 0.7, 1e-6) << "on the conveyor";
  run_to(6);
  // Beyond the foot of the chutes, at 2.26 m: the rougher, the shorter.
  EXPECT_LT(x("puck_mud") + 0.1, x("puck_carpet"));
  EXPECT_LT(x("puck_carpet") + 0.3, x("puck_bare"));
  EXPECT_GT(x("puck_ice"), 8);
  EXPECT_LT(x("ball_mud"), 4.5);
  EXPECT_LT(x("ball_mud") + 2, x("ball_carpet"));
  EXPECT_LT(norm(body("ball_mud").V_WB.linear), 1e-3);
}

TEST(MslField, ItsLinesLieWhereTheRuleBookSays) {
  const auto image = assets::read_image("worlds/msl_field.png");
  ASSERT_TRUE(image);
  const auto white = [&](double x, double y) {  // on a carpet of 24 x 16 m, 100 pixels to the metre
    return image->at(static_cast<int>((x + 12) * 100), static_cast<int>((8 - y) * 100), 0) > 200;
  };
  // Each line 0.125 m wide: white 2 cm from either edge within, green 2 cm outside.
  const auto line_across_x = [&](double low, double y) {
    return !white(low - 0.02, y) && white(low + 0.02, y) && white(low + 0.105, y) && !white(low + 0.145, y);
  };
  const auto line_across_y = [&](double low, double x) {
    return !white(x, low - 0.02) && white(x, low + 0.02) && white(x, low + 0.105) && !white(x, low + 0.145);
  };
  for (const double side : {1.0, -1.0}) {
    EXPECT_TRUE(line_across_x(-0.0625, side)) << "half way";
    EXPECT_TRUE(line_across_x(side > 0 ? 10.875 : -11, 5));
    EXPECT_TRUE(line_across_y(side > 0 ? 6.875 : -7, 5));
    EXPECT_TRUE(line_across_x(side > 0 ? 8.75 : -8.875, 3)) << "penalty area 2.25 deep";
    EXPECT_TRUE(line_across_y(side > 0 ? 3.325 : -3.45, 9)) << "and 6.9 wide";
    EXPECT_TRUE(line_across_x(side > 0 ? 10.25 : -10.375, 1)) << "goal area 0.75 deep";
    EXPECT_TRUE(line_across_y(side > 0 ? 1.825 : -1.95, -10.6)) << "and 3.9 wide";
    EXPECT_TRUE(line_across_x(side > 0 ? 1.875 : -2, 0.0)) << "centre circle of 4 m";
    EXPECT_TRUE(white(7.4 * side, 0.06) && !white(7.4 * side, 0.09)) << "penalty mark of 0.15 m";
    const double d = std::sqrt(0.5);
    EXPECT_TRUE(white(side * (11 - 0.69 * d), 7 - 0.69 * d)) << "corner arc of 0.75 m";
    EXPECT_FALSE(white(side * (11 - 0.6 * d), 7 - 0.6 * d) || white(side * (11 - 0.78 * d), 7 - 0.78 * d));
  }
}

TEST(MslField, HasTwoTeamsOfSixRobotsThatTheLeagueAllows) {
  const model::Setup setup = loaded("scenarios/msl_field.yaml");
  std::map<std::string, int> teams;
  for (const model::Instance& instance : setup.instances) {
    if (instance.name == "ball") {
      const model::Inertial& ball = instance.model->links[0].inertial;
      EXPECT_NEAR(ball.moments.x, 2.0 / 3 * 0.43 * 0.11 * 0.11, 1e-8) << "hollow";
    }
    if (!instance.is_robot) continue;
    ++teams[instance.team];
    SCOPED_TRACE(instance.name);
    Bounds bounds;
    double mass = 0;
    for (const model::Link& link : instance.model->links) {
      mass += link.inertial.mass_kg;
      for (const model::Visual& each : link.visuals)
        bounds.include(bounds_of(each.shape, link.X_ML * each.X_LC));
    }
    EXPECT_LE(bounds.high.x - bounds.low.x, 0.5);
    EXPECT_LE(bounds.high.y - bounds.low.y, 0.5);
    EXPECT_NEAR(bounds.low.z, 0, 0.003);
    EXPECT_GE(bounds.high.z, 0.4);
    EXPECT_LE(bounds.high.z, 0.8);
    EXPECT_LE(mass, 40);
  }
  EXPECT_EQ(teams, (std::map<std::string, int>{{"cyan", 6}, {"magenta", 6}}));
}

TEST(Rover, InertiaIsThatOfTheSolidsItNames) {
  struct Part {
    double mass_kg;
    Shape shape;
    Vec3 at;
  };
  const Part parts[] = {{3.0, Cylinder{0.175, 0.10}, {0, 0, 0.08}},
                        {0.6, Box{{0.08, 0.14, 0.05}}, {-0.09, 0, 0.065}},
                        {0.1, Cylinder{0.025, 0.09}, {0, 0, 0.175}},
                        {0.2, Cylinder{0.04, 0.06}, {0, 0, 0.25}}};
  double mass = 0;
  Vec3 moment;
  for (const Part& part : parts) mass += part.mass_kg, moment += part.mass_kg * part.at;
  const Vec3 centre = moment / mass;
  Vec3 inertia;
  double ixz = 0;
  for (const Part& part : parts) {
    const Vec3 d = part.at - centre;
    inertia += inertia_kg_m2(part.shape, part.mass_kg) +
               part.mass_kg * Vec3{d.y * d.y + d.z * d.z, d.x * d.x + d.z * d.z, d.x * d.x + d.y * d.y};
    ixz -= part.mass_kg * d.x * d.z;
  }
  const formats::WorldContent content = rover_file();
  const model::Link& base = content.instances[0].model->links[0];
  // The file has six digits.
  EXPECT_NEAR(base.inertial.mass_kg, mass, 1e-9);
  EXPECT_NEAR(norm(base.inertial.X_LCo.p - centre), 0, 1e-6);
  EXPECT_NEAR(norm(base.inertial.moments - inertia), 0, 1e-6);
  EXPECT_NEAR(base.inertial.products.y, ixz, 1e-8);
  for (const char* name : {"left_wheel", "right_wheel"}) {
    const auto index = content.instances[0].model->find_link(name);
    ASSERT_TRUE(index);
    const model::Inertial& wheel = content.instances[0].model->links[*index].inertial;
    const Vec3 disc = inertia_kg_m2(Cylinder{0.05, 0.02}, wheel.mass_kg);
    EXPECT_NEAR(norm(wheel.moments - Vec3{disc.x, disc.z, disc.y}), 0, 1e-9);  // its axis is y
  }
}

TEST(Rover, FitsIntoADiscOfItsRadius) {
  // What planar physics takes as its footprint: no collision shape reaches beyond the chassis.
  const formats::WorldContent content = rover_file();
  for (const model::Link& link : content.instances[0].model->links)
    for (const model::Collision& collision : link.collisions) {
      const Pose X = link.X_ML * collision.X_LC;
      double radius = bounding_radius_m(collision.shape);
      if (const auto* cylinder = std::get_if<Cylinder>(&collision.shape)) radius = cylinder->radius_m;
      EXPECT_LE(math::hypot(X.p.x, X.p.y) + radius, 0.175 + 1e-9) << link.name << "/" << collision.name;
    }
}

TEST(Rover, StandsStillOnItsWheelsAndRearCaster) {
  auto setup = loaded("scenarios/indoor.yaml");
  setup.instances.back().controllers.clear();
  for (const char* level : {"ideal", "contact"}) {
    auto leveled = setup;
    for (model::DeviceDecl& device : leveled.instances.back().devices)
      if (device.name == "drive") device.config.set("level", Node::scalar(level));
    const auto simulation = test::build(std::move(leveled));
    ASSERT_TRUE(simulation);
    const Pose before = simulation->engine().pose(*simulation->find_instance("rover"));
    for (int i = 0; i < 300; ++i) ASSERT_TRUE(static_cast<bool>(simulation->tick()));
    const Pose after = simulation->engine().pose(*simulation->find_instance("rover"));
    // Soft contacts give way by far less than the front caster's clearance of 1 mm.
    EXPECT_NEAR(norm(after.p - before.p), 0, 2e-4) << level;
    EXPECT_GT(rotate(after.q, {0, 0, 1}).z, 1 - 1e-6) << level;
  }
}

/// Which room of worlds/indoor.sdf a point is in.
int room_of(Vec3 p) {
  if (p.y > 4.06 && p.y < 5.24) return 0;
  if (p.y < 4.06) return p.x < 5.2 ? 1 : p.x < 8.6 ? 2 : 3;
  return p.x < 4.2 ? 4 : p.x < 6.4 ? 5 : 6;
}

/// Where the rovers go, and how long each stays within 0.3 m of a point.
struct Tracker final : Observer {
  struct Track {
    Vec3 anchor{1e9, 0, 0};
    Time since;
    double longest_s = 0;
    std::set<int> rooms;
    std::set<std::pair<int, int>> cells;  ///< of 0.5 m
    double lean = 0, out_of_world = 0;
  };
  std::map<std::string, Track> tracks;
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    for (const FrameInstance& instance : frame->instances) {
      if (!instance.is_robot) continue;
      Track& track = tracks[instance.name];
      const Vec3 p = instance.X_WM.p;
      if (norm(p - track.anchor) > 0.3) track.anchor = p, track.since = frame->now;
      track.longest_s = std::max(track.longest_s, (frame->now - track.since).s());
      track.rooms.insert(room_of(p));
      track.cells.insert({static_cast<int>(2 * p.x), static_cast<int>(2 * p.y)});
      track.lean = std::max(track.lean, 1 - rotate(instance.X_WM.q, {0, 0, 1}).z);
      if (p.x < 0.1 || p.x > 11.9 || p.y < 0.1 || p.y > 8.9 || std::abs(p.z) > 0.01) ++track.out_of_world;
    }
  }
};

void expect_wandering(const std::string& physics, const std::string& level) {
  double cells = 0;
  std::size_t rooms = 0;
  constexpr int runs = 4;
  for (std::uint64_t seed = 1; seed <= runs; ++seed) {
    SCOPED_TRACE(physics + " " + level + " seed " + std::to_string(seed));
    const auto simulation = test::build(
        loaded("scenarios/indoor.yaml", {{"physics", physics}, {"level", level}}, seed));
    ASSERT_TRUE(simulation);
    Tracker tracker;
    simulation->add_observer(&tracker);
    while (!simulation->stop_reason()) ASSERT_TRUE(static_cast<bool>(simulation->tick()));
    ASSERT_EQ(tracker.tracks.size(), 1u);
    const Tracker::Track& track = tracker.tracks.begin()->second;
    EXPECT_EQ(simulation->now(), Time::from_s(300));
    EXPECT_LT(track.longest_s, 40);  // 16 s at most in 80 runs over both engines
    EXPECT_EQ(track.out_of_world, 0);
    EXPECT_LT(track.lean, 1e-3);
    cells += static_cast<double>(track.cells.size()) / runs;
    rooms += track.rooms.size();
  }
  // 80 runs over both engines: 110 cells and 5.2 of 7 rooms on average, never less than 80 cells and 3 rooms.
  EXPECT_GT(cells, 70);
  EXPECT_GE(rooms, 3u * runs);
}

TEST(SlowContent, TheRoverWandersWithoutGettingStuckRigid) { expect_wandering("rigid", "ideal"); }
TEST(SlowContent, TheRoverWandersWithoutGettingStuckPlanar) { expect_wandering("planar", "ideal"); }
TEST(SlowContent, TheRoverWandersWithoutGettingStuckOnWheels) { expect_wandering("rigid", "contact"); }

TEST(SlowContent, AFleetKeepsMovingAndInside) {
  for (const char* physics : {"rigid", "planar"}) {
    SCOPED_TRACE(physics);
    const auto simulation = test::build(loaded("scenarios/fleet.yaml", {{"physics", physics}}));
    ASSERT_TRUE(simulation);
    Tracker tracker;
    simulation->add_observer(&tracker);
    while (!simulation->stop_reason()) ASSERT_TRUE(static_cast<bool>(simulation->tick()));
    EXPECT_EQ(tracker.tracks.size(), 8u);
    for (const auto& [name, track] : tracker.tracks) {
      EXPECT_LT(track.longest_s, 60) << name;
      EXPECT_EQ(track.out_of_world, 0) << name;
      EXPECT_GT(track.cells.size(), 10u) << name;
    }
  }
}

TEST(SlowContent, ThePileFallsIntoTheBinAndTheSlopeSortsWhatLiesOnIt) {
  const auto simulation = test::build(loaded("scenarios/pile.yaml"));
  ASSERT_TRUE(simulation);
  const auto at = [&](const char* name) {
    return simulation->engine().pose(*simulation->find_instance(name)).p;
  };
  const Vec3 stuck = at("box_sticking"), sliding = at("box_sliding");
  while (!simulation->stop_reason()) ASSERT_TRUE(static_cast<bool>(simulation->tick()));
  // tan 20 deg = 0.364 lies between the two coefficients, 0.6 and 0.2. Soft friction creeps a little.
  EXPECT_NEAR(norm(at("box_sticking") - stuck), 0, 0.02);
  EXPECT_GT(norm(at("box_sliding") - sliding), 3);
  int inside = 0;
  for (int i = 1; i <= 40; ++i) {
    const Vec3 p = at(("box_" + std::string(i < 10 ? "0" : "") + std::to_string(i)).c_str());
    EXPECT_GT(p.z, 0.09) << "box " << i << " is in the floor";
    EXPECT_LT(p.z, 1.5) << "box " << i << " still stands high";
    inside += std::abs(p.x) < 0.75 && std::abs(p.y) < 0.75 ? 1 : 0;
  }
  EXPECT_GE(inside, 15);
  // What rolls leaves the slope, which ends at x = 5.6, and nothing brakes it on the floor.
  EXPECT_GT(at("ball_light").x, 10);
  EXPECT_GT(at("cylinder_thick").x, 10);
}

}  // namespace
}  // namespace sandlot
