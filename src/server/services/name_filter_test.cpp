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
  for (const char* bad : {"(a)", "a|b", "a{3}", "*", "[a", "\\"})
    EXPECT_FALSE(NameFilter::compile(bad)) << bad;
  // What takes a backtracking matcher for ever.
  std::string evil;
  for (int i = 0; i < 100; ++i) evil += "a*";
  EXPECT_FALSE(matches(("^" + evil + "b$").c_str(), std::string(200, 'a').c_str()));
}

}  // namespace
}  // namespace sandlot::server::test
