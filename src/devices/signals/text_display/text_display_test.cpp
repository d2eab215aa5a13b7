#include "devices/signals/text_display/text_display.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"
#include "messages/command.h"

namespace sandlot::text_display {
namespace {

using test::config;
using test::Rig;

struct Screen : Rig {
  Screen() : Rig(kind, test::two_wheels()) {
    const Status added = add("screen", config({{"rows", "3"}, {"columns", "5"}, {"rate", "0"}}));
    EXPECT_TRUE(added) << added.error().text();
  }
  Status order(const std::string& text) {
    TopicBase& slot = *topics.at("/robot1/screen/text/command");
    return slot.assign(command_bytes(msg::String{text}));
  }
  const std::string& shown() {
    act();
    sense();
    return static_cast<Topic<msg::String>&>(*topics.at("/robot1/screen/text")).message.data;
  }
};

TEST(TextDisplay, PrintsAllOrdersOfATickInTheirOrder) {
  Screen screen;
  EXPECT_EQ(screen.shown(), "");
  ASSERT_TRUE(screen.order("ab") && screen.order("c\n") && screen.order("d"));
  EXPECT_EQ(screen.shown(), "abc\nd");
  EXPECT_EQ(screen.shown(), "abc\nd") << "each is printed once";
  for (int i = 0; i < 64; ++i) ASSERT_TRUE(screen.order("x"));
  EXPECT_FALSE(screen.order("x")) << "the queue is full";
}

TEST(TextDisplay, WrapsScrollsAndClears) {
  Screen screen;
  ASSERT_TRUE(screen.order("1234567\nab"));
  EXPECT_EQ(screen.shown(), "12345\n67\nab");
  ASSERT_TRUE(screen.order("\ncd\n"));
  EXPECT_EQ(screen.shown(), "ab\ncd\n");
  ASSERT_TRUE(screen.order("\fnew"));
  EXPECT_EQ(screen.shown(), "new");
  ASSERT_TRUE(screen.order("\f\xc3\xa4\xc3\xb6\xc3\xbc\xc3\x9f\xe2\x82\xac!\a\x7f"));
  EXPECT_EQ(screen.shown(), "\xc3\xa4\xc3\xb6\xc3\xbc\xc3\x9f\xe2\x82\xac\n!")
      << "five characters, twelve bytes";
  ASSERT_TRUE(screen.order("\f" + std::string(1000, '\x80')));
  EXPECT_LE(screen.shown().size(), 20u) << "bytes that are not characters";
}

TEST(TextDisplay, IsClearedByItsService) {
  Screen screen;
  ASSERT_TRUE(screen.order("hello"));
  EXPECT_EQ(screen.shown(), "hello");
  std::vector<std::byte> asked, answer;
  msg::std_srvs::Trigger::Request nothing;
  write_cdr(message_info<msg::std_srvs::Trigger::Request>(), &nothing, asked);
  ASSERT_TRUE(screen.pool->call(0, **service_of(kind, "robot1/screen", "clear"), asked, answer,
                                screen.context(screen.now)));
  EXPECT_EQ(screen.shown(), "");
}

TEST(TextDisplay, StateSurvivesSavingAndForgedScreensAreRefused) {
  Screen a, b;
  ASSERT_TRUE(a.order("hello\nyou"));
  EXPECT_EQ(a.shown(), "hello\nyou");
  b.load(a.saved());
  EXPECT_EQ(b.shown(), "hello\nyou");
  EXPECT_EQ(a.saved(), b.saved());
  const auto loads = [&](const State& state) {
    ByteWriter w;
    write(w, state);
    ByteReader r(w.bytes());
    b.pool->load(0, r);
    return r.ok();
  };
  EXPECT_TRUE(loads({{"a", "b", "c"}}));
  EXPECT_FALSE(loads({{"a", "b", "c", "d"}})) << "more rows than the screen has";
  EXPECT_FALSE(loads({{std::string(21, 'x')}}));
}

}  // namespace
}  // namespace sandlot::text_display
