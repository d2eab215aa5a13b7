/// Users' own controllers in shared libraries, by the command: they drive robots, are saved and restored, and
/// what does not fit is refused with the place that asked for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command.h"
#include "control/controller.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Where the build leaves tests/plugins/x.cpp as x.so.
std::string plugins() { return (fs::absolute(SANDLOT_BIN).parent_path() / "test_plugins").string(); }

/// A robot on an empty plane, driven by the given controller of the given plugin; control steps every 10 ms.
std::string plugin_scenario(const std::string& plugin, const std::string& controller) {
  return "version: 1\nname: spin\nphysics: planar\nplugins: [" + plugin +
         "]\ntime: {step: 10 ms, stop: 1 s}\nrobots:\n  - name: rover\n    model: " +
         fs::absolute("models/rover").string() + "\n    controller: " + controller + "\n";
}

TEST(Plugin, ItsControllerDrivesARobot) {
  const TestFolder scratch;
  // Order k, given in tick k - 1, turns by gain * k for a tick of 10 ms: after 100 ticks the sum is 0.5050
  // rad. Each begins 0.01 rad/s below its rate and gains it at 6 rad/s^2, which costs 0.01^2 / (2 * 6) rad.
  const double predicted_rad = 0.01 * 0.01 * (100 * 101 / 2) - 100 * 0.01 * 0.01 / (2 * 6);
  const std::string here = scratch.write("here.yaml", plugin_scenario("good", "spinner"));
  fs::copy_file(plugins() + "/good.so", scratch.file("libgood.so"));
  const std::vector<std::string> ways{
      scratch.write("file.yaml", plugin_scenario(plugins() + "/good.so", "spinner")),
      scratch.write("name.yaml", plugin_scenario("good", "{kind: spinner, gain: 0.01}")) + " --path " +
          plugins(),
      here,  // lib and .so are added, beside the scenario
  };
  std::string hash;
  for (const std::string& way : ways) {
    const auto s = summary_of(way);
    ASSERT_FALSE(s.contains("failed")) << s["failed"];
    EXPECT_NEAR(s["robots"][0]["pose"][5].get<double>(), predicted_rad, 1e-9) << way;
    if (hash.empty()) hash = s["state_hash"];
    EXPECT_EQ(s["state_hash"], hash) << way;
  }
}

TEST(Plugin, ItsControllersAreListedWithTheirFields) {
  const Printed listed = sandlot("list controllers --verbose --plugin " + plugins() + "/good.so");
  EXPECT_EQ(listed.exit_code, 0) << listed.out;
  EXPECT_THAT(listed.out,
              AllOf(HasSubstr("spinner"), HasSubstr("Rate gained in each step."), HasSubstr("wander")));
  EXPECT_THAT(sandlot("list controllers").out, Not(HasSubstr("spinner")));
  EXPECT_EQ(sandlot("list controllers --plugin nowhere").exit_code, 2);
}

TEST(Plugin, ASnapshotNamesItsPluginAndGoesOnWithIt) {
  const TestFolder scratch;
  fs::copy_file(plugins() + "/good.so", scratch.file("mine.so"));
  const std::string run = scratch.write("s.yaml", plugin_scenario("mine.so", "spinner"));
  const auto whole = summary_of(run);
  const std::string snapshot = scratch.file("half.snap");
  ASSERT_FALSE(summary_of(run + " --snapshot-at 0.5s --snapshot " + snapshot).contains("failed"));
  const auto rest = summary_of("--from " + snapshot);
  ASSERT_FALSE(rest.contains("failed")) << rest["failed"];
  EXPECT_EQ(rest["state_hash"], whole["state_hash"]);

  // Moved away: an error that names it; found again by --path.
  fs::create_directory(scratch.file("elsewhere"));
  fs::rename(scratch.file("mine.so"), scratch.file("elsewhere/mine.so"));
  const Printed lost = sandlot("run --from " + snapshot);
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_THAT(lost.out,
              AllOf(HasSubstr("half.snap"), HasSubstr("needs plugin 'test_good'"), HasSubstr("mine.so")));
  EXPECT_EQ(summary_of("--from " + snapshot + " --path " + scratch.file("elsewhere"))["state_hash"],
            whole["state_hash"]);

  // Another plugin in its place is refused; another build of it is a warning.
  fs::copy_file(plugins() + "/taken.so", scratch.file("mine.so"));
  const Printed other = sandlot("run --from " + snapshot);
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.out, AllOf(HasSubstr("'test_good'"), HasSubstr("'test_taken'")));
  fs::copy_file(scratch.file("elsewhere/mine.so"), scratch.file("mine.so"),
                fs::copy_options::overwrite_existing);
  std::ofstream(scratch.file("mine.so"), std::ios::app | std::ios::binary) << "x";
  const Printed rebuilt = sandlot("run --from " + snapshot);
  EXPECT_EQ(rebuilt.exit_code, 0);
  EXPECT_THAT(rebuilt.out, HasSubstr("warning: plugin '" + scratch.file("mine.so") + "' is not the build"));
}

TEST(Plugin, WhatDoesNotFitIsRefusedWithItsPlace) {
  const TestFolder scratch;
  const auto refused = [&](const std::string& plugin, auto&& matcher) {
    const std::string file = scratch.write("bad.yaml", plugin_scenario(plugin, "spinner"));
    for (const char* verb : {"run ", "check "}) {
      const Printed printed = sandlot(verb + file);
      EXPECT_EQ(printed.exit_code, 2) << verb << plugin << printed.out;
      EXPECT_THAT(printed.out, AllOf(HasSubstr("error: " + file + ":4:"), matcher)) << verb << plugin;
    }
  };
  refused("no/where.so", HasSubstr("looked for it in "));
  refused("nowhere", AllOf(HasSubstr("'nowhere' is not there"), HasSubstr("libnowhere.so")));
  refused("bad.yaml", HasSubstr("not a shared library"));
  refused(fs::absolute(SANDLOT_BIN).string(), HasSubstr("cannot load"));  // a program, not a library
  refused(plugins() + "/no_plugin.so", HasSubstr("is not a Sandlot plugin"));
  refused(plugins() + "/other_api.so",
          AllOf(HasSubstr("version 99"), HasSubstr("has version " + std::to_string(controller_api_version))));
  refused(plugins() + "/other_build.so", AllOf(HasSubstr("fast-math"), HasSubstr("this Sandlot as [")));
  refused(plugins() + "/taken.so", AllOf(HasSubstr("'wander'"), HasSubstr("so does Sandlot")));
  refused(plugins() + "/good.so, " + plugins() + "/good.so", HasSubstr("'spinner'"));

  // Cut short where the loader would map it: a message, not SIGBUS. (Debug information at the end may be
  // missing.)
  std::ifstream in(plugins() + "/good.so", std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{3}, std::size_t{63}, std::size_t{200}, std::size_t{4096}})
    refused(scratch.write("cut.so", whole.substr(0, size)), HasSubstr("cut.so"));
}

TEST(Plugin, ANameThatNoControllerHasSuggestsThoseOfThePlugin) {
  const TestFolder scratch;
  const Printed printed = sandlot("check " +
                                  scratch.write("s.yaml", plugin_scenario(plugins() + "/good.so", "spiner")));
  EXPECT_EQ(printed.exit_code, 2);
  EXPECT_THAT(printed.out, HasSubstr("did you mean 'spinner'?"));
}

TEST(Plugin, AControllerThatThrowsEndsTheRunAndKeepsItsResults) {
  const TestFolder scratch;
  const auto run = [&](const std::string& end) {
    return scratch.write(
        "s.yaml", plugin_scenario(plugins() + "/good.so", "{kind: spinner, steps: 30, end: " + end + "}"));
  };
  const std::string summary = scratch.file("s.json"), svg = scratch.file("s.svg");
  const Printed printed = sandlot("run " + run("exception") + " --summary " + summary + " --svg " + svg);
  EXPECT_EQ(printed.exit_code, 1) << printed.out;
  EXPECT_THAT(printed.out, AllOf(HasSubstr("rover/controller"), HasSubstr("spinner"), HasSubstr("dizzy")));
  const auto kept = read_json(summary);
  EXPECT_EQ(kept["end_tick"], 30) << "steps 1 to 30 were made at ticks 0 to 29";
  EXPECT_THAT(kept["errors"][0].get<std::string>(), HasSubstr("dizzy"));
  EXPECT_TRUE(fs::exists(svg));

  const Printed number = sandlot("run " + run("number"));
  EXPECT_EQ(number.exit_code, 1);
  EXPECT_THAT(number.out, HasSubstr("not a std::exception"));

  // In its first step: the run has begun, so it is still a run that failed.
  const std::string first = scratch.write(
      "first.yaml", plugin_scenario(plugins() + "/good.so", "{kind: spinner, steps: 0, end: exception}"));
  EXPECT_EQ(sandlot("run " + first).exit_code, 1);

  // Before it: the input is wrong, and the place says where.
  const std::string start = scratch.write(
      "start.yaml", plugin_scenario(plugins() + "/good.so", "{kind: spinner, fail_at_start: true}"));
  const Printed refused = sandlot("run " + start);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.out, AllOf(HasSubstr(start + ":9:"), HasSubstr("no battery")));
}

}  // namespace
}  // namespace sandlot::test
