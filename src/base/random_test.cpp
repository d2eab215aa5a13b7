#include "base/random.h"

#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sandlot {
namespace {

Stream stream(std::uint64_t sample = 0, std::uint64_t seed = 1, Purpose purpose = Purpose::noise,
              std::string_view path = "robot1/laser") {
  return {seed, entity_key(path), purpose, sample};
}

// Known answers of philox4x32-10 from the file kat_vectors of Random123 1.09.
TEST(Random, PhiloxGivesItsKnownAnswers) {
  using P = r123::Philox4x32;
  const auto run = [](P::ctr_type c, P::key_type k) { return P()(c, k); };
  EXPECT_EQ(run({{0, 0, 0, 0}}, {{0, 0}}), (P::ctr_type{{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}}));
  EXPECT_EQ(run({{~0u, ~0u, ~0u, ~0u}}, {{~0u, ~0u}}),
            (P::ctr_type{{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}}));
  EXPECT_EQ(run({{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}}, {{0xa4093822, 0x299f31d0}}),
            (P::ctr_type{{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}));
}

// A stream is Philox under a key and a counter that random.cpp writes down: block n of sample s of entity e
// has counter (n, low(e), low(s), high(s)).
TEST(Random, AStreamIsPhiloxUnderItsKey) {
  const std::uint64_t entity = entity_key("robot1/laser"), sample = 0x100000002;
  Stream s(9, entity, Purpose::noise, sample);
  const std::uint64_t key = hash_combine(hash_combine(mix64(9), entity), 1);
  const r123::Philox4x32::key_type k{
      {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)}};
  for (std::uint32_t block = 0; block < 3; ++block) {
    const auto wanted = r123::Philox4x32()({{block, static_cast<std::uint32_t>(entity), 2, 1}}, k);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(s.bits32(), wanted[i]);
  }
}

TEST(Random, TheSameKeyGivesTheSameNumbersAndACopyGoesOnAlone) {
  Stream a = stream(), b = stream();
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.normal(), b.normal());
  Stream c = a;
  const double next = a.normal();
  EXPECT_EQ(c.normal(), next);
}

TEST(Random, UniformsAreUniform) {
  // Mean 1/2 with standard deviation sqrt(1/12/n); chi^2 over 100 bins has mean 99 and deviation sqrt(198) =
  // 14.
  constexpr int n = 400'000;
  Stream s = stream();
  double sum = 0;
  std::array<int, 100> bins{};
  for (int i = 0; i < n; ++i) {
    const double u = s.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    ++bins[static_cast<std::size_t>(u * 100)];
  }
  EXPECT_NEAR(sum / n, 0.5, 5 * std::sqrt(1.0 / 12 / n));
  double chi2 = 0;
  for (const int count : bins) chi2 += (count - n / 100.0) * (count - n / 100.0) / (n / 100.0);
  EXPECT_NEAR(chi2, 99, 5 * 14.1);
}

TEST(Random, ARangeNeverReturnsItsUpperEnd) {
  Stream s = stream();
  const double up = std::nextafter(1.0, 2.0);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(s.uniform(1.0, up), 1.0);  // half of the sums round to `up`
  for (int i = 0; i < 1000; ++i) {
    const double x = s.uniform(-3, 5);
    EXPECT_TRUE(x >= -3 && x < 5);
  }
  EXPECT_EQ(s.uniform(2, 2), 2);
}

TEST(Random, BelowIsUnbiased) {
  // n = 3 * 2^30 is where shortcuts show: the remainder of 32 bits gives the lowest third twice as often, the
  // high word of the product without rejection every multiple of three. Counts: mean draws / 3, deviation
  // sqrt(draws 2/9).
  constexpr int draws = 90'000;
  constexpr std::uint32_t n = 3u << 30;
  Stream s = stream();
  std::array<int, 3> thirds{}, residues{};
  for (int i = 0; i < draws; ++i) {
    const std::uint32_t x = s.below(n);
    ASSERT_LT(x, n);
    ++thirds[x >> 30];
    ++residues[x % 3];
  }
  for (const int count : residues) EXPECT_NEAR(count, draws / 3, 5 * std::sqrt(draws * 2.0 / 9));
  for (const int count : thirds) EXPECT_NEAR(count, draws / 3, 5 * std::sqrt(draws * 2.0 / 9));
  std::array<int, 6> die{};
  for (int i = 0; i < 60'000; ++i) ++die[s.below(6)];
  for (const int count : die) EXPECT_NEAR(count, 10'000, 5 * std::sqrt(60'000 * 5.0 / 36));
  EXPECT_EQ(s.below(1), 0u);
}

TEST(Random, NormalsAreNormal) {
  // Standard deviations of the estimators over n draws: mean 1/sqrt(n), variance sqrt(2/n), skewness
  // sqrt(6/n), kurtosis sqrt(24/n).
  constexpr int n = 1'000'000;
  Stream s = stream();
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0;
  int beyond3 = 0;
  for (int i = 0; i < n; ++i) {
    const double x = s.normal();
    m1 += x;
    m2 += x * x;
    m3 += x * x * x;
    m4 += x * x * x * x;
    beyond3 += std::abs(x) > 3;
  }
  EXPECT_NEAR(m1 / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(m2 / n, 1, 5 * std::sqrt(2.0 / n));
  EXPECT_NEAR(m3 / n, 0, 5 * std::sqrt(15.0 / n));  // raw third moment: variance E x^6 = 15
  EXPECT_NEAR(m4 / n, 3, 5 * std::sqrt(96.0 / n));  // raw fourth moment: variance E x^8 - 9 = 96
  const double tail = 0.0026998;                    // P(|x| > 3)
  EXPECT_NEAR(beyond3, n * tail, 5 * std::sqrt(n * tail));
}

double correlation(Stream a, Stream b, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double x = a.normal(), y = b.normal();
    sum += x * y;
  }
  return sum / n;
}

TEST(Random, StreamsOfDifferentKeysAreIndependent) {
  // The mean product of independent normals has standard deviation 1/sqrt(n).
  constexpr int n = 100'000;
  const double bound = 5 / std::sqrt(n);
  EXPECT_NEAR(correlation(stream(0), stream(1), n), 0, bound);
  EXPECT_NEAR(correlation(stream(0, 1), stream(0, 2), n), 0, bound);
  EXPECT_NEAR(correlation(stream(0, 1, Purpose::noise), stream(0, 1, Purpose::initial), n), 0, bound);
  EXPECT_NEAR(correlation(stream(0, 1, Purpose::noise, "a"), stream(0, 1, Purpose::noise, "b"), n), 0, bound);
  // One normal per sample, as sensors draw them, over consecutive samples.
  double sum = 0, product = 0, previous = 0;
  for (std::uint64_t k = 0; k < n; ++k) {
    const double x = stream(k).normal();
    sum += x;
    product += x * previous;
    previous = x;
  }
  EXPECT_NEAR(sum / n, 0, bound);
  EXPECT_NEAR(product / n, 0, bound);
}

TEST(Random, KeysDoNotCollideOverManyEntitiesAndSamples) {
  std::vector<std::uint64_t> first;
  for (int robot = 0; robot < 300; ++robot)
    for (std::uint64_t sample = 0; sample < 300; ++sample)
      first.push_back(stream(sample, 1, Purpose::noise, "robot" + std::to_string(robot)).bits64());
  std::sort(first.begin(), first.end());
  EXPECT_EQ(std::adjacent_find(first.begin(), first.end()), first.end());  // by chance: once in 5e9
}

TEST(Random, WordsAreThoseOfTheSequenceWhereverOneBegins) {
  Stream drawn = stream(7);
  std::vector<std::uint32_t> sequence(50), words(38);
  for (std::uint32_t& word : sequence) word = drawn.bits32();
  drawn.words(3, words);  // wherever it is
  EXPECT_TRUE(std::equal(words.begin(), words.end(), sequence.begin() + 12));
}

using RandomDeathTest = testing::Test;
TEST(RandomDeathTest, BelowNothingIsABug) { EXPECT_DEATH((void)stream().below(0), "internal error"); }

}  // namespace
}  // namespace sandlot
