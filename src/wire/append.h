#pragma once
/// Numbers at the end of a binary message, little-endian as the machine is.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace sandlot::wire {

void append(std::vector<std::byte>& out, const auto& value) {
  const auto* const bytes = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), bytes, bytes + sizeof value);
}
/// As a float; what is too large for one is the largest.
inline void append_float(std::vector<std::byte>& out, double x) {
  constexpr double most = std::numeric_limits<float>::max();
  append(out, static_cast<float>(std::clamp(x, -most, most)));
}

}  // namespace sandlot::wire
