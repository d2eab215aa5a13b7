#include "server/services/name_filter.h"

#include <gtest/gtest.h>

namespace sandlot::server::test {
namespace {

TEST(NameFilter, FindsWhatARegularExpressionFinds) {
  const auto matches = [](const char* filter, const char* name) {
    const auto made = NameFilter::compile(filter);
    EXPECT_TRUE(made) << filter;
    return made && made->matches(name);
  };
  EXPECT_TRUE(matches("", "robot"));
  EXPECT_TRUE(matches("bo", "robot"));
  EXPECT_FALSE(matches("^bo", "robot"));
  EXPECT_TRUE(matches("ot$", "robot"));
  EXPECT_FALSE(matches("ro$", "robot"));
  EXPECT_TRUE(matches("^r.*t$", "robot"));
  EXPECT_TRUE(matches("^robot[0-9]+$", "robot12"));
  EXPECT_FALSE(matches("^robot[0-9]+$", "robot"));
  EXPECT_TRUE(matches("^robots?$", "robot"));
  EXPECT_TRUE(matches("^[^x-z]*$", "robot"));
  EXPECT_FALSE(matches("^[^a-z]*$", "robot"));
  EXPECT_TRUE(matches("a\\.b", "a.b"));
  EXPECT_FALSE(matches("a\\.b", "aXb"));
  EXPECT_FALSE(matches("a+$", "b"));
  EXPECT_TRUE(matches("(robot|crate)[12]", "crate2"));
  EXPECT_FALSE(matches("^(robot|crate)[12]$", "crate3"));
  EXPECT_TRUE(matches("^(a|b|)c$", "c"));
  EXPECT_TRUE(matches("^(ab)*$", "ababab"));
  EXPECT_FALSE(matches("^(ab)*$", "ababa"));
  EXPECT_TRUE(matches("^(a*)*b$", "aaab"));
  EXPECT_TRUE(matches("^a{2}$", "aa"));
  EXPECT_FALSE(matches("^a{2}$", "aaa"));
  EXPECT_TRUE(matches("^a{2,}$", "aaaaa"));
  EXPECT_FALSE(matches("^a{2,}$", "a"));
  EXPECT_TRUE(matches("^a{1,3}$", "aaa"));
  EXPECT_FALSE(matches("^a{1,3}$", "aaaa"));
  EXPECT_TRUE(matches("^(x|^y)z$", "yz"));
  EXPECT_TRUE(matches("^[[:alpha:]_]+[[:digit:]]$", "red_1"));
  EXPECT_FALSE(matches("^[[:alpha:]]+$", "red1"));
  EXPECT_TRUE(matches("^[]a]+$", "]a"));
  EXPECT_TRUE(matches("a|b$", "ac"));
  EXPECT_TRUE(matches("$", ""));
  for (const char* bad : {"(a", "a)", "a{3,2}", "a{x}", "{3}", "*", "(*a)", "[a", "[z-a]", "[[:letter:]]",
                          "\\", "\\1", "((a{255}){255}){255}"})
    EXPECT_FALSE(NameFilter::compile(bad)) << bad;
  EXPECT_FALSE(NameFilter::compile(std::string(60, '(') + std::string(60, ')')));
  // What takes a backtracking matcher for ever.
  std::string evil;
  for (int i = 0; i < 100; ++i) evil += "a*";
  EXPECT_FALSE(matches(("^" + evil + "b$").c_str(), std::string(200, 'a').c_str()));
  EXPECT_FALSE(matches("^((a|a)*)*b$", std::string(200, 'a').c_str()));
}

}  // namespace
}  // namespace sandlot::server::test
