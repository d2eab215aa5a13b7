#include "console/console.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "console/test_console.h"

namespace sandlot {
namespace {

using test::has;
using test::Talk;

TEST(Console, SetsAParameterAndTellsWhen) {
  Talk talk(test::arena("rigid", 1));
  EXPECT_EQ(talk.ok("show rover1/laser.noise.white"), "rover1/laser.noise.white = 0.01 m");
  EXPECT_EQ(talk.ok("set rover1/laser.noise.white 2 cm"),
            "rover1/laser.noise.white = 0.02 m with the next tick");
  EXPECT_EQ(talk.ok("show rover1/laser.noise.white"), "rover1/laser.noise.white = 0.01 m");
  talk.step();
  EXPECT_EQ(talk.ok("show rover1/laser.noise.white"), "rover1/laser.noise.white = 0.02 m");
}

TEST(Console, WhileItRunsTheAnswerNamesTheTick) {
  Talk talk(test::arena("rigid", 1));
  talk.ok("run max");
  const std::string answer = talk.ok("set rover1/laser.noise.white = 30mm");
  EXPECT_TRUE(has(answer, "rover1/laser.noise.white = 0.03 m from tick ")) << answer;
  talk.ok("pause");
  EXPECT_EQ(talk.ok("view rover1/laser.noise.white"), "rover1/laser.noise.white = 0.03 m");
}

TEST(Console, PatternsSetManyAndNothingElse) {
  Talk talk(test::arena("rigid", 3));
  EXPECT_EQ(talk.ok("set rover[12]/laser.noise.white 0.05"),
            "rover1/laser.noise.white = 0.05 m with the next tick\n"
            "rover2/laser.noise.white = 0.05 m with the next tick");
  talk.step();
  EXPECT_EQ(talk.ok("show */laser.noise.white"),
            "rover1/laser.noise.white = 0.05 m\nrover2/laser.noise.white = 0.05 m\nrover3/laser.noise.white "
            "= 0.01 m");
  EXPECT_EQ(talk.ok("show **.noise.white"), talk.ok("show */laser.noise.white"));
}

TEST(Console, ErrorsHaveSlidersOfTheWorldAndOfRobots) {
  Talk talk(test::arena("rigid", 2));
  EXPECT_EQ(talk.ok("set errors 0.5"), "sim.errors = 0.5 with the next tick");
  EXPECT_EQ(talk.ok("set rover*.errors 2"),
            "rover1.errors = 2 with the next tick\nrover2.errors = 2 with the next tick");
  EXPECT_EQ(talk.ok("set rover2.errors = 300 %"), "rover2.errors = 300 % with the next tick");
  talk.step();
  EXPECT_EQ(talk.ok("show sim.errors"), "sim.errors = 0.5");
  EXPECT_EQ(talk.ok("show rover1.errors"), "rover1.errors = 2");
  EXPECT_EQ(talk.ok("show rover2.errors"), "rover2.errors = 3");
  EXPECT_TRUE(has(talk.refused("set errors -1"), "must be in [0, 1000]"));
  EXPECT_TRUE(has(talk.refused("set rovr1.errors 1"), "did you mean 'rover1'"));
}

TEST(Console, DevicesFailAtAWord) {
  Talk talk(test::arena("rigid", 2));
  EXPECT_EQ(talk.ok("set rover1/laser.failure dead"), "rover1/laser.failure = dead with the next tick");
  EXPECT_EQ(talk.ok("set */laser.failure = {kind: noisy, factor: 3}"),
            "rover1/laser.failure = {kind: noisy, factor: 3} with the next tick\n"
            "rover2/laser.failure = {kind: noisy, factor: 3} with the next tick");
  EXPECT_EQ(talk.ok("set rover1/drive.failure planned"), "rover1/drive.failure = planned with the next tick");
  EXPECT_TRUE(has(talk.refused("set rover1/laser.failure ded"), "dead"));
  EXPECT_TRUE(has(talk.refused("set rover1/lasr.failure dead"), "rover1/laser"));
}

TEST(Console, WrongValuesAreAnsweredAtOnce) {
  Talk talk(test::arena("rigid", 1));
  EXPECT_TRUE(has(talk.refused("set rover1/laser.noise.white -1"), "must be"))
      << talk.say("set rover1/laser.noise.white -1").text;
  EXPECT_TRUE(has(talk.refused("set rover1/laser.noise.white 2 kg"), "unit 'kg' does not fit"));
  EXPECT_TRUE(has(talk.refused("set rover1/laser.noise.wite 1"), "rover1/laser.noise.white"));
  EXPECT_TRUE(has(talk.refused("set rover1/laserr.noise.white 1"), "did you mean 'rover1/laser'"));
  EXPECT_TRUE(has(talk.refused("set rober1/laser.noise.white 1"), "did you mean 'rover1'"));
  EXPECT_TRUE(has(talk.refused("set rover1/laser.beams 10"), "fixed once the run has started"));
  EXPECT_TRUE(has(talk.refused("set rover1/laser.noise.white"), "needs more words"));
  EXPECT_TRUE(has(talk.refused("set rover1 1"), "is not a parameter"));
}

TEST(Console, SetsPropertiesOfTheUsersOwnWithinTheirRange) {
  model::Setup setup = test::arena("rigid", 2);
  for (model::Instance& each : setup.instances)
    if (each.is_robot) each.properties = {{"fuel", "kg", 5, 0, 10}};
  Talk talk(setup);
  EXPECT_EQ(talk.ok("set rover1.fuel 3000 g"), "rover1.fuel = 3000 g with the next tick");
  talk.step();
  EXPECT_EQ(talk.ok("show rover1.fuel"), "rover1.fuel = 3 kg");
  EXPECT_EQ(talk.ok("show rover2.fuel"), "rover2.fuel = 5 kg");
  EXPECT_EQ(talk.ok("set *.fuel = 1"),
            "rover1.fuel = 1 with the next tick\nrover2.fuel = 1 with the next tick");
  EXPECT_TRUE(has(talk.refused("set rover1.fuel 11"), "/rover1.fuel: must be in [0, 10]"));
  EXPECT_TRUE(has(talk.refused("set rover1.fual 1"), "is not a parameter"));
  EXPECT_TRUE(has(talk.refused("set pillar1.fuel 1"), "is not a parameter"));
}

TEST(Console, ControllersHaveParametersToo) {
  Talk talk(test::arena("rigid", 1));
  const std::string list = talk.ok("list parameters");
  EXPECT_TRUE(has(list, "rover1/controller.speed = ")) << list;
  talk.ok("set rover1/controller.speed 0.125");
  talk.step();
  EXPECT_EQ(talk.ok("show rover1/controller.speed"), "rover1/controller.speed = 0.125 m/s");
}

TEST(Console, UnknownWordsNameTheNearest) {
  Talk talk(test::arena("rigid", 1));
  EXPECT_TRUE(has(talk.refused("puase"), "did you mean 'pause'"));
  EXPECT_TRUE(has(talk.refused("help puase"), "did you mean 'pause'"));
  EXPECT_TRUE(has(talk.refused("list topcs"), "did you mean 'topics'"));
  EXPECT_TRUE(has(talk.refused("pause now"), "stands alone"));
  EXPECT_EQ(talk.ok(""), "");
  EXPECT_EQ(talk.ok("  \t "), "");
  EXPECT_FALSE(talk.say(std::string(5000, 'x')).ok);
  EXPECT_FALSE(talk.say("echo a\nb").ok);
}

TEST(Console, MediaAndRulesAreSetByTheirNames) {
  model::Setup setup = test::arena("planar", 1);
  setup.media.push_back({"breeze", "wind", Node::map(), {}});
  Talk talk(std::move(setup));
  EXPECT_TRUE(has(talk.ok("set media/breeze.density 2"), "media/breeze.density = 2 kg/m^3"));
  EXPECT_EQ(talk.refused("set media/breze.density 2"),
            "there is no 'media/breze'; did you mean 'media/breeze'?");
  EXPECT_EQ(talk.refused("set media/breeze.densty 2"),
            "no parameter 'densty' of 'media/breeze' can be set; did you mean 'media/breeze.density'?");
  Talk still(test::arena("planar", 1));
  EXPECT_EQ(still.refused("set rules/goals.reset true"),
            "there is no 'rules/goals'; the scenario declares neither media nor rules");
}

TEST(Console, SpectatorsLookAndDoNotSteer) {
  Talk talk(test::arena("rigid", 1));
  for (const char* line :
       {"pause", "run", "step", "speed 2", "reset", "jump 0", "set rover1/laser.noise.white 0.02",
        "pose rover1 1 1", "drag rover1 1 1", "add box 1 1", "remove rover1", "store a", "load a",
        "record a.mcap", "level rover1/drive ideal", "sample rover1/laser", "quit",
        "pull rover1 base_link 0 0 0 0 0 1", "command rover1/drive Twist {}"})
    EXPECT_TRUE(has(talk.refused(line, false), "you may watch, not steer")) << line;
  for (const char* line :
       {"help", "list", "show rover1.pose.x", "time", "hash", "values", "events", "echo hello"})
    EXPECT_TRUE(talk.say(line, false).ok) << line;
  EXPECT_EQ(talk.session.report().tick, 0u);
}

TEST(Console, PosesAndDrags) {
  Talk talk(test::arena("rigid", 1));
  talk.ok("pose crate1 1 m 50 cm 0.2 90 deg");
  talk.step();
  // At rest on the ground: a tick of 10 ms moves it by nothing that the solver does not allow (its ERP), under 1 mm.
  EXPECT_NEAR(talk.place("crate1").x, 1, 1e-3);
  EXPECT_NEAR(talk.place("crate1").y, 0.5, 1e-3);
  EXPECT_NEAR(
      talk.ask([](const Simulation& s) { return yaw_of(s.engine().pose(s.find_entity("crate1")->id).q); }),
      math::pi / 2, 1e-3);
  talk.ok("drag crate1 -1 0.25");
  talk.step();
  EXPECT_NEAR(talk.place("crate1").x, -1, 1e-3);
  EXPECT_NEAR(talk.place("crate1").z, 0.2, 1e-3);
  EXPECT_NEAR(
      talk.ask([](const Simulation& s) { return yaw_of(s.engine().pose(s.find_entity("crate1")->id).q); }),
      math::pi / 2, 1e-3);
  EXPECT_TRUE(has(talk.ok("pose crate1"), "crate1 is at -1"));
  EXPECT_TRUE(has(talk.refused("pose crate1 1"), "a pose is X Y"));
  EXPECT_TRUE(has(talk.refused("pose crate1 1 x"), "Y: 'x' is not a number"));
  EXPECT_TRUE(has(talk.refused("drag crate1 1 1 1 1"), "turns nothing"));
  EXPECT_TRUE(has(talk.refused("pose crate3 1 1"), "did you mean 'crate"));
}

TEST(Console, PullsWithASpring) {
  Talk talk(test::arena("rigid", 1));
  const Vec3 before = talk.place("crate1");
  for (int i = 0; i < 40; ++i) {
    talk.ok("pull crate1 link 0 0 0 0.4 -1.1 1.2");
    talk.step(10);
  }
  // Critically damped with w = 2 pi / s: after 4 s it hangs g / w^2 below the target.
  EXPECT_NEAR(talk.place("crate1").z, 1.2 - 9.81 / (4 * math::pi * math::pi), 0.02);
  EXPECT_NEAR(talk.place("crate1").y, -1.1, 0.02);
  EXPECT_GT(talk.place("crate1").z, before.z + 0.5);
  talk.ok("pull crate1 off");
  EXPECT_TRUE(has(talk.refused("pull crate1 lnk 0 0 0 0 0 1"), "did you mean 'link'"));
  EXPECT_TRUE(has(talk.refused("pull crate1 link 0 0 0 0 0"), "TZ is missing"));
}

TEST(Console, AddsThingsThatStandOnWhatIsThere) {
  Talk talk(test::arena("rigid", 1));
  EXPECT_TRUE(has(talk.ok("add box 1 -1 size=0.4 mass=2 color=red"), "box (box) at 1 -1 0.2 m"));
  EXPECT_TRUE(has(talk.ok("add sphere ball 1 2 size=20cm"), "ball (sphere) at 1 2 0.1 m"));
  talk.step();
  // On top of the first: 0.4 m of it and half of its own 0.2 m.
  EXPECT_TRUE(has(talk.ok("add box 1 -1 size=0.2"), "box2 (box) at 1 -1 0.5 m"));
  talk.step(100);
  EXPECT_NEAR(talk.place("box").z, 0.2, 2e-3);
  EXPECT_NEAR(talk.place("box2").z, 0.5, 4e-3);
  const auto mass = talk.ask(
      [](const Simulation& s) { return mass_kg(*s.find_entity("box")->instance.model); });
  EXPECT_DOUBLE_EQ(mass, 2);
  EXPECT_TRUE(has(talk.refused("add box box 0 0"), "'box3' is free"));
  EXPECT_TRUE(has(talk.refused("add bxo 0 0"), "did you mean 'box'"));
  EXPECT_TRUE(has(talk.refused("add box 0 0 size=1,2"), "size=X,Y,Z"));
  EXPECT_TRUE(has(talk.refused("add box 0 0 colr=red"), "did you mean 'color'"));
}

TEST(Console, AddsACopyOfARobot) {
  Talk talk(test::arena("rigid", 1));
  talk.ok("add copy of rover1 as ann 2 -1 0 90 deg");
  talk.ok("add rover1 bob 2 -2");
  talk.step();
  EXPECT_EQ(talk.ok("show ann/laser.parameter.max_range"), "ann/laser.parameter.max_range = 6 m");
  EXPECT_NEAR(talk.place("ann").x, 2, 0.01);
  // The rover's wheels touch the ground when its frame is on it.
  EXPECT_NEAR(talk.place("bob").z, 0, 2e-3);
  EXPECT_EQ(talk.ok("remove [ab]*"), "ann removed with the next tick\nbob removed with the next tick");
  talk.step();
  EXPECT_FALSE(talk.ask([](const Simulation& s) { return s.find_entity("ann") != nullptr; }));
}

TEST(Console, AddsAModelFile) {
  Talk talk(test::arena("rigid", 1));
  const auto models = nlohmann::json::parse(talk.ok("list models --json"));
  bool found = false;
  for (const auto& model : models) found = found || model["name"] == "models/rover/model.sdf";
  EXPECT_TRUE(found) << models.dump();
  talk.ok("add models/rover/model.sdf ann 2 -1");
  talk.ok("add rover bob 2 -2");
  talk.step();
  EXPECT_TRUE(has(talk.ok("list ann"), "ann/laser  laser_scanner"));
  EXPECT_TRUE(talk.ask([](const Simulation& s) { return s.find_entity("bob")->instance.is_robot; }));
  EXPECT_FALSE(talk.say("add ../../../etc/passwd 1 1").ok);
  EXPECT_FALSE(talk.say("add /etc/passwd 1 1").ok);
}

TEST(Console, CommandsADevice) {
  model::Setup setup = test::arena("rigid", 1, "");
  Talk talk(std::move(setup));
  const Vec3 before = talk.place("rover1");
  talk.ok("command rover1/drive Twist {\"linear\": {\"x\": 0.3}}");
  talk.step(200);
  // 2 s at 0.3 m/s, less the time to get there; the drive's own limits make that well under half a second.
  EXPECT_NEAR(norm(talk.place("rover1") - before), 0.6, 0.15);
  EXPECT_TRUE(has(talk.refused("command rover1/drive Twist {\"linear\": 3}"), "linear"));
  EXPECT_TRUE(has(talk.refused("command rover1/drive Image {}"),
                  "takes no Image; known are: geometry_msgs/msg/Twist"));
  EXPECT_TRUE(has(talk.refused("command rover1/drve Twist {}"), "did you mean 'rover1/drive'"));
}

TEST(Console, PressesKeys) {
  model::Setup setup = test::arena("planar", 2);
  for (const char* name : {"keys", "more"}) {
    model::DeviceDecl keys;
    keys.name = name;
    keys.kind = "keys";
    setup.instances.back().devices.push_back(keys);
  }
  Talk talk(std::move(setup));
  talk.step();
  EXPECT_EQ(talk.ok("press rover2 3"), "rover2/keys got key 3 with the next tick");
  EXPECT_EQ(talk.ok("press rover2 touch 12 -5"), "rover2/keys got a touch at 12 -5 with the next tick");
  talk.ok("press rover2/more 1");
  talk.step();
  const auto presses = [&](const std::string& device) {
    return talk.ask([&](const Simulation& s) {
      msg::KeyPresses found;
      for (const auto& each : s.find_entity("rover2")->devices)
        for (const auto& topic : each->topics)
          if (topic.topic->name() == "/rover2/" + device + "/presses")
            found = topic_cast<msg::KeyPresses>(topic.topic.get())->message;
      return found;
    });
  };
  const msg::KeyPresses pressed = presses("keys");
  ASSERT_EQ(pressed.latest.size(), 2u);
  EXPECT_EQ(pressed.latest[0].key, 3u);
  EXPECT_EQ(pressed.latest[1].key, 0u);
  EXPECT_EQ(pressed.latest[1].x, 12);
  EXPECT_EQ(pressed.latest[1].y, -5);
  EXPECT_EQ(presses("more").count, 1u);
  EXPECT_TRUE(has(talk.refused("press rover1 1"), "rover1 has no keys"));
  EXPECT_TRUE(has(talk.refused("press rovr2 1"), "did you mean 'rover2'"));
  for (const char* line : {"press rover2 -1", "press rover2 0", "press rover2 one", "press rover2 touch 1",
                           "press rover2 1 2", "press rover2 touch 1 x", "press rover2 99999999999"})
    EXPECT_TRUE(has(talk.refused(line), "press")) << line;
  talk.refused("press rover2 1", false);
}

TEST(Console, CallsServicesOfDevices) {
  model::Setup setup = test::arena("planar", 1);
  model::DeviceDecl odometry;
  odometry.name = "odo";
  odometry.kind = "wheel_odometry";
  odometry.config = test::map({{"left_joint", "left_wheel_joint"},
                               {"right_joint", "right_wheel_joint"},
                               {"wheel_radius", "0.07"},
                               {"wheel_separation", "0.3"}});
  setup.instances.back().devices.push_back(odometry);
  Talk talk(std::move(setup));
  EXPECT_EQ(talk.ok("call rover1/odo reset"), "rover1/odo reset with the next tick");
  EXPECT_TRUE(has(talk.refused("call rover1/odo rest"), "did you mean 'reset'"));
  EXPECT_TRUE(has(talk.refused("call rover1/laser reset"), "a laser_scanner offers none"));
  EXPECT_TRUE(has(talk.refused("call rover1/od reset"), "did you mean 'rover1/odo'"));
  EXPECT_TRUE(has(talk.refused("call rover1/odo reset {\"x\": 1}"), "x"));
  EXPECT_TRUE(has(talk.refused("call rover1/odo reset", false), "you may watch, not steer"));
  EXPECT_EQ(talk.complete("call rover1/odo "), (std::vector<std::string>{"reset", "set_pose"}));
  talk.ok("run");
  EXPECT_EQ(talk.ok("call rover1/odo reset"),
            R"(rover1/odo reset: {"success":true,"message":"the odometry is at zero"})");
  EXPECT_EQ(talk.ok(R"(call rover1/odo set_pose {"pose": {"pose": {"pose": {"position": {"x": 1}}}}})"),
            "rover1/odo set_pose: {}");
  EXPECT_TRUE(has(talk.refused(R"(call rover1/odo set_pose {"pose": {"header": {"frame_id": "map"}}})"),
                  "give it in"));
}

TEST(Console, StepsSpeedsAndTellsTheTime) {
  Talk talk(test::arena("rigid", 1));
  talk.step(7);
  EXPECT_EQ(talk.session.report().tick, 7u);
  EXPECT_TRUE(has(talk.ok("time"), "0.07 s, tick 7, paused"));
  EXPECT_EQ(talk.ok("speed 0.5"), "real time x 0.5");
  EXPECT_EQ(talk.session.report().speed, 0.5);
  EXPECT_EQ(talk.ok("speed max"), "as fast as possible");
  EXPECT_FALSE(talk.session.report().speed);
  EXPECT_FALSE(talk.say("speed 1e9").ok);
  EXPECT_FALSE(talk.say("speed fast").ok);
  EXPECT_FALSE(talk.say("step 0.5").ok);
  EXPECT_FALSE(talk.say("step -1").ok);
}

TEST(Console, ShowsExpressionsAndStructs) {
  Talk talk(test::arena("rigid", 1));
  EXPECT_EQ(talk.ok("show crate1.pose.x*2 'crate1.pose.y + 1'"),
            "crate1.pose.x*2 = 0.8\ncrate1.pose.y + 1 = -1.1");
  EXPECT_TRUE(has(talk.ok("show crate1.pose"), "crate1.pose.x = 0.4 m\ncrate1.pose.y = -2.1 m\n"))
      << talk.ok("show crate1.pose");
  EXPECT_TRUE(has(talk.refused("show crate1.pose.xx"), "crate1.pose"));
  const auto rows = nlohmann::json::parse(talk.ok("show sim.tick sim.time --json"));
  EXPECT_EQ(rows[0]["address"], "sim.tick");
  EXPECT_EQ(rows[1]["unit"], "s");
}

/// Two thousand words of one letter would have answers of gigabytes, for whoever may look.
TEST(Console, ShowsSoManyValuesInOneLine) {
  Talk talk(test::arena("rigid", 2));
  const std::string one = talk.ok("show ** --json");
  const auto values = nlohmann::json::parse(one).size();
  ASSERT_GT(values, 20u);
  std::string line = "show --json";
  for (std::size_t met = 0; met <= 10'000; met += values) line += " **";
  ASSERT_LE(line.size(), 4096u);
  const Answer answer = talk.say(line, false);
  EXPECT_FALSE(answer.ok);
  EXPECT_TRUE(has(answer.text.substr(0, 100), "the line meets more than 10000 values"));
}

TEST(Console, ListsADeviceForThePage) {
  Talk talk(test::arena("rigid", 1));
  talk.step();
  const auto rows = nlohmann::json::parse(talk.ok("list rover1/laser --json"));
  bool ranges = false, white = false;
  for (const auto& row : rows) {
    EXPECT_EQ(row["address"].get<std::string>().rfind("rover1/laser", 0), 0u);
    if (row["address"] == "rover1/laser.ranges") ranges = row["count"] == 61;
    if (row["address"] == "rover1/laser.noise.white") white = row["value"] == 0.01 && row["unit"] == "m";
  }
  EXPECT_TRUE(ranges);
  EXPECT_TRUE(white);
  const auto things = nlohmann::json::parse(talk.ok("list entities --json"));
  EXPECT_EQ(things.size(), 10u);  // ground, four walls, two pillars, two crates, the rover
  EXPECT_TRUE(has(talk.ok("ls topics"), "/rover1/laser/ranges  sensor_msgs/msg/LaserScan  1"));
  EXPECT_TRUE(has(talk.refused("list rover1/lasr"), "did you mean 'rover1/laser'"));
}

TEST(Console, StoresAndLoads) {
  const test::TestFolder folder;
  Talk talk(test::arena("rigid", 1), {.folder = folder.path.string()});
  talk.step(20);
  const std::string hash = talk.ok("hash");
  talk.ok("store a.snapshot");
  talk.step(20);
  EXPECT_NE(talk.ok("hash"), hash);
  EXPECT_TRUE(has(talk.ok("load a.snapshot"), "at 0.2 s, tick 20"));
  EXPECT_EQ(talk.ok("hash"), hash);
  talk.ok("store a.snapshot");  // a snapshot may be replaced
  std::ofstream(folder.path / "scenario.yaml") << "version: 1\n";
  EXPECT_TRUE(has(talk.refused("store scenario.yaml"), "is not a snapshot"));
  EXPECT_TRUE(has(talk.refused("load scenario.yaml"), "is not a snapshot"));
  EXPECT_TRUE(has(talk.refused("store ../a"), "not within the run's folder"));
  EXPECT_TRUE(has(talk.refused("store x/../../a"), "not within the run's folder"));
  EXPECT_TRUE(has(talk.refused("store /usr/a"), "not within the run's folder"));
  std::filesystem::create_directory_symlink("/usr", folder.path / "out");
  EXPECT_TRUE(has(talk.refused("store out/a"), "not within the run's folder"));
  EXPECT_TRUE(has(talk.refused("load b.snapshot"), "there is no file"));
}

TEST(Console, RecordsByWhatItIsGiven) {
  const test::TestFolder folder;
  std::string asked;
  Talk talk(test::arena("rigid", 1), {.folder = folder.path.string(), .record = [&](const std::string& file) {
                                        asked = file.empty() ? "off" : file;
                                        return Result<std::string>("fine");
                                      }});
  EXPECT_EQ(talk.ok("record run.mcap"), "fine");
  EXPECT_EQ(asked, folder.file("run.mcap"));
  talk.ok("record off");
  EXPECT_EQ(asked, "off");
  EXPECT_FALSE(talk.say("record run.txt").ok);
  EXPECT_FALSE(talk.say("record ../run.mcap").ok);
  Talk without(test::arena("rigid", 1));
  EXPECT_TRUE(has(without.refused("record run.mcap"), "nothing can be recorded"));
}

TEST(Console, CompletesWordsAndAddresses) {
  Talk talk(test::arena("rigid", 12));
  using Words = std::vector<std::string>;
  EXPECT_EQ(talk.complete("pa"), (Words{"pause"}));
  EXPECT_EQ(talk.complete("set rover1"), (Words{"rover1/", "rover10/", "rover11/", "rover12/"}));
  const Words laser = talk.complete("set rover2/laser.noise.w");
  EXPECT_EQ(laser, (Words{"rover2/laser.noise.white"}));
  EXPECT_EQ(talk.complete("show rover2.pose.y"), (Words{"rover2.pose.y", "rover2.pose.yaw"}));
  EXPECT_EQ(talk.complete("level rover2/drive "), (Words{"contact", "ideal"}));
  EXPECT_EQ(talk.complete("command rover2/d"), (Words{"rover2/drive"}));
  EXPECT_EQ(talk.complete("pull crate1 "), (Words{"link"}));
  EXPECT_EQ(talk.complete("pause x"), Words{});
  EXPECT_EQ(talk.complete("nonsense x"), Words{});
  EXPECT_EQ(talk.complete("remove crate"), (Words{"crate1", "crate2"}));
  EXPECT_LE(talk.complete("show rover2/").size(), 100u);
}

TEST(Console, PublishesOnTopicsThatProgramsRead) {
  model::Setup setup = test::arena("planar", 2);
  setup.instances.back().controllers.push_back(
      {"localiser",
       "localise",
       test::map({{"map_data", "90 90 0.1 -4.5 -4.5 0\n450*100 7650*0"},
                  {"odometry", "truth"},
                  {"begin", "topic"},
                  {"max_particles", "500"}}),
       {}});
  Talk talk(std::move(setup));
  using Words = std::vector<std::string>;
  EXPECT_EQ(talk.complete("command rover2/i"), (Words{"rover2/initialpose"}));
  EXPECT_EQ(talk.complete("command rover1/i"), Words{}) << "that one has no such program";
  EXPECT_EQ(talk.complete("command rover2/initialpose "),
            (Words{"geometry_msgs/msg/PoseWithCovarianceStamped"}));
  EXPECT_EQ(talk.complete("show rover2/initialpose.c"), (Words{"rover2/initialpose.count"}));
  talk.ok(
      R"(command rover2/initialpose PoseWithCovarianceStamped {"pose": {"pose": {"position": {"x": 1.5}}}})");
  talk.ok(
      R"(command /rover2/initialpose geometry_msgs/PoseWithCovarianceStamped {"header": {"frame_id": "x"}})");
  talk.step(6);
  EXPECT_EQ(talk.ok("show rover2/initialpose.count"), "rover2/initialpose.count = 2");
  EXPECT_EQ(talk.ok("show rover2/localiser.refused"), "rover2/localiser.refused = 1")
      << "of two in one control step the last counts, and its frame is not the map's";
  EXPECT_TRUE(
      has(talk.refused("command rover2/initialpose Twist {}"),
          "'rover2/initialpose' takes no Twist; known are: geometry_msgs/msg/PoseWithCovarianceStamped"));
  EXPECT_TRUE(has(talk.refused("command rover2/initialpos PoseWithCovarianceStamped {}"),
                  "there is no device or topic 'rover2/initialpos' that takes commands; did you mean "
                  "'rover2/initialpose'?"));
  for (const char* const name : {"initialpose", "/initialpose", "rover7/initialpose"})
    EXPECT_TRUE(has(talk.refused("command " + std::string(name) + " PoseWithCovarianceStamped {}"),
                    "'rover2/initialpose'"))
        << name;
  EXPECT_TRUE(has(
      talk.refused(R"(command rover2/initialpose PoseWithCovarianceStamped {"pose": {"pos": 1}})"), "pos"));
}

TEST(Console, ListsWhatBelongsToNoRobot) {
  model::Setup setup = test::arena("planar", 1, "");
  setup.media.push_back({"air", "shout", Node::map(), {}});
  model::TeamDecl& team = setup.teams.emplace_back();
  team.name = "red";
  team.controllers.push_back({"coach", "formation", test::map({{"odometry", "truth"}}), {}});
  setup.instances.back().team = "red";
  Talk talk(setup);
  EXPECT_TRUE(has(talk.ok("list media/air"), "media/air  shout\n"));
  EXPECT_TRUE(has(talk.ok("list media/air"), "media/air.words"));
  EXPECT_TRUE(has(talk.ok("list red/coach --json"), "red/coach.spacing"));
  EXPECT_TRUE(has(talk.ok("show re*/coach.spacing"), "red/coach.spacing = 1 m"));
  EXPECT_TRUE(has(talk.refused("list media/aer"), "did you mean 'media/air'"));
  EXPECT_EQ(talk.complete("list media/"), (std::vector<std::string>{"media/air"}));
}

}  // namespace
}  // namespace sandlot
