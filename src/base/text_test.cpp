#include "base/text.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/math.h"
#include "base/units.h"

namespace sandlot {
namespace {

TEST(Text, NearestForgivesASlipButNoMore) {
  const std::vector<std::string> keys{"beams", "max_range", "min_range", "rate"};
  EXPECT_EQ(nearest("beam", keys), "beams");   // missing letter
  EXPECT_EQ(nearest("baems", keys), "beams");  // swapped letters count as one slip
  EXPECT_EQ(nearest("Max_Range", keys), "max_range");
  EXPECT_EQ(nearest("maxrange", keys), "max_range");
  EXPECT_EQ(nearest("colour", keys), "");
  EXPECT_EQ(nearest("", keys), "");
  EXPECT_EQ(nearest(std::string(100'000, 'x'), keys), "");  // bounded cost
}

TEST(Text, ASuggestionListsWhatThereIsWhenNothingIsNear) {
  const std::vector<std::string> keys{"a1", "b2"};
  EXPECT_EQ(suggestion("zzzzzz", keys), "known are: a1, b2");
  EXPECT_EQ(suggestion("zzzzzz", {}), "");
  const std::vector<std::string> many(20, "key");
  EXPECT_EQ(suggestion("zzzzzz", many),
            "known are: key, key, key, key, key, key, key, key, key, key, key, key, ... (20 in all)");
}

TEST(Text, NumbersReadBackAsThemselves) {
  for (const double x : {0.1, 1.0 / 3, -2.5e-300, 1e300, 4.9e-324, 9007199254740993.0, 0.0}) {
    double back = 1;
    ASSERT_TRUE(parse_number(number_text(x), back));
    EXPECT_EQ(back, x);
  }
}

TEST(Text, NumbersInMessagesHaveThreeDigits) {
  EXPECT_EQ(short_text(0.1 + 0.2), "0.3");
  EXPECT_EQ(short_text(-1.0 / 3), "-0.333");
  EXPECT_EQ(short_text(123456), "1.23e+05");
  EXPECT_EQ(short_text(0), "0");
}

TEST(Text, NumbersAreTakenWholeOrNotAtAll) {
  double x = 0;
  for (const char* good : {"1", " 1 ", "+1", "1.0", "1e0", "1.", "\t1\n"}) {
    x = 0;
    EXPECT_TRUE(parse_number(good, x)) << good;
    EXPECT_EQ(x, 1) << good;
  }
  for (const char* bad : {"", " ", "+", "-", "+-1", "++1", "1x", "1,5", "0x10", "1 2", "e5", "1e400", "--1"})
    EXPECT_FALSE(parse_number(bad, x)) << bad;
  EXPECT_TRUE(parse_number("-.5", x));
  EXPECT_EQ(x, -0.5);
}

TEST(Text, SplitsTrimsAndCleans) {
  EXPECT_EQ(split("a//b", '/'), (std::vector<std::string_view>{"a", "", "b"}));
  EXPECT_EQ(split("", '/'), (std::vector<std::string_view>{""}));
  EXPECT_EQ(split("a/", '/'), (std::vector<std::string_view>{"a", ""}));
  EXPECT_EQ(trim(" \t\r\na b\n "), "a b");
  EXPECT_TRUE(starts_with("abc", "ab"));
  EXPECT_FALSE(starts_with("a", "ab"));
  EXPECT_EQ(sanitised("a::b c-d_9"), "a__b_c-d_9");
  EXPECT_EQ(sanitised("r\xc3\xb6"), "r__");
  EXPECT_EQ(sanitised(""), "_");
}

double quantity(std::string_view text, std::string_view unit) {
  const auto result = parse_quantity(text, unit);
  return result ? *result : NAN;
}
std::string complaint(std::string_view text, std::string_view unit) {
  const auto result = parse_quantity(text, unit);
  return result ? "" : result.error().text();
}

TEST(Units, EachUnitIsWorthWhatItIs) {
  const double ulp = 2.3e-16;  // one product, relative
  EXPECT_EQ(quantity("5", "m"), 5);
  EXPECT_EQ(quantity("5 m", "m"), 5);
  EXPECT_EQ(quantity("5m", "m"), 5);
  EXPECT_NEAR(quantity("5 cm", "m"), 0.05, 0.05 * ulp);
  EXPECT_NEAR(quantity("-1e3 mm", "m"), -1, ulp);
  EXPECT_NEAR(quantity("90 deg", "rad"), math::pi / 2, 2 * ulp);
  EXPECT_NEAR(quantity("36 km/h", "m/s"), 10, 20 * ulp);
  EXPECT_NEAR(quantity("60 rpm", "rad/s"), math::tau, 14 * ulp);
  EXPECT_EQ(quantity("2 min", "s"), 120);
  EXPECT_EQ(quantity("1 h", "s"), 3600);
  EXPECT_EQ(quantity("2 kHz", "Hz"), 2000);
  EXPECT_EQ(quantity("50 %", "1"), 0.5);
  EXPECT_EQ(quantity("1 g0", "m/s^2"), 9.80665);
  EXPECT_EQ(quantity("3 Nm/A", "Nm/A"), 3);  // the field's own unit, whatever it is
  EXPECT_EQ(quantity(" 7 ", "m"), 7);
}

/// Every name of the table, as a quantity that is a round number in SI.
TEST(Units, NoNameIsWorthAnythingElse) {
  const struct {
    const char *text, *si;
    double value;
  } all[] = {
      {"4 m", "m", 4},
      {"2500 mm", "m", 2.5},
      {"50 cm", "m", 0.5},
      {"2 km", "m", 2000},
      {"2e6 um", "m", 2},
      {"100 in", "m", 2.54},
      {"10 ft", "m", 3.048},
      {"3 rad", "rad", 3},
      {"500 mrad", "rad", 0.5},
      {"180 deg", "rad", math::pi},
      {"3 s", "s", 3},
      {"250 ms", "s", 0.25},
      {"5e5 us", "s", 0.5},
      {"5e8 ns", "s", 0.5},
      {"3 min", "s", 180},
      {"2 h", "s", 7200},
      {"3 kg", "kg", 3},
      {"500 g", "kg", 0.5},
      {"2 t", "kg", 2000},
      {"3 Hz", "Hz", 3},
      {"3 kHz", "Hz", 3000},
      {"3 m/s", "m/s", 3},
      {"50 cm/s", "m/s", 0.5},
      {"500 mm/s", "m/s", 0.5},
      {"72 km/h", "m/s", 20},
      {"3 rad/s", "rad/s", 3},
      {"180 deg/s", "rad/s", math::pi},
      {"30 rpm", "rad/s", math::pi},
      {"3 m/s^2", "m/s^2", 3},
      {"2 g0", "m/s^2", 19.6133},
      {"3 rad/s^2", "rad/s^2", 3},
      {"180 deg/s^2", "rad/s^2", math::pi},
      {"3 N", "N", 3},
      {"2 kN", "N", 2000},
      {"3 Nm", "Nm", 3},
      {"500 mNm", "Nm", 0.5},
      {"3 W", "W", 3},
      {"3 J", "J", 3},
      {"2 kJ", "J", 2000},
      {"2 Wh", "J", 7200},
      {"3 V", "V", 3},
      {"500 mV", "V", 0.5},
      {"3 A", "A", 3},
      {"500 mA", "A", 0.5},
      {"3 ohm", "ohm", 3},
      {"500 mohm", "ohm", 0.5},
      {"50 %", "1", 0.5},
      {"3 1", "1", 3},
      {"3 C", "C", 3},
      {"2 Ah", "C", 7200},
      {"1000 mAh", "C", 3600},
      {"500 mW", "W", 0.5},
      {"2 kW", "W", 2000},
      {"500 mJ", "J", 0.5},
      {"5e5 uJ", "J", 0.5},
      {"5e8 nJ", "J", 0.5},
      {"3 Ns", "Ns", 3},
      {"3 B", "B", 3},
      {"3 kB", "B", 3000},
      {"3 MB", "B", 3e6},
      {"3 GB", "B", 3e9},
      {"2 KiB", "B", 2048},
      {"0.5 MiB", "B", 524288},
      {"0.5 GiB", "B", 536870912},
      {"3 bit/s", "bit/s", 3},
      {"3 kbit/s", "bit/s", 3000},
      {"3 Mbit/s", "bit/s", 3e6},
  };
  for (const auto& each : all)
    EXPECT_NEAR(quantity(each.text, each.si), each.value, 1e-15 * each.value) << each.text;
}

TEST(Units, WhatDoesNotFitIsRefused) {
  EXPECT_EQ(complaint("5 kg", "s"), "unit 'kg' does not fit; units that fit: s, ms, us, ns, min, h");
  EXPECT_EQ(complaint("5 m", "Nm/A"), "unit 'm' does not fit; write the bare number");
  EXPECT_EQ(complaint("", "m"), "'' is not a number; write a number, in m or with its unit");
  EXPECT_EQ(complaint("abc", "1"), "'abc' is not a number; write a number");
  EXPECT_EQ(complaint("1e400", "m"), "'1e400' is not a number; write a number, in m or with its unit");
  EXPECT_NE(complaint("1,5", "m"), "");
  EXPECT_NE(complaint("0x10", "m"), "");
  EXPECT_NE(complaint("1 2", "m"), "");
  EXPECT_NE(complaint("+-1", "m"), "");
  EXPECT_NE(complaint(std::string(1'000'000, '1'), "m"), "");
  EXPECT_NE(complaint(std::string(1'000'000, 'a'), "m"), "");
}

TEST(Text, FirstPartEndsBeforeTheFirstSlash) {
  EXPECT_EQ(first_part("robot1/laser/ranges"), "robot1");
  EXPECT_EQ(first_part("robot1"), "robot1");
  EXPECT_EQ(first_part("/robot1"), "");
  EXPECT_EQ(first_part(""), "");
}

TEST(Text, IsOneOfComparesWholeTexts) {
  EXPECT_TRUE(is_one_of("joint", {"link", "joint"}));
  EXPECT_FALSE(is_one_of("join", {"link", "joint"}));
  EXPECT_FALSE(is_one_of("", {"link"}));
}

}  // namespace
}  // namespace sandlot
