#include "noise/image_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/depth_noise.h"
#include "noise/deviates.h"

namespace sandlot::image_noise_test {
namespace {

using namespace image_stage;
using testing::Each;
using testing::HasSubstr;

Stream device(std::uint64_t entity = 2) { return {1, entity, Purpose::initial, 0}; }
Stream sample(std::uint64_t k) { return {1, 2, Purpose::noise, k}; }

struct Picture {
  int width = 160, height = 120, channels = 3;
  std::vector<std::uint8_t> pixels;
  Picture(std::uint8_t value = 128, int c = 3) : channels(c) {
    pixels.assign(static_cast<std::size_t>(width * height * channels), value);
  }
  std::uint8_t at(int x, int y, int c = 0) const {
    return pixels[static_cast<std::size_t>((y * width + x) * channels + c)];
  }
  int count() const { return width * height; }
};

Picture corrupted(const std::vector<ImageStageSpec>& stages, Picture picture = {}, std::uint64_t k = 0,
                  double errors = 1, std::uint64_t entity = 2) {
  const ImageNoiseSpec spec{stages};
  ImageNoise noise;
  noise.reset(spec, device(entity));
  noise.corrupt(spec, picture.pixels, picture.width, picture.height, picture.channels,
                Stream(1, entity, Purpose::noise, k), errors);
  return picture;
}

struct Moments {
  double mean = 0, variance = 0;
};
template <class Values>
Moments moments(const Values& values) {
  Moments out;
  for (const auto v : values) out.mean += static_cast<double>(v) / static_cast<double>(values.size());
  for (const auto v : values) {
    const double d = static_cast<double>(v) - out.mean;
    out.variance += d * d / static_cast<double>(values.size());
  }
  return out;
}
/// Five standard deviations of a count of n trials.
double five_binomial(double p, double n) { return 5 * std::sqrt(p * (1 - p) * n); }

TEST(Deviates, AreNormal) {
  std::vector<float> n(400'000);
  fill_normals(sample(0), 0, n);
  const Moments m = moments(n);
  const auto size = static_cast<double>(n.size());
  EXPECT_NEAR(m.mean, 0, 5 / std::sqrt(size));
  EXPECT_NEAR(m.variance, 1, 5 * std::sqrt(2 / size));
  // Beyond k deviations lie erfc(k / sqrt 2) of them.
  for (const auto& [k, p] : {std::pair(1.0, 0.317310507863), {2.0, 0.045500263896}, {3.0, 0.002699796063}}) {
    const auto beyond = std::count_if(n.begin(), n.end(),
                                      [of = static_cast<float>(k)](float x) { return std::abs(x) > of; });
    EXPECT_NEAR(static_cast<double>(beyond), p * size, five_binomial(p, size)) << k;
  }
  // Any part of them is the same numbers: that lets rows be done in any order.
  std::vector<float> part(100);
  fill_normals(sample(0), 7, part);
  EXPECT_TRUE(std::equal(part.begin(), part.end(), n.begin() + 7 * 8));
}

TEST(ImageNoise, GaussianHasItsVarianceInEveryChannelOrInAllAlike) {
  constexpr double std = 0.02;
  const Picture apart = corrupted({Gaussian{.std = std}});
  const auto n = static_cast<double>(apart.pixels.size());
  // Rounding to bytes adds the variance of a uniform step, 1/12.
  const double variance = 255 * 255 * std * std + 1.0 / 12;
  const Moments m = moments(apart.pixels);
  EXPECT_NEAR(m.mean, 128, 5 * std::sqrt(variance / n));
  EXPECT_NEAR(m.variance, variance, variance * 5 * std::sqrt(2 / n));
  double product = 0;
  for (int i = 0; i < apart.count(); ++i)
    product += (apart.pixels[static_cast<std::size_t>(3 * i)] - m.mean) *
               (apart.pixels[static_cast<std::size_t>(3 * i + 1)] - m.mean);
  // Independent: the mean product of n pairs has the deviation variance / sqrt(n).
  EXPECT_NEAR(product / apart.count(), 0, 5 * variance / std::sqrt(apart.count()));

  const Picture together = corrupted({Gaussian{.std = std, .channels = Gaussian::Channels::together}});
  EXPECT_NEAR(moments(together.pixels).variance, variance, variance * 5 * std::sqrt(2.0 / together.count()));
  for (int i = 0; i < together.count(); ++i) {
    const auto at = static_cast<std::size_t>(3 * i);
    ASSERT_EQ(together.pixels[at], together.pixels[at + 1]);
    ASSERT_EQ(together.pixels[at], together.pixels[at + 2]);
  }
  EXPECT_NE(corrupted({Gaussian{.std = std}}, {}, 1).pixels, apart.pixels) << "each picture errs anew";
}

TEST(ImageNoise, ShotNoiseGrowsWithTheLight) {
  for (const int grey : {40, 160}) {
    const Picture seen = corrupted({Shot{.full_well = 2000}}, Picture(static_cast<std::uint8_t>(grey)));
    const double variance = 255 * 255 * (grey / 255.0) / 2000 + 1.0 / 12;
    EXPECT_NEAR(moments(seen.pixels).variance, variance,
                variance * 5 * std::sqrt(2.0 / static_cast<double>(seen.pixels.size())));
  }
}

TEST(ImageNoise, SaltAndPepperComeWithTheirProbabilities) {
  const SaltAndPepper spec{.salt = 0.02, .pepper = 0.05};
  for (const double errors : {0.5, 1.0, 100.0}) {
    const Picture seen = corrupted({spec}, {}, 0, errors);
    int salt = 0, pepper = 0;
    for (int i = 0; i < seen.count(); ++i) {
      const auto* const rgb = &seen.pixels[static_cast<std::size_t>(3 * i)];
      ASSERT_TRUE(rgb[0] == rgb[1] && rgb[1] == rgb[2]);
      ASSERT_TRUE(rgb[0] == 0 || rgb[0] == 128 || rgb[0] == 255);
      salt += rgb[0] == 255;
      pepper += rgb[0] == 0;
    }
    // More often than always is in the same proportion.
    const double p = std::min(0.02 * errors, 2.0 / 7), q = std::min(0.05 * errors, 5.0 / 7);
    EXPECT_NEAR(salt, p * seen.count(), five_binomial(p, seen.count())) << errors;
    EXPECT_NEAR(pepper, q * seen.count(), five_binomial(q, seen.count())) << errors;
  }
}

TEST(ImageNoise, HundredsAndThousandsAreOfAllColours) {
  const Picture seen = corrupted({HundredsAndThousands{.rate = 0.3}});
  std::vector<double> colours;
  int hit = 0;
  for (int i = 0; i < seen.count(); ++i) {
    const auto* const rgb = &seen.pixels[static_cast<std::size_t>(3 * i)];
    if (rgb[0] == 128 && rgb[1] == 128 && rgb[2] == 128) continue;
    ++hit;
    colours.insert(colours.end(), rgb, rgb + 3);
  }
  EXPECT_NEAR(hit, 0.3 * seen.count(), five_binomial(0.3, seen.count()));
  // Uniform over 0..255: mean 127.5, variance (256^2 - 1) / 12; the variance of a uniform's square is 4/5 of
  // its square.
  const auto n = static_cast<double>(colours.size());
  const double variance = (256.0 * 256 - 1) / 12;
  EXPECT_NEAR(moments(colours).mean, 127.5, 5 * std::sqrt(variance / n));
  EXPECT_NEAR(moments(colours).variance, variance, 5 * variance * std::sqrt(0.8 / n));
}

TEST(ImageNoise, APatternIsTheDevicesOwnAndStays) {
  const std::vector<ImageStageSpec> stages{FixedPattern{.offset_std = 0.02, .gain_std = 0.03},
                                           DeadPixels{.dead = 0.01, .hot = 0.02}};
  const Picture first = corrupted(stages, {}, 0), second = corrupted(stages, {}, 1);
  EXPECT_EQ(first.pixels, second.pixels);
  EXPECT_NE(first.pixels, corrupted(stages, {}, 0, 1, 77).pixels) << "another device";

  const Picture pattern = corrupted({stages[0]});
  const double x = 128 / 255.0, variance = 255 * 255 * (0.02 * 0.02 + 0.03 * 0.03 * x * x) + 1.0 / 12;
  EXPECT_NEAR(moments(pattern.pixels).variance, variance,
              variance * 5 * std::sqrt(2.0 / static_cast<double>(pattern.pixels.size())));
  const Picture dead = corrupted({stages[1]}, Picture(128, 1));
  const double n = dead.count();
  const auto count = [&](int value) {
    return static_cast<double>(std::count(dead.pixels.begin(), dead.pixels.end(), value));
  };
  EXPECT_NEAR(count(0), 0.01 * n, five_binomial(0.01, n));
  EXPECT_NEAR(count(255), 0.02 * n, five_binomial(0.02, n));
}

TEST(ImageNoise, RowsErrAsAWhole) {
  std::vector<double> rows;
  for (std::uint64_t k = 0; k < 20; ++k) {
    const Picture seen = corrupted({Rows{.std = 0.04}}, {}, k);
    for (int y = 0; y < seen.height; ++y) {
      rows.push_back(seen.at(0, y));
      for (int x = 0; x < seen.width; ++x) ASSERT_EQ(seen.at(x, y, 2), seen.at(0, y));
    }
  }
  const double variance = 255 * 255 * 0.04 * 0.04 + 1.0 / 12;
  EXPECT_NEAR(moments(rows).variance, variance,
              variance * 5 * std::sqrt(2 / static_cast<double>(rows.size())));
}

TEST(ImageNoise, VignettingTakesItsShareInTheCorners) {
  Picture even(200);
  even.width = 81, even.height = 61;
  even.pixels.assign(81 * 61 * 3, 200);
  const Picture seen = corrupted({Vignetting{.strength = 0.5}}, even);
  EXPECT_EQ(seen.at(40, 30), 200);
  EXPECT_EQ(seen.at(0, 0), 100);
  EXPECT_EQ(seen.at(80, 60, 2), 100);
  // (40/50)^2 and (30/50)^2 of the corner's radius squared.
  EXPECT_EQ(seen.at(80, 30), 136);
  EXPECT_EQ(seen.at(40, 0), 164);
}

const std::vector<ImageStageSpec> all_types{Vignetting{.strength = 0.3},
                                            Shot{.full_well = 3000},
                                            FixedPattern{0.01, 0.02},
                                            Gaussian{.std = 0.02},
                                            Rows{.std = 0.01},
                                            HundredsAndThousands{.rate = 0.01},
                                            DeadPixels{.dead = 0.001, .hot = 0.001},
                                            SaltAndPepper{.salt = 0.01, .pepper = 0.01}};

TEST(ImageNoise, PartsOfAPictureAreThoseOfTheWhole) {
  for (const int channels : {1, 3, 4}) {
    const Picture whole = corrupted(all_types, Picture(90, channels));
    Picture parts(90, channels);
    const ImageNoiseSpec spec{all_types};
    ImageNoise noise;
    noise.reset(spec, device());
    Stream drawn = sample(0);
    drawn.normal();  // its position does not matter
    for (int y = parts.height - 10; y >= 0; y -= 10) {
      const auto row = static_cast<std::size_t>(parts.width * channels);
      noise.corrupt(spec, std::span(parts.pixels).subspan(static_cast<std::size_t>(y) * row, 10 * row),
                    parts.width, parts.height, channels, drawn, 1, y);
    }
    EXPECT_EQ(parts.pixels, whole.pixels) << channels;
  }
}

TEST(ImageNoise, AStageMovesNoOthersNumbersAndWithoutErrorsNothingMoves) {
  const Picture alone = corrupted({SaltAndPepper{.salt = 0.01}});
  const Picture behind = corrupted({Gaussian{.std = 0.01}, SaltAndPepper{.salt = 0.01}});
  for (std::size_t i = 0; i < alone.pixels.size(); ++i)
    ASSERT_EQ(alone.pixels[i] == 255, behind.pixels[i] == 255);
  EXPECT_THAT(corrupted(all_types, {}, 0, 0).pixels, Each(128));
}

std::vector<float> corrupted(const std::vector<DepthStageSpec>& stages, std::vector<float> depth_m, int width,
                             double errors = 1) {
  const int height = static_cast<int>(depth_m.size()) / width;
  corrupt_depth({stages}, depth_m, width, height, sample(0), errors);
  return depth_m;
}

TEST(DepthNoise, GrowsWithTheSquareOfTheDistance) {
  for (const float z : {1.0F, 4.0F}) {
    const auto seen = corrupted({depth_stage::Gaussian{.std = 0.001}, depth_stage::Quadratic{.std = 0.0014}},
                                std::vector<float>(40'000, z), 200, 2);
    const double quadratic = 0.0014 * static_cast<double>(z * z),
                 variance = 4 * (1e-6 + quadratic * quadratic);
    EXPECT_NEAR(moments(seen).variance, variance, variance * 5 * std::sqrt(2.0 / 40'000)) << z;
    EXPECT_NEAR(moments(seen).mean, static_cast<double>(z), 5 * std::sqrt(variance / 40'000)) << z;
  }
}

TEST(DepthNoise, DisparitiesComeInSteps) {
  // f b = 40 pixel m in steps of 1/2: at 3 m 13.33 pixels become 13.5; what is beyond 160 m is less than half
  // a step.
  const auto inf = std::numeric_limits<float>::infinity();
  const auto seen = corrupted({depth_stage::Disparity{.step = 0.5, .focal_baseline_m = 40}}, {3, 8, inf, 200},
                              4);
  EXPECT_NEAR(seen[0], 40 / 13.5, 1e-6);
  EXPECT_EQ(seen[1], 8);
  EXPECT_EQ(seen[2], inf);
  EXPECT_EQ(seen[3], inf);
}

TEST(DepthNoise, EdgesAreLostOrBetweenBothSurfaces) {
  // A post of 1 m before a wall of 3 m: the pixels left and right of both edges, and nothing else.
  std::vector<float> scene(100, 3.0F);
  std::fill(scene.begin() + 40, scene.begin() + 70, 1.0F);  // also over the border of two pieces
  const auto lost = corrupted({depth_stage::Edges{.jump_m = 0.5}}, scene, 100);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_EQ(std::isnan(lost[i]), i == 39 || i == 40 || i == 69 || i == 70) << i;
  std::vector<float> many;
  for (int k = 0; k < 500; ++k) many.insert(many.end(), scene.begin(), scene.end());
  const auto mixed = corrupted(
      {depth_stage::Edges{.jump_m = 0.5, .rate = 0.5, .shows = depth_stage::Edges::Shows::mixed}}, many, 100);
  std::vector<double> between;
  for (std::size_t i = 0; i < many.size(); ++i)
    if (mixed[i] != many[i]) between.push_back(static_cast<double>(mixed[i]));
  const auto n = static_cast<double>(between.size());
  EXPECT_NEAR(n, 0.5 * 2000, five_binomial(0.5, 2000));
  EXPECT_NEAR(moments(between).mean, 2, 5 * std::sqrt(4.0 / 12 / n)) << "uniform in 1..3";
  EXPECT_NEAR(moments(between).variance, 4.0 / 12, 5 * 4.0 / 12 * std::sqrt(0.8 / n));
}

TEST(DepthNoise, DropoutsAndPartsOfAPicture) {
  const std::vector<DepthStageSpec> stages{
      depth_stage::Gaussian{.std = 0.01}, depth_stage::Edges{.jump_m = 0.02, .rate = 0.3},
      depth_stage::Dropouts{.rate = 0.05, .shows = depth_stage::Dropouts::Shows::inf}};
  const std::vector<float> scene(30'000, 2);
  const auto whole = corrupted(stages, scene, 150);
  std::vector<float> parts = scene;
  for (int y = 190; y >= 0; y -= 10)
    corrupt_depth({stages}, std::span(parts).subspan(static_cast<std::size_t>(y) * 150, 1500), 150, 200,
                  sample(0), 1, y);
  const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  EXPECT_TRUE(std::equal(whole.begin(), whole.end(), parts.begin(), same));
  const auto lost = static_cast<double>(
      std::count(whole.begin(), whole.end(), std::numeric_limits<float>::infinity()));
  EXPECT_NEAR(lost, 0.05 * 30'000, five_binomial(0.05, 30'000));
  EXPECT_EQ(corrupted(stages, scene, 150, 0), scene);
}

struct Holder {
  ImageNoiseSpec noise;
  DepthNoiseSpec depth;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"noise", "1", "Errors."}, s.noise);
    visit(Field{"depth", "m", "Errors."}, s.depth);
  }
};
std::string fault(const char* key, const char* name,
                  std::initializer_list<std::pair<const char*, const char*>> keys) {
  Node inner = Node::map(), stage = Node::map(), list = Node::sequence(), root = Node::map();
  for (const auto& [k, value] : keys) inner.set(k, Node::scalar(value));
  stage.set(name, std::move(inner));
  list.push(std::move(stage));
  root.set(key, std::move(list));
  const auto read = read_spec<Holder>(root);
  return read ? "" : read.error().text();
}

TEST(ImageNoise, IsReadAsAListAndBadOnesAreRefused) {
  EXPECT_EQ(fault("noise", "gaussian", {{"std", "2 %"}, {"channels", "together"}}), "");
  EXPECT_EQ(fault("noise", "salt_and_pepper", {{"salt", "0.5"}, {"pepper", "50 %"}}), "");
  EXPECT_THAT(fault("noise", "gaussian", {{"std", "-0.1"}}),
              HasSubstr("/noise/0/gaussian/std: must be in [0, 10]"));
  EXPECT_THAT(fault("noise", "gaussian", {{"std", "nan"}}), HasSubstr("/noise/0/gaussian/std"));
  EXPECT_THAT(fault("noise", "gaussian", {}), HasSubstr("'std' is missing"));
  EXPECT_THAT(fault("noise", "gausian", {}), HasSubstr("gaussian"));
  EXPECT_THAT(fault("noise", "salt_and_pepper", {{"salt", "0.6"}, {"pepper", "0.5"}}),
              HasSubstr("more than 1"));
  EXPECT_THAT(fault("noise", "drift", {{"std", "1"}}), HasSubstr("unknown key 'drift'"));
  EXPECT_EQ(fault("depth", "quadratic", {{"std", "1.4 mm"}}), "");
  EXPECT_THAT(fault("depth", "disparity", {{"step", "0.125"}}), HasSubstr("'focal_baseline' is missing"));
}

}  // namespace
}  // namespace sandlot::image_noise_test
