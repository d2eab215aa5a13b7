#include "base/shared_list.h"

#include <gtest/gtest.h>

#include <string>

namespace sandlot {
namespace {

TEST(SharedList, CopiesShareUntilOneOfThemIsEdited) {
  SharedList<std::string> a{"one", "two"};
  SharedList<std::string> b = a;
  EXPECT_EQ(&std::as_const(a)[0], &std::as_const(b)[0]);
  b.push_back("three");
  EXPECT_FALSE(a.shares_with(b));
  EXPECT_EQ(a.size(), 2u);
  ASSERT_EQ(b.size(), 3u);
  for (std::string& each : a) each += "!";
  EXPECT_EQ(std::as_const(a)[1], "two!");
  EXPECT_EQ(std::as_const(b)[1], "two");
}

TEST(SharedList, WhoHoldsOneOfThemKeepsItWhateverBecomesOfTheList) {
  SharedList<std::string> list{"one", "two"};
  const std::shared_ptr<const std::string> two = list.share(1);
  list.erase(1);
  list[0] = "changed";
  EXPECT_EQ(*two, "two") << "the list was edited in a copy: somebody held it";
  list.clear();
  EXPECT_TRUE(list.empty());
  EXPECT_EQ(list.begin(), list.end());
  EXPECT_EQ(*two, "two");
}

TEST(SharedList, AnEmptyOneCanBeEdited) {
  SharedList<int> list;
  EXPECT_EQ(list.size(), 0u);
  list.push_back(3);
  EXPECT_EQ(list.back(), 3);
}

}  // namespace
}  // namespace sandlot
