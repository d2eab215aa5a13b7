/// RoBIOS programs in C with the libraries of robios/, in worlds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/log.h"
#include "base/program.h"
#include "base/test_folder.h"
#include "command.h"
#include "programs/test_sandbox.h"
#include "sim/test_input.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Programs in a folder that others can read, and a cache of its own.
class RobiosPrograms : public testing::Test {
 protected:
  RobiosPrograms() {
    fs::permissions(folder.path, fs::perms(0755));
    ::setenv("XDG_CACHE_HOME", (folder.path / "x/../cache").c_str(), 1);
    fs::create_directory(folder.file("x"));
    fs::create_directory(folder.file("cache"));
    log::set_listener([this](log::Level, std::string_view text) { said += std::string(text) + "\n"; });
  }
  ~RobiosPrograms() override { log::set_listener({}); }
  void SetUp() override { SKIP_WITHOUT_SANDBOX(); }

  model::Setup with(const std::vector<std::string>& programs,
                    const std::vector<std::pair<const char*, const char*>>& more = {}) const {
    model::Setup setup = arena("planar", static_cast<int>(programs.size()), "");
    setup.media.push_back({"air", "radio", Node::map(), {}});
    for (std::size_t i = 0; i < programs.size(); ++i) {
      model::Instance& robot = setup.instances[setup.instances.size() - programs.size() + i];
      model::DeviceDecl radio;
      radio.name = "radio";
      radio.kind = "radio";
      robot.devices.push_back(radio);
      Node config = Node::map();
      config.set("program", Node::scalar(programs[i]));
      config.set("folder", Node::scalar(folder.path.string()));
      for (const auto& [key, text] : more) config.set(key, Node::scalar(text));
      robot.controllers.push_back({"brain", "robios", config, {}});
    }
    return setup;
  }

  TestFolder folder;
  std::string said;
};

TEST_F(RobiosPrograms, ACProgramDrivesItsRobot) {
  folder.write("speed.h", "#define SPEED 250\n");
  folder.write("drive.c", R"(
#include "eyebot.h"
#include "speed.h"
FILE *data;
main() {                       /* as they wrote it then */
  int x, y, phi, wanted;
  data = fopen("wanted.txt", "r");
  fscanf(data, "%d", &wanted);
  VWSetSpeed(SPEED, 0);
  OSWait(2000);
  VWSetSpeed(0, 0);
  OSWait(500);
  VWGetPosition(&x, &y, &phi);
  printf("%s at %d %d, wanted %d\n", missing(1), x, y, wanted);
  return 3;
}
char *missing(int n) { static char text[8] = "done"; return text; }
)");
  folder.write("wanted.txt", "500\n");
  // A pointer from a function without a prototype is an int where pointers are longer: said here before.
  std::string text = folder.read("drive.c");
  text.replace(text.find("FILE *data;"), 11, "FILE *data; char *missing();");
  folder.write("drive.c", text);
  const auto live = build(with({"drive.c"}), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 300);
  EXPECT_EQ(value(*live, "rover1/brain.ended"), 1);
  EXPECT_EQ(value(*live, "rover1/brain.exit_code"), 3);
  EXPECT_THAT(said, HasSubstr("rover1/brain: done at "));
  // 0.25 m/s for 2 s; up to a slot of 50 ms late at either end, and ramps of 2 m/s^2.
  const auto at = said.find("done at ") + 8;
  EXPECT_NEAR(std::stoi(said.substr(at)), 500, 15);
  EXPECT_THAT(said, HasSubstr(", wanted 500"));
}

TEST_F(RobiosPrograms, TheSameTwiceAndOnAnyThreads) {
  folder.write("ping.c", R"(
#include "eyebot.h"
int main() {
  BYTE text[64];
  int me = OSMachineID(), id, n = 0;
  srand(time(0) + me);
  RADIOInit();
  while (n < 100) {
    VWSetSpeed(100 + rand() % 200, rand() % 40 - 20);
    if (n % 2 == me % 2) { sprintf((char *) text, "%d from %d", n, me); RADIOSend(3 - me, (char *) text); }
    OSWait(10 + rand() % 100);
    while (RADIOCheck() > 0) { RADIOReceive(&id, (char *) text, 64); if (id != 3 - me) return 9; }
    n++;
  }
  return 0;
}
)");
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 1, 2, 4}) {
    const auto live = build(with({"ping.c", "ping.c"}), {.threads = threads, .start_programs = true});
    ASSERT_TRUE(live);
    advance(*live, 300);
    hashes.push_back(live->state_hash());
    EXPECT_EQ(value(*live, "rover1/brain.ended"), 0) << said;
    EXPECT_GT(value(*live, "rover1/brain.receptions"), 5);
  }
  EXPECT_THAT(hashes, testing::Each(hashes.front()));
}

TEST_F(RobiosPrograms, CompilesOnceAndAgainWhenSomethingChanged) {
  folder.write("step.h", "#define N 1\n");
  folder.write("program.c", "#include \"eyebot.h\"\n#include \"step.h\"\nint main() { return N; }\n");
  const auto run = [&] {
    const auto live = build(with({"program.c"}), {.start_programs = true});
    if (live) advance(*live, 5);
    return live ? value(*live, "rover1/brain.exit_code") : -1;
  };
  const auto kept = [&] {
    std::set<std::string> out;
    for (const auto& each : fs::directory_iterator(folder.path / "cache" / "sandlot" / "robios"))
      out.insert(each.path().filename().string() +
                 std::to_string(fs::last_write_time(each.path() / "program").time_since_epoch().count()));
    return out;
  };
  EXPECT_EQ(run(), 1);
  const auto first = kept();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(run(), 1);
  EXPECT_EQ(kept(), first);
  folder.write("step.h", "#define N 2\n");
  EXPECT_EQ(run(), 2);
  EXPECT_NE(kept(), first);
}

TEST_F(RobiosPrograms, WhatDoesNotCompileIsShownByItsOwnLines) {
  folder.write("wrong.c", "#include \"eyebot.h\"\nint main() {\n  int x = ;\n}\n");
  Diagnostics diagnostics;
  const auto none = Simulation::create(with({"wrong.c"}), {.start_programs = true}, diagnostics);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text(), HasSubstr("'wrong.c' does not compile:\n"));
  EXPECT_THAT(none.error().text(), HasSubstr("wrong.c:3:11: error:"));
  EXPECT_THAT(none.error().text(), HasSubstr("int x = ;"));
}

TEST_F(RobiosPrograms, ReadNoFilesOfOthersWhileTheyCompile) {
  folder.write(
      "thief.c",
      "#include \"eyebot.h\"\n__asm__(\".incbin \\\"/etc/passwd\\\"\");\nint main() { return 0; }\n");
  Diagnostics diagnostics;
  const auto none = Simulation::create(with({"thief.c"}), {.start_programs = true}, diagnostics);
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().text(), HasSubstr("does not compile"));
}

/// VWControl has hundredths; 0 for Tw means no integral. A robot whose drive has no loops takes the call and keeps its wheels.
TEST_F(RobiosPrograms, GainsOfTheLoopsAreThoseOfTheProgram) {
  const auto program = [&](const char* name, const char* gains) {
    folder.write(name, std::string("#include \"eyebot.h\"\nint main() { VWControl(") + gains +
                           "); VWSetSpeed(200, 0); OSWait(1000); return 0; }\n");
  };
  program("strong.c", "250, 50, 400, 0");
  program("weak.c", "5, 10000, 5, 10000");
  const auto robot = [&](const char* name, const char* file, const char* model, const char* drive, double y) {
    return std::string("  - name: ") + name + "\n    model: {builder: " + model + "}\n    pose: [0, " +
           std::to_string(y) + ", 0]\n    devices: {drive: " + drive +
           "}\n    controller: {kind: robios, program: " + file + "}\n";
  };
  folder.write(
      "gains.yaml",
      "version: 1\nname: gains\nphysics: planar\ntime: {step: 10 ms, substeps: 5, stop: 0.6 s}\nrobots:\n" +
          robot("strong", "strong.c", "mecanum_robot", "{level: contact, control: {}}", 0) +
          robot("weak", "weak.c", "mecanum_robot", "{level: contact, control: {}}", 2) +
          robot("plain", "weak.c", "diff_robot", "{level: contact}", 4));
  const std::string values =
      "strong/drive.control.vv,strong/drive.control.tv,strong/drive.control.vw,strong/drive.control.tw,"
      "strong.twist.linear.x,weak.twist.linear.x,plain.twist.linear.x,strong/controller.refused,plain/"
      "controller.refused";
  const Printed run = sandlot("run " + folder.file("gains.yaml") + " --headless --log " +
                              folder.file("log.csv") + " --log-values " + values);
  ASSERT_EQ(run.exit_code, 0) << run.out;
  std::ifstream log(folder.file("log.csv"));
  std::string line, last;
  while (std::getline(log, line)) last = line;
  std::vector<double> numbers;
  std::stringstream fields(last);
  while (std::getline(fields, line, ',')) numbers.push_back(std::stod(line));
  ASSERT_EQ(numbers.size(), 10u) << last;
  EXPECT_EQ(std::vector(numbers.begin() + 1, numbers.begin() + 5), (std::vector{2.5, 0.5, 4.0, 1e6}));
  EXPECT_GT(numbers[5], 0.15) << "strong gains";
  EXPECT_LT(numbers[6], 0.1) << "gains of a fiftieth";
  EXPECT_NEAR(numbers[7], 0.2, 0.005) << "wheels that keep their speed";
  EXPECT_EQ(numbers[8] + numbers[9], 0);
}

TEST_F(RobiosPrograms, CppAndRobios6AndLibrariesRun) {
  folder.write("plus.cpp",
               "#include \"eyebot.h\"\n#include <vector>\nint main() { std::vector<int> v(4); OSWait(60); "
               "return (int)v.size(); }\n");
  folder.write("six.c",
               "#include \"eyebot.h\"\nint main() { VWHandle vw = VWInit(VW_DRIVE, 1); VWStartControl(vw, 7, "
               "0.3, 10, 0.1); OSWait(6); return vw != 0 ? 6 : 0; }\n");
  folder.write("seven.c", "#include \"eyebot.h\"\nint main() { OSWait(100); return 7; }\n");
  const std::string beside = fs::path(program_files().front()).parent_path().string();
  const std::string library = "cc -shared -fPIC -I robios/include/robios7 " + folder.file("seven.c") +
                              " -o " + folder.file("seven.so") + " -L " + beside +
                              "/robios -Wl,--no-as-needed -lrobios7";
  ASSERT_EQ(std::system(library.c_str()), 0);
  const auto live = build(with({"plus.cpp", "six.c", "seven.so"}), {.start_programs = true});
  ASSERT_TRUE(live) << said;
  advance(*live, 30);
  EXPECT_EQ(value(*live, "rover1/brain.exit_code"), 4) << said;
  EXPECT_EQ(value(*live, "rover2/brain.exit_code"), 6) << said;
  EXPECT_EQ(value(*live, "rover3/brain.exit_code"), 7) << said;
}

}  // namespace
}  // namespace sandlot::test
