/// Checksum of MCAP. Every byte of a recording is summed twice, in its chunk and in the file, so that with images in it,
/// which are hardly compressed, zlib's would cost more than the compression.
///
/// Source   V. Gopal et al., "Fast CRC Computation for Generic Polynomials Using PCLMULQDQ Instruction", Intel 2009: the
///          bit-reflected form, with the constants of its section on the polynomial of gzip.
#include <immintrin.h>
#include <zlib.h>

#include "record/mcap/codec.h"

namespace sandlot::mcap {
namespace {

/// `data` times the two powers of x in `k`, plus `next`: moves 128 bits of remainder on to where `next` lies.
[[gnu::target("pclmul,sse4.1")]] inline __m128i fold(__m128i data, __m128i k, __m128i next) {
  return _mm_xor_si128(
      _mm_xor_si128(_mm_clmulepi64_si128(data, k, 0x00), _mm_clmulepi64_si128(data, k, 0x11)), next);
}

inline __m128i load_block(const std::byte* from) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
}

/// @param size  at least 64 and a multiple of 16
/// @param crc   inverted, and so is the result
[[gnu::target("pclmul,sse4.1")]] std::uint32_t crc32_folded(const std::byte* at, std::size_t size,
                                                            std::uint32_t crc) {
  const __m128i by_64 = _mm_set_epi64x(0x01c6e41596, 0x0154442bd4);
  const __m128i by_16 = _mm_set_epi64x(0x00ccaa009e, 0x01751997d0);
  __m128i a = _mm_xor_si128(load_block(at), _mm_cvtsi32_si128(static_cast<int>(crc)));
  __m128i b = load_block(at + 16), c = load_block(at + 32), d = load_block(at + 48);
  for (at += 64, size -= 64; size >= 64; at += 64, size -= 64) {
    a = fold(a, by_64, load_block(at));
    b = fold(b, by_64, load_block(at + 16));
    c = fold(c, by_64, load_block(at + 32));
    d = fold(d, by_64, load_block(at + 48));
  }
  a = fold(fold(fold(a, by_16, b), by_16, c), by_16, d);
  for (; size >= 16; at += 16, size -= 16) a = fold(a, by_16, load_block(at));
  // 128 bits to 64, then Barrett's reduction to 32.
  const __m128i low = _mm_setr_epi32(~0, 0, ~0, 0);
  a = _mm_xor_si128(_mm_srli_si128(a, 8), _mm_clmulepi64_si128(a, by_16, 0x10));
  a = _mm_xor_si128(_mm_clmulepi64_si128(_mm_and_si128(a, low), _mm_set_epi64x(0, 0x0163cd6124), 0x00),
                    _mm_srli_si128(a, 4));
  const __m128i polynomial = _mm_set_epi64x(0x01f7011641, 0x01db710641);
  __m128i quotient = _mm_clmulepi64_si128(_mm_and_si128(a, low), polynomial, 0x10);
  quotient = _mm_clmulepi64_si128(_mm_and_si128(quotient, low), polynomial, 0x00);
  return static_cast<std::uint32_t>(_mm_extract_epi32(_mm_xor_si128(a, quotient), 1));
}

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) {
  static const bool has_pclmul = __builtin_cpu_supports("pclmul") && __builtin_cpu_supports("sse4.1");
  if (has_pclmul && bytes.size() >= 64) {
    const std::size_t folded = bytes.size() & ~std::size_t{15};
    before = ~crc32_folded(bytes.data(), folded, ~before);
    bytes = bytes.subspan(folded);
  }
  if (bytes.empty()) return before;  // zlib begins again at a null pointer
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace sandlot::mcap
