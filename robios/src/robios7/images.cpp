#include "../images.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <vector>

#include "../functions.h"

using namespace robios;

extern "C" {
#pragma GCC visibility push(default)
int CAMWIDTH = QVGA_X, CAMHEIGHT = QVGA_Y, CAMPIXELS = QVGA_PIXELS, CAMSIZE = QVGA_SIZE, CAMMODE = QVGA;
int IP_WIDTH = QVGA_X, IP_HEIGHT = QVGA_Y, IP_PIXELS = QVGA_PIXELS, IP_SIZE = QVGA_SIZE, IP_MODE = QVGA;
#pragma GCC visibility pop
}

namespace {

constexpr int widths[] = {QQVGA_X, QVGA_X, VGA_X, CAM1MP_X, CAMHD_X, CAM5MP_X};
constexpr int heights[] = {QQVGA_Y, QVGA_Y, VGA_Y, CAM1MP_Y, CAMHD_Y, CAM5MP_Y};
int camera_size = QVGA,
    ip_size = QVGA;  // programs may write into the variables above: they decide nothing here

bool is_size(int size) { return size >= QQVGA && size <= CAM5MP; }
int camera_width() { return widths[camera_size]; }
int camera_height() { return heights[camera_size]; }
int ip_width() { return widths[ip_size]; }
int ip_height() { return heights[ip_size]; }
std::size_t ip_pixels() {
  return static_cast<std::size_t>(ip_width()) * static_cast<std::size_t>(ip_height());
}

void use_size(int size) {
  ip_size = size;
  IP_MODE = size;
  IP_WIDTH = widths[size];
  IP_HEIGHT = heights[size];
  IP_PIXELS = IP_WIDTH * IP_HEIGHT;
  IP_SIZE = IP_PIXELS * 3;
}

struct Closer {
  void operator()(FILE* file) const { fclose(file); }
};
using File = std::unique_ptr<FILE, Closer>;

/// Next number of a PNM header, after spaces and comments; -1: there is none.
int header_number(FILE* file) {
  int c = fgetc(file);
  while (c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '#') {
    if (c == '#') {
      while (c != '\n' && c != EOF) c = fgetc(file);
    }
    c = fgetc(file);
  }
  int value = -1;
  for (; c >= '0' && c <= '9'; c = fgetc(file)) {
    if (value > 1'000'000) return -1;
    value = std::max(value, 0) * 10 + (c - '0');
  }
  return value;  // with the one character behind it
}

/// Pixels of a PNM file of kind 1 to 6 into `to`, cut or filled with 0 to the size of the IP functions; false: it ends too early.
bool read_pixels(FILE* file, int kind, int width, int height, int most, BYTE* to) {
  const std::size_t channels = kind == 3 || kind == 6 ? 3 : 1;
  std::fill_n(to, ip_pixels() * channels, BYTE{0});
  int byte = 0;
  for (int y = 0; y < height && y < ip_height(); y++) {
    for (int x = 0; x < width; x++) {
      for (std::size_t c = 0; c < channels; c++) {
        int value = 0;
        if (kind == 1) {
          do value = fgetc(file);
          while (value != '0' && value != '1' && value != EOF);
          if (value != EOF) value = '1' - value;  // 1 is black in the file
        } else if (kind == 4) {
          if (x % 8 == 0) byte = fgetc(file);
          value = byte == EOF ? EOF : 1 - (byte >> (7 - x % 8) & 1);
        } else {
          value = kind >= 5 ? fgetc(file) : header_number(file);
          if (value >= 0) value = std::min(value, most) * 255 / most;
        }
        if (value < 0) return false;
        if (x < ip_width())
          to[(static_cast<std::size_t>(y) * static_cast<std::size_t>(ip_width()) +
              static_cast<std::size_t>(x)) *
                 channels +
             c] = static_cast<BYTE>(value);
      }
    }
  }
  return true;
}

int write_file(const char* name, const BYTE* image, char kind, std::size_t bytes) {
  if (!name || !image) return failed;
  const File file(fopen(name, "wb"));
  if (!file) return failed;
  fprintf(file.get(), "P%c\n%d %d\n255\n", kind, ip_width(), ip_height());
  return fwrite(image, 1, bytes, file.get()) == bytes ? ok : failed;
}

bool any(const BYTE* p) { return p[0] || p[1] || p[2]; }

}  // namespace

extern "C" {

int CAMInit(int resolution) {
  enter(Call::CAMInit);
  if (!is_size(resolution) || !machine.robot().has_camera) {
    if (!machine.robot().has_camera)
      note_once("camera", "the program takes a picture, and the robot has no camera");
    if (is_size(resolution)) use_size(resolution);
    return failed;
  }
  camera_on = true;
  camera_size = CAMMODE = resolution;
  use_size(resolution);
  CAMWIDTH = IP_WIDTH, CAMHEIGHT = IP_HEIGHT, CAMPIXELS = IP_PIXELS, CAMSIZE = IP_SIZE;
  LCDImageSize(resolution);
  return ok;
}
int CAMGet(BYTE* rgb) {
  enter(Call::CAMGet);
  if (!rgb || !take_picture()) return failed;
  copy_picture(rgb, camera_width(), camera_height());
  return ok;
}
int CAMGetGray(BYTE* gray) {
  enter(Call::CAMGetGray);
  if (!gray || !take_picture()) return failed;
  const auto pixels = static_cast<std::size_t>(camera_width()) * static_cast<std::size_t>(camera_height());
  std::vector<BYTE> rgb(pixels * 3);
  copy_picture(rgb.data(), camera_width(), camera_height());
  images::gray(rgb.data(), gray, pixels);
  return ok;
}

int IPSetSize(int resolution) {
  enter(Call::IPSetSize);
  if (!is_size(resolution)) return failed;
  use_size(resolution);
  return ok;
}
int IPReadFile(const char* name, BYTE* image) {
  enter(Call::IPReadFile);
  if (!name || !image) return -1;
  const File file(fopen(name, "rb"));
  if (!file || fgetc(file.get()) != 'P') return -1;
  const int kind = fgetc(file.get()) - '0';
  if (kind < 1 || kind > 6) return -1;
  const int width = header_number(file.get()), height = header_number(file.get());
  const bool bits = kind == 1 || kind == 4;
  const int most = bits ? 1 : header_number(file.get());
  if (width < 1 || height < 1 || most < 1 || most > 255) return -1;
  if (!read_pixels(file.get(), kind, width, height, most, image)) return -1;
  return bits ? 1 : kind == 3 || kind == 6 ? 3 : 2;
}
int IPWriteFile(const char* name, BYTE* rgb) {
  enter(Call::IPWriteFile);
  return write_file(name, rgb, '6', ip_pixels() * 3);
}
int IPWriteFileGray(const char* name, BYTE* gray) {
  enter(Call::IPWriteFileGray);
  return write_file(name, gray, '5', ip_pixels());
}

void IPLaplace(BYTE* gray_in, BYTE* gray_out) {
  enter(Call::IPLaplace);
  images::laplace(gray_in, gray_out, ip_width(), ip_height());
}
void IPSobel(BYTE* gray_in, BYTE* gray_out) {
  enter(Call::IPSobel);
  images::sobel(gray_in, gray_out, ip_width(), ip_height());
}
void IPCol2Gray(BYTE* rgb, BYTE* gray) {
  enter(Call::IPCol2Gray);
  images::gray(rgb, gray, ip_pixels());
}
void IPGray2Col(BYTE* gray, BYTE* rgb) {
  enter(Call::IPGray2Col);
  for (std::size_t i = ip_pixels(); i-- > 0;) rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = gray[i];
}
void IPRGB2Col(BYTE* r, BYTE* g, BYTE* b, BYTE* rgb) {
  enter(Call::IPRGB2Col);
  for (std::size_t i = 0; i < ip_pixels(); i++)
    rgb[3 * i] = r[i], rgb[3 * i + 1] = g[i], rgb[3 * i + 2] = b[i];
}
void IPCol2HSI(BYTE* rgb, BYTE* h, BYTE* s, BYTE* i) {
  enter(Call::IPCol2HSI);
  for (std::size_t at = 0; at < ip_pixels(); at++) {
    const images::Hsi value = images::hsi(rgb[3 * at], rgb[3 * at + 1], rgb[3 * at + 2]);
    h[at] = value.hue, s[at] = value.saturation, i[at] = value.intensity;
  }
}
void IPOverlay(BYTE* below, BYTE* above, BYTE* rgb) {
  enter(Call::IPOverlay);
  for (std::size_t i = 0; i < ip_pixels() * 3; i += 3) {
    const BYTE* from = any(above + i) ? above + i : below + i;
    const BYTE r = from[0], g = from[1], b = from[2];
    rgb[i] = r, rgb[i + 1] = g, rgb[i + 2] = b;
  }
}
void IPOverlayGray(BYTE* below, BYTE* above, COLOR color, BYTE* rgb) {
  enter(Call::IPOverlayGray);
  const Color c = color_of(color);
  for (std::size_t i = 0; i < ip_pixels(); i++) {
    const Color p = above[i] ? c : Color{below[i], below[i], below[i]};
    rgb[3 * i] = p.r, rgb[3 * i + 1] = p.g, rgb[3 * i + 2] = p.b;
  }
}

COLOR IPPRGB2Col(BYTE r, BYTE g, BYTE b) {
  enter(Call::IPPRGB2Col);
  return rgb_of({r, g, b});
}
void IPPCol2RGB(COLOR color, BYTE* r, BYTE* g, BYTE* b) {
  enter(Call::IPPCol2RGB);
  const Color c = color_of(color);
  *r = c.r, *g = c.g, *b = c.b;
}
void IPPCol2HSI(COLOR color, BYTE* h, BYTE* s, BYTE* i) {
  enter(Call::IPPCol2HSI);
  const Color c = color_of(color);
  const images::Hsi value = images::hsi(c.r, c.g, c.b);
  *h = value.hue, *s = value.saturation, *i = value.intensity;
}
BYTE IPPRGB2Hue(BYTE r, BYTE g, BYTE b) {
  enter(Call::IPPRGB2Hue);
  return images::hsi(r, g, b).hue;
}
void IPPRGB2HSI(BYTE r, BYTE g, BYTE b, BYTE* h, BYTE* s, BYTE* i) {
  enter(Call::IPPRGB2HSI);
  const images::Hsi value = images::hsi(r, g, b);
  *h = value.hue, *s = value.saturation, *i = value.intensity;
}

}  // extern "C"
