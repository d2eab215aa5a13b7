#include "formats/sdf/sdf.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "base/text.h"
#include "formats/sdf/document.h"
#include "formats/sdf/model_reader.h"
#include "formats/text.h"

namespace sandlot::formats {
namespace {

constexpr const char* world_children = "gravity physics* model* light* frame* plugin*";
/// What is for the eye, the ear or the map only.
constexpr const char* silent_world_children =
    "scene gui audio atmosphere magnetic_field spherical_coordinates";

/// World plugins that ask Gazebo for what Sandlot does anyway.
bool is_standard_plugin(const Xml& plugin) {
  static constexpr const char* standard[] = {
      "physics",     "scenebroadcaster", "usercommands", "sensors",      "contact", "imu",
      "forcetorque", "altimeter",        "airpressure",  "magnetometer", "navsat"};
  const std::string* const name = plugin.attribute("name");
  if (!name) return false;
  std::string last;
  for (const char c : name->substr(name->rfind(':') + 1))
    if (c != '_' && c != '-') last += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(std::begin(standard), std::end(standard), last) != std::end(standard);
}

Status read_physics(const Xml& world, SdfContent& out) {
  const Xml* chosen = nullptr;
  for (const Xml& child : world.children) {
    if (child.name != "physics") continue;
    const std::string* const preferred = child.attribute("default");
    if (!chosen || (preferred && (*preferred == "true" || *preferred == "1"))) chosen = &child;
  }
  const Xml* const step = chosen ? chosen->child("max_step_size") : nullptr;
  if (step) {
    SL_ASSIGN(const double step_s, read_double(*step, {1e-6, 10}));
    out.max_step_s = step_s;
  }
  return {};
}

Result<model::Light> read_light(const Xml& element, Notes& notes) {
  model::Light light;
  const std::string* const type = element.attribute("type");
  light.name = *element.attribute("name");
  notes.unused(element, "pose diffuse direction",
               "cast_shadows intensity specular attenuation spot visualize visual light_on");
  if (!type || (*type != "directional" && *type != "point" && *type != "spot"))
    return element.error("light '" + light.name + "' has no type that is known",
                         "write directional, point or spot");
  light.type = *type == "directional" ? model::Light::Type::directional
               : *type == "point"     ? model::Light::Type::point
                                      : model::Light::Type::spot;
  if (const Xml* const pose = element.child("pose"))
    if (const std::string* const relative = pose->attribute("relative_to");
        relative && !relative->empty() && *relative != "world")
      notes.warn(*pose, "relative_to of a light is not used", "it is placed in the world");
  SL_ASSIGN(light.X_PLight, read_child_pose(element));
  light.color = {1, 1, 1, 1};
  if (const Xml* const diffuse = element.child("diffuse")) { SL_ASSIGN(light.color, read_color(*diffuse)); }
  Vec3 direction{0, 0, -1};
  SL_TRY(read_child(element, "direction", position_range, direction));
  if (!(norm(direction) > 1e-6))
    return element.child("direction")->error("the direction of this light is zero");
  light.X_PLight.q = light.X_PLight.q * quat_between({0, 0, -1}, normalised(direction));
  return light;
}

/// Instances by address: the sanitised name must be unique.
class Instances {
 public:
  Status add(const Xml& element, const ResolvedFrames& frames, Notes& notes, SdfContent& out) {
    model::Instance instance;
    instance.original_name = *element.attribute("name");
    instance.name = sanitised(instance.original_name);
    instance.place = element.place;
    const auto [known, fresh] = places_.emplace(instance.name, &element);
    if (!fresh)
      return element.error("models '" + *known->second->attribute("name") + "' and '" +
                               instance.original_name + "' have the same address '" + instance.name + "'",
                           "rename one; the other is at " + to_string(known->second->place));
    SL_ASSIGN(instance.model, read_model(element, frames, notes));
    SL_ASSIGN(instance.X_WM, model_pose(element, frames));
    instance.devices = instance.model->devices;
    instance.is_robot = !instance.devices.empty();
    out.instances.push_back(std::move(instance));
    return {};
  }

 private:
  std::map<std::string, const Xml*> places_;
};

Status read_world(const Xml& world, const ResolvedFrames& frames, Notes& notes, SdfContent& out) {
  notes.unused(world, world_children, silent_world_children);
  const std::string* const name = world.attribute("name");
  out.world_name = name && !name->empty() ? *name : "world";
  SL_TRY(read_child(world, "gravity", {-1e4, 1e4}, out.gravity_mps2));
  if (const Xml* const gravity = world.child("gravity")) out.gravity_place = gravity->place;
  SL_TRY(read_physics(world, out));
  Instances instances;
  for (const Xml& child : world.children) {
    if (child.name == "model") {
      SL_TRY(instances.add(child, frames, notes, out));
    } else if (child.name == "light") {
      SL_ASSIGN(model::Light light, read_light(child, notes));
      out.lights.push_back(std::move(light));
    } else if (child.name == "plugin" && !is_standard_plugin(child)) {
      const std::string* const plugin = child.attribute("name");
      notes.warn(child, "plugin '" + (plugin ? plugin->substr(0, 100) : "") + "' of the world is not used");
    } else if (starts_with(child.name, "sandlot:")) {
      return child.error("<" + child.name.substr(0, 60) + "> means nothing in a <world>",
                         "put it into a <model>");
    }
  }
  return {};
}

}  // namespace

Result<SdfContent> parse_sdf(std::string_view text, const std::string& file, Diagnostics& diagnostics,
                             const SdfOptions& options) {
  Notes notes(diagnostics);
  SL_ASSIGN(const Xml root, load_document(text, file, notes, options));
  SL_TRY(check_names(root));
  const Xml& main = *main_element(root);
  for (const Xml& child : root.children)
    if (&child != &main && child.name.find(':') == std::string::npos)
      notes.warn(child, "<" + child.name.substr(0, 60) + "> is not used",
                 "the " + main.name + " of this file is read");
  SL_ASSIGN(const ResolvedFrames frames, resolve_frames(root));
  SdfContent out;
  if (main.name == "world") {
    SL_TRY(read_world(main, frames, notes, out));
  } else {
    Instances instances;
    SL_TRY(instances.add(main, frames, notes, out));
  }
  return out;
}

Result<SdfContent> read_sdf(const std::string& path, Diagnostics& diagnostics, const SdfOptions& options) {
  SL_ASSIGN(const std::string text, read_text_file(path, options.limits.max_bytes));
  return parse_sdf(text, path, diagnostics, options);
}

}  // namespace sandlot::formats
