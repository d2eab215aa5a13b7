#include "files/xml.h"

#include <algorithm>

#include <tinyxml2.h>

#include "base/text.h"
#include "files/text.h"

namespace sandlot {
namespace {

/// tinyxml2 compares each attribute of an element with all before it.
constexpr std::size_t max_attributes = 100;

/// Depth and counts without building anything, so that hostile text costs one pass and no memory.
Status check_limits(std::string_view text, const XmlLimits& limits,
                    const std::shared_ptr<const std::string>& file) {
  const auto refuse = [&](std::size_t at, std::string what, std::string fix = "") {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    return Error{std::move(what), std::move(fix), {file, static_cast<int>(line)}};
  };
  std::size_t depth = 0, elements = 0;
  for (std::size_t i = text.find('<'); i != std::string_view::npos; i = text.find('<', i)) {
    const std::string_view rest = text.substr(i);
    const std::string_view end = starts_with(rest, "<!--")        ? "-->"
                                 : starts_with(rest, "<![CDATA[") ? "]]>"
                                 : starts_with(rest, "<?")        ? "?>"
                                 : starts_with(rest, "<!")        ? ">"
                                                                  : "";
    if (!end.empty()) {
      const std::size_t stop = text.find(end, i + (end == "-->" ? 4 : 2));
      if (stop == std::string_view::npos)
        return refuse(i, "this is never closed by '" + std::string(end) + "'");
      i = stop + end.size();
      continue;
    }
    const bool closing = starts_with(rest, "</");
    std::size_t attributes = 0, j = i + 1;
    for (char quote = 0; j < text.size() && (quote || text[j] != '>'); ++j) {
      const char c = text[j];
      if (quote) quote = c == quote ? '\0' : quote;
      else if (c == '"' || c == '\'') quote = c;
      else if (c == '=' && ++attributes > max_attributes)
        return refuse(i, "the element has too many attributes");
      else if (c == '<') return refuse(i, "this tag is never closed by '>'");
    }
    if (j >= text.size()) return refuse(i, "this tag is never closed by '>'");
    if (closing) {
      depth -= depth > 0;
    } else {
      if (++elements > limits.max_elements)
        return refuse(i, "too many elements", "at most " + std::to_string(limits.max_elements) + " are read");
      if (text[j - 1] != '/' && ++depth > limits.max_depth)
        return refuse(i, "nested too deeply",
                      "at most " + std::to_string(limits.max_depth) + " levels are allowed");
    }
    i = j + 1;
  }
  return {};
}

std::string reason(const tinyxml2::XMLDocument& document) {
  switch (document.ErrorID()) {
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT: return "this element is not closed by a tag of its name";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE: return "an attribute is malformed or given twice";
    case tinyxml2::XML_ERROR_PARSING_ELEMENT: return "this element is malformed";
    case tinyxml2::XML_ERROR_EMPTY_DOCUMENT: return "the file holds no XML element";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED: return "nested too deeply";
    default: return std::string("malformed XML (") + document.ErrorName() + ")";
  }
}

void convert(const tinyxml2::XMLElement& from, Xml& to, const std::shared_ptr<const std::string>& file) {
  to.name = from.Name();
  to.place = {file, from.GetLineNum()};
  for (const tinyxml2::XMLAttribute* a = from.FirstAttribute(); a; a = a->Next())
    to.attributes.emplace_back(a->Name(), a->Value());
  for (const tinyxml2::XMLNode* node = from.FirstChild(); node; node = node->NextSibling()) {
    if (const tinyxml2::XMLText* text = node->ToText()) {
      to.text += text->Value();
    } else if (const tinyxml2::XMLElement* element = node->ToElement()) {
      to.children.emplace_back();
      convert(*element, to.children.back(), file);
    }
  }
  to.text = std::string(trim(to.text));
}

}  // namespace

const std::string* Xml::attribute(std::string_view key) const {
  for (const auto& [name_, value] : attributes)
    if (name_ == key) return &value;
  return nullptr;
}

void Xml::set_attribute(std::string_view key, std::string value) {
  for (auto& [name_, present] : attributes)
    if (name_ == key) return void(present = std::move(value));
  attributes.emplace_back(std::string(key), std::move(value));
}

const Xml* Xml::child(std::string_view key) const {
  for (const Xml& each : children)
    if (each.name == key) return &each;
  return nullptr;
}

Xml* Xml::child(std::string_view key) { return const_cast<Xml*>(std::as_const(*this).child(key)); }

Result<Xml> parse_xml(std::string_view text, const std::string& file, const XmlLimits& limits) {
  const auto name = std::make_shared<const std::string>(file);
  if (text.size() > limits.max_bytes)
    return Error{"is too large: " + std::to_string(text.size() >> 20) + " MiB",
                 "at most " + std::to_string(limits.max_bytes >> 20) + " MiB are read",
                 {name}};
  SL_TRY(check_text(text, file));
  SL_TRY(check_limits(text, limits, name));
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
    return Error{reason(document), "", {name, document.ErrorLineNum()}};
  const tinyxml2::XMLElement* const root = document.RootElement();
  if (!root) return Error{"the file holds no XML element", "", {name}};
  Xml out;
  convert(*root, out, name);
  return out;
}

std::size_t count_elements(const Xml& root) {
  std::size_t n = 1;
  for (const Xml& child : root.children) n += count_elements(child);
  return n;
}

Node node_of(const Xml& element) {
  if (element.attributes.empty() && element.children.empty())
    return Node::scalar(element.text, element.place);
  Node out = Node::map(element.place);
  for (const auto& [key, value] : element.attributes) out.set("@" + key, Node::scalar(value, element.place));
  if (element.children.empty()) {
    if (!element.text.empty()) out.set("#text", Node::scalar(element.text, element.place));
    return out;
  }
  // Children of one name are collected without searching the map for each: there may be very many.
  std::vector<const Xml*> sorted;
  for (const Xml& child : element.children) sorted.push_back(&child);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Xml* a, const Xml* b) { return a->name < b->name; });
  for (auto from = sorted.begin(); from != sorted.end();) {
    const auto to = std::find_if(from, sorted.end(),
                                 [&](const Xml* other) { return other->name != (*from)->name; });
    const Xml& first = **from;
    Node value = to - from == 1 ? node_of(first) : Node::sequence(first.place);
    if (to - from > 1)
      for (auto each = from; each != to; ++each) value.push(node_of(**each));
    out.entries().push_back({first.name, std::move(value), first.place});
    from = to;
  }
  // Back into the order of the file, so that the first complaint is about the first mistake.
  std::stable_sort(
      out.entries().begin(), out.entries().end(),
      [](const Node::Entry& a, const Node::Entry& b) { return a.key_place.line < b.key_place.line; });
  return out;
}

}  // namespace sandlot
