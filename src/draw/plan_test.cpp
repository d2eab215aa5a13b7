#include "draw/plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/math.h"

namespace sandlot::draw {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + what.size())) ++n;
  return n;
}

/// Every tag is closed in the right order, every attribute quoted: what any XML reader asks for first.
bool well_formed(const std::string& svg) {
  std::vector<std::string> open;
  for (std::size_t at = svg.find('<'); at != std::string::npos; at = svg.find('<', at + 1)) {
    const std::size_t end = svg.find('>', at);
    const std::size_t next = svg.find('<', at + 1);
    if (end == std::string::npos || next < end) return false;
    const std::string tag = svg.substr(at + 1, end - at - 1);
    if (count(tag, "\"") % 2) return false;
    if (tag[0] == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else if (tag.back() != '/') {
      open.push_back(tag.substr(0, tag.find(' ')));
    }
  }
  return open.empty();
}

Plan::Robot robot(const std::string& name, Vec3 at, double yaw = 0) {
  Plan::Robot r;
  r.name = name;
  r.X_WB = {at, quat_from_rpy(0, 0, yaw)};
  r.solids.push_back({Cylinder{0.2, 0.3}, {at + Vec3{0, 0, 0.15}, {}}, {}, true});
  r.path = {{{0, 0, 0}, at}};
  return r;
}

Plan room() {
  Plan plan;
  plan.title = "room";
  plan.solids.push_back({Plane{{0, 0, 1}}, {}, {}, false});
  plan.solids.push_back({Box{{4, 0.1, 2}}, {{2, 0, 1}, {}}, {0.5f, 0.5f, 0.5f, 1}, false});
  plan.solids.push_back({Box{{4, 0.1, 2}}, {{2, 3, 1}, {}}, {0.5f, 0.5f, 0.5f, 1}, false});
  return plan;
}

TEST(Plan, IsWellFormedAndSaysWhatItShows) {
  Plan plan = room();
  plan.robots.push_back(robot("rover", {1, 1, 0}));
  plan.robots[0].driven_m = 12.34;
  const std::string svg = to_svg(plan);
  EXPECT_TRUE(well_formed(svg));
  EXPECT_THAT(svg, HasSubstr(">room</text>"));
  EXPECT_THAT(svg, HasSubstr("rover, 12.3 m driven"));
  EXPECT_THAT(svg, HasSubstr("x [m]"));
  EXPECT_EQ(count(svg, "class=\"robot\""), 1u);
}

TEST(Plan, DrawsEachRobotsPathAndStart) {
  Plan plan = room();
  for (int i = 0; i < 5; ++i) plan.robots.push_back(robot("r" + std::to_string(i), {0.5 + 0.6 * i, 1, 0}));
  const std::string svg = to_svg(plan);
  EXPECT_EQ(count(svg, "class=\"path\""), 5u);
  EXPECT_EQ(count(svg, "class=\"start\""), 5u);
  EXPECT_EQ(count(svg, "class=\"heading\""), 5u);
}

TEST(Plan, CoordinatesAreMillimetresInTheWorld) {
  Plan plan = room();
  plan.robots.push_back(robot("rover", {1.2345, 2, 0}));
  const std::string svg = to_svg(plan);
  EXPECT_THAT(svg, HasSubstr("cx=\"1235\" cy=\"2000\" r=\"200\""));  // half up
  EXPECT_THAT(svg, HasSubstr("d=\"M0 0l1235 2000\""));               // the path, in steps
}

TEST(Plan, PointsThatRoundToOneAreWrittenOnce) {
  Plan plan = room();
  plan.robots.push_back(robot("rover", {1, 1, 0}));
  plan.robots[0].scans.push_back({{1, 1, 0}, {{1.0001, 1, 0}, {2, 1.5, 0}}, {true, true}});
  EXPECT_THAT(to_svg(plan), HasSubstr("d=\"M1000 1000l1000 500z\""));
}

TEST(Plan, TheArrowPointsWhereTheRobotDoes) {
  Plan plan = room();
  plan.robots.push_back(robot("rover", {1, 1, 0}, math::pi / 2));
  // Reach 0.2 m: the tip lies 0.95 * 0.2 m north of the centre.
  EXPECT_THAT(to_svg(plan), HasSubstr("class=\"heading\" d=\"M1000 1190l"));
}

TEST(Plan, EscapesNames) {
  Plan plan = room();
  plan.title = "a<b & \"c\"";
  plan.robots.push_back(robot("<script>&", {1, 1, 0}));
  plan.robots.push_back(robot("two\n\x01", {2, 1, 0}));
  const std::string svg = to_svg(plan);
  EXPECT_TRUE(well_formed(svg));
  EXPECT_THAT(svg, Not(HasSubstr("<script")));
  EXPECT_THAT(svg, HasSubstr("&lt;script&gt;&amp;"));
  EXPECT_THAT(svg, HasSubstr("a&lt;b &amp; &quot;c&quot;"));
  EXPECT_THAT(svg, Not(HasSubstr("\x01")));
}

TEST(Plan, ScansFanOutAndMarkHitsOnly) {
  Plan plan = room();
  plan.robots.push_back(robot("rover", {1, 1, 0}));
  plan.robots[0].scans.push_back({{1, 1, 0}, {{2, 1, 0}, {2, 2, 0}, {1, 2, 0}}, {true, false, true}});
  const std::string svg = to_svg(plan);
  EXPECT_THAT(svg, HasSubstr("d=\"M1000 1000l1000 0 0 1000-1000 0z\""));
  EXPECT_THAT(svg, HasSubstr("d=\"M2000 1000h0M1000 2000h0\""));
}

TEST(Plan, WhatHangsOverRobotsIsTranslucentUnlessItStandsOnSomething) {
  Plan plan = room();
  plan.solids.push_back({Box{{1, 1, 0.05}}, {{1, 1.5, 0.7}, {}}, {1, 0, 0, 1}, false});
  plan.robots.push_back(robot("rover", {3, 1, 0}));
  EXPECT_EQ(count(to_svg(plan), "opacity=\"0.45\""), 1u);
  plan.solids.push_back({Cylinder{0.1, 0.68}, {{1, 1.5, 0.34}, {}}, {}, false});
  EXPECT_EQ(count(to_svg(plan), "opacity=\"0.45\""), 0u);
}

TEST(Plan, HigherSolidsAreDrawnLater) {
  Plan plan;
  plan.solids.push_back({Box{{1, 1, 2}}, {{0, 0, 1}, {}}, {1, 0, 0, 1}, false});
  plan.solids.push_back({Box{{1, 1, 1}}, {{0, 0, 0.5}, {}}, {0, 0, 1, 1}, false});
  const std::string svg = to_svg(plan);
  EXPECT_LT(svg.find("#0000ff"), svg.find("#ff0000"));
}

TEST(Plan, WhatRolledFarAwayDoesNotShrinkThePicture) {
  Plan plan = room();
  const std::string before = to_svg(plan);
  plan.solids.push_back({Sphere{0.1}, {{500, 0, 0}, {}}, {}, true});
  const auto frame = [](const std::string& svg) { return svg.substr(svg.find("matrix("), 60); };
  EXPECT_EQ(frame(before), frame(to_svg(plan)));
}

TEST(Plan, AnEmptyWorldIsAnEmptyFloor) {
  const std::string svg = to_svg({});
  EXPECT_TRUE(well_formed(svg));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(Plan, StaysSmallWithManyRobotsAndLongPaths) {
  Plan plan = room();
  for (int i = 0; i < 3000; ++i) {
    const int row = i / 60;
    Plan::Robot r = robot("robot" + std::to_string(i), {0.5 * (i % 60), 0.5 * row, 0});
    r.path[0].clear();
    for (int k = 0; k < 200; ++k)
      r.path[0].push_back(r.X_WB.p + 0.2 * Vec3{math::cos(0.37 * k * k), math::sin(0.3 * k), 0});
    plan.robots.push_back(std::move(r));
  }
  const std::string svg = to_svg(plan);
  EXPECT_TRUE(well_formed(svg));
  EXPECT_LT(svg.size(), 1'500'000u);
  EXPECT_EQ(count(svg, "class=\"path\""), 3000u);
}

}  // namespace
}  // namespace sandlot::draw
