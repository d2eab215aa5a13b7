#include "formats/sdf/write.h"

#include <algorithm>
#include <map>

#include "base/math.h"
#include "base/text.h"
#include "formats/sdf/write_parts.h"

namespace sandlot::formats {
namespace {

using namespace writing;

std::string escaped(const std::string& text, bool attribute) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '>') out += "&gt;";
    else if (c == '"' && attribute) out += "&quot;";
    else if ((c == '\n' || c == '\t' || c == '\r') && attribute)
      out += "&#" + std::to_string(static_cast<int>(c)) + ";";
    else out += c;
  }
  return out;
}

void append(const Xml& element, std::size_t depth, std::string& out) {
  const std::string indent(2 * depth, ' ');
  out += indent + "<" + element.name;
  for (const auto& [key, value] : element.attributes) out += " " + key + "=\"" + escaped(value, true) + "\"";
  if (element.children.empty() && element.text.empty()) return void(out += "/>\n");
  out += ">" + escaped(element.text, false);
  if (!element.children.empty()) {
    out += "\n";
    for (const Xml& child : element.children) append(child, depth + 1, out);
    out += indent;
  }
  out += "</" + element.name + ">\n";
}

/// Elements of ours need their namespace declared, or XML tools refuse the file.
bool uses_ours(const Xml& element) {
  return starts_with(element.name, "sandlot:") ||
         std::any_of(element.children.begin(), element.children.end(), uses_ours);
}

/// A model with the models that were nested in it: `a::b` is b in a. Poses of nested models are the identity, so that
/// those of links stay what they are.
class ModelWriter {
 public:
  ModelWriter(const model::Model& model, std::span<const model::DeviceDecl> devices, Diagnostics& diagnostics)
      : model_(model), devices_(devices), diagnostics_(diagnostics) {}

  Result<Xml> write(const std::string& name, const Pose& X_WM) {
    Xml out = element("model");
    out.set_attribute("name", name);
    if (first_link() != model_.links[0].name) out.set_attribute("canonical_link", model_.links[0].name);
    add_pose(out, X_WM);
    if (model_.is_static) add(out, "static", "true");
    if (model_.self_collide) add(out, "self_collide", "true");
    SL_TRY(write_scope("", out));
    if (!model_.label.empty()) {
      Xml& plugin = add(out, "plugin");
      plugin.set_attribute("filename", "gz-sim-label-system");
      plugin.set_attribute("name", "gz::sim::systems::Label");
      add(plugin, "label", model_.label);
    }
    for (const model::DeviceDecl& device : devices_) {
      if (!is_native(device) && is_sensor(device)) continue;
      Xml each = device_of(device, device.X_LS);
      if (is_native(device)) each.set_attribute("link", model_.links[device.link].name);
      add(out, std::move(each));
    }
    return out;
  }

 private:
  /// The first link that the reader meets.
  const std::string& first_link() const {
    const auto depth = [](const std::string& name) { return name.find("::") != std::string::npos; };
    for (const model::Link& link : model_.links)
      if (!depth(link.name)) return link.name;
    return model_.links[0].name;
  }

  /// What `name` is called in the scope; nothing outside of it.
  static std::optional<std::string> within(const std::string& scope, const std::string& name) {
    if (!starts_with(name, scope)) return std::nullopt;
    return name.substr(scope.size());
  }

  /// Joints and frames of a scope stand before, between or after its nested models as they do in the Model.
  template <class Items>
  std::vector<std::size_t> slots(const std::string& scope, const Items& items,
                                 const std::map<std::string, std::size_t>& rank) const {
    std::vector<std::size_t> out(items.size(), ~std::size_t{0});
    std::size_t now = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
      const auto local = within(scope, items[i].name);
      if (!local) continue;
      const std::size_t colons = local->find("::");
      if (colons == std::string::npos) out[i] = now;
      else if (const auto found = rank.find(local->substr(0, colons)); found != rank.end())
        now = std::max(now, found->second + 1);
    }
    return out;
  }

  Status write_scope(const std::string& scope, Xml& out) {
    std::vector<std::string> nested;
    std::map<std::string, std::size_t> rank;
    for (std::uint32_t l = 0; l < model_.links.size(); ++l) {
      const auto local = within(scope, model_.links[l].name);
      if (!local || is_roller(l)) continue;
      const std::size_t colons = local->find("::");
      if (colons == std::string::npos) add(out, link_of(l, *local));
      else if (rank.emplace(local->substr(0, colons), nested.size()).second)
        nested.push_back(local->substr(0, colons));
    }
    const std::vector<std::size_t> joint_slots = slots(scope, model_.joints, rank);
    const std::vector<std::size_t> frame_slots = slots(scope, model_.frames, rank);
    for (std::size_t slot = 0; slot <= nested.size(); ++slot) {
      for (std::size_t j = 0; j < model_.joints.size(); ++j) {
        if (joint_slots[j] != slot || model_.joints[j].roller_of != model::Joint::no_joint) continue;
        SL_ASSIGN(Xml joint, joint_of_model(model_.joints[j], scope));
        add(out, std::move(joint));
      }
      for (std::size_t f = 0; f < model_.frames.size(); ++f) {
        if (frame_slots[f] != slot) continue;
        const model::Frame& frame = model_.frames[f];
        Xml& each = add(out, "frame");
        each.set_attribute("name", *within(scope, frame.name));
        const auto link = within(scope, model_.links[frame.link].name);
        if (!link) return outside("frame", frame.name, model_.place);
        each.set_attribute("attached_to", *link);
        add_pose(each, frame.X_LF);
      }
      if (slot == nested.size()) break;
      Xml inner = element("model");
      inner.set_attribute("name", nested[slot]);
      SL_TRY(write_scope(scope + nested[slot] + "::", inner));
      add(out, std::move(inner));
    }
    return {};
  }

  /// Rollers come of the <sandlot:rollers> of their wheel's joint.
  bool is_roller(std::uint32_t link) const {
    return std::any_of(model_.joints.begin(), model_.joints.end(), [&](const model::Joint& j) {
      return j.child == link && j.roller_of != model::Joint::no_joint;
    });
  }

  static Error outside(const std::string& sort, const std::string& name, const Place& place) {
    return {sort + " '" + name + "' of a nested model refers to a link outside of it",
            "SDF has no words for that", place};
  }

  Xml link_of(std::uint32_t l, const std::string& name) {
    const model::Link& link = model_.links[l];
    Xml out = element("link");
    out.set_attribute("name", name);
    add_pose(out, link.X_ML);
    add(out, inertial_of(link.inertial));
    if (!link.gravity) add(out, "gravity", "false");
    for (const model::Collision& collision : link.collisions) {
      Xml& each = add(out, "collision");
      each.set_attribute("name", collision.name);
      add_pose(each, collision.X_LC);
      add(each,
          geometry_of(collision.shape, "collision '" + collision.name + "'", collision.place, diagnostics_));
      if (auto surface = surface_of(collision.surface)) add(each, std::move(*surface));
    }
    for (const model::Visual& visual : link.visuals) {
      Xml& each = add(out, "visual");
      each.set_attribute("name", visual.name);
      add_pose(each, visual.X_LC);
      add(each, geometry_of(visual.shape, "visual '" + visual.name + "'", visual.place, diagnostics_));
      if (auto material = material_of(visual.material)) add(each, std::move(*material));
      if (!visual.cast_shadows) add(each, "cast_shadows", "false");
    }
    // The reader puts the names of the nested models before the light's own, as before the link's.
    const std::string scope = link.name.substr(0, link.name.size() - name.size());
    for (const model::LinkLight& light : model_.lights) {
      if (light.link != l) continue;
      Xml& each = add(out, light_of(light.light));
      each.set_attribute("name", within(scope, light.light.name).value_or(light.light.name));
    }
    for (const model::DeviceDecl& device : devices_)
      if (!is_native(device) && is_sensor(device) && device.link == l && writing::joint_of(device).empty())
        add(out, device_of(device, device.X_LS));
    return out;
  }

  Result<Xml> joint_of_model(const model::Joint& joint, const std::string& scope) {
    Xml out = element("joint");
    out.set_attribute("name", *within(scope, joint.name));
    out.set_attribute("type", sandlot::name_of(joint.type));
    const bool to_world = joint.parent == model::world_link;
    const auto child = within(scope, model_.links[joint.child].name);
    const auto parent = to_world ? std::string("world") : within(scope, model_.links[joint.parent].name);
    if (!child || !parent) return outside("joint", joint.name, joint.place);
    add(out, "parent", *parent);
    add(out, "child", *child);
    add_pose(out, joint.X_CJ);
    using Type = model::JointType;
    if (joint.type == Type::screw) add_number(out, "screw_thread_pitch", joint.thread_pitch_m);
    if (joint.type != Type::fixed && joint.type != Type::ball) {
      SL_ASSIGN(Xml axis, axis_of(joint, scope));
      add(out, std::move(axis));
    }
    if (joint.second) {
      Xml& axis = add(out, "axis2");
      add(axis, "xyz", direction_text(joint.second->axis_J));
      Xml& limit = add(axis, "limit");
      add_number(limit, "lower", joint.second->lower);
      add_number(limit, "upper", joint.second->upper);
      Xml& dynamics = add(axis, "dynamics");
      add_number(dynamics, "damping", joint.second->damping);
      add_number(dynamics, "friction", joint.second->friction);
    }
    if (joint.safety) add(out, safety_of(*joint.safety));
    if (joint.rollers) add(out, rollers_of(*joint.rollers));
    for (const model::DeviceDecl& device : devices_)
      if (!is_native(device) && is_sensor(device) && writing::joint_of(device) == joint.name)
        add(out, device_of(device, inverse(joint.X_CJ) * device.X_LS));
    return out;
  }

  Result<Xml> axis_of(const model::Joint& joint, const std::string& scope) const {
    Xml axis = element("axis");
    add(axis, "xyz", direction_text(joint.axis_J));
    Xml limit = element("limit");
    if (joint.lower != -unlimited) add_number(limit, "lower", joint.lower);
    if (joint.upper != unlimited) add_number(limit, "upper", joint.upper);
    if (joint.max_effort != unlimited) add_number(limit, "effort", joint.max_effort);
    if (joint.max_velocity != unlimited) add_number(limit, "velocity", joint.max_velocity);
    if (!limit.children.empty()) add(axis, std::move(limit));
    Xml dynamics = element("dynamics");
    if (joint.damping != 0) add_number(dynamics, "damping", joint.damping);
    if (joint.friction != 0) add_number(dynamics, "friction", joint.friction);
    if (joint.spring_stiffness != 0) add_number(dynamics, "spring_stiffness", joint.spring_stiffness);
    if (joint.spring_reference != 0) add_number(dynamics, "spring_reference", joint.spring_reference);
    if (!dynamics.children.empty()) add(axis, std::move(dynamics));
    if (joint.mimic) {
      const model::Joint& leader = model_.joints[joint.mimic->joint];
      const auto name = within(scope, leader.name);
      if (!name) return outside("joint", joint.name, joint.place);
      Xml& mimic = add(axis, "mimic");
      mimic.set_attribute("joint", *name);
      add_number(mimic, "multiplier", joint.mimic->multiplier);
      add_number(mimic, "offset", joint.mimic->offset);
      add_number(mimic, "reference", joint.mimic->reference);
    }
    return axis;
  }

  const model::Model& model_;
  std::span<const model::DeviceDecl> devices_;
  Diagnostics& diagnostics_;
};

Xml sdf_root() {
  Xml root = element("sdf");
  root.set_attribute("version", "1.9");
  return root;
}

void add_geography(const model::Geography& geography, Xml& world) {
  constexpr double degrees = 180 / math::pi;
  Xml& out = add(world, "spherical_coordinates");
  add(out, "surface_model", "EARTH_WGS84");
  add_number(out, "latitude_deg", geography.latitude_rad * degrees);
  add_number(out, "longitude_deg", geography.longitude_rad * degrees);
  add_number(out, "elevation", geography.elevation_m);
  add_number(out, "heading_deg", geography.heading_rad * degrees);
}

}  // namespace

std::string xml_text(const Xml& root, const std::string& comment) {
  std::string out = "<?xml version=\"1.0\"?>\n";
  if (!comment.empty()) {
    std::string safe = comment;  // two hyphens end a comment
    for (std::size_t at = safe.find("--"); at != std::string::npos; at = safe.find("--", at))
      safe.replace(at, 2, "- ");
    out += "<!-- " + safe + " -->\n";
  }
  if (root.attribute("xmlns:sandlot") || !uses_ours(root)) {
    append(root, 0, out);
  } else {
    Xml declared = root;
    declared.set_attribute("xmlns:sandlot", "urn:sandlot:sdf");
    append(declared, 0, out);
  }
  return out;
}

Result<Xml> sdf_of(const model::Instance& instance, Diagnostics& diagnostics) {
  Xml root = sdf_root();
  SL_ASSIGN(Xml model, ModelWriter(*instance.model, instance.devices, diagnostics)
                           .write(instance.original_name, instance.X_WM));
  add(root, std::move(model));
  return root;
}

Result<Xml> sdf_of(const model::Setup& setup, Diagnostics& diagnostics) {
  Xml root = sdf_root();
  Xml& world = add(root, "world");
  world.set_attribute("name", setup.name);
  add(world, "gravity", text_of(setup.gravity));
  if (setup.magnetic_field_T != model::Setup{}.magnetic_field_T)
    add(world, "magnetic_field", text_of(setup.magnetic_field_T));
  Xml& physics = add(world, "physics");
  physics.set_attribute("name", "default");
  physics.set_attribute("type", "ode");
  add_number(physics, "max_step_size", setup.step.s());
  const auto lost = [&](const std::string& what, const Place& place = {}) {
    diagnostics.warn({what + " cannot be said in SDF", "a scenario that names this world can say it", place});
  };
  if (setup.substeps != 1) lost("that a tick has " + std::to_string(setup.substeps) + " physics steps");
  if (setup.control_interval != 1) lost("the control interval");
  if (setup.engine != "rigid") lost("the engine '" + setup.engine + "'");
  if (!setup.physics.entries().empty()) lost("the engine's keys", setup.physics.place());
  if (setup.seed != 1) lost("the seed");
  if (setup.stop) lost("the stop time");
  if (!setup.values.empty()) lost("the named values");
  if (!setup.events.empty()) lost("the events");
  if (setup.log) lost("the log");
  if (!setup.zones.empty()) lost("the zones of the ground", setup.zones.front().place);
  if (!setup.media.empty()) lost("the media", setup.media.front().place);
  if (!setup.rules.empty()) lost("the rules", setup.rules.front().place);
  if (!setup.markers.empty()) lost("the markers", setup.markers.front().place);
  Xml& scene = add(world, "scene");
  add(scene, "ambient", text_of(setup.ambient));
  add(scene, "background", text_of(setup.background));
  if (setup.geography) add_geography(*setup.geography, world);
  for (const model::Light& light : setup.lights) add(world, light_of(light));
  for (const model::Instance& instance : setup.instances) {
    if (!instance.controllers.empty())
      lost("the controller of '" + instance.original_name + "'", instance.place);
    if (!instance.team.empty()) lost("the team of '" + instance.original_name + "'", instance.place);
    if (instance.motion) lost("the motion of '" + instance.original_name + "'", instance.place);
    SL_ASSIGN(Xml model, ModelWriter(*instance.model, instance.devices, diagnostics)
                             .write(instance.original_name, instance.X_WM));
    add(world, std::move(model));
  }
  return root;
}

}  // namespace sandlot::formats
