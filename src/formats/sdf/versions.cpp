#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "formats/sdf/document.h"

namespace sandlot::formats {
namespace {

constexpr int oldest = 2, last_old = 4, last_whole = 9, newest = 12;  ///< minor versions

void rename_attribute(Xml& element, const char* from, const char* to) {
  for (auto& [key, value] : element.attributes)
    if (key == from) key = to;
}

/// Until 1.4 an axis was in the model's frame, then in that of the joint unless given otherwise.
void modernise_axis(Xml& axis, int minor) {
  const Xml* const flag = axis.child("use_parent_model_frame");
  const bool in_model = flag ? is_one_of(flag->text, {"1", "true", "True", "TRUE"}) : minor <= last_old;
  Xml* const xyz = axis.child("xyz");
  if (in_model && xyz) xyz->set_attribute("expressed_in", "__model__");
  std::erase_if(axis.children, [](const Xml& child) { return child.name == "use_parent_model_frame"; });
}

/// Until 1.5 an <imu> had one <noise> for its rates and one for its accelerations, in one element.
void modernise_imu(Xml& imu) {
  const Xml* const found = imu.child("noise");
  if (!found) return;
  const Xml noise = *found;
  const Xml* const type = noise.child("type");
  std::erase_if(imu.children, [](const Xml& child) { return child.name == "noise"; });
  const std::pair<const char*, const char*> groups[] = {{"rate", "angular_velocity"},
                                                        {"accel", "linear_acceleration"}};
  for (const auto& [old_name, new_name] : groups) {
    const Xml* const values = noise.child(old_name);
    if (!values) continue;
    Xml group{new_name, {}, "", {}, values->place};
    for (const char* const axis : {"x", "y", "z"}) {
      Xml one = *values;
      one.name = "noise";
      one.attributes = {{"type", type ? type->text : "gaussian"}};
      group.children.push_back({axis, {}, "", {std::move(one)}, values->place});
    }
    imu.children.push_back(std::move(group));
  }
}

/// What stood in <physics> stands in the <world> since 1.6.
void modernise_world(Xml& world) {
  for (const char* const key : {"gravity", "magnetic_field"}) {
    const Xml* const physics = world.child("physics");
    const Xml* const value = physics && !world.child(key) ? physics->child(key) : nullptr;
    if (value) world.children.push_back(Xml(*value));
  }
}

}  // namespace

Result<int> version_of(const Xml& root, Notes& notes) {
  if (root.name != "sdf")
    return root.error("the root element is <" + root.name.substr(0, 60) + ">",
                      "an SDF file begins with <sdf version=\"1.9\">, a URDF file with <robot>");
  const std::string* const text = root.attribute("version");
  if (!text) return root.error("<sdf> has no version", "write <sdf version=\"1.9\">");
  const std::vector<std::string_view> parts = split(*text, '.');
  double major = 0, minor = 0;
  const bool numbers = parts.size() == 2 && !parts[1].empty() && parts[1].size() <= 2 &&
                       parse_number(parts[0], major) && parse_number(parts[1], minor);
  if (!numbers || major != 1 || minor != std::floor(minor) || minor < oldest || minor > newest)
    return root.error("version '" + text->substr(0, 20) + "' of SDF is not known", "1.2 to 1.12 are read");
  if (minor <= last_old)
    notes.warn(root, "version " + *text + " of SDF is older than 1.5",
               "it is read as 1.5 with the axes of joints in the model's frame; convert it if that is wrong");
  if (minor > last_whole)
    notes.warn(root, "version " + *text + " of SDF is newer than 1.9",
               "not all of what it added is understood");
  return static_cast<int>(minor);
}

void modernise(Xml& element, int minor) {
  if (minor >= 7) return;
  if (element.name == "pose") rename_attribute(element, "frame", "relative_to");
  if (element.name == "axis" || element.name == "axis2") modernise_axis(element, minor);
  if (element.name == "imu" && minor < 6) modernise_imu(element);
  if (element.name == "world" && minor < 6) modernise_world(element);
  for (Xml& child : element.children) modernise(child, minor);
}

}  // namespace sandlot::formats
