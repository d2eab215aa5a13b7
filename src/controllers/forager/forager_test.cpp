#include "controllers/forager/forager.h"

#include <cmath>

#include "base/math.h"
#include "controllers/test_rig.h"

namespace sandlot::controllers::forager {
namespace {

using Rig = FieldRig<Forager>;

/// The nest: a disc of 0.6 m about the origin.
Spec spec() { return {.nest_radius_m = 0.6, .grip_m = 0.2}; }
bool closes(const Rig& rig) { return rig.order<msg::Bool>(3).value_or(msg::Bool{}).data; }

TEST(Forager, GoesForTheNearestItemThatNobodyIsNearerTo) {
  Rig rig(spec());
  rig.put("me", "ant", 1, 0);
  rig.put("mate", "ant", 2, 1);
  rig.put("in the nest", "item", 0.3, 0);
  rig.put("the mate's", "item", 2, 0.2);  // 1.02 m from me, 0.8 m from the mate
  rig.put("mine", "item", 1, -1.5);
  rig.step(0);
  EXPECT_EQ(rig.controller.state.item, "mine");
  EXPECT_FALSE(closes(rig));
}

TEST(Forager, ClosesInFrontOfAnItemOpensAndTriesAgain) {
  Rig rig(spec());
  rig.put("me", "ant", 1, 0);
  rig.put("mine", "item", 1.18, 0);
  rig.step(0);
  EXPECT_TRUE(closes(rig));
  rig.step(0.1);
  EXPECT_FALSE(closes(rig));
  rig.step(0.2);
  EXPECT_TRUE(closes(rig));
}

TEST(Forager, BringsHomeWhatItHoldsAndLetsGoInTheNest) {
  Rig rig(spec());
  rig.put("me", "ant", 2, 0, math::pi);
  rig.put("mine", "item", 1.85, 0);
  rig.hand.message.held = "mine::body";
  rig.step(0);
  EXPECT_EQ(rig.controller.state.phase, Phase::carry);
  EXPECT_TRUE(closes(rig));
  EXPECT_NEAR(rig.twist().linear.x, 0.4, 1e-9);
  rig.put("me", "ant", 0.5, 0, math::pi);
  rig.put("mine", "item", 0.35, 0);  // within 0.7 of the radius
  rig.step(1);
  EXPECT_FALSE(closes(rig));
  EXPECT_EQ(rig.controller.state.brought, 1u);
  rig.hand.message.held.clear();
  rig.step(1.5);
  EXPECT_LT(rig.twist().linear.x, 0);
}

TEST(Forager, ChargesBeforeItIsEmpty) {
  Spec s = spec();
  s.battery = "battery";
  s.stations_m = {{5, 5}, {1, 2}};
  Rig rig(s);
  rig.put("me", "ant", 1, 0, math::pi / 2);
  rig.put("mine", "item", 3, 0);
  rig.battery.message.percentage = 0.29f;
  rig.step(0);
  EXPECT_EQ(rig.controller.state.phase, Phase::charge);
  EXPECT_NEAR(rig.twist().linear.x, 0.4, 1e-9);  // to the nearer station, straight ahead
  rig.put("me", "ant", 1, 1.95, math::pi / 2);
  rig.battery.message.percentage = 0.6f;
  rig.step(1);
  EXPECT_EQ(rig.controller.state.phase, Phase::charge);
  EXPECT_EQ(rig.twist().linear.x, 0);
  rig.battery.message.percentage = 0.96f;
  rig.step(2);
  rig.step(2.1);
  EXPECT_EQ(rig.controller.state.phase, Phase::search);
  EXPECT_EQ(rig.controller.state.item, "mine");
}

TEST(Forager, LeavesAnItemAloneThatItCannotCatch) {
  Rig rig(spec());
  rig.put("me", "ant", 1, 0);
  rig.put("mine", "item", 1.5, 0);
  rig.put("other", "item", 3, 0);
  rig.step(0);
  rig.step(21);
  EXPECT_EQ(rig.controller.state.item, "other");
}

}  // namespace
}  // namespace sandlot::controllers::forager
