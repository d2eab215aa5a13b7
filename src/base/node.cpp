#include "base/node.h"

#include <algorithm>
#include <unordered_map>

namespace sandlot {

struct Node::Content {
  Type type = Type::null;
  Place place;
  std::string text;
  std::vector<Node> items;
  std::vector<Entry> entries;
};

const Node::Content& Node::content() const {
  static const Content nothing;
  return content_ ? *content_ : nothing;
}

Node::Content& Node::own() {
  if (!content_) content_ = std::make_shared<Content>();
  else if (content_.use_count() > 1) content_ = std::make_shared<Content>(*content_);
  return *content_;
}

Node Node::scalar(std::string text, Place place) {
  Node node;
  Content& content = node.own();
  content.type = Type::scalar;
  content.text = std::move(text);
  content.place = std::move(place);
  return node;
}

Node Node::sequence(Place place) {
  Node node;
  node.own().type = Type::sequence;
  node.own().place = std::move(place);
  return node;
}

Node Node::map(Place place) {
  Node node;
  node.own().type = Type::map;
  node.own().place = std::move(place);
  return node;
}

Node::Type Node::type() const { return content().type; }
const Place& Node::place() const { return content().place; }
void Node::set_place(Place place) { own().place = std::move(place); }
const std::string& Node::text() const { return content().text; }
const std::vector<Node>& Node::items() const { return content().items; }
std::vector<Node>& Node::items() { return own().items; }
const std::vector<Node::Entry>& Node::entries() const { return content().entries; }
std::vector<Node::Entry>& Node::entries() { return own().entries; }

const Node* Node::find(std::string_view key) const {
  for (const Entry& entry : content().entries)
    if (entry.key == key) return &entry.value;
  return nullptr;
}

Node* Node::find(std::string_view key) {
  if (!std::as_const(*this).find(key)) return nullptr;  // asking for what is not there copies nothing
  own();
  return const_cast<Node*>(std::as_const(*this).find(key));
}

Node& Node::set(std::string key, Node value) {
  SL_CHECK(is_map() || is_null());
  Content& content = own();
  content.type = Type::map;
  if (Node* present = find(key)) return *present = std::move(value);
  const Place place = value.place();
  content.entries.push_back({std::move(key), std::move(value), place});
  return content.entries.back().value;
}

Node& Node::push(Node value) {
  SL_CHECK(is_sequence() || is_null());
  Content& content = own();
  content.type = Type::sequence;
  content.items.push_back(std::move(value));
  return content.items.back();
}

bool Node::erase(std::string_view key) {
  if (!std::as_const(*this).find(key)) return false;
  return std::erase_if(own().entries, [&](const Entry& entry) { return entry.key == key; }) > 0;
}

Error Node::error(std::string what, std::string fix, std::string path) const {
  return {std::move(what), std::move(fix), place(), std::move(path)};
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
