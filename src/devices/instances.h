#pragma once
/// From the numbers in the instance plane of a picture to the things they name.
#include <algorithm>
#include <span>

#include "devices/thing.h"

namespace sandlot::eye {

/// Null for what is no thing. Things stand in the order of their creation, and so of their numbers.
inline const Thing* thing_of(std::span<const Thing> things, std::uint32_t instance) {
  const auto found = std::lower_bound(things.begin(), things.end(), instance,
                                      [](const Thing& thing, std::uint32_t n) { return thing.instance < n; });
  return found != things.end() && found->instance == instance ? &*found : nullptr;
}

}  // namespace sandlot::eye
