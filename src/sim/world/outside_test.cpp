/// Programs that run outside this process, in a world: their answers are input that is logged, and the log alone repeats the
/// run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cerrno>
#include <fstream>

#include "base/test_folder.h"
#include "sim/session/session.h"
#include "sim/test_input.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

/// Drives forward at a speed that grows with the number of its observations; writes a line per start.
constexpr const char* brain = R"(
import json, sys, os
open(sys.argv[1], 'a').write(str(os.getpid()) + '\n')
sys.stdin.readline()
n = 0
for line in sys.stdin:
    observation = json.loads(line)
    n += 1
    orders = {'drive': {'linear': {'x': 0.01 * n}, 'angular': {'z': 0.1}}}
    print(json.dumps({'orders': orders, 'wait': None}), flush=True)
)";

model::Setup with_brain(const TestFolder& folder,
                        const std::vector<std::pair<const char*, const char*>>& more = {}) {
  model::Setup setup = arena("planar", 1, "");
  Node config = Node::map();
  Node& command = config.set("command", Node::sequence());
  for (const std::string& word :
       {std::string("python3"), folder.write("brain.py", brain), folder.file("starts")})
    command.push(Node::scalar(word));
  config.set("deadline", Node::scalar("20 s"));
  for (const auto& [key, text] : more) config.set(key, Node::scalar(text));
  setup.instances.back().controllers.push_back({"brain", "pipe", config, {}});
  return setup;
}

std::vector<int> starts(const TestFolder& folder) {
  std::ifstream in(folder.file("starts"));
  std::vector<int> out;
  for (int process = 0; in >> process;) out.push_back(process);
  return out;
}

TEST(OutsideProgram, TheLogAloneRepeatsTheRun) {
  const TestFolder folder;
  const auto live = build(with_brain(folder), {.start_programs = true});
  ASSERT_TRUE(live);
  InputLog log;
  live->add_observer(&log);
  advance(*live, 33);
  const auto half = live->snapshot();
  advance(*live, 67);
  // Control steps at ticks 0, 5, ... 100; the answer to that of tick 100 acts in the next tick.
  EXPECT_EQ(value(*live, "rover1/brain.answers"), 20);
  EXPECT_EQ(value(*live, "rover1/brain.misses"), 0);
  EXPECT_NEAR(value(*live, "rover1/drive/ideal/command.linear.x"), 0.2, 1e-12);
  EXPECT_EQ(log.input[1].front().kind, Request(AnswerRequest{}).index());
  ASSERT_EQ(starts(folder).size(), 1u);
  for (const int threads : {1, 2, 4}) {
    const auto rest = [&] {
      Diagnostics diagnostics;
      return std::move(*Simulation::restore(half, {.threads = threads}, diagnostics));
    }();
    for (std::uint64_t tick = 34; tick <= 100; ++tick) {
      feed(*rest, log.input[tick]);
      advance(*rest, 1);
      ASSERT_EQ(rest->state_hash(), log.hash[tick]) << tick << ", " << threads << " threads";
    }
  }
  EXPECT_EQ(starts(folder).size(), 1u);  // nobody started it again
  live->remove_observer(&log);
}

TEST(OutsideProgram, TheProcessEndsWithTheWorld) {
  const TestFolder folder;
  int process = 0;
  {
    const auto live = build(with_brain(folder), {.start_programs = true});
    ASSERT_TRUE(live);
    process = starts(folder).at(0);
    EXPECT_EQ(kill(process, 0), 0);
  }
  EXPECT_EQ(kill(process, 0), -1);
  EXPECT_EQ(errno, ESRCH);
}

TEST(OutsideProgram, IsNotStartedUnlessTheRunMay) {
  const TestFolder folder;
  const auto quiet = build(with_brain(folder));
  ASSERT_TRUE(quiet);
  quiet->connect_programs();
  advance(*quiet, 20);
  EXPECT_TRUE(starts(folder).empty());
  EXPECT_EQ(value(*quiet, "rover1/brain.answers"), 0);
  // Nor does a request start one.
  model::Instance another = quiet->entities().back()->instance;
  another.name = "another";
  quiet->submit(SpawnRequest{another});
  advance(*quiet, 1);
  ASSERT_FALSE(quiet->outcomes().front().status);
  EXPECT_THAT(quiet->outcomes().front().status.error().text(), HasSubstr("it cannot be spawned"));
}

TEST(OutsideProgram, AMissIsLoggedAndActsAsItsKindSays) {
  const TestFolder folder;
  model::Setup setup = with_brain(folder, {{"deadline", "300 ms"}, {"on_miss", "end"}});
  Node& command = *setup.instances.back().controllers.edit().front().config.find("command");
  command = Node::sequence();
  for (const char* word : {"sh", "-c", "read d; read a; echo '{}'; read b; sleep 1000"})
    command.push(Node::scalar(word));
  const auto live = build(setup, {.start_programs = true});
  ASSERT_TRUE(live);
  InputLog log;
  live->add_observer(&log);
  Status status;
  int ticks = 0;
  while (status && ticks < 20) status = live->tick(), ++ticks;
  ASSERT_FALSE(status);
  EXPECT_EQ(ticks, 6);  // asked at tick 5, missed, so the run ends where that is known
  EXPECT_EQ(status.error().what,
            "program 'rover1/brain' (pipe) failed at 0.05 s: the process sent no answer within 0.3 s");
  live->remove_observer(&log);
}

TEST(OutsideProgram, WaitsForTimesAndMessages) {
  const TestFolder folder;
  model::Setup setup = with_brain(folder);
  Node& command = *setup.instances.back().controllers.edit().front().config.find("command");
  command = Node::sequence();
  // Answers 0.12 s, then a message of the ground truth (20 Hz), and then ends.
  for (const char* word :
       {"sh", "-c",
        "read d; read a; echo '{\"wait\": 0.12}'; read b; echo '{\"wait\": \"truth\"}'; read c; echo '{}'"})
    command.push(Node::scalar(word));
  const auto live = build(setup, {.start_programs = true});
  ASSERT_TRUE(live);
  std::vector<std::uint64_t> stepped;
  double steps = value(*live, "rover1/brain.steps");
  EXPECT_EQ(steps, 1);
  std::vector<std::byte> half;
  for (int tick = 1; tick <= 20; ++tick) {
    advance(*live, 1);
    if (tick == 8) half = live->snapshot();
    if (value(*live, "rover1/brain.steps") > steps) stepped.push_back(live->tick_index());
    steps = value(*live, "rover1/brain.steps");
    if (stepped.size() == 2) break;
  }
  // At 0.12 s, and with the sample of 0.15 s. What it waits for is State.
  EXPECT_EQ(stepped, (std::vector<std::uint64_t>{12, 15}));
  Diagnostics diagnostics;
  const auto rest = Simulation::restore(half, {}, diagnostics);
  ASSERT_TRUE(rest);
  advance(**rest, 3);
  EXPECT_EQ(value(**rest, "rover1/brain.steps"), 1);
  advance(**rest, 1);
  EXPECT_EQ(value(**rest, "rover1/brain.steps"), 2);
}

/// A rewound run repeats the answers up to where it was, and starts the process again there.
TEST(OutsideProgram, ARewoundRunRepeatsTheAnswersAndThenGoesOn) {
  const TestFolder folder;
  InputLog log;
  Session session(build(with_brain(folder), {.start_programs = true}),
                  {.history_every_s = 0.2, .simulation = {.start_programs = true}});
  session.add_observer(&log);
  RunReport report;
  std::map<std::uint64_t, std::uint64_t> first;
  bool back = false;
  const auto keep_going = [&](const Simulation& simulation) {
    if (!back && simulation.tick_index() >= 80) {
      back = true;
      first = log.hash;
      EXPECT_TRUE(session.jump(Time::from_s(0.5)));
    }
    return !back || simulation.tick_index() < 120 || session.epoch() == 1;
  };
  EXPECT_TRUE(session.run(report, keep_going));
  // Up to the target the run is the same; then another process goes on.
  for (std::uint64_t tick = 1; tick <= 50; ++tick) EXPECT_EQ(log.hash[tick], first[tick]) << tick;
  EXPECT_EQ(starts(folder).size(), 2u);
  EXPECT_GT(value(session.simulation(), "rover1/brain.answers"), 20);
}

/// Left between a question and its answer, at tick 0 and in the middle, a run goes on as the one that was not left.
TEST(OutsideProgram, WhatWasNotAnsweredIsAskedAgain) {
  const TestFolder folder;
  model::Setup setup = with_brain(folder);
  folder.write("brain.py", R"(
import json, sys
sys.stdin.readline()
for line in sys.stdin:
    print(json.dumps({'orders': {'drive': {'linear': {'x': 0.1 + json.loads(line)['time']}}}}), flush=True)
)");
  const auto live = build(setup, {.start_programs = true});
  ASSERT_TRUE(live);
  std::map<int, std::vector<std::byte>> left;
  for (int tick = 0; tick < 60; ++tick) {
    if (tick == 0 || tick == 35 || tick == 36 || tick == 38) left[tick] = live->snapshot();
    advance(*live, 1);
  }
  for (const auto& [tick, snapshot] : left) {
    Diagnostics diagnostics;
    const auto rest = std::move(*Simulation::restore(snapshot, {.start_programs = true}, diagnostics));
    rest->connect_programs();
    advance(*rest, 60 - tick);
    EXPECT_EQ(rest->state_hash(), live->state_hash()) << "left at tick " << tick;
    EXPECT_EQ(value(*rest, "rover1/brain.misses"), 0);
  }
}

/// A program in a shell of its own, with what it is to read and say.
model::Setup with_shell(const TestFolder& folder, const std::string& script,
                        const std::vector<std::pair<const char*, const char*>>& more = {}) {
  model::Setup setup = with_brain(folder, more);
  Node& command = *setup.instances.back().controllers.edit().front().config.find("command");
  command = Node::sequence();
  for (const std::string& word : {std::string("sh"), std::string("-c"), script})
    command.push(Node::scalar(word));
  return setup;
}

/// Control steps that fall into the time for which it waits are left out: they are not made up for.
TEST(OutsideProgram, WithARateOfItsOwnStepsNextWhenThatIsDueAgain) {
  const TestFolder folder;
  const auto live = build(
      with_shell(folder, "read d; read a; echo '{\"wait\": 0.25}'; while read a; do echo '{}'; done",
                 {{"rate", "10"}}),
      {.start_programs = true});
  ASSERT_TRUE(live);
  std::vector<std::uint64_t> stepped;
  for (double before = 1; live->tick_index() < 45;) {
    advance(*live, 1);
    const double steps = value(*live, "rover1/brain.steps");
    if (steps > before) stepped.push_back(live->tick_index());
    before = steps;
  }
  EXPECT_EQ(stepped, (std::vector<std::uint64_t>{25, 30, 40}));
}

TEST(OutsideProgram, ThatHasEndedStaysSoInARestoredRunAndTakesNoAnswers) {
  const TestFolder folder;
  const auto live = build(with_shell(folder, "read d; read a"), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 7);
  EXPECT_EQ(value(*live, "rover1/brain.steps"), 1);
  Diagnostics diagnostics;
  const auto rest = std::move(*Simulation::restore(live->snapshot(), {.start_programs = true}, diagnostics));
  rest->connect_programs();
  advance(*rest, 20);
  EXPECT_EQ(value(*rest, "rover1/brain.steps"), 1);
  auto& entry = const_cast<SimulationParts::ProgramEntry&>(*rest->entities().back()->programs.front());
  EXPECT_FALSE(entry.program->outside()->connected());
  rest->submit(AnswerRequest{"rover1/brain", {OutsideAnswer::Kind::missed, {}}});
  advance(*rest, 1);
  ASSERT_FALSE(rest->outcomes().front().status);
  EXPECT_EQ(rest->outcomes().front().status.error().what, "program 'rover1/brain' has ended");
}

TEST(OutsideProgram, ThatIsToBeDetachedIsNotStartedAgain) {
  const TestFolder folder;
  const auto live = build(with_brain(folder, {{"after_restore", "detach"}}), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 12);
  Diagnostics diagnostics;
  const auto rest = std::move(*Simulation::restore(live->snapshot(), {.start_programs = true}, diagnostics));
  rest->connect_programs();
  advance(*rest, 12);
  EXPECT_EQ(starts(folder).size(), 1u);
  EXPECT_EQ(value(*rest, "rover1/brain.answers"), value(*live, "rover1/brain.answers"));
}

TEST(OutsideProgram, AnswersOfSeveralAreInTheirOrder) {
  const TestFolder folder;
  model::Setup setup = with_shell(folder, "sleep 1000", {{"deadline", "1 ms"}});
  auto& programs = setup.instances.back().controllers.edit();
  for (const char* name : {"second", "third"}) {
    programs.push_back(programs.front());
    programs.back().name = name;
  }
  const auto live = build(setup, {.start_programs = true});
  ASSERT_TRUE(live);
  InputLog log;
  live->add_observer(&log);
  advance(*live, 1);
  std::vector<std::string> order;
  for (const LogEntry& entry : log.input[1])
    if (entry.kind == Request(AnswerRequest{}).index()) order.push_back(entry.target);
  EXPECT_EQ(order, (std::vector<std::string>{"rover1/brain", "rover1/second", "rover1/third"}));
  live->remove_observer(&log);
}

TEST(OutsideProgram, ForgedStateIsRefused) {
  const TestFolder folder;
  const auto quiet = build(with_brain(folder));
  auto& entry = const_cast<SimulationParts::ProgramEntry&>(*quiet->entities().back()->programs.front());
  const auto loads = [&] {
    ByteWriter w;
    Programs::save(entry, w);
    ByteReader r(w.bytes());
    return Programs::load(entry, r, quiet->now());
  };
  EXPECT_TRUE(loads());
  entry.wait->waiting_for = Program::Waiting::message;
  entry.wait->reading = 1000;
  EXPECT_FALSE(loads());
  entry.wait->reading = 0;
  EXPECT_TRUE(loads());
  entry.wait->until = {-1};
  EXPECT_FALSE(loads());
}

}  // namespace
}  // namespace sandlot::test
