#include <algorithm>
#include <cctype>

#include "base/text.h"
#include "files/yaml.h"
#include "formats/scenario/tree.h"

namespace sandlot::formats {
namespace {

/// `key[1][2]` of a path.
struct Part {
  std::string key;
  std::vector<std::size_t> indices;
};

Result<std::vector<Part>> parse_path(const std::string& text, const Place& place) {
  const auto refuse = [&](const char* what) {
    return Error{what, "write --set robots[0].count=3 or --set variable=value", place};
  };
  std::vector<Part> parts;
  for (const std::string_view piece : split(text, '.')) {
    const std::size_t bracket = piece.find('[');
    Part part{std::string(trim(piece.substr(0, bracket))), {}};
    if (part.key.empty()) return refuse("the path has an empty part");
    std::string_view rest = bracket == std::string_view::npos ? "" : piece.substr(bracket);
    while (!rest.empty()) {
      const std::size_t close = rest.find(']');
      double index = -1;
      if (rest[0] != '[' || close == std::string_view::npos ||
          !parse_number(rest.substr(1, close - 1), index) || !(index >= 0 && index <= 1e6) ||
          index != static_cast<double>(static_cast<std::size_t>(index)))
        return refuse("an index must be a whole number in brackets");
      part.indices.push_back(static_cast<std::size_t>(index));
      rest.remove_prefix(close + 1);
    }
    parts.push_back(std::move(part));
  }
  if (parts.size() > 32) return refuse("the path is too long");
  return parts;
}

/// The place of everything an override gives is its own text: it stands in no file.
void put_at(Node& node, const Place& place) {
  node.set_place(place);
  for (Node& item : node.items()) put_at(item, place);
  for (Node::Entry& entry : node.entries()) {
    entry.key_place = place;
    put_at(entry.value, place);
  }
}

/// `name` of a robot, thing, event or zone, `id` of a module; "" where there is none.
std::string item_name(const Node& item) {
  for (const char* const key : {"name", "id"})
    if (const Node* const name = item.is_map() ? item.find(key) : nullptr) return name->text();
  return "";
}

Node* element_named(Node& list, const std::string& name) {
  for (Node& item : list.items())
    if (item_name(item) == name) return &item;
  return nullptr;
}

/// Into the only element of a list, which `word` does not name.
Result<Node*> only_element(Node& list, const std::string& key, const std::string& word, const Place& place) {
  if (list.items().size() == 1) return &list.items().front();
  std::vector<std::string> names;
  for (const Node& item : list.items())
    if (std::string name = item_name(item); !name.empty()) names.push_back(std::move(name));
  const std::string near = nearest(word, names);
  return Error{"'" + key + "' has " + std::to_string(list.items().size()) + " elements" +
                   (names.empty() ? "" : ", none named '" + word + "'"),
               !near.empty()          ? "did you mean '" + key + "." + near + "'?"
               : list.items().empty() ? ""
                                      : "name one of them, as " + key + "[0]" +
                                            (names.empty() ? "" : " or " + key + "." + names.front()),
               place};
}

/// The element of a list at an index.
Result<Node*> element(Node& list, std::size_t index, const std::string& key, const Place& place) {
  const std::size_t size = list.items().size();
  if (index < size) return &list.items()[index];
  return Error{"'" + key + "' has " + std::to_string(size) + (size == 1 ? " element" : " elements"),
               size == 0 ? "" : "the last one is " + key + "[" + std::to_string(size - 1) + "]", place};
}

/// The short form of a key becomes the long one when a path leads into it: `controller: wander`, `physics: rigid`.
void lengthen(Node& node, const std::string& key) {
  if (!node.is_scalar()) return;
  const char* const name = key == "physics" ? "engine" : key == "controller" ? "kind" : nullptr;
  if (!name) return;
  Node longer = Node::map(node.place());
  longer.set(name, node);
  node = std::move(longer);
}

Status apply(Node& root, const Override& override_) {
  const std::string text = std::string(override_place) + override_.path.substr(0, 200) + "=" +
                           override_.value.substr(0, 200);
  const Place place = place_in(text);
  SL_ASSIGN(const std::vector<Part> parts, parse_path(override_.path, place));
  auto parsed = parse_yaml(override_.value, text,
                           {.max_bytes = 1u << 20, .max_depth = 32, .max_nodes = 10'000});
  if (!parsed) return Error{"the value cannot be read: " + parsed.error().what, parsed.error().fix, place};
  Node value = trim(override_.value).empty() ? Node::scalar("") : std::move(*parsed);
  put_at(value, place);

  Node* vars = root.find("vars");
  if (parts.size() == 1 && parts[0].indices.empty() && vars && vars->is_map()) {
    if (Node* variable = vars->find(parts[0].key)) {
      *variable = std::move(value);
      return {};
    }
  }
  Node* at = &root;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Part& part = parts[i];
    const bool last = i + 1 == parts.size();
    const std::string& outer = i == 0 ? part.key : parts[i - 1].key;
    if (at->is_sequence()) {
      Node* const named = part.indices.empty() ? element_named(*at, part.key) : nullptr;
      if (named) {
        at = named;
        continue;
      }
      SL_ASSIGN(at, only_element(*at, outer, part.key, place));
    }
    lengthen(*at, outer);
    if (at->is_scalar())
      return Error{"'" + outer + "' is " + describe(*at) + " and has no '" + part.key + "' in it", "", place};
    if (at->is_null()) *at = Node::map(at->place().line > 0 ? at->place() : place);
    if (i == 1 && parts[0].key == "vars" && !at->find(part.key)) {
      std::vector<std::string> known;
      for (const Node::Entry& entry : at->entries()) known.push_back(entry.key);
      return Error{"no variable '" + part.key + "'", suggestion(part.key, known), place};
    }
    if (!at->find(part.key)) {
      if (!part.indices.empty()) return Error{"'" + part.key + "' has no elements", "", place};
      at->entries().push_back({part.key, Node::map(place), place});
    }
    Node* next = at->find(part.key);
    for (const std::size_t& index : part.indices) {
      if (!next->is_sequence())
        return Error{"'" + part.key + "' is " + describe(*next) + ", not a list", "", place};
      SL_ASSIGN(next, element(*next, index, part.key, place));
    }
    if (last && i == 0 && part.key == "physics" && next->is_map() && value.is_scalar() &&
        !next->entries().empty()) {
      next->set("engine", std::move(value));
      return {};
    }
    at = next;
  }
  *at = std::move(value);
  return {};
}

}  // namespace

Status apply_overrides(Node& root, std::span<const Override> overrides) {
  if (root.is_null() && !overrides.empty()) root = Node::map(root.place());
  for (const Override& each : overrides) SL_TRY(apply(root, each));
  return {};
}

}  // namespace sandlot::formats
