#include "server/http/guesses.h"

#include <gtest/gtest.h>

namespace sandlot::server {
namespace {

using namespace std::chrono_literals;

TEST(Guesses, AreCountedByAddressAndForgivenWithTime) {
  Guesses guesses(3, 2);  // three at once, one more every 2 s
  const Guesses::Clock::time_point begin{};
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(guesses.allowed("10.0.0.1", begin)) << i;
    guesses.count_wrong("10.0.0.1", begin);
  }
  EXPECT_FALSE(guesses.allowed("10.0.0.1", begin));
  EXPECT_TRUE(guesses.allowed("10.0.0.2", begin)) << "another one";
  EXPECT_FALSE(guesses.allowed("10.0.0.1", begin + 1900ms));
  EXPECT_TRUE(guesses.allowed("10.0.0.1", begin + 2100ms));
  guesses.count_wrong("10.0.0.1", begin + 2100ms);
  EXPECT_FALSE(guesses.allowed("10.0.0.1", begin + 2200ms));
  // Never more than at the beginning, however long it was silent.
  for (int i = 0; i < 3; ++i) guesses.count_wrong("10.0.0.1", begin + 24h);
  EXPECT_FALSE(guesses.allowed("10.0.0.1", begin + 24h));
}

TEST(Guesses, KeepABoundedNumberOfAddresses) {
  Guesses guesses(1, 1e6);
  const Guesses::Clock::time_point begin{};
  for (std::size_t i = 0; i < Guesses::most_addresses + 100; ++i)
    guesses.count_wrong("a" + std::to_string(i), begin + std::chrono::microseconds(i));
  EXPECT_EQ(guesses.addresses(), Guesses::most_addresses);
  EXPECT_TRUE(guesses.allowed("a0", begin + 1s)) << "forgotten";
  EXPECT_FALSE(guesses.allowed("a" + std::to_string(Guesses::most_addresses), begin + 1s));
}

}  // namespace
}  // namespace sandlot::server
