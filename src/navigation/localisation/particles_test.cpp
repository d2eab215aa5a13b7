#include "navigation/localisation/particles.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sandlot::navigation::amcl {
namespace {

TEST(Particles, KldNumberIsFoxsFormula) {
  // k = 2: (1 / 0.1) (1 - 2/9 + sqrt(2/9) 2.33)^3 with sqrt(2/9) = 0.4714045: 1.876150^3 = 6.603945.
  EXPECT_EQ(kld_particles(2, 0.05, 2.33), 67);
  // k = 101: 1000 (1 - 0.0022222 + 0.0471405 * 2.33)^3 = 1000 * 1.1076151^3 = 1358.8.
  EXPECT_EQ(kld_particles(101, 0.05, 2.33), 1359);
  // Without a margin it is nearly the mean of a chi-square of k - 1 degrees: (k - 1) / (2 e), less 2/3 / (2 e).
  EXPECT_NEAR(kld_particles(1001, 0.5, 0), 1000 - 2.0 / 3, 1);
  // chi^2 of 10 degrees at 0.99 is 23.209 (tables): n = 23.209 / (2 * 0.01).
  EXPECT_NEAR(kld_particles(11, 0.01, 2.326348), 23.209 / 0.02, 0.005 * 23.209 / 0.02);
  EXPECT_EQ(kld_particles(0, 0.05, 2.33), 1);
  EXPECT_EQ(kld_particles(1, 0.05, 2.33), 1);
  EXPECT_EQ(kld_particles(2'000'000'000, 1e-4, 10), 1e9);
}

TEST(Particles, LowVarianceDrawsEachWeightRoundedUpOrDown) {
  Stream random(1, entity_key("particles"), Purpose::experiment, 0);
  for (int round = 0; round < 50; ++round) {
    std::vector<double> weights(40);
    double sum = 0;
    for (double& w : weights) sum += w = random.uniform() < 0.3 ? 0 : random.uniform();
    std::vector<std::uint32_t> picks(100), counts(weights.size());
    resample_low_variance(weights, random.uniform(), picks);
    for (std::size_t k = 0; k < picks.size(); ++k) {
      ASSERT_LT(picks[k], weights.size());
      ASSERT_TRUE(k == 0 || picks[k] >= picks[k - 1]);
      ++counts[picks[k]];
    }
    for (std::size_t i = 0; i < weights.size(); ++i) {
      const double expected = 100 * weights[i] / sum;
      EXPECT_GE(counts[i], std::floor(expected - 1e-9));
      EXPECT_LE(counts[i], std::ceil(expected + 1e-9));
    }
  }
  // Four equal ones, eight draws at any offset: twice each.
  std::vector<std::uint32_t> picks(8);
  for (const double offset : {0.0, 0.3, 0.999999999}) {
    resample_low_variance(std::vector<double>{2, 2, 2, 2}, offset, picks);
    EXPECT_EQ(picks, (std::vector<std::uint32_t>{0, 0, 1, 1, 2, 2, 3, 3}));
  }
  // Weights of 0 at the ends are never drawn.
  resample_low_variance(std::vector<double>{0, 1, 0}, 0, picks);
  EXPECT_EQ(picks, std::vector<std::uint32_t>(8, 1));
  resample_low_variance(std::vector<double>{0, 1, 0}, 1 - 1e-16, picks);
  EXPECT_EQ(picks, std::vector<std::uint32_t>(8, 1));
}

TEST(Particles, BinsAreHalfAMetreAndTenDegrees) {
  PoseBins bins(20);
  const double ten = math::pi / 18;
  EXPECT_EQ(bins.add({0.1, 0.1, 0.01}, 1), 0u);
  EXPECT_EQ(bins.add({0.4, 0.4, ten - 0.01}, 1), 0u);
  EXPECT_EQ(bins.add({0.6, 0.1, 0.01}, 1), 1u);
  EXPECT_EQ(bins.add({-0.1, 0.1, 0.01}, 1), 2u);
  EXPECT_EQ(bins.add({0.1, -0.1, 0.01}, 1), 3u);
  EXPECT_EQ(bins.add({0.1, 0.1, ten + 0.01}, 1), 4u);
  EXPECT_EQ(bins.add({0.1, 0.1, math::tau + 0.01}, 1), 0u);
  EXPECT_EQ(bins.occupied(), 5u);
  bins.add({1e300, -1e300, 0}, 1);
  EXPECT_EQ(bins.occupied(), 6u);
  bins.clear();
  EXPECT_EQ(bins.occupied(), 0u);
  EXPECT_EQ(bins.add({0.6, 0.1, 0.01}, 1), 0u);
}

TEST(Particles, ClustersTouchAcrossCornersAndPi) {
  PoseBins bins(20);
  // One cluster of three in a chain, by a corner and across +-pi; one alone, heavier than each but not than the three.
  const std::uint32_t a = bins.add({0.1, 0.1, math::pi - 0.01}, 0.2),
                      b = bins.add({0.6, 0.6, -math::pi + 0.01}, 0.2),
                      c = bins.add({1.1, 0.6, -math::pi + 0.01}, 0.15), alone = bins.add({3, 3, 0}, 0.44),
                      dust = bins.add({3.3, 3.6, 0.3}, 1e-5);
  const PoseBins::Clusters clusters = bins.find_clusters();
  EXPECT_EQ(clusters.count, 2u);
  EXPECT_EQ(bins.cluster_of(a), clusters.best);
  EXPECT_EQ(bins.cluster_of(b), clusters.best);
  EXPECT_EQ(bins.cluster_of(c), clusters.best);
  EXPECT_NE(bins.cluster_of(alone), clusters.best);
  EXPECT_EQ(bins.cluster_of(dust), PoseBins::none);
}

}  // namespace
}  // namespace sandlot::navigation::amcl
