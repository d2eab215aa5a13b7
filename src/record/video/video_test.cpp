/// Films, read back by libav's own reader.
#include "record/video/video.h"

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <vector>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace sandlot {
namespace {

constexpr int width = 64, height = 48;

/// Left half red, right half blue, with a white bar that moves down by two rows per picture.
std::vector<std::uint8_t> picture(int number) {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool bar = y / 2 == number % (height / 2);
      rgb.push_back(bar || x < width / 2 ? 255 : 0);
      rgb.push_back(bar ? 255 : 0);
      rgb.push_back(bar || x >= width / 2 ? 255 : 0);
    }
  return rgb;
}

std::string file_in_temp(const char* name) { return testing::TempDir() + name; }

Status film(const std::string& file, int pictures) {
  SL_ASSIGN(VideoWriter writer,
            VideoWriter::create({.file = file, .width = width, .height = height, .rate_hz = 20}));
  for (int i = 0; i < pictures; ++i) SL_TRY(writer.add(picture(i)));
  return writer.finish();
}

struct Seen {
  int pictures = 0, width = 0, height = 0;
  double duration_s = 0;
  std::vector<double> times_s;
  /// [picture] Y, Cb, Cr in the middle of the left and of the right half
  std::vector<std::array<int, 6>> colours;
};

Seen look_at(const std::string& file) {
  Seen seen;
  AVFormatContext* format = nullptr;
  if (avformat_open_input(&format, file.c_str(), nullptr, nullptr) < 0) {
    ADD_FAILURE() << "no film";
    return seen;
  }
  EXPECT_GE(avformat_find_stream_info(format, nullptr), 0);
  EXPECT_EQ(format->nb_streams, 1u);
  seen.duration_s = static_cast<double>(format->duration) / AV_TIME_BASE;
  const AVStream& stream = *format->streams[0];
  AVCodecContext* decoder = avcodec_alloc_context3(avcodec_find_decoder(stream.codecpar->codec_id));
  avcodec_parameters_to_context(decoder, stream.codecpar);
  EXPECT_EQ(avcodec_open2(decoder, decoder->codec, nullptr), 0);
  seen.width = decoder->width;
  seen.height = decoder->height;
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  const auto take = [&] {
    while (avcodec_receive_frame(decoder, frame) == 0) {
      ++seen.pictures;
      seen.times_s.push_back(static_cast<double>(frame->pts) * av_q2d(stream.time_base));
      const auto at = [&](int plane, int x, int y) {
        return static_cast<int>(frame->data[plane][y * frame->linesize[plane] + x]);
      };
      std::array<int, 6> c{};
      for (int side = 0; side < 2; ++side) {
        const int x = 16 + 32 * side, y = 40;
        c[static_cast<std::size_t>(3 * side)] = at(0, x, y);
        c[static_cast<std::size_t>(3 * side + 1)] = at(1, x / 2, y / 2);
        c[static_cast<std::size_t>(3 * side + 2)] = at(2, x / 2, y / 2);
      }
      seen.colours.push_back(c);
    }
  };
  while (av_read_frame(format, packet) == 0) {
    avcodec_send_packet(decoder, packet);
    av_packet_unref(packet);
    take();
  }
  avcodec_send_packet(decoder, nullptr);
  take();
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&decoder);
  avformat_close_input(&format);
  return seen;
}

std::string bytes_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Video, HasThePicturesThatWerePutIn) {
  for (const char* name : {"a.mp4", "a.mkv", "a.mov"}) {
    SCOPED_TRACE(name);
    const std::string file = file_in_temp(name);
    const Status status = film(file, 50);
    ASSERT_TRUE(status) << status.error().text();
    const Seen seen = look_at(file);
    EXPECT_EQ(seen.pictures, 50);
    EXPECT_EQ(seen.width, width);
    EXPECT_EQ(seen.height, height);
    EXPECT_NEAR(seen.duration_s, 50 / 20.0, 0.001);
    for (std::size_t i = 0; i < seen.times_s.size(); ++i)
      EXPECT_NEAR(seen.times_s[i], static_cast<double>(i) / 20, 0.001);
    // BT.709, limited range: Y = 16 + 219 (0.2126 R + 0.7152 G + 0.0722 B), Cb = 128 + 224 (B - Y') / 1.8556, Cr = 128 + 224 (R - Y') /
    // 1.5748: red 63, 102, 240; blue 32, 240, 118. Within what the quantiser leaves. The bar is elsewhere in picture 3.
    const int expected[6] = {63, 102, 240, 32, 240, 118};
    for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(seen.colours.at(3)[k], expected[k], 4) << k;
    EXPECT_NEAR(seen.colours.at(20)[0], 235, 12) << "the bar crosses row 40 in picture 20";
    std::filesystem::remove(file);
  }
}

TEST(Video, TheSamePicturesAreTheSameFile) {
  const std::string a = file_in_temp("same_a.mp4"), b = file_in_temp("same_b.mp4");
  ASSERT_TRUE(film(a, 30));
  ASSERT_TRUE(film(b, 30));
  EXPECT_GT(bytes_of(a).size(), 500u);
  EXPECT_TRUE(bytes_of(a) == bytes_of(b));
  std::filesystem::remove(a);
  std::filesystem::remove(b);
}

TEST(Video, RefusesWhatCannotBe) {
  const auto said = [](VideoOptions options) {
    const auto writer = VideoWriter::create(options);
    return writer ? "" : writer.error().text();
  };
  const std::string good = file_in_temp("good.mp4");
  EXPECT_EQ(said({.file = good, .width = 641, .height = 480}),
            "a film cannot be 641x480 pixels large; give even numbers from 16 to 4096, such as 1280x720");
  EXPECT_NE(said({.file = good, .width = 100'000, .height = 100'000}), "");
  EXPECT_NE(said({.file = good, .width = 640, .height = 480, .rate_hz = 0}), "");
  EXPECT_FALSE(std::filesystem::exists(good));
  EXPECT_EQ(said({.file = "x.avi", .width = 640, .height = 480}),
            "a film cannot be written as 'x.avi'; call it .mp4, .mov or .mkv");
  EXPECT_EQ(said({.file = "no/such/folder/x.mp4", .width = 640, .height = 480}),
            "no/such/folder/x.mp4: the film cannot be written: No such file or directory; check the folder "
            "and the space "
            "on the disk");
}

TEST(Video, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  const std::string file = file_in_temp("full.mkv");
  std::filesystem::remove(file);
  std::filesystem::create_symlink("/dev/full", file);
  const Status status = film(file, 400);
  std::filesystem::remove(file);
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().text().find("No space left on device"), std::string::npos)
      << status.error().text();
}

}  // namespace
}  // namespace sandlot
