#include <cstdarg>
#include <cstdio>
#include <string>

#include "api.h"

using namespace robios;

namespace {

constexpr int width = 128, height = 64, menu_height = 8;
constexpr Color white{255, 255, 255}, black{0, 0, 0};

void pixel(int x, int y, int value) {
  const bool is_black = screen.pixel(x, y) == black;
  screen.set_pixel(x, y, value == 0 || (value == 2 && is_black) ? white : black);
}

/// Values of pixels: 0, 1, 2; others are an error.
bool is_value(int value) { return value >= 0 && value <= 2; }

int show_number(const char* pattern, int value) {
  char text[40];
  std::snprintf(text, sizeof(text), pattern, value);
  screen.print(text);
  return ok;
}

std::string padded(std::string text, int spaces) {
  const auto wanted = static_cast<std::size_t>(spaces < 0 ? 0 : spaces > 64 ? 64 : spaces);
  return text.size() < wanted ? std::string(wanted - text.size(), ' ') + text : text;
}

std::string decimal(float value, int decimals) {
  char text[128];
  std::snprintf(text, sizeof(text), "%.*f",
                decimals < 0    ? 0
                : decimals > 20 ? 20
                                : decimals,
                static_cast<double>(value));
  return text;
}

/// Inner 80 x 54 pixels of a picture with a border.
template <class Value>
void show(Value value) {
  for (int y = 0; y < 54; y++) {
    for (int x = 0; x < 80; x++) screen.set_pixel(x, y, value(y + 1, x + 1) < 128 ? black : white);
  }
}

void menu(int position, const char* label) {
  const std::string text = label ? label : "";
  if (text != " ") screen.set_menu(position, text.substr(0, 4), black, white);
}

}  // namespace

namespace robios {

void begin_screen() {
  screen.font = {8, 8, 1, 1, false};
  screen.ink_color = black;
  screen.paper_color = white;
  screen.resize(width, height, menu_height, white);
}

}  // namespace robios

extern "C" {

int LCDPutChar(char character) {
  enter(Call::LCDPutChar);
  screen.put(character);
  return ok;
}
int LCDSetChar(int row, int column, char character) {
  enter(Call::LCDSetChar);
  if (!go_to(row, column)) return failed;
  screen.put(character);
  return ok;
}
int LCDPutString(const char* text) {
  enter(Call::LCDPutString);
  if (!text) return failed;
  screen.print(std::string_view(text).substr(0, 4096));
  return ok;
}
int LCDSetString(int row, int column, const char* text) {
  enter(Call::LCDSetString);
  if (!text || !go_to(row, column)) return failed;
  screen.print(std::string_view(text).substr(0, 4096));
  return ok;
}
int LCDPutHex(int value) {
  enter(Call::LCDPutHex);
  return show_number("%08X", value);
}
int LCDPutHex1(int value) {
  enter(Call::LCDPutHex1);
  return show_number("%02X", value & 255);
}
int LCDPutInt(int value) {
  enter(Call::LCDPutInt);
  return show_number("%d", value);
}
int LCDPutIntS(int value, int spaces) {
  enter(Call::LCDPutIntS);
  screen.print(padded(std::to_string(value), spaces));
  return ok;
}
int LCDPutFloat(float value) {
  enter(Call::LCDPutFloat);
  screen.print(decimal(value, 2));
  return ok;
}
int LCDPutFloatS(float value, int spaces, int decimals) {
  enter(Call::LCDPutFloatS);
  screen.print(padded(decimal(value, decimals), spaces));
  return ok;
}
int LCDMode(int mode) {
  enter(Call::LCDMode);
  if (mode & SCROLLING) screen.scrolling = true;
  if (mode & NOSCROLLING) screen.scrolling = false;
  return ok;
}
int LCDPutGraphic(image* buffer) {
  enter(Call::LCDPutGraphic);
  if (!buffer) return failed;
  show([&](int y, int x) { return (*buffer)[y][x]; });
  return ok;
}
int LCDPutColorGraphic(colimage* buffer) {
  enter(Call::LCDPutColorGraphic);
  if (!buffer) return failed;
  show([&](int y, int x) {
    const BYTE* p = (*buffer)[y][x];
    return (p[0] + p[1] + p[2]) / 3;
  });
  return ok;
}
int LCDPutImage(BYTE* buffer) {
  enter(Call::LCDPutImage);
  if (!buffer) return failed;
  for (int y = 0; y < height; y++) {
    for (int x = 0; x < width; x++) pixel(x, y, buffer[y * (width / 8) + x / 8] >> (7 - x % 8) & 1);
  }
  return ok;
}
int LCDMenu(const char* key1, const char* key2, const char* key3, const char* key4) {
  enter(Call::LCDMenu);
  menu(0, key1);
  menu(1, key2);
  menu(2, key3);
  menu(3, key4);
  return ok;
}
int LCDMenuI(int position, const char* label) {
  enter(Call::LCDMenuI);
  if (position < 1 || position > 4) return failed;
  menu(position - 1, label);
  return ok;
}
int LCDSetPixel(int row, int column, int value) {
  enter(Call::LCDSetPixel);
  if (!is_value(value) || row < 0 || column < 0 || row >= height || column >= width) return failed;
  pixel(column, row, value);
  return ok;
}
int LCDInvertPixel(int row, int column) {
  enter(Call::LCDInvertPixel);
  if (row < 0 || column < 0 || row >= height || column >= width) return failed;
  pixel(column, row, 2);
  return ok;
}
int LCDGetPixel(int row, int column) {
  enter(Call::LCDGetPixel);
  if (row < 0 || column < 0 || row >= height || column >= width) return 0;
  return screen.pixel(column, row) == black ? 1 : 0;
}
int LCDLine(int x1, int y1, int x2, int y2, int color) {
  enter(Call::LCDLine);
  if (!is_value(color)) return failed;
  if (color == 2) {
    screen.invert_line(x1, y1, x2, y2);
  } else {
    screen.line(x1, y1, x2, y2, color == 0 ? white : black);
  }
  return ok;
}
int LCDArea(int x1, int y1, int x2, int y2, int color) {
  enter(Call::LCDArea);
  if (!is_value(color)) return failed;
  if (color == 2) {
    screen.invert_area(x1, y1, x2, y2);
  } else {
    screen.area(x1, y1, x2, y2, color == 0 ? white : black, true);
  }
  return ok;
}

}  // extern "C"
