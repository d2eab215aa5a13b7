#include "sim/load/declared_devices.h"

#include <algorithm>

#include "base/text.h"
#include "devices/kind.h"
#include "formats/scenario/scenario.h"
#include "sim/load/joint_controllers.h"
#include "sim/load/presets.h"

namespace sandlot {
namespace {

Result<std::uint32_t> link_named(const model::Model& model, const Node& name, const std::string& path) {
  if (const auto index = model.find_link(name.text())) return *index;
  std::vector<std::string> names;
  for (const model::Link& link : model.links) names.push_back(link.name);
  return name.error("model '" + model.name + "' has no link '" + name.text() + "'",
                    suggestion(name.text(), names), path);
}

/// Name of a device in its file, for messages.
std::string sdf_name(const model::DeviceDecl& decl) {
  if (decl.sdf_types.empty()) return "'" + decl.name + "'";
  const std::string& type = decl.sdf_types.front();
  if (starts_with(type, "sensor:")) return "<sensor type=\"" + type.substr(7) + "\">";
  return "plugin '" + type.substr(starts_with(type, "plugin:") ? 7 : 0) + "'";
}

}  // namespace

Status translate_devices(model::Instance& instance, const SearchPath& path, Diagnostics& diagnostics) {
  std::vector<model::DeviceDecl> kept, controllers;
  for (model::DeviceDecl& decl : instance.devices) {
    if (decl.kind.empty()) {
      if (is_ros_control_plugin(decl)) {
        SL_ASSIGN(auto more, controllers_of_plugin(decl, path, diagnostics));
        std::move(more.begin(), more.end(), std::back_inserter(controllers));
        continue;
      }
      const Kind* const kind = find_device_kind_for_sdf(decl);
      if (!kind) {
        diagnostics.warn({sdf_name(decl) + " is not supported", "it is ignored", decl.place});
        continue;
      }
      auto config = kind->from_sdf(decl.config, diagnostics);
      if (!config) {
        if (!config.error().place.file) config.error().place = decl.place;
        return std::move(config.error());
      }
      decl.config = std::move(*config);
      decl.kind = kind->name;
      if (const Node* const link = decl.config.find("link")) {
        SL_ASSIGN(decl.link, link_named(*instance.model, *link, ""));
        decl.config.erase("link");
      }
    }
    kept.push_back(std::move(decl));
  }
  instance.devices = std::move(kept);
  return add_devices(instance, std::move(controllers));
}

Status merge_devices(model::Instance& instance, const Node& devices) {
  for (const Node::Entry& entry : devices.entries()) {
    const auto found = std::find_if(instance.devices.begin(), instance.devices.end(),
                                    [&](const model::DeviceDecl& d) { return d.name == entry.key; });
    const bool fresh = found == instance.devices.end();
    model::DeviceDecl decl = fresh ? model::DeviceDecl{} : *found;
    Node keys = entry.value;
    if (!keys.is_map() && !keys.is_null()) return wrong_type(keys, "a map of keys", "/devices/" + entry.key);
    const std::string path = "/devices/" + entry.key;
    decl.name = entry.key;
    decl.place = entry.key_place;
    if (const Node* kind = keys.find("kind")) decl.kind = kind->text();
    if (decl.kind.empty()) {
      std::vector<std::string> names;
      for (const model::DeviceDecl& d : instance.devices) names.push_back(d.name);
      return Error{"model '" + instance.model->name + "' has no device '" + entry.key + "'",
                   "give it a kind, or " + suggestion(entry.key, names), entry.key_place, path};
    }
    if (const Node* link = keys.find("link")) {
      SL_ASSIGN(decl.link, link_named(*instance.model, *link, path + "/link"));
    }
    if (const Node* pose = keys.find("pose")) {
      SL_ASSIGN(decl.X_LS, formats::read_pose(*pose, path + "/pose"));
    }
    for (const char* own : {"kind", "link", "pose"}) keys.erase(own);
    if (decl.config.is_null()) decl.config = Node::map(decl.place);
    if (keys.find("level") || keys.find("levels")) {
      decl.config.erase("level");
      decl.config.erase("levels");
    }
    // A preset takes precedence over the model's keys, and the keys given in addition over both.
    SL_TRY(lay_preset(keys, decl.kind));
    merge(decl.config, keys);
    if (fresh) instance.devices.push_back(std::move(decl));
    else *found = std::move(decl);
  }
  return {};
}

}  // namespace sandlot
