/// Bytes of /sandlot/deliveries, read by docs/viewer_protocol.md alone.
#include <gtest/gtest.h>

#include <set>

#include "base/bytes.h"
#include "wire/scene.h"

namespace sandlot::wire {
namespace {

template <class T>
T take_value(ByteReader& r) {
  T value{};
  read(r, value);
  return value;
}

TEST(Deliveries, OfEachPairAndMediumAreOneRecord) {
  std::vector<FrameDelivery> deliveries = {
      {1, 7, 8, 3, -50}, {0, 8, 7, 0, -60}, {1, 7, 8, 4, -40}, {0, 7, 8, 0, 20}};
  std::vector<std::byte> out;
  write_deliveries(deliveries, 7, Time{70'000'000}, out);
  ASSERT_EQ(out.size(), 20u + 3 * 20);
  ByteReader r(out);
  EXPECT_EQ(take_value<std::uint64_t>(r), 7u) << "tick";
  EXPECT_EQ(take_value<std::int64_t>(r), 70'000'000);
  EXPECT_EQ(take_value<std::uint32_t>(r), 3u);
  const auto expect = [&](std::uint32_t sender, std::uint32_t receiver, std::uint16_t medium,
                          std::uint16_t count, std::int32_t channel, float strength) {
    EXPECT_EQ(take_value<std::uint32_t>(r), sender);
    EXPECT_EQ(take_value<std::uint32_t>(r), receiver);
    EXPECT_EQ(take_value<std::uint16_t>(r), medium);
    EXPECT_EQ(take_value<std::uint16_t>(r), count);
    EXPECT_EQ(take_value<std::int32_t>(r), channel) << "of the latest";
    EXPECT_EQ(take_value<float>(r), strength);
  };
  expect(7, 8, 0, 1, 0, 20);
  expect(7, 8, 1, 2, 4, -40);
  expect(8, 7, 0, 1, 0, -60);
}

TEST(Deliveries, OfNoneThereIsTheHeadAlone) {
  std::vector<FrameDelivery> deliveries;
  std::vector<std::byte> out;
  write_deliveries(deliveries, 7, Time{70'000'000}, out);
  EXPECT_EQ(out.size(), 20u);
}

TEST(Deliveries, OfTooManyPairsSomeOfAllSendersAreSent) {
  std::vector<FrameDelivery> deliveries;
  for (std::uint64_t sender = 0; sender < 50; ++sender)
    for (std::uint64_t receiver = 0; receiver < 50; ++receiver)
      deliveries.push_back({0, sender, receiver, 0, 0});
  std::vector<std::byte> out;
  write_deliveries(deliveries, 0, {}, out);
  constexpr std::uint32_t count = 834;  // every third of 2500
  ASSERT_EQ(out.size(), 20u + count * 20);
  ByteReader head(std::span<const std::byte>(out).subspan(16));
  EXPECT_EQ(take_value<std::uint32_t>(head), count);
  std::set<std::uint32_t> senders;
  for (std::uint32_t i = 0; i < count; ++i) {
    ByteReader record(std::span<const std::byte>(out).subspan(20 + 20 * i));
    senders.insert(take_value<std::uint32_t>(record));
  }
  EXPECT_EQ(senders.size(), 50u);
}

}  // namespace
}  // namespace sandlot::wire
