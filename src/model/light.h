#pragma once
/// Lights of the world and of links.
#include <cstdint>
#include <span>
#include <string>

#include "base/fields.h"
#include "geometry/color.h"
#include "geometry/pose.h"

namespace sandlot::model {

/// Directional and spot lights shine along -z of their frame.
struct Light {
  enum class Type : std::uint8_t { directional, point, spot } type = Type::directional;
  std::string name;
  Pose X_PLight;  ///< P: the world, or the link that carries it
  Color color;
  Color specular{0, 0, 0, 1};
  bool cast_shadows = false;
  double range_m = 10;
  double constant = 1, linear = 0,
         quadratic = 0;  ///< attenuation = 1 / (constant + linear d + quadratic d^2)
  double inner_rad = 0, outer_rad = 0, falloff = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"type", "", "Kind of light."}, s.type);
    visit(Field{"name", "", "Name of the light."}, s.name);
    visit(Field{"pose", "", "Pose in the world, or in the link that carries it."}, s.X_PLight);
    visit(Field{"color", "1", "Diffuse colour times the intensity."}, s.color);
    visit(Field{"specular", "1", "Colour of highlights."}, s.specular);
    visit(Field{"cast_shadows", "", "Whether objects cast shadows in this light."}, s.cast_shadows);
    visit(Field{"range", "m", "Reach of point and spot lights; dark beyond."}, s.range_m);
    visit(Field{"constant", "1", "Constant term of the attenuation."}, s.constant);
    visit(Field{"linear", "1/m", "Linear term of the attenuation."}, s.linear);
    visit(Field{"quadratic", "1/m^2", "Quadratic term of the attenuation."}, s.quadratic);
    visit(Field{"inner", "rad", "Angle of the cone of a spot light with full brightness."}, s.inner_rad);
    visit(Field{"outer", "rad", "Angle of the cone of a spot light with any brightness."}, s.outer_rad);
    visit(Field{"falloff", "1", "Exponent of the decrease from the inner to the outer cone."}, s.falloff);
  }
};

inline std::span<const EnumName<Light::Type>> enum_names(Light::Type) {
  using Type = Light::Type;
  static constexpr EnumName<Type> names[] = {
      {"directional", Type::directional}, {"point", Type::point}, {"spot", Type::spot}};
  return names;
}

/// A light on a link.
struct LinkLight {
  std::uint32_t link = 0;
  Light light;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"link", "", "Index of the link."}, s.link);
    visit(Field{"light", "", "Light, posed in the link."}, s.light);
  }
};

}  // namespace sandlot::model
