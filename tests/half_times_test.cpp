/// Whole half-times of scenarios/match.yaml: the referee restarts every ball, in time.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "command.h"

namespace sandlot::test {
namespace {

// The referee's times (soccer/rules.h), and half a second for what ends with the next message.
constexpr double stop_s = 2, prepare_s = 10, prepare_kickoff_s = 20, take_s = 7, penalty_s = 10,
                 slack_s = 0.5;
constexpr int retakes = 2;

struct Decision {
  double t_s = 0;
  std::string rule, command;
};

std::vector<Decision> decisions_of(const std::string& recording) {
  const Printed printed = sandlot("topic echo " + recording + " /rules/referee/decision --json");
  EXPECT_EQ(printed.exit_code, 0) << printed.out;
  std::vector<Decision> decisions;
  std::istringstream lines(printed.out);
  for (std::string line; std::getline(lines, line);) {
    const auto each = nlohmann::json::parse(line, nullptr, false);
    if (!each.is_object()) continue;
    const auto& message = each.contains("message") ? each["message"] : each;
    const auto& stamp = message["header"]["stamp"];
    decisions.push_back({stamp["sec"].get<double>() + 1e-9 * stamp["nanosec"].get<double>(), message["rule"],
                         message["command"]});
  }
  return decisions;
}

/// Looks at each break of play: from the decision that stops it to the ball in play again.
void expect_restarts_in_time(const std::vector<Decision>& decisions, double end_s) {
  const std::set<std::string> aside{"cleared",  "yellow_card", "red_card", "repair",    "back", "ball_moved",
                                    "distance", "begin",       "in_play",  "not_taken", "start"};
  enum { playing, stopped, started } phase = stopped;
  double since_s = 0;
  int repeated = 0;
  std::string piece = "KICKOFF";
  // After a goal there is a kick-off.
  const auto prepared_s = [&] {
    return piece == "KICKOFF" || piece == "GOAL" ? prepare_kickoff_s : prepare_s;
  };
  for (const Decision& each : decisions) {
    const double t = each.t_s - since_s;
    SCOPED_TRACE(each.rule + " at " + std::to_string(each.t_s) + " s");
    if (each.rule == "start") {
      EXPECT_EQ(phase, stopped);
      EXPECT_LE(t, stop_s + prepared_s() + slack_s) << "the set piece is not started in time";
      phase = piece == "DROP_BALL" ? playing : started;
      since_s = each.t_s;
    } else if (each.rule == "in_play" || each.rule == "not_taken") {
      EXPECT_LE(t, (piece == "PENALTY" ? penalty_s : take_s) + slack_s)
          << "the set piece is not taken in time";
      phase = each.rule == "not_taken" && piece == "PENALTY" ? stopped : playing;
      if (phase == stopped) piece = each.command;
      since_s = each.t_s;
      repeated = 0;
    } else if (each.rule == "distance" || (each.rule == "ball_moved" && !each.command.empty())) {
      EXPECT_LE(++repeated, 2 * (retakes + 1)) << "the set piece is repeated for ever";
      phase = stopped;
      since_s = each.t_s;
    } else if (!aside.contains(each.rule)) {
      phase = stopped;
      since_s = each.t_s;
      piece = each.command;
    }
  }
  if (phase == stopped) { EXPECT_LE(end_s - since_s, stop_s + prepared_s() + slack_s); }
  if (phase == started) { EXPECT_LE(end_s - since_s, penalty_s + slack_s); }
}

/// Three; SANDLOT_HALF_TIMES=100 plays a hundred, from the seed SANDLOT_FIRST_SEED on.
TEST(SlowHalfTimes, EveryBallIsRestartedInRuleTimeAndNothingIsNotANumber) {
  const char* const given = std::getenv("SANDLOT_HALF_TIMES");
  const char* const from = std::getenv("SANDLOT_FIRST_SEED");
  const int count = given ? std::max(1, std::atoi(given)) : 3, first = from ? std::atoi(from) : 1;
  int goals = 0, breaks = 0;
  for (int seed = first; seed < first + count; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TestFolder scratch;
    const std::string recording = scratch.file("half.mcap"), summary = scratch.file("s.json");
    const Printed run = sandlot("run scenarios/match.yaml --headless --set half=900 --duration 900s --seed " +
                                std::to_string(seed) + " --record " + recording +
                                " --record-topics /rules/referee/decision --summary " + summary);
    ASSERT_EQ(run.exit_code, 0) << run.out;
    const auto decisions = decisions_of(recording);
    ASSERT_GT(decisions.size(), 100u) << "hardly anything happened";
    expect_restarts_in_time(decisions, 900);
    for (const Decision& each : decisions) {
      goals += each.command == "GOAL";
      breaks += each.rule == "start";
    }
  }
  std::printf("%d half-times: %d goals, %d set pieces\n", count, goals, breaks);
}

/// teams/mixed: robots 2 to 4 stand on other chassis than the scenario's, and one software drives all of them. A robot that hears no referee
/// and sees no ball stands, or turns on its spot; one that plays goes several metres to the kick-off and after it.
TEST(Match, ATeamMayHaveRobotsOfSeveralKinds) {
  for (const std::string drive : {"ideal", "contact", "roller"}) {
    const TestFolder scratch;
    const std::string log = scratch.file("way.csv");
    const Printed run = sandlot(
        "run scenarios/match.yaml --headless --duration 10s --set cyan=../teams/mixed --set drive=" + drive +
        " --log " + log +
        " --log-values 'cyan2.pose.x,cyan2.pose.y,cyan3.pose.x,cyan3.pose.y,cyan4.pose.x,cyan4.pose.y'");
    ASSERT_EQ(run.exit_code, 0) << run.out;
    std::ifstream rows(log);
    std::string row;
    std::getline(rows, row);
    std::array<double, 7> before{}, now{};
    std::array<double, 3> way_m{};
    for (bool begun = false; std::getline(rows, row); begun = true) {
      before = now;
      std::istringstream cells(row);
      for (double& value : now) cells >> value, cells.ignore();
      for (std::size_t robot = 0; begun && robot < way_m.size(); ++robot)
        way_m[robot] += std::hypot(now[1 + 2 * robot] - before[1 + 2 * robot],
                                   now[2 + 2 * robot] - before[2 + 2 * robot]);
    }
    for (std::size_t robot = 0; robot < way_m.size(); ++robot)
      EXPECT_GT(way_m[robot], 1.5) << "cyan" << robot + 2 << " at drive=" << drive << " stands still";
  }
}

TEST(Match, IsTheSameForAnyNumberOfThreads) {
  const std::string match = "scenarios/match.yaml --duration 14s --threads ";
  const auto one = summary_of(match + "1");
  ASSERT_FALSE(one.contains("failed")) << one["failed"];
  for (const char* const threads : {"2", "4"})
    EXPECT_EQ(summary_of(match + threads)["state_hash"], one["state_hash"]) << threads;
}

}  // namespace
}  // namespace sandlot::test
