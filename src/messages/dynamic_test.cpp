#include "messages/dynamic.h"

#include <gtest/gtest.h>

#include "messages/cdr.h"
#include "messages/json.h"
#include "messages/messages.h"
#include "messages/registry.h"
#include "messages/sample.h"

namespace sandlot::dynamic_test {
namespace {

using Bytes = std::vector<std::byte>;

std::string error_of(std::string_view text, std::string_view type = "my_msgs/msg/Thing") {
  const auto schema = DynamicSchema::parse(type, text);
  return schema ? "" : schema.error().text();
}
std::string text_of(const MessageValue& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(v)>, std::string_view>)
          return std::string(v);
        else return std::to_string(v);
      },
      value);
}
std::vector<std::string> values_of(const MessageInfo& info, const Bytes& cdr) {
  std::vector<std::string> out;
  const Status done = visit_values(info, cdr, [&](std::string_view path, const MessageValue& value) {
    out.push_back(std::string(path) + "=" + text_of(value));
  });
  EXPECT_TRUE(static_cast<bool>(done));
  return out;
}
const std::string line(80, '=');

TEST(Dynamic, OurSchemasReadOurBytesAsWeDo) {
  for (const MessageInfo* info : all_messages()) {
    const auto schema = DynamicSchema::parse(info->name, info->schema);
    ASSERT_TRUE(static_cast<bool>(schema)) << info->name << ": " << schema.error().text();
    EXPECT_EQ(schema->info().least, info->least) << info->name;
    AnyMessage message(*info);
    int count = 0;
    fill_sample(*info, message.data(), count);
    Bytes cdr;
    message.to_cdr(cdr);
    std::string json;
    EXPECT_TRUE(static_cast<bool>(cdr_to_json(schema->info(), cdr, json)));
    EXPECT_EQ(json, message.to_json()) << info->name;
  }
}

TEST(Dynamic, ReadsWhatOthersWrite) {
  const auto schema = DynamicSchema::parse("my_msgs/Thing",
                                           "# a comment\r\n\r\n"
                                           "uint8 SMALL=1 # one\n"
                                           "string WORD='a # b'\n"
                                           "Header header\n"  // of std_msgs, and the schema leaves it out
                                           "duration[<=2] waits\n"
                                           "Part[2] parts # its own package\n"
                                           "string<=5 word \"x y\"\n"
                                           "int8 last -1\n" +
                                               line + "\nMSG: my_msgs/Part\nbool on true\n" + line +
                                               "\nMSG: my_msgs/Part\nfloat64 twice\n");
  ASSERT_TRUE(static_cast<bool>(schema)) << schema.error().text();
  // Header: 1 s, 2 ns, "a"; one wait of 3 s 4 ns; true, false; "hi"; -1.
  const Bytes cdr = [] {
    Bytes out;
    for (const int b :
         std::initializer_list<int>{0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 'a', 0, 0,   0,   1, 0,
                                    0, 0, 3, 0, 0, 0, 4, 0, 0, 0, 1, 0, 0, 0, 3, 0, 0,   0, 'h', 'i', 0, 255})
      out.push_back(static_cast<std::byte>(b));
    return out;
  }();
  EXPECT_EQ(values_of(schema->info(), cdr),
            (std::vector<std::string>{"header.stamp=1.000000", "header.frame_id=a", "waits[0]=3.000000",
                                      "parts[0].on=1", "parts[1].on=0", "word=hi", "last=-1"}));
  EXPECT_EQ(schema->info().constants.size(), 2u);
  std::string json;
  EXPECT_TRUE(static_cast<bool>(cdr_to_json(schema->info(), cdr, json)));
  EXPECT_EQ(json,
            R"({"header":{"stamp":{"sec":1,"nanosec":2},"frame_id":"a"},"waits":[{"sec":3,"nanosec":4}],)"
            R"("parts":[{"on":true},{"on":false}],"word":"hi","last":-1})");
}

TEST(Dynamic, PathsTellEveryElement) {
  msg::JointState joints;
  joints.name = {"a", "b"};
  joints.position = {1, 2};
  Bytes cdr;
  write_cdr(message_info<msg::JointState>(), &joints, cdr);
  EXPECT_EQ(values_of(message_info<msg::JointState>(), cdr),
            (std::vector<std::string>{"header.stamp=0.000000", "header.frame_id=", "name[0]=a", "name[1]=b",
                                      "position[0]=1.000000", "position[1]=2.000000"}));
}

TEST(Dynamic, TimesAreSeconds) {
  const auto seconds = [](Time stamp) {
    double found = 0;
    msg::Header header{stamp, ""};
    Bytes cdr;
    write_cdr(message_info<msg::Header>(), &header, cdr);
    const Status done = visit_values(message_info<msg::Header>(), cdr,
                                     [&](std::string_view path, const MessageValue& value) {
                                       if (path == "stamp") found = std::get<double>(value);
                                     });
    EXPECT_TRUE(static_cast<bool>(done));
    return found;
  };
  EXPECT_EQ(seconds(Time::from_ns(2'000'000'001)), 2.000000001);
  EXPECT_EQ(seconds(Time::from_ns(-250'000'000)), -0.25);
}

TEST(Dynamic, ATypeThatOnlyCallsItselfATimeIsNone) {
  const auto schema = DynamicSchema::parse(
      "a/A", "time t\n" + line + "\nMSG: builtin_interfaces/Time\nbool[2] sec\nuint32 nanosec\n");
  ASSERT_TRUE(static_cast<bool>(schema));
  const Bytes cdr{{}, std::byte{1}, {}, {}, std::byte{1}, {}, {}, {}, std::byte{7}, {}, {}, {}};
  EXPECT_EQ(values_of(schema->info(), cdr),
            (std::vector<std::string>{"t.sec[0]=1", "t.sec[1]=0", "t.nanosec=7"}));
}

TEST(Dynamic, ASequenceLongerThanItsBoundIsRefused) {
  const auto schema = DynamicSchema::parse("a/A", "uint8[<=2] few\n");
  const auto read = [&](int count) {
    Bytes cdr{{}, std::byte{1}, {}, {}, static_cast<std::byte>(count), {}, {}, {}, {}, {}, {}};
    std::string json;
    const Status done = cdr_to_json(schema->info(), cdr, json);
    return done ? json : done.error().text();
  };
  EXPECT_EQ(read(2), R"({"few":"AAA="})");
  EXPECT_EQ(read(3), "CDR ends within 'few', or its length is wrong");
}

TEST(Dynamic, ErrorsNameTheLine) {
  EXPECT_EQ(error_of("bool a\nOther b\n"), "schema, line 2: type 'my_msgs/Other' is not in the schema");
  EXPECT_EQ(error_of("sensor_msgs/LaserScn b\n"),
            "schema, line 1: type 'sensor_msgs/LaserScn' is not in the schema");
  EXPECT_EQ(error_of("Thing b\n"), "schema: 'my_msgs/msg/Thing' contains itself");
  EXPECT_EQ(error_of("A a\n" + line + "\nMSG: my_msgs/A\nB b\n" + line + "\nMSG: my_msgs/B\nA[] a\n"),
            "schema: 'my_msgs/msg/A' contains itself");
  EXPECT_EQ(error_of("bool a\nint8 a\n"), "schema, line 2: two fields 'a'");
  EXPECT_EQ(error_of("bool\n"), "schema, line 1: 'bool' is not a field");
  EXPECT_EQ(error_of("bool a-b\n"), "schema, line 1: 'a-b' is not a name of a field");
  EXPECT_EQ(error_of("wstring a\n"), "schema, line 1: wide strings are not supported");
  EXPECT_EQ(error_of("bool[ a\n"), "schema, line 1: a list without ']'");
  EXPECT_EQ(error_of("bool[0] a\n"), "schema, line 1: '0' is not a length of a list");
  EXPECT_EQ(error_of("bool[-1] a\n"), "schema, line 1: '-1' is not a length of a list");
  EXPECT_EQ(error_of("bool[99999999999] a\n"), "schema, line 1: '99999999999' is not a length of a list");
  EXPECT_EQ(error_of("int8<=3 a\n"), "schema, line 1: 'int8<=3' is not a bounded string");
  EXPECT_EQ(error_of("Header A=3\n"), "schema, line 1: 'Header' is not a type of a constant");
  EXPECT_EQ(error_of(line + "\nbool a\n"), "schema, line 2: 'bool a' where 'MSG: pkg/Type' should be");
  EXPECT_EQ(error_of(line), "schema, line 1: ends where 'MSG: pkg/Type' should be");
  EXPECT_EQ(error_of(line + "\nMSG: A\n"), "schema, line 2: 'A' is not a name of a type");
  EXPECT_EQ(error_of("bool a\n", "Thing"), "'Thing' is not a name of a message type");
  EXPECT_EQ(error_of(std::string(1'000'001, '\n')), "schema, line 0: is longer than 1 MB");
}

TEST(Dynamic, LimitsHold) {
  std::string fields, types, chain;
  for (int i = 0; i <= 10'000; ++i) fields += "bool f" + std::to_string(i) + "\n";
  EXPECT_EQ(error_of(fields), "schema, line 10001: more than 10000 fields");
  for (int i = 0; i < 1000; ++i) types += "===\nMSG: a/T" + std::to_string(i) + "\n";
  EXPECT_EQ(error_of(types), "schema, line 2000: more than 1000 types");
  const auto nested = [](int depth) {  // `depth` types below the first one
    std::string text = "T1 t\n";
    for (int i = 1; i <= depth; ++i)
      text += "===\nMSG: my_msgs/T" + std::to_string(i) + "\n" +
              (i < depth ? "T" + std::to_string(i + 1) + " t\n" : "bool t\n");
    return text;
  };
  EXPECT_EQ(error_of(nested(31)), "");
  EXPECT_EQ(error_of(nested(32)), "schema: types nest deeper than 32 in 'my_msgs/msg/Thing'");
  EXPECT_EQ(error_of(nested(900)), "schema: types nest deeper than 32 in 'my_msgs/msg/T868'");
  // 20 lists of lists ... of one bool: a value of 2^400 bytes, which no bytes can be. Asked in vain, at once.
  std::string bomb = "T1[1000000] t\n";
  for (int i = 1; i <= 20; ++i)
    bomb += "===\nMSG: my_msgs/T" + std::to_string(i) + "\n" +
            (i < 20 ? "T" + std::to_string(i + 1) + "[1000000] t\n" : "bool t\n");
  const auto schema = DynamicSchema::parse("my_msgs/Thing", bomb);
  ASSERT_TRUE(static_cast<bool>(schema));
  std::string json;
  EXPECT_FALSE(static_cast<bool>(cdr_to_json(schema->info(), Bytes{{}, std::byte{1}, {}, {}, {}}, json)));
}

}  // namespace
}  // namespace sandlot::dynamic_test
