/// The same answer twice: for any number of threads, with and without observers, next to other robots, and over
/// snapshots.
#include <gtest/gtest.h>

#include "sim/test_world.h"

namespace sandlot::test {
namespace {

class OnBoth : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Engines, OnBoth, testing::Values("rigid", "planar"),
                         [](const auto& p) { return std::string(p.param); });

TEST_P(OnBoth, EveryTickHasOneHashForAnyNumberOfThreads) {
  std::vector<std::vector<std::uint64_t>> hashes;
  for (const int threads : {1, 2, 4}) {
    const auto simulation = build(arena(GetParam(), 10), {.threads = threads});
    ASSERT_TRUE(simulation);
    auto& mine = hashes.emplace_back();
    for (int i = 0; i < 200; ++i) {
      advance(*simulation, 1);
      mine.push_back(simulation->state_hash());
    }
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
  // The hash is not blind: it changes with every tick.
  for (std::size_t i = 1; i < hashes[0].size(); ++i) EXPECT_NE(hashes[0][i], hashes[0][i - 1]);
}

TEST_P(OnBoth, AnotherSeedGivesAnotherRun) {
  auto other = arena(GetParam(), 2);
  other.seed = 8;
  const auto a = build(arena(GetParam(), 2)), b = build(other);
  advance(*a, 100);
  advance(*b, 100);
  EXPECT_NE(a->state_hash(), b->state_hash());
}

struct Watcher : Observer {
  Wants wants() const override { return {.messages = true, .hash = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    kept.push_back(frame);  // a slow viewer holds on to all frames
  }
  std::vector<std::shared_ptr<const Frame>> kept;
};

TEST_P(OnBoth, ObserversDoNotChangeTheRun) {
  const auto alone = build(arena(GetParam(), 3)), watched = build(arena(GetParam(), 3));
  Watcher first, second;
  watched->add_observer(&first);
  watched->add_observer(&second);
  advance(*alone, 150);
  advance(*watched, 150);
  EXPECT_EQ(alone->state_hash(), watched->state_hash());
  ASSERT_EQ(first.kept.size(), 150u);
  EXPECT_EQ(first.kept.back()->hash, watched->state_hash());
  EXPECT_NE(first.kept[10]->instances.back().X_WM.p.x, first.kept[140]->instances.back().X_WM.p.x);
}

TEST_P(OnBoth, ARobotMoreChangesNothingForTheOthers) {
  const auto without = arena(GetParam(), 3);
  auto with = without;
  // Far outside the walls, where nothing touches it and no laser sees it; first in the list, so that every index
  // of the others shifts.
  with.instances.insert(with.instances.begin(), rover("stranger", rover_model(), {40, 30, 0}, 1.0));
  with.instances.push_back(placed("rock", one_shape("rock", Cylinder{0.3, 0.5}, 3), {{45, 30, 0.25}, {}}));
  const auto a = build(without), b = build(with);
  for (int i = 0; i < 30; ++i) {
    advance(*a, 10);
    advance(*b, 10);
    const auto of_b = by_path(*b);
    for (const auto& [path, hash] : by_path(*a))
      ASSERT_EQ(of_b.at(path), hash) << path << " at tick " << a->tick_index();
  }
}

TEST_P(OnBoth, ARestoredRunEndsInTheSameState) {
  const auto whole = build(arena(GetParam(), 4));
  advance(*whole, 150);
  auto restored = again(*whole, {.threads = 2});
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->state_hash(), whole->state_hash());
  for (int i = 0; i < 150; ++i) {
    advance(*whole, 1);
    advance(*restored, 1);
    ASSERT_EQ(restored->state_hash(), whole->state_hash()) << "at tick " << whole->tick_index();
  }
}

TEST_P(OnBoth, SpawningAndDeletingBetweenSnapshots) {
  const auto whole = build(arena(GetParam(), 4));
  advance(*whole, 50);
  whole->submit(DeleteRequest{"rover2"});
  whole->submit(SpawnRequest{rover("late", rover_model(), {2.8, 2.6, 0}, 2.0)});
  whole->submit(
      SpawnRequest{placed("crate3", one_shape("crate", Cylinder{0.2, 0.4}, 2), {{2.8, -2.6, 0.2}, {}})});
  advance(*whole, 50);
  for (const Outcome& outcome : whole->outcomes())
    EXPECT_TRUE(outcome.status) << outcome.status.error().text();
  EXPECT_FALSE(whole->find_instance("rover2"));
  EXPECT_TRUE(whole->find_instance("late"));
  whole->submit(DeleteRequest{"crate1"});
  advance(*whole, 20);
  auto restored = again(*whole);
  ASSERT_TRUE(restored);
  EXPECT_EQ(restored->revision(), whole->revision());
  whole->submit(SpawnRequest{rover("later", rover_model(), {0, 2.8, 0}, -1.0)});
  restored->submit(SpawnRequest{rover("later", rover_model(), {0, 2.8, 0}, -1.0)});
  for (int i = 0; i < 100; ++i) {
    advance(*whole, 1);
    advance(*restored, 1);
    ASSERT_EQ(restored->state_hash(), whole->state_hash()) << "at tick " << whole->tick_index();
  }
  // A snapshot of the restored run is the snapshot of the run.
  EXPECT_EQ(restored->snapshot(), whole->snapshot());
}

TEST(Snapshot, APileOf40BoxesWithEverySolver) {
  for (const char* const solver : {"direct", "quick", "auto"}) {
    model::Setup setup;
    setup.physics = map({{"solver", solver}});
    setup.step = Time::from_s(0.005);
    setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
    const auto box = one_shape("box", Box{{0.3, 0.3, 0.3}}, 1);
    for (int i = 0; i < 40; ++i)
      setup.instances.push_back(placed("box" + std::to_string(i), box,
                                       {{0.17 * (i % 4) + 0.01 * i, 0.16 * (i / 4 % 3), 0.2 + 0.25 * (i / 4)},
                                        quat_from_rpy(0.1 * i, 0.2 * i, 0.3 * i)}));
    const auto whole = build(setup);
    advance(*whole, 260);
    ASSERT_GT(whole->engine().contacts().size(), 40u) << "the pile should be in contact when it is saved";
    const auto restored = again(*whole);
    advance(*whole, 150);
    advance(*restored, 150);
    EXPECT_EQ(restored->state_hash(), whole->state_hash()) << solver;
  }
}

TEST(Snapshot, DamageIsAnErrorAndNoCrash) {
  const auto simulation = build(arena("planar", 1));
  advance(*simulation, 10);
  const auto good = simulation->snapshot();
  Diagnostics diagnostics;
  for (std::size_t cut = 0; cut < good.size(); cut += 1 + cut / 8)
    EXPECT_FALSE(Simulation::restore(std::span(good).first(cut), {}, diagnostics)) << "cut at " << cut;
  for (std::size_t at = 0; at < good.size(); at += 1 + good.size() / 200) {
    auto bad = good;
    bad[at] ^= std::byte{0x10};
    EXPECT_FALSE(Simulation::restore(bad, {}, diagnostics)) << "flipped at " << at;
  }
  const std::string foreign = "PNG or something else entirely, longer than a header";
  EXPECT_FALSE(Simulation::restore(std::as_bytes(std::span(foreign)), {}, diagnostics));
}

/// Commands as they were applied, and the bodies' hash of each tick.
struct CommandLog : Observer {
  Wants wants() const override { return {.log = true, .hash = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    log[frame->tick] = frame->log;
    for (std::size_t i = 0; i < frame->parts.size(); ++i) {
      const std::string& name = (*frame->part_names)[i];
      if (name == "rover1" || name == "rover2") bodies[frame->tick] ^= frame->parts[i];
    }
  }
  std::map<std::uint64_t, std::vector<LogEntry>> log;
  std::map<std::uint64_t, std::uint64_t> bodies;
};

TEST_P(OnBoth, TheCommandLogAloneDrivesTheBodiesTheSameWay) {
  CommandLog live, replayed;
  const auto original = build(arena(GetParam(), 2));
  original->add_observer(&live);
  advance(*original, 200);
  const auto replay = build(arena(GetParam(), 2), {.threads = 1, .run_programs = false});
  replay->add_observer(&replayed);
  for (std::uint64_t tick = 1; tick <= 200; ++tick) {
    for (const LogEntry& entry : live.log[tick])
      replay->submit(CommandRequest{entry.target, entry.type, entry.bytes}, entry.source);
    advance(*replay, 1);
  }
  ASSERT_FALSE(live.log.empty());
  EXPECT_EQ(live.bodies, replayed.bodies);
}

}  // namespace
}  // namespace sandlot::test
