#include "console/line_parsing.h"

#include <gtest/gtest.h>

#include <numbers>

#include "base/random.h"

namespace sandlot::console {
namespace {

std::vector<std::string> texts(std::string_view line) {
  std::vector<std::string> out;
  const auto words = words_of(line);
  if (!words) return {"error: " + words.error().what};
  for (const Word& word : *words) out.push_back(word.text);
  return out;
}

TEST(Words, QuotesKeepBlanks) {
  EXPECT_EQ(texts("  set a.b\t'2 cm' \"x y\"z "), (std::vector<std::string>{"set", "a.b", "2 cm", "x yz"}));
  EXPECT_EQ(texts("say ''"), (std::vector<std::string>{"say", ""}));
  EXPECT_EQ(texts("say 'it"), (std::vector<std::string>{"error: a quote is not closed in 'say 'it'"}));
  EXPECT_EQ((*words_of("pose 'a b' 1"))[1].end, 10u);
}

TEST(Words, PatternsStopAtSlashesAndDotsUnlessDoubled) {
  EXPECT_TRUE(fits("rover*", "rover12"));
  EXPECT_FALSE(fits("rover*", "rover12/laser"));
  EXPECT_TRUE(fits("*/laser", "rover12/laser"));
  EXPECT_FALSE(fits("*/laser", "a/b/laser"));
  EXPECT_TRUE(fits("**/laser", "a/b/laser"));
  EXPECT_TRUE(fits("**", "a/b.c"));
  EXPECT_TRUE(fits("r?ver", "rover"));
  EXPECT_FALSE(fits("r?ver", "rver"));
  EXPECT_TRUE(fits("rover[1-35]", "rover5"));
  EXPECT_FALSE(fits("rover[1-35]", "rover4"));
  EXPECT_TRUE(fits("rover[!1-3]", "rover4"));
  EXPECT_FALSE(fits("rover[!1-3]", "rover2"));
  EXPECT_TRUE(fits("rover[", "rover["));
  EXPECT_TRUE(fits("", ""));
  EXPECT_FALSE(fits("", "a"));
}

/// What a pattern stands for, letter by letter of both.
bool fits_slowly(std::string_view pattern, std::string_view name) {
  if (pattern.empty()) return name.empty();
  const bool deep = pattern.substr(0, 2) == "**";
  const auto stays = [&](char c) { return c != '/' && c != '.'; };
  if (pattern[0] == '*')
    return fits_slowly(pattern.substr(deep ? 2 : 1), name) ||
           (!name.empty() && (deep || stays(name[0])) && fits_slowly(pattern, name.substr(1)));
  return !name.empty() && (pattern[0] == '?' ? stays(name[0]) : pattern[0] == name[0]) &&
         fits_slowly(pattern.substr(1), name.substr(1));
}

/// Also across the border of 64 places, where the bits of the matcher go on in the next word.
TEST(Words, PatternsOfAnyLengthMeanWhatTheyStandFor) {
  Stream random(1, 2, Purpose::experiment, 3);
  const auto pick = [&](std::string_view of) { return of[random.bits32() % of.size()]; };
  int fitting = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string pattern, name;
    for (std::size_t k = random.bits32() % 5; k-- > 0;) pattern += pick("ab/*?"), name += pick("ab/.");
    if (random.bits32() % 2) {  // the same letters in front of both, up to the border and over it
      const std::size_t more = 58 + random.bits32() % 10;
      pattern.insert(0, more, 'x'), name.insert(0, more, 'x');
    }
    for (std::size_t k = random.bits32() % 6; k-- > 0;) pattern += pick("ab*?"), name += pick("ab/");
    const bool expected = fits_slowly(pattern, name);
    ASSERT_EQ(fits(pattern, name), expected) << pattern << " " << name;
    fitting += expected;
  }
  EXPECT_GT(fitting, 500);
}

TEST(Words, BracketsWithDigitsAreIndicesInPaths) {
  EXPECT_TRUE(fits("*.ranges[3]", "laser.ranges[3]", true));
  EXPECT_FALSE(fits("*.ranges[3]", "laser.ranges3", true));
  EXPECT_TRUE(fits("rover[3]", "rover3"));
  EXPECT_FALSE(is_pattern("a.ranges[3]", true));
  EXPECT_TRUE(is_pattern("rover[3]"));
}

/// A hostile pattern costs its length times that of the name, not two to the power of its stars.
TEST(Words, ManyStarsCostLittle) {
  std::string pattern, name(300, 'a');
  for (int i = 0; i < 100; ++i) pattern += "*a";
  EXPECT_FALSE(fits(pattern + "b", name));
  EXPECT_TRUE(fits(pattern, name));
}

TEST(Words, QuantitiesMayBeTwoWords) {
  const std::vector<std::string> words{"90", "deg", "2cm", "3", "4 m"};
  std::span<const std::string> rest = words;
  EXPECT_DOUBLE_EQ(*take_quantity(rest, "YAW", "rad"), std::numbers::pi / 2);
  EXPECT_DOUBLE_EQ(*take_quantity(rest, "X", "m"), 0.02);
  EXPECT_DOUBLE_EQ(*take_quantity(rest, "Y", "m"), 3);
  EXPECT_DOUBLE_EQ(*take_quantity(rest, "Z", "m"), 4);
  EXPECT_TRUE(rest.empty());
  EXPECT_EQ(take_quantity(rest, "Z", "m").error().what, "Z is missing");
}

TEST(Words, Colours) {
  const Color orange = *read_color("#ff8000");
  EXPECT_FLOAT_EQ(orange.r, 1);
  EXPECT_FLOAT_EQ(orange.g, 128 / 255.0f);
  EXPECT_FLOAT_EQ(orange.b, 0);
  EXPECT_EQ(*read_color("1,0.5,0"), (Color{1, 0.5f, 0, 1}));
  EXPECT_FALSE(read_color("1,2,0"));
  EXPECT_FALSE(read_color("#ff80"));
  EXPECT_EQ(read_color("redd").error().fix.find("did you mean 'red'") != std::string::npos, true);
}

TEST(Numbers, AreRoundedForPeopleButWholeOnesAndMillisecondsStay) {
  EXPECT_EQ(readable(0.1 + 0.2), "0.3");
  EXPECT_EQ(readable(1.0 / 3), "0.333333");
  EXPECT_EQ(readable(1.23456789e-9), "1.23457e-09");
  EXPECT_EQ(readable(1234567), "1234567") << "a tick";
  EXPECT_EQ(readable(12345.6789), "12345.679") << "a time";
  EXPECT_EQ(readable(-0.0), "0");
  EXPECT_EQ(with_unit(0.30000000000000004, "m"), "0.3 m");
}

}  // namespace
}  // namespace sandlot::console
