#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "messages/cbor.h"
#include "messages/json.h"
#include "messages/messages.h"
#include "messages/registry.h"
#include "messages/sample.h"
#include "messages/schema.h"
#include "messages/tf2_msgs.h"
#include "messages/topic.h"

namespace sandlot {
namespace {

using Bytes = std::vector<std::byte>;

Bytes bytes(std::string_view hex) {
  Bytes out;
  unsigned value = 0;
  int digits = 0;
  for (const char c : hex) {
    if (c == ' ') continue;
    value = value << 4 | static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10);
    if (++digits % 2 == 0) out.push_back(static_cast<std::byte>(value & 0xFF));
  }
  return out;
}
Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
template <class M>
Bytes cdr_of(const M& message) {
  Bytes out;
  write_cdr(message_info<M>(), &message, out);
  return out;
}
template <class M>
std::string json_of(const M& message) {
  std::string text;
  EXPECT_TRUE(static_cast<bool>(cdr_to_json(message_info<M>(), cdr_of(message), text)));
  return text;
}
template <class M>
Bytes cbor_of(const M& message) {
  Bytes out;
  EXPECT_TRUE(static_cast<bool>(cdr_to_cbor(message_info<M>(), cdr_of(message), out)));
  return out;
}
AnyMessage sample(const MessageInfo& info) {
  AnyMessage message(info);
  int count = 0;
  fill_sample(info, message.data(), count);
  return message;
}
Bytes cdr_of(const AnyMessage& message) {
  Bytes out;
  message.to_cdr(out);
  return out;
}
template <class T>
std::string error_of(const Result<T>& result) {
  return result ? "" : result.error().text();
}
const MessageInfo& info_of(std::string_view name) { return *find_message(name).value(); }
std::string json_error(std::string_view type, std::string_view text) {
  return error_of(message_from_json(info_of(type), text));
}

TEST(Cdr, AHeaderByHand) {
  const msg::Header header{Time::from_ns(1'500'000'000), "abc"};
  // Encapsulation; sec 1; nanosec 500'000'000 = 0x1dcd6500; 4 letters with the NUL.
  EXPECT_EQ(cdr_of(header), bytes("00010000 01000000 0065cd1d 04000000 61626300"));
}

TEST(Cdr, TimesBeforeTheStartAreWholeSecondsRoundedDown) {
  EXPECT_EQ(cdr_of(Time{-1}), bytes("00010000 ffffffff ffc99a3b"));  // -1 s + 999'999'999 ns
  Time back;
  ASSERT_TRUE(static_cast<bool>(read_cdr(message_info<Time>(), cdr_of(Time{-1}), &back)));
  EXPECT_EQ(back.ns, -1);
  EXPECT_EQ(cdr_of(Time{std::numeric_limits<std::int64_t>::max()}), bytes("00010000 ffffff7f ffc99a3b"));
  EXPECT_EQ(cdr_of(Time{std::numeric_limits<std::int64_t>::min()}), bytes("00010000 00000080 00000000"));
}

TEST(Cdr, NumbersAreAlignedFromAfterTheEncapsulation) {
  // "ab": 4 + 3 bytes, so the next 32-bit number waits for 8; uint8 at 12; 3 bytes later the count.
  const msg::PointField field{"ab", 5, 7, 1};
  EXPECT_EQ(cdr_of(field), bytes("00010000 03000000 616200 00 05000000 07 000000 01000000"));
  // A count of 1 at 4, then a double at 8; a sequence without elements ends with its count, without a gap.
  msg::JointState joints;
  joints.position = {1};
  EXPECT_EQ(cdr_of(joints), bytes("00010000 0000000000000000 01000000 00 000000 00000000 01000000"
                                  "000000000000f03f 00000000 00000000"));
}

TEST(Cdr, QuaternionsHaveTheirScalarLast) {
  msg::Transform transform;
  transform.rotation = {1, 2, 3, 4};  // w x y z
  EXPECT_EQ(cdr_of(transform), bytes("00010000 0000000000000000 0000000000000000 0000000000000000"
                                     "0000000000000040 0000000000000840 0000000000001040 000000000000f03f"));
}

TEST(Cdr, AMessageWithoutFieldsIsOneByte) {
  EXPECT_EQ(cdr_of(msg::Empty{}), bytes("00010000 00"));
  EXPECT_EQ(error_of(message_from_cdr(info_of("std_msgs/Empty"), bytes("00010000"))),
            "CDR ends within std_msgs/msg/Empty");
}

TEST(Cdr, BigEndianIsReadToo) {
  const auto message = message_from_cdr(info_of("sensor_msgs/PointField"),
                                        bytes("00000000 00000003 616200 00 00000005 07 000000 00000001"));
  ASSERT_TRUE(static_cast<bool>(message));
  EXPECT_EQ(cdr_of(*message), cdr_of(msg::PointField{"ab", 5, 7, 1}));
  const auto list = message_from_cdr(info_of("std_msgs/Float64MultiArray"),
                                     bytes("00000000 00000000 00000000 00000001 00000000 3ff0000000000000"));
  ASSERT_TRUE(static_cast<bool>(list));
  EXPECT_EQ(list->to_json(), R"({"layout":{"dim":[],"data_offset":0},"data":[1]})");
}

TEST(Cdr, WhatPadsAMessageIsIgnored) {
  const Bytes padded = cdr_of(msg::Bool{true}) + bytes("000000");
  EXPECT_TRUE(static_cast<bool>(message_from_cdr(info_of("std_msgs/Bool"), padded)));
}

TEST(Cdr, LengthsThatCannotBeAreRefusedBeforeMemoryIsTaken) {
  EXPECT_EQ(error_of(message_from_cdr(info_of("std_msgs/String"), bytes("00010000 ffffffff 61"))),
            "CDR ends within 'data', or its length is wrong");
  EXPECT_EQ(error_of(message_from_cdr(info_of("std_msgs/String"), bytes("00010000 02000000 6161"))),
            "CDR ends within 'data', or its length is wrong")
      << "no NUL";
  EXPECT_EQ(error_of(message_from_cdr(info_of("tf2_msgs/TFMessage"), bytes("00010000 ffffff7f"))),
            "CDR ends within 'transforms', or its length is wrong");
  EXPECT_EQ(error_of(message_from_cdr(info_of("std_msgs/Bool"), bytes("00070000 01"))),
            "CDR of encapsulation 7; 0 (big-endian) and 1 (little-endian) are known");
  EXPECT_EQ(error_of(message_from_cdr(info_of("std_msgs/Bool"), bytes("0001"))),
            "CDR ends within its first 4 bytes");
  EXPECT_EQ(message_from_cdr(info_of("std_msgs/Bool"), bytes("00010000 02"))->to_json(), R"({"data":true})");
}

TEST(Cdr, FillingABufferAgainCostsNoHeap) {
  Topic<msg::LaserScan> topic("/x");
  topic.message.ranges.resize(100);
  Bytes buffer;
  topic.to_cdr(buffer);
  const auto* const place = buffer.data();
  const std::size_t size = buffer.size();
  topic.to_cdr(buffer);
  EXPECT_EQ(buffer.data(), place);
  EXPECT_EQ(buffer.size(), size);
}

TEST(Cdr, ATopicTakesAMessageOrKeepsTheOldOne) {
  Topic<msg::Twist> topic("/x");
  topic.message.linear.x = 3;
  Bytes taken = cdr_of(msg::Twist{{1, 2, 3}, {4, 5, 6}});
  EXPECT_FALSE(static_cast<bool>(topic.from_cdr(std::span(taken).first(taken.size() - 1))));
  EXPECT_EQ(topic.message.linear, (Vec3{3, 0, 0}));
  EXPECT_TRUE(static_cast<bool>(topic.from_cdr(taken)));
  EXPECT_EQ(topic.message.angular, (Vec3{4, 5, 6}));
}

TEST(Schema, IsTheTextThatRosKnows) {
  const std::string line(80, '=');
  EXPECT_EQ(message_info<msg::Range>().schema,
            "uint8 ULTRASOUND=0\nuint8 INFRARED=1\nstd_msgs/Header header\nuint8 radiation_type\n"
            "float32 field_of_view\nfloat32 min_range\nfloat32 max_range\nfloat32 range\n" +
                line + "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + line +
                "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
  EXPECT_EQ(
      message_info<msg::PoseWithCovariance>().schema,
      "geometry_msgs/Pose pose\nfloat64[36] covariance\n" + line +
          "\nMSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n" +
          line + "\nMSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n" + line +
          "\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
}

/// What JSON of a std_msgs/...MultiArray without a layout has before its data.
constexpr std::string_view before_data = R"({"layout":{"dim":[],"data_offset":0},)";

TEST(Json, ByHand) {
  EXPECT_EQ(json_of(msg::Header{Time::from_ns(-1), "a\"\\\n\x01\xff\xC3\xA4"}),
            "{\"stamp\":{\"sec\":-1,\"nanosec\":999999999},\"frame_id\":"
            "\"a\\\"\\\\\\n\\u0001\xEF\xBF\xBD\xC3\xA4\"}");
  EXPECT_EQ(json_of(msg::Float32{0.1F}), R"({"data":0.1})");
  EXPECT_EQ(json_of(msg::Float64{-INFINITY}), R"({"data":null})");
  EXPECT_EQ(json_of(msg::UInt64{18446744073709551615U}), R"({"data":18446744073709551615})");
  EXPECT_EQ(json_of(msg::Byte{std::byte{200}}), R"({"data":200})");
  EXPECT_EQ(json_of(msg::Empty{}), "{}");
  // RFC 4648, section 10: "foobar" and its beginnings.
  const auto base64 = [](std::string_view text) {
    return json_of(msg::UInt8MultiArray{{}, {text.begin(), text.end()}}).substr(before_data.size());
  };
  EXPECT_EQ(base64(""), R"("data":""})");
  EXPECT_EQ(base64("f"), R"("data":"Zg=="})");
  EXPECT_EQ(base64("fo"), R"("data":"Zm8="})");
  EXPECT_EQ(base64("foo"), R"("data":"Zm9v"})");
  EXPECT_EQ(base64("foobar"), R"("data":"Zm9vYmFy"})");
}

TEST(Json, KeepsTheSignOfZero) {
  const AnyMessage zero = [] {
    AnyMessage made(info_of("std_msgs/Float64"));
    static_cast<msg::Float64*>(made.data())->data = -0.0;
    return made;
  }();
  EXPECT_EQ(zero.to_json(), R"({"data":-0.0})");
  const auto again = message_from_json(zero.info(), zero.to_json());
  ASSERT_TRUE(again);
  EXPECT_TRUE(std::signbit(static_cast<const msg::Float64*>(again->data())->data));
}

TEST(Json, WhatIsMissingKeepsItsDefault) {
  const auto pose = message_from_json(info_of("geometry_msgs/Pose"), R"({"position":{"y":2}})");
  EXPECT_EQ(pose->to_json(), R"({"position":{"x":0,"y":2,"z":0},"orientation":{"x":0,"y":0,"z":0,"w":1}})");
  EXPECT_EQ(message_from_json(info_of("std_msgs/Header"), R"({"stamp":{"nanosec":5}})")->to_json(),
            R"({"stamp":{"sec":0,"nanosec":5},"frame_id":""})");
}

TEST(Json, ReadsWhatClientsSend) {
  const auto octets = [](std::string_view data) {
    return message_from_json(info_of("std_msgs/UInt8MultiArray"), "{\"data\":" + std::string(data) + "}")
        ->to_json()
        .substr(before_data.size());
  };
  EXPECT_EQ(octets("[102, 111, 111]"), R"("data":"Zm9v"})");
  EXPECT_EQ(octets("\"Zm8\""), R"("data":"Zm8="})");
  EXPECT_EQ(message_from_json(info_of("std_msgs/Int32"), R"({"data":3.0})")->to_json(), R"({"data":3})");
  const auto nan = message_from_json(info_of("std_msgs/Float64"), R"({"data":null})");
  EXPECT_TRUE(std::isnan(static_cast<const msg::Float64*>(nan->data())->data));
}

TEST(Json, ErrorsNamePathAndRemedy) {
  EXPECT_EQ(json_error("geometry_msgs/Twist", R"({"linear":{"w":1}})"),
            "/linear: geometry_msgs/msg/Vector3 has no field 'w'; did you mean 'x'?");
  EXPECT_EQ(json_error("geometry_msgs/TwistStamped", R"({"headr":{}})"),
            "geometry_msgs/msg/TwistStamped has no field 'headr'; did you mean 'header'?");
  EXPECT_EQ(json_error("std_msgs/Int8", R"({"data":128})"), "/data: must be int8, is 128");
  EXPECT_EQ(json_error("std_msgs/Int8", R"({"data":-129})"), "/data: must be int8, is -129");
  EXPECT_EQ(json_error("std_msgs/UInt64", R"({"data":-1})"), "/data: must be uint64, is -1");
  EXPECT_EQ(json_error("std_msgs/Int32", R"({"data":1.5})"), "/data: must be int32, is 1.5");
  EXPECT_EQ(json_error("std_msgs/Float32", R"({"data":1e39})"), "/data: must be float32, is 1e+39");
  EXPECT_EQ(json_error("std_msgs/Bool", R"({"data":1})"), "/data: must be bool, is 1");
  EXPECT_EQ(json_error("std_msgs/String", R"({"data":[]})"), "/data: must be string, is array");
  EXPECT_EQ(json_error("std_msgs/Header", R"({"stamp":{"sec":"x"}})"),
            "/stamp/sec: must be int32, is string");
  EXPECT_EQ(json_error("std_msgs/Header", R"([])"), "must be an object (std_msgs/msg/Header), is array");
  EXPECT_EQ(json_error("sensor_msgs/JointState", R"({"position":[1,true]})"),
            "/position/1: must be float64, is boolean");
  EXPECT_EQ(json_error("geometry_msgs/PoseWithCovariance", R"({"covariance":[1]})"),
            "/covariance: must have 36 elements, has 1");
  EXPECT_EQ(json_error("std_msgs/UInt8MultiArray", R"({"data":"a*bc"})"), "/data: is not base64");
  EXPECT_EQ(json_error("sensor_msgs/JointState", R"({"name":"x"})"),
            "/name: must be a list of string, is string");
  EXPECT_EQ(json_error("std_msgs/Bool", "{").substr(0, 11), "is not JSON");
  const std::string deep(100'000, '[');
  EXPECT_EQ(json_error("std_msgs/Bool", deep).substr(0, 11), "is not JSON");
}

TEST(Cbor, ByHand) {
  // map(1) "data" ...; RFC 8949, appendix A, has most of the values.
  const Bytes data = bytes("a1 64 64617461");
  EXPECT_EQ(cbor_of(msg::Int64{-1000}), data + bytes("3903e7"));
  EXPECT_EQ(cbor_of(msg::Int8{-1}), data + bytes("20"));
  EXPECT_EQ(cbor_of(msg::Int16{24}), data + bytes("1818"));
  EXPECT_EQ(cbor_of(msg::UInt64{18446744073709551615U}), data + bytes("1bffffffffffffffff"));
  EXPECT_EQ(cbor_of(msg::Int64{std::numeric_limits<std::int64_t>::min()}),
            data + bytes("3b7fffffffffffffff"));
  EXPECT_EQ(cbor_of(msg::Float64{1.1}), data + bytes("fb3ff199999999999a"));
  EXPECT_EQ(cbor_of(msg::Float32{100000.0F}), data + bytes("fa47c35000"));
  EXPECT_EQ(cbor_of(msg::Bool{true}), data + bytes("f5"));
  EXPECT_EQ(cbor_of(msg::String{"\xC3\xBC"}), data + bytes("62c3bc"));
  EXPECT_EQ(cbor_of(msg::Float32MultiArray{{}, {1, 2}}),
            bytes("a2 66 6c61796f7574 a2 63 64696d 80 6b 646174615f6f6666736574 00 64 64617461"
                  "d8 55 48 0000803f 00000040"));
}

TEST(Cbor, ReadsOtherWaysOfSayingTheSame) {
  const auto read = [](std::string_view type, std::string_view hex) {
    const auto message = message_from_cbor(info_of(type), bytes("a1 64 64617461") + bytes(hex));
    return message ? message->to_json() : message.error().text();
  };
  EXPECT_EQ(read("std_msgs/Float64", "f93c00"), R"({"data":1})");  // half
  EXPECT_EQ(read("std_msgs/Float64", "f90001"), R"({"data":5.960464477539063e-08})");
  EXPECT_EQ(read("std_msgs/Float64", "f9c400"), R"({"data":-4})");
  EXPECT_EQ(read("std_msgs/Float64", "f97c00"), R"({"data":null})");
  EXPECT_EQ(read("std_msgs/String", "7f 6161 6162 ff"), R"({"data":"ab"})");  // in pieces
  EXPECT_EQ(read("std_msgs/Int32", "c1 05"), R"({"data":5})");                // a tag that means nothing here
  const auto list = [&](std::string_view type, std::string_view hex) {
    const std::string text = read(type, hex);
    return text.substr(std::min(text.size(), before_data.size()));
  };
  EXPECT_EQ(list("std_msgs/Float64MultiArray", "9f 01 f5 ff"), "") << "a bool is not a number";
  EXPECT_EQ(list("std_msgs/Float64MultiArray", "9f 01 02 ff"), R"("data":[1,2]})");
  EXPECT_EQ(list("std_msgs/Float64MultiArray", "d8 51 48 3f800000 40000000"), R"("data":[1,2]})")
      << "big-endian";
  EXPECT_EQ(list("std_msgs/Float64MultiArray", "d8 48 42 01 ff"), R"("data":[1,-1]})") << "from int8";
  EXPECT_EQ(list("std_msgs/UInt16MultiArray", "d8 41 42 0102"), R"("data":[258]})");
  EXPECT_EQ(list("std_msgs/UInt8MultiArray", "43 666f6f"), R"("data":"Zm9v"})");
  EXPECT_EQ(read("std_msgs/UInt8MultiArray", "d8 48 41 ff"), "/data/0: must be uint8, is -1.0");
  EXPECT_EQ(read("std_msgs/Float64MultiArray", "d8 56 47 00000000000000"),
            "/data: is not a whole number of elements");
}

TEST(Cbor, WhatIsNoneIsRefused) {
  const auto error = [](std::string_view hex) { return error_of(parse_cbor(bytes(hex))); };
  EXPECT_EQ(error(""), "CBOR ends too soon");
  EXPECT_EQ(error("1b00"), "CBOR ends too soon");
  EXPECT_EQ(error("5bffffffffffffffff00"), "CBOR ends too soon");
  EXPECT_EQ(error("9bffffffffffffffff00"), "CBOR ends too soon");
  EXPECT_EQ(error("9f00"), "CBOR ends too soon");
  EXPECT_EQ(error("0000"), "bytes go on after the CBOR value");
  EXPECT_EQ(error("a10000"), "CBOR has a key that is not text");
  EXPECT_EQ(error("3bffffffffffffffff"), "CBOR has an integer below -2^63");
  EXPECT_EQ(error("1c"), "is not a CBOR: a head of kind 28");
  EXPECT_EQ(error("1f"), "is not a CBOR: a number without end");
  EXPECT_EQ(error("5f00ff"), "is not a CBOR: a piece of a string");
  EXPECT_EQ(error("ff"), "is not a CBOR: simple value 31");
  std::string deep, tags;
  for (int i = 0; i < 100'000; ++i) deep += "81", tags += "c1";
  EXPECT_EQ(error(deep), "CBOR is nested deeper than 64 levels");
  EXPECT_EQ(error(tags), "CBOR is nested deeper than 64 levels");
}

TEST(Registry, FindsBothFormsOfANameAndTheNearest) {
  EXPECT_EQ(&info_of("sensor_msgs/LaserScan"), &message_info<msg::LaserScan>());
  EXPECT_EQ(&info_of("sensor_msgs/msg/LaserScan"), &message_info<msg::LaserScan>());
  EXPECT_EQ(error_of(find_message("sensor_msgs/LaserScn")),
            "there is no message type 'sensor_msgs/LaserScn'; did you mean 'sensor_msgs/LaserScan'?");
  EXPECT_EQ(error_of(find_message("")), "there is no message type ''");
}

TEST(Registry, EveryNameIsThereOnceAndEveryNestedTypeIsThere) {
  std::set<std::string> names;
  for (const MessageInfo* info : all_messages()) EXPECT_TRUE(names.insert(info->name).second) << info->name;
  for (const MessageInfo* info : all_messages())
    for (const MessageField& field : info->fields)
      EXPECT_TRUE(!field.message || names.contains(field.message->name)) << info->name << " " << field.name;
  EXPECT_EQ(names.count("sensor_msgs/msg/LaserScan"), 1u);
}

class EveryType : public testing::TestWithParam<const MessageInfo*> {
 protected:
  const MessageInfo& info = *GetParam();
  Bytes cdr = cdr_of(sample(info));
};

TEST_P(EveryType, SurvivesCdrJsonAndCbor) {
  const auto from_cdr = message_from_cdr(info, cdr);
  ASSERT_TRUE(static_cast<bool>(from_cdr));
  EXPECT_EQ(cdr_of(*from_cdr), cdr);

  const auto from_json = message_from_json(info, sample(info).to_json());
  ASSERT_TRUE(static_cast<bool>(from_json)) << error_of(from_json);
  EXPECT_EQ(cdr_of(*from_json), cdr);

  Bytes cbor;
  sample(info).to_cbor(cbor);
  const auto from_cbor = message_from_cbor(info, cbor);
  ASSERT_TRUE(static_cast<bool>(from_cbor)) << error_of(from_cbor);
  EXPECT_EQ(cdr_of(*from_cbor), cdr);

  // The library's own reader of CBOR sees the same document, typed arrays and bytes aside.
  const auto theirs = nlohmann::json::from_cbor(cbor, true, true, nlohmann::json::cbor_tag_handler_t::store);
  EXPECT_EQ(theirs, *parse_cbor(cbor));
}

TEST_P(EveryType, EveryTruncationIsRefused) {
  for (std::size_t n = 0; n < cdr.size(); ++n)
    EXPECT_FALSE(static_cast<bool>(message_from_cdr(info, std::span(cdr).first(n)))) << n;
  Bytes cbor;
  sample(info).to_cbor(cbor);
  for (std::size_t n = 0; n < cbor.size(); ++n)
    EXPECT_FALSE(static_cast<bool>(message_from_cbor(info, std::span(cbor).first(n)))) << n;
}

INSTANTIATE_TEST_SUITE_P(Messages, EveryType, testing::ValuesIn(all_messages().begin(), all_messages().end()),
                         [](const auto& param) {
                           std::string name = short_name(param.param->name);
                           for (char& c : name)
                             if (c == '/') c = '_';
                           return name;
                         });

/// For tests/js/messages_test.mjs, which says where to put them; else it is only tried.
TEST(Samples, AreWrittenForOtherReaders) {
  const char* const path = std::getenv("SANDLOT_SAMPLES");
  std::ofstream file(path ? path : "/dev/null");
  for (const MessageInfo* info : all_messages()) {
    const AnyMessage message = sample(*info);
    const Bytes cdr = cdr_of(message);
    std::string hex;
    for (const std::byte b : cdr)
      hex += "0123456789abcdef"[std::to_integer<int>(b) >> 4],
          hex += "0123456789abcdef"[std::to_integer<int>(b) & 15];
    nlohmann::json line{
        {"name", info->name}, {"schema", info->schema}, {"cdr", hex}, {"json", message.to_json()}};
    file << line.dump() << "\n";
  }
  file.close();
  EXPECT_TRUE(file.good());
}

}  // namespace
}  // namespace sandlot
