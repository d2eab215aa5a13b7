#include "sim/session/run_hooks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "sim/test_log.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A ball of 0.1 m whose lower edge is 50 mm above the ground.
model::Setup falling_ball() {
  model::Setup setup;
  setup.step = Time::from_s(0.01);
  setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
  setup.instances.push_back(placed("ball", one_shape("ball", Sphere{0.1}, 1), {{0.3, 0.2, 0.15}, {}}));
  return setup;
}

void run_ticks(RunHooks& run, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    const Status status = run.tick();
    ASSERT_TRUE(status) << status.error().text();
  }
}

TEST(RunHooks, HooksAreCalledInTheOrderThatIsPromised) {
  const auto sim = build(falling_ball());
  std::vector<std::string> called;
  const auto note = [&](const char* what) {
    return [&called, what](RunHooks& e) -> Status {
      called.push_back(what + std::to_string(e.simulation().tick_index()));
      return {};
    };
  };
  Hooks hooks{.on_start = note("start"),
              .before_tick = note("before"),
              .after_tick = note("after"),
              .on_end = note("end")};
  hooks.on_event = [&](RunHooks& e, const std::string& name) -> Status {
    called.push_back(name + std::to_string(e.simulation().tick_index()));
    if (name == "first") e.emit("second");
    return {};
  };
  RunHooks run(*sim, hooks);
  ASSERT_TRUE(run.start());
  run.emit("first");
  run_ticks(run, 2);
  ASSERT_TRUE(run.finish());
  EXPECT_THAT(called,
              ElementsAre("start0", "before0", "first1", "after1", "before1", "second2", "after2", "end2"));
}

TEST(RunHooks, AContactIsToldOncePerTickWithThePairInOrderAndWhereItIs) {
  const auto sim = build(falling_ball());
  std::vector<std::uint64_t> ticks;
  int began = 0;
  Hooks hooks;
  hooks.on_contact = [&](RunHooks& e, const Touch& touch) -> Status {
    ticks.push_back(e.simulation().tick_index());
    began += touch.began;
    EXPECT_EQ(touch.a, "ground");
    EXPECT_EQ(touch.b, "ball");
    EXPECT_NEAR(touch.normal_W.z, 1, 1e-12) << "from the ground towards the ball";
    EXPECT_NEAR(touch.point_W.x, 0.3, 1e-6);
    EXPECT_NEAR(touch.point_W.y, 0.2, 1e-6);
    // It arrives at 1 m/s: one tick of 10 ms carries it in by no more than 10 mm.
    EXPECT_GE(touch.depth_m, 0);
    EXPECT_LE(touch.depth_m, 0.01);
    return {};
  };
  RunHooks run(*sim, hooks);
  run_ticks(run, 40);
  // 50 mm take sqrt(2 * 0.05 / 9.81) = 101 ms; contacts are those that the last step began with.
  ASSERT_FALSE(ticks.empty());
  EXPECT_GE(ticks.front(), 10u);
  EXPECT_LE(ticks.front(), 12u);
  EXPECT_EQ(began, 1);
  for (std::size_t i = 1; i < ticks.size(); ++i) EXPECT_EQ(ticks[i], ticks[i - 1] + 1) << "one call per tick";
}

/// Keeps the log of every tick.
TEST(RunHooks, WhatHooksDoIsInTheLogAndTheLogAloneGivesTheSameState) {
  const auto with_hooks = build(falling_ball());
  TickLog log;
  with_hooks->add_observer(&log);
  Hooks hooks;
  hooks.after_tick = [](RunHooks& e) -> Status {
    if (e.simulation().tick_index() == 7) e.emit("serve");
    return {};
  };
  hooks.on_event = [](RunHooks& e, const std::string&) -> Status {
    e.simulation().submit(
        SpawnRequest{placed("ball2", one_shape("ball", Sphere{0.1}, 1), {{0.31, 0.2, 0.6}, {}})});
    return {};
  };
  RunHooks run(*with_hooks, hooks);
  run_ticks(run, 60);
  ASSERT_TRUE(with_hooks->find_instance("ball2"));

  const auto without = build(falling_ball());
  for (const auto& entries : log.ticks) {
    for (const LogEntry& entry : entries) {
      ByteReader r(entry.bytes);
      Request request;
      ASSERT_TRUE(read_request(r, request));
      without->submit(std::move(request), entry.source);
    }
    ASSERT_TRUE(without->tick());
  }
  EXPECT_EQ(without->state_hash(), with_hooks->state_hash());
}

TEST(RunHooks, AHookThatFailsOrThrowsEndsTheTickWithItsName) {
  const auto sim = build(falling_ball());
  Hooks hooks;
  hooks.before_tick = [](RunHooks& e) -> Status {
    if (e.simulation().tick_index() == 1) return Error{"no power"};
    return {};
  };
  hooks.after_tick = [](RunHooks& e) -> Status {
    if (e.simulation().tick_index() == 1) throw std::runtime_error("no luck");
    return {};
  };
  RunHooks run(*sim, hooks);
  const Status thrown = run.tick();
  ASSERT_FALSE(thrown);
  EXPECT_EQ(thrown.error().what, "after_tick: threw: no luck");
  const Status failed = run.tick();
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().what, "before_tick: no power");
  EXPECT_EQ(sim->tick_index(), 1u);
}

struct Console {
  std::unique_ptr<Simulation> sim = build(falling_ball());
  std::vector<std::string> said;
  Hooks hooks;
  std::unique_ptr<RunHooks> run;
  Console() {
    hooks.commands.push_back({"kick", "kick WORDS: says them",
                              [this](RunHooks& e, std::span<const std::string> words) -> Result<std::string> {
                                std::string all = std::to_string(e.simulation().now().ns / 1'000'000);
                                for (const std::string& word : words) all += "|" + word;
                                said.push_back(all);
                                if (!words.empty() && words[0] == "hard") throw std::runtime_error("ouch");
                                return all;
                              }});
    run = std::make_unique<RunHooks>(*sim, hooks);
  }
};

TEST(RunHooks, ALineIsACommandAndItsWords) {
  Console console;
  EXPECT_EQ(console.run->execute("  kick  ball \"far away\" ").value(), "0|ball|far away");
  EXPECT_THAT(console.run->execute("help").value(), HasSubstr("kick WORDS: says them"));
  const auto complaint = [&](const char* line) {
    const auto result = console.run->execute(line);
    return result ? std::string() : result.error().text();
  };
  EXPECT_THAT(complaint("kik ball"), HasSubstr("did you mean 'kick'?"));
  EXPECT_THAT(complaint(""), HasSubstr("says nothing"));
  EXPECT_THAT(complaint("kick \"ball"), HasSubstr("not closed"));
  EXPECT_THAT(complaint("kick hard"), HasSubstr("ouch"));
}

}  // namespace
}  // namespace sandlot::test
