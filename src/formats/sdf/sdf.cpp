#include "formats/sdf/sdf.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "base/math.h"
#include "base/text.h"
#include "files/text.h"
#include "formats/sdf/comms.h"
#include "formats/sdf/document.h"
#include "formats/sdf/model_reader.h"

namespace sandlot::formats {
namespace {

constexpr const char* world_children =
    "gravity physics* model* light* frame* joint* plugin* scene magnetic_field spherical_coordinates wind";
/// What is for the eye, the ear or the map only.
constexpr const char* silent_world_children = "gui audio atmosphere";

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

/// Keys of `physics:` of the engine `rigid` that mean what elements of SDF mean.
Status read_ode(const Xml& ode, WorldContent& out, const Reading& in) {
  const auto take = [&](const Xml* parent, const char* element, const char* key, Range range) -> Status {
    const Xml* const child = parent ? parent->child(element) : nullptr;
    if (!child) return {};
    SL_ASSIGN(const double value, read_double(*child, range));
    // 0 is how files say "rigid", which no solver is.
    if (value > 0) out.physics.set(key, Node::scalar(number_text(value), child->place));
    return {};
  };
  in.notes.unused(ode, "solver constraints");
  const Xml* const solver = ode.child("solver");
  const Xml* const constraints = ode.child("constraints");
  if (solver)
    in.notes.unused(*solver, "iters",
                    "type sor precon_iters friction_model island_threads min_step_size "
                    "thread_position_correction use_dynamic_moi_rescaling");
  if (constraints)
    in.notes.unused(*constraints, "cfm erp contact_max_correcting_vel", "contact_surface_layer");
  SL_TRY(take(solver, "iters", "quick_iterations", {0, 10000}));
  SL_TRY(take(constraints, "cfm", "cfm", {0, 1}));
  SL_TRY(take(constraints, "erp", "erp", {0, 1}));
  SL_TRY(take(constraints, "contact_max_correcting_vel", "contact_correction", {0, 1e6}));
  return {};
}

Status read_physics(const Xml& world, WorldContent& out, const Reading& in) {
  const Xml* chosen = nullptr;
  for (const Xml& child : world.children) {
    if (child.name != "physics") continue;
    const std::string* const preferred = child.attribute("default");
    if (!chosen || (preferred && (*preferred == "true" || *preferred == "1"))) chosen = &child;
  }
  if (!chosen) return {};
  in.notes.unused(
      *chosen, "max_step_size ode",
      "real_time_factor real_time_update_rate max_contacts gravity magnetic_field dart bullet simbody "
      "collision_detector");
  if (const Xml* const step = chosen->child("max_step_size")) {
    SL_ASSIGN(const double step_s, read_double(*step, {1e-6, 10}));
    out.max_step_s = step_s;
  }
  out.physics = Node::map(chosen->place);
  if (const Xml* const ode = chosen->child("ode")) SL_TRY(read_ode(*ode, out, in));
  return {};
}

Status read_scene(const Xml& world, WorldContent& out) {
  const Xml* const scene = world.child("scene");
  if (const Xml* const ambient = scene ? scene->child("ambient") : nullptr) {
    SL_ASSIGN(out.ambient, read_color(*ambient));
  }
  if (const Xml* const background = scene ? scene->child("background") : nullptr) {
    SL_ASSIGN(out.background, read_color(*background));
  }
  return {};
}

Status read_geography(const Xml& element, WorldContent& out, const Reading& in) {
  in.notes.unused(element,
                  "latitude_deg longitude_deg elevation heading_deg world_frame_orientation surface_model",
                  "surface_axis_equatorial surface_axis_polar");
  if (const Xml* const axes = element.child("world_frame_orientation"); axes && axes->text != "ENU")
    in.notes.warn(*axes, "the world's axes are east, north, up whatever this says", "write ENU");
  model::Geography place;
  double heading_deg = 0, latitude_deg = 0, longitude_deg = 0;
  SL_TRY(read_child(element, "latitude_deg", {-90, 90}, latitude_deg));
  SL_TRY(read_child(element, "longitude_deg", {-360, 360}, longitude_deg));
  SL_TRY(read_child(element, "heading_deg", {-3600, 3600}, heading_deg));
  SL_TRY(read_child(element, "elevation", position_range, place.elevation_m));
  constexpr double degree = math::pi / 180;
  place.latitude_rad = latitude_deg * degree;
  place.longitude_rad = longitude_deg * degree;
  place.heading_rad = heading_deg * degree;
  out.geography = place;
  return {};
}

/// Instances by address: the sanitised name must be unique.
class Instances {
 public:
  Status add(const Xml& element, const std::vector<const Xml*>& world_joints, const Reading& in,
             WorldContent& out) {
    model::Instance instance;
    instance.original_name = *element.attribute("name");
    instance.name = sanitised(instance.original_name);
    instance.place = element.place;
    const auto [known, fresh] = places_.emplace(instance.name, &element);
    if (!fresh)
      return element.error("models '" + *known->second->attribute("name") + "' and '" +
                               instance.original_name + "' have the same address '" + instance.name + "'",
                           "rename one; the other is at " + to_string(known->second->place));
    SL_ASSIGN(instance.model, read_model(element, world_joints, in));
    SL_ASSIGN(instance.X_WM, in.pose(element));
    if (element.attribute("sandlot:actor")) {
      SL_ASSIGN(instance.motion, read_motion(element, instance.X_WM, in));
      if (instance.motion) instance.X_WM = instance.motion->keys.front().X_WM;
    }
    instance.devices = instance.model->devices;
    instance.is_robot = !instance.devices.empty();
    out.instances.push_back(std::move(instance));
    return {};
  }

 private:
  std::map<std::string, const Xml*> places_;
};

/// Joints of the world by the model that their child is in.
std::map<std::string, std::vector<const Xml*>, std::less<>> joints_by_model(const Xml& world,
                                                                            const ResolvedFrames& frames) {
  std::map<std::string, std::vector<const Xml*>, std::less<>> out;
  for (const Xml& model : world.children)
    if (model.name == "model") out[*model.attribute("name")];
  for (const Xml& joint : world.children) {
    if (joint.name != "joint") continue;
    const auto resolved = frames.child_links.find(&joint);
    const std::string child = resolved == frames.child_links.end() ? joint.child("child")->text
                                                                   : resolved->second;
    for (std::size_t at = child.rfind("::"); at != std::string::npos && at > 0;
         at = child.rfind("::", at - 1)) {
      const auto model = out.find(child.substr(0, at));
      if (model == out.end()) continue;
      model->second.push_back(&joint);
      break;
    }
  }
  return out;
}

Status read_sdf_world(const Xml& world, const Reading& in, WorldContent& out) {
  in.notes.unused(world, world_children, silent_world_children);
  const std::string* const name = world.attribute("name");
  out.world_name = name && !name->empty() ? *name : "world";
  SL_TRY(read_child(world, "gravity", {-1e4, 1e4}, out.gravity));
  SL_TRY(read_child(world, "magnetic_field", {-1, 1}, out.magnetic_field_T));
  SL_TRY(read_physics(world, out, in));
  SL_TRY(read_scene(world, out));
  if (const Xml* const geography = world.child("spherical_coordinates"))
    SL_TRY(read_geography(*geography, out, in));
  if (const Xml* const wind = world.child("wind"))
    in.notes.warn(*wind, "<wind> is not used", "the air stands still");
  if (const Xml* const gravity = world.child("gravity")) out.gravity_place = gravity->place;
  Instances instances;
  const auto joints = joints_by_model(world, in.frames);
  for (const Xml& child : world.children) {
    if (child.name == "model") {
      SL_TRY(instances.add(child, joints.find(*child.attribute("name"))->second, in, out));
    } else if (child.name == "light") {
      SL_ASSIGN(model::Light light, read_light(child, in));
      out.lights.push_back(std::move(light));
    } else if (child.name == "plugin" && !is_standard_plugin(child)) {
      SL_ASSIGN(const bool is_comms, read_comms(child, in, out));
      if (is_comms) continue;
      const std::string* const plugin = child.attribute("name");
      in.notes.warn(child,
                    "plugin '" + (plugin ? plugin->substr(0, 100) : "") + "' of the world is not used");
    } else if (starts_with(child.name, "sandlot:")) {
      return child.error("<" + child.name.substr(0, 60) + "> means nothing in a <world>",
                         "put it into a <model>");
    }
  }
  connect_endpoints(out, in);
  return {};
}

}  // namespace

Result<WorldContent> parse_sdf(std::string_view text, const std::string& file, Diagnostics& diagnostics,
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
  const Reading in{options, notes, frames};
  WorldContent out;
  if (main.name == "world") {
    SL_TRY(read_sdf_world(main, in, out));
  } else {
    Instances instances;
    SL_TRY(instances.add(main, {}, in, out));
  }
  return out;
}

Result<WorldContent> read_sdf(const std::string& path, Diagnostics& diagnostics, const SdfOptions& options) {
  SL_ASSIGN(const std::string text, read_text_file(path, options.limits.max_bytes));
  return parse_sdf(text, path, diagnostics, options);
}

}  // namespace sandlot::formats
