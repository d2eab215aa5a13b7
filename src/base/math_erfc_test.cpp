#include "base/math_erfc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sandlot::math {
namespace {

TEST(Math, ErfcIsWithinTwoUlpsOfTheTruth) {
  for (double x = -5; x < 26; x += 0.00731) {
    const long double truth = std::erfc(static_cast<long double>(x));  // lint-ok: the reference
    const auto near = static_cast<double>(truth);
    const double spacing = std::nextafter(near, std::numeric_limits<double>::infinity()) - near;
    EXPECT_NEAR(erfc(x), near, 2 * spacing) << x;
  }
}

}  // namespace
}  // namespace sandlot::math
