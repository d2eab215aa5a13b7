/// The installed package as its users meet it: moved away from where it was installed, found by CMake, with
/// our examples built against it and nothing else.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "command.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string build_folder() { return fs::absolute(SANDLOT_BIN).parent_path().string(); }

/// A value of the build's CMake cache, "" when it has none.
std::string cached(const std::string& name) {
  std::ifstream in(build_folder() + "/CMakeCache.txt");
  for (std::string line; std::getline(in, line);)
    if (line.rfind(name + ":", 0) == 0) return line.substr(line.find('=') + 1);
  return "";
}

/// Installs, and moves what was installed: nothing may remember its first place.
struct Package {
  TestFolder scratch;
  std::string prefix = scratch.file("moved/sandlot");
  Package() {
    const Printed installed = shell("cmake --install " + build_folder() + " --prefix " +
                                    scratch.file("first"));
    EXPECT_EQ(installed.exit_code, 0) << installed.out;
    fs::create_directory(scratch.file("moved"));
    fs::rename(scratch.file("first"), prefix);
    // Each folder in a place of its own: no example may need another.
    for (const auto& each : fs::directory_iterator("examples")) {
      const std::string name = each.path().filename().string();
      fs::create_directory(scratch.file("only_" + name));
      fs::copy(each, example(name), fs::copy_options::recursive);
    }
  }
  /// "embed/room.yaml"
  std::string example(const std::string& name) const {
    return scratch.file("only_" + name.substr(0, name.find('/')) + "/" + name);
  }
  std::string built(const std::string& name) const { return scratch.file("build_" + name); }

  void build(const std::string& name) const {
    std::string configure = "cmake -G Ninja -S " + example(name) + " -B " + built(name) +
                            " -DCMAKE_PREFIX_PATH=" + prefix +
                            " -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=" +
                            cached("CMAKE_CXX_COMPILER");
    if (const std::string ccache = cached("CCACHE");
        !ccache.empty() && ccache.find("NOTFOUND") == std::string::npos)
      configure += " -DCMAKE_CXX_COMPILER_LAUNCHER=" + ccache;
    for (const std::string& command : {configure, "cmake --build " + built(name)}) {
      const Printed printed = shell(command);
      ASSERT_EQ(printed.exit_code, 0) << printed.out;
    }
  }
  Printed run(const std::string& arguments) const { return shell(prefix + "/bin/sandlot " + arguments); }
};

TEST(SlowInstall, TheCommandFindsItsScenariosAndModelsWhereverItStands) {
  const Package package;
  const std::string summary = package.scratch.file("s.json");
  const Printed demo = package.run("demo yard --headless --duration 1s --summary " + summary);
  ASSERT_EQ(demo.exit_code, 0) << demo.out;
  EXPECT_EQ(read_json(summary)["state_hash"], summary_of("scenarios/yard.yaml --duration 1s")["state_hash"]);
  EXPECT_THAT(package.run("--version").out, HasSubstr("sandlot 0."));
}

TEST(SlowInstall, AControllerOfTheUsersOwnDrivesARobot) {
  const Package package;
  package.build("controller");
  const std::string plugin = package.built("controller") + "/my_controllers.so";
  const std::string run = "run " + package.example("controller/wall.yaml") + " --path " +
                          package.built("controller");

  // Small: the simulator is not in it.
  EXPECT_LT(fs::file_size(plugin), 1'000'000u);
  EXPECT_THAT(package.run("list controllers --plugin " + plugin).out,
              HasSubstr("Follows the wall on its right."));

  const std::string summary = package.scratch.file("s.json");
  const Printed printed = package.run(run + " --summary " + summary);
  ASSERT_EQ(printed.exit_code, 0) << printed.out;
  // 20 s at 0.3 m/s are 6 m, less what it takes to turn in corners.
  const auto s = read_json(summary);
  EXPECT_GT(s["robots"][0]["distance_m"].get<double>(), 3.0);
  EXPECT_LT(s["robots"][0]["distance_m"].get<double>(), 6.0);
  ASSERT_EQ(package.run(run + " --threads 2 --summary " + summary).exit_code, 0);
  EXPECT_EQ(read_json(summary)["state_hash"], s["state_hash"]);

  // One that throws: exit code 1, its name, and what there is so far.
  const Printed threw = package.run(run + " --set robots.controller.give_up=3 --summary " + summary);
  EXPECT_EQ(threw.exit_code, 1);
  EXPECT_THAT(threw.out, AllOf(HasSubstr("rover/controller"), HasSubstr("wall"), HasSubstr("I give up")));
  EXPECT_DOUBLE_EQ(read_json(summary)["end_time"].get<double>(), 3.0);

  const Printed other = package.run("list controllers --plugin " + build_folder() +
                                    "/test_plugins/other_api.so");
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.out, AllOf(HasSubstr("version 99"), HasSubstr("this Sandlot has version")));

  // By its name, once it is where an installation keeps plugins.
  fs::create_directory(package.prefix + "/lib/sandlot");
  fs::copy_file(plugin, package.prefix + "/lib/sandlot/my_controllers.so");
  EXPECT_EQ(package.run("check " + package.example("controller/wall.yaml")).exit_code, 0);
}

TEST(SlowInstall, AProgramWithASimulationInsideGivesTheSameStateTwice) {
  const Package package;
  package.build("embed");
  const std::string run = package.built("embed") + "/embed " + package.example("embed/room.yaml");
  const Printed first = shell(run), second = shell("cd / && " + run);
  EXPECT_EQ(first.exit_code, 0) << first.out;
  EXPECT_THAT(first.out, HasSubstr("state "));
  EXPECT_EQ(first.out, second.out);
}

TEST(SlowInstall, AnExperimentIsTheRunCommandWithHooks) {
  const Package package;
  package.build("experiment");
  const std::string run = package.built("experiment") + "/experiment " +
                          package.example("experiment/balls.yaml") +
                          " --duration 9s --json --command 'at 5s move ball1 0 0.5'";
  const Printed first = shell(run + " --threads 1"), second = shell(run + " --threads 2");
  EXPECT_EQ(first.exit_code, 0) << first.out;
  EXPECT_THAT(first.out, AllOf(HasSubstr("4 balls"), HasSubstr("at 5 s: ball1 moved")));
  const auto hash = [](const std::string& out) {
    const std::size_t at = out.find("\"state_hash\"");
    return at == std::string::npos ? "" : out.substr(at, 40);
  };
  EXPECT_FALSE(hash(first.out).empty());
  EXPECT_EQ(hash(first.out), hash(second.out));
  EXPECT_EQ(shell(run + " --command 'at 1s mov ball1 0 0'").exit_code, 2) << "no such command";
  EXPECT_EQ(shell(run + " --command 'at 1s move ball9 0 0'").exit_code, 1)
      << "no such ball when its time comes";
}

TEST(SlowInstall, AClientInCppNeedsNothingOfTheSimulator) {
  const Package package;
  package.build("clients");
  const std::string client = package.built("clients") + "/clearing";
  EXPECT_THAT(shell("ldd " + client).out, Not(HasSubstr("sandlot")));
  EXPECT_EQ(shell(client).exit_code, 2);
  const Printed nowhere = shell("SANDLOT_URL=http://here " + client + " pusher1");
  EXPECT_EQ(nowhere.exit_code, 1);
  EXPECT_THAT(nowhere.out, HasSubstr("'http://here' is not an address"));
}

TEST(SlowInstall, AnAgentWithoutSimulatorNeedsLibselforgAlone) {
  const Package package;
  package.build("selforg");
  const std::string wheels = package.built("selforg") + "/wheels";
  EXPECT_THAT(shell("ldd " + wheels).out,
              AllOf(HasSubstr("libselforg"), Not(HasSubstr("libsandlot")), Not(HasSubstr("ode"))));
  const Printed run = shell(wheels + " --steps 2000 --seed 3");
  ASSERT_EQ(run.exit_code, 0) << run.out;
  // The same bits as the program that the build made of the same source.
  EXPECT_EQ(run.out, shell(build_folder() + "/selforg_wheels --steps 2000 --seed 3").out);
}

/// A program with the navigation library alone and the controller in the run, fed the same messages: the same bits. Both filters of the
/// scenario, of which one has the satellite receiver and its datum.
TEST(SlowInstall, TheFilterAloneGivesTheEstimatesOfTheRunThatWasRecorded) {
  const Package package;
  package.build("estimate_recording");
  const std::string program = package.built("estimate_recording") + "/estimate_recording",
                    recording = package.scratch.file("run.mcap");
  EXPECT_THAT(shell("ldd " + program).out,
              AllOf(HasSubstr("libsandlot_navigation"), Not(HasSubstr("libsandlot.so")),
                    Not(HasSubstr("ode")), Not(HasSubstr("embree"))));
  const Printed run = package.run(
      "run " + package.prefix +
      "/share/sandlot/scenarios/vineyard_loop.yaml --headless --duration 3s --record " + recording);
  ASSERT_EQ(run.exit_code, 0) << run.out;
  const auto exported = [&](const std::string& topic) {
    const std::string file = package.scratch.file(topic.substr(0, topic.find('/')) + ".jsonl");
    EXPECT_EQ(package.run("topic echo " + recording + " /mario/" + topic + " --json > " + file).exit_code, 0);
    return file;
  };
  const std::string wheels = " --program base/odometry=" + exported("base/odometry"),
                    eyes = " --program eyes/odometry=" + exported("eyes/odometry"),
                    inertia = " --device imu=" + exported("imu/imu"),
                    gps = " --device gps=" + exported("gps/fix"),
                    fused = " --expect " + exported("estimator/odometry"),
                    located = " --expect " + exported("locator/odometry");
  const auto estimate = [&](const std::string& filter, const std::string& arguments) {
    return shell(program + " " + package.example("estimate_recording/filters.yaml") + " " + filter +
                 arguments + " > " + package.scratch.file("estimates.jsonl"));
  };
  // 3 s of steps of 10 ms, and the one before the first.
  const std::string all_equal = "301 estimates equal the recorded ones to the bit, 0 differ\n";
  const Printed of_fused = estimate("estimator", wheels + eyes + inertia + fused),
                of_located = estimate("locator", wheels + eyes + inertia + gps + located);
  EXPECT_THAT(of_fused.out,
              AllOf(HasSubstr(all_equal), HasSubstr("imu: "), HasSubstr(" used"), Not(HasSubstr("gps: "))));
  EXPECT_EQ(of_fused.exit_code, 0);
  EXPECT_THAT(of_located.out, AllOf(HasSubstr(all_equal), HasSubstr("gps: ")));
  EXPECT_EQ(of_located.exit_code, 0);

  // The comparison sees when one sensor is missing, and when one comes a step early.
  for (const std::string& sensors : {eyes + inertia, wheels + inertia, wheels + eyes,
                                     wheels + inertia + " --device" + eyes.substr(eyes.find(" eyes"))}) {
    const Printed other = estimate("estimator", sensors + fused);
    EXPECT_EQ(other.exit_code, 1) << sensors;
    EXPECT_THAT(other.out, HasSubstr("differ, the first one at")) << sensors;
  }
  const Printed wrong = estimate("estimator",
                                 " --device imu=" + package.example("estimate_recording/filters.yaml"));
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.out, HasSubstr("filters.yaml:1: this is not a line of `sandlot topic echo --json`"));
  EXPECT_THAT(estimate("locater", wheels).out,
              HasSubstr("there is no filter 'locater'; known are: estimator, locator"));
  EXPECT_THAT(estimate("estimator", " --device gps" + gps.substr(gps.find('='))).out,
              HasSubstr("the filter has no sensor 'gps'; known are: base/odometry, eyes/odometry, imu"));
}

/// Paths of the installed headers, from its include folder.
std::vector<std::string> public_headers(const std::string& include) {
  std::vector<std::string> headers;
  for (const auto& entry : fs::recursive_directory_iterator(include))
    if (entry.path().extension() == ".h") headers.push_back(fs::relative(entry.path(), include));
  std::sort(headers.begin(), headers.end());
  return headers;
}

std::string header_check(const std::string& includes) {
  return cached("CMAKE_CXX_COMPILER") +
         " -std=c++20 -fsyntax-only -Wall -Wextra -Werror -Wno-missing-field-initializers -I. " + includes +
         " -x c++ /dev/null";
}

/// Nothing that an installed header includes is missing, in whatever order a program includes them.
TEST(SlowInstall, PublicHeadersCompileTogetherInAnyOrder) {
  const Package package;
  const std::string include = package.prefix + "/include";
  std::vector<std::string> headers = public_headers(include);
  // The two generations of RoBIOS have the same names: a program has one of them.
  const auto is_older = [](const std::string& header) { return header.rfind("robios6/", 0) == 0; };
  headers.erase(std::remove_if(headers.begin(), headers.end(), is_older), headers.end());
  EXPECT_GT(headers.size(), 40u);
  for (int i = 0; i < 2; ++i) {
    std::string includes;
    for (const std::string& header : headers) includes += " -include " + header;
    const Printed printed = shell("cd " + include + " && " + header_check(includes));
    EXPECT_EQ(printed.exit_code, 0) << printed.out;
    std::reverse(headers.begin(), headers.end());
  }
  EXPECT_FALSE(fs::exists(include + "/sandlot/app/commands.h")) << "the command's own affair";
}

TEST(LongInstall, EveryPublicHeaderCompilesByItself) {
  const Package package;
  const Printed printed = shell("cd " + package.prefix +
                                "/include && find sandlot -name '*.h' | xargs -P2 -I{} " +
                                header_check("-include {}"));
  EXPECT_EQ(printed.exit_code, 0) << printed.out;
}

}  // namespace
}  // namespace sandlot::test
