/// A recording fed to a Session: what came from outside comes again, and every tick has its recorded hash.
#include "record/input_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "base/test_folder.h"
#include "record/recorder.h"
#include "sim/test_world.h"

namespace sandlot::record {
namespace {

constexpr std::uint64_t ticks = 120, begin_tick = 10;

/// Two rovers from tick 10 to 130; before ticks 41 and 91 somebody puts the first one elsewhere.
struct Fixture {
  const test::TestFolder folder;
  std::unique_ptr<Simulation> original;

  Fixture() {
    original = test::build(test::arena("planar", 2));
    test::advance(*original, begin_tick);
    RecordOptions options;
    options.recording.file = file();
    options.recording.chunk_s = 0.25;
    auto recorder = Recorder::start(options, *original);
    EXPECT_TRUE(static_cast<bool>(recorder));
    original->add_observer(recorder->get());
    for (std::uint64_t i = 0; i < ticks; ++i) {
      if (i == 30 || i == 80)
        original->submit(PoseRequest{.name = "rover1", .X_WM = {{0.01 * static_cast<double>(i), 0.5, 0}, {}}},
                         {Source::Kind::admin, 3});
      EXPECT_TRUE(static_cast<bool>(original->tick()));
    }
    EXPECT_TRUE(static_cast<bool>((*recorder)->finish()));
    original->remove_observer(recorder->get());
  }
  std::string file() const { return folder.file("r.mcap"); }

  RecordedRun run() const {
    auto recording = Recording::open(file());
    EXPECT_TRUE(static_cast<bool>(recording));
    auto out = read_run(*recording);
    EXPECT_TRUE(static_cast<bool>(out));
    return std::move(*out);
  }
};

struct Played {
  std::uint64_t hash = 0, compared = 0, different = 0;
  std::vector<std::uint64_t> told;
};
Played play(const Fixture& fixture, const RecordedRun& run) {
  Played out;
  auto recording = Recording::open(fixture.file());
  Diagnostics diagnostics;
  auto simulation = Simulation::restore(recording->snapshot(), {}, diagnostics);
  EXPECT_TRUE(static_cast<bool>(simulation));
  RunCheck check(run, [&](std::uint64_t tick, Time) { out.told.push_back(tick); });
  Session session(std::move(*simulation), {.pace = {}, .input_log = run.input_log});
  session.add_observer(&check);
  RunReport report;
  EXPECT_TRUE(static_cast<bool>(session.run(report)));
  EXPECT_EQ(report.ticks, run.input_log.last_tick - run.first_tick);
  out.hash = session.simulation().state_hash();
  out.compared = check.compared();
  out.different = check.different();
  return out;
}

TEST(InputLog, HoldsWhatCameFromOutsideAtItsTickAndAHashForEveryTick) {
  const Fixture fixture;
  const RecordedRun run = fixture.run();
  EXPECT_EQ(run.first_tick, begin_tick);
  EXPECT_EQ(run.input_log.last_tick, begin_tick + ticks);
  EXPECT_EQ(run.input_log.end, fixture.original->now());
  EXPECT_FALSE(run.cut);
  // The 31st and the 81st tick behind the tenth; nothing of the controllers, which order something all the time.
  ASSERT_EQ(run.input_log.entries.size(), 2u);
  for (const std::uint64_t tick : {begin_tick + 31, begin_tick + 81}) {
    ASSERT_TRUE(run.input_log.entries.contains(tick)) << tick;
    ASSERT_EQ(run.input_log.entries.at(tick).size(), 1u);
    EXPECT_EQ(run.input_log.entries.at(tick).front().target, "rover1");
    EXPECT_EQ(run.input_log.entries.at(tick).front().source.id, 3u);
  }
  ASSERT_EQ(run.hashes.size(), ticks + 1);
  EXPECT_EQ(run.hashes.back(), fixture.original->state_hash());
}

TEST(InputLog, MakesASessionEndInTheRecordedStateWithEveryHashAsRecorded) {
  const Fixture fixture;
  const Played played = play(fixture, fixture.run());
  EXPECT_EQ(played.hash, fixture.original->state_hash());
  EXPECT_EQ(played.compared, ticks);
  EXPECT_EQ(played.different, 0u);
}

TEST(InputLog, TellsTheFirstTickThatDiffersOnce) {
  const Fixture fixture;
  RecordedRun run = fixture.run();
  // Without the second leap the run is another one from the tick on that carried it out: 81 to 120, forty ticks.
  run.input_log.entries.erase(begin_tick + 81);
  const Played played = play(fixture, run);
  EXPECT_THAT(played.told, testing::ElementsAre(begin_tick + 81));
  EXPECT_EQ(played.different, 40u);
  EXPECT_NE(played.hash, fixture.original->state_hash());
}

TEST(InputLog, EndsWhereARecordingIsTornOff) {
  const Fixture fixture;
  std::filesystem::resize_file(fixture.file(), std::filesystem::file_size(fixture.file()) / 2);
  const RecordedRun run = fixture.run();
  EXPECT_TRUE(run.cut);
  EXPECT_GT(run.input_log.last_tick, begin_tick);
  EXPECT_LT(run.input_log.last_tick, begin_tick + ticks);
  const Played played = play(fixture, run);
  EXPECT_EQ(played.different, 0u);
  EXPECT_EQ(played.compared, run.input_log.last_tick - begin_tick);
}

}  // namespace
}  // namespace sandlot::record
