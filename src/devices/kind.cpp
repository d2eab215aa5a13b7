#include "devices/kind.h"

#include <algorithm>

#include "devices/kinds.h"

namespace sandlot {
#define SL_DECLARE(name)  \
  namespace name {        \
  extern const Kind kind; \
  }
SANDLOT_DEVICES(SL_DECLARE)
#undef SL_DECLARE

Error DeviceBuild::error(const char* spec_key, std::string what, std::string fix) const {
  const Node* const node = decl.config.find(spec_key);
  return {std::move(what), std::move(fix), node && node->place().file ? node->place() : decl.place,
          std::string("/") + spec_key};
}

Result<std::uint32_t> DeviceBuild::joint_index(std::string_view name, const char* spec_key) const {
  if (const auto index = instance.model->find_joint(decl.scope + std::string(name))) return *index;
  if (const auto index = instance.model->find_joint(name)) return *index;
  std::vector<std::string> names;
  for (const model::Joint& joint : instance.model->joints) names.push_back(joint.name);
  return error(spec_key, "model '" + instance.model->name + "' has no joint '" + std::string(name) + "'",
               names.empty() ? "it has no joints" : suggestion(name, names));
}

Result<JointId> DeviceBuild::joint(std::string_view name, const char* spec_key) const {
  SL_ASSIGN(const std::uint32_t index, joint_index(name, spec_key));
  return joints[index];
}

Result<const DeviceService*> service_of(const Kind& kind, std::string_view device, std::string_view service) {
  std::vector<std::string> known;
  for (const DeviceService& each : kind.services) {
    if (service == each.name) return &each;
    known.emplace_back(each.name);
  }
  return Error{"'" + std::string(device) + "' offers no service '" + std::string(service.substr(0, 60)) + "'",
               known.empty() ? "a " + std::string(kind.name) + " offers none" : suggestion(service, known)};
}

std::span<const Kind* const> device_kinds() {
#define SL_ENTRY(name) &name::kind,
  static const Kind* const table[] = {SANDLOT_DEVICES(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

Result<std::uint32_t> DeviceBuild::medium(std::string_view name, const char* kind,
                                          const char* spec_key) const {
  std::optional<std::uint32_t> found;
  std::vector<std::string> names;
  for (std::uint32_t i = 0; i < media.size(); ++i) {
    if (media[i].kind != kind) continue;
    names.push_back(sanitised(media[i].name));
    if (!name.empty() && name != names.back()) continue;
    if (found)
      return error(spec_key, "the world has several media of kind " + std::string(kind),
                   "name one of them: " + names.front() + ", " + names.back());
    found = i;
  }
  if (found) return *found;
  const std::string wanted = name.empty() ? "" : " named '" + std::string(name.substr(0, 60)) + "'";
  return error(spec_key, "the world has no medium of kind " + std::string(kind) + wanted,
               names.empty() ? "declare it in the scenario: media: [{kind: " + std::string(kind) + "}]"
                             : suggestion(name, names));
}

Result<const Kind*> find_device_kind(std::string_view name) {
  std::vector<std::string> names;
  for (const Kind* kind : device_kinds()) {
    if (name == kind->name) return kind;
    names.emplace_back(kind->name);
  }
  return Error{"no kind of device '" + std::string(name) + "'", suggestion(name, names)};
}

const Kind* find_device_kind_for_sdf(const model::DeviceDecl& decl) {
  // "plugin:path/libgazebo_ros_imu.so" is "plugin:gazebo_ros_imu".
  const auto plain = [](std::string_view type) {
    std::string name(type.substr(0, type.find(':') + 1));
    std::string_view rest = type.substr(name.size());
    if (name == "plugin:") {
      if (const auto slash = rest.rfind('/'); slash != std::string_view::npos) rest.remove_prefix(slash + 1);
      if (rest.size() > 3 && rest.substr(rest.size() - 3) == ".so") rest.remove_suffix(3);
      if (rest.size() > 3 && rest.substr(0, 3) == "lib") rest.remove_prefix(3);
    }
    return name.append(rest);
  };
  const auto answers = [&](const Kind& kind, const std::string& type) {
    return std::any_of(kind.sdf_types.begin(), kind.sdf_types.end(),
                       [&](const char* t) { return type == t; }) &&
           (!kind.accepts || kind.accepts(decl.config));
  };
  // In the list a sensor's plugins come last, and a plugin's class before its library.
  std::vector<std::string> types;
  for (const std::string& type : decl.sdf_types) types.push_back(plain(type));
  if (!types.empty() && types.front().substr(0, 7) == "sensor:") std::reverse(types.begin(), types.end());
  for (const std::string& type : types)
    for (const Kind* kind : device_kinds())
      if (answers(*kind, type)) return kind;
  return nullptr;
}

}  // namespace sandlot
