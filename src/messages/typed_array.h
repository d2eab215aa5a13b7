#pragma once
/// The tags of CBOR's typed arrays, RFC 8746, section 2.1: little-endian and single octets.
#include <cstdint>

#include "messages/info.h"

namespace sandlot {

/// 0 when there is none for such elements.
constexpr std::uint64_t typed_array_tag(Wire type) {
  switch (type) {
    case Wire::int8: return 72;
    case Wire::uint16: return 69;
    case Wire::uint32: return 70;
    case Wire::uint64: return 71;
    case Wire::int16: return 77;
    case Wire::int32: return 78;
    case Wire::int64: return 79;
    case Wire::float32: return 85;
    case Wire::float64: return 86;
    default: return 0;
  }
}

/// What the elements of an array with such a tag are; uint8 when the tag is none of these.
constexpr Wire typed_array_type(std::uint64_t tag) {
  for (const Wire type : {Wire::int8, Wire::uint16, Wire::uint32, Wire::uint64, Wire::int16, Wire::int32,
                          Wire::int64, Wire::float32, Wire::float64})
    if (typed_array_tag(type) == tag) return type;
  return Wire::uint8;
}

}  // namespace sandlot
