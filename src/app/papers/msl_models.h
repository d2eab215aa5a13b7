#pragma once
/// Figures 1 to 3 of the paper on middle-size robots: models, pictures of cameras with what vision finds in them, the ramp of a speed.
#include <span>

#include "app/papers/papers.h"

namespace sandlot::app {

/// How a controlled speed follows a target that rises linearly, stays, and falls.
struct RampResponse {
  double behind = 0;     ///< mean of target - speed over the second half of the rise
  double overshoot = 0;  ///< how far the speed comes above the top, 0: never
  double short_of = 0;   ///< target - speed at the end of the top
};
/// @pre equally long, not empty; the target rises from its first value to its greatest once
RampResponse ramp_response(std::span<const double> target, std::span<const double> speed);

/// Runs of some seconds each.
Status add_models(const ReproduceContext& context, ReportPage& page);

}  // namespace sandlot::app
