#include "server/http/udp_gate.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <vector>

#include "server/http/http.h"

namespace sandlot::server {
namespace {

struct Sip {
  std::uint64_t v0, v1, v2, v3;
  void round() {
    v0 += v1, v1 = std::rotl(v1, 13) ^ v0, v0 = std::rotl(v0, 32);
    v2 += v3, v3 = std::rotl(v3, 16) ^ v2;
    v0 += v3, v3 = std::rotl(v3, 21) ^ v0;
    v2 += v1, v1 = std::rotl(v1, 17) ^ v2, v2 = std::rotl(v2, 32);
  }
  void take(std::uint64_t word) {
    v3 ^= word;
    round();
    round();
    v0 ^= word;
  }
};

std::uint64_t whole(double seconds) { return seconds > 0 ? static_cast<std::uint64_t>(seconds) : 0; }

}  // namespace

std::uint64_t siphash(std::array<std::uint64_t, 2> key, std::span<const std::byte> bytes) {
  Sip sip{key[0] ^ 0x736f6d6570736575u, key[1] ^ 0x646f72616e646f6du, key[0] ^ 0x6c7967656e657261u,
          key[1] ^ 0x7465646279746573u};
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    std::uint64_t word = 0;
    for (std::size_t k = 0; k < 8; ++k) word |= std::to_integer<std::uint64_t>(bytes[i + k]) << (8 * k);
    sip.take(word);
  }
  std::uint64_t last = static_cast<std::uint64_t>(bytes.size()) << 56;
  for (std::size_t k = 0; i + k < bytes.size(); ++k)
    last |= std::to_integer<std::uint64_t>(bytes[i + k]) << (8 * k);
  sip.take(last);
  sip.v2 ^= 0xff;
  for (int k = 0; k < 4; ++k) sip.round();
  return sip.v0 ^ sip.v1 ^ sip.v2 ^ sip.v3;
}

std::string UdpGate::nonce_of(std::span<const std::byte> peer, std::uint64_t slot) const {
  std::vector<std::byte> bytes(peer.begin(), peer.end());
  for (int k = 0; k < 8; ++k) bytes.push_back(static_cast<std::byte>(slot >> (8 * k) & 0xff));
  return fmt::format("{:016x}{:016x}", siphash({keys_[0], keys_[1]}, bytes),
                     siphash({keys_[2], keys_[3]}, bytes));
}

std::string UdpGate::nonce(std::span<const std::byte> peer, double now_s) const {
  return nonce_of(peer, whole(now_s / valid_s));
}

bool UdpGate::is_nonce(std::string_view given, std::span<const std::byte> peer, double now_s) const {
  const std::uint64_t slot = whole(now_s / valid_s);
  const bool present = same_secret(given, nonce_of(peer, slot));
  const bool before = slot > 0 && same_secret(given, nonce_of(peer, slot - 1));
  return present || before;
}

bool UdpGate::allow(std::span<const std::byte> address, double now_s) {
  if (const std::uint64_t second = whole(now_s); second != second_) {
    second_ = second;
    of_all_ = 0;
    counts_.fill(0);
  }
  std::uint8_t& count = counts_[siphash({keys_[0], keys_[3]}, address) % counts_.size()];
  if (count >= most_per_s || of_all_ >= most_per_s_of_all) return false;
  ++count;
  ++of_all_;
  return true;
}

std::string_view nonce_in(std::string_view text) {
  constexpr std::string_view key = "\"nonce\"";
  const std::size_t at = text.find(key);
  if (at == std::string_view::npos) return {};
  text.remove_prefix(at + key.size());
  const auto skip = [&](std::string_view what) {
    text.remove_prefix(std::min(text.find_first_not_of(what), text.size()));
  };
  skip(" \t\r\n");
  if (text.empty() || text.front() != ':') return {};
  text.remove_prefix(1);
  skip(" \t\r\n");
  if (text.empty() || text.front() != '"') return {};
  text.remove_prefix(1);
  return text.substr(0, std::min(text.find('"'), text.size()));
}

}  // namespace sandlot::server
