#include <map>

#include "base/text.h"
#include "files/yaml.h"
#include "formats/scenario/tree.h"

namespace sandlot::formats {
namespace {

constexpr std::size_t max_text = 64u << 10;

std::size_t number_of_nodes(const Node& node) {
  std::size_t n = 1;
  for (const Node& item : node.items()) n += number_of_nodes(item);
  for (const Node::Entry& entry : node.entries()) n += number_of_nodes(entry.value);
  return n;
}

/// Substitutes in place; variables are completed when they are first needed.
class Variables {
 public:
  explicit Variables(const Node* vars) {
    if (!vars) return;
    for (const Node::Entry& entry : vars->entries()) {
      names_.push_back(entry.key);
      variables_.emplace(entry.key, Variable{entry.value});
    }
  }
  Status replace(Node& node) {
    if (++nodes_ > TextLimits{}.max_nodes) return node.error("variables make too many values");
    if (node.is_scalar()) return replace_scalar(node);
    for (Node& item : node.items()) SL_TRY(replace(item));
    for (Node::Entry& entry : node.entries()) SL_TRY(replace(entry.value));
    return {};
  }
  bool is_used(const std::string& name) const {
    const auto found = variables_.find(name);
    return found == variables_.end() || found->second.state != Variable::raw;
  }

 private:
  struct Variable {
    Node value;
    enum { raw, busy, done } state = raw;
  };

  Result<const Node*> value_of(const std::string& name, const Node& use) {
    const auto found = variables_.find(name);
    if (found == variables_.end())
      return use.error("no variable '" + name.substr(0, 60) + "'",
                       names_.empty() ? "there is no 'vars' in this scenario" : suggestion(name, names_));
    Variable& variable = found->second;
    if (variable.state == Variable::busy)
      return variable.value.error("variable '" + name + "' is defined by itself");
    if (variable.state == Variable::raw) {
      variable.state = Variable::busy;
      Node value = variable.value;
      if (++depth_ > 100) return use.error("variables are defined by each other more than 100 deep");
      SL_TRY(replace(value));
      --depth_;
      variable.value = std::move(value);
      variable.state = Variable::done;
    }
    return &variable.value;
  }

  /// Of `name`, or of `map[key]`: the entry of the variable `map` that the variable `key` names.
  Result<const Node*> meaning_of(const std::string& name, const Node& use) {
    const std::size_t bracket = name.find('[');
    if (bracket == std::string::npos || name.back() != ']') return value_of(name, use);
    const std::string map_name(trim(std::string_view(name).substr(0, bracket)));
    const std::string key_name(trim(std::string_view(name).substr(bracket + 1, name.size() - bracket - 2)));
    SL_ASSIGN(const Node* const map, value_of(map_name, use));
    if (!map->is_map())
      return use.error("variable '" + map_name + "' is " + describe(*map) +
                       " and has no entries to choose from");
    SL_ASSIGN(const Node* const key, value_of(key_name, use));
    if (!key->is_scalar())
      return use.error("variable '" + key_name + "' is " + describe(*key) + " and names no entry of '" +
                       map_name + "'");
    if (const Node* const entry = map->find(key->text())) return entry;
    std::vector<std::string> keys;
    for (const Node::Entry& each : map->entries()) keys.push_back(each.key);
    return key->error("'" + key_name + "' is '" + key->text().substr(0, 60) + "', and '" + map_name +
                          "' has no entry for that",
                      suggestion(key->text(), keys));
  }

  Status replace_scalar(Node& node) {
    const std::string& text = node.text();
    if (text.find("${") == std::string::npos) return {};
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
      if (text.compare(i, 3, "$${") == 0) {
        out += "${";
        i += 3;
      } else if (text.compare(i, 2, "${") == 0) {
        const std::size_t end = text.find('}', i);
        if (end == std::string::npos)
          return node.error("'${' is never closed", "write ${name}, or $${ for a plain ${");
        const std::string name(trim(std::string_view(text).substr(i + 2, end - i - 2)));
        SL_ASSIGN(const Node* value, meaning_of(name, node));
        if (i == 0 && end + 1 == text.size()) {
          nodes_ += number_of_nodes(*value);
          if (nodes_ > TextLimits{}.max_nodes) return node.error("variables make too many values");
          node = Node(*value);
          return {};
        }
        if (!value->is_scalar())
          return node.error("variable '" + name + "' is " + describe(*value) +
                            " and cannot be part of a text");
        out += value->text();
        i = end + 1;
      } else {
        out += text[i++];
      }
      if (out.size() > max_text) return node.error("variables make a text that is too long");
    }
    node = Node::scalar(std::move(out), node.place());
    return {};
  }

  std::map<std::string, Variable, std::less<>> variables_;
  std::vector<std::string> names_;
  std::size_t nodes_ = 0;
  int depth_ = 0;
};

}  // namespace

Status substitute_variables(Node& root, std::vector<std::pair<std::string, Place>>& unused) {
  const Node* const vars = root.find("vars");
  if (vars && !vars->is_map() && !vars->is_null())
    return vars->error("expected a map of names and values, found " + describe(*vars), "", "/vars");
  Variables variables(vars);
  SL_TRY(variables.replace(root));
  if (const Node* const replaced = root.find("vars"))
    for (const Node::Entry& entry : replaced->entries())
      if (!variables.is_used(entry.key)) unused.emplace_back(entry.key, entry.key_place);
  return {};
}

}  // namespace sandlot::formats
