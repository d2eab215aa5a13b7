#include "assets/image/visible.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>

#include "assets/image/image.h"
#include "assets/image/write.h"

namespace sandlot::assets {
namespace {

using Bytes = std::vector<std::uint8_t>;

msg::Image image(const char* encoding, std::uint32_t width, std::uint32_t height, std::uint32_t step,
                 Bytes data) {
  msg::Image out;
  out.encoding = encoding;
  out.width = width;
  out.height = height;
  out.step = step;
  out.data = std::move(data);
  return out;
}

Bytes rgb_of(const msg::Image& message) {
  const auto picture = visible(message);
  EXPECT_TRUE(picture) << picture.error().text();
  return picture ? picture->rgb : Bytes();
}

TEST(Visible, ColoursAreReadInTheirOrderAndRowsByTheirStep) {
  EXPECT_EQ(rgb_of(image("rgb8", 1, 2, 4, {1, 2, 3, 99, 4, 5, 6, 99})), (Bytes{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(rgb_of(image("bgr8", 1, 1, 3, {1, 2, 3})), (Bytes{3, 2, 1}));
  EXPECT_EQ(rgb_of(image("rgba8", 1, 1, 4, {1, 2, 3, 4})), (Bytes{1, 2, 3}));
  EXPECT_EQ(rgb_of(image("bgra8", 1, 1, 4, {1, 2, 3, 4})), (Bytes{3, 2, 1}));
  EXPECT_EQ(rgb_of(image("mono8", 2, 1, 2, {7, 8})), (Bytes{7, 7, 7, 8, 8, 8}));
  EXPECT_EQ(rgb_of(image("mono16", 1, 1, 2, {0x34, 0x12})), (Bytes{0x12, 0x12, 0x12}));
}

TEST(Visible, DistancesGoFromYellowToDarkBlue) {
  const std::array<float, 4> metres{1, 10, 0, std::numeric_limits<float>::infinity()};
  Bytes bytes(sizeof metres);
  std::memcpy(bytes.data(), metres.data(), sizeof metres);
  const Bytes near_far{255, 242, 89, 13, 13, 77, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(rgb_of(image("32FC1", 4, 1, 16, bytes)), near_far);
  // 1 m and 10 m again, in millimetres.
  EXPECT_EQ(rgb_of(image("16UC1", 3, 1, 6, {0xe8, 0x03, 0x10, 0x27, 0, 0})),
            Bytes(near_far.begin(), near_far.begin() + 9));
}

TEST(Visible, LabelsHaveColoursOfTheirOwn) {
  const std::array<std::uint32_t, 5> labels{0, 1, 2, 3, 1};
  const Bytes rgb = label_colours(labels);
  const auto colour = [&](std::size_t i) { return std::array{rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}; };
  EXPECT_EQ(colour(0), (std::array<std::uint8_t, 3>{0, 0, 0}));
  EXPECT_EQ(colour(1), colour(4));
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(colour(i), colour(k)) << i << k;
}

TEST(Visible, RefusesWhatDoesNotFit) {
  EXPECT_FALSE(visible(image("yuv422", 2, 2, 4, Bytes(8))));
  EXPECT_FALSE(visible(image("rgb8", 0, 0, 0, {})));
  EXPECT_FALSE(visible(image("rgb8", 2, 2, 6, Bytes(11))));
  EXPECT_FALSE(visible(image("rgb8", 2, 2, 5, Bytes(12))));
  EXPECT_FALSE(visible(image("rgb8", 100'000, 100'000, 300'000, Bytes(12))));
  EXPECT_FALSE(visible(image("rgb8", 0xffffffff, 0xffffffff, 0xffffffff, Bytes(12))));
}

TEST(Visible, ACompressedImageIsDecoded) {
  const Bytes rgb{10, 20, 30, 40, 50, 60};
  const std::string png = png_of(Pixels8{2, 1, 3, rgb});
  msg::CompressedImage message;
  message.data.assign(png.begin(), png.end());
  const auto picture = visible(message);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width, 2);
  EXPECT_EQ(picture->rgb, rgb);
  message.data.resize(20);
  EXPECT_FALSE(visible(message));
}

TEST(Visible, ShrinkingTakesMeans) {
  // 4 x 2 to 2 x 1: means of four pixels each; a column that is left over stands for itself.
  Picture p{4, 2, {}};
  for (const int grey : {0, 10, 100, 100, 20, 30, 100, 104})
    for (int k = 0; k < 3; ++k) p.rgb.push_back(static_cast<std::uint8_t>(grey));
  const Picture small = shrunk(p, 2);
  EXPECT_EQ(small.width, 2);
  EXPECT_EQ(small.height, 1);
  EXPECT_EQ(small.rgb, (Bytes{15, 15, 15, 101, 101, 101}));
  EXPECT_EQ(shrunk(p, 4).rgb, p.rgb);
  EXPECT_EQ(shrunk(p, 3).width, 2);
}

TEST(Written, PngAndJpegReadBack) {
  Bytes rgb;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x)
      for (const int c : {10 * x, 15 * y, 128}) rgb.push_back(static_cast<std::uint8_t>(c));
  const Pixels8 pixels{24, 16, 3, rgb};
  const auto png = parse_image(png_of(pixels), "a.png");
  ASSERT_TRUE(png);
  EXPECT_EQ(Bytes(png->data.begin(), png->data.end()), rgb) << "without loss";
  const auto jpeg = parse_image(jpeg_of(pixels, 95), "a.jpg");
  ASSERT_TRUE(jpeg);
  ASSERT_EQ(jpeg->data.size(), rgb.size());
  // Smooth ramps: the quantiser of quality 95 leaves a few units.
  for (std::size_t i = 0; i < rgb.size(); ++i) ASSERT_NEAR(jpeg->data[i], rgb[i], 6) << i;
  const std::array<std::uint16_t, 4> grey{0, 1, 256, 65535};
  const auto deep = parse_image(png_of(Pixels16{2, 2, 1, grey}), "a.png");
  ASSERT_TRUE(deep);
  EXPECT_EQ(deep->bits, 16);
  EXPECT_TRUE(std::equal(grey.begin(), grey.end(), deep->data.begin(), deep->data.end()));
  EXPECT_FALSE(write_png("no/such/folder/a.png", pixels));
}

}  // namespace
}  // namespace sandlot::assets
