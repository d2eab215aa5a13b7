#include <fstream>

#include "console/test_console.h"
#include "record/replay.h"
#include "sim/watch/values.h"

namespace sandlot {
namespace {

using test::has;

/// A run of 2 s that executes scheduled lines, on this thread.
struct Scripted {
  explicit Scripted(const std::vector<std::string>& lines = {}, model::Setup setup = test::arena("rigid", 2),
                    int ticks_before = 0) {
    setup.stop = Time::from_s(2);
    Session::Options options;
    options.tick = [this](Simulation& world, std::optional<Time> measured) -> Status {
      SL_TRY(console->before_tick());
      for (std::string& answer : console->take_answers()) answers.push_back(std::move(answer));
      return world.tick(measured);
    };
    auto world = test::build(std::move(setup));
    for (int tick = 0; tick < ticks_before; ++tick) EXPECT_TRUE(world->tick());
    session.emplace(std::move(world), std::move(options));
    console.emplace(*session, Console::Options{});
    for (const std::string& line : lines) {
      const Status scheduled = console->schedule(line);
      EXPECT_TRUE(scheduled) << scheduled.error().text();
    }
  }
  Status run() {
    RunReport report;
    Status status = session->run(report);
    if (Status last = console->finish(); status && !last) status = std::move(last);
    for (std::string& answer : console->take_answers()) answers.push_back(std::move(answer));
    return status;
  }
  double value(const std::string& address) {
    return NamedValue::find(session->simulation(), address)->read().value_or(-1);
  }
  std::optional<Session> session;
  std::optional<Console> console;
  std::vector<std::string> answers;
};

const std::vector<std::string> script{"set rover1/laser.noise.white 0",
                                      "at 0.5 s pose crate1 1 -1",
                                      "at 0.5s echo moved",
                                      "at 1s add box 2 -2 size=0.2",
                                      "at 1.2s pull crate1 link 0 0 0 1 -1 1",
                                      "at 1.5s remove box",
                                      "at 1 s command rover2/drive Twist {\"angular\": {\"z\": 1}}"};

TEST(Script, LinesAreExecutedInTheFirstTickThatBeginsThen) {
  Scripted run(script);
  ASSERT_TRUE(run.run());
  EXPECT_EQ(run.answers, (std::vector<std::string>{
                             "at 0 s: rover1/laser.noise.white = 0 m from tick 1",
                             "at 0.5 s: moved",
                             "at 0.5 s: crate1 at 1 -1 0.2 m, yaw 0 rad from tick 51",
                             "at 1 s: box (box) at 2 -2 0.1 m, yaw 0 rad from tick 101",
                             "at 1 s: rover2/drive got a geometry_msgs/msg/Twist from tick 101",
                             "at 1.2 s: crate1 pulled to 1 -1 1 m from tick 121",
                             "at 1.5 s: box removed from tick 151",
                         }));
  EXPECT_EQ(run.value("rover1/laser.noise.white"), 0);
}

TEST(Script, TheSameScriptGivesTheSameHashAndAnotherAnother) {
  const auto hash = [](const std::vector<std::string>& lines) {
    Scripted run(lines);
    EXPECT_TRUE(run.run());
    return run.session->simulation().state_hash();
  };
  const std::uint64_t first = hash(script);
  EXPECT_EQ(hash(script), first);
  std::vector<std::string> other = script;
  other[0] = "set rover1/laser.noise.white 0.02";
  EXPECT_NE(hash(other), first);
  EXPECT_NE(hash({}), first);
}

/// What a script did is in the log, so a replay needs no script.
TEST(Script, ASteeredRunIsReplayedFromItsLog) {
  struct Log : Observer {
    std::vector<record::RecordedTick> ticks;
    Wants wants() const override { return {.log = true, .hash = true}; }
    void on_frame(const std::shared_ptr<const Frame>& f) override {
      ticks.push_back({f->tick, f->now, f->log, f->hash, f->parts, f->part_names});
    }
  } log;
  Scripted run(script);
  const auto snapshot = run.session->simulation().snapshot();
  run.session->add_observer(&log);
  ASSERT_TRUE(run.run());
  run.session->remove_observer(&log);
  ASSERT_EQ(log.ticks.size(), 200u);
  Diagnostics diagnostics;
  auto replay = record::Replay::begin(snapshot, {}, diagnostics);
  ASSERT_TRUE(replay);
  for (const record::RecordedTick& tick : log.ticks) {
    const auto difference = replay->tick(tick);
    ASSERT_TRUE(difference) << difference.error().text();
    ASSERT_FALSE(*difference) << (*difference)->text();
  }
  EXPECT_EQ(replay->simulation().state_hash(), run.session->simulation().state_hash());
}

TEST(Script, AnErrorEndsTheRunAndSaysWhere) {
  // Both are found when their time comes: the first by the console, the second by the tick that refuses it.
  for (const char* line : {"at 1s remove box7", "at 1.99s remove crate[12]"}) {
    Scripted run({line, "at 1.99s remove crate1"});
    const Status status = run.run();
    ASSERT_FALSE(status) << line;
    EXPECT_TRUE(has(status.error().what, has(line, "box7") ? "at 1 s: there is nothing named 'box7'"
                                                           : "at 1.99 s: there is nothing named 'crate1'"))
        << status.error().text();
  }
}

TEST(Script, FaultsThatCanBeSeenAreFoundBeforeTheRun) {
  const test::TestFolder folder;
  Scripted run;
  const auto fault = [&](const std::string& text) {
    const std::string file = folder.file("script");
    std::ofstream(file) << text;
    const Status status = run.console->schedule_script(file);
    return status ? std::string("none") : status.error().text().substr(folder.path.string().size() + 1);
  };
  EXPECT_EQ(fault("# a script\n\nat 1s pause # now\nset rover1/laser.noise.white 1 cm\r\n"), "none");
  EXPECT_TRUE(
      has(fault("pause\nat 2s puase\n"), "script:2: there is no command 'puase'; did you mean 'pause'?"));
  EXPECT_TRUE(has(fault("at two seconds pause\n"), "script:1: 'at two seconds pause' is not of the form"));
  EXPECT_TRUE(has(fault("at 2s\n"), "script:1: "));
  EXPECT_TRUE(has(fault("set rover1/laser.noise.white 1 kg\n"), "unit 'kg' does not fit"));
  EXPECT_TRUE(has(fault("set rover1/laser.noise.white -1\n"), "script:1: "));
  EXPECT_TRUE(has(fault("pose crate1 1\n"), "script:1: a pose is X Y"));
  // May be there by then.
  EXPECT_EQ(fault("at 1s pose box 1 1\nat 1s set ann/laser.noise.white 1\nat 1s level ann/drive ideal\n"),
            "none");
  EXPECT_TRUE(has(run.console->schedule_script("no/such/file").error().text(), "cannot read the script"));
}

TEST(Script, AJumpBackSaysLinesAgainWhenTheirTimeComes) {
  Scripted straight(script);
  ASSERT_TRUE(straight.run());
  std::vector<std::string> with_jump = script;
  with_jump.emplace_back("at 1.75s jump 0.8 s");
  Scripted run(with_jump);
  ASSERT_TRUE(run.run());
  EXPECT_EQ(run.session->epoch(), 2u);
  const auto box = [](const std::string& answer) { return has(answer, "box removed"); };
  EXPECT_EQ(std::count_if(run.answers.begin(), run.answers.end(), box), 2);
  EXPECT_EQ(std::count(run.answers.begin(), run.answers.end(), "at 0.5 s: moved"), 1);
  EXPECT_EQ(run.session->simulation().state_hash(), straight.session->simulation().state_hash());
}

/// A run that goes on from a snapshot executes at once what was due before; so it does after a reset.
TEST(Script, AResetExecutesAgainWhatIsDueAtTheBeginning) {
  Scripted run({"echo first", "at 0.2s echo missed", "at 1s reset"}, test::arena("rigid", 1), 50);
  ASSERT_TRUE(run.run());
  EXPECT_EQ(run.session->epoch(), 2u);
  EXPECT_EQ(std::count(run.answers.begin(), run.answers.end(), "at 0.5 s: first"), 2);
  EXPECT_EQ(std::count(run.answers.begin(), run.answers.end(), "at 0.5 s: missed"), 2);
}

/// A line for a time that was over does not hold up others after a jump back.
TEST(Script, LinesStayInOrderAfterAJumpBack) {
  Scripted run({"at 0.2s at 0.25s echo mid", "at 0.3s at 0.1s echo late", "at 1s jump 0.15 s"});
  ASSERT_TRUE(run.run());
  EXPECT_EQ(run.session->epoch(), 2u);
  EXPECT_EQ(std::count(run.answers.begin(), run.answers.end(), "at 0.25 s: mid"), 2);
  EXPECT_EQ(std::count(run.answers.begin(), run.answers.end(), "at 0.3 s: late"), 2);
}

TEST(Script, AtSchedulesWhileTheRunGoesOn) {
  Scripted run({"at 0.5s at 1s set rover1/laser.noise.white 0.5", "at 0.6s at 1.2s remove nothing_there"});
  ASSERT_TRUE(run.run());  // the line was said in passing, so its error does not end the run
  EXPECT_EQ(run.value("rover1/laser.noise.white"), 0.5);
  EXPECT_TRUE(has(run.answers.back(), "at 1.2 s: error: there is nothing named 'nothing_there'"))
      << run.answers.back();
}

}  // namespace
}  // namespace sandlot
