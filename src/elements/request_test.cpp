/// Requests as bytes: what a log holds of each, and what it refuses.
#include "elements/request.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace sandlot {
namespace {

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

model::Instance crate() {
  auto model = std::make_shared<model::Model>();
  model->links.resize(1);
  model::Instance out;
  out.name = "crate";
  out.model = std::move(model);
  return out;
}

/// One of each kind, in the order of logs.
struct Case {
  Request request;
  const char *kind, *target;
};
std::vector<Case> cases() {
  LoadDeviceRequest load{"rover", {}};
  load.device.name = "eye";
  return {
      {CommandRequest{"rover/drive", "geometry_msgs/msg/Twist", bytes_of("abc")}, "command", "rover/drive"},
      {ParameterRequest{"rover/laser", "rate", Node::scalar("5")}, "parameter", "rover/laser"},
      {LevelRequest{"rover/laser", {"ideal", "rays"}}, "level", "rover/laser"},
      {SpawnRequest{crate()}, "spawn", "crate"},
      {DeleteRequest{"crate"}, "delete", "crate"},
      {PoseRequest{"crate", {{1, 2, 3}, {}}}, "pose", "crate"},
      {SampleRequest{"rover/laser"}, "sample", "rover/laser"},
      {load, "load device", "rover"},
      {UnloadDeviceRequest{"rover/eye"}, "unload device", "rover/eye"},
      {PullRequest{"crate", "base", {1, 2, 3}, {4, 5, 6}, Time::from_s(1)}, "pull", "crate"},
      {AnswerRequest{"rover/brain", {OutsideAnswer::Kind::gone, bytes_of("why")}}, "answer", "rover/brain"},
      {CallRequest{"rover/odometry", "reset", bytes_of("cdr")}, "call", "rover/odometry"},
      {VelocityRequest{"crate", {{1, 2, 3}, {4, 5, 6}}}, "velocity", "crate"},
      {InfoRequest{"crate", {}}, "info", "crate"}};
}

TEST(Request, HasItsKindAndTarget) {
  const std::vector<Case> all = cases();
  ASSERT_EQ(all.size(), std::variant_size_v<Request>);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].request.index(), i);
    EXPECT_STREQ(request_kind(i), all[i].kind);
    EXPECT_EQ(request_target(all[i].request), all[i].target);
  }
  EXPECT_STREQ(request_kind(all.size()), "unknown");
}

TEST(Request, ComesBackFromItsBytesAndFromNoFewer) {
  for (const Case& each : cases()) {
    ByteWriter w;
    write_request(w, each.request);
    const std::span<const std::byte> bytes = w.bytes();
    Request back;
    ByteReader r(bytes);
    ASSERT_TRUE(read_request(r, back)) << each.kind;
    ByteWriter again;
    write_request(again, back);
    EXPECT_TRUE(std::ranges::equal(again.bytes(), bytes)) << each.kind;
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      ByteReader cut(bytes.first(size));
      EXPECT_FALSE(read_request(cut, back)) << each.kind << ", " << size << " bytes";
    }
  }
}

// Logs of recordings hold this: the place in the list, then the members in their order, texts with 4 bytes of length.
TEST(Request, OfAPullIsTheseBytes) {
  ByteWriter w;
  write_request(w, PullRequest{"ab", "c", {1, 2, 3}, {4, 5, 6}, Time::from_ns(7)});
  ByteReader r(w.bytes());
  std::uint8_t index = 0;
  std::uint32_t size = 0;
  std::array<char, 2> name{};
  char link = 0;
  read(r, index), read(r, size);
  EXPECT_EQ(index, 9);
  ASSERT_EQ(size, 2u);
  read(r, name), read(r, size);
  EXPECT_EQ(name, (std::array<char, 2>{'a', 'b'}));
  ASSERT_EQ(size, 1u);
  read(r, link);
  EXPECT_EQ(link, 'c');
  for (const double expected : {1, 2, 3, 4, 5, 6}) {
    double number = 0;
    read(r, number);
    EXPECT_EQ(number, expected);
  }
  std::int64_t hold_ns = 0;
  read(r, hold_ns);
  EXPECT_EQ(hold_ns, 7);
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(r.remaining(), 0u);
}

TEST(Request, WithAValueThatIsNoneOfAnEnumerationIsRefused) {
  const auto comes_back = [](const Request& request) {
    ByteWriter w;
    write_request(w, request);
    ByteReader r(w.bytes());
    Request back;
    return read_request(r, back);
  };
  AnswerRequest answer{"rover/brain", {OutsideAnswer::Kind::gone, {}}};
  EXPECT_TRUE(comes_back(answer));
  answer.answer.kind = static_cast<OutsideAnswer::Kind>(static_cast<int>(OutsideAnswer::Kind::late) + 1);
  EXPECT_FALSE(comes_back(answer));
  InfoRequest info{"crate", {}};
  info.info.category = model::Category::static_object;
  EXPECT_TRUE(comes_back(info));
  info.info.category = static_cast<model::Category>(static_cast<int>(model::Category::static_object) + 1);
  EXPECT_FALSE(comes_back(info));
}

}  // namespace
}  // namespace sandlot
