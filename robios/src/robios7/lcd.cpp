#include <algorithm>
#include <array>
#include <cstdarg>

#include "../functions.h"

using namespace robios;

namespace {

constexpr int menu_height = 16;
// Of LCDImage: a picture has the size of its place.
int left = 0, top = 0, picture_width = QVGA_X, picture_height = QVGA_Y;

struct Size {
  int width, height;
};
constexpr std::array<Size, 6> sizes{{{QQVGA_X, QQVGA_Y},
                                     {QVGA_X, QVGA_Y},
                                     {VGA_X, VGA_Y},
                                     {CAM1MP_X, CAM1MP_Y},
                                     {CAMHD_X, CAMHD_Y},
                                     {CAM5MP_X, CAM5MP_Y}}};

/// Shows a picture in its place.
template <class At>
int show(const BYTE* picture, At at) {
  if (!picture) return failed;
  for (int y = 0; y < picture_height; y++) {
    for (int x = 0; x < picture_width; x++)
      screen.set_pixel(left + x, top + y,
                       at(static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_width) +
                          static_cast<std::size_t>(x)));
  }
  return ok;
}

}  // namespace

namespace robios {

void begin_screen() {
  const Robot& robot = machine.robot();
  const bool given = robot.screen_width > 0 && robot.screen_height > 0;
  const auto side = [](std::uint32_t size) {
    return static_cast<int>(std::min<std::uint32_t>(size, most_screen_side));
  };
  screen.font = {8, 16, 1, 2, false};
  screen.ink_color = color_of(WHITE);
  screen.paper_color = color_of(BLACK);
  screen.resize(given ? side(robot.screen_width) : 320, given ? side(robot.screen_height) : 480, menu_height,
                {});
}

}  // namespace robios

extern "C" {

int LCDSetColor(COLOR foreground, COLOR background) {
  enter(Call::LCDSetColor);
  screen.ink_color = color_of(foreground);
  screen.paper_color = color_of(background);
  return ok;
}

int LCDSetFont(int font, int variation) {
  enter(Call::LCDSetFont);
  if (font < HELVETICA || font > COURIER || variation < NORMAL || variation > ITALICS) return failed;
  screen.font.bold = variation == BOLD;
  return ok;
}

int LCDSetFontSize(int size) {
  enter(Call::LCDSetFontSize);
  const bool bold = screen.font.bold;
  switch (size) {
    case 8: screen.font = {6, 8, 1, 1, bold}; break;
    case 10: screen.font = {8, 10, 1, 1, bold}; break;
    case 12:
    case 14: screen.font = {8, 16, 1, 2, bold}; break;
    case 18: screen.font = {12, 18, 2, 2, bold}; break;
    case 24: screen.font = {18, 24, 3, 3, bold}; break;
    default: return failed;
  }
  screen.row = std::min(screen.row, screen.rows() - 1);
  return ok;
}

int LCDSetMode(int mode) {
  enter(Call::LCDSetMode);
  // The low byte has two meanings in the headers of RoBIOS-7: those of the screen are taken.
  if (mode & AUTOREFRESH) screen.auto_refresh = true;
  if (mode & NOAUTOREFRESH) screen.auto_refresh = false;
  if (mode & SCROLLING) screen.scrolling = true;
  if (mode & NOSCROLLING) screen.scrolling = false;
  if (mode & LINEFEED) screen.line_feed = true;
  if (mode & NOLINEFEED) screen.line_feed = false;
  return ok;
}

int LCDMenu(const char* key1, const char* key2, const char* key3, const char* key4) {
  enter(Call::LCDMenu);
  const char* const labels[4] = {key1, key2, key3, key4};
  for (int i = 0; i < 4; i++) {
    const std::string_view label = labels[i] ? labels[i] : "";
    if (label != " ") screen.set_menu(i, label, color_of(WHITE), color_of(BLACK));
  }
  return ok;
}

int LCDMenuI(int position, const char* label, COLOR foreground, COLOR background) {
  enter(Call::LCDMenuI);
  if (position < 1 || position > 4) return failed;
  screen.set_menu(position - 1, label ? label : "", color_of(foreground), color_of(background));
  return ok;
}

int LCDGetSize(int* width, int* height) {
  enter(Call::LCDGetSize);
  set(width, screen.width());
  set(height, screen.height());
  return ok;
}

int LCDPixel(int x, int y, COLOR color) {
  enter(Call::LCDPixel);
  if (x < 0 || y < 0 || x >= screen.width() || y >= screen.height()) return failed;
  screen.set_pixel(x, y, color_of(color));
  return ok;
}

COLOR LCDGetPixel(int x, int y) {
  enter(Call::LCDGetPixel);
  return rgb_of(screen.pixel(x, y));
}

int LCDLine(int x1, int y1, int x2, int y2, COLOR color) {
  enter(Call::LCDLine);
  screen.line(x1, y1, x2, y2, color_of(color));
  return ok;
}

int LCDArea(int x1, int y1, int x2, int y2, COLOR color, int fill) {
  enter(Call::LCDArea);
  screen.area(x1, y1, x2, y2, color_of(color), fill != 0);
  return ok;
}

int LCDCircle(int x, int y, int radius, COLOR color, int fill) {
  enter(Call::LCDCircle);
  if (radius < 0) return failed;
  screen.circle(x, y, radius, color_of(color), fill != 0);
  return ok;
}

int LCDImageSize(int type) {
  enter(Call::LCDImageSize);
  if (type < 0 || type >= static_cast<int>(sizes.size())) return failed;
  const Size size = sizes[static_cast<std::size_t>(type)];
  picture_width = size.width;
  picture_height = size.height;
  left = top = 0;
  return ok;
}

int LCDImageStart(int x, int y, int width, int height) {
  enter(Call::LCDImageStart);
  if (width <= 0 || height <= 0 || width > 4096 || height > 4096 || std::abs(x) > 4096 || std::abs(y) > 4096)
    return failed;
  left = x, top = y, picture_width = width, picture_height = height;
  return ok;
}

int LCDImage(BYTE* rgb) {
  enter(Call::LCDImage);
  return show(rgb, [&](std::size_t i) { return Color{rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}; });
}

int LCDImageGray(BYTE* gray) {
  enter(Call::LCDImageGray);
  return show(gray, [&](std::size_t i) { return Color{gray[i], gray[i], gray[i]}; });
}

int LCDImageBinary(BYTE* binary) {
  enter(Call::LCDImageBinary);
  return show(binary, [&](std::size_t i) { return color_of(binary[i] ? WHITE : BLACK); });
}

int LCDRefresh() {
  enter(Call::LCDRefresh);
  screen.refresh();
  return ok;
}

}  // extern "C"
