/// Queues of orders, orders of one device to another, services of devices, in whole simulations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "messages/command.h"
#include "messages/device_services.h"
#include "messages/messages.h"
#include "sim/test_values.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot::test {
namespace {

using msg::std_srvs::Trigger;
using testing::ElementsAre;
using testing::HasSubstr;

/// Prints one line per tick, in the order in which they came.
struct Printer {
  using Spec = NoFields;
  struct State {
    std::string paper;
    static void fields(auto& s, auto&& visit) { visit(Field{"paper", "", "Lines printed."}, s.paper); }
  };
  Spec spec;
  State state;
  CommandQueue<msg::String>* lines = nullptr;
  Topic<msg::String>* printed = nullptr;

  static Result<Printer> create(const DeviceBuild& build, Spec) {
    return Printer{
        {}, {}, build.accept_queue<msg::String>(0, "lines", 3), build.publish<msg::String>(0, "lines")};
  }
  static void actuate(PoolView<Printer> pool, const Context& context) {
    for (const std::uint32_t i : pool.due) {
      Printer& printer = pool.all[i];
      if (printer.lines->empty()) continue;
      printer.state.paper += printer.lines->front().data;
      printer.lines->pop();
      printer.printed->message.data = printer.state.paper;
      printer.printed->publish(context.now);
    }
  }
  Result<Trigger::Response> tear(const Trigger::Request&, const Context&) {
    if (state.paper.empty()) return Error{"there is no paper"};
    return Trigger::Response{true, std::exchange(state.paper, {})};
  }
};
constexpr LevelInfo printer_levels[] = {
    {"lines", msg::String::ros_type, msg::String::ros_type, "Prints lines."}};
constexpr DeviceService printer_services[] = {
    device_service<Printer, Trigger, &Printer::tear>("tear", "Tears the paper off and returns it.")};
const Kind printer_kind = make_kind<Printer>(
    {.name = "printer", .help = "For tests.", .levels = printer_levels, .services = printer_services});

/// Orders a letter of another device in every tick.
struct Author {
  struct Spec {
    std::string printer, part = "lines";
    static void fields(auto& s, auto&& visit) {
      visit(Field{"printer", "", "Device that prints.", 0, 0, Field::required, 100}, s.printer);
      visit(Field{"part", "", "Slot of it.", 0, 0, Field::none, 100}, s.part);
    }
  };
  struct State {
    std::uint64_t given = 0, refused = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"given", "1", "Orders given."}, s.given);
      visit(Field{"refused", "1", "Orders refused."}, s.refused);
    }
  };
  Spec spec;
  State state;
  DeviceOrder* order = nullptr;
  static Result<Author> create(const DeviceBuild& build, Spec spec) {
    Author author{std::move(spec), {}, nullptr};
    author.order = build.order<msg::String>(build.instance.name + "/" + author.spec.printer,
                                            author.spec.part.c_str(), "printer");
    return author;
  }
  static void actuate(PoolView<Author> pool, const Context& context) {
    for (const std::uint32_t i : pool.due) {
      State& state = pool.all[i].state;
      const char letter = static_cast<char>('a' + state.given % 26);
      ++(pool.all[i].order->give(msg::String{std::string(1, letter)}, context.now - context.tick)
             ? state.given
             : state.refused);
    }
  }
};
const Kind author_kind = make_kind<Author>({.name = "author", .help = "For tests."});
const Kind* const call_kinds[] = {&author_kind, &printer_kind};
const SimulationOptions with_call_kinds{.threads = 1, .run_programs = true, .extra_kinds = call_kinds};

model::Setup office(std::initializer_list<model::DeviceDecl> devices) {
  model::Setup setup;
  setup.step = Time::from_s(0.01);
  setup.gravity = {};
  model::Instance desk = placed("desk", one_shape("desk", Sphere{0.1}, 1), {});
  desk.is_robot = true;
  for (const model::DeviceDecl& each : devices) desk.devices.push_back(each);
  setup.instances.push_back(std::move(desk));
  return setup;
}

std::string error_with_kinds(model::Setup setup) {
  Diagnostics diagnostics;
  const auto made = Simulation::create(std::move(setup), with_call_kinds, diagnostics);
  return made ? "" : made.error().text();
}

void print(Simulation& simulation, const char* line) {
  simulation.submit(CommandRequest{"desk/printer", msg::String::ros_type, command_bytes(msg::String{line})});
}
const std::string& paper(const Simulation& simulation) {
  return topic_cast<msg::String>(simulation.find_topic("desk/printer"))->message.data;
}

TEST(OrderQueue, HandsOverSeveralOrdersOfATickInTheirOrderAndRefusesTheRest) {
  const auto simulation = build(office({device("printer", "printer")}), with_call_kinds);
  for (const char* line : {"a", "b", "c", "d"}) print(*simulation, line);
  advance(*simulation, 1);
  ASSERT_EQ(simulation->outcomes().size(), 4u);
  EXPECT_TRUE(simulation->outcomes()[2].status);
  EXPECT_THAT(simulation->outcomes()[3].status.error().text(),
              HasSubstr("the queue of '/desk/printer/lines/command' is full"));
  EXPECT_EQ(simulation->refused_commands(), 1u);
  EXPECT_EQ(paper(*simulation), "a");
  EXPECT_EQ(value(*simulation, "desk/printer/lines/command.waiting"), 2);
  EXPECT_EQ(value(*simulation, "desk/printer/lines/command.count"), 3);
  const auto restored = again(*simulation, with_call_kinds);
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
  for (const auto* sim : {&simulation, &restored}) {
    print(**sim, "e");
    advance(**sim, 3);
    EXPECT_EQ(paper(**sim), "abce");
    EXPECT_EQ(value(**sim, "desk/printer/lines/command.waiting"), 0);
  }
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
}

TEST(OrderQueue, WorksWithDelayAndMaxRate) {
  const auto simulation = build(office({device("printer", "printer", map({{"delay", "20 ms"}}))}),
                                with_call_kinds);
  for (const char* line : {"a", "b"}) print(*simulation, line);
  advance(*simulation, 2);
  EXPECT_EQ(paper(*simulation), "");
  advance(*simulation, 1);
  EXPECT_EQ(paper(*simulation), "a");
  advance(*simulation, 1);
  EXPECT_EQ(paper(*simulation), "ab");
}

TEST(DeviceOrders, ReachTheOtherDeviceInTheSameTick) {
  const auto simulation = build(
      office({device("author", "author", map({{"printer", "printer"}})), device("printer", "printer")}),
      with_call_kinds);
  advance(*simulation, 3);
  EXPECT_EQ(paper(*simulation), "abc");
  ASSERT_EQ(simulation->devices("desk")[0].orders.size(), 1u);
  EXPECT_EQ(simulation->devices("desk")[0].orders[0]->slot(), "/desk/printer/lines/command");
  const auto restored = again(*simulation, with_call_kinds);
  advance(*restored, 5);
  advance(*simulation, 5);
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
  EXPECT_EQ(paper(*restored), "abcdefgh");
}

TEST(DeviceOrders, AreRefusedAndCountedAsOthers) {
  Node failures = Node::sequence();
  failures.push(map({{"kind", "dead"}, {"from", "0.05 s"}, {"until", "0.1 s"}}));
  Node keys = Node::map();
  keys.set("failures", failures);
  const auto simulation = build(
      office({device("author", "author", map({{"printer", "printer"}})), device("printer", "printer", keys)}),
      with_call_kinds);
  advance(*simulation, 20);  // the ticks that begin at 50 ... 90 ms
  EXPECT_EQ(value(*simulation, "desk/author.refused"), 5);
  EXPECT_EQ(simulation->refused_commands(), 5u);
  EXPECT_EQ(paper(*simulation), "abcdefghijklmno");
  // Somebody prints by hand: the author waits for half a second.
  print(*simulation, "!");
  advance(*simulation, 50);
  EXPECT_EQ(paper(*simulation), "abcdefghijklmno!");
  EXPECT_EQ(value(*simulation, "desk/author.refused"), 55);
  advance(*simulation, 1);
  EXPECT_EQ(paper(*simulation), "abcdefghijklmno!p");

  const auto slow = build(office({device("author", "author", map({{"printer", "printer"}})),
                                  device("printer", "printer", map({{"max_rate", "20"}}))}),
                          with_call_kinds);
  advance(*slow, 20);
  EXPECT_EQ(paper(*slow), "abcd");
  EXPECT_EQ(value(*slow, "desk/printer.refused"), 16);
}

TEST(DeviceOrders, KnowNoLatestOneWhileTheOtherDeviceHasFailed) {
  Node failures = Node::sequence();
  failures.push(map({{"kind", "dead"}, {"from", "0.05 s"}, {"until", "0.1 s"}}));
  Node keys = Node::map();
  keys.set("failures", failures);
  const auto simulation = build(
      office({device("author", "author", map({{"printer", "printer"}})), device("printer", "printer", keys)}),
      with_call_kinds);
  advance(*simulation, 3);
  const DeviceOrder& order = *simulation->devices("desk")[0].orders[0];
  EXPECT_NE(order.latest(Time::from_s(0.04)), nullptr);
  EXPECT_EQ(order.latest(Time::from_s(0.05)), nullptr);
  EXPECT_NE(order.latest(Time::from_s(0.1)), nullptr);
}

TEST(DeviceOrders, AreCheckedWhenTheRobotIsComplete) {
  EXPECT_EQ(error_with_kinds(office(
                {device("author", "author", map({{"printer", "printr"}})), device("printer", "printer")})),
            "/printer: 'desk/author' gives orders to 'desk/printr', which is not there; did you mean "
            "'desk/printer'?");
  EXPECT_EQ(
      error_with_kinds(office({device("author", "author", map({{"printer", "printer"}, {"part", "ink"}})),
                               device("printer", "printer")})),
      "/printer: 'desk/author' gives orders to 'desk/printer', which takes no std_msgs/msg/String at "
      "/desk/printer/ink/command; name a device that does");
  const auto simulation = build(
      office({device("author", "author", map({{"printer", "printer"}})), device("printer", "printer")}),
      with_call_kinds);
  const auto status_of = [&](Request request) {
    simulation->submit(std::move(request));
    advance(*simulation, 1);
    const Status& status = simulation->outcomes()[0].status;
    return status ? std::string() : status.error().text();
  };
  EXPECT_EQ(status_of(UnloadDeviceRequest{"desk/printer"}),
            "'desk/author' gives orders to 'desk/printer'; unload 'desk/author' first");
  EXPECT_THAT(status_of(LoadDeviceRequest{"desk", device("poet", "author", map({{"printer", "pen"}}))}),
              HasSubstr("'desk/pen'"));
  EXPECT_EQ(std::as_const(*simulation).find_entity("desk")->devices.size(), 2u);
  EXPECT_EQ(status_of(UnloadDeviceRequest{"desk/author"}), "");
  EXPECT_EQ(status_of(UnloadDeviceRequest{"desk/printer"}), "");
  advance(*simulation, 2);
}

struct CallLog : Observer {
  Wants wants() const override { return {.log = true, .input = true, .hash = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    for (const LogEntry& entry : frame->log) entries.emplace_back(frame->tick, entry);
  }
  std::vector<std::pair<std::uint64_t, LogEntry>> entries;
};

TEST(DeviceServices, AreCalledLoggedAndAnswered) {
  const auto simulation = build(office({device("printer", "printer")}), with_call_kinds);
  CallLog log;
  simulation->add_observer(&log);
  Trigger::Request nothing;
  std::vector<std::byte> bytes;
  write_cdr(message_info<Trigger::Request>(), &nothing, bytes);
  print(*simulation, "hello");
  advance(*simulation, 1);
  simulation->submit(CallRequest{"desk/printer", "tear", bytes});
  simulation->submit(CallRequest{"desk/printer", "tear", bytes});
  simulation->submit(CallRequest{"desk/printer", "teer", bytes});
  simulation->submit(CallRequest{"desk/printers", "tear", bytes});
  simulation->submit(CallRequest{"desk/printer", "tear", {}});
  advance(*simulation, 1);
  const auto outcomes = simulation->outcomes();
  ASSERT_EQ(outcomes.size(), 5u);
  ASSERT_TRUE(outcomes[0].status) << outcomes[0].status.error().text();
  Trigger::Response response;
  ASSERT_TRUE(read_cdr(message_info<Trigger::Response>(), outcomes[0].response, &response));
  EXPECT_TRUE(response.success);
  EXPECT_EQ(response.message, "hello");
  EXPECT_EQ(outcomes[1].status.error().text(), "there is no paper");
  EXPECT_TRUE(outcomes[1].response.empty());
  EXPECT_EQ(outcomes[2].status.error().text(),
            "'desk/printer' offers no service 'teer'; did you mean 'tear'?");
  EXPECT_THAT(outcomes[3].status.error().text(), HasSubstr("desk/printers"));
  EXPECT_FALSE(outcomes[4].status) << "a request that is cut short";

  // The log repeats the run.
  const auto repeated = build(office({device("printer", "printer")}), with_call_kinds);
  for (std::uint64_t tick = 1; tick <= 2; ++tick) {
    for (const auto& [at, entry] : log.entries) {
      if (at != tick || entry.kind == LogEntry::command) continue;
      Request request;
      ByteReader r(entry.bytes);
      ASSERT_TRUE(read_request(r, request));
      repeated->submit(std::move(request), entry.source);
    }
    if (tick == 1) print(*repeated, "hello");
    advance(*repeated, 1);
  }
  EXPECT_EQ(by_path(*repeated), by_path(*simulation));
  EXPECT_STREQ(request_kind(Request(CallRequest{}).index()), "call");
}

TEST(DeviceServices, OfADeadDeviceAnswerNothing) {
  const auto simulation = build(office({device("printer", "printer")}), with_call_kinds);
  simulation->submit(ParameterRequest{"desk/printer", "failure", Node::scalar("dead")});
  Trigger::Request nothing;
  std::vector<std::byte> bytes;
  write_cdr(message_info<Trigger::Request>(), &nothing, bytes);
  simulation->submit(CallRequest{"desk/printer", "tear", bytes});
  advance(*simulation, 1);
  EXPECT_EQ(simulation->outcomes()[1].status.error().text(), "'desk/printer' has failed");
}

}  // namespace
}  // namespace sandlot::test
