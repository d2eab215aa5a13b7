#include <string_view>

#include "files/yaml.h"

namespace sandlot {
namespace {

/// Whether a scalar means itself without quotes, in lists and maps too.
bool is_plain(std::string_view text) {
  if (text.empty() || text.back() == ' ' || text.front() == ' ' || text == "null" || text == "Null" ||
      text == "NULL" || text == "-")
    return false;
  if (text.front() == '-' && text.size() > 1 && text[1] == ' ') return false;
  for (const char c : text) {
    const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (!letter && std::string_view("_./+- ").find(c) == std::string_view::npos) return false;
  }
  return true;
}

std::string scalar_text(std::string_view text) {
  if (is_plain(text)) return std::string(text);
  static constexpr char digits[] = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += std::string("\\x") + digits[static_cast<unsigned char>(c) >> 4] + digits[c & 15];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

bool is_flat(const Node& list) {
  for (const Node& each : list.items())
    if (!each.is_scalar()) return false;
  return true;
}

void write(const Node& node, std::size_t indent, std::string& out);

/// What follows a key or a dash, which stand at `indent`.
void write_value(const Node& node, std::size_t indent, std::string& out) {
  if (node.is_scalar()) {
    out += " " + scalar_text(node.text()) + "\n";
  } else if (node.is_null()) {
    out += " null\n";
  } else if (node.is_map() && node.entries().empty()) {
    out += " {}\n";
  } else if (node.is_sequence() && is_flat(node)) {
    out += " [";
    for (std::size_t i = 0; i < node.items().size(); ++i)
      out += (i == 0 ? "" : ", ") + scalar_text(node.items()[i].text());
    out += "]\n";
  } else {
    out += "\n";
    write(node, indent + 2, out);
  }
}

void write(const Node& node, std::size_t indent, std::string& out) {
  const std::string margin(indent, ' ');
  for (const Node::Entry& each : node.entries()) {
    out += margin + scalar_text(each.key) + ":";
    write_value(each.value, indent, out);
  }
  for (const Node& each : node.items()) {
    out += margin + "-";
    if (each.is_map() && !each.entries().empty()) {
      // The first key stands behind the dash.
      std::string keys;
      write(each, indent + 2, keys);
      out += " " + keys.substr(indent + 2);
    } else {
      write_value(each, indent, out);
    }
  }
}

}  // namespace

std::string yaml_text(const Node& root) {
  std::string out;
  if (root.is_map() || root.is_sequence()) write(root, 0, out);
  else write_value(root, 0, out);
  return out;
}

}  // namespace sandlot
