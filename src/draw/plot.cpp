#include "draw/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "base/text.h"
#include "draw/plan.h"

namespace sandlot::draw {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t most_lines = 24, most_columns = 10'000;

// Okabe and Ito, https://jfly.uni-koeln.de/color: blue, vermilion, green, purple, orange, sky, black.
constexpr const char* line_colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                        "#e69f00", "#56b4e9", "#000000"};
struct NamedColour {
  const char* name;
  const char* code;
};
constexpr NamedColour named_colours[] = {
    {"red", "#d00000"},   {"blue", "#0072b2"},   {"vermilion", "#d55e00"},
    {"green", "#009e73"}, {"purple", "#cc79a7"}, {"orange", "#e69f00"},
    {"sky", "#56b4e9"},   {"black", "#000000"},  {"grey", "#888888"}};
constexpr const char* dashes[] = {"", "7 4", "2 3", "9 3 2 3"};

/// The fields of one line; quotes as in RFC 4180, but no line breaks within them.
std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') out.back() += line[i++];
    else if (c == '"') quoted = !quoted;
    else if (c == ',' && !quoted) out.emplace_back();
    else out.back() += c;
  }
  return out;
}

/// About as wide as a sans-serif font of `size` px draws it.
double text_width(std::string_view text, double size) {
  std::size_t letters = 0;
  for (const char c : text) letters += (static_cast<unsigned char>(c) & 0xC0) != 0x80;  // UTF-8 continues
  return 0.56 * size * static_cast<double>(letters);
}

struct Line {
  std::string label, name, unit;
  std::string colour;  ///< "": by its place in the list
  const std::vector<double>* x;
  const std::vector<double>* y;
};

Result<std::size_t> column_of(const Table& table, std::string_view wanted) {
  const auto named = [&](std::size_t i) {
    return table.units[i].empty() ? table.names[i] : table.names[i] + " [" + table.units[i] + "]";
  };
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (wanted == table.names[i] || wanted == named(i)) return i;
  Place place;
  place.file = std::make_shared<const std::string>(table.file);
  return Error{"there is no column '" + std::string(wanted.substr(0, 100)) + "'",
               suggestion(wanted, table.names), place};
}

/// Code of a colour: "#d00000" for "red" and for "#d00000".
Result<std::string> colour_of(const std::string& wanted) {
  const bool code = wanted.size() == 7 && wanted[0] == '#' &&
                    wanted.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  if (code) return wanted;
  std::vector<std::string> names;
  for (const NamedColour& colour : named_colours) {
    if (wanted == colour.name) return std::string(colour.code);
    names.emplace_back(colour.name);
  }
  return Error{"there is no colour '" + wanted.substr(0, 40) + "'", suggestion(wanted, names)};
}

Result<std::vector<Line>> lines_of(const std::vector<Table>& tables, const PlotOptions& options) {
  std::vector<Line> lines;
  for (const Table& table : tables) {
    SL_ASSIGN(const std::size_t x, column_of(table, options.x));
    std::vector<std::size_t> chosen;
    for (const std::string& name : options.y) {
      const std::size_t before = chosen.size();
      if (name.find('*') != std::string::npos)
        for (std::size_t i = 0; i < table.names.size(); ++i)
          if (i != x && fits_pattern(table.names[i], name)) chosen.push_back(i);
      if (chosen.size() > before) continue;
      SL_ASSIGN(const std::size_t y, column_of(table, name));
      chosen.push_back(y);
    }
    if (options.y.empty())
      for (std::size_t i = 0; i < table.names.size(); ++i)
        if (i != x) chosen.push_back(i);
    for (const std::size_t y : chosen) {
      std::string label = table.names[y];
      if (tables.size() > 1) {
        const std::string stem = std::filesystem::path(table.file).stem().string();
        label = chosen.size() == 1 ? stem : stem + ": " + label;
      }
      lines.push_back({label, table.names[y], table.units[y], "", &table.columns[x], &table.columns[y]});
    }
  }
  if (lines.empty()) return Error{"there is no column to draw in addition to '" + options.x + "'"};
  if (lines.size() > most_lines)
    return Error{std::to_string(lines.size()) + " lines are too many for one figure",
                 "choose at most 24 by --y"};
  if (options.labels.size() > lines.size())
    return Error{"there are " + std::to_string(options.labels.size()) + " labels for " +
                 std::to_string(lines.size()) + " lines"};
  for (std::size_t i = 0; i < options.labels.size(); ++i) lines[i].label = options.labels[i];
  if (options.colours.size() > lines.size())
    return Error{"there are " + std::to_string(options.colours.size()) + " colours for " +
                 std::to_string(lines.size()) + " lines"};
  for (std::size_t i = 0; i < options.colours.size(); ++i) {
    SL_ASSIGN(lines[i].colour, colour_of(options.colours[i]));
  }
  return lines;
}

/// Range of the lines with a small margin.
std::pair<double, double> lines_range(const std::vector<Line>& lines, bool of_x,
                                      const std::optional<std::pair<double, double>>& given,
                                      const std::optional<std::pair<double, double>>& x_given) {
  if (given) return *given;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Line& line : lines)
    for (std::size_t i = 0; i < line.x->size(); ++i) {
      const double x = (*line.x)[i], y = (*line.y)[i];
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      if (!of_x && x_given && (x < x_given->first || x > x_given->second)) continue;
      low = std::min(low, of_x ? x : y);
      high = std::max(high, of_x ? x : y);
    }
  if (low > high) return {0, 1};
  const double least = std::max(1e-12, 1e-9 * std::max(std::abs(low), std::abs(high)));
  const double air = high / 2 - low / 2 < least / 2 ? std::max(0.5 * std::abs(low), 0.5)
                     : of_x                         ? 0
                                                    : 0.05 * (high - low);
  return {low - air, high + air};
}

/// `range` with the marks of its axis in it.
std::pair<double, double> with_marks(std::pair<double, double> range, bool of_x, const PlotOptions& options) {
  if (of_x ? options.x_range.has_value() : options.y_range.has_value()) return range;
  for (const PlotOptions::Mark& mark : options.marks) {
    if (mark.vertical != of_x) continue;
    const double air = 0.05 * (range.second - range.first);
    if (mark.at > range.second - air) range.second = mark.at + air;
    if (mark.at < range.first + air) range.first = mark.at - air;
  }
  return range;
}

struct Frame2 {
  double left, top, width, height;
  std::pair<double, double> x, y;
  double px(double value) const { return left + (value - x.first) / (x.second - x.first) * width; }
  double py(double value) const { return top + height - (value - y.first) / (y.second - y.first) * height; }
};

/// Widens one of the ranges so that a unit has the same length on both axes, or makes the frame higher.
void scale_equally(Frame2& frame) {
  constexpr double lowest = 240, highest = 640, air = 0.05;
  for (auto* const range : {&frame.x, &frame.y}) {
    const double more = air * (range->second - range->first);
    range->first -= more, range->second += more;
  }
  const auto length = [](const std::pair<double, double>& range) { return range.second - range.first; };
  const double wanted = frame.width * length(frame.y) / length(frame.x);
  frame.height = std::clamp(wanted, lowest, highest);
  const auto widen = [&](std::pair<double, double>& range, double to) {
    const double more = (to - length(range)) / 2;
    range.first -= more, range.second += more;
  };
  if (wanted > highest) widen(frame.x, length(frame.y) * frame.width / frame.height);
  else if (wanted < lowest) widen(frame.y, length(frame.x) * frame.height / frame.width);
}

/// The line's path data; points in one half pixel column are thinned to those that show.
std::string path_of(const Line& line, const Frame2& frame) {
  struct Point {
    double x, y;
  };
  std::string out;
  std::vector<Point> bucket;
  bool pen_down = false;
  const auto put = [&](Point p) {
    out += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", p.x, p.y);
    pen_down = true;
  };
  const auto empty_bucket = [&] {
    if (bucket.size() <= 4) {
      for (const Point& p : bucket) put(p);
    } else {
      std::size_t low = 0, high = 0;
      for (std::size_t i = 0; i < bucket.size(); ++i) {
        if (bucket[i].y < bucket[low].y) low = i;
        if (bucket[i].y > bucket[high].y) high = i;
      }
      std::size_t kept[] = {0, std::min(low, high), std::max(low, high), bucket.size() - 1};
      for (std::size_t k = 0; k < 4; ++k)
        if (k == 0 || kept[k] != kept[k - 1]) put(bucket[kept[k]]);
    }
    bucket.clear();
  };
  // Far outside of the frame is cut off there: the clip hides it, and drawing programs dislike 1e300.
  const auto near = [](double v) { return std::clamp(v, -20'000.0, 20'000.0); };
  for (std::size_t i = 0; i < line.x->size(); ++i) {
    const double x = (*line.x)[i], y = (*line.y)[i];
    if (!std::isfinite(x) || !std::isfinite(y)) {
      empty_bucket();
      pen_down = false;
      continue;
    }
    const Point p{near(frame.px(x)), near(frame.py(y))};
    if (!bucket.empty() && std::floor(2 * p.x) != std::floor(2 * bucket.front().x)) empty_bucket();
    bucket.push_back(p);
  }
  empty_bucket();
  return out;
}

std::string with_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

}  // namespace

Result<Table> read_csv(std::string_view text, const std::string& file) {
  Table table;
  table.file = file;
  Place place;
  place.file = std::make_shared<const std::string>(file);
  if (text.starts_with("\x89MCAP"))
    return Error{"this is a recording", "`sandlot topic export` makes a table of its numbers", place};
  if (text.substr(0, 4096).find('\0') != std::string_view::npos)
    return Error{"this is not a table", "expected lines of text: names, then numbers", place};
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = text.find('\n', at);
    if (end == std::string_view::npos) end = text.size();
    std::string_view line = text.substr(at, end - at);
    at = end + 1;
    ++place.line;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty() || line.front() == '#') continue;
    const std::vector<std::string> fields = fields_of(line);
    if (table.names.empty()) {
      if (fields.size() > most_columns) return Error{"there are more than 10000 columns", "", place};
      for (const std::string& field : fields) {
        const std::string_view name = trim(field);
        const std::size_t open = name.rfind(" [");
        const bool unit = !name.empty() && name.back() == ']' && open != std::string_view::npos;
        table.names.emplace_back(unit ? name.substr(0, open) : name);
        table.units.emplace_back(unit ? name.substr(open + 2, name.size() - open - 3) : "");
        if (table.names.back() == "time" && !unit) table.units.back() = "s";
      }
      table.columns.resize(fields.size());
      continue;
    }
    if (fields.size() != table.names.size())
      return Error{"the line has " + std::to_string(fields.size()) + " fields, the first one names " +
                       std::to_string(table.names.size()),
                   "was it cut short?", place};
    for (std::size_t i = 0; i < fields.size(); ++i) {
      double value = nan;
      if (!trim(fields[i]).empty() && !parse_number(fields[i], value))
        return Error{"'" + fields[i].substr(0, 40) + "' in column '" + table.names[i] + "' is not a number",
                     "", place};
      table.columns[i].push_back(value);
    }
  }
  place.line = 0;
  if (table.names.empty()) return Error{"the file is empty", "expected a line of names, then numbers", place};
  return table;
}

Ticks round_ticks(double low, double high, int most) {
  Ticks out;
  // The step is 1, 2 or 5 times a power of ten, found by going there: no logarithm, so no last bit to worry
  // about.
  double power = 1;
  int decimals = 0;
  while (power * most > high - low && decimals < 300) power /= 10, ++decimals;
  while (power * most * 10 <= high - low) power *= 10, --decimals;
  double step = power;
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    step = factor * power;
    if (std::floor(high / step + 1e-9) - std::ceil(low / step - 1e-9) < most) break;
  }
  if (step >= 10 * power) --decimals;
  for (double k = std::ceil(low / step - 1e-9); k <= std::floor(high / step + 1e-9); k += 1) {
    const double value = k == 0 ? 0 : k * step;
    out.at.push_back(value);
    const bool plain = decimals <= 6 && std::abs(value) < 1e7;
    out.text.push_back(plain ? fmt::format("{:.{}f}", value, std::max(decimals, 0))
                             : fmt::format("{:.6g}", value));
    if (out.at.size() > 100) break;
  }
  return out;
}

Result<std::string> draw_plot(const std::vector<Table>& tables, const PlotOptions& options) {
  SL_ASSIGN(std::vector<Line> lines, lines_of(tables, options));
  constexpr double width = 800, plot_height = 360, font = 15;
  Frame2 frame{0,
               0,
               0,
               plot_height,
               with_marks(lines_range(lines, true, options.x_range, {}), true, options),
               with_marks(lines_range(lines, false, options.y_range, options.x_range), false, options)};

  std::string y_label = options.y_label;
  if (y_label.empty()) {
    bool one_name = true, one_unit = true;
    for (const Line& line : lines) {
      one_name = one_name && line.name == lines.front().name;
      one_unit = one_unit && line.unit == lines.front().unit;
    }
    if (one_name) y_label = with_unit(lines.front().name, one_unit ? lines.front().unit : "");
    else if (one_unit && !lines.front().unit.empty()) y_label = "[" + lines.front().unit + "]";
    // Several lines: the legend has their names.
    for (std::size_t i = options.labels.size(); !one_unit && i < lines.size(); ++i)
      lines[i].label = with_unit(lines[i].label, lines[i].unit);
  }
  std::string x_label = options.x_label;
  if (x_label.empty()) {
    SL_ASSIGN(const std::size_t x, column_of(tables.front(), options.x));
    x_label = with_unit(tables.front().names[x], tables.front().units[x]);
  }

  if (options.equal_scale) {
    frame.width = width - 100;  // about what the labels leave
    scale_equally(frame);
  }
  const Ticks x_ticks = round_ticks(frame.x.first, frame.x.second, 9);
  const Ticks y_ticks = round_ticks(frame.y.first, frame.y.second, 7);
  double widest = 0;
  for (const std::string& text : y_ticks.text) widest = std::max(widest, text_width(text, font));
  frame.left = 18 + widest + (y_label.empty() ? 0 : font + 12);
  if (options.equal_scale) frame.height *= (width - frame.left - 24) / frame.width;
  frame.width = width - frame.left - 24;
  double y = 14;
  std::string body;
  const auto text = [&](double x, double at, const char* anchor, std::string_view content,
                        const char* more = "") {
    body += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, at, anchor,
                        more, xml_text(content));
  };
  if (!options.title.empty()) {
    y += 18;
    text(frame.left + frame.width / 2, y, "middle", options.title, " font-size=\"18\" font-weight=\"600\"");
    y += 8;
  }
  const auto style = [&](std::size_t i) {
    const std::string& own = lines[i].colour;
    const char* const dash = own.empty() ? dashes[i / std::size(line_colours) % std::size(dashes)] : "";
    return fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"2\" stroke-linejoin=\"round\"{}",
                       own.empty() ? line_colours[i % std::size(line_colours)] : own.c_str(),
                       *dash ? fmt::format(" stroke-dasharray=\"{}\"", dash) : "");
  };
  if (lines.size() > 1 || !options.labels.empty()) {
    // Above the axes, so that it never lies on the lines.
    double x = frame.left;
    y += font + 2;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double needed = 34 + text_width(lines[i].label, font) + 30;
      if (x > frame.left && x + needed > width) x = frame.left, y += font + 8;
      body += fmt::format("<path d=\"M{:.1f} {:.1f}h26\" {}/>\n", x, y - 5, style(i));
      text(x + 34, y, "start", lines[i].label);
      x += needed;
    }
    y += 6;
  }
  frame.top = y + 8;
  const double bottom = frame.top + frame.height, right = frame.left + frame.width;
  std::string grid;
  for (std::size_t i = 0; i < x_ticks.at.size(); ++i) {
    const double at = frame.px(x_ticks.at[i]);
    grid += fmt::format("M{:.1f} {:.1f}V{:.1f}", at, frame.top, bottom);
    text(at, bottom + font + 6, "middle", x_ticks.text[i]);
  }
  for (std::size_t i = 0; i < y_ticks.at.size(); ++i) {
    const double at = frame.py(y_ticks.at[i]);
    grid += fmt::format("M{:.1f} {:.1f}H{:.1f}", frame.left, at, right);
    text(frame.left - 8, at + 5, "end", y_ticks.text[i]);
  }
  text(frame.left + frame.width / 2, bottom + 2 * font + 14, "middle", x_label);
  if (!y_label.empty()) {
    const double x = 20, middle = frame.top + frame.height / 2;
    text(x, middle, "middle", y_label,
         fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", x, middle).c_str());
  }
  const double height = bottom + 2 * font + 28;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" font-size=\"{2:.0f}\" "
      "fill=\"#222222\">\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
      width, height, font);
  out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#e2e2e2\"/>\n", grid);
  out += fmt::format(
      "<clipPath id=\"axes\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" "
      "height=\"{:.1f}\"/></clipPath>\n",
      frame.left, frame.top, frame.width, frame.height);
  out += "<g clip-path=\"url(#axes)\">\n";
  for (std::size_t i = 0; i < lines.size(); ++i)
    out += fmt::format("<path d=\"{}\" {}/>\n", path_of(lines[i], frame), style(i));
  for (const PlotOptions::Mark& mark : options.marks) {
    const double px = frame.px(mark.at), py = frame.py(mark.at);
    out += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#444444\" stroke-dasharray=\"6 4\"/>\n",
                       mark.vertical ? fmt::format("M{:.1f} {:.1f}V{:.1f}", px, frame.top, bottom)
                                     : fmt::format("M{:.1f} {:.1f}H{:.1f}", frame.left, py, right));
    // A label stands left of a vertical line in the right half, below a level one at the upper edge.
    const bool left = mark.vertical && px > frame.left + frame.width / 2;
    const bool below = !mark.vertical && py < frame.top + 2 * font;
    text(mark.vertical ? px + (left ? -6 : 6) : frame.left + 6,
         mark.vertical ? bottom - 8 : py + (below ? font + 2 : -6), left ? "end" : "start", mark.label,
         " stroke=\"#ffffff\" stroke-width=\"4\" paint-order=\"stroke\"");
  }
  out += "</g>\n";
  out += fmt::format("<path d=\"M{0:.1f} {1:.1f}V{2:.1f}H{3:.1f}\" fill=\"none\" stroke=\"#444444\"/>\n",
                     frame.left, frame.top, bottom, right);
  return out + body + "</svg>\n";
}

}  // namespace sandlot::draw
