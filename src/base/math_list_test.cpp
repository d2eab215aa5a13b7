#include "base/math_list.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <vector>

#include "base/random.h"

namespace sandlot::math {
namespace {

// Sizes of all kinds next to each other: a vector takes another way when one of its angles is large.
TEST(MathList, SineAndCosineHaveTheBitsOfTheScalarFunction) {
  Stream random(1, 2, Purpose::experiment, 6);
  for (std::size_t count = 0; count < 10; ++count)
    for (int round = 0; round < 20'000; ++round) {
      std::vector<double> rad(count);
      for (double& each : rad) each = random.uniform(-1, 1) * exp(random.uniform(-40, 40));
      std::vector<SinCos> got(count);
      sincos(rad, got);
      for (std::size_t i = 0; i < count; ++i) {
        const SinCos one = sincos(rad[i]);
        ASSERT_EQ(std::bit_cast<std::uint64_t>(got[i].sin), std::bit_cast<std::uint64_t>(one.sin)) << rad[i];
        ASSERT_EQ(std::bit_cast<std::uint64_t>(got[i].cos), std::bit_cast<std::uint64_t>(one.cos)) << rad[i];
      }
    }
}

}  // namespace
}  // namespace sandlot::math
