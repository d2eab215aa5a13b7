#pragma once
/// Values of a simulation by their addresses, for tests.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "sim/watch/values.h"

namespace sandlot::test {

/// NaN, and a failure of the test, where there is none.
inline double value(const Simulation& simulation, const std::string& address) {
  auto found = NamedValue::find(simulation, address);
  EXPECT_TRUE(found) << (found ? "" : found.error().text());
  return found ? found->read().value_or(NAN) : NAN;
}

}  // namespace sandlot::test
