// Responses, extremes, descriptors and buckets, predicted by hand or by plain sums.
#include "navigation/visual_odometry/features.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "navigation/maps/grid.h"
#include "navigation/visual_odometry/test_scene.h"

namespace sandlot::navigation::vo {
namespace {

using test::Picture;

constexpr int blob_mask[5][5] = {
    {-1, -1, -1, -1, -1}, {-1, 1, 1, 1, -1}, {-1, 1, 8, 1, -1}, {-1, 1, 1, 1, -1}, {-1, -1, -1, -1, -1}};
constexpr int corner_mask[5][5] = {
    {-1, -1, 0, 1, 1}, {-1, -1, 0, 1, 1}, {0, 0, 0, 0, 0}, {1, 1, 0, -1, -1}, {1, 1, 0, -1, -1}};

Picture noise_picture(int width, int height, std::uint64_t seed) {
  Picture out(width, height, 128);
  test::add_noise(out, 50, seed);
  return out;
}

FeatureSet find(const Picture& picture, const FeatureSpec& spec) {
  return find_features(padded(picture.view()), spec);
}
std::size_t count_of(const FeatureSet& set, FeatureClass kind) {
  const auto squares = static_cast<std::size_t>(set.columns * set.rows), k = static_cast<std::size_t>(kind);
  return set.first[(k + 1) * squares] - set.first[k * squares];
}
const Feature& only(const FeatureSet& set, FeatureClass kind) {
  return set
      .features[set.first[static_cast<std::size_t>(kind) * static_cast<std::size_t>(set.columns * set.rows)]];
}

// One pixel of 100: around it each response is 100 times the mask's number that lies on it, mirrored.
TEST(VoFeatures, ResponsesOfOnePixelAreTheMasks) {
  Picture picture(40, 36);
  picture.at(20, 17) = 100;
  const PaddedImage image = padded(picture.view());
  const Responses found = responses(image);
  for (int y = -3; y <= 3; ++y)
    for (int x = -3; x <= 3; ++x) {
      const auto at = static_cast<std::size_t>((17 + y) * image.stride + 20 + x);
      const bool inside = std::abs(x) <= 2 && std::abs(y) <= 2;
      EXPECT_EQ(found.blob[at], inside ? 100 * blob_mask[2 - y][2 - x] : 0);
      EXPECT_EQ(found.corner[at], inside ? 100 * corner_mask[2 - y][2 - x] : 0);
    }
}

// Against the sum of 25 products at every pixel, sizes that are no multiples of 16 or 32.
TEST(VoFeatures, ResponsesOfNoiseAreTheSums) {
  for (const auto& [width, height] : {std::pair(61, 33), std::pair(96, 40)}) {
    Picture picture = noise_picture(width, height, 3);
    const PaddedImage image = padded(picture.view());
    const Responses found = responses(image);
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        int blob = 0, corner = 0;
        if (u >= 2 && v >= 2 && u < width - 2 && v < height - 2)
          for (int y = 0; y < 5; ++y)
            for (int x = 0; x < 5; ++x) {
              blob += blob_mask[y][x] * picture.at(u + x - 2, v + y - 2);
              corner += corner_mask[y][x] * picture.at(u + x - 2, v + y - 2);
            }
        const auto at = static_cast<std::size_t>(v * image.stride + u);
        ASSERT_EQ(found.blob[at], blob) << u << " " << v;
        ASSERT_EQ(found.corner[at], corner) << u << " " << v;
      }
  }
}

// Greatest responses: 255 under the positive numbers of the mask, 0 elsewhere. Their sums are 16 and 8.
TEST(VoFeatures, ExtremeResponsesFitTheirType) {
  Picture blob(40, 40), corner(40, 40);
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) {
      blob.at(20 + x, 20 + y) = blob_mask[y + 2][x + 2] > 0 ? 255 : 0;
      corner.at(20 + x, 20 + y) = corner_mask[y + 2][x + 2] > 0 ? 255 : 0;
    }
  EXPECT_EQ(only(find(blob, {}), FeatureClass::blob_max).response, 16 * 255);
  EXPECT_EQ(only(find(corner, {}), FeatureClass::corner_max).response, 8 * 255);
}

TEST(VoFeatures, UniformImagesHaveNone) {
  for (const int grey : {0, 7, 255})
    EXPECT_TRUE(find(Picture(64, 64, static_cast<std::uint8_t>(grey)), {}).features.empty());
}

// Bright quadrants upper right and lower left of the corner between pixels 31 and 32: all of the mask's blocks lie in their
// quadrants at (31, 31), (32, 31), (31, 32) and (32, 32), where the response is 2 * 4 * 200. The first one counts.
TEST(VoFeatures, CornerOfQuadrants) {
  Picture picture(64, 64);
  for (int v = 0; v < 64; ++v)
    for (int u = 0; u < 64; ++u) picture.at(u, v) = (u >= 32) != (v >= 32) ? 200 : 0;
  const FeatureSet set = find(picture, {});
  ASSERT_EQ(count_of(set, FeatureClass::corner_max), 1u);
  const Feature& corner = only(set, FeatureClass::corner_max);
  EXPECT_EQ(corner.u, 31);
  EXPECT_EQ(corner.v, 31);
  EXPECT_EQ(corner.response, 1600);
  // Mirrored, it is a least one.
  for (int v = 0; v < 64; ++v)
    for (int u = 0; u < 64; ++u) picture.at(u, v) = (u >= 32) == (v >= 32) ? 200 : 0;
  const FeatureSet mirrored = find(picture, {});
  ASSERT_EQ(count_of(mirrored, FeatureClass::corner_min), 1u);
  EXPECT_EQ(only(mirrored, FeatureClass::corner_min).response, -1600);
}

// Two bright pixels: both are blobs when they are farther apart than the radius, else only the brighter one.
TEST(VoFeatures, WeakerNeighboursAreSuppressed) {
  for (int apart = 1; apart <= 8; ++apart)
    for (const int radius : {3, 5}) {
      Picture picture(64, 64, 20);
      picture.at(30, 33) = 120;
      picture.at(30 + apart, 33) = 119;
      const FeatureSet set = find(picture, {.nms_radius = radius, .threshold = 400});
      EXPECT_EQ(count_of(set, FeatureClass::blob_max), apart > radius ? 2u : 1u) << apart << " " << radius;
      EXPECT_EQ(only(set, FeatureClass::blob_max).u, 30);
    }
}

// Against the definition, at every pixel.
TEST(VoFeatures, ExtremesAreAllThereAre) {
  const Picture picture = noise_picture(90, 70, 5);
  const PaddedImage image = padded(picture.view());
  const Responses found = responses(image);
  const FeatureSpec spec{.nms_radius = 2, .threshold = 300, .bucket_features = 100};
  std::size_t expected = 0;
  for (const auto* response : {&found.blob, &found.corner})
    for (const int sign : {1, -1})
      for (int v = feature_margin_px; v < 70 - feature_margin_px; ++v)
        for (int u = feature_margin_px; u < 90 - feature_margin_px; ++u) {
          const auto value = [&](int x, int y) {
            return sign * (*response)[static_cast<std::size_t>(y * image.stride + x)];
          };
          bool wins = value(u, v) >= spec.threshold;
          for (int y = v - 2; y <= v + 2; ++y)
            for (int x = u - 2; x <= u + 2; ++x)
              wins = wins && (value(x, y) < value(u, v) || (x == u && y == v) ||
                              (value(x, y) == value(u, v) && std::tuple(y, x) > std::tuple(v, u)));
          expected += wins;
        }
  EXPECT_EQ(find_features(image, spec).features.size(), expected);
  EXPECT_GT(expected, 100u);
}

// A ramp of 4 per column: Sobel's du is 4 * (4 + 4) = 32, a quarter of it 8; dv is 0. The bright pixel that makes the feature is
// out of reach of all samples but the four nearest.
TEST(VoFeatures, DescriptorOfARamp) {
  Picture picture(60, 60);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 60; ++u) picture.at(u, v) = static_cast<std::uint8_t>(4 * u);
  picture.at(30, 30) = 250;
  const FeatureSet set = find(picture, {.threshold = 500});
  ASSERT_EQ(count_of(set, FeatureClass::blob_max), 1u);
  const Feature& feature = only(set, FeatureClass::blob_max);
  for (std::size_t i = 4; i < 16; ++i) {
    EXPECT_EQ(feature.descriptor[2 * i], 128 + 8);
    EXPECT_EQ(feature.descriptor[2 * i + 1], 128);
  }
  // The sample up left of it sees 250 - 120 = 130 more at its lower right: du and dv grow by 130.
  EXPECT_EQ(feature.descriptor[0], 128 + (32 + 130) / 4);
  EXPECT_EQ(feature.descriptor[1], 128 + 130 / 4);
  EXPECT_EQ(distance(feature, feature), 0);
}

TEST(VoFeatures, DescriptorsDoNotDependOnBrightness) {
  Picture dark = noise_picture(80, 64, 9);
  for (std::uint8_t& pixel : dark.pixels) pixel = static_cast<std::uint8_t>(pixel / 2);
  Picture bright = dark;
  for (std::uint8_t& pixel : bright.pixels) pixel = static_cast<std::uint8_t>(pixel + 100);
  const FeatureSet a = find(dark, {.bucket_features = 10}), b = find(bright, {.bucket_features = 10});
  ASSERT_EQ(a.features.size(), b.features.size());
  ASSERT_GT(a.features.size(), 50u);
  for (std::size_t i = 0; i < a.features.size(); ++i) EXPECT_EQ(distance(a.features[i], b.features[i]), 0);
}

TEST(VoFeatures, SquaresKeepTheirStrongest) {
  const Picture picture = noise_picture(100, 70, 11);
  const FeatureSet all = find(picture, {.bucket_px = 20, .bucket_features = 100});
  const FeatureSet kept = find(picture, {.bucket_px = 20, .bucket_features = 2});
  ASSERT_EQ(all.first.size(), 4u * 5 * 4 + 1);
  ASSERT_EQ(kept.first.size(), all.first.size());
  std::size_t full = 0;
  for (std::size_t square = 0; square + 1 < all.first.size(); ++square) {
    const std::size_t count = all.first[square + 1] - all.first[square],
                      left = kept.first[square + 1] - kept.first[square];
    EXPECT_EQ(left, std::min<std::size_t>(count, 2));
    full += count > 2;
    for (std::size_t i = 0; i < count; ++i) {
      const Feature& feature = all.features[all.first[square] + i];
      const std::size_t place = square % 20;
      EXPECT_EQ(static_cast<std::size_t>(feature.u / 20), place % 5);
      EXPECT_EQ(static_cast<std::size_t>(feature.v / 20), place / 5);
      if (i > 0) {
        EXPECT_LE(std::abs(feature.response), std::abs(all.features[all.first[square] + i - 1].response));
      }
      if (i < left) { EXPECT_EQ(feature.response, kept.features[kept.first[square] + i].response); }
    }
  }
  EXPECT_GT(full, 5u);
}

// A bright square of two by two pixels is one bright pixel of the half image.
TEST(VoFeatures, HalfResolution) {
  Picture picture(80, 72, 10);
  for (int v = 40; v < 42; ++v)
    for (int u = 50; u < 52; ++u) picture.at(u, v) = 110;
  const FeatureSet set = find(picture, {.half_resolution = true});
  ASSERT_EQ(count_of(set, FeatureClass::blob_max), 1u);
  const Feature& feature = only(set, FeatureClass::blob_max);
  EXPECT_EQ(set.scale, 2);
  EXPECT_EQ(feature.u, 25);
  EXPECT_EQ(feature.v, 20);
  EXPECT_EQ(feature.response, 800);
  // Means are rounded: (1 + 2 + 2 + 2) / 4 = 1.75 to 2, (4 + 2 + 2 + 2) / 4 = 2.5 to 3.
  Picture small(32, 32, 2);
  small.at(0, 0) = 1;
  small.at(2, 0) = 4;
  const PaddedImage half = halved(padded(small.view()));
  EXPECT_EQ(half.width, 16);
  EXPECT_EQ(half.row(0)[0], 2);
  EXPECT_EQ(half.row(0)[1], 3);
}

TEST(VoFeatures, ImagesThatDoNotFitAreRefused) {
  const std::vector<std::uint8_t> pixels(64 * 64);
  EXPECT_TRUE(check({pixels, 64, 64, 64}));
  EXPECT_TRUE(check({pixels, 32, 64, 64}));
  // The last row needs no bytes after its pixels.
  EXPECT_TRUE(check({std::span(pixels).first(63 * 64 + 32), 32, 64, 64}));
  EXPECT_FALSE(check({std::span(pixels).first(63 * 64 + 31), 32, 64, 64}));
  EXPECT_FALSE(check({pixels, 64, 65, 64}));
  EXPECT_FALSE(check({pixels, 64, 64, 63}));
  EXPECT_FALSE(check({pixels, 31, 64, 64}));
  EXPECT_FALSE(check({pixels, 64, 0, 64}));
  EXPECT_FALSE(check({pixels, -64, 64, 64}));
  EXPECT_FALSE(check({pixels, 5000, 64, 5000}));
  EXPECT_FALSE(check({pixels, 2'000'000'000, 2'000'000'000, 2'000'000'000}));
  EXPECT_FALSE(check({{}, 64, 64, 64}));
}

// Rows of a larger image: the bytes between them do not count.
TEST(VoFeatures, StrideIsFollowed) {
  Picture whole = noise_picture(100, 60, 13);
  Picture part(64, 60);
  for (int v = 0; v < 60; ++v)
    for (int u = 0; u < 64; ++u) part.at(u, v) = whole.at(u + 10, v);
  const PaddedImage a = padded(part.view()),
                    b = padded({std::span<const std::uint8_t>(whole.pixels).subspan(10), 64, 60, 100});
  EXPECT_EQ(a.pixels, b.pixels);
}

TEST(VoFeatures, DamagedSetsAreNotSound) {
  const PaddedImage image = padded(noise_picture(64, 64, 17).view());
  const FeatureSet good = find_features(image, {});
  EXPECT_TRUE(sound(image));
  EXPECT_TRUE(sound(good, image));
  FeatureSet bad = good;
  bad.features.pop_back();
  EXPECT_FALSE(sound(bad, image));
  bad = good;
  bad.features.front().u = 64;
  EXPECT_FALSE(sound(bad, image));
  bad = good;
  bad.first[1] = bad.first[2] + 1;
  EXPECT_FALSE(sound(bad, image));
  bad = good;
  bad.columns = 0;
  EXPECT_FALSE(sound(bad, image));
  PaddedImage cut = image;
  cut.pixels.pop_back();
  EXPECT_FALSE(sound(cut));
  EXPECT_FALSE(sound(PaddedImage{}));
}

TEST(VoFeatures, RangesOfTheSpec) {
  EXPECT_TRUE(check_ranges(FeatureSpec{}));
  EXPECT_FALSE(check_ranges(FeatureSpec{.nms_radius = 0}));
  EXPECT_FALSE(check_ranges(FeatureSpec{.bucket_px = 7}));
}

}  // namespace
}  // namespace sandlot::navigation::vo
