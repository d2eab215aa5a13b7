#include "base/values.h"

#include <gtest/gtest.h>

#include <map>

#include "geometry/pose.h"

namespace sandlot {
namespace {

enum class Mode { off, slow = 3 };
struct Inner {
  double white = 0.25;
  std::vector<float> ranges{1, 2, 4};
  static void fields(auto& s, auto&& visit) {
    visit(Field{"white", "m", "White."}, s.white);
    visit(Field{"ranges", "m", "Ranges."}, s.ranges);
  }
};
struct Outer {
  Inner noise;
  std::vector<Inner> many{{.white = 7}};
  std::optional<double> unset;
  std::optional<Inner> none;
  Mode mode = Mode::slow;
  bool on = true;
  Time stamp = Time::from_s(1.5);
  std::string text = "hello";
  std::array<double, 2> pair{8, 9};
  std::vector<bool> bits{false, true};
  Pose pose{{1, 2, 3}, quat_from_rpy(0.1, 0.2, 0.3)};
  static void fields(auto& s, auto&& visit) {
    visit(Field{"noise", "", ""}, s.noise);
    visit(Field{"many", "", ""}, s.many);
    visit(Field{"unset", "V", ""}, s.unset);
    visit(Field{"none", "", ""}, s.none);
    visit(Field{"mode", "", ""}, s.mode);
    visit(Field{"on", "", ""}, s.on);
    visit(Field{"stamp", "ns", ""}, s.stamp);
    visit(Field{"text", "", ""}, s.text);
    visit(Field{"pair", "rad", ""}, s.pair);
    visit(Field{"bits", "", ""}, s.bits);
    visit(Field{"pose", "", ""}, s.pose);
  }
};
using Is = ValueFound::Is;

ValueFound at(const std::string& path) {
  auto parsed = parse_value_path(path);
  EXPECT_TRUE(parsed) << path;
  return value_at(Outer(), *parsed);
}

TEST(Values, EveryKindOfNumberIsFoundByItsPath) {
  const std::vector<std::tuple<const char*, double, const char*>> expected{
      {"noise.white", 0.25, "m"},
      {"noise.ranges[2]", 4, "m"},
      {"many[0].white", 7, "m"},
      {"mode", 3, ""},
      {"on", 1, ""},
      {"stamp", 1.5, "s"},
      {"pair[1]", 9, "rad"},
      {"bits[1]", 1, ""},
      {"pose.x", 1, "m"},
      {"pose.position.z", 3, "m"},
      {"pose.position[1]", 2, "m"},
      {"pose.yaw", 0.3, "rad"},
      {"pose.orientation.roll", 0.1, "rad"},
  };
  for (const auto& [path, value, unit] : expected) {
    const ValueFound found = at(path);
    EXPECT_EQ(found.is, Is::value) << path;
    EXPECT_NEAR(found.value, value, 1e-15) << path;  // angles go through a quaternion: a few ulp of 1
    EXPECT_EQ(found.unit, unit) << path;
  }
}

TEST(Values, WhatIsNoNumberSaysWhy) {
  const std::vector<std::pair<const char*, Is>> expected{
      {"noise", Is::compound},         {"noise.ranges", Is::compound}, {"text", Is::text},
      {"unset", Is::absent},           {"none.white", Is::absent},     {"none.black", Is::unknown},
      {"noise.ranges[3]", Is::absent}, {"many[5].white", Is::absent},  {"many[5].black", Is::unknown},
      {"pair[2]", Is::unknown},        {"noise.black", Is::unknown},   {"on.x", Is::unknown},
      {"pose.x.y", Is::unknown},       {"noise[0]", Is::unknown},
  };
  for (const auto& [path, is] : expected) EXPECT_EQ(at(path).is, is) << path;
}

TEST(Values, TheListHoldsWhatCanBeFound) {
  std::map<std::string, ValueEntry> all;
  list_values(Outer(), "", "", "", [&](ValueEntry entry) { all[entry.path] = entry; });
  for (const auto& [path, entry] : all) {
    const ValueFound found = at(path + (entry.list ? "[0]" : ""));
    EXPECT_EQ(found.is, entry.is) << path;
    if (found.is == Is::value) { EXPECT_EQ(found.value, entry.value) << path; }
    EXPECT_EQ(found.unit, entry.unit) << path;
  }
  EXPECT_TRUE(all.contains("many[0].white"));
  EXPECT_EQ(all.at("noise.ranges").count, 3u);
  EXPECT_EQ(all.size(),
            2u + 2u + 1u + 2u + 3u + 2u + 6u);  // noise many unset none mode,on,stamp pair,bits pose
}

TEST(Values, PathsAreParsedOrRefused) {
  for (const char* good : {"a", "a.b", "a[0]", "a[3].b-c[12][0]"}) {
    auto path = parse_value_path(good);
    ASSERT_TRUE(path) << good;
    EXPECT_EQ(to_string(*path), good);
  }
  std::string deep = "a";
  for (int i = 0; i < 16; ++i) deep += ".a";
  for (const std::string& bad :
       {std::string(), std::string("."), std::string("a."), std::string("a..b"), std::string("a["),
        std::string("a[]"), std::string("a[1"), std::string("a[-1]"), std::string("a[1]b"),
        std::string("a b"), std::string("a[99999999999999999999]"), deep, std::string(1000, 'a')})
    EXPECT_FALSE(parse_value_path(bad)) << bad;
}

}  // namespace
}  // namespace sandlot
