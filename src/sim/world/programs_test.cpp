/// Programs: topics of their own, samples on request, control rates of their own, and programs of teams.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "messages/command.h"
#include "sim/load/load.h"
#include "sim/test_values.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

/// Publishes the number of its steps.
struct Counter {
  using Spec = NoFields;
  struct State {
    std::uint32_t n = 0;
    static void fields(auto& s, auto&& visit) { visit(Field{"n", "1", "Number of steps."}, s.n); }
  };
  Spec spec;
  State state;
  Publication<msg::UInt32> count;
  Status init(const Description&, Outputs& out) {
    count = out.publish<msg::UInt32>("count");
    return {};
  }
  void step(const Observation&, Command& cmd) { cmd.publish(count, msg::UInt32{++state.n}); }
};

/// Adds up what it sees of a counter.
struct Follower {
  struct Spec {
    std::string counter;
    static void fields(auto& s, auto&& visit) { visit(Field{"counter", "", "Topic to follow."}, s.counter); }
  };
  struct State {
    std::uint32_t seen = 0, fresh = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"seen", "1", "Last number."}, s.seen);
      visit(Field{"fresh", "1", "Fresh messages so far."}, s.fresh);
    }
  };
  Spec spec;
  State state;
  Reading<msg::UInt32> counter;
  Status init(const Description& robot) {
    SL_ASSIGN(counter, robot.reading<msg::UInt32>(spec.counter));
    return {};
  }
  void step(const Observation& obs, Command&) {
    const auto view = obs.get(counter);
    if (view.valid) state.seen = view.message.data;
    state.fresh += view.fresh;
  }
};

/// Requests a sample of the ground truth in every third step.
struct Sampler {
  using Spec = NoFields;
  using State = Counter::State;
  Spec spec;
  State state;
  Reading<msg::Odometry> truth;
  Status init(const Description& robot) {
    SL_ASSIGN(truth, robot.reading<msg::Odometry>("truth"));
    return {};
  }
  void step(const Observation&, Command& cmd) {
    if (++state.n % 3 == 0) cmd.request_sample(truth);
  }
};

/// Draws a random number per step.
struct Dice {
  using Spec = NoFields;
  struct State {
    double thrown = 0;
    static void fields(auto& s, auto&& visit) { visit(Field{"thrown", "1", "Last number."}, s.thrown); }
  };
  Spec spec;
  State state;
  Status init(const Description&) { return {}; }
  void step(const Observation& obs, Command&) { state.thrown = obs.random().uniform(); }
};

/// Orders the drive straight on.
struct Driver {
  using Spec = NoFields;
  using State = NoFields;
  Spec spec;
  State state;
  Actuator<msg::Twist> drive;
  Status init(const Description& robot) {
    SL_ASSIGN(drive, robot.actuator<msg::Twist>(robot.actuators.front().device));
    return {};
  }
  void step(const Observation&, Command& cmd) { cmd.set(drive, msg::Twist{{0.1, 0, 0}, {}}); }
};

/// A name that cannot be one of a topic.
struct Misnamed : Counter {
  Status init(const Description&, Outputs& out) {
    count = out.publish<msg::UInt32>("a b");
    return {};
  }
};

/// Keeps what came on the topic "goal" of its robot.
struct Goer {
  using Spec = NoFields;
  struct State {
    double x = 0, came_s = 0, sent_s = 0;
    std::uint32_t fresh = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"x", "m", "Last goal."}, s.x);
      visit(Field{"came", "s", "When it came."}, s.came_s);
      visit(Field{"sent", "s", "The stamp its sender gave."}, s.sent_s);
      visit(Field{"fresh", "1", "Fresh messages so far."}, s.fresh);
    }
  };
  Spec spec;
  State state;
  Subscription<msg::PoseStamped> goal;
  Status init(const Description&, Outputs& out) {
    goal = out.subscribe<msg::PoseStamped>("goal");
    return {};
  }
  void step(const Observation& obs, Command&) {
    const auto view = obs.get(goal);
    state.fresh += view.fresh;
    if (!view.valid) return;
    state = {view.message.pose.p.x, view.stamp.s(), view.message.header.stamp.s(), state.fresh};
  }
};

/// Takes the topic of a Goer for something else.
struct Speeder : Counter {
  Status init(const Description&, Outputs& out) {
    (void)out.subscribe<msg::Twist>("goal");
    return {};
  }
};

constexpr ControllerKind speeder = make_controller<Speeder>({.name = "speeder", .help = "Errs."});
constexpr ControllerKind goer = make_controller<Goer>({.name = "goer", .help = "Waits for goals."});
constexpr ControllerKind counter = make_controller<Counter>({.name = "counter", .help = "Counts."});
constexpr ControllerKind follower = make_controller<Follower>({.name = "follower", .help = "Follows."});
constexpr ControllerKind sampler = make_controller<Sampler>({.name = "sampler", .help = "Samples."});
constexpr ControllerKind misnamed = make_controller<Misnamed>({.name = "misnamed", .help = "Errs."});
constexpr ControllerKind dice = make_controller<Dice>({.name = "dice", .help = "Throws."});
constexpr ControllerKind driver = make_controller<Driver>({.name = "driver", .help = "Drives."});
constexpr const ControllerKind* kinds[] = {&counter, &follower, &sampler, &misnamed,
                                           &dice,    &driver,   &goer,    &speeder};

/// One rover on a plane with programs; ticks of 10 ms, control steps every 50 ms.
model::Setup with_programs(std::vector<model::ControllerDecl> programs) {
  model::Setup setup = arena("planar", 1, "");
  for (auto& decl : programs) setup.instances.back().controllers.push_back(std::move(decl));
  return setup;
}

Result<std::unique_ptr<Simulation>> try_build(model::Setup setup, int threads = 1) {
  Diagnostics diagnostics;
  return Simulation::create(std::move(setup), {.threads = threads, .extra_controllers = kinds}, diagnostics);
}

std::unique_ptr<Simulation> make(model::Setup setup, int threads = 1) {
  auto made = try_build(std::move(setup), threads);
  EXPECT_TRUE(made) << (made ? "" : made.error().text());
  return made ? std::move(*made) : nullptr;
}

std::unique_ptr<Simulation> restored(const Simulation& from, int threads = 1) {
  Diagnostics diagnostics;
  auto made = Simulation::restore(from.snapshot(), {.threads = threads, .extra_controllers = kinds},
                                  diagnostics);
  EXPECT_TRUE(made) << (made ? "" : made.error().text());
  return made ? std::move(*made) : nullptr;
}

/// To forge its State.
SimulationParts::ProgramEntry& first_program(const Simulation& simulation) {
  return const_cast<SimulationParts::ProgramEntry&>(*simulation.entities().back()->programs.front());
}

model::Setup counted() {
  return with_programs({{"counter", "counter", Node::map(), {}},
                        {"first", "follower", map({{"counter", "counter/count"}}), {}}});
}

struct Frames : Observer {
  Wants wants() const override { return {.messages = true, .log = true, .hash = true}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override { kept.push_back(frame); }
  std::vector<std::shared_ptr<const Frame>> kept;
};

// ------------------------------------------------------------------------------------------------------- topics

TEST(ProgramTopics, AreSeenByOthersAtTheirNextStep) {
  const auto simulation = make(counted());
  // The follower steps in the same batch: at tick 0 there is nothing yet, then always the number of the step before.
  EXPECT_EQ(value(*simulation, "rover1/first.fresh"), 0);
  for (int step = 1; step <= 4; ++step) {
    advance(*simulation, 5);
    EXPECT_EQ(value(*simulation, "rover1/counter/count.data"), step + 1);
    EXPECT_EQ(value(*simulation, "rover1/first.seen"), step);
    EXPECT_EQ(value(*simulation, "rover1/first.fresh"), step);
  }
  EXPECT_EQ(value(*simulation, "rover1/counter/count.count"), 5);
  EXPECT_EQ(value(*simulation, "rover1/counter/count.stamp"), 0.2);
}

TEST(ProgramTopics, AreFoundListedAndPublishedInFrames) {
  const auto simulation = make(counted());
  const TopicBase* const topic = simulation->find_topic("/rover1/counter/count");
  ASSERT_NE(topic, nullptr);
  EXPECT_EQ(simulation->find_topic("rover1/counter/count"), topic);
  const auto all = simulation->topics();
  EXPECT_EQ(std::count(all.begin(), all.end(), topic), 1);
  Frames frames;
  simulation->add_observer(&frames);
  advance(*simulation, 10);
  int published = 0;
  for (const auto& frame : frames.kept)
    for (const auto& each : frame->topics)
      if (each->name() == "/rover1/counter/count") {
        ++published;
        EXPECT_EQ(frame->tick % 5, 0u);
        EXPECT_EQ(topic_cast<msg::UInt32>(each.get())->message.data, frame->tick / 5 + 1);
      }
  EXPECT_EQ(published, 2);
  std::vector<std::string> addresses;
  list_values(*simulation, "rover1", [&](const ValueEntry& entry) { addresses.push_back(entry.path); });
  EXPECT_EQ(std::count(addresses.begin(), addresses.end(), "rover1/counter/count.data"), 1);
  simulation->remove_observer(&frames);
}

TEST(ProgramTopics, AreState) {
  const auto whole = make(counted());
  advance(*whole, 12);
  for (const int threads : {1, 2, 4}) {
    const auto rest = restored(*whole, threads);
    ASSERT_TRUE(rest);
    EXPECT_EQ(rest->state_hash(), whole->state_hash());
    EXPECT_EQ(value(*rest, "rover1/counter/count.data"), 3);
    advance(*rest, 40);
    const auto other = restored(*whole);
    advance(*other, 40);
    EXPECT_EQ(rest->state_hash(), other->state_hash());
    EXPECT_EQ(value(*rest, "rover1/first.seen"), 10);
  }
}

/// The topic of the fifth step is of a time that has not come yet: such a snapshot is refused.
TEST(ProgramTopics, OfTheFutureAreRefusedInASnapshot) {
  const auto early = make(counted());
  auto& entry = first_program(*early);
  ByteWriter w;
  Programs::save(entry, w);
  const auto loads = [&](std::span<const std::byte> bytes, Time now) {
    ByteReader r(bytes);
    return Programs::load(entry, r, now) && r.remaining() == 0;
  };
  EXPECT_TRUE(loads(w.bytes(), Time::from_s(1)));
  advance(*early, 10);
  w.clear();
  Programs::save(entry, w);
  EXPECT_TRUE(loads(w.bytes(), Time::from_s(1)));
  EXPECT_FALSE(loads(w.bytes(), Time::from_s(0.05)));
  EXPECT_FALSE(loads(w.bytes().first(w.size() - 1), Time::from_s(1)));
}

TEST(ProgramTopics, LastWhenDevicesComeAndGo) {
  const auto simulation = make(counted());
  advance(*simulation, 10);
  model::DeviceDecl decl;
  decl.name = "second";
  decl.kind = "ground_truth";
  simulation->submit(LoadDeviceRequest{"rover1", decl});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->outcomes().front().status);
  EXPECT_EQ(value(*simulation, "rover1/counter/count.data"), 3);
  advance(*simulation, 9);
  EXPECT_EQ(value(*simulation, "rover1/counter/count.data"), 5);
  EXPECT_EQ(value(*simulation, "rover1/first.seen"), 4);
  EXPECT_EQ(value(*simulation, "rover1/first.fresh"), 4);
}

CommandRequest goal_at(double x, double sent_s = 7) {
  msg::PoseStamped message;
  message.header.stamp = Time::from_s(sent_s);
  message.header.frame_id = "map";
  message.pose.p.x = x;
  return {"rover1/goal", msg::PoseStamped::ros_type, command_bytes(message)};
}

model::Setup two_goers() {
  return with_programs({{"a", "goer", Node::map(), {}}, {"b", "goer", Node::map(), {}}});
}

TEST(ProgramInputs, AreSeenAtTheNextStepByAllThatReadThem) {
  const auto simulation = make(two_goers());
  advance(*simulation, 7);
  simulation->submit(goal_at(3));
  advance(*simulation, 1);  // the tick from 0.07 s to 0.08 s
  ASSERT_TRUE(simulation->outcomes().front().status) << simulation->outcomes().front().status.error().text();
  EXPECT_EQ(value(*simulation, "rover1/goal.pose.position.x"), 3);
  EXPECT_EQ(value(*simulation, "rover1/a.x"), 0) << "control steps are at 0.05 and 0.1 s";
  advance(*simulation, 2);
  for (const char* each : {"rover1/a.", "rover1/b."}) {
    EXPECT_EQ(value(*simulation, std::string(each) + "x"), 3);
    EXPECT_EQ(value(*simulation, std::string(each) + "came"), 0.07);
    EXPECT_EQ(value(*simulation, std::string(each) + "sent"), 7) << "the sender's stamp stays";
    EXPECT_EQ(value(*simulation, std::string(each) + "fresh"), 1);
  }
  advance(*simulation, 10);
  EXPECT_EQ(value(*simulation, "rover1/a.fresh"), 1) << "it is new once";
}

TEST(ProgramInputs, AreStateBeforeAndAfterTheyAreRead) {
  const auto whole = make(two_goers());
  const std::uint64_t before = whole->state_hash();
  advance(*whole, 11);
  whole->submit(goal_at(2));
  advance(*whole, 1);
  const auto unread = restored(*whole);
  ASSERT_TRUE(unread);
  EXPECT_EQ(unread->state_hash(), whole->state_hash());
  advance(*whole, 10), advance(*unread, 10);
  EXPECT_EQ(value(*unread, "rover1/a.x"), 2);
  EXPECT_EQ(unread->state_hash(), whole->state_hash());
  const auto read = restored(*whole);
  advance(*read, 10);
  EXPECT_EQ(value(*read, "rover1/b.fresh"), 1);
  // The same input gives the same hash, on several threads; another goal does not.
  const auto run = [&](double x, int threads) {
    const auto again = make(two_goers(), threads);
    EXPECT_EQ(again->state_hash(), before);
    advance(*again, 11);
    again->repeat(goal_at(x), {});
    advance(*again, 11);
    return again->state_hash();
  };
  EXPECT_EQ(run(2, 1), unread->state_hash());
  EXPECT_EQ(run(2, 2), unread->state_hash());
  EXPECT_NE(run(2.5, 1), unread->state_hash());
}

TEST(ProgramInputs, StayWhenDevicesCome) {
  const auto simulation = make(two_goers());
  simulation->submit(goal_at(2));
  advance(*simulation, 1);
  model::DeviceDecl decl;
  decl.name = "second";
  decl.kind = "ground_truth";
  simulation->submit(LoadDeviceRequest{"rover1", decl});
  advance(*simulation, 9);
  EXPECT_EQ(value(*simulation, "rover1/a.x"), 2);
  EXPECT_EQ(value(*simulation, "rover1/b.fresh"), 1);
}

TEST(ProgramInputs, RefuseWhatIsNoSuchMessage) {
  const auto simulation = make(two_goers());
  const auto refusal = [&](CommandRequest request) {
    simulation->submit(std::move(request));
    advance(*simulation, 1);
    const Status& status = simulation->outcomes().front().status;
    return status ? "" : status.error().text();
  };
  const std::uint64_t refused = simulation->refused_commands();
  CommandRequest twist = goal_at(1);
  twist.type = msg::Twist::ros_type;
  EXPECT_THAT(refusal(twist),
              HasSubstr("'/rover1/goal' takes geometry_msgs/msg/PoseStamped, not geometry_msgs/msg/Twist"));
  EXPECT_THAT(refusal(goal_at(NAN)), HasSubstr("not finite"));
  CommandRequest cut = goal_at(1);
  cut.bytes.pop_back();
  EXPECT_THAT(refusal(cut), HasSubstr("the bytes are no geometry_msgs/msg/PoseStamped"));
  CommandRequest other = goal_at(1);
  other.target = "rover1/goals";
  EXPECT_THAT(refusal(other), HasSubstr("there is no device 'rover1/goals'"));
  msg::PoseStamped message;
  message.header.frame_id.assign(most_input_bytes, 'x');
  EXPECT_THAT(refusal({"rover1/goal", msg::PoseStamped::ros_type, command_bytes(message)}),
              HasSubstr("at most 65536"));
  EXPECT_EQ(simulation->refused_commands(), refused + 5);
  EXPECT_EQ(value(*simulation, "rover1/goal.count"), 0);
}

TEST(ProgramInputs, HaveNamesAndTypesOfTheirOwn) {
  const auto error_of = [](std::vector<model::ControllerDecl> programs, const char* device = nullptr) {
    model::Setup setup = with_programs(std::move(programs));
    if (device) {
      model::DeviceDecl decl;
      decl.name = device;
      decl.kind = "ground_truth";
      setup.instances.back().devices.push_back(decl);
    }
    const auto made = try_build(std::move(setup));
    return made ? "" : made.error().text();
  };
  const model::ControllerDecl reader{"reader", "goer", Node::map(), {}},
      named{"goal", "dice", Node::map(), {}}, other{"other", "speeder", Node::map(), {}};
  const char* const twice =
      "'rover1/reader' reads the topic '/rover1/goal', which is also the name of a device or program";
  EXPECT_THAT(error_of({reader, named}), HasSubstr(twice));
  EXPECT_THAT(error_of({named, reader}), HasSubstr(twice));
  EXPECT_THAT(error_of({reader}, "goal"), HasSubstr(twice));
  EXPECT_EQ(error_of({reader}, "goals"), "");
  EXPECT_THAT(error_of({{"goal", "goer", Node::map(), {}}}),
              HasSubstr("which is also the name of a device or program"));
  EXPECT_THAT(
      error_of({reader, other}),
      HasSubstr(
          "'rover1/other' reads the topic '/rover1/goal' as geometry_msgs/msg/Twist, 'rover1/reader' as "
          "geometry_msgs/msg/PoseStamped"));
}

TEST(ProgramTopics, ErrorsNameWhatIsWrong) {
  const auto error_of = [](model::Setup setup) {
    const auto made = try_build(std::move(setup));
    return made ? "" : made.error().text();
  };
  EXPECT_THAT(error_of(with_programs({{"odd", "misnamed", Node::map(), {}}})),
              HasSubstr("'a b' cannot be the name of a topic"));
  // A program reads those before it.
  EXPECT_THAT(error_of(with_programs({{"first", "follower", map({{"counter", "counter/count"}}), {}},
                                      {"counter", "counter", Node::map(), {}}})),
              HasSubstr("has no reading 'counter/count'"));
  EXPECT_THAT(error_of(with_programs({{"counter", "counter", Node::map(), {}},
                                      {"first", "follower", map({{"counter", "counter/cuont"}}), {}}})),
              HasSubstr("did you mean 'counter/count'"));
}

// ---------------------------------------------------------------------------------------------------- requests

TEST(ProgramSamples, AreTakenInTheNextTickAndLogged) {
  model::Setup setup = with_programs({{"sampler", "sampler", Node::map(), {}}});
  for (model::DeviceDecl& decl : setup.instances.back().devices.edit())
    if (decl.name == "truth") decl.config = map({{"rate", "0.1"}});
  const auto simulation = make(setup);
  Frames frames;
  simulation->add_observer(&frames);
  const auto samples = [&] { return simulation->find_topic("rover1/truth")->count; };
  EXPECT_EQ(samples(), 1u);  // tick 0
  advance(*simulation, 10);  // the third step is at tick 10
  EXPECT_EQ(samples(), 1u);
  const auto half = simulation->snapshot();
  advance(*simulation, 1);
  EXPECT_EQ(samples(), 2u);
  const LogEntry& entry = frames.kept.back()->log.at(0);
  EXPECT_STREQ(request_kind(entry.kind), "sample");
  EXPECT_EQ(entry.target, "rover1/truth");
  EXPECT_EQ(entry.source.kind, Source::Kind::program);
  EXPECT_FALSE(entry.refused);
  advance(*simulation, 29);
  EXPECT_EQ(samples(), 3u);
  // The request is State, and the log alone does the same.
  Diagnostics diagnostics;
  auto rest = Simulation::restore(half, {.extra_controllers = kinds}, diagnostics);
  ASSERT_TRUE(rest);
  advance(**rest, 30);
  EXPECT_EQ((*rest)->state_hash(), simulation->state_hash());
  auto logged = Simulation::create(setup, {.run_programs = false, .extra_controllers = kinds}, diagnostics);
  ASSERT_TRUE(logged);
  for (const auto& frame : frames.kept) {
    for (const LogEntry& each : frame->log) {
      ByteReader r(each.bytes);
      Request request;
      ASSERT_TRUE(read_request(r, request));
      (*logged)->submit(std::move(request), each.source);
    }
    advance(**logged, 1);
  }
  EXPECT_EQ((*logged)->find_topic("rover1/truth")->count, 3u);
  simulation->remove_observer(&frames);
}

// ------------------------------------------------------------------------------------------------------- rates

TEST(ProgramRates, StepsFallOnTheFirstTickNotBeforeTheirTimes) {
  // Step k is due at floor(k 1e9 / rate) ns. With 30 Hz and ticks of 10 ms: 0, 33.3, 66.6 ms ... fall on ticks 0, 4, 7, 10.
  const auto simulation = make(with_programs({{"fast", "counter", map({{"rate", "30"}}), {}},
                                              {"slow", "counter", map({{"rate", "4 Hz"}}), {}},
                                              {"plain", "counter", Node::map(), {}}}));
  for (int tick = 0; tick <= 100; ++tick) {
    int fast = 0;
    while (due_time({}, fast, 30).ns <= tick * 10'000'000) ++fast;
    ASSERT_EQ(value(*simulation, "rover1/fast.steps"), fast) << "tick " << tick;
    EXPECT_EQ(value(*simulation, "rover1/slow.steps"), tick / 25 + 1);
    EXPECT_EQ(value(*simulation, "rover1/plain.steps"), tick / 5 + 1);
    advance(*simulation, 1);
  }
}

TEST(ProgramRates, AreState) {
  const auto whole = make(with_programs({{"fast", "counter", map({{"rate", "30"}}), {}}}));
  advance(*whole, 15);
  const auto rest = restored(*whole, 2);
  for (int i = 0; i < 50; ++i) {
    advance(*whole, 1);
    advance(*rest, 1);
    ASSERT_EQ(rest->state_hash(), whole->state_hash()) << whole->tick_index();
  }
  // A step that no run can have reached is refused.
  auto& entry = first_program(*whole);
  entry.schedule->step = 1000;
  ByteWriter w;
  Programs::save(entry, w);
  ByteReader r(w.bytes());
  EXPECT_FALSE(Programs::load(entry, r, whole->now()));
}

/// The times of a robot that comes later count from then, also in a restored run.
TEST(ProgramRates, OfARobotThatComesCountFromThen) {
  const auto whole = make(with_programs({{"fast", "counter", map({{"rate", "30"}}), {}}}));
  model::Instance late = whole->entities().back()->instance;
  late.name = late.original_name = "late";
  late.X_WM.p.y += 1;
  advance(*whole, 12);
  whole->submit(SpawnRequest{late});
  advance(*whole, 3);
  ASSERT_TRUE(whole->find_instance("late"));
  const auto rest = restored(*whole, 2);
  // It came at 0.12 s: steps at 0.12, 0.1533 and 0.1866 s fall on the ticks 13, 16 and 19.
  for (const auto& [tick, steps] : {std::pair(15, 1), {16, 2}, {18, 2}, {19, 3}}) {
    advance(*whole, tick - static_cast<int>(whole->tick_index()));
    advance(*rest, tick - static_cast<int>(rest->tick_index()));
    EXPECT_EQ(value(*whole, "late/fast.steps"), steps) << tick;
    EXPECT_EQ(rest->state_hash(), whole->state_hash()) << tick;
  }
  advance(*whole, 40);
  advance(*rest, 40);
  EXPECT_EQ(rest->state_hash(), whole->state_hash());
}

TEST(ProgramRandom, IsAFunctionOfSeedProgramAndStep) {
  const auto simulation = make(with_programs({{"dice", "dice", Node::map(), {}}}));
  for (std::uint64_t step = 0; step < 3; ++step) {
    const std::uint64_t key = first_program(*simulation).key;
    EXPECT_EQ(value(*simulation, "rover1/dice.thrown"),
              Stream(simulation->setup().seed, key, Purpose::controller, step).uniform());
    advance(*simulation, 5);
  }
}

TEST(ProgramOrders, AreLoggedWithTheirStepAndWhetherTheyWereRefused) {
  const auto simulation = make(with_programs({{"driver", "driver", Node::map(), {}}}));
  Frames frames;
  simulation->add_observer(&frames);
  advance(*simulation, 5);
  simulation->submit(
      CommandRequest{"rover1/drive", msg::Twist::ros_type, command_bytes(msg::Twist{{0.2, 0, 0}, {}})});
  advance(*simulation, 1);
  const auto order_of = [&](std::size_t frame) {
    for (const LogEntry& entry : frames.kept.at(frame)->log)
      if (entry.source.kind == Source::Kind::program) return entry;
    return LogEntry{};
  };
  EXPECT_EQ(order_of(0).sequence, 1u);
  EXPECT_FALSE(order_of(0).refused);
  EXPECT_EQ(order_of(5).sequence, 2u);
  EXPECT_TRUE(order_of(5).refused) << "somebody drives by hand";
  EXPECT_EQ(order_of(5).target.substr(0, 12), "rover1/drive");
  simulation->remove_observer(&frames);
}

TEST(ProgramRates, AboveTheTickRateIsAnErrorAtItsLine) {
  Node config = Node::map();
  config.set("rate", Node::scalar("200 Hz", {std::make_shared<const std::string>("s.yaml"), 7, 20}));
  const auto made = try_build(with_programs({{"fast", "counter", config, {}}}));
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().text(),
              HasSubstr("s.yaml:7:20: /rate: rate 200 Hz is above the tick rate of 100 Hz"));
}

}  // namespace
}  // namespace sandlot::test
