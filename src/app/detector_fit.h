#pragma once
/// Fit of a detector's errors to the parameters of a camera's level `objects` (devices/cameras/detector.h).
///
/// Model    P(missed) = miss_rate + miss_rate_per_m range + miss_rate_hidden (1 - visible); bearing +
///          bearing_std n; range + (range_std + range_std_per_m range) n; ghosts come at a constant rate; of
///          what is found the part `confusion` is taken for something else.
/// Method   misses: least squares, weighted by 1 / (P (1 - P)) in repeated passes, of which no parameter may
///          become negative; deviation of ranges: the same on |error| sqrt(pi / 2), whose mean is the
///          deviation. Systematic errors are part of the deviations, and given in addition. Deviations are
///          those of what has its own label.
/// Errors   of N sightings: bearing_std by the factor 1 +- 0.71 / sqrt(N), a deviation of ranges by 1 +- 0.76
///          / sqrt(N), a miss rate P by +- sqrt(P (1 - P) / N), where the ranges are alike; the confusion by
///          the same.
#include <span>
#include <vector>

namespace sandlot::app {

/// Object that was to be seen in a picture.
struct Sighted {
  double range_m = 0, visible = 1;
  bool found = false, confused = false;             ///< confused: found, with another label
  double bearing_error_rad = 0, range_error_m = 0;  ///< of those found
};

struct DetectorFit {
  double miss_rate = 0, miss_rate_per_m = 0, miss_rate_hidden = 0, ghost_rate_hz = 0, confusion = 0;
  double bearing_std_rad = 0, range_std_m = 0, range_std_per_m = 0;
  double bearing_mean_rad = 0, range_mean_m = 0;  ///< systematic errors
  double nearest_m = 0, farthest_m = 0;           ///< of what was sighted
};

/// @param seconds  that the ghosts were counted
DetectorFit fit_detector(std::span<const Sighted> sighted, int ghosts, double seconds);

}  // namespace sandlot::app
