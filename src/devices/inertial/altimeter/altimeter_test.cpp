#include "devices/inertial/altimeter/altimeter.h"

#include <gtest/gtest.h>

#include "devices/test_rig.h"

namespace sandlot::altimeter {
namespace {

using test::config;
using test::Rig;

TEST(Altimeter, ShowsTheHeightOfItsPointAboveTheStart) {
  Rig rig(kind, test::two_wheels());
  rig.instance.X_WM = {{0, 0, 10}, {}};
  ASSERT_TRUE(rig.add("alt", config({}), 1, 0, {{1, 0, 0.5}, {}}));
  rig.engine->body[0].X_WB = {{0, 0, 12}, quat_from_rpy(0, -math::pi / 2, 0)};  // x of the link now points up
  rig.engine->body[0].V_WB = {{0, 0, 3}, {0, 1, 0}};
  rig.sense();
  const msg::Altimeter& message = rig.topic<msg::Altimeter>("alt/height").message;
  EXPECT_EQ(message.vertical_reference, 10.5);
  EXPECT_NEAR(message.vertical_position, 13 - 10.5, 1e-14);  // (1, 0, 0.5) -> (-0.5, 0, 1)
  EXPECT_NEAR(message.vertical_velocity, 3 + 0.5, 1e-14);    // (0,1,0) x (-0.5,0,1) = (1, 0, 0.5)
}

}  // namespace
}  // namespace sandlot::altimeter
