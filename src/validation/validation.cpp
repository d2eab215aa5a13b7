#include "validation/validation.h"

#include <cmath>

namespace sandlot::validation {

double Row::deviation() const {
  const double difference = std::abs(measured - expected);
  return relative ? difference / std::abs(expected) : difference;
}

const std::vector<Experiment>& experiments() {
  static const std::vector<Experiment> all = {
      {"impacts", "Collisions of two bodies, a bouncing ball, Newton's cradle.", impacts},
      {"drives", "Every drive at every level on every engine, driven along straight, side, arc and spin.",
       drives},
      {"friction", "Inclines, sliding, rolling, pushing, piles at rest.", friction},
  };
  return all;
}

}  // namespace sandlot::validation
