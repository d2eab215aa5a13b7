#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstring>

#include "assets/image/decoders.h"

namespace sandlot::assets::image {
namespace {

/// All that lives across libpng's longjmp is here, outside the function that it leaves.
struct PngJob {
  std::string_view bytes;
  const ImageLimits& limits;
  Image& out;
  std::size_t at = 0;
  std::string problem;
  png_structp png = nullptr;
  png_infop info = nullptr;
  png_uint_32 width = 0, height = 0;
  std::size_t row_bytes = 0;
  std::vector<png_byte> pixels;
  std::vector<png_bytep> rows;
};

void on_error(png_structp png, png_const_charp message) {
  auto* job = static_cast<PngJob*>(png_get_error_ptr(png));
  if (job->problem.empty()) job->problem = std::string("is damaged: ") + message;
  png_longjmp(png, 1);
}
void on_warning(png_structp, png_const_charp) {}
void on_read(png_structp png, png_bytep to, png_size_t count) {
  auto* job = static_cast<PngJob*>(png_get_io_ptr(png));
  if (job->bytes.size() - job->at < count) {
    job->problem = "ends too early";
    png_longjmp(png, 1);
  }
  std::memcpy(to, job->bytes.data() + job->at, count);
  job->at += count;
}

/// Up to the size; false when libpng gave up.
bool read_png_header(PngJob& job) {
  if (setjmp(png_jmpbuf(job.png))) return false;  // NOLINT(cert-err52-cpp): libpng knows no other way
  const auto side = static_cast<png_uint_32>(job.limits.max_side);
  png_set_user_limits(job.png, side, side);
  png_set_chunk_malloc_max(job.png, 4u << 20);
  png_set_chunk_cache_max(job.png, 64);
  // Text and profiles may be damaged or huge: they are not looked at.
  png_set_keep_unknown_chunks(job.png, PNG_HANDLE_CHUNK_NEVER, nullptr, 0);
  png_set_read_fn(job.png, &job, on_read);
  png_read_info(job.png, job.info);
  job.width = png_get_image_width(job.png, job.info);
  job.height = png_get_image_height(job.png, job.info);
  png_set_expand(job.png);  // palettes to colours, few bits to 8, transparency to a channel
  if constexpr (std::endian::native == std::endian::little) png_set_swap(job.png);
  png_set_interlace_handling(job.png);
  png_read_update_info(job.png, job.info);
  job.out.channels = png_get_channels(job.png, job.info);
  job.out.bits = png_get_bit_depth(job.png, job.info);
  job.row_bytes = png_get_rowbytes(job.png, job.info);
  return true;
}

bool read_png_pixels(PngJob& job) {
  if (setjmp(png_jmpbuf(job.png))) return false;  // NOLINT(cert-err52-cpp)
  png_read_image(job.png, job.rows.data());
  png_read_end(job.png, nullptr);
  return true;
}

}  // namespace

std::string decode_png(std::string_view bytes, const ImageLimits& limits, Image& out) {
  // The size stands in fixed places at the front: judged before libpng does anything.
  const auto number_at = [&](std::size_t at) {
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) n = n << 8 | static_cast<unsigned char>(bytes[at + i]);
    return n;
  };
  if (bytes.size() < 33) return "ends too early";
  if (std::string problem = judge_size(number_at(16), number_at(20), limits); !problem.empty())
    return problem;
  PngJob job{.bytes = bytes, .limits = limits, .out = out};
  job.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
  if (job.png) job.info = png_create_info_struct(job.png);
  if (!job.info) {
    png_destroy_read_struct(&job.png, &job.info, nullptr);
    return "cannot be read: libpng does not start";
  }
  bool good = read_png_header(job);
  if (good) {
    job.pixels.resize(job.row_bytes * job.height);
    for (png_uint_32 y = 0; y < job.height; ++y) job.rows.push_back(job.pixels.data() + y * job.row_bytes);
    good = read_png_pixels(job);
  }
  png_destroy_read_struct(&job.png, &job.info, nullptr);
  if (!good) return job.problem.empty() ? "is damaged" : job.problem;
  out.width = static_cast<int>(job.width);
  out.height = static_cast<int>(job.height);
  out.data.resize(std::size_t{job.width} * job.height * static_cast<std::size_t>(out.channels));
  if (out.bits == 16) std::memcpy(out.data.data(), job.pixels.data(), 2 * out.data.size());
  else out.data.assign(job.pixels.begin(), job.pixels.end());
  return "";
}

}  // namespace sandlot::assets::image
