#include "controllers/clearing/clearing.h"

#include <cmath>

#include "base/math.h"
#include "controllers/test_rig.h"

namespace sandlot::controllers::clearing {
namespace {

using Rig = FieldRig<Clearing>;

/// Destination: a disc of 0.5 m about the origin.
Spec spec(const std::string& radio = "") { return {.radio = radio, .radius_m = 0.5, .margin_m = 0.1}; }

TEST(Clearing, ChoosesTheClosestObjectOutsideTheDestination) {
  Rig rig(spec());
  rig.put("me", "pusher", 2, 0);
  rig.put("inside", "box", 0.3, 0);  // 0.3 < 0.5 - 0.1
  rig.put("edge", "box", 0.45, 0);   // outside by the margin: 1.55 m away
  rig.put("far", "box", 3.6, 0);     // 1.6 m away
  rig.put("can", "can", 1.9, 0);     // another label
  rig.step(0);
  EXPECT_EQ(rig.controller.state.object, "edge");
  EXPECT_EQ(rig.controller.state.phase, Phase::approach);
  EXPECT_NEAR(rig.controller.state.nearest_m, 0.45 - 0.4, 1e-12);
}

TEST(Clearing, DrivesToThePlaceBehindTheObject) {
  // The box at (2, 0), the destination at the origin: behind is (2 + standoff, 0).
  Spec s = spec();
  s.standoff_m = 0.34;
  Rig rig(s);
  rig.put("me", "pusher", 2.34, 2, -math::pi / 2);
  rig.put("box", "box", 2, 0);
  rig.step(0);
  EXPECT_NEAR(rig.twist().linear.x, s.speed_mps, 1e-9);  // straight ahead of it
  EXPECT_NEAR(rig.twist().angular.z, 0, 1e-9);
  // There, it turns to the destination first, then pushes.
  rig.put("me", "pusher", 2.34, 0, -math::pi / 2);
  rig.step(0.1);
  EXPECT_EQ(rig.twist().linear.x, 0);
  EXPECT_NEAR(std::abs(rig.twist().angular.z), s.turn_speed_radps, 1e-12);
  rig.put("me", "pusher", 2.34, 0, math::pi);
  rig.step(0.2);
  EXPECT_EQ(rig.controller.state.phase, Phase::push);
  EXPECT_NEAR(rig.twist().linear.x, s.push_speed_mps, 1e-12);
  EXPECT_NEAR(rig.twist().angular.z, 0, 1e-9);
}

TEST(Clearing, GoesAroundTheObjectInsteadOfThroughIt) {
  Rig rig(spec());
  rig.put("me", "pusher", 1, 0.01);
  rig.put("box", "box", 2, 0);
  rig.step(0);
  // The tangent to the disc of object_clearance about the box: asin(0.26 / 1) to one side.
  const double bearing = math::asin(0.26 / math::hypot(1, 0.01)) - math::atan2(0.01, 1);
  EXPECT_NEAR(rig.twist().angular.z, 3 * bearing, 0.01);
  EXPECT_GT(rig.twist().angular.z, 0.5);
}

TEST(Clearing, SteersTowardsTheDestinationAndTheSlidingObject) {
  Rig rig(spec());
  rig.controller.state.phase = Phase::push;
  rig.controller.state.object = "box";
  rig.controller.state.nearest_m = 9;
  rig.controller.state.patience_s = 20;
  // Heading -x, the destination straight ahead, the box 5 cm to the robot's left (which is -y).
  rig.put("me", "pusher", 2, 0, math::pi);
  rig.put("box", "box", 1.83, -0.05);
  rig.step(0);
  EXPECT_EQ(rig.controller.state.phase, Phase::push);
  EXPECT_GT(rig.twist().angular.z, 0.3);
  // The box in the middle, the destination to the left: a turn to the left.
  rig.put("me", "pusher", 2, 0.5, math::pi);
  rig.put("box", "box", 1.83, 0.5);
  rig.step(0.1);
  EXPECT_GT(rig.twist().angular.z, 0.3);
}

TEST(Clearing, BacksOffAndGoesBehindAgainWhenTheObjectSlidesOutOfTheZone) {
  Rig rig(spec());
  rig.controller.state.phase = Phase::push;
  rig.controller.state.object = "box";
  rig.controller.state.nearest_m = 9;
  rig.controller.state.patience_s = 20;
  rig.put("me", "pusher", 2, 0, math::pi);
  rig.put("box", "box", 1.83, 0.15);
  rig.step(0);
  EXPECT_EQ(rig.controller.state.phase, Phase::back_off);
  EXPECT_EQ(rig.controller.state.slid, 1u);
  rig.step(0.5);
  EXPECT_LT(rig.twist().linear.x, 0);
  rig.step(1.0);  // after 0.9 s
  EXPECT_EQ(rig.controller.state.phase, Phase::approach);
  EXPECT_EQ(rig.controller.state.object, "box");
}

TEST(Clearing, TakesTheNextOneWhenTheObjectIsInside) {
  Rig rig(spec());
  rig.controller.state.phase = Phase::push;
  rig.controller.state.object = "box";
  rig.controller.state.patience_s = 20;
  rig.put("me", "pusher", 0.56, 0, math::pi);
  rig.put("box", "box", 0.39, 0);
  rig.put("other", "box", 3, 0);
  rig.step(0);
  EXPECT_EQ(rig.controller.state.delivered, 1u);
  EXPECT_EQ(rig.controller.state.phase, Phase::back_off);
  rig.step(1);
  EXPECT_EQ(rig.controller.state.object, "other");
}

TEST(Clearing, LeavesAnObjectAloneThatDoesNotComeNearer) {
  Spec s = spec();
  s.patience_s = 10;
  Rig rig(s);
  rig.put("me", "pusher", 5, 0);
  rig.put("box", "box", 3, 0);
  rig.put("other", "box", 9.5, 0);
  rig.step(0);
  EXPECT_EQ(rig.controller.state.object, "box");
  // It moves about, or it would back off as one that is jammed.
  const auto sway_until = [&](int from_s, int to_s) {
    for (int s = from_s; s <= to_s; ++s) {
      rig.camera.message.objects[0].pose.p.x = s % 2 == 0 ? 5 : 5.2;
      rig.step(s);
    }
  };
  sway_until(1, 7);  // patience: 10 s, a quarter more or less
  EXPECT_EQ(rig.controller.state.object, "box");
  sway_until(8, 15);
  EXPECT_EQ(rig.controller.state.object, "other");
  EXPECT_EQ(rig.controller.state.left_alone, "box");
}

TEST(Clearing, BacksOffWhenItDoesNotGetAway) {
  Rig rig(spec());
  rig.put("me", "pusher", 3, 0);
  rig.put("box", "box", 2, 0);
  for (const double now_s : {1.0, 2.0, 3.0, 4.0}) rig.step(now_s);
  EXPECT_EQ(rig.controller.state.jammed, 0u);
  rig.step(4.1);  // for more than three seconds
  EXPECT_EQ(rig.controller.state.jammed, 1u);
  rig.step(4.5);
  EXPECT_LT(rig.twist().linear.x, 0);
  rig.step(5.1);
  EXPECT_EQ(rig.controller.state.object, "box");
  EXPECT_EQ(rig.controller.state.phase, Phase::approach);
}

TEST(Clearing, OfTwoBidsTheSmallerWins) {
  Rig rig(spec("radio"));
  rig.put("me", "pusher", 3, 0);
  rig.put("mate", "pusher", 1.5, 3);
  rig.put("near", "box", 2, 0);
  rig.put("far", "box", 3, 3);
  rig.step(0);
  EXPECT_EQ(rig.sent(), "near 1001");  // 1 m, and 1 mm so that only pushing bids 0
  // The mate bids more: nothing changes. It bids less: the other object.
  rig.hear("mate", "near 1500");
  rig.step(0.1);
  EXPECT_EQ(rig.controller.state.object, "near");
  rig.hear("mate", "near 0");
  rig.step(0.2);
  EXPECT_EQ(rig.controller.state.object, "far");
  EXPECT_EQ(rig.controller.state.yielded, 1u);
  EXPECT_EQ(rig.sent(), "far 3001");
  // Silence for more than two seconds, and it is forgotten.
  rig.controller.state.object.clear();
  rig.controller.state.phase = Phase::choose;
  rig.step(2.3);
  EXPECT_EQ(rig.controller.state.object, "near");
}

TEST(Clearing, OfEqualBidsTheNameThatPrecedesWins) {
  for (const char* const mate : {"aa", "zz"}) {
    Rig rig(spec("radio"));
    rig.put("me", "pusher", 3, 0);
    rig.put("near", "box", 2, 0);
    rig.hear(mate, "near 1001");
    rig.step(0);
    EXPECT_EQ(rig.controller.state.object, std::string(mate) == "aa" ? "" : "near") << mate;
  }
}

TEST(Clearing, IgnoresPacketsThatAreNoClaims) {
  Rig rig(spec("radio"));
  rig.put("me", "pusher", 3, 0);
  rig.put("near", "box", 2, 0);
  for (const char* const text : {"", "near", "near x", "near 1 2", "nobody 1", "near -1", "near 99999999999"})
    rig.hear("mate", text);
  rig.hear("me", "near 0");
  rig.step(0);
  EXPECT_TRUE(rig.controller.state.claims.empty());
  for (std::size_t i = 0; i < 2 * Clearing::most_claims; ++i)
    rig.hear("mate" + std::to_string(i), "near 9000");
  rig.step(0.1);
  EXPECT_EQ(rig.controller.state.claims.size(), Clearing::most_claims);
  EXPECT_TRUE(rig.controller.fits());
  rig.controller.state.claims.resize(Clearing::most_claims + 1);
  EXPECT_FALSE(rig.controller.fits());
}

TEST(Clearing, WithoutRadioItSendsNothing) {
  Rig rig(spec());
  rig.put("me", "pusher", 3, 0);
  rig.put("near", "box", 2, 0);
  rig.hear("mate", "near 0");
  rig.step(0);
  EXPECT_EQ(rig.sent(), "nothing");
  EXPECT_EQ(rig.controller.state.object, "near");
}

TEST(Clearing, StandsWhenTheCameraDoesNotSeeIt) {
  Rig rig(spec());
  rig.put("box", "box", 2, 0);
  rig.step(0);
  EXPECT_EQ(rig.twist().linear.x, 0);
  EXPECT_EQ(rig.twist().angular.z, 0);
}

}  // namespace
}  // namespace sandlot::controllers::clearing
