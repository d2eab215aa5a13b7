#pragma once
/// 64-bit hashing of bytes: for state hashes, stable keys of names and streams of random numbers.
///
/// The value is part of what Sandlot promises to keep (golden hashes, random streams keyed by name), so the
/// function never changes. It is not meant to withstand an adversary.
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace sandlot {

/// The finaliser of SplitMix64: a bijection in which every input bit affects every output bit.
constexpr std::uint64_t mix64(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9u;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebu;
  x ^= x >> 31;
  return x;
}

/// Hash of a byte sequence: mixes eight little-endian bytes at a time, then the length.
inline std::uint64_t hash64(std::span<const std::byte> bytes, std::uint64_t seed = 0) {
  static_assert(std::endian::native == std::endian::little, "state bytes are little-endian");
  std::uint64_t h = mix64(seed ^ 0x9e3779b97f4a7c15u);
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    std::uint64_t word;
    std::memcpy(&word, bytes.data() + i, 8);
    h = mix64(h ^ word) + 0x9e3779b97f4a7c15u;
  }
  std::uint64_t tail = 0;
  if (i < bytes.size()) std::memcpy(&tail, bytes.data() + i, bytes.size() - i);
  return mix64(h ^ tail ^ (static_cast<std::uint64_t>(bytes.size()) << 56) ^ bytes.size());
}

inline std::uint64_t hash64(std::string_view text, std::uint64_t seed = 0) {
  return hash64(std::as_bytes(std::span(text)), seed);
}

/// Combines a running hash with one more value; order matters.
constexpr std::uint64_t hash_combine(std::uint64_t h, std::uint64_t value) {
  return mix64(h ^ mix64(value + 0x9e3779b97f4a7c15u));
}

}  // namespace sandlot
