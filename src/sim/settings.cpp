#include "sim/settings.h"

#include "base/text.h"
#include "base/units.h"
#include "devices/kind.h"

namespace sandlot {

std::optional<double> setting(const model::DeviceDecl& device, std::string_view path) {
  const auto kind = find_device_kind(device.kind);
  if (!kind) return std::nullopt;
  for (const FieldInfo& field : (*kind)->describe()) {
    if (field.path != path) continue;
    const Node* node = &device.config;
    for (const std::string_view key : split(path, '/')) node = node ? node->find(key) : nullptr;
    const std::string& text = node ? node->text() : field.default_value;
    if (text.empty()) return std::nullopt;
    const auto value = parse_quantity(text, field.unit);
    return value ? std::optional(*value) : std::nullopt;
  }
  return std::nullopt;
}

std::vector<std::uint32_t> joints_of(const model::DeviceDecl& device, const model::Model& model) {
  std::vector<std::uint32_t> joints;
  const auto take = [&](const Node& name) {
    if (const auto joint = model.find_joint(name.text())) joints.push_back(*joint);
  };
  for (const Node::Entry& entry : device.config.entries()) {
    const std::string& key = entry.key;
    if (!key.ends_with("joint") && !key.ends_with("joints")) continue;
    if (entry.value.is_scalar()) take(entry.value);
    for (const Node& item : entry.value.items()) take(item);
  }
  return joints;
}

}  // namespace sandlot
