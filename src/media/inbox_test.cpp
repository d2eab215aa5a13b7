/// Inboxes: what was put and what was lent reads, and is saved, alike.
#include "media/inbox.h"

#include <gtest/gtest.h>

#include <string>

namespace sandlot {
namespace {

std::vector<std::uint8_t> bytes_of(std::string_view words) { return {words.begin(), words.end()}; }
std::vector<std::string> words_in(const Inbox& inbox) {
  std::vector<std::string> out;
  for (const Received& each : inbox.items()) out.emplace_back(each.payload().begin(), each.payload().end());
  return out;
}
std::vector<std::byte> saved(const Inbox& inbox) {
  ByteWriter w;
  inbox.save(w);
  return std::move(w.buffer());
}

TEST(Inbox, WhatIsLentReadsAsWhatIsPutAlsoWhenTheLenderHasGoneOn) {
  std::vector<std::uint8_t> memory = bytes_of("lent");
  Inbox lent(0, 10), put(0, 10);
  lent.lend({.at = Time::from_s(1), .emitter = 7}, memory);
  lent.put({.at = Time::from_s(2), .strength = 3}, bytes_of("put"));
  lent.lend({.at = Time::from_s(3)}, memory);
  put.put({.at = Time::from_s(1), .emitter = 7}, bytes_of("lent"));
  put.put({.at = Time::from_s(2), .strength = 3}, bytes_of("put"));
  put.put({.at = Time::from_s(3)}, bytes_of("lent"));
  EXPECT_EQ(saved(lent), saved(put));
  lent.keep();
  memory = bytes_of("gone");
  EXPECT_EQ(words_in(lent), (std::vector<std::string>{"lent", "put", "lent"}));
  EXPECT_EQ(saved(lent), saved(put));
  const std::vector<std::byte> bytes = saved(lent);
  Inbox loaded(0, 10);
  ByteReader r(bytes);
  loaded.load(r);
  EXPECT_TRUE(r.ok() && r.remaining() == 0);
  EXPECT_EQ(saved(loaded), bytes);
  lent.clear();
  lent.put({}, bytes_of("new"));
  lent.lend({}, memory);
  EXPECT_EQ(words_in(lent), (std::vector<std::string>{"new", "gone"}));
}

TEST(Inbox, AFullOneLosesAndCounts) {
  Inbox inbox(0, 2);
  const std::vector<std::uint8_t> memory = bytes_of("x");
  inbox.lend({}, memory);
  EXPECT_FALSE(inbox.put({}, memory).empty());
  EXPECT_TRUE(inbox.put({}, memory).empty());
  inbox.lend({}, memory);
  EXPECT_EQ(inbox.items().size(), 2u);
  EXPECT_EQ(inbox.arrived(), 4u);
  EXPECT_EQ(inbox.lost(), 2u);
  // A snapshot with more than it holds is none.
  const std::vector<std::byte> bytes = saved(inbox);
  Inbox smaller(0, 1);
  ByteReader r(bytes);
  smaller.load(r);
  EXPECT_FALSE(r.ok());
}

}  // namespace
}  // namespace sandlot
