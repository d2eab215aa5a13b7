#include "app/flags.h"

#include <gtest/gtest.h>

namespace sandlot::app {
namespace {

TEST(Flags, ReadSizesAndPoints) {
  draw::ViewpointOptions out;
  for (const char* text : {"640", "640x", "x480", "0x480", "640x-480", "640.5x480", "1e99x2", "axb"})
    EXPECT_FALSE(read_size("--size", text, out)) << text;
  EXPECT_TRUE(read_size("--size", "640x480", out));
  EXPECT_EQ(out.width, 640);
  EXPECT_EQ(out.height, 480);
  std::optional<Vec3> point;
  for (const char* text : {"1", "1,2", "1,2,3,4", "1,2,c", "1,,3", "1,2,1e300", "nan,0,0"})
    EXPECT_FALSE(read_point("--from", text, point)) << text;
  EXPECT_TRUE(read_point("--from", "1,-2,0.5", point));
  EXPECT_EQ(point->y, -2);
}

TEST(Flags, CommasWithinParenthesesDoNotSeparate) {
  EXPECT_EQ(split_list("a, max(b, c[1]),d"), (std::vector<std::string>{"a", "max(b, c[1])", "d"}));
  EXPECT_TRUE(split_list(" ").empty());
}

}  // namespace
}  // namespace sandlot::app
