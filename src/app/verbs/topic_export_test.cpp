#include "app/verbs/topic_export.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sandlot::app {
namespace {

TEST(TopicExport, TheLongestTopicEndsWhereThePathBegins) {
  const std::vector<std::string> topics{"/a", "/a/b", "/odd.name", "/odd"};
  auto wanted = wanted_topics(std::vector<std::string>{"/a/b.x.y[3]", "a.z", "/odd.name.q", "/a/b.w"},
                              topics);
  ASSERT_TRUE(wanted) << wanted.error().text();
  ASSERT_EQ(wanted->size(), 3u);
  EXPECT_EQ((*wanted)[0].topic, "/a/b");
  EXPECT_EQ((*wanted)[0].paths, (std::vector<std::string>{"x.y[3]", "w"}));
  EXPECT_EQ((*wanted)[1].topic, "/a");
  EXPECT_EQ((*wanted)[2].topic, "/odd.name");
  EXPECT_EQ((*wanted)[2].paths, (std::vector<std::string>{"q"}));
  wanted = wanted_topics(std::vector<std::string>{"/a.x", "/a"}, topics);
  ASSERT_TRUE(wanted);
  EXPECT_TRUE(wanted->front().paths.empty());  // all of it
  const auto wrong = wanted_topics(std::vector<std::string>{"/a/c.x"}, topics);
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().text().find("there is no topic '/a/c'; did you mean '/a/b'?"), std::string::npos)
      << wrong.error().text();
}

TEST(TopicExport, ARowPerTimeHoldsTheLatestOfEachTopic) {
  HeldColumns columns;
  columns.add("/a.x");
  columns.add("/b.y");
  std::string out = columns.header();
  columns.message(0, 0, 1, out);
  columns.set(0, 1);
  columns.message(500'000'000, 1, 2, out);
  columns.set(1, 7);
  columns.message(1'000'000'000, 0, 1, out);
  columns.set(0, 2);
  columns.message(1'000'000'000, 1, 2, out);
  columns.set(1, 8);
  columns.message(2'000'000'000, 0, 1, out);  // its list has become too short
  columns.finish(out);
  EXPECT_EQ(out, "time,/a.x,/b.y\n0,1,\n0.5,1,7\n1,2,8\n2,,8\n");
}

}  // namespace
}  // namespace sandlot::app
