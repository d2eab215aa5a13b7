#include "assets/image/image.h"

#include <gtest/gtest.h>
// libpng and libjpeg make the images, since writing them is not our job.
#include <png.h>

#include <cstdio>
// libjpeg's header needs FILE first.
#include <jpeglib.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "assets/image/write.h"

namespace sandlot::assets {
namespace {

/// @param samples  rows from the top, as the file has them (16 bit: in this machine's order)
std::string png(int width, int height, int bits, int type, const std::vector<std::uint16_t>& samples,
                bool interlaced = false) {
  std::string out;
  png_structp write = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(write);
  png_set_write_fn(
      write, &out,
      [](png_structp p, png_bytep data, png_size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(data), n);
      },
      nullptr);
  png_set_IHDR(write, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits, type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE,
               PNG_FILTER_TYPE_BASE);
  std::array<png_color, 2> palette{{{10, 20, 30}, {200, 100, 0}}};
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(write, info, palette.data(), 2);
  png_write_info(write, info);
  std::vector<png_byte> bytes;
  for (const std::uint16_t s : samples) {
    if (bits == 16) bytes.push_back(static_cast<png_byte>(s >> 8));
    bytes.push_back(static_cast<png_byte>(s & 255));
  }
  if (bits < 8) png_set_packing(write);
  std::vector<png_bytep> rows;
  const std::size_t row = bytes.size() / static_cast<std::size_t>(height);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) rows.push_back(bytes.data() + y * row);
  png_write_image(write, rows.data());
  png_write_end(write, info);
  png_destroy_write_struct(&write, &info);
  return out;
}

std::string jpeg(int width, int height, int channels, const std::vector<JSAMPLE>& samples) {
  jpeg_compress_struct write{};
  jpeg_error_mgr errors{};
  write.err = jpeg_std_error(&errors);
  jpeg_create_compress(&write);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&write, &bytes, &size);
  write.image_width = static_cast<JDIMENSION>(width);
  write.image_height = static_cast<JDIMENSION>(height);
  write.input_components = channels;
  write.in_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&write);
  jpeg_set_quality(&write, 100, TRUE);
  jpeg_start_compress(&write, TRUE);
  for (int y = 0; y < height; ++y) {
    auto* row = const_cast<JSAMPLE*>(samples.data() + y * width * channels);
    jpeg_write_scanlines(&write, &row, 1);
  }
  jpeg_finish_compress(&write);
  jpeg_destroy_compress(&write);
  std::string out(reinterpret_cast<char*>(bytes), size);
  std::free(bytes);  // NOLINT(cppcoreguidelines-no-malloc): libjpeg's
  return out;
}

Image read(const std::string& bytes) {
  auto image = parse_image(bytes, "a.png");
  EXPECT_TRUE(image) << (image ? "" : image.error().text());
  return image ? std::move(*image) : Image{};
}
std::string complaint(const std::string& bytes, const ImageLimits& limits = {}) {
  const auto image = parse_image(bytes, "a.png", limits);
  return image ? "" : image.error().text();
}
void expect_says(const std::string& said, const std::string& part) {
  EXPECT_NE(said.find(part), std::string::npos) << "said: '" << said << "', wanted: " << part;
}

TEST(Image, EveryKindOfPngAsItsSamplesSay) {
  const std::vector<std::uint16_t> six{0, 50, 100, 150, 200, 255};
  for (const bool interlaced : {false, true}) {
    const Image grey = read(png(3, 2, 8, PNG_COLOR_TYPE_GRAY, six, interlaced));
    EXPECT_EQ(grey.width, 3);
    EXPECT_EQ(grey.height, 2);
    EXPECT_EQ(grey.channels, 1);
    EXPECT_EQ(grey.bits, 8);
    EXPECT_EQ(grey.data, six);
    EXPECT_EQ(grey.at(2, 1, 0), 255);
    const std::vector<std::uint16_t> deep{1, 256, 65535, 32768};
    const Image grey16 = read(png(2, 2, 16, PNG_COLOR_TYPE_GRAY, deep, interlaced));
    EXPECT_EQ(grey16.bits, 16);
    EXPECT_EQ(grey16.data, deep);
  }
  const Image colour = read(png(2, 1, 8, PNG_COLOR_TYPE_RGB, six));
  EXPECT_EQ(colour.channels, 3);
  EXPECT_EQ(colour.at(1, 0, 2), 255);
  const Image with_alpha = read(png(1, 1, 16, PNG_COLOR_TYPE_RGB_ALPHA, {1000, 2000, 3000, 4000}));
  EXPECT_EQ(with_alpha.channels, 4);
  EXPECT_EQ(with_alpha.data, (std::vector<std::uint16_t>{1000, 2000, 3000, 4000}));
  const Image palette = read(png(2, 1, 1, PNG_COLOR_TYPE_PALETTE, {1, 0}));
  EXPECT_EQ(palette.data, (std::vector<std::uint16_t>{200, 100, 0, 10, 20, 30}));
  const Image four_bits = read(png(2, 1, 4, PNG_COLOR_TYPE_GRAY, {15, 5}));
  EXPECT_EQ(four_bits.data, (std::vector<std::uint16_t>{255, 85}));  // 5 of 15
}

TEST(Image, JpegGreyAndColour) {
  // One value all over survives: only the mean of a block is not zero, at quality 100 it is stored to 1/8.
  const Image grey = read(jpeg(20, 10, 1, std::vector<JSAMPLE>(200, 77)));
  EXPECT_EQ(grey.channels, 1);
  EXPECT_EQ(grey.data, std::vector<std::uint16_t>(200, 77));
  std::vector<JSAMPLE> red;
  for (int i = 0; i < 64; ++i) red.insert(red.end(), {200, 30, 40});
  const Image colour = read(jpeg(8, 8, 3, red));
  ASSERT_EQ(colour.channels, 3);
  // Colours become luminance and two differences, each rounded: two steps of the result at most.
  EXPECT_NEAR(colour.at(4, 4, 0), 200, 2);
  EXPECT_NEAR(colour.at(4, 4, 1), 30, 2);
  EXPECT_NEAR(colour.at(4, 4, 2), 40, 2);
}

TEST(Image, WhatIsWrittenIsRead) {
  for (const int channels : {1, 2, 3, 4}) {
    constexpr int width = 37, height = 11;
    std::vector<std::uint8_t> pixels;
    std::vector<std::uint16_t> deep;
    for (int i = 0; i < width * height * channels; ++i) {
      pixels.push_back(static_cast<std::uint8_t>(i * 89));
      deep.push_back(static_cast<std::uint16_t>(i * 7919));
    }
    const Image image = parse_image(png_of(Pixels8{width, height, channels, pixels}), "a.png").value();
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.height, height);
    EXPECT_EQ(image.channels, channels);
    EXPECT_EQ(image.data, std::vector<std::uint16_t>(pixels.begin(), pixels.end()));
    const Image fine = parse_image(png_of(Pixels16{width, height, channels, deep}), "b.png").value();
    EXPECT_EQ(fine.bits, 16);
    EXPECT_EQ(fine.data, deep);
  }
  // A smooth picture survives JPEG within a few grey levels; the better, the closer.
  std::vector<std::uint8_t> smooth;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      for (const int c : {x * 3, y * 4, 255 - x * 2 - y}) smooth.push_back(static_cast<std::uint8_t>(c));
  const std::string small = jpeg_of({64, 48, 3, smooth}, 50), large = jpeg_of({64, 48, 3, smooth}, 98);
  EXPECT_LT(small.size(), large.size());
  const Image back = parse_image(large, "c.jpg").value();
  ASSERT_EQ(back.data.size(), smooth.size());
  for (std::size_t i = 0; i < smooth.size(); ++i) ASSERT_NEAR(back.data[i], smooth[i], 6) << i;
}

TEST(Image, CutOffOrDamagedIsOneError) {
  std::vector<std::uint16_t> noise;
  std::vector<JSAMPLE> noise8;
  std::uint32_t random = 1;
  for (int i = 0; i < 64 * 64; ++i) {
    random = random * 1664525u + 1013904223u;
    noise.push_back(static_cast<std::uint16_t>(random >> 16));
    noise8.push_back(static_cast<JSAMPLE>(random >> 24));
  }
  for (const std::string& whole : {png(64, 64, 16, PNG_COLOR_TYPE_GRAY, noise), jpeg(64, 64, 1, noise8)}) {
    ASSERT_EQ(complaint(whole), "");
    for (std::size_t k = 0; k < 20; ++k) {
      SCOPED_TRACE(k);
      EXPECT_NE(complaint(whole.substr(0, whole.size() * k / 20)), "");
    }
  }
  std::string flipped = png(64, 64, 16, PNG_COLOR_TYPE_GRAY, noise);
  flipped[flipped.size() / 2] ^= 4;  // the check sum of the block tells
  expect_says(complaint(flipped), "a.png: is damaged");
}

TEST(Image, SizesAreJudgedBeforeAnythingIsDecoded) {
  std::string bomb = png(2, 2, 8, PNG_COLOR_TYPE_GRAY, {1, 2, 3, 4});
  bomb[16] = bomb[20] = 0x7F;  // 2 billion pixels each way
  expect_says(complaint(bomb), "is too large: 2130706434 x 2130706434 pixels, at most 8192 x 8192");
  expect_says(
      complaint(png(5, 2, 8, PNG_COLOR_TYPE_GRAY, std::vector<std::uint16_t>(10, 0)), {.max_side = 4}),
      "too large");
  expect_says(complaint(jpeg(5, 2, 1, std::vector<JSAMPLE>(10, 0)), {.max_side = 4}), "too large");
  expect_says(complaint("GIF89a"), "neither a PNG nor a JPEG");
  expect_says(complaint(""), "is empty");
}

TEST(Heightmap, UpperRowsAreToTheLeftOfTheRobotThatLooksAlongX) {
  // 3 x 2 pixels over 4 m x 1 m x 5 m: the brightest pixel, 250, is 5 m high.
  const Image image = read(png(3, 2, 8, PNG_COLOR_TYPE_GRAY, {0, 50, 100, 150, 200, 250}));
  Diagnostics diagnostics;
  const auto grid = heightmap_of(image, "a.png", {4, 1, 5}, {0, 0, -2}, diagnostics);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->columns, 3);
  EXPECT_EQ(grid->rows, 2);
  EXPECT_NEAR(height_at(*grid, -2, 0.5), -2, 1e-6);  // upper left pixel
  EXPECT_NEAR(height_at(*grid, 0, 0.5), -1, 1e-6);   // 50 / 250 * 5 - 2
  EXPECT_NEAR(height_at(*grid, 2, 0.5), 0, 1e-6);
  EXPECT_NEAR(height_at(*grid, -2, -0.5), 1, 1e-6);  // lower left
  EXPECT_NEAR(height_at(*grid, 2, -0.5), 3, 1e-6);   // lower right
  EXPECT_NEAR(height_at(*grid, -2, 0), -0.5, 1e-6);  // half way along the left edge
  EXPECT_TRUE(diagnostics.warnings.empty());
}

TEST(Heightmap, SixteenBitsAndColoursAndNothing) {
  Diagnostics diagnostics;
  const auto deep = heightmap_of(read(png(2, 2, 16, PNG_COLOR_TYPE_GRAY, {0, 1, 20000, 10000})), "a.png",
                                 {1, 1, 2}, {}, diagnostics);
  ASSERT_TRUE(deep);
  EXPECT_NEAR(deep->at(1, 1), 2.0 / 20000, 1e-9);  // one step of 16 bits is there
  EXPECT_NEAR(deep->at(1, 0), 1, 1e-7);
  // Of colours, red.
  const auto colour = heightmap_of(
      read(png(2, 2, 8, PNG_COLOR_TYPE_RGB, {9, 1, 1, 0, 9, 9, 0, 9, 9, 3, 0, 0})), "a.png", {1, 1, 9}, {},
      diagnostics);
  ASSERT_TRUE(colour);
  EXPECT_EQ(colour->height_m, (std::vector<float>{0, 3, 9, 0}));
  const auto black = heightmap_of(read(png(2, 2, 8, PNG_COLOR_TYPE_GRAY, {0, 0, 0, 0})), "a.png", {1, 1, 9},
                                  {}, diagnostics);
  ASSERT_TRUE(black);
  EXPECT_EQ(black->height_m, (std::vector<float>{0, 0, 0, 0}));
}

TEST(Heightmap, WhatIsRefused) {
  Diagnostics diagnostics;
  const Image image = read(png(2, 2, 8, PNG_COLOR_TYPE_GRAY, {1, 2, 3, 4}));
  for (const Vec3 size : {Vec3{0, 1, 1}, Vec3{1, -1, 1}, Vec3{1, 1, -1}, Vec3{NAN, 1, 1}, Vec3{1, 1, 1e9}})
    EXPECT_FALSE(heightmap_of(image, "a.png", size, {}, diagnostics));
  EXPECT_TRUE(heightmap_of(image, "a.png", {1, 1, 0}, {}, diagnostics));
  EXPECT_FALSE(heightmap_of(read(png(1, 4, 8, PNG_COLOR_TYPE_GRAY, {1, 2, 3, 4})), "a.png", {1, 1, 1}, {},
                            diagnostics));
  EXPECT_TRUE(diagnostics.warnings.empty());
  EXPECT_TRUE(heightmap_of(image, "a.png", {1, 1, 1}, {3, 0, 0}, diagnostics));
  ASSERT_EQ(diagnostics.warnings.size(), 1u);
  expect_says(diagnostics.warnings[0].text(), "use the pose");
  const auto elevation = read_heightmap("/nowhere/alps.TIF", {1, 1, 1}, {}, diagnostics);
  ASSERT_FALSE(elevation);
  expect_says(elevation.error().text(), "gdal_translate -of PNG");
  const auto missing = read_heightmap("/nowhere/alps.png", {1, 1, 1}, {}, diagnostics);
  ASSERT_FALSE(missing);
  expect_says(missing.error().text(), "/nowhere/alps.png: no such file");
}

TEST(Heightmap, TheLargestTerrain) {
  std::vector<std::uint16_t> samples(std::size_t{4097} * 2, 7);
  const auto path = std::filesystem::path(testing::TempDir()) / "sandlot_wide.png";
  Diagnostics diagnostics;
  std::ofstream(path, std::ios::binary) << png(4097, 2, 8, PNG_COLOR_TYPE_GRAY, samples);
  const auto grid = read_heightmap(path.string(), {100, 1, 1}, {}, diagnostics);
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->columns, 4097);
  EXPECT_DOUBLE_EQ(grid->cell_x_m(), 100.0 / 4096);
  samples.assign(std::size_t{4098} * 2, 7);
  std::ofstream(path, std::ios::binary) << png(4098, 2, 8, PNG_COLOR_TYPE_GRAY, samples);
  const auto wider = read_heightmap(path.string(), {100, 1, 1}, {}, diagnostics);
  std::filesystem::remove(path);
  ASSERT_FALSE(wider);
  expect_says(wider.error().text(), "4098 x 2 pixels, at most 4097 x 4097");
}

}  // namespace
}  // namespace sandlot::assets
