/// Devices that act on others, and those of high-level agents, in running worlds on both engines.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/world/test_movers.h"

namespace sandlot::test {
namespace {

Node speeds_node(std::initializer_list<double> values) {
  Node out = Node::sequence();
  for (const double value : values) out.push(Node::scalar(std::to_string(value)));
  return out;
}

template <class M>
void command(Simulation& simulation, const char* device, const M& message) {
  simulation.submit(CommandRequest{device, M::ros_type, command_bytes(message)});
}
template <class M>
const M& reading(const Simulation& simulation, const char* topic) {
  const auto* const found = topic_cast<M>(simulation.find_topic(topic));
  SL_CHECK(found != nullptr);
  return found->message;
}

/// A floor without friction: nothing but the kick changes a velocity.
model::Setup slippery(const char* engine) {
  model::Setup setup;
  setup.engine = engine;
  setup.step = Time::from_s(0.01);
  setup.substeps = 4;
  setup.gravity = {};
  return setup;
}

std::shared_ptr<model::Model> slick(const std::string& name, const Shape& shape, double mass_kg) {
  auto made = one_shape(name, shape, mass_kg);
  made->links[0].collisions[0].surface.mu = made->links[0].collisions[0].surface.mu2 = 0;
  return made;
}

/// A round robot of 0.2 m and 4 kg at the origin that kicks along `yaw`, from its rim.
model::Instance kicking_robot(Node keys, double yaw = 0) {
  model::Instance robot = placed("robot", slick("robot", Cylinder{0.2, 0.3}, 4),
                                 {{0, 0, 0.15}, quat_from_rpy(0, 0, yaw)});
  robot.is_robot = true;
  robot.devices.push_back(device("foot", "kicker", std::move(keys), {{0.2, 0, 0}, {}}));
  return robot;
}

// ---------------------------------------------------------------------------------------------------------- kicker

TEST(Kicker, GivesExactlyItsImpulseAndTakesTheReaction) {
  for (const char* const engine : {"rigid", "planar"})
    for (const double yaw : {0.0, 2.0}) {
      model::Setup setup = slippery(engine);
      setup.instances.push_back(kicking_robot(map({{"max_impulse", "3"}, {"reach", "0.1"}}), yaw));
      const Vec3 ahead{math::cos(yaw), math::sin(yaw), 0};
      // Its nearest surface is 0.05 m before the kicker.
      setup.instances.push_back(
          placed("ball", slick("ball", Sphere{0.1}, 0.5), {ahead * 0.35 + Vec3{0, 0, 0.15}, {}}));
      const auto simulation = build(setup);
      command(*simulation, "robot/foot", msg::Float64{2.0});
      advance(*simulation, 1);
      // J = 2 Ns: dv = J / m, and nothing turns, for the line of the impulse goes through both centres of mass.
      const auto velocity = [&](const std::string& name) {
        return Vec3{value(*simulation, (name + ".twist.linear.x").c_str()),
                    value(*simulation, (name + ".twist.linear.y").c_str()),
                    value(*simulation, (name + ".twist.linear.z").c_str())};
      };
      EXPECT_LT(norm(velocity("ball") - ahead * (2.0 / 0.5)), 1e-12) << engine << " " << yaw;
      EXPECT_LT(norm(velocity("robot") + ahead * (2.0 / 4)), 1e-12) << engine << " " << yaw;
      EXPECT_LT(std::abs(value(*simulation, "ball.twist.angular.z")), 1e-9);
      EXPECT_LT(std::abs(value(*simulation, "robot.twist.angular.z")), 1e-9);
      const auto& state = reading<msg::KickerState>(*simulation, "robot/foot");
      EXPECT_EQ(state.kicks, 1u);
      EXPECT_EQ(state.hits, 1u);
      EXPECT_EQ(state.impulse, 2.0);
      EXPECT_EQ(state.object, "ball");
    }
}

TEST(Kicker, OffTheMiddleItTurnsWhatItMeets) {
  // The ray meets the box 0.1 m beside its centre: w = r J / I, with I = m (a^2 + b^2) / 12 about the vertical.
  for (const char* const engine : {"rigid", "planar"}) {
    model::Setup setup = slippery(engine);
    setup.instances.push_back(kicking_robot(map({{"max_impulse", "1"}, {"reach", "0.1"}})));
    setup.instances.push_back(placed("box", slick("box", Box{{0.2, 0.4, 0.2}}, 2), {{0.35, 0.1, 0.15}, {}}));
    const auto simulation = build(setup);
    command(*simulation, "robot/foot", msg::Float64{1.0});
    advance(*simulation, 1);
    const double inertia = 2 * (0.2 * 0.2 + 0.4 * 0.4) / 12;
    EXPECT_NEAR(value(*simulation, "box.twist.angular.z"), 0.1 * 1 / inertia, 1e-9) << engine;
    // The twist is that of the link's origin, here the centre of mass.
    EXPECT_NEAR(value(*simulation, "box.twist.linear.x"), 0.5, 1e-9) << engine;
  }
}

TEST(Kicker, HeightsCountInThreeDimensionsAndElevationLifts) {
  model::Setup setup = slippery("rigid");
  setup.instances.push_back(
      kicking_robot(map({{"max_impulse", "1"}, {"reach", "0.1"}, {"elevation", "30 deg"}})));
  setup.instances.push_back(placed("ball", slick("ball", Sphere{0.1}, 0.5), {{0.35, 0, 0.15}, {}}));
  const auto simulation = build(setup);
  command(*simulation, "robot/foot", msg::Float64{1.0});
  advance(*simulation, 1);
  EXPECT_NEAR(value(*simulation, "ball.twist.linear.x"), 2 * std::sqrt(0.75), 1e-9);
  EXPECT_NEAR(value(*simulation, "ball.twist.linear.z"), 2 * 0.5, 1e-9);
  setup.engine = "planar";
  EXPECT_NE(error_of(setup).find("/elevation: the engine 'planar' knows no height"), std::string::npos)
      << error_of(setup);
}

TEST(Kicker, ReachOpeningAndWhatStandsBetweenDecideWhatIsMet) {
  for (const char* const engine : {"rigid", "planar"}) {
    const auto hits = [&](std::vector<std::pair<std::string, Vec3>> balls, const char* opening) {
      model::Setup setup = slippery(engine);
      setup.instances.push_back(kicking_robot(map({{"reach", "0.3"}, {"opening", opening}})));
      for (const auto& [name, at] : balls)
        setup.instances.push_back(placed(name, slick("ball", Sphere{0.05}, 0.5), {at, {}}));
      const auto simulation = build(setup);
      command(*simulation, "robot/foot", msg::Float64{1.0});
      advance(*simulation, 1);
      return reading<msg::KickerState>(*simulation, "robot/foot").object;
    };
    EXPECT_EQ(hits({{"ball", {0.2 + 0.349, 0, 0.15}}}, "0"), "ball") << engine;
    EXPECT_EQ(hits({{"ball", {0.2 + 0.351, 0, 0.15}}}, "0"), "") << engine << ": out of reach";
    EXPECT_EQ(hits({{"ball", {-0.3, 0, 0.15}}}, "0"), "") << engine << ": behind";
    EXPECT_EQ(hits({{"ball", {0.4, 0.15, 0.15}}}, "0"), "") << engine << ": beside the ray";
    // At 37 degrees: a fan of 60 degrees to both sides reaches it.
    EXPECT_EQ(hits({{"ball", {0.4, 0.15, 0.15}}}, "120 deg"), "ball") << engine;
    // It is seen between 25 and 48 degrees: not by a fan of 20 degrees to both sides.
    EXPECT_EQ(hits({{"ball", {0.4, 0.15, 0.15}}}, "40 deg"), "") << engine << ": beside the fan";
    EXPECT_EQ(hits({{"far", {0.45, 0, 0.15}}, {"near", {0.3, 0, 0.15}}}, "0"), "near") << engine;
  }
}

TEST(Kicker, AWallTakesTheImpulseAndTheRobotIsPushedBack) {
  for (const char* const engine : {"rigid", "planar"}) {
    model::Setup setup = slippery(engine);
    setup.instances.push_back(kicking_robot(map({{"max_impulse", "1"}, {"reach", "0.1"}})));
    setup.instances.push_back(placed("wall", one_shape("wall", Box{{0.1, 2, 1}}, 0), {{0.3, 0, 0.5}, {}}));
    const auto simulation = build(setup);
    command(*simulation, "robot/foot", msg::Float64{1.0});
    advance(*simulation, 1);
    EXPECT_NEAR(value(*simulation, "robot.twist.linear.x"), -0.25, 1e-12) << engine;
    EXPECT_EQ(reading<msg::KickerState>(*simulation, "robot/foot").object, "wall");
  }
}

TEST(Kicker, ItsStoreFillsLinearlyAndLimitsTheKick) {
  model::Setup setup = slippery("planar");
  setup.instances.push_back(
      kicking_robot(map({{"max_impulse", "2"}, {"reach", "0.1"}, {"recharge_time", "1 s"}})));
  setup.instances.push_back(placed("wall", one_shape("wall", Box{{0.1, 9, 1}}, 0), {{0.3, 0, 0.5}, {}}));
  const auto simulation = build(setup);
  const auto& state = reading<msg::KickerState>(*simulation, "robot/foot");
  EXPECT_TRUE(state.ready);
  // A kick of half the impulse takes a quarter of the store, and the tick gives 0.01 back.
  command(*simulation, "robot/foot", msg::Float64{1.0});
  advance(*simulation, 1);
  EXPECT_NEAR(state.charge, 0.75 + 0.01, 1e-12);
  EXPECT_FALSE(state.ready);
  // More than there is: what is left, 2 sqrt(0.76).
  simulation->submit(PoseRequest{"robot", {{0, 0, 0.15}, {}}});
  command(*simulation, "robot/foot", msg::Float64{50});
  advance(*simulation, 1);
  EXPECT_NEAR(state.impulse, 2 * std::sqrt(0.76), 1e-12);
  EXPECT_NEAR(state.charge, 0.01, 1e-12);
  advance(*simulation, 98);
  EXPECT_FALSE(state.ready);
  advance(*simulation, 2);
  EXPECT_TRUE(state.ready);
  EXPECT_EQ(state.charge, 1);
  // Into the air: the store is empty all the same. Nothing below 0 is a kick.
  simulation->submit(PoseRequest{"robot", {{-5, 0, 0.15}, {}}});
  command(*simulation, "robot/foot", msg::Float64{2});
  advance(*simulation, 1);
  EXPECT_NEAR(state.charge, 0.01, 1e-12);
  EXPECT_EQ(state.impulse, 0);
  EXPECT_EQ(state.kicks, 3u);
  EXPECT_EQ(state.hits, 2u);
  command(*simulation, "robot/foot", msg::Float64{-2});
  advance(*simulation, 1);
  EXPECT_EQ(state.kicks, 3u);
}

TEST(Kicker, MeetsWhatWasPutThereInTheSameTick) {
  for (const char* const engine : {"rigid", "planar"}) {
    model::Setup setup = slippery(engine);
    setup.instances.push_back(kicking_robot(map({{"max_impulse", "1"}, {"reach", "0.1"}})));
    const auto simulation = build(setup);
    simulation->submit(SpawnRequest{placed("ball", slick("ball", Sphere{0.1}, 0.5), {{0.35, 0, 0.15}, {}})});
    command(*simulation, "robot/foot", msg::Float64{1.0});
    advance(*simulation, 1);
    EXPECT_NEAR(value(*simulation, "ball.twist.linear.x"), 2, 1e-12) << engine;
  }
}

// ------------------------------------------------------------------------------------------------------------ lamp

/// A lamp at the origin and a light sensor 2 m before it that looks back, in the dark.
model::Setup lit(Node keys, double yaw_of_lamp = 0) {
  model::Setup setup = slippery("rigid");
  setup.ambient = {0, 0, 0, 1};
  setup.lights.clear();
  model::Instance robot = placed("robot", one_shape("robot", Sphere{0.05}, 1), {});
  robot.is_robot = true;
  keys.set("rate", Node::scalar("0"));
  robot.devices.push_back(device("lamp", "lamp", std::move(keys), {{}, quat_from_rpy(0, 0, yaw_of_lamp)}));
  setup.instances.push_back(robot);
  model::Instance eye = placed("eye", one_shape("eye", Sphere{0.05}, 1),
                               {{2, 0, 0}, quat_from_rpy(0, 0, math::pi)});
  eye.is_robot = true;
  eye.devices.push_back(device("cell", "light_sensor", map({{"rate", "0"}})));
  setup.instances.push_back(eye);
  return setup;
}

double lux(const Simulation& simulation) {
  return reading<msg::Illuminance>(simulation, "eye/cell").illuminance;
}

TEST(Lamp, IsDimmedByTheTickOfItsCommand) {
  // Strength 1 is worth 1000 lx, at 2 m with 1 / (1 + 0.25 * 4) half of it.
  const auto simulation = build(lit(map({{"quadratic", "0.25"}})));
  EXPECT_NEAR(lux(*simulation), 500, 1e-3) << "tick 0";
  command(*simulation, "robot/lamp", msg::Float64{0.2});
  advance(*simulation, 1);
  EXPECT_NEAR(lux(*simulation), 100, 1e-3);
  EXPECT_EQ(reading<msg::Float64>(*simulation, "robot/lamp").data, 0.2);
  command(*simulation, "robot/lamp", msg::Float64{-1});
  advance(*simulation, 1);
  EXPECT_EQ(lux(*simulation), 0);
  command(*simulation, "robot/lamp", msg::Float64{7});
  advance(*simulation, 1);
  EXPECT_NEAR(lux(*simulation), 500, 1e-3);
}

TEST(Lamp, TakesAColourAndTellsWhatItShines) {
  model::Setup setup = lit(map({{"brightness", "0.5"}}));
  Node levels = Node::sequence();
  for (const char* const level : {"brightness", "color"}) levels.push(Node::scalar(level));
  setup.instances[0].devices.edit().front().config.set("levels", levels);
  const auto simulation = build(setup);
  EXPECT_NEAR(lux(*simulation), 500, 1e-3);
  command(*simulation, "robot/lamp", msg::ColorRGBA{0, 1, 0, 0});
  advance(*simulation, 1);
  EXPECT_NEAR(lux(*simulation), 1000 * 0.7152 * 0.5, 1e-3);
  const auto& shown = reading<msg::ColorRGBA>(*simulation, "/robot/lamp/color");
  EXPECT_EQ(shown.g, 0.5f);
  EXPECT_EQ(shown.r, 0);
}

TEST(Lamp, ASpotShinesAlongItsXAlone) {
  const auto seen = [](double yaw) {
    return lux(*build(lit(map({{"type", "spot"}, {"cone", "60 deg"}}), yaw)));
  };
  EXPECT_NEAR(seen(0), 1000, 1e-3);
  EXPECT_NEAR(seen(19 * math::pi / 180), 1000, 1e-3) << "within two thirds of the cone";
  EXPECT_EQ(seen(31 * math::pi / 180), 0);
  EXPECT_EQ(seen(math::pi), 0);
}

TEST(Lamp, GoesOutWhenItFailsOrIsUnloadedAndComesBackFromASnapshot) {
  const auto simulation = build(lit(map({{"brightness", "0.5"}})));
  command(*simulation, "robot/lamp", msg::Float64{0.25});
  advance(*simulation, 1);
  const auto restored = again(*simulation);
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
  for (Simulation* const each : {simulation.get(), restored.get()}) {
    advance(*each, 1);
    EXPECT_NEAR(lux(*each), 250, 1e-3);
    each->submit(ParameterRequest{"robot/lamp", "failure", Node::scalar("dead")});
    advance(*each, 1);
    EXPECT_EQ(lux(*each), 0);
    each->submit(ParameterRequest{"robot/lamp", "failure", Node::scalar("none")});
    advance(*each, 1);
    EXPECT_NEAR(lux(*each), 250, 1e-3);
    each->submit(UnloadDeviceRequest{"robot/lamp"});
    advance(*each, 1);
    EXPECT_EQ(lux(*each), 0);
  }
  EXPECT_EQ(restored->state_hash(), simulation->state_hash());
}

// ------------------------------------------------------------------------------------------------------ agent_eyes

/// An agent at the origin that looks along y, a ball 3 m before it that moves, a robot behind it, and a wall far away.
model::Setup agents(Node keys, const char* engine, bool wall = false) {
  model::Setup setup = slippery(engine);
  model::Instance agent = placed("agent", one_shape("agent", Cylinder{0.1, 0.4}, 1),
                                 {{0, 0, 0.2}, quat_from_rpy(0, 0, math::pi / 2)});
  agent.is_robot = true;
  keys.set("rate", Node::scalar("0"));
  agent.devices.push_back(device("eyes", "agent_eyes", std::move(keys)));
  setup.instances.push_back(agent);
  model::Instance ball = placed("ball1", one_shape("size5", Sphere{0.2}, 0.4), {{0, 3, 0.2}, {}});
  ball.label = "ball";
  setup.instances.push_back(ball);
  model::Instance other = placed("other", one_shape("puck", Cylinder{0.15, 0.4}, 2), {{0, -4, 0.2}, {}});
  other.is_robot = true;
  other.team = "red";
  Node speed = map({{"max_acceleration", "1e9"}});
  speed.set("initial_linear", speeds_node({0.5, 0, 0}));
  other.devices.push_back(device("mover", "body_velocity", std::move(speed)));
  setup.instances.push_back(other);
  setup.teams.emplace_back().name = "red";
  if (wall)
    setup.instances.push_back(placed("wall", one_shape("wall", Box{{2, 0.1, 1}}, 0), {{0, 1.5, 0.5}, {}}));
  return setup;
}

TEST(AgentEyes, ReportAllPropertiesOfWhatIsInSight) {
  for (const char* const engine : {"rigid", "planar"}) {
    const auto simulation = build(agents(Node::map(), engine));
    advance(*simulation, 1);
    const auto& seen = reading<msg::VisibleObjectArray>(*simulation, "agent/eyes").objects;
    ASSERT_EQ(seen.size(), 2u) << engine;
    const msg::VisibleObject &ball = seen[0], &other = seen[1];
    EXPECT_EQ(ball.name, "ball1");
    EXPECT_EQ(ball.label, "ball");
    EXPECT_FALSE(ball.robot);
    // The agent's x is the world's y.
    EXPECT_NEAR(ball.pose.p.x, 3, 1e-9);
    EXPECT_NEAR(ball.pose.p.y, 0, 1e-9);
    EXPECT_NEAR(ball.range, 3, 1e-9);
    EXPECT_NEAR(ball.bearing, 0, 1e-9);
    EXPECT_NEAR(ball.size.x, 0.4, 1e-9);
    EXPECT_EQ(ball.mass, 0.4);
    EXPECT_EQ(other.name, "other");
    EXPECT_EQ(other.team, "red");
    EXPECT_TRUE(other.robot);
    EXPECT_EQ(other.mass, 2);
    EXPECT_NEAR(std::abs(other.bearing), math::pi, 0.01);
    // 0.5 m/s along the world's x are to the right of the agent.
    EXPECT_NEAR(other.velocity.linear.y, -0.5, 1e-9) << engine;
    EXPECT_NEAR(other.velocity.linear.x, 0, 1e-9) << engine;
  }
}

TEST(AgentEyes, ReportTheUsersOwnPropertiesInTheirOrder) {
  for (const char* const engine : {"rigid", "planar"}) {
    model::Setup setup = agents(Node::map(), engine);
    model::Instance& ball = setup.instances[1];
    ASSERT_EQ(ball.name, "ball1");
    ball.properties = {{"pressure", "bar", 0.8, 0, 1.2}, {"age", "", 3}};
    const auto simulation = build(setup);
    const auto all = [&](std::size_t object) {
      std::vector<std::tuple<std::string, double, std::string, double, double>> out;
      for (const msg::Property& each :
           reading<msg::VisibleObjectArray>(*simulation, "agent/eyes").objects.at(object).properties)
        out.emplace_back(each.name, each.value, each.unit, each.min, each.max);
      return out;
    };
    using Properties = decltype(all(0));
    EXPECT_EQ(all(0), (Properties{{"pressure", 0.8, "bar", 0, 1.2}, {"age", 3, "", -1e12, 1e12}})) << engine;
    EXPECT_EQ(all(1), Properties{}) << engine;
    simulation->submit(ParameterRequest{"ball1", "pressure", Node::scalar("0.5")});
    advance(*simulation, 1);
    EXPECT_EQ(std::get<1>(all(0)[0]), 0.5) << engine;
  }
}

TEST(AgentEyes, RangeViewLabelsAndWallsHideThings) {
  for (const char* const engine : {"rigid", "planar"}) {
    const auto names = [&](Node keys, bool wall) {
      std::string all;
      const auto simulation = build(agents(std::move(keys), engine, wall));
      for (const msg::VisibleObject& each :
           reading<msg::VisibleObjectArray>(*simulation, "agent/eyes").objects)
        all += each.name + " ";
      return all;
    };
    EXPECT_EQ(names(map({{"range", "3.5"}}), false), "ball1 ") << engine;
    EXPECT_EQ(names(map({{"fov", "90 deg"}}), false), "ball1 ") << engine;
    EXPECT_EQ(names(map({}), true), "other ") << engine << ": the ball is behind the wall";
    EXPECT_EQ(names(map({{"through_walls", "true"}}), true), "ball1 other ") << engine;
    EXPECT_EQ(names(map({{"fixed", "true"}}), true), "other wall ") << engine;
    Node labels = Node::map();
    labels.set("labels", Node::sequence()).push(Node::scalar("ball"));
    EXPECT_EQ(names(std::move(labels), false), "ball1 ") << engine;
  }
}

TEST(AgentEyes, LinksOfTheOwnRobotHideNothing) {
  for (const char* const engine : {"rigid", "planar"}) {
    model::Setup setup = agents(Node::map(), engine);
    // A screen of 1 m before the eyes, on a link of its own.
    auto screened = std::make_shared<model::Model>(*setup.instances[0].model);
    model::Link screen = one_shape("screen", Box{{0.02, 1, 0.4}}, 1)->links[0];
    screen.name = "screen";
    screen.X_ML.p = {0.3, 0, 0};
    screened->links.push_back(screen);
    model::Joint joint;
    joint.name = "mount";
    joint.type = model::JointType::fixed;
    joint.parent = 0;
    joint.child = 1;
    screened->joints.push_back(joint);
    setup.instances[0].model = screened;
    const auto simulation = build(setup);
    EXPECT_EQ(reading<msg::VisibleObjectArray>(*simulation, "agent/eyes").objects.size(), 2u) << engine;
  }
}

// --------------------------------------------------------------------------------------------------- heading_drive

model::Setup heading(const char* engine, Node keys) {
  model::Setup setup = movers(Node(), 1, engine);
  setup.instances.back().devices.edit().front() = device("go", "heading_drive", std::move(keys));
  return setup;
}

TEST(HeadingDrive, TurnsTheShorterWayAtItsRateAndGoesMeanwhile) {
  for (const char* const engine : {"rigid", "planar"}) {
    const auto simulation = build(heading(
        engine,
        map({{"max_turn_rate", "2"}, {"max_acceleration", "1e9"}, {"max_angular_acceleration", "1e9"}})));
    command(*simulation, "robot1/go", msg::SpeedHeading{0, math::pi + 2.0});  // the shorter way: to the right
    advance(*simulation, 50);
    EXPECT_NEAR(value(*simulation, "robot1.pose.yaw"), -1, 1e-6) << engine << ": 0.5 s at 2 rad/s";
    EXPECT_NEAR(value(*simulation, "robot1.pose.x"), 0, 1e-9) << engine << ": on the spot";
    advance(*simulation, 60);
    EXPECT_NEAR(value(*simulation, "robot1.pose.yaw"), 2 - math::pi, 1e-6) << engine << ": and stays there";
    EXPECT_NEAR(value(*simulation, "robot1.twist.angular.z"), 0, 1e-6) << engine;
    command(*simulation, "robot1/go", msg::SpeedHeading{7, 2 - math::pi});  // cut to max_speed
    advance(*simulation, 100);
    const double way = norm(
        Vec3{value(*simulation, "robot1.pose.x"), value(*simulation, "robot1.pose.y"), 0});
    EXPECT_NEAR(way, 1, 1e-6) << engine;
    command(*simulation, "robot1/go", msg::SpeedHeading{-7, 2 - math::pi});  // and back
    advance(*simulation, 100);
    EXPECT_NEAR(value(*simulation, "robot1.pose.x"), 0, 1e-6) << engine;
    EXPECT_NEAR(value(*simulation, "robot1.pose.y"), 0, 1e-6) << engine;
  }
}

TEST(HeadingDrive, StopsAtTheHeadingWithinItsAcceleration) {
  // 2 rad at 1 rad/s^2: as fast as sqrt(2) in the middle, 2.83 s in all; it never passes the heading by more than a tick's error.
  const auto simulation = build(
      heading("planar", map({{"max_turn_rate", "9"}, {"max_angular_acceleration", "1"}})));
  command(*simulation, "robot1/go", msg::SpeedHeading{0, 2});
  double most = 0, fastest = 0;
  for (int i = 0; i < 320; ++i) {
    advance(*simulation, 1);
    most = std::max(most, value(*simulation, "robot1.pose.yaw"));
    fastest = std::max(fastest, value(*simulation, "robot1.twist.angular.z"));
  }
  EXPECT_NEAR(fastest, std::sqrt(2.0), 0.02);
  EXPECT_LT(most, 2 + 1e-3);
  EXPECT_NEAR(value(*simulation, "robot1.pose.yaw"), 2, 1e-3);
}

TEST(HeadingDrive, StandsBeforeItsFirstCommandAndAfterItsTimeout) {
  const auto simulation = build(
      heading("planar", map({{"command_timeout", "50 ms"}, {"max_acceleration", "1e9"}})));
  advance(*simulation, 5);
  EXPECT_EQ(value(*simulation, "robot1.pose.x"), 0);
  command(*simulation, "robot1/go", msg::SpeedHeading{1, 0});
  advance(*simulation, 1);
  EXPECT_NEAR(value(*simulation, "robot1.twist.linear.x"), 1, 1e-9);
  advance(*simulation, 10);
  EXPECT_NEAR(value(*simulation, "robot1.twist.linear.x"), 0, 1e-9);
}

// ------------------------------------------------------------------------------------------------------- snapshots

/// All of them in one world.
model::Setup team(const char* engine) {
  model::Setup setup = arena(engine, 1);
  for (model::Instance& each : setup.instances) {
    if (!each.is_robot) continue;
    each.devices.push_back(device("foot", "kicker",
                                  map({{"reach", "0.5"}, {"opening", "120 deg"}, {"max_impulse", "0.4"}}),
                                  {{0.17, 0, 0}, {}}));
    Node lamp = map({{"rate", "25"}}), levels = Node::sequence();
    for (const char* const level : {"brightness", "color"}) levels.push(Node::scalar(level));
    lamp.set("levels", levels);
    each.devices.push_back(device("lamp", "lamp", lamp, {{0, 0, 0.3}, {}}));
    each.devices.push_back(device("eyes", "agent_eyes", map({{"rate", "20"}})));
    each.devices.push_back(device("cell", "light_sensor", map({{"rate", "20"}}), {{0.1, 0, 0.3}, {}}));
  }
  model::Instance agent = placed("agent", one_shape("puck", Cylinder{0.15, 0.3}, 2), {{2, 2, 0.15}, {}});
  agent.is_robot = true;
  agent.devices.push_back(device("go", "heading_drive", Node::map()));
  setup.instances.push_back(agent);
  for (int i = 0; i < 6; ++i)
    setup.instances.push_back(placed("ball" + std::to_string(i), one_shape("ball", Sphere{0.1}, 0.3),
                                     {{-2.1 + 0.5 * (i % 3), -2.5 + 0.5 * (i / 3), 0.1}, {}}));
  return setup;
}

void play(Simulation& simulation, std::uint64_t until) {
  while (simulation.tick_index() < until) {
    const std::uint64_t tick = simulation.tick_index();
    if (tick % 20 == 5) command(simulation, "rover1/foot", msg::Float64{0.3});
    if (tick % 10 == 3)
      command(simulation, "rover1/lamp", msg::Float64{0.05 * static_cast<double>(tick % 20)});
    if (tick == 12) command(simulation, "rover1/lamp", msg::ColorRGBA{0.2f, 0.9f, 0.4f, 1});
    if (tick % 30 == 1)
      command(simulation, "agent/go", msg::SpeedHeading{0.5, 0.1 * static_cast<double>(tick)});
    advance(simulation, 1);
  }
}

TEST(Acting, GoesOnFromASnapshotToTheSameHashInAnyNumberOfThreads) {
  for (const char* const engine : {"rigid", "planar"}) {
    const auto whole = build(team(engine));
    play(*whole, 90);
    EXPECT_GT(reading<msg::KickerState>(*whole, "rover1/foot").hits, 0u) << engine;
    const auto half = build(team(engine));
    play(*half, 46);
    for (const int threads : {1, 2, 4}) {
      const auto rest = again(*half, {.threads = threads});
      play(*rest, 90);
      EXPECT_EQ(rest->state_hash(), whole->state_hash()) << engine << ", " << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace sandlot::test
