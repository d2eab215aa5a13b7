#include "draw/plot.h"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

namespace sandlot::draw {
namespace {

Table table(const std::string& text, const std::string& file = "run.csv") {
  auto read = read_csv(text, file);
  EXPECT_TRUE(read) << (read ? "" : read.error().text());
  return read ? std::move(*read) : Table{};
}
std::string complaint(const std::string& text) {
  const auto read = read_csv(text, "run.csv");
  return read ? "" : read.error().text();
}

TEST(Plot, ReadsWhatTheLogWrites) {
  const Table t = table("time,rover.pose.x [m],\"max(a, b)\"\r\n0,1.5,nan\n# a remark\n0.1,,-inf\n");
  EXPECT_EQ(t.names, (std::vector<std::string>{"time", "rover.pose.x", "max(a, b)"}));
  EXPECT_EQ(t.units, (std::vector<std::string>{"s", "m", ""}));
  EXPECT_EQ(t.columns[0], (std::vector<double>{0, 0.1}));
  EXPECT_EQ(t.columns[1][0], 1.5);
  EXPECT_TRUE(std::isnan(t.columns[1][1]));
  EXPECT_TRUE(std::isinf(t.columns[2][1]));
}

TEST(Plot, BadFilesAreNamedWithTheirLine) {
  EXPECT_NE(complaint("").find("run.csv: the file is empty"), std::string::npos) << complaint("");
  EXPECT_NE(complaint("a,b\n1,2\n3\n").find("run.csv:3: the line has 1 fields"), std::string::npos);
  EXPECT_NE(complaint("a,b\n1,x\n").find("run.csv:2: 'x' in column 'b' is not a number"), std::string::npos);
}

TEST(Plot, TicksAreRound) {
  const auto at = [](double low, double high, int most) { return round_ticks(low, high, most); };
  EXPECT_EQ(at(0, 10, 9).text, (std::vector<std::string>{"0", "2", "4", "6", "8", "10"}));
  EXPECT_EQ(at(-0.23, 0.31, 7).text, (std::vector<std::string>{"-0.2", "-0.1", "0.0", "0.1", "0.2", "0.3"}));
  EXPECT_EQ(at(0, 2500, 7).text, (std::vector<std::string>{"0", "500", "1000", "1500", "2000", "2500"}));
  EXPECT_EQ(at(3.1, 3.2, 7).text.front(), "3.10");
  for (const auto& [low, high] : {std::pair(1e-9, 3e-9), std::pair(-1e12, 1e12), std::pair(100.0, 100.001)}) {
    const Ticks ticks = at(low, high, 7);
    ASSERT_GE(ticks.at.size(), 3u);
    EXPECT_LE(ticks.at.size(), 7u);
    for (std::size_t i = 1; i < ticks.text.size(); ++i) EXPECT_NE(ticks.text[i], ticks.text[i - 1]);
  }
}

/// Points of the first data line.
std::vector<std::pair<double, double>> points(const std::string& svg) {
  std::vector<std::pair<double, double>> out;
  std::size_t at = svg.find("<path d=\"M", svg.find("<g clip-path")) + 9;
  const char* p = svg.c_str() + at;
  while (*p == 'M' || *p == 'L') {
    char* end = nullptr;
    const double x = std::strtod(p + 1, &end);
    const double y = std::strtod(end, &end);
    out.emplace_back(x, y);
    p = end;
  }
  return out;
}

TEST(Plot, PointsLieWhereTheAxesSay) {
  const auto svg = draw_plot({table("time,a [m]\n0,0\n5,2\n10,1\n")},
                             {.x_range = {{0, 10}}, .y_range = {{0, 2}}});
  ASSERT_TRUE(svg);
  const auto p = points(*svg);
  ASSERT_EQ(p.size(), 3u);
  EXPECT_NEAR(p[1].first, (p[0].first + p[2].first) / 2, 0.1);  // coordinates are rounded to 0.1
  EXPECT_NEAR(p[0].second - p[1].second, 360, 0.1);             // the height of the axes
  EXPECT_NEAR(p[2].second, (p[0].second + p[1].second) / 2, 0.1);
  EXPECT_NE(svg->find(">time [s]<"), std::string::npos);
  EXPECT_NE(svg->find(">a [m]<"), std::string::npos);
}

TEST(Plot, MapsHaveOneScale) {
  // 10 m by 2 m, and by 40 m: a metre is as long in both directions.
  for (const char* const rows : {"0,0\n10,0\n10,2\n", "0,0\n10,0\n10,40\n", "0,0\n10,0\n10,8\n"}) {
    const Table t = table(std::string("x,y\n") + rows);
    const auto svg = draw_plot({t}, {.x = "x", .equal_scale = true});
    ASSERT_TRUE(svg);
    const auto p = points(*svg);
    ASSERT_EQ(p.size(), 3u);
    const double across = (p[1].first - p[0].first) / 10;
    EXPECT_NEAR((p[1].second - p[2].second) / t.columns[1][2], across, 0.1) << rows;
    EXPECT_GT(across, 10);
  }
}

TEST(Plot, MarksLieWhereTheAxesSayAndCountForTheRange) {
  const Table t = table("time,a\n0,0\n10,1\n");
  const auto svg = draw_plot({t}, {.marks = {{false, 4, "limit <4>"}, {true, 5, "half"}}});
  ASSERT_TRUE(svg);
  EXPECT_NE(svg->find("limit &lt;4&gt;"), std::string::npos);
  const auto p = points(*svg);
  ASSERT_EQ(p.size(), 2u);
  std::size_t at = svg->find("#444444\" stroke-dasharray");
  ASSERT_NE(at, std::string::npos);
  const std::size_t level = svg->rfind("<path d=\"M", at);
  double x = 0, y = 0;
  ASSERT_EQ(std::sscanf(svg->c_str() + level, "<path d=\"M%lf %lf", &x, &y), 2);
  EXPECT_NEAR(y, p[0].second + 4 * (p[1].second - p[0].second), 0.3);
  EXPECT_GT(y, 14);  // within the figure
  at = svg->find("#444444\" stroke-dasharray", at + 1);
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(std::sscanf(svg->c_str() + svg->rfind("<path d=\"M", at), "<path d=\"M%lf %lf", &x, &y), 2);
  EXPECT_NEAR(x, (p[0].first + p[1].first) / 2, 0.1);
}

TEST(Plot, LinesTakeTheColoursTheyAreGiven) {
  const Table t = table("time,a,b\n0,0,1\n1,1,2\n");
  const auto svg = draw_plot({t}, {.colours = {"red"}});
  ASSERT_TRUE(svg);
  // Legend and line of the first; the second keeps the colour of its place.
  EXPECT_NE(svg->find("stroke=\"#d00000\""), svg->rfind("stroke=\"#d00000\""));
  EXPECT_EQ(svg->find("#0072b2"), std::string::npos);
  EXPECT_NE(svg->find("#d55e00"), std::string::npos);
  EXPECT_NE(draw_plot({t}, {.colours = {"red", "#12aB9f"}})->find("#12aB9f"), std::string::npos);
  EXPECT_NE(draw_plot({t}, {.colours = {"gren"}}).error().fix.find("green"), std::string::npos);
  EXPECT_FALSE(draw_plot({t}, {.colours = {"#12\"/><b"}}));
  EXPECT_FALSE(draw_plot({t}, {.colours = {"red", "red", "red"}}));
}

TEST(Plot, GapsBreakTheLineAndManyPointsKeepTheirPeaks) {
  std::string text = "time,a\n0,0\n1,1\n2,\n3,1\n4,nan\n5,1\n6,2\n";
  auto svg = draw_plot({table(text)}, {});
  ASSERT_TRUE(svg);
  const std::string data = svg->substr(svg->find("<g clip-path"));
  EXPECT_EQ(std::count(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(data.find("</g>")), 'M'), 3);

  text = "time,a\n";
  for (int i = 0; i < 100'000; ++i)
    text += std::to_string(i) + "," + (i == 54321 ? "9" : i % 2 ? "1" : "0") + "\n";
  svg = draw_plot({table(text)}, {.y_range = {{0, 9}}});
  ASSERT_TRUE(svg);
  const auto p = points(*svg);
  EXPECT_LT(p.size(), 8000u);  // 4 per half pixel of less than 800
  double top = 1e9;
  for (const auto& [x, y] : p) top = std::min(top, y);
  EXPECT_NEAR(p.front().second - top, 360, 0.1);
}

TEST(Plot, ManyFilesMakeALegend) {
  const std::vector<Table> two{table("time,a,b\n0,1,2\n1,2,3\n", "x/one.csv"),
                               table("time,a,b\n0,1,2\n1,2,4\n", "two.csv")};
  auto svg = draw_plot(two, {.y = {"a"}});
  ASSERT_TRUE(svg);
  EXPECT_NE(svg->find(">one<"), std::string::npos);
  EXPECT_NE(svg->find(">two<"), std::string::npos);
  svg = draw_plot(two, {.title = "P < Q", .labels = {"first & best"}});
  ASSERT_TRUE(svg);
  EXPECT_NE(svg->find(">first &amp; best<"), std::string::npos);
  EXPECT_NE(svg->find(">two: b<"), std::string::npos);
  EXPECT_NE(svg->find(">P &lt; Q<"), std::string::npos);
  const auto wrong = draw_plot(two, {.y = {"aa"}});
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text().find("one.csv: there is no column 'aa'; did you mean 'a'?"),
            std::string::npos)
      << wrong.error().text();
}

}  // namespace
}  // namespace sandlot::draw
