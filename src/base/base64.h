#pragma once
/// Base64 with the letters + and / (RFC 4648, section 4).
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace sandlot {

/// Appends `bytes` as Base64, padded by =, to `out`.
void add_base64(std::span<const std::byte> bytes, std::string& out);

/// The bytes of a Base64 text, whose padding may be left out; nothing when the text is not Base64.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace sandlot
