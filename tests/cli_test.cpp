/// The command as a user meets it: exit codes, messages, files it leaves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "command.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Cli, EveryVerbExplainsItselfWithAnExample) {
  for (const char* verb : {"run", "demo", "check", "info", "convert", "list", "plot", "bench", "doctor",
                           "replay", "diff", "render"}) {
    const Printed help = sandlot(std::string(verb) + " --help");
    EXPECT_EQ(help.exit_code, 0) << verb;
    EXPECT_THAT(help.out, HasSubstr("Example: sandlot")) << verb;
  }
  EXPECT_THAT(sandlot("--help").out, HasSubstr("Usage: sandlot [OPTIONS] VERB\n"));
  EXPECT_THAT(sandlot("render --help").out, HasSubstr("--shadows,--no-shadows "));
  const std::string help = sandlot("run --help").out;
  EXPECT_THAT(help, HasSubstr("--threads INT (0 to 1024; 1 if left out)\n"));
  EXPECT_THAT(help, HasSubstr("--port INT (0 to 65535; not with --headless)\n"));
  EXPECT_EQ(sandlot("").exit_code, 2);
  EXPECT_EQ(sandlot("fly").exit_code, 2);
  EXPECT_EQ(sandlot("run scenarios/indoor.yaml --sed 3").exit_code, 2);
}

TEST(Cli, WrongOptionsNameTheOptionAndExit2) {
  const auto refused = [](const std::string& arguments, const std::string& word) {
    const Printed printed = sandlot("run " + arguments);
    EXPECT_EQ(printed.exit_code, 2) << arguments;
    EXPECT_THAT(printed.out, HasSubstr(word)) << arguments;
  };
  refused("scenarios/indoor.yaml --duration soon", "--duration");
  refused("scenarios/indoor.yaml --duration -3s", "--duration");
  refused("scenarios/indoor.yaml --rate fast", "--rate");
  refused("scenarios/indoor.yaml --set physics", "--set");
  refused("scenarios/indoor.yaml --set phisics=planar", "physics");
  refused("scenarios/indoor.yaml --snapshot-at 3s", "--snapshot");
  refused("scenarios/nowhere.yaml", "nowhere.yaml");
  refused("scenarios/indor.yaml", "did you mean 'scenarios/indoor.yaml'?");
  refused("rover", "models/rover/model.sdf");
  refused("README.md", "neither a scenario");
  refused("", "needs either a file or --from");
  refused("--from README.md", "not a Sandlot snapshot");
  refused("--from nowhere.snap", "cannot read");
}

TEST(Cli, AMisspeltVerbOrOptionIsAnsweredWithTheNearest) {
  const auto refused = [](const std::string& arguments, const std::string& error) {
    const Printed printed = sandlot(arguments);
    EXPECT_EQ(printed.exit_code, 2) << arguments;
    EXPECT_EQ(printed.out, "error: " + error + "\n") << arguments;
  };
  refused("", "a verb is needed; sandlot --help lists the verbs");
  refused("chek scenarios/indoor.yaml", "there is no verb 'chek'; did you mean 'check'?");
  refused("topic lst run.mcap", "there is no verb 'lst'; did you mean 'list'?");
  EXPECT_EQ(sandlot("help run").out, sandlot("run --help").out);
  EXPECT_EQ(sandlot("help").out, sandlot("--help").out);
  refused("fly", "there is no verb 'fly'; sandlot --help lists the verbs");
  refused("run scenarios/indoor.yaml --duraton 3s",
          "there is no option '--duraton'; did you mean '--duration'?");
  refused("render scenarios/indoor.yaml --sze=8x8", "there is no option '--sze'; did you mean '--size'?");
  refused("run scenarios/indoor.yaml --colour",
          "there is no option '--colour'; sandlot run --help lists the options");
  refused("demo indoor fast", "'fast' is one word too many; sandlot demo --help lists the options");
  refused("list devices camra", "list devices: there is no 'camra'; did you mean 'camera'?");
  refused("list levels camera", "list levels takes no names; leave 'camera' out");
  refused(
      "list messages geometry_msgs/msg/Twits",
      "list messages: there is no type 'geometry_msgs/msg/Twits'; did you mean 'geometry_msgs/msg/Twist'?");
  refused("list devices --schema", "--schema stands for the whole; leave 'devices' out");
  refused("run scenarios/indoor.yaml --svg run.png", "--svg run.png: drawings are SVG; name it run.svg");
  refused("run scenarios/indoor.yaml --record run.bag",
          "--record run.bag: recordings are MCAP; name it run.mcap");
  refused("run scenarios/indoor.yaml --duration",
          "--duration needs a value; sandlot run --help lists the options");
  refused("run scenarios/indoor.yaml --seed x",
          "--seed: 'x' is not a number; sandlot run --help lists the options");
  refused("run scenarios/indoor.yaml --errors -1", "--errors: must be in [0, 1000], is -1");
  refused("run scenarios/indoor.yaml --seed 1 --seed 2",
          "--seed is given more than once; sandlot run --help lists the options");
  refused("demo indor", "there is no demo 'indor'; did you mean 'indoor'?");
}

TEST(Cli, ARunLeavesASummaryWithWhatTheDocsPromise) {
  const auto s = summary_of("scenarios/indoor.yaml --duration 5s --seed 3");
  ASSERT_FALSE(s.contains("failed")) << s["failed"];
  for (const char* key : {"ticks", "sim_seconds", "wall_seconds", "real_time_factor", "phase_us",
                          "state_hash", "profile", "criterion", "teams", "warnings", "errors"})
    EXPECT_TRUE(s.contains(key)) << key;
  EXPECT_DOUBLE_EQ(s["sim_seconds"].get<double>(), 5.0);
  EXPECT_EQ(s["seed"], 3);
  EXPECT_EQ(s["errors"].size(), 0u);
  EXPECT_EQ(s["warnings"].size(), 0u);
  EXPECT_EQ(s["state_hash"].get<std::string>().size(), 16u);
}

TEST(Cli, RenderTakesAPictureOrSaysWhatIsWrong) {
  const TestFolder scratch;
  const std::string file = scratch.file("a.png"),
                    view = "render scenarios/indoor.yaml --from 1,1,1 --at 3,3,0 --out ";
  const Printed printed = sandlot(view + file + " --size 64x48 --samples 1 --time 100ms");
  EXPECT_EQ(printed.exit_code, 0) << printed.out;
  EXPECT_EQ(printed.out, "");
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  const auto refused = [](const std::string& arguments, const std::string& word) {
    const Printed said = sandlot(arguments);
    EXPECT_EQ(said.exit_code, 2) << arguments;
    EXPECT_THAT(said.out, HasSubstr(word)) << arguments;
  };
  refused(view + scratch.file("a.bmp"), "call it .png or .jpg");
  refused(view + scratch.file("no/such/a.png") + " --size 8x8", "no/such/a.png");
  refused(view + file + " --size 100000x100000", "100000");
  refused(view + file + " --size big", "--size");
  refused(view + file + " --plane red", "--plane");
  refused(view + file + " --overhead", "--from");
  refused("render scenarios/indoor.yaml --out " + file, "--camera");
  refused("render scenarios/indoor.yaml --camera follow:nobody --out " + file, "nobody");
}

TEST(Cli, AFilmLeavesTheRunAsItIs) {
  const TestFolder scratch;
  const std::string run = "scenarios/indoor.yaml --duration 400ms --seed 3";
  const std::string film = " --camera overhead --video-size 64x48 --video-rate 10 --video " +
                           scratch.file("a.mp4");
  const auto without = summary_of(run), with = summary_of(run + film);
  ASSERT_FALSE(with.contains("failed")) << with["failed"];
  EXPECT_EQ(with["state_hash"], without["state_hash"]);
  EXPECT_EQ(with["video"]["pictures"], 5) << "at 0, 0.1 ... 0.4 s";
  const auto refused = [&](const std::string& arguments, const std::string& word) {
    const Printed said = sandlot("run " + run + " " + arguments);
    EXPECT_EQ(said.exit_code, 2) << arguments;
    EXPECT_THAT(said.out, HasSubstr(word)) << arguments;
  };
  refused("--video " + scratch.file("b.mp4"), "--camera");
  refused("--camera overhead", "--video");
  refused("--camera overhead --video " + scratch.file("b.avi"), "b.avi");
  refused("--camera overhead --video " + scratch.file("no/such/b.mp4"), "b.mp4");
  refused("--camera overhead --video-size 63x48 --video " + scratch.file("b.mp4"), "63x48");
  refused("--camera overhead --video scenarios/indoor.yaml", "indoor.yaml");
}

TEST(Cli, ASnapshotGoesOnInANewProcessToTheSameHash) {
  for (const char* scenario :
       {"scenarios/indoor.yaml", "scenarios/indoor.yaml --set physics=planar", "scenarios/pile.yaml",
        "scenarios/fleet.yaml", "scenarios/gripping.yaml", "scenarios/gripping.yaml --set physics=planar"}) {
    const TestFolder scratch;
    const std::string snapshot = scratch.file("half.snapshot");
    const auto whole = summary_of(std::string(scenario) + " --duration 6s");
    ASSERT_FALSE(whole.contains("failed")) << whole["failed"];
    const Printed half = sandlot(std::string("run ") + scenario + " --headless --duration 3s --snapshot " +
                                 snapshot);
    ASSERT_EQ(half.exit_code, 0) << half.out;
    const auto rest = summary_of("--from " + snapshot + " --duration 3s --threads 2");
    ASSERT_FALSE(rest.contains("failed")) << rest["failed"];
    EXPECT_EQ(rest["sub_hashes"], whole["sub_hashes"]) << scenario;
    EXPECT_EQ(rest["end_tick"], whole["end_tick"]) << scenario;
  }
}

TEST(Cli, ASnapshotInMidRunChangesNothing) {
  const TestFolder scratch;
  const auto plain = summary_of("scenarios/pile.yaml --duration 4s");
  const auto with = summary_of("scenarios/pile.yaml --duration 4s --snapshot-at 2s --snapshot " +
                               scratch.file("s.snapshot"));
  EXPECT_EQ(plain["state_hash"], with["state_hash"]);
  const auto rest = summary_of("--from " + scratch.file("s.snapshot"));
  EXPECT_EQ(plain["state_hash"], rest["state_hash"]) << "--from alone goes on to the stop time of the run";
}

TEST(Cli, AWorldThatExplodesIsNamedAndLeftAsASnapshot) {
  const TestFolder scratch;
  const std::string world = scratch.write("drop.sdf",
                                          R"(<sdf version="1.9"><world name="drop"><model name="stone">
<pose>0 0 100 0 0 0</pose><link name="link"><inertial><mass>1</mass></inertial><collision name="c"><geometry><sphere>
<radius>0.1</radius></sphere></geometry></collision></link></model></world></sdf>)");
  const std::string scenario = scratch.write(
      "drop.yaml", "version: 1\nname: deep drop\nworld: drop.sdf\nphysics: {max_speed: 3}\n");
  const auto run = [&](const std::string& more) {
    return shell("cd " + scratch.path.string() + "; " + std::filesystem::absolute(SANDLOT_BIN).string() +
                 " run " + scenario + " --headless --duration 2s " + more);
  };
  for (const std::string file : {"sandlot-failed-deep_drop.snapshot", "asked.snapshot"}) {
    const Printed printed = run(file[0] == 'a' ? "--snapshot asked.snapshot" : "--summary s.json");
    EXPECT_EQ(printed.exit_code, 1);
    EXPECT_NE(printed.out.find("'stone/link' has exploded"), std::string::npos) << printed.out;
    EXPECT_NE(printed.out.find("the world before it is in '" + file + "'"), std::string::npos) << printed.out;
    const Printed info = sandlot("info " + scratch.file(file));
    EXPECT_EQ(info.exit_code, 0) << info.out;
    EXPECT_NE(info.out.find("0.3 s, tick 30"), std::string::npos) << info.out;
  }
  EXPECT_FALSE(std::filesystem::exists(scratch.file("sandlot-failed-deep_drop.snapshot.tmp")));
  const auto summary = read_json(scratch.file("s.json"));
  EXPECT_EQ(summary.dump().find("nan"), std::string::npos);
  ASSERT_EQ(summary["errors"].size(), 1u);
  EXPECT_NE(summary["errors"][0].dump().find("has exploded"), std::string::npos);
}

TEST(Cli, FilesThatCannotBeWrittenFailTheRunWith1) {
  const Printed printed = sandlot(
      "run scenarios/indoor.yaml --headless --duration 1s --summary /nonexistent/s.json");
  EXPECT_EQ(printed.exit_code, 1);
  EXPECT_THAT(printed.out, HasSubstr("/nonexistent/s.json"));
}

TEST(Cli, CheckTellsFileLineAndRemedy) {
  const TestFolder scratch;
  const std::string good = "version: 1\nname: g\nrobots: []\n";
  EXPECT_EQ(sandlot("check " + scratch.write("good.yaml", good)).exit_code, 0);
  const std::string bad = scratch.write("bad.yaml", "version: 1\nname: b\nphysiks: rigid\n");
  const Printed printed = sandlot("check " + bad);
  EXPECT_EQ(printed.exit_code, 2);
  EXPECT_THAT(printed.out, HasSubstr(bad + ":3:"));
  EXPECT_THAT(printed.out, HasSubstr("did you mean 'physics'?"));
  const auto json = nlohmann::json::parse(sandlot("check --json " + bad).out);
  EXPECT_EQ(json[0]["line"], 3);
  EXPECT_EQ(json[0]["severity"], "error");
}

TEST(Cli, ARunThatIsRefusedLeavesTheLogOfTheOneBefore) {
  const TestFolder scratch;
  const std::string log = scratch.write("run.csv", "worth keeping\n");
  const Printed printed = sandlot(
      "run scenarios/indoor.yaml --headless --duration 1s --log-values sim.tick --log " + log +
      " --record /nonexistent/r.mcap");
  EXPECT_EQ(printed.exit_code, 2);
  EXPECT_THAT(printed.out, HasSubstr("/nonexistent/r.mcap"));
  std::string kept;
  std::getline(std::ifstream(log), kept);
  EXPECT_EQ(kept, "worth keeping");
}

TEST(Cli, NoResultOfARunOverwritesAnotherOne) {
  const TestFolder scratch;
  const std::string file = scratch.file("x.mcap");
  const Printed twice = sandlot(
      "run scenarios/indoor.yaml --headless --duration 1s --log-values sim.tick --log " + file +
      " --record " + scratch.file("y/../x.mcap"));
  EXPECT_EQ(twice.exit_code, 2);
  EXPECT_THAT(twice.out, HasSubstr("would overwrite"));
  const std::string scenario = scratch.write("s.yaml", "version: 1\nname: s\nrobots: []\n");
  EXPECT_EQ(sandlot("run " + scenario + " --duration 1s --summary " + scenario).exit_code, 2);
  EXPECT_EQ(sandlot("run " + scenario + " --duration 1s --summary /dev/null --svg /dev/null").exit_code, 0);
}

TEST(Cli, ASnapshotThatTheRunDidNotReachIsSaidToBeAnother) {
  const TestFolder scratch;
  const Printed printed = sandlot(
      "run scenarios/indoor.yaml --headless --duration 1s --snapshot-at 9s --snapshot " +
      scratch.file("s.snapshot"));
  EXPECT_EQ(printed.exit_code, 0);
  EXPECT_THAT(printed.out, HasSubstr("the run ended before 9 s"));
}

TEST(Cli, ListShowsMessageTypesWithUnitsAndConstants) {
  EXPECT_THAT(sandlot("list messages").out, HasSubstr("\n  sensor_msgs/msg/LaserScan\n"));
  const std::string all = sandlot("list messages --verbose").out;
  for (const char* part : {"float32[]", "STATUS_NO_FIX = -1", "[m]", "float64[36]"})
    EXPECT_THAT(all, HasSubstr(part));
  const auto json = nlohmann::json::parse(sandlot("list messages --json").out);
  EXPECT_GT(json["messages"].size(), 80u);
  EXPECT_EQ(json["messages"][0]["fields"][0]["type"], "int32");
  EXPECT_THAT(sandlot("list messages").out, HasSubstr("\n  sandlot_msgs/srv/Console\n"));
  for (const auto& message : json["messages"])
    EXPECT_EQ(message["name"].get<std::string>().find("/srv/"), std::string::npos) << message["name"];
  for (const auto& service : json["services"])
    if (service["name"] == "simulation_interfaces/srv/StepSimulation") {
      EXPECT_EQ(service["request"]["fields"][0]["type"], "uint64");
      EXPECT_EQ(service["response"]["fields"][0]["type"], "simulation_interfaces/msg/Result");
    }
}

TEST(Cli, ListShowsEveryKindAndTheSchemaIsJson) {
  const Printed text = sandlot("list --verbose");
  for (const char* kind : {"laser_scanner", "diff_drive", "wheel_encoder", "joint_motor", "ground_truth",
                           "wander", "waypoints", "rigid", "planar"})
    EXPECT_THAT(text.out, HasSubstr(kind));
  const auto json = nlohmann::json::parse(sandlot("list --json").out);
  EXPECT_GE(json["devices"].size(), 5u);
  const auto schema = nlohmann::json::parse(sandlot("list --schema").out);
  EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
  EXPECT_THAT(schema.dump(), HasSubstr("laser_scanner"));
  EXPECT_THAT(sandlot("list --markdown").out, HasSubstr("### laser_scanner"));
  const Printed wrong = sandlot("list device");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.out, HasSubstr("did you mean 'devices'?"));
}

TEST(Cli, ListShowsFileFormatsWithTheirExtensions) {
  const std::string text = sandlot("list formats").out;
  for (const char* part : {"formats\n", "  sdf ", ".sdf, .world", ".urdf", ".yaml", ".dae"})
    EXPECT_THAT(text, HasSubstr(part));
  const auto json = nlohmann::json::parse(sandlot("list formats --json").out);
  EXPECT_EQ(json["formats"][0]["name"], "scenario");
  EXPECT_EQ(json["formats"][0]["contents"], "scenarios");
  EXPECT_EQ(json["formats"][0]["extensions"], nlohmann::json({".yaml", ".yml"}));
  EXPECT_EQ(json["formats"][0]["written"], true);
}

TEST(Cli, ListGivesTheNameOfAKindOnceAndAlignsItsColumns) {
  const std::string text = "\n" + sandlot("list levels").out;
  EXPECT_THAT(text, HasSubstr("\n  camera               image "));
  EXPECT_THAT(text, HasSubstr("\n                       objects "));
  EXPECT_THAT(sandlot("list devices").out, Not(HasSubstr("Levels: height")));
}

TEST(Cli, ListPrintsOneKindOrTypeWithAllItsFields) {
  const std::string camera = sandlot("list devices camera").out;
  EXPECT_EQ(camera.find("devices\n  camera  "), 0u);
  EXPECT_THAT(camera, HasSubstr("\n    horizontal_fov "));
  EXPECT_THAT(camera, Not(HasSubstr("\n  imu ")));
  EXPECT_EQ(nlohmann::json::parse(sandlot("list rules goals impact --json").out)["rules"].size(), 2u);
  const std::string twist = sandlot("list messages Twist").out;
  EXPECT_EQ(twist.find("messages\n  geometry_msgs/msg/Twist\n    "), 0u);
  EXPECT_THAT(twist, Not(HasSubstr("TwistStamped\n")));
}

TEST(Cli, InfoPrintsTheTree) {
  const Printed text = sandlot("info scenarios/indoor.yaml");
  EXPECT_EQ(text.exit_code, 0);
  for (const char* part :
       {"robot rover, 4.2 kg, at 1.6 4.65 0, model of models/rover/model.sdf:4", "joint  left_wheel_joint ",
        "device  rover/laser ", "models/rover/model.sdf:152", "sensor_msgs/msg/LaserScan", "sphere r 0.05",
        "controller  controller  wander", "1 robot, 7 objects, 43 static things; 9.", "on endless ground"})
    EXPECT_THAT(text.out, HasSubstr(part));
  const auto json = nlohmann::json::parse(sandlot("info --json scenarios/indoor.yaml").out);
  EXPECT_GT(json["instances"].size(), 10u);
  const auto& rover = json["instances"].back();
  EXPECT_EQ(rover["name"], "rover");
  EXPECT_EQ(rover["role"], "robot");
  EXPECT_EQ(rover["links"].size(), 3u);
  EXPECT_EQ(rover["links"][1]["collisions"][0]["radius_m"], 0.05);
  EXPECT_EQ(rover["joints"][0]["axis"], nlohmann::json({0.0, 1.0, 0.0}));
  EXPECT_TRUE(rover["joints"][0]["lower"].is_null()) << "no limit";
  EXPECT_EQ(rover["devices"][1]["rate_hz"], 10.0);
  EXPECT_EQ(rover["devices"][1]["place"]["line"], 152);
  EXPECT_EQ(json["warnings"].size(), 0u);
}

TEST(Cli, InfoFoldsWhatIsAlikeAndTellsWhatWasMappedAndWhatWasNot) {
  const TestFolder scratch;
  std::string world = "<sdf version='1.9'><world name='w'>\n";
  const auto add_box = [&](const std::string& name, const char* mu) {
    world += "<model name='" + name +
             "'><link name='l'><inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz>"
             "</inertia></inertial><collision name='c'><geometry><box><size>1 2 3</size></box></geometry>"
             "<surface><friction><ode><mu>" +
             mu + "</mu></ode></friction></surface></collision></link></model>\n";
  };
  for (int i = 1; i <= 500; ++i) add_box("box" + std::to_string(i), "1");
  add_box("slippery", "0.1");
  world +=
      "<model name='my robot'><link name='l'><inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy>"
      "<izz>0.1</izz></inertia></inertial>\n<sensor name='the scan' "
      "type='gpu_lidar'><update_rate>10</update_rate>"
      "<lidar><scan><horizontal><samples>5</samples><min_angle>-1</min_angle><max_angle>1</max_angle>"
      "</horizontal></scan><range><min>0.1</min><max>5</max></range></lidar></sensor>\n"
      "<sensor name='nose' type='smell'/></link></model>\n</world></sdf>\n";
  const std::string file = scratch.write("many.sdf", world);
  const Printed text = sandlot("info " + file);
  EXPECT_EQ(text.exit_code, 0) << text.out;
  EXPECT_THAT(text.out, HasSubstr("object  box1 .. box500 (500 alike)  2 kg  box 1 x 2 x 3\n"));
  EXPECT_THAT(text.out, HasSubstr("object  slippery ")) << "its friction is another";
  EXPECT_THAT(text.out, HasSubstr("robot my_robot (in the file: \"my robot\"), 1 kg"));
  EXPECT_THAT(text.out, HasSubstr("device  my_robot/the_scan  laser_scanner  level ranges  10 Hz  on l  "
                                  "from sensor:gpu_lidar \"the scan\" at " +
                                  file + ":504"));
  EXPECT_THAT(text.out, HasSubstr("/my_robot/the_scan/ranges"));
  EXPECT_THAT(text.out, HasSubstr(file + ":505: <sensor type=\"smell\"> is not supported"));
  EXPECT_LT(std::count(text.out.begin(), text.out.end(), '\n'), 25) << "500 boxes are one line";
  const auto json = nlohmann::json::parse(sandlot("info --json " + file).out);
  EXPECT_EQ(json["instances"].size(), 502u);
  EXPECT_EQ(json["warnings"][0]["place"]["line"], 505);
  EXPECT_EQ(json["instances"][501]["devices"][0]["mapped_from"][0], "sensor:gpu_lidar");
  EXPECT_EQ(json["instances"][501]["original_name"], "my robot");
}

TEST(Cli, DoctorIsContent) {
  const Printed printed = sandlot("doctor");
  EXPECT_EQ(printed.exit_code, 0) << printed.out;
  EXPECT_THAT(printed.out, Not(HasSubstr("BAD")));
}

TEST(Cli, ThePictureIsSvgWithTheRobotsPath) {
  const TestFolder scratch;
  const std::string file = scratch.file("run.svg");
  ASSERT_EQ(sandlot("run scenarios/indoor.yaml --headless --duration 10s --svg " + file).exit_code, 0);
  std::ifstream in(file);
  const std::string svg((std::istreambuf_iterator<char>(in)), {});
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
  EXPECT_THAT(svg, HasSubstr("rover"));
}

TEST(Cli, ARunWithoutAnEndCanBeInterruptedAndStillReports) {
  const TestFolder scratch;
  const std::string file = scratch.file("s.json");
  const std::string command = "timeout -s INT 2 " + std::string(SANDLOT_BIN) +
                              " run scenarios/indoor.yaml --headless --rate 1 --duration 1000s --summary " +
                              file + " >/dev/null 2>&1";
  (void)!std::system(command.c_str());
  const auto summary = read_json(file);
  ASSERT_TRUE(summary.is_object());
  EXPECT_GT(summary["ticks"].get<int>(), 50);
  EXPECT_LT(summary["sim_seconds"].get<double>(), 10) << "--rate 1 keeps to real time";
}

}  // namespace
}  // namespace sandlot::test
