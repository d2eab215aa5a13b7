/// The command `controllers`: what it lists, what it does, and what of it a jump and a reset leave.
#include "console/test_console.h"

namespace sandlot {
namespace {

using test::has;
using test::Talk;

TEST(ControllersCommand, ListsThemForEverybody) {
  Talk talk(test::arena("planar", 2));
  const std::string both =
      "rover1/controller  wander  active  commands drive\n"
      "rover2/controller  wander  active  commands drive";
  EXPECT_EQ(talk.ok("controllers"), both);
  EXPECT_EQ(talk.say("controllers", false).text, both);
  EXPECT_EQ(
      talk.ok("controllers rover2 --json"),
      R"([{"path":"rover2/controller","kind":"wander","state":"active","program":true,"claims":["drive"]}])");
  EXPECT_EQ(talk.refused("controllers stop rover1/controller", false),
            "this is for those who may steer; you may watch");
}

/// Goes there and waits until it is there.
void jump(Talk& talk, const std::string& time, std::uint64_t tick) {
  talk.ok("jump " + time);
  const auto is_there = [&] {
    const Session::Report report = talk.session.report();
    return report.tick == tick && report.state == Session::State::paused && !report.target;
  };
  for (int i = 0; i < 2000 && !is_there(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(talk.session.report().tick, tick);
}

TEST(ControllersCommand, ExchangesThemAndAResetBringsThoseOfTheScenarioBack) {
  Talk talk(test::arena("planar", 1));
  talk.ok("controllers load rover1/tour wander {speed: 0.2}");
  talk.step();
  EXPECT_EQ(talk.ok("controllers"),
            "rover1/controller  wander  active  commands drive\nrover1/tour  wander  unconfigured");
  talk.ok("controllers configure rover1/tour");
  talk.step();
  talk.ok("controllers start rover1/tour stop rover1/controller");
  talk.step();
  const std::string after =
      "rover1/controller  wander  inactive  commands drive\nrover1/tour  wander  active  commands drive";
  EXPECT_EQ(talk.ok("controllers"), after);
  EXPECT_TRUE(has(talk.ok("show rover1/tour.speed"), "0.2"));
  talk.step(30);
  const std::string hash = talk.ok("hash");
  talk.step(30);
  // From the beginning again, the run takes the switches from its own log.
  jump(talk, "330 ms", 33);
  EXPECT_EQ(talk.ok("hash"), hash);
  EXPECT_EQ(talk.ok("controllers"), after);
  jump(talk, "10 ms", 1);
  EXPECT_EQ(talk.ok("controllers"),
            "rover1/controller  wander  active  commands drive\nrover1/tour  wander  unconfigured");
  talk.ok("reset");
  EXPECT_EQ(talk.ok("controllers"), "rover1/controller  wander  active  commands drive");
}

TEST(ControllersCommand, SaysWhatIsMissing) {
  Talk talk(test::arena("planar", 1));
  EXPECT_TRUE(has(talk.refused("controllers load rover1/x"), "needs a name and a kind"));
  EXPECT_TRUE(
      has(talk.refused("controllers start rover1"), "'rover1' names no controller; write ROBOT/CONTROLLER"));
  EXPECT_TRUE(has(talk.refused("controllers start crate1/x"), "'crate1' is not a robot"));
  EXPECT_TRUE(has(talk.refused("controllers start rover9/x"), "rover9"));
  EXPECT_TRUE(has(talk.refused("controllers start"), "needs a controller"));
  EXPECT_TRUE(has(talk.refused("controllers start stop"), "no controller is named"));
  EXPECT_TRUE(has(talk.refused("controllers strat rover1/x"), "did you mean 'start'?"));
  EXPECT_TRUE(has(talk.refused("controllers load rover1/x ../x.yaml"), "x.yaml"));
  EXPECT_EQ(talk.complete("controllers sta"), std::vector<std::string>{"start"});
  EXPECT_EQ(talk.complete("controllers stop rover1/"), std::vector<std::string>{"rover1/controller"});
}

}  // namespace
}  // namespace sandlot
