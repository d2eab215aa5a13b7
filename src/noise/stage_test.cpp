/// Each stage against its closed form, at several sample rates. Bounds are 4.5 standard deviations of the
/// estimator, which a correct stage leaves once in 150 000 estimates; the streams are fixed, so that a test
/// that passes stays so.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "noise/chain.h"

namespace sandlot::stage_test {
namespace {

constexpr double bound = 4.5;
constexpr double rates_dt_s[] = {0.001, 0.01, 0.1};

Stream stream(Purpose purpose, std::uint64_t sample, std::uint64_t seed = 1) {
  return {seed, 2, purpose, sample};
}

/// What a chain makes of n samples of `truth`, dt apart.
std::vector<double> run(const std::vector<StageSpec>& stages, double truth, double dt_s, int n,
                        double errors = 1, std::uint64_t seed = 1) {
  ChannelChain chain;
  chain.reset(stages, stream(Purpose::initial, 0, seed));
  std::vector<double> out;
  for (int k = 0; k < n; ++k)
    out.push_back(chain.corrupt(stages, truth, dt_s,
                                stream(Purpose::noise, static_cast<std::uint64_t>(k), seed), errors));
  return out;
}

struct Moments {
  double mean = 0, variance = 0;
};

Moments moments(const std::vector<double>& x) {
  Moments m;
  const auto n = static_cast<double>(x.size());
  for (const double v : x) m.mean += v / n;
  for (const double v : x) m.variance += (v - m.mean) * (v - m.mean) / n;
  return m;
}

/// Mean of n independent values of variance v: deviation sqrt(v / n). Their sample variance: v sqrt((kurtosis
/// - 1) / n), kurtosis 3 for normal and 1.8 for uniform values.
void expect_moments(const std::vector<double>& x, double mean, double variance, double kurtosis = 3) {
  const Moments m = moments(x);
  const auto n = static_cast<double>(x.size());
  EXPECT_NEAR(m.mean, mean, bound * std::sqrt(variance / n));
  EXPECT_NEAR(m.variance, variance, bound * variance * std::sqrt((kurtosis - 1) / n));
}

TEST(Stages, GaussianIsTheSamePerSampleAtEveryRate) {
  for (const double dt_s : rates_dt_s)
    expect_moments(run({GaussianSpec{.std = 0.2, .mean = 0.5}}, 3, dt_s, 40'000), 3.5, 0.04);
}

TEST(Stages, LagFollowsAStepAlikeAtEveryRate) {
  for (const double dt_s : rates_dt_s) {
    const std::vector<StageSpec> stages{LagSpec{.time_constant_s = 0.5}};
    ChannelChain chain;
    chain.reset(stages, stream(Purpose::initial, 0));
    const auto show = [&](double x, double errors = 1) {
      return chain.corrupt(stages, x, dt_s, stream(Purpose::noise, 0), errors);
    };
    EXPECT_EQ(show(2), 2) << "no warm-up";
    double y = 0;
    for (int k = 1; k <= std::lround(1 / dt_s); ++k) y = show(5);
    EXPECT_NEAR(y, 5 - 3 * math::exp(-2.0), 1e-12);  // two time constants
    EXPECT_TRUE(std::isnan(show(std::nan("")))) << "no number passes by";
    EXPECT_NEAR(show(5), 5 - 3 * math::exp(-2 - dt_s / 0.5), 1e-12);
    EXPECT_EQ(show(7, 0), 7);
    // A scan, each beam for itself.
    ChannelChain beams;
    beams.reset(stages, stream(Purpose::initial, 0));
    std::vector<float> scan{1, 10};
    beams.corrupt(stages, scan, dt_s, stream(Purpose::noise, 0));
    EXPECT_EQ(scan, (std::vector<float>{1, 10}));
    scan = {2, std::numeric_limits<float>::infinity()};
    beams.corrupt(stages, scan, dt_s, stream(Purpose::noise, 1));
    EXPECT_NEAR(scan[0], 1 + (1 - math::exp(-dt_s / 0.5)), 1e-6);
    EXPECT_TRUE(std::isinf(scan[1]));
  }
}

TEST(Stages, ABeamOfALagThatSeesSomethingAgainShowsItAtOnce) {
  const std::vector<StageSpec> stages{LagSpec{.time_constant_s = 0.5}};
  ChannelChain beams;
  beams.reset(stages, stream(Purpose::initial, 0));
  std::vector<float> scan{std::numeric_limits<float>::infinity()};
  beams.corrupt(stages, scan, 0.1, stream(Purpose::noise, 0));
  scan = {3};
  beams.corrupt(stages, scan, 0.1, stream(Purpose::noise, 1));
  EXPECT_EQ(scan[0], 3);
}

/// What a lag shows next follows from what it showed: of one value, and of a scan.
TEST(Stages, ALagGoesOnFromItsBytes) {
  const std::vector<StageSpec> stages{LagSpec{.time_constant_s = 0.5}};
  ChannelChain lag;
  lag.reset(stages, stream(Purpose::initial, 0));
  const auto restored = [&](const ChannelChain& from) {
    ByteWriter w;
    write(w, from);
    ChannelChain to;
    to.reset(stages, stream(Purpose::initial, 0));
    ByteReader r(w.bytes());
    read(r, to);
    EXPECT_TRUE(r.ok() && r.remaining() == 0);
    return to;
  };
  const double share = 1 - math::exp(-0.1 / 0.5);
  lag.corrupt(stages, 2, 0.1, stream(Purpose::noise, 0));
  ChannelChain again = restored(lag);
  EXPECT_NEAR(again.corrupt(stages, 5, 0.1, stream(Purpose::noise, 1)), 2 + share * 3, 1e-12);
  std::vector<float> scan{1, 10};
  lag.corrupt(stages, scan, 0.1, stream(Purpose::noise, 1));
  again = restored(lag);
  scan = {2, 20};
  again.corrupt(stages, scan, 0.1, stream(Purpose::noise, 2));
  EXPECT_NEAR(scan[0], 1 + share, 1e-6);
  EXPECT_NEAR(scan[1], 10 + 10 * share, 1e-5);
}

TEST(Stages, WhiteNoiseHasTheVarianceOfItsDensity) {
  for (const double dt_s : rates_dt_s)
    expect_moments(run({WhiteSpec{.density = 0.1}}, 0, dt_s, 40'000), 0, 0.01 / dt_s);
}

TEST(Stages, WhiteNoiseAveragesDownAlikeAtEveryRate) {
  // Means over one second have the variance density^2 / 1 s: 400 of them, whatever they are made of.
  for (const double dt_s : rates_dt_s) {
    const int per_second = static_cast<int>(std::lround(1 / dt_s));
    const auto x = run({WhiteSpec{.density = 0.1}}, 0, dt_s, 400 * per_second);
    std::vector<double> means;
    for (int i = 0; i < 400; ++i) {
      double sum = 0;
      for (int k = 0; k < per_second; ++k) sum += x[static_cast<std::size_t>(i * per_second + k)];
      means.push_back(sum / per_second);
    }
    expect_moments(means, 0, 0.01);
  }
}

TEST(Stages, UniformErrorsFillTheirIntervalAlike) {
  for (const double dt_s : rates_dt_s) {
    const auto x = run({UniformSpec{.min = -1, .max = 2}}, 10, dt_s, 40'000);
    expect_moments(x, 10.5, 9.0 / 12, 1.8);
    const auto [low, high] = std::minmax_element(x.begin(), x.end());
    // The extremes of n uniform values lie within width ln(150 000) / n = 12 width / n of the ends, as
    // surely.
    EXPECT_TRUE(*low >= 9 && *low < 9 + 12 * 3 / 40'000.0) << *low;
    EXPECT_TRUE(*high <= 12 && *high > 12 - 12 * 3 / 40'000.0) << *high;
  }
}

TEST(Stages, ProportionalErrorsGrowWithTheValueEitherSign) {
  for (const double truth : {-20.0, 0.5, 4.0})
    expect_moments(run({ProportionalSpec{.std = 0.05}}, truth, 0.01, 40'000), truth, 0.0025 * truth * truth);
  EXPECT_EQ(run({ProportionalSpec{.std = 0.05}}, 0, 0.01, 10), std::vector<double>(10, 0.0));
}

/// Autocovariance of an AR(1) process of variance v and factor a at lag l from n samples with known mean 0
/// has, by Bartlett, the variance v^2 / n times sum_j (a^2|j| + a^|j+l| a^|j-l|)
///   = v^2 / n ((1 + a^2)(1 + a^2l) / (1 - a^2) + 2 l a^2l).
double bartlett(double variance, double a, int lag, double n) {
  const double a2 = a * a, al = math::pow(a2, lag);
  return variance * std::sqrt(((1 + a2) * (1 + al) / (1 - a2) + 2 * lag * al) / n);
}

double autocovariance(const std::vector<double>& x, int lag) {
  double sum = 0;
  const std::size_t l = static_cast<std::size_t>(lag);
  for (std::size_t k = 0; k + l < x.size(); ++k) sum += x[k] * x[k + l];
  return sum / static_cast<double>(x.size() - l);
}

TEST(Stages, DriftForgetsItselfInItsCorrelationTimeAtEveryRate) {
  // 2000 correlation times at each rate; lags of 0, tau / 2, tau, 2 tau.
  constexpr double std = 0.3, tau_s = 0.2;
  for (const double dt_s : rates_dt_s) {
    const int n = static_cast<int>(2000 * tau_s / dt_s);
    const auto x = run({DriftSpec{.std = std, .correlation_s = tau_s}}, 0, dt_s, n);
    const double a = math::exp(-dt_s / tau_s);
    for (const double lag_s : {0.0, 0.1, 0.2, 0.4}) {
      const int lag = static_cast<int>(std::lround(lag_s / dt_s));
      EXPECT_NEAR(autocovariance(x, lag), std * std * math::exp(-lag_s / tau_s),
                  bound * bartlett(std * std, a, lag, n))
          << "dt " << dt_s << ", lag " << lag_s;
    }
  }
}

TEST(Stages, DriftBeginsInItsStationarySpread) {
  std::vector<double> first;
  for (std::uint64_t seed = 0; seed < 10'000; ++seed)
    first.push_back(run({DriftSpec{.std = 0.3, .correlation_s = 50}}, 0, 0.01, 1, 1, seed).front());
  expect_moments(first, 0, 0.09);
}

TEST(Stages, BiasIsDrawnOncePerDevice) {
  std::vector<double> normal, uniform;
  for (std::uint64_t seed = 0; seed < 10'000; ++seed) {
    const auto x = run({BiasSpec{.mean = 1, .std = 0.5}}, 2, 0.01, 3, 1, seed);
    EXPECT_EQ(x[0], x[1]);
    EXPECT_EQ(x[1], x[2]);
    normal.push_back(x[0]);
    uniform.push_back(run({BiasSpec{.half_width = 0.6}}, 0, 0.01, 1, 1, seed).front());
    EXPECT_LE(std::abs(uniform.back()), 0.6);
  }
  expect_moments(normal, 3, 0.25);
  expect_moments(uniform, 0, 0.36 / 3, 1.8);
}

TEST(Stages, WalkGrowsWithTheRootOfTimeAtEveryRate) {
  // After 1 s and 4 s over 2000 devices: variance density^2 t.
  for (const double dt_s : {0.01, 0.1, 0.5}) {
    std::vector<double> early, late;
    const int n = static_cast<int>(std::lround(4 / dt_s));
    for (std::uint64_t seed = 0; seed < 2000; ++seed) {
      const auto x = run({WalkSpec{.density = 0.2}}, 0, dt_s, n, 1, seed);
      early.push_back(x[static_cast<std::size_t>(n / 4 - 1)]);
      late.push_back(x.back());
    }
    expect_moments(early, 0, 0.04);
    expect_moments(late, 0, 0.16);
  }
}

TEST(Stages, ScaleMultipliesByOneFactorPerDevice) {
  EXPECT_EQ(run({ScaleSpec{.error = 0.25}}, 8, 0.01, 2), (std::vector<double>{10, 10}));
  std::vector<double> drawn;
  for (std::uint64_t seed = 0; seed < 10'000; ++seed)
    drawn.push_back(run({ScaleSpec{.std = 0.02}}, 50, 0.01, 1, 1, seed).front());
  expect_moments(drawn, 50, 1);
}

TEST(Stages, QuantisationErrsUniformlyWithinHalfAStep) {
  // Normal values spread over 10 steps: the error's variance is step^2 / 12 to within exp(-2 pi^2 100).
  const std::vector<StageSpec> spread{GaussianSpec{.std = 1}};
  const std::vector<StageSpec> rounded{GaussianSpec{.std = 1}, QuantiseSpec{.step = 0.1}};
  const auto exact = run(spread, 0.037, 0.01, 40'000), shown = run(rounded, 0.037, 0.01, 40'000);
  std::vector<double> error;
  for (std::size_t k = 0; k < exact.size(); ++k) {
    error.push_back(shown[k] - exact[k]);
    EXPECT_LE(std::abs(error.back()), 0.05 + 1e-12);
    EXPECT_NEAR(shown[k] / 0.1, std::round(shown[k] / 0.1), 1e-9);
  }
  expect_moments(error, 0, 0.01 / 12, 1.8);
}

TEST(Stages, ClipAndDeadZoneCut) {
  ChannelChain chain;
  const std::vector<StageSpec> clip{ClipSpec{.min = -1, .max = 2}}, zone{DeadZoneSpec{.width = 0.5}};
  const Stream random = stream(Purpose::noise, 0);
  chain.reset(clip, random);
  EXPECT_EQ(chain.corrupt(clip, 5, 0.1, random), 2);
  EXPECT_EQ(chain.corrupt(clip, -5, 0.1, random), -1);
  EXPECT_EQ(chain.corrupt(clip, 1.5, 0.1, random), 1.5);
  EXPECT_EQ(chain.corrupt(clip, -5, 0.1, random, 0.0), -1);  // what it can show, errors or not
  EXPECT_TRUE(std::isinf(chain.corrupt(clip, INFINITY, 0.1, random)));
  chain.reset(zone, random);
  EXPECT_EQ(chain.corrupt(zone, 0.49, 0.1, random), 0);
  EXPECT_EQ(chain.corrupt(zone, -0.5, 0.1, random), -0.5);
  EXPECT_EQ(chain.corrupt(zone, 0.7, 0.1, random, 2.0), 0);
}

struct Runs {
  double lost = 0, bursts = 0;
  int n = 0;
  double fraction() const { return lost / n; }
  double mean_length() const { return lost / bursts; }
};

Runs runs_of(const std::vector<double>& x) {
  Runs out;
  bool before = false;
  for (const double v : x) {
    const bool lost = std::isnan(v);
    out.lost += lost;
    out.bursts += lost && !before;
    before = lost;
    ++out.n;
  }
  return out;
}

/// Standard deviation for a two-state chain with P(lost | not) = p and P(lost | lost) = s: the fraction f = p
/// / (p + 1 - s) estimated from n samples has the variance f (1 - f) / n (1 + r) / (1 - r) with r = s - p.
/// Bursts are geometric: of m of them with mean L the mean length has the deviation sqrt(L (L - 1) / m).
void expect_runs(const Runs& found, double p, double s) {
  const double f = p / (p + 1 - s), r = s - p, length = 1 / (1 - s);
  EXPECT_NEAR(found.fraction(), f, bound * std::sqrt(f * (1 - f) / found.n * (1 + r) / (1 - r)));
  EXPECT_NEAR(found.mean_length(), length, bound * std::sqrt(length * (length - 1) / found.bursts));
}

TEST(Stages, DropoutsPerSampleLoseTheirShareInBurstsOfTheirLength) {
  for (const double dt_s : rates_dt_s) {  // per sample: whatever the rate
    expect_runs(runs_of(run({DropoutsSpec{.rate = 0.1}}, 1, dt_s, 40'000)), 0.1, 0.1);
    expect_runs(runs_of(run({DropoutsSpec{.rate = 0.02, .burst = 5}}, 1, dt_s, 40'000)), 0.02, 1 - 0.98 / 5);
  }
}

TEST(Stages, DropoutsPerSecondLoseTheSameShareOfTimeAtEveryRate) {
  // r = 0.5 / s, T = 0.5 s: a fifth of the time, f = 0.25 / 1.25. Correlation exp(-dt (r + 1 / T)).
  for (const double dt_s : rates_dt_s) {
    const double keep = math::exp(-dt_s * 2.5), f = 0.2;
    const int n = static_cast<int>(4000 / dt_s);
    const auto found = runs_of(run({DropoutsSpec{.per_second = 0.5, .burst_time_s = 0.5}}, 1, dt_s, n));
    expect_runs(found, f * (1 - keep), 1 - (1 - f) * (1 - keep));
    // The bursts themselves: 0.5 per second of the time that is not lost, 4000 s long; those between samples
    // go unseen.
    EXPECT_NEAR(found.bursts, n * (1 - f) * f * (1 - keep), bound * std::sqrt(4000 * 0.4));
  }
}

TEST(Stages, DropoutsShowWhatTheyAreTold) {
  using Shows = DropoutsSpec::Shows;
  const auto shown = [](Shows shows, double truth) {
    ChannelChain chain;
    std::vector<StageSpec> stages{DropoutsSpec{.rate = 0, .shows = shows, .value = -7}};
    chain.reset(stages, stream(Purpose::initial, 0));
    chain.corrupt(stages, 42, 0.1, stream(Purpose::noise, 0));  // nothing is lost yet
    std::get<DropoutsSpec>(stages[0].stage).rate = 1;
    return chain.corrupt(stages, truth, 0.1, stream(Purpose::noise, 1));
  };
  EXPECT_TRUE(std::isnan(shown(Shows::nan, 3)));
  EXPECT_EQ(shown(Shows::inf, 3), INFINITY);
  EXPECT_EQ(shown(Shows::hold, 3), 42);
  EXPECT_EQ(shown(Shows::value, 3), -7);
}

TEST(Stages, OutliersComeAtTheirRate) {
  const auto share = [](const OutliersSpec& spec, double dt_s, double errors = 1) {
    double far = 0;
    for (const double x : run({spec}, 100, dt_s, 40'000, errors)) far += x != 100;
    return far / 40'000;
  };
  const auto near = [](double found, double p) {
    EXPECT_NEAR(found, p, bound * std::sqrt(p * (1 - p) / 40'000));
  };
  for (const double dt_s : rates_dt_s) {
    near(share({.rate = 0.03, .std = 5}, dt_s), 0.03);
    near(share({.per_second = 2, .std = 5}, dt_s), 1 - math::exp(-2 * dt_s));
    near(share({.rate = 0.03, .std = 5}, dt_s, 3), 0.09);
  }
  EXPECT_EQ(share({.rate = 0.3, .std = 5}, 0.1, 10), 1);  // not more often than always
  EXPECT_EQ(share({.rate = 0.3, .std = 5}, 0.1, 0), 0);
}

TEST(Stages, OutliersAreNormalOrUniformAddedOrShown) {
  std::vector<double> added, shown;
  for (const double x : run({OutliersSpec{.rate = 0.5, .std = 5}}, 100, 0.1, 40'000))
    if (x != 100) added.push_back(x);
  expect_moments(added, 100, 25);
  for (const double x :
       run({OutliersSpec{.rate = 0.5, .min = -3, .max = 1, .replace = true}}, 100, 0.1, 40'000))
    if (x != 100) shown.push_back(x);
  expect_moments(shown, -1, 16.0 / 12, 1.8);
}

TEST(Stages, TheVarianceTheyReportIsTheOneTheyHave) {
  // Sample variance of n values of any distribution: deviation at most sqrt(kurtosis / n); an added normal
  // outlier of the probability p has kurtosis 3 / p, a uniform one about its distance from zero less than 3 /
  // p.
  for (const double dt_s : rates_dt_s)
    for (const std::vector<StageSpec>& stages :
         {std::vector<StageSpec>{GaussianSpec{.std = 0.2}, UniformSpec{.min = 0, .max = 1}},
          std::vector<StageSpec>{WhiteSpec{.density = 0.1}, OutliersSpec{.rate = 0.1, .std = 2}},
          std::vector<StageSpec>{OutliersSpec{.rate = 0.1, .min = 1, .max = 3}}}) {
      const double variance = variance_of(stages, dt_s, 2.0) / 4;
      EXPECT_NEAR(moments(run(stages, 0, dt_s, 40'000)).variance, variance,
                  bound * variance * std::sqrt(30 / 40'000.0));
    }
}

/// A signal whose value is its time.
std::vector<double> run_clock(const std::vector<StageSpec>& stages, double dt_s, int n, double errors = 1) {
  ChannelChain chain;
  chain.reset(stages, stream(Purpose::initial, 0));
  std::vector<double> age;
  double shown_before = -1;
  for (int k = 0; k < n; ++k) {
    const double shown = chain.corrupt(stages, k * dt_s, dt_s,
                                       stream(Purpose::noise, static_cast<std::uint64_t>(k)), errors);
    EXPECT_GE(shown, shown_before);  // never back in time
    shown_before = shown;
    age.push_back(k * dt_s - shown);
  }
  return age;
}

TEST(Stages, LatencyShowsWhatWasMeasuredThatLongAgo) {
  for (const double dt_s : rates_dt_s) {
    const int warm = static_cast<int>(std::lround(0.3 / dt_s));
    const auto age = run_clock({LatencySpec{.delay_s = 0.3}}, dt_s, 10 * warm);
    for (std::size_t k = 0; k < age.size(); ++k)
      EXPECT_NEAR(age[k], std::min(static_cast<double>(k) * dt_s, 0.3), 1e-9);  // until then the first
    EXPECT_NEAR(run_clock({LatencySpec{.delay_s = 0.3}}, dt_s, 10 * warm, 2.0).back(), 0.6, 1e-9);
    EXPECT_EQ(run_clock({LatencySpec{.delay_s = 0.3}}, dt_s, warm, 0.0).back(), 0);
  }
}

TEST(Stages, JitterVariesTheAgeWithinItsBounds) {
  const auto age = run_clock({LatencySpec{.delay_s = 0.3, .jitter_s = 0.1}}, 0.01, 4000);
  double low = 1, high = 0;
  for (std::size_t k = 100; k < age.size(); ++k) {
    low = std::min(low, age[k]);
    high = std::max(high, age[k]);
  }
  // Samples lie 0.01 s apart: up to that much is added. Order keeps the age from growing faster than time.
  EXPECT_GE(low, 0.2 - 1e-9);
  EXPECT_LE(low, 0.22);
  EXPECT_LE(high, 0.41 + 1e-9);
  EXPECT_GE(high, 0.25);
}

TEST(Stages, LatencyKeepsABoundedNumberOfSamples) {
  const std::vector<StageSpec> stages{LatencySpec{.delay_s = 1000}};
  ChannelChain chain;
  chain.reset(stages, stream(Purpose::initial, 0));
  const int n = static_cast<int>(LatencySpec::max_held) + 500;
  double shown = -1;
  for (int k = 0; k < n; ++k) shown = chain.corrupt(stages, k, 0.001, stream(Purpose::noise, 0));
  EXPECT_EQ(shown, 500);  // the oldest that is kept
}

TEST(Stages, ScansAreDelayedAsAWhole) {
  const std::vector<StageSpec> stages{LatencySpec{.delay_s = 0.2}};
  ChannelChain chain;
  chain.reset(stages, stream(Purpose::initial, 0));
  std::vector<float> scan;
  for (int k = 0; k < 6; ++k) {
    scan = {static_cast<float>(k), static_cast<float>(10 * k)};
    chain.corrupt(stages, scan, 0.1, stream(Purpose::noise, 0));
  }
  EXPECT_EQ(scan, (std::vector<float>{3, 30}));
}

TEST(Stages, BeamsAreLostAloneOrAllAtOnce) {
  const auto lost = [](bool whole) {
    const std::vector<StageSpec> stages{
        DropoutsSpec{.rate = 0.2, .shows = DropoutsSpec::Shows::inf, .whole = whole}};
    ChannelChain chain;
    chain.reset(stages, stream(Purpose::initial, 0));
    std::vector<int> counts;
    for (std::uint64_t k = 0; k < 500; ++k) {
      std::vector<float> scan(100, 2.0f);
      chain.corrupt(stages, scan, 0.1, stream(Purpose::noise, k));
      counts.push_back(static_cast<int>(std::count(scan.begin(), scan.end(), INFINITY)));
    }
    return counts;
  };
  double alone = 0, scans = 0;
  for (const int n : lost(false)) alone += n;
  EXPECT_NEAR(alone / 50'000, 0.2, bound * std::sqrt(0.16 / 50'000));
  for (const int n : lost(true)) {
    EXPECT_TRUE(n == 0 || n == 100) << n;
    scans += n == 100;
  }
  EXPECT_NEAR(scans / 500, 0.2, bound * std::sqrt(0.16 / 500));
}

std::vector<float> scans_of(const StageSpec& stage, const std::vector<float>& scan, int n,
                            double errors = 1) {
  ChannelChain chain;
  const std::vector<StageSpec> stages{stage};
  chain.reset(stages, Stream(1, 2, Purpose::initial, 0));
  std::vector<float> out;
  for (int k = 0; k < n; ++k) {
    std::vector<float> one = scan;
    chain.corrupt(stages, one, 0.1, Stream(1, 2, Purpose::noise, static_cast<std::uint64_t>(k)), errors);
    out.insert(out.end(), one.begin(), one.end());
  }
  return out;
}
struct Spread {
  double mean = 0, variance = 0;
};
template <class Values>
Spread spread(const Values& values) {
  Spread out;
  const auto n = static_cast<double>(values.size());
  for (const auto v : values) out.mean += static_cast<double>(v) / n;
  for (const auto v : values)
    out.variance += (static_cast<double>(v) - out.mean) * (static_cast<double>(v) - out.mean) / n;
  return out;
}

double square(double x) { return x * x; }

TEST(RangeStages, GrowingHasItsDeviationWhereItSaysAndThePowerBeyond) {
  constexpr int n = 20'000;
  for (const double power : {1.0, 2.0, 3.0})
    for (const double x : {10.0, 20.0}) {
      const auto seen = scans_of(GrowingSpec{.std = 0.02, .at = 10, .power = power}, {static_cast<float>(x)},
                                 n);
      const double variance = square(0.02 * math::pow(x / 10, power));
      EXPECT_NEAR(spread(seen).variance, variance, variance * 5 * std::sqrt(2.0 / n)) << power << " " << x;
    }
}

TEST(RangeStages, BeamsAtAnEdgeShowSomethingBetween) {
  const auto inf = std::numeric_limits<float>::infinity();
  const std::vector<float> scan{4, 4, 4, 1, 1, 1, inf, inf, 2, 2.1F};
  constexpr int n = 20'000;
  const auto seen = scans_of(MixedSpec{.rate = 0.2, .jump = 0.5}, scan, n, 2);
  int changed[10] = {};
  std::vector<double> between;
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (seen[i] != scan[i % 10]) {
      ++changed[i % 10];
      between.push_back(static_cast<double>(seen[i]));
    }
  for (int i = 0; i < 10; ++i) {  // at 4 | 1 alone: infinite neighbours and small steps are not edges
    const double p = i == 2 || i == 3 ? 0.4 : 0;
    EXPECT_NEAR(changed[i], p * n, 5 * std::sqrt(p * (1 - p) * n)) << i;
  }
  const auto m = static_cast<double>(between.size());
  EXPECT_NEAR(spread(between).mean, 2.5, 5 * std::sqrt(9.0 / 12 / m));
  EXPECT_NEAR(spread(between).variance, 9.0 / 12, 5 * 9.0 / 12 * std::sqrt(0.8 / m));
}

TEST(RangeStages, ShortReadingsAreExponentialUpToTheWall) {
  constexpr int n = 40'000;
  const float inf = std::numeric_limits<float>::infinity();
  for (const float x : {2.0F, inf}) {
    const auto seen = scans_of(ShortSpec{.rate = 0.25, .mean = 1.5}, {x}, n);
    std::vector<double> shorter;
    for (const float each : seen)
      if (each != x) shorter.push_back(static_cast<double>(each));
    EXPECT_NEAR(static_cast<double>(shorter.size()), 0.25 * n, 5 * std::sqrt(0.25 * 0.75 * n));
    // Mean of an exponential distribution cut at x: m - x / (exp(x / m) - 1).
    const double mean = x < inf ? 1.5 - 2 / (math::exp(2 / 1.5) - 1) : 1.5;
    const Spread got = spread(shorter);
    EXPECT_NEAR(got.mean, mean, 5 * std::sqrt(got.variance / static_cast<double>(shorter.size())));
    EXPECT_LE(*std::max_element(shorter.begin(), shorter.end()), static_cast<double>(x));
    EXPECT_GE(*std::min_element(shorter.begin(), shorter.end()), 0);
  }
}

TEST(RangeStages, EchoesByALongerWayAreExponentialBehindTheWall) {
  constexpr int n = 40'000;
  const MultipathSpec spec{.rate = 0.3, .mean = 0.8};
  const auto seen = scans_of(spec, {2.0F, std::numeric_limits<float>::infinity()}, n);
  std::vector<double> longer, all;
  for (std::size_t i = 0; i < seen.size(); i += 2) {
    all.push_back(static_cast<double>(seen[i]));
    if (seen[i] != 2.0F) longer.push_back(static_cast<double>(seen[i]) - 2);
    ASSERT_TRUE(std::isinf(seen[i + 1]));
  }
  const auto m = static_cast<double>(longer.size());
  EXPECT_NEAR(m, 0.3 * n, 5 * std::sqrt(0.3 * 0.7 * n));
  EXPECT_NEAR(spread(longer).mean, 0.8, 5 * 0.8 / std::sqrt(m));
  // The variance of an exponential's estimated variance is 8 v^2 / m.
  EXPECT_NEAR(spread(longer).variance, 0.64, 5 * 0.64 * std::sqrt(8 / m));
  EXPECT_NEAR(spread(all).variance, spec.variance(0.1), 0.1 * spec.variance(0.1));
}

}  // namespace
}  // namespace sandlot::stage_test
