#include <cctype>
#include <map>

#include "base/text.h"
#include "files/yaml.h"
#include "formats/sdf/model_reader.h"

namespace sandlot::formats {
namespace {

bool upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

/// "DiffDrive" becomes "diff_drive", "IMUSensor" "imu_sensor".
std::string snake_case(const std::string& name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool word = i > 0 && upper(name[i]) && name[i - 1] != '_' &&
                      (!upper(name[i - 1]) ||
                       (i + 1 < name.size() && !upper(name[i + 1]) && name[i + 1] != '_'));
    if (word) out += '_';
    out += static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
  }
  return out;
}

std::string last_component(const std::string& name, const char* separator) {
  const std::size_t at = name.rfind(separator);
  return at == std::string::npos ? name : name.substr(at + std::string_view(separator).size());
}

/// A text such as "[1, 2]" in an element of ours is YAML: XML has no lists of its own.
Status read_flow(Node& node) {
  if (node.is_scalar() && !node.text().empty() &&
      (node.text().front() == '[' || node.text().front() == '{')) {
    auto value = parse_yaml(node.text(), "", {.max_bytes = 1u << 20, .max_depth = 16, .max_nodes = 100'000});
    if (!value) return node.error("this list cannot be read: " + value.error().what, value.error().fix);
    const Place place = node.place();
    const auto put = [&](auto& self, Node& each) -> void {
      each.set_place(place);
      for (Node& item : each.items()) self(self, item);
      for (Node::Entry& entry : each.entries()) {
        entry.key_place = place;
        self(self, entry.value);
      }
    };
    put(put, *value);
    node = std::move(*value);
    return {};
  }
  for (Node& item : node.items()) SL_TRY(read_flow(item));
  for (Node::Entry& entry : node.entries()) SL_TRY(read_flow(entry.value));
  return {};
}

bool is_plugin(const model::DeviceDecl& device) {
  return !device.sdf_types.empty() && starts_with(device.sdf_types.front(), "plugin:");
}
bool is_sensor(const model::DeviceDecl& device) {
  return !device.sdf_types.empty() && starts_with(device.sdf_types.front(), "sensor:");
}

}  // namespace

Result<model::DeviceDecl> read_sensor(const Xml& element, const Reading& in) {
  model::DeviceDecl device;
  device.place = element.place;
  device.name = *element.attribute("name");
  const std::string* const type = element.attribute("type");
  if (!type || type->empty())
    return element.error("sensor '" + device.name + "' has no type", "write type=\"gpu_lidar\"");
  device.sdf_types.push_back("sensor:" + *type);
  // Gazebo Classic tells sensors of one type apart by the plugin inside.
  for (const Xml& child : element.children)
    if (const std::string* const file = child.name == "plugin" ? child.attribute("filename") : nullptr)
      device.sdf_types.push_back("plugin:" + *file);
  SL_ASSIGN(device.X_LS, in.pose(element));
  device.config = node_of(element);
  device.config.erase("pose");
  return device;
}

Result<model::DeviceDecl> read_plugin(const Xml& element) {
  const std::string* const name = element.attribute("name");
  const std::string* const file = element.attribute("filename");
  const bool named = name && !trim(*name).empty(), filed = file && !trim(*file).empty();
  if (!named && !filed) return element.error("this <plugin> has neither name nor filename");
  model::DeviceDecl device;
  device.place = element.place;
  std::string library = filed ? last_component(*file, "/") : "";
  if (starts_with(library, "lib")) library = library.substr(3);
  if (library.size() > 3 && library.substr(library.size() - 3) == ".so") library.resize(library.size() - 3);
  const std::string last = named ? last_component(*name, "::") : library;
  device.name = snake_case(last);
  device.sdf_types.push_back("plugin:" + last);
  if (filed && library != last) device.sdf_types.push_back("plugin:" + library);
  device.config = node_of(element);
  return device;
}

Result<model::DeviceDecl> read_native_device(const Xml& element) {
  if (element.name != "sandlot:device")
    return element.error("unknown element <" + element.name.substr(0, 60) + ">",
                         "did you mean 'sandlot:device'?");
  model::DeviceDecl device;
  device.place = element.place;
  for (const auto& [key, value] : element.attributes) {
    if (key == "name") device.name = value;
    else if (key == "kind") device.kind = value;
    else if (key != "link" && !starts_with(key, "xmlns"))
      return element.error("<sandlot:device> has no attribute '" + key.substr(0, 60) + "'",
                           suggestion(key, std::vector<std::string>{"name", "kind", "link"}));
  }
  if (device.name.empty()) return element.error("<sandlot:device> has no name", "write name=\"laser\"");
  if (device.kind.empty())
    return element.error("device '" + device.name + "' has no kind", "write kind=\"laser_scanner\"");
  if (const Xml* const pose = element.child("pose")) {
    if (const std::string* const relative = pose->attribute("relative_to"); relative && !relative->empty())
      return pose->error("the pose of a <sandlot:device> is relative to its link", "leave relative_to out");
    SL_ASSIGN(device.X_LS, read_sdf_pose(*pose));
  }
  Xml keys = element;
  keys.attributes.clear();
  std::erase_if(keys.children, [](const Xml& child) { return child.name == "pose"; });
  device.config = keys.children.empty() ? Node::map(element.place) : node_of(keys);
  SL_TRY(read_flow(device.config));
  return device;
}

Status name_devices(model::Model& model) {
  // SDF lets the sensors of two links have one name; the address of each then begins with its link's.
  std::map<std::string, int> sensors;
  for (const model::DeviceDecl& device : model.devices)
    if (is_sensor(device)) ++sensors[sanitised(device.name)];
  for (model::DeviceDecl& device : model.devices)
    if (is_sensor(device) && sensors[sanitised(device.name)] > 1)
      device.name = model.links[device.link].name + "_" + device.name;
  std::map<std::string, Place> taken;
  for (model::DeviceDecl& device : model.devices) {
    if (is_plugin(device)) continue;
    const auto [known, fresh] = taken.emplace(sanitised(device.name), device.place);
    if (!fresh)
      return Error{"two devices have the address '" + known->first + "'",
                   "the other one is at " + to_string(known->second), device.place};
  }
  // Plugins are often given several times under one name, once per joint.
  std::map<std::string, int> numbers;
  for (model::DeviceDecl& device : model.devices) {
    if (!is_plugin(device)) continue;
    const std::string stem = device.name;
    int& number = numbers[sanitised(stem)];
    do device.name = ++number == 1 ? stem : stem + "_" + std::to_string(number);
    while (!taken.emplace(sanitised(device.name), device.place).second);
  }
  return {};
}

}  // namespace sandlot::formats
