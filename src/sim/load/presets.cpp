#include "sim/load/presets.h"

#include <map>
#include <mutex>

#include "base/read.h"
#include "files/yaml.h"

namespace sandlot {
namespace {

/// The keys of a preset. Each is read once in a process: to parse YAML took an eighth of the time to make a small world.
Node keys_of(const Preset& preset) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::string>, Node> known;
  const std::lock_guard lock(mutex);
  const auto [it, is_new] = known.try_emplace({preset.name, preset.keys});
  if (is_new) {
    auto keys = parse_yaml(preset.keys, std::string("preset ") + preset.name);
    SL_CHECK_MSG(keys, "a preset that is no YAML");
    it->second = std::move(*keys);
  }
  return it->second;
}

}  // namespace

Status lay_preset(Node& config, const Kind& kind) {
  const Node* const wanted = config.find("preset");
  if (!wanted) return {};
  if (!wanted->is_scalar()) return wrong_type(*wanted, "the name of a preset", "/preset");
  std::vector<std::string> names;
  for (const Preset& preset : kind.presets) {
    names.emplace_back(preset.name);
    if (wanted->text() != preset.name) continue;
    Node keys = keys_of(preset);
    const Place place = config.place();
    config.erase("preset");
    merge(keys, config);
    config = std::move(keys);
    config.set_place(place);
    return {};
  }
  return wanted->error(
      "device kind '" + std::string(kind.name) + "' has no preset '" + wanted->text().substr(0, 60) + "'",
      names.empty() ? "it has none at all" : suggestion(wanted->text(), names), "/preset");
}

Status lay_preset(Node& config, std::string_view kind) {
  for (const Kind* const known : device_kinds())
    if (kind == known->name) return lay_preset(config, *known);
  return {};
}

}  // namespace sandlot
