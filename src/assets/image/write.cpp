#include "assets/image/write.h"

#include <png.h>

#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>
// libjpeg's header needs FILE first.
#include <jpeglib.h>

#include "base/check.h"
#include "files/text.h"

namespace sandlot::assets {
namespace {

// Both libraries leave by longjmp or exit where they find an error. With the preconditions checked only memory can
// run out, and that ends the program anyway.
[[noreturn]] void on_png_error(png_structp, png_const_charp message) {
  SL_CHECK_MSG(false, message);
  std::abort();
}
void on_png_warning(png_structp, png_const_charp) {}
void on_png_write(png_structp png, png_bytep bytes, png_size_t count) {
  static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), count);
}
void on_png_flush(png_structp) {}

[[noreturn]] void on_jpeg_error(j_common_ptr jpeg) {
  char text[JMSG_LENGTH_MAX] = {};
  jpeg->err->format_message(jpeg, text);
  SL_CHECK_MSG(false, text);
  std::abort();
}

std::string png_bytes(int width, int height, int channels, int bits, const void* data) {
  constexpr int types[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                           PNG_COLOR_TYPE_RGB_ALPHA};
  SL_CHECK(channels >= 1 && channels <= 4);
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, on_png_error, on_png_warning);
  SL_CHECK_MSG(png, "libpng does not start");
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(png, &out, on_png_write, on_png_flush);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits,
               types[channels - 1], PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, 1);
  png_set_filter(png, 0, PNG_FILTER_SUB | PNG_FILTER_UP);
  png_write_info(png, info);
  if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  const auto stride = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels * bits / 8);
  for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y)
    png_write_row(png, static_cast<const png_byte*>(data) + y * stride);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return out;
}

template <class Pixels>
void check_size(const Pixels& p) {
  SL_CHECK(p.width > 0 && p.height > 0 && p.channels > 0);
  SL_CHECK(p.data.size() == static_cast<std::size_t>(p.width) * static_cast<std::size_t>(p.height) *
                                static_cast<std::size_t>(p.channels));
}

Status save(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) return Error{"cannot be written", "check the folder and the space on the disk", place_in(path)};
  return {};
}

}  // namespace

std::string png_of(const Pixels8& p) {
  check_size(p);
  return png_bytes(p.width, p.height, p.channels, 8, p.data.data());
}
std::string png_of(const Pixels16& p) {
  check_size(p);
  return png_bytes(p.width, p.height, p.channels, 16, p.data.data());
}

std::string jpeg_of(const Pixels8& p, int quality) {
  check_size(p);
  SL_CHECK(p.channels == 1 || p.channels == 3);
  SL_CHECK(p.width <= 65500 && p.height <= 65500 && quality >= 1 && quality <= 100);
  jpeg_error_mgr errors{};
  jpeg_compress_struct jpeg{};
  jpeg.err = jpeg_std_error(&errors);
  errors.error_exit = on_jpeg_error;
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<JDIMENSION>(p.width);
  jpeg.image_height = static_cast<JDIMENSION>(p.height);
  jpeg.input_components = p.channels;
  jpeg.in_color_space = p.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg.dct_method = JDCT_ISLOW;  // the same bits with and without vector instructions
  if (p.channels == 3 && quality >= 90) jpeg.comp_info[0].h_samp_factor = jpeg.comp_info[0].v_samp_factor = 1;
  jpeg_start_compress(&jpeg, TRUE);
  const auto stride = static_cast<std::size_t>(p.width) * static_cast<std::size_t>(p.channels);
  std::vector<JSAMPLE> row(stride);
  for (std::size_t y = 0; y < static_cast<std::size_t>(p.height); ++y) {
    row.assign(p.data.begin() + static_cast<std::ptrdiff_t>(y * stride),
               p.data.begin() + static_cast<std::ptrdiff_t>((y + 1) * stride));
    JSAMPROW rows = row.data();
    jpeg_write_scanlines(&jpeg, &rows, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string out(reinterpret_cast<const char*>(bytes), size);
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return out;
}

Status write_png(const std::string& path, const Pixels8& p) { return save(path, png_of(p)); }
Status write_png(const std::string& path, const Pixels16& p) { return save(path, png_of(p)); }
Status write_jpeg(const std::string& path, const Pixels8& p, int quality) {
  return save(path, jpeg_of(p, quality));
}

}  // namespace sandlot::assets
