#include "programs/pipe/pipe.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>

#include <cerrno>
#include <thread>

namespace sandlot::programs::pipe {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

Child started(const std::vector<std::string>& command) {
  auto child = Child::start(command);
  EXPECT_TRUE(child) << (child ? "" : child.error().text());
  return std::move(*child);
}

/// Calls `done` until it is true, for ten seconds at most.
template <class Done>
bool soon(Done&& done) {
  for (int i = 0; i < 2000; ++i) {
    if (done()) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

std::string line_of(Child& child) {
  std::optional<std::string> line;
  EXPECT_TRUE(soon([&] { return child.move(), (line = child.take_line()).has_value(); })) << child.gone();
  return line.value_or("");
}

bool is_running(int process) { return kill(process, 0) == 0 || errno != ESRCH; }

TEST(Child, ExchangesLinesWithoutWaiting) {
  Child child = started({"cat"});
  child.move();
  EXPECT_FALSE(child.take_line());
  child.write_line("one");
  child.write_line("two");
  EXPECT_EQ(line_of(child), "one");
  EXPECT_EQ(line_of(child), "two");
  EXPECT_EQ(child.gone(), "");
  // More than any buffer of the kernel holds, while nobody reads.
  const std::string long_line(300'000, 'x');
  for (int i = 0; i < 5; ++i) child.write_line(long_line);
  EXPECT_TRUE(child.writing());
  for (int i = 0; i < 5; ++i) EXPECT_EQ(line_of(child), long_line);
  EXPECT_FALSE(child.writing());
}

TEST(Child, IsKilledWithItsGroupAndCollected) {
  int child_process = 0, grandchild = 0;
  {
    Child child = started({"sh", "-c", "echo $$; sleep 1000 & echo $!; wait"});
    child_process = std::stoi(line_of(child));
    grandchild = std::stoi(line_of(child));
    EXPECT_TRUE(is_running(child_process));
    EXPECT_TRUE(is_running(grandchild));
  }
  EXPECT_FALSE(is_running(child_process));  // collected: not even a zombie is left
  EXPECT_TRUE(soon([&] { return !is_running(grandchild); }));
}

TEST(Child, ReportsItsEndAndItsNotes) {
  Child child = started({"sh", "-c", "echo last; echo why >&2; exit 3"});
  EXPECT_EQ(line_of(child), "last");
  EXPECT_TRUE(soon([&] { return child.move(), !child.gone().empty(); }));
  EXPECT_EQ(child.gone(), "it has ended");
  EXPECT_EQ(child.take_note(), "why");
  child.write_line("nobody reads this");  // no SIGPIPE
  EXPECT_TRUE(soon([&] { return child.move(), !child.writing(); }));
}

TEST(Child, ALineWithoutEndEndsTheConnection) {
  Child child = started({"sh", "-c", "exec cat /dev/zero"});
  EXPECT_TRUE(soon([&] { return child.move(), !child.gone().empty(); }));
  EXPECT_THAT(child.gone(), HasSubstr("longer than 1048576 bytes"));
}

TEST(Child, AFloodOfLinesIsHeldBackByTheKernel) {
  Child child = started({"sh", "-c", "exec yes"});
  for (int i = 0; i < 100; ++i) child.move();
  int lines = 0;
  while (child.take_line()) ++lines;
  EXPECT_LE(lines, 64 + 16384 / 2);  // what one read brings
}

TEST(Child, AnErrorSaysWhyItCannotBeStarted) {
  const auto error_of = [](const std::vector<std::string>& command) {
    const auto child = Child::start(command);
    return child ? "" : child.error().text();
  };
  EXPECT_THAT(error_of({"sandlot-no-such-program"}), HasSubstr("there is no such program"));
  EXPECT_THAT(error_of({"/etc/passwd"}), HasSubstr("cannot start '/etc/passwd'"));
  EXPECT_THAT(error_of({}), HasSubstr("the command is empty"));
  EXPECT_THAT(error_of({"/"}), HasSubstr("Permission denied"));
  const auto elsewhere = Child::start({"cat"}, "/no/such/folder");
  ASSERT_FALSE(elsewhere);
  EXPECT_THAT(elsewhere.error().text(),
              HasSubstr("cannot start 'cat': there is no folder '/no/such/folder'"));
}

// ------------------------------------------------------------------------------------------------------ answers

Description robot() {
  Description out;
  out.robot = "rover";
  out.control_period_s = 0.1;
  out.readings = {{"laser", "", msg::LaserScan::ros_type, 0, {}},
                  {"laser", "ranges", msg::LaserScan::ros_type, 1, {}},
                  {"drive", "", msg::Odometry::ros_type, 2, {}}};
  out.actuators = {{"drive", "", msg::Twist::ros_type, 0, {}},
                   {"drive", "", msg::TwistStamped::ros_type, 1, {}},
                   {"drive", "ideal", msg::Twist::ros_type, 2, {}}};
  return out;
}

struct Answers {
  std::vector<Named> readings = names_of(robot().readings), actuators = names_of(robot().actuators);
  Topic<msg::Twist> twist{"/rover/drive/command"};
  Topic<msg::TwistStamped> stamped{"/rover/drive/command"};
  const TopicBase* forms[3] = {&twist, &stamped, &twist};
  Command cmd;
  Result<Program::Resumed> read(std::string_view line) {
    return read_answer(line, readings, actuators, forms, cmd);
  }
  std::string error(std::string_view line) {
    const auto result = read(line);
    EXPECT_TRUE(cmd.orders().empty());
    return result ? "" : result.error().text();
  }
};

TEST(PipeAnswer, NamesFollowDevicesTypesAndLevels) {
  std::vector<std::string> names;
  for (const Named& each : names_of(robot().actuators)) names.push_back(each.name);
  EXPECT_EQ(names, (std::vector<std::string>{"drive", "drive/TwistStamped", "drive/ideal"}));
}

TEST(PipeAnswer, OrdersSamplesAndWaits) {
  Answers t;
  const auto first = t.read(R"({"orders": {"drive": {"linear": {"x": 0.25}}}, "samples": ["laser"]})");
  ASSERT_TRUE(first) << first.error().text();
  EXPECT_EQ(first->waiting_for, Program::Waiting::control_step);
  ASSERT_EQ(t.cmd.orders().size(), 2u);
  EXPECT_EQ(t.cmd.orders()[0].slot, 0u);
  EXPECT_TRUE(t.twist.assign(t.cmd.bytes(t.cmd.orders()[0])));
  EXPECT_EQ(t.twist.message.linear.x, 0.25);
  EXPECT_TRUE(t.cmd.orders()[1].is_sample());
  EXPECT_EQ(t.cmd.orders()[1].reading(), 0u);
  const auto later = t.read(R"({"wait": 2.5})");
  ASSERT_TRUE(later);
  EXPECT_EQ(later->waiting_for, Program::Waiting::time);
  EXPECT_EQ(later->until, Time::from_s(2.5));
  const auto message = t.read(R"({"wait": "drive"})");
  ASSERT_TRUE(message);
  EXPECT_EQ(message->waiting_for, Program::Waiting::message);
  EXPECT_EQ(message->reading, 2u);
  EXPECT_TRUE(t.read("{}"));
}

TEST(PipeAnswer, ErrorsNameWhatIsWrongAndOrderNothing) {
  Answers t;
  EXPECT_THAT(t.error("drive!"), HasSubstr("the answer is not JSON"));
  EXPECT_THAT(t.error("[]"), HasSubstr("the answer is not a JSON object"));
  EXPECT_THAT(t.error(R"({"order": {}})"), HasSubstr("has the key 'order'"));
  EXPECT_THAT(t.error(R"({"orders": {"drive": {}, "driv": {}}})"),
              HasSubstr("there is no actuator 'driv'; did you mean 'drive'?"));
  EXPECT_THAT(t.error(R"({"orders": {"drive": {"linear": {"w": 1}}}})"), HasSubstr("order for 'drive': "));
  EXPECT_THAT(t.error(R"({"orders": 3})"), HasSubstr("'orders' of the answer is not an object"));
  EXPECT_THAT(t.error(R"({"samples": ["eye"]})"), HasSubstr("there is no reading 'eye'"));
  EXPECT_THAT(t.error(R"({"wait": -1})"), HasSubstr("'wait' of the answer is not a time"));
  EXPECT_THAT(t.error(std::string(100'000, '[')), HasSubstr("nested more than 32 deep"));
}

// --------------------------------------------------------------------------------------------------- the program

/// A pipe program with a topic for each reading.
struct Rig {
  Pipe pipe;
  Outputs outputs{"rover/brain"};
  Topic<msg::LaserScan> laser{"/rover/laser/ranges"};
  Topic<msg::Odometry> drive{"/rover/drive/ideal"};
  Answers answers;
  Time now;

  explicit Rig(const char* script, std::initializer_list<std::pair<const char*, const char*>> more = {}) {
    Node config = Node::map();
    Node& command = config.set("command", Node::sequence());
    for (const char* word : {"sh", "-c", script}) command.push(Node::scalar(word));
    for (const auto& [key, text] : more) config.set(key, Node::scalar(text));
    const Status status = pipe.init(robot(), config, outputs);
    EXPECT_TRUE(status) << (status ? "" : status.error().text());
    const Status connected = pipe.connect();
    EXPECT_TRUE(connected) << (connected ? "" : connected.error().text());
  }
  void resume() {
    const TopicBase* const topics[] = {&laser, &laser, &drive};
    const std::vector<std::uint64_t> seen(3);
    Command cmd;
    EXPECT_EQ(
        pipe.resume(Observation(now, topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd).waiting_for,
        Program::Waiting::outside);
    EXPECT_TRUE(cmd.orders().empty());
  }
  OutsideAnswer wait() {
    std::optional<OutsideAnswer> answer;
    EXPECT_TRUE(soon([&] { return (answer = pipe.receive()).has_value(); }));
    return answer.value_or(OutsideAnswer{});
  }
};

std::string text(const OutsideAnswer& answer) {
  return {reinterpret_cast<const char*>(answer.bytes.data()), answer.bytes.size()};
}

TEST(Pipe, SendsADescriptionAndThenWhatIsFresh) {
  Rig rig("while read line; do echo \"$line\"; done");
  rig.laser.message.ranges = {1.5f};
  rig.laser.publish({});
  rig.now = Time::from_s(0.5);
  rig.resume();
  EXPECT_TRUE(rig.pipe.expects_answer());
  EXPECT_EQ(
      text(rig.wait()),
      R"({"robot":"rover","period":0.1,"readings":[{"name":"laser","type":"sensor_msgs/msg/LaserScan"},)"
      R"({"name":"drive","type":"nav_msgs/msg/Odometry"}],"actuators":[{"name":"drive","type":)"
      R"("geometry_msgs/msg/Twist"},{"name":"drive/TwistStamped","type":"geometry_msgs/msg/TwistStamped"},)"
      R"({"name":"drive/ideal","type":"geometry_msgs/msg/Twist"}]})");
  EXPECT_FALSE(rig.pipe.expects_answer());
}

TEST(Pipe, SendsEachMessageOnce) {
  Rig rig("read line; while read line; do echo \"$line\"; done");
  rig.laser.publish({});
  rig.drive.publish({});
  rig.resume();
  const std::string first = text(rig.wait());
  EXPECT_THAT(first, testing::StartsWith(R"({"time":0,"step":0,"readings":{"laser":{"header":)"));
  EXPECT_THAT(first, HasSubstr(R"("drive":{"header")"));
  rig.now = Time::from_s(0.25);
  rig.drive.publish(rig.now);
  rig.resume();
  EXPECT_THAT(text(rig.wait()), testing::StartsWith(R"({"time":0.25,"step":1,"readings":{"drive":{)"));
}

TEST(Pipe, ALateAnswerComesBeforeTheNext) {
  Rig rig("read d; read a; sleep 0.3; echo '{\"wait\":1}'; read b; echo '{\"wait\":2}'; read c",
          {{"deadline", "50 ms"}});
  rig.resume();
  EXPECT_LT(rig.pipe.deadline(), Outside::Clock::now() + 51ms);
  std::this_thread::sleep_for(60ms);
  EXPECT_FALSE(rig.pipe.receive());
  EXPECT_TRUE(rig.pipe.expects_answer());
  std::this_thread::sleep_for(600ms);
  rig.resume();
  EXPECT_EQ(text(rig.wait()), R"({"wait":1})");
  EXPECT_TRUE(rig.pipe.expects_answer());
  EXPECT_EQ(text(rig.wait()), R"({"wait":2})");
  EXPECT_FALSE(rig.pipe.expects_answer());
}

/// A program that takes its place, because devices came or went, waits on for what was asked.
TEST(Pipe, OneThatReplacesItWaitsForTheAnswerToo) {
  Rig old("read d; read a; sleep 0.2; echo '{\"wait\":1}'; read d; read b; echo '{\"wait\":2}'; read c");
  old.resume();
  EXPECT_TRUE(old.pipe.expects_answer());
  Rig rig("sleep 1000");
  rig.pipe.adopt(old.pipe);
  EXPECT_TRUE(rig.pipe.expects_answer());
  EXPECT_EQ(text(rig.wait()), R"({"wait":1})");
  EXPECT_FALSE(rig.pipe.expects_answer());
  rig.resume();
  EXPECT_EQ(text(rig.wait()), R"({"wait":2})");
}

TEST(Pipe, WhatItAnswersUnaskedEndsIt) {
  Rig rig("read d; read a; echo '{}'; echo '{}'; sleep 1000");
  rig.resume();
  EXPECT_EQ(rig.wait().kind, OutsideAnswer::Kind::message);
  std::this_thread::sleep_for(100ms);
  rig.resume();
  ASSERT_TRUE(rig.pipe.expects_answer());
  const OutsideAnswer gone = rig.wait();
  EXPECT_EQ(gone.kind, OutsideAnswer::Kind::gone);
  EXPECT_EQ(text(gone), "it sent a line that answers no observation");
  EXPECT_FALSE(rig.pipe.connected());
}

TEST(Pipe, ReactsToMissesAsConfigured) {
  const auto react = [](const char* on_miss, Command& cmd) {
    Rig rig("cat", {{"on_miss", on_miss}});
    const auto resumed = rig.pipe.answer({OutsideAnswer::Kind::missed, {}}, rig.answers.forms, cmd);
    EXPECT_EQ(rig.pipe.value(ValuePart::state, parse_value_path("misses").value()).value, 1);
    return resumed;
  };
  Command cmd;
  EXPECT_FALSE(react("hold", cmd).failure);
  EXPECT_TRUE(cmd.orders().empty());
  EXPECT_FALSE(react("stop", cmd).failure);
  ASSERT_EQ(cmd.orders().size(), 2u);  // as Twist and as TwistStamped
  EXPECT_EQ(react("end", cmd).failure, "the process sent no answer within 1 s");
}

TEST(Pipe, ItsEndIsReportedWithTheLastNote) {
  Rig rig("read d; echo 'no brain' >&2");
  rig.resume();
  const OutsideAnswer gone = rig.wait();
  EXPECT_EQ(gone.kind, OutsideAnswer::Kind::gone);
  EXPECT_EQ(text(gone), "it has ended; last line of its standard error: no brain");
  Command cmd;
  EXPECT_EQ(rig.pipe.answer(gone, rig.answers.forms, cmd).waiting_for, Program::Waiting::nothing);
}

TEST(Pipe, ErrorsNameTheReadingsThereAre) {
  Pipe pipe;
  Outputs out("rover/brain");
  Node config = Node::map();
  Node& command = config.set("command", Node::sequence());
  command.push(Node::scalar("cat"));
  config.set("readings", Node::sequence()).push(Node::scalar("lasr"));
  const Status status = pipe.init(robot(), config, out);
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().text(), HasSubstr("robot 'rover' has no reading 'lasr'; did you mean 'laser'?"));
}

}  // namespace
}  // namespace sandlot::programs::pipe
