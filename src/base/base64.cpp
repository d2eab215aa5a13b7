#include "base/base64.h"

#include <array>

namespace sandlot {
namespace {

constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr unsigned not_a_letter = 64;

constexpr std::array<unsigned char, 256> value_of_letter = [] {
  std::array<unsigned char, 256> values{};
  values.fill(not_a_letter);
  for (std::size_t i = 0; i < letters.size(); ++i)
    values[static_cast<unsigned char>(letters[i])] = static_cast<unsigned char>(i);
  return values;
}();

}  // namespace

void add_base64(std::span<const std::byte> bytes, std::string& out) {
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](std::size_t k) {
      return i + k < bytes.size() ? std::to_integer<unsigned>(bytes[i + k]) : 0;
    };
    const unsigned three = at(0) << 16 | at(1) << 8 | at(2);
    out += letters[three >> 18];
    out += letters[three >> 12 & 63];
    out += i + 1 < bytes.size() ? letters[three >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? letters[three & 63] : '=';
  }
}

std::optional<std::string> from_base64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  if (text.size() % 4 == 1) return std::nullopt;
  std::string out;
  out.reserve(text.size() / 4 * 3 + 2);
  unsigned bits = 0;
  int have = 0;
  for (const char c : text) {
    const unsigned value = value_of_letter[static_cast<unsigned char>(c)];
    if (value == not_a_letter) return std::nullopt;
    bits = (bits << 6 | value) & 0xFFFF;
    if ((have += 6) >= 8) out += static_cast<char>(bits >> (have -= 8) & 0xFF);
  }
  return out;
}

}  // namespace sandlot
