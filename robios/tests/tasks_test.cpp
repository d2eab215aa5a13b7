/// The order in which tasks run, against traces made by hand.
#include <gtest/gtest.h>

#include "fake_simulator.h"

namespace {

std::string trace(const std::string& what, int exit_code = 0) {
  fake::Simulator sim;
  const auto r = sim.run(fake::compile("r6_tasks.c", 6), {what});
  EXPECT_EQ(r.exit_code, exit_code) << fake::compile("r6_tasks.c", 6) << r.errors;
  EXPECT_EQ(r.finished, exit_code);
  return r.output;
}

TEST(RobiosTasks, CooperativeOnesGiveWay) {
  // The task of the highest priority yields to none of the others; those two take turns. OSSleep counts for main as being ready.
  EXPECT_EQ(trace("coop"), "main 3:0 3:1 3:2 1:0 2:0 1:1 2:1 1:2 2:2 back sleeps woke end\n");
}

TEST(RobiosTasks, SemaphoresWakeTheHigherPriority) {
  // Preemptive: each V lets the consumer run at once; main goes on while the producer sleeps. Cooperative: when the producer sleeps or ends.
  EXPECT_EQ(trace("sem preempt"), "+0 -0 +1 -1 end\n+2 -2 c. p. ");
  EXPECT_EQ(trace("sem coop"), "+0 +1 -0 -1 +2 p. -2 c. end\n");
}

TEST(RobiosTasks, SlicesOfTenMilliseconds) {
  // 10 ms of LCDPutChar (50 us) are 200 calls. The other task runs within the call whose time ends the slice, before it has
  // done its work: a task that comes back counts that call first.
  EXPECT_EQ(trace("preempt"), "1@0 2@0 1@200 2@200 1@400 2@400 1@600 2@600 1@800 2@800 end\n");
}

TEST(RobiosTasks, HighPriorityRunsWhenItWakes) {
  // Times in 1/100 s. main goes on when both wait for the first time. From the sixth
  // round of the lower task until its ninth nothing switches.
  EXPECT_EQ(trace("priorities"), "end\n1 2 H3 3 4 5 6 7 8 9 H9 10 H12 ");
}

TEST(RobiosTasks, SuspendReadyRunKillExit) { EXPECT_EQ(trace("control", 4), "1 2 s 2 2 k 1 1 r 5 end\n"); }

TEST(RobiosTasks, MainOfPreemptiveProgramsGoesOnWhileOthersWait) {
  // The task counts at 0, 5 and 10 hundredths; at 22, after 11 of forbidding, it continues.
  EXPECT_EQ(trace("main"), "main 1 3 3 4\n");
  EXPECT_EQ(trace("main returns"), "main 1 ticked ");
}

TEST(RobiosTasks, MainGoesOnWhenNoOtherCan) { EXPECT_EQ(trace("stuck"), "back\n"); }

TEST(RobiosTasks, PanicEndsTheProgram) {
  fake::Simulator sim;
  const auto r = sim.run(fake::compile("r6_tasks.c", 6), {"panic"});
  EXPECT_EQ(r.exit_code, 1);
  EXPECT_NE(r.errors.find("no more"), std::string::npos);
  EXPECT_EQ(sim.lines.at(1), "no more");
}

}  // namespace
