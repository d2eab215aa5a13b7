/// Scenarios of teams, by the command: they end as they should, a law gives one hash as part of Sandlot and as a plugin, and
/// `reproduce` writes one page that needs no network.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <regex>
#include <sstream>

#include "command.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

std::string read_file(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Teams, TwoPushersClearTheYardOnBothEngines) {
  for (const char* const engine : {"planar", "rigid"}) {
    const auto s = summary_of(std::string("scenarios/clearing.yaml --set boxes=2 --set physics=") + engine);
    ASSERT_FALSE(s.contains("failed")) << s["failed"];
    EXPECT_EQ(s["criterion"], 1.0) << engine;
    EXPECT_EQ(s["success"], true) << engine;
    EXPECT_LT(s["end_time"], 120) << engine;
  }
}

TEST(Teams, AGroupMayBeEmptyAndMovesNothingElse) {
  const auto without = summary_of("scenarios/clearing.yaml --duration 100ms");
  const auto with = summary_of("scenarios/clearing.yaml --duration 100ms --set disturbers=1");
  ASSERT_FALSE(without.contains("failed")) << without["failed"];
  ASSERT_EQ(without["robots"].size(), 2u);
  ASSERT_EQ(with["robots"].size(), 3u);
  EXPECT_EQ(without["sub_hashes"]["box1"], with["sub_hashes"]["box1"]);
}

TEST(Teams, TheClearingLawIsTheSameAsAPlugin) {
  // Its text: all lines but those that name the place it is in.
  const auto same = [](const std::string& file) {
    std::string ours = read_file("src/controllers/clearing/" + file);
    ours = std::regex_replace(ours, std::regex("#include \"controllers/clearing/(\\w+).h\""),
                              "#include \"$1.h\"");
    ours = std::regex_replace(ours, std::regex("#include \"control/controller.h\""),
                              "#include <sandlot/control.h>");
    ours = std::regex_replace(ours, std::regex("\n#include \"(control/steering|base/math).h\""), "");
    ours = std::regex_replace(ours, std::regex("namespace sandlot::controllers::clearing \\{"),
                              "namespace my_clearing {\n\nusing namespace sandlot;");
    ours = std::regex_replace(ours, std::regex("namespace sandlot::controllers::clearing"),
                              "namespace my_clearing");
    ours = std::regex_replace(ours, std::regex("= clearing::"), "= my_clearing::");
    ours = std::regex_replace(ours, std::regex("\n\n\n"), "\n\n");
    EXPECT_EQ(ours, read_file("examples/clearing_plugin/" + file));
  };
  same("clearing.h");
  same("clearing.cpp");
  // Its arithmetic: for the client in C++, too, which has nothing of the simulator.
  for (const auto& [place, file] : {std::pair("my_clearing::exact", "examples/clearing_plugin/exact.h"),
                                    std::pair("exact", "examples/clients/exact.h")})
    EXPECT_EQ(std::regex_replace(read_file("src/controllers/clearing/exact.h"),
                                 std::regex("sandlot::controllers::clearing::exact"), place),
              read_file(file));

  const std::string plugins = (fs::absolute(SANDLOT_BIN).parent_path() / "test_plugins").string();
  const std::string text = read_file("examples/clearing_plugin/clearing.yaml");
  const TestFolder scratch;
  const auto run = [&](const std::string& kind) {
    return summary_of(scratch.write(kind + ".yaml", std::regex_replace(text, std::regex("kind: my_clearing"),
                                                                       "kind: " + kind)) +
                      " --path " + plugins);
  };
  const auto plugin = run("my_clearing"), built_in = run("clearing");
  ASSERT_FALSE(plugin.contains("failed")) << plugin["failed"];
  ASSERT_FALSE(built_in.contains("failed")) << built_in["failed"];
  EXPECT_EQ(plugin["success"], true);
  EXPECT_EQ(plugin["state_hash"], built_in["state_hash"]);
}

TEST(Teams, PredatorsCatchAPreyThatFlees) {
  const auto s = summary_of("scenarios/predator_prey.yaml");
  ASSERT_FALSE(s.contains("failed")) << s["failed"];
  EXPECT_EQ(s["success"], true);
  EXPECT_EQ(s["criterion"], s["end_time"]);
}

TEST(Teams, TheBeamArrivesByBidsAndByOneProgram) {
  for (const char* const control : {"bids", "central"}) {
    const auto s = summary_of(std::string("scenarios/transport.yaml --set control=") + control);
    ASSERT_FALSE(s.contains("failed")) << s["failed"];
    EXPECT_EQ(s["success"], true) << control;
  }
}

TEST(Teams, OneRobotAloneCannotMoveTheBeam) {
  const auto s = summary_of(
      "scenarios/transport.yaml --duration 20s --set 'robots.hauler.count=1' --set 'vars.own={bids: {kind: "
      "carrier, load: beam, "
      "destination: [1.8, 0], posts: [0.25], radio: radio}}' --stop-when 'abs(beam.pose.x + 0.8) > 2 cm'");
  ASSERT_FALSE(s.contains("failed")) << s["failed"];
  EXPECT_EQ(s["end_time"], 20.0);
}

TEST(Teams, ForagersBringSomeItemsHomeAndNoneIsEmpty) {
  const auto s = summary_of("scenarios/foraging.yaml --set items=4");
  ASSERT_FALSE(s.contains("failed")) << s["failed"];
  EXPECT_EQ(s["success"], true);
}

TEST(Teams, FootballersScoreOnBothSidesAndMoreWithKicks) {
  // Goals of red and blue over six seeds, with kicks and with pushing only.
  const auto goals = [](const std::string& more) {
    std::array<double, 2> sum{};
    for (int seed = 1; seed <= 6; ++seed) {
      const auto s = summary_of("scenarios/football.yaml --seed " + std::to_string(seed) + more);
      if (s.contains("failed")) {
        ADD_FAILURE() << s["failed"];
        continue;
      }
      EXPECT_EQ(s["criteria"].size(), 2u);
      sum[0] += s["criteria"]["red"]["value"].get<double>();
      sum[1] += s["criteria"]["blue"]["value"].get<double>();
    }
    return sum;
  };
  const auto kicked = goals(""), pushed = goals(" --set red_impulse=0 --set blue_impulse=0");
  EXPECT_GE(kicked[0], 6);
  EXPECT_GE(kicked[1], 6);
  EXPECT_GT(kicked[0] + kicked[1], 2 * (pushed[0] + pushed[1]));
}

TEST(Teams, ADamagedCarrierLeavesItsPlaceToOneThatStandsBy) {
  // hauler2 and hauler4 push, 2.6 m in all; below 15 % of health a robot takes no role.
  for (const char* const control : {"bids", "central"}) {
    const auto s = summary_of(std::string("scenarios/transport.yaml --set control=") + control +
                              " --command 'at 10s set hauler4.health 14'");
    ASSERT_FALSE(s.contains("failed")) << s["failed"];
    EXPECT_EQ(s["success"], true) << control;
    double way_m = 0;
    for (const auto& robot : s["robots"])
      if (robot["name"] == "hauler1" || robot["name"] == "hauler3")
        way_m = std::max(way_m, robot["distance_m"].get<double>());
    EXPECT_GT(way_m, 1) << control;
  }
}

TEST(Reproduce, NamesWhatItDoesNotKnow) {
  const TestFolder scratch;
  const Printed wrong = sandlot("reproduce cooperatoin --out " + scratch.file("out"));
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.out, HasSubstr("there is no paper 'cooperatoin'; did you mean 'cooperation'?"));
  EXPECT_EQ(sandlot("reproduce cooperation --repeat 0 --out " + scratch.file("out")).exit_code, 2);
  EXPECT_EQ(sandlot("reproduce cooperation --out /dev/null/out").exit_code, 2);
  EXPECT_EQ(sandlot("reproduce cooperation").exit_code, 2);
  EXPECT_EQ(sandlot("reproduce msl --repeat 2 --out " + scratch.file("out")).exit_code, 2);
  EXPECT_EQ(
      sandlot("reproduce cooperation --traces tests/clock/pile.csv --out " + scratch.file("out")).exit_code,
      2);
  EXPECT_EQ(sandlot("reproduce eyesim --repeat 0 --out " + scratch.file("out")).exit_code, 2);
  EXPECT_EQ(sandlot("reproduce eyesim --traces tests/clock/pile.csv --out " + scratch.file("out")).exit_code,
            2);
  const Printed trace = sandlot("reproduce msl --traces scenarios/pile.yaml --out " + scratch.file("out"));
  EXPECT_EQ(trace.exit_code, 2);
  EXPECT_THAT(trace.out, HasSubstr("scenarios/pile.yaml:2: these are not step times"));
}

TEST(Reproduce, MslIsOnePageOfRecordedStepTimes) {
  const TestFolder scratch;
  const Printed made = sandlot(
      "reproduce msl --traces tests/clock/pile.csv tests/clock/field_images.csv --out " +
      scratch.file("out"));
  ASSERT_EQ(made.exit_code, 0) << made.out;
  const std::string html = read_file(scratch.file("out/index.html"));
  for (const char* const text : {"Figure 4", "field_images", "our clock", "the paper", "&lt; 2 %", "<svg"})
    EXPECT_THAT(html, HasSubstr(text));
  for (const char* const text : {"src=\"http", "href=\"http", "<script", "<link"})
    EXPECT_THAT(html, Not(HasSubstr(text)));
  EXPECT_THAT(read_file(scratch.file("out/timers.csv")), HasSubstr("trace,timers,estimate,10 ms"));
  EXPECT_THAT(read_file(scratch.file("out/speed_pile.svg")), HasSubstr("<svg"));
}

TEST(Output, StepTimesAreWrittenAndChangeNothing) {
  const TestFolder scratch;
  const std::string run = "run scenarios/indoor.yaml --set physics=planar --duration 0.2s --json";
  const Printed with = sandlot(run + " --step-times " + scratch.file("t.csv"));
  ASSERT_EQ(with.exit_code, 0) << with.out;
  EXPECT_EQ(nlohmann::json::parse(with.out)["state_hash"],
            nlohmann::json::parse(sandlot(run).out)["state_hash"]);
  const std::string text = read_file(scratch.file("t.csv"));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3 + 20);
  const Printed missing = sandlot(run + " --step-times " + scratch.file("missing/t.csv"));
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.out, HasSubstr("missing/t.csv"));
  EXPECT_EQ(sandlot(run + " --repeat 2 --step-times " + scratch.file("t.csv")).exit_code, 2);
}

TEST(LongReproduce, MslQuickShowsModelsAndWhatVisionFinds) {
  const TestFolder scratch;
  const Printed made = sandlot("reproduce msl --quick --out " + scratch.file("out"));
  ASSERT_EQ(made.exit_code, 0) << made.out;
  const std::string html = read_file(scratch.file("out/index.html"));
  for (const char* const text :
       {"Figure 1", "Figure 2 (a)", "Figure 2 (b)", "Figure 3", "Figure 4", "Figure 5", "--quick leaves out",
        ">inside<", "25 control steps a second", "20 scans a second", "Said in the paper, not shown here"})
    EXPECT_THAT(html, HasSubstr(text));
  EXPECT_THAT(html, Not(HasSubstr(">outside<")));
  EXPECT_FALSE(fs::exists(scratch.file("out/levels.csv")));
  // The ball lies 4.6 m ahead and 0.6 m to the right of the looking robot, which has hardly moved: hypot(4.6, 0.6) = 4.64 m. Both of its
  // cameras see it; a pixel of the omni-camera is some tenths of a metre there.
  std::istringstream csv(read_file(scratch.file("out/vision.csv")));
  std::string line;
  int balls = 0;
  while (std::getline(csv, line)) {
    if (line.find(",ball,ball,") == std::string::npos) continue;
    ++balls;
    double bearing = 0, true_bearing = 0, range = 0, true_range = 0;
    ASSERT_EQ(std::sscanf(line.substr(line.find(",ball,ball,") + 11).c_str(), "%lf,%lf,%lf,%lf", &bearing,
                          &true_bearing, &range, &true_range),
              4)
        << line;
    EXPECT_NEAR(true_range, 4.64, 0.1);
    EXPECT_NEAR(range, true_range, 0.15 * true_range) << line;
    EXPECT_NEAR(bearing, true_bearing, 2) << line;
  }
  EXPECT_EQ(balls, 2);
  EXPECT_THAT(read_file(scratch.file("out/ramp.csv")), HasSubstr("gains_p/left_motor.target"));
}

TEST(LongReproduce, CooperationIsOnePageWithoutANetwork) {
  const TestFolder scratch;
  const Printed made = sandlot("reproduce cooperation --repeat 2 --out " + scratch.file("out"));
  ASSERT_EQ(made.exit_code, 0) << made.out;
  const std::string html = read_file(scratch.file("out/index.html"));
  for (const char* const text :
       {"rigid, disturber, no radio", "lead / hide", "bids by radio", "the paper", "<svg",
        "energy drawn by pusher1 [J]", "Figures of the paper that are not shown"})
    EXPECT_THAT(html, HasSubstr(text));
  for (const char* const text : {"src=\"http", "href=\"http", "<script", "<link", "drawing.svg"})
    EXPECT_THAT(html, Not(HasSubstr(text)));
  for (const char* const file : {"clearing.csv", "predator_prey.csv", "transport.csv"})
    EXPECT_THAT(read_file(scratch.file(std::string("out/") + file)),
                HasSubstr("condition,seed,criterion,success"));
  EXPECT_FALSE(fs::exists(scratch.file("out/drawing.svg")));
}

}  // namespace
}  // namespace sandlot::test
