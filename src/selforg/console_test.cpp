/// Consoles of agents, and files of agents that are not what they should be.
#include "selforg/console.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <iterator>

#include "base/test_folder.h"
#include "selforg/sox/sox.h"
#include "selforg/store.h"
#include "selforg/terminal/terminal.h"
#include "selforg/test_reference.h"

namespace sandlot::selforg::test {
namespace {

using testing::HasSubstr;

struct Wheels : Robot {
  std::vector<double> y{0, 0};
  std::size_t sensors() const override { return 2; }
  std::size_t motors() const override { return 2; }
  void read_sensors(std::span<double> x) override { x[0] = y[0], x[1] = 0.5 * y[1]; }
  void set_motors(std::span<const double> to) override { y.assign(to.begin(), to.end()); }
};

class ConsoleTest : public testing::Test {
 protected:
  ConsoleTest() : agent(std::move(*make_agent(robot, {.seed = 3}))), console(*agent) {}
  std::string ok(const std::string& line) {
    auto answer = console.execute(line);
    EXPECT_TRUE(static_cast<bool>(answer)) << line << ": " << answer.error().text();
    return answer ? *answer : "";
  }
  std::string refused(const std::string& line) {
    const auto answer = console.execute(line);
    EXPECT_FALSE(static_cast<bool>(answer)) << line << ": " << *answer;
    return answer ? "" : answer.error().text();
  }
  std::vector<std::byte> state() { return agent->wired().stored(); }

  sandlot::test::TestFolder folder;
  Wheels robot;
  std::unique_ptr<Agent> agent;
  AgentConsole console;
};

TEST_F(ConsoleTest, ShowsAndSetsByNamesAndPatterns) {
  EXPECT_EQ(ok("show epsC"), "epsC = 0.1\n");
  EXPECT_EQ(ok("set eps* 0.2"), "epsC = 0.2\nepsA = 0.2\n");
  EXPECT_EQ(ok("epsC=0.3"), "epsC = 0.3\n");
  EXPECT_EQ(ok("set epsA = 0.4"), "epsA = 0.4\n");
  EXPECT_EQ(ok("set error root"), "error = root\n");
  EXPECT_EQ(ok("set wiring.noise.strength 0.5"), "wiring.noise.strength = 0.5\n");
  EXPECT_EQ(ok("noise=0"), "noise = 0\n");
  EXPECT_EQ(agent->wired().noise(), 0);
  EXPECT_EQ(ok("show C[0,1] x_R[0]"), "C[0,1] = 0\nx_R[0] = 0\n");
  EXPECT_THAT(ok("list"), HasSubstr("sox behind one_to_one, 2 sensors, 2 motors, 0 steps\nnoise = 0\n"));
  EXPECT_THAT(ok("help"), HasSubstr("set NAME VALUE"));
  EXPECT_EQ(ok("  "), "");
}

TEST_F(ConsoleTest, ALineThatFailsChangesNothing) {
  for (int k = 0; k < 20; ++k) agent->step(0.01);
  const auto before = state();
  EXPECT_THAT(refused("set * 0.5"), HasSubstr("must be")) << "some of them cannot be 0.5";
  EXPECT_THAT(refused("set eps* 9"), HasSubstr("epsC"));
  for (const char* line : {"set epsC nan",
                           "set epsC inf",
                           "epsC=",
                           "set noise -1",
                           "set noise nan",
                           "set error roots",
                           "set s4delay 0",
                           "set s4delay 1.5",
                           "set init_feedback 2",
                           "babble 0",
                           "babble -3",
                           "babble 1e99",
                           "log",
                           "store",
                           "load",
                           "load /nowhere",
                           "set",
                           "set epsC",
                           "set a b c",
                           "\x01",
                           "log x 0",
                           "show Q[0]"})
    EXPECT_NE(refused(line), "") << line;
  EXPECT_THAT(refused("sett epsC 1"), HasSubstr("did you mean 'set'"));
  EXPECT_NE(refused(std::string(5000, 'a')), "");
  EXPECT_EQ(state(), before);
}

TEST_F(ConsoleTest, FilesOfAgentsThatAreCutOrForgedChangeNothing) {
  for (int k = 0; k < 40; ++k) agent->step(0.01);
  const auto before = state();
  const std::string path = folder.file("agent");
  ok("store " + path);
  ok("load " + path);
  EXPECT_EQ(state(), before);
  for (std::size_t cut = 0; cut < before.size(); cut += 11) {
    EXPECT_FALSE(static_cast<bool>(agent->wired().take_stored(std::span(before).first(cut), "cut"))) << cut;
    ASSERT_EQ(state(), before) << cut;
  }
  // Bytes changed, with the check sum made right again: refused, or another agent that still moves within +-1.
  const auto forged = [&](std::size_t at, std::uint8_t with) {
    auto bytes = before;
    bytes[at] ^= std::byte{with};
    const std::uint64_t sum = hash64(std::span(bytes).subspan(20));
    std::memcpy(&bytes[12], &sum, 8);
    return bytes;
  };
  int refused_files = 0;
  for (std::size_t at = 20; at < before.size(); at += 3) {
    const Status taken = agent->wired().take_stored(forged(at, 0xff), "forged");
    if (!taken) {
      ++refused_files;
      ASSERT_EQ(state(), before) << at;
      continue;
    }
    for (int k = 0; k < 5; ++k) agent->step(0.01);
    for (const double y : robot.y) ASSERT_TRUE(std::abs(y) <= 1) << at;
    ASSERT_TRUE(static_cast<bool>(agent->wired().take_stored(before, "back")));
  }
  EXPECT_GT(refused_files, 20);
  auto longer = before;
  longer.push_back(std::byte{0});
  const std::uint64_t sum = hash64(std::span(longer).subspan(20));
  std::memcpy(&longer[12], &sum, 8);
  EXPECT_FALSE(static_cast<bool>(agent->wired().take_stored(longer, "longer")));
  EXPECT_EQ(state(), before) << "what was read before the bytes that are left over";
}

TEST_F(ConsoleTest, AFileOfNumbersThatNoRunReachesIsRefused) {
  auto& sox = dynamic_cast<ControllerOf<Sox>&>(agent->controller()).element();
  const auto before = state();
  const double kept = sox.state.C[0];
  for (const double number : {1e60, -1e300, std::nan(""), std::numeric_limits<double>::infinity()}) {
    sox.state.C[0] = number;
    const auto file = state();
    sox.state.C[0] = kept;
    EXPECT_FALSE(static_cast<bool>(agent->wired().take_stored(file, "file"))) << number;
  }
  EXPECT_EQ(state(), before);
}

TEST_F(ConsoleTest, ATerminalStepsWhatItIsToldAndEndsWithItsInput) {
  const std::string in = folder.write("in", "step 5\nshow epsC\nstep 3\nfly\nstep 0\nquit\nstep 9\n"),
                    out = folder.file("out");
  const int from = ::open(in.c_str(), O_RDONLY), to = ::open(out.c_str(), O_WRONLY | O_CREAT, 0600);
  Terminal terminal(*agent, {.paused = true, .in = from, .out = to});
  int steps = 0;
  while (terminal.serve()) agent->step(0.01), ++steps;
  ::close(from), ::close(to);
  EXPECT_EQ(steps, 8);
  EXPECT_THAT(folder.read("out"), HasSubstr("epsC = 0.1\n"));
  EXPECT_THAT(folder.read("out"), HasSubstr("there is no command 'fly'"));
  EXPECT_THAT(folder.read("out"), HasSubstr("'0' is not a number of steps"));
  // Running, the end of the input does not end the robot.
  const int nothing = ::open("/dev/null", O_RDONLY);
  Terminal running(*agent, {.paused = false, .in = nothing, .out = nothing});
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(running.serve());
  ::close(nothing);
}

}  // namespace
}  // namespace sandlot::selforg::test
