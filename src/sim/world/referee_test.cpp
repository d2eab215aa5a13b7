/// The referee in whole worlds: each file of tests/referee provokes a rule or nearly does, and says which decisions follow.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/log.h"
#include "messages/command.h"
#include "messages/messages.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot::test::referee {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> files() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator("tests/referee")) out.push_back(entry.path().string());
  std::sort(out.begin(), out.end());
  return out;
}

/// What follows "# KEY: " in a line of a file.
std::string line_of(const std::string& file, const std::string& key) {
  std::ifstream in(file);
  const std::string begin = "# " + key + ": ";
  for (std::string line; std::getline(in, line);)
    if (line.starts_with(begin)) return line.substr(begin.size());
  return "";
}

/// Word of a person, with the time at which it comes.
struct TimedWord {
  double time_s = 0;
  msg::RefereeCommand command;
};

/// The line "# words: 1.5 BALL 3 1; 2 RED_CARD cyan 2" of a file: a number and a team are of robots, all else is the word.
std::vector<TimedWord> words_of(const std::string& file) {
  std::vector<TimedWord> out;
  std::istringstream all(line_of(file, "words"));
  for (std::string text; std::getline(all, text, ';');) {
    std::istringstream in(text);
    TimedWord word;
    in >> word.time_s >> word.command.command;
    if (word.command.command == "BALL") {
      std::string place;
      std::getline(in, place);
      word.command.command += place;
    } else {
      in >> word.command.team >> word.command.robot;
    }
    out.push_back(word);
  }
  return out;
}

void give_word(Simulation& simulation, const msg::RefereeCommand& command) {
  simulation.submit(CommandRequest{"rules/referee", msg::RefereeCommand::ros_type, command_bytes(command)});
}

std::unique_ptr<Simulation> open(const std::string& file, int threads = 1) {
  Diagnostics diagnostics;
  auto setup = load(file, {}, diagnostics);
  EXPECT_TRUE(setup) << setup.error().text();
  if (!setup) return nullptr;
  auto made = Simulation::create(std::move(*setup), {.threads = threads}, diagnostics);
  EXPECT_TRUE(made) << made.error().text();
  return made ? std::move(*made) : nullptr;
}

/// What a simulation decides until it stops: "goal cyan cyan2; ...".
struct Log {
  std::string text;
  std::uint64_t seen = 0;
  void look(const Simulation& simulation) {
    const auto* const topic = topic_cast<msg::RefereeDecision>(
        simulation.find_topic("/rules/referee/decision"));
    ASSERT_NE(topic, nullptr);
    if (topic->count == seen) return;
    seen = topic->count;
    const msg::RefereeDecision& made = topic->message;
    text += (text.empty() ? "" : "; ") + made.rule + (made.team.empty() ? "" : " " + made.team) +
            (made.robot.empty() ? "" : " " + made.robot);
  }
};

std::string run(Simulation& simulation, Log log = {}, std::vector<TimedWord> words = {}) {
  log.look(simulation);  // rules judge the beginning, too
  while (!simulation.stop_reason()) {
    for (; !words.empty() && words.front().time_s <= simulation.now().s(); words.erase(words.begin()))
      give_word(simulation, words.front().command);
    const Status status = simulation.tick();
    if (!status) return status.error().text();
    log.look(simulation);
  }
  return log.text;
}

TEST(RefereeFiles, DecideAsTheySay) {
  ASSERT_GT(files().size(), 30u);
  for (const std::string& file : files()) {
    const auto simulation = open(file);
    ASSERT_TRUE(simulation) << file;
    EXPECT_EQ(run(*simulation, {}, words_of(file)), line_of(file, "decisions")) << file;
  }
}

TEST(RefereeFiles, GoOnTheSameFromASnapshotInAnyNumberOfThreads) {
  for (const char* const file : {"tests/referee/goal.yaml", "tests/referee/pushing.yaml"}) {
    const auto whole = open(file);
    ASSERT_TRUE(whole);
    const std::string decisions = run(*whole);
    for (const int threads : {1, 2, 4}) {
      const auto first = open(file, threads);
      Log log;
      log.look(*first);
      for (int i = 0; i < 170; ++i) {
        ASSERT_TRUE(first->tick());
        log.look(*first);
      }
      Diagnostics diagnostics;
      auto second = Simulation::restore(first->snapshot(), {.threads = threads}, diagnostics);
      ASSERT_TRUE(second) << second.error().text();
      EXPECT_EQ((*second)->state_hash(), first->state_hash());
      EXPECT_EQ(run(**second, log), decisions) << file << ", " << threads << " threads";
      EXPECT_EQ((*second)->state_hash(), whole->state_hash()) << file << ", " << threads << " threads";
    }
  }
}

void say_word(Simulation& simulation, const std::string& word, const std::string& team = "", int robot = 0) {
  msg::RefereeCommand command;
  command.command = word;
  command.team = team;
  command.robot = robot;
  give_word(simulation, command);
}

TEST(RefereeRule, AWordOfAPersonReachesTheGameAndTheRobots) {
  const auto simulation = open("tests/referee/stuck_ball.yaml");
  ASSERT_TRUE(simulation);
  Log log;
  const auto step = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      ASSERT_TRUE(simulation->tick());
      log.look(*simulation);
    }
  };
  step(100);
  log.text.clear();
  say_word(*simulation, "STOP");
  say_word(*simulation, "RED_CARD", "cyan", 2);
  step(1);
  ASSERT_EQ(simulation->outcomes().size(), 2u);
  EXPECT_TRUE(simulation->outcomes()[0].status) << simulation->outcomes()[0].status.error().text();
  step(3);
  EXPECT_EQ(log.text, "person; red_card magenta cyan2");
  const auto* const word = topic_cast<msg::RefereeCommand>(
      simulation->find_topic("/magenta1/referee/command"));
  const auto* const state = topic_cast<msg::RefereeState>(simulation->find_topic("/magenta1/referee/state"));
  ASSERT_TRUE(word && state);
  EXPECT_EQ(word->message.command, "RED_CARD");
  EXPECT_EQ(word->message.team, "cyan");
  EXPECT_EQ(word->message.robot, 2);
  EXPECT_EQ(state->message.phase, "stopped");
  ASSERT_EQ(state->message.teams.size(), 2u);
  EXPECT_EQ(state->message.teams[0].red_cards, 1u);
  EXPECT_EQ(state->message.teams[0].robots, 1u);
  // Beside the field, and its drive has failed.
  const auto at = simulation->engine().pose(*simulation->find_instance("cyan2"));
  EXPECT_LT(at.p.y, -4);
  simulation->submit(CommandRequest{"cyan2/drive", msg::Twist::ros_type, command_bytes(msg::Twist{})});
  step(1);
  EXPECT_FALSE(simulation->outcomes().back().status);
}

TEST(RefereeRule, TakesNoWordsFromThoseWhoDriveARobot) {
  const auto simulation = open("tests/referee/stuck_ball.yaml");
  ASSERT_TRUE(simulation);
  msg::RefereeCommand goal;
  goal.command = "GOAL";
  goal.team = "cyan";
  simulation->submit(CommandRequest{"rules/referee", msg::RefereeCommand::ros_type, command_bytes(goal)},
                     Source{Source::Kind::robot, 1});
  ASSERT_TRUE(simulation->tick());
  // Requests from outside come before those of the rule.
  ASSERT_FALSE(simulation->outcomes().empty());
  EXPECT_EQ(simulation->outcomes()[0].source.kind, Source::Kind::robot);
  EXPECT_FALSE(simulation->outcomes()[0].status);
}

TEST(RefereeRule, WarnsOnceOfTwoRobotsWithOneNumber) {
  const auto warnings = [](const std::vector<std::string>& robots) {
    std::string text =
        "version: 1\nname: x\nphysics: planar\nrules: [{kind: referee}]\n"
        "things: [{name: ball, model: ../../models/msl_ball/model.sdf}]\nrobots:\n";
    for (std::size_t i = 0; i < robots.size(); ++i)
      text += "  - {name: " + robots[i] + ", team: cyan, model: {builder: msl_robot}, pose: [" +
              std::to_string(2 * i + 2) + ", 0, 0]}\n";
    Diagnostics diagnostics;
    auto setup = load("tests/referee/x.yaml", {.text = text}, diagnostics);
    EXPECT_TRUE(setup) << setup.error().text();
    std::vector<std::string> out;
    log::set_listener([&](log::Level level, std::string_view line) {
      if (level == log::Level::warning) out.emplace_back(line);
    });
    auto made = Simulation::create(std::move(*setup), {}, diagnostics);
    EXPECT_TRUE(made) << made.error().text();
    for (int i = 0; i < 3; ++i) EXPECT_TRUE((*made)->tick());
    log::set_listener({});
    return out;
  };
  EXPECT_TRUE(warnings({"cyan1", "cyan2", "ada"}).empty());
  const std::vector<std::string> twins = warnings({"cyan2", "ada", "bob"});
  ASSERT_EQ(twins.size(), 1u);
  EXPECT_NE(twins[0].find("'ada' and 'bob' of team 'cyan' have the same number, 0"), std::string::npos)
      << twins[0];
}

TEST(RefereeRule, KeysThatCannotBeAreNamed) {
  const auto refusal = [](const std::string& rule) {
    Diagnostics diagnostics;
    const std::string text =
        "version: 1\nname: x\nphysics: planar\nthings: [{name: ball, model: "
        "../../models/msl_ball/model.sdf}]\nrules:\n  - {kind: "
        "referee" +
        rule + "}\n";
    auto setup = load("tests/referee/x.yaml", {.text = text}, diagnostics);
    if (!setup) return setup.error().text();
    auto made = Simulation::create(std::move(*setup), {}, diagnostics);
    return made ? std::string("accepted") : made.error().text();
  };
  EXPECT_EQ(refusal(""), "accepted");
  EXPECT_NE(refusal(", half_length: 3").find("half_length"), std::string::npos)
      << refusal(", half_length: 3");
  EXPECT_NE(refusal(", ball: bal").find("did you mean 'ball'"), std::string::npos) << refusal(", ball: bal");
  EXPECT_NE(refusal(", teams: [a, a]").find("both teams"), std::string::npos);
  EXPECT_NE(refusal(", size: 30x20").find("22x14"), std::string::npos) << refusal(", size: 30x20");
  EXPECT_NE(refusal(", half: -1 s").find("half"), std::string::npos);
  EXPECT_NE(refusal(", half: -1 s").find("x.yaml:6"), std::string::npos) << refusal(", half: -1 s");
}

}  // namespace
}  // namespace sandlot::test::referee
