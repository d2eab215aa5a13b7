/// Promises of scenarios/soccer_practice.yaml.
#include <gtest/gtest.h>

#include "command.h"

namespace sandlot::test {
namespace {

TEST(SoccerPractice, RunsAtEveryLevelOnBothEngines) {
  for (const std::string engine : {"rigid", "planar"})
    for (const std::string drive : {"ideal", "contact", "roller"})
      for (const std::string sense : {"image", "objects", "world"}) {
        const Printed run = sandlot(
            "run scenarios/soccer_practice.yaml --headless --duration 200ms --set engine=" + engine +
            " --set drive=" + drive + " --set sense=" + sense);
        SCOPED_TRACE(engine + " " + drive + " " + sense + "\n" + run.out);
        if (engine == "planar" && drive == "roller") {
          EXPECT_EQ(run.exit_code, 2);
          EXPECT_NE(run.out.find("rollers"), std::string::npos) << "the error names the level";
          continue;
        }
        EXPECT_EQ(run.exit_code, 0);
        EXPECT_EQ(run.out.find("warning"), std::string::npos);
      }
}

/// The lines of its header: the ball is taken, dribbled and lies in the goal in the end.
TEST(SoccerPractice, TheLinesOfItsHeaderScore) {
  for (const std::string engine : {"rigid", "planar"}) {
    const Printed run = sandlot(
        "run scenarios/soccer_practice.yaml --headless --duration 6s --set engine=" + engine +
        " --command 'at 0.1s command cyan2/handler Float64 {\"data\": 1}'"
        " --command 'at 0.5s command cyan2/drive Twist {\"linear\": {\"x\": 1.5}}'"
        " --command 'at 2.4s command cyan2/handler Float64 {\"data\": 0}'"
        " --command 'at 2.42s command cyan2/kicker Float64 {\"data\": 3}'"
        " --stop-when 'ball.pose.x > 11.11 and abs(ball.pose.y) < 1.2 and cyan2/handler.grips == 1 and "
        "cyan2/kicker.hits == 1'");
    SCOPED_TRACE(engine + "\n" + run.out);
    EXPECT_EQ(run.exit_code, 0);
    EXPECT_EQ(run.out.find("simulated time reached"), std::string::npos) << "it does not score";
    EXPECT_NE(run.out.find("stopped"), std::string::npos);
  }
}

}  // namespace
}  // namespace sandlot::test
