#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "noise/channel_noise.h"
#include "noise/drifting_bias.h"
#include "noise/range_noise.h"
#include "noise/white.h"

namespace sandlot {
namespace {

Stream noise_stream(std::uint64_t k) { return {1, 2, Purpose::noise, k}; }

/// Root mean square of the error over n samples, dt apart.
double rms(const DriftingBiasSpec& spec, double dt, int n) {
  DriftingBias channel;
  Stream first = noise_stream(0);
  channel.reset(spec, first);
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    Stream random = noise_stream(static_cast<std::uint64_t>(k) + 1);
    const double e = channel.corrupt(spec, 0.0, dt, random);
    sum += e * e;
  }
  return std::sqrt(sum / n);
}

TEST(DriftingBias, HasItsStatedSpreadAtAnySampleRate) {
  const DriftingBiasSpec spec{.bias_std = 0.2, .correlation_s = 0.5};
  for (const double dt : {0.001, 0.1}) {
    const double duration = 4000 * spec.correlation_s;
    // e^2 decorrelates in tau: 4000 independent squares, so the rms has a relative standard deviation of
    // sqrt(2 / 4000) / 2 = 1.1 %. Allow five of them.
    EXPECT_NEAR(rms(spec, dt, static_cast<int>(duration / dt)), 0.2, 0.2 * 5 * 0.0112);
  }
}

TEST(DriftingBias, WhiteNoiseAveragesDownWithTheSampleInterval) {
  const DriftingBiasSpec spec{.white_density = 0.01};
  // 40000 independent samples: relative standard deviation 1 / sqrt(2 * 40000) = 0.35 %.
  EXPECT_NEAR(rms(spec, 0.01, 40'000), 0.1, 0.1 * 5 * 0.0035);
  EXPECT_NEAR(rms(spec, 1.00, 40'000), 0.01, 0.01 * 5 * 0.0035);
}

TEST(DriftingBias, IsCorrelatedAsItsTimeConstantSays) {
  // Autocorrelation at lag dt: exp(-dt / tau) = exp(-0.5). Bartlett: its estimate from n samples of an AR(1)
  // process has variance (1 - a^2) / n.
  const DriftingBiasSpec spec{.bias_std = 1, .correlation_s = 2};
  DriftingBias channel;
  double product = 0, squares = 0, previous = 0;
  constexpr int n = 100'000;
  for (int k = 0; k < n; ++k) {
    Stream random = noise_stream(static_cast<std::uint64_t>(k));
    channel.corrupt(spec, 0.0, 1.0, random);
    product += channel.bias * previous;
    squares += channel.bias * channel.bias;
    previous = channel.bias;
  }
  const double a = math::exp(-0.5);
  EXPECT_NEAR(product / squares, a, 5 * std::sqrt((1 - a * a) / n));
}

TEST(DriftingBias, TheFirstBiasIsDrawnFromTheStationarySpread) {
  const DriftingBiasSpec spec{.bias_std = 0.3};
  double sum = 0;
  constexpr int n = 20'000;
  for (int k = 0; k < n; ++k) {
    Stream random = noise_stream(static_cast<std::uint64_t>(k));
    DriftingBias channel;
    channel.reset(spec, random);
    sum += channel.bias * channel.bias;
  }
  EXPECT_NEAR(std::sqrt(sum / n), 0.3, 0.3 * 5 / std::sqrt(2.0 * n));
}

TEST(DriftingBias, WithoutErrorsTheTruthComesThrough) {
  DriftingBias channel;
  Stream random = noise_stream(0);
  EXPECT_EQ(channel.corrupt({}, 1.25, 0.1, random), 1.25);
}

TEST(WhiteNoise, HasItsStatedMeanAndSpread) {
  const WhiteNoiseSpec spec{0.5};
  Stream random = noise_stream(0);
  double sum = 0, squares = 0;
  constexpr int n = 100'000;
  for (int k = 0; k < n; ++k) {
    const double e = spec.corrupt(3.0, random) - 3.0;
    sum += e;
    squares += e * e;
  }
  EXPECT_NEAR(sum / n, 0, 5 * 0.5 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.5, 0.5 * 5 / std::sqrt(2.0 * n));
}

TEST(RangeNoise, BeamsShareTheBiasAndHaveTheirOwnWhiteError) {
  // Error of a beam: b + w. Mean over 1000 beams estimates b to 0.1 / sqrt(1000), the spread around it is
  // white.
  const RangeNoiseSpec spec{.white_m = 0.1, .bias = {.bias_std = 0.5, .correlation_s = 1e-3}};
  DriftingBias bias;
  double bias_squares = 0, white_squares = 0;
  constexpr int samples = 2000, beams = 1000;
  for (int k = 0; k < samples; ++k) {
    std::vector<float> ranges(beams, 5.0f);
    Stream random = noise_stream(static_cast<std::uint64_t>(k));
    corrupt_ranges(spec, bias, 0.1, random, 0.0, 100.0, ranges);
    double mean = 0;
    for (const float r : ranges) mean += (r - 5.0) / beams;
    bias_squares += mean * mean;
    for (const float r : ranges) white_squares += (r - 5.0 - mean) * (r - 5.0 - mean);
    EXPECT_NEAR(mean, bias.bias, 5.5 * 0.1 / std::sqrt(beams));
  }
  EXPECT_NEAR(std::sqrt(bias_squares / samples), 0.5, 0.5 * 5 / std::sqrt(2.0 * samples));
  EXPECT_NEAR(std::sqrt(white_squares / samples / (beams - 1)), 0.1,
              0.1 * 5 / std::sqrt(2.0 * samples * beams));
}

TEST(RangeNoise, LeavesTheEndsAloneAndStaysBetweenThem) {
  constexpr float inf = std::numeric_limits<float>::infinity();
  const RangeNoiseSpec spec{.white_m = 10};
  DriftingBias bias;
  std::vector<float> ranges(1000, 2.0f);
  ranges[0] = inf;
  ranges[1] = -inf;
  Stream random = noise_stream(0);
  corrupt_ranges(spec, bias, 0.1, random, 0.5, 3.0, ranges);
  EXPECT_EQ(ranges[0], inf);
  EXPECT_EQ(ranges[1], -inf);
  bool low = false, high = false;
  for (std::size_t i = 2; i < ranges.size(); ++i) {
    EXPECT_TRUE(ranges[i] >= 0.5f && ranges[i] <= 3.0f);
    low |= ranges[i] == 0.5f;
    high |= ranges[i] == 3.0f;
  }
  EXPECT_TRUE(low && high);
}

TEST(RangeNoise, WithoutErrorsTheRangesStayAsTheyAre) {
  DriftingBias bias{0.7};
  std::vector<float> ranges{0.1f, 5.0f};
  Stream random = noise_stream(0);
  corrupt_ranges({}, bias, 0.1, random, 0.5, 3.0, ranges);
  EXPECT_EQ(ranges, (std::vector<float>{0.1f, 5.0f}));
  EXPECT_EQ(bias.bias, 0.7);
}

TEST(RangeNoise, TheConstantErrorIsAddedAndTheSumRounded) {
  const RangeNoiseSpec spec{.mean_m = 0.3, .systematic_m = 0, .resolution_m = 0.25};
  Stream random = noise_stream(0);
  const double constant = constant_error_m(spec, random);
  EXPECT_EQ(constant, 0.3);
  DriftingBias bias;
  std::vector<float> ranges{1.0f, 1.1f, 9.95f};
  corrupt_ranges(spec, bias, 0.1, random, 0.5, 10.0, ranges, constant);
  EXPECT_EQ(ranges, (std::vector<float>{1.25f, 1.5f, 10.0f}));  // 1.3, 1.4, 10.25 cut to the maximum
}

TEST(ChannelNoise, ItsPartsAddUp) {
  // Constant 0.5 + drawn; white and the drifting bias are independent: sqrt(0.3^2 + 0.4^2) = 0.5 about it.
  // With a correlation far below the sample interval samples are independent, too.
  const ChannelNoiseSpec spec{
      .white = 0.3, .mean = 0.5, .mean_std = 2, .bias = {.bias_std = 0.4, .correlation_s = 1e-3}};
  ChannelNoise channel;
  Stream first = noise_stream(0);
  channel.reset(spec, first);
  EXPECT_NE(channel.drawn, 0);
  double sum = 0, squares = 0;
  constexpr int n = 40'000;
  for (int k = 0; k < n; ++k) {
    Stream random = noise_stream(static_cast<std::uint64_t>(k) + 1);
    const double e = channel.corrupt(spec, 7, 0.1, random) - 7.5 - channel.drawn;
    sum += e;
    squares += e * e;
  }
  EXPECT_NEAR(sum / n, 0, 5 * 0.5 / std::sqrt(n));
  EXPECT_NEAR(std::sqrt(squares / n), 0.5, 5 * 0.5 / std::sqrt(2.0 * n));
  EXPECT_NEAR(spec.variance(0.1), 0.25, 1e-15);
}

TEST(ChannelNoise, RoundsAndSaturates) {
  const ChannelNoiseSpec spec{.resolution = 0.5, .limit = 3};
  ChannelNoise channel;
  Stream random = noise_stream(0);
  EXPECT_EQ(channel.corrupt(spec, 1.2, 0.1, random), 1.0);
  EXPECT_EQ(channel.corrupt(spec, 1.3, 0.1, random), 1.5);
  EXPECT_EQ(channel.corrupt(spec, 7, 0.1, random), 3);
  EXPECT_EQ(channel.corrupt(spec, -7, 0.1, random), -3);
}

}  // namespace
}  // namespace sandlot
