/// Threads, clocks and the ends of programs.
#include <gtest/gtest.h>

#include <csignal>

#include "fake_simulator.h"

namespace {

fake::Result run(const std::string& source, const std::string& what, bool delays = true, double most_s = 60) {
  fake::Simulator sim;
  sim.robot().delays = delays;
  return sim.run(fake::compile(source, 7, "-w"), {what}, most_s);
}
std::string trace(const std::string& what, int exit_code = 0) {
  const auto r = run("threads.c", what);
  EXPECT_EQ(r.exit_code, exit_code) << fake::compile("threads.c", 7, "-w") << r.errors;
  EXPECT_EQ(r.output, run("threads.c", what).output) << "the same in every run";
  return r.output;
}

TEST(RobiosThreads, TakeTurns) {
  // main goes on until it waits; then each thread until it yields.
  EXPECT_EQ(trace("yield"), "main a0 b0 a1 b1 a2 b2 end\n");
}
TEST(RobiosThreads, WaitInAQueue) { EXPECT_EQ(trace("queue"), "sa sb sc all ma mb mc end\n"); }
TEST(RobiosThreads, Mutexes) { EXPECT_EQ(trace("mutex"), "end\n"); }
TEST(RobiosThreads, ConditionsAndSemaphores) { EXPECT_EQ(trace("cond"), "p1 c1 p2 c2 p3 c3 end\n"); }
TEST(RobiosThreads, Others) { EXPECT_EQ(trace("others"), "cleaned end\n"); }
TEST(RobiosThreads, ProgramOutlivesMain) { EXPECT_EQ(trace("late"), "late 300\n"); }
TEST(RobiosThreads, ExitOfAThreadIsThePrograms) { trace("exit", 6); }

TEST(RobiosThreads, SlicesOfTenMilliseconds) {
  // A round costs 20 + 10 + 10 + 50 + 10 = 100 us, so a slice is 100 rounds; it ends in the last call of a round.
  EXPECT_EQ(trace("slices"), "a0 b0 a100 b100 a200 b200 a300 b300 a400 b400 end\n");
}

TEST(RobiosThreads, SlicesAreTheSameWithoutDelays) {
  EXPECT_EQ(run("threads.c", "slices", false).output, run("threads.c", "slices").output);
}

TEST(RobiosThreads, DeadlockIsNoted) {
  const auto r = run("threads.c", "stuck", true, 2);
  const auto notes = r.of(fake::OrderKind::note);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].payload.find("wait for each other"), std::string::npos);
  EXPECT_LE(r.turns, 3);
}

TEST(RobiosClocks, AreVirtual) {
  const auto r = run("clocks.c", "");
  EXPECT_EQ(r.exit_code, 0) << fake::compile("clocks.c", 7, "-w") << r.output << r.errors;
  EXPECT_EQ(r.output, run("clocks.c", "").output) << "random numbers are the same in every run";
}

TEST(RobiosClocks, OldProgramsRun) {
  for (const bool delays : {true, false}) {
    fake::Simulator sim;
    sim.robot().delays = delays;
    sim.press(3000 * fake::millisecond, 4);
    const auto r = sim.run(fake::compile("old.c", 7, "-std=gnu89 -w"));
    EXPECT_EQ(r.exit_code, 4) << r.errors;
    EXPECT_EQ(r.output, "1 loops\nno newline");
    EXPECT_GE(r.end_ns, 3950 * fake::millisecond);
    EXPECT_EQ(sim.lines.at(8), "loop 9");
  }
}

TEST(RobiosTime, CallsMoveTheClock) {
  // 50 us a call: in 2 s of simulated time 40 slots of 50 ms with 1000 calls each.
  const auto r = run("hostile.c", "busy", true, 2);
  EXPECT_EQ(r.turns, 40);
  EXPECT_EQ(r.exit_code, 0);
}

TEST(RobiosTime, LoopsEndTheirSlotWithoutDelays) { EXPECT_EQ(run("hostile.c", "busy", false, 2).turns, 40); }

struct End {
  const char* what;
  int exit_code;
  bool last_order;
};
TEST(RobiosEnd, CrashesAreReported) {
  for (const End& e : {End{"recursion", 128 + SIGSEGV, true}, End{"null", 128 + SIGSEGV, true},
                       End{"abort", 128 + SIGABRT, true}, End{"zero", 128 + SIGFPE, true}}) {
    const auto r = run("hostile.c", e.what);
    EXPECT_EQ(r.exit_code, e.exit_code) << e.what;
    EXPECT_EQ(r.finished, e.exit_code) << e.what;
    EXPECT_NE(r.errors.find("the program"), std::string::npos) << e.what;
  }
}
TEST(RobiosEnd, HostileProgramsAreBounded) {
  EXPECT_EQ(run("hostile.c", "exit in thread").exit_code, 9);
  const auto orders = run("hostile.c", "orders");
  EXPECT_EQ(orders.exit_code, 0);
  EXPECT_EQ(orders.of(fake::OrderKind::radio).size(), 10000u);
  const auto free = run("hostile.c", "orders", false);
  EXPECT_EQ(free.of(fake::OrderKind::speed).size(), 100000u);
  EXPECT_EQ(run("hostile.c", "lcd").output, "survived\n");
  EXPECT_EQ(run("hostile.c", "fork").output, "child 1\n");
  const auto threads = run("hostile.c", "threads");
  EXPECT_EQ(threads.output, "255 threads\n");
  EXPECT_EQ(run("hostile.c", "many").output, "5000 threads\n");
  const auto late = run("hostile.c", "late");
  EXPECT_EQ(late.output, "ends\n");
  EXPECT_EQ(late.exit_code, 7);
  EXPECT_GE(late.end_ns, 950 * fake::millisecond);
  EXPECT_EQ(run("hostile.c", "double free").finished, 128 + SIGABRT);
}

TEST(RobiosHost, RunsASharedLibrary) {
  fake::Simulator sim;
  sim.press(400 * fake::millisecond, 1);
  const std::string library = fake::compile("first.c", 7, "-shared -fPIC");
  const auto r = sim.run(SANDLOT_ROBIOS_HOST, {library});
  EXPECT_EQ(r.exit_code, 5) << r.errors;
  EXPECT_EQ(r.output, "key at 400\n500 0 90, front 100\n");
  EXPECT_EQ(sim.run(SANDLOT_ROBIOS_HOST, {"/bin/true"}).exit_code, 2);
}

TEST(RobiosHost, SharedLibrariesHaveVirtualTime) {
  fake::Simulator sim;
  const auto r = sim.run(SANDLOT_ROBIOS_HOST, {fake::compile("clocks.c", 7, "-w -shared -fPIC")});
  EXPECT_EQ(r.exit_code, 0) << r.output << r.errors;
}

TEST(RobiosProtocol, MismatchIsReported) {
  fake::Simulator sim;
  sim.memory().protocol++;
  const auto r = sim.run(fake::compile("first.c", 7));
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_NE(r.errors.find("same release"), std::string::npos) << r.errors;
}

}  // namespace
