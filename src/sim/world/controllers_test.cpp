/// Controllers of a robot that are loaded, configured, started, stopped and unloaded while the simulation runs.
#include "sim/world/controllers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "messages/cdr.h"
#include "messages/command.h"
#include "messages/controller_manager_msgs.h"
#include "messages/messages.h"
#include "messages/registry.h"
#include "sim/test_values.h"
#include "sim/test_world.h"

namespace sandlot::test {
namespace {

namespace cm = msg::controller_manager;
using testing::ElementsAre;
using testing::HasSubstr;

/// Orders the drive 1 mm/s more in each of its steps, and publishes their number.
struct Ramp {
  struct Spec {
    double scale = 1;
    static void fields(auto& s, auto&& visit) {
      visit(Field{"scale", "1", "Factor on the speed.", 0, 10, Field::tunable}, s.scale);
    }
  };
  struct State {
    std::uint32_t n = 0;
    static void fields(auto& s, auto&& visit) { visit(Field{"n", "1", "Number of steps."}, s.n); }
  };
  Spec spec;
  State state;
  Actuator<msg::Twist> drive;
  Publication<msg::UInt32> count;
  Status init(const Description& robot, Outputs& out) {
    SL_ASSIGN(drive, robot.actuator<msg::Twist>("drive"));
    count = out.publish<msg::UInt32>("count");
    return {};
  }
  void step(const Observation&, Command& cmd) {
    cmd.publish(count, msg::UInt32{++state.n});
    cmd.set(drive, msg::Twist{{spec.scale * 1e-3 * state.n, 0, 0}, {}});
  }
};

/// Reads the topic of another program, which it cannot be without, and claims nothing.
struct Listener {
  using Spec = NoFields;
  using State = NoFields;
  Spec spec;
  State state;
  Reading<msg::UInt32> count;
  Status init(const Description& robot) {
    SL_ASSIGN(count, robot.reading<msg::UInt32>("ramp/count"));
    return {};
  }
  void step(const Observation&, Command&) {}
};

constexpr ControllerKind ramp = make_controller<Ramp>({.name = "ramp", .help = "Drives faster and faster."});
constexpr ControllerKind listener = make_controller<Listener>({.name = "listener", .help = "Listens."});
constexpr const ControllerKind* kinds[] = {&ramp, &listener};
const SimulationOptions options{.threads = 1, .extra_controllers = kinds};

constexpr const char* gait = R"(controller_manager:
  ros__parameters:
    update_rate: 100
    ramp:
      type: ramp
    quick:
      type: ramp
quick:
  ros__parameters:
    scale: 2
    rate: 20
)";

/// A joint by its position, or by its speed, of the wheels of a rover without a drive.
constexpr const char* wheels = R"(controller_manager:
  ros__parameters:
    turn: {type: position_controllers/JointGroupPositionController}
    spin: {type: velocity_controllers/JointGroupVelocityController}
    base: {type: diff_drive_controller/DiffDriveController}
turn:
  ros__parameters: {joints: [left_wheel_joint]}
spin:
  ros__parameters: {joints: [left_wheel_joint, right_wheel_joint]}
base:
  ros__parameters: {left_wheel_names: left_wheel_joint, right_wheel_names: right_wheel_joint, wheel_separation: 0.3, wheel_radius: 0.07}
)";

/// A world with rover1, and who talks to its controller manager.
struct Bench {
  explicit Bench(const char* controller = "wander", int threads = 1)
      : simulation(build(arena("planar", 1, controller), {.threads = threads, .extra_controllers = kinds})) {}
  explicit Bench(std::unique_ptr<Simulation> made) : simulation(std::move(made)) {}

  /// Carries one call out in the next tick. @return "" or why it was refused
  template <class S>
  std::string call(const char* service, const typename S::Request& asked,
                   typename S::Response* answer = nullptr) {
    CallRequest made{"rover1/controller_manager", service, {}};
    write_cdr(message_info<typename S::Request>(), &asked, made.bytes);
    const std::uint64_t sequence = simulation->submit(std::move(made));
    advance(*simulation, 1);
    for (const Outcome& outcome : simulation->outcomes()) {
      if (outcome.sequence != sequence) continue;
      if (!outcome.status) return outcome.status.error().text();
      typename S::Response response;
      EXPECT_TRUE(read_cdr(message_info<typename S::Response>(), outcome.response, &response));
      if (answer) *answer = response;
      return "";
    }
    return "no outcome";
  }
  std::string load(const std::string& name, const std::string& kind, const std::string& parameters = "",
                   const std::string& file = "") {
    return call<cm::LoadController>("load_controller", {name, kind, parameters, file});
  }
  std::string configure(const std::string& name) {
    return call<cm::ConfigureController>("configure_controller", {name});
  }
  std::string unload(const std::string& name) {
    return call<cm::UnloadController>("unload_controller", {name});
  }
  std::string change(std::vector<std::string> start, std::vector<std::string> stop) {
    return call<cm::SwitchController>("switch_controller", {std::move(start), std::move(stop)});
  }
  /// Loads and configures one.
  void bring(const std::string& name, const std::string& kind, const std::string& parameters = "") {
    EXPECT_EQ(load(name, kind, parameters), "");
    EXPECT_EQ(configure(name), "");
  }
  /// "ramp active drive" of each.
  std::vector<std::string> states() {
    std::vector<std::string> out;
    for (const ControllerView& each : controllers_of(*simulation, robot())) {
      out.push_back(each.name + " " + name_of(each.state));
      for (const std::string& claim : each.claims) out.back() += " " + claim;
    }
    return out;
  }
  const Simulation::Entity& robot() const { return *std::as_const(*simulation).find_entity("rover1"); }
  double value(const std::string& address) { return test::value(*simulation, address); }
  /// The speed that the drive is ordered [m/s].
  double ordered() {
    for (const auto& device : robot().devices)
      for (const auto& slot : device->commands)
        if (const auto* const twist = topic_cast<msg::Twist>(slot.topic.get());
            twist && device->decl.name == "drive")
          return twist->message.linear.x;
    return NAN;
  }

  std::unique_ptr<Simulation> simulation;
};

std::unique_ptr<Simulation> without_drive() {
  model::Setup setup = arena("rigid", 1, "");
  auto& devices = setup.instances.back().devices;
  for (std::size_t i = 0; i < devices.size(); ++i)
    if (std::as_const(devices)[i].name == "drive") devices.erase(i);
  return build(std::move(setup), options);
}

// --------------------------------------------------------------------------------------------------- what they do

TEST(Controllers, OfAScenarioAreActiveAndListingThemChangesNothing) {
  Bench asked, quiet;
  cm::ListControllers::Response list;
  EXPECT_EQ(asked.call<cm::ListControllers>("list_controllers", {}, &list), "");
  ASSERT_EQ(list.controller.size(), 1u);
  EXPECT_EQ(list.controller[0].name, "controller");
  EXPECT_EQ(list.controller[0].type, "wander");
  EXPECT_EQ(list.controller[0].state, "active");
  EXPECT_THAT(list.controller[0].claimed_interfaces, ElementsAre("drive"));
  advance(*quiet.simulation, 1);
  EXPECT_EQ(asked.simulation->state_hash(), quiet.simulation->state_hash());
}

/// Control steps are at the ticks that 5 divides. A switch acts at the beginning of its tick: one that starts in tick 5 has its
/// step in that tick; one that stops in tick 15 has none in it.
TEST(Controllers, StepFromTheTickInWhichTheyStartUntilTheOneInWhichTheyStop) {
  Bench bench("");
  EXPECT_EQ(bench.load("ramp", "ramp"), "");  // tick 1
  EXPECT_THAT(bench.states(), ElementsAre("ramp unconfigured"));
  EXPECT_EQ(bench.configure("ramp"), "");  // tick 2
  EXPECT_THAT(bench.states(), ElementsAre("ramp inactive drive"));
  advance(*bench.simulation, 2);
  EXPECT_EQ(bench.change({"ramp"}, {}), "");  // tick 5
  EXPECT_THAT(bench.states(), ElementsAre("ramp active drive"));
  EXPECT_EQ(bench.value("rover1/ramp.n"), 1);
  advance(*bench.simulation, 9);              // tick 14: one more step, at 10, whose order came in tick 11
  EXPECT_EQ(bench.change({}, {"ramp"}), "");  // tick 15
  advance(*bench.simulation, 20);
  EXPECT_EQ(bench.value("rover1/ramp.n"), 2);
  EXPECT_DOUBLE_EQ(bench.ordered(), 2e-3) << "its devices keep the last order";
  EXPECT_EQ(bench.change({"ramp"}, {}), "");  // tick 36: it goes on where it was, at 40
  advance(*bench.simulation, 4);
  EXPECT_EQ(bench.value("rover1/ramp.n"), 3);
}

/// The step at tick 10 orders 2 mm/s, to be delivered in tick 11, in which it is stopped.
TEST(Controllers, StoppedOnesLeaveNoOrderBehindThatWasNotDelivered) {
  Bench bench("");
  bench.bring("ramp", "ramp");                // ticks 1 and 2
  EXPECT_EQ(bench.change({"ramp"}, {}), "");  // tick 3
  advance(*bench.simulation, 7);              // tick 10
  ASSERT_EQ(bench.value("rover1/ramp.n"), 2);
  EXPECT_EQ(bench.change({}, {"ramp"}), "");  // tick 11
  advance(*bench.simulation, 5);
  EXPECT_DOUBLE_EQ(bench.ordered(), 1e-3);
  EXPECT_EQ(bench.simulation->refused_commands(), 0u);
}

/// At 20 Hz and ticks of 10 ms a step comes every 5 ticks from its start on, however long it was stopped.
TEST(Controllers, WithARateOfTheirOwnDoNotCatchUpWhatTheyMissed) {
  Bench bench("");
  bench.bring("quick", "", gait);  // ticks 1 and 2
  advance(*bench.simulation, 1);   // tick 3
  EXPECT_EQ(bench.change({"quick"}, {}),
            "");  // tick 4: it begins at 30 ms, so that its steps are at 40, 80, 130 ... ms
  EXPECT_EQ(bench.value("rover1/quick.n"), 1);
  advance(*bench.simulation, 3);
  EXPECT_EQ(bench.value("rover1/quick.n"), 1);
  advance(*bench.simulation, 1);
  EXPECT_EQ(bench.value("rover1/quick.n"), 2);
  EXPECT_EQ(bench.value("rover1/quick.scale"), 2);
  EXPECT_EQ(bench.change({}, {"quick"}), "");
  advance(*bench.simulation, 100);
  EXPECT_EQ(bench.change({"quick"}, {}), "");
  advance(*bench.simulation, 3);
  EXPECT_EQ(bench.value("rover1/quick.n"), 3);
  advance(*bench.simulation, 1);
  EXPECT_EQ(bench.value("rover1/quick.n"), 4);
}

TEST(Controllers, TakeOverFromEachOtherInOneTick) {
  Bench bench("ramp");  // named controller; steps at tick 0, too
  bench.bring("other", "ramp", "scale: 10");
  advance(*bench.simulation, 7);  // tick 9: steps at 0 and 5
  EXPECT_EQ(bench.change({"other"}, {"controller"}), "");
  EXPECT_EQ(bench.value("rover1/controller.n"), 2);
  EXPECT_EQ(bench.value("rover1/other.n"), 1);
  EXPECT_DOUBLE_EQ(bench.ordered(), 2e-3);
  advance(*bench.simulation, 1);
  EXPECT_DOUBLE_EQ(bench.ordered(), 1e-2);
  EXPECT_THAT(bench.states(), ElementsAre("controller inactive drive", "other active drive"));
}

// ------------------------------------------------------------------------------------------------------- refusals

TEST(Controllers, OfWhichTwoWouldCommandOneDeviceAreRefusedAndNothingIsStopped) {
  Bench bench;
  bench.bring("ramp", "ramp");
  bench.bring("other", "ramp");
  EXPECT_EQ(
      bench.change({"ramp"}, {}),
      "controller 'controller' and controller 'ramp' both command 'rover1/drive'; stop one of them in the "
      "same switch");
  EXPECT_EQ(
      bench.change({"ramp", "other"}, {"controller"}),
      "controller 'ramp' and controller 'other' both command 'rover1/drive'; stop one of them in the same "
      "switch");
  EXPECT_EQ(bench.change({"no"}, {"controller"}),
            "robot 'rover1' has no controller 'no'; known are: controller, ramp, other");
  EXPECT_THAT(bench.states(),
              ElementsAre("controller active drive", "ramp inactive drive", "other inactive drive"));
  EXPECT_EQ(bench.change({"ramp"}, {"controller"}), "");
}

TEST(Controllers, SayWhatIsWrongWithARequest) {
  Bench bench;
  bench.bring("ramp", "ramp");
  EXPECT_EQ(
      bench.load("ramp", "ramp"),
      "robot 'rover1' has a controller 'ramp' already, which is inactive; unload it first, or take another "
      "name");
  EXPECT_EQ(bench.load("laser", "ramp"),
            "'rover1/laser' would name two things; give the controller another name");
  EXPECT_THAT(bench.load("a b", "ramp"), HasSubstr("'a b' cannot be the name of a controller"));
  EXPECT_THAT(bench.load("x", "rampp"),
              HasSubstr("there is no kind of controller 'rampp'; did you mean 'ramp'?"));
  EXPECT_THAT(bench.load("x", "pipe"), HasSubstr("a program of kind 'pipe' begins with the run"));
  EXPECT_THAT(bench.load("x", ""), HasSubstr("the kind of controller 'x' is missing"));
  EXPECT_THAT(bench.load("x", "", gait, "gait.yaml"),
              HasSubstr("gait.yaml:1:1: this file declares no controller 'x'"));
  EXPECT_THAT(bench.load("x", "ramp", "a: b: c", "x.yaml"), HasSubstr("x.yaml:1:"));
  EXPECT_THAT(bench.load("x", "ramp", "[1]"), HasSubstr("parameters:1:1: parameters are a map of keys"));
  EXPECT_EQ(bench.configure("ramp"),
            "controller 'ramp' is inactive, which it can be but once; configure those that are unconfigured; "
            "unload it and load it again to read other keys");
  EXPECT_THAT(bench.configure("rump"), HasSubstr("has no controller 'rump'; did you mean 'ramp'?"));
  EXPECT_EQ(bench.unload("controller"), "controller 'controller' is active; stop it before it is unloaded");
  EXPECT_EQ(bench.change({}, {}), "no controller is named; name those to start and those to stop");
  EXPECT_EQ(bench.change({"controller"}, {}),
            "controller 'controller' is active already; leave it out of those to start");
  EXPECT_EQ(bench.change({}, {"ramp"}),
            "controller 'ramp' is not active, but inactive; leave it out of those to stop");
  EXPECT_EQ(bench.change({"ramp"}, {"ramp"}), "controller 'ramp' is named twice; start it or stop it, once");
  EXPECT_EQ(bench.call<cm::SwitchController>("switch_controller", {{"ramp"}, {}, 1}),
            "strictness 1 is not known; STRICT (2) is");
  // What its keys are is known when it is configured.
  EXPECT_EQ(bench.load("y", "",
                       "controller_manager:\n  ros__parameters:\n    y: {type: ramp}\ny:\n  "
                       "ros__parameters:\n    scal: 2\n",
                       "y.yaml"),
            "");
  EXPECT_EQ(bench.change({"y"}, {"controller"}),
            "controller 'y' is unconfigured; configure it before it is started");
  EXPECT_THAT(bench.configure("y"), HasSubstr("y.yaml:6:5: "));
  EXPECT_THAT(bench.states(),
              ElementsAre("controller active drive", "ramp inactive drive", "y unconfigured"));
  EXPECT_EQ(bench.unload("y"), "");
}

TEST(Controllers, ThatOthersListenToStay) {
  Bench bench("");
  bench.bring("ramp", "ramp");
  bench.bring("ear", "listener");
  EXPECT_THAT(bench.unload("ramp"), HasSubstr("has no reading 'ramp/count'"));
  EXPECT_NE(bench.simulation->find_topic("/rover1/ramp/count"), nullptr);
  EXPECT_EQ(bench.unload("ear"), "");
  EXPECT_EQ(bench.unload("ramp"), "");
  EXPECT_EQ(bench.simulation->find_topic("/rover1/ramp/count"), nullptr);
  EXPECT_THAT(bench.states(), ElementsAre());
}

TEST(Controllers, AreCalledAtRobotsAlone) {
  Bench bench;
  const std::uint64_t sequence = bench.simulation->submit(
      CallRequest{"crate1/controller_manager", "list_controllers", {}});
  const std::uint64_t other = bench.simulation->submit(
      CallRequest{"rover1/controller_manager", "lost_controllers", {}});
  advance(*bench.simulation, 1);
  for (const Outcome& outcome : bench.simulation->outcomes()) {
    ASSERT_FALSE(outcome.status);
    if (outcome.sequence == sequence) {
      EXPECT_THAT(outcome.status.error().text(), HasSubstr("there is no device 'crate1/controller_manager'"));
    }
    if (outcome.sequence == other) {
      EXPECT_THAT(outcome.status.error().text(), HasSubstr("did you mean 'list_controllers'?"));
    }
  }
}

// ----------------------------------------------------------------------------------------------- joint controllers

TEST(JointControllers, OfAFileOfRos2ControlTurnJointsWhileTheyAreActive) {
  Bench bench(without_drive());
  bench.bring("spin", "", wheels);
  EXPECT_THAT(bench.states(), ElementsAre("spin inactive joint left_wheel_joint joint right_wheel_joint"));
  const auto command = [&](double speed) {
    for (const char* joint : {"left", "right"})
      bench.simulation->submit(CommandRequest{"rover1/spin_" + std::string(joint) + "_wheel_joint",
                                              msg::Float64::ros_type, command_bytes(msg::Float64{speed})});
  };
  command(2);
  advance(*bench.simulation, 100);
  // The wheels are spheres of 0.07 m, and what is stopped rolls nowhere.
  EXPECT_NEAR(bench.value("rover1.twist.linear.x"), 0, 1e-3);
  EXPECT_EQ(bench.change({"spin"}, {}), "");
  command(2);
  advance(*bench.simulation, 200);
  EXPECT_NEAR(bench.value("rover1.joints.left_wheel_joint.velocity"), 2, 1e-3);
  EXPECT_EQ(bench.change({}, {"spin"}), "");
  command(-5);
  advance(*bench.simulation, 20);
  EXPECT_GT(bench.value("rover1.joints.left_wheel_joint.velocity"), 0) << "the joint is free and rolls on";
}

TEST(JointControllers, ChangeFromSpeedToPositionInOneTickAndNeverShareAJoint) {
  Bench bench(without_drive());
  bench.bring("spin", "", wheels);
  bench.bring("turn", "", wheels);
  EXPECT_EQ(
      bench.change({"spin", "turn"}, {}),
      "controller 'spin' and controller 'turn' both command joint 'left_wheel_joint'; stop one of them in "
      "the same switch");
  EXPECT_EQ(bench.change({"spin"}, {}), "");
  EXPECT_EQ(bench.unload("spin"), "controller 'spin' is active; stop it before it is unloaded");
  EXPECT_EQ(bench.change({"turn"}, {"spin"}), "");
  EXPECT_THAT(bench.states(), ElementsAre("spin inactive joint left_wheel_joint joint right_wheel_joint",
                                          "turn active joint left_wheel_joint"));
  EXPECT_EQ(bench.unload("spin"), "");
  EXPECT_THAT(bench.states(), ElementsAre("turn active joint left_wheel_joint"));
  EXPECT_EQ(bench.robot().devices.size(), 3u);  // laser, truth, turn
  EXPECT_THAT(bench.load("base", "", wheels, "w.yaml"),
              HasSubstr("w.yaml:5:18: a diff_drive_controller/DiffDriveController becomes a device of kind "
                        "diff_drive, which can be neither started nor stopped"));
}

TEST(JointControllers, DoNotTakeAWheelFromADrive) {
  Bench bench;
  bench.bring("turn", "", wheels);
  EXPECT_EQ(
      bench.change({"turn"}, {}),
      "controller 'turn' and device 'drive' both command joint 'left_wheel_joint'; the device is always "
      "active: unload it, or leave the controller stopped");
}

/// A motor of the scenario is a controller as well.
TEST(JointControllers, OfTheScenarioAreStoppedAndStarted) {
  model::Setup setup = arena("rigid", 1, "");
  auto& devices = setup.instances.back().devices;
  devices.clear();
  devices.push_back(device("left", "joint_motor", map({{"joint", "left_wheel_joint"}, {"servo", "exact"}})));
  Bench bench(build(std::move(setup), options));
  EXPECT_THAT(bench.states(), ElementsAre("left active joint left_wheel_joint"));
  EXPECT_EQ(bench.change({}, {"left"}), "");
  EXPECT_THAT(bench.states(), ElementsAre("left inactive joint left_wheel_joint"));
  Bench same(again(*bench.simulation, options));
  EXPECT_EQ(same.states(), bench.states());
  EXPECT_EQ(bench.change({"left"}, {}), "");
  EXPECT_EQ(bench.value("rover1/left.active"), 1);
}

// ----------------------------------------------------------------------------------------------------------- State

TEST(Controllers, SurviveASnapshotInAllTheirStates) {
  Bench bench;
  bench.bring("ramp", "ramp");
  EXPECT_EQ(bench.load("late", "ramp", "{scale: 3}"), "");
  EXPECT_EQ(bench.load("turn", "", wheels), "");
  EXPECT_EQ(bench.configure("turn"), "");
  EXPECT_EQ(bench.change({"ramp"}, {"controller"}), "");
  advance(*bench.simulation, 12);
  Bench other(again(*bench.simulation, {.threads = 4, .extra_controllers = kinds}));
  EXPECT_EQ(other.states(), bench.states());
  EXPECT_THAT(other.states(), ElementsAre("controller inactive drive", "ramp active drive",
                                          "turn inactive joint left_wheel_joint", "late unconfigured"));
  EXPECT_EQ(other.simulation->state_hash(), bench.simulation->state_hash());
  for (Bench* const each : {&bench, &other}) {
    EXPECT_EQ(each->change({"controller"}, {"ramp"}), "");
    EXPECT_EQ(each->configure("late"), "");
    EXPECT_EQ(each->value("rover1/late.scale"), 3);
    EXPECT_EQ(each->change({"late"}, {"controller"}), "");
    EXPECT_EQ(each->unload("turn"), "");
    advance(*each->simulation, 20);
  }
  EXPECT_EQ(other.simulation->state_hash(), bench.simulation->state_hash());
}

TEST(Controllers, SwitchedAlikeGiveTheSameHashInAnyNumberOfThreads) {
  const auto hash = [](int threads, bool switched) {
    Bench bench("wander", threads);
    bench.bring("ramp", "ramp");
    if (switched) {
      EXPECT_EQ(bench.change({"ramp"}, {"controller"}), "");
    } else {
      advance(*bench.simulation, 1);
    }
    advance(*bench.simulation, 50);
    return bench.simulation->state_hash();
  };
  const std::uint64_t first = hash(1, true);
  EXPECT_EQ(hash(4, true), first);
  EXPECT_NE(hash(1, false), first);
}

/// Bytes of a loaded controller cannot be anything.
TEST(Controllers, OfAForgedSnapshotAreRefused) {
  Bench bench;
  EXPECT_EQ(bench.load("late", "ramp"), "");
  const_cast<Simulation::LoadedController&>(bench.robot().loaded.front()).decl.name = "a b";
  Diagnostics diagnostics;
  const auto restored = Simulation::restore(bench.simulation->snapshot(), options, diagnostics);
  ASSERT_FALSE(restored);
  EXPECT_THAT(restored.error().text(), HasSubstr("the snapshot is damaged"));
}

}  // namespace
}  // namespace sandlot::test
