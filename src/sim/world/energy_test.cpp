/// Energy of robots in whole simulations: batteries, drains, chargers, the rule of empty robots.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "messages/cdr.h"
#include "messages/device_services.h"
#include "sim/world/test_movers.h"

namespace sandlot::test {
namespace {

using testing::HasSubstr;

/// robot1 of movers() with a battery and a sensor.
model::Setup powered(Node battery, Node eye, Node mover = {}, const char* engine = "planar") {
  model::Setup setup = movers(mover, 1, engine);
  model::Instance& robot = setup.instances.back();
  if (!eye.find("rate")) eye.set("rate", Node::scalar("10"));
  robot.devices.push_back(device("battery", "battery", std::move(battery)));
  robot.devices.push_back(device("eye", "ground_truth", std::move(eye)));
  return setup;
}

/// drained = sum of what all devices drew + lost, and energy = initial + charged - drained.
void expect_closed(const Simulation& simulation, const std::string& robot, double initial_J) {
  double drawn_J = 0;
  for (const auto& each : simulation.find_entity(robot)->devices) drawn_J += each->energy->state.drawn_J;
  const auto of = [&](const char* what) { return value(simulation, (robot + "/battery." + what).c_str()); };
  const double drained_J = of("drained");
  EXPECT_NEAR(drained_J, drawn_J + of("lost"), 1e-9 * std::abs(drained_J) + 1e-12) << robot;
  EXPECT_NEAR(of("energy"), initial_J + of("charged") - drained_J, 1e-9 * std::abs(drained_J) + 1e-12)
      << robot;
}

// -------------------------------------------------------------------------------------------------------------- drains

TEST(Battery, IsEmptyAfterItsCapacityOverTheDrain) {
  // 10 J / 2 W = 5 s, whatever the voltage does meanwhile: without an inner resistance nothing is lost.
  for (const bool sloped : {false, true}) {
    Node battery = map({{"capacity", "10 J"}});
    if (sloped) {
      Node curve = Node::sequence();
      for (const auto& [charge, volts] : {std::pair("0", "9"), {"0.3", "11"}, {"1", "12.6"}})
        curve.push(map({{"charge", charge}, {"voltage", volts}}));
      battery.set("curve", curve);
    }
    const auto simulation = build(powered(battery, map({{"drain", "2 W"}})));
    int ticks = 0;
    while (value(*simulation, "robot1/battery.empty") == 0 && ticks < 600) advance(*simulation, 1), ++ticks;
    EXPECT_NEAR(ticks, 500, 1);
    EXPECT_EQ(value(*simulation, "robot1/battery.energy"), 0);
    advance(*simulation, 550 - ticks);
    EXPECT_NEAR(value(*simulation, "robot1/eye.drawn"), 10, 1e-11);
    EXPECT_NEAR(value(*simulation, "robot1/eye.missing"), 2 * 0.5, 1e-9);
    EXPECT_NEAR(value(*simulation, "robot1/battery.missing"), 2 * 0.5, 1e-9);
    expect_closed(*simulation, "robot1", 10);
  }
}

TEST(Battery, LosesInItsResistanceWhatTheCurrentSquaredTakes) {
  // P = 9 W on 10 V behind 1 ohm: I = (10 - sqrt(100 - 36)) / 2 = 1 A, U = 9 V; 10 W leave it, 1 W is lost.
  const auto simulation = build(
      powered(map({{"capacity", "50 J"}, {"voltage", "10 V"}, {"resistance", "1"}, {"rate", "0"}}),
              map({{"drain", "9 W"}})));
  advance(*simulation, 100);
  EXPECT_NEAR(value(*simulation, "robot1/battery.voltage"), 9, 1e-6);
  EXPECT_NEAR(value(*simulation, "robot1/battery.current"), -1, 1e-6);
  EXPECT_NEAR(value(*simulation, "robot1/battery.energy"), 40, 1e-10);
  EXPECT_NEAR(value(*simulation, "robot1/battery.lost"), 1, 1e-12);
  EXPECT_NEAR(value(*simulation, "robot1/battery.percentage"), 0.8, 1e-7);
  EXPECT_NEAR(value(*simulation, "robot1/battery.charge"), 0.8 * 5 / 3600, 1e-9);  // 5 C = 50 J / 10 V
  EXPECT_EQ(value(*simulation, "robot1/battery.power_supply_status"), 2);
  expect_closed(*simulation, "robot1", 50);
}

TEST(Battery, DeliversNoMoreThanItsResistanceLetsOut) {
  // V^2 / 4R = 25 W of the 50 W that are wanted, at half the voltage.
  const auto simulation = build(powered(map({{"capacity", "1000 J"}, {"voltage", "10"}, {"resistance", "1"}}),
                                        map({{"drain", "50 W"}})));
  advance(*simulation, 100);
  EXPECT_NEAR(value(*simulation, "robot1/battery.terminal_voltage"), 5, 1e-12);
  EXPECT_NEAR(value(*simulation, "robot1/eye.drawn"), 25, 1e-10);
  EXPECT_NEAR(value(*simulation, "robot1/eye.missing"), 25, 1e-10);
  EXPECT_NEAR(value(*simulation, "robot1/battery.energy"), 950, 1e-9);
  EXPECT_EQ(value(*simulation, "robot1/battery.empty"), 0);
  expect_closed(*simulation, "robot1", 1000);
}

TEST(Battery, CountsItsChargeAsTheIntegralOfTheCurrent) {
  // Linear from 10 V to 12 V: 36 C at the mean of 11 V are 396 J. The current of a tick is that at its beginning: the sum is
  // off by about half the change of the voltage in a tick, 1e-4 of it.
  Node curve = Node::sequence();
  for (const auto& [charge, volts] : {std::pair("0", "10"), {"1", "12"}})
    curve.push(map({{"charge", charge}, {"voltage", volts}}));
  Node battery = map({{"charge_capacity", "10 mAh"}});
  battery.set("curve", curve);
  const auto simulation = build(powered(battery, map({{"drain", "20 W"}})));
  EXPECT_NEAR(value(*simulation, "robot1/battery.energy"), 396, 1e-9);
  double charge_C = 0;
  for (int i = 0; i < 1000; ++i) {
    advance(*simulation, 1);
    charge_C += value(*simulation, "robot1/battery.load_current") * 0.01;
  }
  // w = 10 s + s^2 = 11 - 200 / 36 for the charge s that is left.
  const double w = 11 - 200.0 / 36, s = -5 + std::sqrt(25 + w);
  EXPECT_NEAR(value(*simulation, "robot1/battery.fraction"), s, 1e-12);
  EXPECT_NEAR(value(*simulation, "robot1/battery.open_voltage"), 10 + 2 * s, 1e-11);
  EXPECT_NEAR(charge_C, 36 * (1 - s), 36 * 2e-4);
}

TEST(Drain, PerUseCountsCommandsOfActuatorsAndSamplesOfSensors) {
  Node mover = map({{"drain_per_use", "0.5 J"}, {"max_rate", "20"}});
  const auto simulation = build(
      powered(map({{"capacity", "100 J"}}), map({{"drain_per_use", "0.25 J"}}), mover));
  EXPECT_NEAR(value(*simulation, "robot1/eye.drawn"), 0.25, 1e-15) << "the sample of time 0";
  // One command per tick for 1 s, of which every fifth is taken: 20 Hz at ticks of 10 ms.
  for (int i = 0; i < 100; ++i) drive(*simulation, 0), advance(*simulation, 1);
  EXPECT_EQ(value(*simulation, "robot1/mover.refused"), 80);
  EXPECT_NEAR(value(*simulation, "robot1/mover.drawn"), 20 * 0.5, 1e-12);
  EXPECT_NEAR(value(*simulation, "robot1/eye.drawn"), 11 * 0.25, 1e-12);
  simulation->submit(SampleRequest{"robot1/eye"});
  advance(*simulation, 1);
  EXPECT_NEAR(value(*simulation, "robot1/eye.drawn"), 12 * 0.25, 1e-12);
  expect_closed(*simulation, "robot1", 100);
}

TEST(Drain, EndsWhenTheDeviceIsDeadAndChangesByRequest) {
  Node failures = Node::sequence();
  failures.push(map({{"kind", "dead"}, {"from", "1 s"}, {"until", "2 s"}}));
  failures.push(map({{"kind", "stuck"}, {"from", "2 s"}, {"until", "3 s"}}));
  Node eye = map({{"drain", "1 W"}, {"drain_per_use", "0.1 J"}});
  eye.set("failures", failures);
  const auto simulation = build(powered(map({{"capacity", "100 J"}}), eye));
  advance(*simulation, 300);
  // 1 W for 1 s and 1 s; samples at 0 .. 0.9 s, none from 1.0 to 1.9 s, then 2.0 .. 3.0 s.
  EXPECT_NEAR(value(*simulation, "robot1/eye.drawn"), 2 + 21 * 0.1, 1e-11);
  simulation->submit(ParameterRequest{"robot1/eye", "drain", Node::scalar("3 W")});
  simulation->submit(ParameterRequest{"robot1/eye", "drain_per_use", Node::scalar("0")});
  advance(*simulation, 100);
  EXPECT_NEAR(value(*simulation, "robot1/eye.drawn"), 2 + 21 * 0.1 + 3, 1e-11);
  const auto restored = again(*simulation);
  advance(*simulation, 10), advance(*restored, 10);
  EXPECT_EQ(restored->state_hash(), simulation->state_hash()) << "with what was set";
}

// -------------------------------------------------------------------------------------------------------------- motion

TEST(IdealDrive, DrawsTheWorkThatItsMotionTakes) {
  // 2 kg to 1 m/s: 1 J; at 1 m/s against 0.1 of the weight: 1.962 W. Half of what is drawn moves the robot.
  for (const char* engine : {"planar", "rigid"}) {
    Node mover = map({{"max_acceleration", "2"}, {"efficiency", "50 %"}});
    const auto simulation = build(powered(map({{"capacity", "100 J"}}), Node::map(), mover, engine));
    drive(*simulation, 1);
    advance(*simulation, 100);
    EXPECT_NEAR(value(*simulation, "robot1/mover.drawn"), 2, 1e-6) << engine;
    drive(*simulation, 0);
    advance(*simulation, 100);
    EXPECT_NEAR(value(*simulation, "robot1/mover.drawn"), 2, 1e-6) << "brakes give nothing back";
  }
  Node mover = map({{"rolling_resistance", "0.1"}});
  const auto simulation = build(powered(map({{"capacity", "100 J"}}), Node::map(), mover));
  drive(*simulation, 1);
  advance(*simulation, 1);
  const double before = value(*simulation, "robot1/mover.drawn");
  advance(*simulation, 100);
  EXPECT_NEAR(value(*simulation, "robot1/mover.drawn") - before, 0.1 * 2 * 9.81, 1e-9);
  expect_closed(*simulation, "robot1", 100);
}

TEST(IdealDrive, DrawsTheWorkOfTurning) {
  // Cylinder of 2 kg, 0.2 m: J = m r^2 / 2 = 0.04 kg m^2; to 3 rad/s: 0.18 J.
  Node mover = map({{"max_angular_acceleration", "5"}});
  const auto simulation = build(powered(map({{"capacity", "100 J"}}), Node::map(), mover));
  drive(*simulation, 0, 3);
  advance(*simulation, 100);
  EXPECT_NEAR(value(*simulation, "robot1/mover.drawn"), 0.5 * 0.04 * 9, 1e-9);
}

TEST(DeviceMassAndForce, AccelerateTheRobotOnBothEngines) {
  // A wrench of 2 N on a puck of 1 kg with a device of 3 kg: 0.5 m/s^2.
  struct Pusher {
    using Spec = NoFields;
    using State = NoFields;
    Spec spec;
    State state;
    BodyId body;
    static Result<Pusher> create(const DeviceBuild& build, Spec) { return Pusher{{}, {}, build.body()}; }
    static void actuate(PoolView<Pusher> pool, const Context& context) {
      for (const std::uint32_t i : pool.due)
        context.actuation.wrenches.push_back({pool.all[i].body, {2, 0, 0}, {}});
    }
  };
  static const Kind pusher = make_kind<Pusher>({.name = "force", .help = "For tests."});
  static const Kind* const kinds[] = {&pusher};
  for (const char* engine : {"planar", "rigid"}) {
    for (const auto& [mass, speed] : {std::pair("0", 2.0), {"3 kg", 0.5}}) {
      model::Setup setup;
      setup.engine = engine;
      setup.step = Time::from_s(0.01);
      setup.gravity = {};
      model::Instance puck = placed("puck", one_shape("puck", Cylinder{0.2, 0.4}, 1), {});
      puck.is_robot = true;
      puck.devices.push_back(device("force", "force", Node::map()));
      puck.devices.push_back(device("pack", "battery", map({{"capacity", "10 J"}, {"mass", mass}})));
      setup.instances.push_back(std::move(puck));
      const auto simulation = build(std::move(setup),
                                    {.threads = 1, .run_programs = true, .extra_kinds = kinds});
      advance(*simulation, 100);
      EXPECT_NEAR(value(*simulation, "puck.twist.linear.x"), speed, 1e-9) << engine << ", " << mass;
    }
  }
}

// ------------------------------------------------------------------------------------------------------------- closing

/// Like a radio: draws per order in actuate, and while it senses.
struct Talker {
  struct Spec {
    double rate_hz = 20;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"rate", "Hz", "Samples per second."}, s.rate_hz);
    }
  };
  using State = NoFields;
  Spec spec;
  State state;
  EnergyMeter* energy = nullptr;
  static Result<Talker> create(const DeviceBuild& build, Spec spec) { return Talker{spec, {}, build.energy}; }
  static void actuate(PoolView<Talker> pool, const Context& context) {
    for (const std::uint32_t i : pool.due)
      if (context.tick_index % 3 == 0 && pool.all[i].energy) pool.all[i].energy->draw(0.031);
  }
  static void sense(PoolView<Talker> pool, const Context&) {
    for (const std::uint32_t i : pool.due)
      if (pool.all[i].energy) pool.all[i].energy->draw(0.0017);
  }
};
const Kind talker_kind = make_kind<Talker>({.name = "talker", .help = "For tests."});
const Kind* const energy_kinds[] = {&talker_kind};
SimulationOptions with_talker(int threads = 1) {
  return {.threads = threads, .run_programs = true, .extra_kinds = energy_kinds};
}

/// Rovers with lasers that drain, a talker, DC motors (rover2) or a drive (the others), and a charger.
model::Setup busy_rover(const char* engine) {
  model::Setup setup = arena(engine, 3);
  const bool rigid = std::string(engine) == "rigid";
  for (model::Instance& robot : setup.instances) {
    if (!robot.is_robot) continue;
    robot.devices[1].config.set("drain", Node::scalar("1.5 W"));
    robot.devices[1].config.set("drain_per_use", Node::scalar("0.2 J"));
    robot.devices[0].config.set("drain_per_use", Node::scalar("0.01 J"));
    robot.devices[0].config.set("rolling_resistance", Node::scalar("0.02"));
    robot.devices.push_back(device("talker", "talker", map({{"drain", "0.3 W"}})));
    robot.devices.push_back(device("battery", "battery",
                                   map({{"capacity", robot.name == "rover1" ? "6 J" : "60 J"},
                                        {"voltage", "12"},
                                        {"resistance", "0.5"}})));
    if (rigid && robot.name == "rover2") {
      robot.controllers = {};
      std::vector<model::DeviceDecl> devices;
      for (const model::DeviceDecl& each : std::as_const(robot.devices))
        if (each.name != "drive") devices.push_back(each);
      for (const char* joint : {"left_wheel_joint", "right_wheel_joint"}) {
        model::DeviceDecl motor = device(
            joint, "dc_motor", map({{"joint", joint}, {"torque_constant", "0.05"}, {"gear_ratio", "10"}}));
        devices.push_back(motor);
      }
      robot.devices = devices;
    }
  }
  model::Instance station = placed("station", one_shape("post", Cylinder{0.1, 0.4}, 0),
                                   {{-2.5, -2.0, 0.2}, {}});
  station.is_robot = true;
  station.devices.push_back(device("charger", "charger", map({{"power", "8 W"}, {"reach", "1.2 m"}})));
  setup.instances.push_back(std::move(station));
  model::ElementDecl rule;
  rule.name = rule.kind = "energy";
  rule.config = map({{"restart", "0.3"}});
  setup.rules.push_back(rule);
  return setup;
}

void run(Simulation& simulation, std::uint64_t until) {
  while (simulation.tick_index() < until) {
    const std::uint64_t tick = simulation.tick_index();
    if (std::as_const(simulation).find_entity("rover2")->devices.size() > 5 && tick % 40 == 2)
      for (const char* joint : {"left_wheel_joint", "right_wheel_joint"})
        simulation.submit(CommandRequest{std::string("rover2/") + joint, msg::Float64::ros_type,
                                         command_bytes(msg::Float64{tick % 80 < 40 ? 8.0 : -3.0})});
    advance(simulation, 1);
  }
}

TEST(Energy, ClosesWithDrainsMotorsDrivesAndUsersDevices) {
  for (const char* engine : {"planar", "rigid"}) {
    const auto simulation = build(busy_rover(engine), with_talker());
    run(*simulation, 600);
    for (const char* robot : {"rover1", "rover2", "rover3"})
      expect_closed(*simulation, robot, robot == std::string("rover1") ? 6 : 60);
    EXPECT_GT(value(*simulation, "rover2/battery.lost"), 0);
    EXPECT_GT(value(*simulation, "rover1/battery.charged"), 0);
    EXPECT_GE(value(*simulation, "rules/energy.count"), 1) << engine;
    if (engine == std::string("planar")) continue;
    EXPECT_GT(value(*simulation, "rover2/left_wheel_joint.drawn"), 0);
  }
}

TEST(Energy, GoesOnFromASnapshotInAnyNumberOfThreads) {
  for (const char* engine : {"planar", "rigid"}) {
    const auto whole = build(busy_rover(engine), with_talker());
    run(*whole, 300);
    for (const std::uint64_t at : {67u, 151u, 240u}) {
      const auto first = build(busy_rover(engine), with_talker());
      run(*first, at);
      const std::vector<std::byte> snapshot = first->snapshot();
      for (const int threads : {1, 2, 4}) {
        Diagnostics diagnostics;
        auto second = Simulation::restore(snapshot, with_talker(threads), diagnostics);
        ASSERT_TRUE(second) << second.error().text();
        EXPECT_EQ((*second)->state_hash(), first->state_hash()) << at;
        run(**second, 300);
        EXPECT_EQ((*second)->state_hash(), whole->state_hash()) << engine << " at " << at << ", " << threads;
      }
    }
  }
}

TEST(Energy, HasMetersWhereThereIsABatteryAlone) {
  const auto meters_of = [](model::Setup setup) {
    const auto simulation = build(std::move(setup));
    int meters = 0;
    for (const auto& each : std::as_const(*simulation).find_entity("robot1")->devices)
      meters += each->energy ? 1 : 0;
    return meters;
  };
  EXPECT_EQ(meters_of(movers({})), 0);
  EXPECT_EQ(meters_of(powered(map({{"capacity", "1 J"}}), Node::map())), 3);
}

// ------------------------------------------------------------------------------------------------------------ chargers

TEST(Charger, SharesItsPowerAmongTheBatteriesInReach) {
  model::Setup setup = movers({}, 3);
  int i = 0;
  for (model::Instance& robot : setup.instances) {
    if (!robot.is_robot) continue;
    robot.X_WM.p = {0, 1.0 * i++, 0.2};
    robot.devices.push_back(
        device("battery", "battery", map({{"capacity", "10 J"}, {"initial_charge", "0.5"}})));
  }
  model::Instance station = placed("station", one_shape("post", Cylinder{0.1, 0.4}, 0),
                                   {{0.5, 0.5, 0.2}, {}});
  station.is_robot = true;
  station.devices.push_back(device("charger", "charger", map({{"power", "4 W"}, {"reach", "1 m"}})));
  setup.instances.push_back(std::move(station));
  const auto simulation = build(std::move(setup));
  advance(*simulation, 100);
  // Those at (0, 0) and (0, 1) get 2 W each; (0, 2) is 1.58 m away.
  EXPECT_NEAR(value(*simulation, "robot1/battery.energy"), 7, 1e-11);
  EXPECT_NEAR(value(*simulation, "robot2/battery.energy"), 7, 1e-11);
  EXPECT_EQ(value(*simulation, "robot3/battery.energy"), 5);
  EXPECT_EQ(value(*simulation, "station/charger.batteries"), 2);
  EXPECT_NEAR(value(*simulation,
                    "station/charger"
                    ".data"),
              4, 1e-12);
  // Full after 2.5 s; then nothing more is given.
  advance(*simulation, 200);
  EXPECT_EQ(value(*simulation, "robot1/battery.energy"), 10);
  EXPECT_NEAR(value(*simulation, "station/charger.given"), 10, 1e-9);
  EXPECT_EQ(value(*simulation, "station/charger.power_given"), 0);
  EXPECT_EQ(value(*simulation, "robot1/battery.power_supply_status"), 4);
  expect_closed(*simulation, "robot1", 5);
  simulation->submit(CommandRequest{"station/charger", msg::Bool::ros_type, command_bytes(msg::Bool{false})});
  advance(*simulation, 1);
  EXPECT_EQ(value(*simulation, "station/charger.on_now"), 0);
}

TEST(Charger, OfARobotGivesWhatItsOwnBatteryDelivers) {
  model::Setup setup = movers({}, 2);
  for (model::Instance& robot : setup.instances) {
    if (!robot.is_robot) continue;
    const bool giver = robot.name == "robot1";
    robot.X_WM.p = {giver ? 0.0 : 0.6, 0, 0.2};
    robot.devices.push_back(
        device("battery", "battery",
               map({{"capacity", giver ? "3 J" : "10 J"}, {"initial_charge", giver ? "1" : "0"}})));
    if (giver)
      robot.devices.push_back(device(
          "charger", "charger", map({{"power", "1 W"}, {"reach", "1 m"}, {"transfer_efficiency", "0.5"}})));
  }
  const auto simulation = build(std::move(setup));
  advance(*simulation, 101);
  // 1 W given for 1 s, one tick later than drawn, at 2 W drawn.
  EXPECT_NEAR(value(*simulation, "robot2/battery.energy"), 1, 1e-11);
  EXPECT_NEAR(value(*simulation, "robot1/charger.drawn"), 2.02, 1e-11);
  advance(*simulation, 200);
  // 3 J are 1.5 J at the other end.
  EXPECT_NEAR(value(*simulation, "robot2/battery.energy"), 1.5, 1e-11);
  EXPECT_EQ(value(*simulation, "robot1/battery.empty"), 1);
  expect_closed(*simulation, "robot1", 3);
  expect_closed(*simulation, "robot2", 0);
}

TEST(Battery, IsExchangedByAService) {
  const auto simulation = build(powered(map({{"capacity", "10 J"}}), map({{"drain", "2 W"}})));
  advance(*simulation, 300);
  EXPECT_NEAR(value(*simulation, "robot1/battery.energy"), 4, 1e-10);
  const msg::std_srvs::Trigger::Request nothing;
  std::vector<std::byte> bytes;
  write_cdr(message_info<msg::std_srvs::Trigger::Request>(), &nothing, bytes);
  simulation->submit(CallRequest{"robot1/battery", "exchange", bytes});
  advance(*simulation, 1);
  ASSERT_TRUE(simulation->outcomes()[0].status) << simulation->outcomes()[0].status.error().text();
  EXPECT_NEAR(value(*simulation, "robot1/battery.energy"), 10 - 0.02, 1e-10);
  expect_closed(*simulation, "robot1", 10);
}

// ---------------------------------------------------------------------------------------------------------------- rule

TEST(EnergyRule, StopsAnEmptyRobotUntilItIsCharged) {
  model::Setup setup = powered(map({{"capacity", "2 J"}}), map({{"drain", "2 W"}}));
  model::ElementDecl rule;
  rule.name = rule.kind = "energy";
  rule.config = map({{"restart", "0.5"}});
  setup.rules.push_back(rule);
  model::Instance station = placed("station", one_shape("post", Cylinder{0.1, 0.4}, 0), {{3, 0.5, 0.2}, {}});
  station.is_robot = true;
  station.devices.push_back(
      device("charger", "charger", map({{"power", "4 W"}, {"reach", "1 m"}, {"on", "false"}})));
  setup.instances.push_back(std::move(station));
  const auto simulation = build(std::move(setup));
  advance(*simulation, 102);  // empty at 1 s, 2 J at 2 W
  EXPECT_EQ(value(*simulation, "robot1/battery.empty"), 1);
  drive(*simulation, 1);
  advance(*simulation, 2);
  EXPECT_EQ(simulation->refused_commands(), 1u);
  EXPECT_EQ(speed_of(*simulation), 0);
  EXPECT_EQ(value(*simulation, "rules/energy.count"), 1);
  simulation->submit(PoseRequest{"robot1", {{3, 0, 0.2}, {}}});
  simulation->submit(CommandRequest{"station/charger", msg::Bool::ros_type, command_bytes(msg::Bool{true})});
  advance(*simulation, 40);
  // 4 - 2 W: 0.8 J after 0.4 s, of 1 J that are wanted.
  drive(*simulation, 1);
  advance(*simulation, 1);
  EXPECT_EQ(simulation->refused_commands(), 2u);
  advance(*simulation, 15);
  drive(*simulation, 1);
  advance(*simulation, 2);
  EXPECT_EQ(simulation->refused_commands(), 2u);
  EXPECT_GT(speed_of(*simulation), 0.9);
}

TEST(EnergyRule, PutsAMovingRobotToRestOrLetsItCoast) {
  for (const char* empty : {"stop", "coast", "nothing"}) {
    model::Setup setup = powered(map({{"capacity", "2 J"}}), map({{"drain", "2 W"}}), {}, "rigid");
    setup.instances[0].X_WM.p.z = -1;  // nothing rubs
    model::ElementDecl rule;
    rule.name = rule.kind = "energy";
    rule.config = map({{"empty", empty}});
    setup.rules.push_back(rule);
    const auto simulation = build(std::move(setup));
    drive(*simulation, 0.5);
    advance(*simulation, 150);
    EXPECT_NEAR(speed_of(*simulation), empty == std::string("stop") ? 0 : 0.5, 1e-6) << empty;
    drive(*simulation, 0.2);
    advance(*simulation, 1);
    EXPECT_EQ(bool(simulation->outcomes().back().status), empty == std::string("nothing")) << empty;
  }
}

// ---------------------------------------------------------------------------------------------------------- properties

model::Setup fuelled() {
  model::Setup setup = movers({}, 2);
  setup.instances.back().properties = {{"fuel", "kg", 5, 0, 10}, {"points", "1", 0}};
  setup.values.push_back({"left", "robot2.fuel / 2", {}});
  return setup;
}

TEST(Property, IsAValueSetWithinItsRangeAndState) {
  const auto simulation = build(fuelled());
  EXPECT_EQ(value(*simulation, "robot2.fuel"), 5);
  EXPECT_EQ(NamedValue::find(*simulation, "robot2.fuel")->unit(), "kg");
  EXPECT_EQ(value(*simulation, "left"), 2.5);
  EXPECT_FALSE(NamedValue::find(*simulation, "robot1.fuel"));
  const std::uint64_t before = by_path(*simulation)["robot2"];
  simulation->submit(ParameterRequest{"robot2", "fuel", Node::scalar("3000 g")});
  simulation->submit(ParameterRequest{"robot2", "fuel", Node::scalar("11")});
  simulation->submit(ParameterRequest{"robot1", "fuel", Node::scalar("1")});
  simulation->submit(ParameterRequest{"robot2", "points", Node::scalar("nan")});
  advance(*simulation, 1);
  EXPECT_TRUE(simulation->outcomes()[0].status);
  EXPECT_THAT(simulation->outcomes()[1].status.error().text(), HasSubstr("/fuel: must be in [0, 10]"));
  EXPECT_FALSE(simulation->outcomes()[2].status);
  EXPECT_FALSE(simulation->outcomes()[3].status);
  EXPECT_EQ(value(*simulation, "robot2.fuel"), 3);
  EXPECT_NE(by_path(*simulation)["robot2"], before);
  const auto restored = again(*simulation);
  EXPECT_EQ(value(*restored, "robot2.fuel"), 3);
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
  // A copy that is spawned carries its own.
  model::Instance copy = std::as_const(*simulation).find_entity("robot2")->declared();
  copy.name = "copy";
  copy.X_WM.p.x = 9;
  simulation->submit(SpawnRequest{std::move(copy)});
  advance(*simulation, 1);
  simulation->submit(ParameterRequest{"copy", "fuel", Node::scalar("1")});
  advance(*simulation, 1);
  EXPECT_EQ(value(*simulation, "copy.fuel"), 1);
  EXPECT_EQ(value(*simulation, "robot2.fuel"), 3);
}

TEST(Property, OfHealthIsLoweredByImpactsAndItsEndIsThatOfTheActuators) {
  // A puck of 2 kg at 3 m/s meets a wall: 6 Ns, of which 4 Ns are damage; 10 points per Ns.
  model::Setup setup = movers({});
  setup.instances.push_back(placed("wall", one_shape("wall", Box{{0.2, 4, 1}}, 0), {{1, 0, 0.5}, {}}));
  setup.instances[1].properties = {{"health", "1", 100, 0, 100}};
  model::ElementDecl rule;
  rule.name = rule.kind = "impact";
  rule.config = map({{"threshold", "2"}, {"property", "health"}, {"per_damage", "10"}});
  setup.rules.push_back(rule);
  const auto simulation = build(setup);
  drive(*simulation, 3);
  advance(*simulation, 40);
  const double damage_Ns = value(*simulation, "rules/impact.robots[0].sum");
  EXPECT_GT(damage_Ns, 3.9);
  EXPECT_NEAR(value(*simulation, "robot1.health"), std::max(0.0, 100 - 10 * damage_Ns), 1e-9);
  setup.rules.back().config.set("per_damage", Node::scalar("50"));
  const auto broken = build(setup);
  drive(*broken, 3);
  advance(*broken, 45);
  EXPECT_EQ(value(*broken, "robot1.health"), 0);
  drive(*broken, -1);
  advance(*broken, 1);
  EXPECT_FALSE(broken->outcomes().back().status) << "the drive has failed";
  setup.rules.back().config.set("property", Node::scalar("helth"));
  EXPECT_THAT(error_of(setup), HasSubstr("did you mean 'health'?"));
}

// -------------------------------------------------------------------------------------------------------------- errors

TEST(Energy, NamesWhatIsWrong) {
  EXPECT_THAT(error_of(movers(map({{"drain", "1 W"}}))), HasSubstr("has no battery to draw from"));
  EXPECT_THAT(error_of(movers(map({{"drain_per_use", "1"}}))), HasSubstr("/drain_per_use"));
  model::Setup two = powered(map({{"capacity", "1 J"}}), Node::map());
  two.instances.back().devices.push_back(device("more", "battery", map({{"capacity", "1 J"}})));
  EXPECT_THAT(error_of(std::move(two)), HasSubstr("has two batteries, 'battery' and 'more'"));
  const auto of_battery = [](Node keys) { return error_of(powered(std::move(keys), Node::map())); };
  EXPECT_THAT(of_battery(Node::map()), HasSubstr("the battery has no capacity"));
  EXPECT_THAT(of_battery(map({{"capacity", "1"}, {"charge_capacity", "1 Ah"}})),
              HasSubstr("the capacity is given twice"));
  for (const char* mass : {"-1", "nan"})
    EXPECT_THAT(of_battery(map({{"capacity", "1"}, {"mass", mass}})), HasSubstr("/mass")) << mass;
  for (const char* drain : {"-1", "nan", "inf"})
    EXPECT_THAT(error_of(powered(map({{"capacity", "1"}}), map({{"drain", drain}}))), HasSubstr("/drain"))
        << drain;
  EXPECT_THAT(error_of(powered(map({{"capacity", "1"}}), map({{"efficiency", "0.5"}}))),
              HasSubstr("does no work"));
  EXPECT_THAT(error_of(powered(map({{"capacity", "1"}}), map({{"rolling_resistance", "0.5"}}))),
              HasSubstr("does not drive on rails"));
  Node curve = Node::sequence();
  for (const char* charge : {"0", "0.5", "0.5", "1"}) curve.push(map({{"charge", charge}, {"voltage", "3"}}));
  Node battery = map({{"capacity", "1"}});
  battery.set("curve", curve);
  EXPECT_THAT(of_battery(battery), HasSubstr("not in the order of their charge"));
  const auto simulation = build(movers({}));
  simulation->submit(LoadDeviceRequest{"robot1", device("late", "battery", map({{"capacity", "1"}}))});
  simulation->submit(ParameterRequest{"robot1/mover", "drain", Node::scalar("1")});
  advance(*simulation, 1);
  EXPECT_THAT(simulation->outcomes()[0].status.error().text(), HasSubstr("neither comes nor goes"));
  EXPECT_FALSE(simulation->outcomes()[1].status);
}

TEST(Energy, ADeviceThatIsLoadedDrawsAndOneThatIsUnloadedDoesNot) {
  const auto simulation = build(powered(map({{"capacity", "100 J"}}), Node::map()));
  simulation->submit(LoadDeviceRequest{"robot1", device("late", "ground_truth", map({{"drain", "5 W"}}))});
  advance(*simulation, 101);
  EXPECT_NEAR(value(*simulation, "robot1/battery.energy"), 100 - 5 * 1.01, 1e-9);
  simulation->submit(UnloadDeviceRequest{"robot1/late"});
  simulation->submit(UnloadDeviceRequest{"robot1/battery"});
  advance(*simulation, 100);
  EXPECT_NEAR(value(*simulation, "robot1/battery.energy"), 100 - 5 * 1.01, 1e-9);
  simulation->submit(DeleteRequest{"robot1"});
  advance(*simulation, 2);
}

}  // namespace
}  // namespace sandlot::test
