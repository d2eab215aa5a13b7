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

Result<std::uint32_t> DeviceBuild::joint_index(std::string_view name, const char* spec_key) const {
  if (const auto index = instance.model->find_joint(decl.scope + std::string(name))) return *index;
  if (const auto index = instance.model->find_joint(name)) return *index;
  std::vector<std::string> names;
  for (const model::Joint& joint : instance.model->joints) names.push_back(joint.name);
  const Node* const value = decl.config.find(spec_key);
  return Error{"model '" + instance.model->name + "' has no joint '" + std::string(name) + "'",
               names.empty() ? "it has no joints" : suggestion(name, names),
               value ? value->place() : decl.place, std::string("/") + spec_key};
}

Result<JointId> DeviceBuild::joint(std::string_view name, const char* spec_key) const {
  SL_ASSIGN(const std::uint32_t index, joint_index(name, spec_key));
  return joints[index];
}

std::span<const Kind* const> device_kinds() {
#define SL_ENTRY(name) &name::kind,
  static const Kind* const table[] = {SANDLOT_DEVICES(SL_ENTRY)};
#undef SL_ENTRY
  return table;
}

Result<const Kind*> find_device_kind(std::string_view name) {
  std::vector<std::string> names;
  for (const Kind* kind : device_kinds()) {
    if (name == kind->name) return kind;
    names.emplace_back(kind->name);
  }
  return Error{"no kind of device '" + std::string(name) + "'", suggestion(name, names)};
}

const Kind* find_device_kind_for_sdf(std::span<const std::string> sdf_types) {
  for (const std::string& type : sdf_types)
    for (const Kind* kind : device_kinds())
      if (std::any_of(kind->sdf_types.begin(), kind->sdf_types.end(),
                      [&](const char* t) { return type == t; }))
        return kind;
  return nullptr;
}

}  // namespace sandlot
