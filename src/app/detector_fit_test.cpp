#include "app/detector_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sandlot::app {
namespace {

/// What a detector with these errors would make of n things from 1 to 9 m, a third of them half hidden.
std::vector<Sighted> sightings(const DetectorFit& errors, int n) {
  std::vector<Sighted> out;
  Stream random(11, 22, Purpose::noise, 33);
  for (int i = 0; i < n; ++i) {
    Sighted s;
    s.range_m = 1 + 8 * random.uniform();
    s.visible = i % 3 == 0 ? 0.5 : 1;
    const double p = errors.miss_rate + errors.miss_rate_per_m * s.range_m +
                     errors.miss_rate_hidden * (1 - s.visible);
    s.found = random.uniform() >= p;
    s.confused = s.found && i % 10 == 0;
    s.bearing_error_rad = errors.bearing_std_rad * random.normal();
    s.range_error_m = (errors.range_std_m + errors.range_std_per_m * s.range_m) * random.normal();
    out.push_back(s);
  }
  return out;
}

TEST(DetectorFit, GivesBackTheErrorsThatWereThere) {
  const DetectorFit truth{.miss_rate = 0.03,
                          .miss_rate_per_m = 0.02,
                          .miss_rate_hidden = 0.3,
                          .bearing_std_rad = 0.02,
                          .range_std_m = 0.04,
                          .range_std_per_m = 0.03};
  constexpr int n = 6000;
  const DetectorFit fit = fit_detector(sightings(truth, n), 90, 300);
  // P is about 0.18 on average: sqrt(0.18 * 0.82 / 6000) = 0.005 for a mean; the slope over ranges that
  // spread by 8 / sqrt(12) = 2.3 m: 0.005 / 2.3; a constant at 0 m, 5 m from the middle: 0.005 * sqrt(1 + (5
  // / 2.3)^2) = 0.012; hidden parts spread by 0.24. Four of each.
  EXPECT_NEAR(fit.miss_rate, 0.03, 4 * 0.012);
  EXPECT_NEAR(fit.miss_rate_per_m, 0.02, 4 * 0.0022);
  EXPECT_NEAR(fit.miss_rate_hidden, 0.3, 4 * 0.021);
  EXPECT_NEAR(fit.miss_rate + 5 * fit.miss_rate_per_m + fit.miss_rate_hidden / 6, 0.18, 4 * 0.005);
  EXPECT_NEAR(fit.ghost_rate_hz, 0.3, 1e-12);
  EXPECT_NEAR(fit.confusion, 0.1, 4 * std::sqrt(0.1 * 0.18 / n));  // every tenth, of which 18 % were missed
  EXPECT_NEAR(fit.bearing_std_rad, 0.02, 0.02 * 4 * 0.71 / std::sqrt(0.82 * n));
  // At the middle, 5 m, the deviation is 0.19 m within 0.76 / sqrt(N); its slope that over 2.3 m.
  const double sigma = 0.19 * 0.76 / std::sqrt(0.82 * n);
  EXPECT_NEAR(fit.range_std_m + 5 * fit.range_std_per_m, 0.19, 4 * sigma);
  EXPECT_NEAR(fit.range_std_per_m, 0.03, 4 * sigma / 2.3);
  EXPECT_NEAR(fit.range_std_m, 0.04, 4 * sigma * 2.4);
  EXPECT_NEAR(fit.nearest_m, 1, 0.01);
  EXPECT_NEAR(fit.farthest_m, 9, 0.01);
}

TEST(DetectorFit, NothingBecomesNegativeOrInfinite) {
  DetectorFit fit = fit_detector(sightings({}, 100), 0, 0);  // faultless
  EXPECT_EQ(fit.miss_rate, 0);
  EXPECT_EQ(fit.miss_rate_per_m, 0);
  EXPECT_EQ(fit.miss_rate_hidden, 0);
  EXPECT_EQ(fit.range_std_m, 0);
  EXPECT_EQ(fit.range_std_per_m, 0);
  EXPECT_EQ(fit.ghost_rate_hz, 0);
  fit = fit_detector(sightings({.miss_rate = 1}, 50), 3, 10);  // blind
  EXPECT_NEAR(fit.miss_rate + 5 * fit.miss_rate_per_m, 1, 0.05);
  EXPECT_EQ(fit.bearing_std_rad, 0);
  EXPECT_DOUBLE_EQ(fit.ghost_rate_hz, 0.3);
  fit = fit_detector({}, 0, 1);
  EXPECT_EQ(fit.miss_rate, 0);
  // Misses that become fewer with the distance: no negative slope.
  std::vector<Sighted> odd;
  for (int i = 0; i < 100; ++i) odd.push_back({.range_m = 1 + 0.01 * i, .found = i > 20});
  fit = fit_detector(odd, 0, 1);
  EXPECT_EQ(fit.miss_rate_per_m, 0);
  EXPECT_NEAR(fit.miss_rate, 0.21, 1e-6);
}

}  // namespace
}  // namespace sandlot::app
