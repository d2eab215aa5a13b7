#pragma once
/// Text from the wire need not be UTF-8; what JSON and CBOR carry must be.
#include <cstddef>
#include <string_view>

namespace sandlot {

/// The bytes of the well-formed UTF-8 character at the beginning of `text`; 0 when there is none.
std::size_t utf8_length(std::string_view text);

/// Calls take(piece) for the pieces of `text`, each byte that belongs to no character replaced by U+FFFD.
template <class Take>
void each_utf8(std::string_view text, Take&& take) {
  std::size_t good = 0;  // bytes at the beginning of `text` that are well-formed
  while (good < text.size()) {
    if (const std::size_t n = utf8_length(text.substr(good))) {
      good += n;
      continue;
    }
    if (good) take(text.substr(0, good));
    take(std::string_view("\xEF\xBF\xBD"));
    text.remove_prefix(good + 1);
    good = 0;
  }
  if (good) take(text);
}

}  // namespace sandlot
