#include "screen.h"

#include <algorithm>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "font.h"
#include "machine.h"

namespace robios {

namespace {
alignas(Screen) std::byte screen_place[sizeof(Screen)];
}
Screen& screen = reinterpret_cast<Screen&>(screen_place);
void make_screen() { new (screen_place) Screen; }

void send_screen() { screen.send(); }

std::string format(const char* pattern, __builtin_va_list arguments) {
  if (!pattern) return "(null)";
  char text[4097];
  const int size = vsnprintf(text, sizeof(text), pattern, arguments);
  return size < 0 ? "" : text;
}

void Screen::resize(int width, int height, int menu_height, Color background) {
  width_ = std::clamp(width, 32, most_screen_side);
  height_ = std::clamp(height, 32, most_screen_side);
  menu_height_ = menu_height;
  pixels_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), background);
  lines_.assign(static_cast<std::size_t>(rows()), "");
  if (background != Color{}) touch(0, 0, width_ - 1, height_ - 1);
}

std::uint32_t Screen::menu_key(int x, int y) const {
  if (x < 0 || y < height_ - menu_height_ || x >= width_ || y >= height_) return 0;
  return 1 + static_cast<std::uint32_t>(x * 4 / width_);
}

void Screen::touch(int x1, int y1, int x2, int y2) {
  if (dirty_x2_ < dirty_x1_) {
    dirty_x1_ = x1, dirty_y1_ = y1, dirty_x2_ = x2, dirty_y2_ = y2;
    return;
  }
  dirty_x1_ = std::min(dirty_x1_, x1), dirty_y1_ = std::min(dirty_y1_, y1);
  dirty_x2_ = std::max(dirty_x2_, x2), dirty_y2_ = std::max(dirty_y2_, y2);
}

Color Screen::pixel(int x, int y) const {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return {};
  return pixels_[static_cast<std::size_t>(y * width_ + x)];
}

void Screen::set_pixel(int x, int y, Color color) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  Color& p = pixels_[static_cast<std::size_t>(y * width_ + x)];
  if (p == color) return;
  p = color;
  touch(x, y, x, y);
}

/// Calls `mark` of each pixel of a line that is on the screen.
template <class Mark>
void Screen::walk(int x1, int y1, int x2, int y2, Mark mark) {
  // Far outside only the part near the screen is walked along.
  const std::int64_t dx = std::int64_t{x2} - x1, dy = std::int64_t{y2} - y1;
  const std::int64_t steps = std::max(std::llabs(dx), std::llabs(dy));
  if (steps == 0) {
    if (x1 >= 0 && y1 >= 0 && x1 < width_ && y1 < height_) mark(x1, y1);
    return;
  }
  double first = 0, last = static_cast<double>(steps);
  const auto cut = [&](double from, double by, double size) {
    if (by == 0) return;
    double a = (-1 - from) / by, b = (size - from) / by;
    if (a > b) std::swap(a, b);
    first = std::max(first, a);
    last = std::min(last, b);
  };
  cut(x1, static_cast<double>(dx) / static_cast<double>(steps), width_);
  cut(y1, static_cast<double>(dy) / static_cast<double>(steps), height_);
  const auto begin = static_cast<std::int64_t>(first);
  const auto end = std::min(static_cast<std::int64_t>(last + 1), steps);
  const auto at = [&](std::int64_t d, std::int64_t i) {  // d i / steps, rounded away from 0
    const auto product = static_cast<__int128>(d) * i * 2;
    const auto rounded = (product + (d < 0 ? -steps : steps)) / (2 * static_cast<__int128>(steps));
    return static_cast<std::int64_t>(rounded);
  };
  for (std::int64_t i = begin; i <= end; i++) {
    const std::int64_t x = x1 + at(dx, i), y = y1 + at(dy, i);
    if (x >= 0 && y >= 0 && x < width_ && y < height_) mark(static_cast<int>(x), static_cast<int>(y));
  }
}

void Screen::line(int x1, int y1, int x2, int y2, Color color) {
  walk(x1, y1, x2, y2, [&](int x, int y) { set_pixel(x, y, color); });
}

void Screen::invert_line(int x1, int y1, int x2, int y2) {
  walk(x1, y1, x2, y2, [&](int x, int y) { invert_pixel(x, y); });
}

void Screen::invert_pixel(int x, int y) {
  const auto inverse_of = [](std::uint8_t c) { return static_cast<std::uint8_t>(255 - c); };
  const Color c = pixel(x, y);
  set_pixel(x, y, {inverse_of(c.r), inverse_of(c.g), inverse_of(c.b)});
}

void Screen::invert_area(int x1, int y1, int x2, int y2) {
  for (int y = std::max(std::min(y1, y2), 0); y <= std::min(std::max(y1, y2), height_ - 1); y++) {
    for (int x = std::max(std::min(x1, x2), 0); x <= std::min(std::max(x1, x2), width_ - 1); x++)
      invert_pixel(x, y);
  }
}

void Screen::area(int x1, int y1, int x2, int y2, Color color, bool fill) {
  if (x1 > x2) std::swap(x1, x2);
  if (y1 > y2) std::swap(y1, y2);
  const int left = std::max(x1, 0), right = std::min(x2, width_ - 1);
  const int top = std::max(y1, 0), bottom = std::min(y2, height_ - 1);
  for (int y = top; y <= bottom; y++) {
    const bool whole = fill || y == y1 || y == y2;
    for (int x = left; x <= right; x++) {
      if (whole || x == x1 || x == x2) set_pixel(x, y, color);
    }
  }
}

void Screen::circle(int cx, int cy, int radius, Color color, bool fill) {
  if (radius < 0) return;
  // A pixel is inside if x^2 + y^2 <= r (r + 1), and of the edge if a neighbour along an axis is not.
  const std::int64_t r = radius, limit = r * (r + 1);
  const auto inside = [&](std::int64_t x, std::int64_t y) { return x * x + y * y <= limit; };
  for (int y = 0; y < height_; y++) {
    const std::int64_t dy = std::int64_t{y} - cy;
    if (std::llabs(dy) > r) continue;
    for (int x = 0; x < width_; x++) {
      const std::int64_t dx = std::int64_t{x} - cx;
      if (std::llabs(dx) > r || !inside(dx, dy)) continue;
      const bool edge = !inside(std::llabs(dx) + 1, dy) || !inside(dx, std::llabs(dy) + 1);
      if (fill || edge) set_pixel(x, y, color);
    }
  }
}

void Screen::clear() {
  area(0, 0, width_ - 1, height_ - 1, paper_color, true);
  lines_.assign(lines_.size(), "");
  for (std::string& label : menu_) label.clear();
  row = column = 0;
  text_changed_ = true;
}

void Screen::draw(char character, int left, int top, const Font& f, Color ink_c, Color paper,
                  bool background) {
  const int indent = (f.cell_width - glyph_width * f.scale_x) / 2;
  const int lower = (f.cell_height - glyph_height * f.scale_y) / 2;
  for (int y = 0; y < f.cell_height; y++) {
    for (int x = 0; x < f.cell_width; x++) {
      const int gx = x < indent ? -1 : (x - indent) / f.scale_x,
                gy = y < lower ? -1 : (y - lower) / f.scale_y;
      const bool on = character != ' ' &&
                      (robios::ink(character, gx, gy) ||
                       (f.bold && x > indent && robios::ink(character, (x - 1 - indent) / f.scale_x, gy)));
      if (on || background) set_pixel(left + x, top + y, on ? ink_c : paper);
    }
  }
}

void Screen::note_text(int r, int c, char character) {
  if (r < 0 || c < 0 || static_cast<std::size_t>(r) >= lines_.size() || c >= 400) return;
  std::string& text = lines_[static_cast<std::size_t>(r)];
  if (text.size() <= static_cast<std::size_t>(c)) {
    if (character == ' ') return;
    text.resize(static_cast<std::size_t>(c) + 1, ' ');
  }
  char& at = text[static_cast<std::size_t>(c)];
  if (at == character) return;
  at = character;
  text.erase(text.find_last_not_of(' ') + 1);
  text_changed_ = true;
}

void Screen::scroll() {
  const int step = font.cell_height, bottom = rows() * step;
  for (int y = 0; y < bottom - step; y++) {
    for (int x = 0; x < width_; x++) set_pixel(x, y, pixel(x, y + step));
  }
  area(0, bottom - step, width_ - 1, bottom - 1, paper_color, true);
  std::rotate(lines_.begin(), lines_.begin() + 1, lines_.end());
  lines_.back().clear();
  text_changed_ = true;
}

void Screen::new_line() {
  column = 0;
  if (++row < rows()) return;
  if (scrolling) {
    row = rows() - 1;
    scroll();
  } else {
    row = 0;
  }
}

void Screen::put(char character) {
  switch (character) {
    case '\n':
      if (line_feed) new_line();
      return;
    case '\r': column = 0; return;
    case '\f': return clear();
    case '\b': column = std::max(column - 1, 0); return;
    case '\t':
      do put(' ');
      while (column % 8 != 0);
      return;
    default: break;
  }
  if (static_cast<unsigned char>(character) < 32) return;
  if (column >= columns()) new_line();
  if (row >= rows()) row = rows() - 1;
  draw(character, column * font.cell_width, row * font.cell_height, font, inverse ? paper_color : ink_color,
       inverse ? ink_color : paper_color, !transparent);
  note_text(row, column, character);
  column++;
}

void Screen::print(std::string_view text) {
  for (const char c : text) put(c);
}

void Screen::set_menu(int position, std::string_view label, Color ink_c, Color paper) {
  if (position < 0 || position > 3) return;
  const Font f{8, menu_height_, 1, menu_height_ / 8, false};
  const int left = width_ * position / 4, right = width_ * (position + 1) / 4 - 1,
            top = height_ - menu_height_;
  area(left, top, right, height_ - 1, paper, true);
  const std::size_t most = static_cast<std::size_t>((right - left + 1) / f.cell_width);
  const std::string_view shown = label.substr(0, most);
  int x = left + (right - left + 1 - static_cast<int>(shown.size()) * f.cell_width) / 2;
  for (const char c : shown) {
    draw(c, x, top, f, ink_c, paper, true);
    x += f.cell_width;
  }
  menu_[position] = label.substr(0, 64);
  text_changed_ = true;
}

void Screen::send() {
  if (!machine.robot().has_screen) return;
  if (!auto_refresh && !refresh_) return;
  refresh_ = false;
  if (dirty_x2_ >= dirty_x1_) {
    const int w = dirty_x2_ - dirty_x1_ + 1, h = dirty_y2_ - dirty_y1_ + 1;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(w * h * 3));
    std::uint8_t* to = bytes.data();
    for (int y = dirty_y1_; y <= dirty_y2_; y++) {
      for (int x = dirty_x1_; x <= dirty_x2_; x++) {
        const Color c = pixel(x, y);
        *to++ = c.r, *to++ = c.g, *to++ = c.b;
      }
    }
    const ScreenOrder head{static_cast<std::uint32_t>(dirty_x1_), static_cast<std::uint32_t>(dirty_y1_),
                           static_cast<std::uint32_t>(w), static_cast<std::uint32_t>(h)};
    order_at_hand_over(OrderKind::screen, &head, sizeof(head), bytes.data(), bytes.size());
    dirty_x1_ = dirty_y1_ = 0, dirty_x2_ = dirty_y2_ = -1;
  }
  if (text_changed_) {
    std::string all;
    for (const std::string& label : menu_) (all += label) += '\0';
    for (const std::string& text : lines_) (all += text) += '\0';
    order_at_hand_over(OrderKind::text, all.data(), all.size());
    text_changed_ = false;
  }
}

}  // namespace robios
