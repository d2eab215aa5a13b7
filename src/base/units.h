#pragma once
/// Quantities as people write them in files: `5 cm`, `90 deg`, `1.5 km/h`, or a bare number in the field's
/// own unit. Everything inside Sandlot is SI.
#include <string_view>

#include "base/result.h"

namespace sandlot {

/// @param text  a number, optionally followed by a unit
/// @param unit  the field's unit ("m", "rad", "s", "1", ...): what a bare number means
/// @return the value in `unit`. An error lists the units that would fit; the caller adds place and path.
Result<double> parse_quantity(std::string_view text, std::string_view unit);

}  // namespace sandlot
