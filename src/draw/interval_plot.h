#pragma once
/// Interval plot: values with their confidence intervals, one under the other, as an SVG figure.
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sandlot::draw {

struct IntervalRow {
  std::string label;
  std::optional<double> value, low, high;  ///< without a value the row is empty
  int colour = 0;                          ///< number of the colour; rows of one kind share it
};

struct IntervalPlotOptions {
  std::string title, x_label;
  std::optional<std::pair<double, double>> range;  ///< of the axis; unset: what holds all intervals
  std::optional<double> mark;                      ///< a line across all rows, such as 0 of a difference
};

/// SVG of the figure.
std::string draw_intervals(const std::vector<IntervalRow>& rows, const IntervalPlotOptions& options);

}  // namespace sandlot::draw
