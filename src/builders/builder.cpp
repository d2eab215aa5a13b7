#include "builders/builder.h"

#include "builders/kinds.h"

namespace sandlot {
#define SL_DECLARE(name)        \
  namespace builders::name {    \
  extern const Builder builder; \
  }
SANDLOT_BUILDERS(SL_DECLARE)
#undef SL_DECLARE

std::span<const Builder* const> builder_table() {
#define SL_ENTRY(name) &builders::name::builder,
  static const Builder* const table[] = {SANDLOT_BUILDERS(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

Error parameter_error(const Node& config, const std::string& path, const char* key, std::string what,
                      std::string fix, const char* other_key) {
  const Node* at = config.find(key);
  if (!at) at = config.find(other_key);
  return (at ? *at : config).error(std::move(what), std::move(fix), path + "/" + key);
}

Result<Built> build_model(const Node& map, const std::string& path) {
  const Node* const name = map.find("builder");
  if (!name) return map.error("key 'builder' is missing", "write {builder: snake, ...}", path);
  if (!name->is_scalar()) return wrong_type(*name, "the name of a builder", path + "/builder");
  std::vector<std::string> names;
  for (const Builder* const builder : builder_table()) {
    names.emplace_back(builder->name);
    if (name->text() != builder->name) continue;
    Node parameters = map;
    parameters.erase("builder");
    auto built = builder->build(parameters, path);
    if (!built) {
      if (!built.error().place.file) built.error().place = map.place();
      return std::move(built.error());
    }
    built->model.name = builder->name;
    built->model.place = map.place();
    return built;
  }
  return name->error("there is no builder '" + name->text().substr(0, 60) + "'",
                     suggestion(name->text(), names), path + "/builder");
}

std::optional<Result<Node>> parse_builder(std::string_view text, const Place& written) {
  constexpr std::string_view scheme = "builder:";
  if (!starts_with(text, scheme)) return std::nullopt;
  const Place place = written.file ? written : Place{std::make_shared<const std::string>(text)};
  text.remove_prefix(scheme.size());
  const std::size_t mark = text.find('?');
  Node map = Node::map(place);
  map.set("builder", Node::scalar(std::string(text.substr(0, mark)), place));
  if (mark == std::string_view::npos) return map;
  for (const std::string_view word : split(text.substr(mark + 1), '&')) {
    const std::size_t equals = word.find('=');
    const std::string key(word.substr(0, equals));
    if (equals == std::string_view::npos || key.empty() || key == "builder")
      return map.error("'" + std::string(word.substr(0, 60)) + "' is not a parameter",
                       "write key=value, with & between them");
    if (map.find(key)) return map.error("'" + key.substr(0, 60) + "' is given twice");
    map.set(key, Node::scalar(std::string(word.substr(equals + 1)), place));
  }
  return map;
}

}  // namespace sandlot
