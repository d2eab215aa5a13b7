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
