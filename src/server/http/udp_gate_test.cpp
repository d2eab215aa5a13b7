#include "server/http/udp_gate.h"

#include <gtest/gtest.h>

#include <vector>

namespace sandlot::server {
namespace {

std::vector<std::byte> bytes(std::initializer_list<int> all) {
  std::vector<std::byte> out;
  for (const int each : all) out.push_back(static_cast<std::byte>(each));
  return out;
}

/// The vector of the paper's appendix A: key 00 01 ... 0f, message 00 01 ... 0e.
TEST(UdpGate, HashesAsThePaperDoes) {
  std::vector<std::byte> message;
  for (int i = 0; i < 15; ++i) message.push_back(static_cast<std::byte>(i));
  EXPECT_EQ(siphash({0x0706050403020100u, 0x0f0e0d0c0b0a0908u}, message), 0xa129ca6149be45e5u);
}

TEST(UdpGate, ANonceIsGoodForItsAddressAndForAWhile) {
  const UdpGate gate({1, 2, 3, 4}), other({1, 2, 3, 5});
  const auto peer = bytes({127, 0, 0, 1, 0x1f, 0x90}), neighbour = bytes({127, 0, 0, 1, 0x1f, 0x91});
  const std::string nonce = gate.nonce(peer, 1000);
  EXPECT_EQ(nonce.size(), UdpGate::nonce_letters);
  EXPECT_TRUE(gate.is_nonce(nonce, peer, 1000));
  EXPECT_TRUE(gate.is_nonce(nonce, peer, 1019.9)) << "in the slot behind it, too";
  EXPECT_FALSE(gate.is_nonce(nonce, peer, 1020));
  EXPECT_FALSE(gate.is_nonce(nonce, peer, 999)) << "before it was given";
  EXPECT_FALSE(gate.is_nonce(nonce, neighbour, 1000)) << "of another port";
  EXPECT_FALSE(other.is_nonce(nonce, peer, 1000)) << "of another key";
  EXPECT_FALSE(gate.is_nonce("", peer, 1000));
  EXPECT_FALSE(gate.is_nonce(nonce.substr(0, 31), peer, 1000));
}

TEST(UdpGate, ListensToSoManyDatagramsASecond) {
  UdpGate gate({1, 2, 3, 4});
  const auto flood = bytes({10, 0, 0, 1}), quiet = bytes({10, 0, 0, 2});
  int taken = 0;
  for (int i = 0; i < 1000; ++i) taken += gate.allow(flood, 5.5);
  EXPECT_EQ(taken, UdpGate::most_per_s);
  EXPECT_TRUE(gate.allow(quiet, 5.5)) << "another address has an allowance of its own";
  EXPECT_TRUE(gate.allow(flood, 6.0)) << "the next second";
  // From 200 addresses: all together have an end, too.
  taken = 0;
  for (int a = 0; a < 200; ++a)
    for (int i = 0; i < 50; ++i) taken += gate.allow(bytes({192, 168, 0, a}), 8);
  EXPECT_EQ(taken, UdpGate::most_per_s_of_all);
}

TEST(UdpGate, FindsANonceHoweverItIsWritten) {
  EXPECT_EQ(nonce_in(R"({"op":"x","nonce":"ab"})"), "ab");
  EXPECT_EQ(nonce_in("{ \"nonce\" : \n \"ab\" }"), "ab");
  for (const char* none : {"", "{}", R"({"nonce":7})", R"({"nonce")", R"({"nonce":)", "nonce"})
    EXPECT_EQ(nonce_in(none), "") << none;
  EXPECT_EQ(nonce_in(R"({"nonce":"ab)"), "ab") << "an object without its end is refused where it is read";
}

}  // namespace
}  // namespace sandlot::server
