/// RoBIOS programs in a world: turns, what is logged and repeated, and programs that mean harm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include "base/log.h"
#include "base/test_folder.h"
#include "programs/test_sandbox.h"
#include "sim/session/session.h"
#include "sim/test_input.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Folder with tests/robios/fake_program.cpp, compiled, under a name.
class RobiosWorld : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    made = new TestFolder;
    fs::permissions(made->path, fs::perms(0755));
    const std::string compile = "c++ -std=c++20 -O1 -w -I src tests/robios/fake_program.cpp -o " +
                                made->file("fake");
    ASSERT_EQ(std::system(compile.c_str()), 0);
  }
  static void TearDownTestSuite() {
    delete made;
    made = nullptr;
  }
  static model::ControllerDecl brain(const std::string& mode,
                                     const std::vector<std::pair<const char*, const char*>>& more = {}) {
    std::error_code exists;
    fs::copy_file(made->file("fake"), made->file(mode), exists);
    Node config = Node::map();
    config.set("program", Node::scalar(mode));
    config.set("folder", Node::scalar(made->path.string()));
    config.set("sandbox", Node::scalar("off"));
    for (const auto& [key, text] : more) config.set(key, Node::scalar(text));
    return {"brain", "robios", config, {}};
  }
  static model::Setup with(const std::vector<std::string>& modes,
                           const std::vector<std::pair<const char*, const char*>>& more = {}) {
    model::Setup setup = arena("planar", static_cast<int>(modes.size()), "");
    for (std::size_t i = 0; i < modes.size(); ++i)
      setup.instances[setup.instances.size() - modes.size() + i].controllers.push_back(brain(modes[i], more));
    return setup;
  }
  void TearDown() override { log::set_listener({}); }

  static TestFolder* made;
};
TestFolder* RobiosWorld::made = nullptr;

TEST_F(RobiosWorld, SensesAndOrdersOncePerSlot) {
  const auto live = build(with({"drive"}), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 100);
  // Slots of 50 ms begin at 0, 0.05 ... 1 s; the orders of the last one act in the tick in which it ends.
  EXPECT_EQ(value(*live, "rover1/brain.turns"), 21);
  EXPECT_EQ(value(*live, "rover1/brain.refused"), 0);
  EXPECT_NEAR(value(*live, "rover1/drive/ideal/command.linear.x"), 0.01 * 20, 1e-12);
  EXPECT_NEAR(value(*live, "rover1/drive/ideal/command.angular.z"), 0.001 * 61, 1e-12);
}

TEST_F(RobiosWorld, OrdersActInTheTickInWhichTheirSlotEnds) {
  const auto live = build(with({"drive"}), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 4);
  for (int tick = 5; tick <= 100; ++tick) {
    advance(*live, 1);
    // The first order is of the slot up to 50 ms, which the fifth tick ends.
    EXPECT_NEAR(value(*live, "rover1/drive/ideal/command.linear.x"), 0.01 * (tick / 5), 1e-12) << tick;
  }
  // A snapshot holds orders that wait.
  advance(*live, 1);
  const auto rest = again(*live);
  advance(*live, 4);
  advance(*rest, 4);
  EXPECT_NEAR(value(*rest, "rover1/drive/ideal/command.linear.x"), 0.01 * 21, 1e-12);
  EXPECT_EQ(rest->state_hash(), live->state_hash());
}

TEST_F(RobiosWorld, RunsTheSameOnAnyThreadsAndFromItsLog) {
  InputLog log;
  std::string half;
  const std::vector<std::string> modes{"drive", "waiter", "kill", "finish", "pose"};
  for (const int threads : {1, 2, 4}) {
    const auto live = build(with(modes), {.threads = threads, .start_programs = true});
    ASSERT_TRUE(live);
    InputLog again;
    live->add_observer(&again);
    advance(*live, 33);
    const auto snapshot = live->snapshot();
    advance(*live, 67);
    live->remove_observer(&again);
    if (log.hash.empty()) log = again;
    EXPECT_EQ(again.hash, log.hash) << threads;
    const auto rest = [&] {
      Diagnostics diagnostics;
      return std::move(*Simulation::restore(snapshot, {.threads = threads}, diagnostics));
    }();
    for (std::uint64_t tick = 34; tick <= 100; ++tick) {
      feed(*rest, log.input[tick]);
      advance(*rest, 1);
      ASSERT_EQ(rest->state_hash(), log.hash[tick]) << tick << ", " << threads << " threads";
    }
  }
}

TEST_F(RobiosWorld, HasNoTurnWhileItWaits) {
  const auto live = build(with({"waiter"}), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 39);
  EXPECT_EQ(value(*live, "rover1/brain.turns"), 1);
  advance(*live, 60);
  // 0.43 s lies in the slot from 0.4 s on.
  EXPECT_EQ(value(*live, "rover1/brain.turns"), 2);
  EXPECT_NEAR(value(*live, "rover1/brain.now") * 1e-9, 0.4, 1e-9);
}

TEST_F(RobiosWorld, KeepsTheOdometryThatItSet) {
  const auto live = build(with({"pose"}), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 120);
  EXPECT_EQ(value(*live, "rover1/brain.ended"), 0);
  // It drives from the first slot on, and says at 0.95 s where it is.
  EXPECT_NEAR(value(*live, "rover1/brain.origin[0]"), 3 - 0.2 * 0.95, 0.02);
}

TEST_F(RobiosWorld, ASupervisorSeesAndMovesTheWorld) {
  const auto live = build(with({"supervise"}, {{"supervisor", "true"}}), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 60);
  EXPECT_EQ(value(*live, "rover1/brain.ended"), 0);
  EXPECT_NEAR(value(*live, "crate1.pose.x"), 2.5, 0.01);
  const auto others = build(with({"supervise"}), {.start_programs = true});
  ASSERT_TRUE(others);
  advance(*others, 60);
  EXPECT_EQ(value(*others, "rover1/brain.ended"), 2);  // it misses the crate
}

TEST_F(RobiosWorld, BeginsOnceMoreWhereTheRunIsRestored) {
  const auto live = build(with({"waiter"}), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 60);
  ASSERT_EQ(value(*live, "rover1/brain.turns"), 2);  // and it waits for ever
  Diagnostics diagnostics;
  const auto rest = std::move(*Simulation::restore(live->snapshot(), {.start_programs = true}, diagnostics));
  rest->connect_programs();
  advance(*rest, 60);
  EXPECT_EQ(value(*rest, "rover1/brain.turns"), 4);
}

/// What hostile programs do, what becomes of them, and the share of turns that another robot still has: all.
struct Case {
  const char* mode;
  int ended;
  int refused = 0;  ///< at least
};

TEST_F(RobiosWorld, ProgramsThatMeanHarmEndAlone) {
  for (const Case& each : std::vector<Case>{{"finish", 1},
                                            {"return", 2},
                                            {"kill", 2},
                                            {"abort", 2},
                                            {"double_free", 2},
                                            {"recursion", 2},
                                            {"spin", 3},
                                            {"nan", 0, 20},
                                            {"radio", 0, 20},
                                            {"screen", 0, 20},
                                            {"lie", 0, 20},
                                            {"scribble", 0, 5},
                                            {"shorten", 0}}) {
    SCOPED_TRACE(each.mode);
    const auto live = build(with({each.mode, "drive"}, {{"deadline", each.ended == 3 ? "1 s" : "20 s"}}),
                            {.start_programs = true});
    ASSERT_TRUE(live);
    advance(*live, 101);
    EXPECT_EQ(value(*live, "rover1/brain.ended"), each.ended);
    EXPECT_GE(value(*live, "rover1/brain.refused"), each.refused);
    EXPECT_EQ(value(*live, "rover2/brain.turns"), 21);
    EXPECT_NEAR(value(*live, "rover2/drive/ideal/command.linear.x"), 0.01 * 20, 1e-12);
  }
}

TEST_F(RobiosWorld, FloodsAndForksStayInTheirSandbox) {
  SKIP_WITHOUT_SANDBOX();
  std::size_t lines = 0;
  log::set_listener(
      [&](log::Level, std::string_view text) { lines += text.find("nobody wants") != text.npos; });
  const auto flood = build(with({"flood", "drive"}), {.start_programs = true});
  ASSERT_TRUE(flood);
  advance(*flood, 10);
  EXPECT_EQ(value(*flood, "rover2/brain.turns"), 3);
  EXPECT_GT(lines, 0u);
  EXPECT_LE(lines, 3 * 201u);
  const auto fork = build(with({"fork", "drive"}, {{"sandbox", "on"}, {"deadline", "3 s"}}),
                          {.start_programs = true});
  ASSERT_TRUE(fork);
  advance(*fork, 40);
  EXPECT_EQ(value(*fork, "rover2/brain.turns"), 9);
}

char state_of(int process) {
  std::ifstream in("/proc/" + std::to_string(process) + "/stat");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t end = text.rfind(')');
  return end == std::string::npos ? ' ' : text[end + 2];
}

TEST_F(RobiosWorld, WhoUsesMoreThanItsShareIsHaltedBetweenTurns) {
  int burner = 0;
  log::set_listener([&](log::Level, std::string_view text) {
    if (const auto at = text.find("burner "); at != text.npos)
      burner = std::stoi(std::string(text.substr(at + 7)));
  });
  const auto live = build(with({"burn"}, {{"cpu", "10 %"}}), {.start_programs = true});
  ASSERT_TRUE(live);
  bool halted = false;
  for (int i = 0; i < 6000 && !halted; ++i) {  // on a busy machine it gets little to use
    advance(*live, 1);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    halted = burner > 0 && state_of(burner) == 'T';
  }
  EXPECT_TRUE(halted);
  const double turns = value(*live, "rover1/brain.turns");
  advance(*live, 50);
  EXPECT_EQ(value(*live, "rover1/brain.turns"), turns + 10);
}

TEST_F(RobiosWorld, LastWordsAreShown) {
  std::string all;
  log::set_listener([&](log::Level, std::string_view text) { all += std::string(text) + "\n"; });
  const auto live = build(with({"kill"}), {.start_programs = true});
  ASSERT_TRUE(live);
  advance(*live, 30);
  EXPECT_THAT(all, HasSubstr("was ended by signal 9 (Killed); its last words:\n  these are my last words"));
}

}  // namespace
}  // namespace sandlot::test
