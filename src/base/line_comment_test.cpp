#include "base/line_comment.h"

#include <gtest/gtest.h>

namespace sandlot {
namespace {

TEST(LineComment, BeginsAtTheLineOrAfterABlank) {
  EXPECT_EQ(without_comment("play # slowly"), "play ");
  EXPECT_EQ(without_comment("play\t#slowly"), "play\t");
  EXPECT_EQ(without_comment("# nothing"), "");
  EXPECT_EQ(without_comment(""), "");
}

TEST(LineComment, IsNoneInAWordOrInQuotes) {
  EXPECT_EQ(without_comment("image: map#2.pgm"), "image: map#2.pgm");
  EXPECT_EQ(without_comment("say 'a # b' # c"), "say 'a # b' ");
  EXPECT_EQ(without_comment("say \"it's # 1\" now"), "say \"it's # 1\" now");
  EXPECT_EQ(without_comment("say 'open # end"), "say 'open # end");
}

}  // namespace
}  // namespace sandlot
