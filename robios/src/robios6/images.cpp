#include "../images.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "api.h"

using namespace robios;

namespace {

constexpr int width = 80, height = 60;
constexpr std::size_t pixels = 80 * 60;
int kept_brightness = 128, kept_hue = 128, kept_saturation = 128;

using Picture = std::vector<BYTE>;

/// New colour picture of 80 x 60; empty: there is none.
Picture picture() {
  if (!camera_on || !take_picture()) return {};
  Picture rgb(pixels * 3);
  copy_picture(rgb.data(), width, height);
  return rgb;
}

BYTE gray_of(const BYTE* rgb) { return static_cast<BYTE>((rgb[0] + rgb[1] + rgb[2]) / 3); }

BYTE* flat(image* i) { return &(*i)[0][0]; }
constexpr std::size_t image_pixels = sizeof(image);

}  // namespace

extern "C" {

int CAMInit(int mode) {
  enter(Call::CAMInit);
  if (mode != NORMAL && mode != WIDE && mode != TELE) return INITERROR;
  if (!machine.robot().has_camera) {
    note_once("camera", "the program takes a picture, and the robot has no camera");
    return NOINIT;
  }
  camera_on = true;
  return 17;  // a colour camera
}
int CAMGetFrame(image* buffer) {
  enter(Call::CAMGetFrame);
  const Picture rgb = buffer ? picture() : Picture{};
  if (rgb.empty()) return failed;
  std::memset(buffer, 0, sizeof(image));
  for (std::size_t y = 0; y < height; y++) {
    for (std::size_t x = 0; x < width; x++) (*buffer)[y + 1][x + 1] = gray_of(&rgb[(y * width + x) * 3]);
  }
  return ok;
}
int CAMGetColFrame(colimage* buffer, int convert) {
  enter(Call::CAMGetColFrame);
  const Picture rgb = buffer ? picture() : Picture{};
  if (rgb.empty()) return failed;
  // Converted pictures are grey ones, `image`: programs hand their buffer over with a cast.
  if (convert) {
    auto* const gray = reinterpret_cast<image*>(buffer);
    std::memset(gray, 0, sizeof(image));
    for (std::size_t y = 0; y < height; y++) {
      for (std::size_t x = 0; x < width; x++) (*gray)[y + 1][x + 1] = gray_of(&rgb[(y * width + x) * 3]);
    }
    return ok;
  }
  std::memset(buffer, 0, sizeof(colimage));
  for (std::size_t y = 0; y < height; y++) std::memcpy((*buffer)[y + 1][1], &rgb[y * width * 3], width * 3);
  return ok;
}
int CAMGetFrameMono(BYTE* buffer) {
  enter(Call::CAMGetFrameMono);
  const Picture rgb = buffer ? picture() : Picture{};
  if (rgb.empty()) return failed;
  images::gray(rgb.data(), buffer, pixels);
  return ok;
}
int CAMGetFrameRGB(BYTE* buffer) {
  enter(Call::CAMGetFrameRGB);
  const Picture rgb = buffer ? picture() : Picture{};
  if (rgb.empty()) return failed;
  std::copy(rgb.begin(), rgb.end(), buffer);
  return ok;
}
int CAMGetFrameBayer(BYTE* buffer) {
  enter(Call::CAMGetFrameBayer);
  const Picture rgb = buffer ? picture() : Picture{};
  if (rgb.empty()) return failed;
  for (std::size_t y = 0; y < height; y++) {
    for (std::size_t x = 0; x < width; x++) {
      const std::size_t channel = (x + y) % 2 == 0 ? 1 : y % 2 == 0 ? 0 : 2;
      buffer[y * width + x] = rgb[(y * width + x) * 3 + channel];
    }
  }
  return ok;
}
int CAMSet(int brightness, int hue, int saturation) {
  enter(Call::CAMSet);
  kept_brightness = brightness, kept_hue = hue, kept_saturation = saturation;
  return ok;
}
int CAMGet(int* brightness, int* hue, int* saturation) {
  enter(Call::CAMGet);
  set(brightness, kept_brightness);
  set(hue, kept_hue);
  set(saturation, kept_saturation);
  return ok;
}
int CAMMode(int mode) {
  enter(Call::CAMMode);
  return mode == AUTOBRIGHTNESS || mode == NOAUTOBRIGHTNESS ? ok : failed;
}

int IPLaplace(image* source, image* destination) {
  enter(Call::IPLaplace);
  images::laplace(flat(source), flat(destination), imagecolumns, imagerows);
  return ok;
}
int IPSobel(image* source, image* destination) {
  enter(Call::IPSobel);
  images::sobel(flat(source), flat(destination), imagecolumns, imagerows);
  return ok;
}
int IPDither(image* source, image* destination) {
  enter(Call::IPDither);
  constexpr int thresholds[2][2] = {{51, 153}, {204, 102}};
  for (std::size_t y = 0; y < imagerows; y++) {
    for (std::size_t x = 0; x < imagecolumns; x++)
      (*destination)[y][x] = (*source)[y][x] > thresholds[y % 2][x % 2] ? 255 : 0;
  }
  return ok;
}
int IPDiffer(image* current, image* last, image* destination) {
  enter(Call::IPDiffer);
  for (std::size_t i = 0; i < image_pixels; i++)
    flat(destination)[i] = static_cast<BYTE>(std::abs(flat(current)[i] - flat(last)[i]));
  return ok;
}
int IPColor2Grey(colimage* source, image* destination) {
  enter(Call::IPColor2Grey);
  images::gray(&(*source)[0][0][0], flat(destination), image_pixels);
  return ok;
}

}  // extern "C"
