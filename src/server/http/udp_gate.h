#pragma once
/// Gate of the UDP port: who has shown that it receives what is sent to its address, and how much is listened to from others.
///
/// Nonce     a keyed hash of address, port and time: it costs no memory, and another address, or a later time, has another one.
///           Who brings the nonce of its address back has received it. It is the session's key from then on.
/// Limits    of datagrams without a key: so many a second from one address, and from all.
/// Not here  secrecy: who reads the network reads the nonce, as it reads everything else.
/// Source    J.-P. Aumasson, D. J. Bernstein, SipHash: a fast short-input PRF (2012); the cookies of RFC 9000, sec. 8.1.
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sandlot::server {

std::uint64_t siphash(std::array<std::uint64_t, 2> key, std::span<const std::byte> bytes);

class UdpGate {
 public:
  static constexpr std::size_t nonce_letters = 32;
  static constexpr double valid_s = 10;  ///< a nonce is good for that long, and at most twice as long
  static constexpr int most_per_s = 50, most_per_s_of_all = 2000;

  /// @param keys  random and secret
  explicit UdpGate(std::array<std::uint64_t, 4> keys) : keys_(keys) {}

  /// @param peer  bytes of address and port
  std::string nonce(std::span<const std::byte> peer, double now_s) const;
  bool is_nonce(std::string_view given, std::span<const std::byte> peer, double now_s) const;
  /// Takes one datagram without a key from the allowance of its address (without port).
  bool allow(std::span<const std::byte> address, double now_s);

 private:
  std::string nonce_of(std::span<const std::byte> peer, std::uint64_t slot) const;
  std::array<std::uint64_t, 4> keys_;
  std::array<std::uint8_t, 4096> counts_{};  ///< of this second, by hash of the address
  int of_all_ = 0;
  std::uint64_t second_ = 0;
};

/// The value of the first `"nonce"` in a JSON text; "": there is none.
std::string_view nonce_in(std::string_view text);

}  // namespace sandlot::server
