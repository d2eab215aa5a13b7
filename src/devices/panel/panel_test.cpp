#include <gtest/gtest.h>

#include <limits>

#include "devices/test_rig.h"
#include "messages/messages.h"
#include "messages/sensor_images.h"

namespace sandlot {
namespace screen {
extern const Kind kind;
}
namespace keys {
extern const Kind kind;
}
namespace speaker {
extern const Kind kind;
}

namespace {

/// Puts an order into the queue of a device, as a request does.
template <class M>
Status send(test::Rig& rig, const std::string& slot, const M& message) {
  ByteWriter w;
  write(w, message);
  return rig.topics.at("/robot1/" + slot + "/command")->assign(w.buffer());
}

msg::ScreenPatch patch(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height,
                       std::vector<std::uint8_t> data) {
  msg::ScreenPatch made;
  made.x = x;
  made.y = y;
  made.width = width;
  made.height = height;
  made.data = std::move(data);
  return made;
}

void tick(test::Rig& rig) {
  rig.act();
  rig.sense();
}

std::vector<std::uint8_t> pixel(const msg::Image& image, std::size_t x, std::size_t y) {
  const auto at = image.data.begin() + static_cast<std::ptrdiff_t>(image.step * y + 3 * x);
  return {at, at + 3};
}

test::Rig small_screen() {
  test::Rig rig(screen::kind, test::two_wheels());
  Node config = test::config({{"width", "16"}, {"height", "20"}, {"repeat", "0"}});
  Node background = Node::sequence(config.place());
  for (const char* const part : {"0", "1", "0.2"}) background.push(Node::scalar(part, config.place()));
  config.set("background", background);
  const Status added = rig.add("lcd", config);
  SL_CHECK(added);
  return rig;
}

using Bytes = std::vector<std::uint8_t>;

TEST(Screen, HasTheBackgroundWhereNothingWasDrawn) {
  test::Rig rig = small_screen();
  tick(rig);
  const auto& image = rig.topic<msg::Image>("lcd/pixels");
  EXPECT_EQ(image.count, 0u);
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(14, 18, 2, 1, {1, 2, 3, 4, 5, 6})));
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(15, 18, 1, 2, {7, 8, 9, 10, 11, 12})));
  tick(rig);
  ASSERT_EQ(image.count, 1u);
  ASSERT_EQ(image.message.data.size(), 16u * 20 * 3);
  EXPECT_EQ(image.message.encoding, "rgb8");
  EXPECT_EQ(pixel(image.message, 13, 18), (Bytes{0, 255, 51}));  // 255 times 0, 1, 0.2
  EXPECT_EQ(pixel(image.message, 14, 18), (Bytes{1, 2, 3}));
  EXPECT_EQ(pixel(image.message, 15, 18), (Bytes{7, 8, 9}));  // the second one lies above
  EXPECT_EQ(pixel(image.message, 15, 19), (Bytes{10, 11, 12}));
  EXPECT_EQ(pixel(image.message, 14, 19), (Bytes{0, 255, 51}));
  tick(rig);
  EXPECT_EQ(image.count, 1u) << "nothing has changed";
}

TEST(Screen, RefusesWhatDoesNotFit) {
  test::Rig rig = small_screen();
  constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(15, 0, 2, 1, Bytes(6))));        // over the right edge
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(0, 20, 1, 1, Bytes(3))));        // below
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(most, most, 1, 1, Bytes(3))));   // x + width wraps to 0
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(0, 0, 2, 2, Bytes(11))));        // a byte is missing
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(0, 0, most, most, Bytes(12))));  // 3 (2^32 - 1)^2 wraps to 3
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(0, 0, 0, 0, Bytes(3))));         // pixels of nothing
  msg::ScreenPatch with_text = patch(0, 0, 1, 1, Bytes(4));
  with_text.has_text = true;
  with_text.lines = {"lost"};
  ASSERT_TRUE(send(rig, "lcd/pixels", with_text));
  tick(rig);
  EXPECT_EQ(rig.topic<msg::Image>("lcd/pixels").count, 0u);
  EXPECT_EQ(rig.topic<msg::ScreenText>("lcd/text").count, 0u);
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(0, 0, 16, 20, Bytes(16 * 20 * 3, 9))));
  tick(rig);
  EXPECT_EQ(rig.topic<msg::Image>("lcd/pixels").message.data, Bytes(16 * 20 * 3, 9));
}

TEST(Screen, KeepsTextWithinItsLimits) {
  test::Rig rig = small_screen();
  msg::ScreenPatch text;
  text.has_text = true;
  text.lines.assign(300, "x");
  // 399 bytes and a character of two: the cut at 400 lies within the character.
  text.lines[0].assign(399, 'a');
  text.lines[0] += "\xc3\xa4";
  text.menu = {"GO", "", "", "END"};
  ASSERT_TRUE(send(rig, "lcd/pixels", text));
  tick(rig);
  const auto& shown = rig.topic<msg::ScreenText>("lcd/text");
  ASSERT_EQ(shown.count, 1u);
  ASSERT_EQ(shown.message.lines.size(), 200u);
  EXPECT_EQ(shown.message.lines[0], std::string(399, 'a'));
  EXPECT_EQ(shown.message.menu, (std::vector<std::string>{"GO", "", "", "END"}));
  EXPECT_EQ(rig.topic<msg::Image>("lcd/pixels").count, 0u);
}

TEST(Screen, ChangesOnlyWhenAPatchComes) {
  test::Rig rig = small_screen();
  ASSERT_EQ(rig.pool->changes(0), std::optional<std::uint64_t>(0));
  tick(rig);
  EXPECT_EQ(rig.pool->changes(0), std::optional<std::uint64_t>(0));
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(0, 0, 1, 1, Bytes(3))));
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(99, 0, 1, 1, Bytes(3))));
  tick(rig);
  EXPECT_EQ(rig.pool->changes(0), std::optional<std::uint64_t>(2));
}

TEST(Screen, RefusesAStateOfAnotherSize) {
  test::Rig rig = small_screen();
  ASSERT_TRUE(send(rig, "lcd/pixels", patch(0, 0, 1, 1, Bytes(3, 7))));
  tick(rig);
  test::Rig other(screen::kind, test::two_wheels());
  ASSERT_TRUE(other.add("lcd", test::config({{"width", "17"}, {"height", "20"}})));
  const std::vector<std::byte> saved = rig.saved();
  ByteReader reader(saved);
  other.pool->load(0, reader);
  EXPECT_FALSE(reader.ok());
  test::Rig same = small_screen();
  same.load(rig.saved());
  EXPECT_TRUE(same.pool->fits(0));
  EXPECT_EQ(same.saved(), rig.saved());
}

test::Rig four_keys() {
  test::Rig rig(keys::kind, test::two_wheels());
  const Status added = rig.add("keys", test::config({}));
  SL_CHECK(added);
  return rig;
}

TEST(Keys, KeepsTheLastSixteenInTheirOrder) {
  test::Rig rig = four_keys();
  const auto& pressed = rig.topic<msg::KeyPresses>("keys/presses");
  tick(rig);
  EXPECT_EQ(pressed.count, 0u);
  // Of 18 presses the first two are gone: press i has key 1 + i % 4.
  for (std::uint32_t i = 0; i < 18; ++i)
    ASSERT_TRUE(send(rig, "keys/presses", msg::KeyPress{1 + i % 4, 5, 5}));
  tick(rig);
  ASSERT_EQ(pressed.count, 1u);
  EXPECT_EQ(pressed.message.count, 18u);
  ASSERT_EQ(pressed.message.latest.size(), 16u);
  for (std::uint32_t i = 0; i < 16; ++i) {
    EXPECT_EQ(pressed.message.latest[i].key, 1 + (i + 2) % 4) << i;
    EXPECT_EQ(pressed.message.latest[i].x, 0) << "a key has no place";
  }
  ASSERT_TRUE(send(rig, "keys/presses", msg::KeyPress{0, 12, 34}));
  tick(rig);
  EXPECT_EQ(pressed.message.count, 19u);
  EXPECT_EQ(pressed.message.latest.back().key, 0u);
  EXPECT_EQ(pressed.message.latest.back().x, 12);
  EXPECT_EQ(pressed.message.latest.back().y, 34);
}

TEST(Keys, RefusesKeysThatDoNotExist) {
  test::Rig rig = four_keys();
  ASSERT_TRUE(send(rig, "keys/presses", msg::KeyPress{5, 0, 0}));
  tick(rig);
  EXPECT_EQ(rig.topic<msg::KeyPresses>("keys/presses").count, 0u);
  test::Rig dull(keys::kind, test::two_wheels());
  ASSERT_TRUE(dull.add("keys", test::config({{"touch", "false"}, {"count", "5"}})));
  ASSERT_TRUE(send(dull, "keys/presses", msg::KeyPress{0, 1, 1}));
  ASSERT_TRUE(send(dull, "keys/presses", msg::KeyPress{5, 0, 0}));
  tick(dull);
  EXPECT_EQ(dull.topic<msg::KeyPresses>("keys/presses").message.count, 1u);
}

test::Rig loud() {
  test::Rig rig(speaker::kind, test::two_wheels(), 0.01);
  const Status added = rig.add("speaker", test::config({{"max_duration", "2"}}));
  SL_CHECK(added);
  return rig;
}

msg::Sound sound(double frequency, double duration, std::string name = "") {
  msg::Sound made;
  made.frequency = frequency;
  made.duration = duration;
  made.name = std::move(name);
  return made;
}

/// Number of ticks after that of the order in which the sound still lasts at the end.
int ticks_until_silence(test::Rig& rig) {
  const auto& state = rig.topic<msg::SpeakerState>("speaker/sound");
  int ticks = 0;
  for (tick(rig); state.message.playing && ticks < 1000; tick(rig)) ++ticks;
  return ticks;
}

TEST(Speaker, PlaysForTheDuration) {
  test::Rig rig = loud();
  const auto& state = rig.topic<msg::SpeakerState>("speaker/sound");
  tick(rig);
  EXPECT_EQ(state.count, 0u);
  // From the beginning of a tick of 10 ms: 25 ms end within the third tick, so two end while it lasts.
  rig.command("speaker/sound", sound(440, 0.025));
  EXPECT_EQ(ticks_until_silence(rig), 2);
  EXPECT_EQ(state.count, 2u) << "begin and end";
  EXPECT_EQ(state.message.sounds, 1u);
  EXPECT_EQ(state.message.sound.frequency, 440);
  // 30 ms end with the third tick.
  rig.command("speaker/sound", sound(440, 0.03));
  EXPECT_EQ(ticks_until_silence(rig), 2);
  // 2 s at most.
  rig.command("speaker/sound", sound(440, 1e300));
  EXPECT_EQ(ticks_until_silence(rig), 199);
  EXPECT_EQ(state.message.sound.duration, 2);
}

TEST(Speaker, EndsTheSoundBefore) {
  test::Rig rig = loud();
  const auto& state = rig.topic<msg::SpeakerState>("speaker/sound");
  rig.command("speaker/sound", sound(440, 1));
  tick(rig);
  EXPECT_TRUE(state.message.playing);
  rig.command("speaker/sound", sound(0, 0.5, "hello.wav"));
  tick(rig);
  EXPECT_EQ(state.message.sounds, 2u);
  EXPECT_EQ(state.message.sound.name, "hello.wav");
  for (const double silent : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    rig.command("speaker/sound", sound(440, 1));
    tick(rig);
    ASSERT_TRUE(state.message.playing);
    rig.command("speaker/sound", sound(440, silent));
    tick(rig);
    EXPECT_FALSE(state.message.playing) << silent;
  }
  rig.command("speaker/sound", sound(0, 1, std::string(201, 'n')));
  tick(rig);
  EXPECT_FALSE(state.message.playing);
  EXPECT_EQ(state.message.sounds, 5u);
}

}  // namespace
}  // namespace sandlot
