#include "controllers/predator/predator.h"

#include <cmath>

#include "base/math.h"
#include "controllers/test_rig.h"

namespace sandlot::controllers::predator {
namespace {

using Rig = FieldRig<Predator>;

TEST(Predator, PursuitDrivesAtTheNearestPrey) {
  Rig rig({.strategy = Strategy::pursuit, .speed_mps = 0.4});
  rig.put("me", "predator", 0, 0, math::pi / 4);
  rig.put("a", "prey", 3, 3);
  rig.put("b", "prey", -4, -4);
  rig.step(0);
  EXPECT_NEAR(rig.twist().linear.x, 0.4, 1e-12);
  EXPECT_NEAR(rig.twist().angular.z, 0, 1e-12);
}

TEST(Predator, LeadMeetsThePreyOnTheInterceptTriangle) {
  Predator predator;
  predator.spec = {.speed_mps = 0.5, .horizon_s = 100};
  // 4 m ahead, crossing at 0.3 m/s: 3-4-5, so that they meet after 4 / 0.4 = 10 s at (4, 3).
  const Vec3 met = predator.meeting_point({0, 0, 0}, {4, 0, 0}, {0, 0.3, 0});
  EXPECT_NEAR(met.x, 4, 1e-12);
  EXPECT_NEAR(met.y, 3, 1e-12);
  // Faster and running away: never; it aims at where the prey is after the horizon.
  predator.spec.horizon_s = 2;
  EXPECT_NEAR(predator.meeting_point({0, 0, 0}, {1, 0, 0}, {0.7, 0, 0}).x, 1 + 2 * 0.7, 1e-12);
  // As fast and coming: half way.
  EXPECT_NEAR(predator.meeting_point({0, 0, 0}, {1, 0, 0}, {-0.5, 0, 0}).x, 0.5, 1e-12);
  // Faster and coming: the earlier of both meetings, 1 = (0.5 + 0.7) t.
  EXPECT_NEAR(predator.meeting_point({0, 0, 0}, {1, 0, 0}, {-0.7, 0, 0}).x, 1 - 0.7 / 1.2, 1e-12);
}

TEST(Predator, EstimatesTheVelocityFromPictures) {
  Rig rig({.strategy = Strategy::lead});
  rig.put("me", "predator", 0, 0);
  for (int k = 0; k < 60; ++k) {
    rig.put("a", "prey", 3, 0.02 * k);
    rig.step(0.1 * (k + 1));
  }
  // 0.2 m/s; what is left of the beginning is 0.7^59.
  EXPECT_NEAR(rig.controller.state.velocity.y, 0.2, 1e-8);
  EXPECT_NEAR(rig.controller.state.velocity.x, 0, 1e-12);
}

TEST(Predator, EncirclingPredatorsShareTheDirectionsEvenly) {
  // Three predators, 30 degrees apart about a prey at the origin: the middle one stays, the others go 120 degrees from it.
  std::vector<double> angles;
  for (const char* const name : {"p1", "p2", "p3"}) {
    Rig rig({.strategy = Strategy::encircle, .circle_m = 1}, name);
    int k = 0;
    for (const char* const each : {"p1", "p2", "p3"}) {
      const double angle = math::pi / 6 * (k++ - 1);
      rig.put(each, "predator", 3 * math::cos(angle), 3 * math::sin(angle));
    }
    rig.put("a", "prey", 0, 0);
    const Vec3 place = rig.controller.place_around(rig.camera.message,
                                                   *steering::find(rig.camera.message, name), {0, 0, 0});
    EXPECT_NEAR(norm(place), 1, 1e-12);
    angles.push_back(math::atan2(place.y, place.x));
  }
  EXPECT_NEAR(angles[0], -math::tau / 3, 1e-9);
  EXPECT_NEAR(angles[1], 0, 1e-9);
  EXPECT_NEAR(angles[2], math::tau / 3, 1e-9);
}

TEST(Predator, TheCircleClosesWhenAllAreInTheirPlaces) {
  Rig rig({.strategy = Strategy::encircle, .circle_m = 1}, "p1");
  int k = 0;
  for (const char* const each : {"p1", "p2", "p3"}) {
    const double angle = math::tau / 3 * (k++ - 1);
    rig.put(each, "predator", 1.1 * math::cos(angle), 1.1 * math::sin(angle));
  }
  const Vec3 place = rig.controller.place_around(rig.camera.message,
                                                 *steering::find(rig.camera.message, "p1"), {0, 0, 0});
  EXPECT_NEAR(norm(place), 0, 1e-12);
}

TEST(Predator, StandsWithoutPrey) {
  Rig rig({});
  rig.put("me", "predator", 0, 0);
  rig.step(0);
  EXPECT_EQ(rig.twist().linear.x, 0);
}

}  // namespace
}  // namespace sandlot::controllers::predator
