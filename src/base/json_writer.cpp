#include "base/json_writer.h"

#include <algorithm>
#include <cmath>

#include "base/utf8.h"

namespace sandlot {
namespace {

template <class T>
void append_number(T number, std::string& out) {
  if (!std::isfinite(number)) return void(out += "null");
  // "-0" is an integer to readers of JSON, and those have no negative zero.
  if (number == 0 && std::signbit(number)) return void(out += "-0.0");
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, number).ptr);
}

}  // namespace

void append_json(double number, std::string& out) { append_number(number, out); }
void append_json(float number, std::string& out) { append_number(number, out); }

void append_json(std::string_view text, std::string& out) {
  out += '"';
  // Most texts are names: what needs no second look goes at once.
  const auto plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };
  const auto odd = std::find_if_not(text.begin(), text.end(), plain);
  out.append(text.begin(), odd);
  text.remove_prefix(static_cast<std::size_t>(odd - text.begin()));
  each_utf8(text, [&](std::string_view piece) {
    for (const char c : piece) {
      if (c == '"' || c == '\\') (out += '\\') += c;
      else if (c == '\n') out += "\\n";
      else if (c == '\t') out += "\\t";
      else if (static_cast<unsigned char>(c) < 0x20) {
        constexpr std::string_view hex = "0123456789abcdef";
        (((out += "\\u00") += hex[static_cast<unsigned char>(c) >> 4]) += hex[c & 15]);
      } else {
        out += c;
      }
    }
  });
  out += '"';
}

void JsonWriter::real(double value) {
  separate();
  const std::size_t begin = out_.size();
  append_json(value, out_);
  if (std::isfinite(value) && out_.find_first_of(".e", begin) == std::string::npos) out_ += ".0";
}

}  // namespace sandlot
