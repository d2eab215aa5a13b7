#include "base/node.h"

#include <algorithm>
#include <unordered_map>

namespace sandlot {

Node Node::scalar(std::string text, Place place) {
  Node node;
  node.type_ = Type::scalar;
  node.text_ = std::move(text);
  node.place_ = std::move(place);
  return node;
}

Node Node::sequence(Place place) {
  Node node;
  node.type_ = Type::sequence;
  node.place_ = std::move(place);
  return node;
}

Node Node::map(Place place) {
  Node node;
  node.type_ = Type::map;
  node.place_ = std::move(place);
  return node;
}

const Node* Node::find(std::string_view key) const {
  for (const Entry& entry : entries_)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

Node* Node::find(std::string_view key) { return const_cast<Node*>(std::as_const(*this).find(key)); }

Node& Node::set(std::string key, Node value) {
  SL_CHECK(type_ == Type::map || type_ == Type::null);
  type_ = Type::map;
  if (Node* present = find(key)) return *present = std::move(value);
  const Place place = value.place();
  entries_.push_back({std::move(key), std::move(value), place});
  return entries_.back().value;
}

Node& Node::push(Node value) {
  SL_CHECK(type_ == Type::sequence || type_ == Type::null);
  type_ = Type::sequence;
  items_.push_back(std::move(value));
  return items_.back();
}

bool Node::erase(std::string_view key) {
  return std::erase_if(entries_, [&](const Entry& entry) { return entry.key == key; }) > 0;
}

Error Node::error(std::string what, std::string fix, std::string path) const {
  return {std::move(what), std::move(fix), place_, std::move(path)};
}

void merge(Node& base, const Node& over) {
  if (!base.is_map() || !over.is_map()) {
    base = over;
    return;
  }
  // Looked up by hash: two maps of 10^5 keys would otherwise take minutes.
  std::unordered_map<std::string, std::size_t> present;
  for (const Node::Entry& entry : base.entries()) present.emplace(entry.key, present.size());
  for (const Node::Entry& entry : over.entries()) {
    const auto found = present.find(entry.key);
    if (found != present.end()) merge(base.entries()[found->second].value, entry.value);
    else base.entries().push_back(entry);
  }
}

std::string describe(const Node& node) {
  switch (node.type()) {
    case Node::Type::null: return "nothing";
    case Node::Type::scalar: return "'" + node.text().substr(0, 40) + "'";
    case Node::Type::sequence: return "a list";
    case Node::Type::map: return "a map";
  }
  return "";
}

}  // namespace sandlot
