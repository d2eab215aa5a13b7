#include "draw/interval_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "draw/plan.h"
#include "draw/plot.h"

namespace sandlot::draw {
namespace {

constexpr const char* colours[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                   "#e69f00", "#56b4e9", "#000000"};
constexpr double row_px = 26, top_px = 44, bottom_px = 48, right_px = 30, width_px = 720, size_px = 13;

double text_px(const std::string& text) { return 0.56 * size_px * static_cast<double>(text.size()); }

/// The range that holds all intervals, with a little room.
std::pair<double, double> range_of(const std::vector<IntervalRow>& rows, const IntervalPlotOptions& options) {
  if (options.range) return *options.range;
  double low = options.mark.value_or(1e300), high = options.mark.value_or(-1e300);
  for (const IntervalRow& row : rows) {
    if (!row.value) continue;
    for (const double x : {*row.value, row.low.value_or(*row.value), row.high.value_or(*row.value)}) {
      if (!std::isfinite(x)) continue;
      low = std::min(low, x), high = std::max(high, x);
    }
  }
  if (low > high) return {0, 1};
  const double room = high > low ? 0.05 * (high - low) : 1;
  return {low - room, high + room};
}

}  // namespace

std::string draw_intervals(const std::vector<IntervalRow>& rows, const IntervalPlotOptions& options) {
  double left = 60;
  for (const IntervalRow& row : rows) left = std::max(left, 24 + text_px(row.label));
  left = std::min(left, 0.6 * width_px);
  const std::pair<double, double> range = range_of(rows, options);
  const double low = range.first, high = range.second;
  const double height = top_px + row_px * static_cast<double>(rows.size()) + bottom_px;
  const double bottom = height - bottom_px;
  const auto x = [&](double value) {
    return left + std::clamp((value - low) / (high - low), 0.0, 1.0) * (width_px - left - right_px);
  };
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" "
      "font-family=\"sans-serif\" font-size=\"{2:.0f}\">\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"#ffffff\"/>\n"
      "<text x=\"{3:.0f}\" y=\"24\" font-weight=\"bold\">{4}</text>\n",
      width_px, height, size_px, left, xml_text(options.title));
  const Ticks ticks = round_ticks(low, high, 8);
  for (std::size_t i = 0; i < ticks.at.size(); ++i)
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.0f}V{2:.0f}\" stroke=\"#e4e4e4\"/><text x=\"{0:.1f}\" y=\"{3:.0f}\" "
        "text-anchor=\"middle\" fill=\"#444444\">{4}</text>\n",
        x(ticks.at[i]), top_px - 8, bottom, bottom + 18, xml_text(ticks.text[i]));
  if (options.mark)
    svg += fmt::format("<path d=\"M{:.1f} {:.0f}V{:.0f}\" stroke=\"#888888\"/>\n", x(*options.mark),
                       top_px - 8, bottom);
  svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.0f}\" text-anchor=\"middle\" fill=\"#444444\">{}</text>\n",
                     0.5 * (left + width_px - right_px), height - 8, xml_text(options.x_label));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const IntervalRow& row = rows[i];
    const double y = top_px + row_px * (static_cast<double>(i) + 0.5);
    svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", left - 10, y + 4,
                       xml_text(row.label));
    if (!row.value) continue;
    const char* const colour = colours[static_cast<std::size_t>(std::abs(row.colour)) % std::size(colours)];
    const double from = x(row.low.value_or(*row.value)), to = x(row.high.value_or(*row.value));
    svg += fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}H{2:.1f}M{0:.1f} {3:.1f}V{4:.1f}M{2:.1f} {3:.1f}V{4:.1f}\" stroke=\"{5}\" "
        "stroke-width=\"1.5\"/><circle cx=\"{6:.1f}\" cy=\"{1:.1f}\" r=\"4.5\" fill=\"{5}\"/>\n",
        from, y, to, y - 5, y + 5, colour, x(*row.value));
  }
  return svg + "</svg>\n";
}

}  // namespace sandlot::draw
