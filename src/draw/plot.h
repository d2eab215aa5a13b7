#pragma once
/// Plot: columns of CSV files as lines over time or over another column, as an SVG figure for papers and
/// READMEs.
///
/// Axes have round ticks, a light grid and units where the columns have them (`rover.pose.x [m]`; `time` is
/// in seconds). Colours are Okabe and Ito's, which people who are colour-blind can tell apart; from the
/// eighth line on they are dashed. A cell that is empty, `nan` or `inf` breaks the line. Points that fall
/// into one pixel column are drawn as their first, last, lowest and highest, so that a file of a million
/// lines gives a small figure that looks the same.
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"

namespace sandlot::draw {

/// CSV file: a line of names, then numbers.
struct Table {
  std::string file;
  std::vector<std::string> names;            ///< without unit
  std::vector<std::string> units;            ///< "" when not given
  std::vector<std::vector<double>> columns;  ///< NaN where there is no number
};
/// Errors name file and line. Lines may end in CR LF; `#` begins a comment line.
Result<Table> read_csv(std::string_view text, const std::string& file);

struct PlotOptions {
  std::string x = "time";
  std::vector<std::string> y;  ///< empty: every column but x
  std::string title, x_label, y_label;
  std::vector<std::string> labels;  ///< of the lines in the legend, in order
  std::vector<std::string>
      colours;  ///< of the lines, in order: "red", "blue" or "#1f77b4"; the others get their own
  std::optional<std::pair<double, double>> x_range, y_range;
  /// A unit is as long on both axes, as a map needs it: the figure becomes higher or lower, and the shorter axis gets air.
  bool equal_scale = false;
  /// Straight line across the axes at a value to compare with; it counts for the range.
  struct Mark {
    bool vertical = false;  ///< at an x; else at a y
    double at = 0;
    std::string label;  ///< beside it, within the axes
  };
  std::vector<Mark> marks;
};
/// SVG of the figure; errors name the nearest column.
Result<std::string> draw_plot(const std::vector<Table>& tables, const PlotOptions& options);

/// Ticks at round numbers within [low, high], at most `most`, and their texts.
struct Ticks {
  std::vector<double> at;
  std::vector<std::string> text;
};
Ticks round_ticks(double low, double high, int most);

}  // namespace sandlot::draw
