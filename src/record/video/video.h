#pragma once
/// Films from pictures, as players and editors read them: MP4, MOV or Matroska with H.264 (or MPEG-4 part 2 where libavcodec
/// has no x264), no sound.
///
///   SL_ASSIGN(auto film, VideoWriter::create({.file = "out.mp4", .width = 640, .height = 480, .rate_hz = 25}));
///   SL_TRY(film.add(rgb));   ... once per picture, at equal distances of time
///   SL_TRY(film.finish());
///
/// Colours  RGB as screens have it becomes BT.709, 8 bit, limited range, 4:2:0; constant quality (CRF 20).
/// Same     pictures give the same file with the same version of libav: one encoding thread, nothing of the time of day in it.
/// Errors   create(): an extension or size that cannot be, a file that cannot be written. add(), finish(): what the encoder or
///          the disk says, such as a full one.
/// Cost     about 10 ns per pixel; 40 pictures wait in the encoder (their size each).
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "base/result.h"

namespace sandlot {

struct VideoOptions {
  std::string file;           ///< .mp4, .mov or .mkv; replaced if it exists
  int width = 0, height = 0;  ///< even, 16 to 4096
  int rate_hz = 25;           ///< pictures per second of the film, 1 to 240
};

class VideoWriter {
 public:
  static Result<VideoWriter> create(const VideoOptions& options);
  /// What create() would refuse without touching the disk.
  static Status check(const VideoOptions& options);
  VideoWriter(VideoWriter&&) noexcept;
  VideoWriter& operator=(VideoWriter&&) noexcept;
  /// Leaves a film that finish() did not end as it is: most players refuse it.
  ~VideoWriter();

  /// @param rgb  width * height * 3 bytes, rows from the top. @pre no add() has failed
  Status add(std::span<const std::uint8_t> rgb);
  Status finish();

  std::uint64_t pictures() const;
  const char* codec() const;  ///< "libx264" or "mpeg4"

 private:
  struct Impl;
  explicit VideoWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace sandlot
