#include "devices/sdf_element.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace sandlot::sdf_element {

const Node* find(const Node& element, std::string_view path) {
  const Node* node = &element;
  for (const std::string_view name : split(path, '/')) {
    node = node->find(name);
    if (!node) return nullptr;
    if (node->is_sequence()) {
      if (node->items().empty()) return nullptr;
      node = &node->items().front();
    }
  }
  return node;
}

std::string text(const Node* element) {
  if (!element) return "";
  if (element->is_scalar()) return std::string(trim(element->text()));
  const Node* const inner = element->find("");
  return inner ? std::string(trim(inner->text())) : "";
}

Result<std::optional<double>> number(const Node& element, std::string_view path) {
  const Node* const node = find(element, path);
  if (!node) return std::optional<double>();
  double value = 0;
  if (!parse_number(text(node), value) || !std::isfinite(value))
    return node->error("<" + std::string(path) + "> is '" + text(node).substr(0, 40) + "'", "write a number");
  return std::optional<double>(value);
}

void copy(const Node& element, std::string_view path, Node& config, const char* key) {
  if (const Node* const node = find(element, path)) config.set(key, Node::scalar(text(node), node->place()));
}

Node scalar(double value, const Node& from) { return Node::scalar(number_text(value), from.place()); }

void warn_unknown(const Node& element, std::initializer_list<std::string_view> known, const std::string& what,
                  Diagnostics& diagnostics) {
  for (const Node::Entry& entry : element.entries()) {
    if (entry.key.empty() || entry.key.front() == '@') continue;
    if (std::find(known.begin(), known.end(), entry.key) != known.end()) continue;
    diagnostics.warn(
        {"<" + entry.key + "> of " + what + " is not supported and has no effect", "", entry.key_place});
  }
}

}  // namespace sandlot::sdf_element
