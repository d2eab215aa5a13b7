/// The tick: due times, order of requests, levels, parameters, rules, media, failures, heap.
#include "sim/world/simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "messages/messages.h"
#include "sim/test_log.h"
#include "sim/test_world.h"
#include "sim/watch/values.h"

namespace sandlot::test {
namespace {

/// A device of the tests' own: counts its samples, emits one byte each time, can push its body to infinity.
struct Probe {
  struct Spec {
    double rate_hz = 0;
    bool explode = false;
    double force_N = 0;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"rate", "Hz", "Samples per second; 0: every tick.", 0, 1e5, Field::tunable}, s.rate_hz);
      visit(Field{"force", "N", "Push sideways.", 0, 1e308, Field::tunable}, s.force_N);
      visit(Field{"explode", "", "Push with a force that is not finite.", 0, 1, Field::tunable}, s.explode);
    }
  };
  struct State {
    double sum_since_s = 0;
    static void fields(auto& s, auto&& visit) { visit(Field{"sum", "s", ""}, s.sum_since_s); }
  };
  Spec spec;
  State state;
  BodyId body;
  std::uint64_t key = 0;
  Topic<msg::Int64Stamped>* count = nullptr;
  Topic<msg::Float64>* gain = nullptr;
  Topic<msg::Float64>* trim = nullptr;

  static Result<Probe> create(const DeviceBuild& build, Spec spec) {
    return Probe{spec,
                 {},
                 build.body(),
                 build.key,
                 build.publish<msg::Int64Stamped>(0, "count"),
                 build.accept<msg::Float64>(0, "count"),
                 build.accept<msg::Float64>(1, "other")};
  }
  static void actuate(PoolView<Probe> pool, const Context& ctx) {
    for (const std::uint32_t i : pool.due)
      if (const double f = pool.all[i].spec.force_N; f > 0)
        ctx.actuation.wrenches.push_back({pool.all[i].body, {f, f, -f}, {f, 0, 0}});
      else if (pool.all[i].spec.explode)
        ctx.actuation.wrenches.push_back(
            {pool.all[i].body, {std::numeric_limits<double>::quiet_NaN(), 0, 0}, {}});
  }
  static void sense(PoolView<Probe> pool, const Context& ctx) {
    for (const std::uint32_t i : pool.due) {
      Probe& probe = pool.all[i];
      probe.count->message.data = static_cast<std::int64_t>(pool.sample[i]);
      probe.count->publish(ctx.now);
      probe.state.sum_since_s += pool.since[i].s();
    }
  }
};
constexpr LevelInfo probe_levels[] = {
    {"count", "sandlot_msgs/msg/Int64Stamped", "std_msgs/msg/Float64", "Counts."},
    {"other", "", "std_msgs/msg/Float64", "Takes another command."}};
const Kind probe_kind = make_kind<Probe>({.name = "probe", .help = "For tests.", .levels = probe_levels});
const Kind* const probe_kinds[] = {&probe_kind};
const SimulationOptions with_probe{.threads = 1, .run_programs = true, .extra_kinds = probe_kinds};

model::Instance probed(const std::string& name, const Node& config, Vec3 at = {0, 0, 5}) {
  model::Instance instance = placed(name, one_shape("ball", Sphere{0.1}, 1), {at, {}});
  model::DeviceDecl decl;
  decl.name = "probe";
  decl.kind = "probe";
  decl.config = config;
  instance.devices.push_back(decl);
  return instance;
}

model::Setup one_probe(const Node& config, double step_s = 0.01) {
  model::Setup setup;
  setup.step = Time::from_s(step_s);
  setup.instances.push_back(probed("ball", config));
  return setup;
}

std::string error_with_probe(model::Setup setup) {
  Diagnostics diagnostics;
  const auto made = Simulation::create(std::move(setup), with_probe, diagnostics);
  return made ? "" : made.error().text();
}

TEST(Build, ASetupThatNoTickCanFollowIsRefused) {
  const auto refused = [](auto&& spoil) {
    model::Setup setup = arena("planar", 1);
    spoil(setup);
    Diagnostics diagnostics;
    const auto made = Simulation::create(std::move(setup), {}, diagnostics);
    return made ? std::string() : made.error().what;
  };
  EXPECT_EQ(refused([](model::Setup&) {}), "");
  EXPECT_NE(refused([](model::Setup& s) { s.control_interval = 0; }), "");
  EXPECT_NE(refused([](model::Setup& s) { s.substeps = 0; }), "");
  EXPECT_NE(refused([](model::Setup& s) { s.step = {}; }), "");
}

TEST(Due, TheFirstSampleIsTakenAtTimeZeroAndTheKthAtTheFirstTickNotBeforeKOverRate) {
  Diagnostics diagnostics;
  auto made = Simulation::create(one_probe(map({{"rate", "3"}})), with_probe, diagnostics);
  ASSERT_TRUE(made);
  EXPECT_EQ(diagnostics.warnings.size(), 1u) << "3 Hz does not divide 100 Hz: said once";
  Simulation& simulation = **made;
  const TopicBase* const topic = simulation.find_topic("/ball/probe/count");
  ASSERT_TRUE(topic);
  std::vector<double> stamps{topic->stamp.s()};
  EXPECT_EQ(topic->count, 1u);
  for (int i = 0; i < 1000; ++i) {
    advance(simulation, 1);
    if (topic->stamp == simulation.now()) stamps.push_back(topic->stamp.s());
  }
  ASSERT_EQ(stamps.size(), 31u);  // k = 0..30 fall into [0, 10] s
  for (std::size_t k = 0; k < stamps.size(); ++k)
    EXPECT_NEAR(stamps[k], std::ceil(static_cast<double>(k) / 3 * 100 - 1e-9) / 100, 1e-12) << k;
}

TEST(Due, ARateEqualToTheTickRateSamplesEveryTickAndOneAboveItIsRefused) {
  const auto simulation = build(one_probe(map({{"rate", "100"}})), with_probe);
  advance(*simulation, 50);
  EXPECT_EQ(simulation->find_topic("ball/probe")->count, 51u);
  EXPECT_NE(error_with_probe(one_probe(map({{"rate", "101"}}))).find("above the tick rate"),
            std::string::npos);
}

TEST(Due, ARequestTakesOneSampleMore) {
  const auto simulation = build(one_probe(map({{"rate", "1"}})), with_probe);
  advance(*simulation, 10);
  EXPECT_EQ(simulation->find_topic("ball/probe")->count, 1u);
  simulation->submit(SampleRequest{"ball/probe"});
  advance(*simulation, 10);
  EXPECT_EQ(simulation->find_topic("ball/probe")->count, 2u);
}

TEST(Build, ErrorsNameWhatThereIs) {
  auto setup = one_probe(Node::map());
  setup.instances[0].devices[0].kind = "prob";
  EXPECT_NE(error_with_probe(setup).find("did you mean 'probe'"), std::string::npos)
      << error_with_probe(setup);
  setup = one_probe(map({{"rat", "1"}}));
  EXPECT_NE(error_with_probe(setup).find("did you mean 'rate'"), std::string::npos)
      << error_with_probe(setup);
  setup = one_probe(map({{"level", "cuont"}}));
  EXPECT_NE(error_with_probe(setup).find("did you mean 'count'"), std::string::npos)
      << error_with_probe(setup);
  setup = one_probe(Node::map());
  setup.engine = "rigit";
  EXPECT_NE(error_with_probe(setup).find("did you mean 'rigid'"), std::string::npos)
      << error_with_probe(setup);
  setup = one_probe(Node::map());
  setup.instances.push_back(setup.instances[0]);
  EXPECT_NE(error_with_probe(setup).find("two things named 'ball'"), std::string::npos);
  setup = one_probe(Node::map());
  setup.instances[0].devices.push_back(setup.instances[0].devices[0]);
  EXPECT_NE(error_with_probe(setup).find("two devices named 'probe'"), std::string::npos);
  setup = one_probe(Node::map());
  setup.instances[0].controllers.push_back({"controller", "wandr", Node::map(), {}});
  EXPECT_NE(error_with_probe(setup).find("did you mean 'wander'"), std::string::npos);
}

std::vector<std::byte> bytes_of(double x) {
  ByteWriter w;
  write(w, msg::Float64{x});
  return {w.bytes().begin(), w.bytes().end()};
}

TEST(Requests, AdministratorsGoFirstThenRobotsThenSequence) {
  const auto simulation = build(one_probe(Node::map()), with_probe);
  struct Log : Observer {
    std::vector<double> given;
    Wants wants() const override { return {.log = true}; }
    void on_frame(const std::shared_ptr<const Frame>& frame) override {
      for (const LogEntry& command : frame->log) {
        double x = 0;
        std::memcpy(&x, command.bytes.data(), 8);
        given.push_back(x);
      }
    }
  } log;
  simulation->add_observer(&log);
  const auto give = [&](double x, Source source) {
    simulation->submit(CommandRequest{"ball/probe", "std_msgs/msg/Float64", bytes_of(x)}, source);
  };
  give(4, {Source::Kind::robot, 9});
  give(3, {Source::Kind::robot, 2});
  give(1, {Source::Kind::admin, 5});
  give(5, {Source::Kind::robot, 9});
  give(2, {Source::Kind::admin, 5});
  advance(*simulation, 1);
  EXPECT_EQ(log.given, (std::vector<double>{1, 2, 3, 4, 5}));
}

TEST(Requests, CommandsOfAnInactiveLevelAreRefusedUntilItIsSwitchedOn) {
  const auto simulation = build(one_probe(Node::map()), with_probe);
  const auto give = [&] {
    simulation->submit(CommandRequest{"ball/probe/other", "std_msgs/msg/Float64", bytes_of(1)});
    advance(*simulation, 1);
    return static_cast<bool>(simulation->outcomes().back().status);
  };
  EXPECT_FALSE(give());
  EXPECT_EQ(simulation->refused_commands(), 1u);
  const auto before = simulation->revision();
  simulation->submit(LevelRequest{"ball/probe", {"count", "other"}});
  EXPECT_TRUE(give());
  EXPECT_EQ(simulation->revision(), before + 1);
  simulation->submit(LevelRequest{"ball/probe", {"othr"}});
  advance(*simulation, 1);
  ASSERT_FALSE(simulation->outcomes().back().status);
  EXPECT_NE(simulation->outcomes().back().status.error().text().find("did you mean 'other'"),
            std::string::npos);
}

TEST(Requests, ACommandThatIsNoNumberIsRefusedAndLeavesNoTraceInTheState) {
  const auto simulation = build(arena("planar", 1));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    msg::Twist twist;
    twist.angular.z = bad;
    ByteWriter w;
    write(w, twist);
    simulation->submit(CommandRequest{"rover1/drive", "geometry_msgs/msg/Twist", w.buffer()});
    advance(*simulation, 1);
    ASSERT_FALSE(simulation->outcomes().back().status);
    EXPECT_EQ(simulation->outcomes().back().status.error().what, "the command is not finite");
    auto held = NamedValue::find(*simulation, "rover1/drive/ideal/command.angular.z");
    ASSERT_TRUE(held);
    EXPECT_TRUE(std::isfinite(held->read().value_or(0)));
  }
}

TEST(Requests, WhoDrivesFromOutsideIsNotDisturbedByTheRobotsControllerForHalfASecond) {
  const auto simulation = build(arena("planar", 1));
  advance(*simulation, 100);
  const auto speed = [&](const Simulation& of) {
    auto value = NamedValue::find(of, "rover1/drive/ideal/command.linear.x");
    return value ? value->read().value_or(-1) : -2;
  };
  msg::Twist twist;
  twist.linear.x = 0.0625;
  ByteWriter w;
  write(w, twist);
  simulation->submit(CommandRequest{"rover1/drive", "geometry_msgs/msg/Twist", w.buffer()});
  const std::uint64_t refused = simulation->refused_commands();
  std::vector<std::byte> between;
  for (int tick = 0; tick < 50; ++tick) {
    if (tick == 20) between = simulation->snapshot();
    advance(*simulation, 1);
    ASSERT_EQ(speed(*simulation), 0.0625) << tick;
  }
  EXPECT_GT(simulation->refused_commands(), refused);
  const int steps = simulation->setup().control_interval;
  advance(*simulation, steps);
  EXPECT_NE(speed(*simulation), 0.0625) << "the controller is heard again";
  const std::uint64_t hash = simulation->state_hash();
  Diagnostics diagnostics;
  const auto restored = Simulation::restore(between, {}, diagnostics);
  ASSERT_TRUE(restored);
  advance(**restored, 30 + steps);
  EXPECT_EQ((*restored)->state_hash(), hash);
}

TEST(Requests, WrongTargetsTypesAndBytesAreAnsweredAndChangeNothing) {
  const auto simulation = build(one_probe(Node::map()), with_probe),
             untouched = build(one_probe(Node::map()), with_probe);
  simulation->submit(CommandRequest{"ball/prob", "std_msgs/msg/Float64", bytes_of(1)});
  simulation->submit(CommandRequest{"ball/probe", "geometry_msgs/msg/Twist", bytes_of(1)});
  simulation->submit(CommandRequest{"ball/probe", "std_msgs/msg/Float64", {std::byte{1}}});
  simulation->submit(ParameterRequest{"ball/probe", "rat", Node::scalar("1")});
  simulation->submit(ParameterRequest{"ball/probe", "rate", Node::scalar("fast")});
  simulation->submit(DeleteRequest{"bal"});
  simulation->submit(PoseRequest{"ball", {{std::numeric_limits<double>::quiet_NaN(), 0, 0}, {}}});
  advance(*simulation, 1);
  advance(*untouched, 1);
  ASSERT_EQ(simulation->outcomes().size(), 7u);
  for (const Outcome& outcome : simulation->outcomes()) EXPECT_FALSE(outcome.status);
  EXPECT_EQ(by_path(*simulation), by_path(*untouched));
}

TEST(Requests, ATunableParameterTakesEffectAtTheNextTick) {
  const auto simulation = build(one_probe(map({{"rate", "1"}})), with_probe);
  simulation->submit(ParameterRequest{"ball/probe", "rate", Node::scalar("50 Hz")});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->outcomes().back().status);
  const auto before = simulation->find_topic("ball/probe")->count;
  advance(*simulation, 100);
  EXPECT_NEAR(static_cast<double>(simulation->find_topic("ball/probe")->count - before), 50, 1);
  // The changed value is State: it survives a restore. (Restoring needs the kind too.)
  Diagnostics diagnostics;
  auto restored = Simulation::restore(simulation->snapshot(), with_probe, diagnostics);
  ASSERT_TRUE(restored) << restored.error().text();
  EXPECT_EQ((*restored)->state_hash(), simulation->state_hash());
}

TEST(Requests, APoseRequestMovesAnInstance) {
  const auto simulation = build(one_probe(Node::map()), with_probe);
  simulation->submit(PoseRequest{"ball", {{3, 4, 50}, {}}});
  advance(*simulation, 1);
  const Pose pose = simulation->engine().pose(*simulation->find_instance("ball"));
  EXPECT_NEAR(pose.p.x, 3, 1e-9);
  EXPECT_NEAR(pose.p.z, 50, 0.01);  // fell for one tick
}

TEST(Requests, AVelocityRequestMovesWhatMoves) {
  const auto simulation = build(arena("rigid", 1, ""));
  const auto refused = [&](Request request) {
    simulation->submit(std::move(request));
    advance(*simulation, 1);
    const Status& status = simulation->outcomes().front().status;
    return status ? std::string() : status.error().what;
  };
  EXPECT_EQ(refused(VelocityRequest{"crate1", {{0, 0, 3}, {}}}), "");
  // Thrown up at 3 m/s, and fallen for one tick of 10 ms; its middle is its model's origin.
  const auto body = simulation->engine().bodies(*simulation->find_instance("crate1")).front();
  EXPECT_NEAR(simulation->engine().states()[body.index].V_WB.linear.z, 3 - 9.81 * 0.01, 1e-3);
  EXPECT_EQ(refused(VelocityRequest{"pillar1", {{1, 0, 0}, {}}}), "'pillar1' never moves");
  EXPECT_EQ(refused(VelocityRequest{"crate1", {{1e5, 0, 0}, {}}}), "the velocity is out of range");
  EXPECT_EQ(refused(VelocityRequest{"crate1", {{std::numeric_limits<double>::quiet_NaN(), 0, 0}, {}}}),
            "the velocity is out of range");
  EXPECT_NE(refused(VelocityRequest{"nobody", {}}), "");
}

/// Descriptions are in snapshots, with the poses and the topics that the scenario names, and change no hash.
TEST(Requests, ADescriptionIsKeptAndChangesNothing) {
  model::Setup setup = arena("planar", 1, "");
  setup.poses.push_back({"dock", {{1, 2, 0}, {}}, "by the door", {"parking"}, Vec3{1, 2, 3}});
  setup.sharing.topics.push_back({"/rover1/*", {}});
  setup.sharing.spectators = model::Sharing::Spectators::topics;
  const auto told = build(setup), other = build(setup);
  told->submit(InfoRequest{"crate1", {model::Category::object, "a crate", {"red", "heavy"}}});
  advance(*told, 5);
  advance(*other, 5);
  EXPECT_EQ(told->state_hash(), other->state_hash());
  const auto restored = again(*told);
  const model::EntityInfo& info = std::as_const(*restored).find_entity("crate1")->instance.info;
  EXPECT_EQ(info.category, model::Category::object);
  EXPECT_EQ(info.description, "a crate");
  EXPECT_EQ(info.tags, (std::vector<std::string>{"red", "heavy"}));
  ASSERT_EQ(restored->setup().poses.size(), 1u);
  EXPECT_EQ(restored->setup().poses[0].X_WP.p.y, 2);
  EXPECT_EQ(restored->setup().poses[0].size_m->z, 3);
  EXPECT_TRUE(restored->setup().sharing.has("/rover1/laser/ranges"));
  EXPECT_FALSE(restored->setup().sharing.has("/rover2/laser/ranges"));
  EXPECT_EQ(restored->setup().sharing.spectators, model::Sharing::Spectators::topics);
}

TEST(Failure, AStateThatIsNotFiniteEndsTheRunAndNamesTheBody) {
  const auto simulation = build(one_probe(Node::map()), with_probe);
  advance(*simulation, 3);
  simulation->submit(ParameterRequest{"ball/probe", "explode", Node::scalar("true")});
  const Status status = simulation->tick();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().text().find("ball"), std::string::npos) << status.error().text();
  EXPECT_TRUE(simulation->stop_reason());
  EXPECT_FALSE(simulation->tick()) << "a failed run does not go on";
}

TEST(Failure, AWorldThatExplodesKeepsTheStateOfBeforeAndCanBeSaved) {
  auto setup = one_probe(Node::map());
  setup.physics = map({{"max_speed", "3"}});
  const auto simulation = build(setup, with_probe);
  // v = g t passes 3 m/s after 0.306 s: in the 31st tick.
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(simulation->tick()) << i;
  const std::uint64_t hash = simulation->state_hash();
  const Status status = simulation->tick();
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().what.find("'ball/link' has exploded"), std::string::npos) << status.error().what;
  EXPECT_NE(status.error().what.find("between 0.3 s and 0.31 s"), std::string::npos) << status.error().what;
  EXPECT_EQ(simulation->tick_index(), 30u);
  EXPECT_EQ(simulation->now(), Time::from_s(0.3));
  EXPECT_EQ(simulation->state_hash(), hash);
  Diagnostics diagnostics;
  const auto again = Simulation::restore(simulation->snapshot(), with_probe, diagnostics);
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_FALSE((*again)->tick()) << "it explodes again";
}

TEST(Surfaces, ZonesAndTheRuleOfAProgramReachTheEngine) {
  for (const bool hole : {false, true}) {
    model::Setup setup;
    setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {}));
    setup.instances.push_back(placed("ball", one_shape("ball", Sphere{0.1}, 1), {{0, 0, 0.1}, {}}));
    SimulationOptions options{.threads = 1};
    if (hole) {
      setup.zones.push_back({"hole", {}, {}, 1, {}, {}});
      setup.zones[0].surface.touches = false;
    } else {
      options.contact_rule = [](const ContactSide& a, const ContactSide& b, Vec3, Vec3, PairSurface& pair) {
        EXPECT_EQ(a.instance, "ground");
        EXPECT_EQ(b.link.name, "link");
        pair.touches = false;
      };
    }
    const auto simulation = build(setup, options);
    advance(*simulation, 50);
    EXPECT_LT(simulation->engine().pose(simulation->entities()[1]->id).p.z, -0.9) << hole;
  }
}

TEST(Failure, ForcesBeyondAllBoundsEndTheRunToo) {
  for (const double force_N : {1e30, 1e150, 1e300}) {
    auto setup = one_probe(Node::map());
    setup.instances.push_back(placed("ground", one_shape("ground", Plane{{0, 0, 1}}, 0), {{0, 0, 4.9}, {}}));
    const auto simulation = build(setup, with_probe);
    advance(*simulation, 3);
    simulation->submit(ParameterRequest{"ball/probe", "force", Node::scalar(std::to_string(force_N))});
    Status status;
    for (int i = 0; i < 10 && status; ++i) status = simulation->tick();
    ASSERT_FALSE(status) << force_N;
    EXPECT_NE(status.error().text().find("ball"), std::string::npos) << status.error().text();
  }
}

TEST(Rules, TheRunStopsWhenItsTimeIsUp) {
  auto setup = one_probe(Node::map());
  setup.stop = Time::from_s(0.5);
  const auto simulation = build(setup, with_probe);
  int ticks = 0;
  while (!simulation->stop_reason()) advance(*simulation, 1), ++ticks;
  EXPECT_EQ(ticks, 50);
}

TEST(Levels, ADriveKeepsItsPlaceWhenItsLevelIsSwitched) {
  const auto simulation = build(arena("rigid", 1));
  advance(*simulation, 100);
  const auto id = *simulation->find_instance("rover1");
  const Vec3 before = simulation->engine().pose(id).p;
  simulation->submit(LevelRequest{"rover1/drive", {"contact"}});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->outcomes().back().status) << simulation->outcomes().back().status.error().text();
  EXPECT_LT(norm(simulation->engine().pose(id).p - before), 0.02);
  advance(*simulation, 200);
  EXPECT_GT(norm(simulation->engine().pose(id).p - before), 0.2)
      << "the controller drives on at the new level";
  EXPECT_EQ(simulation->refused_commands(), 0u);
  // And it is all in the State.
  const auto restored = again(*simulation);
  advance(*simulation, 50);
  advance(*restored, 50);
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
}

TEST(Levels, PlanarDrivesByContact) {
  auto setup = arena("planar", 1);
  for (auto& device : setup.instances.back().devices)
    if (device.kind == "diff_drive") device.config.set("level", Node::scalar("contact"));
  EXPECT_EQ(error_with_probe(setup), "");
}

/// Every kind of request once, as the log carries it.
std::vector<Request> all_requests() {
  const model::Setup setup = arena("planar", 1);
  Node value = Node::map();
  value.set("gaussian", Node::scalar("1 cm"));
  return {CommandRequest{"rover1/drive/ideal", "geometry_msgs/msg/Twist", bytes_of(1)},
          ParameterRequest{"rover1/laser", "noise", value},
          LevelRequest{"rover1/drive", {"ideal", "contact"}},
          SpawnRequest{setup.instances.back()},
          DeleteRequest{"crate1"},
          PoseRequest{"rover1", {{1, 2, 3}, quat_from_rpy(0.1, 0.2, 0.3)}},
          SampleRequest{"rover1/laser"},
          LoadDeviceRequest{"rover1", setup.instances.back().devices[0]},
          UnloadDeviceRequest{"rover1/laser"},
          PullRequest{"rover1", "base_link", {0.1, 0.2, 0.3}, {4, 5, 6}, Time::from_s(0.5)},
          AnswerRequest{"rover1/brain", {OutsideAnswer::Kind::gone, bytes_of(2)}},
          CallRequest{"rover1/odometry", "reset", bytes_of(1)},
          VelocityRequest{"rover1", {{1, 2, 3}, {4, 5, 6}}},
          InfoRequest{"rover1", {model::Category::human, "a walker", {"tall", "slow"}}}};
}

TEST(Requests, EachKindSurvivesBeingBytes) {
  const std::vector<Request> requests = all_requests();
  ASSERT_EQ(requests.size(), std::variant_size_v<Request>);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    ASSERT_EQ(requests[i].index(), i) << "one of each, in order";
    ByteWriter w, again;
    write_request(w, requests[i]);
    ByteReader r(w.bytes());
    Request read_back;
    ASSERT_TRUE(read_request(r, read_back)) << request_kind(i);
    EXPECT_EQ(read_back.index(), i);
    EXPECT_EQ(request_target(read_back), request_target(requests[i]));
    write_request(again, read_back);
    EXPECT_TRUE(std::ranges::equal(again.bytes(), w.bytes())) << request_kind(i);
    for (std::size_t cut = 0; cut < w.size(); cut += 1 + cut / 4) {
      ByteReader torn(w.bytes().first(cut));
      EXPECT_FALSE(read_request(torn, read_back)) << request_kind(i) << " cut at " << cut;
    }
  }
}

TEST(Requests, TheLogOfARunRepeatsItWithEverythingThatWasAskedOfIt) {
  TickLog live, repeated;
  const auto original = build(arena("planar", 2));
  original->add_observer(&live);
  model::Instance guest = arena("planar", 1).instances.back();
  guest.name = "guest";
  guest.X_WM = {{3, 3, 0}, {}};
  for (int tick = 0; tick < 150; ++tick) {
    if (tick == 20) original->submit(SpawnRequest{guest});
    if (tick == 40) original->submit(PoseRequest{"rover1", {{-3, 3, 0}, {}}});
    if (tick == 50) original->submit(ParameterRequest{"guest/laser", "noise/white", Node::scalar("5 cm")});
    if (tick == 60) original->submit(DeleteRequest{"rover2"});
    if (tick == 61) original->submit(DeleteRequest{"rover2"});  // refused: it is gone
    if (tick == 70) original->submit(SampleRequest{"guest/laser"});
    if (tick == 80) original->submit(VelocityRequest{"crate1", {{1, 0.5, 0}, {0, 0, 2}}});
    if (tick == 90) original->submit(InfoRequest{"crate1", {model::Category::human, "", {"red"}}});
    advance(*original, 1);
  }
  const auto replay = build(arena("planar", 2));
  replay->add_observer(&repeated);
  std::size_t asked = 0, refused = 0;
  for (const auto& entries : live.ticks) {
    for (const LogEntry& entry : entries) {
      if (entry.source.kind == Source::Kind::program) continue;
      ++asked;
      refused += entry.refused;
      Request request;
      ByteReader r(entry.bytes);
      ASSERT_TRUE(read_request(r, request));
      replay->submit(std::move(request), entry.source);
    }
    advance(*replay, 1);
  }
  EXPECT_EQ(asked, 8u);
  EXPECT_EQ(refused, 1u);
  EXPECT_EQ(repeated.hashes, live.hashes);
  EXPECT_EQ(std::as_const(*replay).find_entity("crate1")->instance.info.tags,
            std::vector<std::string>{"red"});
}

TEST(Simulation, TicksLongerThanASamplingIntervalLoseSamplesAndDoNotPileThemUp) {
  model::Setup setup = arena("planar", 1);
  setup.clock.mode = model::Clock::Mode::continuous;
  for (auto& device : setup.instances.back().devices)
    if (device.name == "laser") device.config.set("rate", Node::scalar("20"));
  const auto simulation = build(setup);
  const TopicBase* const scan = simulation->find_topic("rover1/laser");
  ASSERT_TRUE(scan);
  const std::uint64_t before = scan->count;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation->tick(Time::from_s(0.1)));
  EXPECT_EQ(scan->count - before, 5u) << "one per tick: there are two intervals in each";
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(simulation->tick(Time::from_s(0.01)));
  EXPECT_EQ(scan->count - before, 15u) << "0.5 s at 20 Hz, none made up for";
}

}  // namespace
}  // namespace sandlot::test
