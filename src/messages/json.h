#pragma once
/// Messages as JSON, the form of rosbridge clients and of `sandlot topic echo --json`.
///
/// Output   one object with the field names of ROS 2, in their order, without blanks. Numbers in the shortest form that
///          reads back as the same; NaN and infinities are null; lists of uint8, byte or char are base64.
/// Input    the same, and: lists of octets as lists of numbers; a field that is missing keeps its default; null is NaN.
/// Errors   a field that the type does not have (the nearest is named), a value of another kind or out of its range,
///          a list of another length than the array: with the path, "/header/stamp/sec".
/// Limits   integers beyond 2^53 are exact here but not in JavaScript. Infinity becomes NaN on its way.
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "base/result.h"
#include "messages/info.h"

namespace sandlot {

/// Replaces what `out` holds by the JSON of a message given as CDR.
Status cdr_to_json(const MessageInfo& info, std::span<const std::byte> cdr, std::string& out);

/// Sets those fields of `message` that `text` names. When it fails, some of them have been set.
Status read_json(const MessageInfo& info, std::string_view text, void* message);
/// The same from a document that is already in memory. A binary value is a list of numbers if its subtype is one of the
/// typed arrays of RFC 8746, else a list of octets.
Status read_json(const MessageInfo& info, const nlohmann::json& document, void* message);

}  // namespace sandlot
