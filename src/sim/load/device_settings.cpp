#include "sim/load/device_settings.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/text.h"
#include "base/units.h"
#include "devices/kind.h"
#include "sim/load/presets.h"

namespace sandlot {

namespace {

/// The fields of each kind, listed once: a world may have ten thousand devices.
const std::vector<FieldInfo>* fields_of(std::string_view kind) {
  static const auto all = [] {
    std::map<std::string, std::vector<FieldInfo>, std::less<>> fields;
    for (const Kind* const one : device_kinds()) fields.emplace(one->name, one->describe());
    return fields;
  }();
  const auto found = all.find(kind);
  return found == all.end() ? nullptr : &found->second;
}

}  // namespace

std::optional<double> setting(const model::DeviceDecl& device, std::string_view path) {
  const std::vector<FieldInfo>* const fields = fields_of(device.kind);
  if (!fields) return std::nullopt;
  for (const FieldInfo& field : *fields) {
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

void set_default_rate(model::DeviceDecl& device, double rate_hz, const Place& place) {
  const std::vector<FieldInfo>* const fields = fields_of(device.kind);
  // An element of SDF without a rate has been translated into "every tick", at the element's own place.
  const auto given = [](const Node& config) {
    const Node* const rate = config.find("rate");
    const Place &a = rate ? rate->place() : config.place(), &b = config.place();
    return rate && !(rate->text() == "0" && a.line > 0 && a.line == b.line && a.column == b.column &&
                     a.file && b.file && *a.file == *b.file);
  };
  if (!fields || given(device.config)) return;
  if (std::none_of(fields->begin(), fields->end(),
                   [](const FieldInfo& field) { return field.path == "rate"; }))
    return;
  Node with_preset = device.config;
  // An unknown preset is an error where the device is built.
  if (!lay_preset(with_preset, device.kind) || given(with_preset)) return;
  if (device.config.is_null()) device.config = Node::map(device.place);
  device.config.set("rate", Node::scalar(number_text(rate_hz), place));
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

bool drives(const Kind& kind) {
  return (kind.phases & phase_pre_substep) &&
         std::any_of(kind.levels.begin(), kind.levels.end(), [](const LevelInfo& l) { return *l.command; });
}

std::vector<std::uint32_t> driven_joints(const model::DeviceDecl& device, const Kind& kind,
                                         const model::Model& model) {
  using model::JointType;
  std::vector<std::uint32_t> joints = joints_of(device, model);
  if (!joints.empty()) return joints;
  const std::vector<FieldInfo> fields = kind.describe();
  if (std::none_of(fields.begin(), fields.end(), [](const FieldInfo& f) { return f.path == "joints"; }))
    return joints;
  for (std::uint32_t i = 0; i < model.joints.size(); ++i)
    if (const JointType type = model.joints[i].type;
        type == JointType::revolute || type == JointType::continuous || type == JointType::prismatic)
      joints.push_back(i);
  return joints;
}

std::string kinds_with(std::string_view message_type, bool commands) {
  std::vector<std::string> names;
  for (const Kind* const kind : device_kinds())
    if (std::any_of(kind->levels.begin(), kind->levels.end(), [&](const LevelInfo& level) {
          return message_type == (commands ? level.command : level.message);
        }))
      names.emplace_back(kind->name);
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 < names.size() ? ", " : " or ") + names[i];
  return text;
}

}  // namespace sandlot
