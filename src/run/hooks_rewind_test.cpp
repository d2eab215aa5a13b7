/// Runs with hooks that are rewound and reset: to the bit what they would have been without.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/atomic_file.h"
#include "base/test_folder.h"
#include "console/console.h"
#include "run/run.h"
#include "sim/session/run_hooks.h"
#include "sim/session/session.h"

namespace sandlot {
namespace {

using testing::HasSubstr;

/// What the experiment remembers: it decides what its requests are.
struct Memory {
  std::uint64_t starts = 0, ticks = 0, kicks = 0, events = 0, touches = 0;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"starts", "1", "Calls of on_start."}, s.starts);
    visit(Field{"ticks", "1", "Ticks so far."}, s.ticks);
    visit(Field{"kicks", "1", "Commands so far."}, s.kicks);
    visit(Field{"events", "1", "Events so far."}, s.events);
    visit(Field{"touches", "1", "Contacts that began."}, s.touches);
  }
  bool operator==(const Memory&) const = default;
};

/// Pushes a ball about in every phase of a tick, by numbers that it remembers.
struct Experiment {
  Memory memory;
  Hooks hooks;
  Experiment() {
    const auto push = [this](RunHooks& run, double sign) {
      const double v = sign * (0.1 + 0.01 * static_cast<double>(memory.ticks % 17 + 3 * memory.kicks));
      run.simulation().submit(VelocityRequest{"ball", {{v, -v / 2, 0}, {}}});
    };
    hooks.on_start = [this](RunHooks& run) -> Status {
      ++memory.starts;
      run.simulation().submit(PoseRequest{"ball", {{0.5, 0.25, 0.1}, {}}});
      return run.bind("k", "kick hard", "Kicks the ball");
    };
    hooks.before_tick = [this, push](RunHooks& run) -> Status {
      if (++memory.ticks % 7 == 0) push(run, 1);
      return {};
    };
    hooks.after_tick = [this, push](RunHooks& run) -> Status {
      if (memory.ticks % 11 == 0) push(run, -1), run.emit("pushed");
      return {};
    };
    hooks.on_event = [this](RunHooks&, const std::string&) -> Status { return ++memory.events, Status(); };
    hooks.on_contact = [this](RunHooks&, const Touch& touch) -> Status {
      memory.touches += touch.began;
      return {};
    };
    hooks.commands.push_back({"kick", "kick HOW", [this, push](RunHooks& run, auto) -> Result<std::string> {
                                ++memory.kicks;
                                push(run, 2);
                                return std::string("kicked");
                              }});
    hooks.keep(memory);
  }
};

struct Ended {
  Memory memory;
  std::uint64_t hash = 0;
  std::vector<std::string> refused;
};

/// Runs to tick 200, with a kick after tick 120, and does something at a tick on the way, once.
Ended ran(const std::string& file, std::uint64_t at = 0, const std::function<Status(Session&)>& act = {},
          bool keep = true) {
  Experiment experiment;
  if (!keep) experiment.hooks.save = nullptr, experiment.hooks.load = nullptr;
  Ended ended;
  Session* session = nullptr;
  Console* console = nullptr;
  bool acted = !act;
  std::uint64_t frontier = 0;
  RunCallbacks callbacks;
  callbacks.hooks = &experiment.hooks;
  callbacks.on_ready = [&](const RunParts& parts) -> Status {
    session = &parts.session;
    console = &parts.console;
    return {};
  };
  callbacks.keep_going = [&](const Simulation& simulation) {
    const std::uint64_t tick = simulation.tick_index();
    const bool live = session->report().takes_no_input.empty() && !session->rerunning();
    // A tick that is repeated has the kick already.
    if (tick == 120 && live && frontier != tick)
      console->execute("kick hard", {}, [&](const Answer& answer) {
        if (!answer.ok) ended.refused.push_back(answer.text);
      });
    frontier = tick;
    if (tick == at && !acted) {
      acted = true;
      if (const Status status = act(*session); !status) ended.refused.push_back(status.error().text());
      return true;
    }
    if (tick < 200) return true;
    ended.hash = simulation.state_hash();
    return false;
  };
  RunSpec spec{.file = file};
  spec.steered = true;
  spec.may_be_endless = true;
  const auto summary = run(spec, callbacks);
  EXPECT_TRUE(summary) << summary.error().text();
  if (summary) { EXPECT_THAT(summary->errors, testing::IsEmpty()); }
  ended.memory = experiment.memory;
  return ended;
}

std::string scenario(const test::TestFolder& folder) {
  const std::string file = folder.file("s.yaml");
  EXPECT_TRUE(write_file(file, R"(version: 1
name: kicked
physics: planar
time: {step: 10 ms}
things:
  - {name: ball, model: msl_ball, pose: [0, 0, 0.11]}
  - {name: other, model: msl_ball, pose: [0.8, 0.1, 0.11]}
)"));
  return file;
}

TEST(HooksRewind, AJumpBackGivesTheSameRunAndTheSameMemory) {
  const test::TestFolder folder;
  const std::string file = scenario(folder);
  const Ended straight = ran(file);
  EXPECT_EQ(straight.memory.ticks, 200u);
  EXPECT_EQ(straight.memory.kicks, 1u);
  EXPECT_EQ(straight.memory.events, 18u);  // emitted in the ticks 11, 22, ... 198
  EXPECT_GT(straight.memory.touches, 0u);
  EXPECT_EQ(ran(file).hash, straight.hash);
  // To before the kick, which is made again; to behind it, where it is repeated; to the very beginning; to a snapshot.
  for (const double to_s : {0.9, 1.37, 1.21, 1.19, 0.0, 0.01, 1.0}) {
    const Ended back = ran(file, 180, [&](Session& s) { return s.jump(Time::from_s(to_s)); });
    EXPECT_EQ(back.hash, straight.hash) << to_s;
    Memory memory = back.memory;
    EXPECT_EQ(memory, straight.memory) << to_s;
    EXPECT_TRUE(back.refused.empty()) << to_s << back.refused.front();
  }
}

TEST(HooksRewind, AResetBeginsAgain) {
  const test::TestFolder folder;
  const std::string file = scenario(folder);
  const Ended straight = ran(file), again = ran(file, 150, [](Session&s) { return s.reset(); });
  EXPECT_EQ(again.hash, straight.hash);
  EXPECT_EQ(again.memory, straight.memory);
}

TEST(HooksRewind, WithoutSaveAndLoadItIsRefusedWithTheReason) {
  const test::TestFolder folder;
  const Ended ended = ran(
      scenario(folder), 150, [](Session& s) { return s.jump(Time::from_s(1)); }, false);
  ASSERT_EQ(ended.refused.size(), 1u);
  EXPECT_THAT(ended.refused.front(), HasSubstr("without Hooks::save and load"));
  EXPECT_EQ(ended.memory.ticks, 200u);
}

TEST(HooksRewind, KeysAreBoundOnceAndShownInHelp) {
  const test::TestFolder folder;
  Experiment experiment;
  std::string help, json;
  RunCallbacks callbacks;
  callbacks.hooks = &experiment.hooks;
  Console* console = nullptr;
  callbacks.on_ready = [&](const RunParts& parts) -> Status {
    console = &parts.console;
    return {};
  };
  callbacks.keep_going = [&](const Simulation&) {
    console->execute("help", {}, [&](const Answer& answer) { help = answer.text; });
    console->execute("help --json", {}, [&](const Answer& answer) { json = answer.text; });
    return false;
  };
  RunSpec spec{.file = scenario(folder)};
  spec.may_be_endless = true;
  ASSERT_TRUE(run(spec, callbacks));
  EXPECT_THAT(help, HasSubstr("key k  kick hard: Kicks the ball"));
  EXPECT_THAT(json, HasSubstr(R"("keys":[{"key":"k","line":"kick hard","help":"Kicks the ball"}])"));
}

}  // namespace
}  // namespace sandlot
