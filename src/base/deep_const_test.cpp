#include "base/deep_const.h"

#include <gtest/gtest.h>

#include <vector>

namespace sandlot {
namespace {

struct Part {
  int value = 0;
};
struct Special : Part {};
struct Whole {
  Owned<Part> owned;
  DeepConst<Part*> seen;
  std::vector<Owned<Part>> list;
};

template <class T>
constexpr bool is_const_access = std::is_same_v<T, const Part&>;
static_assert(is_const_access<decltype(*std::declval<const Whole&>().owned)>);
static_assert(is_const_access<decltype(*std::declval<const Whole&>().seen)>);
static_assert(is_const_access<decltype(*std::declval<const Whole&>().list[0])>);
static_assert(std::is_same_v<decltype(std::declval<const Whole&>().owned.get()), const Part*>);
static_assert(std::is_same_v<decltype(*std::declval<Whole&>().owned), Part&>);
static_assert(!std::is_copy_constructible_v<DeepConst<Part*>>, "a copy would lose the constness");
static_assert(!std::is_constructible_v<DeepConst<Part*>, const Part*>);

TEST(DeepConst, OwnsMovesAndKnowsWhenItIsEmpty) {
  Whole whole;
  EXPECT_FALSE(whole.owned);
  EXPECT_EQ(whole.owned.get(), nullptr);
  whole.owned = std::make_unique<Special>();
  whole.owned->value = 3;
  whole.seen = whole.owned.get();
  EXPECT_EQ(whole.seen->value, 3);
  whole.list.push_back(std::move(whole.owned));
  EXPECT_FALSE(whole.owned);
  EXPECT_EQ(std::as_const(whole).list.front()->value, 3);
  EXPECT_EQ(whole.seen.get(), whole.list.front().get());
  whole.list.front() = nullptr;
  EXPECT_FALSE(whole.list.front());
}

}  // namespace
}  // namespace sandlot
