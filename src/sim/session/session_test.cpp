#include "sim/session/session.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <thread>

#include "sim/test_world.h"

namespace sandlot::test {
namespace {

/// Snapshots fall due by simulated time alone, so that what a jump does depends on no wall clock.
constexpr double always = std::numeric_limits<double>::infinity();

/// A ball that rolls, 10 ms a tick.
model::Setup rolling(std::optional<double> stop_s = std::nullopt) {
  model::Setup setup;
  setup.engine = "rigid";
  if (stop_s) setup.stop = Time::from_s(*stop_s);
  setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
  setup.instances.push_back(placed("ball", one_shape("ball", Sphere{0.1}, 1, 0.5), {{0, 0, 1}, {}}));
  return setup;
}

std::uint64_t hash_after(model::Setup setup, std::uint64_t ticks) {
  const auto simulation = build(std::move(setup));
  for (std::uint64_t i = 0; i < ticks; ++i) EXPECT_TRUE(simulation->tick());
  return simulation->state_hash();
}

TEST(Session, EndsWhereTheRunEnds) {
  Session session(build(rolling(1)), {});
  RunReport report;
  ASSERT_TRUE(session.run(report));
  EXPECT_EQ(report.ticks, 100u);
  EXPECT_EQ(session.report().state, Session::State::ended);
  EXPECT_EQ(session.simulation().state_hash(), hash_after(rolling(1), 100));
}

/// By hand: 1 s at 10 x real time cannot take less than 0.1 s, but for the last tick, which need not be waited for. Whether
/// the run keeps up depends on the machine and is not tested.
TEST(Session, NeverRunsAheadOfItsClock) {
  Session session(build(rolling(1)), {.pace = {10.0}});
  RunReport report;
  ASSERT_TRUE(session.run(report));
  EXPECT_EQ(report.ticks, 100u);
  EXPECT_GE(report.wall_s, 0.1 - 0.001 - 1e-9);
  EXPECT_EQ(session.simulation().state_hash(), hash_after(rolling(1), 100)) << "the clock changes no result";
}

/// By hand: at real time a tick of 10 ms that takes 30 ms is late. After 1.2 s without a tick the clock is set again: the
/// next tick waits for it, where a run that caught up would do 120 ticks at once.
TEST(Session, CountsLateTicksAndDoesNotCatchUpWhenFarBehind) {
  using Clock = std::chrono::steady_clock;
  Session session(build(rolling(0.1)), {.pace = {1.0}});
  Clock::time_point behind;
  RunReport report;
  ASSERT_TRUE(session.run(report, [&](const Simulation& simulation) {
    if (simulation.tick_index() == 2) std::this_thread::sleep_for(std::chrono::milliseconds(30));
    if (simulation.tick_index() == 5) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1200));
      behind = Clock::now();
    }
    return true;
  }));
  EXPECT_EQ(report.ticks, 10u);
  EXPECT_GE(report.late_ticks, 2u);
  // One tick notices the delay, the next begins the clock, the last three wait for 10 ms each.
  EXPECT_GE(std::chrono::duration<double>(Clock::now() - behind).count(), 0.03 - 0.001);
}

TEST(Session, EndsWhenTheCallerSaysSo) {
  Session session(build(rolling()), {});
  RunReport report;
  ASSERT_TRUE(session.run(report, [](const Simulation& s) { return s.tick_index() < 30; }));
  EXPECT_EQ(report.ticks, 30u);
}

/// Records the length of each tick, and the lengths in its log.
struct Lengths : Observer {
  Wants wants() const override { return {.log = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    ticks.push_back(frame->step);
    for (const LogEntry& entry : frame->log) {
      if (entry.kind != LogEntry::step) continue;
      Time logged;
      ByteReader r(entry.bytes);
      read(r, logged.ns);
      logged_ticks.push_back(logged);
    }
  }
  std::vector<Time> ticks, logged_ticks;
};

TEST(Session, AContinuousClockTakesTheTimeThatTheLastTickTook) {
  model::Setup setup = rolling(0.3);
  setup.clock = {model::Clock::Mode::continuous, Time::from_s(1e-3), Time::from_s(0.03)};
  Session session(build(setup), {});
  Lengths lengths;
  session.add_observer(&lengths);
  RunReport report;
  // A cycle of at least 5 ms, now and then one of 50 ms: more than the longest tick.
  const auto slow = [](const Simulation& s) {
    std::this_thread::sleep_for(std::chrono::milliseconds(s.tick_index() % 8 == 5 ? 50 : 5));
    return true;
  };
  ASSERT_TRUE(session.run(report, slow));
  ASSERT_GE(lengths.ticks.size(), 7u);
  EXPECT_EQ(lengths.logged_ticks, lengths.ticks);
  EXPECT_EQ(lengths.ticks[0], setup.step) << "nothing has been measured yet";
  EXPECT_EQ(lengths.ticks[5], setup.clock.max_step);
  for (std::size_t i = 1; i < lengths.ticks.size(); ++i) {
    EXPECT_GE(lengths.ticks[i], Time::from_s(5e-3)) << i;
    EXPECT_LE(lengths.ticks[i], setup.clock.max_step) << i;
  }
  EXPECT_GE(report.late_ticks, 1u);
  EXPECT_LE(report.sim_s, report.wall_s + setup.step.s()) << "it never runs ahead of the wall clock";
  // The log alone gives the same run.
  const auto replay = build(setup);
  for (const Time length : lengths.logged_ticks) ASSERT_TRUE(replay->tick(length));
  EXPECT_EQ(replay->now(), session.simulation().now());
  EXPECT_EQ(replay->state_hash(), session.simulation().state_hash());
}

TEST(Session, AStepIsExactlyOneTickAndLeavesItPaused) {
  Session session(build(rolling()), {.paused = true});
  std::vector<std::uint64_t> seen;
  int idle = 0;
  const auto keep_going = [&](const Simulation& simulation) {
    if (seen.empty() || seen.back() != simulation.tick_index()) seen.push_back(simulation.tick_index());
    // Called when it has nothing to do, and after ticks: three naps prove that it stands still.
    if (session.report().state == Session::State::paused && ++idle % 3 == 0) {
      if (idle == 3) session.step();
      else if (idle == 6) session.step(5);
      else session.quit();
    }
    return true;
  };
  RunReport report;
  ASSERT_TRUE(session.run(report, keep_going));
  EXPECT_EQ(seen, (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(session.simulation().state_hash(), hash_after(rolling(), 6));
}

TEST(Session, StepsThatFollowAJumpAreTakenFromThere) {
  Session session(build(rolling()), {.paused = true});
  ASSERT_TRUE(session.jump(Time::from_s(0.5)));
  session.step(2);
  RunReport report;
  ASSERT_TRUE(session.run(report, [&](const Simulation&) {
    if (session.report().state == Session::State::paused) session.quit();
    return true;
  }));
  EXPECT_EQ(session.simulation().tick_index(), 52u);
}

TEST(Session, WhatWasAskedForWhilePausedHappensWithTheNextTickAndIsAnswered) {
  Session session(build(rolling()), {.paused = true});
  std::optional<std::string> answer, refusal;
  ASSERT_TRUE(session.submit(PoseRequest{"ball", {{3, 0, 0.1}, {}}}, {}, [&](const Status& status) {
    answer = status ? "done" : status.error().text();
  }));
  ASSERT_TRUE(session.submit(PoseRequest{"bell", {}}, {}, [&](const Status& status) {
    refusal = status ? "done" : status.error().text();
  }));
  int calls = 0;
  const auto keep_going = [&](const Simulation&) {
    if (++calls == 2) { EXPECT_FALSE(answer) << "before any tick"; }
    if (calls == 2) session.step();
    if (answer) session.quit();
    return true;
  };
  RunReport report;
  ASSERT_TRUE(session.run(report, keep_going));
  EXPECT_EQ(answer, "done");
  ASSERT_TRUE(refusal);
  EXPECT_NE(refusal->find("bell"), std::string::npos);
  EXPECT_NEAR(session.simulation().engine().pose(*session.simulation().find_instance("ball")).p.x, 3, 1e-6);
}

TEST(Session, AJumpBackGivesTheSameWorldToTheBitWithWhatCameFromOutside) {
  // Reference: the same requests at the same ticks, without any jump.
  const auto reference = build(rolling());
  std::vector<std::uint64_t> hashes;
  for (int tick = 0; tick < 400; ++tick) {
    if (tick == 150) reference->submit(PoseRequest{"ball", {{2, 0, 3}, {}}});
    if (tick == 210) reference->submit(PullRequest{"ball", "", {0, 0, 0.1}, {4, 1, 2}, Time::from_s(0.5)});
    ASSERT_TRUE(reference->tick());
    hashes.push_back(reference->state_hash());
  }
  Session session(build(rolling()), {.history_share = always});
  int jumps = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> stops;  // tick and hash where it came to rest
  std::vector<std::uint64_t> submitted;
  const auto keep_going = [&](const Simulation& simulation) {
    const std::uint64_t tick = simulation.tick_index();
    if (jumps == 0 && tick == 150) { EXPECT_TRUE(session.submit(PoseRequest{"ball", {{2, 0, 3}, {}}})); }
    if (jumps == 0 && tick == 210) {
      EXPECT_TRUE(session.submit(PullRequest{"ball", "", {0, 0, 0.1}, {4, 1, 2}, Time::from_s(0.5)}));
    }
    if (jumps == 0 && tick == 400) {
      session.pause();
      EXPECT_TRUE(session.jump(Time::from_s(2.3)));
      ++jumps;
    } else if (jumps > 0 && session.report().state == Session::State::paused &&
               session.report().epoch == static_cast<std::uint64_t>(jumps) + 1 && !session.report().target) {
      stops.emplace_back(tick, simulation.state_hash());
      // Back once more, to where a snapshot lies and nothing need be run again; then the end.
      if (jumps++ == 1) {
        EXPECT_TRUE(session.jump(Time::from_s(1)));
      } else {
        session.quit();
      }
    }
    return true;
  };
  RunReport report;
  ASSERT_TRUE(session.run(report, keep_going));
  ASSERT_EQ(stops.size(), 2u);
  EXPECT_EQ(stops[0], (std::pair<std::uint64_t, std::uint64_t>{230, hashes[229]}));
  EXPECT_EQ(stops[1], (std::pair<std::uint64_t, std::uint64_t>{100, hashes[99]}));
}

TEST(Session, WhatHappenedBehindAJumpIsForgotten) {
  Session session(build(rolling()), {});
  bool jumped = false;
  const auto keep_going = [&](const Simulation& simulation) {
    if (!jumped && simulation.tick_index() == 150) {
      EXPECT_TRUE(session.submit(PoseRequest{"ball", {{2, 0, 3}, {}}}));
    }
    if (!jumped && simulation.tick_index() == 200) {
      EXPECT_TRUE(session.jump(Time::from_s(1.2)));
      jumped = true;
    }
    return !(jumped && session.epoch() == 2 && simulation.tick_index() >= 300);
  };
  RunReport report;
  ASSERT_TRUE(session.run(report, keep_going));
  EXPECT_EQ(session.simulation().tick_index(), 300u);
  EXPECT_EQ(session.simulation().state_hash(), hash_after(rolling(), 300)) << "the pose of 1.5 s came back";
}

TEST(Session, ARunThatHasEndedWaitsForOrdersIfItShallStay) {
  Session session(build(rolling(0.5)), {.stay = true});
  std::uint64_t ended = 0;
  const auto keep_going = [&](const Simulation&) {
    if (session.report().state == Session::State::ended && session.report().epoch == 1 + ended) {
      EXPECT_EQ(session.report().reason, "simulated time reached 0.5 s");
      if (ended++ == 0) {
        EXPECT_TRUE(session.reset());
      } else {
        session.quit();
      }
    }
    return true;
  };
  RunReport report;
  ASSERT_TRUE(session.run(report, keep_going));
  EXPECT_EQ(report.ticks, 100u) << "50 before the reset and 50 after it";
}

TEST(Session, RunsAnInputLogAndTakesNothingElse) {
  InputLog log;
  const auto reference = build(rolling());
  struct Keep final : Observer {
    InputLog& input;
    explicit Keep(InputLog& to) : input(to) {}
    Wants wants() const override { return {.input = true}; }
    void on_frame(const std::shared_ptr<const Frame>& frame) override {
      if (!frame->log.empty()) input.entries[frame->tick] = frame->log;
    }
  } keep(log);
  const std::vector<std::byte> begin = reference->snapshot();
  reference->add_observer(&keep);
  for (int tick = 0; tick < 200; ++tick) {
    if (tick == 70) reference->submit(PoseRequest{"ball", {{2, 0, 3}, {}}});
    ASSERT_TRUE(reference->tick());
  }
  log.last_tick = 200;
  log.end = reference->now();
  Diagnostics diagnostics;
  auto world = Simulation::restore(begin, {}, diagnostics);
  ASSERT_TRUE(world);
  Session session(std::move(*world), {.input_log = log});
  EXPECT_FALSE(session.submit(PoseRequest{"ball", {}}));
  RunReport report;
  ASSERT_TRUE(session.run(report));
  EXPECT_EQ(session.simulation().tick_index(), 200u);
  EXPECT_EQ(session.simulation().state_hash(), reference->state_hash());
  EXPECT_EQ(session.report().reason, "the recording ends here");
}

TEST(Session, RefusesWhatCannotBe) {
  Session session(build(rolling(1)), {.paused = true, .may_not_rewind = "an experiment is in it"});
  EXPECT_EQ(session.reset().error().text(), "this run cannot be rewound: an experiment is in it");
  EXPECT_EQ(session.jump(Time::from_s(-1)).error().text(), "the run begins at 0 s");
  EXPECT_EQ(session.jump(Time::from_s(2)).error().text(), "the run ends at 1 s");
  EXPECT_TRUE(session.jump(Time::from_s(0.5)));
  EXPECT_FALSE(session.set_speed(0));
  EXPECT_FALSE(session.set_speed(1e9));
}

/// `history_mb` 0: nothing to go back to, but ahead it may run.
TEST(Session, JumpsAheadWithoutSnapshots) {
  Session session(build(rolling()), {.paused = true, .history_mb = 0});
  EXPECT_EQ(session.reset().error().text(), "this run cannot be rewound: no snapshots are kept");
  ASSERT_TRUE(session.jump(Time::from_s(0.5)));
  bool jumped = false;
  RunReport report;
  ASSERT_TRUE(session.run(report, [&](const Simulation& simulation) {
    jumped = jumped || simulation.tick_index() == 50;
    return !(jumped && session.report().state == Session::State::paused);
  }));
  EXPECT_EQ(session.simulation().tick_index(), 50u);
  EXPECT_EQ(session.epoch(), 1u);
}

/// A jump may become one back while it waits: the run went past its aim. The world of a run that may not be rewound stays.
TEST(Session, NeverReplacesAWorldThatMayNotBeRewound) {
  Session session(build(rolling(1)), {.may_not_rewind = "an experiment is in it"});
  const Simulation* const world = &session.simulation();
  RunReport report;
  ASSERT_TRUE(session.run(report, [&](const Simulation& simulation) {
    if (simulation.tick_index() == 50 && session.epoch() == 1) {
      session.post([&](Session& s) {
        EXPECT_TRUE(s.jump(Time::from_s(0.505)));
        EXPECT_TRUE(s.simulation().tick());
        EXPECT_TRUE(s.simulation().tick());
      });
    }
    return true;
  }));
  EXPECT_EQ(&session.simulation(), world);
  EXPECT_EQ(session.epoch(), 1u);
}

/// What is loaded may have another kind of clock. By hand: measured ticks have 5 ms at most, those of 10 ms are not measured.
TEST(Session, KeepsTimeByTheClockOfTheWorldThatIsThere) {
  model::Setup setup = rolling();
  setup.clock = {model::Clock::Mode::continuous, Time::from_s(0.001), Time::from_s(0.005)};
  Session session(build(rolling()), {.paused = true});
  session.load(build(std::move(setup))->snapshot(), {});
  session.play();
  RunReport report;
  ASSERT_TRUE(session.run(report, [&](const Simulation&) { return report.ticks < 20; }));
  EXPECT_LE(report.longest, Time::from_s(0.005));
}

/// Each load is answered, also one that another takes the place of, or that comes when all is over.
TEST(Session, AnswersEveryLoad) {
  const std::vector<std::byte> snapshot = build(rolling())->snapshot();
  Session session(build(rolling()), {.paused = true});
  std::vector<std::string> answers;
  const auto note = [&](const Status& status) { answers.push_back(status ? "done" : status.error().text()); };
  session.load(snapshot, note);
  session.load(snapshot, note);
  bool asked = false;
  RunReport report;
  ASSERT_TRUE(session.run(report, [&](const Simulation&) {
    if (answers.size() == 2 && !std::exchange(asked, true)) {
      session.quit();
      session.load(snapshot, note);
    }
    return true;
  }));
  session.load(snapshot, note);
  EXPECT_EQ(answers, (std::vector<std::string>{"another one was asked for meanwhile", "done",
                                               "the run has ended", "the run has ended"}));
}

/// On the way to where it was, the input is that of then: what comes while the world is changed is refused, too.
TEST(Session, TakesNoInputFromTheMomentItGoesBack) {
  const auto reference = build(rolling());
  for (int tick = 0; tick < 150; ++tick) ASSERT_TRUE(reference->tick());
  Session* running = nullptr;
  Status submitted;
  Session session(build(rolling()),
                  {.history_share = always, .on_world = [&](Simulation&, const std::string&) {
                     auto sequence = running->submit(PoseRequest{"ball", {{2, 0, 3}, {}}});
                     if (!sequence) submitted = sequence.error();
                   }});
  running = &session;
  bool jumped = false;
  std::uint64_t hash = 0;
  RunReport report;
  ASSERT_TRUE(session.run(report, [&](const Simulation& simulation) {
    if (!jumped && simulation.tick_index() == 200) {
      jumped = true;
      session.pause();  // a snapshot may lie at the target: then no tick leads there
      EXPECT_TRUE(session.jump(Time::from_s(1.5)));
    }
    if (session.epoch() == 2 && session.report().state == Session::State::paused && !session.report().target)
      hash = simulation.state_hash();
    return hash == 0;
  }));
  EXPECT_FALSE(submitted);
  EXPECT_EQ(hash, reference->state_hash());
}

TEST(Session, ForgetsSnapshotsInBetweenButNeverTheFirst) {
  // Memory for none: each third one makes them fewer.
  Session session(build(rolling()), {.history_mb = 1e-6, .history_every_s = 0.01, .history_share = always});
  std::size_t most = 0;
  bool reset = false;
  RunReport report;
  ASSERT_TRUE(session.run(report, [&](const Simulation& simulation) {
    most = std::max(most, session.report().history.size());
    if (simulation.tick_index() == 5000 && !std::exchange(reset, true)) { EXPECT_TRUE(session.reset()); }
    return session.epoch() == 1 || simulation.tick_index() < 10;
  }));
  EXPECT_EQ(most, 2u);
  EXPECT_EQ(session.simulation().tick_index(), 10u);
  EXPECT_EQ(session.simulation().state_hash(), hash_after(rolling(), 10));
}

TEST(Session, ForgetsTheOldestInputWhereItFillsMoreThanSnapshotsMay) {
  // A request per tick, of 200 to 600 bytes in the log; memory for 100 KB of it, so for some 160 to 500 ticks.
  const auto with_input = [](const Simulation& simulation, const auto& submit) {
    submit(PoseRequest{"ball", {{0.01 * static_cast<double>(simulation.tick_index()), 0, 1}, {}}});
  };
  const auto reference = build(rolling());
  std::vector<std::uint64_t> hashes{reference->state_hash()};
  for (int tick = 0; tick < 1000; ++tick) {
    with_input(*reference, [&](Request request) { reference->submit(std::move(request)); });
    ASSERT_TRUE(reference->tick());
    hashes.push_back(reference->state_hash());
  }
  Session session(build(rolling()), {.history_mb = 0.1, .history_every_s = 0.05, .history_share = always});
  std::optional<std::uint64_t> back_at;
  Time kept_from;
  RunReport report;
  ASSERT_TRUE(session.run(report, [&](const Simulation& simulation) {
    const std::uint64_t tick = simulation.tick_index();
    if (session.epoch() == 1 && tick < 1000) {
      with_input(simulation, [&](Request request) { EXPECT_TRUE(session.submit(std::move(request))); });
    } else if (session.epoch() == 1 && !session.report().target) {
      session.pause();
      kept_from = session.report().kept_from;
      const Status early = session.jump(kept_from - Time::from_s(0.01));
      EXPECT_NE(early.error().text().find("a reset goes back to the beginning"), std::string::npos)
          << early.error().text();
      EXPECT_TRUE(session.jump(kept_from + Time::from_s(0.02)));
    } else if (session.epoch() == 2 && session.report().state == Session::State::paused &&
               !session.report().target) {
      if (!back_at) { EXPECT_EQ(simulation.state_hash(), hashes[tick]); }
      if (!std::exchange(back_at, tick)) { EXPECT_TRUE(session.reset()); }
    }
    return session.epoch() < 3;
  }));
  // Half of the memory's ticks at least, and all of them at most, are kept.
  EXPECT_GT(kept_from, Time::from_s(10 - 5.0));
  EXPECT_LT(kept_from, Time::from_s(10 - 0.8));
  EXPECT_EQ(back_at, static_cast<std::uint64_t>(std::lround(kept_from.s() / 0.01)) + 2);
  EXPECT_EQ(session.simulation().state_hash(), hashes[0]);
  EXPECT_EQ(session.report().kept_from, Time());
}

/// By what takes longer than a tick may wait: between two of them there is a tick, and none is lost.
TEST(Session, GoesOnWhileOthersAskMuch) {
  Session session(build(rolling()), {});
  std::vector<std::uint64_t> seen;
  for (int i = 0; i < 3; ++i)
    session.post([&](Session& s) {
      seen.push_back(s.simulation().tick_index());
      std::this_thread::sleep_for(std::chrono::milliseconds(15));
    });
  RunReport report;
  ASSERT_TRUE(session.run(report, [](const Simulation& simulation) { return simulation.tick_index() < 2; }));
  EXPECT_EQ(seen, (std::vector<std::uint64_t>{0, 1, 2}));
}

TEST(Session, OrdersAndRequestsMayComeFromManyThreads) {
  Session session(build(rolling()), {});
  std::atomic<int> answered = 0, posted = 0;
  std::atomic<bool> running = true;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] {
      for (int n = 0; n < 200 && running; ++n) {
        if (n % 20 == i) session.pause();
        if (n % 20 == i + 4) session.play();
        if (n % 50 == i) (void)session.jump(Time::from_s(0.01 * n));
        if (n % 70 == i) (void)session.reset();
        (void)session.submit(PoseRequest{"ball", {{0.1 * n, 0, 1}, {}}}, {Source::Kind::robot, unsigned(i)},
                             [&](const Status&) { ++answered; });
        if (session.post([&](Session&) { ++posted; })) {}
        (void)session.report();
        std::this_thread::yield();
      }
      session.play();
    });
  std::thread ender([&] {
    for (auto& thread : threads) thread.join();
    session.quit();
  });
  RunReport report;
  EXPECT_TRUE(session.run(report));
  running = false;
  ender.join();
  EXPECT_EQ(posted, 800);
  EXPECT_FALSE(session.post([](Session&) {}));
}

// ---------------------------------------------------------------------------------------------------------- pulls

/// By hand: critically damped with w = 2 pi per second, the mass of 1 kg comes to rest g / w^2 below its target.
TEST(Pull, HoldsAThingWhereTheSpringAndGravityBalance) {
  const auto simulation = build(rolling());
  for (int tick = 0; tick < 600; ++tick) {
    if (tick % 100 == 0) simulation->submit(PullRequest{"ball", "", {}, {1, 2, 3}, Time::from_s(2)});
    ASSERT_TRUE(simulation->tick());
  }
  const Vec3 p = simulation->engine().pose(*simulation->find_instance("ball")).p;
  EXPECT_NEAR(p.x, 1, 1e-3);
  EXPECT_NEAR(p.y, 2, 1e-3);
  EXPECT_NEAR(p.z, 3 - 9.81 / (math::tau * math::tau), 1e-3);
}

TEST(Pull, EndsByItselfAndIsPartOfASnapshot) {
  const auto whole = build(rolling());
  whole->submit(PullRequest{"ball", "link", {0, 0, 0.1}, {0, 0, 5}, Time::from_s(0.5)});
  std::vector<std::byte> half;
  double highest = 0;
  for (int tick = 0; tick < 300; ++tick) {
    if (tick == 20) half = whole->snapshot();
    ASSERT_TRUE(whole->tick());
    highest = std::max(highest, whole->engine().pose(*whole->find_instance("ball")).p.z);
  }
  EXPECT_GT(highest, 2) << "pulled up";
  EXPECT_LT(whole->engine().pose(*whole->find_instance("ball")).p.z, 2) << "and let go";
  Diagnostics diagnostics;
  auto restored = Simulation::restore(half, {}, diagnostics);
  ASSERT_TRUE(restored);
  for (int tick = 20; tick < 300; ++tick) ASSERT_TRUE((*restored)->tick());
  EXPECT_EQ((*restored)->state_hash(), whole->state_hash());
}

TEST(Pull, RefusesWhatDoesNotMove) {
  const auto simulation = build(rolling());
  const auto refusal = [&](PullRequest request) {
    simulation->submit(std::move(request));
    EXPECT_TRUE(simulation->tick());
    const Status& status = simulation->outcomes().front().status;
    return status ? std::string() : status.error().text();
  };
  EXPECT_NE(refusal({"ground", "", {}, {}}).find("cannot be moved"), std::string::npos);
  EXPECT_NE(refusal({"ball", "lnk", {}, {}}).find("link"), std::string::npos);
  EXPECT_NE(refusal({"ball", "", {}, {0, 0, 1e300}}).find("finite"), std::string::npos);
  EXPECT_NE(refusal({"ball", "", {}, {}, Time::from_s(60)}).find("10 s"), std::string::npos);
  EXPECT_EQ(refusal({"ball", "", {}, {0, 0, 1}}), "");
}

}  // namespace
}  // namespace sandlot::test
