#pragma once
/// The colour of a texture under the footprint of a pixel.
///
/// The footprint is an ellipse: along its long axis up to `most_taps` samples stand in a row, across it the
/// level of the pyramid is chosen whose texels are as wide as it; between levels the colour is blended. So a
/// white line at 30 m seen from 70 cm above the ground still is a line, and greyer, not dotted.
/// Source   P. Heckbert, Survey of texture mapping (1986); T. Akenine-Moeller et al., Texture level of detail
///          strategies for real-time ray tracing, Ray Tracing Gems (2019), ch. 20 (ray cones).
#include "optics/lanes_math.h"
#include "optics/texture.h"

namespace sandlot::optics {

/// Where, and the two axes of the footprint, all in texture coordinates.
struct Footprint8 {
  lanes::F u, v;
  lanes::F du[2], dv[2];
};

inline constexpr int most_taps = 8;

/// Red, green, blue in 0..1; zero in the lanes that are not valid.
lanes::F3 sample(const Texture& texture, const Footprint8& footprint, lanes::I valid);

}  // namespace sandlot::optics
