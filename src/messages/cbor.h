#pragma once
/// Messages as CBOR, the binary form of rosbridge.
///
/// Output   one map with the field names of ROS 2, in their order. Lists of numbers are typed arrays (RFC 8746,
///          little-endian), lists of uint8, byte or char byte strings; NaN and infinities are themselves.
/// Input    any well-formed CBOR with the same content: lists as arrays or as typed arrays in either order, lengths
///          definite or not, floats of 16, 32 or 64 bits; other tags are passed over. The rest is as in json.h.
/// Errors   as in json.h; bytes that end too soon or go on after the value, keys that are not text, more than 64 levels.
#include <cstddef>
#include <span>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "base/result.h"
#include "messages/info.h"

namespace sandlot {

/// Replaces what `out` holds by the CBOR of a message given as CDR.
Status cdr_to_cbor(const MessageInfo& info, std::span<const std::byte> cdr, std::vector<std::byte>& out);

/// Sets those fields of `message` that `bytes` names. When it fails, some of them have been set.
Status read_cbor(const MessageInfo& info, std::span<const std::byte> bytes, void* message);

/// Any CBOR as a document; typed arrays are binary values with their tag as subtype (little-endian: what came in the
/// other order is turned round).
Result<nlohmann::json> parse_cbor(std::span<const std::byte> bytes);

}  // namespace sandlot
