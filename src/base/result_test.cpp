#include "base/result.h"

#include <gtest/gtest.h>

#include "base/node.h"
#include "base/time.h"

namespace sandlot {
namespace {

TEST(Error, SaysWhatIsKnownAndLeavesOutTheRest) {
  const auto file = std::make_shared<const std::string>("w.sdf");
  EXPECT_EQ((Error{"bad", "do good", {file, 3, 4}, "/a/b"}.text()), "w.sdf:3:4: /a/b: bad; do good");
  EXPECT_EQ((Error{"bad", "", {file, 3, 0}, ""}.text()), "w.sdf:3: bad");
  EXPECT_EQ((Error{"bad", "", {file, 0, 0}, ""}.text()), "w.sdf: bad");
  EXPECT_EQ((Error{"bad", "", {nullptr, 3, 4}, ""}.text()), "line 3:4: bad");
  EXPECT_EQ((Error{"bad"}.text()), "bad");
}

Result<int> half(int x) {
  if (x % 2) return Error{"odd"};
  return x / 2;
}
Result<int> quarter(int x) {
  SL_ASSIGN(const int h, half(x));
  return half(h);
}
Status both(int a, int b) {
  SL_TRY(half(a));
  SL_TRY(half(b));
  return {};
}

TEST(Result, CarriesTheValueOrTheFirstError) {
  EXPECT_EQ(*quarter(8), 2);
  EXPECT_EQ(quarter(6).error().what, "odd");
  EXPECT_TRUE(both(2, 4));
  EXPECT_EQ(both(2, 3).error().what, "odd");
  Result<std::unique_ptr<int>> owner = std::make_unique<int>(5);
  const std::unique_ptr<int> taken = *std::move(owner);
  EXPECT_EQ(*taken, 5);
}

using ResultDeathTest = testing::Test;
TEST(ResultDeathTest, TakingWhatIsNotThereIsABug) {
  EXPECT_DEATH((void)half(3).value(), "odd");
  EXPECT_DEATH((void)half(2).error(), "internal error");
  EXPECT_DEATH((void)Status().error(), "internal error");
}

TEST(Node, KeepsOrderAndPlacesAndReplacesByKey) {
  Node map = Node::map();
  map.set("b", Node::scalar("1"));
  map.set("a", Node::scalar("2"));
  map.set("b", Node::scalar("3"));
  ASSERT_EQ(map.entries().size(), 2u);
  EXPECT_EQ(map.entries()[0].key, "b");
  EXPECT_EQ(map.find("b")->text(), "3");
  EXPECT_EQ(map.find("c"), nullptr);
  EXPECT_TRUE(map.erase("b"));
  EXPECT_FALSE(map.erase("b"));
  EXPECT_EQ(describe(Node()), "nothing");
  EXPECT_EQ(describe(map), "a map");
}

TEST(Node, MergingGoesKeyByKeyAndReplacesTheRest) {
  Node base = Node::map();
  base.set("keep", Node::scalar("1"));
  base.set("list", Node::sequence()).push(Node::scalar("1"));
  base.set("inner", Node::map()).set("x", Node::scalar("1"));
  Node over = Node::map();
  over.set("inner", Node::map()).set("y", Node::scalar("2"));
  over.set("list", Node::sequence());
  over.set("new", Node::scalar("3"));
  merge(base, over);
  EXPECT_EQ(base.find("keep")->text(), "1");
  EXPECT_TRUE(base.find("list")->items().empty());
  EXPECT_EQ(base.find("inner")->find("x")->text(), "1");
  EXPECT_EQ(base.find("inner")->find("y")->text(), "2");
  EXPECT_EQ(base.find("new")->text(), "3");
}

TEST(Time, SecondsRoundToTheNearestNanosecond) {
  EXPECT_EQ(Time::from_s(0.1).ns, 100'000'000);
  EXPECT_EQ(Time::from_s(-0.1).ns, -100'000'000);
  EXPECT_EQ(Time::from_s(1e-9 * 0.6).ns, 1);
  EXPECT_EQ((Time::from_s(1.5) - Time::from_s(0.25)).ns, 1'250'000'000);
  EXPECT_EQ((Time::from_s(0.001) * 1000).s(), 1.0);
  // Forged numbers of seconds are the greatest time there is, not an overflow.
  EXPECT_EQ(Time::from_s(1e300).ns, 9'200'000'000'000'000'000);
  EXPECT_EQ(Time::from_s(-1e300).ns, -9'200'000'000'000'000'000);
  EXPECT_GT(due_time({}, 1, 1e-300), Time::from_s(3e9));
  EXPECT_LT(Time::from_ns(1), Time::from_ns(2));
}

TEST(Time, DueTimesDoNotDrift) {
  // 3 Hz: floor(k 1e9 / 3). After ten million samples still exact.
  EXPECT_EQ(due_time({}, 1, 3.0).ns, 333'333'333);
  EXPECT_EQ(due_time({}, 3, 3.0).ns, 1'000'000'000);
  EXPECT_EQ(due_time({}, 30'000'001, 3.0).ns, 10'000'000'333'333'333);
  EXPECT_EQ(due_time(Time::from_s(2), 50, 50.0).ns, 3'000'000'000);
  EXPECT_EQ(due_time({}, 1'000'000'000, 1e6).ns, 1'000'000'000'000);
  for (std::int64_t k = 0; k < 10'000; ++k) EXPECT_LT(due_time({}, k, 7.3), due_time({}, k + 1, 7.3));
}

}  // namespace
}  // namespace sandlot
