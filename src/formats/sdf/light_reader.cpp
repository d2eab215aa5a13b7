#include "base/math.h"
#include "formats/sdf/reading.h"

namespace sandlot::formats {
namespace {

Status read_attenuation(const Xml& element, model::Light& out, const Reading& in) {
  in.notes.unused(element, "range constant linear quadratic");
  SL_TRY(read_capped(element, "range", {0, 1e6}, out.range_m));
  SL_TRY(read_capped(element, "constant", {0, 1e6}, out.constant));
  SL_TRY(read_capped(element, "linear", {0, 1e6}, out.linear));
  SL_TRY(read_capped(element, "quadratic", {0, 1e6}, out.quadratic));
  return {};
}

Status read_cone(const Xml& light, model::Light& out, const Reading& in) {
  const Xml* const spot = light.child("spot");
  if (!spot) {
    in.notes.warn(light, "spot light '" + out.name + "' has no <spot>", "its cone is taken as 0.5 to 1 rad");
    out.inner_rad = 0.5;
    out.outer_rad = 1;
    return {};
  }
  in.notes.unused(*spot, "inner_angle outer_angle falloff");
  SL_TRY(read_child(*spot, "inner_angle", {0, 2 * math::pi}, out.inner_rad));
  SL_TRY(read_child(*spot, "outer_angle", {0, 2 * math::pi}, out.outer_rad));
  SL_TRY(read_capped(*spot, "falloff", {0, 1e6}, out.falloff));
  if (out.inner_rad > out.outer_rad)
    return spot->error("the inner angle of this spot light is larger than the outer one", "swap them");
  return {};
}

}  // namespace

Result<model::Light> read_light(const Xml& element, const Reading& in) {
  model::Light light;
  const std::string* const type = element.attribute("type");
  light.name = *element.attribute("name");
  in.notes.unused(element, "pose diffuse specular direction cast_shadows intensity attenuation spot light_on",
                  "visualize visual");
  if (!type || (*type != "directional" && *type != "point" && *type != "spot"))
    return element.error("light '" + light.name + "' has no type that is known",
                         "write directional, point or spot");
  light.type = *type == "directional" ? model::Light::Type::directional
               : *type == "point"     ? model::Light::Type::point
                                      : model::Light::Type::spot;
  SL_ASSIGN(light.X_PLight, in.pose(element));
  light.color = {1, 1, 1, 1};
  if (const Xml* const diffuse = element.child("diffuse")) { SL_ASSIGN(light.color, read_color(*diffuse)); }
  if (const Xml* const specular = element.child("specular")) {
    SL_ASSIGN(light.specular, read_color(*specular));
  }
  double intensity = 1;
  bool on = true;
  SL_TRY(read_child(element, "intensity", {0, 1e6}, intensity));
  SL_TRY(read_child(element, "light_on", on));
  const auto strength = static_cast<float>(on ? intensity : 0);
  for (Color* const color : {&light.color, &light.specular}) {
    color->r *= strength;
    color->g *= strength;
    color->b *= strength;
  }
  SL_TRY(read_child(element, "cast_shadows", light.cast_shadows));
  light.linear = 1;  // SDF's defaults are 1 1 0
  if (const Xml* const attenuation = element.child("attenuation"))
    SL_TRY(read_attenuation(*attenuation, light, in));
  if (light.type == model::Light::Type::spot) SL_TRY(read_cone(element, light, in));
  Vec3 direction{0, 0, -1};
  SL_TRY(read_child(element, "direction", position_range, direction));
  if (!(norm(direction) > 1e-6))
    return element.child("direction")->error("the direction of this light is zero", "write 0 0 -1");
  if (light.type != model::Light::Type::point)
    light.X_PLight.q = light.X_PLight.q * quat_between({0, 0, -1}, normalised(direction));
  return light;
}

}  // namespace sandlot::formats
