#pragma once
/// Functions of base/math.h over lists, with the same bits: several values at a time where the processor has vectors.
#include <span>

#include "base/math.h"

namespace sandlot::math {

/// @pre as many results as angles
void sincos(std::span<const double> rad, std::span<SinCos> out);

}  // namespace sandlot::math
