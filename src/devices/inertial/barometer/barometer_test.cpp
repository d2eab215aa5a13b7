#include "devices/inertial/barometer/barometer.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"

namespace sandlot::barometer {
namespace {

using test::config;
using test::Rig;

TEST(Barometer, TheStandardAtmosphere) {
  // ISO 2533, tables: 1000 m 89874.6 Pa, 11000 m 22632 Pa.
  EXPECT_DOUBLE_EQ(pressure_Pa(0), 101325);
  EXPECT_NEAR(pressure_Pa(1000), 89874.6, 1);
  EXPECT_NEAR(pressure_Pa(11000), 22632, 3);
}

TEST(Barometer, CountsFromTheWorldsElevation) {
  Rig rig(kind, test::two_wheels());
  rig.geography = model::Geography{0, 0, 1000, 0};
  ASSERT_TRUE(rig.add("a", config({})));
  ASSERT_TRUE(rig.add("b", config({{"reference_altitude", "0"}})));
  rig.engine->body[0].X_WB.p.z = -1000;
  rig.sense();
  EXPECT_NEAR(rig.topic<msg::FluidPressure>("a/pressure").message.fluid_pressure, 101325, 1e-6);
  EXPECT_GT(rig.topic<msg::FluidPressure>("b/pressure").message.fluid_pressure, 113000);
}

}  // namespace
}  // namespace sandlot::barometer
