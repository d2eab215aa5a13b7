#include "validation/validation.h"

#include <gtest/gtest.h>

namespace sandlot::validation {
namespace {

TEST(SlowValidation, everything_lies_within_its_bounds) {
  for (const Experiment& experiment : experiments()) {
    const Section section = experiment.run();
    EXPECT_FALSE(section.rows.empty()) << experiment.name;
    for (const Row& row : section.rows)
      EXPECT_TRUE(row.ok()) << row.what << ", " << row.engine << ": " << row.measured << ' ' << row.unit
                            << " instead of " << row.expected;
  }
}

TEST(Validation, AResultThatIsNoNumberIsOff) {
  Row row{.measured = std::numeric_limits<double>::quiet_NaN(), .expected = 1, .bound = 1};
  EXPECT_FALSE(row.ok());
  row = {.measured = 1.2, .expected = 1, .bound = 0.1};
  EXPECT_FALSE(row.ok());
  row.relative = false, row.bound = 0.21;
  EXPECT_TRUE(row.ok());
}

}  // namespace
}  // namespace sandlot::validation
