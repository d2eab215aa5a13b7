#include "messages/command_queue.h"

#include <gtest/gtest.h>

#include <cmath>

#include "messages/command.h"
#include "messages/messages.h"

namespace sandlot {
namespace {

using Words = CommandQueue<msg::String>;

Status order(Words& queue, const char* text) { return queue.assign(command_bytes(msg::String{text})); }

std::vector<std::string> drained(Words& queue) {
  std::vector<std::string> out;
  for (; !queue.empty(); queue.pop()) out.push_back(queue.front().data);
  return out;
}

std::vector<std::byte> saved(const TopicBase& topic) {
  ByteWriter w;
  topic.save(w);
  return w.buffer();
}

bool loads(TopicBase& topic, std::span<const std::byte> bytes) {
  ByteReader r(bytes);
  topic.load(r);
  return r.ok() && r.remaining() == 0;
}

TEST(CommandQueue, HandsOrdersOverInTheirOrderAndRefusesThoseBeyondItsLimit) {
  Words queue("/x/say/command", 3);
  EXPECT_EQ(queue.queue_limit(), 3u);
  for (const char* word : {"a", "b", "c"}) ASSERT_TRUE(order(queue, word));
  const Status full = order(queue, "d");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().what, "the queue of '/x/say/command' is full");
  EXPECT_EQ(queue.waiting(), 3u);
  EXPECT_EQ(queue.front().data, "a");
  queue.pop();
  ASSERT_TRUE(order(queue, "e")) << "around the end of the ring";
  EXPECT_EQ(queue.message.data, "e") << "the latest";
  EXPECT_EQ(drained(queue), (std::vector<std::string>{"b", "c", "e"}));
}

TEST(CommandQueue, TakesWholeOrdersOnly) {
  Words queue("/x/say/command", 3);
  std::vector<std::byte> bytes = command_bytes(msg::String{"hello"});
  bytes.pop_back();
  EXPECT_FALSE(queue.assign(bytes));
  EXPECT_FALSE(queue.check(bytes));
  CommandQueue<msg::Float64> numbers("/x/beep/command", 2);
  EXPECT_FALSE(numbers.assign(command_bytes(msg::Float64{std::nan("")})));
  EXPECT_TRUE(numbers.check(command_bytes(msg::Float64{1})));
  EXPECT_EQ(queue.waiting() + numbers.waiting(), 0u);
}

TEST(CommandQueue, SurvivesSavingWithItsOrders) {
  Words a("/x/say/command", 3), b("/x/say/command", 3), small("/x/say/command", 1);
  for (const char* word : {"a", "b", "c"}) ASSERT_TRUE(order(a, word));
  a.pop();
  ASSERT_TRUE(order(a, "d"));
  a.count = 4;
  ASSERT_TRUE(loads(b, saved(a)));
  EXPECT_EQ(saved(a), saved(b));
  EXPECT_EQ(b.count, 4u);
  const std::unique_ptr<TopicBase> copy = a.clone();
  EXPECT_EQ(saved(*copy), saved(a));
  EXPECT_FALSE(loads(small, saved(a))) << "more orders than its limit";
  EXPECT_EQ(drained(b), (std::vector<std::string>{"b", "c", "d"}));
}

/// The other's place in its own ring means nothing here, wherever this one has got to in its.
TEST(CommandQueue, WhatIsLoadedOrCopiedTakesThePlaceOfWhatWasThere) {
  Words source("/x/say/command", 3), copy("/x/say/command", 3), loaded("/x/say/command", 3),
      small("/x/say/command", 1);
  for (Words* const used : {&source, &copy, &loaded})
    for (const char* word : {"old", "older"}) ASSERT_TRUE(order(*used, word));
  source.pop();
  source.pop();
  for (const char* word : {"a", "b"}) ASSERT_TRUE(order(source, word));  // around the end of the ring
  source.count = 4;
  copy.pop();
  loaded.pop();
  copy.copy_from(source);
  EXPECT_EQ(saved(copy), saved(source));
  EXPECT_EQ(copy.count, 4u);
  EXPECT_EQ(drained(copy), (std::vector<std::string>{"a", "b"}));
  ASSERT_TRUE(loads(loaded, saved(source)));
  EXPECT_EQ(drained(loaded), (std::vector<std::string>{"a", "b"}));
  EXPECT_FALSE(loads(small, saved(source))) << "one more than there is room for";
}

TEST(CommandQueue, RefusesForgedOrders) {
  CommandQueue<msg::Float64> queue("/x/beep/command", 2), other("/x/beep/command", 2);
  ASSERT_TRUE(queue.assign(command_bytes(msg::Float64{1})));
  std::vector<std::byte> bytes = saved(queue);
  const double nan = std::nan("");
  std::memcpy(bytes.data() + bytes.size() - 8, &nan, 8);
  EXPECT_FALSE(loads(other, bytes));
  EXPECT_FALSE(loads(other, std::span(bytes).first(bytes.size() - 4)));
}

}  // namespace
}  // namespace sandlot
