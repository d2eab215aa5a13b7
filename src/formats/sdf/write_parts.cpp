#include "formats/sdf/write_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "model/substance.h"

namespace sandlot::formats::writing {
namespace {

bool is_plain_name(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto later = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '-'; };
  return !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), later);
}

/// A scalar in a YAML flow list.
std::string flow_scalar(const std::string& text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '.' || c == '+' || c == '-' || c == '/';
  };
  if (!text.empty() && std::all_of(text.begin(), text.end(), plain)) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string flow(const Node& node) {
  if (node.is_null()) return "null";
  if (node.is_scalar()) return flow_scalar(node.text());
  std::string out;
  for (const Node& item : node.items()) out += (out.empty() ? "" : ", ") + flow(item);
  for (const Node::Entry& entry : node.entries())
    out += (out.empty() ? "" : ", ") + flow_scalar(entry.key) + ": " + flow(entry.value);
  return node.is_map() ? "{" + out + "}" : "[" + out + "]";
}

/// A key of ours: maps nest where their keys can be names of elements, lists are written as YAML has them.
Xml native_key(const std::string& name, const Node& value) {
  const bool nests = value.is_map() && !value.entries().empty() &&
                     std::all_of(value.entries().begin(), value.entries().end(),
                                 [](const Node::Entry& entry) { return is_plain_name(entry.key); });
  if (value.is_scalar()) return element(name, value.text());
  if (!nests) return element(name, flow(value));
  Xml out = element(name);
  for (const Node::Entry& entry : value.entries()) add(out, native_key(entry.key, entry.value));
  return out;
}

/// The reverse of node_of().
Xml element_of(const std::string& name, const Node& node) {
  Xml out = element(name, node.text());
  for (const Node::Entry& entry : node.entries()) {
    if (entry.key == "#text") out.text = entry.value.text();
    else if (starts_with(entry.key, "@")) out.set_attribute(entry.key.substr(1), entry.value.text());
    else if (!entry.value.is_sequence()) add(out, element_of(entry.key, entry.value));
    else
      for (const Node& item : entry.value.items()) add(out, element_of(entry.key, item));
  }
  return out;
}

template <class Vector, class Normalise>
Vector before_normalising(const Vector& unit, Normalise scaled_and_normalised) {
  // Dividing by the norm again may move the last bit; of a few multiples, one nearly always comes back exactly.
  for (int k = 0; k < 4096; ++k)
    if (const auto [raw, back] = scaled_and_normalised(1.0 + k / 4096.0); back == unit) return raw;
  return unit;
}

}  // namespace

Xml element(std::string name, std::string text) {
  Xml out;
  out.name = std::move(name);
  out.text = std::move(text);
  return out;
}

Xml& add(Xml& parent, Xml child) { return parent.children.emplace_back(std::move(child)); }
Xml& add(Xml& parent, std::string name, std::string text) {
  return add(parent, element(std::move(name), std::move(text)));
}
void add_number(Xml& parent, std::string name, double x) { add(parent, std::move(name), number_text(x)); }

std::string text_of(Vec3 v) { return number_text(v.x) + " " + number_text(v.y) + " " + number_text(v.z); }

std::string text_of(const Color& color) {
  std::string out;
  // The shortest text that is this float again: as a double it would show its binary dust.
  for (const float part : {color.r, color.g, color.b, color.a})
    out += fmt::format("{}{}", out.empty() ? "" : " ", part);
  return out;
}

std::string direction_text(Vec3 unit) {
  return text_of(before_normalising(unit, [&](double scale) {
    const Vec3 raw = scale * unit;
    return std::pair(raw, normalised(raw));
  }));
}

void add_pose(Xml& parent, const Pose& X) {
  const auto is_plus_zero = [](double x) { return x == 0 && !std::signbit(x); };
  const bool upright = X.q.w == 1 && is_plus_zero(X.q.x) && is_plus_zero(X.q.y) && is_plus_zero(X.q.z);
  const bool centred = is_plus_zero(X.p.x) && is_plus_zero(X.p.y) && is_plus_zero(X.p.z);
  if (upright && centred) return;
  if (upright) return void(add(parent, "pose", text_of(X.p) + " 0 0 0"));
  const Quat q = before_normalising(X.q, [&](double scale) {
    const Quat raw{scale * X.q.w, scale * X.q.x, scale * X.q.y, scale * X.q.z};
    return std::pair(raw, normalised(raw));
  });
  Xml& pose = add(parent, "pose",
                  text_of(X.p) + "  " + text_of(Vec3{q.x, q.y, q.z}) + " " + number_text(q.w));
  pose.set_attribute("rotation_format", "quat_xyzw");
}

std::optional<Xml> surface_of(const model::Surface& s) {
  const model::Surface usual;
  Xml ode = element("ode");
  if (s.mu != usual.mu || s.mu2 != usual.mu2) {
    add_number(ode, "mu", s.mu);
    add_number(ode, "mu2", s.mu2);
  }
  if (s.fdir1 != usual.fdir1) add(ode, "fdir1", direction_text(s.fdir1));
  if (s.slip1 != usual.slip1) add_number(ode, "slip1", s.slip1);
  if (s.slip2 != usual.slip2) add_number(ode, "slip2", s.slip2);
  Xml out = element("surface");
  if (!ode.children.empty()) add(add(out, "friction"), std::move(ode));
  if (s.restitution != usual.restitution || s.restitution_threshold_mps != usual.restitution_threshold_mps) {
    Xml& bounce = add(out, "bounce");
    add_number(bounce, "restitution_coefficient", s.restitution);
    add_number(bounce, "threshold", s.restitution_threshold_mps);
  }
  Xml soft = element("ode");
  const auto add_given = [&](const char* key, const std::optional<double>& x) {
    if (x) add_number(soft, key, *x);
  };
  add_given("soft_cfm", s.soft_cfm);
  add_given("soft_erp", s.soft_erp);
  add_given("kp", s.stiffness_N_per_m);
  add_given("kd", s.damping_N_s_per_m);
  add_given("max_vel", s.max_correction_mps);
  if (!soft.children.empty()) add(add(out, "contact"), std::move(soft));
  if (s.substance) add(out, "sandlot:substance", model::text_of(*s.substance));
  if (s.skin) {
    Xml& skin = add(out, "sandlot:skin");
    add(skin, "axis", direction_text(s.skin->axis));
    add_number(skin, "ratio", s.skin->ratio);
  }
  if (s.rolling_resistance_m != 0) add_number(out, "sandlot:rolling_resistance", s.rolling_resistance_m);
  if (s.belt_velocity_mps != Vec3{}) add(out, "sandlot:belt_velocity", text_of(s.belt_velocity_mps));
  if (!s.touches) add(out, "sandlot:no_contact", "true");
  if (out.children.empty()) return std::nullopt;
  return out;
}

Xml safety_of(const model::SafetyLimits& limits) {
  Xml out = element("sandlot:safety");
  if (limits.soft_lower != -unlimited) add_number(out, "soft_lower", limits.soft_lower);
  if (limits.soft_upper != unlimited) add_number(out, "soft_upper", limits.soft_upper);
  add_number(out, "k_position", limits.k_position);
  add_number(out, "k_velocity", limits.k_velocity);
  return out;
}

Xml rollers_of(const model::RollerWheel& w) {
  Xml out = element("sandlot:rollers");
  add_number(out, "radius", w.radius_m);
  add_number(out, "count", w.count);
  if (w.rows > 1) {
    add_number(out, "rows", w.rows);
    add_number(out, "row_spacing", w.row_spacing_m);
  }
  add_number(out, "angle", w.angle_rad);
  add_number(out, "roller_radius", w.roller_radius_m);
  add_number(out, "roller_length", w.roller_length_m);
  add_number(out, "roller_mass", w.roller_mass_kg);
  if (w.bearing_friction_Nm != 0) add_number(out, "bearing_friction", w.bearing_friction_Nm);
  if (auto surface = surface_of(w.surface)) add(out, std::move(*surface));
  return out;
}

Xml geometry_of(const Shape& shape, const std::string& owner, const Place& place, Diagnostics& diagnostics) {
  Xml out = element("geometry");
  Xml& form = add(out, shape_name(shape));
  const auto round = [&](double radius, double length) {
    add_number(form, "radius", radius);
    add_number(form, "length", length);
  };
  if (const auto* const box = std::get_if<Box>(&shape)) add(form, "size", text_of(box->size_m));
  else if (const auto* const ball = std::get_if<Sphere>(&shape)) add_number(form, "radius", ball->radius_m);
  else if (const auto* const can = std::get_if<Cylinder>(&shape)) round(can->radius_m, can->length_m);
  else if (const auto* const pill = std::get_if<Capsule>(&shape)) round(pill->radius_m, pill->length_m);
  else if (const auto* const cone = std::get_if<Cone>(&shape)) round(cone->radius_m, cone->length_m);
  else if (const auto* const barrel = std::get_if<Barrel>(&shape)) {
    add_number(form, "radius", barrel->radius_m);
    add_number(form, "profile", barrel->profile_m);
    add_number(form, "length", barrel->length_m);
  } else if (const auto* const egg = std::get_if<Ellipsoid>(&shape))
    add(form, "radii", text_of(egg->radii_m));
  else if (const auto* const plane = std::get_if<Plane>(&shape))
    add(form, "normal", direction_text(plane->normal));
  else if (const auto* const mesh = std::get_if<Mesh>(&shape)) {
    const TriangleMesh& m = *mesh->mesh;
    if (m.source.empty()) {
      form.name = "empty";
      diagnostics.warn({owner + ": its triangles came from no mesh file", "it is left out", place});
      return out;
    }
    add(form, "uri", m.source);
    if (m.source_scale != Vec3{1, 1, 1}) add(form, "scale", text_of(m.source_scale));
    if (!m.source_part.empty()) {
      Xml& part = add(form, "submesh");
      add(part, "name", m.source_part);
      if (m.source_centred) add(part, "center", "true");
    }
    if (m.is_hull) {
      form.set_attribute("optimization", "convex_hull");
      diagnostics.warn({owner + ": is written as the hull of its whole mesh",
                        "look at it if it was one part of a decomposition", place});
    }
  } else if (const auto* const ground = std::get_if<Heightfield>(&shape)) {
    add(form, "uri", ground->grid->source);
    const HeightGrid& g = *ground->grid;
    add(form, "size", text_of(Vec3{g.size_x_m, g.size_y_m, g.source_height_m}));
  }
  return out;
}

std::optional<Xml> material_of(const model::Material& m) {
  const model::Material usual;
  if (m.from_mesh && m.diffuse == usual.diffuse && m.texture.empty()) return std::nullopt;
  Xml out = element("material");
  add(out, "ambient", text_of(m.diffuse));
  add(out, "diffuse", text_of(m.diffuse));
  if (m.specular != usual.specular) add(out, "specular", text_of(m.specular));
  if (m.emissive != usual.emissive) add(out, "emissive", text_of(m.emissive));
  if (m.shininess != usual.shininess) add_number(out, "shininess", static_cast<double>(m.shininess));
  if (!m.texture.empty()) add(add(add(out, "pbr"), "metal"), "albedo_map", m.texture);
  return out;
}

Xml light_of(const model::Light& light) {
  using Type = model::Light::Type;
  Xml out = element("light");
  out.set_attribute("name", light.name);
  out.set_attribute("type", light.type == Type::directional ? "directional"
                            : light.type == Type::point     ? "point"
                                                            : "spot");
  add_pose(out, light.X_PLight);
  add(out, "diffuse", text_of(light.color));
  add(out, "specular", text_of(light.specular));
  add(out, "cast_shadows", light.cast_shadows ? "true" : "false");
  add(out, "direction", "0 0 -1");
  if (light.type == Type::directional) return out;
  Xml& attenuation = add(out, "attenuation");
  add_number(attenuation, "range", light.range_m);
  add_number(attenuation, "constant", light.constant);
  add_number(attenuation, "linear", light.linear);
  add_number(attenuation, "quadratic", light.quadratic);
  if (light.type == Type::spot) {
    Xml& spot = add(out, "spot");
    add_number(spot, "inner_angle", light.inner_rad);
    add_number(spot, "outer_angle", light.outer_rad);
    add_number(spot, "falloff", light.falloff);
  }
  return out;
}

Xml inertial_of(const model::Inertial& inertial) {
  Xml out = element("inertial");
  add_pose(out, inertial.X_LCo);
  add_number(out, "mass", inertial.mass_kg);
  Xml& tensor = add(out, "inertia");
  const Vec3 d = inertial.moments, p = inertial.products;
  for (const auto& [key, value] : {std::pair("ixx", d.x), std::pair("ixy", p.x), std::pair("ixz", p.y),
                                   std::pair("iyy", d.y), std::pair("iyz", p.z), std::pair("izz", d.z)})
    add_number(tensor, key, value);
  return out;
}

bool is_sensor(const model::DeviceDecl& device) {
  return !device.sdf_types.empty() && starts_with(device.sdf_types.front(), "sensor:");
}

std::string joint_of(const model::DeviceDecl& device) {
  const Node* const joint = device.config.find("@joint");
  return joint ? joint->text() : "";
}

Xml device_of(const model::DeviceDecl& device, const Pose& X_pose) {
  if (is_native(device)) {
    Xml out = element("sandlot:device");
    out.set_attribute("name", device.name);
    out.set_attribute("kind", device.kind);
    add_pose(out, X_pose);
    for (const Node::Entry& entry : device.config.entries()) add(out, native_key(entry.key, entry.value));
    return out;
  }
  Xml out = element_of(is_sensor(device) ? "sensor" : "plugin", device.config);
  std::erase_if(out.attributes, [](const auto& attribute) { return attribute.first == "joint"; });
  if (is_sensor(device)) add_pose(out, X_pose);
  return out;
}

}  // namespace sandlot::formats::writing
