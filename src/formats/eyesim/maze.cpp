/// Mazes drawn with characters: `_` and `|` are walls, letters are starts and things.
#include <algorithm>
#include <string>

#include "base/math.h"
#include "base/text.h"
#include "files/text.h"
#include "formats/eyesim/lines.h"
#include "formats/eyesim/plan.h"

namespace sandlot::formats::eyesim {
namespace {

/// With posts there are twice as many of both.
constexpr std::size_t most_rows = 1000, most_columns = 2001;
/// With posts it is that of the rules of micromouse contests.
constexpr double usual_cell_mm = 360, usual_posts_mm = 180;

/// Direction of a start, or nothing: up, down, left, right.
std::optional<double> direction_of(char c) {
  switch (c) {
    case 's':
    case 'S':
    case 'u':
    case 'U': return math::pi / 2;
    case 'd':
    case 'D': return -math::pi / 2;
    case 'l':
    case 'L': return math::pi;
    case 'r':
    case 'R': return 0.0;
    default: return std::nullopt;
  }
}

struct Row {
  std::string_view text;
  int line = 0;
};

std::string_view without_return(std::string_view text) {
  while (!text.empty() && (text.back() == '\r' || text.back() == ' ' || text.back() == '\t'))
    text.remove_suffix(1);
  return text;
}

/// Whether a row is drawn with posts, as collections of micromouse mazes are: o---o   o.
bool has_posts(std::string_view row) {
  if (row.size() < 5 || (row.front() != 'o' && row.front() != '+')) return false;
  const std::string_view between = row.substr(1, 3);
  return row[4] == row.front() && (between == "---" || between == "   ");
}

/// Rows with posts as rows without: the walls of a row of posts stand below the cells above it.
Result<std::vector<std::string>> without_posts(const std::vector<Row>& rows,
                                               const std::shared_ptr<const std::string>& name) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    const std::string_view posts = rows[i].text;
    if (!has_posts(posts))
      return Error{"this line is not a row of posts", "rows of posts and of cells take turns: o---o, |   |",
                   place_in(name, rows[i].line)};
    const std::string_view cells = i == 0 ? std::string_view() : rows[i - 1].text;
    std::string row((std::max(posts.size(), cells.size()) + 3) / 4 * 2 + 1, ' ');
    for (std::size_t c = 0; 4 * c < row.size() * 2; ++c) {
      if (4 * c < cells.size() && cells[4 * c] == '|') row[2 * c] = '|';
      const bool floor = 4 * c + 2 < posts.size() && posts[4 * c + 2] == '-';
      const char letter = 4 * c + 2 < cells.size() ? cells[4 * c + 2] : ' ';
      if (2 * c + 1 >= row.size()) continue;
      if (floor) row[2 * c + 1] = '_';
      // Of its letters a start has a meaning here; G is where the mouse should go.
      if (letter == 'S' || letter == 's') row[2 * c + 1] = floor ? 'S' : 's';
    }
    while (row.size() > 1 && row.back() == ' ') row.pop_back();
    out.push_back(std::move(row));
  }
  return out;
}

/// Whether cells are drawn three characters wide, a wall and two of floor: walls in every third column, and not in every second.
bool is_wide(const std::vector<Row>& rows) {
  bool elsewhere = false;
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.text.size(); ++i) {
      if (row.text[i] != '|') continue;
      if (i % 3 != 0) return false;
      elsewhere = elsewhere || i % 2 == 1;
    }
  return elsewhere;
}

/// Such a row with cells of two characters: of the floor's two the letter, if there is one.
std::string narrowed(std::string_view row) {
  std::string out;
  for (std::size_t i = 0; i < row.size(); i += 3) {
    out += row[i] == '|' ? '|' : ' ';
    char floor = ' ';
    for (std::size_t k = i + 1; k < std::min(i + 3, row.size()); ++k)
      if (row[k] != ' ' && row[k] != '_') floor = row[k];
      else if (floor == ' ') floor = row[k];
    out += floor;
  }
  while (out.size() > 1 && out.back() == ' ') out.pop_back();
  return out;
}

}  // namespace

Result<Plan> read_maze(std::string_view text, const std::string& file, Diagnostics& diagnostics) {
  SL_TRY(check_text(text, file));
  const auto name = std::make_shared<const std::string>(file);
  std::optional<double> given_m;
  std::vector<Row> rows;
  int number = 0;
  for (const std::string_view each : split(text, '\n')) {
    ++number;
    const std::string_view row = without_return(each);
    if (row.empty() || row.front() == '#' || row.front() == ';') continue;
    const Place place = place_in(name, number);
    double size_mm = 0;
    if (parse_number(row, size_mm)) {
      if (!(size_mm >= 1 && size_mm <= 1e5))
        return Error{"the cells of a maze are 1 to 1e5 mm wide", "", place};
      given_m = size_mm * mm;
      continue;
    }
    if (row.front() != ' ' && row.front() != '|' && row.front() != '_' && !has_posts(row)) {
      diagnostics.warn(
          {"this line is not a row of a maze and left out", "rows begin with a blank or with |", place});
      continue;
    }
    if (row.size() > 2 * most_columns || rows.size() >= 2 * most_rows + 1)
      return Error{"a maze has at most 1000 rows of 1000 cells", "", place};
    rows.push_back({row, number});
  }
  if (rows.empty()) return Error{"there is no row of a maze", "draw it with | and _", place_in(name)};

  const double cell_m = given_m.value_or((has_posts(rows.front().text) ? usual_posts_mm : usual_cell_mm) *
                                         mm);
  std::vector<std::string> redrawn;
  if (has_posts(rows.front().text)) {
    SL_ASSIGN(redrawn, without_posts(rows, name));
    for (std::size_t i = 0; i < redrawn.size(); ++i) rows[i] = {redrawn[i], rows[2 * i].line};
    rows.resize(redrawn.size());
  } else if (is_wide(rows)) {
    for (const Row& row : rows) redrawn.push_back(narrowed(row.text));
    for (std::size_t i = 0; i < redrawn.size(); ++i) rows[i].text = redrawn[i];
  }
  Plan plan;
  std::size_t columns = 0;
  for (const Row& row : rows) columns = std::max(columns, row.text.size() / 2);
  const auto at = [&](std::size_t row, std::size_t i) {
    return row < rows.size() && i < rows[row].text.size() ? rows[row].text[i] : ' ';
  };
  const auto base_m = [&](std::size_t row) { return static_cast<double>(rows.size() - 1 - row) * cell_m; };
  const auto x_m = [&](std::size_t i) { return static_cast<double>((i + 1) / 2) * cell_m; };
  // A capital letter stands on a wall of its own.
  const auto is_floor = [&](std::size_t row, std::size_t i) {
    const char c = at(row, i);
    return i % 2 == 1 && (c == '_' || (c >= 'A' && c <= 'Z'));
  };
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t i = 1; i < 2 * columns + 1; i += 2) {
      if (!is_floor(row, i) || (i >= 2 && is_floor(row, i - 2))) continue;
      std::size_t last = i;
      while (is_floor(row, last + 2)) last += 2;
      plan.walls.push_back({.x1_m = x_m(i) - cell_m,
                            .y1_m = base_m(row),
                            .x2_m = x_m(last),
                            .y2_m = base_m(row),
                            .place = place_in(name, rows[row].line)});
    }
  for (std::size_t i = 0; i < 2 * columns + 1; i += 2)
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (at(row, i) != '|' || (row > 0 && at(row - 1, i) == '|')) continue;
      std::size_t last = row;
      while (at(last + 1, i) == '|') ++last;
      plan.walls.push_back({.x1_m = x_m(i),
                            .y1_m = base_m(last),
                            .x2_m = x_m(i),
                            .y2_m = base_m(row) + cell_m,
                            .place = place_in(name, rows[row].line)});
    }
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (std::size_t i = 0; i < rows[row].text.size(); ++i) {
      const char c = at(row, i);
      const Place place = place_in(name, rows[row].line, static_cast<int>(i) + 1);
      if (c == ' ' || c == '_' || c == '|') {
        if (c == '|' && i % 2 == 1)
          diagnostics.warn(
              {"'|' stands where no cell ends", "it belongs into odd columns, counted from 1", place});
        continue;
      }
      Spot spot{x_m(i) - cell_m / 2, base_m(row) + cell_m / 2, 0, place};
      if (const auto yaw = direction_of(c)) {
        spot.yaw_rad = *yaw;
        plan.starts.push_back(spot);
      } else if (c == 'o' || c == 'O') {
        plan.balls.push_back(spot);
      } else if (c == 'x' || c == 'X') {
        plan.boxes.push_back(spot);
      } else if (c != '.' && c != 'f' && c != 'F') {  // the goal of some mazes
        diagnostics.warn({std::string("'") + c + "' is not known in a maze and left out",
                          "known are | _ and the letters s u d l r o x", place});
      }
    }
  plan.width_m = static_cast<double>(columns) * cell_m;
  // The first row is the top wall alone.
  const bool has_top_row = rows.front().text.find('|') == std::string_view::npos;
  plan.height_m = static_cast<double>(rows.size() - (has_top_row ? 1 : 0)) * cell_m;
  if (plan.height_m == 0) plan.height_m = cell_m;
  return plan;
}

}  // namespace sandlot::formats::eyesim
