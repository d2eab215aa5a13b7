#include <gtest/gtest.h>

#include "fake_simulator.h"

namespace {

TEST(RobiosFirst, DrivesPrintsAndWaits) {
  fake::Simulator sim;
  sim.press(400 * fake::millisecond, 1);
  const fake::Result r = sim.run(fake::compile("first.c", 7));
  EXPECT_EQ(r.exit_code, 5) << r.errors;
  EXPECT_EQ(r.finished, 5);
  EXPECT_EQ(r.output, "key at 400\n500 0 90, front 100\n");
  EXPECT_EQ(sim.lines.at(0), "Hello 7");
  EXPECT_EQ(sim.lines.at(3), "  x=500");
  EXPECT_EQ(sim.menu, (std::vector<std::string>{"GO", "", "", "END"}));
}

TEST(RobiosFirst, NeedsASimulator) {
  std::string errors;
  EXPECT_FALSE(fake::compiles("exec " + fake::compile("first.c", 7), &errors));
  EXPECT_NE(errors.find("SANDLOT_ROBIOS_FD"), std::string::npos) << errors;
}

}  // namespace
