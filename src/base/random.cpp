#include "base/random.h"

#include <Random123/philox.h>

#include "base/check.h"
#include "base/math.h"

namespace sandlot {
namespace {
constexpr std::uint32_t low(std::uint64_t x) { return static_cast<std::uint32_t>(x); }
constexpr std::uint32_t high(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); }
}  // namespace

// The key is (seed, entity, purpose) hashed to 64 bits; the counter is (block, sample). 2^32 blocks of four
// words per sample are more than any sample draws.
Stream::Stream(std::uint64_t seed, std::uint64_t entity, Purpose purpose, std::uint64_t sample) {
  const std::uint64_t key = hash_combine(hash_combine(mix64(seed), entity),
                                         static_cast<std::uint64_t>(purpose));
  key_ = {low(key), high(key)};
  counter_ = {0, low(entity), low(sample), high(sample)};
}

Stream Stream::fork(std::uint64_t use) const {
  Stream out = *this;
  const std::uint64_t key = hash_combine(static_cast<std::uint64_t>(key_[1]) << 32 | key_[0], use);
  out.key_ = {low(key), high(key)};
  out.counter_[0] = 0;
  out.used_ = 4;
  out.has_spare_ = false;
  return out;
}

void Stream::refill() {
  const r123::Philox4x32 philox;
  const r123::Philox4x32::ctr_type counter{{counter_[0], counter_[1], counter_[2], counter_[3]}};
  const r123::Philox4x32::key_type key{{key_[0], key_[1]}};
  const auto block = philox(counter, key);
  block_ = {block[0], block[1], block[2], block[3]};
  used_ = 0;
  ++counter_[0];
}

void Stream::words(std::uint32_t block, std::span<std::uint32_t> out) const {
  const r123::Philox4x32 philox;
  const r123::Philox4x32::key_type key{{key_[0], key_[1]}};
  for (std::size_t i = 0; i < out.size(); i += 4) {
    const auto four = philox({{block++, counter_[1], counter_[2], counter_[3]}}, key);
    for (std::size_t k = 0; k < 4 && i + k < out.size(); ++k) out[i + k] = four[k];
  }
}

std::uint32_t Stream::bits32() {
  if (used_ == 4) refill();
  return block_[static_cast<std::size_t>(used_++)];
}

std::uint64_t Stream::bits64() {
  const std::uint64_t first = bits32();
  const std::uint64_t second = bits32();
  return first | (second << 32);
}

double Stream::uniform() { return static_cast<double>(bits64() >> 11) * 0x1p-53; }

std::uint32_t Stream::below(std::uint32_t n) {
  SL_CHECK(n > 0);
  // Lemire's multiplication with rejection: unbiased, one division at most.
  std::uint64_t product = static_cast<std::uint64_t>(bits32()) * n;
  if (low(product) < n) {
    const std::uint32_t threshold = (0u - n) % n;
    while (low(product) < threshold) product = static_cast<std::uint64_t>(bits32()) * n;
  }
  return high(product);
}

double Stream::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double u = 1.0 - uniform();  // (0, 1]: the logarithm is finite
  const double angle = math::tau * uniform();
  const double radius = std::sqrt(-2.0 * math::log(u));
  const auto [s, c] = math::sincos(angle);
  spare_ = radius * s;
  has_spare_ = true;
  return radius * c;
}

}  // namespace sandlot
