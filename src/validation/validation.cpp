#include "validation/validation.h"

#include <cmath>

namespace sandlot::validation {

double Row::deviation() const {
  const double difference = std::abs(measured - expected);
  return relative ? difference / std::abs(expected) : difference;
}

const std::vector<Validation>& validations() {
  static const std::vector<Validation> all = {
      {"impacts", "Collisions of two bodies, a bouncing ball, Newton's cradle.", impacts},
      {"surfaces", "Substances, belts, skins, resistance to rolling, zones.", surfaces},
      {"drives", "Every drive at every level on every engine, driven along straight, side, arc and spin.",
       drives},
      {"switching", "A drive whose level is switched while it moves.", switching},
      {"odometry", "Wheel odometry by least squares and by Kabsch, with and without slip.", odometry},
      {"radio", "Received power, air time, bit errors, ALOHA and CSMA.", radio},
      {"friction", "Inclines, sliding, rolling, pushing, piles at rest.", friction},
  };
  return all;
}

}  // namespace sandlot::validation
