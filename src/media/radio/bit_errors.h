#pragma once
/// Bit errors of a radio as a binary symmetric channel.
///
/// Formula  with s the ratio of signal to noise and interference, and one bit per second and hertz of noise bandwidth:
///            bpsk   p = erfc(sqrt(s)) / 2         coherent, s = Eb / N0
///            qpsk   p = erfc(sqrt(s / 2)) / 2     coherent, Gray coded, s = Es / N0 = 2 Eb / N0
///            fsk    p = exp(-s / 2) / 2           binary, orthogonal, not coherent, s = Eb / N0
/// Limits   bits are wrong independently of each other; no coding.
/// Cost     one random number per wrong bit, and one.
/// Source   J. G. Proakis, M. Salehi, Digital Communications, 5th ed. (2008), sec. 4.3 and 4.5.
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "base/math.h"
#include "base/math_erfc.h"
#include "base/random.h"
#include "media/radio/spec.h"

namespace sandlot::media::radio {

inline double milliwatts(double dBm) { return math::exp(dBm * (std::numbers::ln10 / 10)); }
inline double decibels(double ratio) { return 10 / std::numbers::ln10 * math::log(ratio); }

/// Probability of a wrong bit. @param ratio  of signal to noise and interference, as powers
inline double error_rate(Modulation modulation, double ratio) {
  switch (modulation) {
    case Modulation::none: return 0;
    case Modulation::bpsk: return 0.5 * math::erfc(std::sqrt(ratio));
    case Modulation::qpsk: return 0.5 * math::erfc(std::sqrt(0.5 * ratio));
    case Modulation::fsk: return 0.5 * math::exp(-0.5 * ratio);
  }
  return 0;
}

/// Probability that a bit is wrong after two channels, one behind the other.
inline double both(double p, double q) { return p + q - 2 * p * q; }

/// Turns over each bit with the probability p, 0 <= p <= 0.5. @return how many
inline std::uint32_t flip_bits(std::span<std::uint8_t> data, double p, Stream& random) {
  constexpr double never = 1e-15;
  if (!(p > never)) return 0;
  const double bits = 8 * static_cast<double>(data.size());
  const double per_log = 1 / math::log(1 - p);
  std::uint32_t wrong = 0;
  // The gaps between wrong bits have a geometric distribution.
  for (double at = 0;; at += 1) {
    at += std::floor(math::log(1 - random.uniform()) * per_log);
    if (!(at < bits)) return wrong;
    const auto bit = static_cast<std::size_t>(at);
    data[bit / 8] = static_cast<std::uint8_t>(data[bit / 8] ^ (1u << (bit % 8)));
    ++wrong;
  }
}

}  // namespace sandlot::media::radio
