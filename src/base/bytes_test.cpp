#include "base/bytes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/hash.h"
#include "base/time.h"

namespace sandlot {
namespace {

enum class Colour : std::uint8_t { red = 1, green = 7 };
constexpr EnumName<Colour> colour_names[] = {{"red", Colour::red}, {"green", Colour::green}};
std::span<const EnumName<Colour>> enum_names(Colour) { return colour_names; }

struct Inner {
  double tuned = 1.5;
  int fixed = 2;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"tuned", "m", "", 0, 10, Field::tunable}, s.tuned);
    visit(Field{"fixed", "1", ""}, s.fixed);
  }
};

struct All {
  std::int32_t i = -5;
  double d = 0.1;
  bool b = true;
  Colour c = Colour::green;
  std::string s = "text";
  Time t{123};
  std::vector<float> floats{1.f, 2.f};
  std::vector<bool> bools{true, false, true};
  std::vector<std::string> strings{"a", ""};
  std::vector<Inner> inners{{}, {2.5, 3}};
  std::array<double, 3> array{1, 2, 3};
  std::array<bool, 2> flags{true, false};
  std::optional<double> some = 4, none;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"i", "", ""}, s.i);
    visit(Field{"d", "", ""}, s.d);
    visit(Field{"b", "", ""}, s.b);
    visit(Field{"c", "", ""}, s.c);
    visit(Field{"s", "", ""}, s.s);
    visit(Field{"t", "", ""}, s.t);
    visit(Field{"floats", "", ""}, s.floats);
    visit(Field{"bools", "", ""}, s.bools);
    visit(Field{"strings", "", ""}, s.strings);
    visit(Field{"inners", "", ""}, s.inners);
    visit(Field{"array", "", ""}, s.array);
    visit(Field{"flags", "", ""}, s.flags);
    visit(Field{"some", "", ""}, s.some);
    visit(Field{"none", "", ""}, s.none);
  }
};

std::vector<std::byte> bytes_of(const auto& value) {
  ByteWriter w;
  write(w, value);
  return w.buffer();
}

TEST(Bytes, AreLittleEndianWithLengths) {
  const auto expect = [](const std::vector<std::byte>& bytes, std::initializer_list<int> wanted) {
    std::vector<std::byte> list;
    for (const int b : wanted) list.push_back(static_cast<std::byte>(b));
    EXPECT_EQ(bytes, list);
  };
  expect(bytes_of(std::uint32_t{0x01020304}), {4, 3, 2, 1});
  expect(bytes_of(std::string("ab")), {2, 0, 0, 0, 'a', 'b'});
  expect(bytes_of(std::vector<std::uint8_t>{9}), {1, 0, 0, 0, 9});
  expect(bytes_of(std::optional<std::uint8_t>{}), {0});
  expect(bytes_of(true), {1});
}

TEST(Bytes, ReadBackWhatWasWritten) {
  const All all;
  const auto bytes = bytes_of(all);
  All back;
  All::fields(back, [](const Field&, auto& member) { member = {}; });
  ByteReader r(bytes);
  read(r, back);
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(r.remaining(), 0u);
  EXPECT_EQ(bytes_of(back), bytes);
  EXPECT_EQ(back.strings, all.strings);
  EXPECT_EQ(back.bools, all.bools);
  EXPECT_EQ(back.c, Colour::green);
  EXPECT_EQ(back.some, 4);
  EXPECT_FALSE(back.none);
}

TEST(Bytes, AWriterHasWhatWasWrittenHoweverItWasUsedBefore) {
  const auto text = [](std::span<const std::byte> bytes) {
    return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  ByteWriter w;
  std::string all;
  for (int i = 0; i < 1000; ++i) {  // past several steps of its memory
    const std::string piece(static_cast<std::size_t>(i % 37), static_cast<char>('a' + i % 26));
    w.raw(piece.data(), piece.size());
    all += piece;
    ASSERT_EQ(w.size(), all.size());
  }
  EXPECT_EQ(text(w.bytes()), all);
  w.patch(1, '!');
  all[1] = '!';
  EXPECT_EQ(text(w.bytes()), all);
  EXPECT_EQ(text(w.buffer()), all);
  w.buffer().push_back(std::byte{'z'});
  w.raw("end", 3);
  EXPECT_EQ(text(w.bytes()), all + "zend");
  const ByteWriter copy = w;
  ByteWriter moved = std::move(w);
  EXPECT_EQ(text(copy.bytes()), text(moved.bytes()));
  w.raw("new", 3);  // NOLINT(bugprone-use-after-move): it is empty
  EXPECT_EQ(text(w.bytes()), "new");
  const std::vector<std::byte> taken = std::move(moved.buffer());
  EXPECT_EQ(text(taken), all + "zend");
  moved.raw("x", 1);
  EXPECT_EQ(text(moved.bytes()), "x");
  w.clear();
  EXPECT_EQ(w.size(), 0u);
  w.raw("again", 5);
  EXPECT_EQ(text(w.bytes()), "again");
}

TEST(Bytes, EveryTruncationIsNoticed) {
  const auto bytes = bytes_of(All{});
  for (std::size_t n = 0; n < bytes.size(); ++n) {
    All back;
    ByteReader r{std::span<const std::byte>(bytes).first(n)};
    read(r, back);
    EXPECT_FALSE(r.ok()) << n;
  }
}

TEST(Bytes, ADamagedLengthAsksForNoMemory) {
  const std::vector<std::byte> huge(8, std::byte{0xff});
  ByteReader a(huge), b(huge), c(huge);
  std::vector<double> numbers;
  std::vector<std::string> strings;
  std::string text;
  read(a, numbers);
  read(b, strings);
  read(c, text);
  EXPECT_FALSE(a.ok() || b.ok() || c.ok());
  EXPECT_EQ(numbers.capacity(), 0u);
  EXPECT_EQ(strings.capacity(), 0u);
}

TEST(Bytes, AnEnumeratorThatDoesNotExistIsDamage) {
  const std::byte bad[] = {std::byte{2}};
  ByteReader r(bad);
  Colour colour = Colour::red;
  read(r, colour);
  EXPECT_FALSE(r.ok());
  EXPECT_EQ(colour, Colour::red);
}

TEST(Bytes, OnceFailedStaysFailed) {
  const std::byte two[] = {std::byte{1}, std::byte{2}};
  ByteReader r(two);
  std::uint32_t big = 0;
  std::uint8_t small = 0;
  read(r, big);
  read(r, small);
  EXPECT_FALSE(r.ok());
  EXPECT_EQ(small, 0);
}

struct Outer {
  double a = 1;
  Inner inner;
  std::optional<double> b;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"a", "", "", 0, 10, Field::tunable}, s.a);
    visit(Field{"inner", "", ""}, s.inner);
    visit(Field{"b", "", "", 0, 1, Field::tunable}, s.b);
  }
};

TEST(Bytes, TunablesAreThePartOfASpecThatIsState) {
  Outer outer{5, {6, 7}, 8};
  ByteWriter w;
  write_tunables(w, outer);
  EXPECT_EQ(w.size(), 8u + 8u + 9u);
  Outer back;
  ByteReader r(w.bytes());
  read_tunables(r, back);
  EXPECT_TRUE(r.ok());
  EXPECT_EQ(back.a, 5);
  EXPECT_EQ(back.inner.tuned, 6);
  EXPECT_EQ(back.inner.fixed, 2);  // not State
  EXPECT_EQ(back.b, 8);
}

struct Share {
  double share = 0.5;
  static void fields(auto& s, auto&& visit) { visit(Field{"share", "1", "", 0, 1, Field::tunable}, s.share); }
};

TEST(Bytes, TunablesOutOfTheirRangeAreNoTunables) {
  const auto taken = [](double x) {
    ByteWriter w;
    write(w, x);
    ByteReader r(w.bytes());
    Share spec;
    read_tunables(r, spec);
    return r.ok();
  };
  EXPECT_TRUE(taken(0));
  EXPECT_TRUE(taken(1));
  for (const double x : {-0.001, 1.001, HUGE_VAL, std::nan("")}) EXPECT_FALSE(taken(x)) << x;
}

TEST(Hash, NeverChanges) {
  // Golden: streams and state hashes are keyed by these.
  EXPECT_EQ(mix64(1), 0x5692161d100b05e5u);
  EXPECT_EQ(hash64(""), 0x48218226ff3cd4bfu);
  EXPECT_EQ(hash64("robot1/laser"), 0x2db33a07ebccaabau);
  EXPECT_EQ(hash64("robot1/laser", 7), 0xa1fdb72ae14aecb7u);
  EXPECT_EQ(hash_combine(1, 2), 0xf2826f98653e9e57u);
}

TEST(Hash, EveryInputBitFlipsHalfTheOutput) {
  // 64 output bits x 128 input bits x 64 texts: the mean flip probability has a standard deviation of
  // 0.5 / sqrt(524288) = 0.0007; allow five. Each input bit alone: 0.5 / sqrt(4096) = 0.0078, of 128 bits the
  // worst lies within 4.5 of them.
  double total = 0;
  for (int bit = 0; bit < 128; ++bit) {
    int flips = 0;
    for (std::uint64_t trial = 0; trial < 64; ++trial) {
      std::array<std::uint64_t, 2> words{mix64(trial + 1), mix64(trial + 1000)};
      const std::uint64_t before = hash64(std::as_bytes(std::span(words)));
      words[static_cast<std::size_t>(bit / 64)] ^= 1ull << (bit % 64);
      flips += std::popcount(before ^ hash64(std::as_bytes(std::span(words))));
    }
    EXPECT_NEAR(flips / 4096.0, 0.5, 4.5 * 0.0078) << bit;
    total += flips / 4096.0 / 128;
  }
  EXPECT_NEAR(total, 0.5, 5 * 0.0007);
}

TEST(Hash, TellsZerosOfDifferentLengthApart) {
  std::vector<std::uint64_t> seen;
  const std::vector<std::byte> zeros(64);
  for (std::size_t n = 0; n <= zeros.size(); ++n) seen.push_back(hash64(std::span(zeros).first(n)));
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
}

}  // namespace
}  // namespace sandlot
