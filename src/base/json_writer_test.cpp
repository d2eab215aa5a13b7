#include "base/json_writer.h"

#include <gtest/gtest.h>

#include <limits>

namespace sandlot {
namespace {

template <class F>
std::string written(F f) {
  std::string out;
  JsonWriter w(out);
  f(w);
  return out;
}

TEST(JsonWriter, SeparatesMembersAndElements) {
  EXPECT_EQ(written([](JsonWriter& w) {
              w.object([&] {
                w.key("a").integer(1);
                w.key("empty").list([] {});
                w.key("none").object([] {});
                w.key("list").list([&] {
                  w.null();
                  w.flag(true);
                  w.object([&] { w.key("b").text("x"); });
                  w.numbers({1, 0.5});
                  w.raw("[7]");
                });
                w.key("names").texts(std::initializer_list<const char*>{"p", "q"});
              });
            }),
            R"({"a":1,"empty":[],"none":{},"list":[null,true,{"b":"x"},[1,0.5],[7]],"names":["p","q"]})");
}

TEST(JsonWriter, WritesNumbersThatReadBackAsTheSame) {
  const auto number = [](double x) { return written([&](JsonWriter& w) { w.number(x); }); };
  const auto real = [](double x) { return written([&](JsonWriter& w) { w.real(x); }); };
  EXPECT_EQ(number(0.1), "0.1");
  EXPECT_EQ(number(2), "2");
  EXPECT_EQ(number(-0.0), "-0.0");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity()), "null");
  EXPECT_EQ(written([](JsonWriter& w) { w.number(0.1f); }), "0.1") << "not that of the double next to it";
  EXPECT_EQ(real(2), "2.0");
  EXPECT_EQ(real(0), "0.0");
  EXPECT_EQ(real(-0.0), "-0.0");
  EXPECT_EQ(real(1e300), "1e+300");
  EXPECT_EQ(real(std::numeric_limits<double>::quiet_NaN()), "null");
  EXPECT_EQ(written([](JsonWriter& w) { w.integer(std::numeric_limits<std::uint64_t>::max()); }),
            "18446744073709551615");
  EXPECT_EQ(written([](JsonWriter& w) { w.integer(std::int8_t{-5}); }), "-5");
}

TEST(JsonWriter, EscapesTexts) {
  const auto text = [](std::string_view x) { return written([&](JsonWriter& w) { w.text(x); }); };
  EXPECT_EQ(text("a \"b\" \\"), R"("a \"b\" \\")");
  EXPECT_EQ(text("\n\t\x01"), R"("\n\t\u0001")");
  EXPECT_EQ(text("\xC3\xA4"), "\"\xC3\xA4\"");
  EXPECT_EQ(text("a\xff"), "\"a\xEF\xBF\xBD\"") << "not UTF-8";
}

}  // namespace
}  // namespace sandlot
