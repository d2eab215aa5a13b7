/// Models with parameters: what they weigh and measure, that they stand, load back from files and move as they should.
#include "builders/builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "base/math.h"
#include "formats/sdf/write.h"
#include "geometry/bounds.h"
#include "geometry/height_grid.h"
#include "model/model_bytes.h"
#include "sim/load/load.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Built made(const std::string& words) {
  const auto map = parse_builder("builder:" + words);
  EXPECT_TRUE(map && *map) << words;
  auto built = build_model(**map);
  EXPECT_TRUE(built) << built.error().text();
  return std::move(*built);
}

std::string refusal(const std::string& words) {
  const auto map = parse_builder("builder:" + words);
  if (!map) return "no builder";
  if (!*map) return map->error().text();
  const auto built = build_model(**map);
  return built ? "" : built.error().text();
}

double total_kg(const model::Model& model) {
  double sum = 0;
  for (const model::Link& link : model.links) sum += link.inertial.mass_kg;
  return sum;
}

Bounds extent(const Built& built) {
  Bounds bounds;
  for (const model::Link& link : built.model.links)
    for (const model::Collision& each : link.collisions)
      bounds.include(bounds_of(each.shape, built.X_WM * link.X_ML * each.X_LC));
  return bounds;
}

/// A world from the text of a scenario, ready to run.
std::unique_ptr<Simulation> world(const std::string& rest) {
  Diagnostics diagnostics;
  const std::string text = "version: 1\nname: t\nphysics: rigid\ntime: {step: 10 ms, substeps: 2}\n" + rest;
  LoadOptions options;
  options.text = text;
  auto setup = load("t.yaml", options, diagnostics);
  EXPECT_TRUE(setup) << setup.error().text();
  return setup ? test::build(std::move(*setup)) : nullptr;
}

Vec3 place_of(const Simulation& simulation, const char* name) {
  return simulation.engine().pose(*simulation.find_instance(name)).p;
}

std::vector<std::string> builder_names() {
  std::vector<std::string> names;
  for (const Builder* const builder : builder_table()) names.emplace_back(builder->name);
  return names;
}

class EachBuilder : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, EachBuilder, testing::ValuesIn(builder_names()),
                         [](const auto& test) { return test.param; });

TEST_P(EachBuilder, SaysAModelThatCanBe) {
  const Built built = made(GetParam());
  EXPECT_EQ(built.model.name, GetParam());
  for (const model::Link& link : built.model.links) {
    EXPECT_GT(link.inertial.mass_kg, 0) << link.name;
    const Vec3 i = link.inertial.moments;
    // The largest moment of a body is at most the sum of the two others.
    EXPECT_GT(std::min({i.x, i.y, i.z}), 0) << link.name;
    EXPECT_LE(2 * std::max({i.x, i.y, i.z}), (i.x + i.y + i.z) * (1 + 1e-12)) << link.name;
  }
  for (const model::Joint& joint : built.model.joints)
    EXPECT_NEAR(norm(joint.axis_J), 1, 1e-12) << joint.name;
  // It stands on the ground: neither above nor in it.
  EXPECT_NEAR(extent(built).low.z, 0, 0.006);
}

/// At rest nothing gives it energy: it never has more than at the start, but for what contacts push out and motors that
/// hold their joints put in; five seconds later it hardly moves.
TEST_P(EachBuilder, Settles) {
  const auto simulation = world("robots: [{name: it, model: {builder: " + GetParam() + "}}]\n");
  const auto id = *simulation->find_instance("it");
  const model::Model& model = *simulation->instances()[1]->model;
  const auto energies = [&] {
    double kinetic = 0, potential = 0;
    const auto bodies = simulation->engine().bodies(id);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const BodyState& state = simulation->engine().states()[bodies[i].index];
      const model::Inertial& inertial = model.links[i].inertial;
      const Vec3 arm = rotate(state.X_WB.q, inertial.X_LCo.p);
      const Vec3 v = state.V_WB.linear + cross(state.V_WB.angular, arm);
      kinetic += 0.5 * inertial.mass_kg * dot(v, v);
      potential += 9.81 * inertial.mass_kg * (state.X_WB.p.z + arm.z);
    }
    return std::pair(kinetic, potential);
  };
  const double start = energies().second;
  double most = start, kinetic = 0;
  for (int i = 0; i < 500; ++i) {
    test::advance(*simulation, 1);
    const auto [k, p] = energies();
    most = std::max(most, k + p);
    kinetic = k;
  }
  if (model.is_static) return;
  EXPECT_LT(most, start + 0.05 * std::abs(start) + 0.1);
  EXPECT_LT(kinetic, 2e-3 * total_kg(model)) << "faster than 6 cm/s on average";
}

TEST_P(EachBuilder, IsTheSameWhenItComesFromAFile) {
  Diagnostics diagnostics;
  const auto direct = load_instance("builder:" + GetParam(), GetParam(), {}, diagnostics);
  ASSERT_TRUE(direct);
  // These have no file: convert makes a mesh of the first two.
  if (GetParam() == "terrain" || GetParam() == "basin" || GetParam() == "soccer_field") return;
  auto xml = formats::sdf_of(*direct, diagnostics);
  ASSERT_TRUE(xml) << xml.error().text();
  const std::string file = testing::TempDir() + "builder_" + GetParam() + ".sdf";
  std::ofstream(file) << formats::xml_text(*xml);
  const auto again = load_instance(file, GetParam(), {}, diagnostics);
  std::filesystem::remove(file);
  ASSERT_TRUE(again) << again.error().text();
  for (const Error& warning : diagnostics.warnings) ADD_FAILURE() << warning.text();
  const auto bytes = [](const model::Instance& instance) {
    ByteWriter w;
    write_instance(w, instance);
    return std::vector<std::byte>(w.bytes().begin(), w.bytes().end());
  };
  EXPECT_TRUE(bytes(*direct) == bytes(*again));
}

TEST(Builders, WeighWhatTheirParametersSay) {
  const std::pair<const char*, double> table[] = {
      {"two_wheeled?body_mass=3&wheel_mass=0.5", 4},
      {"four_wheeled?body_mass=3&wheel_mass=0.25", 4},
      {"sphere_robot?shell_mass=2&mass=0.5", 3.5},
      {"barrel_robot?shell_mass=2&mass=0.5", 3},
      {"snake?segments=7&mass=0.3", 2.1},
      {"snake?segments=7&mass=0.3&joints=universal", 2.1 + 6 * 0.03},
      {"slider_wheelie?segments=10&mass=0.2", 2},
      {"armband?segments=9&mass=0.2", 1.8},
      {"hexapod?mass=2", 2},
      {"hexapod?mass=2&knees=true", 2},
      {"dog?mass=3", 3},
      {"humanoid?mass=5", 5},
      {"wheel_chain?members=3&body_mass=2&wheel_mass=0.5", 3 * 3 + 2 * 0.2},  // couplings: a tenth of a body
      {"diff_robot?mass=8", 8},
      {"blade_robot?mass=3", 3},
      {"block?mass=0.7", 0.7},
      {"block?mass=0.7&form=cylinder", 0.7},
      {"skid_robot?mass=8", 8},
      {"ackermann_robot?mass=8", 8},
      {"omni_robot?mass=8&wheels=4", 8 + 4 * 0.08},  // rollers: 2 fifths of a fortieth per wheel
      {"mecanum_robot?mass=8", 8 + 4 * 0.1},         // a half
      {"swerve_robot?mass=8", 8},
      {"tracked_robot?mass=8", 8},
      {"seesaw?mass=5", 7},  // with two cheeks of 1 kg
      {"box_pile?count=5&smallest=0.2&largest=0.2&density=500", 5 * 500 * 0.008},
  };
  for (const auto& [words, kg] : table) EXPECT_NEAR(total_kg(made(words).model), kg, 1e-9 * kg) << words;
}

TEST(Builders, MeasureWhatTheirParametersSay) {
  // A snake: segments of capsules that stick out of the first and last by what its caps overlap at the joints.
  const Vec3 snake = extent(made("snake?segments=4&length=0.5&diameter=0.1")).high -
                     extent(made("snake?segments=4&length=0.5&diameter=0.1")).low;
  EXPECT_NEAR(snake.x, 3 * 0.5 + 0.5 - 0.9 * 0.05 + 2 * 0.05, 1e-9);
  EXPECT_NEAR(snake.z, 0.1, 1e-9);
  EXPECT_NEAR(extent(made("sphere_robot?diameter=0.6&range=0.1")).high.z, 0.6, 1e-9);
  const Bounds barrel = extent(made("barrel_robot?diameter=0.6&length=0.8&range=0.1"));
  EXPECT_NEAR(barrel.high.y - barrel.low.y, 0.8, 1e-7);  // sqrt(1 - z^2) of an axis that is turned
  const Bounds yard = extent(made("square_playground?length=4&factor_xy=0.5&wall=0.1&height=0.3"));
  EXPECT_NEAR(yard.high.x, 2.1, 1e-9);
  EXPECT_NEAR(yard.high.y, 1.1, 1e-9);
  EXPECT_NEAR(yard.high.z, 0.3, 1e-9);
  // The corners of an octagon of walls, outside: (length / 2 + wall) / cos(pi / 8) from the middle.
  const Bounds octagon = extent(made("octagon_playground?length=6&wall=0.2"));
  EXPECT_NEAR(octagon.high.x, 3.2, 1e-9);
  const Bounds stairs = extent(made("stairs?steps=4&rise=0.15&tread=0.3&platform=1"));
  EXPECT_NEAR(stairs.high.z, 0.6, 1e-9);
  EXPECT_NEAR(stairs.high.x, 3 * 0.3 + 1 + 3 * 0.3, 1e-9);
  const Bounds oneway = extent(made("stairs?steps=4&rise=0.15&tread=0.3&platform=1&down=false"));
  EXPECT_NEAR(oneway.high.x, 3 * 0.3 + 1, 1e-9);
}

TEST(Builders, PartsOfALinkAddUpToItsInertia) {
  // The leg of a hexapod: a rod from the hip and a ball at its end, along a direction in the y-z plane. About the hip its
  // inertia along x is the sum of both by Steiner's rule, and so is it about the common centre.
  const Built built = made("hexapod?leg_length=1&mass=10&spread=0.5");
  const model::Inertial& leg = built.model.links[*built.model.find_link("left_front_leg")].inertial;
  const double rod = 0.5 * 0.7, ball = 0.5 * 0.1;  // 0.3 * 10 kg / 6 legs
  EXPECT_NEAR(leg.mass_kg, rod + ball, 1e-12);
  const double centre = (rod * 0.5 + ball * 1.0) / (rod + ball);
  EXPECT_NEAR(leg.X_LCo.p.y, centre * math::sin(0.5), 1e-12);
  EXPECT_NEAR(leg.X_LCo.p.z, -centre * math::cos(0.5), 1e-12);
  const double rod_x = inertia_kg_m2(Capsule{0.05, 1}, rod).x, ball_x = inertia_kg_m2(Sphere{0.07}, ball).x;
  const double across = rod_x + rod * (centre - 0.5) * (centre - 0.5) + ball_x +
                        ball * (1 - centre) * (1 - centre);
  EXPECT_NEAR(leg.moments.x, across, 1e-12);
  // In y and z the slender leg is turned by 0.5 rad about x: the product tells.
  const double alongside = inertia_kg_m2(Capsule{0.05, 1}, rod).z + ball_x;
  EXPECT_NEAR(leg.products.z, (across - alongside) * math::sin(0.5) * math::cos(0.5), 1e-12);
}

TEST(Builders, ATerrainFollowsFromItsSeedAndSinksToItsEdge) {
  const auto grid = [](const char* words) {
    return std::get<Heightfield>(made(words).model.links[0].collisions[0].shape).grid;
  };
  const auto a = grid("terrain?size_x=4&size_y=3&height=0.5&cell=0.1&seed=3");
  EXPECT_EQ(a->columns, 41);
  EXPECT_EQ(a->rows, 31);
  EXPECT_EQ(a->height_m, grid("terrain?size_x=4&size_y=3&height=0.5&cell=0.1&seed=3")->height_m);
  EXPECT_NE(a->height_m, grid("terrain?size_x=4&size_y=3&height=0.5&cell=0.1&seed=4")->height_m);
  const auto [low, high] = std::minmax_element(a->height_m.begin(), a->height_m.end());
  EXPECT_EQ(*low, 0.0f);
  EXPECT_LE(*high, 0.5f);
  EXPECT_GT(*high, 0.15f);
  for (int i = 0; i < a->columns; ++i) EXPECT_EQ(a->at(i, 0) + a->at(i, a->rows - 1), 0.0f);
}

TEST(Builders, ABasinTurnsUpFromItsFloorToItsRim) {
  const auto grid = std::get<Heightfield>(
                        made("basin?diameter=4&floor=2&depth=1&cell=0.1").model.links[0].collisions[0].shape)
                        .grid;
  EXPECT_EQ(grid->columns, 41);
  EXPECT_EQ(grid->at(20, 20), 0.0f);
  EXPECT_EQ(grid->at(30, 20), 0.0f) << "the edge of the floor, 1 m from the middle";
  EXPECT_NEAR(grid->at(35, 20), 0.25, 1e-6) << "half way up: a quarter of the depth";
  EXPECT_EQ(grid->at(40, 20), 1.0f);
  EXPECT_EQ(grid->at(0, 0), 1.0f) << "beyond the rim it is flat";
}

/// A joint of +-0.2 m in the middle and at the command 0.5 of the way, read back in the same unit; a wheel of at most 12 rad/s at half of it.
TEST(Builders, TakeAndGiveNumbersBetweenMinusOneAndOne) {
  const auto simulation = world(
      "robots:\n  - name: ball\n    model: {builder: sphere_robot, units: centred}\n"
      "    controller: {kind: sequence, steps: [{at: 0, orders: {x: 0.5, y: -2}}]}\n"
      "  - name: nimm\n    model: {builder: two_wheeled, units: centred}\n    pose: [0, 5, 0]\n"
      "    controller: {kind: sequence, steps: [{at: 0, orders: {left: 0.5, right: 0.5}}]}\n"
      "  - name: wheelie\n    model: {builder: slider_wheelie, units: centred}\n    pose: [0, -5, 0]\n");
  test::advance(*simulation, 300);
  const auto value = [&](const char* address) {
    auto found = NamedValue::find(*simulation, address);
    EXPECT_TRUE(found) << address;
    return found ? found->read().value_or(NAN) : NAN;
  };
  EXPECT_NEAR(value("ball/joints.position[0]"), 0.5, 0.02);
  EXPECT_NEAR(value("ball.joints.slider_x.position"), 0.1, 0.004);
  EXPECT_NEAR(value("ball/joints.position[1]"), -1, 0.02) << "cut at the limit";
  EXPECT_NEAR(value("nimm/joints.velocity[0]"), 0.5, 0.02);
  EXPECT_NEAR(value("nimm.joints.left_joint.velocity"), 6, 0.2);
  EXPECT_LE(std::abs(value("nimm/joints.position[0]")), 1) << "part of half a turn";
  // A hinge from -pi/8 to pi/3: its middle is pi (1/3 - 1/8) / 2.
  const double hinge = value("wheelie.joints.hinge_1_joint.position");
  EXPECT_NEAR(value("wheelie/joints.position[0]"),
              (hinge - math::pi * (1.0 / 3 - 1.0 / 8) / 2) / (math::pi * (1.0 / 3 + 1.0 / 8) / 2), 1e-12);
}

TEST(Builders, RefuseImpossibleParametersByTheirKey) {
  EXPECT_THAT(refusal("snake?segments=1"), HasSubstr("/segments: "));
  EXPECT_THAT(refusal("snake?segmens=9"), HasSubstr("did you mean 'segments'"));
  EXPECT_THAT(refusal("snake?length=0.1&diameter=0.2"), HasSubstr("/length: "));
  EXPECT_THAT(refusal("snake?joints=sideways"), HasSubstr("/joints: "));
  EXPECT_THAT(refusal("sphere_robot?range=0.6"), HasSubstr("/range: the masses would leave the shell"));
  EXPECT_THAT(refusal("barrel_robot?range=0.6"), HasSubstr("/range: "));
  EXPECT_THAT(refusal("slider_wheelie?segments=9"), HasSubstr("/segments: "));
  EXPECT_THAT(refusal("slider_wheelie?slide=0.3"), HasSubstr("/slide: "));
  EXPECT_THAT(refusal("armband?length=0.1"), HasSubstr("/length: "));
  EXPECT_THAT(refusal("terrain?cell=0.001"), HasSubstr("/cell: "));
  EXPECT_THAT(refusal("basin?floor=7"), HasSubstr("/floor: "));
  EXPECT_THAT(refusal("basin?cell=0.001"), HasSubstr("/cell: "));
  EXPECT_THAT(refusal("humanoid?height=0"), HasSubstr("/height: "));
  EXPECT_THAT(refusal("box_pile?smallest=0.5"), HasSubstr("/smallest: "));
  EXPECT_THAT(refusal("box_pile?length=0.2"), HasSubstr("/largest: "));
  EXPECT_THAT(refusal("diff_robot?track=0.1"), HasSubstr("/track: "));
  EXPECT_THAT(refusal("blade_robot?radius=0.04"), HasSubstr("/radius: "));
  EXPECT_THAT(refusal("skid_robot?wheelbase=0.1"), HasSubstr("/wheelbase: "));
  EXPECT_THAT(refusal("ackermann_robot?track=0.2"), HasSubstr("/track: "));
  EXPECT_THAT(refusal("omni_robot?wheels=16"), HasSubstr("/radius: the wheels would touch"));
  EXPECT_THAT(refusal("mecanum_robot?wheelbase=0.1"), HasSubstr("/wheelbase: "));
  EXPECT_THAT(refusal("swerve_robot?height=0.1"), HasSubstr("/height: "));
  EXPECT_THAT(refusal("tracked_robot?wheels=9"), HasSubstr("/length: "));
  EXPECT_THAT(refusal("seesaw?height=0.01"), HasSubstr("/height: "));
  EXPECT_THAT(refusal("snake?"), HasSubstr("key=value"));
  EXPECT_THAT(refusal("snake?segments"), HasSubstr("'segments' is not a parameter"));
  EXPECT_THAT(refusal("snake?segments=3&segments=4"), HasSubstr("given twice"));
  EXPECT_THAT(refusal("snaek"), HasSubstr("there is no builder 'snaek'; did you mean 'snake'"));
}

TEST(Builders, ScenariosNameThemWithParametersThatCanBeSet) {
  const std::string text =
      "version: 1\nname: t\n"
      "things:\n  - {name: yard, model: {builder: square_playground}}\n"
      "  - {name: heap, count: 2, model: {builder: box_pile, count: 3}, distribution: {grid: {spacing: 3}}}\n"
      "robots:\n  - name: s\n    model: {builder: snake, segments: 3}\n";
  const auto loaded = [&](std::vector<formats::Override> overrides) {
    Diagnostics diagnostics;
    LoadOptions options;
    options.text = text;
    options.overrides = overrides;
    return load("t.yaml", options, diagnostics);
  };
  const auto setup = loaded({{"robots[0].model.segments", "20"}});
  ASSERT_TRUE(setup) << setup.error().text();
  ASSERT_EQ(setup->instances.size(), 5u);  // the ground, too
  EXPECT_EQ(setup->instances[1].name, "yard");
  EXPECT_EQ(setup->instances[3].name, "heap2");
  EXPECT_FALSE(setup->instances[3].is_robot);
  EXPECT_NEAR(norm(setup->instances[3].X_WM.p - setup->instances[2].X_WM.p), 3, 1e-9);
  EXPECT_EQ(setup->instances[4].model->links.size(), 20u);
  EXPECT_TRUE(setup->instances[4].is_robot);
  EXPECT_EQ(setup->instances[4].X_WM.p.z, 0.1) << "it lies on the ground";
  const auto broken = loaded({{"things[0].model.height", "-1"}});
  EXPECT_THAT(broken ? "" : broken.error().text(), HasSubstr("/things/0/model/height: "));
  const auto no_model = loaded({{"robots[0].model", "[1, 2]"}});
  EXPECT_THAT(no_model ? "" : no_model.error().text(),
              HasSubstr("name a model file, or write {builder: ...}"));
}

TEST(Builders, AScenarioNamesThemAsTheCommandLineDoes) {
  const auto loaded = [](const std::string& robot) {
    Diagnostics diagnostics;
    LoadOptions options;
    const std::string text = "version: 1\nrobots:\n  - " + robot + "\n";
    options.text = text;
    return load("t.yaml", options, diagnostics);
  };
  const auto setup = loaded(
      "{name: s, model: 'builder:snake?segments=3&length=40 cm', modules: [{id: m, model: "
      "builder:diff_robot}]}");
  ASSERT_TRUE(setup) << setup.error().text();
  const auto same = loaded("{name: s, model: {builder: snake, segments: 3, length: 40 cm}}");
  ASSERT_TRUE(same) << same.error().text();
  const auto& links = setup->instances.at(1).model->links;
  const auto& links_of_snake = same->instances.at(1).model->links;
  ASSERT_GT(links.size(), links_of_snake.size()) << "the module's follow";
  for (std::size_t i = 0; i < links_of_snake.size(); ++i) {
    EXPECT_EQ(links[i].name, links_of_snake[i].name);
    EXPECT_EQ(links[i].X_ML, links_of_snake[i].X_ML);
  }
  const auto wrong = loaded("{name: s, model: builder:snak}");
  EXPECT_EQ(wrong ? "" : wrong.error().text(),
            "t.yaml:3:22: /robots/0/model/builder: there is no builder 'snak'; did you mean 'snake'?");
  const auto not_a_parameter = loaded("{name: s, model: 'builder:snake?segments'}");
  EXPECT_EQ(not_a_parameter ? "" : not_a_parameter.error().text(),
            "t.yaml:3:22: 'segments' is not a parameter; write key=value, with & between them");
}

TEST(Builders, AScenarioSaysWhereAParameterIsWrong) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.text = "version: 1\nrobots:\n  - name: s\n    model:\n      builder: snake\n      segments: 0\n";
  const auto setup = load("t.yaml", options, diagnostics);
  ASSERT_FALSE(setup);
  EXPECT_THAT(setup.error().text(), StartsWith("t.yaml:6:17: /robots/0/model/segments: "));
}

// --- motion ---

TEST(Creatures, ABallRollsTowardsWhereItsMassesMove) {
  // The centre of mass moves ahead of the point it stands on, so it rolls that way; about y for x, about -x for y.
  for (const bool sideways : {false, true}) {
    const auto simulation = world(
        std::string("robots:\n  - name: ball\n    model: {builder: sphere_robot, shell_mass: 1}\n") +
        "    controller: {kind: sequence, steps: [{at: 0, orders: {" + (sideways ? "y" : "x") +
        ": 0.2}}]}\n");
    test::advance(*simulation, 60);
    const Vec3 p = place_of(*simulation, "ball");
    EXPECT_GT(sideways ? p.y : p.x, 0.05);
    EXPECT_NEAR(sideways ? p.x : p.y, 0, 0.005);
  }
}

TEST(Creatures, ABarrelRollsAlongX) {
  const auto simulation = world(
      "robots:\n  - name: barrel\n    model: {builder: barrel_robot, shell_mass: 1.5}\n"
      "    controller: {kind: sequence, steps: [{at: 0, orders: {x: -0.2}}]}\n");
  test::advance(*simulation, 60);
  EXPECT_LT(place_of(*simulation, "barrel").x, -0.05);
  EXPECT_NEAR(place_of(*simulation, "barrel").y, 0, 1e-3);
}

TEST(Creatures, ASnakeGoesWhereItsWavesComeFrom) {
  // A skin that slides along more easily than across: waves that run to the tail drive it forward, and the other way round.
  const auto forward_m = [](const char* shift, const char* along) {
    const auto simulation = world(
        std::string("robots:\n  - name: s\n    model: {builder: snake, segments: 8, length: 0.25, diameter: "
                    "0.12, mass: "
                    "0.2, power: 2, friction_along: ") +
        along + "}\n    controller: {kind: sine, period: 1 s, amplitude: 0.5, phase_shift: " + shift + "}\n");
    test::advance(*simulation, 300);
    return place_of(*simulation, "s").x;
  };
  EXPECT_GT(forward_m("45 deg", "0.1"), 0.3);
  EXPECT_LT(forward_m("-45 deg", "0.1"), -0.3);
  EXPECT_LT(std::abs(forward_m("45 deg", "1")), 0.3) << "an even skin hardly drives";
}

TEST(Creatures, AHexapodAdvancesInItsTripodGait) {
  const auto simulation = world(
      "robots:\n  - name: h\n    model: {builder: hexapod}\n    controller:\n      kind: sine\n      period: "
      "1 s\n"
      "      phase_shift: 0\n      amplitudes: [0.5, 0.35, 0.5, 0.35, 0.5, 0.35, 0.5, 0.35, 0.5, 0.35, 0.5, "
      "0.35]\n"
      "      phases: [0, 90 deg, 180 deg, 270 deg, 0, 90 deg, 180 deg, 270 deg, 0, 90 deg, 180 deg, 270 "
      "deg]\n");
  test::advance(*simulation, 300);
  const Vec3 p = place_of(*simulation, "h");
  // A foot sweeps 2 * leg * sin(spread) ... at most 2 sin(0.5) * (leg * sin(30 deg)) = 0.29 m per stance: six of them in 3 s.
  EXPECT_GT(p.x, 0.3 * 6 * 0.29);
  EXPECT_LT(p.x, 1.2 * 6 * 0.29);
  EXPECT_LT(std::abs(p.y), 0.3);
  EXPECT_NEAR(p.z, 0.6 * math::cos(math::pi / 6) + 0.042, 0.12) << "it keeps standing";
}

TEST(Creatures, WheelsRollAsFarAsTheyTurn) {
  for (const auto& [name, motors, radius] :
       {std::tuple("two_wheeled", "left: 4, right: 4", 0.25 + 1.0 / 600),
        std::tuple("four_wheeled", "front_left: 4, front_right: 4, rear_left: 4, rear_right: 4", 0.15)}) {
    const auto simulation = world(std::string("robots:\n  - name: it\n    model: {builder: ") + name +
                                  "}\n    controller: {kind: sequence, steps: [{at: 0, orders: {" + motors +
                                  "}}]}\n");
    test::advance(*simulation, 100);
    const double before = place_of(*simulation, "it").x;
    test::advance(*simulation, 100);
    EXPECT_NEAR(place_of(*simulation, "it").x - before, 4 * radius, 0.05 * 4 * radius) << name;
  }
}

TEST(Creatures, RingsRollByChangingTheirShape) {
  for (const char* const ring : {"slider_wheelie", "armband"}) {
    const auto simulation = world(
        std::string("robots:\n  - name: ring\n    model: {builder: ") + ring +
        "}\n    controller: {kind: sine, period: 1.6 s, amplitude: 0.4, phase_shift: 90 deg}\n");
    double farthest = 0;
    for (int i = 0; i < 40; ++i) {
      test::advance(*simulation, 10);
      farthest = std::max(farthest, std::abs(place_of(*simulation, "ring").x));
    }
    EXPECT_GT(farthest, 0.3) << ring;
  }
}

TEST(Creatures, ASeesawTipsToTheHeavierSide) {
  const auto simulation = world(
      "things:\n  - {name: seesaw, model: {builder: seesaw}}\n"
      "  - {name: load, model: {builder: box_pile, count: 1, smallest: 0.2, largest: 0.2}, pose: [1.2, 0, "
      "0.3, 0, 0, 0]}\n");
  test::advance(*simulation, 150);
  // The plank's right end is on the ground: its slope is height / (length / 2), and turning x down is positive about y.
  const auto bodies = simulation->engine().bodies(*simulation->find_instance("seesaw"));
  const Quat q = simulation->engine().states()[bodies[1].index].X_WB.q;
  EXPECT_NEAR(rpy_from_quat(q).y, math::asin(0.25 / 1.5), 0.03);
}

/// A robot of wheels goes where it is told at each level its drive has.
struct Told {
  const char* builder;
  const char* level;
  bool sideways;
};
void PrintTo(const Told& told, std::ostream* out) { *out << told.builder << " " << told.level; }
class EachDrive : public testing::TestWithParam<Told> {};
constexpr Told all_told[] = {{"diff_robot", "ideal", false},      {"diff_robot", "contact", false},
                             {"skid_robot", "ideal", false},      {"skid_robot", "contact", false},
                             {"tracked_robot", "ideal", false},   {"tracked_robot", "contact", false},
                             {"ackermann_robot", "ideal", false}, {"ackermann_robot", "contact", false},
                             {"swerve_robot", "ideal", true},     {"swerve_robot", "contact", true},
                             {"omni_robot", "ideal", true},       {"omni_robot", "contact", true},
                             {"omni_robot", "rollers", true},     {"mecanum_robot", "ideal", true},
                             {"mecanum_robot", "contact", true},  {"mecanum_robot", "rollers", true}};
INSTANTIATE_TEST_SUITE_P(All, EachDrive, testing::ValuesIn(all_told));

TEST_P(EachDrive, GoesWhereItIsTold) {
  const Told told = GetParam();
  const auto simulation = world(std::string("robots:\n  - name: it\n    model: {builder: ") + told.builder +
                                "}\n    devices: {drive: {level: " + told.level +
                                "}}\n    controller: {kind: sequence, steps: [{at: 0, orders: {drive: " +
                                (told.sideways ? "[0.3, 0.3]" : "[0.4]") + "}}]}\n");
  // When it has its speed, after 0.4 / 2 s and some time to settle, it goes on at that speed: rails exactly, wheels by contact
  // within 5 % (facts on engines: 1 % of slip at most on even ground), and rollers clatter.
  test::advance(*simulation, 60);
  const Vec3 before = place_of(*simulation, "it");
  test::advance(*simulation, 60);
  const Vec3 way = place_of(*simulation, "it") - before;
  const double share = std::string_view(told.level) == "ideal" ? 1e-6 : 0.05;
  const Vec3 expected = told.sideways ? Vec3{0.18, 0.18, 0} : Vec3{0.24, 0, 0};
  EXPECT_NEAR(way.x, expected.x, share * 0.24);
  EXPECT_NEAR(way.y, expected.y, share * 0.24);
  EXPECT_NEAR(way.z, 0, 0.004);
}

}  // namespace
}  // namespace sandlot
