#include "physics/pair_surface.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "physics/substance.h"

namespace sandlot {
namespace {

using model::substance_from;
using model::Surface;

TEST(Substance, PresetsAreTheTable) {
  const auto is = [](const char* text, model::Substance expected) {
    const auto read = substance_from(text);
    ASSERT_TRUE(read) << text << read.error().text();
    EXPECT_EQ(read->substance, expected) << text;
    EXPECT_EQ(read->warning, "") << text;
    EXPECT_EQ(substance_from(text_of(read->substance))->substance, expected) << text;
  };
  is("metal(0.3)", {0.3, 0.01, 200, 0.8});
  is("plastic(0.8)", {});
  is("plastic", {});
  is("rubber(7.5)", {3, 0, 7.5, 0.95});
  is("foam(30)", {2, 0.1, 30, 0});
  is("snow(0.25)", {0.75, 0.25, 40, 0});
  is("0.1 0.2 3 0.4", {0.1, 0.2, 3, 0.4});
  is("[0.1, 0.2, 3, 0.4]", {0.1, 0.2, 3, 0.4});
  EXPECT_EQ(text_of(model::Substance{3, 0, 7.5, 0.95}), "rubber(7.5)");
  EXPECT_EQ(text_of(model::Substance{3, 0, 7.5, 0.9}), "3 0 7.5 0.9");
}

TEST(Substance, OutsideTheTableIsStrangeAndImpossibleIsRefused) {
  for (const char* text : {"metal(2.5)", "plastic(4)", "rubber(60)", "rubber(1)", "foam(0.5)"}) {
    const auto read = substance_from(text);
    ASSERT_TRUE(read) << text;
    EXPECT_NE(read->warning.find("usual"), std::string::npos) << text;
  }
  for (const char* text : {"", "wood", "metal(", "metal()", "metal(0.5", "metal(nan)", "metal(-1)",
                           "rubber(0)", "foam(-3)", "snow(1.5)", "snow(-0.1)", "1 2 3", "1 2 3 4 5",
                           "1 2 0 0.5", "1 2 3 1.5", "-1 0 1 0", "1 1e999 3 0.5", "metal(0.5) x"})
    EXPECT_FALSE(substance_from(text)) << text;
}

TEST(Substance, ThePairLawIsTheOneOfTheTable) {
  // rubber(20) on metal(0.5): mu 3 * 0.5, slip 0 + 0.01, h1 h2 / (h1 + h2) = 4000 / 220,
  // ((1 - 0.95) 200 + (1 - 0.8) 20) / 220 = 14 / 220
  const model::Substance rubber = substance_from("rubber(20)")->substance,
                         metal = substance_from("metal(0.5)")->substance;
  for (const SubstancePair pair : {combine(rubber, metal), combine(metal, rubber)}) {
    EXPECT_DOUBLE_EQ(pair.mu, 1.5);
    EXPECT_DOUBLE_EQ(pair.slip, 0.01);
    EXPECT_DOUBLE_EQ(pair.stiffness_N_per_m, 100 * 4000.0 / 220);
    EXPECT_NEAR(pair.damping_N_s_per_m, 50 * 14.0 / 220, 1e-13);
  }
}

TEST(PairSurface, SubstancesDecideWhereBothHaveOne) {
  Surface a, b;
  a.mu = 0.1, a.restitution = 0.9, a.soft_cfm = 1, a.fdir1 = {1, 0, 0};
  a.substance = model::Substance{};
  const PairSurface plain = combine(a, b);
  EXPECT_EQ(plain.mu, 0.1);
  EXPECT_EQ(plain.restitution, 0.9);
  EXPECT_FALSE(plain.stiffness_N_per_m);
  b.substance = model::Substance{};
  const PairSurface pair = combine({a, {}}, {b, {}}, {0, 0, 1});
  EXPECT_DOUBLE_EQ(pair.mu, 0.64);
  EXPECT_EQ(pair.mu2, pair.mu);
  EXPECT_EQ(pair.fdir1_W, (Vec3{}));
  EXPECT_EQ(pair.restitution, 0);
  EXPECT_FALSE(pair.soft_cfm);
  EXPECT_DOUBLE_EQ(*pair.stiffness_N_per_m, 2000);
  EXPECT_DOUBLE_EQ(*pair.damping_N_s_per_m, 25);
}

TEST(PairSurface, FrictionIsTheSmallerBounceTheLarger) {
  Surface a, b;
  a.mu = 0.3, b.mu = 0.7;
  a.mu2 = 0.1;  // means nothing without a direction
  a.restitution = 0.2, b.restitution = 0.6;
  a.restitution_threshold_mps = 1, b.restitution_threshold_mps = 2;
  a.rolling_resistance_m = 0.001, b.rolling_resistance_m = 0.002;
  for (const PairSurface& pair : {combine(a, b), combine(b, a)}) {
    EXPECT_DOUBLE_EQ(pair.mu, 0.3);
    EXPECT_DOUBLE_EQ(pair.mu2, 0.3);
    EXPECT_DOUBLE_EQ(pair.restitution, 0.6);
    EXPECT_DOUBLE_EQ(pair.restitution_threshold_mps, 2);
    EXPECT_DOUBLE_EQ(pair.rolling_resistance_m, 0.003);
    EXPECT_FALSE(pair.soft_erp || pair.soft_cfm || pair.stiffness_N_per_m || pair.max_correction_mps);
  }
}

TEST(PairSurface, WhatHasAHighThresholdSwallowsTheBounceOfTheOther) {
  Surface net, ball;
  net.restitution_threshold_mps = 1000;
  ball.restitution = 0.6;
  for (const PairSurface& pair : {combine(net, ball), combine(ball, net)}) {
    EXPECT_DOUBLE_EQ(pair.restitution, 0.6);
    EXPECT_DOUBLE_EQ(pair.restitution_threshold_mps, 1000);
  }
}

TEST(PairSurface, ADirectionBelongsToOneOfThem) {
  Surface wheel, floor;
  wheel.mu = 1, wheel.mu2 = 0.2, wheel.fdir1 = {1, 0, 0};
  floor.mu = 0.5;
  const Quat left = quat_from_rpy(0, 0, math::pi / 2);
  const PairSurface pair = combine({floor, {}}, {wheel, left}, {0, 0, 1});
  EXPECT_NEAR(norm(pair.fdir1_W - Vec3{0, 1, 0}), 0, 1e-15);
  EXPECT_DOUBLE_EQ(pair.mu, 0.5);
  EXPECT_DOUBLE_EQ(pair.mu2, 0.2);
  Surface ice = wheel;
  ice.mu = 0.05;
  EXPECT_NEAR(combine({wheel, {}}, {ice, left}, {0, 0, 1}).fdir1_W.y, 1, 1e-15);
  EXPECT_NEAR(combine({ice, left}, {wheel, {}}, {0, 0, 1}).fdir1_W.y, 1, 1e-15);
}

TEST(PairSurface, SpringsAreInSeriesAndCompliancesAdd) {
  Surface a, b;
  a.slip1 = 0.01, b.slip1 = 0.02;
  a.soft_cfm = 1e-3, b.soft_cfm = 2e-3;
  a.soft_erp = 0.5, b.soft_erp = 0.1;
  a.stiffness_N_per_m = 3000, b.stiffness_N_per_m = 6000;
  a.damping_N_s_per_m = 5;
  a.max_correction_mps = 0.1, b.max_correction_mps = 0.2;
  const PairSurface pair = combine(a, b);
  EXPECT_DOUBLE_EQ(pair.slip1, 0.03);
  EXPECT_DOUBLE_EQ(pair.slip2, 0.03);
  EXPECT_DOUBLE_EQ(*pair.soft_cfm, 3e-3);
  EXPECT_DOUBLE_EQ(*pair.soft_erp, 0.1);
  EXPECT_DOUBLE_EQ(*pair.stiffness_N_per_m, 2000);
  EXPECT_DOUBLE_EQ(*pair.damping_N_s_per_m, 6);  // b's is SDF's default, 1
  EXPECT_DOUBLE_EQ(*pair.max_correction_mps, 0.1);
  b = {};
  EXPECT_DOUBLE_EQ(*combine(b, a).stiffness_N_per_m, 3000);
  EXPECT_DOUBLE_EQ(*combine(b, a).damping_N_s_per_m, 5);
}

TEST(PairSurface, ASkinScalesFrictionAlongItsAxis) {
  Surface snake, floor;
  snake.mu = 0.5;
  snake.skin = model::Skin{{1, 0, 0}, 0.1};
  PairSurface pair = combine({snake, quat_from_rpy(0, 0, math::pi / 2)}, {floor, {}}, {0, 0, 1});
  EXPECT_DOUBLE_EQ(pair.mu, 0.05);
  EXPECT_DOUBLE_EQ(pair.mu2, 0.5);
  EXPECT_NEAR(norm(pair.fdir1_W - Vec3{0, 1, 0}), 0, 1e-15);
  // On its nose, with the axis up: the squared sine of 18 deg is 0.0955, of 19 deg 0.106.
  pair = combine({snake, quat_from_rpy(0, math::pi / 2 - 0.314, 0)}, {floor, {}}, {0, 0, 1});
  EXPECT_EQ(pair.fdir1_W, (Vec3{}));
  EXPECT_DOUBLE_EQ(pair.mu, 0.5);
  pair = combine({snake, quat_from_rpy(0, math::pi / 2 - 0.332, 0)}, {floor, {}}, {0, 0, 1});
  EXPECT_NE(pair.fdir1_W, (Vec3{}));
  // On top of substances too.
  snake.substance = floor.substance = model::Substance{};
  pair = combine({snake, {}}, {floor, {}}, {0, 0, 1});
  EXPECT_DOUBLE_EQ(pair.mu, 0.064);
  EXPECT_DOUBLE_EQ(pair.mu2, 0.64);
  // The more slippery skin counts.
  floor.skin = model::Skin{{0, 1, 0}, 0.01};
  EXPECT_EQ(combine({snake, {}}, {floor, {}}, {0, 0, 1}).fdir1_W, (Vec3{0, 1, 0}));
}

TEST(PairSurface, BeltsAreSeenFromTheFirst) {
  Surface a, b;
  a.belt_velocity_mps = {0.2, 0, 0};
  b.belt_velocity_mps = {0.7, 0, 0};
  const Vec3 v = combine({a, {}}, {b, quat_from_rpy(0, 0, math::pi / 2)}, {0, 0, 1}).belt_velocity_W_mps;
  EXPECT_NEAR(norm(v - Vec3{-0.2, 0.7, 0}), 0, 1e-15);
}

TEST(ZoneMap, TheLastZoneThatHoldsThePointCounts) {
  model::SurfaceZone square{"square", {{0, 0, 5}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, {}, 0, {}, {}};
  model::SurfaceZone dent{"dent", {{4, 0, 0}, {8, 0, 0}, {8, 4, 0}, {6, 1, 0}, {4, 4, 0}}, {}, 0, {}, {}};
  model::SurfaceZone disc{"disc", {}, {2, 2, 0}, 1, {}, {}};
  const ZoneMap map(std::vector{square, dent, disc});
  const auto at = [&](double x, double y) {
    const model::SurfaceZone* const zone = map.find({x, y, -3});
    return zone ? zone->name : "";
  };
  EXPECT_EQ(at(0.5, 0.5), "square");
  EXPECT_EQ(at(1.9, 1.9), "disc");
  EXPECT_EQ(at(2.5, 2.5), "disc");
  EXPECT_EQ(at(2.8, 2.8), "");
  EXPECT_EQ(at(6, 0.5), "dent");
  EXPECT_EQ(at(6, 2), "");
  EXPECT_EQ(at(7.9, 2), "dent");
  EXPECT_EQ(at(-0.1, 1), "");
  // Neighbours share no point of their border and leave none out.
  model::SurfaceZone right = square;
  right.name = "right";
  for (Vec3& corner : right.outline_W) corner.x += 2;
  EXPECT_TRUE(ZoneMap(std::vector{right}).find({2, 1, 0}) != nullptr);
  EXPECT_TRUE(ZoneMap(std::vector{square}).find({2, 1, 0}) == nullptr);
  EXPECT_TRUE(ZoneMap().empty() && !ZoneMap().find({}));
}

}  // namespace
}  // namespace sandlot
