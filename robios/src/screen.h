#pragma once
/// Screen of the robot: pixels, lines of text and labels of the keys, as the program has drawn them. What has changed is sent at
/// the end of the turn.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace robios {

inline constexpr int most_screen_side = 800;  ///< [px]; the largest order fits into the shared memory

struct Color {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Color&) const = default;
};
inline Color color_of(int rgb) {
  return {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8),
          static_cast<std::uint8_t>(rgb)};
}
inline int rgb_of(Color c) { return c.r << 16 | c.g << 8 | c.b; }

/// Place of one character: scaled glyphs in cells.
struct Font {
  int cell_width = 8, cell_height = 8, scale_x = 1, scale_y = 1;
  bool bold = false;
};

class Screen {
 public:
  void resize(int width, int height, int menu_height, Color background);
  int width() const { return width_; }
  int height() const { return height_; }
  int rows() const { return (height_ - menu_height_) / font.cell_height; }
  int columns() const { return width_ / font.cell_width; }

  Color pixel(int x, int y) const;
  void set_pixel(int x, int y, Color color);
  void line(int x1, int y1, int x2, int y2, Color color);
  void invert_line(int x1, int y1, int x2, int y2);
  void area(int x1, int y1, int x2, int y2, Color color, bool fill);
  void invert_area(int x1, int y1, int x2, int y2);
  void circle(int x, int y, int radius, Color color, bool fill);

  void clear();
  /// Characters from the cursor on; "\n" begins a line, "\f" clears, "\r" goes to the line's begin, "\b" back.
  void print(std::string_view text);
  void put(char character);
  void set_menu(int position, std::string_view label, Color ink, Color paper);
  /// Key under a place of the menu, from 1; 0: none.
  std::uint32_t menu_key(int x, int y) const;

  Font font;
  Color ink_color, paper_color;
  bool transparent = false, inverse = false, scrolling = true, line_feed = true;
  bool auto_refresh = true;
  int row = 0, column = 0;

  void refresh() { refresh_ = true; }
  void send();

 private:
  template <class Mark>
  void walk(int x1, int y1, int x2, int y2, Mark mark);
  void invert_pixel(int x, int y);
  void new_line();
  void scroll();
  void touch(int x1, int y1, int x2, int y2);
  void draw(char character, int x, int y, const Font& f, Color ink, Color paper, bool clear_background);
  void note_text(int r, int c, char character);

  int width_ = 0, height_ = 0, menu_height_ = 0;
  std::vector<Color> pixels_;
  std::vector<std::string> lines_;
  std::string menu_[4];
  bool text_changed_ = false, refresh_ = false;
  int dirty_x1_ = 0, dirty_y1_ = 0, dirty_x2_ = -1, dirty_y2_ = -1;
};
extern Screen& screen;  ///< made by make_screen(), never destroyed
void make_screen();

/// Of the generation: its size, colours and font.
void begin_screen();
void send_screen();

/// printf's result of at most 4096 characters.
std::string format(const char* pattern, __builtin_va_list arguments);

}  // namespace robios
