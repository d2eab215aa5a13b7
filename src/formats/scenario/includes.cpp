#include <set>

#include "files/yaml.h"
#include "formats/scenario/tree.h"

namespace sandlot::formats {
namespace {

constexpr std::size_t most_nested = 16;
constexpr int max_files = 100;

struct Including {
  std::vector<std::string> open;  ///< canonical paths from the scenario down to the file being read
  int files = 0;

  Result<Node> expand(Node root, const std::string& file);
  Result<Node> include(const Node& name, const std::string& folder);
};

Result<Node> Including::include(const Node& name, const std::string& folder) {
  if (!name.is_scalar() || name.text().empty())
    return name.error("expected the name of a file", "", "/include");
  const std::string path = beside(folder, name.text());
  const std::string canonical = canonical_path(path);
  for (const std::string& outer : open)
    if (outer == canonical) return name.error("'" + name.text() + "' includes itself", "", "/include");
  if (open.size() >= most_nested) return name.error("files are included more than 16 deep", "", "/include");
  if (++files > max_files) return name.error("more than 100 files are included", "", "/include");
  auto text = read_text_file(path, TextLimits{}.max_bytes);
  if (!text)
    return name.error("cannot include '" + path + "': " + text.error().what, text.error().fix, "/include");
  SL_ASSIGN(Node root, parse_yaml(*text, path));
  open.push_back(canonical);
  auto expanded = expand(std::move(root), path);
  open.pop_back();
  return expanded;
}

Result<Node> Including::expand(Node root, const std::string& file) {
  if (!root.is_map() && !root.is_null())
    return root.error("a scenario is a map of keys, found " + describe(root), "begin with version: 1");
  const Node* const list = root.find("include");
  if (!list || list->is_null()) return root;
  std::vector<Node> names = list->is_sequence() ? list->items() : std::vector<Node>{*list};
  root.erase("include");
  // Later files lie upon earlier ones, and this one upon all of them.
  Node merged = Node::map(root.place());
  for (const Node& name : names) {
    SL_ASSIGN(const Node included, include(name, folder_of(file)));
    if (included.is_map()) merge(merged, included);
  }
  merge(merged, root);
  return merged;
}

}  // namespace

Result<Node> parse_with_includes(std::string_view text, const std::string& file) {
  SL_ASSIGN(Node root, parse_yaml(text, file));
  Including including;
  including.open.push_back(canonical_path(file));
  return including.expand(std::move(root), file);
}

}  // namespace sandlot::formats
