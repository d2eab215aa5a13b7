#pragma once
/// Very many normal deviates, cheaply: each is looked up for 16 random bits.
///
/// Each of the 2^16 equally probable values is the middle (by probability) of its part of the normal
/// distribution, all of them scaled so that the variance is exactly 1. The outermost are +-4.3.
/// Cost     2 to 3 ns each. The table has 128 KB.
#include <cstdint>
#include <span>

#include "base/random.h"

namespace sandlot {

/// Fills `out` from the block of random words number `block` on; eight deviates take one block.
void fill_normals(const Stream& random, std::uint32_t block, std::span<float> out);
/// Fills `out` with numbers in [0, 1) of 24 bits; four take one block.
void fill_uniforms(const Stream& random, std::uint32_t block, std::span<float> out);

}  // namespace sandlot
