#include "validation/validation.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "validation/quasistatic.h"

namespace sandlot::validation {
namespace {

TEST(SlowValidation, EverythingLiesWithinItsBounds) {
  for (const Validation& validation : validations()) {
    const Section section = validation.run();
    EXPECT_FALSE(section.rows.empty()) << validation.name;
    for (const Row& row : section.rows)
      EXPECT_TRUE(row.ok()) << row.what << ", " << row.engine << ": " << row.measured << ' ' << row.unit
                            << " instead of " << row.expected;
  }
}

/// Four wheels skid round their middle at the rate where moments balance: kinematics/skid.h has it in closed
/// form. Along an arc the solution is where no other dissipates less.
TEST(Validation, FrictionTurnsFourWheelsAsTheBalanceOfMomentsSays) {
  const double length = 0.34, track = 0.44, rim = 0.3;
  const auto wheels = [&](double left, double right) {
    std::vector<Patch> patches;
    for (const double x : {0.5 * length, -0.5 * length})
      for (const double y : {0.5 * track, -0.5 * track}) add_wheel(patches, x, y, 0, y > 0 ? left : right);
    return patches;
  };
  const Twist spin = least_dissipation(wheels(-rim, rim));
  const double ratio = 1 + length * length / (track * track);
  EXPECT_NEAR(spin.wz_radps, 2 * rim / (ratio * track), 1e-9);
  EXPECT_NEAR(spin.vx_mps, 0, 1e-9);
  const auto arc = wheels(0.1, 0.5);
  const auto power = [&](double vx, double vy, double w) {
    double sum = 0;
    for (const Patch& p : arc)
      sum += math::hypot(vx - w * p.y_m - p.sx_mps, vy + w * p.x_m - p.sy_mps) + 0.05 * vy;
    return sum;
  };
  const Twist v = least_dissipation(arc, {0, -0.05});
  const double least = power(v.vx_mps, v.vy_mps, v.wz_radps);
  for (const double d : {1e-3, -1e-3}) {
    EXPECT_GT(power(v.vx_mps + d, v.vy_mps, v.wz_radps), least);
    EXPECT_GT(power(v.vx_mps, v.vy_mps + d, v.wz_radps), least);
    EXPECT_GT(power(v.vx_mps, v.vy_mps, v.wz_radps + d), least);
  }
}

/// With a roller right below, a Mecanum wheel is what the closed form thinks; at a third of the pitch its
/// axis has turned.
TEST(Validation, AMecanumWheelStandsOnTheRollerThatIsLowest) {
  std::vector<Patch> patches;
  const double pitch = math::tau / 8;  // a roller ahead at zero, so one below
  for (const double turned : {0.0, 3 * pitch, pitch / 3})
    add_mecanum_wheel(patches, 0, 0, 0.1, 0.01, 8, math::pi / 4, turned, 2);
  for (std::size_t k : {0u, 1u}) {
    EXPECT_NEAR(patches[k].y_m, 0, 1e-12);
    EXPECT_NEAR(patches[k].ex, std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(patches[k].ey, std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(patches[k].sx_mps, 0.2, 1e-12);
  }
  // 15 degrees past: cos 15 deg = 0.965926, tan = 0.267949.
  EXPECT_NEAR(patches[2].y_m, 0.09 * 0.267949, 1e-7);
  EXPECT_NEAR(patches[2].ex / patches[2].ey, 0.965926, 1e-6);
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
