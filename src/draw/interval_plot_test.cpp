#include "draw/interval_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sandlot::draw {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(IntervalPlot, PutsValuesAndIntervalsAtTheirPlaces) {
  // A short label: the axis begins at 60 px and ends at 690 px, so that 0 to 100 % has 6.3 px per %.
  const std::string svg = draw_intervals({{"a", 50.0, 40.0, 70.0, 0}},
                                         {.title = "Rates", .x_label = "%", .range = {{0, 100}}, .mark = {}});
  EXPECT_THAT(svg, HasSubstr("<circle cx=\"375.0\" cy=\"57.0\""));
  EXPECT_THAT(svg, HasSubstr("M312.0 57.0H501.0"));
  EXPECT_THAT(svg, HasSubstr(">Rates</text>"));
}

TEST(IntervalPlot, WritesTextsAsTextAndLeavesRowsWithoutValueEmpty) {
  const std::string svg = draw_intervals({{"<b>", {}, {}, {}, 0}},
                                         {.title = "", .x_label = "", .range = {}, .mark = {}});
  EXPECT_THAT(svg, HasSubstr("&lt;b&gt;"));
  EXPECT_THAT(svg, Not(HasSubstr("<circle")));
}

TEST(IntervalPlot, TheAxisHoldsAllIntervalsAndTheMark) {
  const std::string svg = draw_intervals({{"a", 5.0, 4.0, 6.0, 1}},
                                         {.title = "", .x_label = "s", .range = {}, .mark = 0.0});
  // From 0 to 6 with a twentieth of room at each side: 0 lies at 60 + 630 * 0.3 / 6.6.
  EXPECT_THAT(svg, HasSubstr("<path d=\"M88.6 36V70\" stroke=\"#888888\"/>"));
}

}  // namespace
}  // namespace sandlot::draw
