#pragma once
/// Rules between the keys of devices that scan a fan of angles: ranges and angles in order, at most one turn.
#include "base/math.h"
#include "base/text.h"
#include "devices/device_build.h"

namespace sandlot {

/// @param spec  with min_range_m, max_range_m, min_angle_rad, max_angle_rad
template <class Spec>
Status check_scan_limits(const DeviceBuild& build, const Spec& spec) {
  if (spec.max_range_m <= spec.min_range_m)
    return build.error("max_range", "max_range must be greater than min_range",
                       "min_range is " + number_text(spec.min_range_m) + " m");
  if (spec.max_angle_rad < spec.min_angle_rad)
    return build.error("max_angle", "max_angle must not be less than min_angle",
                       "angles grow counter-clockwise");
  if (spec.max_angle_rad - spec.min_angle_rad > math::tau + 1e-6)
    return build.error("max_angle", "the beams cover more than a full turn",
                       "max_angle - min_angle is at most 360 deg");
  return {};
}

}  // namespace sandlot
