#pragma once
/// The light that leaves a surface towards the camera.
///
///   L = emissive + k ambient + sum over lights seen from there: (k max(0, n.l) + s max(0, n.h)^shininess)
///   light / attenuation
///
/// k = diffuse times texture, s = specular, h half way between light and camera.
/// Source   J. Blinn, Models of light reflection for computer synthesized pictures (1977). Spots as OGRE has
///          them: between the inner and the outer cone ((cos - cos_outer) / (cos_inner - cos_outer))^falloff.
#include "optics/picture_tree.h"
#include "optics/shadow_grid.h"

namespace sandlot::optics {

/// A light as one camera has it: relative to the base of its rays.
struct LightNow {
  model::Light::Type type;
  float position[3], shines[3];  ///< `shines`: the way the light goes
  float diffuse[3], specular[3];
  float constant, linear, quadratic, range;
  float cos_inner, cos_outer, falloff;
  bool shadows;
  ShadowGrid::View grid;  ///< of suns
};
LightNow light_now(const PictureLight& light, std::span<const Pose> X_WG, const double base[3]);

struct Scenery {
  const PictureTree* tree;
  std::vector<LightNow> lights;
  Surroundings surroundings;
  bool shadows = true, srgb = false;
  bool lit = true;  ///< false: surfaces show their own colour
  std::uint32_t shadowless_body = no_body;
};

/// Colour of every valid lane; where nothing was hit, the background.
/// @param cone  width of the pixel as seen from the camera [rad]
lanes::F3 shade(const Scenery& scenery, const Rays& rays, const Hits& hits, lanes::F cone);

/// Light that a white matt surface would reflect at each place, from all lights and `ambient`.
/// @param at, normal  relative to `base`, in W
lanes::F3 light_at(const Scenery& scenery, const double* base, const lanes::F3& at, const lanes::F3& normal,
                   lanes::I valid);

/// sRGB's curve and its inverse, 0..1.
lanes::F srgb_encoded(lanes::F linear);
lanes::F srgb_decoded(lanes::F encoded);

}  // namespace sandlot::optics
